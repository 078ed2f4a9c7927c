"""Contacts of convex polyhedra in space, against boxes of lesson 9 and against the hull of all differences."""

import numpy as np
import pytest
from scipy.optimize import nnls
from scipy.spatial import ConvexHull

from solutions.given.hulls import hull_bounds, hull_contacts
from solutions.support.broad_phase import Pairs
from solutions.support.contact_points import PREFER_FACES, box_contacts, box_plane, edge_gap, face_gap, room_for
from solutions.support.convex_3d import RoundedBoxes, rounded_contacts
from solutions.support.hulls import MOST_POINTS, hulls_in_world, hulls_of, widest_edges, widest_face
from solutions.support.shapes import Ball, Box, Capsule, Polyhedron, size_of

PAIR, ON_PLANE = Pairs(np.array([0, 1, 1]), np.array([1])), Pairs(np.array([0, 1]), np.array([1]))
NO_PLANES, FAR = np.zeros((0, 4)), 100.0
EXACT = 1e-11                # round-off of lengths of about one metre [m]
LEAST_SQUARES = 1e-6         # error of a distance by least squares with heavy rows, over the distance [-]


# ---------------------------------------------------------------------------------------------- random shapes

def random_shape(rng, kind):
    """Return a shape of about one metre; the origin is inside."""
    if kind is Ball:
        return Ball(rng.uniform(0.05, 0.5))
    if kind is Capsule:
        return Capsule(rng.uniform(0.2, 1.0), rng.uniform(0.05, 0.5))
    if kind is Box:
        return Box(tuple(rng.uniform(0.2, 1.0, 3)))
    tetrahedron = np.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)])       # holds the origin inside
    corners = np.concatenate((0.5 * tetrahedron, rng.normal(size=(rng.integers(0, 8), 3)))) * rng.uniform(0.3, 0.8, 3)
    return Polyhedron(tuple(corners[np.unique(ConvexHull(corners).simplices)]))


def as_hulls(*shapes):
    """Return the RoundedBoxes of shapes; a Box is a polyhedron here."""
    core = [(shape.half_length if isinstance(shape, Capsule) else 0.0, 0.0, 0.0) for shape in shapes]
    half = [shape.half if isinstance(shape, Box) else (size_of(shape),) * 3 for shape in shapes]
    radius = [getattr(shape, "radius", 0.0) for shape in shapes]
    return RoundedBoxes(np.array(core), np.array(radius), np.array(half, float), hulls_of(shapes))


def pose(rng, n, spread):
    """Return (x, q) of n bodies: the first at 0, all turned at random."""
    x, q = rng.uniform(-spread, spread, (n, 3)), rng.normal(size=(n, 4))
    x[0] = 0.0
    return x, q / np.linalg.norm(q, axis=1)[:, None]


def random_pairs(seed, count, kinds, spread, reach=FAR):
    """Yield (cores of both in the world, radii, their ContactSet, Hulls, x)."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        shapes = as_hulls(*[random_shape(rng, kind) for kind in kinds])
        x, q = pose(rng, 2, spread)
        _, _, turn = hull_bounds(x, q, shapes)
        hulls = hulls_in_world(x, turn, shapes.hulls)
        cores = np.split(hulls.corners, hulls.first[1:2, 0].tolist())
        yield cores, shapes.radius, hull_contacts(x, turn, shapes, NO_PLANES, PAIR, reach), hulls, x


# ---------------------------------------------------------------------------------------------- truths

def distance(a, b):
    """Return (distance, unit vector from b to a) of two hulls: least squares over the weights of all corners."""
    heavy = 1e4                                  # of both sums of weights, beside places of about one metre
    rows = np.block([[a.T, -b.T], [heavy * np.ones(len(a)), np.zeros(len(b))],
                     [np.zeros(len(a)), heavy * np.ones(len(b))]])
    weights, _ = nnls(rows, (0.0, 0.0, 0.0, heavy, heavy))
    way = weights[:len(a)] @ a - weights[len(a):] @ b
    return np.linalg.norm(way), way / max(np.linalg.norm(way), 1e-300)


def facets(a, b):
    """Return (unit normals (k, 3) from b to a, gaps (k,)) of the faces of the hull of all differences a_i − b_j.

    Its least distance from 0 is the depth of two bodies that overlap; one face of it is farther than 0 if they do not.
    """
    hull = ConvexHull((a[:, None] - b).reshape(-1, 3))
    return -hull.equations[:, :3], hull.equations[:, 3]


def parted(n, a, b):
    """Return the gap of two hulls along n, from b to a."""
    return np.min(a @ n) - np.max(b @ n)


# ---------------------------------------------------------------------------------------------- hulls

@pytest.mark.parametrize("seed", range(3))
def test_faces_and_edges_of_a_hull_fit_together(seed):
    rng = np.random.default_rng(seed)
    hulls = hulls_of([random_shape(rng, kind) for kind in (Polyhedron, Ball, Box, Capsule, Polyhedron)])
    for i in (0, 2, 4):
        corners, faces, edges = (slice(*hulls.first[i:i + 2, kind]) for kind in range(3))
        assert np.diff(hulls.first[i:i + 2], axis=0) @ (1, 1, -1) == 2                       # Euler
        heights = hulls.corners[corners] @ hulls.faces[faces, :3].T + hulls.faces[faces, 3]
        assert np.max(heights) < EXACT
        assert np.all(np.sum(np.abs(heights) < EXACT, axis=0) == np.diff(hulls.begin)[faces])
        for a, b, left, right in hulls.edges[edges]:
            for f in (left, right):
                assert {a, b} < set(hulls.around[hulls.begin[f]:hulls.begin[f + 1]])
            along = np.cross(hulls.faces[left, :3], hulls.faces[right, :3])
            assert along @ (hulls.corners[b] - hulls.corners[a]) > 0.0
    assert np.diff(hulls.first, axis=0)[1:4].tolist() == [[1, 0, 0], [8, 6, 12], [2, 0, 1]]


@pytest.mark.parametrize("kinds", [(Polyhedron, Polyhedron), (Polyhedron, Box)], ids=["hulls", "hull and box"])
def test_the_axis_that_separates_best_is_that_of_the_hull_of_all_differences(kinds):
    """Also where bodies are apart: no face of that hull is farther from 0."""
    overlapping = 0
    for (a, b), _, _, hulls, x in random_pairs(1, 20, kinds, 1.0):
        found = max(widest_face(hulls, 0, 1)[0], widest_face(hulls, 1, 0)[0], widest_edges(hulls, x, 0, 1)[0])
        assert found == pytest.approx(np.max(facets(a, b)[1]), abs=1e-9)
        overlapping += found < 0.0
    assert 3 < overlapping < 17


# ---------------------------------------------------------------------------------------------- a box is a polyhedron

def sorted_rows(contacts):
    """Return rows (n, p, gap) of contacts in an order of their own."""
    rows = np.column_stack((contacts.n, contacts.p, contacts.gap))
    return rows[np.lexsort(rows.round(7).T)]


def second_best(x, turn, half, parallel):
    """Return by how much the best of the axes of two boxes separates them better than the next [m].

    There are fifteen of them, and three where all edges are parallel.
    """
    C, t = turn[0].T @ turn[1], turn[0].T @ (x[1] - x[0])
    gaps = [face_gap(C, t, *half, k) for k in range(3 if parallel else 6)]
    gaps += [edge_gap(C, t, *half, i, j) for i in range(0 if parallel else 3) for j in range(3)]
    return np.diff(np.sort(gaps)[-2:])[0]


@pytest.mark.parametrize("parallel", [False, True])
def test_two_boxes_have_the_contacts_of_lesson_9(parallel):
    """Also those that are near each other.  Axes are left out that separate so much alike that the order decides."""
    rng, met, reach = np.random.default_rng(2), 0, 0.1
    for _ in range(30):
        shapes = as_hulls(random_shape(rng, Box), random_shape(rng, Box))
        x, q = pose(rng, 2, 1.1)
        q[1] = q[0] if parallel else q[1]
        _, _, turn = hull_bounds(x, q, shapes)
        ours = sorted_rows(hull_contacts(x, turn, shapes, NO_PLANES, PAIR, reach))
        boxes = sorted_rows(box_contacts(x, turn, shapes.half, NO_PLANES, PAIR, reach))
        if second_best(x, turn, shapes.half, parallel) > 2.0 * PREFER_FACES * np.max(shapes.half):
            met += len(boxes) > 0
            assert ours == pytest.approx(boxes, abs=EXACT)
    assert met > 8


def test_a_box_on_a_plane_has_the_contacts_of_lesson_9():
    rng = np.random.default_rng(3)
    for _ in range(20):
        shapes, (x, q), n = as_hulls(random_shape(rng, Box)), pose(rng, 1, 0.0), rng.normal(size=3)
        plane = np.array([*(n / np.linalg.norm(n)), rng.uniform(0.0, 1.0)])
        _, _, turn = hull_bounds(x, q, shapes)
        ours, boxes = hull_contacts(x, turn, shapes, plane[None], ON_PLANE, 0.3), room_for(1, 8, 3)
        m = box_plane(x, turn, shapes.half, 0, plane, 0.3, boxes, 0)
        assert ours.a.size == m
        for found, expected in zip(ours[3:], boxes[3:], strict=True):
            assert found == pytest.approx(expected[:m], abs=EXACT)


@pytest.mark.parametrize("round_one", [Ball, Capsule])
def test_a_box_meets_what_is_round_as_a_box_does(round_one):
    """A capsule near an edge has more contacts with a Box: with the same nearest one."""
    rng = np.random.default_rng(4)
    for k in range(20):
        shapes, (x, q) = as_hulls(random_shape(rng, Box), random_shape(rng, round_one)), pose(rng, 2, 1.0)
        x, q = (x, q) if k % 2 else (x[::-1].copy(), q[::-1].copy())
        _, _, turn = hull_bounds(x, q, shapes)
        ours = hull_contacts(x, turn, shapes, NO_PLANES, PAIR, FAR)
        boxes = rounded_contacts(x, turn, shapes._replace(core=np.stack((shapes.half[0], shapes.core[1]))),
                                 NO_PLANES, PAIR, FAR)
        assert np.min(ours.gap) == pytest.approx(np.min(boxes.gap), abs=1e-8)
        one, other = np.argmin(ours.gap), np.argmin(boxes.gap)
        assert ours.n[one] == pytest.approx(boxes.n[other], abs=1e-6)


# ---------------------------------------------------------------------------------------------- against the truths

KINDS = pytest.mark.parametrize("kinds", [
    (Polyhedron, Polyhedron), (Polyhedron, Box), (Polyhedron, Ball), (Ball, Polyhedron), (Polyhedron, Capsule),
    (Capsule, Polyhedron)], ids=lambda kinds: " and ".join(kind.__name__ for kind in kinds))


@KINDS
def test_contacts_of_bodies_that_are_apart_are_no_nearer_than_these(kinds):
    """What is round, and hulls of which no face lies over the other, have their nearest points among the contacts."""
    apart, nearest = 0, 0
    for (a, b), radius, contacts, _, _ in random_pairs(5, 20, kinds, 2.0):
        truth, n = distance(a, b)
        if truth > 1e-3:
            apart += 1
            least = np.min(contacts.gap) + np.sum(radius)
            assert least >= truth * (1.0 - LEAST_SQUARES)
            if least <= truth * (1.0 + LEAST_SQUARES):
                nearest += 1
                assert contacts.n[np.argmin(contacts.gap)] == pytest.approx(n, abs=1e-4)
    assert apart > 7
    assert nearest == apart if np.sum(radius) > 0.0 else nearest > 0.7 * apart


@KINDS
def test_the_normal_of_bodies_that_overlap_is_that_of_the_shortest_way_out(kinds):
    """Contacts that are cut at a face may tell less than the depth, and never more.  Hulls prefer faces."""
    deep, slack = 0, 2.0 * PREFER_FACES if Ball not in kinds and Capsule not in kinds else 1e-8
    for (a, b), radius, contacts, _, _ in random_pairs(6, 20, kinds, 0.2):
        truth = np.max(facets(a, b)[1])
        if truth < -1e-3:
            deep += 1
            best = np.argmin(contacts.gap)
            assert truth - slack <= contacts.gap[best] + np.sum(radius) < slack
            assert parted(contacts.n[best], a, b) == pytest.approx(truth, abs=slack)
    assert deep > 5


@KINDS
def test_each_contact_lies_halfway_between_two_points_of_the_surfaces(kinds):
    for (a, b), radius, contacts, _, _ in random_pairs(7, 10, kinds, 1.0):
        for n, place, gap in zip(contacts.n, contacts.p, contacts.gap, strict=True):
            assert np.linalg.norm(n) == pytest.approx(1.0, abs=1e-12)
            for core, r, sign in ((a, radius[0], 1.0), (b, radius[1], -1.0)):
                inside = place + sign * (0.5 * gap + r) * n               # a point of the core
                assert distance(core, inside[None])[0] < 1e-6


@KINDS
def test_bodies_beyond_reach_have_no_contact_and_others_have_all_within_it(kinds):
    for (_, every), (_, near) in zip(
            enumerate(random_pairs(8, 10, kinds, 1.5)), enumerate(random_pairs(8, 10, kinds, 1.5, 0.2)), strict=True):
        within = every[2].gap <= 0.2
        if np.max(facets(*every[0])[1]) - np.sum(every[1]) <= 0.2:
            assert sorted(near[2].gap) == pytest.approx(sorted(every[2].gap[within]), abs=EXACT)
        else:
            assert near[2].gap.size == 0


def test_the_boxes_around_bodies_are_those_of_their_corners():
    rng = np.random.default_rng(9)
    shapes = as_hulls(*[random_shape(rng, kind) for kind in (Polyhedron, Ball, Capsule, Box)])
    x, q = pose(rng, 4, 1.0)
    low, high, turn = hull_bounds(x, q, shapes)
    hulls = hulls_in_world(x, turn, shapes.hulls)
    for i, corners in enumerate(np.split(hulls.corners, hulls.first[1:-1, 0].tolist())):
        assert low[i] == pytest.approx(np.min(corners, axis=0) - shapes.radius[i], abs=EXACT)
        assert high[i] == pytest.approx(np.max(corners, axis=0) + shapes.radius[i], abs=EXACT)


# ---------------------------------------------------------------------------------------------- manifolds

def prism(corners, half=0.1):
    """Return a Polyhedron: a regular polygon, extended along z."""
    angles = 2.0 * np.pi * np.arange(corners) / corners
    return Polyhedron(tuple((np.cos(a), np.sin(a), z) for z in (-half, half) for a in angles))


NOT_TURNED = np.stack((np.eye(3), np.eye(3)))
GROUND = np.array([(0.0, 0.0, 1.0, 0.1)])


@pytest.mark.parametrize("corners", [3, 6, 16])
def test_a_prism_on_a_plane_touches_it_with_all_corners_of_its_face(corners):
    shapes = as_hulls(prism(corners))
    contacts = hull_contacts(np.zeros((1, 3)), NOT_TURNED, shapes, GROUND, ON_PLANE, 0.01)
    assert contacts.gap == pytest.approx(np.zeros(corners), abs=EXACT)
    assert np.linalg.norm(contacts.p[:, :2], axis=1) == pytest.approx(np.ones(corners), abs=EXACT)


@pytest.mark.parametrize("corners", [17, 24])
def test_of_a_face_with_many_corners_16_leave_nine_tenths_of_its_inner_radius(corners):
    pair = np.array([(0.0, 0.0, 0.0), (0.0, 0.0, 0.2)])
    for x, planes, pairs in ((pair[:1], GROUND, ON_PLANE), (pair, NO_PLANES, PAIR)):
        contacts = hull_contacts(x, NOT_TURNED, as_hulls(*[prism(corners)] * len(x)), planes, pairs, 0.01)
        assert contacts.gap.size == MOST_POINTS
        assert np.min(-ConvexHull(contacts.p[:, :2]).equations[:, 2]) > 0.9 * np.cos(np.pi / corners)


def test_faces_that_lie_on_each_other_touch_at_the_corners_of_what_they_share():
    """A triangle on a square, half of it beyond a side."""
    for order in ((0, 1), (1, 0)):
        shapes = as_hulls(*[(Box((0.5, 0.5, 0.1)), prism(3))[k] for k in order])
        x = np.array([(0.0, 0.0, 0.0), (0.3, 0.0, 0.201)])[list(order)]
        contacts = hull_contacts(x, NOT_TURNED, shapes, NO_PLANES, PAIR, 0.01)
        assert contacts.n == pytest.approx(np.tile((0.0, 0.0, -1.0 if order[0] == 0 else 1.0), (contacts.a.size, 1)))
        assert contacts.gap == pytest.approx(0.001, abs=EXACT)
        across = (1.3 - 0.5) / np.sqrt(3.0)               # half the width of the triangle at the side of the square
        left = (1.3 + 0.2) / np.sqrt(3.0)                # and at its own back, which the square is too small for
        assert left > 0.5 > across
        where = 1.3 - 0.5 * np.sqrt(3.0)                  # there the triangle is as wide as the square
        expected = [(-0.2, 0.5), (-0.2, -0.5), (where, 0.5), (where, -0.5), (0.5, across), (0.5, -across)]
        found = np.array(sorted(contacts.p[:, :2].round(9).tolist()))
        assert found == pytest.approx(np.array(sorted(expected)), abs=1e-8)


def test_a_capsule_that_lies_on_a_face_touches_it_at_both_ends_of_what_they_share():
    shapes, x = as_hulls(prism(4), Capsule(2.0, 0.2)), np.array([(0.0, 0.0, 0.0), (0.0, 0.1, 0.31)])
    contacts = hull_contacts(x, NOT_TURNED, shapes, NO_PLANES, PAIR, 0.05)
    assert (np.min(contacts.p[:, 0]), np.max(contacts.p[:, 0])) == pytest.approx((-0.9, 0.9))
    assert contacts.gap == pytest.approx(0.01, abs=EXACT)
    assert contacts.n[:, 2] == pytest.approx(-1.0, abs=1e-12)


def test_bodies_at_one_place_have_a_unit_normal():
    for shapes in ((prism(5), prism(5)), (prism(5), Ball(0.1)), (Capsule(0.3, 0.1), prism(4)),
                   (prism(3), Box((1.0, 1.0, 1.0)))):
        contacts = hull_contacts(np.zeros((2, 3)), NOT_TURNED, as_hulls(*shapes), NO_PLANES, PAIR, 0.1)
        assert contacts.a.size >= 1
        assert np.linalg.norm(contacts.n, axis=1) == pytest.approx(1.0, abs=1e-12)
        assert np.max(contacts.gap) < 0.0
