"""A block launched over the floor stops after v²/2μg in every direction; with a friction pyramid it would not."""

from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import check_positive
from solutions.given.friction import make_block
from validate.check import Whose, states
from validate.engines import mujoco
from validate.engines.friction import slab
from validate.methods import AVERAGE_SLIDING, EVENT, PYRAMID, SLIDING
from validate.reference.friction import HALF, NOTHING_LEFT
from validate.reference.schemes import summed
from validate.scene import EXACT, MUJOCO, PYBULLET, PYMUNK, Departure, Prediction, Scene, engine, ours
from validate.scenes._common import ONE_LINK, coordinates, measured, round_off
from validate.scenes.friction._common import (
    BY_SWEEPS,
    JOINT,
    in_pybullet,
    in_pymunk,
    left_by,
    slab_on_box,
    slab_on_line,
)

T = 1.25                     # [s]: it stops after 1.02 s
STEPS = (50, 100, 200, 500, 1000, 2000, 5000)
ITERATIONS = 10              # iterations of the engines with a leapfrog start
rounded = round_off(T)


class Params(NamedTuple):
    degrees: Annotated[float, "heading, from the x axis [°]"] = 22.5
    v0: Annotated[float, "speed [m/s]"] = 3.0
    mu: Annotated[float, "friction [-]"] = 0.3
    g: Annotated[float, "gravity [m/s²]"] = 9.81


CASES = {"heading 22.5°": Params(), "heading 0°": Params(degrees=0.0), "heading 45°": Params(degrees=45.0)}


def thrown(p):
    """Return the initial velocity (3,) [m/s], z up."""
    heading = np.radians(p.degrees)
    return p.v0 * np.array([np.cos(heading), np.sin(heading), 0.0])


def start(p):
    check_positive("g", p.g)
    return np.zeros(3), thrown(p), make_block((0.0, 0.0, 1.0), p.mu, p.mu, (0.0, 0.0, -p.g), (0.0, 0.0, 0.0), 0.0)


def run(lessons, step, acceleration, state, p, dt, steps):
    x, v, block = state
    return *lessons.integrators.advance(step, acceleration, 0.0, x, v, dt, steps, block), block


def braked(v, t, a):
    """Return the distance [m] covered from the speed v ≥ 0 with the deceleration a [m/s²] until it stops."""
    t = np.minimum(t, v / a)
    return v * t - 0.5 * a * t * t


def truth(p, t):
    """s(t) = v₀ t − ½ μ g t²  until  t = v₀/μg,  in a straight line.

    Source: Coulomb 1785; ½ m v₀² = μ m g s.
    """
    return thrown(p)[:2] / p.v0 * braked(p.v0, t, p.mu * p.g)


def pyramid(p, t):
    """Return the positions under a friction square, which decelerates each component of v by μg until it stops.

    The components stop after v_x²/2μg and v_y²/2μg.  At 45° that is 1/√2 of the distance; at 22.5° the block turns
    towards the x axis and stops at 9.7°.
    """
    return braked(thrown(p)[:2], t, p.mu * p.g)


def limits(p, dt):
    """The velocity is exact at every step until it is zero.  The position uses the velocity at one end of each step,
    so its error is ½ v₀ dt.

    The last step is shorter, which adds up to ⅛ μg dt² (see the incline): all that a leapfrog start or the mean of
    both velocities leaves.  If the method finds the time of the stop, only round-off is left.
    """
    late, last = np.array((0.5 * p.v0 * dt, p.mu * p.g * dt * dt / 8.0)) / np.linalg.norm(truth(p, T))
    return {1: late + last + rounded(p, dt), 2: last + rounded(p, dt), EXACT: rounded(p, dt)}


def leapfrog_limit(p, dt):
    """With a leapfrog start only the last, shorter step has an error, and what the engine's
    sweeps leave, as measured.
    """
    return limits(p, dt)[2] + left_by_sweeps(p, dt)


def carried_limit(p, dt):
    """pybullet loses a slab that moves by more than half its length in a step; see the block that sticks and slips.
    What its sweeps leave was measured.
    """
    return leapfrog_limit(p, dt) if p.v0 * dt < HALF else np.inf


def left_by_sweeps(p, dt):
    return left_by(ITERATIONS, (1.0 + p.mu) * p.g * dt * T) / np.linalg.norm(truth(p, T))


def pyramid_limit(p, dt):
    """With the pyramid this limit holds for each component, relative to a shorter distance."""
    bias = np.linalg.norm(0.5 * thrown(p)[:2] * dt + p.mu * p.g * dt * dt / 8.0) / np.linalg.norm(pyramid(p, T))
    return bias + rounded(p, dt)


def new_velocity(p, dt, at=1.0):
    """The rectangle rule, as on the incline: too short with the new velocity, too long with pymunk's old one.

    With a leapfrog start it is the midpoint rule.
    """
    velocity = lambda t: np.maximum(0.0, 1.0 - p.mu * p.g / p.v0 * t[:, None]) * thrown(p)[:2]
    return Prediction(summed(velocity, T, dt, at) - truth(p, T), rounded(p, dt))


old_velocity = partial(new_velocity, at=0.0)


def mean_velocity(p, dt):
    """The trapezoidal rule: its error is the mean of those of both rectangle rules."""
    new, old = new_velocity(p, dt), old_velocity(p, dt)
    return new._replace(error=0.5 * (new.error + old.error))


def halfway_velocity(p, dt):
    found = new_velocity(p, dt, 0.5)
    return found._replace(band=found.band + left_by_sweeps(p, dt))


def carried_velocity(p, dt):
    return halfway_velocity(p, dt) if p.v0 * dt < HALF else None


def at_first(p, ahead):
    """Return the accelerations of the slab and the floor at the start; ahead: the unit vector of the throw."""
    brake = -p.mu * p.g * np.asarray(ahead)
    return (brake, 0.0 * brake), np.zeros(2 if len(brake) == 2 else (2, 3))


def new_velocities(p, dt):
    """With the pyramid the rectangle rule holds for each component."""
    velocities = lambda t: np.maximum(0.0, thrown(p)[:2] - p.mu * p.g * t[:, None])
    return Prediction(summed(velocities, T, dt, 1.0) - pyramid(p, T), rounded(p, dt))


BOX = Departure("it clamps friction along x and y separately, each to μ F_N", pyramid, Whose.LAW)


def model(p):
    return slab((0.0, 0.0, -p.g), p.mu, tuple(thrown(p)))


def in_the_plane_of_the_throw(p):
    return slab((0.0, -p.g), p.mu, (p.v0, 0.0))


def read(state, p):
    """Return x and y on the floor."""
    return state.x[0, :2]


def read_ahead(state, p):
    """Return the same of the block in the plane of the throw."""
    return state.x[0, 0] * thrown(p)[:2] / p.v0


def jointed(p, dt):
    """Make MuJoCo's block without a contact: the joint along the throw has the friction."""
    brake, ahead = p.mu * p.g, thrown(p)[:2] / p.v0
    return mujoco.rubbed(1.0, brake, 0.0, p.v0 + 0.5 * dt * brake, dt, lambda x: x * ahead)


def joint_limit(p, dt):
    """With a leapfrog start only the last, shorter step has an error.  The friction of MuJoCo's joint is −b v as soon
    as that is less than μg.  Here b = 2/τ, and τ is the time constant.  From v = μg/b on, the block slides by v/b.
    Coulomb's friction would stop it after v²/2μg, which is ½ μg/b² less.
    """
    return limits(p, dt)[2] + 0.5 * p.mu * p.g * (0.5 * mujoco.TIME_CONSTANT) ** 2 / np.linalg.norm(truth(p, T))


RUNNERS = (
    ours(SLIDING, limit=limits, predicted=new_velocity),
    ours(AVERAGE_SLIDING, limit=limits, predicted=mean_velocity),
    ours(PYRAMID, limit=pyramid_limit, predicted=new_velocities, departure=BOX),
    # the deceleration is constant, and the stop is found
    ours(EVENT, order=EXACT, limit=limits, predicted=NOTHING_LEFT),
    engine(PYMUNK, "", in_pymunk(in_the_plane_of_the_throw, read_ahead),
           slab_on_line("the vertical plane of the throw, "), order=1, limit=limits, predicted=old_velocity),
    engine(PYBULLET, "pyramid", in_pybullet(model, read, maximal=False, pyramid=True),
           "reduced coordinates, enableConeFriction 0; otherwise as in pybullet",
           order=1, limit=pyramid_limit, predicted=new_velocities, departure=BOX),
    engine(PYBULLET, "", in_pybullet(model, read), slab_on_box(), order=1, limit=limits, predicted=new_velocity),
    engine(PYMUNK, "leapfrog start",
           in_pymunk(in_the_plane_of_the_throw, read_ahead, accelerations=lambda p: at_first(p, (1.0, 0.0)),
                     iterations=ITERATIONS),
           f"first velocity + ½ a dt; {slab_on_line('the vertical plane of the throw, ', iterations=ITERATIONS)}",
           order=2, limit=leapfrog_limit, predicted=halfway_velocity, measured=BY_SWEEPS),
    engine(PYBULLET, "leapfrog start",
           in_pybullet(model, read, accelerations=lambda p: at_first(p, thrown(p) / p.v0), iterations=ITERATIONS),
           f"first velocity − ½ a dt; {slab_on_box(iterations=ITERATIONS)}",
           order=2, limit=carried_limit, predicted=carried_velocity, measured=BY_SWEEPS),
    engine(MUJOCO, "friction of a joint", jointed, JOINT, order="2 in long steps", limit=joint_limit,
           predicted="its friction is viscous below 3 cm/s, in steps shorter than half of its time constant"),
)


def sanity_checks():
    """Return Findings about the reference solution."""
    p = Params()
    corner = pyramid(Params(degrees=45.0), T)
    aside = pyramid(p, T)
    shorter = np.linalg.norm(corner) / np.linalg.norm(truth(p, T))
    direction, expected = np.arctan2(aside[1], aside[0]), np.arctan(np.tan(np.radians(22.5)) ** 2)
    return (
        states("distance to the stop [m]", np.linalg.norm(truth(p, T)), 1.529052, 5e-7),
        states("time to the stop [s]", p.v0 / (p.mu * p.g), 1.019368, 5e-7),
        states("distance with a pyramid at 45° over the exact one [-]", shorter, np.sqrt(0.5), 1e-14),
        states("final direction with a pyramid from 22.5° [°]", np.degrees(direction), np.degrees(expected), 1e-12),
    )


def points(observed, p):
    """Draw the scene from above."""
    return np.array([[0.0, 0.0], [observed[0], observed[1]]])


SCENE = Scene(
    title="Stopping block", lesson="friction",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: lessons.friction.driven_acceleration, start=start, run=run, observe=coordinates(2),
    truth=truth, truth_uncertainty=1e-15, model=model, read=read,
    sanity_checks=sanity_checks,
    points=points, links=ONE_LINK,
    uses=("three coordinates", "a normal", "one step of a block that stays on its plane"),
    ablations={
        **measured("rotation: it does not turn or tip", "detection: it does not leave the floor"),
    },
)
