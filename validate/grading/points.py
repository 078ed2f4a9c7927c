"""Points from test outcomes.  An exercise's points are the sum over its tests; a test that fails earns nothing."""

import contextlib
import io
import os
import re
import traceback
from pathlib import Path
from typing import NamedTuple

import pytest

from solutions.checks import BadInput, Diverged
from validate import mistakes
from validate.mistakes import failing_case
from validate.subject import needs
from validate.subject.loading import TooLong, Unloadable, remedy_for, words_of

from .expect import MOST_DIGITS, NotYet, tidy

TESTS = Path(__file__).resolve().parents[2] / "tests"
LESSONS = TESTS / "lessons"  # the grading tests
SOLUTIONS = TESTS.parent / "solutions"
OURS = {TESTS, TESTS.parent / "validate", Path(os.__file__).parent,                      # no subject's file is in here
        *(SOLUTIONS / name for name in ("given", "support", "checks.py", "vectors.py"))}
PUBLIC = "public"            # the seed of everyone's own tests
LIMIT = 20.0                 # a grading test may take this long [s]: the slowest takes 2, or 5 on a slow machine
AGAIN = 10.0                 # and so long where a test of the exercise, or of one that it calls, has taken too long [s]
READING = "reading the file"   # the quantity where a file could not be loaded
FILE = "the file"            # the quantity where it has no function that a test calls
OWN_NAME = "name the function as in the file that you received"
VALUES = "return as many values as the docstring says, in its order"
LISTED = "a list stands where an array is needed; np.array(…) makes an array of it. Which function returned the list?"
A_LIST = re.compile(r"'list'|\blist indices|concatenate list|multiply sequence")          # as Python speaks of it
NOT_ATTEMPTED = "not attempted"   # the status of a test whose exercise is not written yet
DURATION = "the time it takes"   # the quantity where a test did not end
BOX_LIMIT = 20.0             # and so long in the sandbox [s]
SHAPES = (AttributeError, TypeError, ValueError, IndexError, KeyError)   # what a result of another kind ends in
LINES, PRINTED = 20, 2000    # of what a subject prints, so much is shown [lines, characters]


TRACE = pytest.StashKey[dict]()    # of a test: what the exercise's function returned in it


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
    printed: str = ""        # by a subject in this process, while the test failed
    idea: str = ""           # a known mistake that gives the same results, as a sentence
    below: str = ""          # an exercise that this one calls, and that does not pass, as a sentence
    tells: bool = False      # whether the hint tells the formula that a ★★ exercise asks to find


class Points:
    """A pytest plugin that keeps the outcomes of the grading tests: {name of the subject: its outcomes}."""

    def __init__(self):
        self.outcomes = {}

    def keep(self, item, result):
        self.outcomes.setdefault(item.callspec.params["lesson"], []).append(result)

    def all(self):
        return [outcome for outcomes in self.outcomes.values() for outcome in outcomes]

    def explain(self, traces, folder):
        """Add to every outcome that is "not yet" the mistake that its exercise's results are known for, and an
        exercise below it that does not pass.
        """
        for subject, outcomes in self.outcomes.items():
            states = needs.states((o.exercise, o.status) for o in outcomes if o.status != "not run")
            said = {number: reasons(number, states, traces.of(subject, number), folder)
                    for number, state in states.items() if state == "not yet"}
            self.outcomes[subject] = [o._replace(idea=said[o.exercise][0], below=said[o.exercise][1])
                                      if o.status == "not yet" else o for o in outcomes]

    def pytest_collection_finish(self, session):
        if session.config.getoption("--collect-only"):
            for item in session.items:
                mark = item.get_closest_marker("exercise")
                worth, hint = mark.kwargs["points"], mark.kwargs["hint"]
                self.keep(item, Outcome(mark.args[0], name_of(item), worth, "not run", hint=hint))

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self, item, call):
        mark = item.get_closest_marker("exercise")
        if mark and call.excinfo and call.excinfo.errisinstance(NotImplementedError):
            item.repr_failure = lambda excinfo: words_of(excinfo.value)          # its place would take 0.2 s to find
        report = yield
        if mark and (call.when == "call" or (call.excinfo and call.when == "setup")):
            found = outcome(mark, name_of(item), call.excinfo, item.stash.get(TRACE, None))
            self.keep(item, found._replace(printed=beginning(report.capstdout)) if call.excinfo else found)
            report.attempted = found.status != NOT_ATTEMPTED
            if call.when == "setup" and isinstance(call.excinfo.value, BadInput):
                report.longrepr = str(call.excinfo.value)            # how it came to that is not the student's
        return report

    def pytest_report_teststatus(self, report):
        """Count what is not written yet as such: a class that begins would read thousands of lines of failures."""
        return None if getattr(report, "attempted", True) else (NOT_ATTEMPTED, "o", NOT_ATTEMPTED.upper())


class FailingCases:
    """A pytest plugin that keeps the last call of the exercise's function in the first test that failed, as text:
    found = {(name of the subject, exercise): a failing_case.Case}.
    """

    def __init__(self):
        self.found, self.failed = {}, set()

    def pytest_runtest_makereport(self, item, call):
        trace, mark = item.stash.get(TRACE, None), item.get_closest_marker("exercise")
        key = trace and (item.callspec.params["lesson"], mark.args[0])
        if call.when != "call" or not call.excinfo or not trace or not trace.calls or key in self.failed:
            return
        if call.excinfo.errisinstance(NotImplementedError):
            return
        self.failed.add(key)
        result = None if trace.returned is mistakes.NOTHING else trace.returned
        expected = failing_case.expected_result(result, *getattr(call.excinfo.value, "compared", (None, None)))
        case = failing_case.Case(mark.args[0], name_of(item), list(trace.arguments), result, expected)
        text = failing_case.encoded(case)
        if text:
            self.found[key] = text


def reasons(exercise, states, traces, folder):
    """Return two sentences about an exercise that does not pass, or empty ones.

    They name the mistake, and an exercise below it.
    """
    if exercise not in needs.table():
        return "", ""
    found = mistakes.matching(needs.table()[exercise]["lesson"], exercise, traces)
    below = needs.sentence_below(exercise, states, folder)
    if below:                                              # what is below spoils the results, so they tell nothing
        return "", below
    return mistakes.sentence(found), ""


def beginning(text):
    """Return the first lines of what was printed, what is no text in it written as numbers."""
    lines = text.expandtabs(4)[:PRINTED + 1].splitlines()
    kept = "\n".join(lines[:LINES])[:PRINTED]
    shown = "".join(c if c.isprintable() or c == "\n" else f"\\x{ord(c):02x}" for c in kept)
    return f"{shown}\n…" if len(lines) > LINES or len(text) > PRINTED else shown


def name_of(item):
    """Return a test's name, without the speed that a given subject does not have."""
    return item.name.replace("[given-", "[").replace("[given]", "")


def outcome(mark, name, excinfo, trace=None):
    """Return the Outcome of one test from its mark and its error, if any; trace: the results of the function."""
    exercise, points, hint = mark.args[0], mark.kwargs["points"], mark.kwargs["hint"]
    if excinfo is None:
        return Outcome(exercise, name, points, "passed")
    error = excinfo.value
    if isinstance(error, NotImplementedError):
        return Outcome(exercise, name, points, NOT_ATTEMPTED, got=words_of(error), hint=hint)
    find = needs.asks_to_find(exercise)
    if isinstance(error, NotYet):
        advice = _advice(exercise, error, "") or hint
        words = map(str, (error.quantity, error.expected, error.got, error.tolerance, advice, error.error, error.given))
        return Outcome(exercise, name, points, "not yet", *words, tells=find and advice == hint)
    if isinstance(error, TooLong):
        within = f"an answer within {getattr(error, 'limit', LIMIT):g} s"
        return Outcome(exercise, name, points, "not yet", DURATION, within, "none", "",
                       "does one of your loops never end? Limit the number of its rounds")
    if not any(Path(entry.filename).name.startswith("test_") for entry in _frames(error)):
        return unreadable(Outcome(exercise, name, points, "not run"), error, "")
    kind, place, said = type(error).__name__, _place(error), tidy(words_of(error), MOST_DIGITS)
    if isinstance(error, (BadInput, Diverged)) and _raised_by(exercise, error):
        said = said.partition(": ")[0]                               # a student's own remedy is no advice here
    shapes = isinstance(error, SHAPES) and _misshapen(exercise, trace)
    if shapes:                                                       # the caller could not use what was returned
        listed = "array" in shapes[0] and shapes[1].startswith(("a list", "a tuple"))
        advice = "np.array(…) makes an array of it" if listed else VALUES
        return Outcome(exercise, name, points, "not yet", f"what {trace.function} returns", *shapes, "", advice, kind)
    expected, advice = "an answer, and no error" if place else "an answer", _advice(exercise, error, said)
    return Outcome(exercise, name, points, "not yet", "the call itself", expected, f"{kind}: {said}{place}", "",
                   advice or hint, f"{kind}{place}", tells=find and not advice)


def _misshapen(exercise, trace):
    lesson = needs.table().get(exercise, {"lesson": ""})["lesson"]
    return mistakes.misshapen(lesson, exercise, trace)


def unreadable(o, error, place):
    """Return the Outcome of a test whose subject could not even be loaded."""
    told = f"{type(error).__name__}: {error}{'' if place in str(error) else place}"
    reason, remedy = (error.reason, error.remedy) if isinstance(error, Unloadable) else (told, remedy_for(told, place))
    hint = f"{remedy}; until then nothing in the file can be tested"
    return o._replace(status="not yet", quantity=READING, got=reason, hint=hint, error=f"{type(error).__name__}{place}")


def _raised_by(exercise, error):
    """Return whether the exercise's function itself raised the error, and no given function that it calls."""
    return _frames(error)[-1].name == needs.table().get(exercise, {"function": ""})["function"]


def _frames(error):
    return traceback.extract_tb(error.__traceback__)


def _place(error):
    """Return where in the subject's own file it happened."""
    if hasattr(error, "where"):                                      # the sandbox says
        return f" ({error.where})" if error.where else ""
    files = [(Path(entry.filename), entry.lineno) for entry in _frames(error) if not entry.filename.startswith("<")]
    own = [f" ({file.name}, line {line})" for file, line in files
           if "site-packages" not in file.parts and not OURS.intersection((file, *file.parents))]
    return own[-1] if own else ""


def _advice(exercise, error, said):
    """Return a hint for what Python says, where that is more to the point than the hint for the physics; or nothing."""
    function = needs.table().get(exercise, {"function": ""})["function"]
    if isinstance(error, NotYet):
        return OWN_NAME if error.quantity == FILE else ""
    if isinstance(error, AttributeError) and said.startswith("module ") and said.endswith(f" {function!r}"):
        return OWN_NAME
    if isinstance(error, TypeError) and said.startswith(f"{function}() ") and " argument" in said:
        return "give the function the arguments that it has in the file that you received"
    if "NoneType" in said:
        return "your function returned None: does every path through it end with a return?"
    if "to unpack" in said:
        return VALUES
    if A_LIST.search(said):
        return LISTED
    if said.startswith("it took too long"):                          # in the sandbox
        return "limit the number of rounds of each loop"
    if isinstance(error, NameError):
        return "a name is misspelt, or it has no value yet"
    return ""


def grade(lesson, subject, wanted=lambda exercise, test: True, seed=PUBLIC, collect=False):
    """Run a lesson's grading tests, or those that are wanted, and return their outcomes.

    subject: any object with the lesson's functions as attributes.  With collect no test is run, and all outcomes are
    "not run".
    """
    return grade_each(lesson, {"given": (subject, wanted)}, seed, collect)["given"]


def grade_each(lesson, subjects, seed=PUBLIC, collect=False, traces=None, cases=None):
    """Test several subjects, {name: (subject, wanted)}, in one run of pytest: {name: outcomes}.

    traces: mistakes.Traces, which keep what the functions of the exercises return.  cases: FailingCases, which need
    these.  Both are for public inputs only.
    """
    class Given:
        def pytest_configure(self, config):
            config.given, config.traces = subjects, traces

    points = Points()
    file = str(LESSONS / f"test_{lesson}.py")
    arguments = [file, f"--rootdir={TESTS.parent}", f"--seed={seed}", "--tb=no", "-Wignore"]
    # other plugins and the collection of garbage only take time
    faster = ["-p", "no:cacheprovider", "-p", "no:unraisableexception", "--disable-plugin-autoload"]
    if collect:
        arguments.append("--collect-only")
    with contextlib.redirect_stdout(io.StringIO()):
        pytest.main([*arguments, *faster], plugins=[Given(), points, *filter(None, [cases])])
    return {name: points.outcomes.get(name, []) for name in subjects}


def score(outcomes):
    """Return {exercise: (points earned, points possible)}, in the order in which the exercises came."""
    total = {}
    for o in outcomes:
        earned, possible = total.get(o.exercise, (0, 0))
        total[o.exercise] = earned + o.points * (o.status == "passed"), possible + o.points
    return total
