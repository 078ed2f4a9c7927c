"""Balls fly at an infinite cylinder, across its axis, at 1 to 10⁴ m/s: the discrete and the continuous test.

This is the worked question of the second lecture deck.  The discrete test runs after each step.  It detects a ball up
to v dt inside, or misses it, because a step can be longer than the path through the cylinder.  The continuous test
solves for the first root and works with any step.
"""

import numpy as np

from validate.check import states
from validate.engines.collisions import sweep
from validate.reference import collisions as balls
from validate.scene import EXACT, Scene
from validate.scenes.collisions import _common as common

T = 1.0                      # [s]: every ball has hit by then
STEPS = (20, 50, 100, 200, 500, 1000, 2000)
FASTEST_DISCRETE = 100.0     # [m/s]: above this, no step of the sweep is short enough for the discrete test
WIDEST = 0.8                 # largest offset from the axis at which a ball aims, over R + r [-]
STEEP = np.sqrt(1.0 - WIDEST**2)     # cosine of the angle between its path and the normal [-]
CASES = balls.at_speeds(R=0.5)


def place(p):
    """Return (x, v), each (COPIES, 3), of balls that come down, tilted by 0.3 rad towards y, at different offsets."""
    e, across = np.array([0.0, np.sin(0.3), -np.cos(0.3)]), np.array([0.0, np.cos(0.3), np.sin(0.3)])
    k = np.arange(balls.COPIES)
    beside = WIDEST * (p.R + p.r) * np.sin(1.0 + 2.0 * k)
    # to the point that is nearest to the axis
    way = p.speed * balls.impact_times(T) + np.sqrt((p.R + p.r) ** 2 - beside**2)
    along = common.PLACE_APART * (k - 0.5 * balls.COPIES)
    x = np.outer(along, [1.0, 0.0, 0.0]) + np.outer(beside, across) - np.outer(way, e)
    return x, np.tile(p.speed * e, (balls.COPIES, 1))


start = common.start_balls(place, ("speed", "r", "R"))


def run(lessons, step, acceleration, state, p, dt, steps):
    collisions, (x, v, goal) = lessons.collisions, state
    gap, time = collisions.ball_cylinder_gap, collisions.ball_cylinder_time
    return *collisions.advance_projectiles(step, gap, time, 0.0, x, v, dt, steps, goal), goal


def truth(p, t):
    """x₀ + v min(t, t*), t* the first root of √(y² + z²) − R − r before the nearest point, by brentq.

    Source: the distance of a point from a line.
    """
    x, v = place(p)
    return balls.stopped(x, v, lambda y: np.hypot(y[1], y[2]) - p.R - p.r, nearest(p), t)


FLIGHT = common.Flight(T, place, truth, STEEP)
per_ball, rounding = FLIGHT.per_ball, FLIGHT.rounding


def nearest(p):
    """Return the times (COPIES,) at which the balls would be closest to the axis."""
    x, v = place(p)
    return -np.sum(x[:, 1:] * v[:, 1:], axis=1) / np.sum(v[:, 1:] ** 2, axis=1)


def when(p, r):
    """Return the times at which balls of radius r enter and leave the cylinder; balls that pass it never do."""
    (x, v), middle, gap = place(p), nearest(p), lambda y: np.hypot(y[1], y[2]) - p.R - r
    meets = gap((x + middle[:, None] * v).T) < 0.0
    enters = balls.moments(x, v, gap, np.where(meets, middle, 0.0))
    return enters, 2.0 * middle - enters


def swept_band(p, dt, share):
    """Return how far a swept ball may end from its prediction: as far as a ray does, by round-off without a sweep."""
    return rounding(p, dt) if sweep(p, dt, share) is None else ray_limit(p, dt)


def limits(p, dt):
    """The limits are relative to the root of the sum of all squares.

    continuous: a position is rounded by half a spacing of floats at each step until the impact.  On the path that
    passes farthest from the axis, at b (R + r), the root is 1/√(1 − b²) times as uncertain as the position.  The
    time of impact adds a dozen rounding errors of the whole path, here and in the truth.
    discrete: contact is detected at most one step late, at a predicted time.  A step longer than the shortest path
    through the cylinder, 2 √(1 − b²)(R + r), can miss it.
    """
    late = per_ball(p, p.speed * dt) if p.speed * dt < 2.0 * STEEP * (p.R + p.r) else np.inf
    rounded = rounding(p, dt)
    return {EXACT: rounded, 1: late + rounded}


def ray_limit(p, dt):
    """A ray may end up to 1 mm from a round shape, and along its path that is 1 mm over the cosine of the angle between
    its path and the normal.
    """
    return per_ball(p, common.RAY_ENDS / STEEP) + rounding(p, dt)


RUNNERS = common.ball_runners(
    place, FASTEST_DISCRETE, limits, balls.detection_errors(T, place, when, rounding),
    "GEOM_CYLINDER of radius R + r",
    rays={"order": 0, "limit": ray_limit, "predicted": "where in this millimetre a ray ends depends on its search"},
    swept=common.swept_runner(FLIGHT, when, swept_band))


SIDES = 36                   # of the polygon that is drawn for the circle: it differs by 0.4 % of the radius


def points(observed, p):
    """Draw the scene along the axis, to a millimetre: the cylinder with the radius R + r, and every third ball."""
    around = np.linspace(0.0, 2.0 * np.pi, SIDES + 1)
    circle = (p.R + p.r) * np.stack((np.cos(around), np.sin(around)), axis=1)
    return np.round(np.concatenate((circle, np.reshape(observed, (-1, 2))[::3])), 3)


def links(p):
    return [(n, n + 1) for n in range(SIDES)]


def sanity_checks():
    """Return Findings: the point where a ball in the middle must touch."""
    p = CASES["10,000 m/s"]
    x = truth(p, T).reshape(-1, 2)
    return (states("distance of all balls from the axis at the end [m]", np.hypot(*x.T), p.R + p.r, 1e-11),
            balls.impact_claim(*place(p), x, T))


SCENE = Scene(
    title="Point and cylinder", lesson="collisions",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    start=start, run=run, observe=common.observe_balls,
    truth=truth, truth_uncertainty=balls.UNCERTAINTY,
    sanity_checks=sanity_checks, points=points, links=links,
    uses=("a straight way", "a quadratic equation for each step, or a distance"),
    ablations={
        "balls that never come near, tested at every step": lambda p: (balls.with_balls_that_miss(*start(p)), p),
        "gravity: the path would bend, and the equation would be of fourth degree":
            "short straight pieces of the path lead back to this equation",
        "response": "the whole loop of lesson 10 has it, and a full run measures it",
        "a cloth in place of the balls: its edges and faces": "triangle_cylinder_gap of this lesson tests them",
    },
)
