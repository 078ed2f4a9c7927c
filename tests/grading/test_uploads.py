"""Each system finds in our file what it finds in a file of its own.

The samples have the form of the systems' own files, with our data.  A reader for each has the system's rules; it is
tried on the sample before it reads our file.
"""

import csv
import io
import json
import re

import pytest

from validate.grading import classlist, marks, pages, points, uploads

from .test_cli import grade, run
from .test_marks import HEAD, handed_in  # noqa: F401   a fixture
from .test_pages import DUE, EVIL, FREE, SETTINGS, Seen, found, result

# Columns and their order: instructure/canvas-lms, lib/gradebook_importer.rb and spec/lib/gradebook_importer_spec.rb.
CANVAS = """Student,ID,SIS User ID,SIS Login ID,Section,falling,bouncing (31)
    Points Possible,,,,,6,4.00
"Lovelace, Ada",101,S-1,ada01,Monday,4.5,4
"Hooke, Bob",,S-2,,Monday,0,
"Test Student",,,,,,
"""
# moodle/moodle, grade/import/csv/tests/load_data_test.php.
MOODLE = """"First name",Surname,"ID number",Institution,Department,"Email address",falling, "Feedback: falling"
Ada,Lovelace,,Town,Physics,ada@example.org,4.50,"Well done, and short"
Bob,Hooke,S-2,Town,Physics,bob@example.org,0.00,
"""
# jupyter/nbgrader, nbgrader/plugins/export.py.
NBGRADER = """assignment,duedate,timestamp,student_id,last_name,first_name,email,\
raw_score,late_submission_penalty,score,max_score
falling,2026-11-30 23:59:00,2026-11-30 12:00:00,ada,Lovelace,Ada,ada@example.org,4.5,0.0,4.5,6.0
bouncing,,,ada,Lovelace,Ada,ada@example.org,0.0,0.0,0.0,4.0
"""
# Gradescope's documentation of autograders, Specifications, results.json; all keys that it names.
GRADESCOPE = """{"score": 4.5, "execution_time": 12, "output": "late", "output_format": "text",
 "test_output_format": "text", "test_name_format": "text",
 "visibility": "visible", "stdout_visibility": "hidden", "extra_data": {},
 "tests": [{"score": 2.0, "max_score": 3.0, "status": "failed", "name": "It falls", "name_format": "text",
            "number": "1.1", "output": "down", "output_format": "text", "tags": ["falling"], "visibility": "visible",
            "extra_data": {}}], "leaderboard": []}"""
PEOPLE = {
    "ada": classlist.Person("ada", "Lovelace", "Ada", "ada@example.org", "", "101", "S-1", "ada01", "Monday"),
    "bob": classlist.Person("bob", "Hooke", "Bob", "bob@example.org", sis_id="S-2"),
    "fay": classlist.Person("fay", "Tanaka", "Fay", "fay@example.org", login="fay07"),
}


def canvas(text):
    """What Canvas reads: ({assignment: maximum}, {id, else SIS id, else login: {assignment: grade}})."""
    head, *rows = csv.reader(io.StringIO(text, newline=""))
    assert "Student" in head[0] and "ID" in head[1] and "Section" in head[4]
    assert re.search(r"SIS\s+User\s+ID", head[2]) and re.search(r"SIS\s+Login\s+ID", head[3])
    titles = [re.sub(r" \(\d+\)$", "", title) for title in head[5:]]   # with the number of an assignment that exists
    possible = next(row for row in rows if "Points Possible" in row[0])
    grades = {next(filter(None, row[1:4])): dict(zip(titles, row[5:], strict=True))
              for row in rows if row is not possible and any(row[1:4])}
    for number in [*possible[5:], *(number for of in grades.values() for number in of.values())]:
        assert re.fullmatch(r"(-?\d+(\.\d+)?)?", number)               # others lose their commas and points
    return dict(zip(titles, possible[5:], strict=True)), grades


def moodle(text, column="Email address"):
    """What Moodle reads when a column is mapped to the user: {user: {item: (grade, feedback)}}."""
    head, *rows = csv.reader(io.StringIO(text, newline=""), skipinitialspace=True)
    assert all(len(row) == len(head) for row in rows)                  # else "csvweirdcolumns"
    read, items = {}, [name for name in head if f"Feedback: {name}" in head]
    for row in (dict(zip(map(str.strip, head), row, strict=True)) for row in rows):
        assert row[column] not in ("", *read)
        read[row[column]] = {item: (float(row[item]), row[f"Feedback: {item}"]) for item in items}
    return read


def written(tmp_path, *results, people=PEOPLE, failed=(), terms=FREE, lines=""):
    """The class, written with these points by hand: the text of a file by its name."""
    (tmp_path / "marks.csv").write_text(HEAD + lines)
    given = marks.read(tmp_path, SETTINGS, {*people})
    pages.write(tmp_path, results, dict(failed), SETTINGS, people, terms, given=given)
    return {path.name: path.read_bytes().decode() for path in tmp_path.glob("*.*") if path.is_file()}


MISSED = found("1.2", "not yet", {"quantity": "height [m]"})           # 3 of 6 points of the first lesson


# ---------------------------------------------------------------------------------------------- the systems

def test_canvas_reads_our_file_as_its_own(tmp_path):
    maxima = {"falling": "6", "bouncing": "4.00"}
    assert canvas(CANVAS) == (maxima, {"101": {"falling": "4.5", "bouncing": "4"},
                                       "S-2": {"falling": "0", "bouncing": ""}})
    late = pages.Terms(DUE, 25.0)
    some = result("ada", MISSED, timestamp="2026-12-01T00:00:00"), result("bob", handed_in=("falling",))
    text = written(tmp_path, *some, terms=late)["canvas.csv"]
    assert canvas(text) == ({"falling": "6", "bouncing": "4"},
                            {"101": {"falling": "1.5", "bouncing": "3"}, "S-2": {"falling": "6", "bouncing": "0"},
                             "fay07": {"falling": "0", "bouncing": "0"}})
    assert text.splitlines()[0].split(",")[:5] == CANVAS.splitlines()[0].split(",")[:5]
    assert text.splitlines()[1].startswith("    Points Possible,,,,,")
    assert text.splitlines()[2].startswith('"Lovelace, Ada",101,S-1,ada01,Monday,')


def test_moodle_reads_our_file_as_its_own(tmp_path):
    assert moodle(MOODLE) == {"ada@example.org": {"falling": (4.5, "Well done, and short")},
                              "bob@example.org": {"falling": (0.0, "")}}
    some = result("ada", MISSED, timestamp="2026-12-01T00:00:00"), result("bob", handed_in=("falling",))
    text = written(tmp_path, *some, terms=pages.Terms(DUE, 25.0), lines='ada,1.2,2,"nearly, see me",')["moodle.csv"]
    told = "1.5 off for being late | 1.2: 2 by hand, and 0 without: nearly, see me"
    assert moodle(text) == {
        "ada@example.org": {"falling": (3.5, told), "bouncing": (3.0, "1 off for being late")},
        "bob@example.org": {"falling": (6.0, ""), "bouncing": (0.0, "not handed in")},
        "fay@example.org": {"falling": (0.0, "not handed in"), "bouncing": (0.0, "not handed in")},
    }
    assert {"First name", "ID number", "Email address"} <= {*text.splitlines()[0].split(",")}


def test_a_zero_for_a_file_that_does_not_load_comes_with_its_reason(tmp_path):
    got = "SyntaxError: invalid syntax (falling.py, line 3)"
    lost = [found(exercise, "not yet", {"quantity": points.READING, "got": got}) for exercise in ("1.1", "1.2", "1.10")]
    feedback = moodle(written(tmp_path, result("ada", *lost))["moodle.csv"])["ada@example.org"]
    assert feedback == {"falling": (0.0, f"falling.py does not load: {got}"), "bouncing": (4.0, "")}


def test_a_zero_without_a_file_that_can_be_read_says_what_was_handed_in(tmp_path):
    one = result("ada", handed_in=(), problems=["notes.pdf was not read", "a.zip lies inside, and was not read"])
    feedback = moodle(written(tmp_path, one)["moodle.csv"])["ada@example.org"]
    said = "no file of this lesson that can be read: notes.pdf was not read; a.zip lies inside, and was not read"
    assert feedback == {"falling": (0.0, said), "bouncing": (0.0, said)}


def test_nbgrader_has_the_columns_of_its_own_export_first(tmp_path):
    head, *sample = csv.reader(io.StringIO(NBGRADER, newline=""))
    ours, *rows = csv.reader(io.StringIO(written(tmp_path, result("ada"))["grades.csv"], newline=""))
    assert ours[:len(head)] == head
    for row in (*sample, *rows):
        raw, penalty, score, maximum = map(float, row[7:11])
        assert score == raw - penalty <= maximum


def test_gradescope_knows_every_key_of_its_results(tmp_path):
    written(tmp_path, result("ada", MISSED), lines="ada,1.2,2,,")
    sample, ours = json.loads(GRADESCOPE), json.loads((tmp_path / "gradescope" / "ada.json").read_text())
    assert {*ours} <= {*sample} and {key for test in ours["tests"] for key in test} <= {*sample["tests"][0]}
    assert ours["score"] == 9 and ours["output_format"] == "text"


# ---------------------------------------------------------------------------------------------- who is in them

def test_a_total_by_hand_is_an_assignment_of_its_own(tmp_path):
    files = written(tmp_path, result("ada"), lines="ada,,8.5,too late,\nfay,,0.125,,add")
    maxima, grades = canvas(files["canvas.csv"])
    assert maxima["by hand"] == "0" and [of["by hand"] for of in grades.values()] == ["-1.5", "0", "0.125"]
    assert moodle(files["moodle.csv"])["ada@example.org"]["by hand"] == (
        -1.5, "the total: 8.5 by hand, and 10 without: too late")


def test_who_is_not_graded_or_not_on_the_class_list_is_in_neither_file(tmp_path):
    files = written(tmp_path, result("ada"), result("zoe"), failed={"bob": "RuntimeError"})
    assert [*canvas(files["canvas.csv"])[1]] == ["101", "fay07"]
    assert [*moodle(files["moodle.csv"])] == ["ada@example.org", "fay@example.org"]


@pytest.mark.parametrize(("change", "files", "gaps"), [
    ({}, {"canvas.csv", "moodle.csv"}, []),
    ({"login": ""}, {"canvas.csv", "moodle.csv"}, [
        ("canvas.csv lacks fay: no canvas_id or sis_id or login of their own on the class list", False)]),
    ({"canvas_id": "101"}, {"canvas.csv", "moodle.csv"}, [          # two have it: Canvas would mix them up
        ("canvas.csv lacks ada, fay: no canvas_id or sis_id or login of their own on the class list", False)]),
    ({"email": ""}, {"canvas.csv", "moodle.csv"}, [
        ("moodle.csv lacks fay: no email of their own on the class list", False)]),
])
def test_what_the_class_list_lacks_is_said(tmp_path, change, files, gaps):
    people = {**PEOPLE, "fay": PEOPLE["fay"]._replace(**change)}
    assert files <= {*written(tmp_path, result("ada"), people=people)} and uploads.gaps(people) == gaps
    page = Seen(tmp_path / "index.html").text
    assert all(sentence in page for sentence, _ in gaps)


def test_moodle_finds_all_students_by_one_column(tmp_path):
    people = {name: person._replace(email="", sis_id=f"S-{name}") for name, person in PEOPLE.items()}
    people["ada"] = people["ada"]._replace(email="ada@example.org")
    text = written(tmp_path, result("ada"), people=people)["moodle.csv"]
    assert [*moodle(text, "ID number")] == ["S-ada", "S-bob", "S-fay"]


def test_no_file_is_written_where_no_student_could_be_found(tmp_path):
    assert {"canvas.csv", "moodle.csv"} <= {*written(tmp_path, result("ada"))}
    names = {name: classlist.Person(name) for name in PEOPLE}
    for people in (names, {}):
        left = written(tmp_path, result("ada"), people=people)
        assert not {"canvas.csv", "moodle.csv"} & {*left}              # nor that of an earlier run
    assert [gap.whole for gap in uploads.gaps(names)] == [True, True] == [gap.whole for gap in uploads.gaps({})]


@pytest.mark.parametrize("text", ["=1+1", "+1", "@SUM(A1)", "a;=1", "\t=1", "＝1", EVIL])
def test_no_cell_is_a_formula(tmp_path, text):
    people = {"ada": classlist.Person("ada", text, text, text, "", text, text, text, text)}
    files = written(tmp_path, result("ada"), people=people)
    for name in ("canvas.csv", "moodle.csv"):
        for row in csv.reader(io.StringIO(files[name], newline="")):
            parts = [part.lstrip(' "') for cell in row for part in re.split(r"[;|,\t]", cell)]
            assert not [part for part in parts if part[:1] in tuple("=+@＝")] and "".join(row).isprintable()


@pytest.mark.parametrize(("x", "text"), [
    (0, "0"), (5.5e-17, "0"), (-5.5e-17, "0"), (20, "20"), (1e6 / 3, "333333.3333"), (1e7, "10000000"), (-1.5, "-1.5"),
    (0.1 + 0.2, "0.3")])
def test_points_have_no_exponent(x, text):
    assert uploads.decimal(x) == text


def test_the_class_list_may_give_the_ids_of_the_systems(capsys, tmp_path, handed_in):  # noqa: F811
    (tmp_path / "class" / "list.csv").write_text("student_id,email,canvas_id\nada,ada@example.org,7\nbob,,8\n")
    command = [grade, tmp_path / "class", "--lesson", "integrators", "--out", tmp_path / "grades", "--roster",
               tmp_path / "class" / "list.csv"]
    said = run(capsys, *command)[1]
    assert "moodle.csv lacks bob: no email of their own on the class list" in said and "canvas.csv" not in said
