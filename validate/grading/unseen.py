"""Laws of graded runs.  The students' zip does not contain this file, so no answer can recognise a law of it."""

import numpy as np


def stiffening_ring(t, x, v, p):
    """Return accelerations (n,) of a ring of bodies that pull at their neighbours, less and less the farther they are.

    It replaces `coupled_pendula` of the tests of lesson 1 and takes the same record.  The slopes are as small: in x at
    most 2 · stiffness, in v at most 2 · drag.
    """
    near = x - 0.5 * np.roll(x, 1)
    pull, drag = p.stiffness * near / np.sqrt(1.0 + near * near), p.drag * np.tanh(v + np.roll(v, 2))
    return p.push * np.sin(p.rate * t + 0.4) - pull - drag


UNSEEN = {"coupled_pendula": stiffening_ring}      # {law of the public tests: the law in its place}
