"""Kepler's ellipse: the reference solution of lesson 1's orbits, and the error limits from theory."""

from functools import cache
from typing import Annotated, NamedTuple

import numpy as np

from ..scene import LATE_LEAPFROG, ROUND_OFF
from .schemes import BLANES_MOAN, Model, Motion, nudged, step_of


class Planet(NamedTuple):
    """A planet that starts at its nearest point to the sun."""
    mu: Annotated[float, "gravity of the sun, G m [m³/s²]"] = 1.0
    a: Annotated[float, "half the long axis [m]"] = 1.0
    e: Annotated[float, "eccentricity [-]"] = 0.6


def perihelion(p):
    """Return (x, v) at the nearest point to the sun: |x| = a (1 − e),  v² = μ (1 + e)/(a (1 − e)), the largest v."""
    return np.array([p.a * (1.0 - p.e), 0.0]), np.array([0.0, np.sqrt(p.mu / p.a * (1.0 + p.e) / (1.0 - p.e))])


def attraction(x, mu):
    """Return a = −μ x/|x|³."""
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
    A method of even order makes this error on the way in and reverses it on the way out, by time reversal.  Only ε_k₊₁
    remains at every passage (and nothing for symplectic methods).  A method of order 1 leaves ε₁ at every passage.  By
    Kepler's third law n changes by 3/2 ε, so the phase at T is wrong by
        φ = 3/2 n T (ε_k + ε_k₊₁ n T/4π)        for even k,
        φ = 3/2 n T ε₁ (1 + n T/4π)              for k = 1;        in metres |v(T)|/n φ.
    The two terms may differ in sign: for the midpoint method they cancel at one step size.
    Source: Calvo and Sanz-Serna 1993; Hairer, Lubich, Wanner 2006, X.3 and XI.
    """
    n, rate = np.sqrt(p.mu / p.a**3), np.sqrt(p.mu / (p.a * (1.0 - p.e)) ** 3)
    growth = (rate * dt) ** k + n * T / (4.0 * np.pi) * (rate * dt) ** (1 if k == 1 else k + 1)
    return passage_weight(p, T) * growth + round_off(p, T, dt)


def passage_weight(p, T):
    """Return the relative error of position at T over the relative error of v at each passage, as in drift."""
    n = np.sqrt(p.mu / p.a**3)
    x, v = orbit(*perihelion(p), p.mu, T)
    return np.linalg.norm(v) / n / np.linalg.norm(x) * 1.5 * n * T * 2.0 * (1.0 + p.e) / (1.0 - p.e)


def round_off(p, T, dt):
    """Return the relative error of position at T caused by round-off, which grows like a method's own error."""
    return passage_weight(p, T) * (1e-12 + T / dt * ROUND_OFF)


def random_round_off(p, T, dt):
    """Return the same if rounding errors have either sign: a random walk, ten times its standard deviation."""
    return passage_weight(p, T) * 10.0 * np.sqrt(T / dt) * ROUND_OFF + 1e-11


def late_start(p, T, dt, side):
    """Return the relative error at T of leapfrog with a first velocity dt/2 before (side +1) or after (−1) the start.

    Symplectic Euler and the engines are leapfrog with v(0) in place of v(∓½dt).  That is exactly the ellipse of a
    planet with the velocity v(0) ± ½dt a(0).  At the nearest point a is normal to v, so the energy changes only by
    dt².  The ellipse turns, and its period stays the same.  This error does not grow with time while leapfrog's own
    does, so a sweep of dt shows an order between 1 and 2.
    """
    x, v = perihelion(p)
    shifted, _ = orbit(x, v + side * 0.5 * dt * attraction(x, p.mu), p.mu, T)
    error = np.linalg.norm(shifted - kepler_position(p, T)) / np.linalg.norm(kepler_position(p, T))
    # the planet escapes: no limit
    return error if np.isfinite(error) else 1.0


def mean_rate(p):
    """Return n = √(μ/a³) [rad/s]: Kepler's third law."""
    return np.sqrt(p.mu / p.a**3)


def adaptive_limit(p, T, share):
    """Return the largest relative error at T of a method of order 4 whose steps are share/√(μ/r³), as in drift."""
    growth = share**4 + mean_rate(p) * T / (4.0 * np.pi) * share**5
    return passage_weight(p, T) * growth + round_off(p, T, share / mean_rate(p))


def adaptive_march(law, x, v, share, T):
    """Return x at T of adaptive steps with Blanes and Moan's table.

    In complex numbers x·v/x² is the real part of v/x.  The middle of each step has the rate ρ, which is √(|a|/|x|)
    continued by ρ̇ = −3/2 ρ x·v/x²; the step is share/ρ.
    Source: Hairer and Söderlind 2005.
    """
    move, t = step_of(BLANES_MOAN), 0.0
    rate = np.sqrt(abs(law(t, x, v)) / abs(x)) - 0.75 * share * (v / x).real
    while t < T:
        if not rate > 0.0:
            raise ArithmeticError("the steps are too long for the rule")
        h = min(share / rate, T - t)
        x, v = move(law, t, x, v, h)
        t, rate = t + h, rate - 1.5 * share * (v / x).real
    return x


def kepler_limits(T):
    """Return function(p, dt) → {order: largest relative error at T}."""
    def limits(p, dt):
        """Methods of order 2 and 4 drift in phase.  Symplectic Euler and pybullet are leapfrog, whose first velocity
        should be that of half a step before the start.
        """
        smooth = {k: drift(p, T, dt, k) for k in (1, 2, 4)}
        return {**smooth, LATE_LEAPFROG: late_start(p, T, dt, 1.0) + smooth[2]}
    return limits


def early_limit(T):
    """Return function(p, dt) → largest relative error at T of leapfrog that is started half a step early."""
    def limit(p, dt):
        """pymunk is leapfrog, whose first velocity should be that of half a step after the start."""
        return late_start(p, T, dt, -1.0) + drift(p, T, dt, 2)
    return limit


EVEN = {2: (2, 4, 6), 4: (4, 6, 8)}      # powers of dt in the error of a symmetric method, by its order
FINEST = {1: 20000, 2: 10000, 4: 4000}   # steps of the finest run of a table, by its order
FINEST_RK4, FINEST_ADAPTIVE = 10000, 2000


def kepler_motion(T):
    """Return the Motion of a planet, with positions as complex numbers."""
    def law(p):
        return lambda t, x, v: -p.mu * x / abs(x) ** 3

    def begin(p):
        return tuple(complex(*pair) for pair in perihelion(p))

    return Motion(T, law, begin, lambda x, p: [x.real, x.imag], kepler_position,
                  lambda p, dt: random_round_off(p, T, dt))


def adaptive_errors(motion):
    """Return the field `predicted` of steps that adapt to the distance."""
    @cache
    def run(p, h, steps, nudge):
        x, v = motion.begin(p)
        end = adaptive_march(motion.law(p), nudged(x, nudge), v, h * mean_rate(p), motion.T)
        return motion.seen(end, p)
    return motion.predict_model(Model(4, run), finest=FINEST_ADAPTIVE, powers=EVEN[4])
