"""The parts of the scene that grows: which exercise writes what, and what the room is without it."""

from functools import partial
from typing import NamedTuple

import numpy as np

from . import actors, room, swaps
from .swaps import in_place

FINE_BALL = partial(actors.thrown, dt=swaps.FINE)


class Part(NamedTuple):
    """A part of the scene: a function that an exercise asks for."""
    actor: object            # moves the things that the part concerns: use → {thing: places}
    off: object              # in its place where it is switched off; None: what the actor does without it
    given: object            # in its place where another part is shown; None: what the actor does without it
    without: str             # label of the left film
    whole: bool = True       # also in the film of its lesson; False: in its own film only


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


def nothing(*_):
    """Return a time that never comes."""
    return np.inf


def unmoved(surface, x, w, solid):
    """Return the points as they are."""
    return x


def own(actor, off, without, given=None):
    """Return a part that has a film of its own, and is not in the film of its lesson."""
    return Part(actor, off, given, f"without it: {without}", whole=False)


def by_step(number, form=None, ball=actors.thrown):
    """Return the actor of the ball that is thrown up, by an exercise in the place of the step."""
    return in_place(ball, "1.6", number, form)


def by_sweep(number, form):
    """Return the actor of the curtain of lesson 8, by an exercise within its sweep."""
    return in_place(partial(actors.cloth, steps=4), "8.6", number, form)


def by_curtain(number, form=None):
    """Return the actor of the curtain, by an exercise in the place of the step."""
    return in_place(actors.moved, "1.5", number, form)


def by_impact(number, form):
    """Return the actor of the ball that hits rail and floor, by an exercise in the place of the impulse."""
    return in_place(actors.ball, "7.10", number, form)


def by_brick(number, form=None):
    """Return the actor of the brick, by an exercise in the place of its step."""
    return in_place(swaps.brick, "5.12", number, form)


def by_solver(number, form, stack=actors.stack, given=()):
    """Return the actor of the stack, by an exercise in the place of its sweep."""
    return in_place(stack, "9.4", number, form, given)


def by_arm(number, form=None):
    """Return the actor of the arm, by an exercise in the place of its step."""
    return in_place(actors.arm, "11.11", number, form, (("11.15", None),))


def no_torque(q, omega, tau, I_body):
    """Return no angular acceleration."""
    return np.zeros(3)


def no_moment(*sizes):
    """Return a tensor without a moment."""
    return np.zeros((3, 3))


def unturned(q, *_):
    """Return the orientation as it is."""
    return q


PARTS = {
    "1.1": own(by_step("1.1"), swaps.straight, "no acceleration"),
    "1.2": own(by_step("1.2"), euler, "Euler's step"),
    "1.3": own(by_curtain("1.3"), euler, "Euler's step"),
    "1.4": own(by_step("1.4"), actors.velocity_first, "the new velocity alone"),
    "1.5": Part(actors.moved, euler, actors.velocity_first, "without it: Euler's step"),
    "1.6": Part(actors.thrown, euler, actors.flight, "without it: Euler's step"),
    "1.13": own(by_step("1.13"), euler, "Euler's step"),
    "2.1": own(by_step("2.1", swaps.attracted), lambda x_a, *_: 0.0 * x_a, "no gravity"),
    "2.2": Part(actors.curtain, lambda v, wind, k_v: 0.0 * v, actors.blown, "without it: no air"),
    "2.3": own(in_place(actors.curtain, "2.7", "2.3", swaps.pulled_by), lambda length, rate, rest, k, k_d: 0.0,
               "no tension"),
    "2.5": own(by_step("2.5", swaps.soft_floor, FINE_BALL), lambda C, C_rate, n, k, k_d: 0.0 * n, "no floor"),
    "2.7": Part(actors.curtain, lambda x, v, net: 0.0 * x, actors.threads_pull, "without it: no threads"),
    "2.8": own(by_curtain("2.8", swaps.with_law), swaps.only_weight, "no forces but weight"),
    "2.10": own(in_place(actors.curtain, "2.7", "2.10", swaps.tied), lambda *_: np.zeros((0, 2), int),
                "no diagonal threads"),
    "2.14": own(by_step("2.14", swaps.led), swaps.pulled_now, "the force at the beginning of the step"),
    "3.1": own(in_place(actors.box, "3.7", "3.1", swaps.supported), lambda F, n: 0.0, "no support"),
    "3.2": own(in_place(actors.book, "3.16", "3.2", swaps.at_rest), lambda F, n, mu: 0.0 * F, "no friction"),
    "3.3": own(in_place(actors.box, "3.7", "3.3", swaps.braked), lambda F, v, n, mu: 0.0 * F, "no friction"),
    "3.5": own(in_place(actors.box, "3.7", "3.5", swaps.by_impulse), lambda v, m, j, mu: 0.0 * v, "no friction"),
    "3.7": Part(actors.box, actors.smooth_slide, None, "without it: no friction"),
    "3.13": own(by_step("3.13", swaps.hit_floor, FINE_BALL), lambda v, *_: 0.0 * v, "only the place is put back"),
    "3.14": own(by_step("3.14", swaps.on_floor, FINE_BALL), swaps.no_contact, "no contact"),
    "3.15": own(in_place(actors.book, "3.16", "3.15", swaps.put_back), lambda moved, *_: 0.0 * moved, "no correction"),
    "3.16": Part(actors.book, actors.smooth_lid, None, "without it: no friction"),
    "3.19": own(in_place(actors.box, "3.7", "3.19", swaps.by_impulse), lambda v, m, j, mu: 0.0 * v, "no friction"),
    "4.4": own(in_place(actors.picture, "4.5", "4.4", swaps.many_points, (("4.11", swaps.kept),)), swaps.one_point,
               "all mass in the middle"),
    "4.5": Part(actors.picture, lambda m, size: np.zeros((3, 3)), plate, "without it: a point mass"),
    "4.6": own(swaps.roller("4.6"), no_moment, "no moment"),
    "4.7": own(swaps.roller("4.7", 0.2), no_moment, "no moment"),
    "4.8": own(swaps.roller("4.8", 0.2), no_moment, "no moment"),
    "4.11": Part(actors.picture, lambda I, m, d: I, point_mass, "without it: about the centre"),
    "4.12": own(in_place(actors.picture, "4.5", "4.12", swaps.two_boards), swaps.only_added, "moments only added"),
    "5.6": own(in_place(actors.die, "5.10", "5.6", swaps.by_matrix), unturned, "nothing turns"),
    "5.7": own(in_place(actors.die, "5.10", "5.7", swaps.by_matrix), unturned, "nothing turns"),
    "5.8": own(in_place(actors.die, "5.10", "5.8", swaps.by_product), lambda a, b: 0.0 * b, "nothing turns"),
    "5.9": own(in_place(actors.die, "5.9", "5.9", None, (("5.10", swaps.turned_on),)), lambda q: np.eye(3),
               "nothing turns", actors.matrix_of),
    "5.10": Part(actors.die, lambda q, omega, dt: q, None, "without it: nothing turns"),
    "5.11": own(by_brick("5.11", swaps.tumbled), no_torque, "the spin stays"),
    "5.12": own(by_brick("5.12"), swaps.still_body, "nothing moves"),
    "5.15": Part(actors.top, lambda t, q, L, top: 0.0 * L, None, "without it: no torque"),
    "5.16": own(by_brick("5.16", swaps.freely), unturned, "nothing turns"),
    "5.17": own(by_brick("5.17", swaps.freely), unturned, "nothing turns"),
    "6.1": own(in_place(actors.ball, "6.2", "6.1", swaps.measured_floor), lambda p, plane: 9.0, "no floor"),
    "6.2": Part(actors.ball, nothing, actors.floor_time, "without it: no floor"),
    "6.4": Part(actors.ball, actors.looked_late, actors.rail_time, "without it: looks after each step"),
    "6.5": own(swaps.landed("6.5", swaps.at_lid, (0.5, 0.8)), lambda p, a, b: a, "only the upper end"),
    "6.7": own(swaps.landed("6.7", swaps.at_corner_of_lid, (0.5, 0.8)), lambda p, a, b, c: a, "only a corner"),
    "6.8": own(swaps.landed("6.8", swaps.at_sill, (0.85, 1.5)), swaps.far, "no sill"),
    "6.12": own(swaps.landed("6.12", swaps.at_edge, (0.85, 1.5)), lambda a, b: (9.0, 0), "no sill"),
    "6.15": own(swaps.landed("6.15", swaps.at_hull, (0.85, 1.5)), swaps.far, "no sill"),
    "6.16": own(by_step("6.16", swaps.repelled, FINE_BALL), lambda x, *_: 0.0 * x, "no field"),
    "7.1": own(by_impact("7.1", swaps.kinematic), swaps.dead_stop, "no bounce"),
    "7.2": own(by_step("7.2", swaps.penalty_floor, FINE_BALL), lambda *_: 0.0, "no floor"),
    "7.3": own(in_place(actors.ball, "7.3", "7.3", None, (("7.10", swaps.cone),)), lambda a, b, r_a, r_b: a.v - b.v,
               "spin is no slip", actors.slip_of),
    "7.4": Part(actors.ball, dead, lively, "without it: no bounce"),
    "7.6": own(in_place(actors.ball, "7.6", "7.6", None, (("7.10", swaps.cone),)), swaps.velocity_only,
               "nothing turns", actors.pushed),
    "7.9": own(by_impact("7.9", swaps.with_response), swaps.only_mass, "as if it could not turn"),
    "7.10": Part(actors.ball, None, None, "without it: no friction"),
    "7.15": own(by_step("7.15", swaps.rebound, FINE_BALL), swaps.no_contact, "no contact"),
    "7.16": own(by_step("7.16", swaps.rebound), swaps.no_contact, "no contact"),
    "7.20": own(by_impact("7.20", swaps.own_law), swaps.smooth, "no friction"),
    "8.1": own(by_sweep("8.1", swaps.measured), lambda x_i, x_j, rest: (0.0, 0.0 * x_i), "no threads"),
    "8.2": own(by_sweep("8.2", swaps.corrected), lambda C, gradients, w: 0.0 * gradients, "no threads"),
    "8.3": own(by_curtain("8.3", swaps.predicted), lambda law, t, x, v, dt, net: x + dt * v, "no forces"),
    "8.6": Part(actors.cloth, None, swaps.shortened, "without it: springs"),
    "8.7": own(by_curtain("8.7", swaps.projected), swaps.free_fall, "no threads"),
    "8.10": own(in_place(actors.cloth, "8.11", "8.10", swaps.kept_out), lambda x, obstacle: (9.0, x), "no obstacle"),
    "8.11": Part(actors.cloth, unmoved, unmoved, "without it: no obstacle"),
    "8.14": own(by_curtain("8.14", swaps.elastic), swaps.rigid, "threads that do not stretch"),
    "9.2": own(by_solver("9.2", swaps.coupled), swaps.alone, "contacts do not know each other"),
    "9.4": Part(actors.stack, lambda A, b, lam, omega: 0.0 * lam, actors.one_by_one, "without it: no contact"),
    "9.8": own(by_solver("9.8", swaps.exact), lambda A, b: 0.0 * b, "no contact"),
    "9.10": own(by_solver("9.10", swaps.in_cones), lambda A, b, J, mu: 0.0 * J, "no contact"),
    "9.14": Part(actors.stack, lambda now, old, J, near: 0.0 * J, actors.remembered, "without it: no memory"),
    "9.17": own(by_solver("9.17", swaps.proximal), lambda A, b, J, mu, r: 0.0 * J, "no contact"),
    "9.19": own(by_solver("9.19", swaps.newton), lambda A, b, lam: 0.0 * lam, "no contact"),
    "9.22": own(by_solver("9.22", swaps.faster, partial(actors.stack, sweeps=1), (("9.14", swaps.forgotten),)),
                swaps.plain_sweeps, "as many plain sweeps"),
    "10.1": Part(actors.parcel, lambda load, t, x, q, v, omega, dt, p: (v, omega), None, "without it: no weight"),
    "10.3": own(actors.parcel, swaps.still_body, "nothing moves"),
    "10.4": own(by_brick("10.4", swaps.among_bodies), swaps.still_body, "nothing moves"),
    "10.6": Part(actors.pile, actors.moved_freely, None, "without it: no contact"),
    "10.11": own(swaps.rolled, swaps.slides_on, "no friction"),
    "11.1": own(by_arm("11.1", swaps.placed), lambda theta, lengths: np.zeros((4, 2)), "the hand is nowhere"),
    "11.2": own(by_arm("11.2", swaps.with_jacobian), lambda x: np.zeros((2, 3)), "no joint moves the hand"),
    "11.5": own(by_arm("11.5", swaps.in_one_step), lambda target, lengths, elbow: room.REST, "the arm rests"),
    "11.9": own(by_arm("11.9"), actors.stay, "the arm rests"),
    "11.10": own(by_arm("11.10", swaps.inverted), lambda J: 0.0 * J.T, "the arm rests"),
    "11.11": Part(actors.arm, actors.stay, actors.unlimited, "without it: the arm rests"),
    "11.13": own(by_arm("11.13", swaps.around_base), actors.stay, "the arm rests"),
    "11.14": own(by_arm("11.14", swaps.by_places), lambda x, target, lengths: x, "the arm rests"),
    "11.15": Part(actors.arm, None, None, "without it: no limits"),
    "11.16": own(by_arm("11.16", swaps.with_rest), actors.stay, "the arm rests"),
    "12.1": own(swaps.aimed("12.1", swaps.by_difference), lambda f, s, h, p: np.zeros(2), "the first throw"),
    "12.3": own(swaps.aimed("12.3", swaps.by_complex), lambda f, s, h, p: np.zeros(2), "the first throw"),
    "12.4": own(swaps.aimed("12.4", swaps.by_tangents), swaps.as_it_was, "the first throw"),
    "12.10": own(swaps.aimed("12.10"), swaps.first_throw, "the first throw"),
}


def lesson_of(number):
    """Return the number of the lesson of an exercise."""
    return int(number.partition(".")[0])


def borrowed(lesson):
    """Return {exercise: function} of a room in this lesson: given functions in place of what is written by then."""
    return {number: part.given if lesson_of(number) <= lesson else part.off for number, part in PARTS.items()}
