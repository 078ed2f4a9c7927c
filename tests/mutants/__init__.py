"""Wrong answers that must lose an exercise's points, and right ones, written differently, that must keep them.

One module per lesson.  A wrong answer has one fault only, and its kind proves it: without the fault the answer passes.

edit         the worked answer with one replacement in one line of its text
variant      made by a factory with one argument that differs from its default; the factory's defaults make a right answer
written out  neither of these: WRITTEN_OUT describes its one fault
"""

import functools
import inspect
from typing import Callable, NamedTuple

from validate.generate import exercises

WRITTEN_OUT = {}             # {(exercise, story): its one fault}


class Mutant(NamedTuple):
    exercise: str
    name: str                # of the function that it stands in for
    story: str               # what is wrong, or what is different
    right: bool
    function: Callable
    kind: str                # edit, variant or written out
    faults: int              # replacements, or arguments that differ from their defaults
    factory: str = ""        # of a variant


def variants(make):
    """A factory of answers that notes which of its arguments differ from their defaults."""
    parameters = inspect.signature(make)

    @functools.wraps(make)
    def noting(*arguments, **named):
        bound, answer = parameters.bind(*arguments, **named), make(*arguments, **named)
        changed = [name for name, value in bound.arguments.items() if value is not parameters.parameters[name].default]
        answer.made = "variant", len(changed), make.__qualname__
        return answer
    return noting


def collection(worked):
    """wrong(exercise, story)(function), right likewise, edit(exercise, story, old, new), and the list that they fill."""
    mutants, names = [], exercises(inspect.getsource(worked))

    def keep(right):
        def marked(exercise, story):
            def decorate(function):
                made = getattr(function, "made", ("written out", int(not right)))
                mutants.append(Mutant(exercise, names[exercise], story, right, function, *made))
                return function
            return decorate
        return marked

    def edit(exercise, story, old, new):
        name = names[exercise]
        head, mark, answer = inspect.getsource(getattr(worked, name)).partition("### BEGIN SOLUTION")
        space = dict(vars(worked))
        exec(head + mark + answer.replace(old, new), space)
        mutants.append(Mutant(exercise, name, story, False, space[name], "edit", answer.count(old)))

    return keep(False), keep(True), edit, mutants
