"""Rotation matrices and quaternions, independent of `solutions`."""

import numpy as np


def cross_matrix(a):
    """Return the matrix (3, 3) that maps b to a × b."""
    x, y, z = a
    return np.array(((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)))


def about(axis, angle):
    """Return R (3, 3) about a unit vector."""
    K = cross_matrix(axis)
    return np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * K @ K


def quaternion_matrix(w, x, y, z):
    """Return R (3, 3) of a unit quaternion, which is a rotation by 2 acos w about (x, y, z)."""
    s = np.sqrt(x * x + y * y + z * z)
    return about(np.array([x, y, z]) / s, 2.0 * np.arctan2(s, w)) if s > 0.0 else np.eye(3)


def quaternion(R):
    """Return the unit quaternion (w, x, y, z), w ≥ 0, of R, from the longest row of 4 q qᵀ.

    *Source:* Shepperd 1978.
    """
    (a, b, c), (d, e, f), (g, h, i) = R
    rows = np.array([[1.0 + a + e + i, h - f, c - g, d - b],
                     [h - f, 1.0 + a - e - i, b + d, c + g],
                     [c - g, b + d, 1.0 - a + e - i, f + h],
                     [d - b, c + g, f + h, 1.0 - a - e + i]])
    row = rows[np.argmax(np.diag(rows))]
    return row / np.copysign(np.linalg.norm(row), row[0])


def relative_turn(R, S):
    """Return the angle [rad] between two orientations: |R − S| = 2√2 sin(½ angle) in Frobenius' norm."""
    return 2.0 * np.arcsin(min(1.0, np.linalg.norm(R - S) / np.sqrt(8.0)))


def leaning(first, second):
    """Return R (3, 3) of a rotation about y, then about x."""
    return about(np.array([1.0, 0.0, 0.0]), first) @ about(np.array([0.0, 1.0, 0.0]), second)
