"""Three links, a place and a direction: as many conditions as joints, so there are again two answers.

The closed form puts the last joint where the direction requires it, and solves for the other two.  The damped step
does the same by a Jacobian with a third row.  pybullet accepts a direction, too, but the place alone decides when the
search ends.
"""

from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.kinematics import make_arm_2d
from validate.check import Whose, states
from validate.engines.kinematics import bullet_reach
from validate.methods import CLOSED_3R, DAMPED, PSEUDO_INVERSE, TRANSPOSE
from validate.reference.kinematics import (
    bullet_ik,
    end_of,
    jacobian_of,
    joints_of,
    search_errors,
    searched,
    single_rounding,
)
from validate.scene import EXACT, PYBULLET, ROUND_OFF, Departure, Scene, engine, ours
from validate.scenes._common import ANSWER, check_positives
from validate.scenes.drawing import two_arms_and_target_links
from validate.scenes.kinematics._common import draw_answers, within_half_a_turn
from validate.scenes.kinematics._common import from_minus_pi_to_pi as observe

T = 1.0
ENOUGH = 1e-10               # |e| at which a search ends [m and rad]
MOST = 20_000                # iterations; the transpose needs some thousand
LAMBDA = 0.1                 # λ over the reach [-]
BEND = 1.2                   # of the elbow at the start, to either side [rad]


class Params(NamedTuple):
    l_1: Annotated[float, "length of the first link [m]"] = 3.0
    l_2: Annotated[float, "length of the second link [m]"] = 2.0
    l_3: Annotated[float, "length of the third link [m]"] = 1.0
    x: Annotated[float, "target [m]"] = 4.0
    y: Annotated[float, "target [m]"] = 2.0
    degrees: Annotated[float, "direction of the third link [°]"] = 0.0


CASES = {
    "lengths 3, 2 and 1 m, target (4, 2), 0°": Params(),
    "the hand points back": Params(x=2.0, y=2.5, degrees=160.0),
    "lengths 0.3, 0.2 and 0.1 m": Params(0.3, 0.2, 0.1, 0.4, 0.2, 0.0),
}


def lengths_of(p):
    return np.array([p.l_1, p.l_2, p.l_3])


def target_of(p):
    return np.array([p.x, p.y, np.radians(p.degrees)])


def start(p):
    """Return angles with the elbow on one side and on the other, and the hand along its direction."""
    check_positives(p, "l_1", "l_2", "l_3")
    wrist = target_of(p)[:2] - end_of([np.radians(p.degrees)], [p.l_3])
    bearing = np.arctan2(wrist[1], wrist[0])
    return tuple(np.array([bearing - 0.5 * side * BEND, side * BEND,
                           np.radians(p.degrees) - bearing - 0.5 * side * BEND]) for side in (1.0, -1.0))


# ---------------------------------------------------------------------------------------------- ours

def run(lessons, step, acceleration, state, p, dt, steps):
    kinematics = lessons.kinematics
    if step is kinematics.solve_3r:
        return step(target_of(p), lengths_of(p), 1.0), step(target_of(p), lengths_of(p), -1.0)
    return tuple(kinematics.solve_reach(step, kinematics.pose_2d, theta, target_of(p), ENOUGH, MOST, arm_of(p))[0]
                 for theta in state)


def arm_of(p):
    size = p.l_1 + p.l_2 + p.l_3
    return make_arm_2d(lengths_of(p), 1.0 / (2.0 * size**2 + 3.0), LAMBDA * size, -np.inf, np.inf, 0.0, 0.0)


def truth(p, t):
    """The last joint is at  w = (x, y) − l₃ (cos φ, sin φ).  The elbow is where the circles of l₁ about the base and of
    l₂ about w meet:  w (l₁² − l₂² + |w|²)/(2|w|²) ± (−w_y, w_x) h/|w|.  Angles are those between the links.

    Source: two circles; the numbers are those of an exercise in Lynch and Park 2017, chapter 6.
    """
    w = complex(p.x, p.y) - p.l_3 * np.exp(1j * np.radians(p.degrees))
    along = (p.l_1**2 - p.l_2**2 + abs(w) ** 2) / (2.0 * abs(w))
    aside = np.sqrt(p.l_1**2 - along**2)
    found = []
    for side in (-1.0, 1.0):                                  # an elbow to the right of the line bends θ₂ to the left
        elbow = w / abs(w) * complex(along, side * aside)
        upper, lower = np.angle(elbow), np.angle(w - elbow)
        found += [upper, lower - upper, np.radians(p.degrees) - lower]
    return np.angle(np.exp(1j * np.array(found)))


def smallest_singular_value(p):
    """Return the smaller one, of both answers, of the smallest singular values of the Jacobian with its third row."""
    return min(np.linalg.svd(np.vstack((jacobian_of(angles, lengths_of(p)), np.ones(3))), compute_uv=False)[-1]
               for angles in truth(p, T).reshape(2, 3))


def relative(off, p):
    """Return an error of place or direction over σ₃, relative to both answers' angles."""
    return off * np.sqrt(2.0) / smallest_singular_value(p) / np.linalg.norm(truth(p, T))


def limit(p, dt):
    """Angles are off by at most |e|/σ₃, σ₃ the smallest singular value of J at the answer.  A search ends at 1e-10.
    The gain is below 2/σ₁², because σ₁² < 3 reach² + 3 and α = 1/(2 reach² + 3).
    """
    return relative(1.1 * ENOUGH, p)


def formula_limit(p, dt):
    """The closed form has a few rounding errors of lengths and angles, over σ₃, here as in the truth."""
    return relative(20.0 * ROUND_OFF * (1.0 + p.l_1 + p.l_2 + p.l_3), p)


def cured_limit(p, dt):
    """pybullet with adjusted settings detects no missing rotation below 2 arccos(1 − 1.1e-16) = 3e-8 rad."""
    return relative(3e-8, p)


def default_limit(p, dt):
    """By default pybullet follows its own law.  If its angle is not known well enough to decide to which 32-bit float
    it is rounded, that iteration may be off by the spacing of such floats.
    """
    return (1e-13 + single_doubt(p)) * np.sqrt(2.0) / np.linalg.norm(truth(p, T))


def single_doubt(p):
    """Return the larger uncertainty [rad] by 32-bit floats of both answers."""
    x, y, direction = target_of(p)
    return max(single_rounding(theta, np.array([x, y]), lengths_of(p), direction) for theta in start(p))


def searches(p, step):
    """Return the searches of a method of ours, in the form that `search_errors` takes."""
    target, lengths, size = target_of(p), lengths_of(p), p.l_1 + p.l_2 + p.l_3
    return [lambda nudge, theta=theta: searched(step, theta + nudge, target, lengths, ENOUGH, MOST,
                                                1.0 / (2.0 * size**2 + 3.0), LAMBDA * size) for theta in start(p)]


def turned_by(angles, p):
    return within_half_a_turn(angles, truth(p, T))


# ---------------------------------------------------------------------------------------------- engine

def pybullet_make(p, dt, **settings):
    x, y, direction = target_of(p)
    return bullet_reach(lengths_of(p), start(p), lambda found: observe(found, p), (x, y), direction, **settings)


def cured(p, dt):
    return pybullet_make(p, dt, damping=1e-4 * sum(lengths_of(p)) ** 2, iterations=200, threshold=1e-12)


def default_law(p, t):
    x, y, direction = target_of(p)
    return observe([bullet_ik(theta, np.array([x, y]), lengths_of(p), direction) for theta in start(p)], p)


RUNNERS = (
    ours(CLOSED_3R, order=EXACT, limit=formula_limit, predicted="a formula: only round-off is left"),
    *(ours(m, order=EXACT, limit=limit,
           predicted=search_errors(partial(searches, step=m.table), turned_by, truth, limit))
      for m in (TRANSPOSE, PSEUDO_INVERSE, DAMPED)),
    engine(PYBULLET, "", cured, "jointDamping 1e-4 reach², at most 200 iterations, residualThreshold 1e-12",
           order=EXACT, limit=cured_limit,
           predicted="it ends where it sees no missing rotation any more, and that moment depends on roundings"),
    engine(PYBULLET, "default", pybullet_make, "calculateInverseKinematics with targetOrientation, as it is",
           order=EXACT, limit=default_limit, predicted="its own law is its search, which leaves nothing but roundings",
           departure=Departure("it stops at 0.1 mm from the place, in any direction, or after 20 iterations, and its "
                               "damping is ½ for an arm of any size", default_law, Whose.DEFAULT)),
)


def quantity_names(p):
    return [f"θ_{k}, elbow to the {side} [rad]" for side in ("right", "left") for k in (1, 2, 3)]


def sanity_checks():
    """Return Findings: both answers end at the target with its direction."""
    both = [(angles, p) for p in CASES.values() for angles in truth(p, T).reshape(2, 3)]
    off = [joints_of(angles, lengths_of(p))[-1] - target_of(p)[:2] for angles, p in both]
    turned = [np.angle(np.exp(1j * (np.sum(angles) - np.radians(p.degrees)))) for angles, p in both]
    return (states("way from the end to the target [m]", off, 0.0, 1e-14),
            states("direction that is missing [rad]", turned, 0.0, 1e-14))


# ---------------------------------------------------------------------------------------------- picture

def points(observed, p):
    return draw_answers(lengths_of(p), observed, target_of(p)[:2])


SCENE = Scene(
    title="Three links and a direction", lesson="kinematics", **ANSWER, cases=CASES, runners=RUNNERS,
    start=start, run=run, observe=observe, truth=truth, truth_uncertainty=1e-15,
    omitted_methods="CCD and FABRIK have no direction; pymunk has no inverse kinematics",
    quantity_names=quantity_names,
    published_states=((1.0, (0.0, 0.5 * np.pi, -0.5 * np.pi, 2.0 * np.arctan2(2.0, 3.0), -0.5 * np.pi,
                             0.5 * np.pi - 2.0 * np.arctan2(2.0, 3.0)), 1e-14),),
    sanity_checks=sanity_checks,
    points=points, links=lambda p: two_arms_and_target_links(3),
    uses=("positions of the joints", "the Jacobian of the end, and of the direction: a row of ones"),
    ablations={"a fourth joint": "it would leave one freedom, and a whole curve of answers",
               "masses": "inverse kinematics asks for a position, not for a velocity"},
)
