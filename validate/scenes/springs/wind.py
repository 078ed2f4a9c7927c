"""A ball of paper is thrown against the wind, comes back, and in the end drifts at a constant velocity."""

from typing import Annotated, NamedTuple

import numpy as np

from solutions.support.model import Body, Drag, make_model
from validate.check import states
from validate.reference.schemes import Motion
from validate.scene import Scene, by_order
from validate.scenes._common import coordinates, floor_of
from validate.scenes.integrators._common import Point, as_pair, integrator_runners, one_point

T = 2.0                      # [s]
STEPS = (10, 20, 50, 100, 200, 500, 1000, 2000)


class Params(NamedTuple):
    m: Annotated[float, "mass [kg]"] = 0.02
    k_v: Annotated[float, "viscosity [N s/m]"] = 0.03
    wind: Annotated[float, "force of the wind on a resting ball, towards −x [N]"] = 0.12
    vx: Annotated[float, "initial velocity [m/s], y up"] = 6.0
    vy: float = 5.0
    g: Annotated[float, "gravity [m/s²]"] = 9.81


CASES = {"thrown": Params()}


def acceleration(lessons):
    air_force = lessons.springs.air_force

    def blown(t, x, v, p):
        """a = F/m − g ŷ,   F the force of the air"""
        a = air_force(v, np.array([-p.wind, 0.0]), p.k_v) / p.m
        a[1] -= p.g
        return a
    return blown


def model(p):
    """Make the ball.  The wind pushes with a constant force, which is a part of gravity here."""
    return make_model([Body((0.0, 0.0), p.m, v=(p.vx, p.vy))], (-p.wind / p.m, -p.g), loads=[Drag(p.k_v)])


POINT = Point(model)
start = POINT.start("m", "k_v")


def run(lessons, step, acceleration, state, p, dt, steps):
    x, v = state
    return lessons.integrators.advance(step, acceleration, 0.0, x, v, dt, steps, p)


def drift(p):
    """Return the velocity at which wind, gravity and drag balance:  k_v v = F_wind + m g."""
    return np.array([-p.wind, -p.m * p.g]) / p.k_v


def truth(p, t):
    """x(t) = u t + (v₀ − u)(1 − e^(−kt))/k,   k = k_v/m,   u = (F_wind + m g)/k_v

    v − u obeys ẇ = −k w, so it decays as e^(−kt); integrate once more.
    Source: Marion and Thornton, Classical dynamics, chapter 2 (motion in a resisting medium).
    """
    k, u = p.k_v / p.m, drift(p)
    return u * t - (np.array([p.vx, p.vy]) - u) * np.expm1(-k * t) / k


def limits(p, dt):
    """Only the decaying term has an error; its length is |v₀ − u|/k and its rate k."""
    k = p.k_v / p.m
    size = np.linalg.norm(np.array([p.vx, p.vy]) - drift(p)) / k / np.linalg.norm(truth(p, T))
    return {order: size * limit for order, limit in by_order(k, T, dt).items()}


def law(p):
    """Return a(t, x, v) of a complex number x, independent of the lesson's."""
    return lambda t, x, v: complex(-p.wind / p.m, -p.g) - p.k_v / p.m * v


def thrown(p):
    return 0j, complex(p.vx, p.vy)


MOTION = Motion(T, law, thrown, as_pair, truth, floor_of(limits))


RUNNERS = (
    *integrator_runners(MOTION, limits), POINT.in_pymunk(MOTION, limits), POINT.in_pybullet(MOTION, limits),
    POINT.leaping_in_pybullet(MOTION, limits),
    POINT.in_mujoco(MOTION, limits, "damping of the joints, wind as a part of gravity"),
)


def sanity_checks():
    """Return Findings: the initial and the final velocity of the truth."""
    p, h = CASES["thrown"], 1e-3
    early, late = (truth(p, h) - truth(p, -h)) / (2.0 * h), truth(p, 30.0) - truth(p, 29.0)
    return (states("initial velocity of the truth: error [m/s]", np.linalg.norm(early - (p.vx, p.vy)), 0.0, 1e-5),
            states("velocity after half a minute less that of the balance [m/s]", np.linalg.norm(late - drift(p)), 0.0,
                   1e-12))


SCENE = Scene(
    title="Against the wind", lesson="springs",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=acceleration, start=start, run=run, observe=coordinates(2),
    truth=truth, truth_uncertainty=1e-14, model=model, read=POINT.read,
    sanity_checks=sanity_checks, points=one_point,
    uses=("one point in the plane", "the force of the air", "one step function"),
    ablations={
        "the third dimension": "the acceleration of this scene has two components",
        "rotation": "the whole loop of lesson 10 has it, and a full run measures it",
        "a drag that grows with the square of the speed": "a scene of lesson 1 has it",
    },
)
