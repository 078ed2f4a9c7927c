"""Numbers of the reference that take seconds: `validate record` computes them once, and keeps them with a scene."""

import json
from contextlib import contextmanager
from functools import cache
from pathlib import Path

RECORDED = Path(__file__).resolve().parent.parent / "recorded"
_computing: list[dict] = []  # [{key: number}] of the block `computed_anew`


@cache
def numbers(scene):
    """{key: number} that were stored for a scene."""
    try:
        return json.loads((RECORDED / f"{scene}.json").read_text(encoding="utf-8")).get("numbers", {})
    except (OSError, ValueError):        # measure/traces.py names a damaged file, when it reads the engine's runs
        return {}


def stored(scene, function, *arguments):
    """Return the number function(*arguments), stored where these are the arguments of a case of the scene.

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
    """Give {key: number} of all that `stored` returns during the block, and let it compute each of them."""
    _computing.append({})
    try:
        yield _computing[-1]
    finally:
        _computing.pop()
