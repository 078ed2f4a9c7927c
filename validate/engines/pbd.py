"""Pendulums and ropes in both engines."""

import numpy as np

from validate.engines.bullet import Rigid
from validate.engines.chipmunk import pymunk_space, pymunk_world
from validate.scene import EngineRun

# of the engines' solvers for each link: an impulse travels one link per sweep, in both directions
ITERATIONS = 10
FEWER = 3                    # sweeps with which pymunk's rope errs the same to 1 %, and is three times as fast
# moment of inertia of a bob in pybullet over m l²: its solver sweeps over three axes, and a point has none
SHARE = 0.1


def pymunk_rope(x, l, m, g, dt, read, iterations):
    """Make an EngineRun of point masses on PinJoints, held in the origin; x (n, 2) are the initial positions.

    The error that a step leaves in a link is corrected in the next step.
    """
    import pymunk
    space = pymunk_space((0.0, -g))
    space.iterations = iterations
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


def bullet_sweeps(links):
    """Return how often pybullet visits each link in a step."""
    return ITERATIONS * max(links, 10)


def bullet_rope(x, m, g, inertia, dt, read):
    """Make the same of bodies with inertia, which rotate with the link above, on point-to-point constraints.

    z is up.  In maximal coordinates a moment of inertia has no effect before the second step, and a body without shape
    could not rotate in the first one.  A first step without gravity is therefore made beforehand.
    """
    bullet = Rigid(dt, iterations=bullet_sweeps(len(x)), erp=1.0)
    pb = bullet.pb
    bodies, above = [], np.zeros(2)
    for place in x:
        body = bullet.body(m, (inertia,) * 3, (place[0], 0.0, place[1]), np.zeros(3), True)
        arm = [float(above[0] - place[0]), 0.0, float(above[1] - place[1])]
        if bodies:
            pb.createConstraint(bodies[-1], -1, body, -1, pb.JOINT_POINT2POINT, [0, 0, 0], [0, 0, 0], arm)
        else:
            bullet.pivot(body, arm, True)
        bodies.append(body)
        above = place
    bullet.step()
    pb.setGravity(0.0, 0.0, -g)
    places = lambda: np.array([bullet.position(body) for body in bodies])
    return EngineRun(bullet.step, lambda: read(places()[:, ::2]), bullet.close)
