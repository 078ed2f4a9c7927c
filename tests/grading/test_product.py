"""What students get, with right answers in it: all points, notebooks without an error, scenes that agree.

The long tests unpack the zip and install it by the students' README, in an environment in which this repository cannot
be imported.  The short one copies the files that a check needs and takes the answers out of solutions/.
"""

import json
import os
import re
import shutil
import subprocess
import sys

import nbformat
import pytest

from validate.check import Verdict
from validate.stability.examine import cases_of
from validate.subject import generate, modules
from validate.subject.modules import GIVEN, ROOT, SOLUTIONS, lesson_names

from ..lessons.kernels import kernel, ran
from ..lessons.test_notebooks import HASTE, NOTEBOOKS

OURS = {"PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV", "WORKBOOK_LESSONS"}          # variables that lead back to us
BLOCKED = re.compile(r"Not attempted yet: [^<]*\d\.\d|it waits for|Traceback \(most|NotImplementedError: Exercise"
                     r"|✗ \w+Error:")                    # what `attempt` catches in a call of our own


def write_answers(folder, solved=None):
    """Write right answers into the lessons of a folder, as a student would; all, or those of some lessons."""
    for name in lesson_names():
        text = (SOLUTIONS / f"{name}.py").read_text()
        answered = generate.exercises(text) if solved is None or name in solved else ()
        (folder / "lessons" / f"{name}.py").write_text(generate.stub(text, answered, GIVEN))


def run_in(folder, *command):
    """What a command prints in a folder, and its exit code."""
    environment = {name: value for name, value in os.environ.items() if name not in OURS}
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, env=environment)
    return run.stdout + run.stderr, run.returncode


# ---------------------------------------------------------------------------------------------- without an environment

def test_right_answers_of_the_simulator_get_all_points_where_no_answers_are(tmp_path):
    """This lesson needs most of what is given."""
    skipped = shutil.ignore_patterns("__pycache__", "recorded", "book", "report", "attacks", "mutants", "faults")
    for name in ("solutions", "lessons", "tests", "validate"):
        shutil.copytree(ROOT / name, tmp_path / name, ignore=skipped)
    shutil.copytree(ROOT / "validate" / "report", tmp_path / "validate" / "report",
                    ignore=shutil.ignore_patterns("__pycache__", "player3d"))
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    for name in lesson_names():
        text = (SOLUTIONS / f"{name}.py").read_text()
        (tmp_path / "solutions" / f"{name}.py").write_text(generate.stub(text, elsewhere=()))
    write_answers(tmp_path)
    tests = "tests/lessons/test_simulator.py"
    said, code = run_in(tmp_path, sys.executable, "-m", "pytest", "--of=lessons", "-p", "no:cacheprovider", tests)
    assert re.search(r"^all: 20 of 20$", said, re.M) and code == 0, said


# ---------------------------------------------------------------------------------------------- the zip, installed

@pytest.fixture(scope="module")
def installed(unpacked):
    """The unpacked zip with right answers, installed by the command of its README."""
    text = (unpacked / "README.md").read_text()
    line = next(line for line in text.splitlines() if line.startswith("python3 -m venv"))
    make, install, _ = line.split(" && ")
    for command in (make.replace("python3", sys.executable, 1), install):
        said, code = run_in(unpacked, "bash", "-c", command)
        assert code == 0, said
    write_answers(unpacked)
    return unpacked


@pytest.fixture
def program(installed):
    """program(name) → the path of a command of the students' environment."""
    return lambda name: str(installed / ".venv" / "bin" / name)


@pytest.mark.long
@pytest.mark.xdist_group("notebooks")
def test_nothing_is_imported_from_this_repository(installed, program, tmp_path):
    show = "import lessons, solutions, tests, validate\nfor m in lessons, solutions, tests, validate: print(m.__file__)"
    said, code = run_in(tmp_path, program("python"), "-c", show)
    assert code == 0 and all(path.startswith(str(installed)) for path in said.split()), said


@pytest.mark.long
@pytest.mark.xdist_group("notebooks")
def test_right_answers_get_all_points(installed, program):
    said, code = run_in(installed, program("pytest"), "--of=lessons", "-p", "no:cacheprovider")
    assert re.search(rf"^ +all  {20 * len(lesson_names())} of {20 * len(lesson_names())}$", said, re.M), said
    assert code == 0


@pytest.mark.long
@pytest.mark.xdist_group("notebooks")
@pytest.mark.parametrize("name", [path.name for path in NOTEBOOKS])
def test_a_notebook_runs_without_an_error_and_its_checks_pass(installed, program, monkeypatch, name):
    for variable in OURS:
        monkeypatch.delenv(variable, raising=False)
    cells = nbformat.read(installed / "notebooks" / name, as_version=4).cells
    with kernel(installed / "notebooks", program("python")) as client:
        ran(client, HASTE)
        for source in [cell.source for cell in cells if cell.cell_type == "code"]:
            said = ran(client, source)
            assert not BLOCKED.search(re.sub(r"<style>.*?</style>", "", said)), f"{source}\n{said}"
            assert not source.startswith("check(") or ": passed" in said, said


@pytest.mark.long
@pytest.mark.xdist_group("notebooks")
@pytest.mark.parametrize("path", [path for path in NOTEBOOKS if path.stem[3:] in lesson_names()], ids=lambda p: p.stem)
def test_a_notebook_has_no_error_where_only_its_own_lesson_is_solved(installed, program, monkeypatch, tmp_path, path):
    for variable in OURS:
        monkeypatch.delenv(variable, raising=False)
    (tmp_path / "lessons").mkdir()
    write_answers(tmp_path, {path.stem[3:]})
    monkeypatch.setenv("WORKBOOK_LESSONS", str(tmp_path / "lessons"))
    cells = nbformat.read(installed / "notebooks" / path.name, as_version=4).cells
    with kernel(installed / "notebooks", program("python")) as client:
        ran(client, HASTE)
        for source in [cell.source for cell in cells if cell.cell_type == "code"]:
            if not source.startswith("check("):
                said = ran(client, source)
                assert not re.search(r"✗ \w+Error:", said), f"{source}\n{said}"


@pytest.mark.long
@pytest.mark.xdist_group("notebooks")
@pytest.mark.parametrize("about", lesson_names())
def test_every_method_and_every_stability_case_of_right_answers_is_judged(installed, program, tmp_path, about):
    said, code = run_in(installed, program("validate"), "--of", "lessons", "--plain", "--quick", "--lesson", about,
                        "--out", str(tmp_path))
    report = json.loads((tmp_path / "report.json").read_text())
    assert code == 0, said
    verdicts = {(scene["scene"], curve["label"]): Verdict(curve["verdict"]) for scene in report["scenes"]
                for case in scene["cases"].values() for curve in case["ours"]}
    assert not [place for place, verdict in verdicts.items() if verdict is Verdict.NOT_ATTEMPTED]
    assert {(case["lesson"], case["slug"]) for case in report["stability"]} == {
        (about, slug) for slug, case in cases_of(about).items() if case.in_quick}
    assert not [finding for case in report["stability"] for finding in case["findings"] if not finding["holds"]]
    assert {scene["scene"] for scene in report["scenes"]} == {
        name for name in modules.scene_names() if modules.bind_scene(name).lesson == about}
