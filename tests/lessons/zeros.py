"""Vectors that are not zero, although an entry, their sum, their product or their largest entry is."""

import numpy as np


def nearly_zero(draw, n, low=0.5, high=1.5):
    """List vectors (n,): one entry alone, in each place and of either sign, and two entries that add up to 0."""
    alone = [sign * draw(low, high) * one for one in np.eye(n) for sign in (1.0, -1.0)]
    pairs = [draw(low, high) * (one - other) for one, other in zip(np.eye(n)[:-1], np.eye(n)[1:], strict=True)]
    return alone + [sign * pair for pair in pairs[:1] + pairs[1:][-1:] for sign in (1.0, -1.0)]
