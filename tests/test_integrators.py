"""Lesson 1 is right when each method has its own stability function, its order, and keeps what it should keep."""

from typing import NamedTuple

import numpy as np
import pytest

from .grading.expect import between, close, raises
from solutions.checks import Diverged

exercise = pytest.mark.exercise
OMEGA, ZETA, DT = 3.0, 0.2, 0.1

METHODS = {     # method: exercise, points for its matrix, for its order, the order, where in the step it reads the clock {c: weight}
    "euler_step": ("1.1", 1, 1, 1, {0: 1}),
    "midpoint_step": ("1.2", 1, 1, 2, {0.5: 1}),
    "rk4_step": ("1.3", 1, 2, 4, {0: 1 / 6, 0.5: 2 / 3, 1: 1 / 6}),
    "average_velocity_step": ("1.4", 1, 1, 1, {0: 1}),
    "symplectic_euler_step": ("1.5", 1, 1, 1, {0: 1}),
    "verlet_step": ("1.6", 1, 1, 2, {0: 1 / 2, 1: 1 / 2}),
    "implicit_euler_step": ("1.7", 0.5, 1, 1, {1: 1}),
    "implicit_midpoint_step": ("1.8", 0.5, 1, 2, {0.5: 1}),
}
HINTS = {
    "1.1": "both slopes belong to the beginning of the step: use the old v for the position",
    "1.2": "take half an Euler step, then a whole step from the beginning along the slopes found there, with a at t + ½dt",
    "1.3": "each slope is reached along the one before it; weights 1/6, 1/3, 1/3, 1/6, for x and v alike",
    "1.4": "new velocity by Euler first, then the position with the mean of old and new velocity",
    "1.5": "velocity first; the position then moves with the new velocity",
    "1.6": "the position takes ½dt² a; the new acceleration belongs to tₙ + dt, the new position and the predicted velocity v + dt a",
    "1.7": "the acceleration belongs to tₙ + dt, to x + dt w and to w; start from w = v.copy(), and subtract the Newton correction",
    "1.8": "half a step of implicit Euler gives the middle: the end is as far again beyond it",
}


def cases(*indices):
    """One pytest case for each method: its name and the listed columns, marked with its exercise."""
    def case(name, row, points):
        return pytest.param(name, *(row[i] for i in indices), id=name, marks=exercise(row[0], points=points, hint=HINTS[row[0]]))
    return [case(name, row, row[2] if indices else row[1]) for name, row in METHODS.items()]


def expected_matrix(name, h):
    """A of one step on the damped oscillator: the method's stability function at hB for those that have one."""
    B = np.array([[0.0, 1.0], [-OMEGA**2, -2.0 * ZETA * OMEGA]])
    one, z = np.eye(2), h * B
    kick = np.array([[1.0, 0.0], [z[1, 0], 1.0 + z[1, 1]]])                       # v ← v + h a
    kick_ahead = one + np.array([[0.0, 0.0], [0.5 * z[1, 0], 0.5 * z[1, 1]]])     # v ← v + ½h a
    return {
        "euler_step": lambda: one + z,
        "midpoint_step": lambda: one + z + z @ z / 2,
        "rk4_step": lambda: one + z + z @ z / 2 + z @ z @ z / 6 + z @ z @ z @ z / 24,
        "average_velocity_step": lambda: np.array([one[0], [0.0, 0.0]]) + np.array([0.5 * h * (one[1] + kick[1]), kick[1]]),
        "symplectic_euler_step": lambda: np.array([[1.0, h], [0.0, 1.0]]) @ kick,
        "verlet_step": lambda: verlet_matrix(B, h),
        "implicit_euler_step": lambda: np.linalg.inv(one - z),
        "implicit_midpoint_step": lambda: np.linalg.inv(one - z / 2) @ (one + z / 2),
    }[name]()


def verlet_matrix(B, h):
    """x⁺ = x + hv + ½h²a;  v⁺ = v + ½h(a + b·(x⁺, v + ha)), with a = b·(x, v), b the lower row of B."""
    x, v, b = np.array([1.0, 0.0]), np.array([0.0, 1.0]), B[1]
    x_new = x + h * v + 0.5 * h * h * b
    return np.array([x_new, v + 0.5 * h * (b + b[0] * x_new + b[1] * (v + h * b))])


@pytest.mark.parametrize("method", cases())
def test_one_step_has_the_amplification_matrix_of_the_method(lesson, method):
    p = lesson.Oscillator(OMEGA, ZETA)
    expected = expected_matrix(method, DT)
    for x0, v0 in ((1.0, 0.0), (0.0, 1.0), (0.3, -2.0)):
        before = np.array([x0]), np.array([v0])
        x, v = lesson.advance(getattr(lesson, method), lesson.oscillator_acceleration, 0.0, *before, DT, 1, p)
        # 1e-11: Newton stops at 1e-12, everything else is round-off of numbers below 30
        close(f"x, v after one step of {DT} s from x = {x0} m, v = {v0} m/s", [x[0], v[0]], expected @ [x0, v0], 1e-11)
        close("the x and v that were handed in: return new arrays", np.ravel(before), [x0, v0], 0.0)


class Drive(NamedTuple):
    strength: float      # [m/s²]
    drag: float          # [1/s]


def driven_pendula(t, x, v, p):
    """a = −sin x − c v + s cos t, entry by entry: depends on time, position and velocity, and on nothing linearly."""
    return -np.sin(x) - p.drag * v + p.strength * np.cos(t)


@pytest.fixture(scope="module")
def drive_truth():
    """Two driven pendula at t = 1.7 + 1.6 s by DOP853 at its tightest tolerance (global error below 1e-12)."""
    from scipy.integrate import solve_ivp
    p, x, v = Drive(0.7, 0.3), np.array([1.0, -0.4]), np.array([0.2, 1.5])
    end = solve_ivp(lambda t, y: np.concatenate([y[2:], driven_pendula(t, y[:2], y[2:], p)]), (1.7, 3.3),
                    np.concatenate([x, v]), method="DOP853", rtol=3e-14, atol=1e-14).y[:, -1]
    return p, x, v, end.reshape(2, 2)


@pytest.mark.parametrize("method, order, clock", cases(3, 4))
def test_halving_the_step_divides_the_error_by_two_to_the_order(lesson, method, order, clock, drive_truth):
    push = Drive(1e-3, 0.0)
    _, kicked = lesson.advance(getattr(lesson, method), driven_pendula, 1.7, np.zeros(2), np.zeros(2), 0.1, 1, push)
    mean = sum(weight * np.cos(1.7 + c * 0.1) for c, weight in clock.items())
    # near x = 0 the pendulum's own pull is below 1e-3 of the push; a clock wrong by half a step would change the mean by 0.05
    close("gain of velocity over dt times push: does a get the right time?", kicked / (0.1 * push.strength), [mean, mean], 0.005)

    p, x, v, end = drive_truth
    steps = np.array([16, 32, 64, 128])
    errors = []
    for n in steps:
        got = lesson.advance(getattr(lesson, method), driven_pendula, 1.7, x.copy(), v.copy(), 1.6 / n, int(n), p)
        close(f"x after {n} steps [rad]", got[0], end[0], 2.0 * 1.6 / n)          # the right motion: |x|, |v|, |a| < 3, t < 2
        errors.append(max(np.abs(got[0] - end[0]).max(), np.abs(got[1] - end[1]).max()))
    ratios = np.log2(np.array(errors[:-1]) / errors[1:])
    # the next term of the expansion is dt smaller: at dt ≤ 1/20 s it moves a measured order by at most a third
    between("order of convergence over dt = 1/20 … 1/80 s", ratios[1:].mean(), order - 0.3, order + 0.4)


@pytest.mark.parametrize("method, share", [
    pytest.param("implicit_euler_step", 1.0, marks=exercise("1.7", points=1, hint=HINTS["1.7"] + "; repeat until the correction is small enough")),
    pytest.param("implicit_midpoint_step", 0.5, marks=exercise("1.8", points=0.5, hint=HINTS["1.8"]))])
def test_an_implicit_step_solves_its_own_equation_however_long_it_is(lesson, method, share):
    """v⁺ = v + dt a and x⁺ = x + dt v at the same moment of the step: its end, or its middle."""
    x, v, p = np.array([1.0, -2.5]), np.array([-0.3, 2.0]), Drive(0.7, 0.3)
    for dt in (0.3, 0.9):
        x_new, v_new = lesson.advance(getattr(lesson, method), driven_pendula, 1.7, x, v, dt, 1, p)
        there = x + share * (x_new - x), v + share * (v_new - v)
        # Newton's last correction is below 1e-12 of |w| < 3, and the equation at most 1 + dt (1 + dt) < 3 times as steep
        close(f"v⁺ − v − dt a after a step of {dt} s [m/s]", v_new - v - dt * driven_pendula(1.7 + share * dt, *there, p), [0.0, 0.0], 1e-11)
        close(f"x⁺ − x − dt v after a step of {dt} s [m]", x_new - x - dt * there[1], [0.0, 0.0], 1e-11)


@exercise("1.7", points=0.5, hint="when the loop ends without a return, raise Diverged as the docstring says")
def test_implicit_euler_says_so_when_newton_finds_no_root(lesson):
    """w = v + dt(1 + w²) has no real root once 4 dt (v + dt) > 1."""
    raises("a step without a solution", Diverged, lesson.implicit_euler_step, runaway, 0.0, np.zeros(1), np.zeros(1), 10.0, Drive(1.0, 0.0))


def runaway(t, x, v, p):
    return p.strength * (1.0 + v * v)


@exercise("1.9", points=1, hint="one column for each starting state: where the step takes (1, 0), and where (0, 1)")
def test_amplification_matrix_moves_states_as_the_method_does(lesson):
    close("A of Euler's method", lesson.amplification_matrix(euler, OMEGA, ZETA, DT), expected_matrix("euler_step", DT), 1e-14)
    drift, kick = np.array([[1.0, DT], [0.0, 1.0]]), expected_matrix("euler_step", DT) - [[0.0, DT], [0.0, 0.0]]
    close("A of position first, then velocity", lesson.amplification_matrix(drift_then_kick, OMEGA, ZETA, DT), kick @ drift, 1e-14)


def euler(acceleration, t, x, v, dt, p):
    return x + dt * v, v + dt * acceleration(t, x, v, p)


def drift_then_kick(acceleration, t, x, v, dt, p):
    x = x + dt * v
    return x, v + dt * acceleration(t, x, v, p)


@exercise("1.10", points=1, hint="subtract the means of log dt and of log error, then divide the sum of products by the sum of squares")
def test_observed_order_is_the_slope_between_logarithms(lesson):
    dts = np.array([0.1, 0.03, 0.02, 0.001])
    close("order of error = 5 dt³", lesson.observed_order(dts, 5.0 * dts**3), 3.0, 1e-12)
    wobble = np.array([1.0, 3.0, 0.5, 2.0])
    slope = np.polyfit(np.log(dts), np.log(7.0 * dts**2 * wobble), 1)[0]
    close("order of a noisy series, by least squares", lesson.observed_order(dts, 7.0 * dts**2 * wobble), slope, 1e-10)
