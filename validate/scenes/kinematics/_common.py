"""A straight arm of three links, and drawings of arms and targets."""

import numpy as np

from validate.reference.kinematics import bent_to, joints_of
from validate.scenes.drawing import arms_and_target

LENGTHS = np.array([1.0, 0.7, 0.4])
REACH = 2.1                  # [m]


def draw_straight(angles, target):
    """Draw the straight arm, an arm that reaches the target by a bend of its first two joints, and the target."""
    arms = [joints_of(bent, LENGTHS) for bent in (angles, bent_to(target, LENGTHS))]
    return arms_and_target(arms, target, 0.04)


def within_half_a_turn(angles, truth):
    """Return angles of several answers in one row, each within half a turn of the truth."""
    return truth + np.angle(np.exp(1j * (np.concatenate(angles) - truth)))


def from_minus_pi_to_pi(state, p):
    """Return the angles of all answers in one row, each from −π to π [rad]."""
    return np.angle(np.exp(1j * np.concatenate(state)))


def draw_answers(lengths, observed, target):
    """Draw an arm for each of two answers, and the target as a small cross."""
    arms = [joints_of(angles, lengths) for angles in np.reshape(observed, (2, -1))]
    return arms_and_target(arms, target, 0.03 * sum(lengths))
