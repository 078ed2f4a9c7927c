"""A lesson whose exercises are worked in the sandbox: the object that the grading tests get as `lesson`."""

import atexit
import importlib
import re
import shutil
import tempfile
import types
from functools import lru_cache
from pathlib import Path

from validate.subject import generate, modules

from .box import Call, Sandbox


def exercises(lesson):
    """Return {"1.2": "midpoint_step", …}."""
    return generate.exercises((modules.SOLUTIONS / f"{lesson}.py").read_text())


def builds_on(lesson):
    """List the earlier lessons that a lesson imports, directly or through others."""
    source = (modules.SOLUTIONS / f"{lesson}.py").read_text()
    imported = re.findall(r"^from \.(\w+) import", source, re.M)
    found = [name for name in imported if name in modules.lesson_names()]
    return list(dict.fromkeys([*found, *(further for name in found for further in builds_on(name))]))


@lru_cache(maxsize=1)
def handout():
    """Make a folder with the lessons as handed out, for the sandbox."""
    folder = Path(tempfile.mkdtemp(prefix="handout-"))
    folder.chmod(0o755)
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    for name, text in generate.lessons().items():
        (folder / name).write_text(text)
    for package in modules.PACKAGES:
        shutil.copytree(modules.SOLUTIONS / package, folder / package, ignore=shutil.ignore_patterns("__pycache__"))
    for name in sorted(modules.GIVEN - {"__init__"}):
        if (modules.SOLUTIONS / f"{name}.py").is_file():
            (folder / f"{name}.py").write_text((modules.SOLUTIONS / f"{name}.py").read_text())
    return folder


def box_of(lesson, text, budget):
    """Make the sandbox for one lesson's file."""
    earlier = {name: worked_functions(name) for name in builds_on(lesson)}
    return Sandbox(lesson, text, handout(), earlier, budget, records_of(lesson))


def records_of(lesson):
    """List the classes of NamedTuples that a lesson's functions may hand over: its own, and those of the modules from
    which its given functions come.
    """
    own = vars(modules.bind(lesson))
    homes = [value.__globals__ for value in own.values() if isinstance(value, types.FunctionType)]
    spaces = (*homes, own)                                             # of two with one name the lesson's own counts
    return [kind for space in spaces for kind in space.values()
            if isinstance(kind, type) and issubclass(kind, tuple) and hasattr(kind, "_fields")]


def worked_functions(lesson):
    """Return {exercise function: the worked one} of a lesson."""
    module = importlib.import_module(f"solutions.{lesson}")
    return {function: getattr(module, function) for function in exercises(lesson).values()}


def lesson_in(box, lesson):
    """Return the lesson with its exercises in the sandbox.

    Given functions run in this process and call the exercises in the sandbox, also a loop over steps, one round trip
    per step.  In the sandbox the student's code could put another function in their place.
    """
    module = modules.bind(lesson)
    ours = module.__name__, f"solutions.given.{lesson}"
    calls = {function: Call(box, f"lesson:{function}") for function in exercises(lesson).values()}
    space = {**vars(module), **calls}
    given = {
        name: value
        for name, value in vars(module).items()
        if isinstance(value, types.FunctionType) and value.__module__ in ours and name not in calls
    }
    for name, function in given.items():
        space[name] = types.FunctionType(function.__code__, space, name, function.__defaults__)
    return types.SimpleNamespace(**space, box=box)
