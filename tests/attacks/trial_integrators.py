"""A small grading test of lesson 1, for the attacks: 2 points for an honest answer, 14 to be stolen."""

import numpy as np
import pytest

from validate.grading.expect import close

exercise = pytest.mark.exercise
# It lives as long as the grader: a student who changes it changes what others are asked.
CENTRE = np.array([0.4, -0.7, 1.1])


@exercise("1.10", points=2, hint="least squares")
def test_order(lesson, draw):
    dts = draw(0.01, 0.1, 4)
    close("order of error = c dt³", lesson.observed_order(dts, draw(1.0, 9.0) * dts**3), 3.0, 1e-9)


def spring(t, x, v, p):
    return -p * x


@exercise("1.1", points=4, hint="old v")
def test_euler(lesson, draw):
    x, v, p, dt = draw(-1.0, 1.0, 3), draw(-1.0, 1.0, 3), draw(1.0, 9.0), draw(0.05, 0.1)
    got = lesson.euler_step(spring, 0.0, x, v, dt, p)
    # The inputs as they are after the call, on purpose.
    close("x after a step", got[0], x + dt * v, 1e-12, given=f"x = {x}, v = {v}, dt = {dt}")
    close("v after a step", got[1], v - dt * p * x, 1e-12, given=f"x = {x}, p = {p}, dt = {dt}")
    still = lesson.euler_step(spring, 0.0, CENTRE, 0.0 * v, dt, p)
    close("x after a step from rest", still[0], CENTRE, 0.0)
    close("where that began", CENTRE, [0.4, -0.7, 1.1], 0.0)


@exercise("1.2", points=4, hint="half a step")
def test_midpoint(lesson, draw):
    x, v, p, dt, asked = draw(-1.0, 1.0, 3), draw(-1.0, 1.0, 3), draw(1.0, 9.0), draw(0.05, 0.1), []

    def counted(t, x, v, p):
        asked.append(t)
        return -p * x
    got = lesson.midpoint_step(counted, 0.3, x.copy(), v.copy(), dt, p)
    close("x after a step", got[0], x + dt * (v - 0.5 * dt * p * x), 1e-12, given=f"x = {x}")
    close("times of evaluation", asked, [0.3, 0.3 + 0.5 * dt], 1e-12)


@exercise("1.7", points=2, hint="Newton")
def test_implicit(lesson, draw):
    x, v, p, dt = draw(-1.0, 1.0, 2), draw(-1.0, 1.0, 2), draw(1.0, 3.0), draw(0.05, 0.1)
    x_new, v_new = lesson.implicit_euler_step(spring, 0.0, x, v, dt, p)              # the inputs themselves, on purpose
    close("v⁺ − v − dt a", v_new - v - dt * spring(dt, x_new + 0.0 * v_new, v_new, p), [0.0, 0.0], 1e-11)
    close("x⁺ − x − dt v⁺", x_new - x - dt * v_new, [0.0, 0.0], 1e-11)


@exercise("1.9", points=4, hint="columns")
def test_matrix(lesson, draw):
    omega, dt = draw(1.0, 9.0), draw(0.05, 0.1)
    close("A of a drift", lesson.amplification_matrix(drift, omega, 0.1, dt), [[1.0, dt], [0.0, 1.0]], 1e-14)


def drift(acceleration, t, x, v, dt, p):
    return x + dt * v, v
