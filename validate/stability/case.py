"""The records of a stability case, the decorator that registers it, and the tools that several lessons' cases share.

A case states the bound that theory gives, finds the bound by experiment and compares the two.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from solutions.checks import BadInput, Diverged

EDGE = 1e-6                  # relative width at which bisection stops [-]
LINE, DOTS = "line", "dots"


class Finding(NamedTuple):
    """One bound, and what became of it: it holds where |measured − predicted| ≤ tolerance."""
    claim: str               # what theory says, in one sentence
    quantity: str            # what was measured [unit]
    predicted: float         # theory's number
    measured: float          # the experiment's
    tolerance: float         # derived beforehand, in the unit of the quantity
    observation: str         # what was found, in one sentence

    @property
    def holds(self):
        """Whether experiment and theory agree; a measurement that failed is not a number, and does not hold."""
        return bool(abs(self.measured - self.predicted) <= self.tolerance)


class Picture(NamedTuple):
    """Curves to draw: series = [(label, xs, ys, style)], style LINE or DOTS."""
    title: str
    x_label: str
    y_label: str
    series: list
    sentence: str


class Case(NamedTuple):
    """One case before it is run."""
    slug: str                # its name in addresses
    title: str
    lesson: str
    examine: Callable        # (lesson) → (findings, Picture)
    compiled: bool           # False where a run is short, or brings an acceleration of its own


class Examined(NamedTuple):
    """One case after it was run."""
    slug: str
    title: str
    lesson: str
    findings: list
    picture: Picture | None


CASES = {}                   # {lesson: {slug: Case}} of the files that were imported so far


def case(slug, title, compiled=True):
    """Register a function (lesson) → (findings, Picture) as a case of the lesson that its file is named after."""
    def register(examine):
        lesson = examine.__module__.rpartition(".")[2]
        CASES.setdefault(lesson, {})[slug] = Case(slug, title, lesson, examine, compiled)
        return examine
    return register


def finding(*, claim, quantity, predicted, measured, tolerance, observation):
    """A Finding in plain floats."""
    return Finding(claim, quantity, float(predicted), float(measured), float(tolerance), observation)


def series(label, xs, ys, style):
    """One curve of a Picture in plain floats."""
    return (label, [float(x) for x in xs], [float(y) for y in ys], style)


# ---------------------------------------------------------------------------------------------- experiments

def bisect(too_long, low, high):
    """Where too_long turns from False to True; 0 if it is True at low already, infinite if it is still False at high."""
    if too_long(low):
        return 0.0
    if not too_long(high):
        return np.inf
    while high - low > EDGE * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if too_long(middle) else (middle, high)
    return 0.5 * (low + high)


def refuses(function, arguments=(), value=""):
    """Whether a call ends in BadInput, with that value in its sentence."""
    try:
        function(*arguments)
    except BadInput as e:
        return value in str(e)
    return False


def refuse(methods, run):
    """Number of these methods that end in Diverged, as they must, rather than in a number: run(name) → anything."""
    refused = 0
    for method in methods:
        try:
            run(method.function)
        except Diverged:
            refused += 1
    return refused
