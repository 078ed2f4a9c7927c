"""Given.  Joints between bodies: hinges in the plane, ball joints in space.

A joint holds a point of body a at a point of body b.  It is a contact with as many rows as there are dimensions, and
without a sign: it may pull.  So its law is an equation, and the Delassus matrix of lesson 9 gives all impulses at once:

    A J = −u,      A = G M⁻¹ Gᵀ,      J (m, d) on a, −J on b

A chain has a matrix with a narrow band, so that the work grows with the number of its bodies.  The steps are RATTLE of
lesson 8, with bodies in place of points:  half of the load, impulses that close the joints at the *end* of the step,
motion, the other half, and impulses that stop what the joints' points move relative to each other.

Joints may form closed loops, and their rows may depend on each other: two ball joints on one axis are a hinge in space,
a beam may lie on three supports, and a four-bar may lie flat.  Then many impulses give the same motion, and the
shortest of them is taken (shortest_impulses).
*Source:* Andersen 1983; Hairer, Lubich, Wanner 2006, VII.1.
*Left out:* limits, motors and friction of joints.
"""

from typing import NamedTuple

import numpy as np

from ..checks import (
    BadInput,
    Diverged,
    check_indices,
    check_positive,
    check_restitution,
    check_shape,
    finite_array,
    float_copy,
)
from ..rotation import SUZUKI, body_angular_momentum, exponential, quaternion_product, splitting_free_rotation
from ..support.arms import apply_impulses, apply_impulses_2d, normal_velocities_2d, point_velocity_of, world_inertia
from ..support.contact_points import ContactSet
from ..support.quaternions import rotate, unrotate
from ..support.records import check_record
from ..support.small_systems import shortest_solution, solve_band
from ..support.tuples import across, minus, row, times

CLOSED = 1e-14               # gap of a joint that counts as closed, over the size of its terms [-]: 45 roundings
SHAPE = 100.0                # for gaps that no impulse closes, over CLOSED [-]: bodies of rounded shape leave such gaps
CLEAR = 1e-8                 # least pivot over its diagonal [-]: without exchange of rows it costs 8 of 16 digits
MOST = 30                    # rounds of Newton's method per step [-]; with useful steps it needs 3 to 6

NOT_CLOSED = "take a smaller step; if that does not help, the joints cannot all stay closed"

COMPOSED = (SUZUKI, SUZUKI, 1.0 - 4.0 * SUZUKI, SUZUKI, SUZUKI)  # steps of a method of order 4, over dt [-]


class Joints(NamedTuple):
    """m pairs of points that stay together."""
    a: np.ndarray            # (m,) a body of each
    b: np.ndarray            # (m,) the other body
    r_a: np.ndarray          # (m, d) the point of a, from its centre, in coordinates of a [m]
    r_b: np.ndarray          # (m, d) the same for b [m]
    band: int                # rows of the Delassus matrix that are farther apart have no entry
    loops: bool              # whether they form a closed loop, so that rows may depend on each other


class JointedBodies(NamedTuple):
    """A Bodies with joints."""
    inv_mass: np.ndarray     # the first eight as in Bodies
    inv_inertia: np.ndarray
    half: np.ndarray
    planes: np.ndarray
    gravity: np.ndarray
    mu: float
    sweeps: int
    margin: float
    e: float                 # restitution of contacts [-]; several impacts at once have no law
    joints: Joints


class JointArms(NamedTuple):
    """Offsets of the joints from the centres of their bodies, in the world."""
    r_a: np.ndarray          # (m, d) [m]
    r_b: np.ndarray          # (m, d) [m]


def make_joints(state, p, a, b, places, e):
    """Return the JointedBodies of a Bodies p, whose bodies a[k] and b[k] are joined at places[k] (m, d) [m], as they
    are in the PileState; e is the restitution of their contacts.  There may be no joint at all.

    A row with inv_mass = 0 is the world, such as a plane.  Two ball joints on one axis are a hinge in space.
    Raises BadInput for a body that is none, and for two that cannot move.
    """
    check_record(p, state)
    check_restitution(e)
    places, d = finite_array("the place of a joint [m]", places), state.x.shape[1]
    places = places if places.size > 0 else np.zeros((0, d))             # an empty list has no rows to count
    a = check_indices("a body of a joint", a, p.inv_mass.size)
    b = check_indices("a body of a joint", b, p.inv_mass.size)
    check_shape("the bodies a", a, (a.size,))
    check_shape("the bodies b", b, (a.size,))
    check_shape("the places of the joints [m]", places, (a.size, d))
    for k in range(a.size):
        if a[k] == b[k]:
            raise BadInput("both bodies of a joint", a[k], "name two bodies")
        check_positive("inverse mass of both bodies of a joint [1/kg]", p.inv_mass[a[k]] + p.inv_mass[b[k]])
    r_a, r_b = places - state.x[a], places - state.x[b]
    for k in range(a.size):
        if state.q.ndim == 1:
            r_a[k], r_b[k] = turned_2d(-state.q[a[k]], r_a[k]), turned_2d(-state.q[b[k]], r_b[k])
        else:
            r_a[k], r_b[k] = unrotate(state.q[a[k]], r_a[k]), unrotate(state.q[b[k]], r_b[k])
    band = d * (farthest_neighbour(a, b, p.inv_mass) + 1) - 1
    jointed = JointedBodies(*p, float(e), Joints(a, b, r_a, r_b, band, form_loops(a, b, p.inv_mass)))
    check_record(jointed, state)
    return jointed


def farthest_neighbour(a, b, inv_mass):
    """The largest difference of the numbers of two joints that share a body that can move; 0 if none do."""
    apart = 0
    for k in range(a.size):
        for i in range(k):
            if any(body in (a[i], b[i]) and inv_mass[body] > 0.0 for body in (a[k], b[k])):
                apart = max(apart, k - i)
    return apart


def form_loops(a, b, inv_mass):
    """Whether joints lead from a body back to it; all bodies with inv_mass = 0 are one, the world."""
    part = np.where(inv_mass > 0.0, np.arange(inv_mass.size), -1)        # of what the joints so far have joined
    for k in range(a.size):
        if part[a[k]] == part[b[k]]:
            return True
        part[part == part[b[k]]] = part[a[k]]
    return False


# ---------------------------------------------------------------------------------------------- in the plane

def turned_2d(angle, r):
    """r (2,) turned by an angle [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array((c * r[0] - s * r[1], s * r[0] + c * r[1]))


def joint_arms_2d(q, joints):
    """The JointArms of bodies with the angles q (n,)."""
    arms = JointArms(np.empty(joints.r_a.shape), np.empty(joints.r_a.shape))
    for k in range(joints.a.size):
        c, s = np.cos(q[joints.a[k]]), np.sin(q[joints.a[k]])
        arms.r_a[k, 0] = c * joints.r_a[k, 0] - s * joints.r_a[k, 1]
        arms.r_a[k, 1] = s * joints.r_a[k, 0] + c * joints.r_a[k, 1]
        c, s = np.cos(q[joints.b[k]]), np.sin(q[joints.b[k]])
        arms.r_b[k, 0] = c * joints.r_b[k, 0] - s * joints.r_b[k, 1]
        arms.r_b[k, 1] = s * joints.r_b[k, 0] + c * joints.r_b[k, 1]
    return arms


def joint_gaps(x, arms, joints):
    """(m, d) [m]: the point of a less that of b, of each joint."""
    gaps = np.empty(arms.r_a.shape)
    for k in range(joints.a.size):
        for c in range(x.shape[1]):
            gaps[k, c] = x[joints.a[k], c] + arms.r_a[k, c] - x[joints.b[k], c] - arms.r_b[k, c]
    return gaps


def size_of_terms(x, arms, turned):
    """The size [m] of what a gap is a sum of, of which some roundings are its error; turned: the largest angle [rad].

    An angle q is known to a rounding of itself, so that an arm r may be off by |q| roundings of r.
    """
    return np.max(np.abs(x)) + (1.0 + turned) * np.maximum(np.max(np.abs(arms.r_a)), np.max(np.abs(arms.r_b)))


def joint_matrix_2d(left, right, p):
    """A (2m, 2m) [1/kg]: velocities of the joints' points, at the arms `left`, by unit impulses at the arms `right`.

    With left = right it is the Delassus matrix.
    """
    joints, inv_mass, inv_inertia = p.joints, p.inv_mass, p.inv_inertia
    m, near = joints.a.size, joints.band // 2
    A = np.zeros((2 * m, 2 * m))
    for k in range(m):
        for s in range(max(0, k - near), min(m, k + near + 1)):
            if joints.a[k] == joints.a[s]:
                add_block_2d(A, k, s, 1.0, joints.a[k], left.r_a, right.r_a, inv_mass, inv_inertia)
            if joints.b[k] == joints.b[s]:
                add_block_2d(A, k, s, 1.0, joints.b[k], left.r_b, right.r_b, inv_mass, inv_inertia)
            if joints.a[k] == joints.b[s]:
                add_block_2d(A, k, s, -1.0, joints.a[k], left.r_a, right.r_b, inv_mass, inv_inertia)
            if joints.b[k] == joints.a[s]:
                add_block_2d(A, k, s, -1.0, joints.b[k], left.r_b, right.r_a, inv_mass, inv_inertia)
    return A


def add_block_2d(A, k, s, sign, body, left, right, inv_mass, inv_inertia):
    """Add what a body that both joints share carries over from joint s, arm right[s], to joint k, arm left[k]."""
    light, turns = sign * inv_mass[body], sign * inv_inertia[body]
    A[2 * k, 2 * s] += light + turns * left[k, 1] * right[s, 1]
    A[2 * k, 2 * s + 1] -= turns * left[k, 1] * right[s, 0]
    A[2 * k + 1, 2 * s] -= turns * left[k, 0] * right[s, 1]
    A[2 * k + 1, 2 * s + 1] += light + turns * left[k, 0] * right[s, 0]


def impulses_2d(left, right, u, p):
    """(J (m, 2) [N s], whether they reach u): impulses at the arms `right` that add −u (m, 2) [m/s] at the arms `left`.

    Joints without loops have independent rows: one after the other holds a body that the joints before let go.  Then
    the matrix is near a positive definite one, and elimination within the band is safe.  In a loop rows may depend on
    each other: always, as those of two ball joints on one axis, or in a singular position, as in a flat four-bar.
    Where a pivot shows that, shortest_impulses takes all rows at once.
    """
    J = -u.ravel()
    if solve_band(joint_matrix_2d(left, right, p), J, p.joints.band, least_pivot(p.joints)):
        return J.reshape(-1, 2), True
    return shortest_impulses(joint_matrix_2d(left, right, p), u)


def least_pivot(joints):
    """The pivot, over the diagonal, at which elimination within the band ends."""
    return CLEAR if joints.loops else 0.0


def shortest_impulses(A, u):
    """(J (m, d), whether they reach u): the J of least Σ |J|² with A J = −u, or as near to it as A allows.

    Bodies move in one way only, but where rows depend on each other many J move them so.  The shortest one is unique
    and does not depend on the order of the joints, on the axes or on the units.  It is that of joints which are
    equally stiff.
    It does not reach u where more than half of u is left: no J at these arms makes those velocities.
    """
    J = shortest_solution(A, -u.ravel())
    return J.reshape(u.shape), np.max(np.abs(A @ J + u.ravel())) <= 0.5 * np.max(np.abs(u))


def close_joints_2d(x, q, v, omega, dt, p):
    """(v, omega) after the impulses at the joints with which all of them are closed at x + dt v, q + dt omega.

    Newton's method: what is open in the end needs the velocity −gap/dt there, from an impulse that acts now.
    Where a mechanism is singular at the start, as a flat four-bar, no impulse in the directions of the start may reach
    that; then the directions at the end serve.  Such a step is of second order, also within a composed one.
    Raises Diverged where a step is too long for that, or where bodies go where the joints cannot stay closed.
    """
    v, omega, joints, arms = float_copy(v), float_copy(omega), p.joints, joint_arms_2d(q, p.joints)
    open_by, turned = 0.0, np.max(np.abs(q))
    for _ in range(MOST if joints.a.size > 0 else 0):
        there, end = x + dt * v, joint_arms_2d(q + dt * omega, joints)
        gaps, small = joint_gaps(there, end, joints), CLOSED * size_of_terms(there, end, turned)
        open_by = np.max(np.abs(gaps))
        if open_by <= small:
            return v, omega
        J, reach = impulses_2d(end, arms, gaps / dt, p)
        if reach:
            apply_impulses_2d(v, omega, J, joints, arms, p.inv_mass, p.inv_inertia)
        elif open_by <= SHAPE * small:
            return v, omega
        else:
            arms = end
    if joints.a.size > 0:
        raise Diverged("the largest gap of a joint [m]", open_by, NOT_CLOSED)
    return v, omega


def joint_velocities_2d(v, omega, arms, joints):
    """u (m, 2) [m/s]: the velocity of the point of a less that of b, of each joint."""
    u = np.empty(arms.r_a.shape)
    for k in range(joints.a.size):
        a, b = joints.a[k], joints.b[k]
        u[k, 0] = v[a, 0] - omega[a] * arms.r_a[k, 1] - v[b, 0] + omega[b] * arms.r_b[k, 1]
        u[k, 1] = v[a, 1] + omega[a] * arms.r_a[k, 0] - v[b, 1] - omega[b] * arms.r_b[k, 0]
    return u


def hold_joints_2d(q, v, omega, p):
    """(v, omega) after the impulses with which both points of each joint have the same velocity."""
    v, omega, joints, arms = float_copy(v), float_copy(omega), p.joints, joint_arms_2d(q, p.joints)
    J, _ = impulses_2d(arms, arms, joint_velocities_2d(v, omega, arms, joints), p)
    apply_impulses_2d(v, omega, J, joints, arms, p.inv_mass, p.inv_inertia)
    return v, omega


def without_joined(contacts, joints):
    """The ContactSet without the contacts of two bodies that share a joint."""
    kept, first = [0 for _ in range(0)], contacts.first.copy()
    for i in range(first.size - 1):
        for k in range(contacts.first[i], contacts.first[i + 1]):
            joined = False
            for s in range(joints.a.size):
                joined = joined or (joints.a[s] == i and joints.b[s] == contacts.b[k]) or (
                    joints.b[s] == i and joints.a[s] == contacts.b[k])
            if not joined:
                kept.append(k)
        first[i + 1] = len(kept)
    k = np.array(kept, dtype=np.int64)
    return ContactSet(first, contacts.a[k], contacts.b[k], contacts.n[k], contacts.p[k], contacts.gap[k])


def parting_speeds(v, omega, contacts, arms, dt, e):
    """u_n (m,) [m/s] below which no contact in the plane may leave, after it has come with that of v and omega.

    e = 0: −gap/dt, which closes the gap, or 0.  Else a contact must have closed before it bounces, with −e u_n; until
    then nothing stops it.  Where it parts already, that is below 0, and it must be: 0 would gain energy.
    *Source:* Moreau 1988.
    """
    gap, u_n = contacts.gap, normal_velocities_2d(v, omega, contacts, arms)
    aim = np.empty(gap.size)
    for k in range(gap.size):
        if gap[k] > 0.0:
            aim[k] = -gap[k] / dt if e == 0.0 else -np.inf
        else:
            aim[k] = -e * u_n[k]
    return aim


# ---------------------------------------------------------------------------------------------- in space

def spatial_inertia(q, inv_body):
    """I⁻¹ (n, 3, 3) in the world from inverse principal moments (n, 3) and quaternions (n, 4)."""
    turn = np.empty((q.shape[0], 3, 3))
    for i in range(q.shape[0]):
        for k in range(3):
            unit = np.zeros(3)
            unit[k] = 1.0
            turn[i, :, k] = rotate(q[i], unit)
    return world_inertia(turn, inv_body)


def joint_arms(q, joints):
    """The JointArms of bodies with the quaternions q (n, 4)."""
    arms = JointArms(np.empty(joints.r_a.shape), np.empty(joints.r_a.shape))
    for k in range(joints.a.size):
        arms.r_a[k] = rotate(q[joints.a[k]], joints.r_a[k])
        arms.r_b[k] = rotate(q[joints.b[k]], joints.r_b[k])
    return arms


def joint_matrix(left, right, inv_mass, inv_inertia, joints):
    """A (3m, 3m) [1/kg] as in the plane, with inv_inertia (n, 3, 3) in the world."""
    m, near = joints.a.size, joints.band // 3
    A, axes = np.zeros((3 * m, 3 * m)), ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    for k in range(m):
        for s in range(max(0, k - near), min(m, k + near + 1)):
            for body, sign, r in ((joints.a[k], 1.0, left.r_a), (joints.b[k], -1.0, left.r_b)):
                for other, also, arm in ((joints.a[s], 1.0, right.r_a), (joints.b[s], -1.0, right.r_b)):
                    if body == other:
                        for c in range(3):
                            spin = times(inv_inertia, body, across(row(arm, s), axes[c]))
                            u = across(spin, row(r, k))
                            A[3 * k, 3 * s + c] += sign * also * (u[0] + inv_mass[body] * axes[c][0])
                            A[3 * k + 1, 3 * s + c] += sign * also * (u[1] + inv_mass[body] * axes[c][1])
                            A[3 * k + 2, 3 * s + c] += sign * also * (u[2] + inv_mass[body] * axes[c][2])
    return A


def impulses_3d(left, right, u, inv_mass, inv_inertia, joints):
    """(J (m, 3), whether they reach u) as in the plane."""
    J = -u.ravel()
    if solve_band(joint_matrix(left, right, inv_mass, inv_inertia, joints), J, joints.band, least_pivot(joints)):
        return J.reshape(-1, 3), True
    return shortest_impulses(joint_matrix(left, right, inv_mass, inv_inertia, joints), u)


def turn_on(q, omega, dt, inv_body):
    """(q, omega) of all bodies after they have turned freely for dt: splitting_free_rotation of lesson 5, L as it is.

    What no torque can turn keeps its ω.
    """
    q, omega = float_copy(q), float_copy(omega)
    for i in range(q.shape[0]):
        if inv_body[i, 0] > 0.0:
            L = body_angular_momentum(q[i], omega[i], 1.0 / inv_body[i])
            q[i] = splitting_free_rotation(q[i], L, 1.0 / inv_body[i], dt)
            omega[i] = rotate(q[i], inv_body[i] * unrotate(q[i], L))
        else:
            q[i] = quaternion_product(exponential(dt * omega[i]), q[i])
    return q, omega


def close_joints(x, q, v, omega, dt, p):
    """(v, omega) as in the plane: all joints are closed when the bodies have moved and turned on for dt."""
    v, omega, joints, arms = float_copy(v), float_copy(omega), p.joints, joint_arms(q, p.joints)
    inv_inertia, open_by = spatial_inertia(q, p.inv_inertia), 0.0
    for _ in range(MOST if joints.a.size > 0 else 0):
        there, end = x + dt * v, joint_arms(turn_on(q, omega, dt, p.inv_inertia)[0], joints)
        gaps, small = joint_gaps(there, end, joints), CLOSED * size_of_terms(there, end, 0.0)
        open_by = np.max(np.abs(gaps))
        if open_by <= small:
            return v, omega
        J, reach = impulses_3d(end, arms, gaps / dt, p.inv_mass, inv_inertia, joints)
        if reach:
            apply_impulses(v, omega, J, joints, arms, p.inv_mass, inv_inertia)
        elif open_by <= SHAPE * small:
            return v, omega
        else:
            arms = end
    if joints.a.size > 0:
        raise Diverged("the largest gap of a joint [m]", open_by, NOT_CLOSED)
    return v, omega


def joint_velocities(v, omega, arms, joints):
    """u (m, 3) [m/s] as in the plane."""
    u = np.empty(arms.r_a.shape)
    for k in range(joints.a.size):
        apart = minus(point_velocity_of(v, omega, joints.a[k], row(arms.r_a, k)),
                      point_velocity_of(v, omega, joints.b[k], row(arms.r_b, k)))
        u[k, 0], u[k, 1], u[k, 2] = apart
    return u


def hold_joints(q, v, omega, p):
    """(v, omega) as in the plane: both points of each joint have the same velocity."""
    v, omega, joints, arms = float_copy(v), float_copy(omega), p.joints, joint_arms(q, p.joints)
    inv_inertia, u = spatial_inertia(q, p.inv_inertia), joint_velocities(v, omega, arms, joints)
    J, _ = impulses_3d(arms, arms, u, p.inv_mass, inv_inertia, joints)
    apply_impulses(v, omega, J, joints, arms, p.inv_mass, inv_inertia)
    return v, omega


def kick(load, t, x, q, v, omega, dt, p):
    """(v, omega) after the loads have acted for dt; the gyroscopic term is in turn_on."""
    F, tau = load(t, x, q, v, omega, p)
    v, omega = v + dt * p.inv_mass[:, None] * F, float_copy(omega)
    for i in range(q.shape[0]):
        omega[i] += dt * rotate(q[i], p.inv_inertia[i] * unrotate(q[i], tau[i]))
    return v, omega


def joint_step(load, t, x, q, v, omega, dt, p):
    """(x, q, v, omega) of JointedBodies in space after dt without contact: the same as joint_step_2d."""
    v, omega = kick(load, t, x, q, v, omega, 0.5 * dt, p)
    v, omega = close_joints(x, q, v, omega, dt, p)
    x = x + dt * v
    q, omega = turn_on(q, omega, dt, p.inv_inertia)
    v, omega = kick(load, t + dt, x, q, v, omega, 0.5 * dt, p)
    v, omega = hold_joints(q, v, omega, p)
    return x, q, v, omega
