"""Given.  Convex polyhedra in space: their faces and edges, what separates two of them, and faces that are clipped.

Two polyhedra that touch do so with a face and corners, or with two edges.  So the axis that separates them best is the
normal of a face, or across two edges.  Of all pairs of edges only those count that could touch: those whose normals,
as arcs on the unit sphere between the normals of their faces, cross.
*Source:* Gregorius 2013, “The separating axis test between convex polyhedra”; lesson 6 for theorem and clipping.
"""

import numpy as np

from ..vectors import dot
from .contact_points import PARALLEL
from .convex_3d import SAME, Hulls, part_between, put_point
from .shapes import Ball, Box, Capsule, face_planes, hull_faces
from .tuples import across, axis, minus, plus, put, row, scaled

# Contacts of two bodies at most [-]: of a regular polygon with more corners, 16 leave at least 0.9 of its inner radius,
# within which a body does not tip.
MOST_POINTS = 16
FREE = 0                     # stands for a face of an edge that has none


# ---------------------------------------------------------------------------------------------- making them

def hulls_of(shapes):
    """Return the Hulls of shapes in space, in the coordinates of their bodies."""
    corners, faces, around, begin, edges, first = [], [], [], [0], [], [(0, 0, 0)]
    for shape in shapes:
        own = corners_of(shape)
        loops = hull_faces(own) if len(own) > 2 else []
        ways = edges_of(loops) if loops else [(0, 1, FREE, FREE)] * (len(own) - 1)
        edges += [(a + len(corners), b + len(corners), left + len(faces), right + len(faces))
                  for a, b, left, right in ways]
        around += [k + len(corners) for loop in loops for k in loop]
        begin += (begin[-1] + np.cumsum([len(loop) for loop in loops], dtype=np.int64)).tolist()
        faces += face_planes(own, loops).tolist()
        corners += own.tolist()
        first.append((len(corners), len(faces), len(edges)))
    return Hulls(np.array(corners, float).reshape(-1, 3), np.array(faces, float).reshape(-1, 4),
                 np.array(around, np.int64), np.array(begin, np.int64), np.array(edges, np.int64).reshape(-1, 4),
                 np.array(first, np.int64))


def corners_of(shape):
    """Return the corners (k, 3) [m] of the core of a shape: one of a ball, two of a capsule."""
    if isinstance(shape, Ball):
        return np.zeros((1, 3))
    if isinstance(shape, Capsule):
        return np.array([(-shape.half_length, 0.0, 0.0), (shape.half_length, 0.0, 0.0)])
    if isinstance(shape, Box):
        return np.array([(x, y, z) for z in (-1.0, 1.0) for y in (-1.0, 1.0) for x in (-1.0, 1.0)]) * shape.half
    return np.array(shape.corners, float)


def edges_of(loops):
    """Return [(a, b, left, right), …]: each edge once, from corner a to corner b, with its faces."""
    left = {(a, b): face for face, loop in enumerate(loops) for a, b in zip(loop, [*loop[1:], loop[0]])}
    return [(a, b, face, left[b, a]) for (a, b), face in left.items() if a < b]


def hulls_in_world(x, turn, hulls):
    """Return the Hulls in the world."""
    corners, faces = np.empty(hulls.corners.shape), np.empty(hulls.faces.shape)
    for i in range(hulls.first.shape[0] - 1):
        for k in range(hulls.first[i, 0], hulls.first[i + 1, 0]):
            put(corners, k, plus(row(x, i), 1.0, turned(turn, i, row(hulls.corners, k))))
        for f in range(hulls.first[i, 1], hulls.first[i + 1, 1]):
            n = turned(turn, i, row(hulls.faces, f))
            put(faces, f, n)
            faces[f, 3] = hulls.faces[f, 3] - dot(n, row(x, i))
    return Hulls(corners, faces, hulls.around, hulls.begin, hulls.edges, hulls.first)


def turned(turn, i, a):
    """Return a vector of body i in the world."""
    return plus(plus(scaled(a[0], axis(turn, i, 0)), a[1], axis(turn, i, 1)), a[2], axis(turn, i, 2))


# ---------------------------------------------------------------------------------------------- what separates them

def widest_face(hulls, i, j):
    """Return (gap [m], face, corner): the face of body i from which body j is farthest, and the nearest corner of j.

    gap is below zero where the plane of each face is crossed, and −∞ of a body without faces.
    """
    best, face, corner = -np.inf, -1, -1
    for f in range(hulls.first[i, 1], hulls.first[i + 1, 1]):
        n, gap, nearest = row(hulls.faces, f), np.inf, -1
        for k in range(hulls.first[j, 0], hulls.first[j + 1, 0]):
            height = dot(n, row(hulls.corners, k)) + hulls.faces[f, 3]
            if height < gap:
                gap, nearest = height, k
        if gap > best:
            best, face, corner = gap, f, nearest
    return best, face, corner


def along_edge(hulls, e):
    """Return the way along an edge [m]."""
    return minus(row(hulls.corners, hulls.edges[e, 1]), row(hulls.corners, hulls.edges[e, 0]))


def beside(hulls, e, way):
    """Return (left, right): how far the outward normals of both faces of an edge point along a way [m]."""
    return dot(row(hulls.faces, hulls.edges[e, 2]), way), dot(row(hulls.faces, hulls.edges[e, 3]), way)


def may_cross(hulls, e, g):
    """Return whether edges e and g of two polyhedra could touch: the arcs of their normals cross, those of g negated.
    """
    left, right = beside(hulls, e, along_edge(hulls, g))
    if not left * right < 0.0:
        return False
    its_left, its_right = beside(hulls, g, along_edge(hulls, e))
    return its_left * its_right < 0.0 and its_left * right < 0.0


def edge_axis(hulls, e, g, centre):
    """Return (gap [m], n): the unit normal of edges e and g, away from the centre of the body of e; −∞: parallel."""
    u, w, p = along_edge(hulls, e), along_edge(hulls, g), row(hulls.corners, hulls.edges[e, 0])
    n = across(u, w)
    squared = dot(n, n)
    if squared < PARALLEL * dot(u, u) * dot(w, w):
        return -np.inf, n
    n = scaled((1.0 if dot(n, minus(p, centre)) > 0.0 else -1.0) / np.sqrt(squared), n)
    return dot(n, minus(row(hulls.corners, hulls.edges[g, 0]), p)), n


def widest_edges(hulls, x, i, j):
    """Return (gap [m], e, g): the edges of bodies i and j across which they are farthest apart; −∞ if none cross."""
    best, edge, other = -np.inf, -1, -1
    for e in range(hulls.first[i, 2], hulls.first[i + 1, 2]):
        for g in range(hulls.first[j, 2], hulls.first[j + 1, 2]):
            if may_cross(hulls, e, g):
                gap, _ = edge_axis(hulls, e, g, row(x, i))
                if gap > best:
                    best, edge, other = gap, e, g
    return best, edge, other


def widest_edge(hulls, x, i, j):
    """Return the same for body j, which is a segment."""
    best, edge, segment = -np.inf, -1, hulls.first[j, 2]
    way = along_edge(hulls, segment)
    for e in range(hulls.first[i, 2], hulls.first[i + 1, 2]):
        left, right = beside(hulls, e, way)
        if left * right < 0.0:
            gap, _ = edge_axis(hulls, e, segment, row(x, i))
            if gap > best:
                best, edge = gap, e
    return best, edge, segment


def face_along(hulls, i, n):
    """Return the face of body i whose normal is nearest to n."""
    best, face = -np.inf, -1
    for f in range(hulls.first[i, 1], hulls.first[i + 1, 1]):
        along = dot(n, row(hulls.faces, f))
        if along > best:
            best, face = along, f
    return face


def facing(hulls, j, corner, n):
    """Return the face of body j, among those with this corner, that is most opposed to n."""
    best, face = np.inf, -1
    for f in range(hulls.first[j, 1], hulls.first[j + 1, 1]):
        along = dot(n, row(hulls.faces, f))
        if along < best:
            for k in range(hulls.begin[f], hulls.begin[f + 1]):
                if hulls.around[k] == corner:
                    best, face = along, f
    return face


# ---------------------------------------------------------------------------------------------- contacts

def cut_at(y, m, z, out, side):
    """Write what is left of a polygon y[:m] where out · p ≤ side into z; return its number of corners."""
    k = 0
    for i in range(m):
        j = i + 1 if i + 1 < m else 0
        s_i, s_j = dot(out, row(y, i)) - side, dot(out, row(y, j)) - side
        if s_i <= 0.0:
            put(z, k, row(y, i))
            k += 1
        if s_i * s_j < 0.0:
            put(z, k, plus(row(y, i), s_i / (s_i - s_j), minus(row(y, j), row(y, i))))
            k += 1
    return k


def side_of(hulls, f, k):
    """Return (out, side): the plane  out · p = side  through the k-th edge of face f, across the face, out of it."""
    size = hulls.begin[f + 1] - hulls.begin[f]
    p = row(hulls.corners, hulls.around[hulls.begin[f] + k])
    q = row(hulls.corners, hulls.around[hulls.begin[f] + (k + 1) % size])
    out = across(minus(q, p), row(hulls.faces, f))
    return out, dot(out, p)


def face_contacts(hulls, f, j, corner, sign, reach, y, z, c, m):
    """Write the contacts of a face with body j, whose corner is nearest to it; return how many contacts there are then.

    The face of j that looks at it is cut at its sides.  sign: 1 if the normal of a contact is that of face f, else −1.
    """
    other, n, start = facing(hulls, j, corner, row(hulls.faces, f)), row(hulls.faces, f), m
    left = hulls.begin[other + 1] - hulls.begin[other]
    for k in range(left):
        put(y, k, row(hulls.corners, hulls.around[hulls.begin[other] + k]))
    for k in range(hulls.begin[f + 1] - hulls.begin[f]):
        out, side = side_of(hulls, f, k)
        left = cut_at(y, left, z, out, side)
        for s in range(left):
            put(y, s, row(z, s))
    for k in range(left):
        gap = dot(n, row(y, k)) + hulls.faces[f, 3]
        if gap <= reach:
            m = put_point(c, m, plus(row(y, k), -0.5 * gap, n), scaled(sign, n), gap)
    return thinned(c, start, m)


def point_on_face(hulls, f, place, r, sign, reach, c, m):
    """Write the contact of a place of a core of radius r with a face; return how many contacts there are then."""
    n = row(hulls.faces, f)
    gap = dot(n, place) + hulls.faces[f, 3] - r
    return put_point(c, m, plus(place, -r - 0.5 * gap, n), scaled(sign, n), gap) if gap <= reach else m


def segment_on_face(hulls, f, j, r, sign, reach, c, m):
    """Write the contacts of the ends of that part of segment j which lies over face f; return how many there are then.
    """
    p, way, low, high = row(hulls.corners, hulls.first[j, 0]), along_edge(hulls, hulls.first[j, 2]), 0.0, 1.0
    for k in range(hulls.begin[f + 1] - hulls.begin[f]):
        out, side = side_of(hulls, f, k)
        low, high = part_between(dot(out, p) - side, dot(out, way), -np.inf, 0.0, low, high)
    if low <= high:
        m = point_on_face(hulls, f, plus(p, low, way), r, sign, reach, c, m)
    if high - low > SAME:
        m = point_on_face(hulls, f, plus(p, high, way), r, sign, reach, c, m)
    return m


def places_on_edges(hulls, e, g):
    """Return (s, t): the shares of edges e and g at which their lines are nearest to each other."""
    u, w = along_edge(hulls, e), along_edge(hulls, g)
    r = minus(row(hulls.corners, hulls.edges[g, 0]), row(hulls.corners, hulls.edges[e, 0]))
    uu, ww, uw, ur, wr = dot(u, u), dot(w, w), dot(u, w), dot(u, r), dot(w, r)
    return (ur * ww - uw * wr) / (uu * ww - uw * uw), (ur * uw - uu * wr) / (uu * ww - uw * uw)


def edge_contact(hulls, x, i, e, g, r, sign, c, m):
    """Write the contact of edge e of body i with edge g of a body of radius r; return how many contacts there are then.

    sign: 1 if the normal of the contact points away from body i, else −1.
    """
    gap, n = edge_axis(hulls, e, g, row(x, i))
    _, t = places_on_edges(hulls, e, g)
    q = plus(row(hulls.corners, hulls.edges[g, 0]), t, along_edge(hulls, g))
    return put_point(c, m, plus(q, -0.5 * (gap + r), n), scaled(sign, n), gap - r)


def thinned(c, start, end):
    """Keep at most MOST_POINTS of the contacts from `start` to end − 1; return how many contacts there are then.

    The deepest one comes first.  Each next one is that which is farthest from all that are kept.
    """
    if end - start <= MOST_POINTS:
        return end
    swap(c, start, start + np.argmin(c.gap[start:end]))
    for kept in range(start + 1, start + MOST_POINTS):
        best, far = kept, -1.0
        for k in range(kept, end):
            nearest = np.inf
            for s in range(start, kept):
                way = minus(row(c.p, k), row(c.p, s))
                nearest = min(nearest, dot(way, way))
            if nearest > far:
                best, far = k, nearest
        swap(c, kept, best)
    return start + MOST_POINTS


def swap(c, k, s):
    """Exchange contacts k and s, in place."""
    gap, n, p = c.gap[k], row(c.n, k), row(c.p, k)
    put_point(c, k, row(c.p, s), row(c.n, s), c.gap[s])
    put_point(c, s, p, n, gap)
