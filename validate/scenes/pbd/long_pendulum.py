"""A pendulum swings twice, as a bob on a string and as an angle: what is left of the error is phase.

No method here changes the length of the string or the height of the swing for long.  Each is early or late by a little
in every swing, so that its error grows with time.  This page has the first two swings; the published benchmark lasts
2,000 s, or 844 swings, after which the order of a method decides.
"""

from typing import Annotated, NamedTuple

import numpy as np

from solutions.given.pbd import make_constraint_network
from validate.check import states
from validate.methods import BLANES_MOAN, COMPOSED_ROPE, RK4, ROPE, SYMPLECTIC_EULER
from validate.reference.integrators import EVEN
from validate.reference.pbd import (
    Rope,
    RopeMotion,
    chipmunk_rope,
    composed_rope,
    pendulum_angle,
    pendulum_period,
    rattle_once,
)
from validate.reference.schemes import Motion
from validate.scene import MUJOCO, PYBULLET, PYMUNK, Scene, by_order, engine, ours
from validate.scenes._common import ONE_LINK, built, check_positives, floor_of
from validate.scenes.exams import iftomm
from validate.scenes.pbd._common import on_hinges, on_strings

T = 5.0                      # [s]: two swings
STEPS = (100, 200, 300, 400, 1000, 4000, 10000)
WHOLE = 2000.0               # how long the published problem lasts [s]


class Params(NamedTuple):
    L: Annotated[float, "length, released at rest from horizontal [m]"] = 1.0
    m: Annotated[float, "mass [kg]"] = 1.0
    g: Annotated[float, "gravity [m/s²]"] = 9.81


CASES = {"from horizontal": Params()}


def place(theta, p):
    return p.L * np.array([np.sin(theta), -np.cos(theta)])


def start(p):
    """Return (x, v) of both ends of the string, the network, and (angle, rate) of the same bob; p."""
    check_positives(p, "L", "m", "g")
    x = np.stack((np.zeros(2), place(0.5 * np.pi, p)))
    network = make_constraint_network(x, p.m, [0], [(0, 1)], 0.0, 1.0, (0.0, -p.g), 1)
    return x, np.zeros((2, 2)), network, np.array([0.5 * np.pi]), np.zeros(1)


def swings(t, theta, omega, p):
    """Return θ̈ = −g/L sin θ, θ from straight down."""
    return -p.g / p.L * np.sin(theta)


def run(lessons, step, acceleration, state, p, dt, steps):
    """Move the ends of the string; of a method that moves the angle, they are None."""
    x, v, network, theta, omega = state
    advance = lessons.integrators.advance
    if step is lessons.integrators.blanes_moan_step or step is lessons.integrators.rk4_step:
        return None, v, network, *advance(step, acceleration, 0.0, theta, omega, dt, steps, p)
    return *advance(step, lessons.pbd.network_gravity, 0.0, x, v, dt, steps, network), network, theta, omega


def observe(state, p):
    x, _, _, theta, _ = state
    return place(theta[0], p) if x is None else x[1]


def truth(p, t):
    """sin ½θ = k cd(√(g/L) t, k),  k = sin 45°;  the bob is at L (sin θ, −cos θ).

    Source: Landau and Lifshitz, Mechanics, § 11.
    """
    return place(pendulum_angle(0.5 * np.pi, p.L, p.g, t), p)


def limits(p, dt):
    """The fastest rates are √(g/L) and the rotation, whose square is at most 2g/L.

    The string errs as an independent program of the same step does, and the angle as a table of coefficients applied to
    it.
    """
    return by_order((1.0 + np.sqrt(2.0)) * np.sqrt(p.g / p.L), T, dt)


BOB = RopeMotion(T, lambda p: Rope(np.stack((np.zeros(2), place(0.5 * np.pi, p))), p.L, p.g), lambda x: x[1], truth,
                 floor_of(limits))
ANGLE = Motion(T, lambda p: lambda t, theta, omega: -p.g / p.L * np.sin(theta), lambda p: (0.5 * np.pi, 0.0), place,
               truth, floor_of(limits))


def model(p):
    """Make the bob on a rod without mass."""
    return on_strings([place(0.5 * np.pi, p)], p.m, p.g)


def hinged(p):
    return on_hinges([place(0.5 * np.pi, p)], p.m, p.g)


def read(state, p):
    return state.x[0]


def at_first(p):
    """Return the accelerations (1, 2), (1,) of the bob on its hinge when it is released."""
    return np.zeros((1, 2)), np.array([-p.g / p.L])


RUNNERS = (
    ours(BLANES_MOAN, limit=limits, predicted=ANGLE.predict(BLANES_MOAN.table)),
    ours(RK4, limit=limits, predicted=ANGLE.predict(RK4.table)),
    ours(ROPE, limit=limits, predicted=BOB.predict(rattle_once, 2), most_in_quick=400),
    ours(COMPOSED_ROPE, limit=limits, predicted=BOB.predict(composed_rope, 4), most_in_quick=400),
    engine(PYMUNK, "", built(PYMUNK, model, read, iterations=1), "PinJoint; error_bias 0, 1 iteration",
           order=1, limit=limits, predicted=BOB.predict(chipmunk_rope, 1)),
    engine(PYMUNK, "leapfrog start", built(PYMUNK, model, read, iterations=1, ahead=0.5),
           "the same, first velocity + ½ g dt", order=2, limit=limits, predicted=BOB.predict(chipmunk_rope, 2, 0.5)),
    engine(PYBULLET, "", built(PYBULLET, hinged, read, maximal=False),
           "a link on a hinge, whose coordinate is the angle; no damping",
           order=1, limit=limits, predicted=ANGLE.predict(SYMPLECTIC_EULER.table)),
    engine(PYBULLET, "leapfrog start", built(PYBULLET, hinged, read, maximal=False, accelerations=at_first),
           "the same, first rate − ½ θ̈ dt",
           order=2, limit=limits, predicted=ANGLE.predict(SYMPLECTIC_EULER.table, ahead=-0.5, powers=EVEN[2])),
    engine(MUJOCO, "", built(MUJOCO, hinged, read), "hinge; Runge–Kutta 4",
           order=4, limit=limits, predicted=ANGLE.predict(RK4.table), most_steps=4000),
    engine(MUJOCO, "leapfrog start", built(MUJOCO, hinged, read, integrator="Euler", ahead=0.5),
           "hinge; Euler, first rate − ½ θ̈ dt", order=2, limit=limits, most_steps=4000,
           predicted=ANGLE.predict(SYMPLECTIC_EULER.table, ahead=-0.5, powers=EVEN[2])),
)

ONE_MOTION = "any other mechanism: it solves the equation of one angle"
EXAM = iftomm(
    "A01, simple pendulum for 2,000 s",
    "A particle of 1 kg hangs on a massless rod of 1 m and is released at rest from horizontal. Asked for is its place "
    "every half second for 2,000 s.",
    WHOLE, 4000, (20_000, 40_000, 80_000, 200_000, 400_000, 800_000, 2_000_000),
    {BLANES_MOAN: ONE_MOTION, RK4: ONE_MOTION,
     ROPE: "bodies that turn: it moves points on strings",
     COMPOSED_ROPE: "bodies that turn: it moves points on strings, in five steps in place of one",
     PYMUNK: "the phase: its error grows with every swing, with a leapfrog start as without",
     PYBULLET: "the phase: its error grows with every swing, with a leapfrog start as without",
     MUJOCO: "with Runge–Kutta 4 an energy that stays, and with Euler's step the phase"},
    note="The library's own reference file was not at hand: the error is against the closed form.")


def sanity_checks():
    """Return Findings about the closed form."""
    period = pendulum_period(0.5 * np.pi, 1.0, 9.81)
    return (states("period from horizontal [s]", period, 2.367841948, 5e-10),
            states("swings in 2,000 s [-]", np.floor(WHOLE / period), 844.0, 0.0),
            states("place after 844 swings [m]", truth(Params(), 844.0 * period), (1.0, 0.0), 1e-11))


def points(observed, p):
    return np.stack((np.zeros(2), observed))


SCENE = Scene(
    title="Phase of a pendulum", lesson="pbd",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: swings, start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-14,
    published_states=((0.0, (1.0, 0.0), 1e-15), (2.367841948, (1.0, 0.0), 5e-9)),
    sanity_checks=sanity_checks,
    points=points, links=ONE_LINK,
    uses=("two coordinates, or one angle", "one link", "one step function"),
    full_loop="the pendulum from horizontal has the same motion, and is measured with the loop",
    ablations={"rotation of the bob": "the pendulum from horizontal is measured with the whole loop of lesson 10"},
    exam=EXAM,
)
