"""Functions for vectors of three coordinates, matrices of three rows, and the two points of a link, written out.

Given.  Compiled, these functions are as fast as loops.  NumPy's own functions take longer to compile and to run.
"""

import numpy as np

from .checks import BadInput

__all__ = ["cross", "distance_between", "dot", "inverse", "move_apart", "norm", "product_between"]


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


def product_between(x, y, i, j):
    """Return (x_i − x_j) · (y_i − y_j) of the rows i and j of two arrays (n, d)."""
    product = 0.0
    for c in range(x.shape[1]):
        product += (x[i, c] - x[j, c]) * (y[i, c] - y[j, c])
    return product


def distance_between(x, i, j):
    """Return |x_i − x_j| of the points i and j of x (n, d)."""
    return np.sqrt(product_between(x, x, i, j))


def move_apart(y, i, j, k_i, k_j, x):
    """Add k_i r to y_i and take k_j r from y_j, in place, for r = x_i − x_j; y (n, d) may be x itself."""
    for c in range(x.shape[1]):
        r = x[i, c] - x[j, c]
        y[i, c] += k_i * r
        y[j, c] -= k_j * r
