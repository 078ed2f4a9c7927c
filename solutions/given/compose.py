"""Given with lesson 10.  Our loop, put together from what a Model contains, in the plane and in space.

compose(model) returns a Loop: the parts that the model needs, in the lecture's order, each with the reason why it is
there.  A loop has no part for what its model lacks: without shapes it does not search for contacts, without joints it
closes none, and bodies that cannot turn are only moved.  run_parts runs it.
*Left out:* seams.  A body that slides over two supports side by side bumps into the second: give it a single support.
Restitution is Newton's, with which an impact with friction can gain energy, as lesson 7 shows.
"""

from typing import NamedTuple

import numpy as np

from ..checks import BadInput, check_kind, check_not_negative, finite_number, positive_number, whole_number
from ..simulator import weight
from ..support.convex_2d import (
    box_bounds_of,
    box_contacts_of,
    convex_bounds_2d,
    convex_contacts_2d,
    disc_bounds_of,
    disc_contacts_of,
)
from ..support.convex_3d import (
    ball_bounds_of,
    ball_contacts_of,
    cuboid_bounds_of,
    cuboid_contacts_of,
    rounded_bounds,
    rounded_contacts,
)
from ..support.model import (
    Drag,
    State,
    can_turn,
    check_model,
    friction_of,
    load_now,
    touching_pairs,
)
from ..support.scenes import PileState
from ..support.shapes import Ball, Box, HalfSpace, Polyhedron
from .dividing import advance_parts, divided_step, first_touch, whole_step
from .hulls import hull_bounds, hull_contacts
from .parts import (
    accelerate,
    accelerate_half,
    accelerate_rest,
    close,
    contact_impulses,
    contact_impulses_of_centres,
    contact_impulses_of_pairs,
    contact_impulses_with_joints,
    contact_impulses_with_rods,
    detect_few,
    detect_many,
    detect_unjoined,
    hold,
    leave,
    model_load,
    move,
    move_and_turn,
    separate,
    separate_with_joints,
    separate_with_rods,
)
from .parts_3d import (
    accelerate_half_in_space,
    accelerate_in_space,
    accelerate_rest_in_space,
    close_in_space,
    contact_impulses_in_space,
    contact_impulses_of_centres_in_space,
    contact_impulses_with_joints_in_space,
    contact_impulses_with_rods_in_space,
    hold_in_space,
    model_load_in_space,
    move_and_turn_in_space,
    separate_in_space,
    separate_with_joints_in_space,
    separate_with_rods_in_space,
)
from .rods import close_with_rods, hold_with_rods
from .rows import Composed, Settings, in_order, points_of, rods_in, rows_in_order, rows_of

ROUND_OFF = 1e-9             # of the limits of a step [-]
FEW = 8                      # shapes up to which all pairs are tested, without a broad phase [-]


class Part(NamedTuple):
    """A part of a loop."""
    step: object             # (load, bounds, narrow, t, state, dt, p) → state
    why: str                 # what of the model needs it, for people


class Loop(NamedTuple):
    """A loop for one model."""
    parts: tuple             # of Part, in their order
    step: Part               # how they make a step: whole_step or divided_step
    touch: object            # (bounds, narrow, before, after, dt, p) → share of a step at which fast bodies touch
    load: object             # (t, x, q, v, omega, p) → (F, tau)
    bounds: object           # (x, q, half) → (low, high, turn)
    narrow: object           # (x, turn, half, planes, pairs, reach) → ContactSet
    state: PileState         # at the start
    p: Composed
    row: np.ndarray          # (bodies,) the row of each body of the model
    joint_of: tuple          # the number of the model's joint that each row of p.joints, then of p.rods, belongs to


class Kit(NamedTuple):
    """The parts that loops in the plane, or those in space, are made of."""
    accelerate: object
    accelerate_half: object
    accelerate_rest: object
    close: object
    hold: object
    separate: object
    separate_joined: object
    centres: object          # contacts: where nothing rubs and nothing turns
    one_friction: object     # where all pairs have the same friction
    contacts: object
    with_joints: object
    turn: object
    load: object


def kit_of(model):
    """Return the Kit for the dimension of a model, with parts for rods only where it has rods.

    It is made in each call: in a student's copy these names stand for the student's functions.
    """
    if model.d == 2:
        kit = Kit(accelerate, accelerate_half, accelerate_rest, close, hold, separate, separate_with_joints,
                  contact_impulses_of_centres, contact_impulses, contact_impulses_of_pairs,
                  contact_impulses_with_joints, move_and_turn, model_load)
        rods = {"separate_joined": separate_with_rods, "with_joints": contact_impulses_with_rods}
    else:
        kit = Kit(accelerate_in_space, accelerate_half_in_space, accelerate_rest_in_space, close_in_space,
                  hold_in_space, separate_in_space, separate_with_joints_in_space,
                  contact_impulses_of_centres_in_space, contact_impulses_in_space, contact_impulses_in_space,
                  contact_impulses_with_joints_in_space, move_and_turn_in_space, model_load_in_space)
        rods = {"separate_joined": separate_with_rods_in_space, "with_joints": contact_impulses_with_rods_in_space}
    return kit._replace(close=close_with_rods, hold=hold_with_rods, **rods) if rods_in(model) else kit


# ---------------------------------------------------------------------------------------------- composition

SETTINGS = Settings()


def compose(model, settings=SETTINGS):
    """Return the Loop of a Model.  Raises BadInput for anything but a Model, and for settings that cannot be."""
    check_model(model)
    settings = checked_settings(settings)
    p, state, row = rows_of(model, settings)
    bounds, narrow = shapes_of_loop(model)
    joint_of = tuple(k for k, joint in enumerate(model.joints) for _ in points_of(model, joint))
    joint_of += tuple(rods_in(model))
    return Loop(parts_of(model, kit_of(model)), step_of(model), first_touch, load_of(model), bounds, narrow, state, p,
                row, joint_of)


def checked_settings(settings):
    """Return Settings as numbers of their kinds.  Raises BadInput; rows_of checks the margin."""
    check_kind("the settings", settings, Settings, "give Settings(…), or leave them out")
    settled = finite_number("the share at which sweeps have settled [-]", settings.settled)
    check_not_negative("the share at which sweeps have settled [-]", settled)
    return settings._replace(sweeps=whole_number("number of sweeps", settings.sweeps, 1), settled=settled)


def parts_of(model, kit):
    """Return the parts that a model needs, in the lecture's order."""
    touching, reason = touching_pairs(model), reason_of_forces(model)
    motion = Part(kit.turn, "what moves and turns") if turns(model) else Part(move, "what moves; nothing can turn")
    if touching:
        apart = kit.separate_joined if model.joints else kit.separate
        return (*[Part(kit.accelerate, reason)] * bool(reason), detection(model, touching),
                Part(apart, "shapes, which may overlap"), solver(model, touching, kit), motion)
    if any(model.joints[k].compliance > 0.0 for k in rods_in(model)):
        return (*[Part(kit.accelerate, reason)] * bool(reason), Part(kit.close, "joints, of which some give way"),
                motion, Part(kit.hold, "joints that do not give way"))
    if model.joints:
        return (*[Part(kit.accelerate_half, reason)] * bool(reason), Part(kit.close, "joints"), motion,
                *[Part(kit.accelerate_rest, reason)] * bool(reason), Part(kit.hold, "joints"))
    return (*[Part(kit.accelerate, reason)] * bool(reason), motion)


def step_of(model):
    """Return how the parts make a step."""
    if touching_pairs(model):
        return Part(divided_step, "shapes, which may be so fast that they would pass through each other")
    return Part(whole_step, "nothing can touch")


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
            more, twist = load_now(load, t, state)
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
    if Polyhedron in kinds:
        return hull_bounds, hull_contacts
    return (convex_bounds_2d, convex_contacts_2d) if flat else (rounded_bounds, rounded_contacts)


# ---------------------------------------------------------------------------------------------- runs

def state_of(loop, state):
    """Return the State of all bodies of the model, in its order."""
    return in_order(loop.row, state)


def padded(loop):
    """Return six steps: those of the parts of a Loop, at most five, and `leave` in the other places."""
    return [part.step for part in loop.parts] + [leave] * (6 - len(loop.parts))


def check_explicit_forces(loop, dt):
    """Raise BadInput where a spring or the drag makes a motion grow in each step.

    Two bodies on a spring, or one in drag, with the inverse mass w = 1/m_a + 1/m_b, ω² = k w and γ = c w.  A step with
    one kick has the determinant 1 − γ dt and the trace 2 − ω² dt² − γ dt, a step with two half kicks A² and
    1 + A² − ½ ω² dt² (1 + A) with A = 1 − ½ γ dt.  Motions do not grow where |determinant| ≤ 1 and
    |trace| ≤ 1 + determinant (Jury's test).
    *Left out:* turns and further springs, which make a motion grow sooner; bodies with joints, which may hold it.
    """
    p, dt = loop.p, positive_number("step dt [s]", dt)
    if p.laws.size == 0 and p.drag == 0.0:
        return
    inv_mass = p.inv_mass.copy()
    inv_mass[np.concatenate((p.joints.a, p.joints.b, p.rods.a, p.rods.b))] = 0.0
    w = inv_mass[p.ends[:, 0]] + inv_mass[p.ends[:, 1]]
    squared, damping = w * p.laws[:, 1] * dt * dt, w * p.laws[:, 2] * dt
    halved = any(part.step in (accelerate_half, accelerate_half_in_space) for part in loop.parts)
    grow, most = np.flatnonzero(grows(squared, damping, halved)), float(p.drag * np.max(inv_mass) * dt)
    if grow.size:
        raise BadInput("step dt [s]", dt, f"take a smaller one: with this one, spring {grow[0]} makes the motion grow "
                       "without end; or take a Distance with a compliance, which damps it")
    if grows(0.0, most, halved):
        raise BadInput("step dt [s]", dt, "take a smaller one: with this one, the drag makes motions grow without end")


def grows(squared, damping, halved):
    """Return whether a step makes a motion grow, of (ω dt)² and γ dt; halved: it has two half kicks."""
    A = 1.0 - 0.5 * damping
    determinant = A * A if halved else 1.0 - damping
    trace = 1.0 + A * A - 0.5 * squared * (1.0 + A) if halved else 2.0 - squared - damping
    return (np.abs(determinant) > 1.0 + ROUND_OFF) | (np.abs(trace) > 1.0 + determinant + ROUND_OFF)


def run_parts(loop, t, state, dt, steps):
    """Return the PileState after so many steps of a Loop.

    Raises BadInput for anything but a Loop and a state of it, for a step that is not positive, and for one with which
    springs or a drag throw bodies ever farther.  Raises Diverged where the end is not finite or a step is far too long.
    """
    check_kind("the loop", loop, Loop, "give what compose returns for a Model")
    steps = whole_number("number of steps", steps, 0)
    own = "begin with loop.state, or go on from what run_parts has returned"
    check_kind("the state", state, PileState, own)
    if len(state.x) != len(loop.state.x):
        raise BadInput("the state", f"of another loop, with {len(state.x)} rows and not {len(loop.state.x)}", own)
    check_explicit_forces(loop, dt)
    functions = loop.step.step, *padded(loop), loop.touch, loop.load, loop.bounds, loop.narrow
    return advance_parts(*functions, t, state, dt, steps, loop.p)
