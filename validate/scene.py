"""What a scene may say of itself: the records that scene files are written with, and their defaults.

A scene is a module in `validate/scenes/`.  It must define
    TITLE, LESSON             name for people, and the lesson that it belongs to
    CASES                     {name: Params}: the first is timed and drawn, all are checked
    T                         output time [s]
    STEPS                     numbers of steps over T, coarse to fine: they divide T, and span two decades
    METHODS                   tuple of Method: which of our steps to run
    start(p) → state          a tuple of arrays, ready for run; checks p
    acceleration              (t, x, v, p) → a [m/s²]: the law of the scene, its own or a lesson's
    run(step, acceleration, state, p, dt, steps) → state        hands over to a lesson's stepping loop: that is timed, and
                              in a compiled world step, acceleration and loop are compiled
    observe(state, p)         flat array: what is compared with the truth at T
    truth(p, t)               the same quantities at time t
    UNCERTAINTY               of the truth, relative
    tolerance(p, dt)          {order, or label of an engine or a method: largest relative error}, derived before looking
    ENGINES                   tuple of Engine
    points(observed, p)       (n, 2) drawing coordinates [m] of what was observed
    NEEDS, LEAVES_OUT         what the scene calls; {what it does without: (p → (state, p) with it put in), or why not yet}
and may define
    LINKS(p)                  pairs of points to join in the picture
    WITHOUT                   why some methods or engines that a reader would expect are not there, in one sentence without its full stop
    FULL_ONLY                 functions of methods that are too slow here for a quick validation
    PLAIN_IN_QUICK            functions of methods that plain Python has done here before the compiler has: a quick validation does not compile them
    bodies(p)                 shapes of validate/report/space.py: the motion is then shown in space, and its points in small;
    poses(observed, p)        (bodies, 7) place and quaternion (w, x, y, z) of each;
    arrows(observed, p)       {name: (from, to)} [m], such as ω and L;   TRAIL: number of the body whose way is drawn;   GROUND: draw z = 0
    FULL_CASES                names of cases that are too dear for a quick validation
    FILM                      how much of the motion the moving picture shows [s]; T without it
    PUBLISHED                 ((time, observed, tolerance), …) of the first case, from elsewhere
    ORDERS                    {method's function: order here}, where it differs from the usual; EXACT means no error but round-off
    WHY                       {label of an engine or a method: (why it departs from the truth, in one sentence; its own law (p, t),
                              like truth)}: it is held against its own law, and the report says how far that is from the truth
    CAN(name, p)              whether that method (by its function) or engine (by its label) can do that case at all; without it all can
    STILL                     nothing moves: what the fineness dt = T/steps means, in words, "size of a triangle, 1/n [-]".  T is 1, no start is
                              compared, the picture stands.  When nothing can be refined either, STILL is "" and STEPS (1,): then the report
                              has no diagrams but a table of numbers, under the names that QUANTITIES(p) gives to what is observed
"""

from typing import Callable, NamedTuple

EXACT = "exact"
LATE_LEAPFROG = "1 to 2"     # the order that leapfrog shows when its first velocity belongs to half a step before or after
ROUND_OFF = 2.3e-16          # spacing of floats around 1, rounded up [-]


class Method(NamedTuple):
    """One of our steps."""
    function: str
    label: str
    order: int
    lesson: str = "integrators"


EULER = Method("euler_step", "Euler", 1)
MIDPOINT = Method("midpoint_step", "midpoint", 2)
RK4 = Method("rk4_step", "Runge–Kutta 4", 4)
AVERAGE_VELOCITY = Method("average_velocity_step", "average velocity", 1)
SYMPLECTIC_EULER = Method("symplectic_euler_step", "symplectic Euler", 1)
VERLET = Method("verlet_step", "Verlet", 2)
IMPLICIT_EULER = Method("implicit_euler_step", "implicit Euler", 1)
IMPLICIT_MIDPOINT = Method("implicit_midpoint_step", "implicit midpoint", 2)
IMPLICIT_MESH = Method("implicit_mesh_step", "implicit mesh", 1, "springs")
TRIANGLES = Method("mesh_body", "triangles", 2, "inertia_tensors")
POINTS = Method("point_mass_inertia", "points", 1, "inertia_tensors")
PARTS = Method("combine", "parts", 2, "inertia_tensors")
SLIDING = Method("sliding_step", "sliding", 1, "friction")
PYRAMID = Method("pyramid_step", "pyramid", 1, "friction")
EVENT = Method("event_step", "event", 2, "friction")
CONTACT = Method("contact_step", "contact", 1, "friction")
GRIPPING = Method("gripping_step", "gripping", 1, "friction")

INTEGRATORS = (EULER, MIDPOINT, RK4, AVERAGE_VELOCITY, SYMPLECTIC_EULER, VERLET, IMPLICIT_EULER, IMPLICIT_MIDPOINT)
ONE_OF_EACH_ORDER = (SYMPLECTIC_EULER, VERLET, RK4)                  # enough for a quick run; oscillator and throw show the others
LEFT_TO_FULL = tuple(method.function for method in INTEGRATORS if method not in ONE_OF_EACH_ORDER)


class Engine(NamedTuple):
    """One way to set up an engine: make(p, dt) gives a World."""
    label: str               # "pymunk", "pymunk, leapfrog start": the engine's name comes first
    make: Callable
    order: int               # expected
    settings: str            # for people: what was set, and to what
    most_steps: int | None = None            # the finest step that is worth the engine's time


class World(NamedTuple):
    """An engine at work: step() advances it by dt, read() observes it, close() ends it."""
    step: Callable
    read: Callable
    close: Callable


def by_order(rate, T, dt):
    """{order k: largest relative error at T} of a method whose local error is (rate dt)ᵏ⁺¹ a step.

    rate [1/s] is the fastest rate at which anything in the scene changes: T/dt steps add up to  rate T (rate dt)ᵏ.
    Round-off adds up like T/dt spacings at worst; Newton's method stops at 1e-12.
    """
    limits = {k: rate * T * (rate * dt) ** k + 1e-12 + T / dt * ROUND_OFF for k in (1, 2, 4)}
    return {**limits, EXACT: 1e-12 + T / dt * ROUND_OFF}
