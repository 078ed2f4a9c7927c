"""Parts and views that the pictures of several exercises share."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from .marks import Arrow, Dots, Note, View, Way

BOTH_WAYS, TURN = np.array([-1.0, 1.0]), np.linspace(0.0, 2.0 * np.pi, 61)


class Picture(NamedTuple):
    """How the case of an exercise is drawn."""
    views: Callable          # (results, *arguments) → list of View; results: the answer, the expected one, or neither
    given: Callable          # (*arguments) → marks
    answer: Callable         # (result, *arguments) → marks; parts of an expected result may be None
    see: str                 # what a right answer looks like, as the end of a sentence


# ---------------------------------------------------------------------------------------------- views

def world_views(d):
    """Return the plane as it is, or space from above and from the side."""
    if d == 2:
        return [View("", np.eye(2), np.zeros(2), ("x [m]", "y [m]"))]
    return [View("from above", np.eye(3)[:2], np.zeros(3), ("x [m]", "y [m]")),
            View("from the side", np.eye(3)[::2], np.zeros(3), ("x [m]", "z [m]"))]


def in_world(_, first, *__):
    """Return the usual views of what has the dimension of the first argument."""
    return world_views(np.shape(first)[-1])


def flat(*_):
    return world_views(2)


def in_space(*_):
    return world_views(3)


def axes_of(first, second):
    """Return two orthogonal unit vectors (2, d), along the first vector and in the plane of both.

    Any if undetermined.
    """
    found = []
    for vector in (first, second, *np.eye(len(first))):
        rest = np.asarray(vector, dtype=float) / (np.linalg.norm(vector) or 1.0)
        for e in found:
            rest = rest - (rest @ e) * e
        if np.linalg.norm(rest) > 1e-6 and len(found) < 2:
            found.append(rest / np.linalg.norm(rest))
    return np.array(found)


def across(n, near):
    """Return a unit vector (d,) at right angles to n, in the plane of n and `near`."""
    return axes_of(n, near)[1]


def plane_view(title, first, second, origin, labels):
    """Return a view of the plane of two vectors (d,); of a scene in the plane the world's own."""
    if len(first) == 2:
        return world_views(2)[0]
    return View(title, axes_of(first, second), np.asarray(origin, dtype=float), labels)


# ---------------------------------------------------------------------------------------------- results and marks

def array(value, *shape):
    """Return a value as an array of that shape.  Raises ValueError for another one."""
    found = np.asarray(value, dtype=float)
    if found.shape != shape:
        raise ValueError(found.shape)
    return found


def part(result, name, number):
    """Return a field of a record, or the entry of a tuple; None where it is not known."""
    return getattr(result, name) if hasattr(result, name) else result[number]


def contact(result, *_):
    """Return both points of a Contact, the gap between them, and its normal."""
    p_a, p_b, n, gap = (part(result, name, k) for k, name in enumerate(("p_a", "p_b", "n", "gap")))
    found = [Dots(np.array([p], dtype=float), name) for p, name in ((p_a, "p_a"), (p_b, "p_b")) if p is not None]
    size = f", gap {gap:.4g} m" if gap is not None else ""
    if p_a is not None and p_b is not None:
        found.append(Way(np.array([p_a, p_b], dtype=float), f"p_a to p_b{size}", dots=False))
    elif gap is not None:
        found.append(Note(size.strip(", ")))
    if n is not None:
        texts = ", ".join(f"{c:.3g}" for c in n)
        length = abs(gap) if gap else 1.0
        found.append(Note(f"n = ({texts})") if p_b is None else
                     Arrow(np.asarray(p_b), length * np.asarray(n), "n, from p_b"))
    return found


def scaled(vector, length, *others):
    """Return a vector drawn so that the longest of all these has this length."""
    longest = max(np.linalg.norm(one) for one in (vector, *others))
    return np.asarray(vector, dtype=float) * (length / longest if longest > 0.0 else 0.0)


def size_of(*points):
    """Return the greatest extent of points along an axis [m]; 1 where all are in one place."""
    return np.ptp(np.concatenate([np.atleast_2d(one) for one in points]), axis=0).max() or 1.0
