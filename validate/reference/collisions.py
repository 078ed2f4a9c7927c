"""Reference solutions of lesson 6: distances, impacts and pairs.

Nothing here uses the functions of `solutions`.  Distances of convex bodies are least-squares problems with non-negative
weights (SciPy's nnls), first roots are found by SciPy's brentq, and pairs by a NumPy comparison of all boxes.
"""

from typing import Annotated, NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, nnls
from scipy.spatial import ConvexHull

from ..check import states
from ..scene import Prediction

# why no theory predicts the error of a method with a closed form
ONLY_ROUND_OFF = "exact: only round-off is left, and the limit bounds it"
COPIES = 16                  # balls per run, so that their impacts fall on all phases of a step
SPEEDS = {"1 m/s": 1.0, "10 m/s": 10.0, "100 m/s": 1e2, "1,000 m/s": 1e3, "10,000 m/s": 1e4}     # of the balls
GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
UNCERTAINTY = 1e-13          # of brentq, times the 7,000 m that the fastest balls have travelled; relative [-]
EARLIEST, SPREAD = 0.3, 0.4  # range of the impacts, as shares of the output time


class Balls(NamedTuple):
    """Balls that fly at an obstacle."""
    speed: Annotated[float, "of the balls [m/s]"] = 1.0
    r: Annotated[float, "their radius [m]"] = 0.1
    R: Annotated[float, "of the cylinder about the x axis [m]; 0: the plane z = 0"] = 0.0


def at_speeds(R):
    """Return {name: Balls} of the cases; R: radius of the cylinder [m], 0 for a plane."""
    return {name: Balls(speed, R=R) for name, speed in SPEEDS.items()}


def impact_times(T):
    """Return the time of each copy's impact [s]: EARLIEST + SPREAD {k φ} of T, φ the golden section.

    These times are spread evenly over the phases of a step of any length.
    """
    return T * (EARLIEST + SPREAD * ((np.arange(COPIES) + 1.0) * GOLDEN % 1.0))


def impact_claim(x, v, end, T):
    """Return the check that balls (x, v), which end at end (n, 2), y and z, have moved straight until impact_times."""
    return states("times of impact [s]", (end[:, 1] - x[:, 2]) / v[:, 2], impact_times(T), 1e-14)


def with_balls_that_miss(x, v, target):
    """Return the state with as many balls again, a kilometre away, which never hit; a broad phase would skip them."""
    aside = np.array([0.0, 1.0, 0.0])
    more = np.linalg.norm(v[0]) * np.tile(aside, (COPIES, 1))
    return np.concatenate((x, x + 1e3 * np.array([0.0, 1.0, 1.0]))), np.concatenate((v, more)), target


def first_root(gap, t_0, t_1):
    """Return the time between t_0 (gap positive) and t_1 (gap negative) at which gap(t) is zero, to the last digit."""
    return brentq(gap, t_0, t_1, xtol=1e-300, rtol=4.0 * np.finfo(float).eps)


def moments(x, v, gap, latest):
    """Return the times (n,) at which gap(position) becomes zero for balls that move in a straight line.

    The gap is positive at the start and negative at `latest`, a time for each ball; a ball with latest 0 never touches.
    """
    touches = lambda y, w, last: first_root(lambda s: gap(y + s * w), 0.0, last) if last > 0.0 else np.inf
    return np.array([touches(y, w, last) for y, w, last in zip(x, v, latest)])


def stopped(x, v, gap, latest, t):
    """Return y and z of all balls at t, in one row: they move in a straight line and stop when gap(position) is zero.

    gap and latest as in `moments`.  *Source:* x₀ + v min(t, t*), t* the root, by brentq.
    """
    return np.ravel((x + np.minimum(t, moments(x, v, gap, latest))[:, None] * v)[:, 1:])


def found_after(enters, leaves, dt, T):
    """Return the times (n,) at which balls stop if they are tested after each step; None if round-off decides.

    This is the first multiple of dt between the times at which a ball enters its target and leaves it again.  If
    there is no such multiple, the ball flies on until T.
    """
    steps = enters / dt
    if np.any(np.abs(steps - np.round(steps)) < 1e-9):
        return None
    found = dt * np.ceil(steps)
    return np.where(found < leaves, np.minimum(found, T), T)


class Sweep(NamedTuple):
    """How an engine sweeps a ball along its path in a step."""
    radius: float            # of the ball that it sweeps [m]
    near: float              # of a ball that touches where it gives contact points: it sweeps nothing that has any [m]
    least: float             # way along the normal in the step: it ignores what comes nearer by less [m]

    def hits(self, p, dt, when):
        """Return the times (n,) at which balls stop by a sweep, ∞ where none does; when as in detection_errors."""
        enters, seen, h = when(p, self.radius)[0], when(p, self.near)[0], 1e-6 * self.radius
        with np.errstate(invalid="ignore"):              # of a ball that never touches
            nearer = h * dt / (when(p, self.radius - h)[0] - enters)     # gap = 0 gives  d(enters)/dr = −1/(speed)
            return np.where((seen > dt * np.floor(enters / dt)) & (nearer > self.least), enters, np.inf)


def detection_errors(T, place, when, band, swept=None):
    """Return the field `predicted` of a runner whose balls move in a straight line and stop when contact is detected.

    place(p) → (x, v), each (n, 3)    when(p, r) → the times at which balls of radius r enter and leave the target
    band(p, dt) → as in Prediction    swept(p, dt) → Sweep of an engine, None for a step that is not swept
    """
    def predicted_error(p, dt):
        """The time of each impact is known, and so is its phase in a step.

        A test after each step detects a ball at the first multiple of dt at which it is inside.  It misses a ball that
        has left by then.  A swept ball also stops where its smaller sphere touches, if that is earlier in the step.
        """
        v, (enters, leaves) = place(p)[1], when(p, p.r)
        found = found_after(enters, leaves, dt, T)
        if found is None:
            return None
        if swept is not None and (sweep := swept(p, dt)) is not None:
            found = np.minimum(found, sweep.hits(p, dt, when))
        error = (found - np.minimum(enters, T))[:, None] * v
        return Prediction(np.ravel(error[:, 1:]), band(p, dt))

    return predicted_error


def rounded_way(x, v, t, dt):
    """Return the largest error [m] (n,) of balls (x, v), each (n, d), that add v dt until t (n,), along d axes.

    Each sum is rounded by half the spacing of floats at its value, and v dt by half the spacing at its own.
    """
    k = np.arange(1, int(np.ceil(np.max(t) / dt)) + 1)
    along = 0.5 * np.spacing(np.abs(x[..., None] + dt * k * v[..., None])) + 0.5 * np.spacing(np.abs(dt * v))[..., None]
    return np.linalg.norm(np.sum(np.where(dt * k <= np.asarray(t)[:, None, None], along, 0.0), axis=-1), axis=-1)


def hull_nearest(a, b, weight=1e3):
    """Return (p, q), the nearest points of the hulls of a (k, d) and b (m, d).

    They minimise |Σ α a − Σ β b| over α, β ≥ 0 with Σ α = Σ β = 1.  The two sums enter as rows with the given
    weight, a penalty that leaves a relative error of about 1/weight².  That answer is only the start.  The points
    with a non-zero weight span flat parts of the two bodies, and the nearest points of these solve a linear system
    exactly.
    *Source:* Lawson and Hanson 1974, chapter 23.
    """
    one, none = np.ones(len(a)), np.zeros(len(a))
    sums = np.vstack((np.hstack((one, np.zeros(len(b)))), np.hstack((none, np.ones(len(b))))))
    rows = np.vstack((np.hstack((a.T, -b.T)), weight * sums))
    shares, _ = nnls(rows, np.append(np.zeros(a.shape[1]), [weight, weight]))
    p, q = a[shares[:len(a)] > 1e-9], b[shares[len(a):] > 1e-9]
    span = np.vstack((p[1:] - p[0], q[0] - q[1:]))
    c = np.linalg.lstsq(span.T, q[0] - p[0], rcond=None)[0] if len(span) else np.zeros(0)
    split = len(p) - 1
    return p[0] + c[:split] @ (p[1:] - p[0]), q[0] + c[split:] @ (q[1:] - q[0])


def depth_of(a, b):
    """Return (gap, n) of two overlapping hulls, n from b to a: the nearest face of the hull of all differences a − b.

    *Source:* the Minkowski difference; SciPy's ConvexHull (Qhull) gives its faces n · y + offset = 0.
    """
    faces = ConvexHull((a[:, None] - b[None]).reshape(-1, a.shape[1])).equations
    nearest = faces[np.argmax(faces[:, -1])]
    return float(nearest[-1]), -nearest[:-1]


def all_touching(low, high):
    """Return the pairs (m, 2), i < j, of boxes low, high (n, d) that have a common point, by comparing all pairs."""
    found = []
    for first in range(0, len(low), 500):
        part = slice(first, first + 500)
        i, j = np.nonzero(np.all((low[part, None] <= high[None]) & (low[None] <= high[part, None]), axis=2))
        found.append(np.stack((i + first, j), axis=1)[i + first < j])
    return np.concatenate(found)


# ---------------------------------------------------------------------------------------------- steering past a disc

def held_steering(distance, offset):
    """Return (closest approach over the radius, last speed over the first) of a body that keeps its acceleration.

    In radii, with speed 1: along = t − distance, across = offset + ½ a t², a = 2 (1 − offset)/distance².  The square
    of the distance is least where  (t − distance) + (offset + ½ a t²) a t = 0.
    """
    a = 2.0 * (1.0 - offset) / distance**2
    t = brentq(lambda t: t - distance + (offset + 0.5 * a * t * t) * a * t, 0.0, distance, xtol=1e-15)
    return np.hypot(t - distance, offset + 0.5 * a * t * t), np.hypot(1.0, a * distance)


def anew_steering(distance, offset):
    """Return the closest approach over the radius of a body that computes its acceleration anew at every moment.

    In the frame of its velocity the centre is A ahead and B beside.  The velocity turns at the rate a, so
    dA/dt = −1 − a B and dB/dt = a A, with a = 2 (1 − B)/A².  Eliminating time gives an equation for B(A), which is
    integrated to A = 0, where the body is abreast of the centre.
    """
    slope = lambda s, B: 2.0 * (1.0 - B) * (distance - s) / ((distance - s) ** 2 + 2.0 * B * (1.0 - B))
    return solve_ivp(slope, (0.0, distance), [offset], method="DOP853", rtol=1e-12, atol=1e-14).y[0, -1]
