"""Mark one submission: the same tests as everyone's, with the student's code in the sandbox and the judgement out here.

A manifest fixes what there is to earn.  A test that did not pass, for whatever reason, earns nothing of its points and touches no other.
"""

import hashlib
import time
from typing import NamedTuple

from validate import binding

from . import box, points, remote

BUDGET = 60.0                # of one lesson of one submission, all calls together [s]: the worked one takes 1
PRINTED = 2000               # of what a student's code prints, so much is shown [characters]


class Settings(NamedTuple):
    """How a class is graded: the same for every submission."""
    lessons: tuple
    seed: str                # secret
    manifest: tuple          # ((lesson, exercise, function, test, points, hint), …)
    code: str                # digest of tests, solutions and grader

    def digest(self, submission):
        """Changes when a submission has to be graded again."""
        return hashlib.sha256(repr((self, submission.digest(), box.no_sandbox_because())).encode()).hexdigest()


def settings(lessons, seed):
    """The Settings for these lessons."""
    return Settings(tuple(lessons), seed, manifest(lessons), code_digest())


def manifest(lessons):
    """Every test that gives points, in the order of the lessons."""
    rows = []
    for lesson in lessons:
        functions = remote.exercises(lesson)
        rows += [(lesson, o.exercise, functions[o.exercise], o.test, o.points, o.hint) for o in points.grade(lesson, None, collect=True)]
    return tuple(sorted(rows, key=lambda row: (lessons.index(row[0]), [int(n) for n in row[1].split(".")])))


def code_digest():
    """Fingerprint of everything that decides about points."""
    return binding.fingerprint({*binding.SOLUTIONS.glob("*.py"), *points.TESTS.glob("*.py"), *(points.TESTS / "grading").glob("*.py")})


def mark(submission, settings):
    """The result of one submission, in types that JSON knows.  Raises RuntimeError when the grader itself fails: that is never a zero."""
    began, found, printed = time.monotonic(), {}, {}
    for lesson in settings.lessons:
        if lesson in submission.files:
            outcomes, printed[lesson] = mark_lesson(lesson, submission.files[lesson], settings.seed)
            found.update({(lesson, kind, o.test): o for kind, o in outcomes})
    tests = [verdict(row, found, row[0] in submission.files) for row in settings.manifest]
    return {"student": submission.student, "problems": list(submission.problems), "timestamp": submission.timestamp,
            "handed_in": sorted(submission.files), "tests": tests, "printed": printed, "seconds": round(time.monotonic() - began, 2),
            "no_grade": box.no_sandbox_because(), "digest": settings.digest(submission)}


def mark_lesson(lesson, text, seed):
    """[(visible or hidden, Outcome), …] of one file, and what it printed in the visible tests."""
    place = remote.box_of(lesson, text, BUDGET)
    try:
        place.open()
        subject = remote.lesson_in(place, lesson)
        outcomes = [("visible", o) for o in points.grade(lesson, subject, seed=points.PUBLIC)]
        printed = readable(place.printed.decode(errors="replace"))
        return outcomes + [("hidden", o) for o in points.grade(lesson, subject, seed=seed)], printed
    finally:
        place.close()


def verdict(row, found, handed_in):
    """One test of the manifest: passed when it passed with the public inputs and with the secret ones."""
    lesson, exercise, function, test, worth, hint = row
    base = {"lesson": lesson, "exercise": exercise, "function": function, "test": test, "points": worth, "hint": hint}
    for kind in ("visible", "hidden"):
        o = found.get((lesson, kind, test))
        if o is None:
            why = "it was not run" if handed_in else f"{lesson}.py was not handed in"
            return {**base, "status": "not run" if handed_in else "not handed in", "earned": 0, "kind": kind, "says": {"got": why}}
        if o.status != "passed":
            return {**base, "status": o.status, "earned": 0, "kind": kind, "hint": readable(o.hint), "says": says(o, kind)}
    return {**base, "status": "passed", "earned": worth, "kind": "", "says": {}}


def says(o, kind):
    """What a student may read about a test.  With secret inputs only the size of the error is told, nothing that they could be read off."""
    told = {"quantity": o.quantity, "given": o.given, "expected": o.expected, "got": o.got, "tolerance": o.tolerance}
    if kind == "hidden":
        told = {"quantity": o.quantity, "got": o.error or o.status, "tolerance": o.tolerance}
    return {name: readable(text) for name, text in told.items() if text}


def readable(text):
    """Text from a student's program, fit to be shown: control and format characters spelt out, and not too much of it."""
    shown = "".join(c if c == "\n" or (c.isprintable() and ord(c) not in range(0xD800, 0xE000)) else f"\\x{ord(c):02x}" for c in text[:PRINTED])
    return shown + (" …" if len(text) > PRINTED else "")


def course_order(lesson):
    """Place of a lesson in the course: the number of its exercises."""
    return int(next(iter(remote.exercises(lesson))).partition(".")[0])
