"""Hold one scene against its truth: errors, orders, verdicts; then error against run time.

Errors and times come from separate, identical runs.  Only the stepping loop is timed: two warm-ups, then interleaved
repeats with garbage collection off; a loop shorter than a tenth of a millisecond is repeated inside the clock.
"""

import gc
import inspect
import time
import warnings
from contextlib import contextmanager
from functools import wraps
from pathlib import Path
from typing import NamedTuple

import numpy as np

from solutions.checks import BadInput

from . import binding, engines, stability
from .scene import EXACT, ROUND_OFF
from .store import read_whole

RECORDED = Path(__file__).resolve().parent / "recorded"
WARM_UPS, REPEATS, PROBE = 2, 7, 64
ASYMPTOTIC = 0.5             # limits above this are not held against a run [-]
EXACTLY = 1e-11              # a smaller relative error is round-off: there is no race for it [-]
LOST = 10.0                  # a run with a larger relative error is not worth timing [-]
SHORTEST = 1e-4              # a timed loop is repeated until it lasts this long [s]
NOTEBOOK = 0.02              # how long a timed run in a notebook may take [s]
FRAMES = 120                 # of the moving picture
NOT_ATTEMPTED = "not attempted"
TARGETS = (1e-2, 1e-3, 1e-4, 1e-6, 1e-8)


class Plan(NamedTuple):
    """How much to measure."""
    of: str = "solutions"
    speeds: tuple = ("plain", "compiled")
    quick: bool = True
    live: tuple = ("pymunk", "pybullet")     # engines installed here; the others come from their records
    overrides: tuple = ()                    # (name, value) pairs that replace parameters of the first case
    most_steps: int | None = None            # for a notebook: a shorter sweep, of the first case only

    def longest(self):
        """{speed: how long a single timed run may take [s]}; longer ones are left to --full, and there out."""
        ours, engine = (NOTEBOOK, NOTEBOOK) if self.most_steps else (0.003, 0.01) if self.quick else (0.5, 1.5)
        return {"plain": ours, "compiled": ours, "engine": engine}

    def repeats(self):
        """How often each run is timed: seldomer where somebody waits."""
        return 3 if self.most_steps else REPEATS


def load(name, of):
    """Load a scene with those answers.  Raises BadInput when one of them does not load."""
    binding.bind_scene(name, of)


@contextmanager
def changed(name, changes):
    """In the block a scene runs with these parameters: numbers may overflow without a warning, and what it cannot compute ends in BadInput."""
    if not changes:
        yield
        return
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            yield
    except (BadInput, OSError):
        raise
    except Exception as e:                                           # a truth, a bound or an engine is made for parameters near the scene's own
        values = ", ".join(f"{parameter} = {value}" for parameter, value in changes)
        raise BadInput(f"scene {name} with {values}", f"not computable ({type(e).__name__}: {e})", "choose a value nearer to the scene's own") from None


def with_overrides(measuring):
    """The same, in such a block."""
    @wraps(measuring)
    def measured(name, plan, *more):
        with changed(name, plan.overrides):
            return measuring(name, plan, *more)
    return measured


# ---------------------------------------------------------------------------------------------- running a scene

def final(scene, step, p, steps):
    """What our method observes at T, or why it could not."""
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            observed = scene.observe(scene.run(step, scene.law, scene.start(p), p, scene.T / steps, steps), p)
    except ArithmeticError as e:
        return None, str(e)
    except np.linalg.LinAlgError as e:
        return None, f"Newton's matrix is singular: {e}"
    except NotImplementedError as e:
        return None, f"{NOT_ATTEMPTED}: {e}"
    except BadInput:
        raise
    except Exception as e:                                           # a subject's code may do anything: say it, and go on
        return None, f"{type(e).__name__}: {str(e).strip().splitlines()[0] if str(e).strip() else ''}"
    return (observed, None) if np.all(np.isfinite(observed)) else (None, "not finite")


def engine_final(scene, engine, p, steps):
    """What an engine reads after so many steps."""
    world = engine.make(p, scene.T / steps)
    try:
        for _ in range(steps):
            world.step()
        observed = np.array(world.read(), dtype=float)
    finally:
        world.close()
    return (observed, None) if np.all(np.isfinite(observed)) else (None, "not finite")


def relative(observed, truth):
    """|observed − truth| / |truth|, Euclidean norms over everything observed; absolute where the truth is zero."""
    size = np.linalg.norm(truth)
    return float(np.linalg.norm(observed - truth) / (size if size > 0.0 else 1.0))


def curve(scene, label, p, truth, runs, order, limits):
    """Errors over the sweep, the order they show, and the verdict on them.

    A limit holds where it is small: an expansion in powers of dt says nothing about a step at which it promises 50 %.  An order is
    held against a run that has two steps where it does.
    """
    rows, worst = [], None
    for steps, (observed, failure) in runs:
        error = None if failure else relative(observed, truth)
        limit = limits(steps)
        rows.append({"steps": steps, "dt": scene.T / steps, "error": error, "limit": limit, "failure": failure})
        if error is not None and limit < ASYMPTOTIC:
            worst = max(worst or 0.0, error / limit)
    shown = shown_order(rows, 10.0 * scene.UNCERTAINTY)
    finest = rows[-1]
    if finest["failure"] and finest["failure"].startswith(NOT_ATTEMPTED):
        right, why = None, finest["failure"]
    elif finest["failure"]:
        right, why = False, f"fails at the finest step: {finest['failure']}"
    elif worst is None:
        right, why = None, "the sweep is too coarse to judge: theory allows 50 % at its finest step"
    elif worst > 1.0:
        right, why = False, f"departs from truth by {worst:.3g} times what theory allows"
    elif order in (1, 2, 4) and shown is not None and shown < order - 0.3 and sum(r["limit"] < ASYMPTOTIC for r in rows) >= 2:
        right, why = False, f"converges with order {shown:.2f}, theory says {order}"
    else:
        right, why = True, ""
    return {"label": label, "rows": rows, "order": shown, "expected": order, "right": right, "why": why}


def shown_order(rows, floor):
    """Order over the finest four runs that are clear of truth's uncertainty and of round-off; None if there are fewer than three.

    Runs before one that was lost do not count: what they have right they have by luck.
    """
    lost = [k for k, r in enumerate(rows) if r["error"] is None or r["error"] >= ASYMPTOTIC]
    clear = [(r["dt"], r["error"]) for r in rows[lost[-1] + 1 if lost else 0:]
             if r["error"] > max(1e-11 + floor, 100.0 * ROUND_OFF * r["steps"])]
    return float(np.polyfit(*np.log(clear[-4:]).T, 1)[0]) if len(clear) >= 3 else None


# ---------------------------------------------------------------------------------------------- errors

@with_overrides
def errors(name, plan):
    """Everything about a scene but its run times: a dict that JSON can hold."""
    scene = binding.bind_scene(name, plan.of)
    cases = {}
    for case, p in cases_of(scene, plan).items():
        asked = not cases or not plan.quick or still(scene) is not None       # moving ones ask engines for other cases in a full validation only
        truth = np.array(scene.truth(p, scene.T), dtype=float)
        ours = []
        for method in methods_of(scene, plan, p):
            order = getattr(scene, "ORDERS", {}).get(method.function, method.order)
            fast, step = at_speed(name, plan, method, speeds_of(scene, plan, method)[-1])
            runs = [(n, final(fast, step, p, n)) for n in sweep(scene, plan)]
            ours.append(judged(scene, method.label, p, truth, runs, order))
            if still(scene) is not None:
                ours[-1]["observed"] = [{"steps": n, "observed": o, "failure": f} for n, (o, f) in runs]
        cases[case] = {"params": p._asdict() if hasattr(p, "_asdict") else {}, "truth": truth.tolist(), "ours": ours,
                       "quantities": scene.QUANTITIES(p) if hasattr(scene, "QUANTITIES") else [],
                       "engines": [engine_curve(name, scene, case, e, p, truth, plan) for e in engines_of(scene, p)] if asked else []}
    first = next(iter(cases_of(scene, plan).values()))
    agreeing = usable({"cases": cases})
    return jsonable({
        "scene": name, "still": still(scene), "title": scene.TITLE, "lesson": scene.LESSON, "story": said_of(scene), "T": scene.T,
        "uncertainty": scene.UNCERTAINTY, "truth_story": said_of(scene.truth), "needs": list(scene.NEEDS),
        "without": not_run(scene, plan), "cases": cases, "parity": parity(name, scene, plan, first), "picture": picture(name, scene, plan, first, agreeing),
        "law": said_of(scene.acceleration) if hasattr(scene, "acceleration") else "", "limits": said_of(scene.tolerance),
    })


def said_of(thing):
    """Its docstring, without what only the makers of lessons read."""
    return (inspect.getdoc(thing) or "").removeprefix("Given.").replace("*Source:*", "Source:").replace("*Left out:*", "Left out:").strip()


def still(scene):
    """None where something moves; else what the scene refines instead of a step, in words: "" when nothing."""
    return getattr(scene, "STILL", None)


def can(scene, name, p):
    """Whether a method or an engine of the scene can do this case; without a case, whether it is there at all."""
    return p is None or not hasattr(scene, "CAN") or scene.CAN(name, p)


def methods_of(scene, plan, p=None):
    """The methods to run on a case; those that the scene finds too slow for a quick validation only in a full one, none without a speed."""
    if not plan.speeds:
        return ()
    slow = getattr(scene, "FULL_ONLY", ()) if plan.quick else ()
    return tuple(m for m in scene.METHODS if m.function not in slow and can(scene, m.function, p))


def speeds_of(scene, plan, method):
    """The speeds at which a method runs, the quickest last: plain only where a quick validation would wait for the compiler, not for the run."""
    soon = still(scene) == "" or method.function in getattr(scene, "PLAIN_IN_QUICK", ())
    return ("plain",) if plan.quick and soon and "plain" in plan.speeds else plan.speeds


def at_speed(name, plan, method, speed):
    """The scene and our step, both plain or both compiled."""
    compiled = speed == "compiled"
    return binding.bind_scene(name, plan.of, compiled), getattr(binding.world(plan.of, compiled).lesson(method.lesson), method.function)


def engines_of(scene, p):
    """The engines that can do this case."""
    return tuple(e for e in scene.ENGINES if can(scene, e.label, p))


def not_run(scene, plan):
    """Sentences: what the scene does without, and what this run leaves to --full; in a notebook only the former, for it has no --full."""
    never = [scene.WITHOUT[0].upper() + scene.WITHOUT[1:]] if hasattr(scene, "WITHOUT") else []
    if plan.most_steps:
        return never
    labels = [m.label for m in scene.METHODS if m not in methods_of(scene, plan)]
    slow = [f"Left to --full, to keep this one quick: {', '.join(labels)}"] if labels else []
    if plan.quick and getattr(scene, "FULL_CASES", ()):
        slow.append(f"Left to --full: {', '.join(scene.FULL_CASES)}")
    if plan.quick and len(scene.CASES) > 1 and still(scene) is None and scene.ENGINES:
        slow.append(f"Left to --full: the engines on {', '.join(list(scene.CASES)[1:])}")
    if plan.quick and len(scene.STEPS) > 1 and scene.ENGINES:
        slow.append("Left to --full: the engines' finest step, where the one before it is fine enough to judge them by")
    plain = [m.label for m in methods_of(scene, plan) if speeds_of(scene, plan, m) != plan.speeds]
    if plain:
        slow.append(f"Left to --full: the same, compiled: {', '.join(plain)}")
    if plan.quick and still(scene) != "":
        slow.append("Left to --full: run times of steps coarser than the scene's own sweep")
    return never + slow


def sweep(scene, plan=Plan()):
    """The scene's numbers of steps, and before them three that are too coarse: they show where a method gives up."""
    coarse = tuple(n for n in (scene.STEPS[0] // 10, scene.STEPS[0] // 5, scene.STEPS[0] // 2) if n >= 2)
    return tuple(n for n in coarse + scene.STEPS if n <= (plan.most_steps or n))


def cases_of(scene, plan):
    """The scene's cases; for a notebook only the first of what moves, and with overrides the first, changed."""
    name, p = next(iter(scene.CASES.items()))
    if not plan.overrides:
        slow = getattr(scene, "FULL_CASES", ()) if plan.quick else ()
        return {name: p} if plan.most_steps and still(scene) is None else {case: q for case, q in scene.CASES.items() if case not in slow}
    return {f"{name}, changed": p._replace(**dict(plan.overrides))}


def engine_curve(name, scene, case, engine, p, truth, plan):
    """An engine's errors: live where it is installed, recorded where it is not."""
    product = engine.label.split(",")[0]
    if product in plan.live:
        source = f"live, {product} {engines.installed(product)}"
        early = scene.STEPS[-2:][0]                                  # the last one is half of an engine's time
        finest = early if plan.quick and allowed(scene, p, engine.label, engine.order, early) < ASYMPTOTIC else scene.STEPS[-1]
        runs = [(n, engine_final(scene, engine, p, n)) for n in sweep(scene, plan) if n <= min(engine.most_steps or n, finest)]
    else:
        record = recorded(name, case, engine.label)
        if record is None:
            return {"label": engine.label, "rows": [], "order": None, "expected": engine.order, "right": None, "settings": engine.settings,
                    "source": "missing", "why": f"{product} is not installed here and this case was never recorded"}
        source = record["source"]
        runs = [(r["steps"], (np.array(r["observed"]), None) if r["observed"] else (None, r["failure"])) for r in record["runs"]]
    return {**judged(scene, engine.label, p, truth, runs, engine.order), "settings": engine.settings, "source": source,
            "observed": [{"steps": n, "observed": None if o is None else o.tolist(), "failure": f} for n, (o, f) in runs]}


def allowed(scene, p, label, order, steps):
    """The largest relative error that theory allows a method or an engine at so many steps."""
    limits = scene.tolerance(p, scene.T / steps)
    return limits[label] if label in limits else limits[order]


def judged(scene, label, p, truth, runs, order):
    """The curve of one method or engine; where the scene gives it a law of its own, it must depart from the truth exactly as that says."""
    def limit(steps):
        return allowed(scene, p, label, order, steps)

    result = {**curve(scene, label, p, truth, runs, order, limit), "reason": ""}
    if label in getattr(scene, "WHY", {}):
        reason, own_law = scene.WHY[label]
        own = np.array(own_law(p, scene.T), dtype=float)
        result = {**curve(scene, label, p, own, runs, order, limit), "rows": result["rows"], "reason": reason, "departs": relative(own, truth), "own": own.tolist()}
    return result


def trace(name):
    """All that the repository keeps of a scene's runs of pybullet, or None.  Raises BadInput for a damaged file."""
    path = RECORDED / f"{name}.json"
    return read_whole(path, dict, f"make it anew: validate record --scene {name}") if path.is_file() else None


def recorded(name, case, label):
    """The trace of one engine run on one case from the repository, or None for what was not recorded.  Raises BadInput where the scene's file is missing."""
    record = trace(name) or {"runs": {}}
    if not record["runs"] and label.startswith("pybullet"):
        raise BadInput(f"file '{RECORDED / name}.json'", "missing or empty", f"restore it, or make it where pybullet is installed: validate record --scene {name}")
    runs = record["runs"].get(case, {}).get(label)
    return runs and {"source": f"recorded, {record['stamp']}", "runs": runs, "seconds": record["seconds"].get(label)}


def parity(name, scene, plan, p):
    """Largest difference between the plain and the compiled run of every method, relative; None where no method runs at both speeds."""
    differences = []
    for method in methods_of(scene, plan, p):
        if len(speeds_of(scene, plan, method)) == 2:
            a, b = (final(*at_speed(name, plan, method, speed), p, scene.STEPS[0])[0] for speed in plan.speeds)
            differences += [relative(a, b)] if a is not None and b is not None else []
    return max(differences, default=None)


def picture(name, scene, plan, p, usable):
    """Frames of the motion: truth, our usable method of highest order, and the first engine that is live and agrees."""
    if still(scene) is not None:
        there = np.array(scene.truth(p, scene.T), dtype=float)
        return {"seconds": 0.0, "dt": 0.0, "links": links(scene, p), "frames": {"truth": [scene.points(there, p).tolist()]},
                "space": in_space(scene, {"truth": [there]}, p, 1.0)}
    per_frame = max(1, scene.STEPS[-3] // FRAMES)
    seconds = getattr(scene, "FILM", scene.T)
    dt = seconds / (per_frame * FRAMES)
    seen = {"truth": [np.array(scene.truth(p, seconds * k / FRAMES)) for k in range(FRAMES + 1)]}
    for method in sorted((m for m in scene.METHODS if m.label in usable), key=lambda m: -m.order)[:1]:
        seen[method.label] = our_frames(*at_speed(name, plan, method, speeds_of(scene, plan, method)[-1]), p, dt, per_frame)
    for engine in scene.ENGINES:
        if engine.label.split(",")[0] in plan.live and engine.label not in getattr(scene, "WHY", {}):
            seen[engine.label] = engine_frames(engine, p, dt, per_frame)
            break
    frames = {label: [scene.points(observed, p).tolist() for observed in film] for label, film in seen.items()}
    if not plan.overrides and not any(label.startswith("py") for label in seen) and (record := trace(name)):
        frames["pybullet, recorded"] = record["frames"]
    return {"seconds": seconds, "frames": frames, "links": links(scene, p), "dt": dt, "space": in_space(scene, seen, p, seconds)}


def in_space(scene, seen, p, seconds):
    """The same motion for the player in space, where the scene says what its bodies look like; None where it does not."""
    if not hasattr(scene, "bodies"):
        return None
    from .report import space                                        # brings matplotlib along
    poses = {label: [scene.poses(observed, p) for observed in film] for label, film in seen.items()}
    arrows = {}
    if hasattr(scene, "arrows"):
        for label, film in seen.items():
            each = [scene.arrows(observed, p) for observed in film]
            arrows[label] = {name: [one[name] for one in each] for name in each[0]}
    return space.picture(scene.bodies(p), poses, seconds, arrows, getattr(scene, "TRAIL", None), getattr(scene, "GROUND", False))


def links(scene, p):
    """Pairs of points that the picture joins."""
    return [list(map(int, pair)) for pair in scene.LINKS(p)] if hasattr(scene, "LINKS") else []


def our_frames(scene, step, p, dt, per_frame):
    """What our method observes at every frame."""
    state, film = scene.start(p), []
    for _ in range(FRAMES + 1):
        film.append(scene.observe(state, p))
        state = scene.run(step, scene.law, state, p, dt, per_frame)
    return film


def engine_frames(engine, p, dt, per_frame):
    """What an engine reads at every frame."""
    world = engine.make(p, dt)
    film = []
    try:
        for _ in range(FRAMES + 1):
            film.append(np.array(world.read(), dtype=float))
            for _ in range(per_frame):
                world.step()
    finally:
        world.close()
    return film


def stability_cases(lesson, plan):
    """The stability cases of a lesson, as data."""
    found = stability.cases(lesson, plan.of, "compiled" in plan.speeds)
    return jsonable([{**case._asdict(), "findings": [f._asdict() for f in case.findings], "picture": case.picture and case.picture._asdict()}
                     for case in found])


# ---------------------------------------------------------------------------------------------- times

class Timed(NamedTuple):
    """Something with a stepping loop."""
    label: str
    speed: str               # plain, compiled, engine
    steps: int
    dt: float                # [s]
    prepare: object          # (steps, dt) → (the function to time, what to do after)


@with_overrides
def times(name, plan, result):
    """Run times of the first case, joined with the errors already found: [{label, speed, steps, error, seconds, low, high}]."""
    scene = binding.bind_scene(name, plan.of)
    case, p = next(iter(cases_of(scene, plan).items()))
    coarsest = scene.STEPS[0] if plan.quick and not plan.most_steps else 0               # what is coarser shows where methods give up, not how fast they are
    found = {c["label"]: {r["steps"]: r for r in c["rows"] if r["error"] is not None and r["error"] < LOST and r["steps"] >= coarsest}
             for c in result["cases"][case]["ours"] + result["cases"][case]["engines"]}
    refined = still(scene) != ""                                     # else there is no diagram to time anything for
    items = [Timed(m.label, speed, n, scene.T / n, prepare) for m in methods_of(scene, plan, p) for speed in speeds_of(scene, plan, m) if refined
             for prepare in [_loop(*at_speed(name, plan, m, speed), p)] for n in found[m.label]]
    items += [Timed(e.label, "engine", n, scene.T / n, _engine(e, p)) for e in engines_of(scene, p) if refined and e.label.split(",")[0] in plan.live
              for n in found[e.label]]
    timed = [(i.label, i.speed, i.steps, t) for i, t in interleaved(items, plan.longest(), plan.repeats())]
    timed += [(e.label, "recorded", row["steps"], row) for e in engines_of(scene, p) if e.label.split(",")[0] not in plan.live
              for row in (recorded(name, case, e.label) or {}).get("seconds") or []]
    rows = [{**t, "label": label, "speed": speed, "steps": n, "error": found[label][n]["error"]} for label, speed, n, t in timed
            if n in found[label]]
    untimed = dict.fromkeys(f"{i.label} ({i.speed})" for i in items if (i.label, i.speed) not in {(r["label"], r["speed"]) for r in rows})
    return jsonable({"rows": rows, "untimed": list(untimed), "baseline": baseline(plan) if still(scene) is None else {}, "reach": reach(rows), "advantage": advantage(rows),
                     "left_out": left_out(name, plan, p, usable(result))})


def _loop(scene, step, p, state=None):
    state = state or scene.start(p)

    def prepare(steps, dt):
        arguments = step, scene.law, state, p, dt, steps
        return lambda: scene.run(*arguments), lambda: None
    return prepare


def _engine(engine, p):
    def prepare(steps, dt):
        world = engine.make(p, dt)

        def loop():
            step = world.step
            for _ in range(steps):
                step()
        return loop, world.close
    return prepare


def interleaved(items, longest, repeats=REPEATS):
    """[(item, {seconds, low, high})]: medians of interleaved repeats.  What would take longer than `longest[speed]` is left out."""
    chosen = []
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        pace = {}                                                   # {(label, speed): seconds a step}, as far as it is known
        for item in items:
            key = item.label, item.speed
            first = all((i.label, i.speed) != key for i, _ in chosen)
            limit = longest[item.speed] * (3.0 if first else 1.0)                                        # or a slow one would not be there at all
            if key not in pace:
                pace[key] = _pace(item, limit)
            if pace[key] * item.steps > limit:
                continue
            seconds = min(_clock(item, 1) for _ in range(WARM_UPS))
            pace[key] = seconds / item.steps
            chosen.append((item, 1 if item.speed == "engine" else max(1, int(SHORTEST / max(seconds, 1e-9)))))
        samples = [[] for _ in chosen]
        enabled = gc.isenabled()
        gc.disable()
        try:
            for _ in range(repeats):
                for (item, inner), seconds in zip(chosen, samples):
                    seconds.append(_clock(item, inner))
        finally:
            if enabled:
                gc.enable()
    return [(item, {"seconds": float(np.median(s)), "low": min(s), "high": max(s)}) for (item, _), s in zip(chosen, samples)]


def _pace(item, limit):
    """Seconds a step, from a few steps; where those leave it open whether all of them take longer than `limit`, from more, because of two the call is most."""
    pace = min(_clock(item, 1, steps=2) for _ in range(2)) / 2
    if PROBE < item.steps and limit / item.steps < pace < limit / PROBE:
        pace = min(_clock(item, 1, steps=PROBE) for _ in range(2)) / PROBE
    return pace


def _clock(item, inner, steps=None):
    """Seconds of one stepping loop, or of its first steps."""
    loop, close = item.prepare(steps or item.steps, item.dt)
    try:
        begin = time.perf_counter()
        for _ in range(inner):
            loop()
        return (time.perf_counter() - begin) / inner
    finally:
        close()


def baseline(plan):
    """What one step of an empty world costs [s]: the Python call itself, for each engine."""
    costs = {}
    if "pymunk" in plan.live:
        space = engines.pymunk_space()
        costs["pymunk"] = _empty(lambda: space.step(1e-3))
    if "pybullet" in plan.live:
        bullet = engines.Bullet(1e-3)
        costs["pybullet"] = _empty(bullet.step)
        bullet.close()
    return costs


def _empty(step):
    laps = []
    for _ in range(REPEATS):
        begin = time.perf_counter()
        for _ in range(500):
            step()
        laps.append((time.perf_counter() - begin) / 500)
    return float(np.median(laps))


def usable(result):
    """Labels of our methods that agree with the truth in the first case."""
    return {c["label"] for c in next(iter(result["cases"].values()))["ours"] if c["right"] and not c["reason"]}


def left_out(name, plan, p, usable):
    """[{what, saves: times longer with it put in, same: the motion is unchanged, note}] for what the scene does without."""
    plain = binding.bind_scene(name, plan.of)
    method = max((m for m in plain.METHODS if m.label in usable), key=lambda m: m.order, default=None)
    if method is None:
        return []
    speed = speeds_of(plain, plan, method)[-1]
    scene, step = at_speed(name, plan, method, speed)
    steps = scene.STEPS[min(2, len(scene.STEPS) - 1)] if speed == "compiled" else scene.STEPS[0]
    rows = []
    for what, extra in scene.LEAVES_OUT.items():
        if isinstance(extra, str):
            rows.append({"what": what, "saves": None, "same": None, "note": extra})
            continue
        state, p_full = extra(p)
        items = [Timed(which, speed, steps, scene.T / steps, _loop(scene, step, *begin))
                 for which, *begin in (("without", p), ("with", p_full, state))]
        (_, lean), (_, full) = interleaved(items, {speed: np.inf})
        a = scene.observe(scene.run(step, scene.law, scene.start(p), p, scene.T / steps, steps), p)
        b = scene.observe(scene.run(step, scene.law, state, p_full, scene.T / steps, steps), p)
        rows.append({"what": what, "saves": full["seconds"] / lean["seconds"], "same": relative(a, b) < 1e-9, "note": ""})
    return rows


# ---------------------------------------------------------------------------------------------- reading the diagram

def reach(rows):
    """{label (speed): {target error: seconds, or None where the sweep does not get there}}, log-log between points."""
    table = {}
    for key in dict.fromkeys((r["label"], r["speed"]) for r in rows):
        points = sorted((r["error"], r["seconds"]) for r in rows if (r["label"], r["speed"]) == key)
        table[f"{key[0]} ({key[1]})"] = {f"{target:g}": time_to(points, target) for target in TARGETS}
    return table


def time_to(points, target):
    """Least time for that error from (error, seconds) points: the cheapest point that is good enough, or between it and the next."""
    good = [(s, e) for e, s in points if e <= target]
    if not good:
        return None
    seconds, error = min(good)
    worse = [(e, s) for e, s in points if e > target and s < seconds]
    if not worse or error <= 0.0:
        return seconds
    e, s = min(worse)
    fraction = np.log(target / error) / np.log(e / error)
    return float(np.exp(np.log(seconds) + fraction * (np.log(s) - np.log(seconds))))


def advantage(rows):
    """For each engine that errs: its smallest error, its time for that, our quickest time to get there, and the ratio."""
    result = []
    ours = {}
    for r in rows:
        if r["speed"] in ("plain", "compiled"):
            ours.setdefault((r["label"], r["speed"]), []).append((r["error"], r["seconds"]))
    worth = [r for r in rows if r["speed"] == "engine" and EXACTLY < r["error"] < ASYMPTOTIC]
    for label in dict.fromkeys(r["label"] for r in worth):
        best = min((r for r in worth if r["label"] == label), key=lambda r: r["error"])
        reached = [(t, name, speed) for (name, speed), points in ours.items() if (t := time_to(sorted(points), best["error"]))]
        quickest = min(reached, default=(None, "", ""))
        result.append({"engine": label, "error": best["error"], "seconds": best["seconds"], "ours": quickest[0],
                       "method": quickest[1], "speed": quickest[2], "ratio": best["seconds"] / quickest[0] if quickest[0] else None})
    return result


def jsonable(value):
    """The same data in types that JSON knows; numbers that are not finite become None."""
    if isinstance(value, dict):
        return {str(k): jsonable(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [jsonable(v) for v in value]
    if isinstance(value, np.ndarray):
        return jsonable(value.tolist())
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    if isinstance(value, (int, np.integer)):
        return int(value)
    if isinstance(value, (float, np.floating)):
        return float(value) if np.isfinite(value) else None
    return value
