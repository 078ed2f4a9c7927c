"""A chain of twenty springs between two nails is released in a side wind, from its rest shape without stretch."""

from functools import cache
from typing import Annotated, NamedTuple

import numpy as np
from scipy.optimize import brentq

from validate.check import states
from validate.reference.schemes import NEW_VELOCITY_OLD_FORCE
from validate.reference.springs import ReferenceNetwork, motion, net_limits, net_steps, rest_positions
from validate.scene import LATE_LEAPFROG, PYBULLET, Scene, engine
from validate.scenes.springs._common import DAMPED, net_fields, net_runners, net_world

T = 1.2                      # [s]: one period of the slowest mode, nearly two of the sagging mode
STEPS = (100, 200, 500, 1000, 2000, 5000, 10000)
UNCERTAINTY = 1e-11


class Params(NamedTuple):
    links: Annotated[int, "N [-], even, so that one point is in the middle"] = 20
    rest: Annotated[float, "length of a link [m]"] = 0.1
    span: Annotated[float, "between the nails [m]"] = 1.5
    m: Annotated[float, "each point between links [kg]"] = 0.02
    k: Annotated[float, "each link [N/m]: the outermost stretches by a fifth"] = 100.0
    k_d: Annotated[float, "damper [N s/m]"] = 0.02
    k_v: Annotated[float, "viscous drag [N s/m]"] = 0.0
    wind: Annotated[float, "sideways, on each point [N]: a tenth of its weight"] = 0.02
    g: Annotated[float, "gravity [m/s²]"] = 9.81


# without wind the slowest moving mode has ω = 8.74 rad/s: δ = k_v/2m = 8.5 /s leaves all of them oscillating, with
# equal decay
CASES = {"let go": Params(), "at rest": Params(k_d=0.0, k_v=0.34, wind=0.0)}


def rigid_chain(p):
    """Return (n, 2): the rest shape of a chain of rigid links; link s from a nail carries N/2 + ½ − s weights."""
    return hung(p, 0.0)[0]


def hung(p, compliance):
    """Return (x (n, 2), H): the chain at rest, with links of that compliance, and its horizontal pull H [N].

    V_s = (N + 1 − 2s)/2 · m g,   T_s = √(H² + V_s²),   link s spans (rest + compliance T_s) (H, −V_s)/T_s;   H from
    Σ = span.
    *Source:* equilibrium of each point; the one unknown is bracketed and found by Brent's method.
    """
    V = 0.5 * (p.links + 1 - 2.0 * np.arange(1, p.links + 1)) * p.m * p.g

    def links(H):
        tension = np.hypot(H, V)
        return (p.rest / tension + compliance)[:, None] * np.stack((np.full_like(V, H), -V), axis=1)

    weight = p.links * p.m * p.g
    H = brentq(lambda H: np.sum(links(H)[:, 0]) - p.span, 1e-6 * weight, 1e3 * weight, xtol=1e-15 * weight, rtol=1e-15)
    return np.concatenate((np.zeros((1, 2)), np.cumsum(links(H), axis=0))), H


def net(p):
    x, n = rigid_chain(p), np.arange(p.links + 1)
    pairs = np.stack((n[:-1], n[1:]), axis=1)
    rest, gravity, wind = np.full(p.links, p.rest), np.array([0.0, -p.g]), np.array([p.wind, 0.0])
    return ReferenceNetwork(x, 0.0 * x, (0, p.links), pairs, rest, p.m, p.k, p.k_d, p.k_v, gravity, wind)


def run(lessons, step, acceleration, state, p, dt, steps):
    x, v, network = state
    return *lessons.integrators.advance(step, acceleration, 0.0, x, v, dt, steps, network), network


@cache
def reference(p):
    return motion(net(p), T)


def truth(p, t):
    """Every point of the elastic chain, by DOP853 with separately coded forces, at a relative tolerance of 1e-13.

    Its rest state is the discrete catenary.  The sag is 0.5895021 m for inextensible links, and 0.5886677 m for the
    continuum.
    """
    return reference(p)(t).ravel()


limits = net_limits(net, T, truth, UNCERTAINTY)
MOTION = net_steps(net, T, truth, UNCERTAINTY)


RUNNERS = (
    *net_runners(net, MOTION, limits, in_quick=False),
    # forces come from the state before a step, then the new velocity moves the points
    engine(PYBULLET, "", net_world(net, PYBULLET),
           "useMaximalCoordinates=1, no damping; spring forces applied each step",
           order=1, limit=limits, predicted=MOTION.predict(NEW_VELOCITY_OLD_FORCE)),
    engine(PYBULLET, "leapfrog start", net_world(net, PYBULLET, ahead=0.5),
           f"the same, first velocities − ½ a dt; {DAMPED}", order=LATE_LEAPFROG, limit=lambda p, dt: limits(p, dt)[1],
           predicted=MOTION.predict(NEW_VELOCITY_OLD_FORCE, ahead=-0.5)),
)


def sanity_checks():
    """Return Findings: the numbers of the lecture."""
    p = CASES["at rest"]
    x, H = hung(p, 0.0)
    middle, weight = p.links // 2, p.m * p.g
    stiff = [-hung(p, 1.0 / k)[0][middle, 1] for k in (1e6, 2e6)]
    elastic = hung(p, 1.0 / p.k)[0]
    later = 4.0                                          # [s]: (1 + δt) e^(−δt) of a metre is left, 6e-14
    settled = motion(net(p), later)(later)
    by_newton = np.abs(rest_positions(net(p)) - elastic).max()
    return (
        states("sag of rigid links [m]", -x[middle, 1], 0.5895021, 5e-8),
        states("horizontal pull of rigid links [weights]", H / weight, 5.54718, 5e-6),
        states("sag as k → ∞, extrapolated from two stiffnesses [m]", 2.0 * stiff[1] - stiff[0], 0.5895021, 1e-7),
        states("elastic rest by Newton's method, from that by H [m]", by_newton, 0.0, 1e-12),
        states("rest position of the damped chain, from the same [m]", np.abs(settled - elastic).max(), 0.0, 1e-11),
    )


SCENE = Scene(
    title="Discrete catenary",
    **net_fields(net, ("links", "m", "k", "rest", "span"), "contact between links"),
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: lessons.springs.spring_network_acceleration, run=run,
    truth=truth, truth_uncertainty=UNCERTAINTY,
    sanity_checks=sanity_checks,
)
