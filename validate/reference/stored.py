"""Numbers of the reference that take seconds: `validate record` computes them once, and keeps them with a scene.

A motion on which two codes agree is kept there, too; `measure/agreement.py` computes it.
"""

import json
from contextlib import contextmanager
from functools import cache
from pathlib import Path

RECORDED = Path(__file__).resolve().parent.parent / "recorded"
_computing: list[dict] = []  # [{key: number}] of the block `computed_anew`


@cache
def numbers(scene):
    """Return {key: number} that were stored for a scene."""
    return kept(scene).get("numbers", {})


def kept(scene):
    """Return what the record of a scene holds; nothing without one."""
    try:
        return json.loads((RECORDED / f"{scene}.json").read_text(encoding="utf-8"))
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


@cache
def agreements(scene):
    """Return {key: motion} on which two codes agree, of the cases of a scene; measure/agreement.py writes them."""
    return kept(scene).get("agreed", {})


def agreed(scene, p):
    """Return the motion of this case, or None."""
    return agreements(scene).get(key_of(p))


def key_of(p):
    """Return the key of a case: the values of its parameters."""
    return json.dumps(list(p))


@contextmanager
def computed_anew():
    """Yield {key: number} of all that `stored` returns during the block, in which it computes every number."""
    _computing.append({})
    try:
        yield _computing[-1]
    finally:
        _computing.pop()
