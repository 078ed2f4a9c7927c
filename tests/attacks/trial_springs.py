"""A small grading test of lesson 2, which builds on lesson 1.

The worked functions of lesson 1 answer the student's file, out here.
"""

import numpy as np
import pytest

from validate.grading.expect import close

exercise = pytest.mark.exercise


@exercise("2.2", points=2, hint="minus")
def test_air(lesson, draw):
    v, wind, k_v = draw(-1.0, 1.0, 3), draw(-1.0, 1.0, 3), draw(0.1, 0.9)
    close("force", lesson.air_force(v, wind, k_v), wind - k_v * v, 1e-13)


@exercise("2.13", points=4, hint="implicit")
def test_implicit(lesson, draw):
    asked = []

    def counted(t, x, v, p):
        asked.append(t)
        return -x
    x = draw(-1.0, 1.0, (2, 2))
    got = lesson.implicit_spring_network_step(counted, 0.0, x, np.zeros((2, 2)), 0.1, None)
    close("x", got[0], x / 1.01, 1e-9)
