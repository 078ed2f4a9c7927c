"""How deep bodies of a pile overlap, by separating axes: the same judge for every engine, and no code of the lessons.

*Source:* the depth of two convex bodies is the least distance by which one of them must move so that they only touch.
Of two boxes its direction is normal to a face of one or to an edge of each (Gottschalk, Lin and Manocha 1996,
OBBTree).
"""

from itertools import product

import numpy as np
from scipy.spatial import cKDTree

PARALLEL = 1e-6              # length of a cross product of unit vectors that gives no direction [-]


def overlaps(x, axes, half, is_round, planes):
    """Return depths (k,) [m] of all pairs that overlap, planes included.

    x (n, d) [m]: centres · axes (n, d, d): columns are the directions of each box · half (n, d) [m]: half sizes, of a
    round body its radius · planes (p, d + 1): n · x + c ≥ 0 for every point of a body.
    """
    a, b = close_pairs(x, half, is_round)
    between = ball_depths(x, half[:, 0], a, b) if is_round else box_depths(x, axes, half, a, b)
    depths = np.concatenate((between, plane_depths(x, axes, half, is_round, planes)))
    return depths[depths > 0.0]


def close_pairs(x, half, is_round):
    """Return (a, b), the pairs of bodies whose bounding balls meet."""
    radius = half[:, 0] if is_round else np.linalg.norm(half, axis=1)
    a, b = cKDTree(x).query_pairs(2.0 * radius.max(), output_type="ndarray").T
    meet = np.linalg.norm(x[b] - x[a], axis=1) < radius[a] + radius[b]
    return a[meet], b[meet]


def ball_depths(x, radius, a, b):
    """Return depths (k,) [m] of pairs of balls or discs; negative where they are apart."""
    return radius[a] + radius[b] - np.linalg.norm(x[b] - x[a], axis=1)


def box_depths(x, axes, half, a, b):
    """Return depths (k,) [m] of pairs of boxes; negative where they are apart."""
    d, (A, B) = x.shape[1], (axes[a], axes[b])
    faces = [M[:, :, i] for M in (A, B) for i in range(d)]
    edges = [np.cross(A[:, :, i], B[:, :, j]) for i, j in product(range(d), repeat=2)] if d == 3 else []
    least = np.full(len(a), np.inf)
    for direction in (*faces, *edges):
        length = np.linalg.norm(direction, axis=1)
        n = direction / np.maximum(length, PARALLEL)[:, None]
        depth = reach(A, half[a], n) + reach(B, half[b], n) - np.abs(np.sum(n * (x[b] - x[a]), axis=1))
        least = np.where(length > PARALLEL, np.minimum(least, depth), least)
    return least


def reach(axes, half, n):
    """Return how far boxes reach from their centres along n (k, d) [m]."""
    return np.sum(np.abs(np.einsum("kij,ki->kj", axes, n)) * half, axis=1)


def plane_depths(x, axes, half, is_round, planes):
    """Return depths (p n,) [m] of bodies in planes; negative where they are apart."""
    def into(n, c):
        size = half[:, 0] if is_round else reach(axes, half, np.broadcast_to(n, x.shape))
        return size - x @ n - c
    return np.concatenate([into(plane[:-1], plane[-1]) for plane in planes])
