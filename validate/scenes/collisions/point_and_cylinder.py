"""Balls fly at an endless cylinder, across its axis, at 1 to 10⁴ m/s: where are they when somebody notices?

Deck B's worked question.  The discrete test looks after each step, and finds a ball up to v dt inside, or never: a step longer than the
way through the cylinder may leave it behind.  The continuous test solves for the first root, and does not care how long the step is.
"""

from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import check_positive
from solutions.collisions import Plane, Target, cylinder_gap, cylinder_time, flight
from validate.engines.collisions import PLACE_APART, RAY_ENDS, SWEPT, across, bullet_rays, bullet_swept, swept_limit
from validate.methods import CONTINUOUS, DISCRETE
from validate.reference.collisions import COPIES, first_root, impact_times
from validate.scene import EXACT, PYBULLET, ROUND_OFF, Engine, Scene

T = 1.0                      # [s]: every ball has hit by then
STEPS = (20, 50, 100, 200, 500, 1000, 2000)
FASTEST_DISCRETE = 100.0     # [m/s]: above, no step of the sweep is short enough for the discrete test
WIDEST = 0.8                 # how far beside the axis a ball may aim, over R + r [-]


class Params(NamedTuple):
    speed: Annotated[float, "of the balls [m/s]"] = 1.0
    r: Annotated[float, "their radius [m]"] = 0.1
    R: Annotated[float, "of the cylinder, about the x axis [m]"] = 0.5


CASES = {"1 m/s": Params(), "10 m/s": Params(10.0), "100 m/s": Params(100.0), "1,000 m/s": Params(1e3), "10,000 m/s": Params(1e4)}


def place(p):
    """(x, v), each (COPIES, 3): balls that come down, tilted by 0.3 rad towards y, each with its own distance beside the axis."""
    e, across = np.array([0.0, np.sin(0.3), -np.cos(0.3)]), np.array([0.0, np.cos(0.3), np.sin(0.3)])
    k = np.arange(COPIES)
    beside = WIDEST * (p.R + p.r) * np.sin(1.0 + 2.0 * k)
    way = p.speed * impact_times(T) + np.sqrt((p.R + p.r) ** 2 - beside**2)             # to the point of its path nearest to the axis
    x = np.outer(PLACE_APART * (k - 0.5 * COPIES), [1.0, 0.0, 0.0]) + np.outer(beside, across) - np.outer(way, e)
    return x, np.tile(p.speed * e, (COPIES, 1))


def start(p):
    for name in ("speed", "r", "R"):
        check_positive(name, getattr(p, name))
    return *place(p), Target(p.r, p.R, Plane(np.array([0.0, 0.0, 1.0]), 0.0))


def with_others(p):
    """(state, p) with as many balls again, a kilometre to the side, which never hit: a broad phase would leave them out."""
    x, v, goal = start(p)
    e = np.array([0.0, 1.0, 0.0])
    return (np.concatenate((x, x + 1e3 * np.array([0.0, 1.0, 1.0]))), np.concatenate((v, np.linalg.norm(v[0]) * np.tile(e, (COPIES, 1)))), goal), p


def run(step, acceleration, state, p, dt, steps):
    x, v, goal = state
    x, v = flight(step, cylinder_gap, cylinder_time, 0.0, x, v, dt, steps, goal)
    return x, v, goal


def observe(state, p):
    return across(state[0][:COPIES])


def truth(p, t):
    """x₀ + v min(t, t*), t* the first root of √(y² + z²) − R − r along the way, by brentq, before the point nearest to the axis.

    Source: the distance of a point from a line.
    """
    x, v = place(p)
    found = []
    for y, w in zip(x, v):
        nearest = -(y[1:] @ w[1:]) / (w[1:] @ w[1:])
        moment = first_root(lambda s: np.hypot(*(y + s * w)[1:]) - p.R - p.r, 0.0, nearest)
        found.append(y + min(t, moment) * w)
    return across(np.array(found))


def supports(name, p):
    """The discrete test up to FASTEST_DISCRETE; engines at the least, the middle and the greatest speed."""
    return p.speed <= FASTEST_DISCRETE if name == "discrete_step" else p.speed in (1.0, 1e2, 1e4) or not name.startswith("pybullet")


def tolerance(p, dt):
    """Relative to the root of the sum of all squares.

    continuous: a place is rounded by ½ spacing of the farthest one, speed · 0.7 s, at each of T/dt steps; at WIDEST beside the axis the root
    is 1/√(1 − WIDEST²) times as uncertain as the place.
    rays: RAY_ENDS, which is measured and not derived; swept: see swept_limit.
    discrete: found after the impact by one step at most; meaningless for steps that may pass by: the shortest way through is 2 √(1 − WIDEST²)(R + r).
    """
    size, steep = np.linalg.norm(truth(p, T)), np.sqrt(1.0 - WIDEST**2)
    per_ball = lambda metres: np.sqrt(COPIES) * metres / size
    rounded = per_ball((T / dt + 20.0) * ROUND_OFF * (p.speed * T + PLACE_APART * COPIES) / steep)
    late = per_ball(p.speed * dt) if p.speed * dt < 2.0 * steep * (p.R + p.r) else np.inf
    return {EXACT: rounded, 1: late + rounded, "pybullet, rays": per_ball(RAY_ENDS / steep) + rounded,
            "pybullet, swept": per_ball(swept_limit(p, dt) / steep) + rounded}


ENGINES = (
    Engine(PYBULLET, "rays", lambda p, dt: bullet_rays(p, *place(p), dt), 0, "one rayTestBatch a step, at a GEOM_CYLINDER of radius R + r", most_steps=100),
    Engine(PYBULLET, "swept", lambda p, dt: bullet_swept(p, *place(p), dt), 0,
           f"useMaximalCoordinates, ccdSweptSphereRadius {SWEPT:g} r, contactProcessingThreshold, contactERP and contactSlop 0", most_steps=200),
)


def points(observed, p):
    """Seen along the axis: the cylinder as far as the balls get, and every third ball; to a millimetre."""
    around = np.linspace(0.0, 2.0 * np.pi, 13)
    return np.round(np.concatenate(((p.R + p.r) * np.stack((np.cos(around), np.sin(around)), axis=1), np.reshape(observed, (-1, 2))[::3])), 3)


def links(p):
    return [(n, n + 1) for n in range(12)]


def sanity_checks():
    """((claim, found, expected, tolerance), …): the truth itself against the point where a ball in the middle must touch."""
    p = Params(1e4)
    x, (began, v) = truth(p, T).reshape(-1, 2), place(p)
    return (("distance of all balls from the axis at the end [m]", np.hypot(*x.T), p.R + p.r, 1e-11),
            ("times at which they hit [s]", (x[:, 1] - began[:, 2]) / v[:, 2], impact_times(T), 1e-14))


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
    truth_uncertainty=1e-13,          # of brentq, times the 7,000 m that the fastest balls have come
    tolerance=tolerance,
    engines=ENGINES,
    orders={"continuous_step": EXACT},
    supports=supports,
    uncompiled_in_quick=("discrete_step",),          # sooner run than compiled
    sanity_checks=sanity_checks,
    points=points,
    links=links,
    uses=("a straight way", "a quadratic equation for each step, or a distance"),
    ablations={"balls that never come near, tested at every step": with_others,
              "gravity: the way would bend, and the equation be of fourth degree": "cut into short straight pieces it is this one",
              "response": "lesson 7 builds it", "a cloth in place of the balls: its edges and faces": "triangle_cylinder_gap of this lesson tests them"},
)
