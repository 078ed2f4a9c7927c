"""Pages about the functions of each lesson, made from the lessons as students get them: signatures and docstrings only.

They are written as reStructuredText, because Sphinx's search finds functions that are declared in it.
"""

import ast
import re
import textwrap
from functools import cache

from ..subject import generate, modules
from ..subject.modules import SOLUTIONS
from . import course

GIVEN = "solutions.given.", "solutions.support."
SECTION = re.compile(r"^# -{20,} *(.+)$", re.M)
FORMULA = re.compile(r"^\s|\s{3,}|^\S+( \S+)? [=←≥≤] ")        # a line whose columns or breaks matter
LABEL = re.compile(r"^\*(Source|Left out):\*|^Raises \w")      # a line that begins a paragraph of its own
QUOTE = re.compile(r"`([^`\n]+)`")
EMPHASIS = re.compile(r"(?<!\S)\*(\w[\w ,-]*:?)\*(?=[\s.,;:)]|$)")
NAME = re.compile(r"(?<![\w.])([a-z]\w*_\w+)(?!\w)")           # a bare word with an underscore may be a function


@cache
def functions():
    """Return {function: "lessons.<lesson>.<function>"} of all functions whose name stands in one lesson only."""
    found = {}
    for name in modules.lesson_names():
        for node in tree_of(name).body:
            if isinstance(node, ast.FunctionDef):
                found[node.name] = None if node.name in found else f"lessons.{name}.{node.name}"
    return {name: target for name, target in found.items() if target}


@cache
def text_of(name):
    """Return the text of a lesson without answers."""
    return generate.stub((SOLUTIONS / f"{name}.py").read_text(encoding="utf-8"))


@cache
def tree_of(name):
    return ast.parse(text_of(name))


# ---------------------------------------------------------------------------------------------- docstrings

def prose(text):
    """Return a paragraph as reStructuredText: names of functions become links, and all other markup is escaped."""
    text, kept = " ".join(text.split()), []

    def keep(markup):
        kept.append(markup)
        return f"\0{len(kept) - 1}\0"

    text = QUOTE.sub(lambda match: keep(f"``{match[1]}``"), text)
    text = EMPHASIS.sub(lambda match: keep(f"*{match[1]}*"), text)
    text = NAME.sub(lambda match: keep(link(match[1])) if match[1] in functions() else match[0], text)
    text = re.sub(r"([\\*`|_\[\]<>])", r"\\\1", text)
    return re.sub(r"\0(\d+)\0", lambda match: kept[int(match[1])], text)


def link(name):
    """Return a link to the entry of a function."""
    return f":py:func:`~{functions()[name]}`\\ "


def blocks(docstring):
    """Generate (whether the lines are to be shown as they are, lines) of a docstring."""
    lines, exact = [], False
    for number, line in enumerate([*docstring.splitlines(), ""]):
        as_is = number > 0 and bool(FORMULA.search(line)) and not LABEL.match(line)
        begins = not line.strip() or as_is != exact or LABEL.match(line) or number == 1
        if begins and lines:
            yield exact, lines
            lines = []
        exact = as_is
        if line.strip():
            lines.append(line)


def as_rst(docstring):
    """Return a docstring as reStructuredText."""
    parts = []
    for exact, lines in blocks(docstring):
        if exact:
            parts.append(".. code-block:: text\n\n" + textwrap.indent(textwrap.dedent("\n".join(lines)), "   "))
        else:
            parts.append(prose(" ".join(lines)))
    return "\n\n".join(parts)


# ---------------------------------------------------------------------------------------------- pages

def heading(text, line):
    return f"{prose(text)}\n{line * (2 * len(text) + 8)}"


def page(name):
    """Return the page of one lesson."""
    lesson = course.lessons()[name]
    first, _, rest = ast.get_docstring(tree_of(name)).partition("\n")
    said = re.sub(r"^Lesson \d+\. *", "", first).rstrip(".")
    numbers = {exercise.function: exercise for exercise in lesson.exercises}
    parts = [f".. py:module:: lessons.{name}", heading(f"{lesson.number} · {name}: functions", "="), prose(f"{said}."),
             f"Notebook: :doc:`/notebooks/{course.notebook_of(name).stem}`. {len(numbers)} exercises, "
             f"{lesson.points:g} points. A number marks an exercise; all other functions are given.",
             as_rst("\n" + rest.strip("\n"))]
    text = text_of(name)
    sections = [(text.count("\n", 0, match.start()) + 1, match[1]) for match in SECTION.finditer(text)]
    for node in tree_of(name).body:
        while sections and sections[0][0] < node.lineno:
            parts.append(heading(sections.pop(0)[1].strip().capitalize(), "-"))
        if isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
            parts.append(function(node, numbers.get(node.name)))
        elif isinstance(node, ast.ClassDef):
            parts.append(record(node, name))
    parts += imported(name)
    return "\n\n".join(parts) + "\n"


def function(node, exercise):
    """Return the entry of a function."""
    said = (ast.get_docstring(node) or "").replace("Given.  ", "")
    about = []
    if exercise:
        calls = [f"{number} :py:func:`~{target(number)}`" for number in exercise.uses]
        about = [f"**Exercise {exercise.number}** · {exercise.points:g} point{'s' * (exercise.points != 1)}"
                 + (f"; calls {', '.join(calls)}" if calls else "")]
    body = "\n\n".join([*about, as_rst(said)])
    return f".. py:function:: {node.name}({ast.unparse(node.args)})\n\n{textwrap.indent(body, '   ')}"


@cache
def targets():
    return {exercise.number: f"lessons.{lesson.name}.{exercise.function}"
            for lesson in course.lessons().values() for exercise in lesson.exercises}


def target(number):
    """Return the full name of the function of an exercise."""
    return targets()[number]


def record(node, name):
    """Return the entry of a record: its fields with their units, as they stand in the lesson."""
    lines = text_of(name).splitlines()[node.lineno:node.end_lineno]              # whole lines: with their comments
    fields = [line for line in lines if re.match(r" +\w+: ", line)]
    body = as_rst(ast.get_docstring(node) or "")
    if fields:
        body += "\n\n.. code-block:: python\n\n" + textwrap.indent(textwrap.dedent("\n".join(fields)), "   ")
    return f".. py:class:: {node.name}\n\n{textwrap.indent(body, '   ')}"


def imported(name):
    """Return the given functions and records that the lesson imports and exports: names and first sentences."""
    rows = []
    for node in tree_of(name).body:
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith(GIVEN):
            file = SOLUTIONS.parent / f"{node.module.replace('.', '/')}.py"
            there = {one.name: one for one in ast.parse(file.read_text(encoding="utf-8")).body
                     if isinstance(one, (ast.FunctionDef, ast.ClassDef))}
            rows += [entry(there[alias.name], file) for alias in node.names if alias.name in there]
    if not rows:
        return []
    return [heading("Given in other files", "-"), "This lesson imports them.", "\n".join(rows)]


def entry(node, file):
    said = (ast.get_docstring(node) or "").partition("\n\n")[0].replace("Given.  ", "")
    signature = f"({ast.unparse(node.args)})" if isinstance(node, ast.FunctionDef) else ""
    return f"``{node.name}{signature}``\n   {prose(said)} (``{file.parent.name}/{file.name}``)"
