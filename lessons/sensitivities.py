"""Lesson 12.  Sensitivities: how the result of a motion depends on its inputs.

    dx = ∂x/∂s,      dv = ∂v/∂s,      δx ≈ dx δs      for a small change δs of the inputs

Symbols: s (m,) the inputs: initial values, parameters, or a restitution · x, v (d,) [m], [m/s] a point at the time t ·
dx, dv (d, m) its sensitivities, per unit of the input; column k belongs to s_k · τ [s] the time of an event,
dtau (m,) = ∂τ/∂s · a_x, a_v (d, d), a_s (d, m) the derivatives of the acceleration a(t, x, v) with respect to x, to v,
and to the inputs on which it depends itself · e restitution, e_s (m,) = ∂e/∂s · n unit normal · h step of a
difference · r (k,) a miss and J (k, k) = ∂r/∂s · p parameters of the scene, passed on unchanged.

The sensitivities of a method are the derivatives of its own numbers: each line of a step is differentiated.  At an
event, the time depends on the inputs, too.
Given in solutions/given/sensitivities.py: the loops advance_tangents and tangent_trajectory, flight over planes, and
throw_miss.
*Left out:* adjoint (reverse) sensitivities, which are quicker for many inputs and one result; friction; lasting
contacts.
"""

import numpy as np

from solutions.checks import (
    BadInput,
    Diverged,
    check_not_negative,
    check_positive,
    finite_array,
    finite_number,
    whole_number,
)
from solutions.impulses import free_flight, impact_time, kinematic_response
from solutions.integrators import implicit_euler_step, solve

__all__ = [
    "GRAZING", "MOST_HALVINGS", "aim", "best_step", "bounce", "bounced_curve_is", "central_difference",
    "checked_search", "complex_step", "event_time_sensitivity", "free_flight", "impact_time", "implicit_euler_step",
    "kinematic_response", "predicted_horizon", "remainder_orders", "saltation", "solve", "tangent_implicit_step",
    "tangent_step",
]

GRAZING = 1e-12              # rate of an event over the sizes of its terms [-]: 5000 roundings; below, it is zero
MOST_HALVINGS = 40           # of one Newton step [-]: 2⁻⁴⁰ of it changes the twelfth digit


# ---------------------------------------------------------------------------------------------- differences

def central_difference(f, s, h, p):
    """Return the derivative of f at s from two values:  (f(s + h) − f(s − h)) / 2h.

    f(s, p) is a number or an array, s a number, and h > 0 has the unit of s.
    The truncation error is h² f‴/6.  Round-off adds about ε |f|/h, so a smaller h is not always better.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 12.1: central_difference")


def best_step(value, third, round_off):
    """Return the h > 0 with which a central difference has the smallest error bound.

    *Find* it.  The bound is the sum of the truncation error h² |f‴|/6 and the round-off  round_off |f|/h.

    value is f and third is f‴, numbers of either sign; round_off > 0 is the relative error of f [-].  Where f‴ = 0, a
    longer step always has the smaller bound: return infinity.
    *Source:* Press et al. 2007, “Numerical Recipes”, 5.7.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 12.2: best_step")


def complex_step(f, s, h, p):
    """Return the derivative of f at s from one value at a complex number:  Im f(s + i h) / h.

    f(s, p) computes a number or an array with a complex s, without np.abs, comparisons or conjugates.
    The formula subtracts nothing, so nothing cancels: the error is h² f‴/6 only, and h = 1e-20 gives all digits that
    f itself does not lose.
    *Source:* Squire and Trapp 1998.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 12.3: complex_step")


# ---------------------------------------------------------------------------------------------- of a step

def tangent_step(acceleration, derivatives, t, x, v, dx, dv, dt, p):
    """Advance (x, v) by one step of symplectic Euler, and its sensitivities (dx, dv) with it; return all four.

    vₙ₊₁ = vₙ + dt a(tₙ, xₙ, vₙ)                        dvₙ₊₁ = dvₙ + dt (a_x dxₙ + a_v dvₙ + a_s)
    xₙ₊₁ = xₙ + dt vₙ₊₁                                 dxₙ₊₁ = dxₙ + dt dvₙ₊₁

    (a_x, a_v, a_s) = derivatives(t, x, v, p) at the place at which the step takes the acceleration.  The products are
    those of matrices, (d, d) times (d, m).
    dt is no input: it does not depend on s.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 12.4: tangent_step")


def tangent_implicit_step(acceleration, derivatives, t, x, v, dx, dv, dt, p):
    """Advance (x, v) by implicit_euler_step of lesson 1, and its sensitivities (dx, dv) with it; return all four.

    *Find* dv.  Newton's iterations need not be differentiated: the new velocity obeys
        vₙ₊₁ = vₙ + dt a(tₙ + dt, xₙ + dt vₙ₊₁, vₙ₊₁)
    whichever way it was found.  Differentiate this equation with respect to s, and solve it for dvₙ₊₁.

    (a_x, a_v, a_s) = derivatives(…), at the time and the state that the differentiated equation has; the law need not
    be linear.  solve(A, B) of lesson 1 solves A Y = B for a matrix B (d, m), too.  xₙ₊₁ = xₙ + dt vₙ₊₁ gives dxₙ₊₁.
    Raises Diverged as implicit_euler_step does.
    *Source:* the implicit function theorem.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 12.5: tangent_implicit_step")


# ---------------------------------------------------------------------------------------------- of an event

def event_time_sensitivity(gap_x, gap_v, gap_s, v, a, dx, dv):
    """Return dtau (m,): how the time τ of an event  g(x, v; s) = 0  depends on the inputs.

    *Find* it: for all inputs, g is zero at the state that the motion has at its own τ.  A change of s_k by 1 changes
    this state by dx and dv at a fixed time, and by v dtau and a dtau because τ changes.

    gap_x, gap_v (d,) and gap_s (m,) are the derivatives of g with respect to x, to v, and to the inputs on which it
    depends itself.  v and a are those before the event, dx and dv (d, m) the sensitivities before it.
    Raises BadInput("rate of the event", rate, "an event that only grazes has no sensitivity: change the inputs") where
    the rate of g along the motion is at most GRAZING times the sum of the sizes |g_x,i v_i| + |g_v,i a_i| of its terms.
    *Left out:* events that depend on t itself, such as those of a floor that moves; then ∂g/∂t adds to the rate.
    *Source:* the implicit function theorem; Hiskens and Pai 2000.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 12.6: event_time_sensitivity")


def saltation(dtau, dx, dv, v, a, v_new, a_new, R_v, R_s):
    """Return (dx, dv) just after an impact, at which the velocity jumps to  v⁺ = R(v⁻; s)  while x stays.

    *Find* both at a fixed time after the impact.  A change of the inputs moves the impact by dtau: until then the
    point has v⁻ and a⁻, and from then on v⁺ and a⁺.

    dtau (m,) from event_time_sensitivity; dx, dv (d, m), v and a (d,) before the impact; v_new, a_new (d,) after it;
    R_v (d, d) and R_s (d, m) the derivatives of R.
    A ball that is dropped from h on a floor with e has ∂x/∂h = −e just after the impact: −1 for e = 1, because a ball
    that is dropped from higher comes later, and is lower at the same time.
    *Source:* Aizerman and Gantmakher 1958; Leine and Nijmeijer 2004.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 12.7: saltation")


def bounce(v, a, dx, dv, n, e, gap_s, e_s):
    """Return (v, dx, dv) of a point just after its impact on a plane without friction.

    v⁺ = kinematic_response(v, n, e) = v − (1 + e) (v · n) n        of lesson 7
    dtau = event_time_sensitivity(…)     of the gap  φ = n · (x − point),  with φ_x = n, φ_v = 0, φ_s = gap_s
    (dx, dv) = saltation(…)              with R_v = 1 − (1 + e) n nᵀ,   R_s = −(v · n) n e_sᵀ,   and a⁺ = a

    v, a (d,), dx, dv (d, m) before the impact; n (d,) the unit normal, v · n < 0.  gap_s (m,) is zero unless an input
    moves the plane; e_s (m,) is zero unless e is an input or depends on one.
    Raises what event_time_sensitivity raises.
    *Left out:* accelerations that jump with the velocity, such as drag.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 12.8: bounce")


# ---------------------------------------------------------------------------------------------- what they are for

def remainder_orders(f, gradient, s, direction, steps, p):
    """Return (n − 1,) observed orders of  |f(s + h y) − f(s) − h g · y|,  one between each two successive h of steps.

    *Find* them: a remainder is about C hᵏ, so two of them give k.  For the gradient g of f it is 2 (Taylor), or more
    where f has no curvature along y.  For a wrong one it is 1, unless y is at right angles to the error of g.
    Round-off hides the remainder of a short step.

    f(s, p) is a number; s, gradient g and direction y are (m,) arrays, steps (n,) numbers above zero, all different.
    Raises BadInput for a remainder of exactly 0, from which no order can be computed: call
    check_positive("remainder of a step", remainder) for every remainder.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 12.9: remainder_orders")


def checked_search(s, tolerance, most):
    """Given.  Return (s, tolerance, most) in float64, and an int: what a search needs before its first iteration.

    Raises BadInput for an s that is not finite, a negative tolerance, and a `most` that is negative or not whole.
    """
    tolerance = finite_number("tolerance of a search", tolerance)
    check_not_negative("tolerance of a search", tolerance)
    return finite_array("inputs s", s), tolerance, whole_number("number of iterations", most, 0)


def aim(miss, s, tolerance, most, p):
    """Return (s, misses): inputs (k,) with which a throw hits, by Newton's method, and the sizes |r| on the way.

    *Make it* arrive from far away.  (r, J) = miss(s, p) is the miss r (k,) of the inputs s and its sensitivity
    J = ∂r/∂s (k, k).  Each iteration takes the step that would make r zero if r were linear.  Where the miss does not
    become smaller, or is NaN because a throw never arrives, this step goes too far: halve it until the miss is smaller,
    at most MOST_HALVINGS times.

    The search ends when |r| = √(r · r) is at most tolerance, after at most `most` iterations; misses (iterations + 1,)
    begins with that of the first s.  A miss within the tolerance needs no iteration.
    (s, tolerance, most) = checked_search(s, tolerance, most) comes first, and raises BadInput for what cannot be.
    Raises Diverged("miss of the last throw", |r|, "begin elsewhere, or allow more iterations") after `most` iterations,
    or if no halved step makes the miss smaller; |r| is that of the last s.
    solve of lesson 1 raises LinAlgError for a singular J.
    *Source:* Dennis and Schnabel 1983, 6.3.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 12.10: aim")


# ---------------------------------------------------------------------------------------------- how long they help

def predicted_horizon(rate, error, allowed):
    """Return the time [s] after which an error of the initial position has grown to `allowed` [m].

    *Find* it before you run anything.  A pencil stands almost on its tip: ẍ = rate² x, released at rest.  Its position
    at the start is known up to `error` [m], its velocity is exactly 0.

    rate > 0 [1/s], error > 0 [m].  Where allowed is at most error, the time is 0.
    A smaller error helps little: a tenth of it gains  ln 10/rate  only.
    *Source:* the tangent of ẍ = rate² x.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 12.11: predicted_horizon")


def bounced_curve_is():
    """Return "A", "B", "C" or "D": the curve of the heights after a bounce on a floor with e = 0.5.

    *Find* it before you run anything.  Balls are dropped from rest at heights h from 0.9 to 1 m.  Each bounces once.
    At the time at which the highest ball touches the floor, how does the height of a ball depend on its h?

    The notebook draws the four curves, each less its first height.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 12.12: bounced_curve_is")
