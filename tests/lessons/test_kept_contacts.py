"""Contacts that are kept while bodies hardly move are those that a new search finds, to the second order of the way."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from solutions.checks import Diverged
from solutions.given import contact, simulator
from solutions.support import kept_contacts
from solutions.support.arms import normal_velocities
from solutions.support.broad_phase import near_pairs
from solutions.support.contact_points import ContactSet

G, DT, TILT = 9.81, 1.0 / 240.0, 1e-3
FIND = {2: (contact.box_bounds_2d, contact.box_contacts_2d), 3: (contact.box_bounds, contact.box_contacts)}


def tower(rng, d):
    """(state, pile) of three boxes that stand askew on each other and on a plane, and overlap by up to a millimetre."""
    half = 0.1 * rng.uniform(0.9, 1.1, (3, d)) * np.array([3.0, 2.0, 1.0])[:, None] ** (np.arange(d) < d - 1)
    x = rng.uniform(-0.02, 0.02, (3, d))
    x[:, -1] = half[:, -1] + 2.0 * np.append(0.0, np.cumsum(half[:-1, -1])) - rng.uniform(2e-4, 1e-3) * np.arange(1, 4)
    planes, settings = [(*np.eye(d)[-1], 0.0)], (0.5, 4, 120.0, 10.0, 0.008)
    if d == 2:
        return contact.make_pile_2d(x, rng.uniform(-TILT, TILT, 3), 1.0, 0.01, half, planes, (0.0, -G), *settings)
    q = np.append(np.ones((3, 1)), 0.5 * TILT * rng.uniform(-0.5, 0.5, (3, 3)), axis=1)
    return contact.make_pile(x, q / np.linalg.norm(q, axis=1)[:, None], 1.0, np.full((3, 3), 0.01), half, planes,
                             (0.0, 0.0, -G), *settings)


def found(d, x, q, pile):
    """(contacts, pairs, turn) of all pairs."""
    low, high, turn = FIND[d][0](x, q, pile.half)
    pairs = near_pairs(low - pile.margin, high + pile.margin, pile.planes)
    return FIND[d][1](x, turn, pile.half, pile.planes, pairs, 0.5 * pile.margin), pairs, turn


def shifted(rng, d, state, pile):
    """(x, q, v, omega) after bodies have moved with v and omega for 1 s, as far as their contacts are kept."""
    ways = kept_contacts.unknown_ways(pile.half, len(pile.planes), pile.margin)
    v, omega = np.zeros(state.v.shape), np.zeros(state.omega.shape)
    for i in range(3):
        share = rng.uniform(0.2, 0.8)
        direction, axis = rng.normal(size=d), rng.normal(size=1 if d == 2 else 3)
        v[i] = share * ways.allowed[i] * direction / np.linalg.norm(direction)
        turned = 0.999 * (1.0 - share) * ways.allowed[i] / ways.radius[i] * axis / np.linalg.norm(axis)
        omega[i] = turned[0] if d == 2 else turned
    ways.length[:] = 0.0
    x, q = (contact.move_2d if d == 2 else contact.move)(state.x, state.q, v, omega, ways, 1.0)
    assert not kept_contacts.have_moved(ways).any()
    return x, q, v, omega


@pytest.mark.parametrize("d", [2, 3])
def test_kept_contacts_are_those_of_a_new_search_to_the_second_order(d):
    """The gap errs by 7 w²/h + 2 w α: w is the way, h the half size, α the angle between the faces.

    The normal turns by w/h while bodies part by 2 w; an arm turns twice; the ends of a contact go 2 w along faces at an
    angle of α + 2 w/h.
    """
    rng, least = np.random.default_rng(5), 0.09
    way = kept_contacts.KEPT * 0.33
    for _ in range(20):
        state, pile = tower(rng, d)
        old, _, turn = found(d, state.x, state.q, pile)
        x, q, v, omega = shifted(rng, d, state, pile)
        if d == 2:
            arms = contact.arms_2d(state.x, pile.inv_mass, pile.inv_inertia, old)
            u_n = contact.normal_velocities_2d(v, omega, old, arms)
        else:
            arms = contact.arms_3d(state.x, pile.inv_mass, contact.world_inertia(turn, pile.inv_inertia), old)
            u_n = normal_velocities(v, omega, old, arms)
        new = found(d, x, q, pile)[0]
        assert len(old.a) >= 3 * 2 ** (d - 1) and np.max(np.abs(u_n)) > 1e-5
        for k in range(len(old.a)):
            same = (new.a == old.a[k]) & (new.b == old.b[k])
            away = np.linalg.norm(new.p[same] - old.p[k], axis=1)
            assert away.min() < 2.0 * way
            near = np.flatnonzero(same)[away.argmin()]
            assert np.linalg.norm(new.n[near] - old.n[k]) < way / least
            assert abs(old.gap[k] + u_n[k] - new.gap[near]) < 7.0 * way**2 / least + 2.0 * way * TILT


def copied(contacts):
    return contacts._replace(**{name: array.copy() for name, array in contacts._asdict().items()})


@pytest.mark.parametrize("first", [True, False])
@pytest.mark.parametrize("d", [2, 3])
def test_only_pairs_of_which_a_body_has_moved_are_looked_at(d, first):
    rng = np.random.default_rng(6)
    state, pile = tower(rng, d)
    old = found(d, state.x, state.q, pile)[0]
    x, q, _, _ = shifted(rng, d, state, pile)
    new, pairs, turn = found(d, x, q, pile)
    J, moved = rng.normal(size=old.p.shape), np.array([True, False, False, False])
    ways = kept_contacts.unknown_ways(pile.half, pile.planes.shape[0], pile.margin)
    c, J_c = copied(old), J.copy()
    part, J_part, at, left, changed = contact._found_anew(FIND[d][1], x, turn, pairs, moved, c, J_c, ways, pile,
                                                          first)
    assert changed == first and np.array_equal(left, np.flatnonzero((old.a == 0) | (old.b == 0)))
    if changed:
        c, J_c = kept_contacts.with_kept(c, J_c, part, J_part, moved)
    assert np.all(np.diff(c.a) >= 0) and np.array_equal(c.first, np.searchsorted(c.a, np.arange(4)))
    ours, of_old, of_new = ((one.a == 0) | (one.b == 0) for one in (c, old, new))
    for field in ("a", "b", "n", "p", "gap"):
        assert np.array_equal(getattr(c, field)[ours], getattr(new, field)[of_new])
        assert np.array_equal(getattr(c, field)[~ours], getattr(old, field)[~of_old])
        assert changed or np.array_equal(getattr(c, field)[at], getattr(part, field))
    assert np.array_equal(J_c[~ours], J[~of_old]) and len(at) == len(part.a) == np.sum(ours)
    assert np.array_equal(J_c[ours], contact.kept_impulses(new, old, J, pile.margin)[of_new])


def contacts_of(bodies):
    """A ContactSet of these (a, b), whose other numbers are their places in the list."""
    a, b = np.array(bodies, dtype=np.int64).reshape(-1, 2).T
    numbers = np.arange(len(a), dtype=float)
    return ContactSet(np.searchsorted(a, np.arange(5)), a, b, np.stack([numbers] * 2, axis=1),
                      np.stack([numbers] * 2, axis=1), numbers)


@pytest.mark.parametrize(("then", "now", "at"), [
    ([(0, 1), (0, 1), (0, 3)], [(0, 1), (0, 1), (0, 3)], [0, 1, 2]),
    ([(0, 3), (0, 1), (0, 1)], [(0, 1), (0, 1), (0, 3)], [1, 2, 0]),     # in another order
    ([(0, 1), (1, 2), (2, 3)], [(0, 1)], [0]),
    ([(0, 1), (0, 1)], [(0, 1)], [0]),                                   # one less
    ([(0, 1)], [], []),
    ([(0, 1), (1, 2), (1, 3)], [(1, 3)], [2]),
    ([(0, 1)], [(0, 1), (0, 1)], None),                                  # one more
    ([(0, 1)], [(0, 3)], None),                                          # as many, and another body
    ([(0, 1), (0, 1), (0, 3)], [(0, 1), (0, 3), (0, 3)], None),
    ([], [(0, 1)], None),
    ([], [], []),
])
def test_new_contacts_take_the_places_of_old_ones_of_the_same_bodies_if_there_are_enough(then, now, at):
    found, whole = kept_contacts.places_in(contacts_of(then), contacts_of(now))
    assert whole == (at is not None)
    if whole:
        assert found.tolist() == at


def test_contacts_of_bodies_that_have_moved_leave_their_places_and_later_the_set():
    c, J = contacts_of([(0, 1), (0, 3), (1, 2), (1, 3), (2, 3)]), np.ones((5, 2))
    left = kept_contacts.of_moved(c, np.array([False, False, True, False]))
    assert left.tolist() == [2, 4]
    kept_contacts.mark_gone(c, c.gap, J, left)
    assert c.gap.tolist() == [0.0, 1.0, kept_contacts.GONE, 3.0, kept_contacts.GONE]
    assert np.all(J[left] == 0.0) and np.all(np.delete(J, left, axis=0) == 1.0)
    assert not np.any(contact.kept_impulses(contacts_of([(1, 2)]), c, J + 1.0, 10.0))    # no new contact is near them
    rest, J_rest = kept_contacts.without_gone(c, J)
    assert rest.a.tolist() == [0, 0, 1] and rest.b.tolist() == [1, 3, 3]
    assert rest.first.tolist() == [0, 2, 3, 3, 3] and rest.gap.tolist() == [0.0, 1.0, 3.0] and len(J_rest) == 3
    both, _ = kept_contacts.with_kept(c, J, contacts_of([]), J[:0], np.zeros(4, np.bool_))
    assert both.b.tolist() == rest.b.tolist()


@pytest.mark.parametrize("d", [2, 3])
def test_a_contact_that_is_gone_does_nothing_and_its_place_is_taken_again(d):
    """The top box of a tower jumps, too low for a new search of pairs, and lands."""
    state, pile = tower(np.random.default_rng(7), d)
    v = state.v.copy()
    v[2, -1] = 1.2
    advance = contact.advance_pile_2d if d == 2 else contact.advance_pile
    state, pile = state._replace(v=v), pile._replace(margin=0.1)
    for steps, touches in ((24, False), (84, True)):
        kept, anew = advance(*FIND[d], state, DT, steps, pile), state
        for _ in range(steps):
            anew = advance(*FIND[d], anew, DT, 1, pile)
        assert np.any(kept.contacts.b == 2) == touches
        assert np.max(kept.contacts.gap) < pile.margin and len(kept.J) == len(anew.J)
        assert np.max(np.abs(kept.x - anew.x)) < 2.0 * kept_contacts.KEPT * 0.1


def test_a_way_is_that_of_the_farthest_point_and_a_way_that_is_no_number_has_moved():
    half = np.array([(0.3, 0.4), (0.3, 0.4), (0.3, 0.4)])
    ways = kept_contacts.unknown_ways(half, 1, 0.1)
    assert kept_contacts.have_moved(ways).tolist() == [True, True, True, False]
    ways.length[:] = 0.0
    v = np.array([(0.0, 0.0), (0.3, 0.4), (np.nan, 0.0), (0.0, 0.0)])
    contact.move_2d(np.zeros((4, 2)), np.zeros(4), v, np.array([2.0, 0.0, 0.0, 0.0]), ways, 1e-4)
    assert ways.length[:2] == pytest.approx([1e-4 * 2.0 * 0.5, 1e-4 * 0.5])
    assert kept_contacts.have_moved(ways).tolist() == [False, False, True, False]
    kept_contacts.begin_ways(ways, np.array([False, True, True, False]))
    assert ways.length[0] > 0.0 and np.all(ways.length[1:] == 0.0)


def test_no_pair_comes_into_reach_unseen_and_gaps_stay_small_of_small_bodies():
    """Both bodies of a pair beyond reach, margin/2, may go 2 · margin/16 each before it is looked at."""
    for half, margin in ((0.1, 0.008), (0.1, 1e-5), (1e-4, 0.008)):
        allowed = kept_contacts.unknown_ways(np.full((1, 2), half), 0, margin).allowed[0]
        assert 4.0 * allowed <= 0.5 * margin and allowed <= kept_contacts.KEPT * half


def counted(find):
    """(find, calls): the same function, which notes how many pairs it was given."""
    calls = []

    def noted(x, turn, half, planes, pairs, reach):
        calls.append(len(pairs.partner))
        return find(x, turn, half, planes, pairs, reach)
    return noted, calls


@pytest.mark.parametrize("d", [2, pytest.param(3, marks=pytest.mark.long)])
def test_a_tower_at_rest_is_not_searched_again_and_stands_as_if_it_were(d):
    """Single steps find all contacts anew."""
    state, pile = tower(np.random.default_rng(7), d)
    advance = contact.advance_pile_2d if d == 2 else contact.advance_pile
    find, calls = counted(FIND[d][1])
    kept = advance(FIND[d][0], find, state, DT, 240, pile)
    anew = state
    for _ in range(240):
        anew = advance(*FIND[d], anew, DT, 1, pile)
    assert sum(pairs > 0 for pairs in calls) < 60
    assert np.max(np.abs(kept.x - anew.x)) < 2.0 * kept_contacts.KEPT * 0.1
    assert np.max(np.abs(kept.v)) < 1e-4
    on_floor = kept.contacts.b == 3
    weight = 3.0 * G * DT / pile.substeps
    assert np.sum(kept.J[on_floor, -1]) == pytest.approx(weight, rel=1e-3)


def apart(low, high, i, j):
    """The largest gap along an axis between two boxes."""
    return np.max(np.maximum(low[i] - high[j], low[j] - high[i]))


@pytest.mark.parametrize("d", [2, 3])
def test_a_pair_within_reach_that_was_none_before_a_search_is_looked_at(d):
    """Of bodies that have moved inside their widened boxes, and of some that have left them."""
    rng, n, margin, new, marked = np.random.default_rng(12), 40, 0.1, 0, []
    for _ in range(200):
        low = rng.uniform(-1.0, 1.0, (n, d)) * (2.0 if d == 2 else 1.0)
        high = low + rng.uniform(0.1, 0.3, (n, d))
        wide = kept_contacts.widened(low, high, rng.normal(size=(n, d)), margin, 0.004)
        before = kept_contacts.pairs_in_reach(*wide, np.zeros((0, d + 1)), margin)
        pairs = {(i, j) for i in range(n) for j in before.partner[before.first[i]:before.first[i + 1]]}
        way = rng.uniform(wide[0] - low, wide[1] - high) * rng.choice([0.2, 1.0, 3.0], (n, 1))
        low, high, moved = low + way, high + way, np.zeros(n, np.bool_)
        kept_contacts.mark_far(moved, low, high, *wide, margin)
        near = {(i, j) for j in range(n) for i in range(j) if apart(low, high, i, j) <= kept_contacts.REACH * margin}
        assert all(moved[i] or moved[j] for i, j in near - pairs)
        new += len(near - pairs)
        marked.append(np.mean(moved))
    assert new > 20 and 0.1 < np.mean(marked) < 0.8


@pytest.mark.parametrize("way", [-2.0, 0.0, 1e-3, 5.0, np.nan, np.inf])
def test_a_box_is_wider_by_the_margin_and_the_way_of_a_few_steps_up_to_its_size(way):
    low, high, dt = np.array([(0.0, 1.0)]), np.array([(0.5, 1.2)]), 0.004
    wide_low, wide_high = kept_contacts.widened(low, high, np.array([(way, 0.0)]), 0.01, dt)
    ahead = min(kept_contacts.AHEAD * dt * abs(way), 0.5) if way == way else 0.0
    assert np.allclose(wide_low, [(-0.01 - (ahead if way < 0.0 else 0.0), 0.99)], atol=1e-15)
    assert np.allclose(wide_high, [(0.51 + (ahead if way > 0.0 else 0.0), 1.21)], atol=1e-15)


@pytest.mark.parametrize("d", [2, 3])
def test_all_contacts_within_reach_are_known_while_bodies_fly_about(d, monkeypatch):
    """At the beginning of each step, against all pairs: what is within reach is a contact, with the same gap.

    A pair just beyond reach is looked at again only after one body has gone UNSEEN of the margin.
    """
    rng, n = np.random.default_rng(11), 24
    half, walls = np.repeat(0.1 * rng.uniform(0.5, 1.5, (n, 1)), d, axis=1), np.append(np.eye(d), -np.eye(d), axis=0)
    x = 0.32 * (np.stack(np.meshgrid(*[np.arange(5)] * d), axis=-1).reshape(-1, d)[:n] - 2.0)
    x += 0.01 * rng.normal(size=(n, d))
    planes = np.append(walls, np.full((2 * d, 1), 0.9), axis=1)
    make, advance, bounds = ((contact.make_pile_2d, contact.advance_pile_2d, contact.disc_bounds) if d == 2 else
                             (contact.make_pile, contact.advance_pile, contact.ball_bounds))
    q = np.zeros(n) if d == 2 else np.tile([1.0, 0.0, 0.0, 0.0], (n, 1))
    state, pile = make(x, q, 1.0, 0.01 if d == 2 else np.full((n, 3), 0.01), half, planes, np.zeros(d), 0.3, 2, 60.0,
                       5.0, 0.008)
    v = np.append(rng.normal(size=(n, d)) * rng.choice([0.01, 3.0], (n, 1)), np.zeros((2 * d, d)), axis=0)
    places, met = [], []

    def noted(x, *others):
        places.append(x[:n].copy())
        return bounds(x, *others)

    def compared(ways, contacts, gap):
        x = places[-1]
        known = {(a, b): g for a, b, g in zip(contacts.a, contacts.b, gap, strict=True)}
        for i in range(n):
            true = {(i, j): np.linalg.norm(x[i] - x[j]) - half[i, 0] - half[j, 0] for j in range(i + 1, n)}
            true |= {(i, n + k): plane[:d] @ x[i] + plane[d] - half[i, 0] for k, plane in enumerate(planes)}
            for pair, truth in true.items():
                assert truth > within or abs(known[pair] - truth) < 1e-5
                met.append(truth <= 0.0)
        forget_deep(ways, contacts, gap)
    forget_deep = contact.forget_deep
    within = (kept_contacts.REACH - 2.0 * kept_contacts.UNSEEN) * pile.margin
    monkeypatch.setattr(contact, "forget_deep", compared)
    advance(noted, contact.round_contacts, state._replace(v=v), DT, 120, pile)
    assert sum(met) > 100 and len(places) > 100


ROUND = {2: (contact.disc_bounds, contact.round_contacts), 3: (contact.ball_bounds, contact.round_contacts)}


def piled(d, x, half, *, planes=(), gravity=0.0, mu=0.5, margin=0.008, substeps=4, inertia=0.01):
    """(advance, state, pile) of bodies of 1 kg, upright and at rest."""
    up, x = np.eye(d)[-1], np.array(x, dtype=float)
    planes = [(*up, 1e3), *planes]
    settings = (mu, substeps, 120.0, 10.0, margin)
    if d == 2:
        return contact.advance_pile_2d, *contact.make_pile_2d(x, np.zeros(len(x)), 1.0, inertia, half, planes,
                                                              -gravity * up, *settings)
    inertia = np.broadcast_to(inertia, (len(x), 3))
    return contact.advance_pile, *contact.make_pile(x, np.tile([1.0, 0.0, 0.0, 0.0], (len(x), 1)), 1.0, inertia, half,
                                                    planes, -gravity * up, *settings)


def moving(state, *velocities):
    """The state with these velocities of the first bodies."""
    v = state.v.copy()
    v[:len(velocities)] = velocities
    return state._replace(v=v)


def test_a_ball_whose_mass_is_not_spread_evenly_turns_about_its_own_principal_axes():
    """The impulse of a substep on a floor gives it the angular momentum that it has: r × J = R I_body Rᵀ ω."""
    rng, moments = np.random.default_rng(13), np.array((0.01, 0.02, 0.025))
    advance, state, pile = piled(3, [(0.0, 0.0, 0.2)], np.full((1, 3), 0.2), planes=[(0.0, 0.0, 1.0, 0.0)], mu=2.0,
                                 substeps=1, inertia=moments)
    for turn in Rotation.random(5, rng=rng):
        q, v = state.q.copy(), state.v.copy()
        q[0], v[0] = turn.as_quat(scalar_first=True), (1.0, 0.5, -2.0)
        end = advance(*ROUND[3], state._replace(q=q, v=v), 1e-4, 1, pile._replace(hertz=1e3))
        R = turn.as_matrix()
        assert np.allclose(R @ (moments * (R.T @ end.omega[0])), np.cross((0.0, 0.0, -0.2), end.J[0]), atol=1e-12)
        assert np.linalg.norm(end.omega[0]) > 1.0


def test_a_free_body_that_spins_without_bound_is_named():
    """The free turn is explicit: with three different moments and long steps it gains speed, but never ends in NaN."""
    advance, state, pile = piled(3, [(0.0, 0.0, 50.0)], np.full((1, 3), 0.5), substeps=1, inertia=(0.05, 0.08, 0.1))
    omega = state.omega.copy()
    omega[0] = 100.0, 100.0, 30.0
    with pytest.raises(Diverged), np.errstate(over="ignore", invalid="ignore"):
        advance(*ROUND[3], state._replace(omega=omega), DT, 240, pile._replace(hertz=30.0))


@pytest.mark.parametrize("angle", np.radians([0.0, 17.0, 35.0, 36.0, 80.0]))
def test_a_wheel_on_an_axle_gets_no_speed_from_round_off(angle):
    """Its contact presses through its centre, so no impulse changes its velocity there, and none brakes it."""
    n = np.array((-np.sin(angle), np.cos(angle)))
    state, p = simulator.make_bodies_2d([(0.3, 0.2)], [0.0], np.inf, 1.0, [(0.5, 0.5)],
                                        [(*n, 0.5 - 1e-6 - n @ (0.3, 0.2))], (0.0, -G), 0.5, 10, 0.02)
    omega = state.omega.copy()
    omega[0] = 1.0
    end = simulator.advance_contact(simulator.contact_step_2d, simulator.weight, simulator.disc_bounds,
                                    simulator.round_contacts, 0.0, state._replace(omega=omega), 0.01, 5, p)
    assert end.contacts.a.size == 1 and abs(end.omega[0] - 1.0) < 1e-12


@pytest.mark.parametrize("m", [1.0, 1e12, np.inf])
def test_a_bar_that_turns_through_a_floor_within_a_step_is_named(m):
    state, p = simulator.make_bodies_2d([(0.0, 0.5)], [0.0], m, 0.3, [(1.0, 0.05)], [(0.0, 1.0, 0.0)], (0.0, 0.0), 0.5,
                                        20, 0.02)
    omega = state.omega.copy()
    omega[0] = 30.0
    with pytest.raises(Diverged):
        simulator.advance_contact(simulator.contact_step_2d, simulator.weight, simulator.box_bounds_2d,
                                  simulator.box_contacts_2d, 0.0, state._replace(omega=omega), 0.1, 4, p)


def test_a_bar_on_a_pivot_meets_a_floor_as_a_very_heavy_one_does():
    ends = []
    for m in (1e12, np.inf):
        state, p = simulator.make_bodies_2d([(0.0, 0.5)], [0.0], m, 0.3, [(1.0, 0.05)], [(0.0, 1.0, 0.0)], (0.0, 0.0),
                                            0.5, 20, 0.02)
        omega = state.omega.copy()
        omega[0] = 1.0
        ends.append(simulator.advance_contact(simulator.contact_step_2d, simulator.weight, simulator.box_bounds_2d,
                                              simulator.box_contacts_2d, 0.0, state._replace(omega=omega), 0.01, 60, p))
    heavy, pivot = ends
    assert abs(pivot.q[0] - heavy.q[0]) < 1e-9 and pivot.omega[0] < 0.0 < 0.45 < pivot.q[0]


@pytest.mark.parametrize("spin", [0.0, 300.0, 3000.0])
def test_a_ball_that_passes_another_one_is_named_however_fast_it_spins(spin):
    state, p = simulator.make_bodies([(0.0, 0.0, 0.1), (0.0, 0.0, 0.305)], [(1.0, 0.0, 0.0, 0.0)] * 2, [1.0, np.inf],
                                     [[0.004] * 3, [np.inf] * 3], [[0.1] * 3] * 2, [(0.0, 0.0, 1.0, 0.0)], (0.0,) * 3,
                                     0.0, 10, 0.02)
    v, omega = state.v.copy(), state.omega.copy()
    v[1, 2], omega[0, 2] = -30.0, spin
    with pytest.raises(Diverged):
        simulator.advance_contact(simulator.contact_step, simulator.weight, simulator.ball_bounds,
                                  simulator.round_contacts, 0.0, state._replace(v=v, omega=omega), 0.02, 1, p)


def both_ways(advance, shape, state, pile, steps):
    """(end of one call, end of as many calls of one step), of which each finds all pairs and contacts anew."""
    kept, anew = advance(*shape, state, DT, steps, pile), state
    for _ in range(steps):
        anew = advance(*shape, anew, DT, 1, pile)
    return kept, anew


@pytest.mark.parametrize("speed", [0.1, 0.3, 0.45])
@pytest.mark.parametrize("d", [2, 3])
def test_bodies_that_meet_overlap_in_one_call_no_more_than_in_single_steps(d, speed):
    """Their contact is known before they touch.  They begin just farther apart than their widened boxes are wide."""
    for apart in 2.0 * (0.008 + kept_contacts.AHEAD * DT * speed) * np.linspace(1.001, 1.08, 7):
        advance, state, pile = piled(d, [(0.0,) * d, (0.2 + apart,) + (0.0,) * (d - 1)], np.full((2, d), 0.1))
        state = moving(state, speed * np.eye(d)[0], -speed * np.eye(d)[0])
        kept, anew = both_ways(advance, ROUND[d], state, pile, int(0.5 * apart / speed / DT) + 1)
        assert np.max(np.abs(kept.x - anew.x)) < kept_contacts.KEPT * 0.1
        assert 0.1995 < np.linalg.norm(kept.x[0] - kept.x[1]) < 0.2005


@pytest.mark.parametrize("d", [2, 3])
def test_a_small_body_falls_off_a_large_one_that_is_drawn_away_under_it(d):
    """The large one may go far, measured by its own size, before the small one has lost its support."""
    large, small = 50.0, 0.02
    x, half = np.zeros((2, d)), np.array([np.full(d, large), np.full(d, small)])
    x[0, -1], x[1, 0], x[1, -1] = -large, large - small, 0.999 * small
    advance, state, pile = piled(d, x, half, gravity=G, mu=0.0, margin=2.0)
    inv_mass, inv_inertia = pile.inv_mass.copy(), pile.inv_inertia.copy()
    inv_mass[0], inv_inertia[0] = 0.0, 0.0
    state, pile = moving(state, -0.05 * np.eye(d)[0]), pile._replace(inv_mass=inv_mass, inv_inertia=inv_inertia)
    kept, anew = both_ways(advance, FIND[d], state, pile, 156)
    assert kept.x[1, -1] < 0.019 and np.max(np.abs(kept.x - anew.x)) < 1e-6


def test_no_body_goes_farther_than_the_smallest_that_it_touches_allows():
    half = np.array([(10.0, 10.0), (1.0, 1.0), (5.0, 5.0), (0.1, 0.1)])
    ways = kept_contacts.unknown_ways(half, 1, 1e3)
    one = contacts_of([(0, 1), (0, 2), (0, 4), (1, 4), (2, 3)])
    kept_contacts.shorten_ways(ways, one._replace(first=np.array([0, 3, 4, 5, 5])), 1)
    assert ways.allowed.tolist() == [kept_contacts.KEPT * h for h in (1.0, 1.0, 0.1, 0.1)] + [np.inf]


@pytest.mark.parametrize("shape", ["round", "boxes"])
@pytest.mark.parametrize("d", [2, 3])
def test_bodies_that_nothing_moves_may_touch_each_other_and_planes_and_carry_others(d, shape):
    """Two posts overlap each other and the ground; a body stands on one of them, and a pinned wheel beside it.

    The ground pushes the wheel towards its pin, where no impulse changes anything.
    """
    x = np.zeros((4, d))
    x[:, -1], x[:, 0] = (0.1, 0.1, 0.2999, 0.1), (0.0, 0.15, 0.0, 1.0)
    advance, state, pile = piled(d, x, np.full((4, d), 0.1), planes=[(*np.eye(d)[-1], 0.0)], gravity=G)
    inv_mass, inv_inertia = pile.inv_mass.copy(), pile.inv_inertia.copy()
    inv_mass[[0, 1, 3]], inv_inertia[[0, 1]] = 0.0, 0.0
    pile = pile._replace(inv_mass=inv_mass, inv_inertia=inv_inertia)
    end = advance(*(ROUND if shape == "round" else FIND)[d], state, DT, 120, pile)
    assert np.max(np.abs(end.x - state.x)) < 1e-3 and np.max(np.abs(end.v)) < 1e-3
    assert np.array_equal(end.x[[0, 1, 3]], state.x[[0, 1, 3]])
    pairs = {*zip(end.contacts.a.tolist(), end.contacts.b.tolist(), strict=True)}
    assert (0, 2) in pairs and not pairs & {(0, 1), (0, 5), (1, 5)}


def test_a_body_that_turns_freely_takes_substeps_as_well_as_steps():
    """Nothing touches it, so sixteen substeps of a step are sixteen steps."""
    ends = []
    for substeps, steps in ((16, 30), (1, 480)):
        advance, state, pile = piled(3, [(0.0, 0.0, 0.0)], [(0.3, 0.1, 0.05)], substeps=substeps,
                                     inertia=(0.0042, 0.0308, 0.0333))
        omega = state.omega.copy()
        omega[0] = 0.2, 20.0, 0.4
        ends.append(advance(*FIND[3], state._replace(omega=omega), substeps * DT / 16.0, steps, pile))
    assert np.max(np.abs(ends[0].omega - ends[1].omega)) < 1e-9 * 20.0 and np.max(np.abs(ends[0].q - ends[1].q)) < 1e-9
