"""Given with lesson 10.  Fast bodies do not pass through thin ones: a step in which they would is divided.

A step finds contacts at its beginning only.  If after it two bodies have met and would be too deep in each other, or
past each other, it is done anew, and ends where they first touch.  The rest of it is a step of its own, in which the
contact acts as any other, with its restitution and its arms; joints stay closed.
Suspects come from the boxes around the ways of all bodies (swept_boxes).  Where all bodies are slow, the test is a
single pass over them.
*Source:* lesson 6, swept volumes; event-driven integration of lessons 3 and 7.
*Left out:* after a divided step the impulses are those of its last part.
"""

from typing import NamedTuple

import numpy as np

from ..checks import Diverged, finite_number, positive_number
from ..rotation import body_angular_momentum
from ..support.quaternions import rotate, unrotate
from ..support.records import check_record
from ..support.scenes import TOO_DEEP
from .joints import Joints, turn_on
from .passing import both_sides, find_suspects, may_pass

MOST_CUTS = 30               # of one step: bodies that bounce between two others may meet ever sooner [-]
SUNK = 0.5                   # of what is too deep, at which bodies are parted anew that touched at the beginning [-]
TOUCHING = 1e-9              # gap up to which bodies touch, over the smallest half size [-]: closing leaves round-off
SHORTEST = 1e-9              # part of a step that is left out [-]
CLOSING = 1e-8               # part of a step that closes what SHORTEST has left open [-]: forces make parts end short
HALVINGS = 40                # of the time between two poses, until it is known to round-off [-]
NOT_FINITE = "take a smaller step, or look for a function that returned no number"
TOO_LONG = "take a smaller step; if that does not help, bodies have no room between others"


class Rough(NamedTuple):
    """What find_suspects reads."""
    half: np.ndarray         # (n, d) half sizes of boxes around the bodies, the least one its thickness [m]
    inv_mass: np.ndarray
    inv_inertia: np.ndarray
    planes: np.ndarray
    joints: Joints


# ---------------------------------------------------------------------------------------------- where they touch

def pose_within(before, after, share, dt, inv_inertia):
    """Return (x, q) of all bodies after this share of a step: the poses at which a step of that length would end."""
    x = before.x + share * (after.x - before.x)
    if inv_inertia.ndim == 1:
        return x, before.q + share * (after.q - before.q)
    return x, turn_on(before.q, spins_before(before.q, after, inv_inertia), share * dt, inv_inertia)[0]


def spins_before(q, after, inv_inertia):
    """Return the angular velocities (n, 3) with which bodies at q begin to turn freely, so that they end as `after`."""
    omega = after.omega.copy()
    for i in range(q.shape[0]):
        if inv_inertia[i, 0] > 0.0:
            L = body_angular_momentum(after.q[i], after.omega[i], 1.0 / inv_inertia[i])       # it stays
            omega[i] = rotate(q[i], inv_inertia[i] * unrotate(q[i], L))
    return omega


def overlaps_at(bounds, narrow, before, after, share, dt, suspects, sides, p):
    """Return the overlap (m,) [m] of each suspect when this share of the step is over; 0 of those that are apart.

    The backs of planes, which suspects have as well, do not count.
    """
    back, pairs, overlap = p.half.half.shape[0] + sides.shape[0] // 2, suspects.pairs, np.zeros(suspects.way.size)
    x, q = pose_within(before, after, share, dt, p.inv_inertia)
    _, _, turn = bounds(x, q, p.half)
    found = narrow(x, turn, p.half, sides, pairs, 0.0)
    for k in range(found.a.size):
        i = found.a[k]
        for s in range(pairs.first[i], pairs.first[i + 1]):
            if pairs.partner[s] == found.b[k] and found.b[k] < back:
                overlap[s] = max(overlap[s], -found.gap[k])
    return overlap


def first_touch(bounds, narrow, before, after, dt, p):
    """Return the share of a step at which two bodies first touch that go too deep into each other in it; 1 if none do.

    Too deep is more than half of the smallest half size beyond the overlap at the beginning.  Bodies that touch at the
    beginning may sink in by half of that: the step then ends there, and they are parted anew.
    """
    shapes = p.half
    boxes, boxes_new = bounds(before.x, before.q, shapes), bounds(after.x, after.q, shapes)
    rough = Rough(shapes.half, p.inv_mass, p.inv_inertia, p.planes, p.joints)
    suspects = find_suspects(before, after, boxes, boxes_new, dt, rough)
    if suspects.way.size == 0:
        return 1.0
    sides, free, allowed = both_sides(p.planes), 0.0, TOO_DEEP * suspects.size       # also where a turn dips in
    begin = overlaps_at(bounds, narrow, before, after, 0.0, dt, suspects, sides, p)
    for k in range(suspects.poses + 1):
        share = suspects.begin + (k + 0.5) / suspects.poses * (suspects.end - suspects.begin)
        share = min(share, 1.0) if k < suspects.poses else 1.0
        more = overlaps_at(bounds, narrow, before, after, share, dt, suspects, sides, p) - begin
        s = np.argmax(more - allowed)
        if more[s] > allowed[s]:
            touch = begin[s] > 0.0 or touches(after.contacts, suspects.pairs, s, TOUCHING * suspects.size[s])
            least = begin[s] + (SUNK * allowed[s] if touch else 0.0)
            return touching_share(bounds, narrow, before, after, dt, suspects, sides, p, s, least, free, share)
        if np.max(more) <= 0.0:
            free = share
    return 1.0


def touches(contacts, pairs, s, most):
    """Return whether pair s has a contact with a gap of at most `most` [m]."""
    for k in range(contacts.a.size):
        i = contacts.a[k]
        if pairs.first[i] <= s < pairs.first[i + 1] and pairs.partner[s] == contacts.b[k] and contacts.gap[k] <= most:
            return True
    return False


def touching_share(bounds, narrow, before, after, dt, suspects, sides, p, s, least, free, deep):
    """Return the share of the step at which suspect s begins to overlap by more than `least` [m], by halving."""
    for _ in range(HALVINGS):
        middle = 0.5 * (free + deep)
        if overlaps_at(bounds, narrow, before, after, middle, dt, suspects, sides, p)[s] > least:
            deep = middle
        else:
            free = middle
    return deep


# ---------------------------------------------------------------------------------------------- steps

def whole_step(first, second, third, fourth, fifth, sixth, touch, load, bounds, narrow, t, state, dt, p):
    """Return the PileState after the six parts of a step; `leave` stands where there is none."""
    state = first(load, bounds, narrow, t, state, dt, p)
    state = second(load, bounds, narrow, t, state, dt, p)
    state = third(load, bounds, narrow, t, state, dt, p)
    state = fourth(load, bounds, narrow, t, state, dt, p)
    state = fifth(load, bounds, narrow, t, state, dt, p)
    return sixth(load, bounds, narrow, t, state, dt, p)


def divided_step(first, second, third, fourth, fifth, sixth, touch, load, bounds, narrow, t, state, dt, p):
    """Return the same, but divided where bodies touch that would go too deep into each other or pass each other.

    touch: first_touch, of which only fast bodies have need
    A part that would go too far is done anew and ends where they touch; each part is looked at.
    Raises Diverged where bodies still pass each other after MOST_CUTS of this kind.
    """
    left, part, cuts, closed = dt, dt, 0, False
    while left >= SHORTEST * dt:
        after = whole_step(first, second, third, fourth, fifth, sixth, touch, load, bounds, narrow, t + dt - left,
                           state, part, p)
        share = touch(bounds, narrow, state, after, part, p) if may_pass(state, after, part, p.half.half) else 1.0
        if share == 1.0:
            state, left = after, left - part
            part = left
        else:
            if cuts == MOST_CUTS or (closed and share * part < SHORTEST * dt):
                raise Diverged("the share of a step that its most parts reach [-]", 1.0 - left / dt, TOO_LONG)
            cuts, closed = cuts + 1, share * part < SHORTEST * dt
            part = min(CLOSING * dt, left) if closed else share * part   # closed: what is open does not bounce
    return state


def advance_parts(step, first, second, third, fourth, fifth, sixth, touch, load, bounds, narrow, t, state, dt, steps,
                  p):
    """Return the PileState after so many steps of a loop with six parts; step: whole_step or divided_step.

    All are arguments of their own, so that compiled code is kept on disk for each set of parts.
    Raises BadInput for a step that is not positive, Diverged where the end is not finite.
    """
    check_record(p, state)
    t, dt = finite_number("time t [s]", t), positive_number("step dt [s]", dt)
    for n in range(steps):
        state = step(first, second, third, fourth, fifth, sixth, touch, load, bounds, narrow, t + n * dt, state, dt, p)
    if not (np.all(np.isfinite(state.x)) and np.all(np.isfinite(state.v))
            and np.all(np.isfinite(state.q)) and np.all(np.isfinite(state.omega))):
        raise Diverged("the time [s] at which the motion is no longer finite", t + steps * dt, NOT_FINITE)
    return state
