"""Measurement of one scene: errors, orders and verdicts, then error against run time.

`selection.py` says what is to be done, `accuracy.py` compares it with the truth, `timing.py` times it, `full_loop.py`
puts in what it leaves out, `film.py` films it. `record.py` writes and `traces.py` reads what pybullet did, for machines
without it.
"""

from . import accuracy, timing
from .accuracy import errors
from .full_loop import times
from .selection import Plan, Selection, load, select

__all__ = ["Plan", "Selection", "accuracy", "errors", "load", "select", "times", "timing"]
