"""Measurement of one scene: errors, orders and verdicts, then error against run time.

`selection.py` selects cases, methods, engines and steps.  `accuracy.py` compares runs with the truth, `timing.py` times
them, and `races.py` makes ratios of the times, with the cost of calls (`calls.py`) and of compilation
(`compilation.py`).  `full_loop.py` includes the parts that a scene omits; `switches.py` switches parts of engines off.
`film.py` makes the film.  `record.py` writes and `traces.py` reads the runs of pybullet, for machines without it, and
`agreement.py` computes a truth on which two codes agree.
"""

from . import accuracy, timing
from .accuracy import errors
from .full_loop import times
from .selection import Plan, Selection, load, select

__all__ = ["Plan", "Selection", "accuracy", "errors", "load", "select", "times", "timing"]
