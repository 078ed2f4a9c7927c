"""Given with lesson 9.  Piles over many steps."""

import numpy as np

from ..checks import check_end
from ..contact import *  # noqa: F403    one import has a lesson and its given functions
from ..contact import has_left_margin, kept_impulses, soft_contact, velocity_sweep, velocity_sweep_2d
from ..support.arms import (
    apply_impulses,
    apply_impulses_2d,
    arms_2d,
    arms_3d,
    normal_velocities,
    normal_velocities_2d,
    turn_freely,
    turn_quaternions,
    world_inertia,
)
from ..support.broad_phase import Pairs, near_pairs
from ..support.contact_points import put_back, reordered, spread_order
from ..support.records import check_record
from ..support.scenes import PileState, check_overlap, checked_pile, smaller_half

SEPARATION = 0.03            # half sizes in 1/hertz [-] by which bodies part that begin inside each other: gently


def separation_speeds(contacts, pile):
    """Given.  The largest speeds (m,) [m/s] at which contacts part: SEPARATION of the smaller half size times hertz."""
    speeds = np.empty(contacts.a.size)
    for k in range(speeds.size):
        speeds[k] = SEPARATION * pile.hertz * smaller_half(contacts, k, pile.half)
    return speeds


def contact_targets(gap, load, fastest, dt, pile):
    """Given.  (aim, give), each (m,), of soft_contact for all contacts, of which none parts faster than its `fastest`.

    A contact that already carries J_n pushes bodies apart with aim − give k_n J_n.  load: k_n J_n.  All (m,) [m/s].
    """
    aim, give = np.empty(gap.size), np.empty(gap.size)
    for k in range(gap.size):
        aim[k], give[k] = soft_contact(gap[k], pile.hertz, pile.zeta, dt)
        aim[k] = min(aim[k], fastest[k] + give[k] * load[k])
    return aim, give


def advance_pile_2d(bounds, find_contacts, state, dt, steps, pile):
    """Given.  PileState after so many steps in the plane, with disc_bounds and round_contacts, or those of boxes.

    Contacts are found once per step, and visited in spread_order.  A substep: gravity and the last impulses; a sweep of
    soft contacts; motion; a sweep at rest, which takes back the velocity that only served to push bodies apart.  Bodies
    that begin inside each other part with at most separation_speeds.
    Raises BadInput for hertz that a substep cannot carry, Diverged with the residual where bodies sink into each other.
    """
    check_record(pile, state)
    state, dt, steps = checked_pile(state, dt, steps, pile)
    h, wide_low, wide_high, residual, allowed = dt / pile.substeps, pile.half + np.inf, pile.half, 0.0, np.inf
    (x, q, v, omega, contacts, J), falls = state, (pile.inv_mass > 0.0)[:, None]
    pairs = Pairs(contacts.first, contacts.b)
    for _ in range(steps):
        low, high, turn = bounds(x, q, pile.half)
        if has_left_margin(low, high, wide_low, wide_high):
            wide_low, wide_high = low - pile.margin, high + pile.margin
            pairs = near_pairs(wide_low, wide_high, pile.planes)
        old, contacts = contacts, find_contacts(x, turn, pile.half, pile.planes, pairs, 0.5 * pile.margin)
        allowed = check_overlap(contacts, v, dt, pile.half, allowed, residual)
        J, order = kept_impulses(contacts, old, J, pile.margin), spread_order(contacts.a.size)
        J, spread = J[order], reordered(contacts, order)
        arms, gap = arms_2d(x, pile.inv_mass, pile.inv_inertia, spread), spread.gap
        fastest = separation_speeds(spread, pile)
        for _ in range(pile.substeps):
            aim, give = contact_targets(gap, arms.k_n * np.sum(J * spread.n, axis=1), fastest, h, pile)
            v, omega = v + h * falls * pile.gravity, omega.copy()
            apply_impulses_2d(v, omega, J, spread, arms, pile.inv_mass, pile.inv_inertia)
            v, omega, J = velocity_sweep_2d(v, omega, J, aim, give, spread, arms, pile)
            x, q, before = x + h * v, q + h * omega, v
            gap = gap + h * normal_velocities_2d(v, omega, spread, arms)
            aim, give = np.minimum(aim, 0.0), 0.0 * give
            v, omega, J = velocity_sweep_2d(v, omega, J, aim, give, spread, arms, pile)
        J = put_back(J, order)
        residual = np.max(np.abs(v - before))
    check_end(x, v, dt)
    return PileState(x, q, v, omega, contacts, J)


def advance_pile(bounds, find_contacts, state, dt, steps, pile):
    """Given.  The same in space, with ball_bounds and round_contacts, or box_bounds and box_contacts."""
    check_record(pile, state)
    state, dt, steps = checked_pile(state, dt, steps, pile)
    h, wide_low, wide_high, residual, allowed = dt / pile.substeps, pile.half + np.inf, pile.half, 0.0, np.inf
    (x, q, v, omega, contacts, J), falls = state, (pile.inv_mass > 0.0)[:, None]
    pairs = Pairs(contacts.first, contacts.b)
    for _ in range(steps):
        low, high, turn = bounds(x, q, pile.half)
        if has_left_margin(low, high, wide_low, wide_high):
            wide_low, wide_high = low - pile.margin, high + pile.margin
            pairs = near_pairs(wide_low, wide_high, pile.planes)
        old, contacts = contacts, find_contacts(x, turn, pile.half, pile.planes, pairs, 0.5 * pile.margin)
        allowed = check_overlap(contacts, v, dt, pile.half, allowed, residual)
        inv_inertia = world_inertia(turn, pile.inv_inertia)
        arms = arms_3d(x, pile.inv_mass, inv_inertia, contacts)
        J, gap = kept_impulses(contacts, old, J, pile.margin), contacts.gap
        fastest = separation_speeds(contacts, pile)
        for _ in range(pile.substeps):
            aim, give = contact_targets(gap, arms.k_n * np.sum(J * contacts.n, axis=1), fastest, h, pile)
            v, omega = v + h * falls * pile.gravity, turn_freely(turn, omega, pile.inv_inertia, h)
            apply_impulses(v, omega, J, contacts, arms, pile.inv_mass, inv_inertia)
            v, omega, J = velocity_sweep(v, omega, J, aim, give, contacts, arms, pile.inv_mass, inv_inertia, pile.mu)
            x, q, before = x + h * v, turn_quaternions(q, omega, h), v
            gap = gap + h * normal_velocities(v, omega, contacts, arms)
            aim, give = np.minimum(aim, 0.0), 0.0 * give
            v, omega, J = velocity_sweep(v, omega, J, aim, give, contacts, arms, pile.inv_mass, inv_inertia, pile.mu)
        residual = np.max(np.abs(v - before))
    check_end(x, v, dt)
    return PileState(x, q, v, omega, contacts, J)


def pile_trajectory(advance, bounds, find_contacts, state, dt, steps, pile):
    """Given.  All PileStates, the first included, of so many steps by advance_pile_2d or advance_pile."""
    check_record(pile, state)
    states = [state]
    for _ in range(steps):
        states.append(advance(bounds, find_contacts, states[-1], dt, 1, pile))
    return states
