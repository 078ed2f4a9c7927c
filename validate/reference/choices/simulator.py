"""Choices of lesson 10."""

import numpy as np

from . import Choice

EVENT = 1.2                  # the time that three of the curves approach [s]


def times_of_an_event():
    """Return four laws of the time of an event against the step: of order 1, 2 and ½, and without a limit."""
    dt = 0.1 * 0.5 ** np.arange(6.0)[::-1]
    return Choice(dt, (EVENT + 0.8 * dt, EVENT + 8.0 * dt**2, EVENT + 0.25 * np.sqrt(dt), 1.38 + 0.025 * np.log2(dt)),
                  "four laws of the time of an event", "step dt [s]", "time of the event [s]")
