"""Towers of boxes on a floor: their Model, and what engines read of them; whether a Model stands in an engine."""

import numpy as np

from solutions.support.model import Body, friction_of, make_model, start_of
from solutions.support.shapes import Box, HalfSpace
from validate.engines import watched
from validate.engines.switches import worlds_made
from validate.scene import PYMUNK
from validate.scenes._common import one_reading

DT = 1.0 / 240.0             # of the engines [s]
WAITING = 3.0                # duration of their runs [s]
WATCHED = 1.0                # duration of a run that shows whether something stands [s]
OVERLAP = 1e-6               # of pymunk's bodies at first [m]: it detects a contact only if they overlap
# of pybullet; the floor has other coordinates than the boxes, so that the solver begins at its contacts from zero
FROM_ZERO = {"overlap": 0.0, "slop": 1e-5, "ground": False, "weighed": False}


def tower(masses, size, g, mu, d):
    """Return the Model of a floor and boxes on it, from the lowest to the highest; they do not overlap."""
    up = np.eye(d)[-1]
    boxes = [Body(tuple(size * (k + 0.5) * up), m, Box((0.5 * size,) * d), np.sqrt(mu) if k else mu)
             for k, m in enumerate(masses)]
    return make_model([Body((0.0,) * d, shape=HalfSpace(tuple(up), 0.0), mu=1.0), *boxes], tuple(-g * up))


def frictions(tower):
    """Return the coefficients of the joints, from the floor upwards."""
    return tuple(friction_of(tower, k, k + 1) for k in range(len(tower.bodies) - 1))


def in_tower(product, model, answer, waiting=WAITING, **settings):
    """Return make(p, dt) of an engine's runner, one long reading of model(p, d): cubes where it is in space.

    waiting [s]: until it is read;    answer(p, F, shifts): of the force under each box [N], and of how far each has
    moved up [m].  A force is that of all contacts of a joint, because contacts tilt as corners sink, and friction
    carries the rest.
    """
    def make(p, dt):
        tower = model(p, 2 if product == PYMUNK else 3)
        world = product.world.build(tower, DT, **settings)

        def read():
            for _ in range(round(waiting / DT)):
                world.step()
            F = np.zeros(len(tower.bodies) - 1)
            for push in world.pushes():
                F[max(push.a, push.b) - 1] += abs(push.F[-1])
            return answer(p, F, (world.state().x - start_of(tower).x)[1:, -1])
        return one_reading(read, world.close)
    return make


def stands_in(product, model, moved, kept, dt, **settings):
    """Return whether no body of a Model has moved by more than `moved` [m] after a second; kept: gets watched steps."""
    with worlds_made() as made:
        world = product.world.build(model, dt, **settings)
    watching = watched.Pymunk(*made, dt) if product == PYMUNK else watched.Bullet(made[0].pb, dt, made[0].gravity)
    watched.run(watching, round(WATCHED / dt), kept)
    far = np.max(np.abs(world.state().x - start_of(model).x))
    world.close()
    return far < moved
