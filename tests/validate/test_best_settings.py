"""pymunk and pybullet race at their best: two settings that their authors would try at once do not make them better.

The first setting is half of the iterations.  The second is a leapfrog start: first velocities of half a step before or
after.  Both are tried in the timed case of each scene.
"""

import numpy as np
import pytest

from solutions.checks import BadInput
from validate.engines.switches import worlds_made
from validate.measure.accuracy import relative, run_engine_to_end
from validate.measure.selection import Plan, select
from validate.scene import PYBULLET, PYMUNK, no_limit
from validate.subject import modules

SAME = 1e-4                  # of an error: less is the same error [-]
BETTER = 0.6                 # of an error: a setting that errs less, by the median, has to race [-]
EXACT = 1e-11                # smaller errors are round-off [-]
RANGE = 5e-4, 0.3            # errors at which races are run, and a little beyond [-]
MOST = 500                   # steps of a run
LEAPFROG = "leapfrog start"

scenes = pytest.mark.parametrize("name", modules.scene_names())


def racing(name):
    """Return (scene, p, truth, steps, [runner, …]) of the timed case, with pymunk and pybullet where they may race."""
    selection = select(name, Plan(quick=False, speeds=()))
    _, p = selection.first
    if not selection.races(p):
        pytest.skip("nothing is timed here")
    scene = selection.scene
    runners = [r for r in selection.engines_for(p) if r.who.product in (PYMUNK, PYBULLET) and selection.is_live(r)
               and not r.departure and r.limit is not no_limit and r.who.substeps == 1 and not r.is_reference(p)]
    if not runners:
        pytest.skip("neither engine races here")
    steps = [n for n in selection.steps if n <= MOST] or [selection.steps[0]]
    return scene, p, np.array(scene.truth(p, scene.duration), dtype=float), steps, runners


def error(scene, engine, p, truth, steps):
    observed = run_engine_to_end(scene, engine, p, steps).observed
    return np.inf if observed is None else relative(observed, truth)


def with_iterations(engine, times):
    """Return the same engine with its number of iterations changed by a function, and the list of numbers before."""
    before = []

    def make(p, dt):
        adapter = engine.product.adapter
        with worlds_made() as worlds:
            run = engine.make(p, dt)
        for world in worlds:
            before.append(adapter.let_sweep(world, 1))
            adapter.let_sweep(world, times(before[-1]))
        return run
    return engine._replace(make=make), before


def iterations_of(engine, p, dt):
    """Return the largest number of iterations of the engine's worlds; 1 where there is nothing to sweep over."""
    with worlds_made() as worlds:
        run = engine.make(p, dt)
    sweeping = [world for world in worlds if engine.product.adapter.sweep_once(world)]
    run.close()
    probe, before = with_iterations(engine, lambda n: n)
    probe.make(p, dt).close()
    return max(before) if sweeping else 1


@scenes
def test_half_of_the_iterations_change_the_error_or_another_variant_has_fewer(name):
    scene, p, truth, steps, runners = racing(name)
    counts = [iterations_of(r.who, p, scene.duration / steps[0]) for r in runners]
    for runner, count in zip(runners, counts, strict=True):
        fewest = min(c for c, other in zip(counts, runners, strict=True) if other.who.product is runner.who.product)
        if count == 1 or fewest < count:
            continue
        halved, _ = with_iterations(runner.who, lambda n: max(1, n // 2))
        errors = [(error(scene, runner.who, p, truth, n), error(scene, halved, p, truth, n)) for n in steps]
        assert any(abs(whole - half) > SAME * max(whole, EXACT) for whole, half in errors), (
            f"{runner.label} errs the same with half of its {count} iterations")


@scenes
def test_no_first_velocity_of_half_a_step_before_or_after_errs_much_less(name, monkeypatch):
    scene, p, truth, steps, runners = racing(name)
    for product in {r.who.product for r in runners}:
        mine = [r for r in runners if r.who.product is product]
        if any(LEAPFROG in r.label for r in mine):
            continue
        best = np.array([min(error(scene, r.who, p, truth, n) for r in mine) for n in steps])
        judged = (best > RANGE[0]) & (best < RANGE[1])
        for runner in mine:
            found = errors_ahead(scene, runner.who, p, truth, steps, monkeypatch)
            if found is not None and np.any(judged):
                ratio = np.median(found[judged] / best[judged])
                assert ratio > BETTER, f"{runner.label} errs {ratio:.2f} times as much with a leapfrog start"


def errors_ahead(scene, engine, p, truth, steps, monkeypatch):
    """Return an engine's errors with a leapfrog start; None where its links cannot have one, or no Model is built."""
    world, used = engine.product.world, []
    build = world.build

    def ahead(model, dt, **settings):
        used.append(model)
        return build(model, dt, **{**settings, "ahead": 0.5})
    with monkeypatch.context() as patch:
        patch.setattr(world, "build", ahead)
        try:
            found = np.array([error(scene, engine, p, truth, n) for n in steps])
        except BadInput:                                         # links, whose accelerations a scene has to give
            return None
    return found if used else None
