"""Contacts of convex shapes of any kind, against brute force over directions."""

import numpy as np
import pytest

from solutions.support.broad_phase import Pairs
from solutions.support.convex_2d import (
    PREFER,
    Cores,
    convex_bounds_2d,
    convex_contacts_2d,
    turned_corners,
)
from solutions.support.shapes import (
    Ball,
    Box,
    Capsule,
    Polygon,
    core_of,
    moments_of_shape,
    outline_of,
    polygon_centre,
    size_of,
)

PAIR, FAR = Pairs(np.array([0, 1, 1]), np.array([1])), 100.0
NO_LINES = np.zeros((0, 3))


def random_shape(rng):
    """Return a Ball, a Box, a Capsule or a Polygon."""
    kind = rng.integers(4)
    if kind == 0:
        return Ball(rng.uniform(0.2, 1.0))
    if kind == 1:
        return Box(tuple(rng.uniform(0.2, 1.0, 2)))
    if kind == 2:
        return Capsule(rng.uniform(0.2, 1.0), rng.uniform(0.1, 0.5))
    around = np.sort(rng.uniform(0.0, 2.0 * np.pi, rng.integers(3, 7)))
    corners = np.stack((np.cos(around), np.sin(around)), axis=1) * rng.uniform(0.5, 1.0)
    return Polygon(tuple(map(tuple, corners)))


def placed(shapes, x, q):
    """Return (x, turn, Cores) of two shapes."""
    cores = [core_of(shape) for shape in shapes]
    made = Cores(np.concatenate([corners for corners, _ in cores]),
                 np.cumsum([0] + [len(corners) for corners, _ in cores]), np.array([radius for _, radius in cores]),
                 np.zeros((len(shapes), 2)))
    return x, np.stack((np.cos(q), np.sin(q)), axis=1), made


def separation(one, other):
    """Return the largest distance by which a line can part two convex polygons, over all directions of its normal."""
    def gap(angle):
        n = np.array([np.cos(angle), np.sin(angle)])
        return np.min(other @ n) - np.max(one @ n)

    around = np.linspace(0.0, 2.0 * np.pi, 720, endpoint=False)
    best = around[np.argmax([gap(angle) for angle in around])]
    low, high = best - 2.0 * np.pi / 720, best + 2.0 * np.pi / 720
    for _ in range(60):
        a, b = low + 0.382 * (high - low), low + 0.618 * (high - low)
        low, high = (a, high) if gap(a) < gap(b) else (low, b)
    return gap(0.5 * (low + high))


def random_pairs(seed, count):
    """Yield (shapes, x, turn, cores) of two shapes that are near each other or overlap."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        shapes = random_shape(rng), random_shape(rng)
        yield shapes, *placed(shapes, np.array([(0.0, 0.0), rng.uniform(-2.0, 2.0, 2)]), rng.uniform(0.0, 6.3, 2))


def test_the_smallest_gap_of_two_shapes_is_the_largest_separation_over_all_directions():
    seen = 0
    for shapes, x, turn, cores in random_pairs(1, 100):
        corners = turned_corners(x, turn, cores)
        truth = separation(corners[:cores.first[1]], corners[cores.first[1]:])
        if truth < 0.0 and all(isinstance(shape, Capsule) for shape in shapes):
            continue                                                     # two segments that cross have no depth
        found = convex_contacts_2d(x, turn, cores, NO_LINES, PAIR, FAR)
        reach = float(np.sum(cores.radius))
        # of two edges that separate alike, a's is preferred by this share
        assert found.gap.min() == pytest.approx(truth - reach, abs=1e-9 + PREFER * (reach + max(0.0, -truth))), shapes
        seen += 1
    assert seen > 75


def test_a_contact_lies_halfway_between_both_surfaces_and_its_normal_points_from_b_to_a():
    for shapes, x, turn, cores in random_pairs(2, 200):
        found = convex_contacts_2d(x, turn, cores, NO_LINES, PAIR, FAR)
        for k in range(found.a.size):
            assert (found.a[k], found.b[k]) == (0, 1)
            assert np.hypot(*found.n[k]) == pytest.approx(1.0, abs=1e-12)
        k = int(np.argmin(found.gap))
        n, gap = found.n[k], found.gap[k]
        if gap <= 0.0:
            continue
        # moved together by the gap along the normal, both shapes touch at the contact and nowhere overlap
        moved = np.array([x[0] - 0.5 * gap * n, x[1] + 0.5 * gap * n])
        again = convex_contacts_2d(moved, turn, cores, NO_LINES, PAIR, FAR)
        assert again.gap.min() == pytest.approx(0.0, abs=1e-9), shapes
        assert np.min(np.hypot(*(again.p - found.p[k]).T)) < 1e-7, shapes


def test_exchanged_bodies_have_the_same_contacts_with_opposite_normals():
    for shapes, x, turn, cores in random_pairs(3, 200):
        found = convex_contacts_2d(x, turn, cores, NO_LINES, PAIR, 0.5)
        x_2, turn_2, cores_2 = placed(shapes[::-1], x[::-1], np.arctan2(turn[::-1, 1], turn[::-1, 0]))
        other = convex_contacts_2d(x_2, turn_2, cores_2, NO_LINES, PAIR, 0.5)
        assert bool(found.gap.size) == bool(other.gap.size), shapes
        if found.gap.size and found.gap.min() > 0.0:
            assert other.gap.min() == pytest.approx(found.gap.min(), abs=1e-12)
            k, s = np.argmin(found.gap), np.argmin(other.gap)
            assert found.n[k] == pytest.approx(-other.n[s], abs=1e-9)


def test_faces_that_lie_on_each_other_have_two_contacts_at_the_ends_of_what_they_share():
    shapes = Box((1.0, 0.5)), Box((0.25, 0.5))
    found = convex_contacts_2d(*placed(shapes, np.array([(0.0, 0.0), (0.5, 1.001)]), np.zeros(2)), NO_LINES, PAIR, 0.1)
    assert sorted(found.p[:, 0]) == pytest.approx([0.25, 0.75])
    assert found.gap == pytest.approx([0.001, 0.001])
    assert found.n == pytest.approx(np.array([(0.0, -1.0)] * 2))


def test_a_capsule_lies_on_a_line_with_both_ends_and_a_disc_with_one_point():
    line = np.array([(0.0, 1.0, 0.0)])
    for shape, places in ((Capsule(0.5, 0.2), (-0.5, 0.5)), (Ball(0.2), (0.0,))):
        x, turn, cores = placed((shape,), np.array([(0.0, 0.19)]), np.zeros(1))
        found = convex_contacts_2d(x, turn, cores, line, Pairs(np.array([0, 1]), np.array([1])), 0.1)
        assert sorted(found.p[:, 0]) == pytest.approx(places)
        assert found.gap == pytest.approx([-0.01] * len(places))


def test_shapes_of_any_unit_of_length_have_the_same_contacts():
    for shapes, x, turn, cores in random_pairs(4, 60):
        for size in (2.0**-20, 2.0**20):
            found = convex_contacts_2d(x, turn, cores, NO_LINES, PAIR, 0.5)
            scaled = Cores(size * cores.corners, cores.first, size * cores.radius, cores.half)
            other = convex_contacts_2d(size * x, turn, scaled, NO_LINES, PAIR, 0.5 * size)
            assert other.gap == pytest.approx(size * found.gap, rel=1e-9, abs=1e-12 * size), shapes


def test_the_box_around_a_shape_touches_it_on_every_side():
    rng = np.random.default_rng(5)
    for _ in range(60):
        shape, q = random_shape(rng), rng.uniform(0.0, 6.3, 1)
        x, _, cores = placed((shape,), rng.uniform(-1.0, 1.0, (1, 2)), q)
        low, high, turn = convex_bounds_2d(x, q, cores)
        outline = outline_of(shape, 4000) @ np.array([(turn[0, 0], turn[0, 1]), (-turn[0, 1], turn[0, 0])]) + x[0]
        assert low[0] == pytest.approx(outline.min(axis=0), abs=1e-5)
        assert high[0] == pytest.approx(outline.max(axis=0), abs=1e-5)
        assert np.max(np.hypot(*(outline - x[0]).T)) == pytest.approx(size_of(shape), abs=1e-5)


@pytest.mark.parametrize("d", [2, 3])
def test_moments_of_shapes_are_the_integrals_over_their_points(d):
    rng = np.random.default_rng(6)
    triangle = np.array([(1.0, 0.0), (-0.5, 0.9), (-0.7, -0.8)])
    triangle -= polygon_centre(triangle)
    shapes = [Ball(0.7), Box((0.8, 0.3, 0.5)[:d]), Capsule(0.5, 0.3)]
    if d == 2:
        shapes.append(Polygon(tuple(map(tuple, triangle))))
    for shape in shapes:
        size = size_of(shape)
        points = rng.uniform(-size, size, (400_000, d))
        points = points[inside(shape, points)]
        squares = np.mean(points**2, axis=0)
        found = moments_of_shape(shape, 2.0, d)
        expected = 2.0 * np.sum(squares) if d == 2 else 2.0 * (np.sum(squares) - squares)
        assert found == pytest.approx(expected, rel=0.01)              # of 100,000 points the mean is off by 0.3 %


def inside(shape, points):
    """Return which points lie in a shape at the origin."""
    if isinstance(shape, Ball):
        return np.sum(points**2, axis=1) <= shape.radius**2
    if isinstance(shape, Box):
        return np.all(np.abs(points) <= shape.half, axis=1)
    if isinstance(shape, Capsule):
        near = np.clip(points[:, 0], -shape.half_length, shape.half_length)
        return (points[:, 0] - near) ** 2 + np.sum(points[:, 1:] ** 2, axis=1) <= shape.radius**2
    corners = np.array(shape.corners)
    edges = np.roll(corners, -1, axis=0) - corners
    left = [e[0] * (points[:, 1] - c[1]) >= e[1] * (points[:, 0] - c[0]) for c, e in zip(corners, edges, strict=True)]
    return np.all(left, axis=0)
