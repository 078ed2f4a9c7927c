"""A lesson whose exercises are worked in the sandbox: the object that the grading tests get as `lesson`."""

import atexit
import importlib
import re
import shutil
import tempfile
import types
from functools import lru_cache
from pathlib import Path

from validate import generate, modules

from .box import Box, Call


def exercises(lesson):
    """{"1.2": "midpoint_step", …}."""
    return generate.exercises((modules.SOLUTIONS / f"{lesson}.py").read_text())


def builds_on(lesson):
    """The earlier lessons that a lesson imports, and that those import."""
    found = [name for name in re.findall(r"^from \.(\w+) import", (modules.SOLUTIONS / f"{lesson}.py").read_text(), re.M)
             if name in modules.lesson_names()]
    return list(dict.fromkeys([*found, *(further for name in found for further in builds_on(name))]))


@lru_cache(maxsize=1)
def handout():
    """A folder with the lessons as handed out, for the sandbox."""
    folder = Path(tempfile.mkdtemp(prefix="handout-"))
    folder.chmod(0o755)
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    for name, text in generate.lessons().items():
        (folder / name).write_text(text)
    shutil.copytree(modules.SOLUTIONS / "support", folder / "support", ignore=shutil.ignore_patterns("__pycache__"))
    for name in sorted(modules.GIVEN - {"__init__"}):
        if (modules.SOLUTIONS / f"{name}.py").is_file():
            (folder / f"{name}.py").write_text((modules.SOLUTIONS / f"{name}.py").read_text())
    return folder


def box_of(lesson, text, budget):
    """The sandbox for one lesson's file."""
    earlier = {name: {function: getattr(importlib.import_module(f"solutions.{name}"), function) for function in exercises(name).values()}
               for name in builds_on(lesson)}
    records = [kind for kind in vars(importlib.import_module(f"solutions.{lesson}")).values() if hasattr(kind, "_fields")]
    return Box(lesson, list(exercises(lesson).values()), text, handout(), earlier, budget, records)


def lesson_in(box, lesson):
    """The lesson with its exercises in the box.

    What is given is ours, and calls the exercises in the box.  A given function that gets an exercise's to work with, such as a loop of
    steps, goes there as a whole: its result is the student's in any case, and a step is not worth a round trip.
    """
    module = importlib.import_module(f"solutions.{lesson}")
    space = {**vars(module), **{function: Call(box, f"lesson:{function}") for function in exercises(lesson).values()}}
    given = [name for name, value in vars(module).items()
             if isinstance(value, types.FunctionType) and value.__module__ == module.__name__ and not isinstance(space[name], Call)]
    for name in given:
        space[name] = types.FunctionType(vars(module)[name].__code__, space, name, vars(module)[name].__defaults__)
    return types.SimpleNamespace(**{**space, **{name: _where_it_belongs(box, name, space[name]) for name in given}}, box=box)


def _where_it_belongs(box, name, function):
    there = Call(box, f"given:{name}")

    def call(*arguments):
        return (there if any(isinstance(a, Call) and a.name.startswith("lesson:") for a in arguments) else function)(*arguments)
    return call
