"""A live scene without its canvas: the learner's loop, pymunk beside it, the hand, the settings and the past.

Nothing here knows of a widget or of the time of day.  Both worlds are built from one Model.
"""

from collections import deque
from typing import NamedTuple

import numpy as np

from solutions.checks import BadInput, check_friction, check_restitution, finite_number, positive_number, whole_number
from solutions.given.rows import Settings, in_order, rows_of
from solutions.support.model import (
    Distance,
    State,
    can_move,
    model_energy,
    own_place,
    picture_of,
    start_of,
    world_place,
)
from solutions.support.scenes import PileState
from solutions.support.shapes import HalfSpace

from ...worlds import chipmunk
from .files import Followed
from .hand import Grip, hand_force, pulled
from .loops import LOOPS

SECONDS_KEPT = 30.0          # of the past
KEPT_PER_SECOND = 30.0       # states of the past
MOST_KEPT = 48_000_000       # bytes of the past, for any number of bodies
AHEAD = 1.0                  # steps by which pymunk's first velocities run ahead: it moves first and pushes then


class Tuning(NamedTuple):
    """What can be changed while a scene runs; None: as in the Model."""
    g: float | None = None       # [m/s²], in the direction that gravity has in the Model
    mu: float | None = None      # friction of every body that can move [-]
    e: float | None = None       # restitution of every body that can move [-]
    dt: float = 1.0 / 120.0      # [s]
    sweeps: int = 20             # of our loop, at most


class Moment(NamedTuple):
    """What is kept of a moment, so that the scene can go on from there."""
    t: float                 # [s]
    state: PileState         # of our loop
    beside: State | None     # of pymunk
    given: float             # energy that came from outside since the start [J]


class Simulation:
    """The two worlds, now."""

    def __init__(self, model, folder, tuning=None, beside=True, lesson="simulator"):
        if model.d == 3:
            raise BadInput("a model for a live scene", "one in space", "take one in the plane")
        self.model, self.code, self.beside, self.lesson = model, Followed(folder), beside, lesson
        self.tuning, (_, self.first, self.row) = checked(tuning or Tuning()), rows_of(model, Settings())
        self.loop, self.trouble, self.grip = None, None, None
        self.now_model = self.tuned()
        self.driven = any(not can_move(body) and (np.any(body.v) or np.any(body.omega)) for body in model.bodies)
        self.reset()

    # ------------------------------------------------------------------------------------------ code and settings

    def follow(self):
        """Take the learner's code as saved last; return whether it is another one than before.

        The state stays.  What loading the code raises is raised by the next step.
        """
        if not self.code.changed():
            return False
        self.loop = self.trouble = None
        try:
            self.simulator, self.exercises = self.code.load("simulator"), self.code.load(self.lesson)
            self._compose()
        except (SystemExit, Exception) as e:
            self.trouble = e
        return True

    def _compose(self):
        composed = self.simulator.compose(self.now_model, self.simulator.Settings(sweeps=self.tuning.sweeps))
        self.loop = LOOPS[self.lesson](composed, self.simulator, self.exercises)
        self.turns = any(part.step is self.simulator.move_and_turn for part in self.loop.parts)

    def set(self, **changes):
        """Change the tuning; the bodies stay where they are."""
        tuning, before = checked(self.tuning._replace(**changes)), self.energy()
        self.tuning, self.engine = tuning, None
        self.now_model = self.tuned()
        self.given += self.energy() - before               # a change of g changes the energy of every height
        if self.loop is not None:
            self._compose()

    def tuned(self):
        """Return the Model with the settings of now."""
        now, size = self.tuning, np.hypot(*self.model.gravity)
        gravity = np.array(self.model.gravity) / size if size > 0.0 else np.array((0.0, -1.0))
        gravity = tuple((gravity * (size if now.g is None else now.g)).tolist())
        changes = {name: value for name, value in (("mu", now.mu), ("e", now.e)) if value is not None}
        bodies = tuple(body._replace(**changes) if can_move(body) else body for body in self.model.bodies)
        return self.model._replace(bodies=bodies, gravity=gravity)

    # ------------------------------------------------------------------------------------------ steps

    def reset(self):
        """Return to the start of the Model."""
        self.t, self.state, self.given, self.grip = 0.0, self.first, 0.0, None
        self.engine, self.engine_state, self.ahead = None, start_of(self.model) if self.beside else None, AHEAD
        self.past, self.bytes = deque(), 0
        self.origin = self.energy()
        self.remember()

    def step(self):
        """Advance both worlds by dt.  Raises what the learner's code raises; then nothing has changed."""
        if self.loop is None:
            self.follow()
        if self.trouble is not None:
            raise self.trouble
        self._forget_the_future()
        state, work = self._with_hand(self.state)
        after = self.simulator.run_parts(self.loop, self.t, state, self.tuning.dt, 1)
        self._check(after)
        if self.driven:
            work += self.simulator.work_of_driven_rows(after, self.tuning.dt, self.loop.p)
        if self.beside:
            self.step_engine()
        self.state, self.t, self.given = after, self.t + self.tuning.dt, self.given + work

    def _with_hand(self, state):
        """Return (state after the hand has acted for dt, its work)."""
        if self.grip is None:
            return state, 0.0
        i, p = self.row[self.grip.body], self.loop.p
        inv_inertia = p.inv_inertia[i] if self.turns else 0.0
        v, omega = state.v.copy(), state.omega.copy()
        v[i], omega[i], work = pulled(self.grip, self.tuning.dt, state.x[i], state.q[i], v[i], omega[i],
                                      p.inv_mass[i], inv_inertia)
        return state._replace(v=v, omega=omega), work

    def _check(self, after):
        for name in State._fields:
            found, before = getattr(after, name, None), getattr(self.state, name)
            if found is None:
                raise TypeError(f"a part of the loop returned {type(after).__name__} in place of a PileState")
            if np.shape(found) != before.shape:
                raise TypeError(f"{name} has the shape {np.shape(found)} after the step and had {before.shape}")
            bad = ~np.isfinite(np.asarray(found, float).reshape(len(found), -1)).all(axis=1)[self.row]
            if bad.any():
                body = int(np.flatnonzero(bad)[0])
                raise ArithmeticError(f"{name} of body {body} is not finite at t = {self.t:.4g} s")

    def step_engine(self):
        """Advance pymunk, which begins anew from its last state where a setting or the time was changed."""
        if self.engine is None:
            model = moved(self.now_model, self.engine_state)
            loads = (*model.loads, self._hand_load)
            self.engine = chipmunk.build(model._replace(loads=loads), self.tuning.dt, ahead=self.ahead)
            self.ahead = 0.0                               # what it has moved itself is ahead already
        self.engine.step()
        self.engine_state = self.engine.state()

    def _hand_load(self, t, x, q, v, omega):
        """Return (F, tau) of the hand on all bodies: the load that pymunk gets."""
        F, tau = np.zeros_like(x), np.zeros_like(omega)
        if self.grip is not None:
            k = self.grip.body
            body = self.model.bodies[k]
            F[k], tau[k] = hand_force(self.grip, self.tuning.dt, x[k], q[k], v[k], omega[k], 1.0 / body.m,
                                      1.0 / body.inertia)
        return F, tau

    def show_beside(self, on):
        """Switch pymunk on, from our state, or off."""
        self.beside, self.engine, self.ahead = on, None, AHEAD
        self.engine_state = self.now() if on else None

    def grab(self, body, place, target):
        """Let the hand hold a place of a body.  Raises BadInput for a body that nothing moves."""
        if not (0 <= body < len(self.model.bodies) and can_move(self.model.bodies[body])):
            raise BadInput("the body to grab", body, "choose one that can move")
        self.grip = Grip(int(body), tuple(map(float, place)), tuple(map(float, target)))

    def held_place(self):
        """Return the place (2,) of the body that the hand holds [m]."""
        state, k = self.now(), self.grip.body
        return world_place(state, k, np.array(self.grip.place))

    # ------------------------------------------------------------------------------------------ what is seen

    def now(self):
        """Return the State of our loop."""
        return in_order(self.row, self.state)

    def energy(self):
        """Return the energy of our loop [J]."""
        return model_energy(self.now_model, self.now())

    def expected(self):
        """Return the energy at the start, with what the hand and driven bodies gave since [J]: ours lies below it."""
        return self.origin + self.given

    def apart(self):
        """Return the largest distance of a body that can move from the same body in pymunk [m]."""
        if self.engine_state is None:
            return 0.0
        ways = [a - b for body, a, b in zip(self.model.bodies, self.now().x, self.engine_state.x) if can_move(body)]
        return float(np.max(np.hypot(*np.array(ways).T))) if ways else 0.0

    def forces(self):
        """Return (m, 4): place [m] and force on body a [N] of each contact of the last step."""
        J = self.state.J
        presses = np.any(J != 0.0, axis=1)
        return np.hstack((self.state.contacts.p[presses], J[presses] / self.tuning.dt))

    def overlap(self):
        """Return the largest overlap in the last step [m]."""
        return max(0.0, -float(np.min(self.state.contacts.gap, initial=0.0)))

    # ------------------------------------------------------------------------------------------ the past

    def remember(self):
        """Keep this moment for the slider and the film."""
        self._forget_the_future()
        if self.past and self.t - self.past[-1].t < 1.0 / KEPT_PER_SECOND - 1e-9:
            return
        self.past.append(Moment(self.t, self.state, self.engine_state, self.given))
        self.bytes += size_of_moment(self.past[-1])
        while len(self.past) > 1 and (self.bytes > MOST_KEPT or self.past[0].t < self.t - SECONDS_KEPT):
            self.bytes -= size_of_moment(self.past.popleft())

    def _forget_the_future(self):
        """Drop the moments after now, of a scene that was set back and goes on."""
        while self.past and self.past[-1].t > self.t + 1e-9:
            self.bytes -= size_of_moment(self.past.pop())

    def seek(self, t):
        """Return to the kept moment that is nearest to t; later ones stay until the next step."""
        found = min(self.past, key=lambda one: abs(one.t - t))
        self.t, self.state, self.engine_state, self.given = found
        self.engine, self.grip = None, None
        if self.beside and self.engine_state is None:
            self.show_beside(True)

    def pictures(self, width=3.0):
        """Return (seconds, links, {"mine": [(k, 2), …], "pymunk": …}) of what is kept, for a film."""
        mine = [picture_of(self.model, in_order(self.row, one.state), width) for one in self.past]
        films = {"mine": [points for points, _ in mine]}
        if all(one.beside is not None for one in self.past):
            films["pymunk"] = [picture_of(self.model, one.beside, width)[0] for one in self.past]
        return self.past[-1].t - self.past[0].t, mine[0][1], films


def checked(tuning):
    """Return the tuning with floats.  Raises BadInput for what cannot be."""
    g, mu, e, dt, sweeps = tuning
    if mu is not None:
        check_friction(finite_number("friction μ [-]", mu))
    if e is not None:
        check_restitution(finite_number("restitution e [-]", e))
    if g is not None:
        g = finite_number("gravity g [m/s²]", g)
    return Tuning(g, mu, e, positive_number("dt [s]", dt), whole_number("number of sweeps", sweeps, 1))


def moved(model, state):
    """Return the Model that starts from a State.  A half-space lies in the world and keeps its place."""
    def body_there(body, x, q, v, omega):
        if isinstance(body.shape, HalfSpace):
            return body
        return body._replace(x=tuple(x.tolist()), q=float(q), v=tuple(v.tolist()), omega=float(omega))

    def joint_there(joint):
        if isinstance(joint, Distance):
            return joint
        return joint._replace(place=tuple(world_place(state, joint.a, own_place(model, joint.a, joint.place)).tolist()))
    return model._replace(bodies=tuple(map(body_there, model.bodies, *state)),
                          joints=tuple(map(joint_there, model.joints)))


def size_of_moment(moment):
    """Return the bytes of a moment's arrays."""
    arrays = [*moment.state[:4], moment.state.J, *moment.state.contacts, *(moment.beside or ())]
    return sum(np.asarray(one).nbytes for one in arrays)
