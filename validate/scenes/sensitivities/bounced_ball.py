"""A ball that bounces, and how its height and speed depend on where it was dropped and on the restitution.

A ball from higher up reaches the floor later.  Its bounce moves in time, and the sensitivities jump: this is saltation.
A method that finds a bounce at the end of a step does not move it when the height changes a little.  Its
differences say that the height after a bounce does not depend on the first height at all (where the ball is
set on the floor), or that it grows with it (where the ball is left below the floor, as engines do).  In truth it falls.
"""

from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import check_positive
from solutions.given.sensitivities import Course
from solutions.impulses import BouncingBall, check_restitution
from solutions.support.model import Body
from solutions.support.shapes import Ball
from validate.check import Whose, states
from validate.engines.bullet import IMPACT_SETTINGS
from validate.methods import BACKTRACKING, PROJECTING, SALTATION
from validate.reference.impulses import APART as ASIDE
from validate.reference.impulses import BULLET_RULE, CHIPMUNK_RULE, LATE, PROJECTING_RULE
from validate.reference.sensitivities import (
    Plane,
    bounced_flight,
    bounced_sensitivities,
    bounces_until,
    by_complex_numbers,
    stepped_differences,
    stepped_sensitivities,
)
from validate.scene import (
    EXACT,
    PYBULLET,
    PYMUNK,
    ROUND_OFF,
    Departure,
    Prediction,
    Scene,
    by_order,
    engine,
    ours,
)
from validate.scenes._common import ONE_LINK, built, check_positives
from validate.scenes.impulses._common import above_floor, over_floor

T = 1.9                      # [s]: clear of impacts in all cases
STEPS = (40, 100, 200, 500, 1000, 2500, 10000)
APART = 1e-6                 # of the balls of a difference, in the height [m] and in the restitution [-]
CHANGES = np.array([(0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)])   # of (h, e), over APART
RADIUS = 0.1                 # of the engines' balls [m]


class Params(NamedTuple):
    e: Annotated[float, "restitution [-]"] = 0.79
    h: Annotated[float, "dropped from here [m]"] = 1.0
    slip: Annotated[float, "velocity along the floor [m/s]"] = 0.5
    g: Annotated[float, "gravity [m/s²]"] = 9.81


CASES = {"three bounces": Params(), "one bounce": Params(e=0.97, h=4.0), "elastic": Params(e=1.0)}


def balls(p):
    """Return (height, restitution) (5, 2) of the ball and of its four neighbours."""
    return np.array([p.h, p.e]) + APART * CHANGES


def start(p):
    """Return (x, v (5, 2), dx, dv (2, 2)): the balls, and the sensitivities of the first to its height and
    restitution.
    """
    check_positives(p, "h", "g")
    check_restitution(p.e)
    check_positive("restitution [-]", p.e)
    x, v = np.zeros((5, 2)), np.zeros((5, 2))
    x[:, 1], v[:, 0] = balls(p)[:, 0], p.slip
    return x, v, np.array([[0.0, 0.0], [1.0, 0.0]]), np.zeros((2, 2))


def run(lessons, step, acceleration, state, p, dt, steps):
    """Fly with saltation; or move all five balls step by step, and take differences at the end."""
    x, v, dx, dv = state
    up, gravity = np.array([0.0, 1.0]), np.array([0.0, -p.g])
    if step is lessons.sensitivities.flight:
        course = Course(gravity, up[None], np.zeros((1, 2)), np.array([p.e]), np.array([[0.0, 1.0]]))
        place, speed, dx, dv = step(x[0], v[0], dx, dv, steps * dt, course)
        return np.array([place]), np.array([speed]), dx, dv
    x, v = x.copy(), v.copy()
    for k, (_, e) in enumerate(balls(p)):
        drop = BouncingBall(e, gravity, np.zeros(2), up, 0.0, 0.0)
        one = slice(k, k + 1)
        x[one], v[one] = lessons.impulses.advance_balls(step, acceleration, 0.0, x[one], v[one], dt, steps, drop)
    return x, v, differences(x), differences(v)


def differences(x):
    """Return (2, 2): central differences of the balls' coordinates over the height and over the restitution."""
    return np.stack((x[1] - x[2], x[3] - x[4]), axis=1) / (2.0 * APART)


def observe(state, p):
    """Return the distance along the floor, the height, the speed, and the sensitivities of the last two."""
    x, v, dx, dv = state
    return np.array([*x[0], v[0, 1], *dx[1], *dv[1]])


def truth(p, t):
    """Parabolas from impact to impact, differentiated on paper.

    After the k-th impact  y = v_k (t − t_k) − ½ g (t − t_k)²  with  v_k = eᵏ √(2gh),
    t_k = √(2h/g) (1 + 2 (e + … + eᵏ⁻¹)).   Source: the geometric series, and the chain rule.
    """
    return np.array([p.slip * t, *bounced_sensitivities(p.h, p.e, p.g, t)])


def in_fixed_steps(p, t, kept):
    """Return the same with the sensitivities of a method whose bounces stay in their steps; see the reference."""
    return np.array([*truth(p, t)[:3], *stepped_sensitivities(p.h, p.e, p.g, t, kept)])


# ---------------------------------------------------------------------------------------------- errors

def size(p, kept=None):
    return np.linalg.norm(truth(p, T) if kept is None else in_fixed_steps(p, T, kept))


def exact_limit(p, dt):
    """A flight has some dozen operations per bounce, and a bounce divides by its speed.  Speeds of later bounces are eᵏ
    times as large, and so are their roundings over them: twenty roundings cover three bounces.
    """
    return 20.0 * ROUND_OFF


def rounded(p, dt, far=0.0):
    """Return the round-off of a difference: in each step a spacing of the largest coordinate and, times what is left of
    T, of the speed.  They are a random walk over T/dt steps, with 25 more for the operations that are not steps.

    far: the largest coordinate [m], if it is not a height of the fall.
    """
    spacing = ROUND_OFF * (max(far, p.h) + T * np.sqrt(2.0 * p.g * p.h))
    return np.sqrt(25.0 + T / dt) * spacing / APART


def difference_limit(p, dt):
    """A step that goes back to the impact is exact, so its difference has only truncation, h² f‴/6 with h = 10⁻⁶,
    and round-off.

    The speed after k bounces is v_k = eᵏ √(2gh), and each derivative brings a factor of at most k/e or 1/2h.
    """
    k = bounces_until(p.h, p.e, p.g, T)[0]
    third = (k / p.e + 0.5 / p.h) ** 3 * np.sqrt(2.0 * p.g * p.h) * (1.0 + p.g * T)
    return (APART**2 / 6.0 * third + rounded(p, dt)) / size(p)


def closed_difference(p, dt):
    """A step that goes back to the impact is exact: its differences are those of the closed form, and round-off."""
    ends = np.array([bounced_sensitivities(h, e, p.g, T)[:2] for h, e in balls(p)])
    by_h, by_e = ends[1] - ends[2], ends[3] - ends[4]
    found = np.array([*truth(p, T)[:3], *(np.stack((by_h, by_e), axis=1).ravel() / (2.0 * APART))])
    return Prediction(found - truth(p, T), rounded(p, dt) / size(p))


def late_limits(p, dt, kept):
    """A bounce is detected at most L = 1.5 dt late.  The speeds and their derivatives with respect to e
    are then off by g L per bounce, the heights by the speed times L, and what follows a bounce by e g L t.
    Where a ball leaves from below the floor it needs 1/e of that time.
    """
    k, L = bounces_until(p.h, p.e, p.g, T)[0], LATE * dt / p.e
    fast, exact = np.sqrt(2.0 * p.g * p.h), by_order(1.0 / T, T, dt)[EXACT]
    slower, moved = k * p.g * L, k * (fast * L + p.g * L * T)
    return {1: np.hypot(2.0 * slower, 3.0 * moved) / size(p, kept) + rounded(p, dt) / size(p, kept), EXACT: exact}


def late_differences(p, dt, rule, kept, far=1.0):
    """The balls of a difference are predicted one by one, as in the scene Bounces: a parabola over many steps, and the
    first end of a step below the floor.  The lesson's step then sets a ball on the floor, pybullet reverses it
    in place, and pymunk lifts it by a share of its depth per step.  Only round-off over the step of the
    difference remains.
    """
    found = stepped_differences(rule, p.h, p.e, p.g, dt, round(T / dt), APART)
    if found is None:
        return None
    law = in_fixed_steps(p, T, kept)
    return Prediction(np.array([p.slip * T, *found]) - law, rounded(p, dt, far) / size(p, kept))


# ---------------------------------------------------------------------------------------------- engines

def model(p):
    return over_floor([Body((0.0, h + RADIUS), 1.0, Ball(RADIUS), e=e, v=(p.slip, 0.0)) for h, e in balls(p)], p.g)


def read(state, p):
    x, v, _ = above_floor(state, RADIUS)
    return observe((x, v, differences(x), differences(v)), p)


def not_elastic(p):
    """Return whether e < 1: a difference needs a ball with more.

    Besides, with e = 1 a ball that is set on the floor meets it again exactly at the end of a step, and
    round-off decides in which step it bounces: there is nothing to differentiate.
    """
    return p.e < 1.0


def departure(why, kept, whose=Whose.LAW):
    return Departure(why, partial(in_fixed_steps, kept=kept), whose)


SAME_STEP = "its bounce stays in the same step when the first height changes a little, and there it "
SET_DOWN = SAME_STEP + "sets the ball on the floor: the height after the bounce no longer depends on the first one"
LEFT_BELOW = SAME_STEP + "hardly moves the ball: the height after the bounce grows with the first one"


def late(kept, rule, **about):
    """Return the fields of a runner that finds bounces at the ends of steps."""
    return {"order": 1, "supports": not_elastic, "limit": partial(late_limits, kept=kept),
            "predicted": partial(late_differences, rule=rule, kept=kept, **about)}


world = partial(built, model=model, read=read, iterations=1)
RUNNERS = (
    ours(SALTATION, order=EXACT, limit=exact_limit, predicted="exact: only round-off is left, and the limit bounds it"),
    ours(BACKTRACKING, order=EXACT, limit=difference_limit, predicted=closed_difference, supports=not_elastic),
    ours(PROJECTING, departure=departure(SET_DOWN, 0.0), **late(0.0, PROJECTING_RULE)),
    engine(PYMUNK, "", world(PYMUNK), "five circles on a thick segment; 1 iteration, collision_slop 1e-5",
           departure=departure(LEFT_BELOW, 1.0), most_steps=2500, **late(1.0, CHIPMUNK_RULE, far=4.0 * ASIDE)),
    engine(PYBULLET, "", world(PYBULLET),
           f"five spheres on a GEOM_PLANE; 1 iteration, {IMPACT_SETTINGS}",
           departure=departure(LEFT_BELOW, 1.0), most_steps=2500, **late(1.0, BULLET_RULE)),
)


def sanity_checks():
    """Return Findings: the derivatives by complex numbers through the whole flight, and the limit at an impact."""
    found, expected = [], []
    for p in CASES.values():
        def end(s, p=p):
            floor = Plane(np.array([0.0, 1.0]), np.zeros(2), s[1])
            x, v, _ = bounced_flight(np.array([0.0, s[0]]), np.zeros(2), T, np.array([0.0, -p.g]), [floor])
            return np.array([x[1], v[1]])
        found.append(by_complex_numbers(end, [p.h, p.e])[1].ravel())
        expected.append(truth(p, T)[3:])
    p = Params()
    behind = bounced_sensitivities(p.h, p.e, p.g, np.sqrt(2.0 * p.h / p.g) * (1.0 + 1e-12))
    return (
        states("the sensitivities by complex numbers through the whole flight", np.ravel(found), np.ravel(expected),
               1e-11),
        states("∂y/∂h just after the first impact: −e [-]", behind[2], -p.e, 1e-10),
    )


def points(observed, p):
    """Draw the ball over the floor, and where a ball from 10 cm higher up would be, to first order."""
    return np.array([[-0.2, 0.0], [1.4, 0.0], observed[:2], [observed[0], observed[1] + 0.1 * observed[3]]])


SCENE = Scene(
    title="Ball that bounces, with sensitivities", lesson="sensitivities",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: lessons.impulses.falling_acceleration, start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-14, model=model, read=read,
    quantity_names=lambda p: ["distance along the floor [m]", "height y [m]", "speed v [m/s]", "∂y/∂h [-]",
                              "∂y/∂e [m]", "∂v/∂h [1/s]", "∂v/∂e [m/s]"],
    sanity_checks=sanity_checks,
    points=points, links=ONE_LINK,
    uses=("two coordinates", "one plane", "four sensitivities"),
    ablations=dict.fromkeys(("rotation: the ball has no torque", "detection"),
                            "the scene Bounces of lesson 7 says what the whole loop costs"),
    full_loop="the loop has no sensitivities",
)
