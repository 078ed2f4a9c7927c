"""A chain of rigid rods on hinges is released from horizontal; its end whips round within a second.

Our joints solve for all hinges at once, by one band matrix.  pymunk and pybullet sweep over them, one after the other.
Angles need no joints at all: the chain obeys Lagrange's equations, and Runge–Kutta's method of lesson 1 solves them.
"""

from functools import cache, partial
from itertools import pairwise
from typing import Annotated, Any, NamedTuple

import numpy as np

from solutions.checks import BadInput
from solutions.given.simulator import RodsInAngles
from solutions.rotation import SUZUKI
from solutions.simulator import make_bodies, make_bodies_2d, make_joints
from solutions.support.model import WORLD, Body, Hinge, make_model
from validate.check import states
from validate.engines.bullet import HINGES
from validate.methods import COMPOSED_JOINTS, IN_ANGLES, JOINTS, JOINTS_IN_SPACE, SYMPLECTIC_EULER
from validate.reference.orientation import about
from validate.reference.schemes import Motion
from validate.reference.simulator import (
    rods_ends,
    rods_energy,
    rods_error,
    rods_gaps,
    rods_lag,
    rods_motion,
    rods_slope,
)
from validate.scene import (
    LATE_LEAPFROG,
    MUJOCO,
    PYBULLET,
    PYMUNK,
    ROUND_OFF,
    Scene,
    by_order,
    engine,
    in_substeps,
    ours,
)
from validate.scenes import drawing
from validate.scenes._common import built, check_positives
from validate.scenes.drawing import pose

T = 1.0                      # [s]
STEPS = (10, 20, 50, 100, 200, 500, 1000)
HEADING = np.array([0.6, 0.8, 0.0])      # of the chain in space: along no axis
THICK = 0.01                 # moment of a rod about its axis over the other two [-]
FIVE = (SUZUKI, SUZUKI, 1.0 - 4.0 * SUZUKI, SUZUKI, SUZUKI)


class Params(NamedTuple):
    rods: Annotated[int, "N [-]"] = 10
    l: Annotated[float, "length of each [m]"] = 0.1
    m: Annotated[float, "mass of each [kg]"] = 0.1
    g: Annotated[float, "gravity [m/s²]"] = 9.81


CASES = {"10 rods": Params(), "50 rods": Params(rods=50)}


def inertia(p):
    return p.m * p.l**2 / 12.0


def straight(p):
    """Return the ends (N + 1, 2) [m] at the start."""
    return p.l * np.stack((np.arange(p.rods + 1.0), np.zeros(p.rods + 1)), axis=1)


def start(p):
    """Return (x, q, v, ω, JointedBodies) in the plane, the same in space, and (angles, rates).  Body 0 is the wall."""
    check_positives(p, "l", "m", "g")
    if p.rods < 1:
        raise BadInput("rods", p.rods, "give 1 or more")
    ends, n = straight(p), np.arange(1, p.rods + 1)
    along = np.append(0.0, 0.5 * (ends[1:, 0] + ends[:-1, 0]))
    mass, I = np.append(np.inf, np.full(p.rods, p.m)), np.append(np.inf, np.full(p.rods, inertia(p)))
    flat, rows = make_bodies_2d(np.stack((along, 0.0 * along), axis=1), 0.0 * along, mass, I,
                                np.full((p.rods + 1, 2), 0.5 * p.l), np.zeros((0, 3)), (0.0, -p.g), 0.0, 1, 0.01)
    hinged = make_joints(flat, rows, n, n - 1, ends[:-1], 0.0)
    half_angle = 0.5 * np.arctan2(HEADING[1], HEADING[0])
    turned = np.tile(np.array([np.cos(half_angle), 0.0, 0.0, np.sin(half_angle)]), (p.rods + 1, 1))
    deep, rows = make_bodies(along[:, None] * HEADING, turned, mass, I[:, None] * np.array([THICK, 1.0, 1.0]),
                             np.full((p.rods + 1, 3), 0.5 * p.l), np.zeros((0, 4)), (0.0, 0.0, -p.g), 0.0, 1, 0.01)
    return (*flat[:4], hinged, *deep[:4], make_joints(deep, rows, n, n - 1, ends[:-1, :1] * HEADING, 0.0),
            flat.q[1:], flat.omega[1:])


@cache
def rods_of(p):
    return RodsInAngles(p.m, p.l, inertia(p), p.g)


def run(lessons, step, acceleration, state, p, dt, steps):
    """Move the rods in the plane, in space, or their angles; the places of those that do not move are then None."""
    simulator, advance = lessons.simulator, lessons.integrators.advance
    flat, deep, angles = state[:5], state[5:10], state[10:]
    if step is lessons.integrators.rk4_step:
        now = advance(step, simulator.rods_acceleration, 0.0, *angles, dt, steps, rods_of(p))
        return None, *flat[1:], None, *deep[1:], *now
    if step is simulator.joint_step:
        now = simulator.advance_free(step, acceleration, 0.0, *deep[:4], dt, steps, deep[4])
        return None, *flat[1:], *now, deep[4], *angles
    return *simulator.advance_free(step, acceleration, 0.0, *flat[:4], dt, steps, flat[4]), flat[4], *deep, *angles


def about_x(q):
    """Return the x axis (3,) of a body with the quaternion q: along the rod."""
    w, x, y, z = q
    return np.array([1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)])


def centres(angle, p):
    """Return the centres (N + 1, 2) [m] of the wall and of rods with these angles (N,)."""
    along = 0.5 * p.l * np.stack((np.cos(angle), np.sin(angle)), axis=1)
    return np.concatenate((np.zeros((1, 2)), np.cumsum(2.0 * along, axis=0) - along))


def lower_ends(x, angle, p):
    """Return the lower ends (2N,) [m] of rods with these centres (N, 2) and angles (N,)."""
    return (x + 0.5 * p.l * np.stack((np.cos(angle), np.sin(angle)), axis=1)).ravel()


def observe(state, p):
    """Return the lower ends in the plane of the motion."""
    x, q, deep_x, deep_q, angle = state[0], state[1], state[5], state[6], state[10]
    if x is not None:
        return lower_ends(x[1:], q[1:], p)
    if deep_x is None:
        return lower_ends(centres(angle, p)[1:], angle, p)
    along = np.array([about_x(q) for q in deep_q[1:]])
    flat = np.stack((deep_x[1:] @ HEADING, deep_x[1:, 2]), axis=1)
    return lower_ends(flat, np.arctan2(along[:, 2], along @ HEADING), p)


def of(p):
    """Return the arguments of the functions of the reference."""
    return p.rods, p.l, p.m, inertia(p), p.g, T


def truth(p, t):
    """The lower end of each rod, from the angles of all rods: Lagrange's equations by DOP853 at 1e-12.

    Angles have no joints that could open, so nothing is projected.
    """
    return rods_ends(rods_motion(*of(p)).sol(t)[:p.rods], p.l).ravel()


def size(p):
    return np.linalg.norm(truth(p, T))


def second(p, dt):
    """Return the relative error at T of the discrete Lagrangian, as in limits, and half as much again."""
    coarse = max(200, 10 * p.rods)
    return 1.5 * rods_error(*of(p), coarse) * (dt * coarse / T) ** 2 / size(p)


def fourth(p, dt):
    """Return the same of five of its steps with Suzuki's shares."""
    coarse = max(100, 4 * p.rods)
    return 1.5 * rods_error(*of(p), coarse, FIVE) * (dt * coarse / T) ** 4 / size(p)


def limits(p, dt):
    """Ours: the error of the same discrete Lagrangian written in angles, an independent code.  It is taken
    from one run, of 10 steps per rod (4 for the fourth order), at least 200 (100), and scaled with dt² (dt⁴); half of
    it is added for the next order in shorter steps.
    """
    rounded = 1e-11 + T / dt * 100.0 * ROUND_OFF
    return {2: second(p, dt) + rounded, 4: fourth(p, dt) + rounded}


def swept_limit(p, dt):
    """pymunk and pybullet also begin half a step late or early, an error of first order.  They close a joint in
    the step after the one that opened it, an error of second order.  If a rod rotates by more than a
    radian in a step, an expansion in powers of dt is meaningless.
    """
    gaps, fastest = rods_gaps(*of(p))
    late = (rods_lag(*of(p)) * dt + gaps * dt**2) / size(p)
    return late + second(p, dt) + 1e-9 if fastest * dt < 1.0 else np.inf


def leapfrog_limit(p, dt):
    """With a leapfrog start nothing is half a step late.  What fewer sweeps leave is no more than that was, as measured
    on runs of 100 to 1,000 steps.
    """
    return swept_limit(p, dt)


def is_short(p):
    """Return whether few sweeps, which carry an impulse over as many rods, reach the end of the chain."""
    return p.rods <= FEWER[PYMUNK]


def angles_limit(p, dt):
    """The angles of Runge–Kutta's method, of pybullet's hinges and of MuJoCo change at the greatest rate of a rod.

    They cannot leave a joint open: the method's table, applied to them, predicts the error.
    """
    return {order: limit + 1e-9 for order, limit in by_order(rods_gaps(*of(p))[1], T, dt).items()}


def hanging(p):
    """Return θ̈(t, θ, ω) of all rods, θ from straight down."""
    slope = rods_slope(p.rods, p.l, p.m, inertia(p), p.g)
    return lambda t, theta, omega: slope(t, np.concatenate((theta, omega)))[p.rods:]


def released(p):
    return np.full(p.rods, 0.5 * np.pi), np.zeros(p.rods)


def ends_of(theta, p):
    return rods_ends(theta, p.l).ravel()


ANGLES = Motion(T, hanging, released, ends_of, truth, lambda p, dt: 1e-9)


def model(p):
    """Make the rods on hinges; the first hangs on the world."""
    ends = straight(p)
    rods = [Body(tuple(0.5 * (a + b)), p.m, inertia=inertia(p)) for a, b in pairwise(ends)]
    return make_model(rods, (0.0, -p.g), [Hinge(k, k - 1 if k else WORLD, tuple(ends[k])) for k in range(p.rods)])


def read(state, p):
    return lower_ends(state.x, state.q, p)


world = partial(built, model=model, read=read)
LAGRANGIAN = "the same discrete Lagrangian in angles gives the size of its error, which is in its limit"
SWEEPS = "10 iterations for each rod, at least 100"          # an impulse travels one rod per iteration
SWEPT = "its sweeps over the joints, and the gaps that they leave, are bounded, but not modelled"
FEWER = {PYMUNK: 20, PYBULLET: 30}       # iterations: enough for 1 %, in a third and in half of the time
LEAPFROG: dict[str, Any] = {"order": LATE_LEAPFROG, "limit": leapfrog_limit, "predicted": SWEPT, "supports": is_short,
                            "measured": "what fewer sweeps leave, on runs of 100 to 1,000 steps"}
FINER = (2000, 5000, 10_000, 20_000)
HINGED = engine(PYBULLET, "reduced coordinates", world(PYBULLET, maximal=False), HINGES,
                order=1, limit=angles_limit, predicted=ANGLES.predict(SYMPLECTIC_EULER.table), finer_in_full=FINER)
RUNNERS = (
    ours(JOINTS, limit=limits, predicted=LAGRANGIAN),
    ours(COMPOSED_JOINTS, limit=limits, predicted=LAGRANGIAN, in_quick=False),
    ours(JOINTS_IN_SPACE, limit=limits, predicted=LAGRANGIAN, in_quick=False),
    ours(IN_ANGLES, limit=angles_limit, predicted=ANGLES.predict(IN_ANGLES.table)),
    engine(PYMUNK, "", world(PYMUNK), f"PivotJoints, error_bias 0, {SWEEPS}",
           order=1, limit=swept_limit, predicted=SWEPT, finer_in_full=FINER),
    engine(PYBULLET, "", world(PYBULLET),
           f"JOINT_POINT2POINT, maximal coordinates, erp 1, {SWEEPS}; it moves in one plane",
           order=1, limit=swept_limit, predicted=SWEPT, finer_in_full=FINER),
    engine(PYMUNK, "leapfrog start", world(PYMUNK, ahead=0.5, iterations=FEWER[PYMUNK]),
           f"first velocities + ½ g dt, {FEWER[PYMUNK]} iterations", **LEAPFROG),
    engine(PYBULLET, "leapfrog start", world(PYBULLET, ahead=0.5, iterations=FEWER[PYBULLET]),
           f"maximal coordinates, first velocities − ½ g dt, {FEWER[PYBULLET]} iterations", **LEAPFROG),
    HINGED,
    in_substeps(HINGED, 10),
    engine(MUJOCO, "", world(MUJOCO), "hinges; Runge–Kutta 4",
           order=4, limit=angles_limit, predicted=ANGLES.predict(IN_ANGLES.table)),
)


def sanity_checks():
    """Return Findings: conditions that the reference solution must meet."""
    claims = []
    for name, p in CASES.items():
        motion = rods_motion(*of(p))
        energies = [rods_energy(motion.sol(t), *of(p)[1:5]) for t in np.linspace(0.0, T, 21)]
        gained = np.ptp(energies) / (p.m * p.g * p.l * p.rods**2)
        claims.append(states(f"{name}: energy gained over the weight times the length", gained, 0.0, 1e-9))
    alone = Params(rods=1, l=0.8)
    swings = rods_motion(*of(alone)).sol(T)[0]
    from scipy.special import ellipj
    w, k = np.sqrt(1.5 * alone.g / alone.l), np.sqrt(0.5)
    _, cn, dn, _ = ellipj(w * T, k * k)
    claims.append(states("one rod: angle of a pendulum from horizontal, by an elliptic function [rad]", swings,
                         2.0 * np.arcsin(k * cn / dn), 1e-9))
    return tuple(claims)


def points(observed, p):
    return np.round(np.concatenate((np.zeros((1, 2)), np.reshape(observed, (-1, 2)))), 4)


def links(p):
    return [(n, n + 1) for n in range(p.rods)]


def bodies(p):
    return [drawing.capsule(0.12 * p.l, 0.76 * p.l) for _ in range(p.rods)]


def poses(observed, p):
    """Return the rods in the plane of x and z; a capsule lies along its own z."""
    ends = np.concatenate((np.zeros((1, 2)), np.reshape(observed, (-1, 2))))
    return [pose(np.array([x, 0.0, z]), about(np.array([0.0, 1.0, 0.0]), np.arctan2(*along)))
            for (x, z), along in zip(0.5 * (ends[1:] + ends[:-1]), ends[1:] - ends[:-1])]


SCENE = Scene(
    title="A chain of rods", lesson="simulator",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: lessons.simulator.weight, start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-9, model=model, read=read,
    slow_cases=("50 rods",),
    sanity_checks=sanity_checks,
    points=points, links=links,
    bodies=bodies, poses=poses,
    uses=("bodies that turn", "one matrix with a narrow band for all joints", "no detection"),
    ablations={"contact of the rods": "they would meet in the whip; the loop with joints of this lesson finds it",
               "friction in the hinges": "it is a load; lesson 3 has its laws"},
)
