"""Wrong functions of lesson 7 do not have the thresholds, the stops and the energy losses that theory gives."""

import types

import numpy as np
import pytest

from solutions import impulses as worked
from validate import stability


def against_the_slip(u, n, K, e, mu):
    """Friction against the slip before the impact, a rule that jams."""
    slip = worked.tangential(u, n)
    d = n - min(mu, 1e6) * slip / max(np.linalg.norm(slip), 1e-300)
    return -(1.0 + e) * (n @ u) / (n @ (K @ d)) * d


def keeps_the_push(x, v, dt, p):
    """Turns position corrections into velocity, as methods do that compute velocities from positions."""
    x_new, v_new = worked.projecting_discs_step(x, v, dt, p)
    return x_new, v_new + (x_new - x) / dt


def springs_out(acceleration, t, x, v, dt, p):
    x_new, v_new = worked.projecting_step(acceleration, t, x, v, dt, p)
    return x_new, v_new - min(0.0, worked.gap(x, p)) / dt * p.n


def never_rests(acceleration, t, x, v, dt, p):
    return worked.projecting_step(acceleration, t, x, v, dt, p)


def half_a_spring(acceleration, t, x, v, dt, p):
    return worked.penalty_step(acceleration, t, x, v, dt, p._replace(stiffness=0.5 * p.stiffness))


def single(acceleration, t, x, v, dt, p):
    """Positions in single precision."""
    x, v = worked.backtracking_step(acceleration, t, x, v, dt, p)
    return x.astype(np.float32).astype(float), v


def half_the_inertia(r, inv_mass, inv_inertia):
    return 2.0 * worked.point_inverse_mass(r, inv_mass, inv_inertia) - inv_mass * np.eye(3)


WRONG = [                    # case, function, the function that replaces it
    (18, "contact_impulse", against_the_slip),
    (18, "point_inverse_mass", half_the_inertia),
    (19, "projecting_step", springs_out),
    (19, "projecting_discs_step", keeps_the_push),
    (19, "penalty_step", worked.projecting_step),
    (20, "backtracking_step", never_rests),
    (20, "backtracking_step", single),
    (71, "penalty_step", half_a_spring),
    (72, "energy_change", lambda u, K, J: J @ u + J @ (K @ J)),
    (72, "point_inverse_mass", lambda r, inv_mass, inv_inertia: inv_mass * np.eye(3)),
    (73, "impulse_size", lambda u_n, k, e: -(1.0 + e) * u_n / k if k else np.inf),
    (73, "cone_impulse", lambda u, n, K, w, mu: np.zeros(3)),
]


@pytest.mark.parametrize(("number", "name", "wrong"), WRONG, ids=[f"{w[0]}-{w[1]}-{k}" for k, w in enumerate(WRONG)])
def test_a_wrong_function_does_not_find_what_theory_says(number, name, wrong):
    lesson = types.SimpleNamespace(**{**vars(stability.lesson_of(number)), name: wrong})
    found, _ = stability.CASES[number][1](lesson)
    assert not all(f.holds for f in found)
