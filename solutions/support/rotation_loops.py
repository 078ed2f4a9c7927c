"""Given.  Many steps of a rigid body, and the checks before them."""

import numpy as np

from ..checks import (
    BadInput,
    check_end,
    check_finite,
    check_positive,
    check_shape,
    checked_run,
    finite_array,
    finite_number,
    positive_number,
    whole_number,
)
from .quaternions import check_rotation

FLAT_BODY_TOLERANCE = 1e-12  # a flat body has I₁ + I₂ = I₃; round-off may violate that by this share [-]


def check_moments(I_body):
    """Given.  Raise BadInput unless these are moments of a body: positive, none above the sum of the others."""
    check_shape("the principal moments", I_body, (3,))
    for k in range(3):
        check_positive("a principal moment of inertia [kg m²]", I_body[k])
        others = I_body[(k + 1) % 3] + I_body[(k + 2) % 3]
        if I_body[k] > others * (1.0 + FLAT_BODY_TOLERANCE):
            raise BadInput("a principal moment of inertia [kg m²]", I_body[k],
                           "no distribution of mass has it; keep it below the sum of the other two")


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
    t, q, L, dt, steps = checked_rotation(t, q, L, dt, steps, body.I_body)
    for n in range(steps):
        q, L = step(torque, t + n * dt, q, L, dt, body)
    check_end(q, L, dt)
    return q, L


def rotation_trajectory(step, torque, t, q, L, dt, steps, body):
    """Given.  Return times (steps + 1,), orientations (steps + 1, 4) and L (steps + 1, 3), with the start."""
    t, q, L, dt, steps = checked_rotation(t, q, L, dt, steps, body.I_body)
    ts = t + dt * np.arange(steps + 1)
    qs, Ls = np.zeros((steps + 1, 4)), np.zeros((steps + 1, 3))
    qs[0], Ls[0] = q, L
    for n in range(steps):
        q, L = advance_rotation(step, torque, t + n * dt, q, L, dt, 1, body)
        qs[n + 1], Ls[n + 1] = q, L
    return ts, qs, Ls


def advance_rigid_body(step, load, t, x, v, q, omega, dt, steps, body):
    """Given.  Return (x, v, q, ω) after `steps` steps of a rigid body; raises what advance_rotation raises."""
    positive_number("mass m [kg]", body.m)
    t, q, omega, dt, steps = checked_rotation(t, q, omega, dt, steps, body.I_body)
    t, x, v, dt, steps = checked_run(t, x, v, dt, steps)
    check_shape("the position x", x, (3,))
    F, tau = load(t, x, v, q, omega, body)
    check_finite("force at the start [N]", F)
    check_finite("torque at the start [N m]", tau)
    for n in range(steps):
        x, v, q, omega = step(load, t + n * dt, x, v, q, omega, dt, body)
    check_end(x, v, dt)
    check_end(q, omega, dt)
    return x, v, q, omega
