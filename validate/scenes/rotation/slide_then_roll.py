"""A ball bowled without spin first slides; friction slows and rotates it until it rolls."""

from functools import partial
from typing import Annotated, Any, NamedTuple

import numpy as np

from validate.check import states
from validate.methods import AVERAGE_ROLLING, ROLLING
from validate.reference.orientation import about
from validate.reference.schemes import summed
from validate.scene import PYBULLET, PYMUNK, ROUND_OFF, Prediction, Scene, engine, in_substeps, ours
from validate.scenes import drawing
from validate.scenes._common import built, check_positives, measured
from validate.scenes.drawing import pose
from validate.scenes.rotation import _common as balls
from validate.scenes.rotation._common import ball_on_floor as ball

T = 1.5                      # [s]
STEPS = (60, 120, 300, 600, 1200, 3000, 6000)


class Params(NamedTuple):
    shape: Annotated[float, "I/mR² [-]: 2/5 for a sphere, 1/2 for a disc"] = 0.4
    v0: Annotated[float, "initial speed [m/s]"] = 5.0
    mu: Annotated[float, "friction [-]"] = 0.2
    R: Annotated[float, "radius [m]"] = 0.1
    m: Annotated[float, "mass [kg]"] = 2.0
    g: Annotated[float, "gravity [m/s²]"] = 9.81


CASES = {"sphere": Params(), "disc": Params(shape=0.5)}


def start(p):
    check_positives(p, "shape", "R", "m", "mu", "g")
    return balls.bowled(p)


def run(lessons, step, acceleration, state, p, dt, steps):
    x, q, v, omega = state
    return lessons.rotation.advance_rigid_body(step, acceleration, 0.0, x, q, v, omega, dt, steps, ball(p))


def truth(p, t):
    """v = v₀ − μgt and Rω = μgt mR²/I until they meet at t* = v₀/(μg(1 + mR²/I)); then both are v₀/(1 + I/mR²).

    A sphere keeps 5/7 of the speed, a disc 2/3.
    Source: Newton and Euler with f = μmg; first lecture deck, friction.
    """
    return balls.rolled(p, t)


def round_off(dt):
    return 1e-12 + T / dt * ROUND_OFF


def limits(p, dt):
    """While it slides, a step that moves with the new velocity loses ½ μg dt per second.

    With the old one it gains the same.

    In the step in which it begins to roll the velocity is off by at most μg dt, for dt.  After that both velocities are
    exact, though pymunk's friction may act for one step more or less: another μg dt².
    With mean velocities, and with those of the middles of steps, only that one step is inexact: at most ⅛ μg dt².
    """
    brake, size = p.mu * p.g, np.linalg.norm(truth(p, T))
    bias = (0.5 * brake * dt * balls.rolls_from(p) + 2.0 * brake * dt * dt) / size
    return {1: bias + round_off(dt), 2: 0.125 * brake * dt * dt / size + round_off(dt)}


def new_velocity(p, dt, share=1.0):
    """Both velocities are exact at every step, but the ball moves with the new one, the old one or their mean.

    The rectangle rule, or the trapezoidal one, predicts where the ball ends: not far enough with the new velocity.
    """
    # share: of the new velocity in the way of a step
    new, old = summed(way(p), T, dt, 1.0), summed(way(p), T, dt, 0.0)
    return reached(share * new + (1.0 - share) * old, p, dt)


def way(p):
    """Return v(t)."""
    return lambda t: np.maximum(p.v0 - p.mu * p.g * t, p.v0 / (1.0 + p.shape))


def reached(x, p, dt):
    """Return the Prediction of a ball that rolls in the end, at x."""
    rolling = p.v0 / (1.0 + p.shape)
    return Prediction(np.array([x, rolling, rolling]) - truth(p, T), round_off(dt))


old_velocity, mean_velocity = partial(new_velocity, share=0.0), partial(new_velocity, share=0.5)


def halfway_velocity(p, dt):
    """With a leapfrog start velocities are those of the middles of steps, and the midpoint rule predicts the end."""
    return reached(summed(way(p), T, dt, 0.5), p, dt)


def model(p):
    return balls.rolling_model(ball(p), p.v0)


read = balls.read_rolling(lambda p: p.R)
world = partial(built, model=model, read=read)
in_pybullet = partial(world, PYBULLET, iterations=1, overlap=0.0, slop=0.0)
MAXIMAL = engine(PYBULLET, "", in_pybullet(ground=False),
                 "the ball in maximal coordinates, the ground in reduced ones; else the same",
                 order=1, limit=limits, predicted=new_velocity)
LEAPFROG: dict[str, Any] = {"order": 2, "limit": limits, "predicted": halfway_velocity}
RUNNERS = (
    ours(ROLLING, limit=limits, predicted=new_velocity),
    ours(AVERAGE_ROLLING, limit=limits, predicted=mean_velocity),
    engine(PYMUNK, "", world(PYMUNK, iterations=1), "1 iteration; the circle starts 1e-6 m inside the floor",
           order=1, limit=limits, predicted=old_velocity),
    engine(PYMUNK, "leapfrog start", world(PYMUNK, iterations=1, accelerations=balls.slips_at_first),
           "the same, first velocities + ½ a dt", **LEAPFROG),
    engine(PYBULLET, "reduced coordinates", in_pybullet(maximal=False),
           "createMultiBody on a GEOM_PLANE; 1 iteration, no residual threshold, no slop, no damping",
           order=1, limit=limits, predicted=new_velocity),
    MAXIMAL,
    in_substeps(MAXIMAL, 60),
    engine(PYBULLET, "leapfrog start", in_pybullet(ground=False, accelerations=balls.slips_at_first),
           "the same, first velocities − ½ a dt", **LEAPFROG),
)


def points(observed, p):
    """Draw the scene from the side: the centre, and the distance of the rim, both along the floor."""
    x, v, rim = observed
    beside, floor = x + 0.05, [[0.0, 0.0], [6.0, 0.0]]
    return np.array([[x, p.R], [x, p.R + 0.2 * v], [beside, p.R], [beside, p.R + 0.2 * rim], *floor])


def links(p):
    return [(0, 1), (2, 3), (4, 5)]


def bodies(p):
    return [drawing.sphere(p.R)]


def poses(observed, p):
    """Return the rotation of the rim.

    The rim moved ½ (Rω)²/(μg mR²/I) while the ball slid, and then the same distance as the ball after (v₀² − v²)/2μg.
    """
    x, v, rim = observed
    brake = p.mu * p.g
    way = 0.5 * rim**2 * p.shape / brake + max(0.0, x - (p.v0**2 - v**2) / (2.0 * brake))
    return [pose(np.array([x, 0.0, p.R]), about(np.array([0.0, 1.0, 0.0]), way / p.R))]


def arrows(observed, p):
    """Return v, and ω as long as the speed of the rim; they are equal as soon as it rolls."""
    x, v, rim = observed
    centre = np.array([x, 0.0, p.R])
    return {"v": (centre, centre + np.array([0.2 * v, 0.0, 0.0])),
            "ω": (centre, centre + np.array([0.0, 0.2 * rim, 0.0]))}


def sanity_checks():
    sphere, disc = CASES["sphere"], CASES["disc"]
    return (
        states("a sphere rolls from [s]", balls.rolls_from(sphere), 0.728120, 5e-7),
        states("its speed then [m/s]", truth(sphere, T)[1:], 25.0 / 7.0, 1e-14),
        states("a disc rolls from [s]", balls.rolls_from(disc), 0.849473, 5e-7),
        states("its speed then [m/s]", truth(disc, T)[1:], 10.0 / 3.0, 1e-14),
    )


SCENE = Scene(
    title="Slide, then roll", lesson="rotation",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: lessons.rotation.supported_weight,
    start=start, run=run, observe=balls.observe_rolling(lambda p: p.R),
    truth=truth, truth_uncertainty=1e-15, model=model, read=read,
    sanity_checks=sanity_checks,
    points=points, links=links,
    bodies=bodies, poses=poses, arrows=arrows,
    ground=True,
    uses=("one ball", "one force at one point", "the lecture's loop"),
    ablations={
        **measured("detection of the contact", "a force of the support that is solved for"),
    },
)
