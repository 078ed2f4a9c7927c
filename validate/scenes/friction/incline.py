"""A block on a slope of 30°: released on a rough and on a smoother slope, and launched up a slope that can hold it."""

from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import check_positive
from solutions.given.friction import make_block
from solutions.support.model import Body, make_model
from solutions.support.shapes import Ball
from validate.check import Whose, states
from validate.engines import mujoco
from validate.engines.friction import LOW, floor, slab
from validate.engines.mujoco import IMPEDANCE, SOFT, TIME_CONSTANT
from validate.methods import EVENT, SLIDING
from validate.reference.friction import CLOSE, NOTHING_LEFT, SoftBlock
from validate.reference.schemes import summed
from validate.scene import EXACT, MUJOCO, PYBULLET, PYMUNK, Departure, Prediction, Scene, engine, ours
from validate.scenes._common import built, round_off
from validate.scenes.friction._common import (
    BY_SWEEPS,
    JOINT,
    block_on,
    in_pybullet,
    in_pymunk,
    left_by,
    read_distance,
    slab_on_box,
    slab_on_line,
)

T = 1.0                      # [s]
STEPS = (50, 100, 200, 500, 1000, 2000, 5000)
INSIDE = 1e-9                # where MuJoCo's ball begins, so that its first step has a contact [m]
ITERATIONS = 15              # iterations of the engines with a leapfrog start; fewer lose a slab in long steps
rounded = round_off(T)


class Params(NamedTuple):
    degrees: Annotated[float, "slope [°]"] = 30.0
    mu: Annotated[float, "friction, static and kinetic [-]"] = 0.5
    v0: Annotated[float, "initial speed down the slope [m/s]; up where negative"] = 0.0
    g: Annotated[float, "gravity [m/s²]"] = 9.81


CASES = {
    "slides, μ = 0.5": Params(),
    "slides, μ = 0.3": Params(mu=0.3),
    "thrown up, sticks, μ = 0.6": Params(mu=0.6, v0=-2.0),
}


def tilted(p):
    """Return gravity along the slope and normal to it [m/s²]: x points down the slope, y out of it."""
    theta = np.radians(p.degrees)
    return p.g * np.sin(theta), -p.g * np.cos(theta)


def start(p):
    check_positive("g", p.g)
    block = make_block((0.0, 1.0), p.mu, p.mu, tilted(p), (0.0, 0.0), 0.0)
    return np.zeros(2), np.array([p.v0, 0.0]), block


def run(lessons, step, acceleration, state, p, dt, steps):
    x, v, block = state
    return *lessons.integrators.advance(step, acceleration, 0.0, x, v, dt, steps, block), block


def truth(p, t):
    """s(t) = v₀ t + ½ a t²,  a = g (sin θ ∓ μ cos θ) while it slides down or up; after a stop it stays if tan θ ≤ μ.

    Otherwise it slides on.  Source: Coulomb 1785; two phases of constant acceleration.
    """
    along, across = tilted(p)
    stop, s = 0.0, 0.0
    if p.v0 < 0.0:
        brake = along - p.mu * across
        if t * brake < -p.v0:
            return np.array([p.v0 * t + 0.5 * brake * t * t])
        stop, s = -p.v0 / brake, -0.5 * p.v0**2 / brake
    a = along + p.mu * across
    v = max(p.v0, 0.0)
    if v == 0.0 and a <= 0.0:
        return np.array([s])
    later = t - stop if a >= 0.0 else min(t - stop, -v / a)
    return np.array([s + v * later + 0.5 * a * later * later])


def limits(p, dt):
    """The velocity is exact at every step.  The position uses the velocity at one end of each step, so its error is
    at most ½ dt times the change of velocity.

    A block that slides for the time T changes its velocity by a T.  A block that stops on the way changes it by v₀,
    and the last, shorter step adds up to ⅛ a dt².  pybullet moves with the new velocity like our methods of order 1,
    pymunk with the old one, which gives the same bound.  On two or four contacts, a slab of 2 m settles within an
    engine's iterations.  It begins with the overlap that the engine tolerates.
    """
    along, across = tilted(p)
    size = abs(truth(p, T)[0])
    change = abs(along + p.mu * across) * T if p.v0 == 0.0 else abs(p.v0)
    last = 0.0 if p.v0 == 0.0 else (along - p.mu * across) * dt * dt / 8.0
    late, last = 0.5 * dt * change / (size or 1.0), last / (size or 1.0)
    return {1: late + last + rounded(p, dt), 2: last + rounded(p, dt), EXACT: rounded(p, dt)}


def leapfrog_limit(p, dt):
    """With a leapfrog start only the last, shorter step of a block that stops has an error, and what the engine's
    sweeps leave, as measured.
    """
    return limits(p, dt)[2] + left_by_sweeps(p, dt)


def left_by_sweeps(p, dt):
    along, across = tilted(p)
    return left_by(ITERATIONS, (along - p.mu * across) * dt * T) / abs(truth(p, T)[0])


def new_velocity(p, dt, at=1.0):
    """Velocities are exact at every step, but the block moves with the new one (pymunk: the old one) for a whole step.

    So it ends where the rectangle rule ends: too low on the slope with the new velocity, too high with the old one.
    With a leapfrog start velocities are those of the middles of steps: the midpoint rule.
    """
    along, across = tilted(p)
    brake, a = along - p.mu * across, along + p.mu * across
    if (p.v0 < 0.0 and a > 0.0) or p.v0 > 0.0:
        return None
    velocity = (lambda t: np.minimum(p.v0 + brake * t, 0.0)) if p.v0 < 0.0 else (lambda t: max(a, 0.0) * t)
    return Prediction(np.array([summed(velocity, T, dt, at)]) - truth(p, T), rounded(p, dt))


old_velocity = partial(new_velocity, at=0.0)


def halfway_velocity(p, dt):
    found = new_velocity(p, dt, 0.5)
    return found and found._replace(band=found.band + left_by_sweeps(p, dt))


def at_first(p):
    """Return the accelerations (2, 2), (2,) of the slab and the floor at the start, with friction."""
    along, across = tilted(p)
    a = along - p.mu * across if p.v0 < 0.0 else max(along + p.mu * across, 0.0)
    return ((a, 0.0), (0.0, 0.0)), (0.0, 0.0)


def hops(p, dt):
    """MuJoCo's block hops on its contact.  The same contact law, solved in closed form, predicts every hop.  Runs
    whose starts differ by a nanometre show how accurate that is: the band is four times half of their range.
    """
    middle, half = soft(p).hopping(p.v0, dt, round(T / dt))
    law = held(p, T)[0]
    return Prediction(np.array([middle - law]), 4.0 * half / (abs(law) or 1.0) + CLOSE)


def soft(p):
    along, across = tilted(p)
    return SoftBlock(along, -across, p.mu, IMPEDANCE, TIME_CONSTANT)


def held(p, t):
    """While it slides, the block moves as the truth does.

    Where friction holds it, it creeps with (1 − d) τ/2 times g sin θ.

    d and τ are the impedance and the time constant of MuJoCo's contact.  Its last speed decays within a few τ.
    """
    along, across = tilted(p)
    slides = p.v0 > 0.0 or along + p.mu * across > 0.0
    return truth(p, t) if slides else np.array([soft(p).arrest(p.v0, t)])


def model(p):
    """Make the slab of pymunk and pybullet."""
    return slab(tilted(p), p.mu, (p.v0, 0.0))


def slides(p):
    """Return whether the block slides all the time: where a joint holds it, it creeps."""
    along, across = tilted(p)
    return p.v0 == 0.0 and along + p.mu * across > 0.0


def on_a_point(p):
    """Make MuJoCo's block, a ball that cannot turn: its law is known for one contact, and a slab has four."""
    ball = Body((0.0, LOW - INSIDE), 1.0, Ball(LOW), p.mu, v=(p.v0, 0.0), inertia=np.inf)
    return make_model([ball, floor(tilted(p))], tilted(p))



def jointed(p, dt):
    """Make MuJoCo's block without a contact: the joint along which it slides has the friction."""
    along, across = tilted(p)
    first = p.v0 - 0.5 * dt * at_first(p)[0][0][0]
    return mujoco.rubbed(1.0, -p.mu * across, along, first, dt, lambda x: np.array([x]))


TILTED = "gravity tilted, "
RUNNERS = (
    ours(SLIDING, limit=limits, predicted=new_velocity),
    # nothing changes between two events, and a midpoint step is then exact
    ours(EVENT, order=EXACT, limit=limits, predicted=NOTHING_LEFT),
    engine(PYMUNK, "leapfrog start", in_pymunk(model, read_distance, accelerations=at_first, iterations=ITERATIONS),
           f"first velocity + ½ a dt; {slab_on_line(TILTED, iterations=ITERATIONS)}", order=2,
           limit=leapfrog_limit, predicted=halfway_velocity, measured=BY_SWEEPS),
    engine(PYBULLET, "leapfrog start", in_pybullet(model, read_distance, accelerations=at_first, iterations=ITERATIONS),
           f"first velocity − ½ a dt; {slab_on_box(TILTED, iterations=ITERATIONS)}", order=2,
           limit=leapfrog_limit, predicted=halfway_velocity, measured=BY_SWEEPS),
    engine(PYMUNK, "", in_pymunk(model, read_distance), slab_on_line(TILTED),
           order=1, limit=limits, predicted=old_velocity),
    engine(PYBULLET, "", in_pybullet(model, read_distance), slab_on_box(TILTED),
           order=1, limit=limits, predicted=new_velocity),
    engine(MUJOCO, "", built(MUJOCO, on_a_point, read_distance), f"{TILTED}a ball that cannot turn; {SOFT}",
           order=1, limit=limits, predicted=hops,
           departure=Departure("its contact is a spring with a damper, and its friction holds only what moves: on the "
                               "slope that can hold it, a block creeps, more slowly with an impratio above the default",
                               held, Whose.DEFAULT)),
    engine(MUJOCO, "friction of a joint", jointed, JOINT, order=2, limit=limits,
           predicted=partial(new_velocity, at=0.5), supports=slides),
)


def sanity_checks():
    """Return Findings: the numbers of the lecture's slope, moving and from rest."""
    found = [2.0 * truth(CASES[name], T)[0] / T**2 for name in ("slides, μ = 0.5", "slides, μ = 0.3")]
    held = truth(Params(mu=float(np.tan(np.radians(30.0))) * 1.000001), T)[0]
    return (
        states("acceleration at μ = 0.5 [m/s²]", found[0], 0.657145, 5e-7),
        states("acceleration at μ = 0.3 [m/s²]", found[1], 2.356287, 5e-7),
        states("distance of a block that is held, from rest [m]", held, 0.0, 0.0),
    )


def points(observed, p):
    """Draw the ends of the slope, and the block, from the side."""
    theta = np.radians(p.degrees)
    down = np.array([np.cos(theta), -np.sin(theta)])
    return np.stack([-0.4 * down, 1.4 * down, observed[0] * down + 0.03 * np.array([np.sin(theta), np.cos(theta)])])


SCENE = Scene(
    title="Block on an incline",
    **block_on("slope", start), cases=CASES, duration=T, steps=STEPS,
    acceleration=lambda lessons: lessons.friction.driven_acceleration, run=run,
    runners=RUNNERS,
    truth=truth, truth_uncertainty=1e-15, model=model, read=read_distance,
    omitted_methods=("the integrators of lesson 1 have no stopping condition; the stability case "
                     "regularised-friction-creeps shows the effect"),
    sanity_checks=sanity_checks,
    points=points,
)
