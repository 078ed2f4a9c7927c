"""Marking of one submission: the student's code runs in the sandbox, and the tests, the same for all, in this process.

A manifest lists every test with its points.  A test that did not pass, for any reason, earns nothing and affects no
other test.
"""

import contextlib
import hashlib
import re
import time
from pathlib import Path
from typing import NamedTuple

from validate.subject import modules, needs

from . import children, expect, points, remote, watch
from .box import CROWDED
from .classlist import spelt_out

BUDGET = 90.0                # time of one lesson of one submission, all calls together [s]: worked ones take 0.3 to 16
MEMORY = 2 << 30             # growth of the grader's own process, because answers may broadcast to large arrays [bytes]
OTHER_NUMBERS = "not an array of finite numbers of the right shape"
NOT_REFUSED = "not the error that the docstring asks for"
NO_ANSWER = "an error, or no answer"
WORDS = (*expect.OFF, OTHER_NUMBERS, NOT_REFUSED, NO_ANSWER)
PRINTED = 2000               # printed text that is shown [characters]
GRADER = (
    "box",
    "calls",
    "expect",
    "marking",
    "meter",
    "plugin",
    "points",
    "remote",
    "sandbox",
    "shipping",
    "watch",
    "wire",
    "worker",
)


class Settings(NamedTuple):
    """The settings of grading a class, the same for every submission."""
    lessons: tuple
    seed: str                # secret
    manifest: tuple          # ((lesson, exercise, function, test, points, hint), …)
    code: str                # digest of tests, solutions and grader

    def digest(self, submission):
        """Return a digest that changes when the submission has to be graded again."""
        return hashlib.sha256(repr((self, submission.digest())).encode()).hexdigest()


def settings(lessons, seed, worth=None):
    """Return the Settings for these lessons, or for the exercises of worth, {exercise: points or None}."""
    return Settings(tuple(lessons), seed, manifest(lessons, worth), code_digest(lessons))


def manifest(lessons, worth=None):
    """List every test that gives points, in the order of the lessons and exercises.

    worth: {exercise: points or None} of the exercises that are graded; empty for all.  Points that are given are shared
    among the tests of an exercise as its own are.
    """
    rows = []
    for lesson in lessons:
        functions = remote.exercises(lesson)
        for o in points.grade(lesson, None, collect=True):
            rows.append((lesson, o.exercise, functions[o.exercise], o.test, o.points, o.hint))
    if worth:
        rows = [row for row in rows if row[1] in worth]
        own = {exercise: sum(row[4] for row in rows if row[1] == exercise) for exercise in worth}
        rows = [(*row[:4], row[4] if (given := worth[row[1]]) is None else row[4] * given / own[row[1]], row[5])
                for row in rows]
    return tuple(sorted(rows, key=lambda row: (lessons.index(row[0]), [int(n) for n in row[1].split(".")])))


def code_digest(lessons=None):
    """Return a digest of all code that decides about points in these lessons, or in all of them.

    It does not depend on where the workbook lies.
    """
    files = {
        *modules.SOLUTIONS.rglob("*.py"),
        *(points.LESSONS / f"test_{lesson}.py" for lesson in lessons or modules.lesson_names()),
        *(Path(__file__).with_name(f"{name}.py") for name in GRADER),
        *(Path(modules.__file__).with_name(f"{name}.py") for name in ("modules", "generate", "loading")),
    }
    return hashlib.sha256(b"".join(file.name.encode() + file.read_bytes() for file in sorted(files))).hexdigest()[:12]


def patience(settings):
    """Return the time after which a grading process counts as hanging [s].

    Each call may take CROWDED times its own time, and the tests as much again for their own work.
    """
    return 2.0 * CROWDED * BUDGET * len(settings.lessons)


def refused(settings):
    """Return the exercises of which a graded test refuses the worked answer with the secret inputs.

    There should be none.  Such a test would refuse every right answer in the class.
    """
    found = []
    for lesson in settings.lessons:
        graded = {row[3] for row in settings.manifest if row[0] == lesson}
        outcomes = points.grade(lesson, modules.bind(lesson, "solutions"), seed=settings.seed)
        found += [o.exercise for o in outcomes if o.test in graded and o.status != "passed"]
    return [*dict.fromkeys(found)]


def mark(submission, settings):
    """Return the result of one submission, in types of JSON.

    Raises RuntimeError if the grader itself fails, which is never a zero.
    """
    began, found, printed, again, watched = time.monotonic(), {}, {}, [], {}
    for lesson in settings.lessons:
        if lesson in submission.files:
            with bounded():
                graded = {row[3] for row in settings.manifest if row[0] == lesson}
                outcomes, printed[lesson], late, seen = mark_lesson(
                    lesson, submission.files[lesson], settings.seed, graded)
            watched[lesson] = sorted(seen & {*watch.SENTENCES}) + watch.in_text(submission.files[lesson])
            found.update({(lesson, kind, o.test): o for kind, o in outcomes})
            again += [lesson] * late
    tests = [verdict(row, found, row[0] in submission.files) for row in settings.manifest]
    return {
        "student": submission.student,
        "problems": list(submission.problems),
        "timestamp": submission.timestamp,
        "handed_in": sorted(submission.files),
        "tests": tests,
        "printed": printed,
        "seconds": round(time.monotonic() - began, 2),
        "watched": watched,
        "again": again,
        "digest": settings.digest(submission),
    }


def nothing(student, settings):
    """Return the result of a student who handed nothing in."""
    return {
        "student": student,
        "problems": ["nothing was handed in"],
        "timestamp": "",
        "handed_in": [],
        "tests": [verdict(row, {}, False) for row in settings.manifest],
        "printed": {},
        "seconds": 0.0,
        "watched": {},
        "again": [],
        "digest": "",
    }


def again(submission, settings, first):
    """Return the result of a second try, in which only lessons that ran out of time are marked again."""
    second = mark(submission._replace(files={lesson: submission.files[lesson] for lesson in first["again"]}), settings)
    tests = {(t["lesson"], t["test"]): t for t in second["tests"] if t["lesson"] in first["again"]}
    return {
        **first,
        "tests": [tests.get((t["lesson"], t["test"]), t) for t in first["tests"]],
        "printed": {**first["printed"], **second["printed"]},
        "watched": {**first["watched"], **second["watched"]},
        "seconds": round(first["seconds"] + second["seconds"], 2),
        "again": [],
    }


def mark_lesson(lesson, text, seed, graded=None):
    """Mark one file: ([(kind, Outcome), …], printed text, whether the time was up, codes to look into).

    graded: names of the tests that are run; without it all of them.  kind is "visible" or "hidden".  The printed text
    is that of the visible tests only.
    """
    def wanted(exercise, test):
        return graded is None or test in graded

    place = remote.box_of(lesson, text, BUDGET)
    try:
        place.open()
        if place.broken:
            place.stop()                                               # after this its notes are complete
            where = f" ({place.broken.where})" if getattr(place.broken, "where", "") else ""
            tests = points.grade(lesson, None, collect=True)
            unread = [("visible", points.unreadable(o, place.broken, where)) for o in tests]
            return unread, readable(place.printed.decode(errors="replace")), place.late, place.seen
        subject = remote.lesson_in(place, lesson)
        outcomes = [("visible", o) for o in points.grade(lesson, subject, wanted, points.PUBLIC)]
        place.stop()                                                   # after this the printed text is complete
        printed = readable(place.printed.decode(errors="replace"))
        passed = {o.test for _, o in outcomes if o.status == "passed"}
        if passed:                                                     # the others have lost their points already
            place.open()                                               # a new worker, without the state of the old one
            place.secret = True
            hidden = points.grade(lesson, subject, lambda exercise, test: test in passed, seed)
            outcomes += [("hidden", o) for o in hidden]
            place.stop()
        if place.failed:                                               # pytest has caught it; it must not become a zero
            raise place.failed
        late = place.late or any(o.quantity == points.DURATION for _, o in outcomes)
        return outcomes, printed, late, place.seen
    finally:
        place.close()


@contextlib.contextmanager
def bounded():
    """Let this process grow by MEMORY at most; beyond, NumPy raises MemoryError in the test that asked for it."""
    before = children.bound(MEMORY)
    try:
        yield
    finally:
        if before:
            import resource
            resource.setrlimit(resource.RLIMIT_AS, before)


def verdict(row, found, handed_in):
    """Return the verdict on one test: passed if it passed with the public inputs and with the secret ones."""
    lesson, exercise, function, test, worth, hint = row
    base = {"lesson": lesson, "exercise": exercise, "function": function, "test": test, "points": worth, "hint": hint,
            "tells": needs.asks_to_find(exercise)}
    for kind in ("visible", "hidden"):
        o = found.get((lesson, kind, test))
        if o is None:
            status = "not run" if handed_in else "not handed in"
            why = "it was not run" if handed_in else f"{lesson}.py was not handed in"
            return {**base, "status": status, "earned": 0, "kind": kind, "says": {"got": why}}
        if o.status != "passed":
            failed = {"earned": 0, "kind": kind, "says": says(o, kind)}
            if kind == "hidden":                                       # status and hint may follow from secret inputs
                return {**base, "status": "not yet", **failed}
            said = readable(o.hint)
            return {**base, "status": o.status, "hint": said, "tells": base["tells"] and said == hint, **failed}
    return {**base, "status": "passed", "earned": worth, "kind": "", "says": {}}


def says(o, kind):
    """Return the report that a student may read about a test.

    With secret inputs it has only the quantity and one of WORDS.  A program that knows the inputs could write them
    into any other field: a tolerance that depends on its answer, or the name of an error.
    """
    if kind == "hidden":
        return {"quantity": readable(o.quantity), "got": in_a_word(o.error)}
    told = {"quantity": o.quantity, "given": o.given, "expected": o.expected, "got": o.got, "tolerance": o.tolerance}
    return {name: readable(text) for name, text in told.items() if text}


def in_a_word(error):
    """Return the one of WORDS that describes an error."""
    if error in expect.OFF:
        return error
    if error in ("no error", "another error", "another value"):
        return NOT_REFUSED
    return OTHER_NUMBERS if re.match(r"shape |an? |not finite$", error) else NO_ANSWER


def readable(text):
    """Spell out control and format characters in the text of a student's program, and limit its length."""
    shown = "\n".join(map(spelt_out, text[:PRINTED].split("\n")))
    return shown + (" …" if len(text) > PRINTED else "")
