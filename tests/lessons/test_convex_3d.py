"""Contacts of balls, capsules, boxes and planes in space, against searches that know only points and directions."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from solutions.support.broad_phase import Pairs
from solutions.support.convex_3d import RoundedBoxes, rounded_bounds, rounded_contacts

PAIR, FAR = Pairs(np.array([0, 1, 1]), np.array([1])), 100.0
ON_PLANE = Pairs(np.array([0, 1]), np.array([1]))
NO_PLANES = np.zeros((0, 4))
KINDS = "ball", "capsule", "box"


def random_core(rng, kind):
    """Return (half sizes of the core (3,), radius)."""
    sizes = {"ball": (0.0, 0.0, 0.0), "capsule": (rng.uniform(0.2, 1.0), 0.0, 0.0), "box": rng.uniform(0.2, 1.0, 3)}
    return np.array(sizes[kind]), 0.0 if kind == "box" else rng.uniform(0.05, 0.5)


def pose(rng, n, spread):
    """Return (x, q) of n bodies: the first at 0, all turned at random."""
    x, q = rng.uniform(-spread, spread, (n, 3)), rng.normal(size=(n, 4))
    x[0] = 0.0
    return x, q / np.linalg.norm(q, axis=1)[:, None]


def found(x, q, cores, planes=NO_PLANES, pairs=PAIR, reach=FAR):
    """Return the ContactSet and the rotations of these shapes."""
    core, radius = (np.array(values) for values in zip(*cores, strict=True))
    shapes = RoundedBoxes(core, radius, core)
    _, _, turn = rounded_bounds(x, q, shapes)
    return rounded_contacts(x, turn, shapes, planes, pairs, reach), turn


def nearest(x, turn, cores):
    """Return the points (2, 3) of two cores that are nearest to each other, by bounded least squares."""
    half, both = np.concatenate([core for core, _ in cores]), np.concatenate((turn[0], -turn[1]), axis=1)
    free, a = half > 0.0, np.zeros(6)
    if np.any(free):
        a[free] = lsq_linear(both[:, free], x[1] - x[0], (-half[free], half[free]), method="bvls", tol=1e-15,
                             max_iter=1000).x
    return x[0] + turn[0] @ a[:3], x[1] + turn[1] @ a[3:]


def parted(n, x, turn, cores):
    """Return the gaps (k,) of two shapes along directions n (k, 3), from the second to the first."""
    reach = sum(np.abs(n @ turn[k]) @ cores[k][0] + cores[k][1] for k in (0, 1))
    return n @ (x[0] - x[1]) - reach


def widest(x, turn, cores, rng):
    """Return the largest gap over all directions: a search that narrows around the best of many."""
    n, width = rng.normal(size=(4000, 3)), 0.1
    n /= np.linalg.norm(n, axis=1)[:, None]
    best = n[np.argsort(parted(n, x, turn, cores))[-20:]]
    while width > 1e-10:
        n = (best[:, None] + width * rng.normal(size=(len(best), 40, 3))).reshape(-1, 3)
        n = np.concatenate((best, n / np.linalg.norm(n, axis=1)[:, None]))
        best = n[np.argsort(parted(n, x, turn, cores))[-20:]]
        width *= 0.7
    return np.max(parted(best, x, turn, cores))


def random_pairs(seed, count, first, second, spread):
    """Yield (x, turn, cores, contacts) of two shapes."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        cores = random_core(rng, first), random_core(rng, second)
        x, q = pose(rng, 2, spread)
        contacts, turn = found(x, q, cores)
        yield x, turn, cores, contacts


ROUND_PAIRS = [(a, b) for a in KINDS for b in KINDS if (a, b) != ("box", "box")]


@pytest.mark.parametrize(("first", "second"), ROUND_PAIRS)
def test_the_smallest_gap_of_cores_that_are_apart_is_their_distance_less_both_radii(first, second):
    apart = 0
    for x, turn, cores, contacts in random_pairs(1, 60, first, second, 2.0):
        p, q = nearest(x, turn, cores)
        distance = np.linalg.norm(p - q)
        if distance > 1e-6:
            apart += 1
            assert contacts.gap.min() == pytest.approx(distance - cores[0][1] - cores[1][1], abs=1e-9)
            best = np.argmin(contacts.gap)
            assert contacts.n[best] == pytest.approx((p - q) / distance, abs=1e-5)
    assert apart > 30


@pytest.mark.parametrize(("first", "second"), [(a, b) for a in KINDS for b in KINDS if "box" in (a, b)])
def test_the_normal_of_cores_that_overlap_is_that_of_the_shortest_way_out(first, second):
    """Contacts that are clipped to a face may tell less than the depth, and never more."""
    rng, deep = np.random.default_rng(2), 0
    for x, turn, cores, contacts in random_pairs(3, 25, first, second, 0.5):
        if np.linalg.norm(np.subtract(*nearest(x, turn, cores))) < 1e-9:
            deep += 1
            truth = widest(x, turn, cores, rng)
            slack = 2e-3 if (first, second) == ("box", "box") else 1e-8       # lesson 9 prefers faces
            assert truth - slack <= contacts.gap.min() < 0.0
            best = np.argmin(contacts.gap)
            assert parted(contacts.n[best], x, turn, cores) == pytest.approx(truth, abs=slack)
    assert deep > 5


@pytest.mark.parametrize(("first", "second"), ROUND_PAIRS)
def test_each_contact_lies_halfway_between_two_points_of_the_surfaces(first, second):
    """The points are on the two shapes, and the gap is their distance along the normal."""
    for x, turn, cores, contacts in random_pairs(4, 40, first, second, 2.0):
        for n, place, gap in zip(contacts.n, contacts.p, contacts.gap, strict=True):
            assert np.linalg.norm(n) == pytest.approx(1.0, abs=1e-12)
            for k, sign in ((0, 1.0), (1, -1.0)):
                inside = place + sign * (0.5 * gap + cores[k][1]) * n         # a point of the core
                assert np.all(np.abs(turn[k].T @ (inside - x[k])) <= cores[k][0] + 1e-9) or gap < -cores[k][1]


@pytest.mark.parametrize("kind", KINDS)
def test_contacts_with_a_plane_are_those_of_the_lowest_points(kind):
    rng = np.random.default_rng(5)
    for _ in range(30):
        core, radius = random_core(rng, kind)
        x, q = pose(rng, 1, 1.0)
        n = rng.normal(size=3)
        plane = np.array([*(n / np.linalg.norm(n)), rng.uniform(0.0, 2.0)])
        contacts, turn = found(x, q, [(core, radius)], plane[None], ON_PLANE)
        assert contacts.a.size == 2 ** np.count_nonzero(core)
        lowest = plane[:3] @ x[0] + plane[3] - np.abs(plane[:3] @ turn[0]) @ core - radius
        assert contacts.gap.min() == pytest.approx(lowest, abs=1e-12)
        heights = contacts.p @ plane[:3] + plane[3]
        assert heights == pytest.approx(0.5 * contacts.gap, abs=1e-12)


def level(kind, length=0.5):
    return {"capsule": (np.array([length, 0.0, 0.0]), 0.1), "box": (np.array([0.5, 0.4, 0.3]), 0.0)}[kind]


@pytest.mark.parametrize(("turned", "expected"), [
    (0.0, [-0.5, 0.5]),                                    # along the longer side of the box: it carries both ends
    (0.5 * np.pi, [-0.4, 0.4])])                           # across: as far as the box is wide
def test_a_capsule_that_lies_on_a_box_has_two_contacts(turned, expected):
    x = np.array([(0.0, 0.0, 0.0), (0.0, 0.0, 0.41)])
    q = np.array([(1.0, 0.0, 0.0, 0.0), (np.cos(0.5 * turned), 0.0, 0.0, np.sin(0.5 * turned))])
    for order in ((0, 1), (1, 0)):
        contacts, _ = found(x[list(order)], q[list(order)], [(level("box"), level("capsule"))[k] for k in order])
        along = contacts.p[:, 0] * np.cos(turned) + contacts.p[:, 1] * np.sin(turned)
        assert sorted(along) == pytest.approx(expected, abs=1e-9)
        assert contacts.gap == pytest.approx(0.01, abs=1e-12)
        assert contacts.n[:, 2] == pytest.approx(1.0 if order[0] else -1.0, abs=1e-12)


@pytest.mark.parametrize("tilt", [1e-12, 1e-6, 1e-3, 0.02])
def test_a_capsule_that_bears_on_one_edge_of_a_box_has_a_contact_above_the_other(tilt):
    """It lies across the box, which is 1 m wide, with its ends outside.  Without the second contact it would rock."""
    cores = level("box"), level("capsule", 2.0)
    for turned in (tilt, -tilt):
        x = np.array([(0.0, 0.0, 0.0), (0.0, 0.0, 0.4 + 0.5 * np.tan(tilt))])
        q = np.array([(1.0, 0.0, 0.0, 0.0), (np.cos(0.5 * turned), 0.0, np.sin(0.5 * turned), 0.0)])
        for order in ((0, 1), (1, 0)):
            contacts, _ = found(x[list(order)], q[list(order)], [cores[k] for k in order], reach=0.05)
            first, last = np.argsort(contacts.p[:, 0])[[0, -1]]
            assert contacts.p[[first, last], 0] == pytest.approx([-0.5, 0.5], abs=2.0 * tilt)
            assert sorted(contacts.gap[[first, last]]) == pytest.approx([0.0, np.tan(tilt)], abs=tilt**2 + 1e-12)


def test_parallel_capsules_touch_at_both_ends_of_what_they_share():
    x, q = np.array([(0.0, 0.0, 0.0), (0.3, 0.0, 0.25)]), np.array([(1.0, 0.0, 0.0, 0.0)] * 2)
    contacts, _ = found(x, q, (level("capsule"), level("capsule")))
    assert sorted(contacts.p[:, 0]) == pytest.approx([-0.2, 0.5], abs=1e-9)
    assert contacts.gap == pytest.approx(0.05, abs=1e-12)


def test_crossed_segments_and_equal_centres_have_a_unit_normal():
    x, q = np.zeros((2, 3)), np.array([(1.0, 0.0, 0.0, 0.0), (np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5))])
    ball = np.zeros(3), 0.2
    for cores in ((level("capsule"), level("capsule")), (ball, ball), (ball, level("box")), (level("box"), ball)):
        contacts, _ = found(x, q, cores)
        assert contacts.a.size >= 1
        assert np.linalg.norm(contacts.n, axis=1) == pytest.approx(1.0, abs=1e-12)
