"""A spinning ball hits the floor: friction removes as much slip as the cone permits; without slip the ball rolls."""

from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.friction import check_friction
from solutions.given.impulses import SpinningBall
from solutions.impulses import check_restitution
from solutions.support.model import Body
from solutions.support.shapes import Ball
from validate.check import states
from validate.methods import BACKTRACKING_SPIN, PROJECTING_SPIN
from validate.reference.impulses import APART, COPIES, all_dropped, delays, rounded_steps
from validate.scene import EXACT, PYBULLET, PYMUNK, Prediction, Scene, by_order
from validate.scenes._common import built, check_positives
from validate.scenes.impulses._common import above_floor, impact_runners, over_floor

T = 1.0                      # [s]: it hits the floor after half of it
STEPS = (20, 50, 100, 200, 500, 2000, 10000)
WINDOW = 0.2                 # spread of the starts over the copies [s]


class Params(NamedTuple):
    shape: Annotated[float, "I/mR² [-]: 2/5 for a sphere, 1/2 for a disc"] = 0.4
    mu: Annotated[float, "friction [-]"] = 0.1
    e: Annotated[float, "restitution [-]"] = 0.6
    v: Annotated[float, "along the floor [m/s]"] = 3.0
    fall: Annotated[float, "towards it [m/s]"] = 4.0
    rim: Annotated[float, "Rω, the spin's share of the slip [m/s]"] = 2.0
    h: Annotated[float, "initial height [m]"] = 2.0
    R: Annotated[float, "radius [m]"] = 0.1
    m: Annotated[float, "mass [kg]"] = 1.0


CASES = {
    "sphere slips": Params(),
    "sphere grips": Params(mu=0.5),
    "disc slips": Params(shape=0.5),
    "disc grips": Params(shape=0.5, mu=0.5),
}


def start(p):
    check_positives(p, "shape", "R", "m", "h", "fall")
    check_restitution(p.e)
    check_friction(p.mu)
    before = delays(WINDOW)
    x, v, omega = np.zeros((COPIES, 3)), np.zeros((COPIES, 3)), np.zeros((COPIES, 3))
    x[:, 0], x[:, 2] = p.v * before, p.h - p.fall * before
    # the lowest point moves with −Rω_y
    v[:, 0], v[:, 2], omega[:, 1] = p.v, -p.fall, -p.rim / p.R
    up = np.array([0.0, 0.0, 1.0])
    inv_inertia = np.eye(3) / (p.shape * p.m * p.R**2)
    return x, v, omega, SpinningBall(p.e, p.mu, 1.0 / p.m, inv_inertia, p.R, np.zeros(3), np.zeros(3), up)


def run(lessons, step, acceleration, state, p, dt, steps):
    x, v, omega, ball = state
    x, v, omega = lessons.impulses.advance_spinning_balls(step, acceleration, 0.0, x, v, omega, dt, steps, ball)
    return x, v, omega, ball


def observe(state, p):
    """Return position, velocity and rim speed of each copy."""
    x, v, omega, _ = state
    return np.stack((x[:, 0], x[:, 2], v[:, 0], v[:, 2], -p.R * omega[:, 1]), axis=1).ravel()


def after(p):
    """Return (v, Rω) after the impact.

    The slip is v + Rω.  The impulse of friction is at most μ m (1 + e) |v_n|, and at most what stops the slip.
    """
    needed = (p.v + p.rim) / (1.0 + 1.0 / p.shape)
    given = min(p.mu * (1.0 + p.e) * p.fall, needed)
    return p.v - given, p.rim - given / p.shape


def truth(p, t):
    """The ball moves in straight lines with an impact:  v_n⁺ = −e v_n,  v⁺ = v − J/m,  Rω⁺ = Rω − J R²/I.

    J = min(μ(1 + e) m |v_n|, m (v + Rω)/(1 + mR²/I)).
    Source: linear and angular momentum about the point of contact; the ball sticks if Coulomb's cone permits.
    """
    v, rim = after(p)
    rows = []
    for before in delays(WINDOW):
        since = t + before - p.h / p.fall
        if since < 0.0:
            rows.append((p.v * (t + before), -p.fall * since, p.v, -p.fall, p.rim))
        else:
            rows.append((p.v * p.h / p.fall + v * since, p.e * p.fall * since, v, p.e * p.fall, rim))
    return np.ravel(rows)


def limits(p, dt):
    """The impact is detected up to one step late.  Until then the ball moves as before, so it is off by (v⁺ − v) dt.

    Placed on the floor, it lacks the e |v_n| dt by which it should have risen.  Velocities are exact, because they
    do not depend on the position.
    """
    v, _ = after(p)
    exact = by_order(1.0 / T, T, dt)[EXACT]
    late = np.hypot(p.v - v, (1.0 + p.e) * p.fall) * dt * np.sqrt(COPIES) / np.linalg.norm(truth(p, T))
    return {1: late + exact, EXACT: exact}


def late_impact(p, dt, rule, far=5.0):
    """Each ball is predicted on its own.  An impact is detected at the first end of a step below the floor; until then
    the ball moves as before.  The lesson's step then sets it on the floor.  pybullet reverses it in place.  pymunk
    reverses it and then lifts it by a fraction of its depth per step.
    """
    # largest coordinate [m], for round-off
    before = delays(WINDOW)
    runs = all_dropped(rule, p.h - p.fall * before, np.full(COPIES, -p.fall), 0.0, p.e, dt, round(T / dt))
    if runs is None:
        return None
    (found, ways), law, (v, rim) = runs, truth(p, T), after(p)
    hit = np.minimum(found[:, 2] * dt, T)
    done = hit < T
    rows = (p.v * (before + hit) + v * (T - hit), found[:, 0], np.where(done, v, p.v), found[:, 1],
            np.where(done, rim, p.rim))
    size = np.linalg.norm(law)
    unsure = 1.01 * np.linalg.norm(ways * (1.0, 1.0, abs(p.v - v) * dt))
    return Prediction(np.stack(rows, axis=1).ravel() - law,
                      unsure / size + rounded_steps(T, dt, far * np.sqrt(COPIES) / size))


def model(p):
    ball = Body((0.0, 0.0), p.m, Ball(p.R), p.mu, p.e, v=(p.v, -p.fall), omega=p.rim / p.R,
                inertia=p.shape * p.m * p.R**2)
    return over_floor([ball._replace(x=(p.v * before, p.h - p.fall * before + p.R)) for before in delays(WINDOW)], 0.0)


def read(state, p):
    x, v, omega = above_floor(state, p.R)
    return np.column_stack((x, v, p.R * omega)).ravel()


def is_sphere(p):
    return p.shape == 0.4


FAR = {"far": APART * COPIES}
world = partial(built, model=model, read=read, iterations=1)
RUNNERS = impact_runners(
    (PROJECTING_SPIN, BACKTRACKING_SPIN), limits, late_impact,
    (world(PYMUNK), "circles on a thick segment; 1 iteration"),
    (world(PYBULLET), "spheres on a GEOM_PLANE; 1 iteration"),
    pymunk_errs=FAR, bullet_errs=FAR, supports=is_sphere)


def sanity_checks():
    found = [after(p) for p in CASES.values()]
    expected = ((2.36, 0.4), (11.0 / 7.0, -11.0 / 7.0), (2.36, 0.72), (4.0 / 3.0, -4.0 / 3.0))
    return (states("v and Rω afterwards [m/s]", found, expected, 1e-14),)


def points(observed, p):
    """Draw the first copy: its centre, and a spoke that turns."""
    x, z, v, _, rim = observed[:5]
    before = delays(WINDOW)[0]
    t = before + x / p.v if rim == p.rim else p.h / p.fall + (x - p.v * p.h / p.fall) / v
    turned = (p.rim * min(t, p.h / p.fall) + rim * max(0.0, t - p.h / p.fall)) / p.R
    centre = np.array([x, z + p.R])
    return np.array([[-0.2, 0.0], [3.2, 0.0], centre, centre + p.R * np.array([np.cos(turned), np.sin(turned)])])


def links(p):
    return [(0, 1), (2, 3)]


SCENE = Scene(
    title="Spinning bounce", lesson="impulses",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: lessons.impulses.falling_acceleration, start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-15, model=model, read=read,
    sanity_checks=sanity_checks,
    points=points, links=links,
    uses=("one ball", "one angular velocity", "one impulse in a cone"),
    full_loop="contacts of contact_step_2d and of contact_step do not bounce",
    ablations={
        "gravity": "it would bend the path, and is part of the step: the scene bounces has it",
        "orientation": "the rotation angle of a plain ball cannot be seen",
        "detection": "one ball, one plane; lesson 6 finds contacts",
    },
)
