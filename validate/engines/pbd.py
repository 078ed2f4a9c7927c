"""Pendulums and ropes in both engines."""

import numpy as np

from validate.engines.bullet import Rigid
from validate.engines.chipmunk import pymunk_space, pymunk_world
from validate.scene import EngineRun

ITERATIONS = 10              # of the engines' solvers for each link: news of an impulse goes one link a sweep, to and fro

SHARE = 0.1                  # moment of inertia of a bob in pybullet over m l²: its solver sweeps over three axes, and a point has none


def pymunk_rope(x, l, m, g, dt, read):
    """A EngineRun of point masses on PinJoints, held in the origin; x (n, 2) to begin with.  What a step leaves a link off by, the next undoes."""
    import pymunk
    space = pymunk_space((0.0, -g))
    space.iterations = ITERATIONS * max(len(x), 10)
    above, bodies = space.static_body, []
    for place in x:
        body = pymunk.Body(m, float("inf"))
        body.position = tuple(map(float, place))
        joint = pymunk.PinJoint(above, body, (0.0, 0.0), (0.0, 0.0))
        joint.distance = l
        joint.error_bias = 0.0
        space.add(body, joint)
        bodies.append(body)
        above = body
    return pymunk_world(space, dt, lambda: read(np.array([body.position for body in bodies])))


def bullet_rope(x, m, g, inertia, dt, read):
    """The same of bodies with a moment of inertia that turn with the link above them: point-to-point constraints; z is up."""
    bullet = Rigid(dt, (0.0, 0.0, -g), iterations=ITERATIONS * max(len(x), 10), erp=1.0)
    pb = bullet.pb
    bodies, above = [], np.zeros(2)
    for k, place in enumerate(x):
        body = bullet.body(m, (inertia,) * 3, (place[0], 0.0, place[1]), np.zeros(3), True)
        arm = [float(above[0] - place[0]), 0.0, float(above[1] - place[1])]
        if bodies:
            pb.createConstraint(bodies[-1], -1, body, -1, pb.JOINT_POINT2POINT, [0, 0, 0], [0, 0, 0], arm)
        else:
            bullet.pivot(body, arm, True)
        bodies.append(body)
        above = place
    return EngineRun(bullet.step, lambda: read(np.array([bullet.position(body) for body in bodies])[:, ::2]), bullet.close)
