"""Scenes of many contacts whose truth is beyond dispute, and piles:
by the worked answers, compiled where that is possible.
"""

import numpy as np
import pytest

from solutions.checks import BadInput, Diverged
from solutions.support import broad_phase
from solutions.support.kept_contacts import KEPT
from validate.subject import modules

from .test_contact import MIDDLE, G, chain, contacts_of

plain = modules.bind("contact")
pytestmark = [pytest.mark.xdist_group("compiled test_contact"), pytest.mark.long]
PILES = pytest.mark.long               # compiling the loops of the piles takes a minute
AT_REST = 1e-8               # acceleration that counts as none [m/s², rad/s²]: solve_contacts leaves some 1e-10
CRITICAL = 1e-7              # of a critical coefficient [-]: where all accelerations but 1e-8 of g are gone
UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])
DT = 1.0 / 240.0             # [s]


@pytest.fixture(scope="module")
def fast():
    return modules.bind("contact", compiled=modules.can_compile())


def edge(stands, low, high):
    """Where `stands` becomes True, by bisection."""
    while high - low > 1e-9 * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if stands(middle) else (middle, high)
    return high


def at_rest(lesson, x, inv_mass, inv_inertia, pairs, mu, load=None):
    """Whether these bodies stay where they are; pairs (a, b, point, normal); the default load is gravity."""
    c = contacts_of(lesson, *map(list, zip(*pairs, strict=True)))
    weight = np.zeros((len(x), 3))
    weight[inv_mass > 0.0, 1] = -G / inv_mass[inv_mass > 0.0]
    _, a = lesson.contact_forces(x, inv_mass, inv_inertia, c, weight if load is None else load, np.array(mu, float))
    return np.max(np.abs(a)) < AT_REST


# ---------------------------------------------------------------------------------------------- exact scenes

@pytest.mark.parametrize("touch", [True, False], ids=["neighbours touch", "neighbours do not"])
def test_one_disc_on_two_stands_from_both_critical_frictions_on(fast, touch):
    """The upper contacts, 30° from the vertical, carry forces along the line to the ground contact, 15° off their
    normals: tan 15° = 2 − √3.
    At the ground the normal force is 1.5 m g, three times what the disc above leaves at its contact: a third of that.
    """
    x = np.array([(0.0, -1.0), (-0.5, 0.5), (0.5, 0.5), (0.0, 0.5 + np.sqrt(0.75))])
    inv_mass, inv_inertia = np.array([0.0, 1.0, 1.0, 1.0]), np.array([0.0, 8.0, 8.0, 8.0])

    def stands(between, ground):
        pairs = [(1, 0, x[1] - 0.5 * MIDDLE, MIDDLE), (2, 0, x[2] - 0.5 * MIDDLE, MIDDLE),
                 (3, 1, 0.5 * (x[3] + x[1]), x[3] - x[1]), (3, 2, 0.5 * (x[3] + x[2]), x[3] - x[2])]
        mu = [ground, ground, between, between]
        if touch:
            pairs.insert(2, (2, 1, 0.5 * (x[1] + x[2]), x[2] - x[1]))
            mu.insert(2, between)
        return at_rest(fast, x, inv_mass, inv_inertia, pairs, mu)
    assert abs(edge(lambda mu: stands(mu, 1.0), 0.01, 0.9) - (2.0 - np.sqrt(3.0))) < CRITICAL
    assert abs(edge(lambda mu: stands(1.0, mu), 0.01, 0.9) - (2.0 - np.sqrt(3.0)) / 3.0) < CRITICAL


@pytest.mark.parametrize("degrees", [40.0, 60.0, 75.0])
def test_a_ladder_on_a_smooth_wall_needs_half_the_cotangent(fast, degrees):
    theta = np.radians(degrees)
    end = 0.5 * np.array([np.cos(theta), np.sin(theta)])
    x, inv_mass, inv_inertia = np.array([(0.0, -1.0), (0.0, 0.0)]), np.array([0.0, 1.0]), np.array([0.0, 12.0])
    pairs = [(1, 0, -end, MIDDLE), (1, 0, end, np.array([-1.0, 0.0]))]
    found = edge(lambda mu: at_rest(fast, x, inv_mass, inv_inertia, pairs, [mu, 0.0]), 0.01, 2.0)
    assert abs(found - 0.5 / np.tan(theta)) < CRITICAL


def test_five_blocks_reach_out_by_the_harmonic_sum(fast):
    """Block k from the top may reach 1/(2k) of its length over the one below,
    all at once ½ Σ 1/k = 1.141667 for five.
    """
    def stands(share, n=5, length=1.0, height=0.2):
        middles, right = [0.0], 0.5 * length
        # from the top down: each block below has its edge under the centre of what is above, times share
        for k in range(1, n):
            middles.append(middles[-1] - share * 0.5 * length / k)
        x = np.array([(m, (n - k - 0.5) * height) for k, m in enumerate(middles)]
                     + [(middles[-1] - share * 0.5 * length / n - 5.0, -0.5)])
        edges = [x[k + 1, 0] + right for k in range(n - 1)] + [middles[-1] - share * 0.5 * length / n + right]
        pairs = []
        for k in range(n):
            for place in (x[k, 0] - 0.5 * length, min(edges[k], x[k, 0] + 0.5 * length)):
                pairs.append((k, k + 1, np.array([place, (n - k - 1) * height]), MIDDLE))
        inertia = np.array([12.0 / (length**2 + height**2)] * n + [0.0])
        return at_rest(fast, x, np.array([1.0] * n + [0.0]), inertia, pairs, [0.5] * len(pairs))
    found = edge(lambda inverse: stands(1.0 / inverse), 0.5, 2.0)
    assert abs(1.0 / found - 1.0) < CRITICAL and stands(0.999) and not stands(1.001)
    assert abs(0.5 * sum(1.0 / k for k in range(1, 6)) - 1.141667) < 1e-6


def test_a_box_topples_before_it_slides(fast):
    """At tan θ = w/h it topples if μ is larger, and at tan θ = μ it slides if μ is smaller."""
    def stands(slope, mu, w=0.4, h=1.0):
        x = np.array([(0.0, -1.0), (0.0, 0.5 * h)])
        pairs = [(1, 0, np.array([side, 0.0]), MIDDLE) for side in (-0.5 * w, 0.5 * w)]
        load = np.array([(0.0, 0.0, 0.0), (G * slope, -G, 0.0)]) / np.sqrt(1.0 + slope * slope)
        return at_rest(fast, x, np.array([0.0, 1.0]), np.array([0.0, 12.0 / (w * w + h * h)]), pairs, [mu, mu], load)
    assert abs(1.0 / edge(lambda inverse: stands(1.0 / inverse, 0.6), 1.0, 10.0) - 0.4) < CRITICAL
    assert abs(1.0 / edge(lambda inverse: stands(1.0 / inverse, 0.3), 1.0, 10.0) - 0.3) < CRITICAL


def test_sweeps_are_as_many_as_theory_says(fast):
    """Errors shrink by ρ per sweep: ln(1e-3)/ln ρ sweeps for the slowest part of the error,
    which is nearly all of it.
    """
    for n in (10, 20):
        A, b, forces = chain(np.ones(n))
        lam, sweeps = np.zeros(n), 0
        while np.linalg.norm(lam - forces) > 1e-3 * np.linalg.norm(forces):
            lam, sweeps = fast.gauss_seidel_sweep(A, b, lam, 1.0), sweeps + 1
        assert abs(sweeps * np.log(plain.stack_contraction(n)) / np.log(1e-3) - 1.0) < 0.05
        omega, _ = plain.best_relaxation(plain.stack_contraction(n))
        lam, relaxed = np.zeros(n), 0
        while np.max(np.abs(lam / forces - 1.0)) > 1e-3:
            lam, relaxed = fast.gauss_seidel_sweep(A, b, lam, omega), relaxed + 1
        assert relaxed < 3 * n


def test_a_mass_ratio_of_a_million_is_refused_by_sweeps_and_solved_directly(fast):
    A, b, forces = chain([1.0, 1e6])
    assert np.max(np.abs(fast.solve_lcp(A, b) / forces - 1.0)) < 1e-9
    # with tangents that see nothing
    both = np.kron(A, np.diag([1.0, 0.0])) + np.kron(np.diag(np.diag(A)), np.diag([0.0, 1.0]))
    with pytest.raises(Diverged, match="residual of the contacts"):
        fast.solve_contacts(both, np.kron(b, [1.0, 0.0]), np.array([0.5, 0.5]))


@pytest.mark.parametrize(("change", "said"), [
    ({"a": [1, 1]}, "two bodies"), ({"a": [1, 2]}, "whole numbers"),
    ({"n": [(0.0, 2.0), (0.0, 1.0)]}, "the length must be 1"), ({"inv_mass": [0.0, 0.0]}, "above zero"),
    ({"p": [(0.0, np.nan), (0.0, 0.0)]}, "finite"), ({"p": [(0.0, 0.0)]}, "shape")])
def test_contacts_that_cannot_be_are_refused(change, said):
    fields = {"a": [1, 1], "b": [0, 0], "p": [(0.0, 0.0), (1.0, 0.0)], "n": [(0.0, 1.0), (0.0, 1.0)],
              "inv_mass": [0.0, 1.0]}
    assert plain.make_contacts(**fields).a.tolist() == [1, 1]
    if said == "two bodies":
        change = {"b": [1, 0]}
    with pytest.raises(BadInput, match=said):
        plain.make_contacts(**{**fields, **change})


# ---------------------------------------------------------------------------------------------- piles

def pile_2d(x, half, masses, angles=0.0, **more):
    """(PileState, Pile) of boxes in the plane over a floor; or of discs, where shape="disc"."""
    x, half = np.array(x, float), np.array(half, float)
    masses = np.broadcast_to(masses, len(x)).astype(float)
    settings = {"mu": 0.5, "substeps": 4, "hertz": 240.0, "zeta": 10.0, "margin": 0.02,
                "planes": [(0.0, 1.0, 0.0)]} | more
    inertia = masses * (0.5 * half[:, 0] ** 2 if settings.pop("shape", "box") == "disc"
                        else np.sum(half**2, axis=1) / 3.0)
    planes = settings.pop("planes")
    return plain.make_pile_2d(x, np.broadcast_to(angles, len(x)).astype(float), masses, inertia, half, planes,
                              (0.0, -G), **settings)


def pile_3d(x, half, masses, shape="box", **more):
    x, half = np.array(x, float), np.array(half, float)
    masses = np.broadcast_to(masses, len(x)).astype(float)
    settings = {"mu": 0.5, "substeps": 4, "hertz": 120.0, "zeta": 10.0, "margin": 0.02,
                "planes": [(0.0, 0.0, 1.0, 0.0)]} | more
    squares = np.sum(half**2, axis=1)[:, None] - half**2
    inertia = masses[:, None] * (0.6 * squares if shape == "ball" else squares) / 3.0
    planes = settings.pop("planes")
    return plain.make_pile(x, np.tile(UPRIGHT, (len(x), 1)), masses, inertia, half, planes, (0.0, 0.0, -G), **settings)


def run(lesson, state, pile, seconds, shape="box", dt=DT):
    advance, bounds, contacts = {(2, "box"): (lesson.advance_pile_2d, lesson.box_bounds_2d, lesson.box_contacts_2d),
                                 (2, "disc"): (lesson.advance_pile_2d, lesson.disc_bounds, lesson.round_contacts),
                                 (3, "box"): (lesson.advance_pile, lesson.box_bounds, lesson.box_contacts),
                                 (3, "ball"): (lesson.advance_pile, lesson.ball_bounds,
                                               lesson.round_contacts)}[pile.half.shape[1], shape]
    return advance(bounds, contacts, state, dt, round(seconds / dt), pile)


def carried(state, pile, n, dt=DT):
    """Vertical force [N] between each body and what is under it, of a stack whose bodies are numbered from below."""
    force = np.zeros(n)
    for a, b, J in zip(state.contacts.a, state.contacts.b, state.J, strict=True):
        force[0 if b >= n else max(a, b)] += abs(J[-1]) * pile.substeps / dt
    return force


def unit_stack(d, masses, **more):
    n = len(masses)
    x = np.zeros((n, d))
    x[:, -1] = np.arange(n) + 0.5
    return (pile_2d if d == 2 else pile_3d)(x, np.full((n, d), 0.5), masses, **more)


@PILES
@pytest.mark.parametrize(("d", "tolerance"), [(2, 3e-6), (3, 3e-7)])
def test_a_stack_of_ten_carries_k_m_g_and_stays(fast, d, tolerance):
    """Measured 3.3e-7 (2D) and 1.1e-8 (3D) after 3 s.

    It sags by Σ k_n F/(2π hertz)², a millimetre in all, and drifts by less.
    """
    state, pile = unit_stack(d, np.ones(10))
    end = run(fast, state, pile, 3.0)
    assert np.max(np.abs(carried(end, pile, 10) / (G * np.arange(10, 0, -1)) - 1.0)) < tolerance
    assert np.max(np.abs(end.x[:10, :-1])) < 1e-3 and np.max(np.abs(end.v)) < 1e-3


@PILES
def test_a_contact_sags_by_its_law_at_any_step(fast):
    """A disc of 2 kg has k_n = 1/m, so that it sags by g/(2π hertz)²; after 10 s nothing is left of the fall."""
    for hertz, substeps in ((20.0, 1), (20.0, 8), (60.0, 2)):
        state, pile = pile_2d([(0.0, 0.3)], [(0.3, 0.3)], 2.0, shape="disc", hertz=hertz, substeps=substeps)
        end = run(fast, state, pile, 10.0, "disc")
        sag = 0.3 - end.x[0, 1]
        assert abs(sag / (G / (2.0 * np.pi * hertz) ** 2) - 1.0) < 1e-9, (hertz, substeps)


@PILES
@pytest.mark.parametrize(("ratio", "substeps", "hertz", "tolerance"),
                         [(10.0, 4, 240.0, 1e-8), (100.0, 16, 480.0, 1e-8), (1000.0, 16, 480.0, 6e-6)])
def test_a_heavy_box_on_a_light_one_is_carried(fast, ratio, substeps, hertz, tolerance):
    state, pile = unit_stack(2, np.array([1.0, ratio]), substeps=substeps, hertz=hertz)
    end = run(fast, state, pile, 2.0)
    assert np.max(np.abs(carried(end, pile, 2) / (G * np.array([1.0 + ratio, ratio])) - 1.0)) < tolerance


@PILES
@pytest.mark.parametrize(("ratio", "substeps", "hertz"), [(1e6, 2, 120.0), (1e6, 16, 480.0), (1e4, 2, 120.0)])
def test_a_mass_ratio_that_the_sweeps_do_not_carry_is_refused(fast, ratio, substeps, hertz):
    state, pile = unit_stack(2, np.array([1.0, ratio]), substeps=substeps, hertz=hertz)
    with pytest.raises(Diverged, match="sink into each other; the residual"):
        run(fast, state, pile, 5.0)


def potential_energy(state, pile):
    n = len(pile.half)
    return G * np.sum(state.x[:n, -1] / pile.inv_mass[:n])


def settled(fast, rng, d, shape, n=200, seconds=4.0):
    """A pile of n bodies in a box that fell from a grid, after so many seconds."""
    size = 0.1 * rng.uniform(0.9, 1.1, n)
    half = np.repeat(size[:, None], d, axis=1) if shape != "box" else 0.1 * rng.uniform(0.8, 1.2, (n, d))
    wide = 12 if d == 2 else 6
    k = np.arange(n)
    grid = [k % wide, k // wide] if d == 2 else [k % wide, k // wide % wide, k // wide**2]
    x = 0.32 * np.stack(grid, axis=1) + 0.2 + 0.01 * rng.uniform(-1.0, 1.0, (n, d))
    room = 0.32 * wide + 0.2
    planes = [(*(side * np.eye(d)[c]), 0.0 if side > 0.0 else room) for c in range(d) for side in (1.0, -1.0) if c < d
              - 1 or side > 0.0]
    masses = np.prod(half, axis=1) / 0.1**d
    if d == 2:
        state, pile = pile_2d(x, half, masses, rng.uniform(0.0, 6.0, n) * (shape == "box"), shape=shape, planes=planes,
                              substeps=3, hertz=180.0, margin=0.005)
    else:
        state, pile = pile_3d(x, half, masses, shape, planes=planes, substeps=4, hertz=120.0, margin=0.005)
    return state, pile, run(fast, state, pile, seconds, shape)


# spheres: below, plain; compiling them takes 8 s more
@PILES
@pytest.mark.parametrize(("d", "shape"), [(2, "disc"), (2, "box"), (3, "box")])
def test_a_pile_of_two_hundred_comes_to_rest_and_balances_its_weight(fast, d, shape):
    if not modules.can_compile():
        pytest.skip("a pile takes minutes without numba")
    state, pile, end = settled(fast, np.random.default_rng(1), d, shape)
    n, h = len(pile.half), DT / pile.substeps
    force = np.zeros(d)
    for _a, b, J in zip(end.contacts.a, end.contacts.b, end.J, strict=True):
        force += J / h if b >= n else 0.0
    weight = G * np.sum(1.0 / pile.inv_mass[:n])
    assert np.abs(force[-1] / weight - 1.0) < 0.01 and np.max(np.abs(force[:-1])) < 0.02 * weight
    assert potential_energy(end, pile) < 0.8 * potential_energy(state, pile)
    assert np.median(np.abs(end.v[:n])) < 1e-2 and np.min(end.contacts.gap) > -0.1 * np.min(pile.half)


@PILES
def test_a_sphere_that_slides_rolls_in_the_end_with_five_sevenths(fast):
    """At any μ, m v r + I ω about the floor is kept.

    In 3D, across the axes, by the disc of friction; plain, because it is short.
    """
    state, pile = pile_3d([(0.0, 0.0, 0.1)], [(0.1, 0.1, 0.1)], 1.0, "ball", mu=0.4)
    state = state._replace(v=np.array([(0.6, 0.8, 0.0), (0.0, 0.0, 0.0)]))
    end = run(plain, state, pile, 0.25, "ball")
    assert np.max(np.abs(end.v[0] - 5.0 / 7.0 * np.array([0.6, 0.8, 0.0]))) < 1e-3
    assert np.max(np.abs(end.omega[0] - 5.0 / 7.0 / 0.1 * np.array([-0.8, 0.6, 0.0]))) < 1e-2
    assert np.array_equal(end.x[1], np.zeros(3))


@PILES
def test_bodies_that_begin_inside_each_other_part_and_are_not_thrown_out(fast):
    for shape, at in (("disc", [(0.0, 0.5), (0.0, 0.5)]), ("box", [(0.0, 0.5), (0.05, 0.6)]),
                      ("disc", [(0.0, 0.2), (0.1, 0.3)])):
        state, pile = pile_2d(at, [(0.5, 0.5)] * 2, 1.0, shape=shape)
        end = run(fast, state, pile, 3.0, shape)
        assert np.all(np.isfinite(end.x)) and np.max(np.abs(end.v)) < 5.0 and np.max(end.x[:2, 1]) < 2.5


def tilted(degrees):
    """A plane through the origin, rising to the right."""
    theta = np.radians(degrees)
    return (-np.sin(theta), np.cos(theta), 0.0)


@PILES
@pytest.mark.parametrize("degrees", [45.0, 80.0, 89.0])
def test_a_disc_in_a_wedge_is_held_by_both_walls(fast, degrees):
    """Without friction each wall carries m g/(2 cos θ): 28.65 weights at 89°.

    Errors there are as much larger as the wedge is steep: sweeps contract by cos² 2θ.
    """
    state, pile = pile_2d([(0.0, 0.5 / np.cos(np.radians(degrees)))], [(0.5, 0.5)], 1.0, shape="disc", mu=0.0,
                          planes=[tilted(degrees), tilted(-degrees)])
    end = run(fast, state, pile, 5.0, "disc")
    force = np.linalg.norm(end.J, axis=1) * pile.substeps / DT
    assert len(force) == 2 and np.max(np.abs(force / (0.5 * G / np.cos(np.radians(degrees))) - 1.0)) < 1e-3
    assert np.max(np.abs(end.v)) < 1e-3 and abs(end.x[0, 0]) < 1e-3


@PILES
def test_infinite_friction_holds_a_box_at_any_slope_and_none_lets_it_go(fast):
    theta = np.radians(40.0)
    at = 0.5 * np.array([-np.sin(theta), np.cos(theta)])
    for mu, expected in ((np.inf, 0.0), (0.0, G * np.sin(theta))):
        state, pile = pile_2d([at], [(0.5, 0.5)], 1.0, theta, mu=mu, planes=[tilted(40.0)])
        end = run(fast, state, pile, 1.0)
        assert abs(np.linalg.norm(end.v[0]) - expected) < 2e-3 and abs(end.q[0] - theta) < 1e-3, mu


@PILES
def test_small_discs_stand_beside_a_hundred_times_larger_one(fast):
    """The large one is 10,000 times as heavy.  Under it they could not be carried; beside it nothing disturbs them."""
    x = [(0.0, 1.0)] + [(1.5 + 0.05 * k, 0.01) for k in range(5)]
    state, pile = pile_2d(x, [(1.0, 1.0)] + [(0.01, 0.01)] * 5, [1e4] + [1.0] * 5, shape="disc", margin=0.002)
    end = run(fast, state, pile, 2.0, "disc")
    assert np.max(np.abs(end.x[:6] - state.x[:6])) < 1e-4 and np.max(np.abs(end.v)) < 1e-6


@PILES
def test_long_steps_with_enough_substeps_hold_a_stack(fast):
    state, pile = unit_stack(2, np.ones(5), substeps=8, hertz=72.0)
    end = run(fast, state, pile, 3.0, dt=1.0 / 30.0)
    assert np.max(np.abs(carried(end, pile, 5, 1.0 / 30.0) / (G * np.arange(5, 0, -1)) - 1.0)) < 3e-5  # measured 3.4e-6


@PILES
def test_an_overlap_is_removed_without_leaving_a_velocity(fast):
    state, pile = pile_2d([(0.0, 0.49)], [(0.5, 0.5)], 1.0, shape="disc")
    end = run(fast, state, pile, DT, "disc")
    assert end.x[0, 1] > 0.49 + 1e-4 and abs(end.v[0, 1]) < 1e-12


@PILES
def test_a_falling_body_closes_its_gap_once_however_many_substeps(fast):
    """Soft contacts let it in by give/(1 + give) of what it would go in a substep: 0.11 mm with four.

    It falls 4 mm in a step.
    """
    for substeps in (1, 4, 16):
        state, pile = pile_2d([(0.0, 0.501)], [(0.5, 0.5)], 1.0, shape="disc", substeps=substeps, hertz=60.0)
        end = run(fast, state._replace(v=np.array([(0.0, -1.0), (0.0, 0.0)])), pile, DT, "disc")
        rests = abs(end.x[0, 1] - 0.5) < 2e-4 and abs(end.v[0, 1]) < 1e-12 + (substeps == 1)
        assert rests, (substeps, end.x[0], end.v[0])


@PILES
def test_a_body_that_begins_inside_a_wall_comes_out_gently(fast):
    state, pile = pile_2d([(0.0, -2.0)], [(0.5, 0.5)], 1.0)
    states = plain.pile_trajectory(fast.advance_pile_2d, fast.box_bounds_2d, fast.box_contacts_2d, state, DT, 480, pile)
    heights, speeds = np.array([one.x[0, 1] for one in states]), np.array([one.v[0, 1] for one in states])
    assert np.all(np.diff(heights)[:200] > 0.0) and abs(heights[-1] - 0.5) < 1e-2
    assert np.max(speeds) <= 3.0 and np.max(heights) < 0.6


def test_the_search_for_pairs_looks_at_as_many_boxes_per_body_in_large_piles_as_in_small_ones(monkeypatch):
    looked, boxes_overlap = [], broad_phase.boxes_overlap
    monkeypatch.setattr(broad_phase, "boxes_overlap", lambda *given: looked.append(given) or boxes_overlap(*given))

    def looks(n):
        looked.clear()
        k = np.arange(n)
        low = np.stack((0.2 * (k % 50), 0.2 * (k // 50)), axis=1)
        broad_phase.near_pairs(low - 0.005, low + 0.205, np.array([(0.0, 1.0, 0.0)]))
        return len(looked) / n
    assert 2.0 < looks(10_000) < 2.0 * looks(100)


def test_hertz_beyond_three_tenths_of_the_substeps_are_refused(fast):
    state, pile = unit_stack(2, np.ones(2), substeps=2, hertz=145.0)
    with pytest.raises(BadInput, match="hertz of the contacts"):
        run(fast, state, pile, 0.1)
    run(fast, state, pile._replace(hertz=144.0), 0.1)


@pytest.mark.parametrize("change", [{"half": [(0.5, 0.0)]}, {"half": [(0.5, -0.5)]}, {"masses": 0.0},
                                    {"masses": np.nan}, {"x": [(0.0, np.inf)]}, {"mu": -0.1},
                                    {"substeps": 0}, {"substeps": 1.5}, {"hertz": 0.0}, {"zeta": 0.0},
                                    {"margin": 0.0}, {"planes": [(0.0, 0.0, 1.0)]}])
def test_piles_that_cannot_be_are_refused(change):
    with pytest.raises(BadInput):
        pile_2d(**({"x": [(0.0, 0.5)], "half": [(0.5, 0.5)], "masses": 1.0} | change))


@PILES
def test_plain_and_compiled_piles_go_the_same_way(fast):
    """The same arithmetic in the same order; only the compiler's sums of products differ by rounding,
    which contacts do not amplify in 24 steps.
    """
    state, pile = pile_2d([(0.0, 0.55), (0.3, 1.7), (-0.2, 2.9)], [(0.5, 0.5)] * 3, 1.0, [0.1, 0.3, -0.2])
    a, b = (run(lesson, state, pile, 24 * DT) for lesson in (plain, fast))
    assert np.max(np.abs(a.x - b.x)) < 1e-9 and np.max(np.abs(a.q - b.q)) < 1e-9


@PILES
def test_a_trajectory_ends_where_the_run_ends(fast):
    state, pile = pile_2d([(0.0, 0.55), (0.3, 1.7)], [(0.5, 0.5)] * 2, 1.0, 0.1)
    states = plain.pile_trajectory(plain.advance_pile_2d, plain.box_bounds_2d, plain.box_contacts_2d, state, DT, 10,
                                   pile)
    end, way = run(plain, state, pile, 10 * DT), KEPT * 0.5
    assert len(states) == 11 and np.array_equal(states[0].x, state.x)
    # each call finds all contacts anew; kept ones are wrong in the second order of the way, over half a size
    assert np.max(np.abs(states[-1].x - end.x)) < 4 * way**2 / 0.5
