"""Choices of lesson 1."""

import numpy as np

from . import Choice

OMEGA_DT = 0.1               # of every method [-]
STEPS = 120


def energies_of_a_spring():
    """Return the energies of an undamped oscillator by four methods, over that at the start, after each step.

    Each method is the matrix of its step on (ω x, v), by hand.
    """
    z = OMEGA_DT
    one, half = np.eye(2), np.array([[1.0 - 0.5 * z * z, z], [-z, 1.0]])
    turn = np.array([[0.0, z], [-z, 0.0]])
    matrices = one + turn, half, np.array([[1.0 - z * z, z], [-z, 1.0]]), np.linalg.inv(one - turn)
    return Choice(np.arange(STEPS + 1), tuple(map(_energies, matrices)), f"four methods, ω dt = {z:g}", "step",
                  "energy / energy at the start [-]")


def _energies(matrix):
    states = [np.array([1.0, 0.0])]
    for _ in range(STEPS):
        states.append(matrix @ states[-1])
    return np.array([state @ state for state in states])
