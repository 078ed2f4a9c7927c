"""A block that sticks and slips under a periodic force: the reference solution, and the errors that theory allows."""

from functools import cache, partial
from typing import Annotated, NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from ..scene import EXACT, Prediction, by_order

T = 4.0                      # [s]: two slips
HALF = 1.0                   # half the length of the engines' slab [m]
SWEPT = 1e-9                 # what the engines' sweeps leave, relative
FEW_SWEPT = 1.0              # the same of 10 sweeps, over the length of a step [1/s]: see leapfrog_slip_limit
NOTHING_LEFT = "it is exact: only round-off is left, and the limit bounds it"


class DrivenBlock(NamedTuple):
    """A block on the floor under a periodic force."""
    force: Annotated[float, "amplitude [N], of F cos ωt"] = 8.0
    omega: Annotated[float, "[rad/s]"] = 1.0
    mu: Annotated[float, "friction [-]: holds 7.848 N"] = 0.8
    m: Annotated[float, "mass [kg]"] = 1.0
    g: Annotated[float, "gravity [m/s²]"] = 9.81


def block_in_space(x, v, block):
    """Return the same block with an unused third coordinate."""
    third = lambda y: np.append(y, 0.0)
    return third(x), third(v), block._replace(n=third(block.n), gravity=third(block.gravity), drive=third(block.drive))


@cache
def slips(p):
    """Return ((begin, end, sign, x at the beginning), …) of all slips up to T [s]; x [m]."""
    A, hold, w = p.force / p.m, p.mu * p.g, p.omega
    found, t, x = [], 0.0, 0.0
    while abs(A) > hold:
        turn = np.ceil(w * t / np.pi - 1e-12) * np.pi / w                    # the force is strongest where cos ωt = ±1
        if abs(A * np.cos(w * t)) <= hold:
            t = turn - np.arccos(hold / A) / w
        if t >= T:
            break
        sign = np.sign(A * np.cos(w * t))
        speed = lambda s, t=t, sign=sign: sign * A / w * (np.sin(w * s) - np.sin(w * t)) - hold * (s - t)
        # over a whole period the impulse of the force is zero, so friction has stopped the block
        s = t + np.linspace(0.0, 2.0 * np.pi / w, 1001)[1:]
        k = np.flatnonzero(speed(s) <= 0.0)[0]
        end = brentq(speed, s[k - 1], s[k], xtol=1e-15, rtol=1e-15)
        found.append((t, end, sign, x))
        x += travelled(p, found[-1], end)
        t = end
    return tuple(found)


def travelled(p, slip, t):
    """Return the distance [m] since the start of a slip:  sign · ∫∫ (A |cos| − μg)."""
    begin, _, sign, _ = slip
    A, hold, w = p.force / p.m, p.mu * p.g, p.omega
    s = t - begin
    return A / w**2 * (np.cos(w * begin) - np.cos(w * t)) - A / w * np.sin(w * begin) * s - sign * 0.5 * hold * s * s


def slip_position(p, t):
    """x(t): during a slip from t₁  ẍ = A cos ωt ∓ μg, integrated twice; constant between slips.

    A slip begins where |A cos ωt| = μg, and ends where  ± A/ω (sin ωt − sin ωt₁) = μg (t − t₁);  A = F/m.
    Source: Den Hartog 1931, forced vibrations with friction; the second equation solved by Brent's method.
    """
    x = 0.0
    for slip in slips(p):
        if t > slip[0]:
            x = slip[3] + travelled(p, slip, min(t, slip[1]))
    return np.array([x])


def slip_limits(p, dt):
    """Friction and the force are smooth within a slip, so an event that is detected late by dt costs only dt².

    A slip begins and ends at the limit of friction, so the error of late detection is of second order.

    Order 1 uses the force at the beginning of each step for all of it: in a slip of s seconds in which A |cos ωt|
    changes by V its velocity is wrong by ½ dt V.  In order 2, a midpoint step, the velocity is wrong by dt² Aω² s/24,
    and the distance by another dt² Aω s/6.  The velocity error at the end, divided by the deceleration there, is the
    delay of the stop.  If the next slip begins at that moment, it loses its first acceleration for the same time.  In
    order 1 the terms in dt² are bounded by Aω dt² s each for the beginning, the end and the sum.  The engines use
    the same forces at the same times.  pymunk moves with the old velocity.  This has no effect where the block rests
    between its slips, because a slip then begins and ends at rest.
    """
    A, w, hold = p.force / p.m, p.omega, p.mu * p.g
    limits, size = by_order(0.0, T, dt), abs(slip_position(p, T)[0])
    first = second = 0.0
    # delay of the end of the previous slip, in either order, and its time
    late = np.zeros(2)
    before = -1.0
    for begin, end, sign, _ in slips(p):
        s, pull = min(end, T) - begin, sign * A * np.cos(w * np.linspace(begin, end, 101))
        fast = np.array([0.5 * dt * np.ptp(pull), dt * dt * A * w * w * s / 24.0])
        fast += (late if begin == before else 0.0) * (pull[0] - hold)
        late, before = fast / (hold - pull[-1]), end
        first += fast[0] * s + 3.0 * A * w * dt * dt * s
        second += fast[1] * s + dt * dt * A * w / 6.0 * s
    return {1: limits[1] + first / size, 2: limits[2] + second / size}


def carried_limit(p, dt):
    """pybullet has no limit if the slab moves by more than half its length in a step, because it then loses it."""
    return slip_limits(p, dt)[1] if carried_along(p, dt) else np.inf


def acceleration_at_first(p):
    """Return the acceleration [m/s²] at the start, where the force is strongest, less friction."""
    return max(p.force / p.m - p.mu * p.g, 0.0)


@cache
def pushed_in_steps(p, steps, new, lag=0.0):
    """Return x at T and the largest speed of a block if the force at the beginning of each step acts for all of it.

    It moves with one velocity per step.  Friction removes at most μg dt of the velocity, and at most all of it.
    lag: of the first velocity, in steps; ½ makes leapfrog
    """
    dt, x, fastest = T / steps, 0.0, 0.0
    v = -lag * dt * acceleration_at_first(p)
    for n in range(steps):
        old, v = v, v + dt * p.force / p.m * np.cos(p.omega * n * dt)
        v -= np.sign(v) * min(abs(v), p.mu * p.g * dt)
        x += dt * (v if new else old)
        fastest = max(fastest, abs(v))
    return x, fastest


def carried_along(p, dt):
    """Return whether pybullet's slab keeps its four contact points: it moves by less than half its length per step.

    pybullet matches the points of the last step by the nearest place on the floor.  The points are one length apart.
    Beyond half a length it may take a front point for a rear one, and the slab tips.
    """
    steps = round(T / dt)
    return pushed_in_steps(p, steps, True)[1] * dt < HALF


def slip_error(p, dt, new=True, left=0.0):
    """The prediction is the same rule in plain numbers, with the force from the beginning of each step.

    Our sliding step and pybullet move with the new velocity, pymunk with the old one.  The engines' sweeps leave 1e-9.
    """
    error = np.array([pushed_in_steps(p, round(T / dt), new)[0]]) - slip_position(p, T)
    return Prediction(error, by_order(0.0, T, dt)[EXACT] + left)


old_velocity_slip_error = partial(slip_error, new=False, left=SWEPT)


def carried_slip_error(p, dt):
    """pybullet's error is not predicted where it loses the slab."""
    return slip_error(p, dt, left=SWEPT) if carried_along(p, dt) else None


def leapfrog_slip_limit(p, dt):
    """With a leapfrog start the force of a step is that of its middle, as in a midpoint step.  A slip that begins or
    ends between two steps adds the same order: its first and its last force change by Aω dt at most.  What ten sweeps
    leave was measured: half of this limit's share, on runs of 160 to 1,600 steps.
    """
    return slip_limits(p, dt)[2] + FEW_SWEPT * dt if carried_along(p, dt) else np.inf


def leapfrog_slip_error(p, dt):
    """The same rule with a first velocity that is half a step old, and the measured share that ten sweeps leave."""
    if not carried_along(p, dt):
        return None
    found = slip_error(p, dt, left=FEW_SWEPT * dt)
    return found._replace(error=np.array([pushed_in_steps(p, round(T / dt), True, 0.5)[0]]) - slip_position(p, T))


# ---------------------------------------------------------------------------------------------- MuJoCo's contact

HOPS = 4                     # runs whose starts differ slightly, to measure how far hops separate them
APART = 1e-9                 # of two such starts [m]
CLOSE = 1e-6                 # relative error of a run without hops: the solver leaves 1e-9 per step


class SoftBlock(NamedTuple):
    """A block of mass 1 on MuJoCo's contact, whose forces (N, F) are the smallest in the cone |F| ≤ μN, in the sense of

        ½ fᵀ(1 + ρ) f + fᵀ c,    c = (−g_n + b v_n + k r, g_t + b v_t),    ρ = (1 − d)/d,  b = 2/(d τ),  k = 1/(d τ²)

    r: gap [m], negative inside;    d: impedance, τ: time constant [s], at least twice the step.
    *Source:* the documentation of MuJoCo, chapter Computation; Todorov 2014.
    """
    g_t: float               # gravity along the plane [m/s²]
    g_n: float               # and into it
    mu: float
    d: float
    tau: float

    def numbers(self):
        """Return (ρ, b [1/s], k [1/s²])."""
        return (1.0 - self.d) / self.d, 2.0 / (self.d * self.tau), 1.0 / (self.d * self.tau**2)

    def force(self, r, v_n, v_t):
        """Return (N, F) [N] in contact: inside the cone, on its surface, or zero."""
        rho, b, k = self.numbers()
        normal, along = -self.g_n + b * v_n + k * r, self.g_t + b * v_t
        N, F = -normal / (1.0 + rho), -along / (1.0 + rho)
        if N >= 0.0 and abs(F) <= self.mu * N:
            return N, F
        N = max(0.0, (self.mu * abs(along) - normal) / ((1.0 + rho) * (1.0 + self.mu**2)))
        return N, -self.mu * N if along > 0.0 else self.mu * N

    def creep(self):
        """Return the speed [m/s] of a block that friction holds: b v = ρ g_t, as this friction vanishes at rest."""
        rho, b, _ = self.numbers()
        return rho * self.g_t / b

    def steps(self, v, dt, count, r=0.0):
        """Return the displacement [m] after this number of semi-implicit Euler steps.

        Above the plane there is no contact.
        """
        way, v_n, law = 0.0, 0.0, self._replace(tau=max(self.tau, 2.0 * dt))
        for _ in range(count):
            N, F = law.force(r, v_n, v) if r < 0.0 else (0.0, 0.0)
            v_n, v = v_n + dt * (N - self.g_n), v + dt * (self.g_t + F)
            way, r = way + dt * v, r + dt * v_n
        return way

    def hopping(self, v, dt, count):
        """Return (mean, half range) of the displacement of runs whose starts differ slightly.

        A fast block is lifted out of its contact, falls back, and is lifted again.  Every impulse is on the surface
        of the cone.  Hence  v_t + μ v_n  is exact, and a hop changes the end by μ times its height.
        """
        ways = [self.steps(v, dt, count, -APART * (n + 1.0)) for n in range(HOPS)]
        return 0.5 * (max(ways) + min(ways)), 0.5 * (max(ways) - min(ways))

    def arrest(self, v, t):
        """Return the displacement [m] at t of a block that is thrown up and held, for dt → 0.

        Coulomb's law holds as long as the block hops on its contact.  Then the contact's own equations hold, which
        end in the creep.
        """
        rho, b, _ = self.numbers()
        left = self.g_n * ((1.0 + rho) * (1.0 + self.mu**2) - 1.0) / self.mu           # here N is the weight
        end, brake = -(left + self.g_t) / b, self.g_t + self.mu * self.g_n
        begin = max(0.0, (end - v) / brake)
        if t <= begin:
            return v * t + 0.5 * brake * t * t

        def slope(_, y):
            N, F = self.force(*y[1:])
            return y[3], y[2], N - self.g_n, self.g_t + F
        start = (v * begin + 0.5 * brake * begin * begin, 0.0, 0.0, v + brake * begin)
        return float(solve_ivp(slope, (begin, t), start, method="DOP853", rtol=1e-10, atol=1e-13).y[0, -1])
