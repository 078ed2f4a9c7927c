"""Pairs of n random boxes that touch, found by testing every pair and by descending two trees together.

Both must find the same pairs, all of them and no others.  The room grows with n, so each box keeps about the same
number of neighbours.  The result then grows with n, the work of brute force with n², and the work of the trees only
slightly faster than n (the benchmark measures it).
"""

from functools import lru_cache, partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.collisions import check_boxes
from validate.check import Whose
from validate.engines.collisions import bullet_closest_pairs, bullet_query_pairs
from validate.methods import BRUTE_FORCE, TREES
from validate.reference.collisions import all_touching
from validate.scene import EXACT, PYBULLET, Departure, Scene, engine, ours
from validate.scenes._common import ANSWER, constantly, one_reading
from validate.scenes.drawing import outlines

T = 1.0
MARGIN = 0.02                # that pybullet's broad phase adds around every box, its contactBreakingThreshold [m]
MOST_BY_ENGINE = 1000        # boxes: the query takes one call from Python for each of them


class Params(NamedTuple):
    n: Annotated[int, "boxes"] = 100
    edge: Annotated[float, "mean edge of the boxes; there is one box per cubic metre [m]"] = 0.6
    seed: int = 1


CASES = {
    "100 boxes": Params(),
    "1,000 boxes": Params(1000),
    "200 long boxes": Params(200, 1.5, 2),
    "10,000 boxes": Params(10_000),
    "100,000 boxes": Params(100_000),
}


@lru_cache(maxsize=8)
def boxes(p):
    """Return corners low, high (n, 3) [m]; edges from 0 to twice the mean, at random in a cube of n cubic metres."""
    rng = np.random.default_rng(p.seed)
    low = rng.uniform(0.0, p.n ** (1.0 / 3.0), (p.n, 3))
    return low, low + rng.uniform(0.0, 2.0 * p.edge, (p.n, 3))


def start(p):
    low, high = boxes(p)
    check_boxes(low, high)
    return low, high


def run(lessons, step, acceleration, state, p, dt, steps):
    return (step(*state),)


def judged(pairs, p):
    """Return how many of the reference pairs are among these, and how many of these are wrong or duplicates."""
    right = len(set(map(tuple, np.asarray(pairs).tolist())) & true_pairs(p))
    return np.array([right, len(pairs) - right], dtype=float)


def observe(state, p):
    return judged(state[0], p)


@lru_cache(maxsize=8)
def true_pairs(p, wider=0.0):
    """Return the pairs as a set; with `wider`, one box of each pair is larger on every side.

    Up to 1,000 boxes, all pairs are compared.  For more, boxes are sorted along x, and each is compared with those that
    begin before it ends.
    """
    low, high = boxes(p)
    if wider:
        touch = np.all((low[:, None] <= high[None] + wider) & (low[None] - wider <= high[:, None]), axis=2)
        return {(i, j) for i, j in np.argwhere(touch).tolist() if i < j}
    if p.n <= 1000:
        return set(map(tuple, all_touching(low, high).tolist()))
    order = np.argsort(low[:, 0])
    a, b = low[order], high[order]
    last, pairs = np.searchsorted(a[:, 0], b[:, 0], side="right"), set()
    for k in range(p.n):
        there = slice(k + 1, last[k])
        for m in np.nonzero(np.all((a[there, 1:] <= b[k, 1:]) & (b[there, 1:] >= a[k, 1:]), axis=1))[0]:
            i, j = int(order[k]), int(order[k + 1 + m])
            pairs.add((min(i, j), max(i, j)))
    return pairs


def truth(p, t):
    """Two boxes touch if they overlap in every coordinate: low_a ≤ high_b and low_b ≤ high_a.

    Source: the definition; all pairs compared by NumPy, or boxes sorted along x.
    """
    return np.array([len(true_pairs(p)), 0.0])


def by_wider_boxes(p, t):
    """Return the pairs with boxes that are MARGIN larger on every side.

    Source: Bullet, btCollisionWorld::updateSingleAabb and gContactBreakingThreshold.
    """
    true = true_pairs(p)
    return np.array([len(true), len(true_pairs(p, MARGIN) - true)])


def limit(p, dt):
    """Counts are whole numbers, which must be exact."""
    return 1e-15


def up_to(n):
    """Return the field `supports` of a runner that supports at most n boxes."""
    return lambda p: p.n <= n


def pybullet_make(p, dt, find):
    """Make an EngineRun of a function that returns the pairs of boxes that pybullet finds: one long reading."""
    return one_reading(lambda: judged(find(*boxes(p)), p))


COUNTS = {"order": EXACT, "limit": limit, "predicted": "exact: counts are whole numbers"}
RUNNERS = (
    ours(TREES, **COUNTS),
    ours(BRUTE_FORCE, **COUNTS, supports=up_to(10_000)),
    engine(PYBULLET, "", partial(pybullet_make, find=bullet_closest_pairs),
           "getClosestPoints(distance = 0) for every pair of GEOM_BOX", **COUNTS, supports=up_to(200)),
    engine(PYBULLET, "query", partial(pybullet_make, find=bullet_query_pairs),
           "getOverlappingObjects with the corners of each box, after a step", **COUNTS,
           supports=up_to(MOST_BY_ENGINE),
           departure=Departure("its broad phase enlarges boxes by 2 cm on every side, to predict contacts",
                               by_wider_boxes, Whose.DEFAULT)),
)


def points(observed, p):
    """Draw the boxes of the first case, seen from above."""
    low, high = boxes(p)
    outline = lambda a, b: np.array([(a[0], a[1]), (b[0], a[1]), (b[0], b[1]), (a[0], b[1])])
    return np.concatenate([outline(a, b) for a, b in zip(low[:100], high[:100])])


def links(p):
    return outlines(4, min(p.n, 100))


SCENE = Scene(
    title="Pairs of boxes", lesson="collisions",
    cases=CASES, **ANSWER,
    runners=RUNNERS,
    start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-16,
    slow_cases=("10,000 boxes", "100,000 boxes"),  # too slow for a quick validation
    quantity_names=constantly(("pairs that touch [-]", "too many [-]")),
    points=points, links=links,
    uses=("boxes along the axes", "a tree, rebuilt"),
    full_loop="the broad phase alone: nothing moves, so there is no loop",
    ablations={
        "motion": "a tree can be refitted instead of rebuilt if little has moved",
        "the shapes inside the boxes": "the narrow phase of this lesson tests the pairs",
    },
)
