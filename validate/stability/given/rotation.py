"""Times of torques: what a torque that grows with time does to the angular momentum, step by step."""

import numpy as np

from validate import methods
from validate.stability.case import case, matrix_of, random_law, random_quaternions

EXACT = 1e-9                 # of numbers around 1: the same by another sum
AT_BEGINNING = methods.MATRIX, methods.AXIS_ANGLE, methods.QUATERNION
BY_TRAPEZOIDS = methods.MIDPOINT_TURN, methods.SPLITTING, methods.COMPOSED_SPLITTING, methods.COMPOSED_MIDPOINT


@random_law("A torque that is linear in time changes L by its integral, or by its value at the beginning of each step.",
            "torque in time: largest error of L, and of the lengths of quaternions [kg m²/s, -]", EXACT)
def times_of_torques(lesson, rng):
    """Trapezoids and Simpson's rule are exact for such a torque; steps of first order lag by ½ dt of its growth."""
    still, grows = rng.normal(size=(2, 3))
    (t, dt), steps, q, L = rng.uniform(0.01, 0.05, 2), 4, random_quaternions(rng, 1)[0], rng.normal(size=3)
    body, T = lesson.make_rigid_body(2.0, rng.uniform(1.0, 1.9, 3)), 4 * dt
    torque = lambda t, q, L, body: still + t * grows
    exact, found, truth = L + T * (still + (t + 0.5 * T) * grows), [], []
    for method in (*AT_BEGINNING, *BY_TRAPEZOIDS, methods.RUNGE_KUTTA):
        step = getattr(lesson, method.function)
        end, found_L = lesson.advance_rotation(step, torque, t, q, L, dt, steps, body)
        ts, qs, Ls = lesson.rotation_trajectory(step, torque, t, q, L, dt, steps, body)
        found += [found_L, ts, Ls[-1], matrix_of(qs[-1]) @ matrix_of(end).T]
        truth += [exact - 0.5 * dt * T * grows * (method in AT_BEGINNING), t + dt * np.arange(steps + 1)]
        truth += [truth[-2], np.eye(3)]
    return tuple(found), tuple(truth)


@random_law("A body that only turns about a principal axis gets the torque of the beginning of each step.",
            "torque about an axis: largest error of L [kg m²/s]", EXACT)
def torque_about_an_axis(lesson, rng):
    """The gyroscopic term is 0 there, so both steps with ω as their state add dt τ."""
    k, (still, grows, spin) = rng.integers(3), rng.normal(size=3)
    axis, dt, t = np.eye(3)[k], 0.02, rng.uniform(0.0, 1.0)
    body = lesson.make_rigid_body(2.0, rng.uniform(1.0, 1.9, 3))
    torque = lambda t, q, L, body: (still + t * grows) * axis
    ends = [lesson.advance_rotation(getattr(lesson, method.function), torque, t, np.array([1.0, 0.0, 0.0, 0.0]),
                                    spin * axis, dt, 4, body)[1]
            for method in (methods.GYROSCOPIC, methods.IMPLICIT_GYROSCOPIC)]
    truth = (spin + 4 * dt * (still + (t + 1.5 * dt) * grows)) * axis
    return tuple(ends), (truth, truth)


@case("times-of-torques", "Torques that grow with time", compiled=False)
def torques_in_time(lesson, check):
    """Compare L after four steps with the integral of a torque that is linear in time."""
    check.laws(lesson, (times_of_torques, torque_about_an_axis), seed=37, times=10)
