"""Given.  Contacts that are kept over many steps: a pair of bodies is looked at again only once one of them has moved.

A kept contact keeps its place and its normal.  Its gap follows the velocities of its bodies in every substep, so its
error is of second order in the way that they have made.  At the beginning of a step that way is at most KEPT of the
smallest half size, or else the contact is found anew.
*Source:* Box2D 3 and Rapier keep the points of a pair in the same way (contact recycling).
"""

from typing import NamedTuple

import numpy as np

from .broad_phase import near_pairs
from .contact_points import first_of, room_for

KEPT = 2e-3                  # way of a body after which its contacts are found anew [-], over the smallest half size
                             # of it and of all that it touches
DEEP = 2e-2                  # overlap over the smallest half size from which contacts are found anew in every step [-];
                             # less where the margin limits the allowed way
UNSEEN = 1.0 / 16.0          # the same over the margin: no pair beyond reach may touch before it is looked at [-]
REACH = 0.5                  # gap up to which two bodies have a contact, over the margin [-]
AHEAD = 8                    # steps of its velocity by which the box of a body is wider when pairs are searched [-]
GONE = 1e30                  # gap of a contact that is no longer found, but keeps its place [m]


class Ways(NamedTuple):
    """How far n bodies and p planes have moved since their contacts were found."""
    length: np.ndarray       # (n + p,) no point of the body has moved farther [m]; ∞ where it is not known
    allowed: np.ndarray      # (n + p,) the longest way with which contacts are kept [m]
    own: np.ndarray          # (n + p,) the same, where nothing smaller touches the body [m]
    radius: np.ndarray       # (n + p,) of the ball around the centre that holds the body [m]


def unknown_ways(half, planes, margin):
    """Return the Ways of bodies whose contacts are not known yet, and of planes, which never move."""
    n, count = half.shape[0], half.shape[0] + planes
    ways = Ways(np.zeros(count), np.full(count, np.inf), np.full(count, np.inf), np.zeros(count))
    for i in range(n):
        squared, ways.length[i], ways.own[i] = 0.0, np.inf, UNSEEN * margin
        for c in range(half.shape[1]):
            squared += half[i, c] ** 2
            ways.own[i] = min(ways.own[i], KEPT * half[i, c])
        ways.allowed[i], ways.radius[i] = ways.own[i], np.sqrt(squared)
    return ways


def shorten_ways(ways, contacts, planes):
    """Allow no body a longer way than the smallest that it touches, in place.  The last bodies are planes."""
    bodies = ways.length.size - planes
    for k in range(contacts.a.size):
        a, b = contacts.a[k], contacts.b[k]
        if b < bodies:
            ways.allowed[a], ways.allowed[b] = min(ways.allowed[a], ways.own[b]), min(ways.allowed[b], ways.own[a])


def have_moved(ways):
    """Return whether contacts of each body or plane must be found anew, (n + p,); also where its way is no number."""
    moved = np.empty(ways.length.size, np.bool_)
    for i in range(moved.size):
        moved[i] = not ways.length[i] <= ways.allowed[i]
    return moved


def begin_ways(ways, moved):
    """Set the ways of those that have moved back to zero, in place: their contacts have just been found."""
    for i in range(moved.size):
        if moved[i]:
            ways.length[i] = 0.0


def forget_deep(ways, contacts, gap):
    """Mark bodies that overlap deeply, in place, so that their contacts are found anew in the next step.

    There a small motion can change the normal.
    """
    for k in range(gap.size):
        for i in (contacts.a[k], contacts.b[k]):
            if gap[k] < -DEEP / KEPT * ways.own[i]:
                ways.length[i] = np.inf


def widened(low, high, v, margin, dt):
    """Return (wide_low, wide_high): wider boxes, by the margin on all sides.

    While all bodies stay inside theirs, no pair has to be searched for.  In the direction of its velocity a box is also
    wider by the way of AHEAD steps, but at most by its own size.
    """
    wide_low, wide_high = low - margin, high + margin
    for i in range(low.shape[0]):
        for c in range(low.shape[1]):
            size, way = high[i, c] - low[i, c], AHEAD * dt * v[i, c]
            if way > 0.0:
                wide_high[i, c] += min(way, size)
            elif way < 0.0:
                wide_low[i, c] -= min(-way, size)
    return wide_low, wide_high


def mark_far(moved, low, high, wide_low, wide_high, margin):
    """Mark bodies that have used up more than half of their margin as moved, in place.

    Two bodies that have not, and that the last search did not find as a pair, are beyond reach.  So they have no
    contact that is still unknown.
    """
    for i in range(low.shape[0]):
        for c in range(low.shape[1]):
            if not (wide_low[i, c] + 0.5 * margin <= low[i, c] and high[i, c] <= wide_high[i, c] - 0.5 * margin):
                moved[i] = True


def pairs_in_reach(wide_low, wide_high, planes, margin):
    """Return the Pairs that can come within reach while bodies stay inside their widened boxes.

    Each of two bodies is wider by half of the reach.  A plane is nearer by the other half.
    """
    half, nearer = 0.5 * REACH * margin, planes.copy()
    nearer[:, -1] -= half
    return near_pairs(wide_low - half, wide_high + half, nearer)


def copy_contact(c, J, m, old, J_old, k):
    """Write contact k of `old` and its impulse to place m of c and J; return m + 1."""
    c.a[m], c.b[m], c.gap[m] = old.a[k], old.b[k], old.gap[k]
    for e in range(J.shape[1]):
        c.n[m, e], c.p[m, e], J[m, e] = old.n[k, e], old.p[k, e], J_old[k, e]
    return m + 1


def with_kept(old, J_old, new, J_new, moved):
    """Return (ContactSet, J (m, d)): the new contacts, and the old ones, not gone, of which neither body has moved."""
    n, d, m = new.first.size - 1, J_new.shape[1], 0
    c, J = room_for(n, old.a.size + new.a.size, d), np.empty((old.a.size + new.a.size, d))
    for i in range(n):
        for k in range(old.first[i], old.first[i + 1]):
            if not (moved[i] or moved[old.b[k]]) and old.gap[k] < GONE:
                m = copy_contact(c, J, m, old, J_old, k)
        for k in range(new.first[i], new.first[i + 1]):
            m = copy_contact(c, J, m, new, J_new, k)
        c.first[i + 1] = m
    return first_of(c, m), J[:m]


def places_in(old, new):
    """Return (at (m,), whole): the number of the old contact, of the same two bodies, whose place each new one takes.

    whole: whether there is such a place for each new contact.
    """
    at = np.empty(new.a.size, np.int64)
    for i in range(new.first.size - 1):
        begin, end = old.first[i], old.first[i + 1]
        k = begin
        for s in range(new.first[i], new.first[i + 1]):
            if s > new.first[i] and new.b[s] != new.b[s - 1]:            # those of one pair lie side by side
                k = begin
            while k < end and old.b[k] != new.b[s]:
                k += 1
            if k == end:
                return at, False
            at[s] = k
            k += 1
    return at, True


def of_moved(c, moved):
    """Return the numbers of the contacts of bodies that have moved."""
    found, m = np.empty(c.a.size, np.int64), 0
    for k in range(c.a.size):
        found[m] = k
        m += moved[c.a[k]] | moved[c.b[k]]
    return found[:m]


def mark_gone(c, gap, J, left):
    """Mark contacts as gone, in place: their bodies are far apart, and they have no impulse.  left: their numbers."""
    for k in left:
        gap[k] = GONE
        for e in range(J.shape[1]):
            c.p[k, e], J[k, e] = GONE, 0.0


def without_gone(c, J):
    """Return (ContactSet, J (m, d)) of the contacts that are not gone."""
    left, J_left, m = room_for(c.first.size - 1, c.a.size, J.shape[1]), np.empty(J.shape), 0
    for i in range(c.first.size - 1):
        for k in range(c.first[i], c.first[i + 1]):
            if c.gap[k] < GONE:
                m = copy_contact(left, J_left, m, c, J, k)
        left.first[i + 1] = m
    return first_of(left, m), J_left[:m]


def replace_contacts(c, J, at, new, J_new):
    """Write new contacts and their impulses into their places, in place."""
    for k in range(at.size):
        copy_contact(c, J, at[k], new, J_new, k)


def replace_in_plane(c, gap, J, arms, at, new, J_new, arms_new):
    """The same for contacts in the plane in another order, with their gaps and Arms, in place."""
    for k in range(at.size):
        i = at[k]
        gap[i], arms.k_n[i], arms.k_t[i] = new.gap[k], arms_new.k_n[k], arms_new.k_t[k]
        for e in range(2):
            c.n[i, e], c.p[i, e], J[i, e] = new.n[k, e], new.p[k, e], J_new[k, e]
            arms.r_a[i, e], arms.r_b[i, e] = arms_new.r_a[k, e], arms_new.r_b[k, e]
