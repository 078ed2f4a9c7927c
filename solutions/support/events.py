"""Given.  Find when something happens along a trajectory: a zero, an extremum, a release.

A trajectory gives times ts (n,), equally spaced, and a quantity at these times, values (n,).  Between the times the
quantity is the polynomial of degree 5 through the six nearest values, whose error is O(dt⁶).  So an event has the
order of the method that made the trajectory, for every method of the lessons.  The quantity must be smooth: an impact
between two times spoils the polynomials around it.

*Source:* E. Hairer, S. P. Nørsett, G. Wanner, Solving Ordinary Differential Equations I, section II.6.
"""

import numpy as np

from ..checks import BadInput, finite_array

POINTS = 6                   # of a polynomial [-]: its error, O(dt⁶), is below that of any method of the lessons
HALVINGS = 60                # of an interval [-]: 2⁻⁶⁰ of a step is below the spacing of floats


def check_samples(ts, values):
    """Return (ts, values) in float64; raise BadInput unless they are equally spaced samples of one quantity."""
    ts, values = finite_array("times ts [s]", ts), finite_array("values", values)
    if ts.ndim != 1 or ts.shape != values.shape or len(ts) < POINTS:
        raise BadInput("shapes of times and values", (ts.shape, values.shape), f"give at least {POINTS} of each")
    steps = np.diff(ts)
    if not (steps[0] > 0.0 and np.all(np.abs(steps - steps[0]) <= 1e-6 * steps[0])):
        raise BadInput("times ts", ts, "give equally spaced, rising times: those of a trajectory")
    return ts, values


def interpolant(values, n):
    """Return (c (6,), first): Σ cₖ sᵏ passes through the six values nearest to interval n; s is 0 at number `first`."""
    first = min(max(n - POINTS // 2 + 1, 0), len(values) - POINTS)
    s = np.arange(POINTS, dtype=float)
    return np.linalg.solve(np.vander(s, increasing=True), values[first:first + POINTS]), first


def bisected(c, low, high):
    """Return the s in [low, high] at which Σ cₖ sᵏ changes its sign."""
    rising = np.polyval(c[::-1], high) > 0.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if (np.polyval(c[::-1], middle) > 0.0) == rising:
            high = middle
        else:
            low = middle
    return 0.5 * (low + high)


def zeros(ts, values, direction=0):
    """Return the times (k,) [s] at which a quantity changes its sign; rising with direction 1, falling with −1.

    A value that is zero counts as positive.  Two changes within one step cancel: they are not seen.
    """
    ts, values = check_samples(ts, values)
    positive, found = values >= 0.0, []
    for n in np.flatnonzero(positive[1:] != positive[:-1]):
        if direction == 0 or direction == (1 if positive[n + 1] else -1):
            c, first = interpolant(values, n)
            found.append(ts[first] + (ts[1] - ts[0]) * bisected(c, n - first, n + 1.0 - first))
    return np.array(found)


def extrema(ts, values, direction=0):
    """Return (times (k,) [s], values (k,)) of a quantity's extrema; maxima with direction 1, minima with −1.

    An extremum is where the derivative of the polynomial changes its sign, so one at an end does not count.
    """
    ts, values = check_samples(ts, values)
    times, tops = [], []
    for n in range(len(ts) - 1):
        c, first = interpolant(values, n)
        slope = c[1:] * np.arange(1.0, POINTS)
        low, high = n - first, n + 1.0 - first
        falls = np.polyval(slope[::-1], low) > 0.0
        if falls != (np.polyval(slope[::-1], high) > 0.0) and (direction == 0 or direction == (1 if falls else -1)):
            s = bisected(slope, low, high)
            times.append(ts[first] + (ts[1] - ts[0]) * s)
            tops.append(np.polyval(c[::-1], s))
    return np.array(times), np.array(tops)


def release(ts, forces):
    """Return the time [s] at which a support first ceases to push: the force falls through zero; inf if it never does.

    A support can push and cannot pull, so what follows is another motion.
    """
    found = zeros(ts, forces, -1)
    return found[0] if len(found) else np.inf
