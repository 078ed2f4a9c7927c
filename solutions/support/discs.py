"""Given.  Discs or balls that collide without friction: when they meet, and how they are moved apart."""

import numpy as np

from ..checks import float_copy


def meeting_time(x, v, i, j, reach, dt):
    """Given.  Return the time [s] until two round bodies i and j meet, at most dt; reach [m] is the sum of their radii.

    |Δx + τ Δv| = reach, with decreasing distance.  Bodies that overlap and approach meet now.
    The loop over coordinates is for speed: this runs for every pair.
    """
    closing, apart, speed = 0.0, -reach * reach, 0.0
    for k in range(x.shape[1]):
        dx, dv = x[i, k] - x[j, k], v[i, k] - v[j, k]
        closing -= dx * dv
        apart += dx * dx
        speed += dv * dv
    apart = np.maximum(0.0, apart)
    squared = closing * closing - speed * apart
    if closing > 0.0 and squared >= 0.0:
        return min(dt, apart / (closing + np.sqrt(squared)))
    return dt


def overlap(x, i, j, reach):
    """Given.  Return whether two round bodies are closer than the sum of their radii, reach [m]."""
    squared = 0.0
    for k in range(x.shape[1]):
        squared += (x[i, k] - x[j, k]) ** 2
    return squared < reach * reach


def normal_between(x, i, j):
    """Given.  Return (distance [m], unit normal (d,) from disc j to i); the first axis where the centres coincide."""
    n = x[i] - x[j]
    distance = np.sqrt(n @ n)
    if distance == 0.0:
        n[0] = 1.0
        return 0.0, n
    return distance, n / distance


def separated(x, i, j, p):
    """Given.  Return (x_i, x_j), each (d,): two discs moved apart along their normal until they no longer overlap.

    The lighter one moves farther.  Only positions change: discs that start inside each other are separated without
    gaining speed.
    """
    distance, n = normal_between(x, i, j)
    share = np.maximum(0.0, p.radius[i] + p.radius[j] - distance) / (p.inv_mass[i] + p.inv_mass[j])
    return x[i] + share * p.inv_mass[i] * n, x[j] - share * p.inv_mass[j] * n


def drift(x, v, dt):
    """Given.  Return x + dt v, body by body: compiled loops over short rows cost less than two-dimensional arrays."""
    x = float_copy(x)
    for k in range(x.shape[0]):
        x[k] += dt * v[k]
    return x
