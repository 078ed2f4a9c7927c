"""Choices of lesson 11."""

import numpy as np

from . import Choice


def errors_of_four_ways():
    """Return errors that shrink by a fixed factor, slowly, faster and alternating in sign, and one that is squared."""
    k = np.arange(9.0)
    return Choice(k, (0.5 * 0.85**k, 0.5 * 0.5**k, 0.5 * np.abs(-0.2) ** k, 0.5 ** (2.0**np.minimum(k, 5.0))),
                  "four ways to a target", "iterations", "distance to the target [m]", log=True)
