"""From test outcomes to points.  An exercise's points are the sum over its tests; what did not pass earns nothing."""

import contextlib
import io
import signal
import threading
import time
from pathlib import Path
from typing import NamedTuple

import pytest

from solutions.checks import BadInput

from .expect import NotYet

TESTS = Path(__file__).resolve().parent.parent
PUBLIC = "public"            # the seed of everyone's own tests
LIMIT = 20.0                 # a grading test may take this long [s]: the slowest takes 2, on two shared cores
READING = "reading the file"   # the quantity where a file could not be loaded
DURATION = "the time it takes"   # the quantity where a test did not end
BOX_LIMIT = 10.0             # and so long in the sandbox [s]


class TooLong(Exception):
    """A test that has run out of its time."""


@contextlib.contextmanager
def alarm(seconds, error, own=False):
    """Raise that error after so long, also inside a loop; in a main thread only, and where the system has an alarm clock.  An alarm around it goes on.

    own: count only the time of this process on the processor, so that it is no matter what else the machine does.
    """
    if not hasattr(signal, "setitimer") or threading.current_thread() is not threading.main_thread():
        yield
        return
    clock, number, now = (signal.ITIMER_PROF, signal.SIGPROF, time.process_time) if own else (signal.ITIMER_REAL, signal.SIGALRM, time.monotonic)

    def ring(*arguments):
        if 0.0 < left < seconds:                                       # it was the other's time
            around(*arguments)
        raise error()
    left, began = signal.getitimer(clock)[0], now()
    around = signal.signal(number, ring)
    signal.setitimer(clock, max(0.01, min(seconds, left or seconds)))
    try:
        yield
    finally:
        signal.setitimer(clock, max(0.01, left - (now() - began)) if left else 0.0)
        signal.signal(number, around)


class Outcome(NamedTuple):
    """What one grading test found."""
    exercise: str            # "1.2"
    test: str                # a claim
    points: float
    status: str              # passed, not attempted, not yet
    quantity: str = ""
    expected: str = ""
    got: str = ""
    tolerance: str = ""
    hint: str = ""
    error: str = ""          # the size of what is wrong, in place of expected and got where the inputs are secret
    given: str = ""          # the inputs, in words


class Points:
    """A pytest plugin that keeps the outcomes of the grading tests: {name of the subject: its outcomes}."""

    def __init__(self):
        self.outcomes = {}

    def keep(self, item, result):
        self.outcomes.setdefault(item.callspec.params["lesson"], []).append(result)

    def all(self):
        return [outcome for outcomes in self.outcomes.values() for outcome in outcomes]

    def pytest_collection_finish(self, session):
        if session.config.getoption("--collect-only"):
            for item in session.items:
                mark = item.get_closest_marker("exercise")
                self.keep(item, Outcome(mark.args[0], name_of(item), mark.kwargs["points"], "not run", hint=mark.kwargs["hint"]))

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self, item, call):
        report = yield
        mark = item.get_closest_marker("exercise")
        if mark and (call.when == "call" or (call.excinfo and call.when == "setup")):
            self.keep(item, outcome(mark, name_of(item), call.excinfo))
        return report


def name_of(item):
    """A test's name, without the speed that a given subject does not have."""
    return item.name.replace("[given-", "[").replace("[given]", "")


def outcome(mark, name, excinfo):
    """The Outcome of one test from its mark and what it raised, if anything."""
    exercise, points, hint = mark.args[0], mark.kwargs["points"], mark.kwargs["hint"]
    if excinfo is None:
        return Outcome(exercise, name, points, "passed")
    error = excinfo.value
    if isinstance(error, NotImplementedError):
        return Outcome(exercise, name, points, "not attempted", got=str(error), hint=hint)
    if isinstance(error, NotYet):
        words = map(str, (error.quantity, error.expected, error.got, error.tolerance, hint, error.error, error.given))
        return Outcome(exercise, name, points, "not yet", *words)
    kind = type(error).__name__
    said = f"{kind}: {error}"
    if isinstance(error, TooLong):
        return Outcome(exercise, name, points, "not yet", DURATION, f"an answer within {LIMIT:g} s", "none", "",
                       "does a loop of yours never end? Count its rounds, and stop after so many")
    if not _in_a_test(excinfo):
        return unreadable(Outcome(exercise, name, points, "not run"), error, _line(error))
    place = _place(excinfo)
    return Outcome(exercise, name, points, "not yet", "the call itself", "an answer", f"{said}{place}", "", _advice(error, hint), f"{kind}{place}")


def unreadable(o, error, place):
    """The Outcome of a test whose subject could not even be loaded; Python's own sentence may name the place already."""
    place = "" if place and place in str(error) else place
    return o._replace(status="not yet", quantity=READING, expected="a module that loads", got=f"{type(error).__name__}: {error}{place}",
                      hint="mend this first: nothing in the file can be tested before", error=f"{type(error).__name__}{place}")


def _in_a_test(excinfo):
    return any(entry.path.name.startswith("test_") for entry in excinfo.traceback)


def _line(error):
    return f" (line {error.lineno})" if isinstance(error, SyntaxError) and error.lineno and "line" not in str(error) else ""


def _place(excinfo):
    """Where in the subject's own file it happened."""
    if hasattr(excinfo.value, "where"):                              # the sandbox says
        return f" ({excinfo.value.where})" if excinfo.value.where else ""
    for entry in reversed(excinfo.traceback):
        path = Path(entry.path)                                      # a str for frames such as <frozen importlib._bootstrap>
        if TESTS not in path.parents and "site-packages" not in path.parts:
            return f" ({path.name}, line {entry.lineno + 1})"
    return ""


def _advice(error, hint):
    """A hint for what Python says, where that is more to the point than the hint for the physics."""
    text = str(error)
    if "NoneType" in text:
        return "your function gave None: does every way through it end in a return?"
    if "to unpack" in text:
        return "return as many values as the docstring says, in its order"
    if isinstance(error, NameError):
        return "a name is misspelt, or was never given a value"
    return hint


def grade(lesson, subject, wanted=lambda exercise, test: True, seed=PUBLIC, collect=False):
    """Outcomes of a lesson's grading tests, or of those that are wanted, for a subject (any object with the lesson's functions as attributes).

    With collect no test is run: the tests that there are, all of them "not run".
    """
    return grade_each(lesson, {"given": (subject, wanted)}, seed, collect)["given"]


def grade_each(lesson, subjects, seed=PUBLIC, collect=False):
    """{name: outcomes} of several subjects, {name: (subject, wanted)}, in one run of pytest."""
    class Given:
        def pytest_configure(self, config):
            config.given = subjects

    points = Points()
    with contextlib.redirect_stdout(io.StringIO()):                   # without what only takes time: other people's plugins, and collecting garbage
        pytest.main([str(TESTS / f"test_{lesson}.py"), f"--rootdir={TESTS.parent}", "--tb=no", "-p", "no:cacheprovider",
                     "-p", "no:unraisableexception", "--disable-plugin-autoload", f"--seed={seed}", *["--collect-only"] * collect], plugins=[Given(), points])
    return {name: points.outcomes.get(name, []) for name in subjects}


def score(outcomes):
    """{exercise: (points earned, points possible)}, in the order in which the exercises came."""
    total = {}
    for o in outcomes:
        earned, possible = total.get(o.exercise, (0, 0))
        total[o.exercise] = earned + o.points * (o.status == "passed"), possible + o.points
    return total
