"""Which of n random boxes touch each other?  By testing every pair, and by two trees that are gone down together.

Both must find the same pairs, all of them and no others.  With n the boxes fill a larger room, so that each has about as many neighbours:
the answer grows with n, brute force with n², the trees little faster than n (the benchmark measures it).
"""

from functools import lru_cache
from typing import Annotated, NamedTuple

import numpy as np

from solutions.collisions import check_boxes
from validate.engines.collisions import bullet_closest_pairs, bullet_query_pairs
from validate.methods import BRUTE_FORCE, TREES
from validate.reference.collisions import all_touching
from validate.scene import EXACT, PYBULLET, Departure, Engine, EngineRun, Scene

T = 1.0
STEPS = (1,)
MARGIN = 0.02                # that pybullet's broad phase puts around every box, its contactBreakingThreshold [m]
MOST_BY_ENGINE = 1000        # boxes; it is asked for each of them by a call from Python


class Params(NamedTuple):
    n: Annotated[int, "boxes"] = 100
    edge: Annotated[float, "their mean edge; there is one for each cubic metre [m]"] = 0.6
    seed: int = 1


CASES = {"100 boxes": Params(), "1,000 boxes": Params(1000), "200 long boxes": Params(200, 1.5, 2), "10,000 boxes": Params(10_000), "100,000 boxes": Params(100_000)}


@lru_cache(maxsize=8)
def boxes(p):
    """Corners low, high (n, 3) [m]: edges from 0 to twice the mean, somewhere in a cube of n cubic metres."""
    rng = np.random.default_rng(p.seed)
    low = rng.uniform(0.0, p.n ** (1.0 / 3.0), (p.n, 3))
    return low, low + rng.uniform(0.0, 2.0 * p.edge, (p.n, 3))


def start(p):
    low, high = boxes(p)
    check_boxes(low, high)
    return low, high


def quantity_names(p):
    return "pairs that touch [-]", "too many [-]"


def run(step, acceleration, state, p, dt, steps):
    return (step(*state),)


def judged(pairs, p):
    """How many of the true pairs are among these, and how many of these are none, or are there twice."""
    right = len(set(map(tuple, np.asarray(pairs).tolist())) & true_pairs(p))
    return np.array([right, len(pairs) - right], dtype=float)


def observe(state, p):
    return judged(state[0], p)


@lru_cache(maxsize=8)
def true_pairs(p, wider=0.0):
    """The pairs, as a set; wider: with the other of each pair made larger on every side.

    Up to 1,000 boxes by comparing all with all; beyond, sorted along x, each with those that begin before it ends.
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
    """Two boxes touch where they do in every coordinate: low_a ≤ high_b and low_b ≤ high_a.

    Source: the definition; compared all with all by NumPy, or sorted along x.
    """
    return np.array([len(true_pairs(p)), 0.0])


def by_wider_boxes(p, t):
    """The same with boxes MARGIN larger on every side.  Source: Bullet, btCollisionWorld::updateSingleAabb and gContactBreakingThreshold."""
    true = true_pairs(p)
    return np.array([len(true), len(true_pairs(p, MARGIN) - true)])


def tolerance(p, dt):
    """None: counts.  A single pair more or less is 1/pairs, above 1e-6 in all cases."""
    return {EXACT: 1e-9, **{engine.label: 1e-9 for engine in ENGINES}}


def supports(name, p):
    """Brute force up to 10,000 boxes; pybullet's closest points for the first case, its query up to MOST_BY_ENGINE."""
    return {"all_pairs": p.n <= 10_000, "pybullet": p.n <= 200, "pybullet, query": p.n <= MOST_BY_ENGINE}.get(name, True)


def asked(find):
    return lambda p, dt: EngineRun(lambda: None, lambda: judged(find(*boxes(p)), p), lambda: None)


ENGINES = (
    Engine(PYBULLET, "", asked(bullet_closest_pairs), EXACT, "getClosestPoints(distance = 0) for every pair of GEOM_BOX"),
    Engine(PYBULLET, "query", asked(bullet_query_pairs), EXACT, "getOverlappingObjects with the corners of each box, after a step"),
)


def points(observed, p):
    """The boxes of the first case, seen from above."""
    low, high = boxes(p)
    return np.concatenate([np.array([(a[0], a[1]), (b[0], a[1]), (b[0], b[1]), (a[0], b[1])]) for a, b in zip(low[:100], high[:100])])


def links(p):
    return [(4 * k + i, 4 * k + (i + 1) % 4) for k in range(min(p.n, 100)) for i in range(4)]


SCENE = Scene(
    title="Pairs of boxes",
    lesson="collisions",
    cases=CASES,
    duration=T,
    steps=STEPS,
    methods=(TREES, BRUTE_FORCE),
    start=start,
    run=run,
    observe=observe,
    truth=truth,
    truth_uncertainty=1e-16,
    tolerance=tolerance,
    engines=ENGINES,
    expected_departures={"pybullet, query": Departure("its broad phase keeps boxes that are 2 cm larger on every side, so that contacts are known before they happen", by_wider_boxes)},
    orders={"tree_pairs": EXACT, "all_pairs": EXACT},
    supports=supports,
    slow_cases=("10,000 boxes", "100,000 boxes"),          # left to a full validation
    moves=False,
    refinement="",
    quantity_names=quantity_names,
    points=points,
    links=links,
    uses=("boxes along the axes", "a tree, made anew"),
    ablations={"motion": "a tree may be mended instead of made anew when little has moved", "what is in the boxes": "the narrow phase of this lesson looks at the pairs"},
)
