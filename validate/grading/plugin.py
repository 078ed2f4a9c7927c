"""One set of tests for several subjects: `pytest --of=solutions|lessons|PATH`.

`--compiled`, `--exercise=1.2` and `--seed=anything` choose among the tests and their inputs.
Without options the subject is `solutions`, plain and compiled, and the tests of the workbook itself run too.
With --of only the grading tests run.  Long tests run only with --long, and with --part=K/N only a part of them.
"""

import argparse
import ast
import hashlib
import importlib.util
import json
import re
import signal
import sys
import threading
import types
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from solutions.checks import BadInput
from validate import mistakes
from validate.subject import copies, modules, needs
from validate.subject.loading import TooLong, alarm, lacks

from . import wire
from .expect import NotYet
from .points import (
    AGAIN,
    BOX_LIMIT,
    FILE,
    LESSONS,
    LIMIT,
    NOT_ATTEMPTED,
    PUBLIC,
    TESTS,
    TRACE,
    FailingCases,
    Points,
    name_of,
    score,
)


def pytest_addoption(parser):
    group = parser.getgroup("workbook")
    group.addoption("--of", help="whose answers to test: solutions, lessons or a folder of lesson files")
    group.addoption("--compiled", action="store_true", help="test the compiled twins only")
    exercise = "only this exercise (may be repeated)"
    group.addoption("--exercise", action="append", default=[], metavar="1.2", help=exercise)
    seed = "draw the inputs of the tests from this; a class is graded with a secret one"
    group.addoption("--seed", default=PUBLIC, help=seed)
    group.addoption("--long", action="store_true", help="run the long tests, too")
    part = "with --long: only part K of N of the long tests, drawn from their names (K may be any whole number)"
    group.addoption("--part", metavar="K/N", type=part_of, default=(0, 1), help=part)
    group.addoption("--outcomes", metavar="FILE", help="with --of: write every outcome there, as JSON")
    case = "with --of and the public seed: write the first failing call there, as JSON, for a notebook to draw"
    group.addoption("--case", metavar="FILE", help=case)


def part_of(text):
    """Return (k, n) of K/N."""
    try:
        k, n = map(int, text.split("/"))
        return k % n, n
    except (ValueError, ZeroDivisionError):
        raise argparse.ArgumentTypeError(f"{text!r} is not K/N, such as 1/4") from None


def pytest_configure(config):
    in_main_thread = threading.current_thread() is threading.main_thread()
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN and in_main_thread:
        # a background job of a shell ignores Ctrl-C, and so would all processes that it starts
        signal.signal(signal.SIGINT, signal.default_int_handler)
    if hasattr(config.option, "loadscopereorder"):
        config.option.loadscopereorder = False               # pytest-xdist would start the longest groups last
    if config.getoption("--of"):
        asked, config.option.of = config.option.of, copies.meant_here(config.option.of)
        config.of_another_copy = asked != config.option.of
        if config.getoption("--seed") == PUBLIC:
            config.traces = mistakes.Traces()
        try:
            modules.subject_folder(config.getoption("--of"))
        except BadInput as e:
            raise pytest.UsageError(str(e)) from None
        if config.option.tbstyle == "auto":
            config.option.tbstyle = "short"
        config.points = Points()
        config.pluginmanager.register(config.points)
        if config.getoption("--case") and hasattr(config, "traces"):  # never with a secret seed
            config.cases = FailingCases()
            config.pluginmanager.register(config.cases)
    for exercise in config.getoption("--exercise"):
        if not re.fullmatch(r"\d+\.\d+", exercise) or not tests_of(exercise):
            raise pytest.UsageError(f"exercise {exercise!r} is unknown: give its number, like --exercise=1.2")


def tests_of(exercise):
    """List the test files that name an exercise; for an empty one, those of every lesson."""
    files = [LESSONS / f"test_{lesson}.py" for lesson in modules.lesson_names()]
    files = [path for path in files if path.is_file()]
    return [path for path in files if not exercise or f'"{exercise}"' in path.read_text(encoding="utf-8")]


def pytest_ignore_collect(collection_path, config):
    """Ignore files without a selected test if --of or --exercise is given."""
    exercises = config.getoption("--exercise") or [""] * bool(config.getoption("--of"))
    if exercises and collection_path.is_relative_to(TESTS) and collection_path.suffix == ".py":
        return not any(collection_path in tests_of(exercise) for exercise in exercises) or None


def pytest_generate_tests(metafunc):
    if "lesson" in metafunc.fixturenames:
        option = metafunc.config.getoption
        group = pytest.mark.xdist_group(f"compiled {metafunc.definition.path.stem}")     # one process compiles
        once = pytest.param("compiled", marks=group)
        subjects = [once] if option("--compiled") else ["plain"] if option("--of") else ["plain", once]
        if hasattr(metafunc.config, "given"):
            subjects = list(metafunc.config.given)
        metafunc.parametrize("lesson", subjects, indirect=True)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item):
    """Stop a subject's endless loop.  Compiled and given code is ours and trusted."""
    given = hasattr(item.config, "given")
    if not item.get_closest_marker("exercise") or not (given or item.config.getoption("--of")):
        return (yield)
    limit = limit_of(item, LIMIT)
    try:
        with alarm(limit, own=given):                                # own time when grading, wall time for one student
            return (yield)
    except TooLong as e:
        e.limit = limit
        note_too_long(item)
        raise
    finally:
        box = box_of(item.config.given[item.callspec.params["lesson"]][0]) if given else None
        if box and box.overdue:
            note_too_long(item)


def box_of(subject):
    """Return the sandbox of a subject, or None.

    A lesson's module is no sandbox, though it answers for every name that it lacks.
    """
    return None if isinstance(subject, types.ModuleType) else getattr(subject, "box", None)


RETURNED = pytest.StashKey[dict]()   # {subject: {name of its function: its last results}}
TOO_LONG = pytest.StashKey[set]()                                    # {(subject, exercise)} of tests that were stopped


def note_too_long(item):
    stopped = item.config.stash.setdefault(TOO_LONG, set())
    stopped.add((item.callspec.params["lesson"], item.get_closest_marker("exercise").args[0]))


def limit_of(item, limit):
    """Return how long a test may take [s].

    An endless loop is waited for once: after it, the other tests of its exercise, and those of exercises that call it,
    have less time.  That is still twice what the slowest test of the worked answers takes, so a test that ends passes.
    """
    subject, exercise = item.callspec.params["lesson"], item.get_closest_marker("exercise").args[0]
    stopped = item.config.stash.get(TOO_LONG, ())
    below = [exercise, *needs.needed(exercise)] if stopped and exercise in needs.table() else [exercise]
    return min(AGAIN, limit) if any((subject, number) in stopped for number in below) else limit


@pytest.hookimpl(tryfirst=True)                         # before pytest's own -m, which must see what is long
def pytest_collection_modifyitems(config, items):
    wanted = [item for item in items if is_wanted(item, config)]
    if not (config.getoption("--compiled") or hasattr(config, "given")):
        mark_compiled_as_long(wanted)
    keep = [item for item in wanted if not is_left_out(item, config)]
    count_left_out(config, len(wanted) - len(keep))
    if len(keep) < len(items):
        kept = {*keep}
        if not config.getoption("--of"):                             # a student has not chosen what is left out
            config.hook.pytest_deselected(items=[item for item in items if item not in kept])
        items[:] = keep
    if config.getoption("--of"):                                     # a student's code may warn, as in the sandbox
        for item in items:
            item.add_marker(pytest.mark.filterwarnings("ignore"))
    items.sort(key=lambda item: item.path.stem != "test_notebooks")  # the longest first: processes end together


def is_wanted(item, config):
    mark, exercises = item.get_closest_marker("exercise"), config.getoption("--exercise")
    if mark is None:
        return not (exercises or config.getoption("--of") or hasattr(config, "given"))
    if hasattr(config, "given"):
        _, wanted = config.given[item.callspec.params["lesson"]]
        return wanted(mark.args[0], name_of(item))
    return not exercises or mark.args[0] in exercises


def is_left_out(item, config):
    """Return whether this test is long and was not asked for."""
    k, n = config.getoption("--part")
    asked = config.getoption("--long") and int(hashlib.sha256(item.nodeid.encode()).hexdigest(), 16) % n == k
    return bool(item.get_closest_marker("long")) and not asked


def mark_compiled_as_long(items):
    """Mark the tests of a lesson's compiled answers as long, except the first.  Each compiles something else."""
    seen = set()
    for item in items:
        if hasattr(item, "callspec") and item.callspec.params.get("lesson") == "compiled":
            if item.path in seen:
                item.add_marker(pytest.mark.long)
            seen.add(item.path)


def count_left_out(config, count):
    """Keep the number of long tests left out for the summary; a worker of pytest-xdist sends it."""
    config.long_tests_left_out = count
    if hasattr(config, "workeroutput"):
        config.workeroutput["long_tests_left_out"] = count


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node):
    """Take the number from a worker of pytest-xdist; all workers collect the same tests."""
    left_out = getattr(node, "workeroutput", {}).get("long_tests_left_out", 0)
    node.config.long_tests_left_out = max(left_out, getattr(node.config, "long_tests_left_out", 0))


@pytest.fixture
def lesson(request):
    """Load the lesson that the test file is named after, from the subject under test."""
    if hasattr(request.config, "given"):
        subject, _ = request.config.given[request.param]
        if box := box_of(subject):
            box.begin(limit_of(request.node, BOX_LIMIT))
        return Pure(subject, trace_for(request), returned_to(request))
    name, of = request.path.stem.removeprefix("test_"), request.config.getoption("--of") or "solutions"
    if request.param == "plain":
        return Pure(modules.bind(name, of), trace_for(request), returned_to(request))
    if not modules.can_compile():
        pytest.skip("numba has no wheel for this machine: the compiled twins are not tested")
    if request.node.get_closest_marker("counts_calls"):
        pytest.skip("counts the calls of a Python function, which compiled code cannot call")
    return Compiled(modules.bind(name, of, compiled=True))


def trace_for(request):
    """Return the Trace of the function that a test is about; None where nothing is traced, as with secret inputs."""
    traces, mark = getattr(request.config, "traces", None), request.node.get_closest_marker("exercise")
    if traces is None or mark is None:
        return None
    test = request.node.name.replace(f"[{request.param}-", "[").replace(f"[{request.param}]", "")
    trace = traces.begin(request.param, request.path.stem.removeprefix("test_"), mark.args[0], test)
    request.node.stash[TRACE] = trace
    return trace


def returned_to(request):
    """Return the last results of each function of the subject of a test, as earlier tests left them."""
    return request.config.stash.setdefault(RETURNED, {}).setdefault(request.param, wire.results())


class Draw:
    """Draw the inputs of one test from the seed and the name of the test, the same for every subject."""

    def __init__(self, seed, test):
        self.rng = np.random.default_rng(list(hashlib.sha256(f"{seed}/{test}".encode()).digest()))
        self.secret = seed != PUBLIC

    def __call__(self, low, high, shape=None):
        """Return a float, or an array of them, between low and high."""
        return self.rng.uniform(low, high, shape)

    def sparse(self, low, high, shape=None):
        """Return a float, or an array of them, between low and high; each is exactly 0 with a chance of a half.

        A short cut for what is at rest, or points along an axis, shows only there.
        """
        return self(low, high, shape) * self.rng.integers(0, 2, shape) + 0.0         # −0 becomes 0

    def whole(self, low, high):
        """Return an integer from low to high, both included."""
        return int(self.rng.integers(low, high + 1))

    def within(self, least=0.1):
        """Return three shares of a threshold that are below it: one just below, and one of each half of the rest."""
        return 0.99, self(0.5 * (least + 0.99), 0.98), self(least, 0.5 * (least + 0.99))

    def beyond(self, most):
        """Return three shares of a threshold that are above it: one just above, and one of each half of the rest."""
        return 1.01, self(1.02, 0.5 * (1.01 + most)), self(0.5 * (1.01 + most), most)

    def law(self, public):
        """Return a law of public tests; with a secret seed, one that students do not receive in its place."""
        unseen = importlib.util.find_spec(f"{__package__}.unseen") if self.secret else None
        return importlib.import_module(unseen.name).UNSEEN[public.__name__] if unseen else public


@pytest.fixture
def draw(request):
    """Return the inputs of this test."""
    return Draw(request.config.getoption("--seed"), request.function.__name__)


class Pure:
    """A lesson whose functions must not change arrays: neither their arguments nor what they have returned before."""

    def __init__(self, subject, trace=None, returned=None):
        self.subject, self.trace = subject, trace
        self.returned = wire.results() if returned is None else returned          # of calls in earlier tests, too

    def __getattr__(self, name):
        if isinstance(self.subject, types.ModuleType) and name not in vars(self.subject):
            file = Path(self.subject.__file__)
            raise NotYet(FILE, f"a function {name}", lacks(file, name), "", "no such function")
        value = getattr(self.subject, name)
        if not callable(value) or isinstance(value, type):
            return value
        watched = self.trace and name == self.trace.function
        value = self.trace.watching(value) if watched else value

        def call(*arguments):
            given, earlier = wire.Contents(arguments), wire.Contents(list(self.returned[name]))
            result = value(*(getattr(a, "unwatched", a) for a in arguments))
            inputs, results = given.changed(), earlier.changed()
            if inputs or results:
                if watched and inputs:
                    self.trace.changed_input()
                what = "the input arrays" if inputs else "the results of earlier calls"
                culprit = f"{name}, or a function that it calls," if self.trace and not watched else name
                raise NotYet(what, "unchanged: return new arrays", f"{culprit} has changed one in place", "",
                             "changed in place")
            self.returned[name].append(result)
            return result

        call.unwatched = value
        return call


class Compiled:
    """A compiled lesson that compiles the functions of a test that it gets as callbacks."""

    def __init__(self, module):
        self.module = module

    def __getattr__(self, name):
        value = getattr(self.module, name)
        if not hasattr(value, "py_func"):
            return value

        def call(*arguments):
            return value(*map(compiled_callback, arguments))

        call.twin = value
        return call


def compiled_callback(argument):
    if hasattr(argument, "twin"):
        return argument.twin
    return _jitted(argument) if isinstance(argument, types.FunctionType) else argument


_callbacks: dict = {}


def _jitted(function):
    from numba import njit
    if function not in _callbacks:
        _callbacks[function] = njit(error_model="numpy")(function)
    return _callbacks[function]


@pytest.hookimpl(tryfirst=True)
def pytest_sessionfinish(session):
    terminal = session.config.pluginmanager.get_plugin("terminalreporter")
    if terminal and hasattr(session.config, "points"):               # a file that cannot be loaded is reported once
        errors = reversed(terminal.stats.get("error", ()))
        terminal.stats["error"] = [*{str(report.longrepr): report for report in errors}.values()]
    if hasattr(session.config, "points") and hasattr(session.config, "traces"):
        session.config.points.explain(session.config.traces, modules.subject_folder(session.config.getoption("--of")))
    path = session.config.getoption("--outcomes")
    if path and hasattr(session.config, "points"):
        Path(path).write_text(json.dumps([outcome._asdict() for outcome in session.config.points.all()]))
    for text in [*session.config.cases.found.values()][:1] if hasattr(session.config, "cases") else ():
        Path(session.config.getoption("--case")).write_text(text)


def lines_of_points(outcomes):
    """Return the points of each lesson, and below it those of its exercises, as soon as one of them is attempted."""
    table, lessons, lines = score(outcomes), {}, []
    ran = needs.states((o.exercise, o.status) for o in outcomes if o.status != "not run")
    states = dict.fromkeys(table, NOT_ATTEMPTED) | ran                   # an interrupted run leaves some out
    for exercise in sorted(table, key=needs.in_order):
        lessons.setdefault(needs.table()[exercise]["lesson"], []).append(exercise)
    for lesson, exercises in lessons.items():
        lines.append(f"{lesson}: {total(table[number] for number in exercises)}")
        for number in exercises if any(states[number] != NOT_ATTEMPTED for number in exercises) else ():
            lines.append(f"{number:>6}  {total([table[number]])}{'  o' * (states[number] == NOT_ATTEMPTED)}")
            lines += [f"{'':8}{said}" for said in dict.fromkeys(text for o in outcomes if o.exercise == number
                                                               for text in (o.below, o.idea, why_open(o)) if text)]
    whole = [lesson for lesson in lessons if states.keys() >= {*needs.of_lesson(lesson)}]
    begin = next((number for lesson in whole if (number := needs.next_of(lesson, states))), None)
    return [*lines, f"all: {total(table.values())}", *(["o: not written yet"] * (NOT_ATTEMPTED in states.values())),
            *([f"next: {begin} {needs.table()[begin]['function']}"] if begin else [])]


def why_open(o):
    """Return why an exercise is open, where it is not its own: another one is, or its lesson does not load."""
    return "" if o.status != NOT_ATTEMPTED or o.got.startswith(f"Exercise {o.exercise}:") else f"open: {o.got}"


def total(points):
    """Return the sum of some (earned, possible), in words."""
    earned, possible = map(sum, zip(*points))
    return f"{earned:g} of {possible:g}"


def imports_without_a_grader(config):
    """Return {file: modules that it imports, and that the sandbox of a grader need not have} of the lessons tested."""
    folder, found = modules.subject_folder(config.getoption("--of")), {}
    there = {*sys.stdlib_module_names, "numpy", "solutions", *(f"lessons.{name}" for name in modules.lesson_names())}
    for path in sorted(folder.glob("*.py")):
        with suppress(SyntaxError, ValueError, OSError):
            parts = [name.split(".") for name in imported(ast.parse(path.read_bytes()))]
            names = {".".join(part[:2] if part[0] == "lessons" else part[:1]) for part in parts}
            found.update({path.name: sorted(names - there)} if names - there else {})
    return found


def imported(tree):
    """Yield the full names of all modules that a file imports, but those beside it that it names by a dot."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            yield node.module


def pytest_terminal_summary(terminalreporter, config):
    left_out = getattr(config, "long_tests_left_out", 0)
    if left_out:
        tests, were = ("test", "was") if left_out == 1 else ("tests", "were")
        how = "another --part" if config.getoption("--long") else "pytest --long"
        them = "it" if left_out == 1 else "them"
        terminalreporter.line(f"{left_out} long {tests} {were} left out: {how} runs {them}, too")
    outcomes = config.points.all() if hasattr(config, "points") else []
    if all(o.status == "not run" for o in outcomes):                     # as with --collect-only
        return
    terminalreporter.section("points")
    for line in lines_of_points(outcomes):
        terminalreporter.line(line)
    for file, names in imports_without_a_grader(config).items():
        terminalreporter.line(f"{file} imports {', '.join(names)}: a grader need not have that, and a file that does "
                              "not load there has no points. Keep pictures in the notebook.")
    if config.of_another_copy:
        terminalreporter.line(f"tested: {config.getoption('--of')}, with the tests of {modules.ROOT}")
