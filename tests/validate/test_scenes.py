"""Every scene: its truth reproduces the published numbers, our methods and the engines keep to it,
and a wrong method would be seen.
"""

import ast
import math
import re
from dataclasses import replace

import numpy as np
import pytest

from solutions import integrators
from solutions.checks import BadInput
from validate import measure, methods
from validate.check import Verdict, is_right, states
from validate.measure.accuracy import ASYMPTOTIC, engine_curve, relative, run_to_end, theory
from validate.measure.selection import select
from validate.report import words
from validate.scene import PRODUCTS, PYBULLET
from validate.subject import modules
from validate.subject.generate import stub

SCENES = modules.scene_names()
MOVING = [n for n in SCENES if modules.bind_scene(n).moves]
REFINED = [n for n in SCENES if modules.bind_scene(n).refined]
LIVE = tuple(product for product in PRODUCTS if product.installed())
BRIEF = measure.Plan(speeds=("plain",), live=LIVE, most_steps=500)
# `validate` judges every scene, and its exit code says the result; these stand for all in the default tests
SAMPLE = {"oscillator", "incline", "spinning_bounce", "asymmetric_top", "pendulum", "backspin_ball"}


def scenes(names, sample=frozenset(SCENES)):
    """For each of these scenes; all tests of a scene in one process, which then computes its truth once.

    Scenes outside the sample are long tests.
    """
    def marks(name):
        return [pytest.mark.xdist_group(f"scene {name}"), *([] if name in sample else [pytest.mark.long])]
    return pytest.mark.parametrize("name", [pytest.param(name, marks=marks(name)) for name in names])


@scenes(SCENES)
def test_a_truth_reproduces_what_was_published(name):
    scene = modules.bind_scene(name)
    p = scene.parameters
    for t, expected, tolerance in scene.published_states:
        finding = states(f"the truth at {t} s", scene.truth(p, t), expected, tolerance)
        assert finding.holds, finding


@scenes([n for n in SCENES if modules.bind_scene(n).sanity_checks],
        set(SCENES) - {"cloth", "rod_chain", "rope", "spring_net"})           # which take most of the time
def test_what_a_scene_claims_beside_its_motion_holds(name):
    for finding in modules.bind_scene(name).sanity_checks():
        assert finding.holds, finding


@scenes(MOVING, set(SCENES) - {"cloth", "rod_chain", "rope"})          # whose truths take seconds
def test_a_truth_begins_where_the_scene_begins(name):
    scene = modules.bind_scene(name)
    for p in scene.cases.values():
        begin = scene.observe(scene.start(p), p)
        known_to = max(1e-9, scene.truth_uncertainty)
        assert np.allclose(scene.truth(p, 0.0), begin, rtol=0.0, atol=known_to * (1.0 + np.abs(begin).max()))


@scenes([n for n in SCENES if modules.bind_scene(n).poses])
def test_a_body_is_shown_by_a_place_and_a_rotation_where_the_motion_has_it(name):
    scene = modules.bind_scene(name)
    p = scene.parameters
    times = (0.0, 0.37 * scene.duration, scene.duration)
    frames = scene.our_film(p)[1] if scene.our_film else [scene.truth(p, t) for t in times]
    for observed in np.array(frames, dtype=float):
        poses = np.array(scene.poses(observed, p), dtype=float)
        assert poses.shape == (len(scene.bodies(p)), 7) and np.all(np.isfinite(poses))
        # rounding of quaternions of R
        assert np.allclose(np.linalg.norm(poses[:, 3:], axis=1), 1.0, rtol=0.0, atol=1e-12)


@scenes(REFINED)
def test_steps_span_two_decades(name):
    steps = modules.bind_scene(name).steps
    assert list(steps) == sorted(steps) and steps[-1] >= 100 * steps[0]


@scenes([n for n in SCENES if any(r.most_in_quick for r in modules.bind_scene(n).our_runners)])
def test_a_quick_validation_ends_a_sweep_where_the_scene_says(name):
    quick, full = (select(name, measure.Plan(quick=quick)) for quick in (True, False))
    for runner in full.ours:
        if most := runner.most_in_quick:
            p = full.first[1]
            assert most in full.scene.steps and full.steps_of(runner, p)[:len(full.steps)] == full.steps
            assert quick.steps_of(runner, p) == tuple(n for n in quick.steps if n <= most)
    assert any("the finest steps of" in note for note in quick.notes)


def test_a_curve_ends_after_three_judged_runs_in_a_quick_validation_alone():
    steps = modules.bind_scene("linear_drag").steps
    quick, full = ({curve["label"]: curve["rows"] for curve in (*case["ours"], *case["engines"])} for case in (
        measure.errors("linear_drag", BRIEF._replace(most_steps=None, quick=quick))["cases"]["shot"]
        for quick in (True, False)))
    assert all(rows[-1]["steps"] == steps[-1] for rows in full.values())
    for label, rows in quick.items():
        assert rows == full[label][:len(rows)]
        assert sum(row["limit"] < ASYMPTOTIC for row in rows if row["steps"] in steps) <= 3 < len(steps)
    assert any(len(rows) < len(full[label]) for label, rows in quick.items())


@scenes([n for n in SCENES if any(r.slow_cases for r in modules.bind_scene(n).our_runners)])
def test_a_quick_validation_leaves_a_slow_run_out_and_a_full_one_does_not(name):
    quick, full = (select(name, measure.Plan(quick=quick)) for quick in (True, False))
    for runner in full.ours:
        for case in runner.slow_cases:
            p = full.scene.cases[case]
            assert runner in full.ours_for(p)
            assert runner.who not in [r.who for r in quick.ours_for(p)]
            assert any(runner.who in [r.who for r in quick.ours_for(q)] for q in quick.cases.values())
    assert any("our methods on" in note for note in quick.notes)


@scenes(SCENES, SAMPLE)
def test_nothing_departs_from_truth_without_having_been_predicted(name):
    result = measure.errors(name, BRIEF)
    for case in result["cases"].values():
        for curve in case["ours"] + case["engines"]:
            assert Verdict(curve["verdict"]) is not Verdict.DEPARTS, f"{curve['label']} {curve['message']}"
    first = result["picture"]["films"][0]
    assert first["role"] == ("ours" if modules.bind_scene(name).our_film else "truth") and first["frames"]


UNFINISHED = [(name, r.label, case) for name in SCENES for r in modules.bind_scene(name).our_runners if r.unfinished
              for case, p in modules.bind_scene(name).cases.items() if r.unfinished(p)]


def test_a_method_that_does_not_arrive_has_its_row_in_the_table():
    result = measure.errors("reach_2r", measure.Plan(speeds=("plain",), live=()))
    curve = next(c for c in result["cases"]["near the hole"]["ours"] if c["label"] == "pseudo-inverse")
    assert Verdict(curve["verdict"]) is Verdict.UNFINISHED and curve["rows"] == [] and "jumps" in curve["message"]
    assert "29 of 30 comparisons" in words.headline(result) and "1 does not arrive" in words.headline(result)
    said, = words.recorded(result)
    assert said.startswith("pybullet's runs are recorded ones, of pybullet 3.")


@pytest.mark.long
@pytest.mark.parametrize(("name", "label", "case"), UNFINISHED)
def test_what_is_said_not_to_arrive_does_not(name, label, case):
    """It fails, or it is off by more than theory allows a method that comes to rest."""
    selection = select(name, measure.Plan(speeds=("compiled",), quick=False))
    scene, p = selection.scene, selection.scene.cases[case]
    runner = next(r for r in scene.our_runners if r.label == label)
    bound, step = selection.bound(runner, "compiled")
    outcome, truth = run_to_end(bound, step, p, 1), np.array(scene.truth(p, scene.duration), dtype=float)
    assert outcome.failure or relative(outcome.observed, truth) > 10.0 * runner.largest_error(p, scene.duration)


def test_a_wrong_tensor_departs_and_a_table_without_motion_has_all_its_numbers(tmp_path):
    text = stub((modules.SOLUTIONS / "inertia_tensors.py").read_text(), {f"4.{k}" for k in range(1, 18)})
    assert text.count("0.375 * length * radius") == 1
    (tmp_path / "inertia_tensors.py").write_text(text.replace("0.375 * length * radius", "0.5 * length * radius"))
    result = measure.errors("tensors", measure.Plan(of=str(tmp_path), speeds=("plain",), live=()))
    verdicts = {case: is_right(one["ours"][0]) for case, one in result["cases"].items()}
    assert verdicts.pop("capsule") is False and all(verdicts.values())
    for case in result["cases"].values():
        for curve in case["ours"] + [e for e in case["engines"] if e["source"] != "missing"]:
            assert len(curve["rows"][-1]["observed"]) == len(case["truth"]) == len(case["quantities"])


def test_an_engine_that_leaves_its_own_rule_departs():
    runners = modules.bind_scene("tensors").runners
    right = next(r for r in runners if r.departure and r.who.variant == "automatic")
    wrong = right.departure._replace(own_law=lambda p, t: right.departure.own_law(p, t) * 1.001)
    changed = tuple(replace(r, departure=wrong) if r is right else r for r in runners)
    result = measure.errors("tensors", measure.Plan(speeds=("plain",), live=(), changes=(("runners", changed),)))
    assert {is_right(e) for one in result["cases"].values() for e in one["engines"]
            if e["label"] == right.label} == {False}


def test_a_wrong_method_departs(tmp_path):
    text = stub((modules.SOLUTIONS / "integrators.py").read_text(), {f"1.{k}" for k in range(1, 11)})
    (tmp_path / "integrators.py").write_text(text.replace("return x + dt * v_mid, v + dt *",
                                                          "return x + dt * v, v + dt *"))
    result = measure.errors("oscillator", measure.Plan(of=str(tmp_path), speeds=("plain",), live=(), most_steps=2000))
    verdicts = {c["label"]: is_right(c) for c in result["cases"]["under-damped"]["ours"]}
    assert verdicts["midpoint"] is False and verdicts["Verlet"] is True


VELOCITY_FIRST = "    v = v + dt * acceleration(t, x, v, p)\n    return x + dt * v, v\n"


@pytest.mark.parametrize(("body", "message"), [
    ("x + dt * v, v + dt * acceleration(t, x, v, p)", "as much as theory predicts at 100 steps, but in"),
    ("x + dt * v + 0.5 * dt * dt * acceleration(t, x, v, p), v + dt * acceleration(t, x, v, p)", "errs only"),
    ("x + dt * v + 1.01 * dt * dt * acceleration(t, x, v, p), v + dt * acceleration(t, x, v, p)", "errs 1.02 times")])
def test_a_method_must_err_as_theory_predicts_neither_less_nor_elsewhere(tmp_path, body, message):
    text = (modules.SOLUTIONS / "integrators.py").read_text()
    assert text.count(VELOCITY_FIRST) == 1
    (tmp_path / "integrators.py").write_text(text.replace("from .", "from solutions.")
                                             .replace(VELOCITY_FIRST, f"    return {body}\n"))
    result = measure.errors("throw", measure.Plan(of=str(tmp_path), speeds=("plain",), live=(), most_steps=100))
    curve = next(c for c in result["cases"]["thrown"]["ours"] if c["label"] == "symplectic Euler")
    assert curve["verdict"] == Verdict.DEPARTS and message in curve["message"]


def test_stubs_are_not_attempted_and_depart_from_nothing():
    result = measure.errors("oscillator", measure.Plan(of="lessons", speeds=("plain",), live=(), most_steps=200))
    for curve in result["cases"]["under-damped"]["ours"]:
        assert Verdict(curve["verdict"]) is Verdict.NOT_ATTEMPTED and "Exercise" in curve["message"]
    assert words.verdict(result["cases"]["under-damped"]["ours"])[1] == "open"


@scenes([n for n in SCENES if any(r.who.product == PYBULLET for r in modules.bind_scene(n).engine_runners)])
def test_without_pybullet_its_record_stands_in_and_says_so(name):
    selection = select(name, measure.Plan(speeds=("plain",), live=()))
    case, p = selection.first
    truth = np.array(selection.scene.truth(p, selection.scene.duration), dtype=float)
    curves = [engine_curve(selection, case, runner, p, truth) for runner in selection.engines_for(p)
              if runner.who.product == PYBULLET]
    assert curves and all(c["source"].startswith("recorded, pybullet") and c["rows"] for c in curves)


def test_same_scene_same_bits():
    first, second = (measure.errors("oscillator", measure.Plan(speeds=("plain",), live=LIVE, most_steps=100))
                     for _ in range(2))
    assert first == second


@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
def test_a_step_must_be_positive_and_finite(value):
    with pytest.raises(BadInput, match="step dt"):
        integrators.advance(integrators.euler_step, integrators.oscillator_acceleration, 0.0, np.ones(1), np.ones(1),
                            value, 1,
                            integrators.Oscillator(1.0, 0.0))


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_a_state_must_be_finite(value):
    with pytest.raises(BadInput, match=str(value)):
        integrators.advance(integrators.euler_step, integrators.oscillator_acceleration, 0.0, np.array([value]),
                            np.ones(1), 0.1, 1,
                            integrators.Oscillator(1.0, 0.0))


def test_a_method_with_a_law_of_its_own_must_follow_that_law(tmp_path):
    """With the cone in its place the pyramid would agree with the truth: that is a departure, too."""
    text = (modules.SOLUTIONS / "friction.py").read_text().replace("from .", "from solutions.")
    cone = "\n\ndef pyramid_impulse(u, m, N, mu, t_1, t_2):\n    return friction_impulse(u, m, N, mu)\n"
    for own, expected in (("", True), (cone, False)):
        (tmp_path / "friction.py").write_text(text + own)
        result = measure.errors("stopping_block",
                                measure.Plan(of=str(tmp_path), speeds=("plain",), live=(), most_steps=200))
        verdicts = {c["label"]: is_right(c) for c in result["cases"]["heading 22.5°"]["ours"]}
        assert verdicts["pyramid"] is expected and verdicts["sliding"] is True


def test_no_two_curves_of_a_scene_look_alike():
    """Methods differ in colour and in marker; variants of an engine in marker or line."""
    for name in modules.scene_names():
        scene = modules.bind_scene(name)
        ours, witnesses = [r.who for r in scene.our_runners], [r.who for r in scene.engine_runners]
        for looks in ([m.colour for m in ours], [m.marker for m in ours],
                      [methods.engine_look(e, witnesses) for e in witnesses]):
            assert len(set(looks)) == len(looks), name
        assert not {m.colour for m in ours} & {product.colour for product in PRODUCTS}


# things that scenes are about: what one scene says of its limits must not speak of the things of another
THINGS = set("arch ball block bowl box card chain cloth cradle cylinder disc domino house machine mesh net particle "
             "pendulum pile planet rod rope spring stack star top triangle turntable wedge".split())


def things_in(text):
    """The THINGS that a text names, in singular or plural."""
    found = re.findall(r"[a-z]+", text.lower())
    return THINGS & {one for word in found for one in (word, word.removesuffix("s"), word.removesuffix("es"))}


def own_things(name):
    """The THINGS that the texts in the file of a scene name: docstrings, titles, meanings and reasons."""
    tree = ast.parse(modules.scene_files()[name].read_text(encoding="utf-8"))
    return things_in(" ".join(node.value for node in ast.walk(tree)
                              if isinstance(node, ast.Constant) and isinstance(node.value, str)))


@pytest.mark.parametrize("name", SCENES)
def test_a_page_speaks_of_its_own_scene_where_it_explains_its_limits(name):
    """The report prints the docstrings of the functions, and some of these serve several scenes."""
    assert things_in(theory(modules.bind_scene(name))) <= own_things(name)


def test_a_word_of_another_scene_is_noticed():
    text = "In a rope its sweeps do not finish, and the band is half of the error."
    assert things_in(text) == {"rope"} <= own_things("rope") and not {"rope"} <= own_things("pendulum")
