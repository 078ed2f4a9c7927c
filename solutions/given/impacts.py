"""Given.  Checks, speeds and cones for impacts at several points, and what answers where Coulomb's law does not.

A function that needs an exercise takes it as an argument.
"""

import numpy as np

from ..checks import (
    BadInput,
    check_field,
    check_finite,
    check_friction,
    check_normal,
    check_positive,
    check_restitution,
    finite_number,
    number,
)
from ..friction import tangential
from ..vectors import cross, dot, norm

MAX_SWEEPS = 2000            # over contact points [-]; four under a box need about 100, close ones more than 1000
CONVERGED = 1e-14            # largest change in a sweep over the largest initial |v| + |ω||r| [-]: a hundred roundings
MIN_DETERMINANT = 1e-40      # det K over (tr K)³ below which K has no inverse [-]: products in it underflow


def times(A, b):
    """Given.  Return A b of a matrix (3, 3) and a vector (3,); it compiles much faster than A @ b."""
    return np.array([dot(A[0], b), dot(A[1], b), dot(A[2], b)])


def check_inverse_mass(k_n):
    """Given.  Raise BadInput unless k_n [1/kg] is above zero and finite: two immovable bodies have k_n = 0."""
    if not (k_n > 0.0 and np.isfinite(k_n)):
        raise BadInput("inverse mass of two bodies at their contact [1/kg]", k_n, "let one of them have a finite mass")


def check_contact(u, n, K, mu):
    """Given.  Raise BadInput unless n is a unit vector, μ ≥ 0, u finite, and K positive along n and not singular."""
    check_normal(n)
    check_friction(mu)
    check_finite("relative velocity u [m/s]", u)
    check_inverse_mass(n @ times(K, n))
    determinant = K[0] @ cross(K[1], K[2])
    if not determinant > MIN_DETERMINANT * (K[0, 0] + K[1, 1] + K[2, 2]) ** 3:
        raise BadInput("determinant of K [1/kg³]", determinant, "give a K that gives way in every direction")


def check_impacts(body, r, n, e, mu):
    """Given.  Raise BadInput unless body, offsets r and unit normals n (points, 3), e and μ define an impact."""
    check_restitution(finite_number("restitution e [-]", e))
    check_friction(number("friction μ [-]", mu))
    check_positive("inverse mass [1/kg]", number("inverse mass [1/kg]", body.inv_mass))
    check_field("velocity v [m/s]", body.v, (3,))
    check_field("angular velocity ω [rad/s]", body.omega, (3,))
    check_field("inverse inertia [1/(kg m²)]", body.inv_inertia, (3, 3))
    check_field("offsets r of the points [m]", r, (len(r), 3))
    check_field("normals n of the points [-]", n, r.shape)
    for i in range(len(n)):
        check_normal(n[i])


def largest_speed(body, r):
    """Given.  Return the largest |v| + |ω||rᵢ| [m/s].

    The velocity of a point is a sum of these two, so its round-off is relative to them, however small the sum is.
    """
    reach = 0.0
    for i in range(len(r)):
        reach = max(reach, norm(r[i]))
    return norm(body.v) + norm(body.omega) * reach


def project_onto_cone(J, n, mu):
    """Given.  Return the impulse (3,) in Coulomb's cone |J_t| ≤ μ J_n that is nearest to J (3,)."""
    J_n, J_t = J @ n, tangential(J, n)
    beta = np.arctan(mu)
    size = np.sqrt(J_t @ J_t)
    if J_n >= 0.0 and size * np.cos(beta) <= J_n * np.sin(beta):
        return J
    if size == 0.0:
        return np.maximum(0.0, J_n) * n
    along_rim = np.maximum(0.0, J_n * np.cos(beta) + size * np.sin(beta))
    return along_rim * (np.cos(beta) * n + np.sin(beta) / size * J_t)


def velocity_at(body, r):
    """Given.  Return v + ω × r [m/s] (3,) of the point of a body at the offset r."""
    return body.v + cross(body.omega, r)


def rebound_speeds(body, r, n, e):
    """Given.  Return u_sepᵢ = max(0, −e nᵢ · uᵢ) [m/s] (points,): Newton's restitution, before the impact."""
    u_sep = np.zeros(len(r))
    for i in range(len(r)):
        u_sep[i] = np.maximum(0.0, -e * (n[i] @ velocity_at(body, r[i])))
    return u_sep


def impact_residual(contact_matrix, cone_impulse, after, r, n, Js, u_sep, mu):
    """Given.  Return the residual [m/s] of impulses Js (points, 3) in the law of cone_impulse; 0 where the law holds.

    It is the largest component of a velocity by which the law, applied to one point alone, would still change
    that point.
    """
    worst = 0.0
    for i in range(len(r)):
        K = contact_matrix(r[i], after.inv_mass, after.inv_inertia)
        u = velocity_at(after, r[i]) - times(K, Js[i])
        J = cone_impulse(u, n[i], K, u_sep[i], mu)
        worst = np.maximum(worst, np.abs(times(K, J - Js[i])).max())
    return worst


def stop_approach(contact_matrix, apply_impulse, after, r, n, Js, allowed):
    """Given.  Return (BodyState3D, impulses (points, 3)) after impulses along the normals, until no point comes in.

    Each one stops a point that approaches faster than `allowed` [m/s].  It loses energy and stays in the cone.
    """
    Js = Js.copy()
    for _ in range(MAX_SWEEPS):
        fastest = 0.0
        for i in range(len(r)):
            u_n = n[i] @ velocity_at(after, r[i])
            fastest = np.maximum(fastest, -u_n)
            if u_n < 0.0:
                J = -u_n / (n[i] @ times(contact_matrix(r[i], after.inv_mass, after.inv_inertia), n[i])) * n[i]
                after = apply_impulse(after, r[i], J)
                Js[i] += J
        if fastest <= allowed:
            break
    return after, Js


def most_dissipative_impact(contact_matrix, cone_impulse, apply_impulse, body, r, n, e, mu):
    """Given.  Return (BodyState3D, residual [m/s]) after simultaneous impacts for which solve_impacts finds no answer.

    With much friction its law can be without an answer, or its sweeps may not find one.  Of all impulses inside the
    cones, take those that leave the least kinetic energy: a convex problem, which always has an answer.  Each point in
    turn follows the gradient of the energy, its own velocity uᵢ, and returns to its cone:
    Jᵢ ← project_onto_cone(Jᵢ − uᵢ/tr Kᵢ).  Scale all impulses by s.
    s = 1 leaves the least energy, and s = 1 + e is Poisson's restitution;
    s is smaller where a point would otherwise move into the other body.  This never gains energy: the energy is
    a parabola in s, and s = 1 + e loses 1 − e² of what s = 1 loses.  The gradient converges slowly, so that some points
    may still approach: stop_approach ends that.
    *Source:* Moreau 1973, maximum dissipation; Anitescu 2006, the convex problem; Poisson 1817, the two phases.
    """
    before = np.zeros((len(r), 3))
    for i in range(len(r)):
        before[i] = velocity_at(body, r[i])
    u_sep = rebound_speeds(body, r, n, e)
    Js = np.zeros((len(r), 3))
    after, speed = body, largest_speed(body, r)
    for _ in range(MAX_SWEEPS):
        change = 0.0
        for i in range(len(r)):
            K = contact_matrix(r[i], body.inv_mass, body.inv_inertia)
            u = velocity_at(after, r[i])
            J = project_onto_cone(Js[i] - u / (K[0, 0] + K[1, 1] + K[2, 2]), n[i], mu) - Js[i]
            change = np.maximum(change, np.abs(times(K, J)).max())
            after = apply_impulse(after, r[i], J)
            Js[i] += J
        if change <= CONVERGED * speed:
            break
    gain, curvature, share = 0.0, 0.0, 1.0 + e
    for i in range(len(r)):
        u = velocity_at(after, r[i])
        gain += Js[i] @ before[i]
        curvature += Js[i] @ (u - before[i])
        leaves = n[i] @ before[i]
        would_leave = np.maximum(0.0, n[i] @ u)
        if leaves > would_leave:                         # the impact slows this point: it may stop along n, not reverse
            share = np.minimum(share, leaves / (leaves - would_leave))
    share *= -gain / curvature if gain < 0.0 else 0.0
    after = body
    for i in range(len(r)):
        Js[i] *= share
        after = apply_impulse(after, r[i], Js[i])
    after, Js = stop_approach(contact_matrix, apply_impulse, after, r, n, Js, CONVERGED * speed)
    return after, impact_residual(contact_matrix, cone_impulse, after, r, n, Js, u_sep, mu)
