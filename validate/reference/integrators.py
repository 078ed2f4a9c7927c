"""Kepler's ellipse: the reference solution of lesson 1's orbits, and the error limits from theory."""

from typing import Annotated, NamedTuple

import numpy as np

from ..scene import LATE_LEAPFROG, ROUND_OFF


class Planet(NamedTuple):
    """A planet that starts at its nearest point to the sun."""
    mu: Annotated[float, "gravity of the sun, G m [m³/s²]"] = 1.0
    a: Annotated[float, "half the long axis [m]"] = 1.0
    e: Annotated[float, "eccentricity [-]"] = 0.6


def perihelion(p):
    """Return (x, v) at the nearest point to the sun: |x| = a (1 − e),  v² = μ (1 + e)/(a (1 − e)), the largest v."""
    return np.array([p.a * (1.0 - p.e), 0.0]), np.array([0.0, np.sqrt(p.mu / p.a * (1.0 + p.e) / (1.0 - p.e))])


def attraction(x, mu):
    """a = −μ x/|x|³"""
    return -mu / np.linalg.norm(x) ** 3 * x


def eccentric_anomaly(M, e):
    """Solve Kepler's equation E − e sin E = M for E [rad], by Newton's method to round-off.

    It starts at the end of the half turn that contains M.  There the curvature of the left side prevents overshoot,
    so all corrections have one sign until round-off.
    """
    side = np.sign(np.sin(M))
    E = np.pi * (np.ceil(M / np.pi) if side > 0.0 else np.floor(M / np.pi))
    while True:
        nearer = E - (E - e * np.sin(E) - M) / (1.0 - e * np.cos(E))
        if not side * (E - nearer) > 0.0:                                  # also stops if M is not a number
            return E
        E = nearer


def orbit(x, v, mu, t):
    """Return (x, v) at t of a planet that passes x with the velocity v on an ellipse; NaN if it escapes.

    1/a = 2/r − v²/μ,   n = √(μ/a³),   e cos E₀ = 1 − r/a,   e sin E₀ = x·v/√(μa),   E − e sin E = E₀ − e sin E₀ + n t
    With ψ = E − E₀:   x(t) = f x + g v,   f = 1 − (a/r)(1 − cos ψ),   g = ((r/a) sin ψ + e sin E₀ (1 − cos ψ))/n;
    v(t) is the time derivative, with ψ̇ = n/(1 − e cos E).
    Source: Bate, Mueller and White 1971, Fundamentals of astrodynamics, chapter 4.
    """
    r, per_a = np.linalg.norm(x), 2.0 / np.linalg.norm(x) - v @ v / mu
    if per_a <= 0.0:
        return np.full_like(x, np.nan), np.full_like(v, np.nan)
    n, r_a, e_cos, e_sin = np.sqrt(mu * per_a**3), r * per_a, 1.0 - r * per_a, x @ v * np.sqrt(per_a / mu)
    E_0, e = np.arctan2(e_sin, e_cos), np.hypot(e_sin, e_cos)
    E = eccentric_anomaly(E_0 - e_sin + n * t, e)
    c, s, rate = np.cos(E - E_0), np.sin(E - E_0), n / (1.0 - e * np.cos(E))
    return ((1.0 - (1.0 - c) / r_a) * x + (r_a * s + e_sin * (1.0 - c)) / n * v,
            -s / r_a * rate * x + (r_a * c + e_sin * s) / n * rate * v)


def kepler_position(p, t):
    """Kepler's ellipse: n t = E − e sin E,   n = √(μ/a³),   x = a (cos E − e, √(1 − e²) sin E)

    r²θ̇ is constant; with the eccentric anomaly E in place of θ that integrates to the first equation.
    Source: Kepler 1609, Astronomia nova; Goldstein, Classical mechanics, § 3.8.
    """
    return orbit(*perihelion(p), p.mu, t)[0]


def drift(p, T, dt, k):
    """Return the largest relative error of position at T of a method of order k.

    Near the sun a step errs by (rate dt)ᵏ⁺¹ of the velocity, rate = √(μ/r³) at the shortest distance r: in complex
    time |x| = 0 lies about 1/rate away, which sets the growth of Taylor's coefficients.  A passage lasts 1/rate.  It
    changes v by (rate dt)ᵏ v, and the energy, relative to μ/2a, by
        ε_k = 2 (1 + e)/(1 − e) (rate dt)ᵏ.
    A method of even order does that on the way in and undoes it on the way out, by time reversal.  Only ε_k₊₁ is left
    at every passage (and nothing for symplectic methods).  A method of order 1 leaves ε₁ at every passage.  By Kepler's
    third law n changes by 3/2 ε, so the phase at T is wrong by
        φ = 3/2 n T (ε_k + ε_k₊₁ n T/4π)        for even k,
        φ = 3/2 n T ε₁ (1 + n T/4π)              for k = 1;        in metres |v(T)|/n φ.
    The two terms may differ in sign: for the midpoint method they cancel at one step size.
    Source: Calvo and Sanz-Serna 1993; Hairer, Lubich, Wanner 2006, X.3 and XI.
    """
    n, rate = np.sqrt(p.mu / p.a**3), np.sqrt(p.mu / (p.a * (1.0 - p.e)) ** 3)
    x, v = orbit(*perihelion(p), p.mu, T)
    metres = np.linalg.norm(v) / n / np.linalg.norm(x)
    # the effect of a relative error of v at each passage
    weight = metres * 1.5 * n * T * 2.0 * (1.0 + p.e) / (1.0 - p.e)
    round_off = weight * (1e-12 + T / dt * ROUND_OFF)
    return weight * ((rate * dt) ** k + n * T / (4.0 * np.pi) * (rate * dt) ** (1 if k == 1 else k + 1)) + round_off


def late_start(p, T, dt, side):
    """Return the relative error at T of leapfrog with a first velocity dt/2 before (side +1) or after (−1) the start.

    Symplectic Euler and the engines are leapfrog with v(0) in place of v(∓½dt): exactly the ellipse of a planet
    with the velocity v(0) ± ½dt a(0).  At the nearest point a is normal to v, so the energy changes only by dt²:
    the ellipse turns, its period stays.  This error does not grow with time while leapfrog's own does, so a sweep
    of dt shows an order between 1 and 2.
    """
    x, v = perihelion(p)
    shifted, _ = orbit(x, v + side * 0.5 * dt * attraction(x, p.mu), p.mu, T)
    error = np.linalg.norm(shifted - kepler_position(p, T)) / np.linalg.norm(kepler_position(p, T))
    # it escapes: no limit
    return error if np.isfinite(error) else 1.0


def kepler_limits(p, T, dt):
    """Return {order or engine label: largest relative error at T}."""
    smooth = {k: drift(p, T, dt, k) for k in (1, 2, 4)}
    old, new = late_start(p, T, dt, -1.0) + smooth[2], late_start(p, T, dt, 1.0) + smooth[2]
    return {**smooth, LATE_LEAPFROG: new, "pymunk": old, "pymunk, leapfrog start": smooth[2],
            "pybullet": new, "pybullet, leapfrog start": smooth[2]}


# ---------------------------------------------------------------------------------------------- one step

class Nystrom(NamedTuple):
    """A method for ẍ = a(t, x, ẋ) as a table of numbers, for stages i:

    aᵢ = a(t + cᵢ h,  x + cᵢ h v + h² Σ Āᵢⱼ aⱼ,  v + h Σ Aᵢⱼ aⱼ),      x ← x + h v + h² Σ b̄ⱼ aⱼ,      v ← v + h Σ bⱼ aⱼ
    Source: Hairer, Nørsett and Wanner 1993, II.14.
    """
    c: np.ndarray            # times of the stages [-]
    A_bar: np.ndarray        # their places [-]
    A: np.ndarray            # their velocities [-]
    b_bar: np.ndarray        # weights for the place [-]
    b: np.ndarray            # weights for the velocity [-]


def runge_kutta(A, b):
    """Return the Nystrom of a Runge–Kutta method for (x, v) together: Ā = A², b̄ = b A, and c the sums of rows of A."""
    A, b = np.array(A, float), np.array(b, float)
    return Nystrom(A.sum(axis=1), A @ A, A, b @ A, b)


def kicks_and_drifts(kicks, drifts):
    """Return the Nystrom of a splitting, kick and drift by turns; for accelerations that do not depend on v.

    A kick at cᵢ moves what comes later by its distance in time: Āᵢⱼ = bⱼ (cᵢ − cⱼ) for j < i, and b̄ⱼ = bⱼ (1 − cⱼ).
    """
    b, c = np.array(kicks), np.concatenate(([0.0], np.cumsum(drifts)))
    return Nystrom(c, np.tril(b * (c[:, None] - c), -1), 0.0 * np.outer(c, c), b * (1.0 - c), b)


def blanes_moan():
    """Return SRKN₆ᵇ of order 4.  Source: Blanes and Moan 2002, table 4: b₁ to b₄, backwards; a₁ to a₃, backwards."""
    b, a = [0.0829844064174052, 0.396309801498368, -0.0390563049223486], [0.245298957184271, 0.604872665711080]
    a.append(0.5 - sum(a))
    return kicks_and_drifts([*b, 1.0 - 2.0 * sum(b), *b[::-1]], [*a, *a[::-1]])


def stages(*rows):
    """Return a Nystrom with one or two stages from nested lists."""
    return Nystrom(*(np.array(row, float) for row in rows))


TABLES = {
    "euler_step": runge_kutta([[0]], [1]),
    "midpoint_step": runge_kutta([[0, 0], [1 / 2, 0]], [0, 1]),
    "rk4_step": runge_kutta([[0, 0, 0, 0], [1 / 2, 0, 0, 0], [0, 1 / 2, 0, 0], [0, 0, 1, 0]],
                            [1 / 6, 1 / 3, 1 / 3, 1 / 6]),
    "average_velocity_step": stages([0], [[0]], [[0]], [1 / 2], [1]),
    "symplectic_euler_step": stages([0], [[0]], [[0]], [1], [1]),
    "verlet_step": stages([0, 1], [[0, 0], [1 / 2, 0]], [[0, 0], [1, 0]], [1 / 2, 0], [1 / 2, 1 / 2]),
    "implicit_euler_step": runge_kutta([[1]], [1]),
    "implicit_midpoint_step": runge_kutta([[1 / 2]], [1]),
    "blanes_moan_step": blanes_moan(),
}
ROUNDS = 100                 # at most, of a fixed point [-]: a rate of two thirds would end at round-off


def table_step(table, acceleration, t, x, v, h):
    """Return (x, v) after one step of a Nystrom; implicit stages by fixed-point iteration, for short steps."""
    a = np.zeros((len(table.c), *x.shape))
    for _ in range(ROUNDS):
        place, speed = np.tensordot(table.A_bar, a, 1), np.tensordot(table.A, a, 1)
        before, a = a, np.array([acceleration(t + c * h, x + c * h * v + h * h * place[i], v + h * speed[i])
                                 for i, c in enumerate(table.c)])
        if np.array_equal(a, before):
            break
    return x + h * v + h * h * np.tensordot(table.b_bar, a, 1), v + h * np.tensordot(table.b, a, 1)
