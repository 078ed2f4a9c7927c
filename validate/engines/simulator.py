"""Boxes and balls on a floor, in both engines."""

import numpy as np

from validate.engines.bullet import Rigid
from validate.engines.chipmunk import pymunk_space
from validate.scene import EngineRun

OVERLAP = 1e-6               # with which pymunk's bodies begin [m], because it detects a contact only if bodies overlap
HEAVY = 1e9                  # mass of pybullet's turntable over that of the ball [-]: it falls by 1e-7 m in 5 s
ITERATIONS = 100             # of both engines' contact solvers


def pymunk_floor_space(g, mu):
    """Make a space with a floor y = 0 of that friction; the bodies that stand on it have 1."""
    import pymunk
    space = pymunk_space((0.0, -g))
    space.iterations = ITERATIONS
    floor = pymunk.Segment(space.static_body, (-1000.0, -5.0), (1000.0, -5.0), 5.0)
    floor.friction = mu
    space.add(floor)
    return space


def pymunk_body(space, m, I, x, angle, make):
    """Add a body with the shape make(body), of friction 1."""
    import pymunk
    body = pymunk.Body(m, I)
    body.position, body.angle = tuple(map(float, x)), float(angle)
    shape = make(body)
    shape.friction = 1.0
    space.add(body, shape)
    return body


def pybullet_turntable(ball, x, v, omega, dt):
    """Make an EngineRun of a ball on a very heavy box that rotates; read: x, y and both velocities.

    In maximal coordinates Bullet ignores the velocity of a body without mass.  Gravity is a force on the ball only.
    """
    bullet, half = Rigid(dt, iterations=ITERATIONS), np.array([3.0, 3.0, 0.5])
    shape = bullet.pb.createCollisionShape(bullet.pb.GEOM_BOX, halfExtents=half.tolist())
    bullet.body(HEAVY * ball.m, HEAVY * ball.m * np.ones(3), (0.0, 0.0, -half[2]), ball.floor_omega, True, shape=shape,
                mu=1.0)
    body = bullet.body(ball.m, ball.I_body, x, omega, True, v=v, shape=bullet.ball(ball.radius), mu=ball.mu)
    bullet.begin()
    weight = (ball.m * ball.gravity).tolist()

    def step():
        bullet.push(body, weight, bullet.position(body))
        bullet.step()
    read = lambda: np.array([*bullet.position(body)[:2], *bullet.velocity(body)[:2]])
    return EngineRun(step, read, bullet.close)


def pybullet_box(bullet, m, I, half, x, R, mu):
    """Add a box in maximal coordinates."""
    shape = bullet.pb.createCollisionShape(bullet.pb.GEOM_BOX, halfExtents=list(map(float, half)))
    return bullet.body(m, I, x, np.zeros(3), True, R=R, shape=shape, mu=mu)


def pybullet_slab(bullet):
    """Add a fixed box below z = 0, of friction 1: a plane would give one contact per step only."""
    shape = bullet.pb.createCollisionShape(bullet.pb.GEOM_BOX, halfExtents=[5.0, 5.0, 1.0])
    slab = bullet.pb.createMultiBody(0, shape, basePosition=[0.0, 0.0, -1.0], useMaximalCoordinates=1)
    bullet.pb.changeDynamics(slab, -1, lateralFriction=1.0, rollingFriction=0, spinningFriction=0, restitution=0)
