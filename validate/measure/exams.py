"""Published benchmarks: the organisers' own error of every method and engine of an exam, its class, and its run time.

A scene is judged over its own time T.  Here the same methods run for as long as the problem asks, and what they observe
at its outputs is judged as the organisers do.
"""

import gc
import time
import warnings
from functools import partial
from statistics import median
from typing import NamedTuple

import numpy as np

from ..check import Role

LONGEST = {True: 0.05, False: 3.0}   # run of a quick validation, and of a full one [s]
REPEATS, ENOUGH = 3, 1.0             # of a timed run, which is repeated so often or for so long [s]
PROBE, LONG_ENOUGH = 2, 0.01         # the length of a run is estimated from so many calls, or more until they last [s]


class Contestant(NamedTuple):
    """A method of ours or an engine in an exam."""
    runner: object
    role: Role
    begin: object            # (dt) → (advance(steps) → what is observed then, close())


def exam_of(selection, p):
    """Return an exam with its results as data, or None: what it is, and the runs of every contestant."""
    exam = selection.scene.exam
    if exam is None:
        return None
    known = {}
    rows = [results(exam, one, partial(reference, selection.scene, exam, p, known), LONGEST[selection.plan.quick])
            for one in contestants(selection, p)]
    return {"organiser": exam.organiser, "problem": exam.problem, "statement": exam.statement, "source": exam.source,
            "duration": exam.duration, "outputs": exam.outputs, "unit": exam.unit, "note": exam.note,
            "classes": exam.grade is not None,
            "published": [list(one) for one in exam.published], "rows": rows}


def reference(scene, exam, p, known):
    """Return what the truth has at the outputs; it is computed when it is first needed, and kept in `known`."""
    if not known:
        times = exam.duration / exam.outputs * np.arange(1, exam.outputs + 1)
        known["truth"] = np.array([scene.truth(p, t) for t in times], dtype=float)
    return known["truth"]


def contestants(selection, p):
    """Yield the methods of ours, at their fastest speed, and the engines that run here."""
    for runner in selection.ours_for(p):
        yield Contestant(runner, Role.OURS, partial(our_run, *selection.fastest(runner), p))
    for runner in selection.engines_for(p):
        if selection.is_live(runner):
            yield Contestant(runner, Role.ENGINE, partial(engine_run, runner.who, p))


def our_run(scene, step, p, dt):
    """Begin a run of one of our methods."""
    state = [scene.start(p)]

    def advance(steps):
        state[0] = scene.run(scene.lessons, step, scene.law, state[0], p, dt, steps)
        return scene.observe(state[0], p)
    return advance, lambda: None


def engine_run(engine, p, dt):
    """Begin a run of an engine."""
    world = engine.make(p, dt)

    def advance(steps):
        for _ in range(steps // engine.substeps):
            world.step()
        return world.read()
    return advance, world.close


def results(exam, one, truth, longest):
    """Return the runs of a contestant, from coarse to fine, until one is good enough or takes too long."""
    about = one.runner.who.product if one.runner.is_engine else one.runner.who
    row = {"label": one.runner.label, "role": one.role, "gives_up": exam.gives_up.get(about, ""), "runs": [],
           "left": ""}
    pace = seconds_per_step(exam, one)
    for steps in exam.steps:
        if pace is None or pace * steps > longest:
            row["left"] = "" if pace is None else f"finer runs were expected to take longer than {longest:g} s each"
            break
        found = judged(exam, one, truth, steps)
        row["runs"].append(found)
        pace = found["seconds"] / steps if found["seconds"] else pace
        if found["error"] is not None and found["error"] <= exam.enough:
            break
    return row


def seconds_per_step(exam, one):
    """Estimate seconds per step from a few steps, after some that compile; None where it cannot begin."""
    try:
        advance, close = one.begin(exam.duration / exam.steps[-1])
        try:
            return per_step(advance, PROBE * getattr(one.runner.who, "substeps", 1), exam.steps[-1])
        finally:
            close()
    except (Exception, SystemExit):                  # a subject's code may do anything; its page says what it did
        return None


def per_step(advance, steps, most):
    """Return the seconds per step of so many steps, or of ever more until they last long enough to be timed."""
    advance(steps)
    while True:
        began = time.perf_counter()
        advance(steps)
        seconds = time.perf_counter() - began
        if seconds >= LONG_ENOUGH or 4 * steps > most:
            return seconds / steps
        steps *= 4


def judged(exam, one, truth, steps):
    """Return {steps, dt, error, grade, seconds, failure} of a run; seconds: the median of a few repeats."""
    found = {"steps": steps, "dt": exam.duration / steps, "error": None, "grade": "", "seconds": None, "failure": ""}
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            timed = [run(exam, one, steps)]
            while len(timed) < REPEATS and len(timed) * timed[0][1] < ENOUGH:
                timed.append(run(exam, one, steps))
    except (Exception, SystemExit) as e:             # a subject's code may do anything: say it, and go on
        return {**found, "failure": str(e).strip().splitlines()[0] if str(e).strip() else type(e).__name__}
    outputs = timed[0][0]
    if not np.all(np.isfinite(outputs)):
        return {**found, "failure": "not finite"}
    error = exam.measure(outputs, truth())
    return {**found, "error": error, "grade": exam.grade(error) if exam.grade else "",
            "seconds": median(seconds for _, seconds in timed)}


def run(exam, one, steps):
    """Return (what is observed at all outputs, seconds) of one run."""
    advance, close = one.begin(exam.duration / steps)
    enabled = gc.isenabled()
    gc.disable()
    try:
        began = time.perf_counter()
        outputs = [advance(steps // exam.outputs) for _ in range(exam.outputs)]
        return np.array(outputs, dtype=float), time.perf_counter() - began
    finally:
        close()
        if enabled:
            gc.enable()
