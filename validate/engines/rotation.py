"""Free and rolling bodies in engines, and what the scenes of free bodies share."""

from functools import partial

import numpy as np

from validate.engines import mujoco
from validate.engines.bullet import Rigid
from validate.reference.orientation import quaternion_matrix
from validate.reference.rotation import EXPLICIT, IMPLICIT, free_limits
from validate.reference.turns import EXPLICIT_TERM, IMPLICIT_TERM, MUNTHE_KAAS
from validate.scene import EXACT, MUJOCO, PYBULLET, EngineRun, engine, ours
from validate.scenes.drawing import axes_links, axes_seen, turned_in_place


def turn_runners(body, methods, limits, in_quick, exact=()):
    """Return the runners of our methods on a TurningBody.

    in_quick: {method that a quick run has: its most steps there, or None};    exact: methods with nothing but round-off
    """
    return tuple(ours(m, limit=limits, predicted=body.predict(m.table), order=EXACT if m in exact else m.order,
                      in_quick=m in in_quick, most_in_quick=in_quick.get(m)) for m in methods)


def free_body(p, dt, maximal=False):
    """Make pybullet's free body with p.moments() and p.omega() that starts at R = 1; read: R, flat."""
    bullet = Rigid(dt)
    body = bullet.body(1.0, p.moments(), (0.0, 0.0, 0.0), p.omega(), maximal)
    return EngineRun(bullet.step, lambda: bullet.R(body).ravel(), bullet.close)


def free_engines(body):
    """Return the runners of both kinds of body in pybullet, and of MuJoCo, on a TurningBody that is free."""
    return (
        engine(PYBULLET, "reduced coordinates", free_body,
               "createMultiBody with its defaults, but no damping and no clamp of velocity",
               order=1, limit=free_limits(body.T, (EXPLICIT,)), predicted=body.predict(EXPLICIT_TERM)),
        engine(PYBULLET, "", partial(free_body, maximal=True), "useMaximalCoordinates=1, no damping",
               order=1, limit=free_limits(body.T, (IMPLICIT,)), predicted=body.predict(IMPLICIT_TERM)),
        engine(MUJOCO, "", mujoco.free_body, "freejoint; Runge–Kutta 4",
               order=4, limit=free_limits(body.T), predicted=body.predict(MUNTHE_KAAS), most_steps=5000),
    )


def mujoco_default(body):
    """Return the runner of MuJoCo's own default on a TurningBody that is free."""
    return engine(MUJOCO, "default", partial(mujoco.free_body, integrator="Euler"),
                  "freejoint; the semi-implicit Euler step",
                  order=1, limit=free_limits(body.T, (EXPLICIT,)), predicted=body.predict(EXPLICIT_TERM),
                  most_steps=5000)


def observe_rotation(state, p):
    """Return R, nine numbers, in which q and −q are equal."""
    return quaternion_matrix(*state[0]).ravel()


# the fields that the scenes of a body without a torque share
FREE_BODY = {
    "lesson": "rotation",
    "observe": observe_rotation,
    "points": axes_seen,
    "links": axes_links,
    "poses": turned_in_place,
    "uses": ("one orientation", "one angular momentum", "one step function"),
    "ablations": {
        "position": "the whole loop of lesson 10 has it, and is measured",
        "contacts": "the whole loop of lesson 10 has them, and is measured",
    },
}


def rolling_ball(ball, v, maximal, dt):
    """Make an EngineRun of a ball bowled along x on a horizontal floor; read: distance, speed and rim speed."""
    bullet = Rigid(dt, ball.gravity, iterations=100)
    bullet.floor()
    body = bullet.body(ball.m, ball.I_body, (0.0, 0.0, ball.radius), np.zeros(3), maximal,
                       v=v, shape=bullet.ball(ball.radius), mu=ball.mu)
    read = lambda: np.array([bullet.position(body)[0], bullet.velocity(body)[0], ball.radius * bullet.omega(body)[1]])
    return EngineRun(bullet.step, read, bullet.close)
