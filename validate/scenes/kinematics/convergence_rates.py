"""Convergence near the target: the factor of each direction follows from its singular value.

An arm of three links near its target is displaced slightly along one direction of its Jacobian.  After one iteration
the ratio of the errors is 1 − ασ² for the transpose, λ²/(σ² + λ²) for the damped step, and 0 for the pseudo-inverse.
With λ² = ½ m² the damped step is that of pybullet.
"""

from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.kinematics import make_arm_2d
from validate.check import states
from validate.engines.kinematics import bullet_reach
from validate.methods import DAMPED, FACTORS, PSEUDO_INVERSE, TRANSPOSE
from validate.reference.kinematics import bullet_ik, end_of, jacobian_of, joints_of, searched
from validate.scene import EXACT, PYBULLET, ROUND_OFF, Prediction, Scene, engine, ours
from validate.scenes._common import ANSWER, cases_with, check_positives
from validate.scenes.drawing import circle, outlines

T = 1.0
MOVED = 1e-5                 # along a direction, to either side [rad]
ANGLES = np.array([0.4, 0.9, 0.7])


class Params(NamedTuple):
    kind: Annotated[str, "which method"] = "damped"
    setting: Annotated[float, "λ² [m²] of the damped step, or α σ₁² [-] of the transpose"] = 0.5
    l_1: Annotated[float, "length of the first link [m]"] = 1.0
    l_2: Annotated[float, "length of the second link [m]"] = 0.7
    l_3: Annotated[float, "length of the third link [m]"] = 0.4


CASES = {
    "damped, λ² = ½ m²": Params(), "damped, λ² = 0.01 m²": Params(setting=0.01),
    "transpose, α = 1/σ₁²": Params("transpose", 1.0), "transpose, α = 1.9/σ₁²": Params("transpose", 1.9),
    "pseudo-inverse": Params("pseudo-inverse", 0.0),
    "damped, λ² = ½ m², 10 cm each": Params("damped", 0.5, 0.1, 0.1, 0.1),
}


def lengths_of(p):
    return np.array([p.l_1, p.l_2, p.l_3])


def directions(p):
    """Return (u (2, 2), σ (2,), v (2, 3)) of the arm at its target."""
    return np.linalg.svd(jacobian_of(ANGLES, lengths_of(p)), full_matrices=False)


def start(p):
    """Return angles beside those of the target: ahead and behind along each direction."""
    check_positives(p, "l_1", "l_2", "l_3")
    v = directions(p)[2]
    return tuple(ANGLES + sign * MOVED * v[i] for i in (0, 1) for sign in (1.0, -1.0))


def settings(p):
    """Return (gain [1/m²], damping [m])."""
    if p.kind == "transpose":
        return p.setting / directions(p)[1][0] ** 2, 0.0
    return 0.0, np.sqrt(p.setting)


# ---------------------------------------------------------------------------------------------- ours

def run(lessons, step, acceleration, state, p, dt, steps):
    kinematics = lessons.kinematics
    if step is kinematics.contraction_factors:
        return tuple(step(directions(p)[1], *settings(p)))
    target = end_of(ANGLES, lengths_of(p))
    return tuple(kinematics.advance_reach(step, kinematics.reach_2d, theta, target, 1, arm_of(p)) for theta in state)


def arm_of(p):
    gain, damping = settings(p)
    return make_arm_2d(lengths_of(p), gain, damping, -np.inf, np.inf, 0.0, 0.0)


def observe(state, p):
    """Return the share of an error that remains along each direction; of the lesson's factors, those of the method."""
    if len(state) == 2:
        return np.asarray(state[0 if p.kind == "transpose" else 1])
    u, sigma, _ = directions(p)
    ends = [end_of(theta, lengths_of(p)) for theta in state]
    return np.array([u[:, i] @ (ends[2 * i] - ends[2 * i + 1]) / (2.0 * MOVED * sigma[i]) for i in (0, 1)])


def truth(p, t):
    """e ← (1 − J P) e with the P of the method:  1 − ασ²,  λ²/(σ² + λ²),  or 0.

    Source: the singular value decomposition of J.
    """
    sigma = directions(p)[1]
    if p.kind == "transpose":
        return 1.0 - p.setting * (sigma / sigma[0]) ** 2
    return p.setting / (sigma**2 + p.setting)


def limit(p, dt):
    """A central difference is off by δ²/6 times a third derivative, over σ₂.  The third derivative of the end is at
    most 3√3 reach along a direction of size 1, and that of the step is at most (1 + reach/σ₂)² times as large.  A
    rounding error of the end over 2 δ σ₂ is added.
    """
    sigma, reach = directions(p)[1][1], p.l_1 + p.l_2 + p.l_3
    lost = 0.87 * reach / sigma * (MOVED * (1.0 + reach / sigma)) ** 2 + 2.0 * ROUND_OFF * reach / (MOVED * sigma)
    return lost / size(p)


def formula_limit(p, dt):
    """The closed form of the factors has a few rounding errors."""
    return 20.0 * ROUND_OFF / size(p)


def size(p):
    return np.linalg.norm(truth(p, T)) or 1.0


def our_error(p, dt, step):
    """The prediction takes the same difference of the same iteration, by complex numbers and other equations than the
    lesson's.  What is left is a rounding error of the end, in both, over 2 δ σ₂.
    """
    target, settled = end_of(ANGLES, lengths_of(p)), settings(p)
    return predicted([searched(step, theta, target, lengths_of(p), 0.0, 1, *settled)[0] for theta in start(p)], p)


def bullet_error(p, dt):
    target = end_of(ANGLES, lengths_of(p))
    found = [bullet_ik(theta, target, lengths_of(p), damping=p.setting, iterations=1) for theta in start(p)]
    return predicted(found, p)


def predicted(found, p):
    rounded = 2.0 * ROUND_OFF * sum(lengths_of(p)) / (MOVED * directions(p)[1][1])
    return Prediction(observe(found, p) - truth(p, T), rounded / size(p))


# ---------------------------------------------------------------------------------------------- engine

def pybullet_make(p, dt):
    target = end_of(ANGLES, lengths_of(p))
    return bullet_reach(lengths_of(p), start(p), lambda found: observe(found, p), target, iterations=1)


def of_kind(kind):
    """Return the function (p) → bool: each case belongs to one method."""
    return cases_with("kind", (kind,), CASES)


def has_factors(p):
    """Return whether the case is one of the two methods that do not end after one iteration: only they have factors."""
    return p.kind != "pseudo-inverse"


def as_pybullet(p):
    """Return whether the damping is that of pybullet, ½ m²."""
    return p.kind == "damped" and p.setting == 0.5


RUNNERS = (
    ours(FACTORS, order=EXACT, limit=formula_limit, supports=has_factors,
         predicted="a formula: only round-off is left"),
    *(ours(m, order=EXACT, limit=limit, supports=of_kind(kind), predicted=partial(our_error, step=m.table))
      for m, kind in ((TRANSPOSE, "transpose"), (DAMPED, "damped"), (PSEUDO_INVERSE, "pseudo-inverse"))),
    engine(PYBULLET, "", pybullet_make, "calculateInverseKinematics, maxNumIterations 1",
           order=EXACT, limit=limit, supports=as_pybullet, predicted=bullet_error),
)


def quantity_names(p):
    return [f"factor along the {which} axis, σ = {sigma:.4f} m [-]"
            for which, sigma in zip(("long", "short"), directions(p)[1])]


def sanity_checks():
    """Return Findings: σ as half axes of the ellipse of velocities, found by sampling directions."""
    around = np.linspace(0.0, np.pi, 20001)
    found, expected = [], []
    for p in CASES.values():
        J = jacobian_of(ANGLES, lengths_of(p))
        widths = np.linalg.norm(np.stack((np.cos(around), np.sin(around)), axis=1) @ J, axis=1)
        found, expected = [*found, widths.max(), widths.min()], [*expected, *directions(p)[1]]
    return (states("largest and smallest width of the ellipse, half [m]", found, np.array(expected), 1e-7),)


# ---------------------------------------------------------------------------------------------- picture

def points(observed, p):
    """Draw the arm, and the ellipse of velocities at its end, at a quarter of its size."""
    arm = joints_of(ANGLES, lengths_of(p))
    u, sigma, _ = directions(p)
    ring = arm[-1] + 0.25 * circle(40) * sigma @ u.T
    return np.round(np.concatenate((arm, ring)), 5)


def links(p):
    return [(0, 1), (1, 2), (2, 3), *outlines(40, 1, 4)]


SCENE = Scene(
    title="Rates of convergence", lesson="kinematics", **ANSWER, cases=CASES, runners=RUNNERS,
    start=start, run=run, observe=observe, truth=truth, truth_uncertainty=1e-15,
    omitted_methods="CCD and FABRIK have no factor that follows from J alone; pymunk has no inverse kinematics",
    quantity_names=quantity_names,
    sanity_checks=sanity_checks,
    points=points, links=links,
    uses=("the Jacobian of the end", "one iteration of each method"),
    ablations={"more iterations": "each multiplies by the same factors, as long as the error is small"},
)
