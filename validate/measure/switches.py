"""Cost and effect of an engine's own parts in a scene: each is switched off in turn."""

import numpy as np

from ..check import jsonable
from ..engines.switches import worlds_made
from .accuracy import relative, run_engine_to_end
from .timing import Timed, interleaved, time_engine

LEAST = 50                   # steps of a run


def engine_parts(selection, p):
    """Return the cost of each part of the first settings of each engine that runs.

    [{engine, product, part, steps, cost, change, observed, repeats}]
    cost: time with the part over time without it;    change: relative change of the observed quantities without it, or
    None if the run is lost.  Nothing is measured if an engine makes its worlds only when it is read.
    """
    scene = selection.scene
    if not (scene.moves and scene.refined):
        return []
    steps = next((n for n in scene.steps if n >= LEAST), scene.steps[-1])
    first = {}
    for runner in selection.engines_for(p):
        if selection.is_live(runner):
            first.setdefault(runner.who.product, runner.who)
    return [with_and_without(scene, engine, switch, p, steps, selection.plan.repeats())
            for engine in first.values() for switch in switches_of(engine, p, scene.duration / steps)]


def switches_of(engine, p, dt):
    """Return the switches of what the worlds of this engine have."""
    found = []
    for switch in engine.product.adapter.SWITCHES:
        with worlds_made() as worlds:
            run = engine.make(p, dt)
        if any(switch.off(world) for world in worlds):
            found.append(switch)
        run.close()
    return found


def without(engine, switch):
    """Return the same engine without one of its parts."""
    def make(p, dt):
        with worlds_made() as worlds:
            run = engine.make(p, dt)
        for world in worlds:
            switch.off(world)
        return run
    return engine._replace(make=make)


def with_and_without(scene, engine, switch, p, steps, repeats):
    """Return what one part of an engine costs, and what changes without it."""
    lean_engine, dt = without(engine, switch), scene.duration / steps
    items = [Timed(which, "engine", steps, dt, time_engine(one, p))
             for which, one in (("with", engine), ("without", lean_engine))]
    (_, full), (_, lean) = interleaved(items, {"engine": np.inf}, repeats)
    observed = [run_engine_to_end(scene, one, p, steps).observed for one in (engine, lean_engine)]
    lost = any(values is None for values in observed)
    return jsonable({
        "engine": engine.label, "product": engine.product.name, "part": switch.part, "steps": steps,
        "cost": full["seconds"] / lean["seconds"], "change": None if lost else relative(observed[1], observed[0]),
        "observed": observed, "repeats": (full["repeats"], lean["repeats"]),
    })
