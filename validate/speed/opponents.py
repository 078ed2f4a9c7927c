"""Engines for `validate piles` that no scene with a pile has: Box2D 3, Rapier and MuJoCo.

All get the same bodies, places, walls, friction and step, and start from our settled state.  No body may sleep, one
thread works unless more are asked for, and continuous detection is off where the binding has a switch.  An engine is
imported when its pile is made, so this module loads without any of them.  Nothing is built from a Model here: Box2D's
and MuJoCo's adapters in `validate/worlds/` look at every pair of bodies, and a pile may have 100,000.
"""

import numpy as np

from ..engines.contact import DT, MU, G

DENSITY = 1000.0             # [kg/m³], in the plane [kg/m²]
THICK = 1.0                  # half thickness of floor and walls [m]
FAR = 60.0                   # half length of floor and walls [m], longer only where the walls stand further apart
DAMPING, PUSH_OUT = 10.0, 3.0            # Box2D's and Rapier's default damping ratio [-] and speed of pushing out [m/s]
SOFT = 2.02                  # MuJoCo's time constant of contacts in steps: with less than two it is unstable [-]


def slabs(wall, d):
    """Return [(centre, half sizes)] of the floor and of the walls, as boxes whose inner faces are the planes."""
    def slab(axis, sign, distance):
        centre, half = np.zeros(d), np.full(d, max(FAR, wall + THICK))
        centre[axis], half[axis] = sign * (distance + THICK), THICK
        return centre.tolist(), half.tolist()
    return [slab(d - 1, -1.0, 0.0), *(slab(axis, sign, wall) for axis in range(d - 1) for sign in (-1.0, 1.0))]


class Box2DPile:
    """Box2D 3, which computes with 32-bit floats.

    unit: the length [m] of which Box2D's slop is 0.5 %.  It holds for the whole process and can be set once only.
    """

    def __init__(self, kind, state, pile, substeps=4, hertz=None, unit=1.0, threads=1):
        import pyb2d3 as b2
        b2.set_length_units_per_meter(unit)
        pool = {"thread_pool": b2.ThreadPool(threads)} if threads > 1 else {}
        self.world, self.substeps, self.bodies = b2.World(gravity=(0.0, -G), **pool), substeps, []
        self.world.sleeping_enabled = self.world.continuous_enabled = False
        if hertz:
            self.world.set_contact_tuning(hertz, DAMPING, PUSH_OUT)
        shape = b2.shape_def(material=b2.surface_material(friction=MU, restitution=0.0), density=DENSITY)
        ground = self.world.create_static_body(position=(0.0, 0.0))
        for centre, half in slabs(pile.planes[1, 2], 2):
            ground.create_polygon_shape(shape, b2.box(*half, center=tuple(centre)))
        for x, angle, half in zip(state.x.tolist(), state.q.tolist(), pile.half.tolist()):
            body = self.world.create_dynamic_body(position=tuple(x), rotation=b2.make_rot(angle), enable_sleep=False)
            if kind.shape == "round":
                body.create_circle_shape(shape, b2.circle(radius=half[0]))
            else:
                body.create_polygon_shape(shape, b2.box(*half))
            self.bodies.append(body)

    def run(self, steps):
        for _ in range(steps):
            self.world.step(DT, self.substeps)

    def places(self):
        return np.array([tuple(body.position) for body in self.bodies]), np.array([b.angle for b in self.bodies])


class RapierPile:
    """Rapier, which computes with 32-bit floats."""

    def __init__(self, kind, state, pile, iterations=4, hertz=None, slop=None, threads=1):
        import rapier3d as rapier
        self.world, self.handles = rapier.PhysicsWorld(gravity=(0.0, 0.0, -G)), []
        self.world.set_num_threads(threads)
        set_rapier(self.world.integration_parameters, iterations, hertz, slop)
        for centre, half in slabs(pile.planes[1, 3], 3):
            self.add(rapier.RigidBody.fixed().translation(tuple(centre)), rapier.Collider.cuboid(*half))
        for x, q, half in zip(state.x.tolist(), state.q.tolist(), pile.half.tolist()):
            body = rapier.RigidBody.dynamic().translation(tuple(x)).can_sleep(False)
            if kind.shape == "round":
                shape = rapier.Collider.ball(half[0])
            else:
                body, shape = body.rotation(rotation_vector(q)), rapier.Collider.cuboid(*half)
            self.handles.append(self.add(body, shape.density(DENSITY)))

    def add(self, body, shape):
        handle = self.world.add_body(body)
        self.world.add_collider(shape.friction(MU).restitution(0.0), handle)
        return handle

    def run(self, steps):
        for _ in range(steps):
            self.world.step()

    def places(self):
        bodies = [self.world.rigid_bodies[handle] for handle in self.handles]
        x = np.array([(at.x, at.y, at.z) for at in (body.translation for body in bodies)])
        return x, np.array([body.rotation.to_tuple() for body in bodies])[:, [3, 0, 1, 2]]


def set_rapier(settings, iterations, hertz, slop):
    """Change Rapier's settings in place.  Contacts with fixed bodies have a softness of their own."""
    settings.dt, settings.num_solver_iterations = DT, iterations
    if hertz:
        softness = type(settings.contact_softness)(hertz, DAMPING)
        settings.contact_softness = settings.static_contact_softness = softness
    if slop:
        settings.normalized_allowed_linear_error = slop


def rotation_vector(q):
    """Return the axis times the angle (3,) [rad] of a quaternion, w first."""
    w, xyz = q[0], np.array(q[1:])
    sine = np.linalg.norm(xyz)
    return tuple((xyz * (2.0 * np.arctan2(sine, w) / sine if sine else 2.0)).tolist())


class MuJoCoPile:
    """MuJoCo, whose contacts are soft, with its conjugate gradients and the exact cone of friction."""

    def __init__(self, kind, state, pile, iterations=20):
        import mujoco
        model = mujoco.MjModel.from_xml_string(mujoco_scene(kind, state, pile, iterations))
        self.model, self.data, self.step = model, mujoco.MjData(model), mujoco.mj_step

    def run(self, steps):
        for _ in range(steps):
            self.step(self.model, self.data)

    def places(self):
        rows = self.data.qpos.reshape(-1, 7)
        return rows[:, :3].copy(), rows[:, 3:].copy()


def mujoco_scene(kind, state, pile, iterations):
    """Return MuJoCo's description of a pile, in its XML."""
    words = lambda numbers: " ".join(f"{one:.17g}" for one in numbers)
    shape = "sphere" if kind.shape == "round" else "box"
    sizes = pile.half[:, :1] if kind.shape == "round" else pile.half
    bodies = "".join(
        f'<body pos="{words(x)}" quat="{words(q)}"><freejoint/>'
        f'<geom type="{shape}" size="{words(size)}" density="{DENSITY}"/></body>'
        for x, q, size in zip(state.x, state.q, sizes))
    planes = "".join(f'<geom type="plane" pos="{words(-c * np.array(n))}" zaxis="{words(n)}" size="0 0 1"/>'
                     for *n, c in pile.planes)
    return (f'<mujoco><option timestep="{DT}" gravity="0 0 {-G}" solver="CG" iterations="{iterations}" cone="elliptic" '
            f'jacobian="sparse"/><size memory="3G"/><default><geom friction="{MU} 0 0" condim="3" '
            f'solref="{SOFT * DT} 1" solimp="0.95 0.99 0.0005"/></default>'
            f'<worldbody>{planes}{bodies}</worldbody></mujoco>')
