"""Facts about the lessons, read from their files: exercises, points, hours, and the lessons before.

The head of a notebook is the source of a lesson's hours, of the mathematics that it takes for granted, and of the
lessons that it builds on.  The tests compare the hours with an estimate, and the lessons with the calls.
"""

import json
import re
import subprocess
import sys
import tempfile
from collections import defaultdict
from functools import cache
from pathlib import Path
from typing import NamedTuple

import nbformat

from ..run import coverage
from ..stability.examine import all_cases
from ..subject import generate, modules
from ..subject import needs as calls
from ..subject.modules import ROOT, SOLUTIONS

WORDS_PER_MINUTE = 100       # of a text with formulas
MINUTES_PER_OUTPUT = 2.0     # to run a cell, and to look at what it shows
MINUTES_PER_EXERCISE = 5.0   # to read the docstring, to run the check
MINUTES_PER_LINE = 2.0       # of the worked answer: to write and to mend
MINUTES_TO_FIND = 6.0        # the formula of a ★★ exercise


class Exercise(NamedTuple):
    """One numbered function of a lesson."""
    lesson: str
    number: str              # "5.16"
    function: str
    points: float
    hints: tuple             # that its tests give when they fail
    lines: int               # of its worked answer, without comments and blank lines
    uses: tuple              # numbers of the exercises that its answer calls
    stars: str               # ★, ★★ or ★★★

    @property
    def minutes(self):
        """Return an estimate of the minutes."""
        return MINUTES_PER_EXERCISE + MINUTES_PER_LINE * self.lines + MINUTES_TO_FIND * (self.stars != "★")


class Head(NamedTuple):
    """What the table at the beginning of a notebook says."""
    mathematics: str         # and physics, that the lesson takes for granted
    before: str              # the lessons that it builds on, each with a reason
    reading: float           # hours with the notebook, without its exercises
    writing: float           # hours for all exercises

    @property
    def whole(self):
        """Return the hours of the whole lesson."""
        return self.reading + self.writing

    @property
    def numbers(self):
        """Return the numbers of the lessons that it builds on."""
        return frozenset(map(int, re.findall(r"lesson (\d+)", self.before)))


class Lesson(NamedTuple):
    """One lesson."""
    number: int
    name: str
    title: str               # the first words of its notebook, such as "Friction: the force that knows when to stop"
    exercises: tuple[Exercise, ...]
    needs: frozenset         # names of the lessons that it imports, directly or not
    scenes: tuple            # names of its scenes
    cases: int               # stability cases
    words: int               # of its notebook
    outputs: int             # code cells of its notebook that are no check
    head: Head

    @property
    def points(self):
        return sum(one.points for one in self.exercises)

    @property
    def estimate(self):
        """Return (hours to read and run the notebook, hours to write all exercises), by the constants above."""
        reading = self.words / WORDS_PER_MINUTE + self.outputs * MINUTES_PER_OUTPUT
        return reading / 60.0, sum(one.minutes for one in self.exercises) / 60.0

    def hours(self, chosen):
        """Return the hours of a student who does these exercises and reads the corresponding part of the notebook."""
        share = sum(one.minutes for one in chosen) / sum(one.minutes for one in self.exercises)
        return self.head.reading * len(chosen) / len(self.exercises) + self.head.writing * share


@cache
def lessons():
    """Return {name: Lesson}, in the order of the course."""
    cases = defaultdict(int)
    for case in all_cases():
        cases[case.lesson] += 1
    scenes = defaultdict(list)
    for name, path in modules.scene_files().items():
        scenes[path.parent.name].append(name)
    return {name: Lesson(number, name, title(name), exercises_of(name), needs(name), tuple(scenes[name]), cases[name],
                         *size_of_notebook(name), head(name)) for number, name in modules.lessons_by_number().items()}


def notebook_of(name):
    """Return the path of a lesson's notebook."""
    return next((ROOT / "notebooks").glob(f"[0-9][0-9]_{name}.ipynb"))


def title(name):
    first = nbformat.read(notebook_of(name), as_version=4).cells[0].source
    return re.sub(r"^# *\d+ *· *", "", first.splitlines()[0]).strip("# ")


def head(name):
    """Return the Head of a lesson's notebook."""
    text = nbformat.read(notebook_of(name), as_version=4).cells[2].source
    rows = dict(re.findall(r"^\| \*\*([\w ]+)\*\* \| (.+) \|$", text, re.M))
    told = re.fullmatch(r"about ([\d.]+) hours: ([\d.]+) to read and run, ([\d.]+) to write", rows["Time"])
    whole, reading, writing = map(float, told.groups())
    if whole != reading + writing:
        raise ValueError(f"the hours in the head of notebook {name} do not add up: {rows['Time']}")
    return Head(rows["You need"], rows["Lessons before"], reading, writing)


def size_of_notebook(name):
    """Return (words of its texts, code cells that are no check)."""
    cells = nbformat.read(notebook_of(name), as_version=4).cells
    words = sum(len(cell.source.split()) for cell in cells if cell.cell_type == "markdown")
    return words, sum(cell.cell_type == "code" and not cell.source.startswith("check(") for cell in cells)


def imports(name):
    """Return names of the lessons that a lesson imports itself, or by what it is given."""
    text = (SOLUTIONS / f"{name}.py").read_text(encoding="utf-8")
    return set(re.findall(r"^from \.(\w+) import", text, re.M)) & set(modules.lesson_names())


@cache
def needs(name):
    """Return names of all lessons that must be written, or handed out as worked, before this one runs."""
    direct = imports(name)
    return frozenset(direct.union(*map(needs, direct)))


@cache
def grading_tests():
    """Return {number of an exercise: its grading tests}, as pytest collects them."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "outcomes.json")
        command = [sys.executable, "-m", "pytest", "tests/lessons", "--collect-only", "--of=solutions",
                   f"--outcomes={file}", "-p", "no:cacheprovider"]
        said = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
        if not file.is_file():
            raise RuntimeError(f"the grading tests cannot be collected:\n{said.stdout}{said.stderr}")
        outcomes = json.loads(file.read_text(encoding="utf-8"))
    found = defaultdict(list)
    for outcome in outcomes:
        found[outcome["exercise"]].append(outcome)
    return dict(found)


@cache
def numbers():
    """Return {(lesson, function): number of the exercise}."""
    return {(name, function): number for name in modules.lesson_names()
            for number, function in generate.exercises(source(name)).items()}


@cache
def source(name):
    return (SOLUTIONS / f"{name}.py").read_text(encoding="utf-8")


def exercises_of(name):
    found = []
    for match in generate.ANSWER.finditer(source(name)):
        number = match["exercise"]
        function = generate.exercises(source(name))[number]
        body = match[0].splitlines()[1:-1]
        lines = sum(bool(line.strip()) and not line.strip().startswith("#") for line in body)
        tests = grading_tests()[number]
        hints = tuple(dict.fromkeys(test["hint"] for test in tests))
        points = sum(test["points"] for test in tests)
        found.append(Exercise(name, number, function, points, hints, lines, uses(name, function),
                              calls.stars(number)))
    return tuple(found)


def uses(name, function):
    """Return numbers of the exercises that an answer calls itself, or by a given function."""
    found, seen, waiting = set(), set(), list(coverage.calls()[name, function])
    while waiting:
        place = coverage.defined(waiting.pop())
        if place is None or place in seen:
            continue
        seen.add(place)
        if place in numbers():
            found.add(numbers()[place])
        else:
            waiting += coverage.calls()[place]
    return tuple(sorted(found - {numbers()[name, function]}, key=in_order))


def in_order(number):
    """Return a key by which "5.2" comes before "5.10"."""
    return tuple(map(int, number.split(".")))


@cache
def used_by():
    """Return {number of an exercise: numbers of the exercises that call it}."""
    found = defaultdict(list)
    for lesson in lessons().values():
        for exercise in lesson.exercises:
            for number in exercise.uses:
                found[number].append(exercise.number)
    return found


def link_into(report, address, words):
    """Return a link to a place of the report, as HTML; None if there is no report, or if it does not have this place.

    report: its folder, or None.  A quick run leaves some stability cases out, and a run of some scenes the others.
    """
    page, _, place = address.partition("#")
    if not report or not (report / page).is_file() or (place and place not in places_of(report / page)):
        return None
    return f'<a href="../report/{address}">{words}</a>'


@cache
def places_of(page):
    """Return the names of all places of a page."""
    return frozenset(re.findall(r'\bid="([^"]+)"', page.read_text(encoding="utf-8")))
