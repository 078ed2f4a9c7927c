"""Contact points of boxes in space and of convex shapes in the plane, and what a pile does in a step.

Each truth comes from corners and planes, by trying all of them, and never from the formulas of the given functions.
"""

from itertools import combinations, product

import numpy as np

from solutions.support.broad_phase import box_reaches, boxes_overlap, near_pairs
from solutions.support.convex_2d import Cores, convex_bounds_2d, convex_contacts_2d, edge_along
from solutions.support.kept_contacts import (
    AHEAD,
    GONE,
    begin_ways,
    have_moved,
    mark_far,
    mark_gone,
    pairs_in_reach,
    unknown_ways,
    widened,
)
from solutions.support.kept_contacts import REACH as SHARE
from validate.stability.case import case, matrix_of, random_law, random_quaternions, turned_by, unlike

EXACT = 1e-9                 # of numbers around 1: the same by another sum
TOUCHING = 3e-4              # overlap of bodies that a soft contact stops [m]: 5e-5, and 3e-3 after a search too late
REACH = 0.06                 # gap up to which contacts are found [m]
DEEPEST = 0.05               # overlap of the bodies that are tried, and their largest gap [m]
CLEAR = 0.02                 # by which the axis along which two boxes touch must be the best one [m]
SIGNS = np.array(list(product((-1.0, 1.0), repeat=3)))
AROUND = np.array([(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)])          # corners of a box over its half sizes


# ---------------------------------------------------------------------------------------------- boxes in space

def corners_of(x, R, half):
    """Return the corners (8, 3) of a box."""
    return x + (SIGNS * half) @ R.T


def gaps_along_axes(a, b):
    """Return (axes (15, 3), gaps (15,) [m]) of two boxes (x, R, half): of their corners along all directions in which
    boxes can be separated.  Parallel edges have the gap −∞.
    """
    crossed = np.cross(a[1].T[:, None], b[1].T).reshape(9, 3)
    size = np.linalg.norm(crossed, axis=1)
    axes = np.concatenate((a[1].T, b[1].T, crossed / np.maximum(size, 1e-300)[:, None]))
    of_a, of_b = corners_of(*a) @ axes.T, corners_of(*b) @ axes.T
    gaps = np.maximum(np.min(of_b, axis=0) - np.max(of_a, axis=0), np.min(of_a, axis=0) - np.max(of_b, axis=0))
    return axes, np.where(np.append(np.ones(6), size) > 0.05, gaps, -np.inf)


def touching_boxes(rng, kind):
    """Return two boxes and the axis along which they touch: 0 to 2 a face of the first, 3 to 5 of the second, 6 to 14
    two edges.  `kind` is that number over 3, from 0 to 2; 2 means any pair of edges.

    The second box is moved along a random line until its gap is as asked for.
    """
    while True:
        half, R = rng.uniform(0.3, 1.0, (2, 3)), [matrix_of(q) for q in random_quaternions(rng, 2)]
        way, gap = rng.normal(size=3), rng.uniform(-DEEPEST, DEEPEST)
        near, far = 0.0, 6.0
        place = lambda s, way=way: s * way / np.linalg.norm(way)
        for _ in range(14):                                                  # to 0.4 mm
            middle = 0.5 * (near + far)
            wide = np.max(gaps_along_axes((np.zeros(3), R[0], half[0]), (place(middle), R[1], half[1]))[1]) > gap
            near, far = (near, middle) if wide else (middle, far)
        move = rng.normal(size=3)
        a, b = (move, R[0], half[0]), (move + place(far), R[1], half[1])
        gaps = gaps_along_axes(a, b)[1]
        best = int(np.argmax(gaps))
        if min(best // 3, 2) == kind and np.partition(gaps, -2)[-2] < gaps[best] - CLEAR:
            return a, b, best


def polygon_in_rectangle(corners, wide):
    """Return the corners (k, 2) of what a convex quadrilateral and the rectangle |y| ≤ wide have in common.

    They are all crossings of two of the eight lines that lie inside all of them.
    """
    ahead = np.roll(corners, -1, axis=0) - corners
    turn = np.sign(ahead[0, 0] * ahead[1, 1] - ahead[0, 1] * ahead[1, 0])
    normals = np.concatenate((turn * np.stack((ahead[:, 1], -ahead[:, 0]), axis=1), np.eye(2), -np.eye(2)))
    offsets = np.append(np.sum(normals[:4] * corners, axis=1), [*wide, *wide])
    found = []
    for i, j in combinations(range(8), 2):
        pair = normals[[i, j]]
        if abs(np.linalg.det(pair)) > 1e-9:
            y = np.linalg.solve(pair, offsets[[i, j]])
            found += [y] if np.all(normals @ y <= offsets + 1e-9) else []
    return np.array(found).reshape(-1, 2)


def contacts_with_face(face, other, k, sign):
    """Return rows (normal, place, gap) of the face of a box across its axis k that looks at another box.

    The corners are those of the part of the other's nearest face that lies over it, each halfway to its own distance
    from the face.  sign: 1 if the normal points out of the face.
    """
    (x, R, half), (place, turn, size) = face, other
    n = R[:, k] * np.sign(R[:, k] @ (place - x))
    faced = int(np.argmax(np.abs(turn.T @ n)))
    out = -turn[:, faced] * np.sign(turn[:, faced] @ n)
    across = [turn[:, e] * size[e] for e in range(3) if e != faced]
    middle = place + size[faced] * out
    corners = np.array([middle + s * across[0] + t * across[1] for s, t in ((1, 1), (-1, 1), (-1, -1), (1, -1))])
    plane = [e for e in range(3) if e != k]
    rows = []
    for y in polygon_in_rectangle((corners - x) @ R[:, plane], half[plane]):
        foot = x + R[:, plane] @ y + half[k] * n
        gap = ((middle - foot) @ out) / (n @ out)                            # from the face to the other one, along n
        rows += [(*(sign * n), *(foot + 0.5 * gap * n), gap)] if gap <= REACH else []
    return rows


def contact_of_edges(a, b, e, f, gap):
    """Return the row (normal, place, gap) of the edges along axis e of box a and f of b that are nearest."""
    u, w = a[1][:, e], b[1][:, f]
    n = np.cross(u, w) / np.linalg.norm(np.cross(u, w))
    n = n if n @ (a[0] - b[0]) > 0.0 else -n                                 # from b to a
    ends = [corners_of(*box)[np.argsort(corners_of(*box) @ (sign * n))[-2:]] for box, sign in ((a, -1.0), (b, 1.0))]
    s, t = np.linalg.lstsq(np.stack((u, -w), axis=1), ends[1][0] - ends[0][0], rcond=None)[0]
    return [(*n, *(0.5 * (ends[0][0] + s * u + ends[1][0] + t * w)), gap)]


def contacts_of_boxes(a, b, k):
    """Return rows (normal, place, gap) of two boxes that touch along axis k."""
    if k < 3:
        return contacts_with_face(a, b, k, -1.0)
    if k < 6:
        return contacts_with_face(b, a, k - 3, 1.0)
    return contact_of_edges(a, b, (k - 6) // 3, (k - 6) % 3, gaps_along_axes(a, b)[1][k])


def quaternion_of(R):
    """Return a unit quaternion of a rotation (3, 3): the eigenvector of K with the eigenvalue 1.

    *Source:* Bar-Itzhack 2000.
    """
    K = np.zeros((4, 4))
    K[0, 1:] = K[1:, 0] = (R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1])
    K[1:, 1:], K[0, 0] = R + R.T - np.trace(R) * np.eye(3), np.trace(R)
    return np.linalg.eigh(K / 3.0)[1][:, -1]


def each_with_each(lesson, n, planes):
    """Return the Pairs of n bodies with each other and with all planes."""
    partners = [np.arange(i + 1, n + planes) for i in range(n)]
    return lesson.Pairs(np.cumsum([0, *map(len, partners)]), np.concatenate(partners))


def rows_found(lesson, boxes, planes=()):
    """Return rows (a, b, normal, place, gap) that box_contacts finds of boxes and planes, each with each."""
    x, half = np.array([box[0] for box in boxes]), np.array([box[2] for box in boxes])
    _, _, turn = lesson.box_bounds(x, np.array([quaternion_of(box[1]) for box in boxes]), half)
    n, planes = len(boxes), np.reshape(planes, (-1, 4))
    c = lesson.box_contacts(np.concatenate((x, np.zeros((len(planes), 3)))), turn, half, planes,
                            each_with_each(lesson, n, len(planes)), REACH)
    assert c.first[-1] == len(c.a)
    return np.column_stack((c.a, c.b, c.n, c.p, c.gap))


def touch(lesson, boxes, axis):
    """Return (got, truth) of two boxes that touch along this axis."""
    truth = [(0.0, 1.0, *row) for row in contacts_of_boxes(*boxes, axis)]
    return unlike(rows_found(lesson, boxes), truth), (len(truth), 0.0)


@random_law("A face of the first box has contacts with the part of the second one that lies over it.",
            "face of the first box: largest error of the contacts [-, m]", EXACT)
def face_of_the_first(lesson, rng):
    a, b, axis = touching_boxes(rng, 0)
    return touch(lesson, (a, b), axis)


@random_law("A face of the second box has contacts with the part of the first one that lies over it.",
            "face of the second box: largest error of the contacts [-, m]", EXACT)
def face_of_the_second(lesson, rng):
    a, b, axis = touching_boxes(rng, 1)
    return touch(lesson, (a, b), axis)


@random_law("Two edges touch halfway between the nearest points of their lines.",
            "two edges: largest error of the contact [-, m]", EXACT)
def two_edges(lesson, rng):
    a, b, axis = touching_boxes(rng, 2)
    return touch(lesson, (a, b), axis)


@random_law("Faces that lie on each other touch in all corners of what they have in common; the normal is that of the "
            "first.", "face on face: largest error of the contacts [-, m]", EXACT)
def face_on_face(lesson, rng):
    """Lay a face of one box on a face of another, turned and shifted so that both stick out."""
    (k, f), half = rng.integers(3, size=2), rng.uniform(0.5, 0.8, (2, 3))
    turn, side = rng.uniform(0.1, 1.4), rng.choice((-1.0, 1.0))
    R = matrix_of(random_quaternions(rng, 1)[0])
    n, u, w = (R[:, (k + e) % 3] for e in range(3))
    c, s = np.cos(turn), np.sin(turn)
    axes = dict(zip(((f + e) % 3 for e in range(3)), (n, c * u + s * w, c * w - s * u), strict=True))
    gap, move, shift = rng.uniform(-DEEPEST, DEEPEST), rng.normal(size=3), rng.uniform(-0.5, 0.5, 2)
    place = move + side * (half[0][k] + half[1][f] + gap) * n + shift[0] * u + shift[1] * w
    return touch(lesson, ((move, R, half[0]), (place, np.stack([axes[e] for e in range(3)], axis=1), half[1])), k)


@random_law("A box touches a plane with the corners that reach it, and fills the box along the axes around it.",
            "box on a plane: largest error of the contacts and bounds [-, m]", EXACT)
def box_on_a_plane(lesson, rng):
    q, half, (x, n) = random_quaternions(rng, 1)[0], rng.uniform(0.3, 1.0, 3), rng.normal(size=(2, 3))
    n, R = n / np.linalg.norm(n), matrix_of(q)
    corners = corners_of(x, R, half)
    offset = rng.uniform(-0.4, DEEPEST) - np.min(corners @ n)
    gaps = corners @ n + offset
    truth = [(0.0, 1.0, *n, *(p - 0.5 * gap * n), gap) for p, gap in zip(corners, gaps, strict=True) if gap <= REACH]
    low, high, turn = lesson.box_bounds(x[None], q[None], half[None])
    found = rows_found(lesson, [(x, R, half)], [(*n, offset)])
    return ((*unlike(found, truth), low, high, turn),
            (len(truth), 0.0, np.min(corners, axis=0), np.max(corners, axis=0), R))


@random_law("Boxes that an axis separates by more than the margin have no contact.",
            "boxes apart: contacts that are found [-]", 0.0)
def boxes_apart(lesson, rng):
    a, b, axis = touching_boxes(rng, rng.integers(3))
    axes, gaps = gaps_along_axes(a, b)
    n = axes[axis] * np.sign(axes[axis] @ (b[0] - a[0]))
    beyond = (b[0] + (REACH - gaps[axis] + 1e-6) * n, *b[1:])
    return float(len(rows_found(lesson, (a, beyond)))), 0.0


# ---------------------------------------------------------------------------------------------- convex shapes, plane

def regular(rng, corners):
    """Return the corners (k, 2) [m] of a convex polygon on a circle, counter-clockwise."""
    angles = 2.0 * np.pi * (np.arange(corners) + rng.uniform(-0.2, 0.2, corners)) / corners
    return rng.uniform(0.5, 1.0) * np.stack((np.cos(angles), np.sin(angles)), axis=1)


def cores_of(shapes):
    """Return the Cores of shapes (corners, radius)."""
    return Cores(np.concatenate([corners for corners, _ in shapes]), np.cumsum([0, *(len(c) for c, _ in shapes)]),
                 np.array([radius for _, radius in shapes]), np.ones((len(shapes), 2)))


def convex_rows(lesson, shapes, x, q, lines=()):
    """Return rows (a, b, normal, place, gap) that convex_contacts_2d finds of shapes and lines, each with each."""
    cores, n, lines = cores_of(shapes), len(shapes), np.reshape(lines, (-1, 3))
    _, _, turn = convex_bounds_2d(x, q, cores)
    c = convex_contacts_2d(np.concatenate((x, np.zeros((len(lines), 2)))), turn, cores, lines,
                           each_with_each(lesson, n, len(lines)), REACH)
    return np.column_stack((c.a, c.b, c.n, c.p, c.gap))


def rotated(q, r):
    """Return r (k, 2) turned by the angle q."""
    c, s = np.cos(q), np.sin(q)
    return r @ np.array([(c, s), (-s, c)])


def sides_of(corners):
    """Return (outward normals (k, 2), offsets (k,)) of the edges of a polygon."""
    ahead = np.roll(corners, -1, axis=0) - corners
    n = np.stack((ahead[:, 1], -ahead[:, 0]), axis=1) / np.linalg.norm(ahead, axis=1)[:, None]
    return n, np.sum(n * corners, axis=1)


def nearest_of_cores(a, b):
    """Return (p of a, q of b), the nearest points of two polygons that are apart: all corners with all edges."""
    pairs = []
    for points, edges, swapped in ((a, b, False), (b, a, True)):
        for point in points:
            for p, r in zip(edges, np.roll(edges, -1, axis=0), strict=True):
                along = (r - p) @ (r - p)
                foot = p + np.clip((point - p) @ (r - p) / along if along > 0.0 else 0.0, 0.0, 1.0) * (r - p)
                pairs.append((np.linalg.norm(foot - point), *((foot, point) if swapped else (point, foot))))
    _, p, q = min(pairs, key=lambda pair: pair[0])
    return p, q


@random_law("Convex shapes that are apart touch between the nearest points of their cores, each with its radius.",
            "shapes apart: largest error of the contact [-, m]", EXACT)
def convex_apart(lesson, rng):
    """Try polygons, capsules and discs whose edges do not face each other."""
    kinds = [lambda: regular(rng, 5), lambda: regular(rng, 3), lambda: np.array([(0.4, 0.0), (-0.4, 0.0)]),
             lambda: np.zeros((1, 2))]
    while True:
        shapes = [(kinds[k](), radius) for k, radius in zip(rng.integers(4, size=2), rng.uniform(0.1, 0.3, 2))]
        q, way, move = rng.uniform(0.0, 6.28, 2), rng.normal(size=2), rng.normal(size=2)
        a, b = (rotated(angle, core) for angle, (core, _) in zip(q, shapes, strict=True))
        way, both = way / np.linalg.norm(way), shapes[0][1] + shapes[1][1]
        x = np.array([move, move + (2.2 + both) * way])
        p, r = nearest_of_cores(a + x[0], b + x[1])
        x[1] -= (np.linalg.norm(r - p) - both - rng.uniform(-DEEPEST, DEEPEST)) * (r - p) / np.linalg.norm(r - p)
        p, r = nearest_of_cores(a + x[0], b + x[1])
        n = (r - p) / np.linalg.norm(r - p)
        facing = [np.max(sides_of(core)[0] @ d) for core, d in ((a, n), (b, -n)) if len(core) > 1]
        if len(facing) < 2 or max(facing) < 0.99:
            gap = np.linalg.norm(r - p) - both
            truth = [(0.0, 1.0, *-n, *(p + (shapes[0][1] + 0.5 * gap) * n), gap)]
            return unlike(convex_rows(lesson, shapes, x, q), truth), (1, 0.0)


@random_law("An edge that lies along an edge touches it at both ends of what they have in common.",
            "edge along edge: largest error of the contacts [-, m]", EXACT)
def edge_along_edge(lesson, rng):
    """Lay two rounded boxes along each other, one shifted; two overlap, or are a little apart."""
    half, radius = rng.uniform(0.3, 0.8, (2, 2)), rng.uniform(0.0, 0.2, 2)
    signs = np.array([(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)])
    gap, q, move = rng.uniform(-DEEPEST, DEEPEST), rng.uniform(0.0, 6.28), rng.normal(size=2)
    shift = rng.uniform(-0.9, 0.9) * np.sum(half[:, 0])
    up = half[0, 1] + half[1, 1] + np.sum(radius) + gap
    x = np.array([move, move + rotated(q, np.array([shift, up]))])
    ends = max(-half[0, 0], shift - half[1, 0]), min(half[0, 0], shift + half[1, 0])
    n, places = rotated(q, np.array([0.0, 1.0])), [(s, half[0, 1] + radius[0] + 0.5 * gap) for s in ends]
    truth = [(0.0, 1.0, *-n, *(move + rotated(q, np.array(place))), gap) for place in places]
    found = convex_rows(lesson, [(signs * h, r) for h, r in zip(half, radius, strict=True)], x, np.array([q, q]))
    return unlike(found, truth), (2, 0.0)


@random_law("Polygons that overlap touch along the edge that separates them best; boxes touch as boxes.",
            "polygons that overlap: largest error of the contacts [-, m]", EXACT)
def convex_overlap(lesson, rng):
    shapes, x, q, truth = overlapping_pair(rng, lambda: [regular(rng, k) for k in rng.integers(3, 7, 2)])
    return unlike(convex_rows(lesson, [(core, 0.0) for core in shapes], x, q), truth), (len(truth), 0.0)


@random_law("Boxes in the plane that overlap touch as polygons do.",
            "boxes in the plane: largest error of the contacts [-, m]", EXACT)
def boxes_in_the_plane(lesson, rng):
    shapes, x, q, truth = overlapping_pair(rng, lambda: rng.uniform(0.2, 1.0, (2, 1, 2)) * AROUND)
    half = np.array([core[0] for core in shapes])
    _, _, turn = lesson.box_bounds_2d(x, q, half)
    c = lesson.box_contacts_2d(x, turn, half, np.zeros((0, 3)), each_with_each(lesson, 2, 0), REACH)
    return unlike(np.column_stack((c.a, c.b, c.n, c.p, c.gap)), truth), (len(truth), 0.0)


def overlapping_pair(rng, draw):
    """Return (corners of two polygons, places, angles, rows of their contacts); `draw` makes the corners.

    The edge that separates them best is better than all others by a centimetre.
    """
    while True:
        shapes, q = draw(), rng.uniform(0.0, 6.28, 2)
        x = rng.normal(size=2) + np.array([(0.0, 0.0), rotated(rng.uniform(0.0, 6.28),
                                                               np.array([rng.uniform(0.8, 1.5), 0.0]))])
        a, b = (rotated(angle, core) + place for angle, core, place in zip(q, shapes, x, strict=True))
        best = [np.min(n @ other.T, axis=1) - offset for (n, offset), other in ((sides_of(a), b), (sides_of(b), a))]
        gaps = np.concatenate(best)
        gap, second = np.sort(gaps)[:-3:-1]
        if -0.2 < gap < -0.01 and second < gap - 0.01:
            one, other, sign = (a, b, -1.0) if np.argmax(gaps) < len(a) else (b, a, 1.0)
            truth = overlapping(one, other, int(np.argmax(gaps)) % len(a) if sign < 0 else int(np.argmax(best[1])),
                                sign)
            return shapes, x, q, truth


def overlapping(one, other, edge, sign):
    """Return rows of an edge of one polygon with the nearest edge of another: its part that lies over the edge."""
    n, offsets = sides_of(one)
    facing = int(np.argmin(sides_of(other)[0] @ n[edge]))
    p, r = other[facing], other[(facing + 1) % len(other)]
    along = np.roll(one, -1, axis=0)[edge] - one[edge]
    shares = np.sort([(corner - p) @ along / ((r - p) @ along) for corner in (one[edge], one[edge] + along)])
    low, high = max(0.0, shares[0]), min(1.0, shares[1])
    places = [p + share * (r - p) for share in (low, high)] if low <= high else []
    rows = [(place, n[edge] @ place - offsets[edge]) for place in places]
    return [(0.0, 1.0, *(sign * n[edge]), *(place - 0.5 * gap * n[edge]), gap) for place, gap in rows if gap <= REACH]


@random_law("The edge of a polygon along a direction is the one whose normal has the largest cosine with it.",
            "edge along a direction: largest error of its number and cosine [-]", EXACT)
def edges_along(lesson, rng):
    """Try a pentagon among the corners of other shapes."""
    core, q = regular(rng, 5), rng.uniform(0.0, 6.28)
    cosines = sides_of(core)[0] @ (np.cos(q), np.sin(q))
    return (edge_along(np.concatenate((rng.normal(size=(3, 2)), core, rng.normal(size=(2, 2)))), 3, 8, np.cos(q),
                       np.sin(q)), (3 + np.argmax(cosines), np.max(cosines)))


@random_law("Of two edges that separate almost alike, that of the first shape counts, unless the other is better by a "
            "thousandth of the depth.", "edges that separate alike: largest error of the contacts [-, m]", EXACT)
def edges_alike(lesson, rng):
    """Sink a wide shape into a narrower one and tilt it, so that its edge is better by half of that or by twice that.

    A tilt by α lowers a corner of the wide edge by half its width times sin α, and brings a corner of the narrow one
    nearer to the wide edge by less.
    """
    half, radius, sunk = rng.uniform((0.2, 0.5), (0.4, 0.9), (2, 2)), rng.uniform(0.0, 0.1, 2), rng.uniform(0.05, 0.1)
    half[1, 0] += 0.3
    alike, tilt = rng.choice((0.5, 2.0)), rng.choice((-1.0, 1.0))
    tilt *= 1e-3 * alike * (np.sum(radius) + sunk) / (half[1, 0] - half[0, 0])
    q, move = rng.uniform(0.0, 6.28) + np.array([0.0, tilt]), rng.normal(size=2)
    middle = np.array([0.0, half[0, 1] - sunk]) + rotated(tilt, np.array([0.0, half[1, 1]]))
    x = np.array([move, move + rotated(q[0], middle)])
    a, b = (rotated(angle, AROUND * size) + place for angle, size, place in zip(q, half, x, strict=True))
    truth = np.array(overlapping(a, b, 0, -1.0) if alike < 1.0 else overlapping(b, a, 2, 1.0))
    truth[:, 4:6] -= 0.5 * (radius[0] - radius[1]) * truth[:, 2:4]           # from the cores to the surfaces
    truth[:, 6] -= np.sum(radius)
    found = convex_rows(lesson, [(AROUND * size, r) for size, r in zip(half, radius, strict=True)], x, q)
    return unlike(found, truth), (2, 0.0)


@random_law("A convex shape touches a line with each corner that reaches it, and its bounds are those of its corners.",
            "shape on a line: largest error of the contacts and bounds [-, m]", EXACT)
def convex_on_a_line(lesson, rng):
    core, radius, q, x = regular(rng, 5), rng.choice((0.0, 0.2)), rng.uniform(0.0, 6.28), rng.normal(size=2)
    n, corners = rotated(rng.uniform(0.0, 6.28), np.array([0.0, 1.0])), rotated(q, core) + x
    offset = rng.uniform(-0.3, DEEPEST) - np.min(corners @ n) + radius
    gaps = corners @ n + offset - radius
    truth = [(0.0, 1.0, *n, *(p - (radius + 0.5 * gap) * n), gap) for p, gap in zip(corners, gaps, strict=True)
             if gap <= REACH]
    low, high, _ = convex_bounds_2d(x[None], np.array([q]), cores_of([(core, radius)]))
    found = convex_rows(lesson, [(core, radius)], x[None], np.array([q]), [(*n, offset)])
    return ((*unlike(found, truth), low, high),
            (len(truth), 0.0, np.min(corners, axis=0) - radius, np.max(corners, axis=0) + radius))


@random_law("Several convex shapes touch a line with all of their corners that reach it.",
            "shapes on a line: largest error of the contacts [-, m]", EXACT)
def small_shapes_on_a_line(lesson, rng):
    """Put small polygons of eight to ten corners so near to a line that each corner has a contact."""
    cores = [0.02 * regular(rng, corners) for corners in rng.permutation((8, 9, 10))]
    x, q = np.stack((3.0 * np.arange(3), rng.uniform(0.0, 0.02, 3)), axis=1), rng.uniform(0.0, 6.28, 3)
    places = [rotated(angle, core) + place for angle, core, place in zip(q, cores, x, strict=True)]
    truth = [(i, 3.0, 0.0, 1.0, p[0], 0.5 * p[1], p[1]) for i, corners in enumerate(places) for p in corners]
    return unlike(convex_rows(lesson, [(core, 0.0) for core in cores], x, q, [(0.0, 1.0, 0.0)]), truth), (27, 0.0)


@case("contact-points", "Contact points of boxes and of convex shapes", compiled=False)
def contact_points(lesson, check):
    """Compare contacts with those that come from trying all corners, edges and planes.

    Boxes in space touch in every way: faces of either box with a corner, an edge or a face; two edges; a plane.  Of all
    directions in which two boxes can be separated, the contact is along the one with the largest gap.  Shapes in the
    plane are boxes, polygons, capsules and discs, alone and with a radius.
    """
    check.laws(lesson, (face_of_the_first, face_of_the_second, two_edges, face_on_face, box_on_a_plane, boxes_apart,
                        convex_apart, edge_along_edge, convex_overlap, convex_on_a_line, boxes_in_the_plane,
                        edges_alike, edges_along, small_shapes_on_a_line), seed=31, times=15)


# ---------------------------------------------------------------------------------------------- a step of a pile

@random_law("A body that sticks out of its margin, up or sideways, makes the pairs be searched again.",
            "margin: wrong answers [-]", 0.0)
def leaves_its_margin(lesson, rng):
    d, found, truth = rng.choice((2, 3)), [], []
    wide_low = rng.normal(size=(3, d))
    wide_high = wide_low + rng.uniform(0.5, 1.0, (3, d))
    for body, e, side in product(range(3), range(d), (-1.0, 1.0)):
        low, high = wide_low + 0.1, wide_high - 0.1
        move = side * rng.choice((0.09, 0.11))
        low[body, e], high[body, e] = low[body, e] + move, high[body, e] + move
        found.append(lesson.has_left_margin(low, high, wide_low, wide_high))
        truth.append(abs(move) > 0.1)
    return np.array(found, float), np.array(truth, float)


def alone(lesson, rng, substeps):
    """Return (PileState, Pile) of a box in flight that tumbles, with three moments of inertia."""
    moments = rng.uniform(1.0, 1.9, 3)
    state, pile = lesson.make_pile(rng.normal(size=(1, 3)), random_quaternions(rng, 1), rng.uniform(0.5, 2.0),
                                   [moments], rng.uniform(0.1, 0.3, (1, 3)), [(0.0, 0.0, 1.0, 50.0)],
                                   rng.normal(size=3), 0.5, substeps, 30.0, 1.0, 0.05)
    v, omega = rng.normal(size=(2, 2, 3)) * np.array([(1.0,), (0.0,)])
    return state._replace(v=v, omega=omega), pile, moments


@random_law("A box of a pile tumbles in flight by Euler's equation, with the tensor of the beginning of each substep.",
            "box in flight: largest error of its state [m, -, m/s, rad/s]", EXACT)
def tumbling_flight(lesson, rng):
    substeps, dt = 3, rng.uniform(0.01, 0.03)
    state, pile, moments = alone(lesson, rng, substeps)
    end = lesson.pile_trajectory(lesson.advance_pile, lesson.box_bounds, lesson.box_contacts, state, dt, 2, pile)[2]
    x, R, v, omega, h = state.x[0], matrix_of(state.q[0]), state.v[0], state.omega[0], dt / substeps
    for _ in range(2 * substeps):
        I = R @ np.diag(moments) @ R.T
        v = v + h * pile.gravity
        omega = omega - h * np.linalg.solve(I, np.cross(omega, I @ omega))
        x, R = x + h * v, turned_by(omega, h) @ R
    return ((end.x[0], matrix_of(end.q[0]), end.v[0], end.omega[0], end.x[1], end.q[1]),
            (x, R, v, omega, np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0])))


@random_law("What begins deep inside another body parts with 3 % of the smaller half size times hertz, less what the "
            "contact gives.", "deep overlap: largest error of the speed of separation [m/s]", EXACT)
def separation(lesson, rng):
    """Put two discs or balls into each other without gravity: half sizes, masses and hertz are random.

    A contact gives by 1/(s (2ζ + s)) of its speed, s = 2π hertz h.  One sweep per substep reaches the target of a
    single contact, and the sweep at rest takes back both the velocity and the impulse.
    """
    d, radius, m = rng.choice((2, 3)), rng.uniform(0.2, 0.5, 2), rng.uniform(0.5, 2.0, 2)
    hertz, dt, n = rng.uniform(10.0, 30.0), 0.004, rng.normal(size=d)
    n /= np.linalg.norm(n)
    make, advance = (lesson.make_pile_2d, lesson.advance_pile_2d) if d == 2 else (lesson.make_pile, lesson.advance_pile)
    q = np.zeros(2) if d == 2 else [(1.0, 0.0, 0.0, 0.0)] * 2
    state, pile = make([np.zeros(d), 0.3 * np.min(radius) * n], q, m, 0.1 if d == 2 else np.full((2, 3), 0.1),
                       np.repeat(radius[:, None], d, axis=1), [(*-np.eye(d)[0], 50.0)], np.zeros(d), 0.3, 2, hertz,
                       1.0, 0.01)
    bounds = lesson.disc_bounds if d == 2 else lesson.ball_bounds
    end = advance(bounds, lesson.round_contacts, state, dt, 1, pile)
    s = 2.0 * np.pi * hertz * 0.5 * dt
    return ((end.x[1] - end.x[0] - 0.3 * np.min(radius) * n) @ n / dt,
            0.03 * np.min(radius) * hertz / (1.0 + 1.0 / (s * (2.0 + s))))


@random_law("Of many pairs that begin deep inside each other each one parts with its own speed.",
            "deep pairs: largest error of the speeds of separation [m/s]", EXACT)
def separations(lesson, rng):
    """Put balls of many sizes into each other by 30 %, two and two, in space: see `separation`."""
    radius, m, hertz, dt = rng.uniform(0.2, 0.5, (9, 2)), rng.uniform(0.5, 2.0, (9, 2)), rng.uniform(10.0, 30.0), 0.004
    n, least = rng.normal(size=(9, 3)), np.min(radius, axis=1)
    n /= np.linalg.norm(n, axis=1)[:, None]
    x = np.stack((np.outer(5.0 * np.arange(9), (1.0, 0.0, 0.0)),) * 2, axis=1)
    x[:, 1] += 0.3 * least[:, None] * n
    state, pile = lesson.make_pile(x.reshape(18, 3), [(1.0, 0.0, 0.0, 0.0)] * 18, m.ravel(), np.full((18, 3), 0.1),
                                   np.repeat(radius.reshape(18, 1), 3, axis=1), [(0.0, 0.0, 1.0, 50.0)], np.zeros(3),
                                   0.3, 2, hertz, 1.0, 0.01)
    end = lesson.advance_pile(lesson.ball_bounds, lesson.round_contacts, state, dt, 1, pile).x[:18].reshape(9, 2, 3)
    s = 2.0 * np.pi * hertz * 0.5 * dt
    return (np.sum((end[:, 1] - end[:, 0]) * n, axis=1) / dt - 0.3 * least / dt,
            0.03 * least * hertz / (1.0 + 1.0 / (s * (2.0 + s))))


@random_law("A step changes momentum and angular momentum of two boxes by gravity and by the impulses that it returns.",
            "impulses of a step in space: largest error of the velocities [m/s, rad/s]", EXACT)
def balance_in_space(lesson, rng):
    """Two boxes with three moments each touch and approach, in one substep, where arms and tensors are those before."""
    boxes, dt = touching_boxes(rng, rng.integers(3))[:2], 0.004
    x, half = (np.array([box[k] for box in boxes]) for k in (0, 2))
    m, moments = rng.uniform(0.5, 2.0, 2), rng.uniform(0.05, 0.09, (2, 3))
    state, pile = lesson.make_pile(x, [quaternion_of(R) for _, R, _ in boxes], m, moments, half,
                                   [(0.0, 0.0, 1.0, 50.0)], rng.normal(size=3), rng.uniform(0.2, 0.8), 1, 30.0, 1.0,
                                   2.0 * REACH)
    v, omega = np.zeros((3, 3)), np.append(rng.normal(size=(2, 3)), np.zeros((1, 3)), axis=0)
    v[:2] = rng.normal(size=(2, 3)) + 30.0 * (x[::-1] - x)
    end = lesson.advance_pile(lesson.box_bounds, lesson.box_contacts, state._replace(v=v, omega=omega), dt, 1, pile)
    v_new, omega_new = v + dt * np.append(np.tile(pile.gravity, (2, 1)), np.zeros((1, 3)), axis=0), omega.copy()
    for i, (place, R, _) in enumerate(boxes):
        I = R @ np.diag(moments[i]) @ R.T
        J = end.J * (1.0 * (end.contacts.a == i) - 1.0 * (end.contacts.b == i))[:, None]
        v_new[i] += np.sum(J, axis=0) / m[i]
        turning = np.sum(np.cross(end.contacts.p - place, J), axis=0) - dt * np.cross(omega[i], I @ omega[i])
        omega_new[i] += np.linalg.solve(I, turning)
    assert np.max(np.abs(end.J)) > 1e-2
    return (end.v, end.omega), (v_new, omega_new)


@random_law("At each contact of a box that slides, friction is μ J_n.",
            "a box that slides in space: largest |J_t| − μ J_n [N s]", EXACT)
def friction_in_space(lesson, rng):
    mu, half = rng.uniform(0.2, 0.8), np.append(rng.uniform(0.3, 0.5, 2), 0.1)
    state, pile = lesson.make_pile([(0.0, 0.0, half[2])], [(1.0, 0.0, 0.0, 0.0)], 1.0, [np.ones(3)], [half],
                                   [(0.0, 0.0, 1.0, 0.0)], (0.0, 0.0, -9.81), mu, 4, 60.0, 10.0, 0.01)
    v = np.append(rng.normal(size=2), 0.0)
    v = np.stack((5.0 * v / np.linalg.norm(v), np.zeros(3)))
    J = lesson.advance_pile(lesson.box_bounds, lesson.box_contacts, state._replace(v=v), 0.004, 5, pile).J
    assert len(J) == 4 and np.sum(J[:, 2]) > 1e-3
    return np.linalg.norm(J[:, :2], axis=1), mu * J[:, 2]


@random_law("Contacts of bodies that pass each other are found at the places of the beginning of a step.",
            "bodies that pass each other: largest error of the gap and the normal [m, -]", EXACT)
def passing_bodies(lesson, rng):
    """Without gravity, by more than 1/500 of their size in each step.  Gaps that follow velocities err by 1e-5 m."""
    d, steps, dt = rng.choice((2, 3)), rng.integers(2, 6), 0.004
    make, advance = (lesson.make_pile_2d, lesson.advance_pile_2d) if d == 2 else (lesson.make_pile, lesson.advance_pile)
    radius, q = rng.uniform(0.2, 0.4, 2), np.zeros(2) if d == 2 else [(1.0, 0.0, 0.0, 0.0)] * 2
    n, along = np.linalg.qr(rng.normal(size=(d, 2)))[0].T
    x = np.stack(((np.sum(radius) + 0.01) * n, np.zeros(d)))
    state, pile = make(x, q, 1.0, 0.1 if d == 2 else np.full((2, 3), 0.1), np.repeat(radius[:, None], d, axis=1),
                       [(*-np.eye(d)[0], 50.0)], np.zeros(d), 0.3, 2, 30.0, 1.0, 0.1)
    v = np.stack((rng.uniform(0.5, 1.0) * along, np.zeros(d), np.zeros(d)))
    bounds = lesson.disc_bounds if d == 2 else lesson.ball_bounds
    found = advance(bounds, lesson.round_contacts, state._replace(v=v), dt, steps, pile).contacts
    way = x[0] + (steps - 1) * dt * v[0]
    return (found.gap, found.n[0]), (np.linalg.norm(way) - np.sum(radius), way / np.linalg.norm(way))


@random_law("Bodies that meet stop where they touch, wherever they come from.",
            "bodies that meet: largest error of their distance [m]", TOUCHING)
def meeting_bodies(lesson, rng):
    """They begin outside each other's widened boxes, just so far apart that both are inside their own when they touch.

    A search that comes too late finds them inside each other, by up to the way of a step.
    """
    d, dt, margin, speed = rng.choice((2, 3)), 1.0 / 240.0, 0.008, rng.uniform(0.2, 0.45)
    make, advance = (lesson.make_pile_2d, lesson.advance_pile_2d) if d == 2 else (lesson.make_pile, lesson.advance_pile)
    radius, along = rng.uniform(0.1, 0.2, 2), rng.choice((-1.0, 1.0)) * np.eye(d)[rng.choice(d)]
    apart = 2.0 * (margin + AHEAD * dt * speed) * rng.uniform(1.0, 1.05)
    x, q = (np.stack((np.zeros(d), (np.sum(radius) + apart) * along)),
            np.zeros(2) if d == 2 else [(1.0, 0.0, 0.0, 0.0)] * 2)
    state, pile = make(x, q, 1.0, 0.1 if d == 2 else np.full((2, 3), 0.1), np.repeat(radius[:, None], d, axis=1),
                       [(*np.eye(d)[0], 50.0)], np.zeros(d), 0.3, 4, 120.0, 10.0, margin)
    v = np.stack((speed * along, -speed * along, np.zeros(d)))
    bounds = lesson.disc_bounds if d == 2 else lesson.ball_bounds
    steps = int(0.5 * apart / speed / dt) + 1
    end = advance(bounds, lesson.round_contacts, state._replace(v=v), dt, steps, pile)
    return np.linalg.norm(end.x[1] - end.x[0]), np.sum(radius)


@random_law("Only gravity acts on a body whose contacts are gone.",
            "contacts that are gone: largest error of the velocities [m/s, rad/s]", EXACT)
def gone_contacts(lesson, rng):
    """In the first step a small box slides over the edge of a large one.  No pairs are searched before the second."""
    d, dt, g = rng.choice((2, 3)), 0.004, rng.uniform(5.0, 15.0)
    make, advance, shape = (
        (lesson.make_pile_2d, lesson.advance_pile_2d, (lesson.box_bounds_2d, lesson.box_contacts_2d)) if d == 2 else
        (lesson.make_pile, lesson.advance_pile, (lesson.box_bounds, lesson.box_contacts)))
    x, v, up = np.zeros((2, d)), np.zeros((3, d)), np.eye(d)[-1]
    x[0], x[1], v[1, 0] = 0.3 * up, 0.349 * np.eye(d)[0] + 0.65 * up, rng.uniform(2.8, 3.4)
    q, inertia = (np.zeros(2), 0.1) if d == 2 else ([(1.0, 0.0, 0.0, 0.0)] * 2, np.full((2, 3), 0.1))
    state, pile = make(x, q, 1.0, inertia, [np.full(d, 0.3), np.full(d, 0.05)], [(*up, 0.0)], -g * up,
                       rng.uniform(0.0, 0.5), 2, 30.0, 1.0, 0.02)
    first, second = (advance(*shape, state._replace(v=v), dt, steps, pile) for steps in (1, 2))
    assert np.any(first.contacts.b == 1) and not np.any(second.contacts.b == 1)
    return (second.v[1], second.omega[1]), (first.v[1] - dt * g * up, first.omega[1])


@random_law("A contact that is gone has no impulse, and is far from all places; others stay as they are.",
            "marked contacts: largest error of impulses, gaps and places [N s, m]", 0.0)
def marked_contacts(lesson, rng):
    """Mark three of six contacts."""
    d, left = rng.choice((2, 3)), rng.permutation(6)[:3]
    (J, p, n), gap, none = rng.normal(size=(3, 6, d)), rng.normal(size=6), np.zeros(6, np.int64)
    c, truth = lesson.ContactSet(none, none, none, n, p, gap), (J.copy(), p.copy(), gap.copy())
    truth[0][left], truth[1][left], truth[2][left] = 0.0, GONE, GONE
    mark_gone(c, gap, J, left)
    return (J, c.p, gap), truth


@random_law("Forces of contacts under loads with torques obey Newton, Euler, and the laws of contact and friction.",
            "forces and torques: largest violation [N, m/s², rad/s²]", EXACT)
def forces_under_torques(lesson, rng):
    """Load a body on two feet, and another one on its top, by random forces and torques.

    Accelerations follow from forces and levers.  At each contact F_n and the acceleration along n are not negative and
    one of them is 0; friction is at most μ F_n, and as large as that against a slip that begins.
    """
    x, w, I = np.array([(0.0, 0.4), (0.1, 1.0), (0.0, 0.0)]), rng.uniform(0.5, 2.0, 2), rng.uniform(2.0, 5.0, 2)
    inv_mass, inv_inertia, mu = np.append(w, 0.0), np.append(I, 0.0), rng.uniform(0.2, 0.8, 3)
    p = np.array([(-0.4, 0.0), (0.5, 0.0), (0.2, 0.8)])
    contacts = lesson.make_contacts([0, 0, 1], [2, 2, 0], p, [(0.0, 1.0)] * 3, inv_mass)
    load = np.concatenate((rng.normal(size=(2, 3)) - [0.0, 5.0, 0.0], np.zeros((1, 3))))
    F, a = lesson.contact_forces(x, inv_mass, inv_inertia, contacts, load, mu)
    truth, aside = load.copy(), []
    for k, (body, other) in enumerate(((0, 2), (0, 2), (1, 0))):
        force = np.array([-F[k, 1], F[k, 0]])                                # along n = (0, 1) and t = (−1, 0)
        for i, sign in ((body, 1.0), (other, -1.0)):
            truth[i] += sign * np.append(force, np.cross((*(p[k] - x[i]), 0.0), (*force, 0.0))[2])
    truth *= np.stack((inv_mass, inv_mass, inv_inertia), axis=1)
    for k, (body, other) in enumerate(((0, 2), (0, 2), (1, 0))):
        parts = [a[i, :2] + a[i, 2] * np.array([-(p[k] - x[i])[1], (p[k] - x[i])[0]]) for i in (body, other)]
        slides, rises = (parts[0] - parts[1]) * [-1.0, 1.0]
        limit = mu[k] * max(F[k, 0], 0.0)
        aside += [min(F[k, 0], rises), F[k, 1] - np.clip(F[k, 1] - slides, -limit, limit)]
    return (a, np.array(aside)), (truth, np.zeros(6))


@random_law("Bodies move and turn with their velocities, and the way of a body is that of its fastest point.",
            "motion: largest error of places, turns and ways [m, -]", EXACT)
def ways_of_bodies(lesson, rng):
    """In the plane, and in space if v is at right angles to ω, some point of the ball around a body moves along v as it
    turns.  Contacts are found anew as soon as this way is longer than 1/500 of the smallest half size.
    """
    d, dt, half = rng.choice((2, 3)), rng.uniform(1e-3, 3e-3), rng.uniform(0.1, 1.0, (4, 2))
    half = np.append(half, half[:, :1], axis=1)[:, :d]
    x, v, q = rng.normal(size=(4, d)), 0.1 * rng.normal(size=(4, d)), (
        rng.normal(size=4) if d == 2 else random_quaternions(rng, 4))
    omega = 0.1 * rng.normal(size=4) if d == 2 else np.cross(v, rng.normal(size=(4, 3)))
    way = dt * (np.linalg.norm(v, axis=1) + np.linalg.norm(half, axis=1) * (
        np.abs(omega) if d == 2 else np.linalg.norm(omega, axis=1)))
    ways = unknown_ways(half, 0, 100.0)
    begin_ways(ways, have_moved(ways))
    end = (lesson.move_2d if d == 2 else lesson.move)(x, q, v, omega, ways, dt)
    found, turned = end[1], q + dt * omega if d == 2 else np.zeros(0)
    if d == 3:
        found = np.array([matrix_of(one) for one in end[1]])
        turned = np.array([turned_by(w, dt) @ matrix_of(one) for w, one in zip(omega, q, strict=True)])
    return ((end[0], found, ways.length, 1.0 * have_moved(ways)),
            (x + dt * v, turned, way, 1.0 * (way > 2e-3 * np.min(half, axis=1))))


@random_law("A box is wider by the margin on all sides, and on one side by the way of eight steps, or by its own size.",
            "widened boxes: largest error of their sides [m]", EXACT)
def boxes_ahead(lesson, rng):
    """Move them in all directions, over a part of their size or farther."""
    d, dt, margin = rng.choice((2, 3)), rng.uniform(0.001, 0.01), rng.uniform(0.01, 0.05)
    low, size, way = rng.normal(size=(6, d)), rng.uniform(0.1, 1.0, (6, d)), rng.choice((-2.0, -0.5, 0.5, 2.0), (6, d))
    ahead = np.clip(way, -1.0, 1.0) * size
    return (widened(low, low + size, way * size / (AHEAD * dt), margin, dt),
            (low - margin + np.minimum(ahead, 0.0), low + size + margin + np.maximum(ahead, 0.0)))


@random_law("Boxes overlap where no axis separates them; a box reaches a plane with its nearest corner.",
            "boxes and planes: wrong answers [-]", 0.0)
def boxes_that_reach(lesson, rng):
    """Put a box beside others along each axis, and over planes, by a little too far or just near enough."""
    d = rng.choice((2, 3))
    axes, sides, shares = np.array(list(product(range(d), (-1.0, 1.0), (0.99, 1.01)))).T
    n, ways = len(axes), rng.uniform(-0.9, 0.9, (len(axes), d))
    ways[np.arange(n), axes.astype(int)] = sides * shares
    half, planes = rng.uniform(0.1, 1.0, (n + 1, d)), rng.normal(size=(n, d + 1))
    x = rng.normal(size=d) + np.vstack((np.zeros(d), ways * (half[0] + half[1:])))
    low, high, signs = x - half, x + half, np.array(list(product((-1.0, 1.0), repeat=d)))
    for k in range(n):
        planes[k, d] = shares[k] - 1.0 - np.min((x[k + 1] + signs * half[k + 1]) @ planes[k, :d])
    found = [(boxes_overlap(low, high, 0, k + 1), boxes_overlap(low, high, k + 1, 0),
              box_reaches(low, high, k + 1, planes[k])) for k in range(n)]
    return np.array(found, float), np.repeat(1.0 * (shares < 1.0), 3).reshape(n, 3)


def pairs_of(found, low, planes):
    """Return 1 for each pair of a box and a later box, or a plane, that is among the Pairs found, (n, n + p)."""
    table = np.zeros((len(low), len(low) + planes))
    for i in range(len(low)):
        table[i, found.partner[found.first[i]:found.first[i + 1]]] += 1.0
    return table


def pairs_by_hand(low, high, planes):
    """Return the same by all corners, low and high (n, d), and planes."""
    n, d = low.shape
    overlap = np.all((low[:, None] <= high) & (low <= high[:, None]), axis=2) & np.triu(np.ones((n, n), bool), 1)
    corners = np.where(np.array(list(product((False, True), repeat=d)))[:, None], high, low)
    reaches = np.min(corners @ planes[:, :d].T, axis=0) + planes[:, d] <= 0.0
    return 1.0 * np.hstack((overlap, reaches))


@random_law("A grid finds each pair of boxes that overlap once: in a crowd, beside one far away, and far out.",
            "pairs in a grid: wrong answers [-]", 0.0)
def pairs_in_a_grid(lesson, rng):
    """Far out, boxes of half a metre and the ways between them round to 0."""
    found, truth, d = [], [], rng.choice((2, 3))
    for kind in range(4):
        x, half, planes = rng.uniform(-2.0, 2.0, (20, d)), rng.uniform(0.1, 0.5, (20, d)), rng.normal(size=(3, d + 1))
        x *= 0.1 if kind == 1 else 1.0
        x[rng.integers(20)] += 1e3 * (kind == 2)
        x += 1e17 * (kind == 3)
        found.append(pairs_of(near_pairs(x - half, x + half, planes), x, 3))
        truth.append(pairs_by_hand(x - half, x + half, planes))
    return np.array(found), np.array(truth)


@random_law("Pairs come within reach where their widened boxes, or such a box and a plane, are nearer than half of the "
            "margin.", "pairs within reach: wrong answers [-]", 0.0)
def pairs_within_reach(lesson, rng):
    """Put boxes beside a first one along each axis, and over planes across the axes, by a little more or less."""
    d, margin = rng.choice((2, 3)), rng.uniform(0.05, 0.2)
    axes, sides, shares = np.array(list(product(range(d), (-1.0, 1.0), (0.99, 1.01)))).T
    n, axes, half = len(axes), axes.astype(int), rng.uniform(0.1, 1.0, (len(axes) + 1, d))
    out = sides[:, None] * np.eye(d)[axes]
    x = rng.normal(size=d) + np.vstack((np.zeros(d), out * (half[0] + half[1:] + SHARE * margin * shares[:, None])))
    offsets = SHARE * margin * shares - np.min((x[:, None] - np.sign(out) * half[:, None]) @ out[0], axis=1)[:n]
    planes = np.column_stack((np.tile(out[0], (n, 1)), offsets))
    near = pairs_of(pairs_in_reach(x - half, x + half, planes, margin), x, n)
    return (near[0, 1:n + 1], near[np.arange(n), n + 1 + np.arange(n)]), np.tile(1.0 * (shares < 1.0), 2)


@random_law("Pairs are searched anew when a body has used up half of its margin on some side.",
            "used margins: wrong answers [-]", 0.0)
def used_margins(lesson, rng):
    """Move bodies along each axis in both directions, by a little less and by a little more."""
    d, margin = rng.choice((2, 3)), rng.uniform(0.01, 0.05)
    axes, sides, shares = np.array(list(product(range(d), (-1.0, 1.0), (0.49, 0.51)))).T
    n, way = len(axes), (sides * shares * margin)[:, None] * np.eye(d)[axes.astype(int)]
    low, size, moved = rng.normal(size=(n, d)), rng.uniform(0.1, 1.0, (n, d)), np.zeros(n, bool)
    mark_far(moved, low + way, low + size + way, low - margin, low + size + margin, margin)
    return 1.0 * moved, 1.0 * (shares > 0.5)


@case("steps-of-a-pile", "A step of a pile, and forces under torques", compiled=False)
def steps_of_a_pile(lesson, check):
    """Compare flights, margins, separation, impulses, gaps and forces with Euler's equation and the laws of contact."""
    check.laws(lesson, (leaves_its_margin, tumbling_flight, separation, forces_under_torques, ways_of_bodies,
                        balance_in_space, friction_in_space, passing_bodies, meeting_bodies, gone_contacts, boxes_ahead,
                        used_margins, boxes_that_reach, pairs_in_a_grid, pairs_within_reach, separations,
                        marked_contacts), seed=32,
               times=15)
