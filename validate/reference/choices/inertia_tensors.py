"""Choices of lesson 4."""

import numpy as np

from . import Choice

PULL = 9.81 * np.sin(0.2)    # of gravity along the slope [m/s²]


def four_rollers():
    """Return the ways of a solid cylinder, a solid ball, a hollow ball and a hoop.

    ½ a t²  with  a = g sin θ/(1 + I/(m R²))
    """
    t = np.linspace(0.0, 2.0, 101)
    shares = 1.0 / 2.0, 2.0 / 5.0, 2.0 / 3.0, 1.0
    return Choice(t, tuple(0.5 * PULL / (1.0 + share) * t * t for share in shares), "four round bodies on one slope",
                  "t [s]", "way along the slope [m]")
