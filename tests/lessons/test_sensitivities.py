"""Lesson 12 is right when differences have their errors, tangents are the derivatives of steps, events and impacts, and
Newton's method aims.

The truths are closed forms, most of them evaluated at complex inputs s + i h: the imaginary part over h is the
derivative, up to h² = 1e-40.
"""

import itertools
from typing import NamedTuple

import numpy as np
import pytest

from solutions.checks import BadInput, Diverged
from validate.grading.expect import NotYet, between, choice, close, instance, raises, truth
from validate.reference import choices

from .zeros import nearly_zero

exercise = pytest.mark.exercise
H = 1e-20                    # of the complex steps in these tests
# Everything drawn is below 10 in its unit.  A comparison takes a few hundred operations, each rounded by 1e-16 of that.
ROUND_OFF = 1e-11
SOLVED = 1e-9                # of implicit_euler_step, which ends its iterations at 1e-12 of the velocity
TINY = 1e-20                 # no law here has a scale
SIZES = ((1, 1), (1, 3), (2, 1), (2, 2), (3, 2), (3, 3))                 # coordinates d, inputs m
LARGER = (*SIZES, (7, 2), (2, 8))


def full(draw, shape):
    """An array of numbers of either sign, none of them near 0."""
    return draw(0.3, 1.0, shape) * np.where(draw(-1.0, 1.0, shape) < 0.0, -1.0, 1.0)


def unit(draw, d):
    """A unit vector with no entry near 0."""
    n = full(draw, d)
    return n / np.linalg.norm(n)


def across(draw, n):
    """A vector at right angles to n, from 0.1 to 3.5: the round-off along n of a very short one would be no grazing."""
    y = 0.0 * n
    while np.linalg.norm(y) < 0.1:
        y = draw(0.5, 2.0, n.size)
        y -= (y @ n) * n
    return y


def mostly_zero(draw, *shapes):
    """Arrays of these shapes, one of which is nearly zero: the others are full or all 0 in turn, then nearly zero, too.

    What is taken for zero by its sum, its product or one entry shows here.
    """
    nearly = [[y.reshape(shape) for y in nearly_zero(draw, int(np.prod(shape)))] for shape in shapes]
    for k, choices_of in enumerate(nearly):
        for number, y in enumerate(choices_of):
            rest = [np.zeros(shape) if number % 2 else full(draw, shape) for shape in shapes]
            yield *rest[:k], y, *rest[k + 1:]
    for k in range(max(map(len, nearly))):
        yield tuple(choices_of[k % len(choices_of)] for choices_of in nearly)


def slopes(function, *inputs):
    """Derivatives (…, m) of a function; an input that depends on s is a pair (value, its derivatives (…, m))."""
    def at(k):
        return [y[0] + 1j * H * np.asarray(y[1])[..., k] if isinstance(y, tuple) else y for y in inputs]
    m = next(np.shape(y[1])[-1] for y in inputs if isinstance(y, tuple))
    return np.stack([np.imag(function(*at(k))) / H for k in range(m)], axis=-1)


# ---------------------------------------------------------------------------------------------- differences

def cubic(s, p):
    return ((p[3] * s + p[2]) * s + p[1]) * s + p[0]


def wave(s, p):
    return p[0] * np.exp(p[1] * s) * np.sin(p[2] * s)


def place(s, p):
    """An array of any shape that depends on one number."""
    return p * s * s * s


def places(draw):
    """(size, s, p) for `place`: arrays of any shape, entries that are 0 or add up to 0, and s of all sizes."""
    for shape in ((2,), (1,), (2, 3), (2, 2), (1, 3), (3, 1), (1, 1), (2, 3, 2)):
        yield 1.0, draw(-2.0, -0.5), draw(-2.0, 2.0, shape)
    for shape in ((3,), (3, 2)):
        yield 1.0, 0.0, draw(-2.0, 2.0, shape)
    for p in (draw.sparse(-2.0, 2.0, 8), np.zeros(2), *nearly_zero(draw, 2), *nearly_zero(draw, 3)):
        yield 1.0, draw(-2.0, 2.0), p
    for size in (1e-8, 1e-4, 1e4, 1e8):
        yield size, draw(-2.0, 2.0), draw(-2.0, 2.0, 2)
        yield size, 0.0, draw(-2.0, 2.0, 2)


@exercise("12.1", points=0.5, hint="(f(s + h) − f(s − h)) / 2h: the distance between the two inputs is 2h")
def test_a_central_difference_of_a_cubic_is_off_by_a_sixth_of_its_third_derivative(lesson, draw):
    for h, s in ((draw(0.1, 0.5), draw(0.5, 2.0)), (draw(1.0, 2.0), draw(0.5, 2.0)), (draw(0.1, 0.5), 0.0),
                 (draw(0.1, 0.5), draw(-2.0, -0.5))):
        p = draw(0.5, 2.0, 4)
        slope = p[1] + 2.0 * p[2] * s + 3.0 * p[3] * s * s
        close("central difference of a cubic", lesson.central_difference(cubic, s, h, p), slope + h * h * p[3],
              ROUND_OFF, given=f"s = {s}, h = {h}, coefficients {p}")


@exercise("12.1", points=0.5, hint="f may return an array: subtract and divide it as a whole")
def test_a_central_difference_has_the_shape_of_its_function(lesson, draw):
    for size, s, p in places(draw):
        h = draw(0.1, 0.5)
        got = lesson.central_difference(place, size * s, size * h, p)
        close("central difference of an array, over the square of the size of s and h", np.asarray(got) / size**2,
              (3.0 * s * s + h * h) * p, ROUND_OFF, given=f"s = {size * s}, h = {size * h}, factors {p}")


@exercise("12.2", points=1, hint="set the derivative of h² |f‴|/6 + round_off |f|/h to zero: h³ = 3 round_off |f|/|f‴|")
def test_the_best_step_is_where_the_bound_is_flat(lesson, draw):
    """With f, f‴ and the round-off of all sizes: f may be 1e-12 m, and f‴ 1e12 m/s³."""
    for of_f, of_third in ((1.0, 1.0), *zip(10.0 ** np.arange(-12, 13, 3.0), 10.0 ** -np.arange(-12, 13, 3.0),
                                            strict=True), *itertools.product((1e-12, 1.0, 1e12), repeat=2)):
        for round_off in (2.2e-16, 10.0 ** draw(-9.0, -3.0)):
            value, third = of_f * draw(0.1, 9.0), of_third * draw(0.1, 9.0)
            h = float(lesson.best_step(value, third, round_off))
            given = f"f = {value}, third derivative {third}, round-off {round_off}"
            between("best step, a number above zero", h, 1e-16, 1e10, given=given)
            close("slope of the truncation error over that of the round-off [-]",
                  (h * third / 3.0) / (round_off * value / h**2), 1.0, ROUND_OFF, given=given)


@exercise("12.2", points=0.5, hint="only the sizes of f and of f‴ count: take np.abs of both")
def test_the_best_step_is_the_same_for_either_sign(lesson, draw):
    for size, other_size in itertools.product((1e-12, 1e-3, 1.0, 1e12), repeat=2):
        value, third, round_off = size * draw(0.1, 9.0), other_size * draw(0.1, 9.0), 10.0 ** draw(-15.0, -3.0)
        h = (3.0 * round_off * value / third) ** (1.0 / 3.0)
        for sign, other in ((1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)):
            close("best step over what it should be [-]", lesson.best_step(sign * value, other * third, round_off) / h,
                  1.0, ROUND_OFF, given=f"f = {sign * value}, third derivative {other * third}, round-off {round_off}")


@exercise("12.2", points=0.5, hint="where f‴ is 0 there is no truncation error: return np.inf")
def test_the_best_step_of_a_parabola_is_infinite(lesson, draw):
    """It is finite for the smallest third derivative that is not 0."""
    for size in (1.0, -1.0, 1e-12, -1e-12, 1e12, -1e12):
        value, round_off = size * draw(0.1, 9.0), 10.0 ** draw(-15.0, -3.0)
        h = float(lesson.best_step(value, 0.0, round_off))
        truth("the best step is infinite where the third derivative is 0", h == np.inf, True, given=f"f = {value}")
        for small in (1.0, 1e-12, 1e-30, 1e-100):
            third = small * draw(0.1, 9.0)
            h = float(lesson.best_step(value, third, round_off))
            between("best step times ∛|f‴|, where the third derivative is not 0", h * np.cbrt(third), 1e-10, 1e4,
                    given=f"f = {value}, third derivative {third}")


@exercise("12.3", points=0.5, hint="np.imag(f(s + 1j * h, p)) / h: no difference, so no digits are lost")
def test_a_complex_step_gives_all_digits(lesson, draw):
    for h, s in ((1e-20, draw(0.5, 1.5)), (1e-100, draw(0.5, 1.5)), (1e-20, 0.0), (1e-20, draw(-1.5, -0.5))):
        p = draw(0.5, 1.5, 3)
        slope = p[0] * np.exp(p[1] * s) * (p[1] * np.sin(p[2] * s) + p[2] * np.cos(p[2] * s))
        close("derivative by a complex step", lesson.complex_step(wave, s, h, p), slope, ROUND_OFF,
              given=f"s = {s}, h = {h}, parameters {p}")


@exercise("12.3", points=0.5, hint="divide the imaginary part by h; f may return an array")
def test_a_long_complex_step_of_a_cubic_is_off_by_the_negative_of_a_difference(lesson, draw):
    for size, s, p in places(draw):
        h = draw(0.1, 0.5)
        got = lesson.complex_step(place, size * s, size * h, p)
        close("complex step of an array, over the square of the size of s and h", np.asarray(got) / size**2,
              (3.0 * s * s - h * h) * p, ROUND_OFF, given=f"s = {size * s}, h = {size * h}, factors {p}")


# ---------------------------------------------------------------------------------------------- steps

class Spring(NamedTuple):
    """A spring and a damper that are neither linear nor symmetric, and a load that swings; all but its rate inputs."""
    k: float                 # [1/s²]
    c: float                 # [1/s]
    load: np.ndarray         # (d,) [m/s²]
    rate: float              # of the load [1/s]; at t and at −t, the load differs
    S: np.ndarray            # (d, d) [-]
    G: np.ndarray            # (d, d) [-]
    k_s: np.ndarray          # (m,) derivatives of k with respect to the inputs
    c_s: np.ndarray          # (m,) of c
    load_s: np.ndarray       # (d, m) of the load


def pull(t, x, v, p):
    """Acceleration (d,) of a Spring."""
    return p.load * np.cos(p.rate * t + 1.0) - p.k * (p.S @ x + (x @ x) * x) - p.c * (p.G @ v + (v @ v) * v)


def pull_derivatives(t, x, v, p):
    """Derivatives (a_x, a_v, a_s) of pull."""
    one = np.eye(x.size)
    a_x = -p.k * (p.S + (x @ x) * one + 2.0 * np.outer(x, x))
    a_v = -p.c * (p.G + (v @ v) * one + 2.0 * np.outer(v, v))
    a_s = (np.cos(p.rate * t + 1.0) * p.load_s - np.outer(p.S @ x + (x @ x) * x, p.k_s)
           - np.outer(p.G @ v + (v @ v) * v, p.c_s))
    return a_x, a_v, a_s


def spring(draw, d, m):
    """(p, x, v, dx, dv): a drawn Spring, and a state that depends on all inputs."""
    near_one = [np.eye(d) + draw(-0.4, 0.4, (d, d)) for _ in range(2)]
    p = Spring(draw(0.5, 3.0), draw(0.2, 1.0), draw(-2.0, 2.0, d), draw(1.0, 3.0), *near_one,
               draw(-1.0, 1.0, m), draw(-1.0, 1.0, m), draw(-1.0, 1.0, (d, m)))
    return p, draw(-1.0, 1.0, d), draw(-1.0, 1.0, d), draw(-1.0, 1.0, (d, m)), draw(-1.0, 1.0, (d, m))


def springs(draw):
    """Springs as of `spring` of all sizes, and some of which much is 0: terms of the law, the state, the tangents."""
    for d, m in SIZES:
        yield spring(draw, d, m)
    for d, m in LARGER:
        yield spring(draw.sparse, d, m)
    for d, m in ((1, 1), (3, 2)):
        p, x, v, dx, dv = spring(draw, d, m)
        yield p, x, v, np.zeros((d, m)), np.zeros((d, m))
        yield p, np.zeros(d), np.zeros(d), dx, dv
        yield p._replace(k_s=np.zeros(m), c_s=np.zeros(m), load_s=np.zeros((d, m))), x, v, dx, dv
    for d, m in ((3, 1), (2, 2)):
        p, _, _, full_dx, full_dv = spring(draw, d, m)
        q = p._replace(k_s=np.zeros(m), c_s=np.zeros(m))
        for x, v, load, dx, dv, load_s in mostly_zero(draw, (d,), (d,), (d,), (d, m), (d, m), (d, m)):
            yield q._replace(load=load, load_s=load_s), x, v, dx, dv
    rest, still = np.zeros(2), np.zeros((2, 2))
    for S, G in mostly_zero(draw, (2, 2), (2, 2)):                       # at rest, a_x and a_v are −k S and −c G
        yield q._replace(S=S, G=G, load=rest, load_s=still), rest, rest, full_dx, full_dv
    for k_s, c_s in mostly_zero(draw, (2,), (2,)):
        yield p._replace(k_s=k_s, c_s=c_s, load_s=still), draw(0.5, 1.0, 2), draw(0.5, 1.0, 2), still, still


def other_units(draw):
    """Springs as of `spring` in units of other sizes: the Spring and its state, then the units of x, time and s."""
    for metre, second, unit_of_s in ((1e-9, 1.0, 1.0), (1.0, 1.0, 1e-15), (1.0, 1.0, 1e12), (1e-6, 1e3, 1e-6),
                                     (1.0, 1e9, 1.0)):
        p, x, v, dx, dv = spring(draw, 2, 3)
        p = p._replace(k=p.k / second**2, c=p.c / second, load=metre / second**2 * p.load, rate=p.rate / second,
                       k_s=unit_of_s / second**2 * p.k_s, c_s=unit_of_s / second * p.c_s,
                       load_s=unit_of_s * metre / second**2 * p.load_s)
        speed = metre / second
        yield p, metre * x, speed * v, unit_of_s * metre * dx, unit_of_s * speed * dv, metre, second, unit_of_s


def times_and_steps(draw):
    """(t, dt) without end: before and after t = 0, soon and late, and every seventh step a very short one."""
    for t, short in itertools.cycle(itertools.product((1.0, -1.0, 100.0, -100.0, 0.0), np.arange(7) == 6)):
        yield t * draw(0.3, 1.0), (1e-6 if short else 1.0) * draw(0.1, 0.4)


def moved(p, x, v, dx, dv, k):
    """(p, x, v) at a complex input: an imaginary change of input k."""
    change = 1j * H
    return (p._replace(k=p.k + change * p.k_s[k], c=p.c + change * p.c_s[k], load=p.load + change * p.load_s[:, k]),
            x + change * dx[:, k], v + change * dv[:, k])


def tangents(step, t, p, x, v, dx, dv, dt):
    """(x, v, dx, dv) after a step (t, p, x, v, dt) → (x, v), which is evaluated at complex inputs."""
    columns = [[np.imag(y) / H for y in step(t, *moved(p, x, v, dx, dv, k), dt)] for k in range(dx.shape[1])]
    return (*map(np.real, step(t, p, x, v, dt)), *(np.stack(y, axis=1) for y in zip(*columns, strict=True)))


def explicit(t, p, x, v, dt):
    """Velocity first, then position."""
    v = v + dt * pull(t, x, v, p)
    return x + dt * v, v


def implicit(t, p, x, v, dt):
    """The velocity at the end of the step by Newton's method at complex inputs, with the exact matrix.

    After a correction by 1e-8 of it, and of its derivatives, the next one is round-off.
    """
    w, last = v + 0j, False
    for _ in range(12):
        a_x, a_v, _ = pull_derivatives(t + dt, x + dt * w, w, p)
        change = np.linalg.solve(np.eye(x.size) - dt * a_v - dt * dt * a_x,
                                 w - v - dt * pull(t + dt, x + dt * w, w, p))
        w = w - change
        if last:
            break
        last = all(np.abs(by).max() <= 1e-8 * np.abs(of).max() for by, of in ((change.real, w.real),
                                                                              (change.imag, w.imag)))
    return x + dt * w, w


def four(result):
    """(x, v, dx, dv) that a step returned."""
    instance("what the step returns: (x, v, dx, dv)", result, tuple)
    if len(result) != 4:
        raise NotYet("what the step returns", "4 values: x, v, dx, dv", f"{len(result)} values", "")
    return result


def close_tangents(result, expected, tolerance, sizes, given):
    """sizes: of x, v, dx and dv."""
    names = "position x [m]", "velocity v [m/s]", "sensitivity dx", "sensitivity dv"
    for name, got, right, size in zip(names, four(result), expected, sizes, strict=True):
        close(f"{name} after a step", got, right, tolerance * size, given=given)


def check_tangents(draw, step, exact, tolerance):
    """Compare a step of a lesson with the derivatives of the exact step, which is evaluated at complex inputs."""
    cases = itertools.chain(((*case, 1.0, 1.0, 1.0) for case in springs(draw)), other_units(draw))
    for (p, x, v, dx, dv, metre, second, unit_of_s), (t, dt) in zip(cases, times_and_steps(draw), strict=False):
        t, dt, speed = second * t, second * dt, metre / second
        got = step(pull, pull_derivatives, t, x, v, dx, dv, dt, p)
        close_tangents(got, tangents(exact, t, p, x, v, dx, dv, dt), tolerance,
                       (metre, speed, unit_of_s * metre, unit_of_s * speed),
                       given=f"x = {x} m, v = {v} m/s, inputs: {dx.shape[1]}, t = {t} s, dt = {dt} s")


def oscillation(t, x, v, k, c):
    """State (2,) of ẍ = −k x − c ẋ at t, in closed form; k and c may be complex."""
    decay = 0.5 * c
    omega = np.sqrt(k - decay * decay + 0j)
    b = (v + decay * x) / omega
    cosine, sine, fade = np.cos(omega * t), np.sin(omega * t), np.exp(-decay * t)
    y = fade * (x * cosine + b * sine)
    return np.array([y, -decay * y + fade * omega * (b * cosine - x * sine)])


class Linear(NamedTuple):
    """A spring and a damper per unit of mass."""
    k: float                 # [1/s²]
    c: float                 # [1/s]
    k_s: np.ndarray          # (m,)
    c_s: np.ndarray          # (m,)


def linear(t, x, v, p):
    return -p.k * x - p.c * v


def linear_derivatives(t, x, v, p):
    one = np.eye(x.size)
    return -p.k * one, -p.c * one, -np.outer(x, p.k_s) - np.outer(v, p.c_s)


def damped(draw, m):
    """(p, x, v, dx, dv): a drawn oscillator, all of which depends on the inputs."""
    p = Linear(draw(2.0, 9.0), draw(0.2, 1.0), draw(-1.0, 1.0, m), draw(-1.0, 1.0, m))
    return p, draw(0.5, 2.0, 1), draw(-2.0, 2.0, 1), draw(-1.0, 1.0, (1, m)), draw(-1.0, 1.0, (1, m))


def run(step, p, x, v, dx, dv, dt, steps):
    """(x, v, dx, dv) after so many steps of a lesson."""
    for n in range(steps):
        x, v, dx, dv = four(step(linear, linear_derivatives, n * dt, x, v, dx, dv, dt, p))
    return np.asarray(x), np.asarray(v), np.asarray(dx), np.asarray(dv)


def errors_of_tangents(step, draw):
    """Errors of (dx, dv) at t = 1 s after 400 and after 800 steps."""
    p, x, v, dx, dv = damped(draw, 3)
    right = slopes(oscillation, 1.0, (x[0], dx[0]), (v[0], dv[0]), (p.k, p.k_s), (p.c, p.c_s))
    return [np.concatenate(run(step, p, x, v, dx, dv, 1.0 / steps, steps)[2:]) - right for steps in (400, 800)]


@exercise("12.4", points=1.5,
          hint="differentiate both lines: dv gains dt (a_x dx + a_v dv + a_s) with the old dx and dv; dx gains dt times"
               " the new dv")
def test_the_tangents_are_the_derivatives_of_the_step(lesson, draw):
    check_tangents(draw, lesson.tangent_step, explicit, ROUND_OFF)


@exercise("12.4", points=0.5,
          hint="the tangents of many steps approach the derivatives of the motion, with an error proportional to dt")
def test_the_tangents_of_an_oscillator_approach_those_of_its_motion(lesson, draw):
    """Each error is C dt + O(dt²), so the second is half of the first; terms of dt² are below 1e-2 of C dt.

    With k ≤ 9, |C| is below k² = 81 in all entries.
    """
    once, twice = errors_of_tangents(lesson.tangent_step, draw)
    size = np.abs(once).max()
    between("largest error of the tangents after 400 steps", size, 0.0, 81.0 / 400.0)
    between("error after 800 steps over that after 400 [-]", np.abs(twice).max() / size, 0.45, 0.55)


class Drive(NamedTuple):
    """A drive that becomes stronger with the velocity."""
    strength: float


def runaway(t, x, v, p):
    """No w solves w = v + dt s (1 + w²) once 4 s dt (v + s dt) > 1."""
    return p.strength * (1.0 + v * v)


def runaway_derivatives(t, x, v, p):
    return np.zeros((x.size, x.size)), np.diag(2.0 * p.strength * v), np.zeros((x.size, 2))


def after_three_implicit_steps(x, v, k, c, dt):
    """State (2,) of ẍ = −k x − c ẋ after three steps of implicit Euler; all but dt may be complex."""
    return np.linalg.matrix_power(np.linalg.inv(np.eye(2) - dt * np.array([[0.0, 1.0], [-k, -c]])), 3) @ (x, v)


@exercise("12.5", points=1,
          hint="(1 − dt a_v − dt² a_x) dvₙ₊₁ = dvₙ + dt (a_x dxₙ + a_s), with derivatives at t + dt and the new x, v")
def test_the_tangents_are_the_derivatives_of_the_implicit_step(lesson, draw):
    check_tangents(draw, lesson.tangent_implicit_step, implicit, SOLVED)
    for d in (1, 2):
        p, dt, x, v = Drive(draw(0.5, 2.0)), draw(5.0, 15.0), draw(-1.0, 1.0, d), draw(0.0, 1.0, d)
        raises("a step without a solution", Diverged, lesson.tangent_implicit_step, runaway, runaway_derivatives, 0.0,
               x, v, draw(-1.0, 1.0, (d, 2)), draw(-1.0, 1.0, (d, 2)), dt, p, naming=[dt],
               thing="Newton's method did not converge at dt")


@exercise("12.5", points=1, hint="solve one linear system for dvₙ₊₁, with a_x, a_v and a_s at the new x and v;"
                                 " then dxₙ₊₁ = dxₙ + dt dvₙ₊₁")
def test_the_tangents_of_an_implicit_step_do_not_explode(lesson, draw):
    """The step of a linear law is a matrix, y ← (1 − dt B)⁻¹ y, and so is that of its tangents.

    Two further inputs are relative changes of k and c.  ‖B‖ dt is up to 1e5, which costs as many digits.
    """
    for k, dt in ((draw(1.0, 4.0), 0.1), (1e6 * draw(0.5, 1.0), 0.1), (1e10 * draw(0.5, 1.0), 1.0)):
        c, y = draw(0.5, 2.0), draw(0.5, 2.0, 2)
        p = Linear(k, c, np.array([0.0, 0.0, k, 0.0]), np.array([0.0, 0.0, 0.0, c]))
        right = slopes(after_three_implicit_steps, *zip((*y, k, c), np.diag((1.0, 1.0, k, c)), strict=True), dt)
        got = run(lesson.tangent_implicit_step, p, y[:1], y[1:], *np.eye(2, 4)[:, None, :], dt, 3)
        close("(dx, dv) after three steps, for the inputs x, v, log k and log c", np.concatenate(got[2:]), right, 1e-6,
              given=f"k = {k} 1/s², c = {c} 1/s, dt = {dt} s")
    once, twice = errors_of_tangents(lesson.tangent_implicit_step, draw)
    size = np.abs(once).max()
    between("largest error of the tangents after 400 steps", size, 0.0, 81.0 / 400.0)
    between("error after 800 steps over that after 400 [-]", np.abs(twice).max() / size, 0.45, 0.55)


# ---------------------------------------------------------------------------------------------- events

def fall_time(phi, u, a):
    """First τ > 0 with φ + u τ + ½ a τ² = 0, for φ > 0 and a ≤ 0; complex numbers allowed."""
    return 2.0 * phi / (np.sqrt(u * u - 2.0 * a * phi) - u)


def arrival(n, x, v, a, c):
    """When such a flight reaches the plane n · x = c."""
    return fall_time(n @ x - c, n @ v, n @ a)


def dropped(draw, d, m):
    """A flight at constant acceleration to an oblique plane n · x = c: (n, x, v, a, c, X, V, c_s), and its τ."""
    n = unit(draw, d)
    sideways = draw(-2.0, 2.0, d)
    sideways -= (sideways @ n) * n
    a = -draw(5.0, 9.0) * n + sideways
    c = draw(-1.0, 1.0)
    x, v = (c + draw(0.5, 2.0)) * n + sideways, draw(-2.0, 2.0, d)
    X, V, c_s = draw(-1.0, 1.0, (d, m)), draw(-1.0, 1.0, (d, m)), draw(-1.0, 1.0, m)
    return (n, x, v, a, c, X, V, c_s), arrival(n, x, v, a, c)


def dropped_plainly(draw, d, m):
    """The same with much that is 0: n along an axis, perhaps no acceleration, and few or no inputs that matter."""
    n = np.eye(d)[draw.whole(0, d - 1)] * (2.0 * draw.whole(0, 1) - 1.0)
    a, c = -draw.sparse(5.0, 9.0) * n, draw.sparse(-1.0, 1.0)
    x, v = (c + draw(0.5, 2.0)) * n, draw.sparse(-2.0, 2.0, d)
    v -= (n @ v + draw(0.5, 2.0)) * n
    X, V, c_s = draw.sparse(-1.0, 1.0, (d, m)), draw.sparse(-1.0, 1.0, (d, m)), draw.sparse(-1.0, 1.0, m)
    return (n, x, v, a, c, X, V, c_s), arrival(n, x, v, a, c)


def drops(draw):
    """(numbers, flight, τ) of flights of both kinds and all sizes, and of two that no input moves.

    numbers: how further numbers of such a flight are drawn, with many that are 0 or without.
    """
    for d, m in SIZES:
        yield draw, *dropped(draw, d, m)
    for d, m in LARGER:
        yield draw.sparse, *dropped_plainly(draw, d, m)
    for d, m in ((1, 1), (3, 2)):
        flight, tau = dropped(draw, d, m)
        yield draw, (*flight[:5], np.zeros((d, m)), np.zeros((d, m)), np.zeros(m)), tau


def reaches(gap_x, gap_v, x, v, a, level):
    """The τ near 0 of g = gap_x · x + gap_v · v − level = 0, of a flight that is there at τ = 0."""
    phi, rate, bend = gap_x @ x + gap_v @ v - level, gap_x @ v + gap_v @ a, gap_x @ a
    return -2.0 * phi / (rate + np.sign(rate.real) * np.sqrt(rate * rate - 2.0 * bend * phi + 0j))


def with_rate(draw, y, z, by_y, by_z):
    """(by_y, by_z), of which one is changed: y · by_y + z · by_z is from 0.5 to 2, with either sign."""
    change = draw(0.5, 2.0) * (2.0 * draw.whole(0, 1) - 1.0) - y @ by_y - z @ by_z
    return (by_y + change / (y @ y) * y, by_z) if y.any() else (by_y, by_z + change / (z @ z) * z)


def events(draw):
    """(gap_x, gap_v, gap_s, v, a, dx, dv, unit of s) of events, in which some arrays are nearly zero."""
    for d, m in ((2, 2), (3, 1)):
        for gap_s, dx, dv in mostly_zero(draw, (m,), (d, m), (d, m)):
            gap_x, gap_v, v, a = full(draw, (4, d))
            yield gap_x, gap_v, gap_s, *with_rate(draw, gap_x, gap_v, v, a), dx, dv, 1.0
        of_s = full(draw, m), full(draw, (d, m)), full(draw, (d, m))
        for y, z in mostly_zero(draw, (d,), (d,)):
            v, a = with_rate(draw, y, z, *full(draw, (2, d)))
            yield y, z, of_s[0], v, a, *of_s[1:], 1.0
            gap_x, gap_v = with_rate(draw, y, z, *full(draw, (2, d)))
            yield gap_x, gap_v, of_s[0], y, z, *of_s[1:], 1.0
        for of_gap, metre, unit_of_s in ((1.0, 1.0, 1e-15), (1.0, 1.0, 1e12), (1e-15, 1.0, 1.0), (1e12, 1.0, 1.0),
                                         (1.0, 1e-12, 1.0), (1.0, 1e12, 1.0)):
            gap_s, dx, dv = (unit_of_s * by for by in of_s)
            yield (of_gap / metre * gap_x, of_gap / metre * gap_v, of_gap * gap_s, metre * y, metre * z, metre * dx,
                   metre * dv, unit_of_s)


@exercise("12.6", points=1,
          hint="dtau = −(g_x dx + g_v dv + g_s)/(g_x · v + g_v · a): the change of g at a fixed time, over its rate")
def test_the_time_of_an_impact_on_an_oblique_plane_moves_with_all_inputs(lesson, draw):
    """In closed form: τ is the root of a quadratic equation, whose coefficients depend on the inputs."""
    for _, (n, x, v, a, c, X, V, c_s), tau in drops(draw):
        d, m = X.shape
        expected = slopes(arrival, n, (x, X), (v, V), a, (c, c_s))
        got = lesson.event_time_sensitivity(n, 0.0 * n, -c_s, v + tau * a, a, X + tau * V, V)
        close("dtau of an impact", got, expected, ROUND_OFF, given=f"coordinates: {d}, inputs: {m}, n = {n}")
    for gap_x, gap_v, gap_s, v, a, dx, dv, unit_of_s in events(draw):
        # per unit, because the square of a complex step of 1e-20 times a unit of 1e12 does not vanish
        expected = slopes(reaches, gap_x, gap_v, (0.0 * v, dx / unit_of_s), (v, dv / unit_of_s), a,
                          (gap_v @ v, -gap_s / unit_of_s))
        got = lesson.event_time_sensitivity(gap_x, gap_v, gap_s, v, a, dx, dv)
        close("dtau of an event, per unit of the inputs", np.asarray(got) / unit_of_s, expected, ROUND_OFF,
              given=f"gap_x = {gap_x}, gap_v = {gap_v}, gap_s = {gap_s}, v = {v} m/s, a = {a} m/s²")


def crossing(k, x, v, level, by_x, by_v):
    """When an oscillator first crosses the line by_x x + by_v v = level, by Newton's method on the closed form."""
    tau = 0.5 / np.sqrt(np.real(k)) + 0j
    for _ in range(30):
        y, w = oscillation(tau, x, v, k, 0.0)
        tau = tau - (by_x * y + by_v * w - level) / (by_x * w - by_v * k * y)
    return tau


@exercise("12.6", points=0.5, hint="an event may depend on the velocity: g_v dv in the numerator, g_v · a in the rate")
def test_the_time_at_which_a_velocity_is_reached_moves_too(lesson, draw):
    for m in (1, 2, 3):
        k, x, v, level = draw(2.0, 9.0), draw(0.5, 1.0), draw(0.2, 1.0), draw(-0.2, 0.2)
        by_x, by_v = draw(-0.3, 0.3), draw(0.5, 1.0)
        if m == 1:                                       # the same event, with a gap that opens
            by_x, by_v, level = -by_x, -by_v, -level
        rates = [draw(-1.0, 1.0, m) for _ in range(4)]
        tau = float(np.real(crossing(k, x, v, level, by_x, by_v)))
        state = np.real(oscillation(tau, x, v, k, 0.0))
        inputs = [*zip((k, x, v, level), rates, strict=True)]
        dx, dv = slopes(oscillation, tau, inputs[1], inputs[2], inputs[0], 0.0)
        got = lesson.event_time_sensitivity(np.array([by_x]), np.array([by_v]), -rates[3], state[1:], -k * state[:1],
                                            dx[None], dv[None])
        close("dtau of an event in position and velocity", got, slopes(crossing, *inputs, by_x, by_v), 1e-9,
              given=f"g = {by_x} x + {by_v} v − {level}, {m} inputs")


def slow_events(draw, shares):
    """(gap_x, gap_v, v, a, rate): the rate is such a share of 1e-12 times the sizes of its terms, and has no round-off.

    Only two terms are not 0, both in gap_x · v, or both in gap_v · a, or one in each.  They are products with a power
    of two, and the float numbers are so close together that their sum is exact.  Other entries of gap_x and v are large
    where the other factor is 0: the sizes are those of the terms, not products of lengths.
    """
    scales = itertools.cycle(itertools.product((1.0, 1e6, TINY), (2.0**-50, 1.0, 2.0**60)))
    for d, share, sign in itertools.product((2, 3), shares, (1.0, -1.0)):
        for first, second in ((0, d - 1), (d, 2 * d - 1), (d - 1, d)):
            size, power = next(scales)
            gap, motion = np.zeros(2 * d), np.zeros(2 * d)
            gap[[first, second]] = power, -power
            term = sign * size * draw(1.0, 2.0)
            motion[[first, second]] = term, term * (1.0 - 2e-12 * share)
            idle = [k for k in range(2 * d) if k not in (first, second)]
            motion[idle[0]], gap[idle[-1]] = 9.0 * size, 9.0 * power if len(idle) > 1 else 0.0
            yield gap[:d], gap[d:], motion[:d], motion[d:], power * (motion[first] - motion[second])


@exercise("12.6", points=0.5,
          hint="compare |rate| with GRAZING times the sum of the sizes of its terms: Σ |g_x,i v_i| + Σ |g_v,i a_i|")
def test_an_event_that_only_grazes_is_refused(lesson, draw):
    dtau_of, thing = lesson.event_time_sensitivity, "rate of the event"
    for d in (2, 3):
        n, a, still, dx = unit(draw, d), draw(-5.0, 5.0, d), np.zeros(d), draw(-1.0, 1.0, (d, 2))
        along = across(draw, n)
        for size in (1.0, 1e6, TINY):
            raises("an event whose rate is zero but for round-off", BadInput, dtau_of, n, still, np.zeros(2),
                   size * along, size * a, dx, dx, thing=thing)
            for slow in (1e-9, 1e-3):
                v = size * (along - slow * n)
                close("dtau of a slow event times its rate",
                      np.asarray(dtau_of(n, still, np.zeros(2), v, size * a, dx, dx)) * (n @ v), -n @ dx, 1e-5,
                      given=f"v = {v} m/s, n = {n}")
        raises("an event in which nothing moves", BadInput, dtau_of, n, still, np.zeros(2), still, a, dx, dx,
               naming=[0.0], thing=thing)
        raises("an event in the velocity without acceleration along it", BadInput, dtau_of, still, n, np.zeros(2),
               draw(-1.0, 1.0, d), along, dx, dx, thing=thing)
    for gap_x, gap_v, v, a, rate in slow_events(draw, (*draw.within(), 0.0)):
        dx = np.zeros((v.size, 2))
        raises("an event with a rate of just below 1e-12 of the sizes of its terms", BadInput, dtau_of, gap_x, gap_v,
               np.ones(2), v, a, dx, dx, naming=[rate], thing=thing)
    for gap_x, gap_v, v, a, rate in slow_events(draw, (*draw.beyond(3.0), 1e2, 1e5)):
        dx, gap_s = np.zeros((v.size, 2)), draw(0.5, 1.0, 2)
        close("dtau times the rate of an event, above 1e-12 of the sizes of its terms",
              np.asarray(dtau_of(gap_x, gap_v, gap_s, v, a, dx, dx)) * rate, -gap_s, ROUND_OFF,
              given=f"gap_x = {gap_x}, gap_v = {gap_v}, v = {v} m/s, a = {a} m/s²")


# ---------------------------------------------------------------------------------------------- impacts

def after_jump(time, tau, x, v, a, a_new, R, kick):
    """State (2, d) at a fixed time: a flight until τ, the jump v⁺ = R v⁻ + kick, and a flight with a_new."""
    left = time - tau
    place, speed = x + tau * v + 0.5 * tau * tau * a, R @ (v + tau * a) + kick
    return np.array([place + left * speed + 0.5 * left * left * a_new, speed + left * a_new])


def behind(time, n, x, v, a, c, a_new, R):
    """State (2, d) at a fixed time: a flight to the plane n · x = c, the jump v⁺ = R v⁻, and a flight with a_new."""
    return after_jump(time, arrival(n, x, v, a, c), x, v, a, a_new, R, 0.0)


UNITS = (1.0, 1e-15), (1.0, 1e12), (1e-12, 1.0), (1e12, 1.0)             # of length and of the inputs


def jumps(draw):
    """(dtau, dx, dv, v, a, v_new, a_new, R_v, R_s, unit of length, unit of s) of impacts; some arrays are nearly zero.
    """
    for d, m in ((2, 2), (3, 1)):
        shapes = (m,), (d, m), (d, m), (d,), (d,), (d,), (d,), (d, d), (d, m)
        for arrays in mostly_zero(draw, *shapes):
            yield *arrays, 1.0, 1.0
        for metre, unit_of_s in UNITS:
            dtau, dx, dv, v, a, v_new, a_new, R_v, R_s = (full(draw, shape) for shape in shapes)
            both = metre * unit_of_s
            yield (unit_of_s * dtau, both * dx, both * dv, metre * v, metre * a, metre * v_new, metre * a_new, R_v,
                   both * R_s, metre, unit_of_s)


@exercise("12.7", points=1,
          hint="dx⁺ = dx⁻ + (v⁻ − v⁺) dtauᵀ;  dv⁺ = R_v (dv⁻ + a⁻ dtauᵀ) + R_s − a⁺ dtauᵀ, with np.outer for y dtauᵀ")
def test_after_a_jump_the_sensitivities_are_those_at_a_fixed_time(lesson, draw):
    """The jump v⁺ = R v⁻ is any matrix that depends on the inputs, and the acceleration changes at the impact, too."""
    for numbers, (n, x, v, a, c, X, V, c_s), tau in drops(draw):
        d, m = X.shape
        R, R_by, a_new = numbers(-1.0, 1.0, (d, d)), numbers(-1.0, 1.0, (d, d, m)), numbers(-9.0, 9.0, d)
        expected = slopes(behind, tau, n, (x, X), (v, V), a, (c, c_s), a_new, (R, R_by))
        dtau = slopes(arrival, n, (x, X), (v, V), a, (c, c_s))
        v_old = v + tau * a
        R_s = np.einsum("ijk,j->ik", R_by, v_old)
        dx, dv = lesson.saltation(dtau, X + tau * V, V, v_old, a, R @ v_old, a_new, R, R_s)
        given = f"coordinates: {d}, inputs: {m}, dtau = {dtau}"
        close("dx after the impact", dx, expected[0], 1e-10, given=given)
        close("dv after the impact", dv, expected[1], 1e-10, given=given)
    for dtau, dx, dv, v, a, v_new, a_new, R_v, R_s, metre, unit_of_s in jumps(draw):
        expected = slopes(after_jump, 0.0, (0.0, dtau), (0.0 * v, dx), (v, dv), a, a_new, R_v, (v_new - R_v @ v, R_s))
        got = lesson.saltation(dtau, dx, dv, v, a, v_new, a_new, R_v, R_s)
        for name, by, right in zip(("dx", "dv"), got, expected, strict=True):
            unit_of_by = metre * unit_of_s
            close(f"{name} after an impact, per unit of the inputs", np.asarray(by) / unit_of_by, right / unit_of_by,
                  1e-10, given=f"dtau = {dtau}, v = {v} m/s, a = {a} m/s², v_new = {v_new} m/s, a_new = {a_new} m/s²")


@exercise("12.7", points=1,
          hint="a ball from higher meets the floor later: dx⁺ gains (v⁻ − v⁺) dtau, which makes −e of 1")
def test_a_ball_that_is_dropped_from_higher_is_lower_just_after_its_bounce(lesson, draw):
    """With τ = √(2h/g):  x(t) = e g τ (t − τ) − ½ g (t − τ)²;  inputs are h and e."""
    for e in (0.0, 1.0, draw(0.3, 0.9)):
        h, g = draw(0.5, 2.0), 9.81
        tau = np.sqrt(2.0 * h / g)
        v, a = np.array([-g * tau]), np.array([-g])
        dx, dv = lesson.saltation(np.array([1.0 / (g * tau), 0.0]), np.array([[1.0, 0.0]]), np.zeros((1, 2)), v, a,
                                  -e * v, a, np.array([[-e]]), np.array([[0.0, g * tau]]))
        given = f"h = {h} m, e = {e}"
        close("∂x/∂h and ∂x/∂e just after the bounce", dx, [[-e, 0.0]], ROUND_OFF, given=given)
        close("∂v/∂h and ∂v/∂e just after the bounce", dv, [[(1.0 + e) / tau, g * tau]], ROUND_OFF, given=given)


def reflected(n, e):
    """The matrix of an impact on a plane: 1 − (1 + e) n nᵀ."""
    return np.eye(n.size) - (1.0 + e) * np.outer(n, n)


@exercise("12.8", points=1,
          hint="v − (1 + e)(v · n) n; then dtau with gap_x = n, and saltation with R_v, R_s and a before and after")
def test_a_bounce_has_the_sensitivities_of_a_flight_and_its_reflection(lesson, draw):
    for numbers, (n, x, v, a, c, X, V, c_s), tau in drops(draw):
        d, m = X.shape
        e, e_s = draw(0.2, 0.9), numbers(-1.0, 1.0, m)
        R = reflected(n, e), -np.multiply.outer(np.outer(n, n), e_s)
        expected = slopes(behind, tau, n, (x, X), (v, V), a, (c, c_s), a, R)
        v_old = v + tau * a
        got_v, dx, dv = lesson.bounce(v_old, a, X + tau * V, V, n, e, -c_s, e_s)
        given = f"coordinates: {d}, inputs: {m}, n = {n}, e = {e}"
        close("velocity after the bounce [m/s]", got_v, reflected(n, e) @ v_old, ROUND_OFF, given=given)
        close("dx after the bounce", dx, expected[0], 1e-10, given=given)
        close("dv after the bounce", dv, expected[1], 1e-10, given=given)


def impacts(draw):
    """(v, a, dx, dv, n, e, gap_s, e_s) of impacts, the unit of length and that of s.

    Some arrays are nearly zero, and e is anywhere from 0 to 1.
    """
    restitutions = itertools.cycle((0.0, 1e-9, 1e-6, 1e-3, 0.03, draw(0.05, 0.1), draw(0.3, 0.7), 1.0 - 1e-6, 1.0))
    for d, m in ((2, 2), (3, 1)):
        normals = itertools.cycle([y / np.linalg.norm(y) for y in nearly_zero(draw, d)] + [unit(draw, d)])
        for a, dx, dv, gap_s, e_s in mostly_zero(draw, (d,), (d, m), (d, m), (m,), (m,)):
            v, n = full(draw, d), next(normals)
            yield v - (v @ n + draw(1.0, 3.0)) * n, a, dx, dv, n, next(restitutions), gap_s, e_s, 1.0, 1.0
        rest = full(draw, d), full(draw, (d, m)), full(draw, (d, m))
        for v in nearly_zero(draw, d):
            aside = full(draw, d)
            aside -= (aside @ v) / (v @ v) * v
            n = 0.5 * aside - v
            yield v, *rest, n / np.linalg.norm(n), next(restitutions), full(draw, m), full(draw, m), 1.0, 1.0
        for metre, u in UNITS:
            a, dx, dv, n, gap_s, both = *rest, unit(draw, d), full(draw, m), metre * u
            v = full(draw, d)
            v -= (v @ n + draw(1.0, 3.0)) * n
            yield (metre * v, metre * a, both * dx, both * dv, n, next(restitutions), both * gap_s, u * full(draw, m),
                   metre, u)


@exercise("12.8", points=0.5, hint="e_s moves only the velocity: R_s = −(v · n) n e_sᵀ; 0 ≤ e ≤ 1")
def test_restitution_alone_changes_the_velocity_and_not_the_place(lesson, draw):
    for d in (1, 2, 3):
        for e, n in ((0.0, unit(draw, d)), (1.0, unit(draw, d)), (draw(0.2, 0.8), np.eye(d)[-1]),    # a level floor
                     (1e-6, unit(draw, d)), (draw(0.01, 0.09), unit(draw, d)), (1.0 - 1e-6, unit(draw, d))):
            v, a = draw(-1.0, 1.0, d), draw(-9.0, 9.0, d)
            v -= (v @ n + draw(1.0, 3.0)) * n
            still, e_s = np.zeros((d, 2)), np.array([0.0, draw(0.5, 2.0)])
            _, dx, dv = lesson.bounce(v, a, still, still, n, e, np.zeros(2), e_s)
            given = f"v = {v} m/s, n = {n}, e = {e}"
            close("dx after the bounce, for the input e", dx, still, 0.0, given=given)
            close("dv after the bounce, for the input e", dv, -(v @ n) * np.outer(n, e_s), ROUND_OFF, given=given)
    for v, a, dx, dv, n, e, gap_s, e_s, metre, unit_of_s in impacts(draw):
        R = reflected(n, e), -np.multiply.outer(np.outer(n, n), e_s)
        expected = slopes(behind, 0.0, n, (0.0 * v, dx), (v, dv), a, (0.0, -gap_s), a, R)
        got = lesson.bounce(v, a, dx, dv, n, e, gap_s, e_s)
        given = f"v = {v} m/s, a = {a} m/s², n = {n}, e = {e}"
        for name, y, right, size in zip(("velocity", "dx", "dv"), got, (reflected(n, e) @ v, *expected),
                                        (metre, metre * unit_of_s, metre * unit_of_s), strict=True):
            close(f"{name} after a bounce, over its unit", np.asarray(y) / size, right / size, ROUND_OFF, given=given)


@exercise("12.8", points=0.5, hint="call event_time_sensitivity: it refuses a ball that only slides along the plane")
def test_a_ball_that_grazes_a_plane_has_no_sensitivities(lesson, draw):
    """In four dimensions there is a normal whose products with a velocity have no round-off."""
    thing = "rate of the event"
    for d in (2, 3):
        n, a, dx = unit(draw, d), draw(-9.0, 9.0, d), draw(-1.0, 1.0, (d, 2))
        v = across(draw, n)
        raises("a ball that moves along the plane", BadInput, lesson.bounce, v, a, dx, dx, n, draw(0.2, 0.9),
               np.zeros(2), np.zeros(2), thing=thing)
        v_new, _, _ = lesson.bounce(v - n, a, dx, dx, n, 1.0, np.zeros(2), np.zeros(2))
        close("velocity after the bounce of a ball that comes down [m/s]", v_new, v + n, ROUND_OFF, given=f"n = {n}")
    n, e = 0.5 * np.where(draw(-1.0, 1.0, 4) < 0.0, -1.0, 1.0), draw(0.2, 0.9)
    for share in (*draw.within(), *draw.beyond(3.0), 1e3):
        a, dx, v = draw(-9.0, 9.0, 4), full(draw, (4, 2)), np.zeros(4)
        v[:2] = draw(0.5, 2.0) * np.array([1.0 - 2e-12 * share, -1.0]) * np.sign(n[:2])
        ball = v, a, dx, np.zeros((4, 2)), n, e, np.zeros(2), np.zeros(2)
        if share < 1.0:
            raises("a ball that comes down with less than 1e-12 of the sizes of the terms", BadInput, lesson.bounce,
                   *ball, naming=[n @ v], thing=thing)
        else:                                            # v⁺ − v⁻ has a relative error of 1e-4
            close("dx after the bounce of a ball that comes down very slowly", lesson.bounce(*ball)[1],
                  dx - (1.0 + e) * np.outer(n, n @ dx), 5e-3, given=f"v = {v} m/s, n = {n}")


# ---------------------------------------------------------------------------------------------- what they are for

def hills(s, p):
    """A sum of cubics of the inputs; p (4, m) are their coefficients."""
    return np.sum(p[0] + (p[1] + (p[2] + p[3] * s) * s) * s)


def check_orders(lesson, draw, s, y, p, gradient, longest=1.0):
    steps = longest * np.array([draw(0.3, 0.4), draw(0.1, 0.2), draw(0.04, 0.05), draw(0.01, 0.02), draw(0.5, 0.6)])
    first, second, third = p[1] + 2.0 * p[2] * s + 3.0 * p[3] * s * s, (p[2] + 3.0 * p[3] * s) @ y**2, p[3] @ y**3
    left = np.abs((first - gradient) @ y * steps + second * steps**2 + third * steps**3)
    expected = np.log(left[1:] / left[:-1]) / np.log(steps[1:] / steps[:-1])
    got = lesson.remainder_orders(hills, gradient, s, y, steps, p)
    close("observed orders of the remainder [-]", got, expected, 1e-5,
          given=f"s = {s}, y = {y}, gradient {gradient}, steps {steps}")


@exercise("12.9", points=1.5,
          hint="remainder |f(s + h y) − f(s) − h g · y| of each h; then log of its ratio over log of that of the steps")
def test_taylors_test_tells_a_right_gradient_from_a_wrong_one(lesson, draw):
    """The remainder of a cubic is h δ + h² b + h³ c in closed form, with δ from the error of the gradient.

    It is above 1e-5, and f below 100 in units of which 1e-16 is lost: 1e-9 of it.
    """
    for m, off in ((1, 0.0), (3, 0.0), (2, 0.5), (3, -0.5), (2, 1e-3)):
        s, y, p = draw(0.5, 1.0, m), draw(0.5, 1.0, m), draw(0.5, 1.5, (4, m))
        check_orders(lesson, draw, s, y, p, p[1] + 2.0 * p[2] * s + 3.0 * p[3] * s * s + off)
    for m in (2, 8):
        s, y, p = np.zeros(m), draw.sparse(0.5, 1.0, m), draw.sparse(0.5, 1.5, (4, m))
        y[0], p[1:, 0], p[0] = 1.0, draw(0.5, 1.5, 3), 0.0
        check_orders(lesson, draw, s, y, p, p[1])
        check_orders(lesson, draw, s, y, p, np.zeros(m))                 # the gradient of a place where f is flat
    check_orders_of_parts(lesson, draw)
    for size, metre, longest in ((1.0, 1.0, 1e-8), (1e-12, 1.0, 1.0), (1e-12, 1.0, 1e-8), (1.0, 1.0, 1e6),
                                 (1e12, 1.0, 1e6), (1.0, 1e-12, 1e12), (1.0, 1e12, 1e-12)):
        p, y = size * draw(0.5, 1.5, (4, 2)), metre * draw(0.5, 1.0, 2)
        p[0] = 0.0                                       # f is 0 at s = 0: no digit of the smallest remainder is lost
        check_orders(lesson, draw, np.zeros(2), y, p, 0.5 * p[1], longest)
        p[1] = 0.0
        check_orders(lesson, draw, np.zeros(2), y, p, np.zeros(2), longest)


def check_orders_of_parts(lesson, draw):
    """The place, the direction or the gradient is nearly zero; none of these signs makes the remainder pass 0."""
    for m in (2, 3):
        s, y, p = draw(0.5, 1.0, m), draw(0.5, 1.0, m), draw(0.5, 1.5, (4, m))
        right = p[1] + 2.0 * p[2] * s + 3.0 * p[3] * s * s
        for part in nearly_zero(draw, m, 0.5, 1.0):
            check_orders(lesson, draw, s, part, p, right)
            check_orders(lesson, draw, s, y, p, 0.5 * part)
            check_orders(lesson, draw, 0.1 * part, y, p, p[1] + 0.2 * p[2] * part + 0.03 * p[3] * part * part)
        p[1], across = 0.0, draw(0.5, 1.0) * (np.eye(m)[0] - np.eye(m)[1])
        p[1, 0] = draw(2.0, 3.0)
        check_orders(lesson, draw, np.zeros(m), across, p, np.full(m, draw(0.5, 1.0)))   # the direction is across it


@exercise("12.9", points=0.5, hint='call check_positive("remainder of a step", …) for every remainder')
def test_taylors_test_refuses_a_function_without_a_remainder(lesson, draw):
    """A linear function of whole numbers, with steps that are powers of two, has no round-off.

    Neither has p h + 2ⁿ c h² − c h³ at h = 2ⁿ, where a single remainder is 0.
    """
    thing = "remainder of a step"
    for m, n in ((1, 2), (2, 2), (1, 3), (2, 4)):
        p, steps = np.zeros((4, m)), 0.5 ** (np.arange(n) + draw.whole(0, 9))
        p[1], p[3, -1] = float(draw.whole(1, 9)), float(draw.whole(1, 9))
        for h in steps:
            p[2, -1] = -p[3, -1] * h
            raises("a single step without a remainder", BadInput, lesson.remainder_orders, hills, p[1], np.zeros(m),
                   np.ones(m), steps, p, naming=[0.0], thing=thing)
    for m in (1, 2):
        s, y = (np.array([float(draw.whole(1, 9)) for _ in range(m)]) for _ in range(2))
        p = np.zeros((4, m))
        p[1] = [float(draw.whole(1, 9)) for _ in range(m)]
        raises("a function that is linear", BadInput, lesson.remainder_orders, hills, p[1], s, y,
               np.array([0.5, 0.25]), p, naming=[0.0], thing=thing)
        orders = lesson.remainder_orders(hills, p[1] + 1.0, s, y, np.array([0.5, 0.25, 0.125]), p)
        close("observed orders for a wrong gradient [-]", orders, [1.0, 1.0], ROUND_OFF)


# The throws of these tests.  Each returns the miss and its derivatives.

def by_speed_and_angle(s, p):
    """A throw with speed s[0] and angle s[1]; p = (duration, g, the target)."""
    T, g, x, y = p[0], p[1], p[2], p[3]
    along, up = np.cos(s[1]), np.sin(s[1])
    r = np.array([T * s[0] * along - x, T * s[0] * up - 0.5 * g * T * T - y])
    return r, np.array([[T * along, -T * s[0] * up], [T * up, T * s[0] * along]])


def square(s, p):
    """s² = p[0]."""
    return np.array([s[0] * s[0] - p[0]]), np.array([[2.0 * s[0]]])


def ring(s, p):
    """s_i + 0.3 s_i+1² = p_i, around."""
    J, r = np.eye(s.size), s - p
    for i in range(s.size):
        j = (i + 1) % s.size
        r[i] += 0.3 * s[j] ** 2
        J[i, j] += 0.6 * s[j]
    return r, J


def bend(s, p):
    """arctan((s − p[0])/p[1]): from far away, Newton's step goes much too far."""
    y = (s - p[0]) / p[1]
    return np.arctan(y), np.array([[1.0 / (p[1] * (1.0 + y[0] * y[0]))]])


def logarithm(s, p):
    """log(s/p[0]); what is not above zero never arrives."""
    if s[0] <= 0.0:
        return np.full(1, np.nan), np.full((1, 1), np.nan)
    return np.log(s / p[0]), np.array([[1.0 / s[0]]])


def pit(s, p):
    """s² + p[0] > 0: no s hits."""
    return np.array([s[0] * s[0] + p[0]]), np.array([[2.0 * s[0]]])


class Narrow(NamedTuple):
    """Throws of which only those near s = 0 miss by less."""
    first: np.ndarray        # (k,) miss at s = 0
    near: np.ndarray         # (k,) miss within the reach
    beyond: np.ndarray       # (k,) miss beyond it
    reach: float             # in Newton's steps


def narrow(s, p):
    """From s = 0, Newton's step is −1 or 0 for each input; beyond the reach, the derivatives are others."""
    far = np.max(np.abs(s))
    J = np.diag(np.where(p.first == 0.0, 1.0, p.first))
    if far == 0.0:
        return p.first.copy(), J
    if far <= p.reach:
        return p.near.copy(), J
    return p.beyond.copy(), 3.0 * J


def both(s, p):
    """The same sum of two inputs shall be two numbers."""
    return s[0] + s[1] - p, np.ones((2, 2))


SMALLER = (                  # two misses, the second of which is smaller; but not its sum, largest entry, first, last …
    ((0.9, 0.9, 0.0), (1.2, 0.0, 0.0)), ((0.9, 0.9, 0.0), (0.0, 0.0, 1.2)), ((1.4, 0.0, 0.0), (0.9, 0.9, 0.0)),
    ((0.0, 0.0, 1.4), (0.9, 0.9, 0.0)), ((1.0, -1.0, 0.0), (0.7, 0.7, 0.7)), ((-1.0, -1.0, -1.0), (0.9, 0.9, 0.9)),
    ((1.0, 1.0, 1.0), (-0.9, -0.9, -0.9)), ((1.0, 1.0, 1.0), (0.0, 1.2, -1.2)), ((-1.0, 0.0, 0.0), (0.0, 0.9, 0.0)))


def check_sizes(lesson, draw):
    """A throw is measured by √(r · r), at its first place, and as smaller or not, and as within the tolerance."""
    for k in (1, 2, 3):
        for first in nearly_zero(draw, k):
            s, misses = lesson.aim(narrow, np.zeros(k), 1e-3, 3, Narrow(first, 0.0 * first, first, 1.5))
            given = f"from a miss of {first} m"
            close("inputs that hit, in Newton's steps", s, -1.0 * (first != 0.0), ROUND_OFF, given=given)
            close("misses", misses, [np.linalg.norm(first), 0.0], ROUND_OFF, given=given)
    for large, small in draw(0.5, 2.0) * np.array(SMALLER):
        sizes = [np.linalg.norm(large), np.linalg.norm(small)]
        for tolerance in (sizes[1] * 1.001, sizes[0] * 0.999):
            s, misses = lesson.aim(narrow, np.zeros(3), tolerance, 1, Narrow(large, small, large, 1.5))
            given = f"misses of {large} m, then {small} m"
            close("inputs after a step that is good enough, in Newton's steps", s, -1.0 * (large != 0.0), ROUND_OFF,
                  given=given)
            close("misses before and after it", misses, sizes, ROUND_OFF, given=given)
        raises("a step after which the miss is larger, however short it is", Diverged, lesson.aim, narrow, np.zeros(3),
               1e-3, 3, Narrow(small, small, large, 0.0), naming=[sizes[1]], thing="miss of the last throw")
        raises("a miss that is just above the tolerance", Diverged, lesson.aim, narrow, np.zeros(3), sizes[1] * 0.999,
               1, Narrow(large, small, large, 1.5), naming=[sizes[1]], thing="miss of the last throw")


def check_halvings(lesson, draw):
    """Only a step that was halved so many times makes the miss smaller: before, it is as large, or larger, or NaN."""
    for k, beyond in ((1, 1.0), (2, -1.0), (3, 2.0), (2, np.nan), (1, 1e9), (3, 1.0)):
        first = full(draw, k)
        for halvings in (0, 1, 2, draw.whole(3, 8), 39, 40):
            p = Narrow(first, 0.0 * first, beyond * first, draw(1.1, 1.9) * 0.5**halvings)
            given = f"a miss of {first} m is smaller after {halvings} halvings"
            s, misses = lesson.aim(narrow, np.zeros(k), 1e-3, 1, p)
            close("inputs that hit, in halved steps", np.asarray(s) * 2.0**halvings, -np.ones(k), ROUND_OFF,
                  given=given)
            close("misses", misses, [np.linalg.norm(first), 0.0], ROUND_OFF, given=given)
            barely, size = p._replace(near=(1.0 - 1e-9) * first), np.linalg.norm(first)
            s, _ = lesson.aim(narrow, np.zeros(k), (1.0 - 5e-10) * size, 1, barely)
            close("inputs that miss by a billionth less, in halved steps", np.asarray(s) * 2.0**halvings, -np.ones(k),
                  ROUND_OFF, given=given)
        for reach in (draw(0.6, 0.9) * 0.5**40, 0.0):
            raises("a step that has to be halved more than 40 times", Diverged, lesson.aim, narrow, np.zeros(k), 1e-3,
                   9, Narrow(first, 0.0 * first, beyond * first, reach), naming=[np.linalg.norm(first)],
                   thing="miss of the last throw")


@exercise("12.10", points=0.75,
          hint="step = solve(J, r), s ← s − step, a step that misses by more halved, "
               "until √(r · r) ≤ tolerance; keep every |r|")
def test_newtons_method_hits_what_it_aims_at(lesson, draw):
    T, g, x, y = draw(0.8, 1.2), 9.81, draw(2.0, 4.0), draw(0.5, 1.5)
    p = np.array([T, g, x, y])
    along, up = x / T, (y + 0.5 * g * T * T) / T
    right = np.array([np.hypot(along, up), np.arctan2(up, along)])
    start = right * [draw(0.8, 1.2), draw(0.8, 1.2)]
    s, misses = lesson.aim(by_speed_and_angle, start, 1e-10, 20, p)
    given = f"from speed and angle {start}, target ({x}, {y}) m after {T} s"
    close("speed [m/s] and angle [rad] of a throw that hits", s, right, 1e-8, given=given)
    first = np.linalg.norm(by_speed_and_angle(start, p)[0])
    close("first miss [m]", np.asarray(misses)[0], first, ROUND_OFF, given=given)
    between("last miss [m]", np.asarray(misses)[-1], 0.0, 1e-10, given=given)
    for k, start, right in ((1, 0.0, draw(0.2, 0.8, 1)), (3, 0.0, draw(0.2, 0.8, 3)),
                            (8, 0.1, draw.sparse(0.2, 0.8, 8)), (1, 0.1, np.zeros(1))):
        s, misses = lesson.aim(ring, np.full(k, start), 1e-12, 20, right + 0.3 * np.roll(right, -1) ** 2)
        close("inputs that hit, of equations with a known solution", s, right, ROUND_OFF, given=f"{k} inputs")
        between("number of iterations", len(misses) - 1, 1, 8, given=f"{k} inputs")
    check_sizes(lesson, draw)


@exercise("12.10", points=0.25,
          hint="misses has one entry for the first throw, and one per iteration; "
               "a miss that equals the tolerance is small enough, also where both are 0")
def test_the_misses_are_those_of_newtons_method(lesson, draw):
    """For s² = a Newton's method is s ← ½ (s + a/s), which misses by less each time if it begins above the root."""
    a, start = draw(2.0, 5.0), draw(3.0, 5.0)
    for most in (0, 5):
        found, misses = lesson.aim(square, np.array([start]), 100.0, most, np.array([a]))
        close("inputs that hit before the first iteration", found, [start], 0.0, given=f"s = {start}")
        close("misses without an iteration", misses, [start * start - a], ROUND_OFF, given=f"s² = {a}, s = {start}")
        for root, tolerance in ((2.0, 0.0), (0.0, 4.0)):                 # a miss of exactly the tolerance is a hit
            found, misses = lesson.aim(square, np.array([root]), tolerance, most, np.array([4.0]))
            given = f"s² = 4, s = {root}, tolerance {tolerance}"
            close("inputs that hit, with a miss of just the tolerance", found, [root], 0.0, given=given)
            close("misses, where the first is just the tolerance", misses, [tolerance], 0.0, given=given)
    for tolerance, size in ((1e-2, 1.0), (1e-9, 1.0), (1e-2, 1e-9), (1e-9, 1e-9), (1e-2, 1e9), (1e-9, 1e9)):
        s, expected = start, [start * start - a]
        while expected[-1] > tolerance:
            s = 0.5 * (s + a / s)
            expected.append(abs(s * s - a))
        found, misses = lesson.aim(square, np.array([size * start]), size * size * tolerance, len(expected) - 1.0,
                                   np.array([size * size * a]))
        given = f"s² = {size * size * a}, from {size * start}, tolerance {size * size * tolerance}"
        close("root of s² = a, over its size", np.asarray(found) / size, [s], ROUND_OFF, given=given)
        close("misses, over their size", np.asarray(misses) / size**2, expected, ROUND_OFF, given=given)


@exercise("12.10", points=0.5, hint="while the new miss is not smaller, halve the step; write not (new < old) for NaN")
def test_a_step_that_goes_too_far_is_halved(lesson, draw):
    """Newton's method alone diverges for the arctangent from beyond 1.39 widths, and leaves the logarithm's range."""
    middle, width = draw(-2.0, 2.0), draw(0.5, 2.0)
    for side in (-1.0, 1.0):
        start = middle + side * draw(5.0, 20.0) * width
        s, misses = lesson.aim(bend, np.array([start]), 1e-12, 40, np.array([middle, width]))
        given = f"arctan((s − {middle})/{width}) from {start}"
        close("root of an arctangent", s, [middle], ROUND_OFF, given=given)
        truth("every miss is smaller than the one before", bool(np.all(np.diff(misses) < 0.0)), True, given=given)
        most = len(misses) - 1
        s, _ = lesson.aim(bend, np.array([start]), 1e-12, most, np.array([middle, width]))
        close("root of an arctangent with just enough iterations: a halving is none", s, [middle], ROUND_OFF,
              given=f"{given}, at most {most} iterations")
    root, far = draw(1.0, 3.0), draw(5.0, 50.0)
    s, _ = lesson.aim(logarithm, np.array([far * root]), 1e-12, 40, np.array([root]))
    close("root of a logarithm, where throws beyond zero never arrive", s, [root], ROUND_OFF,
          given=f"root {root}, from {far * root}")
    check_halvings(lesson, draw)


@exercise("12.10", points=0.5, hint="raise Diverged with the last miss; begin with checked_search")
def test_a_search_that_does_not_arrive_says_so(lesson, draw):
    a, start = draw(2.0, 5.0), draw(3.0, 5.0)
    once = 0.5 * (start + a / start)
    last, p = "miss of the last throw", np.array([a])
    raises("too few iterations", Diverged, lesson.aim, square, np.array([start]), 1e-12, 1, p,
           naming=[once * once - a], thing=last)
    raises("no iteration at all", Diverged, lesson.aim, square, np.array([start]), 1e-12, 0, p,
           naming=[start * start - a], thing=last)
    raises("a target that no throw hits", Diverged, lesson.aim, pit, np.array([start]), 1e-6, 100, p, thing=last)
    for wrong in (np.nan, np.inf):
        raises("inputs that are not finite", BadInput, lesson.aim, square, np.array([wrong]), 1e-6, 10, p,
               thing="inputs s")
        raises("a tolerance that is not finite", BadInput, lesson.aim, square, np.array([start]), wrong, 10, p,
               thing="tolerance of a search")
    raises("a negative tolerance", BadInput, lesson.aim, square, np.array([start]), -1e-6, 10, p, naming=[-1e-6],
           thing="tolerance of a search")
    for wrong in (-1, 2.5):
        raises("a number of iterations that is negative or not whole", BadInput, lesson.aim, square, np.array([start]),
               1e-6, wrong, p, naming=[wrong], thing="number of iterations")
    root = float(draw.whole(2, 9))
    for miss, s, aim_at in ((square, np.zeros(1), p), (both, draw(-1.0, 1.0, 2), draw(2.0, 5.0, 2)),
                            (pit, np.array([root]), np.array([root * root]))):           # Newton's step is to s = 0
        raises("a sensitivity that is singular", np.linalg.LinAlgError, lesson.aim, miss, s, 1e-6, 10, aim_at)


# ---------------------------------------------------------------------------------------------- how long they help

@exercise("12.11", points=0.75, hint="the error grows by cosh(rate t): e^(rate t) and e^(−rate t) have half of it each")
def test_the_error_of_a_pencil_has_grown_to_what_is_allowed(lesson, draw):
    """Growths from a millionth above 1 to 5e8: log(2 growth) is off by 1/(4 growth²)."""
    def grown(error, growth, tolerance):
        rate = draw(1.0, 6.0) * 10.0 ** draw.whole(-6, 6)
        turns = rate * float(lesson.predicted_horizon(rate, error, growth * error))
        given = f"rate {rate} 1/s, error {error} m, allowed {growth * error} m"
        between("time times the rate, a number from zero to 50", turns, 0.0, 50.0, given=given)
        close("error at that time over the allowed one [-]", 0.5 * (np.exp(turns) + np.exp(-turns)) / growth, 1.0,
              tolerance, given=given)
        close("growth less 1, at that time, over the allowed one [-]",
              2.0 * np.sinh(0.5 * turns) ** 2 / (growth - 1.0), 1.0, max(tolerance, 1e-14 / (growth - 1.0)),
              given=given)
    for error, growth in ((draw(1e-3, 1e-2), draw(2.0, 9.0)), (1e-9, 1e8), (draw(0.1, 1.0), 1.05)):
        grown(error, growth, ROUND_OFF)
    for power in (1e1, 1e2, 1e3, 1e4, 1e5):
        for size in (1.0, 1e-9, 1e9):
            grown(size * draw(0.1, 1.0), power * draw(1.0, 5.0), 2e-13)
    for above in (1e-1, 1e-2, 1e-3, 1e-6, 1e-8):
        grown(draw(0.1, 1.0), 1.0 + above * draw(1.0, 5.0), 2e-13)


@exercise("12.11", points=0.25, hint="where the error is as large as allowed from the start, the time is 0")
def test_an_error_that_is_too_large_from_the_start_helps_for_no_time(lesson, draw):
    for size in (1.0, 1e-9, 1e9):
        error, rate = size * draw(0.1, 1.0), draw(1.0, 6.0)
        for share in (1.0, 1.0 - 1e-9, *draw.within(), 1e-9, 0.0):
            close("time for which the start is known well enough [s]",
                  lesson.predicted_horizon(rate, error, share * error), 0.0, 0.0,
                  given=f"error {error} m, allowed {share * error} m")
        known = rate * lesson.predicted_horizon(rate, error, 2.0 * error)
        between("time until the error has doubled, times the rate [-]", known, 1.3, 1.35,
                given=f"error {error} m, rate {rate} 1/s")


def bounced_once(heights, x):
    """Whether these balls fell from rest, came back up with half their speed, and are seen at one time."""
    tau = np.sqrt(2.0 * heights / 9.81)
    left = tau[-1] - tau
    right = 0.5 * 9.81 * tau * left - 0.5 * 9.81 * left**2
    return np.abs(x - (right - right[0])).max() < ROUND_OFF


@exercise("12.12", points=1, hint="just after the bounce, ∂x/∂h is −e: see 12.7")
def test_the_curve_is_that_of_balls_that_bounce_once(lesson):
    choice("letter of the curve of balls that bounce once", lesson.bounced_curve_is(),
           choices.where("sensitivities", "bounced_curve_is", bounced_once))
