"""A parachutist falls from rest: drag grows with the square of the speed until it balances the weight."""

from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import check_positive
from validate.engines.bullet import Bullet, hidden_damping
from validate.engines.chipmunk import pymunk_space
from validate.methods import INTEGRATORS, ONE_OF_EACH_ORDER
from validate.reference.schemes import NEW_VELOCITY_OLD_FORCE, OLD_VELOCITY_OLD_FORCE, Motion
from validate.scene import EXACT, PYBULLET, PYMUNK, EngineRun, Scene, by_order, engine, ours

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


def start(p):
    for name in ("m", "c", "g"):
        check_positive(name, getattr(p, name))
    return np.zeros(1), np.zeros(1)


def run(lessons, step, acceleration, state, p, dt, steps):
    x, v = state
    return lessons.integrators.advance(step, acceleration, 0.0, x, v, dt, steps, p)


def observe(state, p):
    return state[0][:1]


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

    Both engines are of first order and take drag at the beginning of a step: order 1.
    """
    v_end = terminal_speed(p)
    rate = 2.0 * p.g / v_end + damping
    return {k: v_end / rate / truth(p, T)[0] * limit for k, limit in by_order(rate, T, dt).items()}


def damped_limits(p, dt):
    """The default damping adds 0.04 (1 + 2v) to the rate; v∞ bounds the speed with it, too."""
    return limits(p, dt, 0.04 * (1.0 + 2.0 * terminal_speed(p)))


def floor(p, dt):
    return limits(p, dt)[EXACT]


def law(p):
    """Return a(t, x, v) of a number x, apart from the scene's."""
    return lambda t, x, v: p.g - p.c / p.m * v * abs(v)


def damped_law(p):
    """Return the same with the default damping."""
    return lambda t, x, v: p.g - p.c / p.m * v * abs(v) - 0.04 * v * (1.0 + abs(v))


def at_rest(p):
    return 0.0, 0.0


def seen(x, p):
    return [x]


MOTION = Motion(T, law, at_rest, seen, truth, floor)
DAMPED = hidden_damping(acceleration, start)


def pymunk_make(p, dt):
    """Apply drag as a force before each step.

    Chipmunk moves first: forward Euler, harmless here because drag depends on v alone.
    """
    import pymunk
    space = pymunk_space((p.g, 0.0))
    body = pymunk.Body(p.m, 1.0)
    space.add(body)

    def step():
        v = body.velocity.x
        body.force = (-p.c * abs(v) * v, 0.0)                                    # the step clears it
        space.step(dt)

    return EngineRun(step, lambda: np.array([body.position.x]), lambda: None)


def pybullet_make(p, dt, default=False):
    """Apply drag as a force before each step."""
    bullet = Bullet(dt, (p.g, 0.0, 0.0))
    body = bullet.point_mass(p.m, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), default)

    def step():
        v = bullet.velocity(body)[0]
        bullet.push(body, (-p.c * abs(v) * v, 0.0, 0.0), bullet.position(body))
        bullet.step()

    return EngineRun(step, lambda: np.array([bullet.position(body)[0]]), bullet.close)


RUNNERS = (
    *(ours(m, limit=limits, predicted=MOTION.predict(m.table), in_quick=m in ONE_OF_EACH_ORDER) for m in INTEGRATORS),
    engine(PYMUNK, "", pymunk_make, "force applied each step",
           order=1, limit=limits, predicted=MOTION.predict(OLD_VELOCITY_OLD_FORCE)),
    engine(PYBULLET, "default", partial(pybullet_make, default=True),
           "createMultiBody with its defaults; force applied each step",
           order=1, limit=damped_limits, departure=DAMPED,
           predicted=MOTION.predict(NEW_VELOCITY_OLD_FORCE, damped_law, follows=DAMPED.own_law)),
    engine(PYBULLET, "", pybullet_make, "useMaximalCoordinates=1, no damping; force applied each step",
           order=1, limit=limits, predicted=MOTION.predict(NEW_VELOCITY_OLD_FORCE)),
)


def points(observed, p):
    return np.array([[0.0, -observed[0]]])


def in_space(p):
    """The same fall with two unused sideways coordinates."""
    return (np.zeros(3), np.zeros(3)), p


SCENE = Scene(
    title="Quadratic drag", lesson="integrators",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: acceleration, start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-14,
    # the depth; the speed is then 9.852684396 m/s
    published_states=((3.0, (22.80837567,), 5e-9),),
    points=points,
    uses=("one coordinate", "one step function"),
    ablations={"the second and third dimension": in_space,
              "rotation": "the whole loop of lesson 10 has it, and is measured",
              "detection of the ground": "the whole loop of lesson 10 has it, and is measured"},
)
