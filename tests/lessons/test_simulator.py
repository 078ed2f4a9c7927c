"""Lesson 10 is right when the composed loop follows closed forms on floors that stand, slope and move, when events are
found to round-off, and when its invariants see what is wrong with a run.
"""

import itertools

import numpy as np
import pytest

from solutions.checks import BadInput
from validate.grading.expect import between, choice, close, numbers, raises, truth
from validate.reference import choices
from validate.reference.orientation import about, cross_matrix

exercise = pytest.mark.exercise
G = 9.81                     # [m/s²]
# Everything drawn is below 10 in its unit.  A comparison takes a few dozen operations, each rounded by 1.1e-16 of that.
ROUND_OFF = 1e-12
MANY = 1e-10                 # the same after a hundred steps
TINY = 1e-30                 # a size at which every fixed number that stands for zero, or for a bound, is noticed
SWEPT = 1e-9                 # of impulses that sweeps have found: 0.7 of the error is left by each of at least 60


def unit_vector(draw, d):
    """A direction along no axis of the coordinates."""
    n = draw(0.3, 1.0, d) * np.array([(-1.0) ** draw.whole(0, 1) for _ in range(d)])
    return n / np.linalg.norm(n)


def quaternions(draw, n):
    return np.stack([unit_vector(draw, 4) for _ in range(n)])


def matrix(q):
    """Rotation matrix of a unit quaternion: 1 + 2 w a* + 2 a* a*, with a* b = a × b."""
    star = cross_matrix(q[1:])
    return np.eye(3) + 2.0 * q[0] * star + 2.0 * star @ star


def oriented(q):
    """Rotation matrix of an orientation in the plane or in space.  Its sign and whole turns make no difference."""
    return matrix(q) if np.ndim(q) else np.array([[np.cos(q), -np.sin(q)], [np.sin(q), np.cos(q)]])


def moments(draw):
    """Three principal moments of a body [kg m²]."""
    return np.roll([1.0, draw(1.2, 1.5), draw(1.6, 2.0)], draw.whole(0, 2)) * draw(0.5, 1.5)


def often_zero(draw, n, d):
    """(n, d) numbers that are 0, a, −a or b: in a third of the rows all are 0, in others some, or two are equal."""
    a, b = draw(0.5, 1.0), draw(1.1, 2.0)
    return draw.rng.choice([0.0, a, -a, b], (n, d)) * draw.rng.choice([0.0, 1.0, 1.0], (n, 1))


def of_any_size(draw, *shape):
    """Numbers of either sign, from 1e-6 to 1e6."""
    return draw.rng.choice([-1.0, 1.0], shape) * 10.0 ** draw(-6.0, 6.0, shape)


def bodies_of(lesson, inv_mass, inv_inertia, half=None, planes=None, mu=0.3, sweeps=30, margin=0.01, gravity=None):
    """Bodies in the plane or in space, as the shape of inv_inertia says."""
    d = 2 if np.ndim(inv_inertia) == 1 else 3
    n = len(inv_mass) - (0 if planes is None else len(planes))
    down = -G * np.eye(d)[-1] if gravity is None else gravity
    return lesson.Bodies(np.array(inv_mass, float), np.array(inv_inertia, float),
                         np.full((n, d), 0.5) if half is None else np.array(half, float),
                         np.zeros((0, d + 1)) if planes is None else np.array(planes, float), down, float(mu), sweeps,
                         float(margin))


def made(lesson, x, m, moments, half, planes, mu, sweeps, margin):
    """(PileState, Bodies) at rest: n round bodies, and planes as further rows.

    Written out, because make_bodies is not compiled.
    """
    x, planes, n, p = np.array(x, float), np.array(planes, float), len(x), len(planes)
    d, I = x.shape[1], np.array(moments, float)
    still = np.zeros((p, *I.shape[1:]))
    bodies = bodies_of(lesson, np.append(np.full(n, 1.0 / m), np.zeros(p)), np.concatenate((1.0 / I, still)), half,
                       planes, mu, sweeps, margin)
    none = np.zeros(0, np.int64)
    contacts = lesson.ContactSet(np.zeros(n + 1, np.int64), none, none, np.zeros((0, d)), np.zeros((0, d)),
                                 np.zeros(0))
    q = np.zeros(n + p) if d == 2 else np.tile(np.eye(4)[0], (n + p, 1))
    spin = np.zeros(n + p) if d == 2 else np.zeros((n + p, 3))
    return lesson.PileState(np.vstack((x, np.zeros((p, d)))), q, np.zeros((n + p, d)), spin, contacts,
                            np.zeros((0, d))), bodies


def swirl_2d(t, x, q, v, omega, p):
    """Forces and torques that depend on all arguments, so that an outdated one is noticed.

    Places decide whether both act on a row, one of them, or none.
    """
    F = np.cos(t) - 0.5 * v + 0.3 * x + 0.1 * (q - omega).reshape((-1, 1))
    tau = np.sin(t) + 0.2 * q - 0.4 * omega + x[:, 0] * v[:, 1]
    return F * (x[:, :1] > 0.0), tau * (x[:, 1] <= 0.0)


def swirl(t, x, q, v, omega, p):
    """The same in space."""
    F = np.cos(t) - 0.5 * v + 0.3 * x + 0.1 * (q[:, 1:] - omega)
    tau = np.sin(t) + 0.2 * q[:, 1:] - 0.4 * omega + 0.1 * v
    return F * (x[:, :1] > 0.0), tau * (x[:, 1:2] <= 0.0)


T_0, T_1, T_2 = 1.0, 5.0, 6.0          # [s] from when weight is single and there is no kick; drag; a push
DRAG, TWIST = 5.0, 0.05                # [N s/m, N m s] force per speed, and torque per angular velocity
SPRING = 2.0                           # [N/m] force per distance from the origin


def late_weight(t, x, q, v, omega, p):
    """Weight, doubled until half a second before T_0, and drag and springs from T_1 on; outdated arguments are noticed.

    The springs pull towards the origin, and turn by the first number of q.
    All tests of contacts use it: the loop is compiled anew for each function that it is given.
    """
    F, tau, drag = np.zeros(x.shape), np.zeros(omega.shape), 1.0 if t >= T_1 else 0.0
    angles = q.reshape((x.shape[0], -1))
    for i in range(x.shape[0]):
        if p.inv_mass[i] > 0.0:
            F[i] = p.gravity / p.inv_mass[i] * (1.0 if t > 0.5 * T_0 else 2.0) - drag * (DRAG * v[i] + SPRING * x[i])
        tau[i] = -drag * TWIST * (omega[i] + angles[i, 0])
    return F, tau


def own_motion(t, x, q, v, omega, p):
    """A load that returns arrays which are not new: they belong to others."""
    return v, omega


def inertial(t, x, q, v, omega, p):
    """A load that is as large as bodies are heavy: it would double v and ω in a second, but for the gyroscopic term."""
    m = np.where(p.inv_mass > 0.0, 1.0 / np.maximum(p.inv_mass, 1e-300), 0.0)
    I = np.where(p.inv_inertia > 0.0, 1.0 / np.maximum(p.inv_inertia, 1e-300), 0.0)
    return m.reshape((-1, 1)) * v, I * omega


def by_place(t, x, q, v, omega, p):
    """A load whose torques are the places, in the place of units."""
    return v, x


def nothing(t, x, q, v, omega, p):
    return 0.0 * x, 0.0 * omega


def kinds(planes):
    """(moves, turns) of six rows and of so many planes: whether forces move and torques turn them, 1 or 0.

    (0, 1) is a wheel on an axle, (1, 0) keeps its direction, (0, 0) is driven.  With planes the last rows are driven;
    without them the first one is, and the last one is free.
    """
    rows = [(1.0, 1.0), (1.0, 1.0), (0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 0.0)]
    return np.array(rows + planes * [(0.0, 0.0)] if planes else rows[::-1]).T


def moving_2d(draw, lesson, planes):
    """(t, x, q, v, omega, dt, p) of six bodies of all kinds in the plane, and of so many planes."""
    moves, turns = kinds(planes)
    n = len(moves)
    lines = np.array([np.append(unit_vector(draw, 2), draw(-1.0, 1.0)) for _ in range(planes)]).reshape(-1, 3)
    p = bodies_of(lesson, moves * draw(0.3, 2.0, n), turns * draw(0.5, 5.0, n), planes=lines)
    return (draw(0.5, 1.5), draw(-2.0, 2.0, (n, 2)), draw(-9.0, 9.0, n), draw(-2.0, 2.0, (n, 2)), draw(-2.0, 2.0, n),
            draw(0.05, 0.2), p)


def moving(draw, lesson, planes):
    """The same in space."""
    moves, turns = kinds(planes)
    n = len(moves)
    I = np.stack([moments(draw) for _ in range(n)])
    faces = np.array([np.append(unit_vector(draw, 3), draw(-1.0, 1.0)) for _ in range(planes)]).reshape(-1, 4)
    p = bodies_of(lesson, moves * draw(0.3, 2.0, n), turns[:, None] / I, planes=faces)
    return (draw(0.5, 1.5), draw(-2.0, 2.0, (n, 3)), quaternions(draw, n), draw(-2.0, 2.0, (n, 3)),
            draw(-2.0, 2.0, (n, 3)), draw(0.05, 0.2), p)


SPECIAL = 128                # bodies that are drawn at once, so that all combinations of special values come up [-]


def special(draw, lesson, d):
    """(t, x, q, v, omega, dt, p) of bodies without planes whose numbers are often 0 or equal, and of one of each kind.

    They may be at rest, at the origin or along an axis; q may be the identity or a half-turn, moments equal or nearly
    so, and gravity 0.  A step may be short, or so long that bodies turn around.
    """
    x, v, q, omega = (often_zero(draw, SPECIAL, count) for count in ((2, 2, 1, 1) if d == 2 else (3, 3, 4, 3)))
    inv_mass = draw.rng.choice([0.0, 0.0, draw(0.3, 2.0), draw(11.0, 12.0)], SPECIAL)
    inv_inertia = draw.rng.choice([0.0, 1.0], (SPECIAL, 1)) * draw(0.5, 2.0, (SPECIAL, 1))
    if d == 2:
        q, omega, inv_inertia = q.ravel(), omega.ravel(), inv_inertia.ravel()
    else:
        a = draw(0.4, 0.5)
        inv_inertia = (inv_inertia > 0.0) / draw.rng.choice([a, 1.02 * a, 1.5 * a], (SPECIAL, 3))
        q[~q.any(axis=1), 0] = 1.0
        q /= np.linalg.norm(q, axis=1)[:, None]
    kinds = zip(v.any(axis=1), omega.reshape(SPECIAL, -1).any(axis=1), inv_mass > 0.0,
                inv_inertia.reshape(SPECIAL, -1).any(axis=1), strict=True)
    one_of_each = {kind: slice(i, i + 1) for i, kind in enumerate(kinds)}.values()
    for gravity, dt in ((np.zeros(d), draw(3.0, 5.0)), (np.zeros(d), draw(1e-3, 2e-3)), (draw(-5.0, 5.0, d), 0.1)):
        for rows in (slice(SPECIAL), *one_of_each):
            p = bodies_of(lesson, inv_mass[rows], inv_inertia[rows], gravity=gravity)
            yield draw(0.5, 1.5), x[rows], q[rows], v[rows], omega[rows], dt, p


def vast(draw, lesson, d):
    """(t, x, q, v, omega, dt, p) of bodies without planes whose numbers are from 1e-6 to 1e6, in steps as different."""
    n = 16
    for dt in (draw(1e-6, 1e-5), draw(1e3, 1e4)):
        x, v, inv_mass, inertias = (of_any_size(draw, n, count) for count in (d, d, 1, 1))
        q, omega = (of_any_size(draw, n), of_any_size(draw, n)) if d == 2 else \
            (quaternions(draw, n), of_any_size(draw, n, 1) * draw(0.5, 1.0, (n, 3)))
        inv_inertia = abs(inertias).ravel() if d == 2 else abs(inertias) * draw(0.5, 1.5, (n, 3))
        yield (draw(200.0, 900.0), x, q, v, omega, dt,
               bodies_of(lesson, abs(inv_mass).ravel(), inv_inertia, gravity=of_any_size(draw, d)))


def extremes(draw, lesson, d):
    """(load, size, t, x, q, v, omega, dt, p): bodies of next to no mass, or of enormous ones, and of next to no motion.

    All places, velocities and rates have this size; the orientations are then 0, or the identity.
    """
    t, x, q, v, omega, dt, p = moving_2d(draw, lesson, 2) if d == 2 else moving(draw, lesson, 2)
    for light in (TINY, 1.0 / TINY):
        yield (inertial, 1.0, t, x, q, v, omega, dt,
               p._replace(inv_mass=light * p.inv_mass, inv_inertia=light * p.inv_inertia))
    none = 0.0 * q if d == 2 else np.tile(np.eye(4)[0], (len(x), 1))
    yield own_motion, TINY, t, TINY * x, none, TINY * v, TINY * omega, dt, p


def turning(p):
    """Numbers of the rows that torques turn."""
    return np.flatnonzero(p.inv_inertia if p.inv_inertia.ndim == 1 else p.inv_inertia[:, 0])


def spins_after(q, omega, tau, dt, p):
    """ω of all bodies in space after dt, by Euler's equation."""
    omega = omega.copy()
    for i in turning(p):
        omega[i] += dt * euler(q[i], omega[i], tau[i], 1.0 / p.inv_inertia[i])
    return omega


def row_by_row(quantity, got, expected, tolerance, p):
    """Compare rows of bodies, and say what kind of row it is that differs."""
    got = numbers(quantity, got, np.shape(expected))
    off = np.abs(got - expected).reshape(len(got), -1)
    for i in np.flatnonzero(np.any(off > tolerance, axis=1)):
        signs = "above 0" if p.inv_mass[i] > 0.0 else "0", "above 0" if np.any(p.inv_inertia[i] > 0.0) else "0"
        close(quantity, got[i], expected[i], tolerance,
              given=f"row {i} of {len(expected)}: inv_mass is {signs[0]}, inv_inertia {signs[1]}")


def changed(quantity, got, before, change, p):
    """Compare rows with before + change, over the sizes of these two."""
    sizes = np.abs(before) + np.abs(change)
    row_by_row(f"{quantity}, over its size", np.asarray(got) / sizes, (before + change) / sizes, ROUND_OFF, p)


def spun(quantity, got, q, omega, tau, dt, p):
    """Compare rows of ω after the loads, over the sizes of what they are sums of.

    The terms of ω̇ are turned to the axes of the body and back.  So each component has the round-off of the longest.
    """
    light, heavy = np.max(p.inv_inertia, axis=1), np.max(1.0 / p.inv_inertia, axis=1)
    size_tau, size_omega = np.linalg.norm(tau, axis=1), np.linalg.norm(omega, axis=1)
    sizes = np.abs(omega) + (dt * light * (size_tau + heavy * size_omega**2))[:, None]
    row_by_row(f"{quantity}, over its size", np.asarray(got) / sizes, spins_after(q, omega, tau, dt, p) / sizes,
               ROUND_OFF, p)


def new_arrays(name, got, *given):
    """No result may share memory with an argument: a caller's change of one would change both."""
    shared = any(np.shares_memory(np.asarray(part), one) for part in got for one in given)
    truth(f"whether {name} returns an argument, or a part of one, in place of a new array", shared, False)


def euler(q, omega, tau, I):
    """ω̇ by Euler's equation in the world, with the whole tensor."""
    tensor = matrix(q) @ np.diag(I) @ matrix(q).T
    return np.linalg.solve(tensor, tau - np.cross(omega, tensor @ omega))


# ---------------------------------------------------------------------------------------------- without contact

def pushed(before, load, inverse, dt):
    """Velocities of bodies after their loads have acted for dt, body by body."""
    return before + dt * np.array([share * one for share, one in zip(inverse, load, strict=True)])


@exercise("10.1", points=0.5, hint="F, τ = load(t, x, q, v, omega, p); v + dt F/m and ω + dt τ/I, with inverse masses")
def test_loads_change_velocities_of_what_they_can_move(lesson, draw):
    ordinary = [moving_2d(draw, lesson, planes) for planes in (2, 0)]
    for t, x, q, v, omega, dt, p in (*ordinary, *special(draw, lesson, 2)):
        for load in (swirl_2d, own_motion, lesson.weight):
            F, tau = load(t, x, q, v, omega, p)
            got = lesson.new_velocities_2d(load, t, x, q, v, omega, dt, p)
            row_by_row("v after the loads [m/s]", got[0], pushed(v, F, p.inv_mass, dt), ROUND_OFF, p)
            row_by_row("ω after the loads [rad/s]", got[1], pushed(omega, tau, p.inv_inertia, dt), ROUND_OFF, p)
            new_arrays("new_velocities_2d", got, x, q, v, omega, *p[:2])
    for t, x, q, v, omega, dt, p in vast(draw, lesson, 2):
        for load in (swirl_2d, lesson.weight):
            F, tau = load(t, x, q, v, omega, p)
            got = lesson.new_velocities_2d(load, t, x, q, v, omega, dt, p)
            changed("v after the loads", got[0], v, dt * p.inv_mass[:, None] * F, p)
            changed("ω after the loads", got[1], omega, dt * p.inv_inertia * tau, p)
    spun_2d = lambda q, omega, tau, dt, p: pushed(omega, tau, p.inv_inertia, dt)
    check_extremes(draw, lesson, 2, lesson.new_velocities_2d, spun_2d, ROUND_OFF)


def check_extremes(draw, lesson, d, new_velocities, spins_after, tolerance):
    """Compare the velocities of `extremes` after the loads with their laws."""
    for load, size, t, x, q, v, omega, dt, p in extremes(draw, lesson, d):
        F, tau = load(t, x, q, v, omega, p)
        got = new_velocities(load, t, x, q, v, omega, dt, p)
        row_by_row("v after the loads, over its size", np.asarray(got[0]) / size,
                   pushed(v, F, p.inv_mass, dt) / size, ROUND_OFF, p)
        row_by_row("ω after the loads, over its size", np.asarray(got[1]) / size,
                   spins_after(q, omega, tau, dt, p) / size, tolerance, p)


@exercise("10.1", points=0.5, hint="the change of the total momentum is dt times the total force")
def test_momentum_changes_by_the_forces_times_dt(lesson, draw):
    t, x, q, v, omega, dt, p = moving_2d(draw, lesson, 0)
    p = p._replace(inv_mass=draw(0.3, 2.0, 6), inv_inertia=draw(0.5, 5.0, 6))
    got_v, got_omega = map(np.asarray, lesson.new_velocities_2d(swirl_2d, t, x, q, v, omega, dt, p))
    F, tau = swirl_2d(t, x, q, v, omega, p)
    close("change of momentum over dt [N]", np.sum((got_v - v) / p.inv_mass[:, None], axis=0) / dt, F.sum(axis=0), MANY)
    close("change of spin over dt [N m]", np.sum((got_omega - omega) / p.inv_inertia) / dt, tau.sum(), MANY)
    p = p._replace(inv_mass=10.0 ** np.array([9.0, 3.0, -1.0, -4.0, -9.0, 0.0]))
    fast = 300.0 * v
    got_v, got_omega = lesson.new_velocities_2d(lesson.weight, t, x, q, fast, omega, dt, p)
    close("v after dt in gravity, of a fast grain of dust as of a ship [m/s]", got_v, fast + dt * np.array([0.0, -G]),
          ROUND_OFF)
    close("ω after dt in gravity [rad/s]", got_omega, omega, 0.0)
    two = p._replace(inv_mass=draw(0.3, 2.0, 2), inv_inertia=draw(0.5, 5.0, 2))
    v, omega = v[:2].copy(), omega[:2].copy()
    got_v, got_omega = lesson.new_velocities_2d(own_motion, t, x[:2].copy(), q[:2].copy(), v, omega, dt, two)
    close("v of two bodies that their own motion drives [m/s]", got_v, (v.T * (1.0 + dt * two.inv_mass)).T, ROUND_OFF)
    close("ω of two bodies that their own motion drives [rad/s]", got_omega, omega * (1.0 + dt * two.inv_inertia),
          ROUND_OFF)


@exercise("10.2", points=0.5,
          hint="angular_acceleration(q[i], ω[i], τ[i], 1/inv_inertia[i]) for each body that can turn")
def test_every_body_in_space_obeys_euler(lesson, draw):
    ordinary = [moving(draw, lesson, planes) for planes in (2, 0)]
    for t, x, q, v, omega, dt, p in (*special(draw, lesson, 3), *ordinary):
        for load in (swirl, own_motion, lesson.weight):
            F, tau = load(t, x, q, v, omega, p)
            got = lesson.new_velocities(load, t, x, q, v, omega, dt, p)
            row_by_row("v after the loads [m/s]", got[0], pushed(v, F, p.inv_mass, dt), ROUND_OFF, p)
            row_by_row("ω after the loads [rad/s]", got[1], spins_after(q, omega, tau, dt, p), ROUND_OFF, p)
            new_arrays("new_velocities", got, x, q, v, omega, *p[:2])
    for size, load in itertools.product((1e-4, 1e-9), (swirl, lesson.weight)):
        heavy = p._replace(inv_mass=size * p.inv_mass, inv_inertia=size * p.inv_inertia)
        F, tau = load(t, x, q, v, omega, heavy)
        got = lesson.new_velocities(load, t, x, q, v, omega, dt, heavy)
        row_by_row("v of ships after the loads [m/s]", got[0], pushed(v, F, heavy.inv_mass, dt), ROUND_OFF, p)
        row_by_row("ω of ships after the loads [rad/s]", got[1], spins_after(q, omega, tau, dt, heavy), ROUND_OFF, p)
    fast = 300.0 * omega
    _, tau = swirl(t, x, q, v, fast, p)
    _, got_omega = lesson.new_velocities(swirl, t, x, q, v, fast, dt, p)
    row_by_row("ω of fast tops after the loads, over 300² [rad/s]", np.asarray(got_omega) / 300.0**2,
               spins_after(q, fast, tau, dt, p) / 300.0**2, ROUND_OFF, p)
    for t, x, q, v, omega, dt, p in vast(draw, lesson, 3):
        for load in (swirl, lesson.weight):
            F, tau = load(t, x, q, v, omega, p)
            got = lesson.new_velocities(load, t, x, q, v, omega, dt, p)
            changed("v after the loads", got[0], v, dt * p.inv_mass[:, None] * F, p)
            spun("ω after the loads", got[1], q, omega, tau, dt, p)
    check_extremes(draw, lesson, 3, lesson.new_velocities, spins_after, MANY)


@exercise("10.2", points=0.5, hint="the gyroscopic term does no work: ω · I ω̇ = ω · τ")
def test_the_power_is_that_of_the_torque(lesson, draw):
    t, x, q, v, omega, _, p = moving(draw, lesson, 0)
    dt, still = 1e-3, 0.0 * omega
    for load in (swirl, lesson.weight):
        _, tau = load(t, x, q, v, omega, p)
        _, got = lesson.new_velocities(load, t, x, q, v, omega, dt, p)
        for i in turning(p):
            tensor = matrix(q[i]) @ np.diag(1.0 / p.inv_inertia[i]) @ matrix(q[i]).T
            # (ω' − ω) rounds at 2e-16 of 2, over dt
            close("power ω · I (ω' − ω)/dt [W]", omega[i] @ tensor @ (np.asarray(got)[i] - omega[i]) / dt,
                  omega[i] @ tau[i], MANY, given=f"body {i}, torque {tau[i]} N m")
        row_by_row("ω after the loads [rad/s]", got, spins_after(q, omega, tau, dt, p), ROUND_OFF, p)
    _, tau = swirl(t, x, q, v, still, p)
    _, got = lesson.new_velocities(swirl, t, x, q, v, still, dt, p)
    row_by_row("ω of what begins to turn [rad/s]", got, spins_after(q, still, tau, dt, p), ROUND_OFF, p)
    p = p._replace(inv_inertia=1.0 / np.stack([moments(draw) for _ in p.inv_mass]))      # all can turn
    torques = draw(0.5, 2.0) * np.array([(1, -1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 0), (-1, -1, -1), (0, 1, -1)])
    _, got = lesson.new_velocities(by_place, t, torques, q, v, still, dt, p)
    row_by_row("ω of what begins to turn by a special torque [rad/s]", got, spins_after(q, still, torques, dt, p),
               ROUND_OFF, p)


@exercise("10.3", points=0.25, hint="velocities first; then positions and angles of all rows, with the new ones")
def test_a_step_in_the_plane_is_velocities_first(lesson, draw):
    ordinary = [moving_2d(draw, lesson, planes) for planes in (2, 0)]
    for t, x, q, v, omega, dt, p in (*ordinary, *special(draw, lesson, 2)):
        for load in (swirl_2d, lesson.weight):
            F, tau = load(t, x, q, v, omega, p)
            new_v, new_omega = pushed(v, F, p.inv_mass, dt), pushed(omega, tau, p.inv_inertia, dt)
            got = lesson.free_step_2d(load, t, x, q, v, omega, dt, p)
            for name, is_, should in zip(("x [m]", "q [rad]", "v [m/s]", "ω [rad/s]"), got,
                                         (x + dt * new_v, q + dt * new_omega, new_v, new_omega), strict=True):
                row_by_row(f"{name} after a step", is_, should, ROUND_OFF, p)
    for t, x, q, v, omega, dt, p in vast(draw, lesson, 2):
        F, tau = swirl_2d(t, x, q, v, omega, p)
        got = [np.asarray(part) for part in lesson.free_step_2d(swirl_2d, t, x, q, v, omega, dt, p)]
        changed("v after a step", got[2], v, dt * p.inv_mass[:, None] * F, p)
        changed("ω after a step", got[3], omega, dt * p.inv_inertia * tau, p)
        changed("x after a step", got[0], x, dt * got[2], p)
        changed("q after a step", got[1], q, dt * got[3], p)
    *_, (load, size, t, x, q, v, omega, dt, p) = extremes(draw, lesson, 2)
    got = [np.asarray(part) for part in lesson.free_step_2d(load, t, x, q, v, omega, dt, p)]
    row_by_row("x after a tiny step, over its size", got[0] / size, (x + dt * got[2]) / size, ROUND_OFF, p)
    row_by_row("q after a tiny step, over its size", got[1] / size, dt * got[3] / size, ROUND_OFF, p)


@exercise("10.3", points=0.25, hint="a fall is ½ g t² (1 + dt/t) long with symplectic Euler; angles grow by ω t")
def test_bodies_fly_on_parabolas_that_are_late_by_half_a_step(lesson, draw):
    _, x, q, v, omega, _, p = moving_2d(draw, lesson, 1)
    v[0], v[5], omega[1], omega[5] = 300.0 * v[0], 1e-9 * v[5], 100.0 * omega[1], 1e-9 * omega[5]    # fast, and slow
    T, n = draw(0.5, 1.5), draw.whole(10, 30)
    state = x, q, v, omega
    for k in range(n):
        state = lesson.free_step_2d(lesson.weight, k * T / n, *state, T / n, p)
    fall = -0.5 * G * T * T * (1.0 + 1.0 / n) * np.stack((0.0 * p.inv_mass, p.inv_mass > 0.0), axis=1)
    row_by_row("x after a flight [m]", state[0], x + T * v + fall, MANY, p)
    row_by_row("q after a flight [rad]", state[1], q + T * omega, MANY, p)
    close("ω after a flight [rad/s]", state[3], omega, 0.0)


@exercise("10.4", points=0.5, hint="quaternion_update(q[i], ω[i], dt) for each row, with its new ω")
def test_a_step_in_space_is_velocities_first(lesson, draw):
    ordinary = [moving(draw, lesson, planes) for planes in (2, 0)]
    for t, x, q, v, omega, dt, p in (*ordinary, *special(draw, lesson, 3)):
        for load in (swirl, lesson.weight):
            F, tau = load(t, x, q, v, omega, p)
            new_v, new_omega = pushed(v, F, p.inv_mass, dt), spins_after(q, omega, tau, dt, p)
            got = lesson.free_step(load, t, x, q, v, omega, dt, p)
            row_by_row("x after a step [m]", got[0], x + dt * new_v, ROUND_OFF, p)
            row_by_row("v after a step [m/s]", got[2], new_v, ROUND_OFF, p)
            row_by_row("ω after a step [rad/s]", got[3], new_omega, ROUND_OFF, p)
            row_by_row("orientation after a step, as a matrix",
                       [matrix(one) for one in numbers("q after a step", got[1], q.shape)],
                       [updated(q[i], new_omega[i], dt) for i in range(len(q))], ROUND_OFF, p)
    for t, x, q, v, omega, dt, p in vast(draw, lesson, 3):
        F, tau = swirl(t, x, q, v, omega, p)
        got = [np.asarray(part) for part in lesson.free_step(swirl, t, x, q, v, omega, dt, p)]
        changed("v after a step", got[2], v, dt * p.inv_mass[:, None] * F, p)
        spun("ω after a step", got[3], q, omega, tau, dt, p)
        changed("x after a step", got[0], x, dt * got[2], p)
        row_by_row("orientation after a step of any size, as a matrix", [matrix(one) for one in got[1]],
                   [updated(one, rate, dt) for one, rate in zip(q, got[3], strict=True)], ROUND_OFF, p)
    *_, (load, size, t, x, q, v, omega, dt, p) = extremes(draw, lesson, 3)
    got = [np.asarray(part) for part in lesson.free_step(load, t, x, q, v, omega, dt, p)]
    row_by_row("x after a tiny step, over its size", got[0] / size, (x + dt * got[2]) / size, ROUND_OFF, p)
    row_by_row("rotation vector of a tiny step, over its size", 2.0 * got[1][:, 1:] / got[1][:, :1] / size,
               dt * got[3] / size, ROUND_OFF, p)


def updated(q, omega, dt):
    """Rotation matrix after a quaternion_update: it turns about ω by 2 atan(½|ω| dt)."""
    rate = np.linalg.norm(omega)
    return about(omega / (rate or 1.0), 2.0 * np.arctan(0.5 * dt * rate)) @ matrix(q)


@exercise("10.4", points=0.5, hint="does every body turn, even without torque? q has one row for each body")
def test_bodies_of_revolution_precess_as_they_should(lesson, draw):
    """L is constant; the body turns about L by |L|/A and about its own axis by (1/C − 1/A) L_axis per second."""
    A, C, T = draw(0.8, 1.2), draw(1.5, 2.0), 1.0
    q, omega = quaternions(draw, 3), draw(0.5, 1.5, (3, 3))
    omega[2] *= 1e-7
    p = bodies_of(lesson, [1.0, 0.0, 0.0], [[1.0 / A, 1.0 / A, 1.0 / C], [0.0] * 3, [0.0] * 3], gravity=np.zeros(3))
    R, errors, across = matrix(q[0]), [], draw(-np.pi, np.pi)
    # it wobbles: where ω is nearly along an axis, the error of first order is small beside that of second order
    omega[0] = R @ (draw(1.0, 1.5, 3) * np.array([np.cos(across), np.sin(across), 1.0]))
    L = R @ (np.array([A, A, C]) * (R.T @ omega[0]))
    size = np.linalg.norm(L)
    axis = R[:, 2]
    truth = about(L / size, size / A * T) @ about(axis, (1.0 / C - 1.0 / A) * (L @ axis) * T) @ R
    for n in (100, 200):
        end = np.zeros((3, 3)), q, np.zeros((3, 3)), omega
        for k in range(n):
            end = lesson.free_step(lesson.weight, k * T / n, *end, T / n, p)
        errors.append(np.max(np.abs(matrix(np.asarray(end[1])[0]) - truth)))
    # |ω| is at most 2.6: the local error ½ dt² (|ω̇| + |ω̇||ω|) is below 12 dt² and grows by less than 4 in a second
    between("error of the orientation after a second, as a matrix", errors[1], 0.0, 48.0 / 200)
    between("error with 200 steps over error with 100", errors[1] / errors[0], 0.45, 0.55)
    for i, speed in ((1, ""), (2, ", and that turns very slowly")):
        spun = np.linalg.norm(omega[i])
        # the angle 2 atan(½|ω| dt) of a step is short by (|ω| dt)³/12
        close(f"orientation of a body that no torque turns{speed}, as a matrix", matrix(np.asarray(end[1])[i]),
              about(omega[i] / spun, spun * T) @ matrix(q[i]), spun**3 / 12.0 / 200**2 + MANY)


# ---------------------------------------------------------------------------------------------- contacts are found

def found(lesson, x, half, planes, p):
    """{(a, b): (gap, normal, place)} of what the lesson finds."""
    bounds = lesson.disc_bounds if x.shape[1] == 2 else lesson.ball_bounds
    q = np.zeros(len(x)) if x.shape[1] == 2 else np.tile(np.eye(4)[0], (len(x), 1))
    low, high, turned = bounds(x, q, p.half)
    c = lesson.find_contacts(lesson.round_contacts, x, low, high, turned, p)
    places = [k for i in range(len(half)) for k in range(c.first[i], c.first[i + 1]) if c.a[k] == i]
    close("contacts that are where first says [-]", len(places), len(c.a), 0.0)
    found = zip(c.a, c.b, c.gap, c.n, c.p, strict=True)
    return {(int(a), int(b)): (float(gap), n, place) for a, b, gap, n, place in found}


def touching(x, half, planes, movable, margin):
    """{(a, b): (gap, normal, place)} of all pairs within the margin of which one can move, planes last."""
    n, known = len(half), {}
    for i, j in itertools.combinations(range(n), 2):
        way = x[i] - x[j]
        known[i, j] = np.linalg.norm(way) - half[i, 0] - half[j, 0], way / np.linalg.norm(way)
    for i, (k, plane) in itertools.product(range(n), enumerate(planes)):
        known[i, n + k] = plane[:-1] @ x[i] + plane[-1] - half[i, 0], plane[:-1]
    return {(i, j): (gap, normal, x[i] - (half[i, 0] + 0.5 * gap) * normal) for (i, j), (gap, normal) in known.items()
            if gap <= margin and movable[[i, j]].any()}


def can_move(p):
    """(n + p,) whether an impulse moves or turns each body."""
    return (p.inv_mass > 0.0) | np.any(p.inv_inertia.reshape(p.inv_mass.size, -1) > 0.0, axis=1)


def crowd(draw, lesson, d, margin, planes=4, size=1.0):
    """(x, half, planes, Bodies): ten round bodies, of which two can neither move nor turn, and the first only turns.

    The last two planes are a floor and a ceiling, with bodies 9 and 1 next to them, at a part of the margin.  Two
    others only move.  All lengths are multiplied by `size`.
    """
    n = 10
    x, half = draw(0.0, 2.0, (n, d)), np.repeat(draw(0.2, 0.5, (n, 1)), d, axis=1)
    x[9, -1] = half[9, 0] - 0.5 + 0.99 * margin
    x[1, -1] = 1.5 - half[1, 0] - draw(0.3, 0.99) * margin
    faces = np.stack([np.append(unit_vector(draw, d), draw(-0.5, 0.5)) for _ in range(2)]
                     + [np.append(np.eye(d)[-1], 0.5), np.append(-np.eye(d)[-1], 1.5)])[:planes]
    x, half, margin, faces = size * x, size * half, size * margin, faces * np.append(np.ones(d), size)
    inv_mass, inv_inertia = draw(0.5, 2.0, n + planes), draw(0.5, 2.0, n + planes)
    inv_mass[[0, 4, 7]] = inv_mass[n:] = inv_inertia[n:] = inv_inertia[[1, 4, 7, 9]] = 0.0
    bodies = bodies_of(lesson, inv_mass, inv_inertia if d == 2 else np.repeat(inv_inertia[:, None], 3, axis=1), half,
                       faces, margin=margin)
    return np.vstack((x, np.zeros((planes, d)))), half, faces, bodies


@exercise("10.5", points=0.25, hint="widen the boxes by the margin on all sides, and let narrow find gaps up to margin")
def test_all_gaps_up_to_the_margin_are_found_and_no_others(lesson, draw):
    for d, planes in ((2, 4), (3, 4), (2, 0), (3, 0)):
        for share, light, size in ((draw(0.01, 0.05), 1.0, 1.0), (draw(0.2, 0.4), 1.0, 1e-6),
                                   (draw(0.2, 0.4), 1e-20, 1e4)):
            x, half, faces, p = crowd(draw, lesson, d, share, planes, size)
            p, margin = p._replace(inv_mass=light * p.inv_mass), p.margin
            got, expected = found(lesson, x, half, faces, p), touching(x, half, faces, can_move(p), margin)
            close("number of contacts [-]", len(got), len(expected), 0.0,
                  given=f"margin {margin} m, {d} dimensions, {planes} planes, inverse masses {p.inv_mass} 1/kg")
            close("contacts that are not among them [-]", len(set(got) - set(expected)), 0, 0.0)
            for what, k, shape, unit in (("gaps [m]", 0, (), size), ("normals [-]", 1, (d,), 1.0),
                                         ("places [m]", 2, (d,), size)):
                close(f"their {what}", np.reshape([got[pair][k] for pair in sorted(got)], (-1, *shape)),
                      np.reshape([expected[pair][k] for pair in sorted(got)], (-1, *shape)), unit * ROUND_OFF)
    for d in (2, 3):
        check_edge(lesson, draw, d)


def check_edge(lesson, draw, d):
    """A body above a floor, alone or with one beside it, at exactly the margin or a rounding farther.

    All lengths are multiplied by `size`.
    """
    for n, size in itertools.product((1, 2), (1.0, 2.0**10, 2.0**-10)):
        margin, r = size * 2.0 ** draw.whole(-4, -1), size * 0.5
        for more, count in ((0.0, n), (2.0**-30, 0)):
            x, half, first = np.zeros((n + 1, d)), np.full((n, d), r), np.eye(n + 1)[0]
            x[:n, -1] = r + margin * (1.0 + more)
            x[1:n, 0] = 2.0 * r + margin * (1.0 + more)
            p = bodies_of(lesson, first, 0.0 * first if d == 2 else np.zeros((n + 1, 3)), half,
                          [np.append(np.eye(d)[-1], 0.0)], margin=margin)
            close("number of contacts at the edge of the margin [-]", len(found(lesson, x, half, p.planes, p)), count,
                  0.0, given=f"{n} above the floor, gaps {margin * (1.0 + more)} m, margin {margin} m")


@exercise("10.5", points=0.25, hint="movable_pairs(pairs, p) leaves out pairs of which neither body can move or turn")
def test_two_bodies_that_no_impulse_moves_have_no_contact(lesson, draw):
    for d in (2, 3):
        margin = draw(0.1, 0.2)
        x, half, planes, p = crowd(draw, lesson, d, margin)
        x[7] = x[4] + 0.1                                                # two that overlap and cannot move
        got = found(lesson, x, half, planes, p)
        still = [pair for pair in got if not can_move(p)[list(pair)].any()]
        close("contacts of bodies that no impulse moves [-]", len(still), 0, 0.0)
        x[5], x[6], x[0] = x[4], x[7] - 0.1, x[4] - 0.1                  # one centre on the other, two beside others
        got = found(lesson, x, half, planes, p)
        for pair, how in (((4, 5), "moves"), ((6, 7), "moves"), ((0, 4), "only turns")):
            truth(f"whether a body that {how} touches one that does not", pair in got, True)


@pytest.mark.counts_calls                                            # boxes would be compiled anew, for seconds
@exercise("10.5", points=0.5, hint="narrow(x, turn, p.half, …): use the function and the turn that are handed in")
def test_a_turned_box_touches_a_floor_with_its_lowest_corners(lesson, draw):
    """Boxes that lie on their long side, raised by a little on one end, and boxes that stand upright."""
    for d, bounds, narrow in ((2, lesson.box_bounds_2d, lesson.box_contacts_2d),
                              (3, lesson.box_bounds, lesson.box_contacts)):
        long, lean, margin = draw(0.5, 0.8), draw(0.02, 0.1), draw(0.05, 0.1)
        half = np.full((2, d), 0.2)
        half[:, 0] = long
        for turns in ((lean, -2.0 * lean), (0.5 * np.pi + lean, -0.5 * np.pi - 2.0 * lean)):
            q = np.array([*turns, 0.0])                                  # about z in the plane, about y in space
            if d == 3:
                q = np.stack([np.cos(0.5 * q), 0.0 * q, -np.sin(0.5 * q), 0.0 * q], axis=1)
            corners = np.array(list(itertools.product((-1.0, 1.0), repeat=d))) * half[0]
            heights = [np.sin(turn) * corners[:, 0] + np.cos(turn) * corners[:, -1] for turn in turns]
            ways = [np.cos(turn) * corners[:, 0] - np.sin(turn) * corners[:, -1] for turn in turns]
            x = np.zeros((3, d))
            x[:2, 0], x[:2, -1] = (-3.0, 3.0), [0.2 * margin - np.min(one) for one in heights]
            plane = np.append(np.eye(d)[-1], 0.0)
            inverse = np.array([1.0, 1.0, 0.0])
            p = bodies_of(lesson, inverse, inverse if d == 2 else np.repeat(inverse[:, None], 3, axis=1), half, [plane],
                          margin=margin)
            got = lesson.find_contacts(narrow, x, *bounds(x, q, p.half), p)
            for i in range(2):
                gaps = heights[i] - np.min(heights[i]) + 0.2 * margin
                along, gaps = x[i, 0] + ways[i][gaps <= margin], np.sort(gaps[gaps <= margin])
                mine = np.asarray(got.a) == i
                close("number of contacts of a box with the floor [-]", np.count_nonzero(mine), len(gaps), 0.0,
                      given=f"half sizes {half[0]} m, turned by {turns[i]} rad")
                close("gaps of a box [m]", np.sort(np.asarray(got.gap)[mine]), gaps, ROUND_OFF)
                close("heights of its contacts [m]", np.sort(np.asarray(got.p)[mine, -1]), 0.5 * gaps, ROUND_OFF)
                close("places of its contacts along the floor [m]", np.sort(np.asarray(got.p)[mine, 0]), np.sort(along),
                      ROUND_OFF, given=f"half sizes {half[0]} m, turned by {turns[i]} rad")


# ---------------------------------------------------------------------------------------------- loops with contact

def weighted_bounds(x, q, half):
    """Boxes around balls whose mass may not be spread evenly: their rotation counts.

    All tests in space use it: the loop is compiled anew for each function that it is given.
    """
    n = half.shape[0]
    turned = np.zeros((n, 3, 3))
    for i in range(n):
        w, a, b, c = q[i, 0], q[i, 1], q[i, 2], q[i, 3]
        turned[i, 0, 0], turned[i, 0, 1] = 1.0 - 2.0 * (b * b + c * c), 2.0 * (a * b - w * c)
        turned[i, 0, 2], turned[i, 1, 0] = 2.0 * (a * c + w * b), 2.0 * (a * b + w * c)
        turned[i, 1, 1], turned[i, 1, 2] = 1.0 - 2.0 * (a * a + c * c), 2.0 * (b * c - w * a)
        turned[i, 2, 0], turned[i, 2, 1] = 2.0 * (a * c - w * b), 2.0 * (b * c + w * a)
        turned[i, 2, 2] = 1.0 - 2.0 * (a * a + b * b)
    return x[:n] - half, x[:n] + half, turned


def run(lesson, state, p, dt, steps=1, t=T_0):
    """So many steps of discs or balls, one by one: the loop over steps takes long to compile."""
    step, bounds = lesson.contact_step, weighted_bounds
    if state.x.shape[1] == 2:
        step, bounds = lesson.contact_step_2d, lesson.disc_bounds
    for k in range(steps):
        state = step(late_weight, bounds, lesson.round_contacts, t + k * dt, state, dt, p)
    return state


def row_of(draw, lesson, d, heights, r, mu=0.5, sweeps=1, margin=0.05):
    """(PileState, Bodies) of discs or balls side by side, 3 m apart, their lowest points at these heights."""
    n, m = len(heights), draw(0.5, 2.0)
    x = np.zeros((n, d))
    x[:, 0], x[:, -1] = 3.0 * np.arange(n), np.array(heights) + r
    shape = (n,) if d == 2 else (n, 3)
    return made(lesson, x, m, np.full(shape, 0.5 * m * r * r), np.full((n, d), r), [np.append(np.eye(d)[-1], 0.0)], mu,
                sweeps, margin)


def without_planes(state, p):
    """(PileState, Bodies) without the rows of the planes."""
    n = len(p.half)
    return (state._replace(x=state.x[:n], q=state.q[:n], v=state.v[:n], omega=state.omega[:n]),
            p._replace(inv_mass=p.inv_mass[:n], inv_inertia=p.inv_inertia[:n], planes=p.planes[:0]))


def flies(lesson, draw, d):
    """Far above a belt: a driven row, a free one, one that cannot turn, and a wheel on an axle, with fast spins."""
    state, p = row_of(draw, lesson, d, draw(8.0, 9.0, 4), draw(0.2, 0.5))
    p = p._replace(inv_mass=p.inv_mass * [0.0, 1.0, 1.0, 0.0, 0.0])
    p.inv_inertia[[0, 2]] = 0.0
    v, omega = draw(-2.0, 2.0, (5, d)), draw(-9.0, 9.0, state.omega.shape)
    v[1, 0], v[4, -1] = draw(1e-4, 1e-3), 0.0                            # a slow row; a belt moves along itself
    v[2, -1], omega[1] = draw(200.0, 400.0), 30.0 * omega[1]             # a fast row, and a fast spin
    state.x[0, 0], state.x[2, 0], v[3], omega[3] = 1e-5, 500.0, 1e-8 * v[3], 1e-8 * omega[3]
    q = draw(-9.0, 9.0, 5) if d == 2 else quaternions(draw, 5)
    start = state._replace(q=q, v=v, omega=omega)
    n, dt = draw.whole(3, 6), draw(0.01, 0.05)
    T, fall = n * dt, -G * np.outer(p.inv_mass > 0.0, np.eye(d)[-1])
    end = run(lesson, start, p, dt, n)
    row_by_row("x after a flight [m]", end.x, start.x + T * v + 0.5 * T * T * (1.0 + 1.0 / n) * fall, MANY, p)
    row_by_row("v after a flight [m/s]", end.v, v + T * fall, MANY, p)
    row_by_row("ω after a flight [rad/s]", end.omega, omega, MANY, p)
    if d == 2:
        row_by_row("q after a flight [rad]", end.q, q + T * omega, MANY, p)
    for late, drag, part in ((-0.5, 0.0, 1.0), (0.5, 1.0, 1.0), (1.0, 1.0, 1e-5), (-0.5, 0.0, 1e7)):      # around T_1
        when, dt = f"a step that begins {'after' if drag else 'before'} drag sets in", part * dt
        end, angles = run(lesson, start, p, dt, 1, T_1 + late * dt), q if d == 2 else q[:, :1]
        slower = omega - dt * drag * TWIST * p.inv_inertia * (omega + angles)
        row_by_row(f"v after {when} [m/s]", end.v,
                   v + dt * fall - dt * drag * p.inv_mass[:, None] * (DRAG * v + SPRING * start.x), ROUND_OFF, p)
        row_by_row(f"ω after {when} [rad/s]", end.omega, slower, MANY, p)
        turned = [oriented(q[i] + dt * slower[i]) if d == 2 else updated(q[i], slower[i], dt) for i in range(5)]
        row_by_row(f"orientation after {when}, as a matrix", [oriented(one) for one in end.q], turned, MANY, p)


def finds_what_is_near_at_the_beginning(lesson, draw, d):
    """Over a floor a body leaves, one hovers within the margin, one comes from beyond it; two more are side by side."""
    r, dt, margin = draw(0.2, 0.5), 0.02, 0.05
    hover, beside = 0.99 * margin, draw(0.5, 0.99) * margin
    state, p = row_of(draw, lesson, d, [0.0, hover, 1.01 * margin, 2.0, 2.0], r, margin=margin)
    state.x[4, 0] = state.x[3, 0] + 2.0 * r + beside
    state.v[0, -1], state.v[2, -1] = 10.0 * margin / dt, -10.0 * margin / dt
    end = run(lesson, state, p, dt)
    order = np.lexsort((end.contacts.b, end.contacts.a))
    pairs = np.stack((end.contacts.a, end.contacts.b), axis=1)
    close("pairs of the contacts [-]", np.ravel(pairs[order]), (0, 5, 1, 5, 3, 4), 0.0,
          given="gaps of 0, 0.99, 1.01 and 0.5 to 0.99 times the margin at the beginning of the step")
    close("gaps of the contacts [m]", np.asarray(end.contacts.gap)[order], (0.0, hover, beside), ROUND_OFF)
    close("sizes of their impulses [N s]", np.linalg.norm(end.J, axis=1), np.zeros(3), ROUND_OFF)


def falls_and_stops(lesson, draw, d):
    """Free fall, but no lower than the surface: h' = max(0, h + dt (v − g dt)), and v' = (h' − h)/dt.

    The second body comes down from within the margin with twice the margin per step, and closes its gap in one step.
    The third one has hardly a gap.
    """
    r, dt, margin = draw(0.2, 0.5), 0.01, 0.1
    state, p = row_of(draw, lesson, d, [-0.1], r)
    end = run(lesson, state, p, dt)
    close("velocity of a body that begins inside the floor [m/s]", np.asarray(end.v)[0], np.zeros(d), ROUND_OFF)
    close("place of a body that begins inside the floor [m]", np.asarray(end.x)[0], state.x[0], ROUND_OFF)
    h = np.array([draw(0.05, 0.2), draw(0.7, 0.9) * margin, draw(2e-10, 9e-10)])
    v = -np.array([draw(0.5, 1.5), 2.0 * margin / dt, draw(0.5, 1.5)])
    state, p = row_of(draw, lesson, d, h, r, sweeps=3, margin=margin)
    state.v[:3, -1] = v
    for k in range(25):
        state = run(lesson, state, p, dt, 1, T_0 + k * dt)
        h, before = np.maximum(0.0, h + dt * (v - G * dt)), h
        v = (h - before) / dt
        for i, kind in enumerate(("a slow body", "a body that closes its gap in one step", "what is near")):
            close(f"height of {kind} that falls on a floor [m]", np.asarray(state.x)[i, -1] - r, h[i], ROUND_OFF)
            close(f"velocity of {kind} that falls on a floor [m/s]", np.asarray(state.v)[i, -1], v[i], MANY)


def is_carried(lesson, draw, d):
    """Friction ends when v = belt + the speed of the rim: v = c/(1 + c) belt with I = c m r².  Here c = ½.

    A roller is a driven row that turns; its rim is a belt.  A lift is a driven row that rises.  A wheel on an axle
    turns, too, but impulses change its spin: with the same c it loses 2/5 of it, and the body gets 1/5 of ω r.
    Next to no weight is enough for friction where μ = ∞; nothing else is there, not even a plane.
    """
    speed, dt, r, sweeps = draw(0.5, 1.5), 0.01, draw(0.2, 0.5), 1 if d == 2 else 40     # in space k_t is a bound
    state, p = row_of(draw, lesson, d, [0.0], r, draw(0.3, 0.6), sweeps)
    state.v[1, 0] = speed
    n = int(np.ceil(speed / (3.0 * p.mu * G) / dt)) + 2
    end, along = run(lesson, state, p, dt, n), np.eye(d)[0]
    close("velocity of a body on a belt [m/s]", np.asarray(end.v)[0], speed / 3.0 * along, MANY,
          given=f"belt {speed} m/s")
    spin = 2.0 * speed / 3.0 / r
    close("its angular velocity [rad/s]", np.asarray(end.omega)[0], spin if d == 2 else (0.0, -spin, 0.0), MANY)
    close("velocity of the belt [m/s]", np.asarray(end.v)[1], speed * along, 0.0)
    for v, omega, free in ((speed, 0.0, 0.0), (0.0, speed / r, 0.0), (0.0, speed / r, 1.0)):
        state, p = row_of(draw, lesson, d, [0.0, 2.0 * r], r, np.inf, sweeps)
        state.x[:2, 0], state.x[:2, -1] = 0.0, state.x[:2, -1] + 5.0
        state.v[0, -1] = v
        state.omega[0] = omega if d == 2 else (0.0, -omega, 0.0)
        p.inv_mass[0] = 0.0
        p.inv_inertia[0] *= free
        state, p = without_planes(state, p._replace(gravity=1e-6 * p.gravity))
        once, twice = run(lesson, state, p, dt), run(lesson, state, p, dt, 2)
        # the rim on top moves with −ω r, and pulls the body by c/(1 + c) of it
        expected = v * np.eye(d)[-1] - omega * r / (3.0 + 2.0 * free) * along
        close(f"velocity of a body on {'a lift' if v else 'a roller that turns'} [m/s]", np.asarray(once.v)[1],
              expected, MANY, given=f"lift {v} m/s, rim of the roller {omega * r} m/s")
        close("place of the driven row after two steps [m]", np.asarray(twice.x)[0], state.x[0] + 2.0 * dt * state.v[0],
              MANY)
        close("angular velocity of the driven row, or of the wheel [rad/s]", np.asarray(twice.omega)[0],
              (1.0 - 0.4 * free) * state.omega[0], MANY * free)


def sweeps_halve_the_error(lesson, draw, d):
    """Two bodies above each other, from nothing: each sweep halves the error of the force on the ground.

    The upper joint gets half of the lower force, the lower joint the weight and the upper force: 1, 1½, 1¾ … m g.
    With k times the mass above, it gets ρ = k/(1 + k) of it: 1 + ρ + ρ² … = (1 + k) (1 − ρˢ) after s sweeps.
    """
    dt, r = 0.01, draw(0.2, 0.5)
    for sweeps, light, k in ((draw.whole(3, 6), 1.0, 1.0), (1, 1.0, 1.0), (2, 1.0, 1.0), (30, 1.0 / TINY, 1.0),
                             (30, TINY, 1.0), (100, 1.0, draw(15.0, 25.0))):
        state, p = row_of(draw, lesson, d, [0.0, 2.0 * r], r, sweeps=sweeps)
        p = p._replace(inv_mass=light * p.inv_mass / [1.0, k, 1.0], inv_inertia=light * p.inv_inertia)
        state.x[:2, 0] = 0.0
        end, unit = run(lesson, state, p, dt), G * dt / p.inv_mass[0]
        close("force on the ground over m g, after some sweeps from nothing [-]", forces_in(end, 2, unit)[0],
              (1.0 + k) * (1.0 - (k / (1.0 + k)) ** sweeps), MANY,
              given=f"{sweeps} sweeps, {1.0 / p.inv_mass[0]} kg below, {k} times that above")
        close("place after them [m]", end.x, state.x + dt * np.asarray(end.v), ROUND_OFF)


def groove(lesson, draw, d, jammed, planes=True, heavy=1.0):
    """(PileState, Bodies, ways up along the walls): a body in a symmetric groove of two planes or two bodies, at rest.

    It remembers forces that carry it: 2 (N sin α + T cos α) = m g, with N across and T along both walls, friction up
    and inwards.  T = 0 unless it is jammed.
    """
    alpha, m, r, dt = draw(0.5, 0.7), heavy * draw(0.5, 2.0), draw(0.2, 0.5), 0.002
    walls = np.zeros((2, d + 1))
    walls[:, 0], walls[:, d - 1] = (np.cos(alpha), -np.cos(alpha)), np.sin(alpha)
    x = np.eye(d)[-1] * r / np.sin(alpha) - np.vstack((np.zeros(d), 2.0 * r * walls[:, :d]))[:1 if planes else 3]
    state, p = made(lesson, x, m, np.full(x.shape[:1] if d == 2 else x.shape, 0.4 * m * r * r), np.full(x.shape, r),
                    walls, 0.5, 1, 10.0 ** draw(-2.5, -1.5))
    p.inv_mass[1:], p.inv_inertia[1:] = 0.0, 0.0
    state, p = (state, p) if planes else without_planes(state, p)
    T = 0.1 * jammed * m * G * dt
    N = (0.5 * m * G * dt - T * np.cos(alpha)) / np.sin(alpha)
    up = np.zeros((2, d))
    up[:, 0], up[:, -1] = (-np.sin(alpha), np.sin(alpha)), np.cos(alpha)
    first = run(lesson, state, p, dt)
    walls_of = np.asarray(first.contacts.b) - 1
    return state._replace(contacts=first.contacts, J=(N * walls[:, :d] + T * up)[walls_of]), p, up, dt


def remembers(lesson, draw, d):
    """What rests with the right forces stays, in one sweep, if it remembers them; also with friction in them."""
    for jammed, planes, heavy in ((1.0, True, 1.0), (1.0, False, 1.0), (0.0, True, TINY), (0.0, False, 1.0)):
        state, p, _, dt = groove(lesson, draw, d, jammed, planes, heavy)
        for order, way in (([1, 0], 0.0), ([0, 1], 0.99 * p.margin), ([1, 0, 1], 0.0)):
            first = np.minimum(np.arange(len(p.half) + 1), 1) * len(order)
            old = lesson.ContactSet(first, *(part[order] for part in state.contacts[1:]))
            old = old._replace(p=old.p + way * np.eye(d)[0], gap=old.gap + way)
            end = run(lesson, state._replace(contacts=old, J=state.J[order]), p, dt)
            given = f"contacts that have moved by {way / p.margin} margins, and were numbered {order}"
            close("impulses on what rests in a groove, over its size [N s]", np.asarray(end.J) / heavy, state.J / heavy,
                  ROUND_OFF, given=given)
            close("places of its contacts [m]", end.contacts.p, state.contacts.p, ROUND_OFF, given=given)
            close("gaps of its contacts [m]", end.contacts.gap, np.zeros(2), ROUND_OFF, given=given)
            close("its velocity [m/s]", np.asarray(end.v)[0], np.zeros(d), ROUND_OFF)
            close("its angular velocity [rad/s]", np.asarray(end.omega)[0], 0.0 * state.omega[0], MANY)


def swept(state, p, known, kept, dt):
    """Impulses on a single smooth body after the sweeps of a step: each contact leaves −gap/dt, or nothing that pulls.

    known: {(a, b): (gap, normal, place)} in the order of the sweeps; kept: the impulses that are remembered.
    """
    J, m = kept.copy(), 1.0 / p.inv_mass[0]
    for _ in range(p.sweeps):
        for k, ((_, wall), (gap, n, _)) in enumerate(known.items()):
            v = state.v[0] + dt * p.gravity + J.sum(axis=0) / m - state.v[wall]
            J[k] = max(0.0, n @ J[k] + m * (min(0.0, -gap / dt) - n @ v)) * n
    return J


def forgets(lesson, draw, d):
    """From beyond the margin nothing is remembered: the first wall takes the weight across it, the second the rest.

    In a second sweep each wall takes what the other one leaves.  From nearer all is remembered: of a body that hovers
    or overlaps, that turns or cannot, that rises, over walls that move along themselves; and also what would pull now,
    because its normal has turned.
    """
    for far, sweeps, share, rise, leaves in (
            (1.01, 1, 1.0, 0.0, 0.0), (draw(11.0, 19.0), 1, 1.0, 0.0, 0.0), (draw(1.1, 1.9), 2, 1.0, 0.0, 0.0),
            (0.3, 1, -draw(0.2, 0.5), 0.0, 0.0), (0.3, 1, draw(0.2, 0.5), draw(0.1, 0.5), 0.0),
            (0.3, 1, draw(0.2, 0.5), -draw(0.1, 0.5), 0.0), (0.3, 1, draw(1.5, 2.0), 0.0, draw(1.01, 1.1))):
        for planes, turns in itertools.product((True, False), (1.0, 0.0)):
            state, p, up, dt = groove(lesson, draw, d, 0.0, planes)
            p = p._replace(mu=0.0, sweeps=sweeps, inv_inertia=turns * p.inv_inertia)
            state.x[0, -1] += rise * G * dt * dt
            state.v[1:], state.v[0, -1] = draw(-1.0, 1.0) * up, leaves * G * dt
            away = state.contacts._replace(p=state.contacts.p + far * p.margin * np.eye(d)[0])
            end = run(lesson, state._replace(contacts=away, J=share * state.J), p, dt)
            known = touching(state.x, p.half, p.planes, p.inv_mass > 0.0, p.margin)
            order = np.argsort(end.contacts.b)
            kept = share * state.J[np.argsort(state.contacts.b)] * (far < 1.0)
            given = f"old contacts {far} margins away, {sweeps} sweeps, gaps {[one[0] for one in known.values()]} m, " \
                f"{p.planes.shape[0]} planes, inertia {'finite' if turns else 'infinite'}"
            close("impulses across both walls [N s]", np.asarray(end.J)[order], swept(state, p, known, kept, dt),
                  ROUND_OFF, given=given)
    state, p, _, dt = groove(lesson, draw, d, 0.0)
    state.x[0, -1] += 1.0                                                # lifted far out of the groove
    end = run(lesson, state, p, dt)
    close("contacts, and rows of J, of a body that touches nothing", (len(end.contacts.a), len(end.J)), (0, 0), 0.0)


def is_loaded_at_rest(lesson, draw, d):
    """A single body at rest with drag: v = 0 at the beginning, so that no drag acts with any remembered impulse.

    One sweep solves a single smooth contact, so that the impulse is that of the weight and of the spring.
    """
    r, dt = draw(0.2, 0.5), 0.01
    state, p = row_of(draw, lesson, d, [0.0], r, 0.0)
    state = run(lesson, state, p, dt, 1, T_1)
    state = state._replace(J=np.asarray(state.J) * draw(2.0, 4.0), v=0.0 * np.asarray(state.v))
    got = np.asarray(run(lesson, state, p, dt, 1, T_1).J)[0]
    close("impulse on a body at rest [N s]", got, (G / p.inv_mass[0] + SPRING * r) * dt * np.eye(d)[-1], ROUND_OFF)


def forces_in(state, n, unit):
    """Sizes of the impulses in the joints of a column, from below; body n is the ground."""
    low = np.minimum(state.contacts.a, np.where(np.asarray(state.contacts.b) == n, -1, state.contacts.b)) + 1
    forces = np.zeros(n)
    for k, J in zip(low, np.asarray(state.J), strict=True):
        forces[k] += np.linalg.norm(J) / unit
    return forces


# ---------------------------------------------------------------------------------------------- the loop in the plane

@exercise("10.6", points=0.125,
          hint="velocities, detection, contact; then x + dt v and q + dt ω of all rows, with the new ones")
def test_rows_that_touch_nothing_fly_in_the_plane(lesson, draw):
    flies(lesson, draw, 2)


@exercise("10.6", points=0.125,
          hint="bounds(x, q, p.half) and find_contacts(narrow, x, …) take the places before the motion")
def test_contacts_in_the_plane_are_those_of_the_beginning(lesson, draw):
    finds_what_is_near_at_the_beginning(lesson, draw, 2)


@exercise("10.6", points=0.125, hint="aim = closing_speeds(gap, dt): bodies may close their gap, but not more")
def test_a_falling_disc_stops_on_the_surface_and_not_in_it(lesson, draw):
    falls_and_stops(lesson, draw, 2)


def disc_on(lesson, draw, plane, mu, v=(0.0, 0.0), floor=(0.0, 0.0), height=0.0, sweeps=30, margin=0.05):
    """(PileState, Bodies, radius, 1/m) of a disc that touches a line, or is `height` above it; the line may move."""
    m, r = draw(0.5, 2.0), draw(0.2, 0.5)
    x = plane[:2] * (r + height - plane[2])
    state, p = made(lesson, [x], m, [0.5 * m * r * r], [(r, r)], [plane], mu, sweeps, margin)
    return state._replace(v=np.array([v, floor], float)), p, r, m


@exercise("10.6", points=0.125,
          hint="forces before contacts: contacts must stop the velocity that gravity adds in this step")
def test_a_disc_rolls_down_a_slope_or_slides(lesson, draw):
    """It rolls with ⅔ g sin θ where μ ≥ ⅓ tan θ, and else slides with g (sin θ − μ cos θ)."""
    slope, n, dt = draw(0.2, 0.7), draw.whole(10, 20), draw(0.002, 0.01)
    plane, down = np.array([np.sin(slope), np.cos(slope), draw(-0.5, 0.5)]), np.array([np.cos(slope), -np.sin(slope)])
    for mu, rate, spin in ((draw(0.5, 1.0) * np.tan(slope), 2.0 / 3.0 * G * np.sin(slope), True),
                           (draw(0.1, 0.3) * np.tan(slope), None, False)):
        state, p, r, _ = disc_on(lesson, draw, plane, mu)
        end = run(lesson, state, p, dt, n)
        a = G * (np.sin(slope) - mu * np.cos(slope)) if rate is None else rate
        close("velocity of a disc on a slope [m/s]", np.asarray(end.v)[0], n * dt * a * down, MANY,
              given=f"tan θ = {np.tan(slope)}, μ = {mu}")
        close("place of a disc on a slope [m]", np.asarray(end.x)[0],
              state.x[0] + 0.5 * a * (n * dt) ** 2 * (1.0 + 1.0 / n) * down, MANY)
        turns = -a * n * dt / r if spin else -2.0 * mu * G * np.cos(slope) * n * dt / r
        close("angular velocity of a disc on a slope [rad/s]", np.asarray(end.omega)[0], turns, MANY)
        close("angle of a disc on a slope [rad]", np.asarray(end.q)[0], 0.5 * turns * n * dt * (1.0 + 1.0 / n), MANY)


@pytest.mark.counts_calls                                            # boxes would be compiled anew, for seconds
@exercise("10.6", points=0.125, hint="bounds(x, q, half): detection takes bodies as they are turned at the beginning")
def test_a_box_comes_down_on_its_lowest_corner(lesson, draw):
    """The corner at r from the centre stops: j = −u_n/(1/m + r_x²/I), u_n = ω r_x − fall."""
    m, I, half = draw(0.5, 2.0), draw(0.02, 0.1), np.array([0.3, 0.2])
    for turn, spin in ((draw(0.3, 1.2), draw(1.0, 2.0)), (draw(-1.2, -0.3), draw(-2.0, -1.0))):
        fall = draw(1.0, 2.0)
        corners = np.array([(a, b) for a in (-1.0, 1.0) for b in (-1.0, 1.0)]) * half
        corners = corners @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
        r = corners[np.argmin(corners[:, 1])]
        state, p = made(lesson, [(0.0, -r[1])], m, [I], [half], [(0.0, 1.0, 0.0)], 0.0, 1, 0.01)
        state = state._replace(q=np.array([turn, 0.0]), v=np.array([(0.0, -fall), (0.0, 0.0)]),
                               omega=np.array([spin, 0.0]))
        end = lesson.contact_step_2d(nothing, lesson.box_bounds_2d, lesson.box_contacts_2d, T_0, state, 0.02, p)
        j = (fall - spin * r[0]) / (1.0 / m + r[0] ** 2 / I)
        given = f"turned by {turn} rad, {fall} m/s, {spin} rad/s"
        close("place of the contact [m]", np.asarray(end.contacts.p), [(r[0], 0.0)], ROUND_OFF, given=given)
        close("velocity of a box that comes down on a corner [m/s]", np.asarray(end.v)[0], (0.0, j / m - fall), MANY,
              given=given)
        close("its angular velocity [rad/s]", np.asarray(end.omega)[0], spin + r[0] * j / I, MANY, given=given)


@exercise("10.6", points=0.125,
          hint="rows with inv_mass 0 keep v and ω, and move with them: they carry what lies on them")
def test_belts_rollers_and_lifts_carry_a_disc(lesson, draw):
    is_carried(lesson, draw, 2)


@exercise("10.6", points=0.125, hint="p.sweeps times velocity_sweep_2d, each with the v, ω and J of the one before")
def test_each_sweep_halves_the_error_of_a_column_of_two_discs(lesson, draw):
    sweeps_halve_the_error(lesson, draw, 2)


@exercise("10.6", points=0.125, hint="apply kept_impulses before the first sweep, so that sweeps add up over the steps")
def test_memory_turns_sweeps_into_steps(lesson, draw):
    """Four discs above each other, two sweeps per step: from nothing each step leaves 0.73 of the error of forces."""
    n, m, dt = 4, draw(0.5, 2.0), 0.005
    x, truth = np.stack((np.zeros(n), 1.0 * np.arange(n) + 0.5), axis=1), np.arange(n, 0.0, -1.0)
    state, p = made(lesson, x, m, np.full(n, 0.125 * m), np.full((n, 2), 0.5), [(0.0, 1.0, 0.0)], 0.5, 2, 0.01)
    # sweeps from nothing leave cos²(π/8) each: 3e-6 after 80
    close("forces in the joints over m g, after one step of 80 sweeps [-]",
          forces_in(run(lesson, state, p._replace(sweeps=80), dt), n, m * G * dt), truth, 1e-4)
    end = run(lesson, state, p, dt, 120)
    # the column sinks together by some g dt² before all forces are right, and 1e-3 of a step's fall remains
    close("forces in the joints over m g, after 120 steps of two sweeps [-]", forces_in(end, n, m * G * dt), truth,
          1e-3)
    close("how far the top has sunk [m]", np.asarray(end.x)[n - 1, 1] - x[n - 1, 1], 0.0, 20.0 * G * dt * dt)


@exercise("10.6", points=0.25, hint="kept_impulses(contacts, state.contacts, state.J, p.margin): near is p.margin")
def test_an_impulse_in_the_plane_is_remembered_as_far_as_the_margin(lesson, draw):
    remembers(lesson, draw, 2)
    forgets(lesson, draw, 2)


@exercise("10.6", points=0.25, hint="first the loads, with the velocities at the beginning; only then the old impulses")
def test_loads_see_the_velocities_of_the_beginning(lesson, draw):
    is_loaded_at_rest(lesson, draw, 2)


# ---------------------------------------------------------------------------------------------- the loop in space

@exercise("10.7", points=0.125, hint="the loop of the plane; then x + dt v and turn_quaternions(q, ω, dt) of all rows")
def test_rows_that_touch_nothing_fly_in_space(lesson, draw):
    flies(lesson, draw, 3)


@exercise("10.7", points=0.125, hint="find_contacts before the motion; aim = closing_speeds(gap, dt), as in the plane")
def test_balls_are_found_before_they_touch_and_stop_on_the_surface(lesson, draw):
    falls_and_stops(lesson, draw, 3)
    finds_what_is_near_at_the_beginning(lesson, draw, 3)


def ball_on(lesson, draw, mu, share=0.4, sweeps=40, tilt=0.5):
    """(PileState, Bodies, n, r, m) of a ball that touches a sloping plane."""
    m, r = draw(0.5, 2.0), draw(0.2, 0.5)
    n = np.append(tilt * unit_vector(draw, 2), 1.0)
    n /= np.linalg.norm(n)
    I = share * m * r * r
    return *made(lesson, [r * n], m, np.zeros((1, 3)) + I, [(r, r, r)], [np.append(n, 0.0)], mu, sweeps, 0.05), n, r, m


@exercise("10.7", points=0.125, hint="the same loop as in the plane, with the functions for space")
def test_a_ball_rolls_down_any_slope_or_slides(lesson, draw):
    """It rolls with 5/7 of g along the slope, and slides with g_t − μ g_n where μ < 2/7 tan θ."""
    steps, dt = draw.whole(10, 20), draw(0.002, 0.01)
    for sticks in (True, False):
        mu = draw(0.4, 0.8) if sticks else draw(0.02, 0.1)
        state, p, n, r, _ = ball_on(lesson, draw, mu)
        g_t = np.array([0.0, 0.0, -G]) + G * n[2] * n
        a = 5.0 / 7.0 * g_t if sticks else g_t * (1.0 - mu * G * n[2] / np.linalg.norm(g_t))
        end = run(lesson, state, p, dt, steps)
        T = steps * dt
        close("velocity of a ball on a slope [m/s]", np.asarray(end.v)[0], T * a, SWEPT, given=f"μ = {mu}, n = {n}")
        close("place of a ball on a slope [m]", np.asarray(end.x)[0], state.x[0] + 0.5 * a * T * T * (1.0 + dt / T),
              SWEPT)
        rate = np.cross(n, T * a) / r if sticks else np.cross(-r * n, a - g_t) * T / (0.4 * r * r)
        close("angular velocity of a ball on a slope [rad/s]", np.asarray(end.omega)[0], rate, 10.0 * SWEPT)


@exercise("10.7", points=0.125,
          hint="rows with inv_mass 0 keep v and ω, and move with them: they carry what lies on them")
def test_belts_rollers_and_lifts_carry_a_ball(lesson, draw):
    is_carried(lesson, draw, 3)


@exercise("10.7", points=0.125, hint="p.sweeps times velocity_sweep, each with the v, ω and J of the one before")
def test_each_sweep_halves_the_error_of_a_column_of_two_balls(lesson, draw):
    sweeps_halve_the_error(lesson, draw, 3)


@exercise("10.7", points=0.125,
          hint="apply kept_impulses(contacts, state.contacts, state.J, p.margin) before the first sweep")
def test_an_impulse_in_space_is_remembered_as_far_as_the_margin(lesson, draw):
    remembers(lesson, draw, 3)
    forgets(lesson, draw, 3)
    is_loaded_at_rest(lesson, draw, 3)


@exercise("10.7", points=0.125, hint="inertia in the world: world_inertia(turn, inv_inertia), wherever an impulse acts")
def test_impulses_turn_a_ball_with_its_mass_inside_as_its_tensor_says(lesson, draw):
    """In the second step the impulses of the first one are remembered, and they turn it in the same way."""
    state, p, n, r, m = ball_on(lesson, draw, np.inf, np.array([0.3, draw(0.4, 0.5), 0.55]), 120)
    q = state.q.copy()
    q[0] = quaternions(draw, 1)[0]
    state = state._replace(q=q, v=np.vstack((draw(-1.0, 1.0, 3) - 2.0 * n, np.zeros(3))),
                           omega=np.vstack((draw(-2.0, 2.0, 3), np.zeros(3))))
    dt, I, arm = 0.01, 1.0 / p.inv_inertia[0], -r * n
    once = np.asarray(run(lesson, state, p._replace(mu=0.0, sweeps=1), dt).v)[0]
    close("approach of a smooth ball after one sweep [m/s]", n @ once, 0.0, ROUND_OFF)
    for _ in range(2):
        end = run(lesson, state, p, dt)
        v, omega = np.asarray(end.v)[0], np.asarray(end.omega)[0]
        close("velocity of the point that touches [m/s]", v + np.cross(omega, arm), np.zeros(3), 100.0 * SWEPT)
        J, tensor = m * (v - state.v[0] - dt * np.array([0.0, 0.0, -G])), matrix(q[0]) @ np.diag(I) @ matrix(q[0]).T
        before = state.omega[0] + dt * euler(q[0], state.omega[0], np.zeros(3), I)
        close("change of the spin by the impulse [N m s]", tensor @ (omega - before), np.cross(arm, J), SWEPT)
        close("impulse that is returned [N s]", np.asarray(end.J)[0], J, SWEPT)
        close("velocity of the plane [m/s, rad/s]", np.append(np.asarray(end.v)[1], np.asarray(end.omega)[1]),
              np.zeros(6), 0.0)
        close("orientation after the step, as a matrix", matrix(np.asarray(end.q)[0]), updated(q[0], omega, dt),
              ROUND_OFF)
        state, q = end, np.asarray(end.q)


@pytest.mark.counts_calls                                            # boxes would be compiled anew, for seconds
@exercise("10.7", points=0.125, hint="bounds(x, q, half): detection takes bodies as they are turned at the beginning")
def test_a_box_in_space_comes_down_on_its_lowest_corner(lesson, draw):
    """The corner at r from the centre stops: j = −u_n/(1/m + (r × n) · I⁻¹ (r × n)), and I Δω = j r × n.

    Two boxes that are turned otherwise come down side by side.
    """
    m, half, n, dt = draw(0.5, 2.0), np.array([0.3, 0.2, 0.4]), np.eye(3)[2], 0.02
    I, q = m / 3.0 * (np.sum(half**2) - half**2), quaternions(draw, 2)
    corners = [np.array(list(itertools.product((-1.0, 1.0), repeat=3))) * half @ matrix(one).T for one in q]
    r, fall, spin = [one[np.argmin(one[:, 2])] for one in corners], draw(1.5, 2.0, 2), draw(-1.0, 1.0, (2, 3))
    x = [(3.0 * k, 0.0, -r[k][2]) for k in range(2)]
    state, p = made(lesson, x, m, [I, I], [half, half], [(0.0, 0.0, 1.0, 0.0)], 0.0, 1, 1e-9)
    state = state._replace(q=np.vstack((q, np.eye(4)[:1])), v=-np.outer(np.append(fall, 0.0), n),
                           omega=np.vstack((spin, 0.0 * n)))
    end = lesson.contact_step(nothing, lesson.box_bounds, lesson.box_contacts, T_0, state, dt, p)
    close("places of the contacts [m]", np.asarray(end.contacts.p),
          [(x[k][0] + r[k][0], r[k][1], 0.0) for k in range(2)], ROUND_OFF)
    for k in range(2):
        tensor, before = matrix(q[k]) @ np.diag(I) @ matrix(q[k]).T, spin[k] + dt * euler(q[k], spin[k], 0.0 * n, I)
        turns = np.linalg.solve(tensor, np.cross(r[k], n))
        j = (fall[k] - np.cross(before, r[k]) @ n) / (1.0 / m + np.cross(r[k], n) @ turns)
        given = f"q = {q[k]}, {fall[k]} m/s, ω = {spin[k]} rad/s"
        close("velocity of a box that comes down on a corner [m/s]", np.asarray(end.v)[k], (j / m - fall[k]) * n, MANY,
              given=given)
        close("its angular velocity [rad/s]", np.asarray(end.omega)[k], before + j * turns, MANY, given=given)


# ---------------------------------------------------------------------------------------------- a floor that moves

def carried(lesson, draw, floor_v, spin, centre=(0.0, 0.0), mu=100.0):
    """A ball with drawn mass, size and moments on such a floor."""
    m, r, share = draw(0.5, 2.0), draw(0.1, 0.4), draw(0.3, 0.6)
    return lesson.CarriedBall(m, np.full(3, share * m * r * r), r, mu, np.array([0.0, 0.0, -G]),
                              np.append(np.array(centre, float), 0.0), np.append(np.array(floor_v, float), 0.0),
                              np.array([0.0, 0.0, float(spin)])), share


@exercise("10.8", points=0.5, hint="floor_v + floor_omega × (place − centre)")
def test_a_floor_moves_as_a_rigid_body(lesson, draw):
    """In a short time h the place turns about the centre, which moves on.

    All four may be 0 or along an axis; half of the floors are fast.
    """
    ball, _ = carried(lesson, draw, (0.0, 0.0), 0.0)
    places, centres, spins, speeds = (often_zero(draw, 40, 3) for _ in range(4))
    speeds[::2] *= draw(50.0, 100.0)
    for place, centre, spin, v in zip(places, centres, spins, speeds, strict=True):
        ball, h, rate = ball._replace(floor_omega=spin, floor_v=v, centre=centre), 1e-4, np.linalg.norm(spin)
        ends = [centre + s * h * v + about(spin / (rate or 1.0), s * h * rate) @ (place - centre) for s in (1.0, -1.0)]
        # central difference: its error is h² |ω|³ |place − centre|/6, below 5e-7
        close("velocity of the floor [m/s]", lesson.support_velocity(place, ball), (ends[0] - ends[1]) / (2.0 * h),
              1e-6, given=f"place {place} m, centre {centre} m, ω = {spin} rad/s, v = {v} m/s")


@exercise("10.8", points=0.5, hint="at the centre the velocity is floor_v; elsewhere add the part from floor_omega")
def test_the_centre_of_the_floor_has_the_velocity_of_the_floor(lesson, draw):
    ball, _ = carried(lesson, draw, draw(-1.0, 1.0, 2), draw(0.5, 2.0), draw(-1.0, 1.0, 2))
    arm = draw(0.01, 0.02)
    beside = ball.centre + np.array([arm, 0.0, 0.0])
    close("velocity of the floor one arm along x from its centre [m/s]", lesson.support_velocity(beside, ball),
          ball.floor_v + np.array([0.0, arm * ball.floor_omega[2], 0.0]), ROUND_OFF)
    close("velocity of the floor at its centre [m/s]", lesson.support_velocity(ball.centre, ball), ball.floor_v,
          ROUND_OFF)
    for size in (1.0, 1e-12):
        belt = ball._replace(mu=draw(0.0, 0.9), floor_omega=np.zeros(3), floor_v=size * draw(-300.0, 300.0, 3))
        close("velocity of a fast or slow belt, which does not turn, over its size [m/s]",
              np.asarray(lesson.support_velocity(beside, belt)) / size, belt.floor_v / size, ROUND_OFF)
    for place, centre, spin, v in np.swapaxes(of_any_size(draw, 4, 20, 3), 0, 1):
        floor, arm = ball._replace(floor_omega=spin, floor_v=v, centre=centre), place - centre
        size = np.linalg.norm(v) + np.linalg.norm(spin) * np.linalg.norm(arm)
        close("velocity of a floor of any size, over it [-]", np.asarray(lesson.support_velocity(place, floor)) / size,
              (v + cross_matrix(spin) @ arm) / size, ROUND_OFF, given=f"place {place} m, floor {floor[-3:]}")
    floor, place = ball._replace(centre=np.zeros(3)), draw(0.5, 1.0, 3)
    slow = floor._replace(floor_omega=TINY * floor.floor_omega, floor_v=TINY * floor.floor_v)
    close("velocity of a floor that hardly moves, over its size [m/s]",
          np.asarray(lesson.support_velocity(place, slow)) / TINY,
          floor.floor_v + cross_matrix(floor.floor_omega) @ place, ROUND_OFF)
    close("velocity of a turntable next to its centre, over that distance [1/s]",
          np.asarray(lesson.support_velocity(TINY * place, floor._replace(floor_v=np.zeros(3)))) / TINY,
          cross_matrix(floor.floor_omega) @ place, ROUND_OFF)
    rate, far = draw(1e-8, 1e-7), draw(1e7, 1e8)                         # slower than the earth, and larger
    planet = ball._replace(floor_omega=np.array([0.0, 0.0, rate]), floor_v=np.zeros(3), centre=np.zeros(3))
    close("velocity far from the centre of a floor that hardly turns [m/s]",
          lesson.support_velocity(np.array([0.0, far, 0.0]), planet), (-rate * far, 0.0, 0.0), ROUND_OFF,
          given=f"{far} m from the centre, {rate} rad/s")


def supported(t, x, q, v, omega, ball):
    """Weight and the force of the floor: what is left is the weight along the floor.

    A kick before T_0 and a push after T_2, with a torque about z, show with which time a load was asked.
    """
    F, tau = ball.m * ball.gravity, np.zeros(3)
    F[2] = 0.0
    if t < T_0 or t > T_2:
        F[0] += 0.3 * ball.mu * ball.m * G
        tau[2] = 0.1 * ball.m * G * ball.radius
    return F, tau


def tethered(t, x, q, v, omega, ball):
    """A force that depends on the whole state: tether, thrust along an axis, drag and lift."""
    return ball.m * (q[1:] - x - v + omega), np.zeros(3)


def unloaded(t, x, q, v, omega, ball):
    return np.zeros(3), np.zeros(3)


def rolling_on(lesson, x, v, ball):
    """ω of a ball that rolls on its floor without spin about the normal: (ω × r) is what floor and v leave."""
    r = np.array([0.0, 0.0, -ball.radius])
    floor = ball.floor_v + np.cross(ball.floor_omega, x - ball.centre)
    return np.cross(r, floor - v) / ball.radius**2


@exercise("10.9", points=0.25, hint="positions with the mean of both velocities: x + dt (v + v_new)/2, and q likewise")
def test_a_step_brings_the_lowest_point_to_the_velocity_of_the_floor_ahead(lesson, draw):
    """One impulse at the lowest point does it: r × m Δv = I Δω.  The spin about the normal stays."""
    ball, share = carried(lesson, draw, draw(-1.0, 1.0, 2), draw(1.0, 2.0), draw(-0.5, 0.5, 2))
    x, v, q = np.append(draw(-1.0, 1.0, 2), ball.radius), np.append(draw(-1.0, 1.0, 2), 0.0), quaternions(draw, 1)[0]
    omega, r, dt = draw(-3.0, 3.0, 3), np.array([0.0, 0.0, -ball.radius]), draw(0.1, 0.2)
    got = [np.asarray(part) for part in lesson.carried_step(supported, T_0, x, q, v, omega, dt, ball)]
    ahead = ball.floor_v + np.cross(ball.floor_omega, x + dt * v - ball.centre)
    close("velocity of the lowest point after a step [m/s]", got[2] + np.cross(got[3], r), ahead, MANY,
          given=f"velocity of the floor where the ball would be {ahead} m/s")
    close("change of ω by the impulse at the lowest point [rad/s]", got[3] - omega,
          np.cross(r, got[2] - v) / (share * ball.radius**2), MANY)
    close("place after a step [m]", got[0], x + 0.5 * dt * (v + got[2]), ROUND_OFF)
    mean = 0.5 * (omega + got[3])
    rate = np.linalg.norm(mean)
    close("orientation after a step, as a matrix", matrix(got[1]), about(mean / rate, rate * dt) @ matrix(q), MANY)
    tiny, still = TINY * draw(1.0, 9.0), ball._replace(floor_v=np.zeros(3), floor_omega=np.zeros(3))
    x_0, slow = ball.radius * np.eye(3)[2], tiny * np.append(unit_vector(draw, 2), 0.0)
    rolls = rolling_on(lesson, x_0, slow, still) + tiny * np.eye(3)[2]
    after = lesson.carried_step(unloaded, T_0, x_0, np.eye(4)[0], slow, rolls, dt, still)
    close("velocity of a ball that rolls slowly, over its size [-]", np.asarray(after[2]) / tiny, slow / tiny, MANY,
          given=f"v = {slow} m/s, ω = {rolls} rad/s")
    close("its way, over that size [s]", (np.asarray(after[0]) - x_0) / tiny, dt * slow / tiny, MANY)
    close("rotation vector of its turn, over that size [s/m]", 2.0 * np.asarray(after[1])[1:] / tiny, dt * rolls / tiny,
          MANY)
    sloping = ball._replace(gravity=np.append(draw(-1.0, 1.0, 2), -G))
    pulled, free = (lesson.carried_step(load, T_0, x, q, v, omega, dt, sloping) for load in (tethered, unloaded))
    state = q[1:] - x - np.asarray(free[2]) + free[3]                     # the velocities are those after friction
    close("what a load at the old place, with the velocities after friction, adds to the velocity [m/s]",
          np.asarray(pulled[2]) - free[2], dt * state, MANY, given=f"F = m (q − x − v + ω), x = {x} m")
    close("velocity of the lowest point without a load, on a sloping turntable [m/s]",
          np.asarray(free[2]) + np.cross(free[3], r), ahead - dt * sloping.gravity * [1.0, 1.0, 0.0], MANY,
          given=f"gravity {sloping.gravity} m/s², which friction holds for dt")


def rubbed(x, v, omega, dt, ball):
    """(v, ω) after friction for dt: it stops the slip on the floor ahead, or takes from it what Coulomb allows."""
    r, floor = np.array([0.0, 0.0, -ball.radius]), ball.floor_v + np.cross(ball.floor_omega, x + dt * v - ball.centre)
    slip = (v + np.cross(omega, r) + dt * ball.gravity - floor) * [1.0, 1.0, 0.0]
    size, whole = np.linalg.norm(slip), 1.0 / ball.m + ball.radius**2 / ball.I_body[0]
    J = -min(size / whole, ball.mu * ball.m * dt * G) * slip / (size or 1.0)
    return v + J / ball.m, omega + np.cross(r, J) / ball.I_body[0]


@exercise("10.9", points=0.125,
          hint="stop_slip with the floor at x + dt v, also where ball or floor is at rest, and for μ = 0 or ∞")
def test_friction_is_that_of_the_floor_ahead_wherever_ball_and_floor_rest(lesson, draw):
    """All that moves may be 0 or along an axis, very slow or fast; balls are small or large; floors carry or brake."""
    level, q = np.array([1.0, 1.0, 0.0]), np.eye(4)[0]
    for k, mu in enumerate(20 * (0.0, draw(0.02, 0.1), 100.0, np.inf)):
        size, m = (1.0, 1e-6, 1e4)[k // 4 % 3], 10.0 ** draw(-6.0, 6.0)
        r = max(1.0, size) * 10.0 ** draw(-3.0, 1.0)
        x, v, omega, centre, floor_v, spin, tilt = often_zero(draw, 7, 3) * ([[1.0]] + 6 * [[size]])
        spin = spin / max(1.0, size)
        ball, share = carried(lesson, draw, floor_v[:2], spin[2], centre[:2], mu)
        ball, v = ball._replace(gravity=tilt * level + np.array([0.0, 0.0, -G])), v * level
        dt = draw(0.05, 0.1) if k % 5 else draw(2.0, 5.0)
        ball, omega = ball._replace(m=m, radius=r, I_body=np.full(3, share * m * r * r)), omega / r
        got = [np.asarray(part) for part in lesson.carried_step(unloaded, T_0, x, q, v, omega, dt, ball)]
        given = f"v = {v} m/s, ω = {omega} rad/s, μ = {mu}, floor {ball.floor_v} m/s and {ball.floor_omega} rad/s " \
            f"about {ball.centre} m"
        v_new, omega_new = rubbed(x, v, omega, dt, ball)
        close("velocity after friction, over its size [m/s]", got[2] / size, v_new / size, MANY, given=given)
        close("ω r after friction, over its size [m/s]", r * got[3] / size, r * omega_new / size, 10.0 * MANY,
              given=given)
        close("way in the step, over its size [m]", (got[0] - x) / size, 0.5 * dt * (v + v_new) / size, 10.0 * MANY,
              given=given)


@exercise("10.9", points=0.25, hint="stop_slip first; then rigid_body_step adds the load, at the time t and for dt")
def test_a_ball_on_a_sloping_belt_feels_its_load_once(lesson, draw):
    """It rolls with g_t/(1 + c), I = c m r².  Friction does not know of a push, and the mean velocity makes ½ a dt²."""
    ball, share = carried(lesson, draw, draw(-1.0, 1.0, 2), 0.0)
    ball = ball._replace(gravity=np.append(draw(-1.0, 1.0, 2), -G))
    x, v = np.append(draw(-1.0, 1.0, 2), ball.radius), np.append(draw(-1.0, 1.0, 2), 0.0)
    T, n, a = 0.5, 5, ball.gravity * [1.0, 1.0, 0.0] / (1.0 + share)
    start = x, quaternions(draw, 1)[0], v, rolling_on(lesson, x, v, ball)
    state, dt = start, T / n
    for k in range(n):
        state = lesson.carried_step(supported, T_0 + k * dt, *state, dt, ball)
    close("velocity of a ball that rolls down a sloping belt [m/s]", state[2], v + T * a, MANY,
          given=f"gravity {ball.gravity} m/s²")
    close("its place [m]", state[0], x + T * v + 0.5 * T * T * a, MANY)
    before, after = (lesson.carried_step(supported, T_2 + late * dt, *start, dt, ball) for late in (-0.1, 0.1))
    close("velocity after a step that begins before a push [m/s]", before[2], v + dt * a, MANY)
    push, twist = 0.3 * ball.mu * G * dt, 0.1 * G / (share * ball.radius) * dt
    e_x, e_z = np.eye(3)[0], np.eye(3)[2]
    close("what a push adds to the velocity [m/s]", np.asarray(after[2]) - before[2], push * e_x, MANY)
    close("what it adds to the place [m]", np.asarray(after[0]) - before[0], 0.5 * dt * push * e_x, MANY)
    close("what a torque adds to the angular velocity [rad/s]", np.asarray(after[3]) - before[3], twist * e_z, MANY)
    still = ball._replace(gravity=-G * e_z, floor_v=0.0 * e_z)
    moved = lesson.carried_step(supported, T_2 + 0.1 * dt, x, start[1], 0.0 * e_z, 0.0 * e_z, dt, still)
    close("velocity of a ball at rest after a push [m/s]", moved[2], push * e_x, MANY)
    close("its way [m]", moved[0] - x, 0.5 * dt * push * e_x, MANY)
    close("its angular velocity after a torque [rad/s]", moved[3], twist * e_z, MANY)
    mean = 0.5 * (start[3] + np.asarray(after[3]))
    rate = np.linalg.norm(mean)
    close("orientation after a push and a torque, as a matrix", matrix(np.asarray(after[1])),
          about(mean / rate, rate * dt) @ matrix(start[1]), MANY)


@exercise("10.9", points=0.25,
          hint="take the floor at the place where the ball will be, x + dt v; x moves by the mean of both v")
def test_a_ball_on_a_turntable_moves_on_circles(lesson, draw):
    """With I = c m r² a rolling ball has v̇ = c/(1 + c) Ω × v: 2Ω/7 for a solid one.

    Adams and Bashforth leave 5/12 (rate dt)³ of v per step, the mean velocity 1/12: ½ T rate² dt² |v|, and a half more.
    """
    spin, T = draw(1.0, 2.0), 3.0
    ball, share = carried(lesson, draw, (0.0, 0.0), spin, draw(-0.5, 0.5, 2))
    x, v = np.append(draw(0.5, 1.0, 2), ball.radius), np.append(draw(0.3, 0.6, 2), 0.0)
    rate, errors = share / (1.0 + share) * spin, []
    middle = x + np.array([-v[1], v[0], 0.0]) / rate
    truth = middle + about(np.array([0.0, 0.0, 1.0]), rate * T) @ (x - middle)
    for n in (50, 100):
        state = x, np.eye(4)[0], v, rolling_on(lesson, x, v, ball)
        for k in range(n):
            state = lesson.carried_step(supported, T_0 + k * T / n, *state, T / n, ball)
        errors.append(np.linalg.norm(np.asarray(state[0]) - truth))
    between("error of the place after 3 s [m]", errors[1], 0.0, 0.75 * T * rate**2 * (T / 100) ** 2 * np.linalg.norm(v),
            given=f"Ω = {spin} rad/s")
    between("error with 100 steps over error with 50", errors[1] / errors[0], 0.2, 0.3)


@exercise("10.9", points=0.125, hint="x_new = x + dt (v + v_new)/2, and q turned by the mean of both ω")
def test_a_belt_pulls_a_ball_along_with_exact_parabolas(lesson, draw):
    """On a belt a ball at rest slips until J has given v = c/(1 + c) belt; c = I/m r²."""
    belt, mu, n = draw(1.0, 2.0, 2), draw(0.2, 0.5), 8
    ball, share = carried(lesson, draw, belt, 0.0, mu=mu)
    size = np.linalg.norm(belt)
    T = 0.5 * size / (mu * G * (1.0 + 1.0 / share))                        # half of the time for which it slips
    x, q = np.array([0.3, -0.2, ball.radius]), quaternions(draw, 1)[0]
    state = x, q, np.zeros(3), np.zeros(3)
    for k in range(n):
        state = lesson.carried_step(supported, T_0 + k * T / n, *state, T / n, ball)
    along = np.append(belt / size, 0.0)
    close("place while it slips [m]", state[0], x + 0.5 * mu * G * T * T * along, ROUND_OFF, given=f"belt {belt} m/s")
    close("velocity while it slips [m/s]", state[2], mu * G * T * along, ROUND_OFF)
    spun = np.cross([0.0, 0.0, -ball.radius], mu * G * along) / (share * ball.radius**2)
    angle = 0.5 * np.linalg.norm(spun) * T * T
    close("orientation while it slips, as a matrix", matrix(np.asarray(state[1])),
          about(spun / np.linalg.norm(spun), angle) @ matrix(q), MANY)
    for k in range(4 * n):
        state = lesson.carried_step(supported, T_0 + k * T / n, *state, T / n, ball)
    close("velocity when it rolls [m/s]", state[2], share / (1.0 + share) * size * along, ROUND_OFF)


# ---------------------------------------------------------------------------------------------- exact events

def bowled(lesson, draw, tilt=0.0):
    """(RollingBall, v, ω, direction of the slip, its size, share c = I/m r²), with gravity tilted along the slip.

    Without tilt it slips for at most 7/(0.2 · 8 · 2.67) s, a third of T_2 − T_0.
    """
    m, r, share, mu = draw(0.5, 2.0), draw(0.1, 0.4), draw(0.3, 0.6), draw(0.2, 0.5)
    e = np.append(unit_vector(draw, 2), 0.0)
    v, rim = draw(2.0, 4.0), draw(-3.0, 1.0)
    gravity = tilt * e + np.array([0.0, 0.0, -draw(8.0, 15.0)])
    ball = lesson.RollingBall(m, np.full(3, share * m * r * r), r, mu, gravity)
    return ball, v * e, np.cross([0.0, 0.0, 1.0], rim * e) / r, e, v - rim, share


def brake(ball):
    """Deceleration μ |g_z| of a ball that slips [m/s²]."""
    return ball.mu * abs(ball.gravity[2])


@exercise("10.10", points=1,
          hint="|slip| along the floor, so without u_z, over the rate at which friction, by v and ω, and gravity "
               "reduce it")
def test_the_slip_ends_when_theory_says(lesson, draw):
    """Friction takes μg from v and adds μg/c to the speed of the rim.  At first gravity brakes more than friction."""
    ball, _, _, _, _, share = bowled(lesson, draw)
    v, omega = draw(-3.0, 3.0, 3), draw(-9.0, 9.0, 3)
    u = (v + np.cross(omega, [0.0, 0.0, -ball.radius])) * [1.0, 1.0, 0.0]
    slip = np.linalg.norm(u)
    slopes = draw(60.0, 90.0), draw(1.0, 3.0), 0.0
    times = [lesson.slip_time(v, omega, ball._replace(gravity=ball.gravity - uphill / slip * u)) for uphill in slopes]
    for uphill, time in zip(slopes, times, strict=True):
        close("time until a ball rolls that goes one way and turns another way [s]", time,
              slip / (brake(ball) * (1.0 + 1.0 / share) + uphill), ROUND_OFF,
              given=f"v = {v} m/s, ω = {omega} rad/s, gravity against the slip {uphill} m/s²")
    for tilt in (-draw(0.3, 1.0), draw(0.3, 1.0), 0.0):
        ball, v, omega, _, slip, share = bowled(lesson, draw, tilt)
        expected = slip / (brake(ball) * (1.0 + 1.0 / share) - tilt)
        close("time until it rolls [s]", lesson.slip_time(v, omega, ball), expected, ROUND_OFF,
              given=f"slip {slip} m/s, μ = {ball.mu}, gravity along it {tilt} m/s²")
    ball, v, omega, _, slip, _ = bowled(lesson, draw, -draw(0.3, 1.0))
    close("time until gravity alone has stopped the slip [s]", lesson.slip_time(v, omega, ball._replace(mu=0.0)),
          slip / np.linalg.norm(ball.gravity[:2]), MANY)


def rolling_cases(draw, lesson):
    """(RollingBall, v, ω, slip u, size of these): v, ω and gravity along the floor may be 0 or along an axis.

    A third is slow, and a third fast in as much more gravity.  Balls are small or large.  There is no friction, some,
    or very much; gravity presses the ball on the floor, or does not.
    """
    for k, mu in enumerate(24 * (0.0, draw(0.2, 0.5), np.inf)):
        size, m = (1.0, TINY, 1e4)[k // 3 % 3], 10.0 ** draw(-6.0, 6.0)
        r = max(1.0, size) * 10.0 ** draw(-3.0, 1.0)
        v, omega = size * often_zero(draw, 2, 3) / [[1.0], [r]]
        share, tilt = draw(0.3, 0.6), size * draw.rng.choice([0.0, -2.0, 2.0])
        u = (v + np.cross(omega, [0.0, 0.0, -r])) * [1.0, 1.0, 0.0]
        along = u / np.linalg.norm(u) if u.any() else np.append(unit_vector(draw, 2), 0.0)
        down = max(1.0, size) * draw.rng.choice([-G, -G, 0.0, G])
        gravity = tilt * along + np.array([0.0, 0.0, down])
        yield lesson.RollingBall(m, np.full(3, share * m * r * r), r, mu, gravity), v, omega, u, size


def sticks(ball):
    """Whether friction ends any slip at once.  Without a load on the floor not even μ = ∞ does."""
    return np.isinf(ball.mu) and ball.gravity[2] < 0.0


def accelerations(ball, along):
    """(v̇, rate of the velocity ω × r of the rim) under as much friction as Coulomb allows, against `along`."""
    friction = -ball.mu * max(0.0, -ball.gravity[2]) * along if ball.gravity[2] < 0.0 else 0.0 * along
    return ball.gravity * [1.0, 1.0, 0.0] + friction, ball.m * ball.radius**2 / ball.I_body[0] * friction


@exercise("10.10", points=0.25,
          hint="the same rate for a ball that stands or does not spin; there is no friction where g_z ≥ 0")
def test_the_slip_of_a_ball_at_rest_or_along_an_axis_ends_when_theory_says(lesson, draw):
    for ball, v, omega, u, _ in rolling_cases(draw, lesson):
        slip, given = np.linalg.norm(u), f"v = {v} m/s, ω = {omega} rad/s, μ = {ball.mu}, gravity {ball.gravity} m/s²"
        time = lesson.slip_time(v, omega, ball)
        if slip > 0.0 and not sticks(ball):
            slower = -np.sum(accelerations(ball, u / slip), axis=0) @ u / slip
            truth("whether it slips forever", bool(np.isinf(time)), bool(slower <= 0.0), given)
            time, slip = (0.0, 0.0) if slower <= 0.0 else (time / slip, 1.0 / slower)
            close("time until it rolls, over its slip, times what slows it [-]", time / (slip or 1.0), slip > 0.0, MANY,
                  given=given)
        else:
            close("time of what rolls at once [s]", time, 0.0, 0.0, given=given)


@exercise("10.10", points=0.25, hint="no slip: 0; gravity stronger than friction: inf; ignore u_z")
def test_what_rolls_does_not_slip_and_what_is_too_steep_never_rolls(lesson, draw):
    ball, v, _, e, _, share = bowled(lesson, draw)
    rolls = np.cross([0.0, 0.0, 1.0], v) / ball.radius
    between("time of a ball that rolls already [s]", lesson.slip_time(v, rolls, ball), 0.0, ROUND_OFF)
    creeps = draw(1.0, 9.0)
    # u is a difference of velocities that are rounded at 1e-15, a part of 1e-7 of it
    close("time of a ball that hardly slips [s]", lesson.slip_time(v + 1e-8 * creeps * e, rolls, ball),
          1e-8 * creeps / (brake(ball) * (1.0 + 1.0 / share)), 1e-14, given=f"slip {1e-8 * creeps} m/s")
    slowly, ends = TINY * creeps, brake(ball) * (1.0 + 1.0 / share)
    close("time of a ball that is almost at rest, over what it should be [-]",
          lesson.slip_time(slowly * e, np.zeros(3), ball) * ends / slowly, 1.0, ROUND_OFF, given=f"v = {slowly} m/s")
    weightless = ball._replace(gravity=TINY * ball.gravity)
    close("time of a ball that has hardly any weight, over what it should be [-]",
          lesson.slip_time(v, np.zeros(3), weightless) * TINY * ends / np.linalg.norm(v), 1.0, ROUND_OFF,
          given=f"v = {v} m/s, gravity {weightless.gravity} m/s²")
    for factor in (1e-8, 1e4):                                           # ice, and a glue that is not infinite
        time = lesson.slip_time(v, np.zeros(3), ball._replace(mu=factor * ball.mu))
        close("time of a ball on ice or glue, over what it should be [-]", time * factor * ends / np.linalg.norm(v),
              1.0, ROUND_OFF, given=f"μ = {factor * ball.mu}")
    ball_2, v_2, omega_2, _, slip, share_2 = bowled(lesson, draw)
    close("time until a ball rolls that also moves up or down [s]",
          lesson.slip_time(v_2 + np.array([0.0, 0.0, draw(0.5, 2.0)]), omega_2, ball_2),
          slip / (brake(ball_2) * (1.0 + 1.0 / share_2)), ROUND_OFF)
    between("time of a ball at rest [s]", lesson.slip_time(np.zeros(3), np.zeros(3), ball), 0.0, 0.0)
    for much in (*draw.beyond(1.5), 0.99, 1.0 - 1e-7):
        steep = ball._replace(gravity=ball.gravity + much * brake(ball) * (1.0 + 1.0 / share) * e)
        endless = np.isinf(lesson.slip_time(v, 0.5 * rolls, steep))
        truth("whether it slips forever on a steep floor", endless, much > 1.0)
    endless = np.isinf(lesson.slip_time(v, 0.5 * rolls, ball._replace(mu=0.0)))
    truth("whether it slips forever without friction", endless, True)
    between("time of a ball on a floor of infinite friction [s]",
            lesson.slip_time(v, 0.5 * rolls, ball._replace(mu=np.inf)), 0.0, 0.0)


@exercise("10.11", points=0.25, hint="one part until slip_time, but at most dt; another part for the rest of dt")
def test_one_step_over_the_end_of_slipping_is_exact(lesson, draw):
    """With gravity g_t along the slip v changes by g_t − μ g, the rim by μ g/c, and both by g_t/(1 + c) in rolling."""
    for tilt in (draw(0.3, 0.5), 0.0):
        ball, v, omega, e, slip, share = bowled(lesson, draw, tilt)
        a, e_z = brake(ball), np.eye(3)[2]
        ends = slip / (a * (1.0 + 1.0 / share) - tilt)
        x, q, rim = np.append(draw(-1.0, 1.0, 2), ball.radius), quaternions(draw, 1)[0], v @ e - slip
        for T in np.array((*draw.beyond(2.5), *draw.within(0.2))) * ends:
            s = min(T, ends)
            rest, speed, rolls = T - s, v @ e + (tilt - a) * s, tilt / (1.0 + share)
            got = lesson.exact_rolling_step(supported, T_0, x, q, v, omega, T, ball)
            way = s * (v @ e) + 0.5 * (tilt - a) * s * s + rest * speed + 0.5 * rolls * rest * rest
            close("place after one step [m]", got[0], x + way * e, MANY, given=f"slips for {ends} s, dt = {T} s")
            close("velocity after one step [m/s]", got[2], (speed + rolls * rest) * e, MANY)
            close("angular velocity after one step [rad/s]", got[3],
                  np.cross(e_z, (rim + a / share * s + rolls * rest) * e) / ball.radius, MANY)
            angle = (s * rim + 0.5 * a / share * s * s + rest * speed + 0.5 * rolls * rest * rest) / ball.radius
            close("orientation after one step, as a matrix", matrix(np.asarray(got[1])),
                  about(np.cross(e_z, e), angle) @ matrix(q), MANY)


@exercise("10.11", points=0.25, hint="a ball that rolls moves on, and so does one that never ceases to slip")
def test_one_step_without_an_end_of_slipping_is_exact(lesson, draw):
    """A ball that rolls, with a spin about z, which stays; and one on a floor that is too steep for friction."""
    ball, v, _, e, _, share = bowled(lesson, draw)
    x, T, e_z = np.append(draw(-1.0, 1.0, 2), ball.radius), draw(0.5, 1.0), np.eye(3)[2]
    steep = ball._replace(gravity=ball.gravity + draw(1.1, 1.5) * brake(ball) * (1.0 + 1.0 / share) * e)
    omega = np.cross(e_z, v) / ball.radius
    for kind, one, spin, a, rim_a in (
            ("rolls", ball, omega + draw(1.0, 3.0) * e_z, 0.0, 0.0),
            ("slips forever", steep, 0.5 * omega, steep.gravity @ e - brake(ball), brake(ball) / share)):
        for dt in (T, 1e-6):
            got = lesson.exact_rolling_step(supported, T_0, x, np.eye(4)[0], v, spin, dt, one)
            close(f"velocity of a ball that {kind} [m/s]", got[2], v + dt * a * e, MANY, given=f"dt = {dt} s")
            close("its place [m]", got[0], x + dt * v + 0.5 * a * dt * dt * e, MANY)
            close("its angular velocity [rad/s]", got[3], spin + np.cross(e_z, dt * rim_a * e) / ball.radius, MANY)


def rolled(v, rim, T, ball):
    """(way, v, velocity ω × r of the rim) after T of slip and of what follows: two parabolas at most."""
    way, g = np.zeros(3), ball.gravity * [1.0, 1.0, 0.0]
    slip, part, share = np.linalg.norm(v + rim), 0.0, ball.m * ball.radius**2 / ball.I_body[0]
    if sticks(ball):
        v, rim = v - (v + rim) / (1.0 + share), rim - share * (v + rim) / (1.0 + share)
    elif slip > 0.0:
        along = (v + rim) / slip
        a, b = accelerations(ball, along)
        part = min(T, slip / -((a + b) @ along)) if (a + b) @ along < 0.0 else T
        way, v, rim = part * v + 0.5 * part**2 * a, v + part * a, rim + part * b
    push = np.linalg.norm(g)
    most = ball.mu * -ball.gravity[2] if ball.gravity[2] < 0.0 else 0.0
    friction, rest = -min(most, push / (1.0 + share)) * g / (push or 1.0), T - part
    return (way + rest * v + 0.5 * rest**2 * (g + friction), v + rest * (g + friction), rim + rest * share * friction)


@exercise("10.11", points=0.125,
          hint="both parts for every ball: one at rest, or that only spins, too, may begin to move")
def test_one_step_is_exact_for_a_ball_at_rest_or_along_an_axis(lesson, draw):
    level = np.array([1.0, 1.0, 0.0])
    for ball, v, omega, u, size in rolling_cases(draw, lesson):
        rim, r = u - v * level, np.array([0.0, 0.0, -ball.radius])
        ends = np.linalg.norm(u) / max(1.0, size) / (ball.mu * G + 1.0) or 0.1           # about
        for T in (0.2 * ends, 4.0 * ends, 0.5):
            given = f"v = {v} m/s, ω = {omega} rad/s, μ = {ball.mu}, gravity {ball.gravity} m/s², dt = {T} s"
            step = lesson.exact_rolling_step(supported, T_0, np.zeros(3), np.eye(4)[0], v, omega, T, ball)
            got = [np.asarray(part) for part in step]
            way, speed, turned = rolled(v * level, rim, T, ball)
            close("velocity after one step, over its size [-]", (got[2] - v * [0.0, 0.0, 1.0]) / size, speed / size,
                  MANY, given=given)
            close("velocity of the rim after one step, over that size [-]", np.cross(got[3], r) / size, turned / size,
                  MANY, given=given)
            close("spin about the vertical times the radius, over that size [-]", ball.radius * got[3][2] / size,
                  ball.radius * omega[2] / size, MANY, given=given)
            if not sticks(ball):
                close("way after one step, over that size and dt [-]", got[0] / (size * T) * level,
                      way / (size * T), MANY, given=given)


@exercise("10.11", points=0.125, hint="the second part begins with the end of the first, and lasts dt − first")
def test_a_long_step_is_as_good_as_many(lesson, draw):
    """Also the orientation: along a line all rotations are about one axis."""
    ball, v, omega, e, slip, share = bowled(lesson, draw)
    ends = slip / (brake(ball) * (1.0 + 1.0 / share))
    T, n = draw(1.5, 3.0) * ends, draw.whole(3, 9)
    start = np.zeros(3), np.eye(4)[0], v, omega
    whole = lesson.exact_rolling_step(supported, T_0, *start, T, ball)
    close("velocity when it rolls [m/s]", whole[2], v - slip * share / (1.0 + share) * e, MANY, given=f"dt = {T} s")
    parts = start
    for k in range(n):
        parts = lesson.exact_rolling_step(supported, T_0 + k * T / n, *parts, T / n, ball)
    for name, one, many in zip(("place [m]", "orientation [-]", "velocity [m/s]", "angular velocity [rad/s]"), whole,
                               parts, strict=True):
        close(f"{name} after one long step", one, many, MANY, given=f"{n} parts")


@exercise("10.11", points=0.25, hint="load(t, …) for the first part, load(t + first, …) for the second one")
def test_the_second_part_asks_the_load_at_its_own_time(lesson, draw):
    """A push sets in right after the beginning, at T_2: only the second part knows it, so v differs by push · rest/m.

    rolling_step lets the floor hold gravity only, so that a push is not shared with the rotation in its own step.
    """
    ball, v, omega, e, slip, share = bowled(lesson, draw)
    ends = slip / (brake(ball) * (1.0 + 1.0 / share))
    T, start = draw(1.5, 3.0) * ends, np.array([0.0, 0.0, ball.radius])
    without = lesson.exact_rolling_step(supported, T_0, start, np.eye(4)[0], v, omega, T, ball)
    pushed = lesson.exact_rolling_step(supported, T_2, start, np.eye(4)[0], v, omega, T, ball)
    first = lesson.exact_rolling_step(supported, T_2 + 1.0, start, np.eye(4)[0], v, omega, 0.5 * ends, ball)
    close("velocity of a ball that is pushed while it slips [m/s]", first[2],
          v + 0.5 * ends * brake(ball) * (0.3 * G / abs(ball.gravity[2]) * np.eye(3)[0] - e), MANY)
    close("what the push adds to the velocity [m/s]", np.asarray(pushed[2]) - np.asarray(without[2]),
          (0.3 * ball.mu * G * (T - ends), 0.0, 0.0), MANY, given=f"slips for {ends} s, dt = {T} s")
    late = lesson.exact_rolling_step(supported, T_2 - 0.9 * ends - 0.1 * T, start, np.eye(4)[0], v, omega, T, ball)
    close("what a push adds that sets in after the second part has begun [m/s]", np.asarray(late[2]) - without[2],
          np.zeros(3), MANY, given=f"slips for {ends} s, dt = {T} s")
    for v_0, pushes in itertools.product((0.0 * v, v), (1.0, 0.0)):      # without slip there is one part only
        rolls, when = np.cross(np.eye(3)[2], v_0) / ball.radius, T_2 + (1.0 if pushes else -0.5 * T)
        got = lesson.exact_rolling_step(supported, when, start, np.eye(4)[0], v_0, rolls, T, ball)
        close("velocity of a ball at rest, or that rolls, after a push [m/s]", got[2],
              v_0 + pushes * 0.3 * ball.mu * G * T * np.eye(3)[0], MANY, given=f"v = {v_0} m/s, t = {when} s")


@exercise("10.12", points=0.5,
          hint="the angular momentum about the corner stays the same: ω⁺ = (I ω − m (r × v))/(I + m |r|²)")
def test_a_rocking_block_keeps_what_housner_says(lesson, draw):
    for _ in range(3):
        b, h, m, rate = draw(0.1, 0.3), draw(0.4, 1.0), draw(0.5, 2.0), -draw(0.5, 2.0)
        I = m * (b * b + h * h) / 3.0
        alpha = np.arctan(b / h)
        v, omega = lesson.corner_impact(rate * np.array([-h, b]), rate, np.array([b, -h]), 1.0 / m, 1.0 / I)
        close("angular velocity after over before [-]", omega / rate, 1.0 - 1.5 * np.sin(alpha) ** 2, ROUND_OFF,
              given=f"half sizes {b} and {h} m")
        close("velocity of its centre then [m/s]", v, omega * np.array([-h, -b]), ROUND_OFF)


@exercise("10.12", points=0.5,
          hint="v⁺ + ω⁺ × r = 0: the corner stops. The angular momentum about it stays, also where ω changes its sign")
def test_the_corner_stops_and_one_impulse_there_explains_it(lesson, draw):
    """In any direction, of light and of heavy bodies, near their centres and far from them; and hardly moving.

    At last r, v and ω are often 0 or along an axis.
    """
    kinds = ((1.0, 1.0, 1.0), (3.0, 1.0, 1.0), (1.0, TINY, 1.0), (1.0, 1e6, 1.0), (1.0, 1.0, 1e6), (1.0, 1.0, 1e-6),
             (1e-3, 1.0, 1.0))
    usual = [(speed, heavy, np.append(size * unit_vector(draw, 2), speed * draw(-2.0, 2.0, 3)))
             for size, speed, heavy in 4 * kinds]
    arms, speeds, spins = often_zero(draw, 60, 2), often_zero(draw, 60, 2), often_zero(draw, 60, 1)
    usual += [(speed, heavy, row * (1.0, 1.0, -1.0, -1.0, -1.0)) for speed, heavy, row in usual]     # and backwards
    for speed, heavy, row in usual + [(1.0, 1.0, often) for often in np.hstack((arms, speeds, spins))]:
        m, I, r, v, omega = *heavy * draw(0.5, 2.0, 2), row[:2], row[2:4], row[4]
        v_new, omega_new = lesson.corner_impact(v, omega, r, 1.0 / m, 1.0 / I)
        v_new, given = np.asarray(v_new), f"r = {r} m, m = {m} kg, I = {I} kg m², v = {v} m/s, ω = {omega} rad/s"
        close("velocity of the corner [m/s]", v_new + omega_new * np.array([-r[1], r[0]]), np.zeros(2),
              speed * ROUND_OFF, given=given)
        J = m * (v_new - v)
        close("change of spin that the impulse at the corner explains, over m + I [1/s]",
              I * (omega_new - omega) / (m + I), (r[0] * J[1] - r[1] * J[0]) / (m + I), speed * 10.0 * ROUND_OFF,
              given=given)


@exercise("10.12", points=0.5,
          hint="a body that already turns about the corner continues, and a body at rest stays at rest")
def test_what_turns_about_the_corner_goes_on(lesson, draw):
    """Also a small body that hits with its velocity only: ω⁺ = −r × v/(c + 1)|r|², with I = c m |r|²."""
    for size in (TINY, 1e6):
        m, share, way, v = draw(0.5, 2.0), draw(0.3, 1.0), unit_vector(draw, 2), draw(-2.0, 2.0, 2)
        _, omega = lesson.corner_impact(v, 0.0, size * way, 1.0 / m, 1.0 / (share * m * size * size))
        close("angular velocity after an impact, times the distance of the corner [m/s]", omega * size,
              -(way[0] * v[1] - way[1] * v[0]) / (1.0 + share), MANY, given=f"r = {size * way} m, v = {v} m/s")
    m, I, r, rate = draw(0.5, 2.0), draw(0.5, 2.0), draw(0.3, 1.0, 2), draw(0.5, 2.0)
    v, omega = lesson.corner_impact(rate * np.array([r[1], -r[0]]), rate, r, 1.0 / m, 1.0 / I)
    close("angular velocity [rad/s]", omega, rate, ROUND_OFF)
    close("velocity of the centre [m/s]", v, rate * np.array([r[1], -r[0]]), ROUND_OFF)
    slides, _ = lesson.corner_impact(np.array([draw(0.5, 1.0), 0.0]), 0.0, np.array([0.5, 0.0]), 1.0 / m, 1.0 / I)
    close("velocity of what slides into an edge at the height of its centre [m/s]", slides, np.zeros(2), ROUND_OFF)


# ---------------------------------------------------------------------------------------------- invariants

def tensor_of(i, q, p):
    """The inertia tensor of a body in the world."""
    return matrix(q[i]) @ np.diag(1.0 / p.inv_inertia[i]) @ matrix(q[i]).T


@exercise("10.13", points=0.5, hint="½ m v² + ½ ω · I ω − m g · x, with the tensor of the body in the world")
def test_energy_is_that_of_motion_rotation_and_height(lesson, draw):
    ordinary = [moving(draw, lesson, planes) for planes in (2, 0)]
    for _, x, q, v, omega, _, p in (*special(draw, lesson, 3), *ordinary):
        p = p._replace(gravity=p.gravity * draw(-0.5, 0.5) + (p.gravity != 0.0) * draw(-5.0, 5.0, 3),
                       inv_inertia=mixed(p.inv_inertia))
        expected = 0.0
        for i in np.flatnonzero(p.inv_mass):
            expected += (0.5 * v[i] @ v[i] - p.gravity @ x[i]) / p.inv_mass[i]
            if p.inv_inertia[i, 0] > 0.0:
                expected += 0.5 * omega[i] @ tensor_of(i, q, p) @ omega[i]
        close("energy [J]", lesson.mechanical_energy(x, q, v, omega, p), expected, MANY,
              given=f"rows with inv_mass 0: {np.flatnonzero(p.inv_mass == 0.0)}, with inv_inertia 0: "
                    f"{np.flatnonzero(p.inv_inertia[:, 0] == 0.0)}")
    x_2, q_2, v_2, omega_2, (plain, *others) = of_all_sizes(draw, lesson)
    usual = lesson.mechanical_energy(x_2, q_2, v_2, omega_2, plain[1])
    for scale, other in others:
        close("energy of dust or of planets, over their masses [J/kg]",
              lesson.mechanical_energy(x_2, q_2, v_2, omega_2, other) / scale, usual, MANY,
              given=f"all masses and moments times {scale:g}")
    for size in (1e-6, 1e4):
        scaled = plain[1]._replace(gravity=size * plain[1].gravity)
        got = lesson.mechanical_energy(size * x_2, q_2, size * v_2, size * omega_2, scaled)
        close("energy where places, velocities and gravity are very small or large, over the square [J]",
              got / size**2, usual, MANY, given=f"all times {size:g}")
    deep = lesson.mechanical_energy(x + 99.0 * p.gravity, q, v, omega, p)
    close("energy of what is far below [J]", deep, expected - 99.0 * p.gravity @ p.gravity * heaviness(p), 1e-8)


def mixed(inv_inertia):
    """Principal moments in neither a rising nor a falling order."""
    return np.ascontiguousarray(inv_inertia[:, [1, 2, 0]])


def of_all_sizes(draw, lesson):
    """(x, q, v, omega, p, its rows) of bodies from a grain of dust to a planet: all masses times 10^±30."""
    _, x, q, v, omega, _, p = moving(draw, lesson, 0)
    return x, q, v, omega, [(scale, p._replace(inv_mass=p.inv_mass / scale, inv_inertia=p.inv_inertia / scale))
                            for scale in (1.0, 1.0 / TINY, TINY)]


def heaviness(p):
    """The mass of all that can move [kg]."""
    return np.sum(1.0 / p.inv_mass[p.inv_mass > 0.0])


@exercise("10.13", points=0.5,
          hint="bodies that cannot move have no energy here; for the others add up all three parts")
def test_energy_of_a_throw_stays(lesson, draw):
    """From one time of a parabola to another; the body turns about a principal axis."""
    q, rate, T = quaternions(draw, 2), draw(0.5, 2.0), draw(0.5, 1.0)
    x, v = draw(-1.0, 1.0, (2, 3)), draw(-2.0, 2.0, (2, 3))
    p = bodies_of(lesson, [draw(0.5, 2.0), 0.0], [1.0 / moments(draw), np.zeros(3)])
    omega = np.stack([rate * matrix(one)[:, 2] for one in q])
    fall, down = np.zeros((2, 3)), np.zeros((2, 3))
    fall[0, 2], down[0, 2] = -0.5 * G * T * T, -G * T
    before = lesson.mechanical_energy(x, q, v, omega, p)
    after = lesson.mechanical_energy(x + T * v + fall, q, v + down, omega, p)
    close("change of the energy of a throw [J]", after - before, 0.0, MANY)
    lifted = lesson.mechanical_energy(x + np.array([0.0, 0.0, T]), q, v, omega, p)
    close("energy that lifting adds [J]", lifted - before, G * T / p.inv_mass[0], MANY, given=f"lifted by {T} m")
    rest = lesson.mechanical_energy(np.zeros((2, 3)), q, np.zeros((2, 3)), np.zeros((2, 3)), p)
    close("energy of what rests at the origin [J]", rest, 0.0, ROUND_OFF)


@exercise("10.14", points=0.5, hint="P = Σ m v,  L = Σ x × m v + I ω, with I ω in the world")
def test_momenta_are_those_of_orbit_and_spin(lesson, draw):
    ordinary = [moving(draw, lesson, planes) for planes in (2, 0)]
    for _, x, q, v, omega, _, p in (*special(draw, lesson, 3), *ordinary):
        P, L, p = np.zeros(3), np.zeros(3), p._replace(inv_inertia=mixed(p.inv_inertia))
        for i in np.flatnonzero(p.inv_mass):
            P, L = P + v[i] / p.inv_mass[i], L + np.cross(x[i], v[i]) / p.inv_mass[i]
            if p.inv_inertia[i, 0] > 0.0:
                L = L + tensor_of(i, q, p) @ omega[i]
        got, given = lesson.momenta(x, q, v, omega, p), f"rows with inv_mass 0: {np.flatnonzero(p.inv_mass == 0.0)}"
        close("momentum [kg m/s]", got[0], P, MANY, given=given)
        close("angular momentum about the origin [kg m²/s]", got[1], L, MANY, given=given)
    x, q, v, omega, (plain, *others) = of_all_sizes(draw, lesson)
    usual = lesson.momenta(x, q, v, omega, plain[1])
    for scale, other in others:
        for name, one, expected in zip(("momentum", "angular momentum"), lesson.momenta(x, q, v, omega, other), usual,
                                       strict=True):
            close(f"{name} of dust or of planets, over their masses", np.asarray(one) / scale, expected, MANY,
                  given=f"all masses and moments times {scale:g}")
    for far, fast, turns in ((1e-6, 1.0, 1e-6), (1e4, 1.0, 1e4), (1.0, 1e-6, 1e-6), (1.0, 1e4, 1e4)):
        got = lesson.momenta(far * x, q, fast * v, turns * omega, plain[1])
        close("momentum of slow or fast bodies, over their speed", np.asarray(got[0]) / fast, usual[0], MANY)
        close("angular momentum of near, far, slow or fast bodies, over that", np.asarray(got[1]) / turns, usual[1],
              MANY, given=f"x times {far:g}, v times {fast:g}, ω times {turns:g}")


@exercise("10.14", points=0.5, hint="about another point, L differs by the cross product of the displacement and P")
def test_angular_momentum_belongs_to_a_point(lesson, draw):
    _, x, q, v, omega, _, p = moving(draw, lesson, 1)
    way = draw(-2.0, 2.0, 3)
    P, L = map(np.asarray, lesson.momenta(x, q, v, omega, p))
    P_there, L_there = map(np.asarray, lesson.momenta(x + way, q, v, omega, p))
    moves = p.inv_mass > 0.0
    close("momentum [kg m/s]", P, np.sum(v[moves] / p.inv_mass[moves, None], axis=0), MANY)
    close("momentum after all bodies are moved [kg m/s]", P_there, P, MANY)
    close("angular momentum after all bodies are moved [kg m²/s]", L_there, L + np.cross(way, P), MANY)


@exercise("10.15", points=0.5, hint="the largest difference of (E − W) at a later time and (E − W) at an earlier time")
def test_the_largest_gain_is_found_among_all_pairs_of_times(lesson, draw):
    """It is between the ends, somewhere, before the lowest time, and after the highest one."""
    for rest in (np.concatenate(([-3.0], draw(-2.0, 2.0, 7), [3.0])), draw(-2.0, 2.0, 8),
                 np.sort(draw(-2.0, 2.0, 2)), np.sort(draw(-2.0, 2.0, 3)),
                 np.array([0.0, 4.0, -6.0, -5.0]), np.array([6.0, 0.0, 4.0, -1.0])):
        n, work = len(rest), draw(-2.0, 2.0, len(rest))
        energies = rest * draw(0.5, 1.0) + work
        expected = max((energies - work)[k] - (energies - work)[j] for k in range(n) for j in range(k + 1))
        close("largest gain [J]", lesson.gain_without_source(energies, work), expected, ROUND_OFF,
              given=f"E − W = {energies - work} J")
    for size, unit in ((1e9, "gigajoules"), (1e-9, "nanojoules"), (TINY, "next to no joules")):
        close(f"largest gain of a run in {unit} [J]", lesson.gain_without_source(size * energies, size * work),
              size * expected, size * MANY)
    close("largest gain of a single time [J]", lesson.gain_without_source(energies[:1], work[:1]), 0.0,
          ROUND_OFF)
    slow = np.cumsum(draw(1e-11, 2e-11, 300))                             # far below the energy, in many small steps
    close("largest gain of what gains slowly [J]", lesson.gain_without_source(1e3 + slow, np.zeros(300)),
          slow[-1] - slow[0], MANY)
    least = draw.whole(1, 9) * 2.0**-43                                   # the last digit of 1000
    close("largest gain of what gains the last digit only [J]",
          lesson.gain_without_source(np.array([1e3, 1e3, 1e3 + least]), np.zeros(3)), least, 0.0)


@exercise("10.15", points=0.25, hint="energies, work = checked_histories(energies, work) comes first")
def test_histories_need_not_be_arrays_and_must_be_alike(lesson, draw):
    energies, work = draw(-2.0, 2.0, 6), draw(-2.0, 2.0, 6)
    for wrong in (np.nan, np.inf):
        raises("an energy that is no finite number", BadInput, lesson.gain_without_source,
               np.append(energies[:5], wrong), work, thing="an energy")
        raises("a work that is no finite number", BadInput, lesson.gain_without_source, energies,
               np.append(work[:5], wrong), thing="a work")
    raises("work of fewer times", BadInput, lesson.gain_without_source, energies, work[:5],
           thing="the shape of the work")
    expected = max((energies - work)[k] - (energies - work)[j] for k in range(6) for j in range(k + 1))
    close("largest gain of numbers that are in no array [J]",
          lesson.gain_without_source(tuple(energies.tolist()), tuple(work.tolist())), expected, ROUND_OFF)
    close("largest gain of whole numbers [J]", lesson.gain_without_source((3, 1, 2), (0, 0, 0)), 1.0, 0.0)


@exercise("10.15", points=0.25, hint="return 0 if the energy only falls; a gain that work explains does not count")
def test_what_only_loses_gains_nothing(lesson, draw):
    energies = 5.0 - np.cumsum(draw(0.1, 1.0, 8))
    close("largest gain of what only loses [J]", lesson.gain_without_source(energies, np.zeros(8)), 0.0, 0.0)
    lifted = np.cumsum(draw(0.1, 1.0, 8))
    close("largest gain of what is lifted by work [J]", lesson.gain_without_source(lifted, lifted.copy()), 0.0,
          ROUND_OFF)
    jump = energies.copy()
    jump[5:] += 2.0
    close("largest gain where 2 J come from nowhere [J]", lesson.gain_without_source(jump, np.zeros(8)),
          2.0 - (energies[4] - energies[5]), ROUND_OFF)


def compared(lesson, full_times, minimal_times, full_ends, minimal_ends):
    """What `compare` returns of runs that take these times on a clock of their own, and end so.

    To compare two ends takes time on that clock, too, but belongs to neither run.
    """
    now, order = [100.0], []

    class End(np.ndarray):
        def __array_ufunc__(self, ufunc, method, *inputs, out=(), **named):
            now[0] += 1.0
            named |= {"out": tuple(map(np.asarray, out))} if out else {}
            return getattr(ufunc, method)(*map(np.asarray, inputs), **named)

    def runs(number, times, ends):
        left = iter(zip(times, ends, strict=True))

        def one():
            order.append(number)
            time, end = next(left, (1.0, ends[0]))
            now[0] += time
            return end.copy().view(End)
        return one
    answer = lesson.compare(runs(1.0, full_times, full_ends), runs(0.0, minimal_times, minimal_ends), len(full_times),
                            lambda: now[0])
    close("runs in their order: 1 full, 0 minimal [-]", order, np.tile([1.0, 0.0], len(full_times)), 0.0)
    return answer


@pytest.mark.counts_calls
@exercise("10.16", points=0.5,
          hint="clock() directly before and after each run; the median of the ratios of all rounds")
def test_the_ratio_is_the_median_of_neighbours(lesson, draw):
    """The median is neither the first nor the last ratio, nor that of the run in the middle, nor one of four."""
    for order, short in (([1, 3, 0, 5, 6, 2, 4], 1e-4), ([1, 3, 0, 2], 1e-7), ([1, 0], 1e-4), ([0], 1e-4)):
        n = len(order)
        quick, ratios = np.sort(draw(short, 1.2 * short, n)), np.sort(10.0 ** draw(-3.0, 3.0, n))[order]
        full, minimal = draw(-1.0, 1.0, (2, n, 4, 2))
        _, ratio = compared(lesson, quick * ratios, quick, full, minimal)
        # the clock shows 100 s, to 1e-14 s
        close("ratio of times [-]", ratio, np.median(ratios), 1e-12 / short * (1.0 + np.max(ratios)),
              given=f"times of the full loop {quick * ratios} s, of the other {quick} s")


@pytest.mark.counts_calls
@exercise("10.16", points=0.5, hint="the largest absolute difference in all entries and all runs")
def test_the_difference_is_the_largest_of_all(lesson, draw):
    """The largest one is in the second of four runs, in the middle or at the end of the array, and has either sign."""
    for sign, size, entry in ((1.0, 1.0, (2, 1)), (1.0, 1e6, (0, 0)), (-1.0, TINY, (1999, 2))):
        full, minimal = size * draw(-1.0, 1.0, (2, 4, 2000, 3))
        half = size * draw(1.2, 1.8)
        full[1][entry], minimal[1][entry] = -sign * half, sign * half
        difference, ratio = compared(lesson, np.full(4, 3.0), np.full(4, 1.5), full, minimal)
        close("largest difference [-]", difference, 2.0 * half, size * ROUND_OFF,
              given=f"full − minimal is {-2.0 * sign * half} there")
        close("ratio of times [-]", ratio, 2.0, ROUND_OFF)
    for shape in ((7,), (4, 3, 2), (2, 1, 3, 2)):
        ends = draw(-1.0, 1.0, (2, 4, *shape))
        difference, _ = compared(lesson, np.full(4, 3.0), np.full(4, 1.5), *ends)
        close("largest difference of arrays with more or fewer axes [-]", difference, np.max(np.abs(ends[0] - ends[1])),
              ROUND_OFF, given=f"{len(shape)} axes")
    difference, _ = compared(lesson, np.full(4, 3.0), np.full(4, 1.5), full, full)
    close("difference of what is the same [-]", difference, 0.0, 0.0)
    for loops in ([0], [1], [0, 1]):
        ends = np.stack((full, minimal))
        ends[loops, 2, 3, 1] = np.nan
        difference, _ = compared(lesson, np.full(4, 3.0), np.full(4, 1.5), *ends)
        truth("whether the difference is NaN where a run has ended with NaN", bool(np.isnan(difference)), True,
              given=" and ".join(("full", "minimal")[k] for k in loops))


# ---------------------------------------------------------------------------------------------- why?

@exercise("10.17", points=1,
          hint="count the steps until the gap is at most the margin: the body has moved by that many v dt")
def test_a_body_stops_at_the_predicted_depth(lesson, draw):
    """What creeps and what flies, after 1 to 3000 steps: one step less leaves a gap of (1 − share) ways + margin."""
    for slow, short, least in itertools.product((0, -4, -2, 2), (-1, -5, -3), (1, 10, 100, 1000)):
        speed, dt, steps = 10.0 ** draw(slow, slow + 2), 10.0 ** draw(short, short + 2), draw.whole(least, 3 * least)
        way = speed * dt
        parts, least_share = (draw(0.05, 0.99), 0.0, 1e-3, draw(3.0, 9.0)), 1e-12 * steps     # far above round-off
        for share, part in itertools.product((draw(0.1, 0.9), least_share, 1.0 - least_share), parts):
            margin = part * share * way
            gap = margin + (steps - share) * way
            close("depth at which the loop stops the body [m]", lesson.stopping_depth(speed, gap, margin, dt),
                  max(0.0, share * way - margin), ROUND_OFF * gap,
                  given=f"speed {speed}, gap {gap}, margin {margin}, dt = {dt}")
        close("depth of a body that begins within the margin [m]",
              lesson.stopping_depth(speed, draw(0.01, 1.0) * margin, margin, 10.0 ** draw(0.0, 3.0) * dt), 0.0, 0.0)
    for steps, margin, k in itertools.product((0, 1, 2, 999), (0.0, 0.25), (-9, 1, 9)):    # it comes to the margin
        speed, dt = 2.0**k, 0.5
        close("depth of a body that comes to exactly the margin [m]",
              lesson.stopping_depth(speed, margin + (steps or 1.0 * (margin == 0.0)) * speed * dt, margin, dt), 0.0,
              ROUND_OFF, given=f"speed {speed}, margin {margin}, dt = {dt}, {steps} steps")


@exercise("10.18", points=1, hint="2 t(dt/2) − t(dt) is the same for every dt if, and only if, the error is c dt")
def test_the_chosen_result_has_an_error_in_proportion_to_the_step(lesson):
    choice("the letter of the result that may be extrapolated", lesson.may_be_extrapolated(), choices.where(
        "simulator", "times_of_an_event", lambda dt, t: np.ptp(2.0 * t[:-1] - t[1:]) < 1e-12))


def judged_run(lesson, x, q, v, half, planes, steps=100, dt=0.01, margin=0.03):
    """(overlap, fastest way per step, rise of the energy, pairs that meet) of boxes of 1 kg in the lesson's loop."""
    n, moment = len(x), np.sum(half**2, axis=1) / 3.0
    state, p = made(lesson, x, 1.0, moment, half, planes, 0.5, 10, margin)
    state = state._replace(q=np.append(q, np.zeros(len(planes))), v=np.vstack((v, np.zeros((len(planes), 2)))))
    energies, ways, gaps, pushed = [], [], [0.0], []
    for k in range(steps):
        x, _, v, omega = (np.asarray(part)[:n] for part in state[:4])
        energies.append(0.5 * np.sum(v * v) + 0.5 * np.sum(moment * omega**2) + G * np.sum(x[:, 1]))
        state = lesson.contact_step_2d(lesson.weight, lesson.box_bounds_2d, lesson.box_contacts_2d, k * dt, state, dt,
                                       p)
        c, J = state.contacts, np.asarray(state.J)
        ways.append(dt * np.max(np.linalg.norm(np.asarray(state.v), axis=1)))
        gaps.extend(c.gap)
        near = [(int(a), int(b), bool(np.any(j))) for a, b, j in zip(c.a, c.b, J, strict=True) if max(a, b) < n]
        pushed.append({(a, b) for a, b, pushes in near if pushes or k == 0})
    return -np.min(gaps), np.max(ways), np.max(energies) - energies[0], len(set.union(*pushed) - pushed[0])


@exercise("10.19", points=1,
          hint="begin with a row of dominoes; where boxes come in faster than margin/dt, they stop inside each other")
def test_a_scene_of_ones_own_meets_and_gains_no_energy(lesson):
    for n in range(5, 9):
        given, shapes = f"n = {n}", {"x": (n, 2), "q": (n,), "v": (n, 2), "half": (n, 2)}
        *boxes, planes = lesson.my_scene(n)
        x, q, v, half = (numbers(name, part, shape, given)
                         for (name, shape), part in zip(shapes.items(), boxes, strict=True))
        planes = numbers("planes", planes, (len(planes), 3), given) if len(planes) else np.zeros((0, 3))
        between("smallest half size [m]", half.min(), 0.05, 0.5, given)
        between("largest half size [m]", half.max(), 0.05, 0.5, given)
        close("lengths of the normals of the planes", np.hypot(*planes.T[:2]), np.ones(len(planes)), ROUND_OFF,
              given=given)
        overlap, way, rise, met = judged_run(lesson, x, q, v, half, planes)
        between("largest overlap [m]", overlap, 0.0, 0.01, given)
        between("largest way of a box in a step, over the smallest half size", way / half.min(), 0.0, 1.0, given)
        between("rise of the energy above that at the start [J]", rise, 0.0, 0.001 * n * G, given)
        between("pairs that are apart at the start and push each other later", met, n / 2.0, n * n, given)
