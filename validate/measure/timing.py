"""Error against run time.

Only the stepping loop is timed: two warm-ups, then nine interleaved repeats with garbage collection off.  An engine's
world is built before the clock starts; in the same way a compiled loop of ours is rehearsed.  A loop of ours that is
shorter than a tenth of a millisecond is repeated inside the clock.  Before each repeat of a loop of less than a
millisecond, ours or an engine's, the loop runs once without the clock: otherwise one that follows a long loop would be
timed with the long one's data in the caches.  A loop that takes longer than 40 ms is warmed up once and repeated seven
times.  A long loop in plain Python, which decides no race, is repeated less often.  Errors come from separate,
identical runs.
"""

import gc
import os
import time
import warnings
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..check import Verdict, jsonable
from ..subject.numba_twins import CachedDispatch
from . import traces
from .accuracy import labels_that_agree, relative
from .calls import costs_of_calls
from .races import races, reach
from .rehearsal import rehearsed
from .selection import REPEATS, select, with_overrides

WARM_UPS, PROBE = 2, 64
LOST = 10.0                  # a run with a larger relative error is not worth timing [-]
SAME = 1e-9                  # relative difference of two motions that count as the same [-]
LONG, LONG_REPEATS = 0.04, 7         # a timed loop that takes longer [s] is warmed up once, and repeated so often
ENOUGH = 0.3                 # a loop in plain Python is repeated for this long, or REPEATS times [s]
LEAST_REPEATS = 3            # fewest repeats of such a loop [-]
SHORTEST = 1e-4              # a timed loop is repeated until it lasts this long [s]
SHORT = 1e-3                 # before each repeat of a shorter loop [s] it runs once without the clock
SHORTEST_LOOK = 0.1          # the system counts hundredths of a second: a shorter look at them is no measurement [s]
TARGETS = (1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8)


class Timed(NamedTuple):
    """Something with a stepping loop."""
    label: str
    speed: str               # plain, compiled, engine
    steps: int
    dt: float                # [s]
    prepare: object          # (steps, dt) → (the function to time, what to do after)


@with_overrides
def times(name, plan, result):
    """Return the run times of the first case with the errors found before, and what follows from them.

    The rows are [{label, speed, steps, error, seconds, low, high, repeats}].
    """
    selection = select(name, plan)
    scene, (case, p) = selection.scene, selection.first
    found = worth_timing(selection, result["cases"][case])
    items = []
    if scene.refined:                                                # else there is no diagram to time anything for
        items = [*our_items(selection, p, found), *engine_items(selection, p, found)]
    before = cpu_seconds()
    timed = [(i.label, i.speed, i.steps, t) for i, t in interleaved(items, plan.time_limits(), plan.repeats())]
    others = used_by_others(before, cpu_seconds())
    timed += recorded_times(selection, case, p)
    rows = [{**t, "label": label, "speed": speed, "steps": n, "error": found[label][n]["error"]}
            for label, speed, n, t in timed if n in found[label]]
    done = {(r["label"], r["speed"]) for r in rows}
    calls = costs_of_calls(plan.live) if items else []
    return jsonable({
        "rows": rows,
        "untimed": list(dict.fromkeys(f"{i.label} ({i.speed})" for i in items if (i.label, i.speed) not in done)),
        "calls": calls,
        "load": os.getloadavg() if hasattr(os, "getloadavg") else None,
        "others": others if items else None,
        "time_to_error": times_to_error(rows),
        "races": races(rows, result["cases"][case], [product.name for product in plan.live], plan.quick, calls)
                 if items else [],
        "ablations": ablations(selection, p, result),
    })


def worth_timing(selection, case):
    """Return {label: {steps: row}} of the runs that are worth timing.

    Lost runs are not.  A quick run times every second one of the sweep, from the finest, but both where there are two.
    """
    every = {c["label"]: [r for r in c["rows"] if r["error"] is not None and r["error"] < LOST]
             for c in case["ours"] + case["engines"]}
    if selection.plan.quick and not selection.plan.most_steps:
        swept = {label: [r for r in rows if r["steps"] in selection.scene.steps] for label, rows in every.items()}
        every = {label: rows if len(rows) < 3 else rows[::-2][::-1] for label, rows in swept.items()}
    return {label: {r["steps"]: r for r in rows} for label, rows in every.items()}


def our_items(selection, p, found):
    """Yield what to time of our own methods, at each speed."""
    for runner in selection.ours_for(p):
        for speed in selection.speeds(runner) if found[runner.label] else ():      # a lost start cannot be prepared
            prepare = time_ours(*selection.bound(runner, speed), p)
            for n in found[runner.label]:
                yield Timed(runner.label, speed, n, selection.scene.duration / n, prepare)


def engine_items(selection, p, found):
    """Yield what to time of the engines that are installed."""
    for runner in selection.engines_for(p):
        if selection.is_live(runner):
            for n in found[runner.label]:
                yield Timed(runner.label, "engine", n, selection.scene.duration / n, time_engine(runner.who, p))


def recorded_times(selection, case, p):
    """Return [(label, "recorded", steps, times)] of the engines that are not installed."""
    return [(r.label, "recorded", row["steps"], row) for r in selection.engines_for(p) if not selection.is_live(r)
            for row in (traces.recorded(selection.name, case, r.who) or {}).get("seconds") or []]


def time_ours(scene, step, p, state=None):
    """Return prepare(steps, dt) for one of our methods; if it is compiled, its first run of so many steps rehearses."""
    state, ready = state or scene.start(p), {}

    def prepare(steps, dt):
        arguments = scene.law, state, p, dt, steps
        if steps not in ready:
            ready[steps] = (rehearsed(scene.lessons, step, lambda *of_lessons: scene.run(*of_lessons, *arguments))
                            if isinstance(step, CachedDispatch) else (scene.lessons, step))
        arguments = *ready[steps], *arguments
        return lambda: scene.run(*arguments), lambda: None
    return prepare


def time_engine(engine, p):
    """Return prepare(steps, dt) for an engine."""
    def prepare(steps, dt):
        world = engine.make(p, dt)

        def loop():
            step = world.step
            for _ in range(steps // engine.substeps):
                step()
        return loop, world.close
    return prepare


# ---------------------------------------------------------------------------------------------- a busy machine

def cpu_seconds():
    """Return (clock, busy seconds of all cores, seconds of this process) [s].

    None if the system does not report them.
    """
    try:
        counts = list(map(int, Path("/proc/stat").read_text(encoding="utf-8").splitlines()[0].split()[1:]))
    except (OSError, ValueError):
        return None
    ticks = sum(counts[:8]) - sum(counts[3:5])           # but for the two kinds of idling
    return time.perf_counter(), ticks / os.sysconf("SC_CLK_TCK"), time.process_time()


def used_by_others(before, after):
    """Return how many cores other programs used in between; None if unknown, or if the time is too short to tell."""
    if before is None or after is None or after[0] - before[0] < SHORTEST_LOOK:
        return None
    clock, all_cores, own = (b - a for a, b in zip(before, after))
    return max(0.0, (all_cores - own) / clock)


# ---------------------------------------------------------------------------------------------- the clock

def interleaved(items, time_limits, repeats=REPEATS):
    """Return [(item, {seconds, low, high, repeats})]: medians of interleaved repeats, their intervals, and all of them.

    Runs longer than `time_limits[speed]` are left out.
    """
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        chosen = short_enough(items, time_limits)
        samples = [[] for _ in chosen]
        enabled = gc.isenabled()
        gc.disable()
        try:
            for lap in range(repeats):
                for (item, inner, seconds), sample in zip(chosen, samples):
                    if is_due(item.speed, lap, seconds):
                        if seconds < SHORT:
                            clock(item, 1)
                        sample.append(clock(item, inner))
        finally:
            if enabled:
                gc.enable()
    return [(item, {"seconds": float(np.median(s)), **interval(s), "repeats": s})
            for (item, *_), s in zip(chosen, samples)]


def is_due(speed, laps, seconds):
    """Return whether a loop that takes `seconds` is timed once more after so many laps."""
    if speed == "plain" and laps >= LEAST_REPEATS and laps * seconds >= ENOUGH:
        return False
    return laps < LONG_REPEATS or seconds <= LONG


def interval(repeats):
    """Return {"low", "high"}: ends between which the median of many more repeats lies, with a chance of 96 %.

    Of nine repeats these are the second and the eighth by size: 1 − 2 (1 + 9)/2⁹.  Of fewer they are the first and the
    last, for seven with a chance of 1 − 2/2⁷, 98 %.  This holds for any distribution.
    *Source:* the sign test.
    """
    ordered = sorted(repeats)
    skip = 1 if len(ordered) >= REPEATS else 0
    return {"low": ordered[skip], "high": ordered[-1 - skip]}


def short_enough(items, time_limits):
    """Return [(item, repeats inside the clock, seconds)] of the items that do not take too long, warmed up."""
    chosen, pace = [], {}                                            # pace: {(label, speed): seconds per step}
    for item in items:
        key = item.label, item.speed
        first = all((i.label, i.speed) != key for i, *_ in chosen)
        limit = time_limits[item.speed] * (3.0 if first else 1.0)    # or a slow one would not be there at all
        if key not in pace:
            pace[key] = seconds_per_step(item, limit)
        if pace[key] * item.steps > limit:
            continue
        seconds = min(clock(item, 1) for _ in range(1 if pace[key] * item.steps > LONG else WARM_UPS))
        pace[key] = seconds / item.steps
        chosen.append((item, 1 if item.speed == "engine" else max(1, int(SHORTEST / max(seconds, 1e-9))), seconds))
    return chosen


def seconds_per_step(item, limit):
    """Estimate seconds per step from two steps.

    If that cannot tell whether the run exceeds `limit`, time 64 steps, because call overhead dominates two.
    """
    pace = min(clock(item, 1, steps=2) for _ in range(2)) / 2
    if PROBE < item.steps and limit / item.steps < pace < limit / PROBE:
        pace = min(clock(item, 1, steps=PROBE) for _ in range(2)) / PROBE
    return pace


def clock(item, inner, steps=None):
    """Return seconds of one stepping loop, or of its first steps."""
    loop, close = item.prepare(steps or item.steps, item.dt)
    try:
        begin = time.perf_counter()
        for _ in range(inner):
            loop()
        return (time.perf_counter() - begin) / inner
    finally:
        close()


# ---------------------------------------------------------------------------------------------- ablations

def ablations(selection, p, result):
    """Return [{what, cost: ratio of times with it included, same: the motion is unchanged, note}] for omitted parts."""
    agreeing = labels_that_agree(result)
    scene = selection.scene
    runner = min((r for r in scene.our_runners if r.label in agreeing), key=selection.rank, default=None)
    if runner is None:
        verdicts = {Verdict(c["verdict"]) for c in next(iter(result["cases"].values()))["ours"]}
        none = ("no method of this scene is written yet" if verdicts == {Verdict.NOT_ATTEMPTED} else
                "no method of ours agrees with the truth here")
        return [unpriced(what, extra if isinstance(extra, str) else none) for what, extra in scene.ablations.items()]
    speed = selection.speeds(runner)[-1]
    bound, step = selection.bound(runner, speed)
    steps = scene.steps[min(2, len(scene.steps) - 1)] if speed == "compiled" else scene.steps[0]
    rows = []
    for what, extra in scene.ablations.items():
        if isinstance(extra, str):
            rows.append(unpriced(what, extra))
        else:
            rows.append(with_and_without(bound, step, speed, steps, selection.plan.repeats(), p, what, *extra(p)))
    return rows


def unpriced(what, note):
    """Return the row of an omitted part that is not timed, for the reason `note`."""
    return {"what": what, "cost": None, "same": None, "note": note, "observed": None, "repeats": None}


def with_and_without(scene, step, speed, steps, repeats, p, what, state, p_full):
    """Return what it costs to put one omitted thing in, and whether the motion stays the same."""
    dt = scene.duration / steps
    items = [Timed(which, speed, steps, dt, time_ours(scene, step, *begin))
             for which, *begin in (("without", p), ("with", p_full, state))]
    (_, lean), (_, full) = interleaved(items, {speed: np.inf}, repeats)
    a = scene.observe(scene.run(scene.lessons, step, scene.law, scene.start(p), p, dt, steps), p)
    b = scene.observe(scene.run(scene.lessons, step, scene.law, state, p_full, dt, steps), p)
    return {"what": what, "cost": full["seconds"] / lean["seconds"], "same": relative(a, b) < SAME, "note": "",
            "observed": (a, b), "repeats": (full["repeats"], lean["repeats"])}


# ---------------------------------------------------------------------------------------------- reading the diagram

def times_to_error(rows):
    """Return [{label, speed, seconds}]: times of each curve to the TARGETS, None where its runs do not get there."""
    groups = {}
    for row in rows:
        groups.setdefault((row["label"], row["speed"]), []).append(row)
    reached = {key: [reach(group, target) for target in TARGETS] for key, group in groups.items()}
    return [{"label": label, "speed": speed, "seconds": [one and one.seconds for one in found]}
            for (label, speed), found in reached.items()]
