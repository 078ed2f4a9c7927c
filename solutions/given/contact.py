"""Given with lesson 9.  Piles over many steps, and other solvers for the same laws."""

import numpy as np

from ..checks import check_end, float_copy
from ..contact import *  # noqa: F403    one import has a lesson and its given functions
from ..contact import (
    fischer_burmeister,
    friction_disc,
    gauss_seidel_sweep,
    has_left_margin,
    kept_impulses,
    soft_contact,
    solve,
    velocity_sweep_2d,
)
from ..support.arms import (
    add_push,
    apply_impulses,
    apply_impulses_2d,
    arms_2d,
    arms_3d,
    fallen_on,
    largest_change,
    move,
    move_2d,
    normal_velocities_2d,
    push_since,
    turn_freely,
    world_inertia,
)
from ..support.broad_phase import Pairs, pairs_with
from ..support.contact_points import (
    places_of,
    put_back,
    reordered,
    rotations,
    sorted_rows,
    spread_order,
    with_gap,
    with_gaps,
)
from ..support.kept_contacts import (
    REACH,
    begin_ways,
    forget_deep,
    have_moved,
    mark_far,
    mark_gone,
    of_moved,
    pairs_in_reach,
    places_in,
    replace_contacts,
    replace_in_plane,
    shorten_ways,
    unknown_ways,
    widened,
    with_kept,
    without_gone,
)
from ..support.lanes import (
    AIM,
    ARM_A,
    ARM_B,
    FASTEST,
    GAP,
    GIVE,
    IMPULSE,
    INERTIA_A,
    INERTIA_B,
    K_N,
    K_T,
    MASS_A,
    MASS_B,
    NORMAL,
    OMEGA_A,
    OMEGA_B,
    ROWS,
    V_A,
    V_B,
    WIDE,
    WORK_ROWS,
    contact_velocity,
    gaps_and_impulses,
    in_any_order,
    lanes_for,
    mark_gone_in_lanes,
    number_of_parts,
    part_of,
    pushed,
    put_contacts,
    put_three,
    read_velocities,
    three,
    turned,
    write_velocities,
)
from ..support.records import check_record
from ..support.scenes import (
    PileState,
    check_overlap,
    checked_pile,
    movable,
    overlap_before,
    smaller_half,
    smallest_halves,
)
from ..support.tuples import minus, plus
from ..vectors import dot

SEPARATION = 0.03            # half sizes in 1/hertz [-] by which bodies part that begin inside each other: gently


def separation_speeds(contacts, pile):
    """Given.  The largest speeds (m,) [m/s] at which contacts part: SEPARATION of the smaller half size times hertz."""
    speeds, least = np.empty(contacts.a.size), smallest_halves(pile.half)
    for k in range(speeds.size):
        speeds[k] = SEPARATION * pile.hertz * smaller_half(contacts, k, least)
    return speeds


def contact_targets(gap, J, contacts, arms, fastest, dt, pile):
    """Given.  (aim, give), each (m,), of soft_contact for all contacts, of which none parts faster than its `fastest`.

    A contact that already carries J_n pushes bodies apart with aim − give k_n J_n.  fastest (m,) [m/s], J (m, 2).
    """
    aim, give = np.empty(gap.size), np.empty(gap.size)
    for k in range(gap.size):
        aim[k], give[k] = soft_contact(gap[k], pile.hertz, pile.zeta, dt)
        J_n = J[k, 0] * contacts.n[k, 0] + J[k, 1] * contacts.n[k, 1]
        aim[k] = min(aim[k], fastest[k] + give[k] * arms.k_n[k] * J_n)
    return aim, give


def _follow_2d(gap, aim, give, u_n, h):
    """Given.  The gaps after h with the velocities u_n, and targets that push nothing apart, (m,), in place."""
    for k in range(gap.size):
        gap[k] += h * u_n[k]
        aim[k], give[k] = min(aim[k], 0.0), 0.0


def _pairs_now(low, high, v, moved, wide, pairs, dt, pile):
    """Given.  (wide, pairs): the widened boxes, and the Pairs to look at.

    Both are made anew where a body has left its box; then bodies near the rim of theirs are marked as moved, in place.
    At least one body of a pair is moved or turned by impulses.
    """
    if not has_left_margin(low, high, *wide):
        return wide, pairs
    mark_far(moved, low, high, *wide, pile.margin)
    wide = widened(low, high, v, pile.margin, dt)
    return wide, pairs_with(movable(pile), pairs_in_reach(*wide, pile.planes, pile.margin))


def _found_anew(find_contacts, x, turn, pairs, moved, known, J, ways, pile, first):
    """Given.  (new, J_new (m, d) [N s], at, left, changed): the contacts of bodies that have moved, found anew.

    left: the numbers of their old contacts in `known`;    at: of those whose places the new contacts take.
    changed: whether all must be sorted again, in the `first` step and where a pair touches in more points than before.
    Otherwise the old contacts are marked as gone, and the new ones written, both in `known`.
    """
    new = find_contacts(x, turn, pile.half, pile.planes, pairs_with(moved, pairs), REACH * pile.margin)
    J_new, left, (at, whole) = kept_impulses(new, known, J, pile.margin), of_moved(known, moved), places_in(known, new)
    begin_ways(ways, moved)
    shorten_ways(ways, new, pile.planes.shape[0])
    changed = first or not whole
    if not changed:
        mark_gone(known, known.gap, J, left)
        replace_contacts(known, J, at, new, J_new)
    return new, J_new, at, left, changed


def _substep_2d(x, q, v, omega, push, spin, J, gap, contacts, arms, fastest, ways, h, pile):
    """Given.  (x, q, v, omega, J) after h in the plane, and how much the sweep at rest changed a v [m/s] at most.

    Gravity and the last impulses; a sweep of soft contacts; motion; a sweep at rest, which takes back the velocity that
    only served to push bodies apart.  `push` and `spin` are the changes of v and omega by the last impulses.  They,
    `gap` and `ways` change in place.
    """
    v, omega = fallen_on(v, pile.inv_mass, pile.gravity, h), float_copy(omega)
    add_push(v, push)
    add_push(omega, spin)
    aim, give = contact_targets(gap, J, contacts, arms, fastest, h, pile)
    v, omega, J = velocity_sweep_2d(v, omega, J, aim, give, contacts, arms, pile)
    (x, q), before = move_2d(x, q, v, omega, ways, h), v
    _follow_2d(gap, aim, give, normal_velocities_2d(v, omega, contacts, arms), h)
    v, omega, J = velocity_sweep_2d(v, omega, J, aim, give, contacts, arms, pile)
    push_since(v, push)
    push_since(omega, spin)
    return x, q, v, omega, J, largest_change(v, before)


def advance_pile_2d(bounds, find_contacts, state, dt, steps, pile):
    """Given.  PileState after so many steps in the plane, with disc_bounds and round_contacts, or those of boxes.

    Contacts are found at most once per step, and visited in spread_order.  Those of bodies that have hardly moved are
    kept (support/kept_contacts.py) during a call; the next call finds all of them anew.
    Bodies that begin inside each other part with at most separation_speeds.
    Raises BadInput as checked_pile does, Diverged with the residual where bodies sink into each other, and also where a
    place or a velocity is not finite.
    """
    check_record(pile, state)
    (x, q, v, omega, contacts, J), dt, steps = checked_pile(state, dt, steps, pile)
    h, wide, residual = dt / pile.substeps, (pile.half + np.inf, pile.half), 0.0
    allowed = overlap_before(state, dt, pile.half)
    ways, pairs = unknown_ways(pile.half, pile.planes.shape[0], pile.margin), Pairs(contacts.first, contacts.b)
    order, gap, found, push, spin = np.arange(contacts.a.size), contacts.gap, contacts.gap, v, omega
    for step in range(steps):
        moved = have_moved(ways)
        if np.any(moved):
            low, high, turn = bounds(x, q, pile.half)
            wide, pairs = _pairs_now(low, high, v, moved, wide, pairs, dt, pile)
            J_known = put_back(J, order)
            new, J_new, at, left, changed = _found_anew(find_contacts, x, turn, pairs, moved, contacts, J_known, ways,
                                                        pile, step == 0)
            allowed = check_overlap(new, v, dt, pile.half, allowed, residual)
            if changed:
                contacts, J_known = with_kept(with_gaps(contacts, gap, order), J_known, new, J_new, moved)
                order = spread_order(contacts.a.size)
                place = places_of(order)
                spread, J = reordered(contacts, order), sorted_rows(J_known, order)
                gap, fastest = spread.gap, separation_speeds(spread, pile)
                arms = arms_2d(x, pile.inv_mass, pile.inv_inertia, spread)
            else:
                arms_new = arms_2d(x, pile.inv_mass, pile.inv_inertia, new)
                mark_gone(spread, gap, J, place[left])
                replace_in_plane(spread, gap, J, arms, place[at], new, J_new, arms_new)
            push, spin = np.zeros(v.shape), np.zeros(omega.size)
            apply_impulses_2d(push, spin, J, spread, arms, pile.inv_mass, pile.inv_inertia)
        found = gap.copy()
        forget_deep(ways, spread, gap)
        for _ in range(pile.substeps):
            x, q, v, omega, J, residual = _substep_2d(x, q, v, omega, push, spin, J, gap, spread, arms, fastest, ways,
                                                      h, pile)
    check_end(x, v, dt)
    check_end(q, omega, dt)
    return PileState(x, q, v, omega, *without_gone(with_gaps(contacts, found, order), put_back(J, order)))


def _aim_eight(s, w, h, pile):
    """Given.  The targets of a group of contacts, as contact_targets sets them, in place."""
    for k in range(WIDE):
        aim, give = soft_contact(s[WIDE * GAP + k], pile.hertz, pile.zeta, h)
        load = s[WIDE * K_N + k] * dot(three(s, NORMAL, k), three(s, IMPULSE, k))
        w[WIDE * AIM + k], w[WIDE * GIVE + k] = min(aim, s[WIDE * FASTEST + k] + give * load), give


def _visit_eight(s, w, mu):
    """Given.  Visit a group of contacts, as velocity_sweep visits one, in place."""
    for k in range(WIDE):
        n, old, u = three(s, NORMAL, k), three(s, IMPULSE, k), contact_velocity(s, w, k)
        k_n, give, J_n = s[WIDE * K_N + k], w[WIDE * GIVE + k], dot(n, old)
        J_n += (w[WIDE * AIM + k] - dot(n, u) - give * k_n * J_n) / (k_n * (1.0 + give))
        J_n = 0.0 if J_n <= 0.0 else J_n                                 # a NaN stays one
        stick = plus(old, -1.0 / s[WIDE * K_T + k], u)
        J = plus(friction_disc(plus(stick, -dot(n, stick), n), mu * J_n if J_n > 0.0 else 0.0), J_n, n)
        put_three(s, IMPULSE, k, J)
        J = minus(J, old)
        put_three(w, V_A, k, pushed(s, w, V_A, MASS_A, k, 1.0, J))
        put_three(w, OMEGA_A, k, turned(s, w, OMEGA_A, INERTIA_A, ARM_A, k, 1.0, J))
        put_three(w, V_B, k, pushed(s, w, V_B, MASS_B, k, -1.0, J))
        put_three(w, OMEGA_B, k, turned(s, w, OMEGA_B, INERTIA_B, ARM_B, k, -1.0, J))


def _follow_eight(s, w, h):
    """Given.  The gaps of a group of contacts after h, and targets that push nothing apart, in place."""
    for k in range(WIDE):
        gap = s[WIDE * GAP + k]
        s[WIDE * GAP + k] = gap + h * dot(three(s, NORMAL, k), contact_velocity(s, w, k))
        w[WIDE * AIM + k], w[WIDE * GIVE + k] = min(-gap / h, 0.0), 0.0


SIDE_BY_SIDE = "contact_targets", "_follow_2d", "_aim_eight", "_visit_eight", "_follow_eight"  # vector instructions


def _sweep_part(begin, end, v, omega, lanes, h, pile):
    """Given.  Set the targets of the contacts of some groups, and visit them, in place."""
    w = np.empty(WIDE * WORK_ROWS)
    for group in range(begin, end):
        s = lanes.rows[group]
        read_velocities(w, v, omega, lanes.bodies, group)
        _aim_eight(s, w, h, pile)
        _visit_eight(s, w, pile.mu)
        write_velocities(w, v, omega, lanes.bodies, group, lanes.number[group])


def _rest_part(begin, end, before, spin, v, omega, lanes, h, pile):
    """Given.  Let the gaps of some groups follow `before` and `spin`, and visit their contacts at rest, in place."""
    w = np.empty(WIDE * WORK_ROWS)
    for group in range(begin, end):
        s = lanes.rows[group]
        read_velocities(w, before, spin, lanes.bodies, group)
        _follow_eight(s, w, h)
        read_velocities(w, v, omega, lanes.bodies, group)
        _visit_eight(s, w, pile.mu)
        write_velocities(w, v, omega, lanes.bodies, group, lanes.number[group])


def _sweep_in_lanes(v, omega, lanes, h, pile):
    """Given.  Set the targets of all contacts, and visit them, in place."""
    parts = number_of_parts()
    for turn in range(lanes.turns.size - 1):
        for part in in_any_order(parts):
            begin, end = part_of(lanes, turn, part, parts)
            _sweep_part(begin, end, v, omega, lanes, h, pile)


def _rest_in_lanes(before, spin, v, omega, lanes, h, pile):
    """Given.  Let the gaps follow the velocities `before` and `spin`, and visit all contacts at rest, in place."""
    parts = number_of_parts()
    for turn in range(lanes.turns.size - 1):
        for part in in_any_order(parts):
            begin, end = part_of(lanes, turn, part, parts)
            _rest_part(begin, end, before, spin, v, omega, lanes, h, pile)


def _substep(x, q, v, omega, push, spin, lanes, ways, h, pile):
    """Given.  (x, q, v, omega) and the largest change, as _substep_2d returns them, in space.

    push, spin, lanes and ways change in place.
    """
    v, omega = fallen_on(v, pile.inv_mass, pile.gravity, h), turn_freely(q, omega, pile.inv_inertia, h)
    add_push(v, push)
    add_push(omega, spin)
    _sweep_in_lanes(v, omega, lanes, h, pile)
    (x, q), before = move(x, q, v, omega, ways, h), v.copy()
    _rest_in_lanes(before, omega.copy(), v, omega, lanes, h, pile)
    push_since(v, push)
    push_since(omega, spin)
    return x, q, v, omega, largest_change(v, before)


def advance_pile(bounds, find_contacts, state, dt, steps, pile):
    """Given.  The same in space, with ball_bounds and round_contacts, or box_bounds and box_contacts.

    Inertia in the world is kept with the contacts.  Contacts are visited in the order of their Lanes.
    """
    check_record(pile, state)
    (x, q, v, omega, contacts, J), dt, steps = checked_pile(state, dt, steps, pile)
    h, wide, residual = dt / pile.substeps, (pile.half + np.inf, pile.half), 0.0
    allowed = overlap_before(state, dt, pile.half)
    ways, pairs = unknown_ways(pile.half, pile.planes.shape[0], pile.margin), Pairs(contacts.first, contacts.b)
    gap, found, room, push, spin = contacts.gap, contacts.gap, np.empty((0, WIDE * ROWS)), v, omega
    for step in range(steps):
        moved = have_moved(ways)
        if np.any(moved):
            low, high, turn = bounds(x, q, pile.half)
            wide, pairs = _pairs_now(low, high, v, moved, wide, pairs, dt, pile)
            contacts, inv_inertia = with_gap(contacts, gap), world_inertia(rotations(q, len(low)), pile.inv_inertia)
            new, J_new, at, left, changed = _found_anew(find_contacts, x, turn, pairs, moved, contacts, J, ways, pile,
                                                        step == 0)
            allowed = check_overlap(new, v, dt, pile.half, allowed, residual)
            if changed:
                contacts, J = new, J_new = with_kept(contacts, J, new, J_new, moved)
                lanes, at = lanes_for(contacts, pile.half.shape[0], room), np.arange(contacts.a.size)
                room, push, spin = lanes.rows, np.zeros(v.shape), np.zeros(v.shape)
            else:
                mark_gone_in_lanes(push, spin, lanes, contacts, left)
            gap, arms = contacts.gap, arms_3d(x, pile.inv_mass, inv_inertia, new)
            put_contacts(lanes, at, new, J_new, arms, separation_speeds(new, pile), pile.inv_mass, inv_inertia)
            apply_impulses(push, spin, J_new, new, arms, pile.inv_mass, inv_inertia)
        found = gap
        forget_deep(ways, contacts, gap)
        for _ in range(pile.substeps):
            x, q, v, omega, residual = _substep(x, q, v, omega, push, spin, lanes, ways, h, pile)
        gap, J = gaps_and_impulses(lanes)
    check_end(x, v, dt)
    check_end(q, omega, dt)
    return PileState(x, q, v, omega, *without_gone(with_gap(contacts, found), J))


def pile_trajectory(advance, bounds, find_contacts, state, dt, steps, pile):
    """Given.  All PileStates, the first included, of so many steps by advance_pile_2d or advance_pile."""
    check_record(pile, state)
    states = [state]
    for _ in range(steps):
        states.append(advance(bounds, find_contacts, states[-1], dt, 1, pile))
    return states


# ---------------------------------------------------------------------- other solvers, for impulses J (2m,)

def jacobi_step(A, b, J, mu, r):
    """Given.  Return J after all contacts apply the proximal map at once, with the factors r (2m,) [kg].

    All u come from the given J, and the limits from the new J_n.  It converges for small r only.
    """
    free, new = J - r * (A @ J + b), np.empty(J.size)
    for n in range(0, J.size, 2):
        new[n] = np.maximum(0.0, free[n])
        limit = mu[n // 2] * new[n] if new[n] > 0.0 else 0.0
        new[n + 1] = np.minimum(np.maximum(free[n + 1], -limit), limit)
    return new


def normals_first_sweep(A, b, J, mu):
    """Given.  Return J after projected Gauss–Seidel over all normals, then over all tangents, as Bullet visits them."""
    J = float_copy(J)
    A_n, b_n = np.ascontiguousarray(A[::2, ::2]), b[::2] + np.ascontiguousarray(A[::2, 1::2]) @ J[1::2].copy()
    J[::2] = gauss_seidel_sweep(A_n, b_n, J[::2].copy(), 1.0)
    for t in range(1, J.size, 2):
        limit = mu[t // 2] * J[t - 1] if J[t - 1] > 0.0 else 0.0
        J[t] = np.minimum(np.maximum(J[t] - (A[t] @ J + b[t]) / A[t, t], -limit), limit)
    return J


def minimum_map_step_with_friction(A, b, J, mu):
    """Given.  Return J after one step of Newton's method for cone_residual = 0: minimum_map_step with friction.

    Friction that would leave its limit ±μ J_n is set to it, with the J_n of the same step.
    """
    u, matrix, right = A @ J + b, np.diag(np.diag(float_copy(A))), np.zeros(b.size)
    for n in range(0, b.size, 2):
        t = n + 1
        if u[n] >= A[n, n] * J[n]:                                       # it opens, and then nothing rubs
            continue
        matrix[n], right[n] = A[n], -b[n]
        free, limit = J[t] - u[t] / A[t, t], mu[n // 2] * J[n] if J[n] > 0.0 else 0.0
        if np.abs(free) <= limit:
            matrix[t], right[t] = A[t], -b[t]
        else:
            matrix[t, n] = (-mu[n // 2] if free > 0.0 else mu[n // 2]) * A[t, t]
    return solve(matrix, right)


def fischer_burmeister_step(A, b, J, mu):
    """Given.  Return J after one step of Newton's method for φ = 0 at all contacts, φ from fischer_burmeister; μ < ∞.

    Normal:  φ(k_n J_n, u_n).  Friction, which has two limits:  φ(k_t (J_t + μ J_n), −φ(k_t (μ J_n − J_t), −u_t)).
    *Source:* Billups 1995 for two limits.
    """
    u, matrix, phi = A @ J + b, np.empty(A.shape), np.empty(b.size)
    for n in range(0, b.size, 2):
        t, limit, k_t = n + 1, mu[n // 2] * J[n], A[n + 1, n + 1]
        phi[n], by_J, by_u = fischer_burmeister(A[n, n] * J[n], u[n])
        matrix[n] = by_u * A[n]
        matrix[n, n] += by_J * A[n, n]
        upper, by_room, by_slip = fischer_burmeister(k_t * (limit - J[t]), -u[t])
        phi[t], by_lower, by_upper = fischer_burmeister(k_t * (limit + J[t]), -upper)
        matrix[t] = by_upper * by_slip * A[t]
        matrix[t, n] += (by_lower - by_upper * by_room) * k_t * mu[n // 2]
        matrix[t, t] += (by_lower + by_upper * by_room) * k_t
    return J - solve(matrix, phi)


def relaxed_sweep(A, b, J, mu):
    """Given.  Return J after a sweep for the convex relaxation: the least  ½ J·A J + b·J  with all J in their cones.

    Each contact moves by −u/k, with k its larger diagonal entry plus the coupling, and then to the nearest point of the
    cone |J_t| ≤ μ J_n; μ < ∞.  The order is that of cone_sweep.
    *Source:* Anitescu and Tasora 2010.
    """
    J = float_copy(J)
    for n in range(0, J.size, 2):
        t, m = n + 1, mu[n // 2]
        k = np.maximum(A[n, n], A[t, t]) + np.abs(A[n, t])
        J_n, J_t = J[n] - (A[n] @ J + b[n]) / k, J[t] - (A[t] @ J + b[t]) / k
        if J_n < 0.0 or np.abs(J_t) > m * J_n:                           # outside: to the edge, or to its tip
            along = np.maximum(0.0, J_n + m * np.abs(J_t)) / (1.0 + m * m)
            J_n, J_t = along, m * along * np.sign(J_t)
        J[n], J[t] = J_n, J_t
    return J
