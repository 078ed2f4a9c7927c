"""Numbers of the reference solutions that take seconds to compute: `validate record` stores them with a scene."""

import json
from contextlib import contextmanager
from functools import cache
from pathlib import Path

RECORDED = Path(__file__).resolve().parent.parent / "recorded"
_computing: list[dict] = []  # [{key: number}] of the block `computed_anew`


@cache
def numbers(scene):
    """Return {key: number} that were stored for a scene."""
    try:
        return json.loads((RECORDED / f"{scene}.json").read_text(encoding="utf-8")).get("numbers", {})
    except (OSError, ValueError):        # measure/traces.py names a damaged file, when it reads the engine's runs
        return {}


def stored(scene, function, *arguments):
    """Return the number function(*arguments): the stored one if a case of the scene has these arguments.

    Arguments are numbers, texts, and tuples of them.
    """
    key = json.dumps([function.__name__, *arguments], ensure_ascii=False)
    if _computing:
        _computing[-1][key] = number = function(*arguments)
        return number
    found = numbers(scene).get(key)
    return function(*arguments) if found is None else found


@contextmanager
def computed_anew():
    """Yield {key: number} of all that `stored` returns during the block, in which it computes every number."""
    _computing.append({})
    try:
        yield _computing[-1]
    finally:
        _computing.pop()
