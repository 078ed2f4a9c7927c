"""A body that computes nothing earns nothing in any exercise.

Such bodies return a constant, their arguments, or zeros, ones or NaN of the right shape, look up the public answers, or
raise an error for every input.
"""

import inspect
import itertools
import math
import types

import numpy as np
import pytest

from solutions.checks import BadInput, Diverged
from validate.grading import points, wire
from validate.subject import modules
from validate.subject.generate import exercises


def filled(value, x):
    """The same structure with every number replaced by x."""
    if isinstance(value, tuple):
        parts = [filled(part, x) for part in value]
        return type(value)(*parts) if hasattr(value, "_fields") else tuple(parts)
    if isinstance(value, np.ndarray):
        return np.full(value.shape, x, value.dtype if np.isfinite(x) else float)
    if isinstance(value, bool | int | float):
        return type(value)(x) if np.isfinite(x) else x
    return "" if isinstance(value, str) else value


class Shaped:
    """Answers of the right structure without content; the last one again if the worked function raises an error."""

    def __init__(self, worked, x):
        self.worked, self.x, self.last = worked, x, None

    def __call__(self, *arguments):
        try:
            self.last = filled(self.worked(*arguments), self.x)
        except Exception:
            pass
        return self.last


class First:
    """Its first right answer for ever: a student who has read the public inputs may copy it."""

    def __init__(self, worked):
        self.worked, self.answer = worked, None

    def __call__(self, *arguments):
        if self.answer is None:
            try:
                self.answer = self.worked(*arguments)
            except Exception:
                pass
        return self.answer


class Table:
    """The right answers of all public calls; its last answer for any other call."""

    def __init__(self, worked):
        self.worked, self.answers, self.last, self.complete = worked, {}, None, False

    def __call__(self, *arguments):
        asked = wire.pack(arguments, lambda function: getattr(function, "__name__", ""))
        if not self.complete:
            self.answers[asked] = self.worked(*arguments)
        self.last = self.answers.get(asked, self.last)
        return self.last


class Arguments:
    """Arguments in place of the parts of the right answer: of all choices with the right shapes the one of number k."""

    def __init__(self, worked, k):
        self.worked, self.k, self.last = worked, k, None

    def __call__(self, *arguments):
        try:
            self.last = self.chosen(self.worked(*arguments), arguments)
        except Exception:
            pass
        return self.last

    def chosen(self, answer, arguments):
        parts = answer if isinstance(answer, tuple) else (answer,)
        own = [*arguments, *(field for a in arguments if hasattr(a, "_fields") for field in a)]
        fit = [[a for a in own if shape(a) == shape(part)] or [filled(part, 0)] for part in parts]
        *_, choice = itertools.islice(itertools.product(*fit), self.k % math.prod(map(len, fit)) + 1)
        if not isinstance(answer, tuple):
            return choice[0]
        return type(answer)(*choice) if hasattr(answer, "_fields") else choice


def shape(value):
    """What two values have in common that may be mistaken for each other."""
    return np.shape(value) if isinstance(value, np.ndarray | int | float) else type(value)


def constant(value):
    return lambda worked: lambda *arguments: value


def argument(n):
    return lambda worked: lambda *arguments: arguments[n]


def arrays(worked):
    """The first two arrays that are handed in: a step that does not move."""
    def body(*arguments):
        some = [a for a in arguments if isinstance(a, np.ndarray)][:2]
        return tuple(some) if len(some) > 1 else some[0] if some else None
    return body


def raising(error):
    def body(*arguments):
        raise error
    return lambda worked: body


def naming(worked):
    """Refuses everything, and names all numbers that it was given: one of them will be the right one."""
    def body(*arguments):
        numbers = [a for a in arguments if isinstance(a, np.ndarray | float | int)]
        raise BadInput("something", [number for a in numbers for number in np.ravel(a).tolist()], "")
    return body


CHOICES = 8                  # of arguments in place of an answer's parts [-]: (x, v) for a step has four
BODIES = {
    **{f"return {value!r}".replace("\n", ""): constant(value) for value in (
        None, 0.0, False, np.zeros(3), np.eye(3), (), np.zeros(0), np.zeros((0, 3)))},
    "return the arrays": arrays,
    **{f"return arguments of the right shapes, {k}": lambda worked, k=k: Arguments(worked, k) for k in range(CHOICES)},
    **{f"return {x} in the right shape": lambda worked, x=x: Shaped(worked, x) for x in (0, 1, np.nan)},
    **{f"raise {type(error).__name__}": raising(error) for error in (BadInput("x", 1.0, "y"), Diverged("x", 1.0, "y"))},
    "raise BadInput with every number": naming, "the first right answer": First, "a table of public answers": Table,
}
LEARNED = First, Table       # these count only if they pass with the public seed, too
FINITE = "10.19",            # exercises whose arguments have few values, all of them tested: a table is an answer


def passed(graded):
    """{(subject, test)} of the tests that passed."""
    return {(key, o.test) for key, outcomes in graded.items() for o in outcomes if o.status == "passed"}


@pytest.mark.long
@pytest.mark.parametrize("name", modules.lesson_names())
def test_senseless_answers_earn_nothing(name):
    module, subjects, learned = vars(modules.bind(name)), {}, {}
    for exercise, function in exercises((modules.SOLUTIONS / f"{name}.py").read_text()).items():
        count = len(inspect.signature(module[function]).parameters)
        arguments = {f"return argument {n}": argument(n) for n in range(count)}
        for text, make in {**BODIES, **arguments}.items():
            if make in LEARNED and (not count or exercise in FINITE):        # to know all answers is right
                continue
            body, key = make(module[function]), f"{exercise}: {text}"
            changed = types.SimpleNamespace(**{**module, function: body})
            subjects[key] = changed, lambda number, test, exercise=exercise: number == exercise
            if make in LEARNED:
                learned[key] = body
    public = passed(points.grade_each(name, {key: subjects[key] for key in learned}))
    for body in learned.values():
        body.complete = True
    secret = passed(points.grade_each(name, subjects, seed="another"))
    earned = sorted(test for key, test in secret if key not in learned or (key, test) in public)
    assert not earned, "\n".join(earned)
