"""A wrong function of lesson 9 does not find the factors, depths and refusals that theory gives the right one."""

import types

import numpy as np
import pytest

from solutions.checks import Diverged
from solutions.support.scenes import HIGHEST
from validate.stability import contact as cases
from validate.stability.examine import cases_of, found_by, subject_of
from validate.subject.modules import bind

worked = bind("contact")


def jacobi(A, b, lam, omega):
    """All contacts at once, from the old impulses."""
    return np.maximum(0.0, lam - omega * (A @ lam + b) / np.diag(A))


def backwards(A, b, lam, omega):
    """Two sweeps, there and back."""
    lam = worked.gauss_seidel_sweep(A, b, lam, omega)
    return worked.gauss_seidel_sweep(A[::-1, ::-1], b[::-1], lam[::-1], omega)[::-1]


def unprojected_at_once(A, b, J, mu):
    """All normals and tangents from the old impulses."""
    step = J - (A @ J + b) / np.diag(A)
    limit = np.repeat(mu, 2) * np.repeat(np.maximum(0.0, step[::2]), 2)
    return np.where(np.arange(J.size) % 2 == 0, np.maximum(0.0, step), np.clip(step, -limit, limit))


def right_corner_first(A, b, J, mu):
    """Another order of the contacts."""
    order = np.arange(J.size).reshape(-1, 2)[::-1].ravel()
    J = worked.cone_sweep(A[np.ix_(order, order)], b[order], J[order], mu[::-1])
    return J[order]


def deaf(A, b, lam, omega):
    """Takes no relaxation."""
    return worked.gauss_seidel_sweep(A, b, lam, 1.0)


def swept(A, b):
    """Sweeps for a direct method."""
    lam = np.zeros(b.size)
    for _ in range(1000):
        lam = worked.gauss_seidel_sweep(A, b, lam, 1.0)
    return lam


def silent(A, b, mu):
    """The impulses after a hundred sweeps, settled or not."""
    J = np.zeros(b.size)
    for _ in range(100):
        J = worked.cone_sweep(A, b, J, mu)
    return J


def too_soon(A, b, mu):
    """Gives up after a hundred sweeps."""
    raise Diverged("residual of the contacts [m/s]", worked.cone_residual(A, b, silent(A, b, mu), mu), "sweep more")


def pile_with(**changes):
    """The pile with other settings than it was told."""
    def advance(bounds, find_contacts, state, dt, steps, pile):
        return worked.advance_pile_2d(bounds, find_contacts, state, dt, steps, pile._replace(**changes))
    return advance


def half_the_hertz(bounds, find_contacts, state, dt, steps, pile):
    return worked.advance_pile_2d(bounds, find_contacts, state, dt, steps, pile._replace(hertz=0.5 * pile.hertz))


def keeps_the_push(bounds, find_contacts, state, dt, steps, pile):
    """Turns what parted two bodies into velocity, as projections of velocities from positions do."""
    end = worked.advance_pile_2d(bounds, find_contacts, state, dt, steps, pile)
    return end._replace(v=(end.x - state.x) / (steps * dt))


def space_with(**changes):
    """The pile in space with other settings than it was told."""
    def advance(bounds, find_contacts, state, dt, steps, pile):
        return worked.advance_pile(bounds, find_contacts, state, dt, steps, pile._replace(**changes))
    return advance


def keeps_the_push_in_space(bounds, find_contacts, state, dt, steps, pile):
    end = worked.advance_pile(bounds, find_contacts, state, dt, steps, pile)
    return end._replace(v=(end.x - state.x) / (steps * dt))


def frictionless(A, b, J, mu):
    """Judges normal impulses only."""
    u, k_n = A @ J + b, np.diag(A)[::2]
    return np.max(k_n * np.abs(np.maximum(0.0, J[::2] - u[::2] / k_n) - J[::2]))


def content(A, b, J, mu):
    return 0.0


def unchecked(a, b, p, n, inv_mass):
    a = np.array(a)
    return worked.ContactSet(np.zeros(1, np.int64), a, np.array(b), np.array(n), np.array(p), np.zeros(a.size))


def lets_it_sink(bounds, find_contacts, state, dt, steps, pile):
    try:
        return worked.advance_pile_2d(bounds, find_contacts, state, dt, steps, pile)
    except Diverged:
        return state


WRONG = [                    # case, the function that it examines, what is put in its place
    ("contraction-of-a-stack", "gauss_seidel_sweep", jacobi),
    ("contraction-of-a-stack", "gauss_seidel_sweep", backwards),
    ("contraction-of-a-mass-ratio", "gauss_seidel_sweep", jacobi),
    ("speed-of-sinking", "gauss_seidel_sweep", jacobi),
    ("speed-of-sinking", "gauss_seidel_sweep", backwards),
    ("trembling", "gauss_seidel_sweep", jacobi),
    ("trembling", "gauss_seidel_sweep", backwards),
    ("creeping", "cone_sweep", unprojected_at_once),
    ("creeping", "cone_sweep", right_corner_first),
    ("over-relaxation", "gauss_seidel_sweep", deaf),
    ("over-relaxation", "gauss_seidel_sweep", jacobi),
    ("sag-of-a-soft-contact", "advance_pile_2d", half_the_hertz),
    ("sag-of-a-soft-contact", "advance_pile_2d", pile_with(gravity=np.array([0.0, -9.8]))),
    ("stack-at-rest", "advance_pile_2d", half_the_hertz),
    ("stack-at-rest", "advance_pile_2d", pile_with(gravity=np.array([0.01, -9.81]))),
    ("mass-ratio-of-a-million", "solve_lcp", swept),
    ("mass-ratio-of-a-million", "solve_contacts", silent),
    ("mass-ratio-of-a-million", "solve_contacts", too_soon),
    ("mass-ratio-of-a-million", "advance_pile_2d", lets_it_sink),
    ("highest-hertz", "advance_pile_2d", half_the_hertz),
    ("highest-hertz", "advance_pile_2d", pile_with(zeta=5.0)),
    ("highest-hertz", "advance_pile_2d", pile_with(substeps=2)),
    ("highest-hertz-in-space", "advance_pile", space_with(zeta=5.0)),
    ("highest-hertz-in-space", "advance_pile", space_with(hertz=45.0)),
    ("highest-hertz-in-space", "advance_pile", space_with(substeps=2)),
    ("extremes-in-space", "advance_pile", keeps_the_push_in_space),
    ("extremes-in-space", "advance_pile", space_with(mu=0.5)),
    ("judge", "cone_residual", content),
    ("judge", "cone_residual", frictionless),
    ("judge", "advance_pile", space_with(mu=0.8)),
    ("extremes", "advance_pile_2d", keeps_the_push),
    ("extremes", "advance_pile_2d", pile_with(mu=0.5)),
    ("extremes", "make_contacts", unchecked),
]


IDS = [f"{slug}-{name}-{k}" for k, (slug, name, _) in enumerate(WRONG)]


@pytest.mark.long
@pytest.mark.parametrize(("slug", "name", "wrong"), WRONG, ids=IDS)
def test_a_wrong_function_does_not_find_what_theory_says(slug, name, wrong):
    case = cases_of("contact")[slug]
    lesson = types.SimpleNamespace(**{**vars(subject_of(case)), name: wrong})
    with np.errstate(all="ignore"):
        found, _ = found_by(case, lesson)
    assert not all(f.holds for f in found)


@pytest.mark.parametrize("wide", [1.0, 2.0, 4.0, 10.0])
def test_by_theory_towers_of_equal_boxes_in_the_plane_are_stable_at_a_quarter_of_the_substep_rate(wide):
    """1e-6 is allowed: stresses that nothing removes give eigenvalues of 1 that are double."""
    assert all(grows(n, 0.25, wide) < 1e-6 for n in range(2, 25))


def test_by_theory_squares_are_stable_at_the_highest_hertz_and_high_towers_of_flat_boxes_are_not():
    assert all(grows(n, HIGHEST) < 1e-6 for n in range(1, 25))
    assert grows(10, 0.307) < 1e-6 < grows(10, 0.3085)
    assert grows(13, 0.268, 2.0) < 1e-6 < 1e-3 < grows(13, HIGHEST, 2.0)
    assert grows(24, 0.26, 4.0) < 1e-6 < grows(24, 0.263, 4.0)


def grows(n, c, wide=1.0):
    """What a substep adds to an error at most, over that error, by theory."""
    return cases.largest(cases.substep_matrix(cases.tower_of_boxes(n, wide), c, 10.0)) - 1.0


@pytest.mark.long
def test_a_tower_of_flat_boxes_comes_to_rest_where_theory_says_so_and_not_where_it_sways_more_and_more():
    fastest = {}
    for c in (0.25, HIGHEST):
        x = np.stack((np.zeros(13), np.arange(13) + 0.5), axis=1)
        state, pile = cases.pile_of(worked, cases.BOX, x, (1.0, 0.5), 1.0, substeps=1, hertz=c / cases.DT)
        fastest[c] = np.max(np.abs(cases.after(worked, cases.BOX, state, pile, 12.0).v))
    assert fastest[0.25] < 1e-3 < 0.02 < fastest[HIGHEST]


def tower_of_cubes(n, c):
    return cases.rest_in_space(worked, n, 1.0, c)


def test_by_theory_towers_of_cubes_are_stable_at_a_fifth_of_the_substep_rate_and_not_at_the_highest_hertz():
    towers = {n: tower_of_cubes(n, 0.1)[2] for n in (2, 3, 4, 5, 8, 12)}
    left = {c: [cases.largest(cases.substep_matrix(tower, c, 10.0)) - 1.0 for tower in towers.values()]
            for c in (0.2, HIGHEST)}
    assert max(left[0.2]) < 1e-6 and max(left[HIGHEST][:2]) < 1e-6 < 1e-3 < min(left[HIGHEST][2:])


@pytest.mark.long
def test_a_tower_of_four_cubes_comes_to_rest_at_a_fifth_of_the_substep_rate_and_not_at_the_highest_hertz():
    """From rest, after a push of 0.1 mm/s.  A cube that turns gets other contacts, which adds to the sway."""
    speeds = {}
    for c in (0.2, HIGHEST):
        state, pile, _ = tower_of_cubes(4, c)
        state.v[3, 0] = cases.NUDGE
        ends = [cases.after(worked, cases.CUBE, state, pile, seconds).v for seconds in (7.9, 8.0)]
        speeds[c] = np.max(np.abs(ends))
    assert speeds[0.2] < 1e-5 < 5e-3 < speeds[HIGHEST]
