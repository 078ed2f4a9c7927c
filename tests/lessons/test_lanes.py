"""Contacts side by side: no two of a group share a body that moves, and a sweep over groups is velocity_sweep."""

import numpy as np
import pytest

from solutions.given import contact
from solutions.support import lanes
from solutions.support.arms import Arms, apply_impulses, normal_velocities, world_inertia
from solutions.support.contact_points import ContactSet
from solutions.support.kept_contacts import GONE
from validate.subject import modules

DT, NO_ROOM, WORK = 1.0 / 480.0, np.empty((0, lanes.WIDE * lanes.ROWS)), np.empty(lanes.WIDE * lanes.WORK_ROWS)
COMPILED = pytest.mark.long, pytest.mark.xdist_group("compiled test_contact")


def random_contacts(rng, bodies, planes, m):
    """A ContactSet of m contacts between any bodies, or with a plane, ordered by a."""
    a = np.sort(rng.integers(0, bodies, m))
    b = (a + rng.integers(1, bodies + planes - 1, m)) % (bodies + planes)
    b = np.where(b == a, bodies, b)
    n = rng.normal(size=(m, 3))
    return ContactSet(np.searchsorted(a, np.arange(bodies + 1)), a, b, n / np.linalg.norm(n, axis=1)[:, None],
                      rng.normal(size=(m, 3)), rng.normal(size=m) * 1e-3)


def in_groups(c, side_by_side):
    """Return [numbers of the contacts of a group], as `place` says."""
    group = side_by_side.place // lanes.WIDE
    found = [np.flatnonzero(group == k) for k in range(len(side_by_side.number))]
    return [one[np.argsort(side_by_side.place[one])] for one in found]


@pytest.mark.parametrize(("bodies", "planes", "m"), [(2, 1, 1), (2, 1, 40), (3, 0, 200), (20, 3, 300), (200, 5, 150)])
def test_no_two_contacts_of_a_group_share_a_body_that_moves(bodies, planes, m):
    """Also where a body has more contacts than there are colours."""
    c = random_contacts(np.random.default_rng(m), bodies, planes, m)
    side_by_side = lanes.lanes_for(c, bodies, NO_ROOM)
    groups = in_groups(c, side_by_side)
    assert sorted(np.concatenate(groups)) == list(range(m)) and list(map(len, groups)) == side_by_side.number.tolist()
    for k, group in enumerate(groups):
        moving = np.concatenate((c.a[group], c.b[group]))
        moving = moving[moving < bodies]
        assert 0 < len(group) <= lanes.WIDE and len(set(moving)) == len(moving)
        assert np.array_equal(side_by_side.bodies[k, :len(group)], c.a[group])
        assert np.array_equal(side_by_side.bodies[k, lanes.WIDE:lanes.WIDE + len(group)], c.b[group])


def test_contacts_with_a_plane_alone_fill_their_groups():
    c = random_contacts(np.random.default_rng(1), 100, 1, 100)._replace(a=np.arange(100), b=np.full(100, 100))
    assert lanes.lanes_for(c, 100, NO_ROOM).number.tolist() == [8] * 12 + [4]


def heap(rng, bodies=12, planes=2, m=40):
    """(contacts, J, arms, fastest, v, omega, inv_mass, inv_inertia, pile) of bodies that touch in any way."""
    c = random_contacts(rng, bodies, planes, m)
    axes, _ = np.linalg.qr(rng.normal(size=(bodies, 3, 3)))
    moments = np.append(rng.uniform(1.0, 1.9, (bodies, 3)), np.zeros((planes, 3)), axis=0)
    inv_mass = np.append(rng.uniform(0.5, 2.0, bodies), np.zeros(planes))
    inv_inertia = world_inertia(axes, moments)
    arms = Arms(rng.normal(size=(m, 3)), rng.normal(size=(m, 3)), rng.uniform(1.0, 3.0, m), rng.uniform(3.0, 5.0, m))
    v, omega = rng.normal(size=(2, bodies + planes, 3))
    v[bodies:] = omega[bodies:] = 0.0
    _, pile = contact.make_pile(rng.normal(size=(1, 3)), [(1.0, 0.0, 0.0, 0.0)], 1.0, np.ones((1, 3)), np.ones((1, 3)),
                                [(0.0, 0.0, 1.0, 0.0)], (0.0, 0.0, 0.0), 0.4, 2, 100.0, 2.0, 0.1)
    return c, rng.normal(size=(m, 3)), arms, rng.uniform(0.1, 1.0, m), v, omega, inv_mass, inv_inertia, pile


def each_group(lesson, side_by_side, v, omega, work):
    """Do something with each group and the velocities of its bodies, in place."""
    for group, number in enumerate(side_by_side.number):
        lesson.read_velocities(WORK, v, omega, side_by_side.bodies, group)
        work(side_by_side.rows[group])
        lesson.write_velocities(WORK, v, omega, side_by_side.bodies, group, number)


@pytest.mark.parametrize("compiled", [False, pytest.param(True, marks=COMPILED)])
def test_groups_are_visited_as_velocity_sweep_visits_contacts(compiled):
    """Targets, visits and gaps, against functions that know nothing of lanes."""
    lesson = modules.bind("contact", compiled=compiled and modules.can_compile())
    rng = np.random.default_rng(8)
    for _ in range(5):
        c, J, arms, fastest, v, omega, inv_mass, inv_inertia, pile = heap(rng)
        side_by_side = lesson.lanes_for(c, 12, NO_ROOM)
        lesson.put_contacts(side_by_side, np.arange(len(J)), c, J, arms, fastest, inv_mass, inv_inertia)
        order = np.concatenate(in_groups(c, side_by_side))
        c, arms = contact.reordered(c, order), Arms(*(array[order] for array in arms))
        aim, give = targets(c, J[order], arms, fastest[order], pile)
        swept = contact.velocity_sweep(v, omega, J[order], aim, give, c, arms, inv_mass, inv_inertia, pile.mu)

        def visit(s, pile=pile):
            lesson._aim_eight(s, WORK, DT, pile)
            lesson._visit_eight(s, WORK, pile.mu)
        each_group(lesson, side_by_side, v, omega, visit)
        gap, J = lesson.gaps_and_impulses(side_by_side)
        for ours, theirs in zip((v, omega, J[order]), swept, strict=True):
            assert np.max(np.abs(ours - theirs)) < 1e-12
        assert np.array_equal(gap[order], c.gap)
        before, spin = v.copy(), omega.copy()
        lesson._rest_in_lanes(before, spin, v, omega, side_by_side, DT, pile)
        gap, J_rest = lesson.gaps_and_impulses(side_by_side)
        assert np.max(np.abs(gap[order] - c.gap - DT * normal_velocities(before, spin, c, arms))) < 1e-14
        swept = contact.velocity_sweep(before, spin, J[order], np.minimum(aim, 0.0), 0.0 * give, c, arms, inv_mass,
                                       inv_inertia, pile.mu)
        for ours, theirs in zip((v, omega, J_rest[order]), swept, strict=True):
            assert np.max(np.abs(ours - theirs)) < 1e-12


def targets(c, J, arms, fastest, pile):
    """(aim, give) of soft_contact for all contacts in space, of which none parts faster than its `fastest`."""
    aim, give = np.transpose([contact.soft_contact(gap, pile.hertz, pile.zeta, DT) for gap in c.gap])
    return np.minimum(aim, fastest + give * arms.k_n * np.sum(c.n * J, axis=1)), give


@pytest.mark.parametrize("left", [[], [3], [0, 7, 8, 39], list(range(40))])
def test_contacts_that_leave_take_what_their_impulses_did_with_them(left):
    c, J, arms, fastest, v, _, inv_mass, inv_inertia, _ = heap(np.random.default_rng(3))
    side_by_side = lanes.lanes_for(c, 12, NO_ROOM)
    lanes.put_contacts(side_by_side, np.arange(len(J)), c, J, arms, fastest, inv_mass, inv_inertia)
    pushes, rest = (np.zeros(v.shape), np.zeros(v.shape)), (np.zeros(v.shape), np.zeros(v.shape))
    apply_impulses(*pushes, J, c, arms, inv_mass, inv_inertia)
    lanes.mark_gone_in_lanes(*pushes, side_by_side, c, np.array(left, np.int64))
    J[left] = 0.0
    apply_impulses(*rest, J, c, arms, inv_mass, inv_inertia)
    assert np.max(np.abs(np.subtract(pushes, rest))) < 1e-13
    gap, J_left = lanes.gaps_and_impulses(side_by_side)
    assert np.array_equal(J_left, J) and np.all(gap[left] == GONE)
    assert np.array_equal(np.delete(gap, left), np.delete(c.gap, left))
