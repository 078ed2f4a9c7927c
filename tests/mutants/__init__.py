"""Wrong answers that must lose an exercise's points, and right ones, written differently, that must keep them.

One module a lesson.  A mutant is a function with the name of the one it stands in for, and a decorator that says what it is.
"""

from typing import Callable, NamedTuple


class Mutant(NamedTuple):
    exercise: str
    story: str               # what is wrong, or what is different
    right: bool
    function: Callable


def collection():
    """Two decorators, wrong(exercise, story) and right(exercise, story), and the list that they fill."""
    mutants = []

    def keep(right):
        def marked(exercise, story):
            def decorate(function):
                mutants.append(Mutant(exercise, story, right, function))
                return function
            return decorate
        return marked

    return keep(False), keep(True), mutants
