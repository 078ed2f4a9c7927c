"""Bricard's mechanism: five rods on six hinges in space.  By counting constraints it could not move, and yet it does.

Each hinge is made of two ball joints on its axis, so that 36 rows hold 30 coordinates.  Rows depend on each other in
every position.  Our joints take the shortest impulses of all that move the bodies alike.
"""

from typing import Annotated, NamedTuple

import numpy as np

from solutions.support.model import WORLD, Body, Hinge, make_model
from validate.check import states
from validate.engines import watched
from validate.methods import JOINTS_IN_SPACE
from validate.reference.exams import bricard_angle, predict_bricard
from validate.reference.mechanisms import AXES, CUBE, bricard, bricard_motion, bricard_state
from validate.scene import MUJOCO, PYBULLET, Scene, by_order, engine, no_limit, ours
from validate.scenes._common import built, check_positives, constantly
from validate.scenes.drawing import seen
from validate.scenes.exams import iftomm
from validate.scenes.simulator._common import joined_3d, watched_joints

T = 0.5                      # [s]
STEPS = (10, 20, 50, 100, 200, 500, 1000)
WHOLE = 10.0                 # how long the published problem lasts [s]
UNCERTAINTY = 1e-10          # of the truth: DOP853 at 1e-12


class Params(NamedTuple):
    g: Annotated[float, "gravity, along −y [m/s²]"] = 9.81


CASES = {"from the cube": Params()}


def start(p):
    check_positives(p, "g")
    return joined_3d(bricard(), (0.0, -p.g, 0.0))


def run(lessons, step, acceleration, state, p, dt, steps):
    return *lessons.simulator.advance_free(step, acceleration, 0.0, *state[:4], dt, steps, state[4]), state[4]


def observe(state, p):
    return state[0][:5].ravel()


def truth(p, t):
    """Centres of the five rods, from one angle ψ: tan ½θ = √3 cos ψ, sin ½φ = ½√3 sin ψ, and hinges turn by θ and φ.

    Lagrange's equation for ψ, with derivatives by complex steps, by DOP853 at 1e-12.
    """
    return bricard_state(bricard_angle(p.g, T if t <= T else WHOLE)(t)[0])[0].ravel()


def limits(p, dt):
    """An independent program of the same step predicts the error; this limit judges only what that cannot predict."""
    return by_order(fastest(p), T, dt)


def fastest(p):
    """Return the rate [1/s] of a rod that has fallen by 1 m: ω² = 2 g/l, twice over for what others give it."""
    return np.sqrt(4.0 * p.g)


def floor(p, dt):
    """Each step closes joints to 1e-14 of their size."""
    return 10.0 * UNCERTAINTY + 1e-13 * T / dt


def model(p):
    """Return the Model for the engines: six hinges in space, of which one closes the loop."""
    made = bricard()
    rods = [Body(tuple(map(float, made.x[k])), 1.0, inertia=tuple(map(float, made.inertia[k]))) for k in range(5)]
    ends = [(0, WORLD), (0, 1), (1, 2), (2, 3), (3, 4), (4, WORLD)]
    hinges = [Hinge(a, b, tuple(map(float, CUBE[k])), tuple(map(float, AXES[k]))) for k, (a, b) in enumerate(ends)]
    return make_model(rods, (0.0, -p.g, 0.0), hinges)


def read(state, p):
    return state.x[:5].ravel()


DEPENDENT = "its sweeps over rows that depend on each other end before they agree"
HINGES = watched_joints(model, fastest)
RUNNERS = (
    ours(JOINTS_IN_SPACE, limit=limits, predicted=predict_bricard(T, truth, floor), in_quick=False),
    engine(PYBULLET, "", built(PYBULLET, model, read, HINGES, erp=0.2, iterations=500),
           "two points for each hinge, maximal coordinates, erp 0.2, 500 iterations",
           order=1, limit=no_limit, predicted=DEPENDENT, laws=watched.sweeps_over_joints(DEPENDENT), most_in_quick=50),
    engine(MUJOCO, "", built(MUJOCO, model, read, HINGES), "hinges as coordinates, one of them closed by `connect`",
           order=1, limit=no_limit, predicted="the hinge that closes the loop is a spring with a damper",
           laws=watched.SOFT_LOOPS, most_in_quick=50),
)

EXAM = iftomm(
    "A04, Bricard's mechanism",
    "Five rods of 1 m and 1 kg lie along edges of a cube, on six hinges of which the ground holds two, and fall under "
    "gravity. Counting constraints gives no freedom, and yet the mechanism has one.",
    WHOLE, 100, (1000, 2000, 5000, 10_000, 50_000),
    {JOINTS_IN_SPACE: "the unique forces of the hinges: of all that move the rods alike it takes the shortest",
     PYBULLET: "closed hinges, as far as its sweeps leave them",
     MUJOCO: "a rigid loop: the hinge that closes it is a spring with a damper"},
    note="Its outputs are not at hand: here the centres of all rods are judged, 100 times, against the derived "
         "equation of one angle.")


def sanity_checks():
    """Return Findings about the truth: another file's solution, and the energy."""
    p = CASES["from the cube"]
    x, psi, rate = bricard_motion(p.g, T)
    _, v, w = bricard_state(psi)
    moments = bricard().inertia[:5]
    first = p.g * np.sum(bricard_state(np.arctan(np.sqrt(2.0)))[0][:, 1])
    energy = 0.5 * rate**2 * (np.sum(v * v) + np.sum(moments * w * w)) + p.g * np.sum(x[:, 1])
    return (states("centres at T, by another file [m]", truth(p, T), x.ravel(), 1e-9),
            states("energy gained until T [J]", energy - first, 0.0, 1e-8),
            states("centres at the start, in the middles of edges of the cube [m]", truth(p, 0.0),
                   bricard().x[:5].ravel(), 1e-14))


# ---------------------------------------------------------------------------------------------- picture

def points(observed, p):
    """Draw the corners: the first is fixed, and each centre is halfway to the next one."""
    corners = [CUBE[0]]
    for centre in np.reshape(observed, (5, 3)):
        corners.append(2.0 * centre - corners[-1])
    return np.round(seen(np.array(corners)[:, [2, 0, 1]]), 5)


SCENE = Scene(
    title="Bricard's mechanism", lesson="simulator",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: lessons.simulator.weight, start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=UNCERTAINTY,
    omitted_methods="pymunk is an engine of the plane",
    sanity_checks=sanity_checks,
    points=points, links=constantly([(0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 0)]),
    uses=("bodies that turn in space", "one matrix for all joints, whose rows depend on each other", "no detection"),
    ablations={"contact of the rods": "real ones would meet at last; the loop with joints of this lesson finds it"},
    exam=EXAM,
)
