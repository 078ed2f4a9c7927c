"""What is given in lesson 11: tasks, searches, makers of arms and small systems."""

import numpy as np
import pytest

from solutions.checks import BadInput, Diverged
from validate.engines.products import PYBULLET
from validate.speed import targets
from validate.subject import modules

worked = modules.bind("kinematics")
NO_LIMITS = (-np.inf, np.inf, 0.0, 0.0)
X, Y, Z = np.eye(3)
AXES = np.stack((Z, Y, Y, X, Y, X))
OFFSETS = np.array([0.4 * Z, 0.6 * X, 0.25 * X + 0.1 * Y, 0.25 * X, 0.1 * X, 0.1 * X + 0.1 * Z])
FLAT = worked.make_arm_2d([1.0, 0.7, 0.4], 0.1, 0.05, *NO_LIMITS)
SPATIAL = worked.make_arm_3d(AXES, OFFSETS, 0.1, 0.05, *NO_LIMITS)


def drawn(seed, n):
    return np.random.default_rng(seed).uniform(-1.0, 1.0, n)


def here(task, theta, arm):
    """The target at which this arm is."""
    if arm is SPATIAL:
        return worked.end_pose(theta, arm)[:3 if task is worked.reach_3d else 7]
    x = worked.joint_positions(theta, arm.lengths)[-1]
    return x if task is worked.reach_2d else np.append(x, theta.sum())


TASKS = [pytest.param(task, arm, id=task.__name__) for task, arm in
         ((worked.reach_2d, FLAT), (worked.pose_2d, FLAT), (worked.reach_3d, SPATIAL), (worked.pose_3d, SPATIAL))]


@pytest.mark.parametrize(("task", "arm"), TASKS)
def test_the_jacobian_of_a_task_is_minus_the_slope_of_its_error(task, arm):
    """The logarithm of a rotation has this slope where the rotation is small."""
    theta, h = drawn(1, arm.low.size), 1e-5
    target = here(task, theta, arm)
    e, J = task(theta, target, arm)
    assert np.max(np.abs(e)) < 1e-14
    slopes = [(task(theta + d, target, arm)[0] - task(theta - d, target, arm)[0]) / (2.0 * h)
              for d in h * np.eye(theta.size)]
    assert np.allclose(-np.stack(slopes, axis=1), J, rtol=0.0, atol=1e-8)


@pytest.mark.parametrize("compiled", [False, pytest.param(
    True, marks=[pytest.mark.long, pytest.mark.xdist_group("compiled test_kinematics"),
                 pytest.mark.skipif(not modules.can_compile(), reason="numba has no wheel for this machine")])])
def test_six_joints_find_a_place_and_an_orientation(compiled):
    lesson, theta = modules.bind("kinematics", compiled=compiled), drawn(2, 6)
    goals = np.stack([worked.end_pose(theta + 0.3 * drawn(seed, 6), SPATIAL) for seed in range(3, 8)])
    arm = SPATIAL._replace(damping=0.01)
    found, errors, counts = lesson.solve_targets(lesson.damped_step, lesson.pose_3d, theta, goals, 1e-10, 200, arm)
    assert np.all(errors <= 1e-10) and np.all(counts > 1)
    for angles, goal in zip(found, goals, strict=True):
        pose = worked.end_pose(angles, SPATIAL)
        assert np.allclose(pose[:3], goal[:3], rtol=0.0, atol=1e-9)
        assert abs(abs(pose[3:] @ goal[3:]) - 1.0) < 1e-12                    # q and −q are the same


def test_a_pose_that_is_no_pose_of_this_task_is_refused():
    for task, arm, size in ((worked.reach_2d, FLAT, 3), (worked.pose_2d, FLAT, 2), (worked.reach_3d, SPATIAL, 2),
                            (worked.pose_3d, SPATIAL, 6)):
        with pytest.raises(BadInput, match="the target"):
            worked.solve_reach(worked.damped_step, task, np.zeros(arm.low.size), np.ones(size), 1e-6, 5, arm)


def test_many_targets_are_single_searches_and_a_trajectory_ends_where_the_loop_does():
    theta, goals = np.array([0.2, 0.5, 0.4]), np.array([[0.3, 1.5], [1.2, -0.7]])
    found, errors, counts = worked.solve_targets(worked.ccd_step, worked.reach_2d, theta, goals, 1e-8, 100, FLAT)
    for goal, angles, error, count in zip(goals, found, errors, counts, strict=True):
        one = worked.solve_reach(worked.ccd_step, worked.reach_2d, theta, goal, 1e-8, 100, FLAT)
        path = worked.reach_trajectory(worked.ccd_step, worked.reach_2d, theta, goal, count, FLAT)
        assert np.array_equal(one[0], angles) and one[1:] == (error, count)
        assert np.array_equal(path[0], theta) and np.array_equal(path[-1], angles) and len(path) == count + 1


def test_a_search_stops_as_soon_as_it_has_arrived_and_says_when_it_has_not():
    theta = np.array([0.2, 0.5, 0.4])
    goal = worked.joint_positions(theta, FLAT.lengths)[-1]
    assert worked.solve_reach(worked.damped_step, worked.reach_2d, theta, goal, 1e-12, 50, FLAT)[2] == 0
    _, error, count = worked.solve_reach(worked.limited_step, worked.reach_2d, theta, np.array([4.0, 3.0]), 1e-6, 7,
                                         FLAT._replace(damping=3.0))
    assert count == 7 and error >= 2.9                                        # the reach is 2.1 m, the target at 5 m


def test_what_overflows_has_diverged():
    with np.errstate(all="ignore"), pytest.raises(Diverged, match="what is left of the way"):
        worked.advance_reach(worked.transpose_step, worked.reach_2d, np.zeros(3), np.array([0.0, 1e200]), 3,
                             FLAT._replace(gain=1e200))


def test_angles_come_back_from_points():
    theta = 3.0 * drawn(9, 12)
    found = worked.angles_of(worked.joint_positions(theta, np.linspace(0.5, 1.5, 12)))
    assert np.allclose(found, theta, rtol=0.0, atol=1e-13)
    wrapped = [3.5 - 2.0 * np.pi, 2.0 * np.pi - 3.5, 9.0 - 2.0 * np.pi]
    assert np.allclose(worked.wrapped(np.array([3.5, -3.5, 9.0])), wrapped, rtol=0.0, atol=1e-14)


def test_limits_are_one_for_all_joints_or_one_each():
    one = worked.make_arm_2d([1, 2], 0.1, 0.2, -1, [0.5, np.inf], 0.25, 1.0)
    assert np.array_equal(one.low, [-1.0, -1.0]) and np.array_equal(one.high, [0.5, np.inf])
    assert np.array_equal(one.rest, [0.25, 0.25]) and one.lengths.dtype == float


def test_elimination_solves_what_is_positive_definite_and_refuses_what_is_not():
    for m in (1, 2, 3, 6):
        half = drawn(m, (m, m + 2))
        A, b = half @ half.T + 0.1 * np.eye(m), drawn(m + 10, m)
        assert np.allclose(worked.row_products(half), half @ half.T, rtol=0.0, atol=1e-14)
        assert np.allclose(worked.solve_symmetric(A, b), np.linalg.solve(A, b), rtol=1e-11, atol=0.0)
        assert np.allclose(worked.sum_of_rows(half, b), half.T @ b, rtol=0.0, atol=1e-14)
    with pytest.raises(BadInput, match="pivot"):
        worked.solve_symmetric(np.ones((2, 2)), np.ones(2))


@pytest.mark.skipif(not PYBULLET.installed(), reason="pybullet has no wheel for this machine")
def test_a_comparison_with_pybullet_counts_no_target_that_is_less_well_solved():
    for name in targets.ARMS:
        for _, _, _, _, _, _, _, found, left in targets.compare(worked, name, 5, 3):
            assert np.max(found) <= np.median(left) * (1.0 + 1e-6) and np.max(left) < 0.01
