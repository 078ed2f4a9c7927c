"""Linear systems of a few rows, in loops: compiled, they are quicker than NumPy, which calls LAPACK for each."""

import numpy as np

from ..checks import BadInput


def row_products(J):
    """J Jᵀ (m, m): the products of all pairs of rows of J (m, n)."""
    m, n = J.shape
    A = np.empty((m, m))
    for r in range(m):
        for s in range(r + 1):
            total = 0.0
            for k in range(n):
                total += J[r, k] * J[s, k]
            A[r, s], A[s, r] = total, total
    return A


def sum_of_rows(J, y):
    """Jᵀ y (n,): the rows of J (m, n), each times its y."""
    total = np.zeros(J.shape[1])
    for r in range(y.size):
        for k in range(total.size):
            total[k] += J[r, k] * y[r]
    return total


def solve_symmetric(A, b):
    """y (m,) with A y = b, for a symmetric positive definite A (m, m): elimination, which needs no pivoting for those.

    Raises BadInput for a pivot that is not above 0.
    """
    U, y, m = A.copy(), b.copy(), b.size
    for k in range(m):
        if U[k, k] <= 0.0:
            raise BadInput("a pivot of J Jᵀ + λ² 1 [m²]", U[k, k], "give a damping above zero")
        for r in range(k + 1, m):
            factor = U[r, k] / U[k, k]
            for c in range(k + 1, m):
                U[r, c] -= factor * U[k, c]
            y[r] -= factor * y[k]
    for k in range(m - 1, -1, -1):
        for c in range(k + 1, m):
            y[k] -= U[k, c] * y[c]
        y[k] /= U[k, k]
    return y
