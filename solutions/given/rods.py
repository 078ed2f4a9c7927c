"""Given with lesson 10.  Rods without mass beside joints, in the plane and in space.

A rod keeps two points at a distance.  It is one row where a joint has as many as there are dimensions:

    C = |p_a − p_b| − length,      J along n = (p_a − p_b)/|p_a − p_b| on a, −J on b

All rows of joints and rods are solved at once, as in joints.py.  A rod with a compliance α is a spring of the stiffness
1/α whose force is that of the end of the step, C = −α J/dt, as in lesson 8.  So it stays calm however stiff it is, and
has the first order.
*Left out:* a band: the matrix is full.
"""

from typing import NamedTuple

import numpy as np

from ..checks import Diverged, float_copy
from ..rotation import body_angular_momentum
from ..simulator import new_velocities_2d
from ..support.arms import apply_impulses, apply_impulses_2d, arms_2d, arms_3d
from ..support.quaternions import rotate, unrotate
from ..support.scenes import PileState
from ..support.small_systems import shortest_solution, solve_band
from ..vectors import cross
from .joints import CLEAR, CLOSED, MOST, NOT_CLOSED, SHAPE, kick, spatial_inertia, turn_on, turned_2d


class Rods(NamedTuple):
    """m pairs of points that keep their distance."""
    a: np.ndarray            # (m,) a body of each
    b: np.ndarray            # (m,) the other body
    r_a: np.ndarray          # (m, d) the point of a, from its centre, in coordinates of a [m]
    r_b: np.ndarray          # (m, d) the same for b [m]
    length: np.ndarray       # (m,) [m]
    compliance: np.ndarray   # (m,) [m/N]


# ---------------------------------------------------------------------------------------------- rows

def arm_of(q, i, r):
    """Return a vector r (d,) of body i in the world."""
    if q.ndim == 1:
        return turned_2d(q[i], r)
    return rotate(q[i], r)


def put_entries(G, s, i, r, way, sign):
    """Write what row s of G has for body i: the point at r moves along `way` (d,)."""
    d = r.size
    at = (3 if d == 2 else 6) * i
    for c in range(d):
        G[s, at + c] = sign * way[c]
    if d == 2:
        G[s, at + 2] = sign * (r[0] * way[1] - r[1] * way[0])
    else:
        turn = cross(r, way)
        for c in range(3):
            G[s, at + 3 + c] = sign * turn[c]


def link_rows(x, q, p):
    """Return (G (rows, 3 n or 6 n), gap (rows,) [m]): G turns the velocities of n bodies into those of the gaps.

    A joint has d rows, one for each coordinate, and a rod has one.
    """
    n, d = x.shape
    joints, rods, m = p.joints, p.rods, d * p.joints.a.size
    G, gap, axes = np.zeros((m + rods.a.size, (3 if d == 2 else 6) * n)), np.zeros(m + rods.a.size), np.eye(d)
    for k in range(joints.a.size):
        a, b = joints.a[k], joints.b[k]
        r_a, r_b = arm_of(q, a, joints.r_a[k]), arm_of(q, b, joints.r_b[k])
        for c in range(d):
            put_entries(G, d * k + c, a, r_a, axes[c], 1.0)
            put_entries(G, d * k + c, b, r_b, axes[c], -1.0)
            gap[d * k + c] = x[a, c] + r_a[c] - x[b, c] - r_b[c]
    for k in range(rods.a.size):
        a, b = rods.a[k], rods.b[k]
        r_a, r_b = arm_of(q, a, rods.r_a[k]), arm_of(q, b, rods.r_b[k])
        way = x[a] + r_a - x[b] - r_b
        length = np.sqrt(np.sum(way * way))
        put_entries(G, m + k, a, r_a, way / length, 1.0)
        put_entries(G, m + k, b, r_b, way / length, -1.0)
        gap[m + k] = length - rods.length[k]
    return G, gap


def softness(p):
    """Return the compliance (rows,) [m/N] of all rows: 0 of joints."""
    return np.concatenate((np.zeros(p.joints.r_a.size), p.rods.compliance))


def no_link_impulses(p):
    """Return the impulses (rows,) [N s] of all rows at the beginning of a step."""
    return np.zeros(p.joints.r_a.size + p.rods.a.size)


def impulses_at_rest(x, q, dt, p):
    """Return the impulses (rows,) [N s] that hold each compliant rod at its present length, J = −C dt/α; else 0."""
    J, soft, (_, gap) = no_link_impulses(p), softness(p), link_rows(x, q, p)
    for s in range(J.size):
        if soft[s] > 0.0:
            J[s] = -gap[s] * dt / soft[s]
    return J


def responses(G, q, p):
    """Return M⁻¹ Gᵀ (3 n or 6 n, rows): velocities of all bodies by unit impulses along the rows."""
    W, wide = np.zeros((G.shape[1], G.shape[0])), G.shape[1] // q.shape[0]
    for i in range(q.shape[0]):
        for c in range(2 if wide == 3 else 3):
            W[wide * i + c] = p.inv_mass[i] * G[:, wide * i + c]
    if q.ndim == 1:
        for i in range(q.shape[0]):
            W[3 * i + 2] = p.inv_inertia[i] * G[:, 3 * i + 2]
    else:
        inv_inertia = spatial_inertia(q, p.inv_inertia)
        for i in range(q.shape[0]):
            for c in range(3):
                for e in range(3):
                    W[6 * i + 3 + c] += inv_inertia[i, c, e] * G[:, 6 * i + 3 + e]
    return W


def in_one_row(v, omega):
    """Return the velocities of all bodies in one array (3 n or 6 n,)."""
    if omega.ndim == 1:
        return np.concatenate((v, omega.reshape(-1, 1)), axis=1).ravel()
    return np.concatenate((v, omega), axis=1).ravel()


def pushed(v, omega, change):
    """Return (v, omega) after a change (3 n or 6 n,) of the velocities of all bodies."""
    rows = change.reshape(v.shape[0], -1)
    if omega.ndim == 1:
        return v + rows[:, :2], omega + rows[:, 2]
    return v + rows[:, :3], omega + rows[:, 3:]


def impulses_along(A, u):
    """Return (J (rows,), whether they reach u) with A J = u, the shortest where rows depend on each other."""
    J = u.copy()
    if solve_band(A.copy(), J, u.size, CLEAR):
        return J, True
    J = shortest_solution(A, u)
    return J, np.max(np.abs(A @ J - u)) <= 0.5 * np.max(np.abs(u))


# ---------------------------------------------------------------------------------------------- closing and holding

def moved_on(x, q, v, omega, dt, p):
    """Return (x, q) after dt with these velocities."""
    if q.ndim == 1:
        return x + dt * v, q + dt * omega
    return x + dt * v, turn_on(q, omega, dt, p.inv_inertia)[0]


def longest_arm(p):
    """Return the largest coordinate of an arm of a joint or a rod [m]."""
    most = 0.0
    for arms in (p.joints.r_a, p.joints.r_b, p.rods.r_a, p.rods.r_b):
        for r in arms.ravel():
            most = max(most, abs(r))
    return most


def close_links(x, q, v, omega, J, dt, p):
    """Return (v, omega, J) after the impulses with which joints are closed, and rods have their lengths, after dt.

    J (rows,) [N s]: the sums of all impulses of this step.  The whole sum stretches a compliant rod: C = −α J/dt.
    Newton's method, as close_joints_2d has it.  Raises Diverged where a step is too long for that, or where bodies go
    where the links cannot stay closed.
    """
    v, omega, J, soft, open_by = float_copy(v), float_copy(omega), J.copy(), softness(p) / dt, 0.0
    W, arm, longest = responses(link_rows(x, q, p)[0], q, p), longest_arm(p), np.max(p.rods.length)
    for _ in range(MOST):
        there, turned = moved_on(x, q, v, omega, dt, p)
        G, gap = link_rows(there, turned, p)
        gap += soft * J
        open_by, size = np.max(np.abs(gap)), longest + np.max(np.abs(there)) + (1.0 + np.max(np.abs(turned))) * arm
        if open_by <= CLOSED * size:
            return v, omega, J
        more, reach = impulses_along(G @ W + np.diag(soft / dt), -gap / dt)
        if reach:
            J += more
            v, omega = pushed(v, omega, W @ more)
        elif open_by <= SHAPE * CLOSED * size:
            return v, omega, J
        else:
            W = responses(G, turned, p)
    raise Diverged("the largest gap of a joint or a rod [m]", open_by, NOT_CLOSED)


def hold_links(x, q, v, omega, p):
    """Return (v, omega) after the impulses with which no rigid link opens; compliant rods are left as they are."""
    G, soft = link_rows(x, q, p)[0], softness(p)
    for s in range(soft.size):
        if soft[s] > 0.0:
            G[s] = 0.0
    W, u = responses(G, q, p), G @ in_one_row(v, omega)
    A = G @ W
    for s in range(soft.size):
        if soft[s] > 0.0:
            A[s, s] = 1.0
    return pushed(v, omega, W @ impulses_along(A, -u)[0])


def close_with_rods(load, bounds, narrow, t, state, dt, p):
    """Return the state with velocities that leave no joint or rod open at the end of the step."""
    x, q, v, omega, contacts, J = state
    v, omega, _ = close_links(x, q, v, omega, no_link_impulses(p), dt, p)
    return PileState(x, q, v, omega, contacts, J)


def hold_with_rods(load, bounds, narrow, t, state, dt, p):
    """Return the state with velocities at which no joint or rod opens."""
    x, q, v, omega, contacts, J = state
    v, omega = hold_links(x, q, v, omega, p)
    return PileState(x, q, v, omega, contacts, J)


# ---------------------------------------------------------------------------------------------- forces as results

def without_links(load, t, before, after, dt, p):
    """Return (v, omega) after the loads and the contacts of a step from `before`, at t, to `after`."""
    x, q, v, omega = before[:4]
    if q.ndim == 1:
        v, omega = new_velocities_2d(load, t, x, q, v, omega, dt, p)
        arms = arms_2d(x, p.inv_mass, p.inv_inertia, after.contacts)
        apply_impulses_2d(v, omega, after.J, after.contacts, arms, p.inv_mass, p.inv_inertia)
    else:
        v, omega = kick(load, t, x, q, v, omega, dt, p)
        inv_inertia = spatial_inertia(q, p.inv_inertia)
        arms = arms_3d(x, p.inv_mass, inv_inertia, after.contacts)
        apply_impulses(v, omega, after.J, after.contacts, arms, p.inv_mass, inv_inertia)
    return v, omega


def before_turning(before, after, p):
    """Return ω of all bodies of `after` as it was before they turned: their angular momenta stay in that."""
    if after.q.ndim == 1:
        return after.omega
    omega = after.omega.copy()
    for i in range(omega.shape[0]):
        if p.inv_inertia[i, 0] > 0.0:
            L = body_angular_momentum(after.q[i], omega[i], 1.0 / p.inv_inertia[i])
            omega[i] = rotate(before.q[i], p.inv_inertia[i] * unrotate(before.q[i], L))
    return omega


def link_impulses(load, t, before, after, dt, p):
    """Return J (links, d) [N s], on body a, of all joints and then all rods in a step from `before`, at t.

    They are what loads and contacts leave of the change of the velocities; J/dt is the mean force of the step, impacts
    included.  Where rows depend on each other J is the shortest that there is.
    """
    G, d, m = link_rows(before.x, before.q, p)[0], before.x.shape[1], p.joints.a.size
    change = in_one_row(after.v, before_turning(before, after, p))
    change -= in_one_row(*without_links(load, t, before, after, dt, p))
    J = impulses_along(G @ responses(G, before.q, p), G @ change)[0]
    found, wide = np.zeros((m + p.rods.a.size, d)), 3 if d == 2 else 6
    found[:m] = J[:d * m].reshape(-1, d)
    for k in range(p.rods.a.size):
        at = wide * p.rods.a[k]
        found[m + k] = J[d * m + k] * G[d * m + k, at:at + d]
    return found
