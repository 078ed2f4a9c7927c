"""Contacts in space, eight side by side: a processor computes with four or eight numbers as fast as with one.

It can do so only if no contact of the eight waits for another one, so no two of them may share a body that moves.
Each contact gets the first colour that none of its bodies has yet, and a group holds contacts of one colour.
*Source:* graph colouring, as in Box2D 3.
"""

from typing import NamedTuple

import numpy as np

from .kept_contacts import GONE
from .tuples import across, minus, plus, put, row

WIDE = 8                     # contacts of a group [-]
SPARE = 8                    # groups for which there is memory for one more [-]: new memory in each step takes time
COLOURS = 62                 # [-]; a contact for which none is free is a group of its own
in_any_order = range         # over the parts of a turn; threads may share them

# Rows of a group: what begins a line of three is a vector, an inertia has six rows, and a number has one.
NORMAL, ARM_A, ARM_B, IMPULSE = 0, 3, 6, 9
INERTIA_A, INERTIA_B = 12, 18
MASS_A, MASS_B, K_N, K_T, FASTEST, GAP = 24, 25, 26, 27, 28, 29
ROWS = 30

# Rows of the working memory, which holds the numbers of one group while it is visited
V_A, OMEGA_A, V_B, OMEGA_B, AIM, GIVE = 0, 3, 6, 9, 12, 13
WORK_ROWS = 14


def number_of_parts():
    """Into how many parts the groups of a turn are divided.

    `validate/speed/threads.py` puts the number of threads in its place.
    """
    return 1


class Lanes(NamedTuple):
    """Groups of up to eight contacts.  Entry 8 r + k of a group is row r of its contact k."""
    number: np.ndarray       # (groups,) how many contacts each has
    bodies: np.ndarray       # (groups, 16) their bodies a, and then their bodies b
    rows: np.ndarray         # (groups or more, 8 ROWS) their numbers
    place: np.ndarray        # (m,) where each contact is: 8 times its group, and its number in it
    turns: np.ndarray        # groups turns[k] to turns[k + 1] − 1 share no body that moves


def three(s, r, k):
    """The vector in the rows r, r + 1, r + 2 of contact k."""
    return s[WIDE * r + k], s[WIDE * (r + 1) + k], s[WIDE * (r + 2) + k]


def put_three(s, r, k, a):
    """Write a vector into those rows, in place."""
    s[WIDE * r + k], s[WIDE * (r + 1) + k], s[WIDE * (r + 2) + k] = a


def inertia_times(s, r, k, b):
    """I⁻¹ b of contact k, whose I⁻¹ is in six rows: xx, xy, xz, yy, yz, zz."""
    xy, xz, yz = s[WIDE * (r + 1) + k], s[WIDE * (r + 2) + k], s[WIDE * (r + 4) + k]
    return (s[WIDE * r + k] * b[0] + xy * b[1] + xz * b[2], xy * b[0] + s[WIDE * (r + 3) + k] * b[1] + yz * b[2],
            xz * b[0] + yz * b[1] + s[WIDE * (r + 5) + k] * b[2])


def colours_of(c, moving):
    """(m,) the colour of each contact; bodies from number `moving` on never move, and may be shared."""
    taken, colour = np.zeros(moving, np.int64), np.empty(c.a.size, np.int64)
    for k in range(c.a.size):
        a, b = c.a[k], c.b[k]
        both, free = taken[a] | (taken[b] if b < moving else 0), 0
        while free < COLOURS and both >> free & 1:
            free += 1
        colour[k] = free
        taken[a] |= 1 << free
        if b < moving:
            taken[b] |= 1 << free
    return colour


def lanes_for(c, moving, room):
    """The Lanes of a ContactSet, in `room` if that has enough rows.  Their numbers are still to be written."""
    colour, m = colours_of(c, moving), c.a.size
    groups, count = np.zeros(COLOURS + 2, np.int64), np.zeros(COLOURS + 1, np.int64)
    for k in range(m):
        count[colour[k]] += 1
    for k in range(COLOURS + 1):
        groups[k + 1] = groups[k] + ((count[k] + WIDE - 1) // WIDE if k < COLOURS else count[k])
    total, turns = groups[-1], np.append(groups[:COLOURS], np.arange(groups[COLOURS], groups[-1] + 1))
    if room.shape[0] < total:
        room = np.empty((total + total // SPARE, WIDE * ROWS))
    lanes = Lanes(np.zeros(total, np.int64), np.zeros((total, 2 * WIDE), np.uint32), room, np.empty(m, np.int64),
                  np.unique(turns))
    for k in range(m):
        group = groups[colour[k]]
        i = lanes.number[group]
        lanes.place[k] = WIDE * group + i
        lanes.bodies[group, i], lanes.bodies[group, WIDE + i] = c.a[k], c.b[k]
        lanes.number[group] = i + 1
        if i + 1 == WIDE or colour[k] == COLOURS:
            groups[colour[k]] = group + 1
    clear_unused(lanes)
    return lanes


def clear_unused(lanes):
    """Write zeros where a group has fewer than eight contacts, and ones where a visit divides, in place."""
    for group in range(lanes.number.size):
        for i in range(lanes.number[group], WIDE):
            for r in range(ROWS):
                lanes.rows[group, WIDE * r + i] = 1.0 if r == K_N or r == K_T else 0.0


def put_contacts(lanes, at, c, J, arms, fastest, inv_mass, inv_inertia):
    """Write contacts into their lanes, in place: contact k of c, with its impulse, Arms and so on, is number at[k]."""
    for k in range(c.a.size):
        place = lanes.place[at[k]]
        s, i, a, b = lanes.rows[place // WIDE], place % WIDE, c.a[k], c.b[k]
        for e in range(3):
            s[WIDE * (NORMAL + e) + i], s[WIDE * (IMPULSE + e) + i] = c.n[k, e], J[k, e]
            s[WIDE * (ARM_A + e) + i], s[WIDE * (ARM_B + e) + i] = arms.r_a[k, e], arms.r_b[k, e]
        row = 0
        for e in range(3):
            for f in range(e, 3):
                s[WIDE * (INERTIA_A + row) + i] = inv_inertia[a, e, f]
                s[WIDE * (INERTIA_B + row) + i] = inv_inertia[b, e, f]
                row += 1
        s[WIDE * MASS_A + i], s[WIDE * MASS_B + i] = inv_mass[a], inv_mass[b]
        s[WIDE * K_N + i], s[WIDE * K_T + i] = arms.k_n[k], arms.k_t[k]
        s[WIDE * GAP + i], s[WIDE * FASTEST + i] = c.gap[k], fastest[k]


def mark_gone_in_lanes(push, spin, lanes, c, left):
    """Mark contacts as gone, in place.  left: their numbers.

    Their impulses no longer count in `push` and `spin`, the changes (n + p, 3) of all velocities by impulses.
    """
    for k in left:
        s, i, a, b = lanes.rows[lanes.place[k] // WIDE], lanes.place[k] % WIDE, c.a[k], c.b[k]
        J = three(s, IMPULSE, i)
        put(push, a, plus(row(push, a), -s[WIDE * MASS_A + i], J))
        put(push, b, plus(row(push, b), s[WIDE * MASS_B + i], J))
        put(spin, a, minus(row(spin, a), inertia_times(s, INERTIA_A, i, across(three(s, ARM_A, i), J))))
        put(spin, b, plus(row(spin, b), 1.0, inertia_times(s, INERTIA_B, i, across(three(s, ARM_B, i), J))))
        put_three(s, IMPULSE, i, (0.0, 0.0, 0.0))
        s[WIDE * GAP + i] = GONE


def gaps_and_impulses(lanes):
    """(gap (m,), J (m, 3)) of all contacts, in the order of the ContactSet."""
    gap, J = np.empty(lanes.place.size), np.empty((lanes.place.size, 3))
    for k in range(gap.size):
        s, i = lanes.rows[lanes.place[k] // WIDE], lanes.place[k] % WIDE
        gap[k] = s[WIDE * GAP + i]
        for e in range(3):
            J[k, e] = s[WIDE * (IMPULSE + e) + i]
    return gap, J


def part_of(lanes, turn, part, parts):
    """(begin, end): the groups of a part of a turn."""
    begin, size = lanes.turns[turn], lanes.turns[turn + 1] - lanes.turns[turn]
    return begin + part * size // parts, begin + (part + 1) * size // parts


def read_velocities(w, v, omega, bodies, group):
    """Write the velocities of the bodies of a group side by side into the rows w, in place."""
    for k in range(WIDE):
        a, b = bodies[group, k], bodies[group, WIDE + k]
        for e in range(3):
            w[WIDE * (V_A + e) + k], w[WIDE * (OMEGA_A + e) + k] = v[a, e], omega[a, e]
            w[WIDE * (V_B + e) + k], w[WIDE * (OMEGA_B + e) + k] = v[b, e], omega[b, e]


def write_velocities(w, v, omega, bodies, group, number):
    """Write back the velocities of the bodies of a group of so many contacts, in place."""
    for k in range(number):
        a, b = bodies[group, k], bodies[group, WIDE + k]
        for e in range(3):
            v[a, e], omega[a, e] = w[WIDE * (V_A + e) + k], w[WIDE * (OMEGA_A + e) + k]
            v[b, e], omega[b, e] = w[WIDE * (V_B + e) + k], w[WIDE * (OMEGA_B + e) + k]


def pushed(s, w, v, mass, k, sign, J):
    """The velocity in row v of contact k after an impulse sign J; the inverse mass is in row `mass`."""
    return plus(three(w, v, k), sign * s[WIDE * mass + k], J)


def turned(s, w, omega, inertia, arm, k, sign, J):
    """The angular velocity in row `omega` after the same impulse; its arm and I⁻¹ are in rows `arm` and `inertia`."""
    return plus(three(w, omega, k), sign, inertia_times(s, inertia, k, across(three(s, arm, k), J)))


def contact_velocity(s, w, k):
    """The velocity of a's point of contact k relative to b's."""
    of_a = plus(three(w, V_A, k), 1.0, across(three(w, OMEGA_A, k), three(s, ARM_A, k)))
    return minus(of_a, plus(three(w, V_B, k), 1.0, across(three(w, OMEGA_B, k), three(s, ARM_B, k))))


SIDE_BY_SIDE = ("read_velocities",)      # its loop becomes vector instructions; its arrays share no memory
