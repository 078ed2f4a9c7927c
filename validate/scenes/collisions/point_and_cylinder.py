"""Balls fly at an infinite cylinder, across its axis, at 1 to 10⁴ m/s: the discrete and the continuous test.

This is the worked question of the second lecture deck.  The discrete test runs after each step.  It finds a ball up to
v dt inside, or misses it, because a step longer than the path through the cylinder can pass it.  The continuous test
solves for the first root and works with any step.
"""

from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import check_positive
from solutions.collisions import Plane
from solutions.support.collisions import Target, advance_projectiles, ball_cylinder_gap, ball_cylinder_time
from validate.engines.collisions import (
    PLACE_APART,
    RAY_ENDS,
    across,
    discrete_up_to,
    ray_and_sweep,
    swept_limit,
    swept_radius,
)
from validate.methods import CONTINUOUS, DISCRETE
from validate.reference.collisions import (
    COPIES,
    SPEEDS,
    detection_errors,
    impact_times,
    moments,
    rounded_way,
    stopped,
    with_balls_that_miss,
)
from validate.scene import EXACT, ROUND_OFF, Scene

T = 1.0                      # [s]: every ball has hit by then
STEPS = (20, 50, 100, 200, 500, 1000, 2000)
FASTEST_DISCRETE = 100.0     # [m/s]: above this, no step of the sweep is short enough for the discrete test
WIDEST = 0.8                 # largest offset from the axis at which a ball aims, over R + r [-]


class Params(NamedTuple):
    speed: Annotated[float, "of the balls [m/s]"] = 1.0
    r: Annotated[float, "their radius [m]"] = 0.1
    R: Annotated[float, "of the cylinder, about the x axis [m]"] = 0.5


CASES = {name: Params(speed) for name, speed in SPEEDS.items()}


def place(p):
    """Return (x, v), each (COPIES, 3): balls that come down, tilted by 0.3 rad towards y, each with its own offset."""
    e, across = np.array([0.0, np.sin(0.3), -np.cos(0.3)]), np.array([0.0, np.cos(0.3), np.sin(0.3)])
    k = np.arange(COPIES)
    beside = WIDEST * (p.R + p.r) * np.sin(1.0 + 2.0 * k)
    way = p.speed * impact_times(T) + np.sqrt((p.R + p.r) ** 2 - beside**2)    # to the nearest point to the axis
    x = np.outer(PLACE_APART * (k - 0.5 * COPIES), [1.0, 0.0, 0.0]) + np.outer(beside, across) - np.outer(way, e)
    return x, np.tile(p.speed * e, (COPIES, 1))


def start(p):
    for name in ("speed", "r", "R"):
        check_positive(name, getattr(p, name))
    return *place(p), Target(p.r, p.R, Plane(np.array([0.0, 0.0, 1.0]), 0.0))


def run(step, acceleration, state, p, dt, steps):
    x, v, goal = state
    x, v = advance_projectiles(step, ball_cylinder_gap, ball_cylinder_time, 0.0, x, v, dt, steps, goal)
    return x, v, goal


def observe(state, p):
    return across(state[0][:COPIES])


def truth(p, t):
    """x₀ + v min(t, t*), t* the first root of √(y² + z²) − R − r before the nearest point, by brentq.

    Source: the distance of a point from a line.
    """
    x, v = place(p)
    return across(stopped(x, v, lambda y: np.hypot(y[1], y[2]) - p.R - p.r, nearest(p), t))


def nearest(p):
    """Return the times (COPIES,) at which the balls would be nearest to the axis."""
    x, v = place(p)
    return -np.sum(x[:, 1:] * v[:, 1:], axis=1) / np.sum(v[:, 1:] ** 2, axis=1)


def when(p, r):
    """Return the times at which balls of radius r enter and leave the cylinder: never, if they pass beside it."""
    (x, v), middle, gap = place(p), nearest(p), lambda y: np.hypot(y[1], y[2]) - p.R - r
    meets = gap((x + middle[:, None] * v).T) < 0.0
    enters = moments(x, v, gap, np.where(meets, middle, 0.0))
    return enters, 2.0 * middle - enters


def rounding(p, dt):
    """Return the largest relative error by round-off."""
    x, v = place(p)
    way = np.linalg.norm(rounded_way(x[:, 1:], v[:, 1:], impact_times(T), dt))
    few = 12.0 * ROUND_OFF * np.sqrt(COPIES) * p.speed * T
    return (way + few) / np.sqrt(1.0 - WIDEST**2) / np.linalg.norm(truth(p, T))


def band(p, dt, label):
    """Return how far a run may be off from its prediction: round-off, and where a swept sphere ends, as a ray does."""
    if label == "discrete" or swept_radius(p, dt) is None:
        return rounding(p, dt)
    steep = np.sqrt(1.0 - WIDEST**2)
    return np.sqrt(COPIES) * RAY_ENDS / steep / np.linalg.norm(truth(p, T)) + rounding(p, dt)


def tolerance(p, dt):
    """Limits relative to the root of the sum of all squares.

    continuous: a position is rounded by ½ spacing of itself at each step until the impact; with its largest offset
    b (R + r) from the axis the root is 1/√(1 − b²) times as uncertain as the position; a dozen roundings of the whole
    way for the time of impact, here and in the truth.
    rays: where a ray ends is measured and not derived.
    discrete: detected at most one step late; `predicted_error` knows when.  A step longer than the shortest path
    through the cylinder, 2 √(1 − b²)(R + r), can pass it.
    """
    size, steep = np.linalg.norm(truth(p, T)), np.sqrt(1.0 - WIDEST**2)
    per_ball = lambda metres: np.sqrt(COPIES) * metres / size
    rounded = rounding(p, dt)
    late = per_ball(p.speed * dt) if p.speed * dt < 2.0 * steep * (p.R + p.r) else np.inf
    return {EXACT: rounded, 1: late + rounded, "pybullet, rays": per_ball(RAY_ENDS / steep) + rounded,
            "pybullet, swept": per_ball(swept_limit(p, dt) / steep) + rounded}


ENGINES = ray_and_sweep(place, 0, "GEOM_CYLINDER of radius R + r")


def points(observed, p):
    """Draw the scene along the axis, to a millimetre: the cylinder with the radius R + r, and every third ball."""
    around = np.linspace(0.0, 2.0 * np.pi, 13)
    circle = (p.R + p.r) * np.stack((np.cos(around), np.sin(around)), axis=1)
    return np.round(np.concatenate((circle, np.reshape(observed, (-1, 2))[::3])), 3)


def links(p):
    return [(n, n + 1) for n in range(12)]


def sanity_checks():
    """Return ((claim, found, expected, tolerance), …): the point where a ball in the middle must touch."""
    p = Params(1e4)
    x, (began, v) = truth(p, T).reshape(-1, 2), place(p)
    return (("distance of all balls from the axis at the end [m]", np.hypot(*x.T), p.R + p.r, 1e-11),
            ("times of impact [s]", (x[:, 1] - began[:, 2]) / v[:, 2], impact_times(T), 1e-14))


SCENE = Scene(
    title="Point and cylinder",
    lesson="collisions",
    cases=CASES,
    duration=T,
    steps=STEPS,
    methods=(CONTINUOUS, DISCRETE),
    start=start,
    run=run,
    observe=observe,
    truth=truth,
    # of brentq, times the 7,000 m that the fastest balls have travelled
    truth_uncertainty=1e-13,
    tolerance=tolerance,
    predicted_error=detection_errors(T, place, when, swept_radius, band),
    engines=ENGINES,
    orders={"continuous_step": EXACT},
    supports=discrete_up_to(FASTEST_DISCRETE),
    # Plain Python finishes before numba has compiled it.
    uncompiled_in_quick=("discrete_step",),
    shorter_in_quick={"discrete_step": 1000},
    sanity_checks=sanity_checks,
    points=points,
    links=links,
    uses=("a straight way", "a quadratic equation for each step, or a distance"),
    full_loop="the scene ends where the loop begins: a ball stays where it is found to hit",
    ablations={
        "balls that never come near, tested at every step": lambda p: (with_balls_that_miss(*start(p)), p),
        "gravity: the path would bend, and the equation be of fourth degree": ("short straight pieces of the path "
                                                                              "lead back to this equation"),
        "response": "lesson 7 builds it",
        "a cloth in place of the balls: its edges and faces": "triangle_cylinder_gap of this lesson tests them",
    },
)
