"""Given.  The law of a planet around a fixed sun."""

import numpy as np


def attraction(t, x, v, p):
    """Given.  a = −μ x/|x|³

    Return the acceleration (d,) [m/s²]; μ [m³/s²] is a field of p.  The loop compiles faster than np.sum.
    """
    squared = 0.0
    for coordinate in x:
        squared += coordinate * coordinate
    return -p.mu / (squared * np.sqrt(squared)) * x
