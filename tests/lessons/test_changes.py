"""Small changes of a worked answer: what the command `python -m tests.mutants.changes` makes and finds."""

import ast

from ..mutants.changes import changes_of, graded

TEXT = '''
def step(x, v, dt, p):
    """Return x."""
    if x > 0.0:
        x = x + dt * v
    return x, p.a
'''


def test_each_change_is_one_small_one_and_the_docstring_stays():
    found = {(before, after) for _, before, after, _ in changes_of(ast.parse(TEXT))}
    assert {("x = x + dt * v", "x = x - dt * v"), ("x = x + dt * v", "x = x + v"), ("x = x + dt * v", "pass"),
            ("return (x, p.a)", "return (p.a, x)"), ("return (x, p.a)", "return (x, p.b)")} <= found
    assert {after.splitlines()[0] for before, after in found if before.startswith("if")} == {
        "if x >= 0.0:", "if x < 0.0:", "if x > 1.0:", "if False:", "if True:"}
    assert all("Return x" in ast.unparse(tree) for *_, tree in changes_of(ast.parse(TEXT)))


def test_a_changed_answer_with_other_results_loses_points():
    rows = list(graded("integrators", ("1.1", "1.4"), most=25))
    assert len(rows) > 30
    assert all(earned < possible for *_, earned, possible, differs, _ in rows if differs)
    assert all(earned == possible for *_, earned, possible, differs, _ in rows if not differs)
    assert any(named for *_, named in rows)
