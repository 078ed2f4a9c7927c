"""Contact points of many bodies: discs and boxes in the plane, spheres and boxes in space, each with planes.

A shape is a pair of functions:
    bounds(x, q, half) → (low, high, turn)          boxes along the axes around all bodies, and their rotation
    contacts(x, turn, half, planes, pairs, reach) → ContactSet        all contacts whose gap is at most `reach` [m]

x (n + p, d) centres [m] of n bodies and p planes · q orientations: an angle each (n + p,) in 2D, a unit quaternion (n
+ p, 4) in 3D · turn: cosine and sine (n, 2), or rotation matrices (n, 3, 3) · half (n, d) half sizes [m], of what is
round its radius d times · planes (p, d + 1), each a row (n, d) with n · p + d = 0 · pairs of the broad phase.
"""

from typing import NamedTuple

import numpy as np

from ..checks import BadInput
from ..vectors import dot
from .tuples import across, axes, axis, minus, plus, put, row, scaled

# Of the longest half size of both boxes [-]: of two faces that separate alike, take that of a unless b's is better by
# so much, or normals take turns; an edge must be better by so much than any face, which holds more points.
PREFER_FIRST, PREFER_FACES = 2e-4, 2e-3
APART = 5                    # contacts that a sweep visits one after the other lie so far from each other in memory [-]
PARALLEL = 1e-6              # sin² of the angle below which two edges count as parallel [-]


class ContactSet(NamedTuple):
    """m contacts of n bodies, ordered by body a; those with a = i are first[i], …, first[i + 1] − 1."""
    first: np.ndarray        # (n + 1,)
    a: np.ndarray            # (m,) body on the side to which the normal points
    b: np.ndarray            # (m,) the other; n + p is plane p
    n: np.ndarray            # (m, d) unit normal, from b to a
    p: np.ndarray            # (m, d) place: halfway between the two surfaces [m]
    gap: np.ndarray          # (m,) [m]; below zero they overlap


def room_for(bodies, m, d):
    """A ContactSet with room for m contacts."""
    return ContactSet(np.zeros(bodies + 1, np.int64), np.empty(m, np.int64), np.empty(m, np.int64), np.empty((m, d)),
                      np.empty((m, d)), np.empty(m))


def first_of(c, m):
    """The first m contacts."""
    return ContactSet(c.first, c.a[:m], c.b[:m], c.n[:m], c.p[:m], c.gap[:m])


def spread_order(m):
    """(m,) the order 0, 5, 10, …, 1, 6, 11, … for a sweep over m contacts.

    Contacts that lie side by side share a body, and a processor would wait for one before it begins the next.  A sweep
    in the plane takes three quarters of the time like this.
    """
    order, i = np.empty(m, np.int64), 0
    for begin in range(APART):
        for k in range(begin, m, APART):
            order[i] = k
            i += 1
    return order


def reordered(c, order):
    """The contacts in another order, without `first`.  A whole number without a sign is an index that needs no test."""
    m, d = c.n.shape
    new = ContactSet(c.first[:0], np.empty(m, np.uint32), np.empty(m, np.uint32), np.empty((m, d)), np.empty((m, d)),
                     np.empty(m))
    for i in range(m):
        k = order[i]
        new.a[i], new.b[i], new.gap[i] = c.a[k], c.b[k], c.gap[k]
        for e in range(d):
            new.n[i, e], new.p[i, e] = c.n[k, e], c.p[k, e]
    return new


def sorted_rows(J, order):
    """Rows of J (m, d) in another order."""
    rows = np.empty(J.shape)
    for i in range(J.shape[0]):
        for e in range(J.shape[1]):
            rows[i, e] = J[order[i], e]
    return rows


def put_back(J, order):
    """Rows that are sorted by `order`, as they were before."""
    back = np.empty(J.shape)
    for i in range(J.shape[0]):
        for e in range(J.shape[1]):
            back[order[i], e] = J[i, e]
    return back


def places_of(order):
    """(m,) the place at which each row is in an order."""
    place = np.empty(order.size, np.int64)
    for i in range(order.size):
        place[order[i]] = i
    return place


def with_gap(c, gap):
    """The contacts with other gaps."""
    return ContactSet(c.first, c.a, c.b, c.n, c.p, gap)


def with_gaps(c, gap, order):
    """The contacts with other gaps, which are sorted by `order`."""
    return with_gap(c, put_back(gap.reshape(-1, 1), order).ravel())


# ------------------------------------------------------------------------------------------ what is round, in 2D and 3D

def check_round(half):
    """Raise BadInput unless each body has the same half size (n, d) along all axes, which is its radius."""
    for i in range(half.shape[0]):
        for e in range(1, half.shape[1]):
            if half[i, e] != half[i, 0]:
                raise BadInput("half size of a disc or sphere [m]", half[i, e], "give its radius for every axis")


def disc_bounds(x, q, half):
    """(low, high, turn) of discs, whose rotation cannot be seen.  Raises BadInput for two different half sizes."""
    n = half.shape[0]
    check_round(half)
    return x[:n] - half, x[:n] + half, np.zeros((n, 2))


def ball_bounds(x, q, half):
    """(low, high, turn) of spheres: they look the same however they turn, so their axes are those of the world.

    Raises BadInput for different half sizes of a sphere.
    """
    n = half.shape[0]
    check_round(half)
    turn = np.zeros((n, 3, 3))
    for i in range(n):
        for e in range(3):
            turn[i, e, e] = 1.0
    return x[:n] - half, x[:n] + half, turn


def round_contacts(x, turn, half, planes, pairs, reach):
    """Contacts of discs or spheres, and planes."""
    n, d = half.shape
    c, m = room_for(n, pairs.partner.size, d), 0
    for i in range(n):
        for k in range(pairs.first[i], pairs.first[i + 1]):
            j = pairs.partner[k]
            if j < n:
                squared = 0.0
                for e in range(d):
                    c.n[m, e] = x[i, e] - x[j, e]
                    squared += c.n[m, e] ** 2
                distance = np.sqrt(squared)
                for e in range(d):                                   # one centre on the other: any normal is as good
                    c.n[m, e] = c.n[m, e] / distance if distance > 0.0 else 1.0 * (e == d - 1)
                gap = distance - half[i, 0] - half[j, 0]
            else:
                gap = planes[j - n, d] - half[i, 0]
                for e in range(d):
                    c.n[m, e] = planes[j - n, e]
                    gap += planes[j - n, e] * x[i, e]
            if gap <= reach:
                c.a[m], c.b[m], c.gap[m] = i, j, gap
                for e in range(d):
                    c.p[m, e] = x[i, e] - (half[i, 0] + 0.5 * gap) * c.n[m, e]
                m += 1
        c.first[i + 1] = m
    return first_of(c, m)


# ---------------------------------------------------------------------------------------------- boxes in the plane

def box_bounds_2d(x, q, half):
    """(low, high, turn) of boxes in the plane."""
    n = half.shape[0]
    turn, reach = np.empty((n, 2)), np.empty((n, 2))
    for i in range(n):
        turn[i, 0], turn[i, 1] = np.cos(q[i]), np.sin(q[i])
        c, s = abs(turn[i, 0]), abs(turn[i, 1])
        reach[i, 0], reach[i, 1] = half[i, 0] * c + half[i, 1] * s, half[i, 0] * s + half[i, 1] * c
    return x[:n] - reach, x[:n] + reach, turn


def face_gaps_2d(d, u, own, other, cosine, sine):
    """Gaps [m] along the two axes u and (−u_y, u_x) of a box between it and another one at d.

    own, other: half sizes (x, y) of both; cosine and sine of the angle between them, without sign.
    """
    return (abs(u[0] * d[0] + u[1] * d[1]) - own[0] - other[0] * cosine - other[1] * sine,
            abs(u[0] * d[1] - u[1] * d[0]) - own[1] - other[0] * sine - other[1] * cosine)


def clipped_edge(d, n, deep, wide, u, other):
    """(n, p, q): where the nearest edge of a box at d lies over a face at deep along ±n, ±wide across.

    u and other are that box's first axis and half sizes.  n comes back as the outward normal of the face; p and q are
    points (x, y, gap) halfway between the edge and the face.  The gap is infinite where no part of the edge is there.
    """
    if n[0] * d[0] + n[1] * d[1] < 0.0:
        n = -n[0], -n[1]
    out, edge = (other[0] * u[0], other[0] * u[1]), (-other[1] * u[1], other[1] * u[0])
    if abs(n[0] * u[0] + n[1] * u[1]) < abs(n[1] * u[0] - n[0] * u[1]):
        out, edge = edge, out
    if n[0] * out[0] + n[1] * out[1] > 0.0:              # from its centre to its edge that looks at the face
        out = -out[0], -out[1]
    if n[0] * edge[1] - n[1] * edge[0] < 0.0:                        # from there to the end at larger `along`
        edge = -edge[0], -edge[1]
    out = d[0] + out[0], d[1] + out[1]
    gap, along = n[0] * out[0] + n[1] * out[1] - deep, n[0] * out[1] - n[1] * out[0]
    rise, run = n[0] * edge[0] + n[1] * edge[1], n[0] * edge[1] - n[1] * edge[0]
    s, t = max(-1.0, (-wide - along) / run), min(1.0, (wide - along) / run)
    if s > t:
        return n, (0.0, 0.0, np.inf), (0.0, 0.0, np.inf)
    return (n, point_over_face(n, deep, along + s * run, gap + s * rise),
            point_over_face(n, deep, along + t * run, gap + t * rise))


def point_over_face(n, deep, along, gap):
    """(x, y, gap) of a contact from the centre of a box: half the gap above its face at deep along n."""
    up = deep + 0.5 * gap
    return up * n[0] - along * n[1], up * n[1] + along * n[0], gap


def box_pair_2d(d, u, w, a, b, reach):
    """(n, p, q) of boxes a and b: the normal from b to a, and their contacts (x, y, gap) from the centre of a.

    d is the way from a to b, u and w their first axes, a and b their half sizes.  A gap is infinite where there is no
    contact.  All are numbers: compiled code hands over numbers sooner than arrays.
    """
    cosine, sine, none = abs(u[0] * w[0] + u[1] * w[1]), abs(u[0] * w[1] - u[1] * w[0]), (0.0, 0.0, np.inf)
    a_x, a_y = face_gaps_2d(d, u, a, b, cosine, sine)
    of_a = max(a_x, a_y)
    if of_a > reach:
        return u, none, none
    b_x, b_y = face_gaps_2d(d, w, b, a, cosine, sine)
    of_b = max(b_x, b_y)
    if of_b > reach:
        return u, none, none
    if of_a + PREFER_FIRST * max(a[0], a[1], b[0], b[1]) >= of_b:
        face, deep, wide = (u, a[0], a[1]) if a_x >= a_y else ((-u[1], u[0]), a[1], a[0])
        n, p, q = clipped_edge(d, face, deep, wide, w, b)
        return (-n[0], -n[1]), p, q
    face, deep, wide = (w, b[0], b[1]) if b_x >= b_y else ((-w[1], w[0]), b[1], b[0])
    n, p, q = clipped_edge((-d[0], -d[1]), face, deep, wide, u, a)
    return n, (d[0] + p[0], d[1] + p[1], p[2]), (d[0] + q[0], d[1] + q[1], q[2])


def box_line(x, turn, half, i, j, line, reach, c, m):
    """Write the corners of box i that reach a line, which is body j; return how many contacts there are then."""
    for k in range(4):
        e_x, e_y = (half[i, 0] if k % 2 else -half[i, 0]), (half[i, 1] if k // 2 else -half[i, 1])
        p_x, p_y = x[i, 0] + turn[i, 0] * e_x - turn[i, 1] * e_y, x[i, 1] + turn[i, 1] * e_x + turn[i, 0] * e_y
        gap = line[0] * p_x + line[1] * p_y + line[2]
        if gap <= reach:
            c.a[m], c.b[m], c.gap[m], c.n[m, 0], c.n[m, 1] = i, j, gap, line[0], line[1]
            c.p[m, 0], c.p[m, 1] = p_x - 0.5 * gap * line[0], p_y - 0.5 * gap * line[1]
            m += 1
    return m


def box_contacts_2d(x, turn, half, planes, pairs, reach):
    """Contacts of boxes and lines in the plane, two for each pair of faces."""
    n, m = half.shape[0], 0
    c = room_for(n, 4 * pairs.partner.size, 2)
    for i in range(n):
        for k in range(pairs.first[i], pairs.first[i + 1]):
            j = pairs.partner[k]
            if j >= n:
                m = box_line(x, turn, half, i, j, planes[j - n], reach, c, m)
                continue
            d, u, w = (x[j, 0] - x[i, 0], x[j, 1] - x[i, 1]), (turn[i, 0], turn[i, 1]), (turn[j, 0], turn[j, 1])
            normal, p, q = box_pair_2d(d, u, w, (half[i, 0], half[i, 1]), (half[j, 0], half[j, 1]), reach)
            for p_x, p_y, gap in (p, q):
                if gap <= reach:
                    c.a[m], c.b[m], c.gap[m], c.n[m, 0], c.n[m, 1] = i, j, gap, normal[0], normal[1]
                    c.p[m, 0], c.p[m, 1] = x[i, 0] + p_x, x[i, 1] + p_y
                    m += 1
        c.first[i + 1] = m
    return first_of(c, m)


# ---------------------------------------------------------------------------------------------- boxes in space

def rotations(q, n):
    """The rotation matrices (n, 3, 3) of the first n bodies, q (n + p, 4)."""
    turn = np.empty((n, 3, 3))
    for i in range(n):
        for k, axis_k in enumerate(axes(q, i)):
            turn[i, 0, k], turn[i, 1, k], turn[i, 2, k] = axis_k
    return turn


def box_bounds(x, q, half):
    """(low, high, turn) of boxes in space."""
    n = half.shape[0]
    turn, reach = rotations(q, n), np.empty((n, 3))
    for i in range(n):
        for e in range(3):
            along_x, along_y, along_z = abs(turn[i, e, 0]), abs(turn[i, e, 1]), abs(turn[i, e, 2])
            reach[i, e] = half[i, 0] * along_x + half[i, 1] * along_y + half[i, 2] * along_z
    return x[:n] - reach, x[:n] + reach, turn


def face_gap(C, t, h_a, h_b, k):
    """Gap [m] along axis k of a (k < 3) or k − 3 of b; C = R_aᵀ R_b, t = x_b − x_a in the coordinates of a."""
    if k < 3:
        return abs(t[k]) - h_a[k] - h_b[0] * abs(C[k, 0]) - h_b[1] * abs(C[k, 1]) - h_b[2] * abs(C[k, 2])
    j = k - 3
    distance = abs(t[0] * C[0, j] + t[1] * C[1, j] + t[2] * C[2, j])
    return distance - h_b[j] - h_a[0] * abs(C[0, j]) - h_a[1] * abs(C[1, j]) - h_a[2] * abs(C[2, j])


def edge_gap(C, t, h_a, h_b, i, j):
    """Gap [m] along the normal of edge i of a and edge j of b; −∞ if these are parallel: then a face says the same."""
    squared_sine = 1.0 - C[i, j] * C[i, j]
    if squared_sine < PARALLEL:
        return -np.inf
    i_1, i_2, j_1, j_2 = (i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3
    distance = abs(t[i_2] * C[i_1, j] - t[i_1] * C[i_2, j])
    reach_a = h_a[i_1] * abs(C[i_2, j]) + h_a[i_2] * abs(C[i_1, j])
    reach = reach_a + h_b[j_1] * abs(C[i, j_2]) + h_b[j_2] * abs(C[i, j_1])
    return (distance - reach) / np.sqrt(squared_sine)


def cut(y, m, z, e, side, sign):
    """Write what is left of a polygon y[:m] where sign y_e ≤ side into z; return its number of corners."""
    k = 0
    for i in range(m):
        j = i + 1 if i + 1 < m else 0
        s_i, s_j = sign * y[i, e] - side, sign * y[j, e] - side
        if s_i <= 0.0:
            put(z, k, row(y, i))
            k += 1
        if s_i * s_j < 0.0:
            put(z, k, plus(row(y, i), s_i / (s_i - s_j), minus(row(y, j), row(y, i))))
            k += 1
    return k


def face_points(x, turn, half, i, j, k, reach, y, z, c, m, sign):
    """Write the contacts of box j with face ±k of box i from place m on; return how many contacts there are then."""
    d = minus(row(x, j), row(x, i))
    side = 1.0 if dot(axis(turn, i, k), d) >= 0.0 else -1.0
    n = scaled(side, axis(turn, i, k))
    face = 0                                                         # of box j, that looks at it
    for e in range(1, 3):
        if abs(dot(n, axis(turn, j, e))) > abs(dot(n, axis(turn, j, face))):
            face = e
    f, g = (face + 1) % 3, (face + 2) % 3
    middle = plus(d, -half[j, face] if dot(n, axis(turn, j, face)) > 0.0 else half[j, face], axis(turn, j, face))
    for corner in range(4):
        p = plus(middle, half[j, f] if corner % 3 == 0 else -half[j, f], axis(turn, j, f))
        p = plus(p, half[j, g] if corner < 2 else -half[j, g], axis(turn, j, g))
        put(y, corner, (dot(p, axis(turn, i, 0)), dot(p, axis(turn, i, 1)), dot(p, axis(turn, i, 2))))
    left = 4
    for e in ((k + 1) % 3, (k + 2) % 3):
        left = cut(y, left, z, e, half[i, e], 1.0)
        left = cut(z, left, y, e, half[i, e], -1.0)
    for corner in range(left):
        gap = side * y[corner, k] - half[i, k]
        if gap <= reach:
            p = plus(row(x, i), -0.5 * gap, n)
            for e in range(3):
                p = plus(p, y[corner, e], axis(turn, i, e))
            put(c.p, m, p)
            put(c.n, m, scaled(sign, n))
            c.gap[m] = gap
            m += 1
    return m


def edge_middle(x, turn, half, i, k, n):
    """The middle of that edge along axis k of box i which lies farthest along n."""
    p = row(x, i)
    for e in range(3):
        if e != k:
            p = plus(p, half[i, e] if dot(axis(turn, i, e), n) > 0.0 else -half[i, e], axis(turn, i, e))
    return p


def edge_point(x, turn, half, i, j, e, f, gap, c, m):
    """Write the contact of edge e of box i and edge f of box j; return how many contacts there are then."""
    u, w = axis(turn, i, e), axis(turn, j, f)
    n, cosine = across(u, w), dot(u, w)
    n = scaled((1.0 if dot(n, minus(row(x, i), row(x, j))) > 0.0 else -1.0) / np.sqrt(dot(n, n)), n)
    p, q = edge_middle(x, turn, half, i, e, scaled(-1.0, n)), edge_middle(x, turn, half, j, f, n)
    r = minus(q, p)
    p = plus(p, (dot(u, r) - cosine * dot(w, r)) / (1.0 - cosine**2), u)             # the nearest points of both lines
    q = plus(q, (cosine * dot(u, r) - dot(w, r)) / (1.0 - cosine**2), w)
    put(c.p, m, scaled(0.5, plus(p, 1.0, q)))
    put(c.n, m, n)
    c.gap[m] = gap
    return m + 1


def box_pair(x, turn, half, i, j, reach, C, t, y, z, c, m):
    """Write the contacts of boxes i and j from place m on; C, t, y, z are scratch.

    Return how many contacts there are then.
    """
    d = minus(row(x, j), row(x, i))
    for r in range(3):
        t[r] = dot(axis(turn, i, r), d)
        for s in range(3):
            C[r, s] = dot(axis(turn, i, r), axis(turn, j, s))
    best, k, h_a, h_b = -np.inf, 0, half[i], half[j]
    size = max(h_a[0], h_a[1], h_a[2], h_b[0], h_b[1], h_b[2])
    for test in range(15):
        gap = face_gap(C, t, h_a, h_b, test) if test < 6 else edge_gap(C, t, h_a, h_b, (test - 6) // 3, (test - 6) % 3)
        if gap > reach:
            return m
        if gap > best + size * (0.0 if test < 3 else PREFER_FIRST if test < 6 else PREFER_FACES):
            best, k = gap, test
    if k < 3:
        return face_points(x, turn, half, i, j, k, reach, y, z, c, m, -1.0)
    if k < 6:
        return face_points(x, turn, half, j, i, k - 3, reach, y, z, c, m, 1.0)
    return edge_point(x, turn, half, i, j, (k - 6) // 3, (k - 6) % 3, best, c, m)


def box_plane(x, turn, half, i, plane, reach, c, m):
    """Write the corners of box i that reach a plane; return how many contacts there are then."""
    n = (plane[0], plane[1], plane[2])
    for corner in range(8):
        p = row(x, i)
        for e in range(3):
            p = plus(p, half[i, e] if corner >> e & 1 else -half[i, e], axis(turn, i, e))
        gap = dot(n, p) + plane[3]
        if gap <= reach:
            put(c.p, m, plus(p, -0.5 * gap, n))
            put(c.n, m, n)
            c.gap[m] = gap
            m += 1
    return m


def box_contacts(x, turn, half, planes, pairs, reach):
    """Contacts of boxes and planes in space, up to eight for each pair of faces."""
    n, m = half.shape[0], 0
    c = room_for(n, 8 * pairs.partner.size, 3)
    C, t, y, z = np.empty((3, 3)), np.empty(3), np.empty((8, 3)), np.empty((8, 3))
    for i in range(n):
        for k in range(pairs.first[i], pairs.first[i + 1]):
            j, before = pairs.partner[k], m
            if j < n:
                m = box_pair(x, turn, half, i, j, reach, C, t, y, z, c, m)
            else:
                m = box_plane(x, turn, half, i, planes[j - n], reach, c, m)
            for s in range(before, m):
                c.a[s], c.b[s] = i, j
        c.first[i + 1] = m
    return first_of(c, m)


def largest_overlap(contacts):
    """Given.  Return how far the deepest contact has sunk in [m]; 0 if none has."""
    return np.max(np.append(0.0, -contacts.gap))
