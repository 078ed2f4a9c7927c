"""Impacts for the engines, and reference solutions for the scenes of lesson 7.

Neither engine solves for the time of an impact: a body that overlaps at the end of a step is reflected then.  Both
are therefore late by up to one step, depending on where in the step the impact falls.  For that reason each scene
runs COPIES of itself with staggered starts.

pybullet creates contacts before bodies touch, and loses the approach velocity in the gap, unless
contactProcessingThreshold is 0.  It also pushes overlapping bodies apart, which adds speed, unless contactERP is 0.
"""

import numpy as np
from scipy.optimize import brentq

COPIES = 16
APART = 10.0                 # distance between copies in an engine's world [m]: they never touch
GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
# steps by which an impact may be late: it is detected at the end of a step, and the fall before it is ½ dt off,
# because its height is ½ g t dt off at v = g t
LATE = 1.5


def delays(window):
    """Return (COPIES,) start delays [s] between 0 and window: no two fall on the same phase of a step."""
    return window * np.mod(GOLDEN * np.arange(COPIES), 1.0)


# ---------------------------------------------------------------------- several points at once, by linear algebra

def point_rows(r):
    """Return (3, 6): v + ω × r as a matrix on (v, ω)."""
    return np.hstack((np.eye(3), np.stack([np.cross(axis, r) for axis in np.eye(3)], axis=1)))


def inverse_matrix(m, inv_inertia):
    """Return (6, 6): the inverse masses that act on impulses and their moments."""
    M = np.zeros((6, 6))
    M[:3, :3], M[3:, 3:] = np.eye(3) / m, inv_inertia
    return M


def all_at_once(m, inv_inertia, y, r, n, e, rough):
    """Return (v, ω) after an impact at the points r of a body that had y = (v, ω) before.

    Every point leaves with −e times its own normal velocity:
        smooth    n · u⁺ = −e n · u  at every point, impulses along n
        rough     u⁺ = −e (n · u) n, impulses in any direction
    One linear system for all points, solved by the pseudo-inverse.  With more points than a body has degrees of
    freedom the impulses are not unique, but their effect is.
    """
    M = inverse_matrix(m, inv_inertia)
    D = np.eye(3) if rough else n[None]
    G = np.concatenate([D @ point_rows(arm) for arm in r])
    wanted = np.concatenate([D @ (-e * (n @ u) * n - u) for u in (point_rows(arm) @ y for arm in r)])
    return y + M @ G.T @ (np.linalg.pinv(G @ M @ G.T, rcond=1e-11, hermitian=True) @ wanted)


def each_in_turn(m, inv_inertia, y, r, n, e, rough):
    """Return the same with the points in sequence, each once, on the body as the previous one left it: another law."""
    for arm in r:
        u = point_rows(arm) @ y
        if u @ n < 0.0:
            y = all_at_once(m, inv_inertia, y, [arm], n, e, rough)
    return y


# ---------------------------------------------------------------------------------------------- a soft floor

def soft_bounce(height, speed, t, g, omega, zeta):
    """Return (height, speed) after t of a ball over a floor that is a spring and a damper and never pulls.

    In the air a parabola; inside  z̈ = −2ζω ż − ω² z,  z = y + g/ω²,  until  ω² y + 2ζω ẏ = 0,  where the floor
    would begin to pull.
    """
    y, v = height, speed
    sigma, delta = omega * np.sqrt(1.0 - zeta * zeta), omega * zeta
    rest = g / omega**2
    while True:
        flight = (v + np.sqrt(v * v + 2.0 * g * max(y, 0.0))) / g if y >= 0.0 or v > 0.0 else 0.0
        # it leaves from below, where the floor has stopped pushing
        if y < 0.0:
            flight = (v + np.sqrt(v * v + 2.0 * g * y)) / g
        if flight >= t:
            return y + v * t - 0.5 * g * t * t, v - g * t
        t, y, v = t - flight, 0.0, v - g * flight
        z, B = rest, (v + delta * rest) / sigma

        def inside(s, z=z, B=B):
            wave = np.exp(-delta * s)
            c, d = np.cos(sigma * s), np.sin(sigma * s)
            place = wave * (z * c + B * d)
            return place - rest, wave * (sigma * (B * c - z * d) - delta * (z * c + B * d))

        def push(s):
            place, rate = inside(s)
            return -(omega**2 * place + 2.0 * delta * rate)
        times = np.linspace(0.0, np.pi / sigma, 65)[1:]
        pulls = next((k for k, s in enumerate(times) if push(s) < 0.0), None)
        if pulls is None:
            return inside(t)                                             # it stays
        until = brentq(push, times[pulls - 1] if pulls else 0.0, times[pulls], xtol=1e-15)
        if until >= t:
            return inside(t)
        t, (y, v) = t - until, inside(until)
