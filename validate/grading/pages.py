"""The output of grading: a page for the instructor, one per student, a CSV in nbgrader's columns, JSON for Gradescope.

Texts of students (ids, errors, printed text) are shown but never trusted.  `clean` spells out invisible characters,
the templates escape, the pages allow no script, and no cell of the CSV is a formula.
"""

import csv
import hashlib
import io
import json
import re
from collections.abc import Mapping
from datetime import datetime, timedelta
from functools import lru_cache, partial
from pathlib import Path
from statistics import mean, median
from types import MappingProxyType
from typing import NamedTuple

from jinja2 import Environment, FileSystemLoader
from markupsafe import Markup
from rich.markup import escape
from rich.table import Table

from validate.run.store import write_text
from validate.subject import modules, needs

from . import classlist, marking, marks, points, similar, submissions, uploads, watch
from .texts import cell, clean, line, many, number

HERE = Path(__file__).resolve().parent
STYLES = (modules.ROOT / "validate" / "report" / "style.css", HERE / "templates" / "grades.css")
COLUMNS = ("assignment", "duedate", "timestamp", "student_id", "last_name", "first_name", "email",
           "raw_score", "late_submission_penalty", "score", "max_score",                # as nbgrader exports them
           "problems", "raw_score_of_tests", "by_hand")          # of the files; what was changed by hand
MOST_PROBLEMS = submissions.MOST_PROBLEMS + 5          # problems shown per submission [-]; `sheet` adds some
MOST_NAMED = 200             # students named per cause on the class page [-]; the table of students has them all
STATES = ("passed", "not attempted", "not yet")        # of a test that was run
MOST_BARS = 20               # bars of the histogram [-]: a phone has room for so many
SHOWN = ("quantity", "given", "expected", "got", "tolerance")
INPUTS = {"visible": "with the public inputs", "hidden": "with other inputs"}
CALL = "the call itself"     # the quantity where a call of the student's function ended in an error
ENDS = {"Lost": "the program ended, hung or sent no data", "StudentError": "an error of another kind"}


NAMED_AFTER = ("coulomb", "euler", "gauss", "hooke", "housner", "jacobi", "kepler", "kutta", "lagrange", "newton",
               "runge", "seidel", "suzuki", "verlet")                    # persons in the names of tests
PROPER = {"l": "L", **{name: name.capitalize() for name in NAMED_AFTER},
          **{f"{name}s": f"{name.capitalize()}'s" for name in NAMED_AFTER}}
NOTHING: Mapping = MappingProxyType({})


class Run(NamedTuple):
    """Facts about one run; only the class page has them, so that grading again changes no other file."""
    overlooked: tuple = ()   # sentences about files that belong to no student
    alike: Mapping = NOTHING    # {student: [(lesson, another student, share of lines in common), …]}
    when: str = ""           # ISO 8601
    versions: str = ""       # of workbook, Python and NumPy
    seed: str = ""           # its fingerprint


NO_RUN = Run()


class Terms(NamedTuple):
    """The due date and the late penalty."""
    due: str                 # ISO 8601; "" for none
    late: float              # deducted for each day begun [% of the maximum]
    listed: bool = False     # only the class list says when work was handed in, and no date of a file


class Account(NamedTuple):
    """One student's lesson [points]."""
    handed_in: bool
    raw: float
    penalty: float           # no more than was earned
    score: float             # raw − penalty
    maximum: float
    tested: float = 0.0      # raw without points by hand


class Sheet(NamedTuple):
    """One student's submission with its result and points."""
    student: str
    person: classlist.Person
    file: str                # name of the page, without its ending
    result: dict
    tests: list              # verdicts, in the order of the manifest
    accounts: dict           # {lesson: Account}
    hands: dict              # {place: marks.Hand} of the points given by hand
    due: str                 # the student's due date: ISO 8601; "" for none
    days: int                # days begun after it [-]; None if unknown
    problems: tuple

    def total(self, field):
        if field == "score" and marks.TOTAL in self.hands:
            return self.hands[marks.TOTAL].points
        return sum(getattr(account, field) for account in self.accounts.values())

    def hands_in(self, lesson):
        return [hand for place, hand in self.hands.items() if place[0] == lesson]


# ---------------------------------------------------------------------------------------------- texts and names

def fingerprint(seed):
    """Return a fingerprint of a secret seed.  It is slow to compute, so that a short seed cannot be found by trying."""
    return hashlib.pbkdf2_hmac("sha256", seed.encode(errors="surrogatepass"), b"workbook", 200_000).hex()[:12]


def breakable(name):
    """Allow a narrow page to break a function's name after an underscore."""
    return Markup("_<wbr>").join(name.split("_"))


def claim(test):
    """Write a test's name in words: test_it_falls[euler] as "It falls (euler)"."""
    name, _, variant = test.removeprefix("test_").partition("[")
    words = " ".join(PROPER.get(word, word) for word in name.split("_"))
    return words[:1].upper() + words[1:] + (f" ({variant.removesuffix(']')})" if variant else "")


def file_name(student):
    """Return the name of a student's files: a plain id itself, otherwise its plain characters and a fingerprint.

    No two ids share a name, even where file names ignore case.  "~" keeps the two kinds apart.
    """
    reserved = re.match(r"(con|prn|aux|nul|com\d|lpt\d)(\.|$)", student)             # on Windows
    if re.fullmatch(r"[a-z0-9][a-z0-9._-]{0,58}[a-z0-9]|[a-z0-9]", student) and not reserved:
        return student
    plain = re.sub(r"[^A-Za-z0-9_]+", "-", student)[:40].strip("-") or "student"
    return f"{plain}~{hashlib.sha256(student.encode(errors='surrogatepass')).hexdigest()[:16]}"


# ---------------------------------------------------------------------------------------------- points

def verdicts(result, settings):
    """Return the verdict on every test of the manifest, in its order.

    A test that the result lacks was not run and earns nothing.
    """
    found = {(t["lesson"], t["test"]): t for t in result["tests"]}
    return [
        found.get((row[0], row[3])) or marking.verdict(row, {}, row[0] in result["handed_in"])
        for row in settings.manifest
    ]


def kind_of(got):
    """Return the error's name: ValueError for "ValueError: a ball (falling.py, line 3)"."""
    return re.match(r"\w*", got)[0]


def days_late(timestamp, due):
    """Count the days begun between due and timestamp [-]: one second late is a day.  None if the timestamp is no date.

    Two times without a time zone are compared as they are.  If only one has a time zone, the other is taken as local
    time of this machine.
    """
    if not due:
        return 0
    try:
        when, until = datetime.fromisoformat(timestamp), datetime.fromisoformat(due)
        if (when.tzinfo is None) != (until.tzinfo is None):
            when, until = when.astimezone(), until.astimezone()
    except (ValueError, OverflowError):
        return None
    return max(0, -((until - when) // timedelta(days=1)))


def grouped(tests, *names):
    """Group tests by one entry, or by several: {value or tuple of values: tests}, in the order of the tests."""
    groups = {}
    for t in tests:
        key = t[names[0]] if len(names) == 1 else tuple(t[name] for name in names)
        groups.setdefault(key, []).append(t)
    return groups


def accounts_of(tests, handed_in, days, settings, terms, hands=NOTHING):
    """Return {lesson: Account}, with points by hand.  A penalty is no larger than the points earned."""
    accounts, of = {}, grouped(tests, "lesson")
    for lesson in settings.lessons:
        mine = of.get(lesson, ())
        raw, maximum = marks.earned(mine, hands), sum(t["points"] for t in mine)
        late = days if days and lesson in handed_in else 0             # what was not handed in is by hand, and not late
        penalty = min(raw, terms.late / 100.0 * maximum * late)
        tested = sum(t["earned"] for t in mine)
        accounts[lesson] = Account(lesson in handed_in, raw, penalty, raw - penalty, maximum, tested)
    return accounts


def sheet(result, settings, terms, person=None, given=()):
    """Return the Sheet of one result.  Dates in the class list override that of the files and that of the class.

    given: the student's marks, as marks.read returns them.
    """
    person = person or classlist.Person(result["student"])
    result = {**result, "timestamp": person.timestamp or ("" if terms.listed else result["timestamp"])}
    tests, due = verdicts(result, settings), person.due or terms.due
    days = days_late(result["timestamp"], due) if result["handed_in"] else 0
    problems = list(result["problems"]) or ["no lesson file is in it"] * (not result["handed_in"])
    if days is None:
        when = line(result["timestamp"]) or "no date"
        problems.append(f"when it was handed in is not known ({when}): nothing is taken off for being late")
    student, hands = result["student"], marks.by_hand(tests, given)
    accounts = accounts_of(tests, result["handed_in"], days, settings, terms, hands)
    if any(mark.place == marks.TOTAL for mark in given):
        hands[marks.TOTAL] = marks.hand(marks.TOTAL, sum(account.score for account in accounts.values()), given)
    return Sheet(
        student=student,
        person=person,
        file=file_name(student),
        result=result,
        tests=tests,
        accounts=accounts,
        hands=hands,
        due=due,
        days=days,
        problems=tuple(problems[:MOST_PROBLEMS]),
    )


def lateness(one, terms):
    """Return a sentence about when a submission was handed in."""
    when, due = one.result["timestamp"].replace("T", " "), one.due.replace("T", " ")
    if not one.result["handed_in"] or one.days is None or not when:
        return ""
    if not one.days:
        return f"Handed in {when}{f', in time: due {due}' if due else ''}."
    cost = "nothing is taken off for that"
    if terms.late:
        rule = f"{number(terms.late)} % of the maximum for each day begun, and no more than was earned"
        cost = f"{rule}: {number(one.total('penalty'))} points off"
    return f"Handed in {when}, due {due}, {many(one.days, 'day')} late; {cost}."


# ---------------------------------------------------------------------------------------------- the class in numbers

def by_lesson(sheets, settings):
    """Return [(lesson, accounts of the students who handed it in), …]."""
    return [
        (lesson, [s.accounts[lesson] for s in sheets if s.accounts[lesson].handed_in])
        for lesson in settings.lessons
    ]


def hardest(sheets, settings):
    """Return the exercises by the share of points earned, smallest first; only students who handed in count."""
    counts = {}                                                        # {exercise: [earned, points, solved, of, left]}
    for s in sheets:
        for (lesson, exercise), tests in grouped(s.tests, "lesson", "exercise").items():
            if s.accounts[lesson].handed_in:
                so_far = counts.get((lesson, exercise), 5 * [0])
                counts[lesson, exercise] = [a + b for a, b in zip(so_far, counts_of(tests), strict=True)]
    rows = []
    for lesson, exercise, function in dict.fromkeys(row[:3] for row in settings.manifest):
        if (lesson, exercise) in counts:
            earned, worth, solved, of, left = counts[lesson, exercise]
            rows.append({
                "lesson": lesson,
                "exercise": exercise,
                "function": function,
                "share": earned / worth,
                "solved": solved,
                "of": of,
                "left": left,
            })
    return sorted(rows, key=lambda row: row["share"])


def counts_of(tests):
    """Return (points earned, points, 1 if solved, 1, 1 if not attempted) of one student's exercise."""
    states = {t["status"] for t in tests}
    earned, worth = sum(t["earned"] for t in tests), sum(t["points"] for t in tests)
    return earned, worth, states == {"passed"}, 1, states == {"not attempted"}


def cause(test):
    """Return the cause of a failure: a quantity, a kind of error, or the status of a test that was not run."""
    quantity, got = test["says"].get("quantity", ""), test["says"].get("got", "")
    if test["status"] != "not yet":
        return test["status"]
    if quantity not in (CALL, points.READING) or test["kind"] == "hidden":
        return quantity
    return f"{quantity}: {ENDS.get(kind_of(got), kind_of(got))}"


def looks(one, alike):
    """Return [(observation, the same with details), …] that the instructor, but no student, sees."""
    told = [pair for lesson, codes in sorted(one.result["watched"].items()) for pair in watch.noted(lesson, codes)]
    for lesson, other, share in alike.get(one.student, ()):
        what = "the same" if share == 1.0 else "nearly the same"
        whose = "the workbook" if other == similar.WORKED else "another student"
        lines = f" ({share:.0%} of the lines)" if share < 1.0 else ""
        told.append((f"{what} answers as {whose}", f"{lesson}: {what} as {other}{lines}"))
    public = sum(t["kind"] == "hidden" and t["status"] == "not yet" for t in one.tests)
    if public:
        told.append(("right with the public inputs only", f"{many(public, 'test')} right with the public inputs only"))
    return told


def to_look_into(sheets, found):
    """Return [(observation, sheets), …] from {student: observations of `looks`}, rare ones first."""
    groups = {}
    for one in sheets:
        for what in dict.fromkeys(what for what, _ in found[one.student]):
            groups.setdefault(what, []).append(one)
    return sorted(groups.items(), key=lambda row: (len(row[1]), row[0]))


def causes(sheets):
    """Group failures that share exercise, cause and hint, with their students, the most frequent first.

    An exercise that was not attempted is not a failure.
    """
    groups = {}
    for s in sheets:
        for t in s.tests:
            if t["status"] not in ("passed", "not handed in", "not attempted"):
                exercise = "the whole file" if t["says"].get("quantity") == points.READING else t["exercise"]
                hint = t["hint"] if t["status"] == "not yet" else ""
                group = groups.setdefault((t["lesson"], exercise, cause(t), hint), {"students": {}, "other": set()})
                group["students"][s.student] = s
                if t["kind"] == "hidden":
                    group["other"].add(s.student)
    rows = [
        {
            "lesson": lesson,
            "exercise": exercise,
            "cause": why,
            "hint": hint,
            "other": len(group["other"]),
            "students": [*group["students"].values()],
        }
        for (lesson, exercise, why, hint), group in groups.items()
    ]
    return sorted(rows, key=lambda row: -len(row["students"]))


def histogram(scores, maximum):
    """Return {"width" of a bar [points], "median", "bars", "ticks"}, with positions in % of the picture's width.

    The lower edge belongs to a bar, and the maximum to the last one.
    """
    widths = (digit * 10**power for power in range(9) for digit in (1, 2, 5))
    width = next(width for width in widths if maximum <= MOST_BARS * width)
    bars = max(1, -int(-maximum // width))
    counts = [0] * bars
    for score in scores:
        counts[min(int(score // width), bars - 1)] += 1

    def place(x):
        return f"{3.0 + 94.0 * x / (bars * width):.3f}"

    def bar(n, count):
        high = round(130.0 * count / max(counts), 1)
        return {"x": place(n * width), "wide": f"{94.0 / bars:.3f}", "count": count, "high": high}

    every = -(-bars // 10) * width
    middle = median(scores)
    return {
        "width": width,
        "median": (place(middle), middle),
        "right": middle > 0.5 * bars * width,
        "bars": [bar(n, count) for n, count in enumerate(counts)],
        "ticks": [(place(x), x) for x in range(0, bars * width + 1, every)],
    }


def lessons_of(one):
    """Generate the lessons of a student's page: exercises with their points, and remarks on tests that failed.

    Tests that failed with the same words share a remark, so that a file that does not load has only one.
    """
    tests = [*one.tests]
    theirs, below = grouped(tests, "lesson"), below_of(tests)
    for lesson, account in one.accounts.items():
        exercises, remarks = {}, {}
        for t in theirs.get(lesson, ()):
            exercises.setdefault(t["exercise"], []).append(t)
            if t["status"] not in ("passed", "not attempted", "not handed in"):
                remarks.setdefault((t["kind"], t["hint"], json.dumps(t["says"])), []).append(t)
        yield {
            "name": lesson,
            "account": account,
            "remarks": [(tests, [*dict.fromkeys(below[t["exercise"]] for t in tests if t["exercise"] in below)])
                        for tests in remarks.values()],
            "exercises": [exercise_row(tests, one.hands.get((lesson, exercise)))
                          for exercise, tests in exercises.items()],
            "hands": one.hands_in(lesson),
        }


def below_of(tests):
    """Return {exercise: a sentence} for each that does not pass and calls another one that does not pass either.

    Earlier lessons are worked where a class is graded, so the other one is of the same lesson.
    """
    states = needs.states((t["exercise"], t["status"]) for t in tests if t["status"] in STATES
                          and needs.table().get(t["exercise"], {}).get("lesson") == t["lesson"])
    sentences = {number: needs.sentence_below(number, states) for number, state in states.items() if state == "not yet"}
    return {number: sentence for number, sentence in sentences.items() if sentence}


def exercise_row(tests, hand):
    """Return the row of one exercise on a student's page.  hand: its points by hand, or None."""
    return {
        "number": tests[0]["exercise"],
        "function": tests[0]["function"],
        "earned": hand.points if hand else sum(t["earned"] for t in tests),
        "hand": hand,
        "points": sum(t["points"] for t in tests),
        "word": word({t["status"] for t in tests}),
    }


def word(states):
    """Return (words, kind) for an exercise whose tests ended in these states."""
    if states == {"passed"}:
        return "right", "agrees"
    if states == {"not attempted"}:
        return "not attempted", "open"
    return ("partly right" if "passed" in states else "not yet"), "departs"


# ---------------------------------------------------------------------------------------------- for other programs

def gradescope(result, settings, terms):
    """Return Gradescope's results.json of a result, as a dict."""
    return sheet_for_gradescope(sheet(result, settings, terms), terms)


def sheet_for_gradescope(one, terms):
    """Return the same for a Sheet: one row for every test of the manifest, run or not.

    score is after the late penalty and with points by hand; Gradescope takes it in place of the sum of the rows.
    *Source:* Gradescope, Autograder Specifications.
    """
    below = below_of(one.tests)
    by_hand = [f"By hand: {line(marks.words(hand))}" for hand in one.hands.values()]
    lines = [clean(lateness(one, terms)), *by_hand, *map(line, one.problems)]
    return {
        "score": round(one.total("score"), 6),
        "visibility": "visible",
        "stdout_visibility": "hidden",
        "output": "\n".join(filter(None, lines)),
        "output_format": "text",
        "tests": [row_of(t, below.get(t["exercise"], "")) for t in one.tests],
    }


def row_of(test, below):
    """Return Gradescope's row of one test.  below: a sentence about an exercise that it calls, or empty."""
    said = [f"{name}: {clean(test['says'][name])}" for name in SHOWN if name in test["says"]]
    if test["status"] == "not yet":
        hint = [] if test["tells"] else [f"hint: {clean(test['hint'])}"]
        said = [INPUTS[test["kind"]], *said, *[f"first: {below}"] * bool(below), *hint]
    if test["status"] == "not attempted":
        own = f"Exercise {test['exercise']}:" in test["says"].get("got", f"Exercise {test['exercise']}:")
        said = [test["status"] if own or not below else f"it waits: {below}"]
    passed = test["status"] == "passed"
    return {
        "score": test["earned"],
        "max_score": test["points"],
        "status": "passed" if passed else "failed",
        "number": test["exercise"],
        "name": f"{test['function']}: {claim(test['test'])}",
        "output": "" if passed else "\n".join(said),
        "output_format": "text",
        "visibility": "visible",
        "tags": [test["lesson"]],
    }


def table(sheets, failed, settings, people, terms):
    """Return grades.csv as text: a row for each student and lesson.

    A row has no scores if the grader failed, and 0 if a student of the class list handed nothing in.  A total that is
    given by hand has a row of its own, with the difference.
    """
    graded = {s.student: s for s in sheets}
    maxima = {lesson: sum(row[4] for row in settings.manifest if row[0] == lesson) for lesson in settings.lessons}
    text = io.StringIO()
    rows = csv.writer(text)
    rows.writerow(COLUMNS)
    for student in sorted({*graded, *failed, *people}):
        one, person = graded.get(student), people.get(student) or classlist.Person(student)
        due = person.due or terms.due
        problems = [failed[student]] if student in failed else one.problems if one else []
        stranger = ["not on the class list"] * (bool(people) and student not in people)
        who = [cell(text) for text in (student, person.last_name, person.first_name, person.email)]
        problems = cell(" | ".join([*stranger, *problems]))
        for lesson in settings.lessons:
            account = one.accounts[lesson] if one else Account(False, 0.0, 0.0, 0.0, maxima[lesson])
            scores = ("", "", "") if student in failed else map(number, (account.raw, account.penalty, account.score))
            rows.writerow([
                cell(lesson),
                due,
                cell(one.result["timestamp"] if account.handed_in else ""),
                *who,
                *scores,
                number(account.maximum),
                problems,
                "" if student in failed else number(account.tested),
                cell(" | ".join(map(marks.words, one.hands_in(lesson)))) if one else "",
            ])
        if one and (hand := one.hands.get(marks.TOTAL)):
            more = number(round(hand.points - hand.before, 6))
            rows.writerow([cell(marks.BY_HAND), due, "", *who, more, "0", more, "0", problems, "0",
                           cell(marks.words(hand))])
    return text.getvalue()


# ---------------------------------------------------------------------------------------------- files

@lru_cache(maxsize=1)
def templates():
    """Return the templates of the pages.  They clean and escape what they show, and contain their style."""
    loader = FileSystemLoader(HERE / "templates")
    pages = Environment(loader=loader, autoescape=True, finalize=clean, trim_blocks=True, lstrip_blocks=True)
    pages.filters.update(line=line, breakable=breakable, number=number, claim=claim, many=many)
    style = Markup("".join(css.read_text(encoding="utf-8") for css in STYLES))
    pages.globals.update(style=style, SHOWN=SHOWN, INPUTS=INPUTS, READING=points.READING, MOST_NAMED=MOST_NAMED)
    pages.globals.update(mean=mean, median=median)
    return pages


def write(out, results, failed, settings, people, terms, run=NO_RUN, given=NOTHING):
    """Write pages, CSV and JSON into a folder; return the path of the front page.

    results: as marking.mark returns them · failed: {student: why there are no points} · people: the class list, or {}
    · given: points by hand, as marks.read returns them.
    """
    sheets = sheets_of(results, settings, people, terms, given)
    nothing = {*given} & {*people} - {s.student for s in sheets} - {*failed}
    others = [marking.nothing(student, settings) for student in sorted(nothing)]
    absent = sheets_of(others, settings, people, terms, given)         # who handed nothing in and has points by hand
    for folder in ("students", "gradescope"):
        (out / folder).mkdir(parents=True, exist_ok=True)
    current = {s.student for s in sheets + absent}
    for student in {*failed, *people} - current:                       # pages of an earlier run are out of date
        (out / "students" / f"{file_name(student)}.html").unlink(missing_ok=True)
        (out / "gradescope" / f"{file_name(student)}.json").unlink(missing_ok=True)
    for s in sheets + absent:                                          # one by one: many would fill the memory
        write_text(out / "students" / f"{s.file}.html", student_page(s, terms))
        write_text(out / "gradescope" / f"{s.file}.json", as_json(sheet_for_gradescope(s, terms)))
    write_text(out / "grades.csv", table(sheets + absent, failed, settings, people, terms))
    uploads.write(partial(write_or_remove, out), sheets + absent, failed, settings, people)
    write_text(out / "index.html", class_page(sheets, failed, settings, people, terms, run, absent))
    return out / "index.html"


def sheets_of(results, settings, people, terms, given):
    """Return the Sheets of results, in the order of the students."""
    found = (sheet(r, settings, terms, people.get(r["student"]), given.get(r["student"], ())) for r in results)
    return sorted(found, key=lambda s: s.student)


def student_page(one, terms):
    """Return one student's page.  It has no links, so that it can be handed out."""
    return templates().get_template("student.html").render(
        s=one,
        lessons=lessons_of(one),
        lateness=lateness(one, terms),
        total_by_hand=[one.hands[marks.TOTAL]] if marks.TOTAL in one.hands else [],
    )


def class_page(sheets, failed, settings, people, terms, run, absent):
    """Return the instructor's page.  absent: Sheets of those who handed nothing in and have points by hand."""
    found = {s.student: looks(s, run.alike) for s in sheets}
    handed = {s.student: s for s in absent}
    missing = sorted({*people} - {s.student for s in sheets} - {*failed})
    maximum = sum(row[4] for row in settings.manifest)
    return templates().get_template("class.html").render(
        sheets=sheets,
        failed=sorted(failed.items()),
        run=run,
        looks=found,
        settings=settings,
        seconds=[s.result["seconds"] for s in sheets],
        empty=[s for s in sheets if not s.result["handed_in"]],
        named=any(s.person.first_name or s.person.last_name for s in sheets),
        late=any(s.days for s in sheets),
        remarks=any(s.problems or found[s.student] or (people and s.student not in people) for s in sheets),
        watched=to_look_into(sheets, found),
        people=people,
        terms=terms,
        absent=[(people[student], handed.get(student)) for student in missing],
        gaps=uploads.gaps(people),
        imports=uploads.files(people),
        by_hand=[s for s in (*sheets, *absent) if s.hands],
        picture=histogram([s.total("score") for s in sheets], maximum) if sheets else None,
        lessons=by_lesson(sheets, settings),
        hardest=hardest(sheets, settings),
        causes=causes(sheets),
    )


def as_json(value):
    return json.dumps(value, ensure_ascii=False, allow_nan=False, indent=1)


def write_or_remove(folder, name, text):
    """Write a file, or remove that of an earlier run where there is no text."""
    if text is None:
        (folder / name).unlink(missing_ok=True)
    else:
        write_text(folder / name, text)


def show(console, results, failed, settings, given=NOTHING):
    """Print a summary: points by lesson before late penalties, the hardest exercises, and students without points."""
    sheets = sheets_of(results, settings, {}, Terms("", 0.0), given)
    summary = Table(header_style="bold", box=None, pad_edge=False)
    for column in ("lesson", "handed in", "mean", "median", "of"):
        summary.add_column(column, justify="left" if column == "lesson" else "right")
    for lesson, accounts in by_lesson(sheets, settings):
        raw = [a.raw for a in accounts]
        middle = [f"{mean(raw):.1f}", f"{median(raw):.1f}"] if raw else ["–", "–"]
        maximum = sum(row[4] for row in settings.manifest if row[0] == lesson)
        summary.add_row(lesson, str(len(raw)), *middle, number(maximum))
    console.print(summary)
    rows = [row for row in hardest(sheets, settings) if row["share"] < 1.0]
    if rows:
        names = [f"{r['exercise']} {r['function']} ({r['share']:.0%} of its points)" for r in rows[:3]]
        equal = sum(row["share"] == rows[:3][-1]["share"] for row in rows[3:])
        more = f", and {equal} more with the same share as the last one" if equal else ""
        console.print(f"Hardest: {', '.join(names)}{more}", highlight=False, soft_wrap=True)
    for student, why in sorted(failed.items()):
        who = f"[bold red]Not graded: {escape(line(student))}[/bold red], who has no points and no zero"
        console.print(f"{who}: {escape(line(why))}", highlight=False, soft_wrap=True)
