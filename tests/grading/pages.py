"""What a class reads: a page for the instructor, one for each student, a CSV in nbgrader's columns, results.json for Gradescope.

What came from students (ids, errors, printed text) is shown and never trusted: `clean` spells out what cannot be seen, the templates escape,
the pages allow no script, and no cell of the CSV is a formula.
"""

import csv
import hashlib
import io
import json
import re
from datetime import datetime, timedelta
from functools import lru_cache
from pathlib import Path
from statistics import mean, median
from typing import NamedTuple

from jinja2 import Environment, FileSystemLoader
from markupsafe import Markup
from rich.markup import escape
from rich.table import Table

from validate import modules

from . import marking, points, similar, submissions, watch

HERE = Path(__file__).resolve().parent
STYLES = (modules.ROOT / "validate" / "report" / "style.css", HERE / "templates" / "grades.css")
COLUMNS = ("assignment", "duedate", "timestamp", "student_id", "last_name", "first_name", "email",
           "raw_score", "late_submission_penalty", "score", "max_score",                # as nbgrader exports them
           "problems")       # and what is wrong with the files
MOST_TOLD = 20               # students that are named on the screen [-]: the page has them all
MOST_PROBLEMS = submissions.MOST_PROBLEMS + 5          # of a submission that are shown [-]: its own, and what is added here
MOST_NAMED = 200             # students of one cause whom the class page names [-]: the table of students has them all
MOST_BARS = 20               # of the histogram [-]: what a phone has room for
SHOWN = ("quantity", "given", "expected", "got", "tolerance")
INPUTS = {"visible": "with the public inputs", "hidden": "with other inputs"}
CALL = "the call itself"     # the quantity where a call of the student's function ended in an error
FORMULA = re.compile(r"""(^|[;|,\t])(?=[\s"']*[=+\-@＝＋－＠])""")     # at the start or after a separator
ENDS = {"Lost": "the program ended, hung or sent no data", "StudentError": "an error that is none of Python's own"}


class Run(NamedTuple):
    """What the class page says of this run, and no other file: the others stay the same when a class is graded again."""
    overlooked: tuple = ()   # sentences about files that are nobody's
    alike: dict = {}         # {student: [(lesson, another student, share of lines in common), …]}
    when: str = ""           # ISO 8601
    versions: str = ""       # of workbook, Python and NumPy
    seed: str = ""           # its fingerprint


class Terms(NamedTuple):
    """When it was due, and what being late costs."""
    due: str                 # ISO 8601; "" for no such date
    late: float              # taken off for each day begun [% of the maximum]


class Account(NamedTuple):
    """One student's lesson [points]."""
    handed_in: bool
    raw: float
    penalty: float           # no more than was earned
    score: float             # raw − penalty
    maximum: float


class Sheet(NamedTuple):
    """All about one student's submission."""
    student: str
    person: submissions.Person
    file: str                # name of the page, without its ending
    result: dict
    tests: list              # verdicts, in the order of the manifest
    accounts: dict           # {lesson: Account}
    days: int                # begun after it was due [-]; None when that is not known
    problems: tuple

    def total(self, field):
        return sum(getattr(account, field) for account in self.accounts.values())


# ---------------------------------------------------------------------------------------------- texts and names

def clean(value):
    """A text with control, format and undecodable characters spelt out, and not too long; anything else as it is."""
    return marking.readable(value) if isinstance(value, str) and not isinstance(value, Markup) else value


def line(text):
    """The same on one line."""
    return clean(text).replace("\n", "\\x0a")


def number(x):
    """Points in six digits at most: 3, 2.5, 0.333333."""
    return f"{x:.6g}"


def fingerprint(seed):
    """Tells one secret seed from another; slow, so that a short one is not found by trying."""
    return hashlib.pbkdf2_hmac("sha256", seed.encode(errors="surrogatepass"), b"workbook", 200_000).hex()[:12]


def many(n, what):
    return f"{n} {what}{'' if n == 1 else 's'}"


def breakable(name):
    """A function's name that a narrow page may break after an underscore."""
    return Markup("_<wbr>").join(name.split("_"))


def claim(test):
    """A test's name in words: test_it_falls[euler] as "It falls (euler)"."""
    name, _, variant = test.removeprefix("test_").partition("[")
    words = name.replace("_", " ")
    return words[:1].upper() + words[1:] + (f" ({variant.removesuffix(']')})" if variant else "")


def file_name(student):
    """The name of a student's files: the id where that is plain, else what is plain in it and a fingerprint.

    No two ids share one, on systems either that take A for a; "~" keeps the two kinds apart.
    """
    reserved = re.match(r"(con|prn|aux|nul|com\d|lpt\d)(\.|$)", student)             # on Windows
    if re.fullmatch(r"[a-z0-9][a-z0-9._-]{0,58}[a-z0-9]|[a-z0-9]", student) and not reserved:
        return student
    plain = re.sub(r"[^A-Za-z0-9_]+", "-", student)[:40].strip("-") or "student"
    return f"{plain}~{hashlib.sha256(student.encode(errors='surrogatepass')).hexdigest()[:16]}"


def cell(text):
    """A text that no spreadsheet runs as a formula.

    It may split cells at other separators than ours, trim blanks and quotes, and take the wide signs of East Asian
    keyboards.  Each part that begins as a formula gets an apostrophe.
    """
    return FORMULA.sub(r"\1'", line(text))


# ---------------------------------------------------------------------------------------------- points

def verdicts(result, settings):
    """The verdict on every test of the manifest, in its order: what a result lacks was not run, and earns nothing."""
    found = {(t["lesson"], t["test"]): t for t in result["tests"]}
    return [found.get((row[0], row[3])) or marking.verdict(row, {}, row[0] in result["handed_in"]) for row in settings.manifest]


def kind_of(got):
    """The error's name, of "ValueError: a ball (falling.py, line 3)"."""
    return re.match(r"\w*", got)[0]


def days_late(timestamp, due):
    """Days begun between due and timestamp [-]: one second is a day.  None when the timestamp is no date.

    Two local times are compared as the clock on the wall showed them; where one has a time zone, the other is taken as local time here.
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
    """{value of that entry, or values of those: its tests}, in the order in which they come."""
    groups = {}
    for t in tests:
        groups.setdefault(t[names[0]] if len(names) == 1 else tuple(t[name] for name in names), []).append(t)
    return groups


def accounts_of(tests, handed_in, days, settings, terms):
    """{lesson: Account}.  A penalty takes no more than there is."""
    accounts, of = {}, grouped(tests, "lesson")
    for lesson in settings.lessons:
        mine = of.get(lesson, ())
        raw, maximum = sum(t["earned"] for t in mine), sum(t["points"] for t in mine)
        penalty = min(raw, terms.late / 100.0 * maximum * (days or 0))
        accounts[lesson] = Account(lesson in handed_in, raw, penalty, raw - penalty, maximum)
    return accounts


def sheet(result, settings, terms, person=None):
    """The Sheet of one result.  A timestamp in the class list beats that of the files."""
    if person and person.timestamp:
        result = {**result, "timestamp": person.timestamp}
    tests = verdicts(result, settings)
    days = days_late(result["timestamp"], terms.due) if result["handed_in"] else 0
    problems = list(result["problems"]) or ["no lesson file is in it"] * (not result["handed_in"])
    if days is None:
        problems.append(f"when it was handed in is not known ({line(result['timestamp']) or 'no date'}): nothing is taken off for being late")
    student, accounts = result["student"], accounts_of(tests, result["handed_in"], days, settings, terms)
    return Sheet(student, person or submissions.Person(student), file_name(student), result, tests, accounts, days, tuple(problems[:MOST_PROBLEMS]))


def lateness(one, terms):
    """A sentence about when it was handed in."""
    when, due = one.result["timestamp"].replace("T", " "), terms.due.replace("T", " ")
    if not one.result["handed_in"] or one.days is None or not when:
        return ""
    if not one.days:
        return f"Handed in {when}{f', in time: due {due}' if due else ''}."
    cost = (f"{number(terms.late)} % of the maximum for each day begun, and no more than was earned: {number(one.total('penalty'))} points off"
            if terms.late else "nothing is taken off for that")
    return f"Handed in {when}, due {due}, {many(one.days, 'day')} late; {cost}."


# ---------------------------------------------------------------------------------------------- the class in numbers

def by_lesson(sheets, settings):
    """[(lesson, accounts of those who handed it in)]"""
    return [(lesson, [s.accounts[lesson] for s in sheets if s.accounts[lesson].handed_in]) for lesson in settings.lessons]


def hardest(sheets, settings):
    """Exercises by the share of their points that was earned by those who handed the lesson in, the smallest first."""
    counts = {}                                                        # {exercise: [earned, points, solved, of, left]}
    for s in sheets:
        for (lesson, exercise), tests in grouped(s.tests, "lesson", "exercise").items():
            if s.accounts[lesson].handed_in:
                states = {t["status"] for t in tests}
                one = (sum(t["earned"] for t in tests), sum(t["points"] for t in tests), states == {"passed"}, 1,
                       states == {"not attempted"})
                counts[lesson, exercise] = [a + b for a, b in zip(counts.get((lesson, exercise), 5 * [0]), one)]
    rows = []
    for lesson, exercise, function in dict.fromkeys(row[:3] for row in settings.manifest):
        if (lesson, exercise) in counts:
            earned, worth, solved, of, left = counts[lesson, exercise]
            rows.append({"lesson": lesson, "exercise": exercise, "function": function, "share": earned / worth,
                         "solved": solved, "of": of, "left": left})
    return sorted(rows, key=lambda row: row["share"])


def cause(test):
    """What a test failed on: a quantity, a kind of error, or that there was nothing to test."""
    quantity, got = test["says"].get("quantity", ""), test["says"].get("got", "")
    if test["status"] != "not yet":
        return test["status"]
    if quantity not in (CALL, points.READING) or test["kind"] == "hidden":
        return quantity
    return f"{quantity}: {ENDS.get(kind_of(got), kind_of(got))}"


def looks(one, alike):
    """[(what, the same with its details), …] of what may be more than an answer: for the instructor, not for students."""
    told = [pair for lesson, codes in sorted(one.result["watched"].items()) for pair in watch.noted(lesson, codes)]
    for lesson, other, share in alike.get(one.student, ()):
        what = "the same" if share == 1.0 else "nearly the same"
        told.append((f"{what} answers as {'the workbook' if other == similar.WORKED else 'somebody else'}",
                     f"{lesson}: {what} as {other}" + f" ({share:.0%} of the lines)" * (share < 1.0)))
    public = sum(t["kind"] == "hidden" and t["status"] == "not yet" for t in one.tests)
    return told + [("right with the public inputs only", f"{many(public, 'test')} right with the public inputs only")][:public]


def to_look_into(sheets, found):
    """[(what, sheets), …] of {student: what `looks` has found}: what is rare comes first."""
    groups = {}
    for one in sheets:
        for what in dict.fromkeys(what for what, _ in found[one.student]):
            groups.setdefault(what, []).append(one)
    return sorted(groups.items(), key=lambda row: (len(row[1]), row[0]))


def causes(sheets):
    """Failures that have exercise, cause and hint in common, with their students, the most frequent first.

    What was not attempted is no failure.
    """
    groups = {}
    for s in sheets:
        for t in s.tests:
            if t["status"] not in ("passed", "not handed in", "not attempted"):
                exercise = "the whole file" if t["says"].get("quantity") == points.READING else t["exercise"]
                key = t["lesson"], exercise, cause(t), t["hint"] if t["status"] == "not yet" else ""
                group = groups.setdefault(key, {"students": {}, "other": set()})
                group["students"][s.student] = s
                group["other"] |= {s.student} if t["kind"] == "hidden" else set()
    rows = [{"lesson": lesson, "exercise": exercise, "cause": why, "hint": hint, "other": len(group["other"]),
             "students": [*group["students"].values()]} for (lesson, exercise, why, hint), group in groups.items()]
    return sorted(rows, key=lambda row: -len(row["students"]))


def histogram(scores, maximum):
    """{"width" of a bar [points], "median", "bars", "ticks"}, with places in % of the picture's width.

    The lower edge belongs to a bar, and the maximum to the last one.
    """
    width = next(digit * 10 ** power for power in range(9) for digit in (1, 2, 5) if maximum <= MOST_BARS * digit * 10 ** power)
    bars = max(1, -int(-maximum // width))
    counts = [0] * bars
    for score in scores:
        counts[min(int(score // width), bars - 1)] += 1

    def place(x):
        return f"{3.0 + 94.0 * x / (bars * width):.3f}"
    every = -(-bars // 10) * width
    middle = median(scores)
    return {"width": width, "median": (place(middle), middle), "right": middle > 0.5 * bars * width,
            "bars": [{"x": place(n * width), "wide": f"{94.0 / bars:.3f}", "count": count, "high": round(130.0 * count / max(counts), 1)}
                     for n, count in enumerate(counts)],
            "ticks": [(place(x), x) for x in range(0, bars * width + 1, every)]}


def lessons_of(one):
    """What a student reads, lesson by lesson: exercises with their points, and remarks on what was tried and did not pass.

    Tests that failed in the very same words share a remark: a file that does not load says so once.
    """
    theirs = grouped(one.tests, "lesson")
    for lesson, account in one.accounts.items():
        exercises, remarks = {}, {}
        for t in theirs.get(lesson, ()):
            exercises.setdefault(t["exercise"], []).append(t)
            if t["status"] not in ("passed", "not attempted", "not handed in"):
                remarks.setdefault((t["kind"], t["hint"], json.dumps(t["says"])), []).append(t)
        yield {"name": lesson, "account": account, "remarks": [*remarks.values()], "exercises": [
            {"number": exercise, "function": tests[0]["function"], "earned": sum(t["earned"] for t in tests),
             "points": sum(t["points"] for t in tests), "word": word({t["status"] for t in tests})} for exercise, tests in exercises.items()]}


def word(states):
    """(words, kind) for an exercise whose tests ended in these states."""
    if states == {"passed"}:
        return "right", "agrees"
    if states == {"not attempted"}:
        return "not attempted", "open"
    return ("partly right" if "passed" in states else "not yet"), "departs"


# ---------------------------------------------------------------------------------------------- for other programs

def gradescope(result, settings, terms):
    """Gradescope's results.json for a result, as a dict."""
    return sheet_for_gradescope(sheet(result, settings, terms), terms)


def sheet_for_gradescope(one, terms):
    """The same for a Sheet: a row for every test of the manifest, whatever happened to it.

    score is after the late penalty and beats the sum of the rows.  *Source:* Gradescope, Autograder Specifications.
    """
    result = one.result
    warning = result["no_grade"] and f"NOT A GRADE ({line(result['no_grade'])})"
    lines = [warning, clean(lateness(one, terms)), *map(line, one.problems)]
    return {"score": round(one.total("score"), 6), "visibility": "visible", "stdout_visibility": "hidden",
            "output": "\n".join(filter(None, lines)), "output_format": "text", "tests": [row_of(t, warning) for t in one.tests]}


def row_of(test, warning):
    said = [f"{name}: {clean(test['says'][name])}" for name in SHOWN if name in test["says"]]
    if test["status"] == "not yet":
        said = [INPUTS[test["kind"]], *said, f"hint: {clean(test['hint'])}"]
    passed = test["status"] == "passed"
    return {"score": test["earned"], "max_score": test["points"], "status": "passed" if passed else "failed", "number": test["exercise"],
            "name": f"{warning}: " * bool(warning) + f"{test['function']}: {claim(test['test'])}", "output": "" if passed else "\n".join(said),
            "output_format": "text", "visibility": "visible", "tags": [test["lesson"]]}


def table(sheets, failed, settings, people, terms):
    """grades.csv as text: a row for each student and lesson.

    No scores where the grader failed; 0 for who is on the class list and handed nothing in.
    """
    graded, warning = {s.student: s for s in sheets}, warning_of(sheets)
    maxima = {lesson: sum(row[4] for row in settings.manifest if row[0] == lesson) for lesson in settings.lessons}
    text = io.StringIO()
    rows = csv.writer(text)
    rows.writerow(COLUMNS)
    for student in sorted({*graded, *failed, *people}):
        one, person = graded.get(student), people.get(student) or submissions.Person(student)
        no_grade = one.result["no_grade"] if one else warning
        problems = [failed[student]] if student in failed else one.problems if one else []
        stranger = ["not on the class list"] * (bool(people) and student not in people)
        for lesson in settings.lessons:
            account = one.accounts[lesson] if one else Account(False, 0.0, 0.0, 0.0, maxima[lesson])
            scores = ("", "", "") if student in failed else map(number, (account.raw, account.penalty, account.score))
            rows.writerow([cell(f"{lesson} (NOT A GRADE: {no_grade})" if no_grade else lesson), terms.due,
                           cell(one.result["timestamp"] if account.handed_in else ""), cell(student), cell(person.last_name),
                           cell(person.first_name), cell(person.email), *scores, number(account.maximum),
                           cell(" | ".join([*stranger, *problems]))])
    return text.getvalue()


def warning_of(sheets):
    """Why what the class got are no grades; an empty string when they are."""
    return "; ".join(sorted({s.result["no_grade"] for s in sheets} - {""}))


# ---------------------------------------------------------------------------------------------- files

@lru_cache(maxsize=1)
def templates():
    """The pages' templates; what they show is cleaned and escaped, and their style is in them."""
    pages = Environment(loader=FileSystemLoader(HERE / "templates"), autoescape=True, finalize=clean, trim_blocks=True, lstrip_blocks=True)
    pages.filters.update(line=line, breakable=breakable, number=number, claim=claim, many=many)
    style = Markup("".join(css.read_text(encoding="utf-8") for css in STYLES))
    pages.globals.update(style=style, SHOWN=SHOWN, INPUTS=INPUTS, READING=points.READING, MOST_NAMED=MOST_NAMED)
    pages.globals.update(mean=mean, median=median)
    return pages


def write(out, results, failed, settings, people, terms, run=Run()):
    """Pages, CSV and JSON in a folder; the path of the front page.

    results: as marking.mark gives them · failed: {student: why there are no points} · people: the class list, or {}.
    """
    sheets = sorted((sheet(r, settings, terms, people.get(r["student"])) for r in results), key=lambda s: s.student)
    for folder in ("students", "gradescope"):
        (out / folder).mkdir(parents=True, exist_ok=True)
    for student in {*failed, *people} - {s.student for s in sheets}:                     # what an earlier run found is not so any more
        (out / "students" / f"{file_name(student)}.html").unlink(missing_ok=True)
        (out / "gradescope" / f"{file_name(student)}.json").unlink(missing_ok=True)
    for s in sheets:                                                   # one by one: many would fill the memory
        write_whole(out / "students" / f"{s.file}.html", student_page(s, terms))
        write_whole(out / "gradescope" / f"{s.file}.json", as_json(sheet_for_gradescope(s, terms)))
    write_whole(out / "grades.csv", table(sheets, failed, settings, people, terms))
    write_whole(out / "index.html", class_page(sheets, failed, settings, people, terms, run))
    return out / "index.html"


def student_page(one, terms):
    """One student's page; it leads nowhere, so that it can be handed out."""
    return templates().get_template("student.html").render(s=one, lessons=lessons_of(one), lateness=lateness(one, terms),
                                                           warning=one.result["no_grade"])


def class_page(sheets, failed, settings, people, terms, run):
    """The instructor's page."""
    found = {s.student: looks(s, run.alike) for s in sheets}
    absent = [people[student] for student in sorted({*people} - {s.student for s in sheets} - {*failed})]
    picture = histogram([s.total("score") for s in sheets], sum(row[4] for row in settings.manifest)) if sheets else None
    return templates().get_template("class.html").render(
        sheets=sheets, failed=sorted(failed.items()), run=run, looks=found, settings=settings,
        seconds=[s.result["seconds"] for s in sheets],
        watched=to_look_into(sheets, found), people=people, terms=terms, absent=absent, picture=picture,
        lessons=by_lesson(sheets, settings), hardest=hardest(sheets, settings), causes=causes(sheets), warning=warning_of(sheets))


def as_json(value):
    return json.dumps(value, ensure_ascii=False, allow_nan=False, indent=1)


def write_whole(path, text):
    """Write a text so that a reader never sees half of it."""
    draft = path.with_name(f"{path.name}.part")
    draft.write_bytes(text.encode())
    draft.replace(path)


def show_intake(console, intake):
    """Print what is wrong with the files, before the grading begins."""
    problems = [(one.student, problem) for one in intake.submissions for problem in one.problems]
    for student, problem in problems[:MOST_TOLD]:
        console.print(f"[bold]{escape(line(student))}[/bold]: {escape(line(problem))}", highlight=False, soft_wrap=True)
    for told in intake.overlooked[:MOST_TOLD]:
        console.print(escape(line(told)), highlight=False, soft_wrap=True)
    more = len(problems[MOST_TOLD:]) + len(intake.overlooked[MOST_TOLD:])
    if more:
        console.print(f"… and {more} more, which are on the page of the class")


def show(console, results, failed, settings):
    """Print the class in short: points by lesson before late penalties, the hardest exercises, and who is not graded."""
    sheets = [sheet(r, settings, Terms("", 0.0)) for r in results]
    summary = Table(header_style="bold", box=None, pad_edge=False)
    for column in ("lesson", "handed in", "mean", "median", "of"):
        summary.add_column(column, justify="left" if column == "lesson" else "right")
    for lesson, accounts in by_lesson(sheets, settings):
        raw = [a.raw for a in accounts]
        middle = [f"{mean(raw):.1f}", f"{median(raw):.1f}"] if raw else ["–", "–"]
        summary.add_row(lesson, str(len(raw)), *middle, number(sum(row[4] for row in settings.manifest if row[0] == lesson)))
    console.print(summary)
    rows = hardest(sheets, settings)[:3]
    if rows:
        console.print("Hardest: " + ", ".join(f"{r['exercise']} {r['function']} ({r['share']:.0%} of its points)" for r in rows), highlight=False)
    if warning_of(sheets):
        console.print(f"NOT A GRADE: {escape(line(warning_of(sheets)))}", style="bold red", highlight=False)
    for student, why in sorted(failed.items()):
        who = f"[bold red]Not graded: {escape(line(student))}[/bold red], who has no points and no zero"
        console.print(f"{who}: {escape(line(why))}", highlight=False, soft_wrap=True)
