"""Linear systems of a few rows, in loops: compiled, they are quicker than NumPy, which calls LAPACK for each."""

import numpy as np

from ..checks import BadInput

DEPENDENT = 1e-12            # what is left of a column over the longest one [-]: round-off of 1,000 rows is 2e-13


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


def solve_band(A, y, band, least):
    """Return whether elimination within a band has solved A x = y; y becomes x, and A is used up.

    Rows are not exchanged, because that would widen the band.  So it stops, with False, at a pivot whose size is at
    most `least` times the diagonal: there a row is nearly a sum of earlier ones, and what is left of it has few digits.
    """
    diagonal = np.diag(A).copy()
    for k in range(y.size):
        if np.abs(A[k, k]) <= least * np.abs(diagonal[k]):
            return False
        for r in range(k + 1, min(y.size, k + band + 1)):
            factor = A[r, k] / A[k, k]
            for c in range(k + 1, min(y.size, k + band + 1)):
                A[r, c] -= factor * A[k, c]
            y[r] -= factor * y[k]
    for k in range(y.size - 1, -1, -1):
        for c in range(k + 1, min(y.size, k + band + 1)):
            y[k] -= A[k, c] * y[c]
        y[k] /= A[k, k]
    return True


def orthogonal_columns(B, y):
    """Return (R, c, order, rank) with R x[order] = c for the x of least |A x − y|², given B = Aᵀ; B and y are used up.

    Gram and Schmidt's method: of the columns of A the one of which most is left comes next, becomes a unit vector, and
    is taken out of the others and of y.  Columns of which at most DEPENDENT of the longest is left depend on the rank
    many before.  In the end y is what no x reaches.
    *Source:* Golub and Van Loan 2013, 5.2.8 and 5.4.2.
    """
    m = y.size
    R, c, order, longest = np.zeros((m, m)), np.zeros(m), np.arange(m), 0.0
    for k in range(m):
        lengths = np.sqrt(np.sum(B[k:] * B[k:], axis=1))
        s = k + np.argmax(lengths)
        longest = max(longest, lengths[s - k])
        if lengths[s - k] <= DEPENDENT * longest:
            return R, c, order, k
        order[k], order[s] = order[s], order[k]
        moved, left = B[k].copy(), R[:, k].copy()
        B[k], B[s], R[:, k], R[:, s] = B[s], moved, R[:, s], left
        unit, R[k, k] = B[k] / lengths[s - k], lengths[s - k]
        R[k, k + 1:] = np.sum(B[k + 1:] * unit, axis=1)
        B[k + 1:] -= np.outer(R[k, k + 1:], unit)
        c[k] = np.sum(unit * y)
        y -= c[k] * unit
    return R, c, order, m


def shortest_solution(A, y):
    """Return x (m,) with A x = y, of all such x the shortest; columns of A (m, m) may depend on each other.

    First each row of A and y, and then each column, is divided by its largest entry: neither the units nor the masses
    of a mechanism must decide about the rank.  Where no x has A x = y, the sum of the squares of what is left of the
    rows that are so divided is the least.
    """
    m = y.size
    B, right, sizes = np.empty((m, m)), np.empty(m), np.empty(m)
    for k in range(m):
        size = np.max(np.abs(A[k]))
        B[:, k], right[k] = A[k] / size, y[k] / size
    for k in range(m):
        sizes[k] = np.max(np.abs(B[k]))
        B[k] /= sizes[k]
    R, c, order, rank = orthogonal_columns(B, right)
    return shortest_of(all_solutions(R, c, order, rank, sizes))


def all_solutions(R, c, order, rank, sizes):
    """Return rows (1 + m − rank, m): an x, and then what may be added to it, from what orthogonal_columns returns.

    sizes (m,) are those of the columns, so that component k of the solution is x[k]/sizes[k].
    """
    found = np.zeros((1 + c.size - rank, c.size))
    for k in range(rank, c.size):
        found[1 + k - rank, order[k]] = 1.0
    for k in range(rank - 1, -1, -1):
        found[0, order[k]] = c[k]
        for i in range(k + 1, c.size):
            for s in range(found.shape[0]):
                found[s, order[k]] -= R[k, i] * found[s, order[i]]
        for s in range(found.shape[0]):
            found[s, order[k]] /= R[k, k]
    return found / sizes


def shortest_of(found):
    """Return the shortest sum of the first row and multiples of the others, by Gram and Schmidt; found is used up."""
    for s in range(1, found.shape[0]):
        unit = found[s] / np.sqrt(np.sum(found[s] * found[s]))
        found[0] -= np.sum(found[0] * unit) * unit
        for i in range(s + 1, found.shape[0]):
            found[i] -= np.sum(found[i] * unit) * unit
    return found[0].copy()
