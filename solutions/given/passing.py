"""Given with lesson 10.  Bodies that are too fast: they would pass each other, or a plane, within a single step.

A loop finds contacts between steps only.  This check tests poses within a step, and only where a body moves so far that
it could pass.  Within a step a centre moves straight, and a body turns steadily.
*Left out:* corners that graze by less than half of the smallest half size, which is an overlap that loops allow.
"""

from typing import NamedTuple

import numpy as np

from ..checks import Diverged
from ..support.arms import turn_quaternions
from ..support.broad_phase import Pairs, box_reaches, boxes_overlap
from ..support.scenes import TOO_DEEP
from .bodies import TooFast

POSES_PER_HALF = 2.0         # poses on a way of the smallest half size [-]: they miss a quarter of it at most
MOST_POSES = 10_000          # within a step [-]: enough for any number of turns, after which poses repeat
FAR = "take a smaller step: a body moves by some thousand times its size towards another one"


class Suspects(NamedTuple):
    """m pairs that may pass each other within a step.  After the pair of a body and a plane comes that of the back."""
    pairs: Pairs             # n + k is plane k of p planes, and n + p + k its back
    way: np.ndarray          # (m,) of a point of one body as the other sees it, at most [m]
    size: np.ndarray         # (m,) smallest half size of both [m]
    allowed: np.ndarray      # (m,) overlap beyond that at the ends of the step [m]; infinite for a back
    begin: float             # shares of the step between which spheres around the bodies of some pair meet [-]
    end: float
    poses: int               # to be tested between these


def squared_angle(q, q_new, omega, dt, i):
    """Return the square of the angle [rad] by which body i turns in a step; in space quaternion_update turns it by
    less.
    """
    if q.ndim == 1:
        return (q_new[i] - q[i]) ** 2
    return dt * dt * (omega[i, 0] ** 2 + omega[i, 1] ** 2 + omega[i, 2] ** 2)


def length(a, i):
    """Return the length of row i of a (n, d)."""
    squared = 0.0
    for c in range(a.shape[1]):
        squared += a[i, c] * a[i, c]
    return np.sqrt(squared)


def may_pass(before, after, dt, half):
    """Return whether a point of a body may move by more than half of the smallest half size of all bodies.

    Two bodies need twice that together to overlap by half of a half size and to be free again.  This runs in each step
    and takes no root:  (|move| + R φ)² ≤ 2 (|move|² + R² φ²).
    """
    farthest, smallest, d = 0.0, np.inf, half.shape[1]
    for i in range(half.shape[0]):
        move, radius = 0.0, 0.0
        for c in range(d):
            step, size = after.x[i, c] - before.x[i, c], half[i, c]
            move, radius, smallest = move + step * step, radius + size * size, min(smallest, size)
        farthest = max(farthest, move + radius * squared_angle(before.q, after.q, after.omega, dt, i))
    return 8.0 * farthest > smallest * smallest


def check_passing(before, after, bounds, narrow, t, dt, p):
    """Raise TooFast where bodies pass each other or a plane within the step from `before`, at t, to `after`.

    Two bodies pass if within the step they overlap by half of the smallest half size more than at both its ends; or
    more than at its beginning only, if the normal at its end is against that with which they met.  The same holds for a
    body and a plane.  A body that is wholly behind a plane after the step has passed it, too.
    A loop calls this after each step.  Where all bodies are slow it is a single pass over them.
    """
    if not may_pass(before, after, dt, p.half):
        return
    boxes, boxes_new = bounds(before.x, before.q, p.half), bounds(after.x, after.q, p.half)
    suspects, sides = find_suspects(before, after, boxes, boxes_new, dt, p), both_sides(p.planes)
    m, d = suspects.way.size, p.half.shape[1]
    overlap, normal = np.zeros((3, m)), np.zeros((3, m, d))  # at the beginning, at the end, and between: largest, first
    for k in range(suspects.poses + 2 if m > 0 else 0):
        between = suspects.begin + (k - 1.5) / suspects.poses * (suspects.end - suspects.begin)
        x, q = pose_at(before, after, 1.0 * k if k < 2 else between, dt)
        _, _, turn = bounds(x, q, p.half)
        found, row = narrow(x, turn, p.half, sides, suspects.pairs, 0.0), min(k, 2)
        keep_overlaps(overlap[row], normal[row], suspects.pairs, found)
    check_overlaps(overlap, normal, suspects, t, dt, p.half.shape[0])


def both_sides(planes):
    """Return the planes (p, d + 1) and then their backs, (2p, d + 1)."""
    sides, count = np.empty((2 * planes.shape[0], planes.shape[1])), planes.shape[0]
    for k in range(count):
        for c in range(planes.shape[1]):
            sides[k, c], sides[count + k, c] = planes[k, c], -planes[k, c]
    return sides


# ---------------------------------------------------------------------------------------------- who may meet?

def sagitta(radius, angle):
    """Return how far [m] a point of a body that turns is from its chord at most: R φ²/8, and 2 R for many turns."""
    return radius * min(angle * angle / 8.0, 2.0)


def swept_boxes(before, after, boxes, boxes_new, dt, half):
    """Return (low, high, arc, bulge): boxes around the ways of all bodies, and what their turns add [m].

    arc (n,) is the way of the farthest point as a body turns, bulge (n,) its sagitta, by which the box around both ends
    is widened.  A round body looks the same however it turns: its `turn` stays, and both are 0.
    """
    (low, high, turn), (low_new, high_new, turn_new), n = boxes, boxes_new, half.shape[0]
    arc, bulge = np.zeros(n), np.zeros(n)
    for i in range(n):
        if np.any(turn[i] != turn_new[i]):
            angle = np.sqrt(squared_angle(before.q, after.q, after.omega, dt, i))
            arc[i], bulge[i] = length(half, i) * angle, sagitta(length(half, i), angle)
        for c in range(half.shape[1]):
            low[i, c] = min(low[i, c], low_new[i, c]) - bulge[i]
            high[i, c] = max(high[i, c], high_new[i, c]) + bulge[i]
    return low, high, arc, bulge


def smallest_half(half, i, j):
    """Return the smallest half size [m] of bodies i and j; planes have none."""
    smallest = np.inf
    for c in range(half.shape[1]):
        smallest = min(smallest, half[i, c], half[j, c] if j < half.shape[0] else np.inf)
    return smallest


def way_to_plane(before, after, i, plane):
    """Return the way [m] of the centre of body i towards a plane, or from it; what moves along it stays as near."""
    way = 0.0
    for c in range(plane.size - 1):
        way += plane[c] * (after.x[i, c] - before.x[i, c])
    return abs(way)


def way_and_times(before, after, i, j, reach):
    """Return (way [m] of the centre of i as j sees it, begin, end): shares of the step between which they are within
    `reach` [m]; 0 and 0 if never.

    |x + s u| = reach,      x from one centre to the other at the beginning, u its change within the step
    """
    uu, ux, xx = 0.0, 0.0, 0.0
    for c in range(before.x.shape[1]):
        x = before.x[i, c] - before.x[j, c]
        u = after.x[i, c] - after.x[j, c] - x
        uu, ux, xx = uu + u * u, ux + u * x, xx + x * x
    if uu == 0.0:
        return 0.0, 0.0, 1.0
    inside = ux * ux - uu * (xx - reach * reach)
    if inside < 0.0:
        return np.sqrt(uu), 0.0, 0.0
    return np.sqrt(uu), max((-ux - np.sqrt(inside)) / uu, 0.0), min((-ux + np.sqrt(inside)) / uu, 1.0)


def may_touch(low, high, i, j, p):
    """Return whether the boxes of bodies i and j overlap, or that of i reaches plane j − n, and an impulse moves or
    turns one of both.
    """
    n = p.half.shape[0]
    if p.inv_mass[i] + p.inv_mass[j] == 0.0 and not (np.any(p.inv_inertia[i:i + 1]) or np.any(p.inv_inertia[j:j + 1])):
        return False
    return boxes_overlap(low, high, i, j) if j < n else box_reaches(low, high, i, p.planes[j - n])


def share_a_joint(joints, i, j):
    """Return whether a joint holds bodies i and j together: such bodies do not touch."""
    if joints is not None:
        for k in range(joints.a.size):
            if (joints.a[k] == i and joints.b[k] == j) or (joints.a[k] == j and joints.b[k] == i):
                return True
    return False


def in_contact(contacts, i, j):
    """Return whether the step has found a contact of bodies i and j."""
    for k in range(contacts.a.size):
        if contacts.a[k] == i and contacts.b[k] == j:
            return True
    return False


def find_suspects(before, after, boxes, boxes_new, dt, p):
    """Return the Suspects of a step from the boxes around all bodies at its beginning and at its end.

    A turn about a contact lets it dip in by the sagitta, because the centre moves straight: so much more is allowed.
    Raises Diverged where MOST_POSES are too few to see whether a body passes another one on its way, without its turn.
    """
    low, high, arc, bulge = swept_boxes(before, after, boxes, boxes_new, dt, p.half)
    n, backs, joints = p.half.shape[0], p.planes.shape[0], getattr(p, "joints", None)      # a Bodies has no joints
    first, partner, facts = np.zeros(n + 1, np.int64), [0 for _ in range(0)], [0.0 for _ in range(0)]
    earliest, latest, most, straight = 1.0, 0.0, 0.0, 0.0
    for i in range(n):
        for j in range(i + 1, n + backs):
            size, way, slack = smallest_half(p.half, i, j), arc[i], bulge[i]
            if j < n:
                move, begin, end = way_and_times(before, after, i, j, length(p.half, i) + length(p.half, j))
                way, slack = move + arc[i] + arc[j], bulge[i] + bulge[j]
            else:
                way, begin, end = way_to_plane(before, after, i, p.planes[j - n]) + arc[i], 0.0, 1.0
            if way > size and begin < end and may_touch(low, high, i, j, p) and not share_a_joint(joints, i, j):
                partner.append(j)
                facts += [way, size, TOO_DEEP * size + (slack if in_contact(after.contacts, i, j) else 0.0)]
                earliest, latest, most = min(earliest, begin), max(latest, end), max(most, way / size)
                if j < n:
                    straight = max(straight, (way - arc[i] - arc[j]) / size)
                else:
                    partner.append(j + backs)
                    facts += [way, size, np.inf]
        first[i + 1] = len(partner)
    per_way, facts = POSES_PER_HALF * (latest - earliest), np.array(facts)
    if per_way * straight > MOST_POSES:
        raise Diverged("the number of poses at which to look within a step [-]", per_way * straight, FAR)
    poses = int(min(np.ceil(per_way * most), MOST_POSES))
    return Suspects(Pairs(first, np.array(partner, dtype=np.int64)), facts[0::3], facts[1::3], facts[2::3], earliest,
                    latest, poses)


# ---------------------------------------------------------------------------------------------- do they pass?

def pose_at(before, after, share, dt):
    """Return (x, q) of all bodies when this share of the step is over."""
    return before.x + share * (after.x - before.x), turned(before.q, after.q, after.omega, share, dt)


def turned(q, q_new, omega, share, dt):
    """Return the orientations when this share of the step is over."""
    if q.ndim == 1:
        return q + share * (q_new - q)
    return turn_quaternions(q, omega, share * dt)


def keep_overlaps(overlap, normal, pairs, contacts):
    """Raise the overlaps (m,) [m] of all pairs to those of these contacts, and keep the first normals (m, d), in place.
    """
    for k in range(contacts.a.size):
        i = contacts.a[k]
        for s in range(pairs.first[i], pairs.first[i + 1]):
            if pairs.partner[s] == contacts.b[k]:
                if overlap[s] == 0.0:
                    normal[s] = contacts.n[k]
                overlap[s] = max(overlap[s], -contacts.gap[k])


def have_passed(begin, end, between, met, left, allowed):
    """Return whether two bodies with these overlaps [m], which met with one normal and leave with another, have passed
    each other.
    """
    turned_round = 0.0
    for c in range(met.size):
        turned_round += met[c] * left[c]
    return max(end, between) > begin + allowed and (between > end + allowed or turned_round < 0.0)


def check_overlaps(overlap, normal, suspects, t, dt, n):
    """Raise TooFast for the first of the pairs that have passed each other by their overlaps (3, m) [m] and normals."""
    first, partner = suspects.pairs
    for i in range(n):
        for k in range(first[i], first[i + 1]):
            passed = have_passed(overlap[0, k], overlap[1, k], overlap[2, k], normal[2, k], normal[1, k],
                                 suspects.allowed[k])
            if partner[k] >= n and suspects.allowed[k] < np.inf:             # its back comes next
                passed = passed or (overlap[0, k + 1] > 0.0 and overlap[1, k + 1] == 0.0)
            if passed:
                enough = TOO_DEEP * suspects.size[k] / suspects.way[k] * dt
                raise TooFast(i, partner[k], n, t, dt, suspects.way[k] / dt, enough)
