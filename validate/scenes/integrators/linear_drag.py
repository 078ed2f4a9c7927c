"""A pellet shot up in syrup: linear drag bends the parabola until the pellet falls almost straight down."""

from typing import Annotated, NamedTuple

import numpy as np

from solutions.support.model import Body, Drag, make_model
from validate.engines.bullet import hidden_damping
from validate.reference.schemes import Motion
from validate.scene import PYBULLET, PYMUNK, Scene, by_order, engine
from validate.scenes._common import coordinates, floor_of, measured
from validate.scenes.integrators._common import Point, as_pair, integrator_runners, one_point

T = 1.97599434               # [s]: the pellet is then back at the initial height
STEPS = (10, 20, 50, 100, 200, 500, 1000, 2000)


class Params(NamedTuple):
    vx: Annotated[float, "initial velocity [m/s], y up"] = 2.54
    vy: float = 12.7
    k: Annotated[float, "drag over mass [1/s]"] = 1.0
    g: Annotated[float, "gravity [m/s²]"] = 9.81456


CASES = {"shot": Params()}
# Landing time and range are published to 8 decimals: half a unit of the time, at the landing speed of 6.7 m/s, is
# 3.4e-8 m.


def acceleration(t, x, v, p):
    """a = −g ŷ − k v"""
    a = -p.k * v
    a[1] -= p.g
    return a


def model(p):
    """Make a pellet of one kilogram."""
    return make_model([Body((0.0, 0.0), 1.0, v=(p.vx, p.vy))], (0.0, -p.g), loads=[Drag(p.k)])


POINT = Point(model)
start = POINT.start("k")


def run(lessons, step, acceleration, state, p, dt, steps):
    x, v = state
    return lessons.integrators.advance(step, acceleration, 0.0, x, v, dt, steps, p)


def truth(p, t):
    """x(t) = v∞ t + (v₀ − v∞)(1 − e^(−kt))/k,   v∞ = −(g/k) ŷ

    v − v∞ obeys u̇ = −k u, so it decays as e^(−kt); integrate once more.  It lands when (v_y + g/k)(1 − e^(−kt)) = g t.
    Source: Marion and Thornton, Classical dynamics, chapter 2 (motion in a resisting medium).
    """
    v_0, v_end = np.array([p.vx, p.vy]), np.array([0.0, -p.g / p.k])
    return v_end * t - (v_0 - v_end) * np.expm1(-p.k * t) / p.k


def limits(p, dt, damping=0.0):
    """Only the decaying term has an error.  Its length is |v₀ − v∞|/k, its rate is k, and x(T) is ten times shorter.

    pymunk and pybullet take drag at the beginning of a step, or multiply v by e^(−k dt): order 1 with rate k, with a
    leapfrog start, too, because drag depends on the velocity.  MuJoCo runs Runge–Kutta 4.
    """
    scale = np.hypot(p.vx, p.vy + p.g / p.k) / p.k / np.linalg.norm(truth(p, T))
    return {k: scale * limit for k, limit in by_order(p.k + damping, T, dt).items()}


def damped_limits(p, dt):
    """The default damping has its fastest rate, 0.04 (1 + 2|v|), at the larger of the initial and terminal speed."""
    return limits(p, dt, 0.04 * (1.0 + 2.0 * max(np.hypot(p.vx, p.vy), p.g / p.k)))


def law(p):
    """Return a(t, x, v) of a complex number x, independent of the scene's."""
    return lambda t, x, v: complex(0.0, -p.g) - p.k * v


def weight(p):
    """Return the acceleration of gravity alone likewise: what an engine takes for its first velocity, if it damps."""
    return lambda t, x, v: complex(0.0, -p.g)


def thrown(p):
    return 0j, complex(p.vx, p.vy)


def at_first(p):
    """Return the accelerations (1, 2), (1,) of the pellet when it is shot."""
    return ((-p.k * p.vx, -p.g - p.k * p.vy),), (0.0,)


def own_damping(place):
    """Return the step of an engine with its own damping: the velocity times e^(−k dt), then gravity."""
    def step(p):
        kept = lambda v, h: v * np.exp(-p.k * h) + h * complex(0.0, -p.g)
        return lambda law, t, x, v, h: (x + h * place(v, kept(v, h)), kept(v, h))
    return step


MOTION = Motion(T, law, thrown, as_pair, truth, floor_of(limits))
DAMPED = hidden_damping(acceleration, start)
RUNNERS = (
    *integrator_runners(MOTION, limits),
    POINT.in_pymunk(MOTION, limits),
    engine(PYMUNK, "own damping", POINT.built(PYMUNK, own_drag=True, ahead=0.5),
           "space.damping = e^(−k), the share left after one second; first velocity + ½ g dt",
           order=1, limit=limits, predicted=MOTION.predict(own_damping(lambda old, new: old), weight, ahead=0.5)),
    POINT.in_default_pybullet(MOTION, damped_limits, DAMPED),
    POINT.in_pybullet(MOTION, limits),
    POINT.leaping_in_pybullet(MOTION, limits),
    engine(PYBULLET, "own damping", POINT.built(PYBULLET, own_drag=True, accelerations=at_first),
           "useMaximalCoordinates=1, linearDamping = 1 − e^(−k), the share lost in one second; first velocity − ½ a dt",
           order=1, limit=limits, predicted=MOTION.predict(own_damping(lambda old, new: new), ahead=-0.5)),
    POINT.in_mujoco(MOTION, limits, "damping of the joints"),
)

SCENE = Scene(
    title="Linear drag", lesson="integrators",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: acceleration, start=start, run=run, observe=coordinates(2),
    truth=truth, model=model, read=POINT.read,
    # (1 − e^(−kt)) and gt are ten times as large as their difference
    truth_uncertainty=1e-14,
    published_states=((1.97599434, (2.18789655, 0.0), 4e-8),),
    points=one_point,
    uses=("one point in the plane", "one step function"),
    ablations={
        "the third dimension": POINT.in_space,
        **measured("rotation", "detection of the ground"),
    },
)
