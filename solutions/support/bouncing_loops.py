"""Given.  Many steps of balls above a plane, and the checks before them."""

from ..checks import (
    check_array,
    check_end,
    check_field,
    check_friction,
    check_normal,
    check_not_negative,
    check_positive,
    check_restitution,
    check_shape,
    checked_run,
    finite_array,
    finite_number,
    number,
    positive_number,
)


def check_over_plane(p, d):
    """Given.  Raise BadInput for an e outside 0 … 1, and unless gravity, point and unit normal have d coordinates."""
    check_restitution(finite_number("restitution e [-]", p.e))
    check_field("gravity [m/s²]", p.gravity, (d,))
    check_field("point of the plane [m]", p.point, (d,))
    check_field("normal of the plane [-]", p.n, (d,))
    check_normal(p.n)


def advance_balls(step, acceleration, t, x, v, dt, steps, p):
    """Given.  Return (x, v), each (copies, d), of copies of a BouncingBall after `steps` steps of one method.

    Raises BadInput for a step that is not positive, an e outside 0 … 1, a normal that is not a unit vector, a
    state that is not finite; Diverged when the final state is not finite.
    """
    t, x, v, dt, steps = checked_run(t, x, v, dt, steps)
    check_array("position x [m]", x, 2)
    check_over_plane(p, x.shape[1])
    check_not_negative("stiffness over mass [1/s²]", number("stiffness over mass [1/s²]", p.stiffness))
    check_not_negative("damping over mass [1/s]", number("damping over mass [1/s]", p.damping))
    x, v = x.copy(), v.copy()
    for k in range(x.shape[0]):
        x_k, v_k = x[k], v[k]
        for n in range(steps):
            x_k, v_k = step(acceleration, t + n * dt, x_k, v_k, dt, p)
        x[k], v[k] = x_k, v_k
    check_end(x, v, dt)
    return x, v


def advance_spinning_balls(step, acceleration, t, x, v, omega, dt, steps, p):
    """Given.  Return (x, v, ω), each (copies, 3), of copies of a SpinningBall after `steps` steps of one method.

    Raises the errors of advance_balls, and BadInput for μ < 0.
    """
    t, x, v, dt, steps = checked_run(t, x, v, dt, steps)
    check_field("position x [m]", x, (len(x), 3))
    omega = finite_array("angular velocity ω [rad/s]", omega)
    check_shape("the angular velocity ω", omega, x.shape)
    check_over_plane(p, 3)
    check_friction(number("friction μ [-]", p.mu))
    check_positive("inverse mass [1/kg]", number("inverse mass [1/kg]", p.inv_mass))
    check_field("inverse inertia [1/(kg m²)]", p.inv_inertia, (3, 3))
    positive_number("radius [m]", p.radius)
    x, v, omega = x.copy(), v.copy(), omega.copy()
    for k in range(x.shape[0]):
        x_k, v_k, omega_k = x[k], v[k], omega[k]
        for n in range(steps):
            x_k, v_k, omega_k = step(acceleration, t + n * dt, x_k, v_k, omega_k, dt, p)
        x[k], v[k], omega[k] = x_k, v_k, omega_k
    check_end(x, v, dt)
    return x, v, omega
