"""Given with lesson 7.  More steps: a spring, a rotating ball, discs; impacts one after the other; loops over steps."""

from typing import NamedTuple

import numpy as np

from ..checks import (
    Diverged,
    check_array,
    check_end,
    check_field,
    check_friction,
    check_law,
    check_normal,
    check_not_negative,
    check_positive,
    check_restitution,
    check_shape,
    checked_run,
    finite_array,
    finite_number,
    float_copy,
    number,
    positive_number,
)
from ..impulses import *  # noqa: F403    one import has a lesson and its given functions
from ..impulses import (
    MAX_IMPACTS,
    apply_impulse,
    check_impacts,
    cone_impulse,
    contact_matrix,
    free_flight,
    gap,
    impact_time,
    impulse_size,
    penalty_force,
    point_velocity,
    rebound_speeds,
    symplectic_euler_step,
    times,
)
from ..support.discs import drift, meeting_time, normal_between, overlap, separated
from ..support.records import check_record
from ..vectors import cross
from .impacts import impact_residual


class SpinningBall(NamedTuple):
    """A rotating ball above a plane."""
    e: float                 # restitution [-]
    mu: float                # friction [-]
    inv_mass: float          # [1/kg]
    inv_inertia: np.ndarray  # (3, 3), the same about any axis [1/(kg m²)]
    radius: float            # [m]
    gravity: np.ndarray      # (3,) [m/s²]
    point: np.ndarray        # (3,) position of its centre when it touches the plane [m]
    n: np.ndarray            # (3,) unit normal of the plane


class Discs(NamedTuple):
    """Discs or balls without friction and without forces between impacts."""
    radius: np.ndarray       # (bodies,) [m]
    inv_mass: np.ndarray     # (bodies,) [1/kg]
    e: float                 # restitution [-]


def contact_impulse(u, n, K, e, mu):
    """Given.  Return J (3,) [N s] of an impact with friction: cone_impulse with u_sep = −e n · u; 0 if they part."""
    check_restitution(e)
    return np.zeros(3) if u @ n >= 0.0 else cone_impulse(u, n, K, -e * (u @ n), mu)


def penalty_step(acceleration, t, x, v, dt, p):
    """Given.  Advance a BouncingBall by symplectic Euler with a penalty force; first order, stable for ω dt < 2."""
    force = penalty_force(gap(x, p), v @ p.n, p.stiffness, p.damping)
    v = v + dt * (acceleration(t, x, v, p) + force * p.n)
    return x + dt * v, v


def spinning_impact(v, omega, p):
    """Given.  Return (v, ω) of a SpinningBall after contact_impulse of its plane at the offset −radius n."""
    r = -p.radius * p.n
    K = contact_matrix(r, p.inv_mass, p.inv_inertia)
    J = contact_impulse(point_velocity(v, omega, r), p.n, K, p.e, p.mu)
    return v + p.inv_mass * J, omega + times(p.inv_inertia, cross(r, J))


def position_projection_spin_step(acceleration, t, x, v, omega, dt, p):
    """Given.  Advance a SpinningBall as position_projection_step does; first order."""
    x, v = symplectic_euler_step(acceleration, t, x, v, dt, p)
    if gap(x, p) >= 0.0:
        return x, v, omega
    v, omega = spinning_impact(v, omega, p)
    return project_to_plane(x, p), v, omega


def project_to_plane(x, p):
    """Given.  Return the point (d,) of the plane of p that is nearest to x:  x − φ n."""
    return x - gap(x, p) * p.n


def advance_to_plane(x, v, a, left, p):
    """Given.  Fly at constant acceleration to the plane of p, at most for `left` [s]; return (x, v, time then left)."""
    tau = impact_time(gap(x, p), v @ p.n, a @ p.n, left)
    x, v = free_flight(x, v, a, tau)
    return x, v, left - tau


def backtracking_spin_step(acceleration, t, x, v, omega, dt, p):
    """Given.  Advance a SpinningBall impact by impact; exact at constant acceleration.  Raises as backtracking_step."""
    a = acceleration(t, x, v, p)
    x, v, left = advance_to_plane(x, v, a, dt, p)
    for _ in range(MAX_IMPACTS):
        if left <= 0.0:
            return x, v, omega
        v, omega = spinning_impact(v, omega, p)
        x, v, left = advance_to_plane(project_to_plane(x, p), v, a, left, p)
    raise Diverged("impacts without end in a step of dt [s]", dt, "take a smaller step")


def disc_impact(x, v, i, j, p):
    """Given.  Return (v_i, v_j), each (d,), after discs i and j meet without friction: the impulse of impulse_size."""
    _, n = normal_between(x, i, j)
    size = impulse_size((v[i] - v[j]) @ n, p.inv_mass[i] + p.inv_mass[j], p.e)
    return v[i] + p.inv_mass[i] * size * n, v[j] - p.inv_mass[j] * size * n


def position_projection_discs_step(x, v, dt, p):
    """Given.  Advance discs by one step, then treat all overlapping pairs one by one; first order."""
    x, v = drift(x, v, dt), float_copy(v)
    for i in range(x.shape[0]):
        for j in range(i):
            if overlap(x, i, j, p.radius[i] + p.radius[j]):
                v[i], v[j] = disc_impact(x, v, i, j, p)
                x[i], x[j] = separated(x, i, j, p)
    return x, v


def backtracking_discs_step(x, v, dt, p):
    """Given.  Advance discs impact by impact, the earliest first; exact.  Raises Diverged after MAX_IMPACTS impacts.

    Of simultaneous impacts, the first pair in the list goes first: a choice.
    """
    left, v = dt, float_copy(v)
    for _ in range(MAX_IMPACTS):
        tau, first, second = left, 0, 0
        for i in range(x.shape[0]):
            for j in range(i):
                meets = meeting_time(x, v, i, j, p.radius[i] + p.radius[j], left)
                if meets < tau:
                    tau, first, second = meets, i, j
        x = drift(x, v, tau)
        left -= tau
        if left <= 0.0:
            return x, v
        v[first], v[second] = disc_impact(x, v, first, second, p)
    raise Diverged("impacts without end in a step of dt [s]", dt, "take a smaller step")


def sequential_impacts(body, r, n, e, mu):
    """Given.  Return (BodyState3D, residual [m/s]) after an impact at several points, each treated once, in order.

    Each impulse starts from the body as the previous one left it, so the result depends on the order: the two
    ends of an edge leave at different speeds.
    """
    check_impacts(body, r, n, e, mu)
    u_sep = rebound_speeds(body, r, n, e)
    Js = np.zeros(r.shape)
    after = body
    for i in range(len(r)):
        u = point_velocity(after.v, after.omega, r[i])
        K = contact_matrix(r[i], body.inv_mass, body.inv_inertia)
        Js[i] = contact_impulse(u, n[i], K, e, mu)
        after = apply_impulse(after, r[i], Js[i])
    return after, impact_residual(contact_matrix, cone_impulse, after, r, n, Js, u_sep, mu)


# ---------------------------------------------------------------------------------------------- many steps

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
    check_record(p, x)
    t, x, v, dt, steps = checked_run(t, x, v, dt, steps)
    check_array("position x [m]", x, 2)
    check_over_plane(p, x.shape[1])
    check_not_negative("stiffness over mass [1/s²]", number("stiffness over mass [1/s²]", p.stiffness))
    check_not_negative("damping over mass [1/s]", number("damping over mass [1/s]", p.damping))
    check_law("acceleration [m/s²]", acceleration(t, x[0], v[0], p), x.shape[1:])
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
    check_record(p, x)
    t, x, v, dt, steps = checked_run(t, x, v, dt, steps)
    check_field("position x [m]", x, (len(x), 3))
    omega = finite_array("angular velocity ω [rad/s]", omega)
    check_shape("the angular velocity ω", omega, x.shape)
    check_over_plane(p, 3)
    check_friction(number("friction μ [-]", p.mu))
    check_positive("inverse mass [1/kg]", number("inverse mass [1/kg]", p.inv_mass))
    check_field("inverse inertia [1/(kg m²)]", p.inv_inertia, (3, 3))
    positive_number("radius [m]", p.radius)
    check_law("acceleration [m/s²]", acceleration(t, x[0], v[0], p), x.shape[1:])
    x, v, omega = x.copy(), v.copy(), omega.copy()
    for k in range(x.shape[0]):
        x_k, v_k, omega_k = x[k], v[k], omega[k]
        for n in range(steps):
            x_k, v_k, omega_k = step(acceleration, t + n * dt, x_k, v_k, omega_k, dt, p)
        x[k], v[k], omega[k] = x_k, v_k, omega_k
    check_end(x, v, dt)
    return x, v, omega


def advance_discs(step, x, v, dt, steps, p):
    """Given.  Return (x, v), each (copies, bodies, d), of discs after `steps` steps; raises as advance_balls."""
    check_record(p, x)
    _, x, v, dt, steps = checked_run(0.0, x, v, dt, steps)
    check_array("position x [m]", x, 3)
    check_restitution(finite_number("restitution e [-]", p.e))
    for thing, values in (("radius of a disc [m]", p.radius), ("inverse mass of a disc [1/kg]", p.inv_mass)):
        check_field(thing, values, x.shape[1:2])
        check_not_negative(thing, values.min())
    x, v = x.copy(), v.copy()
    for k in range(x.shape[0]):
        x_k, v_k = x[k], v[k]
        for _ in range(steps):
            x_k, v_k = step(x_k, v_k, dt, p)
        x[k], v[k] = x_k, v_k
    check_end(x, v, dt)
    return x, v
