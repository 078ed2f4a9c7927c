"""A bob is released with its string horizontal: projection keeps the length of the string, but loses energy."""

from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import BadInput
from solutions.given.pbd import make_constraint_network
from validate.check import states
from validate.engines.mujoco import chain as mujoco_chain
from validate.engines.pbd import ITERATIONS, SHARE, bullet_rope, pymunk_rope
from validate.methods import COMPOSED_ROPE, PBD, PROJECTION, RATTLE, RK4, ROPE, SYMPLECTIC_EULER, XPBD
from validate.reference.pbd import (
    Rope,
    RopeMotion,
    bullet_bob,
    chipmunk_rope,
    composed_rope,
    onto_circle,
    pendulum_angle,
    pendulum_period,
    rattle,
    rattle_once,
)
from validate.reference.schemes import Motion
from validate.scene import MUJOCO, PYBULLET, PYMUNK, Departure, Prediction, Scene, by_order, engine, ours
from validate.scenes._common import ONE_LINK, check_positives, floor_of
from validate.scenes.pbd._common import in_space

T = 1.5                      # [s]: the bob has passed the lowest point and nearly reached its turning point
STEPS = (100, 200, 500, 1000, 2000, 5000, 10000)
SMALL = 1e-14                # moment of MuJoCo's bob over mL², because MuJoCo permits no bob without a moment [-]


class Params(NamedTuple):
    degrees: Annotated[float, "released at rest, at this angle from straight down [°]"] = 90.0
    L: Annotated[float, "length [m]"] = 1.0
    m: Annotated[float, "mass [kg]"] = 1.0
    g: Annotated[float, "gravity [m/s²]"] = 9.81


CASES = {"from horizontal": Params(), "from 170°": Params(degrees=170.0)}


def place(theta, p):
    return p.L * np.array([np.sin(theta), -np.cos(theta)])


def start(p):
    check_positives(p, "L", "m", "g")
    if not 0.0 < p.degrees < 180.0:
        raise BadInput("the initial angle [°]", p.degrees, "give a number between 0 and 180")
    x = np.stack((np.zeros(2), place(np.radians(p.degrees), p)))
    return x, np.zeros((2, 2)), make_constraint_network(x, p.m, [0], [(0, 1)], 0.0, 1.0, (0.0, -p.g), 1)


def run(lessons, step, acceleration, state, p, dt, steps):
    x, v, network = state
    return *lessons.integrators.advance(step, acceleration, 0.0, x, v, dt, steps, network), network


def observe(state, p):
    return state[0][1, :2]


def truth(p, t):
    """sin ½θ = k cd(√(g/L) t, k),  k = sin ½θ₀;  the bob is at L (sin θ, −cos θ).

    Source: Landau and Lifshitz, Mechanics, § 11.
    """
    return place(pendulum_angle(np.radians(p.degrees), p.L, p.g, t), p)


def with_inertia(p, t):
    """Return the position of a bob whose moment I about itself rotates with the string.

    It falls as if gravity were g/(1 + I/mL²).
    """
    return place(pendulum_angle(np.radians(p.degrees), p.L, p.g / (1.0 + SHARE), t), p)


def limits(p, dt):
    """The fastest rates are √(g/L) and the rotation, whose square is at most 2g(1 − cos θ₀)/L.

    With one link PBD, XPBD without compliance and the projection method are identical, of order 1; RATTLE is of
    order 2.  pymunk is symplectic Euler along the circle and corrects at once the ½ω²dt² L that a step leaves.
    pybullet does the same, with erp 1.  Both are of order 1, but pymunk moves the bob before it pulls.  The coordinate
    of MuJoCo is the angle, which cannot open a joint: a table of coefficients, applied to it, predicts the error.
    """
    return by_order(np.sqrt(p.g / p.L) + np.sqrt(2.0 * p.g / p.L * (1.0 - np.cos(np.radians(p.degrees)))), T, dt)


def rope(p):
    return Rope(np.stack((np.zeros(2), place(np.radians(p.degrees), p))), p.L, p.g)


def swinging(p):
    """Return θ̈(t, θ, ω), θ from straight down."""
    return lambda t, theta, omega: -p.g / p.L * np.sin(theta)


BOB = RopeMotion(T, rope, lambda x: x[1], truth, floor_of(limits))
ANGLE = Motion(T, swinging, lambda p: (np.radians(p.degrees), 0.0), place, truth, floor_of(limits))


def bullet_error(p, dt):
    """pybullet's bob moves by symplectic Euler, and in each step its joint closes the gap that the last step has
    opened.  The prediction is this step, written out.  Sweeps and round-off leave 1e-15 of a velocity, which grows
    as a pendulum's errors do.
    """
    bob = place(np.radians(p.degrees), p)
    error = bullet_bob(bob, p.m, SHARE * p.m * p.L**2, p.g, dt, round(T / dt)) - with_inertia(p, T)
    return Prediction(error, 1e-11) if np.linalg.norm(error) < 0.1 * p.L else None


def pymunk_make(p, dt):
    return pymunk_rope([place(np.radians(p.degrees), p)], p.L, p.m, p.g, dt, lambda x: x[0], 1)


def pybullet_make(p, dt):
    return bullet_rope([place(np.radians(p.degrees), p)], p.m, p.g, SHARE * p.m * p.L**2, dt, lambda x: x[0])


def mujoco_make(p, dt, integrator="RK4"):
    string = np.stack((np.zeros(2), place(np.radians(p.degrees), p)))
    return mujoco_chain(string, p.m, SMALL * p.m * p.L**2, 1.0, p.g, dt,
                        lambda angles: p.L * np.array([np.cos(angles[0]), np.sin(angles[0])]), integrator)


RUNNERS = (
    ours(PROJECTION, limit=limits, predicted=BOB.predict(onto_circle, 1), most_in_quick=2000),
    ours(PBD, limit=limits, predicted=BOB.predict(onto_circle, 1)),
    ours(XPBD, limit=limits, predicted=BOB.predict(onto_circle, 1), in_quick=False),     # on one rigid link it is PBD
    ours(RATTLE, limit=limits, predicted=BOB.predict(rattle, 2)),
    ours(ROPE, limit=limits, predicted=BOB.predict(rattle_once, 2)),
    ours(COMPOSED_ROPE, limit=limits, predicted=BOB.predict(composed_rope, 4)),
    engine(PYMUNK, "", pymunk_make, "PinJoint to a mass that cannot turn; error_bias 0, 1 iteration: it has one link",
           order=1, limit=limits, predicted=BOB.predict(chipmunk_rope, 1), finer_in_full=(20_000, 50_000)),
    engine(PYBULLET, "", pybullet_make,
           f"JOINT_POINT2POINT, useMaximalCoordinates=1, erp 1, {10 * ITERATIONS} iterations; a bob with I = {SHARE} "
           "mL²; a step without gravity beforehand, after which moments count",
           order=1, limit=limits, predicted=bullet_error,
           departure=Departure(
               f"its solver, which sweeps over three axes, needs a bob with a moment of inertia. It has {SHARE} mL² "
               f"and rotates with the string, so it falls as if gravity were g/{1.0 + SHARE:g}", with_inertia)),
    engine(MUJOCO, "", mujoco_make, "hinge; Runge–Kutta 4",
           order=4, limit=limits, predicted=ANGLE.predict(RK4.table), most_steps=5000),
    engine(MUJOCO, "default", partial(mujoco_make, integrator="Euler"), "hinge; the semi-implicit Euler step",
           order=1, limit=limits, predicted=ANGLE.predict(SYMPLECTIC_EULER.table), most_steps=5000),
)


def sanity_checks():
    """Return Findings about the reference solution."""
    high = CASES["from 170°"]
    period = pendulum_period(np.radians(170.0), high.L, high.g)
    return (
        states("period from horizontal [s]", pendulum_period(0.5 * np.pi, 1.0, 9.81), 2.367841948, 5e-10),
        states("period from 170° [s]", pendulum_period(np.radians(170.0), 1.0, 9.81), 4.893524274, 5e-10),
        states("position one period later [m]", truth(high, period), truth(high, 0.0), 1e-13),
    )


def points(observed, p):
    return np.stack((np.zeros(2), observed))


SCENE = Scene(
    title="Pendulum", lesson="pbd",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: lessons.pbd.network_gravity, start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-14,
    published_states=(
        (0.0, (1.0, 0.0), 1e-15),
        (10.0, (0.275087463, -0.961419205), 5e-10),
        (2.367841948, (1.0, 0.0), 5e-9),
    ),
    sanity_checks=sanity_checks,
    points=points, links=ONE_LINK,
    uses=("two coordinates", "one link", "one step function"),
    ablations={
        "the third dimension": in_space(start),
        "rotation of the bob": "the whole loop of lesson 10 has it, and is measured",
    },
)
