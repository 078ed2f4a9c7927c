"""What a sweep needs to know of each contact, made once per step; and how free rigid bodies turn."""

from typing import NamedTuple

import numpy as np

from ..checks import float_copy
from ..vectors import dot
from .tuples import across, axes, minus, plus, put, row, scaled, times


class Arms(NamedTuple):
    """Offsets and effective inverse masses of m contacts."""
    r_a: np.ndarray          # (m, d) from the centre of a to the contact [m]
    r_b: np.ndarray          # (m, d) the same for b [m]
    k_n: np.ndarray          # (m,) effective inverse mass along the normal [1/kg]
    k_t: np.ndarray          # (m,) effective inverse mass along the surface [1/kg]: in space a bound for all directions
                             # both are NO_IMPULSE where no impulse changes that velocity


NO_IMPULSE = 1e200           # an effective inverse mass with which a sweep gives no impulse [1/kg]
NO_LEVER = 1e-18             # square of the distance of a line from a centre, over that of its point [-]: round-off


def divisors(k_n, k_t):
    """(k_n, k_t) of two bodies that only turn, or NO_IMPULSE for what is 0 or round-off of the other."""
    least = NO_LEVER * (k_n + k_t)
    return k_n if k_n > least else NO_IMPULSE, k_t if k_t > least else NO_IMPULSE


def arms_2d(x, inv_mass, inv_inertia, c):
    """The Arms of a ContactSet in the plane."""
    m = c.a.size
    arms = Arms(np.empty((m, 2)), np.empty((m, 2)), np.empty(m), np.empty(m))
    for k in range(m):
        a, b, n_x, n_y = c.a[k], c.b[k], c.n[k, 0], c.n[k, 1]
        a_x, a_y, b_x, b_y = c.p[k, 0] - x[a, 0], c.p[k, 1] - x[a, 1], c.p[k, 0] - x[b, 0], c.p[k, 1] - x[b, 1]
        arms.r_a[k, 0], arms.r_a[k, 1], arms.r_b[k, 0], arms.r_b[k, 1] = a_x, a_y, b_x, b_y
        light, I_a, I_b = inv_mass[a] + inv_mass[b], inv_inertia[a], inv_inertia[b]
        arms.k_n[k] = light + I_a * (a_x * n_y - a_y * n_x) ** 2 + I_b * (b_x * n_y - b_y * n_x) ** 2
        arms.k_t[k] = light + I_a * (a_x * n_x + a_y * n_y) ** 2 + I_b * (b_x * n_x + b_y * n_y) ** 2
        if light == 0.0:                                                 # both only turn
            arms.k_n[k], arms.k_t[k] = divisors(arms.k_n[k], arms.k_t[k])
    return arms


def arms_3d(x, inv_mass, inv_inertia, c):
    """The Arms of a ContactSet in space, inv_inertia (n + p, 3, 3) in the world.

    k_t = tr K − k_n is the sum of both eigenvalues of K along the surface, so at least the larger one.  It must be
    one number for all directions: only then does a projection onto the disc of friction come to rest where Coulomb's
    law holds.
    """
    m = c.a.size
    arms = Arms(np.empty((m, 3)), np.empty((m, 3)), np.empty(m), np.empty(m))
    for k in range(m):
        n, p = row(c.n, k), row(c.p, k)
        light, along, trace = inv_mass[c.a[k]] + inv_mass[c.b[k]], 0.0, 0.0
        for body, r in ((c.a[k], arms.r_a), (c.b[k], arms.r_b)):
            arm = minus(p, row(x, body))
            lever = across(arm, n)
            put(r, k, arm)
            along += dot(lever, times(inv_inertia, body, lever))
            both = inv_inertia[body, 0, 0] + inv_inertia[body, 1, 1] + inv_inertia[body, 2, 2]
            trace += dot(arm, arm) * both - dot(arm, times(inv_inertia, body, arm))
        arms.k_n[k], arms.k_t[k] = light + along, 2.0 * light + trace - along
        if light == 0.0:                                                 # both only turn
            arms.k_n[k], arms.k_t[k] = divisors(arms.k_n[k], arms.k_t[k])
    return arms


def apply_impulses_2d(v, omega, J, c, arms, inv_mass, inv_inertia):
    """Velocities of all bodies after impulses J (m, 2) at their contacts, in place."""
    for k in range(c.a.size):
        a, b, J_x, J_y = c.a[k], c.b[k], J[k, 0], J[k, 1]
        v[a, 0] += inv_mass[a] * J_x
        v[a, 1] += inv_mass[a] * J_y
        omega[a] += inv_inertia[a] * (arms.r_a[k, 0] * J_y - arms.r_a[k, 1] * J_x)
        v[b, 0] -= inv_mass[b] * J_x
        v[b, 1] -= inv_mass[b] * J_y
        omega[b] -= inv_inertia[b] * (arms.r_b[k, 0] * J_y - arms.r_b[k, 1] * J_x)


def apply_impulse(v, omega, i, r, J, inv_mass, inv_inertia):
    """Velocities of body i after an impulse J at its offset r, in place."""
    put(v, i, plus(row(v, i), inv_mass[i], J))
    put(omega, i, plus(row(omega, i), 1.0, times(inv_inertia, i, across(r, J))))


def apply_impulses(v, omega, J, c, arms, inv_mass, inv_inertia):
    """The same as apply_impulses_2d in space."""
    for k in range(c.a.size):
        apply_impulse(v, omega, c.a[k], row(arms.r_a, k), row(J, k), inv_mass, inv_inertia)
        apply_impulse(v, omega, c.b[k], row(arms.r_b, k), scaled(-1.0, row(J, k)), inv_mass, inv_inertia)


def point_velocity_of(v, omega, i, r):
    """Velocity of the point of body i at its offset r, in space."""
    return plus(row(v, i), 1.0, across(row(omega, i), r))


def normal_velocities_2d(v, omega, c, arms):
    """u_n (m,) [m/s] of all contacts in the plane."""
    u_n = np.empty(c.a.size)
    for k in range(c.a.size):
        a, b = c.a[k], c.b[k]
        u_x = v[a, 0] - omega[a] * arms.r_a[k, 1] - v[b, 0] + omega[b] * arms.r_b[k, 1]
        u_y = v[a, 1] + omega[a] * arms.r_a[k, 0] - v[b, 1] - omega[b] * arms.r_b[k, 0]
        u_n[k] = c.n[k, 0] * u_x + c.n[k, 1] * u_y
    return u_n


def normal_velocities(v, omega, c, arms):
    """u_n (m,) [m/s] of all contacts in space."""
    u_n = np.empty(c.a.size)
    for k in range(c.a.size):
        u = minus(point_velocity_of(v, omega, c.a[k], row(arms.r_a, k)),
                  point_velocity_of(v, omega, c.b[k], row(arms.r_b, k)))
        u_n[k] = dot(row(c.n, k), u)
    return u_n


def fallen_on(v, inv_mass, gravity, dt):
    """v + dt g of all bodies that can move."""
    v = float_copy(v)
    for i in range(v.shape[0]):
        for c in range(v.shape[1]):
            v[i, c] += dt * gravity[c] if inv_mass[i] > 0.0 else 0.0
    return v


def add_push(v, push):
    """Add push to v, and keep the v from before in push, both in place.

    Both are contiguous and have one shape: (n + p, d) for velocities, (n + p,) for angular ones in the plane.
    """
    total, kept = v.ravel(), push.ravel()
    for k in range(total.size):
        before = total[k]
        total[k], kept[k] = before + kept[k], before


def push_since(v, push):
    """Write the change of v since before add_push into push, in place."""
    total, kept = v.ravel(), push.ravel()
    for k in range(total.size):
        kept[k] = total[k] - kept[k]


def largest_change(v, before):
    """The largest difference of two arrays (n, d)."""
    largest = 0.0
    for i in range(v.shape[0]):
        for c in range(v.shape[1]):
            largest = max(largest, abs(v[i, c] - before[i, c]))
    return largest


def world_inertia(turn, inv_body):
    """I⁻¹ = R I_body⁻¹ Rᵀ (n + p, 3, 3) of all bodies, turn (n, 3, 3),
    from inverse principal moments inv_body (n + p, 3).
    """
    I = np.zeros((inv_body.shape[0], 3, 3))
    for i in range(turn.shape[0]):
        if inv_body[i, 0] == inv_body[i, 1] == inv_body[i, 2]:           # any axes are principal axes
            I[i, 0, 0], I[i, 1, 1], I[i, 2, 2] = inv_body[i]
            continue
        for r in range(3):
            along = turn[i, r, 0] * inv_body[i, 0], turn[i, r, 1] * inv_body[i, 1], turn[i, r, 2] * inv_body[i, 2]
            for c in range(3):
                I[i, r, c] = along[0] * turn[i, c, 0] + along[1] * turn[i, c, 1] + along[2] * turn[i, c, 2]
    return I


def move_2d(x, q, v, omega, ways, dt):
    """New arrays (x (n, 2), q (n,)) after dt in the plane, with v (n + p, 2) and omega (n + p,).

    The ways that bodies have made are added up in place.
    """
    x, q = float_copy(x), float_copy(q)
    for i in range(x.shape[0]):
        x[i, 0] += dt * v[i, 0]
        x[i, 1] += dt * v[i, 1]
        q[i] += dt * omega[i]
        ways.length[i] += dt * (np.sqrt(v[i, 0] ** 2 + v[i, 1] ** 2) + ways.radius[i] * abs(omega[i]))
    return x, q


def move(x, q, v, omega, ways, dt):
    """The same in space, with x (n, 3), quaternions q (n, 4), v (n + p, 3) and omega (n + p, 3)."""
    x = float_copy(x)
    for i in range(x.shape[0]):
        put(x, i, plus(row(x, i), dt, row(v, i)))
        speed, spin = np.sqrt(dot(row(v, i), row(v, i))), np.sqrt(dot(row(omega, i), row(omega, i)))
        ways.length[i] += dt * (speed + ways.radius[i] * spin)
    return x, turn_quaternions(q, omega, dt)


def turn_freely(q, omega, inv_body, dt):
    """ω − dt I⁻¹ (ω × I ω) of n bodies with quaternions q (n, 4): the gyroscopic term of lesson 5, explicit.

    Bodies with three equal moments have no such term.
    """
    omega = float_copy(omega)
    for i in range(q.shape[0]):
        if inv_body[i, 0] == inv_body[i, 1] == inv_body[i, 2]:
            continue
        w, (u_a, u_b, u_c) = row(omega, i), axes(q, i)
        a, b, c = dot(u_a, w), dot(u_b, w), dot(u_c, w)
        I_a, I_b, I_c = 1.0 / inv_body[i, 0], 1.0 / inv_body[i, 1], 1.0 / inv_body[i, 2]
        w = plus(w, dt * (I_b - I_c) * b * c / I_a, u_a)
        w = plus(w, dt * (I_c - I_a) * c * a / I_b, u_b)
        put(omega, i, plus(w, dt * (I_a - I_b) * a * b / I_c, u_c))
    return omega


def turn_quaternions(q, omega, dt):
    """quaternion_update of lesson 5 for all bodies."""
    q = float_copy(q)
    for i in range(q.shape[0]):
        w, a = q[i, 0], (q[i, 1], q[i, 2], q[i, 3])
        h = (0.5 * dt * omega[i, 0], 0.5 * dt * omega[i, 1], 0.5 * dt * omega[i, 2])
        w_new, a_new = w - dot(h, a), plus(plus(a, w, h), 1.0, across(h, a))
        size = np.sqrt(w_new * w_new + dot(a_new, a_new))
        q[i, 0], q[i, 1], q[i, 2], q[i, 3] = w_new / size, a_new[0] / size, a_new[1] / size, a_new[2] / size
    return q


SIDE_BY_SIDE = "add_push", "push_since"   # their loops become vector instructions; their arrays share no memory
