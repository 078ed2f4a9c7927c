"""Points by hand are read from one file, count in every output, and change nothing that the machine found."""

import io
import json
import re

import pytest
from rich.console import Console

from solutions.checks import BadInput
from validate.grading import classlist, marking, marks, pages, submissions
from validate.subject.modules import ROOT

from .test_cli import grade, run
from .test_pages import DUE, EVIL, FREE, SETTINGS, Seen, found, result, rows_of

STUDENTS = {"ada", "bob", "cem", "dia"}
PEOPLE = {name: classlist.Person(name, name.title(), "Ö") for name in sorted(STUDENTS)}
HEAD = "student_id,exercise,points,comment,how\n"
MISSED = found("1.2", "not yet", {"quantity": "height [m]"})           # 3 of 10 points
BAD = {
    "zoe,1.1,1,,": "student 'zoe' in line 2",
    "ada,99.1,1,,": "exercise '99.1' in line 2",
    "ada,rotations,1,,": "exercise 'rotations' in line 2",
    "ada,1.1,,,": "points '' in line 2",
    "ada,1.1,two,,": "points 'two' in line 2",
    "ada,1.1,nan,,": "points 'nan' in line 2",
    "ada,1.1,inf,,add": "points 'inf' in line 2",
    "ada,1.1,2.5,,": "points '2.5' in line 2 of '{0}' is too many: write 0 to 2; how = add may go above the maximum",
    "ada,1.1,-1,,set": "points '-1' in line 2 of '{0}' is too few: write 0 to 2",
    "ada,1.1,3,,add": "points '3' in line 2 of '{0}' is too many: write -2 to 2",
    "ada,,11,,": "write 0 to 10",
    "ada,1.1,1,,replace": "how 'replace' in line 2",
    "ada,1.1,1,right, but late,": "line 2 of '{0}' is of more cells",
    "ada,1.1,1,,\nada,fall,2,,": "1.1 of 'ada' in line 3 of '{0}' is set a second time",
    'ada,1.1,1,"no end,': "not readable",
}


def given(folder, lines, students=STUDENTS, settings=SETTINGS):
    """The marks of a class folder with these lines in its file."""
    folder.mkdir(exist_ok=True)
    (folder / "marks.csv").write_text(HEAD + lines)
    return marks.read(folder, settings, students)


def scores(out, student):
    """{assignment: (raw_score, score, raw_score_of_tests, by_hand)} of a student."""
    return {r["assignment"]: (r["raw_score"], r["score"], r["raw_score_of_tests"], r["by_hand"])
            for r in rows_of(out) if r["student_id"] == student}


# ---------------------------------------------------------------------------------------------- the file

@pytest.mark.parametrize("lines", BAD)
def test_a_line_that_is_wrong_is_refused_in_one_sentence_that_names_it(tmp_path, lines):
    with pytest.raises(BadInput, match=re.escape(BAD[lines].format(tmp_path / "marks.csv"))) as told:
        given(tmp_path, lines)
    assert "\n" not in str(told.value)


@pytest.mark.parametrize(("content", "why"), [
    (b"", "the first line"),
    (b"student_id,exercise\nada,1.1\n", "the first line"),
    (b"student_id,exercise,points,remark\nada,1.1,1,x\n", "remark"),
    (b"student_id,exercise,points,points\nada,1.1,1,2\n", "the first line"),
    ("student_id,exercise,points,comment\nada,1.1,1,schön".encode("cp1252"), "UTF-8"),
])
def test_a_file_with_other_columns_is_refused_whole(tmp_path, content, why):
    (tmp_path / "marks.csv").write_bytes(content)
    with pytest.raises(BadInput, match=why):
        marks.read(tmp_path, SETTINGS, STUDENTS)


@pytest.mark.parametrize("text", [
    "student_id,exercise,points,comment,how\nada,1.2,1.5,good,\n\n,,,,\n",
    "\ufeffStudent_ID;Exercise;Points;Comment;How\r\n ada ; 1.2 ;1,5; good ;SET\r\n",
    "points\tcomment\tstudent_id\texercise\n1.5\tgood\tada\tland\n",
])
def test_the_file_may_come_from_any_spreadsheet(tmp_path, text):
    (tmp_path / "marks.csv").write_text(text, encoding="utf-8", newline="")
    only = marks.Mark(("falling", "1.2"), 1.5, False, "good")
    assert marks.read(tmp_path, SETTINGS, STUDENTS) == {"ada": (only,)}


def test_a_function_may_stand_for_its_exercise_unless_two_lessons_have_it(tmp_path):
    rest = given(tmp_path, "ada,rest,1,,")["ada"]                      # 1.10, which spreadsheets turn into 1.1
    assert [mark.place for mark in rest] == [("falling", "1.10")]
    twice = SETTINGS._replace(manifest=(*SETTINGS.manifest, ("bouncing", "2.2", "rest", "test_it_rests", 1, "")))
    with pytest.raises(BadInput, match="in more than one lesson"):
        given(tmp_path, "ada,rest,1,,", settings=twice)


def test_the_file_of_the_documentation_is_right(tmp_path):
    shown = re.search(r"^```\n(student_id,.*?)^```", (ROOT / "docs" / "grading.md").read_text("utf-8"), re.M | re.S)[1]
    (tmp_path / "marks.csv").write_text(shown)
    rules = marking.settings(["integrators", "springs"], "a secret")
    places = {student: given[0].place for student, given in marks.read(tmp_path, rules, STUDENTS).items()}
    assert places == {"ada": ("integrators", "1.2"), "bob": ("integrators", "1.3"), "cem": ("springs", ""),
                      "dia": marks.TOTAL}


def test_lines_of_lessons_that_are_not_graded_are_left_out_and_counted(tmp_path):
    """One file for all lessons, each of which is graded by a command of its own."""
    said, lines = [], "ada,rotation,1,,\nada,skew,1,,\nada,5.1,7,,\nada,1.2,1,,\n"
    (tmp_path / "marks.csv").write_text(HEAD + lines)
    found = marks.read(tmp_path, SETTINGS, STUDENTS, said.append)
    assert [mark.place[1] for mark in found["ada"]] == ["1.2"]
    assert said == ["marks.csv: 3 lines of lessons that are not graded in this run, left out"]


def test_without_the_file_there_are_no_marks(tmp_path):
    assert marks.read(tmp_path, SETTINGS, STUDENTS) == {}


# ---------------------------------------------------------------------------------------------- the points

@pytest.mark.parametrize(("lines", "falling", "bouncing", "total"), [
    ("ada,1.2,2,,", "5", "4", 9.0),
    ("ada,1.2,2,,set\nada,1.2,0.5,,add", "5.5", "4", 9.5),
    ("ada,1.2,0.5,,add\nada,1.2,2,,set", "5.5", "4", 9.5),             # in any order
    ("ada,1.1,0,,", "1", "4", 5.0),
    ("ada,1.1,2,,add\nada,1.1,1,,add", "6", "4", 10.0),                # above the maximum
    ("ada,1.1,-2,,add\nada,1.1,-2,,add", "1", "4", 5.0),               # not below 0
    ("ada,falling,6,,", "6", "4", 10.0),
    ("ada,falling,1,,add\nada,1.2,3,,", "7", "4", 11.0),               # exercises first, then the lesson
    ("ada,,10,,", "3", "4", 10.0),
    ("ada,,-1,,add\nada,bouncing,0,,", "3", "0", 2.0),                 # the total last
])
def test_points_are_set_and_added_to_exercises_lessons_and_the_total(tmp_path, lines, falling, bouncing, total):
    pages.write(tmp_path, [result("ada", MISSED)], {}, SETTINGS, {}, FREE, given=given(tmp_path / "class", lines))
    rows = scores(tmp_path, "ada")
    assert (rows["falling"][0], rows["bouncing"][0]) == (falling, bouncing)
    assert (rows["falling"][2], rows["bouncing"][2]) == ("3", "4")     # what the tests gave
    assert sum(float(score) for _, score, *_ in rows.values()) == pytest.approx(total)
    assert json.loads((tmp_path / "gradescope" / "ada.json").read_text())["score"] == total
    assert f"{total:g} of 10 points" in " ".join(Seen(tmp_path / "students" / "ada.html").text.split())


def test_the_late_penalty_comes_after_points_of_exercises_and_lessons_and_before_those_of_the_total(tmp_path):
    late = result("ada", MISSED, timestamp="2026-12-01T00:00:00"), pages.Terms(DUE, 10.0)
    lesson = given(tmp_path / "class", "ada,falling,5,,\nada,bouncing,0.2,,")
    pages.write(tmp_path, [late[0]], {}, SETTINGS, {}, late[1], given=lesson)
    assert [row[:2] for row in scores(tmp_path, "ada").values()] == [("5", "4.4"), ("0.2", "0")]
    pages.write(tmp_path, [late[0]], {}, SETTINGS, {}, late[1], given=given(tmp_path / "class", "ada,,7,,"))
    assert json.loads((tmp_path / "gradescope" / "ada.json").read_text())["score"] == 7.0


def test_who_handed_nothing_in_may_have_points_by_hand(tmp_path):
    some = [result("ada", handed_in=("falling",), timestamp="2026-12-01T00:00:00")]
    lines = given(tmp_path / "class", "ada,bouncing,4,by paper,\nbob,1.1,2,told me,\ncem,,3,,")
    seen = pages.write(tmp_path, some, {"cem": "RuntimeError"}, SETTINGS, PEOPLE, pages.Terms(DUE, 10.0), given=lines)
    assert scores(tmp_path, "ada")["bouncing"] == ("4", "4", "0", "bouncing: 4 by hand, and 0 without: by paper")
    assert scores(tmp_path, "bob")["falling"] == ("2", "2", "0", "1.1: 2 by hand, and 0 without: told me")
    assert scores(tmp_path, "cem")["falling"][0] == ""                 # a failure of the grader is still none
    assert not (tmp_path / "students" / "cem.html").exists()
    assert "1 student handed in" not in Seen(seen).text and "2 students handed in" in Seen(seen).text
    page = Seen(tmp_path / "students" / "bob.html").text
    assert "told me" in page and "nothing was handed in" in page
    pages.write(tmp_path, some, {}, SETTINGS, PEOPLE, FREE)            # the line is gone, and so is the page
    assert not (tmp_path / "students" / "bob.html").exists() and scores(tmp_path, "bob")["falling"][0] == "0"


# ---------------------------------------------------------------------------------------------- where it is shown

def test_points_by_hand_are_shown_with_their_comment_beside_those_of_the_tests(tmp_path):
    lines = given(tmp_path / "class", 'ada,1.2,2,"nearly, see me",\nada,,0.5,for the essay,add')
    seen = Seen(pages.write(tmp_path, [result("ada", MISSED), result("bob")], {}, SETTINGS, {}, FREE, given=lines))
    page = " ".join(Seen(tmp_path / "students" / "ada.html").text.split())
    for text in ("1.2: 2 by hand, and 0 without: nearly, see me", "the total: 9.5 by hand, and 9 without"):
        assert text in page
    assert "for the essay" in page and "not yet, points by hand" in page
    part = seen.text[seen.text.index("Points by hand"):seen.text.index("Students", seen.text.index("Points by hand"))]
    assert re.search(r"ada\s*1\.2\s*0\s*2\s*nearly, see me", part) and "bob" not in part
    rows = scores(tmp_path, "ada")
    assert rows["falling"][3] == "1.2: 2 by hand, and 0 without: nearly, see me"
    assert rows["by hand"] == ("0.5", "0.5", "0", "the total: 9.5 by hand, and 9 without: for the essay")
    assert set(scores(tmp_path, "bob")) == {"falling", "bouncing"}
    output = json.loads((tmp_path / "gradescope" / "ada.json").read_text())["output"]
    assert "By hand: 1.2: 2 by hand, and 0 without: nearly, see me" in output and "for the essay" in output
    assert "by hand" not in Seen(tmp_path / "students" / "bob.html").text.lower()


def test_comments_of_one_place_are_joined_and_the_screen_counts_the_points(tmp_path):
    lines = given(tmp_path, "ada,1.2,1,one,add\nada,1.2,0.5,,add\nada,1.2,0,two,add")
    assert pages.sheet(result("ada", MISSED), SETTINGS, FREE, None, lines["ada"]).hands["falling", "1.2"] == (
        "1.2", 0, 1.5, "one; two")
    screen = Console(file=io.StringIO(), width=200)
    pages.show(screen, [result("ada", MISSED)], {}, SETTINGS, lines)
    assert re.search(r"falling +1 +4\.5 +4\.5 +6", screen.file.getvalue())


def test_an_edit_changes_the_files_of_its_student_only(tmp_path):
    some = [result("ada", MISSED), result("bob", MISSED)]

    def files(lines):
        pages.write(tmp_path, some, {}, SETTINGS, {}, FREE, given=given(tmp_path / "class", lines))
        return {path.name: path.read_bytes() for path in tmp_path.glob("*/*.*") if path.name != "marks.csv"}, rows_of(
            tmp_path)
    (first, one), (again, same), (second, two) = files("bob,1.2,1,,"), files("bob,1.2,1,,"), files("bob,1.2,2,,")
    assert first == again and one == same
    assert {name for name in first if first[name] != second[name]} == {"bob.html", "bob.json"}
    assert [(r["student_id"], r["assignment"]) for r, s in zip(one, two, strict=True) if r != s] == [("bob", "falling")]


def test_a_comment_is_neither_markup_nor_a_formula(tmp_path):
    comment = EVIL.replace("\ud800", "").replace('"', "").replace("\x00", "")
    lines = given(tmp_path / "class", f'ada,1.2,1,"{comment}",\nada,1.1,1,=1+1,\nada,,1,"=1;\n=2",add')
    pages.write(tmp_path, [result("ada", MISSED)], {}, SETTINGS, {}, FREE, given=lines)
    for row in rows_of(tmp_path):
        assert not re.search(r"(^|[;|,\t])[\s\"']*(?<!')[=+@]", row["by_hand"]) and row["by_hand"].isprintable()
    for page in (tmp_path / "index.html", tmp_path / "students" / "ada.html"):
        seen = Seen(page)
        assert "script" not in seen.tags and "<script>alert(1)</script>" in seen.text and r"\x202e" in seen.text


# ---------------------------------------------------------------------------------------------- the command

@pytest.fixture
def handed_in(tmp_path, made_up):
    """A class of two whose results are made up; {student: how often he was graded}."""
    for student in ("ada", "bob"):
        (tmp_path / "class" / student).mkdir(parents=True)
        (tmp_path / "class" / student / "integrators.py").write_text("")
    return made_up(lambda s, settings: {})


def test_marks_are_applied_by_the_same_command_and_no_student_is_graded_again(capsys, tmp_path, handed_in):
    command = [grade, tmp_path / "class", "--lesson", "integrators", "--out", tmp_path / "grades"]
    assert "by hand" not in run(capsys, *command)[1]
    kept = {path: path.read_bytes() for path in (tmp_path / "grades" / "results").iterdir()}
    (tmp_path / "class" / "marks.csv").write_text(HEAD + "bob,1.1,1,seen,\n")
    code, said, _ = run(capsys, *command)
    assert code == 0 and "marks.csv: 1 line with points by hand, for bob" in said and "marks.csv is" not in said
    assert handed_in == {"ada": 1, "bob": 1} and kept == {path: path.read_bytes() for path in kept}
    rows = {r["student_id"]: r for r in rows_of(tmp_path / "grades")}
    assert [rows[name]["score"] for name in ("ada", "bob")] == ["0", "1"] and set(rows) == {"ada", "bob"}
    (tmp_path / "class" / "marks.csv").write_text(HEAD + "bod,1.1,1,,\n")
    code, _, error = run(capsys, *command)
    assert code == 2 and "student 'bod'" in error and len(error.splitlines()) == 1
    assert rows_of(tmp_path / "grades") == [*rows.values()]            # refused before anything is written


def test_a_folder_of_that_name_is_a_submission_as_any_other(tmp_path):
    (tmp_path / "marks.csv").mkdir()
    assert [one.student for one in submissions.read_all(tmp_path, ["integrators"]).submissions] == ["marks.csv"]
    assert marks.read(tmp_path, SETTINGS, STUDENTS) == {}
