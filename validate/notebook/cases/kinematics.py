"""Pictures of lesson 11: arms before and after, their Jacobians and their targets."""

import numpy as np

from ...reference.kinematics import joints_of
from .marks import Arrow, Disc, Dots, Note, View, Way
from .pieces import TURN, Picture, array, flat, in_space, in_world, part, scaled, size_of

RATES = 400                  # random rates of the joints with |θ̇| = 1, in a picture


# ---------------------------------------------------------------------------------------------- arms in the plane

def base_and_reach(lengths):
    reach = float(np.sum(lengths))
    return [Dots(np.zeros((1, 2)), "base"), Disc(np.zeros(2), reach, f"reach, {reach:.4g} m")]


def straight_arm(theta, lengths):
    return [*base_and_reach(lengths), Way(joints_of(0.0 * theta, lengths), "arm with all θ = 0")]


def chain(x, *_):
    return [Way(np.asarray(x, dtype=float), "joints and end")]


def columns(J, x, *_):
    """Return the velocity of the end when each joint alone turns, for 1 rad/s."""
    J = array(J, len(np.asarray(J)), len(x) - 1)[:x.shape[1]]
    return [Arrow(x[-1], scaled(column, 0.5 * size_of(x), *J.T), "velocity of the end by each joint alone")
            for column in J.T]


def velocities(J):
    rates = np.random.default_rng(11).normal(size=(RATES, J.shape[1]))
    return [Dots(rates / np.linalg.norm(rates, axis=1)[:, None] @ J.T, f"J θ̇ of {RATES} rates with |θ̇| = 1")]


def ellipse(result, J):
    longer, shorter, angle = (float(one) for one in result)
    u = np.array([(np.cos(angle), np.sin(angle)), (-np.sin(angle), np.cos(angle))])
    rim = np.stack((longer * np.cos(TURN), shorter * np.sin(TURN)), axis=1) @ u
    return [Way(rim, "ellipse", dots=False), Way(np.stack((0.0 * u[0], longer * u[0])), f"σ₁ = {longer:.4g} m"),
            Way(np.stack((0.0 * u[1], shorter * u[1])), f"σ₂ = {shorter:.4g} m")]


def wished(target, lengths, *_):
    """Return the reach and the target, or several points, with the direction of the hand if the target has one."""
    phi = target[2] if len(target) == 3 else None
    hand = [] if phi is None else [
        Arrow(target[:2], 0.5 * lengths[-1] * np.array([np.cos(phi), np.sin(phi)]), "direction φ of the target")]
    points = target[None, :2] if len(target) == 3 else target.reshape(-1, 2)
    return [*base_and_reach(lengths), Dots(points, "target" if len(points) == 1 else "targets"), *hand]


def solved_2r(theta, target, lengths, *_):
    return [Way(joints_of(array(theta, 2), lengths[:2]), "arm with these angles")]


def solved_3r(theta, target, lengths, *_):
    return [Way(joints_of(array(theta, 3), lengths[:3]), "arm with these angles")]


def arm_before(task, theta, target, arm):
    return [*wished(target, arm.lengths), Way(joints_of(theta, arm.lengths), "arm before the step")]


def arm_after(result, task, theta, target, arm):
    return [Way(joints_of(array(result, len(theta)), arm.lengths), "arm after the step")]


def chain_before(x, target, lengths):
    return [Way(x, "chain before the sweep"), Dots(target[None], "target")]


# ---------------------------------------------------------------------------------------------- arms in space

def straight_arm_3d(theta, axes, offsets):
    return [Way(np.concatenate((np.zeros((1, 3)), np.cumsum(offsets, axis=0))), "arm with all θ = 0")]


def chain_3d(result, theta, axes, offsets):
    x, a = part(result, "x", 0), part(result, "a", 1)
    if x is None:
        return [Note("the axes or the orientation: see the numbers")]
    x = array(x, len(theta) + 1, 3)
    turns = [] if a is None else [Arrow(p, 0.3 * size_of(x) * n, "axes of the joints") for p, n in zip(x, a)]
    return [Way(x, "joints and end"), *turns]


def chain_and_axes(x, a):
    return [Way(x, "joints and end"), *(Arrow(p, 0.3 * size_of(x) * n, "axes of the joints") for p, n in zip(x, a))]


COLUMNS = "each arrow is at right angles to the line from its joint to the end, and in proportion to that line."
CLOSER = "as a rule the end comes closer to the target; the links keep their lengths."
PICTURES = {
    "11.1": Picture(flat, straight_arm, chain, "each joint turns all links after it, against the clock for θ > 0."),
    "11.2": Picture(in_world, lambda x: [Way(x, "joints and end")], columns, COLUMNS),
    "11.3": Picture(lambda *_: [View("", np.eye(2), np.zeros(2), ("velocity of the end, x [m/s]", "y [m/s]"))],
                    velocities, ellipse, "the ellipse is the outline of all velocities, and its half axes end on it."),
    "11.4": Picture(flat, wished, solved_2r, "the arm ends at the target, bent to the side that elbow asks for."),
    "11.5": Picture(flat, wished, solved_3r, "the arm ends at the target, and its last link points along φ."),
    "11.6": Picture(in_space, straight_arm_3d, chain_3d, "each joint turns all that follows about its axis."),
    "11.7": Picture(in_world, chain_and_axes, columns,
                    "each arrow is at right angles to its axis and to the line from its joint to the end."),
    "11.9": Picture(flat, arm_before, arm_after, CLOSER),
    "11.11": Picture(flat, arm_before, arm_after, CLOSER),
    "11.13": Picture(flat, arm_before, arm_after, CLOSER),
    "11.14": Picture(in_world, chain_before, chain,
                     "the first joint stays, every link keeps its length, and the end is closer to the target."),
    "11.15": Picture(flat, arm_before, arm_after, "the end comes closer to the target as far as the limits allow."),
    "11.16": Picture(flat, arm_before, arm_after,
                     "the end comes closer to the target, and the arm to its angles at rest."),
}
