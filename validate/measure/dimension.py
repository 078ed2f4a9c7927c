"""A Model in the plane in both loops of lesson 10: in the plane, and in space with a third coordinate that stays 0."""

from functools import partial
from itertools import starmap
from typing import NamedTuple

import numpy as np

from solutions.support.model import State, friction_of, restitution_of, start_of, touching_pairs
from solutions.support.shapes import Ball, Box, HalfSpace

SWEEPS = 60                  # each leaves half of a slip in space, so these leave round-off
MARGIN = 0.1                 # gap up to which a contact is found, over the smallest half size of a body [-]
STEPS = {2: "contact_step_2d", 3: "contact_step"}
FINDERS = {                  # {(shape, dimension): (bounds, contacts)}
    (Ball, 2): ("disc_bounds", "round_contacts"), (Ball, 3): ("ball_bounds", "round_contacts"),
    (Box, 2): ("box_bounds_2d", "box_contacts_2d"), (Box, 3): ("box_bounds", "box_contacts"),
}


class Lifted(NamedTuple):
    """A Model in a loop of lesson 10."""
    names: tuple             # of the functions of a step: step, load, bounds, contacts
    state: object            # PileState at the start
    bodies: object           # Bodies
    row: np.ndarray          # of each body of the Model


def in_both(lesson, model):
    """Return {2: Lifted, 3: Lifted} of a Model in the plane whose bodies all have shapes.

    None where the loops of lesson 10 lack something: they have discs or boxes, gravity alone, one friction, and
    contacts that do not bounce.
    """
    kinds = {type(body.shape) for body in model.bodies} - {HalfSpace}
    pairs = touching_pairs(model)
    rubs = set(starmap(partial(friction_of, model), pairs))
    if (model.joints or model.springs or model.loads or len(kinds) != 1 or not kinds <= {Ball, Box} or len(rubs) > 1
            or any(starmap(partial(restitution_of, model), pairs))):
        return None
    return {dim: lifted(lesson, model, kinds.copy().pop(), dim, rubs.copy().pop() if rubs else 0.0) for dim in STEPS}


def lifted(lesson, model, kind, dim, mu):
    """Return the Lifted of a Model in the plane (dim 2) or in space (dim 3)."""
    order = sorted(range(len(model.bodies)), key=lambda k: isinstance(model.bodies[k].shape, HalfSpace))
    shaped = [model.bodies[k] for k in order if not isinstance(model.bodies[k].shape, HalfSpace)]
    flat, s = [model.bodies[k].shape for k in order[len(shaped):]], start_of(model)
    half = np.array([(*sizes_of(body.shape), min(sizes_of(body.shape))) for body in shaped])[:, :dim]
    x, v = (wide(rows[order], dim) for rows in (s.x, s.v))
    n, inertia = len(shaped), np.array([body.inertia for body in shaped], dtype=float)
    make = (lesson.make_bodies_2d, lesson.make_bodies)[dim - 2]
    state, bodies = make(
        x[:n], turned(s.q[order][:n], dim), np.array([body.m for body in shaped]),
        inertia if dim == 2 else np.repeat(inertia[:, None], 3, axis=1), half,
        np.array([(*wide(np.array([plane.normal]), dim)[0], plane.offset) for plane in flat]).reshape(-1, dim + 1),
        wide(np.array([model.gravity]), dim)[0], mu, SWEEPS, MARGIN * half.min())
    omega = s.omega[order] if dim == 2 else np.pad(s.omega[order][:, None], ((0, 0), (2, 0)))
    row = np.empty(len(order), int)
    row[order] = np.arange(len(order))
    return Lifted((STEPS[dim], "weight", *FINDERS[kind, dim]), state._replace(v=v, omega=omega), bodies, row)


def sizes_of(shape):
    """Return the half sizes (2,) of a disc or a box."""
    return shape.half if isinstance(shape, Box) else (shape.radius,) * 2


def wide(rows, dim):
    """Return vectors (n, 2) with as many components, of which the third is 0."""
    return np.pad(rows, ((0, 0), (0, dim - 2)))


def turned(angles, dim):
    """Return angles as they are, or as quaternions about the third axis."""
    if dim == 2:
        return angles
    zero = np.zeros(len(angles))
    return np.stack((np.cos(0.5 * angles), zero, zero, np.sin(0.5 * angles)), axis=1)


def advancing(lesson, one):
    """Return the function (steps, dt) → PileState of a Lifted, with a plain or a compiled lesson."""
    functions = [getattr(lesson, name) for name in one.names]
    return lambda steps, dt: lesson.advance_contact(*functions, 0.0, one.state, dt, steps, one.bodies)


def state_in_plane(one, state):
    """Return the State of all bodies of the Model; a turn in space is one about the third axis."""
    x, v, q, omega = (rows[one.row] for rows in (state.x, state.v, state.q, state.omega))
    if q.ndim == 1:
        return State(x, q, v, omega)
    return State(x[:, :2], 2.0 * np.arctan2(q[:, 3], q[:, 0]), v[:, :2], omega[:, 2])
