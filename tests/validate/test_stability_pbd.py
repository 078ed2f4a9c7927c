"""A wrong function of lesson 8 does not find the sags, the sweeps and the losses that theory gives the right one."""

import types

import numpy as np
import pytest

from validate.stability.examine import cases_of, found_by, subject_of
from validate.subject.modules import bind

from .sampled import wrong_functions

worked = bind("pbd")


def hooke(acceleration, t, x, v, dt, network):
    """A compliance that is a stiffness in PBD's sense."""
    return worked.pbd_step(acceleration, t, x, v, dt, network._replace(stiffness=1.0 / (1.0 + network.alpha / dt)))


def forgetful(acceleration, t, x, v, dt, network):
    """Λ = 0 at every sweep."""
    new = worked.predict(acceleration, t, x, v, dt, network)
    for _ in range(network.sweeps):
        new, _ = worked.compliant_sweep(new, np.zeros(network.i.size), dt, network)
    return new, (new - x) / dt


def jacobi(x, network):
    """All links at once."""
    new = x.copy()
    for s in range(network.i.size):
        alone = network._replace(i=network.i[s:s + 1], j=network.j[s:s + 1], rest=network.rest[s:s + 1],
                             stiffness=network.stiffness[s:s + 1])
        new += worked.distance_sweep(x, alone) - x
    return new


def by_jacobi(acceleration, t, x, v, dt, network):
    new = worked.predict(acceleration, t, x, v, dt, network)
    for _ in range(network.sweeps):
        new = jacobi(new, network)
    return new, (new - x) / dt


def once(acceleration, t, x, v, dt, network):
    return worked.pbd_step(acceleration, t, x, v, dt, network._replace(sweeps=1))


def without_air(acceleration, t, x, v, dt, balloon):
    return worked.xpbd_step(acceleration, t, x, v, dt, balloon.network)


def links_only(acceleration, t, x, v, dt, cloth):
    return worked.pbd_step(acceleration, t, x, v, dt, cloth.network)


WRONG = [                    # case, the function that it examines, what is put in its place
    ("stiffness-depends-on-dt", "pbd_step", worked.xpbd_step),
    ("stiffness-depends-on-dt", "pbd_step", once),
    ("stiffness-depends-on-dt", "pbd_sag", lambda g, dt, s, n: g * dt * dt * (1.0 - s) ** n),
    ("compliance", "xpbd_step", worked.pbd_step),
    ("compliance", "xpbd_step", hooke),
    ("compliance", "xpbd_step", forgetful),
    ("unconverged-iterations", "pbd_step", once),
    ("unconverged-iterations", "pbd_step", by_jacobi),
    ("mass-ratio", "distance_sweep", jacobi),
    ("projection-dissipation", "pbd_step", worked.rattle_step),
    ("projection-dissipation", "rattle_step", worked.constraint_projection_step),
    ("substeps-vs-iterations", "xpbd_step", once),
    ("extremes", "distance_constraint", lambda x_i, x_j, rest: (0.0, x_i)),
    ("extremes", "compliant_multiplier", lambda C, Lam, weight, alpha_scaled: 0.0),
    ("extremes", "fold_constraint", lambda x, fold: (0.0, x)),
    ("primitives", "pivoted_body_step",
     lambda t, x, q, v, omega, dt, rod: (x + dt * v, q, v + dt * rod.gravity, omega)),
    ("primitives", "balloon_step", without_air),
    ("primitives", "cloth_step", links_only),
    ("primitives", "fold_sweep", lambda x, cloth: x),
]


@pytest.mark.parametrize(("slug", "name", "wrong"), list(wrong_functions(WRONG)))
def test_a_wrong_function_does_not_find_what_theory_says(slug, name, wrong):
    case = cases_of("pbd")[slug]
    lesson = types.SimpleNamespace(**{**vars(subject_of(case)), name: wrong})
    with np.errstate(all="ignore"):
        found, _ = found_by(case, lesson)
    assert not all(f.holds for f in found)
