"""The points as Canvas and Moodle import them: `canvas.csv` and `moodle.csv`, one column for each lesson.

Both find a student by what the class list says, so a student who is not on it is left out; so is one whom the grader
could not grade, because an import would write an empty grade over an old one.
"""

import csv
import io
from collections import Counter
from typing import NamedTuple

from . import marks, points
from .texts import cell, line, number

DIGITS = 4                   # decimals of a point: Canvas shows two, and reads no exponents
SHOWN = 10                   # students named in a sentence [-]


class Entry(NamedTuple):
    """What one student of the class list gets."""
    person: tuple            # classlist.Person
    scores: dict             # {assignment: points after late penalties}
    remarks: dict            # {assignment: feedback}


class System(NamedTuple):
    """One system that imports grades."""
    file: str
    needs: tuple             # columns of the class list by which it finds a student
    mixed: bool              # whether it may find each student by another of them
    rows: object             # (entries, {assignment: maximum}) → rows of the file


class Gap(NamedTuple):
    """What the class list lacks for one file."""
    sentence: str
    whole: bool              # for the whole class, so that there is no file


# ---------------------------------------------------------------------------------------------- formats

def canvas(entries, maxima):
    """Return the rows of Canvas's gradebook import.

    *Source:* Canvas, `lib/gradebook_importer.rb`: columns of the student up to Section, then assignments; a row of
    points possible.  A student is found by ID, else by SIS User ID, else by SIS Login ID, else by name.
    """
    yield ["Student", "ID", "SIS User ID", "SIS Login ID", "Section", *maxima]
    yield ["    Points Possible", "", "", "", "", *maxima.values()]
    for one in entries:
        p = one.person
        name = ", ".join(filter(None, (p.last_name, p.first_name))) or p.student_id
        yield [name, p.canvas_id, p.sis_id, p.login, p.section, *(one.scores[a] for a in maxima)]


def moodle(entries, maxima):
    """Return the rows for Moodle's grade import, which asks which column is what.

    *Source:* Moodle, `grade/import/csv/tests/load_data_test.php`: columns of the student, then grades, each with its
    feedback.  Moodle empties grades that are imported without their feedback, or feedback without grades.
    """
    heads = [head for a in maxima for head in (a, f"Feedback: {a}")]
    yield ["First name", "Last name", "ID number", "Username", "Email address", *heads]
    for one in entries:
        p = one.person
        grades = [x for a in maxima for x in (one.scores[a], one.remarks[a])]
        yield [p.first_name, p.last_name, p.sis_id, p.login, p.email, *grades]


SYSTEMS = (
    System("canvas.csv", ("canvas_id", "sis_id", "login"), True, canvas),
    System("moodle.csv", ("email", "sis_id", "login"), False, moodle),
)


# ---------------------------------------------------------------------------------------------- the class

def entries_of(sheets, failed, settings, people):
    """Return ([Entry, …] in the order of the class list, {assignment: maximum}).  Who handed nothing in has 0."""
    graded = {s.student: s for s in sheets}
    maxima = {place[0]: most for place, most in marks.maxima_of(settings).items() if place[0] and not place[1]}
    if any(marks.TOTAL in s.hands for s in sheets):
        maxima[marks.BY_HAND] = 0
    return [entry(person, graded.get(student), maxima) for student, person in people.items()
            if student not in failed], maxima


def entry(person, one, maxima):
    """Return the Entry of a person.  one: the Sheet, or None."""
    scores, remarks = dict.fromkeys(maxima, 0), dict.fromkeys(maxima, "" if one else "not handed in")
    for lesson, account in one.accounts.items() if one else ():
        told = [marks.words(hand) for hand in one.hands_in(lesson)]
        late = [f"{number(account.penalty)} off for being late"] * bool(account.penalty)
        scores[lesson] = account.score
        why = "; ".join(map(line, one.problems))
        missing = f"no file of this lesson that can be read: {why}" if why else "not handed in"
        remarks[lesson] = " | ".join([missing] * (not account.handed_in) + unloadable(one, lesson) + late + told)
    if marks.BY_HAND in maxima:
        hand = one.hands.get(marks.TOTAL) if one else None
        scores[marks.BY_HAND] = hand.points - hand.before if hand else 0
        remarks[marks.BY_HAND] = marks.words(hand) if hand else ""
    return Entry(person, scores, remarks)


def unloadable(one, lesson):
    """Return why the file of a lesson earns nothing, as a list of one sentence; empty if it loads."""
    said = [t["says"] for t in one.tests if t["lesson"] == lesson and t["says"].get("quantity") == points.READING]
    return [f"{lesson}.py does not load: {said[0]['got']}"] if said else []


def write(put, sheets, failed, settings, people):
    """Call put(file, its text, or None for no file) for every system."""
    entries, maxima = entries_of(sheets, failed, settings, people)
    for system in SYSTEMS:
        _, students = found(system, people)
        theirs = [one for one in entries if one.person.student_id in students]
        put(system.file, as_csv(system.rows(theirs, maxima)) if theirs else None)


def files(people):
    """Return the names of the files that are written for this class list."""
    return [system.file for system in SYSTEMS if found(system, people)[1]]


def gaps(people):
    """Return [Gap, …] of the files that the class list is not enough for."""
    told = []
    for system in SYSTEMS:
        columns, students = found(system, people)
        lacking = [student for student in people if student not in students]
        if len(lacking) == len(people):
            told.append(Gap(f"{system.file} needs a class list with {' or '.join(system.needs)}", True))
        elif lacking:
            more = f" and {len(lacking) - SHOWN} more" if len(lacking) > SHOWN else ""
            names = ", ".join(map(line, lacking[:SHOWN]))
            why = f"no {' or '.join(columns)} of their own on the class list"
            told.append(Gap(f"{system.file} lacks {names}{more}: {why}", False))
    return told


def found(system, people):
    """Return (the columns by which a system finds these people, the students whom it finds).

    A system that cannot mix columns uses the one that most have.  An id that two share finds the wrong student.
    """
    counts = {name: Counter(getattr(person, name) for person in people.values()) for name in system.needs}
    columns = system.needs if system.mixed else (min(system.needs, key=lambda name: counts[name][""]),)

    def alone(person):
        ids = [(name, value) for name in columns if (value := getattr(person, name))]
        return bool(ids) and all(counts[name][value] == 1 for name, value in ids)
    return columns, {student for student, person in people.items() if alone(person)}


def as_csv(rows):
    """Return rows as the text of a CSV without formulas."""
    text = io.StringIO()
    csv.writer(text).writerows([cell(x) if isinstance(x, str) else decimal(x) for x in row] for row in rows)
    return text.getvalue()


def decimal(x):
    """Return a number without an exponent and without needless zeros."""
    shown = f"{x:.{DIGITS}f}".rstrip("0").rstrip(".")
    return "0" if shown == "-0" else shown
