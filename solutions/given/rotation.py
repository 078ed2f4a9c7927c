"""Given with lesson 5.  Steps of a rigid body to compare with, loops over steps, and the checks before them."""

import numpy as np

from ..checks import (
    check_end,
    check_law,
    check_load,
    check_positive,
    check_shape,
    checked_run,
    finite_array,
    finite_number,
    positive_number,
    whole_number,
)
from ..rotation import *  # noqa: F403    one import has a lesson and its given functions
from ..rotation import (
    RigidBody,
    angular_acceleration,
    angular_velocity,
    axis_angle_update,
    body_angular_momentum,
    compose,
    matrix_update,
    midpoint_step,
    quaternion_product,
    quaternion_update,
    rotation_matrix,
    splitting_step,
)
from ..support.quaternions import check_rotation, quaternion_from_matrix, rotate, solve3, unit, unrotate
from ..support.records import check_principal_moments, check_record
from ..vectors import cross


def check_moments(I_body):
    """Given.  Raise BadInput unless these are moments of a body: positive, none above the sum of the others."""
    check_shape("the principal moments", I_body, (3,))
    for k in range(3):
        check_positive("a principal moment of inertia [kg m²]", I_body[k])
    check_principal_moments(I_body)


def checked_rotation(t, q, L, dt, steps, I_body):
    """Given.  Return (t, q, L, dt, steps) in float64, as advance_rotation needs them.

    Raises BadInput for a step that is not positive, a quaternion that is not a rotation, moments that no body has, an L
    that is not finite.
    """
    q = finite_array("quaternion q [-]", q)
    L = finite_array("angular momentum L [kg m²/s]", L)
    check_rotation(q)
    check_shape("the angular momentum L", L, (3,))
    check_moments(I_body)
    t, dt = finite_number("time t [s]", t), positive_number("step dt [s]", dt)
    return t, q, L, dt, whole_number("number of steps", steps, 0)


def advance_rotation(step, torque, t, q, L, dt, steps, body):
    """Given.  Return the state (q, L) after `steps` steps of one method.

    Raises what checked_rotation raises, and Diverged when the final state is not finite.
    """
    check_record(body, L)
    t, q, L, dt, steps = checked_rotation(t, q, L, dt, steps, body.I_body)
    check_law("torque [N m]", torque(t, q, L, body), L.shape)
    for n in range(steps):
        q, L = step(torque, t + n * dt, q, L, dt, body)
    check_end(q, L, dt)
    return q, L


def rotation_trajectory(step, torque, t, q, L, dt, steps, body):
    """Given.  Return times (steps + 1,), orientations (steps + 1, 4) and L (steps + 1, 3), with the start."""
    check_record(body, L)
    t, q, L, dt, steps = checked_rotation(t, q, L, dt, steps, body.I_body)
    check_law("torque [N m]", torque(t, q, L, body), L.shape)
    ts = t + dt * np.arange(steps + 1)
    qs, Ls = np.zeros((steps + 1, 4)), np.zeros((steps + 1, 3))
    qs[0], Ls[0] = q, L
    for n in range(steps):
        q, L = step(torque, t + n * dt, q, L, dt, body)
        check_end(q, L, dt)
        qs[n + 1], Ls[n + 1] = q, L
    return ts, qs, Ls


def advance_rigid_body(step, load, t, x, q, v, omega, dt, steps, body):
    """Given.  Return (x, q, v, ω) after `steps` steps of a rigid body; raises what advance_rotation raises."""
    check_record(body, x)
    positive_number("mass m [kg]", body.m)
    t, q, omega, dt, steps = checked_rotation(t, q, omega, dt, steps, body.I_body)
    t, x, v, dt, steps = checked_run(t, x, v, dt, steps)
    check_shape("the position x", x, (3,))
    check_load(load(t, x, q, v, omega, body), (3,), (3,))
    for n in range(steps):
        x, q, v, omega = step(load, t + n * dt, x, q, v, omega, dt, body)
    check_end(x, v, dt)
    check_end(q, omega, dt)
    return x, q, v, omega


# ---------------------------------------------------------------------------------------------- steps

def make_rigid_body(m, I_body):
    """Given.  Make a RigidBody from a number and three; raises BadInput for a mass or moments that no body has."""
    moments = finite_array("principal moments [kg m²]", I_body)
    check_moments(moments)
    body = RigidBody(positive_number("mass m [kg]", m), moments)
    check_record(body, moments)
    return body


def matrix_step(torque, t, q, L, dt, body):
    """Given.  L ← L + dt τ, then matrix_update with ω = I⁻¹ L; first order."""
    L = L + dt * torque(t, q, L, body)
    R = rotation_matrix(q)
    R = matrix_update(R, angular_velocity(R, L, body.I_body), dt)
    return quaternion_from_matrix(R), L


def axis_angle_step(torque, t, q, L, dt, body):
    """Given.  The same with axis_angle_update."""
    L = L + dt * torque(t, q, L, body)
    R = rotation_matrix(q)
    R = axis_angle_update(R, angular_velocity(R, L, body.I_body), dt)
    return quaternion_from_matrix(R), L


def quaternion_step(torque, t, q, L, dt, body):
    """Given.  The same with quaternion_update."""
    L = L + dt * torque(t, q, L, body)
    return quaternion_update(q, angular_velocity(rotation_matrix(q), L, body.I_body), dt), L


def gyroscopic_step(torque, t, q, L, dt, body):
    """Given.  The loop of the second lecture deck: state ω, gyroscopic term explicit.  |L| is not conserved."""
    omega = angular_velocity(rotation_matrix(q), L, body.I_body)
    omega = omega + dt * angular_acceleration(q, omega, torque(t, q, L, body), body.I_body)
    q = quaternion_update(q, omega, dt)
    return q, body_angular_momentum(q, omega, body.I_body)


def implicit_gyroscopic_step(torque, t, q, L, dt, body):
    """Given.  The same with an implicit gyroscopic term, by one iteration of Newton's method, as in some engines.

    (I + dt (ω* I − (Iω)*)) Δω = dt (τ − ω × Iω)  in body coordinates.
    *Source:* Catto 2015, “Numerical methods”.
    """
    I, L_body = body.I_body, unrotate(q, L)
    omega, one = L_body / I, np.eye(3)
    right = dt * (unrotate(q, torque(t, q, L, body)) - cross(omega, L_body))
    column = [I[k] * one[k] + dt * cross(I[k] * omega - L_body, one[k]) for k in range(3)]
    omega = rotate(q, omega + solve3(column[0], column[1], column[2], right))
    q = quaternion_update(q, omega, dt)
    return q, body_angular_momentum(q, omega, I)


def runge_kutta_step(torque, t, q, L, dt, body):
    """Given.  Runge–Kutta 4 of lesson 1 for q̇ = ½ (0, ω) q, L̇ = τ, then q normalised; fourth order, energy drifts.

    The stages have quaternions that are not quite of length 1.  ω and τ are those of the orientation q/|q|.
    """
    rate_1, tau_1 = _slope(torque, t, q, L, body)
    rate_2, tau_2 = _slope(torque, t + 0.5 * dt, q + 0.5 * dt * rate_1, L + 0.5 * dt * tau_1, body)
    rate_3, tau_3 = _slope(torque, t + 0.5 * dt, q + 0.5 * dt * rate_2, L + 0.5 * dt * tau_2, body)
    rate_4, tau_4 = _slope(torque, t + dt, q + dt * rate_3, L + dt * tau_3, body)
    q = q + dt / 6.0 * (rate_1 + 2.0 * rate_2 + 2.0 * rate_3 + rate_4)
    return unit(q), L + dt / 6.0 * (tau_1 + 2.0 * tau_2 + 2.0 * tau_3 + tau_4)


def _slope(torque, t, q, L, body):
    """Given.  Return q̇ and L̇."""
    turn = unit(q)
    omega = angular_velocity(rotation_matrix(turn), L, body.I_body)
    return 0.5 * quaternion_product(np.array([0.0, omega[0], omega[1], omega[2]]), q), torque(t, turn, L, body)


def composed_splitting_step(torque, t, q, L, dt, body):
    """Given.  compose of splitting_step: fourth order, L exact without torque, bounded energy error."""
    return compose(splitting_step, torque, t, q, L, dt, body)


def composed_midpoint_step(torque, t, q, L, dt, body):
    """Given.  compose of midpoint_step: fourth order; without torque, L exact and energy to round-off."""
    return compose(midpoint_step, torque, t, q, L, dt, body)
