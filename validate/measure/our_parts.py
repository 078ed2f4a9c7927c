"""Cost and effect of each part of our loop in a scene.

A loop with all parts runs every scene that is a Model: it has loads of all kinds, searches for contacts of
shapes of all kinds, lets them rub, closes joints and turns what moves.  From it one part at a time is left out, as the
engines' switches do.  The loop that `compose` makes of the Model leaves out all that the scene does not need.
"""

from collections.abc import Callable
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from typing import NamedTuple

import numpy as np

from solutions.support.model import make_model
from solutions.support.shapes import Ball

from ..check import jsonable
from ..worlds.ours import compiled_advance, lesson_of
from . import dimension
from .accuracy import relative
from .timing import Timed, interleaved, seconds_per_step

ALL = ("accelerate", "detect_unjoined", "separate_with_joints", "contact_impulses_with_joints", "move_and_turn")
SMOOTH = ("accelerate_half", "detect_unjoined", "contact_impulses_with_joints", "move_and_turn", "accelerate_rest",
          "hold")            # all parts where the loop of the scene is RATTLE: forces act at both ends of its step
WITHOUT = {                  # {part: ({function: the one in its place, or None}, fields that are zero)}
    "rotation": ({"move_and_turn": "move"}, ("inv_inertia",)),
    "detection": ({"detect_unjoined": None, "separate_with_joints": None, "contact_impulses_with_joints": "close"}, ()),
    "contact": ({"separate_with_joints": None, "contact_impulses_with_joints": "close"}, ()),
    "friction": ({}, ("mu", "mu_of")),
    "joints": ({"detect_unjoined": "detect_many", "separate_with_joints": "separate",
                "contact_impulses_with_joints": "contact_impulses_of_pairs", "hold": None}, ()),
}
WITH_RODS = {                # where joints are also rods
    "close": "close_with_rods", "hold": "hold_with_rods", "separate_with_joints": "separate_with_rods",
    "contact_impulses_with_joints": "contact_impulses_with_rods"}
TOTAL, DIMENSION = "all that the scene leaves out", "the third dimension"
WITH, OWN = "all parts", "the scene's loop"
SMALL = 0.01                 # radius of a body without a shape over the least distance of two bodies, or over 1 m [-]
STEPS, PROBE = 500, 2        # steps of a run, and of the shortest one
LONGEST, SEEN = 0.03, 0.5    # a run that is timed, or observed, ends sooner if it would take longer than this [s]


class Part(NamedTuple):
    """A function of a step."""
    step: Callable


class Run(NamedTuple):
    """A loop that can be timed and observed."""
    advance: Callable        # (steps, dt) → its state
    see: Callable            # (state) → what the scene observes


def our_parts(selection, p):
    """Return {"rows", "note"}; note: why there are none.

    rows: [{part, speed, steps, cost, change, until, observed, repeats}]
    cost: time with the part over time without it;    change: relative change of the observed quantities without it, or
    None if the run is lost;    until: the time at which they were observed, over T.

    The part TOTAL is the loop with all parts against the loop of the scene, and DIMENSION the loop of lesson 10 in
    space against the one in the plane.
    """
    one = described_scene(selection.name)
    if one is None:
        return {"rows": [], "note": "" if selection.scene.moves else "no motion is compared here"}
    model = one.model(p)
    own_load = any(callable(load) for load in model.loads)
    note = "a force of this scene is a Python function, which is not compiled" if own_load else ""
    speeds = ("plain",) if own_load else selection.plan.speeds
    try:
        return jsonable({"rows": rows_of(selection, one, model, p, speeds), "note": note})
    except (Exception, SystemExit) as e:                             # a subject's code may do anything
        return {"rows": [], "note": f"with these steps the loop ends in an error, {type(e).__name__}: {e}"}


def described_scene(name):
    """Return the Described of a scene; None where it is no Model, and in a copy for students, which lacks the list."""
    if find_spec("validate.worlds.described") is None:
        return None
    return import_module("validate.worlds.described").DESCRIBED.get(name)


def variants(lesson, model):
    """Return {name: (names of the functions of a step, Loop)}: with all parts, without each of them, and the scene's.
    """
    own, full = lesson.compose(model), lesson.compose(shaped(model))
    names = tuple(part.step.__name__ for part in own.parts)
    rods = WITH_RODS if full.p.rods.a.size else {}
    named = lambda name: in_dimension(lesson, model.d, rods.get(name, name))
    load = full.load if any(callable(load) for load in model.loads) else getattr(lesson, named("model_load"))
    bounds, narrow = ((lesson.convex_bounds_2d, lesson.convex_contacts_2d) if model.d == 2 else
                      (lesson.rounded_bounds, lesson.rounded_contacts))
    full = full._replace(load=load)
    if full.narrow is not lesson.hull_contacts:              # which finds the contacts of all shapes
        full = full._replace(bounds=bounds, narrow=narrow)
    every = SMOOTH if names[:1] == (named(SMOOTH[0]),) else ALL
    found = {WITH: (tuple(map(named, every)), full)}
    for part, (functions, fields) in WITHOUT.items():
        kept = tuple(named(other) for other in (functions.get(name, name) for name in every) if other)
        zero = {field: 0.0 * getattr(full.p, field) for field in fields}
        step = own.step._replace(step=lesson.whole_step) if part == "detection" else full.step
        found[part] = kept, full._replace(p=full.p._replace(**zero), step=step)
    return {**found, OWN: (names, own)}


def in_dimension(lesson, d, name):
    """Return the name of a function of a loop in the plane, or of its twin in space."""
    twin = f"{name.removesuffix('_of_pairs')}_in_space"
    return twin if d == 3 and hasattr(lesson, twin) else name


def shaped(model):
    """Return the Model with a small ball for each body without a shape, which the search for contacts has to look at.
    """
    x = np.array([body.x for body in model.bodies])
    apart = np.linalg.norm(x[:, None] - x, axis=2) + np.diag(np.ones(len(x)))
    ball = Ball(SMALL * float(apart.min()) if apart.min() > 0.0 else SMALL)
    bodies = [body if body.shape is not None else body._replace(shape=ball) for body in model.bodies]
    return make_model(bodies, model.gravity, model.joints, model.springs, model.loads)


def advancing(of, compiled, names, loop):
    """Return the function (steps, dt) → PileState of a loop of a subject, plain or compiled, with the parts named."""
    lesson = lesson_of(of)
    loop = loop._replace(parts=[Part(getattr(lesson, name)) for name in names])
    advance = compiled_advance(loop, of) if compiled else partial(lesson.run_parts, loop)
    return lambda steps, dt: advance(0.0, loop.state, dt, steps)


def rows_of(selection, described, model, p, speeds):
    """Return the rows of all parts at these speeds."""
    of, see = selection.plan.of, partial(seen_in, described, p)
    plain = lesson_of(of)
    loops, lifted = variants(plain, model), (dimension.in_both(plain, shaped(model)) if model.d == 2 else None) or {}

    def composed(compiled):
        return {name: Run(advancing(of, compiled, *one), partial(see, partial(plain.state_of, one[1])))
                for name, one in loops.items()}

    def in_space(compiled):
        lesson = lesson_of(of, compiled)
        return {dim: Run(dimension.advancing(lesson, one), partial(see, partial(dimension.state_in_plane, one)))
                for dim, one in lifted.items()}
    rows = priced(selection, composed, [*((part, WITH, part) for part in WITHOUT), (TOTAL, WITH, OWN)], speeds)
    try:
        return rows + (priced(selection, in_space, [(DIMENSION, 3, 2)], speeds) if lifted else [])
    except ArithmeticError:              # the loops of lesson 10 end where bodies sink into each other
        return rows


def seen_in(described, p, read, state):
    """Return what a scene observes of a state of its loop, which `read` makes a State of the Model."""
    return described.observe(read(state), p)


def priced(selection, runs_of, pairs, speeds):
    """Return a row for each speed and each of `pairs`, (part, name of the run with it, name of the run without it).

    runs_of(compiled) → {name: Run}.  All runs of one speed are timed alternately.  Their ends are observed at the last
    speed, the fastest, which gets farthest.
    """
    rows, runs = [], {speed: runs_of(speed == "compiled") for speed in speeds}
    dt, far = length_of_run(selection.scene, runs[speeds[-1]][pairs[0][1]].advance, SEEN)
    seen = {name: observed(run, far, dt) for name, run in runs[speeds[-1]].items()}
    until = far * dt / selection.scene.duration
    for speed in speeds:
        _, steps = length_of_run(selection.scene, runs[speed][pairs[0][1]].advance, LONGEST)
        items = [Timed(name, speed, steps, dt, prepared(run.advance)) for name, run in runs[speed].items()]
        times = {item.label: one for item, one in interleaved(items, {speed: np.inf}, selection.plan.repeats())}
        rows += [row(part, speed, steps, [times[full], times[lean]], [seen[full], seen[lean]], until)
                 for part, full, lean in pairs]
    return rows


def prepared(run):
    """Return prepare(steps, dt) of a loop, for the clock."""
    return lambda steps, dt: (lambda: run(steps, dt), lambda: None)


def length_of_run(scene, advance, longest):
    """Return (dt, steps) of a run: all of T, or as much of it as takes `longest` [s]."""
    n = next((n for n in scene.steps if n >= STEPS), scene.steps[-1])
    dt = scene.duration / n
    pace = seconds_per_step(Timed("", "", n, dt, prepared(advance)), longest)
    return dt, min(n, max(PROBE, int(longest / pace)))


def observed(run, steps, dt):
    """Return what a run observes at its end, flat, or None if that is not finite."""
    found = np.asarray(run.see(run.advance(steps, dt)), dtype=float).ravel()
    return found if np.all(np.isfinite(found)) else None


def row(part, speed, steps, times, seen, until=1.0):
    """Return one row from what was timed and observed with the part and without it."""
    full, lean = times
    lost = any(one is None for one in seen)
    return {"part": part, "speed": speed, "steps": steps, "cost": full["seconds"] / lean["seconds"],
            "change": None if lost else relative(seen[1], seen[0]), "until": until, "observed": seen,
            "repeats": (full["repeats"], lean["repeats"])}
