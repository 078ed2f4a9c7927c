"""Mark one submission: the same tests as everyone's, with the student's code in the sandbox and the judgement out here.

A manifest fixes what there is to earn.  A test that did not pass, for whatever reason, earns nothing of its points and touches no other.
"""

import contextlib
import hashlib
import re
import time
from typing import NamedTuple

from validate import modules

from . import children, expect, points, remote, sandbox, watch
from .box import CROWDED
from .submissions import spelt_out

BUDGET = 60.0                # of one lesson of one submission, all calls together [s]: the worked one takes 1
MEMORY = 2 << 30             # so much may the grader's own process grow by what a student's code hands back, which broadcasts [bytes]
OTHER_NUMBERS, NOT_REFUSED, NO_ANSWER = "not an array of finite numbers of the right shape", "not the error that the docstring asks for", "an error, or no answer"
WORDS = (*expect.OFF, OTHER_NUMBERS, NOT_REFUSED, NO_ANSWER)
PRINTED = 2000               # of what a student's code prints, so much is shown [characters]


class Settings(NamedTuple):
    """How a class is graded: the same for every submission."""
    lessons: tuple
    seed: str                # secret
    manifest: tuple          # ((lesson, exercise, function, test, points, hint), …)
    code: str                # digest of tests, solutions and grader

    def digest(self, submission):
        """Changes when a submission has to be graded again."""
        return hashlib.sha256(repr((self, submission.digest(), sandbox.unavailable())).encode()).hexdigest()


def settings(lessons, seed):
    """The Settings for these lessons."""
    return Settings(tuple(lessons), seed, manifest(lessons), code_digest(lessons))


def manifest(lessons):
    """Every test that gives points, in the order of the lessons."""
    rows = []
    for lesson in lessons:
        functions = remote.exercises(lesson)
        rows += [(lesson, o.exercise, functions[o.exercise], o.test, o.points, o.hint) for o in points.grade(lesson, None, collect=True)]
    return tuple(sorted(rows, key=lambda row: (lessons.index(row[0]), [int(n) for n in row[1].split(".")])))


def code_digest(lessons=None):
    """Fingerprint of everything that decides about points in these lessons, or in all of them; the same wherever the workbook lies."""
    grader = ("box", "calls", "expect", "marking", "meter", "plugin", "points", "remote", "sandbox", "shipping", "watch", "wire", "worker")
    files = {*modules.SOLUTIONS.rglob("*.py"), *(points.LESSONS / f"test_{lesson}.py" for lesson in lessons or modules.lesson_names()),
             *(points.TESTS / "grading" / f"{name}.py" for name in grader), *(modules.ROOT / "validate" / f"{name}.py" for name in ("modules", "generate", "loading"))}
    return hashlib.sha256(b"".join(file.name.encode() + file.read_bytes() for file in sorted(files))).hexdigest()[:12]


def patience(settings):
    """A grading process that takes longer hangs [s]: each call has several times its own time, and the tests as much again for their own work."""
    return 2.0 * CROWDED * BUDGET * len(settings.lessons)


def mark(submission, settings):
    """The result of one submission, in types that JSON knows.  Raises RuntimeError when the grader itself fails: that is never a zero."""
    began, found, printed, again, watched = time.monotonic(), {}, {}, [], {}
    for lesson in settings.lessons:
        if lesson in submission.files:
            with bounded():
                outcomes, printed[lesson], late, seen = mark_lesson(lesson, submission.files[lesson], settings.seed)
            watched[lesson] = sorted(seen & {*watch.SENTENCES}) + watch.in_text(submission.files[lesson])
            found.update({(lesson, kind, o.test): o for kind, o in outcomes})
            again += [lesson] * late
    tests = [verdict(row, found, row[0] in submission.files) for row in settings.manifest]
    return {"student": submission.student, "problems": list(submission.problems), "timestamp": submission.timestamp,
            "handed_in": sorted(submission.files), "tests": tests, "printed": printed, "seconds": round(time.monotonic() - began, 2),
            "watched": watched, "again": again, "no_grade": sandbox.unavailable(), "digest": settings.digest(submission)}


def again(submission, settings, first):
    """The result of a second try.  Only the lessons are marked again whose time was up in the first."""
    second = mark(submission._replace(files={lesson: submission.files[lesson] for lesson in first["again"]}), settings)
    tests = {(t["lesson"], t["test"]): t for t in second["tests"] if t["lesson"] in first["again"]}
    return {**first, "tests": [tests.get((t["lesson"], t["test"]), t) for t in first["tests"]], "printed": {**first["printed"], **second["printed"]},
            "watched": {**first["watched"], **second["watched"]},
            "seconds": round(first["seconds"] + second["seconds"], 2), "again": []}


def mark_lesson(lesson, text, seed):
    """([(visible or hidden, Outcome), …] of one file, what it printed in the visible tests, whether the time was up, what was seen beside)."""
    place = remote.box_of(lesson, text, BUDGET)
    try:
        place.open()
        if place.broken:
            where = f" ({place.broken.where})" if getattr(place.broken, "where", "") else ""
            unread = [("visible", points.unreadable(o, place.broken, where)) for o in points.grade(lesson, None, collect=True)]
            return unread, readable(place.printed.decode(errors="replace")), place.late, place.seen
        subject = remote.lesson_in(place, lesson)
        outcomes = [("visible", o) for o in points.grade(lesson, subject, seed=points.PUBLIC)]
        place.stop()                                                   # now all is here that was printed
        printed = readable(place.printed.decode(errors="replace"))
        passed = {o.test for _, o in outcomes if o.status == "passed"}
        if passed:                                                     # the others have lost their points already
            place.open()                                               # a new worker: what the old one has seen, or what was left in it, is gone
            place.secret = True
            outcomes += [("hidden", o) for o in points.grade(lesson, subject, lambda exercise, test: test in passed, seed)]
        if place.failed:                                               # pytest has caught it: it must not become a zero
            raise place.failed
        return outcomes, printed, place.late or any(o.quantity == points.DURATION for _, o in outcomes), place.seen
    finally:
        place.close()


@contextlib.contextmanager
def bounded():
    """Let this process have only so much more memory; beyond, NumPy raises MemoryError in the test that asked for it."""
    before = children.bound(MEMORY)
    try:
        yield
    finally:
        if before:
            import resource
            resource.setrlimit(resource.RLIMIT_AS, before)


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
            told = {"status": "not yet"} if kind == "hidden" else {"status": o.status, "hint": readable(o.hint)}       # the hint may follow from the error
            return {**base, **told, "earned": 0, "kind": kind, "says": says(o, kind)}
    return {**base, "status": "passed", "earned": worth, "kind": "", "says": {}}


def says(o, kind):
    """What a student may read about a test.  With secret inputs it is what was compared and one of a few words: a program that knows the inputs could
    write them into anything else, a tolerance that follows from its answer or the name of an error."""
    if kind == "hidden":
        return {"quantity": readable(o.quantity), "got": in_a_word(o.error)}
    told = {"quantity": o.quantity, "given": o.given, "expected": o.expected, "got": o.got, "tolerance": o.tolerance}
    return {name: readable(text) for name, text in told.items() if text}


def in_a_word(error):
    """One of WORDS for whatever was wrong."""
    if error in expect.OFF:
        return error
    if error in ("no error", "another error", "another value"):
        return NOT_REFUSED
    return OTHER_NUMBERS if re.match(r"shape |an? |not finite$", error) else NO_ANSWER


def readable(text):
    """Text from a student's program, fit to be shown: control and format characters spelt out, and not too much of it."""
    shown = "\n".join(map(spelt_out, text[:PRINTED].split("\n")))
    return shown + (" …" if len(text) > PRINTED else "")
