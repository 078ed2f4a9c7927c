"""`validate compare` names what changed between two reports, and ends with 1 when something became worse."""

import copy
import json

import pytest

from solutions.checks import BadInput
from validate import __main__ as command
from validate.report.compare import changes
from validate.run.store import FORMAT


def row(label, speed, seconds):
    return {"label": label, "speed": speed, "steps": 100,
            "seconds": seconds, "low": 0.9 * seconds, "high": 1.1 * seconds}


def curve(role, label, errors, verdict="agrees"):
    rows = [{"steps": n, "error": e} for n, e in zip((10, 20, 40), errors, strict=True)]
    return {"role": role, "label": label, "rows": rows, "order": 2.0, "verdict": verdict, "message": ""}


@pytest.fixture
def report():
    ours = [curve("ours", "Verlet", (4e-2, 1e-2, 2.5e-3)), curve("ours", "exact", (1e-13, 2e-13, 3e-13))]
    engines = [curve("engine", "pymunk", (0.1, 0.05, 0.02), "as predicted")]
    times = {"rows": [row("Verlet", "compiled", 1e-4), row("exact", "plain", 1e-3), row("pymunk", "engine", 1e-2)]}
    scene = {"scene": "throw", "cases": {"one": {"ours": ours, "engines": engines}}, "times": times}
    found = [{"quantity": "edge [-]", "claim": "Stable below 2.", "measured": 2.0, "holds": True},
             {"quantity": "edge [-]", "claim": "Unstable above 2.", "measured": 2.0, "holds": True}]
    return {"run": {}, "scenes": [scene], "stability": [{"lesson": "integrators", "slug": "limits", "findings": found}]}


def first_curve(report):
    return report["scenes"][0]["cases"]["one"]["ours"][0]


def kinds(old, new):
    return [(change.kind, change.worse) for change in changes(old, new)]


def test_equal_reports_have_no_changes(report):
    assert kinds(report, copy.deepcopy(report)) == []


def test_a_verdict_that_turns_is_named_first_and_is_worse_in_one_direction_only(report):
    new = copy.deepcopy(report)
    first_curve(new).update(verdict="departs", message="3 times what theory allows")
    assert kinds(report, new) == [("verdicts", True)] and kinds(new, report) == [("verdicts", False)]
    (change,) = changes(report, new)
    assert change.place == "throw, one: Verlet" and change.words == "agrees → departs (3 times what theory allows)"


def test_a_curve_or_a_finding_that_is_gone_is_worse_and_a_new_one_is_not(report):
    new = copy.deepcopy(report)
    del new["scenes"][0]["cases"]["one"]["ours"][0]
    del new["stability"][0]["findings"][1]
    new["scenes"][0]["times"]["rows"] = []
    assert kinds(report, new) == [("verdicts", True), ("findings", True)]
    assert kinds(new, report) == [("verdicts", False), ("findings", False)]


def test_a_finding_that_fails_now_is_worse_and_one_that_is_reworded_is_no_change(report):
    new = copy.deepcopy(report)
    new["stability"][0]["findings"][0]["claim"] = "It is stable below 2."
    assert kinds(report, new) == []
    new["stability"][0]["findings"][1].update(holds=False, measured=2.5)
    assert kinds(report, new) == [("findings", True)] and "2.5" in changes(report, new)[0].words


def test_a_finding_that_this_machine_cannot_make_is_not_worse(report):
    new = copy.deepcopy(report)
    gone = new["stability"][0]["findings"].pop()
    new["stability"][0]["not_run"] = [{"claim": gone["claim"], "quantity": gone["quantity"], "why": "not installed"}]
    assert kinds(report, new) == [("findings", False)] and "was not run" in changes(report, new)[0].words


def test_errors_and_orders_are_listed_beyond_noise_and_round_off_is_not(report):
    new = copy.deepcopy(report)
    first_curve(new)["rows"][2]["error"] *= 1.005
    new["scenes"][0]["cases"]["one"]["ours"][1]["rows"][0]["error"] *= 7.0            # of 1e-13
    assert kinds(report, new) == []
    first_curve(new)["rows"][2]["error"] *= 1.5
    first_curve(new)["order"] = 1.8
    assert kinds(report, new) == [("orders", False), ("errors", False)]               # the verdict still agrees
    first_curve(new)["verdict"] = "departs"
    assert kinds(report, new) == [("verdicts", True), ("orders", True), ("errors", True)]


@pytest.mark.parametrize(("factors", "expected"), [
    ((3.0, 3.0, 3.0), []),                                      # a slower machine
    ((1.15, 1.0, 1.0), []),                                     # within the ranges
    ((2.0, 1.0, 1.0), [("times", True)]), ((1.0, 0.4, 1.0), [("times", False)]),
    ((6.0, 3.0, 3.0), [("times", True)]),                       # on a slower machine
])
def test_times_are_compared_at_the_pace_of_the_engines_and_beyond_their_ranges(report, factors, expected):
    new = copy.deepcopy(report)
    for one, factor in zip(new["scenes"][0]["times"]["rows"], factors, strict=True):
        for key in ("seconds", "low", "high"):
            one[key] *= factor
    assert kinds(report, new) == expected


@pytest.mark.parametrize("old_format", [{}, {"format": 2}, {"format": FORMAT}])
def test_a_report_of_an_older_format_is_compared_by_what_both_record(report, old_format):
    new = copy.deepcopy(report)
    report["run"], new["run"] = old_format, {"format": FORMAT}
    new["scenes"][0]["agreed"] = False                         # older formats have no such record
    assert kinds(report, new) == []
    first_curve(new).update(verdict="departs", order=1.5)
    first_curve(new)["rows"][2]["error"] *= 2.0
    new["stability"][0]["findings"][0]["holds"] = False
    assert kinds(report, new) == [(kind, True) for kind in ("verdicts", "findings", "orders", "errors")]


@pytest.mark.parametrize(("old_format", "names"), [({}, "older than 2"), ({"format": 2}, "2")])
def test_reports_without_common_records_are_refused_by_their_formats(report, old_format, names):
    new = {**copy.deepcopy(report), "run": {"format": FORMAT}}
    report["run"] = old_format
    del first_curve(report)["verdict"]
    with pytest.raises(BadInput, match=f"with the formats {names} and {FORMAT}:"):
        changes(report, new)


def test_a_curve_of_an_engine_that_is_no_longer_known_is_gone(report):
    new = copy.deepcopy(report)
    new["scenes"][0]["times"]["rows"] = []
    engine = new["scenes"][0]["cases"]["one"]["engines"].pop()
    report["scenes"][0]["cases"]["one"]["engines"] = [{**engine, "product": "an engine of before"}]
    assert kinds(report, new) == [("verdicts", True)]


def test_the_command_says_when_the_formats_differ(report, tmp_path, capsys):
    for name, run in (("old", {"format": 2}), ("new", {"format": FORMAT})):
        (tmp_path / name).mkdir()
        (tmp_path / name / "report.json").write_text(json.dumps({**report, "run": run}))
    for pair, says in ((("old", "new"), True), (("new", "new"), False)):
        with pytest.raises(SystemExit) as ended:
            command.main(["compare", *(str(tmp_path / name) for name in pair)])
        assert ended.value.code == 0
        assert (f"Formats of the reports: 2 and {FORMAT}." in capsys.readouterr().out) == says


def test_the_command_ends_with_1_when_something_became_worse(report, tmp_path, capsys):
    new = copy.deepcopy(report)
    first_curve(new)["verdict"] = "departs"
    for name, content in (("old", report), ("new", new), ("odd", {**report, "scenes": [{}]})):
        (tmp_path / name).mkdir()
        (tmp_path / name / "report.json").write_text(json.dumps(content))
    for pair, code in ((("old", "new"), 1), (("new", "old"), 0), (("old", "old"), 0), (("old", "odd"), 2),
                       (("old", "nothing"), 2)):
        with pytest.raises(SystemExit) as ended:
            command.main(["compare", *(str(tmp_path / name) for name in pair)])
        said = capsys.readouterr()
        assert ended.value.code == code, pair
        assert code != 1 or "✗ throw, one: Verlet  agrees → departs" in said.out
        assert code != 2 or len(said.err.splitlines()) == 1


def slowed(report, factor):
    """The same report, in which Verlet takes longer."""
    new = copy.deepcopy(report)
    for key in ("seconds", "low", "high"):
        new["scenes"][0]["times"]["rows"][0][key] *= factor
    return new


def test_what_became_slower_is_named_with_its_ratio_and_on_a_busy_machine_it_is_not_worse(report):
    new = slowed(report, 3.0)
    (change,) = changes(report, new)
    assert change.place == "throw: Verlet, compiled" and change.words == "slower by 3× at 100 steps" and change.worse
    new["scenes"][0]["times"]["others"] = 1.0
    (change,) = changes(report, new)
    assert "busy machine" in change.words and not change.worse


def test_a_scene_without_an_engine_is_timed_in_the_steps_of_the_other_scenes_engines(report):
    new = slowed(report, 3.0)
    for one in (report, new):
        one["scenes"].append({**copy.deepcopy(one["scenes"][0]), "scene": "other"})
        one["scenes"][0]["times"]["rows"].pop()
        one["scenes"][1]["times"]["rows"] = one["scenes"][1]["times"]["rows"][2:]
    assert kinds(report, new) == [("times", True)]
