"""Wrong functions of lesson 8 do not have the sags, the convergence and the energy losses that theory gives."""

import types

import numpy as np
import pytest

from solutions import pbd as worked
from validate import stability


def hooke(acceleration, t, x, v, dt, net):
    """Compliance converted to a PBD stiffness."""
    return worked.pbd_step(acceleration, t, x, v, dt, net._replace(stiffness=1.0 / (1.0 + net.alpha / dt)))


def forgetful(acceleration, t, x, v, dt, net):
    """Λ = 0 at every sweep."""
    new = worked.predict(acceleration, t, x, v, dt, net)
    for _ in range(net.sweeps):
        new, _ = worked.compliant_sweep(new, np.zeros(net.i.size), dt, net)
    return new, (new - x) / dt


def jacobi(x, net):
    """All links at once, from the same positions."""
    new = x.copy()
    for s in range(net.i.size):
        alone = net._replace(i=net.i[s:s + 1], j=net.j[s:s + 1],
                             rest=net.rest[s:s + 1], stiffness=net.stiffness[s:s + 1])
        new += worked.distance_sweep(x, alone) - x
    return new


def by_jacobi(acceleration, t, x, v, dt, net):
    new = worked.predict(acceleration, t, x, v, dt, net)
    for _ in range(net.sweeps):
        new = jacobi(new, net)
    return new, (new - x) / dt


def once(acceleration, t, x, v, dt, net):
    return worked.pbd_step(acceleration, t, x, v, dt, net._replace(sweeps=1))


WRONG = [                    # case, function, the function that replaces it
    (9, "pbd_step", worked.xpbd_step),
    (9, "pbd_step", once),
    (9, "pbd_sag", lambda g, dt, s, n: g * dt * dt * (1.0 - s) ** n),
    (12, "xpbd_step", worked.pbd_step),
    (12, "xpbd_step", hooke),
    (12, "xpbd_step", forgetful),
    (81, "pbd_step", once),
    (81, "pbd_step", by_jacobi),
    (82, "distance_sweep", jacobi),
    (83, "pbd_step", worked.rattle_step),
    (83, "rattle_step", worked.projection_step),
    (84, "xpbd_step", once),
    (85, "distance_constraint", lambda x_i, x_j, rest: (0.0, x_i)),
    (85, "compliant_multiplier", lambda C, Lam, weight, alpha_scaled: 0.0),
    (85, "fold_constraint", lambda x, fold: (0.0, x)),
    (86, "hung_step", lambda t, x, v, q, omega, dt, rod: (x + dt * v, v + dt * rod.gravity, q, omega)),
    (86, "balloon_step", lambda acceleration, t, x, v, dt, ball: worked.xpbd_step(acceleration, t, x, v, dt, ball.net)),
    (86, "cloth_step", lambda acceleration, t, x, v, dt, cloth: worked.pbd_step(acceleration, t, x, v, dt, cloth.net)),
    (86, "fold_sweep", lambda x, cloth: x),
]


@pytest.mark.parametrize(("number", "name", "wrong"), WRONG, ids=[f"{w[0]}-{w[1]}-{k}" for k, w in enumerate(WRONG)])
def test_a_wrong_function_does_not_find_what_theory_says(number, name, wrong):
    lesson = types.SimpleNamespace(**{**vars(stability.lesson_of(number)), name: wrong})
    with np.errstate(all="ignore"):
        found, _ = stability.CASES[number][1](lesson)
    assert not all(f.holds for f in found)
