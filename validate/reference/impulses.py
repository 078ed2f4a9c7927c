"""Impacts for the engines, and reference solutions for the scenes of lesson 7.

Neither engine solves for the time of an impact: it reflects a body that overlaps at the end of a step.  Both
are therefore late by up to one step, depending on where in the step the impact falls.  For that reason each scene
runs COPIES of itself with staggered starts.

pybullet creates contacts before bodies touch, and loses the approach velocity in the gap, unless
contactProcessingThreshold is 0.  It also pushes overlapping bodies apart, which adds speed, unless contactERP is 0.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from ..scene import ROUND_OFF

# why no theory predicts the error of a method that finds the time of an impact within a step
ONLY_ROUND_OFF = "exact: only round-off is left, and the limit bounds it"
COPIES = 16
APART = 10.0                 # distance between copies in an engine's world [m]: they never touch
GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
# steps by which an impact may be late: it is detected at the end of a step, and the fall before it is off by ½ dt,
# because its height is ½ g t dt off at v = g t
LATE = 1.5


def delays(window):
    """Return (COPIES,) start delays [s] between 0 and window, each at a different phase of a step.

    The first is slightly above 0, where round-off would decide in which step an impact is detected.
    """
    return window * np.mod(GOLDEN * (0.001 + np.arange(COPIES)), 1.0)


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
    The pseudo-inverse solves one linear system for all points.  With more points than a body has degrees of freedom
    the impulses are not unique, but their effect is.
    """
    M = inverse_matrix(m, inv_inertia)
    D = np.eye(3) if rough else n[None]
    G = np.concatenate([D @ point_rows(arm) for arm in r])
    wanted = np.concatenate([D @ (-e * (n @ u) * n - u) for u in (point_rows(arm) @ y for arm in r)])
    return y + M @ G.T @ (np.linalg.pinv(G @ M @ G.T, rcond=1e-11, hermitian=True) @ wanted)


def each_in_turn(m, inv_inertia, y, r, n, e, rough):
    """Return the same with the points in sequence, each once, on the velocities after the previous one: another law."""
    for arm in r:
        u = point_rows(arm) @ y
        if u @ n < 0.0:
            y = all_at_once(m, inv_inertia, y, [arm], n, e, rough)
    return y


# ---------------------------------------------------------------------------------------------- a soft floor

def soft_bounce(height, speed, t, g, omega, zeta):
    """Return (height, speed) after t of a ball over a floor that is a spring with a damper and never pulls.

    In the air the motion is a parabola.  Inside,  z̈ = −2ζω ż − ω² z,  z = y + g/ω²,  until  ω² y + 2ζω ẏ = 0,
    where the floor would begin to pull.
    """
    y, v = height, speed
    sigma, delta = omega * np.sqrt(1.0 - zeta * zeta), omega * zeta
    rest = g / omega**2
    while True:
        flight = (v + np.sqrt(v * v + 2.0 * g * max(y, 0.0))) / g if y >= 0.0 or v > 0.0 else 0.0
        # it leaves from below the surface, where the floor stops pushing
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
            return inside(t)                                             # it stays in contact
        until = brentq(push, times[pulls - 1] if pulls else 0.0, times[pulls], xtol=1e-15)
        if until >= t:
            return inside(t)
        t, (y, v) = t - until, inside(until)


# ---------------------------------------------------------------------------------------------- balls, step by step

CLOSE_CALL = 1e-12           # fraction of a flight's steps below which round-off decides whether the last one hits [-]
MOST_WAYS = 64               # largest number of outcomes of close calls
PYMUNK_SLOP = 1e-5           # overlap that pymunk leaves [m]
PYMUNK_BIAS = float(np.float32(0.9)) ** 60     # fraction of an overlap that remains after a second; 0.9 has 32 bits [-]


class ImpactRule(NamedTuple):
    """The treatment of impacts by a method or an engine.  Its step adds a push to the position of the next step."""
    ahead: float             # 1: positions take the new velocity, −1: the old one
    step: Callable           # of a ball above a floor, (y, v, push, g, e, dt) → (y, v, push [m], whether it hit)
    at_end: bool             # it bounces at the end of the step that finds an overlap; False: at the start of the next
    share: Callable          # (dt) → share of an overlap of two discs that it takes back per step [-]
    slop: float = 0.0        # overlap that it leaves [m]
    later: bool = False      # it takes an overlap back during the next step; False: at once


def set_on_floor(y, v, push, g, e, dt):
    """Take a step of the lesson: fall with the new velocity; if that ends below the floor, bounce and restart on it."""
    v = v - g * dt
    y = y + v * dt
    hits = y < 0.0 and v < 0.0
    return max(y, 0.0), -e * v if hits else v, 0.0, hits


def hit_then_fall(y, v, push, g, e, dt):
    """Take a step of pybullet: reverse the velocity of a ball that overlaps, times e, before gravity acts.

    Then move.
    """
    hits = y < 0.0 and v < 0.0
    new = max(v - g * dt, max(-e * v, 0.0)) if y < 0.0 else v - g * dt
    return y + new * dt, new, 0.0, hits


def fall_then_hit(y, v, push, g, e, dt):
    """Take a step of pymunk: move with the old velocity, and then bounce.

    An overlap beyond the slop shrinks by a correction of positions.
    """
    y = y + v * dt + push
    new, push, hits = v - g * dt, 0.0, y < 0.0 and v < 0.0
    if y < 0.0:
        new = max(new, -e * v)
        push = (1.0 - PYMUNK_BIAS**dt) * max(-y - PYMUNK_SLOP, 0.0)
    return y, new, push, hits


PROJECTING_RULE = ImpactRule(1.0, set_on_floor, True, lambda dt: 1.0)
BULLET_RULE = ImpactRule(1.0, hit_then_fall, False, lambda dt: 0.0)
CHIPMUNK_RULE = ImpactRule(-1.0, fall_then_hit, True, lambda dt: 1.0 - PYMUNK_BIAS**dt, PYMUNK_SLOP, True)


def flying_steps(y, v, g, dt, ahead):
    """Return [(number of steps from y ≥ 0 that end above the floor, 0)], or two such pairs if round-off decides.

    The second number of a pair is the small height [m] by which the ball must be lower to hit.
    After k steps the height is  y + k (v ∓ ½ g dt) dt − ½ g dt² k²,  − for new velocities, + for old ones.
    """
    rise, curve = (v - 0.5 * ahead * g * dt) * dt, g * dt * dt
    if rise <= 0.0 and y == 0.0:
        return [(0, 0.0)]
    if curve == 0.0:
        steps = y / -rise if rise < 0.0 else np.inf
    else:
        steps = (rise + np.sqrt(rise * rise + 2.0 * curve * y)) / curve
    if np.isinf(steps):
        return [(steps, 0.0)]
    if abs(steps - round(steps)) < CLOSE_CALL * (1.0 + steps) and round(steps) > 0:
        little = 2.0 * CLOSE_CALL * (1.0 + steps) * (abs(rise) + curve * steps)
        return [(round(steps), 0.0), (round(steps) - 1, little)]
    return [(int(steps), 0.0)]


def dropped(rule, y, v, g, e, dt, steps):
    """Return [(y, v, number of the step whose end detects the first impact)] of a ball.

    Each close call gives both outcomes.

    Many steps in the air are one parabola, so the time is proportional to the impacts and not to the steps.
    """
    open_runs, ends = [(y, v, 0.0, 0, np.inf)], []
    while open_runs:
        y, v, push, n, first = open_runs.pop()
        if y >= 0.0 and push == 0.0:
            ways = flying_steps(y, v, g, dt, rule.ahead)
        else:
            ways = [(0, 0.0)]
        if len(ends) + len(open_runs) > MOST_WAYS:
            return None
        for k, lower in ways:
            k = int(min(k, steps - n))
            height = y + k * (v - 0.5 * rule.ahead * g * dt) * dt - 0.5 * g * (dt * k) ** 2
            if n + k == steps:
                ends.append((height, v - k * g * dt, first))
                continue
            height = max(height, 0.0) - lower if k else height - lower
            now, speed, push_now, hits = rule.step(height, v - k * g * dt, push, g, e, dt)
            found = n + k + rule.at_end
            open_runs.append((now, speed, push_now, n + k + 1, min(first, found) if hits else first))
    return ends


def all_dropped(rule, y, v, g, e, dt, steps):
    """Return (runs (n, 3) of n balls as `dropped`, their possible errors (n, 3)); None if there are too many outcomes.

    If a close call leads to several ends, it returns the middle of them.
    """
    runs = [dropped(rule, *ball, g, e, dt, steps) for ball in zip(y, v)]
    if None in runs:
        return None
    low, high = np.array([np.min(run, axis=0) for run in runs]), np.array([np.max(run, axis=0) for run in runs])
    with np.errstate(invalid="ignore"):                                                 # a ball that never hits: ∞
        return np.where(low == high, low, 0.5 * (low + high)), np.where(low == high, 0.0, 0.5 * (high - low))


def pushed(y, v, g, stiffness, damping, dt, steps):
    """Return (height, speed) of balls y, v (n,) over a soft floor by symplectic Euler, step by step."""
    for _ in range(steps):
        v = v + dt * (np.where(y < 0.0, np.maximum(0.0, -stiffness * y - damping * v), 0.0) - g)
        y = y + dt * v
    return y, v


def struck(rule, a, b, v, reach, m_a, m_b, e, dt, steps):
    """Return the end of two discs at a and b, complex numbers; b rests and a moves with v: (a, v_a, b, v_b).

    They first overlap at the end of a step, and bounce along the line of centres at that moment.  The lesson's step
    moves them apart at once, pybullet never, and pymunk moves them by a fraction of the overlap per step.  None if
    round-off decides in which step.
    """
    along = ((b - a) * v.conjugate()).real / abs(v)
    half = np.sqrt(reach**2 - abs(b - a) ** 2 + along**2)
    meets, leaves = (along - half) / abs(v) / dt, (along + half) / abs(v) / dt          # in steps
    if min(abs(t - round(t)) for t in (meets, leaves)) < 1e-9:
        return None
    n = int(meets) + 1
    if n > min(leaves, steps):
        return a + v * dt * steps, v, b, 0j
    a = a + v * dt * n
    share_a, share_b = (m / (m_a + m_b) for m in (m_b, m_a))
    normal = (a - b) / abs(a - b)
    closing = min((v * normal.conjugate()).real, 0.0)
    v_a, v_b = v - (1.0 + e) * share_a * closing * normal, (1.0 + e) * share_b * closing * normal
    share, wait = rule.share(dt), dt if rule.later else 0.0
    while n < steps and share:
        overlap = reach - abs(a - b) - rule.slop
        if overlap <= 0.0:
            break
        part = share * overlap * (a - b) / abs(a - b)
        a, b, n = a + share_a * part + wait * v_a, b - share_b * part + wait * v_b, n + rule.later
    return a + v_a * dt * (steps - n), v_a, b + v_b * dt * (steps - n), v_b


def passed_on(rule, x, v, reach, dt, steps):
    """Return [(x, v)] of equal balls in a row, x (n,), the first of which moves with v.

    Each close call gives both outcomes.

    Each impact passes v on at the end of the first step that ends with an overlap.  The lesson's step shares the
    overlap between the two at once, pybullet leaves it, and pymunk removes a fraction of it in the next step.  None if
    there are too many outcomes.
    """
    open_runs, ends = [(tuple(x), 0, 0)], []
    while open_runs:
        x, flies, n = open_runs.pop()
        if len(ends) + len(open_runs) > MOST_WAYS:
            return None
        ways = [(steps - n, False)]
        if flies + 1 < len(x):
            gap = (x[flies + 1] - x[flies] - reach) / (v * dt)
            whole = [round(gap), round(gap) + 1] if abs(gap - round(gap)) < 1e-9 else [int(gap) + 1]
            ways = {(min(max(k, 1), steps - n), max(k, 1) <= steps - n) for k in whole}
        for k, hits in ways:
            new = list(x)
            new[flies] += k * v * dt
            if not hits:
                ends.append((np.array(new), v * (np.arange(len(x)) == flies)))
                continue
            overlap = max(reach - (new[flies + 1] - new[flies]) - rule.slop, 0.0)
            back = 0.0 if rule.later and n + k == steps else 0.5 * (rule.share(dt) * overlap)
            new[flies], new[flies + 1] = new[flies] - back, new[flies + 1] + back
            open_runs.append((tuple(new), flies + 1, n + k))
    return ends


def rounded_steps(T, dt, size):
    """Return the relative round-off of a run of T/dt steps: a few spacings of floats per step, and some dozen."""
    return (2.0 * T / dt + 50.0) * ROUND_OFF * size
