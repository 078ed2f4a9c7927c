"""A block rocks from one lower corner to the other, and each impact removes a part of its rate, 5.8 % of a slender one.

The block is released at half of the angle at which it would tip over.  An impact conserves the angular momentum about
the new corner, because the impulse acts there and the old corner is free at once.  Our rocking step cuts its step at
the impact; the whole loop and the engines detect the corner when it touches.
"""

from functools import cache, partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import BadInput
from solutions.simulator import RockingBlock, make_bodies_2d
from solutions.support.model import Body, make_model
from solutions.support.shapes import Box, HalfSpace
from validate.check import states
from validate.methods import LOOP_2D, ROCKING
from validate.reference.simulator import rocking
from validate.scene import PYBULLET, PYMUNK, ROUND_OFF, Scene, engine, ours
from validate.scenes._common import built, check_positives
from validate.scenes.drawing import outlines

T = 0.6                      # [s]; the first impact is at about 0.35 s
STEPS = (24, 48, 120, 240, 480, 1200, 2400)
SWEEPS = 40                  # [-]
MARGIN = 0.02                # [m]
OVERLAP = 1e-6               # of the engines' bodies at the start [m], so that they detect a contact
MU = 5.0                     # nothing slides [-]
BY_PHASE = "1 on average"    # an order: the error is dt times a number that depends on the phase of the impact


class Params(NamedTuple):
    b: Annotated[float, "half width [m]"] = 0.1
    h: Annotated[float, "half height [m]"] = 0.5
    share: Annotated[float, "first lean over the angle at which it tips [-]"] = 0.5
    g: Annotated[float, "gravity [m/s²]"] = 9.81


CASES = {"half of the angle": Params(), "a quarter of it": Params(share=0.25), "stout": Params(b=0.2, h=0.5)}


def alpha(p):
    return np.arctan2(p.b, p.h)


def inertia(p):
    return (p.b * p.b + p.h * p.h) / 3.0


def place(p):
    """Return the centre (2,) [m] of the block when it leans on its left corner, which is at −b."""
    c, s = np.cos(p.share * alpha(p)), np.sin(p.share * alpha(p))
    return np.array([-p.b + c * p.b - s * p.h, s * p.b + c * p.h])


def start(p):
    """Return (angle (1,), rate (1,)), positive to the left."""
    check_positives(p, "b", "h", "share", "g")
    if p.share >= 1.0:
        raise BadInput("first lean over the angle at which it tips [-]", p.share, "give less than 1")
    return np.array([p.share * alpha(p)]), np.zeros(1)


@cache
def rocker(p):
    return RockingBlock(1.0, p.b, p.h, inertia(p), p.g)


def run(lessons, step, acceleration, state, p, dt, steps):
    simulator, (x, v) = lessons.simulator, state
    if step is simulator.rocking_step:
        return simulator.advance_rocking(lessons.integrators.rk4_step, 0.0, x, v, dt, steps, rocker(p))
    now, block = make_bodies_2d(place(p)[None], x, 1.0, inertia(p), np.array([(p.b, p.h)]),
                                np.array([(0.0, 1.0, 0.0)]), np.array([0.0, -p.g]), MU, SWEEPS, MARGIN)
    shape = simulator.box_bounds_2d, simulator.box_contacts_2d
    end = simulator.advance_contact(step, acceleration, *shape, 0.0, now, dt, steps, block)
    return end.q[:1], end.omega[:1]


def observe(state, p):
    """Return angle [rad] and rate [rad/s]."""
    return np.array([state[0][0], state[1][0]])


def truth(p, t):
    """A pendulum about each corner in turn, by DOP853; an impact keeps (4h² − 2b²)/(4h² + 4b²) of the rate.

    That is Housner's 1 − 3/2 sin²α.  Source: Housner 1963.
    """
    return np.array(rocking(p.b, p.h, p.g, p.share * alpha(p), t)[:2])


def late_limit(p, dt, overlap=0.0):
    """Let P² = 3 g/4R.  Errors grow as cosh(P t), in the fall and after the impact.

    The whole loop and the engines detect the corner up to dt late.  In that time the angular acceleration has the wrong
    sign: 2 P² sin α dt.  Before the impact positions use the new velocities: dt/2 P² sin α.  The pivot moves up by
    ½ ω² dt² per step and is set down again, another ½ ω² dt of the rate.  All of these grow by at most cosh(P T).
    """
    P2 = 0.75 * p.g / np.hypot(p.b, p.h)
    fastest = np.sqrt(P2) * alpha(p)
    late = (2.5 * P2 * np.sin(alpha(p)) + 0.5 * fastest**2) * dt
    return late * np.cosh(np.sqrt(P2) * T) / np.linalg.norm(truth(p, T)) + overlap


def cut_limit(p, dt):
    """A cut step has the error of Runge–Kutta 4, (P dt)⁴ P T/120 of the rate, and round-off."""
    P = np.sqrt(0.75 * p.g / np.hypot(p.b, p.h))
    cut = (P * dt) ** 4 * P * T / 120.0 * P * alpha(p) * np.cosh(P * T) / np.linalg.norm(truth(p, T))
    return cut + 1e-11 + T / dt * ROUND_OFF


def model(p):
    block = Body(place(p), 1.0, Box((p.b, p.h)), MU, q=p.share * alpha(p))
    return make_model([block, Body((0.0, 0.0), shape=HalfSpace((0.0, 1.0)), mu=1.0, e=1.0)], (0.0, -p.g))


def read(state, p):
    """Return angle [rad] and rate [rad/s]."""
    return np.array([state.q[0], state.omega[0]])


world = partial(built, model=model, read=read, overlap=OVERLAP)
# Tried at 24, 120, 480 and 2,400 steps; the errors with these settings are 263, 15, 3.0 and 0.65 % in pymunk, and 97,
# 15, 3.0 and 0.65 % in pybullet.  No setting mends what makes them: the corner is found up to a step late.
# pymunk at 480 and 2,400 steps: 3.1 and 0.64 % with 10 or 1,000 iterations, slop 0, or a persistence of contacts of 1
# or 30; 3.3 and 0.64 % with slop 1e-3 or 0.1, or bias 1; 2.8 to 3.0 and 0.64 % with bias 0 or 0.8⁶⁰; 3.5 and 2.0 % from
# 1e-4 m inside the floor; 8 and 6 % with a block rounded by 1 mm.  With a persistence of 0 it falls over at any step.
# pybullet: 2.8 to 2.9 and 0.66 % in reduced coordinates, with 10 or 1,000 iterations, with erp 0.2 or 0.8, a breaking
# threshold of 1e-4 or 0.1, or split impulses; 3.2 and 0.66 % with erp 0; 6 and 0.9 % with slop 1e-4 or more.  Four
# substeps err as four times as many steps do, 0.68 and 0.22 %.  The direct solver (Dantzig) gives 2.9 and 0.66 %.
BY_CHANCE = "the delay of the impact depends on its phase in the step"
RUNNERS = (
    ours(LOOP_2D, order=BY_PHASE, limit=late_limit, predicted=BY_CHANCE, in_quick=False),
    ours(ROCKING, limit=cut_limit, predicted="the leading term of its error is not derived, only its bound"),
    engine(PYMUNK, "", world(PYMUNK, iterations=2),
           "2 iterations, collision_slop 1e-5; the block starts 1e-6 m inside the floor; "
           "thirteen other settings find the corner as late",
           order=BY_PHASE, limit=partial(late_limit, overlap=1e-4), predicted=BY_CHANCE),
    engine(PYBULLET, "", world(PYBULLET, iterations=3, slop=0.0),
           "a box in space on a fixed box; maximal coordinates, 3 iterations, no residual threshold, no slop; "
           "thirteen other settings find the corner as late, but for substeps, which are smaller steps",
           order=BY_PHASE, limit=partial(late_limit, overlap=1e-3), predicted=BY_CHANCE),
)


def corners(observed, p):
    """Return the corners (4, 2) of the block, which stands on its lower left or right corner."""
    angle = observed[0]
    c, s, side = np.cos(angle), np.sin(angle), -1.0 if angle >= 0.0 else 1.0
    ring = np.array([(-p.b, -p.h), (p.b, -p.h), (p.b, p.h), (-p.b, p.h)]) @ np.array([(c, s), (-s, c)])
    foot = np.array([side * p.b, -p.h]) @ np.array([(c, s), (-s, c)])
    return ring - foot + np.array([side * p.b, 0.0])


def points(observed, p):
    return np.vstack((corners(observed, p), ((-0.6, 0.0), (0.6, 0.0))))


def links(p):
    return [*outlines(4), (4, 5)]


def sanity_checks():
    """Return Findings: the first impact, Housner's ratio and the energy it leaves."""
    p = Params()
    (first, before, after), *_ = rocking(p.b, p.h, p.g, 0.5 * alpha(p), T)[2]
    R = np.hypot(p.b, p.h)
    fall = p.g * R * (np.cos(0.5 * alpha(p)) - np.cos(alpha(p)))
    return (states("time of the first impact [s]", first, 0.347093587, 5e-10),
            states("size of the rate before it [rad/s]", abs(before), 0.648049012, 5e-10),
            states("rate after over before [-]", after / before, 1.0 - 1.5 * np.sin(alpha(p)) ** 2, 1e-12),
            states("energy of the rotation about the corner over that of the fall [-]",
                   2.0 / 3.0 * R * R * before**2 / fall, 1.0, 1e-9))


SCENE = Scene(
    title="A rocking block", lesson="simulator",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: lessons.simulator.weight, start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-11, model=model, read=read,
    slow_cases=("a quarter of it",),
    sanity_checks=sanity_checks,
    points=points, links=links,
    uses=("one angle", "the time at which it is zero", "angular momentum about the corner"),
    full_loop="its method finds the time of each impact; contacts of the loop stop a corner at the end of a step",
    ablations={"sliding": "with enough friction the corner stays where it is",
               "coming to rest": "that needs infinitely many impacts, in a finite time"},
)
