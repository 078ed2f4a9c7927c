"""A straight arm and a target on its axis: who finds out how to bend?

The end cannot move along a straight arm: Jᵀe = 0, although e is not.  Every method that asks the Jacobian stays where
it is, for ever.  Projections along the line stay on the line.  Only CCD gets away if the target lies behind its last
joint: it turns that joint by π, whose sine is 1.2e-16 in floats, and what is left of the symmetry breaks.  A millionth
of a radian at the start saves them all, because the straight arm is a saddle: see the stability case about it.
"""

from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import check_positive
from solutions.kinematics import make_arm_2d, reach_2d, solve_reach
from validate.engines.kinematics import BulletArm
from validate.methods import CCD, DAMPED, FABRIK, PSEUDO_INVERSE, TRANSPOSE
from validate.reference.kinematics import bullet_ik, end_of, joints_of
from validate.scene import EXACT, PYBULLET, ROUND_OFF, Departure, Engine, EngineRun, Scene

T = 1.0
STEPS = (1,)
MOST = 4000                  # iterations
ENOUGH = 1e-8                # |e| over the reach at which a search ends [-]
LENGTHS = np.array([1.0, 0.7, 0.4])
REACH = 2.1                  # [m]
METHODS = (TRANSPOSE, PSEUDO_INVERSE, DAMPED, CCD, FABRIK)


class Params(NamedTuple):
    x: Annotated[float, "target [m]"] = 1.05
    y: Annotated[float, "target [m]"] = 0.0
    bent: Annotated[float, "all angles at the start [rad]"] = 0.0


CASES = {
    "target behind the last joint": Params(), "target beyond the last joint": Params(1.9),
    "bent by a millionth": Params(1.05, 0.0, 1e-6), "beyond, bent by a millionth": Params(1.9, 0.0, 1e-6),
    "target beside the arm": Params(1.05, 0.6),
}


def target_of(p):
    return np.array([p.x, p.y])


def stuck(p):
    """Whether arm and target lie on one line."""
    return p.bent == 0.0 and p.y == 0.0


def start(p):
    check_positive("x", p.x)
    return (np.full(3, p.bent),)


# ---------------------------------------------------------------------------------------------- ours

def run(step, acceleration, state, p, dt, steps):
    arm = make_arm_2d(LENGTHS, 0.6 / REACH**2, 0.2 * REACH, -np.inf, np.inf, 0.0, 0.0)
    return solve_reach(step, reach_2d, state[0], np.array([p.x, p.y]), ENOUGH * REACH, MOST, arm)[:1]


def observe(state, p):
    """What is left of the way, over the reach."""
    return np.array([np.linalg.norm(target_of(p) - end_of(state[0], LENGTHS)) / REACH])


def truth(p, t):
    """Nothing: all these targets are within the ring that the arm reaches.

    Source: the triangle's inequality; the longest link is shorter than the other two together.
    """
    return np.zeros(1)


def stays(p, t):
    """All of the way, where arm and target lie on one line; else nothing."""
    return np.array([(REACH - p.x) / REACH if stuck(p) else 0.0])


def stays_or_folds(p, t):
    """As stays; but CCD folds the last link back where the target is behind the last joint, and gets away."""
    return np.zeros(1) if p.x < REACH - LENGTHS[-1] else stays(p, t)


def on_the_line(p, t):
    """FABRIK on a line, with signs for directions: joints go to where their link puts them, ahead or behind."""
    if not stuck(p):
        return np.zeros(1)
    s = np.append(0.0, np.cumsum(LENGTHS))
    for _ in range(MOST):
        s[3] = p.x
        for k in (2, 1, 0):
            s[k] = s[k + 1] + np.copysign(LENGTHS[k], s[k] - s[k + 1])
        s[0] = 0.0
        for k in (0, 1, 2):
            s[k + 1] = s[k] + np.copysign(LENGTHS[k], s[k + 1] - s[k])
    return np.array([abs(p.x - s[3]) / REACH])


def tolerance(p, dt):
    """A search that arrives ends at 1e-8 of the reach.  One that stays does so to round-off; on a line there are no
    sines and cosines but 0 and 1.

    pybullet follows its own law: twenty steps round a few hundred times, and a millionth of bend grows by its own
    factor and what is rounded with it.
    """
    arrives = ENOUGH if not stuck(p) else 20.0 * ROUND_OFF
    return {EXACT: arrives, "CCD": max(ENOUGH if p.x < REACH - LENGTHS[-1] else 0.0, arrives), "pybullet": 1e-11}


# ---------------------------------------------------------------------------------------------- engine

def pybullet_make(p, dt):
    engine = BulletArm(LENGTHS)
    return EngineRun(lambda: None, lambda: observe([engine.solve(start(p)[0], target_of(p))], p), engine.close)


def bullet_law(p, t):
    return observe([bullet_ik(start(p)[0], target_of(p), LENGTHS)], p)


ENGINES = (Engine(PYBULLET, "", pybullet_make, EXACT, "calculateInverseKinematics as it is"),)
JACOBIAN = Departure("Jᵀe = 0 on a straight arm with its target on its axis: no joint can make |e| smaller", stays)


def quantity_names(p):
    return ["way that is left, over the reach [-]"]


def sanity_checks():
    """((claim, found, expected, tolerance), …): the gradient of |e| on the straight arm, by complex numbers."""
    levers = 1j * np.cumsum(LENGTHS[::-1])[::-1]
    slopes = [np.real(np.conj(p.x - REACH) * levers) for p in CASES.values() if stuck(p)]
    end = [abs(REACH - end_of(np.zeros(3), LENGTHS)[0])]
    return (("Jᵀe of the straight arm [m²]", slopes, 0.0, 0.0), ("end of the straight arm [m]", end, 0.0, 1e-15))


# ---------------------------------------------------------------------------------------------- picture

def points(observed, p):
    """The straight arm, an arm that reaches the target by a bend of its first two links, and the target."""
    straight = joints_of(np.zeros(3), LENGTHS)
    r, l_1, rest = np.hypot(p.x, p.y), LENGTHS[0], LENGTHS[1] + LENGTHS[2]
    bend = np.pi - np.arccos((l_1**2 + rest**2 - r * r) / (2.0 * l_1 * rest))
    first = np.arctan2(p.y, p.x) - np.arctan2(rest * np.sin(bend), l_1 + rest * np.cos(bend))
    cross = target_of(p) + 0.04 * np.array([(-1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (1.0, -1.0)])
    return np.round(np.concatenate((straight, joints_of(np.array([first, bend, 0.0]), LENGTHS), cross)), 5)


def links(p):
    return [(0, 1), (1, 2), (2, 3), (4, 5), (5, 6), (6, 7), (8, 9), (10, 11)]


SCENE = Scene(
    title="A straight arm",
    lesson="kinematics",
    cases=CASES,
    duration=T,
    steps=STEPS,
    methods=METHODS,
    start=start,
    run=run,
    observe=observe,
    truth=truth,
    truth_uncertainty=0.0,
    tolerance=tolerance,
    engines=ENGINES,
    orders=dict.fromkeys((method.function for method in METHODS), EXACT),
    expected_departures={
        "transpose": JACOBIAN, "pseudo-inverse": JACOBIAN, "damped": JACOBIAN,
        "CCD": Departure("every joint already points at the target, unless the last one has to turn round",
                         stays_or_folds),
        "FABRIK": Departure("projections along a line stay on the line", on_the_line),
        "pybullet": Departure("Jᵀe = 0 on a straight arm, and 20 iterations with its damping of ½ m² are few beside it",
                              bullet_law)},
    omitted_methods="pymunk has no inverse kinematics",
    moves=False,
    refinement="",
    quantity_names=quantity_names,
    sanity_checks=sanity_checks,
    points=points,
    links=links,
    uses=("positions of the joints", "the Jacobian of the end, for the methods that have one"),
    ablations={"a random disturbance": "the cases with a millionth of bend show what it does"},
)
