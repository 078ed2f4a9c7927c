"""Steering of lesson 6 where a body heads exactly for the centre of a disc."""

import numpy as np
import pytest

from solutions.collisions import steer


@pytest.mark.parametrize("v", [(1.0, 1.0), (1.0, -3.0), (-2.0, 7.0), (0.1, 0.7), (3.0, 0.0)])
@pytest.mark.parametrize("tau", [0.1, 1.0, 3.0])
def test_who_heads_for_the_centre_in_any_direction_turns_aside_and_does_not_brake(v, tau):
    """The offset r − (r·e) e is round-off here, and may point along v; (r·n) n cannot."""
    v = np.array(v)
    a = steer(np.zeros(2), v, tau * v, 1.0, 4.0)
    assert abs(a @ v) <= 1e-15 * np.linalg.norm(a) * np.linalg.norm(v)
    assert np.linalg.norm(a) == pytest.approx(2.0 / tau**2)
