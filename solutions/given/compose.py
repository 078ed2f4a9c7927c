"""Given with lesson 10.  Our loop, put together from what a Model contains, in the plane and in space.

compose(model) returns a Loop: the parts that the model needs, in the lecture's order, each with the reason why it is
there.  A loop has no part for what its model lacks: without shapes it does not search for contacts, without joints it
closes none, and bodies that cannot turn are only moved.  run_parts runs it.
"""

from typing import NamedTuple

import numpy as np

from ..checks import BadInput, check_not_negative, positive_number, whole_number
from ..simulator import weight
from ..support.broad_phase import Pairs
from ..support.convex_2d import (
    Cores,
    box_bounds_of,
    box_contacts_of,
    convex_bounds_2d,
    convex_contacts_2d,
    disc_bounds_of,
    disc_contacts_of,
)
from ..support.convex_3d import (
    RoundedBoxes,
    ball_bounds_of,
    ball_contacts_of,
    cuboid_bounds_of,
    cuboid_contacts_of,
    rounded_bounds,
    rounded_contacts,
)
from ..support.model import (
    WORLD,
    Body,
    Distance,
    Drag,
    Hinge,
    State,
    Weld,
    can_turn,
    friction_of,
    make_model,
    own_place,
    start_of,
    touching_pairs,
)
from ..support.scenes import PileState, no_contacts
from ..support.shapes import Ball, Box, Capsule, HalfSpace, core_of, size_of
from .joints import Joints, farthest_neighbour, form_loops
from .parts import (
    accelerate,
    accelerate_half,
    accelerate_rest,
    advance_parts,
    close,
    contact_impulses,
    contact_impulses_of_centres,
    contact_impulses_of_pairs,
    contact_impulses_with_joints,
    detect_few,
    detect_many,
    detect_unjoined,
    hold,
    leave,
    model_load,
    move,
    move_and_turn,
    separate,
)
from .parts_3d import (
    accelerate_half_in_space,
    accelerate_in_space,
    accelerate_rest_in_space,
    close_in_space,
    contact_impulses_in_space,
    contact_impulses_of_centres_in_space,
    contact_impulses_with_joints_in_space,
    hold_in_space,
    model_load_in_space,
    move_and_turn_in_space,
    separate_in_space,
)

FEW = 8                      # shapes up to which all pairs are tested, without a broad phase [-]
SLOP = 5e-3                  # overlap that stays, over the smallest size of a shape [-]


class Settings(NamedTuple):
    """How a model is solved; nothing here changes the motion that ever shorter steps approach."""
    sweeps: int = 100        # over all contacts in a step, at most
    settled: float = 1e-3    # sweeps end when one changes no impulse by more than this share of the largest [-]
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
    margin: float
    slop: float              # overlap that stays [m]
    joints: Joints
    ends: np.ndarray         # (s, 2) bodies of springs
    arms: np.ndarray         # (s, 2 d) their points, in coordinates of the bodies [m]
    laws: np.ndarray         # (s, 3) rest [m], k [N/m], c [N s/m]
    drag: float              # [N s/m]


class Part(NamedTuple):
    """A part of a loop."""
    step: object             # (load, bounds, narrow, t, state, dt, p) → state
    why: str                 # what of the model needs it, for people


class Loop(NamedTuple):
    """A loop for one model."""
    parts: tuple             # of Part, in their order
    load: object             # (t, x, q, v, omega, p) → (F, tau)
    bounds: object           # (x, q, half) → (low, high, turn)
    narrow: object           # (x, turn, half, planes, pairs, reach) → ContactSet
    state: PileState         # at the start
    p: Composed
    row: np.ndarray          # (bodies,) the row of each body of the model
    joint_of: tuple          # the number of the model's joint that each row of p.joints belongs to


class Kit(NamedTuple):
    """The parts that loops in the plane, or those in space, are made of."""
    accelerate: object
    accelerate_half: object
    accelerate_rest: object
    close: object
    hold: object
    separate: object
    centres: object          # contacts: where nothing rubs and nothing turns
    one_friction: object     # where all pairs have the same friction
    contacts: object
    with_joints: object
    turn: object
    load: object


def kit_of(model):
    """Return the Kit for the dimension of a model."""
    if model.d == 2:
        return Kit(accelerate, accelerate_half, accelerate_rest, close, hold, separate, contact_impulses_of_centres,
                   contact_impulses, contact_impulses_of_pairs, contact_impulses_with_joints, move_and_turn, model_load)
    return Kit(accelerate_in_space, accelerate_half_in_space, accelerate_rest_in_space, close_in_space, hold_in_space,
               separate_in_space, contact_impulses_of_centres_in_space, contact_impulses_in_space,
               contact_impulses_in_space, contact_impulses_with_joints_in_space, move_and_turn_in_space,
               model_load_in_space)


# ---------------------------------------------------------------------------------------------- composition

def refuses(model):
    """Return why our loop cannot run a model, for people; an empty text where it can."""
    if any(isinstance(joint, Distance) for joint in model.joints):
        return "a Distance between two points"
    return ""


SETTINGS = Settings()


def compose(model, settings=SETTINGS):
    """Return the Loop of a Model.  Raises BadInput where refuses(model) has a reason."""
    if why := refuses(model):
        raise BadInput("a model for our loop", why, "take another world")
    whole_number("number of sweeps", settings.sweeps, 1)
    check_not_negative("the share at which sweeps have settled [-]", settings.settled)
    p, state, row = rows_of(model, settings)
    bounds, narrow = shapes_of_loop(model)
    joint_of = tuple(k for k, joint in enumerate(model.joints) for _ in points_of(model, joint))
    return Loop(parts_of(model, kit_of(model)), load_of(model), bounds, narrow, state, p, row, joint_of)


def parts_of(model, kit):
    """Return the parts that a model needs, in the lecture's order."""
    touching, reason = touching_pairs(model), reason_of_forces(model)
    motion = Part(kit.turn, "what moves and turns") if turns(model) else Part(move, "what moves; nothing can turn")
    if touching:
        return (*[Part(kit.accelerate, reason)] * bool(reason), detection(model, touching),
                Part(kit.separate, "shapes, which may overlap"), solver(model, touching, kit), motion)
    if model.joints:
        return (*[Part(kit.accelerate_half, reason)] * bool(reason), Part(kit.close, "joints"), motion,
                *[Part(kit.accelerate_rest, reason)] * bool(reason), Part(kit.hold, "joints"))
    return (*[Part(kit.accelerate, reason)] * bool(reason), motion)


def reason_of_forces(model):
    """Return which forces a model has, for people; an empty text without any."""
    found = {"gravity": np.any(model.gravity), "springs": model.springs, "loads": model.loads}
    return " and ".join(name for name, there in found.items() if there)


def load_of(model):
    """Return the load of a model: exercise `weight` where gravity is all, and functions of its own at last."""
    own, known = [load for load in model.loads if not isinstance(load, Drag)], kit_of(model).load
    if not own:
        return known if model.springs or model.loads else weight
    row = rows_in_order(model)

    def with_own_loads(t, x, q, v, omega, p):
        F, tau = known(t, x, q, v, omega, p)
        state = State(x[row], q[row], v[row], omega[row])
        for load in own:
            more, twist = load(t, *state)
            F[row], tau[row] = F[row] + more, tau[row] + twist
        return F, tau
    return with_own_loads


def turns(model):
    """Return whether anything turns: a spin at the start, or a finite moment and something that could turn it."""
    if any(np.any(body.omega) for body in model.bodies):
        return True
    free = {k for k, body in enumerate(model.bodies) if can_turn(body)}
    off_centre = any(np.any(place) for s in model.springs for k, place in ((s.a, s.place_a), (s.b, s.place_b))
                     if k in free)
    own = any(not isinstance(load, Drag) for load in model.loads)
    pushed = any(k in free and (not isinstance(model.bodies[k].shape, Ball) or friction_of(model, i, j) > 0.0)
                 for i, j in touching_pairs(model) for k in (i, j))
    return bool(free) and (off_centre or own or bool(model.joints) or pushed)


def detection(model, touching):
    """Return the part that finds contacts."""
    shaped = sum(body.shape is not None and not isinstance(body.shape, HalfSpace) for body in model.bodies)
    if shaped <= FEW:
        return Part(detect_few, f"{len(touching)} pairs of shapes, so few that all are tested")
    if model.joints:
        return Part(detect_unjoined, "many shapes, some of them joined")
    return Part(detect_many, "many shapes")


def solver(model, touching, kit):
    """Return the part that solves the contacts."""
    rubs = {friction_of(model, i, j) for i, j in touching}
    if model.joints:
        return Part(kit.with_joints, "contacts and joints")
    if rubs == {0.0} and not turns(model):
        return Part(kit.centres, "contacts; nothing rubs and nothing turns")
    if len(rubs) == 1:
        return Part(kit.one_friction, "contacts with one friction")
    return Part(kit.contacts, "contacts with several frictions")


def shapes_of_loop(model):
    """Return (bounds, narrow): those of lesson 9 where all shapes are round or all are boxes."""
    kinds, flat = {type(body.shape) for body in model.bodies if body.shape is not None} - {HalfSpace}, model.d == 2
    if kinds == {Ball}:
        return (disc_bounds_of, disc_contacts_of) if flat else (ball_bounds_of, ball_contacts_of)
    if kinds == {Box}:
        return (box_bounds_of, box_contacts_of) if flat else (cuboid_bounds_of, cuboid_contacts_of)
    return (convex_bounds_2d, convex_contacts_2d) if flat else (rounded_bounds, rounded_contacts)


# ---------------------------------------------------------------------------------------------- rows

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


def rows_of(model, settings):
    """Return (Composed, PileState, row (bodies,) of each body of the model)."""
    order, n, h = ordered_bodies(model)
    row, bodies, d = rows_in_order(model), [model.bodies[k] for k in order], model.d
    sizes = [size_of(body.shape) for body in bodies[:n]]
    margin = 0.1 * min(sizes, default=1.0) if settings.margin is None else settings.margin
    rubs = {friction_of(model, i, j) for i, j in touching_pairs(model)}
    inv_mass = np.array([1.0 / body.m for body in bodies] + [0.0])
    p = Composed(
        inv_mass, np.array([np.divide(1.0, body.inertia) for body in bodies] + [np.zeros(d if d == 3 else ())]),
        cores_of(bodies[:n]) if d == 2 else rounded_boxes_of(bodies[:n]), planes_of(bodies[n:n + h], d),
        np.array(model.gravity), rubs.pop() if len(rubs) == 1 else 0.0,
        np.array([body.mu for body in bodies] + [0.0]), np.array([body.e for body in bodies] + [0.0]),
        pairs_of(model, row, n), settings.sweeps, float(settings.settled), positive_number("margin [m]", margin),
        SLOP * min(sizes, default=1.0), joints_of(model, row, inv_mass), *springs_of(model, row, len(bodies)),
        float(sum(load.k for load in model.loads if isinstance(load, Drag))))
    return p, PileState(*states_of_rows(model, order), no_contacts(n, d), np.zeros((0, d))), row


def states_of_rows(model, order):
    """Return (x, q, v, omega) of all rows at the start; the last row is the world."""
    world = make_model([Body((0.0,) * model.d)], model.gravity)
    return [np.concatenate((rows[order], last)) for rows, last in zip(start_of(model), start_of(world))]


def cores_of(bodies):
    """Return the Cores of bodies with shapes in the plane."""
    cores = [core_of(body.shape) for body in bodies]
    half = [body.shape.half if isinstance(body.shape, Box) else (size_of(body.shape),) * 2 for body in bodies]
    return Cores(np.concatenate([np.zeros((0, 2)), *[corners for corners, _ in cores]]),
                 np.cumsum([0] + [len(corners) for corners, _ in cores]), np.array([r for _, r in cores], float),
                 np.array(half, float).reshape(-1, 2))


def rounded_boxes_of(bodies):
    """Return the RoundedBoxes of bodies with shapes in space."""
    core, radius, half = [], [], []
    for body in bodies:
        shape = body.shape
        round_one = isinstance(shape, Ball | Capsule)
        core.append((shape.half_length if isinstance(shape, Capsule) else 0.0, 0.0, 0.0) if round_one else shape.half)
        radius.append(shape.radius if round_one else 0.0)
        half.append((size_of(shape),) * 3 if round_one else shape.half)
    return RoundedBoxes(np.array(core, float).reshape(-1, 3), np.array(radius, float),
                        np.array(half, float).reshape(-1, 3))


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


def points_of(model, joint):
    """Return the places (d,) that a joint holds together.

    A ball joint, and a hinge in the plane, hold one.  A hinge in space holds two on its axis.  A weld holds as many as
    fix a body: two in the plane, three in space.
    """
    place, d = np.array(joint.place), model.d
    sizes = [size_of(model.bodies[k].shape) for k in (joint.a, joint.b)
             if k != WORLD and model.bodies[k].shape is not None]
    arm = min([*sizes, 1.0])
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


def springs_of(model, row, world):
    """Return (ends (s, 2), arms (s, 2 d), laws (s, 3)) of the springs."""
    ends = [(row[s.a], world if s.b == WORLD else row[s.b]) for s in model.springs]
    arms, laws = [(*s.place_a, *s.place_b) for s in model.springs], [(s.rest, s.k, s.c) for s in model.springs]
    return (np.array(ends, np.int64).reshape(-1, 2), np.array(arms, float).reshape(-1, 2 * model.d),
            np.array(laws, float).reshape(-1, 3))


def state_of(loop, state):
    """Return the State of all bodies of the model, in its order."""
    return State(*(rows[loop.row] for rows in state[:4]))


def run_parts(loop, t, state, dt, steps):
    """Return the PileState after so many steps of a Loop."""
    steps = whole_number("number of steps", steps, 0)
    padded = [part.step for part in loop.parts] + [leave] * (6 - len(loop.parts))
    return advance_parts(*padded, loop.load, loop.bounds, loop.narrow, t, state, dt, steps, loop.p)
