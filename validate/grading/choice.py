"""Choice of the graded lessons, exercises and their points: `--lesson friction`, `--exercises 3.1-3.4,3.6=2`."""

import math
import re

from solutions.checks import BadInput
from validate.subject import modules

from . import remote

OPTION = "Only these exercises, such as 3.1-3.4,3.6=2; =2 sets the points of each.  All of them without."
PART = re.compile(r"(\d+)\.(\d+)(?:[-–](?:(\d+)\.)?(\d+))?(?:=(.*))?")


def chosen(lessons, exercises=None):
    """Return (lessons in the order of the course, {exercise: its points, or None for those of its tests}).

    lessons: names; without any, the lessons of the exercises, or all.  exercises: text of the option; without it the
    dict is empty, and every exercise is graded.  Raises BadInput for what does not exist or contradicts itself.
    """
    for name in lessons:
        modules.bind(name)
    every, worth = modules.lesson_names(), {} if exercises is None else parsed(exercises)
    numbered = modules.lessons_by_number()
    there = {numbered[int(number.split(".")[0])] for number in worth} or set(lessons or every)
    if lessons and there != set(lessons):
        wrong = sorted(there ^ set(lessons), key=every.index)[0]
        said = "has no exercise there" if wrong in lessons else "is not given by --lesson"
        raise BadInput(f"--exercises {exercises!r}", f"at odds with --lesson: {wrong} {said}", "name the same lessons")
    return [name for name in every if name in there], worth


def parsed(text):
    """Return {exercise: points or None} in the order of the text.  Raises BadInput."""
    found = {}
    for part in filter(None, map(str.strip, text.split(","))):
        match = PART.fullmatch(part)
        if not match:
            raise refused(part, "not a list of exercises")
        lesson, first, again, last, points = match.groups()
        if again not in (None, lesson):
            raise refused(part, "a range over two lessons")
        for number in range(int(first), int(last or first) + 1):
            exercise = known(part, f"{lesson}.{number}")
            if exercise in found:
                raise refused(part, f"not the first that names {exercise}")
            found[exercise] = positive(part, points)
        if last and int(last) < int(first):
            raise refused(part, "a range that ends before it begins")
    if not found:
        raise refused(text, "empty")
    return found


def known(part, exercise):
    """Return an exercise.  Raises BadInput if no lesson has it."""
    names, number = modules.lessons_by_number(), int(exercise.split(".")[0])
    if number not in names:
        raise refused(part, f"of a lesson that is not there: they are {in_words(names)}")
    there = remote.exercises(names[number])
    if exercise not in there:
        raise refused(part, f"not all there: {names[number]} has {next(iter(there))} to {list(there)[-1]}")
    return exercise


def in_words(numbers):
    """Return increasing whole numbers as text: "1 to 11", or "1 to 11, 20"."""
    runs = []
    for number in numbers:
        if runs and number == runs[-1][1] + 1:
            runs[-1][1] = number
        else:
            runs.append([number, number])
    return ", ".join(f"{first} to {last}" if last > first else f"{first}" for first, last in runs)


def positive(part, points):
    """Return points as a number, or None.  Raises BadInput if they are not positive."""
    try:
        number = None if points is None else float(points)
    except ValueError:
        number = math.nan
    if number is not None and not 0.0 < number < math.inf:
        raise refused(part, "without a positive number of points")
    return number


def refused(part, what):
    return BadInput(f"--exercises {part!r}", what, "write it like 3.1,3.4 or 3.1-3.4,3.6=2")
