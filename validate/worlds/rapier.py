"""Rapier 3: single precision and soft steps in space, made for games.

Friction and restitution of a pair are products here, by its rule MULTIPLY.  A planar Model moves in the plane x, z.
Its joints are constraints between bodies.  A rod without mass is a stiff spring of the engine, whose steps are
implicit: a limit of the distance, as its rope has, only pulls.  Its friction does not point against the sliding of a
body that is pushed askew: a crate went 4 mm aside on a way of 1 m.  With its friction of each point it is 14 mm.
"""

from functools import cache
from typing import NamedTuple

import numpy as np

from solutions.support.model import (
    WORLD,
    BallJoint,
    Distance,
    Hinge,
    State,
    Weld,
    can_move,
    can_turn,
    friction_of,
    loads_at,
    start_of,
    world_place,
)
from solutions.support.shapes import Ball, Box, Capsule, HalfSpace, Polygon, Polyhedron

from ..engines import quiet_import
from ..reference.orientation import quaternion
from . import Push, World, unsupported
from .derived import (
    Embedding,
    beyond_single,
    checked_step,
    grip,
    moved_start,
    thinnest,
    with_plain_springs,
)

SUBSTEPS = 4                 # per step, by default
SLOP = 1e-5                  # overlap that it leaves [m]; its default is 5 mm
RIGID = 1e8                  # stiffness of a rod per mass of its lighter end [1/s²]
THIN = 5e-3                  # half of the width below which a polyhedron falls into boxes and other polyhedra [m]
FAST = 1e6                   # its greatest speed [m/s]; its default is 400


class Parts(NamedTuple):
    """A world that is being built."""
    rapier: object
    world: object
    model: object
    start: State
    space: Embedding
    bodies: list             # its handle of each body of the Model
    colliders: dict          # {(index, generation) of a collider: number of a body}


@cache
def module():
    """Return rapier3d."""
    return quiet_import("rapier3d")


def refuses(model):
    """Return why it cannot run a model, or ""."""
    if thinnest(model) < THIN:
        return f"its polyhedra must be at least {2.0 * THIN:g} m wide"
    return beyond_single(model) or unsupported(model, Ball, Box, Capsule, Polygon, Polyhedron, HalfSpace, Hinge,
                                               BallJoint, Weld, Distance)


def build(model, dt, substeps=SUBSTEPS, ahead=0.0):
    """Make a World.  ahead: share of a substep by which the first velocities lag; ½ makes leapfrog."""
    dt = checked_step(model, dt, refuses)
    rapier, model = module(), with_plain_springs(model)
    space = Embedding(model.d)
    world = rapier.PhysicsWorld(gravity=tuple(space.point(model.gravity).tolist()))
    parts = Parts(rapier, world, model, start_of(model), space, [], {})
    loaded = bool(model.springs or model.loads)            # a force stays for a whole step, so a substep is one there
    configure(parts, dt / substeps if loaded else dt, 1 if loaded else substeps)
    add_bodies(parts, ahead * dt / substeps)
    add_joints(parts)
    clock = [0]

    def step():
        for _ in range(substeps if loaded else 1):
            if loaded:
                push(parts, clock[0] * dt / substeps)
            clock[0] += 1
            world.step()
    return World(step, lambda: state(parts), lambda: pushes(parts, dt / substeps if loaded else dt), world.clear)


def configure(parts, dt, substeps):
    """Set the solver, in place.  Threads of the world's own would cost a change of threads in every step."""
    settings = parts.world.integration_parameters
    settings.dt, settings.num_solver_iterations = dt, substeps
    settings.normalized_allowed_linear_error, settings.normalized_max_linear_velocity = SLOP, FAST
    settings.contact_recycling = settings.contact_clustering = False       # contacts of this step, all of them


# ---------------------------------------------------------------------------------------------- bodies

def add_bodies(parts, age):
    """Add the bodies; age [s]: how old the first velocities are."""
    rapier, space, start = parts.rapier, parts.space, parts.start
    v, omega = moved_start(parts.model, -age)[2:]
    for k, body in enumerate(parts.model.bodies):
        carries = np.any(start.v[k]) or np.any(start.omega[k])
        make = (rapier.RigidBody.dynamic if can_move(body) else
                rapier.RigidBody.kinematic_velocity_based if carries else rapier.RigidBody.fixed)
        at = rapier.Isometry3(tuple(space.point(start.x[k]).tolist()), rotation(rapier, space.frame(start.q[k])))
        made = (make().position(at).linvel(tuple(space.point(v[k]).tolist()))
                .angvel(tuple(space.turning(omega[k]).tolist())).can_sleep(False)
                .allow_fast_rotation(True))
        if can_move(body):
            made = weighed(parts, made, body)
        parts.bodies.append(parts.world.add_body(made))
        if body.shape is not None:
            rule = rapier.CoefficientCombineRule.MULTIPLY
            about = (shape_of(parts, k).density(0.0).friction(grip(body)).restitution(body.e)
                     .friction_combine_rule(rule).restitution_combine_rule(rule))
            handle = parts.world.add_collider(about, parts.bodies[k])
            parts.colliders[handle.index, handle.generation] = k


def weighed(parts, made, body):
    """Return a body with its mass and its moments; one of the plane turns about y only.

    It may move along y, where nothing pushes it: contacts of a body that cannot have no friction.
    """
    moments = np.broadcast_to(body.inertia, 3) if can_turn(body) else np.ones(3)
    made = made.gyroscopic_forces(True).additional_mass_properties(
        parts.rapier.MassProperties((0.0, 0.0, 0.0), body.m, tuple(moments.tolist())))
    flat, turns = parts.space.flat, can_turn(body)
    return made.enabled_rotations((turns and not flat, turns, turns and not flat))


def shape_of(parts, k):
    """Return the shape of body k; a half-space lies in the world, and is put into its body."""
    shape, space, make = parts.model.bodies[k].shape, parts.space, parts.rapier.Collider
    if isinstance(shape, Ball):
        return make.ball(shape.radius)
    if isinstance(shape, Box):
        return make.cuboid(*space.half(shape.half).tolist())
    if isinstance(shape, Capsule):
        return make.capsule_x(shape.half_length, shape.radius)
    if isinstance(shape, Polygon):
        return make.convex_hull(space.deep(shape.corners).astype(np.float32))
    if isinstance(shape, Polyhedron):
        return make.convex_hull(np.array(shape.corners, np.float32))
    R, n = space.frame(parts.start.q[k]), space.point(shape.normal)
    place = R.T @ (-shape.offset * n - space.point(parts.start.x[k]))
    return make.halfspace(tuple((R.T @ n).tolist())).translation(tuple(place.tolist()))


# ---------------------------------------------------------------------------------------------- joints

def add_joints(parts):
    """Add the joints."""
    ground = parts.world.add_body(parts.rapier.RigidBody.fixed()) if parts.model.joints else None
    for joint in parts.model.joints:
        ends = [ground if k == WORLD else parts.bodies[k] for k in (joint.b, joint.a)]
        made = rod_of(parts, joint) if isinstance(joint, Distance) else joint_of(parts, joint)
        parts.world.impulse_joints.insert(*ends, made)


def rod_of(parts, joint):
    """Return the spring of the engine that stands for a rod without mass."""
    space, start = parts.space, parts.start
    length = np.linalg.norm(world_place(start, joint.a, joint.place_a) - world_place(start, joint.b, joint.place_b))
    mass = min(parts.model.bodies[k].m for k in (joint.a, joint.b) if k != WORLD)
    return (parts.rapier.SpringJoint.builder(float(length), RIGID * mass, 0.0)
            .local_anchor1(tuple(space.point(joint.place_b).tolist()))
            .local_anchor2(tuple(space.point(joint.place_a).tolist())).contacts_enabled(True).build())


def joint_of(parts, joint):
    """Return a joint of the engine; joined bodies do not collide.

    Rows that only turn a body where it cannot turn make its joints stiff all over, so a hinge of the plane has none.
    """
    rapier, space, mask = parts.rapier, parts.space, parts.rapier.JointAxesMask
    basis, axes = np.eye(3), mask.LIN_AXES
    if isinstance(joint, Weld):
        axes = axes | (mask.ANG_Y if space.flat else mask.ANG_AXES)
    elif isinstance(joint, Hinge) and not space.flat:
        basis, axes = across(joint.axis), axes | mask.ANG_Y | mask.ANG_Z
    frames = []
    for k in (joint.b, joint.a):
        R = np.eye(3) if k == WORLD else space.frame(parts.start.q[k])
        base = np.zeros(3) if k == WORLD else space.point(parts.start.x[k])
        place = R.T @ (space.point(joint.place) - base)
        frames.append(rapier.Isometry3(tuple(place.tolist()), rotation(rapier, R.T @ basis)))
    return (rapier.GenericJoint.builder(axes).local_frame1(frames[0]).local_frame2(frames[1])
            .contacts_enabled(False).build())


def across(axis):
    """Return a rotation (3, 3) whose first column is a unit vector."""
    side = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    side = side / np.linalg.norm(side)
    return np.stack((axis, side, np.cross(axis, side)), axis=1)


def rotation(rapier, R):
    """Return the engine's rotation of a matrix."""
    return rapier.Rotation3.from_quaternion(*quaternion(R).tolist())


# ---------------------------------------------------------------------------------------------- a step, and after it

def state(parts):
    """Return the State; a fixed body stays where the Model has it."""
    seen = [parts.world.rigid_bodies[handle] for handle in parts.bodies]
    now = parts.space.back([one.translation.to_tuple() for one in seen],
                           [np.roll(one.rotation.to_tuple(), 1) for one in seen],
                           [one.linvel.to_tuple() for one in seen], [one.angvel.to_tuple() for one in seen])
    for k, one in enumerate(seen):
        if one.is_fixed:
            now.x[k], now.q[k] = parts.start.x[k], parts.start.q[k]
    return now


def push(parts, t):
    """Apply springs and loads at time t [s] during the next step."""
    F, tau = loads_at(parts.model, t, state(parts))
    for k, body in enumerate(parts.model.bodies):
        if can_move(body):
            one = parts.world.rigid_bodies[parts.bodies[k]]
            one.reset_forces()
            one.reset_torques()
            one.add_force(tuple(parts.space.point(F[k]).tolist()))
            one.add_torque(tuple(parts.space.turning(tau[k]).tolist()))


def pushes(parts, dt):
    """Return the forces of contacts without friction, from their impulses over dt [s].

    Its binding tells how large friction is and not where it points to.  It tells the impulses of rows that it has made
    orthogonal, and not those of a joint: a pendulum's force was (0.7, 48.7) N where it changed the velocity by
    (3.8, 48.7) N.
    """
    found = []
    for pair in parts.world.narrow_phase.contact_pairs():
        a, b = (parts.colliders[one.index, one.generation] for one in (pair.collider1, pair.collider2))
        J = np.array(pair.total_impulse().to_tuple())
        if np.any(J) and not friction_of(parts.model, a, b):
            found.append(Push(a, b, parts.space.push(-J / dt)))
    return found
