"""The pages of a class are complete, deterministic and harmless for any text of a student.

They are never called a grade when they are none.
"""

import csv
import errno
import io
import json
import re
from html.parser import HTMLParser
from pathlib import Path

import pytest
from rich.console import Console

from solutions.checks import BadInput
from validate.grading import classlist, marking, pages, points

LESSONS = ("falling", "bouncing")
MANIFEST = (("falling", "1.1", "fall", "test_it_falls[plain]", 2, "down, not up"),
            ("falling", "1.2", "land", "test_it_lands", 3, "at the floor"),
            ("falling", "1.10", "rest", "test_it_rests", 1, "no speed"),
            ("bouncing", "2.1", "bounce", "test_it_bounces", 4, "e, not 1"))
SETTINGS = marking.Settings(LESSONS, "secret", MANIFEST, "code")
IN_TIME, DUE = "2026-11-30T23:59:00", "2026-11-30T23:59:00"
FREE = pages.Terms("", 0.0)
EVIL = "<script>alert(1)</script>\"'&{{ 7 * 7 }}\x1b[31m\x00\u202e\ud800"


def found(exercise, status, says=None, kind="visible", hint=""):
    """A change to one test of a result."""
    change = {"status": status, "earned": 0, "kind": kind, "says": says or {}}
    if hint:
        change["hint"] = hint
    return exercise, change


def result(
    student, *changes, handed_in=LESSONS, printed=None, problems=(), timestamp=IN_TIME, watched=None
):
    """A result as marking.mark returns it: every test has passed, except for the changes."""
    changed, tests = dict(changes), []
    for row in MANIFEST:
        lesson, exercise = row[:2]
        if lesson in handed_in:
            tests.append({**passed(*row), **changed.get(exercise, {})})
        else:
            tests.append(marking.verdict(row, {}, False))
    return {
        "student": student,
        "problems": list(problems),
        "timestamp": timestamp,
        "handed_in": sorted(handed_in),
        "tests": tests,
        "printed": printed or {},
        "seconds": 1.5,
        "watched": watched or {},
        "again": [],
        "digest": "",
    }


def passed(lesson, exercise, function, test, worth, hint):
    """The verdict on a test of the manifest that has passed."""
    return {
        "lesson": lesson,
        "exercise": exercise,
        "function": function,
        "test": test,
        "points": worth,
        "hint": hint,
        "tells": False,
        "status": "passed",
        "earned": worth,
        "kind": "",
        "says": {},
    }


def rows_of(out):
    return list(csv.DictReader(io.StringIO((out / "grades.csv").read_bytes().decode(), newline="")))


class Seen(HTMLParser):
    """The tags of a page, its links, and its text without the style sheet."""

    def __init__(self, path):
        super().__init__()
        self.tags, self.links, self.text, self.attributes = [], [], "", set()
        self.feed(path.read_bytes().decode())

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.attributes |= {name for name, _ in attributes}
        self.links += [value for name, value in attributes if name in ("href", "src")]

    def handle_data(self, data):
        if self.tags[-1:] != ["style"]:
            self.text += data


def write(out, results, failed=None, people=None, terms=FREE):
    front = pages.write(out, results, failed or {}, SETTINGS, people or {}, terms)
    assert front == out / "index.html" and not list(out.rglob("*.part"))
    return Seen(front)


# ---------------------------------------------------------------------------------------------- points

@pytest.mark.parametrize(("handed_in", "days"), [
    ("2026-11-30T23:59:00", 0),
    ("2026-11-01T00:00:00", 0),
    ("2026-11-30T23:59:01", 1),
    ("2026-12-01T23:59:00", 1),
    ("2026-12-01T23:59:01", 2),
    ("yesterday", None),
    ("", None),
])
def test_every_day_begun_counts(handed_in, days):
    assert pages.days_late(handed_in, DUE) == days
    assert pages.days_late(handed_in, "") == 0


def test_a_time_zone_on_one_side_only_is_no_error():
    assert pages.days_late("2026-12-24T12:00:00+00:00", DUE) in (24, 25)
    assert pages.days_late(IN_TIME, "2030-01-01T00:00:00+01:00") == 0


def test_the_penalty_is_a_part_of_the_maximum_and_no_more_than_was_earned(tmp_path):
    late = result("late", found("2.1", "not attempted"), found("1.2", "not attempted"), timestamp="2026-12-02T12:00:00")
    write(tmp_path, [late], terms=pages.Terms(DUE, 10.0))
    scores = [(r["raw_score"], r["late_submission_penalty"], r["score"], r["max_score"]) for r in rows_of(tmp_path)]
    assert scores == [("3", "1.2", "1.8", "6"), ("0", "0", "0", "4")]                        # two days: 2 × 10 % of 6
    write(tmp_path, [late], terms=pages.Terms(DUE, 100.0))
    assert [(r["late_submission_penalty"], r["score"]) for r in rows_of(tmp_path)] == [("3", "0"), ("0", "0")]
    assert "2 days late" in Seen(tmp_path / "students" / "late.html").text


def test_a_time_in_the_class_list_overrides_that_of_the_files(tmp_path):
    person = classlist.Person("ada", "Byron", "Ada", "ada@example.org", "2026-12-01T00:00:00")
    terms = pages.Terms(DUE, 10.0)
    seen = write(tmp_path, [result("ada")], people={"ada": person}, terms=terms)
    row = rows_of(tmp_path)[0]
    assert (row["timestamp"], row["score"]) == ("2026-12-01T00:00:00", "5.4")
    assert (row["last_name"], row["email"]) == ("Byron", "ada@example.org")
    assert json.loads((tmp_path / "gradescope" / "ada.json").read_text())["score"] == 9.0 and "1 day" in seen.text
    seen = write(tmp_path, [result("ada")], people={"ada": person._replace(timestamp="noonish")}, terms=terms)
    assert rows_of(tmp_path)[0]["score"] == "6" and "noonish" in seen.text


# ---------------------------------------------------------------------------------------------- CSV

def test_the_csv_has_the_columns_of_nbgrader_and_a_row_for_every_student_and_lesson(tmp_path):
    people = {n: classlist.Person(n) for n in ("zoe", "kim")}
    graded = [result("zoe"), result("ada", handed_in=("falling",))]
    seen = write(tmp_path, graded, {"max": "RuntimeError: no sandbox"}, people)
    text = (tmp_path / "grades.csv").read_bytes().decode()
    assert text.splitlines()[0] == ("assignment,duedate,timestamp,student_id,last_name,first_name,email,"
                                    "raw_score,late_submission_penalty,score,max_score,"
                                    "problems,raw_score_of_tests,by_hand")
    rows = rows_of(tmp_path)
    all_of_them = [(n, lesson) for n in ("ada", "kim", "max", "zoe") for lesson in LESSONS]
    assert [(r["student_id"], r["assignment"]) for r in rows] == all_of_them
    assert [r["score"] for r in rows] == ["6", "0", "0", "0", "", "", "6", "4"]    # a failure of the grader is no zero
    assert [r["max_score"] for r in rows] == ["6", "4"] * 4
    assert rows[0]["timestamp"] and rows[1]["timestamp"] == ""
    assert "kim" in seen.text and "not on the class list" in seen.text


def test_the_same_class_gives_the_same_bytes_in_any_order(tmp_path):
    some = [result(n, found("1.2", "not yet", {"quantity": "height [m]", "got": "3"})) for n in ("b", "A", "c d")]
    write(tmp_path / "1", some, terms=pages.Terms(DUE, 100.0 / 3.0))
    write(tmp_path / "2", some[::-1], terms=pages.Terms(DUE, 100.0 / 3.0))
    first, second = ({p.relative_to(tmp_path / n): p.read_bytes() for p in (tmp_path / n).rglob("*.*")} for n in "12")
    assert first == second and len(first) == 8


@pytest.mark.parametrize("text", ["=1+1", "+1", "-1", "@SUM(A1)", "\t=1", "\r=1", "\n=1", " =1", "＝1"])
def test_no_cell_is_a_formula(tmp_path, text):
    person = classlist.Person(text, text, text, text, text)
    write(tmp_path, [result(text, timestamp=text)], people={text: person})
    row = rows_of(tmp_path)[0]
    for name in ("student_id", "last_name", "first_name", "email", "timestamp", "assignment"):
        assert row[name].lstrip()[0] not in "=+-@＝" and not set(row[name]) & set("\t\r\n"), name


SPLIT = ["a;=1+1", "a|=1+1", "a,=1+1", "a\t=1+1", "a; =1+1", "a;＝1+1", "a;＋1", "a;－1", "a;＠A1", "a;b;@A1",
         'a;"=1+1"', "=1;=2"]


@pytest.mark.parametrize("text", SPLIT)
@pytest.mark.parametrize("separator", [";", "|", ",", "\t"])
def test_no_cell_becomes_a_formula_where_a_spreadsheet_splits_it(tmp_path, text, separator):
    person = classlist.Person("ada", text, text, text)
    write(tmp_path, [result("ada", problems=[text, text])], people={"ada": person})
    row = rows_of(tmp_path)[0]
    for name in ("last_name", "first_name", "email", "problems"):
        parts = [part.lstrip(' "') for part in row[name].split(separator)]
        assert not [part for part in parts if part[:1] in tuple("=+-@＝＋－＠")], (name, row[name])


@pytest.mark.parametrize("text", ["Müller-Lüdenscheidt", "O'Neil, Ann-Marie", "ada+b@example.org", "a = b; c - d"])
def test_an_ordinary_cell_stays_as_it_is(text):
    assert pages.cell(text) == text


# ---------------------------------------------------------------------------------------------- Gradescope

def test_gradescope_gets_every_test_of_the_manifest_even_when_it_did_not_run():
    lacking = result("ada", found("1.1", "not yet", {"quantity": "height [m]", "got": "1.0e-3 off"}, "hidden"))
    lacking["tests"] = lacking["tests"][:2]
    for one in (lacking, result("bob", handed_in=()), result("eve")):
        got = pages.gradescope(one, SETTINGS, FREE)
        assert [(t["number"], t["max_score"]) for t in got["tests"]] == [(row[1], row[4]) for row in MANIFEST]
        assert got["score"] == sum(t["score"] for t in got["tests"]) and "execution_time" not in got
        for test in got["tests"]:
            assert test["status"] == ("passed" if test["score"] else "failed") and test["visibility"] == "visible"
    first, second, third, _ = pages.gradescope(lacking, SETTINGS, FREE)["tests"]
    assert first["name"] == "fall: It falls (plain)" and first["tags"] == ["falling"]
    assert first["output"] == "with other inputs\nquantity: height [m]\ngot: 1.0e-3 off\nhint: down, not up"
    assert second["output"] == "" and "not run" in third["output"]


def test_gradescope_does_not_print_a_hint_that_tells_the_formula():
    change = found("1.1", "not yet", {"quantity": "height [m]"})
    asked = result("ada", (change[0], {**change[1], "tells": True}))
    assert "hint" in pages.gradescope(result("ada", change), SETTINGS, FREE)["tests"][0]["output"]
    assert "hint" not in pages.gradescope(asked, SETTINGS, FREE)["tests"][0]["output"]


def test_gradescopes_score_is_after_the_late_penalty():
    got = pages.gradescope(result("ada", timestamp="2026-12-01T12:00:00"), SETTINGS, pages.Terms(DUE, 5.0))
    assert got["score"] == 9.5 and "1 day late" in got["output"]


# ---------------------------------------------------------------------------------------------- pages

def test_a_students_page_shows_the_reported_fields_and_nothing_else(tmp_path):
    reported = {
        "quantity": "height [m]",
        "given": "dropped from 3 m",
        "expected": "(3, 2)",
        "got": "(3, 4)",
        "tolerance": "1.0e-12",
    }
    ada = result(
        "ada",
        found("1.1", "not yet", reported),
        found("1.2", "not yet", {"quantity": "speed [m/s]", "got": "2.0e-1 off"}, "hidden"),
        found("1.10", "not attempted"),
        printed={"falling": "here I am"},
        handed_in=("falling",),
        problems=["bouncing.py is a link"],
    )
    write(tmp_path, [ada, result("bob")])
    page = Seen(tmp_path / "students" / "ada.html")
    answers = "It falls (plain)", "down, not up", "2.0e-1 off", "at the floor", "here I am", "bouncing.py is a link"
    words = "not attempted", "No file of this lesson could be read", "With other inputs", "With the public inputs"
    for text in (*reported.values(), *answers, *words):
        assert text in page.text, text
    for text in ("bob", "secret", "no speed"):
        assert text not in page.text, text
    assert page.links == []
    assert "img" not in page.tags and "link" not in page.tags


def test_a_file_that_does_not_load_says_so_once(tmp_path):
    error = "SyntaxError: invalid (falling.py, line 1)"
    lost = {"quantity": points.READING, "expected": "a module that loads", "got": error}
    tests = [found(exercise, "not yet", lost, hint="mend this first") for exercise in ("1.1", "1.2", "1.10")]
    seen = write(tmp_path, [result("ada", *tests), result("bob", *tests)])
    page = Seen(tmp_path / "students" / "ada.html").text
    assert page.count("SyntaxError") == 1 and page.count("mend this first") == 1 and "down, not up" not in page
    assert "the whole file" in seen.text and seen.text.count("reading the file: SyntaxError") == 1


def test_a_failure_below_is_named_on_the_page_and_for_gradescope(tmp_path):
    """In lesson 2, spring_network_acceleration calls air_force."""
    rows = (("springs", "2.2", "air_force", "test_air", 1, "the wind force"),
            ("springs", "2.8", "spring_network_acceleration", "test_mesh", 1, "divide by the mass"))
    lost = {"status": "not yet", "earned": 0, "kind": "visible", "says": {"quantity": "the call itself"}}
    one = {**result("ada", handed_in=()), "handed_in": ["springs"], "tests": [{**passed(*row), **lost} for row in rows]}
    settings = marking.Settings(("springs",), "secret", rows, "code")
    pages.write(tmp_path, [one], {}, settings, {}, FREE)
    sentence = "2.8 calls air_force (2.2), which does not pass yet: mend that first"
    assert Seen(tmp_path / "students" / "ada.html").text.count("mend that first") == 1
    first, second = pages.gradescope(one, settings, FREE)["tests"]
    assert sentence in second["output"] and "mend" not in first["output"]


def test_an_error_of_a_call_is_recognised_by_its_kind():
    def call(a):
        raise ValueError("no such ball")
    with pytest.raises(ValueError, match="no such ball") as error:
        call(1)
    mark = pytest.mark.exercise("1.1", points=1, hint="h").mark
    o = points.outcome(mark, "test_it", error)
    test = {"status": o.status, "kind": "visible", "says": marking.says(o, "visible")}
    assert o.quantity == pages.CALL and pages.cause(test) == "the call itself: ValueError"
    assert marking.says(o, "hidden") == {"quantity": pages.CALL, "got": marking.NO_ANSWER}


def test_failures_are_grouped_by_cause_and_the_hardest_exercise_comes_first():
    height = {"quantity": "height [m]", "got": "1"}
    some = [
        result("a", found("1.1", "not yet", height)),
        result("b", found("1.1", "not yet", {**height, "got": "2"}, "hidden")),
        result("c", found("1.1", "not attempted"), found("1.2", "not attempted"), handed_in=("falling",)),
        result("d", found("1.2", "not yet", height)),
    ]
    sheets = [pages.sheet(r, SETTINGS, FREE) for r in some]
    groups = [(g["exercise"], g["cause"], [s.student for s in g["students"]], g["other"]) for g in pages.causes(sheets)]
    # exercises that were not attempted have no cause; `hardest` counts them
    assert groups == [("1.1", "height [m]", ["a", "b"], 1), ("1.2", "height [m]", ["d"], 0)]
    rows = [(r["exercise"], r["share"], r["solved"], r["of"], r["left"]) for r in pages.hardest(sheets, SETTINGS)]
    assert rows == [("1.1", 0.25, 1, 4, 1), ("1.2", 0.5, 2, 4, 1), ("1.10", 1.0, 4, 4, 0), ("2.1", 1.0, 3, 3, 0)]


def test_exercises_not_attempted_do_not_crowd_out_the_failures(tmp_path):
    untouched = [found(row[1], "not attempted") for row in MANIFEST]
    wrong = result("ada", found("1.2", "not yet", {"quantity": "height [m]"}))
    lost = result("bob", found("1.1", "not run", {"got": "it was not run"}))
    seen = write(tmp_path, [*(result(f"s{n}", *untouched) for n in range(40)), wrong, lost])
    part = seen.text[seen.text.index("What went wrong"):seen.text.index("To look into")]
    assert "height [m]" in part and "not run" in part and "s1" not in part
    assert "not attempted" not in part.partition("counts it.")[2]


# ---------------------------------------------------------------------------------------------- for the instructor

LOOK_INTO = (
    "falling: the program ended by itself",
    "falling: it imports os",
    "falling: it tried to start another process",
    "falling: the same as max",
    "87%",
    "1 test right with the public inputs only",
)
OF_THE_RUN = "notes.txt", "2027-01-15 08:00:00", "workbook 12ab", "0123fe", "1.5 s (median)"


def test_observations_to_look_into_are_on_the_class_page_and_nowhere_else(tmp_path):
    some = [
        result("eve", watched={"falling": ["end", "import os", "process"], "bouncing": []}),
        result("max", found("1.1", "not yet", {"quantity": "height [m]"}, "hidden"), watched={"falling": ["process"]}),
        result("ada"),
    ]
    run = pages.Run(
        overlooked=("notes.txt is no submission, and was not read",),
        alike={"ada": [("falling", "max", 1.0)], "max": [("falling", "ada", 1.0), ("bouncing", "eve", 0.87)]},
        when="2027-01-15T08:00:00",
        versions="workbook 12ab",
        seed="0123fe",
    )
    pages.write(tmp_path, some, {}, SETTINGS, {}, FREE, run)
    page = Seen(tmp_path / "index.html").text
    for text in (*LOOK_INTO, *OF_THE_RUN):
        assert text in page, text
    part = page[page.index("To look into"):page.index("Students", page.index("To look into"))]
    assert re.search(r"it tried to start another process\s*2\s*eve,\s*max", part) and "ended by itself" in part
    others = *(tmp_path / "students").iterdir(), *(tmp_path / "gradescope").iterdir()
    for other in (tmp_path / "grades.csv", *others):
        text = other.read_text()
        for absent in ("ended by itself", "process", "the same as", "0123fe", "12ab", "2027-01-15"):
            assert absent not in text, (other, absent)


def test_what_could_not_be_read_stands_at_the_top_of_the_class_page(tmp_path):
    some = [result("ada"), result("eve", handed_in=(), problems=["it cannot be read: BadZipFile"])]
    pages.write(tmp_path, some, {}, SETTINGS, {}, FREE)
    page = Seen(tmp_path / "index.html").text
    top = re.sub(r"\s+", " ", page[:page.index("handed in")])
    assert "1 submission with nothing to grade" in top and re.search("eve ?: it cannot be read: BadZipFile", top)
    pages.write(tmp_path, some[:1], {}, SETTINGS, {}, FREE)
    assert "nothing to grade" not in Seen(tmp_path / "index.html").text


def test_only_the_class_page_has_the_date_and_duration_of_the_run(tmp_path):
    slow = {**result("ada"), "seconds": 99.25}
    pages.write(tmp_path / "1", [result("ada")], {}, SETTINGS, {}, FREE, pages.Run(when="2027-01-15T08:00:00"))
    pages.write(tmp_path / "2", [slow], {}, SETTINGS, {}, FREE, pages.Run(when="2027-01-16T08:00:00"))
    for name in ("grades.csv", "students/ada.html"):
        assert (tmp_path / "1" / name).read_bytes() == (tmp_path / "2" / name).read_bytes()
    assert "99.2" in Seen(tmp_path / "2" / "index.html").text


def test_the_fingerprint_of_a_seed_tells_seeds_apart_and_not_the_seed():
    one, two = pages.fingerprint("a secret"), pages.fingerprint("a secret ")
    assert one != two and one == pages.fingerprint("a secret")
    assert re.fullmatch("[0-9a-f]{12}", one) and len(pages.fingerprint("\ud800")) == 12


@pytest.mark.parametrize(
    ("maximum", "width", "bars"),
    [(1, 1, 1), (20, 1, 20), (20.5, 2, 11), (40, 2, 20), (220, 20, 11), (5000, 500, 10)],
)
def test_the_histogram_counts_each_student_once(maximum, width, bars):
    scores = [0.0, 0.999 * width, maximum, maximum / 2.0]
    picture = pages.histogram(scores, maximum)
    assert picture["width"] == width and len(picture["bars"]) == bars and sum(b["count"] for b in picture["bars"]) == 4
    assert picture["bars"][0]["count"] >= 2 and picture["bars"][-1]["count"] >= 1 and len(picture["ticks"]) <= 11


def test_the_graders_failures_come_first_and_old_pages_of_theirs_go(tmp_path):
    write(tmp_path, [result("ada"), result("bob")])
    seen = write(tmp_path, [result("ada")], {"bob": "RuntimeError: no sandbox"})
    assert seen.text.index("RuntimeError: no sandbox") < seen.text.index("2 students handed in")
    assert [p.name for p in sorted(tmp_path.glob("*/*"))] == ["ada.json", "ada.html"]
    assert "Nothing is graded" in write(tmp_path / "none", [], {"bob": "RuntimeError"}).text


# ---------------------------------------------------------------------------------------------- a large class

@pytest.mark.parametrize(("make", "folder"), [("student_page", "students"), ("row_of", "gradescope")])
def test_a_page_is_written_before_the_next_one_is_made(tmp_path, monkeypatch, make, folder):
    made, there = getattr(pages, make), []

    def seen(one, *more):
        there.append(len([*(tmp_path / folder).iterdir()]))
        return made(one, *more)
    monkeypatch.setattr(pages, make, seen)
    write(tmp_path, [result(n) for n in "abcdef"])
    assert sorted({*there}) == [0, 1, 2, 3, 4, 5]


class Counted(list):
    """A list that counts how often it is iterated over."""
    times = 0

    def __iter__(self):
        self.times += 1
        return super().__iter__()


def test_every_statistic_of_the_class_reads_the_tests_of_a_student_once():
    sheets = [pages.sheet(result(n), SETTINGS, FREE) for n in "abc"]
    for work in (lambda s: pages.hardest(s, SETTINGS), pages.causes, lambda s: [*pages.lessons_of(s[0])],
                 lambda s: pages.accounts_of(s[0].tests, LESSONS, 0, SETTINGS, FREE)):
        counted = [s._replace(tests=Counted(s.tests)) for s in sheets]
        work(counted)
        assert max(s.tests.times for s in counted) == 1


def test_a_cause_that_a_large_class_shares_names_the_first_students_only(tmp_path):
    wrong = found("1.1", "not yet", {"quantity": "height [m]"})
    some = [result(f"s{n:04d}", wrong) for n in range(pages.MOST_NAMED + 50)]
    seen = write(tmp_path, some)
    part = seen.text[seen.text.index("What went wrong"):seen.text.index("To look into")]
    assert f"s{pages.MOST_NAMED - 1:04d}" in part and f"s{pages.MOST_NAMED:04d}" not in part and "50 others" in part
    assert f"s{pages.MOST_NAMED + 49:04d}" in seen.text                # in the table of students


# ---------------------------------------------------------------------------------------------- hostile texts

def hostile(student=EVIL):
    return result(
        student,
        found("1.1", "not yet", {name: EVIL + name for name in pages.SHOWN}, hint=EVIL),
        found("2.1", "not run", {"got": EVIL}),
        found("1.2", "not yet", {"quantity": pages.CALL, "got": "x" * 10**5}, "hidden", EVIL),
        printed={"falling": EVIL * 10_000},
        problems=[EVIL] * 5000,
        timestamp=EVIL,
    )


UNSEEN = re.compile(
    r"[\x00-\x09\x0b\x0c\x0e-\x1f\x7f-\x9f"
    r"\u200b-\u200f\u2028-\u202e\u2066-\u2069\ufeff]"
)


def test_no_text_of_a_student_becomes_markup_or_a_control_character(tmp_path):
    person = classlist.Person(EVIL, EVIL, EVIL, EVIL)
    absent = classlist.Person("absent", EVIL, EVIL, EVIL)
    write(tmp_path, [hostile()], {f"{EVIL}2": EVIL}, {EVIL: person, "absent": absent}, pages.Terms(DUE, 5.0))
    files = list(tmp_path.rglob("*.*"))
    assert len(files) == 4
    for path in files:
        text = path.read_bytes().decode()                                                # valid UTF-8
        assert not UNSEEN.search(text), path
        assert len(text) < 200_000, path
        if path.suffix == ".html":
            seen = Seen(path)
            assert "script" not in seen.tags and not any(name.startswith("on") for name in seen.attributes)
            for shown in ("<script>alert(1)</script>", "{{ 7 * 7 }}", r"\x202e"):
                assert shown in seen.text
            assert "default-src 'none'" in text


STRANGE_IDS = [
    "<b>", "w" * 200, "with spaces", "../../evil", "a/b", "..", ".", "~", "", "CON",
    "con.x", "Ada", "ada.", "é", "e\u0301", "\ud800", "\n", "%2e%2e", "a?b#c",
]


@pytest.mark.parametrize("student", STRANGE_IDS)
def test_file_names_are_safe_and_unique(tmp_path, student):
    name = pages.file_name(student)
    assert re.fullmatch(r"[A-Za-z0-9_-][A-Za-z0-9_~-]{0,80}", name) and "~" in name[1:]
    assert name == pages.file_name(student)
    assert pages.file_name(name) != name                               # no id can be chosen to get another's file
    seen = write(tmp_path, [result(student)])
    assert f"students/{name}.html" in seen.links and (tmp_path / "students" / f"{name}.html").is_file()
    assert len(list(tmp_path.rglob("*.*"))) == 4


def test_plain_ids_keep_their_names_and_no_two_ids_share_one():
    plain = ["ada", "a", "s1234567", "ada.byron", "ada-byron_2"]
    assert [pages.file_name(student) for student in plain] == plain
    ids = [*plain, "Ada", "ADA", "ada ", "ada~", "w" * 200, "w" * 201, "<b>", "(b)", "é", "e\u0301"]
    assert len({pages.file_name(student).lower() for student in ids}) == len(ids)


# ---------------------------------------------------------------------------------------------- on screen

def test_the_screen_shows_lessons_hardest_exercises_and_failures_as_plain_text():
    screen = Console(file=io.StringIO(), width=200)
    ada = result("ada", found("1.2", "not attempted"))
    bob = result("bob", handed_in=("falling",))
    pages.show(screen, [ada, bob], {"[bold]eve\x1b": "[/x] no sandbox"}, SETTINGS)
    text = screen.file.getvalue()
    lines = {first: rest for first, *rest in (line.split() for line in text.splitlines() if line)}
    assert lines["falling"] == ["2", "4.5", "4.5", "6"] and lines["bouncing"] == ["1", "4.0", "4.0", "4"]
    for part in ("1.2 land (50% of its points)", r"[bold]eve\x1b", "[/x] no sandbox"):
        assert part in text
    pages.show(screen, [], {}, SETTINGS)


def test_no_exercise_is_the_hardest_where_all_points_are_earned():
    screen = Console(file=io.StringIO(), width=200)
    pages.show(screen, [result("ada")], {}, SETTINGS)
    assert "falling" in screen.file.getvalue() and "Hardest" not in screen.file.getvalue()


@pytest.mark.parametrize("name", ["students/ada.html", "gradescope/ada.json", "grades.csv", "index.html"])
def test_a_full_disk_is_told_with_the_name_of_the_file(tmp_path, monkeypatch, name):
    write = Path.write_bytes

    def full(path, data):
        if (path.parent / path.name.removeprefix(".").removesuffix(".part")) == tmp_path / name:
            raise OSError(errno.ENOSPC, "No space left on device")
        return write(path, data)

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(BadInput, match=rf"{name}.*No space left"):
        pages.write(tmp_path, [result("ada")], {}, SETTINGS, {}, FREE)


@pytest.mark.parametrize("text", [
    "student_id,last_name,timestamp\nada,Lovelace,2026-11-30T23:59\n",
    "student_id;last_name;timestamp\nada;Lovelace;2026-11-30 23:59:00\n",
    "student_id\tlast_name\ttimestamp\nada\tLovelace\t2026-11-30T23:59:00\n",
])
def test_a_class_list_may_come_from_any_spreadsheet(tmp_path, text):
    (tmp_path / "list.csv").write_text(text, encoding="utf-8-sig")
    ada = classlist.Person("ada", "Lovelace", timestamp="2026-11-30T23:59:00")
    assert classlist.roster(tmp_path / "list.csv") == {"ada": ada}


@pytest.mark.parametrize(("content", "why"), [
    (None, "No such file"),
    (b"\x89PNG\r\n\x1a\n\xff", "no text"),
    (b"name\nAda\n", "without the column student_id"),
    (b"student_id,timestamp\nada,soon\n", "'soon'"),
])
def test_a_file_that_is_no_class_list_is_reported_in_plain_words(tmp_path, content, why):
    if content is not None:
        (tmp_path / "list.csv").write_bytes(content)
    with pytest.raises(BadInput, match=re.escape(why)) as told:
        classlist.roster(tmp_path / "list.csv")
    assert "Errno" not in str(told.value) and "codec" not in str(told.value)


def test_a_file_that_does_not_load_says_so_first_and_once(tmp_path):
    error = SyntaxError("unmatched ')'", ("falling.py", 7, 1, ")("))
    broken = points.unreadable(points.Outcome("1.1", "", 1.0, "not run"), error, " (falling.py, line 7)")
    says = {"quantity": points.READING, "expected": broken.expected, "got": broken.got}
    ada = result("ada", *(found(row[1], "not yet", says, hint=broken.hint) for row in MANIFEST if row[0] == "falling"))
    pages.write(tmp_path, [ada], {}, SETTINGS, {}, FREE)
    seen = Seen(tmp_path / "students" / "ada.html").text
    assert seen.count("unmatched ')' (falling.py, line 7)") == 1 and seen.count("falling.py, line 7") == 1
    assert seen.index("falling.py does not load") < seen.index("1.1") and "What did not pass" not in seen
