"""Forces of joints and of contacts, which are given: against Newton's laws, with the order of the method."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from validate.reference import mechanisms
from validate.subject import modules

simulator = modules.bind("simulator")
G = 9.81                     # [m/s²]
FLOOR = [(0.0, 1.0, 0.0)]
BOXES = simulator.box_bounds_2d, simulator.box_contacts_2d
SPEEDS = ["plain", pytest.param("compiled", marks=pytest.mark.long)]


def bound(speed):
    if speed == "compiled" and not modules.can_compile():
        pytest.skip("numba is not installed")
    return modules.bind("simulator", compiled=speed == "compiled")


def joined(mechanism, gravity):
    """((x, q, v, omega), JointedBodies) of a Mechanism."""
    n, d = mechanism.x.shape
    make = simulator.make_bodies_2d if d == 2 else simulator.make_bodies
    state, p = make(mechanism.x, mechanism.q, mechanism.m, mechanism.inertia, np.full((n, d), 0.1),
                    np.zeros((0, d + 1)), gravity, 0.0, 1, 0.01)
    p = simulator.make_joints(state, p, mechanism.a, mechanism.b, mechanism.places, 0.0)
    return (state.x, state.q, mechanism.v, mechanism.omega), p


# ---------------------------------------------------------------------------------------------- joints

L, M, I = 0.7, 2.0, 0.05     # of a pendulum: from its hinge to its centre [m], mass [kg], about its centre [kg m²]


def pendulum_truth(t, start):
    """Force (2,) [N] of the hinge on a pendulum that is released at `start` from the lowest position.

    Along the rod m (g cos θ + l ω²); across it what gravity does less m l θ̈.
    """
    rate = M * G * L / (I + M * L * L)
    theta, omega = solve_ivp(lambda _, y: (y[1], -rate * np.sin(y[0])), (0.0, t), (start, 0.0), "DOP853", rtol=1e-12,
                             atol=1e-13).y[:, -1]
    inwards, along = np.array([-np.sin(theta), np.cos(theta)]), np.array([np.cos(theta), np.sin(theta)])
    return M * (G * np.cos(theta) + L * omega**2) * inwards + M * (G - L * rate) * np.sin(theta) * along


@pytest.mark.parametrize("speed", SPEEDS)
@pytest.mark.parametrize(("step", "orders"), [("joint_step_2d", (1.9, 2.1)), ("composed_joint_step_2d", (3.7, 4.3))])
def test_the_tension_of_a_pendulum_has_the_order_of_the_step(speed, step, orders):
    lesson, start, T = bound(speed), 1.2, 0.5
    place = L * np.array([np.sin(start), -np.cos(start)])
    now, p = joined(mechanisms.mechanism_2d([place], [start], [M], [I], [(0, -1, (0.0, 0.0))]), (0.0, -G))
    errors = []
    for steps in (10, 20):
        end = lesson.advance_free(getattr(lesson, step), lesson.weight, 0.0, *now, T / steps, steps, p)
        F = lesson.joint_forces_2d(lesson.weight, T, *end, p)
        errors.append(np.max(np.abs(F[0] - pendulum_truth(T, start))))
    assert errors[1] < 0.1 and orders[0] < np.log2(errors[0] / errors[1]) < orders[1], errors


def test_hinges_of_a_chain_at_rest_carry_what_hangs_below():
    n, m = 4, np.array([0.5, 1.0, 0.2, 2.0])
    heights = -0.3 * (np.arange(n) + 0.5)
    made = mechanisms.mechanism_2d(np.stack((0.0 * heights, heights), axis=1), np.full(n, -0.5 * np.pi), m, 0.01 * m,
                                   [(k, k - 1, (0.0, -0.3 * k)) for k in range(n)])
    now, p = joined(made, (0.0, -G))
    F = simulator.joint_forces_2d(simulator.weight, 0.0, *now, p)
    assert np.allclose(F[:, 1], G * np.cumsum(m[::-1])[::-1], atol=1e-11) and np.allclose(F[:, 0], 0.0, atol=1e-11)


@pytest.mark.parametrize("speed", SPEEDS)
def test_a_conical_pendulum_pulls_with_its_weight_and_the_force_towards_its_axis(speed):
    """A body with the moments (I, I, J) about its centre, J about the rod, precesses at the tilt θ without spin where
    (I + m l² − J) w² cos θ = m g l.  The hinge gives m g upwards and m w² l sin θ inwards.
    """
    lesson, tilt, J = bound(speed), 0.6, 0.01
    w = np.sqrt(M * G * L / ((I + M * L * L - J) * np.cos(tilt)))
    centre, turned = L * np.array([np.sin(tilt), 0.0, -np.cos(tilt)]), np.array([np.cos(0.5 * tilt), 0.0,
                                                                                -np.sin(0.5 * tilt), 0.0])
    made = mechanisms.mechanism_3d([centre], [M], [(I, I, J)], [(0, -1, (0.0, 0.0, 0.0))])
    made.q[0], made.omega[0] = turned, (0.0, 0.0, w)
    made.v[0] = np.cross(made.omega[0], centre)
    now, p = joined(made, (0.0, 0.0, -G))
    F = lesson.joint_forces(lesson.weight, 0.0, *now, p)[0]
    assert np.allclose(F, (-M * w * w * L * np.sin(tilt), 0.0, M * G), atol=1e-10)
    T, errors = 1.0, []
    for steps in (20, 40):
        end = lesson.advance_free(lesson.joint_step, lesson.weight, 0.0, *now, T / steps, steps, p)
        F, x = lesson.joint_forces(lesson.weight, T, *end, p)[0], np.array([np.cos(w * T), np.sin(w * T), 0.0])
        errors.append(np.max(np.abs(F - (M * G * np.eye(3)[2] - M * w * w * L * np.sin(tilt) * x))))
    assert errors[1] < 0.1 and 1.9 < np.log2(errors[0] / errors[1]) < 2.1, errors


def test_a_load_and_its_time_reach_the_joint():
    """A rod in line with a force that depends on time, at rest: the hinge gives the contrary at that time."""
    now, p = joined(mechanisms.mechanism_2d([(0.5, 0.0)], [0.0], [1.0], [0.1], [(0, -1, (0.0, 0.0))]), (0.0, 0.0))
    load = lambda t, x, q, v, omega, p: (np.array([(np.cos(t), 0.0), (0.0, 0.0)]), np.zeros(2))
    for t in (0.0, 0.7, 2.0):
        assert np.allclose(simulator.joint_forces_2d(load, t, *now, p), [(-np.cos(t), 0.0)], atol=1e-13)


# ---------------------------------------------------------------------------------------------- impacts and joints

@pytest.mark.parametrize("s", [0.4, 2.0 / 3.0, 0.9])
def test_a_rod_that_is_struck_at_its_centre_of_percussion_does_not_pull_its_hinge(s):
    """A rod of 1 m and 1 kg hangs at rest, and the corner of a box strikes it at s from its hinge with the impulse J.

    It turns with J s/(1/3), so that its centre gets J · 3/2 s, of which the hinge must have given J (3/2 s − 1).
    """
    half, dt = np.array([(0.02, 0.5), (0.05, 0.05)]), 1e-4
    x = np.array([(0.0, -0.5), (-0.02 - np.hypot(0.05, 0.05) - 2.5 * dt, -s)])
    state, p = simulator.make_bodies_2d(x, (0.0, 0.25 * np.pi), 1.0, (1.0 / 12.0, 0.1), half, [(0.0, 1.0, 10.0)],
                                        (0.0, 0.0), 0.0, 30, 0.01)
    p = simulator.make_joints(state, p, [0], [2], [(0.0, 0.0)], 0.5)
    state, J, hinge = state._replace(v=np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 0.0)])), 0.0, np.zeros(2)
    for k in range(6):
        after = simulator.joint_contact_step_2d(simulator.weight, *BOXES, k * dt, state, dt, p)
        J += np.sum(np.abs(after.J[:, 0]))
        hinge += simulator.joint_impulses_2d(simulator.weight, k * dt, state, after, dt, p)[0]
        state = after
    # the turn in a step, ω dt, is what is neglected
    assert abs(J - 1.5 / (1.0 + 3.0 * s * s)) < 1e-3 and abs(hinge[0] - J * (1.5 * s - 1.0)) < 1e-3


def test_without_impacts_impulses_over_the_step_are_forces_of_first_order():
    place = L * np.array([np.sin(1.2), -np.cos(1.2)])
    state, p = simulator.make_bodies_2d([place], [1.2], M, I, [(0.1, 0.1)], [(0.0, 1.0, 10.0)], (0.0, -G), 0.0, 1, 0.01)
    p, errors = simulator.make_joints(state, p, [0], [1], [(0.0, 0.0)], 0.0), []
    for steps in (100, 200):
        now, dt = state, 0.5 / steps
        for k in range(steps):
            before, now = now, simulator.joint_contact_step_2d(simulator.weight, *BOXES, k * dt, now, dt, p)
        F = simulator.joint_impulses_2d(simulator.weight, 0.5 - dt, before, now, dt, p)[0] / dt
        errors.append(np.max(np.abs(F - pendulum_truth(0.5, 1.2))))
    assert errors[1] < 1.0 and 0.7 < np.log2(errors[0] / errors[1]) < 1.3, errors


# ---------------------------------------------------------------------------------------------- no joint

@pytest.mark.parametrize("speed", SPEEDS)
def test_bodies_without_a_joint_fly_freely_in_the_plane_and_in_space(speed):
    lesson = bound(speed)
    state, p = simulator.make_bodies_2d([(0.0, 1.0)], [0.0], 1.0, 0.1, [(0.1, 0.1)], [], (0.0, -G), 0.0, 1, 0.01)
    for places in ([], np.zeros((0, 2))):
        rows = simulator.make_joints(state, p, [], [], places, 1.0)
        for step in (lesson.joint_step_2d, lesson.composed_joint_step_2d):
            x, *_ = lesson.advance_free(step, lesson.weight, 0.0, *state[:4], 0.02, 10, rows)
            assert np.allclose(x, [(0.0, 1.0 - 0.5 * G * 0.04)], atol=1e-13)
        assert lesson.joint_forces_2d(lesson.weight, 0.0, *state[:4], rows).shape == (0, 2)
    state, p = simulator.make_bodies([(0.0, 0.0, 1.0)], [(1.0, 0.0, 0.0, 0.0)], 1.0, [(0.1, 0.2, 0.25)],
                                     [(0.1, 0.1, 0.1)], [], (0.0, 0.0, -G), 0.0, 1, 0.01)
    rows = simulator.make_joints(state, p, [], [], [], 1.0)
    x, *_ = lesson.advance_free(lesson.joint_step, lesson.weight, 0.0, *state[:4], 0.02, 10, rows)
    assert np.allclose(x, [(0.0, 0.0, 1.0 - 0.5 * G * 0.04)], atol=1e-13)
    assert lesson.joint_forces(lesson.weight, 0.0, *state[:4], rows).shape == (0, 3)


@pytest.mark.parametrize("speed", SPEEDS)
def test_two_discs_without_a_joint_bounce_with_their_restitution(speed):
    lesson = bound(speed)
    state, p = simulator.make_bodies_2d([(0.0, 0.0), (0.25, 0.0)], np.zeros(2), (1.0, 3.0), 0.1, np.full((2, 2), 0.1),
                                        [], (0.0, 0.0), 0.0, 4, 1e-9)
    p = simulator.make_joints(state, p, [], [], [], 0.6)
    state = state._replace(v=np.array([(2.0, 0.0), (0.0, 0.0)]))
    end = lesson.advance_contact(lesson.joint_contact_step_2d, lesson.weight, lesson.disc_bounds, lesson.round_contacts,
                                 0.0, state, 0.001, 60, p)
    assert np.allclose(end.v, [(0.5 - 0.75 * 1.2, 0.0), (0.5 + 0.25 * 1.2, 0.0)], atol=1e-12)


# ---------------------------------------------------------------------------------------------- sizes and turns

@pytest.mark.parametrize("size", [1e-9, 1e-3, 1e6])
def test_a_pendulum_of_any_size_swings_alike(size):
    ends = []
    for k in (1.0, size):
        made = mechanisms.mechanism_2d([(0.3 * k, 0.0)], [0.0], [1.0], [0.05 * k * k], [(0, -1, (0.0, 0.0))])
        now, p = joined(made, (0.0, -G * k))
        ends.append(simulator.advance_free(simulator.joint_step_2d, simulator.weight, 0.0, *now, 0.01, 50, p)[1])
    assert np.allclose(*ends, atol=1e-11)


@pytest.mark.parametrize("turns", [160, 10_000])
def test_a_crank_that_has_turned_often_goes_on(turns):
    """It begins so many turns later; its angle is known to that much less."""
    ends, later = [], 2.0 * np.pi * turns
    for begun in (0.0, later):
        made = mechanisms.mechanism_2d([(0.3, 0.0)], [begun], [1.0], [0.05], [(0, -1, (0.0, 0.0))])
        made.omega[0], made.v[0] = 10.0, (0.0, 3.0)
        now, p = joined(made, (0.0, -G))
        ends.append(simulator.advance_free(simulator.joint_step_2d, simulator.weight, 0.0, *now, 0.01, 200, p)[1][0])
    assert abs(ends[1] - later - ends[0]) < 1e-13 * later * 200


# ---------------------------------------------------------------------------------------------- contacts

@pytest.mark.parametrize("mu", [0.0, 0.5])
def test_the_feet_of_a_box_at_rest_bear_half_of_its_weight_each(mu):
    """Friction may press the feet together or apart by as much as it likes: only its sum is determined."""
    state, p = simulator.make_bodies_2d([(0.0, 0.2)], [0.0], M, 0.1, [(0.3, 0.2)], FLOOR, (0.0, -G), mu, 40, 0.01)
    state = simulator.advance_contact(simulator.contact_step_2d, simulator.weight, *BOXES, 0.0, state, 0.01, 20, p)
    N, T = simulator.normal_and_friction(state, 0.01)
    assert np.allclose(N, 0.5 * M * G, rtol=1e-6) and np.allclose(np.sum(T, axis=0), 0.0, atol=1e-6)
    assert np.all(np.abs(T[:, 0]) <= mu * N * (1.0 + 1e-12))
    for body, sign in ((0, 1.0), (1, -1.0)):
        assert np.allclose(simulator.contact_force(state, body, 0.01), (0.0, sign * M * G), rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(("mu", "d"), [(0.2, 2), (0.9, 2), (0.2, 3)])
def test_a_body_on_a_slope_is_pushed_by_m_g_cos_and_held_by_friction(mu, d):
    """It slides where μ < tan: friction μ N.  Otherwise it rests, and friction is m g sin; a ball that cannot turn."""
    slope = 0.5
    down = G * np.array([np.sin(slope), -np.cos(slope)])
    if d == 2:
        state, p = simulator.make_bodies_2d([(0.0, 0.2)], [0.0], M, np.inf, [(0.3, 0.2)], FLOOR, down, mu, 40, 0.01)
        step, shapes = simulator.contact_step_2d, BOXES
    else:
        state, p = simulator.make_bodies([(0.0, 0.0, 0.2)], [(1.0, 0.0, 0.0, 0.0)], M, [(np.inf,) * 3],
                                         [(0.2, 0.2, 0.2)], [(0.0, 0.0, 1.0, 0.0)], (down[0], 0.0, down[1]), mu, 60,
                                         0.01)
        step, shapes = simulator.contact_step, (simulator.ball_bounds, simulator.round_contacts)
    state = simulator.advance_contact(step, simulator.weight, *shapes, 0.0, state, 0.01, 20, p)
    N, T = simulator.normal_and_friction(state, 0.01)
    normal, rubs = M * G * np.cos(slope), M * G * min(mu * np.cos(slope), np.sin(slope))
    assert np.isclose(np.sum(N), normal, rtol=1e-6) and np.isclose(np.sum(T, axis=0)[0], -rubs, rtol=1e-6)
    F = simulator.contact_force(state, 0, 0.01)
    assert np.isclose(F[0], -rubs, rtol=1e-6) and np.isclose(F[-1], normal, rtol=1e-6)


def test_the_force_of_a_contact_belongs_to_the_beginning_of_its_step():
    """A box that rests under a force which depends on time: the state at t has the force at t − dt, exactly."""
    push, dt = (lambda t: 5.0 * np.sin(3.0 * t)), 0.02
    load = lambda t, x, q, v, omega, p: (np.array([(0.0, -M * G - push(t)), (0.0, 0.0)]), np.zeros(2))
    state, p = simulator.make_bodies_2d([(0.0, 0.2)], [0.0], M, 0.1, [(0.3, 0.2)], FLOOR, (0.0, -G), 0.0, 60, 0.01)
    for k in range(20):
        state = simulator.contact_step_2d(load, *BOXES, k * dt, state, dt, p)
        assert np.isclose(simulator.contact_force(state, 0, dt)[1], M * G + push(k * dt), rtol=1e-7)


def test_the_force_under_a_falling_rod_has_the_first_order_of_the_loop():
    """A box on one corner of a smooth floor, its diagonal R at φ: N (1/m + R² cos² φ/I) = g − R φ̇² sin φ."""
    half = np.array([0.05, 0.4])
    R, start, T = np.hypot(*half), 1.1, 0.15
    height = lambda y: (G - R * y[1] ** 2 * np.sin(y[0])) / (1.0 / M + (R * np.cos(y[0])) ** 2 / I)
    y = solve_ivp(lambda _, y: (y[1], -height(y) * R * np.cos(y[0]) / I), (0.0, T), (start, 0.0), "DOP853", rtol=1e-12,
                  atol=1e-13).y[:, -1]
    lean, errors = np.pi - start - np.arctan2(half[1], half[0]), []      # on its left corner, and it falls to the left
    for steps in (120, 240):
        dt = T / steps
        state, p = simulator.make_bodies_2d([(0.0, R * np.sin(start))], [lean], M, I, [half], FLOOR, (0.0, -G), 0.0, 20,
                                            0.01)
        for k in range(steps + 1):                           # one more: its force belongs to T
            state = simulator.contact_step_2d(simulator.weight, *BOXES, k * dt, state, dt, p)
        errors.append(abs(simulator.contact_force(state, 0, dt)[1] - height(y)))
    assert errors[1] < 0.05 * height(y) and 0.8 < np.log2(errors[0] / errors[1]) < 1.2, (errors, height(y))
