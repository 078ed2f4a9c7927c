"""A block launched over the floor stops after v²/2μg in every direction; with a friction pyramid it would not."""

from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import check_positive
from solutions.friction import driven_acceleration as acceleration
from solutions.integrators import advance
from solutions.support.friction import make_block
from validate.engines.friction import SWEEPS, bullet_block, pymunk_block
from validate.methods import EVENT, PYRAMID, SLIDING
from validate.reference.schemes import summed
from validate.scene import EXACT, PYBULLET, PYMUNK, Departure, Engine, Prediction, Scene, by_order

T = 1.25                     # [s]: it stops after 1.02 s
STEPS = (50, 100, 200, 500, 1000, 2000, 5000)


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


def run(step, acceleration, state, p, dt, steps):
    x, v, block = state
    return *advance(step, acceleration, 0.0, x, v, dt, steps, block), block


def observe(state, p):
    return state[0][:2]


def braked(v, t, a):
    """Return the distance [m] covered from the speed v ≥ 0 with the deceleration a [m/s²] until it stops."""
    t = np.minimum(t, v / a)
    return v * t - 0.5 * a * t * t


def truth(p, t):
    """s(t) = v₀ t − ½ μ g t²  until  t = v₀/μg,  straight on.

    Source: Coulomb 1785; ½ m v₀² = μ m g s.
    """
    return thrown(p)[:2] / p.v0 * braked(p.v0, t, p.mu * p.g)


def pyramid(p, t):
    """With a square for the disc each component is decelerated by μg until it stops, after v_x²/2μg and v_y²/2μg.

    At 45° that is 1/√2 of the distance; at 22.5° the block turns towards the x axis and stops at 9.7°.
    """
    return braked(thrown(p)[:2], t, p.mu * p.g)


def tolerance(p, dt):
    """The velocity is exact at every step until it is zero.  Positions sum it at the wrong end of each step: ½ v₀ dt.

    The last step is shorter, which adds up to ⅛ μg dt² (see the incline).  With the pyramid the same holds for each
    component, relative to a shorter distance.
    """
    limits = by_order(0.0, T, dt)
    v, a = thrown(p)[:2], p.mu * p.g
    bias = (0.5 * p.v0 * dt + a * dt * dt / 8.0) / np.linalg.norm(truth(p, T)) + limits[EXACT]
    square = np.linalg.norm(0.5 * v * dt + a * dt * dt / 8.0) / np.linalg.norm(pyramid(p, T)) + limits[EXACT]
    return {**limits, 1: bias, "pymunk": bias, "pybullet": bias, "pyramid": square, "pybullet, pyramid": square}


NEW_VELOCITY = {"sliding": True, "pybullet": True, "pymunk": False, "pyramid": True, "pybullet, pyramid": True}


def predicted_error(label, p, dt):
    """The rectangle rule, as on the incline: too short with the new velocity, too long with pymunk's old one.

    With the pyramid the same holds for each component.
    """
    if label not in NEW_VELOCITY:
        return None
    v, a, square = thrown(p)[:2], p.mu * p.g, "pyramid" in label
    share = (lambda t: v * 0.0 + np.maximum(0.0, v - a * t[:, None])) if square else (
        lambda t: np.maximum(0.0, 1.0 - a / p.v0 * t[:, None]) * v)
    error = summed(share, T, dt, NEW_VELOCITY[label]) - (pyramid if square else truth)(p, T)
    return Prediction(error, by_order(0.0, T, dt)[EXACT])


def pymunk_make(p, dt):
    """Use the vertical plane of the launch; positions are rotated back into the floor."""
    ahead = thrown(p)[:2] / p.v0
    return pymunk_block((0.0, -p.g), p.mu, p.v0, dt, lambda x: x.x * ahead)


def pybullet_make(p, dt, pyramid=False):
    return bullet_block((0.0, 0.0, -p.g), p.mu, thrown(p), p.v0, dt, lambda x: np.array(x[:2]), pyramid=pyramid)


ENGINES = (
    Engine(
        PYMUNK,
        "",
        pymunk_make,
        1,
        f"the vertical plane of the throw, a slab of 2 m on a line; {SWEEPS} iterations, collision_slop 1e-5",
    ),
    Engine(
        PYBULLET,
        "pyramid",
        lambda p, dt: pybullet_make(p, dt, pyramid=True),
        1,
        "reduced coordinates, enableConeFriction 0; otherwise as in pybullet",
    ),
    Engine(
        PYBULLET,
        "",
        pybullet_make,
        1,
        f"a slab of 2 m on a box; maximal coordinates, solverResidualThreshold 0, {SWEEPS} iterations",
    ),
)
BOX = "it clamps friction along x and y separately, each to μ F_N"


def sanity_checks():
    """Return ((claim, found, expected, tolerance), …) about the reference solution."""
    p = Params()
    corner = pyramid(Params(degrees=45.0), T)
    aside = pyramid(p, T)
    shorter = np.linalg.norm(corner) / np.linalg.norm(truth(p, T))
    direction, expected = np.arctan2(aside[1], aside[0]), np.arctan(np.tan(np.radians(22.5)) ** 2)
    return (
        ("distance to the stop [m]", np.linalg.norm(truth(p, T)), 1.529052, 5e-7),
        ("time to the stop [s]", p.v0 / (p.mu * p.g), 1.019368, 5e-7),
        ("distance with a pyramid at 45° over the exact one [-]", shorter, np.sqrt(0.5), 1e-14),
        ("final direction with a pyramid from 22.5° [°]", np.degrees(direction), np.degrees(expected), 1e-12),
    )


def points(observed, p):
    """Draw the scene from above."""
    return np.array([[0.0, 0.0], [observed[0], observed[1]]])


def links(p):
    return [(0, 1)]


SCENE = Scene(
    title="Stopping block", lesson="friction",
    cases=CASES, duration=T, steps=STEPS,
    methods=(SLIDING, PYRAMID, EVENT),
    acceleration=acceleration, start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-15, tolerance=tolerance, predicted_error=predicted_error,
    engines=ENGINES,
    expected_departures={"pyramid": Departure(BOX, pyramid), "pybullet, pyramid": Departure(BOX, pyramid)},
    # The deceleration is constant, and the stop is found.
    orders={"event_step": EXACT},
    sanity_checks=sanity_checks,
    points=points, links=links,
    uses=("three coordinates", "a normal", "one step of a block that stays on its plane"),
    ablations={
        "rotation: it does not turn or tip": "the whole loop of lesson 10 has it, and is measured",
        "detection: it does not leave the floor": "the whole loop of lesson 10 has it, and is measured",
    },
)
