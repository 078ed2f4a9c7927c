"""A ball is released on a slope and rolls: two sevenths of gravity's pull along the slope go into rotation."""

from functools import cache, partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import BadInput
from solutions.rotation import RollingBall
from validate.check import states
from validate.methods import AVERAGE_ROLLING, ROLLING
from validate.reference.orientation import about
from validate.scene import PYBULLET, ROUND_OFF, Prediction, Scene, engine, in_substeps, ours
from validate.scenes import drawing
from validate.scenes._common import built, check_positives, measured
from validate.scenes.drawing import pose
from validate.scenes.rotation._common import observe_rolling, read_rolling, rolling_model

T = 1.0                      # [s]
STEPS = (50, 100, 200, 500, 1000, 2000, 5000)


class Params(NamedTuple):
    slope: Annotated[float, "of the floor [°]"] = 15.0
    radius: Annotated[float, "[m]"] = 0.05
    m: Annotated[float, "mass [kg]"] = 0.5
    mu: Annotated[float, "friction [-]; it rolls from 2/7 tan 15° = 0.077 on"] = 0.5
    g: Annotated[float, "gravity [m/s²]"] = 9.81


CASES = {"15°": Params(), "hardly rough enough": Params(mu=0.077)}


@cache
def ball(p):
    slope = np.radians(p.slope)
    gravity = p.g * np.array([np.sin(slope), 0.0, -np.cos(slope)])
    return RollingBall(p.m, np.full(3, 0.4 * p.m * p.radius**2), p.radius, p.mu, gravity)


def start(p):
    check_positives(p, "radius", "m", "g")
    if not p.mu >= 2.0 / 7.0 * np.tan(np.radians(p.slope)):
        raise BadInput("the friction μ", p.mu, "give 2/7 tan(slope) or more: with less it slides")
    return np.array([0.0, 0.0, p.radius]), np.array([1.0, 0.0, 0.0, 0.0]), np.zeros(3), np.zeros(3)


def run(lessons, step, acceleration, state, p, dt, steps):
    x, q, v, omega = state
    return lessons.rotation.advance_rigid_body(step, acceleration, 0.0, x, q, v, omega, dt, steps, ball(p))


def truth(p, t):
    """v = rω = at,  s = ½at²,  a = g sin β/(1 + I/mr²) = (5/7) g sin β.

    Source: m v̇ = m g sin β − f,  I ω̇ = r f,  v = rω; second lecture deck, "sticking: any force in the cone".
    """
    a = acceleration_down(p)
    return np.array([0.5 * a * t * t, a * t, a * t])


def acceleration_down(p):
    return 5.0 / 7.0 * p.g * np.sin(np.radians(p.slope))


def round_off(dt):
    return 1e-12 + T / dt * ROUND_OFF


def limits(p, dt):
    """A step that moves with the new velocity ends ½ a dt T too far, in the engine too; v and ω are exact.

    With the mean velocity the distance is exact, too.
    """
    late = 0.5 * acceleration_down(p) * dt * T / np.linalg.norm(truth(p, T))
    return {1: late + round_off(dt), 2: round_off(dt)}


def new_velocity(p, dt, share=1.0):
    """The new velocity moves the ball during all of a step: ½ a dt T too far, in pybullet too.

    v and rω are exact.  Mean velocities make no error.
    """
    return Prediction(np.array([share * 0.5 * acceleration_down(p) * dt * T, 0.0, 0.0]), round_off(dt))


mean_velocity = partial(new_velocity, share=0.0)


def model(p):
    return rolling_model(ball(p))


read = read_rolling(lambda p: p.radius)
world = partial(built, PYBULLET, model, read, iterations=60, overlap=0.0, slop=0.0)
MAXIMAL = engine(PYBULLET, "", world(ground=False),
                 "the ball in maximal coordinates, the ground in reduced ones; else the same",
                 order=1, limit=limits, predicted=new_velocity)
RUNNERS = (
    ours(ROLLING, limit=limits, predicted=new_velocity),
    ours(AVERAGE_ROLLING, limit=limits, predicted=mean_velocity),
    engine(PYBULLET, "reduced coordinates", world(maximal=False),
           "createMultiBody on a GEOM_PLANE, slanted gravity; 60 iterations, no residual threshold, no slop, "
           "no damping",
           order=1, limit=limits, predicted=new_velocity),
    MAXIMAL,
    in_substeps(MAXIMAL, 50),
)


def points(observed, p):
    """Draw the slope from the side: the centre, and a mark on the rim, rotated by s/r."""
    slope, s = np.radians(p.slope), observed[0]
    down, up = np.array([np.cos(slope), -np.sin(slope)]), np.array([np.sin(slope), np.cos(slope)])
    turned = s / p.radius
    centre = s * down + p.radius * up
    mark = centre + p.radius * (np.sin(turned) * down + np.cos(turned) * up)
    return np.stack((centre, mark, np.zeros(2), 1.1 * down))


def links(p):
    return [(0, 1), (2, 3)]


def bodies(p):
    """Draw the ball, and a board for a slope."""
    return [drawing.sphere(p.radius), drawing.box((0.6, 0.15, 0.005))]


def axes(p):
    """Return unit vectors (3,) down the slope, along it, and out of it."""
    slope = np.radians(p.slope)
    return (np.array([np.cos(slope), 0.0, -np.sin(slope)]), np.array([0.0, 1.0, 0.0]),
            np.array([np.sin(slope), 0.0, np.cos(slope)]))


def poses(observed, p):
    down, along, out = axes(p)
    s = observed[0]
    return [pose(s * down + p.radius * out, about(along, s / p.radius)),
            pose(0.5 * down - 0.005 * out, about(along, np.radians(p.slope)))]


def arrows(observed, p):
    """Return v, and ω as long as the speed of the rim; they are equal because it rolls."""
    down, along, out = axes(p)
    s, v, rim = observed
    centre = s * down + p.radius * out
    return {"v": (centre, centre + 0.15 * v * down), "ω": (centre, centre + 0.15 * rim * along)}


def sanity_checks():
    s, v, _ = truth(Params(), T)
    return (states("speed after 1 s [m/s]", v, 1.813582, 5e-7), states("distance after 1 s [m]", s, 0.906791, 5e-7))


SCENE = Scene(
    title="Rolling down", lesson="rotation",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: lessons.rotation.supported_weight,
    start=start, run=run, observe=observe_rolling(lambda p: p.radius),
    truth=truth, truth_uncertainty=1e-15, model=model, read=read,
    sanity_checks=sanity_checks,
    points=points, links=links,
    bodies=bodies, poses=poses, arrows=arrows,
    uses=("one ball", "one force at one point", "the lecture's loop"),
    ablations={
        **measured("detection of the contact", "a force of the support that is solved for"),
    },
)
