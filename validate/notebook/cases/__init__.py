"""Pictures of failing checks: the shapes that an exercise's function was given, its answer, and what the test expects.

A pictured exercise is one entry of PICTURES in the file of its lesson; there is no list to edit.  The inputs are
public, as in the message of the check; a graded run draws nothing.  What is expected comes from the test, and only
where the test compares a result, or a part of it, with numbers.
"""

import base64
import importlib
import io
from functools import cache
from html import escape
from pathlib import Path
from typing import NamedTuple

import numpy as np

from .marks import Dots, Way, is_finite, picture

UNDRAWABLE = (ArithmeticError, AttributeError, IndexError, TypeError, ValueError, np.linalg.LinAlgError)
PLAIN = {"__init__", "marks", "pieces"}      # files without entries
DOTS_PER_INCH = 120          # of the file
SHOWN = 96                   # pixels of a page per inch, so that type has its size in points there


class Drawn(NamedTuple):
    """The picture of a case."""
    png: bytes
    width: int               # as shown [pixels]
    alt: str                 # what is in it
    words: str               # what to see in it

    def html(self):
        data = base64.b64encode(self.png).decode()
        return (f'<img src="data:image/png;base64,{data}" alt="{escape(self.alt)}" '
                f'style="width:{self.width}px;max-width:100%;height:auto;background:#ffffff">'
                f"<div>{escape(self.words)}</div>")


@cache
def pictures():
    """Return {exercise: Picture} of all lessons."""
    files = sorted(file.stem for file in Path(__file__).parent.glob("*.py") if file.stem not in PLAIN)
    return {number: one for name in files
            for number, one in importlib.import_module(f"{__name__}.{name}").PICTURES.items()}


@np.errstate(all="ignore")                               # a wrong answer may hold any numbers
def drawn(case):
    """Return the Drawn picture of a Case; None where its exercise has none, or its numbers cannot be drawn."""
    how = pictures().get(case.exercise)
    if how is None:
        return None
    answer, expected = (_marks(how, result, case.arguments, whose)
                        for result, whose in ((case.result, "your answer"), (case.expected, "expected")))
    try:
        given = how.given(*case.arguments)
        views = how.views([one for one in (case.result, case.expected) if one is not None], *case.arguments)
        if not all(map(is_finite, given)):
            return None
        figure, inside = picture(views, given, answer, expected)
        file = io.BytesIO()
        figure.savefig(file, format="png", dpi=DOTS_PER_INCH)
    except UNDRAWABLE:
        return None
    words = [f"What to see: {how.see}"]
    words += [] if answer else ["Your function returned nothing that can be drawn here."]
    words += [] if inside else ["Your answer reaches beyond the edge of the picture."]
    words += _beside(views, given, answer)
    if answer and not expected:
        words.append("The check compares something that follows from the answer, so no expected answer is drawn.")
    listed = "; ".join(dict.fromkeys(mark.label for mark in [*given, *answer, *expected] if mark.label))
    seen = " and ".join(view.title for view in views if view.title)
    alt = f"The case in which the check of exercise {case.exercise} failed{f', seen {seen}' if seen else ''}: {listed}."
    return Drawn(file.getvalue(), round(SHOWN * figure.get_figwidth()), alt, " ".join(words))


def _marks(how, result, arguments, whose):
    """Return the marks of a result, named as the answer or as the expected one; none where it cannot be drawn."""
    if result is None:
        return []
    try:
        found = [mark for mark in how.answer(result, *arguments) if is_finite(mark)]
    except UNDRAWABLE:
        return []
    return [mark._replace(label=f"{whose}: {mark.label}" if mark.label else "") for mark in found]


def _beside(views, given, answer):
    """Return a sentence about an answer that is not in the plane in which all that is given lies."""
    known, found = ([mark.points for mark in some if isinstance(mark, (Dots, Way))] for some in (given, answer))
    if len(views) > 1 or not known or not found:
        return []
    size = np.ptp(np.concatenate(known), axis=0).max()
    off, flat = (max(views[0].depth(points).max() for points in some) for some in (found, known))
    return [f"Your answer is {off:.3g} m beside the plane of the picture."] if off > 1e-6 * size > flat else []
