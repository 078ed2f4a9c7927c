"""In every scene the reference solution agrees with published values, no method departs, and a wrong one would."""

import math

import numpy as np
import pytest

from solutions import integrators
from solutions.checks import BadInput
from validate import binding, engines, measure
from validate.generate import stub
from validate.report import words

SCENES = binding.scene_names()
MOVING = [n for n in SCENES if measure.still(binding.bind_scene(n)) is None]
REFINED = [n for n in SCENES if measure.still(binding.bind_scene(n)) != ""]
LIVE = tuple(name for name in engines.NAMES if engines.installed(name))
BRIEF = measure.Plan(speeds=("plain",), live=LIVE, most_steps=500)


def scenes(names):
    """Run a test for each of these scenes. Tests of one scene share a process, which computes its reference once."""
    each = [pytest.param(name, marks=pytest.mark.xdist_group(f"scene {name}")) for name in names]
    return pytest.mark.parametrize("name", each)


@scenes(SCENES)
def test_a_truth_reproduces_published_values(name):
    scene = binding.bind_scene(name)
    p = next(iter(scene.CASES.values()))
    for t, expected, tolerance in getattr(scene, "PUBLISHED", ()):
        assert np.allclose(scene.truth(p, t), expected, rtol=0.0, atol=tolerance)


@scenes([n for n in SCENES if hasattr(binding.bind_scene(n), "published")])
def test_published_claims_other_than_the_motion_hold(name):
    for claim, found, expected, tolerance in binding.bind_scene(name).published():
        error = np.abs(np.asarray(found) - expected)
        assert np.all(error <= tolerance), f"{claim}: {found}, expected {expected} ± {tolerance}"


@scenes(MOVING)
def test_a_truth_starts_at_the_start_of_the_scene(name):
    scene = binding.bind_scene(name)
    for p in scene.CASES.values():
        begin = scene.observe(scene.start(p), p)
        assert np.allclose(scene.truth(p, 0.0), begin, rtol=0.0, atol=1e-9 * (1.0 + np.abs(begin).max()))


@scenes([n for n in SCENES if hasattr(binding.bind_scene(n), "poses")])
def test_poses_are_positions_and_unit_quaternions_along_the_motion(name):
    scene = binding.bind_scene(name)
    p = next(iter(scene.CASES.values()))
    for t in (0.0, 0.37 * scene.T, scene.T):
        observed = np.array(scene.truth(p, t), dtype=float)
        poses = np.array(scene.poses(observed, p), dtype=float)
        assert poses.shape == (len(scene.bodies(p)), 7) and np.all(np.isfinite(poses))
        # round-off of quaternions computed from R
        assert np.allclose(np.linalg.norm(poses[:, 3:], axis=1), 1.0, rtol=0.0, atol=1e-12)


@scenes(REFINED)
def test_steps_span_two_decades(name):
    steps = binding.bind_scene(name).STEPS
    assert list(steps) == sorted(steps) and steps[-1] >= 100 * steps[0]


@scenes(SCENES)
def test_nothing_departs_from_truth_without_having_been_predicted(name):
    result = measure.errors(name, BRIEF)
    for case in result["cases"].values():
        for curve in case["ours"] + case["engines"]:
            assert curve["right"] is not False, f"{curve['label']} {curve['why']}"
    assert result["picture"]["frames"]["truth"]


def test_a_wrong_tensor_departs_and_a_table_without_motion_has_all_its_numbers(tmp_path):
    text = stub((binding.SOLUTIONS / "inertia_tensors.py").read_text(), {f"4.{k}" for k in range(1, 18)})
    assert text.count("0.375 * length * radius") == 1
    (tmp_path / "inertia_tensors.py").write_text(text.replace("0.375 * length * radius", "0.5 * length * radius"))
    result = measure.errors("tensors", measure.Plan(of=str(tmp_path), speeds=("plain",), live=()))
    verdicts = {case: one["ours"][0]["right"] for case, one in result["cases"].items()}
    assert verdicts.pop("capsule") is False and all(verdicts.values())
    for case in result["cases"].values():
        for curve in case["ours"] + [e for e in case["engines"] if e["source"] != "missing"]:
            assert len(curve["observed"][-1]["observed"]) == len(case["truth"]) == len(case["quantities"])


def test_an_engine_that_leaves_its_own_rule_departs(monkeypatch):
    scene = binding.bind_scene("tensors")
    why, rule = scene.WHY["pybullet, automatic"]
    monkeypatch.setitem(scene.WHY, "pybullet, automatic", (why, lambda p, t: rule(p, t) * 1.001))
    result = measure.errors("tensors", measure.Plan(speeds=("plain",), live=()))
    curves = [e for one in result["cases"].values() for e in one["engines"]]
    assert {e["right"] for e in curves if e["label"] == "pybullet, automatic"} == {False}


def test_a_wrong_method_departs(tmp_path):
    text = stub((binding.SOLUTIONS / "integrators.py").read_text(), {f"1.{k}" for k in range(1, 11)})
    wrong = text.replace("return x + dt * v_mid, v + dt *", "return x + dt * v, v + dt *")
    (tmp_path / "integrators.py").write_text(wrong)
    result = measure.errors("oscillator", measure.Plan(of=str(tmp_path), speeds=("plain",), live=(), most_steps=2000))
    verdicts = {c["label"]: c["right"] for c in result["cases"]["under-damped"]["ours"]}
    assert verdicts["midpoint"] is False and verdicts["Verlet"] is True


def test_stubs_are_not_attempted_and_depart_from_nothing():
    result = measure.errors("oscillator", measure.Plan(of="lessons", speeds=("plain",), live=(), most_steps=200))
    for curve in result["cases"]["under-damped"]["ours"]:
        assert curve["right"] is None and "Exercise" in curve["why"]
    assert words.verdict(result["cases"]["under-damped"]["ours"])[1] == "open"


@scenes([n for n in SCENES if any(e.label.startswith("pybullet") for e in binding.bind_scene(n).ENGINES)])
def test_without_pybullet_its_record_replaces_it_and_is_labelled(name):
    scene = binding.bind_scene(name)
    case, p = next(iter(scene.CASES.items()))
    truth = np.array(scene.truth(p, scene.T), dtype=float)
    curves = [measure.engine_curve(name, scene, case, engine, p, truth, measure.Plan(speeds=("plain",), live=()))
              for engine in measure.engines_of(scene, p) if engine.label.startswith("pybullet")]
    assert curves and all(c["source"].startswith("recorded, pybullet") and c["rows"] for c in curves)


def test_the_same_scene_gives_the_same_bits():
    plan = measure.Plan(speeds=("plain",), live=LIVE, most_steps=100)
    first, second = (measure.errors("oscillator", plan) for _ in range(2))
    assert first == second


def test_time_to_an_error_is_interpolated_between_points():
    points = [(1e-1, 1.0), (1e-3, 100.0)]
    assert measure.time_to(points, 1e-2) == pytest.approx(10.0)
    assert measure.time_to(points, 1e-4) is None
    assert measure.time_to(points, 1.0) == 1.0


@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
def test_a_step_must_be_positive_and_finite(value):
    with pytest.raises(BadInput, match="step dt"):
        integrators.advance(integrators.euler_step, integrators.oscillator_acceleration, 0.0,
                            np.ones(1), np.ones(1), value, 1, integrators.Oscillator(1.0, 0.0))


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_a_state_must_be_finite(value):
    with pytest.raises(BadInput, match=str(value)):
        integrators.advance(integrators.euler_step, integrators.oscillator_acceleration, 0.0,
                            np.array([value]), np.ones(1), 0.1, 1, integrators.Oscillator(1.0, 0.0))


def test_a_method_with_a_law_of_its_own_must_follow_that_law(tmp_path):
    """If the pyramid used the cone's impulse, it would agree with the reference solution. That is a departure, too."""
    text = (binding.SOLUTIONS / "friction.py").read_text()
    pyramid = "pyramid_impulse(v_free, 1.0, normal_force(pull, p.n), p.mu_k, t_1, t_2)"
    assert pyramid in text
    cone = "friction_impulse(v_free, 1.0, normal_force(pull, p.n), p.mu_k)"
    for replacement, expected in ((pyramid, True), (cone, False)):
        (tmp_path / "friction.py").write_text(text.replace("from .", "from solutions.").replace(pyramid, replacement))
        result = measure.errors("stopping_block",
                                measure.Plan(of=str(tmp_path), speeds=("plain",), live=(), most_steps=200))
        verdicts = {c["label"]: c["right"] for c in result["cases"]["heading 22.5°"]["ours"]}
        assert verdicts["pyramid"] is expected and verdicts["sliding"] is True
