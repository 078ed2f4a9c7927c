"""How fast may a body be, how does a turntable spiral, how many impacts has a rocking block, and what gains energy?

What a case predicts is derived in its docstring; what it measures comes from the loops of the lesson.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from solutions.checks import Diverged
from solutions.support.events import release
from validate.reference.simulator import leaves_ball, leaves_platform, rocking, slides_on_ball
from validate.stability.case import DOTS, LINE, Picture, Worst, agreement, bisect, case, finding, refuses, series

G = 9.81                     # [m/s²]
ROUND_OFF = 1e-12            # of numbers around 1 after a few hundred operations
UP = (0.0, 1.0, 0.0)


def disc_above(lesson, height, speed, margin, sweeps=5):
    """(PileState, Bodies) of a disc of 10 cm that approaches a floor; no gravity."""
    state, p = lesson.make_bodies_2d([(0.0, 0.1 + height)], [0.0], 1.0, 0.005, [(0.1, 0.1)], [UP], (0.0, 0.0), 0.0,
                                     sweeps, margin)
    return state._replace(v=np.array([(0.0, -speed), (0.0, 0.0)])), p


def deepest(lesson, speed, margin, dt):
    """Greatest depth [m] of that disc, over sixteen places at which a step may find it."""
    worst = 0.0
    for k in range(16):
        state, p = disc_above(lesson, margin + (k + 0.5) / 16.0 * speed * dt, speed, margin)
        for n in range(4):
            state = lesson.contact_step_2d(lesson.weight, lesson.disc_bounds, lesson.round_contacts, n * dt, state, dt,
                                           p)
        worst = max(worst, 0.1 - state.x[0, 1])
    return worst


@case("margin-and-speed", "How fast a body may come", compiled=False)
def margin_and_speed(lesson):
    """A contact is found when its gap is at most the margin, and a body moves by v dt in a step.

    So it is found before it touches if v dt is at most the margin.  Faster, it may be v dt − margin deep when it is
    found, and it stops there: of sixteen places in the step the worst lacks 1/32 of v dt.
    """
    found, dt = [], 0.01
    margins, edges = (0.01, 0.02, 0.05), []
    for margin in margins:
        sinks = lambda v, margin=margin: deepest(lesson, v, margin, dt) > 1e-9
        edge = bisect(sinks, 0.5 * margin / dt, 4.0 * margin / dt)
        edges.append(edge)
        found.append(finding(
            claim="A body touches in time if its way in a step is at most the margin.",
            quantity=f"speed at which a disc first sinks in, margin {margin:g} m, dt 0.01 s [m/s]",
            predicted=margin / dt * 32.0 / 31.0,
            measured=edge,
            tolerance=1e-4 * margin / dt,
            observation=f"With a margin of {margin:g} m the disc sinks in from {edge:.2f} m/s on.",
        ))
    for speed in (5.0, 8.0):
        deep = deepest(lesson, speed, 0.02, dt)
        found.append(finding(
            claim="A faster body is up to v dt − margin inside when it is found, and stays there.",
            quantity=f"greatest depth at {speed:g} m/s, margin 0.02 m [m]",
            predicted=speed * dt - 0.02 - speed * dt / 32.0,
            measured=deep,
            tolerance=ROUND_OFF,
            observation=f"At {speed:g} m/s the disc is up to {1e3 * deep:.1f} mm deep.",
        ))
    return found, Picture("Which speeds are safe", "margin [m]", "speed at which a disc sinks in [m/s]", [
        series("theory, margin/dt", margins, np.array(margins) / dt, LINE), series("measured", margins, edges, DOTS)],
        "A contact that is found a step ahead stops a body on the surface; what comes faster is stopped inside.")


@case("growth-on-a-turntable", "Why the ball spirals", compiled=False)
def growth_on_a_turntable(lesson):
    """A rolling ball has v̇ = w n × v with w = 2/7 Ω.

    The whole loop takes the floor where the ball was: v ← v + w dt n × v of the step before, whose size grows by the
    root that is near 1 of  z² = z + i w dt:  |z|² = 1 + (w dt)² + O((w dt)⁴), so that the logarithm of |v| grows by
    ½ w² dt per second.  One step ahead it is  z = 1 + i w dt (3/2 − 1/(2z)), with |z| = 1 + ¼ (w dt)⁴.
    The next order is a relative (w dt)² in the first, which is 2 % here at most.  A sweep halves the slip of a ball, so
    that 40 leave nothing of it.
    """
    found, spin, R, moment = [], 2.0, 0.1, 0.004
    w, r, table = 2.0 / 7.0 * spin, np.array([0.0, 0.0, -R]), np.array([0.0, 0.0, spin])
    x, v = np.array([0.6, 0.0, R]), np.array([0.0, 0.3, 0.0])
    omega, upright, down = np.cross(r, np.cross(table, x) - v) / R**2, np.array([1.0, 0.0, 0.0, 0.0]), (0.0, 0.0, -G)
    still = lambda t, x, q, v, omega, ball: (np.zeros(3), np.zeros(3))

    def loop(dt, steps):
        state, p = lesson.make_bodies([x], [upright], 1.0, [(moment,) * 3], [(R,) * 3], [(0.0, 0.0, 1.0, 0.0)], down,
                                      10.0, 40, 0.02)
        state = state._replace(v=np.array([v, np.zeros(3)]), omega=np.array([omega, table]))
        for n in range(steps):
            state = lesson.contact_step(lesson.weight, lesson.ball_bounds, lesson.round_contacts, n * dt, state, dt, p)
        return np.linalg.norm(state.v[0])

    def ahead(dt, steps):
        ball = lesson.CarriedBall(1.0, np.full(3, moment), R, 10.0, np.array(down), np.zeros(3), np.zeros(3), table)
        now = x, upright, v, omega
        for n in range(steps):
            now = lesson.carried_step(still, n * dt, *now, dt, ball)
        return np.linalg.norm(now[2])

    dts, grown = (0.02, 0.05, 0.1, 0.2), []
    for dt in dts:
        first, last = (loop(dt, steps) for steps in (round(2.0 / dt), round(12.0 / dt)))
        grown.append(np.log(last / first) / 10.0)
        found.append(finding(
            claim="With the floor's velocity where the ball was, its speed grows by the share ½ (2Ω/7)² dt per second.",
            quantity=f"growth of ln |v| per second, dt = {dt:g} s, Ω = 2 rad/s [1/s]",
            predicted=0.5 * w * w * dt,
            measured=grown[-1],
            tolerance=0.5 * w * w * dt * 2.0 * (w * dt) ** 2 + 1e-9,
            observation=f"With dt = {dt:g} s the speed grows by {100.0 * np.expm1(10.0 * grown[-1]):.2f} % in 10 s.",
        ))
    dt = 0.2
    first, last = (ahead(dt, steps) for steps in (round(2.0 / dt), round(12.0 / dt)))
    found.append(finding(
        claim="With the floor's velocity where the ball will be, the growth is of the fourth order.",
        quantity="growth of ln |v| per second, dt = 0.2 s, floor ahead [1/s]",
        predicted=0.25 * (w * dt) ** 4 / dt,
        measured=np.log(last / first) / 10.0,
        tolerance=0.1 * (w * dt) ** 4 / dt,
        observation=f"With dt = 0.2 s and the floor ahead it grows by {100.0 * (last / first - 1.0):.4f} % in 10 s.",
    ))
    fine = np.linspace(0.01, 0.2, 40)
    return found, Picture("A ball on a turntable", "dt [s]", "growth of ln |v| per second [1/s]", [
        series("theory, ½ (2Ω/7)² dt", fine, 0.5 * w * w * fine, LINE), series("the whole loop", dts, grown, DOTS)],
        "Taking the velocity of the floor from the wrong end of a step feeds energy into the ball.")


@case("rocking-to-the-end", "How long a block rocks", compiled=False)
def rocking_to_the_end(lesson):
    """The n-th impact comes when theory says, for slender and stout blocks; a block that does not lean stays.

    Housner's ratio e = 1 − 1.5 sin²α per impact; the times are those of a pendulum about each corner, by DOP853.
    Runge–Kutta 4 with dt = 0.01 s leaves (P dt)⁴ P t/120 ≈ 1e-7 of the rate, and the time of a slow impact multiplies
    that by some ten.  A stout block has infinitely many impacts in a finite time, so these runs end before.
    """
    found, ends = [], []
    for b, h, T in ((0.02, 0.5, 1.0), (0.1, 0.5, 1.5), (0.2, 0.5, 1.0)):
        lean = 0.5 * np.arctan(b / h)
        block = lesson.RockingBlock(1.0, b, h, (b * b + h * h) / 3.0, G)
        impacts = rocking(b, h, G, lean, T)[2]
        x, v, times = np.array([lean]), np.zeros(1), []
        for n in range(round(T / 0.01)):
            before = x[0]
            x, v = lesson.rocking_step(lesson.rk4_step, n * 0.01, x, v, 0.01, block)
            if before * x[0] < 0.0:
                times.append((n + 1) * 0.01)
        expected = [0.01 * np.ceil(t / 0.01 - 1e-9) for t, _, _ in impacts]
        ends.append(len(impacts))
        found.append(finding(
            claim="A block changes its corner in the steps in which theory has its impacts.",
            quantity=f"largest difference of the ends of these steps, {b:g} m × {h:g} m, {len(impacts)} impacts [s]",
            predicted=0.0,
            measured=max(abs(a - b) for a, b in zip(times, expected)) if len(times) == len(expected) else np.inf,
            tolerance=1e-9,
            observation=f"A block of half sizes {b:g} m and {h:g} m changes its corner {len(times)} times in {T:g} s.",
        ))
    block = lesson.RockingBlock(1.0, 0.1, 0.5, 0.26 / 3.0, G)
    x, v = lesson.advance_rocking(lesson.rk4_step, 0.0, np.zeros(1), np.zeros(1), 0.01, 100, block)
    found.append(finding(
        claim="A block that stands stays.",
        quantity="lean and rate after 1 s [rad, rad/s]",
        predicted=0.0,
        measured=np.max(np.abs(np.append(x, v))),
        tolerance=ROUND_OFF,
        observation=f"It leans by {abs(x[0]):.0e} rad.",
    ))
    found.append(refusals(lesson))
    widths = np.linspace(0.01, 0.4, 40)
    sine = np.sin(np.arctan(widths / 0.5))
    ratios = [lesson.corner_impact(np.array([0.5, -b]), -1.0, np.array([b, -0.5]), 1.0, 3.0 / (b * b + 0.25))[1] / -1.0
              for b in widths[::4]]
    return found, Picture("What an impact leaves", "half width of a block of half height 0.5 m [m]",
                          "rate after over before [-]", [
        series("theory, 1 − 1.5 sin²α", widths, 1.0 - 1.5 * sine**2, LINE),
        series("corner_impact", widths[::4], ratios, DOTS)],
        "A slender block loses next to nothing at each impact and rocks for long; a cube stops at once.")


@case("flight-and-its-invariants", "What stays in a flight, and what a fault does to it", compiled=False)
def flight_and_its_invariants(lesson):
    """Bodies that fly: parabolas that are late by half a step, momenta that stay, and energy that only a source raises.

    Symplectic Euler falls ½ g T (T + dt).  A free body that turns about a principal axis by 2 atan(½ ω dt) per step
    keeps ω.  L of a tumbling body drifts by O(dt): half the step leaves half of it, up to a few per cent.
    A ball of 2 kg that jumps from nothing by 0.3 m gains 2 g · 0.3 J, whatever it loses before.
    """
    found, T = [], 1.2
    state, p = lesson.make_bodies_2d([(0.0, 1.0), (1.0, 2.0)], [0.1, 0.2], [1.0, 3.0], 0.2, np.full((2, 2), 0.1),
                                     np.zeros((0, 3)), (0.0, -G), 0.0, 1, 0.01)
    v, omega = np.array([(1.0, 2.0), (-2.0, 0.5)]), np.array([3.0, -2.0])
    dts, falls = (0.1, 0.05, 0.025), []
    for dt in dts:
        end = lesson.advance_free(lesson.free_step_2d, lesson.weight, 0.0, state.x, state.q, v, omega, dt,
                                  round(T / dt), p)
        fall = np.array([0.0, 0.5 * G * T * (T + dt)])
        falls.append(np.max(np.abs(end[0] - state.x - T * v)))
        found.append(agreement("Thrown bodies fall ½ g T (T + dt) and turn by ω T.",
                               f"error of places and angles, dt = {dt:g} s [m, rad]",
                               max(np.max(np.abs(end[0] - state.x - T * v + fall)),
                                   np.max(np.abs(end[1] - state.q - T * omega))), ROUND_OFF))
    half, upright = np.ones((1, 3)), [(1.0, 0.0, 0.0, 0.0)]
    state, p = lesson.make_bodies([(0.5, -0.2, 0.3)], upright, 2.0, [(1.0, 2.0, 3.0)], half, np.zeros((0, 4)),
                                  (0.0, 0.0, -G), 0.0, 1, 0.01)
    v, spin = np.array([(1.0, 2.0, -0.5)]), np.array([(0.0, 0.0, 1.5)])
    energy = 0.5 * 2.0 * 5.25 + 0.5 * 3.0 * 2.25 + 2.0 * G * 0.3
    P, L = lesson.momenta(state.x, state.q, v, spin, p)
    by_hand = 2.0 * np.cross(state.x[0], v[0]) + np.array([0.0, 0.0, 4.5])
    found.append(agreement("Energy and momenta of one body are those found by hand.", "error [J, kg m/s, kg m²/s]",
                           max(abs(lesson.mechanical_energy(state.x, state.q, v, spin, p) - energy),
                               np.max(np.abs(P - 2.0 * v[0])), np.max(np.abs(L - by_hand))), ROUND_OFF))
    drifts, still = [], p._replace(gravity=np.zeros(3))
    for dt in (0.01, 0.005):
        tumbles = np.array([(0.1, 1.0, 0.2)])
        end = lesson.advance_free(lesson.free_step, lesson.weight, 0.0, state.x, state.q, v, tumbles, dt,
                                  round(2.0 / dt), still)
        drifts.append(np.linalg.norm(lesson.momenta(*end, still)[1]
                                     - lesson.momenta(state.x, state.q, v, tumbles, still)[1]))
    found.append(finding(
        claim="The explicit gyroscopic term lets L drift in proportion to the step.",
        quantity="drift of L with half the step over that with the whole one [-]",
        predicted=0.5, measured=drifts[1] / drifts[0], tolerance=0.03,
        observation=f"In 2 s L drifts by {drifts[0]:.1e} kg m²/s with 0.01 s and by {drifts[1]:.1e} with half of that.",
    ))
    end = lesson.advance_free(lesson.free_step, lesson.weight, 0.0, state.x, state.q, v, spin, 0.1, 12, p)
    turned, fall = 12 * np.arctan(0.5 * 1.5 * 0.1), 0.5 * G * T * (T + 0.1)
    found.append(agreement("A body that spins about a principal axis turns by 2 atan(½ ω dt) per step.",
                           "error of its quaternion and place [-, m]",
                           max(np.max(np.abs(end[1][0] - (np.cos(turned), 0.0, 0.0, np.sin(turned)))),
                               np.max(np.abs(end[0] - state.x - T * v + (0.0, 0.0, fall)))), ROUND_OFF))
    heights = np.array([1.0, 0.8, 0.5, 0.8, 0.6, 0.7])
    found.append(agreement("A jump from nothing is found, and work explains it.", "error of the gains [J]",
                           max(abs(lesson.gain_without_source(2.0 * G * heights, np.zeros(6)) - 0.6 * G),
                               abs(lesson.gain_without_source(2.0 * G * heights, 2.0 * G * heights))), ROUND_OFF))
    now = [0.0]

    def takes(seconds, result):
        now[0] += seconds
        return result
    full, short = lambda: takes(3.0, heights), lambda: takes(0.5, heights + 0.01)
    difference, ratio = lesson.compare(full, short, 3, lambda: now[0])
    found.append(agreement("Two runs are compared by difference and by time.", "error of 0.01 m and of 6 [m, -]",
                           max(abs(difference - 0.01), abs(ratio - 6.0)), ROUND_OFF))
    return found, Picture("How far a body falls in 1.2 s", "dt [s]", "fall [m]", [
        series("theory, ½ g T (T + dt)", dts, 0.5 * G * T * (T + np.array(dts)), LINE),
        series("measured", dts, falls, DOTS)],
        "Moving with the new velocity makes a fall too deep by ½ g T dt: exactly, whatever the step is.")


def refusals(lesson):
    """The Finding on what is no scene."""
    def made(**more):
        given = {"x": [(0.0, 0.5)], "q": [0.0], "m": 1.0, "inertia": 0.1, "half": [(0.5, 0.5)], "planes": [UP],
                 "gravity": (0.0, -G), "mu": 0.3, "sweeps": 10, "margin": 0.02, **more}
        return lesson.make_bodies_2d(*given.values())

    def moved(dt, **more):
        state, p = made()
        return lesson.advance_contact(lesson.contact_step_2d, lesson.weight, lesson.disc_bounds, lesson.round_contacts,
                                      0.0, state._replace(**more), dt, 3, p)
    asked = ((lambda: made(m=-1.0), "-1.0"), (lambda: made(m=0.0), "0.0"), (lambda: made(inertia=np.nan), "nan"),
             (lambda: made(half=[(0.5, 0.0)]), "0.0"), (lambda: made(planes=[(0.0, 2.0, 0.0)]), "2.0"),
             (lambda: made(mu=-0.3), "-0.3"), (lambda: made(sweeps=0), "0"), (lambda: made(margin=0.0), "0.0"),
             (lambda: made(x=[(np.inf, 0.5)]), "inf"), (lambda: moved(0.0), "0.0"), (lambda: moved(-0.01), "-0.01"),
             (lambda: moved(0.01, v=np.full((2, 2), np.nan)), "nan"), (lambda: moved(0.01, v=np.zeros((3, 2))), "3"))
    refused = sum(refuses(function, (), value) for function, value in asked)
    return finding(
        claim="Masses, sizes, margins and steps of zero, normals without a length, and what is no number are refused, "
              "with their value.",
        quantity=f"calls that name the value in their error [of {len(asked)}]",
        predicted=len(asked),
        measured=refused,
        tolerance=0.0,
        observation=f"{refused} of {len(asked)} such calls end in a sentence that names the value.",
    )


# ---------------------------------------------------------------------------------------------- each part by itself

TRIED = 30                   # random bodies and loads [-]
SIDES = np.array([(0.0, 1.0), (0.0, -1.0), (1.0, 0.0), (-1.0, 0.0)])  # normals of a floor, a ceiling and two walls


def matrix_of(q):
    """Return the rotation (3, 3) of a unit quaternion: (w² − 𝐪²) 1 + 2 𝐪 𝐪ᵀ + 2 w 𝐪*."""
    w, r = q[0], q[1:]
    return (w * w - r @ r) * np.eye(3) + 2.0 * np.outer(r, r) + 2.0 * w * np.cross(np.eye(3), r)


@case("loop-by-parts", "Each part of the loop by itself", compiled=False)
def loop_by_parts(lesson):
    """Two unlike bodies and an immovable one, turned and tumbling, under loads with torques that depend on time.

    In space the second body is free, on an axle, which no force moves, or cannot be turned, by turns.
    Euler's equation in world coordinates, ω̇ = I⁻¹ (τ − ω × I ω), with I = R diag Rᵀ as matrices.
    """
    rng = np.random.default_rng(101)
    worst = Worst()

    for trial in range(TRIED):
        m, dt, t, g = rng.uniform(0.5, 2.0, 2), rng.uniform(0.01, 0.1), rng.uniform(0.0, 1.0), rng.normal(size=3)
        push, twist = rng.normal(size=(2, 3, 3))

        # in the plane: the third body is immovable, whatever pushes it
        inertia = rng.uniform(0.1, 0.5, 2)
        state, p = lesson.make_bodies_2d(rng.normal(size=(2, 2)), rng.normal(size=2), m, inertia, np.full((2, 2), 0.1),
                                         [UP], g[:2], 0.3, 1, 0.01)
        v, omega = rng.normal(size=(3, 2)) * [[1.0], [1.0], [0.0]], rng.normal(size=3) * [1.0, 1.0, 0.0]
        load = lambda t, x, q, v, omega, p, push=push, twist=twist: (np.cos(t) * push[:, :2], np.sin(t) * twist[:, 0])
        w = np.array([*(1.0 / m), 0.0])
        v_new = v + dt * w[:, None] * np.cos(t) * push[:, :2]
        omega_new = omega + dt * np.array([*(1.0 / inertia), 0.0]) * np.sin(t) * twist[:, 0]
        x, q, got_v, got_omega = lesson.free_step_2d(load, t, state.x, state.q, v, omega, dt, p)
        worst.note("plane", np.column_stack((got_v, got_omega)), np.column_stack((v_new, omega_new)))
        worst.note("plane", np.column_stack((x, q)), np.column_stack((state.x + dt * v_new, state.q + dt * omega_new)))
        steps = 5
        v_end = v + dt * w[:, None] * push[:, :2] * sum(np.cos(t + k * dt) for k in range(steps))
        end = lesson.advance_free(lesson.free_step_2d, load, t, state.x, state.q, v, omega, dt, steps, p)
        worst.note("times", end[2], v_end)
        alone = p._replace(planes=np.zeros((0, 3)), half=np.full((3, 2), 1e-6))        # they meet nobody
        end = lesson.advance_contact(lesson.contact_step_2d, load, lesson.disc_bounds, lesson.round_contacts, t,
                                     state._replace(v=v, omega=omega, contacts=state.contacts._replace(
                                         first=np.zeros(4, np.int64))), dt, steps, alone)
        worst.note("times", end.v, v_end)

        # in space
        turns, moments = rng.normal(size=(2, 4)), rng.uniform(1.0, 1.9, (2, 3))
        turns /= np.linalg.norm(turns, axis=1)[:, None]
        state, p = lesson.make_bodies(rng.normal(size=(2, 3)), turns, m, moments, np.full((2, 3), 0.1), [(0.0, *UP)],
                                      g, 0.3, 1, 0.01)
        held = trial % 3
        w[1] *= held != 1                                        # on an axle; with 2 it cannot be turned
        p.inv_mass[1] = w[1]
        p.inv_inertia[1] *= held != 2
        v, omega = rng.normal(size=(2, 3, 3)) * [[1.0], [1.0], [0.0]]
        v *= 10.0 ** rng.uniform(-2.0, 2.0)
        load = lambda t, x, q, v, omega, p, push=push, twist=twist: (np.cos(t) * push, np.sin(t) * twist)
        tensors = [R @ np.diag(I) @ R.T for R, I in zip(map(matrix_of, turns), moments, strict=True)]
        rates = [np.linalg.solve(I, np.sin(t) * twist[i] - np.cross(omega[i], I @ omega[i]))
                 for i, I in enumerate(tensors)]
        rates[1] = rates[1] * (held != 2)
        omega_new = omega + dt * np.array([*rates, np.zeros(3)])
        x, q, got_v, got_omega = lesson.free_step(load, t, state.x, state.q, v, omega, dt, p)
        worst.note("space", (got_v, got_omega), np.array((v + dt * w[:, None] * np.cos(t) * push, omega_new)))
        worst.note("space", x, state.x + dt * got_v)
        for i in range(2):                                       # by 2 atan(½ |ω| dt) about ω
            rate = np.linalg.norm(omega_new[i])
            axis, angle = omega_new[i] / rate, 2.0 * np.arctan(0.5 * rate * dt)
            R = matrix_of(np.array([np.cos(0.5 * angle), *(np.sin(0.5 * angle) * axis)]))
            worst.note("turn", matrix_of(q[i]), R @ matrix_of(turns[i]))
        movable, tensors[1] = range(1 if held == 1 else 2), tensors[1] * (held != 2)
        energy = sum(0.5 * m[i] * v[i] @ v[i] + 0.5 * omega[i] @ tensors[i] @ omega[i] - m[i] * g @ state.x[i]
                     for i in movable)
        P = sum(m[i] * v[i] for i in movable)
        L = sum(m[i] * np.cross(state.x[i], v[i]) + tensors[i] @ omega[i] for i in movable)
        size = 1.0 + np.max(np.abs(v)) ** 2                      # the invariants of fast bodies are large
        worst.note("invariants", lesson.mechanical_energy(state.x, state.q, v, omega, p) / size, energy / size)
        momenta = np.array(lesson.momenta(state.x, state.q, v, omega, p))
        worst.note("invariants", momenta / size, np.array((P, L)) / size)

        energies, work = rng.normal(size=(2, 6))
        rest = energies - work
        gain = max(rest[k] - rest[j] for k in range(6) for j in range(k + 1))
        worst.note("gain", lesson.gain_without_source(energies, work), gain)
        # the second is ahead by 0.5, 1.5 and 1 J, and is 2, 3 and 9 times as fast
        ends, now = iter((rest, rest + 0.5, rest, rest + 1.5, rest, rest + 1.0)), np.zeros(1)
        lengths = iter((2.0, 1.0, 3.0, 1.0, 9.0, 1.0))

        def run(ends=ends, lengths=lengths, now=now):
            now += next(lengths)                                 # the clock stands still between the runs
            return next(ends)
        worst.note("gain", lesson.compare(run, run, 3, now.item), (1.5, 3.0))

        # a disc at the margin of another, and of a plane: found before it touches, and not from farther away
        for share, count in ((0.9, 3), (1.1, 0)):
            gap, n = share * 0.05, SIDES[trial % 4]
            along = np.array([-n[1], n[0]])
            state, p = lesson.make_bodies_2d([(0.1 + gap) * n, (0.1 + gap) * n + (0.2 + gap) * along], np.zeros(2), 1.0,
                                             1.0, np.full((2, 2), 0.1), [(*n, 0.0)], (0.0, 0.0), 0.0, 1, 0.05)
            low, high, turn = lesson.disc_bounds(state.x, state.q, p.half)
            found = lesson.find_contacts(lesson.round_contacts, state.x, low, high, turn, p)
            worst.note("found", found.a.size, count)             # both are as near to the plane

        # a turned box comes down on one corner, in the plane and in space: this stops at the floor, or closes its gap
        R, angle, ahead = matrix_of(turns[0]), rng.uniform(0.2, 1.3), rng.choice((0.0, 0.004))
        flat = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        for axes, moment in ((flat, inertia[:1]), (R, moments[0])):
            d, half = len(axes), np.array([0.3, 0.2, 0.1][:len(axes)])
            corners = (np.stack(np.meshgrid(*[(-1.0, 1.0)] * d), axis=-1).reshape(-1, d) * half) @ axes.T
            lowest = corners[np.argmin(corners[:, -1])]
            if np.sort(corners[:, -1])[1] < lowest[-1] + 0.02:           # two corners come nearly at once
                continue
            place, n, fall = np.array([*[0.5] * (d - 1), ahead - lowest[-1]]), np.eye(d)[-1], -rng.uniform(1.0, 2.0)
            r, q = lowest - 0.5 * ahead * n, [angle] if d == 2 else turns[:1]
            state, p = (lesson.make_bodies_2d if d == 2 else lesson.make_bodies)(
                [place], q, m[0], moment if d == 2 else [moment], [half], [(*n, 0.0)], np.zeros(d), 0.0, 1, 0.01)
            state = state._replace(v=np.array([0.3 * np.eye(d)[0] + fall * n, np.zeros(d)]))
            step, *shape = (lesson.contact_step_2d, lesson.box_bounds_2d, lesson.box_contacts_2d) if d == 2 else (
                lesson.contact_step, lesson.box_bounds, lesson.box_contacts)
            end = step(lesson.weight, *shape, 0.0, state, dt, p)
            lever = np.array([r[0]]) if d == 2 else axes.T @ np.cross(r, n)      # in the body's coordinates
            j = (-ahead / dt - fall) / (1.0 / m[0] + np.sum(lever**2 / moment))
            spin = lever * j / moment if d == 2 else axes @ (lever * j / moment)
            worst.note("corner of a box", (end.v[0], end.omega[0], end.J),
                       (state.v[0] + j / m[0] * n, spin, j * n))
            worst.note("corner of a box", end.x[0], place + dt * (state.v[0] + j / m[0] * n))
            if d == 2:
                worst.note("corner of a box", end.q[0], angle + dt * spin)
            else:
                rate = np.linalg.norm(spin)
                half_turn = np.arctan(0.5 * rate * dt)
                worst.note("corner of a box", matrix_of(end.q[0]),
                           matrix_of(np.array([np.cos(half_turn), *(np.sin(half_turn) * spin / rate)])) @ R)
        worst.note("found", lesson.closing_speeds(np.array([0.02, -0.01]), dt), (-0.02 / dt, 0.0))

        # a corner that stops keeps the angular momentum about it
        v, omega, r, inv_mass, inv_inertia = rng.normal(size=2), rng.normal(), rng.normal(size=2), 1.0 / m[0], 3.0
        v_new, omega_new = lesson.corner_impact(v, omega, r, inv_mass, inv_inertia)
        about = lambda v, omega, r=r, k=inv_inertia, w=inv_mass: omega / k - (r[0] * v[1] - r[1] * v[0]) / w
        worst.note("corner", v_new + omega_new * np.array([-r[1], r[0]]), 0.0)
        worst.note("corner", about(v_new, omega_new), about(v, omega))

        # a ball that slips: its slip decreases by what friction and gravity do to centre and rotation
        radius, mu, I, slope = rng.uniform((0.1, 0.2, 0.01, -0.5), (0.5, 0.5, 0.1, 0.5))
        slope = slope if trial % 3 else 60.0                     # so steep that it slips faster and faster
        angle, r = rng.uniform(0.0, 6.28), np.array([0.0, 0.0, -radius])
        along = np.array([np.cos(angle), np.sin(angle), 0.0])
        ball = lesson.RollingBall(m[0], np.full(3, I), radius, mu, slope * along - [0.0, 0.0, G])
        omega = rng.normal(size=3)
        v = rng.uniform(0.5, 2.0) * along - np.cross(omega, r) * [1.0, 1.0, 0.0] + [0.0, 0.0, rng.normal()]
        size = np.linalg.norm((v + np.cross(omega, r))[:2])
        friction = -mu * m[0] * G * along
        slows = -(friction / m[0] + slope * along + np.cross(np.cross(r, friction) / I, r)) @ along
        worst.note("slip", lesson.slip_time(v, omega, ball), size / slows if slows > 0.0 else np.inf)
        seen, stops = [], lesson.slip_time(v, omega, ball)
        watched = lambda t, x, q, v, omega, p, seen=seen: (seen.append(t), (p.m * p.gravity, np.zeros(3)))[1]
        if stops < np.inf:
            lesson.exact_rolling_step(watched, t, x[0], np.array([1.0, 0.0, 0.0, 0.0]), v, omega, 2.0 * stops, ball)
            worst.note("parts", (min(seen), max(seen)), (t, t + stops))
        centre, v_s, omega_s, place = rng.normal(size=(4, 3))
        carried = lesson.CarriedBall(1.0, np.ones(3), 0.1, 0.5, np.array([0.0, 0.0, -G]), centre, v_s, omega_s)
        worst.note("floor", lesson.support_velocity(place, carried), v_s + np.cross(omega_s, place - centre))
    claims = (
        ("plane", "In the plane v changes by F/m and ω by τ/I, and positions by the new ones.",
         "state [m, m/s, rad/s]"),
        ("space", "In space ω changes by Euler's equation, for each body by its own tensor.",
         "state [m, m/s, rad/s]"),
        ("turn", "A body turns by 2 atan(½ |ω| dt) about its own new ω.", "orientation [-]"),
        ("times", "Each step takes the load of its own time.", "velocity after five steps [m/s]"),
        ("invariants", "Energy and momenta equal those by matrices; bodies that cannot move do not count.",
         "invariants [J, kg m²/s]"),
        ("gain", "A gain counts from any time on, without the work that was done; a difference counts either way.",
         "gain and difference [J]"),
        ("found", "Contacts are found up to the margin, and may close in one step.", "contacts and speeds [-, m/s]"),
        ("corner of a box", "The corner on which a box comes down stops there, or closes its gap.",
         "state and impulse [m, m/s, rad/s, N s]"),
        ("corner", "A corner that stops keeps the angular momentum about it.", "velocity and momentum [m/s, kg m²/s]"),
        ("slip", "A slip ends when friction and gravity have used it up.", "time [s]"),
        ("parts", "A ball rolls from when its slip has ended: loads are those of both times.", "times of loads [s]"),
        ("floor", "A floor that travels and turns has the velocity of each of its points.",
         "velocity of a floor [m/s]"))
    return [agreement(claim, f"{name}: largest error of the {quantity}", worst[name], 1e-9)
            for name, claim, quantity in claims], None


@case("rolling-by-contact", "What one contact does, step by step", compiled=False)
def rolling_by_contact(lesson):
    """A disc and a sphere roll down a slope: a = g sin θ/(1 + I/(m r²)), J_n = m g cos θ dt, J_t = −I a dt/r² per step.

    A round body decouples normal and tangent: in the plane one sweep is exact.  In space a sweep leaves half of the
    slip, because it counts both tangents.  The steps are those of symplectic Euler: after k of them v = k a dt and
    x = ½ k (k + 1) a dt².
    """
    found, dt, steps, theta, m, r, I = [], 0.01, 12, 0.3, 2.0, 0.4, 0.1
    down = G * np.sin(theta)
    a, k = down / (1.0 + I / (m * r * r)), np.arange(steps + 1)
    way, push = 0.5 * steps * (steps + 1) * a * dt * dt, m * G * np.cos(theta) * dt
    state, p = lesson.make_bodies_2d([(0.0, r)], [0.7], m, I, [(r, r)], [UP], (down, -G * np.cos(theta)), 0.9, 3,
                                     0.01)
    end = lesson.advance_contact(lesson.contact_step_2d, lesson.weight, lesson.disc_bounds, lesson.round_contacts, 0.0,
                                 state, dt, steps, p)
    truth = (way, r, 0.7 - way / r, steps * a * dt, 0.0, -steps * a * dt / r, -I * a * dt / r**2, push)
    got = (*end.x[0], end.q[0], *end.v[0], end.omega[0], *end.J[0])
    found.append(agreement("A disc rolls down a slope with g sin θ/(1 + I/(m r²)), by the impulses of theory.",
                           "disc: largest error of its state and impulse [m, rad, m/s, rad/s, N s]",
                           np.max(np.abs(np.array(got) - truth)), ROUND_OFF))
    state, p = lesson.make_bodies([(0.0, 0.0, r)], [(1.0, 0.0, 0.0, 0.0)], m, [(I, I, I)], [(r, r, r)],
                                  [(0.0, 0.0, 1.0, 0.0)], (down, 0.0, -G * np.cos(theta)), 0.9, 60, 0.01)
    end = lesson.advance_contact(lesson.contact_step, lesson.weight, lesson.ball_bounds, lesson.round_contacts, 0.0,
                                 state, dt, steps, p)
    turned = np.sum(np.arctan(0.5 * k * a * dt / r * dt))                   # half of the angle, about y
    truth = (way, 0.0, r, np.cos(turned), 0.0, np.sin(turned), 0.0, steps * a * dt, 0.0, 0.0,
             0.0, steps * a * dt / r, 0.0, -I * a * dt / r**2, 0.0, push)
    got = (*end.x[0], *end.q[0], *end.v[0], *end.omega[0], *end.J[0])
    found.append(agreement("A sphere does the same in space.",
                           "sphere: largest error of its state and impulse [m, -, m/s, rad/s, N s]",
                           np.max(np.abs(np.array(got) - truth)), ROUND_OFF))
    # with μ = 0.05 they slip: J_t = −μ J_n, a = g (sin θ − μ cos θ)
    slips = p._replace(mu=0.05)
    end = lesson.advance_contact(lesson.contact_step, lesson.weight, lesson.ball_bounds, lesson.round_contacts, 0.0,
                                 state, dt, steps, slips)
    flat, flat_p = lesson.make_bodies_2d([(0.0, r)], [0.7], m, I, [(r, r)], [UP], (down, -G * np.cos(theta)), 0.05, 3,
                                         0.01)
    end_2d = lesson.advance_contact(lesson.contact_step_2d, lesson.weight, lesson.disc_bounds, lesson.round_contacts,
                                    0.0, flat, dt, steps, flat_p)
    truth = steps * dt * (down - 0.05 * G * np.cos(theta)), steps * r * 0.05 * push / I, 0.05 * push
    errors = np.array((end.v[0, 0], end.omega[0, 1], -end.J[0, 0])) - truth, np.array(
        (end_2d.v[0, 0], -end_2d.omega[0], -end_2d.J[0, 0])) - truth
    found.append(agreement("With less friction both slip with g (sin θ − μ cos θ).",
                           "slipping disc and sphere: largest error [m/s, rad/s, N s]", np.max(np.abs(errors)),
                           ROUND_OFF))
    # three discs on each other, one sweep per step: without what is kept they would carry their weights only by sinking
    heights = r * (1.0 + 2.0 * np.arange(3))
    state, p = lesson.make_bodies_2d([(0.0, y) for y in heights], np.zeros(3), m, I, np.full((3, 2), r), [UP],
                                     (0.0, -G), 0.0, 1, 0.01)
    end = lesson.advance_contact(lesson.contact_step_2d, lesson.weight, lesson.disc_bounds, lesson.round_contacts, 0.0,
                                 state, 1e-4, 400, p)
    carried = np.sort(np.abs(end.J[:, 1])) / (m * G * 1e-4)
    found.append(agreement("Impulses that are kept carry a stack with one sweep per step: 1, 2 and 3 weights.",
                           "impulses under three discs over m g dt: largest error [-]",
                           np.max(np.abs(carried - (1.0, 2.0, 3.0))), 1e-6))
    state, p = lesson.make_bodies([(0.0, 0.0, y) for y in heights[:2]], [(1.0, 0.0, 0.0, 0.0)] * 2, m, [(I, I, I)] * 2,
                                  np.full((2, 3), r), [(0.0, 0.0, 1.0, 0.0)], (0.0, 0.0, -G), 0.0, 1, 0.01)
    piled = lesson.advance_contact(lesson.contact_step, lesson.weight, lesson.ball_bounds, lesson.round_contacts, 0.0,
                                   state, 1e-4, 80, p)
    carried = np.sort(np.abs(piled.J[:, 2])) / (m * G * 1e-4)
    found.append(agreement("So they do in space, at rest.",
                           "impulses under two spheres, and their speed, over those of g dt: largest error [-]",
                           max(np.max(np.abs(carried - (1.0, 2.0))), np.max(np.abs(piled.v)) / (G * 1e-4)), 1e-6))
    # a carried ball rolls on a floor at rest that is tilted, and turns by its way over its radius
    tilted, still = np.array([down, 0.0, -G]), np.zeros(3)
    ball = lesson.CarriedBall(m, np.full(3, I), r, 0.9, tilted, still, still, still)
    now = np.array([0.0, 0.0, r]), np.array([1.0, 0.0, 0.0, 0.0]), np.zeros(3), np.zeros(3)
    for k in range(steps):
        now = lesson.carried_step(lambda t, x, q, v, omega, p: (p.m * p.gravity, np.zeros(3)), k * dt, *now, dt, ball)
    half_turn = 0.5 * now[0][0] / r
    found.append(agreement("A carried ball turns by its way over its radius.",
                           "quaternion after 12 steps: largest error [-]",
                           np.max(np.abs(now[1] - (np.cos(half_turn), 0.0, np.sin(half_turn), 0.0))), ROUND_OFF))
    found.append(agreement("They carry it at rest.", "speed of three discs over g dt [-]",
                           np.max(np.abs(end.v)) / (G * 1e-4), 1e-6))
    return found, None


# ---------------------------------------------------------------------------------------------- release

BALL = (0.2, 1.0, 1.1)       # of a puck on a ball: angle at the start [rad], speed [m/s], distance of the centres [m]
STIFFNESS, DEPTH = 100.0, 0.3    # of the spring under a platform [N/m], below equilibrium at the start [m]
HEAVY, LIGHT = 1.0, 0.5      # masses of the platform and of the box on it [kg]


def puck_on_a_ball(lesson, ahead):
    """(load, shapes, PileState, Bodies) of a puck on a fixed disc, with the velocity that it has at t = −ahead."""
    start, speed, R = BALL
    angle, back = slides_on_ball(*BALL, G, -ahead) if ahead > 0.0 else (start, speed)
    state, p = lesson.make_bodies_2d([(0.0, 0.0), (R * np.sin(start), R * np.cos(start))], np.zeros(2), [np.inf, 1.0],
                                     [np.inf, np.inf], [(1.0, 1.0), (0.1, 0.1)], [], (0.0, -G), 0.0, 10, 0.2)
    v = back * np.array([(0.0, 0.0), (np.cos(angle), -np.sin(angle))])
    return lesson.weight, (lesson.disc_bounds, lesson.round_contacts), state._replace(v=v), p


def box_on_a_spring(lesson, ahead):
    """The same for a box on a platform on a spring, which begins at rest; the spring has its natural length at 0."""
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
    """(times [s], forces [N] between bodies 0 and 1) of such a scene; `ahead` [steps] is the leapfrog start."""
    load, shapes, state, p = scene(lesson, ahead * dt)
    ts, states = lesson.contact_trajectory(step, load, *shapes, 0.0, state, dt, int(seconds / dt) + 8, p)
    return ts[:-1], lesson.normal_forces(states, 0, 1, dt)


class Held(NamedTuple):
    """A body on a support that lets it go."""
    what: str                # as a sentence without its full stop
    scene: Callable          # (lesson, ahead [s]) → load, shapes, PileState, Bodies
    rate: float              # of the motion [1/s]
    a: float                 # acceleration along the motion at the start [m/s²]
    force: Callable          # (t [s]) → force of the support [N]
    time: Callable           # (more [m/s]) → time of release [s] if it begins faster by that


def supports():
    """The puck and the box, with their theories."""
    start, speed, R = BALL
    rate = np.sqrt(STIFFNESS / (HEAVY + LIGHT))

    def on_the_ball(t):
        angle, v = slides_on_ball(*BALL, G, t)
        return G * np.cos(angle) - v * v / R
    return (Held("a puck leaves a ball", puck_on_a_ball, np.sqrt(G / R), G * np.sin(start), on_the_ball,
                 lambda more: leaves_ball(start, speed + more, R, G)[0]),
            Held("a box leaves an oscillating platform", box_on_a_spring, rate, rate**2 * DEPTH,
                 lambda t: LIGHT * (G + rate**2 * DEPTH * np.cos(rate * t)),
                 lambda more: leaves_platform(DEPTH, more, rate, G)))


def about_release(lesson, held):
    """(findings, curves) of one of them."""
    what, T = held.what, held.time(0.0)
    run = lambda dt, ahead: pushed(lesson, lesson.contact_step_2d, held.scene, dt, ahead, T)
    dts = T / np.array([20.3, 40.6, 81.2])
    led, plain = (np.array([release(*run(dt, ahead)) for dt in dts]) for ahead in (0.5, 0.0))
    order, best = np.log2((led[1] - T) / (led[2] - T)), (4.0 * led[2] - led[1]) / 3.0
    dt, small, force = dts[2], held.rate * dts[1:], run(dts[2], 0.5)[1][2]
    found = [
        finding(claim="J/dt is the force of the support at the beginning of the step.",
                quantity=f"third force in the run in which {what} [N]", predicted=held.force(2.0 * dt), measured=force,
                tolerance=small[1] ** 2 * force, observation=f"The third force is {force:.4f} N."),
        finding(claim="From the impulses of steps a release is found with order 2 if the run has a leapfrog start.",
                quantity=f"order of the time at which {what} [-]", predicted=2.0, measured=order,
                tolerance=1.5 * small[0], observation=f"The order is {order:.2f} where {what}."),
        finding(claim="The support lets go where the force that holds the contact would begin to pull.",
                quantity=f"time at which {what}, from two steps [s]", predicted=T, measured=best,
                tolerance=small[0] ** 3 * T, observation=f"After {best:.6f} s {what}."),
        finding(claim="With v at the time of x the loop starts too fast by ½ a dt.",
                quantity=f"change of the time at which {what} by that start, dt = {1e3 * dt:.1f} ms [s]",
                predicted=held.time(0.5 * held.a * dt) - T, measured=plain[2] - led[2], tolerance=small[1] ** 2 * T,
                observation=f"So {what} {1e3 * (led[2] - plain[2]):.3f} ms early."),
    ]
    fine = np.linspace(0.0, dts[0], 30)
    return found, [
        series(f"{what}: theory", 1e3 * fine, [1e3 * (held.time(0.5 * held.a * dt) - T) for dt in fine], LINE),
        series(f"{what}: v at the time of x", 1e3 * dts, 1e3 * (plain - T), DOTS),
        series(f"{what}: leapfrog start", 1e3 * dts, 1e3 * (led - T), DOTS)]


@case("release-from-a-support", "When a support lets go", compiled=False)
def release_from_a_support(lesson):
    """The loop is the leapfrog method if v is half a step before x at the start, and J/dt is the force at x.

    So the release has order 2; the next order is a relative k dt, where k is the rate of the motion.  The best of two
    steps, (4 t(½dt) − t(dt))/3, then errs by (k dt)³ of the time.  If v belongs to the time of x, the loop follows a
    start with v + ½ a dt, to (k dt)² of the time.  On a round support the first two forces share their sum wrongly,
    because the gap is 0 only at the start.
    """
    (about_ball, ball), (about_platform, platform) = (about_release(lesson, held) for held in supports())
    return about_ball + about_platform, Picture(
        "Time of release from the impulses of steps", "dt [ms]", "error [ms]", ball + platform,
        "The lines are the releases after a start that is too fast by ½ a dt. A leapfrog start leaves an error of "
        "second order.")


@case("sweeps-until-settled", "When to stop sweeping", compiled=False)
def sweeps_until_settled(lesson):
    """Sweeps that end when they change little leave ρ/(1 − ρ) times the last change, with the contraction factor ρ.

    For n discs on top of each other ρ = cos²(π/(2n)): the floor does not move, so the lowest contact has half the
    inverse mass of the others.  The last change lies between ρ and 1 times the threshold.
    """
    n, m, r, dt, ts = 6, 2.0, 0.4, 1e-3, (1, 2, 4, 8, 16, 32)
    heights, truth = r * (1.0 + 2.0 * np.arange(n)), np.arange(1.0, n + 1.0)
    state, p = lesson.make_bodies_2d([(0.0, y) for y in heights], np.zeros(n), m, 0.1, np.full((n, 2), r), [UP],
                                     (0.0, -G), 0.0, 1, 0.01)

    def after(steps, step):
        return lesson.advance_contact(step, lesson.weight, lesson.disc_bounds, lesson.round_contacts, 0.0, state, dt,
                                      steps, p)

    def wrong(end):
        return np.max(np.abs(np.sort(np.abs(end.J[:, 1])) / (m * G * dt) - truth)) / n

    above, one = lesson.make_bodies_2d([(0.0, r + 0.005)], [0.0], m, 0.1, [(r, r)], [UP], (0.0, -G), 0.0, 1, 0.01)
    falling = above._replace(v=np.array([(0.0, -0.1), (0.0, 0.0)]))
    fallen = above.x[0, 1] - lesson.advance_contact(lesson.settled_contact_step_2d, lesson.weight, lesson.disc_bounds,
                                                    lesson.round_contacts, 0.0, falling, dt, 1, one).x[0, 1]
    rho = np.cos(np.pi / (2 * n)) ** 2
    bound = lesson.SETTLED * rho / (1.0 - rho)
    settled = lesson.settled_contact_step_2d
    left = {steps: wrong(after(steps, settled)) for steps in ts}
    alone, late = [wrong(after(steps, lesson.contact_step_2d)) for steps in ts], after(60, settled)
    found = [
        finding(claim="A first step, which knows no impulses, leaves as much as the threshold and the contraction say.",
                quantity="error of the forces under six discs over SETTLED ρ/(1 − ρ) [-]",
                predicted=0.5 * (1.0 + rho), measured=left[1] / bound, tolerance=0.5 * (1.0 - rho) + 0.01,
                observation=f"It leaves {left[1]:.1e} of the largest force."),
        agreement("Later steps, which know the impulses of the last one, leave less.",
                  "largest error of the forces after 2 to 32 steps [-]", max(list(left.values())[1:]), bound),
        agreement("Then the discs rest.", "speed of the discs after 60 steps, over g dt [-]",
                  np.max(np.abs(late.v)) / (G * dt), bound),
        agreement("What is about to land is not stopped before.", "way of a falling disc, 5 mm above the floor: "
                  "largest error, relative [-]", fallen / (dt * (0.1 + G * dt)) - 1.0, ROUND_OFF),
    ]
    percent = lambda errors: 100.0 * np.array(errors)
    return found, Picture("Forces under six discs", "step", "error of the forces over the largest [%]", [
        series("sweeps until settled", ts, percent(list(left.values())), DOTS),
        series("one sweep per step", ts, percent(alone), DOTS)],
        "Sweeps that go on until little changes find the forces in the first step. With one sweep per step dozens of "
        "steps go by, in which the discs sink into each other.")


# ---------------------------------------------------------------------------------------------- turns per step

SPINS = (0.5, 5.0, 50.0)     # angle [rad] by which a ball turns in its first step


def slipping_ball(lesson, spin, mu, dt, steps):
    """Return the PileState of a ball of 1 kg and 10 cm that is put on a floor with this ω about y, after some steps."""
    state, p = lesson.make_bodies([(0.0, 0.0, 0.1)], [(1.0, 0.0, 0.0, 0.0)], 1.0, [(0.004, 0.004, 0.004)],
                                  [(0.1, 0.1, 0.1)], [(0.0, 0.0, 1.0, 0.0)], (0.0, 0.0, -G), mu, 40, 0.01)
    state.omega[0, 1] = spin
    return lesson.advance_contact(lesson.contact_step, lesson.weight, lesson.ball_bounds, lesson.round_contacts, 0.0,
                                  state, dt, steps, p)


@case("turns-per-step", "A ball that turns many times per step", compiled=False)
def turns_per_step(lesson):
    """A ball put down with the spin Ω slips for 2RΩ/7μg with v = μ g t.  Then it rolls with v = 2RΩ/7, for any Ω dt.

    A ball looks the same from every side, so that the turn of a step changes neither the contact nor the impulse.
    Friction is constant while it slips, and J_t < μ J_n in the step in which it stops slipping, which conserves the
    angular momentum about the contact.  μ is chosen for a hundred steps of slip.
    *Source:* Coriolis 1835, with I = 2/5 m R².
    """
    dt, R, found, ends = 0.01, 0.1, [], []
    for turn in SPINS:
        spin = turn / dt
        mu = 2.0 * R * spin / (7.0 * G * 100.5 * dt)
        half, end = (slipping_ball(lesson, spin, mu, dt, steps) for steps in (50, 140))
        ends.append(end.v[0, 0])
        found.append(agreement("While a ball slips, it gains μ g per second and loses 5μg/2R of its spin.",
                               f"ball that turns by {turn:g} rad per step: error of v and R ω over R Ω [-]",
                               np.max(np.abs((half.v[0, 0] - mu * G * 50 * dt,
                                              R * half.omega[0, 1] - R * spin + 2.5 * mu * G * 50 * dt))) / (R * spin),
                               ROUND_OFF))
        found.append(agreement("In the end it rolls with 2/7 of the speed of its surface.",
                               f"ball that turns by {turn:g} rad per step: error of v and R ω over R Ω in the end [-]",
                               np.max(np.abs(np.array((end.v[0, 0], R * end.omega[0, 1])) / (R * spin) - 2.0 / 7.0)),
                               ROUND_OFF))
    fine = np.logspace(-1.0, 2.0, 40)
    return found, Picture("A ball put down with a spin", "log₁₀ of its turn in the first step [rad]",
                          "log₁₀ of its speed in the end [m/s]", [
        series("theory, 2/7 R Ω", np.log10(fine), np.log10(2.0 / 7.0 * R * fine / dt), LINE),
        series("measured", np.log10(SPINS), np.log10(ends), DOTS)],
        "The speed is right at eight turns per step as at half a radian. The orientation is not: quaternion_update "
        "turns by 2 arctan(½ω dt), which is at most half a turn per step.")


# ---------------------------------------------------------------------------------------------- turns through a wall

BAR, WALL = (1.0, 0.02), (0.2, 0.01)     # half sizes of a bar that turns about its centre, and of a wall beside it [m]
PLACE, REACH = 0.7, 0.02                 # of the wall, from the centre of the bar; margin [m]


def turns_to_a_wall(lesson, angle, omega):
    """(PileState, Bodies) of the bar at this angle [rad] to the wall, which nothing moves; no gravity."""
    state, p = lesson.make_bodies_2d([(0.0, 0.0), (PLACE, 0.0)], [angle, 0.0], [1.0, np.inf], [0.3, np.inf],
                                     [BAR, WALL], [], (0.0, 0.0), 0.0, 20, REACH)
    return state._replace(omega=np.array([omega, 0.0])), p


def angle_found():
    """The angle [rad] at which the bar comes within the margin of the wall's inner corner, at r:

    r sin θ = w cos θ + b + margin,     half thicknesses b of the bar and w of the wall
    """
    r = PLACE - WALL[0]
    return np.arctan2(WALL[1], r) + np.arcsin((BAR[1] + REACH) / np.hypot(r, WALL[1]))


def ends_of_turn(lesson, omega, dt):
    """(misses, errors) of 4 starts, just before the wall is near: runs that go on as if there were no wall, and runs
    of advance_contact that end in an error in place of that.
    """
    misses, errors, shapes = 0, 0, (lesson.box_bounds_2d, lesson.box_contacts_2d)
    for k in range(4):
        start = -angle_found() * (1.0 + 1e-9) - k / 4.0 * omega * dt
        state, p = turns_to_a_wall(lesson, start, omega)
        now, steps = state, 1 + int(np.ceil(2.0 * angle_found() / (omega * dt)))
        for n in range(steps):
            now = lesson.contact_step_2d(lesson.weight, *shapes, n * dt, now, dt, p)
        if now.omega[0] == omega:
            misses += 1
            try:
                lesson.advance_contact(lesson.contact_step_2d, lesson.weight, *shapes, 0.0, state, dt, steps, p)
            except Diverged:
                errors += 1
    return misses, errors


def silent_plates(lesson, ways, thin=0.01):
    """(runs that pass, errors) of a plate that flies towards another one, by these ways per step in half thicknesses.

    It begins just outside the margin, a half of `thin`.
    """
    passes, errors, dt, shapes = 0, 0, 0.01, (lesson.box_bounds_2d, lesson.box_contacts_2d)
    for way in ways:
        state, p = lesson.make_bodies_2d([(0.0, 2.51 * thin), (0.0, 0.0)], np.zeros(2), [1.0, np.inf], [0.3, np.inf],
                                         np.full((2, 2), (0.5, thin)), [], (0.0, 0.0), 0.0, 20, 0.5 * thin)
        now = state = state._replace(v=np.array([(0.0, -way * thin / dt), (0.0, 0.0)]))
        for n in range(3):
            now = lesson.contact_step_2d(lesson.weight, *shapes, n * dt, now, dt, p)
        if now.x[0, 1] < -2.0 * thin:
            passes += 1
            try:
                lesson.advance_contact(lesson.contact_step_2d, lesson.weight, *shapes, 0.0, state, dt, 3, p)
            except Diverged:
                errors += 1
    return passes, errors


@case("turns-through-a-wall", "How fast a bar may turn beside a thin wall", compiled=False)
def turns_through_a_wall(lesson):
    """A bar turns about its centre.  Its face meets the inner corner of a wall, which is parallel to it at θ = 0.

    The loop finds the contact where the gap is at most the margin, which is for |θ| ≤ θ*:
        r sin θ* = w cos θ* + b + margin
    Found at θ < 0 it stops the bar; behind the middle it is found on the wrong side, and lets the bar go on.  So no
    start misses the wall if ω dt ≤ θ*: dt = (w + b + margin)/(r ω) to first order, half of the thickness over the speed
    of the tip.  Twice that step and more can miss it altogether.
    """
    found, spins, edges, theta = [], (5.0, 80.0), [], angle_found()
    for omega in spins:
        edges.append(bisect(lambda dt, omega=omega: ends_of_turn(lesson, omega, dt)[0] > 0, 0.3 * theta / omega,
                            4.0 * theta / omega))
        found.append(finding(
            claim="No start misses the wall if the bar turns by at most the angle at which it comes near, in a step.",
            quantity=f"longest step that misses no wall, ω = {omega:g} rad/s [s]", predicted=theta / omega,
            measured=edges[-1], tolerance=1e-5 * theta / omega,
            observation=f"At {omega:g} rad/s the bar first passes at a step of {1e3 * edges[-1]:.3g} ms."))
    misses, errors = np.sum([ends_of_turn(lesson, 20.0, share * theta / 20.0) for share in (1.1, 1.5, 2.1, 5.0, 20.0)],
                            axis=0)
    found.append(finding(
        claim="No bar passes in silence: advance_contact ends in an error where the loop would miss the wall.",
        quantity=f"errors of {misses:.0f} runs that miss the wall, with 1.1 to 20 times that step [-]",
        predicted=max(misses, 1), measured=errors, tolerance=0.0,
        observation=f"{errors:.0f} of {misses:.0f} such runs end in an error."))
    ways = np.linspace(2.05, 8.05, 13)
    passes, errors = silent_plates(lesson, ways)
    found.append(finding(
        claim="A plate behind the middle of another one is let go on the far side, and this is an error, too.",
        quantity=f"plates that end in an error, of {ways.size} that fly 2 to 8 half thicknesses per step [-]",
        predicted=np.sum(ways > 2.51), measured=errors, tolerance=0.0,
        observation=f"{passes} of {ways.size} plates pass, and {errors} end in an error."))
    fine = np.geomspace(4.0, 100.0, 40)
    return found, Picture("A bar beside a thin wall", "log₁₀ of ω [rad/s]", "log₁₀ of the longest step [ms]", [
        series("theory, θ*/ω", np.log10(fine), np.log10(1e3 * theta / fine), LINE),
        series("measured", np.log10(spins), np.log10(1e3 * np.array(edges)), DOTS)],
        "Above the line a bar can turn through the wall between two steps, and advance_contact says so.")


# ---------------------------------------------------------------------------------------------- forces

SWING, CENTRE, INERTIA = 1.2, 0.7, 0.05  # of a pendulum: largest angle [rad], hinge to centre [m], moment [kg m²]
FEET = np.array([(0.5, 0.3), (-0.5, 0.3), (-0.5, -0.3), (0.5, -0.3)])        # of a table, 0.4 m below its centre [m]


def tension(lesson, dt, steps):
    """(angles [rad], forces [N] along the rod) of a pendulum of 2 kg, let go at SWING, after each joint_step_2d."""
    place = CENTRE * np.array([np.sin(SWING), -np.cos(SWING)])
    state, p = lesson.make_bodies_2d([place, (0.0, 0.0)], [SWING, 0.0], [2.0, np.inf], [INERTIA, np.inf],
                                     np.full((2, 2), 0.1), [], (0.0, -G), 0.0, 1, 0.01)
    p, now, angles, forces = lesson.make_joints(state, p, [0], [1], [(0.0, 0.0)], 0.0), state[:4], [], []
    for n in range(steps):
        now = lesson.joint_step_2d(lesson.weight, n * dt, *now, dt, p)
        F = lesson.joint_forces_2d(lesson.weight, (n + 1) * dt, *now, p)[0]
        angles.append(now[1][0])
        forces.append(F @ (-np.sin(now[1][0]), np.cos(now[1][0])))
    return np.array(angles), np.array(forces)


def tension_at(theta):
    """m g cos θ + m l ω² [N], where the energy gives ω² = 2 m g l (cos θ − cos θ₀)/(I + m l²)."""
    omega_squared = 4.0 * G * CENTRE * (np.cos(theta) - np.cos(SWING)) / (INERTIA + 2.0 * CENTRE**2)
    return 2.0 * G * np.cos(theta) + 2.0 * CENTRE * omega_squared


def legs(lesson, place):
    """Forces (4, 3) [N] of the ground on the feet of a table without weight that bears 100 N at place (2,) [m]."""
    load = lambda t, x, q, v, omega, p: (np.array([(0.0, 0.0, -100.0), np.zeros(3)]),
                                         np.array([np.cross((*place, 0.0), (0.0, 0.0, -100.0)), np.zeros(3)]))
    state, p = lesson.make_bodies([(0.0, 0.0, 0.4), (0.0, 0.0, 0.0)], [(1.0, 0.0, 0.0, 0.0)] * 2, [3.0, np.inf],
                                  [(0.2, 0.4, 0.5), (np.inf,) * 3], np.full((2, 3), 0.1), [], np.zeros(3), 0.0, 1, 0.01)
    p = lesson.make_joints(state, p, [0] * 4, [1] * 4, [(*foot, 0.0) for foot in FEET], 0.0)
    return lesson.joint_forces(load, 0.0, *state[:4], p)


def feet(lesson, place, dt):
    """Normal forces (left, right) [N] of a smooth floor on a box of 1 m that bears 100 N at `place` [m] of its middle.
    """
    load = lambda t, x, q, v, omega, p: (np.array([(0.0, -100.0), (0.0, 0.0)]), np.array([-100.0 * place, 0.0]))
    state, p = lesson.make_bodies_2d([(0.0, 0.2)], [0.0], 3.0, 0.3, [(0.5, 0.2)], [UP], (0.0, 0.0), 0.0, 60, 0.01)
    state = lesson.advance_contact(lesson.contact_step_2d, load, lesson.box_bounds_2d, lesson.box_contacts_2d, 0.0,
                                   state, dt, 20, p)
    N, _ = lesson.normal_and_friction(state, dt)
    return N[np.argsort(state.contacts.p[:, 0])]


@case("forces-of-supports", "What a rod and the legs of a table bear", compiled=False)
def forces_of_supports(lesson):
    """The rod of a pendulum bears m g cos θ + m l ω²; joint_step_2d leaves an error of order 2.

    Four legs are one more than the laws of equilibrium determine.  The shortest of all possible forces is that of
    equally stiff legs, whose shares are linear in the place of the foot:
        N_k = W (1/4 + x x_k/Σx² + y y_k/Σy²),      the load W at (x, y)
    Two feet on a floor are determined:  N = W (1/2 ± x/b),  b their distance.
    """
    (coarse, far), (angles, near) = tension(lesson, 0.02, 40), tension(lesson, 0.01, 80)
    swing = np.linspace(-SWING, SWING)
    errors = np.max(np.abs(far - tension_at(coarse))), np.max(np.abs(near - tension_at(angles)))
    rate = np.sqrt(2.0 * G * CENTRE / (INERTIA + 2.0 * CENTRE**2))
    places = ((0.0, 0.0), (0.2, 0.0), (0.25, 0.15), (-0.1, 0.3))
    wrong = max(np.max(np.abs(legs(lesson, place) - np.stack((0.0 * FEET[:, 0], 0.0 * FEET[:, 0], 100.0 * (
        0.25 + FEET @ (place / np.sum(FEET**2, axis=0)))), axis=1))) for place in places)
    shares = max(np.max(np.abs(feet(lesson, x, 0.01) - 100.0 * np.array((0.5 - x, 0.5 + x)))) for x in (0.0, 0.2, 0.4))
    found = [
        agreement("A rod bears m g cos θ + m l ω².", "error of its force over 3 m g, dt = 0.01 s [-]",
                  errors[1] / (6.0 * G), (rate * 0.01) ** 2),
        finding(claim="The force has the order of the step.", quantity="order of the force of a rod [-]", predicted=2.0,
                measured=np.log2(errors[0] / errors[1]), tolerance=(rate * 0.02) ** 2,
                observation=f"The order is {np.log2(errors[0] / errors[1]):.2f}."),
        agreement("Four legs share a load as four equal springs.", "error of the forces of four legs, 100 N [N]", wrong,
                  100.0 * ROUND_OFF),
        agreement("Two feet share a load by their levers.", "error of the forces of two feet, 100 N [N]", shares,
                  100.0 * ROUND_OFF),
    ]
    return found, Picture("The force in the rod of a pendulum", "angle [rad]", "force [N]", [
        series("theory, m g cos θ + m l ω²", swing, tension_at(swing), LINE),
        series("joint_forces_2d, dt = 20 ms", coarse, far, DOTS)],
        "A pendulum that is let go at 69° pulls in its lowest position with twice its weight and more.")
