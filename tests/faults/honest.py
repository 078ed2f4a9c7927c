"""Honest runs: right answers written differently, other random numbers, compiled code.  None may turn a verdict."""

import importlib
import random
import re
import time
from contextlib import contextmanager
from typing import NamedTuple

import numpy as np

from validate.run import coverage
from validate.subject import modules

from .notice import copy_with, turned_at

STEPS = 1000                 # most steps of a run [-]
ELSEWHERE = 3                # places of later lessons that use this one [-]
COMPILED = 4                 # one of so many runs is of the worked answers, compiled; all others are plain


class HonestRun(NamedTuple):
    """What an honest run was, and what turned in it: {place: words}."""
    about: str
    alarms: dict
    ended: int               # scenes and cases that ended in time
    places: int              # all of them
    seconds: float


def honest_run(number):
    """The HonestRun of that number: lessons by turns, with other answers, places and random numbers for each."""
    began, draw = time.monotonic(), random.Random(number)
    lessons = modules.lesson_names()
    lesson = lessons[number % len(lessons)]
    compiled = number % COMPILED == COMPILED - 1 and modules.can_compile()
    text, count = varied(lesson, draw)
    chosen = places_of(lesson, draw)
    with copy_with({lesson: text}) as copy, other_seeds(1000 * (number + 1)):
        of = "solutions" if compiled else copy
        speeds = ("compiled",) if compiled else ("plain",)           # what is written differently does not compile
        found = {place: turned_at(place, of, None, STEPS, speeds) for place in chosen}
    about = f"{lesson}, " + ("compiled" if compiled else f"{count} answers written differently")
    ended = {place: turned for place, turned in found.items() if turned is not None}
    alarms = {place: turned for place, turned in ended.items() if turned}
    return HonestRun(about, alarms, len(ended), len(found), time.monotonic() - began)


def varied(lesson, draw):
    """(text, count): the lesson with so many of its exercises answered by a right answer of tests/mutants."""
    mutants = importlib.import_module(f"tests.mutants.{lesson}").MUTANTS
    right = {}
    for number, mutant in enumerate(mutants):
        if mutant.right:
            right.setdefault(mutant.name, []).append(number)
    taken = {name: draw.choice(numbers) for name, numbers in right.items() if draw.random() < 0.7}
    lines = [f"{name} = MUTANTS[{number}].function" for name, number in taken.items()]
    text = (modules.SOLUTIONS / f"{lesson}.py").read_text(encoding="utf-8")
    return "\n".join([text, f"from tests.mutants.{lesson} import MUTANTS", *lines, ""]), len(taken)


def places_of(lesson, draw):
    """All scenes and cases of a lesson, and a few of later lessons that use it."""
    places = sorted({place for (module, _), there in coverage.places().items() if module == lesson for place in there})
    own = [place for place in places if re.match(rf"{coverage.STABILITY}{lesson}/", place) or
           (place in modules.scene_names() and modules.bind_scene(place).lesson == lesson)]
    others = [place for place in places if place not in own]
    return own + draw.sample(others, min(ELSEWHERE, len(others)))


@contextmanager
def other_seeds(shift):
    """Let numpy's generators start from other seeds than the stability cases name."""
    real = np.random.default_rng
    np.random.default_rng = lambda seed=None: real(seed + shift if isinstance(seed, int) else seed)
    try:
        yield
    finally:
        np.random.default_rng = real
