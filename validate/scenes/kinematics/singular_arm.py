"""A straight arm and a target on its axis: methods that use the Jacobian do not move.

The end cannot move along a straight arm: Jᵀe = 0, although e is not zero.  Every method that uses the Jacobian stays
where it is.  If the target is beyond the last joint, every joint already points at it, so CCD has nothing to do.
Projections along the line stay on the line.  A bend of a millionth of a radian at the start is enough for all methods:
see the nearly straight arm.
"""

from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import check_positive
from solutions.kinematics import make_arm_2d
from validate.check import Whose, states
from validate.engines.kinematics import bullet_reach
from validate.methods import CCD, DAMPED, FABRIK, PSEUDO_INVERSE, TRANSPOSE
from validate.reference.kinematics import end_of
from validate.scene import EXACT, PYBULLET, ROUND_OFF, Departure, Scene, engine, ours
from validate.scenes._common import ANSWER, constantly
from validate.scenes.drawing import two_arms_and_target_links
from validate.scenes.kinematics._common import LENGTHS, REACH, draw_straight

ITERATIONS = 200


class Params(NamedTuple):
    x: Annotated[float, "target, on the axis of the arm [m]"] = 1.9


CASES = {"target beyond the last joint": Params(), "target behind the last joint": Params(1.05)}


def start(p):
    check_positive("x", p.x)
    return (np.zeros(3),)


# ---------------------------------------------------------------------------------------------- ours

def run(lessons, step, acceleration, state, p, dt, steps):
    kinematics = lessons.kinematics
    return (kinematics.advance_reach(step, kinematics.reach_2d, state[0], np.array([p.x, 0.0]), ITERATIONS, arm_of(p)),)


def arm_of(p):
    return make_arm_2d(LENGTHS, 0.6 / REACH**2, 0.2 * REACH, -np.inf, np.inf, 0.0, 0.0)


def observe(state, p):
    """Return the remaining distance to the target and the distance of the end from the axis, over the reach."""
    end = end_of(state[0], LENGTHS)
    return np.array([np.hypot(p.x - end[0], end[1]), abs(end[1])]) / REACH


def truth(p, t):
    """The remaining distance is zero, because both targets are within the ring that the arm reaches.

    Source: the triangle inequality; the longest link is shorter than the other two together.
    """
    return np.zeros(2)


def stays(p, t):
    """Return the whole initial distance."""
    return np.array([(REACH - p.x) / REACH, 0.0])


def on_the_line(p, t):
    """Return FABRIK on a line, with signs for directions: a link puts each joint ahead or behind."""
    s = np.append(0.0, np.cumsum(LENGTHS))
    for _ in range(ITERATIONS):
        s[3] = p.x
        for k in (2, 1, 0):
            s[k] = s[k + 1] + np.copysign(LENGTHS[k], s[k] - s[k + 1])
        s[0] = 0.0
        for k in (0, 1, 2):
            s[k + 1] = s[k] + np.copysign(LENGTHS[k], s[k + 1] - s[k])
    return np.array([abs(p.x - s[3]) / REACH, 0.0])


def limit(p, dt):
    """On a line the only sines and cosines are 0 and 1, and π is rounded once.  What is left is the round-off of three
    lengths.
    """
    return 20.0 * ROUND_OFF


# ---------------------------------------------------------------------------------------------- engine

def pybullet_make(p, dt):
    return bullet_reach(LENGTHS, start(p), lambda found: observe(found, p), (p.x, 0.0))


def beyond_the_last_joint(p):
    """Return whether the target is beyond the last joint.

    Behind it CCD folds and escapes, see the nearly straight arm.
    """
    return p.x > REACH - LENGTHS[-1]


STUCK = Departure("Jᵀe = 0 on a straight arm with its target on its axis: no turn of a joint changes |e| to first "
                  "order", stays, Whose.LAW)
POINTING = Departure("every joint points at the target already", stays, Whose.LAW)
ON_THE_LINE = Departure("projections along a line stay on the line", on_the_line, Whose.LAW)
JUDGED = {"order": EXACT, "limit": limit, "predicted": "its own law leaves nothing but roundings"}

RUNNERS = (
    *(ours(m, departure=STUCK, **JUDGED) for m in (TRANSPOSE, PSEUDO_INVERSE, DAMPED)),
    ours(CCD, departure=POINTING, supports=beyond_the_last_joint, **JUDGED),
    ours(FABRIK, departure=ON_THE_LINE, **JUDGED),
    engine(PYBULLET, "", pybullet_make, "calculateInverseKinematics with its defaults", departure=STUCK, **JUDGED),
)


def sanity_checks():
    """Return Findings: the gradient of ½|e|² on the straight arm, by complex numbers."""
    levers = 1j * np.cumsum(LENGTHS[::-1])[::-1]
    slopes = [np.real(np.conj(p.x - REACH) * levers) for p in CASES.values()]
    return (states("Jᵀe of the straight arm [m²]", slopes, 0.0, 0.0),
            states("end of the straight arm [m]", end_of(np.zeros(3), LENGTHS)[0], REACH, 1e-15))


# ---------------------------------------------------------------------------------------------- picture

def points(observed, p):
    return draw_straight(np.zeros(3), (p.x, 0.0))


SCENE = Scene(
    title="A straight arm", lesson="kinematics", **ANSWER, cases=CASES, runners=RUNNERS,
    start=start, run=run, observe=observe, truth=truth, truth_uncertainty=0.0,
    omitted_methods="pymunk has no inverse kinematics; if the target is behind the last joint, CCD folds the last "
                    "link, and round-off then bends the arm until it arrives",
    quantity_names=constantly(["way that is left, over the reach [-]", "way off the axis, over the reach [-]"]),
    sanity_checks=sanity_checks,
    points=points, links=lambda p: two_arms_and_target_links(3),
    uses=("positions of the joints", "the Jacobian of the end, for the methods that have one"),
    ablations={"a disturbance": "the nearly straight arm shows what a millionth of a radian does"},
)
