"""An instructor grades the exercises that were set, for the points that they are worth in this course."""

import csv
import json
import re
import subprocess
import sys

import pytest

from solutions.checks import BadInput
from validate.grading import autograder, choice, example, marking, sandbox, submissions
from validate.subject import modules

LAST = len(modules.lesson_names())
FRICTION = {exercise for _, exercise, *_ in marking.manifest(["friction"])}
WHOLE = f"friction has 3.1 to 3.{len(FRICTION)}"


@pytest.fixture
def in_sandbox():
    sandbox.for_tests(pytest.skip, pytest.fail)


@pytest.mark.parametrize(("text", "worth"), [
    ("3.1,3.4", {"3.1": None, "3.4": None}),
    ("3.1-3.3", {"3.1": None, "3.2": None, "3.3": None}),
    ("3.1–3.3", {"3.1": None, "3.2": None, "3.3": None}),              # as the tables of the book write it
    ("3.9-11=2", {"3.9": 2.0, "3.10": 2.0, "3.11": 2.0}),
    (" 3.4=0.5 , 3.1,", {"3.4": 0.5, "3.1": None})])
def test_exercises_are_written_as_a_list_with_ranges_and_points(text, worth):
    assert choice.chosen([], text) == (["friction"], worth)


def test_without_a_choice_every_exercise_of_the_lessons_is_graded():
    assert choice.chosen([]) == (modules.lesson_names(), {})
    assert choice.chosen(["springs", "integrators"]) == (["integrators", "springs"], {})
    assert marking.manifest(["friction"], {}) == marking.manifest(["friction"])


@pytest.mark.parametrize(("text", "said"), [
    ("", "empty"), ("friction", "not a list"), ("3", "not a list"), ("3.99", WHOLE),
    (f"3.14-3.{len(FRICTION) + 1}", WHOLE), ("3.0", "friction has"), (f"{LAST + 1}.1", f"they are 1 to {LAST}"),
    ("0.1", f"they are 1 to {LAST}"), ("3.4-3.1", "ends before"), ("3.1-4.1", "two lessons"), ("3.1,3.1", "names 3.1"),
    ("3.1-3.3,3.2=2", "names 3.2"), ("3.1=", "positive"), ("3.1=0", "positive"), ("3.1=-1", "positive"),
    ("3.1=nan", "positive"), ("3.1=inf", "positive"), ("3.1=two", "positive"), ("3.1 3.4", "not a list")])
def test_a_choice_that_means_nothing_is_refused_in_one_sentence(text, said):
    with pytest.raises(BadInput, match=re.escape(said)):
        choice.chosen([], text)


@pytest.mark.parametrize("lessons", [["springs"], ["friction", "springs"]])
def test_a_choice_at_odds_with_the_lessons_is_refused(lessons):
    assert choice.chosen(["friction"], "3.1")[0] == ["friction"]
    with pytest.raises(BadInput, match=r"at odds with --lesson: \w+ (has no exercise there|is not given)"):
        choice.chosen(lessons, "3.1")


@pytest.mark.parametrize(("numbers", "words"), [
    (range(1, 12), "1 to 11"), ([1, 2, 3, 20], "1 to 3, 20"), ([1, 3, 4], "1, 3 to 4"), ([7], "7")])
def test_the_lessons_that_there_are_in_words(numbers, words):
    assert choice.in_words(numbers) == words


def test_points_that_are_set_are_shared_among_the_tests_as_before():
    every = marking.manifest(["friction"])
    rows = marking.manifest(["friction"], {"3.5": 3.0, "3.1": None})
    assert [row[:4] for row in rows] == [row[:4] for row in every if row[1] in ("3.1", "3.5")]
    own = {exercise: sum(row[4] for row in every if row[1] == exercise) for exercise in ("3.1", "3.5")}
    there = {exercise: sum(row[4] for row in rows if row[1] == exercise) for exercise in ("3.1", "3.5")}
    assert there == pytest.approx({"3.1": own["3.1"], "3.5": 3.0})
    shares = {row[3]: row[4] / there[row[1]] for row in rows}
    assert shares == pytest.approx({row[3]: row[4] / own[row[1]] for row in every if row[3] in shares})


@pytest.mark.usefixtures("in_sandbox")
def test_only_what_is_chosen_is_run_and_a_change_of_the_choice_grades_again():
    endless = example.worked("integrators") + "\n\ndef midpoint_step(*arguments):\n    while True:\n        pass\n"
    submission = submissions.Submission("ada", {"integrators": endless.encode()}, (), "")
    lessons, worth = choice.chosen([], "1.1=3,1.4")
    settings = marking.settings(lessons, "a secret", worth)
    found = marking.mark(submission, settings)
    assert {test["exercise"] for test in found["tests"]} == {"1.1", "1.4"} and found["again"] == []
    assert all(test["status"] == "passed" for test in found["tests"])
    assert sum(test["earned"] for test in found["tests"] if test["exercise"] == "1.1") == pytest.approx(3.0)
    others = [marking.settings(lessons, "a secret", other) for other in ({"1.1": 2.0, "1.4": None}, {"1.1": 3.0})]
    assert len({one.digest(submission) for one in (settings, *others)}) == 3


@pytest.mark.usefixtures("in_sandbox")
def test_a_right_answer_that_hands_a_record_of_a_given_module_to_a_given_function_earns_its_points():
    lessons, worth = choice.chosen([], "10.5")                         # near_pairs returns it, round_contacts takes it
    submission = submissions.Submission("ada", {"simulator": example.worked("simulator").encode()}, (), "")
    found = marking.mark(submission, marking.settings(lessons, "a secret", worth))
    assert {test["status"] for test in found["tests"]} == {"passed"}


@pytest.mark.long
@pytest.mark.usefixtures("in_sandbox")
@pytest.mark.xdist_group("a graded class")
def test_a_class_is_graded_by_the_exercises_that_were_set(tmp_path):
    example.make(tmp_path / "class")
    run = subprocess.run(
        [sys.executable, "-m", "validate.grading", tmp_path / "class", "--out", tmp_path / "grades",
         "--seed", "a secret", "--exercises", "1.1=4,1.2-1.3=3"], cwd=modules.ROOT, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout + run.stderr
    with open(tmp_path / "grades" / "grades.csv", newline="") as file:
        rows = {row["student_id"]: row for row in csv.DictReader(file)}
    assert {row["max_score"] for row in rows.values()} == {"10"}
    assert [rows[name]["raw_score"] for name in ("ada", "bob", "cem", "dia")] == ["10", "6", "0", "10"]
    page = (tmp_path / "grades" / "students" / "bob.html").read_text()
    assert "1.3" in page and "verlet_step" not in page


def test_gradescope_and_classroom_get_the_choice(tmp_path):
    with pytest.raises(SystemExit) as end:
        autograder.main(["classroom", "--out", str(tmp_path / "grade.yml"), "--exercises", "3.1,3.4=2"])
    text = (tmp_path / "grade.yml").read_text()
    assert not end.value.code and [*dict.fromkeys(re.findall(r"name: Exercise ([\d.]+)", text))] == ["3.1", "3.4"]
    (tmp_path / "in").mkdir()
    worth = json.loads(json.dumps(choice.chosen([], "3.1,3.4=2")[1]))
    course = {"lessons": ["friction"], "exercises": worth, "seed": "a secret", "late": 0.0}
    found = autograder.graded(tmp_path / "in", course, {})
    assert sum(row["max_score"] for row in found["tests"]) == pytest.approx(
        2.0 + sum(row[4] for row in marking.manifest(["friction"], {"3.1": None})))
