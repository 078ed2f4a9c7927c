"""A comet on a long ellipse: at its nearest a nineteenth of its farthest distance from the sun, where all the error is made."""

import numpy as np

from solutions.integrators import advance
from validate.scene import INTEGRATORS, LEFT_TO_FULL
from validate.scenes.kepler import ENGINES, ORDERS, Params, in_space, limits_at, observe, points, start, truth  # noqa: F401

TITLE, LESSON = "Kepler, near collision", "integrators"
T = 20.0                     # [s]: three revolutions
STEPS = (2000, 5000, 10000, 20000, 50000, 100000, 200000)
METHODS = INTEGRATORS
FULL_ONLY = LEFT_TO_FULL
FILM = 12.6                  # two revolutions [s]
UNCERTAINTY = 1e-12          # the truth's, as in kepler: 1e-13

CASES = {"e = 0.9": Params(e=0.9)}
PUBLISHED = ((20.0, (-1.295266251, 0.400393896), 1e-9),)


def acceleration(t, x, v, p):
    """a = −μ x/|x|³"""
    squared = 0.0
    for coordinate in x:
        squared += coordinate * coordinate
    return -p.mu / (squared * np.sqrt(squared)) * x


def run(step, acceleration, state, p, dt, steps):
    x, v = state
    return advance(step, acceleration, 0.0, x, v, dt, steps, p)


def tolerance(p, dt):
    """As in kepler.  The rate at the nearest point, √(μ/r³), is 32 times the mean one: most steps are wasted far away."""
    return limits_at(p, T, dt)


NEEDS = ("one point in the plane", "one step function")
LEAVES_OUT = {"the third dimension": in_space, "steps that adapt to the distance": "beyond this workbook",
              "rotation": "lesson 5 builds it"}
