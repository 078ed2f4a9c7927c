"""Reference solutions of lesson 12: derivatives in closed form, by power series, and by complex numbers.

None of them differentiates a step or an event by the lesson's formulas.  A closed form is differentiated on paper.  A
flight with bounces is computed with complex numbers as a whole, and its derivative is the imaginary part.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from .impulses import ImpactRule, dropped

TINY = 1e-30                 # imaginary part of an input: its square is far below round-off [-]
POINTS = 32                  # on a circle, for a power series [-]
ARRIVED = 1e-13              # of a target, relative: Newton's method doubles its digits once more [-]


# ---------------------------------------------------------------------------------------------- smooth motions

def oscillation(t, k, c, m, x0):
    """Return x(t) of a mass on a spring k with a damper c, released at x0; k and c may be complex.

    x = e^(−δt) x₀ (cos σt + δ/σ sin σt),   δ = c/2m,   σ² = k/m − δ²
    """
    delta = c / (2.0 * m)
    sigma = np.sqrt(k / m - delta * delta)
    return x0 * np.exp(-delta * t) * (np.cos(sigma * t) + delta / sigma * np.sin(sigma * t))


def oscillator_sensitivities(t, k, c, m, x0):
    """Return (∂x/∂k, ∂x/∂c) of the same at t, for c < 2√(km), by the chain rule through δ and σ.

    With s = sin σt/σ:    x = x₀ e^(−δt) (cos σt + δ s),   ∂s/∂σ = (t cos σt − s)/σ
    ∂x/∂σ = x₀ e^(−δt) (−t sin σt + δ ∂s/∂σ),   ∂x/∂δ = x₀ e^(−δt) (s − t cos σt − t δ s)
    ∂σ/∂k = 1/2mσ,   ∂δ/∂c = 1/2m,   ∂σ/∂c = −δ/2mσ
    """
    delta = c / (2.0 * m)
    sigma = np.sqrt(k / m - delta * delta)
    wave, cosine, s = x0 * np.exp(-delta * t), np.cos(sigma * t), np.sin(sigma * t) / sigma
    by_sigma = wave * (-t * sigma * s + delta * (t * cosine - s) / sigma)
    by_delta = wave * (s - t * cosine - t * delta * s)
    return by_sigma / (2.0 * m * sigma), (by_delta - by_sigma * delta / sigma) / (2.0 * m)


def power_series(f, centre, radius, points=POINTS):
    """Return the coefficients c_j of f(centre + h) = Σ c_j hʲ, from values of f on a circle in the complex plane.

    The mean of f e^(−ijφ) over the circle is c_j radiusʲ.  It is exact but for the coefficients from c_points on.
    *Source:* Cauchy's integral formula; Trefethen and Weideman 2014.
    """
    around = np.exp(2j * np.pi * np.arange(points) / points)
    means = np.fft.fft(f(centre + radius * around)) / points
    return np.real(means) / radius ** np.arange(points)


# ---------------------------------------------------------------------------------------------- a ball over a floor

def bounces_until(h, e, g, t):
    """Return (number of bounces, time of the last one, speed after it) of a ball that is dropped from h at 0."""
    bounces, moment, speed = 0, np.sqrt(2.0 * h / g), np.sqrt(2.0 * g * h)
    last, left = 0.0, 0.0
    while moment <= t:
        speed *= e
        bounces, last, left = bounces + 1, moment, speed
        moment += 2.0 * speed / g
    return bounces, last, left


def bounced_sensitivities(h, e, g, t):
    """Return (y, v, ∂y/∂h, ∂y/∂e, ∂v/∂h, ∂v/∂e) at t of a ball that is dropped from h on a floor with restitution e.

    After k bounces  y = v_k (t − t_k) − ½ g (t − t_k)²  with  v_k = eᵏ √(2gh)  and
    t_k = √(2h/g) (1 + 2 (e + … + eᵏ⁻¹)).  Both grow with √h:  ∂v_k/∂h = v_k/2h,  ∂t_k/∂h = t_k/2h.
    ∂y = ∂v_k (t − t_k) − v ∂t_k,     ∂v = ∂v_k + g ∂t_k
    """
    k, moment, speed = bounces_until(h, e, g, t)
    since = t - moment
    if k == 0:
        return h - 0.5 * g * t * t, -g * t, 1.0, 0.0, 0.0, 0.0
    y, v = speed * since - 0.5 * g * since**2, speed - g * since
    powers = np.arange(1, k)
    speeds = speed / (2.0 * h), k * speed / e
    moments = moment / (2.0 * h), 2.0 * np.sqrt(2.0 * h / g) * np.sum(powers * e ** (powers - 1.0))
    places = [dv * since - v * dt for dv, dt in zip(speeds, moments)]
    return y, v, *places, *(dv + g * dt for dv, dt in zip(speeds, moments))


def stepped_sensitivities(h, e, g, t, kept):
    """Return (∂y/∂h, ∂y/∂e, ∂v/∂h, ∂v/∂e) at t, in the limit of short steps, of a method that fixes the step of
    a bounce.

    Each bounce stays in its step when an input changes, so its time does not move.  A change of h does not reach the
    speed, because the number of steps before the bounce does not change.
    The velocity:   w_k = −e (w_(k−1) − g flight)   gives   ∂w_k/∂e = eᵏ⁻¹ √(2gh) − e ∂w_(k−1)/∂e,   ∂w_0 = 0
    The position:   kept = 1: a ball that is below the floor stays there, and ∂y goes on through the bounce;
                    kept = 0: it is set on the floor, which forgets ∂y.
    """
    speed, moment, since = np.sqrt(2.0 * g * h), np.sqrt(2.0 * h / g), 0.0
    by_h, by_e, change = 1.0, 0.0, 0.0
    while moment <= t:
        by_h, by_e = kept * by_h, kept * (by_e + change * (moment - since))
        change = speed - e * change
        speed, since = e * speed, moment
        moment += 2.0 * speed / g
    return np.array([by_h, by_e + change * (t - since), 0.0, change])


def stepped_differences(rule: ImpactRule, h, e, g, dt, steps, apart):
    """Return (y, v, ∂y/∂h, ∂y/∂e, ∂v/∂h, ∂v/∂e) by central differences of balls that fall step by step, or None.

    The differences are over 2 `apart`.  None where round-off decides in which step a ball hits, so that no
    difference is determined.
    """
    moved = ((0.0, 0.0), (apart, 0.0), (-apart, 0.0), (0.0, apart), (0.0, -apart))
    ends = [dropped(rule, h + a, 0.0, g, e + b, dt, steps) for a, b in moved]
    if any(ways is None or len(ways) != 1 for ways in ends):
        return None
    here, up, down, more, less = (np.array(ways[0][:2]) for ways in ends)
    by_h, by_e = (up - down) / (2.0 * apart), (more - less) / (2.0 * apart)
    return np.array([*here, by_h[0], by_e[0], by_h[1], by_e[1]])


# ---------------------------------------------------------------------------------------------- a ball over planes

class Plane(NamedTuple):
    """A plane without friction."""
    n: np.ndarray            # (d,) unit normal
    point: np.ndarray        # (d,) on it [m]
    e: complex               # restitution


def first_root(gap, rate, curve):
    """Return the first t > 0 with  gap + rate t + ½ curve t² = 0  that crosses downwards, or ∞; numbers may be complex.

    A ball that leaves the plane has gap 0, and the root 0 is not a new impact.
    """
    if gap.real <= 1e-12 and rate.real > 0.0:
        return -2.0 * rate / curve if curve.real < 0.0 else np.inf
    if curve == 0.0:
        return -gap / rate if rate.real < 0.0 else np.inf
    D = rate * rate - 2.0 * curve * gap
    if D.real <= 0.0:
        return np.inf
    root = (-rate - np.sqrt(D)) / curve
    return root if root.real > 0.0 else np.inf


def bounced_flight(x, v, duration, gravity, planes):
    """Return (x, v, planes that were hit) of a ball after a flight; any number may be complex, and then x and v are."""
    x, v, left, hit = np.asarray(x) + 0j, np.asarray(v) + 0j, duration + 0j, []
    while True:
        times = [first_root((x - plane.point) @ plane.n, v @ plane.n, gravity @ plane.n) for plane in planes]
        k = int(np.argmin([np.real(t) for t in times])) if planes else 0
        if not planes or np.real(times[k]) >= left.real:
            return x + left * v + 0.5 * left**2 * gravity, v + left * gravity, hit
        t, n = times[k], planes[k].n
        x, v, left = x + t * v + 0.5 * t**2 * gravity, v + t * gravity, left - t
        v = v - (1.0 + planes[k].e) * (v @ n) * n
        hit.append(k)


def by_complex_numbers(f: Callable, s):
    """Return (f(s), ∂f/∂s (…, m)) of an analytic f of inputs (m,), each column from one value at a complex input."""
    s = np.asarray(s, dtype=float)
    columns = [np.imag(f(s + 1j * TINY * unit)) / TINY for unit in np.eye(s.size)]
    return np.real(f(s + 0j)), np.stack(columns, axis=-1)


def newton(f, s, most):
    """Return [(s, |f|), …] of Newton's method, the start first; whole steps, with derivatives by complex numbers."""
    ways = []
    for _ in range(most + 1):
        r, J = by_complex_numbers(f, s)
        ways.append((s, np.linalg.norm(r)))
        s = s - np.linalg.solve(J, r)
    return ways
