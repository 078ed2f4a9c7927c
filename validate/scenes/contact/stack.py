"""Ten stacked boxes: the joint under k of them carries k m g, and solvers differ in how fast they find it.

A box has two contacts with the one below.  A sweep passes information only to neighbours: how many boxes are above,
and which way they rock.  That takes long, so the sweeps of contact_forces end in an error for ten boxes.
Murty's method needs a few pivots.  The pile needs two sweeps per substep, because it begins each substep with the
impulses of the last: its sweeps are spread over many steps.
"""

from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import check_positive
from solutions.contact import make_contacts, make_pile, make_pile_2d
from validate.check import states
from validate.engines.bullet import CONTACT_ERP, WARM, WARMER
from validate.engines.mujoco import SOFT
from validate.methods import DIRECT, PILE, PILE_IN_SPACE, SWEEPS
from validate.reference.contact import Settling, Towers, rounded_force, rounded_overlap, sway_of_tower, unrest_in_pymunk
from validate.reference.stored import stored
from validate.scene import EXACT, MUJOCO, PYBULLET, PYMUNK, Scene, engine, ours
from validate.scenes._common import ANSWER, check_positives
from validate.scenes.contact._common import DT, FROM_ZERO, OVERLAP, WAITING, frictions, in_tower, tower
from validate.scenes.drawing import outlines

T = 1.0
MU = 0.5                     # nothing slides
SUBSTEPS, HERTZ, ZETA = 8, 240.0, 10.0       # of the pile: substeps per step, frequency [1/s], damping ratio [-]
SETTLING = 1.5               # duration of the pile's run [s]
ROUNDED = 1e-12              # of the forces of MuJoCo at rest, relative [-]
FINE, DEFAULT = {"iterations": 100, "slop": 1e-4}, {"iterations": 10, "slop": 0.1}       # of pymunk; slop [m]
SETTLED = Settling(DT, SUBSTEPS, HERTZ, ZETA, MU, SETTLING)


class Params(NamedTuple):
    shape: Annotated[str, "boxes touch in two points, discs in one, cubes (in space) in four"] = "boxes"
    n: Annotated[int, "how many"] = 10
    m: Annotated[float, "mass of each [kg]"] = 1.0
    size: Annotated[float, "edge or diameter [m]"] = 1.0
    g: Annotated[float, "gravity [m/s²]"] = 9.81


CASES = {
    "ten boxes": Params(), "five boxes": Params(n=5, m=2.0),
    "ten discs": Params("discs"), "twenty discs": Params("discs", 20),
    "ten cubes in space": Params("cubes"), "five cubes in space": Params("cubes", 5, 2.0),
}


def moment(p):
    return p.m * p.size**2 / (8.0 if p.shape == "discs" else 6.0)


def start(p):
    """Return (centres (n + 1, 2), inverse masses, inverse moments, contacts from below, load).

    The last body is the ground.
    """
    check_positives(p, "m", "size", "g")
    check_positive("n", float(p.n))
    k = np.arange(p.n)
    x = np.stack((np.zeros(p.n + 1), p.size * (np.append(k, -1.0) + 0.5)), axis=1)
    movable = np.append(np.ones(p.n), 0.0)
    sides = np.array((-0.5, 0.5) if p.shape == "boxes" else (0.0,)) * p.size
    a = np.repeat(k, len(sides))
    places = np.stack((np.tile(sides, p.n), p.size * a), axis=1)
    below, up = np.where(a > 0, a - 1, p.n), np.tile((0.0, 1.0), (len(a), 1))
    contacts = make_contacts(a, below, places, up, movable / p.m)
    load = np.zeros((p.n + 1, 3))
    load[:p.n, 1] = -p.m * p.g
    return x, movable / p.m, movable / moment(p), contacts, load


def run(lessons, step, acceleration, state, p, dt, steps):
    """Return the forces at all contacts, (n,) summed joint by joint."""
    contact, (x, inv_mass, inv_inertia, contacts, load) = lessons.contact, state
    if step is contact.advance_pile_2d:
        return (pile_forces(step, contact.box_bounds_2d, contact.box_contacts_2d, p),)
    if step is contact.advance_pile:
        return (pile_forces_in_space(step, contact.box_bounds, contact.box_contacts, p),)
    if step is contact.contact_forces:
        forces = step(x, inv_mass, inv_inertia, contacts, load, np.full(len(contacts.a), MU))[0][:, 0]
    else:                                                     # without friction: the normal rows only
        G, w = contact.contact_rows(x, contacts)[::2], contact.inverse_masses(inv_mass, inv_inertia)
        forces = step(contact.delassus_matrix(G, w), G @ (w * load.ravel()))
    return (forces.reshape(p.n, -1).sum(axis=1),)


def pile_forces(advance, bounds, find_contacts, p):
    """Return the joint forces of a settled stack: the impulses of the last substep over its duration."""
    half = np.full((p.n, 2), 0.5 * p.size)
    state, pile = make_pile_2d(start(p)[0][:p.n], np.zeros(p.n), p.m, moment(p), half, np.array([(0.0, 1.0, 0.0)]),
                               (0.0, -p.g), mu=MU, substeps=SUBSTEPS, hertz=HERTZ, zeta=ZETA, margin=0.02 * p.size)
    return carried(advance(bounds, find_contacts, state, DT, round(SETTLING / DT), pile), pile, p)


def pile_forces_in_space(advance, bounds, find_contacts, p):
    """Return the same of cubes."""
    half, upright = np.full((p.n, 3), 0.5 * p.size), np.tile([1.0, 0.0, 0.0, 0.0], (p.n, 1))
    x = np.insert(start(p)[0][:p.n], 1, 0.0, axis=1)
    state, pile = make_pile(x, upright, p.m, np.full((p.n, 3), moment(p)), half, np.array([(0.0, 0.0, 1.0, 0.0)]),
                            (0.0, 0.0, -p.g), mu=MU, substeps=SUBSTEPS, hertz=HERTZ, zeta=ZETA, margin=0.02 * p.size)
    return carried(advance(bounds, find_contacts, state, DT, round(SETTLING / DT), pile), pile, p)


def carried(end, pile, p):
    """Return the upward forces [N] of all contacts, summed joint by joint."""
    forces = np.zeros(p.n)
    for a, b, J in zip(end.contacts.a, end.contacts.b, end.J):
        forces[0 if b == p.n else max(a, b)] += abs(J[-1]) * pile.substeps / DT
    return forces


def observe(state, p):
    """Return the forces [N] in the joints, from the lowest."""
    return state[0]


def truth(p, t):
    """The joint under k bodies at rest carries k m g.

    Source: Newton's second law for all bodies above a joint.
    """
    return p.m * p.g * np.arange(p.n, 0.0, -1.0)


def swept_limit(p, dt):
    """Sweeps stop when the residual is 1e-13 of the largest (|A||F| + |b|)_k.  With λ the smallest eigenvalue of A, the
    error is at most the residual over λ: in a column of discs λ = 4 sin²(π/(4n + 2))/m, and boxes can rock, too.
    """
    A, here = normal_matrix(p), 2 if p.shape == "boxes" else 1
    values, forces = np.linalg.eigvalsh(A), np.repeat(truth(p, T), here) / here
    return 1e-13 * (np.max(np.abs(A) @ forces) + p.g) / values[0] * np.sqrt(here * p.n) / np.linalg.norm(forces)


def solved_limit(p, dt):
    """Murty's method solves a linear system: 1.1e-16 times the condition of A, and ten for the operations."""
    values = np.linalg.eigvalsh(normal_matrix(p))
    return 10.0 * 1.1e-16 * values[-1] / values[0]


def pile_limit(p, dt, axes=1.0):
    """The pile still rocks slightly when it is read.  A reference that knows only the recursion of its sweeps
    predicts the amount.  It takes the corners as fixed, and the phase of the rocking depends on their exact places.
    So the limit is three times its sway, plus the force of a rounded gap.  In space a cube can rock about two axes,
    so its limit is twice that of the square.
    """
    return axes * 3.0 * sway(p) + rounded_force((p.m,) * p.n, p.size, p.g, HERTZ)


def pymunk_limit(p, dt, iterations, slop):
    """pymunk rocks, too, and the recursion of its sweeps predicts by how much.  Its limit is three times that, plus the
    rounding errors of Murty's method.
    """
    return 3.0 * unrest(p, iterations, slop) + solved_limit(p, dt)


def pybullet_limit(p, dt):
    """pybullet begins each step with the last impulses, so its sweeps accumulate over the steps.  It removes 8 % of an
    overlap per step.  Nothing is left of the first overlaps, but each overlap is rounded.
    """
    return rounded_overlap((p.m,) * p.n, p.size, p.g, CONTACT_ERP, DT)


def creeping_limit(p, dt):
    """With pybullet's default settings sweeps do not accumulate, and its tower creeps.  Each force must be right to a
    hundredth of a box's weight.
    """
    return 0.01 * p.m * p.g / np.linalg.norm(truth(p, T))


def mujoco_limit(p, dt):
    """MuJoCo's contacts are at rest after 150 of their time constants, up to round-off."""
    return ROUNDED


def sway(p):
    """Return the relative error of the forces of the pile when they are read."""
    return stored("stack", sway_of_tower, (p.m,) * p.n, p.size, p.g, SETTLED)


def unrest(p, iterations, slop):
    """Return the relative error of pymunk's forces when they are read."""
    how = Towers(DT, iterations, slop, OVERLAP, frictions(model(p)), WAITING)
    return stored("stack", unrest_in_pymunk, (p.m,) * p.n, p.size, p.g, how)


def normal_matrix(p):
    """Return A of the normal impulses, from heights and rotations (y, θ) of the bodies.

    Contacts are `offsets` off the middle.
    """
    offsets = np.array((-0.5, 0.5) if p.shape == "boxes" else (0.0,)) * p.size
    G = np.zeros((p.n, len(offsets), p.n, 2))
    for k in range(p.n):
        G[k, :, k] = np.stack((np.ones(len(offsets)), offsets), axis=1)
        if k:
            G[k, :, k - 1] = -G[k, :, k]
    G = G.reshape(p.n * len(offsets), 2 * p.n)
    return (G * np.tile((1.0 / p.m, 1.0 / moment(p)), p.n)) @ G.T


# ---------------------------------------------------------------------------------------------- engines

def model(p, d=2):
    return tower([p.m] * p.n, p.size, p.g, MU, d)


def answer(p, forces, shifts):
    return forces


def are_boxes(p):
    """Return whether the bodies are boxes: moving discs would fall over, because they stand on one point."""
    return p.shape == "boxes"


def are_cubes(p):
    return p.shape == "cubes"


def are_boxes_or_cubes(p):
    return are_boxes(p) or are_cubes(p)


def are_flat(p):
    """Return whether the bodies are flat: under a cube one of four contacts is redundant, so the matrix is singular."""
    return not are_cubes(p)


def too_slow(p):
    """Ten boxes are too many for the sweeps."""
    slow = are_boxes(p) and p.n > 5
    return "after 50,000 sweeps it ends in Diverged, because boxes that rock settle slowly" if slow else ""


PHASE = "only the size of its rocking is known, because its phase depends on the exact places of the corners"
RUNNERS = (
    ours(DIRECT, limit=solved_limit, order=EXACT, supports=are_flat,
         predicted="it solves a linear system: only round-off is left, and the limit bounds it"),
    ours(SWEEPS, limit=swept_limit, order=EXACT, supports=are_flat, unfinished=too_slow,
         predicted="its sweeps stop at a residual, and the limit bounds what is left"),
    ours(PILE, limit=pile_limit, predicted=PHASE, order=EXACT, supports=are_boxes),
    ours(PILE_IN_SPACE, limit=partial(pile_limit, axes=2.0), predicted=PHASE, order=EXACT, supports=are_cubes),
    engine(PYMUNK, "", in_tower(PYMUNK, model, answer, **FINE, overlap=OVERLAP),
           "100 iterations, collision_slop 1e-4; 3 s of 1/240 s",
           order=EXACT, limit=partial(pymunk_limit, **FINE), predicted=PHASE, supports=are_boxes),
    engine(PYMUNK, "default", in_tower(PYMUNK, model, answer, **DEFAULT, overlap=OVERLAP),
           "10 iterations, collision_slop 0.1; 3 s of 1/240 s",
           order=EXACT, limit=partial(pymunk_limit, **DEFAULT), predicted=PHASE, supports=are_boxes),
    engine(PYBULLET, "", in_tower(PYBULLET, model, answer, **FROM_ZERO, iterations=200, warm=WARMER),
           f"maximal coordinates; solverResidualThreshold 0, 200 iterations, warmStartingFactor {WARMER}; "
           "3 s of 1/240 s",
           order=EXACT, limit=pybullet_limit, supports=are_boxes_or_cubes,
           predicted="only roundings of overlaps are left, and the limit bounds them"),
    engine(PYBULLET, "default", in_tower(PYBULLET, model, answer, **FROM_ZERO, iterations=50, residual=1e-7),
           f"maximal coordinates; 50 iterations, warmStartingFactor {WARM}; 3 s of 1/240 s",
           order=EXACT, limit=creeping_limit, supports=are_boxes_or_cubes,
           predicted="its tower creeps, and its solver's sweeps are not modelled"),
    engine(MUJOCO, "", in_tower(MUJOCO, model, answer), f"{SOFT}; 3 s of 1/240 s",
           order=EXACT, limit=mujoco_limit, supports=are_boxes_or_cubes,
           predicted="at rest only roundings are left, and the limit bounds them"),
)


def quantity_names(p):
    return [f"force under {k} [N]" for k in range(p.n, 0, -1)]


def sanity_checks():
    """Return Findings: the ground carries all boxes, and each joint one box more than the next."""
    all_of_them = [truth(p, T)[0] / (p.n * p.m * p.g) for p in CASES.values()]
    return (states("what the ground carries, over the weight [-]", all_of_them, 1.0, 1e-15),
            states("what a joint carries more than the next, over a body's weight [-]",
                   -np.diff(truth(Params(), T)) / 9.81, 1.0, 1e-14))


# ---------------------------------------------------------------------------------------------- picture

def points(observed, p):
    """Draw the corners of all bodies, seen from the side.

    An arrow right of each joint has the length of its force over one weight.
    """
    k = np.arange(p.n)[:, None]
    corners = p.size * np.array([(-0.5, 0.0), (0.5, 0.0), (0.5, 1.0), (-0.5, 1.0)])
    boxes = (corners[None] + np.stack((0.0 * k, p.size * k), axis=2)).reshape(-1, 2)
    joints = np.stack((np.full(p.n, p.size), p.size * k[:, 0]), axis=1)
    arrows = joints + np.stack((0.2 * p.size * np.asarray(observed) / (p.m * p.g), np.zeros(p.n)), axis=1)
    return np.round(np.concatenate((boxes, joints, arrows)), 5)


def links(p):
    return outlines(4, p.n) + [(4 * p.n + k, 5 * p.n + k) for k in range(p.n)]


SCENE = Scene(
    title="Stack of ten", lesson="contact",
    cases=CASES, **ANSWER,
    runners=RUNNERS,
    start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-15,
    slow_cases=("twenty discs", "ten cubes in space", "five cubes in space"),
    omitted_methods="no case with a motion has a column of discs, which would fall over",
    quantity_names=quantity_names,
    published_states=((1.0, tuple(9.81 * k for k in range(10, 0, -1)), 1e-13),),
    sanity_checks=sanity_checks,
    points=points, links=links,
    uses=("rows of all contacts", "masses and moments", "for the pile: contact points, soft contacts and memory"),
    full_loop="forces of bodies at rest: nothing moves, so there is no loop",
    ablations={"restitution": "nothing bounces at rest",
               "the third dimension": "cubes touch in four points instead of two, and the joints carry the same: a "
                                      "case of --full",
               "friction": "it carries nothing here; it keeps the boxes of the pile from sliding off"},
)
