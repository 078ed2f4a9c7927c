"""Points on strings: their Models, and the same motion with an unused coordinate."""

import numpy as np

from solutions.support.model import WORLD, Body, Distance, Hinge, make_model

LEAST = 1e-14                # moment of a point on a hinge [kg m²]: MuJoCo permits no less than 1e-15


def on_strings(x, m, g):
    """Return the Model of points x (n, 2) that cannot turn, each on a rod without mass; the first hangs on the origin.
    """
    return make_model([Body(tuple(place), m) for place in x], (0.0, -g),
                      [Distance(k, k - 1 if k else WORLD, (0.0, 0.0), (0.0, 0.0)) for k in range(len(x))])


def on_hinges(x, m, g):
    """Return the Model of the same points with moments, whose only coordinates are the angles of hinges."""
    above = ((0.0, 0.0), *map(tuple, x))
    return make_model([Body(tuple(place), m, inertia=LEAST) for place in x], (0.0, -g),
                      [Hinge(k, k - 1 if k else WORLD, above[k]) for k in range(len(x))])


def in_space(start):
    """Return p → (state, p) of start(p) → (x, v, network, …) in the plane: the same motion with three coordinates."""
    def wide_start(p):
        x, v, network, *others = start(p)
        wide = lambda y: np.concatenate((y, np.zeros((len(y), 1))), axis=1)
        return (wide(x), wide(v), network._replace(gravity=np.append(network.gravity, 0.0)), *others), p
    return wide_start
