"""A block under a force that swings to and fro, a little stronger than friction can hold: it slips twice in each swing, and sticks between."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from solutions.checks import check_positive
from solutions.friction import driven_acceleration as acceleration
from solutions.friction import make_block, slip_times
from solutions.integrators import advance
from validate.blocks import MASS, SWEEPS, bullet_block, pymunk_block
from validate.scene import EVENT, SLIDING, Engine, by_order

TITLE, LESSON = "Stick and slip", "friction"
T = 4.0                      # [s]: two slips
STEPS = (80, 160, 400, 800, 1600, 4000, 8000)
METHODS = (SLIDING, EVENT)
UNCERTAINTY = 1e-13


class Params(NamedTuple):
    force: float = 8.0       # amplitude [N], of F cos ωt
    omega: float = 1.0       # [rad/s]
    mu: float = 0.8          # friction [-]: holds 7.848 N
    m: float = 1.0           # mass [kg]
    g: float = 9.81          # gravity [m/s²]


CASES = {"F = 8 cos t": Params(), "F = 16 cos 2t, turns without a rest": Params(force=16.0, omega=2.0)}


def start(p):
    for name in ("g", "m", "omega"):
        check_positive(name, getattr(p, name))
    block = make_block((0.0, 1.0), p.mu, p.mu, (0.0, -p.g), (p.force / p.m, 0.0), p.omega)
    return np.zeros(2), np.zeros(2), block


def run(step, acceleration, state, p, dt, steps):
    x, v, block = state
    x, v = advance(step, acceleration, 0.0, x, v, dt, steps, block)
    return x, v, block


def observe(state, p):
    return state[0][:1]


@lru_cache(maxsize=None)
def slips(p):
    """((begin, end, sign, x at the beginning), …): the slips up to T [s], x [m]."""
    A, hold, w = p.force / p.m, p.mu * p.g, p.omega
    found, t, x = [], 0.0, 0.0
    while abs(A) > hold:
        turn = np.ceil(w * t / np.pi - 1e-12) * np.pi / w                    # the force is strongest where cos ωt = ±1
        if abs(A * np.cos(w * t)) <= hold:
            t = turn - np.arccos(hold / A) / w
        if t >= T:
            break
        sign = np.sign(A * np.cos(w * t))
        speed = lambda s: sign * A / w * (np.sin(w * s) - np.sin(w * t)) - hold * (s - t)
        s = t + np.linspace(0.0, 2.0 * np.pi / w, 1001)[1:]                  # after a whole swing only friction has done anything
        k = np.flatnonzero(speed(s) <= 0.0)[0]
        end = brentq(speed, s[k - 1], s[k], xtol=1e-15, rtol=1e-15)
        found.append((t, end, sign, x))
        x += travelled(p, found[-1], end)
        t = end
    return tuple(found)


def travelled(p, slip, t):
    """Way [m] since a slip began:  sign · ∫∫ (A |cos| − μg)."""
    begin, _, sign, _ = slip
    A, hold, w = p.force / p.m, p.mu * p.g, p.omega
    s = t - begin
    return A / w**2 * (np.cos(w * begin) - np.cos(w * t)) - A / w * np.sin(w * begin) * s - sign * 0.5 * hold * s * s


def truth(p, t):
    """x(t): during a slip from t₁,  ẍ = A cos ωt ∓ μg  integrated twice; constant between.

    A slip begins where |A cos ωt| = μg, and ends where  ± A/ω (sin ωt − sin ωt₁) = μg (t − t₁);  A = F/m.
    Source: Den Hartog 1931, forced vibrations with friction; the second equation solved by Brent's method.
    """
    x = 0.0
    for slip in slips(p):
        if t > slip[0]:
            x = slip[3] + travelled(p, slip, min(t, slip[1]))
    return np.array([x])


def tolerance(p, dt):
    """Friction and the force are smooth within a slip, and where it begins and ends at the limit of friction an event that is found
    late by dt costs dt² only.

    Order 1 takes the force of the beginning of each step for all of it: in a slip of s seconds in which A |cos ωt| changes by V its
    velocity goes wrong by ½ dt V.  Order 2, a midpoint step: by dt² Aω² s/24, and the way by dt² Aω s/6 besides.  The velocity at
    the end over the deceleration there is how late it stops; where the next slip begins in that moment, it is that late times its
    first acceleration too slow.  What adds up to dt² in order 1 is bounded by Aω dt² s each for the beginning, the end and the sum.
    The engines know the same forces at the same times; that pymunk moves with the old velocity costs nothing, since a slip begins
    and ends with none.
    """
    A, w, hold = p.force / p.m, p.omega, p.mu * p.g
    limits, size = by_order(0.0, T, dt), abs(truth(p, T)[0])
    first = second = 0.0
    late, before = np.zeros(2), -1.0                     # by how much the slip before ended late, in either order, and when
    for begin, end, sign, _ in slips(p):
        s, pull = min(end, T) - begin, sign * A * np.cos(w * np.linspace(begin, end, 101))
        fast = np.array([0.5 * dt * np.ptp(pull), dt * dt * A * w * w * s / 24.0])
        fast += (late if begin == before else 0.0) * (pull[0] - hold)
        late, before = fast / (hold - pull[-1]), end
        first += fast[0] * s + 3.0 * A * w * dt * dt * s
        second += fast[1] * s + dt * dt * A * w / 6.0 * s
    limits = {1: limits[1] + first / size, 2: limits[2] + second / size}
    return {**limits, "pymunk": limits[1], "pybullet": limits[1]}


def push(p, d):
    """t → force (d,) [N] on the engines' block, whose mass is their own."""
    still = (0.0,) * (d - 1)
    return lambda t: (MASS * p.force / p.m * float(np.cos(p.omega * t)), *still)


ENGINES = (
    Engine("pymunk", lambda p, dt: pymunk_block((0.0, -p.g), p.mu, 0.0, dt, lambda x: np.array([x.x]), push(p, 2)), 1,
           f"a slab of 2 m on a line, the force applied each step; {SWEEPS} iterations, collision_slop 1e-5"),
    Engine("pybullet", lambda p, dt: bullet_block((0.0, 0.0, -p.g), p.mu, (0.0, 0.0, 0.0), 0.1, dt, lambda x: np.array(x[:1]), push(p, 3)), 1,
           f"a slab of 2 m on a box, the force applied each step; maximal coordinates, solverResidualThreshold 0, {SWEEPS} iterations"),
)


def published():
    """((claim, found, expected, tolerance), …): the times of the slips, by truth and by our event steps."""
    p = CASES["F = 8 cos t"]
    times = np.array([[begin, end] for begin, end, _, _ in slips(p)])
    known = np.array([[0.0, 0.338608], [2.946347, 3.532835]])
    x, v, block = start(p)
    steps = 4000
    ours = slip_times(acceleration, 0.0, x, v, T / steps, steps, block)
    # v(t) at the end of a slip is wrong by dt² Aω² s/24, and falls there with more than μg − A |cos ωt| > 0.3 m/s²
    late = (T / steps) ** 2 * p.force * p.omega**2 * 0.6 / 24.0 / 0.3
    return (("times of the slips [s]", times, known, 5e-7), ("times of the slips, event steps of 1 ms [s]", ours, times, late + 1e-12),
            ("x after the first slip [m]", truth(p, 1.0)[0], 0.00434857, 5e-9), ("x after the second [m]", truth(p, T)[0], -0.00869717, 5e-9))


def points(observed, p):
    """The block, fifty times as far from its place, and the place."""
    return np.array([[0.0, 0.0], [50.0 * observed[0], 0.3]])


def LINKS(p):
    return [(0, 1)]


def in_space(p):
    """The same motion with a third coordinate carried along."""
    x, v, block = start(p)
    third = lambda y: np.append(y, 0.0)
    return (third(x), third(v), block._replace(n=third(block.n), gravity=third(block.gravity), push=third(block.push))), p


NEEDS = ("two coordinates", "a normal", "one step of a block that stays on its plane")
LEAVES_OUT = {"the third dimension": in_space, "rotation: it does not tip": "lesson 5 builds it", "detection: it does not leave the floor": "lesson 6 builds it"}
