"""Results of a run as plain data: a Finding for each statement of theory, verdicts, and the roles of curves."""

from enum import Enum, StrEnum
from typing import NamedTuple

import numpy as np


class Finding(NamedTuple):
    """Theory predicts a value, something else gives another: it holds where they differ by no more than a tolerance.

    A stability case measures what it predicts.  A check of a truth compares it with another source.  Numbers may be
    arrays there, and all of them must agree.
    """
    claim: str               # the statement of theory, in one sentence; "" where the quantity says all
    quantity: str            # the measured quantity [unit]
    predicted: float         # the value from theory
    measured: float          # the value from the experiment
    tolerance: float         # derived before the experiment, or measured; in the unit of the quantity
    observation: str         # the result of the experiment, in one sentence
    tolerance_from: str = ""  # the measurement that the tolerance was taken from; empty where it was derived

    @property
    def holds(self):
        """Return whether experiment and theory agree; False for a failed measurement, which is NaN."""
        return bool(np.all(np.abs(np.subtract(self.measured, self.predicted)) <= self.tolerance))


def states(quantity, found, law, within):
    """Return the Finding that a truth must meet: `found` is what it gives, `law` what it must be to `within`."""
    return Finding("", quantity, law, found, within, "")


class Verdict(StrEnum):
    """The verdict on a method or an engine in one case."""
    AGREES = "agrees"                        # within the error that theory allows
    FOLLOWS_OWN_LAW = "as predicted"         # departs from the truth exactly as its own law says
    KEEPS_LAWS = "keeps the laws"            # no theory gives its error; its steps keep the laws of contact or joints
    BREAKS_AS_KNOWN = "breaks a law as known"  # the same, but for a rule of its own, which is named beforehand
    DEPARTS = "departs"                      # no theory predicted this
    UNDECIDED = "undecided"                  # too coarse to judge, or not recorded
    NOT_ATTEMPTED = "not attempted"          # the exercise has no answer yet
    UNFINISHED = "does not arrive"           # it does not come to its end, as the scene says
    REFERENCE = "reference"                  # the truth is a run of this engine: nothing is judged


class Allowed(NamedTuple):
    """What an engine's own rules say beyond the laws of contact: see `validate/reference/contact_laws.py`."""
    iterations: int          # per step
    slop: float = 0.0        # overlap up to which its solver lets bodies approach: a named tolerance [m]
    recovers: float = 0.0    # share of an overlap that its velocities take back per step [-]
    rules: tuple = ()        # (name of a quantity, end of a sentence with "because"): laws that it is known to break
    rests: bool = True       # False: bodies meet on the way, and may still move when the run ends
    soft: bool = False       # contacts are springs with dampers: what these leave has no bound


class JointsAllowed(NamedTuple):
    """The same of an engine whose bodies hang on joints: see `validate/reference/joint_laws.py`."""
    order: int               # of its step: 1 or 2
    # ("gap" or "energy", end of a sentence with "because", by what factor or None for any): laws that it may break
    rules: tuple = ()


class Whose(StrEnum):
    """Whose choice a departure from the truth is."""
    LAW = "its law"                          # of the method, or of the engine with the option that names the runner
    DEFAULT = "its default"                  # the engine has another setting without it
    SET_UP = "our set-up"                    # another set-up of the scene removes it; no scene here may have one


class Role(StrEnum):
    """Where a curve or a film comes from."""
    TRUTH = "truth"
    OURS = "ours"
    ENGINE = "engine"


BY_LAWS = Verdict.KEEPS_LAWS, Verdict.BREAKS_AS_KNOWN
JUDGED_RIGHT = Verdict.AGREES, Verdict.FOLLOWS_OWN_LAW, *BY_LAWS


def is_right(curve):
    """Return True, False, or None if undecided, for the stored record of a curve."""
    return {**dict.fromkeys(JUDGED_RIGHT, True), Verdict.DEPARTS: False}.get(Verdict(curve["verdict"]))


def jsonable(value):
    """Return the same data in JSON's types; numbers that are not finite become None."""
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
