"""Given.  Tools for unit quaternions (w, x, y, z)."""

import numpy as np

from ..checks import BadInput, Diverged, check_shape
from ..vectors import cross, dot, norm

UNIT_TOLERANCE = 1e-9        # allowed error of a given quaternion's length [-]: 1000 times the round-off of 10⁷ steps


def unit(q):
    """Given.  Return q / |q|: the nearest unit quaternion.

    Raises BadInput for q = 0, and Diverged for a q that is not finite, as a step may produce.
    """
    length = np.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    if length == 0.0:
        raise BadInput("length of the quaternion q [-]", length, "an orientation has length 1")
    if not np.isfinite(length):
        raise Diverged("length of the quaternion q [-]", length, "take a smaller step")
    return np.array([q[0] / length, q[1] / length, q[2] / length, q[3] / length])


def exponential(phi):
    """Given.  Return the quaternion (4,) of a rotation by |φ| [rad] about φ/|φ|: (cos ½|φ|, sin ½|φ| φ/|φ|)."""
    angle = norm(phi)
    s = 0.5 if angle == 0.0 else np.sin(0.5 * angle) / angle
    return np.array([np.cos(0.5 * angle), s * phi[0], s * phi[1], s * phi[2]])


def rotate(q, r):
    """Given.  Return the world coordinates of a vector with body coordinates r:  r + 2w 𝐪×r + 2𝐪×(𝐪×r),  q = (w, 𝐪)."""
    a, b, c = q[2] * r[2] - q[3] * r[1], q[3] * r[0] - q[1] * r[2], q[1] * r[1] - q[2] * r[0]      # 𝐪×r
    return np.array([r[0] + 2.0 * (q[0] * a + q[2] * c - q[3] * b),
                     r[1] + 2.0 * (q[0] * b + q[3] * a - q[1] * c),
                     r[2] + 2.0 * (q[0] * c + q[1] * b - q[2] * a)])


def unrotate(q, r):
    """Given.  Return the body coordinates of a vector with world coordinates r: the inverse of rotate."""
    return rotate(np.array([-q[0], q[1], q[2], q[3]]), r)


def body_component(q, r, k):
    """Given.  Return the k-th body coordinate of a vector with world coordinates r, without computing the other two."""
    x, y, z, w = q[1], q[2], q[3], q[0]
    if k == 0:
        return (w * w + x * x - y * y - z * z) * r[0] + 2.0 * ((x * y + w * z) * r[1] + (x * z - w * y) * r[2])
    if k == 1:
        return (w * w - x * x + y * y - z * z) * r[1] + 2.0 * ((x * y - w * z) * r[0] + (y * z + w * x) * r[2])
    return (w * w - x * x - y * y + z * z) * r[2] + 2.0 * ((x * z + w * y) * r[0] + (y * z - w * x) * r[1])


def about_axis(q, k, angle):
    """Given.  Return the orientation after a rotation about the body's k-th axis:  q (cos ½angle, sin ½angle 𝐞ₖ)."""
    c, s = np.cos(0.5 * angle), np.sin(0.5 * angle)
    x, y, z, w = q[1], q[2], q[3], q[0]
    if k == 0:
        return np.array([w * c - x * s, x * c + w * s, y * c + z * s, z * c - y * s])
    if k == 1:
        return np.array([w * c - y * s, x * c - z * s, y * c + w * s, z * c + x * s])
    return np.array([w * c - z * s, x * c + y * s, y * c - x * s, z * c + w * s])


def solve3(a, b, c, r):
    """Given.  Return the u (3,) with  u₀ a + u₁ b + u₂ c = r  for columns a, b, c (3,), by Cramer's rule."""
    bc = cross(b, c)
    return np.array([dot(r, bc), dot(a, cross(r, c)), dot(a, cross(b, r))]) / dot(a, bc)


def quaternion_from_matrix(R):
    """Given.  Return the unit quaternion (4,) of a rotation matrix.

    Its largest component is computed first, to avoid cancellation.

    *Source:* Shepperd 1978.
    """
    trace = R[0, 0] + R[1, 1] + R[2, 2]
    k = 0
    for i in range(1, 3):
        if R[i, i] > R[k, k]:
            k = i
    if trace > R[k, k]:
        return unit(np.array([1.0 + trace, R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]))
    i = (k + 1) % 3
    j = 3 - k - i
    q = np.zeros(4)
    q[0] = R[j, i] - R[i, j]
    q[1 + k] = 1.0 + R[k, k] - R[i, i] - R[j, j]
    q[1 + i] = R[i, k] + R[k, i]
    q[1 + j] = R[j, k] + R[k, j]
    return unit(q)


def check_rotation(q):
    """Given.  Raise BadInput unless q is a quaternion of length 1."""
    check_shape("the quaternion q", q, (4,))
    length = np.sqrt(np.sum(q * q))
    if not abs(length - 1.0) <= UNIT_TOLERANCE:
        raise BadInput("length of the quaternion q [-]", length, "divide q by it: an orientation has length 1")
