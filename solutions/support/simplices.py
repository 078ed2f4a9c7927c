"""Given.  What GJK needs: the farthest corner, and the part of a simplex that is nearest to the origin."""

import numpy as np

from ..checks import BadInput, check_array, check_shape

SMALLEST, LARGEST = 1e-100, 1e100       # sizes of bodies whose squares neither underflow nor overflow [m]
GJK_RELATIVE_GAP = 1e-14     # tolerance of GJK: error of the distance over the size of the bodies [-]


def support(x, n):
    """Given.  Return the number of the point of x (k, d) that lies farthest along n (d,)."""
    farthest, best = -np.inf, 0
    for i in range(len(x)):
        if x[i] @ n > farthest:
            farthest, best = x[i] @ n, i
    return best


def cofactor(delta, G, rest, j):
    """Given.  Return Δ_j of the points `rest` (bits of an integer) and point j.

    Δ_j = Σ Δ_i(rest) (y_i · y_k − y_i · y_j), with k the first of rest.
    """
    if rest == 0:
        return 1.0
    k = 0
    while not rest >> k & 1:
        k += 1
    total = 0.0
    for i in range(len(G)):
        if rest >> i & 1:
            total += delta[rest, i] * (G[i, k] - G[i, j])
    return total


def nearest_subsimplex(p, q):
    """Given.  Return (p, q, weights) of those points p, q (k, d) that span the part of the hull of y = p − q next to 0.

    The nearest point is Σ weight y, with weights > 0 and sum 1; k is at most 5.  Johnson's cofactors give it for every
    subset of the points.  Where they are all positive, it lies inside that subset; the nearest of these points counts.
    *Source:* Gilbert, Johnson and Keerthi 1988.
    """
    y = p - q
    y = y / np.abs(y).max()                              # weights are ratios; products of 8 lengths must not overflow
    k, G, least = len(y), y @ y.T, np.inf
    delta, weights = np.zeros((2**k, k)), np.zeros(k)
    for subset in range(1, 2**k):
        inside = True
        for j in range(k):
            if subset >> j & 1:
                delta[subset, j] = cofactor(delta, G, subset ^ (1 << j), j)
                inside = inside and delta[subset, j] > 0.0
        if inside:
            trial = delta[subset] / np.sum(delta[subset])
            v = trial @ y
            if v @ v < least:
                least, weights = v @ v, trial
    keep = weights > 0.0
    return p[keep], q[keep], weights[keep]


def check_hulls(a, b):
    """Given.  Raise BadInput unless a (k, d) and b (m, d) are finite points of two bodies, at least one of each.

    Their size must have a square that neither underflows nor overflows.
    """
    check_array("the points of body a [m]", a, 2)
    check_array("the points of body b [m]", b, 2)
    check_shape("a point of body b", b[0], a[0].shape)
    size = max(np.abs(a).max(), np.abs(b).max())
    if size > LARGEST or 0.0 < size < SMALLEST:
        raise BadInput("the size of two bodies [m]", size, "scale both to about one metre, and the distance back")


def far_enough(v, w):
    """Given.  Return whether v (d,) is nearest to 0, if no point is beyond w (d,) along −v.

    The tolerance is GJK_RELATIVE_GAP of the size.

    |v|² − v · w ≤ GJK_RELATIVE_GAP |v| |w|:  v · w/|v| is a lower bound of the distance, and |v| an upper bound.
    """
    size_v, size_w = np.sqrt(v @ v), np.sqrt(w @ w)
    return v @ v - v @ w <= GJK_RELATIVE_GAP * size_v * size_w or size_v <= GJK_RELATIVE_GAP * size_w
