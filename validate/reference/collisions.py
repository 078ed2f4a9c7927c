"""Distances, impacts and pairs by other means, and the two engines asked for the same: the witnesses of lesson 6.

Nothing here knows the functions of `solutions`.  Distances of convex bodies are least squares with weights that are not negative (SciPy's
nnls), first roots are SciPy's brentq, pairs are NumPy's comparison of all with all.
"""

import numpy as np
from scipy.optimize import brentq, nnls
from scipy.spatial import ConvexHull

COPIES = 16                  # balls that fly at once, so that their impacts fall on all phases of a step
GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
EARLIEST, SPREAD = 0.3, 0.4  # of the output time: when the impacts are


def impact_times(T):
    """When each copy hits [s]: at EARLIEST + SPREAD {k φ} of T, φ the golden section, which is spread over the steps of any length."""
    return T * (EARLIEST + SPREAD * ((np.arange(COPIES) + 1.0) * GOLDEN % 1.0))


def with_balls_that_miss(x, v):
    """Return (x, v) with as many balls again, a kilometre to the side, which never hit; a broad phase would skip them."""
    aside = np.array([0.0, 1.0, 0.0])
    more = np.linalg.norm(v[0]) * np.tile(aside, (COPIES, 1))
    return np.concatenate((x, x + 1e3 * np.array([0.0, 1.0, 1.0]))), np.concatenate((v, more))


def first_root(gap, t_0, t_1):
    """The time between t_0 (gap above zero) and t_1 (below) at which gap(t) is zero, to the last digit."""
    return brentq(gap, t_0, t_1, xtol=1e-300, rtol=4.0 * np.finfo(float).eps)


def hull_nearest(a, b, weight=1e3):
    """(p, q): the points of the hulls of a (k, d) and b (m, d) that are nearest: min |Σ α a − Σ β b| over α, β ≥ 0 with Σ α = Σ β = 1.

    The two sums enter as rows of that weight, which leaves a relative error of about 1/weight² (a penalty); so the answer is only the start:
    the points that carry weight span flat parts of the two bodies, and the nearest points of those are a linear system, solved exactly.
    *Source:* Lawson and Hanson 1974, chapter 23.
    """
    one, none = np.ones(len(a)), np.zeros(len(a))
    rows = np.vstack(
        (
            np.hstack((a.T, -b.T)),
            weight * np.hstack((one, np.zeros(len(b)))),
            weight * np.hstack((none, np.ones(len(b)))),
        )
    )
    shares, _ = nnls(rows, np.append(np.zeros(a.shape[1]), [weight, weight]))
    p, q = a[shares[:len(a)] > 1e-9], b[shares[len(a):] > 1e-9]
    span = np.vstack((p[1:] - p[0], q[0] - q[1:]))
    c = np.linalg.lstsq(span.T, q[0] - p[0], rcond=None)[0] if len(span) else np.zeros(0)
    split = len(p) - 1
    return p[0] + c[:split] @ (p[1:] - p[0]), q[0] + c[split:] @ (q[1:] - q[0])


def depth_of(a, b):
    """(gap, n) of two hulls that overlap, from b to a: the face of the hull of all differences a − b that is nearest to 0.

    *Source:* the Minkowski difference; SciPy's ConvexHull (Qhull) for its faces n · y + offset = 0.
    """
    faces = ConvexHull((a[:, None] - b[None]).reshape(-1, a.shape[1])).equations
    nearest = faces[np.argmax(faces[:, -1])]
    return float(nearest[-1]), -nearest[:-1]


def all_touching(low, high):
    """Pairs (m, 2), i < j, of boxes low, high (n, d) that have a point in common, by comparing all with all, 500 rows at a time."""
    found = []
    for first in range(0, len(low), 500):
        part = slice(first, first + 500)
        i, j = np.nonzero(np.all((low[part, None] <= high[None]) & (low[None] <= high[part, None]), axis=2))
        found.append(np.stack((i + first, j), axis=1)[i + first < j])
    return np.concatenate(found)
