"""Lesson 1.  From acceleration to motion: eight methods for one time step.

    ẋ = v,   v̇ = a(t, x, v)

Symbols: t [s] time · x [m] position · v [m/s] velocity · a [m/s²] acceleration · dt [s] step · p parameters of
the scene.

Every method is a function  step(acceleration, t, x, v, dt, p) → (x, v)  at t + dt.  x and v are float arrays of
the same shape; any shape is allowed.  acceleration(t, x, v, p) returns an array of that shape; p is passed on to it
unchanged.
*Left out:* accelerations that are not smooth; contacts begin with lesson 3.
"""

from typing import NamedTuple

import numpy as np

from solutions.checks import (
    Diverged,
    check_end,
    check_law,
    check_not_negative,
    check_positive,
    checked_run,
    finite_number,
    float_copy,
    positive_number,
)
from solutions.support.records import check_record

__all__ = [
    "MOST_ADAPTED_STEPS", "NEWTON_LIMIT", "ROUND_OFF", "Oscillator", "advance", "advance_adaptive",
    "amplification_matrix", "average_velocity_step", "blanes_moan_step", "difference_step", "euler_step",
    "explicit_euler_is", "growth_per_period", "implicit_euler_step",
    "implicit_midpoint_step", "inner_product", "midpoint_step", "my_step", "newton_matrix", "observed_order",
    "oscillator_acceleration", "rk4_step", "solve", "spectral_radius", "symplectic_euler_step",
    "trajectory", "velocity_round_off", "verlet_step",
]

NEWTON_TOLERANCE = 1e-12     # last correction over the size of the velocity [-]: well above round-off, 2e-16
NEWTON_LIMIT = 30            # corrections [-]; from a good guess Newton doubles its digits and needs fewer than 8
MOST_ADAPTED_STEPS = 1000000 # of one run [-]: half a second, compiled; what needs more falls into the origin
ROUND_OFF = 1e-15            # a few spacings of floats [-]: the relative accuracy of any position or velocity
KICKS = (0.0829844064174052, 0.396309801498368, -0.0390563049223486)      # the fourth is 1 − 2 Σ, then backwards
DRIFTS = (0.245298957184271, 0.604872665711080)                           # the third is ½ − Σ, then backwards
SPLITTING = (
    (KICKS[0], DRIFTS[0]), (KICKS[1], DRIFTS[1]), (KICKS[2], 0.5 - DRIFTS[0] - DRIFTS[1]),
    (1.0 - 2.0 * (KICKS[0] + KICKS[1] + KICKS[2]), 0.5 - DRIFTS[0] - DRIFTS[1]),
    (KICKS[2], DRIFTS[1]), (KICKS[1], DRIFTS[0]), (KICKS[0], 0.0))
DIFFERENCE_STEP = 6e-6       # ∛(2.2e-16) [-]: balances truncation against round-off in a central difference
LEAST_DIFFERENCE = 1e-12     # of a position or of dt a [-]: 4000 roundings, which leave three digits to the change
UNDERFLOW = 1e-200           # velocity [m/s] that counts as none: what is computed from a smaller one loses its digits


# ---------------------------------------------------------------------------------------------- explicit methods

def euler_step(acceleration, t, x, v, dt, p):
    """Advance one step along the slope at its beginning; first order.

    xₙ₊₁ = xₙ + dt vₙ
    vₙ₊₁ = vₙ + dt a(tₙ, xₙ, vₙ)

    Evaluates the acceleration once.  An undamped oscillator gains energy in every step.
    *Source:* first lecture deck, “Euler method”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 1.1: euler_step")


def midpoint_step(acceleration, t, x, v, dt, p):
    """Advance one step along the slope at its middle; second order.

    *Find* the step from two sentences.  Half a step of Euler estimates the state at the middle of the step.  The slopes
    that are found there, that of x and that of v, carry the whole step from its beginning.

    Evaluates the acceleration twice: at tₙ, and at tₙ + ½dt.
    *Source:* first lecture deck, “Midpoint method”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 1.2: midpoint_step")


def rk4_step(acceleration, t, x, v, dt, p):
    """Advance one step along a weighted mean of four slopes (the classical Runge–Kutta method); fourth order.

    Each slope is a pair (velocity, acceleration): (v₁, a₁) at the beginning, (v₂, a₂) and (v₃, a₃) in the middle,
    (v₄, a₄) at the end, each reached along the slope before it:

    v₁ = vₙ                a₁ = a(tₙ,        xₙ,            v₁)
    v₂ = vₙ + ½dt a₁       a₂ = a(tₙ + ½dt,  xₙ + ½dt v₁,   v₂)
    v₃ = vₙ + ½dt a₂       a₃ = a(tₙ + ½dt,  xₙ + ½dt v₂,   v₃)
    v₄ = vₙ + dt a₃        a₄ = a(tₙ + dt,   xₙ + dt v₃,    v₄)

    xₙ₊₁ = xₙ + dt (v₁/6 + v₂/3 + v₃/3 + v₄/6)
    vₙ₊₁ = vₙ + dt (a₁/6 + a₂/3 + a₃/3 + a₄/6)

    Evaluates the acceleration four times.
    *Source:* first lecture deck, k₁/6 + k₂/3 + k₃/3 + k₄/6.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 1.3: rk4_step")


def average_velocity_step(acceleration, t, x, v, dt, p):
    """Advance one step with the acceleration at its beginning, as if that stayed constant; first order.

    *Find* both lines.  While the acceleration is constant, the velocity is a straight line over the time, from vₙ to
    vₙ₊₁.  The position moves by the area below this line.

    Evaluates the acceleration once, at tₙ.  Exact when the acceleration is constant.
    *Source:* first lecture deck, the last lines of “Mass-Spring-Damper System”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 1.4: average_velocity_step")


# ---------------------------------------------------------------------------------------------- geometric methods

def symplectic_euler_step(acceleration, t, x, v, dt, p):
    """Advance one step, velocity first; first order, and bounded energy error on an undamped oscillator while ω dt < 2.

    vₙ₊₁ = vₙ + dt a(tₙ, xₙ, vₙ)
    xₙ₊₁ = xₙ + dt vₙ₊₁                    with the new velocity

    *Source:* Hairer, Lubich, Wanner 2003, “Geometric numerical integration illustrated by the Störmer–Verlet method”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 1.5: symplectic_euler_step")


def verlet_step(acceleration, t, x, v, dt, p):
    """Advance one step of velocity Verlet; second order, and bounded energy error while ω dt < 2.

    *Find* both lines.  The position moves as if the acceleration at the beginning, aₙ, stayed constant.  The velocity
    changes by the mean of the accelerations at both ends.  The one at the end, aₙ₊₁, is taken at the new position, and
    with a velocity that a step of Euler predicts.

    The prediction matters only for accelerations that depend on velocity.  With it, the method has second order for
    those as well.
    *Source:* Swope et al. 1982; the prediction: Groot and Warren 1997 with λ = 1.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 1.6: verlet_step")


def blanes_moan_step(acceleration, t, x, v, dt, p):
    """Given.  Advance one step of seven kicks and six drifts; fourth order, for accelerations that do not depend on v.

    kick:  v ← v + kick dt a(t, x)         drift:  x ← x + drift dt v,   t ← t + drift dt     alternately, see SPLITTING
    With SPLITTING = ((0, ½), (1, ½)) this is leapfrog, so Verlet is the simplest member of this family.  The energy
    error stays bounded, as with Verlet.  It is smaller by orders of magnitude, for seven accelerations per step in
    place of two.
    *Source:* Blanes and Moan 2002, the Runge–Kutta–Nyström method SRKN₆ᵇ of order 4.
    """
    x, v = float_copy(x), float_copy(v)
    for kick, drift in SPLITTING:
        a = acceleration(t, x, v, p)
        for k in range(x.size):
            v.flat[k] += kick * dt * a.flat[k]
            x.flat[k] += drift * dt * v.flat[k]
        t += drift * dt
    return x, v


# ---------------------------------------------------------------------------------------------- implicit methods

def difference_step(acceleration, t, x, v, dt, p):
    """Given.  Return by how much [m/s] newton_matrix varies a velocity, relative to what the step itself can change.

    DIFFERENCE_STEP max|v|, but at least LEAST_DIFFERENCE (max|xₙ|/dt + dt max|a|): the round-off of a position, or of
    an acceleration, would hide a smaller change.
    """
    a = acceleration(t, x + dt * v, v, p)
    least = LEAST_DIFFERENCE * (np.max(np.abs(x)) / dt + dt * np.max(np.abs(a))) + UNDERFLOW
    return max(DIFFERENCE_STEP * np.max(np.abs(v)), least)


def newton_matrix(acceleration, t, x, v, dt, p):
    """Given.  Return the (n, n) matrix  1 − dt ∂a/∂v (t, x + dt v, v)  over the n entries of v, by central differences.

    It is the derivative of the residual  r(v) = v − vₙ − dt a(t, xₙ + dt v, v).  Newton's method finds the zero of
    this residual.
    """
    matrix, h = np.eye(v.size), difference_step(acceleration, t, x, v, dt, p)
    for k in range(v.size):
        ahead, behind = float_copy(v), float_copy(v)
        ahead.ravel()[k] += h
        behind.ravel()[k] -= h
        change = acceleration(t, x + dt * ahead, ahead, p) - acceleration(t, x + dt * behind, behind, p)
        for row in range(v.size):
            matrix[row, k] -= dt * change.ravel()[row] / (ahead.ravel()[k] - behind.ravel()[k])
    return matrix


def velocity_round_off(x, v, dt):
    """Given.  Return how well [m/s] a step of dt can know a velocity:  ROUND_OFF (max|v| + max|x|/|dt|) + UNDERFLOW.

    The second term is the round-off of a position far from the origin, expressed as a velocity.
    """
    return ROUND_OFF * (np.max(np.abs(v)) + np.max(np.abs(x)) / np.abs(dt)) + UNDERFLOW


def solve(matrix, right):
    """Given.  Return the y with matrix · y = right: (n, n) and (n,) arrays."""
    return np.linalg.solve(matrix, right)


def implicit_euler_step(acceleration, t, x, v, dt, p):
    """Advance one step along the slope at its end; first order, and stable on a decaying system for every step size.

    vₙ₊₁ = vₙ + dt a(tₙ + dt, xₙ + dt vₙ₊₁, vₙ₊₁)
    xₙ₊₁ = xₙ + dt vₙ₊₁

    The first line is an equation for vₙ₊₁ =: w.  Solve it by Newton's method: start from a copy of vₙ as w and
    repeat, at most NEWTON_LIMIT times,
        r = w − vₙ − dt a(tₙ + dt, xₙ + dt w, w)
        w ← w − δ,    newton_matrix(acceleration, tₙ + dt, xₙ, w, dt, p) · δ = r
    until max|δ| ≤ NEWTON_TOLERANCE · max|w| + velocity_round_off(xₙ, vₙ, dt).  This is relative to the motion: a fixed
    number such as 1e-12 m/s would be too much for a very small body, and too little for a very large one.
    newton_matrix, velocity_round_off and solve are given above.  r and δ are flat, (n,): use .ravel() and
    .reshape(v.shape).

    Raises Diverged("Newton's method did not converge at dt [s]", dt, "take a smaller step") after NEWTON_LIMIT
    corrections.  solve raises LinAlgError where dt² k/m exceeds 10¹⁶, because round-off then removes the 1 in the
    matrix.
    *Left out:* a body at rest at the origin where large terms of a cancel, so that only their round-off moves it: put
    the origin elsewhere.
    *Source:* Hairer and Wanner 1996, “Solving ordinary differential equations II”, IV.3 and IV.8.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 1.7: implicit_euler_step")


def implicit_midpoint_step(acceleration, t, x, v, dt, p):
    """Advance one step along the slope at its own middle; second order, exact energy of an undamped oscillator.

    x½ = ½(xₙ + xₙ₊₁),   v½ = ½(vₙ + vₙ₊₁)
    xₙ₊₁ = xₙ + dt v½
    vₙ₊₁ = vₙ + dt a(tₙ + ½dt, x½, v½)

    *Find* how to solve these equations with a function of this lesson.

    Raises Diverged like implicit_euler_step.
    *Source:* Hairer, Lubich, Wanner 2006, “Geometric numerical integration”, II.1 and IV.2.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 1.8: implicit_midpoint_step")


# ---------------------------------------------------------------------------------------------- many steps

def advance(step, acceleration, t, x, v, dt, steps, p):
    """Given.  Return the state (x, v) after `steps` steps of one method.

    Raises BadInput for a step that is not positive or a state that is not finite, Diverged when the final state is not
    finite.
    """
    check_record(p, x)
    t, x, v, dt, steps = checked_run(t, x, v, dt, steps)
    check_law("acceleration [m/s²]", acceleration(t, x, v, p), x.shape)
    for n in range(steps):
        x, v = step(acceleration, t + n * dt, x, v, dt, p)
    check_end(x, v, dt)
    return x, v


def trajectory(step, acceleration, t, x, v, dt, steps, p):
    """Given.  Return ts (steps + 1,), xs and vs (steps + 1, …): times and states of the same run, with the start."""
    check_record(p, x)
    t, x, v, dt, steps = checked_run(t, x, v, dt, steps)
    check_law("acceleration [m/s²]", acceleration(t, x, v, p), x.shape)
    ts = t + dt * np.arange(steps + 1)
    xs = np.zeros((steps + 1, *x.shape))
    vs = np.zeros((steps + 1, *v.shape))
    xs[0], vs[0] = x, v
    for n in range(steps):
        x, v = step(acceleration, t + n * dt, x, v, dt, p)
        check_end(x, v, dt)
        xs[n + 1], vs[n + 1] = x, v
    return ts, xs, vs


def inner_product(a, b):
    """Given.  Return Σ a b over all entries of two arrays of one shape."""
    total = 0.0
    for k in range(a.size):
        total += a.flat[k] * b.flat[k]
    return total


def advance_adaptive(step, acceleration, t, x, v, share, duration, p):
    """Given.  Return the state (x, v) after `duration` [s], in steps that adapt to the distance from the origin.

    On a circle, an attraction −μ x/|x|³ turns a motion at the rate ρ = √(|a|/|x|) = √(μ/|x|³) [1/s].  A step lasts
    dt = share/ρ: there, share is the angle of a step [rad].  ρ belongs to the middle of the step.  Its rate is
    ρ̇ = −3/2 ρ x·v/x², so over the time dt from one middle to the next it changes by −3/2 ρ dt x·v/x²:

        ρ ← √(|a|/|x|) − ½ share 3/2 x·v/x²            at the start, half a step ahead
        ρ ← ρ − share 3/2 x·v/x²                       between two steps

    The rule is symmetric in time, so a run backwards takes the same steps.  A method that keeps the energy over long
    times therefore still does so.  With dt = share √(|x|/|a|) at the beginning of each step it would not.  The last
    step is shorter: it ends at t + duration.

    Raises BadInput for a share that is not positive, a duration below zero or a state that is not finite.  Raises
    Diverged where ρ is not positive, because the steps are too long for the rule, and where more than
    MOST_ADAPTED_STEPS are needed or a step no longer changes the time, because the motion falls into the origin.
    *Source:* Hairer and Söderlind 2005, “Explicit, time reversible, adaptive step size control”.
    *Left out:* laws that are not ∝ 1/x², several centres.
    """
    check_record(p, x)
    t, x, v, share, _ = checked_run(t, x, v, positive_number("share of a step [-]", share), 0)
    dt = finite_number("duration [s]", duration)
    check_not_negative("duration [s]", dt)
    end, steps, a = t + dt, 0, acceleration(t, x, v, p)
    check_law("acceleration [m/s²]", a, x.shape)
    rate = np.sqrt(np.sqrt(inner_product(a, a) / inner_product(x, x)))
    rate -= 0.75 * share * inner_product(x, v) / inner_product(x, x)
    while t < end:
        if not (rate > 0.0 and np.isfinite(rate)):
            raise Diverged("the rate of an adapted step [1/s]", rate, "give a smaller share, and start off the origin")
        dt = min(share / rate, end - t)
        if steps == MOST_ADAPTED_STEPS or t + dt == t:
            raise Diverged("an adapted step leads no further; dt [s]", dt, "end before the motion reaches the origin")
        x, v = step(acceleration, t, x, v, dt, p)
        rate -= 1.5 * share * inner_product(x, v) / inner_product(x, x)
        t, steps = t + dt, steps + 1
    check_end(x, v, dt)
    return x, v


# ---------------------------------------------------------------------------------------------- how good is a method?

class Oscillator(NamedTuple):
    """The test problem for stability: ẍ = −ω² x − 2ζω ẋ."""
    omega: float         # undamped angular frequency ω [rad/s]
    zeta: float          # damping ratio ζ [-]: 1 is critical


def oscillator_acceleration(t, x, v, p):
    """Given.  Return a = −ω² x − 2ζω v  [m/s²] of an Oscillator p."""
    return -p.omega * p.omega * x - 2.0 * p.zeta * p.omega * v


def amplification_matrix(step, omega, zeta, dt):
    """Return the (2, 2) matrix A of one step on an oscillator: (xₙ₊₁, vₙ₊₁)ᵀ = A (xₙ, vₙ)ᵀ.

    *Find* the columns of A: from which two states must you take a step to see them?

    States are arrays of shape (1,).  The acceleration is oscillator_acceleration, and its parameters are an Oscillator.
    If an eigenvalue of A has an absolute value above 1, nearly every motion grows in the end, by that factor per step.
    *Source:* Hairer and Wanner 1996, IV.2.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 1.9: amplification_matrix")


def spectral_radius(matrix):
    """Given.  Return the largest absolute eigenvalue of a real (2, 2) matrix: the growth of the motion per step."""
    half_trace = 0.5 * (matrix[0, 0] + matrix[1, 1])
    determinant = matrix[0, 0] * matrix[1, 1] - matrix[0, 1] * matrix[1, 0]
    discriminant = half_trace * half_trace - determinant
    if discriminant < 0.0:                               # a complex pair: |λ|² = λ λ̄ = det A
        return np.sqrt(determinant)
    return abs(half_trace) + np.sqrt(discriminant)


def observed_order(dts, errors):
    """Return the observed order of convergence k of a series of runs, whose errors are about C dtᵏ.

    *Find* the formula: log(error) over log(dt) is a straight line, and k is its slope by least squares.

    dts and errors are (n,) arrays of positive numbers.
    Raises BadInput for any other number: call check_positive("step dt [s]", dt) for every dt of dts, and
    check_positive("error [-]", error) for every error of errors.
    A run with an error of exactly 0 gives no information about the order.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 1.10: observed_order")


# ---------------------------------------------------------------------------------------------- why?

def growth_per_period(steps):
    """Return the factor [-] by which Euler's method enlarges the amplitude of an undamped oscillator in one period.

    *Find* it before you run anything: a period 2π/ω is divided into `steps` equal steps.  The motion is a turn in the
    plane of ω x and v.  Which right triangle does one step of Euler make there?

    The amplitude is √(x² + (v/ω)²).  The factor does not depend on ω, nor on the start.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 1.11: growth_per_period")


def explicit_euler_is():
    """Return the letter of explicit Euler's curve in the figure of the notebook: "A", "B", "C" or "D".

    Each curve is the energy of the same undamped oscillator, by another method with the same step.  Read the growth
    per step off the figure, and compare it with the growth that one step of Euler must have.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 1.12: explicit_euler_is")


def my_step(acceleration, t, x, v, dt, p):
    """Advance one step by a method of your own, of second order or more, that keeps the energy of an oscillator.

    *Make it*, for accelerations a(t, x, v, p) that do not depend on v.  Many methods are right.  The judge demands:

    - Where the step is halved, the error on driven pendula falls at least to a quarter.
    - After 1,000 steps of ω dt = 0.2, the energy of an undamped oscillator is within 2 % of that at the start.
    - It is none of the other methods of this lesson: its steps end elsewhere.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 1.13: my_step")
