"""Given with lesson 10.  The rows of a Model: its bodies, shapes, joints, rods and springs as arrays for our loop."""

from typing import NamedTuple

import numpy as np

from ..checks import positive_number
from ..support.broad_phase import Pairs
from ..support.convex_2d import Cores
from ..support.convex_3d import NO_HULLS, RoundedBoxes
from ..support.hulls import hulls_of
from ..support.model import (
    WORLD,
    Body,
    Distance,
    Drag,
    Hinge,
    State,
    Weld,
    can_move,
    friction_of,
    make_model,
    own_place,
    start_of,
    touching_pairs,
    world_place,
)
from ..support.scenes import PileState, no_contacts
from ..support.shapes import Ball, Box, Capsule, HalfSpace, Polyhedron, core_of, inner_radius, size_of
from .joints import Joints, farthest_neighbour, form_loops
from .rods import Rods

ALIKE = 40.0                 # difference of bodies up to which the changes of impulses show when sweeps are over [-]
CALM = 40.0                  # by which the velocities at contacts may change more than the impulses, in shares [-]
MORE = 100.0                 # by which there may be more sweeps at most [-]
SLOP = 5e-3                  # overlap that stays, over the smallest half size of a shape [-]


class Settings(NamedTuple):
    """How a model is solved.

    Ever shorter steps approach the same motion with all settings.  Impacts are an exception: their impulses come from
    sweeps, which end before the impulses are exact.
    """
    sweeps: int = 100        # over all contacts in a step, at most; more where bodies differ much (see difference)
    # sweeps end when one changes no impulse by more than this share of the largest one among bodies that touch, also
    # through others [-]
    settled: float = 1e-4
    margin: float | None = None   # gap up to which a contact is found [m]; None: a tenth of the smallest shape's size


class Composed(NamedTuple):
    """What does not change in a run.  Rows: bodies with shapes, half-spaces, bodies without shapes, the world."""
    inv_mass: np.ndarray     # (rows,) [1/kg]
    inv_inertia: np.ndarray  # (rows,), in space (rows, 3) about the axes of the bodies [1/(kg m²)]
    half: tuple              # the shapes: Cores in the plane, RoundedBoxes in space
    planes: np.ndarray       # (h, d + 1)
    gravity: np.ndarray      # (d,) [m/s²]
    mu: float                # friction, if it is the same for all pairs [-]
    mu_of: np.ndarray        # (rows,) of each body
    e_of: np.ndarray         # (rows,) restitution of each body [-]
    pairs: Pairs             # all that could touch
    sweeps: int
    settled: float
    calm: float              # share of the velocities at contacts that settled sweeps may change [-]; ∞: any
    margin: float
    slop: float              # overlap that stays [m]
    joints: Joints           # hinges, ball joints and welds
    rods: Rods
    ends: np.ndarray         # (s, 2) bodies of springs
    arms: np.ndarray         # (s, 2 d) their points, in coordinates of the bodies [m]
    laws: np.ndarray         # (s, 3) rest [m], k [N/m], c [N s/m]
    drag: float              # [N s/m]


# ---------------------------------------------------------------------------------------------- bodies

def ordered_bodies(model):
    """Return (order, n, h): numbers of bodies as rows: n with shapes, then h half-spaces, then those without shapes."""
    kinds = [2 if body.shape is None else 1 if isinstance(body.shape, HalfSpace) else 0 for body in model.bodies]
    return np.argsort(kinds, kind="stable"), kinds.count(0), kinds.count(1)


def rows_in_order(model):
    """Return the row (bodies,) of each body of the model."""
    order, _, _ = ordered_bodies(model)
    row = np.empty(len(order), np.int64)
    row[order] = np.arange(len(order))
    return row


def in_order(row, state):
    """Return the State of all bodies of the model, in its order; row: the row of each body."""
    return State(*(rows[row] for rows in state[:4]))


def rows_of(model, settings):
    """Return (Composed, PileState, row (bodies,) of each body of the model)."""
    order, n, h = ordered_bodies(model)
    row, bodies, d = rows_in_order(model), [model.bodies[k] for k in order], model.d
    sizes, thin = [size_of(body.shape) for body in bodies[:n]], [min(half_of(body.shape, d)) for body in bodies[:n]]
    margin = 0.1 * min(sizes, default=1.0) if settings.margin is None else settings.margin
    rubs = {friction_of(model, i, j) for i, j in touching_pairs(model)}
    inv_mass, uneven = np.array([1.0 / body.m for body in bodies] + [0.0]), difference(bodies[:n], d) / ALIKE
    p = Composed(
        inv_mass, np.array([np.divide(1.0, body.inertia) for body in bodies] + [np.zeros(d if d == 3 else ())]),
        cores_of(bodies[:n]) if d == 2 else rounded_boxes_of(bodies[:n]), planes_of(bodies[n:n + h], d),
        np.array(model.gravity), rubs.pop() if len(rubs) == 1 else 0.0,
        np.array([body.mu for body in bodies] + [0.0]), np.array([body.e for body in bodies] + [0.0]),
        pairs_of(model, row, n), int(settings.sweeps * min(max(uneven, 1.0), MORE)), float(settings.settled),
        CALM * settings.settled if uneven > 1.0 else np.inf, positive_number("margin [m]", margin),
        SLOP * min(thin, default=1.0), joints_of(model, row, inv_mass), rods_of(model, row),
        *springs_of(model, row, len(bodies)),
        float(sum(load.k for load in model.loads if isinstance(load, Drag))))
    return p, PileState(*states_of_rows(model, order), no_contacts(n, d), np.zeros((0, d))), row


def difference(bodies, d):
    """Return by how much the lightest end of all these bodies is lighter than the heaviest centre [-]; 0 without any.

    A sweep leaves r/(1 + r) of an error where a body lies on one that is r times as light (lesson 9), so that it takes
    r times as many sweeps.  At a lever of r a body is as light as  1/(1/m + r²/I).
    """
    lightest, heaviest = np.inf, 0.0
    for body in filter(can_move, bodies):
        points = np.array(body.shape.corners if hasattr(body.shape, "corners") else [half_of(body.shape, d)])**2
        levers = np.max(np.sum(points, axis=1, keepdims=True) - (points if d == 3 else 0.0), axis=0)
        lightest = min(lightest, 1.0 / (1.0 / body.m + np.max(levers / np.array(body.inertia))))
        heaviest = max(heaviest, body.m)
    return heaviest / lightest


def states_of_rows(model, order):
    """Return (x, q, v, omega) of all rows at the start; the last row is the world."""
    world = make_model([Body((0.0,) * model.d)], model.gravity)
    return [np.concatenate((rows[order], last)) for rows, last in zip(start_of(model), start_of(world))]


def cores_of(bodies):
    """Return the Cores of bodies with shapes in the plane."""
    cores = [core_of(body.shape) for body in bodies]
    half = [half_of(body.shape, 2) for body in bodies]
    return Cores(np.concatenate([np.zeros((0, 2)), *[corners for corners, _ in cores]]),
                 np.cumsum([0] + [len(corners) for corners, _ in cores]), np.array([r for _, r in cores], float),
                 np.array(half, float).reshape(-1, 2))


def rounded_boxes_of(bodies):
    """Return the RoundedBoxes of bodies with shapes in space, with Hulls if one of them is a Polyhedron."""
    shapes = [body.shape for body in bodies]
    core = [shape.half if isinstance(shape, Box) else
            (shape.half_length if isinstance(shape, Capsule) else 0.0, 0.0, 0.0) for shape in shapes]
    radius = [shape.radius if isinstance(shape, Ball | Capsule) else 0.0 for shape in shapes]
    half, solid = [half_of(shape, 3) for shape in shapes], any(isinstance(shape, Polyhedron) for shape in shapes)
    return RoundedBoxes(np.array(core, float).reshape(-1, 3), np.array(radius, float),
                        np.array(half, float).reshape(-1, 3), hulls_of(shapes) if solid else NO_HULLS)


def half_of(shape, d):
    """Return half sizes (d,) [m] of a box around a shape, whose least one is its thickness."""
    if isinstance(shape, Box):
        return shape.half
    if isinstance(shape, Capsule):
        return (size_of(shape), *(shape.radius,) * (d - 1))
    return (size_of(shape), *(inner_radius(shape),) * (d - 1))


def planes_of(bodies, d):
    """Return rows (h, d + 1) of half-spaces."""
    return np.array([(*body.shape.normal, body.shape.offset) for body in bodies], float).reshape(-1, d + 1)


def pairs_of(model, row, n):
    """Return the Pairs of rows that could touch."""
    partners = [[] for _ in range(n)]
    for i, j in touching_pairs(model):
        low, high = sorted((int(row[i]), int(row[j])))
        partners[low].append(high)
    first = np.cumsum([0] + [len(found) for found in partners])
    return Pairs(first, np.array([j for found in partners for j in sorted(found)], np.int64))


# ---------------------------------------------------------------------------------------------- joints

def rods_in(model):
    """Return the numbers of the joints that are a Distance."""
    return [k for k, joint in enumerate(model.joints) if isinstance(joint, Distance)]


def points_of(model, joint):
    """Return the places (d,) that a joint holds together.

    A ball joint, and a hinge in the plane, hold one.  A hinge in space holds two on its axis.  A weld holds as many as
    fix a body: two in the plane, three in space.  A Distance holds none; rods_of has it.
    """
    if isinstance(joint, Distance):
        return []
    place, d = np.array(joint.place), model.d
    sizes = [size_of(model.bodies[k].shape) for k in (joint.a, joint.b)
             if k != WORLD and model.bodies[k].shape is not None]
    arm = min(sizes, default=1.0)
    if isinstance(joint, Weld):
        return [place, *(place + arm * np.eye(d)[:d - 1])]
    if isinstance(joint, Hinge) and d == 3:
        return [place - 0.5 * arm * np.array(joint.axis), place + 0.5 * arm * np.array(joint.axis)]
    return [place]


def joints_of(model, row, inv_mass):
    """Return the Joints of a model."""
    points, d = [(joint.a, joint.b, place) for joint in model.joints for place in points_of(model, joint)], model.d
    a = np.array([row[i] for i, _, _ in points], np.int64)
    b = np.array([row[j] if j != WORLD else inv_mass.size - 1 for _, j, _ in points], np.int64)
    r_a, r_b = (np.array([own_place(model, k, place) for k, place in ends]).reshape(-1, d)
                for ends in ([(i, place) for i, _, place in points], [(j, place) for _, j, place in points]))
    return Joints(a, b, r_a, r_b, d * (farthest_neighbour(a, b, inv_mass) + 1) - 1, form_loops(a, b, inv_mass))


def lengths_of(model, rods):
    """Return the length [m] of each of these Distances at the start."""
    start = start_of(model)
    ways = [world_place(start, rod.a, rod.place_a) - world_place(start, rod.b, rod.place_b) for rod in rods]
    return [float(np.sqrt(way @ way)) for way in ways]


def rods_of(model, row):
    """Return the Rods of a model."""
    rods = [model.joints[k] for k in rods_in(model)]
    a, b = (np.array([len(row) if k == WORLD else row[k] for k in ends], np.int64)
            for ends in ([rod.a for rod in rods], [rod.b for rod in rods]))
    r_a, r_b = (np.array(places, float).reshape(-1, model.d)
                for places in ([rod.place_a for rod in rods], [rod.place_b for rod in rods]))
    lengths, compliances = np.array(lengths_of(model, rods), float), np.array([rod.compliance for rod in rods], float)
    return Rods(a, b, r_a, r_b, lengths, compliances)


def springs_of(model, row, world):
    """Return (ends (s, 2), arms (s, 2 d), laws (s, 3)) of the springs."""
    ends = [(row[s.a], world if s.b == WORLD else row[s.b]) for s in model.springs]
    arms, laws = [(*s.place_a, *s.place_b) for s in model.springs], [(s.rest, s.k, s.c) for s in model.springs]
    return (np.array(ends, np.int64).reshape(-1, 2), np.array(arms, float).reshape(-1, 2 * model.d),
            np.array(laws, float).reshape(-1, 3))
