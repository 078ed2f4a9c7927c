"""Masses on springs in pymunk."""

import numpy as np

from validate.engines.chipmunk import pymunk_space, pymunk_world


def pymunk_net(net, dt, observe):
    """Make an EngineRun of point masses and DampedSprings; observe(x (n, d)) reads it.

    Masses are equal, so wind is a part of gravity, and viscosity is one factor e^(−k_v dt/m) on all velocities.  The
    factor also reduces the impulse that the springs have just given.  At rest they are therefore stretched e^(k_v dt/m)
    times too far, a first-order error.
    """
    import pymunk
    wide = net.padded()
    space = pymunk_space((wide.gravity + wide.wind / net.m)[:2])
    space.damping = np.exp(-net.k_v / net.m)             # the fraction of velocity kept after one second
    bodies = []
    for n, (x, v) in enumerate(zip(wide.x, wide.v)):
        held = n in net.fixed
        body = pymunk.Body(body_type=pymunk.Body.STATIC) if held else pymunk.Body(net.m, float("inf"))
        body.position = tuple(map(float, x[:2]))
        if not held:
            body.velocity = tuple(map(float, v[:2]))
        space.add(body)
        bodies.append(body)
    for (i, j), rest in zip(net.pairs, net.rest):
        if not (i in net.fixed and j in net.fixed):      # between two fixed ends there is nothing to solve
            space.add(pymunk.DampedSpring(bodies[i], bodies[j], (0.0, 0.0), (0.0, 0.0), float(rest), net.k, net.k_d))
    d = net.x.shape[1]
    return pymunk_world(space, dt, lambda: observe(np.array([body.position for body in bodies])[:, :d]))
