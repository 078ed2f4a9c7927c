"""Reference solutions of lesson 2: masses on springs.

Nothing here uses the forces of `solutions`.  The springs of a net are one matrix B (s, n), with −1 at one end of each
spring and +1 at the other.  It maps points to springs, r = B x, and its transpose maps tensions back to forces.  SciPy
integrates the net (DOP853), Newton's method finds its rest state, and a complex step gives its stiffness and hence
its modes.
"""

from functools import cache
from typing import Annotated, NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import solve_triangular
from scipy.optimize import minimize, root

from validate.reference.schemes import Model, Motion, nudged
from validate.scene import EXACT, ROUND_OFF

RTOL, ATOL = 1e-13, 1e-15    # of DOP853, near the smallest it accepts: the error of a step is below its round-off
TINY = 1e-30                 # a complex step [m]: its square vanishes beside 1, so the derivative is exact to round-off


class ReferenceNetwork(NamedTuple):
    """Equal masses joined by equal springs, whose natural lengths are `rest`."""
    x: np.ndarray            # (n, d) initial positions [m]
    v: np.ndarray            # (n, d) initial velocities [m/s]
    fixed: tuple             # numbers of the fixed points
    pairs: np.ndarray        # (s, 2) ends of each spring
    rest: np.ndarray         # (s,) [m]
    m: float                 # [kg]
    k: float                 # [N/m]
    k_d: float               # [N s/m]
    k_v: float               # [N s/m]
    gravity: np.ndarray      # (d,) [m/s²]
    wind: np.ndarray         # (d,) [N] on each point

    def spring_matrix(self):
        """Return B (s, n)."""
        one = np.eye(len(self.x))
        return one[self.pairs[:, 1]] - one[self.pairs[:, 0]]

    def free(self):
        """Return (n,) bool: whether each point can move."""
        return ~np.isin(np.arange(len(self.x)), self.fixed)

    def padded(self, d=3):
        """Return the same net with d coordinates, the last of which are not used."""
        pad = lambda a: np.concatenate((a, np.zeros((*a.shape[:-1], d - a.shape[-1]))), axis=-1)
        return self._replace(x=pad(self.x), v=pad(self.v), gravity=pad(self.gravity), wind=pad(self.wind))


class SquareNet(NamedTuple):
    """A square net that hangs from its upper edge."""
    n: Annotated[int, "nodes along each side [-]"] = 5
    spacing: Annotated[float, "of the nodes [m]"] = 0.1
    shear: Annotated[int, "1: also springs along both diagonals of each mesh"] = 0
    bend: Annotated[int, "1: also springs over the next node"] = 0
    m: Annotated[float, "each node [kg]"] = 0.05
    k: Annotated[float, "each spring [N/m]: the uppermost stretch by a tenth"] = 200.0
    k_d: Annotated[float, "its damper [N s/m]"] = 0.1
    k_v: Annotated[float, "viscous drag on each node [N s/m]"] = 0.0
    wind: Annotated[float, "horizontal, on each node [N]: a tenth of its weight"] = 0.05
    g: Annotated[float, "gravity [m/s²]"] = 9.81


def square_net(p):
    """Return the ReferenceNetwork: node (r, c) is number r n + c; squared lengths are 1, 2 (shear) or 4 (bend)."""
    r, c = np.divmod(np.arange(p.n * p.n), p.n)
    squared = (r[:, None] - r) ** 2 + (c[:, None] - c) ** 2
    pairs = np.argwhere(np.triu((squared == 1) | (squared == 2) & bool(p.shear) | (squared == 4) & bool(p.bend)))
    rest = p.spacing * np.sqrt(squared[pairs[:, 0], pairs[:, 1]])
    x = p.spacing * np.stack((c, -r), axis=1)
    gravity, wind = np.array([0.0, -p.g]), np.array([p.wind, 0.0])
    return ReferenceNetwork(x, 0.0 * x, tuple(range(p.n)), pairs, rest, p.m, p.k, p.k_d, p.k_v, gravity, wind)


def state_of(net, make_mesh):
    """Return (x, v, mesh) for the steps of lesson 2, with its plain constructor, because numba takes no lists."""
    mesh = make_mesh(net.x, net.m, net.fixed, net.pairs, net.k, net.k_d, net.gravity, net.wind, net.k_v)
    return net.x.copy(), net.v.copy(), mesh._replace(rest=net.rest)


# ---------------------------------------------------------------------------------------------- truth

def forces(x, v, net, B):
    """Return the forces [N] (n, d) on all points.

    m g + wind − k_v v − Bᵀ T n,   n = Bx/|Bx|,   T = k (|Bx| − rest) + k_d n · Bv
    """
    r = B @ x
    length = np.sqrt(np.sum(r * r, axis=1, keepdims=True))
    n = r / length
    tension = net.k * (length - net.rest[:, None]) + net.k_d * np.sum(n * (B @ v), axis=1, keepdims=True)
    return net.m * net.gravity + net.wind - net.k_v * v - B.T @ (tension * n)


def motion(net, T, rtol=RTOL):
    """Return x(t) (n, d) by DOP853, a function of t in [0, T], interpolated between its own steps but not at T."""
    B, free, shape = net.spring_matrix(), net.free()[:, None], net.x.shape

    def slope(t, y):
        x, v = y.reshape(2, *shape)
        return np.concatenate(((free * v).ravel(), (free * forces(x, v, net, B) / net.m).ravel()))

    start = np.concatenate((net.x.ravel(), net.v.ravel()))
    run = solve_ivp(slope, (0.0, T), start, method="DOP853", rtol=rtol, atol=ATOL, dense_output=True)
    return lambda t: np.split(run.y[:, -1] if t == T else run.sol(t), 2)[0].reshape(shape)


def rest_positions(net):
    """Return (n, d), the rest state of the net: the minimum of its energy by BFGS, then by Newton's method.

        U = Σ ½k (|Bx| − rest)² − Σ (m g + wind) · x

    Newton's method alone, started far away, may end where the forces vanish but the energy has no minimum.
    """
    B, free = net.spring_matrix(), net.free()

    def moved(y):
        x = net.x.astype(y.dtype)
        x[free] = y.reshape(-1, net.x.shape[1])
        return x

    def energy(y):
        stretch = np.linalg.norm(B @ moved(y), axis=1) - net.rest
        return 0.5 * net.k * np.sum(stretch**2) - np.sum(moved(y)[free] @ (net.m * net.gravity + net.wind))

    pull = lambda y: forces(moved(y), 0.0 * net.v, net, B)[free].ravel()
    near = minimize(energy, net.x[free].ravel(), jac=lambda y: -pull(y), method="BFGS").x
    return moved(root(pull, near, jac=lambda y: _jacobian(pull, y), tol=1e-15).x)


def _jacobian(function, y):
    """Return ∂function/∂y by complex steps, which involve no difference and hence no cancellation."""
    return np.stack([function(y + 1j * TINY * e).imag / TINY for e in np.eye(y.size)], axis=1)


# ---------------------------------------------------------------------- bounds of the error

def modes(net):
    """Return (omega, c, amplitude) of each mode about rest: frequency [rad/s], damping [1/s], initial amplitude [m].

    The amplitude is √(q² + q̇²/ω²).
    """
    B, free, x = net.spring_matrix(), net.free(), rest_positions(net)
    d = x.shape[1]

    def pull(y, v):
        moved = x.astype(complex)
        moved[free] = y.reshape(-1, d)
        speed = np.zeros_like(moved)
        speed[free] = v.reshape(-1, d)
        return forces(moved, speed, net, B)[free].ravel()

    here, still = x[free].ravel(), np.zeros(d * free.sum())
    squared, shapes = np.linalg.eigh(-_jacobian(lambda y: pull(y, still), here) / net.m)
    omega = np.sqrt(np.abs(squared))
    c = np.einsum("am,ab,bm->m", shapes, -_jacobian(lambda v: pull(here, v), still) / net.m, shapes)
    q, q_rate = shapes.T @ (net.x[free].ravel() - here), shapes.T @ net.v[free].ravel()
    return omega, c, np.hypot(q, q_rate / omega)


def by_mode(omega, c, amplitude, size, T, dt, uncertainty):
    """Return {order k: largest relative error at T}: each mode errs on its own, by its rate ω + c and its amplitude.

    A step with the error (rate dt)ᵏ⁺¹ multiplies a mode by e^z + δ with |δ| ≤ (rate dt)ᵏ⁺¹, |e^z| ≤ 1.  After T/dt
    steps the error is at most χ e^χ,  χ = rate T (rate dt)ᵏ.  So even a fast mode of tiny amplitude can spoil a coarse
    run by growing.  size [m] is that of the reference solution at T.  Round-off and Newton's method are as in
    scene.by_order.
    """
    floor = 1e-12 + T / dt * ROUND_OFF + uncertainty
    rate = omega + c
    chi = {k: np.minimum(rate * T * (rate * dt) ** k, 500.0) for k in (1, 2, 4)}     # e⁵⁰⁰ is large enough, and finite
    return {**{k: float(np.sum(amplitude * x * np.exp(x))) / size + floor for k, x in chi.items()}, EXACT: floor}


@cache
def _noted(make, p):
    net = make(p)
    B = net.spring_matrix()[:, net.free()]
    return *modes(net), np.sqrt(net.k / net.m) * np.linalg.norm(B, 2)


def net_limits(make, T, truth, uncertainty):
    """Return the field `limit` of a net: by_mode, with √2 times its frequencies at rest, but none above the largest.

    Released without tension, threads oscillate between zero and twice their rest tension.  Tension holds a slow
    mode, so its ω² oscillates between zero and twice its value.  A spring's stiffness is k along it and
    k (1 − rest/l) < k across, so no mode of any shape of the net exceeds √(k/m) |B|.
    make(p) → ReferenceNetwork;    truth(p, t);    uncertainty: of the truth, relative [-]
    """
    def limits(p, dt):
        """Each mode on its own, with a margin for large motion.  pymunk and pybullet are symplectic Euler: order 1."""
        omega, c, amplitude, fastest = _noted(make, p)
        size = np.linalg.norm(truth(p, T))
        return by_mode(np.minimum(np.sqrt(2.0) * omega, fastest), c, amplitude, size, T, dt, uncertainty)
    return limits


# ---------------------------------------------------------------------- predicted errors

def net_law(make):
    """Return p → a(t, x, v) of the net of make(p)."""
    def law(p):
        net = make(p)
        B, free = net.spring_matrix(), net.free()[:, None]
        return lambda t, x, v: free * forces(x, v, net, B) / net.m
    return law


def implicit_net(net, h, steps):
    """Return x after `steps` steps of linearly implicit Euler, by a dense matrix.

    (m − h ∂F/∂v − h² ∂F/∂x) Δv = h (F + h ∂F/∂x v).  As in lesson 2, ∂F/∂x leaves out the sideways push of compressed
    springs and the contribution of the damper.
    """
    B, d, x, v, free = net.spring_matrix(), net.x.shape[1], net.x, net.v, np.repeat(net.free(), net.x.shape[1])
    mass = (net.m + h * net.k_v) * np.eye(free.sum())

    def assembled(blocks):
        whole = np.empty((len(x), d, len(x), d))
        for a in range(d):
            for b in range(d):
                whole[:, a, :, b] = B.T @ (blocks[:, a, b, None] * B)
        return whole.reshape(x.size, x.size)

    for _ in range(steps):
        r = B @ x
        length = np.linalg.norm(r, axis=1)
        along = r[:, :, None] * r[:, None, :] / length[:, None, None] ** 2
        across = net.k * np.maximum(0.0, 1.0 - net.rest / length)[:, None, None]
        K, D = assembled(across * np.eye(d) + (net.k - across) * along), assembled(net.k_d * along)
        push = h * (forces(x, v, net, B).ravel() - h * K @ v.ravel())
        change = np.zeros(x.size)
        change[free] = np.linalg.solve((h * h * K + h * D)[np.ix_(free, free)] + mass, push[free])
        v = v + change.reshape(x.shape)
        x = x + h * v
    return x


def pymunk_net_model(net, h, steps, iterations=1, ahead=0.0):
    """Return x (n, d) after `steps` steps of Chipmunk's treatment of a net, in its order.

    ahead: of the first velocity, in steps; ½ makes leapfrog

    Points move with their old velocities; the springs pull at the new positions; then e^(−k_v h/m) reduces all
    velocities, and gravity acts.  Then each damper in sequence moves the rate of its spring towards its target, by
    the fraction  1 − e^(−k_d h/m'),  1/m' = Σ 1/m of the free ends.  The target is zero on the first visit, and
    then the rate that the last visit left.  One round of visits is one triangular system.
    *Source:* Chipmunk 7, cpSpaceStep.c and cpDampedSpring.c.
    """
    held = np.array([net.free()[i] or net.free()[j] for i, j in net.pairs])
    B, free, x = net.spring_matrix()[held], net.free()[:, None], net.x
    v = net.v + ahead * h * free * forces(x, net.v, net, net.spring_matrix()) / net.m
    per_mass = (B**2 @ net.free()) / net.m
    lost, kept = -np.expm1(-net.k_d * h * per_mass), np.exp(-net.k_v * h / net.m)
    for _ in range(steps):
        x = x + h * v
        r = B @ x
        length = np.linalg.norm(r, axis=1, keepdims=True)
        n = r / length
        v = kept * (v - free * (B.T @ (h * net.k / net.m * (length - net.rest[held, None]) * n)))
        v = v + free * h * (net.gravity + net.wind / net.m)
        if net.k_d == 0.0:
            continue
        J = (n[:, None, :] * (B * net.free())[:, :, None]).reshape(len(n), -1)
        coupling = J @ J.T / net.m / per_mass                    # effect of an impulse on the rates of other springs
        visits = np.tril(coupling, -1) + np.diag(1.0 / lost)
        rates, aims, total = J @ v.ravel(), np.zeros(len(n)), np.zeros(len(n))
        for _ in range(iterations):
            changes = solve_triangular(visits, aims - rates, lower=True, check_finite=False)
            aims = aims - changes / lost + changes
            rates = rates + coupling @ changes
            total += changes
        v = v + (J.T @ (total / per_mass)).reshape(x.shape) / net.m
    return x


def net_model(make, run):
    """Return the Model of order 1 that applies run(net, h, steps) → x to the net of make(p)."""
    def observed(p, h, steps, nudge):
        net = make(p)
        return run(net._replace(x=nudged(net.x, nudge)), h, steps).ravel()
    return Model(1, observed)


def net_steps(make, T, truth, uncertainty):
    """Return the Motion of the net of make(p), of which a scene observes every point; the rest is as in net_limits."""
    return Motion(T, net_law(make), lambda p: (make(p).x, make(p).v), lambda x, p: x.ravel(), truth,
                  lambda p, dt: 1e-12 + T / dt * ROUND_OFF + 10.0 * uncertainty)


@cache
def square_net_motion(p, T):
    """Return motion() of a SquareNet."""
    return motion(square_net(p), T)


def net_truth(T):
    """Return the truth of a SquareNet's scene up to T [s]."""
    def truth(p, t):
        """Every node, by DOP853 with separately coded forces, at a relative tolerance of 1e-13."""
        return square_net_motion(p, T)(t).ravel()
    return truth
