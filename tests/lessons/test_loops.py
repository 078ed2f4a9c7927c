"""Joints, which are given, in closed loops and with rows that depend on each other: against closed forms, published
values and an independent solver.
"""

import itertools

import numpy as np
import pytest

from solutions.checks import Diverged
from solutions.given import joints
from solutions.support.small_systems import shortest_solution, solve_band
from validate.reference import mechanisms
from validate.subject import modules

simulator = modules.bind("simulator")
G = 9.81                     # [m/s²]
DOWN = {2: (0.0, -G), 3: (0.0, -G, 0.0)}


def joined(mechanism, gravity=True):
    """((x, q, v, omega), JointedBodies) of a Mechanism."""
    n, d = mechanism.x.shape
    make = simulator.make_bodies_2d if d == 2 else simulator.make_bodies
    state, p = make(mechanism.x, mechanism.q, mechanism.m, mechanism.inertia, np.full((n, d), 0.1),
                    np.zeros((0, d + 1)), DOWN[d] if gravity else np.zeros(d), 0.0, 1, 0.01)
    p = simulator.make_joints(state, p, mechanism.a, mechanism.b, mechanism.places, 0.0)
    return (state.x, state.q, mechanism.v, mechanism.omega), p


def run(step, now, p, T, steps, load=simulator.weight):
    return simulator.advance_free(step, load, 0.0, *now, T / steps, steps, p)


def order(errors):
    return np.log2(errors[0] / errors[1])


# ---------------------------------------------------------------------------------------------- the linear algebra

def test_the_shortest_solution_is_that_of_the_pseudo_inverse():
    rng = np.random.default_rng(2)
    for _ in range(100):
        m = rng.integers(1, 12)
        left = rng.normal(size=(m, rng.integers(1, m + 1)))
        A = left @ (left + 0.1 * rng.normal(size=left.shape)).T          # of full rank or not, nearly symmetric
        y = A @ rng.normal(size=m)
        expected = np.linalg.pinv(A, 1e-11) @ y
        assert np.allclose(shortest_solution(A, y), expected, rtol=0.0, atol=1e-9 * (1.0 + np.abs(expected).max()))


def test_the_rank_does_not_depend_on_units_or_masses():
    """A matrix of rank 3 whose rows and columns are scaled by up to a thousand: mass ratios of a million."""
    rng = np.random.default_rng(3)
    for _ in range(50):
        half, sizes = rng.normal(size=(5, 3)), 10.0 ** rng.uniform(-1.5, 1.5, 5)
        unit = 10.0 ** rng.uniform(-9.0, 9.0)
        A = unit * half @ half.T * np.outer(sizes, sizes)
        y = A @ rng.normal(size=5)
        x = shortest_solution(A, y)
        _, free = np.split(np.linalg.svd(half.T)[2], [3])    # what half.T takes to 0
        free = np.linalg.qr((free / sizes).T)[0]
        assert np.max(np.abs(A @ x - y)) < 1e-9 * np.max(np.abs(y))
        assert np.max(np.abs(free.T @ x)) < 1e-9 * np.linalg.norm(x)


def test_elimination_within_the_band_says_when_a_pivot_is_lost():
    A = np.array([[2.0, 1.0, 0.0], [1.0, 2.0, 1.0], [0.0, 1.0, 2.0]])
    y = np.array([1.0, 2.0, 3.0])
    assert solve_band(A.copy(), y, 1, 1e-8) and np.allclose(A @ y, (1.0, 2.0, 3.0), atol=1e-14)
    A[2, 2] = 2.0 / 3.0 + 1e-9                               # of the last row 1e-9 is left over
    assert not solve_band(A.copy(), np.ones(3), 1, 1e-8)
    assert not solve_band(np.zeros((2, 2)), np.ones(2), 1, 0.0)


def test_joints_without_loops_have_independent_rows_and_all_others_are_called_loops():
    """Random graphs of joints, some bodies of infinite mass: the matrix of what is called no loop has full rank."""
    rng, kinds = np.random.default_rng(4), []
    for _ in range(200):
        n = rng.integers(2, 7)
        m = np.where(rng.random(n) < 0.3, np.inf, 1.0)
        pairs = [(a, b) for a, b in itertools.combinations(range(n), 2) if m[a] < np.inf or m[b] < np.inf]
        chosen = rng.permutation(len(pairs))[:rng.integers(1, n + 1)] if pairs else []
        if len(chosen) == 0:
            continue
        a, b = np.array([pairs[k] for k in chosen]).T
        x = rng.normal(size=(n, 2))
        state, p = simulator.make_bodies_2d(x, rng.normal(size=n), m, np.where(rng.random(n) < 0.3, np.inf, 0.1),
                                            np.full((n, 2), 0.1), np.zeros((0, 3)), (0.0, 0.0), 0.0, 1, 0.01)
        p = simulator.make_joints(state, p, a, b, rng.normal(size=(len(a), 2)), 0.0)
        arms = joints.joint_arms_2d(state.q, p.joints)
        A = joints.joint_matrix_2d(arms, arms, p)
        kinds.append(p.joints.loops)
        assert p.joints.loops or np.linalg.eigvalsh(A)[0] > 1e-6
        # a forest has fewer joints than bodies, all of infinite mass counted as one
        parts = np.where(m < np.inf, np.arange(n), -1)
        for i, j in zip(a, b, strict=True):
            parts[parts == parts[j]] = parts[i]
        bodies = np.sum(m < np.inf) + np.any(m == np.inf)
        assert p.joints.loops == (len(a) != bodies - len(set(parts)))
    assert 20 < np.sum(kinds) < len(kinds) - 20


# ---------------------------------------------------------------------------------------------- random mechanisms

def random_mechanism(rng, d, redundant):
    """A ring of bodies, one of them joined to the world; redundant: one joint twice, and a pair joined by two more."""
    n = 4
    ring = [(k, (k + 1) % n, rng.normal(size=d)) for k in range(n)] + [(0, -1, rng.normal(size=d))]
    if redundant:
        ring += [ring[1], (2, 3, rng.normal(size=d)), (2, 3, rng.normal(size=d))]
    m = rng.uniform(0.5, 2.0, n)
    if d == 2:
        made = mechanisms.mechanism_2d(rng.normal(size=(n, 2)), rng.normal(size=n), m, rng.uniform(0.2, 1.0, n), ring)
    else:
        made = mechanisms.mechanism_3d(rng.normal(size=(n, 3)), m, rng.uniform(0.6, 1.0, (n, 3)), ring)
    turns = 1 if d == 2 else 3
    u = rng.normal(size=((n + 1), d + turns))
    u[-1] = 0.0
    u = mechanisms.consistent(made, u.ravel())
    F = rng.normal(size=(n + 1, d + turns))
    F[-1] = 0.0
    rows = u.reshape(n + 1, -1)
    made = made._replace(v=rows[:, :d].copy(), omega=rows[:, 2].copy() if d == 2 else rows[:, 3:].copy())
    load = lambda t, x, q, v, omega, p: (F[:, :d].copy(), F[:, 2].copy() if d == 2 else F[:, 3:].copy())
    return made, u, F.ravel(), load


CASES = [(d, redundant) for d in (2, 3) for redundant in (False, True)]


@pytest.mark.parametrize(("d", "redundant"), CASES)
def test_forces_of_random_loops_are_those_of_the_pseudo_inverse(d, redundant):
    rng = np.random.default_rng(6)
    for _ in range(10):
        made, u, F, load = random_mechanism(rng, d, redundant)
        now, p = joined(made, False)
        assert p.joints.loops
        expected = mechanisms.solved(made, made.q, u, F)[1]
        found = (simulator.joint_forces_2d if d == 2 else simulator.joint_forces)(load, 0.0, *now, p)
        assert np.allclose(found, expected, rtol=0.0, atol=1e-8 * (1.0 + np.abs(expected).max()))


@pytest.mark.parametrize(("d", "redundant"), CASES)
def test_random_loops_move_as_the_independent_solver_says(d, redundant):
    made, u, F, load = random_mechanism(np.random.default_rng(8), d, redundant)
    now, p = joined(made, False)
    T, errors = 0.1, []
    x, _, u = mechanisms.motion(made, u, F, T)
    step = simulator.joint_step_2d if d == 2 else simulator.joint_step
    for steps in (10, 20):
        end = run(step, now, p, T, steps, load)
        errors.append(np.max(np.abs(end[0] - x)) + np.max(np.abs(end[2] - u.reshape(len(x), -1)[:, :d])))
    assert errors[1] < 0.02 and 1.8 < order(errors) < 2.2, errors


# ---------------------------------------------------------------------------------------------- four-bars

@pytest.mark.parametrize(("loops", "angle"), [(1, 0.5 * np.pi), (2, 0.5 * np.pi), *((n, a) for n in (1, 2) for a in (
    0.0, 1e-9, 1e-7, 1e-6, 1e-4))])
def test_four_bars_move_as_one_angle_from_any_position_flat_ones_too(loops, angle):
    """Upright they pass the flat position within the run."""
    made, T = mechanisms.four_bars(loops, angle, -3.0), 0.6
    now, p = joined(made)
    true, errors = mechanisms.four_bars_motion(made, G, T)[0], []
    for steps in (15, 30):
        q = run(simulator.joint_step_2d, now, p, T, steps)[1][:-1]
        errors.append(np.max(np.abs(q[::2] - true)))
        assert np.ptp(q[::2]) < 1e-9 and np.max(np.abs(q[1::2])) < 1e-9
    assert errors[1] < 0.02 and 1.8 < order(errors) < 2.3, errors


def test_a_load_across_the_singular_position_does_not_stop_a_flat_four_bar():
    """Unequal cranks press the flat mechanism out of its way; no impulse at the start can prevent that."""
    made, T = mechanisms.four_bars(1, 0.0, 2.0, (3.0, 1.0, 0.5)), 0.3
    now, p = joined(made)
    true, errors = mechanisms.four_bars_motion(made, G, T)[0], []
    for steps in (15, 30):
        q = run(simulator.joint_step_2d, now, p, T, steps)[1]
        errors.append(np.max(np.abs(q[[0, 2]] - true)))
    assert errors[1] < 5e-3 and 1.7 < order(errors) < 2.6, errors


@pytest.mark.long
def test_forty_four_bars_reach_the_high_class_of_their_benchmark():
    """IFToMM A02, 20 s: relative error of the first top below 1e-3 with 800 composed steps."""
    if not modules.can_compile():
        pytest.skip("plain Python takes minutes")
    fast, made = modules.bind("simulator", compiled=True), mechanisms.four_bars(40, 0.5 * np.pi, -1.0)
    now, p = joined(made)
    tops, true = [], []
    for k in range(1, 401):
        now = fast.advance_free(fast.composed_joint_step_2d, fast.weight, 0.0, *now, 0.025, 2, p)
        tops.append(2.0 * now[0][0])
        angle = mechanisms.four_bars_motion(made, G, 0.05 * k)[0]
        true.append((np.cos(angle), np.sin(angle)))
    relative = np.abs(np.array(tops) - true) / np.maximum(np.abs(true), 1e-3)
    assert np.sqrt(np.mean(relative**2)) < 1e-3 and np.ptp(now[1][:-1:2]) < 1e-9


# ---------------------------------------------------------------------------------------------- Andrews and Bricard

def test_andrews_squeezer_comes_to_the_published_angles():
    """60 steps leave four digits; 1,000 leave nine."""
    now, p = joined(mechanisms.andrews(), False)
    q = run(simulator.composed_joint_step_2d, now, p, mechanisms.SECONDS, 60, mechanisms.andrews_load)[1]
    assert np.max(np.abs(mechanisms.andrews_angles(q) / mechanisms.ANDREWS_END - 1.0)) < 5e-5


@pytest.mark.long
def test_bricards_mechanism_moves_although_its_constraints_depend_on_each_other():
    now, p = joined(mechanisms.bricard())
    arms = joints.joint_arms(now[1], p.joints)
    A = joints.joint_matrix(arms, arms, p.inv_mass, joints.spatial_inertia(now[1], p.inv_inertia), p.joints)
    assert np.linalg.matrix_rank(A, 1e-9) == 29 and A.shape == (36, 36)
    true, errors = mechanisms.bricard_motion(G, 0.6)[0], []
    for steps in (12, 24):
        errors.append(np.max(np.abs(run(simulator.joint_step, now, p, 0.6, steps)[0][:5] - true)))
    assert errors[1] < 2e-3 and 1.8 < order(errors) < 2.2, errors


def test_the_truth_of_bricards_mechanism_closes_and_keeps_its_energy():
    moments = np.where(mechanisms.EDGES[:5] != 0.0, mechanisms.THICK, 1.0) / 12.0
    for t in (0.3, 1.0, 3.0):
        _, psi, rate = mechanisms.bricard_motion(G, t)
        x, v, w = mechanisms.bricard_state(psi)
        last = x[4] + (x[4] - 2.0 * x[3] + 2.0 * x[2] - 2.0 * x[1] + 2.0 * x[0] - mechanisms.CUBE[0])
        assert np.allclose(last, mechanisms.CUBE[5], atol=1e-12)         # ends of rods, one after the other
        first = mechanisms.bricard_state(np.arctan(np.sqrt(2.0)))[0]
        energy = 0.5 * rate**2 * (np.sum(v * v) + np.sum(moments * w * w)) + G * np.sum(x[:, 1] - first[:, 1])
        assert abs(energy) < 1e-9


# ---------------------------------------------------------------------------------------------- hinges and supports

def door(tilt, points, inertia=(0.1, 0.2, 0.3), m=2.0, r=0.5, spin=0.0):
    """A door on ball joints at these heights along an axis that leans by `tilt` from the vertical; y is up.

    Its centre is r from the axis, at first level with it; the moments are those across, along the axis, and the third.
    """
    up = np.array([0.0, np.cos(tilt), np.sin(tilt)])
    centre, c, s = np.array([r, 0.0, 0.0]), np.cos(0.5 * tilt), np.sin(0.5 * tilt)
    made = mechanisms.mechanism_3d([centre], [m], [inertia], [(0, -1, height * up) for height in points])
    made.q[0] = (c, s, 0.0, 0.0)                             # its y axis is the hinge's
    made.omega[0] = spin * up
    made.v[0] = np.cross(made.omega[0], centre)
    return made, up


def test_a_door_on_two_points_is_a_physical_pendulum():
    """(I + m r²) φ̈ = −m g r sin(tilt) sin φ, with φ from its lowest position; it begins at 90°."""
    from scipy.integrate import solve_ivp
    made, up = door(0.5, (0.7, -0.4))
    now, p = joined(made)
    rate, T, errors = 2.0 * G * 0.5 * np.sin(0.5) / (0.2 + 2.0 * 0.25), 0.6, []
    phi = solve_ivp(lambda _, y: (y[1], -rate * np.sin(y[0])), (0.0, T), (0.5 * np.pi, 0.0), "DOP853", rtol=1e-12,
                    atol=1e-13).y[0, -1]
    down = np.array([0.0, -1.0, 0.0]) + up[1] * up
    lowest = down / np.linalg.norm(down)
    true = 0.5 * (np.cos(phi) * lowest + np.sin(phi) * np.array([1.0, 0.0, 0.0]))
    for steps in (10, 20):
        errors.append(np.max(np.abs(run(simulator.joint_step, now, p, T, steps)[0][0] - true)))
    assert errors[1] < 2e-3 and 1.9 < order(errors) < 2.1, errors


def test_points_of_a_hinge_share_its_force_along_the_axis_evenly_and_the_moment_by_levers():
    """An upright door that turns with w: each bears ½ m g and ½ m w² r, and m g r is a couple over 2 h."""
    h, w = 0.8, 3.0
    made, _ = door(0.0, (h, -h), spin=w)
    now, p = joined(made)
    F = simulator.joint_forces(simulator.weight, 0.0, *now, p)
    pull, couple = 0.5 * 2.0 * w * w * 0.5, 2.0 * G * 0.5 / (2.0 * h)
    assert np.allclose(F, [(-pull - couple, G, 0.0), (-pull + couple, G, 0.0)], atol=1e-10)


def test_a_beam_on_many_hinges_presses_as_on_equally_stiff_springs():
    """Supports at x_k under a beam with its centre at x_c: F_k = m g (1/n + (x_c − x̄)(x_k − x̄)/Σ(x_k − x̄)²).

    The springs' deflection is a straight line in x_k, fixed by force and moment.
    """
    places = np.array([-1.0, -0.3, 0.2, 1.5])
    made = mechanisms.mechanism_2d([(0.4, 0.0)], [0.0], [2.0], [0.5], [(0, -1, (x, 0.0)) for x in places])
    now, p = joined(made)
    F, apart = simulator.joint_forces_2d(simulator.weight, 0.0, *now, p), places - places.mean()
    assert np.allclose(F[:, 1], 2.0 * G * (0.25 + (0.4 - places.mean()) * apart / np.sum(apart**2)), atol=1e-11)
    assert np.allclose(F[:, 0], 0.0, atol=1e-11)
    end = run(simulator.joint_step_2d, now, p, 0.5, 20)
    assert np.allclose(end[0], now[0], atol=1e-12) and np.allclose(end[3], 0.0, atol=1e-10)


def test_forces_of_redundant_joints_do_not_depend_on_order_axes_or_units():
    rng = np.random.default_rng(12)
    made, _, _, _ = random_mechanism(rng, 2, True)
    now, p = joined(made)
    F, mix = simulator.joint_forces_2d(simulator.weight, 0.0, *now, p), rng.permutation(len(made.a))
    mixed = made._replace(a=made.a[mix], b=made.b[mix], places=made.places[mix])
    now, p = joined(mixed)
    assert np.allclose(simulator.joint_forces_2d(simulator.weight, 0.0, *now, p), F[mix], atol=1e-9)
    k, c, s = 1e-4, np.cos(0.7), np.sin(0.7)                 # smaller and turned, with g as small, and lighter
    R = np.array([[c, -s], [s, c]])
    small = made._replace(x=k * made.x @ R.T, v=k * made.v @ R.T, places=k * made.places @ R.T, q=made.q + 0.7,
                          m=k * made.m, inertia=k**3 * made.inertia)
    now, p = joined(small)
    p = p._replace(gravity=k * R @ np.array(DOWN[2]))
    assert np.allclose(simulator.joint_forces_2d(simulator.weight, 0.0, *now, p) / k**2, F @ R.T, atol=1e-8)


def test_a_joint_that_is_given_twice_bears_half_each_and_changes_nothing():
    one = mechanisms.mechanism_2d([(0.5, 0.0)], [0.0], [1.0], [0.1], [(0, -1, (0.0, 0.0))])
    two = mechanisms.mechanism_2d([(0.5, 0.0)], [0.0], [1.0], [0.1], [(0, -1, (0.0, 0.0))] * 2)
    (now, p), (_, twice) = joined(one), joined(two)
    F = simulator.joint_forces_2d(simulator.weight, 0.0, *now, p)
    assert np.allclose(simulator.joint_forces_2d(simulator.weight, 0.0, *now, twice), 0.5 * F[[0, 0]], atol=1e-12)
    ends = [run(simulator.joint_step_2d, now, rows, 0.5, 20)[1] for rows in (p, twice)]
    assert np.allclose(*ends, atol=1e-11)


# ---------------------------------------------------------------------------------------------- what cannot be closed

def test_joints_that_bodies_pull_apart_are_named():
    """A rod between two belts that part: no step is short enough, and the message says so."""
    state, p = simulator.make_bodies_2d([(0.0, 0.0), (-1.0, 0.0), (1.0, 0.0)], np.zeros(3), (1.0, np.inf, np.inf),
                                        (0.1, np.inf, np.inf), np.full((3, 2), 0.1), np.zeros((0, 3)), (0.0, 0.0), 0.0,
                                        1, 0.01)
    p = simulator.make_joints(state, p, [0, 0], [1, 2], [(-0.5, 0.0), (0.5, 0.0)], 0.0)
    v = np.array([(0.0, 0.0), (-1.0, 0.0), (1.0, 0.0)])
    with pytest.raises(Diverged, match=r"gap of a joint.*cannot all stay closed"):
        run(simulator.joint_step_2d, (state.x, state.q, v, state.omega), p, 0.1, 10)
