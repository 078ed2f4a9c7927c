"""Measure one scene: errors, orders and verdicts, then error against run time.

`selection.py` says what is to be done, `accuracy.py` compares it with the truth, `timing.py` times it, `film.py`
films it. `record.py` writes and `traces.py` reads what pybullet did, for machines without it.
"""

from . import accuracy, timing
from .accuracy import errors
from .selection import Plan, Selection, load, select
from .timing import times

__all__ = ["Plan", "Selection", "accuracy", "errors", "load", "select", "times", "timing"]
