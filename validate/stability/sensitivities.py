"""Steps of differences, grazing, wrong gradients, bounces, chaos, and the laws of sensitivities.

Truths are closed forms, power series and imaginary parts; none of them is a formula of the lesson.
*Source:* each case derives its theory; Squire and Trapp 1998 for the complex step.
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize_scalar

from solutions.checks import Diverged
from solutions.given.sensitivities import Course, Throw
from validate.reference.sensitivities import (
    Plane,
    bounced_flight,
    bounced_sensitivities,
    by_complex_numbers,
    power_series,
)
from validate.stability.case import DOTS, LINE, Picture, case, log_series, log_slope, random_law, refuses, series

G = 9.81                     # [m/s²]
EPSILON = 2.0**-53           # largest relative rounding of a number [-]
TRIED = 100                  # random cases per law
UP = np.array([0.0, 1.0])
DOWN = np.array([0.0, -G])


def wave(s, p):
    """e^s sin 3s: a function of which all derivatives are known."""
    return np.exp(s) * np.sin(3.0 * s)


def series_of(f, s, radius=0.5):
    """Return the coefficients of the power series of f(s + h)."""
    return power_series(lambda z: f(z, None), s, radius)


# ---------------------------------------------------------------------------------------------- differences

@case("best-step-of-a-difference", "Too long and too short steps of a difference", compiled=False)
def best_step_of_a_difference(lesson, check):
    """Check that best_step is where the measured error of central differences turns from truncation to round-off.

    The error at a single h is luck in its round-off, so it is the root mean square over 200 places s.  Round-off is a
    random number with the standard deviation of two roundings of f, which are uniform: ε |f| √(2/12) · 2.  Above the
    best h the error grows as h², below as 1/h.
    """
    places = np.linspace(0.4, 0.5, 200)
    slopes = np.array([series_of(wave, s)[1] for s in places])
    hs = np.geomspace(1e-9, 1e-1, 33)
    errors = np.array([np.sqrt(np.mean([(lesson.central_difference(wave, s, h, None) - slope) ** 2
                                        for s, slope in zip(places, slopes)])) for h in hs])
    check("For long steps the error of a central difference is of order 2.", "order for h from 10⁻³ to 10⁻¹ [-]",
          law=2.0, found=log_slope(hs[hs > 1e-3], errors[hs > 1e-3]), within=0.05,
          saw="A hundred times the step has ten thousand times the error.")
    check("For short steps it is round-off over h.", "order for h from 10⁻⁹ to 10⁻⁶ [-]",
          law=-1.0, found=log_slope(hs[hs < 1e-6], errors[hs < 1e-6]), within=0.1,
          saw="A hundredth of the step has a hundred times the error.")
    c = series_of(wave, 0.45)
    best = lesson.best_step(wave(0.45, None), 6.0 * c[3], EPSILON)
    total = lambda h: h * h * abs(c[3]) + EPSILON * abs(c[0]) / h
    law = minimize_scalar(lambda u: total(np.exp(u)), bracket=(-14.0, -10.0), tol=1e-12)
    check("The best step minimises the sum of both.", "log₁₀ of the best step [-]", law=law.x / np.log(10.0),
          found=np.log10(best), within=1e-6, saw=f"The best step is {best:.2e}.")
    at_best = np.interp(np.log(best), np.log(hs), np.log(errors))
    check("No step has a much smaller error than the best one.",
          "error at the best step over the smallest measured [-]",
          law=1.0, found=np.exp(at_best) / errors.min(), within=1.0,
          saw="The measured error is smallest where theory says, to within the scatter of round-off.")
    exact = [abs(lesson.complex_step(wave, s, 1e-20, None) / slope - 1.0) for s, slope in zip(places, slopes)]
    check.agree("A complex step of 10⁻²⁰ has no error but round-off.", "largest relative error [-]",
                np.max(exact), 1e-13)
    return Picture("The step of a difference", "log₁₀ h [-]", "log₁₀ error [-]",
                   [log_series("measured", hs, errors, DOTS), log_series("theory", hs, total(hs), LINE)],
                   "To the right truncation grows as h², to the left round-off as 1/h.")


# ---------------------------------------------------------------------------------------------- events

def lands_at(h, v, g=G):
    """Return the time at which a ball that is thrown upwards with v from h below a ceiling at 0 arrives there."""
    return (v - np.sqrt(v * v - 2.0 * g * h)) / g


@case("grazing-event", "An event that only grazes", compiled=False)
def grazing_event(lesson, check):
    """Check that a ball thrown at a ceiling has a time of impact whose sensitivity grows as the inverse root of what is
    left of its speed, and that none is computed where it only grazes.

    It arrives at  τ = (v − √(v² − 2gh))/g  with the speed w = √(v² − 2gh), and  ∂τ/∂v = (1 − v/w)/g.
    """
    h, lefts, found = 2.0, np.geomspace(1e-9, 1.0, 10), []
    edge = np.sqrt(2.0 * G * h)
    for left in lefts:
        v = edge * (1.0 + left)
        tau = lands_at(h, v)
        w = np.sqrt((v - edge) * (v + edge))
        found.append(lesson.event_time_sensitivity(-UP, np.zeros(2), np.zeros(1), np.array([0.0, w]), DOWN,
                                                   np.array([[0.0], [tau]]), np.array([[0.0], [1.0]]))[0])
    law = [(1.0 - v / np.sqrt((v - edge) * (v + edge))) / G for v in edge * (1.0 + lefts)]
    check.agree("The time of impact changes by (1 − v/w)/g with the speed of the throw.",
                "largest relative error of ∂τ/∂v [-]", np.max(np.abs(np.array(found) / law - 1.0)), 1e-6)
    check("Close to grazing it grows as the inverse root of the speed that is left.",
          "order of ∂τ/∂v in the excess of speed [-]", law=-0.5,
          found=log_slope(lefts[:5], np.abs(found[:5])), within=1e-3,
          saw="A millionth of the excess has a thousand times the sensitivity.")
    n, along, ones = np.array([0.6, 0.8]), np.array([0.8, -0.6]), np.ones((2, 1))
    grazes = lambda rate: refuses(lesson.event_time_sensitivity,
                                  (n, np.zeros(2), np.zeros(1), along + rate * n, DOWN, ones, ones), "rate")
    refused = sum((grazes(0.0), grazes(1e-14), not grazes(1e-9)))
    check.count("A ball that only touches the ceiling has no sensitivity, one that hits it has.", "right answers",
                refused, 3, "answers are right: a rate of 0 and of 10⁻¹⁴ is refused, one of 10⁻⁹ is not.")
    return Picture("The time of an event that almost grazes",
                   "log₁₀ of the excess of speed [-]", "log₁₀ |∂τ/∂v| [s²/m]",
                   [log_series("measured", lefts, np.abs(found), DOTS), log_series("theory", lefts, np.abs(law), LINE)],
                   "Nearer to grazing, a change of the throw moves the time of the impact more and more.")


@case("behind-a-bounce", "The height just after a bounce", compiled=False)
def behind_a_bounce(lesson, check):
    """Compare ∂y/∂h of a ball that was dropped from h with a closed form after its bounce, and with −e just after it.
    """
    es = np.array([0.3, 0.5, 0.7, 0.9])
    T = np.sqrt(2.0 / G) * 1.05                      # a little after the first impact of a fall from 1 m
    found = [flown(lesson, 1.0, e, T)[2][1, 0] for e in es]
    law = np.array([bounced_sensitivities(1.0, e, G, T)[2] for e in es])
    check.agree("Saltation gives the sensitivity of the height after a bounce.", "largest error of ∂y/∂h [-]",
                np.max(np.abs(found - law)), 1e-12)
    just_behind = np.sqrt(2.0 / G) * (1.0 + 1e-9)
    at = [flown(lesson, 1.0, e, just_behind)[2][1, 0] for e in es]
    check.agree("Just after a bounce the height falls by e where the ball was dropped from 1 higher up.",
                "largest error of ∂y/∂h = −e [-]", np.max(np.abs(at + es)), 1e-7)
    return Picture("How the height after a bounce depends on the first height", "restitution e [-]", "∂y/∂h [-]",
                   [series("saltation", es, found, DOTS), series("theory", es, law, LINE)],
                   "A ball from higher up comes later, so it is lower.")


def flown(lesson, h, e, T):
    """Return (x, v, dx, dv) of a ball that was dropped from h; the inputs are h and e."""
    course = Course(DOWN, UP[None], np.zeros((1, 2)), np.array([e]), np.array([[0.0, 1.0]]))
    by_inputs = np.array([[0.0, 0.0], [1.0, 0.0]])
    return lesson.flight(np.array([0.0, h]), np.zeros(2), by_inputs, np.zeros((2, 2)), T, course)


# ---------------------------------------------------------------------------------------------- gradients, and how far

def bowl(s, p):
    """A smooth function of three inputs."""
    return np.exp(0.3 * s[0]) * np.sin(s[1]) + s[2] ** 2 * s[0] + np.cos(s[2] * s[1])


def slope_of_bowl(s):
    """Its gradient, by imaginary parts."""
    return by_complex_numbers(lambda z: bowl(z, None), s)[1]


@case("wrong-gradients", "Taylor's test finds wrong gradients", compiled=False)
def wrong_gradients(lesson, check):
    """Check that the remainder of Taylor's test is of order 2 for the gradient and of order 1 for a wrong one.

    A gradient that is wrong by the share q leaves  q h |g · y| + ½ h² |y · H y|.  For h far below 2q |g · y|/|y
    · H y| its order is 1.
    """
    rng, wrongs = np.random.default_rng(5), (0.0, 1e-3, 0.1)
    steps, orders = np.geomspace(1e-3, 1e-5, 5), {q: [] for q in wrongs}
    for _ in range(50):
        s, y = rng.uniform(-1.0, 1.0, 3), rng.normal(size=3)
        g = slope_of_bowl(s)
        if abs(g @ y) < 0.3:
            continue
        for q in wrongs:
            orders[q].append(lesson.remainder_orders(bowl, (1.0 + q) * g, s, y, steps, None)[-1 if q else 0])
    for q, law in ((0.0, 2.0), (0.1, 1.0), (1e-3, 1.0)):
        check("The remainder of a right gradient is of order 2, of a wrong one of order 1.",
              f"median of the order, gradient wrong by {100.0 * q:g} % [-]",
              law=law, found=np.median(orders[q]), within=0.05,
              saw=f"Wrong by {100.0 * q:g} %: the order is {np.median(orders[q]):.3f}.")


def doubled(s, n):
    """The place after n steps of x ← 4x (1 − x)."""
    for _ in range(n):
        s = 4.0 * s * (1.0 - s)
    return s


@case("chaos", "Sensitivities of a chaotic law grow without bound", compiled=False)
def chaos(lesson, check):
    """Check that a derivative through n steps of x ← 4x (1 − x) doubles per step, and that differences soon fail.

    x_n = sin²(2ⁿ θ) for x_0 = sin² θ, so  ∂x_n/∂x_0 = 2ⁿ sin(2ⁿ⁺¹ θ)/sin 2θ.  The Lyapunov exponent is ln 2 per step.
    Over uniform x_0 the means of ln |sin 2ⁿ⁺¹θ| and of ln sin 2θ are −ln 2 and ln 2 − 1, so thirty steps show
    ln 2 + (1 − 2 ln 2)/30.  The first has a standard deviation of 0.9, of which 400 starts leave 0.9/√400/30 = 0.0015.
    A difference over 2h is of no use from 2ⁿ h ≈ 1 on: n = log₂(1/h), 20 steps for 10⁻⁶.  The tangent itself loses a
    binary digit per step, because its place does.
    """
    n, place = np.arange(1, 31), 0.3
    theta = np.arcsin(np.sqrt(place))
    truth = 2.0**n * np.sin(2.0 ** (n + 1) * theta) / np.sin(2.0 * theta)
    tangents = np.array([lesson.complex_step(doubled, place, 1e-20, k) for k in n])
    apart = 1e-6
    differences = np.array([lesson.central_difference(doubled, place, apart, k) for k in n])
    check.agree("The complex step differentiates all steps.", "largest error over 2ⁿ, thirty steps [-]",
                np.max(np.abs(tangents - truth) / 2.0**n), 2.0**30 * 30.0 * EPSILON)
    starts = (np.arange(400) + 0.5) / 400.0
    growth = np.mean([np.log(abs(lesson.complex_step(doubled, s, 1e-20, 30))) for s in starts]) / 30.0
    check("It doubles in each step: over 30 steps the logarithm of its growth is ln 2 − 0.013 per step, in the mean.",
          "logarithm of the growth per step, mean of 400 starts [1/step]",
          law=np.log(2.0) + (1.0 - 2.0 * np.log(2.0)) / 30.0, found=growth, within=0.006,
          saw=f"A sensitivity grows by {np.exp(growth):.3f} per step.")
    off = np.abs(differences - truth) / 2.0**n
    last = n[np.argmax(off > 0.1)]
    check("A difference over 10⁻⁶ is of no use after about twenty steps.",
          "steps until a difference is off by 10 % of 2ⁿ [-]",
          law=np.log2(1.0 / apart), found=last, within=2.5, saw=f"It is off by more than a tenth after {last} steps.")
    return Picture("Sensitivities through chaos", "steps [-]", "log₁₀ |∂xₙ/∂x₀| [-]",
                   [series("complex step", n, np.log10(np.abs(tangents)), DOTS),
                    series("differences over 10⁻⁶", n, np.log10(np.abs(differences) + 1e-9), DOTS),
                    series("2ⁿ", n, n * np.log10(2.0), LINE)],
                   "Sensitivities grow as 2ⁿ; a difference cannot be larger than 1/2h.")


# ---------------------------------------------------------------------------------------------- random laws

def pulled(t, x, v, p):
    """a = −k x |x|² − c v + p_1 t, with the inputs k, c and the third one in p."""
    return -p[0] * x * (x @ x) - p[1] * v + p[2] * t


def slopes_of_pull(t, x, v, p):
    """Return (a_x, a_v, a_s) of pulled."""
    a_s = np.stack((-x * (x @ x), -v, np.full(x.size, t)), axis=1)
    return -p[0] * (x @ x * np.eye(x.size) + 2.0 * np.outer(x, x)), -p[1] * np.eye(x.size), a_s


def drawn_state(rng):
    """Return (t, x, v, dx, dv, dt, p) of a point in space with three inputs."""
    return (rng.uniform(0.0, 1.0), rng.normal(size=3), rng.normal(size=3), rng.normal(size=(3, 3)),
            rng.normal(size=(3, 3)), rng.uniform(0.01, 0.1), rng.uniform(0.2, 1.0, 3))


def through_step(step, t, x, v, dx, dv, dt, p):
    """Return (x, v, dx, dv) after a step, by imaginary parts: inputs move x, v and p at once."""
    end = lambda s: np.concatenate(step(t, x + dx @ s, v + dv @ s, dt, p + s))
    state, slopes = by_complex_numbers(end, np.zeros(3))
    return state[:3], state[3:], slopes[:3], slopes[3:]


def explicit(t, x, v, dt, p):
    v = v + dt * pulled(t, x, v, p)
    return x + dt * v, v


def implicit(t, x, v, dt, p):
    """Solve v⁺ = v + dt a(t + dt, x + dt v⁺, v⁺) by fixed-point iteration, with complex numbers."""
    new = v
    for _ in range(60):
        new = v + dt * pulled(t + dt, x + dt * new, new, p)
    return x + dt * new, new


@random_law("A tangent step is the derivative of a step of symplectic Euler.",
            "largest error of the tangents [m, m/s]", 1e-13)
def tangent_of_symplectic(lesson, rng):
    t, x, v, dx, dv, dt, p = drawn_state(rng)
    return lesson.tangent_step(pulled, slopes_of_pull, t, x, v, dx, dv, dt, p), \
        through_step(explicit, t, x, v, dx, dv, dt, p)


@random_law("An implicit tangent step is the derivative of a step of implicit Euler.",
            "largest error of its tangents [m, m/s]",
            1e-10)
def tangent_of_implicit(lesson, rng):
    t, x, v, dx, dv, dt, p = drawn_state(rng)
    return lesson.tangent_implicit_step(pulled, slopes_of_pull, t, x, v, dx, dv, dt, p), \
        through_step(implicit, t, x, v, dx, dv, dt, p)


def drawn_impact(rng):
    """Return a ball that hits a plane: n, e, place on the plane, speed v before, gravity, dx, dv, e_s, gap_s."""
    n = rng.normal(size=3)
    n /= np.linalg.norm(n)
    v = rng.normal(size=3)
    v -= (v @ n + rng.uniform(0.5, 2.0)) * n
    return n, rng.uniform(0.1, 0.9), rng.normal(size=3), v, rng.normal(size=3), rng.normal(size=(3, 2)), \
        rng.normal(size=(3, 2)), rng.normal(size=2), rng.normal(size=2)


def around_impact(rng, before=0.01, behind=0.01):
    """Return (arguments of bounce, (v, dx, dv) just after it) by imaginary parts of a flight from before to behind."""
    n, e, place, v, g, dx, dv, e_s, gap_s = drawn_impact(rng)

    def tau_of(s):
        """The time at which  gap(s) + rate t + ½ a t² = 0  near 0."""
        gap, rate, curve = (dx @ s) @ n + gap_s @ s, (v + dv @ s) @ n, g @ n
        return -2.0 * gap / (rate - np.sqrt(rate * rate - 2.0 * curve * gap))

    def end(s):
        """x and v at the time 0, as the flight after the impact says."""
        tau = tau_of(s)
        x_hit, v_hit = place + dx @ s + tau * (v + dv @ s) + 0.5 * tau**2 * g, v + dv @ s + tau * g
        new = v_hit - (1.0 + e + e_s @ s) * (v_hit @ n) * n
        return np.concatenate((x_hit - tau * new + 0.5 * tau**2 * g, new - tau * g))
    state, slopes = by_complex_numbers(end, np.zeros(2))
    tau = by_complex_numbers(lambda s: np.array([tau_of(s)]), np.zeros(2))[1][0]
    return (n, e, v, g, dx, dv, e_s, gap_s), tau, (state[3:], slopes[:3], slopes[3:])


@random_law("The time of an impact moves with the inputs, and so does the plane.", "largest error of ∂τ/∂s [s]", 1e-12)
def time_of_impact(lesson, rng):
    (n, _, v, g, dx, dv, _, gap_s), tau, _ = around_impact(rng)
    return lesson.event_time_sensitivity(n, np.zeros(3), gap_s, v, g, dx, dv), tau


@random_law("An event may depend on the velocity: a turning point.",
            "largest error of ∂τ/∂s of a turning point [s]", 1e-12)
def turning_point(lesson, rng):
    n, v, g = rng.normal(size=3), rng.normal(size=3), rng.normal(size=3)
    v -= (v @ n) / (n @ n) * n                                  # v · n = 0: it turns now
    dx, dv, gap_s = rng.normal(size=(3, 2)), rng.normal(size=(3, 2)), rng.normal(size=2)
    return lesson.event_time_sensitivity(np.zeros(3), n, gap_s, v, g, dx, dv), -(n @ dv + gap_s) / (n @ g)


@random_law("A bounce has the sensitivities of the whole flight through it.",
            "largest error of dx and dv [m, m/s]", 1e-12)
def through_bounce(lesson, rng):
    (n, e, v, g, dx, dv, e_s, gap_s), _, truth = around_impact(rng)
    return lesson.bounce(v, g, dx, dv, n, e, gap_s, e_s), truth


@random_law("Saltation at a plane where the acceleration changes, too.",
            "largest error of dx and dv with a jump of a [m, m/s]", 1e-12)
def jump_of_acceleration(lesson, rng):
    """The point passes a plane behind which another force acts: v stays, and a jumps."""
    n, _, _, v, a, dx, dv, _, _ = drawn_impact(rng)
    a_new = rng.normal(size=3)

    def end(s):
        gap, rate, curve = (dx @ s) @ n, (v + dv @ s) @ n, a @ n
        tau = -2.0 * gap / (rate - np.sqrt(rate * rate - 2.0 * curve * gap))
        x_hit, v_hit = dx @ s + tau * (v + dv @ s) + 0.5 * tau**2 * a, v + dv @ s + tau * a
        return np.concatenate((x_hit - tau * v_hit + 0.5 * tau**2 * a_new, v_hit - tau * a_new))
    slopes = by_complex_numbers(end, np.zeros(2))[1]
    dtau = -(n @ dx) / (n @ v)
    return lesson.saltation(dtau, dx, dv, v, a, v, a_new, np.eye(3), np.zeros((3, 2))), (slopes[:3], slopes[3:])


@random_law("A flight over two planes has the sensitivities of the whole flight, and to the restitution of each plane.",
            "largest error of a flight [m, m/s]", 1e-11)
def flight_over_planes(lesson, rng):
    """The flight ends before the ball comes to rest, which takes longer than T where e ≥ 0.7."""
    n = np.array([(0.0, 1.0), (-np.cos(0.2), np.sin(0.2))])
    feet, e = np.array([(0.0, 0.0), (rng.uniform(2.0, 3.0), 0.0)]), rng.uniform(0.7, 0.9, 2)
    hand, s, T = np.array([0.0, rng.uniform(0.5, 1.5)]), rng.uniform((3.0, -2.0), (5.0, 2.0)), rng.uniform(0.9, 1.3)
    planes = lambda e: [Plane(*one) for one in zip(n, feet, e)]
    end = lambda s: np.concatenate(bounced_flight(hand, s[:2], T, DOWN, planes(s[2:]))[:2])
    state, slopes = by_complex_numbers(end, np.concatenate((s, e)))
    course = Course(DOWN, n, feet, e, np.eye(2, 4, 2))
    x, v, dx, dv = lesson.flight(hand, s, np.zeros((2, 4)), np.eye(2, 4), T, course)
    return (x, v, dx, dv), (state[:2], state[2:], slopes[:2], slopes[2:])


@random_law("A difference and a complex step have the errors of their series.",
            "largest error of differences [-]", 1e-11)
def series_of_differences(lesson, rng):
    s, h = rng.uniform(-1.0, 1.0), 10.0 ** rng.uniform(-3.0, -1.0)
    c, odd = series_of(wave, s), np.arange(1, 32, 2)
    central = np.sum(c[odd] * h ** (odd - 1.0))
    turned = np.sum(c[odd] * (-1.0) ** ((odd - 1) // 2) * h ** (odd - 1.0))
    return (lesson.central_difference(wave, s, h, None), lesson.complex_step(wave, s, h, None)), (central, turned)


@random_law("best_step is where the sum of truncation and round-off is smallest.", "largest error of log h [-]", 1e-6)
def best_of_sum(lesson, rng):
    value, third, rounding = rng.normal(), rng.normal(), 10.0 ** rng.uniform(-16.0, -7.0)
    total = lambda u: np.log(np.exp(2.0 * u) * abs(third) / 6.0 + rounding * abs(value) / np.exp(u))
    found = minimize_scalar(total, bracket=(-15.0, -5.0), tol=1e-14)
    return np.log(lesson.best_step(value, third, rounding)), found.x


@random_law("The horizon is where the tangent of a falling pencil reaches the allowed error.",
            "largest error of the horizon [-]", 1e-12)
def horizon(lesson, rng):
    rate, error, allowed = rng.uniform(0.5, 5.0), 10.0 ** rng.uniform(-9.0, -3.0), rng.uniform(0.01, 1.0)
    T = lesson.predicted_horizon(rate, error, allowed)
    return 0.5 * error * (np.exp(rate * T) + np.exp(-rate * T)) / allowed, 1.0


@random_law("Newton's method finds the root of a miss, and doubles its digits.", "largest error of the aim [m]", 1e-11)
def aimed(lesson, rng):
    root = rng.uniform(-1.0, 1.0, 2)
    A = np.eye(2) + rng.uniform(-0.3, 0.3, (2, 2))

    def miss(s, p):
        d = s - root
        return A @ (d + 0.1 * d * d), A @ (np.eye(2) + np.diag(0.2 * d))
    found, misses = lesson.aim(miss, root + rng.uniform(-0.5, 0.5, 2), 1e-12, 30, None)
    return (found, float(misses[-1] <= 1e-12), float(len(misses) <= 8)), (root, 1.0, 1.0)


class Push(NamedTuple):
    """Of a body of 1 kg: s cos t."""
    s: float                 # amplitude [N]


@random_law("The sensitivities of a body that is pushed by s cos t are sums over its steps.",
            "pushed body: largest error of the state and its derivatives by s [m, m/s, m/N, m/(N s)]", 1e-9)
def pushed_in_time(lesson, rng):
    """Each step has its own time: v gains dt s cos tₖ, and dv/ds gains dt cos tₖ."""
    (x, v, dx, dv), n, p = rng.normal(size=(4, 1)), 5, Push(rng.normal())
    t, dt = rng.uniform(0.0, 2.0), rng.uniform(0.01, 0.1)
    none = np.zeros((1, 1))
    end = lesson.advance_tangents(lesson.tangent_step, lambda t, x, v, p: np.array([p.s * np.cos(t)]),
                                  lambda t, x, v, p: (none, none, np.array([[np.cos(t)]])), t, x, v, dx[:, None],
                                  dv[:, None], dt, n, p)
    gains = np.cumsum(dt * np.cos(t + dt * np.arange(n)))
    way, gain = dt * np.sum(gains), gains[-1]
    truth = x + n * dt * v + p.s * way, v + p.s * gain, dx + n * dt * dv + way, dv + gain
    return tuple(np.ravel(one) for one in end), truth


@case("laws-of-sensitivities", "Sensitivities of steps, events and flights", compiled=False)
def laws_of_sensitivities(lesson, check):
    """Compare every function with imaginary parts of the same motion, or with a closed form."""
    check.laws(lesson, (tangent_of_symplectic, tangent_of_implicit, time_of_impact, turning_point, through_bounce,
                        jump_of_acceleration, flight_over_planes, series_of_differences, best_of_sum, horizon, aimed,
                        pushed_in_time), seed=12, times=TRIED)


@case("throws-that-cannot-hit", "Throws that overshoot, and throws that cannot hit", compiled=False)
def throws_that_cannot_hit(lesson, check):
    """Check that the search halves steps that overshoot, and says so when no throw hits.

    atan has its only root at 0.  Newton's method on it diverges from |s| > 1.3917, the root of  2s = (1 + s²) atan s;
    with halved steps it arrives from everywhere.  A miss of 1 + s² has no root.
    """
    bent = lambda s, p: (np.arctan(s), np.diag(1.0 / (1.0 + s * s)))
    starts = (1.0, 1.4, 3.0, 20.0)
    arrived = sum(abs(lesson.aim(bent, np.array([s]), 1e-12, 60, None)[0][0]) < 1e-11 for s in starts)
    check.count("Halved steps arrive also where Newton's steps overshoot.", "arrivals", arrived, len(starts),
                "starts arrive at the root of atan.")
    downhill = all(np.all(np.diff(lesson.aim(bent, np.array([s]), 1e-12, 60, None)[1]) < 0.0) for s in starts)
    check.count("The miss falls in every iteration.", "searches whose misses fall", int(downhill), 1, "answer is yes.")
    try:
        lesson.aim(lambda s, p: (1.0 + s * s, np.diag(2.0 * s)), np.array([1.0]), 1e-12, 60, None)
        refused = 0
    except (Diverged, np.linalg.LinAlgError):
        refused = 1
    check.count("A miss that cannot be zero is refused.", "refusals", refused, 1, "search ends in a typed error.")
    feet = np.array([(0.0, 0.0), (3.0, 0.0)])
    course = Course(DOWN, np.array([UP, (-1.0, 0.0)]), feet, np.array([0.8, 0.7]), np.zeros((2, 2)))
    throw = Throw(course, np.array([0.0, 1.0]), np.array([1.5, 0.4]), 1.3)
    s, misses = lesson.aim(lesson.throw_miss, np.array([3.5, 1.0]), 1e-12, 20, throw)
    check("A throw over the floor and an upright wall has v_x = (wall + (wall − x)/e)/T.", "v_x of the throw [m/s]",
          law=(3.0 + 1.5 / 0.7) / 1.3, found=s[0], within=1e-12, saw=f"It hits after {len(misses) - 1} corrections.")
