"""Mechanisms: bodies on hinges in closed loops, for the joints of lesson 10 and as Models for the engines."""

import numpy as np

from solutions.simulator import make_bodies, make_bodies_2d, make_joints
from solutions.support.model import WORLD, Body, Hinge, make_model
from validate.reference.contact_laws import Motion, Physics, Step, Touching

SIZE = 0.01                  # half size of a body that touches nothing [m]


def physics_of_boxes(m, half, g, mu):
    """Return the Physics of boxes in the plane, and of the floor as a last row; those of infinite mass are supports."""
    inverse = np.stack((1.0 / m, 3.0 / (m * np.sum(half**2, axis=1))), axis=1)
    return Physics(np.array([0.0, -g]), *np.vstack((inverse, np.zeros(2))).T, mu)


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
