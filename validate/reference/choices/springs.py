"""Choices of lesson 2."""

import numpy as np

from . import Choice

MASS = 0.02                  # of the point on the spring [kg]


def longest_steps():
    """Return four ideas of the longest stable step over the stiffness; for one point on a spring it is 2 √(m/k)."""
    k = np.linspace(20.0, 800.0, 200)
    share = k[0] / k
    ideas = np.sqrt(share), share, np.full_like(k, 1.0), share * share
    return Choice(k, tuple(2.0 * np.sqrt(MASS / k[0]) * idea for idea in ideas), "a network of springs, ever stiffer",
                  "stiffness k [N/m]", "longest stable step [s]", log=True)
