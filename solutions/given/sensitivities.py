"""Given with lesson 12.  Runs with sensitivities, flights over planes that a ball bounces off, throws at a target."""

from typing import NamedTuple

import numpy as np

from ..checks import (
    Diverged,
    check_end,
    check_law,
    check_shape,
    checked_run,
    finite_array,
    finite_number,
)
from ..sensitivities import *  # noqa: F403    one import has a lesson and its given functions
from ..sensitivities import bounce, free_flight, impact_time
from ..support.records import check_record

MOST_BOUNCES = 1000          # of one flight [-]: a ball that needs more comes to rest


class Course(NamedTuple):
    """Planes without friction that a ball flies over and bounces off."""
    gravity: np.ndarray      # (d,) [m/s²]
    n: np.ndarray            # (planes, d) unit normals
    point: np.ndarray        # (planes, d) a point of each plane [m]
    e: np.ndarray            # (planes,) restitution [-]
    e_s: np.ndarray          # (planes, m) derivatives of e with respect to the inputs


class Throw(NamedTuple):
    """A throw that shall be at a target at the end of its flight."""
    course: Course
    x: np.ndarray            # (d,) where the ball is thrown [m]
    target: np.ndarray       # (d,) where it shall be [m]
    duration: float          # of the flight [s]


# ---------------------------------------------------------------------------------------------- many steps

def checked_tangents(acceleration, derivatives, t, x, v, dx, dv, p):
    """Given.  Return (dx, dv), each (d, m), in float64.  Raises BadInput unless they and the law fit the state (d,)."""
    dx, dv = finite_array("sensitivity dx", dx), finite_array("sensitivity dv", dv)
    check_shape("the position x", x, (x.size,))
    check_shape("the sensitivity dx", dx, (x.size, dx.size // x.size))
    check_shape("the sensitivity dv", dv, dx.shape)
    check_law("acceleration [m/s²]", acceleration(t, x, v, p), x.shape)
    a_x, a_v, a_s = derivatives(t, x, v, p)
    check_law("derivative a_x", a_x, (x.size, x.size))
    check_law("derivative a_v", a_v, (x.size, x.size))
    check_law("derivative a_s", a_s, dx.shape)
    return dx, dv


def advance_tangents(step, acceleration, derivatives, t, x, v, dx, dv, dt, steps, p):
    """Given.  Return (x, v, dx, dv) after `steps` steps of tangent_step or of tangent_implicit_step.

    Raises BadInput for a step that is not positive, a state that is not finite, or sensitivities of another shape;
    Diverged when the final state is not finite.
    """
    check_record(p, x)
    t, x, v, dt, steps = checked_run(t, x, v, dt, steps)
    dx, dv = checked_tangents(acceleration, derivatives, t, x, v, dx, dv, p)
    for n in range(steps):
        x, v, dx, dv = step(acceleration, derivatives, t + n * dt, x, v, dx, dv, dt, p)
    check_end(x, v, dt)
    check_end(dx, dv, dt)
    return x, v, dx, dv


def tangent_trajectory(step, acceleration, derivatives, t, x, v, dx, dv, dt, steps, p):
    """Given.  Return ts (steps + 1,), xs, vs (steps + 1, d), dxs and dvs (steps + 1, d, m) of the same run."""
    check_record(p, x)
    t, x, v, dt, steps = checked_run(t, x, v, dt, steps)
    dx, dv = checked_tangents(acceleration, derivatives, t, x, v, dx, dv, p)
    ts = t + dt * np.arange(steps + 1)
    xs, vs = np.zeros((steps + 1, *x.shape)), np.zeros((steps + 1, *x.shape))
    dxs, dvs = np.zeros((steps + 1, *dx.shape)), np.zeros((steps + 1, *dx.shape))
    xs[0], vs[0], dxs[0], dvs[0] = x, v, dx, dv
    for n in range(steps):
        x, v, dx, dv = step(acceleration, derivatives, t + n * dt, x, v, dx, dv, dt, p)
        check_end(x, v, dt)
        check_end(dx, dv, dt)
        xs[n + 1], vs[n + 1], dxs[n + 1], dvs[n + 1] = x, v, dx, dv
    return ts, xs, vs, dxs, dvs


# ---------------------------------------------------------------------------------------------- flights over planes

def next_impact(x, v, left, p):
    """Given.  Return (τ [s], plane): when and on which plane of a Course a ball bounces next; (left, 0) if not before.
    """
    first, plane = left, 0
    for k in range(p.e.size):
        tau = impact_time((x - p.point[k]) @ p.n[k], v @ p.n[k], p.gravity @ p.n[k], left)
        if tau < first:
            first, plane = tau, k
    return first, plane


def fly(x, v, dx, dv, duration, p):
    """Given.  Return (x, v, dx, dv) after `duration` [s] of a ball over a Course, bounce by bounce; exact.

    Raises Diverged after MOST_BOUNCES bounces, and what bounce raises.
    """
    left, still = duration, np.zeros(dx.shape[1])
    for _ in range(MOST_BOUNCES):
        tau, k = next_impact(x, v, left, p)
        x, v = free_flight(x, v, p.gravity, tau)
        dx = dx + tau * dv
        if tau >= left:
            return x, v, dx, dv
        left -= tau
        v, dx, dv = bounce(v, p.gravity, dx, dv, p.n[k], p.e[k], still, p.e_s[k])
        x = x - (x - p.point[k]) @ p.n[k] * p.n[k]       # removes round-off
    raise Diverged("bounces without end in a flight of [s]", duration, "end it before the ball comes to rest")


def flight(x, v, dx, dv, duration, p):
    """Given.  Return (x, v, dx, dv) after `duration` [s] of a ball over a Course: as fly, with checked inputs.

    x, v (d,), and dx, dv (d, m) at the start: dx = 1 if the inputs are the position, zero for a restitution.
    Raises BadInput for a state that is not finite and for shapes that do not fit; Diverged as fly does.
    """
    check_record(p, x)
    x, v = finite_array("position x [m]", x), finite_array("velocity v [m/s]", v)
    dx, dv = finite_array("sensitivity dx", dx), finite_array("sensitivity dv", dv)
    check_shape("the position x", x, (p.n.shape[1],))
    check_shape("the velocity v", v, x.shape)
    check_shape("the sensitivity dx", dx, (x.size, p.e_s.shape[1]))
    check_shape("the sensitivity dv", dv, dx.shape)
    return fly(x, v, dx, dv, finite_number("duration [s]", duration), p)


def throw_miss(s, p):
    """Given.  Return (r, J) of a Throw with the velocity s (d,): how far [m] the ball is from its target at the end.

    r = x(duration) − target,       J = ∂r/∂s (d, d) [s];       e_s of the course is zero
    """
    x, _, dx, _ = fly(p.x, s, np.zeros((s.size, s.size)), np.eye(s.size), p.duration, p.course)
    return x - p.target, dx


# ---------------------------------------------------------------------------------------------- examples

def forward_difference(f, s, h, p):
    """Given.  Return the derivative of f at s from two values:  (f(s + h) − f(s)) / h,  of first order in h."""
    return (f(s + h, p) - f(s, p)) / h


def oscillator_derivatives(t, x, v, p):
    """Given.  Return (a_x (d, d), a_v (d, d), a_s (d, 2)) of an Oscillator of lesson 1:  a = −ω² x − 2ζω v.

    The inputs are relative changes of the stiffness, k = ω² m, and of the damper, c = 2ζω m.
    """
    a_s = np.zeros((x.size, 2))
    a_s[:, 0], a_s[:, 1] = -p.omega * p.omega * x, -2.0 * p.zeta * p.omega * v
    return -p.omega * p.omega * np.eye(x.size), -2.0 * p.zeta * p.omega * np.eye(x.size), a_s
