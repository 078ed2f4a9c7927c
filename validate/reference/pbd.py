"""Reference solutions for the pendulums, ropes and cloths of lesson 8, and for the engines' ropes.

Nothing here uses the functions of `solutions`.  A pendulum is an elliptic function.  A rope is a set of angles, so its
links keep their length exactly, and SciPy's DOP853 integrates them.  A cloth is a set of springs; SciPy integrates it
and finds its rest state.
"""

from collections.abc import Callable
from functools import cache, partial
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import solve_banded
from scipy.sparse import bsr_matrix, csr_matrix, identity, kron
from scipy.sparse.linalg import spsolve
from scipy.special import ellipj, ellipk

from .schemes import ErrorLaw

RTOL = 1e-12                 # of DOP853; the absolute tolerance is a tenth of it


# ---------------------------------------------------------------------------------------------- one link

def pendulum_angle(theta, L, g, t):
    """Return the angle [rad] from straight down of a pendulum released at rest at θ₀, 0 < θ₀ < π.

    sin ½θ = k cd(√(g/L) t),  k = sin ½θ₀.
    *Source:* Landau and Lifshitz, Mechanics, § 11.
    """
    k = np.sin(0.5 * theta)
    _, cn, dn, _ = ellipj(np.sqrt(g / L) * t, k * k)
    return 2.0 * np.arcsin(k * cn / dn)


def pendulum_period(theta, L, g):
    """Return the period 4 √(L/g) K(sin² ½θ₀) [s]."""
    return 4.0 * np.sqrt(L / g) * ellipk(np.sin(0.5 * theta) ** 2)


# ---------------------------------------------------------------------------------------------- many links

def tensions(theta, omega, l, m, g, late=0.0):
    """Return the tensions T (n,) [N] in the links of a rope of equal points with the angles θ from straight down.

    The relative acceleration along each link is −l ω²,  e_k·(a_k − a_{k−1}) = −l ω_k²:
        T_{k−1} e_k·u_{k−1} − 2 T_k + T_{k+1} e_k·u_{k+1} = −m l ω_k²
    The first link has one point, and gravity:  −T_1 + T_2 e_1·u_2 = −m (l ω_1² + g cos θ_1).
    The tensions pull along u = e + late ω t, t normal to e; a real rope has u = e.
    *Source:* Newton's law for every point, with the tensions as unknowns.
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
    """Return (θ, ω)˙ of such a rope: θ̈ is the relative acceleration normal to each link, over l."""
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
    """Return the same if each point is a body with a moment of inertia [kg m²] that rotates with the link above it.

        Σ_j μ_max(k,j) l² (cos(θ_k − θ_j) θ̈_j + sin(θ_k − θ_j) ω_j²) + I θ̈_k + μ_k l g sin θ_k = 0
    μ_k is the mass from k on.
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
    """Solve for (θ, ω) of a rope released horizontally along x, with the velocity that it has `ahead` seconds later."""
    slope = rods_slope(n, l, m, g, inertia) if inertia else rope_slope(l, m, g, late)
    start = np.concatenate((np.full(n, 0.5 * np.pi), np.zeros(n)))
    start[n:] = ahead * slope(0.0, start)[n:]
    return solve_ivp(slope, (0.0, T), start, method="DOP853", rtol=rtol, atol=0.1 * rtol, dense_output=True)


@cache
def rope_lag(n, l, m, g, T, late=0.0, ahead=0.0):
    """Return |∂x/∂dt| [m/s] of all points at T: the error of a first-order method to first order in dt.

    The projection method takes the links' forces at the end of each step,
        xₙ₊₁ − 2xₙ + xₙ₋₁ = dt² (g + W Jᵀ(xₙ₊₁) λₙ₊₁).
    Relative to the middle, tensions pull along e + dt ė (late = 1).  Its start, x₁ − x₀ = dt² a, is that of the
    velocity ½dt later (ahead = ½).  pymunk takes the links' directions in the middle of that difference (late = 0)
    and moves before it pulls, x₁ = x₀: ahead = −½.
    """
    # [s]: a central difference, off by a relative (ρ h)², with DOP853's 1e-6 over h: 0.01 m/s
    h = 1e-4
    motion = lambda dt: rope_motion(n, l, m, g, T, 0.0, late * dt, ahead * dt, 1e-7)
    ends = [rope_places(motion(dt).y[:n, -1], l) for dt in (h, -h)]
    return float(np.linalg.norm(ends[0] - ends[1]) / (2.0 * h))


def rope_places(theta, l):
    """Return the points (n, 2) [m] of a rope that is held in the origin."""
    return l * np.cumsum(np.stack((np.sin(theta), -np.cos(theta)), axis=1), axis=0)


def rope_energy(y, l, m, g):
    """Return the energy [J] of (θ, ω)."""
    theta, omega = np.split(y, 2)
    v = l * np.cumsum(omega[:, None] * np.stack((np.cos(theta), np.sin(theta)), axis=1), axis=0)
    return 0.5 * m * np.sum(v * v) + m * g * np.sum(rope_places(theta, l)[:, 1])


@cache
def rope_rates(n, l, m, g, T):
    """Return (∫ρ dt, ∫ρ³ dt, ∫ρ⁵ dt, largest tension [N]) of a rope's own motion; ρ(t) is its fastest rate [1/s].

    A link turns with ω_k, and under the tension T its ends oscillate about it with at most 2√(T/ml):
    ρ = max |ω_k| + 2√(max T/ml).
    """
    motion = rope_motion(n, l, m, g, T)
    ts = np.linspace(0.0, T, 401)
    states = motion.sol(ts).T
    pull = np.array([np.abs(tensions(*np.split(y, 2), l, m, g)).max() for y in states])
    rho = np.abs(states[:, n:]).max(axis=1) + 2.0 * np.sqrt(pull / (m * l))
    return (*(float(np.trapezoid(rho**k, ts)) for k in (1, 3, 5)), float(pull.max()))


# ---------------------------------------------------------------------------------------------- a cloth

class ClothReference(NamedTuple):
    """Equal masses in a square grid, joined by springs along threads and both diagonals."""
    x: np.ndarray            # (n, 3) [m] flat, at natural length
    pairs: np.ndarray        # (s, 2)
    rest: np.ndarray         # (s,) [m]
    held: tuple              # numbers of the fixed points
    m: float                 # [kg]
    k: float                 # [N/m]
    g: float                 # [m/s²], against z

    def matrix(self):
        """Return B (s, n), sparse: −1 at one end of each spring, +1 at the other; r = B x."""
        s = np.arange(len(self.pairs))
        entries = (np.repeat([-1.0, 1.0], len(s)), (np.tile(s, 2), self.pairs.T.ravel()))
        return csr_matrix(entries, (len(s), len(self.x)))

    def free(self):
        return ~np.isin(np.arange(len(self.x)), self.held)


def weave(n, spacing, m, k, g):
    """Return n × n points in the plane y = 0 … −(n − 1) spacing, held at the two corners with y = 0; z is up."""
    r, c = np.divmod(np.arange(n * n), n)
    number = np.arange(n * n).reshape(n, n)
    ends = (
        (number[:, :-1], number[:, 1:]),
        (number[:-1], number[1:]),
        (number[:-1, :-1], number[1:, 1:]),
        (number[:-1, 1:], number[1:, :-1]),
    )
    pairs = np.concatenate([np.stack((a.ravel(), b.ravel()), axis=1) for a, b in ends])
    x = spacing * np.stack((c, -r, 0 * c), axis=1).astype(float)
    return ClothReference(x, pairs, np.linalg.norm(x[pairs[:, 1]] - x[pairs[:, 0]], axis=1), (0, n - 1), m, k, g)


def weave_motion(cloth, T, late=0.0, ahead=0.0, rtol=1e-8):
    """Solve for a cloth released flat: ẍ = −g − Bᵀ(k (l − rest) n)/m, forces at x + late v, first velocity ahead ẍ."""
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
    """Return x (n, 3), the rest state of a cloth: the minimum of its energy, by a sparse Newton method.

    As much of the identity is added to the Hessian as is needed for a descent direction.  `begin` (n, 3) selects one of
    the folded states in which the cloth can hang.

    U = Σ ½k (l − rest)² + Σ m g z;   ∂²U of a spring:  k n nᵀ + k (1 − rest/l)(1 − n nᵀ)
    """
    B, free = cloth.matrix(), np.flatnonzero(cloth.free())
    columns = (3 * free[:, None] + np.arange(3)).ravel()
    wide, springs = kron(B, identity(3), format="csr")[:, columns], np.arange(len(cloth.pairs))
    x, damping = begin.copy(), 1.0

    def energy(x):
        length = np.linalg.norm(B @ x, axis=1)
        return 0.5 * cloth.k * np.sum((length - cloth.rest) ** 2) + cloth.m * cloth.g * np.sum(x[free, 2])

    for _ in range(400):
        r = B @ x
        length = np.linalg.norm(r, axis=1)
        n = r / length[:, None]
        weights = np.tile([0.0, 0.0, cloth.m * cloth.g], len(free))
        pull = wide.T @ (cloth.k * (length - cloth.rest)[:, None] * n).ravel() + weights
        if np.abs(pull).max() < 1e-13:
            break
        slack = cloth.k * (1.0 - cloth.rest / length)
        blocks = (cloth.k - slack)[:, None, None] * n[:, :, None] * n[:, None, :] + slack[:, None, None] * np.eye(3)
        H = wide.T @ bsr_matrix((blocks, springs, np.arange(len(springs) + 1))) @ wide
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


# ---------------------------------------------------------------------- predicted errors

class Rope(NamedTuple):
    """Points joined by rigid links, the first one fixed."""
    x: np.ndarray            # (N + 1, 2) at rest [m]
    l: float                 # each link [m]
    g: float                 # [m/s²]; equal masses, which do not matter then


GAMMA = 1.0 / (4.0 - 4.0 ** (1.0 / 3.0))                # Suzuki 1990


def links_of(x):
    return x[1:] - x[:-1]


@cache
def coupling(n):
    """Return BBᵀ (n, n) of n links, without the row of the fixed point of B."""
    weights = 2.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    weights[0, 0] = 1.0
    return weights


def along_links(x, z, right):
    """Return the change of all points along the links of x with (link s of z) · (change of link s) = right[s].

    Σ_r (z_s · x_r) (BBᵀ)_sr λ_r = right_s: a dense solve.
    """
    d = links_of(x)
    pull = np.linalg.solve(links_of(z) @ d.T * coupling(len(d)), right)[:, None] * d
    change = np.zeros_like(x)
    change[1:] += pull
    change[1:-1] -= pull[1:]
    return change


def excess(x, l):
    """Return half of what the square of each link's length lacks, (l² − length²)/2 [m²]."""
    return 0.5 * (l * l - np.sum(links_of(x) ** 2, axis=1))


def held(v, x):
    """Return v without its component along the links of x."""
    return v + along_links(x, x, -np.sum(links_of(x) * links_of(v), axis=1))


def rattle(x, v, h, l, a, corrections=50):
    """Take a step of RATTLE, with corrections until nothing changes."""
    half = v + 0.5 * h * a
    for _ in range(corrections):
        change = along_links(x, x + h * half, excess(x + h * half, l) / h)
        half = half + change
        if np.max(np.abs(change)) <= 1e-13 * np.max(np.abs(half)):
            break
    new = x + h * half
    return new, held(half + 0.5 * h * a, new)


rattle_once = partial(rattle, corrections=1)             # rope_step


def composed_rope(x, v, h, l, a):
    for share in (GAMMA, GAMMA, 1.0 - 4.0 * GAMMA, GAMMA, GAMMA):
        x, v = rattle_once(x, v, share * h, l, a)
    return x, v


def onto_circle(x, v, h, l, a):
    """Return (x, v) after a step of projection, PBD or XPBD with one link: the point moves radially to its circle."""
    goal = x + h * (v + h * a)
    new = np.stack((x[0], x[0] + l * (goal[1] - x[0]) / np.linalg.norm(goal[1] - x[0])))
    return new, (new - x) / h


def chipmunk_rope(x, v, h, l, a):
    """Move the points, apply gravity, and then let converged PinJoints give each link the rate  (l − length)/h."""
    x, v = x + h * v, v + h * a
    d = links_of(x)
    length = np.linalg.norm(d, axis=1)
    rate = (l - length) / h
    return x, v + along_links(x, x, length * rate - np.sum(d * links_of(v), axis=1))


def nudged(rope, nudge):
    """Return the points of a rope after a small rotation of each link, which keeps its length."""
    d = links_of(rope.x)
    angles = nudge / rope.l * np.cos(np.arange(1.0, len(rope.x)) ** 2)
    turned = d + angles[:, None] * np.stack((-d[:, 1], d[:, 0]), axis=1)
    return np.concatenate((rope.x[:1], rope.x[0] + np.cumsum(turned, axis=0)))


def rope_after(step, ahead, rope, h, steps):
    """Return x (N + 1, 2) after this number of steps (x, v, h, l, a) → (x, v) from rest; ahead: see `predict`."""
    x, a = rope.x, np.zeros_like(rope.x)
    a[1:, 1] = -rope.g
    v = ahead * h * a
    for _ in range(steps):
        x, v = step(x, v, h, rope.l, a)
    return x


FINEST = {1: 800, 2: 800, 4: 400}    # steps of the finest run of such a step, by its order
UNFINISHED = 0.5             # of the error of a rope whose sweeps stop before all links are right [-]


class RopeMotion(NamedTuple):
    """A scene's description of its rope; Motion in validate/reference/schemes.py is the same for points."""
    T: float                 # the output time [s]
    rope: Callable           # p → Rope
    seen: Callable           # x (N + 1, 2) → what the scene observes
    truth: Callable          # (p, t) → the same, with no error
    floor: Callable          # (p, dt) → round-off, relative

    def error_law(self, run, order, finest):
        """Return p → ErrorLaw of run(rope, h, steps) → x."""
        @cache
        def law(p):
            one = self.rope(p)
            nudged_run = lambda steps, nudge: self.seen(
                run(one._replace(x=nudged(one, nudge)), self.T / steps, steps))
            return ErrorLaw(nudged_run, np.array(self.truth(p, self.T), dtype=float), order, self.T, finest)
        return law

    def predict(self, step, order, ahead=0.0):
        """Return the field `predicted` of a Runner that takes these steps.

        ahead: of the first velocity, in steps, with gravity alone
        """
        law = rope_law(self, step, order, ahead)

        def predicted_error(p, dt):
            """The error, with its sign, of the same step with a dense matrix: at the same step where that is coarse,
            else by its expansion in powers of dt.
            """
            return law(p).prediction(dt, self.floor(p, dt))
        return predicted_error

    def predict_unfinished(self, step, order, ahead=0.0, share=UNFINISHED):
        """Return the same for sweeps that stop before all links are right: its error is known to this share only."""
        law = rope_law(self, step, order, ahead)

        def predicted_error(p, dt):
            """pymunk moves the points first and then corrects each link within one step.

            In a rope of several links its sweeps do not converge: the band is wider by half of the error, and with a
            leapfrog start, whose own error is smaller, by all of it.
            """
            return widened(law(p), dt, self.floor(p, dt), share)
        return predicted_error


@cache
def rope_law(motion, step, order, ahead):
    """Return p → ErrorLaw of a rope that takes these steps: methods and engines with the same step share its runs."""
    return motion.error_law(partial(rope_after, step, ahead), order, FINEST[order])


def widened(law, dt, floor, share):
    """Return the Prediction of an ErrorLaw with its band widened by that fraction of the error; None if it has none."""
    found = law.prediction(dt, floor)
    return found and found._replace(band=found.band + share * np.linalg.norm(found.error) / law.size)
