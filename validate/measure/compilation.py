"""The time that numba takes to compile one method of ours for one scene, and to load it from its cache.

The races time compiled loops, so a reader must know what comes before them.  Both are times of the processor, because
other programs may run on the machine.
"""

import time

from ..subject import modules
from .races import HEADLINE


def compilation(selection, p, races):
    """Return {"label", "cold", "cached"} [s] of the method that runs our race at the headline's error.

    Return None where plain Python runs it, or where there is no such race.  Both are times of a first run minus that of
    a second one, in a process in which numba runs already.

    cold: with an empty cache;    cached: with all that the method needs in the cache
    """
    ours = next((one["ours"] for one in races if one["level"] == HEADLINE and one["ours"]), None)
    if ours is None or ours["speed"] != "compiled":
        return None
    runner = next(r for r in selection.ours_for(p) if r.label == ours["label"])
    cold, cached = (first_run(compiled.scene(selection.name), runner, p, ours["steps"]) - ours["alone"]
                    for compiled in modules.compiled_twice(selection.plan.of))
    return {"label": runner.label, "cold": max(0.0, cold), "cached": max(0.0, cached)}


def first_run(scene, runner, p, steps):
    """Return the processor's time of the first run of a method, which compiles or loads all that it calls [s]."""
    begin = time.process_time()
    step = getattr(getattr(scene.lessons, runner.who.lesson), runner.who.function)
    scene.run(scene.lessons, step, scene.law, scene.start(p), p, scene.duration / steps, steps)
    return time.process_time() - begin
