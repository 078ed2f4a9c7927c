"""The parts of the scene that grows: which exercise writes what, and what the room is without it."""

from typing import NamedTuple

import numpy as np

from . import actors


class Part(NamedTuple):
    """A part of the scene: a function that an exercise asks for."""
    actor: object            # moves the things that the part concerns: use → {thing: places}
    off: object              # in its place where it is switched off; None: what the actor does without it
    given: object            # in its place where another part is shown; None: what the actor does without it
    without: str             # label of the left film


def euler(law, t, x, v, dt, p):
    """Given.  Advance by Euler's method."""
    return x + dt * v, v + dt * law(t, x, v, p)


def point_mass(I, m, d):
    """Given.  Return the tensor about a point at the offset d."""
    return I + m * (d @ d * np.eye(3) - np.outer(d, d))


def plate(m, size):
    """Given.  Return the tensor of a box about its centre."""
    square = np.square(size)
    return np.diag(m * (np.sum(square) - square) / 12.0)


def dead(u_n, k_n, e):
    """Given.  Return the impulse after which points do not separate."""
    return max(-u_n / k_n, 0.0)


def lively(u_n, k_n, e):
    """Given.  Return the impulse after which points separate with e times their speed."""
    return dead(u_n, k_n, e) * (1.0 + e)


def shortened(x, net):
    """Given.  Return the points after each thread has been brought to its length, one after the other."""
    x, w = x.copy(), net.inv_mass
    for i, j, long in zip(net.i, net.j, net.rest):
        way = x[i] - x[j]
        size = np.sqrt(way @ way)
        part = (size - long) / size / (w[i] + w[j]) * way
        x[i], x[j] = x[i] - w[i] * part, x[j] + w[j] * part
    return x


def nothing(*_):
    """Return a time that never comes."""
    return np.inf


def unmoved(surface, x, w, solid):
    """Return the points as they are."""
    return x


PARTS = {
    "1.5": Part(actors.moved, euler, actors.velocity_first, "without it: Euler's step"),
    "1.6": Part(actors.thrown, euler, actors.flight, "without it: Euler's step"),
    "2.2": Part(actors.curtain, lambda v, wind, k_v: 0.0 * v, actors.blown, "without it: no air"),
    "2.7": Part(actors.curtain, lambda x, v, net: 0.0 * x, actors.threads_pull, "without it: no threads"),
    "3.7": Part(actors.box, actors.smooth_slide, None, "without it: no friction"),
    "3.16": Part(actors.book, actors.smooth_lid, None, "without it: no friction"),
    "4.5": Part(actors.picture, lambda m, size: np.zeros((3, 3)), plate, "without it: a point mass"),
    "4.11": Part(actors.picture, lambda I, m, d: I, point_mass, "without it: about the centre"),
    "5.10": Part(actors.die, lambda q, omega, dt: q, None, "without it: nothing turns"),
    "5.15": Part(actors.top, lambda t, q, L, top: 0.0 * L, None, "without it: no torque"),
    "6.2": Part(actors.ball, nothing, actors.floor_time, "without it: no floor"),
    "6.4": Part(actors.ball, actors.looked_late, actors.rail_time, "without it: looks after each step"),
    "7.4": Part(actors.ball, dead, lively, "without it: no bounce"),
    "7.10": Part(actors.ball, None, None, "without it: no friction"),
    "8.6": Part(actors.cloth, None, shortened, "without it: springs"),
    "8.11": Part(actors.cloth, unmoved, unmoved, "without it: no obstacle"),
    "9.4": Part(actors.stack, lambda A, b, lam, omega: 0.0 * lam, actors.one_by_one, "without it: no contact"),
    "9.14": Part(actors.stack, lambda now, old, J, near: 0.0 * J, actors.remembered, "without it: no memory"),
    "10.1": Part(actors.parcel, lambda load, t, x, q, v, omega, dt, p: (v, omega), None, "without it: no weight"),
    "10.6": Part(actors.pile, actors.moved_freely, None, "without it: no contact"),
    "11.11": Part(actors.arm, actors.stay, actors.unlimited, "without it: the arm rests"),
    "11.15": Part(actors.arm, None, None, "without it: no limits"),
}


def lesson_of(number):
    """Return the number of the lesson of an exercise."""
    return int(number.partition(".")[0])


def borrowed(lesson):
    """Return {exercise: function} of a room in this lesson: given functions in place of what is written by then."""
    return {number: part.given if lesson_of(number) <= lesson else part.off for number, part in PARTS.items()}
