"""A disc strikes another off-centre: without friction, only the line between their centres at contact matters."""

from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.given.impulses import Discs
from solutions.impulses import check_restitution
from solutions.support.model import Body, make_model
from solutions.support.shapes import Ball
from validate.check import states
from validate.methods import BACKTRACKING_DISCS, PROJECTING_DISCS
from validate.reference.impulses import APART, COPIES, delays, rounded_steps, struck
from validate.scene import EXACT, PYBULLET, PYMUNK, Prediction, Scene, by_order
from validate.scenes._common import built, check_positives, constantly
from validate.scenes.drawing import circle, outlines
from validate.scenes.impulses._common import copies_of, impact_runners, in_space

T = 1.0                      # [s]: they meet before half of it
STEPS = (20, 50, 100, 200, 500, 2000, 5000)
WINDOW = 0.1                 # spread of the starts over the copies [s]


class Params(NamedTuple):
    m1: Annotated[float, "mass of the moving disc [kg]"] = 1.0
    m2: Annotated[float, "mass of the resting disc [kg]"] = 2.0
    v: Annotated[float, "speed, along x [m/s]"] = 4.0
    R: Annotated[float, "radius of both [m]"] = 0.25
    offset: Annotated[float, "offset of the second centre in +y, over the sum of the radii [-]"] = 0.6
    e: Annotated[float, "restitution [-]"] = 0.9
    away: Annotated[float, "distance to the contact [m]"] = 1.6
    space: Annotated[float, "1: three coordinates, 0: two"] = 0.0


CASES = {"discs": Params(), "spheres": Params(space=1.0)}


def start(p):
    check_positives(p, "m1", "m2", "v", "R", "away")
    check_restitution(p.e)
    x, v = np.zeros((COPIES, 2, 3 if p.space else 2)), np.zeros((COPIES, 2, 3 if p.space else 2))
    x[:, 0, 0] = p.v * delays(WINDOW) - p.away
    x[:, 1, :2] = 2.0 * p.R * normal(p)
    v[:, 0, 0] = p.v
    return x, v, Discs(np.full(2, p.R), np.array([1.0 / p.m1, 1.0 / p.m2]), p.e)


def run(lessons, step, acceleration, state, p, dt, steps):
    x, v, discs = state
    return *lessons.impulses.advance_discs(step, x, v, dt, steps, discs), discs


def observe(state, p):
    """Return positions and velocities of both, of each copy: (COPIES, 8), flat."""
    x, v, _ = state
    return np.concatenate((x[:, :2, :2], v[:, :2, :2]), axis=2).ravel()


def normal(p):
    """Return the direction from the first to the second at contact: (cos θ, sin θ), sin θ = offset."""
    return np.array([np.sqrt(1.0 - p.offset**2), p.offset])


def after(p):
    """Return the velocities (2,), (2,) [m/s] after the impact."""
    n = normal(p)
    j = (1.0 + p.e) * p.v * n[0] / (1.0 / p.m1 + 1.0 / p.m2)
    return np.array([p.v, 0.0]) - j / p.m1 * n, j / p.m2 * n


def truth(p, t):
    """The discs move in straight lines;  j = (1 + e) v cos θ/(1/m₁ + 1/m₂)  along the line of centres, sin θ = offset.

    Source: first lecture deck, "Computing impulse", without rotation.
    """
    v1, v2 = after(p)
    rest, rows = 2.0 * p.R * normal(p), []
    for before in delays(WINDOW):
        since = t + before - p.away / p.v
        if since < 0.0:
            rows.append((p.v * since, 0.0, p.v, 0.0, *rest, 0.0, 0.0))
        else:
            rows.append((*(since * v1), *v1, *(rest + since * v2), *v2))
    return np.ravel(rows)


def limits(p, dt):
    """Contact is detected up to one step late.  The discs then overlap: the first is up to s = v dt too far.

    The line of centres is then at atan(sin θ/(cos θ − s/D)).  The normal turns by the difference Δθ, and the impulse
    (1 + e) m v (n · x) n changes by at most that times Δθ.  The result is a wrong velocity and a growing distance.  In
    addition the first disc travels s too far, and both are separated by their overlap, at most s.
    """
    exact, s = by_order(1.0 / T, T, dt)[EXACT], p.v * dt / (2.0 * p.R)
    c = normal(p)[0]
    # The first disc may pass the other before the first test.
    if s >= c:
        return {1: np.inf, EXACT: exact}
    turned = np.arctan2(p.offset, c - s) - np.arctan2(p.offset, c)
    impulse = (1.0 + p.e) * p.v / (1.0 / p.m1 + 1.0 / p.m2) * turned
    wrong = np.hypot(impulse / p.m1, impulse / p.m2)
    since = T + WINDOW - p.away / p.v
    off = np.hypot(wrong, wrong * since + 3.0 * p.v * dt)
    return {1: off * np.sqrt(COPIES) / np.linalg.norm(truth(p, T)) + exact, EXACT: exact}


def late_impact(p, dt, rule, far=5.0):
    """Each pair is predicted on its own.  The impact happens at the first end of a step with an overlap, along the
    line of centres at that moment.  A step that leads past the other disc detects no overlap.  The lesson's step moves
    the discs apart at once, pybullet never, and pymunk by a fraction of the overlap per step.
    """
    # largest coordinate [m], for round-off
    rest, reach, law = complex(*(2.0 * p.R * normal(p))), 2.0 * p.R, truth(p, T)
    ends = [struck(rule, complex(p.v * before - p.away), rest, complex(p.v), reach, p.m1, p.m2, p.e, dt,
                   round(T / dt)) for before in delays(WINDOW)]
    if None in ends:
        return None
    found = np.array(ends)
    size = np.linalg.norm(law)
    return Prediction(np.stack((found.real, found.imag), axis=-1).ravel() - law,
                      rounded_steps(T, dt, far * np.sqrt(COPIES) / size))


def model(p):
    """Make the copies of both discs, APART from each other.  Each has √e: a pair has the product."""
    x, v, _ = start(p)
    return make_model([Body((x[k, i, 0], x[k, i, 1] + APART * k), m, Ball(p.R), e=np.sqrt(p.e), v=tuple(v[k, i, :2]))
                       for k in range(COPIES) for i, m in enumerate((p.m1, p.m2))], (0.0, 0.0))


def read(state, p):
    return np.concatenate(copies_of(state, 2), axis=2).ravel()


FAR = {"far": APART * COPIES}
world = partial(built, model=model, read=read, iterations=1)
RUNNERS = impact_runners(
    (PROJECTING_DISCS, BACKTRACKING_DISCS), limits, late_impact,
    (world(PYMUNK), "pairs of circles; 1 iteration"),
    (world(PYBULLET), "pairs of spheres; 1 iteration"),
    pymunk_errs=FAR, bullet_errs=FAR)


def sanity_checks():
    p = Params()
    v1, v2 = after(p)
    return (
        states("velocity of the first [m/s]", v1, (0.757333, -2.432), 5e-7),
        states("of the second [m/s]", v2, (1.621333, 1.216), 5e-7),
        states("momentum [kg m/s]", p.m1 * v1 + p.m2 * v2, (4.0, 0.0), 1e-14),
    )


def points(observed, p):
    """Draw the first pair, each with six corners for its rim."""
    rim = p.R * circle(6)
    return np.round(np.concatenate((observed[0:2] + rim, observed[4:6] + rim)), 4)


def with_discs_that_miss(p):
    """Return the same motion beside three more discs, at rest and far away: ten pairs in place of one."""
    x, v, _ = start(p)
    rest = np.zeros((COPIES, 3, x.shape[2]))
    rest[:, :, 1] = -20.0 * p.R * np.arange(1.0, 4.0)
    discs = Discs(np.full(5, p.R), np.array([1.0 / p.m1, 1.0 / p.m2, 1.0, 1.0, 1.0]), p.e)
    return (np.concatenate((x, rest), axis=1), np.concatenate((v, 0.0 * rest), axis=1), discs), p


SCENE = Scene(
    title="Oblique discs", lesson="impulses",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-15, model=model, read=read,
    sanity_checks=sanity_checks,
    points=points, links=constantly(outlines(6, 2)),
    uses=("two coordinates", "two radii", "one number e for the impact"),
    full_loop="contacts of contact_step_2d do not bounce: another motion",
    ablations={
        "the third dimension": in_space(start),
        "rotation: without friction no torque acts on a disc": "the scene spinning_bounce puts it in",
        "three discs that never come near, in all ten pairs": with_discs_that_miss,
        "detection: all pairs are tested at every step": "lesson 6 finds pairs among many",
    },
)
