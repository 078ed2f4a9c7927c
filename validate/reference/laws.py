"""Laws that hold for every solver, and the verdict that they give where no theory predicts an engine's error."""

from typing import NamedTuple

import numpy as np

from ..check import Verdict


class Law(NamedTuple):
    """The largest value of a quantity in the watched steps, which would be zero if the law held exactly."""
    quantity: str
    found: float
    allowed: float           # by the law
    known: float | None      # by the engine's own rule; None: its rule gives no bound, or it has no such rule
    reason: str              # of that rule; empty without one

    @property
    def holds(self):
        """Return whether the law itself holds; False for NaN."""
        return self.found <= self.allowed

    @property
    def is_known(self):
        """Return whether it holds, or is broken as the engine's own rule says."""
        return self.holds or bool(self.reason and (self.known is None or self.found <= self.known))


def verdict_on(laws, kind, kept):
    """Return (Verdict, message) by these Laws.

    kind: what they are laws of, for people;    kept: the message where all of them hold
    """
    lost = [law for law in laws if not law.is_known]
    if lost:
        worst = max(lost, key=lambda law: law.found / law.allowed if law.found == law.found else np.inf)
        return Verdict.DEPARTS, f"breaks a law of {kind}: {said(worst)}, and {worst.allowed:.2g} is allowed"
    broken = [law for law in laws if not law.holds]
    if not broken:
        return Verdict.KEEPS_LAWS, kept
    by_reason = {law.reason: [said(one) for one in broken if one.reason == law.reason] for law in broken}
    return Verdict.BREAKS_AS_KNOWN, "; ".join(f"{', '.join(what)}, because {why}" for why, what in by_reason.items())


def said(law):
    """Return a quantity and its value in words, with enough digits to differ from what is allowed."""
    value = next((text for text in (f"{law.found:.{digits}g}" for digits in (2, 3, 4))
                  if text != f"{law.allowed:.2g}"), f"{law.found:g}")
    return f"{law.quantity.removesuffix(' [-]')}: {value}"
