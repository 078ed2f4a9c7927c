"""Given.  Faces, edges and axes of boxes and of convex polygons."""

import numpy as np

from ..checks import BadInput
from ..vectors import cross, dot

PARALLEL = 1e-12             # sin² of the angle below which two edges count as parallel [-]


def column(R, i):
    """Given.  Return axis i (3,) of a box, as a new array."""
    return np.array([R[0, i], R[1, i], R[2, i]])


def box_corners(box):
    """Given.  Return the eight corners (8, 3) of a Box [m]."""
    corners = np.zeros((8, 3))
    for k in range(8):
        side = np.array([1.0 if k & 1 else -1.0, 1.0 if k & 2 else -1.0, 1.0 if k & 4 else -1.0])
        corners[k] = box.x + box.R @ (side * box.half)
    return corners


def half_width(box, n):
    """Given.  Return how far [m] a Box extends from its centre along the unit vector n:  Σ half_i |axis_i · n|."""
    total = 0.0
    for i in range(3):
        total += box.half[i] * abs(box.R[0, i] * n[0] + box.R[1, i] * n[1] + box.R[2, i] * n[2])
    return total


def candidate_axis(a, b, k):
    """Given.  Return axis k of the 15 that can separate two Boxes: 3 of a, 3 of b, 9 perpendicular to an edge of each.

    Those 9 are zeros where the edges are parallel.
    """
    if k < 3:
        return column(a.R, k)
    if k < 6:
        return column(b.R, k - 3)
    n = cross(column(a.R, (k - 6) // 3), column(b.R, (k - 6) % 3))
    return n / np.sqrt(dot(n, n)) if dot(n, n) > PARALLEL else 0.0 * n


def box_face(box, n):
    """Given.  Return (corners (4, 3), i, outward normal (3,)) of the face of a Box most along n; i is its axis."""
    i, most = 0, -1.0
    for k in range(3):
        along = abs(column(box.R, k) @ n)
        if along > most:
            i, most = k, along
    out = column(box.R, i) if column(box.R, i) @ n >= 0.0 else -column(box.R, i)
    j, k = (i + 1) % 3, (i + 2) % 3
    u, w = box.half[j] * column(box.R, j), box.half[k] * column(box.R, k)
    middle = box.x + box.half[i] * out
    return np.stack((middle + u + w, middle - u + w, middle - u - w, middle + u - w)), i, out


def box_edge(box, i, n):
    """Given.  Return (end, end) of the edge along axis i of a Box that lies farthest along n."""
    x, along = box.x, box.half[i] * column(box.R, i)
    for k in range(3):
        if k != i:
            axis = column(box.R, k)
            x = x + (box.half[k] if axis @ n >= 0.0 else -box.half[k]) * axis
    return x - along, x + along


def outward(a, i):
    """Given.  Return the outward unit normal (2,) of edge i of a polygon a (k, 2), counter-clockwise.

    Raises BadInput for an edge of zero length.
    """
    e = a[(i + 1) % len(a)] - a[i]
    length = np.sqrt(e @ e)
    if not 0.0 < length < np.inf:
        raise BadInput("the length of an edge [m]", length, "give finite corners, each of them once")
    return np.array([e[1], -e[0]]) / length


def incident_edge(a, n):
    """Given.  Return the edge (2, 2) of a polygon whose outward normal is most opposed to n (2,)."""
    least, edge = np.inf, 0
    for i in range(len(a)):
        against = outward(a, i) @ n
        if against < least:
            least, edge = against, i
    return np.stack((a[edge], a[(edge + 1) % len(a)]))


def normal_or_axis(r):
    """Given.  Return r/|r|, or the last axis where r is zero: there every direction is equally good."""
    length = np.sqrt(r @ r)
    if length != 0.0:
        return r / length
    n = 0.0 * r
    n[-1] = 1.0
    return n


def nearer(p, q, other):
    """Given.  Return q or other (d,), whichever is nearer to p (d,)."""
    return q if (q - p) @ (q - p) <= (other - p) @ (other - p) else other
