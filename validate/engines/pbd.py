"""Pendulums and ropes in pymunk.  In pybullet they are the `chain` of bullet.py."""

import numpy as np

from validate.engines.chipmunk import pymunk_space, pymunk_world

# of the engines' solvers for each link: an impulse travels one link per sweep, in both directions
ITERATIONS = 10
FEWER = 3                    # sweeps with which pymunk's rope errs as much, but for 1 %, and is three times as fast


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
