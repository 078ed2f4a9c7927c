"""Gradescope's zip, from setup.sh to results.json without a container, and the workflow for GitHub Classroom."""

import json
import os
import re
import shlex
import stat
import subprocess
import sys
import zipfile

import pytest
import yaml

from solutions.checks import BadInput
from validate.grading import autograder, marking
from validate.subject.modules import ROOT

SEED = "a secret of the tests"
COURSE = ("--seed", SEED, "--lesson", "integrators", "--late", "10", "--dirty")


def command_line(*arguments):
    """Run the command line; return its exit code."""
    with pytest.raises(SystemExit) as end:
        autograder.main([str(a) for a in arguments])
    return end.value.code or 0


@pytest.fixture(scope="module")
def archive(tmp_path_factory):
    out = tmp_path_factory.mktemp("gradescope") / "autograder.zip"
    assert command_line("gradescope", "--out", out, *COURSE) == 0
    return out


@pytest.fixture
def place(archive, tmp_path):
    """Make a folder like Gradescope's /autograder: the zip unpacked with its modes, and an empty submission."""
    with zipfile.ZipFile(archive) as entries:
        for entry in entries.infolist():
            path = entries.extract(entry, tmp_path / "source")
            os.chmod(path, entry.external_attr >> 16)
    (tmp_path / "submission").mkdir()
    return tmp_path


def script(place, name, **more):
    environment = {**os.environ, "AUTOGRADER": str(place), **more}
    command = ["bash", place / "source" / name]
    return subprocess.run(command, env=environment, cwd=place, capture_output=True, text=True)


def graded(place):
    """Return results.json of run_autograder, and the run.  Gradescope starts a new container for each."""
    environment = place / "source" / "venv"
    if not environment.is_symlink():
        environment.symlink_to(sys.prefix)
    run = script(place, "run_autograder")
    return json.loads((place / "results" / "results.json").read_text()), run


def hand_in(place):
    worked = (ROOT / "solutions" / "integrators.py").read_text().replace("from .", "from solutions.")
    (place / "submission" / "integrators.py").write_text(worked)


# ---------------------------------------------------------------------------------------------- Gradescope

def test_the_zip_has_its_scripts_at_the_root_and_the_workbook_as_tracked(archive):
    with zipfile.ZipFile(archive) as entries:
        modes = {entry.filename: stat.S_IMODE(entry.external_attr >> 16) for entry in entries.infolist()}
        files = {name: entries.read(name) for name in modes}
    assert json.loads(files["course.json"]) == {"lessons": ["integrators"], "exercises": {}, "seed": SEED, "late": 10.0}
    for path in ("solutions/integrators.py", "constraints.txt"):
        assert files[f"workbook/{path}"] == (ROOT / path).read_bytes()
    assert modes["setup.sh"] == modes["run_autograder"] == 0o755 and modes["course.json"] == 0o600
    assert not any("__pycache__" in name or ".venv" in name for name in files)
    assert stat.S_IMODE(archive.stat().st_mode) == 0o600
    with_seed = {name for name, data in files.items() if SEED.encode() in data}
    assert with_seed <= {"course.json", "workbook/tests/grading/test_autograder.py"}


def test_the_same_workbook_and_seed_give_the_same_zip(archive, tmp_path):
    command_line("gradescope", "--out", tmp_path / "again.zip", *COURSE)
    assert (tmp_path / "again.zip").read_bytes() == archive.read_bytes()


@pytest.mark.parametrize("name", ["setup.sh", "run_autograder"])
def test_the_scripts_are_bash(place, name):
    assert subprocess.run(["bash", "-n", place / "source" / name], capture_output=True).stderr == b""


APT_GET = """\
echo "apt-get $*" >> {log}
case "$*" in *python3.11*) exit {code};; esac
"""
PYTHON = """\
case "$1" in -c) exec {python} "$@";; esac
echo "{name} $*" >> {log}
mkdir -p "$3/bin"
printf '#!/bin/bash\\necho "pip $*" >> {log}\\n' > "$3/bin/pip"
chmod +x "$3/bin/pip"
"""


@pytest.mark.parametrize("there", ["python3.11", "python3"])
def test_the_setup_installs_sandbox_interpreter_and_the_locked_versions(place, there):
    log = place / "log"
    code = 0 if there == "python3.11" else 100
    apt_get = APT_GET.format(log=log, code=code)
    run = setup_with(place, {"apt-get": apt_get, there: PYTHON.format(log=log, name=there, python=sys.executable)})
    assert run.returncode == 0, run.stderr
    lines, source = log.read_text().splitlines(), place / "source"
    assert "apt-get install -y bubblewrap libseccomp2" in lines and f"{there} -m venv {source}/venv" in lines
    assert lines[-1] == f"pip install -q -c {source}/workbook/constraints.txt -e {source}/workbook[student]"


def test_the_setup_stops_with_a_sentence_where_python_is_too_old(place):
    run = setup_with(place, {"apt-get": "exit 0\n", "python3": "exit 1\n"})
    assert run.returncode == 1 and "Python 3.11 or newer is needed" in run.stderr
    assert not (place / "source" / "venv").exists()


def setup_with(place, commands):
    """Run setup.sh with these commands, a few of the system's, and no others."""
    folder = place / "bin"
    folder.mkdir()
    for name, text in commands.items():
        (folder / name).write_text(f"#!/bin/bash\n{text}")
        (folder / name).chmod(0o755)
    for name in ("bash", "mkdir", "chmod"):
        (folder / name).symlink_to(f"/bin/{name}")
    return script(place, "setup.sh", PATH=str(folder))


METADATA = {
    "created_at": "2026-12-01T00:00:01.500000-08:00",
    "users": [{"email": "ada@example.org"}],
    "assignment": {"due_date": "2026-11-30T23:59:59.000000-08:00"},
}


def test_a_submission_gets_a_row_for_every_test_and_gradescopes_dates(place):
    hand_in(place)
    (place / "submission_metadata.json").write_text(json.dumps(METADATA))
    found, run = graded(place)
    rows, manifest = found["tests"], marking.manifest(("integrators",))
    assert run.returncode == 0, run.stderr
    assert sum(row["max_score"] for row in rows) == sum(row[4] for row in manifest) == 20.0
    assert sum(row["score"] for row in rows) == 20.0
    assert len(rows) == len(manifest) and found["score"] == 18.0       # one day begun, at 10 %
    assert SEED not in json.dumps(found)


def test_nothing_handed_in_is_a_zero_of_the_full_maximum(place):
    found, _ = graded(place)
    assert found["score"] == 0 and sum(row["max_score"] for row in found["tests"]) == 20.0


@pytest.mark.parametrize("broken", ["course", "environment"])
def test_a_failure_of_the_grader_is_reported_without_a_score(place, broken):
    hand_in(place)
    if broken == "course":
        course = {"lessons": ["juggling"], "seed": SEED, "late": 0.0}
        (place / "source" / "course.json").write_text(json.dumps(course))
    else:
        (place / "source" / "venv").symlink_to(place / "nowhere")
    found, run = graded(place)
    assert run.returncode != 0 and set(found) == {"output"}
    assert "grader itself" in found["output"] and SEED not in found["output"]


def test_without_a_sandbox_nothing_is_run_and_there_is_no_score(place, monkeypatch):
    hand_in(place)
    (place / "submission" / "integrators.py").write_text(f"open({str(place / 'canary')!r}, 'w')\n")
    monkeypatch.setenv("WORKBOOK_SANDBOX_BY", "chroot")
    monkeypatch.setenv("PATH", "/nowhere")
    paths = [place / "submission", place / "results.json", "--course", place / "source" / "course.json"]
    code = "import os; os.geteuid = lambda: 1000; from validate.grading.autograder import main; main()"
    command = [sys.executable, "-c", code, "run", *map(str, paths)]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    found = json.loads((place / "results.json").read_text())
    assert run.returncode == 2 and set(found) == {"output"} and "no score" in found["output"], run.stderr
    assert not (place / "canary").exists() and SEED not in json.dumps(found)


# ---------------------------------------------------------------------------------------------- GitHub Classroom

@pytest.fixture(scope="module")
def manifest():
    return marking.manifest(("integrators", "springs"))


def job_of(manifest):
    workflow = yaml.safe_load(autograder.workflow(manifest))
    assert workflow["name"] == "Autograding Tests"                     # Classroom looks for these two names
    assert list(workflow["jobs"]) == ["run-autograding-tests"]
    assert workflow["on"] == ["push", "workflow_dispatch"]
    return workflow["jobs"]["run-autograding-tests"]


COMMAND = re.compile(r"tests/lessons/test_(\w+)\.py .*--exercise=([\d.]+)$")


def commands_in(steps):
    """The inputs of the steps that grade."""
    return [step["with"] for step in steps if "command-grader@v1" in step.get("uses", "")]


def test_the_workflow_has_a_step_for_every_exercise_with_its_points(manifest):
    steps = commands_in(job_of(manifest)["steps"])
    expected = {}
    for lesson, exercise, _, _, worth, _ in manifest:
        expected[lesson, exercise] = expected.get((lesson, exercise), 0) + worth
    found = {COMMAND.search(step["command"]).groups(): step["max-score"] for step in steps}
    scale = autograder.whole_scale(expected.values())
    assert found == {place: scale * worth for place, worth in expected.items()} and len(steps) == len(expected)
    assert all(type(step["max-score"]) is int for step in steps)
    assert all(1 < step["timeout"] <= 6 for step in steps) and sum(found.values()) == 40 * scale


def test_the_reporter_gets_the_result_of_every_step(manifest):
    *others, reporter = job_of(manifest)["steps"]
    ids = [step["id"] for step in others if "id" in step]
    assert reporter["uses"].endswith("autograding-grading-reporter@v1")
    assert reporter["with"]["runners"].split(",") == ids and len(set(ids)) == len(ids)
    assert reporter["env"] == {f"{name.upper()}_RESULTS": f"${{{{ steps.{name}.outputs.result }}}}" for name in ids}


@pytest.mark.long
def test_a_step_passes_a_right_answer_and_fails_an_empty_one(manifest, tmp_path, monkeypatch):
    command = next(step["with"]["command"] for step in job_of(manifest)["steps"] if step.get("id") == "exercise-1-2")
    worked = (ROOT / "solutions" / "integrators.py").read_text()
    (tmp_path / "integrators.py").write_text(worked.replace("from .", "from solutions."))
    assert command.startswith(".venv/bin/pytest ") and "--of=lessons" in command
    monkeypatch.chdir(ROOT)
    code = {}
    for of in (tmp_path, "lessons"):
        _, *words = shlex.split(command.replace("--of=lessons", f"--of={of}"))
        code[str(of)] = pytest.main([*words, "-p", "no:cacheprovider", "--disable-plugin-autoload"])
    assert code == {str(tmp_path): 0, "lessons": 1}


def test_classroom_counts_whole_points():
    def scores(*worths):
        rows = [("integrators", f"1.{n}", "a_step", f"test_{n}", worth, "") for n, worth in enumerate(worths, 1)]
        text = autograder.workflow(rows)
        steps = commands_in(yaml.safe_load(text)["jobs"]["run-autograding-tests"]["steps"])
        return [step["max-score"] for step in steps], "times the workbook's" in text

    assert scores(2, 1) == ([2, 1], False)
    assert scores(1.5, 1) == ([3, 2], True)
    assert scores(0.25, 0.5) == ([1, 2], True)
    with pytest.raises(BadInput, match="not in quarters: GitHub Classroom counts whole points"):
        scores(0.3)


def test_the_workflow_of_all_lessons_is_written(tmp_path):
    assert command_line("classroom", "--out", tmp_path / "grade.yml") == 0


def test_the_workflow_is_written_where_it_was_asked_for(tmp_path):
    out = tmp_path / ".github" / "workflows" / "grade.yml"
    assert command_line("classroom", "--out", out, "--lesson", "springs") == 0
    assert "test_springs" in out.read_text() and "test_integrators" not in out.read_text()


@pytest.mark.parametrize(("arguments", "names"), [
    (["gradescope", "--seed", "s", "--lesson", "juggling", "--dirty"], "juggling"),
    (["classroom", "--lesson", "juggling"], "juggling"),
    (["gradescope", "--seed", "s", "--dirty", "--out", "{folder}"], "not writable"),
])
def test_bad_input_is_one_sentence_and_leaves_no_file(capsys, tmp_path, arguments, names):
    (tmp_path / "there").mkdir()
    arguments = [a.format(folder=tmp_path / "there") for a in arguments]
    if "--out" not in arguments:
        arguments += ["--out", tmp_path / "out"]
    assert command_line(*arguments) == 2
    error = capsys.readouterr().err
    assert names in error and len(error.strip().splitlines()) == 1
    assert [path.name for path in tmp_path.rglob("*")] == ["there"]
