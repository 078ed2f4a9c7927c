"""One worker process with one student's file, to which the trusted parent talks in plain data only.

On Linux the worker lives in the sandbox, and sees Python, NumPy, the file and the lessons as handed out.  Elsewhere it is a process with nothing around it,
and what comes of it is no grade.
"""

import contextlib
import json
import os
import queue
import re
import secrets
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import numpy as np

from solutions.checks import BadInput, Diverged
from validate.loading import alarm

from . import sandbox, shipping, wire
from .meter import LOOK, Meter

HERE = Path(__file__).resolve().parent
LIMITS = {"AS": 2 << 30, "CPU": 150, "NPROC": 4, "FSIZE": 16 << 20, "NOFILE": 64, "CORE": 0}     # [bytes], [s], [-], [bytes], [-], [bytes]
READY_WITHIN = 60.0          # [s]: starting takes 0.2, on a machine that does nothing else
IMPORT_WITHIN = 10.0         # a student's file may take so long to load [s of its own]
CROWDED = 10.0               # so many times as long as its own time may pass before a call is given up: then it is tried once more, alone [-]
ENDED_WITHIN = 60.0          # [s]: the pipes of a sandbox close 0.01 after its end, on a quiet machine
LAST_WORD_WITHIN = 3.0       # [s]: a worker that has closed the wire ends so soon, or lives on
MOST_ENTRIES = 1_000_000     # of all arrays that a student's code hands to one of our functions [-]: the tests need 10⁴
DEEPEST = 16                 # calls inside calls, there and back [-]: the tests need 4
PRINTED = 20_000             # of what is printed, so much is kept [bytes]
NOTE = re.compile(rb"\0note ([a-z]{1,20})\n")         # of the worker's, among what is printed
CUT = re.compile(rb"\0(?:n|no|not|note|note [a-z]{0,20})?\Z")            # the beginning of one
ERRORS = {e.__name__: e for e in (
    BadInput, Diverged, NotImplementedError, ValueError, TypeError, ZeroDivisionError, IndexError, KeyError, AttributeError, NameError,
    UnboundLocalError, ImportError, ModuleNotFoundError, SyntaxError, IndentationError, ArithmeticError, FloatingPointError,
    OverflowError, RecursionError, MemoryError, np.linalg.LinAlgError)}


class StudentError(Exception):
    """The student's program raised an error that is none of Python's usual ones, or ended, or took too long, or sent no data."""
    where = ""               # place in the student's file


class Lost(StudentError):
    """… and its worker is gone."""


class Late(StudentError):
    """One of our own functions, with what the student's code handed it, takes too long."""


# ---------------------------------------------------------------------------------------------- the worker

class Call:
    """A function that lives in the worker."""

    def __init__(self, box, name):
        self.box, self.name = box, name

    def __call__(self, *arguments):
        return self.box.call(self.name, arguments)


class Box:
    """One lesson's file of one submission.  Calls of its functions start the worker, and start another one when it was lost.

    exercises: functions that the file must answer · text: the file, as bytes · given: folder of the lessons as handed out · earlier: {lesson: {exercise function: worked one}} that
    the file may build on · budget [s] for all calls together · begin(limit) allows the next calls so many seconds together.  Seconds are the worker's own (see Meter).
    secret: no word of the student's code is kept with its errors, since it may know secret inputs · failed: what the grader itself could not do ·
    late: the time was up, or the system ended the worker, for which others may be the cause · seen: what the instructor may look into, as in watch.SENTENCES.
    """

    def __init__(self, lesson, exercises, text, given, earlier, budget, records=(), limits=LIMITS):
        self.earlier, self.budget, self.printed, self.process, self.broken, self.depth = earlier, budget, b"", None, None, 0
        self.lesson, self.lines, self.secret, self.failed, self.late, self.seen = lesson, text.count(b"\n") + 1, False, None, False, set()
        self.records, self.meter = {kind.__name__: kind for kind in records}, Meter()
        self.begin(budget)
        self.folder = Path(tempfile.mkdtemp(prefix="workbook-"))
        self.folder.chmod(0o755)
        (self.folder / f"{lesson}.py").write_bytes(text)
        (self.folder / f"{lesson}.py").chmod(0o444)
        config = {"lesson": lesson, "exercises": exercises, "earlier": {name: list(functions) for name, functions in earlier.items()}}
        if sandbox.unavailable():
            inside = {"wire": str(HERE), "given": str(given), "student": str(self.folder)}
            limits, self.binds = {name: value for name, value in limits.items() if name != "NPROC"}, None
        else:
            inside = {"wire": "/box", "given": "/given", "student": "/student"}
            self.binds = {**{HERE / file: f"/box/{file}" for file in ("wire.py", "shipping.py", "worker.py")}, given: "/given", self.folder: "/student"}
        self.program = [sys.executable, "-I", "-B", "-u", f"{inside['wire']}/worker.py", json.dumps({**config, **inside, "limits": limits})]

    # -- functions and records on the wire

    def name_of(self, function):
        """The name under which the worker calls a function.  One that knows nothing goes there as code; the others are called back here."""
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
        """The next calls may take so long, all together [s].

        A worker that has said something unasked is replaced: it would answer past the question.
        """
        self.allow(limit)
        if self.process and self.depth == 0 and not self.quiet():
            self.seen.add("wire")
            self.stop()
        self.allow(limit)

    def allow(self, limit):
        """Count the time from now on."""
        limit = max(0.0, min(limit, self.budget - self.meter.used))
        self.until, self.patience = self.meter.used + limit, time.monotonic() + CROWDED * limit

    def quiet(self):
        """Whether the worker has said nothing unasked.

        What it has said comes before its echo, so that this does not depend on how fast anything is.
        """
        word = secrets.token_hex(8)
        try:
            return self.call("echo", (word,)) == word and self.inbox.empty()
        except Exception:                                              # Lost, or whatever it has sent
            return False

    def call(self, name, arguments):
        """What the worker's function of that name returns; raises what it raised, or Lost."""
        if self.broken:
            raise self.broken
        remember(self.records, arguments)
        if self.meter.used >= self.until:
            raise self.too_long()
        self.depth += 1
        try:
            if self.process is None:
                self.start()
            return self.peer.call(name, arguments)
        except wire.WireError as e:
            self.seen.add("wire")
            raise self.lost(f"the program sent no plain data: {e}") from None
        except Late:
            raise self.too_long() from None
        finally:
            self.depth -= 1
            self.meter.look(False)

    def open(self):
        """Import the file.  When that fails every later call fails in the same way, at once."""
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
        self.process = process = sandbox.started(self.binds, self.program, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.inbox, self.outbox, self.own, self.names = queue.Queue(4), queue.Queue(64), {}, {}
        self.peer = wire.Peer(self.send, self.receive, self.resolve, self.name_of, self.record, describe, self.error,
                              fatal=(KeyboardInterrupt, wire.WireError, Lost, Late))
        self.peer.served = self.peer.serve
        self.peer.serve = self.serve
        self.peer.may_change = lambda name: name.rpartition(":")[2].startswith("solve_")     # all else is pure, or the tests could be moved
        self.over = threading.Event()
        self.threads = [threading.Thread(target=task, args=(process, self.inbox, self.outbox, self.over), daemon=True)
                        for task in (_reading, _writing, self._listening)]
        for thread in self.threads:
            thread.start()
        try:
            ready = self.inbox.get(timeout=READY_WITHIN)
        except queue.Empty:
            ready = None
        if not isinstance(ready, tuple):                               # no code of the student's has run yet
            self.stop()
            self.failed = RuntimeError(f"the grader cannot start its sandbox: {self.printed[-500:].decode(errors='replace')}")
            raise self.failed
        self.meter.follow(process)

    def serve(self, name, arguments):
        """Work one of our functions for the student's code, if what it hands over is of a sane size."""
        if (sum(array.size for array in wire.arrays_in(arguments)) > MOST_ENTRIES or self.depth > DEEPEST
                or not name.startswith(("test:", "solution:"))):
            raise wire.WireError("a call that no test asks for")
        if self.depth > 1:
            return self.peer.served(name, arguments)
        began = time.thread_time()
        try:
            with alarm(self.until - self.meter.used, Late, own=True):
                self.peer.served(name, arguments)
        finally:
            self.meter.used += time.thread_time() - began

    def send(self, frame):
        """Hand a frame to the worker."""
        while True:
            try:
                return self.outbox.put(frame, timeout=LOOK)
            except queue.Full:                                         # it asks, and does not listen to the answers
                self.look(True)

    def receive(self):
        """The next frame."""
        while True:
            if self.meter.due():
                self.look(self.inbox.empty() and not self.outbox.unfinished_tasks and not arriving(self.process.stdout))
            try:
                frame = self.inbox.get(timeout=LOOK)
                break
            except queue.Empty:
                pass
        if isinstance(frame, Exception):
            raise self.lost(f"{frame}{self.last_word()}")
        return frame

    def look(self, owes):
        """See what time the worker has taken, and end it when that is too much."""
        self.meter.look(owes)
        if self.meter.used >= self.until or time.monotonic() >= self.patience:
            raise self.too_long()

    def too_long(self):
        self.late = True
        self.seen.add("time")
        return self.lost("it took too long" if self.meter.used < self.budget else "the time for the whole submission is used up")

    def last_word(self):
        """Why the worker ended, if it did and if the system says so."""
        try:
            code = self.process.wait(timeout=LAST_WORD_WITHIN)
        except subprocess.TimeoutExpired:                              # it has closed the wire, and lives
            self.meter.used += LAST_WORD_WITHIN
            self.seen.add("wire")
            return ""
        number = -code if code < 0 else code - 128                     # bwrap ends with 128 + the signal of the worker
        self.seen.add("refused" if number == signal.SIGSYS else "end")
        self.late |= number == signal.SIGKILL                          # perhaps there was no memory left, and it was nobody's fault
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
                os.killpg(self.process.pid, 9) if os.name == "posix" else self.process.kill()
            self.process.wait()
            self.over.set()
            emptied(self.outbox)
            self.outbox.put_nowait(None)
            until = time.monotonic() + (LAST_WORD_WITHIN if self.binds is None else ENDED_WITHIN)
            for thread in self.threads:                                # they end with the worker's pipes
                thread.join(max(0.0, until - time.monotonic()))
            if not any(thread.is_alive() for thread in self.threads):
                for pipe in (self.process.stdin, self.process.stdout, self.process.stderr):
                    with contextlib.suppress(OSError):                 # what could not be written any more
                        pipe.close()
            self.process = None

    def close(self):
        self.stop()
        shutil.rmtree(self.folder, ignore_errors=True)

    def _listening(self, process, inbox, outbox, over):
        """Keep the beginning of what is printed, and let the rest go; take out what the worker has noted."""
        rest, size = b"", 0
        while chunk := process.stderr.read1(65536):
            chunk = rest + chunk
            rest = (CUT.search(chunk[-30:]) or [b""])[0]
            chunk = chunk[:len(chunk) - len(rest)]
            self.seen.update(kind.decode() for kind in NOTE.findall(chunk))
            chunk = NOTE.sub(b"", chunk)
            size += len(chunk)
            self.printed = (self.printed + chunk)[:PRINTED]
            if size > PRINTED:
                self.seen.add("flood")


def _reading(process, inbox, outbox, over):
    """Hand on what the worker sends, until the worker is over: then nobody takes it any more."""
    def hand_on(frame):
        while not over.is_set():
            with contextlib.suppress(queue.Full):
                return inbox.put(frame, timeout=LOOK)
    try:
        while not over.is_set() and (frame := wire.read(process.stdout)) is not None:
            hand_on(frame)
        hand_on(StudentError("the program ended before it answered"))
    except Exception as e:
        hand_on(StudentError(f"the program sent no plain data: {e}"))


def _writing(process, inbox, outbox, over):
    """In a thread of its own: a worker that never reads must not stop the parent."""
    with contextlib.suppress(OSError, ValueError):
        while (frame := outbox.get()) is not None and not over.is_set():
            process.stdin.write(frame)
            process.stdin.flush()
            outbox.task_done()


def emptied(line):
    """Take everything out of a queue."""
    with contextlib.suppress(queue.Empty):
        while True:
            line.get_nowait()


def arriving(stream):
    """Whether there is something in a pipe that we have not read yet."""
    try:
        import fcntl
        import termios
        return any(fcntl.ioctl(stream.fileno(), termios.FIONREAD, bytes(4)))
    except (ImportError, OSError, ValueError):
        return False


def describe(e):
    """An error of our own functions, for the student's code."""
    return [kind.__name__ for kind in type(e).__mro__][:8], str(e)[:300], ""


def remember(records, value):
    """Note the class of every NamedTuple in a value, so that it can come back as one."""
    if isinstance(value, tuple | list):
        if hasattr(value, "_fields"):
            records[type(value).__name__] = type(value)
        for part in value:
            remember(records, part)


