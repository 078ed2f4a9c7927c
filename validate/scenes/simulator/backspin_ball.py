"""A billiard ball with backspin slides forwards, stops and rolls back.

Both parts of the motion are known exactly.  A loop errs only in the step in which the ball ceases to slip, and
because it uses the velocity at one end of a step.  The third of our methods cuts its step at that event.
"""

from functools import partial
from typing import Annotated, Any, NamedTuple

import numpy as np

from solutions.checks import check_positive
from validate.check import states
from validate.methods import AVERAGE_ROLLING, EXACT_ROLLING, ROLLING
from validate.reference.orientation import about
from validate.reference.schemes import summed
from validate.scene import EXACT, PYBULLET, PYMUNK, ROUND_OFF, Prediction, Scene, engine, ours
from validate.scenes import drawing
from validate.scenes._common import built, check_positives
from validate.scenes.drawing import circle, outlines, pose
from validate.scenes.rotation import _common as balls
from validate.scenes.rotation._common import ball_on_floor as ball

T = 3.0                      # [s]
STEPS = (30, 60, 150, 300, 600, 1500, 3000)
OVERLAP = 1e-6               # of pymunk's circle and the floor at the start [m]: without one it detects no contact


class Params(NamedTuple):
    shape: Annotated[float, "I/mR² [-]: 2/5 for a sphere, 1/2 for a disc"] = 0.4
    v0: Annotated[float, "initial speed [m/s]"] = 2.0
    rim0: Annotated[float, "initial speed of the rim, forwards if it rolls forwards [m/s]"] = -6.0
    mu: Annotated[float, "friction [-]"] = 0.2
    R: Annotated[float, "radius [m]"] = 0.1
    m: Annotated[float, "mass [kg]"] = 1.0
    g: Annotated[float, "gravity [m/s²]"] = 9.81


CASES = {"comes back": Params(), "stops dead": Params(rim0=-5.0), "goes on": Params(rim0=-3.0),
         "disc": Params(shape=0.5)}


def start(p):
    check_positives(p, "shape", "R", "m", "mu", "g")
    check_positive("slip v0 − rim0", p.v0 - p.rim0)
    return balls.bowled(p, p.rim0)


def run(lessons, step, acceleration, state, p, dt, steps):
    x, q, v, omega = state
    return lessons.rotation.advance_rigid_body(step, acceleration, 0.0, x, q, v, omega, dt, steps, ball(p))


def truth(p, t):
    """v = v₀ − μgt and Rω = rim₀ + μgt mR²/I until they meet; from then on both are constant.

    In the end v = (v₀ + (I/mR²) rim₀)/(1 + I/mR²): backwards for a sphere whose rim is faster than 5/2 v₀.
    Source: Newton and Euler with f = μmg; deck A, friction.
    """
    return balls.rolled(p, t, p.rim0)


def rounded(p, dt):
    return (1e-12 + T / dt * ROUND_OFF) * max(1.0, (abs(p.v0) + abs(p.rim0)) / np.linalg.norm(truth(p, T)))


def late_limit(p, dt, overlap=0.0):
    """While it slides, a step that moves with the new velocity loses ½ μg dt per second.

    With the old one it gains the same.

    In the step in which it begins to roll the velocity is off by at most μg dt, for dt.  After that both velocities are
    exact, though an engine's friction may act for one step more or less: another μg dt².
    """
    brake = p.mu * p.g
    late = 0.5 * brake * dt * balls.rolls_from(p, p.rim0) + 2.0 * brake * dt * dt
    return (late + overlap) / np.linalg.norm(truth(p, T)) + rounded(p, dt)


def mean_limit(p, dt):
    """With mean velocities only the step in which it begins to roll is inexact: by ½ μg s (dt − s), where s is the
    time in it at which rolling begins.  That is at most ⅛ μg dt², but no fixed fraction of dt²: the order that a sweep
    shows depends on s.  With a leapfrog start an engine's velocities are those of the middles of steps, with the same
    bound.
    """
    return 1.001 * 0.125 * p.mu * p.g * dt * dt / np.linalg.norm(truth(p, T)) + rounded(p, dt)


def cut_limit(p, dt):
    """A method that cuts its step where the ball begins to roll has no inexact step."""
    return rounded(p, dt)


def error(p, dt, share, overlap=0.0):
    """The rectangle rule with the new velocity, or the trapezoidal one: velocities are exact at every step.

    pymunk moves with the old velocity.  The band is the overlap with which both engines begin.
    """
    new, old = summed(way(p), T, dt, 1.0), summed(way(p), T, dt, 0.0)
    off, law = share * new + (1.0 - share) * old - truth(p, T)[0], truth(p, T)
    return Prediction(np.array([off, 0.0, 0.0]), rounded(p, dt) + overlap / np.linalg.norm(law))


def way(p):
    """Return v(t)."""
    return lambda t: p.v0 - p.mu * p.g * np.minimum(t, balls.rolls_from(p, p.rim0))


def halfway_error(p, dt):
    """The midpoint rule: with a leapfrog start velocities are those of the middles of steps."""
    off = summed(way(p), T, dt, 0.5) - truth(p, T)[0]
    return Prediction(np.array([off, 0.0, 0.0]), rounded(p, dt) + OVERLAP / np.linalg.norm(truth(p, T)))


def halfway_limit(p, dt):
    return mean_limit(p, dt) + OVERLAP / np.linalg.norm(truth(p, T))


def cut_error(p, dt):
    """A step that is cut at the event has no error."""
    return Prediction(np.zeros(3), rounded(p, dt))


def model(p):
    return balls.rolling_model(ball(p), p.v0, p.rim0)


read = balls.read_rolling(lambda p: p.R)
world = partial(built, model=model, read=read, iterations=1)
LEAPFROG: dict[str, Any] = {"order": "2 on average", "limit": halfway_limit, "predicted": halfway_error}
RUNNERS = (
    ours(ROLLING, limit=late_limit, predicted=partial(error, share=1.0)),
    ours(AVERAGE_ROLLING, order="2 on average", limit=mean_limit, predicted=partial(error, share=0.5)),
    ours(EXACT_ROLLING, order=EXACT, limit=cut_limit, predicted=cut_error),
    engine(PYMUNK, "", world(PYMUNK, overlap=OVERLAP), "1 iteration; the circle starts 1e-6 m inside the floor",
           order=1, limit=partial(late_limit, overlap=OVERLAP), predicted=partial(error, share=0.0, overlap=OVERLAP)),
    engine(PYBULLET, "", world(PYBULLET, overlap=0.0, slop=0.0),
           "maximal coordinates on a GEOM_PLANE; 1 iteration, no residual threshold, no slop, no damping",
           order=1, limit=late_limit, predicted=partial(error, share=1.0, overlap=OVERLAP)),
    engine(PYMUNK, "leapfrog start", world(PYMUNK, overlap=OVERLAP, accelerations=balls.slips_at_first),
           "as in pymunk, first velocities + ½ a dt", **LEAPFROG),
    engine(PYBULLET, "leapfrog start", world(PYBULLET, overlap=0.0, slop=0.0, accelerations=balls.slips_at_first),
           "as in pybullet, first velocities − ½ a dt", **LEAPFROG),
)


def turned(observed, p):
    """Return the angle of the ball [rad].

    It is (rim² − rim₀²)/(2μg mR²/I) R while it slides, and then the displacement of the ball over R.
    """
    x, v, rim = observed
    brake = p.mu * p.g
    way = 0.5 * (rim**2 - p.rim0**2) * p.shape / brake
    if abs(v - rim) < 1e-6:
        way += x - (p.v0**2 - v**2) / (2.0 * brake)
    return way / p.R


def points(observed, p):
    """Draw the ball from the side, with a spoke, and the speeds of its centre and of its rim as arrows beside it."""
    x, v, rim = observed
    centre, angle = np.array([x, p.R]), turned(observed, p)
    ring = centre + p.R * circle(24)
    spoke = centre + p.R * np.array([(np.sin(angle), np.cos(angle)), (0.0, 0.0)])
    speeds = centre + np.array([(0.0, 0.15), (0.1 * v, 0.15), (0.0, 0.2), (0.1 * rim, 0.2)])
    return np.vstack((ring, spoke, speeds, ((-0.7, 0.0), (1.5, 0.0))))


def links(p):
    return [*outlines(24), (24, 25), (26, 27), (28, 29), (30, 31)]


def bodies(p):
    return [drawing.sphere(p.R)]


def poses(observed, p):
    """Return the ball, rotated about y."""
    place = np.array([observed[0], 0.0, p.R])
    return [pose(place, about(np.array([0.0, 1.0, 0.0]), turned(observed, p)))]


def arrows(observed, p):
    """Return v of the centre, and the speed of the rim."""
    x, v, rim = observed
    centre = np.array([x, 0.0, p.R])
    return {"v": (centre, centre + np.array([0.1 * v, 0.0, 0.0])),
            "Rω": (centre, centre + np.array([0.1 * rim, 0.0, 0.0]))}


def sanity_checks():
    """Return Findings: the final speeds, and the momentum about the floor."""
    ends = [truth(p, T) for p in CASES.values()]
    kept = [p.v0 + p.shape * p.rim0 - end[1] - p.shape * end[2] for p, end in zip(CASES.values(), ends)]
    return (states("speeds in the end of the three spheres [m/s]", [end[1] for end in ends[:3]],
                   (-2.0 / 7.0, 0.0, 4.0 / 7.0), 1e-14),
            states("speed in the end over that of the rim [m/s]", [end[1] - end[2] for end in ends], 0.0, 1e-14),
            states("change of the angular momentum about the floor over m R [m/s]", kept, 0.0, 1e-14),
            states("it rolls from [s]", balls.rolls_from(Params(), Params().rim0), 1.164992, 5e-7))


SCENE = Scene(
    title="A ball with backspin", lesson="simulator",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: lessons.rotation.supported_weight,
    start=start, run=run, observe=balls.observe_rolling(lambda p: p.R),
    truth=truth, truth_uncertainty=1e-15, model=model, read=read,
    slow_cases=("goes on", "disc"),
    sanity_checks=sanity_checks,
    points=points, links=links,
    bodies=bodies, poses=poses, arrows=arrows,
    ground=True,
    uses=("one ball", "one force at one point", "the time at which it ceases to slip"),
    ablations={"detection of the contact": "the ball starts on the floor and stays there; lesson 6 finds contacts",
               "a force of the support that is solved for": "N = mg, because there is no vertical motion"},
)
