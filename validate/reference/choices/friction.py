"""Choices of lesson 3."""

import numpy as np

from . import Choice

LOAD, MU_S, MU_K = 10.0, 0.6, 0.4            # normal force [N], static and kinetic friction [-]


def frictions_of_a_pulled_block():
    """Return four ideas of the force of friction on a block that a growing force pulls."""
    pull = np.linspace(0.0, 10.0, 401)
    static, kinetic = MU_S * LOAD, MU_K * LOAD
    ideas = (np.where(pull <= static, pull, kinetic), np.full_like(pull, static), np.minimum(pull, static),
             np.minimum(pull, kinetic))
    return Choice(pull, ideas, "a block on a table, pulled ever harder", "force of the hand [N]",
                  "force of friction [N]")
