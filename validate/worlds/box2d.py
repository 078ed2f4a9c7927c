"""Box2D 3, by pyb2d3: single precision and soft steps, made for games.

Its friction of a pair is √(μ_a μ_b), so each body gets the square of its μ.  Its restitution of a pair is the greater
one.  It turns no body by more than π/4 in a step: faster spins are cut off.
"""

from functools import cache

import numpy as np

from solutions.support.model import (
    WORLD,
    Distance,
    Hinge,
    State,
    Weld,
    can_move,
    loads_at,
    own_place,
    restitution_of,
    start_of,
    touching_pairs,
    world_place,
)
from solutions.support.shapes import Ball, Box, Capsule, HalfSpace, Polygon

from ..engines import quiet_import
from . import Push, World, unsupported
from .derived import (
    SPINS_ON,
    as_numbered,
    beyond,
    beyond_single,
    checked_step,
    grip,
    in_plane,
    moved_start,
    spins_on,
    weld_place,
    with_plain_springs,
)

UNITS = 0.01                 # its unit of length [m]: the slop is then 0.05 mm and not 5 mm
SUBSTEPS = 4                 # per step, by default
MOST_CORNERS = 8             # of a polygon
MERGED = 2e-4                # corners of a polygon that are not farther apart become one [m]
STRAIGHT = 1e-4              # and one that is not farther from the line between its neighbours is left out [m]
LONG = 200.0                 # half length of the box that stands for a half-space [m]


@cache
def module():
    """Return pyb2d3.  Its unit of length holds for the whole process, and must be set before the first world."""
    b2 = quiet_import("pyb2d3")
    b2.set_length_units_per_meter(UNITS)
    return b2


def new_world(b2, gravity):
    """Make a world in which nothing sleeps, restitution holds at every speed, and no speed is too large."""
    world = b2.World(gravity=gravity, restitution_threshold=0.0, maximum_linear_speed=1e6)
    world.sleeping_enabled = world.continuous_enabled = False
    return world


def restitutions(model):
    """Return e of each body whose greater one is that of every pair; None where there are none."""
    pairs = touching_pairs(model)
    e = [min([restitution_of(model, *pair) for pair in pairs if k in pair], default=0.0)
         for k in range(len(model.bodies))]
    return e if all(max(e[i], e[j]) == restitution_of(model, i, j) for i, j in pairs) else None


def refuses(model):
    """Return why it cannot run a model, or ""."""
    if model.d == 3 and in_plane(model) is None:
        return "it is an engine of the plane"
    if spins_on(model):
        return SPINS_ON
    if restitutions(model) is None:
        return "its restitution of a pair is the greater of two, which cannot be the product in all pairs here"
    if any(isinstance(body.shape, Polygon) and len(body.shape.corners) > MOST_CORNERS for body in model.bodies):
        return f"its Polygon has at most {MOST_CORNERS} corners"
    if any(isinstance(body.shape, Polygon) and loses_corners(body.shape.corners) for body in model.bodies):
        return "it leaves out a corner of a Polygon that is so near to others"
    return (unsupported(model, Ball, Box, Capsule, Polygon, HalfSpace, Hinge, Weld, Distance)
            or beyond(model, LONG) or beyond_single(model))


def loses_corners(corners):
    """Return whether the engine would leave out a corner of a polygon.  One without three corners falls through planes.

    *Source:* Box2D, `src/hull.c`, b2ComputeHull: four and two times its slop, which is half a hundredth of its UNITS.
    """
    here = np.array(corners)
    side = np.roll(here, -1, axis=0) - here
    across = side + np.roll(side, 1, axis=0)                         # from the corner before to the one behind
    height = np.abs(across[:, 0] * side[:, 1] - across[:, 1] * side[:, 0]) / np.linalg.norm(across, axis=1)
    return np.min(np.linalg.norm(side, axis=1)) <= MERGED or np.min(height) <= STRAIGHT


def build(model, dt, substeps=SUBSTEPS, ahead=0.0):
    """Make a World.  ahead: share of a substep by which the first velocities lag; ½ makes leapfrog."""
    dt = checked_step(model, dt, refuses)
    if model.d == 3:
        flat, lift = in_plane(model)
        world = build(flat, dt, substeps, ahead)
        return world._replace(state=lambda: lift(world.state()))
    whole, model = model, with_plain_springs(model)
    world = new_world(module(), model.gravity)
    bodies = add_bodies(world, model, ahead * dt / substeps)
    joints = add_joints(world, model, bodies)
    clock = [0]
    state = lambda: state_of(world, bodies)

    def step():
        if not (model.springs or model.loads):
            world.step(dt, substeps)
            return
        for _ in range(substeps):                          # a force stays for a whole step, so a substep is one here
            push(model, bodies, loads_at(model, clock[0] * dt / substeps, state()))
            clock[0] += 1
            world.step(dt / substeps, 1)
    return World(step, state, as_numbered(lambda: pushes(world, model, joints), whole))


def state_of(world, bodies):
    """Return the State.  The world is held because its bodies end with it."""
    return State(np.array([tuple(body.position) for body in bodies], float),
                 np.array([np.arctan2(body.rotation.s, body.rotation.c) for body in bodies], float),
                 np.array([tuple(body.linear_velocity) for body in bodies], float),
                 np.array([body.angular_velocity for body in bodies], float))


def push(model, bodies, loads):
    """Apply (F, tau) during the next step."""
    for body, one, F, tau in zip(bodies, model.bodies, *loads):
        if can_move(one):
            body.apply_force_to_center(tuple(F.tolist()), True)
            body.apply_torque(float(tau), True)


def add_bodies(world, model, age):
    """Return the engine's bodies; age [s]: how old the first velocities are."""
    b2, start, e, made = module(), start_of(model), restitutions(model), []
    v, omega = moved_start(model, -age)[2:]
    for k, one in enumerate(model.bodies):
        carries = np.any(start.v[k]) or start.omega[k]
        make = (world.create_dynamic_body if can_move(one) else
                world.create_kinematic_body if carries else world.create_static_body)
        body = make(position=tuple(start.x[k].tolist()), rotation=turned(b2, float(start.q[k])),
                    linear_velocity=tuple(v[k].tolist()), angular_velocity=float(omega[k]))
        surface = b2.surface_material(friction=grip(one) ** 2, restitution=e[k])
        add_shape(b2, body, one, b2.shape_def(material=surface, density=1.0))
        if can_move(one):
            weigh(b2, body, one)
        made.append(body)
    return made


def turned(b2, angle):
    """Return the engine's rotation by an angle [rad].  Its own make_rot and its own angle err by up to 1.5e-3."""
    made = b2.make_rot(angle)
    made.c, made.s = np.cos(angle), np.sin(angle)
    return made


def add_shape(b2, body, one, about):
    """Add the shape of a body; a half-space lies in the world, and its body is not turned."""
    shape = one.shape
    if isinstance(shape, Ball):
        body.create_circle_shape(about, b2.circle(radius=shape.radius))
    elif isinstance(shape, Capsule):
        h = shape.half_length
        body.create_capsule_shape(about, b2.capsule((-h, 0.0), (h, 0.0), shape.radius))
    elif isinstance(shape, Box):
        body.create_polygon_shape(about, b2.box(*shape.half))
    elif isinstance(shape, Polygon):
        body.create_polygon_shape(about, b2.polygon(points=np.array(shape.corners, np.float32)))
    elif isinstance(shape, HalfSpace):
        n = np.array(shape.normal)
        place = own_place_of(one, -(shape.offset + 1.0) * n)
        body.create_polygon_shape(about, b2.box(LONG, 1.0, center=tuple(place.tolist()),
                                                rotation=float(np.arctan2(-n[0], n[1]) - one.q)))


def own_place_of(body, place):
    """Return a place of the world in coordinates of a body."""
    c, s = np.cos(body.q), np.sin(body.q)
    return np.array([(c, s), (-s, c)]) @ (place - np.array(body.x))


def weigh(b2, body, one):
    """Set the mass and the moment."""
    mass = b2.MassData()
    mass.mass, mass.center = one.m, (0.0, 0.0)
    mass.rotational_inertia = one.inertia if np.isfinite(one.inertia) else 0.0
    if not np.isfinite(one.inertia):
        body.fixed_rotation = True
    body.mass_data = mass


def add_joints(world, model, bodies):
    """Return the engine's joints."""
    start, joints = start_of(model), []
    ground = world.create_static_body(position=(0.0, 0.0)) if model.joints else None
    for joint in model.joints:
        ends = {f"body_{end}": ground if k == WORLD else bodies[k] for end, k in (("a", joint.b), ("b", joint.a))}
        if isinstance(joint, Distance):
            places, length = (joint.place_b, joint.place_a), np.linalg.norm(
                world_place(start, joint.a, joint.place_a) - world_place(start, joint.b, joint.place_b))
            more, make = {"length": float(length), "collide_connected": True}, world.create_distance_joint
        else:
            place = weld_place(model, joint) if isinstance(joint, Weld) else joint.place
            places = [own_place(model, k, place).tolist() for k in (joint.b, joint.a)]
            more, make = {}, world.create_revolute_joint
            if isinstance(joint, Weld):
                turn = [0.0 if k == WORLD else start.q[k] for k in (joint.b, joint.a)]
                more, make = {"reference_angle": float(turn[1] - turn[0])}, world.create_weld_joint
        joints.append(make(**ends, local_anchor_a=tuple(places[0]), local_anchor_b=tuple(places[1]), **more))
    return joints


def pushes(world, model, joints):
    """Return the forces of joints.  Its binding reports no forces of contacts.  The world is held, as for the State."""
    return [Push(joint.a, joint.b, np.array(tuple(made.get_constraint_force()), float), n)
            for n, (joint, made) in enumerate(zip(model.joints, joints))]
