"""A block under a periodic force slightly larger than friction: it slips twice per period, and sticks in between."""

from functools import partial
from typing import Any

import numpy as np

from solutions.given.friction import make_block
from solutions.support.model import Force
from validate.check import states
from validate.engines.friction import slab
from validate.methods import EVENT, SLIDING
from validate.reference.friction import (
    DrivenBlock,
    T,
    acceleration_at_first,
    carried_limit,
    carried_slip_error,
    leapfrog_slip_error,
    leapfrog_slip_limit,
    old_velocity_slip_error,
    slip_error,
    slip_limits,
    slip_position,
    slips,
)
from validate.scene import LATE_LEAPFROG, PYBULLET, PYMUNK, Scene, engine, ours
from validate.scenes._common import check_positives
from validate.scenes.friction._common import block_on, in_pybullet, in_pymunk, read_distance, slab_on_box, slab_on_line

STEPS = (80, 160, 400, 800, 1600, 4000, 8000)
CASES = {"F = 8 cos t": DrivenBlock(), "F = 16 cos 2t, turns without a rest": DrivenBlock(force=16.0, omega=2.0)}


def start(p):
    check_positives(p, "g", "m", "omega")
    block = make_block((0.0, 1.0), p.mu, p.mu, (0.0, -p.g), (p.force / p.m, 0.0), p.omega)
    return np.zeros(2), np.zeros(2), block


def run(lessons, step, acceleration, state, p, dt, steps):
    x, v, block = state
    return *lessons.integrators.advance(step, acceleration, 0.0, x, v, dt, steps, block), block


def model(p, later=0.0):
    """Make the slab on the floor, with its force of so many seconds later."""
    push = lambda t: (p.force * float(np.cos(p.omega * (t + later))), 0.0)
    return slab((0.0, -p.g), p.mu, m=p.m, loads=[Force(0, push, "t")])


def at_first(p):
    """Return the accelerations (2, 2), (2,) of the slab and the floor at the start, with friction."""
    return ((acceleration_at_first(p), 0.0), (0.0, 0.0)), (0.0, 0.0)


def late_in_pymunk(p, dt):
    """Make pymunk's slab with a leapfrog start.  It moves first, so its force is that of the end of a step."""
    return in_pymunk(partial(model, later=dt), read_distance, accelerations=at_first, iterations=10)(p, dt)


LEAPFROG: dict[str, Any] = {"order": LATE_LEAPFROG, "limit": leapfrog_slip_limit, "predicted": leapfrog_slip_error,
                            "measured": "what ten sweeps leave, on runs of 160 to 1,600 steps"}
PUSHED = ", the force applied each step"
RUNNERS = (
    ours(SLIDING, limit=slip_limits, predicted=slip_error),
    ours(EVENT, limit=slip_limits,
         predicted="it cuts its steps where slips begin and end, so its error is not a smooth function of dt"),
    engine(PYMUNK, "leapfrog start", late_in_pymunk,
           f"first velocity + ½ a dt; {slab_on_line(after=', the force of the end of each step', iterations=10)}",
           **LEAPFROG),
    engine(PYBULLET, "leapfrog start", in_pybullet(model, read_distance, accelerations=at_first, iterations=10),
           f"first velocity − ½ a dt; {slab_on_box(after=PUSHED, iterations=10)}",
           **LEAPFROG),
    engine(PYMUNK, "", in_pymunk(model, read_distance), slab_on_line(after=PUSHED),
           order=1, limit=slip_limits, predicted=old_velocity_slip_error),
    engine(PYBULLET, "", in_pybullet(model, read_distance), slab_on_box(after=PUSHED),
           order=1, limit=carried_limit, predicted=carried_slip_error),
)


def sanity_checks():
    """Return Findings: the times of the slips, and the positions after them."""
    p = CASES["F = 8 cos t"]
    times = np.array([[begin, end] for begin, end, _, _ in slips(p)])
    known = np.array([[0.0, 0.338608], [2.946347, 3.532835]])
    return (
        states("times of the slips [s]", times, known, 5e-7),
        states("x after the first slip [m]", slip_position(p, 1.0)[0], 0.00434857, 5e-9),
        states("x after the second [m]", slip_position(p, T)[0], -0.00869717, 5e-9),
    )


def points(observed, p):
    """Draw the block, its displacement magnified fifty times, and its initial position."""
    return np.array([[0.0, 0.0], [50.0 * observed[0], 0.3]])


SCENE = Scene(
    title="Stick and slip",
    **block_on("floor", start), cases=CASES, duration=T, steps=STEPS,
    acceleration=lambda lessons: lessons.friction.driven_acceleration, run=run,
    runners=RUNNERS,
    truth=slip_position, truth_uncertainty=1e-13, model=model, read=read_distance,
    sanity_checks=sanity_checks,
    points=points,
)
