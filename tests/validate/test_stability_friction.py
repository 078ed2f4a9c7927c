"""A wrong step of lesson 3 does not find the edges, the creep and the losses that theory gives the right one."""

import types

import numpy as np
import pytest

from validate.stability.examine import cases_of, found_by, subject_of
from validate.subject.modules import bind

from .sampled import wrong_functions

worked = bind("friction")


def holds_by_kinetic(acceleration, t, x, v, dt, p):
    return worked.sliding_step(acceleration, t, x, v, dt, p._replace(mu_s=p.mu_k))


def chatters(acceleration, t, x, v, dt, p):
    a = acceleration(t, x, v, p)
    v = v + dt * (worked.tangential(a, p.n) + worked.kinetic_friction(a, v, p.n, p.mu_k))
    return x + dt * v, v


def never_smooth(acceleration, t, x, v, dt, p):
    return worked.sliding_step(acceleration, t, x, v, dt, p._replace(mu_s=max(p.mu_s, 0.1), mu_k=max(p.mu_k, 0.1)))


def elastic(acceleration, surface, t, x, v, dt, p):
    return worked.contact_step(acceleration, surface, t, x, v, dt, p._replace(e=1.0))


def times_of_steps(acceleration, t, x, v, dt, steps, p):
    """Slips begin and end with a step."""
    return np.round(worked.slip_times(acceleration, t, x, v, dt, steps, p) / dt) * dt


WRONG = [                    # case, the function that it examines, what is put in its place
    ("stick-threshold", "sliding_step", holds_by_kinetic),
    ("stick-threshold", "position_friction_step", worked.contact_step),
    ("stick-slip-threshold", "event_step", worked.sliding_step),
    ("stick-slip-threshold", "slip_times", times_of_steps),
    ("regularised-friction-creeps", "sliding_step", chatters),
    ("regularised-friction-creeps", "kinetic_friction", lambda F, v, n, mu: 0.5 * worked.kinetic_friction(F, v, n, mu)),
    ("artificial-sliding", "contact_step", worked.position_friction_step),
    ("artificial-sliding", "position_friction_step", worked.contact_step),
    ("cone-vs-pyramid", "pyramid_step", worked.sliding_step),
    ("cone-vs-pyramid", "sliding_step", worked.pyramid_step),
    ("curved-wall-order", "contact_step", elastic),
    ("extreme-coefficients", "pyramid_impulse", lambda *_: np.zeros(2)),
    ("extreme-coefficients", "sliding_step", never_smooth),
]


@pytest.mark.parametrize(("slug", "name", "wrong"), list(wrong_functions(WRONG)))
def test_a_wrong_function_does_not_find_what_theory_says(slug, name, wrong):
    case = cases_of("friction")[slug]
    lesson = types.SimpleNamespace(**{**vars(subject_of(case)), name: wrong})
    found, _ = found_by(case, lesson)
    assert not all(f.holds for f in found)
