"""A stone thrown from a cliff, without air: most methods trace its parabola exactly, three miss it by ½ g dt t."""

from functools import cache
from typing import Annotated, NamedTuple

import numpy as np

from solutions.integrators import advance
from validate.engines.bullet import Bullet, hidden_damping
from validate.engines.chipmunk import pymunk_space, pymunk_world
from validate.methods import INTEGRATORS
from validate.reference.schemes import ErrorLaw
from validate.reference.schemes import advance as advance_table
from validate.scene import EXACT, PYBULLET, PYMUNK, Engine, EngineRun, Prediction, Scene, by_order

T = 10.0                     # [s]
STEPS = (10, 20, 50, 100, 200, 500, 1000, 2000)
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


def start(p):
    return np.zeros(3), np.array([p.vx, p.vy, p.vz])


def run(step, acceleration, state, p, dt, steps):
    x, v = state
    return advance(step, acceleration, 0.0, x, v, dt, steps, p)


def observe(state, p):
    return state[0]


def truth(p, t):
    """x(t) = v₀ t − ½ g t² ẑ

    Source: Galilei 1638, fourth day; a = −g ẑ integrated twice.
    """
    return np.array([p.vx * t, p.vy * t, p.vz * t - 0.5 * p.g * t * t])


def tolerance(p, dt):
    """The error of order 1 is exact: ½ g dt T ẑ upwards with the old velocity, downwards with the new.

    With the old velocity x ends at  Σ dt v(n dt) = x(T) + ½ g dt T ẑ.  pymunk moves with the old velocity and errs
    upwards, pybullet with the new and errs downwards: their mean is exact.  Half a step of gravity in the first
    velocity removes the error.  With damping the fastest rate is that of 0.04 v (1 + |v|) at the greater of the
    initial speed and the terminal one, where 0.04 v (1 + v) = g.
    """
    limits = by_order(0.0, T, dt)
    bias = 0.5 * p.g * dt * T / np.linalg.norm(truth(p, T)) + limits[EXACT]
    fastest = max(np.linalg.norm(start(p)[1]), 0.5 * (np.sqrt(1.0 + 100.0 * p.g) - 1.0))
    damped = by_order(0.04 * (1.0 + 2.0 * fastest), T, dt)[1]
    return {**limits, 1: bias, "pymunk": bias, "pymunk, leapfrog start": limits[EXACT],
            "pybullet": bias, "pybullet, default": damped, "pybullet, leapfrog start": limits[EXACT]}


OLD_VELOCITY, NEW_VELOCITY = ("Euler", "pymunk"), ("symplectic Euler", "implicit Euler", "pybullet")
DEPARTURES = {"pybullet, default": hidden_damping(acceleration, start)}


def predicted_error(label, p, dt):
    """+½ g dt T ẑ with the old velocity, −½ g dt T ẑ with the new one, and zero for all others, to round-off.

    pybullet's default body falls by a law of its own.  The table of coefficients of its method, applied to that law,
    predicts its error.
    """
    round_off = by_order(0.0, T, dt)[EXACT]
    if label in DEPARTURES:
        return damped_fall(p).prediction(dt, round_off)
    side = (label in OLD_VELOCITY) - (label in NEW_VELOCITY)
    return Prediction(np.array([0.0, 0.0, 0.5 * side * p.g * dt * T]), round_off)


@cache
def damped_fall(p):
    """Return the ErrorLaw of pybullet's default body: damping from the velocity before each step, then the new one."""
    def run(steps, nudge):
        law = lambda t, x, v: np.array([0.0, 0.0, -p.g]) - 0.04 * v * (1.0 + np.sqrt(v @ v))
        return advance_table("new velocity, old force", law, start(p)[0] + nudge, start(p)[1], T / steps, steps)[0]
    return ErrorLaw(run, DEPARTURES["pybullet, default"].own_law(p, T), 1, T, 1000)


def pymunk_make(p, dt, ahead=0.0):
    """Use the vertical plane of the throw; positions are rotated back into space."""
    import pymunk
    space = pymunk_space((0.0, -p.g))
    body = pymunk.Body(1.0, 1.0)
    heading, speed = np.arctan2(p.vy, p.vx), np.hypot(p.vx, p.vy)
    body.velocity = (speed, p.vz - ahead * dt * p.g)
    space.add(body)
    ahead_x, ahead_y = np.cos(heading), np.sin(heading)
    read = lambda: np.array([ahead_x * body.position.x, ahead_y * body.position.x, body.position.y])
    return pymunk_world(space, dt, read)


def pybullet_make(p, dt, ahead=0.0, default=False):
    """A free body under the engine's own gravity."""
    bullet = Bullet(dt, (0.0, 0.0, -p.g))
    body = bullet.point_mass(1.0, (0.0, 0.0, 0.0), (p.vx, p.vy, p.vz + ahead * dt * p.g), default)
    return EngineRun(bullet.step, lambda: np.array(bullet.position(body)), bullet.close)


ENGINES = (
    Engine(PYMUNK, "", pymunk_make, 1, "default settings: no damping"),
    Engine(PYMUNK, "leapfrog start", lambda p, dt: pymunk_make(p, dt, ahead=0.5), EXACT, "first velocity + ½ a dt"),
    Engine(PYBULLET, "default", lambda p, dt: pybullet_make(p, dt, default=True), 1, "createMultiBody as it comes"),
    Engine(PYBULLET, "", pybullet_make, 1, "useMaximalCoordinates=1, no damping"),
    Engine(PYBULLET, "leapfrog start", lambda p, dt: pybullet_make(p, dt, ahead=0.5), EXACT, "first velocity − ½ a dt"),
)


def points(observed, p):
    """Draw the scene from the side of the throw."""
    heading = np.arctan2(p.vy, p.vx)
    return np.array([[np.cos(heading) * observed[0] + np.sin(heading) * observed[1], observed[2]]])


SCENE = Scene(
    title="Throw", lesson="integrators",
    cases=CASES, duration=T, steps=STEPS,
    methods=INTEGRATORS,
    acceleration=acceleration, start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-15, tolerance=tolerance,
    engines=ENGINES,
    expected_departures=DEPARTURES,
    predicted_error=predicted_error,
    orders={f"{name}_step": EXACT for name in ("midpoint", "rk4", "average_velocity", "verlet", "implicit_midpoint")},
    slow_methods=(
        "implicit_euler_step",
        "implicit_midpoint_step",
    # irrelevant to this scene, and half of its compile time
    ),
    # Plain Python finishes before numba has compiled it.
    # by hand, exactly: only round-off may differ
    published_states=((10.0, (-20.0, 20.0, -410.5), 1e-12),),
    points=points,
    uses=("one point in space", "one step function"),
    ablations={
        "air": "the scenes with linear and quadratic drag have it",
        "rotation": "the whole loop of lesson 10 has it, and is measured",
        "detection of the ground": "the whole loop of lesson 10 has it, and is measured",
    },
)
