"""A bob is released with its string horizontal: projection keeps the length of the string, but loses energy."""

from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import BadInput
from solutions.given.pbd import make_constraint_network
from validate.check import states
from validate.engines.bullet import HINGES
from validate.methods import COMPOSED_ROPE, IN_ANGLE, PBD, PROJECTION, RATTLE, RK4, ROPE, SYMPLECTIC_EULER, XPBD
from validate.reference.integrators import EVEN
from validate.reference.pbd import (
    Rope,
    RopeMotion,
    chipmunk_rope,
    composed_rope,
    onto_circle,
    pendulum_angle,
    pendulum_period,
    rattle,
    rattle_once,
)
from validate.reference.schemes import Motion
from validate.scene import MUJOCO, PYBULLET, PYMUNK, Scene, by_order, engine, in_substeps, ours
from validate.scenes._common import ONE_LINK, built, check_positives, floor_of
from validate.scenes.pbd._common import in_space, on_hinges, on_strings

T = 1.5                      # [s]: the bob has passed the lowest point and nearly reached its turning point
STEPS = (100, 200, 500, 1000, 2000, 5000, 10000)


class Params(NamedTuple):
    degrees: Annotated[float, "released at rest, at this angle from straight down [°]"] = 90.0
    L: Annotated[float, "length [m]"] = 1.0
    m: Annotated[float, "mass [kg]"] = 1.0
    g: Annotated[float, "gravity [m/s²]"] = 9.81


CASES = {"from horizontal": Params(), "from 170°": Params(degrees=170.0)}


def place(theta, p):
    return p.L * np.array([np.sin(theta), -np.cos(theta)])


def start(p):
    """Return (x, v) of both ends of the string, the network, and (angle, rate) of the same bob."""
    check_positives(p, "L", "m", "g")
    if not 0.0 < p.degrees < 180.0:
        raise BadInput("the initial angle [°]", p.degrees, "give a number between 0 and 180")
    theta = np.radians([p.degrees])
    x = np.stack((np.zeros(2), place(theta[0], p)))
    network = make_constraint_network(x, p.m, [0], [(0, 1)], 0.0, 1.0, (0.0, -p.g), 1)
    return x, np.zeros((2, 2)), network, theta, np.zeros(1)


def swings(t, theta, omega, p):
    """Return θ̈ = −g/L sin θ, θ from straight down."""
    return -p.g / p.L * np.sin(theta)


def run(lessons, step, acceleration, state, p, dt, steps):
    """Move the ends of the string; of a method that moves the angle, they are None."""
    x, v, network, theta, omega = state
    advance = lessons.integrators.advance
    if step is lessons.integrators.rk4_step:
        return None, v, network, *advance(step, acceleration, 0.0, theta, omega, dt, steps, p)
    return *advance(step, lessons.pbd.network_gravity, 0.0, x, v, dt, steps, network), network, theta, omega


def observe(state, p):
    x, _, _, theta, _ = state
    return place(theta[0], p) if x is None else x[1, :2]


def truth(p, t):
    """sin ½θ = k cd(√(g/L) t, k),  k = sin ½θ₀;  the bob is at L (sin θ, −cos θ).

    Source: Landau and Lifshitz, Mechanics, § 11.
    """
    return place(pendulum_angle(np.radians(p.degrees), p.L, p.g, t), p)


def limits(p, dt):
    """The fastest rates are √(g/L) and the rotation, whose square is at most 2g(1 − cos θ₀)/L.

    With one link PBD, XPBD without compliance and the projection method are identical, of order 1; RATTLE is of
    order 2.  pymunk is symplectic Euler along the circle and corrects at once the ½ω²dt² L that a step leaves.
    The coordinate of our Runge–Kutta 4, of pybullet's hinge and of MuJoCo is the angle, which cannot leave a joint
    open: a table of coefficients, applied to it, predicts the error.
    """
    return by_order(np.sqrt(p.g / p.L) + np.sqrt(2.0 * p.g / p.L * (1.0 - np.cos(np.radians(p.degrees)))), T, dt)


def rope(p):
    return Rope(np.stack((np.zeros(2), place(np.radians(p.degrees), p))), p.L, p.g)


BOB = RopeMotion(T, rope, lambda x: x[1], truth, floor_of(limits))
ANGLE = Motion(T, lambda p: partial(swings, p=p), lambda p: (np.radians(p.degrees), 0.0), place, truth,
               floor_of(limits))


def model(p):
    """Make the bob on a rod without mass."""
    return on_strings([place(np.radians(p.degrees), p)], p.m, p.g)


def hinged(p):
    return on_hinges([place(np.radians(p.degrees), p)], p.m, p.g)


def read(state, p):
    return state.x[0]


def at_first(p):
    """Return the accelerations (1, 2), (1,) of the bob on its hinge when it is released."""
    return np.zeros((1, 2)), np.array([swings(0.0, np.radians(p.degrees), 0.0, p)])


in_reduced = partial(built, PYBULLET, hinged, read, maximal=False)
LEAPING = engine(PYBULLET, "leapfrog start", in_reduced(accelerations=at_first), f"{HINGES}; first rate − ½ θ̈ dt",
                 order=2, limit=limits, predicted=ANGLE.predict(SYMPLECTIC_EULER.table, ahead=-0.5, powers=EVEN[2]))
RUNNERS = (
    ours(PROJECTION, limit=limits, predicted=BOB.predict(onto_circle, 1), most_in_quick=2000),
    ours(PBD, limit=limits, predicted=BOB.predict(onto_circle, 1)),
    ours(XPBD, limit=limits, predicted=BOB.predict(onto_circle, 1), in_quick=False),     # on one rigid link it is PBD
    ours(RATTLE, limit=limits, predicted=BOB.predict(rattle, 2)),
    ours(ROPE, limit=limits, predicted=BOB.predict(rattle_once, 2)),
    ours(COMPOSED_ROPE, limit=limits, predicted=BOB.predict(composed_rope, 4)),
    ours(IN_ANGLE, limit=limits, predicted=ANGLE.predict(RK4.table)),
    engine(PYMUNK, "", built(PYMUNK, model, read, iterations=1),
           "PinJoint to a mass that cannot turn; error_bias 0, 1 iteration: it has one link",
           order=1, limit=limits, predicted=BOB.predict(chipmunk_rope, 1), finer_in_full=(20_000, 50_000)),
    engine(PYMUNK, "leapfrog start", built(PYMUNK, model, read, iterations=1, ahead=0.5),
           "the same, first velocity + ½ g dt", order=2, limit=limits, predicted=BOB.predict(chipmunk_rope, 2, 0.5)),
    engine(PYBULLET, "", in_reduced(), HINGES,
           order=1, limit=limits, predicted=ANGLE.predict(SYMPLECTIC_EULER.table)),
    LEAPING,
    in_substeps(LEAPING, 10),
    engine(MUJOCO, "", built(MUJOCO, hinged, read), "hinge; Runge–Kutta 4",
           order=4, limit=limits, predicted=ANGLE.predict(RK4.table), most_steps=5000),
    engine(MUJOCO, "leapfrog start", built(MUJOCO, hinged, read, integrator="Euler", ahead=0.5),
           "hinge; Euler, first rate − ½ θ̈ dt", order=2, limit=limits, most_steps=5000,
           predicted=ANGLE.predict(SYMPLECTIC_EULER.table, ahead=-0.5, powers=EVEN[2])),
    engine(MUJOCO, "default", built(MUJOCO, hinged, read, integrator="Euler"),
           "hinge; the semi-implicit Euler step",
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
    acceleration=lambda lessons: swings, start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-14, model=model, read=read,
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
        "rotation of the bob": "the whole loop of lesson 10 has it, and a full run measures it",
    },
)
