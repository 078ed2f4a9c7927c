"""Free and rolling bodies in pybullet, and what the scenes of free bodies share."""

import numpy as np

from validate.drawing import axes_links, axes_seen, turned_in_place
from validate.engines.bullet import Rigid
from validate.reference.orientation import quaternion_matrix
from validate.scene import PYBULLET, Engine, EngineRun


def free_body(maximal):
    """Return make(p, dt) of a free body with p.moments() and p.omega() that starts at R = 1; read: R, flat."""
    def make(p, dt):
        bullet = Rigid(dt)
        body = bullet.body(1.0, p.moments(), (0.0, 0.0, 0.0), p.omega(), maximal)
        return EngineRun(bullet.step, lambda: bullet.R(body).ravel(), bullet.close)
    return make


FREE_ENGINES = (
    Engine(
        PYBULLET,
        "reduced coordinates",
        free_body(False),
        1,
        "createMultiBody with its defaults, but no damping and no clamp of velocity",
    ),
    Engine(PYBULLET, "", free_body(True), 1, "useMaximalCoordinates=1, no damping"),
)


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
