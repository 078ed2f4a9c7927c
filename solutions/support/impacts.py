"""Given.  Checks, speeds and cones for impacts at several points."""

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
