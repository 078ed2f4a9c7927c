"""Vectors of three coordinates and matrices of three rows, written out.

Given.  Compiled, these functions are as fast as loops; NumPy's own take longer to compile and to run.
"""

import numpy as np

from .checks import BadInput

__all__ = ["cross", "dot", "inverse", "norm"]


def dot(a, b):
    """Return a · b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    """Return a × b, (3,), perpendicular to both, right-handed."""
    return np.array((a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]))


def norm(a):
    """Return |a|."""
    return np.sqrt(dot(a, a))


def inverse(A):
    """Return A⁻¹ of a symmetric (3, 3) matrix with rows a, b, c.

    Its rows are b × c, c × a, a × b over the determinant a · (b × c).
    Raises BadInput for a determinant of 0.
    """
    a, b, c = A[0], A[1], A[2]
    determinant = dot(a, cross(b, c))
    if determinant == 0.0:
        raise BadInput("the determinant of a matrix", determinant, "it has no inverse: give one whose axes all resist")
    return np.stack((cross(b, c), cross(c, a), cross(a, b))) / determinant
