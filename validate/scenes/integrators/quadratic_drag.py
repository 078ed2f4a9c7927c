"""A parachutist falls from rest: drag grows with the square of the speed until it balances the weight."""

from typing import Annotated, NamedTuple

import numpy as np

from solutions.support.model import Body, Force, make_model
from validate.engines.bullet import hidden_damping
from validate.reference.schemes import Motion
from validate.scene import Scene, by_order
from validate.scenes._common import coordinates, floor_of, measured
from validate.scenes.integrators._common import Point, integrator_runners

T = 3.0                      # [s]: three times the time to reach the terminal speed without air
STEPS = (15, 30, 60, 150, 300, 600, 1500, 3000)


class Params(NamedTuple):
    m: Annotated[float, "mass [kg]"] = 1.0
    c: Annotated[float, "drag over speed squared [kg/m]"] = 0.1
    g: Annotated[float, "gravity [m/s²]"] = 9.81


CASES = {"falling": Params()}


def acceleration(t, x, v, p):
    """a = g x̂ − (c/m) |v| v          x points down"""
    a = -p.c / p.m * np.sqrt(v @ v) * v
    a[0] += p.g
    return a


def model(p):
    """Make a body that falls along x, with the force −c |v| v."""
    c = -p.c
    drag = Force(0, lambda v: (c * abs(v[0]) * v[0], 0.0), "v")
    return make_model([Body((0.0, 0.0), p.m)], (p.g, 0.0), loads=[drag])


POINT = Point(model, d=1)
start = POINT.start("m", "c", "g")


def run(lessons, step, acceleration, state, p, dt, steps):
    x, v = state
    return lessons.integrators.advance(step, acceleration, 0.0, x, v, dt, steps, p)


def terminal_speed(p):
    """Return v∞ = √(m g/c), at which drag balances the weight [m/s]."""
    return np.sqrt(p.m * p.g / p.c)


def truth(p, t):
    """x(t) = (v∞²/g) ln cosh(g t/v∞),   v(t) = v∞ tanh(g t/v∞)

    v̇ = g (1 − v²/v∞²): separate, ∫dv/(1 − v²/v∞²) = v∞ artanh(v/v∞) = g t; then integrate tanh.
    ln cosh s = s + ln(1 + e^(−2s)) − ln 2 does not overflow.
    Source: Taylor, Classical mechanics, § 2.4.
    """
    s = p.g * t / terminal_speed(p)
    return np.array([terminal_speed(p) ** 2 / p.g * (s + np.log1p(np.exp(-2.0 * s)) - np.log(2.0))])


def limits(p, dt, damping=0.0):
    """The fastest rate is |∂a/∂v| = 2g/v∞ at the terminal speed, and the error scales with v∞ over that rate.

    pymunk and pybullet take drag at the beginning of a step: order 1.  MuJoCo runs Runge–Kutta 4.
    """
    v_end = terminal_speed(p)
    rate = 2.0 * p.g / v_end + damping
    return {k: v_end / rate / truth(p, T)[0] * limit for k, limit in by_order(rate, T, dt).items()}


def damped_limits(p, dt):
    """The default damping adds 0.04 (1 + 2v) to the rate; v∞ bounds the speed with damping, too."""
    return limits(p, dt, 0.04 * (1.0 + 2.0 * terminal_speed(p)))


def law(p):
    """Return a(t, x, v) of a number x, independent of the scene's."""
    return lambda t, x, v: p.g - p.c / p.m * v * abs(v)


def at_rest(p):
    return 0.0, 0.0


def seen(x, p):
    return [x]


MOTION = Motion(T, law, at_rest, seen, truth, floor_of(limits))
DAMPED = hidden_damping(acceleration, start)


RUNNERS = (
    *integrator_runners(MOTION, limits),
    POINT.in_pymunk(MOTION, limits),
    POINT.in_default_pybullet(MOTION, damped_limits, DAMPED),
    POINT.in_pybullet(MOTION, limits),
    POINT.leaping_in_pybullet(MOTION, limits),
    POINT.in_mujoco(MOTION, limits),
)


def points(observed, p):
    return np.array([[0.0, -observed[0]]])


SCENE = Scene(
    title="Quadratic drag", lesson="integrators",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: acceleration, start=start, run=run, observe=coordinates(1),
    truth=truth, truth_uncertainty=1e-14, model=model, read=POINT.read,
    # the depth; the speed is then 9.852684396 m/s
    published_states=((3.0, (22.80837567,), 5e-9),),
    points=points,
    uses=("one coordinate", "one step function"),
    ablations={"the second and third dimension": POINT.in_space,
              **measured("rotation", "detection of the ground")},
)
