"""Names of files as students, Moodle, Canvas and Gradescope write them belong to the students whose they are.

The names are put together here as these systems put them together; `owners.py` names the sources.
"""

import re
import unicodedata

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from validate.grading import classlist, owners, submissions

LESSONS = ("integrators", "springs")
TEXT, OTHER = b"x = 1\n", b"x = 2\n"
CLASS = (("ada", "Lovelace", "Ada"), ("bob", "Hooke", "Bob"), ("cem", "Yılmaz", "Cem Can"), ("dia", "O'Brien", "Zoë"),
         ("eve", "de la Cruz", "Eve-Marie"))
PEOPLE = {s: classlist.Person(s, last, first, f"{s}@example.org", canvas_id=str(100 + n))
          for n, (s, last, first) in enumerate(CLASS)}
BARE = {s: person._replace(email="", canvas_id="") for s, person in PEOPLE.items()}


def moodle(person, number):
    """downloader.php: the full name without underscores, the number, the plugin; clean_filename drops some characters.
    """
    name = f"{person.first_name} {person.last_name}".replace("_", " ")
    return re.sub(r"[&<>\"`|':\\/]", "", f"{name}_{number}_assignsubmission_file")


def canvas(person, number, file, late=False):
    """content_zipper.rb: the sortable name in small letters, LATE, the ID; then the number and the name of the file."""
    name = f"{person.last_name}, {person.first_name}".lower()
    student = re.sub(r"[^\w]", "", "_".join([name, *["LATE"] * late, person.canvas_id or "55"]))
    return f"{student}_{number}_{file}"


def gradescope(folder, handed_in):
    """An export: {number: (students, their own files, when)}."""
    lines = []
    for number, (students, files, when) in handed_in.items():
        (folder / f"submission_{number}").mkdir(parents=True)
        for name, text in files.items():
            (folder / f"submission_{number}" / name).write_bytes(text)
        lines += [f"submission_{number}:", "  :submitters:"]
        for p in (PEOPLE[s] for s in students):
            lines += [f"  - :name: {p.first_name} {p.last_name}", f"    :sid: '{p.sis_id}'", f"    :email: {p.email}"]
        lines += [f"  :created_at: {when}", "  :score: 2.0", "  :results:", "    score: 2.0", "    output: |-",
                  "      submission_2:", "        :submitters:", "      - :email: bob@example.org", ""]
    (folder / "submission_metadata.yml").write_text("\n".join(lines), encoding="utf-8")


def put(path, text=TEXT):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(text)


def intake(folder, people=PEOPLE, lessons=LESSONS):
    found = submissions.read_all(folder, lessons, people)
    return found, {one.student: one for one in found.submissions}


# ---------------------------------------------------------------------------------------------- the systems

@pytest.mark.parametrize("people", [PEOPLE, BARE])
@pytest.mark.parametrize("form", ["/", "_/", "_"])
def test_what_moodle_calls_a_submission_is_its_students(tmp_path, people, form):
    """Folders, as older versions end them, and files without folders."""
    for n, person in enumerate(people.values()):
        put(tmp_path / f"{moodle(person, 9000 + n)}{form}integrators.py", TEXT + b"# %d\n" % n)
        put(tmp_path / f"{moodle(person, 9000 + n).removesuffix('file')}onlinetext{form}onlinetext.html")
    found, mine = intake(tmp_path, people)
    assert [*mine] == [*people] and not found.unclear
    assert [one.files for one in mine.values()] == [{"integrators": TEXT + b"# %d\n" % n} for n in range(len(people))]


@pytest.mark.parametrize("people", [PEOPLE, BARE])
@pytest.mark.parametrize("late", [False, True])
def test_what_canvas_calls_a_file_is_its_students(tmp_path, people, late):
    for n, person in enumerate(people.values()):
        put(tmp_path / canvas(person, 9000 + n, "integrators-1.py", late), TEXT + b"# %d\n" % n)
        put(tmp_path / canvas(person, 9100 + n, "springs.py", late), TEXT)
        put(tmp_path / canvas(person, 9200 + n, "ada_7_8_integrators.ipynb", late))      # the student's own name
    found, mine = intake(tmp_path, people)
    assert [*mine] == [*people] and not found.unclear
    for n, one in enumerate(mine.values()):
        assert one.files == {"integrators": TEXT + b"# %d\n" % n, "springs": TEXT} and "notebook" in one.problems[0]


def test_what_gradescope_exports_is_its_students_with_its_date(tmp_path):
    gradescope(tmp_path, {
        1: (("ada",), {"integrators.py": TEXT}, "2026-04-26 17:34:00.861687000 Z"),
        2: (("cem", "dia"), {"springs.py": TEXT}, "2026-04-27 09:00:00.000000000 -07:00"),
    })
    found, mine = intake(tmp_path)
    assert [*mine] == ["ada", "cem"] and found.sharing == {"cem": ("cem", "dia")}
    assert len(found.overlooked) == 1 and "Gradescope's record" in found.overlooked[0]
    assert [one.timestamp for one in mine.values()] == ["2026-04-26T17:34:00+00:00", "2026-04-27T09:00:00-07:00"]
    assert not found.dated_by_files


def test_anonymous_files_and_those_of_no_student_on_the_list_are_kept_apart(tmp_path):
    names = ("anon_x7Yq2_67890_integrators.py", "anon_Ab3dE_67891_integrators.py", "hookebob_12345_67890_springs.py",
             "Zed Zed_17_assignsubmission_file/integrators.py", "Zed Zed_18_assignsubmission_file/integrators.py")
    for n, name in enumerate(names):
        put(tmp_path / name, TEXT + b"# %d\n" % n)
    assert [*intake(tmp_path, {})[1]] == ["Zed Zed_17", "Zed Zed_18", "anon_Ab3dE", "anon_x7Yq2", "hookebob_12345"]


@pytest.mark.parametrize("name", ["ada@example.org", "ADA@Example.org", "Ada Lovelace", "lovelace_ada", "ADA", "103"])
def test_a_folder_may_have_any_name_that_the_class_list_has_for_one_student(tmp_path, name):
    put(tmp_path / name / "integrators.py")
    assert [*intake(tmp_path)[1]] == ["dia" if name == "103" else "ada"]


@settings(max_examples=300, deadline=None)
@given(st.sampled_from([*PEOPLE]), st.text(st.characters(blacklist_categories=("Cs",)), max_size=30), st.booleans())
def test_what_a_student_calls_a_file_does_not_make_it_another_students(student, own, late):
    person, known = PEOPLE[student], owners.People(PEOPLE)
    for stem in (canvas(person, 77, own, late), f"{moodle(person, 77)}_{own}"):
        if own:
            found = known.owners(owners.name_of(unicodedata.normalize("NFC", stem), True, {}))
            assert found.students == (student,), stem


# ---------------------------------------------------------------------------------------------- one name, two students

def test_namesakes_have_neither_points_nor_a_zero_until_the_instructor_decides(tmp_path):
    people = {s: classlist.Person(s, "Lovelace", "Ada") for s in ("ada1", "ada2")}
    put(tmp_path / moodle(people["ada1"], 5) / "integrators.py")
    found, mine = intake(tmp_path, people)
    assert [*mine] == ["Ada Lovelace_5"] and {*found.unclear} == {*people}
    assert "may be of this student, or of ada2: rename it" in found.unclear["ada1"]
    put(tmp_path / "ada1" / "integrators.py")
    assert {*intake(tmp_path, people)[0].unclear} == {"ada2"}


@pytest.mark.parametrize("name", ["ada ", "ADA", "ada\xa0", "Ada Lovelace", "ada_integrators.py", "ada@example.org",
                                  "ada .zip", "Ada Lovelace_1_assignsubmission_file"])
def test_what_one_student_names_does_not_block_another_on_the_class_list(tmp_path, name):
    put(tmp_path / "ada" / "integrators.py")
    put(tmp_path / name if name.endswith(".py") else tmp_path / name / "integrators.py", OTHER)
    found, mine = intake(tmp_path)
    assert not found.unclear and mine["ada"].files == {"integrators": TEXT}
    assert "was not graded: ada counts" in mine["ada"].problems[0]
    found, mine = intake(tmp_path, {"bob": PEOPLE["bob"]})            # of people on no list nothing is known
    assert name in ("ADA", "Ada Lovelace", "ada@example.org", moodle(PEOPLE["ada"], 1)) or [*found.unclear] == ["ada"]


@pytest.mark.parametrize("second", ["ada ", "ada.zip", "ada_integrators.py"])
@pytest.mark.parametrize("people", [{}, PEOPLE])
def test_one_persons_two_deliveries_of_the_same_bytes_are_graded(tmp_path, people, second):
    put(tmp_path / "ada" / "integrators.py")
    put(tmp_path / second if second.endswith(".py") else tmp_path / second / "integrators.py")
    found, mine = intake(tmp_path, people)
    assert not found.unclear and mine["ada"].files == {"integrators": TEXT} and mine["ada"].problems == ()


@pytest.mark.parametrize("second", ["ada ", "ada.zip", "ada_integrators.py"])
def test_one_persons_two_deliveries_that_differ_are_named_and_not_graded(tmp_path, second):
    put(tmp_path / "ada" / "integrators.py")
    put(tmp_path / second if second.endswith(".py") else tmp_path / second / "integrators.py", OTHER)
    found, mine = intake(tmp_path, {})
    assert not mine and f"as ada, {second}: keep one" in found.unclear["ada"]


# ---------------------------------------------------------------------------------------------- groups

TEAM = {s: person._replace(group="red" if s != "eve" else "") for s, person in PEOPLE.items()}


def test_one_delivery_of_a_group_is_that_of_all_its_members(tmp_path):
    put(tmp_path / "bob" / "integrators.py")
    put(tmp_path / "dia" / "springs.py")                               # they have shared the lessons among them
    put(tmp_path / "eve" / "springs.py", OTHER)
    found, mine = intake(tmp_path, TEAM)
    assert found.sharing == {"ada": ("ada", "bob", "cem", "dia")} and not found.unclear
    assert mine["ada"].files == {"integrators": TEXT, "springs": TEXT} and mine["eve"].files == {"springs": OTHER}


def test_two_deliveries_of_a_group_that_differ_are_named_and_no_student_in_it_is_graded(tmp_path):
    put(tmp_path / "bob" / "integrators.py")
    put(tmp_path / "dia" / "integrators.py", OTHER)
    put(tmp_path / "eve" / "springs.py")
    found, mine = intake(tmp_path, TEAM)
    assert [*mine] == ["eve"] and {*found.unclear} == {"ada", "bob", "cem", "dia"}
    assert "bob, dia: keep one" in found.unclear["cem"]


@pytest.mark.parametrize("name", ["red_17_assignsubmission_file/integrators.py", "red_44_55_integrators.py"])
def test_moodle_and_canvas_call_a_groups_delivery_by_the_name_of_the_group(tmp_path, name):
    put(tmp_path / name)
    assert [*intake(tmp_path, TEAM)[0].sharing.values()] == [("ada", "bob", "cem", "dia")]
