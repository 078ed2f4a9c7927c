"""The case in which a check failed, as data: a function's arguments, its result, and the expected result.

pytest writes it for a notebook, which draws it (`notebook/cases.py`).  It is kept for public inputs only, where the
message of the check names them, too: nothing is traced with a secret seed, nor in the grader's sandbox.
"""

import json
import types
from typing import NamedTuple

import numpy as np

MOST_NUMBERS = 20_000        # of all arguments together; more are not drawn [-]
ARRAY, RECORD, OTHER = "array", "record", "other"


class Case(NamedTuple):
    """A call of an exercise's function in a test that failed."""
    exercise: str
    test: str
    arguments: list          # as `decoded` gives them; None in place of a function
    result: object           # what it returned; None if it did not return
    expected: object         # like the result, with None in place of what the test does not say; or None


def expected_result(result, got, expected):
    """Return the expected result if a test compared all of a result, or parts of it, with numbers; None otherwise.

    got was compared with `expected`.  A part of a record or tuple is the one that is equal to `got`.
    """
    if got is None or expected is None or result is None:
        return None
    if isinstance(result, tuple):
        parts = [expected if is_same(part, got) else None for part in result]
        if all(part is None for part in parts):
            return expected if is_same(result, got) else None
        return result._make(parts) if hasattr(result, "_make") else tuple(parts)
    return expected if is_same(result, got) else None


def is_same(part, got):
    """Return whether two things hold the same numbers; the rows of an array may have changed places."""
    try:
        part, got = np.asarray(part, dtype=float), np.asarray(got, dtype=float)
    except (TypeError, ValueError):
        return False
    if part.shape != got.shape:
        return False
    by_rows = [rows[np.lexsort(rows.T)] if rows.ndim == 2 else rows for rows in (part, got)]
    return np.array_equal(*by_rows, equal_nan=True)


# ---------------------------------------------------------------------------------------------- as JSON

def encoded(case):
    """Return the case as text; None where it is too large."""
    tree = [_tree(part) for part in case]
    return json.dumps(tree) if count(tree) <= MOST_NUMBERS else None


def decoded(text):
    """Return the Case of a text.  Records become objects with the same fields."""
    return Case(*map(_value, json.loads(text)))


def count(tree):
    if isinstance(tree, dict):
        return sum(map(count, tree.values()))
    return sum(map(count, tree)) if isinstance(tree, list) else 1


def _tree(value):
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    if isinstance(value, np.bool_):
        return bool(value)
    if isinstance(value, np.number):
        return float(value)
    if isinstance(value, np.ndarray):
        return {ARRAY: value.tolist()} if value.dtype.kind in "biuf" else {OTHER: type(value).__name__}
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        return {RECORD: {name: _tree(part) for name, part in zip(value._fields, value)}}
    if isinstance(value, (list, tuple)):
        return [_tree(part) for part in value]
    return {OTHER: type(value).__name__}


def _value(tree):
    if isinstance(tree, list):
        return [_value(part) for part in tree]
    if not isinstance(tree, dict):
        return tree
    (kind, content), = tree.items()
    if kind == ARRAY:
        return np.array(content, dtype=float)
    return types.SimpleNamespace(**{name: _value(part) for name, part in content.items()}) if kind == RECORD else None
