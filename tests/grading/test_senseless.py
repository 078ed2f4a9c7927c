"""A body that ignores its arguments earns nothing in any exercise.

Such bodies return a constant, an argument or zeros of the right shape, or raise an error for every input.
"""

import types

import numpy as np
import pytest

from solutions.checks import BadInput, Diverged
from validate import modules
from validate.generate import exercises

from . import points


def filled(value, x):
    """The same structure with every number replaced by x."""
    if isinstance(value, tuple):
        parts = [filled(part, x) for part in value]
        return type(value)(*parts) if hasattr(value, "_fields") else tuple(parts)
    if isinstance(value, np.ndarray):
        return np.full_like(value, x)
    return type(value)(x) if isinstance(value, bool | int | float) else value


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
    """Its first right answer for ever: what somebody may copy who has read the public inputs."""

    def __init__(self, worked):
        self.worked, self.answer = worked, None

    def __call__(self, *arguments):
        if self.answer is None:
            try:
                self.answer = self.worked(*arguments)
            except Exception:
                pass
        return self.answer


def constant(value):
    return lambda worked: lambda *arguments: value


def argument(n):
    return lambda worked: lambda *arguments: arguments[n] if -len(arguments) <= n < len(arguments) else None


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


BODIES = {
    **{f"return {value!r}".replace("\n", ""): constant(value) for value in (
        None, 0.0, False, np.zeros(3), np.eye(3))},
    **{f"return argument {n}": argument(n) for n in (0, 1, -1)}, "return the arrays": arrays,
    **{f"return {x} in the right shape": lambda worked, x=x: Shaped(worked, x) for x in (0, 1)},
    **{f"raise {type(error).__name__}": raising(error) for error in (BadInput("x", 1.0, "y"), Diverged("x", 1.0, "y"))},
    "raise BadInput with every number": naming, "the first right answer": First,
}


def passed(graded):
    """{(subject, test)} of the tests that passed."""
    return {(key, o.test) for key, outcomes in graded.items() for o in outcomes if o.status == "passed"}


@pytest.mark.long
@pytest.mark.parametrize("name", modules.lesson_names())
def test_senseless_answers_earn_nothing(name):
    module, subjects = vars(modules.bind(name)), {}
    for exercise, function in exercises((modules.SOLUTIONS / f"{name}.py").read_text()).items():
        for body, make in BODIES.items():
            changed = types.SimpleNamespace(**{**module, function: make(module[function])})
            subjects[f"{exercise}: {body}"] = changed, lambda number, test, exercise=exercise: number == exercise
    copied = {key: subject for key, subject in subjects.items() if key.endswith("the first right answer")}
    public = passed(points.grade_each(name, copied))
    secret = passed(points.grade_each(name, subjects, seed="another"))
    assert not {(key, test) for key, test in secret if key not in copied or (key, test) in public}
