"""Planar arms by complex numbers, what they can reach, and pybullet's inverse kinematics, written out.

pybullet's calculateInverseKinematics repeats, at most 20 times by default,
    Δθ = (JᵀJ + d 1)⁻¹ Jᵀ e,     scaled so that no joint turns by more than π/4,     d = ½ without jointDamping
and ends after the iteration that began with a position error up to residualThreshold, 1e-4 by default.  The ½ is in m²
whatever the size of the arm is, and the error of the orientation has no part in when it ends.
*Source:* Bullet, b3PhysicsServerCommandProcessor (processCalculateInverseKinematicsCommand) and IKTrajectoryHelper.
"""

import numpy as np

DAMPING, LARGEST, ITERATIONS, THRESHOLD = 0.5, 0.25 * np.pi, 20, 1e-4         # [m²], [rad], [-], [m]


def links_of(theta, lengths):
    """The links as complex numbers."""
    return np.asarray(lengths) * np.exp(1j * np.cumsum(theta))


def end_of(theta, lengths):
    """End of the arm (2,)."""
    z = np.sum(links_of(theta, lengths))
    return np.array([z.real, z.imag])


def joints_of(theta, lengths):
    """Joints and end (n + 1, 2)."""
    z = np.append(0.0, np.cumsum(links_of(theta, lengths)))
    return np.stack((z.real, z.imag), axis=1)


def jacobian_of(theta, lengths):
    """J (2, n): joint k turns all links from the k-th on."""
    z = 1j * np.cumsum(links_of(theta, lengths)[::-1])[::-1]
    return np.stack((z.real, z.imag))


def curvature_of(theta, lengths, e):
    """Σ_c e_c ∂²x_c/∂θ_i∂θ_k (n, n): joints i and k together turn the links from the later one on, twice by i."""
    beyond = np.cumsum(links_of(theta, lengths)[::-1])[::-1]
    later = np.maximum.outer(np.arange(len(beyond)), np.arange(len(beyond)))
    return -(beyond.real * e[0] + beyond.imag * e[1])[later]


def annulus(lengths):
    """(inner, outer) radius of what a planar arm reaches: the hole is what the longest link is more than the others."""
    return max(0.0, 2.0 * max(lengths) - sum(lengths)), float(sum(lengths))


def nearest_reachable(target, lengths):
    """The point of the annulus that is nearest to a target which is not at its centre."""
    r, (inner, outer) = np.hypot(*target), annulus(lengths)
    return np.asarray(target) * (min(max(r, inner), outer) / r)


def bent_to(target, lengths):
    """Angles (3,) of an arm that reaches a target by a bend of its first two joints: the law of cosines."""
    r, rest = np.hypot(*target), lengths[1] + lengths[2]
    bend = np.pi - np.arccos((lengths[0] ** 2 + rest**2 - r * r) / (2.0 * lengths[0] * rest))
    first = np.arctan2(target[1], target[0]) - np.arctan2(rest * np.sin(bend), lengths[0] + rest * np.cos(bend))
    return np.array([first, bend, 0.0])


def bullet_ik(theta, target, lengths, direction=None, damping=DAMPING, iterations=ITERATIONS, threshold=THRESHOLD):
    """Angles that pybullet returns for a planar arm.

    With a direction [rad] of the last link it has six rows.  The angle of the rotation that is missing goes through a
    float of 32 bits there.
    """
    theta, n = np.array(theta, float), len(theta)
    for _ in range(iterations):
        e, J = target - end_of(theta, lengths), jacobian_of(theta, lengths)
        size = np.linalg.norm(e)
        if direction is not None:
            missing = np.float32(np.angle(np.exp(1j * (direction - np.sum(theta)))))
            e, J = np.append(e, float(missing)), np.vstack((J, np.ones(n)))
        step = np.linalg.solve(J.T @ J + damping * np.eye(n), J.T @ e)
        theta = theta + step * min(1.0, LARGEST / max(np.max(np.abs(step)), 1e-300))
        if size <= threshold:
            break
    return theta


def turned(axis, angle):
    """R (3, 3): Rodrigues's formula."""
    a, b, c = axis
    K = np.array([[0.0, -c, b], [c, 0.0, -a], [-b, a, 0.0]])
    return np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * K @ K


def spatial_end(theta, axes, offsets):
    """(end (3,), R (3, 3) of the last link) of a chain in space, by matrices."""
    x, R = np.zeros(3), np.eye(3)
    for angle, axis, offset in zip(theta, axes, offsets):
        R = R @ turned(axis, angle)
        x = x + R @ offset
    return x, R
