"""A lesson whose exercises are worked in the sandbox: the object that the grading tests get as `lesson`."""

import importlib
import re
import tempfile
import types
from functools import lru_cache
from pathlib import Path

from validate import binding, generate

from .box import Box, Call


def exercises(lesson):
    """{"1.2": "midpoint_step", …}."""
    return generate.exercises((binding.SOLUTIONS / f"{lesson}.py").read_text())


def builds_on(lesson):
    """The earlier lessons that a lesson imports, and that those import."""
    found = [name for name in re.findall(r"^from \.(\w+) import", (binding.SOLUTIONS / f"{lesson}.py").read_text(), re.M)
             if name in binding.lesson_names()]
    return list(dict.fromkeys([*found, *(further for name in found for further in builds_on(name))]))


@lru_cache(maxsize=1)
def handout():
    """A folder with the lessons as handed out, for the sandbox."""
    folder = Path(tempfile.mkdtemp(prefix="handout-"))
    folder.chmod(0o755)
    for name, text in generate.lessons().items():
        (folder / name).write_text(text)
    for name in sorted(binding.GIVEN - {"__init__"}):
        if (binding.SOLUTIONS / f"{name}.py").is_file():
            (folder / f"{name}.py").write_text((binding.SOLUTIONS / f"{name}.py").read_text())
    return folder


def box_of(lesson, text, budget):
    """The sandbox for one lesson's file."""
    earlier = {name: {function: getattr(importlib.import_module(f"solutions.{name}"), function) for function in exercises(name).values()}
               for name in builds_on(lesson)}
    records = [kind for kind in vars(importlib.import_module(f"solutions.{lesson}")).values() if hasattr(kind, "_fields")]
    return Box(lesson, text, handout(), earlier, budget, records)


def lesson_in(box, lesson):
    """The lesson with its exercises in the box; what is given is ours, and calls the exercises in the box too."""
    module = importlib.import_module(f"solutions.{lesson}")
    space = {**vars(module), **{function: Call(box, f"lesson:{function}") for function in exercises(lesson).values()}}
    for name, value in vars(module).items():
        if isinstance(value, types.FunctionType) and value.__module__ == module.__name__ and not isinstance(space[name], Call):
            space[name] = types.FunctionType(value.__code__, space, name, value.__defaults__)
    subject = types.SimpleNamespace(**space)
    subject.box = box
    return subject
