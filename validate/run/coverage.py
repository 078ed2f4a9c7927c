"""Coverage of the exercises by scenes and stability cases, read from their source.

A scene runs its methods and what it names of a lesson; a case runs what it names of the lesson that it is given.
Both run all functions that these call in turn.  The table says where a wrong answer can show, and that no exercise is
without such a place.  The seeded faults of the tests show whether the place notices it.
"""

import ast
import inspect
import re
from functools import cache
from pathlib import Path

from .. import methods
from ..scene import Method
from ..stability.examine import all_cases
from ..subject import modules

STABILITY = "stability/"
PARTS = ast.Name, ast.Attribute, ast.Constant, ast.ImportFrom
LETTERS = '"A", "B", "C" or "D"'                          # in the docstring of every choice
CHECKS = "check"             # begins the names of functions that refuse bad input, which no scene gives
CHECKED_ELSEWHERE = "records", "model_checks"            # modules of such functions: the tests of students call them


@cache
def trees():
    """Return {module below solutions: its syntax tree}, such as "pbd" and "given.ropes"."""
    files = {path.relative_to(modules.SOLUTIONS).with_suffix(""): path for path in modules.SOLUTIONS.rglob("*.py")}
    return {".".join(name.parts): ast.parse(path.read_text(encoding="utf-8")) for name, path in files.items()}


@cache
def parts(piece):
    """Return all names, attributes, constants and imports in a piece of source."""
    return [node for node in ast.walk(piece) if isinstance(node, PARTS)]


def imported(tree, home=""):
    """Return {name: (module below solutions, its name there, or None for a module)} of the imports of a file.

    What a file imports with a star is not among them: `starred` has those modules.
    """
    found = {}
    for node, module in from_solutions(tree, home):
        for alias in node.names:
            whole = f"{module}.{alias.name}" if module else alias.name
            is_module = not module or whole in modules.given_modules()
            found[alias.asname or alias.name] = (whole, None) if is_module else (module, alias.name)
    return found


def from_solutions(tree, home=""):
    """Yield (import, module below solutions) of what a file imports from there."""
    for node in parts(tree):
        if isinstance(node, ast.ImportFrom):
            module = node.module or ""
            if node.level:
                yield node, ".".join([*home.split(".")[:-node.level], *([module] if module else [])])
            elif module == "solutions" or module.startswith("solutions."):
                yield node, module.removeprefix("solutions").removeprefix(".")


@cache
def starred(module):
    """Return the modules below solutions of which a module there imports everything."""
    return [there for node, there in from_solutions(trees()[module], module) if node.names[0].name == "*"]


@cache
def calls():
    """Return {(module, function): what it names of solutions} for every function of solutions."""
    found = {}
    for module, tree in trees().items():
        there = imported(tree, module)
        there |= {node.name: (module, node.name) for node in tree.body if isinstance(node, ast.FunctionDef)}
        for node in tree.body:
            if isinstance(node, ast.FunctionDef):
                names = {n.id for n in ast.walk(node) if isinstance(n, ast.Name)}
                found[module, node.name] = {there[name] for name in names if name in there}
    return found


@cache
def defined(place):
    """Return (module, function) where it is defined; None where it is no function.

    A lesson may import it from elsewhere, or have it in its companion, which may import it, too.
    """
    seen, waiting = set(), [place]
    while waiting:
        module, name = place = waiting.pop()
        if place in calls():
            return place
        if place in seen or module not in trees():
            continue
        seen.add(place)
        waiting += [(there, name) for there in starred(module)]
        waiting += [(f"given.{module}", name)] if f"given.{module}" in trees() else []
        waiting += [imports_of(module)[name]] if name in imports_of(module) else []
    return None


@cache
def imports_of(module):
    """Return what a module below solutions imports, as `imported` says it; nothing where there is no such module."""
    return imported(trees()[module], module) if module in trees() else {}


def reached(roots):
    """Return all functions that these call, directly or indirectly, including themselves."""
    found, waiting = set(), [place for root in roots if (place := defined(root))]
    while waiting:
        place = waiting.pop()
        if place not in found:
            found.add(place)
            waiting += [there for called in calls()[place] if (there := defined(called))]
    return found


def named(nodes, there, lesson):
    """Return the names in pieces of source: imported names, attributes of a lesson, and its functions in quotes."""
    for node in nodes:
        for one in parts(node):
            if isinstance(one, ast.Name) and one.id in there and there[one.id][1]:
                yield there[one.id]
            elif isinstance(one, ast.Attribute) and isinstance(one.value, ast.Name):
                owner = one.value.id
                if owner == "lesson":
                    yield lesson, one.attr
                elif owner in there and there[owner][1] is None:
                    yield there[owner][0], one.attr
            elif isinstance(one, ast.Constant) and isinstance(one.value, str) and defined((lesson, one.value)):
                yield lesson, one.value


@cache
def parsed(path):
    """Return (syntax tree, what it imports from solutions, {name: its definition}) of a file."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    own = {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}
    own |= {target.id: node for node in tree.body if isinstance(node, ast.Assign)
            for target in node.targets if isinstance(target, ast.Name)}
    return tree, imported(tree), own


def roots_of_scene(name):
    """Return what a scene calls of `lessons` and names of solutions, its methods included."""
    scene = modules.bind_scene(name)
    tree, there, _ = parsed(modules.scene_files()[name])
    return {*modules.called_by_scene(name), *named([tree], there, scene.lesson),
            *((r.who.lesson, r.who.function) for r in scene.our_runners)}


def roots_of_case(case):
    """Return what a stability case names of its lesson, in its own function and in what it uses of its file."""
    _, there, own = parsed(Path(inspect.getsourcefile(case.examine)))
    pieces, waiting = {}, [case.examine.__name__]
    while waiting:
        name = waiting.pop()
        if name not in pieces:
            pieces[name] = own[name]
            waiting += [n.id for n in parts(own[name]) if isinstance(n, ast.Name) and n.id in own]
    return {*named(pieces.values(), there, case.lesson), *methods_in(pieces.values())}


def methods_in(nodes):
    """Yield the functions of the methods that pieces of source name, such as INTEGRATORS."""
    for node in nodes:
        for one in parts(node):
            found = getattr(methods, one.id, ()) if isinstance(one, ast.Name) else ()
            for method in [found] if isinstance(found, Method) else found if isinstance(found, tuple) else ():
                if isinstance(method, Method):
                    yield method.lesson, method.function


def exercises(lesson):
    """Return [(number, function)] of the exercises that wait in lessons/, in the order of the text.

    The letter of a choice is not among them, because no scene computes with it.
    """
    text = (modules.ROOT / "lessons" / f"{lesson}.py").read_text(encoding="utf-8")
    choices = {node.name for node in trees()[lesson].body if isinstance(node, ast.FunctionDef) and is_choice(node)}
    found = re.findall(r'raise NotImplementedError\("Exercise ([\d.]+): (\w+)"\)', text)
    return [(number, function) for number, function in found if function not in choices]


def is_choice(function):
    """Tell whether a function returns the letter of a choice: it takes no arguments, and its docstring offers letters.

    The docstring says so in a copy without worked answers, too.
    """
    return not function.args.args and LETTERS in (ast.get_docstring(function) or "")


@cache
def places():
    """Return {(module, function): the scenes and stability cases that run it}, in the order of the course."""
    where = {}
    for name in modules.in_course_order(modules.scene_names()):
        for place in reached(roots_of_scene(name)):
            where.setdefault(place, []).append(name)
    for case in all_cases():
        for place in reached(roots_of_case(case)):
            where.setdefault(place, []).append(f"{STABILITY}{case.lesson}/{case.slug}")
    return where


@cache
def given():
    """Return {given module: {function: the places that run it}}, without those that only check an input."""
    where = places()
    return {module: {node.name: where.get((module, node.name), []) for node in tree.body
                     if isinstance(node, ast.FunctionDef) and not node.name.startswith(CHECKS)}
            for module, tree in trees().items() if module.startswith(("given.", "support.")) and
            not module.endswith(("__init__", *CHECKED_ELSEWHERE))}


@cache
def table():
    """Return {exercise: {"lesson", "function", "places"}} in the order of the course.

    places: scenes and stability cases.
    """
    where = places()
    return {number: {"lesson": lesson, "function": function, "places": where.get((lesson, function), [])}
            for lesson in modules.lesson_names() for number, function in exercises(lesson)}


def missing():
    """Return the exercises that nothing in the report runs."""
    return [f"{number} {row['function']}" for number, row in table().items() if not row["places"]]
