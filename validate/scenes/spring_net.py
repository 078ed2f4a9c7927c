"""A square net, held along its upper edge and let go in a side wind: threads alone, then diagonals, then every second node."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from solutions.checks import check_positive
from solutions.integrators import advance
from solutions.springs import BEND, SHEAR, STRUCTURAL, grid_pairs
from solutions.springs import mesh_acceleration as acceleration
from validate.reference import Net, modes, motion, net_limits, pymunk_net, rest_positions, state_of
from validate.scene import IMPLICIT_MESH, INTEGRATORS, LEFT_TO_FULL, Engine

TITLE, LESSON = "Spring net", "springs"
T = 0.6                      # [s]: two bounces, and half a swing of the threads alone
STEPS = (50, 100, 200, 500, 1000, 2000, 5000)
METHODS = INTEGRATORS + (IMPLICIT_MESH,)
FULL_ONLY = LEFT_TO_FULL     # of these the implicit ones build a dense matrix at every correction
UNCERTAINTY = 1e-12


class Params(NamedTuple):
    n: int = 5               # nodes along each side [-]
    spacing: float = 0.1     # of the nodes [m]
    shear: int = 0           # 1: springs along both diagonals of each mesh, too
    bend: int = 0            # 1: springs over the next node, too
    m: float = 0.05          # each node [kg]
    k: float = 200.0         # each spring [N/m]: the uppermost stretch by a tenth
    k_d: float = 0.1         # its damper [N s/m]
    k_v: float = 0.0         # viscosity on each node [N s/m]
    wind: float = 0.05       # sideways, on each node [N]: a tenth of its weight
    g: float = 9.81          # gravity [m/s²]


CASES = {"structural": Params(), "with shear": Params(shear=1), "with shear and bend": Params(shear=1, bend=1)}


def net(p):
    """Node (r, c) is number r n + c; nodes are joined whose squared distance on the lattice is 1, 2 (shear) or 4 (bend)."""
    r, c = np.divmod(np.arange(p.n * p.n), p.n)
    squared = (r[:, None] - r) ** 2 + (c[:, None] - c) ** 2
    pairs = np.argwhere(np.triu((squared == 1) | (squared == 2) & bool(p.shear) | (squared == 4) & bool(p.bend)))
    rest = p.spacing * np.sqrt(squared[pairs[:, 0], pairs[:, 1]])
    x = p.spacing * np.stack((c, -r), axis=1)
    return Net(x, 0.0 * x, tuple(range(p.n)), pairs, rest, p.m, p.k, p.k_d, p.k_v, np.array([0.0, -p.g]), np.array([p.wind, 0.0]))


def start(p):
    for name in ("n", "spacing", "m", "k"):
        check_positive(name, getattr(p, name))
    return state_of(net(p))


def run(step, acceleration, state, p, dt, steps):
    x, v, mesh = state
    x, v = advance(step, acceleration, 0.0, x, v, dt, steps, mesh)
    return x, v, mesh


def observe(state, p):
    return state[0][:, :2].ravel()


@lru_cache(maxsize=None)
def reference(p):
    return motion(net(p), T)


def truth(p, t):
    """Every node, by DOP853 with forces of its own, at a relative tolerance of 1e-13."""
    return reference(p)(t).ravel()


def tolerance(p, dt):
    """Each mode on its own, with the room that large motion needs (net_limits); pymunk is symplectic Euler, order 1."""
    limits = net_limits(net, p, np.linalg.norm(truth(p, T)), T, dt, UNCERTAINTY)
    return {**limits, "pymunk": limits[1]}


ENGINES = (Engine("pymunk", lambda p, dt: pymunk_net(net(p), dt, np.ravel), 1, "DampedSpring between point masses"),)


def points(observed, p):
    return observed.reshape(-1, 2)


def LINKS(p):
    return net(p).pairs.tolist()


def published():
    """((claim, found, expected, tolerance), …): what must hold of the springs and at rest, for a test to assert.

    With viscosity 2 m ω, critical for the slowest mode, every mode dies like (1 + ωt) e^(−ωt): at ωt = 35 that is 2e-14.
    """
    claims = []
    for name, p in CASES.items():
        offsets = STRUCTURAL + SHEAR * p.shear + BEND * p.bend
        ours = {tuple(sorted(pair)) for pair in grid_pairs(p.n, p.n, offsets).tolist()}
        lattice = set(map(tuple, net(p).pairs.tolist()))
        claims.append((f"{name}: springs on which grid and lattice differ", len(ours ^ lattice), 0, 0))

        rest, (x, v, mesh) = rest_positions(net(p)), start(p)
        pull = np.abs(acceleration(0.0, rest, v, mesh)).max()
        claims.append((f"{name}: acceleration where Newton's method finds rest [m/s²]", pull, 0.0, 1e-10))

        slowest = modes(net(p))[0][0]
        later = 35.0 / slowest
        settled = motion(net(p._replace(k_v=2.0 * p.m * slowest)), later)(later)
        claims.append((f"{name}: from there to where the damped net settles [m]", np.abs(settled - rest).max(), 0.0, 1e-11))
    return tuple(claims)


def in_space(p):
    """The same motion with a third coordinate carried along."""
    return state_of(net(p).padded()), p


NEEDS = ("two coordinates", "springs with dampers", "one step function")
LEAVES_OUT = {"the third dimension": in_space, "rotation": "lesson 5 builds it",
              "contact of the net with itself": "lesson 6 builds it"}
