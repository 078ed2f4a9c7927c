"""A block on a plane as a Model, and a particle in a hollow in pybullet: the comparison runs of lesson 3.

The engines hold a resting block by impulses, as our sliding_step does, and differ from it in the order of motion:
pybullet moves with the new velocity, pymunk with the old one.
"""

import numpy as np

from solutions.support.model import Body, make_model
from solutions.support.shapes import Ball, Box, HalfSpace
from validate.engines.switches import worlds_made
from validate.reference.friction import HALF
from validate.scene import PYBULLET, EngineRun

# half its height [m]: friction acts that far below the centre and shifts the load forward by μ LOW.  With a cube and
# μ = 0.8 nearly all load is on the front edge, and pybullet's friction is up to 0.7 % too large
LOW = 0.1
MASS = 1.0                   # of a particle [kg]
# of the contact solvers: the contacts of a flat slab converge by a factor of 2 or more per sweep
SWEEPS = 100


def slab(gravity, mu, v=None, m=1.0, loads=()):
    """Make a slab on a floor of friction 1, in the plane or in space; gravity is tilted like the slope."""
    across = (0.0,) * (len(gravity) - 1)
    body = Body((*across, LOW), m, Box((*[HALF for _ in across], LOW)), mu, v=v)
    return make_model([body, floor(gravity)], gravity, loads=loads)


def floor(gravity):
    """Make the floor of a slab: the last axis is normal to it."""
    across = (0.0,) * (len(gravity) - 1)
    return Body((*across, 0.0), shape=HalfSpace((*across, 1.0)), mu=1.0, e=1.0)


def bullet_in_hollow(gravity, mu, x, v, fastest, wall, dt):
    """Make an EngineRun with a ball that slides, and cannot turn, inside a round wall.

    wall(x) → (nearest point (3,), inward normal (3,)).  pybullet has no hollow shapes except meshes of facets.
    Before each step its floor is therefore placed as the tangent plane of the wall under the ball.  Normal force
    and friction there are the engine's, and the error of the plane is of second order in v dt.
    """
    radius = 0.1
    ball = Body(x, MASS, Ball(radius), mu, v=v, inertia=(np.inf,) * 3)
    with worlds_made() as made:
        world = PYBULLET.world.build(make_model([ball, floor(gravity)], gravity), dt, maximal=False, iterations=1,
                                     overlap=0.0, slop=0.0, breaking=max(0.02, 1.2 * fastest * dt / radius))
    pb = made[0].pb
    one, ground = map(pb.getBodyUniqueId, range(2))

    def step():
        point, n = wall(made[0].position(one))
        below = [float(c - radius * k) for c, k in zip(point, n)]
        # the shortest turn from z to n, as a quaternion (x, y, z, w)
        pb.resetBasePositionAndOrientation(ground, below, [-float(n[1]), float(n[0]), 0.0, 1.0 + float(n[2])])
        world.step()
    return EngineRun(step, lambda: world.state().x[0], world.close)
