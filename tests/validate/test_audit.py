"""`validate audit` derives every figure of a report again, and notices when one was changed."""

import copy
import json
import re
import shutil
import subprocess

import pytest

from validate import __main__ as command
from validate import report
from validate.measure.races import races
from validate.measure.timing import times_to_error
from validate.report import again, plots, required
from validate.report.audit import audit
from validate.stability.examine import all_cases

from .small_report import small_report
from .test_cli import here  # noqa: F401    a fixture

KEPT = required.kept
pytestmark = pytest.mark.xdist_group("coverage")          # a report has the table of coverage: made once


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A small report: one scene with its engines, one stability case."""
    folder = tmp_path_factory.mktemp("report")
    data = small_report(("throw", "tensors"), ("thin-bodies",))
    data = json.loads(json.dumps({**data, "scenes": [as_if_compiled(result) for result in data["scenes"]]}))
    write(folder, data)
    return folder, data


@pytest.fixture(autouse=True)
def a_short_list(made, monkeypatch):
    """The list of what must be there has only the stability case of the small report."""
    must = required.derived(made[1]["stability"])
    monkeypatch.setattr(required, "kept", lambda run, same_code: must)


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
    problems, counts, notes = audit(*made)
    assert problems == notes == [] and min(counts.values()) > 0, (problems, counts, notes)


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
    "what comes before a race": lambda d: d["scenes"][0]["times"].update(
        preparations=[{"label": "no method", "seconds": 1.0, "with": [2.0], "without": []}]),
    "a ratio that is left out": lambda d: race(d).update(ratio=None),
    "a loss that is called undecided": lambda d: race(d).update(ratio=None, outcome="undecided"),
    "a compilation of another method": lambda d: d["scenes"][0]["times"].update(
        compilation={"label": "no method", "cold": 4.0, "cached": 0.3}),
    "an outcome": lambda d: race(d).update(outcome="a tie" if race(d)["outcome"] == "faster" else "faster"),
    "a time to an error": lambda d: d["scenes"][0]["times"]["time_to_error"][0]["seconds"].__setitem__(1, 1.0),
    "a finding": lambda d: d["stability"][0]["findings"][0].update(holds=False),
    "a measured number": lambda d: d["stability"][0]["findings"][0].update(measured=1e9),
    "a claim without numbers": lambda d: d["stability"][0].update(findings=[]),
    "a tolerance": lambda d: finding(d).update(tolerance=1.01 * finding(d)["tolerance"]),
    "a tolerance with a measured number to suit": lambda d: finding(d).update(
        tolerance=1.0, measured=finding(d)["predicted"] + 0.5),
    "the law of a finding": lambda d: finding(d).update(
        predicted=finding(d)["predicted"] + 0.5 * finding(d)["tolerance"]),
    "a finding that is missing": lambda d: d["stability"][0]["findings"].pop(),
    "a stability case that is missing": lambda d: d["stability"].pop(),
    "a scene that is missing": lambda d: d["scenes"].pop(0),
    "a case that is missing": lambda d: d["scenes"][0]["cases"].popitem(),
    "a method that is missing": lambda d: d["scenes"][0]["cases"]["thrown"]["ours"].pop(),
    "a setting of an engine that is missing": lambda d: d["scenes"][0]["cases"]["thrown"]["engines"].pop(),
    "a method that no scene has": lambda d: last_of_ours(d).update(label="an unknown step"),
}


def finding(data):
    return next(f for f in data["stability"][0]["findings"] if f["tolerance"])


def last_of_ours(data):
    return data["scenes"][0]["cases"]["thrown"]["ours"][-1]


@pytest.mark.parametrize("fault", FAULTS)
def test_a_figure_that_was_changed_is_noticed_even_if_the_pages_agree_with_it(made, tmp_path, fault, monkeypatch):
    data = copy.deepcopy(made[1])
    FAULTS[fault](data)
    monkeypatch.setattr("validate.report.audit.pages_of", lambda *_: ([], 0))
    monkeypatch.setattr("validate.report.audit.picture_of", lambda *_: ([], 0))
    assert audit(tmp_path, data)[0], fault


def moved(picture):
    """The text of a picture in which one point of a curve is 40 pixels away; its mark is kept."""
    def away(found):
        return f"{found[1]}{float(found[2]) + 40.0}"
    text, count = re.subn(r"(<path d=\"M [\d.]+ [\d.]+ \n?L [\d.]+ )([\d.]+)", away, picture, count=1)
    assert count == 1
    return text


def with_a_new_mark(picture):
    """The same with a mark that agrees with its text, as a forger would write it."""
    text, mark = picture[:plots.MARK.search(picture).start()], plots.MARK.search(picture)
    return f"{text}<!-- {plots.DRAWN_FROM}{mark['data']} as {plots.of_text(text)} -->\n"


@pytest.mark.parametrize(("forge", "redraw", "says"), [
    (lambda text: text, True, ""), (moved, True, "changed after"), (moved, False, "changed after"),
    (lambda text: with_a_new_mark(moved(text)), True, "not what its data give")])
def test_a_point_that_was_moved_is_noticed(made, tmp_path, forge, redraw, says):
    folder, data = made
    plot, name, shown, _ = report.pictures(data["scenes"], data["stability"])[0]
    (tmp_path / name).write_text(forge((folder / name).read_text(encoding="utf-8")), encoding="utf-8")
    problems, _ = again.picture_of(tmp_path / name, plot.__name__, shown, redraw)
    assert len(problems) == bool(says) and all(says in problem for problem in problems)


def test_a_report_of_other_code_is_judged_by_its_own_list_and_the_rest_is_said(made, monkeypatch):
    folder, data = made
    other = {**data, "run": {**data["run"], "code": "another", "pages": "another"}}
    problems, counts, notes = audit(folder, other)
    assert problems == [] and counts["limits"] == counts["pages"] == 0 and len(notes) == 3
    monkeypatch.setattr(required, "kept", lambda run, same_code: None)
    assert len(audit(folder, other)[2]) == 4


def test_what_other_options_leave_out_is_not_missing(made):
    _, data = made
    must = required.kept(data["run"], True)
    slow = {**must, "scenes": {**must["scenes"], "throw": {**must["scenes"]["throw"], "cases": ["thrown", "slow one"],
                                                           "slow": ["slow one"]}}}
    assert list(required.missing(data, slow)) == []
    full = {**data, "run": {**data["run"], "mode": "full"}}
    assert list(required.missing(full, slow)) == ["throw: the case 'slow one' is missing"]
    everything = {**data, "run": {**data["run"], "chosen": []}}
    assert "oscillator: the scene is missing" in list(required.missing(everything, must))
    left = {**must, "slow": [required.place(data["stability"][0])]}
    without = {**data, "stability": []}
    assert list(required.missing(without, left)) == []
    assert list(required.missing({**full, "stability": []}, left)) == [
        f"{left['slow'][0]}: the stability case is missing"]
    not_run = copy.deepcopy(data)
    gone = not_run["stability"][0]["findings"].pop()
    not_run["stability"][0]["not_run"].append({"quantity": gone["quantity"], "claim": "", "why": ""})
    assert list(required.missing(not_run, must)) == []


@pytest.mark.skipif(shutil.which("git") is None, reason="git is not installed")
def test_a_report_of_an_older_commit_is_judged_by_the_list_of_that_commit(tmp_path, monkeypatch):
    file = tmp_path / "validate" / "report" / "required.json"
    file.parent.mkdir(parents=True)
    monkeypatch.setattr(required.modules, "ROOT", tmp_path)
    monkeypatch.setattr(required, "FILE", file)
    git = lambda *arguments: subprocess.run(["git", "-c", "user.name=a", "-c", "user.email=a@b", *arguments],
                                            cwd=tmp_path, check=True, capture_output=True, text=True).stdout.strip()
    git("init", "-q")
    file.write_text('{"scenes": {"old": 1}}')
    git("add", ".")
    git("commit", "-qm", "old")
    commit = git("rev-parse", "--short", "HEAD")
    file.write_text('{"scenes": {"new": 1}}')
    assert KEPT({"commit": commit}, True) == {"scenes": {"new": 1}}
    for name, known in ((commit, True), (f"{commit}, changed since", True), ("0000000", False), ("", False)):
        assert KEPT({"commit": name}, False) == ({"scenes": {"old": 1}} if known else None), name


def test_the_list_of_scenes_is_that_of_the_code():
    kept = json.loads(required.FILE.read_text(encoding="utf-8"))
    today = required.derived([])
    assert [kept[part] for part in ("scenes", "slow")] == [today[part] for part in ("scenes", "slow")], \
        "run: python -m validate.report.required"
    assert set(kept["findings"]) == {f"{case.lesson}/{case.slug}" for case in all_cases()}, \
        "run: python -m validate.report.required LESSON"


CHANGES = [("throw.html", "agrees", "departs"), ("index.html", "Throw", "Draw"),
           ("throw-steps.svg", "from data ", "data "), ("stability.html", "<h", "<H"), ("style.css", ":", ": ")]


def test_pages_and_pictures_that_were_changed_are_noticed(made, tmp_path):
    folder, data = made
    changed, names = shutil.copytree(folder, tmp_path / "changed"), {name for name, _, _ in CHANGES}
    for name, old, new in CHANGES:
        text = (folder / name).read_text(encoding="utf-8")
        assert old in text
        (changed / name).write_text(text.replace(old, new, 1), encoding="utf-8")
    problems = audit(changed, data)[0]
    assert {name for name in names if any(problem.startswith(name) for problem in problems)} == names
    assert len(problems) == len(names), "a file is named that was not changed"
    for name in names:
        (changed / name).unlink()
    assert {f"{name} is missing" for name in names} <= set(audit(changed, data)[0])


@pytest.mark.usefixtures("here")
def test_the_command_ends_with_1_when_something_differs(made, tmp_path, capsys):
    folder, data = made
    changed = copy.deepcopy(data)
    converging(changed)["verdict"] = "departs"
    write(tmp_path, changed)
    for report_folder, code in ((folder, 0), (tmp_path, 1), (tmp_path / "nothing", 2)):
        with pytest.raises(SystemExit) as ended:
            command.main(["audit", str(report_folder), "--jobs", "1"])
        said = capsys.readouterr()
        assert ended.value.code == code
        assert code == 2 or f"{'0' if code == 0 else '1'} differences in" in said.out, said.out
