"""MuJoCo: its laws hold, and on a platform without its wheel the scenes say that it is missing."""

import numpy as np
import pytest

from solutions.support.model import Body, Drag, Force, make_model
from validate import measure
from validate.check import Verdict
from validate.engines.mujoco import IMPEDANCE, module
from validate.engines.products import MUJOCO, PRODUCTS
from validate.measure.accuracy import engine_curve, run_engine_to_end
from validate.measure.selection import select
from validate.reference import turns
from validate.reference.friction import CLOSE
from validate.report.compare import changes
from validate.scenes.friction import incline
from validate.subject import modules

WITH_MUJOCO = [name for name in modules.scene_names()
               if any(r.who.product == MUJOCO for r in modules.bind_scene(name).engine_runners)]
needs_mujoco = pytest.mark.skipif(not MUJOCO.installed(), reason=f"MuJoCo is not installed: {MUJOCO.remedy}")


def curve_of(name, case=None, variant=""):
    """The curve of MuJoCo in one case of a scene, up to a thousand steps, without our methods."""
    plan = measure.Plan(speeds=(), live=(MUJOCO,), quick=False, most_steps=1000)
    selection = select(name, plan)
    case = case or selection.first[0]
    p = selection.scene.cases[case]
    runner = next(r for r in selection.engines_for(p) if r.who.product == MUJOCO and r.who.variant == variant)
    return engine_curve(selection, case, runner, p, np.array(selection.scene.truth(p, selection.scene.duration)))


def test_it_is_a_witness_where_it_says_something():
    assert {"throw", "oscillator", "linear_drag", "quadratic_drag", "kepler", "kepler_near_collision", "two_stars",
            "wind", "angular_spring", "spring_net", "catenary", "hanging_springs", "asymmetric_top",
            "axisymmetric_body", "heavy_top", "pendulum", "rope", "rod_chain", "incline", "stack"} <= set(WITH_MUJOCO)


@pytest.mark.parametrize("name", WITH_MUJOCO)
def test_where_it_is_left_out_a_scene_says_so_and_keeps_all_other_verdicts(name):
    selection = select(name, measure.Plan(speeds=("plain",), live=()))
    assert sum("The witness mujoco is left out" in note for note in selection.notes) == 1
    for p in selection.cases.values():
        left = {r.label for r in modules.bind_scene(name).engine_runners if not r.who.product.optional}
        assert {r.label for r in selection.engines_for(p)} <= left
    with_it = select(name, measure.Plan(speeds=("plain",), live=PRODUCTS))
    assert not any("mujoco is left out" in note for note in with_it.notes)


def test_a_report_without_it_is_no_regression_of_one_with_it():
    def report(*products):
        curves = [{"role": "engine", "label": n, "product": n, "verdict": "agrees", "rows": [], "order": None}
                  for n in products]
        return {"scenes": [{"scene": "s", "cases": {"c": {"ours": [], "engines": curves}}}], "stability": []}
    both, one = report("pymunk", "mujoco"), report("pymunk")
    assert [(c.worse, "left out" in c.words) for c in changes(both, one)] == [(False, True)]
    assert [c.worse for c in changes(both, report("mujoco"))] == [True]


@needs_mujoco
@pytest.mark.parametrize("name", ["asymmetric_top", "heavy_top", "pendulum", "oscillator", "quadratic_drag",
                                  "wind", "angular_spring", "spring_net"])
def test_its_runge_kutta_method_is_of_order_four_and_errs_as_predicted(name):
    found = curve_of(name)
    assert found["verdict"] is Verdict.AGREES and found["order"] == pytest.approx(4, abs=0.2)
    assert sum(row["predicted"] is not None for row in found["rows"]) >= 4


@needs_mujoco
@pytest.mark.parametrize("name", ["rope", "rod_chain", "two_stars", "hanging_springs"])
def test_its_error_is_predicted_where_a_thousand_steps_do_not_show_the_order_yet(name):
    found = curve_of(name)
    predicted = [row for row in found["rows"] if row["predicted"] is not None]
    assert found["verdict"] is Verdict.AGREES and len(predicted) >= 2
    assert all(row["error"] > 100.0 * row["band"] for row in predicted[:1])


def world_of(loads):
    """A point that moves with 1 m/s under these loads."""
    return MUJOCO.world.build(make_model([Body((0.0, 0.0), 1.0, v=(1.0, 0.0))], (0.0, 0.0), loads=loads), 0.01)


@needs_mujoco
def test_a_load_acts_in_every_stage_and_in_its_own_world_only():
    """A force that is set once per step would make Runge–Kutta a method of order 1."""
    loaded, built_in, free = (world_of(loads) for loads in ([Force(0, lambda v: (-v[0], -v[1]), "v")], [Drag(1.0)], []))
    for _ in range(100):
        for world in (loaded, built_in, free):
            world.step()
    v = [world.state().v[0, 0] for world in (loaded, built_in, free)]
    assert v[0] == pytest.approx(v[1], abs=1e-13) and v[2] == 1.0 != v[0]


@needs_mujoco
def test_a_load_that_fails_does_not_stay():
    world = world_of([Force(0, lambda x: (0.0, 0.0) if x[0] == 0.0 else x[2], "x")])
    with pytest.raises(IndexError):                                          # in the second stage
        world.step()
    assert module().get_mjcb_passive() is None


@needs_mujoco
def test_without_the_terms_of_munthe_kaas_the_prediction_of_a_free_body_fails():
    scene = modules.bind_scene("asymmetric_top")
    p, dt = scene.parameters, scene.duration / 500
    runner = next(r for r in scene.engine_runners if r.who.product == MUJOCO)
    seen = run_engine_to_end(scene, runner.who, p, 500).observed - scene.truth(p, scene.duration)
    body = turns.free_turning(scene.duration, scene.truth, scene.truth_uncertainty)
    predictions = runner.prediction(p, dt), body.predict(turns.RUNGE_KUTTA)(p, dt)
    off = [np.linalg.norm(seen - found.error) / np.sqrt(3.0) / found.band for found in predictions]
    assert off[0] < 0.1 and off[1] > 5.0


@needs_mujoco
@pytest.mark.parametrize(("case", "verdict"), [("slides, μ = 0.5", Verdict.AGREES),
                                               ("thrown up, sticks, μ = 0.6", Verdict.FOLLOWS_OWN_LAW)])
def test_its_block_hops_slides_and_creeps_as_its_contact_law_says(case, verdict):
    found = curve_of("incline", case)
    assert found["verdict"] is verdict
    assert all(row["predicted"] is not None for row in found["rows"])


@needs_mujoco
def test_another_impedance_would_be_seen_on_the_incline():
    scene = modules.bind_scene("incline")
    p, steps = scene.cases["thrown up, sticks, μ = 0.6"], 1000
    engine = next(r.who for r in scene.engine_runners if r.who.product == MUJOCO)
    way = run_engine_to_end(scene, engine, p, steps).observed[0]
    for factor, near in ((1.0, True), (1.001, False)):
        law = incline.soft(p)._replace(d=IMPEDANCE * factor)
        middle, half = law.hopping(p.v0, scene.duration / steps, steps)
        assert bool(abs(way - middle) <= 4.0 * half + CLOSE * abs(way)) is near
