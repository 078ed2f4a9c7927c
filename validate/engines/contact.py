"""Piles of bodies between walls for the lesson and for both engines: the same bodies, places, friction and steps."""

from typing import NamedTuple

import numpy as np

from solutions.support.scenes import make_pile, make_pile_2d

from . import quiet_import, watched
from .bullet import Client
from .switches import made

G, DT, MU = 9.81, 1.0 / 240.0, 0.5


class Kind(NamedTuple):
    """A kind of pile and the settings of its solver."""
    d: int
    shape: str               # round or box
    across: int              # bodies side by side
    pitch: float             # of the lattice from which they fall [m]
    substeps: int
    hertz: float


KINDS = {
    "discs": Kind(2, "round", 30, 0.25, 3, 240.0),
    "boxes": Kind(2, "box", 30, 0.35, 3, 240.0),
    "spheres": Kind(3, "round", 10, 0.25, 2, 150.0),
    "bricks": Kind(3, "box", 10, 0.42, 4, 120.0),
}


def fallen(kind, n):
    """Return (PileState, Pile) of n bodies on a lattice between walls.

    Sizes vary by a tenth for round bodies, and by a fifth for boxes.
    """
    d, rng, k = kind.d, np.random.default_rng(1), np.arange(n)
    if kind.shape == "round":
        half = np.repeat(rng.uniform(0.09, 0.11, (n, 1)), d, axis=1)
    else:
        half = rng.uniform(0.08, 0.12, (n, d))
    places = [k // kind.across**c % kind.across for c in range(d - 1)] + [k // kind.across ** (d - 1)]
    x, wall = (np.stack(places, axis=1) + 0.5) * kind.pitch, 0.5 * kind.across * kind.pitch + 0.02
    x[:, :-1] -= 0.5 * kind.across * kind.pitch
    x += rng.uniform(-0.01, 0.01, x.shape)
    floor = np.append(np.eye(d)[-1], 0.0)
    planes = np.stack([floor, *(np.append(sign * np.eye(d)[c], wall) for c in range(d - 1) for sign in (1.0, -1.0))])
    volume = {(2, "round"): np.pi, (2, "box"): 4.0, (3, "round"): 4.0 / 3.0 * np.pi, (3, "box"): 8.0}[d, kind.shape]
    m, squares = 1000.0 * volume * np.prod(half, axis=1), half**2
    solver = (MU, kind.substeps, kind.hertz, 10.0, 0.008)
    if d == 2:
        inertia = m * (0.5 * squares[:, 0] if kind.shape == "round" else np.sum(squares, axis=1) / 3.0)
        angles = rng.uniform(-np.pi, np.pi, n) if kind.shape == "box" else np.zeros(n)
        return make_pile_2d(x, angles, m, inertia, half, planes, (0.0, -G), *solver)
    inertia = m[:, None] * (0.4 * squares if kind.shape == "round"
                            else (np.sum(squares, axis=1)[:, None] - squares) / 3.0)
    q = rng.normal(size=(n, 4)) if kind.shape == "box" else np.tile([1.0, 0.0, 0.0, 0.0], (n, 1))
    return make_pile(x, q / np.linalg.norm(q, axis=1)[:, None], m, inertia, half, planes, (0.0, 0.0, -G), *solver)


class Judged(NamedTuple):
    """The arguments of natural_residual for a pile after a step."""
    bodies: tuple            # (x, v, ω, inverse masses, inverse moments) of bodies and planes
    contacts: tuple          # (a, b, n, p, gap)
    J: np.ndarray            # (m, d) [N s]


def inverse_tensors(q, inv_body):
    """Return I⁻¹ (n + p, 3, 3) in the world, from quaternions (n + p, 4), w first.

    inv_body: inverse moments (n + p, 3).
    """
    w, xyz = q[:, 0], q[:, 1:]
    cross = np.zeros((len(q), 3, 3))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        cross[:, i, j], cross[:, j, i] = -xyz[:, k], xyz[:, k]
    R = np.eye(3) + 2.0 * (w[:, None, None] * cross + cross @ cross)
    return (R * inv_body[:, None, :]) @ R.transpose(0, 2, 1)


def at_rest(moving, planes):
    """Return the rows of the moving bodies, followed by a row of zeros for each plane."""
    return np.concatenate((moving, np.zeros((planes, *moving.shape[1:]))))


class PymunkPile:
    """The same bodies in pymunk.  Friction coefficients multiply there."""

    def __init__(self, kind, state, pile, iterations, slop=1e-3):
        import pymunk
        self.space, self.bodies = made(pymunk.Space()), []
        self.space.gravity, self.space.iterations, self.space.collision_slop = (0.0, -G), iterations, slop
        wall = pile.planes[1, 2]
        for p, q in (((-wall - 1.0, -1.0), (wall + 1.0, -1.0)), ((-wall - 1.0, -1.0), (-wall - 1.0, 60.0)),
                     ((wall + 1.0, -1.0), (wall + 1.0, 60.0))):
            self.space.add(pymunk.Segment(self.space.static_body, p, q, 1.0))
        for k, (half_x, half_y) in enumerate(pile.half):
            body = pymunk.Body(1.0 / pile.inv_mass[k], 1.0 / pile.inv_inertia[k])
            body.position, body.angle = tuple(state.x[k]), state.q[k]
            corners = [(half_x, half_y), (-half_x, half_y), (-half_x, -half_y), (half_x, -half_y)]
            self.space.add(body, pymunk.Circle(body, half_x) if kind.shape == "round" else pymunk.Poly(body, corners))
            self.bodies.append(body)
        for shape in self.space.shapes:
            shape.friction = np.sqrt(MU)
        self.planes, self.pile = len(pile.planes), pile

    def run(self, steps):
        for _ in range(steps):
            self.space.step(DT)

    def watch(self):
        """Return the same world, whose steps can be watched."""
        return watched.Pymunk(self.space, DT)

    def judged(self):
        """Return the Judged record of discs, whose contacts have one point each.

        Boxes are not judged: pymunk reports sums.

        The normal of a contact points from its first shape to the other; its impulse is that on the first.
        """
        number = {body: k for k, body in enumerate(self.bodies)}
        rows = {}

        def add(arbiter):
            a, b = (number.get(shape.body, len(self.bodies)) for shape in arbiter.shapes)
            points, impulse = arbiter.contact_point_set, np.array(arbiter.total_impulse)
            middle = 0.5 * (np.array(points.points[0].point_a) + np.array(points.points[0].point_b))
            key = (min(a, b), max(a, b), tuple(middle.round(6)) if len(self.bodies) in (a, b) else ())
            rows[key] = (a, b, -np.array(points.normal), middle, points.points[0].distance, impulse)
        for body in self.bodies:
            body.each_arbiter(add)
        a, b, n, p, gap, J = (np.array(column) for column in zip(*rows.values()))
        v, omega = (at_rest(part, self.planes) for part in self.velocities())
        bodies = (self.places()[0], v, omega, self.pile.inv_mass, self.pile.inv_inertia)
        return Judged(bodies, (a, b, n, p, gap), J)

    def places(self):
        """Return (x (n + p, 2), angles (n + p,)) of bodies and planes."""
        still = np.zeros((self.planes, 2))
        places = [tuple(body.position) for body in self.bodies]
        angles = [body.angle for body in self.bodies]
        return np.vstack((places, still)), np.append(angles, still[:, 0])

    def velocities(self):
        """Return (v (n, 2), angular velocities (n,))."""
        return (np.array([tuple(body.velocity) for body in self.bodies]),
                np.array([body.angular_velocity for body in self.bodies]))

    def wall_force(self):
        """Return the sum (2,) [N] of the forces of floor and walls on the bodies."""
        force = np.zeros(2)

        def add(arbiter):
            still = [shape.body is self.space.static_body for shape in arbiter.shapes]
            if any(still):                                               # the impulse is that on the first shape
                force[:] += np.array(arbiter.total_impulse) / DT * (-1.0 if still[0] else 1.0)
        for body in self.bodies:
            body.each_arbiter(add)
        return force

    def close(self):
        pass


class BulletPile:
    """The same bodies in pybullet, with maximal coordinates."""

    def __init__(self, kind, state, pile, iterations, residual=0.0):
        self.p = quiet_import("pybullet")
        self.c = self.p.connect(self.p.DIRECT)
        self.p.setGravity(0.0, 0.0, -G, physicsClientId=self.c)
        self.p.setPhysicsEngineParameter(fixedTimeStep=DT, numSolverIterations=iterations,
                                         solverResidualThreshold=residual, contactBreakingThreshold=0.02,
                                         physicsClientId=self.c)
        wall, thick, self.walls = pile.planes[1, 3], 1.0, []
        for axis, sign in ((2, -1.0), (0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0)):
            at, half = np.zeros(3), np.full(3, 60.0)
            at[axis], half[axis] = sign * (thick if axis == 2 else wall + thick), thick
            self.walls.append(self.add(self.p.GEOM_BOX, {"halfExtents": list(half)}, 0.0, at, (0.0, 0.0, 0.0, 1.0)))
        self.bodies = []
        for k, half in enumerate(pile.half):
            w, *xyz = state.q[k]
            ball, brick = (self.p.GEOM_SPHERE, {"radius": half[0]}), (self.p.GEOM_BOX, {"halfExtents": list(half)})
            shape = ball if kind.shape == "round" else brick
            self.bodies.append(self.add(*shape, 1.0 / pile.inv_mass[k], state.x[k], (*xyz, w)))
        self.planes, self.pile = len(pile.planes), pile

    def judged(self):
        """Return the Judged record of all contact points."""
        number = {body: k for k, body in enumerate(self.bodies)}
        points = [c for c in self.p.getContactPoints(physicsClientId=self.c) if c[9] > 0.0 or c[8] <= 0.0]
        a, b = (np.array([number.get(c[side], len(self.bodies)) for c in points]) for side in (1, 2))
        n, gap = np.array([c[7] for c in points]), np.array([c[8] for c in points])
        p = 0.5 * np.array([np.add(c[5], c[6]) for c in points])
        J = DT * np.array([c[9] * np.array(c[7]) + c[10] * np.array(c[11]) + c[12] * np.array(c[13]) for c in points])
        x, q = self.places()
        v, omega = (at_rest(part, self.planes) for part in self.velocities())
        inv_inertia = inverse_tensors(q, self.pile.inv_inertia)
        return Judged((x, v, omega, self.pile.inv_mass, inv_inertia), (a, b, n, p, gap), J)

    def add(self, geometry, sizes, mass, x, q):
        shape = self.p.createCollisionShape(geometry, physicsClientId=self.c, **sizes)
        body = self.p.createMultiBody(mass, shape, -1, list(x), list(q), useMaximalCoordinates=1,
                                      physicsClientId=self.c)
        self.p.changeDynamics(body, -1, lateralFriction=np.sqrt(MU), restitution=0.0, linearDamping=0.0,
                              angularDamping=0.0, physicsClientId=self.c)
        return body

    def run(self, steps):
        for _ in range(steps):
            self.p.stepSimulation(physicsClientId=self.c)

    def watch(self):
        """Return the same world, whose steps can be watched."""
        return watched.Bullet(Client(self.p, self.c), DT, (0.0, 0.0, -G))

    def places(self):
        """Return (x (n + p, 3), quaternions (n + p, 4), w first) of bodies and planes."""
        both = [self.p.getBasePositionAndOrientation(body, physicsClientId=self.c) for body in self.bodies]
        x, q = (np.array([one[k] for one in both]) for k in (0, 1))
        upright = np.tile([1.0, 0.0, 0.0, 0.0], (self.planes, 1))
        return np.vstack((x, np.zeros((self.planes, 3)))), np.vstack((q[:, [3, 0, 1, 2]], upright))

    def velocities(self):
        """Return (v (n, 3), angular velocities (n, 3))."""
        both = [self.p.getBaseVelocity(body, physicsClientId=self.c) for body in self.bodies]
        return np.array([v for v, _ in both]), np.array([omega for _, omega in both])

    def wall_force(self):
        """Return the sum (3,) [N] of the forces of floor and walls on the bodies.

        Walls were made first, so they are body A.
        """
        force = np.zeros(3)
        for wall in self.walls:
            for c in self.p.getContactPoints(bodyA=wall, physicsClientId=self.c):
                sign = 1.0 if c[1] == wall else -1.0             # the normal points to A, friction acts on A
                on_a = c[9] * np.array(c[7]) + c[10] * np.array(c[11]) + c[12] * np.array(c[13])
                force -= sign * on_a
        return force

    def close(self):
        self.p.disconnect(physicsClientId=self.c)
