"""The command `python -m tests.mutants.changes LESSON`: which small changes of the worked answers keep their points?

A change is made in the syntax tree of an answer, without a look at the tests: another sign, operator, bound, index or
constant, two arguments exchanged, a statement left out.  A change that keeps its points is either the same answer
written another way, or a wrong idea that the tests accept.  A person must decide; `differs` helps.
"""

import ast
import collections
import copy
import inspect
import itertools
import random
import textwrap
import types
from typing import Annotated
from unittest import mock

import numpy as np
import typer
from rich.console import Console

from validate import mistakes
from validate.grading import points
from validate.run.command import start
from validate.subject import modules
from validate.subject.generate import exercises

SAME = 1e-9                  # two results are the same within this, relative to their size [-]
PATIENCE = 4.0               # a test of a changed answer may take this long [s]: some never end
OTHER = {ast.Add: (ast.Sub,), ast.Sub: (ast.Add,), ast.Mult: (ast.Div,), ast.Div: (ast.Mult,), ast.Pow: (ast.Mult,),
         ast.Lt: (ast.LtE, ast.Gt), ast.LtE: (ast.Lt, ast.GtE), ast.Gt: (ast.GtE, ast.Lt), ast.GtE: (ast.Gt, ast.LtE),
         ast.Eq: (ast.NotEq,), ast.NotEq: (ast.Eq,), ast.And: (ast.Or,), ast.Or: (ast.And,)}
NAMES = {"max": "min", "maximum": "minimum", "sin": "cos", "argmin": "argmax", "any": "all", "zeros": "ones", "a": "b",
         "v": "omega", "floor": "ceil", "hypot": "maximum", "norm": "max"}
NAMES |= {new: old for old, new in NAMES.items() if old not in ("hypot", "norm")}


def changes_of(tree):
    """Yield (line [-], text before, text after, changed tree) for each small change of a function's answer."""
    begin = first_line(tree)
    for number, node in enumerate(ast.walk(tree)):
        if getattr(node, "lineno", 0) < begin:
            continue
        for edit in edits_of(node):
            changed = copy.deepcopy(tree)
            other = next(itertools.islice(ast.walk(changed), number, None))
            before = ast.unparse(statement_at(tree, node.lineno))
            edit(other)
            ast.fix_missing_locations(changed)
            after = ast.unparse(statement_at(changed, node.lineno))
            if before != after:
                yield node.lineno, before, after, changed


def first_line(tree):
    """Return the line of the first statement behind the docstring."""
    body = tree.body[0].body
    return body[1].lineno if ast.get_docstring(tree.body[0]) and len(body) > 1 else body[0].lineno


def statement_at(tree, line):
    """Return the innermost statement that begins at this line or before, and ends behind it."""
    found = [node for node in ast.walk(tree) if isinstance(node, ast.stmt) and node.lineno <= line <= node.end_lineno]
    return head_of(max(found, key=lambda node: (node.lineno, -node.end_lineno)))


def head_of(node):
    """Return a statement without the block that it begins."""
    head = copy.copy(node)
    for block in ("body", "orelse"):
        if isinstance(getattr(head, block, None), list):
            setattr(head, block, [ast.Pass()] if block == "body" else [])
    return head


def edits_of(node):
    """Yield functions that change a node of the same kind in place."""
    if isinstance(node, ast.BinOp | ast.AugAssign | ast.BoolOp):
        yield from (lambda n, kind=kind: setattr(n, "op", kind()) for kind in OTHER.get(type(node.op), ()))
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.MatMult | ast.Sub | ast.Div):
        yield exchange_sides
    if isinstance(node, ast.BinOp):
        yield lambda n: become(n, n.left)
        yield lambda n: become(n, n.right)
    if isinstance(node, ast.Compare):
        yield from (lambda n, kind=kind: n.ops.__setitem__(0, kind()) for kind in OTHER.get(type(node.ops[0]), ()))
    if isinstance(node, ast.UnaryOp):
        yield lambda n: become(n, n.operand)
    if isinstance(node, ast.Constant) and type(node.value) in (int, float):
        yield from (lambda n, value=value: setattr(n, "value", value) for value in (node.value + 1, 2 * node.value, 0)
                    if value != node.value)
    if isinstance(node, ast.Call):
        yield from call_edits(node)
    if isinstance(node, ast.Attribute | ast.Name) and isinstance(node.ctx, ast.Load):
        field = "attr" if isinstance(node, ast.Attribute) else "id"
        if getattr(node, field) in NAMES:
            yield lambda n: setattr(n, field, NAMES[getattr(n, field)])
        if getattr(node, "attr", "") == "T":
            yield lambda n: become(n, n.value)
    if isinstance(node, ast.Tuple) and isinstance(node.ctx, ast.Load) and len(node.elts) > 1:
        yield lambda n: n.elts.insert(0, n.elts.pop())
    if isinstance(node, ast.If | ast.IfExp | ast.While):
        yield lambda n: setattr(n, "test", ast.Constant(False))
        if not isinstance(node, ast.While):
            yield lambda n: setattr(n, "test", ast.Constant(True))
    if isinstance(node, ast.AugAssign):
        yield lambda n: become(n, ast.Assign([n.target], n.value, lineno=n.lineno))
    if isinstance(node, ast.Assign | ast.AugAssign | ast.Expr | ast.Break | ast.Continue):
        yield lambda n: become(n, ast.Pass())


def call_edits(node):
    """Yield changes of a call: two arguments exchanged, a function of one argument left out."""
    for k in range(len(node.args) - 1):
        yield lambda n, k=k: n.args.__setitem__(slice(k, k + 2), n.args[k:k + 2][::-1])
    if len(node.args) == 1 and not node.keywords and not isinstance(node.args[0], ast.GeneratorExp | ast.Starred):
        yield lambda n: become(n, n.args[0])
    if getattr(node.func, "id", "") == "range":
        yield lambda n: n.args.__setitem__(-1, ast.BinOp(n.args[-1], ast.Sub(), ast.Constant(1)))
        yield lambda n: become(n, ast.Call(ast.Name("reversed", ast.Load()), [copy.copy(n)], []))


def exchange_sides(node):
    node.left, node.right = node.right, node.left


def become(node, other):
    """Turn a node into another one, in its place."""
    place = {key: getattr(node, key) for key in ("lineno", "end_lineno", "col_offset", "end_col_offset")}
    node.__class__ = other.__class__
    node.__dict__ = {**vars(other), **place}


class Compared:
    """A changed answer that notes whether it ever returns something else than the worked one."""

    def __init__(self, changed, worked):
        self.changed, self.worked, self.differs = changed, worked, False

    def __call__(self, *arguments):
        try:
            expected = self.worked(*copy.deepcopy(arguments))
        except Exception as error:
            expected = type(error)
        try:
            got = self.changed(*arguments)
        except Exception as error:
            self.differs |= type(error) is not expected
            raise
        self.differs |= not same(got, expected)
        return got


def same(a, b):
    """Whether two results are the same up to round-off."""
    if isinstance(a, tuple | list):
        return isinstance(b, tuple | list) and len(a) == len(b) and all(map(same, a, b))
    try:
        a, b = np.asarray(a, float), np.asarray(b, float)
        return a.shape == b.shape and bool(np.allclose(a, b, SAME, SAME * np.max(np.abs(b), initial=0.0), True))
    except (TypeError, ValueError):
        return type(a) is type(b)


def changed_answers(name, only, most, seed):
    """Yield (exercise, function's name, line, before, after, Compared) of at most so many changes of each answer."""
    module = vars(modules.bind(name))
    for exercise, function in exercises((modules.SOLUTIONS / f"{name}.py").read_text()).items():
        if only and exercise not in only:
            continue
        worked = module[function]
        tree = ast.parse(textwrap.dedent(inspect.getsource(worked)))
        all_changes = list(changes_of(tree))
        picked = random.Random(f"{seed} {exercise}").sample(all_changes, min(most, len(all_changes)))
        for line, before, after, changed in picked:
            space = dict(module)
            try:
                exec(compile(changed, f"<{function} changed>", "exec"), space)
            except (SyntaxError, ValueError):
                continue
            yield exercise, function, line, before, after, Compared(space[function], worked)


def graded(name, only=(), most=50, seed=0):
    """Yield (exercise, line, before, after, earned, possible, differs, named) of the changed answers."""
    module = vars(modules.bind(name))
    answers = list(changed_answers(name, only, most, seed))
    subjects = {}
    for number, (exercise, function, *_, answer) in enumerate(answers):
        subjects[str(number)] = (types.SimpleNamespace(**{**module, function: answer}),
                                 lambda asked, test, exercise=exercise: asked == exercise)
    traces = mistakes.Traces()
    with mock.patch.multiple(points, LIMIT=PATIENCE, AGAIN=PATIENCE):
        outcomes = points.grade_each(name, subjects, traces=traces)
    for number, (exercise, _, line, before, after, answer) in enumerate(answers):
        earned, possible = points.score(outcomes[str(number)])[exercise]
        named = mistakes.sentence(mistakes.matching(name, exercise, traces.of(str(number), exercise)))
        yield exercise, line, before, after, earned, possible, answer.differs, named


def main(lesson: Annotated[str, typer.Argument(help="Name of a lesson.")],
         exercise: Annotated[list[str] | None, typer.Option(help="Only this exercise.")] = None,
         most: Annotated[int, typer.Option(min=1, help="Changes per exercise.")] = 50,
         seed: Annotated[int, typer.Option(help="Of the draw of the changes.")] = 0):
    """Print the small changes of worked answers that keep their points, and how many lose them and are named."""
    console = Console(highlight=False, soft_wrap=True)
    counts = collections.Counter()
    for number, line, before, after, earned, possible, differs, named in graded(lesson, exercise or (), most, seed):
        kind = "lose all" if earned == 0 else "lose some" if earned < possible else "keep all"
        counts[kind] += 1
        counts["named"] += bool(named) and earned < possible
        if earned == possible:
            console.print(f"{number}  {'DIFFERS' if differs else 'same   '}  {line}: {before}\n{'':16}→ {after}",
                          markup=False)
    console.print(", ".join(f"{count} {kind}" for kind, count in counts.items()))


if __name__ == "__main__":
    start("python -m tests.mutants.changes", main)
