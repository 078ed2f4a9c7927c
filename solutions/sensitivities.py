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

from .checks import (
    BadInput,
    Diverged,
    check_not_negative,
    check_positive,
    finite_array,
    finite_number,
    whole_number,
)
from .impulses import free_flight, impact_time, kinematic_response
from .integrators import implicit_euler_step, solve

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
    ### BEGIN SOLUTION 12.1
    return (f(s + h, p) - f(s - h, p)) / (2.0 * h)
    ### END SOLUTION


def best_step(value, third, round_off):
    """Return the h > 0 with which a central difference has the smallest error bound.

    *Find* it.  The bound is the sum of the truncation error h² |f‴|/6 and the round-off  round_off |f|/h.

    value is f and third is f‴, numbers of either sign; round_off > 0 is the relative error of f [-].  Where f‴ = 0, a
    longer step always has the smaller bound: return infinity.
    *Source:* Press et al. 2007, “Numerical Recipes”, 5.7.
    """
    ### BEGIN SOLUTION 12.2
    # The derivative of the bound is zero:  h |f‴|/3 = round_off |f|/h²
    if third == 0.0:
        return np.inf
    return (3.0 * round_off * np.abs(value) / np.abs(third)) ** (1.0 / 3.0)
    ### END SOLUTION


def complex_step(f, s, h, p):
    """Return the derivative of f at s from one value at a complex number:  Im f(s + i h) / h.

    f(s, p) computes a number or an array with a complex s, without np.abs, comparisons or conjugates.
    The formula subtracts nothing, so nothing cancels: the error is h² f‴/6 only, and h = 1e-20 gives all digits that
    f itself does not lose.
    *Source:* Squire and Trapp 1998.
    """
    ### BEGIN SOLUTION 12.3
    return np.imag(f(s + 1j * h, p)) / h
    ### END SOLUTION


# ---------------------------------------------------------------------------------------------- of a step

def tangent_step(acceleration, derivatives, t, x, v, dx, dv, dt, p):
    """Advance (x, v) by one step of symplectic Euler, and its sensitivities (dx, dv) with it; return all four.

    vₙ₊₁ = vₙ + dt a(tₙ, xₙ, vₙ)                        dvₙ₊₁ = dvₙ + dt (a_x dxₙ + a_v dvₙ + a_s)
    xₙ₊₁ = xₙ + dt vₙ₊₁                                 dxₙ₊₁ = dxₙ + dt dvₙ₊₁

    (a_x, a_v, a_s) = derivatives(t, x, v, p) at the place at which the step takes the acceleration.  The products are
    those of matrices, (d, d) times (d, m).
    dt is no input: it does not depend on s.
    """
    ### BEGIN SOLUTION 12.4
    a_x, a_v, a_s = derivatives(t, x, v, p)
    v_new = v + dt * acceleration(t, x, v, p)
    dv_new = dv + dt * (a_x @ dx + a_v @ dv + a_s)
    return x + dt * v_new, v_new, dx + dt * dv_new, dv_new
    ### END SOLUTION


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
    ### BEGIN SOLUTION 12.5
    # (1 − dt a_v − dt² a_x) dvₙ₊₁ = dvₙ + dt (a_x dxₙ + a_s),   all derivatives at the new time and state
    x_new, v_new = implicit_euler_step(acceleration, t, x, v, dt, p)
    a_x, a_v, a_s = derivatives(t + dt, x_new, v_new, p)
    dv_new = solve(np.eye(x.size) - dt * a_v - dt * dt * a_x, dv + dt * (a_x @ dx + a_s))
    return x_new, v_new, dx + dt * dv_new, dv_new
    ### END SOLUTION


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
    ### BEGIN SOLUTION 12.6
    # dtau = −(g_x dx + g_v dv + g_s) / (g_x · v + g_v · a)
    rate = gap_x @ v + gap_v @ a
    if np.abs(rate) <= GRAZING * (np.abs(gap_x) @ np.abs(v) + np.abs(gap_v) @ np.abs(a)):
        raise BadInput("rate of the event", rate, "an event that only grazes has no sensitivity: change the inputs")
    return -(gap_x @ dx + gap_v @ dv + gap_s) / rate
    ### END SOLUTION


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
    ### BEGIN SOLUTION 12.7
    # dx⁺ = dx⁻ + (v⁻ − v⁺) dtauᵀ,      dv⁺ = R_v (dv⁻ + a⁻ dtauᵀ) + R_s − a⁺ dtauᵀ
    at_impact = dv + np.outer(a, dtau)
    return dx + np.outer(v - v_new, dtau), R_v @ at_impact + R_s - np.outer(a_new, dtau)
    ### END SOLUTION


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
    ### BEGIN SOLUTION 12.8
    v_new = kinematic_response(v, n, e)
    dtau = event_time_sensitivity(n, 0.0 * n, gap_s, v, a, dx, dv)
    R_v = np.eye(v.size) - (1.0 + e) * np.outer(n, n)
    R_s = -(v @ n) * np.outer(n, e_s)
    dx, dv = saltation(dtau, dx, dv, v, a, v_new, a, R_v, R_s)
    return v_new, dx, dv
    ### END SOLUTION


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
    ### BEGIN SOLUTION 12.9
    # k = log(remainder / next remainder) / log(h / next h)
    logs = np.zeros(steps.size)
    for i in range(steps.size):
        h = steps[i]
        remainder = np.abs(f(s + h * direction, p) - f(s, p) - h * (gradient @ direction))
        check_positive("remainder of a step", remainder)
        logs[i] = np.log(remainder)
    return (logs[1:] - logs[:-1]) / (np.log(steps[1:]) - np.log(steps[:-1]))
    ### END SOLUTION


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
    ### BEGIN SOLUTION 12.10
    s, tolerance, most = checked_search(s, tolerance, most)
    misses = np.zeros(most + 1)
    r, J = miss(s, p)
    misses[0] = np.sqrt(r @ r)
    for i in range(most):
        if misses[i] <= tolerance:
            return s, misses[:i + 1]
        step = solve(J, r)
        for _ in range(MOST_HALVINGS + 1):
            r, J = miss(s - step, p)
            if np.sqrt(r @ r) < misses[i]:
                break
            step = 0.5 * step
        else:
            raise Diverged("miss of the last throw", misses[i], "begin elsewhere, or allow more iterations")
        s, misses[i + 1] = s - step, np.sqrt(r @ r)
    if misses[most] <= tolerance:
        return s, misses
    raise Diverged("miss of the last throw", misses[most], "begin elsewhere, or allow more iterations")
    ### END SOLUTION


# ---------------------------------------------------------------------------------------------- how long they help

def predicted_horizon(rate, error, allowed):
    """Return the time [s] after which an error of the initial position has grown to `allowed` [m].

    *Find* it before you run anything.  A pencil stands almost on its tip: ẍ = rate² x, released at rest.  Its position
    at the start is known up to `error` [m], its velocity is exactly 0.

    rate > 0 [1/s], error > 0 [m].  Where allowed is at most error, the time is 0.
    A smaller error helps little: a tenth of it gains  ln 10/rate  only.
    *Source:* the tangent of ẍ = rate² x.
    """
    ### BEGIN SOLUTION 12.11
    # the sensitivity of x to its start is cosh(rate t)
    if allowed <= error:
        return 0.0
    return np.arccosh(allowed / error) / rate
    ### END SOLUTION


def bounced_curve_is():
    """Return "A", "B", "C" or "D": the curve of the heights after a bounce on a floor with e = 0.5.

    *Find* it before you run anything.  Balls are dropped from rest at heights h from 0.9 to 1 m.  Each bounces once.
    At the time at which the highest ball touches the floor, how does the height of a ball depend on its h?

    The notebook draws the four curves, each less its first height.
    """
    ### BEGIN SOLUTION 12.12
    # slope −e at the last ball: a ball from higher comes later, and has had less time to rise with e v
    return "B"
    ### END SOLUTION
