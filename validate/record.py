"""Keep what pybullet did: its readings at T for every case, setting and step, and its run times, stamped with versions."""

import json
import platform

from . import binding, engines, measure
from .store import whole


def record(name):
    """Write the traces of one scene's pybullet runs; the path, or None for a scene without that engine."""
    scene = binding.bind_scene(name)
    witnesses = [e for e in scene.ENGINES if e.label.startswith("pybullet")]
    if not witnesses:
        return None
    runs = {case: {e.label: [_reading(scene, e, p, n) for n in measure.sweep(scene) if n <= (e.most_steps or n)]
                   for e in witnesses if measure.can(scene, e.label, p)} for case, p in scene.CASES.items()}
    p, moves = next(iter(scene.CASES.values())), measure.still(scene) is None
    items = [measure.Timed(e.label, "engine", n, scene.T / n, measure._engine(e, p))
             for e in witnesses if moves for n in scene.STEPS if n <= (e.most_steps or n)]
    timed = measure.interleaved(items, {"engine": 0.2})
    trace = {
        "stamp": f"pybullet {engines.installed('pybullet')}, {platform.system()} {platform.machine()}, Python {platform.python_version()}",
        "settings": {e.label: e.settings for e in witnesses},
        "runs": runs,
        "seconds": {e.label: [{"steps": i.steps, **t} for i, t in timed if i.label == e.label] for e in witnesses},
        "frames": _film(scene, witnesses[-1], p) if moves else [],
    }
    measure.RECORDED.mkdir(exist_ok=True)
    path = measure.RECORDED / f"{name}.json"
    with whole(path) as draft:
        draft.write_text(json.dumps(measure.jsonable(trace), separators=(",", ":")) + "\n")
    return path


def _film(scene, engine, p):
    per_frame = max(1, scene.STEPS[-3] // measure.FRAMES)
    film = measure.engine_frames(engine, p, getattr(scene, "FILM", scene.T) / (per_frame * measure.FRAMES), per_frame)
    return [scene.points(observed, p).tolist() for observed in film]


def _reading(scene, engine, p, steps):
    observed, failure = measure.engine_final(scene, engine, p, steps)
    return {"steps": steps, "observed": None if observed is None else observed, "failure": failure}
