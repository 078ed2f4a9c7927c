"""Lesson 1: each method has its stability function and its order, and implicit steps solve their equations."""

import itertools
from typing import NamedTuple

import numpy as np
import pytest

from solutions.checks import BadInput, Diverged
from validate.grading.expect import NotYet, between, choice, close, raises
from validate.reference import choices
from validate.reference.choices.integrators import OMEGA_DT

from .zeros import nearly_zero

exercise = pytest.mark.exercise

# method: exercise, points for its matrix, points for its order, order, times at which it evaluates a {c: weight}
METHODS = {
    "euler_step": ("1.1", 0.5, 0.5, 1, {0: 1}),
    "midpoint_step": ("1.2", 1, 1, 2, {0.5: 1}),
    "rk4_step": ("1.3", 1, 1, 4, {0: 1 / 6, 0.5: 2 / 3, 1: 1 / 6}),
    "average_velocity_step": ("1.4", 1, 1, 1, {0: 1}),
    "symplectic_euler_step": ("1.5", 0.5, 0.5, 1, {0: 1}),
    "verlet_step": ("1.6", 1, 1, 2, {0: 1 / 2, 1: 1 / 2}),
    "implicit_euler_step": ("1.7", 0.5, 1, 1, {1: 1}),
    "implicit_midpoint_step": ("1.8", 0.5, 1, 2, {0.5: 1}),
}
HINTS = {
    "1.1": "x gains dt times the old v, v gains dt times a: both derivatives are taken at the start of the step",
    "1.2": "take half an Euler step; then a whole step from the start with the derivatives found there, a at t + ½dt",
    "1.3": "each stage uses the derivative of the stage before it, at t, t + ½dt twice and t + dt; "
           "weights 1/6, 1/3, 1/3, 1/6 for both x and v",
    "1.4": "first the new velocity by Euler, then the position with the mean of old and new velocity",
    "1.5": "first the velocity; then the position with the new velocity",
    "1.6": "x gains dt v + ½dt² a; the new acceleration is that at tₙ + dt, "
           "the new position and the predicted velocity v + dt a",
    "1.7": "a is evaluated at tₙ + dt, x + dt w and w; start from w = v.copy(), and subtract the Newton correction",
    "1.8": "half a step of implicit Euler leads to the midpoint; the end lies as far beyond the midpoint as the start "
           "before it",
}


def cases(*indices):
    """One pytest case for each method: its name and the listed columns, marked with its exercise."""
    def case(name, row, points):
        return pytest.param(name, *(row[i] for i in indices), id=name,
                            marks=exercise(row[0], points=points, hint=HINTS[row[0]]))
    return [case(name, row, row[2] if indices else row[1]) for name, row in METHODS.items()]


def expected_matrix(name, omega, zeta, h):
    """A of one step on the damped oscillator: the method's stability function at hB for those that have one."""
    B = np.array([[0.0, 1.0], [-omega**2, -2.0 * zeta * omega]])
    one, z = np.eye(2), h * B
    kick = np.array([[1.0, 0.0], [z[1, 0], 1.0 + z[1, 1]]])              # v ← v + h a
    drift_by_mean = np.array([[1.0, 0.0], [0.0, 0.0]]) + 0.5 * h * np.array([one[1] + kick[1], [0.0, 0.0]])
    return {
        "euler_step": lambda: one + z,
        "midpoint_step": lambda: one + z + z @ z / 2,
        "rk4_step": lambda: one + z + z @ z / 2 + z @ z @ z / 6 + z @ z @ z @ z / 24,
        "average_velocity_step": lambda: drift_by_mean + np.array([[0.0, 0.0], kick[1]]),
        "symplectic_euler_step": lambda: np.array([[1.0, h], [0.0, 1.0]]) @ kick,
        "verlet_step": lambda: verlet_matrix(B, h),
        "implicit_euler_step": lambda: np.linalg.inv(one - z),
        "implicit_midpoint_step": lambda: np.linalg.inv(one - z / 2) @ (one + z / 2),
    }[name]()


def verlet_matrix(B, h):
    """x⁺ = x + hv + ½h²a and v⁺ = v + ½h(a + b·(x⁺, v + ha)), with a = b·(x, v) and b the lower row of B."""
    x, v, b = np.array([1.0, 0.0]), np.array([0.0, 1.0]), B[1]
    x_new = x + h * v + 0.5 * h * h * b
    return np.array([x_new, v + 0.5 * h * (b + b[0] * x_new + b[1] * (v + h * b))])


# method: (when, X by V, V by A, new x by V, new v by A), each a weight for every stage;
# a stage has X = x + dt Σ V, V = v + dt Σ A and A = a(t + when dt, X, V)
HALF = [[0, 0], [1 / 2, 0]]
STAGES = {
    "euler_step": ([0], [[0]], [[0]], [1], [1]),
    "midpoint_step": ([0, 1 / 2], HALF, HALF, [0, 1], [0, 1]),
    "rk4_step": ([0, 1 / 2, 1 / 2, 1], np.diag([1 / 2, 1 / 2, 1], -1), np.diag([1 / 2, 1 / 2, 1], -1),
                 [1 / 6, 1 / 3, 1 / 3, 1 / 6], [1 / 6, 1 / 3, 1 / 3, 1 / 6]),
    "average_velocity_step": ([0, 1], np.zeros((2, 2)), [[0, 0], [1, 0]], [1 / 2, 1 / 2], [1, 0]),
    "symplectic_euler_step": ([0, 1], np.zeros((2, 2)), [[0, 0], [1, 0]], [0, 1], [1, 0]),
    "verlet_step": ([0, 1], [[0, 0], [1 / 2, 1 / 2]], [[0, 0], [1, 0]], [1 / 2, 1 / 2], [1 / 2, 1 / 2]),
    "implicit_euler_step": ([1], [[1]], [[1]], [1], [1]),
    "implicit_midpoint_step": ([1 / 2], [[1 / 2]], [[1 / 2]], [1], [1]),
}


class Coupled(NamedTuple):
    stiffness: np.ndarray        # of each point [1/s²]
    drag: float                  # [1/s]
    rate: float                  # [1/s]
    push: float = 1.0            # [1/s²]


def coupled_pendula(t, x, v, p):
    """Each pendulum feels the angle and the velocity of another one; nothing is linear."""
    pull, drag = p.stiffness * np.sin(x + 0.5 * x[::-1]), p.drag * v * (1.0 + np.cos(v[::-1]))
    return p.push * np.cos(p.rate * t + 0.7) - pull - drag


def step_by_stages(law, method, t, x, v, dt, p):
    """x and v after a step, by iteration of all stages; explicit ones are right after as many rounds."""
    when, by_V, by_A, x_weights, v_weights = (np.array(part, float) for part in STAGES[method])
    V = A = np.zeros((len(when), *x.shape))
    for _ in range(100):                                                 # dt times the slopes is below ½
        X, V, before = x + dt * np.tensordot(by_V, V, 1), v + dt * np.tensordot(by_A, A, 1), A
        A = np.stack([law(t + c * dt, *there, p) for c, *there in zip(when, X, V, strict=True)])
        if np.array_equal(A, before):
            break
    return x + dt * np.tensordot(x_weights, V, 1), v + dt * np.tensordot(v_weights, A, 1)


def check_a_nonlinear_step(lesson, draw, method):
    """The step itself, with a law whose answer is in no table."""
    law, first = draw.law(coupled_pendula), next(bodies(draw))
    # the same place and time with another velocity and another law, and again, but a step backwards in time
    again = (*first[:2], -first[2], first[3]._replace(drag=0.7))
    for k, (t, x, v, p) in enumerate((first, again, first, *bodies(draw), *bodies_at_rest(draw))):
        dt = draw(0.15, 0.2) * (-1.0 if k == 2 else 1.0)
        expected = step_by_stages(law, method, t, x, v, dt, p)
        # Newton's last correction is below 1e-12 |w|, with |w| < 4, and squares what is left.
        close("x and v after a step of coupled bodies with a nonlinear law",
              getattr(lesson, method)(law, t, x, v, dt, p), expected, 1e-11,
              given=f"dt = {dt:.4g} s, t = {t:.4g} s, arrays of shape {x.shape}")


def bodies(draw):
    """(t, x, v, p) in general, from rest, of one body, of many at zero, long after the start, and of any shape."""
    some = draw.sparse
    for shape, of, t, drag, moves in (
            (draw.whole(3, 5), draw, draw(0.0, 9.0), draw(0.2, 0.5), 1.0), (draw.whole(3, 5), draw, 0.0, 0.3, 0.0),
            (1, draw, draw(-9.0, 0.0), 0.0, 1.0), (9, some, draw(2000.0, 9000.0), draw(0.2, 0.5), 1.0),
            ((2, 3), draw, draw(0.0, 9.0), draw(0.2, 0.5), 1.0), ((4, 1), draw, draw(-9.0, 0.0), 0.0, 1.0)):
        yield (t, of(-2.0, 2.0, shape), moves * of(-1.0, 1.0, shape),
               Coupled(of(0.5, 1.0, shape), drag, draw(0.5, 1.5)))


def bodies_at_rest(draw):
    """(t, x, v, p) where one of three bodies moves, is displaced or is accelerated; or none is; or of mirror images.

    What takes a vector for zero because one entry is, or because all add up to 0, is wrong only there.
    """
    for alone in nearly_zero(draw, 3):
        general = draw(0.5, 1.0, 3)
        yield draw(0.0, 9.0), general * np.sign(alone.sum() or 1.0), alone, Coupled(np.abs(alone), 0.0, 1.0, 0.0)
        yield draw(0.0, 9.0), alone, general, Coupled(draw(0.5, 1.0, 3), draw(0.2, 0.5), 1.0, 0.0)
    yield draw(0.0, 9.0), draw(-2.0, 2.0, 3), draw(-1.0, 1.0, 3), Coupled(np.zeros(3), 0.0, 1.0, 0.0)
    mirror = np.array([1.0, -1.0])
    yield (draw(0.0, 9.0), draw(0.5, 2.0) * mirror, draw(0.5, 1.0) * mirror,
           Coupled(np.full(2, draw(0.5, 1.0)), draw(0.2, 0.5), 1.0, 0.0))


@pytest.mark.parametrize("method", cases())
def test_one_step_has_the_amplification_matrix_of_the_method(lesson, draw, method):
    omega, zeta, dt = draw(2.0, 4.0), draw(0.1, 0.4), draw(0.05, 0.15)
    # in units of seconds and metres, which are powers of two: free bodies, no damping, much damping, all sizes
    for rate, damping, second, metre in ((omega, zeta, 1.0, 1.0), (omega, 0.0, 1.0, 1.0), (0.0, 0.0, 2.0**-20, 2.0**40),
                                         (omega, draw(1.2, 2.0), 2.0**20, 2.0**-40)):
        p, expected = lesson.Oscillator(rate / second, damping), expected_matrix(method, rate, damping, dt)
        starts = draw(-1.0, 1.0, (6, 2)) * [[1.0, 1.0], [1.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]
        for x0, v0 in starts[:6 if second == 1.0 else 3]:
            before = np.array([metre * x0]), np.array([metre / second * v0])
            kept, law = np.ravel(before), lesson.oscillator_acceleration
            x, v = lesson.advance(getattr(lesson, method), law, 0.0, *before, dt * second, 1, p)
            # Newton stops at 1e-12 |w|, with |w|² < ω²x² + v² < 17, and the midpoint doubles that.
            # The rest is round-off of numbers below 20.
            close("x and v [m, m/s] after one step, in these units", [x[0] / metre, v[0] / metre * second],
                  expected @ [x0, v0], 1e-11, given=f"ω = {rate / second:.4g}/s, ζ = {damping:.4g}, "
                  f"dt = {dt * second:.4g} s, from x = {x0:.4g} and v = {v0:.4g}, in units of {metre:.4g} m and "
                  f"{second:.4g} s")
            close("input x and v after the call: return new arrays", np.ravel(before), kept, 0.0)
    check_a_nonlinear_step(lesson, draw, method)


# Of the motion [m], the ordinary one first: a student reads of the first case that fails.
# Powers of two: what is exact at one size is exact at the others.
SIZES = (1.0, 2.0**-40, 2.0**40)


class Drive(NamedTuple):
    strength: float      # [m/s²] at the size of 1 m
    drag: float          # [1/s]
    size: float = 1.0    # [m]


def driven_pendula(t, x, v, p):
    """a/size = −sin(x/size) − c v/size + s cos t, entry by entry: with time, position and velocity, and not linear."""
    return -p.size * np.sin(x / p.size) - p.drag * v + p.size * p.strength * np.cos(t)


def driven_reference(p, t, x, v, T):
    """x and v, one row each, of driven pendula after T, by DOP853 at its tightest tolerance; error below 1e-12."""
    from scipy.integrate import solve_ivp
    start = np.stack([x, v])

    def slopes(t, y):
        x, v = y.reshape(start.shape)
        return np.stack([v, driven_pendula(t, x, v, p)]).ravel()

    end = solve_ivp(slopes, (t, t + T), start.ravel(), method="DOP853", rtol=3e-14, atol=1e-14).y[:, -1]
    return end.reshape(start.shape)


@pytest.mark.parametrize(("method", "order", "clock"), cases(3, 4))
def test_halving_the_step_divides_the_error_by_two_to_the_order(lesson, draw, method, order, clock):
    step = getattr(lesson, method)
    t, dt = draw(1.4, 1.9), draw(0.05, 0.1)
    push = Drive(draw(5e-4, 1e-3), 0.0)
    _, kicked = lesson.advance(step, driven_pendula, t, np.zeros(2), np.zeros(2), dt, 1, push)
    mean = sum(weight * np.cos(t + c * dt) for c, weight in clock.items())
    # |cos| < ½ from 1.4 to 2.0, so x < ½dt² push, and the pendulum's own acceleration is as small.
    # A time that is wrong by ½dt changes the mean by 0.4 dt.
    close("gain of velocity over dt times push: is a evaluated at the right time?", kicked / (dt * push.strength),
          [mean, mean], 0.5 * dt * dt, given=f"dt = {dt:.4g} s, t = {t:.4g} s")

    check_a_nonlinear_step(lesson, draw, method)

    p = Drive(draw(0.5, 0.9), draw(0.2, 0.4))
    x, v = draw(-1.5, 1.5, 3), draw(-1.5, 1.5, 3)
    T = draw(0.4, 0.5)
    end = driven_reference(p, t, x, v, T)
    errors = []
    for n in (10, 40):
        got = np.array(lesson.advance(step, driven_pendula, t, x.copy(), v.copy(), T / n, n, p))
        # Each step has an error of ½dt² |(a, ȧ)|, |(a, ȧ)| < 3, growing by at most eᵗ: ½dt · 3 (e^0.5 − 1) < dt.
        close(f"x and v after {n} steps [rad, rad/s]", got, end, T / n)
        errors.append(np.abs(got - end).max())
    # No rate is above 1.5/s, so the next term of the expansion is below 5 dt of this one.
    # From dt = 1/20 to 1/80 s it moves the mean order by less than 5 (1/20 − 1/80)/(2 ln 2) = 0.14.
    # The reference solution's own 1e-12 moves it by 0.04, beside errors of 2e-11.
    between("order of convergence over two halvings", np.log2(errors[0] / errors[1]) / 2.0,
            order - 0.2, order + 0.2)


@pytest.mark.parametrize(("method", "share"), [
    pytest.param("implicit_euler_step", 1.0, marks=exercise(
        "1.7", points=0.5, hint=HINTS["1.7"] + "; repeat until the correction is small enough")),
    pytest.param("implicit_midpoint_step", 0.5, marks=exercise("1.8", points=0.5, hint=HINTS["1.8"]))])
def test_an_implicit_step_solves_its_own_equation_however_long_it_is(lesson, draw, method, share):
    """v⁺ = v + dt a and x⁺ = x + dt v, both evaluated at the end of the step, or at its midpoint.

    Pendula of a picometre and of a million kilometres solve it to the same digits.
    """
    drawn = [(size, longest, (2,)) for size in SIZES for longest in (0.6, 0.9)]
    for size, longest, shape in (*drawn, (1.0, 0.6, (2, 3)), (1.0, 0.6, (4, 1))):        # any shape is allowed
        dt = draw(longest - 0.3, longest)
        t, x, v = draw(1.0, 3.0), size * draw(-3.0, 3.0, shape), size * draw(-1.5, 1.5, shape)
        p = Drive(draw(0.5, 0.9), draw(1.0, 1.5), size)
        x_new, v_new = lesson.advance(getattr(lesson, method), driven_pendula, t, x, v, dt, 1, p)
        there = x + share * (x_new - x), v + share * (v_new - v)
        given = f"dt = {dt:.4g} s, pendula {size:.4g} m long"
        rest = v_new - v - dt * driven_pendula(t + share * dt, *there, p)
        # In units of the size, Newton's residual r has r′ = 1 + c dt + dt² cos x from 1 to 3.2 and r″ < dt³.
        # An error e < 2.9 shrinks at once, to ½e²dt³/r′.
        # The last correction is below 1e-12 |w|, with |w| < (|v| + 1.9 dt)/(1 + c dt) < 1.7.
        # Half a step doubles it, but there r′ < 1.9.
        close("v⁺ − v − dt a after the step [m/s]", rest, np.zeros(shape), 1e-11 * size, given)
        close("x⁺ − x − dt v after the step [m]", x_new - x - dt * there[1], np.zeros(shape), 1e-11 * size, given)
    # w = v + s dt (1 + w²) has no real root once 4 s dt (v + s dt) > 1; a half step has s dt > 1
    raises("a step without a solution", Diverged, getattr(lesson, method), runaway, 0.0, np.zeros(1), draw(0.0, 1.0, 1),
           draw(5.0, 15.0), Drive(draw(0.5, 2.0), 0.0))


@exercise("1.7", points=0.5, hint="newton_matrix(acceleration, tₙ + dt, xₙ, w, dt, p) adds dt w to xₙ; then w ← w − δ")
def test_newtons_method_has_the_matrix_of_the_end_of_the_step(lesson, draw):
    """x⁺ = y solves  y + κ y³ = x + dt v  with κ = s (t + dt)² dt²,  for the hard spring a = −s t² x³.

    Another matrix, at other times or positions, has another derivative than 1 + 3κ y²: then the error of each
    correction is more than 0.8 of the one before, or grows, and 30 corrections do not suffice.  One coordinate stays at
    rest: its correction is zero from the start, and says nothing about the others.  With κ = 1e6 each of the first
    corrections leaves two thirds of y, and some fifteen are needed.
    """
    for x, v in (*(np.insert(draw(0.5, 1.2, (2, 2)) * [[1.0], [-1.0]], place, 0.0, axis=1) for place in (0, 1, 2)),
                 draw(0.5, 1.2, (2, 1)) * [1.0, -1.0]):                  # and mirror images, whose corrections cancel
        dt = draw(0.1, 0.2)
        x_new, v_new = lesson.implicit_euler_step(hard_spring, 0.0, x, v, dt, Drive(0.0, 0.0))
        close("x and v after a step without a force", [x_new, v_new], [x + dt * v, v], 1e-14, given=f"dt = {dt:.4g} s")
        late = draw(500.0, 900.0) * dt, draw(-0.9, -0.7) * x / dt        # no time matters, but each position
        early = draw(0.4, 0.6) * dt, 0.0 * x                              # the spring is nine times as hard at the end
        for (t, v), kappa in ((late, draw(9.0, 12.0)), (early, draw(9.0, 12.0)), (early, draw(1e6, 3e6))):
            p = Drive(kappa / (dt * (t + dt)) ** 2, 0.0)
            y = np.array([cubic_root(kappa, right) for right in x + dt * v])
            x_new, v_new = lesson.implicit_euler_step(hard_spring, t, x, v, dt, p)
            # the last correction is below 1e-12 |w| with |w| < 12 m/s, and Newton squares what is left
            close("x after a step of a hard spring [m]", x_new, y, 1e-11, given=f"dt = {dt:.4g} s, t = {t:.4g} s")
            close("v after a step of a hard spring [m/s]", v_new, (y - x) / dt, 1e-10)


def hard_spring(t, x, v, p):
    return -p.strength * t * t * x * x * x


def cubic_root(kappa, right):
    """The y with y + κ y³ = right, by bisection and secants."""
    from scipy.optimize import brentq
    return brentq(lambda y: y + kappa * y**3 - right, -2.0, 2.0, xtol=1e-15)


class Web(NamedTuple):
    K: np.ndarray        # (n, n) [1/s²]
    place: np.ndarray    # (n,) where nothing pulls [m]


def web(t, x, v, p):
    return -(p.K @ (x - p.place))


@exercise("1.7", points=0.25, hint="solve(matrix, r) with the whole matrix; add velocity_round_off to the tolerance")
def test_a_step_of_implicit_euler_solves_a_linear_law_at_once_also_far_from_the_origin(lesson, draw):
    """(1 + dt² K) w = v − dt K (x − place).

    1 + dt² K = c + b S with a skew S, and b > c: neither its diagonal nor its transpose leads to the solution.
    A million kilometres off, a position rounds by 2e-7 m, and no velocity is known better than that over dt.
    """
    for n in (2, 3, 4):
        dt, upper = draw(0.1, 0.2), np.triu(draw(1.0, 2.0, (n, n)), 1)
        matrix = draw(1.0, 1.5) * np.eye(n) + draw(4.0, 6.0) * (upper - upper.T)
        K, v = (matrix - np.eye(n)) / dt**2, draw(-1.0, 1.0, n)
        for far in (0.0, 1e9):
            place = far * draw(0.5, 1.0, n)
            x = place + np.round(draw(-1.0, 1.0, n), 3)
            w = np.linalg.solve(matrix, v - dt * K @ (x - place))
            x_new, v_new = lesson.implicit_euler_step(web, 0.0, x, v, dt, Web(K, place))
            # The last correction is below 1e-12 |w| + 1e-15 |x|/dt, with |w| < 100 m/s.
            tolerance = 1e-9 + 1e-14 * far / dt
            close("v after a step of coupled bodies [m/s]", v_new, w, tolerance,
                  given=f"dt = {dt:.4g} s, {far:g} m off")
            close("x after this step, less that before [m]", x_new - x, dt * w, dt * tolerance + 4e-16 * far)


@exercise("1.7", points=0.25, hint="if the loop ends without a return, raise Diverged as the docstring says")
def test_implicit_euler_raises_diverged_when_newton_finds_no_root(lesson, draw):
    """w = v + s dt (1 + w²) has no real root once 4 s dt (v + s dt) > 1."""
    x, v, dt = draw(-1.0, 1.0, 1), draw(0.0, 1.0, 1), draw(5.0, 15.0)
    p = Drive(draw(0.5, 2.0), 0.0)
    _, w = lesson.implicit_euler_step(runaway, 0.0, x, v, 0.002 * dt, p)
    # With s dt < 0.06 and w < 2 the slope is above 0.7. The last correction is below 1e-12 |w|.
    close("w − v − s dt (1 + w²) after a short step, which has a solution [m/s]",
          w - v - 0.002 * dt * p.strength * (1.0 + w * w), [0.0], 1e-11)
    raises("a step without a solution", Diverged, lesson.implicit_euler_step, runaway, 0.0, x, v, dt, p, naming=[dt],
           thing="Newton's method did not converge at dt")


def runaway(t, x, v, p):
    return p.strength * (1.0 + v * v)


@exercise("1.9", points=1, hint="one column for each starting state: the results of a step from (1, 0) and from (0, 1)")
def test_amplification_matrix_moves_states_as_the_method_does(lesson, draw):
    omega, zeta, dt = draw(2.0, 4.0), draw(0.1, 0.4), draw(0.05, 0.15)
    for rate, damping, second in ((omega, zeta, 1.0), (omega, 0.0, 2.0**-20), (0.0, 0.0, 1.0),
                                 (omega, draw(6.0, 9.0), 2.0**20)):
        p, unit = (rate / second, damping, second * dt), np.array([[1.0, second], [1.0 / second, 1.0]])
        given = f"ω = {p[0]:.4g}/s, ζ = {damping:.4g}, dt = {p[2]:.4g} s"
        expected = expected_matrix("euler_step", rate, damping, dt)
        drift = np.array([[1.0, dt], [0.0, 1.0]])
        kick = expected - [[0.0, dt], [0.0, 0.0]]
        # round-off of numbers below 12
        close("A of a step without acceleration", lesson.amplification_matrix(drift_only, *p) / unit, drift, 3e-14,
              given)
        A = lesson.amplification_matrix(drift_then_kick, *p)
        close("A of a step that updates the position first", A / unit, kick @ drift, 3e-14, given)


def drift_only(acceleration, t, x, v, dt, p):
    return x + dt * v, v


def drift_then_kick(acceleration, t, x, v, dt, p):
    x = x + dt * v
    return x, v + dt * acceleration(t, x, v, p)


@exercise("1.10", points=1,
          hint="subtract the means of log dt and log error; divide the sum of products by the sum of squares")
def test_observed_order_is_the_slope_between_logarithms(lesson, draw):
    dts = draw(0.5, 1.0, 40) * np.resize([0.1, 1.0, 0.3, 0.03], 40)
    dts[20:25] = dts[:5]                                                 # a step may have several runs
    order, C = draw(1.0, 4.0), draw(2.0, 9.0)
    errors = C * dts**order
    # round-off of logarithms below 20, with a spread of more than 2
    close("order of a power of dt", lesson.observed_order(dts, errors), order, 1e-13,
          given=f"error = {C:.4g} dt^{order:.4g}")
    errors = errors * draw(0.5, 2.0, 40)
    slope = np.polyfit(np.log(dts), np.log(errors), 1)[0]
    close("order of a noisy series, by least squares", lesson.observed_order(dts, errors), slope, 1e-13)
    for k, small in itertools.product((0.5, -1.5, 4.0, 6.5), (1.0, 1e-40)):   # two runs, many, all sizes of steps
        for n in (2, 3, 50):
            dts = small * 0.5 ** np.arange(n)
            errors = small * C * (dts / small)**k
            far, high = np.max(np.abs(np.log(dts))), np.max(np.abs(np.log(errors)))
            # n Σ ξη − Σ ξ Σ η, with the sums of logarithms themselves, is right too: it rounds at their products
            rounded = 1e-15 * far * (high + abs(k) * far) / np.var(np.log(dts))
            close("order of a power of dt", lesson.observed_order(dts, errors), k, 1e-12 + rounded,
                  given=f"{n} steps of {small} s and less, error = {small * C:.4g} (dt/{small} s)^{k}")
    right = draw(0.5, 1.0, 4)
    for one, number in itertools.product(np.eye(4) == 1.0, (0.0, -1.0, np.nan, np.inf)):
        wrong = np.where(one, number, right)
        raises("an error that is no positive number", BadInput, lesson.observed_order, right, wrong)
        raises("a step that is no positive number", BadInput, lesson.observed_order, wrong, right)


# ---------------------------------------------------------------------------------------------- why?

@exercise("1.11", points=1,
          hint="one step of Euler goes along the tangent of a circle: how far from its centre does it end?")
def test_the_predicted_growth_is_that_of_a_run_of_euler_over_one_period(lesson, draw):
    for low, high in ((1, 1), (2, 3), (4, 7), (12, 20), (50, 90), (3000, 5000)):
        steps, omega = draw.whole(low, high), draw(1.0, 5.0)
        dt, (x, v) = 2.0 * np.pi / (omega * steps), draw(0.2, 1.0, 2)
        begin = np.hypot(x, v / omega)
        for _ in range(steps):
            x, v = x + dt * v, v - dt * omega**2 * x
        grown = np.hypot(x, v / omega) / begin
        # each step rounds twice
        close("growth of the amplitude in one period [-]", lesson.growth_per_period(steps), grown,
              1e-15 * 4.0 * steps * grown, given=f"{steps} step{'s' * (steps > 1)} per period")


@exercise("1.12", points=1, hint="from x = 1 and v = 0, one step of explicit Euler leads to x = 1 and v = −ω² dt")
def test_the_chosen_curve_grows_at_every_step_as_explicit_euler_does(lesson):
    right = choices.where("integrators", "energies_of_a_spring", lambda step, energy: np.allclose(
        energy[1:] / energy[:-1], 1.0 + OMEGA_DT**2, rtol=1e-12))
    choice("the letter of explicit Euler's curve", lesson.explicit_euler_is(), right)


@exercise("1.13", points=1, hint="begin with Verlet: what becomes of it if it drifts, kicks and drifts?")
def test_a_method_of_ones_own_is_of_second_order_keeps_energy_and_is_new(lesson, draw):
    t, p, T = draw(1.4, 1.9), Drive(draw(0.5, 0.9), 0.0), draw(0.4, 0.5)
    x, v = draw(-1.5, 1.5, 3), draw(-1.5, 1.5, 3)
    end, errors = driven_reference(p, t, x, v, T), []
    for n in (10, 40):
        got = np.array(lesson.advance(lesson.my_step, driven_pendula, t, x.copy(), v.copy(), T / n, n, p))
        close(f"x and v after {n} steps [rad, rad/s]", got, end, T / n)
        errors.append(np.abs(got - end).max())
    between("order of convergence over two halvings, if not higher", order_shown(*errors), 1.8, 2.0)

    one, table = (x[:1].copy(), v[:1].copy()), draw(-1.5, 1.5, (2, 2, 3))
    for start in ((x, 0.0 * v), (0.0 * x, v), (0.0 * x, 0.0 * v), one, tuple(table), tuple(table.reshape(2, 6, 1))):
        got = lesson.advance(lesson.my_step, driven_pendula, t, *(part.copy() for part in start), T / 40, 40, p)
        close("x and v of one body, from zeros, and of any shape, after 40 steps [rad, rad/s]", np.array(got),
              driven_reference(p, t, *start, T), T / 40)
    is_of_second_order_where_something_rests(lesson, draw)

    p = lesson.Oscillator(draw(1.0, 3.0), 0.0)
    x, v = draw(0.3, 1.0, 1), draw(0.3, 1.0, 1)
    begin = p.omega**2 * x[0]**2 + v[0]**2
    x, v = lesson.advance(lesson.my_step, lesson.oscillator_acceleration, 0.0, x, v, 0.2 / p.omega, 1000, p)
    between("energy after 1,000 steps, over that at the start", (p.omega**2 * x[0]**2 + v[0]**2) / begin, 0.98, 1.02)
    check_new(lesson, draw)


def order_shown(error, after_two_halvings):
    """The order that two errors show, at most 2.  The reference solution is known to 1e-12.

    A method of fifth order or more is as exact with the short steps: no ratio shows its order then, and 2 is granted.
    """
    return 2.0 if after_two_halvings <= 1e-12 else min(2.0, np.log2(error / after_two_halvings) / 2.0)


def is_of_second_order_where_something_rests(lesson, draw):
    """Pendula of which one swings, in each place and to either side, or which are mirror images; and before t = 0."""
    alone = [(0.0, 0.0, start) for start in nearly_zero(draw, 3, 1.0, 1.5)]
    for t, strength, start in (*alone, (-draw(1.4, 1.9), draw(0.5, 0.9), draw(1.0, 1.5, 3))):
        p, x, v, T = Drive(strength, 0.0), start, -draw(0.3, 0.6) * start, draw(0.4, 0.5)
        end = driven_reference(p, t, x, v, T)
        errors = []
        for n in (10, 40):
            got = lesson.advance(lesson.my_step, driven_pendula, t, x.copy(), v.copy(), T / n, n, p)
            errors.append(np.abs(np.array(got) - end).max())
        between("order of convergence over two halvings, if not higher", order_shown(*errors), 1.8, 2.0,
                given=f"from x = {x}, v = {v}")


def check_new(lesson, draw):
    """No other method of the lesson takes the same step: they differ by dt² or dt³ times rates of about 1/s.

    blanes_moan_step ends 3e-8 or more from the truth, so that a method of eighth order is not taken for it.  The same
    method, written otherwise, ends within Newton's 1e-12.
    """
    start, p = (draw(1.0, 2.0), draw(0.5, 1.0, 2), draw(0.5, 1.0, 2), draw(0.3, 0.4)), Drive(0.7, 0.0)
    got = np.array(lesson.my_step(driven_pendula, *start, p))
    others = {method: step_by_stages(driven_pendula, method, *start, p) for method in METHODS}
    others["blanes_moan_step"] = lesson.blanes_moan_step(driven_pendula, *start, p)
    for method, other in others.items():
        if np.abs(got - np.array(other)).max() < 1e-9:
            raise NotYet("a step of your own", "an end that no other method of the lesson has", f"that of {method}", "",
                         "no new method")
