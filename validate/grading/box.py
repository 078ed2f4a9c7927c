"""One worker process with one student's file, which exchanges only plain data with the trusted parent.

The worker runs in the sandbox.  There it can read Python, NumPy, the file and the lessons as handed out.  What it notes
for the instructor comes through a pipe of its own, so that nothing takes a note back.
"""

import contextlib
import json
import os
import re
import secrets
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from solutions.checks import BadInput, Diverged
from validate.subject.loading import alarm

from . import calls, sandbox, shipping, watch, wire
from .line import Ended, Line
from .meter import LOOK, Meter

HERE = Path(__file__).resolve().parent
LIMITS = {
    "AS": 2 << 30,           # [bytes]
    "CPU": 150,              # [s]
    "NPROC": 4,
    "FSIZE": 0,              # [bytes]
    "NOFILE": 64,
    "CORE": 0,               # [bytes]
}
READY_WITHIN = 60.0          # [s]: starting takes 0.2 on an idle machine
IMPORT_WITHIN = 10.0         # time to load a student's file [s of its own]
CROWDED = 10.0               # ratio of elapsed to own time at which a call or a lesson is given up [-]
QUIET = 2.0                  # … and below which own time does not depend on other processes, so one try will do [-]
ENDED_WITHIN = 60.0          # [s]: the pipes of a sandbox close 0.01 after its end on an idle machine
ASLEEP = 6.0                 # longest sleep of a worker that owes an answer, summed over all calls [s]
LAST_WORD_WITHIN = 2.0       # [s]: a worker that has closed the wire ends in this time, or it still lives
MOST_ENTRIES = 1_000_000     # of all arrays that a student's code passes to our functions [-]: the tests need 10⁴
DEEPEST = 16                 # calls inside calls, there and back [-]: the tests need 4
PRINTED = 20_000             # printed text that is kept [bytes]
MOST_WAITING = 64            # frames that the worker has not read yet
BREACH = 1.0                 # of the rules of the conversation costs a worker so much of its time [s]: it starts anew
ERRORS = {
    error.__name__: error
    for error in (
        BadInput,
        Diverged,
        NotImplementedError,
        ValueError,
        TypeError,
        ZeroDivisionError,
        IndexError,
        KeyError,
        AttributeError,
        NameError,
        UnboundLocalError,
        ImportError,
        ModuleNotFoundError,
        SyntaxError,
        IndentationError,
        ArithmeticError,
        FloatingPointError,
        OverflowError,
        RecursionError,
        MemoryError,
        np.linalg.LinAlgError,
    )
}


class StudentError(Exception):
    """The student's program raised an error of its own kind, ended, took too long, or sent no data."""
    where = ""               # place in the student's file


class Lost(StudentError):
    """The program's worker has ended."""


class Late(StudentError):
    """One of our own functions takes too long with the arguments of the student's code."""


# ---------------------------------------------------------------------------------------------- the worker

class Call:
    """A function of the worker."""

    def __init__(self, box, name):
        self.box, self.name = box, name

    def __call__(self, *arguments):
        return self.box.call(self.name, arguments)


class Sandbox:
    """One lesson's file of one submission.  Calls of its functions start the worker, and a new one if it was lost.

    Arguments:
    text: the file, as bytes · given: folder of the lessons as handed out · earlier: {lesson: {exercise function: worked
    one}} that the file may import · budget: time of all calls together [s].  Seconds are the worker's own (see Meter).

    Attributes:
    secret: errors keep no text of the student's code, which may know secret inputs · failed: an error of the grader
    itself · late: the time was up or the system ended the worker, perhaps because of other processes · overdue: the
    time was up since `begin` · seen: codes of watch.SENTENCES that the instructor may look into.
    """

    def __init__(self, lesson, text, given, earlier, budget, records=(), limits=LIMITS):
        self.lesson, self.earlier, self.budget = lesson, earlier, budget
        self.lines = text.count(b"\n") + 1
        self.printed, self.seen = b"", set()
        self.process, self.broken, self.failed = None, None, None
        self.secret, self.late, self.overdue, self.depth, self.ours = False, False, False, 0, time.thread_time()
        self.records, self.meter = {kind.__name__: kind for kind in records}, Meter()
        self.ends = time.monotonic() + CROWDED * budget                # nothing that the worker does extends it
        self.begin(budget)
        self.folder = Path(tempfile.mkdtemp(prefix="workbook-"))
        self.folder.chmod(0o755)
        (self.folder / f"{lesson}.py").write_bytes(text)
        (self.folder / f"{lesson}.py").chmod(0o444)
        names = {name: list(functions) for name, functions in earlier.items()}
        config = {"lesson": lesson, "earlier": names}
        ours = {HERE / file: f"/box/{file}" for file in ("wire.py", "shipping.py", "worker.py")}
        self.binds = {**ours, given: "/given", self.folder: "/student"}
        inside = {"wire": "/box", "given": "/given", "student": "/student", "noted": watch.NOTES, "kept": calls.KEPT}
        whole = json.dumps({**config, **inside, "limits": limits})
        self.program = [sys.executable, "-I", "-B", "-u", "/box/worker.py", whole]

    # -- functions and records on the wire

    def name_of(self, function):
        """Return the name under which the worker calls a function.

        A function that uses only its arguments, numbers and NumPy is sent as code.  The worker calls any other one back
        in this process.
        """
        if isinstance(function, Call):
            return function.name
        if function not in self.names:
            parts = shipping.parts_of(function)
            name = f"{'code' if parts else 'test'}:{len(self.own)}"
            self.names[function], self.own[name] = name, function
            if parts:
                self.send(wire.pack(("define", name, *parts), self.name_of))
        return self.names[function]

    def resolve(self, name):
        kind, _, rest = name.partition(":")
        if kind in ("lesson", "own"):
            return Call(self, name)
        lesson, _, function = rest.partition(".")
        if kind == "solution" and function in self.earlier.get(lesson, ()):
            return self.earlier[lesson][function]
        if name in self.own:
            return self.own[name]
        raise wire.WireError("a function that is not there")

    def record(self, name, fields, values):
        kind = self.records.get(name)
        return kind(*values) if kind and kind._fields == fields else values

    def error(self, names, message, where):
        names = [name for name in names if type(name) is str]
        if "MemoryError" in names:
            self.seen.add("memory")
        kind = next((ERRORS[name] for name in names if name in ERRORS), None)
        error = kind.__new__(kind) if kind else StudentError()
        error.args = (message if kind else f"{names[0] if names else 'an error'}: {message}",)
        if isinstance(error, SyntaxError):
            error.msg = message
        line = re.fullmatch(rf"{self.lesson}\.py, line (\d{{1,6}})", where, re.ASCII)
        error.where = where if line and int(line[1]) <= self.lines and not self.secret else ""
        return error

    # -- the conversation

    def begin(self, limit):
        """Allow the next calls `limit` seconds together.

        A worker that has sent a frame unasked is replaced, because its answers would no longer match the calls.
        """
        self.allow(limit)
        if self.process and self.depth == 0 and not self.quiet():
            self.breach()
            self.stop()
        self.allow(limit)
        self.overdue = False

    def allow(self, limit):
        """Set the time limits, from now on."""
        limit = max(0.0, min(limit, self.budget - self.meter.used))
        self.until = self.meter.used + limit
        self.began = time.monotonic(), self.meter.used
        self.patience = min(time.monotonic() + CROWDED * limit, self.ends)

    def quiet(self):
        """Return whether the worker has sent nothing unasked.

        Anything sent earlier arrives before the echo, so that the result does not depend on timing.
        """
        word = secrets.token_hex(8)
        try:
            answered = self.call("echo", (word,)) == word
            self.line.pump(0.0)
            return answered and not self.line.arrived
        except Exception:                                              # Lost, or an error that the worker has sent
            return False

    def call(self, name, arguments):
        """Call the worker's function of that name.  Raises its error, or Lost."""
        if self.broken:
            raise self.broken
        remember(self.records, arguments)
        if self.is_over():
            raise self.too_long()
        self.depth += 1
        try:
            if self.process is None:
                self.start()
            if self.depth == 1:
                self.ours = time.thread_time()
            return self.peer.call(name, arguments)
        except wire.WireError as e:
            self.breach()
            raise self.lost(f"the program sent no plain data: {e}") from None
        except Late:
            raise self.too_long() from None
        finally:
            self.depth -= 1
            self.charge()
            self.meter.look(False)

    def breach(self):
        """Note that the worker broke the rules of the conversation."""
        self.seen.add("wire")
        self.meter.used += BREACH

    def open(self):
        """Import the file.  If that fails, every later call raises the same error at once."""
        self.begin(IMPORT_WITHIN)
        try:
            self.call("import", ())
        except RuntimeError as e:
            if type(e) is RuntimeError:                                # the grader's own
                raise
            self.broken = e
        except Exception as e:
            self.stop()
            self.broken = e

    def start(self):
        pipes = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE)
        notes, inside = os.pipe()
        self.notes = os.fdopen(notes, "rb", buffering=0)
        try:
            program = [*self.program, str(inside)]
            self.process = sandbox.started(self.binds, program, keep=(inside,), **pipes)
        finally:
            os.close(inside)
        self.line, self.own, self.names, self.heard = Line(self.process, self.hear, self.notes, self.note), {}, {}, 0
        self.peer = wire.Peer(
            self.send, self.receive, self.resolve, self.name_of, self.record, describe, self.error,
            fatal=(KeyboardInterrupt, wire.WireError, Lost, Late),
        )
        self.peer.served = self.peer.serve
        self.peer.serve = self.serve
        # only these may change their arguments: otherwise a student's code could change the inputs of the tests
        self.peer.may_change = lambda name: name.rpartition(":")[2].startswith("solve_")
        if not self.is_ready():                                        # the student's code has not run yet
            self.stop()
            printed = self.printed[-500:].decode(errors="replace")
            self.failed = RuntimeError(f"the grader cannot start its sandbox: {printed}")
            raise self.failed
        self.meter.follow(self.process)

    def is_ready(self):
        """Wait for the first frame; return whether it has come."""
        until = time.monotonic() + READY_WITHIN
        with contextlib.suppress(Ended, wire.WireError):
            while time.monotonic() < until:
                if self.line.frame():
                    return True
                self.line.pump(LOOK)
        return False

    def serve(self, name, arguments):
        """Run one of our functions for the student's code.  Raises WireError if the call is too large or too deep."""
        entries = sum(array.size for array in wire.arrays_in(arguments))
        ours = name.startswith(("test:", "solution:"))
        if not ours or entries > MOST_ENTRIES or self.depth > DEEPEST:
            raise wire.WireError("a call that no test asks for")
        if self.depth > 1:
            return self.peer.served(name, arguments)
        self.charge()
        with alarm(self.until - self.meter.used, Late, own=True):
            self.peer.served(name, arguments)

    def charge(self):
        """Count what this process does for a call: it answers, and unpacks what the worker sends."""
        now = time.thread_time()
        self.meter.used, self.ours = self.meter.used + now - self.ours, now

    def send(self, frame):
        """Send a frame to the worker, or begin to."""
        self.line.send(frame)
        while len(self.line.waiting) > MOST_WAITING:                   # the worker calls and does not read the answers
            self.line.pump(LOOK)
            self.look(True)

    def receive(self):
        """Wait for the next frame.  Raises Lost if the worker ends or the time is up."""
        while True:
            if self.meter.due():
                to_it, from_it = arriving(self.process.stdin), arriving(self.process.stdout)
                ours = self.line.waiting and not to_it                 # this process has not got round to write it
                self.look(not ours and not from_it)
            try:
                if frame := self.line.frame():
                    self.meter.messages += 1
                    return frame
                self.line.pump(LOOK)
            except Ended:
                raise self.lost(f"the program ended before it answered{self.last_word()}") from None
            except wire.WireError as e:
                raise self.lost(f"the program sent no plain data: {e}{self.last_word()}") from None

    def look(self, owes):
        """Measure the worker's time, and end the worker if it has taken too long."""
        self.charge()
        self.meter.look(owes)
        if self.is_over():
            raise self.too_long()

    def is_over(self):
        """Return whether the worker's time is up: that of this test, or that of the whole submission."""
        return self.meter.used >= self.until or self.meter.slept >= ASLEEP or time.monotonic() >= self.patience

    def too_long(self):
        """End the worker, and note whether other processes may be the reason why it took so long."""
        (began, used), now = self.began, time.monotonic()
        self.late |= now - began > QUIET * (self.meter.used - used)
        self.overdue = True
        self.seen.add("time")
        if self.meter.slept >= ASLEEP:
            return self.lost("the program waits and does not compute")
        if self.meter.used < self.budget and now < self.ends:
            return self.lost("it took too long; does one of your loops never end?")
        return self.lost("the time for the whole submission is used up")

    def last_word(self):
        """Return why the worker ended, as far as its exit code tells; an empty string if it still runs."""
        try:
            code = self.process.wait(timeout=LAST_WORD_WITHIN)
        except subprocess.TimeoutExpired:                              # it has closed the wire and still runs
            self.meter.sleep(LAST_WORD_WITHIN)
            self.seen.add("wire")
            return ""
        number = -code if code < 0 else code - 128                     # bwrap ends with 128 + the signal of the worker
        self.seen.add("refused" if number == signal.SIGSYS else "end")
        # other processes may have used up the memory, and the system ended it for that
        self.late |= number == signal.SIGKILL and "signal" not in self.seen
        if number == signal.SIGSYS:
            return ": it made a system call that no lesson needs"
        return f" ({signal.Signals(number).name})" if number in set(signal.Signals) else ""

    def lost(self, why):
        self.stop()
        return Lost(why)

    def stop(self):
        """End the worker, if there is one."""
        if self.process:
            with contextlib.suppress(OSError):
                os.killpg(self.process.pid, 9)
            self.process.wait()
            if self.line.drain(ENDED_WITHIN):                          # its pipes end with the last of its processes
                for pipe in (self.process.stdin, self.process.stdout, self.process.stderr, self.notes):
                    pipe.close()
            self.process = None

    def close(self):
        self.stop()
        shutil.rmtree(self.folder, ignore_errors=True)

    def note(self, chunk):
        """Keep the kinds of what the worker notes; other bytes are the student's own."""
        self.seen |= {watch.NOTES[code] if code < len(watch.NOTES) else "inside" for code in {*chunk}}

    def hear(self, chunk):
        """Keep the beginning of the printed text, and drop the rest."""
        self.heard += len(chunk)
        self.printed = (self.printed + chunk)[:PRINTED]
        if self.heard > PRINTED:
            self.seen.add("flood")


def arriving(stream):
    """Return whether a pipe, of which this is one end, holds data that has not been read yet."""
    import fcntl  # there is none on Windows, where this file is read, too
    import termios

    try:
        return any(fcntl.ioctl(stream.fileno(), termios.FIONREAD, bytes(4)))
    except (OSError, ValueError):
        return False


def describe(e):
    """Describe an error of our own functions for the student's code."""
    return [kind.__name__ for kind in type(e).__mro__][:8], str(e)[:300], ""


def remember(records, value):
    """Record the class of every NamedTuple in a value, so that the worker can return one."""
    if isinstance(value, tuple | list):
        if hasattr(value, "_fields"):
            records[type(value).__name__] = type(value)
        for part in value:
            remember(records, part)


