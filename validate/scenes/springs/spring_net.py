"""A square net, held along its upper edge, is released in a side wind: threads alone, then two stiffer nets.

The second case adds springs along the diagonals, the third also springs over every second node.
"""

import numpy as np

from validate.check import states
from validate.reference.springs import (
    SquareNet,
    modes,
    motion,
    net_limits,
    net_steps,
    net_truth,
    rest_positions,
    square_net,
)
from validate.scene import Scene
from validate.scenes.springs._common import SQUARE, net_fields, net_runners

T = 0.6                      # [s]: two bounces, and half an oscillation of the threads alone
STEPS = (50, 100, 200, 500, 1000, 2000, 5000)
UNCERTAINTY = 1e-12
CASES = {"structural": SquareNet(), "with shear": SquareNet(shear=1), "with shear and bend": SquareNet(shear=1, bend=1)}


def run(lessons, step, acceleration, state, p, dt, steps):
    x, v, network = state
    return *lessons.integrators.advance(step, acceleration, 0.0, x, v, dt, steps, network), network


truth = net_truth(T)
RUNNERS = net_runners(
    square_net, net_steps(square_net, T, truth, UNCERTAINTY), net_limits(square_net, T, truth, UNCERTAINTY),
    slow_cases=tuple(CASES)[1:], most_in_quick=200)


def sanity_checks():
    """Return Findings: a condition on the rest state.

    With viscosity 2 m ω, critical for the slowest mode, every mode decays like (1 + ωt) e^(−ωt): at ωt = 35 that is
    2e-14.
    """
    claims = []
    for name, p in CASES.items():
        rest = rest_positions(square_net(p))
        slowest = modes(square_net(p))[0][0]
        later = 35.0 / slowest
        settled = motion(square_net(p._replace(k_v=2.0 * p.m * slowest)), later)(later)
        apart = np.abs(settled - rest).max()
        claims.append(states(f"{name}: distance from there to the rest state of the damped net [m]", apart, 0.0, 1e-11))
    return tuple(claims)


SCENE = Scene(
    title="Spring net",
    **net_fields(square_net, SQUARE),
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: lessons.springs.spring_network_acceleration, run=run,
    truth=truth, truth_uncertainty=UNCERTAINTY,
    sanity_checks=sanity_checks,
)
