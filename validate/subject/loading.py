"""Files of a subject that do not load or lack a function: the message about them, and their stand-ins.

A student's file may hold anything.  Every fault ends in an Unloadable that names file, line, reason and remedy.
"""

import contextlib
import re
import signal
import sys
import threading
import time
import traceback
import types
from importlib.machinery import FileFinder, SourceFileLoader
from pathlib import Path

from solutions.checks import BadInput

LOAD_WITHIN = 10.0           # a file may take so long to load [s]: ours take 0.1
JUMPS = 4                    # our number among the tools of sys.monitoring; Python itself gives it to none
LONGEST_REASON = 200         # of what Python says, so much is told [characters]


class Unloadable(BadInput):
    """A file that cannot be loaded: the file, the reason with its place, and what to do."""

    def __init__(self, file, reason, remedy):
        ValueError.__init__(self, f"{file} cannot be loaded: {reason}. {remedy[:1].upper()}{remedy[1:]}.")
        self.file, self.reason, self.remedy = file, reason, remedy


class AsSaved(SourceFileLoader):
    """Loads a file as it is saved now.

    Python keeps compiled files in `__pycache__`.  It compares only the length of a file and the second in which it was
    saved.  So it would miss a save that follows another within a second and leaves the length as it is.
    """

    def get_code(self, fullname):
        file = self.get_filename(fullname)
        data = self.get_data(file)
        try:
            return self.source_to_code(data, file)
        except ValueError as e:                      # of a NUL byte, before Python 3.11.4
            raise SyntaxError(str(e), (file, None, None, None)) from e


class Folders(list):
    """The `__path__` of a package of a module set: what lies in these folders is loaded as it is saved now."""


class FinderOfFolders:
    """Finds the modules of such packages, and no others."""

    @staticmethod
    def find_spec(name, path=None, target=None):
        folders = path if isinstance(path, Folders) else ()
        found = (FileFinder(folder, (AsSaved, [".py"])).find_spec(name) for folder in folders)
        return next(filter(None, found), None)


sys.meta_path.insert(0, FinderOfFolders)


class TooLong(BaseException):
    """Something has run out of its time.  No `except Exception` of a student's loop keeps it."""


@contextlib.contextmanager
def alarm(seconds, error=TooLong, own=False):
    """Raise that error after so long, even inside a loop.

    Only in a main thread, and where the system has an alarm clock or is a browser; an alarm around
    this one goes on.

    own: count only the time that this process spends on the processor, and not that of other programs.
    """
    if sys.platform == "emscripten":
        with alarm_at_jumps(seconds, error):
            yield
        return
    if not hasattr(signal, "setitimer") or threading.current_thread() is not threading.main_thread():
        yield
        return
    wall = signal.ITIMER_REAL, signal.SIGALRM, time.monotonic
    clock, number, now = (signal.ITIMER_PROF, signal.SIGPROF, time.process_time) if own else wall

    def ring(*arguments):
        if 0.0 < left < seconds:                                     # it was the outer alarm's time
            around(*arguments)
        raise error(f"still running after {seconds:g} s")
    left, began = signal.getitimer(clock)[0], now()
    around = signal.signal(number, ring)
    signal.setitimer(clock, max(0.01, min(seconds, left or seconds)))
    try:
        yield
    finally:
        signal.setitimer(clock, max(0.01, left - (now() - began)) if left else 0.0)
        signal.signal(number, around)


@contextlib.contextmanager
def alarm_at_jumps(seconds, error=TooLong):
    """Do the same where there is no alarm clock: look at the time whenever Python jumps back, as every loop does.

    Needs `sys.monitoring` of Python 3.12.  *Left out:* a loop without a body, `while True: pass`, of which Python 3.12
    reports no jump.
    """
    watch, jump, until = sys.monitoring, sys.monitoring.events.JUMP, time.monotonic() + seconds

    def look(*place):
        nonlocal until
        if time.monotonic() > until:
            until = float("inf")                 # rings once: what catches the error has loops, too
            raise error(f"still running after {seconds:g} s")
        if around:
            around(*place)
    if watch.get_tool(JUMPS) is None:
        watch.use_tool_id(JUMPS, "alarm")
    around = watch.register_callback(JUMPS, jump, look)
    watch.set_events(JUMPS, jump)
    try:
        yield
    finally:
        watch.register_callback(JUMPS, jump, around)
        watch.set_events(JUMPS, jump if around else 0)


# ---------------------------------------------------------------------------------------------- what is said

RUNS_AT_ONCE = "it runs as soon as the file is loaded"
REMEDIES = {                 # {sign in what Python says: what to do}; the first that fits
    "null byte": "save it as plain text in UTF-8",
    "codec can't decode": "save it as plain text in UTF-8",
    "unknown encoding": "save it as plain text in UTF-8",
    "TabError": "indent that line with spaces only, as far as its neighbours",
    "IndentationError": "indent that line as far as its neighbours, in steps of four spaces",
    "SyntaxError": "correct that line, or the one before it",
    "ImportError": "correct that import, or take it out: a lesson needs NumPy and what its first lines import",
    "ModuleNotFoundError": "correct that import, or take it out: a lesson needs NumPy and what its first lines import",
    "SystemExit": "take out what ends the program there",
    "ended before it answered": "take out what ends the program",
    "still running": f"let that loop end, or take it out: {RUNS_AT_ONCE}",
    "took too long": "let every loop end that runs as soon as the file is loaded, or take it out",
}


def unloadable(file, error):
    """Return the Unloadable for a file that raised that error while it was loaded."""
    at_fault, place = _place(file, error)
    words = re.sub(r" \([^()]*\.(py|so)\)$", "", " ".join(words_of(error).split()))     # without where a library lies
    words = words if len(words) <= LONGEST_REASON else f"{words[:LONGEST_REASON]} …"
    told = ": ".join(filter(None, ("" if isinstance(error, TooLong) else type(error).__name__, words)))
    where = ", ".join(filter(None, (at_fault.name, place)))
    return Unloadable(f"{file.parent.name}/{file.name}", f"{told} ({where})", remedy_for(told, place))


def remedy_for(told, place):
    """Return what to do about a file that cannot be loaded, by what Python said."""
    if not place and ("No such file" in told or "Is a directory" in told):
        return "put the file back where it was"
    known = (remedy for sign, remedy in REMEDIES.items() if sign in told)
    return next(known, f"correct that line, or take it out: {RUNS_AT_ONCE}")


PUT_BACK = "put it back under that name, with its arguments"


def lacks(file, name):
    """Return the sentence about a file without a function."""
    return f"{file.parent.name}/{file.name} has no {name}: {PUT_BACK}"


def part(module, name):
    """Return the object that a scene or a lesson takes from a lesson.

    Raises Unloadable if the lesson's file lacks it.
    """
    if name not in vars(module):
        file = Path(module.__file__)
        raise Unloadable(f"{file.parent.name}/{file.name}", f"it has no {name}", PUT_BACK)
    return getattr(module, name)


def words_of(error):
    """Return what an error says; a class of the student's own may fail at that, too."""
    try:
        return str(error.msg if isinstance(error, SyntaxError) else getattr(error, "strerror", None) or error)
    except Exception:
        return ""


def _place(file, error):
    """Return (file, "line 12") of an error.  If bytes are no text, Python may name no line, or a wrong one."""
    if isinstance(error, SyntaxError) and file.is_file():
        at_fault = Path(error.filename) if error.filename and Path(error.filename).is_file() else file
        line = _line_without_text(at_fault.read_bytes()) or error.lineno
        return at_fault, f"line {line}" if line else ""
    lines = [entry.lineno for entry in traceback.extract_tb(error.__traceback__) if Path(entry.filename) == file]
    called = f", which calls line {lines[-1]}" if lines and lines[0] != lines[-1] else ""
    return file, f"line {lines[0]}{called}" if lines else ""


def _line_without_text(data):
    """Return number of the first line that is not UTF-8 or holds a NUL byte; 0 when there is none."""
    try:
        data.decode("utf-8")
        place = data.find(b"\0")
    except UnicodeDecodeError as e:
        place = e.start
    return data.count(b"\n", 0, place) + 1 if place >= 0 else 0


# ---------------------------------------------------------------------------------------------- what stands in

def waiting(why):
    """Return a function that cannot be had yet: it raises NotImplementedError with the reason."""
    def waits(*_, **__):
        raise NotImplementedError(why)
    return waits


def answer_for_what_is_missing(module):
    """Let a lesson have, for every name that its file lacks, a function that says so."""
    def absent(name):
        refuse_private(name)
        return waiting(lacks(Path(module.__file__), name))
    vars(module).setdefault("__getattr__", absent)


def refuse_private(name):
    """Raise AttributeError for a name that begins with _: Python,
    IPython and hypothesis ask every module for such names.
    """
    if name.startswith("_"):
        raise AttributeError(name)


def stand_in(name, given, exercises, why):
    """Return a module in place of one that cannot be loaded: it has what is given, and all else waits."""
    def absent(name):
        refuse_private(name)
        return waiting(why)
    module = types.ModuleType(name)
    vars(module).update({n: value for n, value in given.items() if not n.startswith("__")})
    vars(module).update({**dict.fromkeys(exercises, waiting(why)), "__getattr__": absent})
    return module
