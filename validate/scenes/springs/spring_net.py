"""A square net, held along its upper edge, is released in a side wind: threads alone, then two stiffer nets.

The second case adds springs along the diagonals, the third also springs over every second node.
"""

import numpy as np

from solutions.integrators import advance
from solutions.springs import BEND, SHEAR, STRUCTURAL, grid_pairs
from solutions.springs import spring_network_acceleration as acceleration
from validate.engines.springs import net_in_space, net_links, net_points, observe_net, pymunk_net, start_net
from validate.methods import IMPLICIT_MESH, INTEGRATORS, LEFT_TO_FULL
from validate.reference.springs import (
    SquareNet,
    modes,
    motion,
    net_errors,
    net_limits,
    net_motion,
    rest_positions,
    square_net,
)
from validate.scene import PYMUNK, Engine, Scene

T = 0.6                      # [s]: two bounces, and half an oscillation of the threads alone
STEPS = (50, 100, 200, 500, 1000, 2000, 5000)
UNCERTAINTY = 1e-12


CASES = {"structural": SquareNet(), "with shear": SquareNet(shear=1), "with shear and bend": SquareNet(shear=1, bend=1)}


def run(step, acceleration, state, p, dt, steps):
    x, v, network = state
    x, v = advance(step, acceleration, 0.0, x, v, dt, steps, network)
    return x, v, network


def truth(p, t):
    """Every node, by DOP853 with separately coded forces, at a relative tolerance of 1e-13."""
    return net_motion(p, T)(t).ravel()


def tolerance(p, dt):
    """Each mode on its own, with a margin for large motion; pymunk is symplectic Euler, order 1."""
    limits = net_limits(square_net, p, np.linalg.norm(truth(p, T)), T, dt, UNCERTAINTY)
    return {**limits, "pymunk": limits[1]}


ENGINES = (
    Engine(PYMUNK, "", lambda p, dt: pymunk_net(square_net(p), dt, np.ravel), 1, "DampedSpring between point masses"),
)


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
        _, v, network = start_net(p)
        pull = np.abs(acceleration(0.0, rest, v, network)).max()
        claims.append((f"{name}: acceleration at the rest state of Newton's method [m/s²]", pull, 0.0, 1e-10))

        slowest = modes(square_net(p))[0][0]
        later = 35.0 / slowest
        settled = motion(square_net(p._replace(k_v=2.0 * p.m * slowest)), later)(later)
        apart = np.abs(settled - rest).max()
        claims.append((f"{name}: distance from there to the rest state of the damped net [m]", apart, 0.0, 1e-11))
    return tuple(claims)


SCENE = Scene(
    title="Spring net",
    link_look="spring",
    lesson="springs",
    cases=CASES,
    duration=T,
    steps=STEPS,
    methods=(*INTEGRATORS, IMPLICIT_MESH),
    acceleration=acceleration,
    start=start_net,
    run=run,
    observe=observe_net,
    truth=truth,
    truth_uncertainty=UNCERTAINTY,
    tolerance=tolerance,
    predicted_error=net_errors(square_net, T, truth, UNCERTAINTY),
    engines=ENGINES,
    slow_methods=LEFT_TO_FULL,          # of these the implicit ones build a dense matrix at every correction
    sanity_checks=sanity_checks,
    points=net_points,
    links=net_links,
    uses=("two coordinates", "springs with dampers", "one step function"),
    ablations={"the third dimension": net_in_space, "rotation": "the whole loop of lesson 10 has it, and is measured",
              "contact of the net with itself": "the whole loop of lesson 10 has it, and is measured"},
)
