"""A live scene without its canvas, for anything that moves: the learner's code as saved last, the past, the hand.

Nothing here knows of a widget or of the time of day.
"""

from collections import deque
from typing import Any, NamedTuple

import numpy as np

from solutions.checks import BadInput

from .files import Followed
from .hand import Grip

SECONDS_KEPT = 30.0          # of the past
KEPT_PER_SECOND = 30.0       # states of the past
MOST_KEPT = 48_000_000       # bytes of the past, for any number of bodies


class Moment(NamedTuple):
    """What is kept of a moment, so that the scene can go on from there."""
    t: float                 # [s]
    state: Any               # of the learner's code
    beside: Any              # of the engine, or None
    given: float             # energy that came from outside since the start [J]


class Seen(NamedTuple):
    """Where the bodies are: all that the canvas draws."""
    x: np.ndarray            # (n, 2) [m]
    q: np.ndarray            # (n,) [rad]


class Running:
    """What runs, now.

    A kind of scene defines `load_code`, `advance`, `now`, `energy`, `drawn`, `pictures`, and its `first` state.
    """

    lesson, beside, engine_state = "", False, None
    moves: Any = ()          # whether the hand can move each body, (n,)

    def __init__(self, folder, tuning):
        self.code, self.tuning, self.loaded, self.trouble = Followed(folder), tuning, False, None

    def follow(self):
        """Take the learner's code as saved last; return whether it is another one than before.

        The state stays.  What loading the code raises is raised by the next step.
        """
        if not self.code.changed():
            return False
        self.loaded, self.trouble = False, None
        try:
            self.load_code()
            self.loaded = True
        except (SystemExit, Exception) as e:
            self.trouble = e
        return True

    def reset(self):
        """Return to the start."""
        self.t, self.state, self.given, self.grip = 0.0, self.first, 0.0, None
        self.past, self.bytes = deque(), 0
        self.origin = self.energy()
        self.remember()

    def step(self):
        """Advance by dt.  Raises what the learner's code raises; then nothing has changed."""
        if not self.loaded:
            self.follow()
        if self.trouble is not None:
            raise self.trouble
        self._forget_the_future()
        after, work = self.advance()
        self.state, self.t, self.given = after, self.t + self.tuning.dt, self.given + work

    def grab(self, body, place, target):
        """Let the hand hold a place of a body.  Raises BadInput for a body that nothing moves."""
        if not (0 <= body < len(self.moves) and self.moves[body]):
            raise BadInput("the body to grab", body, "choose one that can move")
        self.grip = Grip(int(body), tuple(map(float, place)), tuple(map(float, target)))

    def held_place(self, grip):
        """Return the place (2,) that a Grip holds [m].  The hand may let go at any time, so it is read once."""
        return self.now().x[grip.body]

    # ------------------------------------------------------------------------------------------ what is seen

    def expected(self):
        """Return the energy at the start, with what the hand and driven bodies gave since [J]: ours lies below it."""
        return self.origin + self.given

    def apart(self):
        """Return the largest distance from the engine beside [m]."""
        return 0.0

    def overlap(self):
        """Return the largest error of a contact or a link in the last step [m]."""
        return 0.0

    def forces(self):
        """Return (m, 4): place [m] and force [N] of each contact."""
        return np.zeros((0, 4))

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
        self.grip = None


def size_of_moment(moment):
    """Return the bytes of a moment's arrays."""
    return bytes_of((moment.state, moment.beside))


def bytes_of(thing):
    """Return the bytes of the arrays in a tuple of tuples."""
    if isinstance(thing, tuple):
        return sum(map(bytes_of, thing))
    return 0 if thing is None else np.asarray(thing).nbytes


def check_found(name, found, before, t, row=slice(None)):
    """Raise TypeError for another shape than before, and ArithmeticError for the first body that is not finite."""
    if np.shape(found) != before.shape:
        raise TypeError(f"{name} has the shape {np.shape(found)} after the step and had {before.shape}")
    bad = ~np.isfinite(np.asarray(found, float).reshape(len(found), -1)).all(axis=1)[row]
    if bad.any():
        raise ArithmeticError(f"{name} {int(np.flatnonzero(bad)[0])} is not finite at t = {t:.4g} s")
