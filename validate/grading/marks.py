"""Points by hand: `marks.csv` in the class folder changes the points of an exercise, of a lesson, or the total.

The file lies beside the submissions, so no run overwrites it.  Its points are applied when the pages are written:
nothing is graded again, and the results of the tests stay as they were found.
"""

import csv
import io
import math
from pathlib import Path
from typing import NamedTuple

from solutions.checks import BadInput
from validate.subject import modules

from . import remote, submissions
from .classlist import identity
from .texts import line, many, number

COLUMNS = ("student_id", "exercise", "points", "comment", "how")
NEEDED = COLUMNS[:3]
WAYS = {"": False, "set": False, "add": True}
TOTAL = ("", "")             # the place of the total, after late penalties
BY_HAND = "by hand"          # the assignment of what a total by hand adds
SHOWN = 10                   # students named on the screen [-]


class Mark(NamedTuple):
    """One line of marks.csv."""
    place: tuple             # (lesson, exercise), (lesson, "") or TOTAL
    points: float
    adds: bool               # to the other points, and does not replace them
    comment: str


class Hand(NamedTuple):
    """The points of a place without and with those given by hand."""
    name: str                # of the place
    before: float
    points: float
    comment: str


# ---------------------------------------------------------------------------------------------- the file

def read(folder, settings, students, tell=print):
    """Return {student: his marks, exercises first, then lessons, then the total} from the file in a class folder.

    students: the ids of all submissions and of the class list.  Lines of lessons that are not graded now are left out,
    and tell is called with their number.  Raises BadInput for the first line that is wrong.
    """
    path, found, seen, others, left = Path(folder) / submissions.MARKS, {}, set(), names_of_others(settings), 0
    if not path.is_file():
        return {}
    maxima = maxima_of(settings)
    for where, row, comma in rows_of(path):
        if row["exercise"] in others:
            left += 1
            continue
        student, place = identity(row["student_id"]), place_of(row["exercise"], settings, where)
        if student not in students:
            raise BadInput(f"student {student!r} in {where}", "not known",
                           "write the id of a submission or of the class list")
        adds = way_of(row["how"], where)
        mark = Mark(place, points_of(row["points"], comma, adds, maxima[place], where), adds, row["comment"])
        if not adds and (student, place) in seen:
            raise BadInput(f"{name_of(place)} of {student!r} in {where}", "set a second time", "keep one of the lines")
        seen |= {(student, place)} - ({(student, place)} if adds else set())
        found.setdefault(student, []).append(mark)
    if left:
        tell(f"{submissions.MARKS}: {many(left, 'line')} of lessons that are not graded in this run, left out")
    order = [*maxima]
    return {student: tuple(sorted(marks, key=lambda m: order.index(m.place))) for student, marks in found.items()}


def names_of_others(settings):
    """Return the lessons that are not graded, and their exercises by number and by function."""
    others = [lesson for lesson in modules.lesson_names() if lesson not in settings.lessons]
    exercises = [text for lesson in others for pair in remote.exercises(lesson).items() for text in pair]
    graded = {text for row in settings.manifest for text in row[1:3]}
    return {*others, *exercises} - graded


def maxima_of(settings):
    """Return {place: what there is to earn}: exercises first, then lessons, then the total."""
    exercises, lessons = {}, dict.fromkeys(((lesson, "") for lesson in settings.lessons), 0)
    for row in settings.manifest:
        exercises[row[0], row[1]] = exercises.get((row[0], row[1]), 0) + row[4]
        lessons[row[0], ""] += row[4]
    return {**exercises, **lessons, TOTAL: sum(lessons.values())}


def rows_of(path):
    """Generate (where, {column: text}, whether numbers may have a decimal comma) of the lines that are not empty."""
    try:
        text = path.read_bytes().decode("utf-8-sig")
        head = text.partition("\n")[0]
        separator = max(",;\t", key=head.count)    # where the comma is decimal, spreadsheets write semicolons
        reader = csv.reader(io.StringIO(text, newline=""), delimiter=separator, strict=True)
        columns = [cell.strip().lower() for cell in next(reader, ())]
        lines = [(reader.line_num, [cell.strip() for cell in cells]) for cells in reader]
    except (OSError, UnicodeDecodeError, csv.Error) as e:
        why = e.strerror if isinstance(e, OSError) else "no text in UTF-8" if isinstance(e, UnicodeDecodeError) else e
        raise BadInput(f"file {str(path)!r}", f"not readable ({why})", "save it as a CSV file in UTF-8") from None
    wrong = {*columns} - {*COLUMNS} or {*NEEDED} - {*columns}
    if wrong or len({*columns}) < len(columns):
        raise BadInput(f"the first line of {str(path)!r}", ", ".join(columns) or "empty",
                       f"give it the columns {', '.join(COLUMNS)}; the last two may be missing")
    for n, cells in lines:
        where = f"line {n} of {str(path)!r}"
        if len(cells) > len(columns):
            raise BadInput(where, "of more cells than there are columns", "write a comment that has commas in quotes")
        if any(cells):
            yield where, {**dict.fromkeys(COLUMNS, ""), **dict(zip(columns, cells, strict=False))}, separator == ";"


def place_of(text, settings, where):
    """Return the place that a text names: an exercise by its number or its function, a lesson, or nothing at all."""
    if text in ("", *settings.lessons):
        return text, ""
    found = {(row[0], row[1]) for row in settings.manifest if text in row[1:3]}
    if len(found) != 1:
        what = "in more than one lesson" if found else "not graded"
        raise BadInput(f"exercise {text!r} in {where}", what,
                       "write the number of a graded exercise, its function, a lesson, or nothing for the total")
    return found.pop()


def way_of(text, where):
    """Return whether points add to the others."""
    if text.lower() not in WAYS:
        raise BadInput(f"how {text!r} in {where}", "unknown", "write set, add, or nothing for set")
    return WAYS[text.lower()]


def points_of(text, comma, adds, maximum, where):
    """Return points as a number: 0 to the maximum if they are set, and no more than it up or down if they are added."""
    try:
        points = float(text.replace(",", ".") if comma else text)
    except ValueError:
        points = math.nan
    if not math.isfinite(points):
        raise BadInput(f"points {text!r} in {where}", "no number", "write one; 0 with how = add leaves a comment only")
    least = -maximum if adds else 0
    if not least <= points <= maximum:
        remedy = f"write {number(least)} to {number(maximum)}" + "; how = add may go above the maximum" * (not adds)
        raise BadInput(f"points {text!r} in {where}", "too many" if points > 0 else "too few", remedy)
    return points


def name_of(place):
    """Return the words for a place."""
    return place[1] or place[0] or "the total"


# ---------------------------------------------------------------------------------------------- the points

def by_hand(tests, marks):
    """Return {place: Hand} of one student's exercises and lessons that have marks."""
    hands = {}
    for place in dict.fromkeys(mark.place for mark in marks if mark.place != TOTAL):
        theirs = [t for t in tests if t["lesson"] == place[0] and place[1] in ("", t["exercise"])]
        hands[place] = hand(place, earned(theirs, hands), marks)
    return hands


def hand(place, before, marks):
    """Return the Hand of a place.  Its points are those that are set, or those before, and those that are added."""
    here = [mark for mark in marks if mark.place == place]
    first = next((mark.points for mark in here if not mark.adds), before)
    points = max(0.0, first + sum(mark.points for mark in here if mark.adds))
    return Hand(name_of(place), before, points, "; ".join(mark.comment for mark in here if mark.comment))


def earned(tests, hands):
    """Return the points of a lesson's tests, or of some of them, before any late penalty and with those by hand."""
    exercises = {}
    for t in tests:
        place = t["lesson"], t["exercise"]
        exercises[place] = exercises.get(place, 0) + t["earned"]
    whole = {(lesson, "") for lesson, _ in exercises} & {*hands}
    return hands[whole.pop()].points if whole else sum(
        hands[place].points if place in hands else points for place, points in exercises.items())


def words(one):
    """Return a Hand in words."""
    comment = f": {one.comment}" if one.comment else ""
    if one.points == one.before:
        return f"{one.name}{comment}" if comment else f"{one.name}: {number(one.points)} by hand, as before"
    return f"{one.name}: {number(one.points)} by hand, and {number(one.before)} without{comment}"


def told(marks):
    """Return the sentence for the screen about the file."""
    names = [*map(line, sorted(marks)[:SHOWN]), *([f"{len(marks) - SHOWN} more"] if len(marks) > SHOWN else [])]
    lines = sum(map(len, marks.values()))
    return f"{submissions.MARKS}: {many(lines, 'line')} with points by hand, for {', '.join(names)}"
