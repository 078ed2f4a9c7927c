"""Recorded runs of pybullet: its readings at T for every case, setting and step, its run times and its film.

A record also has the numbers of the reference that take seconds.
"""

import json
import platform
from itertools import product

from ..check import jsonable
from ..reference.stored import RECORDED, computed_anew, kept
from ..run.store import whole
from ..scene import PYBULLET
from .accuracy import run_engine_to_end
from .film import FRAMES, engine_frames
from .selection import Plan, can_do, select
from .timing import Timed, interleaved, time_engine

LONGEST = 0.2                # a run that takes longer is not timed [s]


def record(name):
    """Write the record of one scene's pybullet runs; its path, or None for a scene without that engine."""
    selection = select(name, Plan(speeds=(), quick=False))
    scene = selection.scene
    witnesses = [r.who for r in scene.engine_runners if r.who.product == PYBULLET]
    if not witnesses:
        return None
    runs = {case: {r.label: readings(selection, r, p) for r in selection.engines_for(p)
                   if r.who in witnesses and r.who.recorded_as is None}
            for case, p in scene.cases.items()}
    p, shown = scene.parameters, [e for e in witnesses if e.recorded_as is None][-1]
    items = [Timed(e.label, "engine", n, scene.duration / n, time_engine(e, p))
             for e in witnesses if scene.moves for n in scene.steps
             if n <= (e.most_steps or n) and n % e.substeps == 0]
    timed = interleaved(items, {"engine": LONGEST})
    record = {
        "stamp": f"pybullet {PYBULLET.installed()}, {platform.system()} {platform.machine()}, "
                 f"Python {platform.python_version()}",
        "settings": {e.label: e.settings for e in witnesses},
        "runs": runs,
        "seconds": {e.label: [{"steps": i.steps, **t} for i, t in timed if i.label == e.label] for e in witnesses},
        "frames": frames(scene, shown, p) if scene.moves else [],
    }
    if numbers := numbers_of(scene):
        record["numbers"] = numbers
    if agreements := kept(name).get("agreed"):           # which measure/agreement.py computes
        record["agreed"] = agreements
    RECORDED.mkdir(exist_ok=True)
    path = RECORDED / f"{name}.json"
    with whole(path) as draft:
        draft.write_text(json.dumps(jsonable(record), separators=(",", ":")) + "\n")
    return path


def numbers_of(scene):
    """Return {key: number}: what `stored` computes for the limits of all cases, at the coarsest step."""
    with computed_anew() as found:
        for runner, p in product(scene.runners, scene.cases.values()):
            if can_do(runner, p):
                runner.largest_error(p, scene.duration / scene.steps[0])
    return found


def readings(selection, runner, p):
    """Return what the engine reads at T, for each number of steps, and what the laws of contact say of its run."""
    found = []
    for steps in selection.steps:
        if steps <= (runner.who.most_steps or steps):
            outcome = run_engine_to_end(selection.scene, runner.who, p, steps, runner.judged_by(p, steps))
            found.append({"steps": steps, "observed": outcome.observed, "failure": outcome.failure,
                          **({"laws": outcome.laws} if outcome.laws else {})})
    return found


def frames(scene, engine, p):
    """Return the engine's film in drawing coordinates."""
    per_frame = max(1, scene.steps[-3] // FRAMES)
    film = engine_frames(engine, p, (scene.film_seconds or scene.duration) / (per_frame * FRAMES), per_frame)
    return [scene.points(observed, p).tolist() for observed in film]
