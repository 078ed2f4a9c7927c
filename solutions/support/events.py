"""Given.  Find when something happens along a trajectory: a zero, an extremum, a release.

A trajectory gives times ts (n,), equally spaced, and a quantity at these times, values (n,).  Between two times the
quantity is a polynomial of degree 5.  It has the values at both ends, and there the slope and the curvature of the
polynomial of degree 6 through the seven nearest values.  So the pieces fit together up to the curvature, and a sign at
a sample is the same for both pieces: no event is lost or found twice where they meet.

The error is O(dt⁶) in values and zeros, and O(dt⁵) in the times of extrema.  So an event has the order of the method
that made the trajectory, for every method of the lessons, wherever it falls between the samples.  Near the first and
the last three samples fewer than eight samples per period are not enough.  The quantity must be smooth: an impact
between two times spoils the pieces around it.

A piece is kept as its six Bézier points b: it begins at b₀, ends at b₅, and changes its sign at most as often as they
do.  Pieces are halved until they do so once, and then bisected.
*Source:* de Casteljau's halving, and Descartes' rule of signs for Bézier points; G. Farin, Curves and Surfaces for
CAGD, chapters 5 and 6.
"""

import numpy as np

from ..checks import BadInput, finite_array, finite_number

POINTS = 7                   # through which slope and curvature are taken [-]: exact up to degree 6
ROUND_OFF = 2e-15            # of a sum of seven products over the sum of their sizes [-]: ten roundings
LARGEST = 1e300              # value [-]: sums of some differences of such values are finite
LAST = 4                     # forces from which a release is extrapolated [-]: to O(dt⁴), as the best methods have
HALVINGS = 60                # of an interval [-]: 2⁻⁶⁰ of a step is below the spacing of floats
NARROW = 2.0**-45            # width of a piece that is halved no further [steps]: a root of even order remains in it


def check_samples(ts, values, least):
    """Return (ts, values) in float64; raise BadInput unless they are equally spaced samples of one quantity."""
    ts, values = finite_array("a time t [s]", ts), finite_array("a value", values)
    if ts.ndim != 1 or ts.shape != values.shape or len(ts) < least:
        raise BadInput("shapes of times and values", (ts.shape, values.shape), f"give at least {least} of each")
    largest = np.max(np.abs(values))
    if largest > LARGEST:
        raise BadInput("the largest value", largest, "give values whose differences are finite")
    steps = np.diff(ts)
    uneven = np.abs(steps - steps[0]) > 1e-6 * steps[0]
    if not steps[0] > 0.0 or np.any(uneven):
        raise BadInput("a step between times [s]", steps[np.argmax(uneven)],
                       "give equally spaced, rising times: those of a trajectory")
    return ts, values


def checked_direction(direction):
    """Return the direction as a float; raise BadInput unless it is 1, −1 or 0."""
    direction = finite_number("direction of the event", direction)
    if direction not in (-1.0, 0.0, 1.0):
        raise BadInput("direction of the event", direction, "give 1 or −1, or 0 for both")
    return direction


# ---------------------------------------------------------------------------------------------- between the samples

def differentiation_matrix():
    """Return D (7, 7): D y is the derivative, at s = 0 … 6, of the polynomial through seven values y.

    *Source:* the barycentric formula; Berrut and Trefethen 2004, section 9.3.
    """
    s = np.arange(float(POINTS))
    gaps = s[:, None] - s + np.eye(POINTS)
    weight = 1.0 / np.prod(gaps, axis=1)
    D = weight / weight[:, None] / gaps
    np.fill_diagonal(D, 0.0)
    return D - np.diag(np.sum(D, axis=1))


def slopes_and_curvatures(values):
    """Return the first and second derivatives (n,) at all samples, per step and per step²; 0 for round-off."""
    n, D = np.arange(len(values)), differentiation_matrix()
    first = np.clip(n - POINTS // 2, 0, len(values) - POINTS)
    near = values[first[:, None] + np.arange(POINTS)] - values[:, None]          # so that a constant has no slope
    found = []
    for matrix in (D, D @ D):
        terms = matrix[n - first] * near
        total = np.sum(terms, axis=1)
        found.append(np.where(np.abs(total) > ROUND_OFF * np.sum(np.abs(terms), axis=1), total, 0.0))
    return found


def value_pieces(values):
    """Return the Bézier points (n − 1, 6) of the quantity between each two samples."""
    d, c = slopes_and_curvatures(values)
    y, d, c = values, d / 5.0, c / 20.0
    return np.stack((y[:-1], (y + d)[:-1], (y + 2.0 * d + c)[:-1], (y - 2.0 * d + c)[1:], (y - d)[1:], y[1:]), axis=1)


def slope_pieces(values):
    """Return the Bézier points (n − 1, 5) of the quantity's slope; their mean is the change over the step."""
    d, c = slopes_and_curvatures(values)
    begin, end = (d + 0.25 * c)[:-1], (d - 0.25 * c)[1:]
    middle = 5.0 * np.diff(values) - (d[:-1] + begin + end + d[1:])
    return np.stack((d[:-1], begin, middle, end, d[1:]), axis=1)


def value_at(ts, values, t):
    """Return the quantity at one time or at several times t [s] from the first to the last sample.

    At a sample it is the value of that sample.  The error is O(dt⁶).
    """
    ts, values = check_samples(ts, values, POINTS)
    t = finite_array("time t [s]", t)
    for one in t[(t < ts[0]) | (t > ts[-1])].ravel():
        raise BadInput("time t [s]", one, f"give a time from {ts[0]:g} to {ts[-1]:g}")
    n = np.clip(np.searchsorted(ts, t, "right") - 1, 0, len(ts) - 2)
    s, b = (t - ts[n]) / (ts[n + 1] - ts[n]), np.moveaxis(value_pieces(values)[n], -1, 0)
    while len(b) > 1:
        b = (1.0 - s) * b[:-1] + s * b[1:]
    return b[0]


# ---------------------------------------------------------------------------------------------- changes of sign

def halves(b):
    """Return the Bézier points of the first and of the second half of a piece; b is a list."""
    first, second = [b[0]], [b[-1]]
    while len(b) > 1:
        b = [0.5 * (b[k] + b[k + 1]) for k in range(len(b) - 1)]
        first.append(b[0])
        second.append(b[-1])
    return first, second[::-1]


def signs_of(b):
    """Return whether they are positive, of the Bézier points that are not zero."""
    return [p > 0.0 for p in b if p != 0.0]


def simple_parts(b, low, high):
    """Return [(b, low, high)], a piece in parts in which the Bézier points change their sign once at most."""
    signs = signs_of(b)
    changes = sum(signs[k] != signs[k + 1] for k in range(len(signs) - 1))
    if changes <= 1 or high - low < NARROW:
        return [(b, low, high)]
    (first, second), middle = halves(b), 0.5 * (low + high)
    return simple_parts(first, low, middle) + simple_parts(second, middle, high)


def bisected(b, low, high):
    """Return where in [low, high] a part changes its sign."""
    rises = signs_of(b)[-1]
    for _ in range(HALVINGS):
        (first, second), middle = halves(b), 0.5 * (low + high)
        if (first[-1] > 0.0) == rises:
            b, high = first, middle
        else:
            b, low = second, middle
    return 0.5 * (low + high)


def sign_changes(pieces, direction):
    """Return (n, s), each (k,): piece n changes its sign at s, from 0 to 1; rising with direction 1, falling with −1.

    Zeros have no sign.  Where all is zero for a while, the change is at the beginning of that.
    """
    found, before, reached = [], None, (0, 0.0)
    for n, piece in enumerate(pieces.tolist()):
        for b, low, high in simple_parts(piece, 0.0, 1.0):
            signs = signs_of(b)
            if not signs:
                continue
            if before is not None and signs[0] != before:
                found.append((*reached, signs[0]))
            if signs[-1] != signs[0]:
                found.append((n, bisected(b, low, high), signs[-1]))
            before, reached = signs[-1], (n, high)
    kept = [(n, s) for n, s, rises in found if direction in (0.0, 1.0 if rises else -1.0)]
    return np.array([n for n, _ in kept], dtype=int), np.array([s for _, s in kept])


# ---------------------------------------------------------------------------------------------- events

def zeros(ts, values, direction=0):
    """Return the times (k,) [s] at which a quantity changes its sign; rising with direction 1, falling with −1.

    A quantity that only touches zero does not change its sign, and neither does one that begins or ends there.  If it
    touches zero between two samples, the error O(dt⁶) decides whether it changes its sign twice or not at all.
    Raises BadInput for samples that are not equally spaced or not finite, and for any other direction.
    """
    ts, values = check_samples(ts, values, POINTS)
    n, s = sign_changes(value_pieces(values), checked_direction(direction))
    return ts[n] + s * (ts[n + 1] - ts[n])


def extrema(ts, values, direction=0):
    """Return (times (k,) [s], values (k,)) of a quantity's extrema; maxima with direction 1, minima with −1.

    An extremum is where the slope changes its sign, so one at an end does not count.  A quantity that is constant but
    for round-off has the extrema of its round-off.
    Raises BadInput as zeros does.
    """
    ts, values = check_samples(ts, values, POINTS)
    n, s = sign_changes(slope_pieces(values), -checked_direction(direction))
    times = ts[n] + s * (ts[n + 1] - ts[n])
    return times, value_at(ts, values, times)


def release(ts, forces):
    """Return the time [s] at which a support first ceases to push; inf if it never does.

    A support can push and cannot pull, so what follows is another motion.  There are two kinds of forces:
    A formula gives the force that would hold the contact, which becomes negative: the release is its first falling
    zero.
    A loop gives the impulse J of each step.  J/dt is the force that holds the contact, or 0 where that would pull.  It
    is never negative, so the zero lies between the last force above 0 and the first that is 0.  There the polynomial
    through the last four forces above 0 continues them, with an error of O(dt⁴).  Where that stays positive, as where
    a support ends, the release is at the first force that is 0.

    Forces of steps need the times to which they belong.  contact_step_2d of lesson 10 takes the loads at the beginning
    of a step, so J/dt is the force there, to second order if the run has a leapfrog start: v half a step before x.
    """
    ts, forces = check_samples(ts, forces, 2)
    if np.any(forces < 0.0):
        return min(zeros(ts, forces, -1), default=np.inf)
    ends = np.flatnonzero((forces[:-1] > 0.0) & (forces[1:] == 0.0))
    if len(ends) == 0:
        return np.inf
    end = ends[0]
    first = max(np.flatnonzero(forces[:end] == 0.0).max(initial=-1) + 1, end - LAST + 1)
    return ts[end] + last_zero(forces[first:end + 1]) * (ts[end + 1] - ts[end])


def last_zero(forces):
    """Return where, from 0 to 1 step after the last force, the polynomial through all of them is zero; 1 if nowhere."""
    s = np.arange(1.0 - len(forces), 1.0)
    c, low, high = np.linalg.solve(np.vander(s), forces), 0.0, 1.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if np.polyval(c, middle) > 0.0 else (low, middle)
    return high
