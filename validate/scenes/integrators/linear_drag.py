"""A pellet shot up in syrup: linear drag bends the parabola until the pellet falls almost straight down."""

from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import check_positive
from validate.engines.bullet import Bullet, hidden_damping
from validate.engines.chipmunk import pymunk_space, pymunk_world
from validate.methods import INTEGRATORS, ONE_OF_EACH_ORDER
from validate.reference.schemes import NEW_VELOCITY_OLD_FORCE, OLD_VELOCITY_OLD_FORCE, Motion
from validate.scene import EXACT, PYBULLET, PYMUNK, EngineRun, Scene, by_order, engine, ours

T = 1.97599434               # [s]: at which it is back at the initial height
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


def start(p):
    check_positive("k", p.k)
    return np.zeros(2), np.array([p.vx, p.vy])


def run(lessons, step, acceleration, state, p, dt, steps):
    x, v = state
    return lessons.integrators.advance(step, acceleration, 0.0, x, v, dt, steps, p)


def observe(state, p):
    return state[0][:2]


def truth(p, t):
    """x(t) = v∞ t + (v₀ − v∞)(1 − e^(−kt))/k,   v∞ = −(g/k) ŷ

    v − v∞ obeys u̇ = −k u, so it decays as e^(−kt); integrate once more.  It lands when (v_y + g/k)(1 − e^(−kt)) = g t.
    Source: Marion and Thornton, Classical dynamics, chapter 2 (motion in a resisting medium).
    """
    v_0, v_end = np.array([p.vx, p.vy]), np.array([0.0, -p.g / p.k])
    return v_end * t - (v_0 - v_end) * np.expm1(-p.k * t) / p.k


def limits(p, dt, damping=0.0):
    """Only the decaying term has an error.  Its length is |v₀ − v∞|/k, its rate is k, and x(T) is ten times shorter.

    Both engines are of first order and take drag at the beginning of a step, or multiply v by e^(−k dt): order 1
    with rate k.  A first velocity half a step later would not help, because drag depends on it.
    """
    scale = np.hypot(p.vx, p.vy + p.g / p.k) / p.k / np.linalg.norm(truth(p, T))
    return {k: scale * limit for k, limit in by_order(p.k + damping, T, dt).items()}


def damped_limits(p, dt):
    """The default damping has its fastest rate, 0.04 (1 + 2|v|), at the greater of the initial and terminal speed."""
    return limits(p, dt, 0.04 * (1.0 + 2.0 * max(np.hypot(p.vx, p.vy), p.g / p.k)))


def floor(p, dt):
    return limits(p, dt)[EXACT]


def law(p):
    """Return a(t, x, v) of a complex number x, apart from the scene's."""
    return lambda t, x, v: complex(0.0, -p.g) - p.k * v


def damped_law(p):
    """Return the same with the default damping."""
    return lambda t, x, v: complex(0.0, -p.g) - p.k * v - 0.04 * v * (1.0 + abs(v))


def thrown(p):
    return 0j, complex(p.vx, p.vy)


def seen(x, p):
    return [x.real, x.imag]


def own_damping(place):
    """Return an engine's step with its own damping: the velocity times e^(−k dt), then gravity."""
    def model(p):
        kept = lambda v, h: v * np.exp(-p.k * h) + h * complex(0.0, -p.g)
        return lambda law, t, x, v, h: (x + h * place(v, kept(v, h)), kept(v, h))
    return model


MOTION = Motion(T, law, thrown, seen, truth, floor)
DAMPED = hidden_damping(acceleration, start)


def pymunk_make(p, dt, own=False):
    """Drag as a force before each step, or as the space's damping: the share of the velocity left after one second.

    Chipmunk moves first and then applies the force.  This forward Euler is harmless here, because drag depends on v
    alone.
    """
    import pymunk
    space = pymunk_space((0.0, -p.g))
    if own:
        space.damping = np.exp(-p.k)
    body = pymunk.Body(1.0, 1.0)
    body.velocity = (p.vx, p.vy)
    space.add(body)

    def step():
        body.force = (-p.k * body.velocity.x, -p.k * body.velocity.y)            # the step clears it
        space.step(dt)

    read = lambda: np.array([body.position.x, body.position.y])
    return pymunk_world(space, dt, read) if own else EngineRun(step, read, lambda: None)


def pybullet_make(p, dt, default=False, own=False):
    """Drag as a force before each step, or as the body's own damping: the share of the velocity lost in one second."""
    bullet = Bullet(dt, (0.0, -p.g, 0.0))
    body = bullet.point_mass(1.0, (0.0, 0.0, 0.0), (p.vx, p.vy, 0.0), default)
    if own:
        bullet.pb.changeDynamics(body, -1, linearDamping=-np.expm1(-p.k))

    def step():
        v = bullet.velocity(body)
        bullet.push(body, (-p.k * v[0], -p.k * v[1], 0.0), bullet.position(body))
        bullet.step()

    return EngineRun(bullet.step if own else step, lambda: np.array(bullet.position(body)[:2]), bullet.close)


RUNNERS = (
    *(ours(m, limit=limits, predicted=MOTION.predict(m.table), in_quick=m in ONE_OF_EACH_ORDER) for m in INTEGRATORS),
    engine(PYMUNK, "", pymunk_make, "force applied each step",
           order=1, limit=limits, predicted=MOTION.predict(OLD_VELOCITY_OLD_FORCE)),
    engine(PYMUNK, "own damping", partial(pymunk_make, own=True),
           "space.damping = e^(−k): the share left after one second",
           order=1, limit=limits, predicted=MOTION.predict(own_damping(lambda old, new: old))),
    engine(PYBULLET, "default", partial(pybullet_make, default=True),
           "createMultiBody with its defaults; force applied each step",
           order=1, limit=damped_limits, departure=DAMPED,
           predicted=MOTION.predict(NEW_VELOCITY_OLD_FORCE, damped_law, follows=DAMPED.own_law)),
    engine(PYBULLET, "", pybullet_make, "useMaximalCoordinates=1, no damping; force applied each step",
           order=1, limit=limits, predicted=MOTION.predict(NEW_VELOCITY_OLD_FORCE)),
    engine(PYBULLET, "own damping", partial(pybullet_make, own=True),
           "useMaximalCoordinates=1, linearDamping = 1 − e^(−k): the share lost in one second",
           order=1, limit=limits, predicted=MOTION.predict(own_damping(lambda old, new: new))),
)


def points(observed, p):
    return observed[None, :]


def in_space(p):
    """The same motion with an unused z coordinate."""
    return (np.zeros(3), np.array([p.vx, p.vy, 0.0])), p


SCENE = Scene(
    title="Linear drag", lesson="integrators",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: acceleration, start=start, run=run, observe=observe,
    truth=truth,
    # (1 − e^(−kt)) and gt are ten times as large as their difference
    truth_uncertainty=1e-14,
    published_states=((1.97599434, (2.18789655, 0.0), 4e-8),),
    points=points,
    uses=("one point in the plane", "one step function"),
    ablations={
        "the third dimension": in_space,
        "rotation": "the whole loop of lesson 10 has it, and is measured",
        "detection of the ground": "the whole loop of lesson 10 has it, and is measured",
    },
)
