"""Live scenes of a single function: a block (lesson 3), a pendulum (lesson 4) and a brick (lesson 5)."""

from typing import NamedTuple

import numpy as np

from solutions.support.quaternions import rotate, unrotate

from .canvas import knob, of_dt, point
from .hand import implicit_force
from .touched import Touched, disc, placed, rectangle, seen_at

# ---------------------------------------------------------------------------------------------- lesson 3

BAND = 25.0                  # stiffness of the band between block and hand, over the mass [1/s²]


class Sliding(NamedTuple):
    """The state of a block."""
    x: np.ndarray            # (3,) [m]
    v: np.ndarray            # (3,) [m/s]


class Block(Touched):
    """A block on a table, from above, which a rubber band pulls, by lesson 3; where it slides alone is beside it."""

    lesson, method, rival, trail, contacts = "friction", "sliding_step", "the exact motion", 0, True
    view = -2.4, 2.4, -1.3, 1.3
    knobs = (knob("static μ", "mu_s", 0.0, 1.5, 0.01, 0.6), knob("kinetic μ", "mu_k", 0.0, 1.5, 0.01, 0.4),
             knob("tilt", "tilt", 0.0, 60.0, 1.0, 0.0, "°"), of_dt(1.0 / 120.0))
    bodies = rectangle(0.5, 0.3),
    measured = "pull along the table over the load", "", "static μ:"

    def begin(self, start):
        """Return the state at the start (x, v)."""
        return Sliding(*map(np.array, start or ((-1.2, 0.0, 0.0), (3.0, 0.0, 0.0))))

    def reset(self):
        """Return to the start."""
        self.friction = np.zeros(3)
        super().reset()

    def pull(self, t, x, v, p):
        """Return the acceleration (3,) by everything but the table: gravity, and the band to the hand."""
        if (grip := self.grip) is None:
            return self.gravity()
        return self.gravity() + BAND * np.append(np.array(grip.target) - grip.place - x[:2], 0.0)

    def gravity(self):
        """Return g (3,): down the picture where the table is tilted [m/s²]."""
        tilt = np.radians(self.tuning.tilt)
        return 9.81 * np.array((0.0, -np.sin(tilt), -np.cos(tilt)))

    def moved(self, state):
        """Return (state after dt, 0)."""
        (x, v), (mu_s, mu_k, _, dt) = state, self.tuning
        p = self.module.Block(np.array((0.0, 0.0, 1.0)), mu_s, min(mu_k, mu_s), self.gravity(), np.zeros(3), 0.0)
        after = Sliding(*self.function(self.pull, self.t, x.copy(), v.copy(), dt, p))
        self.friction = (after.v - v) / dt - self.pull(self.t, x, v, p)
        return after, 0.0

    def exact(self, state):
        """Return the state after dt on a level table:  |v| falls by μ g dt; NaN on a tilted one."""
        (x, v), dt, loss = state, self.tuning.dt, 9.81 * min(self.tuning.mu_k, self.tuning.mu_s)
        speed = np.linalg.norm(v)
        if self.tuning.tilt:
            return Sliding(x + np.nan, v)
        if speed <= loss * dt:
            return Sliding(x + v * (0.5 * speed / loss if speed else 0.0), 0.0 * v)
        return Sliding(x + dt * v * (1.0 - 0.5 * loss * dt / speed), v * (1.0 - loss * dt / speed))

    def seen(self, state):
        """Return where the block is."""
        return seen_at(state.x[:2])

    def held_place(self, grip):
        """Return the place (2,) that the band of a Grip holds [m]."""
        return self.state.x[:2] + grip.place

    def forces(self):
        """Return the place and the friction of the last step on a block of 1 kg."""
        return np.array([(*self.state.x[:2], *self.friction[:2])])

    def energy(self):
        """Return the pull along the table over the load [-]."""
        a = self.pull(self.t, *self.state, None)
        return float(np.hypot(*a[:2]) / -a[2])

    def expected(self):
        """Return the pull at which a block at rest begins to slide [-]."""
        return self.tuning.mu_s


# ---------------------------------------------------------------------------------------------- lesson 4

ROD, WEIGHT = ((0.06, 1.2, 0.06), 0.3), ((0.24, 0.2, 0.1), 0.7)          # edges [m] and mass [kg] of a box


class Swinging(NamedTuple):
    """The state of a pendulum."""
    q: np.ndarray            # (1,) angle [rad]
    omega: np.ndarray        # (1,) [rad/s]


class Pendulum(Touched):
    """A rod that hangs from a nail, with a weight that can be moved; its moment of inertia is that of lesson 4."""

    lesson, method, rival, view = "inertia_tensors", "combine", "the exact motion", (-1.9, 1.9, -1.4, 0.8)
    knobs = (knob("weight at", "way", 0.0, 1.2, 0.01, 0.9, "m"), knob("g", "g", 0.0, 30.0, 0.1, 9.81, "m/s²"),
             of_dt(1.0 / 120.0))
    bodies = rectangle(*ROD[0][:2]), rectangle(*WEIGHT[0][:2]), point(True, False)

    def begin(self, start):
        """Return the state at the start (angle, angular velocity)."""
        return Swinging(*(np.array([float(one)]) for one in start or (1.0, 0.0)))

    def ways(self):
        """Return how far below the nail the centres of rod and weight are [m]."""
        return np.array((0.5 * ROD[0][1], self.tuning.way))

    def true_moment(self):
        """Return the moment about the nail by hand: Σ m ((a² + b²)/12 + d²)  [kg m²]."""
        parts = zip((ROD, WEIGHT), self.ways(), strict=True)
        return sum(m * ((a * a + b * b) / 12.0 + d * d) for ((a, b, _), m), d in parts)

    def moment(self):
        """Return the moment about the nail by the learner's functions [kg m²]."""
        module, masses = self.module, np.array((ROD[1], WEIGHT[1]))
        boxes = np.array([module.box_inertia(m, np.array(size)) for size, m in (ROD, WEIGHT)])
        whole = self.function(masses, np.array([(0.0, -way, 0.0) for way in self.ways()]), boxes)
        return float(module.parallel_axes(whole.I, whole.m, whole.x)[2, 2])

    def set(self, **changes):
        """Change the tuning.  A weight that moves along the rod leaves the angular momentum as it is."""
        moment = self.true_moment()
        super().set(**changes)
        before = self.energy()
        self.state = self.true = self.state._replace(omega=self.state.omega * moment / self.true_moment())
        self.given += self.energy() - before

    def moved(self, state):
        """Return (state after dt, work of the hand)."""
        moment, dt, work = self.moment(), self.tuning.dt, 0.0
        if (grip := self.grip) is not None:
            r = self.held_place(grip)
            across = np.array((-r[1], r[0]))
            K = np.outer(across, across) / moment
            F = implicit_force(r - grip.target, state.omega[0] * across, K, 1.0, dt)
            kick = dt * float(across @ F) / moment
            work = dt * float(across @ F) * (state.omega[0] + 0.5 * kick)
            state = state._replace(omega=state.omega + kick)
        return self.swung(state, moment), work

    def swung(self, state, moment):
        """Return the state after dt by Verlet's method, for a given moment of inertia."""
        pull, dt = self.tuning.g * self.ways() @ (ROD[1], WEIGHT[1]) / moment, self.tuning.dt
        half = state.omega - 0.5 * dt * pull * np.sin(state.q)
        q = state.q + dt * half
        return Swinging(q, half - 0.5 * dt * pull * np.sin(q))

    def exact(self, state):
        """Return the state after dt with the moment of inertia by hand."""
        return self.swung(state, self.true_moment())

    def held_place(self, grip):
        """Return the place (2,) that a Grip holds [m]."""
        seen = self.now()
        return placed(np.array([grip.place]), seen.x[grip.body], seen.q[grip.body])[0]

    def seen(self, state):
        """Return where rod, weight and nail are."""
        down = np.array((np.sin(state.q[0]), -np.cos(state.q[0])))
        return seen_at(*np.outer(self.ways(), down), (0.0, 0.0), turns=(state.q[0], state.q[0], 0.0))

    def energy(self):
        """Return the energy with the moment by hand [J]; none where the pendulum hangs at rest."""
        heavy = self.tuning.g * self.ways() @ (ROD[1], WEIGHT[1])
        return float(0.5 * self.true_moment() * self.state.omega[0] ** 2 + heavy * (1.0 - np.cos(self.state.q[0])))


# ---------------------------------------------------------------------------------------------- lesson 5

SIDES = np.array((1.0, 0.6, 0.25))                                       # of the brick of notebook 5 [m]
BRICK_MASS = 12.0                                                        # [kg]
CORNERS = 0.5 * SIDES * np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
EDGES = tuple((a, b) for a in range(8) for b in range(a) if np.sum(CORNERS[a] != CORNERS[b]) == 1)
EYE = np.array(((-0.5, 0.866, 0.0), (-0.26, -0.15, 0.954), (0.826, 0.477, 0.3)))     # right, up, towards the reader
LIGHT = 0.1                  # mass that the hand feels over that of the brick: a soft hand, for a step of first order
FAR = 5.0                    # of the eye from the centre [m]
SUBSTEPS = 2                 # of the exact motion per step


class Turning(NamedTuple):
    """The state of a body whose centre is held."""
    q: np.ndarray            # (4,) unit quaternion
    omega: np.ndarray        # (3,) in the world [rad/s]


class Brick(Touched):
    """A brick that is held at its centre and turns by a step of lesson 5; the exact motion is beside it."""

    lesson, method, rival, view = "rotation", "rigid_body_step", "the exact motion", (-1.2, 1.2, -0.8, 0.8)
    knobs = of_dt(1.0 / 120.0),
    links = (*EDGES, (8, 9))
    bodies = (*(disc(0.05) for _ in CORNERS), point(True, False), point(False, False))
    I_body = BRICK_MASS / 12.0 * (np.sum(SIDES**2) - SIDES**2)

    def begin(self, start):
        """Return the state at the start (q, ω): nearly about the middle axis."""
        return Turning(*map(np.array, start or ((1.0, 0.0, 0.0, 0.0), (0.01, 3.0, -0.01))))

    def moved(self, state):
        """Return (state after dt, work of the hand)."""
        (q, omega), dt, none = state, self.tuning.dt, np.zeros(3)
        tau = none if (grip := self.grip) is None else self.torque(state, grip)
        body = self.module.RigidBody(BRICK_MASS, self.I_body.copy())
        found = self.function(lambda *_: (none, tau), self.t, none, q.copy(), none, omega.copy(), dt, body)
        after = Turning(found[1], found[3])
        gained = rotate(q, unrotate(q, tau) / self.I_body)
        return after, dt * float(tau @ (omega + 0.5 * dt * gained))

    def torque(self, state, grip):
        """Return the torque (3,) [N m] of the hand, which pulls a corner across the picture."""
        r, dt = rotate(state.q, CORNERS[grip.body]), self.tuning.dt
        size = FAR / (FAR - EYE[2] @ r)
        across = EYE[:2] @ np.array(((0.0, r[2], -r[1]), (-r[2], 0.0, r[0]), (r[1], -r[0], 0.0)))     # u = across ω
        K = np.array([across @ rotate(state.q, unrotate(state.q, row) / self.I_body) for row in across])
        F = implicit_force(EYE[:2] @ r - np.array(grip.target) / size, across @ state.omega, K,
                           LIGHT * BRICK_MASS, dt)
        return across.T @ F

    def exact(self, state):
        """Return the state after dt without a torque, by short steps of Runge and Kutta."""
        def slope(q, omega):
            w = unrotate(q, omega)
            gained = rotate(q, np.cross(self.I_body * w, w) / self.I_body)
            return 0.5 * np.append(-q[1:] @ omega, q[0] * omega + np.cross(omega, q[1:])), gained
        q, omega = state
        h = self.tuning.dt / SUBSTEPS
        for _ in range(SUBSTEPS):
            slopes = [slope(q, omega)]
            for share in (0.5, 0.5, 1.0):
                slopes.append(slope(q + share * h * slopes[-1][0], omega + share * h * slopes[-1][1]))
            q, omega = (y + h / 6.0 * (k[0] + 2.0 * k[1] + 2.0 * k[2] + k[3])
                        for y, k in zip((q, omega), zip(*slopes, strict=True), strict=True))
            q = q / np.linalg.norm(q)
        return Turning(q, omega)

    def momentum(self, state):
        """Return L (3,) [kg m²/s]."""
        return rotate(state.q, self.I_body * unrotate(state.q, state.omega))

    def seen(self, state):
        """Return where the corners are in the picture, and the centre and the end of a line along L."""
        L = self.momentum(state)
        end = 0.9 * L / max(np.linalg.norm(L), 1e-9)
        places = np.array([*(rotate(state.q, corner) for corner in CORNERS), np.zeros(3), end]) @ EYE.T
        return seen_at(*(places[:, :2] * (FAR / (FAR - places[:, 2:]))))

    def energy(self):
        """Return the energy of rotation [J]."""
        return float(0.5 * self.state.omega @ self.momentum(self.state))
