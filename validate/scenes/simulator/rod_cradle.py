"""Newton's cradle: five balls on rods with small gaps; one ball swings down, and one leaves: (0, 0, 0, 0, 1).

A hinge and a contact act in the same instant.  The loop visits them alternately until both hold.
"""

from functools import cache, partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import BadInput, check_not_negative
from solutions.given.simulator import Cradle
from solutions.simulator import make_bodies_2d, make_joints
from solutions.support.model import WORLD, Body, Hinge, make_model
from solutions.support.shapes import Ball
from validate.check import states
from validate.methods import JOINTED_LOOP, SWINGING
from validate.reference.orientation import about
from validate.reference.simulator import cradle_motion
from validate.scene import PYBULLET, PYMUNK, ROUND_OFF, Scene, engine, ours
from validate.scenes import drawing
from validate.scenes._common import built, check_positives
from validate.scenes.drawing import circle, outlines, pose

T = 0.7                      # [s]: all impacts are over after 0.6
STEPS = (5, 10, 20, 50, 100, 200, 500)
BALLS = 5
SWEEPS = 4                   # of the loop, one contact and hinges: each leaves I/mL² = 1e-3 of an error [-]
ITERATIONS = 100             # of pybullet in maximal coordinates [-]: with 50 its errors differ by more than 1 %
IN_PYMUNK = 3, 15            # iterations with gaps, and without [-]: 100 change no error by a ten thousandth of it
TOGETHER = 60                # of four contacts at once: each leaves cos²(π/5) = 0.65 [-]
TOUCHING = 1e-9              # margin of the loop [m]: it detects only contacts that touch
BY_PHASE = "1 on average"    # an order: the error is dt times a number that depends on the phases of the impacts
LOW = np.array([(0.0, 1.0, 100.0)])      # a plane far below: the world to which the rods are hinged


class Params(NamedTuple):
    lifted: Annotated[int, "balls that are let go"] = 1
    angle: Annotated[float, "of these from straight down [rad]"] = 0.3
    gap: Annotated[float, "between neighbours at rest [m]; 0: they touch"] = 0.02
    L: Annotated[float, "length of the rods, which have no mass [m]"] = 1.0
    R: Annotated[float, "radius [m]"] = 0.05
    g: Annotated[float, "gravity [m/s²]"] = 9.81


CASES = {"one ball": Params(), "two balls": Params(lifted=2), "touching": Params(gap=0.0)}


def moment(p):
    """Return the moment of inertia of a solid ball about its centre over its mass [m²]."""
    return 0.4 * p.R**2


def pitch(p):
    return 2.0 * p.R + p.gap


def pivots(p):
    return np.stack((pitch(p) * np.arange(BALLS), np.zeros(BALLS)), axis=1)


def angles(p):
    return np.where(np.arange(BALLS) < p.lifted, -p.angle, 0.0)


def centres(theta, p):
    return pivots(p) + p.L * np.stack((np.sin(theta), -np.cos(theta)), axis=1)


def start(p):
    """Return (PileState, JointedBodies, angles, rates) of the balls; each rotates with its rod."""
    check_positives(p, "angle", "L", "R", "g")
    check_not_negative("gap", p.gap)
    if not 1 <= p.lifted <= BALLS or p.angle >= 0.5 * np.pi:
        raise BadInput("balls and angle", (p.lifted, p.angle), f"lift 1 to {BALLS} balls by less than a right angle")
    x = centres(angles(p), p)
    state, rows = make_bodies_2d(x, angles(p), 1.0, moment(p), np.full((BALLS, 2), p.R), LOW, (0.0, -p.g), 0.0,
                                 SWEEPS if p.gap > 0.0 else TOGETHER, TOUCHING)
    joints = make_joints(state, rows, np.arange(BALLS), np.full(BALLS, BALLS), pivots(p), 1.0)
    return state, joints, angles(p), np.zeros(BALLS)


@cache
def cradle(p):
    return Cradle(pitch(p), p.L, p.R, p.L**2 + moment(p), p.g)


def run(lessons, step, acceleration, state, p, dt, steps):
    """Move the balls.  A method that moves their angles returns None in place of them."""
    simulator, (now, rows, theta, omega) = lessons.simulator, state
    if step is simulator.swinging_step:
        one_step = lessons.integrators.rk4_step
        return None, rows, *simulator.advance_swinging(one_step, 0.0, theta, omega, dt, steps, cradle(p))
    shape = simulator.disc_bounds, simulator.round_contacts
    return simulator.advance_contact(step, acceleration, *shape, 0.0, now, dt, steps, rows), rows, theta, omega


def seen(theta, omega, p):
    """Return the observed quantities: with gaps, the angle [rad] and rate [rad/s] of each ball.

    For touching balls they are the sums of both, and twice the energy over m L².
    """
    if p.gap > 0.0:
        return np.concatenate((theta, omega))
    energy = (1.0 + moment(p) / p.L**2) * np.sum(omega**2) + 2.0 * p.g / p.L * np.sum(1.0 - np.cos(theta))
    return np.array([np.sum(theta), np.sum(omega), energy])


def observe(state, p):
    now, _, theta, omega = state
    return seen(theta, omega, p) if now is None else seen(now.q[:BALLS], now.omega[:BALLS], p)


def truth(p, t):
    """With gaps: pendulums by DOP853 until a gap closes; then the impulse along the normal, with e = 1.

    Equal lever arms act like equal masses.  So each impact passes the rate on, up to squares of the angles, and the
    last ball leaves alone.  Source: Newton; Herrmann and Schmälzle 1981.  Touching balls collide at the same time,
    and five rates have only two conditions: momentum and energy.  For small angles gravity acts on the sum of the
    angles as on one pendulum, independent of which ball moves: the sums are those of one pendulum that swings
    through.  (Which balls leave depends on the law of impact: Moreau's in our loop gives (−0.26, 0, 0, 0.51, 0.51)
    rad/s with 400 steps, and another result where rounding closes one of the contacts a step later.)
    """
    if p.gap > 0.0:
        return np.concatenate(cradle_motion(*of(p), t)[:2])
    theta, omega, _ = cradle_motion(p.lifted, p.angle, p.lifted, 3.0 * p.L, *of(p)[4:], t)
    return seen(theta, omega, p)


def of(p):
    """Return the arguments of the reference."""
    return p.lifted, p.angle, BALLS, pitch(p), p.L, p.R, p.g, cradle(p).inertia


def limit(p, dt):
    """Positions use the new velocities, which costs half a step of the swing, ½ dt.  Each of four impacts (four for
    each ball that swings) is detected up to one step late, and so is everything after it.  Late by s, an angle is
    off by ω s and a rate by w² sin(angle) s, with w² = g/L; a ball that has stopped moved up to ω dt too far.  A
    step in which a ball crosses half of a gap merges two impacts; then there is no bound.

    Touching balls conserve the sums; a late impact of a ball inside the next one does not change them.  What is left is
    half a step of the swing, and the cubes in the sines.  Energy keeps Σ θ² below lifted · angle², so Σ |θ|³ is at most
    c = (lifted · angle²)^1.5.  The cubes change the sum of the rates by c/6 · w² T at most, and that of the angles by T
    times as much.
    """
    w2, size = p.g / p.L, np.linalg.norm(truth(p, T))
    fastest = 2.0 * np.sqrt(w2) * np.sin(0.5 * p.angle)
    rounded = 1e-11 + T / dt * ROUND_OFF
    if p.gap == 0.0:
        late = dt * np.array([fastest, w2 * np.sin(p.angle), 2.0 * w2 * fastest * p.angle])
        cubes = p.lifted**1.5 * p.angle**3 / 6.0 * w2 * T * np.array([T, 1.0, 0.0])
        return (np.linalg.norm(late) + np.linalg.norm(cubes)) / size + rounded
    if 2.0 * fastest * p.L * dt > p.gap:
        return np.inf
    late = (4.0 * p.lifted + 0.5) * dt
    moves = np.hypot(fastest, w2 * np.sin(p.angle)) * late * np.sqrt(p.lifted)
    rests = np.sqrt(BALLS - p.lifted) * fastest * dt * np.hypot(1.0, np.sqrt(w2)) * p.lifted
    return (moves + rests) / size + rounded


def cut_limit(p, dt):
    """A cut step has the error of Runge–Kutta 4: its phase is off by (w dt)⁴ w T/120, with w² = g L/I.  Impacts pass it
    on.
    """
    w = np.sqrt(p.g * p.L / cradle(p).inertia)
    swing = p.angle * np.sqrt(p.lifted) * np.hypot(1.0, w)
    return swing * (w * dt) ** 4 * w * T / 120.0 / np.linalg.norm(truth(p, T)) + 1e-11 + T / dt * ROUND_OFF


def model(p):
    """Make the balls, each on a hinge at its pivot; each turns with its rod."""
    balls = [Body(tuple(x), 1.0, Ball(p.R), e=1.0, q=angle, inertia=moment(p))
             for x, angle in zip(centres(angles(p), p), angles(p))]
    return make_model(balls, (0.0, -p.g), [Hinge(k, WORLD, tuple(pivot)) for k, pivot in enumerate(pivots(p))])


def read(state, p):
    """Observe the engines' balls; the angle is that of the centre about its pivot."""
    r, v = state.x - pivots(p), state.v
    return seen(np.arctan2(r[:, 0], -r[:, 1]), (r[:, 0] * v[:, 1] - r[:, 1] * v[:, 0]) / np.sum(r * r, axis=1), p)


def in_pymunk(p, dt):
    return world(PYMUNK, iterations=IN_PYMUNK[0 if p.gap > 0.0 else 1])(p, dt)


world = partial(built, model=model, read=read)
JUDGED = {"order": BY_PHASE, "limit": limit, "predicted": "the delays of its impacts depend on their phases in a step"}
RUNNERS = (
    ours(JOINTED_LOOP, **JUDGED),
    ours(SWINGING, limit=cut_limit, predicted="the leading term of its error is not derived, only its bound",
         supports=lambda p: p.gap > 0.0),
    engine(PYMUNK, "", in_pymunk, "PivotJoints, error_bias 0; collision_slop 1e-5, "
           f"{IN_PYMUNK[0]} iterations, and {IN_PYMUNK[1]} where balls touch", **JUDGED),
    engine(PYBULLET, "", world(PYBULLET, iterations=ITERATIONS, weighed=False),
           f"JOINT_POINT2POINT, erp 1; settings for impacts, {ITERATIONS} iterations", **JUDGED),
    engine(PYBULLET, "reduced coordinates", world(PYBULLET, iterations=1, maximal=False),
           "createMultiBody with hinges; settings for impacts, 1 iteration", **JUDGED,
           supports=lambda p: p.gap > 0.0),
)


def sanity_checks():
    """Return Findings: which balls leave, and the quantities that each impact conserves."""
    claims = []
    for lifted, leave in ((1, (0.0, 0.0, 0.0, 0.0, 1.0)), (2, (0.0, 0.0, 0.0, 1.0, 1.0))):
        p = Params(lifted=lifted)
        theta, omega, impacts = cradle_motion(*of(p), T)
        least = 2.0 * p.gap**2 / p.L**2
        lost = max(abs(after.sum() / before.sum() - 1.0) for _, _, before, after in impacts)
        claims.append(states(f"{lifted} lifted: momentum kept by each impact, over that of the first [-]",
                             lost, 0.0, 2.0 * least))
        fastest = 2.0 * np.sqrt(p.g / of(p)[-1] * p.L) * np.sin(0.5 * p.angle)
        # the others have been struck and swing back by g/L · gap/L per second since
        back = p.g / p.L * lifted * p.gap / p.L * 4.0 * p.gap / p.L / fastest
        claims.append(states(f"{lifted} lifted: rates after the last impact over that of the first ball [-]",
                             impacts[-1][3] / fastest, leave, 2.0 * back / fastest + 4.0 * least))
        energy = np.sum(omega**2) * of(p)[-1] + 2.0 * p.g * p.L * np.sum(np.cos(angles(p)) - np.cos(theta))
        claims.append(states(f"{lifted} lifted: energy that was gained, over the first [-]",
                             energy / (2.0 * p.g * p.L * lifted * (1.0 - np.cos(p.angle))), 0.0, 1e-10))
    return tuple(claims)


def points(observed, p):
    """Draw the pivots and the balls; touching balls at the start, because only sums are observed."""
    theta = np.asarray(observed)[:BALLS] if p.gap > 0.0 else angles(p)
    x = centres(theta, p)
    return np.round(np.vstack((pivots(p), x, (x[:, None] + p.R * circle(12)).reshape(-1, 2))), 4)


def links(p):
    return [(k, BALLS + k) for k in range(BALLS)] + outlines(12, BALLS, 2 * BALLS)


def bodies(p):
    """Return the balls, then the rods."""
    return [drawing.sphere(p.R)] * BALLS + [drawing.cylinder(0.1 * p.R, p.L)] * BALLS


def poses(observed, p):
    theta = np.asarray(observed)[:BALLS] if p.gap > 0.0 else angles(p)
    found, y = [], np.array([0.0, 1.0, 0.0])
    for middle in (centres(theta, p), 0.5 * (pivots(p) + centres(theta, p))):
        found += [pose(np.array([x, 0.0, z]), about(y, -angle)) for (x, z), angle in zip(middle, theta)]
    return found


SCENE = Scene(
    title="A cradle of balls on rods", lesson="simulator",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: lessons.simulator.weight, start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-9, model=model, read=read,
    slow_cases=("two balls", "touching"),
    sanity_checks=sanity_checks,
    points=points, links=links,
    bodies=bodies, poses=poses,
    uses=("hinges", "one contact at a time, with restitution", "the plane"),
    ablations={"friction": "neighbours slide on each other while they touch, for no time",
               "several impacts at once": "touching balls: no law decides which leave, but only sums of velocities"},
)
