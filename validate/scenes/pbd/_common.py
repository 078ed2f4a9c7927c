"""Points on threads: the same motion with an unused coordinate."""

import numpy as np


def in_space(start):
    """Return p → (state, p) of start(p) → (x, v, network) in the plane: the same motion with three coordinates."""
    def wide_start(p):
        x, v, network = start(p)
        wide = lambda y: np.concatenate((y, np.zeros((len(y), 1))), axis=1)
        return (wide(x), wide(v), network._replace(gravity=np.append(network.gravity, 0.0))), p
    return wide_start
