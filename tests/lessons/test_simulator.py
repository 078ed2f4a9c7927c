"""Lesson 10 is right when the composed loop follows closed forms on floors that stand, slope and move, when events are
found to round-off, and when its invariants see what is wrong with a run.
"""

import itertools

import numpy as np
import pytest

from solutions.checks import BadInput

from ..grading.expect import between, close, raises

exercise = pytest.mark.exercise
G = 9.81                     # [m/s²]
# Everything drawn is below 10 in its unit.  A comparison takes a few dozen operations, each rounded by 1.1e-16 of that.
ROUND_OFF = 1e-12
MANY = 1e-10                 # the same after a hundred steps
SWEPT = 1e-9                 # of impulses that sweeps have found: 0.7 of the error is left by each of at least 60


def unit_vector(draw, d):
    """A direction along no axis of the coordinates."""
    n = draw(0.3, 1.0, d) * np.array([(-1.0) ** draw.whole(0, 1) for _ in range(d)])
    return n / np.linalg.norm(n)


def quaternions(draw, n):
    return np.stack([unit_vector(draw, 4) for _ in range(n)])


def matrix(q):
    """Rotation matrix of a unit quaternion, by its action on three vectors."""
    w, a = q[0], q[1:]
    return np.stack([e + 2.0 * w * np.cross(a, e) + 2.0 * np.cross(a, np.cross(a, e)) for e in np.eye(3)], axis=1)


def about(axis, angle):
    """Rotation matrix about a unit vector."""
    K = np.cross(np.eye(3), axis)                                        # K r = axis × r
    return np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * (K @ K)


def moments(draw):
    """Three principal moments of a body [kg m²]."""
    return np.array([1.0, draw(1.2, 1.5), draw(1.6, 2.0)]) * draw(0.5, 1.5)


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
    nobody = np.zeros(0, np.int64)
    contacts = lesson.ContactSet(np.zeros(n + 1, np.int64), nobody, nobody, np.zeros((0, d)), np.zeros((0, d)),
                                 np.zeros(0))
    q = np.zeros(n + p) if d == 2 else np.tile(np.eye(4)[0], (n + p, 1))
    spin = np.zeros(n + p) if d == 2 else np.zeros((n + p, 3))
    return lesson.PileState(np.vstack((x, np.zeros((p, d)))), q, np.zeros((n + p, d)), spin, contacts,
                            np.zeros((0, d))), bodies


def swirl_2d(t, x, q, v, omega, p):
    """Forces and torques that depend on all arguments, so that an outdated one is noticed."""
    F = np.cos(t) - 0.5 * v + 0.3 * x
    return F, np.sin(t) + 0.2 * q - 0.4 * omega + x[:, 0] * v[:, 1]


def swirl(t, x, q, v, omega, p):
    """The same in space."""
    return np.cos(t) - 0.5 * v + 0.3 * x, np.sin(t) + 0.2 * q[:, 1:] - 0.4 * omega + 0.1 * v


T_0, T_1, T_2 = 1.0, 5.0, 6.0          # [s] from when there is weight and no kick; drag; a push


def late_weight(t, x, q, v, omega, p):
    """Weight from half a second before T_0 on, and drag from T_1 on: an outdated time or velocity is noticed.

    All tests of contacts use it: the loop is compiled anew for each function that it is given.
    """
    F = np.zeros(x.shape)
    for i in range(x.shape[0]):
        if t > 0.5 * T_0 and p.inv_mass[i] > 0.0:
            F[i] = p.gravity / p.inv_mass[i] - (5.0 * v[i] if t >= T_1 else 0.0 * v[i])
    return F, np.zeros(omega.shape)


def nothing(t, x, q, v, omega, p):
    return 0.0 * x, 0.0 * omega


def moving_2d(draw, lesson, fixed=True):
    """(t, x, q, v, omega, dt, p) of four bodies in the plane, of which the last may be one that no force moves."""
    inv_mass, inv_inertia = draw(0.3, 2.0, 4), draw(0.5, 5.0, 4)
    if fixed:
        inv_mass[3] = inv_inertia[3] = 0.0
    return (draw(0.5, 1.5), draw(-2.0, 2.0, (4, 2)), draw(-3.0, 3.0, 4), draw(-2.0, 2.0, (4, 2)), draw(-2.0, 2.0, 4),
            draw(0.05, 0.2), bodies_of(lesson, inv_mass, inv_inertia))


def moving(draw, lesson):
    """The same in space; the last body is one that no force moves."""
    inv_mass, I = np.append(draw(0.3, 2.0, 2), 0.0), np.stack([moments(draw) for _ in range(2)])
    return (draw(0.5, 1.5), draw(-2.0, 2.0, (3, 3)), quaternions(draw, 3), draw(-2.0, 2.0, (3, 3)),
            draw(-2.0, 2.0, (3, 3)), draw(0.05, 0.2), bodies_of(lesson, inv_mass, np.vstack((1.0 / I, np.zeros(3)))))


def euler(q, omega, tau, I):
    """ω̇ by Euler's equation in the world, with the whole tensor."""
    tensor = matrix(q) @ np.diag(I) @ matrix(q).T
    return np.linalg.solve(tensor, tau - np.cross(omega, tensor @ omega))


# ---------------------------------------------------------------------------------------------- without contact

@exercise("10.1", points=0.5, hint="F, τ = load(t, x, q, v, omega, p); v + dt F/m and ω + dt τ/I, with inverse masses")
def test_loads_change_velocities_of_what_they_can_move(lesson, draw):
    for fixed in (True, False):
        t, x, q, v, omega, dt, p = moving_2d(draw, lesson, fixed)
        got_v, got_omega = lesson.new_velocities_2d(swirl_2d, t, x, q, v, omega, dt, p)
        F, tau = swirl_2d(t, x, q, v, omega, p)
        expected = np.array([v[i] + dt * F[i] * p.inv_mass[i] for i in range(4)])
        close("v after the loads [m/s]", got_v, expected, ROUND_OFF, given=f"inverse masses {p.inv_mass} 1/kg")
        close("ω after the loads [rad/s]", got_omega, [omega[i] + dt * tau[i] * p.inv_inertia[i] for i in range(4)],
              ROUND_OFF)


@exercise("10.1", points=0.5, hint="the change of the total momentum is dt times the total force")
def test_momentum_changes_by_the_forces_times_dt(lesson, draw):
    t, x, q, v, omega, dt, p = moving_2d(draw, lesson, False)
    got_v, got_omega = map(np.asarray, lesson.new_velocities_2d(swirl_2d, t, x, q, v, omega, dt, p))
    F, tau = swirl_2d(t, x, q, v, omega, p)
    close("change of momentum over dt [N]", np.sum((got_v - v) / p.inv_mass[:, None], axis=0) / dt, F.sum(axis=0), MANY)
    close("change of spin over dt [N m]", np.sum((got_omega - omega) / p.inv_inertia) / dt, tau.sum(), MANY)


@exercise("10.2", points=1, hint="angular_acceleration(q[i], ω[i], τ[i], 1/inv_inertia[i]) for each body that can turn")
def test_every_body_in_space_obeys_euler(lesson, draw):
    t, x, q, v, omega, dt, p = moving(draw, lesson)
    F, tau = swirl(t, x, q, v, omega, p)
    got_v, got_omega = map(np.asarray, lesson.new_velocities(swirl, t, x, q, v, omega, dt, p))
    close("v after the loads [m/s]", got_v, v + dt * p.inv_mass[:, None] * F, ROUND_OFF)
    for i in range(2):
        close("ω after the loads [rad/s]", got_omega[i],
              omega[i] + dt * euler(q[i], omega[i], tau[i], 1.0 / p.inv_inertia[i]), ROUND_OFF,
              given=f"body {i}: q = {q[i]}, ω = {omega[i]}, τ = {tau[i]}")
    close("ω of a body that no torque turns [rad/s]", got_omega[2], omega[2], 0.0)
    some = p._replace(inv_mass=p.inv_mass[[2, 0, 1]].copy(), inv_inertia=p.inv_inertia[[0, 1, 2]].copy())
    _, got_omega = lesson.new_velocities(swirl, t, x, q, v, omega, dt, some)
    close("ω of a body that torques turn and no force moves [rad/s]", np.asarray(got_omega)[0],
          omega[0] + dt * euler(q[0], omega[0], tau[0], 1.0 / p.inv_inertia[0]), ROUND_OFF)
    close("ω of a body that has a mass, and inv_inertia 0 [rad/s]", np.asarray(got_omega)[2], omega[2], 0.0)


@exercise("10.2", points=0.5, hint="the gyroscopic term does no work: ω · I ω̇ = ω · τ")
def test_the_power_is_that_of_the_torque(lesson, draw):
    t, x, q, v, omega, _, p = moving(draw, lesson)
    dt = 1e-3
    _, tau = swirl(t, x, q, v, omega, p)
    _, got = lesson.new_velocities(swirl, t, x, q, v, omega, dt, p)
    for i in range(2):
        tensor = matrix(q[i]) @ np.diag(1.0 / p.inv_inertia[i]) @ matrix(q[i]).T
        # (ω' − ω) rounds at 2e-16 of 2, over dt
        close("power ω · I (ω' − ω)/dt [W]", omega[i] @ tensor @ (np.asarray(got)[i] - omega[i]) / dt,
              omega[i] @ tau[i], MANY, given=f"body {i}")


@exercise("10.3", points=0.5, hint="velocities first; then positions with the new ones")
def test_a_step_in_the_plane_is_velocities_first(lesson, draw):
    for fixed in (True, False):
        t, x, q, v, omega, dt, p = moving_2d(draw, lesson, fixed)
        F, tau = swirl_2d(t, x, q, v, omega, p)
        new_v, new_omega = v + dt * p.inv_mass[:, None] * F, omega + dt * p.inv_inertia * tau
        got = lesson.free_step_2d(swirl_2d, t, x, q, v, omega, dt, p)
        for name, is_, should in zip(("x [m]", "q [rad]", "v [m/s]", "ω [rad/s]"), got,
                                     (x + dt * new_v, q + dt * new_omega, new_v, new_omega)):
            close(f"{name} after a step", is_, should, ROUND_OFF)


@exercise("10.3", points=0.5, hint="a fall is ½ g t² (1 + dt/t) long with symplectic Euler; angles grow by ω t")
def test_bodies_fly_on_parabolas_that_are_late_by_half_a_step(lesson, draw):
    _, x, q, v, omega, _, p = moving_2d(draw, lesson)
    T, n = draw(0.5, 1.5), draw.whole(10, 40)
    state = x, q, v, omega
    for k in range(n):
        state = lesson.free_step_2d(lesson.weight, k * T / n, *state, T / n, p)
    got_x, got_q, _, got_omega = map(np.asarray, state)
    fall = -0.5 * G * T * T * (1.0 + 1.0 / n) * np.array([1.0, 1.0, 1.0, 0.0])
    close("x after a flight [m]", got_x, x + T * v + np.stack((0.0 * fall, fall), axis=1), MANY, given=f"{n} steps")
    close("q after a flight [rad]", got_q, q + T * omega, MANY)
    close("ω after a flight [rad/s]", got_omega, omega, 0.0)


@exercise("10.4", points=0.5, hint="quaternion_update(q[i], ω[i], dt) for each body, with its new ω")
def test_a_step_in_space_is_velocities_first(lesson, draw):
    t, x, q, v, omega, dt, p = moving(draw, lesson)
    F, tau = swirl(t, x, q, v, omega, p)
    new_v, new_omega = v + dt * p.inv_mass[:, None] * F, omega.copy()
    for i in range(2):
        new_omega[i] += dt * euler(q[i], omega[i], tau[i], 1.0 / p.inv_inertia[i])
    got = [np.asarray(part) for part in lesson.free_step(swirl, t, x, q, v, omega, dt, p)]
    close("x after a step [m]", got[0], x + dt * new_v, ROUND_OFF)
    close("v after a step [m/s]", got[2], new_v, ROUND_OFF)
    close("ω after a step [rad/s]", got[3], new_omega, ROUND_OFF)
    for i in range(3):
        rate = np.linalg.norm(new_omega[i])
        turned = about(new_omega[i] / rate, 2.0 * np.arctan(0.5 * dt * rate)) @ matrix(q[i])
        close("orientation after a step, as a matrix", matrix(got[1][i]), turned, ROUND_OFF, given=f"body {i}")


@exercise("10.4", points=0.5, hint="does every body turn, even without torque? q has one row for each body")
def test_bodies_of_revolution_precess_as_they_should(lesson, draw):
    """L is constant; the body turns about L by |L|/A and about its own axis by (1/C − 1/A) L_axis per second."""
    A, C, T = draw(0.8, 1.2), draw(1.5, 2.0), 1.0
    q, omega = quaternions(draw, 2), draw(0.5, 1.5, (2, 3))
    p = bodies_of(lesson, [1.0, 0.0], [[1.0 / A, 1.0 / A, 1.0 / C], [0.0] * 3])
    R, errors = matrix(q[0]), []
    L = R @ (np.array([A, A, C]) * (R.T @ omega[0]))
    size = np.linalg.norm(L)
    axis = R[:, 2]
    truth = about(L / size, size / A * T) @ about(axis, (1.0 / C - 1.0 / A) * (L @ axis) * T) @ R
    for n in (100, 200):
        end = np.zeros((2, 3)), q, np.zeros((2, 3)), omega
        for k in range(n):
            end = lesson.free_step(nothing, k * T / n, *end, T / n, p)
        errors.append(np.max(np.abs(matrix(np.asarray(end[1])[0]) - truth)))
    # |ω| is at most 2.6: the local error ½ dt² (|ω̇| + |ω̇||ω|) is below 12 dt² and grows by less than 4 in a second
    between("error of the orientation after a second, as a matrix", errors[1], 0.0, 48.0 / 200)
    between("error with 200 steps over error with 100", errors[1] / errors[0], 0.4, 0.6)
    spun = np.linalg.norm(omega[1])
    # the angle 2 atan(½|ω| dt) of a step is short by (|ω| dt)³/12
    close("orientation of a body that no torque turns, as a matrix", matrix(np.asarray(end[1])[1]),
          about(omega[1] / spun, spun * T) @ matrix(q[1]), spun**3 / 12.0 / 200**2 + MANY)


# ---------------------------------------------------------------------------------------------- contacts are found

def found(lesson, x, half, planes, p):
    """{(a, b): gap} of what the lesson finds."""
    bounds = lesson.disc_bounds if x.shape[1] == 2 else lesson.ball_bounds
    q = np.zeros(len(x)) if x.shape[1] == 2 else np.tile(np.eye(4)[0], (len(x), 1))
    low, high, turned = bounds(x, q, p.half)
    c = lesson.find_contacts(lesson.round_contacts, x, low, high, turned, p)
    return {(int(a), int(b)): float(gap) for a, b, gap in zip(c.a, c.b, c.gap)}


def gaps(x, half, planes, movable):
    """{(a, b): gap} of all pairs of which one can move, planes last."""
    n, known = len(half), {}
    for i, j in itertools.combinations(range(n), 2):
        known[i, j] = np.linalg.norm(x[i] - x[j]) - half[i, 0] - half[j, 0]
    for i, (k, plane) in itertools.product(range(n), enumerate(planes)):
        known[i, n + k] = plane[:-1] @ x[i] + plane[-1] - half[i, 0]
    return {pair: gap for pair, gap in known.items() if movable[list(pair)].any()}


def crowd(draw, lesson, d, margin):
    """(x, half, planes, Bodies): ten round bodies of which three cannot move, and three planes.

    The last plane is a ceiling, and body 0 is below it, at a part of the margin.
    """
    n = 10
    x, half = draw(0.0, 2.0, (n, d)), np.repeat(draw(0.2, 0.5, (n, 1)), d, axis=1)
    x[0, -1] = 1.5 - half[0, 0] - draw(0.3, 0.9) * margin
    planes = np.stack([np.append(unit_vector(draw, d), draw(-0.5, 0.5)) for _ in range(2)]
                      + [np.append(-np.eye(d)[-1], 1.5)])
    inv_mass = np.append(draw(0.5, 2.0, 7), np.zeros(6))
    inv_inertia = inv_mass if d == 2 else np.repeat(inv_mass[:, None], 3, axis=1)
    bodies = bodies_of(lesson, inv_mass, inv_inertia, half, planes, margin=margin)
    return np.vstack((x, np.zeros((3, d)))), half, planes, bodies


@exercise("10.5", points=0.5, hint="widen the boxes by the margin on all sides, and let narrow find gaps up to margin")
def test_all_gaps_up_to_the_margin_are_found_and_no_others(lesson, draw):
    for d in (2, 3):
        for margin in (draw(0.01, 0.05), draw(0.2, 0.4)):
            x, half, planes, p = crowd(draw, lesson, d, margin)
            got, every = found(lesson, x, half, planes, p), gaps(x, half, planes, p.inv_mass > 0.0)
            expected = {pair: gap for pair, gap in every.items() if gap <= margin}
            close("number of contacts [-]", len(got), len(expected), 0.0, given=f"margin {margin} m, {d} dimensions")
            close("contacts that are not among them [-]", len(set(got) - set(expected)), 0, 0.0)
            close("their gaps [m]", [got[pair] for pair in sorted(got)], [expected[pair] for pair in sorted(got)],
                  ROUND_OFF)


@exercise("10.5", points=0.5, hint="movable_pairs leaves out pairs in which neither body can move")
def test_two_bodies_that_no_impulse_moves_have_no_contact(lesson, draw):
    for d in (2, 3):
        margin = draw(0.1, 0.2)
        x, half, planes, p = crowd(draw, lesson, d, margin)
        x[8] = x[7] + 0.1                                                # two that overlap and cannot move
        got = found(lesson, x, half, planes, p)
        still = [pair for pair in got if not (p.inv_mass[list(pair)] > 0.0).any()]
        close("contacts of bodies that no impulse moves [-]", len(still), 0, 0.0)
        x[0] = x[7] + 0.1
        got = found(lesson, x, half, planes, p)
        close("whether a body that moves touches one that does not [-]", float((0, 7) in got), 1.0, 0.0)


# ---------------------------------------------------------------------------------------------- the loop in the plane

def disc_on(lesson, draw, plane, mu, v=(0.0, 0.0), floor=(0.0, 0.0), height=0.0, sweeps=30, margin=0.05):
    """(PileState, Bodies, radius, 1/m) of a disc that touches a line, or is `height` above it; the line may move."""
    m, r = draw(0.5, 2.0), draw(0.2, 0.5)
    x = plane[:2] * (r + height - plane[2])
    state, p = made(lesson, [x], m, [0.5 * m * r * r], [(r, r)], [plane], mu, sweeps, margin)
    return state._replace(v=np.array([v, floor], float)), p, r, m


def run_2d(lesson, state, p, dt, steps, t=T_0):
    """So many steps of discs, one by one: the loop over steps takes long to compile."""
    for k in range(steps):
        state = lesson.contact_step_2d(late_weight, lesson.disc_bounds, lesson.round_contacts, t + k * dt, state, dt, p)
    return state


@exercise("10.6", points=0.5,
          hint="forces before contacts: contacts must stop the velocity that gravity adds in this step")
def test_a_disc_rolls_down_a_slope_or_slides(lesson, draw):
    """It rolls with ⅔ g sin θ where μ ≥ ⅓ tan θ, and else slides with g (sin θ − μ cos θ)."""
    slope, n, dt = draw(0.2, 0.7), draw.whole(20, 40), draw(0.002, 0.01)
    plane, down = np.array([np.sin(slope), np.cos(slope), draw(-0.5, 0.5)]), np.array([np.cos(slope), -np.sin(slope)])
    for mu, rate, spin in ((draw(0.5, 1.0) * np.tan(slope), 2.0 / 3.0 * G * np.sin(slope), True),
                           (draw(0.1, 0.3) * np.tan(slope), None, False)):
        state, p, r, _ = disc_on(lesson, draw, plane, mu)
        end = run_2d(lesson, state, p, dt, n)
        a = G * (np.sin(slope) - mu * np.cos(slope)) if rate is None else rate
        close("velocity of a disc on a slope [m/s]", np.asarray(end.v)[0], n * dt * a * down, MANY,
              given=f"tan θ = {np.tan(slope)}, μ = {mu}")
        close("place of a disc on a slope [m]", np.asarray(end.x)[0],
              state.x[0] + 0.5 * a * (n * dt) ** 2 * (1.0 + 1.0 / n) * down, MANY)
        turns = -a * n * dt / r if spin else -2.0 * mu * G * np.cos(slope) * n * dt / r
        close("angular velocity of a disc on a slope [rad/s]", np.asarray(end.omega)[0], turns, MANY)
        close("angle of a disc on a slope [rad]", np.asarray(end.q)[0], 0.5 * turns * n * dt * (1.0 + 1.0 / n), MANY)


@pytest.mark.counts_calls                                            # boxes would be compiled anew, for seconds
@exercise("10.6", points=0.25, hint="bounds(x, q, half): detection takes the bodies as they are turned")
def test_a_box_comes_down_on_its_lowest_corner(lesson, draw):
    """The corner at r from the centre stops: j = −v_y/(1/m + r_x²/I)."""
    m, I, fall, half = draw(0.5, 2.0), draw(0.02, 0.1), draw(0.5, 2.0), np.array([0.3, 0.2])
    for turn in (draw(0.3, 1.2), draw(-1.2, -0.3)):
        corners = np.array([(a, b) for a in (-1.0, 1.0) for b in (-1.0, 1.0)]) * half
        corners = corners @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
        r = corners[np.argmin(corners[:, 1])]
        state, p = made(lesson, [(0.0, -r[1])], m, [I], [half], [(0.0, 1.0, 0.0)], 0.0, 1, 0.01)
        state = state._replace(q=np.array([turn, 0.0]), v=np.array([(0.0, -fall), (0.0, 0.0)]))
        end = lesson.contact_step_2d(lambda t, x, q, v, omega, p: (0.0 * x, 0.0 * omega), lesson.box_bounds_2d,
                                     lesson.box_contacts_2d, T_0, state, 0.005, p)
        j = fall / (1.0 / m + r[0] ** 2 / I)
        given = f"turned by {turn} rad, {fall} m/s"
        close("velocity of a box that comes down on a corner [m/s]", np.asarray(end.v)[0], (0.0, j / m - fall), MANY,
              given=given)
        close("its angular velocity [rad/s]", np.asarray(end.omega)[0], r[0] * j / I, MANY, given=given)


@exercise("10.6", points=0.25, hint="aim = closing_speeds(gap, dt): bodies may close their gap, but not more")
def test_a_falling_disc_stops_on_the_surface_and_not_in_it(lesson, draw):
    floor = np.array([0.0, 1.0, draw(-0.5, 0.5)])
    state, p, r, _ = disc_on(lesson, draw, floor, 0.5, v=(0.0, -draw(0.5, 1.5)), height=draw(0.05, 0.2), margin=0.1)
    heights = []
    for _ in range(60):
        state = run_2d(lesson, state, p, 0.01, 1)
        heights.append(np.asarray(state.x)[0, 1] + floor[2] - r)
    close("depth of a disc that fell on a floor, at its deepest [m]", max(0.0, -min(heights)), 0.0, ROUND_OFF)
    close("its height in the end [m]", heights[-1], 0.0, ROUND_OFF)
    close("its velocity in the end [m/s]", np.asarray(state.v)[0], np.zeros(2), ROUND_OFF)
    deep, p, r, _ = disc_on(lesson, draw, floor, 0.5, height=-0.1)
    end = run_2d(lesson, deep, p, 0.01, 1)
    close("velocity of a disc that begins inside the floor [m/s]", np.asarray(end.v)[0], np.zeros(2), ROUND_OFF)


@exercise("10.6", points=0.5,
          hint="rows with inv_mass 0 keep their velocity, and friction drags bodies that lie on them")
def test_a_conveyor_belt_gives_a_disc_a_third_of_its_speed(lesson, draw):
    """Friction ends when v = belt + rω; with m v = J and I ω = r J, I = ½ m r², that is v = belt/3."""
    belt, mu, dt = draw(0.5, 1.5), draw(0.3, 0.6), 0.01
    state, p, r, _ = disc_on(lesson, draw, np.array([0.0, 1.0, 0.0]), mu, floor=(belt, 0.0))
    n = int(np.ceil(belt / (3.0 * mu * G) / dt)) + 2
    end = run_2d(lesson, state, p, dt, n)
    close("velocity of a disc on a belt [m/s]", np.asarray(end.v)[0], (belt / 3.0, 0.0), MANY, given=f"belt {belt} m/s")
    close("its angular velocity [rad/s]", np.asarray(end.omega)[0], 2.0 * belt / 3.0 / r, MANY)
    close("velocity of the belt [m/s]", np.asarray(end.v)[1], (belt, 0.0), 0.0)
    lift, p, r, _ = disc_on(lesson, draw, np.array([0.0, 1.0, 0.0]), mu, floor=(0.0, belt))
    close("velocity of a disc on a floor that rises [m/s]", np.asarray(run_2d(lesson, lift, p, dt, 1).v)[0],
          (0.0, belt), MANY)


@exercise("10.6", points=0.5, hint="apply kept_impulses before the first sweep, so that sweeps add up over the steps")
def test_memory_turns_sweeps_into_steps(lesson, draw):
    """Four discs above each other, two sweeps per step: from nothing each step leaves 0.73 of the error of forces."""
    n, m, dt = 4, draw(0.5, 2.0), 0.005
    x, truth = np.stack((np.zeros(n), 1.0 * np.arange(n) + 0.5), axis=1), np.arange(n, 0.0, -1.0)
    state, p = made(lesson, x, m, np.full(n, 0.125 * m), np.full((n, 2), 0.5), [(0.0, 1.0, 0.0)], 0.5, 2, 0.01)
    # sweeps from nothing leave cos²(π/8) each: 3e-6 after 80
    close("forces in the joints over m g, after one step of 80 sweeps [-]",
          forces_in(run_2d(lesson, state, p._replace(sweeps=80), dt, 1), n, m * G * dt), truth, 1e-4)
    end = run_2d(lesson, state, p, dt, 120)
    # the column sinks together by some g dt² before all forces are right, and 1e-3 of a step's fall remains
    close("forces in the joints over m g, after 120 steps of two sweeps [-]", forces_in(end, n, m * G * dt), truth,
          1e-3)
    close("how far the top has sunk [m]", np.asarray(end.x)[n - 1, 1] - x[n - 1, 1], 0.0, 20.0 * G * dt * dt)


def remembered(old, J, way):
    """(state that remembers J at contacts moved aside by `way`, the same at their places, the same without J)."""
    aside = old.contacts._replace(p=old.contacts.p + way * np.eye(old.x.shape[1])[0])
    return old._replace(contacts=aside, J=J), old._replace(J=J), old._replace(J=0.0 * J)


def column(lesson, d):
    """(PileState, Bodies) of three balls or discs above each other, one sweep per step, after one step."""
    x = np.zeros((3, d))
    x[:, -1] = np.arange(3) + 0.5
    shape = (3,) if d == 2 else (3, 3)
    plane = np.append(np.eye(d)[-1], 0.0)
    return made(lesson, x, 1.0, np.full(shape, 0.1), np.full((3, d), 0.5), [plane], 0.5, 1, 0.01)


@exercise("10.6", points=0.25, hint="kept_impulses(contacts, state.contacts, state.J, p.margin): near is p.margin")
def test_an_impulse_in_the_plane_is_remembered_as_far_as_the_margin(lesson, draw):
    start, p = column(lesson, 2)
    remembers(lambda state: run_2d(lesson, state, p, 0.01, 1), start, p, draw)


def remembers(step, start, p, draw):
    """Whoever comes from within the margin is known, and from beyond it is new: one sweep shows the difference."""
    first = step(start)
    for part, known in ((draw(0.3, 0.9), 1), (draw(1.1, 3.0), 2)):
        moved, *same = remembered(first, draw(0.5, 2.0) * np.asarray(first.J), part * p.margin)
        close("J after a step, of contacts that have moved since the last step [N s]", step(moved).J,
              np.asarray(step(same[known - 1]).J), ROUND_OFF, given=f"moved by {part} of the margin")


@exercise("10.6", points=0.25, hint="first the loads, with the velocities at the beginning; only then the old impulses")
def test_loads_see_the_velocities_of_the_beginning(lesson, draw):
    """A single disc at rest with drag: v = 0 at the beginning, so that no drag acts, whatever impulse is remembered.

    One sweep solves a single contact, so that the impulse is that of the weight.
    """
    state, p, _, m = disc_on(lesson, draw, np.array([0.0, 1.0, 0.0]), 0.5)
    state = run_2d(lesson, state, p, 0.01, 1, T_1)
    state = state._replace(J=np.asarray(state.J) * draw(2.0, 4.0), v=0.0 * np.asarray(state.v))
    got = np.asarray(run_2d(lesson, state, p, 0.01, 1, T_1).J)[0]
    close("impulse on a disc at rest [N s]", got, (0.0, m * G * 0.01), ROUND_OFF)


def forces_in(state, n, unit):
    """Sizes of the impulses in the joints of a column, from below; body n is the ground."""
    low = np.minimum(state.contacts.a, np.where(np.asarray(state.contacts.b) == n, -1, state.contacts.b)) + 1
    forces = np.zeros(n)
    for k, J in zip(low, np.asarray(state.J)):
        forces[k] += np.linalg.norm(J) / unit
    return forces


# ---------------------------------------------------------------------------------------------- the loop in space

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


def ball_on(lesson, draw, mu, share=0.4, sweeps=40, tilt=0.5):
    """(PileState, Bodies, n, r, m) of a ball that touches a sloping plane."""
    m, r = draw(0.5, 2.0), draw(0.2, 0.5)
    n = np.append(tilt * unit_vector(draw, 2), 1.0)
    n /= np.linalg.norm(n)
    I = share * m * r * r
    return *made(lesson, [r * n], m, np.zeros((1, 3)) + I, [(r, r, r)], [np.append(n, 0.0)], mu, sweeps, 0.05), n, r, m


@exercise("10.7", points=1, hint="the same loop as in the plane, with the functions for space")
def test_a_ball_rolls_down_any_slope_or_slides(lesson, draw):
    """It rolls with 5/7 of g along the slope, and slides with g_t − μ g_n where μ < 2/7 tan θ."""
    steps, dt = draw.whole(10, 20), draw(0.002, 0.01)
    for sticks in (True, False):
        mu = draw(0.4, 0.8) if sticks else draw(0.02, 0.1)
        state, p, n, r, _ = ball_on(lesson, draw, mu)
        g_t = np.array([0.0, 0.0, -G]) + G * n[2] * n
        a = 5.0 / 7.0 * g_t if sticks else g_t * (1.0 - mu * G * n[2] / np.linalg.norm(g_t))
        end = state
        for k in range(steps):
            end = lesson.contact_step(late_weight, weighted_bounds, lesson.round_contacts, T_0 + k * dt, end, dt, p)
        T = steps * dt
        close("velocity of a ball on a slope [m/s]", np.asarray(end.v)[0], T * a, SWEPT, given=f"μ = {mu}, n = {n}")
        close("place of a ball on a slope [m]", np.asarray(end.x)[0], state.x[0] + 0.5 * a * T * T * (1.0 + dt / T),
              SWEPT)
        rate = np.cross(n, T * a) / r if sticks else np.cross(-r * n, a - g_t) * T / (0.4 * r * r)
        close("angular velocity of a ball on a slope [rad/s]", np.asarray(end.omega)[0], rate, 10.0 * SWEPT)


@exercise("10.7", points=0.25, hint="kept_impulses(contacts, state.contacts, state.J, p.margin): near is p.margin")
def test_an_impulse_in_space_is_remembered_as_far_as_the_margin(lesson, draw):
    start, p = column(lesson, 3)

    def step(state):
        return lesson.contact_step(late_weight, weighted_bounds, lesson.round_contacts, T_0, state, 0.01, p)
    remembers(step, start, p, draw)


@exercise("10.7", points=0.25, hint="closing_speeds and kept_impulses are as in the plane")
def test_balls_fall_on_each_other_and_stand(lesson, draw):
    """Three balls above each other, each a little above the next one, two sweeps per step."""
    n, m, dt, space = 3, draw(0.5, 2.0), 0.005, draw(0.01, 0.02)
    x = np.stack((np.zeros(n), np.zeros(n), (1.0 + space) * np.arange(n) + 0.5), axis=1)
    state, p = made(lesson, x, m, np.full((n, 3), 0.1 * m), np.full((n, 3), 0.5), [(0.0, 0.0, 1.0, 0.0)], 0.5, 2, 0.05)
    for k in range(120):
        state = lesson.contact_step(late_weight, weighted_bounds, lesson.round_contacts, T_0 + k * dt, state, dt, p)
    close("forces in the joints over m g [-]", forces_in(state, n, m * G * dt), np.arange(n, 0.0, -1.0), 1e-3)
    # two sweeps leave a share of each approach: the column may sink by some g dt², and no joint stays open
    close("height of the top [m]", np.asarray(state.x)[n - 1, 2], n - 0.5, 20.0 * G * dt * dt)


@exercise("10.7", points=0.5, hint="inertia in the world: world_inertia(turn, inv_inertia), of the present orientation")
def test_an_impulse_turns_a_ball_with_its_mass_inside_as_its_tensor_says(lesson, draw):
    state, p, n, r, m = ball_on(lesson, draw, np.inf, np.array([0.3, draw(0.4, 0.5), 0.55]), 120)
    q = state.q.copy()
    q[0] = quaternions(draw, 1)[0]
    state = state._replace(q=q, v=np.vstack((draw(-1.0, 1.0, 3) - 2.0 * n, np.zeros(3))),
                           omega=np.vstack((draw(-2.0, 2.0, 3), np.zeros(3))))
    dt, I = 0.01, 1.0 / p.inv_inertia[0]
    end = lesson.contact_step(late_weight, weighted_bounds, lesson.round_contacts, T_0, state, dt, p)
    v, omega = np.asarray(end.v)[0], np.asarray(end.omega)[0]
    arm = -r * n
    close("velocity of the point that touches [m/s]", v + np.cross(omega, arm), np.zeros(3), 100.0 * SWEPT)
    J = m * (v - state.v[0] - dt * np.array([0.0, 0.0, -G]))
    tensor = matrix(q[0]) @ np.diag(I) @ matrix(q[0]).T
    before = state.omega[0] + dt * euler(q[0], state.omega[0], np.zeros(3), I)
    close("change of the spin by the impulse [N m s]", tensor @ (omega - before), np.cross(arm, J), SWEPT)
    close("velocity of the plane [m/s, rad/s]", np.append(np.asarray(end.v)[1], np.asarray(end.omega)[1]), np.zeros(6),
          0.0)
    rate = np.linalg.norm(omega)
    close("orientation after the step, as a matrix", matrix(np.asarray(end.q)[0]),
          about(omega / rate, 2.0 * np.arctan(0.5 * dt * rate)) @ matrix(q[0]), ROUND_OFF)


# ---------------------------------------------------------------------------------------------- a floor that moves

def carried(lesson, draw, floor_v, spin, centre=(0.0, 0.0), mu=100.0):
    """A ball with drawn mass, size and moments on such a floor."""
    m, r, share = draw(0.5, 2.0), draw(0.1, 0.4), draw(0.3, 0.6)
    return lesson.CarriedBall(m, np.full(3, share * m * r * r), r, mu, np.array([0.0, 0.0, -G]),
                              np.append(np.array(centre, float), 0.0), np.append(np.array(floor_v, float), 0.0),
                              np.array([0.0, 0.0, float(spin)])), share


@exercise("10.8", points=0.5, hint="floor_v + floor_omega × (place − centre)")
def test_a_floor_moves_as_a_rigid_body(lesson, draw):
    """In a short time h the place turns about the centre, which moves on."""
    ball, _ = carried(lesson, draw, draw(-1.0, 1.0, 2), draw(0.5, 2.0), draw(-1.0, 1.0, 2))
    ball = ball._replace(floor_omega=draw(-1.0, 1.0, 3), floor_v=draw(-1.0, 1.0, 3))
    place, h = draw(-2.0, 2.0, 3), 1e-4
    rate = np.linalg.norm(ball.floor_omega)
    ends = [ball.centre + s * h * ball.floor_v + about(ball.floor_omega / rate, s * h * rate) @ (place - ball.centre)
            for s in (1.0, -1.0)]
    # central difference: its error is h² |ω|³ |place|/6, below 1e-7
    close("velocity of the floor [m/s]", lesson.support_velocity(place, ball), (ends[0] - ends[1]) / (2.0 * h), 1e-6,
          given=f"centre {ball.centre} m, ω = {ball.floor_omega} rad/s")


@exercise("10.8", points=0.5, hint="at the centre the velocity is floor_v; elsewhere add the part from floor_omega")
def test_the_centre_of_the_floor_has_the_velocity_of_the_floor(lesson, draw):
    ball, _ = carried(lesson, draw, draw(-1.0, 1.0, 2), draw(0.5, 2.0), draw(-1.0, 1.0, 2))
    close("velocity of the floor at its centre [m/s]", lesson.support_velocity(ball.centre, ball), ball.floor_v,
          ROUND_OFF)
    arm = draw(0.5, 1.0)
    beside = ball.centre + np.array([arm, 0.0, 0.0])
    close("and one arm along x from there [m/s]", lesson.support_velocity(beside, ball),
          ball.floor_v + np.array([0.0, arm * ball.floor_omega[2], 0.0]), ROUND_OFF)


def supported(t, x, q, v, omega, ball):
    """Weight and the force of the floor: nothing is left of both.

    A kick before T_0 and a push after T_2 show with which time a load was asked.
    """
    F = np.zeros(3)
    if t < T_0 or t > T_2:
        F[0] = 0.3 * ball.mu * ball.m * G
    return F, np.zeros(3)


def rolling_on(lesson, x, v, ball):
    """ω of a ball that rolls on its floor without spin about the normal: (ω × r) is what floor and v leave."""
    r = np.array([0.0, 0.0, -ball.radius])
    floor = ball.floor_v + np.cross(ball.floor_omega, x - ball.centre)
    return np.cross(r, floor - v) / ball.radius**2


@exercise("10.9", points=0.5,
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


@exercise("10.9", points=0.5, hint="x_new = x + dt (v + v_new)/2, and q turned by the mean of both ω")
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
    """(RollingBall, v, ω, direction of the slip, its size, share c = I/m r²), with gravity tilted along the slip."""
    m, r, share, mu = draw(0.5, 2.0), draw(0.1, 0.4), draw(0.3, 0.6), draw(0.2, 0.5)
    e = np.append(unit_vector(draw, 2), 0.0)
    v, rim = draw(2.0, 4.0), draw(-3.0, 1.0)
    gravity = tilt * e + np.array([0.0, 0.0, -G])
    ball = lesson.RollingBall(m, np.full(3, share * m * r * r), r, mu, gravity)
    return ball, v * e, np.cross([0.0, 0.0, 1.0], rim * e) / r, e, v - rim, share


@exercise("10.10", points=1, hint="|slip| over the rate at which friction, through v and ω, and gravity reduce it")
def test_the_slip_ends_when_theory_says(lesson, draw):
    """Friction takes μg from v and adds μg/c to the speed of the rim."""
    for tilt in (0.0, draw(-1.0, 1.0)):
        ball, v, omega, _, slip, share = bowled(lesson, draw, tilt)
        expected = slip / (ball.mu * G * (1.0 + 1.0 / share) - tilt)
        close("time until it rolls [s]", lesson.slip_time(v, omega, ball), expected, ROUND_OFF,
              given=f"slip {slip} m/s, μ = {ball.mu}, gravity along it {tilt} m/s²")


@exercise("10.10", points=0.5, hint="no slip: 0; gravity stronger than friction: inf; ignore u_z")
def test_what_rolls_does_not_slip_and_what_is_too_steep_never_rolls(lesson, draw):
    ball, v, _, e, _, share = bowled(lesson, draw)
    rolls = np.cross([0.0, 0.0, 1.0], v) / ball.radius
    between("time of a ball that rolls already [s]", lesson.slip_time(v, rolls, ball), 0.0, ROUND_OFF)
    ball_2, v_2, omega_2, _, slip, share_2 = bowled(lesson, draw)
    close("time until a ball rolls that also moves up or down [s]",
          lesson.slip_time(v_2 + np.array([0.0, 0.0, draw(0.5, 2.0)]), omega_2, ball_2),
          slip / (ball_2.mu * G * (1.0 + 1.0 / share_2)), ROUND_OFF)
    between("time of a ball at rest [s]", lesson.slip_time(np.zeros(3), np.zeros(3), ball), 0.0, 0.0)
    steep = ball._replace(gravity=np.array([0.0, 0.0, -G]) + draw(1.1, 1.5) * ball.mu * G * (1.0 + 1.0 / share) * e)
    endless = np.isinf(lesson.slip_time(v, 0.5 * rolls, steep))
    close("whether it slips forever on a steep floor [-]", float(endless), 1.0, 0.0)


@exercise("10.11", points=0.5, hint="one part until slip_time, but at most dt; another part for the rest of dt")
def test_one_step_over_the_end_of_slipping_is_exact(lesson, draw):
    ball, v, omega, e, slip, share = bowled(lesson, draw)
    ends = slip / (ball.mu * G * (1.0 + 1.0 / share))
    x = np.append(draw(-1.0, 1.0, 2), ball.radius)
    for T in (draw(0.2, 0.8) * ends, draw(1.5, 3.0) * ends):
        s = min(T, ends)
        end_v = v - ball.mu * G * s * e
        got = lesson.exact_rolling_step(supported, T_0, x, np.eye(4)[0], v, omega, T, ball)
        close("place after one step [m]", got[0], x + s * v - 0.5 * ball.mu * G * s * s * e + (T - s) * end_v, MANY,
              given=f"slips for {ends} s, dt = {T} s")
        close("velocity after one step [m/s]", got[2], end_v, MANY)
        rim = np.cross(np.asarray(got[3]), [0.0, 0.0, ball.radius])
        close("speed of the rim after one step [m/s]", rim @ e, (v - e * slip) @ e + ball.mu * G / share * s, MANY)


@exercise("10.11", points=0.25, hint="the second part begins with the end of the first, and lasts dt − first")
def test_a_long_step_is_as_good_as_many(lesson, draw):
    """Also the orientation: along a line all rotations are about one axis."""
    ball, v, omega, e, slip, share = bowled(lesson, draw)
    ends = slip / (ball.mu * G * (1.0 + 1.0 / share))
    T, n = draw(1.5, 3.0) * ends, draw.whole(3, 9)
    start = np.zeros(3), np.eye(4)[0], v, omega
    whole = lesson.exact_rolling_step(supported, T_0, *start, T, ball)
    close("velocity when it rolls [m/s]", whole[2], v - slip * share / (1.0 + share) * e, MANY, given=f"dt = {T} s")
    parts = start
    for k in range(n):
        parts = lesson.exact_rolling_step(supported, T_0 + k * T / n, *parts, T / n, ball)
    for name, one, many in zip(("place [m]", "orientation [-]", "velocity [m/s]", "angular velocity [rad/s]"), whole,
                               parts):
        close(f"{name} after one long step", one, many, MANY, given=f"{n} parts")


@exercise("10.11", points=0.25, hint="load(t, …) for the first part, load(t + first, …) for the second one")
def test_the_second_part_asks_the_load_at_its_own_time(lesson, draw):
    """A push sets in right after the beginning, at T_2: only the second part knows it, so v differs by push · rest/m.

    rolling_step lets the floor hold gravity only, so that a push is not shared with the rotation in its own step.
    """
    ball, v, omega, _, slip, share = bowled(lesson, draw)
    ends = slip / (ball.mu * G * (1.0 + 1.0 / share))
    T, start = draw(1.5, 3.0) * ends, np.array([0.0, 0.0, ball.radius])
    without = lesson.exact_rolling_step(supported, T_0, start, np.eye(4)[0], v, omega, T, ball)
    pushed = lesson.exact_rolling_step(supported, T_2, start, np.eye(4)[0], v, omega, T, ball)
    close("what the push adds to the velocity [m/s]", np.asarray(pushed[2]) - np.asarray(without[2]),
          (0.3 * ball.mu * G * (T - ends), 0.0, 0.0), MANY, given=f"slips for {ends} s, dt = {T} s")


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


@exercise("10.12", points=0.5, hint="v⁺ + ω⁺ × r = 0: the corner stops")
def test_the_corner_stops_and_one_impulse_there_explains_it(lesson, draw):
    m, I, r = draw(0.5, 2.0), draw(0.5, 2.0), draw(0.3, 1.0, 2) * np.array([1.0, -1.0])
    v, omega = draw(-2.0, 2.0, 2), draw(-2.0, 2.0)
    v_new, omega_new = lesson.corner_impact(v, omega, r, 1.0 / m, 1.0 / I)
    v_new = np.asarray(v_new)
    close("velocity of the corner [m/s]", v_new + omega_new * np.array([-r[1], r[0]]), np.zeros(2), ROUND_OFF)
    J = m * (v_new - v)
    close("change of spin that the impulse at the corner explains [N m s]", I * (omega_new - omega),
          r[0] * J[1] - r[1] * J[0], ROUND_OFF, given=f"r = {r} m")


@exercise("10.12", points=0.5,
          hint="a body that already turns about the corner continues, and a body at rest stays at rest")
def test_what_turns_about_the_corner_goes_on(lesson, draw):
    m, I, r, rate = draw(0.5, 2.0), draw(0.5, 2.0), draw(0.3, 1.0, 2), draw(0.5, 2.0)
    v, omega = lesson.corner_impact(rate * np.array([r[1], -r[0]]), rate, r, 1.0 / m, 1.0 / I)
    close("angular velocity [rad/s]", omega, rate, ROUND_OFF)
    close("velocity of the centre [m/s]", v, rate * np.array([r[1], -r[0]]), ROUND_OFF)
    slides, _ = lesson.corner_impact(np.array([draw(0.5, 1.0), 0.0]), 0.0, np.array([0.5, 0.0]), 1.0 / m, 1.0 / I)
    close("velocity of what slides into an edge at the height of its centre [m/s]", slides, np.zeros(2), ROUND_OFF)


# ---------------------------------------------------------------------------------------------- invariants

@exercise("10.13", points=0.5, hint="½ m v² + ½ ω · I ω − m g · x, with the tensor of the body in the world")
def test_energy_is_that_of_motion_rotation_and_height(lesson, draw):
    _, x, q, v, omega, _, p = moving(draw, lesson)
    p = p._replace(gravity=draw(-5.0, 5.0, 3))
    expected = 0.0
    for i in range(2):
        tensor, m = matrix(q[i]) @ np.diag(1.0 / p.inv_inertia[i]) @ matrix(q[i]).T, 1.0 / p.inv_mass[i]
        expected += 0.5 * m * v[i] @ v[i] + 0.5 * omega[i] @ tensor @ omega[i] - m * p.gravity @ x[i]
    close("energy [J]", lesson.mechanical_energy(x, q, v, omega, p), expected, MANY)
    stiff = p.inv_inertia.copy()
    stiff[1] = 0.0
    tensor = matrix(q[1]) @ np.diag(1.0 / p.inv_inertia[1]) @ matrix(q[1]).T
    close("energy where one body has a mass, and inv_inertia 0 [J]",
          lesson.mechanical_energy(x, q, v, omega, p._replace(inv_inertia=stiff)),
          expected - 0.5 * omega[1] @ tensor @ omega[1], MANY)
    axle = p.inv_mass * [1.0, 0.0, 1.0]
    m = 1.0 / p.inv_mass[1]
    expected -= 0.5 * m * v[1] @ v[1] + 0.5 * omega[1] @ tensor @ omega[1] - m * p.gravity @ x[1]
    close("energy where one body is on an axle, with inv_mass 0 [J]",
          lesson.mechanical_energy(x, q, v, omega, p._replace(inv_mass=axle)), expected, MANY)


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
    _, x, q, v, omega, _, p = moving(draw, lesson)
    P, L = np.zeros(3), np.zeros(3)
    for i in range(2):
        tensor, m = matrix(q[i]) @ np.diag(1.0 / p.inv_inertia[i]) @ matrix(q[i]).T, 1.0 / p.inv_mass[i]
        P, L = P + m * v[i], L + m * np.cross(x[i], v[i]) + tensor @ omega[i]
    got = lesson.momenta(x, q, v, omega, p)
    close("momentum [kg m/s]", got[0], P, MANY)
    close("angular momentum about the origin [kg m²/s]", got[1], L, MANY)
    stiff = p.inv_inertia.copy()
    stiff[1] = 0.0
    tensor = matrix(q[1]) @ np.diag(1.0 / p.inv_inertia[1]) @ matrix(q[1]).T
    close("angular momentum where one body has a mass, and inv_inertia 0 [kg m²/s]",
          lesson.momenta(x, q, v, omega, p._replace(inv_inertia=stiff))[1], L - tensor @ omega[1], MANY)
    own, axle = np.cross(x[1], v[1]) / p.inv_mass[1] + tensor @ omega[1], p.inv_mass * [1.0, 0.0, 1.0]
    close("angular momentum where one body is on an axle, with inv_mass 0 [kg m²/s]",
          lesson.momenta(x, q, v, omega, p._replace(inv_mass=axle))[1], L - own, MANY)


@exercise("10.14", points=0.5, hint="about another point, L differs by the cross product of the displacement and P")
def test_angular_momentum_belongs_to_a_point(lesson, draw):
    _, x, q, v, omega, _, p = moving(draw, lesson)
    way = draw(-2.0, 2.0, 3)
    P, L = map(np.asarray, lesson.momenta(x, q, v, omega, p))
    P_there, L_there = map(np.asarray, lesson.momenta(x + way, q, v, omega, p))
    close("momentum [kg m/s]", P, v[0] / p.inv_mass[0] + v[1] / p.inv_mass[1], MANY)
    close("momentum after all bodies are moved [kg m/s]", P_there, P, MANY)
    close("angular momentum after all bodies are moved [kg m²/s]", L_there, L + np.cross(way, P), MANY)


@exercise("10.15", points=0.5, hint="the largest difference of (E − W) at a later time and (E − W) at an earlier time")
def test_the_largest_gain_is_found_among_all_pairs_of_times(lesson, draw):
    for _ in range(5):
        n = draw.whole(5, 12)
        energies, work = draw(-2.0, 2.0, n), draw(-2.0, 2.0, n)
        expected = max((energies - work)[k] - (energies - work)[j] for k in range(n) for j in range(k + 1))
        close("largest gain [J]", lesson.gain_without_source(energies, work), expected, ROUND_OFF,
              given=f"E − W = {energies - work} J")


@exercise("10.15", points=0.25, hint="energies, work = checked_histories(energies, work) comes first")
def test_histories_need_not_be_arrays_and_must_be_alike(lesson, draw):
    energies, work = draw(-2.0, 2.0, 6), draw(-2.0, 2.0, 6)
    expected = max((energies - work)[k] - (energies - work)[j] for k in range(6) for j in range(k + 1))
    close("largest gain of numbers that are in no array [J]",
          lesson.gain_without_source(tuple(energies.tolist()), tuple(work.tolist())), expected, ROUND_OFF)
    close("largest gain of whole numbers [J]", lesson.gain_without_source((3, 1, 2), (0, 0, 0)), 1.0, 0.0)
    raises("work of fewer times", BadInput, lesson.gain_without_source, energies, work[:5])
    raises("an energy that is no number", BadInput, lesson.gain_without_source, np.append(energies[:5], np.nan), work)
    raises("an energy that is infinite", BadInput, lesson.gain_without_source, np.append(energies[:5], np.inf), work)


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


def runs_of(full_times, minimal_times, full_end, minimal_end):
    """(full, minimal, clock): runs that take these times on a clock of their own."""
    now, calls = [100.0], [0, 0]

    def full():
        now[0] += full_times[calls[0] % len(full_times)]
        calls[0] += 1
        return full_end

    def minimal():
        now[0] += minimal_times[calls[1] % len(minimal_times)]
        calls[1] += 1
        return minimal_end
    return full, minimal, lambda: now[0]


@pytest.mark.counts_calls
@exercise("10.16", points=0.5, hint="clock() before and after each run; the median of the ratios of neighbouring runs")
def test_the_ratio_is_the_median_of_neighbours(lesson, draw):
    n = 5
    quick, ratios = draw(0.5, 2.0, n), draw(1.5, 9.0, n)
    same = draw(-1.0, 1.0, (4, 2))
    difference, ratio = compared(lesson, quick * ratios, quick, same, same.copy(), n)
    close("ratio of times [-]", ratio, np.median(ratios), MANY,
          given=f"times of the full loop {quick * ratios} s, of the other {quick} s")
    close("difference of what is the same [-]", difference, 0.0, 0.0)


def compared(lesson, full_times, minimal_times, full_end, minimal_end, runs):
    full, minimal, clock = runs_of(full_times, minimal_times, full_end, minimal_end)
    order = []
    answer = lesson.compare(lambda: order.append(1.0) or full(), lambda: order.append(0.0) or minimal(), runs, clock)
    close("runs in their order: 1 full, 0 minimal [-]", order, np.tile([1.0, 0.0], runs), 0.0)
    return answer


@pytest.mark.counts_calls
@exercise("10.16", points=0.5, hint="the largest absolute difference in all entries and all runs")
def test_the_difference_is_the_largest_of_all(lesson, draw):
    end, shape = draw(-1.0, 1.0, (5, 3)), (draw.whole(0, 4), draw.whole(0, 2))
    for sign in (1.0, -1.0):
        other, off = end.copy(), draw(0.1, 0.5)
        other[shape] += sign * off
        other[0, 0] += 0.01 * (shape != (0, 0))
        difference, ratio = compared(lesson, [3.0], [1.5], end, other, 3)
        close("largest difference [-]", difference, off, ROUND_OFF)
        close("ratio of times [-]", ratio, 2.0, ROUND_OFF)
    sizes = draw(0.1, 0.5, 4)
    ends, clock = iter(np.concatenate(([1.0], sizes))), itertools.count()
    difference, _ = lesson.compare(lambda: end + next(ends), lambda: end, 5, lambda: float(next(clock)))
    close("largest difference of runs that differ, the first one most [-]", difference, 1.0, ROUND_OFF)
