"""Wrong answers that must lose an exercise's points, and right ones, written differently, that must keep them.

One module per lesson. A wrong answer has exactly one fault. How it is made proves this: without the fault it passes.

edit      the worked answer with one replacement in one line of its text
variant   a factory's answer with one argument that differs from its default; with the defaults the answer is right
"""

import functools
import inspect
from collections.abc import Callable
from typing import NamedTuple

from validate.subject.generate import exercises


class Mutant(NamedTuple):
    exercise: str
    name: str                # of the function that it replaces
    story: str               # what is wrong, or what is different
    right: bool
    make: Callable           # make() is the answer
    kind: str = "written out"     # or edit, or variant
    faults: int = 0               # number of replacements, or of arguments that differ from their defaults
    factory: Callable = None
    old: str = ""                 # of an edit: text of the worked answer
    new: str = ""                 # of an edit: the text in its place

    @property
    def function(self):
        return self.make()


def variants(make):
    """A factory of answers that records how many of its arguments differ from their defaults."""
    signature = inspect.signature(make)

    @functools.wraps(make)
    def noting(*arguments, **named):
        bound, answer = signature.bind(*arguments, **named), make(*arguments, **named)
        faults = sum(value is not signature.parameters[name].default for name, value in bound.arguments.items())
        answer.made = "variant", faults, noting
        return answer
    return noting


def collection(worked):
    """Return wrong(exercise, story)(function), right likewise, edit(exercise, story, old, new), and their list."""
    mutants, names = [], exercises(inspect.getsource(worked))

    def keep(right):
        def marked(exercise, story):
            def decorate(function):
                made = getattr(function, "made", ())
                mutant = Mutant(exercise, names[exercise], story, right, lambda: function, *made)
                whole = (exercise, 0, mutant.factory)
                if mutant.factory and whole not in [(m.exercise, m.faults, m.factory) for m in mutants] and not right:
                    keep(True)(exercise, f"{mutant.factory.__name__} with its defaults")(mutant.factory())
                mutants.append(mutant)
                return function
            return decorate
        return marked

    @functools.cache
    def text_of(name):
        return inspect.getsource(getattr(worked, name)).partition("### BEGIN SOLUTION")

    def edit(exercise, story, old, new):
        name = names[exercise]
        head, mark, answer = text_of(name)

        @functools.cache                             # there are thousands, and a run of the tests needs a few of them
        def make():
            space = dict(vars(worked))
            exec(compile(head + mark + answer.replace(old, new), worked.__file__, "exec"), space)
            return space[name]
        mutant = Mutant(exercise, name, story, False, make, "edit", answer.count(old) + old.count("\n"),
                        old=old, new=new)
        mutants.append(mutant)
        return mutant

    return keep(False), keep(True), edit, mutants


def of_variants(wrong):
    """Return wrongs(exercise, factory, {story: the argument that differs}) and alike(exercise, story, factory, *such).

    `alike` makes several wrong answers with one story: they return different numbers, or no input tells them apart.
    """
    def wrongs(exercise, factory, ideas):
        for story, part in ideas.items():
            wrong(exercise, story)(factory(**part))

    def alike(exercise, story, factory, *parts):
        for part in parts:
            wrong(exercise, story)(factory(**part))
    return wrongs, alike


def same(value):
    """Return the value: the default of a factory's step that a wrong answer leaves out or changes."""
    return value
