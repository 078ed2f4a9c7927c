"""Questions with four answers: the curves that a notebook draws and that the grading test judges.

`<lesson>.py` has a function for each question, which computes the four curves of a Choice in the order of its text.
`of` deals the letters A to D.  The test finds the right letter in the curves by their law, so no letter stands
in a file that students have.
"""

import importlib
from functools import cache
from typing import NamedTuple

import numpy as np

LETTERS = "ABCD"


class Choice(NamedTuple):
    """Four curves over one axis."""
    x: np.ndarray            # (n,)
    curves: tuple            # four (n,) arrays; dealt to the letters by `of`
    title: str
    xlabel: str
    ylabel: str
    log: bool = False        # whether the vertical axis is logarithmic


@cache
def of(lesson, question):
    """Return (the Choice, {letter: its curve}) of a question, by the name of its function."""
    found = getattr(importlib.import_module(f"{__name__}.{lesson}"), question)()
    order = np.random.default_rng(list(question.encode())).permutation(len(LETTERS))
    return found, {letter: found.curves[k] for letter, k in zip(LETTERS, order, strict=True)}


def where(lesson, question, law):
    """Return the one letter whose curve obeys law(x, curve)."""
    found, dealt = of(lesson, question)
    (letter,) = [letter for letter, curve in dealt.items() if law(found.x, curve)]
    return letter
