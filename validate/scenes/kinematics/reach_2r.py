"""Two links and a target: there are two answers, elbow up and elbow down, and a search finds the one on its side.

The closed form gives both at once.  Every iterative method, started with its elbow bent to one side, finds the
answer on that side.  pybullet's default damping of ½ m² suits arms of a metre.  An arm of 20 cm stays 16 % of its
reach away from the target; a smaller jointDamping corrects this.
"""

from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.kinematics import make_arm_2d
from validate.check import Whose, states
from validate.engines.kinematics import bullet_reach
from validate.methods import CCD, CLOSED_2R, DAMPED, FABRIK, PSEUDO_INVERSE, TRANSPOSE
from validate.reference.kinematics import bullet_ik, bullet_search, jacobian_of, joints_of, search_errors, searched
from validate.scene import EXACT, PYBULLET, ROUND_OFF, Departure, Scene, engine, ours
from validate.scenes._common import ANSWER, check_positives, constantly
from validate.scenes.drawing import two_arms_and_target_links
from validate.scenes.kinematics._common import draw_answers, within_half_a_turn
from validate.scenes.kinematics._common import from_minus_pi_to_pi as observe

T = 1.0
ENOUGH = 1e-10               # |e| over the reach at which a search ends [-]
MOST = 20_000                # iterations; the transpose needs some thousand near the edge of the reach
GAIN, LAMBDA = 0.7, 0.1      # α times, and λ over, the square of the reach and the reach [-]
BEND = 1.2                   # of the elbow at the start, to either side [rad]
CURED = 1e-4                 # jointDamping over the square of the reach [-]


class Params(NamedTuple):
    l_1: Annotated[float, "length of the first link [m]"] = 1.0
    l_2: Annotated[float, "length of the second link [m]"] = 1.0
    x: Annotated[float, "target [m]"] = 0.366
    y: Annotated[float, "target [m]"] = 1.366


CASES = {
    "one metre each": Params(), "behind the base": Params(1.0, 0.6, -0.8, -0.5),
    "near the edge of the reach": Params(1.0, 0.6, 1.4, 0.6), "near the hole": Params(1.0, 0.6, 0.1, -0.45),
    "10 cm each": Params(0.1, 0.1, 0.08, 0.1),
}


def lengths_of(p):
    return np.array([p.l_1, p.l_2])


def target_of(p):
    return np.array([p.x, p.y])


def start(p):
    """Return (angles with the elbow on one side, angles with the elbow on the other)."""
    check_positives(p, "l_1", "l_2")
    bearing = np.arctan2(p.y, p.x)
    return tuple(np.array([bearing - 0.5 * side * BEND, side * BEND]) for side in (1.0, -1.0))


# ---------------------------------------------------------------------------------------------- ours

def run(lessons, step, acceleration, state, p, dt, steps):
    kinematics = lessons.kinematics
    if step is kinematics.solve_2r:
        return step(target_of(p), lengths_of(p), 1.0), step(target_of(p), lengths_of(p), -1.0)
    enough = ENOUGH * (p.l_1 + p.l_2)
    return tuple(kinematics.solve_reach(step, kinematics.reach_2d, theta, target_of(p), enough, MOST, arm_of(p))[0]
                 for theta in state)


def arm_of(p):
    size = p.l_1 + p.l_2
    return make_arm_2d(lengths_of(p), GAIN / size**2, LAMBDA * size, -np.inf, np.inf, 0.0, 0.0)


def truth(p, t):
    """In the triangle of base, elbow and target,  cos β = (r² + l₁² − l₂²)/(2 r l₁) at the base and
    cos γ = (l₁² + l₂² − r²)/(2 l₁ l₂) at the elbow.  θ₁ = bearing ∓ β,  θ₂ = ±(π − γ).

    Source: the law of cosines; Lynch and Park 2017, chapter 6.
    """
    r, bearing = np.hypot(p.x, p.y), np.arctan2(p.y, p.x)
    beta = np.arccos((r * r + p.l_1**2 - p.l_2**2) / (2.0 * r * p.l_1))
    gamma = np.arccos((p.l_1**2 + p.l_2**2 - r * r) / (2.0 * p.l_1 * p.l_2))
    return np.angle(np.exp(1j * np.array([bearing - beta, np.pi - gamma, bearing + beta, gamma - np.pi])))


def relative(way, p):
    """Return a distance [of the reach] over σ₂, the smaller singular value of J, relative to both answers' angles."""
    angles = truth(p, T)
    smallest = np.linalg.svd(jacobian_of(angles[:2], lengths_of(p)), compute_uv=False)[-1]
    return way * (p.l_1 + p.l_2) * np.sqrt(2.0) / smallest / np.linalg.norm(angles)


def limit(p, dt):
    """Angles are off by at most |e|/σ₂, σ₂ the smaller singular value of J at the answer, which is the same for both
    answers.  A search ends at |e| ≤ 1e-10 of the reach.  The gain 0.7/reach² is below 2/σ₁², because σ₁² < 2 reach².
    """
    return relative(1.1 * ENOUGH, p)


def formula_limit(p, dt):
    """The closed form has a few rounding errors of lengths, over σ₂, here as in the truth."""
    return relative(20.0 * ROUND_OFF, p)


def cured_limit(p, dt):
    """pybullet with adjusted settings: its position error is 1e-9 of the reach before its last iteration."""
    return relative(1.1e-9, p)


def default_limit(p, dt):
    """By default pybullet follows its own law.  Its matrix is well conditioned, and twenty iterations have a few
    hundred rounding errors.
    """
    return 1e-13


# ---------------------------------------------------------------------------------------------- engine

def pybullet_make(p, dt, **settings):
    return bullet_reach(lengths_of(p), start(p), lambda found: observe(found, p), target_of(p), **settings)


def cure(p):
    size = p.l_1 + p.l_2
    return {"damping": CURED * size**2, "iterations": 100, "threshold": 1e-9 * size}


def cured(p, dt):
    return pybullet_make(p, dt, **cure(p))


def our_searches(p, step):
    """Return the searches of a method of ours, in the form that `search_errors` takes."""
    target, lengths, size = target_of(p), lengths_of(p), p.l_1 + p.l_2
    return [lambda nudge, theta=theta: searched(step, theta + nudge[:2], target, lengths, ENOUGH * size, MOST,
                                                GAIN / size**2, LAMBDA * size) for theta in start(p)]


def cured_searches(p):
    """Return those of pybullet with adjusted settings."""
    return [lambda nudge, theta=theta: bullet_search(theta + nudge[:2], target_of(p), lengths_of(p), **cure(p))
            for theta in start(p)]


def turned_by(angles, p):
    return within_half_a_turn(angles, truth(p, T))


def default_law(p, t):
    return observe([bullet_ik(theta, target_of(p), lengths_of(p)) for theta in start(p)], p)


def jumps(p):
    """Near the hole σ₂ is small on the whole way, and the pseudo-inverse jumps about."""
    return "σ₂ is small on the way to the hole, and it jumps about" if p == CASES["near the hole"] else ""


RUNNERS = (
    ours(CLOSED_2R, order=EXACT, limit=formula_limit, predicted="a formula: it leaves nothing but roundings"),
    *(ours(m, order=EXACT, limit=limit, unfinished=jumps if m is PSEUDO_INVERSE else None,
           predicted=search_errors(partial(our_searches, step=m.table), turned_by, truth, limit))
      for m in (TRANSPOSE, PSEUDO_INVERSE, DAMPED, CCD, FABRIK)),
    engine(PYBULLET, "", cured, "jointDamping 1e-4 reach², at most 100 iterations, residualThreshold 1e-9 reach",
           order=EXACT, limit=cured_limit, predicted=search_errors(cured_searches, turned_by, truth, cured_limit)),
    engine(PYBULLET, "default", pybullet_make, "calculateInverseKinematics as it is",
           order=EXACT, limit=default_limit, predicted="its own law is its search, which leaves nothing but roundings",
           departure=Departure("its damping is ½ m² for an arm of any size, and it stops after 20 iterations or at "
                               "0.1 mm", default_law, Whose.DEFAULT)),
)


def sanity_checks():
    """Return Findings: both answers end at the target; the small arm's remaining distance."""
    ends = [joints_of(angles, lengths_of(p))[-1] - target_of(p)
            for p in CASES.values() for angles in truth(p, T).reshape(2, 2)]
    small = CASES["10 cm each"]
    short = [np.linalg.norm(joints_of(angles, lengths_of(small))[-1] - target_of(small)) / 0.2
             for angles in default_law(small, T).reshape(2, 2)]
    return (states("way from the end to the target [m]", ends, 0.0, 1e-14),
            states("what a 20 cm arm is short of in pybullet, over its reach [-]", short, 0.1645, 5e-5))


# ---------------------------------------------------------------------------------------------- picture

def points(observed, p):
    return draw_answers(lengths_of(p), observed, target_of(p))


SCENE = Scene(
    title="Two elbows", lesson="kinematics", **ANSWER, cases=CASES, runners=RUNNERS,
    start=start, run=run, observe=observe, truth=truth, truth_uncertainty=1e-15,
    omitted_methods="pymunk has no inverse kinematics",
    quantity_names=constantly(["θ₁, elbow to the right [rad]", "θ₂ [rad]", "θ₁, elbow to the left [rad]", "θ₂ [rad]"]),
    published_states=((1.0, tuple(np.radians((30.0, 90.0, 120.0, -90.0))), 5e-4),),
    sanity_checks=sanity_checks,
    points=points, links=lambda p: two_arms_and_target_links(2),
    uses=("positions of the joints", "the Jacobian of the end, for the methods that have one"),
    ablations={"masses": "inverse kinematics asks for a position, not for a velocity",
               "limits of the joints": "they would choose one of the two answers, or none"},
)
