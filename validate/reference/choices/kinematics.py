"""Choices of lesson 11."""

import numpy as np

from . import Choice

LENGTHS = np.array([1.0, 0.8])                               # of an arm in the plane [m]
BENT = np.array([0.4, 1.5])                                  # angles of its joints at the target [rad]


def end_of(theta):
    """Return (the place (2,) of the end [m], its Jacobian (2, 2) [m]) of the arm."""
    s = np.cumsum(theta)
    bars = LENGTHS[:, None] * np.stack((np.cos(s), np.sin(s)), axis=1)
    rest = np.cumsum(bars[::-1], axis=0)[::-1]               # from each joint to the end
    return rest[0], np.stack((-rest[:, 1], rest[:, 0]))


def errors_of(step, iterations=9):
    """Return the distance to the target [m] before each iteration of step(J, e), from angles 0.3 rad away."""
    target, theta, errors = end_of(BENT)[0], BENT + np.array([0.3, -0.3]), []
    for _ in range(iterations):
        place, J = end_of(theta)
        errors.append(np.linalg.norm(target - place))
        theta = theta + step(J, target - place)
    return np.maximum(1e-15, errors)


def errors_of_four_ways():
    """Return errors of an arm of two links: the transpose with two gains, a damped step, and the inverse (Newton)."""
    return Choice(np.arange(9.0), (
        errors_of(lambda J, e: 0.2 * J.T @ e), errors_of(lambda J, e: 0.45 * J.T @ e),
        errors_of(lambda J, e: J.T @ np.linalg.solve(J @ J.T + 0.09 * np.eye(2), e)), errors_of(np.linalg.solve)),
        "four ways to a target", "iterations", "distance to the target [m]", log=True)
