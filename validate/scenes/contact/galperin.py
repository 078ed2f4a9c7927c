"""A wall, a block of 1 kg and a block of 100^N kg: the number of impacts is 3, 31, 314, 3141, the digits of π.

No block ever sticks, no energy is lost, and each impact is one impulse.  The answer is a whole number, so a single
missing or additional impact is visible.
"""

from fractions import Fraction
from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import check_not_negative, check_positive
from solutions.support.model import Body, make_model
from solutions.support.shapes import Ball
from validate.check import states
from validate.engines.bullet import IMPACT_SETTINGS
from validate.engines.switches import worlds_made
from validate.methods import ONE_BY_ONE, REFLECTION
from validate.scene import EXACT, PYBULLET, PYMUNK, Scene, engine, ours
from validate.scenes._common import ANSWER, one_reading
from validate.scenes.drawing import outlines

T = 1.0
LIGHT = 1.0                  # mass of the block next to the wall [kg]
FINEST = 2                   # digits after the first that an engine can count in reasonable time
R, ROOM = 1.0, 0.5           # radius of the engines' blocks, and the free distance between neighbours [m]
ITERATIONS = 50              # of the engines [-]
OVER = 8.0                   # time at which the heavy block is back at its start [s]


class Params(NamedTuple):
    N: Annotated[int, "the heavy block has 100^N kg"] = 2
    V: Annotated[float, "its speed towards the wall [m/s]"] = 1.0


CASES = {f"{100**N:,} kg": Params(N) for N in (2, 0, 1, 3)}


def countable(p):
    """Return whether N is at most two: an engine needs a hundred times as many steps for each further digit."""
    return p.N <= FINEST


def heavy(p):
    return 100.0**p.N


def start(p):
    """Return (number of impacts, velocities of the light and the heavy block)."""
    check_positive("V", p.V)
    check_not_negative("N", float(p.N))
    return 0, np.array([0.0, -p.V])


def run(lessons, step, acceleration, state, p, dt, steps):
    """Run one impact after the other while anything approaches: the two blocks, then the light one and the wall."""
    met, (v, V) = state
    m, M = LIGHT, heavy(p)
    while V < v or v < 0.0:
        if V < v:
            j = impulse(lessons, step, V - v, 1.0 / m + 1.0 / M)
            v, V = v - j / m, V + j / M
        else:
            v += impulse(lessons, step, v, 1.0 / m) / m
        met += 1
        if met > 10.0 * 4.0 * 10.0**p.N:                                 # with a wrong impulse the impacts never end
            break
    return met, np.array([v, V])


def impulse(lessons, step, u, k):
    """Return the elastic impulse, twice that which stops the approach; a sweep with relaxation 2 gives it, too."""
    if step is lessons.impulses.impulse_size:
        return step(u, k, 1.0)
    return step(np.array([[k]]), np.array([u]), np.zeros(1), 2.0)[0]


def seen(met, v, V, p):
    """Return the number of impacts, and velocities over the first: the light block's times √(m/M), the heavy one's."""
    return np.array([met, v * np.sqrt(LIGHT / heavy(p)) / p.V, V / p.V])


def observe(state, p):
    return seen(state[0], *state[1], p)


def truth(p, t):
    """There are ⌊10^N π⌋ impacts.  The point (√M V, √m v) stays on a circle, because energy is conserved.  An impact
    with the wall and an impact of the pair reflect it about two lines with the angle θ = arctan √(m/M) between
    them.  So two impacts rotate it by 2θ; after ⌈π/θ⌉ − 1 impacts nothing approaches.

    Source: Galperin 2003.
    """
    theta = np.arctan(np.sqrt(LIGHT / heavy(p)))
    impacts = np.floor(10.0**p.N * np.pi)
    turned = 2.0 * np.ceil(0.5 * impacts) * theta
    last = 1.0 if impacts % 2 == 0 else -1.0                             # the sign tells whether the wall was last
    return np.array([impacts, last * np.sin(turned), -np.cos(turned)])


def limit(p, dt):
    """One impact too many is 1/⌊10^N π⌋.  Each impact rounds velocities four times by 1.1e-16.  Relative to the number
    of impacts that is 4.4e-16.  θ is rounded in the truth, too.  Engines do the same operations if they detect every
    impact.
    """
    return 1e-15


# ---------------------------------------------------------------------------------------------- engines

def engine_step(p):
    """Return a step [s] in which the light block, at most 10^N V fast, moves by its free distance: about ROOM 10^−N."""
    return ROOM / (p.V * 100.0**p.N) / (1.0 if p.N else 10.0)


def count(advance, velocities, p):
    """Run an engine and count: the wall changes the total momentum, and the pair the heavy block's velocity."""
    dt, met = engine_step(p), 0
    v, V = velocities()
    for _ in range(round(OVER / p.V / dt)):
        advance()
        v_new, V_new = velocities()
        pair, wall = V_new - V, (v_new - v) + heavy(p) / LIGHT * (V_new - V)
        met += (abs(pair) > 1e-9 * p.V) + (abs(wall) > 1e-6 * p.V)
        v, V = v_new, V_new
        if v >= 0.0 and V >= v:
            break
    return seen(met, v, V, p)


PLACES = (0.0, 2.0 * R + ROOM, 4.0 * R + 2.0 * ROOM)                     # of wall, light and heavy [m]


def model(p):
    """Make the wall and both blocks as balls on a line."""
    return make_model([Body((x, 0.0), m, Ball(R), e=1.0, v=(v, 0.0)) for x, m, v in zip(
        PLACES, (np.inf, LIGHT, heavy(p)), (0.0, 0.0, -p.V))], (0.0, 0.0))


def counted(product, velocities):
    """Return make(p, dt) of an engine's runner; velocities(its own world) → () → (v, V): a State takes much longer."""
    def make(p, dt):
        with worlds_made() as made:
            world = product.world.build(model(p), engine_step(p), iterations=ITERATIONS)
        return one_reading(lambda: count(world.step, velocities(*made), p), world.close)
    return make


def in_pymunk(space):
    _, light, large = space.bodies
    return lambda: (light.velocity.x, large.velocity.x)


def in_pybullet(bullet):
    _, light, large = map(bullet.pb.getBodyUniqueId, range(3))
    return lambda: (bullet.velocity(light)[0], bullet.velocity(large)[0])


OURS = {"order": EXACT, "limit": limit, "predicted": "exact: only round-off is left, and the limit bounds it"}
ENGINES = {"order": EXACT, "limit": limit, "supports": countable,
           "predicted": "exact if it sees every impact: only round-off is left, and the limit bounds it"}
RUNNERS = (
    ours(ONE_BY_ONE, **OURS),
    ours(REFLECTION, **OURS),
    engine(PYMUNK, "", counted(PYMUNK, in_pymunk), "circles on a line, 50 iterations, collision_slop 1e-5", **ENGINES),
    engine(PYBULLET, "", counted(PYBULLET, in_pybullet),
           f"spheres on a line; {IMPACT_SETTINGS}, {ITERATIONS} iterations", **ENGINES),
)


def quantity_names(p):
    light, large = "end velocity of the light block, times √(m/M)/V [-]", "end velocity of the heavy block, over V [-]"
    return ["impacts [-]", light, large]


def exact_count(N):
    """Return the number of impacts by exact fractions."""
    m, M, v, V, met = Fraction(1), Fraction(100**N), Fraction(0), Fraction(-1), 0
    while V < v or v < 0:
        if V < v:
            v, V = ((m - M) * v + 2 * M * V) / (m + M), ((M - m) * V + 2 * m * v) / (m + M)
        else:
            v = -v
        met += 1
    return met


def sanity_checks():
    """Return Findings: the count in fractions, Galperin's angle, and the final energy."""
    cases = list(CASES.values())
    angles = [np.ceil(np.pi / np.arctan(10.0**-p.N)) - 1.0 for p in cases]
    ends = np.array([truth(p, T) for p in cases])
    return (states("impacts in exact fractions [-]", [exact_count(N) for N in (0, 1, 2)], (3, 31, 314), 0.0),
            states("⌈π/θ⌉ − 1 [-]", angles, ends[:, 0], 0.0),
            states("energy in the end over that before [-]", ends[:, 1] ** 2 + ends[:, 2] ** 2, 1.0, 1e-14))


# ---------------------------------------------------------------------------------------------- picture

def points(observed, p):
    """Draw the wall, and both blocks as squares, the heavy one larger."""
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    wall = np.array([(0.0, 0.0), (0.0, 1.5)])
    return np.concatenate((wall, np.array((0.6, 0.0)) + 0.3 * square, np.array((1.5, 0.0)) + square))


def links(p):
    return [(0, 1), *outlines(4, 2, 2)]


SCENE = Scene(
    title="Galperin's π", lesson="contact",
    cases=CASES, **ANSWER,
    runners=RUNNERS,
    start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-15,
    omitted_methods="engines go up to 10,000 kg: two of their circles pass through each other if one moves further "
                    "than a radius in a step, so that a million kg would need four million steps",
    quantity_names=quantity_names,
    published_states=((1.0, (314.0, 0.0017, 1.0), 1e-4),),
    sanity_checks=sanity_checks,
    points=points, links=links,
    uses=("one number for each velocity", "one impulse at a time"),
    full_loop="impacts are counted without places and times, so there is no loop",
    ablations={"time and place": "the next impact follows from the velocities alone",
               "restitution below 1": "the number of impacts then has nothing to do with π",
               "rotation": "impacts through the centres turn nothing"},
)
