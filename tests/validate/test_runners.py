"""A runner has everything that concerns one curve of a scene; its label is ink."""

from dataclasses import replace

import numpy as np
import pytest

from solutions.checks import BadInput
from validate import measure, methods
from validate.check import Verdict, Whose
from validate.measure.accuracy import Outcome, judged
from validate.measure.races import races
from validate.methods import INTEGRATORS, VERLET
from validate.scene import PYMUNK, Departure, Method, Runner, no_limit, ours
from validate.scenes._common import cases_with
from validate.subject import modules

PLAIN = measure.Plan(speeds=("plain",), live=(), most_steps=1000)
METHODS = [m for m in vars(methods).values() if isinstance(m, Method)]


def limit(p, dt):
    return dt


def of_ours(result):
    """The curves of our methods in the first case, without their labels."""
    first = next(iter(result["cases"].values()))
    return [{key: value for key, value in curve.items() if key != "label"} for curve in first["ours"]]


def test_a_method_has_the_order_of_its_table():
    assert all(m.order == m.table.order for m in METHODS if hasattr(m.table, "order"))
    assert all(m.table is not None for m in INTEGRATORS)


def test_a_method_is_a_function_of_its_lesson():
    """A misspelt one would stand in the report as an exercise that waits for its answer."""
    lacking = [m.function for m in METHODS if not callable(getattr(modules.bind(m.lesson), m.function, None))]
    assert METHODS and not lacking


def test_new_labels_change_ink_and_nothing_else():
    """Every method keeps its prediction, and every setting of an engine its law, under every name."""
    scene, plan = modules.bind_scene("quadratic_drag"), PLAIN._replace(live=(PYMUNK,))
    renamed = tuple(renamed_runner(r, n) for n, r in enumerate(scene.runners))
    before, after = (next(iter(measure.errors("quadratic_drag", plan._replace(changes=changes))["cases"].values()))
                     for changes in ((), (("runners", renamed),)))
    for part, name in (("ours", "method 2"), ("engines", "pymunk, setting")):
        assert facts(before[part]) == facts(after[part])
        assert any(curve["label"].startswith(name) for curve in after[part])


def renamed_runner(runner, n):
    """The same runner under another name; a record of pybullet is found by its name."""
    if not runner.is_engine:
        return replace(runner, who=runner.who._replace(label=f"method {n}"))
    return replace(runner, who=runner.who._replace(variant=f"setting {n}")) if runner.who.product == PYMUNK else runner


def facts(curves):
    """Everything about curves but ink."""
    return [{key: value for key, value in curve.items() if key not in ("label", "variant", "line", "marker")}
            for curve in curves]


def test_without_its_prediction_a_curve_is_still_judged_by_its_limit():
    scene = modules.bind_scene("quadratic_drag")
    without = tuple(replace(r, predicted="left out here") for r in scene.runners)
    result = measure.errors("quadratic_drag", PLAIN._replace(changes=(("runners", without),)))
    for curve in of_ours(result):
        assert curve["verdict"] == "agrees" and all(row["predicted"] is None for row in curve["rows"])


def test_a_runner_whose_prediction_is_left_out_is_refused():
    with pytest.raises(TypeError, match="predicted"):
        ours(VERLET, limit=limit)


@pytest.mark.parametrize(("field", "value", "says"), [
    ("predicted", "", "say why no theory does"), ("predicted", None, "predicted"), ("limit", 1.0, "limit"),
    ("slow_cases", "all", "slow_cases"), ("in_quick", 1, "in_quick")])
def test_a_runner_without_a_meaning_is_refused(field, value, says):
    with pytest.raises(BadInput, match=says):
        ours(VERLET, **{"limit": limit, "predicted": "of no theory", field: value})


@pytest.mark.parametrize("misspelt", ["limits", "predict", "support", "slow_case", "most_in_quik", "finer_in_ful",
                                      "compiled_in_quik", "departures", "in_quik"])
def test_a_misspelt_field_is_an_error(misspelt):
    with pytest.raises(TypeError, match=misspelt):
        ours(VERLET, limit=limit, predicted="of no theory", **{misspelt: None})


def test_a_departure_without_its_owner_is_refused():
    with pytest.raises(BadInput, match="its law, its default, our set-up"):
        ours(VERLET, limit=limit, predicted="of no theory", departure=Departure("it is", limit, "the engine's"))


@pytest.mark.parametrize("name", modules.scene_names())
def test_no_departure_is_our_own_set_up(name):
    """What a scene could set up otherwise is no property of an engine."""
    found = [r for r in modules.bind_scene(name).runners if r.departure and r.departure.whose is Whose.SET_UP]
    assert not found, found


def test_what_a_default_setting_does_is_not_called_the_engines_law():
    """Reports and tables tell the two apart: a runner named `default` departs by its default."""
    departures = [r for name in modules.scene_names() for r in modules.bind_scene(name).engine_runners if r.departure]
    defaults = [r for r in departures if r.who.variant.startswith("default")]
    assert len(defaults) > 5 and {r.departure.whose for r in defaults} == {Whose.DEFAULT}


def test_a_case_or_a_look_that_there_is_not_is_refused():
    scene = modules.bind_scene("quadratic_drag")
    runner = ours(VERLET, limit=limit, predicted="of no theory", slow_cases=("faling",))
    with pytest.raises(BadInput, match="faling"):
        replace(scene, runners=(runner,))
    with pytest.raises(BadInput, match="faling"):
        replace(scene, slow_cases=("faling",))
    with pytest.raises(BadInput, match="'sprng', is unknown: choose from: rod, spring"):
        replace(scene, link_look="sprng")


def test_a_runner_names_only_cases_that_there_are():
    """A misspelt pair of shapes would otherwise leave its case to the other runners."""
    cases = modules.bind_scene("distances").cases
    supports = cases_with("pair", ("ball, ball", "box, plane"), cases)
    assert [name for name, p in cases.items() if supports(p)] == ["ball, ball", "box, plane"]
    with pytest.raises(BadInput, match="'ball, bal', is unknown"):
        cases_with("pair", ("ball, ball", "ball, bal"), cases)


def test_a_limit_may_be_one_number_or_one_for_each_order():
    by_order = {1: 1.0, 2: 0.25}
    one, each = (ours(VERLET, limit=f, predicted="of no theory") for f in (limit, lambda p, dt: by_order))
    assert one.largest_error(None, 0.5) == 0.5 and each.largest_error(None, 0.5) == 0.25


@pytest.mark.parametrize("name", modules.scene_names())
def test_every_curve_has_a_prediction_or_a_reason_why_not(name):
    for runner in modules.bind_scene(name).runners:
        assert isinstance(runner, Runner)
        assert callable(runner.predicted) or len(runner.predicted.split()) >= 4, runner.label


def test_the_largest_error_of_a_curve_that_no_theory_judges_is_infinite():
    unjudged = [r for r in modules.bind_scene("dominoes").runners if r.limit is no_limit]
    assert unjudged and all(r.largest_error(None, 0.1) == np.inf and not callable(r.predicted) for r in unjudged)


def test_a_limit_that_was_measured_is_marked_and_says_on_what():
    """Its text or its name has the word; `validate audit` and `validate limits` list what is marked."""
    for name in modules.scene_names():
        for r in modules.bind_scene(name).runners:
            limit = getattr(r.limit, "func", r.limit)
            says = "measured" in f"{limit.__name__} {limit.__doc__}"
            assert says == bool(r.measured), (name, r.label)


@pytest.mark.parametrize(("name", "case", "judges_itself"), [
    ("card_house", "too smooth", True), ("card_house", "rough enough", False),
    ("machine", "places", False), ("machine", "energy", False)])
def test_an_engine_whose_run_is_the_truth_is_a_reference(name, case, judges_itself):
    scene = modules.bind_scene(name)
    assert [r.is_reference(scene.cases[case]) for r in scene.engine_runners] == [judges_itself]
    assert not any(r.is_reference(p) for r in scene.our_runners for p in scene.cases.values())


def test_a_reference_is_neither_judged_nor_raced():
    """Its own truth would call it right, and a race against it would measure how fine its own steps are."""
    scene = modules.bind_scene("throw")
    runner = next(r for r in scene.engine_runners if r.who.product == PYMUNK)
    its_own = replace(runner, is_truth=lambda p: True)
    runs = [(100, Outcome(scene.truth(scene.parameters, scene.duration)))]
    curves = [judged(scene, r, scene.parameters, np.array(scene.truth(scene.parameters, scene.duration)), runs, 4)
              for r in (its_own, runner)]
    assert [c["reference"] for c in curves] == [True, False] and curves[0]["message"] == ""
    assert curves[0]["verdict"] is Verdict.REFERENCE
    rows = [{"label": label, "speed": speed, "steps": 100, "error": 0.01, "seconds": 1.0, "low": 1.0, "high": 1.0}
            for label, speed in ((runner.label, "engine"), ("Verlet", "plain"))]
    ours = {"label": "Verlet", "verdict": "agrees", "rows": [], "expected": 2, "order": None}
    raced = [races(rows, {"ours": [ours], "engines": [{**c, "verdict": verdict, "product": "pymunk", "variant": "",
                           "substeps": 1}]},
                   ["pymunk"], False, []) for c, verdict in zip(curves, (curves[0]["verdict"], "agrees"), strict=True)]
    assert [len(found) for found in raced] == [0, 4]
