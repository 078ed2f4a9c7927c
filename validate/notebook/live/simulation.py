"""A live scene without its canvas: the learner's loop, pymunk beside it, the hand, the settings and the past.

Nothing here knows of a widget or of the time of day.  Both worlds are built from one Model.
"""

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
from solutions.support.shapes import HalfSpace

from ...worlds import chipmunk
from .canvas import model_drawn
from .hand import hand_force, pulled
from .loops import LOOPS
from .running import Running, check_found

AHEAD = 1.0                  # steps by which pymunk's first velocities run ahead: it moves first and pushes then


class Tuning(NamedTuple):
    """What can be changed while a scene runs; None: as in the Model."""
    g: float | None = None       # [m/s²], in the direction that gravity has in the Model
    mu: float | None = None      # friction of every body that can move [-]
    e: float | None = None       # restitution of every body that can move [-]
    dt: float = 1.0 / 120.0      # [s]
    sweeps: int = 20             # of our loop, at most


class Simulation(Running):
    """The two worlds, now."""

    def __init__(self, model, folder, tuning=None, beside=True, lesson="simulator"):
        if model.d == 3:
            raise BadInput("a model for a live scene", "one in space", "take one in the plane")
        super().__init__(folder, checked(tuning or Tuning()))
        self.model, self.beside, self.lesson = model, beside, lesson
        self.moves = [can_move(body) for body in model.bodies]
        _, self.first, self.row = rows_of(model, Settings())
        self.now_model = self.tuned()
        self.driven = any(not can_move(body) and (np.any(body.v) or np.any(body.omega)) for body in model.bodies)
        self.reset()

    # ------------------------------------------------------------------------------------------ code and settings

    def load_code(self):
        """Take the loop of lesson 10, and the lesson whose exercises it calls."""
        self.simulator, self.exercises = self.code.load("simulator"), self.code.load(self.lesson)
        self._compose()

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
        if self.loaded:
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
        self.engine, self.engine_state, self.ahead = None, start_of(self.model) if self.beside else None, AHEAD
        super().reset()

    def advance(self):
        """Advance both worlds by dt; return (state of our loop, work of the hand and of driven bodies [J])."""
        state, work = self._with_hand(self.state)
        after = self.simulator.run_parts(self.loop, self.t, state, self.tuning.dt, 1)
        self._check(after)
        if self.driven:
            work += self.simulator.work_of_driven_rows(after, self.tuning.dt, self.loop.p)
        if self.beside:
            self.step_engine()
        return after, work

    def _with_hand(self, state):
        """Return (state after the hand has acted for dt, its work)."""
        if (grip := self.grip) is None:
            return state, 0.0
        i, p = self.row[grip.body], self.loop.p
        inv_inertia = p.inv_inertia[i] if self.turns else 0.0
        v, omega = state.v.copy(), state.omega.copy()
        v[i], omega[i], work = pulled(grip, self.tuning.dt, state.x[i], state.q[i], v[i], omega[i],
                                      p.inv_mass[i], inv_inertia)
        return state._replace(v=v, omega=omega), work

    def _check(self, after):
        for name in State._fields:
            found, before = getattr(after, name, None), getattr(self.state, name)
            if found is None:
                raise TypeError(f"a part of the loop returned {type(after).__name__} in place of a PileState")
            check_found(f"{name} of body", found, before, self.t, self.row)

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
        if (grip := self.grip) is not None:
            k = grip.body
            body = self.model.bodies[k]
            F[k], tau[k] = hand_force(grip, self.tuning.dt, x[k], q[k], v[k], omega[k], 1.0 / body.m,
                                      1.0 / body.inertia)
        return F, tau

    def show_beside(self, on):
        """Switch pymunk on, from our state, or off."""
        self.beside, self.engine, self.ahead = on, None, AHEAD
        self.engine_state = self.now() if on else None

    def held_place(self, grip):
        """Return the place (2,) of the body that a Grip holds [m]."""
        return world_place(self.now(), grip.body, np.array(grip.place))

    # ------------------------------------------------------------------------------------------ what is seen

    def now(self):
        """Return the State of our loop."""
        return in_order(self.row, self.state)

    def energy(self):
        """Return the energy of our loop [J]."""
        return model_energy(self.now_model, self.now())

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

    def seek(self, t):
        """Return to the kept moment that is nearest to t; later ones stay until the next step."""
        super().seek(t)
        self.engine = None
        if self.beside and self.engine_state is None:
            self.show_beside(True)

    def drawn(self):
        """Return what the canvas has to know of the bodies and of the settings."""
        return model_drawn(self.model, self.tuning, self.beside)

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
