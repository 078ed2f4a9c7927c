"""Wrong steps of lesson 3 do not have the thresholds, the creep and the energy losses that theory gives."""

import types

import numpy as np
import pytest

from solutions import friction as worked
from validate import stability


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


def rounded_slip_times(acceleration, t, x, v, dt, steps, p):
    return np.round(worked.slip_times(acceleration, t, x, v, dt, steps, p) / dt) * dt


WRONG = [                    # case, function, the function that replaces it
    (31, "sliding_step", holds_by_kinetic),
    (31, "gripping_step", worked.contact_step),
    (32, "event_step", worked.sliding_step),
    (32, "slip_times", rounded_slip_times),
    (33, "sliding_step", chatters),
    (33, "kinetic_friction", lambda F, v, n, mu: 0.5 * worked.kinetic_friction(F, v, n, mu)),
    (34, "contact_step", worked.gripping_step),
    (34, "gripping_step", worked.contact_step),
    (35, "pyramid_step", worked.sliding_step),
    (35, "sliding_step", worked.pyramid_step),
    (36, "contact_step", elastic),
    (37, "pyramid_impulse", lambda *_: np.zeros(2)),
    (37, "sliding_step", never_smooth),
]


@pytest.mark.parametrize(("number", "name", "wrong"), WRONG, ids=[f"{w[0]}-{w[1]}-{k}" for k, w in enumerate(WRONG)])
def test_a_wrong_function_does_not_find_what_theory_says(number, name, wrong):
    lesson = types.SimpleNamespace(**{**vars(stability.lesson_of(number)), name: wrong})
    found, _ = stability.CASES[number][1](lesson)
    assert not all(f.holds for f in found)
