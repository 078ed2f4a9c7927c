"""pymunk (Chipmunk2D).  It moves, then pushes.  Friction and restitution of a pair are products, as in a Model."""

import numpy as np

from solutions.checks import BadInput
from solutions.support.model import (
    WORLD,
    Distance,
    Drag,
    Hinge,
    State,
    Weld,
    can_move,
    can_turn,
    loads_at,
    own_place,
    start_of,
    world_place,
)
from solutions.support.shapes import Ball, Box, Capsule, HalfSpace, Polygon

from ..engines.chipmunk import pymunk_space
from . import Push, World, unsupported
from .derived import (
    beyond,
    bounces,
    checked_step,
    forces_of,
    grip,
    in_plane,
    moved_start,
    pressed_in,
    touches,
    weld_place,
    with_plain_springs,
)

OVERLAP = 1e-6               # [m]: inside the slop, so that a contact exists in the first step
SLOP = 1e-5                  # overlap that it leaves [m]
THICK, LONG = 5.0, 1000.0    # radius and half length of the segment that stands for a half-space [m]


def refuses(model):
    """Return why it cannot run a model, or ""."""
    if model.d == 3 and in_plane(model) is None:
        return "it is an engine of the plane"
    return (unsupported(model, Ball, Box, Capsule, Polygon, HalfSpace, Hinge, Weld, Distance)
            or beyond(model, LONG))


def build(model, dt, iterations=None, ahead=0.0, accelerations=None, bias=0.0, overlap=OVERLAP, slop=SLOP,
          own_drag=False):
    """Make a World.

    ahead: share of a step by which the first velocities run ahead; ½ makes leapfrog
    accelerations: (a (n, 2), α (n,)) of the bodies then, with what contacts and joints do; without it those of loads
    own_drag: the space damps, v e^(−k dt/m) at the end of a step, in place of a force −k v of the old velocity
    """
    dt = checked_step(model, dt, refuses)
    settings = {"iterations": iterations, "ahead": ahead, "accelerations": accelerations, "bias": bias,
                "overlap": overlap, "slop": slop, "own_drag": own_drag}
    if model.d == 3:
        flat, lift = in_plane(model)
        world = build(flat, dt, **settings)
        return world._replace(state=lambda: lift(world.state()))
    model = with_plain_springs(model)
    space = pymunk_space(model.gravity)
    if own_drag:
        model = let_damp(space, model)
    space.collision_slop = slop
    if iterations or touches(model) or model.joints:
        space.iterations = iterations or max(100, 10 * len(model.joints))
    bodies = add_bodies(space, model, moved_start(model, ahead * dt, accelerations), overlap)
    add_joints(space, model, bodies, bias)
    add_springs(space, model, bodies)
    rows = lambda name: np.array([getattr(body, name) for body in bodies], float)
    state = lambda: State(rows("position"), rows("angle"), rows("velocity"), rows("angular_velocity"))
    step, forces = lambda: space.step(dt), forces_of(model, springs=False)
    if forces:
        step = step_with_forces(space, bodies, forces, dt)
    elif model.loads:
        step = step_with_loads(space, model, bodies, state, dt)
    return World(step, state, lambda: pushes(space, bodies, dt))


def let_damp(space, model):
    """Let the space damp as much as the drag, which is left out of the Model that is returned."""
    kept = tuple(load for load in model.loads if not isinstance(load, Drag))
    k = sum(load.k for load in model.loads if isinstance(load, Drag))
    rates = {k / body.m for body in model.bodies if can_move(body)}
    if len(rates) > 1:
        raise BadInput("own_drag", f"{len(rates)} rates k/m", "take it for bodies of one mass")
    space.damping = np.exp(-sum(rates))                  # the share of the velocity that is left after one second
    return model._replace(loads=kept)


def add_bodies(space, model, start, overlap):
    """Return the engine's bodies, with the velocities of this State."""
    import pymunk
    x = pressed_in(model, overlap) if touches(model) and not bounces(model) else start.x
    bodies = []
    for k, one in enumerate(model.bodies):
        carries = np.any(start.v[k]) or np.any(start.omega[k])
        body = (pymunk.Body(one.m, one.inertia) if can_move(one) else
                pymunk.Body(body_type=pymunk.Body.KINEMATIC if carries else pymunk.Body.STATIC))
        body.position, body.angle = tuple(x[k].tolist()), float(start.q[k])
        body.velocity, body.angular_velocity = tuple(start.v[k].tolist()), float(start.omega[k])
        space.add(body)
        if one.shape is not None:
            shape = shape_of(body, one.shape)
            shape.friction, shape.elasticity = grip(one), one.e
            space.add(shape)
        bodies.append(body)
    return bodies


def shape_of(body, shape):
    """Return a shape of the engine.  A half-space lies in the world, so its body is turned back."""
    import pymunk
    if isinstance(shape, Ball):
        return pymunk.Circle(body, shape.radius)
    if isinstance(shape, Box):
        return pymunk.Poly.create_box(body, tuple(2.0 * h for h in shape.half))
    if isinstance(shape, Capsule):
        return pymunk.Segment(body, (-shape.half_length, 0.0), (shape.half_length, 0.0), shape.radius)
    if isinstance(shape, Polygon):
        return pymunk.Poly(body, list(shape.corners))
    n = np.array(shape.normal)
    middle, along = -(shape.offset + THICK) * n, LONG * np.array([n[1], -n[0]])
    ends = [body.world_to_local(tuple((middle + way * along).tolist())) for way in (-1.0, 1.0)]
    return pymunk.Segment(body, *ends, THICK)


def ends_of(space, bodies, one):
    """Return the engine's two bodies of a joint or a spring, b first."""
    return [space.static_body if k == WORLD else bodies[k] for k in (one.b, one.a)]


def add_joints(space, model, bodies, bias):
    """Add the joints.  bias: share of an error that is left after one second."""
    import pymunk
    start = start_of(model)
    for joint in model.joints:
        b, a = ends_of(space, bodies, joint)
        if isinstance(joint, Distance):
            places = joint.place_b, joint.place_a
            rod = pymunk.PinJoint(b, a, *places)
            rod.distance = float(np.linalg.norm(world_place(start, joint.a, joint.place_a)
                                                - world_place(start, joint.b, joint.place_b)))
            made = [rod]
        else:
            place = weld_place(model, joint) if isinstance(joint, Weld) else joint.place
            anchors = [tuple(own_place(model, k, place).tolist()) for k in (joint.b, joint.a)]
            made = [pymunk.PivotJoint(b, a, *anchors)]
            if isinstance(joint, Weld) and any(k != WORLD and can_turn(model.bodies[k]) for k in (joint.a, joint.b)):
                made.append(pymunk.GearJoint(b, a, a.angle - b.angle, 1.0))
        for one in made:
            one.error_bias, one.collide_bodies = bias, isinstance(joint, Distance)
            space.add(one)


def add_springs(space, model, bodies):
    """Add the springs."""
    import pymunk
    for spring in model.springs:
        space.add(pymunk.DampedSpring(*ends_of(space, bodies, spring), spring.place_b, spring.place_a,
                                      spring.rest, spring.k, spring.c))


def step_with_forces(space, bodies, forces, dt):
    """Return the step with forces of floats.

    The engine moves the bodies first, and then calls their velocity functions.  A force that depends on the place is
    computed there: set before the step it would belong to the old place, which is forward Euler.  Velocity and time
    are then those of before the step, so that their forces can be set before it.
    """
    of_velocity, of_time, advance, clock = [], [], space.step, [0]
    for k, (F, of, b) in forces.items():
        if of == "r":
            bodies[k].velocity_func = attracted(bodies[k].mass, F, bodies[b])
        elif "x" in of:
            bodies[k].velocity_func = pulled(bodies[k].mass, F, of)
        else:
            (of_time if of == "t" else of_velocity).append((bodies[k], F))

    def step():
        for body, F in of_velocity:
            body.force = F(body.velocity)                        # the step clears it
        advance(dt)

    def step_at_a_time():
        for body, F in of_time:
            body.force = F(clock[0] * dt)
        clock[0] += 1
        step()
    return step_at_a_time if of_time else step if of_velocity else lambda: advance(dt)


def pulled(mass, force, of):
    """Return the velocity function of a body with a force that depends on its place."""
    share = 1.0 / mass

    def update(body, gravity, damping, dt):
        x, (right, up) = body.position, body.velocity
        F = force(x) if of == "x" else force(x, (right, up))
        body.velocity = right + dt * (gravity[0] + share * F[0]), up + dt * (gravity[1] + share * F[1])
    return update


def attracted(mass, force, other):
    """Return the velocity function of a body with a force that depends on the vector to another body."""
    share = 1.0 / mass

    def update(body, gravity, damping, dt):
        (x, y), (there, high), (right, up) = body.position, other.position, body.velocity
        F = force((there - x, high - y))
        body.velocity = right + dt * (gravity[0] + share * F[0]), up + dt * (gravity[1] + share * F[1])
    return update


def step_with_loads(space, model, bodies, state, dt):
    """Return the step with loads that are functions: each body has a velocity function; see `step_with_forces`."""
    import pymunk
    memory, loads, clock = {"step": None}, model._replace(springs=()), [0]

    def now():
        if memory["step"] != clock[0]:
            memory.update(step=clock[0], loads=loads_at(loads, clock[0] * dt, state()))
        return memory["loads"]

    def pushed(k):
        def update(body, gravity, damping, dt):
            F, tau = now()
            a = gravity[0] + F[k, 0] / body.mass, gravity[1] + F[k, 1] / body.mass
            pymunk.Body.update_velocity(body, a, 1.0, dt)
            body.angular_velocity += dt * float(tau[k]) / body.moment
        return update
    for k, body in enumerate(bodies):
        if can_move(model.bodies[k]):
            body.velocity_func = pushed(k)

    def step():
        space.step(dt)
        clock[0] += 1
    return step


def pushes(space, bodies, dt):
    """Return the contact forces, one for each pair.  Of a joint the engine reports only the size of its impulse.

    The space is held because contacts end with it.
    """
    import pymunk
    number, found = {id(body): k for k, body in enumerate(bodies)}, {}

    def add(arbiter):
        a, b = (number[id(shape.body)] for shape in arbiter.shapes)
        found[frozenset((a, b))] = Push(a, b, np.array(arbiter.total_impulse) / dt)
    for body in bodies:
        if body.body_type == pymunk.Body.DYNAMIC:
            body.each_arbiter(add)
    return list(found.values())
