"""A stone thrown from a cliff, without air: most methods trace its parabola exactly, three miss it by ½ g dt t."""

from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.support.model import Body, make_model, start_of
from validate.engines.bullet import hidden_damping
from validate.methods import (
    AVERAGE_VELOCITY,
    EULER,
    IMPLICIT_EULER,
    IMPLICIT_MIDPOINT,
    MIDPOINT,
    RK4,
    SYMPLECTIC_EULER,
    VERLET,
)
from validate.reference.schemes import NEW_VELOCITY_OLD_FORCE, Motion
from validate.scene import EXACT, MUJOCO, PYBULLET, PYMUNK, Prediction, Scene, by_order, engine, in_substeps, ours
from validate.scenes._common import built, coordinates, measured, round_off
from validate.scenes.integrators._common import BY_DEFAULT

T = 10.0                     # [s]
STEPS = (10, 20, 50, 100, 200, 500, 1000, 2000)
rounded = round_off(T)
# One step with a constant a moves the stone by dt v + ½dt² a, and changes its velocity by dt a.  Every method gets the
# velocity right.  Methods that move the position with the mean of old and new velocity, or with the one in the middle,
# also get the position right.


class Params(NamedTuple):
    vx: Annotated[float, "initial velocity [m/s], z up"] = -2.0
    vy: float = 2.0
    vz: float = 8.0
    g: Annotated[float, "gravity [m/s²]"] = 9.81


CASES = {"thrown": Params()}


def acceleration(t, x, v, p):
    """a = −g ẑ"""
    a = np.zeros_like(v)
    a[2] = -p.g
    return a


def model(p):
    return make_model([Body((0.0, 0.0, 0.0), 1.0, v=(p.vx, p.vy, p.vz))], (0.0, 0.0, -p.g))


def read(state, p):
    return state.x[0]


def start(p):
    now = start_of(model(p))
    return now.x[0], now.v[0]


def run(lessons, step, acceleration, state, p, dt, steps):
    x, v = state
    return lessons.integrators.advance(step, acceleration, 0.0, x, v, dt, steps, p)


def truth(p, t):
    """x(t) = v₀ t − ½ g t² ẑ

    Source: Galilei 1638, fourth day; a = −g ẑ integrated twice.
    """
    return np.array([p.vx * t, p.vy * t, p.vz * t - 0.5 * p.g * t * t])


def limits(p, dt):
    """The error of order 1 is exact: ½ g dt T ẑ upwards with the old velocity, downwards with the new.

    With the old velocity x ends at  Σ dt v(n dt) = x(T) + ½ g dt T ẑ.  pymunk moves with the old velocity and errs
    upwards, pybullet with the new one and errs downwards: their mean is exact.  Half a step of gravity in the first
    velocity removes the error.
    """
    return {1: 0.5 * p.g * dt * T / np.linalg.norm(truth(p, T)) + rounded(p, dt), EXACT: rounded(p, dt)}


def damped_limit(p, dt):
    """With damping the fastest rate is that of 0.04 v (1 + |v|) at the larger of the initial speed and the terminal
    speed, where 0.04 v (1 + v) = g.
    """
    fastest = max(np.linalg.norm(start(p)[1]), 0.5 * (np.sqrt(1.0 + 100.0 * p.g) - 1.0))
    return by_order(0.04 * (1.0 + 2.0 * fastest), T, dt)[1]


def old_velocity(p, dt, side=1.0):
    """The error is +½ g dt T ẑ with the old velocity, −½ g dt T ẑ with the new one, and round-off for all others."""
    return Prediction(np.array([0.0, 0.0, 0.5 * side * p.g * dt * T]), rounded(p, dt))


new_velocity, mean_velocity = partial(old_velocity, side=-1.0), partial(old_velocity, side=0.0)


def damped_law(p):
    """Return a(t, x, v) with the default damping."""
    return lambda t, x, v: np.array([0.0, 0.0, -p.g]) - 0.04 * v * (1.0 + np.sqrt(v @ v))


DAMPED = hidden_damping(acceleration, start)
MOTION = Motion(T, damped_law, start, lambda x, p: x, DAMPED.own_law, rounded)


world = partial(built, model=model, read=read)
EXACTLY = {"order": EXACT, "limit": limits, "predicted": mean_velocity}
NEW_VELOCITY = engine(PYBULLET, "", world(PYBULLET), "useMaximalCoordinates=1, no damping",
                      order=1, limit=limits, predicted=new_velocity)
RUNNERS = (
    ours(EULER, limit=limits, predicted=old_velocity),
    *(ours(m, **EXACTLY) for m in (MIDPOINT, RK4, AVERAGE_VELOCITY)),
    ours(SYMPLECTIC_EULER, limit=limits, predicted=new_velocity),
    ours(VERLET, **EXACTLY),
    # the implicit methods take half of the scene's time to compile, and add no information here
    ours(IMPLICIT_EULER, limit=limits, predicted=new_velocity, in_quick=False),
    ours(IMPLICIT_MIDPOINT, in_quick=False, **EXACTLY),
    engine(PYMUNK, "", world(PYMUNK), "default settings: no damping", order=1, limit=limits, predicted=old_velocity),
    engine(PYMUNK, "leapfrog start", world(PYMUNK, ahead=0.5), "first velocity + ½ a dt", **EXACTLY),
    engine(PYBULLET, "default", world(PYBULLET, **BY_DEFAULT), "createMultiBody with its defaults",
           order=1, limit=damped_limit, predicted=MOTION.predict(NEW_VELOCITY_OLD_FORCE, finest=1000),
           departure=DAMPED),
    NEW_VELOCITY,
    in_substeps(NEW_VELOCITY, 10),
    engine(PYBULLET, "leapfrog start", world(PYBULLET, ahead=0.5), "first velocity − ½ a dt", **EXACTLY),
    engine(MUJOCO, "", world(MUJOCO), "slide joints; Runge–Kutta 4", **EXACTLY),
    engine(MUJOCO, "leapfrog start", world(MUJOCO, integrator="Euler", ahead=0.5),
           "slide joints; Euler, first velocity − ½ a dt", **EXACTLY),
)


def points(observed, p):
    """Draw the scene from the side of the throw."""
    heading = np.arctan2(p.vy, p.vx)
    return np.array([[np.cos(heading) * observed[0] + np.sin(heading) * observed[1], observed[2]]])


SCENE = Scene(
    title="Throw", lesson="integrators",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: acceleration, start=start, run=run, observe=coordinates(3),
    truth=truth, truth_uncertainty=1e-15, model=model, read=read,
    # by hand, exactly: only round-off may differ
    published_states=((10.0, (-20.0, 20.0, -410.5), 1e-12),),
    points=points,
    uses=("one point in space", "one step function"),
    ablations={
        "air": "the scenes with linear and quadratic drag have it",
        **measured("rotation", "detection of the ground"),
    },
)
