"""Plant a fault in a copy of the lessons, and find the verdict or the finding of the report that it turns.

Only the scenes and stability cases that execute the function run, those first that are most likely to notice.  Of a
scene only the methods run that call the function, on a sweep that grows finer; no engine runs, and nothing is timed.
A verdict has turned if it is DEPARTS where the same sweep of the worked answers is not, a finding if it does not hold.
"""

import importlib
import shutil
import tempfile
import time
import types
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from validate.check import Verdict
from validate.measure.accuracy import our_curve
from validate.measure.selection import Plan, select
from validate.run import coverage
from validate.stability.examine import all_cases, broken_off, examine
from validate.subject import modules, numba_twins
from validate.subject.loading import TooLong, alarm

from . import file_of, planted

SWEEPS = (300, 1000, 5000)   # most steps of a run, before all of them: a coarse sweep often shows the fault
SECONDS = {}                 # of the places that have run in this process: quick ones are asked first
OWN = {}                     # {function of a given module: its own code}, while it has another
LIMITS = {"plain": 40.0, "compiled": 120.0}  # of one place, on the processor; what plain Python leaves is compiled [s]


class Notice(NamedTuple):
    """What became of a fault."""
    turned: str              # the verdict or the finding that turned; empty: none did
    place: str               # the scene or stability case
    seconds: float           # until then
    tried: list              # the places that ran


@contextmanager
def copy_with(texts):
    """A temporary copy of solutions/ in which some modules have another text: {lesson or given module: text}.

    What is compiled meanwhile goes with it, so that it does not crowd out compiled code that will be used again.
    Cases and scenes call the given modules themselves.  While this lasts, the functions of these modules have the code
    of that text.
    """
    cache = numba_twins.CACHE
    with tempfile.TemporaryDirectory(prefix="fault-") as folder:
        copy, numba_twins.CACHE = Path(folder) / "lessons", Path(folder) / "compiled"
        shutil.copytree(modules.SOLUTIONS, copy, ignore=shutil.ignore_patterns("__pycache__"))
        for lesson, text in texts.items():
            (copy / file_of(lesson)).write_text(text, encoding="utf-8")
            if is_given(lesson):
                OWN.update(replaced(codes_of(lesson, text)))
        try:
            yield copy
        finally:
            replaced(OWN)
            OWN.clear()
            numba_twins.CACHE = cache


def codes_of(module, text):
    """{function of a given module: its code in another text}."""
    ours = vars(importlib.import_module(f"solutions.{module}"))
    codes = [code for code in compile(text, module, "exec").co_consts if isinstance(code, types.CodeType)]
    return {ours[code.co_name]: code for code in codes if isinstance(ours.get(code.co_name), types.FunctionType)}


def replaced(codes):
    """Give functions other code; return {function: the code that it had}."""
    before = {function: function.__code__ for function in codes}
    for function, code in codes.items():
        function.__code__ = code
    return before


def is_given(module):
    """Whether this is a given module, and not a lesson."""
    return module not in modules.lesson_names()


def notice(fault, first="", finest=np.inf):
    """The Notice of a fault; `first` is the place that is asked first, and no scene runs with more than `finest` steps.
    """
    began, tried = time.monotonic(), []
    with copy_with({fault.lesson: planted(fault)}) as copy:
        places = coverage.places()[fault.lesson, fault.function]
        for most in (*(most for most in SWEEPS if most < finest), finest):
            for place in sorted(places, key=lambda place: rank(place, fault, first)):
                if most > min(SWEEPS[0], finest) and place.startswith(coverage.STABILITY):
                    continue                                         # it has no sweep, and has already run
                tried.append(place)
                speeds = ("plain",) if is_given(fault.lesson) else tuple(LIMITS)
                turned = turned_at(place, copy, (fault.lesson, fault.function), most, speeds)
                if turned:
                    return Notice(turned, place, time.monotonic() - began, sorted(set(tried)))
    return Notice("", "", time.monotonic() - began, sorted(set(tried)))


def rank(place, fault, first):
    """Places of the lesson itself before those of later lessons; those that name the function first, and quick ones."""
    roots = roots_of(place)
    near = coverage.defined((fault.lesson, fault.function)) in {coverage.defined(root) for root in roots}
    own = any(lesson == fault.lesson.removeprefix("given.") for lesson, _ in roots)
    slow = SECONDS.get(place, 0.0) // 1.0
    return place != first, not own, not near, slow, not place.startswith(coverage.STABILITY), place


@cache
def roots_of(place):
    """What a scene or a stability case names of the lessons."""
    case = stability_case(place)
    return coverage.roots_of_case(case) if case else coverage.roots_of_scene(place)


def stability_case(place):
    """The stability case of that place; None for a scene."""
    return next((c for c in all_cases() if place == f"{coverage.STABILITY}{c.lesson}/{c.slug}"), None)


def turned_at(place, of, function=None, most=np.inf, speeds=tuple(LIMITS)):
    """What of that place turns with the lessons of a folder, in a few words; empty where nothing does.

    The first speed that ends within its time limit decides; None where none does.
    """
    case, began = stability_case(place), time.monotonic()
    for speed in speeds:
        compiled = speed == "compiled"
        if compiled and not (modules.can_compile() and (case is None or case.compiled)):
            continue
        try:
            with alarm(LIMITS[speed], own=True):
                if case:
                    return turned_finding(case, of, compiled)
                return turned_verdict(place, of, function, most, compiled)
        except TooLong:
            continue
        finally:
            SECONDS[place] = time.monotonic() - began
    return None


def turned_finding(case, of, compiled=False):
    """The first finding of a stability case that does not hold."""
    try:
        findings = examine(case, of, compiled).findings
    except (Exception, SystemExit) as e:                             # as in stability_cases
        findings = broken_off(case, e).findings
    return next((f"{f.quantity}: {f.measured:.6g}, predicted {f.predicted:.6g}" for f in findings if not f.holds), "")


def turned_verdict(name, of, function=None, most=np.inf, compiled=False):
    """The first verdict of a scene that is DEPARTS, and is not with the worked answers."""
    plan = Plan(of=str(of), speeds=("compiled",) if compiled else ("plain",), live=())
    selection = shortened(select(name, plan), most)
    for case, p in selection.cases.items():
        truth = np.array(selection.scene.truth(p, selection.scene.duration), dtype=float)
        for runner in selection.ours_for(p):
            if function and not runs(name, runner.who, function):
                continue
            curve = our_curve(selection, runner, p, truth)
            honest = (name, case, runner.who.function, most, compiled)
            if curve["verdict"] is Verdict.DEPARTS and worked(*honest) is not Verdict.DEPARTS:
                return f"{case}, {runner.label}: {curve['message']}"
    return ""


def shortened(selection, most):
    """The same with no more than so many steps, but with the three coarsest of the scene's own sweep."""
    few = selection.scene.steps[:3]
    return selection._replace(steps=tuple(n for n in selection.steps if n <= max(most, *few)))


@cache
def worked(name, case, method, most, compiled):
    """The verdict on a method of the worked answers, on the same sweep."""
    faulty = replaced(OWN)
    try:
        selection = shortened(select(name, Plan(speeds=("compiled",) if compiled else ("plain",), live=())), most)
        p = selection.cases[case]
        truth = np.array(selection.scene.truth(p, selection.scene.duration), dtype=float)
        runner = next(r for r in selection.ours_for(p) if r.who.function == method)
        return our_curve(selection, runner, p, truth)["verdict"]
    finally:
        replaced(faulty)


@cache
def runs(name, method, function):
    """Whether a method of a scene executes a function, or everything in the scene does."""
    ours = {(r.who.lesson, r.who.function) for r in bound(name).our_runners}
    return function_in(coverage.reached({(method.lesson, method.function)}), function) or function_in(
        coverage.reached(coverage.roots_of_scene(name) - ours), function)


def function_in(places, function):
    return coverage.defined(function) in places


@cache
def bound(name):
    return modules.bind_scene(name)
