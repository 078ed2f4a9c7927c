"""Given.  Contact points of balls, capsules, boxes and planes in space.

Each shape is a *rounded box*: all points within a radius of a box, its core.  The core of a ball is a point, that of a
capsule a segment, and that of a box is the box itself, with the radius 0.

Two boxes meet as in lesson 9.  All other pairs have a segment, which a point is as well: where the cores are apart, a
contact lies between their nearest points, and more between the ends of those parts of the segment that lie over the
same face or edge, or over the face that is nearest.  So a capsule that lies on something has two contacts.  Where a
segment is inside a box, the normal is that of the shortest way out.
*Left out:* corners of two boxes that are apart touch no sooner than they overlap, as in lesson 9.
"""

from typing import NamedTuple

import numpy as np

from ..vectors import dot
from .contact_points import (
    ball_bounds,
    box_bounds,
    box_contacts,
    box_pair,
    first_of,
    room_for,
    round_contacts,
)
from .tuples import across, axis, minus, plus, put, row, scaled

SAME = 1e-9                  # places that differ by this share of the size are one [-]
PARALLEL = 1e-6              # sin² of the angle below which two directions count as parallel [-]
PREFER_FACES = 1e-9          # of the size: so much better than a face must an edge separate [-]


class Hulls(NamedTuple):
    """Convex polyhedra of n bodies.  A ball is a corner and a capsule is an edge: they have no face."""
    corners: np.ndarray      # (all, 3) [m]
    faces: np.ndarray        # (faces, 4) planes: rows (n, d) with n · p + d = 0, and n outward
    around: np.ndarray       # numbers of the corners of all faces, counter-clockwise from outside
    begin: np.ndarray        # (faces + 1,) those of face f are around[begin[f]], …, around[begin[f + 1] − 1]
    edges: np.ndarray        # (edges, 4) numbers: from a corner to a corner, the face on the left, that on the right
    first: np.ndarray        # (n + 1, 3) numbers of the first corner, face and edge of each body


NO_HULLS = Hulls(np.zeros((0, 3)), np.zeros((0, 4)), np.zeros(0, np.int64), np.zeros(1, np.int64),
                 np.zeros((0, 4), np.int64), np.zeros((1, 3), np.int64))


class RoundedBoxes(NamedTuple):
    """Shapes of n bodies in space, in their own coordinates."""
    core: np.ndarray         # (n, 3) half sizes of the cores [m]: 0, 0, 0 of a ball, and h, 0, 0 of a capsule
    radius: np.ndarray       # (n,) [m]
    half: np.ndarray         # (n, 3) half sizes of balls and boxes [m], for the functions of lesson 9
    hulls: Hulls = NO_HULLS  # of all bodies, if one of them is a Polyhedron; its core and its radius are 0


def rounded_bounds(x, q, shapes):
    """Return (low, high, turn) of rounded boxes."""
    low, high, turn = box_bounds(x, q, shapes.core)
    for i in range(shapes.radius.size):
        for e in range(3):
            low[i, e] -= shapes.radius[i]
            high[i, e] += shapes.radius[i]
    return low, high, turn


def rounded_contacts(x, turn, shapes, planes, pairs, reach):
    """Return the ContactSet of rounded boxes and planes whose gap is at most `reach` [m]."""
    n, m = shapes.radius.size, 0
    c = room_for(n, 8 * pairs.partner.size, 3)
    C, t, y, z = np.empty((3, 3)), np.empty(3), np.empty((8, 3)), np.empty((8, 3))
    for i in range(n):
        for k in range(pairs.first[i], pairs.first[i + 1]):
            j, before = pairs.partner[k], m
            m = rounded_pair(x, turn, shapes, planes, i, j, reach, C, t, y, z, c, m)
            for s in range(before, m):
                c.a[s], c.b[s] = i, j
        c.first[i + 1] = m
    return first_of(c, m)


def rounded_pair(x, turn, shapes, planes, i, j, reach, C, t, y, z, c, m):
    """Write the contacts of rounded boxes i and j, or of a plane; C, t, y, z are scratch.

    Return how many contacts there are then.
    """
    if j >= shapes.radius.size:
        return corners_on_plane(x, turn, shapes, i, planes[j - shapes.radius.size], reach, c, m)
    if shapes.core[i, 1] > 0.0 and shapes.core[j, 1] > 0.0:
        return box_pair(x, turn, shapes.core, i, j, reach, C, t, y, z, c, m)
    if shapes.core[i, 1] > 0.0:
        return segment_on_box(x, turn, shapes, i, j, -1.0, reach, c, m)
    if shapes.core[j, 1] > 0.0:
        return segment_on_box(x, turn, shapes, j, i, 1.0, reach, c, m)
    return segment_on_segment(x, turn, shapes, i, j, reach, c, m)


def corners_on_plane(x, turn, shapes, i, plane, reach, c, m):
    """Write the contacts of the corners of core i with a plane; return how many contacts there are then."""
    n, r = (plane[0], plane[1], plane[2]), shapes.radius[i]
    for corner in range(8):
        p, twice = row(x, i), False
        for e in range(3):
            far = corner >> e & 1 == 1
            twice = twice or (far and shapes.core[i, e] == 0.0)
            p = plus(p, shapes.core[i, e] if far else -shapes.core[i, e], axis(turn, i, e))
        gap = dot(n, p) + plane[3] - r
        if gap <= reach and not twice:
            m = put_point(c, m, plus(p, -r - 0.5 * gap, n), n, gap)
    return m


def put_point(c, m, place, n, gap):
    """Write contact m; return m + 1."""
    put(c.p, m, place)
    put(c.n, m, n)
    c.gap[m] = gap
    return m + 1


# ---------------------------------------------------------------------------------------------- two segments

def limited(s, most):
    """Return s, but at most `most` in size."""
    return min(max(s, -most), most)


def segment_on_segment(x, turn, shapes, i, j, reach, c, m):
    """Write the contacts of two balls or capsules; return how many contacts there are then.

    The points x_i + s u and x_j + t w are nearest where each is the projection of the other, or at an end.
    *Source:* Ericson 2005, section 5.1.9.
    """
    u, w, r = axis(turn, i, 0), axis(turn, j, 0), minus(row(x, i), row(x, j))
    h_i, h_j, cosine, along = shapes.core[i, 0], shapes.core[j, 0], dot(u, w), dot(w, r)
    low, high = part_between(along, cosine, -h_j, h_j, -h_i, h_i)
    s, skew = low if low <= high else 0.0, 1.0 - cosine * cosine
    if skew > PARALLEL or low > high:
        s = limited((cosine * along - dot(u, r)) / skew if skew > PARALLEL else 0.0, h_i)
        s = limited(limited(along + s * cosine, h_j) * cosine - dot(u, r), h_i)
    m = between_segments(x, shapes, i, j, u, w, s, reach, c, m)
    for end in (low, high):
        if low <= high and abs(end - s) > SAME * h_i:
            m = between_segments(x, shapes, i, j, u, w, end, reach, c, m)
    return m


def part_between(start, slope, least, most, low, high):
    """Return (low, high) of those s between low and high for which  least ≤ start + slope s ≤ most;  low > high: none.
    """
    if slope == 0.0:
        return (low, high) if least <= start <= most else (1.0, 0.0)
    first, last = (least - start) / slope, (most - start) / slope
    return max(low, min(first, last)), min(high, max(first, last))


def between_segments(x, shapes, i, j, u, w, s, reach, c, m):
    """Write the contact of the place s on segment i with the nearest place on segment j; return how many then."""
    p, r_i, r_j = plus(row(x, i), s, u), shapes.radius[i], shapes.radius[j]
    q = plus(row(x, j), limited(dot(w, minus(p, row(x, j))), shapes.core[j, 0]), w)
    n = minus(p, q)
    distance = np.sqrt(dot(n, n))
    gap = distance - r_i - r_j
    if gap > reach:
        return m
    if distance == 0.0:                                              # they cross: n is across both, if there is one
        n = across(u, w) if dot(across(u, w), across(u, w)) > PARALLEL else (0.0, 0.0, 1.0)
        distance = np.sqrt(dot(n, n))
    n = scaled(1.0 / distance, n)
    return put_point(c, m, plus(q, r_j + 0.5 * gap, n), n, gap)


# ---------------------------------------------------------------------------------------------- a segment and a box

def segment_on_box(x, turn, shapes, i, j, sign, reach, c, m):
    """Write the contacts of ball or capsule j with box i; return how many contacts there are then.

    sign: 1 if the normal points to j, else −1.  y and e are the centre and the direction of the segment as the box sees
    them, and s is a place on it.
    """
    d, u, h = minus(row(x, j), row(x, i)), axis(turn, j, 0), shapes.core[j, 0]
    y = dot(axis(turn, i, 0), d), dot(axis(turn, i, 1), d), dot(axis(turn, i, 2), d)
    e = dot(axis(turn, i, 0), u), dot(axis(turn, i, 1), u), dot(axis(turn, i, 2), u)
    half = row(shapes.core, i)
    s = nearest_place(y, e, h, half)
    out = outside(plus(y, s, e), half)
    near = SAME * max(half[0], half[1], half[2])
    if dot(out, out) <= near * near:
        return way_out(x, turn, shapes, i, j, y, e, sign, reach, c, m)
    m = above_box(x, turn, shapes, i, j, plus(y, s, e), sign, reach, c, m)
    far = max(abs(out[0]), abs(out[1]), abs(out[2]))
    same, face = part_over(y, e, h, half, out, near), part_over(y, e, h, half, out, far)
    places = (s, same[0], same[1], face[0], face[1])
    for k in range(1, 5):
        there = same[0] <= same[1] if k < 3 else face[0] <= face[1]
        for other in range(k):
            there = there and abs(places[k] - places[other]) > SAME * h
        if there:
            m = above_box(x, turn, shapes, i, j, plus(y, places[k], e), sign, reach, c, m)
    return m


def part_over(y, e, h, half, out, far):
    """Return (low, high): the part of a segment that lies over a face or an edge of a box; low > high: none.

    out: the way to the segment from the nearest point of the box.  Along axes in which it is 0 or shorter than `far`
    [m], the part ends at the sides of the box.  With a `far` of round-off it is over the face or edge on which that
    point lies.  With far = the largest entry it is over a face, even if a tilted segment bears on an edge.
    """
    low, high = -h, h
    for k in range(3):
        if out[k] == 0.0 or abs(out[k]) < far:
            low, high = part_between(y[k], e[k], -half[k], half[k], low, high)
    return low, high


def outside(y, half):
    """Return the way from the nearest point of a box to the point y; zeros inside."""
    return (y[0] - limited(y[0], half[0]), y[1] - limited(y[1], half[1]), y[2] - limited(y[2], half[2]))


def nearest_place(y, e, h, half):
    """Return the s, from −h to h, at which y + s e is nearest to a box.

    The derivative of half the squared distance, e · outside, grows with s.  It is linear between the places where the
    segment crosses the planes of the faces.
    """
    low, high = -h, h
    at_low, at_high = dot(e, outside(plus(y, low, e), half)), dot(e, outside(plus(y, high, e), half))
    if at_low >= 0.0:
        return low
    if at_high <= 0.0:
        return high
    for k in range(6):
        i = k // 2
        if e[i] != 0.0:
            s = ((half[i] if k % 2 else -half[i]) - y[i]) / e[i]
            if low < s < high:
                slope = dot(e, outside(plus(y, s, e), half))
                if slope < 0.0:
                    low, at_low = s, slope
                else:
                    high, at_high = s, slope
    return low - at_low * (high - low) / (at_high - at_low)


def above_box(x, turn, shapes, i, j, y, sign, reach, c, m):
    """Write the contact of a point y of core j, outside box i, with the nearest point of the box; return how many then.
    """
    out = outside(y, row(shapes.core, i))
    distance = np.sqrt(dot(out, out))
    gap = distance - shapes.radius[j]
    if gap > reach or distance == 0.0:
        return m
    place = plus(minus(y, out), 0.5 * gap / distance, out)
    return put_in_world(x, turn, i, place, scaled(sign / distance, out), gap, c, m)


def put_in_world(x, turn, i, place, n, gap, c, m):
    """Write contact m, whose place and normal are in coordinates of body i; return m + 1."""
    p, way = row(x, i), (0.0, 0.0, 0.0)
    for k in range(3):
        p, way = plus(p, place[k], axis(turn, i, k)), plus(way, n[k], axis(turn, i, k))
    return put_point(c, m, p, way, gap)


def way_out(x, turn, shapes, i, j, y, e, sign, reach, c, m):
    """Write the contacts of a segment, of core j, that is inside box i; return how many contacts there are then.

    The shortest way out is across a face, or across an edge and the segment.
    """
    h, half, best, face, edge = shapes.core[j, 0], row(shapes.core, i), -np.inf, 0, -1
    for k in range(3):
        gap = abs(y[k]) - half[k] - h * abs(e[k])
        if gap > best:
            best, face = gap, k
    ahead = PREFER_FACES * max(half[0], half[1], half[2], h)
    for k in range(3):
        gap = edge_depth(y, e, half, k)
        if h > 0.0 and gap > best + ahead:
            best, edge = gap, k
    if edge >= 0:
        return over_edge(x, turn, shapes, i, j, y, e, edge, sign, reach, c, m)
    return over_face(x, turn, shapes, i, j, y, e, face, sign, reach, c, m)


def edge_depth(y, e, half, k):
    """Return the gap [m] across edge k of a box and a segment through y along e; −∞ if these are parallel."""
    a, b = (k + 1) % 3, (k + 2) % 3
    length = np.sqrt(e[a] * e[a] + e[b] * e[b])
    if length * length < PARALLEL:
        return -np.inf
    return (abs(y[a] * e[b] - y[b] * e[a]) - half[a] * abs(e[b]) - half[b] * abs(e[a])) / length


def over_face(x, turn, shapes, i, j, y, e, k, sign, reach, c, m):
    """Write the contacts of a segment with a face across axis k of box i: of both ends of what is over the face."""
    h, r, half = shapes.core[j, 0], shapes.radius[j], row(shapes.core, i)
    low, high, side = -h, h, 1.0 if y[k] >= 0.0 else -1.0
    for other in ((k + 1) % 3, (k + 2) % 3):
        low, high = part_between(y[other], e[other], -half[other], half[other], low, high)
    n = scaled(side, (1.0 * (k == 0), 1.0 * (k == 1), 1.0 * (k == 2)))
    for number in range(2 if high - low > SAME * h else 1):
        p = plus(y, low if number == 0 else high, e)
        gap = side * p[k] - half[k] - r
        if gap <= reach:
            m = put_in_world(x, turn, i, plus(p, -r - 0.5 * gap, n), scaled(sign, n), gap, c, m)
    return m


def over_edge(x, turn, shapes, i, j, y, e, k, sign, reach, c, m):
    """Write the contact of a segment with an edge along axis k of box i."""
    a, b, half, r = (k + 1) % 3, (k + 2) % 3, row(shapes.core, i), shapes.radius[j]
    size, turned = np.sqrt(e[a] * e[a] + e[b] * e[b]), 1.0 if y[a] * e[b] - y[b] * e[a] >= 0.0 else -1.0
    n_a, n_b = turned * e[b] / size, -turned * e[a] / size
    at_a, at_b = (half[a] if n_a > 0.0 else -half[a]), (half[b] if n_b > 0.0 else -half[b])
    s = limited(((at_a - y[a]) * e[a] + (at_b - y[b]) * e[b]) / (size * size), shapes.core[j, 0])
    gap = n_a * (y[a] - at_a) + n_b * (y[b] - at_b) - r
    if gap > reach:
        return m
    n = (n_a if a == 0 else n_b if b == 0 else 0.0, n_a if a == 1 else n_b if b == 1 else 0.0,
         n_a if a == 2 else n_b if b == 2 else 0.0)
    return put_in_world(x, turn, i, plus(plus(y, s, e), -r - 0.5 * gap, n), scaled(sign, n), gap, c, m)


# ---------------------------------------------------------------------------------------------- one shape throughout

def ball_bounds_of(x, q, shapes):
    """Return ball_bounds of lesson 9, for bodies that are balls."""
    return ball_bounds(x, q, shapes.half)


def ball_contacts_of(x, turn, shapes, planes, pairs, reach):
    """Return round_contacts of lesson 9, for bodies that are balls."""
    return round_contacts(x, turn, shapes.half, planes, pairs, reach)


def cuboid_bounds_of(x, q, shapes):
    """Return box_bounds of lesson 9, for bodies that are boxes in space."""
    return box_bounds(x, q, shapes.half)


def cuboid_contacts_of(x, turn, shapes, planes, pairs, reach):
    """Return box_contacts of lesson 9, for bodies that are boxes in space."""
    return box_contacts(x, turn, shapes.half, planes, pairs, reach)
