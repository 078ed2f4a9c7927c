"""Calls between exercises: read from the worked answers, or looked up if there are none.

`needs.json` has {exercise: its lesson, its function, its stars, the exercises that it calls}.
An exercise also calls another one through a given function, or if it passes the other one on as an argument.
`python -m validate.subject.generate` writes it.
"""

import ast
import json
import re
from functools import cache, lru_cache
from pathlib import Path

FILE = Path(__file__).with_name("needs.json")
FIND = "*Find*"              # in the docstring of an exercise whose formula is to be found: ★★
MAKE = "*Make it*"           # in that of an exercise to which many answers are right: ★★★
OWN = "★★★"                  # its answer is one's own, and need not call what the worked one calls


# ---------------------------------------------------------------------------------------------- looking up

@lru_cache(maxsize=1)
def table():
    """Return {exercise: {"lesson", "function", "needs"}} in the order of the course; empty if the file is missing."""
    return json.loads(FILE.read_text(encoding="utf-8")) if FILE.is_file() else {}


def asks_to_find(exercise):
    """Return whether a formula is to be found: a ★★ exercise."""
    return stars(exercise) == "★★"


def stars(exercise):
    """Return ★ for a formula that is given, ★★ for one to be found, and ★★★ for an answer of one's own."""
    return table().get(exercise, {}).get("stars", "★")


def of_lesson(lesson):
    """Return the exercises of a lesson."""
    return [number for number, one in table().items() if one["lesson"] == lesson]


def needed(exercise, folder=None):
    """Return all exercises that this one calls, directly or indirectly, in the order of the course.

    folder: where the answers are.  A lesson there may import another lesson from solutions, where it is worked.
    Then nothing of that lesson is needed.
    """
    found, waiting = set(), [exercise]
    while waiting:
        number = waiting.pop()
        for other in table().get(number, {"needs": ()})["needs"]:
            lesson, home = table()[other]["lesson"], table()[number]["lesson"]
            if other not in found and (folder is None or lesson == home or lesson in siblings(Path(folder), home)):
                found.add(other)
                waiting.append(other)
    return [number for number in table() if number in found and number != exercise]


def siblings(folder, lesson):
    """Return the lessons that this one imports from beside it."""
    file = folder / f"{lesson}.py"
    text = file.read_text(encoding="utf-8", errors="replace") if file.is_file() else ""
    return set(re.findall(r"^from \.(\w+) import", text, re.M))


def states(outcomes):
    """Return {exercise: passed, not yet or not attempted}, the worst of (exercise, status) of its tests."""
    worst, found = ["passed", "not attempted", "not yet"], {}
    for number, status in outcomes:
        found[number] = max(found.get(number, "passed"), status, key=worst.index)
    return found


def first_open(exercise, states, folder=None):
    """Return the first exercise below this one that does not pass, by its number; None if all of them do.

    states: {exercise: "passed", "not yet" or "not attempted"}; one that is not in it counts as passed.
    """
    return next((number for number in needed(exercise, folder) if states.get(number, "passed") != "passed"), None)


def next_of(lesson, states):
    """Return the first exercise of a lesson that does not pass, while all that it calls do; None if there is none."""
    return next((number for number in of_lesson(lesson)
                 if states.get(number) != "passed" and first_open(number, states) is None), None)


def sentence(exercise, below, state):
    """Return what a student reads where an exercise calls another one that does not pass."""
    own, other = table()[exercise], table()[below]
    lesson = "" if own["lesson"] == other["lesson"] else f" of lesson {other['lesson']}"
    is_open = "is not written yet: write" if state == "not attempted" else "does not pass yet: mend"
    calls = "calls" if below in own["needs"] else "depends on"
    return f"{exercise} {calls} {other['function']} ({below}{lesson}), which {is_open} that first"


def sentence_below(exercise, states, folder=None):
    """Return the same about the first exercise below this one that does not pass; empty if all of them do.

    A ★★★ exercise has an answer of one's own, which need not call them.
    """
    below = first_open(exercise, states, folder) if stars(exercise) != OWN else None
    return sentence(exercise, below, states[below]) if below else ""


# ---------------------------------------------------------------------------------------------- reading the answers

def read_from(solutions, lessons, exercises):
    """Return the table, from a folder of worked answers.

    exercises: the function that finds {exercise: function} in a text.
    """
    numbers = {(lesson, name): number for lesson in lessons
               for number, name in exercises((solutions / f"{lesson}.py").read_text(encoding="utf-8")).items()}
    graph = {".".join(path.relative_to(solutions).with_suffix("").parts): path for path in solutions.rglob("*.py")}

    @cache
    def names_of(module):
        return used_names(graph[module].read_text(encoding="utf-8"), module, graph)

    def called(start):
        found, seen, waiting = set(), {start}, [start]
        while waiting:
            module, name = waiting.pop()
            for other in names_of(module).get(name, ()) if module in graph else ():
                if other in numbers and other != start:
                    found.add(numbers[other])
                elif other not in seen:
                    seen.add(other)
                    waiting.append(other)
        return found

    def stars_of(lesson, function):
        text = (solutions / f"{lesson}.py").read_text(encoding="utf-8")
        (node,) = (node for node in ast.parse(text).body if getattr(node, "name", "") == function)
        doc = ast.get_docstring(node)
        return OWN if MAKE in doc else "★★" if FIND in doc else "★"
    return {number: {"lesson": lesson, "function": name, "stars": stars_of(lesson, name),
                     "needs": sorted(called((lesson, name)), key=in_order)}
            for (lesson, name), number in numbers.items()}


def in_order(number):
    return [int(part) for part in number.split(".")]


def used_names(text, module, modules):
    """Return {name at the top of a module: the (module, name) that its text uses}."""
    tree, package = ast.parse(text), module.split(".")[:-1]
    meant, used = {}, {}
    for node in tree.body:
        if isinstance(node, ast.ImportFrom):
            base = package[:len(package) + 1 - node.level] if node.level else []
            home = ".".join([*base, *(node.module.split(".") if node.module else [])])
            for alias in node.names:
                whole = ".".join(filter(None, (home, alias.name)))
                meant[alias.asname or alias.name] = (whole, None) if whole in modules else (home, alias.name)
    for node in tree.body:
        targets = [node.name] if isinstance(node, (ast.FunctionDef, ast.ClassDef)) else [
            target.id for target in getattr(node, "targets", ()) if isinstance(target, ast.Name)]
        for target in targets:
            used[target] = list(dict.fromkeys(uses(node, module, meant)))
    for name, (home, original) in meant.items():                     # what it imports can be had from it, too
        if original is not None:
            used.setdefault(name, [(home, original)])
    return used


def uses(node, module, meant):
    """Yield the (module, name) that a statement uses; names of its own are harmless, because no module has them."""
    for part in ast.walk(node):
        if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Load):
            home, name = meant.get(part.id, (module, part.id))
            if name is not None:
                yield home, name
        elif isinstance(part, ast.Attribute) and isinstance(part.value, ast.Name) and part.value.id in meant:
            home, name = meant[part.value.id]
            if name is None:
                yield home, part.attr
