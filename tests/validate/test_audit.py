"""`validate audit` derives every figure of a report again, and notices when one was changed."""

import copy
import json

import pytest

from validate import __main__ as command
from validate import report
from validate.measure.races import races
from validate.measure.timing import times_to_error
from validate.report import plots
from validate.report.audit import audit

from .small_report import small_report

pytestmark = pytest.mark.xdist_group("coverage")          # a report has the table of coverage: made once


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A small report: one scene with its engines, one stability case."""
    folder = tmp_path_factory.mktemp("report")
    data = small_report(("throw", "tensors"), ("thin-bodies",))
    data = json.loads(json.dumps({**data, "scenes": [as_if_compiled(result) for result in data["scenes"]]}))
    write(folder, data)
    return folder, data


def as_if_compiled(result):
    """The same result with plain times as those of compiled code: plain Python alone decides few races."""
    times = result["times"]
    rows = [{**row, "speed": "compiled" if row["speed"] == "plain" else row["speed"]} for row in times["rows"]]
    case, live = next(iter(result["cases"].values())), [one["product"] for one in times["calls"]]
    return {**result, "times": {**times, "rows": rows, "time_to_error": times_to_error(rows),
                                "races": races(rows, case, live, True, times["calls"])}}


def write(folder, data):
    for name, text in report.texts(data["scenes"], data["stability"], data["run"]).items():
        (folder / name).write_bytes(text.encode())
    for plot, name, shown, _ in report.pictures(data["scenes"], data["stability"]):
        plots.draw(plot, folder / name, shown)


def curves(data):
    return [curve for scene in data["scenes"] for case in scene["cases"].values()
            for curve in case["ours"] + case["engines"]]


def converging(data):
    return next(curve for curve in curves(data) if curve["order"] is not None)


def last(data):
    return converging(data)["rows"][-1]


def converging_truth(data):
    return next(case["truth"] for scene in data["scenes"] for case in scene["cases"].values()
                if converging(data) in case["ours"] + case["engines"])


def own(data):
    return next(curve for curve in curves(data) if "own_law" in curve)


def timed(data):
    return next(row for row in data["scenes"][0]["times"]["rows"] if row["repeats"])


def race(data):
    return next(one for one in data["scenes"][0]["times"]["races"] if one["ratio"])


def test_a_report_follows_from_its_raw_rows(made):
    problems, counts = audit(*made)
    assert problems == [] and min(counts.values()) > 0, (problems, counts)


FAULTS = {
    "an error": lambda d: last(d).update(error=1.001 * last(d)["error"]),
    "what was observed": lambda d: last(d).update(observed=[x + 1e-3 for x in last(d)["observed"]]),
    "half of what was observed": lambda d: last(d).update(observed=[0.0]),
    "a missing row": lambda d: last(d).update(observed=None),
    "an order": lambda d: converging(d).update(order=converging(d)["order"] + 0.01),
    "a verdict": lambda d: converging(d).update(verdict="as predicted"),
    "a verdict on too large an error": lambda d: last(d).update(limit=1e-30),
    "a step": lambda d: last(d).update(dt=2.0 * last(d)["dt"]),
    "a departure": lambda d: own(d).update(departure=1.01 * own(d)["departure"]),
    "a prediction": lambda d: last(d).update(predicted=[2.0 * x for x in last(d)["predicted"]]),
    "a band": lambda d: last(d).update(band=2.0 * last(d)["band"]),
    "a verdict on less error than predicted": lambda d: last(d).update(observed=converging_truth(d), error=0.0),
    "a limit": lambda d: last(d).update(limit=1.01 * last(d)["limit"]),
    "a median": lambda d: timed(d).update(seconds=1.01 * timed(d)["seconds"]),
    "a repeat": lambda d: timed(d)["repeats"].append(1.0),
    "no repeats": lambda d: timed(d).update(repeats=[]),
    "the error beside a time": lambda d: timed(d).update(error=0.5),
    "a ratio": lambda d: race(d).update(ratio=1.1 * race(d)["ratio"]),
    "our time": lambda d: race(d)["ours"].update(seconds=0.9 * race(d)["ours"]["seconds"]),
    "an engine's time": lambda d: race(d)["engine"].update(seconds=1.1 * race(d)["engine"]["seconds"]),
    "the error of a race": lambda d: race(d).update(error=1.1 * race(d)["error"]),
    "the range of a ratio": lambda d: race(d).update(low=2.0 * race(d)["low"]),
    "a part of a ratio": lambda d: race(d).update(order=7.0),
    "what calls cost in a race": lambda d: race(d).update(calls=7.0),
    "what a call costs": lambda d: d["scenes"][0]["times"]["calls"][0].update(seconds=1.0),
    "a ratio that is left out": lambda d: race(d).update(ratio=None),
    "a loss that is called undecided": lambda d: race(d).update(ratio=None, outcome="undecided"),
    "a compilation of another method": lambda d: d["scenes"][0]["times"].update(
        compilation={"label": "no method", "cold": 4.0, "cached": 0.3}),
    "an outcome": lambda d: race(d).update(outcome="a tie" if race(d)["outcome"] == "faster" else "faster"),
    "a time to an error": lambda d: d["scenes"][0]["times"]["time_to_error"][0]["seconds"].__setitem__(1, 1.0),
    "a finding": lambda d: d["stability"][0]["findings"][0].update(holds=False),
    "a measured number": lambda d: d["stability"][0]["findings"][0].update(measured=1e9),
    "a claim without numbers": lambda d: d["stability"][0].update(findings=[]),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_figure_that_was_changed_is_noticed_even_if_the_pages_agree_with_it(made, tmp_path, fault, monkeypatch):
    data = copy.deepcopy(made[1])
    FAULTS[fault](data)
    monkeypatch.setattr("validate.report.audit.of_pages", lambda *_: [])
    assert audit(tmp_path, data)[0], fault


@pytest.mark.parametrize(("name", "old", "new"), [
    ("throw.html", "agrees", "departs"), ("index.html", "Throw", "Draw"), ("throw-steps.svg", "from data ", "data "),
    ("stability.html", "<h", "<H"), ("style.css", ":", ": ")])
def test_a_page_or_a_picture_that_was_changed_is_noticed(made, name, old, new):
    folder, data = made
    text = (folder / name).read_text(encoding="utf-8")
    assert old in text
    try:
        (folder / name).write_text(text.replace(old, new, 1), encoding="utf-8")
        assert [problem for problem in audit(folder, data)[0] if problem.startswith(name)]
        (folder / name).unlink()
        assert f"{name} is missing" in audit(folder, data)[0]
    finally:
        (folder / name).write_text(text, encoding="utf-8")


def test_the_command_ends_with_1_when_something_differs(made, tmp_path, capsys):
    folder, data = made
    changed = copy.deepcopy(data)
    converging(changed)["verdict"] = "departs"
    write(tmp_path, changed)
    for report_folder, code in ((folder, 0), (tmp_path, 1), (tmp_path / "nothing", 2)):
        with pytest.raises(SystemExit) as ended:
            command.main(["audit", str(report_folder)])
        said = capsys.readouterr()
        assert ended.value.code == code
        assert code == 2 or f"{'0' if code == 0 else '1'} differences in" in said.out, said.out
