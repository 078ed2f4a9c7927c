"""A ball of paper is thrown against the wind.  It comes back, and in the end it drifts at a constant velocity."""

from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import check_positive
from validate.engines.bullet import Bullet
from validate.engines.chipmunk import pymunk_space
from validate.methods import INTEGRATORS, ONE_OF_EACH_ORDER
from validate.reference.schemes import NEW_VELOCITY_OLD_FORCE, OLD_VELOCITY_OLD_FORCE, Motion
from validate.scene import EXACT, PYBULLET, PYMUNK, EngineRun, Scene, by_order, engine, ours

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


def start(p):
    for name in ("m", "k_v"):
        check_positive(name, getattr(p, name))
    return np.zeros(2), np.array([p.vx, p.vy])


def run(lessons, step, acceleration, state, p, dt, steps):
    x, v = state
    return lessons.integrators.advance(step, acceleration, 0.0, x, v, dt, steps, p)


def observe(state, p):
    return state[0]


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
    """Only the term that decays has an error, of the length |v₀ − u|/k and with the rate k."""
    k = p.k_v / p.m
    size = np.linalg.norm(np.array([p.vx, p.vy]) - drift(p)) / k / np.linalg.norm(truth(p, T))
    return {order: size * limit for order, limit in by_order(k, T, dt).items()}


def floor(p, dt):
    return limits(p, dt)[EXACT]


def law(p):
    """Return a(t, x, v) of a complex number x, apart from the lesson's."""
    return lambda t, x, v: complex(-p.wind / p.m, -p.g) - p.k_v / p.m * v


def thrown(p):
    return 0j, complex(p.vx, p.vy)


def seen(x, p):
    return [x.real, x.imag]


MOTION = Motion(T, law, thrown, seen, truth, floor)


def pymunk_make(p, dt):
    """Wind and drag as a force before each step.  Chipmunk moves first, which is harmless: the force needs only v."""
    import pymunk
    space, body = pymunk_space((0.0, -p.g)), pymunk.Body(p.m, 1.0)
    body.velocity = (p.vx, p.vy)
    space.add(body)

    def step():
        body.force = (-p.wind - p.k_v * body.velocity.x, -p.k_v * body.velocity.y)       # the step clears it
        space.step(dt)

    return EngineRun(step, lambda: np.array([body.position.x, body.position.y]), lambda: None)


def pybullet_make(p, dt):
    """Wind and drag as a force before each step."""
    bullet = Bullet(dt, (0.0, -p.g, 0.0))
    body = bullet.point_mass(p.m, (0.0, 0.0, 0.0), (p.vx, p.vy, 0.0))

    def step():
        v = bullet.velocity(body)
        bullet.push(body, (-p.wind - p.k_v * v[0], -p.k_v * v[1], 0.0), bullet.position(body))
        bullet.step()

    return EngineRun(step, lambda: np.array(bullet.position(body)[:2]), bullet.close)


RUNNERS = (
    *(ours(m, limit=limits, predicted=MOTION.predict(m.table), in_quick=m in ONE_OF_EACH_ORDER) for m in INTEGRATORS),
    engine(PYMUNK, "", pymunk_make, "force applied each step",
           order=1, limit=limits, predicted=MOTION.predict(OLD_VELOCITY_OLD_FORCE)),
    engine(PYBULLET, "", pybullet_make, "useMaximalCoordinates=1, no damping; force applied each step",
           order=1, limit=limits, predicted=MOTION.predict(NEW_VELOCITY_OLD_FORCE)),
)


def points(observed, p):
    return observed[None, :]


def sanity_checks():
    """Return ((claim, found, expected, tolerance), …): where the truth begins, and how it ends."""
    p, h = CASES["thrown"], 1e-3
    early, late = (truth(p, h) - truth(p, -h)) / (2.0 * h), truth(p, 30.0) - truth(p, 29.0)
    return (("initial velocity of the truth: error [m/s]", np.linalg.norm(early - (p.vx, p.vy)), 0.0, 1e-5),
            ("velocity after half a minute less that of the balance [m/s]", np.linalg.norm(late - drift(p)), 0.0,
             1e-12))


SCENE = Scene(
    title="Against the wind", lesson="springs",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=acceleration, start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-14,
    sanity_checks=sanity_checks, points=points,
    uses=("one point in the plane", "the force of the air", "one step function"),
    ablations={
        "the third dimension": "the acceleration of this scene has two components",
        "rotation": "the whole loop of lesson 10 has it, and is measured",
        "a drag that grows with the square of the speed": "a scene of lesson 1 has it",
    },
)
