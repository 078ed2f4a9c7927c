"""A class is graded fairly: points for what is right, reasons for the rest, the same every time, and nothing lost."""

import csv
import json
import os
import subprocess
import sys
import time

import pytest

from validate import binding

from .grading import box, example, points, remote


@pytest.fixture(scope="module", autouse=True)
def sandbox():
    """Without bubblewrap nothing here would test what it says: that is a failure, not a skip, where grades are made."""
    if sys.platform == "linux":
        assert not box.no_sandbox_because(), f"{box.no_sandbox_because()}: install the package bubblewrap, or the grader cannot be tested"
    elif box.no_sandbox_because():
        pytest.skip("there is no bubblewrap for this system: grading here is a self-check")


@pytest.fixture
def submissions(tmp_path):
    """The example's class, handed in on 15 January 2027."""
    folder = example.make(tmp_path / "class")
    for path in folder.rglob("*"):
        os.utime(path, (1.8e9, 1.8e9))
    return folder


def graded(submissions, out, *more):
    """Run `grade` as an instructor does; the rows of its CSV by student."""
    run = subprocess.run([sys.executable, "-m", "tests.grading", str(submissions), "--out", str(out), "--lesson", "integrators",
                          "--seed", "a secret", *more], cwd=binding.ROOT, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout + run.stderr
    with open(out / "grades.csv", newline="") as file:
        return {row["student_id"]: row for row in csv.DictReader(file)}


def test_points_are_given_for_what_is_right_and_reasons_for_the_rest(submissions, tmp_path):
    rows = graded(submissions, tmp_path / "out", "--due", "2027-01-01T00:00", "--late", "10")
    assert [rows[s]["raw_score"] for s in ("ada", "bob", "cem", "dia", "eve")] == ["20", "18", "0", "20", "0"]
    assert rows["ada"]["max_score"] == "20" and float(rows["ada"]["late_submission_penalty"]) > 0.0

    def failing(student):
        tests = json.loads((tmp_path / "out" / "results" / f"{student}.json").read_text())["tests"]
        return [t for t in tests if t["status"] != "passed"]

    wrong = failing("bob")
    assert {t["exercise"] for t in wrong} == {"1.1"} and wrong[0]["kind"] == "visible" and {"quantity", "expected", "got"} <= wrong[0]["says"].keys()
    assert all(t["status"] == "not attempted" for t in failing("cem"))
    assert all("ended before it answered" in t["says"]["got"] for t in failing("eve"))
    assert sum(t["points"] for t in failing("eve")) == 20             # nothing drops out of the maximum
    for page in ("index.html", *(f"students/{s}.html" for s in ("ada", "bob", "cem", "dia", "eve"))):
        assert "<html" in (tmp_path / "out" / page).read_text()


def test_the_same_class_graded_twice_gives_the_same_bytes_and_only_what_changed_is_graded_again(submissions, tmp_path):
    graded(submissions, tmp_path / "one", "--jobs", "1")
    graded(submissions, tmp_path / "two", "--jobs", "2")
    assert (tmp_path / "one" / "grades.csv").read_bytes() == (tmp_path / "two" / "grades.csv").read_bytes()

    before = {path.name: path.stat().st_mtime_ns for path in (tmp_path / "one" / "results").iterdir()}
    (submissions / "bob" / "lessons" / "integrators.py").write_text(example.worked("integrators"))
    rows = graded(submissions, tmp_path / "one")
    after = {path.name: path.stat().st_mtime_ns for path in (tmp_path / "one" / "results").iterdir()}
    assert {name for name in after if after[name] != before[name]} == {"bob.json"} and rows["bob"]["raw_score"] == "20"


def test_an_interrupted_run_keeps_what_it_has_and_goes_on_from_there(submissions, tmp_path):
    command = [sys.executable, "-m", "tests.grading", str(submissions), "--out", str(tmp_path / "out"), "--lesson", "integrators",
               "--seed", "a secret", "--jobs", "1"]
    run = subprocess.Popen(command, cwd=binding.ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    results = tmp_path / "out" / "results"
    deadline = time.monotonic() + 60.0
    while not (results.is_dir() and list(results.glob("*.json"))) and time.monotonic() < deadline:
        time.sleep(0.02)
    run.send_signal(2)                                                 # Ctrl-C
    said, _ = run.communicate(timeout=60)
    kept = {path.name: path.stat().st_mtime_ns for path in results.glob("*.json")}
    assert run.returncode in (0, 130) and kept and ("goes on from there" in said or run.returncode == 0)
    rows = graded(submissions, tmp_path / "out")
    assert len(rows) == 5 and all((results / name).stat().st_mtime_ns == when for name, when in kept.items())


@pytest.mark.parametrize("arguments, names", [
    (["no/such/folder"], "no/such/folder"),
    (["{empty}"], "put one folder or zip a student into it"),
    (["{class}", "--lesson", "juggling"], "juggling"),
    (["{class}", "--due", "tomorrow"], "2026-11-30T23:59"),
    (["{class}", "--roster", "{list}"], "student_id"),
])
def test_bad_input_is_one_sentence_and_exit_code_2(submissions, tmp_path, arguments, names):
    (tmp_path / "empty").mkdir()
    (tmp_path / "list.csv").write_text("name\nAda\n")
    filled = [a.format(empty=tmp_path / "empty", list=tmp_path / "list.csv", **{"class": submissions}) for a in arguments]
    run = subprocess.run([sys.executable, "-m", "tests.grading", *filled, "--out", str(tmp_path / "out")], cwd=binding.ROOT,
                         capture_output=True, text=True)
    assert run.returncode == 2 and names in run.stderr and len(run.stderr.strip().splitlines()) == 1
    assert not (tmp_path / "out" / "grades.csv").exists()


def test_the_sandbox_gives_the_same_points_as_the_same_tests_in_one_process():
    """Every mutant could be tried; a wrong step and the solutions are enough to see that nothing is lost on the wire."""
    for lesson in binding.lesson_names():
        place = remote.box_of(lesson, example.worked(lesson).encode(), 60.0)
        try:
            place.open()
            inside = points.score(points.grade(lesson, remote.lesson_in(place, lesson), seed="another"))
        finally:
            place.close()
        assert inside == points.score(points.grade(lesson, binding.bind(lesson), seed="another")), lesson
