"""Balls that stop when they touch an obstacle: initial states, limits, and runners."""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from solutions.collisions import Plane
from solutions.given.collisions import Target
from validate.engines.collisions import SWEPT_SETTINGS, across, bullet_rays, bullet_swept, sweep
from validate.methods import CONTINUOUS, DISCRETE
from validate.reference.collisions import COPIES, ONLY_ROUND_OFF, detection_errors, impact_times, rounded_way
from validate.scene import EXACT, PYBULLET, ROUND_OFF, engine, ours
from validate.scenes._common import check_positives

PLACE_APART = 1.0            # metre between two copies along the x axis
SHARES = (0.8, 0.95, 0.99, 0.999)  # radii that pybullet sweeps, over that of the ball [-]: our choices
ENGINE_SPEEDS = (1.0, 1e2, 1e4)  # of the balls in an engine [m/s]: the lowest, the middle, the highest

# how far from a round shape pybullet's rays and sweeps may end [m].  Both advance while the distance is larger than
# this.  Source: Bullet, btGjkConvexCast, which rayTestBatch asks for, and btContinuousConvexCollision: radius = 0.001
RAY_ENDS = 1e-3


class Flight(NamedTuple):
    """Balls that stop at an obstacle, and the relative errors of their positions."""
    T: float                 # [s]
    place: Callable          # p → (x, v), each (n, 3): initial state
    truth: Callable          # (p, t) → their positions
    steep: float             # smallest cosine of the angle between their path and the normal [-]

    def per_ball(self, p, metres):
        """Return the relative error if every ball is off by this distance [m]."""
        return np.sqrt(COPIES) * metres / np.linalg.norm(self.truth(p, self.T))

    def rounding(self, p, dt):
        """Return the largest relative error caused by round-off."""
        x, v = self.place(p)
        way = np.linalg.norm(rounded_way(x[:, 1:], v[:, 1:], impact_times(self.T), dt))
        few = 12.0 * ROUND_OFF * np.sqrt(COPIES) * p.speed * self.T
        return (way + few) / self.steep / np.linalg.norm(self.truth(p, self.T))


def start_balls(place, positive):
    """Return start(p) of the balls (x, v) = place(p); it raises BadInput unless these parameters are positive."""
    def start(p):
        check_positives(p, *positive)
        return *place(p), Target(p.r, p.R, Plane(np.array([0.0, 0.0, 1.0]), 0.0))
    return start


def observe_balls(state, p):
    """Return the positions of the balls that may hit, in one row."""
    return across(state[0][:COPIES])


def ball_runners(place, fastest, limits, late, obstacle, rays, swept):
    """Return the runners of a scene of balls that stop at an obstacle: our methods, and pybullet's two ways.

    place(p) → (x, v), each (n, 3)       fastest [m/s] that the discrete test can handle
    limits, late    of our methods: limits, and the field `predicted` of the discrete test
    obstacle        of the rays, in words
    rays            {field: its value} of the Runner of pybullet's rays
    swept           share → the same of the Runner that sweeps a ball of that share of the radius
    """
    def slow_enough(p):
        return p.speed <= fastest

    def some_speeds(p):
        return p.speed in ENGINE_SPEEDS
    return (
        ours(CONTINUOUS, limit=limits, predicted=ONLY_ROUND_OFF, order=EXACT),
        ours(DISCRETE, limit=limits, predicted=late, supports=slow_enough),
        engine(PYBULLET, "rays", partial(bullet_rays, place=place), f"one rayTestBatch per step, at a {obstacle}",
               supports=some_speeds, most_steps=100, **rays),
        *(engine(PYBULLET, f"sweeps {share:g} r", partial(bullet_swept, place=place, share=share),
                 SWEPT_SETTINGS.format(share), supports=some_speeds, most_steps=200, order=0, **swept(share))
          for share in SHARES),
    )


def swept_runner(flight, when, band):
    """Return share → {field: its value} of the Runner that sweeps; when and band as in detection_errors.

    band(p, dt, share) depends on the share, too.
    """
    def fields(share):
        def limit(p, dt):
            """A swept ball ends where its smaller sphere touches, with the ball 1 − share of its radius deep, or
            earlier.  Without a sweep it is found at most one step late: in a step that is too short, along or across
            the surface, and where the engine has contact points for it already.
            """
            one = sweep(p, dt, share)
            swept = one is not None and np.all(np.isfinite(one.hits(p, dt, when)))
            late = (1.0 - share) * p.r if swept else p.speed * dt
            return flight.per_ball(p, late / flight.steep) + band(p, dt, share)
        return {"limit": limit, "predicted": detection_errors(flight.T, flight.place, when, partial(band, share=share),
                                                              partial(sweep, share=share))}
    return fields
