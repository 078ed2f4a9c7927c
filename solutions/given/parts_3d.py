"""Given with lesson 10.  The parts of our loop in space, as parts.py has them in the plane.

What finds contacts is the same in both.  Between impulses a body turns by splitting_free_rotation of lesson 5, which
holds its angular momentum, so the gyroscopic term needs no part of its own.
"""

import numpy as np

from ..contact import friction_disc, velocity_sweep
from ..simulator import weight
from ..support.arms import (
    apply_impulse,
    apply_impulses,
    arms_3d,
    normal_velocities,
    point_velocity_of,
)
from ..support.contact_points import ContactSet
from ..support.networks import pull_per_length
from ..support.quaternions import rotate, unrotate
from ..support.scenes import PileState
from ..support.tuples import minus, plus, put, row, scaled
from ..vectors import cross, dot
from .joints import (
    close_joints,
    hold_joints,
    kick,
    spatial_inertia,
    turn_on,
)
from .parts import (
    all_shallow,
    along_normals,
    are_deep,
    check_left,
    forget_bounces,
    is_calm,
    islands_of,
    leave_open,
    may_bounce,
    parting_aims,
    pushing_aims,
    share_left,
    swept,
    swept_and_closed,
)
from .rods import close_links, impulses_at_rest

# ---------------------------------------------------------------------------------------------- forces

def model_load_in_space(t, x, q, v, omega, p):
    """Return (F, tau) of gravity, springs and drag on all rows in space."""
    F, tau = weight(t, x, q, v, omega, p)
    for i in range(x.shape[0]):
        if p.inv_mass[i] > 0.0:
            put(F, i, plus(row(F, i), -p.drag, row(v, i)))
    for s in range(p.ends.shape[0]):
        a, b = p.ends[s, 0], p.ends[s, 1]
        r_a, r_b = rotate(q[a], p.arms[s, :3]), rotate(q[b], p.arms[s, 3:])
        way = x[a] + r_a - x[b] - r_b
        u = minus(point_velocity_of(v, omega, a, r_a), point_velocity_of(v, omega, b, r_b))
        pull = pull_per_length(dot(way, way), dot(way, u), p.laws[s])
        F[a] += pull * way
        F[b] -= pull * way
        tau[a] += pull * cross(r_a, way)
        tau[b] -= pull * cross(r_b, way)
    return F, tau


def accelerated_in_space(load, t, state, dt, p):
    """Return the state after the loads at the time t have acted for dt."""
    x, q, v, omega, contacts, J = state
    v, omega = kick(load, t, x, q, v, omega, dt, p)
    return PileState(x, q, v, omega, contacts, J)


def accelerate_in_space(load, bounds, narrow, t, state, dt, p):
    """Return the state after the loads have acted for dt."""
    return accelerated_in_space(load, t, state, dt, p)


def accelerate_half_in_space(load, bounds, narrow, t, state, dt, p):
    """Return the state after the loads have acted for ½ dt."""
    return accelerated_in_space(load, t, state, 0.5 * dt, p)


def accelerate_rest_in_space(load, bounds, narrow, t, state, dt, p):
    """Return the state after the loads at the end of the step have acted for ½ dt."""
    return accelerated_in_space(load, t + dt, state, 0.5 * dt, p)


# ---------------------------------------------------------------------------------------------- contact

def sweep_pairs(v, omega, J, aim, contacts, arms, inv_inertia, p):
    """Return (v, omega, J) after velocity_sweep of lesson 9 over contacts that have a friction of their own each."""
    v, omega, J = v.copy(), omega.copy(), J.copy()
    for k in range(contacts.a.size):
        a, b, old, n = contacts.a[k], contacts.b[k], row(J, k), row(contacts.n, k)
        r_a, r_b = row(arms.r_a, k), row(arms.r_b, k)
        u = minus(point_velocity_of(v, omega, a, r_a), point_velocity_of(v, omega, b, r_b))
        J_n = max(0.0, dot(n, old) + (aim[k] - dot(n, u)) / arms.k_n[k])
        rubs = J_n > 0.0 and p.mu_of[a] > 0.0 and p.mu_of[b] > 0.0
        stick = plus(old, -1.0 / arms.k_t[k], u)
        J_t = friction_disc(plus(stick, -dot(n, stick), n), p.mu_of[a] * p.mu_of[b] * J_n if rubs else 0.0)
        put(J, k, plus(J_t, J_n, n))
        apply_impulse(v, omega, a, r_a, minus(row(J, k), old), p.inv_mass, inv_inertia)
        apply_impulse(v, omega, b, r_b, minus(old, row(J, k)), p.inv_mass, inv_inertia)
    return v, omega, J


def sweep_centres(v, omega, J, aim, contacts, arms, inv_inertia, p):
    """Return the same where nothing rubs and nothing turns: no arms, no tangent."""
    v, J = v.copy(), J.copy()
    for k in range(contacts.a.size):
        a, b, n = contacts.a[k], contacts.b[k], row(contacts.n, k)
        old, u_n = dot(n, row(J, k)), dot(n, minus(row(v, a), row(v, b)))
        J_n = max(0.0, old + (aim[k] - u_n) / (p.inv_mass[a] + p.inv_mass[b]))
        put(J, k, scaled(J_n, n))
        put(v, a, plus(row(v, a), p.inv_mass[a] * (J_n - old), n))
        put(v, b, plus(row(v, b), -p.inv_mass[b] * (J_n - old), n))
    return v, omega, J


def begun_in_space(load, t, free, v, omega, dt, p):
    """Return (v, omega, J, aim, arms, inv_inertia): what the sweeps of a step begin with, as in the plane."""
    x, q, _, _, contacts, J = free
    inv_inertia = spatial_inertia(q, p.inv_inertia)
    J, arms = J.copy(), arms_3d(x, p.inv_mass, inv_inertia, contacts)
    u_n, pressed = normal_velocities(v, omega, contacts, arms), np.zeros(J.shape[0])
    if may_bounce(contacts, p):              # what loads have added, once more, and what closing joints has added
        later, spun = kick(load, t, x, q, free.v, free.omega, dt, p)
        pressed = normal_velocities(v + later - 2.0 * free.v, omega + spun - 2.0 * free.omega, contacts, arms)
    aim, v, omega = parting_aims(u_n, pressed, contacts, dt, p), v.copy(), omega.copy()
    forget_bounces(J, aim)
    apply_impulses(v, omega, J, contacts, arms, p.inv_mass, inv_inertia)
    return v, omega, J, aim, arms, inv_inertia


def begun_of_centres_in_space(load, t, free, v, omega, dt, p):
    """Return the same where nothing rubs and nothing turns."""
    x, q, v_free, omega_free, contacts, J = free
    free = PileState(x, q, v_free, omega_free, contacts, along_normals(J, contacts.n))
    return begun_in_space(load, t, free, v, omega, dt, p)


def contact_impulses_in_space(load, bounds, narrow, t, state, dt, p):
    """Return the state after the impulses of all contacts, each pair with its own friction."""
    return swept(begun_in_space, sweep_pairs, load, t, state, dt, p)


def contact_impulses_of_centres_in_space(load, bounds, narrow, t, state, dt, p):
    """Return the same where nothing rubs and nothing turns."""
    return swept(begun_of_centres_in_space, sweep_centres, load, t, state, dt, p)


def close_rigid(x, q, v, omega, links, dt, p):
    """Return (v, omega, links) after close_joints, which does not need the impulses of links."""
    v, omega = close_joints(x, q, v, omega, dt, p)
    return v, omega, links


def contact_impulses_with_joints_in_space(load, bounds, narrow, t, state, dt, p):
    """Return the same as contact_impulses_in_space, with joints that are closed after every sweep."""
    return swept_and_closed(begun_in_space, sweep_pairs, close_rigid, load, t, state, dt, p)


def contact_impulses_with_rods_in_space(load, bounds, narrow, t, state, dt, p):
    """Return the same with joints and rods."""
    return swept_and_closed(begun_in_space, sweep_pairs, close_links, load, t, state, dt, p)


def separated_in_space(close_all, links, state, dt, p):
    """Return the state with bodies moved out of each other; close_all and links: see swept_and_closed.

    Bodies turn as free bodies do, because close_all expects that of them.  A body that is turned takes its angular
    velocity along, so that its kinetic energy stays.
    """
    x, q, v, omega, contacts, J = state
    inv_inertia = spatial_inertia(q, p.inv_inertia)
    aim, arms, give = pushing_aims(contacts, dt, p), arms_3d(x, p.inv_mass, inv_inertia, contacts), 0.0 * contacts.gap
    push, spin, J_push = 0.0 * v, 0.0 * omega, 0.0 * J
    still, island, most = push, islands_of(contacts, p), np.zeros(p.inv_mass.size)
    for _ in range(p.sweeps):
        before = J_push
        push, spin, J_push = velocity_sweep(push, spin, J_push, aim, give, contacts, arms, p.inv_mass, inv_inertia, 0.0)
        push, spin, links = close_all(x, q, push, spin, links, dt, p)
        if is_calm(J_push, before, push, still, contacts, arms, island, most, p):
            break
    if are_deep(contacts, p):
        _, _, more = velocity_sweep(push, spin, J_push, aim, give, contacts, arms, p.inv_mass, inv_inertia, 0.0)
        check_left(share_left(more, J_push, push, still, contacts, arms))
    gap = contacts.gap + dt * normal_velocities(push, spin, contacts, arms)
    moved = ContactSet(contacts.first, contacts.a, contacts.b, contacts.n, contacts.p, gap)
    turned, carried = turn_on(q, spin, dt, p.inv_inertia)[0], omega.copy()
    for i in range(q.shape[0]):
        if p.inv_inertia[i, 0] > 0.0:
            carried[i] = rotate(turned[i], unrotate(q[i], omega[i]))
    return PileState(x + dt * push, turned, v, carried, moved, J)


def separate_in_space(load, bounds, narrow, t, state, dt, p):
    """Return the state with bodies moved out of each other, as in the plane."""
    return state if all_shallow(state.contacts, p) else separated_in_space(leave_open, np.zeros(0), state, dt, p)


def separate_with_joints_in_space(load, bounds, narrow, t, state, dt, p):
    """Return the same with joints that stay closed."""
    return state if all_shallow(state.contacts, p) else separated_in_space(close_rigid, np.zeros(0), state, dt, p)


def separate_with_rods_in_space(load, bounds, narrow, t, state, dt, p):
    """Return the same with joints and rods."""
    if all_shallow(state.contacts, p):
        return state
    return separated_in_space(close_links, impulses_at_rest(state.x, state.q, dt, p), state, dt, p)


# ---------------------------------------------------------------------------------------------- joints and motion

def close_in_space(load, bounds, narrow, t, state, dt, p):
    """Return the state with velocities that leave no joint open at the end of the step."""
    x, q, v, omega, contacts, J = state
    v, omega = close_joints(x, q, v, omega, dt, p)
    return PileState(x, q, v, omega, contacts, J)


def hold_in_space(load, bounds, narrow, t, state, dt, p):
    """Return the state with velocities at which the joints' points do not part."""
    x, q, v, omega, contacts, J = state
    v, omega = hold_joints(q, v, omega, p)
    return PileState(x, q, v, omega, contacts, J)


def move_and_turn_in_space(load, bounds, narrow, t, state, dt, p):
    """Return the state after all bodies have moved and turned on; their angular momenta stay."""
    x, q, v, omega, contacts, J = state
    q, omega = turn_on(q, omega, dt, p.inv_inertia)
    return PileState(x + dt * v, q, v, omega, contacts, J)
