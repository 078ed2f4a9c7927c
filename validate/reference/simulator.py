"""Reference solutions for the lesson on simulators, independent of it."""

from functools import cache

import numpy as np
from scipy.integrate import quad, solve_ivp

RTOL, ATOL = 1e-12, 1e-14


def rocking(half_width, half_height, g, lean, t, pushed=0.0):
    """Return (angle [rad], rate [rad/s], times and rates (before, after) of the impacts) of a uniform block at t.

    It begins at `lean` on its left corner, with the rate `pushed`.  About a corner 4/3 m R² θ̈ = −m g R sin(α − θ), by
    DOP853 until the angle is zero.  The impact conserves the angular momentum about the other corner.  With the moments
    written out,
        before:  I ω + m (h² − b²) ω,       after:  (I + m R²) ω⁺,       I = m R²/3
    *Source:* Housner 1963.
    """
    R2, alpha = half_width**2 + half_height**2, np.arctan2(half_width, half_height)
    kept = (R2 / 3.0 + half_height**2 - half_width**2) / (4.0 / 3.0 * R2)
    rate = 0.75 * g / np.sqrt(R2)

    def flat(_, y):
        return y[0]
    flat.terminal, flat.direction = True, -1.0
    now, y, side, impacts = 0.0, np.array([lean, pushed]), 1.0, []
    while now < t:
        run = solve_ivp(lambda _, y: (y[1], -rate * np.sin(alpha - y[0])), (now, t), y, method="DOP853", rtol=RTOL,
                        atol=ATOL, events=flat)
        now, y = run.t[-1], run.y[:, -1]
        if run.status == 1:
            impacts.append((now, side * y[1], side * kept * y[1]))
            y, side = np.array([0.0, -kept * y[1]]), -side
    return side * y[0], side * y[1], impacts


# ---------------------------------------------------------------------------------------------- rods in a chain

def rods_slope(n, l, m, inertia, g):
    """Return (θ, ω)˙ of n rods in a chain that hangs in the origin, θ from straight down.

    The centre of rod k is at Σ_{j<k} l e_j + ½ l e_k, so that its kinetic energy has the factors l l, ½ l l and ¼ l l:
        Σ_j C_kj (cos(θ_k − θ_j) θ̈_j + sin(θ_k − θ_j) ω_j²) + I θ̈_k + w_k sin θ_k = 0
        C_kj = m l² (n − 1 − max(k, j) + ½),   C_kk = m l² (n − 1 − k + ¼),   w_k = m g l (n − 1 − k + ½)
    *Source:* Lagrange's equations.
    """
    k = np.arange(n)
    C = m * l * l * (n - 0.5 - np.maximum.outer(k, k))
    C[k, k] -= 0.25 * m * l * l
    w = m * g * l * (n - 0.5 - k)

    def slope(_, y):
        theta, omega = np.split(y, 2)
        apart = theta[:, None] - theta
        right = -(C * np.sin(apart)) @ omega**2 - w * np.sin(theta)
        return np.concatenate((omega, np.linalg.solve(C * np.cos(apart) + inertia * np.eye(n), right)))
    return slope


@cache
def rods_motion(n, l, m, inertia, g, T, ahead=0.0, rtol=RTOL):
    """Solve for (θ, ω) of such a chain by DOP853, released horizontally with the velocity of `ahead` seconds later."""
    slope = rods_slope(n, l, m, inertia, g)
    start = np.concatenate((np.full(n, 0.5 * np.pi), np.zeros(n)))
    start[n:] = ahead * slope(0.0, start)[n:]
    return solve_ivp(slope, (0.0, T), start, method="DOP853", rtol=rtol, atol=0.1 * rtol, dense_output=True)


def rods_ends(theta, l):
    """Return the lower ends (n, 2) [m]."""
    return l * np.cumsum(np.stack((np.sin(theta), -np.cos(theta)), axis=1), axis=0)


@cache
def rods_lag(n, l, m, inertia, g, T):
    """Return |∂x/∂dt| [m/s] of all ends at T if the first velocity is that of ½ dt later (or earlier).

    Both engines move bodies by xₙ₊₁ − 2xₙ + xₙ₋₁ = dt² (g + forces of the joints at xₙ), which is of second order.
    Only the start is of first order: pybullet has x₁ − x₀ = dt² a, pymunk x₁ = x₀, and ½ dt² a would be right.
    """
    h = 1e-4
    ends = [rods_ends(rods_motion(n, l, m, inertia, g, T, 0.5 * dt, 1e-9).y[:n, -1], l) for dt in (h, -h)]
    return float(np.linalg.norm(ends[0] - ends[1]) / (2.0 * h))


def rods_step(theta, p, h, C, inertia, w):
    """Return (θ, p) after h by the discrete Lagrangian  ½ m |Δx|²/h + ½ I |Δθ|²/h − ½ h (V + V').

    RATTLE takes the same step in Cartesian coordinates.  In angles nothing has to be projected: p = −∂L/∂θ gives
    the new θ by Newton's method, and p' = ∂L/∂θ'.
    *Source:* Marsden and West 2001, 3.5.
    """
    here = np.sum(C * np.sin(theta[:, None] - theta), axis=1) + 0.5 * h * h * w * np.sin(theta)
    now = theta + h * np.linalg.solve(C * np.cos(theta[:, None] - theta) + inertia * np.eye(theta.size), p)
    for _ in range(50):
        apart = now - theta[:, None]
        lacks = h * p - here - np.sum(C * np.sin(apart), axis=1) - inertia * (now - theta)
        change = np.linalg.solve(C * np.cos(apart) + inertia * np.eye(theta.size), lacks)
        now = now + change
        if np.max(np.abs(change)) < 1e-13:
            break
    there = np.sum(C * (np.sin(now[:, None] - theta) - np.sin(now[:, None] - now)), axis=1)
    return now, (there + inertia * (now - theta)) / h - 0.5 * h * w * np.sin(now)


@cache
def rods_error(n, l, m, inertia, g, T, steps, shares=(1.0,)):
    """Return |error| [m] of all ends at T after this number of steps, each divided into substeps with these shares."""
    k = np.arange(n)
    C = m * l * l * (n - 0.5 - np.maximum.outer(k, k))
    C[k, k] -= 0.25 * m * l * l
    theta, p, w = np.full(n, 0.5 * np.pi), np.zeros(n), m * g * l * (n - 0.5 - k)
    for _ in range(steps):
        for share in shares:
            theta, p = rods_step(theta, p, share * T / steps, C, inertia, w)
    return float(np.linalg.norm(rods_ends(theta, l) - rods_ends(rods_motion(n, l, m, inertia, g, T).y[:n, -1], l)))


@cache
def rods_gaps(n, l, m, inertia, g, T):
    """Return (possible error [m/s²] of all ends over dt² if joints are closed one step late, largest ω [rad/s]).

    A rod that turns with ω leaves its tangent by ½ ω² l dt² per step.  The gap of an end is the sum over all joints
    above it, at the largest value during the motion.
    """
    omega = rods_motion(n, l, m, inertia, g, T).sol(np.linspace(0.0, T, 1001))[n:]
    return float(np.linalg.norm(np.cumsum(0.5 * l * np.max(omega**2, axis=1)))), float(np.max(np.abs(omega)))


def rods_energy(y, l, m, inertia, g):
    """Return the energy [J] of (θ, ω)."""
    theta, omega = np.split(y, 2)
    ends = rods_ends(theta, l)
    speeds = l * np.cumsum(omega[:, None] * np.stack((np.cos(theta), np.sin(theta)), axis=1), axis=0)
    before, fast = np.vstack((np.zeros(2), ends[:-1])), np.vstack((np.zeros(2), speeds[:-1]))
    v, x = 0.5 * (speeds + fast), 0.5 * (ends + before)
    return 0.5 * m * np.sum(v * v) + 0.5 * inertia * np.sum(omega**2) + m * g * np.sum(x[:, 1])


# ---------------------------------------------------------------------------------------------- balls on rods

def cradle_gaps(theta, pitch, L, R):
    """Return gaps (n − 1,) [m] of balls on rods of length L, pivots one pitch apart, and their derivatives (n − 1, 2).

    The derivatives are by the angles of both neighbours.
    """
    x = np.stack((pitch * np.arange(theta.size) + L * np.sin(theta), -L * np.cos(theta)), axis=1)
    way, turns = np.diff(x, axis=0), L * np.stack((np.cos(theta), np.sin(theta)), axis=1)
    length = np.linalg.norm(way, axis=1)
    n = way / length[:, None]
    return length - 2.0 * R, np.stack((-np.sum(n * turns[:-1], axis=1), np.sum(n * turns[1:], axis=1)), axis=1)


@cache
def cradle_motion(lifted, angle, n, pitch, L, R, g, inertia, T):
    """Return (θ (n,), ω (n,), impacts) at T of n pendulums, the first `lifted` of which begin at −angle.

    inertia: moment of each about its pivot over its mass [m²].  DOP853 integrates the swing until a gap closes.  There
    the impulse along its normal reverses the gap's velocity and acts on each angle by its own lever arm: e = 1.
    impacts: [(time, number of the gap, rates before, rates after)].
    """
    y, now, impacts = np.concatenate((np.where(np.arange(n) < lifted, -angle, 0.0), np.zeros(n))), 0.0, []

    def slope(_, y):
        return np.concatenate((y[n:], -g * L / inertia * np.sin(y[:n])))

    def closes(k):
        def gap(_, y):
            return cradle_gaps(y[:n], pitch, L, R)[0][k]
        gap.terminal, gap.direction = True, -1.0
        return gap
    events = [closes(k) for k in range(n - 1)]
    while now < T:
        run = solve_ivp(slope, (now, T), y, method="DOP853", rtol=RTOL, atol=ATOL, events=events)
        now, y = run.t[-1], run.y[:, -1].copy()
        if run.status == 1:
            k = next(k for k, times in enumerate(run.t_events) if times.size)
            lever, before = cradle_gaps(y[:n], pitch, L, R)[1][k], y[n:].copy()
            y[n + k:n + k + 2] -= 2.0 * lever * (lever @ y[n + k:n + k + 2]) / (lever @ lever)
            impacts.append((now, k, before, y[n:].copy()))
    return y[:n], y[n:], impacts


# ---------------------------------------------------------------------------------------------- release from a support

def leaves_ball(start, speed, R, g):
    """Return (time [s], angle [rad]) at which a puck leaves a ball on which it slides without friction.

    Its centre is at R from that of the ball, at the angle `start` from the top, and moves down with `speed` > 0.
    The ball pushes with m (g cos θ − R ω²), and R²ω² = speed² + 2 g R (cos start − cos θ).  So the force ends at
        cos θ = (2 cos start + speed²/(g R))/3
    *Source:* energy; ∫ dθ/ω is the time.
    """
    angle = np.arccos((2.0 * np.cos(start) + speed * speed / (g * R)) / 3.0)
    rate = lambda theta: np.sqrt(speed * speed + 2.0 * g * R * (np.cos(start) - np.cos(theta))) / R
    return quad(lambda theta: 1.0 / rate(theta), start, angle, epsabs=1e-12)[0], angle


def slides_on_ball(start, speed, R, g, t):
    """Return (angle [rad], speed [m/s]) of that puck at t [s], before or after the start, by DOP853."""
    run = solve_ivp(lambda _, y: (y[1], g / R * np.sin(y[0])), (0.0, t), (start, speed / R), method="DOP853", rtol=RTOL,
                    atol=ATOL)
    return run.y[0, -1], R * run.y[1, -1]


def leaves_platform(depth, speed, rate, g):
    """Return the time [s] at which a box leaves a platform that oscillates up and down, x = −D cos(rate t + φ).

    It begins at x = −depth with `speed` upwards: D cos φ = depth, rate D sin φ = speed.  The platform pushes with
    m (g + ẍ), so the force ends at  cos(rate t + φ) = −g/(rate² D);  inf if D ≤ g/rate².
    *Source:* Newton's second law.
    """
    D, phi = np.hypot(depth, speed / rate), np.arctan2(speed / rate, depth)
    return (np.arccos(-g / (rate * rate * D)) - phi) / rate if rate * rate * D > g else np.inf


# ---------------------------------------------------------------------------------------------- boxes at rest

def least_friction(a, b, n, p, x, weights):
    """Return the smallest friction μ with which bodies at x (k, 2) with these weights (k,) [N] can rest.

    Inf if none does.

    Contact c pushes body a[c] at p[c] with F_n n + F_t t, 0 ≤ F_n and |F_t| ≤ μ F_n, and body b[c] with the opposite
    force; numbers beyond k are ground.  For each μ of a bisection, a linear program decides whether such forces can
    balance all loads and torques.
    """
    from scipy.optimize import linprog
    k, m = len(x), len(a)
    balance, cone = np.zeros((3 * k, 2 * m)), np.zeros((2 * m, 2 * m))
    for c in range(m):
        for column, d in ((2 * c, n[c]), (2 * c + 1, np.array([-n[c, 1], n[c, 0]]))):
            for body, sign in ((a[c], 1.0), (b[c], -1.0)):
                if body < k:
                    r = p[c] - x[body]
                    balance[3 * body:3 * body + 3, column] += sign * np.array([*d, r[0] * d[1] - r[1] * d[0]])
    load = np.stack((0.0 * weights, weights, 0.0 * weights), axis=1).ravel()

    def rests(mu):
        for c in range(m):
            cone[2 * c, 2 * c:2 * c + 2], cone[2 * c + 1, 2 * c:2 * c + 2] = (-mu, 1.0), (-mu, -1.0)
        found = linprog(np.zeros(2 * m), A_ub=cone, b_ub=np.zeros(2 * m), A_eq=balance, b_eq=load,
                        bounds=[(0.0, None), (None, None)] * m, method="highs")
        return found.status == 0
    low, high = 0.0, 10.0
    if not rests(high):
        return np.inf
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if rests(middle) else (middle, high)
    return high


def wedge_pushed_out(m, angle, g, overlap, share, dt, steps):
    """Return (displacement (4,) [m], velocity (4,) [m/s]) in Bullet: x and y of a wedge on a floor, then of its block.

    There is no friction and no rotation.  Both bodies begin with an overlap.  A step adds gravity to the
    velocities, then finds the impulses at both contacts after which each opens at  share · remaining overlap/dt,
    and moves with the new velocities.
    """
    s, c = np.sin(angle), np.cos(angle)
    normals = np.array([(0.0, 1.0, 0.0, 0.0), (-s, -c, s, c)])                    # rate at which a contact opens
    lightness, way, v = 1.0 / np.repeat(m, 2), np.zeros(4), np.zeros(4)
    inverse = np.linalg.inv(normals * lightness @ normals.T)
    for _ in range(steps):
        v = v - dt * g * np.array([0.0, 1.0, 0.0, 1.0])
        opening = share * (overlap - normals @ way) / dt
        v += lightness * (normals.T @ (inverse @ (opening - normals @ v)))
        way = way + dt * v
    return way, v
