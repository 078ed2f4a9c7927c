"""What a run finds, as plain data: the words that stored results use for verdicts and roles."""

from enum import Enum, StrEnum

import numpy as np


class Verdict(StrEnum):
    """What became of a method or an engine in one case."""
    AGREES = "agrees"                        # within the error that theory allows
    FOLLOWS_OWN_LAW = "as predicted"         # departs from the truth exactly as its own law says
    DEPARTS = "departs"                      # nobody predicted this
    UNDECIDED = "undecided"                  # too coarse to judge, or not recorded
    NOT_ATTEMPTED = "not attempted"          # the exercise has no answer yet


class Role(StrEnum):
    """Where a curve or a film comes from."""
    TRUTH = "truth"
    OURS = "ours"
    ENGINE = "engine"


def is_right(curve):
    """True, False, or None where nothing can be said, for the stored record of a curve."""
    return {Verdict.AGREES: True, Verdict.FOLLOWS_OWN_LAW: True, Verdict.DEPARTS: False}.get(Verdict(curve["verdict"]))


def jsonable(value):
    """The same data in types that JSON knows; numbers that are not finite become None."""
    if isinstance(value, dict):
        return {str(k): jsonable(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [jsonable(v) for v in value]
    if isinstance(value, np.ndarray):
        return jsonable(value.tolist())
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    if isinstance(value, (int, np.integer)):
        return int(value)
    if isinstance(value, (float, np.floating)):
        return float(value) if np.isfinite(value) else None
    return value
