"""Newton's cradle of five equal balls: with gaps mechanics determines how many leave.

For touching balls it does not.
"""

from typing import Annotated, NamedTuple

import numpy as np

from solutions.given.impulses import Discs
from solutions.support.model import Body, make_model
from solutions.support.shapes import Ball
from validate.methods import BACKTRACKING_DISCS, PROJECTING_DISCS
from validate.reference.impulses import APART, COPIES, delays, passed_on, rounded_steps
from validate.scene import EXACT, PYBULLET, PYMUNK, Prediction, Scene, by_order
from validate.scenes._common import built, check_positives
from validate.scenes.impulses._common import copies_of, impact_runners

T = 0.4                      # [s]: all impacts are over after 0.16
STEPS = (20, 50, 100, 200, 500, 2000, 5000)
BALLS = 5
TOGETHER = 50                # iterations for balls that touch: they take one impact all at once
WINDOW = 0.05                # spread of the first ball's start over the copies [s]


class Params(NamedTuple):
    gap: Annotated[float, "between neighbours [m]; 0: they touch"] = 0.02
    away: Annotated[float, "of the first ball from the second [m]"] = 0.1
    v: Annotated[float, "speed of the first [m/s]"] = 1.0
    R: Annotated[float, "radius [m]"] = 0.05


CASES = {"with gaps": Params(), "touching": Params(gap=0.0)}


def start(p):
    check_positives(p, "away", "v", "R")
    x, v = np.zeros((COPIES, BALLS, 2)), np.zeros((COPIES, BALLS, 2))
    x[:, 1:, 0] = 2.0 * p.R + p.away + (2.0 * p.R + p.gap) * np.arange(BALLS - 1)
    x[:, 0, 0] = p.v * delays(WINDOW)
    v[:, 0, 0] = p.v
    return x, v, Discs(np.full(BALLS, p.R), np.ones(BALLS), 1.0)


def run(lessons, step, acceleration, state, p, dt, steps):
    x, v, discs = state
    return *lessons.impulses.advance_discs(step, x, v, dt, steps, discs), discs


def seen(x, v, p):
    """Return the observed quantities: with gaps, the position and velocity of each ball.

    For touching balls they are the total momentum and twice the total energy, over the mass.
    """
    if p.gap > 0.0:
        return np.concatenate((x, v), axis=1).ravel()
    return np.stack((np.sum(v, axis=1), np.sum(v**2, axis=1)), axis=1).ravel()


def observe(state, p):
    return seen(state[0][:, :, 0], state[1][:, :, 0], p)


def truth(p, t):
    """With gaps, e = 1 and equal masses, each impact passes the velocity on; the last ball leaves: (0, 0, 0, 0, 1).

    Touching balls collide simultaneously, and five velocities have only two conditions: momentum and energy.  (Both
    engines end with (−½, 0, ½, ½, ½) here at any step, and our steps with (0, 0, 0, 0, 1).) Source: Newton; for the
    possible outcomes of touching balls, Herrmann and Schmälzle 1981.
    """
    x, v, _ = start(p)
    x, v = x[:, :, 0], v[:, :, 0]
    if p.gap == 0.0:
        return seen(x, v, p)
    for k, before in enumerate(delays(WINDOW)):
        began = 0.0                                                      # when ball i began to move
        for i in range(BALLS):
            stops = began + (p.away - p.v * before if i == 0 else p.gap) / p.v if i < BALLS - 1 else np.inf
            x[k, i] += p.v * np.clip(t - began, 0.0, stops - began)
            v[k, i] = p.v if began <= t < stops else 0.0
            began = stops
    return seen(x, v, p)


def limits(p, dt):
    """Each of four impacts is detected up to one step late; the last ball is off by up to 4 v dt.

    Until its impact is detected, a ball moves up to v dt too far.  The separation of overlapping balls moves each
    by that distance once more.  A step in which a ball crosses a whole gap merges two impacts into one; then there
    is no bound.  Touching balls keep momentum and energy exactly, however they share them.
    """
    exact = by_order(1.0 / T, T, dt)[EXACT]
    if p.gap == 0.0:
        # In a longer step the first may pass the centre of the second.
        late = exact if p.v * dt < p.R else np.inf
        return {1: late, EXACT: exact}
    late = np.inf
    if 2.0 * p.v * dt < p.gap:
        late = 5.0 * p.v * dt * np.sqrt(BALLS * COPIES) / np.linalg.norm(truth(p, T)) + exact
    return {1: late, EXACT: exact}


def late_impacts(p, dt, rule):
    """With gaps, each impact is detected at the first end of a step with an overlap.  The lesson's step, or an
    engine, then places the next ball, which flies on from there.  If a gap is a whole number of steps, round-off
    decides in which step the impact is detected; both outcomes are right.
    """
    if p.gap == 0.0 or 2.0 * p.v * dt >= p.gap:
        return None
    x, _, _ = start(p)
    rows = [passed_on(rule, row, p.v, 2.0 * p.R, dt, round(T / dt)) for row in x[:, :, 0]]
    if None in rows:
        return None
    ends = [np.array([np.concatenate(end) for end in row]) for row in rows]
    low, high = (np.array([bound(end, axis=0) for end in ends]).ravel() for bound in (np.min, np.max))
    law = truth(p, T)
    size = np.linalg.norm(law)
    return Prediction(0.5 * (low + high) - law,
                      0.505 * np.linalg.norm(high - low) / size + rounded_steps(T, dt, np.sqrt(COPIES * BALLS) / size))


def model(p):
    """Make all copies of the row, APART from each other."""
    x, v, _ = start(p)
    return make_model([Body((x[k, i, 0], APART * k), 1.0, Ball(p.R), e=1.0, v=tuple(v[k, i]))
                       for k in range(COPIES) for i in range(BALLS)], (0.0, 0.0))


def read(state, p):
    x, v = copies_of(state, BALLS)
    return seen(x[:, :, 0], v[:, :, 0], p)


def world(product, apart, **settings):
    """Return make(p, dt) of an engine's runner; apart: its iterations for balls with gaps."""
    return lambda p, dt: built(product, model, read, iterations=apart if p.gap > 0.0 else TOGETHER, **settings)(p, dt)


RUNNERS = impact_runners(
    (PROJECTING_DISCS, BACKTRACKING_DISCS), limits, late_impacts,
    (world(PYMUNK, 3), f"rows of circles; 3 iterations, {TOGETHER} where they touch; collision_slop 1e-5"),
    # nothing turns, so no moment has to count; bodies that were moved apart make its search five times as slow
    (world(PYBULLET, 1, weighed=False), f"rows of spheres; 1 iteration, {TOGETHER} where they touch"))


def points(observed, p):
    """Draw the centres of the first row; touching balls at their initial positions, because only sums are observed."""
    x = observed[:BALLS] if p.gap > 0.0 else start(p)[0][0, :, 0]
    return np.round(np.stack((x, np.zeros(BALLS)), axis=1), 5)


SCENE = Scene(
    title="Cradle", lesson="impulses",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-15, model=model, read=read,
    points=points,
    uses=("one coordinate", "the order of the impacts"),
    full_loop="contacts of contact_step_2d do not bounce; lesson 10 has a cradle in another loop",
    ablations={
        "the strings": "a swinging ball would move on an arc",
        "the stiffness of the balls": "it decides which balls leave if they touch; rigid bodies have none",
        "rotation and friction": "central impacts do not depend on them",
    },
)
