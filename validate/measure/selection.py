"""The part of a scene that a run measures: its cases, methods, speeds, engines and steps.

Notes say what it leaves to `--full`.
"""

import warnings
from contextlib import contextmanager
from dataclasses import replace
from functools import wraps
from typing import NamedTuple

import numpy as np

from solutions.checks import BadInput

from ..engines.products import PYBULLET, PYMUNK
from ..scene import Scene
from ..subject import modules

REPEATS = 9                  # of a timed run; fewer of long ones
NOTEBOOK = 0.02              # longest time of a timed run in a notebook [s]
INSTALLED = tuple(engine for engine in (PYMUNK, PYBULLET) if engine.installed())


class Plan(NamedTuple):
    """How much to measure."""
    of: str = "solutions"
    speeds: tuple = ("plain", "compiled")
    quick: bool = True
    live: tuple = INSTALLED                  # engines that run here; the others come from their records
    overrides: tuple = ()                    # (name, value) pairs that replace parameters of the first case
    most_steps: int | None = None            # for a notebook: a shorter sweep, of the first case only
    changes: tuple = ()                      # for a notebook: (field, value) pairs that replace fields of the Scene

    def time_limits(self):
        """Return {speed: the longest time of a single timed run [s]}.

        A quick run leaves longer ones to --full, and a full run leaves them out.
        """
        if self.most_steps:
            return dict.fromkeys(("plain", "compiled", "engine"), NOTEBOOK)
        plain, compiled, engine = (0.003, 0.003, 0.006) if self.quick else (0.03, 0.1, 0.4)
        return {"plain": plain, "compiled": compiled, "engine": engine}

    def repeats(self):
        """Return the number of timed repeats; fewer in a notebook, where the reader is waiting."""
        return 3 if self.most_steps else REPEATS

    def enough(self):
        """Return how many of a curve's runs are judged before it ends: three in a quick validation, not in a notebook.

        Finer runs take most of the time, and the coarser ones show a fault as well.  Three runs show an order.
        """
        return 3 if self.quick and not self.most_steps else np.inf


class Selection(NamedTuple):
    """What is to be done of one scene."""
    name: str
    plan: Plan
    scene: Scene             # plain, with the subject's lessons
    cases: dict              # {name: p}
    ours: tuple              # of Runner: methods of ours; a case may support fewer
    steps: tuple             # numbers of steps over T
    notes: tuple             # sentences: what is omitted, and what is left to --full
    bindings: dict           # {speed: its scene} of the speeds that were used: looking up takes 30 ms

    @property
    def first(self):
        """Return (name, p) of the case that is timed and drawn."""
        return next(iter(self.cases.items()))

    def ours_for(self, p):
        """Return the methods of ours that support this case, and in a quick validation are not too slow in it."""
        return tuple(r for r in self.ours if can_do(r, p) and not (self.plan.quick and self.is_slow(r, p)))

    def unfinished_for(self, p):
        """Return [(runner, why)] of our methods that do not come to their end in this case."""
        found = [(runner, runner.unfinished(p)) for runner in self.ours if runner.unfinished]
        return [(runner, why) for runner, why in found if why]

    def races(self, p):
        """Return whether this is the case of a motion that a full validation times."""
        in_full = not (self.plan.quick or self.plan.most_steps)
        return in_full and self.scene.moves and self.scene.refined and p == self.first[1]

    def engines_for(self, p):
        """Return the engines that support this case; an optional one only where it runs."""
        return tuple(r for r in self.scene.engine_runners if can_do(r, p) and not left_out(r.who, self.plan))

    def is_slow(self, runner, p):
        """Return whether this case is one in which only a full validation runs it."""
        return any(self.cases.get(case) == p for case in runner.slow_cases)

    def is_live(self, runner):
        """Return whether this engine is run here rather than read from its record."""
        return runner.who.product in self.plan.live

    def speeds(self, runner):
        """Return the speeds at which a method of ours runs, the fastest last."""
        return speeds_of(self.scene, self.plan, runner)

    def rank(self, runner):
        """Return a key that sorts methods: high orders first, and within an order compiled methods first."""
        return -runner.who.order, self.speeds(runner)[-1:] != ("compiled",)

    def bound(self, runner, speed):
        """Return (scene, step): the scene and our step, both plain or both compiled."""
        if speed not in self.bindings:
            self.bindings[speed] = bound_scene(self.name, self.plan, speed == "compiled")
        scene = self.bindings[speed]
        return scene, getattr(getattr(scene.lessons, runner.who.lesson), runner.who.function)

    def steps_of(self, runner, p):
        """Return the numbers of steps of a runner.

        Some sweeps end sooner in a quick run.  In a full run some go on, in the case that is timed.
        """
        most = (runner.is_engine and runner.who.most_steps) or np.inf
        if self.plan.quick:
            most = min(most, runner.most_in_quick or np.inf)
        finer = () if self.plan.quick or p != self.first[1] else runner.finer_in_full
        at_once = runner.who.substeps if runner.is_engine else 1
        return tuple(n for n in self.steps if n <= most and n % at_once == 0) + finer

    def fastest(self, runner):
        """Return the same at the fastest speed that was asked for."""
        return self.bound(runner, self.speeds(runner)[-1])


def bound_scene(name, plan, compiled=False):
    """Return the Scene of that name with the plan's lessons and changes."""
    scene = modules.bind_scene(name, plan.of, compiled)
    return replace(scene, **dict(plan.changes)) if plan.changes else scene


def select(name, plan):
    """Return the Selection of a scene under a plan."""
    scene = bound_scene(name, plan)
    ours = ours_of(scene, plan)
    notes = notes_of(scene, plan, ours)
    return Selection(name, plan, scene, cases_of(scene, plan), ours, sweep(scene, plan), notes, {})


def left_out(engine, plan):
    """Return whether this engine is optional and not run here: it has no record that could stand in."""
    return engine.product.optional and engine.product not in plan.live


def can_do(runner, p):
    """Return whether a runner can do this case at all, and comes to its end."""
    if runner.unfinished is not None and runner.unfinished(p):
        return False
    return runner.supports is None or runner.supports(p)


def ours_of(scene, plan):
    """Return the methods of ours to run: slow ones only in a full validation, none without a speed."""
    return tuple(r for r in scene.our_runners if r.in_quick or not plan.quick) if plan.speeds else ()


def speeds_of(scene, plan, runner):
    """Return the speeds at which a method of ours runs: a quick run compiles only what the scene says."""
    plain_only = plan.quick and not (scene.refined and runner.compiled_in_quick)
    return ("plain",) if plain_only and "plain" in plan.speeds else plan.speeds


def sweep(scene, plan):
    """Return the scene's numbers of steps after three that are too coarse, which show where a method fails."""
    first = scene.steps[0]
    coarse = tuple(n for n in (first // 10, first // 5, first // 2) if n >= 2)
    return tuple(n for n in coarse + tuple(scene.steps) if n <= (plan.most_steps or n))


def cases_of(scene, plan):
    """Return the scene's cases; in a notebook only the first of what moves; with overrides the first one, changed."""
    name, p = next(iter(scene.cases.items()))
    if plan.overrides:
        return {f"{name}, changed": p._replace(**dict(plan.overrides))}
    if plan.most_steps and scene.moves:
        return {name: p}
    slow = scene.slow_cases if plan.quick else ()
    return {case: q for case, q in scene.cases.items() if case not in slow}


def notes_of(scene, plan, ours):
    """Return sentences: what the scene omits, and what this run leaves to --full.  A notebook has no --full."""
    omitted = (scene.omitted_methods[0].upper() + scene.omitted_methods[1:],) if scene.omitted_methods else ()
    if plan.most_steps:
        return omitted
    for product in dict.fromkeys(r.who.product for r in scene.engine_runners if left_out(r.who, plan)):
        why = "this run asked for others" if product.installed() else f"not installed; {product.remedy}"
        omitted += (f"The witness {product} is left out: {why}",)
    if not plan.quick:
        return omitted
    slow = [r.label for r in scene.our_runners if r not in ours]
    plain = [r.label for r in ours if speeds_of(scene, plan, r) != plan.speeds]
    finest = "finer steps, where three runs of a method or an engine can be judged already"
    short = [r.label for r in ours if r.most_in_quick]
    slow_cases = [case for case in scene.cases if any(case in r.slow_cases for r in scene.our_runners)]
    several = len(scene.cases) > 1 and scene.moves and scene.engine_runners
    left = (
        (slow, f", to keep this one quick: {', '.join(slow)}"),
        (scene.slow_cases, f": {', '.join(scene.slow_cases)}"),
        (slow_cases, f": our methods on {', '.join(slow_cases)}"),
        (several, f": the engines on {', '.join(list(scene.cases)[1:])}"),
        (len(scene.steps) > plan.enough(), f": {finest}"),
        (short, f": the finest steps of {', '.join(short)}"),
        (plain, f": the same, compiled: {', '.join(plain)}"),
        (scene.refined, ": run times of every second step, and of steps coarser than the scene's own sweep"),
    )
    return omitted + tuple(f"Left to --full{what}" for present, what in left if present)


def load(name, of):
    """Load a scene with those answers.  Raises BadInput when one of them does not load."""
    modules.bind_scene(name, of)


@contextmanager
def changed(name, changes):
    """Suppress overflow warnings for changed parameters, and raise BadInput if the scene cannot compute them."""
    if not changes:
        yield
        return
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            yield
    except (BadInput, OSError):
        raise
    except Exception as e:                                           # a truth or an engine takes ordinary values only
        values = ", ".join(f"{parameter} = {value}" for parameter, value in changes)
        raise BadInput(f"scene {name} with {values}", f"not computable ({type(e).__name__}: {e})",
                       "choose a value nearer to the scene's own") from None


def with_overrides(measuring):
    """Let measuring(name, plan, …) run inside `changed`."""
    @wraps(measuring)
    def measured(name, plan, *more):
        with changed(name, plan.overrides):
            return measuring(name, plan, *more)
    return measured
