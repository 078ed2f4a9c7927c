"""The command line: bad input gets one sentence and exit code 2, a run that was interrupted goes on, departures are told."""

import json
import re
import subprocess
import sys

import pytest

from validate import __main__ as cli
from validate import binding, engines, measure, report
from validate.report import summary


def run(capsys, *arguments):
    """Exit code and what was written to standard output and error."""
    with pytest.raises(SystemExit) as end:
        cli.main(list(arguments))
    said = capsys.readouterr()
    return end.value.code or 0, said.out, said.err


@pytest.mark.parametrize("arguments, names", [
    (["--scene", "moonwalk"], "moonwalk"),
    (["--lesson", "juggling"], "juggling"),
    (["--of", "no/such/folder"], "no/such/folder"),
    (["--scene", "oscillator", "--set", "m=-1"], "-1.0"),
    (["--scene", "oscillator", "--set", "m=0"], "0.0"),
    (["--scene", "oscillator", "--set", "k=nan"], "nan"),
    (["--scene", "oscillator", "--set", "k=soft"], "soft"),
    (["--scene", "oscillator", "--set", "colour=3"], "colour"),
    (["--set", "m=1"], "--scene"),
])
def test_bad_input_is_told_in_one_sentence_and_nothing_is_written(capsys, tmp_path, arguments, names):
    out = tmp_path / "report"
    code, _, error = run(capsys, *arguments, "--out", str(out))
    assert code == 2 and names in error and len(error.strip().splitlines()) == 1 and "Traceback" not in error
    assert not out.exists()


def test_an_unwritable_folder_is_named(capsys, tmp_path):
    (tmp_path / "file").write_text("")
    code, _, error = run(capsys, "--scene", "oscillator", "--out", str(tmp_path / "file" / "report"))
    assert code == 2 and "file" in error and "--out" in error


def test_an_engine_that_is_asked_for_and_missing_is_named(capsys, tmp_path, monkeypatch):
    monkeypatch.setattr(engines, "installed", lambda name: None)
    code, _, error = run(capsys, "--engine", "pybullet", "--out", str(tmp_path / "report"))
    assert code == 2 and "pybullet" in error and "recorded" in error


def test_list_names_every_scene(capsys):
    code, out, _ = run(capsys, "list")
    assert code == 0 and all(name in out for name in binding.scene_names())


@pytest.fixture
def pretended(monkeypatch):
    """Measuring replaced by a note of what was measured; the second scene's times are interrupted once."""
    calls, interrupt = [], ["once"]

    def errors(name, plan):
        calls.append(("errors", name))
        return {"scene": name, "cases": {}}

    def times(name, plan, result):
        if len([c for c in calls if c[0] == "times"]) == 1 and interrupt:
            interrupt.clear()
            raise KeyboardInterrupt
        calls.append(("times", name))
        return {}

    monkeypatch.setattr(measure, "errors", errors)
    monkeypatch.setattr(measure, "times", times)
    monkeypatch.setattr(measure, "stability_cases", lambda lesson, plan: [])
    monkeypatch.setattr(report, "write", lambda out, *_: out / "index.html")
    monkeypatch.setattr(summary, "show", lambda *_: 0)
    return calls


def test_an_interrupted_run_goes_on_where_it_stopped(capsys, tmp_path, pretended):
    asked = ["--scene", "throw", "--scene", "oscillator", "--jobs", "1", "--out", str(tmp_path)]
    code, out, _ = run(capsys, *asked)
    assert code == 130 and "kept" in out
    kept = list(pretended)
    code, _, _ = run(capsys, *asked)
    assert code == 0
    assert sorted(pretended) == sorted({("errors", "oscillator"), ("errors", "throw"), ("times", "oscillator"), ("times", "throw")})
    assert pretended[:len(kept)] == kept
    run(capsys, *asked)                                             # a finished run is measured anew
    assert pretended.count(("errors", "throw")) == 2


def test_results_are_never_half_written(tmp_path):
    path = tmp_path / "x.json"
    cli.write_whole(path, {"a": 1})
    with pytest.raises(ValueError):
        cli.write_whole(path, {"a": float("nan")})
    assert json.loads(path.read_text()) == {"a": 1}


@pytest.mark.parametrize("arguments, said", [
    (["--of=lessons", "--exercise=9.9"], "ERROR: exercise '9.9' is unknown"),
    (["--of=no/such/folder"], "no/such/folder"),
])
def test_the_tests_name_what_they_cannot_find(arguments, said):
    asked = subprocess.run([sys.executable, "-m", "pytest", *arguments], cwd=binding.ROOT, capture_output=True, text=True)
    assert asked.returncode == 4 and said in asked.stderr and len(asked.stderr.strip().splitlines()) == 1


def test_one_exercise_loads_one_test_file():
    asked = subprocess.run([sys.executable, "-m", "pytest", "--of=lessons", "--exercise=8.1", "--collect-only", "-q", "-v"], cwd=binding.ROOT,
                           capture_output=True, text=True)
    assert "test_pbd.py" in asked.stdout and not set(re.findall(r"test_\w+\.py", asked.stdout)) - {"test_pbd.py"}


def test_a_method_without_error_ends_up_on_the_page_and_in_the_table(capsys, tmp_path):
    code, said, _ = run(capsys, "--scene", "throw", "--plain", "--out", str(tmp_path))
    assert code == 0 and "exact" in said
    page = (tmp_path / "throw.html").read_text()
    assert "no error that can be told" in (tmp_path / "throw-times.svg").read_text() and "What theory allows" in page
    assert "exact" in (tmp_path / "index.html").read_text()
