"""The widget: it runs a Simulation in the kernel, sends pictures to the canvas, and hears the pointer and the keys.

The steps run in an asyncio task of the kernel's main thread, between the messages: only there can an alarm end an
endless loop, and no cell ever runs in the middle of a step.
"""

import asyncio
import contextlib
import io
import signal
import threading
import time
from html import escape
from pathlib import Path

import anywidget
import numpy as np
import traitlets
from IPython import get_ipython

from solutions.checks import BadInput

from ...report import HERE as REPORT
from ...subject.loading import TooLong, alarm
from ..saving import film_html
from .canvas import film_of
from .files import sentence

HERE = Path(__file__).parent
FRAME = 1.0 / 60.0           # between two pictures, at least [s]
BUSY = 0.6                   # share of the time of a picture that steps may take, so that messages are heard
LONGEST = 2.0                # processor time that the steps of one picture may take before they are stopped [s]
LONGEST_WAIT = 20.0          # time by the clock, for code that waits and does not compute [s]
LONGEST_GAP = 0.1            # of the time that a scene makes up for, for example after another cell has run [s]
UNSEEN = 3.0                 # after so long without a sign of the page the scene pauses [s]
IN_FLIGHT = 30               # pictures that the page has not acknowledged yet, at most
LOOK = 0.15                  # between two looks at the learner's files [s]
PER_SECOND = 3_000_000       # bytes that are sent, at most
MOST_FORCES = 1000           # contact forces that are sent: the strongest
LONGEST_PRINT = 400          # characters of what a step prints that are shown
STOPPED = "Stopped. ▶ goes on."
AGAIN = " Save the file, and the scene goes on."

alive: dict = {}             # {cell: [(request, its scene)]}; a cell that runs again closes what it has shown
playing: set = set()         # scenes whose task runs
saved: list = []             # the handler of SIGINT while none plays


# ---------------------------------------------------------------------------------------------- the Stop button

def listen():
    """Let SIGINT stop the scenes.  ipykernel ignores it between cells, and changes the handler around each cell."""
    if threading.current_thread() is threading.main_thread() and signal.getsignal(signal.SIGINT) is not stop:
        saved[:] = [signal.signal(signal.SIGINT, stop)]


def unlisten():
    """Give SIGINT back when no scene plays."""
    if not playing and saved and signal.getsignal(signal.SIGINT) is stop:
        signal.signal(signal.SIGINT, saved[0] or signal.default_int_handler)
    if not playing:
        saved.clear()


def stop(*_):
    """End a step that hangs; pause every scene."""
    for scene in playing:
        scene.stopped = True
    if any(scene.inside for scene in playing):
        raise KeyboardInterrupt


# ---------------------------------------------------------------------------------------------- the widget

class LiveScene(anywidget.AnyWidget):
    """A live scene in a cell."""

    _esm = (REPORT / "player.js").read_text(encoding="utf-8") + (HERE / "live.js").read_text(encoding="utf-8")
    _css = (HERE / "live.css").read_text(encoding="utf-8")
    scene = traitlets.Dict().tag(sync=True)

    def __init__(self, simulation, scene):
        self.simulation, self.speed = simulation, 1.0
        self.runs = self.broken = self.inside = self.stopped = False
        self.wanted = bool(scene.get("play"))                        # whether it should run while a page shows it
        self.said, self.tone, self.views, self.task = "", "", 0, None
        self.sent, self.answered, self.next, self.echo = 0, 0, 0.0, 0
        self.heard = self.looked = time.monotonic()
        self.pace, self.cost = 1.0, 0.0
        super().__init__(scene=scene)
        self.on_msg(self._hear)

    # ------------------------------------------------------------------------------------------ commands

    def play(self):
        """Let the scene run; it needs a running event loop, which a kernel has."""
        self.broken, self.wanted = False, True
        if not self.runs and self.comm is not None:
            self.runs, self.stopped, self.answered = True, False, self.sent
            self.heard = time.monotonic()
            self.say("")
            if self.task is None or self.task.done():    # else it has not seen yet that it was to end, and goes on
                self.task = asyncio.get_running_loop().create_task(self._run())

    def pause(self, why="", tone=""):
        self.runs = self.wanted = False
        self.say(why, tone)

    def wait(self):
        """Pause until a page shows the scene again."""
        self.runs = False
        self.say(self.said, self.tone)

    def step(self):
        """Make one step and pause."""
        self.runs = self.wanted = self.broken = False
        self.simulation.follow()
        if self._advance(1):
            self.say("")
        self._picture()

    def reset(self):
        self.simulation.reset()
        self.broken = False
        self.say("")
        self._picture()

    def seek(self, t):
        """Show a moment of the past, and pause there."""
        self.runs = self.wanted = False
        self.simulation.seek(t)
        self.say("")
        self._picture()

    def close(self):
        self.runs = False
        super().close()

    def _hear(self, _, message, __):
        """Act on a message of the page.  A value that cannot be is refused in one sentence."""
        self.heard, do = time.monotonic(), message.get("do")
        try:
            {"ack": self._acknowledged, "grab": self._grab, "move": self._move, "release": self._release,
             "play": lambda _: self.play(), "pause": lambda _: self.pause(), "step": lambda _: self.step(),
             "reset": lambda _: self.reset(), "seek": lambda m: self.seek(float(m["to"])), "set": self._set,
             "beside": lambda m: self.simulation.show_beside(bool(m["on"])), "film": self._send_film,
             "hello": self._opened, "gone": self._closed, "here": self._seen}[do](message)
        except BadInput as e:
            self.say(f"✗ {e}", "error")

    def _acknowledged(self, message):
        self.answered = max(self.answered, int(message["n"]))

    def _grab(self, message):
        self.echo = message["n"]
        self.simulation.grab(int(message["body"]), message["place"], message["target"])

    def _move(self, message):
        self.echo = message["n"]
        if (grip := self.simulation.grip) is not None:
            self.simulation.grip = grip._replace(target=tuple(map(float, message["target"])))

    def _release(self, _):
        self.simulation.grip = None

    def _set(self, message):
        changes = dict(message["to"])
        self.speed = float(changes.pop("speed", self.speed))
        if changes:
            self.simulation.set(**changes)
            if not self.runs:
                self._picture()

    def _opened(self, message):
        """A page shows the scene, which runs unless a reader has paused it or wants no moving pictures."""
        self.views += 1
        self.wanted = self.wanted and bool(message.get("play"))
        self.answered = self.sent
        self.say(self.said, self.tone)
        self._picture()
        if self.wanted:
            self.play()

    def _closed(self, _):
        self.views = max(0, self.views - 1)
        if not self.views:
            self.wait()

    def _seen(self, _):
        if self.wanted and self.views:
            self.play()

    # ------------------------------------------------------------------------------------------ the loop

    async def _run(self):
        """Make steps between the messages of the kernel.  What cannot be done in time is slow motion."""
        before, owed = time.perf_counter(), 0.0
        playing.add(self)
        try:
            while self.runs:
                listen()
                began = time.perf_counter()
                passed, before = min(began - before, LONGEST_GAP), began
                owed = self._frame(passed, owed + self.speed * passed)
                if self.stopped:
                    self.stopped = False
                    self.pause(STOPPED, "info")
                elif time.monotonic() - self.heard > UNSEEN:
                    self.wait()
                else:
                    await asyncio.sleep(max(0.001, FRAME - (time.perf_counter() - began)))
        finally:
            playing.discard(self)
            unlisten()

    def _frame(self, passed, owed):
        """Make the steps of one picture and send it; return the time that is still owed [s]."""
        if self._saved():
            self.broken = False
            self.say("")
        if self.broken:                                  # until the file is saved again
            return 0.0
        dt = self.simulation.tuning.dt
        done = self._advance(int(owed / dt), FRAME * BUSY)
        self.pace += 0.05 * (done * dt / max(passed, 1e-6) / self.speed - self.pace)
        self._picture()
        return min(owed - done * dt, dt)

    def _saved(self):
        """Return whether the learner has saved a file since the last look."""
        if time.monotonic() - self.looked < LOOK:
            return False
        self.looked = time.monotonic()
        return self.simulation.follow()

    def _advance(self, steps, within=np.inf):
        """Make so many steps, or as many as there is time for; return their number."""
        began, done, printed = time.perf_counter(), 0, io.StringIO()
        try:
            try:
                self.inside = True
                with alarm(LONGEST_WAIT), alarm(LONGEST, own=True), np.errstate(all="ignore"), \
                        contextlib.redirect_stdout(printed):
                    while done < steps and (done == 0 or time.perf_counter() - began < within):
                        self.simulation.step()
                        done += 1
            finally:
                self.inside = False
        except KeyboardInterrupt:
            self.stopped = True
        except (TooLong, SystemExit, Exception) as e:
            self._break(e)
        if done:
            self.cost += 0.1 * ((time.perf_counter() - began) / done - self.cost)
            self.simulation.remember()
        if printed.getvalue():
            self.send({"kind": "printed", "text": printed.getvalue()[-LONGEST_PRINT:]})
        return done

    def _break(self, e):
        """Say what is wrong.  The last good state stays."""
        self.broken, self.simulation.grip = True, None
        self.say(sentence(e, self.simulation.code.folder) + AGAIN, "error")

    # ------------------------------------------------------------------------------------------ what is sent

    def say(self, text, tone=""):
        """Show a sentence below the canvas."""
        self.said, self.tone = text, tone
        self.send({"kind": "status", "playing": self.runs, "say": text, "tone": tone})

    def _picture(self):
        """Send the state: numbers of 4 bytes in one buffer."""
        if self.sent - self.answered >= IN_FLIGHT or (self.runs and time.monotonic() < self.next):
            return
        self.sent += 1
        data = np.concatenate((self._head(), *self._rows())).astype("<f4")
        self.send({"kind": "frame"}, buffers=[data.tobytes()])
        self.next = time.monotonic() + 4.0 * data.size / PER_SECOND

    def _head(self):
        """Return the numbers that live.js names in HEAD, in their order."""
        s = self.simulation
        grip = s.grip
        held = (grip.body, *s.held_place(grip), *grip.target) if grip else (-1, 0.0, 0.0, 0.0, 0.0)
        return [self.sent, s.t, self.pace, 1e3 * self.cost, s.energy(), s.expected(), s.apart(), s.overlap(), *held,
                self.echo, s.past[0].t, s.past[-1].t, min(len(s.forces()), MOST_FORCES), s.engine_state is not None]

    def _rows(self):
        """Return x, y, q of each body, the same of pymunk's, and x, y, F_x, F_y of each contact."""
        s = self.simulation
        forces = s.forces()
        if len(forces) > MOST_FORCES:
            forces = forces[np.argsort(np.hypot(forces[:, 2], forces[:, 3]))[-MOST_FORCES:]]
        states = [s.now(), *([s.engine_state] if s.engine_state is not None else [])]
        return [*(np.column_stack((one.x, one.q)).ravel() for one in states), forces.ravel()]

    def _send_film(self, _):
        """Send the last thirty seconds as a page that any browser plays."""
        film = film_of(self.simulation)
        if film is None:
            self.say("Nothing has moved yet: let the scene play, then save its film.", "info")
            return
        page = (f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{escape(self.scene["name"])}</title>'
                f"<body>{film_html(film, 400)}</body></html>")
        self.send({"kind": "film", "page": page})


# ---------------------------------------------------------------------------------------------- one scene per cell

def take_the_place(scene):
    """Close the scene that this cell has shown before it ran again."""
    shell = get_ipython()
    known = shell if hasattr(shell, "get_parent") else getattr(shell, "kernel", None)          # in a browser the latter
    parent = known.get_parent() if known is not None else {}
    cell, request = parent.get("metadata", {}).get("cellId"), parent.get("header", {}).get("msg_id")
    if cell is None:
        return
    kept = alive.get(cell, [])
    for before, older in kept:
        if before != request:
            older.close()
    alive[cell] = [*((before, older) for before, older in kept if before == request), (request, scene)]
