"""Seeded faults: wrong physics, one or two lines each, that the validation report must notice.

One module per lesson, all data.  A fault changes a result; it is neither a typing error nor an exception.
`python -m tests.faults` plants each in a copy of the lessons, and runs the scenes and stability cases that execute it.
The wrong answers in tests/mutants are there for the grading tests; these are there for the report.
"""

import ast
import importlib
from typing import NamedTuple

from validate.subject import modules


class Fault(NamedTuple):
    """One wrong line in a function of a lesson, or of a given module."""
    lesson: str              # or support.rotation, support.geometry …
    function: str
    old: str                 # text that occurs exactly once in the function
    new: str                 # the text in its place
    wrong: str               # what is wrong physically, in a sentence
    missed: str = ""         # why the report does not notice it; empty: it must

    @property
    def name(self):
        """Its name in the table: the lesson, the function, and the changed text."""
        return f"{self.lesson}.{self.function}: {self.wrong}"


def collection(lesson):
    """Return fault(function, old, new, wrong, missed="", of=lesson), wrong_answer(edit, missed=""), and their Faults.

    `of` names a given module in place of the lesson.  An edit of tests/mutants that is also a fault stands there only.
    """
    faults = []

    def fault(function, old, new, wrong, missed="", of=lesson):
        faults.append(Fault(of, function, old, new, wrong, missed))

    def wrong_answer(edit, missed=""):
        fault(edit.name, edit.old, edit.new, edit.story, missed)

    return fault, wrong_answer, faults


def faults_of(lesson):
    """The faults of a lesson."""
    return importlib.import_module(f"{__name__}.{lesson}").FAULTS


def file_of(module):
    """The file of a lesson or of a given module below solutions/."""
    return module.replace(".", "/") + ".py"


def planted(fault):
    """The text of the module with the fault in it.  Raises ValueError unless the old text occurs once in the function.
    """
    text = (modules.SOLUTIONS / file_of(fault.lesson)).read_text(encoding="utf-8")
    function = next(node for node in ast.parse(text).body if getattr(node, "name", None) == fault.function)
    lines = text.splitlines(keepends=True)
    first = (function.body[1] if ast.get_docstring(function) else function.body[0]).lineno - 1
    body = "".join(lines[first:function.end_lineno])
    if body.count(fault.old) != 1 or fault.old == fault.new:
        raise ValueError(f"{fault.name}: {fault.old!r} occurs {body.count(fault.old)} times")
    return "".join([*lines[:first], body.replace(fault.old, fault.new), *lines[function.end_lineno:]])
