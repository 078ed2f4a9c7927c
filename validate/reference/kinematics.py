"""Planar arms by complex numbers, their reach, and an independent version of pybullet's inverse kinematics.

pybullet's calculateInverseKinematics repeats, at most 20 times by default,
    Δθ = (JᵀJ + d 1)⁻¹ Jᵀ e,     scaled so that no joint turns by more than π/4,     d = ½ without jointDamping
and ends after the iteration that began with a position error up to residualThreshold, 1e-4 by default.  The ½ is in m²
for an arm of any size, and the error of the orientation does not decide when it ends.
*Source:* Bullet, b3PhysicsServerCommandProcessor (processCalculateInverseKinematicsCommand) and IKTrajectoryHelper.
"""

from cmath import phase, rect
from functools import cache
from itertools import pairwise

import numpy as np

from ..scene import ROUND_OFF, Prediction

NUDGE = 1e-11                # of the angles at the start, to measure the growth of round-off [rad]
ASIDE = np.array([0.5, -0.4, -1.0])                      # a direction without symmetry
ROUNDINGS = 30.0             # error of the angles per iteration, in spacings of floats [-]
SURE = 0.1                   # a band above this fraction of the tolerance is no prediction [-]
DAMPING, LARGEST, ITERATIONS, THRESHOLD = 0.5, 0.25 * np.pi, 20, 1e-4         # [m²], [rad], [-], [m]


def links_of(theta, lengths):
    """Return the links as complex numbers."""
    return np.asarray(lengths) * np.exp(1j * np.cumsum(theta))


def end_of(theta, lengths):
    """Return the end of the arm (2,)."""
    z = np.sum(links_of(theta, lengths))
    return np.array([z.real, z.imag])


def joints_of(theta, lengths):
    """Return the joints and the end (n + 1, 2)."""
    z = np.append(0.0, np.cumsum(links_of(theta, lengths)))
    return np.stack((z.real, z.imag), axis=1)


def jacobian_of(theta, lengths):
    """Return J (2, n): joint k turns all links from the k-th on."""
    z = 1j * np.cumsum(links_of(theta, lengths)[::-1])[::-1]
    return np.stack((z.real, z.imag))


def curvature_of(theta, lengths, e):
    """Return Σ_c e_c ∂²x_c/∂θ_i∂θ_k (n, n): joints i and k together turn all links from the later of the two on."""
    beyond = np.cumsum(links_of(theta, lengths)[::-1])[::-1]
    later = np.maximum.outer(np.arange(len(beyond)), np.arange(len(beyond)))
    return -(beyond.real * e[0] + beyond.imag * e[1])[later]


def annulus(lengths):
    """Return (inner, outer) radius of a planar arm's reach; inner: the longest link minus all others, if positive."""
    return max(0.0, 2.0 * max(lengths) - sum(lengths)), float(sum(lengths))


def nearest_reachable(target, lengths):
    """Return the point of the annulus that is nearest to a target which is not at its centre."""
    r, (inner, outer) = np.hypot(*target), annulus(lengths)
    return np.asarray(target) * (min(max(r, inner), outer) / r)


def bent_to(target, lengths):
    """Return angles (3,) of an arm that reaches a target by a bend of its first two joints: the law of cosines."""
    r, rest = np.hypot(*target), lengths[1] + lengths[2]
    bend = np.pi - np.arccos((lengths[0] ** 2 + rest**2 - r * r) / (2.0 * lengths[0] * rest))
    first = np.arctan2(target[1], target[0]) - np.arctan2(rest * np.sin(bend), lengths[0] + rest * np.cos(bend))
    return np.array([first, bend, 0.0])


def bullet_ik(theta, target, lengths, direction=None, **settings):
    """Return the angles that pybullet finds for a planar arm; settings as in `bullet_search`."""
    return bullet_search(theta, target, lengths, direction, **settings)[0]


def single_rounding(theta, target, lengths, direction):
    """Return the uncertainty [rad] of pybullet's angles by default, from rounding 2 arccos w, w near 1, to 32 bits.

    w is rounded to 1.1e-16, and so is the quaternion from which it is computed.  The angle φ is off by a few times
    2.2e-16/sin(φ/2).  If that does not determine to which 32-bit float φ is rounded, the search is repeated with
    the other float.
    """
    missing, doubt = [], 0.0
    angles, _ = bullet_search(theta, target, lengths, direction, missing=missing)
    for k, angle in enumerate(map(abs, missing)):
        single = np.float32(angle)
        spacing, unsure = float(np.spacing(single)), 4.0 * ROUND_OFF / np.sin(0.5 * max(angle, 3e-8))
        if 0.5 * spacing - abs(angle - float(single)) < unsure:
            other, _ = bullet_search(theta, target, lengths, direction, off=(k, max(spacing, unsure)))
            doubt += np.linalg.norm(other - angles)
    return doubt


def bullet_search(theta, target, lengths, direction=None, damping=DAMPING, iterations=ITERATIONS, threshold=THRESHOLD,
                  missing=None, off=(-1, 0.0)):
    """Return (angles that pybullet finds for a planar arm, iterations).

    With a direction [rad] of the last link the system has six rows.  The missing rotation angle then passes through a
    float of 32 bits.  A list `missing` receives these angles; off = (k, δ) adds δ to the angle of iteration k.
    """
    theta, n = np.array(theta, float), len(theta)
    for k in range(iterations):
        e, J = target - end_of(theta, lengths), jacobian_of(theta, lengths)
        size = np.linalg.norm(e)
        if direction is not None:
            angle = np.angle(np.exp(1j * (direction - np.sum(theta))))
            e, J = np.append(e, float(np.float32(angle)) + off[1] * (k == off[0])), np.vstack((J, np.ones(n)))
            if missing is not None:
                missing.append(angle)
        step = np.linalg.solve(J.T @ J + damping * np.eye(n), J.T @ e)
        theta = theta + step * min(1.0, LARGEST / max(np.max(np.abs(step)), 1e-300))
        if size <= threshold:
            return theta, k + 1
    return theta, iterations


def turned(axis, angle):
    """Return R (3, 3) by Rodrigues's formula."""
    a, b, c = axis
    K = np.array([[0.0, -c, b], [c, 0.0, -a], [-b, a, 0.0]])
    return np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * K @ K


def spatial_end(theta, axes, offsets):
    """Return (end (3,), R (3, 3) of the last link) of a chain in space, by matrices."""
    x, R = np.zeros(3), np.eye(3)
    for angle, axis, offset in zip(theta, axes, offsets):
        R = R @ turned(axis, angle)
        x = x + R @ offset
    return x, R


# ---------------------------------------------------------------------------------------------- independent searches

def chain(theta, lengths):
    """Return the joints and the end [complex numbers] of a planar arm."""
    x, phi = [0j], 0.0
    for angle, length in zip(theta, lengths):
        phi += angle
        x.append(x[-1] + rect(length, phi))
    return x


def descended(theta, x, e, turn, gain, damping):
    """Return θ + α Jᵀ e: joint k moves the end at a right angle to its lever arm."""
    end = x[-1]
    return [angle + gain * (((end - joint) * 1j).conjugate() * e).real + (gain * turn if turn is not None else 0.0)
            for angle, joint in zip(theta, x)]


def solved(theta, x, e, turn, gain, damping):
    """Return θ + (JᵀJ + λ² 1)⁻¹ Jᵀ e, by n equations; the minimum-norm least-squares solution if λ = 0."""
    levers = 1j * (x[-1] - np.array(x[:-1]))
    J, e = np.stack((levers.real, levers.imag)), np.array([e.real, e.imag])
    if turn is not None:
        J, e = np.vstack((J, np.ones(len(theta)))), np.append(e, turn)
    if damping == 0.0:
        return list(theta + np.linalg.lstsq(J, e, rcond=1e-10)[0])
    return list(theta + np.linalg.solve(J.T @ J + damping**2 * np.eye(len(theta)), J.T @ e))


def pointed(theta, x, e, turn, gain, damping):
    """Turn each joint, from the last to the first, so that the end points at the target."""
    end, target, new = x[-1], x[-1] + e, list(theta)
    for k in reversed(range(len(theta))):
        angle = phase((target - x[k]) * (end - x[k]).conjugate())
        new[k] += angle
        end = x[k] + (end - x[k]) * rect(1.0, angle)
    return new


def pulled(theta, x, e, turn, gain, damping):
    """Put the end on the target and pull each joint along its line to the next; then do the same from the base."""
    lengths, n = [abs(b - a) for a, b in pairwise(x)], len(theta)
    x = [*x[:-1], x[-1] + e]
    for k in reversed(range(n)):
        x[k] = x[k + 1] + (x[k] - x[k + 1]) * (lengths[k] / abs(x[k] - x[k + 1]))
    x[0] = 0j
    for k in range(n):
        x[k + 1] = x[k] + (x[k + 1] - x[k]) * (lengths[k] / abs(x[k + 1] - x[k]))
    directions = [phase(b - a) for a, b in pairwise(x)]
    return [phase(rect(1.0, b - a)) for a, b in zip([0.0, *directions], directions)]


def solved_undamped(theta, x, e, turn, gain, damping):
    """Return θ + J⁺ e."""
    return solved(theta, x, e, turn, gain, 0.0)


def searched(step, theta, target, lengths, enough, most, gain, damping):
    """Return (θ, iterations) of a search that ends when |e| ≤ enough, or after `most` iterations.

    step: one of the five functions above.
    A target with a direction [rad], (x, y, φ), adds a third row to J.  Nothing here is shared with the lesson.
    """
    theta, goal = list(theta), complex(*target[:2])
    for n in range(most):
        x = chain(theta, lengths)
        e, turn = goal - x[-1], phase(rect(1.0, target[2] - sum(theta))) if len(target) == 3 else None
        if np.hypot(abs(e), turn or 0.0) <= enough:
            return theta, n
        theta = step(theta, x, e, turn, gain, damping)
    return theta, most


def search_errors(searches, seen, truth, limit):
    """Return the field `predicted` of a Runner that searches.

    searches(p) → functions of a nudge (3,) [rad] of the start that return (θ, iterations); none if only round-off
    decides
    seen(angles, p), truth(p, t), limit(p, dt) → observed quantities, their truth, and their relative limit
    """
    @cache
    def found(p, dt):
        runs = searches(p)
        here, there = [run(0.0 * ASIDE) for run in runs], [run(NUDGE * ASIDE) for run in runs]
        if not runs or any(a[1] != b[1] for a, b in zip(here, there)):              # one iteration more, or less
            return None
        error = seen([theta for theta, _ in here], p) - truth(p, 1.0)
        size = np.linalg.norm(truth(p, 1.0)) or 1.0
        grown = np.linalg.norm(seen([theta for theta, _ in there], p) - truth(p, 1.0) - error) / NUDGE
        band = ROUND_OFF * (ROUNDINGS * (1.0 + grown) + sum(n for _, n in here)) / size
        return Prediction(error, band) if band < SURE * limit(p, dt) else None

    def predicted_error(p, dt):
        """The prediction is the search itself, iteration by iteration, by complex numbers and other equations than the
        lesson's: a run ends as far from the target as this search does.  A nudge of the start measures how
        round-off grows. Where that growth is not small, as on a jump near a singular arm, only the limit judges.
        """
        return found(p, dt)

    return predicted_error
