"""pybullet.  It pushes, then moves.  Friction and restitution of a pair are products, as in a Model.

It turns no body by more than π/4 in a step, however fast it spins.  A planar Model moves in the plane x, z.  In maximal
coordinates joints are constraints.  In reduced coordinates a tree of hinges is one body with links, and a BallJoint is
a constraint.
"""

from typing import NamedTuple

import numpy as np

from solutions.checks import BadInput
from solutions.support.model import (
    WORLD,
    BallJoint,
    Drag,
    Hinge,
    State,
    Weld,
    can_move,
    can_turn,
    friction_of,
    joined_pairs,
    loads_at,
    touching_pairs,
)
from solutions.support.shapes import Ball, Box, Capsule, HalfSpace, Polygon, Polyhedron

from ..engines.bullet import CONTACT_ERP, WARM, Bullet
from ..reference.orientation import about, quaternion
from . import Push, World, unsupported
from .derived import (
    OPENS,
    Embedding,
    beyond,
    bounces,
    carries,
    checked_step,
    cuts_moments,
    fastest,
    forces_of,
    grip,
    moved_start,
    net_of,
    only_holds,
    opens,
    pressed_in,
    round_only,
    smallest,
    thinnest,
    touches,
    tree,
    weld_place,
    with_plain_springs,
)

OVERLAP = 1e-6               # [m]: a contact exists in the first step
NOWHERE = (0.0, 0.0, 0.0)    # from the centre of a body [m]
ROUGHEST = 10.0              # its largest friction of a pair [-]
WIDE = 1e12                  # stands for an infinite moment of inertia [kg m²]
THIN = 1e-3                  # half of the width below which a polyhedron falls into boxes and other polyhedra [m]
BREAKING = 0.02              # the engine's default [-]
SLAB = 50.0                  # half size of the box that stands for a half-space [m]
FAR = 1000.0                 # where bodies are while they get their moments [m]
LINKS = Hinge, Weld          # joints that are coordinates of a body with links
ARM = 0.5                    # distance from a joint of further points that are held together [m]
TO_CAPSULE = (0.0, np.sqrt(0.5), 0.0, np.sqrt(0.5))  # turns z, the engine's axis of a capsule, to x; w is last


class Settings(NamedTuple):
    """What cannot be derived from a Model."""
    maximal: bool = True     # coordinates of bodies that move
    iterations: int | None = None    # of the solver; None: 10 per joint, at least 100
    ahead: float = 0.0       # share of a step by which the first velocities lag; ½ makes leapfrog
    accelerations: tuple | None = None   # (a, α) then, with what contacts and joints do; None: those of the loads
    damped: bool = False     # keep the engine's default damping
    own_drag: bool = False   # bodies damp, v e^(−k dt/m) before the forces, in place of a force −k v
    overlap: float = OVERLAP  # of touching bodies at the start, where nothing bounces [m]
    slop: float = OVERLAP    # overlap that it leaves, where nothing bounces [m]
    erp: float = 1.0         # share of a joint's error that it takes back per step [-]
    warm: float = WARM       # share of the last impulses with which the solver begins [-]
    ground: bool | None = None       # maximal coordinates of fixed bodies; None: as those that move
    breaking: float | None = None    # contactBreakingThreshold, over the size of a body [-]; None: more at a high speed
    residual: float = 0.0    # solverResidualThreshold: the solver ends where nothing changes by more [m/s]
    pyramid: bool = False    # friction within a square along x and y; in reduced coordinates only
    impacts: bool | None = None      # contacts push no overlap out; None: where a pair has restitution
    slabs: bool = False      # half-spaces are boxes also where all that moves is a ball; a pile rests better on them
    weighed: bool = True     # do a step apart beforehand, so that moments of inertia count from the first step


class Parts(NamedTuple):
    """A world that is being built."""
    pb: object
    model: object
    start: State
    space: Embedding
    settings: Settings
    handles: list            # (body, link) of each body of the Model
    impacts: bool            # whether they are set up for impacts, which takes long to find


def refuses(model):
    """Return why it cannot run a model, or ""."""
    if carries(model):
        return "in maximal coordinates it ignores the velocity of a body without mass"
    if thinnest(model) < THIN:
        return f"its polyhedra must be at least {2.0 * THIN:g} m wide"
    return (unsupported(with_plain_springs(model), Ball, Box, Capsule, Polygon, Polyhedron, HalfSpace, Hinge, BallJoint,
                        Weld)
            or ("" if round_only(model) else beyond(model, SLAB)) or cuts_moments(model, WIDE) or cuts_friction(model))


def cuts_friction(model):
    """Return why it refuses a model with a friction that it would cut off, or "".  An infinite friction is ROUGHEST."""
    roughest = sorted(body.mu for body in model.bodies)[-2:]
    cut = roughest[0] * roughest[-1] > ROUGHEST and any(
        ROUGHEST < friction_of(model, *pair) < np.inf for pair in touching_pairs(model))
    return f"it cuts the friction of a pair off at {ROUGHEST:g}" if cut else ""


def build(model, dt, **settings):
    """Make a World."""
    dt = checked_step(model, dt, refuses)
    settings, model = Settings(**settings), with_plain_springs(model)
    if not settings.maximal and opens(model):
        raise BadInput("a model in reduced coordinates", OPENS, "build it in maximal ones")
    if (settings.ahead and not (settings.maximal or settings.accelerations)
            and any(isinstance(joint, LINKS) for joint in model.joints)):
        raise BadInput("ahead, of links in reduced coordinates,", settings.ahead, "give `accelerations`, too")
    drag = sum(load.k for load in model.loads if isinstance(load, Drag)) if settings.own_drag else 0.0
    if settings.own_drag:
        model = model._replace(loads=tuple(load for load in model.loads if not isinstance(load, Drag)))
    world = Bullet(dt)
    start = moved_start(model, -settings.ahead * dt, settings.accelerations)
    parts = Parts(world.pb, model, start, Embedding(model.d), settings, [(-1, -1)] * len(model.bodies),
                  bounces(model) if settings.impacts is None else settings.impacts)
    configure(parts, dt)
    x = pressed_in(model, settings.overlap) if touches(model) and not parts.impacts else parts.start.x
    linked = [] if settings.maximal else add_linked(parts, x)
    for k in range(len(model.bodies)):
        if k not in linked and not only_holds(model, k):
            add_body(parts, k, x[k])
    if settings.maximal and settings.weighed:
        parts.pb.stepSimulation()
    if drag:
        let_damp(parts, drag)
    release(parts, x, linked)
    world.gravity = tuple(parts.space.point(model.gravity).tolist())
    parts.pb.setGravity(*world.gravity)
    join(parts)

    def close():
        parts.pb.setPhysicsEngineParameter(erp=0.2, contactERP=CONTACT_ERP, contactSlop=1e-5,
                                           restitutionVelocityThreshold=0.2)
        world.close()
    return World(step_of(parts, world.step, dt), lambda: state(parts), lambda: pushes(parts), close)


def configure(parts, dt):
    """Set the solver for impacts or for resting contacts."""
    model, settings, impacts = parts.model, parts.settings, parts.impacts
    breaking = settings.breaking or BREAKING
    if settings.breaking is None and np.isfinite(smallest(model)) and not impacts:
        breaking = max(breaking, 1.2 * fastest(model) * dt / smallest(model))
    parts.pb.setPhysicsEngineParameter(
        solverResidualThreshold=settings.residual,
        numSolverIterations=settings.iterations or max(100, 10 * len(model.joints)), erp=settings.erp,
        warmStartingFactor=settings.warm, contactSlop=0.0 if impacts else settings.slop,
        contactERP=0.0 if impacts else CONTACT_ERP, restitutionVelocityThreshold=0.0,
        contactBreakingThreshold=breaking, enableConeFriction=int(not settings.pyramid))


# ---------------------------------------------------------------------------------------------- bodies

def shape_of(parts, body, place=(0.0, 0.0, 0.0)):
    """Return a shape of the engine, or −1; place: its centre in the frame of its body [m]."""
    pb, shape, at = parts.pb, body.shape, {"collisionFramePosition": list(map(float, place))}
    if isinstance(shape, Ball):
        return pb.createCollisionShape(pb.GEOM_SPHERE, radius=shape.radius, **at)
    if isinstance(shape, Box):
        return pb.createCollisionShape(pb.GEOM_BOX, halfExtents=parts.space.half(shape.half).tolist(), **at)
    if isinstance(shape, Capsule):
        return pb.createCollisionShape(pb.GEOM_CAPSULE, radius=shape.radius, height=2.0 * shape.half_length,
                                       collisionFrameOrientation=TO_CAPSULE, **at)
    if isinstance(shape, Polygon):
        return pb.createCollisionShape(pb.GEOM_MESH, vertices=parts.space.deep(shape.corners).tolist(), **at)
    if isinstance(shape, Polyhedron):
        return pb.createCollisionShape(pb.GEOM_MESH, vertices=list(map(list, shape.corners)), **at)
    if isinstance(shape, HalfSpace):
        if has_planes(parts):
            return pb.createCollisionShape(pb.GEOM_PLANE)
        return pb.createCollisionShape(pb.GEOM_BOX, halfExtents=[SLAB, SLAB, 1.0])
    return -1


def has_planes(parts):
    """Return whether half-spaces are the engine's planes, which have no end; otherwise they are boxes."""
    return round_only(parts.model) and not parts.settings.slabs


def frame_of(parts, k, x):
    """Return (place (3,), R (3, 3)) of body k in the engine; a half-space is put where its plane is."""
    shape = parts.model.bodies[k].shape
    if not isinstance(shape, HalfSpace):
        return parts.space.point(x), parts.space.frame(parts.start.q[k])
    n = parts.space.point(shape.normal)
    axis = np.cross([0.0, 0.0, 1.0], n)
    size = np.linalg.norm(axis)
    R = about(axis / size, np.arctan2(size, n[2])) if size > 0.0 else np.diag((1.0, np.sign(n[2]), np.sign(n[2])))
    depth = 0.0 if has_planes(parts) else 1.0
    return -(shape.offset + depth) * n, R


def pose(parts, k, x):
    """Return the same as (place, quaternion with w last) for the engine."""
    place, R = frame_of(parts, k, x)
    return place.tolist(), last(quaternion(R))


def last(q):
    """Return a quaternion with w last, as the engine has them."""
    return np.roll(q, -1).tolist()


def add_body(parts, k, x):
    """Add a body without links; one in maximal coordinates is far from all others until `release`."""
    body, settings = parts.model.bodies[k], parts.settings
    free, (place, q) = can_move(body), pose(parts, k, x)
    maximal = settings.maximal if free or settings.ground is None else settings.ground
    away = free and settings.maximal and settings.weighed
    made = parts.pb.createMultiBody(float(body.m) if free else 0.0, shape_of(parts, body),
                                    basePosition=[FAR, FAR + 100.0 * k, FAR] if away else place, baseOrientation=q,
                                    useMaximalCoordinates=int(maximal))
    parts.handles[k] = made, -1
    describe(parts, k)


def describe(parts, k):
    """Set the moments, the damping and the surface of body k."""
    body, (one, link) = parts.model.bodies[k], parts.handles[k]
    change = {"lateralFriction": grip(body), "restitution": body.e, "rollingFriction": 0, "spinningFriction": 0}
    if can_move(body):
        moments = np.minimum(np.broadcast_to(body.inertia, 3), WIDE).tolist()
        change |= {"mass": body.m, "localInertiaDiagonal": moments}
        if not parts.settings.damped:
            change |= {"linearDamping": 0, "angularDamping": 0}
    if parts.impacts:
        change["contactProcessingThreshold"] = 0
    if isinstance(body.shape, Polygon | Polyhedron):
        change["collisionMargin"] = 0.0                      # else a hull is a millimetre larger than its corners
    parts.pb.changeDynamics(one, link, **change)
    if can_move(body) and not parts.settings.damped and not parts.settings.maximal:
        parts.pb.changeDynamics(one, link, maxJointVelocity=1e9)     # apart: a call with it changes the base


def let_damp(parts, drag):
    """Let the bodies damp as much as a drag [N s/m]: linearDamping is the share that is lost in one second."""
    for body, (one, link) in zip(parts.model.bodies, parts.handles):
        if can_move(body):
            parts.pb.changeDynamics(one, link, linearDamping=-np.expm1(-drag / body.m))


def release(parts, x, linked):
    """Put the bodies at their places with their velocities."""
    start, space = parts.start, parts.space
    for k, body in enumerate(parts.model.bodies):
        if not can_move(body) or k in linked:
            continue
        one = parts.handles[k][0]
        parts.pb.resetBasePositionAndOrientation(one, *pose(parts, k, x[k]))
        parts.pb.resetBaseVelocity(one, space.point(start.v[k]).tolist(), space.turning(start.omega[k]).tolist())


# ---------------------------------------------------------------------------------------------- joints

def join(parts):
    """Add the joints that are constraints, and let joined bodies pass through each other."""
    pb, model = parts.pb, parts.model
    links = set() if parts.settings.maximal else {n for _, n in tree(model, LINKS)[0].values()}
    for joint in [joint for n, joint in enumerate(model.joints) if n not in links]:
        ends = [handle_of(parts, k, joint.place) for k in (joint.a, joint.b)]
        for place in points_of(model, joint):
            constrain(parts, joint, ends, place)
    for a, b in map(tuple, joined_pairs(model)):
        if WORLD not in (a, b) and model.bodies[a].shape is not None and model.bodies[b].shape is not None:
            pb.setCollisionFilterPair(parts.handles[a][0], parts.handles[b][0], parts.handles[a][1],
                                      parts.handles[b][1], 0)


def points_of(model, joint):
    """Return the points of the world that a joint holds together: one, two on an axis, or as many as fix a body.

    In maximal coordinates the engine's own JOINT_FIXED ignores the orientation of its frames: it turns a body until its
    axes are those of the other one.
    """
    place, d = np.array(joint.place), model.d
    if isinstance(joint, Weld):
        place = weld_place(model, joint)
        return [place, *(place + ARM * np.eye(d)[:d if d == 3 else 1])]
    if isinstance(joint, Hinge) and d == 3:
        return [place - ARM * np.array(joint.axis), place + ARM * np.array(joint.axis)]
    return [place]


def handle_of(parts, k, place):
    """Return (body, link) of body k; of the WORLD: a new fixed body without a shape, at the place."""
    if k != WORLD:
        return parts.handles[k]
    place = parts.space.point(place).tolist()
    return parts.pb.createMultiBody(0, -1, basePosition=place, useMaximalCoordinates=int(parts.settings.maximal)), -1


def constrain(parts, joint, ends, place):
    """Hold a place of the world together; the child is the world, or else a."""
    space, own = parts.space, []
    for k in (joint.a, joint.b):
        base, R = (space.point(joint.place), np.eye(3)) if k == WORLD else frame_of(parts, k, parts.start.x[k])
        own.append((R.T @ (space.point(place) - base)).tolist())
    one, other = (0, 1) if joint.b == WORLD else (1, 0)
    parts.pb.createConstraint(*ends[one], *ends[other], parts.pb.JOINT_POINT2POINT, [0, 0, 0], own[one], own[other])


def add_linked(parts, x):
    """Add each tree of joints as one body with links, and return the numbers of its bodies."""
    above, _ = tree(parts.model, LINKS)
    below = {k: [i for i in above if above[i][0] == k and above[i][1] is not None] for k in (WORLD, *above)}
    linked = []
    for k in below:
        held = k == WORLD or not can_move(parts.model.bodies[k])
        free = not held and above[k][1] is None
        for root in (below[k] if held else [k] if free and below[k] else []):
            linked += add_tree(parts, x, root, above, below)
    return linked


def add_tree(parts, x, root, above, below):
    """Add one body with links, and return the numbers of its bodies, a parent before its children."""
    space, start, model = parts.space, parts.start, parts.model
    order = [root]
    for k in order:
        order += below[k]
    hangs = above[root][1] is not None
    rows, frames = [], {}                                     # (origin, R) of the frame of each link
    for k in order:
        R, n = space.frame(start.q[k]), above[k][1]
        origin = space.point(x[k] if n is None else model.joints[n].place)
        frames[k] = origin, R
        if n is not None:
            base, turn = frames.get(above[k][0], (np.zeros(3), np.eye(3)))
            index = 0 if k == root else order.index(above[k][0]) + hangs
            rows.append(link_of(parts, k, n, turn.T @ (origin - base), turn.T @ R, R.T @ (space.point(x[k]) - origin),
                                index))
    body = model.bodies[root]
    base = {"baseMass": 0.0, "basePosition": [0, 0, 0]} if hangs else {
        "baseMass": body.m, "baseCollisionShapeIndex": shape_of(parts, body),
        "basePosition": frames[root][0].tolist(), "baseOrientation": last(quaternion(frames[root][1]))}
    made = parts.pb.createMultiBody(**base, flags=parts.pb.URDF_USE_SELF_COLLISION,
                                    **{name: [row[name] for row in rows] for name in rows[0]})
    for n, k in enumerate(order, 0 if hangs else -1):
        parts.handles[k] = made, n
        describe(parts, k)
    start_links(parts, order, above)
    return order


def link_of(parts, k, n, place, turn, centre, index):
    """Return what createMultiBody takes for body k, which joint n holds."""
    joint, pb, space = parts.model.joints[n], parts.pb, parts.space
    axis = (np.array([0.0, -1.0, 0.0]) if space.flat else
            space.frame(parts.start.q[k]).T @ joint.axis if isinstance(joint, Hinge) else np.eye(3)[0])
    body = parts.model.bodies[k]
    return {"linkMasses": body.m, "linkCollisionShapeIndices": shape_of(parts, body, centre),
            "linkVisualShapeIndices": -1, "linkPositions": place.tolist(), "linkOrientations": last(quaternion(turn)),
            "linkInertialFramePositions": centre.tolist(), "linkInertialFrameOrientations": [0.0, 0.0, 0.0, 1.0],
            "linkParentIndices": index, "linkJointTypes": pb.JOINT_FIXED if isinstance(joint, Weld) else
            pb.JOINT_REVOLUTE, "linkJointAxis": axis.tolist()}


def start_links(parts, order, above):
    """Switch the motors off and set the first rates of the hinges, and of a base that nothing holds."""
    pb, start, space = parts.pb, parts.start, parts.space
    for k in order:
        (body, link), (parent, n) = parts.handles[k], above[k]
        if n is None:
            pb.resetBaseVelocity(body, space.point(start.v[k]).tolist(), space.turning(start.omega[k]).tolist())
        elif isinstance(parts.model.joints[n], Hinge):
            rate = start.omega[k] - (0.0 if parent == WORLD else start.omega[parent])
            rate = rate if space.flat else rate @ parts.model.joints[n].axis
            pb.setJointMotorControl2(body, link, pb.VELOCITY_CONTROL, force=0)
            pb.resetJointState(body, link, 0.0, float(rate))


# ---------------------------------------------------------------------------------------------- a step, and after it

def state(parts):
    """Return the State; a fixed body stays where the Model has it."""
    pb, start, rows = parts.pb, parts.start, []
    for body, link in parts.handles:
        if body < 0:                                         # it only holds springs
            rows.append(((0.0,) * 3, (0.0, 0.0, 0.0, 1.0), (0.0,) * 3, (0.0,) * 3))
        elif link < 0:
            rows.append((*pb.getBasePositionAndOrientation(body), *pb.getBaseVelocity(body)))
        else:
            seen = pb.getLinkState(body, link, 1, 1)
            rows.append((*seen[:2], *seen[6:8]))
    x, q, v, omega = (np.array(column) for column in zip(*rows))
    now = parts.space.back(x, np.roll(q, 1, axis=1), v, omega)
    for k, body in enumerate(parts.model.bodies):
        if not can_move(body):
            now.x[k], now.q[k] = start.x[k], start.q[k]
    return now


def step_of(parts, advance, dt):
    """Return the step: the engine's own where no load and no spring acts."""
    model, clock = parts.model, [0]
    links = any(link >= 0 for _, link in parts.handles)
    forces = None if links else forces_of(model, springs=True)
    if model.d == 3 and forces and any(of != "t" for _, of, *_ in forces.values()):
        forces = None
    if not (model.loads or model.springs):
        return advance
    pull = None if links else net_of(model)
    acts = ([acting(parts, k, *force) for k, force in forces.items()] if forces else
            [acting_net(parts, pull)] if pull else [lambda t: push(parts, t)])

    def step():
        t = clock[0] * dt
        clock[0] += 1
        for act in acts:
            act(t)
        advance()
    return step


def acting(parts, k, F, of, b):
    """Return the function of t that applies a force of floats to body k in the next step."""
    pb, (body, link) = parts.pb, parts.handles[k]
    place, speed, apply, frame = (pb.getBasePositionAndOrientation, pb.getBaseVelocity, pb.applyExternalForce,
                                  pb.WORLD_FRAME)
    if not parts.space.flat:                                 # a force of the time
        return lambda t: apply(body, link, F(t), place(body)[0], frame)

    centre = lambda: place(body)[0]
    if stays_upright(parts, k):                              # its own frame is parallel to the world's
        centre, frame = lambda: NOWHERE, pb.LINK_FRAME

    def of_time(t):
        along, up = F(t)
        apply(body, link, (along, 0.0, up), centre(), frame)

    def of_place(t):
        here = place(body)[0]
        along, up = F((here[0], here[2]))
        apply(body, link, (along, 0.0, up), here, pb.WORLD_FRAME)

    def of_velocity(t):
        v = speed(body)[0]
        along, up = F((v[0], v[2]))
        apply(body, link, (along, 0.0, up), centre(), frame)

    def of_both(t):
        here, v = place(body)[0], speed(body)[0]
        along, up = F((here[0], here[2]), (v[0], v[2]))
        apply(body, link, (along, 0.0, up), here, pb.WORLD_FRAME)

    fixed = None if b is None or can_move(parts.model.bodies[b]) else parts.space.point(parts.start.x[b])

    def of_other(t):
        here, there = place(body)[0], place(parts.handles[b][0])[0] if fixed is None else fixed
        along, up = F((there[0] - here[0], there[2] - here[2]))
        apply(body, link, (along, 0.0, up), here, pb.WORLD_FRAME)
    return {"t": of_time, "x": of_place, "v": of_velocity, "xv": of_both, "r": of_other}[of]


def stays_upright(parts, k):
    """Return whether body k of a planar Model never turns, so that a force in its own frame is one in the world's."""
    return parts.space.flat and not can_turn(parts.model.bodies[k]) and not parts.start.q[k]


def acting_net(parts, pull):
    """Return the function of t that applies the forces of a net of springs in the next step."""
    pb, space = parts.pb, parts.space
    free = [(k, parts.handles[k][0]) for k, body in enumerate(parts.model.bodies) if can_move(body)]
    place, speed, apply = pb.getBasePositionAndOrientation, pb.getBaseVelocity, pb.applyExternalForce
    upright = all(stays_upright(parts, k) for k, _ in free)
    x, v = (np.array([space.point(row) for row in rows]) for rows in (parts.start.x, parts.start.v))

    def act(t):
        for k, body in free:
            x[k], v[k] = place(body)[0], speed(body)[0]
        F = pull(x, v).tolist()
        for k, body in free:
            if upright:
                apply(body, -1, F[k], NOWHERE, pb.LINK_FRAME)
            else:
                apply(body, -1, F[k], x[k].tolist(), pb.WORLD_FRAME)
    return act


def push(parts, t):
    """Apply springs and loads at time t [s] during the next step."""
    pb, space, now = parts.pb, parts.space, state(parts)
    F, tau = loads_at(parts.model, t, now)
    for k, (body, link) in enumerate(parts.handles):
        if can_move(parts.model.bodies[k]):
            pb.applyExternalForce(body, link, space.point(F[k]).tolist(), space.point(now.x[k]).tolist(),
                                  pb.WORLD_FRAME)
            if np.any(tau[k]):
                pb.applyExternalTorque(body, link, space.turning(tau[k]).tolist(), pb.WORLD_FRAME)


def pushes(parts):
    """Return the contact forces, one for each point.

    The engine reports no forces of joints in maximal coordinates.  In reduced ones its joint reaction forces are not
    those of the constraint: two rods that swing gave 17 N where MuJoCo and Box2D have 12 N.
    """
    number, found = {handle: k for k, handle in enumerate(parts.handles)}, []
    for c in parts.pb.getContactPoints() or ():
        if c[8] <= 0.0 or c[9] > 0.0:
            F = c[9] * np.array(c[7]) + c[10] * np.array(c[11]) + c[12] * np.array(c[13])
            found.append(Push(number[c[1], c[3]], number[c[2], c[4]], parts.space.push(F)))
    return found
