"""Joints, which are given: they stay closed, keep what they must, and follow pendulums, chains and tops."""

from functools import partial

import numpy as np
import pytest
from scipy.optimize import brentq

from solutions.checks import BadInput, Diverged
from solutions.given import joints
from solutions.given import simulator as given
from solutions.rotation import exponential
from validate.reference.rotation import HeavyTop
from validate.reference.simulator import cradle_motion, rods_error, rods_motion, rods_slope
from validate.subject import modules

simulator = modules.bind("simulator")
G = 9.81                     # [m/s²]
NOWHERE = np.zeros((0, 3))


def chain(n, l=0.3, m=0.5, angle=0.0):
    """(PileState, JointedBodies) of n rods in a straight line from the origin; body 0 is the wall."""
    along = np.array([np.cos(angle), np.sin(angle)])
    x = np.vstack((np.zeros(2), l * (np.arange(n) + 0.5)[:, None] * along))
    inertia = np.append(np.inf, np.full(n, m * l * l / 12.0))
    state, p = simulator.make_bodies_2d(x, np.append(0.0, np.full(n, angle)), np.append(np.inf, np.full(n, m)), inertia,
                                        np.full((n + 1, 2), 0.1), NOWHERE, (0.0, -G), 0.0, 1, 0.01)
    k = np.arange(1, n + 1)
    return state, simulator.make_joints(state, p, k, k - 1, l * np.arange(n)[:, None] * along, 0.0)


def run(step, state, p, T, steps):
    return simulator.advance_free(step, simulator.weight, 0.0, *state[:4], T / steps, steps, p)


def swarm_2d(rng, n=5):
    """(x, q, v, omega, JointedBodies) of a tree of bodies in any place: 1, 2 and 3 hang on 0, and 4 on 2."""
    state, p = simulator.make_bodies_2d(rng.normal(size=(n, 2)), rng.normal(size=n), rng.uniform(0.5, 2.0, n),
                                        rng.uniform(0.5, 2.0, n), np.full((n, 2), 0.1), NOWHERE, (0.0, 0.0), 0.0, 1,
                                        0.01)
    p = simulator.make_joints(state, p, [1, 0, 3, 2], [0, 2, 0, 4], rng.normal(size=(4, 2)), 0.0)
    return state.x, state.q, rng.normal(size=(n, 2)), rng.normal(size=n), p


def swarm(rng, n=5):
    """The same in space."""
    q = rng.normal(size=(n, 4))
    state, p = simulator.make_bodies(rng.normal(size=(n, 3)), q / np.linalg.norm(q, axis=1)[:, None],
                                     rng.uniform(0.5, 2.0, n), rng.uniform(1.0, 1.9, (n, 3)), np.full((n, 3), 0.1),
                                     np.zeros((0, 4)), np.zeros(3), 0.0, 1, 0.01)
    p = simulator.make_joints(state, p, [1, 0, 3, 2], [0, 2, 0, 4], rng.normal(size=(4, 3)), 0.0)
    return state.x, state.q, rng.normal(size=(n, 3)), rng.normal(size=(n, 3)), p


def open_by(x, q, p):
    arms = joints.joint_arms_2d(q, p.joints) if q.ndim == 1 else joints.joint_arms(q, p.joints)
    return np.max(np.abs(joints.joint_gaps(x, arms, p.joints)))


@pytest.mark.parametrize(("steps", "T"), [(200, 1.0), (37, 0.2)])
def test_one_rod_is_a_pendulum(steps, T):
    state, p = chain(1)
    angle = rods_motion(1, 0.3, 0.5, 0.5 * 0.09 / 12.0, G, T).sol(T)[0]
    limit = 1.01 * rods_error(1, 0.3, 0.5, 0.5 * 0.09 / 12.0, G, T, steps) / 0.3 + 1e-11
    assert abs(run(simulator.joint_step_2d, state, p, T, steps)[1][1] - (angle - 0.5 * np.pi)) < limit


def test_a_chain_makes_the_same_error_as_the_discrete_lagrangian_in_angles_does():
    n, l, m, T, steps = 4, 0.3, 0.5, 0.8, 200
    state, p = chain(n, l, m)
    x, q, *_ = run(simulator.joint_step_2d, state, p, T, steps)
    ends = x[1:] + 0.5 * l * np.stack((np.cos(q[1:]), np.sin(q[1:])), axis=1)
    theta = rods_motion(n, l, m, m * l * l / 12.0, G, T).y[:n, -1]
    true = l * np.cumsum(np.stack((np.sin(theta), -np.cos(theta)), axis=1), axis=0)
    assert np.isclose(np.linalg.norm(ends - true), rods_error(n, l, m, m * l * l / 12.0, G, T, steps), rtol=1e-6)


def test_angles_obey_lagranges_equations():
    rng, slope = np.random.default_rng(17), rods_slope(5, 0.3, 0.5, 0.004, G)
    for _ in range(20):
        q, omega = rng.uniform(-np.pi, np.pi, 5), rng.normal(size=5)
        there = slope(0.0, np.append(q + 0.5 * np.pi, omega))[5:]             # angles from straight down
        found = simulator.rods_acceleration(0.0, q, omega, simulator.RodsInAngles(0.5, 0.3, 0.004, G))
        assert np.allclose(found, there, rtol=1e-11, atol=1e-11 * np.abs(there).max())


def test_five_substeps_make_it_fourth_order():
    state, p = chain(3)
    fine = run(simulator.composed_joint_step_2d, state, p, 0.3, 80)[0]
    errors = [np.max(np.abs(run(simulator.composed_joint_step_2d, state, p, 0.3, n)[0] - fine)) for n in (10, 20)]
    assert 3.7 < np.log2(errors[0] / errors[1]) < 4.3, errors


@pytest.mark.parametrize(("make", "step"), [(swarm_2d, simulator.joint_step_2d), (swarm, simulator.joint_step)])
def test_joints_of_a_free_tree_stay_closed_and_keep_both_momenta_and_energy(make, step):
    x, q, v, omega, p = make(np.random.default_rng(3))
    hold = joints.hold_joints_2d if q.ndim == 1 else joints.hold_joints
    v, omega = hold(q, v, omega, p)
    still = lambda t, x, q, v, omega, p: (0.0 * x, 0.0 * omega)

    def kept(x, q, v, omega):
        if q.ndim == 1:
            m, I = 1.0 / p.inv_mass, 1.0 / p.inv_inertia
            return np.append(m @ v, m @ (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]) + I @ omega)
        return np.concatenate(simulator.momenta(x, q, v, omega, p))

    def energy(x, q, v, omega):
        return (simulator.mechanical_energy_2d(x, q, v, omega, p) if q.ndim == 1 else
                simulator.mechanical_energy(x, q, v, omega, p))
    begin, swings = (x, q, v, omega), []
    for dt, steps in ((0.01, 20), (0.005, 40)):
        now, energies = begin, []
        for n in range(steps):
            now = step(still, n * dt, *now, dt, p)
            energies.append(energy(*now))
        assert open_by(now[0], now[1], p) < 1e-13
        assert np.allclose(kept(*now), kept(*begin), atol=1e-11)
        swings.append(np.max(np.abs(np.array(energies) / energy(*begin) - 1.0)))
    assert swings[0] < 1e-3 and 3.0 < swings[0] / swings[1] < 5.0, swings


@pytest.mark.parametrize("make", [swarm_2d, swarm])
def test_both_points_of_a_held_joint_have_the_same_velocity_and_no_momentum_is_made(make):
    x, q, v, omega, p = make(np.random.default_rng(5))
    flat = q.ndim == 1
    held, turns = (joints.hold_joints_2d if flat else joints.hold_joints)(q, v, omega, p)
    h = 1e-6
    later = q + h * turns if flat else joints.turn_on(q, turns, h, p.inv_inertia)[0]
    before = q - h * turns if flat else joints.turn_on(q, turns, -h, p.inv_inertia)[0]
    arms = joints.joint_arms_2d if flat else joints.joint_arms
    apart = [joints.joint_gaps(x + s * h * held, arms(turned, p.joints), p.joints)
             for s, turned in ((1.0, later), (-1.0, before))]
    assert np.max(np.abs(apart[0] - apart[1])) / (2.0 * h) < 1e-8
    assert np.allclose((held - v).T @ (1.0 / p.inv_mass), 0.0, atol=1e-13)


def test_a_step_runs_back_to_where_it_began():
    state, p = chain(3)
    there = run(simulator.joint_step_2d, state, p, 0.3, 60)
    back = there
    for _ in range(60):
        back = simulator.joint_step_2d(simulator.weight, 0.0, *back, -0.005, p)
    assert np.allclose(back[0], state.x, atol=1e-11) and np.allclose(back[2], 0.0, atol=1e-9)


def test_a_chain_in_space_moves_as_in_the_plane():
    n, l, m, h = 3, 0.3, 0.5, np.array([0.6, 0.8, 0.0])
    flat, rows = chain(n, l, m)
    I = m * l * l / 12.0
    along, moments = flat.x[:, 0], np.vstack((np.full(3, np.inf), np.tile([0.02 * I, I, I], (n, 1))))
    q = np.tile(exponential(np.array([0.0, 0.0, np.arctan2(0.8, 0.6)])), (n + 1, 1))
    state, p = simulator.make_bodies(along[:, None] * h, q, np.append(np.inf, np.full(n, m)), moments,
                                     np.full((n + 1, 3), 0.1), np.zeros((0, 4)), (0.0, 0.0, -G), 0.0, 1, 0.01)
    k = np.arange(1, n + 1)
    p = simulator.make_joints(state, p, k, k - 1, l * np.arange(n)[:, None] * h, 0.0)
    x, *_ = run(simulator.joint_step, state, p, 0.5, 50)
    expected, *_ = run(simulator.joint_step_2d, flat, rows, 0.5, 50)
    assert np.allclose(np.stack((x @ h, x[:, 2]), axis=1), expected, atol=1e-11)


def test_a_heavy_top_on_a_ball_joint_nods_as_theory_says():
    """I about the pivot (5, 5, 1), m g l = 20 N m, 50 rad/s; with a mass of 2 kg the centre has I − m l²."""
    m, tilt, spin, T = 2.0, 0.05, 50.0, 0.2
    l, errors, truth = 20.0 / (m * G), [], HeavyTop(5.0, 1.0, 20.0, 0.05, 50.0)
    moments = np.array([(np.inf,) * 3, (5.0 - m * l * l, 5.0 - m * l * l, 1.0)])
    q = np.stack((np.eye(4)[0], exponential(np.array([tilt, 0.0, 0.0]))))
    axis = np.array([0.0, -np.sin(tilt), np.cos(tilt)])
    state, p = simulator.make_bodies(np.stack((np.zeros(3), l * axis)), q, (np.inf, m), moments, np.full((2, 3), 0.1),
                                     np.zeros((0, 4)), (0.0, 0.0, -G), 0.0, 1, 0.01)
    p = simulator.make_joints(state, p, [1], [0], np.zeros((1, 3)), 0.0)
    state = state._replace(omega=np.stack((np.zeros(3), spin * axis)))
    for steps in (100, 200):
        x, *_ = run(simulator.joint_step, state, p, T, steps)
        errors.append(np.linalg.norm(x[1, :2] / l - truth.tip(T)))
    assert errors[1] < 1e-4 and 3.5 < errors[0] / errors[1] < 4.5, errors


# ---------------------------------------------------------------------------------------------- with contacts

def cradle(gap, e, n=3, lifted=1, angle=0.3, R=0.05):
    pivots = np.stack((2.0 * R * np.arange(n) + gap * np.arange(n), np.zeros(n)), axis=1)
    q = np.where(np.arange(n) < lifted, -angle, 0.0)
    x = pivots + np.stack((np.sin(q), -np.cos(q)), axis=1)
    state, p = simulator.make_bodies_2d(x, q, 1.0, 0.4 * R * R, np.full((n, 2), R), [(0.0, 1.0, 100.0)], (0.0, -G), 0.0,
                                        4, 1e-9)
    return state, simulator.make_joints(state, p, np.arange(n), np.full(n, n), pivots, e)


def swing(state, p, T, steps):
    return simulator.advance_contact(simulator.joint_contact_step_2d, simulator.weight, simulator.disc_bounds,
                                     simulator.round_contacts, 0.0, state, T / steps, steps, p)


def test_one_ball_of_a_cradle_sends_one_away():
    state, p = cradle(0.02, 1.0)
    end = swing(state, p, 0.62, 620)
    omega = cradle_motion(1, 0.3, 3, 0.12, 1.0, 0.05, G, 1.0 + 0.4 * 0.05**2, 0.62)[1]
    assert np.allclose(end.omega[:3], omega, atol=0.01)
    assert np.all(np.abs(end.omega[:2]) < 0.04) and end.omega[2] > 0.85


@pytest.mark.parametrize("seed", range(4))
def test_a_cradle_in_angles_moves_as_an_independent_integrator_says(seed):
    """Also with steps in which several balls are hit, and one would pass through the next."""
    rng = np.random.default_rng(seed)
    n, lifted, L, R, T = 4, 1 + seed % 2, rng.uniform(0.5, 1.5), 0.05, 0.8
    pitch, inertia = 2.0 * R + rng.uniform(0.01, 0.04), L * L + 0.4 * R * R
    true = cradle_motion(lifted, 0.4, n, pitch, L, R, G, inertia, T)
    begin, p = np.where(np.arange(n) < lifted, -0.4, 0.0), simulator.Cradle(pitch, L, R, inertia, G)
    ends = {steps: np.concatenate(simulator.advance_swinging(simulator.rk4_step, 0.0, begin, np.zeros(n), T / steps,
                                                             steps, p)) for steps in (3, 200)}
    assert len(true[2]) == lifted * (n - lifted)                       # impacts
    assert np.allclose(ends[200], np.concatenate(true[:2]), atol=1e-8, rtol=0.0)
    assert np.allclose(ends[3], np.concatenate(true[:2]), atol=0.05, rtol=0.0)


@pytest.mark.parametrize("seed", range(4))
def test_the_first_impact_of_a_cradle_is_the_earliest_zero_of_all_gaps(seed):
    """Random balls, some of which come together slowly; steps of any length."""
    rng, found = np.random.default_rng(seed), 0
    p = simulator.Cradle(0.15, 1.0, 0.05, 1.001, G)
    for _ in range(60):
        theta, omega, dt = rng.uniform(-0.02, 0.02, 4), rng.normal(size=4), 10.0 ** rng.uniform(-4.0, -0.5)
        after = partial(simulator.rk4_step, given.swing_acceleration, 0.0, theta, omega, p=p)
        times = {k: zero_of_the_gap(after, k, dt, p) for k in range(3) if given.closes(*after(dt), k, p)}
        late, k = given.first_impact(simulator.rk4_step, 0.0, theta, omega, dt, p)
        assert k == min(times, key=times.get, default=-1)
        assert late == dt if k < 0 else abs(late - times[k]) * abs(omega).max() < 1e-14
        found += k >= 0
    assert found > 10


def zero_of_the_gap(after, k, dt, p):
    """Time within dt at which the gap of balls k and k + 1 is zero; after(t) → (θ, ω)."""
    return brentq(lambda t: given.cradle_gap(after(t)[0], k, p)[0], 0.0, dt, xtol=1e-16)


def test_balls_that_hit_each_other_without_end_are_refused(monkeypatch):
    monkeypatch.setattr(given, "MOST_IMPACTS", 2)
    p = simulator.Cradle(0.12, 1.0, 0.05, 1.001, G)
    with pytest.raises(Diverged, match="impacts in a step = 2"):
        simulator.advance_swinging(simulator.rk4_step, 0.0, np.array([-0.3, 0.0, 0.0, 0.0]), np.zeros(4), 0.7, 1, p)


def test_impacts_of_hinged_balls_keep_energy_with_e_1_and_lose_all_of_the_approach_with_e_0():
    for e in (1.0, 0.0):
        state, p = cradle(0.02, e, n=2)
        begin = simulator.mechanical_energy_2d(state.x, state.q, state.v, state.omega, p)
        end = swing(state, p, 0.6, 400)
        lost = begin - simulator.mechanical_energy_2d(end.x, end.q, end.v, end.omega, p)
        first = G * (1.0 - np.cos(0.3))
        # the loop's own error is that of symplectic Euler, ½ w dt of the energy that swings
        assert abs(lost - (1.0 - e) * 0.5 * first) < 0.02 * first
        if e == 0.0:
            # 0.07 s later: they hang 0.02 rad apart, so that g times that drives them apart
            assert abs(end.omega[0] - end.omega[1]) < 0.02


def test_joined_boxes_do_not_push_each_other_away_and_others_do():
    """Two boxes that overlap at their joint hang at rest, and a third one stands on the floor below."""
    x, half = np.array([(0.0, 2.0), (0.0, 1.7), (0.0, 0.2)]), np.full((3, 2), 0.2)
    state, p = simulator.make_bodies_2d(x, np.zeros(3), (np.inf, 1.0, 1.0), (np.inf, 0.02, 0.02), half,
                                        [(0.0, 1.0, 0.0)], (0.0, -G), 0.5, 10, 0.01)
    p = simulator.make_joints(state, p, [1], [0], [(0.0, 1.85)], 0.0)
    for n in range(60):
        state = simulator.joint_contact_step_2d(simulator.weight, simulator.box_bounds_2d, simulator.box_contacts_2d,
                                                n / 60.0, state, 1.0 / 60.0, p)
    # ten sweeps leave a few micrometres of the first steps below the one that stands
    assert np.allclose(state.x[:2], x[:2], atol=1e-9) and np.allclose(state.x[2], x[2], atol=1e-5)
    assert state.contacts.a.size == 2


# ---------------------------------------------------------------------------------------------- what is refused

def test_joints_that_no_physics_can_be_done_with_are_refused():
    state, p = simulator.make_bodies_2d([(0.0, 0.0), (1.0, 0.0), (0.5, 1.0)], np.zeros(3), (1.0, 1.0, np.inf), 0.1,
                                        np.full((3, 2), 0.1), [(0.0, 1.0, 5.0)], (0.0, -G), 0.0, 1, 0.01)
    good = [0], [1], [(0.5, 0.0)]
    assert simulator.make_joints(state, p, *good, 0.0).joints.band == 1
    for a, b, places, e in (([0], [7], good[2], 0.0), ([0], [0], good[2], 0.0), ([2], [3], good[2], 0.0),
                            ([0], [1], [(np.nan, 0.0)], 0.0), ([0], [1], [(0.5, 0.0, 0.0)], 0.0), (*good, 1.5)):
        with pytest.raises(BadInput):
            simulator.make_joints(state, p, a, b, places, e)


def test_a_step_that_is_too_long_says_so():
    state, p = chain(5, 0.1)
    with pytest.raises(Diverged, match="gap of a joint"):
        run(simulator.joint_step_2d, state, p, 2.0, 10)
