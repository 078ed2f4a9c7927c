"""The judge of overlaps: closed forms, and random boxes against the hull of all differences of their corners."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from validate.reference.overlaps import box_depths, overlaps

FLOOR = {2: np.array([[0.0, 1.0, 0.0]]), 3: np.array([[0.0, 0.0, 1.0, 0.0]])}


def turned(d, rng, n):
    if d == 2:
        angle = rng.uniform(-np.pi, np.pi, n)
        return np.stack((np.cos(angle), -np.sin(angle), np.sin(angle), np.cos(angle)), axis=1).reshape(n, 2, 2)
    return Rotation.random(n, random_state=rng).as_matrix()


@pytest.mark.parametrize("d", [2, 3])
def test_two_balls_and_a_floor(d):
    x = np.zeros((2, d))
    x[:, -1], x[1, 0] = 0.4, 0.7
    depths = overlaps(x, np.tile(np.eye(d), (2, 1, 1)), np.full((2, d), 0.45), True, FLOOR[d])
    assert np.sort(depths) == pytest.approx([0.05, 0.05, 0.2])


@pytest.mark.parametrize("d", [2, 3])
def test_a_box_on_a_box_and_one_on_its_corner(d):
    x = np.zeros((2, d))
    x[:, -1] = 0.5, 1.49
    level = np.tile(np.eye(d), (2, 1, 1))
    assert overlaps(x, level, np.full((2, d), 0.5), False, FLOOR[d]) == pytest.approx([0.01])
    c = np.sqrt(0.5)
    corner = np.eye(d)
    corner[np.ix_([0, -1], [0, -1])] = [[c, -c], [c, c]]               # its lowest corner is c above its centre
    x[0, -1] = 0.7
    tilted = overlaps(x[:1], corner[None], np.full((1, d), 0.5), False, FLOOR[d])
    assert tilted == pytest.approx([np.sqrt(0.5) - 0.7])


@pytest.mark.parametrize("d", [2, 3])
def test_random_boxes_against_the_hull_of_all_differences_of_corners(d):
    """Two bodies overlap as deep as the origin lies below the nearest face of the hull of a − b.

    *Source:* the Minkowski difference.  qhull finds its faces here.
    """
    rng, n = np.random.default_rng(d), 200
    corners = np.stack(np.meshgrid(*[[-1.0, 1.0]] * d), axis=-1).reshape(-1, d)
    A, B, a, b = turned(d, rng, n), turned(d, rng, n), rng.uniform(0.2, 1.0, (n, d)), rng.uniform(0.2, 1.0, (n, d))
    x = rng.normal(size=(n, d))
    found = box_depths(np.concatenate((0.0 * x, x)), np.concatenate((A, B)), np.concatenate((a, b)), np.arange(n),
                       n + np.arange(n))
    for k in range(n):
        first, second = (corners * a[k]) @ A[k].T, (corners * b[k]) @ B[k].T + x[k]
        faces = ConvexHull((first[:, None] - second[None]).reshape(-1, d)).equations
        assert found[k] == pytest.approx(np.min(-faces[:, -1]), abs=1e-9)
    assert 40 < np.sum(found > 0.0) < n - 40
