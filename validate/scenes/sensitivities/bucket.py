"""A ball is thrown so that it is in a bucket after two bounces: the velocity of the throw, by Newton's method.

Each throw flies once, with its sensitivities to its own velocity, and one linear equation corrects the
velocity.  Near the bucket each throw has about twice as many right digits as the one before, because the
sensitivities are exact.  With a sensitivity that is wrong by 10 %, each throw would gain one digit.
"""

from itertools import pairwise
from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import check_positive
from solutions.given.sensitivities import Course, Throw
from validate.check import states
from validate.methods import AIMING
from validate.reference.sensitivities import Plane, bounced_flight, by_complex_numbers, newton
from validate.scene import EXACT, ROUND_OFF, Scene, ours
from validate.scenes._common import ANSWER, check_positives

T = 1.0
THROWS = 3                   # whose miss is observed, after the first
HIT = 1e-12                  # miss at which the search ends [m]
MOST = 20                    # throws
FROM = np.array([0.0, 1.0])  # place of the hand [m]
G = np.array([0.0, -9.81])   # [m/s²]


class Params(NamedTuple):
    x: Annotated[float, "bucket [m]"] = 1.5
    y: Annotated[float, "bucket [m]"] = 0.6
    duration: Annotated[float, "of the flight [s]"] = 1.4
    lean: Annotated[float, "of the wall, backwards [rad]"] = float(np.radians(20.0))
    wall: Annotated[float, "foot of the wall [m]"] = 3.0
    e_floor: Annotated[float, "restitution of the floor [-]"] = 0.8
    e_wall: Annotated[float, "restitution of the wall [-]"] = 0.7
    v_x: Annotated[float, "first throw [m/s]"] = 4.0
    v_y: Annotated[float, "first throw [m/s]"] = 1.0


CASES = {"a wall that leans": Params(),
         "an upright wall": Params(y=0.4, duration=1.3, lean=0.0, v_x=3.5, v_y=2.6)}


def normals(p):
    """Return the unit normals of the floor and of the wall (2, 2)."""
    return np.array([(0.0, 1.0), (-np.cos(p.lean), np.sin(p.lean))])


def feet(p):
    """Return a point of the floor and one of the wall (2, 2) [m]."""
    return np.array([(0.0, 0.0), (p.wall, 0.0)])


def start(p):
    """Return (first velocity, Throw)."""
    check_positives(p, "duration", "e_floor", "e_wall")
    check_positive("distance of the wall [m]", p.wall - FROM[0])
    course = Course(G, normals(p), feet(p), np.array([p.e_floor, p.e_wall]), np.zeros((2, 2)))
    return np.array([p.v_x, p.v_y]), Throw(course, FROM, np.array([p.x, p.y]), p.duration)


def run(lessons, step, acceleration, state, p, dt, steps):
    s, throw = state
    return (*step(lessons.sensitivities.throw_miss, s, HIT, MOST, throw), throw)


def digits(misses):
    """Return the digits that the first throws gain: −log₁₀ of their misses over the first miss."""
    return -np.log10(np.asarray(misses[1:THROWS + 1]) / misses[0])


def observe(state, p):
    """Return the velocity of the last throw, and the digits gained by the first throws."""
    s, misses, _ = state
    return np.append(s, digits(misses))


def miss(p):
    """Return r(s), the miss of a throw with the velocity s, which may be complex: parabolas of the reference."""
    planes = [Plane(n, foot, e) for n, foot, e in zip(normals(p), feet(p), (p.e_floor, p.e_wall))]
    return lambda s: bounced_flight(FROM, s, p.duration, G, planes)[0] - np.array([p.x, p.y])


def truth(p, t):
    """The velocity solves r(s) = 0; the misses on the way are those of Newton's method with whole steps.

    Source: Newton's method on parabolas that are computed with complex numbers, so that its Jacobian is an imaginary
    part of the whole flight and contains no formula for an event.
    """
    ways = newton(miss(p), np.array([p.v_x, p.v_y]), 8)
    return np.append(ways[-1][0], digits([size for _, size in ways]))


def round_off(p, dt):
    """A place is off by ten roundings of the 3 m to the wall, and so is a miss: relative to the last miss that
    is observed, over ln 10, in digits.  The roundings of a throw multiply the next ones no more, because
    Newton's method corrects them.
    """
    last = newton(miss(p), np.array([p.v_x, p.v_y]), THROWS)[-1][1]
    return 10.0 * p.wall * ROUND_OFF / (last * np.log(10.0)) / np.linalg.norm(truth(p, T)) + 30.0 * ROUND_OFF


RUNNERS = (ours(AIMING, order=EXACT, limit=round_off,
                predicted="the truth has the same throws: only round-off is left"),)


def upright(p):
    """Return the velocity for an upright wall on paper, along the floor:  w = wall − x,  v_x = (wall +
    w/e)/duration.
    """
    return (p.wall + (p.wall - p.x) / p.e_wall) / p.duration


def sanity_checks():
    """Return Findings: v_x on paper, the way back from the bucket to the hand, and two bounces in every throw."""
    found, bounces, back = [], [], []
    for p in CASES.values():
        s = truth(p, T)[:2]
        planes = [Plane(n, foot, e) for n, foot, e in zip(normals(p), feet(p), (p.e_floor, p.e_wall))]
        x, v, hit = bounced_flight(FROM, s, p.duration, G, planes)
        bounces.append(hit)
        returning = [plane._replace(e=1.0 / plane.e) for plane in planes]
        there = bounced_flight(x.real, -v.real, p.duration, G, returning)
        back.append(there[0].real - FROM)
        found.append(np.linalg.norm(by_complex_numbers(miss(p), s)[0]))
    p = CASES["an upright wall"]
    return (
        states("velocity along the floor for an upright wall, on paper [m/s]", truth(p, T)[0], upright(p), 1e-12),
        states("thrown back with 1/e the ball returns to the hand [m]", np.array(back), np.zeros((2, 2)), 1e-12),
        states("miss of the last throw [m]", np.array(found), np.zeros(2), 1e-13),
        states("first the floor, then the wall", np.array(bounces), np.array([(0, 1), (0, 1)]), 0.0),
    )


# ---------------------------------------------------------------------------------------------- picture

MOMENTS = 81                 # drawn of the flight


def points(observed, p):
    """Draw the flight of the last throw, the floor, the wall and the bucket."""
    planes = [Plane(n, foot, e) for n, foot, e in zip(normals(p), feet(p), (p.e_floor, p.e_wall))]
    times = np.linspace(0.0, p.duration, MOMENTS)
    path = np.array([bounced_flight(FROM, observed[:2], t, G, planes)[0].real for t in times])
    foot, up = np.array([p.wall, 0.0]), np.array([np.sin(p.lean), np.cos(p.lean)])
    bucket = np.array([p.x, p.y]) + 0.12 * np.array([(-1.2, 0.6), (-0.8, -0.8), (0.8, -0.8), (1.2, 0.6)])
    return np.concatenate((path, [(-0.3, 0.0), foot, foot + 1.8 * up], bucket))


def links(p):
    """Return the pairs that lines join: neighbours of each outline."""
    ends = (0, MOMENTS, MOMENTS + 3, MOMENTS + 7)
    return [(i, i + 1) for first, last in pairwise(ends) for i in range(first, last - 1)]


SCENE = Scene(
    title="Ball into a bucket", lesson="sensitivities", **ANSWER, cases=CASES, runners=RUNNERS,
    start=start, run=run, observe=observe, truth=truth, truth_uncertainty=1e-9,
    omitted_methods="pymunk and pybullet have no sensitivities, and their bounces do not move with the throw; MuJoCo "
                    "differentiates its steps, but has no coefficient of restitution",
    quantity_names=lambda p: ["velocity along the floor [m/s]", "velocity upwards [m/s]",
                              *(f"digits gained after correction {k} [-]" for k in range(1, THROWS + 1))],
    sanity_checks=sanity_checks,
    points=points, links=links,
    uses=("two coordinates", "two planes", "sensitivities to the velocity of the throw"),
    ablations={"air, and spin": "then no flight is a parabola, and the lesson's tangents of steps take its place"},
)
