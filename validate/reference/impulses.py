"""Impacts as the engines have them, and once more by other means: what the scenes of lesson 7 hold our impulses against.

Neither engine looks for the moment of an impact: what overlaps at the end of a step is turned round then.  So both are late by up to a
step, at a phase that no two impacts share.  That is why each scene holds COPIES of itself, which meet what they meet at as many phases.

pybullet creates contacts before bodies touch, and spends the approach in the gap, unless contactProcessingThreshold is 0; and it pushes
out what overlaps, which adds speed, unless contactERP is 0.
"""

import numpy as np
from scipy.optimize import brentq

COPIES = 16
APART = 10.0                 # distance between copies in an engine's world [m]: they never meet
GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
LATE = 1.5                   # steps by which an impact may be late: it is seen at the end of a step, and the fall before it, ½ g t dt off at v = g t, is ½ dt off


def delays(window):
    """(COPIES,) [s], between 0 and window: whatever the step is, no two of them are in the same phase of it."""
    return window * np.mod(GOLDEN * np.arange(COPIES), 1.0)


# ---------------------------------------------------------------------------------------------- several points at once, by linear algebra

def point_rows(r):
    """(3, 6): v + ω × r of (v, ω)."""
    return np.hstack((np.eye(3), np.stack([np.cross(axis, r) for axis in np.eye(3)], axis=1)))


def inverse_matrix(m, inv_inertia):
    """(6, 6): what impulses and their moments do to (v, ω)."""
    M = np.zeros((6, 6))
    M[:3, :3], M[3:, 3:] = np.eye(3) / m, inv_inertia
    return M


def all_at_once(m, inv_inertia, y, r, n, e, rough):
    """(v, ω) after an impact at the points r of a body that had y = (v, ω): every point leaves with −e times its own normal velocity.

    smooth:  n · u⁺ = −e n · u  at every point, impulses along n;      rough:  u⁺ = −e (n · u) n, impulses any.
    One linear system for all points, solved by the pseudo-inverse: with more points than a body has freedoms the impulses are not
    unique, but what they do is.
    """
    M = inverse_matrix(m, inv_inertia)
    D = np.eye(3) if rough else n[None]
    G = np.concatenate([D @ point_rows(arm) for arm in r])
    wanted = np.concatenate([D @ (-e * (n @ u) * n - u) for u in (point_rows(arm) @ y for arm in r)])
    return y + M @ G.T @ (np.linalg.pinv(G @ M @ G.T, rcond=1e-11, hermitian=True) @ wanted)


def each_in_turn(m, inv_inertia, y, r, n, e, rough):
    """The same with one point after the other, each once, as the one before has left the body: another law."""
    for arm in r:
        u = point_rows(arm) @ y
        if u @ n < 0.0:
            y = all_at_once(m, inv_inertia, y, [arm], n, e, rough)
    return y


# ---------------------------------------------------------------------------------------------- a soft floor

def soft_bounce(height, speed, t, g, omega, zeta):
    """(height, speed) after t of a ball over a floor that is a spring and a damper while it is pressed, and never pulls.

    In the air a parabola; inside  z̈ = −2ζω ż − ω² z,  z = y + g/ω²,  until  ω² y + 2ζω ẏ = 0,  where the floor would begin to pull.
    """
    y, v = height, speed
    sigma, delta = omega * np.sqrt(1.0 - zeta * zeta), omega * zeta
    rest = g / omega**2
    while True:
        flight = (v + np.sqrt(v * v + 2.0 * g * max(y, 0.0))) / g if y >= 0.0 or v > 0.0 else 0.0
        if y < 0.0:                                                      # it leaves from below, where the floor has stopped pushing
            flight = (v + np.sqrt(v * v + 2.0 * g * y)) / g
        if flight >= t:
            return y + v * t - 0.5 * g * t * t, v - g * t
        t, y, v = t - flight, 0.0, v - g * flight
        z, B = rest, (v + delta * rest) / sigma

        def inside(s):
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
