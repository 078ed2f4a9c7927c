"""What comes before the timed loops: an engine's world is built, and the calls of our run are checked and looked up."""

import time

import numpy as np

from .races import HEADLINE
from .rehearsal import rehearsed
from .selection import REPEATS
from .timing import SHORT

LOOPS = 100                  # runs of ours in one repeat


def preparations(selection, p, races):
    """Return [{label, seconds, with, without}] for both sides of the races at the headline's error.

    seconds  of an engine, to build its world; of a compiled method of ours, its checks and look-ups in one run [s].
             A run that is not SHORT hides them, and has no record.
    with     repeats of what was timed: the building, or a run that checks and looks up [s]
    without  repeats of the same run after its rehearsal; empty for an engine [s]
    """
    at = [one for one in races if one["level"] == HEADLINE and one["ratio"]]
    engines = {one["engine"]["label"]: one["engine"]["steps"] for one in at}
    ours = {one["ours"]["label"]: one["ours"]["steps"] for one in at
            if one["ours"]["speed"] == "compiled" and one["ours"]["alone"] < SHORT}
    found = [built(r, p, selection.scene.duration / engines[r.label])
             for r in selection.engines_for(p) if r.label in engines]
    return found + [looked_up(selection, r, p, ours[r.label]) for r in selection.ours_for(p) if r.label in ours]


def built(runner, p, dt):
    """Return the record of an engine."""
    seconds = []
    for _ in range(REPEATS):
        begin = time.perf_counter()
        world = runner.who.make(p, dt)
        seconds.append(time.perf_counter() - begin)
        world.close()
    return {"label": runner.label, "seconds": float(np.median(seconds)), "with": seconds, "without": []}


def looked_up(selection, runner, p, steps):
    """Return the record of a compiled method of ours; the two kinds of runs take turns."""
    scene, step = selection.bound(runner, "compiled")
    arguments = scene.law, scene.start(p), p, scene.duration / steps, steps
    ready = rehearsed(scene.lessons, step, lambda *of_lessons: scene.run(*of_lessons, *arguments))
    checking, at_once = [], []
    for _ in range(REPEATS):
        for of_lessons, seconds in (((scene.lessons, step), checking), (ready, at_once)):
            begin = time.perf_counter()
            for _ in range(LOOPS):
                scene.run(*of_lessons, *arguments)
            seconds.append((time.perf_counter() - begin) / LOOPS)
    return {"label": runner.label, "seconds": max(0.0, float(np.median(checking) - np.median(at_once))),
            "with": checking, "without": at_once}
