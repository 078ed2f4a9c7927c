"""Given.  Discs or balls that collide without friction: when they meet, and many steps of them."""

import numpy as np

from ..checks import (
    check_array,
    check_end,
    check_field,
    check_not_negative,
    check_restitution,
    checked_run,
    finite_number,
    float_copy,
)


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


def advance_discs(step, x, v, dt, steps, p):
    """Given.  Return (x, v), each (copies, bodies, d), of discs after `steps` steps; raises as advance_balls."""
    _, x, v, dt, steps = checked_run(0.0, x, v, dt, steps)
    check_array("position x [m]", x, 3)
    check_restitution(finite_number("restitution e [-]", p.e))
    for thing, values in (("radius of a disc [m]", p.radius), ("inverse mass of a disc [1/kg]", p.inv_mass)):
        check_field(thing, values, x.shape[1:2])
        check_not_negative(thing, values.min())
    x, v = x.copy(), v.copy()
    for k in range(x.shape[0]):
        x_k, v_k = x[k], v[k]
        for _ in range(steps):
            x_k, v_k = step(x_k, v_k, dt, p)
        x[k], v[k] = x_k, v_k
    check_end(x, v, dt)
    return x, v
