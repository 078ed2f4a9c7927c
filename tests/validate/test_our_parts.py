"""Our loop, part by part: leaving out a part changes the motion only where the scene needs it."""

import json

import numpy as np
import pytest

from validate.measure import our_parts
from validate.measure.selection import Plan, select
from validate.report import audit, words
from validate.worlds.described import DESCRIBED
from validate.worlds.ours import lesson_of

PLAN = Plan(quick=False, speeds=("plain",))


@pytest.fixture(autouse=True)
def quick_clock(monkeypatch):
    """Nothing is timed: the loop with all parts takes three times as long as the others."""
    monkeypatch.setattr(our_parts, "interleaved", lambda items, limits, repeats: [
        (item, {"seconds": seconds, "repeats": [seconds]})
        for item, seconds in zip(items, [3.0] + [1.0] * (len(items) - 1), strict=True)])


def measured(name, **changes):
    selection = select(name, PLAN._replace(**changes))
    return our_parts.our_parts(selection, selection.first[1])


def parts(name):
    """{part: its row} of a scene, in plain Python."""
    return {row["part"]: row for row in measured(name)["rows"]}


@pytest.mark.parametrize(("name", "needed"), [
    ("oscillator", set()), ("linear_drag", set()),
    pytest.param("rod_chain", {"rotation", "joints"}, marks=pytest.mark.long),
    pytest.param("slide_then_roll", {"rotation", "detection", "contact", "friction"}, marks=pytest.mark.long)])
def test_a_part_that_is_left_out_changes_the_motion_where_the_scene_needs_it_and_only_there(name, needed, monkeypatch):
    monkeypatch.setattr(our_parts, "SEEN", 2.0)
    found = parts(name)
    alike = {part for part, row in found.items() if words.change_without(row) == "same"}
    assert found.keys() - alike - {our_parts.DIMENSION} == needed
    assert all(row["cost"] == 3.0 for part, row in found.items() if part != our_parts.DIMENSION)


def test_every_scene_runs_with_all_parts_as_it_does_with_its_own(monkeypatch):
    """Two steps of each: the loops differ in what they leave out, not in what they compute.

    In the machine the two searches list the contacts in different orders, and sweeps end when they change no impulse
    by more than a share.
    """
    monkeypatch.setattr(our_parts, "SEEN", 0.0)
    lesson = lesson_of("solutions")
    for name in DESCRIBED:
        within = lesson.Settings().settled if name == "machine" else 1e-9
        assert parts(name)[our_parts.TOTAL]["change"] < within, name


@pytest.mark.long
def test_the_loop_in_space_moves_as_the_one_in_the_plane(monkeypatch):
    monkeypatch.setattr(our_parts, "SEEN", 2.0)
    assert parts("slide_then_roll")[our_parts.DIMENSION]["change"] < 1e-9
    assert our_parts.DIMENSION not in parts("cradle") and our_parts.DIMENSION not in parts("oscillator")


def test_a_loop_with_another_law_is_noticed(monkeypatch):
    shaped = our_parts.shaped
    monkeypatch.setattr(our_parts, "shaped", lambda model: shaped(model)._replace(
        gravity=tuple(1.001 * g for g in model.gravity)))
    assert words.change_without(parts("slide_then_roll")[our_parts.TOTAL]) != "same"


def test_the_table_of_parts_names_functions_of_the_lesson_and_leaves_places_for_all():
    lesson = lesson_of("solutions")
    for functions, _ in our_parts.WITHOUT.values():
        assert all(hasattr(lesson, name) for name in (*functions, *filter(None, functions.values())))
        assert set(functions) <= {*our_parts.ALL, *our_parts.SMOOTH}
    assert max(len(our_parts.ALL), len(our_parts.SMOOTH)) <= 6              # places in a compiled step


def test_what_is_not_measured_says_why():
    assert measured("tensors") == {"rows": [], "note": "no motion is compared here"}
    assert "Python function" in measured("kepler", speeds=("plain", "compiled"))["note"]
    assert {row["speed"] for row in measured("kepler", speeds=("plain", "compiled"))["rows"]} == {"plain"}


def test_the_audit_derives_the_cost_and_the_change_of_a_part_again():
    found = json.loads(json.dumps(measured("slide_then_roll")))
    times = {"rows": [], "time_to_error": [], "races": [], "calls": [], "ablations": [], "our_parts": found}
    result = {"cases": {"only": {"ours": [], "engines": []}}, "times": times}
    assert list(audit.of_times(result, {"times": 0})) == []
    found["rows"][0]["cost"] *= 1.1
    found["rows"][1]["change"] = 0.5
    assert len(list(audit.of_times(result, {"times": 0}))) == 2


def test_a_run_that_is_not_finite_has_no_change():
    run = our_parts.Run(lambda steps, dt: np.array([np.nan]), lambda state: state)
    assert our_parts.observed(run, 1, 0.1) is None
