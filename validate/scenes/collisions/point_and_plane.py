"""Balls fall on a plane at 1 to 10⁴ m/s, and stop where contact is detected.

The test of the first lecture deck, E(p) < 0 after each step, finds them up to v dt below the plane.  Its formula
t + dt d₁/(d₁ + d₂) puts them back exactly, because the path is straight.  No ball passes a plane: it has no far side.

pybullet's continuous detection sweeps a smaller ball, whose radius the user chooses: with 0.8, 0.95, 0.99 and 0.999 r
the ball ends 0.2, 0.05, 0.01 and 0.001 r deep.  With all of r it sticks to a surface that it grazes.
"""

import numpy as np

from validate.check import states
from validate.reference import collisions as balls
from validate.scene import EXACT, Scene
from validate.scenes._common import ONE_LINK
from validate.scenes.collisions import _common as common

T = 1.0                      # [s]: every ball has hit by then
STEPS = (20, 50, 100, 200, 500, 1000, 2000)
FASTEST_DISCRETE = 10.0     # [m/s]: above this, a ball is deeper than the picture is wide, at every step of the sweep
TILT = 0.3                   # of the path, from the vertical [rad]
CASES = balls.at_speeds(R=0.0)


def place(p):
    """Return (x, v), each (COPIES, 3): balls that come down side by side, tilted towards y."""
    e, k = np.array([0.0, np.sin(TILT), -np.cos(TILT)]), np.arange(balls.COPIES)
    touch = np.stack((common.PLACE_APART * (k - 0.5 * balls.COPIES), 0.0 * k, 0.0 * k + p.r), axis=1)
    return touch - np.outer(p.speed * balls.impact_times(T), e), np.tile(p.speed * e, (balls.COPIES, 1))


start = common.start_balls(place, ("speed", "r"))


def run(lessons, step, acceleration, state, p, dt, steps):
    collisions, (x, v, goal) = lessons.collisions, state
    gap, time = collisions.ball_plane_gap, collisions.ball_plane_time
    return *collisions.advance_projectiles(step, gap, time, 0.0, x, v, dt, steps, goal), goal


def truth(p, t):
    """x₀ + v min(t, t*), t* the root of z − r along the path, by brentq.

    Source: the distance of a point from the plane z = 0.
    """
    x, v = place(p)
    return balls.stopped(x, v, lambda y: y[2] - p.r, np.full(balls.COPIES, T), t)


FLIGHT = common.Flight(T, place, truth, np.cos(TILT))
per_ball, rounding = FLIGHT.per_ball, FLIGHT.rounding


def limits(p, dt):
    """The limits are relative to the root of the sum of all squares.

    continuous: a position is rounded by half a spacing of floats at each step until the impact, and 1/cos 0.3 rad
    times as much on a tilted path; the time of impact adds a dozen rounding errors of the whole path, here and in the
    truth.
    discrete: contact is detected at most one step late, at a predicted time.  pybullet's rays are exact here, because a
    plane is not round.
    """
    rounded = rounding(p, dt)
    return {EXACT: rounded, 1: per_ball(p, p.speed * dt) + rounded}


def when(p, r):
    """Return the times at which balls of radius r reach the plane; they never leave it again."""
    return balls.moments(*place(p), lambda y: y[2] - r, np.full(balls.COPIES, 2.0 * T)), np.inf


RUNNERS = common.ball_runners(
    place, FASTEST_DISCRETE, limits, balls.detection_errors(T, place, when, rounding),
    "GEOM_PLANE raised by the radius of the balls",
    rays={"order": EXACT, "limit": limits, "predicted": balls.ONLY_ROUND_OFF},
    swept=common.swept_runner(FLIGHT, when, lambda p, dt, share: rounding(p, dt)))


def points(observed, p):
    """Draw the plane as a line, and the lowest points of the balls, seen from the front."""
    x = np.reshape(observed, (-1, 2))
    lowest = np.stack((0.12 * (np.arange(balls.COPIES) - 0.5 * balls.COPIES), x[:, 1] - p.r), axis=1)
    return np.round(np.concatenate(([[-1.0, 0.0], [1.0, 0.0]], lowest)), 3)


def sanity_checks():
    """Return Findings about the reference solution."""
    p = CASES["10,000 m/s"]
    x = truth(p, T).reshape(-1, 2)
    return (states("height of all balls at the end [m]", x[:, 1], p.r, 1e-11), balls.impact_claim(*place(p), x, T))


SCENE = Scene(
    title="Point and plane", lesson="collisions",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    start=start, run=run, observe=common.observe_balls,
    truth=truth, truth_uncertainty=balls.UNCERTAINTY,
    sanity_checks=sanity_checks, points=points, links=ONE_LINK,
    uses=("a straight way", "two signed distances for each step"),
    ablations={
        "balls that never come near, tested at every step": lambda p: (balls.with_balls_that_miss(*start(p)), p),
        "gravity: the path would bend": "then the formula is the first step of Newton's method",
        "response": "the whole loop of lesson 10 has it, and a full run measures it",
    },
)
