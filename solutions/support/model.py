"""Given.  A scene as data: bodies, joints, springs, gravity and loads, in the plane or in space.

A Model says what is there and nothing of how it is solved: it has no step, no sweeps, no margin and no engine.  The
worlds of `validate/worlds/` are built from it: our own loop, pymunk, pybullet, MuJoCo, Box2D and Rapier.

d = 2: vectors are (x, y), an orientation is an angle [rad], and an angular velocity is a number.
d = 3: vectors are (x, y, z), an orientation is a unit quaternion (w, x, y, z), an angular velocity is a vector (world).

Two bodies touch with friction μ = μ_a μ_b and restitution e = e_a e_b.  Give floors and other supports 1; then the
numbers of the other body are those of the pair.  pymunk and pybullet have the same law.
*Left out:* ropes that only pull, motors, limits of joints, and soft contacts.
"""

from typing import NamedTuple

import numpy as np

from ..checks import (
    BadInput,
    WrongShape,
    check_friction,
    check_kind,
    check_restitution,
    finite_array,
    finite_number,
    number,
)
from .model_checks import (
    check_force,
    check_joint,
    check_moments,
    check_own_force,
    check_own_load,
    check_shape_of,
    check_sliding,
    check_spring,
    listed,
    one_of,
    orientation,
    vector,
)
from .networks import pull_per_length
from .quaternions import rotate
from .shapes import Ball, Box, Capsule, HalfSpace, Polygon, Polyhedron, moments_of_shape, outline_of

WORLD = -1                   # in a joint or a spring: the world, which does not move


class Body(NamedTuple):
    """A rigid body.  A field that is None gets its value from make_model."""
    x: tuple                 # (d,) centre of mass [m]
    m: float = np.inf        # [kg]; ∞: no impulse moves it, and it keeps the velocity that it has
    shape: object = None     # Ball, Box, Capsule, Polygon, Polyhedron, HalfSpace; None: it touches nothing
    mu: float = 0.0          # friction [-]
    e: float = 0.0           # restitution [-]
    q: object = None         # orientation; None: it is not turned
    v: tuple | None = None   # [m/s]; None: at rest
    omega: object = None     # [rad/s]; None: at rest
    inertia: object = None   # moment about the centre, or (3,) about the axes of the body [kg m²]; ∞: it does not turn;
                             # None: that of its shape, filled evenly; ∞ without a shape


class Hinge(NamedTuple):
    """A point of a stays at a point of b, and in space a line through it stays at a line.  They do not collide."""
    a: int                   # number of a body
    b: int                   # number of a body, or WORLD
    place: tuple             # (d,) at the start [m]
    axis: tuple | None = None  # (3,) in space, at the start; None in the plane


class BallJoint(NamedTuple):
    """In space: a point of a stays at a point of b.  They do not collide."""
    a: int
    b: int                   # or WORLD
    place: tuple             # (3,) at the start [m]


class Weld(NamedTuple):
    """Bodies a and b move as one.  They do not collide."""
    a: int
    b: int                   # or WORLD
    place: tuple             # (d,) at the start [m]: where the weld is


class Distance(NamedTuple):
    """Two points stay as far apart as they are at the start: a rod without mass.  The bodies may collide.

    Our loop takes the force of a compliant one at the end of the step.  That damps a vibration with ω by
    e^(−½ ω² dt t), as implicit Euler does.
    """
    a: int
    b: int                   # or WORLD
    place_a: tuple           # (d,) from the centre of a, in coordinates of a [m]
    place_b: tuple           # the same of b; a place of the world where b is WORLD [m]
    compliance: float = 0.0  # [m/N]; 0: rigid


class Spring(NamedTuple):
    """A spring with a damper along the line between two points."""
    a: int
    b: int                   # or WORLD
    place_a: tuple           # (d,) from the centre of a, in coordinates of a [m]
    place_b: tuple           # the same of b; a place of the world where b is WORLD [m]
    rest: float              # its length without a force [m]
    k: float                 # [N/m]
    c: float = 0.0           # [N s/m]


class Drag(NamedTuple):
    """Air: the force −k v on the centre of each body that can move."""
    k: float                 # [N s/m]


class Force(NamedTuple):
    """A force on the centre of a body, computed from sequences of floats: an engine calls it in each step.

    It is a load like any other function, but engines need not read the state of all bodies for it.
    """
    a: int                   # number of a body
    F: object                # a function → (d,) [N], of what `of` names, in this order
    of: str                  # "t": the time [s]; "x": the place of the body [m]; "v": its velocity [m/s]; "xv": both;
                             # "r": the vector from there to body b [m]
    b: int | None = None     # number of a body, for "r"

    def __call__(self, t, x, q, v, omega):
        """Return (F (n, d) [N], tau [N m]) of all bodies."""
        F, now = np.zeros(x.shape), self.now(t, x, v)
        if np.shape(now) != x[self.a].shape:
            raise WrongShape(f"the force on body {self.a} at t = {t:.6g} s", np.shape(now), x[self.a].shape)
        F[self.a] = now
        return F, np.zeros(omega.shape)

    def now(self, t, x, v):
        """Return F (d,) [N]."""
        now = {"r": x[self.b] - x[self.a]} if self.of == "r" else {"t": t, "x": x[self.a], "v": v[self.a]}
        return self.F(*(now[name] for name in self.of))


class Model(NamedTuple):
    """A scene.  Make it with make_model, which checks it."""
    bodies: tuple
    gravity: tuple           # (d,) [m/s²]
    joints: tuple = ()       # Hinge, BallJoint, Weld, Distance
    springs: tuple = ()
    loads: tuple = ()        # Drag, Force, or functions (t, x, q, v, omega) → (F (n, d) [N], tau [N m]) of all bodies

    @property
    def d(self):
        return len(self.gravity)


class State(NamedTuple):
    """Where n bodies are and how they move."""
    x: np.ndarray            # (n, d) [m]
    q: np.ndarray            # (n,) [rad], or (n, 4) unit quaternions
    v: np.ndarray            # (n, d) [m/s]
    omega: np.ndarray        # (n,) or (n, 3) [rad/s]


SHAPES = (Ball, Box, Capsule, Polygon, Polyhedron, HalfSpace)
JOINTS = (Hinge, BallJoint, Weld, Distance)


# ---------------------------------------------------------------------------------------------- making one

def make_model(bodies, gravity, joints=(), springs=(), loads=()):
    """Return the Model of these records, with all numbers as floats and without None in a body that has a value there.

    Raises BadInput, with the number of the record, for what cannot be: a mass that is not above zero, moments that no
    body has, a number of a body that is none, a joint of two bodies that cannot move, a shape of the other dimension, a
    link without a length, a half-space that would leave its place, a load that returns no force at the start.
    """
    gravity = finite_array("gravity [m/s²]", gravity)
    if gravity.shape not in ((2,), (3,)):
        raise WrongShape("gravity [m/s²]", gravity.shape, "2 numbers in the plane or 3 in space")
    gravity, d = tuple(map(float, gravity)), gravity.size
    bodies = tuple(checked_body(k, one_of("a body", body, (Body,)), d)
                   for k, body in enumerate(listed("bodies", bodies)))
    if not bodies:
        raise BadInput("the number of bodies of a model", 0, "give at least one")
    free = [np.isfinite(body.m) for body in bodies]
    joints = tuple(check_joint(k, one_of("a joint", joint, JOINTS), free, d)
                   for k, joint in enumerate(listed("joints", joints)))
    springs = tuple(check_spring(k, one_of("a spring", spring, (Spring,)), free, d)
                    for k, spring in enumerate(listed("springs", springs)))
    model = Model(bodies, gravity, joints, springs, tuple(checked_load(load, free) for load in listed("loads", loads)))
    check_links(model, start_of(model))
    check_own_loads(model, start_of(model))
    return model


def check_model(model):
    """Raise BadInput unless this is a Model."""
    check_kind("the model", model, Model, "give what make_model returns")


def checked_body(k, body, d):
    """Return body number k, checked, with floats and without None where it has a value.  Raises BadInput."""
    def name(thing):
        return f"{thing} of body {k}"

    mass, shape, fixed = number(name("the mass m [kg]"), body.m), body.shape, False
    if not (mass > 0.0 and np.isfinite(1.0 / mass)):
        raise BadInput(name("the mass m [kg]"), mass, "give a number above zero; ∞ for what nothing moves")
    fixed = not np.isfinite(mass)
    if shape is not None:
        shape = check_shape_of(name("the shape"), one_of(name("the shape"), shape, SHAPES), d, fixed)
    check_friction(number(name("friction μ [-]"), body.mu))
    check_restitution(number(name("restitution e [-]"), body.e))
    still = 0.0 if d == 2 else (0.0, 0.0, 0.0)
    q = orientation(name("the orientation q"), body.q, d)
    v = vector(name("the velocity v [m/s]"), (0.0,) * d if body.v is None else body.v, d)
    omega = still if body.omega is None else body.omega
    omega = (finite_number(name("the angular velocity ω [rad/s]"), omega) if d == 2 else
             vector(name("the angular velocity ω [rad/s]"), omega, 3))
    if isinstance(shape, HalfSpace):
        check_sliding(name("the surface"), shape, v, omega)
    inertia = body.inertia
    if inertia is None and (fixed or shape is None):
        inertia = np.inf if d == 2 else (np.inf,) * 3
    elif inertia is None:
        inertia = filled(name("the shape"), shape, mass, d)
    inertia = check_moments(name("the moment of inertia [kg m²]"), inertia, d)
    if fixed and np.any(np.isfinite(inertia)):
        raise BadInput(name("the moment of inertia [kg m²]"), inertia, "leave it out where m is ∞: nothing turns it")
    return Body(vector(name("the centre x [m]"), body.x, d), mass, shape, float(body.mu), float(body.e), q, v, omega,
                inertia)


def filled(thing, shape, m, d):
    """Return the moments of a shape that is filled evenly.  Raises BadInput where they are no floats."""
    try:
        moments = moments_of_shape(shape, m, d)
    except OverflowError:
        moments = np.inf
    except ZeroDivisionError:                                # of a volume that is none
        moments = 0.0
    if not np.all(np.isfinite(moments)):
        raise BadInput(f"the moment of inertia of {thing} [kg m²]", np.inf, "give a smaller shape or a smaller mass")
    if not np.all(moments):
        raise BadInput(f"the moment of inertia of {thing} [kg m²]", 0.0, "give a larger shape or a larger mass")
    return moments


def check_links(model, start):
    """Raise BadInput for a Distance whose ends are at one place, and for a Spring without a direction there."""
    links = [(f"joint {k} (a Distance)", joint, "a Hinge") for k, joint in enumerate(model.joints)
             if isinstance(joint, Distance)]
    links += [(f"spring {k}", spring, "the rest length 0") for k, spring in enumerate(model.springs)
              if spring.rest * spring.k > 0.0]
    for thing, link, other in links:
        way = world_place(start, link.a, link.place_a) - world_place(start, link.b, link.place_b)
        if not way @ way > 0.0:
            raise BadInput(f"the length of {thing} [m]", 0.0, f"keep its ends apart at the start, or give {other}")


def check_own_loads(model, start):
    """Raise BadInput for a load that is a function unless it returns what a load does, at the start."""
    for k, load in enumerate(model.loads):
        if isinstance(load, Force):
            check_own_force(f"the force of load {k}", load, start, model.d)
        elif not isinstance(load, Drag):
            check_own_load(f"load {k}", load, start)


def checked_load(load, free):
    """Return a load.  Raises BadInput unless it is a Drag of zero or more, a Force on a free body, or a function."""
    if isinstance(load, Force):
        check_force(load, free)
    if isinstance(load, Drag):
        k = number("the drag k [N s/m]", load.k)
        if not (k >= 0.0 and np.isfinite(k)):
            raise BadInput("the drag k [N s/m]", k, "give a finite number of zero or above")
        return Drag(k)
    if not callable(load):
        raise BadInput("a load", type(load).__name__, "give a Drag, a Force, or a function of (t, x, q, v, omega)")
    return load


# ---------------------------------------------------------------------------------------------- its start

def start_of(model):
    """Return the State at the start."""
    rows = [np.array([getattr(body, name) for body in model.bodies], float) for name in State._fields]
    return State(*rows)


def can_move(body):
    """Return whether impulses move a body."""
    return bool(np.isfinite(body.m))


def can_turn(body):
    """Return whether impulses turn a body."""
    return can_move(body) and bool(np.all(np.isfinite(body.inertia)))


def rotation_of(q):
    """Return R (d, d) of an angle or of a unit quaternion: columns are the axes of the body in the world."""
    if np.ndim(q) == 0:
        return np.array([(np.cos(q), -np.sin(q)), (np.sin(q), np.cos(q))])
    return np.stack([rotate(np.asarray(q), axis) for axis in np.eye(3)], axis=1)


def own_place(model, k, place):
    """Return a place of the world, at the start, in coordinates of body k; of the WORLD: the place itself."""
    place = np.asarray(place, float)
    if k == WORLD:
        return place
    return rotation_of(model.bodies[k].q).T @ (place - model.bodies[k].x)


def world_place(state, k, place):
    """Return a place of body k, in its coordinates, in the world; of the WORLD: the place itself."""
    return np.asarray(place, float) if k == WORLD else state.x[k] + rotation_of(state.q[k]) @ place


# ---------------------------------------------------------------------------------------------- forces

def loads_at(model, t, state):
    """Return (F (n, d) [N], tau [N m]) of springs and loads on all bodies, without gravity."""
    F, tau = np.zeros_like(state.x), np.zeros_like(state.omega)
    for spring in model.springs:
        add_spring(F, tau, spring, state)
    for load in model.loads:
        if isinstance(load, Drag):
            F -= load.k * state.v * np.array([can_move(body) for body in model.bodies])[:, None]
        else:
            more, twist = load_now(load, t, State(*[rows.copy() for rows in state]))     # it may change what it gets
            F, tau = F + more, tau + twist
    return F, tau


def load_now(load, t, state):
    """Return (F (n, d) [N], tau [N m]) of a load that is a function.

    Raises BadInput unless the load returns a pair, and WrongShape for arrays of another shape: NumPy would spread them
    over all bodies, or fail.
    """
    answer = load(t, *state)
    try:
        F, tau = answer
    except (TypeError, ValueError):
        raise BadInput(f"what a load returns at t = {t:.6g} s", f"a {type(answer).__name__}",
                       "return the pair F, tau") from None
    for name, values, like in (("F [N]", F, state.x), ("tau [N m]", tau, state.omega)):
        if np.shape(values) != like.shape:
            raise WrongShape(f"{name} of a load at t = {t:.6g} s", np.shape(values), like.shape)
    return F, tau


def add_spring(F, tau, spring, state):
    """Add what a spring pulls at its two bodies, in place."""
    at, u = [], []
    for k, place in ((spring.a, spring.place_a), (spring.b, spring.place_b)):
        at.append(world_place(state, k, place))
        u.append(0.0 if k == WORLD else state.v[k] + turned_by(state.omega[k], at[-1] - state.x[k]))
    way = at[0] - at[1]
    pull = pull_per_length(way @ way, way @ (u[0] - u[1]), (spring.rest, spring.k, spring.c)) * way
    for k, point, force in ((spring.a, at[0], pull), (spring.b, at[1], -pull)):
        if k != WORLD:
            F[k] += force
            tau[k] += torque_of(point - state.x[k], force)


def turned_by(omega, r):
    """Return ω × r, in the plane or in space."""
    return np.array([-omega * r[1], omega * r[0]]) if len(r) == 2 else np.cross(omega, r)


def torque_of(r, F):
    """Return r × F: a number in the plane, a vector in space."""
    return r[0] * F[1] - r[1] * F[0] if len(r) == 2 else np.cross(r, F)


# ---------------------------------------------------------------------------------------------- what it contains

def joined_pairs(model):
    """Return the pairs of bodies, frozensets of two numbers, that share a joint and therefore do not collide."""
    return {frozenset((joint.a, joint.b)) for joint in model.joints if not isinstance(joint, Distance)}


def pair_test(model):
    """Return could_touch(i, j) → whether two bodies could ever touch: both have shapes, one can move, no joint."""
    joined = joined_pairs(model)
    shaped = [body.shape is not None for body in model.bodies]
    moves = [can_move(body) for body in model.bodies]

    def could_touch(i, j):
        return shaped[i] and shaped[j] and (moves[i] or moves[j]) and frozenset((i, j)) not in joined
    return could_touch


def touching_pairs(model):
    """Return the pairs (i, j), i < j, of bodies that could ever touch."""
    could_touch = pair_test(model)
    bodies = range(len(model.bodies))
    return [(i, j) for i in bodies for j in bodies[i + 1:] if could_touch(i, j)]


def friction_of(model, i, j):
    """Return μ of a pair of bodies [-]; 0 where one of them has none, also where the other has ∞."""
    a, b = model.bodies[i].mu, model.bodies[j].mu
    return a * b if a > 0.0 and b > 0.0 else 0.0


def restitution_of(model, i, j):
    """Return e of a pair of bodies [-]."""
    return model.bodies[i].e * model.bodies[j].e


# ---------------------------------------------------------------------------------------------- judged and seen

def model_energy(model, state):
    """Return the energy [J] of motion, height and springs of all bodies that impulses move.

    *Left out:* what function loads store; what drag and dampers have taken is gone.
    """
    energy = 0.0
    for body, x, q, v, omega in zip(model.bodies, *state):
        if can_move(body):
            energy += body.m * (0.5 * v @ v - np.dot(model.gravity, x))
        if can_turn(body):
            w = omega if model.d == 2 else rotation_of(q).T @ omega                # about the axes of the body
            energy += 0.5 * np.sum(np.multiply(body.inertia, w * w))
    for spring in model.springs:
        way = world_place(state, spring.a, spring.place_a) - world_place(state, spring.b, spring.place_b)
        energy += 0.5 * spring.k * (np.sqrt(way @ way) - spring.rest) ** 2
    return float(energy)


def picture_of(model, state, width=3.0):
    """Return (points (k, 2) [m], links) of the outlines of all shapes in the plane, for a film.

    A half-space is a line, `width` [m] to both sides of the point of it that is nearest to the origin.  A body without
    a shape is a line through the places of its joints, such as a rod, or a point.
    """
    points, links = [], []
    for k, (body, x, q) in enumerate(zip(model.bodies, state.x, state.q)):
        if isinstance(body.shape, HalfSpace):
            n = np.array(body.shape.normal)
            middle = np.array(body.x) - body.shape.offset * n
            line = middle + width * np.outer((-1.0, 1.0), (n[1], -n[0]))
            closed = False
        elif body.shape is not None:
            line = x + outline_of(body.shape, 16)[:-1] @ rotation_of(q).T
            closed = True
        else:
            held = [own_place(model, k, joint.place) for joint in model.joints
                    if k in (joint.a, joint.b) and not isinstance(joint, Distance)]
            line = x + np.array(held or [np.zeros(2)]) @ rotation_of(q).T
            closed = False
        first, last = len(points), len(points) + len(line) - 1
        links += [*((i, i + 1) for i in range(first, last)), *[(last, first)] * closed]
        points += list(line)
    return np.array(points), links
