"""The target is out of reach: the best answer is the nearest point of a ring.

An arm reaches a ring around its base.  The outer radius is the length of all links together; the inner radius is the
excess of the longest link over the others.  At both edges the arm is straight, so its Jacobian is singular.  Small
damping then makes a search oscillate, and the pseudo-inverse never comes to rest.
"""

from typing import Annotated, NamedTuple

import numpy as np

from solutions.kinematics import make_arm_2d
from validate.check import Whose, states
from validate.engines.kinematics import bullet_reach
from validate.methods import CCD, DAMPED, FABRIK, PSEUDO_INVERSE, TRANSPOSE
from validate.reference.kinematics import annulus, bullet_ik, end_of, joints_of, nearest_reachable
from validate.scene import EXACT, PYBULLET, ROUND_OFF, Departure, Scene, engine, ours
from validate.scenes._common import ANSWER, check_positives, constantly
from validate.scenes.drawing import circle, outlines

ITERATIONS = 3000            # of each method
BENT = 0.5                   # all angles at the start [rad]


class Params(NamedTuple):
    l_1: Annotated[float, "length of the first link [m]"] = 1.0
    l_2: Annotated[float, "length of the second link [m]"] = 0.7
    l_3: Annotated[float, "length of the third link [m]"] = 0.4
    x: Annotated[float, "target [m]"] = -3.0
    y: Annotated[float, "target [m]"] = 1.5


CASES = {
    "far outside": Params(), "just outside": Params(x=1.4, y=1.8),
    "in the hole": Params(3.0, 1.0, 1.0, 0.3, 0.25), "10 cm each": Params(0.1, 0.1, 0.1, 0.4, 0.3),
}


def lengths_of(p):
    return np.array([p.l_1, p.l_2, p.l_3])


def target_of(p):
    return np.array([p.x, p.y])


def missing(p):
    """Return the distance [m] from the target to the ring."""
    return np.linalg.norm(nearest_reachable(target_of(p), lengths_of(p)) - target_of(p))


def start(p):
    check_positives(p, "l_1", "l_2", "l_3")
    return (np.full(3, BENT),)


# ---------------------------------------------------------------------------------------------- ours

def run(lessons, step, acceleration, state, p, dt, steps):
    kinematics = lessons.kinematics
    return (kinematics.advance_reach(step, kinematics.reach_2d, state[0], target_of(p), ITERATIONS, arm_of(p)),)


def arm_of(p):
    gain, damping = settings(p)
    return make_arm_2d(lengths_of(p), gain, damping, -np.inf, np.inf, 0.0, 0.0)


def settings(p):
    """Return (gain [1/m²], damping [m]) with which both methods come to rest: see `limit`."""
    size, left = sum(lengths_of(p)), missing(p)
    return 1.0 / (3.0 * size * (size + left)), np.sqrt(1.5 * size * left)


def observe(state, p):
    """Return the distance from the end to the target, and the end [m]."""
    end = end_of(state[0], lengths_of(p))
    return np.append(np.linalg.norm(target_of(p) - end), end)


def truth(p, t):
    """The ring is  l_long − the others ≤ r ≤ Σ l.  Its point nearest to the target lies on the ray through the target.

    Source: the triangle inequality.
    """
    end = nearest_reachable(target_of(p), lengths_of(p))
    return np.append(np.linalg.norm(target_of(p) - end), end)


def limit(p, dt):
    """½|e|² has the second derivatives  H = JᵀJ + S,  S_ik = −e · ∂²x/∂θ_i∂θ_k,  and |S| ≤ 3 |e| reach.  The gain is
    below 1/|H|.  A damped step multiplies small errors by  1 − (JᵀJ + λ²)⁻¹ H,  whose size is below 1 for λ² > ½|S|,
    and here λ² = ½ · 3 |e| reach.  So both come to rest, and after 3,000 iterations only round-off is left: some dozen
    rounding errors of the angles, which move the end.
    """
    return 50.0 * ROUND_OFF


def measured_limit(p, dt):
    """CCD and FABRIK have no such theory here, and by default pybullet follows its own law.  The limit is ten times
    what they err by.
    """
    return 2e-14


# ---------------------------------------------------------------------------------------------- engine

def pybullet_make(p, dt, **more):
    return bullet_reach(lengths_of(p), start(p), lambda found: observe(found, p), target_of(p), **more)


def as_our_damping(p, dt):
    return pybullet_make(p, dt, damping=settings(p)[1] ** 2, iterations=ITERATIONS)


def default_law(p, t):
    return observe([bullet_ik(start(p)[0], target_of(p), lengths_of(p))], p)


def too_slow(p):
    """The transpose goes down valleys too slowly for the hole and for what is just outside."""
    return "" if p in (CASES["far outside"], CASES["10 cm each"]) else f"it needs more than {ITERATIONS:,} iterations"


def never_at_rest(p):
    return ("at the edge of the ring all links are in one line, where its steps are large: it still jumps about when "
            "its iterations end")


AT_REST = {"order": EXACT, "limit": limit, "predicted": "it is at rest, and nothing but roundings is left"}
MEASURED = "ten times the largest error of CCD, FABRIK and pybullet's default search in the four cases"
NO_THEORY = {"order": EXACT, "limit": measured_limit, "measured": MEASURED,
             "predicted": "no theory says how soon it comes to rest here"}

RUNNERS = (
    ours(DAMPED, **AT_REST),
    ours(CCD, **NO_THEORY),
    ours(FABRIK, **NO_THEORY),
    ours(TRANSPOSE, unfinished=too_slow, **AT_REST),
    ours(PSEUDO_INVERSE, unfinished=never_at_rest, **AT_REST),
    engine(PYBULLET, "", as_our_damping, "jointDamping as our λ², 3,000 iterations", **AT_REST),
    engine(PYBULLET, "default", pybullet_make, "calculateInverseKinematics as it is",
           order=EXACT, limit=measured_limit, measured=MEASURED,
           predicted="its own law is its search, which leaves nothing but roundings",
           departure=Departure("its damping is ½ m² for an arm of any size at any distance, and it stops after 20 "
                               "iterations", default_law, Whose.DEFAULT)),
)


def sanity_checks():
    """Return Findings: no angles on a fine grid come closer to the target than the ring."""
    near = []
    for p in CASES.values():
        grid = np.linspace(0.0, 2.0 * np.pi, 121)
        inner, outer = annulus(lengths_of(p))
        bend, wrist = np.meshgrid(grid, grid)
        r = np.abs(p.l_1 + np.exp(1j * bend) * (p.l_2 + p.l_3 * np.exp(1j * wrist)))
        near += [abs(r.min() - inner) / outer, abs(r.max() - outer) / outer]
    return (states("edges of the ring on a grid of angles, over the reach [-]", near, 0.0, 2e-3),)


# ---------------------------------------------------------------------------------------------- picture

def points(observed, p):
    """Draw the arm, straight towards the nearest point, the missing distance, and both edges of the ring."""
    end, lengths = np.asarray(observed)[1:], lengths_of(p)
    inner, outer = annulus(lengths)
    bearing = np.arctan2(end[1], end[0])
    folded = np.array([bearing, np.pi if np.hypot(*end) < 0.5 * (inner + outer) else 0.0, 0.0])
    ring = [radius * circle(40) for radius in (outer, inner)]
    return np.round(np.concatenate((joints_of(folded, lengths), [target_of(p)], *ring)), 5)


def links(p):
    return [(k, k + 1) for k in range(4)] + outlines(40, 2, 5)


SCENE = Scene(
    title="Out of reach", lesson="kinematics", **ANSWER, cases=CASES, runners=RUNNERS,
    start=start, run=run, observe=observe, truth=truth, truth_uncertainty=1e-15,
    quantity_names=constantly(["distance that is left [m]", "end, x [m]", "end, y [m]"]),
    published_states=((1.0, (np.sqrt(11.25) - 2.1, -2.1 * 2.0 / np.sqrt(5.0), 2.1 / np.sqrt(5.0)), 1e-14),),
    sanity_checks=sanity_checks,
    points=points, links=links,
    uses=("positions of the joints", "the Jacobian of the end", "damping that fits the distance"),
    ablations={"limits of the joints": "they make the reach smaller, and its edge is then no circle"},
)
