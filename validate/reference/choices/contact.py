"""The question of lesson 9."""

import numpy as np

from ..contact import four_residuals
from . import Choice


def residuals_of_four_solvers():
    """Return the residuals of four solvers of one problem with friction: see four_residuals."""
    curves = np.maximum(four_residuals(), 1e-16)
    return Choice(np.arange(curves.shape[1]), tuple(np.minimum(curves, 1e3)), "five discs that are thrown",
                  "iterations", "residual [m/s]", log=True)
