"""Given with lesson 10.  Is a run right?  What is left of the laws of contact, and of the bodies' room."""

import numpy as np

from ..simulator import closing_speeds, velocity_sweep_2d
from .arms import arms_2d


def sweep_residual_2d(state, dt, p):
    """Given.  Return how far [m/s] the last step in the plane is from the laws: what one more sweep changes."""
    x, _, v, omega, contacts, J = state
    arms, aim = arms_2d(x - dt * v, p.inv_mass, p.inv_inertia, contacts), closing_speeds(contacts.gap, dt)
    _, _, better = velocity_sweep_2d(v, omega, J, aim, 0.0 * aim, contacts, arms, p)
    return np.max(np.append(0.0, np.abs(better - J) * np.stack((arms.k_n, arms.k_n), axis=1)))


def largest_overlap(contacts):
    """Given.  Return how far the deepest contact has sunk in [m]; 0 if none has."""
    return np.max(np.append(0.0, -contacts.gap))
