"""Copies of impacts at different phases of a step: runners that detect them late, or at the right time."""

from functools import partial

import numpy as np

from solutions.support.model import Body, make_model
from solutions.support.shapes import HalfSpace
from validate.engines.bullet import IMPACT_SETTINGS
from validate.reference.impulses import APART, BULLET_RULE, CHIPMUNK_RULE, COPIES, ONLY_ROUND_OFF, PROJECTING_RULE
from validate.scene import EXACT, PYBULLET, PYMUNK, engine, ours


def impact_runners(methods, limits, late, in_pymunk, in_pybullet, pymunk_errs=None, bullet_errs=None,
                   **pybullet):
    """Return the runners of a scene of impacts: our methods, pymunk and pybullet.

    methods        one that projects, and one that goes back to the moment of the impact
    late           (p, dt, rule) → Prediction of a runner that detects an impact at the end of a step
    in_*           (make, settings) of an engine
    *_errs         further arguments of `late` for an engine
    pybullet       further fields of pybullet's runner
    """
    projecting, backtracking = methods
    (pymunk_make, circles), (pybullet_make, spheres) = in_pymunk, in_pybullet
    return (
        ours(projecting, limit=limits, predicted=partial(late, rule=PROJECTING_RULE)),
        # between impacts at known times the motion is a straight line or a parabola
        ours(backtracking, limit=limits, predicted=ONLY_ROUND_OFF, order=EXACT),
        engine(PYMUNK, "", pymunk_make, f"{COPIES} {circles}",
               order=1, limit=limits, predicted=partial(late, rule=CHIPMUNK_RULE, **pymunk_errs or {})),
        engine(PYBULLET, "", pybullet_make, f"{COPIES} {spheres}; {IMPACT_SETTINGS}",
               order=1, limit=limits, predicted=partial(late, rule=BULLET_RULE, **bullet_errs or {}), **pybullet),
    )


def copies_of(state, bodies):
    """Return (x, v), each (COPIES, bodies, 2), of a State with copies that stand APART in y."""
    x = state.x - np.outer(np.repeat(np.arange(COPIES), bodies), (0.0, APART))
    return x.reshape(COPIES, bodies, 2), state.v.reshape(COPIES, bodies, 2)


def over_floor(balls, g):
    """Make balls over the floor y = 0, each APART from the one before, further along it."""
    floor = Body((0.0, 0.0), shape=HalfSpace((0.0, 1.0)), mu=1.0, e=1.0)
    return make_model([floor, *(ball._replace(x=(ball.x[0] + APART * k, ball.x[1])) for k, ball in enumerate(balls))],
                      (0.0, -g))


def above_floor(state, radius):
    """Return (x, v (n, 2), ω (n,)) of such balls, where x is their lowest points without their distances."""
    apart = APART * np.arange(len(state.x) - 1)
    return state.x[1:] - np.stack((apart, np.full(len(apart), radius)), axis=1), state.v[1:], state.omega[1:]


def in_space(start):
    """Return p → (state, p) of a scene whose parameter `space` is the number of unused coordinates."""
    def wide_start(p):
        p = p._replace(space=1.0)
        return start(p), p
    return wide_start
