"""A wrong function of lesson 7 does not find the edges, the stops and the losses that theory gives the right one."""

import types

import numpy as np
import pytest

from validate.stability.examine import cases_of, found_by, subject_of
from validate.subject.modules import bind

from .sampled import wrong_functions

worked = bind("impulses")


def against_the_slip(u, n, K, e, mu):
    """Friction against the slip before the impact: the rule that jams."""
    slip = worked.tangential(u, n)
    d = n - min(mu, 1e6) * slip / max(np.linalg.norm(slip), 1e-300)
    return -(1.0 + e) * (n @ u) / (n @ (K @ d)) * d


def keeps_the_push(x, v, dt, p):
    """Turns what a correction moved into velocity, as projections of velocities from positions do."""
    x_new, v_new = worked.position_projection_discs_step(x, v, dt, p)
    return x_new, v_new + (x_new - x) / dt


def springs_out(acceleration, t, x, v, dt, p):
    x_new, v_new = worked.position_projection_step(acceleration, t, x, v, dt, p)
    return x_new, v_new - min(0.0, worked.gap(x, p)) / dt * p.n


def never_rests(acceleration, t, x, v, dt, p):
    return worked.position_projection_step(acceleration, t, x, v, dt, p)


def half_a_spring(acceleration, t, x, v, dt, p):
    return worked.penalty_step(acceleration, t, x, v, dt, p._replace(stiffness=0.5 * p.stiffness))


def single(acceleration, t, x, v, dt, p):
    """Numbers of seven digits."""
    x, v = worked.backtracking_step(acceleration, t, x, v, dt, p)
    return x.astype(np.float32).astype(float), v


def turns_twice_as_easily(r, inv_mass, inv_inertia):
    return 2.0 * worked.contact_matrix(r, inv_mass, inv_inertia) - inv_mass * np.eye(3)


WRONG = [                    # case, the function that it examines, what is put in its place
    ("painleve-rod", "contact_impulse", against_the_slip),
    ("painleve-rod", "contact_matrix", turns_twice_as_easily),
    ("deep-overlap", "position_projection_step", springs_out),
    ("deep-overlap", "position_projection_discs_step", keeps_the_push),
    ("deep-overlap", "penalty_step", worked.position_projection_step),
    ("zeno-and-far-away", "backtracking_step", never_rests),
    ("zeno-and-far-away", "backtracking_step", single),
    ("penalty-stability", "penalty_step", half_a_spring),
    ("energy-gain", "energy_change", lambda u, K, J: J @ u + J @ (K @ J)),
    ("energy-gain", "contact_matrix", lambda r, inv_mass, inv_inertia: inv_mass * np.eye(3)),
    ("invalid-impacts", "impulse_size", lambda u_n, k, e: -(1.0 + e) * u_n / k if k else np.inf),
    ("invalid-impacts", "cone_impulse", lambda u, n, K, w, mu: np.zeros(3)),
]


@pytest.mark.parametrize(("slug", "name", "wrong"), list(wrong_functions(WRONG)))
def test_a_wrong_function_does_not_find_what_theory_says(slug, name, wrong):
    case = cases_of("impulses")[slug]
    lesson = types.SimpleNamespace(**{**vars(subject_of(case)), name: wrong})
    found, _ = found_by(case, lesson)
    assert not all(f.holds for f in found)
