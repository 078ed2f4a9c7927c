"""Everything in the class folder is graded or named: nothing is overlooked, and no student stops the class."""

import csv
import json
import os
import tarfile
import unicodedata
import zipfile

import pytest

from solutions.checks import BadInput
from validate.grading import classlist, sandbox, submissions
from validate.subject import modules

from .test_cli import grade, run

pytestmark = [pytest.mark.usefixtures("one_reader"), pytest.mark.xdist_group("what is handed in")]
LESSONS = ("integrators", "springs")
TEXT = b"x = 1\n"
NFC, NFD = (unicodedata.normalize(form, "Zoë Müller") for form in ("NFC", "NFD"))


def folder(path, *lessons):
    path.mkdir(parents=True)
    for lesson in lessons or LESSONS:
        (path / f"{lesson}.py").write_bytes(TEXT)


def zipped(path, text=b"y = 2\n"):
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("integrators.py", text)


def tarred(path):
    (path.parent / "source.py").write_bytes(TEXT)
    with tarfile.open(path, "w:gz") as archive:
        archive.add(path.parent / "source.py", "integrators.py")
    (path.parent / "source.py").unlink()


def by_student(intake):
    return {one.student: one for one in intake.submissions}


# ---------------------------------------------------------------------- files that are no folder and no zip


def test_the_only_zip_in_a_folder_without_lesson_files_is_read(tmp_path):
    """Moodle makes a folder for each student, and in it lies what was handed in: often a zip."""
    moodle = tmp_path / "Ada Lovelace_1234567_assignsubmission_file"
    moodle.mkdir()
    zipped(moodle / "Abgabe.ZIP")
    (moodle / "notes.txt").write_text("in haste")
    (one,) = submissions.read_all(tmp_path, LESSONS).submissions
    assert one.files == {"integrators": b"y = 2\n"} and one.timestamp and not one.problems


@pytest.mark.parametrize("make", ["lesson beside it", "two zips", "zip in a zip", "link", "folder"])
def test_no_other_archive_in_a_folder_is_read(tmp_path, make):
    folder(tmp_path / "ada", "springs") if make == "lesson beside it" else (tmp_path / "ada").mkdir()
    inside = tmp_path / "ada" / "a.zip"
    if make == "link":
        zipped(tmp_path / ".elsewhere.zip")
        inside.symlink_to(tmp_path / ".elsewhere.zip")
    elif make == "folder":
        inside.mkdir()
        zipped(inside / "b.zip")
    elif make == "zip in a zip":
        zipped(tmp_path / ".b.zip")
        with zipfile.ZipFile(inside, "w") as archive:
            archive.write(tmp_path / ".b.zip", "b.zip")
    else:
        zipped(inside)
    if make == "two zips":
        zipped(tmp_path / "ada" / "b.zip")
    ada = by_student(submissions.read_all(tmp_path, LESSONS))["ada"]
    assert "integrators" not in ada.files
    assert ada.problems


@pytest.mark.parametrize("ending", [".tar.gz", ".tgz", ".TAR.XZ", ".tar", ".7z", ".rar", ".ipynb"])
def test_what_cannot_be_opened_is_its_students_and_says_so(tmp_path, ending):
    folder(tmp_path / "bob")
    tarred(tmp_path / f"ada.byron{ending}")
    ada = by_student(submissions.read_all(tmp_path, LESSONS))["ada.byron"]
    assert not ada.files and len(ada.problems) == 1 and f"ada.byron{ending}" in ada.problems[0]


def test_what_was_unpacked_by_hand_is_graded_and_the_archive_beside_it_is_named(tmp_path):
    folder(tmp_path / "ada")
    tarred(tmp_path / "ada.tar.gz")
    ada = by_student(submissions.read_all(tmp_path, LESSONS))["ada"]
    assert (
        sorted(ada.files) == ["integrators", "springs"] and len(ada.problems) == 1 and "ada.tar.gz" in ada.problems[0]
    )


def test_bare_lesson_files_of_a_student_belong_together(tmp_path):
    for name in ("ada_integrators.py", "ada-springs.py", "b.o_b integrators.py"):
        (tmp_path / name).write_bytes(TEXT + name.encode())
    os.utime(tmp_path / "ada_integrators.py", (1.8e9, 1.8e9))
    os.utime(tmp_path / "ada-springs.py", (1.7e9, 1.7e9))
    found = by_student(submissions.read_all(tmp_path, LESSONS))
    assert found["ada"].files == {"integrators": TEXT + b"ada_integrators.py", "springs": TEXT + b"ada-springs.py"}
    assert found["ada"].timestamp == submissions.moment(1.8e9) and found["ada"].problems == ()
    assert [*found["b.o_b"].files] == ["integrators"]


def test_a_bare_file_with_only_a_students_name_is_the_one_lesson_that_is_graded(tmp_path):
    (tmp_path / "ada.py").write_bytes(TEXT)
    assert by_student(submissions.read_all(tmp_path, ("springs",)))["ada"].files == {"springs": TEXT}
    (ada,) = submissions.read_all(tmp_path, LESSONS).submissions
    assert not ada.files and "ada_integrators.py" in ada.problems[0]  # of which lesson? the remedy is its name


def test_a_bare_file_of_another_lesson_is_not_taken_for_the_one_that_is_graded(tmp_path):
    (tmp_path / "ada_friction.py").write_bytes(TEXT)
    (ada,) = submissions.read_all(tmp_path, ("springs",)).submissions
    assert ada.student == "ada" and not ada.files and "friction" in ada.problems[0]


def test_two_bare_files_of_one_lesson_leave_open_which_is_meant(tmp_path):
    folder(tmp_path / "bob")
    (tmp_path / "ada_springs.py").write_bytes(TEXT)
    (tmp_path / "ada-springs.py").write_bytes(TEXT + b"y = 2\n")
    intake = submissions.read_all(tmp_path, LESSONS)
    assert [*by_student(intake)] == ["bob"] and all(
        name in intake.unclear["ada"] for name in ("ada_springs.py", "ada-springs.py")
    )


@pytest.mark.parametrize(
    "make",
    [
        lambda path: path.symlink_to(path.parent / "bob" / "springs.py"),
        os.mkfifo,
        lambda path: path.write_bytes(bytes(1 << 19)),
    ],
)
def test_tricks_with_bare_files_are_named_and_not_read(make, tmp_path):
    folder(tmp_path / "bob")
    make(tmp_path / "ada_springs.py")
    ada = by_student(submissions.read_all(tmp_path, LESSONS))["ada"]
    assert not ada.files and len(ada.problems) == 1


def test_lesson_files_beside_the_students_are_of_no_student_and_named(tmp_path):
    folder(tmp_path / "bob")
    (tmp_path / "springs.py").write_bytes(TEXT)
    intake = submissions.read_all(tmp_path, LESSONS)
    assert [*by_student(intake)] == ["bob"] and any("springs.py" in told for told in intake.overlooked)


def test_a_students_own_folder_in_place_of_the_class_is_told_with_its_remedy(tmp_path):
    folder(tmp_path / "ada")
    with pytest.raises(BadInput, match="the folder above"):
        submissions.read_all(tmp_path / "ada", LESSONS)


def test_other_files_are_named_unless_they_are_the_class_list_or_hidden(tmp_path):
    folder(tmp_path / "bob")
    for name in ("list.csv", ".DS_Store", "notes\x1b[2J.txt", "ada.docx"):
        (tmp_path / name).write_bytes(TEXT)
    (tmp_path / "__MACOSX").mkdir()
    intake = submissions.read_all(tmp_path, LESSONS, {"ada": classlist.Person("ada")}, tmp_path / "list.csv")
    assert len(intake.overlooked) == 1 and "notes\\x1b[2J.txt" in intake.overlooked[0]
    assert "ada.docx" in by_student(intake)["ada"].problems[0]  # she is on the list
    assert any("list.csv" in told for told in submissions.read_all(tmp_path, LESSONS).overlooked)


def test_what_nearly_is_a_lesson_file_is_named_where_the_lesson_is_missing(tmp_path):
    (tmp_path / "bob").mkdir()
    zipped(tmp_path / "bob" / "workbook.zip")
    zipped(tmp_path / "bob" / "workbook (1).zip")
    with zipfile.ZipFile(tmp_path / "cem.zip", "w") as archive:
        archive.writestr("integrators.py", TEXT)
        archive.writestr("notebooks/02_springs.ipynb", TEXT)
        archive.writestr("my_springs.py", TEXT)
    found = by_student(submissions.read_all(tmp_path, LESSONS))
    assert "workbook.zip" in " ".join(found["bob"].problems)
    assert (
        [*found["cem"].files] == ["integrators"]
        and len(found["cem"].problems) == 1
        and "my_springs.py" in found["cem"].problems[0]
    )


# ---------------------------------------------------------------------- one student, more than once


def test_a_student_who_is_there_twice_is_not_graded_and_all_others_are(tmp_path):
    folder(tmp_path / "ada")
    zipped(tmp_path / "ada.zip")
    folder(tmp_path / "bob")
    intake = submissions.read_all(tmp_path, LESSONS)
    assert [*by_student(intake)] == ["bob"]
    assert "ada.zip" in intake.unclear["ada"] and "keep one" in intake.unclear["ada"]


def test_a_class_in_which_no_student_is_clear_is_still_told_who(tmp_path):
    folder(tmp_path / "ada")
    zipped(tmp_path / "ada.zip")
    assert [*submissions.read_all(tmp_path, LESSONS).unclear] == ["ada"]


# ---------------------------------------------------------------------- one id, two spellings


@pytest.mark.parametrize(
    ("listed", "handed_in"), [(NFC, NFD), (NFD, NFC), ("ada", "ada "), ("a\u200bda", "a\u200bda"), ("a\xa0b", "a\xa0b")]
)
def test_an_id_is_the_same_in_any_way_of_writing_it(tmp_path, listed, handed_in):
    folder(tmp_path / "class" / handed_in)
    (tmp_path / "list.csv").write_text(f"student_id,last_name\n{listed},Lovelace\n", encoding="utf-8")
    people = classlist.roster(tmp_path / "list.csv")
    (one,) = submissions.read_all(tmp_path / "class", LESSONS, people).submissions
    assert [*people] == [one.student] and people[one.student].student_id == one.student and one.student.isprintable()


def test_two_folders_whose_names_differ_in_their_unicode_form_only_are_one_student_twice(tmp_path):
    folder(tmp_path / NFC)
    folder(tmp_path / NFD)
    if len(list(tmp_path.iterdir())) == 1:
        pytest.skip("this file system takes both for one")
    (tmp_path / NFD / "springs.py").write_bytes(b"y = 2\n")
    intake = submissions.read_all(tmp_path, LESSONS)
    assert not intake.submissions and [*intake.unclear] == [NFC]


def test_a_class_list_that_contradicts_itself_is_refused(tmp_path):
    (tmp_path / "list.csv").write_text(f"student_id,last_name\n{NFC},A\n{NFD},B\n", encoding="utf-8")
    with pytest.raises(BadInput, match="there twice"):
        classlist.roster(tmp_path / "list.csv")
    (tmp_path / "list.csv").write_text(f"student_id,last_name\n{NFC},A\n{NFD},A\n", encoding="utf-8")
    assert [*classlist.roster(tmp_path / "list.csv")] == [NFC]


# ---------------------------------------------------------------------- the command


def handed_in(top):
    """Make the folder of a class whose files come as folders, archives, single files and under an odd name."""
    blank = (modules.ROOT / "lessons" / "integrators.py").read_bytes()
    folder(top / "ada", "integrators")
    zipped(top / "ada.zip")
    tarred(top / "bob.tar.gz")
    (top / "cem_integrators.py").write_bytes(blank)
    (top / "notes.txt").write_bytes(TEXT)
    (top / NFD).mkdir()
    (top / NFD / "integrators.py").write_bytes(blank)
    (top / "list.csv").write_text(f"student_id\nada\nbob\ncem\n{NFC}\n", encoding="utf-8")


def test_the_command_says_all_of_it_on_the_terminal_on_the_page_and_in_the_csv(tmp_path, capsys, made_up, monkeypatch):
    made_up(lambda s, settings: {"problems": list(s.problems), "handed_in": sorted(s.files), "timestamp": s.timestamp})
    monkeypatch.setattr(sandbox, "unavailable", lambda: "")            # no code is run
    top = tmp_path / "class"
    handed_in(top)
    code, said, error = run(capsys, grade, top, "--out", tmp_path / "out", "--lesson", "integrators",
                            "--roster", top / "list.csv")
    assert code == 1, said + error                       # a student has no points yet
    page = (tmp_path / "out" / "index.html").read_text()
    for word in ("ada.zip", "bob.tar.gz", "notes.txt"):
        assert word in said, word
        assert word in page, word
    with open(tmp_path / "out" / "grades.csv", newline="", encoding="utf-8") as file:
        rows = {row["student_id"]: row for row in csv.DictReader(file)}
    assert [*rows] == sorted(["ada", "bob", "cem", NFC])
    assert rows["ada"]["score"] == "" and "ada.zip" in rows["ada"]["problems"]  # no points, and no zero
    assert rows["bob"]["score"] == "0" and "bob.tar.gz" in rows["bob"]["problems"]
    assert (
        rows["cem"]["score"] == "0"
        and rows["cem"]["problems"] == rows[NFC]["problems"] == "" != rows["cem"]["timestamp"]
    )


# ---------------------------------------------------------------------- how files are called, and where they lie

WAYS = ("Integrators.py", "INTEGRATORS.PY", "integrators (1).py", "integrators(2).py", "integrators-1.py")


def hand_in(top, files, as_zip):
    """{name: bytes} as ada's folder or zip; her submission."""
    if as_zip:
        with zipfile.ZipFile(top / "ada.zip", "w") as archive:
            for name, text in files.items():
                archive.writestr(name, text)
    else:
        for name, text in files.items():
            (top / "ada" / name).parent.mkdir(parents=True, exist_ok=True)
            (top / "ada" / name).write_bytes(text)
    intake = submissions.read_all(top, ("integrators",))
    return by_student(intake).get("ada") or intake.unclear["ada"]


@pytest.mark.parametrize("as_zip", [False, True])
@pytest.mark.parametrize("name", WAYS)
def test_a_name_that_a_browser_or_another_system_gives_is_taken_and_said(tmp_path, name, as_zip):
    ada = hand_in(tmp_path, {f"lessons/{name}": TEXT}, as_zip)
    assert ada.files == {"integrators": TEXT} and ada.problems == (f"lessons/{name} was taken for integrators.py",)


@pytest.mark.parametrize("name", WAYS)
def test_the_lessons_own_name_counts_before_a_copys(tmp_path, name):
    ada = hand_in(tmp_path, {"integrators.py": TEXT, name: b"y = 2\n"}, True)
    assert ada.files == {"integrators": TEXT} and ada.problems == (f"{name} was not read: integrators.py counts",)


def test_of_two_copies_neither_is_taken_and_the_remedy_is_said(tmp_path):
    ada = hand_in(tmp_path, {"integrators (1).py": TEXT, "integrators (2).py": b"y = 2\n"}, True)
    assert not ada.files and len(ada.problems) == 1
    assert "neither was read: keep one, and call it integrators.py" in ada.problems[0]


@pytest.mark.parametrize("as_zip", [False, True])
@pytest.mark.parametrize(("name", "told"), [
    ("integrators.py.txt", "integrators.py.txt was not read: if it is meant, call it integrators.py"),
    ("integrators.ipynb", "integrators.ipynb is a notebook, and was not read: the answers belong into lessons/integ"),
    ("integrators.py", "integrators.py is empty, so it is not graded"),
])
def test_a_file_that_cannot_count_gets_one_sentence_with_what_to_do(tmp_path, name, told, as_zip):
    ada = hand_in(tmp_path, {name: b"\xef\xbb\xbf# to do\n\n"}, as_zip)
    assert not ada.files and len(ada.problems) == 1 and told in ada.problems[0]


@pytest.mark.parametrize("ending", [".py.txt", ".ipynb"])
def test_a_bare_file_that_cannot_count_is_its_students_and_says_what_to_do(tmp_path, ending):
    (tmp_path / f"ada_integrators{ending}").write_bytes(TEXT)
    (ada,) = submissions.read_all(tmp_path, LESSONS).submissions
    assert ada.student == "ada" and not ada.files and "integrators.py" in ada.problems[0]


@pytest.mark.parametrize("as_zip", [False, True])
@pytest.mark.parametrize("place", [".venv/lib", "venv/lib", "node_modules", "lib/site-packages", ".git/objects"])
def test_an_environment_is_not_counted_and_nothing_in_it_is_read(tmp_path, place, as_zip, monkeypatch):
    if not as_zip:                                   # a zip is read by another process, with the limit that it knows
        monkeypatch.setattr(submissions, "MOST_ENTRIES", 50)
    files = {f"{place}/{n}": b"" for n in range(submissions.MOST_ENTRIES + 1)}
    ada = hand_in(tmp_path, {**files, f"{place}/springs.py": TEXT, "a/b/integrators.py": TEXT}, as_zip)
    assert ada.files == {"integrators": TEXT} and ada.problems == ()


@pytest.mark.parametrize("as_zip", [False, True])
@pytest.mark.parametrize(("empty", "full"), [("old", "workbook"), ("workbook", "x")])
def test_of_two_copies_in_two_folders_the_one_with_the_most_answers_counts(tmp_path, empty, full, as_zip):
    done = STUB.replace(b'raise NotImplementedError("Exercise 1.1: euler_step")', b"return x, v")
    ada = hand_in(tmp_path, {f"{empty}/lessons/integrators.py": STUB, f"{full}/lessons/integrators.py": done}, as_zip)
    assert ada.files == {"integrators": done}
    taken = f"{full}/lessons/integrators.py was taken, which has the most answers"
    assert ada.problems == (f"integrators.py is there more than once; {taken}",)


@pytest.mark.parametrize("as_zip", [False, True])
def test_two_copies_that_are_equal_are_one(tmp_path, as_zip):
    ada = hand_in(tmp_path, {"a/integrators.py": TEXT, "b/integrators.py": TEXT}, as_zip)
    assert ada.files == {"integrators": TEXT} and not ada.problems


@pytest.mark.parametrize("as_zip", [False, True])
def test_too_many_files_are_no_grade_and_no_zero(tmp_path, as_zip):
    files = {f"data/{n}": b"" for n in range(submissions.MOST_ENTRIES + 1)}
    assert "more than 5000 files" in hand_in(tmp_path, {**files, "integrators.py": TEXT}, as_zip)


@pytest.mark.parametrize("name", ["_", " ", "a_", "integrators", "integrators_", "(1)", "-1"])
def test_names_of_the_greatest_length_take_no_time(tmp_path, name):
    long = name * (60_000 // len(name))
    files = {f"{long}{n}{ending}": b"" for n in range(20) for ending in ("", ".py", ".ipynb", "x.txt")}
    assert hand_in(tmp_path, {**files, "integrators.py": TEXT}, True).files == {"integrators": TEXT}


# ---------------------------------------------------------------------- answers in a notebook

def notebook(source, printed=""):
    outputs = [{"output_type": "stream", "name": "stdout", "text": printed.splitlines(keepends=True)}]
    cells = [{"cell_type": "code", "source": source.splitlines(keepends=True), "outputs": outputs},
             {"cell_type": "markdown", "source": "def rk4_step(x):"}]
    return json.dumps({"cells": cells}).encode()


STUB = (modules.ROOT / "lessons" / "integrators.py").read_bytes()
ANSWERS = "import numpy as np\n\ndef euler_step(acceleration, t, x, v, dt, p):\n    return x, v\n"


@pytest.mark.parametrize("as_zip", [False, True])
@pytest.mark.parametrize("file", [{}, {"lessons/integrators.py": STUB}])
def test_who_answers_in_the_notebook_is_told_where_answers_belong(tmp_path, file, as_zip):
    ada = hand_in(tmp_path, {"notebooks/01_integrators.ipynb": notebook(ANSWERS), **file}, as_zip)
    remedy = "move them into lessons/integrators.py (euler_step)"
    assert ada.problems == (f"answers in the cells of notebooks/01_integrators.ipynb are not graded: {remedy}",)


@pytest.mark.parametrize("text", [notebook("x = 1", ANSWERS), b"{", b"[" * 100_000, notebook("def other():\n    pass")],
                         ids=["printed", "broken", "deep", "others"])
def test_a_notebook_without_answers_is_not_spoken_of(tmp_path, text):
    ada = hand_in(tmp_path, {"notebooks/01_integrators.ipynb": text, "integrators.py": STUB}, True)
    assert ada.problems == () and ada.files


def test_answers_that_are_in_the_lesson_file_too_are_not_spoken_of(tmp_path):
    done = STUB.replace(b'raise NotImplementedError("Exercise 1.1: euler_step")', b"return x, v")
    ada = hand_in(tmp_path, {"01_integrators.ipynb": notebook(ANSWERS), "integrators.py": done}, True)
    assert ada.problems == ()


@pytest.mark.parametrize("make", [os.mkfifo, lambda path: path.symlink_to("/dev/zero")])
def test_a_notebook_that_is_no_file_is_not_opened(tmp_path, make):
    folder(tmp_path / "ada")
    make(tmp_path / "ada" / "01_integrators.ipynb")
    with pytest.raises(OSError, match=r"regular file|symbolic link"):   # at once: no process writes into the pipe
        submissions.regular(tmp_path / "ada" / "01_integrators.ipynb")
    (ada,) = submissions.read_all(tmp_path, ("integrators",)).submissions
    assert ada.files == {"integrators": TEXT} and ada.problems == ()


# ---------------------------------------------------------------------- the class list

@pytest.mark.parametrize("code", ["utf-8", "utf-8-sig", "utf-16", "cp1252", "latin-1"])
def test_a_class_list_is_read_in_the_codes_that_spreadsheets_write(tmp_path, code):
    said, text = [], "Student_ID;Last_Name\r\nada;Müller\r\n"
    (tmp_path / "list.csv").write_bytes(text.encode(code))
    people = classlist.roster(tmp_path / "list.csv", said.append)
    assert people["ada"].last_name == "Müller"
    assert [("Windows-1252" in one and "Müller" in one and "CSV UTF-8" in one) for one in said] == (
        [True] if code in ("cp1252", "latin-1") else [])


@pytest.mark.parametrize("content", [b"PK\3\4\x14\0rest", b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1rest", b"\xff\xfea",
                                     "student_id\nada\n".encode("utf-16-le"), b"student_id\n\x81\n"])
def test_what_is_no_csv_is_told_how_to_be_saved(tmp_path, content):
    (tmp_path / "list.csv").write_bytes(content)
    with pytest.raises(BadInput, match="save it as “CSV UTF-8”"):
        classlist.roster(tmp_path / "list.csv")


def test_a_due_date_without_a_time_ends_with_its_day(tmp_path):
    (tmp_path / "list.csv").write_text("student_id,due\nada,2026-12-07\nbob,2026-12-07T00:00\ncem,\n")
    people = classlist.roster(tmp_path / "list.csv")
    assert [p.due for p in people.values()] == ["2026-12-07T23:59:59", "2026-12-07T00:00:00", ""]
    (tmp_path / "list.csv").write_text("student_id,due\nada,soon\n")
    with pytest.raises(BadInput, match=r"due of ada .* is not a date \('soon'\)"):
        classlist.roster(tmp_path / "list.csv")


def test_columns_and_lines_of_a_class_list_that_are_not_read_are_told(tmp_path):
    (tmp_path / "class.csv").write_text("student_id,Last_Name,nickname\nada,Byron,x\n,Hooke,y\n,,\n")
    told = []
    people = classlist.roster(tmp_path / "class.csv", told.append)
    assert [*people] == ["ada"] and people["ada"].last_name == "Byron"
    assert len(told) == 2 and "not read: nickname." in told[0] and "without a student_id were not read (1)" in told[1]
