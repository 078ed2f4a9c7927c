"""Choices of lesson 6."""

import numpy as np

from . import Choice


def forces_against_a_wall():
    """Return four forces against the gap: a ramp, one over the root, one over the square, and a constant one."""
    gap = np.linspace(0.02, 1.0, 246)
    curves = 150.0 * (1.0 - gap), 12.0 / np.sqrt(gap), 0.04 / gap**2, np.full(gap.size, 120.0)
    return Choice(gap, curves, "four forces near a wall", "gap [m]", "force [N]", log=True)
