"""MuJoCo.  Joints are coordinates, contacts are soft.  The friction of each pair is given; there is no restitution.

Without contacts a step is Runge–Kutta 4.  With contacts it is the semi-implicit Euler step.  Joints that close loops,
and rods between two points, are soft constraints.
"""

from functools import partial
from typing import NamedTuple

import numpy as np

from solutions.support.model import (
    WORLD,
    BallJoint,
    Distance,
    Drag,
    Hinge,
    State,
    Weld,
    can_move,
    can_turn,
    friction_of,
    loads_at,
    start_of,
    touching_pairs,
)
from solutions.support.shapes import Ball, Box, Capsule, HalfSpace, Polygon, Polyhedron

from ..engines.mujoco import IMPEDANCE, TIME_CONSTANT, module, text
from ..engines.switches import made
from ..reference.orientation import quaternion
from . import Push, World, unsupported
from .derived import (
    OPENS,
    SPINS_ON,
    STICKY,
    Embedding,
    as_numbered,
    bounces,
    carries,
    checked_step,
    cuts_moments,
    forces_of,
    only_holds,
    opens,
    rubs,
    spins_on,
    touches,
    tree,
    with_plain_springs,
)

WIDE = 1e9                   # stands for an infinite moment of inertia [kg m²]
LEAST = 1e-15                # mass [kg] and moment of inertia [kg m²] of what moves: above mjMINVAL
SLIPPERY = 1e-9              # stands for friction 0 [-], which it does not take


class Parts(NamedTuple):
    """A Model, and what its XML is made from."""
    model: object
    start: State
    space: Embedding
    above: dict              # {body: (body above or WORLD, number of a joint or None)}
    loops: list              # numbers of the joints that close loops
    drag: float = 0.0        # [N s/m] that the joints of points damp


def refuses(model):
    """Return why it cannot run a model, or ""."""
    if carries(model):
        return "its bodies without mass do not move"
    if bounces(model):
        return "it has no restitution"
    if spins_on(model):
        return SPINS_ON
    if opens(model):
        return OPENS
    if any(can_move(body) and min(body.m, *np.atleast_1d(body.inertia)) <= LEAST for body in model.bodies):
        return f"its masses and moments must be above {LEAST:g}"
    return (unsupported(model, Ball, Box, Capsule, Polygon, Polyhedron, HalfSpace, Hinge, BallJoint, Weld, Distance)
            or cuts_moments(model, WIDE))


def build(model, dt, integrator=None, time_constant=TIME_CONSTANT, ahead=0.0):
    """Make a World.

    integrator: as in MuJoCo's XML    time_constant: of contacts [s]
    ahead: share of a step by which the first velocities lag, by the engine's own accelerations; ½ makes leapfrog
    """
    dt = checked_step(model, dt, refuses)
    mujoco, whole, model = module(), model, with_plain_springs(model)
    integrator = integrator or ("Euler" if touches(model) else "RK4")
    parts = with_damped_joints(Parts(model, start_of(model), Embedding(model.d), *tree(model)), integrator)
    model = parts.model
    world = made(mujoco.MjModel.from_xml_string(xml_of(parts, dt, integrator, time_constant)))
    data = mujoco.MjData(world)
    first_velocities(parts, world, data)
    if ahead:
        mujoco.mj_forward(world, data)
        data.qvel -= ahead * dt * data.qacc
    order = [0 if only_holds(model, k) else mujoco.mj_name2id(world, mujoco.mjtObj.mjOBJ_BODY, f"b{k}")
             for k in range(len(model.bodies))]

    def state():
        mujoco.mj_kinematics(world, data)
        mujoco.mj_comPos(world, data)
        mujoco.mj_comVel(world, data)
        return seen(parts, world, data, order)

    advance, take = mujoco.mj_step, mujoco.set_mjcb_passive
    load = forced_by(parts, world, data, order) or pushed_by(parts, world, order)

    def loaded(call):                                        # the engine has one callback for all worlds
        take(load)
        try:
            return call()
        finally:
            take(None)
    step, tell = partial(advance, world, data), partial(pushes, parts, world, data, order)
    if model.loads:
        step, tell = partial(loaded, step), partial(loaded, tell)
    return World(step, state, as_numbered(tell, whole), data=data)


def is_free(parts, k):
    """Return whether body k hangs on nothing."""
    return can_move(parts.model.bodies[k]) and parts.above[k][1] is None


def with_damped_joints(parts, integrator):
    """Return the Parts with drag as a damping of joints, without calls from Python, if all free bodies are points.

    Euler's step would take such a damping at its end.
    """
    model = parts.model
    points = all(is_free(parts, k) and not can_turn(body) for k, body in enumerate(model.bodies) if can_move(body))
    if integrator != "RK4" or not points:
        return parts
    drags = [load for load in model.loads if isinstance(load, Drag)]
    loads = tuple(load for load in model.loads if load not in drags)
    return parts._replace(model=model._replace(loads=loads), drag=sum(load.k for load in drags))


# ---------------------------------------------------------------------------------------------- the XML of a Model

def xml_of(parts, dt, integrator, time_constant):
    """Return the XML."""
    model, bodies = parts.model, range(len(parts.model.bodies))
    roots = "".join(element(parts, k) for k in bodies if parts.above[k][0] == WORLD)
    hulls = "".join(f'<mesh name="m{k}" vertex="{text(hull_of(parts, k))}"/>' for k in bodies
                    if isinstance(model.bodies[k].shape, Polygon | Polyhedron))
    condim = 3 if rubs(model) else 1
    pairs = "".join(
        f'<pair geom1="g{i}" geom2="g{k}" condim="{condim}" friction="{text(np.full(2, sliding(model, i, k)))} '
        f'{text((SLIPPERY,) * 3)}" solref="{text(time_constant)} 1" solimp="{IMPEDANCE} {IMPEDANCE} 1 0.5 2"/>'
        for i, k in touching_pairs(model))
    tendons, equal = strings(parts, dt)
    equal += "".join(closing(parts, n, dt) for n in parts.loops)
    return (f'<mujoco><compiler boundmass="0" boundinertia="0" balanceinertia="false"/><option timestep="{text(dt)}" '
            f'gravity="{text(parts.space.point(model.gravity))}" integrator="{integrator}" cone="elliptic" '
            'tolerance="0" iterations="100"><flag autoreset="disable"/></option><default><geom contype="0" '
            f'conaffinity="0"/></default><asset>{hulls}</asset><worldbody>{sites(parts, WORLD)}{roots}</worldbody>'
            f'<contact>{pairs}</contact><equality>{equal}</equality><tendon>{tendons}</tendon></mujoco>')


def sliding(model, i, k):
    """Return the friction of a pair as a number that MuJoCo takes [-]."""
    return min(max(friction_of(model, i, k), SLIPPERY), STICKY)


def hull_of(parts, k):
    """Return the corners (n, 3) of the hull of body k."""
    corners = np.array(parts.model.bodies[k].shape.corners)
    return parts.space.deep(corners) if parts.space.flat else corners


def frame(parts, k):
    """Return R (3, 3) at the start of body k; of the WORLD: the unit matrix."""
    return np.eye(3) if k == WORLD else parts.space.frame(parts.start.q[k])


def own(parts, k, place):
    """Return a place of the world in coordinates of body k in the engine."""
    base = np.zeros(3) if k == WORLD else parts.space.point(parts.start.x[k])
    return frame(parts, k).T @ (parts.space.point(place) - base)


def element(parts, k):
    """Return the XML of body k and of all that hang on it."""
    above, body = parts.above[k][0], parts.model.bodies[k]
    if only_holds(parts.model, k):
        return sites(parts, k)
    place, turn = own(parts, above, parts.start.x[k]), frame(parts, above).T @ frame(parts, k)
    inside = ""
    if can_move(body):
        moments = np.minimum(np.broadcast_to(body.inertia, 3), WIDE)
        inside = f'<inertial mass="{text(body.m)}" pos="0 0 0" diaginertia="{text(moments)}"/>{joints(parts, k)}'
    below = "".join(element(parts, i) for i in parts.above if parts.above[i][0] == k)
    return (f'<body name="b{k}" pos="{text(place)}" quat="{text(quaternion(turn))}">{inside}{geom(parts, k)}'
            f'{sites(parts, k)}{below}</body>')


def slides(parts, k):
    """Return whether a body that hangs on nothing slides along axes: in the plane, or where it cannot turn."""
    return parts.space.flat or not can_turn(parts.model.bodies[k])


def joints(parts, k):
    """Return the XML of the coordinates of body k."""
    n, body, own_axes = parts.above[k][1], parts.model.bodies[k], frame(parts, k).T
    if n is None and not slides(parts, k):
        return f'<freejoint name="j{k}"/>'
    if n is None:
        damping = f'damping="{text(parts.drag)}"' if parts.drag else ""
        ways = "".join(f'<joint name="s{k}{c}" type="slide" axis="{text(own_axes[:, axis])}" {damping}/>'
                       for c, axis in enumerate((0, 2) if parts.space.flat else (0, 1, 2)))
        return ways + (f'<joint name="j{k}" type="hinge" axis="0 -1 0"/>' if can_turn(body) else "")
    joint = parts.model.joints[n]
    if isinstance(joint, Weld):
        return ""
    where = f'name="j{k}" pos="{text(own(parts, k, joint.place))}"'
    if isinstance(joint, BallJoint):
        return f'<joint type="ball" {where}/>'
    axis = (0.0, -1.0, 0.0) if parts.space.flat else own_axes @ joint.axis
    return f'<joint type="hinge" axis="{text(axis)}" {where}/>'


def geom(parts, k):
    """Return the XML of the shape of body k."""
    body, space = parts.model.bodies[k], parts.space
    shape, about = body.shape, {}
    if isinstance(shape, Ball):
        about = {"type": "sphere", "size": text(shape.radius)}
    elif isinstance(shape, Box):
        about = {"type": "box", "size": text(space.half(shape.half))}
    elif isinstance(shape, Capsule):
        ends = np.outer((-shape.half_length, shape.half_length), (1.0, 0.0, 0.0))
        about = {"type": "capsule", "size": text(shape.radius), "fromto": text(ends)}
    elif isinstance(shape, Polygon | Polyhedron):
        about = {"type": "mesh", "mesh": f"m{k}"}
    elif isinstance(shape, HalfSpace):                       # it lies in the world, and is put into its body
        n = space.point(shape.normal)
        place = frame(parts, k).T @ (-shape.offset * n - space.point(parts.start.x[k]))
        about = {"type": "plane", "size": "0 0 1", "zaxis": text(frame(parts, k).T @ n), "pos": text(place)}
    if not about:
        return ""
    return f'<geom name="g{k}" mass="0" ' + " ".join(f'{name}="{value}"' for name, value in about.items()) + "/>"


def lines(model):
    """Return the springs and rods of a model with their names: [(name, record), …]."""
    rods = [(f"r{n}", joint) for n, joint in enumerate(model.joints) if isinstance(joint, Distance)]
    return [(f"l{n}", spring) for n, spring in enumerate(model.springs)] + rods


def site_names(model):
    """Return {(number of a body, place on it): name of the point} of all points where springs and rods end."""
    ends = [end for _, line in lines(model) for end in ((line.a, line.place_a), (line.b, line.place_b))]
    return {end: f"p{n}" for n, end in enumerate(dict.fromkeys(ends))}


def sites(parts, k):
    """Return the XML of the points of body k where springs and rods end; they are the world's where it is no more."""
    base, R = np.zeros(3), np.eye(3)
    if k != WORLD and only_holds(parts.model, k):
        base, R = parts.space.point(parts.start.x[k]), frame(parts, k)
    return "".join(f'<site name="{name}" pos="{text(base + R @ parts.space.point(place))}"/>'
                   for (number, place), name in site_names(parts.model).items() if number == k)


def strings(parts, dt):
    """Return the XML (tendons, constraints) of springs and rods."""
    tendons, equal, names = "", "", site_names(parts.model)
    for name, line in lines(parts.model):
        rod = isinstance(line, Distance)
        more = "" if rod else (f'springlength="{text(line.rest)}" stiffness="{text(line.k)}" '
                               f'damping="{text(line.c)}"')
        tendons += (f'<spatial name="{name}" {more}><site site="{names[line.a, line.place_a]}"/>'
                    f'<site site="{names[line.b, line.place_b]}"/></spatial>')
        equal += f'<tendon tendon1="{name}" solref="{text(2.0 * dt)} 1"/>' if rod else ""
    return tendons, equal


def closing(parts, n, dt):
    """Return the XML of a joint that closes a loop."""
    joint = parts.model.joints[n]
    ends = f'body1="b{joint.a}"' + ("" if joint.b == WORLD else f' body2="b{joint.b}"')
    if isinstance(joint, Weld):
        return f'<weld {ends} anchor="0 0 0" solref="{text(2.0 * dt)} 1"/>'
    shifts = (-0.5, 0.5) if isinstance(joint, Hinge) and parts.model.d == 3 else (0.0,)
    axis = joint.axis if shifts[0] else np.zeros(parts.model.d)
    places = [np.add(joint.place, np.multiply(shift, axis)) for shift in shifts]
    return "".join(f'<connect {ends} anchor="{text(own(parts, joint.a, place))}" solref="{text(2.0 * dt)} 1"/>'
                   for place in places)


# ---------------------------------------------------------------------------------------------- motion

def first_velocities(parts, world, data):
    """Set the first velocities in the coordinates of the joints."""
    start = parts.start
    for k, body in enumerate(parts.model.bodies):
        above, n = parts.above[k]
        if not can_move(body):
            continue
        rate = start.omega[k] - (0.0 if above == WORLD else start.omega[above])
        if n is None and not slides(parts, k):
            at = world.joint(f"j{k}").dofadr[0]
            data.qvel[at:at + 3], data.qvel[at + 3:at + 6] = start.v[k], frame(parts, k).T @ start.omega[k]
        elif n is None:
            for c, speed in enumerate(start.v[k]):
                data.qvel[world.joint(f"s{k}{c}").dofadr[0]] = speed
            if can_turn(body):
                data.qvel[world.joint(f"j{k}").dofadr[0]] = start.omega[k]
        elif isinstance(parts.model.joints[n], BallJoint):
            at = world.joint(f"j{k}").dofadr[0]
            data.qvel[at:at + 3] = frame(parts, k).T @ rate
        elif isinstance(parts.model.joints[n], Hinge):
            axis = 1.0 if parts.space.flat else np.array(parts.model.joints[n].axis)
            data.qvel[world.joint(f"j{k}").dofadr[0]] = np.dot(rate, axis)


def seen(parts, world, data, order):
    """Return the State from quantities that the engine has computed."""
    mujoco, velocity, both = module(), np.zeros(6), []
    for i in order:
        mujoco.mj_objectVelocity(world, data, mujoco.mjtObj.mjOBJ_XBODY, i, velocity, 0)
        both.append(velocity.copy())
    both = np.array(both)
    now = parts.space.back(data.xpos[order], data.xquat[order], both[:, 3:], both[:, :3])
    for k in range(len(order)):
        if only_holds(parts.model, k):
            now.x[k], now.q[k] = parts.start.x[k], parts.start.q[k]
    return now


def forced_by(parts, world, data, order):
    """Return the function that adds forces of floats on free bodies in every stage of a step; None for other loads."""
    forces, rows = forces_of(parts.model, springs=False), []
    if not forces or not all(is_free(parts, k) for k in forces):
        return None
    for k, (F, of, b) in forces.items():
        first = world.joint(f"s{k}0" if slides(parts, k) else f"j{k}").dofadr[0]
        own = slice(first, first + parts.model.d)
        rows.append((F, of, data.xpos[order[k]], data.qvel[own], data.qfrc_passive[own],
                     None if b is None else data.xpos[order[b]]))
    along = slice(None, None, 2 if parts.space.flat else 1)

    def load(world, data):
        for F, of, x, v, push, there in rows:
            found = (F(x.tolist()[along]) if of == "x" else F(v.tolist()) if of == "v" else F(data.time) if of == "t"
                     else F([b - a for a, b in zip(x.tolist()[along], there.tolist()[along])]) if of == "r"
                     else F(x.tolist()[along], v.tolist()))
            for c, share in enumerate(found):                # faster than to add an array
                push[c] += share
    return load


def pushed_by(parts, world, order):
    """Return the function that adds the loads in every stage of a step: a force that is set once per step would make
    Runge–Kutta 4 first order.
    """
    mujoco, loads = module(), parts.model._replace(springs=())

    def load(now, its):
        if now is not world and now._address != world._address:
            return
        F, tau = loads_at(loads, its.time, seen(parts, world, its, order))
        for k, i in enumerate(order):
            if can_move(loads.bodies[k]):
                mujoco.mj_applyFT(world, its, parts.space.point(F[k]), parts.space.turning(tau[k]), its.xpos[i], i,
                                  its.qfrc_passive)
    return load


def pushes(parts, world, data, order):
    """Return the forces at the last positions: one for each contact point, one for each joint of the tree.

    The engine's forces of joints leave out what springs and loads do to the bodies beyond.
    """
    mujoco, found, local = module(), [], np.zeros(6)
    mujoco.mj_forward(world, data)
    mujoco.mj_rnePostConstraint(world, data)
    number = {mujoco.mj_name2id(world, mujoco.mjtObj.mjOBJ_GEOM, f"g{k}"): k for k in range(len(order))}
    for n, contact in enumerate(data.contact):
        mujoco.mj_contactForce(world, data, n, local)
        F = np.array(contact.frame).reshape(3, 3).T @ local[:3]        # on the second
        found.append(Push(number[contact.geom[1]], number[contact.geom[0]], parts.space.push(F)))
    loads, _ = loads_at(parts.model, data.time, seen(parts, world, data, order))
    for k, (_, n) in parts.above.items():
        if n is not None:
            F = parts.space.push(data.cfrc_int[order[k]][3:])          # on body k, from what carries it
            F = F - sum(loads[i] for i in range(len(order)) if k in carriers(parts, i))
            joint = parts.model.joints[n]
            found.append(Push(joint.a, joint.b, F if joint.a == k else -F, n))
    return found


def carriers(parts, k):
    """Yield body k, and the bodies above it in the tree that carry it."""
    while k != WORLD:
        yield k
        k = parts.above[k][0] if k in parts.above else WORLD
