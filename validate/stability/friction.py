"""Stick and slip: the edges and errors of the steps of lesson 3, compared with theory.

Edges are found by bisection of runs from rest, never from a formula.  A body that moves less than WAY
counts as at rest.  *Source:* Coulomb 1785 for the edges; each case derives the other numbers.
"""

from functools import partial
from typing import NamedTuple

import numpy as np

from solutions import integrators
from solutions.friction import ParticleInBowl, ParticleOnPlane
from solutions.given.friction import make_block
from validate.engines.friction import slab
from validate.methods import CONTACT, EVENT, GRIPPING, PYRAMID, SLIDING
from validate.reference.friction import DrivenBlock, T, slip_limits, slip_position, slips
from validate.reference.schemes import EULER, step_of
from validate.stability.case import DOTS, EDGE, LINE, Picture, bisect, case, random_law, refuses, series

from ..engines.products import PYBULLET, PYMUNK

G = 9.81                     # [m/s²]
WAY = 1e-9                   # [m]: far above the round-off of one second, far below the slip at 1e-6 beyond the edge
ENGINE_WAY = 2e-5  # [m]: twice the overlap of 1e-5 that an engine tolerates, which limits how well it knows a position
MILLIMETRES = 1e3            # millimetres per metre
ROUND_OFF = 1e-12            # of numbers below 30 after a thousand steps
STILL = np.zeros(2)


def gravity_on(degrees):
    """Return gravity [m/s²] on a slope: x points down the slope, y out of it."""
    theta = np.radians(degrees)
    return np.array([G * np.sin(theta), -G * np.cos(theta)])


def slope(degrees, mu_s, mu_k, drive=(0.0, 0.0), omega=0.0):
    """Return a Block on a slope."""
    return make_block((0.0, 1.0), mu_s, mu_k, gravity_on(degrees), drive, omega)


def particle(degrees, mu):
    """Return the same for a particle on an implicit plane."""
    return ParticleOnPlane(1.0, mu, 0.0, gravity_on(degrees), STILL, np.array([0.0, 1.0]))


def advanced(lesson, method, x, v, dt, steps, block):
    """Return (x, v) of a block after this number of steps of a method."""
    step = getattr(lesson, method.function)
    return integrators.advance(step, lesson.driven_acceleration, 0.0, x, v, dt, steps, block)


def moved(lesson, method, degrees, mu_s, mu_k, dt=0.02, steps=50):
    """Return the distance [m] that a body slides down from rest in one second with a method of this lesson."""
    if method in (CONTACT, GRIPPING):
        x, _ = lesson.advance_particle(
            getattr(lesson, method.function), lesson.falling_acceleration, lesson.particle_plane_gap, 0.0, STILL, STILL,
            dt, steps, particle(degrees, mu_s))
    else:
        x, _ = advanced(lesson, method, STILL, STILL, dt, steps, slope(degrees, mu_s, mu_k))
    return x[0]


def least_friction(lesson, method, degrees):
    """Return the smallest static friction [-] that holds a body on a slope, by bisection."""
    return bisect(lambda mu: moved(lesson, method, degrees, mu, 0.5 * mu) < WAY, 0.01, 4.0)


def engine_moved(engine, degrees, mu, dt=1.0 / 240.0):
    """Return the distance [m] that an engine's block slides down from rest in one second."""
    world = engine.world.build(slab(gravity_on(degrees), mu), dt)
    try:
        for _ in range(round(1.0 / dt)):
            world.step()
        return world.state().x[0, 0]
    finally:
        world.close()


def least_friction_of_an_engine(engine, degrees):
    """Return the smallest friction [-] with which an engine's block holds."""
    return bisect(lambda mu: abs(engine_moved(engine, degrees, mu)) < ENGINE_WAY, 0.3, 1.0)


# ---------------------------------------------------------------------------------------------- stick and slip

def held_by_an_engine(engine):
    """Return what bisection finds of a block on 30° in an engine, for Checks.by."""
    found = least_friction_of_an_engine(engine, 30.0)
    return {"law": np.tan(np.radians(30.0)), "found": found,
            "within": EDGE + 2.0 * ENGINE_WAY / (G * np.cos(np.radians(30.0))),
            "saw": f"By bisection {engine} holds a block at 30° from μ = {found:.5f} on."}


@case("stick-threshold", "Stick and slip on a slope", compiled=False)
def stick_threshold(lesson, check):
    """Check that a block at rest on a slope of angle θ holds from μ = tan θ on.

    Just below, at μ = tan θ (1 − ε), it slides with the acceleration g sin θ ε.  In one second it moves WAY if
    ε > 2 WAY/(g sin θ), which is below 1e-8 here.  An engine knows a position only to ENGINE_WAY.
    """
    drawn, angles = [], (5.0, 10.0, 20.0, 30.0, 45.0, 60.0)
    for method in (SLIDING, EVENT, GRIPPING):
        edges = {degrees: least_friction(lesson, method, degrees) for degrees in angles}
        for degrees in (10.0, 30.0, 60.0):
            bound = np.tan(np.radians(degrees))
            check("A body at rest holds from μ = tan θ on.",
                  f"{method.label}: least static friction that holds at {degrees:g}° [-]",
                  law=bound, found=edges[degrees], within=(EDGE + 1e-8) * bound,
                  saw=f"By bisection the {method.label} step holds at {degrees:g}° from μ = {edges[degrees]:.6f} on; "
                      f"tan θ is {bound:.6f}.")
        drawn.append(series(f"{method.label}, measured", angles, edges.values(), DOTS))
    for engine in (PYMUNK, PYBULLET):
        check.by(engine, "An engine's block holds from μ = tan θ on, to the accuracy of its position.",
                 f"{engine}: least friction that holds at 30° [-]", partial(held_by_an_engine, engine))
    fine = np.linspace(0.0, 62.0, 125)
    return Picture(
        "Stick or slip on a slope", "slope θ [°]", "least friction that holds [-]",
        [series("tan θ, theory", fine, np.tan(np.radians(fine)), LINE), *drawn],
        "Above the line a block stays at rest, below the line it slides: three steps of this lesson agree with theory "
        "to six "
        "digits.")


def least_force_that_moves(lesson, method):
    """Return the smallest amplitude [N] of F cos t that moves a block of 1 kg with μ = 0.8, by bisection."""
    run = lambda force: advanced(lesson, method, STILL, STILL, 0.01, 100, slope(0.0, 0.8, 0.8, (force, 0.0), 1.0))
    return bisect(lambda force: run(force)[0][0] > 1e-12, 4.0, 16.0)


def slips_in_time(lesson, check, p, block, dt):
    """Check the times of both slips of the scene stick_slip, and the end of the run, with steps of dt."""
    steps, milliseconds, times = round(T / dt), f"{MILLIMETRES * dt:g} ms", np.array([slip[:2] for slip in slips(p)])
    ours = lesson.slip_times(lesson.driven_acceleration, 0.0, STILL, STILL, dt, steps, block)
    if len(ours) != len(times):
        ours = np.full_like(times, np.nan)
    for name, (_, truth), (_, end) in zip(("first", "second"), times, ours):
        check("The moment at which a slip ends is found between the steps.",
              f"end of the {name} slip, with steps of {milliseconds} [s]",
              law=truth, found=end, within=dt * dt * 8.0 * 0.59 / 24.0 / 0.3,
              saw=f"With steps of {milliseconds} the {name} slip ends at {end:.6f} s.")
    check("The time at which a slip begins is exact.", f"begin of the second slip, with steps of {milliseconds} [s]",
          law=times[1, 0], found=ours[1, 0], within=ROUND_OFF,
          saw=f"The second slip begins at {ours[1, 0]:.9f} s; |F cos t| = μ m g then.")
    end, goal = advanced(lesson, EVENT, STILL, STILL, dt, steps, block)[0][0], slip_position(p, T)[0]
    check("An event step keeps its second order through all stops and starts.",
          f"position after 4 s, with event steps of {milliseconds} [m]",
          law=goal, found=end, within=slip_limits(p, dt)[2] * abs(goal),
          saw=f"Steps of {milliseconds} end at {MILLIMETRES * end:.5f} mm; the reference solution is "
              f"{MILLIMETRES * goal:.5f} mm.")


@case("stick-slip-threshold", "Stick and slip under a periodic force", compiled=False)
def stick_slip_threshold(lesson, check):
    """Check the edge and the slips of a block under F cos t, which breaks away if F > μ m g.

    With F = 8 N, m = 1 kg and μ = 0.8 it slips twice in 4 s.  Just above the edge, at F = μg + ε, it slips by 1.5 ε²/F,
    which is detected if ε > √(WAY F/1.5).  The other numbers are those of the scene stick_slip, in closed form.  At the
    end of a slip of s = 0.59 s an event step of dt is wrong by dt² Aω² s/24 in speed, while the speed falls by at least
    0.3 m/s²; per slip x is wrong by dt² (Aω s/6 + Aω² s²/24).  A sliding step is wrong by the limit of order 1 of that
    scene.
    """
    p, hold = DrivenBlock(), 0.8 * G
    block = make_block((0.0, 1.0), p.mu, p.mu, (0.0, -p.g), (p.force / p.m, 0.0), p.omega)
    for method in (SLIDING, EVENT):
        found = least_force_that_moves(lesson, method)
        check("A periodic force moves the block if its amplitude exceeds μ m g.",
              f"{method.label}: least amplitude that moves 1 kg at μ = 0.8 [N]",
              law=hold, found=found, within=EDGE * hold + np.sqrt(1e-12 * hold / 1.5),
              saw=f"With the {method.label} step the block moves from {found:.5f} N on; μ m g is {hold:.5f} N.")
    for dt in (0.05, 0.0125):
        slips_in_time(lesson, check, p, block, dt)
    fine = np.linspace(0.0, T, 401)
    drawn = [series("truth", fine, [MILLIMETRES * slip_position(p, t)[0] for t in fine], LINE)]
    for method in (SLIDING, EVENT):
        ts, xs, _ = integrators.trajectory(getattr(lesson, method.function), lesson.driven_acceleration, 0.0, STILL,
                                           STILL, 0.05, 80, block)
        drawn.append(series(f"{method.label}, dt = 0.05 s", ts, MILLIMETRES * xs[:, 0], DOTS))
    return Picture(
        "Stick and slip under 8 N cos t", "t [s]", "x [mm]", drawn,
        "The block moves for a third of a second, rests until the force has reversed, and moves the other way.")


# ---------------------------------------------------------------------------------------------- errors of steps

@case("regularised-friction-creeps", "Friction as a force: a swing in place of a stop", compiled=False)
def regularised_friction_creeps(lesson, check):
    """Check that friction as an ordinary force, −μ F_N v/|v|, never stops a block under Euler's method.

    Every step overshoots.  Once |v| < μg dt the next speed is v − μg dt sign v, and the one after that is v again: v
    alternates by exactly μg dt.
    """
    mu, begin, drawn = 0.3, np.array([1.0, 0.0]), []
    block = slope(0.0, mu, mu)

    def force(t, x, v, p):
        a = p.gravity
        return a - (a @ p.n) * p.n + lesson.kinetic_friction(a, v, p.n, p.mu_k)

    def euler_step(acceleration, t, x, v, dt, p):
        return step_of(EULER)(lambda *now: acceleration(*now, p), t, x, v, dt)

    for dt in (0.05, 0.02, 0.01):
        run = lambda step, law, dt=dt: integrators.trajectory(step, law, 0.0, STILL, begin, dt, round(1.0 / dt), block)
        ts, _, swung = run(euler_step, force)
        _, _, stopped = run(lesson.sliding_step, lesson.driven_acceleration)
        swing, rest, milliseconds = np.ptp(swung[-4:, 0]), np.abs(stopped[-4:]).max(), f"{MILLIMETRES * dt:g} ms"
        check("As a force, friction does not stop a block: its velocity alternates by μ g dt.",
              f"swing of the velocity at rest, Euler with steps of {milliseconds} [m/s]",
              law=mu * G * dt, found=swing, within=ROUND_OFF,
              saw=f"With steps of {milliseconds} the velocity alternates by {swing:.6f} m/s without end.")
        check("As an impulse, limited to the remaining momentum, friction stops the block.",
              f"speed at rest, sliding steps of {milliseconds} [m/s]", law=0.0, found=rest, within=0.0,
              saw=f"With sliding steps of {milliseconds} the velocity at rest is {rest:g} m/s.")
        drawn = drawn or [series("friction as a force, Euler", ts, swung[:, 0], DOTS),
                          series("friction as an impulse, sliding", ts, stopped[:, 0], LINE)]
    return Picture(
        "A stop that does not come", "t [s]", "velocity [m/s]", drawn,
        "Friction as a force changes sign with the velocity, and thereby reverses the velocity at every step.")


@case("artificial-sliding", "Artificial sliding", compiled=False)
def artificial_sliding(lesson, check):
    """Measure artificial sliding: a particle that should stay at rest creeps at g sin θ dt.

    Each step moves it by dt² g sin θ and corrects it along the normal only.  Friction on positions, up to μ times the
    depth dt² g cos θ, removes all of this displacement while tan θ ≤ μ.
    """
    pull, mu = G * np.sin(np.radians(30.0)), 1.1 * np.tan(np.radians(30.0))
    creep = lambda method, dt: moved(lesson, method, 30.0, mu, mu, dt, 200) / (200 * dt)
    for dt in (0.04, 0.01, 0.001):
        crept, held, milliseconds = creep(CONTACT, dt), creep(GRIPPING, dt), f"{MILLIMETRES * dt:g} ms"
        check("Corrected along the normal only, a particle at rest creeps at g sin θ dt.",
              f"creep at 30°, contact steps of {milliseconds} [m/s]", law=pull * dt, found=crept, within=ROUND_OFF,
              saw=f"With steps of {milliseconds} a particle that should stay creeps at {MILLIMETRES * crept:.3f} mm/s.")
        check("Corrected along the tangent as well, it stays.", f"creep at 30°, gripping steps of {milliseconds} [m/s]",
              law=0.0, found=held, within=ROUND_OFF,
              saw=f"With the tangential correction it creeps at {abs(held):.0e} m/s.")
    dts, fine = np.linspace(0.002, 0.04, 12), np.linspace(0.0, 0.042, 50)
    return Picture(
        "Artificial sliding at 30°", "dt [s]", "creep [m/s]",
        [series("g sin θ dt, theory", fine, pull * fine, LINE),
         *(series(f"{method.label}, measured", dts, [creep(method, dt) for dt in dts], DOTS)
           for method in (CONTACT, GRIPPING))],
        "This creep vanishes as dt goes to zero, but it is present at every affordable step.")


LAUNCH, SLIPPERY = 3.0, 0.3              # of the block on two frictions: speed [m/s], μ [-]
FINE = 0.0005                            # its step [s]
STOPS = LAUNCH * LAUNCH / (2.0 * SLIPPERY * G)                                     # its distance on a cone [m]
BLURRED = (0.5 * LAUNCH * FINE + SLIPPERY * G * FINE * FINE / 8.0) / STOPS         # error of the steps over it


def goes(lesson, method, degrees):
    """Return the distance at which a block stops that is launched at an angle from x, over its distance on a cone."""
    block = make_block((0.0, 0.0, 1.0), SLIPPERY, SLIPPERY, (0.0, 0.0, -G), (0.0, 0.0, 0.0), 0.0)
    v = LAUNCH * np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees)), 0.0])
    x, _ = advanced(lesson, method, np.zeros(3), v, FINE, round(1.2 / FINE), block)
    return x[:2] / STOPS


@case("cone-vs-pyramid", "Cone and pyramid", compiled=False)
def cone_vs_pyramid(lesson, check):
    """Compare a friction pyramid along x and y with the cone, and with theory.

    A block launched at the angle φ goes √(cos⁴φ + sin⁴φ) times as far on the pyramid, and turns.  Each component of
    v is decelerated by μg until it is zero: x = v² cos²φ/2μg and y = v² sin²φ/2μg, so the block ends at the angle
    arctan tan²φ.  Summed at the end of each step, a component is short by ½ v_i dt and ahead by at most ⅛ μg dt²
    (scene stopping_block).
    """
    def ways(method, degrees, law, within, claim):
        got = np.linalg.norm(goes(lesson, method, degrees))
        check(claim, f"{method.label}: distance at {degrees:g}° over v²/2μg [-]", law=law, found=got, within=within,
              saw=f"At {degrees:g}° the {method.label} step goes {100.0 * got:.2f} % of the distance.")

    for degrees in (0.0, 22.5, 45.0):
        c, s = np.cos(np.radians(degrees)) ** 2, np.sin(np.radians(degrees)) ** 2
        ways(SLIDING, degrees, 1.0, BLURRED, "With the cone the block goes equally far in every direction.")
        ways(PYRAMID, degrees, np.hypot(c, s), np.sqrt(2.0) * BLURRED,
             "With the pyramid a diagonal slide stops after 1/√2 of the distance.")
    turned = np.degrees(np.arctan2(*goes(lesson, PYRAMID, 22.5)[::-1]))
    check("Between its axes a pyramid also deflects the path.", "pyramid: where a slide at 22.5° ends [°]",
          law=np.degrees(np.arctan(np.tan(np.radians(22.5)) ** 2)), found=turned, within=np.degrees(2.0 * BLURRED),
          saw=f"A block launched at 22.5° ends at {turned:.2f}°.")
    fine, dots = np.linspace(0.0, 90.0, 91), np.linspace(0.0, 90.0, 13)
    pyramid = np.sqrt(np.cos(np.radians(fine)) ** 4 + np.sin(np.radians(fine)) ** 4)
    return Picture(
        "Cone and pyramid", "heading [°]", "way over v²/2μg [-]",
        [series("cone, theory", fine, np.ones_like(fine), LINE), series("pyramid, theory", fine, pyramid, LINE),
         *(series(f"{method.label}, measured", dots, [np.linalg.norm(goes(lesson, method, phi)) for phi in dots], DOTS)
           for method in (SLIDING, PYRAMID))],
        "A floor with friction pyramids has a preferred direction like the grain of wood: a block goes farthest along "
        "it.")


@case("curved-wall-order", "Energy loss along a curved wall", compiled=False)
def curved_wall_order(lesson, check):
    """Compare the loss of speed along a curved wall with theory.

    A step along the tangent turns the wall by α, tan α = v dt/R.

    The bowl has neither friction nor gravity.  Only v cos α is left, so 1/v² grows by (dt/R)² per step and
    v_N = v₀/√(1 + N (v₀ dt/R)²).  Over a given time the loss is of first order in dt.
    """
    radius, speed = 0.5, 2.0
    p = ParticleInBowl(1.0, 0.0, 0.0, np.zeros(3), np.zeros(3), np.zeros(3), radius)
    law = lambda dt, t: speed / np.sqrt(1.0 + t / dt * (speed * dt / radius) ** 2)

    def left(dt, t):
        x, v = np.array([radius, 0.0, 0.0]), np.array([0.0, 0.6 * speed, 0.8 * speed])
        return np.linalg.norm(lesson.advance_particle(
            lesson.contact_step, lesson.falling_acceleration, lesson.particle_bowl_gap, 0.0, x, v, dt, round(t / dt),
            p)[1])

    for dt in (0.05, 0.01, 0.002):
        got, milliseconds = left(dt, 1.0), f"{MILLIMETRES * dt:g} ms"
        check("On a curved wall 1/v² grows by (dt/R)² per step: the method dissipates energy that the physics keeps.",
              f"speed left after 1 s, contact steps of {milliseconds} [m/s]",
              law=law(dt, 1.0), found=got, within=ROUND_OFF,
              saw=f"With steps of {milliseconds} a particle that should keep its 2 m/s has {got:.4f} m/s after one "
                  "second.")
    fine, dots, drawn = np.linspace(0.05, 4.0, 80), np.linspace(0.4, 4.0, 10), []
    for dt in (0.05, 0.01):
        drawn += [series(f"dt = {dt} s, theory", fine, law(dt, fine), LINE),
                  series(f"dt = {dt} s, measured", dots, [left(dt, t) for t in dots], DOTS)]
    return Picture(
        "What a round wall costs", "t [s]", "speed [m/s]", drawn,
        "No force slows this particle: the loss comes from the corners of the polygon that replaces the wall.")


# ---------------------------------------------------------------------------------------------- extreme coefficients

def calls_with_negative_friction(lesson):
    """Return {function: arguments} of every function that takes a μ, with μ = −0.3."""
    F, n, t_1, v, minus = np.array([1.0, -2.0]), np.array([0.0, 1.0]), np.array([1.0, 0.0]), np.array([1.0, -1.0]), -0.3
    step = (lesson.driven_acceleration, 0.0, STILL, STILL, 0.1, slope(10.0, 0.3, 0.3)._replace(mu_s=minus, mu_k=minus))
    return {
        "static_friction": (F, n, minus),
        "kinetic_friction": (F, v, n, minus),
        "incline_acceleration": (0.1, minus, minus, G),
        "friction_impulse": (v, 1.0, 1.0, minus),
        "pyramid_impulse": (v, 1.0, 1.0, minus, t_1, t_1),
        "particle_contact_impulse": (v, n, 1.0, 0.0, minus),
        "sliding_step": step,
        "event_step": step,
        "advance_particle": (lesson.contact_step, lesson.falling_acceleration, lesson.particle_plane_gap, 0.0, STILL,
                             STILL, 0.1, 1, particle(10.0, minus)),
    }


@case("extreme-coefficients", "Extreme friction", compiled=False)
def extreme_coefficients(lesson, check):
    """Check extremes: no friction, infinite friction, no load, a fast launch, and a negative μ, which is refused.

    A block with μ = ∞ holds at 89.9° and stops from 10⁶ m/s within one step.  With μ = 0 it slides with the
    acceleration g sin θ.
    """
    asked = calls_with_negative_friction(lesson)
    refused = sum(refuses(getattr(lesson, name), arguments, "-0.3") for name, arguments in asked.items())
    check("A negative coefficient of friction is refused, and the message gives its value.",
          "functions that name μ = −0.3 in their error [of 9]", law=len(asked), found=refused, within=0.0,
          saw=f"{refused} of {len(asked)} functions refuse μ = −0.3 with a message that contains it.")
    for method in (SLIDING, EVENT, GRIPPING):
        got = moved(lesson, method, 89.9, np.inf, np.inf)
        check("Infinite friction holds on any slope short of the vertical.",
              f"{method.label}: distance in one second at 89.9°, μ = ∞ [m]", law=0.0, found=got, within=WAY,
              saw=f"With μ = ∞ the {method.label} step moves {got:g} m at 89.9°.")
    for method in (SLIDING, GRIPPING):
        got = moved(lesson, method, 30.0, 0.0, 0.0, 0.02, 50)
        check("Without friction a block slides down with g sin θ.",
              f"{method.label}: distance in one second at 30°, μ = 0 [m]",
              law=0.5 * G * np.sin(np.radians(30.0)) * 50 * 0.02 * 51 * 0.02, found=got, within=ROUND_OFF,
              saw=f"With μ = 0 the {method.label} step goes {got:.6f} m, as symplectic Euler does: g sin θ t (t + dt)/"
                  "2.")
    _, v = advanced(lesson, SLIDING, STILL, np.array([1e6, 0.0]), 1e-3, 1, slope(0.0, np.inf, np.inf))
    check("Infinite friction stops a block within one step, and the result is finite.",
          "speed one step after 10⁶ m/s, μ = ∞ [m/s]", law=0.0, found=np.abs(v).max(), within=0.0,
          saw=f"One step after 10⁶ m/s on μ = ∞ the speed is {np.abs(v).max():g} m/s.")
    exponents, hit = np.linspace(-3.0, 6.0, 10), np.array([1.0, -1.0])
    impulses = [np.linalg.norm(lesson.particle_contact_impulse(10.0**y * hit, np.array([0.0, 1.0]), 1.0, 0.5, 0.4))
                for y in exponents]
    return Picture(
        "The same impact at any speed", "log₁₀ of the speed [m/s]", "impulse over m v [-]",
        [series("theory", exponents, np.full(10, 1.5 * np.hypot(1.0, 0.4)), LINE),
         series("contact, measured", exponents, impulses / 10.0**exponents, DOTS)],
        "From a millimetre to a thousand kilometres per second: Coulomb's law has no characteristic speed.")


# ---------------------------------------------------------------------------------------------- laws of friction

TRIED = 100                  # random configurations of each law; a law returns (got, truth) in one of them
AROUND = (0.5, 0.95, 1.05)   # of what friction can hold [-]


class Contact(NamedTuple):
    """A contact: its directions, and what presses, holds and slips there."""
    n: np.ndarray            # (3,) unit normal
    t_1: np.ndarray          # (3,) unit vector along the surface, and the other one
    t_2: np.ndarray
    m: float                 # mass [kg]
    load: float              # into the surface [N], or [m/s²] over the mass; negative: away from it
    F_N: float               # normal force of the surface
    mu_k: float
    mu_s: float
    slip: np.ndarray         # (3,) velocity along the surface [m/s]


def random_contact(rng):
    """Return a random Contact with μ_s above μ_k."""
    n, t_1, t_2 = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    m, load = rng.uniform(0.5, 2.0, 2) * (1.0, rng.choice((-1.0, 1.0)))
    mu_k, more = rng.uniform(0.1, 0.6, 2)
    return Contact(n, t_1, t_2, m, load, max(0.0, load), mu_k, mu_k + more, rng.normal() * t_1 + rng.normal() * t_2)


def length(y):
    """Return |y|."""
    return np.linalg.norm(y)


def nearest_in_disc(y, radius):
    """Return the point of the disc |y| ≤ radius that is nearest to y."""
    return y if length(y) <= radius else radius / length(y) * y


@random_law("A support pushes against a load, and does not hold a body that is pulled away.",
            "largest error of the normal force [N]", 1e-10)
def normal_forces(lesson, rng):
    c = random_contact(rng)
    return lesson.normal_force(c.slip - c.load * c.n, c.n), c.F_N


@random_law("Static friction holds to μ_s F_N, and equals that beyond.",
            "largest error of the static friction [N]", 1e-10)
def static_forces(lesson, rng):
    c = random_contact(rng)
    pull = rng.choice(AROUND) * c.mu_s * abs(c.load)
    F = lesson.static_friction(pull * c.t_1 - c.load * c.n, c.n, c.mu_s)
    return F, -min(pull, c.mu_s * c.F_N) * c.t_1


@random_law("Kinetic friction is μ_k F_N against the slip, at any speed.",
            "largest error of the kinetic friction [N]", 1e-10)
def kinetic_forces(lesson, rng):
    c = random_contact(rng)
    F = lesson.kinetic_friction(c.t_1 - c.load * c.n, c.slip + rng.normal() * c.n, c.n, c.mu_k)
    return F, -c.mu_k * c.F_N * c.slip / length(c.slip)


@random_law("The impulse of the cone is the nearest to what stops the slip.",
            "largest error of the impulse of the cone [N s]", 1e-10)
def impulses_of_the_cone(lesson, rng):
    c, j_n = random_contact(rng), rng.uniform(0.5, 2.0)
    mu = rng.choice(AROUND) * c.m * length(c.slip) / j_n
    return lesson.friction_impulse(c.slip, c.m, j_n, mu), nearest_in_disc(-c.m * c.slip, mu * j_n)


@random_law("The impulse of the pyramid is the nearest along each side.",
            "largest error of the impulse of the pyramid [N s]", 1e-10)
def impulses_of_the_pyramid(lesson, rng):
    c, j_n = random_contact(rng), rng.uniform(0.5, 2.0)
    mu = rng.choice(AROUND) * c.m * length(c.slip) / j_n
    side_1, side_2 = np.clip((-c.m * c.slip @ c.t_1, -c.m * c.slip @ c.t_2), -mu * j_n, mu * j_n)
    return lesson.pyramid_impulse(c.slip, c.m, j_n, mu, c.t_1, c.t_2), side_1 * c.t_1 + side_2 * c.t_2


@random_law("A block holds below tan θ = μ_s; above, it slides with the acceleration g (sin θ − μ_k cos θ).",
            "largest error of the acceleration [m/s²]", 1e-10)
def slopes(lesson, rng):
    c, g, steepness = random_contact(rng), rng.uniform(1.0, 20.0), rng.choice((0.99, 1.01))
    theta = np.arctan(steepness * c.mu_s)
    pull = g * np.cos(theta) * (np.tan(theta) - c.mu_k) if steepness > 1.0 else 0.0
    return lesson.incline_acceleration(theta, c.mu_s, c.mu_k, g), pull


@random_law("A block holds by μ_s, slides by μ_k, and is free if the load lifts it.",
            "largest error of the state of the block [m, m/s]", 1e-10)
def blocks(lesson, rng):
    """Pull a block along a plane; gravity presses it on the plane, or lifts it off."""
    c, dt, moving = random_contact(rng), rng.uniform(0.01, 0.1), rng.choice((0.0, 1.0))
    pull, start = rng.choice((0.99, 1.01)) * c.mu_s * abs(c.load), moving * c.slip
    free = start + dt * pull * c.t_1
    holds = not moving and pull <= c.mu_s * c.F_N
    end = 0.0 * free if holds else free + nearest_in_disc(-free, c.mu_k * dt * c.F_N)
    p = lesson.make_block(c.m * c.n, c.mu_s, c.mu_k, pull * c.t_1 - c.load * c.n, np.zeros(3), 1.0)
    return lesson.sliding_step(lesson.driven_acceleration, 0.0, c.t_2, start, dt, p), (c.t_2 + dt * end, end)


@random_law("A block on a pyramid slides by μ_k along each side.",
            "largest error of the state of the sliding block [m, m/s]", 1e-10)
def blocks_on_a_pyramid(lesson, rng):
    """Slide a block over a level floor, under a force that changes."""
    c, dt, t = random_contact(rng), rng.uniform(0.01, 0.1), rng.uniform()
    weight, swing, x, v = rng.normal(size=(4, 3))
    weight[2], v[2] = weight[2] - 5.0, 0.0
    a = weight + np.cos(3.0 * t) * swing
    free, side = (v + dt * a) * (1.0, 1.0, 0.0), c.mu_k * dt * max(0.0, -a[2])
    end = free + np.clip(-free, -side, side)
    p = lesson.make_block((0.0, 0.0, 1.0), c.mu_s, c.mu_k, weight, swing, 3.0)
    return lesson.pyramid_step(lesson.driven_acceleration, t, x, v, dt, p), (x + dt * end, end)


@random_law("With mean velocities a block under constant forces moves as Galileo says: x = x₀ + v₀ t + ½ a t².",
            "largest error of the state of the sliding block [m, m/s]", 1e-10)
def mean_velocities(lesson, rng):
    """Let a block slide along a straight line, pulled and braked, for three steps in which it does not stop."""
    c, x, dt, speed = random_contact(rng), rng.normal(size=3), rng.uniform(0.01, 0.05), rng.uniform(3.0, 4.0)
    c, pull = c._replace(load=rng.uniform(1.0, 5.0)), rng.normal()
    p, state = block_at(lesson, c, pull), (x, speed * c.t_1)
    for _ in range(3):
        state = lesson.average_sliding_step(lesson.driven_acceleration, 0.0, *state, dt, p)
    a, t = pull - c.mu_k * c.load, 3.0 * dt
    return state, (x + (speed * t + 0.5 * a * t * t) * c.t_1, (speed + a * t) * c.t_1)


@random_law("The normal of a bowl and of a trough is the derivative of the distance.",
            "largest error of the distance and normal [m, -]", 1e-10)
def hollows(lesson, rng):
    """Compare the distance to the wall of a bowl, or of a trough along a tilted axis, with its derivative."""
    centre, x, radius = rng.normal(size=3), rng.normal(size=3), rng.uniform(3.0, 5.0)
    axis = rng.choice((0.0, 1.0)) * random_contact(rng).t_1

    def distance(x):
        r = x - centre - ((x - centre) @ axis) * axis
        return radius - np.sqrt(np.sum(r * r))

    slope_of = np.array([distance(x + 1e-20j * e).imag for e in np.eye(3)]) / 1e-20
    p = ParticleInBowl(1.0, 0.0, 0.5, np.zeros(3), centre, axis, radius)
    return tuple(lesson.particle_bowl_gap(x, p)), (distance(x), slope_of)


def random_hit(rng):
    """Return (Contact, velocity, fall, record, dt) of a particle that hits a plane with m, e and μ.

    μ is up to 10⁴ where it hits slowly, which costs four digits.
    """
    c, e, fall = random_contact(rng), rng.uniform(0.1, 0.9), 10.0 ** rng.uniform(-4.0, 0.0)
    mu = rng.choice(AROUND) * length(c.slip) / ((1.0 + e) * fall)
    p = ParticleOnPlane(c.m, mu, e, np.zeros(3), rng.normal(size=3), c.n)
    return c, c.slip - fall * c.n, fall, p, rng.uniform(0.01, 0.1)


@random_law("A particle rebounds with e, and keeps the slip that the impulse μ (1 + e) leaves.",
            "largest error of the velocity of the particle [m/s]", 1e-10)
def rebounds(lesson, rng):
    """Let friction use the whole normal impulse, rebound included."""
    c, v, fall, p, dt = random_hit(rng)
    after = c.slip + nearest_in_disc(-c.slip, p.mu * (1.0 + p.e) * fall) + p.e * fall * c.n
    J = lesson.particle_contact_impulse(v, c.n, c.m, p.e, p.mu)
    _, stepped = lesson.contact_step(lesson.falling_acceleration, lesson.particle_plane_gap, 0.0, p.point, v, dt, p)
    return (v + J / c.m, stepped), (after, after)


@random_law("The correction of the position along the wall is at most μ times the depth.",
            "largest error of the position [m]", 1e-10)
def shifts(lesson, rng):
    c, v, fall, p, dt = random_hit(rng)
    shift = nearest_in_disc(-dt * c.slip, p.mu * dt * fall)
    correction = lesson.friction_position_correction(dt * v, c.n, dt * fall, p.mu)
    x, _ = lesson.position_friction_step(lesson.falling_acceleration, lesson.particle_plane_gap, 0.0, p.point, v, dt, p)
    return (correction, x), (shift, p.point + dt * c.slip + shift)


def particle_after(force, p, friction_of_positions, t, x, v, dt, steps):
    """Return (x, v) after steps of a particle on a plane: free, then out along the normal, rebound, and friction."""
    for k in range(steps):
        v = v + dt * force(t + k * dt)
        x, fall, slip = x + dt * v, -(v @ p.n), v - (v @ p.n) * p.n
        depth = -((x - p.point) @ p.n)
        if depth > 0.0:
            x = x + depth * p.n
            if fall > 0.0:
                v = slip + nearest_in_disc(-slip, p.mu * (1.0 + p.e) * fall) + p.e * fall * p.n
                x = x + friction_of_positions * nearest_in_disc(-dt * slip, p.mu * depth)
    return x, v


@random_law("Each step of a particle uses the force at its beginning.",
            "largest error of the state of the particle [m, m/s]", 1e-10)
def two_steps(lesson, rng):
    """Take two steps under a force that changes: inside on the way in, inside on the way out, or outside."""
    c, dt, t = random_contact(rng), rng.uniform(0.01, 0.1), rng.uniform()
    still, swing, point = rng.normal(size=(3, 3))
    force = lambda t: still + np.cos(3.0 * t) * swing
    gap, v_n = rng.choice(((-0.2, -1.5), (-0.4, 1.5), (0.3, -1.5)))
    x, v = point + c.slip + gap * c.n, c.slip + v_n * c.n
    p = ParticleOnPlane(c.m, c.mu_k, rng.uniform(0.1, 0.9), still, point, c.n)
    got = [lesson.advance_particle(step, lambda t, x, v, p: force(t), lesson.particle_plane_gap, t, x, v, dt, 2, p)
           for step in (lesson.contact_step, lesson.position_friction_step)]
    return tuple(got), tuple(particle_after(force, p, of_positions, t, x, v, dt, 2) for of_positions in (0.0, 1.0))


@case("laws-of-friction", "Laws of friction", compiled=False)
def laws_of_friction(lesson, check):
    """Check the cone, the pyramid, a slope, a block and a particle, with masses, restitution, and μ_s above μ_k."""
    check.laws(lesson, (normal_forces, static_forces, kinetic_forces, impulses_of_the_cone, impulses_of_the_pyramid,
                        slopes, blocks, mean_velocities, blocks_on_a_pyramid, hollows, rebounds, two_steps,
                        shifts),
               seed=31, times=TRIED)


# ---------------------------------------------------------------------------------------------- stops and starts

def sliding_contact(rng):
    """Return (Contact, speed, pull): a slip along t_1 on a plane with a load of 5 to 15 m/s², and a pull along it."""
    c, load = random_contact(rng), rng.uniform(5.0, 15.0)
    return c._replace(load=load, F_N=load), rng.uniform(0.5, 2.0), rng.uniform(-0.5, 0.9) * c.mu_k * load


def block_at(lesson, c, pull, drive=(0.0, 0.0, 0.0), omega=1.0):
    """Make a Block of the lesson: pull [m/s²] is along t_1, and a drive [m/s²] oscillates."""
    return lesson.make_block(c.n, c.mu_s, c.mu_k, pull * c.t_1 - c.load * c.n, drive, omega)


@random_law("Under constant forces a block stops completely after v/(μ_k a_n − a_t).",
            "time, place and velocity of a stop: largest error [s, m, m/s]", 1e-9)
def stops(lesson, rng):
    """Take a step of `share` of the time to the stop, at a constant deceleration."""
    c, speed, pull = sliding_contact(rng)
    share, brake = rng.choice((0.7, 2.0)), c.mu_k * c.load - pull
    dt, lasts = share * speed / brake, min(share, 1.0) * speed / brake
    end = max(0.0, speed - dt * brake)
    tau, x, v = lesson.advance_to_event(lesson.driven_acceleration, 0.0, np.zeros(3), speed * c.t_1, dt,
                                        block_at(lesson, c, pull))
    # the velocity after a stop is exactly zero: round-off would count as motion
    return (tau, np.any(v), x, v), (lasts, end > 0.0, 0.5 * (speed + end) * lasts * c.t_1, end * c.t_1)


def random_drive(c, rng):
    """Return (along [m/s²], press [m/s²], ω): −along sin ωt passes μ_s (load + press sin ωt) at ωt = π/6."""
    press = rng.uniform(0.1, 0.5) * c.load
    return 2.0 * c.mu_s * c.load + c.mu_s * press, press, rng.uniform(1.0, 3.0)


@random_law("A block breaks away where the force passes μ_s a_n, to the side of the force.",
            "time of a start: largest error [s]", 1e-9)
def starts(lesson, rng):
    """Let a block rest from a quarter of a period on, where the drive is zero."""
    c, _, _ = sliding_contact(rng)
    along, press, omega = random_drive(c, rng)
    sign, t, law = rng.choice((-1.0, 1.0)), 0.5 * np.pi / omega, lesson.driven_acceleration
    p = block_at(lesson, c, 0.0, sign * along * c.t_1 + press * c.n, omega)
    tau, x, _ = lesson.advance_to_event(law, t, c.n, np.zeros(3), 1.0 / omega, p)
    side = lesson.slip_direction(law, t + 1.01 * tau, c.n, np.zeros(3), p)
    return (tau, x, side), (np.pi / 6.0 / omega, c.n, -sign * c.t_1)


@random_law("Between events the motion of a block is that of the midpoint rule.",
            "state after a step: largest error [m, m/s]", 1e-9)
def midpoint_steps(lesson, rng):
    c, speed, _ = sliding_contact(rng)
    along, press, omega = random_drive(c, rng)
    dt, t = rng.uniform(0.05, 0.2), rng.uniform(0.0, 1.0)
    force = lambda t: (along + c.mu_k * press) * np.cos(omega * t) - c.mu_k * c.load
    p = block_at(lesson, c, 0.0, along * c.t_1 + press * c.n, omega)
    got = lesson.kinetic_friction_step(lesson.driven_acceleration, t, np.zeros(3), speed * c.t_1, dt, c.t_1, p)
    return got, (dt * (speed + 0.5 * dt * force(t)) * c.t_1, (speed + dt * force(t + 0.5 * dt)) * c.t_1)


@random_law("A block that static friction does not hold slides back at once, in a separate slip.",
            "times of slips: largest error [s]", 1e-9)
def slides_back(lesson, rng):
    """Let a pull stop a block and move it back; and let a block without load and pull stay."""
    c, speed, _ = sliding_contact(rng)
    t, law, still = rng.uniform(0.0, 1.0), lesson.driven_acceleration, np.zeros(3)
    after = speed / ((c.mu_k + 1.2 * c.mu_s) * c.load)
    back = block_at(lesson, c, -1.2 * c.mu_s * c.load)
    ours = lesson.slip_times(law, t, still, speed * c.t_1, 0.7 * after, 3, back)
    truth = np.array(((t, t + after), (t + after, t + 2.1 * after)))
    free = lesson.slip_direction(law, t, c.n, still, block_at(lesson, c._replace(load=0.0), 0.0))
    return (ours if ours.shape == truth.shape else np.nan * truth, free), (truth, still)


@case("times-of-stops-and-starts", "Times of stops and starts", compiled=False)
def stops_and_starts(lesson, check):
    """Compare the times of stops and starts with theory.

    Under constant forces a block stops after v/(μ_k a_n − a_t).  A periodic force breaks away where it passes μ_s a_n.
    A force that grows with time makes the speed nonlinear: the step under kinetic friction is then the midpoint rule.
    """
    check.laws(lesson, (stops, starts, slides_back, midpoint_steps), seed=32, times=TRIED // 2)


# ---------------------------------------------------------------------------------------------- predicted ways

@case("two-materials", "Ways over two materials, and a floor of one's own", compiled=False)
def two_materials(lesson, check):
    """Compare the predicted way with a run in time, and find out whether a floor of one's own stops a block.

    The run is exact on each material: its speed falls evenly, so that it crosses the strip at a root of a parabola.
    """
    width, near, far, g = 1.0, 0.5, 0.2, 9.81
    for v in (1.0, 3.0, 4.0, 8.0):
        crossing = v * v - 2.0 * near * g * width
        law = width + crossing / (2.0 * far * g) if crossing > 0.0 else v * v / (2.0 * near * g)
        found = lesson.sliding_distance(v, width, near, far, g)
        check("A block slides until friction has taken its energy.", f"way from {v:g} m/s [m]", law=law, found=found,
              within=1e-14 * law, saw=f"From {v:g} m/s the block slides {found:.4g} m.")
    v = np.array([1.8, 2.4])
    for _ in range(400):
        v = v + lesson.my_friction(v, 1.0, 0.01 * g, 0.3)
    check("A floor of one's own stops a block.", "speed 4 s after a throw at 3 m/s [m/s]", law=0.0,
          found=np.linalg.norm(v), within=1e-12, saw="The block is at rest.")
