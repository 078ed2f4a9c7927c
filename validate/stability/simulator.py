"""Safe speeds, growth on a turntable, rocking, flight, releases, forces, and the parts of the loop.

A case derives its prediction in its docstring; the measurement comes from the loops of the lesson.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from solutions.checks import Diverged
from solutions.support.events import release
from solutions.support.model import Body, HalfSpace, make_model
from solutions.support.shapes import polyhedron_of
from validate.reference.simulator import leaves_ball, leaves_platform, rocking, slides_on_ball
from validate.stability.case import (
    DOTS,
    LINE,
    Picture,
    bisect,
    case,
    matrix_of,
    random_law,
    random_quaternions,
    refuses,
    series,
    turned_by,
)

G = 9.81                     # [m/s²]
ROUND_OFF = 1e-12            # of numbers around 1 after a few hundred operations
UP, UPRIGHT = (0.0, 1.0, 0.0), (1.0, 0.0, 0.0, 0.0)      # a floor in the plane; no rotation
DISC = "contact_step_2d", "disc_bounds", "round_contacts"           # names of the step, the bounds and the contacts
BOX = "contact_step_2d", "box_bounds_2d", "box_contacts_2d"
BALL = "contact_step", "ball_bounds", "round_contacts"
CUBE = "contact_step", "box_bounds", "box_contacts"


def round_bodies(lesson, x, r, m, inertia, gravity, mu, sweeps, margin=0.01, angle=0.0):
    """Make (PileState, Bodies) of equal discs at x (n, 2), or of equal spheres at x (n, 3), above a floor."""
    x = np.array(x, float)
    n, d = x.shape
    half, floor = np.full((n, d), r), [(*np.eye(d)[-1], 0.0)]
    if d == 2:
        return lesson.make_bodies_2d(x, np.full(n, angle), m, inertia, half, floor, gravity, mu, sweeps, margin)
    return lesson.make_bodies(x, [UPRIGHT] * n, m, np.full((n, 3), inertia), half, floor, gravity, mu, sweeps, margin)


def advanced(lesson, shape, state, p, dt, steps, load=None, step=None):
    """Return the PileState after this number of steps of advance_contact."""
    usual, bounds, contacts = (getattr(lesson, name) for name in shape)
    return lesson.advance_contact(step or usual, load or lesson.weight, bounds, contacts, 0.0, state, dt, steps, p)


def stepped(lesson, shape, state, p, dt, steps):
    """Return the PileState after this number of steps, without the checks of advance_contact."""
    step, bounds, contacts = (getattr(lesson, name) for name in shape)
    for n in range(steps):
        state = step(lesson.weight, bounds, contacts, n * dt, state, dt, p)
    return state


def largest(*differences):
    """Return the largest size of all numbers in these arrays."""
    return np.max([np.max(np.abs(one)) for one in differences])


# ---------------------------------------------------------------------------------------------- speeds

def deepest(lesson, speed, margin, dt):
    """Return the largest depth [m] of a disc of 10 cm, over sixteen phases of a step, without gravity."""
    depths = []
    for k in range(16):
        height = 0.1 + (margin + (k + 0.5) / 16.0 * speed * dt)
        state, p = round_bodies(lesson, [(0.0, height)], 0.1, 1.0, 0.005, (0.0, 0.0), 0.0, 5, margin)
        state = state._replace(v=np.array([(0.0, -speed), (0.0, 0.0)]))
        depths.append(0.1 - stepped(lesson, DISC, state, p, dt, 4).x[0, 1])
    return np.max([0.0, *depths])


@case("margin-and-speed", "The fastest body that a margin stops", compiled=False)
def margin_and_speed(lesson, check):
    """Compare the speed at which a disc first penetrates, and its depth, with theory.

    A contact is detected when its gap is at most the margin, and a body moves by v dt in a step.  So contact is
    detected before the bodies touch if v dt is at most the margin.  A faster body may be v dt − margin deep when it
    is detected, and it stops there.  The worst of sixteen phases of the step is 1/32 of v dt below that bound.
    """
    dt, margins, edges = 0.01, (0.01, 0.02, 0.05), []
    for margin in margins:
        sinks = lambda v, margin=margin: deepest(lesson, v, margin, dt) > 1e-9
        edges.append(bisect(sinks, 0.5 * margin / dt, 4.0 * margin / dt))
        check("Contact is detected in time if the displacement in a step is at most the margin.",
              f"speed at which a disc first sinks in, margin {margin:g} m, dt 0.01 s [m/s]",
              law=margin / dt * 32.0 / 31.0, found=edges[-1], within=1e-4 * margin / dt,
              saw=f"With a margin of {margin:g} m the disc penetrates from {edges[-1]:.2f} m/s on.")
    for speed in (5.0, 8.0):
        deep = deepest(lesson, speed, 0.02, dt)
        check("A faster body is up to v dt − margin inside when it is detected, and stays there.",
              f"greatest depth at {speed:g} m/s, margin 0.02 m [m]",
              law=speed * dt - 0.02 - speed * dt / 32.0, found=deep, within=ROUND_OFF,
              saw=f"At {speed:g} m/s the disc is up to {1e3 * deep:.1f} mm deep.")
    return Picture("Which speeds are safe", "margin [m]", "speed at which a disc sinks in [m/s]", [
        series("theory, margin/dt", margins, np.array(margins) / dt, LINE), series("measured", margins, edges, DOTS)],
        "A contact that is detected a step ahead stops a body on the surface; a faster body stops inside.")


# ---------------------------------------------------------------------------------------------- a turntable

TABLE = np.array([0.0, 0.0, 2.0])                        # angular velocity of the table [rad/s]
RADIUS, MOMENT = 0.1, 0.004                              # of a ball of 1 kg on it [m], [kg m²]
PLACE_0, V_0 = np.array([0.6, 0.0, RADIUS]), np.array([0.0, 0.3, 0.0])        # of its centre at the start [m], [m/s]
OMEGA_0 = np.cross((0.0, 0.0, -RADIUS), np.cross(TABLE, PLACE_0) - V_0) / RADIUS**2     # it rolls [rad/s]


def speed_in_the_loop(lesson, dt, steps):
    """Return the speed [m/s] of the ball after this number of steps of the whole loop."""
    state, p = round_bodies(lesson, [PLACE_0], RADIUS, 1.0, MOMENT, (0.0, 0.0, -G), 10.0, 40, 0.02)
    state = state._replace(v=np.array([V_0, np.zeros(3)]), omega=np.array([OMEGA_0, TABLE]))
    return np.linalg.norm(stepped(lesson, BALL, state, p, dt, steps).v[0])


def speed_ahead(lesson, dt, steps):
    """Return the speed [m/s] of the ball if the floor's velocity is that at the end of the step."""
    still = lambda t, x, q, v, omega, ball: (np.zeros(3), np.zeros(3))
    ball = lesson.CarriedBall(1.0, np.full(3, MOMENT), RADIUS, 10.0, np.array((0.0, 0.0, -G)), np.zeros(3), np.zeros(3),
                              TABLE)
    now = PLACE_0, np.array(UPRIGHT), V_0, OMEGA_0
    for n in range(steps):
        now = lesson.carried_step(still, n * dt, *now, dt, ball)
    return np.linalg.norm(now[2])


@case("growth-on-a-turntable", "The spiral of a ball on a turntable", compiled=False)
def growth_on_a_turntable(lesson, check):
    """Compare the growth of the speed of a rolling ball, v̇ = w n × v with w = 2/7 Ω, with theory.

    The whole loop takes the floor's velocity at the old position: v ← v + w dt n × v of the step before, whose size
    grows by the root that is near 1 of  z² = z + i w dt:  |z|² = 1 + (w dt)² + O((w dt)⁴), so the logarithm of |v|
    grows by ½ w² dt per second.  One step ahead it is  z = 1 + i w dt (3/2 − 1/(2z)), with |z| = 1 + ¼ (w dt)⁴.
    The next order is a relative (w dt)² in the first, which is at most 2 % here.  A sweep halves the slip of a
    ball, so 40 sweeps leave nothing of it.
    """
    w, dts = 2.0 / 7.0 * TABLE[2], (0.02, 0.05, 0.1, 0.2)
    ratio = lambda speed, dt: np.divide(*(speed(lesson, dt, round(t / dt)) for t in (12.0, 2.0)))
    grown = [np.log(ratio(speed_in_the_loop, dt)) / 10.0 for dt in dts]
    for dt, growth in zip(dts, grown, strict=True):
        check("With the floor's velocity at the ball's old position, its speed grows by the fraction ½ (2Ω/7)² dt per "
              "second.",
              f"growth of ln |v| per second, dt = {dt:g} s, Ω = 2 rad/s [1/s]",
              law=0.5 * w * w * dt, found=growth, within=0.5 * w * w * dt * 2.0 * (w * dt) ** 2 + 1e-9,
              saw=f"With dt = {dt:g} s the speed grows by {100.0 * np.expm1(10.0 * growth):.2f} % in 10 s.")
    dt, ahead = dts[-1], ratio(speed_ahead, dts[-1])
    check("With the floor's velocity at the ball's new position, the growth is of the fourth order.",
          "growth of ln |v| per second, dt = 0.2 s, floor ahead [1/s]",
          law=0.25 * (w * dt) ** 4 / dt, found=np.log(ahead) / 10.0, within=0.1 * (w * dt) ** 4 / dt,
          saw=f"With dt = 0.2 s and the floor's velocity ahead it grows by {100.0 * (ahead - 1.0):.4f} % in 10 s.")
    fine = np.linspace(0.01, 0.2, 40)
    return Picture("A ball on a turntable", "dt [s]", "growth of ln |v| per second [1/s]", [
        series("theory, ½ (2Ω/7)² dt", fine, 0.5 * w * w * fine, LINE), series("the whole loop", dts, grown, DOTS)],
        "Taking the velocity of the floor from the wrong end of a step feeds energy into the ball.")


# ---------------------------------------------------------------------------------------------- rocking

def changes_of_corner(lesson, b, h, lean, T):
    """Return the ends [s] of the steps of 0.01 s in which a block of half sizes b and h changes its corner."""
    block = lesson.RockingBlock(1.0, b, h, (b * b + h * h) / 3.0, G)
    x, v, times = np.array([lean]), np.zeros(1), []
    for n in range(round(T / 0.01)):
        before = x[0]
        x, v = lesson.rocking_step(lesson.rk4_step, n * 0.01, x, v, 0.01, block)
        if before * x[0] < 0.0:
            times.append((n + 1) * 0.01)
    return times


@case("rocking-to-the-end", "The impacts of a rocking block", compiled=False)
def rocking_to_the_end(lesson, check):
    """Compare the times of all impacts of slender and stout blocks with theory; a block without lean stays at rest.

    Housner's ratio e = 1 − 1.5 sin²α per impact; the times are those of a pendulum about each corner, by DOP853.
    Runge–Kutta 4 with dt = 0.01 s leaves (P dt)⁴ P t/120 ≈ 1e-7 of the rate, and the time of a slow impact multiplies
    that by some ten.  A stout block has infinitely many impacts in a finite time, so these runs end before.
    """
    for b, h, T in ((0.02, 0.5, 1.0), (0.1, 0.5, 1.5), (0.2, 0.5, 1.0)):
        lean = 0.5 * np.arctan(b / h)
        expected = [0.01 * np.ceil(t / 0.01 - 1e-9) for t, _, _ in rocking(b, h, G, lean, T)[2]]
        times = changes_of_corner(lesson, b, h, lean, T)
        off = largest(np.subtract(times, expected)) if len(times) == len(expected) else np.inf
        check("A block changes its corner in the steps in which theory has its impacts.",
              f"largest difference of the ends of these steps, {b:g} m × {h:g} m, {len(expected)} impacts [s]",
              law=0.0, found=off, within=1e-9,
              saw=f"Impacts of a block of half sizes {b:g} m and {h:g} m in {T:g} s: {len(times)}.")
    block = lesson.RockingBlock(1.0, 0.1, 0.5, 0.26 / 3.0, G)
    x, v = lesson.advance_rocking(lesson.rk4_step, 0.0, np.zeros(1), np.zeros(1), 0.01, 100, block)
    check("An upright block does not move.", "lean and rate after 1 s [rad, rad/s]", law=0.0, found=largest(x, v),
          within=ROUND_OFF, saw=f"It leans by {abs(x[0]):.0e} rad.")
    refusals(lesson, check)
    widths = np.linspace(0.01, 0.4, 40)
    ratios = [lesson.corner_impact(np.array([0.5, -b]), -1.0, np.array([b, -0.5]), 1.0, 3.0 / (b * b + 0.25))[1] / -1.0
              for b in widths[::4]]
    return Picture("What an impact leaves", "half width of a block of half height 0.5 m [m]",
                   "rate after over before [-]", [
                       series("theory, 1 − 1.5 sin²α", widths, 1.0 - 1.5 * np.sin(np.arctan(widths / 0.5)) ** 2, LINE),
                       series("corner_impact", widths[::4], ratios, DOTS)],
                   "A slender block loses very little at each impact and rocks for a long time; a cube keeps "
                   "a quarter of its rate.")


def refusals(lesson, check):
    """Make calls with invalid bodies and steps."""
    def made(**more):
        given = {"x": [(0.0, 0.5)], "q": [0.0], "m": 1.0, "inertia": 0.1, "half": [(0.5, 0.5)], "planes": [UP],
                 "gravity": (0.0, -G), "mu": 0.3, "sweeps": 10, "margin": 0.02, **more}
        return lesson.make_bodies_2d(*given.values())

    def moved(dt, **more):
        state, p = made()
        return advanced(lesson, DISC, state._replace(**more), p, dt, 3)
    asked = ((lambda: made(m=-1.0), "-1.0"), (lambda: made(m=0.0), "0.0"), (lambda: made(inertia=np.nan), "nan"),
             (lambda: made(half=[(0.5, 0.0)]), "0.0"), (lambda: made(planes=[(0.0, 2.0, 0.0)]), "2.0"),
             (lambda: made(mu=-0.3), "-0.3"), (lambda: made(sweeps=0), "0"), (lambda: made(margin=0.0), "0.0"),
             (lambda: made(x=[(np.inf, 0.5)]), "inf"), (lambda: moved(0.0), "0.0"), (lambda: moved(-0.01), "-0.01"),
             (lambda: moved(0.01, v=np.full((2, 2), np.nan)), "nan"), (lambda: moved(0.01, v=np.zeros((3, 2))), "3"))
    check.count("Masses, sizes, margins and steps of zero, normals without a length, and values that are not numbers "
                "are "
                "refused, with their value.", "calls that name the value in their error",
                sum(refuses(call, (), value) for call, value in asked), len(asked),
                "such calls end in a sentence that names the value.")


# ---------------------------------------------------------------------------------------------- flight

FLIGHT = 1.2                 # [s]
V_FLYER = np.array([(1.0, 2.0, -0.5)])                   # of one body in space [m/s]


def flown(lesson, step, state, p, v, omega, dt, T=FLIGHT):
    """Return (x, q, v, ω) after a flight under gravity."""
    return lesson.advance_free(step, lesson.weight, 0.0, state.x, state.q, v, omega, dt, round(T / dt), p)


def flyer(lesson):
    """Make (PileState, Bodies) of a body of 2 kg with three moments of inertia in space."""
    return lesson.make_bodies([(0.5, -0.2, 0.3)], [UPRIGHT], 2.0, [(1.0, 2.0, 3.0)], np.ones((1, 3)), np.zeros((0, 4)),
                              (0.0, 0.0, -G), 0.0, 1, 0.01)


@case("flight-and-its-invariants", "Invariants of a flight", compiled=False)
def flight_and_its_invariants(lesson, check):
    """Check bodies in flight: parabolas that lag by half a step, constant momenta, energy that only a source raises.

    Symplectic Euler falls ½ g T (T + dt).  A free body that rotates about a principal axis by 2 atan(½ ω dt) per step
    keeps ω.  L of a tumbling body drifts by O(dt): half the step leaves half of it, up to a few per cent.
    A ball of 2 kg that jumps by 0.3 m without a cause gains 2 g · 0.3 J, independent of earlier losses.
    """
    dts = (0.1, 0.05, 0.025)
    falls = [thrown(lesson, check, dt) for dt in dts]
    invariants_of_one_body(lesson, check)
    drift_of_a_tumbling_body(lesson, check)
    spin_about_a_principal_axis(lesson, check)
    gains_and_comparisons(lesson, check)
    return Picture("How far a body falls in 1.2 s", "dt [s]", "fall [m]", [
        series("theory, ½ g T (T + dt)", dts, 0.5 * G * FLIGHT * (FLIGHT + np.array(dts)), LINE),
        series("measured", dts, falls, DOTS)],
        "Moving with the new velocity makes a fall too deep by exactly ½ g T dt, for any step.")


def thrown(lesson, check, dt):
    """Throw two bodies in the plane; return their distance below the straight line [m]."""
    state, p = lesson.make_bodies_2d([(0.0, 1.0), (1.0, 2.0)], [0.1, 0.2], [1.0, 3.0], 0.2, np.full((2, 2), 0.1),
                                     np.zeros((0, 3)), (0.0, -G), 0.0, 1, 0.01)
    v, omega = np.array([(1.0, 2.0), (-2.0, 0.5)]), np.array([3.0, -2.0])
    x, q, _, _ = flown(lesson, lesson.free_step_2d, state, p, v, omega, dt)
    aside = x - state.x - FLIGHT * v
    check.agree("Thrown bodies fall ½ g T (T + dt) and turn by ω T.",
                f"error of places and angles, dt = {dt:g} s [m, rad]",
                largest(aside + np.array([0.0, 0.5 * G * FLIGHT * (FLIGHT + dt)]), q - state.q - FLIGHT * omega),
                ROUND_OFF)
    return largest(aside)


def invariants_of_one_body(lesson, check):
    """Compare energy and momenta of a body with those computed by hand."""
    state, p = flyer(lesson)
    spin = np.array([(0.0, 0.0, 1.5)])
    energy = 0.5 * 2.0 * 5.25 + 0.5 * 3.0 * 2.25 + 2.0 * G * 0.3
    P, L = lesson.momenta(state.x, state.q, V_FLYER, spin, p)
    by_hand = 2.0 * np.cross(state.x[0], V_FLYER[0]) + np.array([0.0, 0.0, 4.5])
    check.agree("Energy and momenta of one body are those found by hand.", "error [J, kg m/s, kg m²/s]",
                largest(lesson.mechanical_energy(state.x, state.q, V_FLYER, spin, p) - energy, P - 2.0 * V_FLYER[0],
                        L - by_hand), ROUND_OFF)


def drift_of_a_tumbling_body(lesson, check):
    """Let a body tumble without gravity, with two steps."""
    state, p = flyer(lesson)
    still, omega, drifts = p._replace(gravity=np.zeros(3)), np.array([(0.1, 1.0, 0.2)]), []
    for dt in (0.01, 0.005):
        end = flown(lesson, lesson.free_step, state, still, V_FLYER, omega, dt, 2.0)
        _, before = lesson.momenta(state.x, state.q, V_FLYER, omega, still)
        drifts.append(np.linalg.norm(lesson.momenta(*end, still)[1] - before))
    check("The explicit gyroscopic term lets L drift in proportion to the step.",
          "drift of L with half the step over that with the whole one [-]",
          law=0.5, found=drifts[1] / drifts[0], within=0.03,
          saw=f"In 2 s L drifts by {drifts[0]:.1e} kg m²/s with 0.01 s and by {drifts[1]:.1e} with half of that.")


def spin_about_a_principal_axis(lesson, check):
    """Let a body fall that spins about its third axis."""
    state, p = flyer(lesson)
    spin, dt = np.array([(0.0, 0.0, 1.5)]), 0.1
    x, q, _, _ = flown(lesson, lesson.free_step, state, p, V_FLYER, spin, dt)
    turned, fall = 12 * np.arctan(0.5 * 1.5 * dt), 0.5 * G * FLIGHT * (FLIGHT + dt)
    check.agree("A body that spins about a principal axis turns by 2 atan(½ ω dt) per step.",
                "error of its quaternion and place [-, m]",
                largest(q[0] - (np.cos(turned), 0.0, 0.0, np.sin(turned)),
                        x - state.x - FLIGHT * V_FLYER + (0.0, 0.0, fall)), ROUND_OFF)


def gains_and_comparisons(lesson, check):
    """Look for a jump without a cause in the energies of a ball, and compare two runs by a clock that is set."""
    heights, now = np.array([1.0, 0.8, 0.5, 0.8, 0.6, 0.7]), [0.0]
    check.agree("A jump without a cause is detected, and work explains it.", "error of the gains [J]",
                largest(lesson.gain_without_source(2.0 * G * heights, np.zeros(6)) - 0.6 * G,
                        lesson.gain_without_source(2.0 * G * heights, 2.0 * G * heights)), ROUND_OFF)

    def takes(seconds, result):
        now[0] += seconds
        return result
    difference, ratio = lesson.compare(lambda: takes(3.0, heights), lambda: takes(0.5, heights + 0.01), 3,
                                       lambda: now[0])
    check.agree("Two runs are compared by difference and by time.", "error of 0.01 m and of 6 [m, -]",
                largest(difference - 0.01, ratio - 6.0), ROUND_OFF)


# ---------------------------------------------------------------------------------------------- the parts of the loop

TRIED = 30                   # random bodies and loads [-]
SIDES = np.array([(0.0, 1.0), (0.0, -1.0), (1.0, 0.0), (-1.0, 0.0)])  # normals of a floor, a ceiling and two walls
MOVES = np.array([1.0, 1.0, 0.0])                        # the third body is the floor, which nothing moves


def random_times(rng):
    """Return (t, dt) [s]."""
    return rng.uniform(0.0, 1.0), rng.uniform(0.01, 0.1)


def loaded_in_the_plane(lesson, rng):
    """Return (PileState, Bodies, load, v̇, ω̇) of two bodies and a floor; the load is F cos t and τ sin t."""
    m, inertia, g = rng.uniform(0.5, 2.0, 2), rng.uniform(0.1, 0.5, 2), rng.normal(size=2)
    F, tau = rng.normal(size=(3, 2)), rng.normal(size=3)
    state, p = lesson.make_bodies_2d(rng.normal(size=(2, 2)), rng.normal(size=2), m, inertia, np.full((2, 2), 0.1),
                                     [UP], g, 0.3, 1, 0.01)
    state = state._replace(v=rng.normal(size=(3, 2)) * MOVES[:, None], omega=rng.normal(size=3) * MOVES)
    load = lambda t, x, q, v, omega, p: (np.cos(t) * F, np.sin(t) * tau)
    return state, p, load, np.append(1.0 / m, 0.0)[:, None] * F, np.append(1.0 / inertia, 0.0) * tau


@random_law("In the plane v changes by F/m and ω by τ/I, and positions use the new velocities.",
            "plane: largest error of the state [m, m/s, rad/s]", 1e-9)
def step_in_the_plane(lesson, rng):
    state, p, load, a, alpha = loaded_in_the_plane(lesson, rng)
    t, dt = random_times(rng)
    v, omega = state.v + dt * np.cos(t) * a, state.omega + dt * np.sin(t) * alpha
    got = lesson.free_step_2d(load, t, state.x, state.q, state.v, state.omega, dt, p)
    return got, (state.x + dt * v, state.q + dt * omega, v, omega)


@random_law("Each step uses the load at its own time.",
            "times: largest error of the velocity after five steps [m/s]", 1e-9)
def times_of_loads(lesson, rng):
    state, p, load, a, _ = loaded_in_the_plane(lesson, rng)
    t, dt = random_times(rng)
    free = lesson.advance_free(lesson.free_step_2d, load, t, *state[:4], dt, 5, p)
    alone = p._replace(planes=np.zeros((0, 3)), half=np.full((3, 2), 1e-6))            # small: they meet nothing
    state = state._replace(contacts=state.contacts._replace(first=np.zeros(4, np.int64)))
    met = lesson.advance_contact(lesson.contact_step_2d, load, lesson.disc_bounds, lesson.round_contacts, t, state, dt,
                                 5, alone)
    v = state.v + dt * a * sum(np.cos(t + k * dt) for k in range(5))
    return (free[2], met.v), (v, v)


def tumbling(lesson, rng):
    """Return (PileState, Bodies, inverse masses, world tensors, bodies that rotate) of two bodies and a floor in space.

    The second body is free, on an axle, which no force moves, or cannot be rotated.
    """
    m, moments, q = rng.uniform(0.5, 2.0, 2), rng.uniform(1.0, 1.9, (2, 3)), random_quaternions(rng, 2)
    state, p = lesson.make_bodies(rng.normal(size=(2, 3)), q, m, moments, np.full((2, 3), 0.1), [(0.0, *UP)],
                                  rng.normal(size=3), 0.3, 1, 0.01)
    moves, turns = rng.choice(((1.0, 1.0), (0.0, 1.0), (1.0, 0.0)))
    w, turns = np.array([1.0, moves, 0.0]) / np.append(m, 1.0), np.array([1.0, turns])
    p.inv_mass[1], p.inv_inertia[1] = w[1], turns[1] * p.inv_inertia[1]
    v, omega = rng.normal(size=(2, 3, 3)) * MOVES[:, None]
    state = state._replace(v=10.0 ** rng.uniform(-2.0, 2.0) * v, omega=omega)
    return state, p, w, [matrix_of(q[i]) @ np.diag(moments[i]) @ matrix_of(q[i]).T for i in range(2)], turns


def step_in_space(lesson, rng):
    """Return (start, state after a step, the same by Euler's equation for each body without the rotations, dt)."""
    state, p, w, tensors, turns = tumbling(lesson, rng)
    t, dt = random_times(rng)
    F, tau = rng.normal(size=(2, 3, 3))
    load = lambda t, x, q, v, omega, p: (np.cos(t) * F, np.sin(t) * tau)
    v, omega = state.v + dt * w[:, None] * np.cos(t) * F, 1.0 * state.omega
    for i, I in enumerate(tensors):
        torque = np.sin(t) * tau[i] - np.cross(omega[i], I @ omega[i])
        omega[i] += dt * turns[i] * np.linalg.solve(I, torque)
    return state, lesson.free_step(load, t, *state[:4], dt, p), (state.x + dt * v, v, omega), dt


@random_law("In space ω changes by Euler's equation, for each body by its own tensor.",
            "space: largest error of the state [m, m/s, rad/s]", 1e-9)
def velocities_in_space(lesson, rng):
    _, (x, _, v, omega), truth, _ = step_in_space(lesson, rng)
    return (x, v, omega), truth


@random_law("A body rotates by 2 atan(½ |ω| dt) about its own new ω.", "turn: largest error of the orientation [-]",
            1e-9)
def rotations_in_space(lesson, rng):
    start, end, (_, _, omega), dt = step_in_space(lesson, rng)
    return (tuple(matrix_of(end[1][i]) for i in range(2)),
            tuple(turned_by(omega[i], dt) @ matrix_of(start.q[i]) for i in range(2)))


@random_law("Energy and momenta equal those by matrices, without the immovable bodies.",
            "invariants: largest error of the invariants [J, kg m²/s]", 1e-9)
def invariants(lesson, rng):
    state, p, w, tensors, turns = tumbling(lesson, rng)
    energy, P, L, size = 0.0, np.zeros(3), np.zeros(3), 1.0 + np.max(np.abs(state.v)) ** 2
    for i in np.flatnonzero(w):
        x, v, omega, m, I = state.x[i], state.v[i], state.omega[i], 1.0 / w[i], turns[i] * tensors[i]
        energy += 0.5 * m * v @ v + 0.5 * omega @ I @ omega - m * p.gravity @ x
        P, L = P + m * v, L + m * np.cross(x, v) + I @ omega
    got = lesson.mechanical_energy(*state[:4], p), *lesson.momenta(*state[:4], p)
    return tuple(one / size for one in got), (energy / size, P / size, L / size)


@random_law("A gain is counted from any time on, without the work of supports; a difference is counted in both "
            "directions.",
            "gain: largest error of the gain and difference [J]", 1e-9)
def gains_and_differences(lesson, rng):
    energies, work = rng.normal(size=(2, 6))
    rest, now = energies - work, np.zeros(1)
    gain = np.max([rest[k] - rest[j] for k in range(6) for j in range(k + 1)])
    # the second run is ahead by 0.5, 1.5 and 1 J, and is 2, 3 and 9 times as fast
    ends = iter((rest, rest + 0.5, rest, rest + 1.5, rest, rest + 1.0))
    lengths = iter((2.0, 1.0, 3.0, 1.0, 9.0, 1.0))

    def run():
        now[0] += next(lengths)                                  # the clock stands still between the runs
        return next(ends)
    return (lesson.gain_without_source(energies, work), *lesson.compare(run, run, 3, now.item)), (gain, 1.5, 3.0)


@random_law("Contacts are detected up to the margin, and may close in one step.",
            "found: largest error of the contacts and speeds [-, m/s]", 1e-9)
def contacts_at_the_margin(lesson, rng):
    counts, n, dt = [], rng.choice(SIDES), rng.uniform(0.01, 0.1)
    along = np.array([-n[1], n[0]])
    for gap in (0.9 * 0.05, 1.1 * 0.05):
        x = [(0.1 + gap) * n, (0.1 + gap) * n + (0.2 + gap) * along]
        state, p = lesson.make_bodies_2d(x, np.zeros(2), 1.0, 1.0, np.full((2, 2), 0.1), [(*n, 0.0)], (0.0, 0.0), 0.0,
                                         1, 0.05)
        low, high, turn = lesson.disc_bounds(state.x, state.q, p.half)
        counts.append(lesson.find_contacts(lesson.round_contacts, state.x, low, high, turn, p).a.size)
    return (*counts, lesson.closing_speeds(np.array([0.02, -0.01]), dt)), (3.0, 0.0, np.array([-0.02 / dt, 0.0]))


def tilted_box(rng, d):
    """Return (orientation, axes, half sizes, lever arm of the lowest corner) of a box.

    The next corner is 2 cm higher.
    """
    half = np.array([0.3, 0.2, 0.1][:d])
    corners = np.stack(np.meshgrid(*[(-1.0, 1.0)] * d), axis=-1).reshape(-1, d) * half
    while True:
        angle, q = rng.uniform(0.2, 1.3), random_quaternions(rng, 1)[0]
        q = q if d == 3 else np.array([np.cos(0.5 * angle), 0.0, 0.0, np.sin(0.5 * angle)])
        axes = matrix_of(q)[:d, :d]
        lowest, second = sorted(corners @ axes.T, key=lambda corner: corner[-1])[:2]
        if second[-1] > lowest[-1] + 0.02:
            return q if d == 3 else angle, axes, half, lowest


def landing(lesson, rng, d):
    """Return the state of a box that has landed on a corner, and the same by the impulse at this corner.

    The corner stops at the floor or closes its gap.
    """
    q, axes, half, lowest = tilted_box(rng, d)
    m, moments, dt = rng.uniform(0.5, 2.0), rng.uniform(0.3, 0.5, 2 * d - 3), rng.uniform(0.01, 0.1)
    ahead, fall = rng.choice((0.0, 0.004)), -rng.uniform(1.0, 2.0)
    n = np.eye(d)[-1]
    place = np.append(np.full(d - 1, 0.5), ahead - lowest[-1])
    make = lesson.make_bodies_2d if d == 2 else lesson.make_bodies
    state, p = make([place], [q], m, moments if d == 2 else [moments], [half], [(*n, 0.0)], np.zeros(d), 0.0, 1, 0.01)
    v = 0.3 * np.eye(d)[0] + fall * n
    state = state._replace(v=np.array([v, 0.0 * v]))
    end = stepped(lesson, BOX if d == 2 else CUBE, state, p, dt, 1)

    r = lowest - 0.5 * ahead * n
    lever = r[:1] if d == 2 else axes.T @ np.cross(r, n)                 # in the body's coordinates
    j = (-ahead / dt - fall) / (1.0 / m + np.sum(lever**2 / moments))
    v, spin = v + j / m * n, lever * j / moments if d == 2 else axes @ (lever * j / moments)
    got, turned = (end.q[0], q + dt * spin) if d == 2 else (matrix_of(end.q[0]), turned_by(spin, dt) @ axes)
    return (end.x[0], got, end.v[0], end.omega[0], end.J), (place + dt * v, turned, v, spin, j * n)


@random_law("The corner on which a box lands stops there, or closes its gap.",
            "corner of a box: largest error of the state and impulse [m, m/s, rad/s, N s]", 1e-9)
def landings(lesson, rng):
    flat, spatial = landing(lesson, rng, 2), landing(lesson, rng, 3)
    return flat[0] + spatial[0], flat[1] + spatial[1]


@random_law("The stop of a corner conserves the angular momentum about it.",
            "corner: largest error of the velocity and momentum [m/s, kg m²/s]", 1e-9)
def corner_that_stops(lesson, rng):
    v, r = rng.normal(size=(2, 2))
    omega, inv_mass, inv_inertia = rng.normal(), rng.uniform(0.5, 2.0), 3.0
    about = lambda v, omega: omega / inv_inertia - (r[0] * v[1] - r[1] * v[0]) / inv_mass
    v_new, omega_new = lesson.corner_impact(v, omega, r, inv_mass, inv_inertia)
    return (v_new + omega_new * np.array([-r[1], r[0]]), about(v_new, omega_new)), (np.zeros(2), about(v, omega))


def slipping(lesson, rng, slope):
    """Return (RollingBall, v, ω, time of its slip) of a ball that slips down or up a slope."""
    m, radius, mu, I = rng.uniform((0.5, 0.1, 0.2, 0.01), (2.0, 0.5, 0.5, 0.1))
    angle, omega, r = rng.uniform(0.0, 6.28), rng.normal(size=3), np.array([0.0, 0.0, -radius])
    along = np.array([np.cos(angle), np.sin(angle), 0.0])
    ball = lesson.RollingBall(m, np.full(3, I), radius, mu, slope * along - [0.0, 0.0, G])
    v = rng.uniform(0.5, 2.0) * along - np.cross(omega, r) * [1.0, 1.0, 0.0] + [0.0, 0.0, rng.normal()]
    friction = -mu * m * G * along
    slows = -(friction / m + slope * along + np.cross(np.cross(r, friction) / I, r)) @ along
    return ball, v, omega, np.linalg.norm((v + np.cross(omega, r))[:2]) / slows if slows > 0.0 else np.inf


@random_law("A slip ends when friction and gravity have stopped it.", "slip: largest error of the time [s]", 1e-9)
def end_of_slip(lesson, rng):
    ball, v, omega, end = slipping(lesson, rng, rng.choice((60.0, rng.uniform(-0.5, 0.5))))
    return lesson.slip_time(v, omega, ball), end


@random_law("A ball rolls as soon as its slip has ended: loads are those of both times.",
            "parts: largest error of the times of loads [s]", 1e-9)
def loads_of_a_slip(lesson, rng):
    ball, v, omega, end = slipping(lesson, rng, rng.uniform(-0.5, 0.5))
    t, seen = rng.uniform(0.0, 1.0), []

    def load(t, x, q, v, omega, p):
        seen.append(t)
        return p.m * p.gravity, np.zeros(3)
    lesson.exact_rolling_step(load, t, rng.normal(size=3), np.array(UPRIGHT), v, omega, 2.0 * end, ball)
    return (np.min(seen), np.max(seen)), (t, t + end)


@random_law("A floor that travels and turns has the velocity of each of its points.",
            "floor: largest error of the velocity of a floor [m/s]", 1e-9)
def moving_floor(lesson, rng):
    centre, v, omega, place = rng.normal(size=(4, 3))
    floor = lesson.CarriedBall(1.0, np.ones(3), 0.1, 0.5, np.array([0.0, 0.0, -G]), centre, v, omega)
    return lesson.support_velocity(place, floor), v + np.cross(omega, place - centre)


@case("loop-by-parts", "The parts of the loop", compiled=False)
def loop_by_parts(lesson, check):
    """Check steps of two unequal bodies and an immovable one, rotated and tumbling, under loads that depend on time.

    The loads have torques.  In space the second body is alternately free, on an axle, which no force moves, or
    cannot be rotated.  Euler's equation in world coordinates is ω̇ = I⁻¹ (τ − ω × I ω), with I = R diag Rᵀ as
    matrices.
    """
    check.laws(lesson, (step_in_the_plane, velocities_in_space, rotations_in_space, times_of_loads, invariants,
                        gains_and_differences, contacts_at_the_margin, landings, corner_that_stops, end_of_slip,
                        loads_of_a_slip, moving_floor), seed=10, times=TRIED)


# ---------------------------------------------------------------------------------------------- rolling

TILT, MASS, R, INERTIA = 0.3, 2.0, 0.4, 0.1              # of a slope [rad]; mass, radius and moment of what rolls on it
DOWN, INTO = G * np.sin(TILT), G * np.cos(TILT)          # parts of gravity along the slope and into it [m/s²]
ROLLING, ROLLING_DT = 12, 0.01                           # steps [-], [s]


def on_a_slope(lesson, d, mu):
    """Return the PileState of a disc or a sphere after twelve steps on a slope from rest."""
    gravity = DOWN * np.eye(d)[0] - INTO * np.eye(d)[-1]
    state, p = round_bodies(lesson, [R * np.eye(d)[-1]], R, MASS, INERTIA, gravity, mu, 3 if d == 2 else 60, angle=0.7)
    return advanced(lesson, DISC if d == 2 else BALL, state, p, ROLLING_DT, ROLLING)


def column_at_rest(lesson, d, n, steps):
    """Return (impulses of the contacts in rising order, largest velocity) over those of g dt, for stacked round bodies.

    There is one sweep per step.
    """
    heights, dt = R * (1.0 + 2.0 * np.arange(n)), 1e-4
    state, p = round_bodies(lesson, heights[:, None] * np.eye(d)[-1], R, MASS, INERTIA, -G * np.eye(d)[-1], 0.0, 1)
    end = advanced(lesson, DISC if d == 2 else BALL, state, p, dt, steps)
    return np.sort(np.abs(end.J[:, -1])) / (MASS * G * dt), largest(end.v) / (G * dt)


@case("rolling-by-contact", "One contact, step by step", compiled=False)
def rolling_by_contact(lesson, check):
    """Compare a disc and a sphere that roll down a slope with a = g sin θ/(1 + I/(m r²)).

    J_n = m g cos θ dt and J_t = −I a dt/r² per step.  In a round body normal and tangent are decoupled: in the
    plane one sweep is exact.  In space a sweep leaves half of the slip, because it counts both tangents.  The steps
    are those of symplectic Euler: after k of them v = k a dt and x = ½ k (k + 1) a dt².
    """
    rolls(lesson, check)
    slips(lesson, check)
    carried, speed = column_at_rest(lesson, 2, 3, 400)
    check.agree("With kept impulses one sweep per step carries a stack: 1, 2 and 3 weights.",
                "impulses under three discs over m g dt: largest error [-]", largest(carried - (1.0, 2.0, 3.0)), 1e-6)
    carried_in_space, speed_in_space = column_at_rest(lesson, 3, 2, 80)
    check.agree("The same holds in space, at rest.",
                "impulses under two spheres, and their speed, over those of g dt: largest error [-]",
                largest(carried_in_space - (1.0, 2.0), speed_in_space), 1e-6)
    turn_of_a_carried_ball(lesson, check)
    check.agree("The stack is at rest.", "speed of three discs over g dt [-]", speed, 1e-6)


def rolls(lesson, check):
    """Roll a disc and a sphere, and compare their states and impulses with theory."""
    dt, steps = ROLLING_DT, ROLLING
    a, k = DOWN / (1.0 + INERTIA / (MASS * R * R)), np.arange(steps + 1)
    way, push, pull = 0.5 * steps * (steps + 1) * a * dt * dt, MASS * INTO * dt, -INERTIA * a * dt / R**2
    v, omega = steps * a * dt, steps * a * dt / R
    end = on_a_slope(lesson, 2, 0.9)
    truth = way, R, 0.7 - way / R, v, 0.0, -omega, pull, push
    check.agree("A disc rolls down a slope at g sin θ/(1 + I/(m r²)), by the impulses of theory.",
                "disc: largest error of its state and impulse [m, rad, m/s, rad/s, N s]",
                largest(np.array((*end.x[0], end.q[0], *end.v[0], end.omega[0], *end.J[0])) - truth), ROUND_OFF)
    end = on_a_slope(lesson, 3, 0.9)
    turned = np.sum(np.arctan(0.5 * k * a * dt / R * dt))                # half of the angle, about y
    truth = (way, 0.0, R, np.cos(turned), 0.0, np.sin(turned), 0.0, v, 0.0, 0.0, 0.0, omega, 0.0, pull, 0.0, push)
    check.agree("A sphere does the same in space.",
                "sphere: largest error of its state and impulse [m, -, m/s, rad/s, N s]",
                largest(np.array((*end.x[0], *end.q[0], *end.v[0], *end.omega[0], *end.J[0])) - truth), ROUND_OFF)


def slips(lesson, check):
    """Let both slip with μ = 0.05: J_t = −μ J_n and a = g (sin θ − μ cos θ)."""
    t, mu = ROLLING * ROLLING_DT, 0.05
    disc, sphere = on_a_slope(lesson, 2, mu), on_a_slope(lesson, 3, mu)
    push = mu * MASS * INTO * ROLLING_DT
    truth = t * (DOWN - mu * INTO), ROLLING * R * push / INERTIA, push
    check.agree("With less friction both slip at g (sin θ − μ cos θ).",
                "slipping disc and sphere: largest error [m/s, rad/s, N s]",
                largest(np.array((sphere.v[0, 0], sphere.omega[0, 1], -sphere.J[0, 0])) - truth,
                        np.array((disc.v[0, 0], -disc.omega[0], -disc.J[0, 0])) - truth), ROUND_OFF)


def turn_of_a_carried_ball(lesson, check):
    """Roll a carried ball on a tilted floor at rest: it rotates by its displacement over its radius."""
    still = np.zeros(3)
    ball = lesson.CarriedBall(MASS, np.full(3, INERTIA), R, 0.9, np.array([DOWN, 0.0, -G]), still, still, still)
    now = np.array([0.0, 0.0, R]), np.array(UPRIGHT), np.zeros(3), np.zeros(3)
    for k in range(ROLLING):
        now = lesson.carried_step(lambda t, x, q, v, omega, p: (p.m * p.gravity, np.zeros(3)), k * ROLLING_DT, *now,
                                  ROLLING_DT, ball)
    half_turn = 0.5 * now[0][0] / R
    check.agree("A carried ball rotates by its displacement over its radius.",
                "quaternion after 12 steps: largest error [-]",
                largest(now[1] - (np.cos(half_turn), 0.0, np.sin(half_turn), 0.0)), ROUND_OFF)


# ---------------------------------------------------------------------------------------------- release

PUCK = (0.2, 1.0, 1.1)       # of a puck on a ball: angle at the start [rad], speed [m/s], distance of the centres [m]
STIFFNESS, DEPTH = 100.0, 0.3    # of the spring under a platform [N/m], below equilibrium at the start [m]
HEAVY, LIGHT = 1.0, 0.5      # masses of the platform and of the box on it [kg]


def puck_on_a_ball(lesson, ahead):
    """Return (load, shapes, PileState, Bodies) of a puck on a fixed disc, with its velocity at t = −ahead."""
    start, speed, R = PUCK
    angle, back = slides_on_ball(*PUCK, G, -ahead) if ahead > 0.0 else (start, speed)
    state, p = lesson.make_bodies_2d([(0.0, 0.0), (R * np.sin(start), R * np.cos(start))], np.zeros(2), [np.inf, 1.0],
                                     [np.inf, np.inf], [(1.0, 1.0), (0.1, 0.1)], [], (0.0, -G), 0.0, 10, 0.2)
    v = back * np.array([(0.0, 0.0), (np.cos(angle), -np.sin(angle))])
    return lesson.weight, (lesson.disc_bounds, lesson.round_contacts), state._replace(v=v), p


def box_on_a_spring(lesson, ahead):
    """Return the same for a box on a platform on a spring, initially at rest; the spring is unstretched at 0."""
    def load(t, x, q, v, omega, p):
        F, tau = lesson.weight(t, x, q, v, omega, p)
        F[0, 1] -= STIFFNESS * x[0, 1]
        return F, tau
    rate = np.sqrt(STIFFNESS / (HEAVY + LIGHT))
    low = -G / rate**2 - DEPTH
    state, p = lesson.make_bodies_2d([(0.0, low), (0.0, low + 0.15)], np.zeros(2), [HEAVY, LIGHT], [np.inf, np.inf],
                                     [(0.5, 0.1), (0.05, 0.05)], [], (0.0, -G), 0.0, 30, 0.2)
    v = np.array([(0.0, -DEPTH * rate * np.sin(rate * ahead))] * 2)
    return load, (lesson.box_bounds_2d, lesson.box_contacts_2d), state._replace(v=v), p


def pushed(lesson, step, scene, dt, ahead, seconds):
    """Return (times [s], forces [N] between bodies 0 and 1) of such a scene; `ahead` [steps] is the leapfrog start."""
    load, shapes, state, p = scene(lesson, ahead * dt)
    ts, states = lesson.contact_trajectory(step, load, *shapes, 0.0, state, dt, int(seconds / dt) + 8, p)
    return ts[:-1], lesson.normal_forces(states, 0, 1, dt)


class Held(NamedTuple):
    """A body on a support that releases it."""
    what: str                # as a sentence without its full stop
    scene: Callable          # (lesson, ahead [s]) → load, shapes, PileState, Bodies
    rate: float              # of the motion [1/s]
    a: float                 # acceleration along the motion at the start [m/s²]
    force: Callable          # (t [s]) → force of the support [N]
    time: Callable           # (more [m/s]) → time of release [s] if it begins faster by that


def supports():
    """Return the puck and the box, with their theories."""
    start, speed, R = PUCK
    rate = np.sqrt(STIFFNESS / (HEAVY + LIGHT))

    def on_the_ball(t):
        angle, v = slides_on_ball(*PUCK, G, t)
        return G * np.cos(angle) - v * v / R
    return (Held("a puck leaves a ball", puck_on_a_ball, np.sqrt(G / R), G * np.sin(start), on_the_ball,
                 lambda more: leaves_ball(start, speed + more, R, G)[0]),
            Held("a box leaves an oscillating platform", box_on_a_spring, rate, rate**2 * DEPTH,
                 lambda t: LIGHT * (G + rate**2 * DEPTH * np.cos(rate * t)),
                 lambda more: leaves_platform(DEPTH, more, rate, G)))


def about_release(lesson, check, held):
    """Find the release of one of them with three steps and both starts; return the curves."""
    what, T = held.what, held.time(0.0)
    run = lambda dt, ahead: pushed(lesson, lesson.contact_step_2d, held.scene, dt, ahead, T)
    dts = T / np.array([20.3, 40.6, 81.2])
    led, plain = (np.array([release(*run(dt, ahead)) for dt in dts]) for ahead in (0.5, 0.0))
    order, best = np.log2((led[1] - T) / (led[2] - T)), (4.0 * led[2] - led[1]) / 3.0
    dt, small, force = dts[2], held.rate * dts[1:], run(dts[2], 0.5)[1][2]
    check("J/dt is the force of the support at the beginning of the step.",
          f"third force in the run in which {what} [N]", law=held.force(2.0 * dt), found=force,
          within=small[1] ** 2 * force, saw=f"The third force is {force:.4f} N.")
    check("The impulses of the steps give the time of release with order 2 if the run has a leapfrog start.",
          f"order of the time at which {what} [-]", law=2.0, found=order, within=1.5 * small[0],
          saw=f"The order is {order:.2f} where {what}.")
    check("The support releases the body where the force of the contact would begin to pull.",
          f"time at which {what}, from two steps [s]", law=T, found=best, within=small[0] ** 3 * T,
          saw=f"After {best:.6f} s {what}.")
    check("If v belongs to the time of x, the loop starts too fast by ½ a dt.",
          f"change of the time at which {what} by that start, dt = {1e3 * dt:.1f} ms [s]",
          law=held.time(0.5 * held.a * dt) - T, found=plain[2] - led[2], within=small[1] ** 2 * T,
          saw=f"So {what} {1e3 * (led[2] - plain[2]):.3f} ms early.")
    fine = np.linspace(0.0, dts[0], 30)
    return [series(f"{what}: theory", 1e3 * fine, [1e3 * (held.time(0.5 * held.a * dt) - T) for dt in fine], LINE),
            series(f"{what}: v at the time of x", 1e3 * dts, 1e3 * (plain - T), DOTS),
            series(f"{what}, leapfrog start", 1e3 * dts, 1e3 * (led - T), DOTS)]


@case("release-from-a-support", "Release from a support", compiled=False)
def release_from_a_support(lesson, check):
    """Compare the time of release and the force of a support with theory.

    The loop is the leapfrog method if v is half a step before x at the start, and J/dt is the force at x.  So the
    release has order 2; the next order is a relative k dt, where k is the rate of the motion.  The best of two
    steps, (4 t(½dt) − t(dt))/3, then errs by (k dt)³ of the time.  If v belongs to the time of x, the loop follows
    a start with v + ½ a dt, to (k dt)² of the time.  On a round support the first two forces share their sum
    wrongly, because the gap is 0 only at the start.
    """
    curves = [curve for held in supports() for curve in about_release(lesson, check, held)]
    return Picture("Time of release from the impulses of steps", "dt [ms]", "error [ms]", curves,
                   "The lines are the releases after a start that is too fast by ½ a dt. A leapfrog start leaves an "
                   "error of second order.")


# ---------------------------------------------------------------------------------------------- sweeps until settled

@case("sweeps-until-settled", "Sweeps until the impulses have settled", compiled=False)
def sweeps_until_settled(lesson, check):
    """Compare the error of sweeps that end when they change little with ρ/(1 − ρ) times the last change.

    ρ is the contraction factor.  For n stacked discs ρ = cos²(π/(2n)): the floor does not move, so the lowest
    contact has half the inverse mass of the others.  The last change lies between ρ and 1 times the threshold.
    """
    n, dt, ts, settled = 6, 1e-3, (1, 2, 4, 8, 16, 32), lesson.settled_contact_step_2d
    make = lambda heights: round_bodies(lesson, [(0.0, y) for y in heights], R, MASS, INERTIA, (0.0, -G), 0.0, 1)
    after = lambda steps, step: advanced(lesson, DISC, *make(R * (1.0 + 2.0 * np.arange(n))), dt, steps, step=step)
    wrong = lambda end: largest(np.sort(np.abs(end.J[:, 1])) / (MASS * G * dt) - np.arange(1.0, n + 1.0)) / n
    left, alone = ([wrong(after(steps, step)) for steps in ts] for step in (settled, lesson.contact_step_2d))
    rho = np.cos(np.pi / (2 * n)) ** 2
    bound = lesson.SETTLED * rho / (1.0 - rho)
    check("A first step, without stored impulses, leaves the error that the threshold and the contraction predict.",
          "error of the forces under six discs over SETTLED ρ/(1 − ρ) [-]",
          law=0.5 * (1.0 + rho), found=left[0] / bound, within=0.5 * (1.0 - rho) + 0.01,
          saw=f"It leaves {left[0]:.1e} of the largest force.")
    check.agree("Later steps, which start from the last impulses, leave less.",
                "largest error of the forces after 2 to 32 steps [-]", np.max(left[1:]), bound)
    check.agree("Then the discs rest.", "speed of the discs after 60 steps, over g dt [-]",
                largest(after(60, settled).v) / (G * dt), bound)
    above, p = make([R + 0.005])
    falling = above._replace(v=np.array([(0.0, -0.1), (0.0, 0.0)]))
    fallen = above.x[0, 1] - advanced(lesson, DISC, falling, p, dt, 1, step=settled).x[0, 1]
    check.agree("A body that is about to land is not stopped before contact.",
                "way of a falling disc, 5 mm above the floor: "
                "largest error, relative [-]", fallen / (dt * (0.1 + G * dt)) - 1.0, ROUND_OFF)
    percent = lambda errors: 100.0 * np.array(errors)
    return Picture("Forces under six discs", "step", "error of the forces over the largest [%]", [
        series("sweeps until settled", ts, percent(left), DOTS),
        series("one sweep per step", ts, percent(alone), DOTS)],
        "Sweeps that continue until little changes find the forces in the first step. With one sweep per step dozens "
        "of "
        "steps go by, in which the discs sink into each other.")


# ---------------------------------------------------------------------------------------------- turns per step

SPINS = (0.5, 5.0, 50.0)     # angle [rad] by which a ball turns in its first step


def slipping_ball(lesson, spin, mu, dt, steps):
    """Return the PileState of a ball of 1 kg and 10 cm that is put on a floor with this ω about y, after some steps."""
    state, p = round_bodies(lesson, [(0.0, 0.0, RADIUS)], RADIUS, 1.0, MOMENT, (0.0, 0.0, -G), mu, 40)
    state.omega[0, 1] = spin
    return advanced(lesson, BALL, state, p, dt, steps)


@case("turns-per-step", "A ball that turns many times per step", compiled=False)
def turns_per_step(lesson, check):
    """Compare a ball put down with the spin Ω, which slips for 2RΩ/7μg and then rolls with v = 2RΩ/7, with theory.

    While it slips v = μ g t.  A ball looks the same from every side, so the rotation of a step changes neither the
    contact nor the impulse: the result holds for any Ω dt.  Friction is constant while it slips, and J_t < μ J_n in
    the step in which it stops slipping, which conserves the angular momentum about the contact.  μ is chosen for a
    hundred steps of slip.  *Source:* Coriolis 1835, with I = 2/5 m R².
    """
    dt, R, ends = 0.01, RADIUS, []
    for turn in SPINS:
        spin = turn / dt
        mu, name = 2.0 * R * spin / (7.0 * G * 100.5 * dt), f"ball that turns by {turn:g} rad per step"
        half, end = (slipping_ball(lesson, spin, mu, dt, steps) for steps in (50, 140))
        ends.append(end.v[0, 0])
        check.agree("While a ball slips, it gains μ g per second and loses 5μg/2R of its spin.",
                    f"{name}: error of v and R ω over R Ω [-]",
                    largest(half.v[0, 0] - mu * G * 50 * dt,
                            R * half.omega[0, 1] - R * spin + 2.5 * mu * G * 50 * dt) / (R * spin), ROUND_OFF)
        check.agree("Finally it rolls at 2/7 of the speed of its surface.",
                    f"{name}: error of v and R ω over R Ω in the end [-]",
                    largest(np.array((end.v[0, 0], R * end.omega[0, 1])) / (R * spin) - 2.0 / 7.0), ROUND_OFF)
    fine = np.logspace(-1.0, 2.0, 40)
    return Picture("A ball put down with a spin", "log₁₀ of its turn in the first step [rad]",
                   "log₁₀ of its speed in the end [m/s]", [
                       series("theory, 2/7 R Ω", np.log10(fine), np.log10(2.0 / 7.0 * R * fine / dt), LINE),
                       series("measured", np.log10(SPINS), np.log10(ends), DOTS)],
                   "The speed is as accurate at eight turns per step as at half a radian. The orientation is not: "
                   "quaternion_update turns by 2 arctan(½ω dt), which is at most half a turn per step.")


# ---------------------------------------------------------------------------------------------- turns through a wall

BAR, WALL = (1.0, 0.02), (0.2, 0.01)     # half sizes of a bar that turns about its centre, and of a wall beside it [m]
PLACE, REACH = 0.7, 0.02                 # of the wall, from the centre of the bar; margin [m]
THIN = 0.01                              # half thickness of two plates [m]


def angle_found():
    """Return the angle [rad] at which the bar comes within the margin of the wall's inner corner, at r.

    r sin θ = w cos θ + b + margin,     half thicknesses b of the bar and w of the wall
    """
    r = PLACE - WALL[0]
    return np.arctan2(WALL[1], r) + np.arcsin((BAR[1] + REACH) / np.hypot(r, WALL[1]))


def one_that_moves(lesson, x, angle, half, margin):
    """Make (PileState, Bodies) of two boxes, the second of which is immovable, without gravity."""
    return lesson.make_bodies_2d(x, [angle, 0.0], [1.0, np.inf], [0.3, np.inf], half, [], (0.0, 0.0), 0.0, 20, margin)


def passes(lesson, state, p, dt, steps, passed):
    """Return (1 if the boxes pass each other undetected, 1 if advance_contact then ends in an error)."""
    if not passed(stepped(lesson, BOX, state, p, dt, steps)):
        return 0, 0
    try:
        advanced(lesson, BOX, state, p, dt, steps)
    except Diverged:
        return 1, 1
    return 1, 0


def turns_of_a_bar(lesson, omega, dt):
    """Return (misses, errors) of 4 starts, just before the wall is near; after a miss there is no wall."""
    ends, theta = [], angle_found()
    for k in range(4):
        start = -theta * (1.0 + 1e-9) - k / 4.0 * omega * dt
        state, p = one_that_moves(lesson, [(0.0, 0.0), (PLACE, 0.0)], start, [BAR, WALL], REACH)
        ends.append(passes(lesson, state._replace(omega=np.array([omega, 0.0])), p, dt,
                           1 + int(np.ceil(2.0 * theta / (omega * dt))), lambda end: end.omega[0] == omega))
    return np.sum(ends, axis=0)


def flights_of_a_plate(lesson, ways):
    """Return (passes, errors) of a plate that flies towards another one, at these half thicknesses per step.

    It begins just outside the margin, at half of its half thickness.
    """
    ends, dt = [], 0.01
    for way in ways:
        half = np.full((2, 2), (0.5, THIN))
        state, p = one_that_moves(lesson, [(0.0, 2.51 * THIN), (0.0, 0.0)], 0.0, half, 0.5 * THIN)
        state = state._replace(v=np.array([(0.0, -way * THIN / dt), (0.0, 0.0)]))
        ends.append(passes(lesson, state, p, dt, 3, lambda end: end.x[0, 1] < -2.0 * THIN))
    return np.sum(ends, axis=0)


@case("turns-through-a-wall", "A bar that turns beside a thin wall", compiled=False)
def turns_through_a_wall(lesson, check):
    """Compare the longest safe step of a bar that rotates beside a thin wall with theory.

    The bar rotates about its centre.  Its face meets the inner corner of a wall, which is parallel to it at θ = 0.
    The loop detects the contact if the gap is at most the margin, which is for |θ| ≤ θ*:
        r sin θ* = w cos θ* + b + margin
    Detected at θ < 0, the contact stops the bar.  Behind the middle it is detected on the wrong side, and does not
    stop the bar.  So no start misses the wall if ω dt ≤ θ*: dt = (w + b + margin)/(r ω) to first order, half of the
    thickness over the speed of the tip.  Twice that step and more can miss it altogether.
    """
    spins, edges, theta = (5.0, 80.0), [], angle_found()
    for omega in spins:
        edges.append(bisect(lambda dt, omega=omega: turns_of_a_bar(lesson, omega, dt)[0] > 0, 0.3 * theta / omega,
                            4.0 * theta / omega))
        check("No start misses the wall if the bar rotates per step by at most the angle at which it comes near.",
              f"longest step that misses no wall, ω = {omega:g} rad/s [s]",
              law=theta / omega, found=edges[-1], within=1e-5 * theta / omega,
              saw=f"At {omega:g} rad/s the bar first passes at a step of {1e3 * edges[-1]:.3g} ms.")
    shares = (1.1, 1.5, 2.1, 5.0, 20.0)
    misses, errors = np.sum([turns_of_a_bar(lesson, 20.0, share * theta / 20.0) for share in shares], axis=0)
    check("No bar passes undetected: advance_contact ends in an error if the loop would miss the wall.",
          f"errors of {misses:.0f} runs that miss the wall, with 1.1 to 20 times that step [-]",
          law=max(misses, 1), found=errors, within=0.0, saw=f"{errors:.0f} of {misses:.0f} such runs end in an error.")
    ways = np.linspace(2.05, 8.05, 13)
    passed, errors = flights_of_a_plate(lesson, ways)
    check("A plate beyond the middle of another one would leave on the far side, and this is an error, too.",
          f"plates that end in an error, of {ways.size} that fly 2 to 8 half thicknesses per step [-]",
          law=np.sum(ways > 2.51), found=errors, within=0.0,
          saw=f"{passed} of {ways.size} plates pass, and {errors} end in an error.")
    fine = np.geomspace(4.0, 100.0, 40)
    return Picture("A bar beside a thin wall", "log₁₀ of ω [rad/s]", "log₁₀ of the longest step [ms]", [
        series("theory, θ*/ω", np.log10(fine), np.log10(1e3 * theta / fine), LINE),
        series("measured", np.log10(spins), np.log10(1e3 * np.array(edges)), DOTS)],
        "Above the line a bar can rotate through the wall between two steps, and advance_contact raises an error.")


# ---------------------------------------------------------------------------------------------- forces

SWING, CENTRE, ROD = 1.2, 0.7, 0.05      # of a pendulum: largest angle [rad], hinge to centre [m], moment [kg m²]
FEET = np.array([(0.5, 0.3), (-0.5, 0.3), (-0.5, -0.3), (0.5, -0.3)])        # of a table, 0.4 m below its centre [m]
LOAD = 100.0                             # on a table or a box [N]


def tension(lesson, dt, steps):
    """Return (angles [rad], forces [N] along the rod) of a pendulum of 2 kg, released at SWING, after each step."""
    place = CENTRE * np.array([np.sin(SWING), -np.cos(SWING)])
    state, p = lesson.make_bodies_2d([place, (0.0, 0.0)], [SWING, 0.0], [2.0, np.inf], [ROD, np.inf],
                                     np.full((2, 2), 0.1), [], (0.0, -G), 0.0, 1, 0.01)
    p, now, angles, forces = lesson.make_joints(state, p, [0], [1], [(0.0, 0.0)], 0.0), state[:4], [], []
    for n in range(steps):
        now = lesson.joint_step_2d(lesson.weight, n * dt, *now, dt, p)
        F = lesson.joint_forces_2d(lesson.weight, (n + 1) * dt, *now, p)[0]
        angles.append(now[1][0])
        forces.append(F @ (-np.sin(now[1][0]), np.cos(now[1][0])))
    return np.array(angles), np.array(forces)


def tension_at(theta):
    """Return m g cos θ + m l ω² [N], where the energy gives ω² = 2 m g l (cos θ − cos θ₀)/(I + m l²)."""
    omega_squared = 4.0 * G * CENTRE * (np.cos(theta) - np.cos(SWING)) / (ROD + 2.0 * CENTRE**2)
    return 2.0 * G * np.cos(theta) + 2.0 * CENTRE * omega_squared


def legs(lesson, place):
    """Return the forces (4, 3) [N] of the ground on the feet of a table without weight, loaded at place (2,) [m]."""
    load = lambda t, x, q, v, omega, p: (np.array([(0.0, 0.0, -LOAD), np.zeros(3)]),
                                         np.array([np.cross((*place, 0.0), (0.0, 0.0, -LOAD)), np.zeros(3)]))
    state, p = lesson.make_bodies([(0.0, 0.0, 0.4), (0.0, 0.0, 0.0)], [UPRIGHT] * 2, [3.0, np.inf],
                                  [(0.2, 0.4, 0.5), (np.inf,) * 3], np.full((2, 3), 0.1), [], np.zeros(3), 0.0, 1, 0.01)
    p = lesson.make_joints(state, p, [0] * 4, [1] * 4, [(*foot, 0.0) for foot in FEET], 0.0)
    return lesson.joint_forces(load, 0.0, *state[:4], p)


def feet(lesson, place, dt):
    """Return the normal forces (left, right) [N] of a smooth floor on a box of 1 m, loaded at `place` [m]."""
    load = lambda t, x, q, v, omega, p: (np.array([(0.0, -LOAD), (0.0, 0.0)]), np.array([-LOAD * place, 0.0]))
    state, p = lesson.make_bodies_2d([(0.0, 0.2)], [0.0], 3.0, 0.3, [(0.5, 0.2)], [UP], (0.0, 0.0), 0.0, 60, 0.01)
    state = advanced(lesson, BOX, state, p, dt, 20, load)
    N, _ = lesson.normal_and_friction(state, dt)
    return N[np.argsort(state.contacts.p[:, 0])]


@case("forces-of-supports", "Forces in a rod and under the legs of a table", compiled=False)
def forces_of_supports(lesson, check):
    """Compare forces of supports with theory: the rod of a pendulum bears m g cos θ + m l ω².

    joint_step_2d leaves an error of order 2.  Four legs are one more than the laws of equilibrium determine.  The
    forces of smallest norm are those of equally stiff legs, which are linear in the place of the foot:
        N_k = W (1/4 + x x_k/Σx² + y y_k/Σy²),      the load W at (x, y)
    Two feet on a floor are determined:  N = W (1/2 ± x/b),  b their distance.
    """
    coarse, far = tension(lesson, 0.02, 40)
    angles, near = tension(lesson, 0.01, 80)
    errors = largest(far - tension_at(coarse)), largest(near - tension_at(angles))
    rate = np.sqrt(2.0 * G * CENTRE / (ROD + 2.0 * CENTRE**2))
    order = np.log2(errors[0] / errors[1])
    check.agree("A rod bears m g cos θ + m l ω².", "error of its force over 3 m g, dt = 0.01 s [-]",
                errors[1] / (6.0 * G), (rate * 0.01) ** 2)
    check("The force has the order of the step.", "order of the force of a rod [-]", law=2.0, found=order,
          within=(rate * 0.02) ** 2, saw=f"The order is {order:.2f}.")
    shares = lambda place: LOAD * (0.25 + FEET @ (place / np.sum(FEET**2, axis=0)))
    check.agree("Four legs share a load like four equal springs.", "error of the forces of four legs, 100 N [N]",
                largest(*(legs(lesson, place) - shares(place)[:, None] * np.eye(3)[2]
                          for place in ((0.0, 0.0), (0.2, 0.0), (0.25, 0.15), (-0.1, 0.3)))), 100.0 * ROUND_OFF)
    check.agree("Two feet share a load by the law of the lever.", "error of the forces of two feet, 100 N [N]",
                largest(*(feet(lesson, x, 0.01) - LOAD * np.array((0.5 - x, 0.5 + x)) for x in (0.0, 0.2, 0.4))),
                100.0 * ROUND_OFF)
    swing = np.linspace(-SWING, SWING)
    return Picture("The force in the rod of a pendulum", "angle [rad]", "force [N]", [
        series("theory, m g cos θ + m l ω²", swing, tension_at(swing), LINE),
        series("joint_forces_2d, dt = 20 ms", coarse, far, DOTS)],
        "A pendulum that is released at 69° pulls at its lowest position with more than twice its weight.")


@case("stopped-below-the-floor", "Where a fast disc is stopped", compiled=False)
def stopped_below_the_floor(lesson, check):
    """Throw discs at a floor by the loop, and compare the depth at which they lie with the prediction."""
    worst, dt = 0.0, 1.0 / 60.0
    for speed in (0.7, 3.0, 8.0):
        for margin, above in ((0.02, 0.001), (0.1, 0.37)):
            gap = margin + above
            state, p = lesson.make_bodies_2d([(0.0, 0.1 + gap)], [0.0], 1.0, 0.005, [(0.1, 0.1)], [(0.0, 1.0, 0.0)],
                                             (0.0, 0.0), 0.0, 5, margin)
            state = state._replace(v=np.array([(0.0, -speed), (0.0, 0.0)]))
            for k in range(60):
                state = lesson.contact_step_2d(lesson.weight, lesson.disc_bounds, lesson.round_contacts, k * dt, state,
                                               dt, p)
            worst = np.maximum(worst, abs(lesson.stopping_depth(speed, gap, margin, dt)
                                          - np.maximum(0.0, 0.1 - state.x[0, 1])))
    check.agree("The loop stops a disc at the predicted depth.", "depth: largest error [m]", worst, 1e-12)


@case("scene-of-ones-own", "A scene of one's own in the loop", compiled=False)
def scene_of_ones_own(lesson, check):
    """Run my_scene for half a second: five boxes move, and the loop brings no energy.

    In free flight symplectic Euler loses ½ m g² dt² per step, and an impulse without restitution loses energy.  What a
    step adds by the turn of a box is of second order; the law allows what lifts all boxes by a millimetre.
    """
    x, q, v, half, planes = (np.asarray(part, dtype=float) for part in lesson.my_scene(5))
    state, p = lesson.make_bodies_2d(x, q, 1.0, np.sum(half**2, axis=1) / 3.0, half, planes, (0.0, -G), 0.5, 10, 0.03)
    state = state._replace(v=np.vstack((v, np.zeros((len(planes), 2)))))
    energies, moved = [], 0.0
    for _ in range(50):
        energies.append(lesson.mechanical_energy_2d(*state[:4], p))
        state = stepped(lesson, BOX, state, p, 0.01, 1)
        moved = np.maximum(moved, largest(state.x[:5] - x))
    check.agree("The loop brings no energy into the scene.", "rise of the energy above that at the start [J]",
                np.maximum(0.0, np.max(energies) - energies[0]), 0.005 * G)
    check("The scene moves.", "farthest way of a box, over the margin [-]", law=1.0, found=min(1.0, moved / 0.03),
          within=0.0, saw=f"A box moves by {moved:.2g} m.")


# ---------------------------------------------------------------------------------------------- polyhedra

PYRAMIDS = [(0.15, 0.9), (0.25, 0.9)]                    # half of an edge of the base, and the height [m]


def pyramid(base, height):
    """Return the corners (5, 3) of a square pyramid that stands on z = 0."""
    return np.array([*((x, y, 0.0) for x in (-base, base) for y in (-base, base)), (0.0, 0.0, height)])


def moved_solid(lesson, corners, mu, gravity, v, dt, steps):
    """Return how far [m] the centre of a solid that stands on z = 0 has moved after these steps."""
    shape, x, q = polyhedron_of(corners)
    bodies = [Body((0.0, 0.0, 0.0), shape=HalfSpace((0.0, 0.0, 1.0)), mu=1.0),
              Body(tuple(x), 1.0, shape, mu, q=tuple(q), v=(v, 0.0, 0.0))]
    loop = lesson.compose(make_model(bodies, tuple(gravity)), lesson.Settings(settled=1e-8, sweeps=1000))
    return lesson.state_of(loop, lesson.run_parts(loop, 0.0, loop.state, dt, steps)).x[1] - x


def tipped(lesson, corners, slope):
    """Return whether a solid that stands on a rough slope [rad] moves by more than a centimetre in 1.2 s."""
    gravity = G * np.array((np.sin(slope), 0.0, -np.cos(slope)))
    return np.linalg.norm(moved_solid(lesson, corners, 2.0, gravity, 0.0, 4e-3, 300)) > 0.01


@case("solids-on-a-plane", "Pyramids that tip and pyramids that slide", compiled=False, in_quick=False)
def solids_on_a_plane(lesson, check):
    """Compare the slope on which a pyramid tips, and the distance that it slides, with their closed forms.

    The centre of mass of a pyramid is at a quarter of its height.  Its line of gravity leaves the base, whose half edge
    is b, at tan α = 4 b/h.  On a slope that is a little steeper, a pyramid tips slowly.  If the slope is 0.5 % steeper,
    the pyramid has moved by more than a centimetre after 1.2 s.

    A pyramid that slides on a horizontal floor stops after v²/(2 μ g).  Symplectic Euler reduces the velocity first, so
    the distance is shorter by ½ v dt.  Each step reduces the velocity by μ g dt, and the last one by a fraction f of
    that, which adds ½ μ g dt² f (1 − f), at most ⅛ μ g dt².
    """
    edges, dt, v = [], 2e-3, 1.0
    laws = [np.arctan(4.0 * base / height) for base, height in PYRAMIDS]
    for law, (base, height) in zip(laws, PYRAMIDS, strict=True):
        tips = lambda slope, base=base, height=height: tipped(lesson, pyramid(base, height), slope)
        edges.append(bisect(tips, 0.8 * law, 1.2 * law, 2e-3))
        check("A pyramid tips where its line of gravity leaves its base.",
              f"slope on which it tips, base {2.0 * base:g} m, height {height:g} m [rad]", law=law, found=edges[-1],
              within=0.005 * law, saw=f"It tips on a slope of {np.degrees(edges[-1]):.2f}°.")
    for mu in (0.2, 0.3):
        slid = moved_solid(lesson, pyramid(0.3, 0.4), mu, (0.0, 0.0, -G), v, dt, 300)[0]
        check("A pyramid that slides stops where friction has used up its kinetic energy.",
              f"distance at 1 m/s, friction {mu:g} [m]", law=v * v / (2.0 * mu * G) - 0.5 * v * dt, found=slid,
              within=mu * G * dt * dt / 8.0, saw=f"It stops after {100.0 * slid:.2f} cm.")
    ratio = [base / height for base, height in PYRAMIDS]
    across = np.linspace(0.8 * ratio[0], 1.2 * ratio[-1], 30)
    return Picture("Which slope a pyramid stands on", "half of an edge of the base over the height [-]", "slope [°]", [
        series("theory, tan α = 4 b/h", across, np.degrees(np.arctan(4.0 * across)), LINE),
        series("measured", ratio, np.degrees(edges), DOTS)],
        "A pyramid with a base as wide as it is high stands on a slope of more than 60°, if friction holds it.")
