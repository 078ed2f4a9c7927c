"""Pendulums, ropes and cloths once more, by other means: what the scenes of lesson 8 hold our steps against, and the engines' ropes.

Nothing here knows the functions of `solutions`.  A pendulum is an elliptic function.  A rope is a set of angles, so that its links
keep their length whatever is done; SciPy's DOP853 moves them.  A cloth is a set of springs: SciPy moves it, and finds where it rests.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import solve_banded
from scipy.sparse import block_diag, csr_matrix, identity, kron
from scipy.sparse.linalg import spsolve
from scipy.special import ellipj, ellipk

RTOL = 1e-12                 # of DOP853; a tenth of it absolute


# ---------------------------------------------------------------------------------------------- one link

def pendulum_angle(theta, L, g, t):
    """Angle [rad] from straight down of a pendulum let go at rest at θ₀, 0 < θ₀ < π:  sin ½θ = k cd(√(g/L) t),  k = sin ½θ₀.

    *Source:* Landau and Lifshitz, Mechanics, § 11.
    """
    k = np.sin(0.5 * theta)
    sn, cn, dn, _ = ellipj(np.sqrt(g / L) * t, k * k)
    return 2.0 * np.arcsin(k * cn / dn)


def pendulum_period(theta, L, g):
    """4 √(L/g) K(sin² ½θ₀) [s]."""
    return 4.0 * np.sqrt(L / g) * ellipk(np.sin(0.5 * theta) ** 2)


# ---------------------------------------------------------------------------------------------- many links

def tensions(theta, omega, l, m, g, late=0.0):
    """T (n,) [N] in the links of a rope of equal points, angles θ from straight down:  the relative acceleration along each link is −l ω².

    e_k·(a_k − a_{k−1}) = −l ω_k²:   T_{k−1} e_k·u_{k−1} − 2 T_k + T_{k+1} e_k·u_{k+1} = −m l ω_k²;   the first has one point and gravity:
    −T_1 + T_2 e_1·u_2 = −m (l ω_1² + g cos θ_1).     The tensions pull along u = e + late ω t, t across e; u = e for a real rope.
    *Source:* Newton's law for every point, with the links as unknowns.
    """
    n, apart = theta.size, np.diff(theta)
    bands = np.zeros((3, n))
    bands[0, 1:] = -np.cos(apart) + late * omega[1:] * np.sin(apart)
    bands[1] = 2.0
    bands[1, 0] = 1.0
    bands[2, :-1] = -np.cos(apart) - late * omega[:-1] * np.sin(apart)
    right = m * l * omega**2
    right[0] += m * g * np.cos(theta[0])
    return solve_banded((1, 1), bands, right)


def rope_slope(l, m, g, late=0.0):
    """(θ, ω)˙ of such a rope: θ̈ is the relative acceleration across each link, over l."""
    def slope(t, y):
        theta, omega = np.split(y, 2)
        T = tensions(theta, omega, l, m, g, late)
        apart, turned = np.diff(theta), late * omega
        across = -2.0 * T * turned                                       # t_k · (a_k − a_{k−1}) m
        across[0] = -T[0] * turned[0] - m * g * np.sin(theta[0])
        across[:-1] += T[1:] * (np.sin(apart) + turned[1:] * np.cos(apart))
        across[1:] += T[:-1] * (-np.sin(apart) + turned[:-1] * np.cos(apart))
        return np.concatenate((omega, across / (m * l)))
    return slope


def rods_slope(n, l, m, g, inertia):
    """The same where each point is a body that turns with the link above it, and has a moment of inertia [kg m²] about itself.

    Σ_j μ_max(k,j) l² (cos(θ_k − θ_j) θ̈_j + sin(θ_k − θ_j) ω_j²) + I θ̈_k + μ_k l g sin θ_k = 0,      μ_k: the mass from k on
    *Source:* Lagrange's equations.
    """
    below = m * (n - np.maximum.outer(np.arange(n), np.arange(n)))

    def slope(t, y):
        theta, omega = np.split(y, 2)
        apart = theta[:, None] - theta
        right = -l * l * (below * np.sin(apart)) @ omega**2 - np.diag(below) * l * g * np.sin(theta)
        return np.concatenate((omega, np.linalg.solve(l * l * below * np.cos(apart) + inertia * np.eye(n), right)))
    return slope


@cache
def rope_motion(n, l, m, g, T, inertia=0.0, late=0.0, ahead=0.0, rtol=RTOL):
    """solve_ivp's answer for (θ, ω) of a rope let go straight and horizontal along x, with the velocity of `ahead` seconds later."""
    slope = rods_slope(n, l, m, g, inertia) if inertia else rope_slope(l, m, g, late)
    start = np.concatenate((np.full(n, 0.5 * np.pi), np.zeros(n)))
    start[n:] = ahead * slope(0.0, start)[n:]
    return solve_ivp(slope, (0.0, T), start, method="DOP853", rtol=rtol, atol=0.1 * rtol, dense_output=True)


@cache
def rope_lag(n, l, m, g, T, inertia=0.0, late=0.0, ahead=0.0):
    """|∂x/∂dt| [m/s] of all points at T: how a first-order method errs, to first order in dt, when it differs from the truth by these.

    The projection method takes the links' forces at the end of each step,  xₙ₊₁ − 2xₙ + xₙ₋₁ = dt² (g + W Jᵀ(xₙ₊₁) λₙ₊₁).  Seen from
    the middle, tensions pull along e + dt ė (late = 1); and x₁ − x₀ = dt² a makes it begin with the velocity of ½dt (ahead = ½).
    The engines take the links' directions in the middle of that difference (late = 0).  pybullet begins as we do, ahead = ½;
    pymunk moves before it pulls, x₁ = x₀: ahead = −½.
    """
    h = 1e-4                 # [s]: a central difference, off by a relative (ρ h)², with DOP853's 1e-6 over h: 0.01 m/s
    ends = [rope_places(rope_motion(n, l, m, g, T, inertia, late * dt, ahead * dt, 1e-7).y[:n, -1], l) for dt in (h, -h)]
    return float(np.linalg.norm(ends[0] - ends[1]) / (2.0 * h))


def rope_places(theta, l):
    """(n, 2) [m] of the points of a rope that is held in the origin."""
    return l * np.cumsum(np.stack((np.sin(theta), -np.cos(theta)), axis=1), axis=0)


def rope_energy(y, l, m, g):
    """Energy [J] of (θ, ω)."""
    theta, omega = np.split(y, 2)
    v = l * np.cumsum(omega[:, None] * np.stack((np.cos(theta), np.sin(theta)), axis=1), axis=0)
    return 0.5 * m * np.sum(v * v) + m * g * np.sum(rope_places(theta, l)[:, 1])


@cache
def rope_rates(n, l, m, g, T):
    """(∫ρ dt, ∫ρ³ dt, greatest tension [N]) of a rope's own motion, ρ(t) its fastest rate [1/s] at the time.

    A link turns with ω_k, and under the tension T its ends swing about it with 2√(T/ml) at most:  ρ = max |ω_k| + 2√(max T/ml).
    """
    motion = rope_motion(n, l, m, g, T)
    ts = np.linspace(0.0, T, 401)
    states = motion.sol(ts).T
    pull = np.array([np.abs(tensions(*np.split(y, 2), l, m, g)).max() for y in states])
    rho = np.abs(states[:, n:]).max(axis=1) + 2.0 * np.sqrt(pull / (m * l))
    return tuple(float(np.trapezoid(rho**k, ts)) for k in (1, 3)) + (float(pull.max()),)


# ---------------------------------------------------------------------------------------------- a cloth

class Weave(NamedTuple):
    """Equal masses in a square, joined by springs along threads and both diagonals."""
    x: np.ndarray            # (n, 3) [m] flat, at natural length
    pairs: np.ndarray        # (s, 2)
    rest: np.ndarray         # (s,) [m]
    held: tuple              # numbers of the points that do not move
    m: float                 # [kg]
    k: float                 # [N/m]
    g: float                 # [m/s²], against z

    def matrix(self):
        """B (s, n), sparse: −1 at one end of each spring, +1 at the other; r = B x."""
        s = np.arange(len(self.pairs))
        return csr_matrix((np.repeat([-1.0, 1.0], len(s)), (np.tile(s, 2), self.pairs.T.ravel())), (len(s), len(self.x)))

    def free(self):
        return ~np.isin(np.arange(len(self.x)), self.held)


def weave(n, spacing, m, k, g):
    """n × n points in the plane y = 0 … −(n − 1) spacing, held at the two corners of y = 0; z is up."""
    r, c = np.divmod(np.arange(n * n), n)
    number = np.arange(n * n).reshape(n, n)
    pairs = np.concatenate([np.stack((a.ravel(), b.ravel()), axis=1) for a, b in (
        (number[:, :-1], number[:, 1:]), (number[:-1], number[1:]), (number[:-1, :-1], number[1:, 1:]), (number[:-1, 1:], number[1:, :-1]))])
    x = spacing * np.stack((c, -r, 0 * c), axis=1).astype(float)
    return Weave(x, pairs, np.linalg.norm(x[pairs[:, 1]] - x[pairs[:, 0]], axis=1), (0, n - 1), m, k, g)


def weave_motion(cloth, T, late=0.0, ahead=0.0, rtol=1e-8):
    """solve_ivp's answer for a cloth let go flat: ẍ = −g − Bᵀ(k (l − rest) n)/m, forces taken at x + late v; begins with ahead ẍ."""
    B, free = cloth.matrix(), cloth.free()[:, None]
    Bt = B.T.tocsr()

    def acceleration(x):
        r = B @ x
        length = np.sqrt(np.sum(r * r, axis=1, keepdims=True))
        a = -Bt @ (cloth.k / cloth.m * (1.0 - cloth.rest[:, None] / length) * r)
        a[:, 2] -= cloth.g
        return free * a

    def slope(t, y):
        x, v = y.reshape(2, *cloth.x.shape)
        return np.concatenate((v.ravel(), acceleration(x + late * v).ravel()))

    start = np.concatenate((cloth.x.ravel(), ahead * acceleration(cloth.x).ravel()))
    return solve_ivp(slope, (0.0, T), start, method="DOP853", rtol=rtol, atol=1e-4 * rtol, dense_output=True)


def weave_rest(cloth, begin):
    """x (n, 3) where a cloth rests: its energy is least there.  Newton's method on the energy, sparse, with as much of the identity added
    as makes the step lead downhill; begin (n, 3) chooses among the folds that it may hang in.

    U = Σ ½k (l − rest)² + Σ m g z;   ∂²U of a spring:  k n nᵀ + k (1 − rest/l)(1 − n nᵀ)
    """
    B, free = cloth.matrix(), np.flatnonzero(cloth.free())
    columns = (3 * free[:, None] + np.arange(3)).ravel()
    wide = kron(B, identity(3), format="csr")[:, columns]
    x, damping = begin.copy(), 1.0

    def energy(x):
        length = np.linalg.norm(B @ x, axis=1)
        return 0.5 * cloth.k * np.sum((length - cloth.rest) ** 2) + cloth.m * cloth.g * np.sum(x[free, 2])

    for _ in range(400):
        r = B @ x
        length = np.linalg.norm(r, axis=1)
        n = r / length[:, None]
        pull = wide.T @ (cloth.k * (length - cloth.rest)[:, None] * n).ravel() + np.tile([0.0, 0.0, cloth.m * cloth.g], len(free))
        if np.abs(pull).max() < 1e-13:
            break
        slack = cloth.k * (1.0 - cloth.rest / length)
        blocks = (cloth.k - slack)[:, None, None] * n[:, :, None] * n[:, None, :] + slack[:, None, None] * np.eye(3)
        H = wide.T @ block_diag(blocks, format="csr") @ wide
        while True:
            step = np.zeros_like(x)
            step[free] = spsolve((H + damping * identity(len(columns))).tocsc(), -pull).reshape(-1, 3)
            if np.abs(step).max() < 0.2 and energy(x + step) <= energy(x) + 1e-16:
                x, damping = x + step, 0.3 * damping
                break
            damping = 4.0 * damping + 1e-9
            if damping > 1e9:
                return x
    return x
