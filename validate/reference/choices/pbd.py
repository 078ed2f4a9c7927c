"""Choices of lesson 8."""

import numpy as np

from . import Choice

LOW = 15.0 * 9.81 / 3600.0   # ½ N (N − 1) g dt²: a chain of six links of 1 m after a single visit per frame [m]


def chains_by_visits():
    """Return how much too low a chain hangs against the visits: sweeps, substeps, a compliance, and a single link."""
    n = np.arange(1.0, 17.0)
    return Choice(n, (LOW / n, LOW / n**2, np.full(n.size, LOW), LOW * 0.5 ** (n - 1.0)), "a chain of six links",
                  "visits to each link per frame", "too low [m]", log=True)
