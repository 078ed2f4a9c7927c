"""Mechanisms: bodies on hinges in closed loops, for the joints of lesson 10 and as Models for the engines."""

from functools import partial

import numpy as np

from solutions.simulator import make_bodies, make_bodies_2d, make_joints
from solutions.support.model import WORLD, Body, Hinge, make_model
from solutions.support.shapes import Box, HalfSpace
from validate.engines import watched
from validate.reference.contact_laws import Motion, Physics, Step, Touching
from validate.scene import PYMUNK

SIZE = 0.01                  # half size of a body that touches nothing [m]


def physics_of_boxes(m, half, g, mu):
    """Return the Physics of boxes in the plane, and of the floor as a last row; those of infinite mass are supports."""
    inverse = np.stack((1.0 / m, 3.0 / (m * np.sum(half**2, axis=1))), axis=1)
    return Physics(np.array([0.0, -g]), *np.vstack((inverse, np.zeros(2))).T, mu)


def boxes_on_floor(x, q, half, m, v, omega, mu, g, belt=0.0, **more):
    """Return the Model of boxes, some of them without mass, on a floor that moves with `belt` [m/s].

    Each has √μ: a pair has the product.  more: springs and loads
    """
    root = float(np.sqrt(mu))
    floor = Body((0.0, 0.0), shape=HalfSpace((0.0, 1.0)), mu=root, v=(belt, 0.0))
    boxes = [Body(tuple(x[k]), m[k], Box(tuple(half[k])), root, q=q[k], v=tuple(v[k]), omega=omega[k])
             for k in range(len(m))]
    return make_model([floor, *boxes], (0.0, -g), **more)


def watched_boxes(physics, pushed=None):
    """Return what watches pymunk's space of such a Model.

    physics(p) → the Physics of the boxes and of the floor as a last row;
    pushed(space, p, dt, before, after) → impulses (n, 2) of springs and air in a step
    """
    def watch(space, p, dt):
        floor, *boxes = space.bodies
        return watched.Pymunk(space, dt, [*boxes, floor], physics(p), pushed and partial(pushed, space, p, dt))
    return watch


def watched_joints(model, rate, work=None):
    """Return what watches an engine's world of model(p).

    rate(p): the fastest of the motion [1/s];    work(State before, State after) → work of loads in a step [J]
    """
    def watch(*made):
        p, dt = made[-2:]
        return watched.Joined(model(p), dt, rate(p), work)
    return watch


def filmed(model, see, dt, steps, every, **settings):
    """Return see(State) of pymunk's world of a Model at the start and after every `every` steps."""
    world = PYMUNK.world.build(model, dt, **settings)
    found = [see(world.state())]
    for n in range(1, steps + 1):
        world.step()
        if n % every == 0:
            found.append(see(world.state()))
    return np.array(found)


def reported_by_loop(before, after, dt, physics, pushed=None):
    """Return the Step between two PileStates in the plane: the places, gaps and impulses of contacts are in the second.

    The loop does not push overlapping bodies apart, and moves them by their new velocities.
    """
    c, J = after.contacts, after.J
    touching = Touching(c.a, c.b, c.n, c.p, c.p, c.gap, J, np.full(len(c.a), physics.mu), np.zeros_like(J))
    motions = (Motion(now.x, now.v, now.omega) for now in (before, after))
    return Step(dt, *physics[:3], *motions, before.x, 0.0, touching, pushed)


def joined_2d(made, gravity):
    """Return (x, q, v, ω, JointedBodies) of a Mechanism in the plane; the last body is the world."""
    state, rows = make_bodies_2d(made.x, made.q, made.m, made.inertia, np.full(made.x.shape, SIZE), np.zeros((0, 3)),
                                 gravity, 0.0, 1, SIZE)
    return state.x, state.q, made.v, made.omega, make_joints(state, rows, made.a, made.b, made.places, 0.0)


def joined_3d(made, gravity):
    """Return (x, q, v, ω, JointedBodies) of a Mechanism in space; two points on the axis of a hinge are two joints."""
    state, rows = make_bodies(made.x, made.q, made.m, made.inertia, np.full(made.x.shape, SIZE), np.zeros((0, 4)),
                              gravity, 0.0, 1, SIZE)
    return state.x, state.q, made.v, made.omega, make_joints(state, rows, made.a, made.b, made.places, 0.0)


def hinged_model(made, gravity, springs=(), loads=()):
    """Return the Model of a Mechanism in the plane."""
    world = len(made.m) - 1
    bodies = [Body(tuple(map(float, made.x[k])), float(made.m[k]), q=float(made.q[k]), v=tuple(map(float, made.v[k])),
                   omega=float(made.omega[k]), inertia=float(made.inertia[k])) for k in range(world)]
    number = lambda k: WORLD if k == world else int(k)
    hinges = [Hinge(number(a), number(b), tuple(map(float, place)))
              if a != world else Hinge(number(b), WORLD, tuple(map(float, place)))
              for a, b, place in zip(made.a, made.b, made.places)]
    return make_model(bodies, gravity, hinges, springs, loads)
