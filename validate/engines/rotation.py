"""Rolling bodies in the engines."""

import numpy as np

from validate.engines.bullet import Rigid
from validate.scene import EngineRun


def rolling_ball(ball, v, omega, maximal, dt):
    """Make an EngineRun of a RollingBall with a first v and ω on its floor; read: distance, speed and rim speed."""
    bullet = Rigid(dt, ball.gravity, iterations=100)
    bullet.floor()
    body = bullet.body(ball.m, ball.I_body, (0.0, 0.0, ball.radius), omega, maximal,
                       v=v, shape=bullet.ball(ball.radius), mu=ball.mu)
    read = lambda: np.array([bullet.position(body)[0], bullet.velocity(body)[0], ball.radius * bullet.omega(body)[1]])
    return EngineRun(bullet.begin().step, read, bullet.close)
