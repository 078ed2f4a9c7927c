"""Given with lesson 10.  Contacts of convex polyhedra in space, with each other and with balls, capsules and boxes.

Two polyhedra touch along the axis that separates them best (support/hulls.py): the nearest face of one is cut at the
sides of a face of the other, or two edges cross.  A box is a polyhedron here, with the same contacts as in lesson 9.
Where no face and no two edges are nearest, gjk of lesson 6 finds the nearest points.  It does so for all balls and
capsules, too: their core is a point or a segment.  A capsule that lies over a face has contacts at both ends.
*Left out:* a capsule that lies along an edge touches it in one point.
"""

import numpy as np

from ..collisions import gjk
from ..support.contact_points import PREFER_FACES, PREFER_FIRST, box_bounds, first_of, room_for
from ..support.convex_3d import PREFER_FACES as PREFER_FACES_TO_SEGMENTS
from ..support.convex_3d import SAME, put_point, rounded_pair
from ..support.hulls import (
    MOST_POINTS,
    edge_contact,
    face_along,
    face_contacts,
    hulls_in_world,
    places_on_edges,
    point_on_face,
    segment_on_face,
    thinned,
    widest_edge,
    widest_edges,
    widest_face,
)
from ..support.tuples import minus, plus, row, scaled
from ..vectors import dot

TOUCHING = 1e-7              # distance over the size below which gjk, whose |v|² is rounded, may see bodies overlap [-]


def hull_bounds(x, q, shapes):
    """Return (low, high, turn) of polyhedra and rounded boxes."""
    low, high, turn = box_bounds(x, q, shapes.core)
    hulls = hulls_in_world(x, turn, shapes.hulls)
    for i in range(shapes.radius.size):
        for e in range(3):
            low[i, e], high[i, e] = np.inf, -np.inf
            for k in range(hulls.first[i, 0], hulls.first[i + 1, 0]):
                low[i, e] = min(low[i, e], hulls.corners[k, e] - shapes.radius[i])
                high[i, e] = max(high[i, e], hulls.corners[k, e] + shapes.radius[i])
    return low, high, turn


def is_polyhedron(shapes, i):
    """Return whether body i is a Polyhedron: the others have a radius, or are boxes."""
    return shapes.radius[i] == 0.0 and shapes.core[i, 1] == 0.0


def hull_contacts(x, turn, shapes, planes, pairs, reach):
    """Return the ContactSet of polyhedra, rounded boxes and planes whose gap is at most `reach` [m]."""
    n, m, most, hulls = shapes.radius.size, 0, 8, hulls_in_world(x, turn, shapes.hulls)
    for i in range(n):
        most = max(most, 2 * (hulls.first[i + 1, 0] - hulls.first[i, 0]))        # of two faces, or of all corners
    c = room_for(n, MOST_POINTS * pairs.partner.size + most, 3)
    C, t, y, z = np.empty((3, 3)), np.empty(3), np.empty((most, 3)), np.empty((most, 3))
    for i in range(n):
        for k in range(pairs.first[i], pairs.first[i + 1]):
            j, before = pairs.partner[k], m
            if not (is_polyhedron(shapes, i) or (j < n and is_polyhedron(shapes, j))):
                m = rounded_pair(x, turn, shapes, planes, i, j, reach, C, t, y, z, c, m)
            elif j >= n:
                m = hull_on_plane(hulls, i, planes[j - n], reach, c, m)
            elif shapes.radius[i] > 0.0:
                m = round_on_hull(x, hulls, shapes, j, i, 1.0, reach, c, m)
            elif shapes.radius[j] > 0.0:
                m = round_on_hull(x, hulls, shapes, i, j, -1.0, reach, c, m)
            else:
                m = hull_pair(x, hulls, shapes, i, j, reach, y, z, c, m)
            for s in range(before, m):
                c.a[s], c.b[s] = i, j
        c.first[i + 1] = m
    return first_of(c, m)


def hull_on_plane(hulls, i, plane, reach, c, m):
    """Write the contacts of the corners of polyhedron i with a plane; return how many contacts there are then."""
    n, start = (plane[0], plane[1], plane[2]), m
    for k in range(hulls.first[i, 0], hulls.first[i + 1, 0]):
        p = row(hulls.corners, k)
        gap = dot(n, p) + plane[3]
        if gap <= reach:
            m = put_point(c, m, plus(p, -0.5 * gap, n), n, gap)
    return thinned(c, start, m)


def longest(shapes, i, j):
    """Return the longest half size of two bodies [m]."""
    return max(np.max(shapes.half[i]), np.max(shapes.half[j]))


def nearest_points(hulls, i, j):
    """Return (p, q, n, gap): the nearest points of the cores of bodies i and j, and the unit normal from j to i."""
    first = hulls.first
    found = gjk(hulls.corners[first[i, 0]:first[i + 1, 0]], hulls.corners[first[j, 0]:first[j + 1, 0]])
    p, q, n = found.p_a, found.p_b, found.n
    return (p[0], p[1], p[2]), (q[0], q[1], q[2]), (n[0], n[1], n[2]), found.gap


def hull_pair(x, hulls, shapes, i, j, reach, y, z, c, m):
    """Write the contacts of polyhedra i and j; return how many contacts there are then.  y, z are scratch.

    Faces of i come first, because they hold more points than edges, and normals must not take turns (lesson 9).
    """
    of_i, face_i, corner_j = widest_face(hulls, i, j)
    of_j, face_j, corner_i = widest_face(hulls, j, i)
    if max(of_i, of_j) > reach:
        return m
    of_edges, e, g = widest_edges(hulls, x, i, j)
    widest, size = max(of_i, of_j, of_edges), longest(shapes, i, j)
    if widest > reach:
        return m
    flipped = of_j > of_i + PREFER_FIRST * size
    f, other, corner, sign = (face_j, i, corner_i, 1.0) if flipped else (face_i, j, corner_j, -1.0)
    if of_edges > (of_j if flipped else of_i) + PREFER_FACES * size:
        s, t = places_on_edges(hulls, e, g)
        if widest <= 0.0 or (0.0 <= s <= 1.0 and 0.0 <= t <= 1.0):
            return edge_contact(hulls, x, i, e, g, 0.0, -1.0, c, m)
    else:
        end = face_contacts(hulls, f, other, corner, sign, reach, y, z, c, m)
        if end > m:
            return end
    p, q, n, gap = nearest_points(hulls, i, j)
    if gap > TOUCHING * size:
        return put_point(c, m, scaled(0.5, plus(p, 1.0, q)), n, gap) if gap <= reach else m
    return point_on_face(hulls, f, row(hulls.corners, corner), 0.0, sign, reach, c, m)


def round_on_hull(x, hulls, shapes, i, j, sign, reach, c, m):
    """Write the contacts of ball or capsule j with polyhedron i; return how many contacts there are then.

    sign: 1 if the normal points to j, else −1
    """
    widest, r, size = widest_face(hulls, i, j), shapes.radius[j], longest(shapes, i, j)
    if widest[0] - r > reach:
        return m
    _, q, n, distance = nearest_points(hulls, j, i)
    if distance <= TOUCHING * size:
        return round_in_hull(x, hulls, i, j, widest, r, size, sign, reach, c, m)
    gap = distance - r
    if gap > reach:
        return m
    m = put_point(c, m, plus(q, 0.5 * gap, n), scaled(sign, n), gap)
    if shapes.core[j, 0] == 0.0:
        return m
    return without_first(c, m, segment_on_face(hulls, face_along(hulls, i, n), j, r, sign, reach, c, m), SAME * size)


def without_first(c, m, end, least):
    """Keep those contacts from m to end − 1 that are farther from contact m − 1 than `least` [m]; return how many then.
    """
    for k in range(m, end):
        way = minus(row(c.p, k), row(c.p, m - 1))
        if dot(way, way) > least * least:
            put_point(c, m, row(c.p, k), row(c.n, k), c.gap[k])
            m += 1
    return m


def round_in_hull(x, hulls, i, j, widest, r, size, sign, reach, c, m):
    """Write the contacts of a core j that is inside polyhedron i; return how many contacts there are then.

    The shortest way out is across a face (widest: its gap, its number and the nearest corner), or across two edges.
    """
    gap, f, corner = widest
    if hulls.first[j + 1, 0] - hulls.first[j, 0] > 1:
        of_edges, e, g = widest_edge(hulls, x, i, j)
        if of_edges > gap + PREFER_FACES_TO_SEGMENTS * size:
            return edge_contact(hulls, x, i, e, g, r, sign, c, m)
        end = segment_on_face(hulls, f, j, r, sign, reach, c, m)
        if end > m:
            return end
    return point_on_face(hulls, f, row(hulls.corners, corner), r, sign, reach, c, m)
