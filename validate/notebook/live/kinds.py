"""Live scenes of a single function: a ball on a spring (lesson 1), two shapes (lesson 6), a throw (lesson 12)."""

from typing import NamedTuple

import numpy as np

from solutions.checks import Diverged

from ...reference import collisions as nearest
from ...reference import sensitivities as flights
from .canvas import knob, of_dt, point
from .hand import pulled_point
from .touched import Touched, disc, outline, placed, seen_at

FASTEST = 4.0                # of what follows the pointer [m/s]


def towards(target, x, most):
    """Return the place (2,) on the way from x to the target, at most so far from x [m]."""
    way = target - x
    return x + way * min(1.0, most / max(np.hypot(*way), 1e-9))


# ---------------------------------------------------------------------------------------------- lesson 1

class Flying(NamedTuple):
    """The state of a ball."""
    x: np.ndarray            # (2,) [m]
    v: np.ndarray            # (2,) [m/s]


class BallOnSpring(Touched):
    """A ball on a spring without a length, by a step of lesson 1; the exact motion is beside it."""

    lesson, method, rival, trail, view = "integrators", "euler_step", "the exact motion", 1, (-2.4, 2.4, -1.4, 1.4)
    knobs = (knob("ω", "omega", 1.0, 70.0, 0.5, 3.0, "rad/s"), knob("damping ζ", "zeta", 0.0, 0.9, 0.01, 0.0),
             of_dt(1.0 / 60.0))
    bodies = point(True, False), disc(0.12)
    springs = (1, 0.0, 0.0, -1, 0.0, 0.0),

    def begin(self, start):
        """Return the state at the start (x, v)."""
        return Flying(*map(np.array, start or ((0.8, 0.0), (0.0, 1.8))))

    def moved(self, state):
        """Return (state after dt, work of the hand)."""
        (x, v), work, dt = state, 0.0, self.tuning.dt
        if (grip := self.grip) is not None:
            v, work = pulled_point(np.array(grip.target), dt, x, v, 1.0, 1.0)
        p = self.module.Oscillator(self.tuning.omega, self.tuning.zeta)
        return Flying(*self.function(self.module.oscillator_acceleration, self.t, x.copy(), v.copy(), dt, p)), work

    def exact(self, state):
        """Return the state after dt:  x = e^(−ζωt) (x₀ cos st + (v₀ + ζω x₀)/s sin st),   s = ω √(1 − ζ²)."""
        (x, v), (omega, zeta, dt) = state, self.tuning
        slow, s = zeta * omega, omega * np.sqrt(1.0 - zeta * zeta)
        c, sin = np.exp(-slow * dt) * np.array((np.cos(s * dt), np.sin(s * dt) / s))
        return Flying(c * x + sin * (v + slow * x), c * v - sin * (slow * v + omega**2 * x))

    def seen(self, state):
        """Return where the nail and the ball are."""
        return seen_at((0.0, 0.0), state.x)

    def energy(self):
        """Return the energy of a ball of 1 kg [J]."""
        x, v = self.state
        return float(0.5 * v @ v + 0.5 * self.tuning.omega**2 * x @ x)


# ---------------------------------------------------------------------------------------------- lesson 6

class Apart(NamedTuple):
    """The state of two shapes."""
    x: np.ndarray            # (2,) place of the first [m]
    turn: np.ndarray         # (1,) of the second [rad]
    nearest: np.ndarray      # (2, 2) a point on each [m]


class Hulls(Touched):
    """Two convex shapes, and their nearest points by lesson 6.  One follows the pointer, the other one turns."""

    lesson, method, links, anywhere = "collisions", "gjk", ((2, 3),), 0
    view = -2.4, 2.4, -1.4, 1.4
    knobs = knob("turns by", "rate", -2.0, 2.0, 0.1, 0.4, "rad/s"), of_dt(1.0 / 60.0)
    bodies = (outline([(0.5, -0.2), (0.3, 0.4), (-0.4, 0.3), (-0.5, -0.3)]),
              outline([(0.0, 0.6), (-0.7, -0.1), (-0.3, -0.5), (0.8, -0.4)], moves=False), point(False, False),
              point(False, False))
    measured = "distance by your function", "m", "the true distance:"

    def begin(self, _):
        """Return the state at the start."""
        x = np.array((-1.4, 0.6))
        return Apart(x, np.zeros(1), np.array(nearest.hull_nearest(*self.corners(x, 0.0))))

    def corners(self, x, turn):
        """Return the corners of both shapes."""
        here = self.seen(Apart(x, np.array((turn,)), np.zeros((2, 2))))
        return [placed(np.array(body["points"]), *one) for body, *one in zip(self.bodies[:2], *here)]

    def moved(self, state):
        """Return (state after dt, 0)."""
        dt, x, turn = self.tuning.dt, state.x, state.turn + self.tuning.dt * self.tuning.rate
        if (grip := self.grip) is not None:
            x = towards(np.array(grip.target) - grip.place, x, FASTEST * dt)
        found = self.function(*self.corners(x, turn[0]))
        return Apart(x, turn, np.array((found.p_a, found.p_b), float)), 0.0

    def held_place(self, grip):
        """Return the place (2,) that a Grip holds [m]."""
        return self.state.x + grip.place

    def seen(self, state):
        """Return where the shapes and their nearest points are."""
        return seen_at(state.x, (0.0, 0.0), *state.nearest, turns=(0.0, state.turn[0], 0.0, 0.0))

    def energy(self):
        """Return the distance of the two points [m]."""
        return without_round_off(self.state.nearest)

    def expected(self):
        """Return the true distance of the two shapes [m]."""
        return without_round_off(nearest.hull_nearest(*self.corners(self.state.x, self.state.turn[0])))


def without_round_off(points):
    """Return the distance of two points [m], in nanometres at least."""
    return round(float(np.hypot(*np.subtract(*points))), 9)


# ---------------------------------------------------------------------------------------------- lesson 12

HAND, LEAN, MOMENTS = (0.0, 1.0), np.radians(20.0), 48   # as in notebook 12 [m], [rad]; points of the path
FLOOR, WALL = ((0.0, 1.0), (0.0, 0.0)), ((-np.cos(LEAN), np.sin(LEAN)), (3.0, 0.0))          # normal, a point [m]
MOST_CORRECTIONS, HIT = 10, 1e-9                         # of a search per step, and its tolerance [m]
RADIUS = 0.09                                            # of the target [m]


class Aimed(NamedTuple):
    """The state of a throw."""
    velocity: np.ndarray     # (2,) at the hand [m/s]
    target: np.ndarray       # (2,) [m]
    ball: np.ndarray         # (1,) time since it was thrown [s]


def inside(target):
    """Return the target (2,), or a place near it whose disc touches neither floor nor wall [m]."""
    for n, place in (WALL, FLOOR):
        target = target + max(0.0, RADIUS - (target - place) @ n) * np.array(n)
    return target


class Bucket(Touched):
    """A throw over floor and wall at a target that is moved, by the search of lesson 12."""

    lesson, method, anywhere, view = "sensitivities", "aim", MOMENTS + 1, (-0.6, 3.8, -0.2, 2.4)
    knobs = (knob("restitution e", "e", 0.3, 1.0, 0.01, 0.8), knob("flight", "duration", 0.7, 2.0, 0.05, 1.4, "s"),
             of_dt(1.0 / 60.0))
    bodies = (*(outline([], closed=False, fixed=True, moves=False) for _ in range(MOMENTS)), disc(0.05, moves=False),
              disc(RADIUS))
    links = tuple((k, k + 1) for k in range(MOMENTS - 1))
    planes = tuple((*n, float(np.dot(n, point))) for n, point in (FLOOR, WALL))
    measured = "miss", "m", "miss of the throw before:"

    def begin(self, start):
        """Return the state at the start (velocity, target)."""
        return Aimed(*map(np.array, start or ((4.0, 1.0), (1.5, 0.6))), np.zeros(1))

    def reset(self):
        """Return to the start."""
        self.before = 0.0
        super().reset()

    def moved(self, state):
        """Return (state after dt, 0).  A search that fails begins anew with the throw that would hit without walls."""
        velocity, target, (ball,) = state
        if (grip := self.grip) is not None:
            target = towards(inside(np.array(grip.target)), target, FASTEST * self.tuning.dt)
        self.before = self.miss(velocity, target)
        e = np.array((self.tuning.e, 0.875 * self.tuning.e))
        normals, points = np.array((FLOOR, WALL)).transpose(1, 0, 2)
        module = self.module
        course = module.Course(np.array((0.0, -9.81)), normals, points, e, np.zeros((2, 2)))
        throw = module.Throw(course, np.array(HAND), target, self.tuning.duration)
        try:
            velocity = self.function(module.throw_miss, velocity.copy(), HIT, MOST_CORRECTIONS, throw)[0]
        except (Diverged, np.linalg.LinAlgError):
            velocity = (target - HAND) / throw.duration - 0.5 * throw.duration * course.gravity
        return Aimed(np.array(velocity, float), target, np.array([(ball + self.tuning.dt) % self.tuning.duration])), 0.0

    def flown(self, velocity, t):
        """Return where the ball is after t (2,) [m], by another flight than the learner's."""
        planes = [flights.Plane(np.array(n), np.array(point), e)
                  for (n, point), e in ((FLOOR, self.tuning.e), (WALL, 0.875 * self.tuning.e))]
        return flights.bounced_flight(HAND, velocity, t, np.array((0.0, -9.81)), planes)[0].real

    def miss(self, velocity, target):
        """Return how far a throw is from a target at the end [m]."""
        return float(np.hypot(*(self.flown(velocity, self.tuning.duration) - target)))

    def seen(self, state):
        """Return where the path, the ball and the target are."""
        times = np.linspace(0.0, self.tuning.duration, MOMENTS)
        path = [self.flown(state.velocity, t) for t in times]
        return seen_at(*path, self.flown(state.velocity, state.ball[0]), state.target)

    def energy(self):
        """Return the miss of the throw [m]."""
        return self.miss(self.state.velocity, self.state.target)

    def expected(self):
        """Return the miss of the throw before the last search [m]."""
        return self.before
