"""A square net, held along its upper edge, is released in a side wind: threads alone, then two stiffer nets.

The second case adds springs along the diagonals, the third also springs over every second node.
"""

from functools import cache

import numpy as np

from solutions.checks import check_positive
from solutions.integrators import advance
from solutions.springs import BEND, SHEAR, STRUCTURAL, grid_pairs, make_spring_network
from solutions.springs import spring_network_acceleration as acceleration
from validate.engines.springs import pymunk_net
from validate.methods import IMPLICIT_MESH, INTEGRATORS, LEFT_TO_FULL
from validate.reference.springs import SquareNet, modes, motion, net_limits, rest_positions, square_net, state_of
from validate.scene import PYMUNK, Engine, Scene

T = 0.6                      # [s]: two bounces, and half an oscillation of the threads alone
STEPS = (50, 100, 200, 500, 1000, 2000, 5000)
UNCERTAINTY = 1e-12


CASES = {"structural": SquareNet(), "with shear": SquareNet(shear=1), "with shear and bend": SquareNet(shear=1, bend=1)}


def start(p):
    for name in ("n", "spacing", "m", "k"):
        check_positive(name, getattr(p, name))
    return state_of(square_net(p), make_spring_network)


def run(step, acceleration, state, p, dt, steps):
    x, v, network = state
    x, v = advance(step, acceleration, 0.0, x, v, dt, steps, network)
    return x, v, network


def observe(state, p):
    return state[0][:, :2].ravel()


@cache
def reference(p):
    return motion(square_net(p), T)


def truth(p, t):
    """Every node, by DOP853 with separately coded forces, at a relative tolerance of 1e-13."""
    return reference(p)(t).ravel()


def tolerance(p, dt):
    """Each mode on its own, with a margin for large motion; pymunk is symplectic Euler, order 1."""
    limits = net_limits(square_net, p, np.linalg.norm(truth(p, T)), T, dt, UNCERTAINTY)
    return {**limits, "pymunk": limits[1]}


ENGINES = (
    Engine(PYMUNK, "", lambda p, dt: pymunk_net(square_net(p), dt, np.ravel), 1, "DampedSpring between point masses"),
)


def points(observed, p):
    return observed.reshape(-1, 2)


def links(p):
    return square_net(p).pairs.tolist()


def sanity_checks():
    """Return ((claim, found, expected, tolerance), …): conditions on the springs and on the rest state.

    With viscosity 2 m ω, critical for the slowest mode, every mode decays like (1 + ωt) e^(−ωt): at ωt = 35 that is
    2e-14.
    """
    claims = []
    for name, p in CASES.items():
        offsets = STRUCTURAL + SHEAR * p.shear + BEND * p.bend
        ours = {tuple(sorted(pair)) for pair in grid_pairs(p.n, p.n, offsets).tolist()}
        lattice = set(map(tuple, square_net(p).pairs.tolist()))
        claims.append((f"{name}: springs on which grid and lattice differ", len(ours ^ lattice), 0, 0))

        rest = rest_positions(square_net(p))
        _, v, network = start(p)
        pull = np.abs(acceleration(0.0, rest, v, network)).max()
        claims.append((f"{name}: acceleration at the rest state of Newton's method [m/s²]", pull, 0.0, 1e-10))

        slowest = modes(square_net(p))[0][0]
        later = 35.0 / slowest
        settled = motion(square_net(p._replace(k_v=2.0 * p.m * slowest)), later)(later)
        apart = np.abs(settled - rest).max()
        claims.append((f"{name}: distance from there to the rest state of the damped net [m]", apart, 0.0, 1e-11))
    return tuple(claims)


def in_space(p):
    """The same motion with an unused third coordinate."""
    return state_of(square_net(p).padded(), make_spring_network), p


SCENE = Scene(
    title="Spring net",
    link_look="spring",
    lesson="springs",
    cases=CASES,
    duration=T,
    steps=STEPS,
    methods=(*INTEGRATORS, IMPLICIT_MESH),
    acceleration=acceleration,
    start=start,
    run=run,
    observe=observe,
    truth=truth,
    truth_uncertainty=UNCERTAINTY,
    tolerance=tolerance,
    engines=ENGINES,
    slow_methods=LEFT_TO_FULL,          # of these the implicit ones build a dense matrix at every correction
    sanity_checks=sanity_checks,
    points=points,
    links=links,
    uses=("two coordinates", "springs with dampers", "one step function"),
    ablations={"the third dimension": in_space, "rotation": "lesson 5 builds it",
              "contact of the net with itself": "lesson 6 builds it"},
)
