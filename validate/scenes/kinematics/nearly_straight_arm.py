"""The same straight arm, bent by a millionth of a radian: the search escapes from the saddle.

A straight arm is a saddle.  A small bend grows in each iteration by a factor above 1 until the arm is free; the
stability case about straight arms predicts the factors.  CCD does not even need a bend if the target lies behind its
last joint: it turns that joint by π, whose sine is 1.2e-16 in floats, and that breaks the symmetry.  By default
pybullet stops after 20 iterations, when its bend is still small.  More iterations and less damping help.
"""

from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import check_positive
from solutions.kinematics import make_arm_2d
from validate.check import Whose
from validate.engines.kinematics import bullet_reach
from validate.methods import CCD, DAMPED, FABRIK, PSEUDO_INVERSE, TRANSPOSE
from validate.reference.kinematics import bullet_ik, bullet_search, end_of, search_errors, searched
from validate.scene import EXACT, PYBULLET, Departure, Scene, engine, ours
from validate.scenes._common import ANSWER, constantly
from validate.scenes.drawing import two_arms_and_target_links
from validate.scenes.kinematics._common import LENGTHS, REACH, draw_straight

MOST = 4000                  # iterations
ENOUGH = 1e-8                # |e| over the reach at which a search ends [-]
GAIN, LAMBDA = 0.6 / REACH**2, 0.2 * REACH               # α [1/m²], λ [m]
CURE = {"damping": LAMBDA**2, "iterations": MOST, "threshold": 1e-8}


class Params(NamedTuple):
    x: Annotated[float, "target [m]"] = 1.05
    y: Annotated[float, "target [m]"] = 0.0
    bent: Annotated[float, "all angles at the start [rad]"] = 1e-6


CASES = {
    "target behind the last joint": Params(), "target beyond the last joint": Params(1.9),
    "straight, target beside the arm": Params(1.05, 0.6, 0.0),
    "straight, target behind the last joint": Params(1.05, 0.0, 0.0),
}


def target_of(p):
    return np.array([p.x, p.y])


def start(p):
    check_positive("x", p.x)
    return (np.full(3, p.bent),)


# ---------------------------------------------------------------------------------------------- ours

def run(lessons, step, acceleration, state, p, dt, steps):
    kinematics, target = lessons.kinematics, target_of(p)
    return kinematics.solve_reach(step, kinematics.reach_2d, state[0], target, ENOUGH * REACH, MOST, arm_of(p))[:1]


def arm_of(p):
    return make_arm_2d(LENGTHS, GAIN, LAMBDA, -np.inf, np.inf, 0.0, 0.0)


def observe(state, p):
    """Return the remaining distance to the target, over the reach."""
    return np.array([np.linalg.norm(target_of(p) - end_of(state[0], LENGTHS)) / REACH])


def truth(p, t):
    """The remaining distance is zero, because all these targets are within the ring that the arm reaches.

    Source: the triangle inequality; the longest link is shorter than the other two together.
    """
    return np.zeros(1)


def limit(p, dt):
    """A search ends at 1e-8 of the reach.

    pybullet with adjusted settings ends after the iteration that began with 1e-8 m.
    """
    return ENOUGH


def default_limit(p, dt):
    """By default pybullet follows its own law.  Twenty iterations have a few hundred rounding errors, which change a
    bend of a millionth by 1e-10 of itself.
    """
    return 1e-11


# ---------------------------------------------------------------------------------------------- engine

def pybullet_make(p, dt, **settings):
    return bullet_reach(LENGTHS, start(p), lambda found: observe(found, p), target_of(p), **settings)


def cured(p, dt):
    return pybullet_make(p, dt, **CURE)


def our_searches(p, step):
    """Return the searches of a method of ours, in the form that `search_errors` takes."""
    return searches(p, lambda theta: searched(step, theta, target_of(p), LENGTHS, ENOUGH * REACH, MOST, GAIN, LAMBDA))


def cured_searches(p):
    """Return the searches of pybullet with adjusted settings."""
    return searches(p, lambda theta: bullet_search(theta, target_of(p), LENGTHS, **CURE))


def searches(p, search):
    """Return the search from a nudged start; none from an exactly straight arm, where the rounding of π decides."""
    return [lambda nudge: search(start(p)[0] + nudge)] if is_bent(p) else []


def is_bent(p):
    """Return whether the arm is bent: a straight arm with its target on its axis is stuck, except for CCD."""
    return p.bent > 0.0 or p.y > 0.0


def default_law(p, t):
    return observe([bullet_ik(start(p)[0], target_of(p), LENGTHS)], p)


RUNNERS = (
    *(ours(m, order=EXACT, limit=limit, supports=None if m is CCD else is_bent,
           predicted=search_errors(partial(our_searches, step=m.table), observe, truth, limit))
      for m in (TRANSPOSE, PSEUDO_INVERSE, DAMPED, CCD, FABRIK)),
    engine(PYBULLET, "", cured, "jointDamping as our λ², at most 4,000 iterations, residualThreshold 1e-8",
           order=EXACT, limit=limit, supports=is_bent,
           predicted=search_errors(cured_searches, observe, truth, limit)),
    engine(PYBULLET, "default", pybullet_make, "calculateInverseKinematics with its defaults",
           order=EXACT, limit=default_limit, supports=is_bent,
           predicted="its own law is its search, which leaves only round-off",
           departure=Departure("it ends after 20 iterations with a damping of ½ m², or 0.1 mm from the target",
                               default_law, Whose.DEFAULT)),
)


# ---------------------------------------------------------------------------------------------- picture

def points(observed, p):
    return draw_straight(np.full(3, p.bent), target_of(p))


SCENE = Scene(
    title="A nearly straight arm", lesson="kinematics", **ANSWER, cases=CASES, runners=RUNNERS,
    start=start, run=run, observe=observe, truth=truth, truth_uncertainty=0.0,
    omitted_methods="pymunk has no inverse kinematics",
    quantity_names=constantly(["way that is left, over the reach [-]"]),
    points=points, links=lambda p: two_arms_and_target_links(3),
    uses=("positions of the joints", "the Jacobian of the end, for the methods that have one"),
    ablations={"the bend": "without it only CCD bends the arm, and only to a target behind the last joint: see "
                          "the straight arm"},
)
