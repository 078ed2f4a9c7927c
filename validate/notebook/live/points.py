"""Live scenes of points: a net of springs (lesson 2), links that are projected (lesson 8), an arm (lesson 11)."""

from functools import partial
from typing import NamedTuple

import numpy as np

from solutions.checks import check_shape, finite_array, finite_number, positive_number, whole_number

from ...subject.loading import part
from .canvas import arm_drawn, network_drawn
from .hand import point_force, pulled_point
from .running import Running, Seen, check_found

FASTEST = 4.0                # of a fixed point that the hand moves [m/s]
FIRST_BEND = 0.4             # of every joint of an arm at the start [rad]
FIRST_TARGET = 0.35, 0.6     # where the target is at the start, over the reach of the arm [-]
ALONE = "mass_spring_damper_step",           # steps that take no acceleration
NETWORKS = {                 # {record of a network: (its lesson, the step without a choice)}
    "SpringNetwork": ("springs", "mass_spring_damper_step"),
    "ConstraintNetwork": ("pbd", "pbd_step"),
}


class NetworkTuning(NamedTuple):
    """What can be changed while a net or a rope moves."""
    g: float                 # [m/s²], downwards
    dt: float                # [s]
    sweeps: int              # per step; of links only
    k: float                 # factor on the stiffness of every spring [-]; of springs only


class ArmTuning(NamedTuple):
    """What can be changed while an arm follows the pointer."""
    damping: float           # λ [m]
    gain: float              # α [1/m²]
    iterations: int          # of the method per step
    dt: float = 1.0 / 60.0   # [s]: one step per picture


class Moving(NamedTuple):
    """The state of a network."""
    x: np.ndarray            # (n, 2) [m]
    v: np.ndarray            # (n, 2) [m/s]


class Reach(NamedTuple):
    """The state of an arm."""
    theta: np.ndarray        # (n,) [rad]
    target: np.ndarray       # (2,) [m]


# ---------------------------------------------------------------------------------------------- networks

class Network(Running):
    """Points that the learner's springs or projections hold together.  The hand pulls a point, or moves a fixed one.

    In a net of springs the hand is the learner's 2.14.
    """

    def __init__(self, network, x, folder, method="", dt=1.0 / 120.0):
        self.lesson, usual = NETWORKS[type(network).__name__]
        self.method, self.network = method or usual, network
        x = finite_array("a position of the network [m]", x)
        check_shape("the positions of a live network", x, (network.inv_mass.size, 2))
        gravity = -float(network.gravity[1])
        super().__init__(folder, checked_network(NetworkTuning(gravity, dt, getattr(network, "sweeps", 1), 1.0)))
        self.moves, self.first = [True] * len(x), Moving(x, np.zeros_like(x))
        self.free = network.inv_mass > 0.0
        self.mass = np.divide(1.0, network.inv_mass, out=np.zeros(len(x)), where=self.free)
        self.now_network = self.tuned()
        self.reset()

    def load_code(self):
        """Take the step of the learner's lesson, and the law that it is given."""
        module = self.code.load(self.lesson)
        step = part(module, self.method)
        law = module.spring_network_acceleration if self.lesson == "springs" else falling
        self.one_step = step if self.method in ALONE else partial(step, law)
        self.hand = self.or_given(module.hand_force) if self.lesson == "springs" else point_force

    def or_given(self, force):
        """Return the learner's force of the hand; the given one stands in for it while it is not written."""
        def of_the_hand(x, *settings):
            try:
                found = force(x, *settings)
            except NotImplementedError:
                return point_force(x, *settings)
            check_found("the force of the hand: component", found, x, self.t)
            return found
        return of_the_hand

    def set(self, **changes):
        """Change the tuning; the points stay where they are."""
        before = self.energy()
        self.tuning = checked_network(self.tuning._replace(**changes))
        self.now_network = self.tuned()
        self.given += self.energy() - before

    def tuned(self):
        """Return the network with the settings of now."""
        changes = {"gravity": np.array((float(self.network.gravity[0]), -self.tuning.g))}
        if self.lesson == "springs":
            changes["k"] = self.network.k * self.tuning.k
        else:
            changes["sweeps"] = self.tuning.sweeps
        return self.network._replace(**changes)

    def advance(self):
        """Advance the points by dt; return (state, work of the hand and of the wind [J])."""
        v, work = self._with_hand()
        x = self.state.x
        x_new, v_new = self.one_step(self.t, x.copy(), v.copy(), self.tuning.dt, self.now_network)
        for name, found in (("x", x_new), ("v", v_new)):
            check_found(f"{name} of point", found, x, self.t)
        after = Moving(np.array(x_new, float), np.array(v_new, float))
        if (grip := self.grip) is not None and not self.free[grip.body]:
            work = self.energy_of(after) - self.energy_of(self.state)  # nothing else tells the work on a fixed point
        elif self.lesson == "springs":
            work += float(np.sum((after.x - x)[self.free] @ self.network.wind))
        return after, work

    def _with_hand(self):
        """Return (velocities after the hand has acted for dt, its work)."""
        v, work = self.state.v.copy(), 0.0
        v[~self.free] = 0.0
        if (grip := self.grip) is not None:
            k, target = grip.body, np.array(grip.target)
            if self.free[k]:
                v[k], work = pulled_point(target, self.tuning.dt, self.state.x[k], v[k], self.mass[k], self.mass.sum(),
                                          self.hand)
            else:
                v[k] = (target - self.state.x[k]) / self.tuning.dt
                v[k] *= min(1.0, FASTEST / max(np.hypot(*v[k]), 1e-9))
        return v, work

    def now(self):
        """Return where the points are."""
        return Seen(self.state.x, np.zeros(len(self.state.x)))

    def energy(self):
        """Return the energy now [J]."""
        return self.energy_of(self.state)

    def energy_of(self, state):
        """Return the energy of the points that can move, and of all springs [J]."""
        kinetic = 0.5 * self.mass @ np.sum(state.v**2, axis=1)
        height = -self.mass @ (state.x @ self.now_network.gravity)
        springs = 0.5 * self.now_network.k @ self.stretches(state.x) ** 2 if self.lesson == "springs" else 0.0
        return float(kinetic + height + springs)

    def stretches(self, x):
        """Return by how much each link is longer than at rest (s,) [m]."""
        apart = x[self.network.i] - x[self.network.j]
        return np.hypot(apart[:, 0], apart[:, 1]) - self.network.rest

    def overlap(self):
        """Return the largest error of the length of a link [m]."""
        return float(np.max(np.abs(self.stretches(self.state.x)), initial=0.0))

    def drawn(self):
        """Return what the canvas has to know of the points and of the settings."""
        return network_drawn(self.first.x, self.network, self.free, self.tuning, self.lesson)

    def pictures(self):
        """Return (seconds, links, {"mine": [(n, 2), …]}) of what is kept, for a film."""
        links = list(zip(self.network.i.tolist(), self.network.j.tolist(), strict=True))
        return self.past[-1].t - self.past[0].t, links, {"mine": [one.state.x for one in self.past]}


def falling(t, x, v, network):
    """Return the acceleration (n, 2) of gravity for every point that can move [m/s²]."""
    return (network.inv_mass > 0.0)[:, None] * network.gravity


def checked_network(tuning):
    """Return the tuning with floats.  Raises BadInput for what cannot be."""
    g, dt, sweeps, k = tuning
    return NetworkTuning(finite_number("gravity g [m/s²]", g), positive_number("dt [s]", dt),
                         whole_number("number of sweeps", sweeps, 1), positive_number("factor on the stiffness [-]", k))


# ---------------------------------------------------------------------------------------------- arms

class Arm(Running):
    """An arm in the plane whose end follows the pointer by the learner's method."""

    lesson = "kinematics"

    def __init__(self, arm, theta, folder, method="", iterations=1):
        theta = np.full(arm.lengths.size, FIRST_BEND) if theta is None else finite_array("an angle of the arm", theta)
        check_shape("the angles of a live arm", theta, arm.lengths.shape)
        super().__init__(folder, checked_arm(ArmTuning(arm.damping, arm.gain, iterations)))
        self.arm, self.method, self.reach = arm, method or "damped_step", float(np.sum(arm.lengths))
        self.moves = [False] * (theta.size + 1) + [True]
        self.first = Reach(theta, self.reach * np.array(FIRST_TARGET))
        self.reset()

    def load_code(self):
        """Take the method and the task of the learner's lesson."""
        module = self.code.load(self.lesson)
        self.one_step, self.task = part(module, self.method), module.reach_2d

    def set(self, **changes):
        """Change the tuning; the arm stays as it is."""
        self.tuning = checked_arm(self.tuning._replace(**changes))

    def advance(self):
        """Let the arm follow the pointer by some iterations; return (state, 0)."""
        theta, target = self.state
        if (grip := self.grip) is not None:
            target = np.array(grip.target)
        arm = self.arm._replace(damping=self.tuning.damping, gain=self.tuning.gain)
        for _ in range(self.tuning.iterations):
            found = self.one_step(self.task, theta.copy(), target.copy(), arm)
            check_found("angle", found, theta, self.t)
            theta = np.array(found, float)
        return Reach(theta, target), 0.0

    def joints(self, theta):
        """Return x (n + 1, 2) of the joints and the end: not by the learner's function, so a mistake in it is seen."""
        z = np.append(0.0, np.cumsum(self.arm.lengths * np.exp(1j * np.cumsum(theta))))
        return np.column_stack((z.real, z.imag))

    def now(self):
        """Return where the joints, the end and the target are."""
        return Seen(np.vstack((self.joints(self.state.theta), self.state.target)), np.zeros(self.state.theta.size + 2))

    def end(self):
        """Return the place (2,) of the end of the arm [m]."""
        return self.joints(self.state.theta)[-1]

    def held_place(self, _):
        """Return the place (2,) that the hand pulls [m]: the hand may hold any part, and the end follows."""
        return self.end()

    def energy(self):
        """Return how far the end is from the target [m]."""
        return float(np.hypot(*(self.end() - self.state.target)))

    def expected(self):
        """Return how far the end of this arm must at least be from the target [m]."""
        far, hole = np.hypot(*self.state.target), 2.0 * np.max(self.arm.lengths) - self.reach
        return float(max(0.0, far - self.reach, hole - far))

    def drawn(self):
        """Return what the canvas has to know of the arm and of the settings."""
        return arm_drawn(self.arm.lengths.size, self.reach, self.tuning)

    def pictures(self):
        """Return (seconds, links, {"mine": [(n + 5, 2), …]}) of what is kept: the arm, and the target as a cross."""
        n = self.arm.lengths.size
        cross = 0.03 * self.reach * np.array([(-1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (1.0, -1.0)])
        frames = [np.vstack((self.joints(one.state.theta), one.state.target + cross)) for one in self.past]
        links = [*((k, k + 1) for k in range(n)), (n + 1, n + 2), (n + 3, n + 4)]
        return self.past[-1].t - self.past[0].t, links, {"mine": frames}


def checked_arm(tuning):
    """Return the tuning with floats.  Raises BadInput for what cannot be."""
    damping, gain, iterations, dt = tuning
    return ArmTuning(positive_number("damping λ [m]", damping), positive_number("gain α [1/m²]", gain),
                     whole_number("number of iterations", iterations, 1), positive_number("dt [s]", dt))
