"""Given.  Contact points of convex shapes of any kind in the plane, and of lines.

Each shape has a *core*, which is a convex polygon, and a radius.  It contains all points within the radius of its core.
The core of a disc is one corner, and that of a capsule has two.  Boxes and other polygons have the radius 0.  So one
function serves every pair.

Cores that are apart touch along the line between their nearest points.  Where cores overlap, the
normal is that of the edge along which the shortest motion separates them (separating axes).
Where edges face each other there are two contacts.
*Source:* Catto, Box2D's manifolds: a reference edge, and the other body's edge clipped to it.
*Left out:* what is curved but not round; holes.
"""

from typing import NamedTuple

import numpy as np

from .contact_points import box_bounds_2d, box_contacts_2d, disc_bounds, first_of, room_for, round_contacts

FACES = 0.999                # cosine between the normal and that of an edge above which two corners may touch it [-]
PREFER = 1e-3                # of two edges that separate alike take that of a, unless b's is better by this share [-]
SAME = 1e-12                 # two points that differ by this share of their coordinates are one [-]


class Cores(NamedTuple):
    """Shapes of n bodies, in their own coordinates."""
    corners: np.ndarray      # (all, 2) [m], counter-clockwise; those of body i are first[i], …, first[i + 1] − 1
    first: np.ndarray        # (n + 1,)
    radius: np.ndarray       # (n,) [m]
    half: np.ndarray         # (n, 2) half sizes of discs and boxes [m], for the functions of lesson 9


def turned_corners(x, turn, cores):
    """Return the corners (all, 2) of all bodies in the world; turn (n, 2): cosine and sine of their angles."""
    corners = np.empty(cores.corners.shape)
    for i in range(cores.radius.size):
        c, s = turn[i, 0], turn[i, 1]
        for k in range(cores.first[i], cores.first[i + 1]):
            corners[k, 0] = x[i, 0] + c * cores.corners[k, 0] - s * cores.corners[k, 1]
            corners[k, 1] = x[i, 1] + s * cores.corners[k, 0] + c * cores.corners[k, 1]
    return corners


def convex_bounds_2d(x, q, cores):
    """Return (low, high, turn) of convex shapes in the plane."""
    n = cores.radius.size
    turn, low, high = np.empty((n, 2)), np.empty((n, 2)), np.empty((n, 2))
    for i in range(n):
        turn[i, 0], turn[i, 1] = np.cos(q[i]), np.sin(q[i])
    corners = turned_corners(x, turn, cores)
    for i in range(n):
        for e in range(2):
            low[i, e], high[i, e] = np.inf, -np.inf
            for k in range(cores.first[i], cores.first[i + 1]):
                low[i, e] = min(low[i, e], corners[k, e] - cores.radius[i])
                high[i, e] = max(high[i, e], corners[k, e] + cores.radius[i])
    return low, high, turn


def next_corner(k, first, last):
    """Return the corner after corner k of those from `first` to last − 1."""
    return k + 1 if k + 1 < last else first


def edge_normal(corners, k, after):
    """Return (n_x, n_y, length) of an edge from corner k to the next: the unit normal out of the polygon."""
    x, y = corners[after, 0] - corners[k, 0], corners[after, 1] - corners[k, 1]
    length = np.sqrt(x * x + y * y)
    return y / length, -x / length, length


def widest_gap(corners, a, a_end, b, b_end):
    """Return (gap, k): of all edges of polygon a the one, from corner k, from whose line polygon b is farthest.

    gap is that distance [m], below zero where all of them are crossed.  A single corner has no edge: −∞.
    """
    best, edge = -np.inf, a
    for k in range(a, a_end if a_end - a > 1 else a):
        n_x, n_y, _ = edge_normal(corners, k, next_corner(k, a, a_end))
        gap = np.inf
        for j in range(b, b_end):
            gap = min(gap, n_x * (corners[j, 0] - corners[k, 0]) + n_y * (corners[j, 1] - corners[k, 1]))
        if gap > best:
            best, edge = gap, k
    return best, edge


def nearest_on_edge(corners, j, k, after):
    """Return (squared distance, x, y): of corner j from the edge from corner k to the next, and the nearest point."""
    x, y = corners[after, 0] - corners[k, 0], corners[after, 1] - corners[k, 1]
    length = x * x + y * y
    share = 0.0
    if length > 0.0:
        share = ((corners[j, 0] - corners[k, 0]) * x + (corners[j, 1] - corners[k, 1]) * y) / length
    share = min(max(share, 0.0), 1.0)
    x, y = corners[k, 0] + share * x, corners[k, 1] + share * y
    return (corners[j, 0] - x) ** 2 + (corners[j, 1] - y) ** 2, x, y


def nearest_points(corners, a, a_end, b, b_end):
    """Return (p_x, p_y, q_x, q_y): the nearest points of two polygons that are apart, p of a and q of b."""
    best, p, q = np.inf, (0.0, 0.0), (0.0, 0.0)
    for k in range(a, a_end):
        for j in range(b, b_end):
            squared, x, y = nearest_on_edge(corners, j, k, next_corner(k, a, a_end))
            if squared < best:
                best, p, q = squared, (x, y), (corners[j, 0], corners[j, 1])
            squared, x, y = nearest_on_edge(corners, k, j, next_corner(j, b, b_end))
            if squared < best:
                best, p, q = squared, (corners[k, 0], corners[k, 1]), (x, y)
    return p[0], p[1], q[0], q[1]


def facing_edge(corners, b, b_end, n_x, n_y):
    """Return the corner from which the edge of polygon b starts that faces the direction n most."""
    best, edge = np.inf, b
    for k in range(b, b_end):
        m_x, m_y, _ = edge_normal(corners, k, next_corner(k, b, b_end))
        if m_x * n_x + m_y * n_y < best:
            best, edge = m_x * n_x + m_y * n_y, k
    return edge


def put_contact(c, m, i, j, n_x, n_y, q_x, q_y, gap, r_a, r_b, flipped):
    """Write contact m of bodies i and j; return m + 1.

    n points from the reference core to the other one, on which (q_x, q_y) lies; gap is that of both surfaces; r_a and
    r_b are the radii of the reference and of the other body.  flipped: the reference is body j.
    """
    back = r_b + 0.5 * gap
    sign = 1.0 if flipped else -1.0
    c.a[m], c.b[m], c.gap[m] = i, j, gap
    c.n[m, 0], c.n[m, 1] = sign * n_x, sign * n_y
    c.p[m, 0], c.p[m, 1] = q_x - back * n_x, q_y - back * n_y
    return m + 1


def clipped_contacts(corners, edge, after, b, b_end, n_x, n_y, r_a, r_b, reach, c, m, i, j, flipped):
    """Write the contacts of a reference edge with what polygon b has over it; return how many there are then."""
    t_x, t_y = -n_y, n_x                                             # along the edge, counter-clockwise
    wide = t_x * (corners[after, 0] - corners[edge, 0]) + t_y * (corners[after, 1] - corners[edge, 1])
    k = facing_edge(corners, b, b_end, n_x, n_y) if b_end - b > 1 else b
    end = next_corner(k, b, b_end)
    s = t_x * (corners[k, 0] - corners[edge, 0]) + t_y * (corners[k, 1] - corners[edge, 1])
    run = t_x * (corners[end, 0] - corners[k, 0]) + t_y * (corners[end, 1] - corners[k, 1])
    low, high = 0.0, 1.0 if end != k else 0.0
    if run != 0.0:                                                   # the part of b's edge that lies over a's
        first, last = -s / run, (wide - s) / run
        low, high = max(low, min(first, last)), min(high, max(first, last))
    if low > high:
        return m
    for number in range(1 if low == high else 2):
        share = low if number == 0 else high
        q_x = corners[k, 0] + share * (corners[end, 0] - corners[k, 0])
        q_y = corners[k, 1] + share * (corners[end, 1] - corners[k, 1])
        gap = n_x * (q_x - corners[edge, 0]) + n_y * (q_y - corners[edge, 1]) - r_a - r_b
        if gap <= reach:
            m = put_contact(c, m, i, j, n_x, n_y, q_x, q_y, gap, r_a, r_b, flipped)
    return m


def pair_contacts(corners, cores, i, j, reach, c, m):
    """Write the contacts of bodies i and j; return how many there are then."""
    a, a_end, b, b_end = cores.first[i], cores.first[i + 1], cores.first[j], cores.first[j + 1]
    both = cores.radius[i] + cores.radius[j]
    of_a, edge_a = widest_gap(corners, a, a_end, b, b_end)
    of_b, edge_b = widest_gap(corners, b, b_end, a, a_end)
    if max(of_a, of_b) - both > reach:
        return m
    if max(of_a, of_b) > 0.0 or (a_end - a == 1 and b_end - b == 1):
        return contacts_apart(corners, cores, i, j, reach, c, m)
    flipped = a_end - a == 1 or of_b > of_a + PREFER * (both - of_a)
    return edge_contacts(corners, cores, i, j, edge_b if flipped else edge_a, flipped, reach, c, m)


def contacts_apart(corners, cores, i, j, reach, c, m):
    """Write the contacts of bodies whose cores are apart: the nearest points, and a second one where edges face."""
    a, a_end, b, b_end = cores.first[i], cores.first[i + 1], cores.first[j], cores.first[j + 1]
    r_i, r_j = cores.radius[i], cores.radius[j]
    p_x, p_y, q_x, q_y = nearest_points(corners, a, a_end, b, b_end)
    distance = np.sqrt((q_x - p_x) ** 2 + (q_y - p_y) ** 2)
    if distance - r_i - r_j > reach:
        return m
    n_x, n_y = 0.0, -1.0                                             # one centre on the other: any normal is as good
    if distance > 0.0:
        n_x, n_y = (q_x - p_x) / distance, (q_y - p_y) / distance    # from a to b
    m = put_contact(c, m, i, j, n_x, n_y, q_x, q_y, distance - r_i - r_j, r_i, r_j, False)
    if a_end - a == 1 or b_end - b == 1:                             # a disc has one contact
        return m
    edge_a, along_a = edge_along(corners, a, a_end, n_x, n_y)
    edge_b, along_b = edge_along(corners, b, b_end, -n_x, -n_y)
    if max(along_a, along_b) < FACES:                                # corner to corner
        return m
    flipped = along_b > along_a
    end = edge_contacts(corners, cores, i, j, edge_b if flipped else edge_a, flipped, reach, c, m)
    return with_farther(c, m, end, SAME * max(distance, abs(p_x) + abs(p_y)))


def edge_along(corners, a, a_end, n_x, n_y):
    """Return (k, cosine): the edge of polygon a, from corner k, whose normal is nearest to n."""
    k = facing_edge(corners, a, a_end, -n_x, -n_y)
    m_x, m_y, _ = edge_normal(corners, k, next_corner(k, a, a_end))
    return k, m_x * n_x + m_y * n_y


def with_farther(c, m, end, least):
    """Keep, of the contacts from m to end − 1, the one that is farther from contact m − 1; return how many there are.

    None is kept that is nearer to it than `least` [m]: it is the same point.
    """
    best, far = m, 0.0
    for k in range(m, end):
        squared = (c.p[k, 0] - c.p[m - 1, 0]) ** 2 + (c.p[k, 1] - c.p[m - 1, 1]) ** 2
        if squared > far:
            best, far = k, squared
    if far <= least * least:
        return m
    c.gap[m], c.n[m, 0], c.n[m, 1] = c.gap[best], c.n[best, 0], c.n[best, 1]
    c.p[m, 0], c.p[m, 1], c.a[m], c.b[m] = c.p[best, 0], c.p[best, 1], c.a[best], c.b[best]
    return m + 1


def edge_contacts(corners, cores, i, j, edge, flipped, reach, c, m):
    """Write the contacts of an edge of body i, or of body j if flipped, with the other body; return how many then."""
    one, other = (j, i) if flipped else (i, j)
    after = next_corner(edge, cores.first[one], cores.first[one + 1])
    n_x, n_y, _ = edge_normal(corners, edge, after)
    return clipped_contacts(corners, edge, after, cores.first[other], cores.first[other + 1], n_x, n_y,
                            cores.radius[one], cores.radius[other], reach, c, m, i, j, flipped)


def line_contacts(corners, cores, i, j, line, reach, c, m):
    """Write the contacts of body i with a line, body j: of each corner within reach; return how many there are then."""
    r = cores.radius[i]
    for k in range(cores.first[i], cores.first[i + 1]):
        gap = line[0] * corners[k, 0] + line[1] * corners[k, 1] + line[2] - r
        if gap <= reach:
            c.a[m], c.b[m], c.gap[m], c.n[m, 0], c.n[m, 1] = i, j, gap, line[0], line[1]
            c.p[m, 0], c.p[m, 1] = (corners[k, 0] - (r + 0.5 * gap) * line[0],
                                    corners[k, 1] - (r + 0.5 * gap) * line[1])
            m += 1
    return m


def convex_contacts_2d(x, turn, cores, planes, pairs, reach):
    """Return the ContactSet of convex shapes and lines whose gap is at most `reach` [m]."""
    n, m, most = cores.radius.size, 0, 0
    for i in range(n):
        for k in range(pairs.first[i], pairs.first[i + 1]):
            most += 3 if pairs.partner[k] < n else cores.first[i + 1] - cores.first[i]
    c, corners = room_for(n, most, 2), turned_corners(x, turn, cores)
    for i in range(n):
        for k in range(pairs.first[i], pairs.first[i + 1]):
            j = pairs.partner[k]
            if j < n:
                m = pair_contacts(corners, cores, i, j, reach, c, m)
            else:
                m = line_contacts(corners, cores, i, j, planes[j - n], reach, c, m)
        c.first[i + 1] = m
    return first_of(c, m)


# ---------------------------------------------------------------------------------------------- one shape throughout

def disc_bounds_of(x, q, cores):
    """Return disc_bounds of lesson 9, for bodies that are discs."""
    return disc_bounds(x, q, cores.half)


def box_bounds_of(x, q, cores):
    """Return box_bounds_2d of lesson 9, for bodies that are boxes."""
    return box_bounds_2d(x, q, cores.half)


def disc_contacts_of(x, turn, cores, planes, pairs, reach):
    """Return round_contacts of lesson 9, for bodies that are discs."""
    return round_contacts(x, turn, cores.half, planes, pairs, reach)


def box_contacts_of(x, turn, cores, planes, pairs, reach):
    """Return box_contacts_2d of lesson 9, for bodies that are boxes."""
    return box_contacts_2d(x, turn, cores.half, planes, pairs, reach)
