"""The grid of the broad phase finds what a comparison of all boxes finds, and stays small."""

import numpy as np
import pytest

from solutions.checks import Diverged
from solutions.support.broad_phase import CELLS_PER_BODY, cell_numbers, cell_size, near_pairs
from validate.subject import modules


def swarms(rng):
    """(name, low (n, d), high (n, d)): boxes strewn at random, and those for which a grid is hard."""
    for d in (2, 3):
        for n in (1, 2, 7, 40):
            low = rng.uniform(-1.0, 1.0, (n, d))
            yield f"{n} at random in {d}D", low, low + rng.uniform(0.01, 1.0, (n, d))
            line = 1e4 * low + 1e4 * np.arange(n)[:, None] * np.eye(d)[n % d]
            yield f"{n} scattered about a line in {d}D", line, line + rng.uniform(1e-6, 1e4, (n, d))
        for axis in range(d):
            thin = 1e-4 * rng.uniform(0.0, 1.0, (60, d))
            thin[:, axis] = rng.uniform(0.0, 1e4, 60)
            thin[1::2] = thin[::2] + 0.5e-4                              # each has a partner
            yield f"tiny bodies in a line along {axis} in {d}D", thin, thin + 1e-4
        flat = np.zeros((60, d))
        flat[:, :2] = rng.uniform(0.0, 1e6, (60, 2))
        flat[1::2] = flat[::2] + 0.5
        yield f"small bodies on a wide plane in {d}D", flat, flat + 1.0
        far = rng.uniform(0.0, 3.0, (30, d))
        far[-1] = 1e12
        yield f"one far away in {d}D", far, far + 1.0
        bricks = np.stack(np.meshgrid(*[0.1 * np.arange(4)] * d), axis=-1).reshape(-1, d)
        yield f"bricks that touch in {d}D", bricks, bricks + 0.1
        yield f"all in one place in {d}D", np.ones((9, d)), np.ones((9, d)) + 0.1
        yield f"points so far out that their sizes round to 0 in {d}D", np.full((3, d), 1e20), np.full((3, d), 1e20)


@pytest.mark.parametrize("seeds", [range(4), pytest.param(range(4, 20), marks=pytest.mark.long)])
def test_the_grid_finds_the_pairs_of_brute_force_in_few_cells(seeds):
    for seed in seeds:
        for name, low, high in swarms(np.random.default_rng(seed)):
            n, d = low.shape
            planes = np.append(np.eye(d)[-1], -float(np.median(low[:, -1])))[None]
            pairs = near_pairs(low, high, planes)
            found = sorted((i, int(j)) for i in range(n) for j in pairs.partner[pairs.first[i]:pairs.first[i + 1]])
            expected = [(i, j) for i in range(n) for j in range(i + 1, n)
                        if np.all(low[i] <= high[j]) and np.all(low[j] <= high[i])]
            expected += [(i, n) for i in range(n) if low[i, -1] + planes[0, -1] <= 0.0]
            assert found == sorted(expected), (name, seed)
            size = cell_size(low, high)
            places = np.floor(np.ptp(low, axis=0) / size)
            assert np.prod(places + 1.0) <= CELLS_PER_BODY * n, (name, seed)
            assert np.all(high - low <= size), (name, seed)
            assert cell_numbers(low, size)[2] == np.prod(places + 3.0), (name, seed)


def test_bodies_that_are_not_finite_have_no_pairs():
    for bad in (np.nan, np.inf):
        low = np.array([(0.0, 0.0), (bad, 1.0)])
        with pytest.raises(Diverged, match="extent of all bodies"):
            near_pairs(low, low + 1.0, np.zeros((0, 3)))


@pytest.mark.parametrize("compiled", [False, pytest.param(True, marks=pytest.mark.long)])
def test_bodies_farther_apart_than_numbers_go_are_refused(compiled):
    if compiled and not modules.can_compile():
        pytest.skip("numba has no wheel for this machine")
    lesson = modules.bind("contact", compiled=compiled)
    state, pile = lesson.make_pile_2d([(0.0, 0.0), (1e308, 1e308), (-1e308, 1e308)], np.zeros(3), 1.0, 0.01,
                                      np.full((3, 2), 0.1), [(0.0, 1.0, 1.0)], (0.0, 0.0), 0.3, 2, 60.0, 5.0, 0.01)
    with pytest.raises(Diverged, match="extent of all bodies"):
        lesson.advance_pile_2d(lesson.disc_bounds, lesson.round_contacts, state, 1.0 / 240.0, 3, pile)
