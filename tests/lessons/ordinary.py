"""Ordinary calls of every public function: those that the worked answers get while they run the grading tests."""

import functools
import shutil
import tempfile
import types
from pathlib import Path

from validate.grading import points
from validate.subject import modules

MOST = 8                     # calls of a function that are kept [-]


@functools.cache
def ordinary_calls(*lessons):
    """{(lesson, function): (function, its first calls)} for every public function of these lessons and companions.

    Calls are recorded while all of these lessons are graded: simulator calls functions of rotation, too.
    """
    found = {}
    with tempfile.TemporaryDirectory() as room:
        folder = Path(room) / "answers"
        shutil.copytree(modules.SOLUTIONS, folder)
        for lesson in lessons:
            module, plain = modules.bind(lesson, folder), modules.bind(lesson)
            public = public_functions(lesson, module)
            calls = {name: [] for name in public}
            for name, function in public.items():
                function.__globals__[name] = vars(module)[name] = recorded(function, calls[name])
            points.grade(lesson, module)
            for name, some in calls.items():
                found[lesson, name] = getattr(plain, name), some
    return found


def public_functions(lesson, module):
    """{name: function} of what a lesson and its companion define."""
    homes = module.__name__, module.__name__.replace(lesson, f"given.{lesson}")
    return {name: f for name, f in vars(module).items()
            if isinstance(f, types.FunctionType) and not name.startswith("_") and f.__module__ in homes}


def recorded(function, calls):
    """The function, which keeps the arguments of its first calls."""
    @functools.wraps(function)
    def keeping(*arguments):
        if len(calls) < MOST:
            calls.append(arguments)
        return function(*arguments)
    return keeping
