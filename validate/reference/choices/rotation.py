"""Choices of lesson 5."""

import numpy as np

from validate.reference.rotation import FreeTop

from . import Choice

BRICK = np.array([0.4225, 1.0625, 1.36])      # 12 kg, edges of 1, 0.6 and 0.25 m: I = m (b² + c²)/12 [kg m²]
SPIN = 3.0                                    # about the middle axis [rad/s]


def times_of_a_flip():
    """Return four ideas of the time until a brick turns over, if its spin is disturbed by 10⁻ⁿ of itself.

    By elliptic functions the disturbance grows as e^(λt): a straight line.  The other three: the disturbance does not
    matter, the time is in inverse proportion to it, and below some disturbance the brick no longer turns over.
    """
    n = np.linspace(1.0, 4.0, 31)
    flips = np.array([FreeTop(BRICK, SPIN * np.array([0.0, 1.0, 10.0**-k])).flips()[0] for k in n])
    begin = flips[0]
    return Choice(n, (flips, np.full_like(n, begin), begin * (1.0 + 0.005 * (10.0 ** (n - 1.0) - 1.0)),
                      begin * 3.5 / (4.5 - n)), "a brick, disturbed by 10⁻ⁿ of its spin about the middle axis", "n",
                  "time until it turns over [s]")
