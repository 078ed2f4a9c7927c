"""The choice of lesson 12."""

import numpy as np

from . import Choice


def bounced_curve_is():
    """Heights [m] at one time just after a bounce, of balls that were dropped from h: four ideas, e = 0.5.

    In units in which g = 2, a ball falls for τ = √h, and the time is that of the highest, 1.  A rebound with e has
    x = 2 e √h (1 − √h) − (1 − √h)² = 2 (1 + e) √h − (1 + 2 e) h − 1.  The curve does not depend on g.
    """
    h = np.linspace(0.9, 1.0, 41)
    ideas = [2.0 * (1.0 + e) * np.sqrt(h) - (1.0 + 2.0 * e) * h for e in (0.5, 1.0)] + [0.0 * h, h]
    return Choice(h, tuple(y - y[0] for y in ideas), "Where are the balls just after their bounce?",
                  "dropped from h [m]", "height, less that of the ball from 0.9 m [m]")
