"""What scenes leave out: the whole loop gives the same motion, and each scene is measured or says why not."""

import pytest

from validate import measure, methods
from validate.measure import full_loop, staged
from validate.report import audit, words
from validate.subject import modules

PLAN = measure.Plan(speeds=("plain",), live=(), quick=False)
EARLIER = [name for name in modules.scene_names()
           if modules.bind_scene(name).lesson not in ("simulator", "kinematics", "sensitivities")]
LOOPS = ("rolling_down", "incline", "stopping_block", "heavy_top", "throw", "catenary", "bounces", "point_and_plane",
         "point_and_cylinder", "pendulum", "rope")


@pytest.mark.parametrize("name", EARLIER)
def test_a_scene_is_measured_against_the_whole_loop_or_says_why_not(name):
    scene = modules.bind_scene(name)
    covered = any(runner.who in full_loop.FULL for runner in scene.our_runners)
    assert covered != bool(scene.full_loop), "give the field full_loop a sentence, or leave it out"


def agreeing(name):
    """A result in which all methods agree with 100 steps or more, because finding out takes long."""
    rows = [{"steps": n, "failure": "diverged" if n < 100 else None} for n in modules.bind_scene(name).steps]
    return {"cases": {"first": {"ours": [{"label": r.label, "verdict": "agrees", "rows": rows}
                                         for r in modules.bind_scene(name).our_runners]}}}


@pytest.mark.parametrize("name", LOOPS)
def test_the_whole_loop_moves_as_the_scene_does_and_takes_longer(name, monkeypatch):
    monkeypatch.setattr(full_loop, "interleaved", lambda items, limits, repeats: [
        (item, {"seconds": seconds, "repeats": [seconds]}) for item, seconds in zip(items, (1.0, 3.0), strict=True)])
    found = full_loop.left_out(name, PLAN, agreeing(name))
    assert found["same"] and found["ratio"] == 3.0 and found["note"] == ""


def test_a_loop_that_moves_otherwise_is_noticed_and_the_audit_checks_the_ratio(monkeypatch):
    monkeypatch.setattr(full_loop, "interleaved", lambda items, limits, repeats: [
        (item, {"seconds": seconds, "repeats": [seconds]}) for item, seconds in zip(items, (1.0, 3.0), strict=True)])

    def heavier(lessons):
        step = full_loop.block(lessons)
        return lambda acceleration, t, x, v, dt, p: step(lambda *now: 1.001 * acceleration(*now), t, x, v, dt, p)
    monkeypatch.setitem(full_loop.FULL, methods.SLIDING, heavier)
    found = full_loop.left_out("incline", PLAN, agreeing("incline"))
    assert not found["same"]
    result = {"cases": {}, "times": {"rows": [], "time_to_error": [], "races": [], "calls": [], "ablations": [],
                                     "left_out": {**found, "observed": [list(o) for o in found["observed"]]}}}
    assert list(audit.of_times(result, {"times": 0})) == []
    result["times"]["left_out"]["ratio"] = 2.0
    assert len(list(audit.of_times(result, {"times": 0}))) == 1


@pytest.mark.parametrize(("scene", "setting", "value"), [
    ("pendulum", "SLENDER", 1e-6), ("point_and_cylinder", "GRIP", 0.1)])
def test_a_rod_that_is_no_string_and_a_target_that_does_not_hold_are_noticed(scene, setting, value, monkeypatch):
    monkeypatch.setattr(full_loop, "interleaved", lambda items, limits, repeats: [
        (item, {"seconds": 1.0, "repeats": [1.0]}) for item in items])
    monkeypatch.setattr(full_loop, setting, value)
    assert full_loop.left_out(scene, PLAN, agreeing(scene))["same"] is False


@pytest.mark.parametrize(("name", "needed"), [
    ("throw", set()), ("heavy_top", {"rotation"}), ("rolling_down", {"rotation", "detection", "contact"}),
    ("bounces", set()), ("point_and_plane", {"detection", "contact"})])
def test_a_part_left_out_of_the_whole_loop_changes_the_motion_only_where_it_is_needed(name, needed, monkeypatch):
    monkeypatch.setattr(full_loop, "interleaved", lambda items, limits, repeats: [
        (item, {"seconds": 1.0, "repeats": [1.0]}) for item in items])
    selection = measure.select(name, PLAN)
    found = full_loop.whole_parts(selection, agreeing(name))
    assert {one["part"] for one in found["rows"]} == set(staged.PARTS)
    assert {one["part"] for one in found["rows"] if words.change_without(one) != "same"} == needed


@pytest.mark.parametrize("name", ["throw", "rolling_down"])
def test_the_whole_loop_of_which_nothing_is_left_out_is_that_of_the_lesson(name):
    """A part that has no name leaves out nothing, so that only what is left out makes a difference."""
    one = full_loop.stand(measure.select(name, PLAN), agreeing(name))
    lessons = one.selection.scene.lessons
    ends = [one.end(full_loop.made_when_called(one.whole(which))).observed
            for which in (lessons, staged.lessons_without(lessons, "nothing"))]
    assert ends[0].tolist() == ends[1].tolist()


def test_a_quick_run_leaves_it_to_a_full_one():
    assert full_loop.left_out("throw", PLAN._replace(quick=True), agreeing("throw"))["note"] == "left to --full"
