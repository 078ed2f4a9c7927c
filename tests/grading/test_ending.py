"""The terminal says at the end of a run, once, who is graded, who is missing, who is a stranger, and why."""

import csv
import os
import time

import pytest

from validate.grading import __main__ as grade
from validate.grading import marking, sandbox

from .test_cli import run

LIST = """student_id,last_name,first_name,email{0}
ada,Lovelace,Ada,ada@example.org{1}
bob,Hooke,Bob,bob@example.org{2}
cem,Yilmaz,Cem,cem@example.org{3}
"""
DATES = {"ada": 1.8e9, "bob": 1.8e9 + 90_000, "zoe": 1.8e9}            # 15 and 16 January 2027


@pytest.fixture
def handed_in(tmp_path, monkeypatch, made_up):
    """The command of a class in which all get all points in this process; how often each was graded."""
    def all_points(s, settings):
        tests = [marking.verdict(row, {}, True) for row in settings.manifest]
        return {"problems": list(s.problems), "handed_in": sorted(s.files), "timestamp": s.timestamp,
                "tests": [{**t, "status": "passed", "earned": t["points"], "says": {}} for t in tests]}
    graded = made_up(all_points)
    monkeypatch.setattr(sandbox, "unavailable", lambda: "")            # no code is run
    for student, when in DATES.items():
        file = tmp_path / "class" / student / "integrators.py"
        file.parent.mkdir(parents=True)
        file.write_text(f"{student} = 1\n")
        os.utime(file, (when, when))
    monkeypatch.setenv("TZ", "UTC")
    time.tzset()
    return [tmp_path / "class", "--lesson", "integrators", "--out", tmp_path / "grades"], graded


def listed(tmp_path, *columns):
    (tmp_path / "list.csv").write_text(LIST.format(*columns))
    return ["--roster", tmp_path / "list.csv"]


def rows(tmp_path):
    with open(tmp_path / "grades" / "grades.csv", newline="", encoding="utf-8") as file:
        return {row["student_id"]: row for row in csv.DictReader(file)}


def test_who_is_graded_missing_strange_or_unreadable_is_counted_and_named_once(capsys, tmp_path, handed_in):
    command, _ = handed_in
    (tmp_path / "class" / "bob" / "integrators.py").write_bytes(b"")
    (tmp_path / "class" / "notes.txt").write_bytes(b"")
    (tmp_path / "class" / "ada" / "integrators (1).py").write_bytes(b"x = 1\n")
    code, said, _ = run(capsys, grade, *command, *listed(tmp_path, "", "", "", ""))
    for line in ("2 handed in and graded", "1 on the class list and nothing handed in: cem",
                 "1 handed in and not on the class list: zoe", "1 could not be read:",
                 "  bob: integrators.py is empty, so it is not graded: was it saved before it was handed in?",
                 "ada: integrators (1).py was not read: integrators.py counts",
                 "notes.txt is no submission, and was not read"):
        assert said.splitlines().count(line) == 1 == said.count(line.strip()), line
    assert code == 0


def test_without_a_class_list_no_student_is_a_stranger(capsys, handed_in):
    said = run(capsys, grade, *handed_in[0])[1]
    assert "3 handed in and graded\n0 could not be read\n" in said and "class list" not in said


@pytest.mark.parametrize("inside", ["", "grades", "ada", "ada/../new/grades"])
def test_an_output_folder_in_the_class_is_refused(capsys, tmp_path, handed_in, inside):
    command, graded = handed_in
    code, said, error = run(capsys, grade, *command[:-1], tmp_path / "class" / inside)
    assert code == 2 and "in the class folder: name a folder beside it" in error and len(error.splitlines()) == 1
    assert not graded and not said and sorted(os.listdir(tmp_path / "class")) == [*DATES]


# ---------------------------------------------------------------------------------------------- dates

LATE = ("--due", "2027-01-15T12:00", "--late", "10")
TOLD = "Late days follow the dates of the files, which students can set"


def test_where_late_days_follow_the_files_this_is_said(capsys, tmp_path, handed_in):
    assert TOLD in run(capsys, grade, *handed_in[0], *LATE)[1]
    assert rows(tmp_path)["bob"]["late_submission_penalty"] == "2"
    assert TOLD not in run(capsys, grade, *handed_in[0])[1]


def test_where_the_class_list_has_times_no_date_of_a_file_counts(capsys, tmp_path, handed_in):
    lines = listed(tmp_path, ",timestamp", ",2027-01-17T12:00", ",", ",")
    assert TOLD not in run(capsys, grade, *handed_in[0], *LATE, *lines)[1]
    found = rows(tmp_path)
    assert found["ada"]["late_submission_penalty"] == "4" and found["ada"]["timestamp"] == "2027-01-17T12:00:00"
    assert found["bob"]["late_submission_penalty"] == "0" and found["bob"]["timestamp"] == ""
    assert "when it was handed in is not known" in found["bob"]["problems"]


def test_a_students_own_due_date_is_in_place_of_the_classs(capsys, tmp_path, handed_in):
    run(capsys, grade, *handed_in[0], *LATE, *listed(tmp_path, ",due", ",2027-01-13", ",2027-01-16", ","))
    found = rows(tmp_path)
    assert [found[s]["late_submission_penalty"] for s in ("ada", "bob", "zoe")] == ["4", "0", "0"]
    assert [found[s]["duedate"] for s in ("ada", "cem")] == ["2027-01-13T23:59:59", "2027-01-15T12:00:00"]
    page = (tmp_path / "grades" / "students" / "ada.html").read_text()
    assert "due 2027-01-13 23:59:59, 2 days late" in page
    assert "2 students have other due dates" in (tmp_path / "grades" / "index.html").read_text()


# ---------------------------------------------------------------------------------------------- groups

def test_a_group_is_graded_once_and_all_its_members_get_the_points(capsys, tmp_path, handed_in):
    command, graded = handed_in
    said = run(capsys, grade, *command, *LATE, *listed(tmp_path, ",group,due", ",,", ",red,", ",red,2027-01-20"))[1]
    found = rows(tmp_path)
    assert graded == {"ada": 1, "bob": 1, "zoe": 1} and "4 handed in and graded" in said
    assert [found[s]["score"] for s in ("ada", "bob", "cem")] == ["20", "18", "20"]    # each by his own due date
    assert "this is one submission" not in said
    assert "this is one submission of bob, cem" in (tmp_path / "grades" / "students" / "cem.html").read_text()
    run(capsys, grade, *command)
    assert graded["bob"] == 1


def test_a_group_that_hands_in_two_different_answers_has_neither_points_nor_a_zero(capsys, tmp_path, handed_in):
    code, said, _ = run(capsys, grade, *handed_in[0], *listed(tmp_path, ",group", ",red", ",red", ",red"))
    assert code == 1 and said.count("as ada, bob: keep one of them") == 3
    assert {s: row["score"] for s, row in rows(tmp_path).items()} == {"ada": "", "bob": "", "cem": "", "zoe": "20"}
