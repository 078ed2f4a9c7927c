"""Truths for the lesson on simulators, independent of it."""

import numpy as np
from scipy.integrate import solve_ivp

RTOL, ATOL = 1e-12, 1e-14


def rocking(half_width, half_height, g, lean, t):
    """Return (angle [rad], rate [rad/s], times and rates (before, after) of the impacts) of a uniform block at t.

    It is let go at `lean` on its left corner.  About a corner 4/3 m R² θ̈ = −m g R sin(α − θ), by DOP853 until the
    angle is zero; then the moment of momentum about the other corner stays: with the products of inertia written out,
        before:  I ω + m (h² − b²) ω,       after:  (I + m R²) ω⁺,       I = m R²/3
    *Source:* Housner 1963.
    """
    R2, alpha = half_width**2 + half_height**2, np.arctan2(half_width, half_height)
    kept = (R2 / 3.0 + half_height**2 - half_width**2) / (4.0 / 3.0 * R2)
    rate = 0.75 * g / np.sqrt(R2)

    def flat(_, y):
        return y[0]
    flat.terminal, flat.direction = True, -1.0
    now, y, side, impacts = 0.0, np.array([lean, 0.0]), 1.0, []
    while now < t:
        run = solve_ivp(lambda _, y: (y[1], -rate * np.sin(alpha - y[0])), (now, t), y, method="DOP853", rtol=RTOL,
                        atol=ATOL, events=flat)
        now, y = run.t[-1], run.y[:, -1]
        if run.status == 1:
            impacts.append((now, side * y[1], side * kept * y[1]))
            y, side = np.array([0.0, -kept * y[1]]), -side
    return side * y[0], side * y[1], impacts
