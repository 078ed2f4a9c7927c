"""The command line: bad input gets one sentence and exit code 2, an interrupted run goes on, a report has one code."""

import errno
import json
import re
import shutil
import signal
import subprocess
import sys
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path

import pytest

from solutions.checks import Diverged
from validate import __main__ as cli
from validate import measure, report
from validate.engines.products import PYBULLET, PYMUNK, Product
from validate.measure import record, traces
from validate.notebook.pytest_process import quiet
from validate.report import plots, summary
from validate.run import processes, store
from validate.run import run as validation
from validate.speed import piles
from validate.subject import modules
from validate.subject.generate import exercises, stub


def run(capsys, *arguments):
    """Exit code and what was written to standard output and error."""
    with pytest.raises(SystemExit) as end:
        cli.main(list(arguments))
    said = capsys.readouterr()
    return end.value.code or 0, said.out, said.err


@pytest.mark.parametrize(("arguments", "names"), [
    (["--scene", "moonwalk"], "moonwalk"),
    (["--lesson", "juggling"], "juggling"),
    (["--of", "no/such/folder"], "no/such/folder"),
    (["--scene", "oscillator", "--set", "m=-1"], "-1.0"),
    (["--scene", "oscillator", "--set", "m=0"], "0.0"),
    (["--scene", "oscillator", "--set", "k=nan"], "nan"),
    (["--scene", "oscillator", "--set", "k=inf"], "finite number"),
    (["--scene", "oscillator", "--set", "k=1e999"], "finite number"),
    (["--scene", "oscillator", "--set", "k=soft"], "soft"),
    (["--scene", "oscillator", "--set", "k"], "NAME=VALUE"),
    (["--scene", "oscillator", "--set", "=3"], "NAME=VALUE"),
    (["--scene", "cloth", "--set", "n=2.5"], "whole number"),
    (["--scene", "tensors", "--set", "shape=egg"], "capsule"),
    (["--scene", "catenary", "--set", "span=1e300"], "catenary with span = 1e+300"),
    (["--scene", "oscillator", "--set", "colour=3"], "colour"),
    (["--set", "m=1"], "--scene"),
    (["--scene", "pendulums"], "did you mean pendulum"),
    (["oscillator"], "did you mean --scene oscillator"),
    (["rotation"], "did you mean --lesson rotation"),
    (["piles", "--threads", "0"], "`validate piles --help`"),
    (["--jobs", "many"], "--jobs"),
    (["--bogus"], "--bogus"),
    *((["--engine", "my_engine.py", *option], option[0]) for option in (
        ["--lesson", "pbd"], ["--of", "lessons"], ["--set", "m=1"], ["--plain"], ["--jobs", "1"], ["--executor", "x"])),
])
def test_bad_input_is_told_in_one_sentence_and_nothing_is_written(capsys, tmp_path, arguments, names):
    out = tmp_path / "report"
    code, _, error = run(capsys, *arguments, "--out", str(out))
    assert code == 2 and names in error and len(error.strip().splitlines()) == 1 and "Traceback" not in error
    assert not out.exists()


def test_a_computation_that_diverges_is_told_in_one_sentence(capsys, monkeypatch):
    def sink(*arguments):
        raise Diverged("bodies sink into each other; the residual of their contacts [m/s]", 0.6, "take shorter steps")
    monkeypatch.setattr(piles, "measure", sink)
    code, _, error = run(capsys, "piles", "discs")
    assert code == 2 and "sink into each other" in error and len(error.strip().splitlines()) == 1


@pytest.mark.parametrize(("change", "says"), [
    (lambda path: path.unlink(), "without inertia_tensors.py"),
    (lambda path: path.write_text(path.read_text() + "def f(:\n"), "line {last}"),
    (lambda path: path.write_text(path.read_text() + "import nompy\n"), "No module named 'nompy'"),
    (lambda path: path.write_text(path.read_text() + "\n1 / 0\n"), "ZeroDivisionError"),
    (lambda path: path.write_text(path.read_text() + "raise SystemExit\n"), "SystemExit"),
    (lambda path: path.write_bytes(path.read_bytes() + b"\xff"), "utf-8"),
    (lambda path: [p.unlink() for p in path.parent.glob("*.py")], "without inertia_tensors.py"),
], ids=["missing", "syntax", "import", "error", "exit", "encoding", "empty folder"])
def test_answers_that_are_not_there_or_do_not_load_are_named_in_one_sentence(capsys, tmp_path, here, change, says):
    shutil.copytree(modules.ROOT / "lessons", tmp_path / "answers")
    lesson = tmp_path / "answers" / "inertia_tensors.py"
    change(lesson)
    code, _, error = run(capsys, "--scene", "tensors", "--of", str(lesson.parent), "--out", str(tmp_path / "report"))
    last = len(lesson.read_bytes().splitlines()) if lesson.is_file() else 0
    assert code == 2 and "inertia_tensors.py" in error and len(error.splitlines()) == 1
    assert says.format(last=last) in error
    assert not (tmp_path / "report").exists()


def test_answers_that_end_in_errors_depart_and_end_nothing_else(capsys, tmp_path, here):
    shutil.copytree(modules.ROOT / "lessons", tmp_path / "answers")
    lesson = tmp_path / "answers" / "inertia_tensors.py"
    source = (modules.SOLUTIONS / lesson.name).read_text()
    wrong = "\ndef world_inverse_inertia(I_body, R):\n    return {}[1]\n\ndef combine(m, x, I):\n    return x['I']\n"
    lesson.write_text(stub(source, exercises(source)) + wrong)
    out = tmp_path / "report"
    code, said, error = run(capsys, *of("tensors"), "--plain", "--of", str(lesson.parent), "--out", str(out))
    said = " ".join(said.split())
    assert code == 1 and error == "" and "✗ 11 ✓ 4" in said and "here it ended in KeyError: 1." in said, said
    assert "KeyError: 1" in (out / "stability.html").read_text()
    assert not (out / "stability-inertia_tensors-thin-bodies.svg").exists()


@pytest.fixture
def with_scene(monkeypatch, tmp_path):
    """Add a scene with that text to the lesson `springs`."""
    def add(text, name="broken"):
        (tmp_path / "springs").mkdir(exist_ok=True)
        (tmp_path / "springs" / f"{name}.py").write_text(text)
        files, folder = modules.scene_files(), import_module("validate.scenes.springs")
        monkeypatch.setattr(modules, "scene_files", lambda: {**files, name: tmp_path / "springs" / f"{name}.py"})
        monkeypatch.setattr(folder, "__path__", [*folder.__path__, str(tmp_path / "springs")])
        sys.modules.pop(f"validate.scenes.springs.{name}", None)
    yield add
    sys.modules.pop("validate.scenes.springs.broken", None)


def test_a_scene_that_does_not_load_is_named_and_hides_no_other(capsys, tmp_path, with_scene, pretended):
    names = modules.scene_names()
    with_scene('"""A scene."""\n\nfrom nowhere import nothing\n')
    code, said, error = run(capsys, "list")
    assert code == 2 and all(name in said for name in names) and "cannot be loaded" in said
    assert "broken.py', line 3" in error and len(error.splitlines()) == 1
    code, _, error = run(capsys, "--scene", "broken", "--out", str(tmp_path / "report"))
    assert code == 2 and "No module named 'nowhere'" in error and len(error.strip().splitlines()) == 1
    code, _, error = run(capsys, "--scene", "throw", "--set", "g=nan", "--out", str(tmp_path / "report"))
    assert code == 2 and "parameter g" in error                     # the others are reached
    run(capsys, "--lesson", "springs", "--out", str(tmp_path / "report"))
    code, _, error = run(capsys, "--lesson", "springs", "--out", str(tmp_path / "report"))
    assert code == 2 and "broken.py" in error and ("errors", "spring_net") in pretended     # after the others have run


RECORD = (modules.SCENES / "springs" / "two_stars.py").read_text()


@pytest.mark.parametrize(("text", "says"), [
    (RECORD.replace(" observe=observe,", ""), "'observe'"),
    (RECORD.replace(" observe=observe,", " obsreve=observe,"), "'obsreve'"),
    (RECORD.replace(" steps=STEPS,", " steps=5,"), "field 'steps'"),
    (RECORD.replace("SCENE = Scene(", "SCENES = Scene("), "SCENE = Scene"),
    (RECORD.replace('lesson="springs"', 'lesson="spring"'), "'spring'"),
], ids=["missing", "misspelt", "of another type", "no record", "of another lesson"])
def test_a_record_that_is_not_right_is_refused_before_anything_runs(capsys, tmp_path, with_scene, text, says):
    assert text != RECORD
    with_scene(text)
    code, _, error = run(capsys, "--scene", "broken", "--out", str(tmp_path / "report"))
    assert code == 2 and says in error and len(error.splitlines()) == 1 and "Traceback" not in error


@pytest.mark.parametrize("out", ["", ".", ".."])
def test_a_report_is_not_written_among_the_files_of_the_working_folder(capsys, tmp_path, monkeypatch, out):
    (tmp_path / "work").mkdir()
    monkeypatch.chdir(tmp_path / "work")
    code, _, error = run(capsys, "--scene", "oscillator", "--out", out)
    assert code == 2 and "name a folder for the report" in error and len(error.splitlines()) == 1
    assert [path.name for path in tmp_path.rglob("*")] == ["work"]


def test_a_report_is_not_written_among_the_files_of_a_program(capsys, tmp_path):
    (tmp_path / "program.py").write_text("")
    for more in (("--scene", "oscillator"), ("--engine", str(tmp_path / "program.py"))):
        code, _, error = run(capsys, *more, "--out", str(tmp_path))
        assert code == 2 and "a folder with Python files" in error and len(error.splitlines()) == 1
    assert [path.name for path in tmp_path.rglob("*")] == ["program.py"]


def test_what_a_command_cannot_do_is_refused_before_it_begins(capsys, tmp_path):
    (tmp_path / "file").write_text("")
    for arguments, says in ((("--scene", "oscillator", "--set", "k=1", "--set", "k=2"), "given twice"),
                            (("piles", "--growth", "--most", "1000000"), "100000"),
                            (("piles", "discs", "--figure", str(tmp_path / "file" / "x")), "another with --figure")):
        code, _, error = run(capsys, *arguments)
        assert code == 2 and says in error and "Traceback" not in error


def test_an_unwritable_folder_is_named(capsys, tmp_path):
    (tmp_path / "file").write_text("")
    code, _, error = run(capsys, "--scene", "oscillator", "--out", str(tmp_path / "file" / "report"))
    assert code == 2 and "file" in error and "--out" in error


def test_an_engine_that_is_asked_for_and_missing_is_named(capsys, tmp_path, monkeypatch):
    monkeypatch.setattr(Product, "installed", lambda self: None)
    code, _, error = run(capsys, "--engine", "pybullet", "--out", str(tmp_path / "report"))
    assert code == 2 and "pybullet" in error and "recorded" in error


@pytest.mark.parametrize("more", [(), ("--exercises",)])
def test_a_list_that_is_piped_has_one_line_for_each_entry(capsys, monkeypatch, more):
    monkeypatch.setenv("COLUMNS", "80")
    _, out, _ = run(capsys, "list", *more)
    entries = cli.needs.table() if more else modules.scene_names()
    assert len(out.splitlines()) == 1 + len(entries)


def test_list_names_every_scene(capsys):
    code, out, _ = run(capsys, "list")
    assert code == 0 and all(name in out for name in modules.scene_names())


# ---------------------------------------------------------------------------------------------- runs

class Here:
    """Workers that are this process: what is replaced here is replaced for them."""

    def each(self, calls, kinds=None, alone=False):
        for key, (function, *arguments) in calls.items():
            yield key, function(*arguments)


@pytest.fixture
def here(monkeypatch):
    @contextmanager
    def workers(count):
        yield Here()
    monkeypatch.setattr(cli, "workers", workers)


@pytest.fixture
def pretended(monkeypatch, here):
    """Notes of what was measured and shown, instead of doing it; the second scene's times are interrupted once."""
    calls, interrupt = [], ["once"]

    def errors(name, plan):
        calls.append(("errors", name))
        return {"scene": name, "cases": {}}

    def times(name, plan, result):
        if len([c for c in calls if c[0] == "times"]) == 1 and interrupt:
            interrupt.clear()
            raise processes.Ended(signal.SIGINT)
        calls.append(("times", name))
        return {}

    def write(out, results, *_):
        calls.append(("shown", *(r["scene"] for r in results)))
        return out / "index.html"

    monkeypatch.setattr(measure, "errors", errors)
    monkeypatch.setattr(measure, "times", times)
    monkeypatch.setattr(validation, "stability_cases", lambda lesson, plan: [])
    monkeypatch.setattr(report, "files", lambda *_: set())
    monkeypatch.setattr(report, "write", write)
    monkeypatch.setattr(summary, "show", lambda *_: 0)
    return calls


def of(*scenes):
    return [word for scene in scenes for word in ("--scene", scene)]


def test_an_interrupted_run_goes_on_where_it_stopped(capsys, tmp_path, pretended):
    asked = [*of("throw", "oscillator"), "--out", str(tmp_path)]
    code, out, _ = run(capsys, *asked)
    assert code == 130 and "kept" in out
    kept = list(pretended)
    code, _, _ = run(capsys, *asked)
    assert code == 0
    both = [("errors", "oscillator"), ("errors", "throw"), ("times", "oscillator"), ("times", "throw")]
    assert sorted(pretended[:-1]) == both and pretended[-1] == ("shown", "oscillator", "throw")
    assert pretended[:len(kept)] == kept
    run(capsys, *asked)                                             # a finished run is measured anew
    assert pretended.count(("errors", "throw")) == 2


def test_a_run_of_one_scene_leaves_an_interrupted_run_of_all_to_go_on(capsys, tmp_path, pretended):
    asked = [*of("throw", "oscillator"), "--out", str(tmp_path)]
    run(capsys, *asked)
    run(capsys, *of("bounces"), "--out", str(tmp_path))
    assert pretended[-1] == ("shown", "oscillator", "bounces")      # the times of throw are still to be measured
    del pretended[:]
    run(capsys, *asked)
    assert pretended == [("times", "throw"), ("shown", "oscillator", "throw", "bounces")]


def test_an_interrupted_new_measurement_leaves_the_old_one_in_the_report(capsys, tmp_path, pretended):
    run(capsys, *of("oscillator"), "--out", str(tmp_path))
    assert run(capsys, *of("oscillator"), "--out", str(tmp_path))[0] == 130
    run(capsys, *of("throw"), "--out", str(tmp_path))
    assert pretended[-1] == ("shown", "oscillator", "throw")


def test_scenes_of_other_code_or_another_plan_are_not_mixed_into_a_report(capsys, tmp_path, pretended, monkeypatch):
    asked = [*of("throw", "oscillator"), "--out", str(tmp_path)]
    run(capsys, *asked)
    run(capsys, *asked)
    before = everything_in(tmp_path)
    for other in (["--plain"], ["--full"], ["--set", "k=4"], ["--of", "lessons"]):
        del pretended[:]
        _, said, _ = run(capsys, *of("oscillator"), *other, "--out", str(tmp_path))
        assert pretended[-1] == ("shown", "oscillator")
        assert str(tmp_path / "subset" / "index.html") in said and "stays as it is" in said
    monkeypatch.setattr(store, "code_digest", lambda of: "of other code")
    run(capsys, *of("throw"), "--out", str(tmp_path))
    assert pretended[-1] == ("shown", "throw")
    assert {path: text for path, text in everything_in(tmp_path).items() if "subset" not in path.parts} == before
    del pretended[:]
    _, said, _ = run(capsys, *asked)                                # covers all scenes of the old report: replaces it
    assert pretended[-1] == ("shown", "oscillator", "throw") and len(pretended) == 5
    assert str(tmp_path / "index.html") in said


def everything_in(folder):
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def linked_from(page):
    """Names of all files that a page and the pages that it leads to are made of."""
    found, waiting = set(), [page]
    while waiting:
        path = waiting.pop()
        if path.name not in found and path.is_file():
            found.add(path.name)
            if path.suffix == ".html":
                names = re.findall(r"(?:href|src|data)=\"([\w.-]+)", path.read_text())
                waiting += [page.parent / name for name in names]
    return found


@pytest.mark.long
def test_a_subset_updates_its_part_of_the_report_and_leaves_no_stale_page(capsys, tmp_path, here, monkeypatch):
    cases = validation.stability_cases

    def quick_cases(lesson, plan):
        return cases(lesson, plan) if lesson == "inertia_tensors" else []
    monkeypatch.setattr(validation, "stability_cases", quick_cases)
    out = ["--plain", "--out", str(tmp_path)]
    assert run(capsys, *of("tensors", "throw"), *out)[0] == 0
    first = {path.name: path.stat().st_mtime_ns for path in tmp_path.rglob("*") if path.is_file()}
    (tmp_path / "mine.html").write_text("not of a report")

    assert run(capsys, *of("tensors"), *out)[0] == 0
    again = {path.name: path.stat().st_mtime_ns for path in tmp_path.rglob("*") if path.is_file()}
    for name in ("throw.errors.json", "throw.times.json", "throw-steps.svg", "throw-times.svg"):
        assert again[name] == first[name], name
    for name in ("tensors.errors.json", "tensors.times.json", "stability-inertia_tensors-far-from-origin.svg",
                 "tensors.html", "index.html"):
        assert again[name] > first[name], name
    assert {"tensors.html", "throw.html"} <= linked_from(tmp_path / "index.html")
    report = json.loads((tmp_path / "report.json").read_text())
    assert [s["scene"] for s in report["scenes"]] == ["throw", "tensors"]
    summary_counts_what_the_report_holds(capsys, tmp_path, report)

    run(capsys, *of("tensors"), "--engine", "pymunk", *out)
    assert pages(tmp_path / "subset") >= {"tensors.html", "stability-inertia_tensors-far-from-origin.svg"}
    run(capsys, *of("throw"), "--engine", "pymunk", "--set", "g=3", *out)
    assert pages(tmp_path / "subset") & {"throw.html", "tensors.html",
                                         "stability-inertia_tensors-far-from-origin.svg"} == {"throw.html"}
    for folder in (tmp_path, tmp_path / "subset"):
        assert pages(folder) - {"mine.html"} == linked_from(folder / "index.html") - {"player3d.js"}
    assert "mine.html" in pages(tmp_path)


def summary_counts_what_the_report_holds(capsys, folder, report):
    page = folder / "readme.txt"
    page.write_text("before\n<!-- results -->\nold\n<!-- results -->\nafter\n")
    assert run(capsys, "summary", str(folder), "--into", str(page))[0] == 0
    said, text = run(capsys, "summary", str(folder))[1], page.read_text()
    page.unlink()
    assert text == f"before\n<!-- results -->\n{said}<!-- results -->\nafter\n" and report["run"]["date"] in said
    rows = {row.split("|")[1].strip(" `"): row.split("|")[2:] for row in said.splitlines() if row.startswith("| `")}
    assert list(rows) == [scene["lesson"] for scene in report["scenes"]]
    for scene in report["scenes"]:
        cells = [cell.strip() for cell in rows[scene["lesson"]]]
        ours = [curve["verdict"] for case in scene["cases"].values() for curve in case["ours"]]
        assert cells[0] == "1" and f"✓ {ours.count('agrees')}" in cells[1]
    held = [f["holds"] for case in report["stability"] for f in case["findings"]]
    assert f"{sum(held)} of {len(held)}" in said
    for wrong in ([str(folder / "nothing")], [str(folder), "--into", str(folder / "index.html")]):
        code, _, error = run(capsys, "summary", *wrong)
        assert code == 2 and len(error.splitlines()) == 1


@pytest.mark.parametrize("command", ["audit", "summary", "limits"])
def test_a_report_of_another_version_is_named_in_one_sentence(capsys, tmp_path, command):
    (tmp_path / "report.json").write_text(json.dumps({"run": {"date": "2025-01-01"}, "scenes": [], "stability": []}))
    code, _, error = run(capsys, command, str(tmp_path))
    assert code == 2 and "of another version of the workbook" in error and len(error.splitlines()) == 1


def test_a_folder_that_is_no_report_is_not_called_another_version(capsys, tmp_path):
    code, _, error = run(capsys, "compare", str(tmp_path / "nowhere"), str(tmp_path))
    assert code == 2 and "nowhere" in error and "not a report" in error


def test_the_results_of_a_full_run_are_kept_with_their_date_and_those_of_a_quick_one_are_not(
        capsys, tmp_path, monkeypatch):
    kept = tmp_path / "full_run.json"
    for module in (cli, store):
        monkeypatch.setattr(module, "FULL_RUN", kept)
    assert store.full_run() is None
    for mode, code in (("quick", 2), ("full", 0)):
        about = {"format": store.FORMAT, "mode": mode, "date": "2026-11-30", "machine": "a machine", "engines": []}
        (tmp_path / "report.json").write_text(json.dumps({"run": about, "scenes": [], "stability": []}))
        assert run(capsys, "summary", str(tmp_path), "--keep")[0] == code and kept.is_file() == (code == 0)
    found = store.full_run()
    assert found["date"] == "2026-11-30" and found["machine"] == "a machine" and len(found["counts"]) == 4


def pages(folder):
    return {path.name for path in folder.iterdir() if path.is_file() and path.name[0] != "."}


def test_results_are_never_half_written(tmp_path, monkeypatch):
    path = tmp_path / "x.json"
    store.write_whole(path, {"a": 1})
    with pytest.raises(ValueError, match="JSON"):
        store.write_whole(path, {"a": float("nan")})

    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")
    monkeypatch.setattr(Path, "replace", full)
    with pytest.raises(processes.BadInput, match=r"x\.json.*No space left"):
        store.write_whole(path, {"a": 2})
    assert json.loads(path.read_text()) == {"a": 1} and list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(("name", "text"), [
    ("tensors.errors.json", "{"),
    ("tensors.times.json", "[]"),
    ("inertia_tensors.stability.json", ""),
    ("run.json", "["),
])
def test_a_damaged_result_is_named_in_one_sentence(capsys, tmp_path, pretended, name, text):
    assert run(capsys, *of("tensors"), "--plain", "--out", str(tmp_path))[0] == 0
    (tmp_path / "results" / name).write_text(text)
    begun = tmp_path / "results" / "run.json"
    if name != "run.json":                                          # as if interrupted: nothing is measured anew
        begun.write_text(json.dumps({**json.loads(begun.read_text()), "begun": ["tensors"]}))
    code, _, error = run(capsys, *of("tensors"), "--plain", "--out", str(tmp_path))
    assert code == 2 and f"{name}'" in error and "remove it" in error and len(error.strip().splitlines()) == 1
    (tmp_path / "results" / name).unlink()
    assert run(capsys, *of("tensors"), "--plain", "--out", str(tmp_path))[0] != 2


@pytest.mark.parametrize(("text", "says"), [(None, "missing"), ("{", "no JSON"), ("[]", "not what was written")])
def test_a_missing_or_damaged_trace_is_named_where_it_is_needed(capsys, tmp_path, here, monkeypatch, text, says):
    monkeypatch.setattr(traces, "RECORDED", tmp_path)
    if text is not None:
        (tmp_path / "tensors.json").write_text(text)
    out = ["--plain", "--out", str(tmp_path / "report")]
    code, _, error = run(capsys, *of("tensors"), "--engine", "pymunk", *out)
    assert code == 2 and "tensors.json" in error and says in error and len(error.splitlines()) == 1
    assert "validate record --scene tensors" in error


@pytest.mark.parametrize(("scene", "change"), [
    ("oscillator", "k=1e300"), ("oscillator", "x0=0"), ("angular_spring", "theta0=0"), ("throw", "g=1e300")])
def test_numbers_overflow_without_a_warning(tmp_path, scene, change):
    changes = cli.overrides([change], [scene])                      # pytest turns warnings into errors
    plan = measure.Plan(speeds=("plain",), live=(PYMUNK,), overrides=changes, most_steps=500)
    errors = measure.errors(scene, plan)
    result = {**errors, "times": measure.times(scene, plan, errors)}
    for plot in (plots.convergence, plots.work_precision):
        plots.draw(plot, tmp_path / "picture.svg", result)
        assert "</svg>" in (tmp_path / "picture.svg").read_text()


@pytest.mark.parametrize(("scene", "change"), [("oscillator", "c=1e300"), ("asymmetric_top", "w3=1e9")])
def test_a_parameter_that_a_scene_cannot_compute_with_is_named(capsys, tmp_path, here, scene, change):
    code, _, error = run(capsys, *of(scene), "--plain", "--set", change, "--out", str(tmp_path))
    assert code == 2 and f"scene {scene} with {change[:change.index('=')]} = " in error and "not computable" in error
    assert len(error.splitlines()) == 1


def turned():
    try:
        signal.raise_signal(signal.SIGINT)
    except BaseException:
        raise ImportError("initialization failed") from None


@pytest.mark.skipif(not PYBULLET.installed(), reason="pybullet is not installed here")
@pytest.mark.parametrize("interrupted", [lambda: signal.raise_signal(signal.SIGINT), turned],
                         ids=["as it is", "as another error"])
def test_an_interrupted_recording_says_so(capsys, monkeypatch, interrupted):
    monkeypatch.setattr(record, "record", lambda name: interrupted())
    before = {number: signal.getsignal(number) for number in processes.ENDING}
    try:
        code, _, error = run(capsys, "record", "--scene", "throw")
        assert code == 130 and error == "validate: interrupted\n"
        assert {signal.getsignal(number) for number in processes.ENDING} == {signal.SIG_IGN}
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


# ---------------------------------------------------------------------------------------------- pytest and the page

def pytest_run(*arguments):
    command = [sys.executable, "-m", "pytest", *arguments]
    return subprocess.run(command, cwd=modules.ROOT, capture_output=True, text=True)


@pytest.mark.parametrize(("arguments", "said"), [
    (["--of=lessons", "--exercise=99.9"], "ERROR: exercise '99.9' is unknown"),
    (["--of=no/such/folder"], "no/such/folder"),
])
def test_the_tests_name_what_they_cannot_find(arguments, said):
    asked = pytest_run(*arguments)
    assert asked.returncode == 4 and said in asked.stderr and len(asked.stderr.strip().splitlines()) == 1


@pytest.mark.long
def test_one_exercise_loads_one_test_file():
    said = quiet(str(modules.ROOT / "tests"), f"--rootdir={modules.ROOT}", "--of=lessons", "--exercise=8.1",
                 "--collect-only", "-q", "-v")
    assert set(re.findall(r"test_\w+\.py", said)) == {"test_pbd.py"}


def test_a_method_without_error_ends_up_on_the_page_and_in_the_table(capsys, tmp_path, here, monkeypatch):
    monkeypatch.setattr(validation, "stability_cases", lambda lesson, plan: [])
    code, said, _ = run(capsys, "--scene", "throw", "--plain", "--out", str(tmp_path))
    assert code == 0 and "exact" in said
    page = (tmp_path / "throw.html").read_text()
    assert "error too small to tell" in (tmp_path / "throw-times.svg").read_text() and "What theory allows" in page
    assert "exact" in (tmp_path / "index.html").read_text()


def programs():
    """The modules that a person can start: all with a start of their own, but those that a worker starts and feeds."""
    for file in sorted((modules.ROOT / "validate").rglob("*.py")):
        text = file.read_text()
        if '\nif __name__ == "__main__":' in text and "sys.stdin.buffer" not in text:
            yield ".".join(file.relative_to(modules.ROOT).with_suffix("").parts).removesuffix(".__main__")


@pytest.mark.long
@pytest.mark.parametrize("module", list(programs()))
def test_every_program_has_a_help_text_and_refuses_an_unknown_option_in_one_sentence(module):
    def run_with(option):
        return subprocess.run([sys.executable, "-m", module, option], cwd=modules.ROOT, capture_output=True, text=True)
    asked, refused = run_with("--help"), run_with("--bogus")
    assert asked.returncode == 0 and len(asked.stdout.split()) > 5 and not asked.stderr
    assert refused.returncode == 2 and not refused.stdout and "--bogus" in refused.stderr
    assert len(refused.stderr.splitlines()) == 1
