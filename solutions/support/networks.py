"""Given.  Points and links as arrays, what a matrix of all links needs, and the edges of a mesh."""

import numpy as np

from ..checks import WrongShape, check_indices, check_positive, one_each


def inverse_masses(thing, m, fixed, x):
    """Given.  Return 1/m (n,) of points x (n, d), 0 if in `fixed`; m is a number or one each.  Raises BadInput."""
    if x.ndim != 2 or x.size == 0:
        raise WrongShape("the points x", x.shape, "(n, d), a row for each point")
    masses = one_each(thing, m, len(x))
    for mass in masses:
        check_positive(thing, mass)
    inv_mass = 1.0 / masses
    inv_mass[check_indices("the number of a fixed point", fixed, len(x))] = 0.0
    return inv_mass


def measured_links(kind, x, pairs):
    """Given.  Return (i, j, length), each (s,), of the links between points x (n, d) with numbers pairs (s, 2).

    Raises BadInput for a number out of range and WrongShape for pairs of another shape.
    """
    pairs = check_indices(f"a point number of a {kind}", pairs, len(x))
    if pairs.size == 0:
        pairs = pairs.reshape(0, 2)
    if pairs.ndim != 2 or pairs.shape[1] != 2:
        raise WrongShape("the pairs", pairs.shape, "(s, 2), two point numbers in each row")
    i, j = np.ascontiguousarray(pairs[:, 0]), np.ascontiguousarray(pairs[:, 1])
    return i, j, np.sqrt(np.sum((x[j] - x[i]) ** 2, axis=1))


def shared_edges(faces):
    """Given.  Return (edges (e, 2), hinges (h, 4)) of triangles (f, 3): every edge once, and the folds.

    A hinge is (a, b, c, d) of an edge that two triangles share: its ends a and b, the other corners c and d.
    """
    found = {}
    for face in np.asarray(faces):
        for k in range(3):
            a, b, c = face[k], face[(k + 1) % 3], face[(k + 2) % 3]
            found.setdefault((min(a, b), max(a, b)), []).append((a, b, c))
    hinges = [(*two[0], two[1][2]) for two in found.values() if len(two) == 2]
    edges = np.array(sorted(found), dtype=np.int64)
    return edges, np.array(hinges, dtype=np.int64).reshape(-1, 4)


def link_delassus_matrix(J, K, network, trace):
    """Given.  Return J W Kᵀ (s, s): the change of each constraint (gradients J) by a push along each gradient of K.

    The trace, times w_i + w_j, is added on the diagonal, so that the matrix of redundant links has an inverse, too.
    The loops visit only the two ends of each link; a product of the whole matrices takes longer.
    """
    d = J.shape[1] // network.inv_mass.size
    A = np.zeros((J.shape[0], K.shape[0]))
    for s in range(J.shape[0]):
        for k in (network.i[s], network.j[s]):                                   # row s is 0 for all other points
            for r in range(K.shape[0]):
                for c in range(k * d, k * d + d):
                    A[s, r] += network.inv_mass[k] * J[s, c] * K[r, c]
        A[s, s] += trace * (network.inv_mass[network.i[s]] + network.inv_mass[network.j[s]])
    return A


def apply_multipliers(J, Lam, network):
    """Given.  Return W JᵀΛ (n, d) [m]: how far the multipliers Λ (s,) move the points.

    The loops visit only the two ends of each link, as above.
    """
    d = J.shape[1] // network.inv_mass.size
    moved = np.zeros((network.inv_mass.size, d))
    for s in range(Lam.size):
        for k in (network.i[s], network.j[s]):
            for c in range(d):
                moved[k, c] += network.inv_mass[k] * J[s, k * d + c] * Lam[s]
    return moved


def constraint_rates(J, v):
    """Given.  Return J v (s,) [m/s]: the rate of change of each constraint."""
    return J @ v.ravel()
