"""Given.  Joints between bodies: hinges in the plane, ball joints in space.

A joint holds a point of body a at a point of body b.  It is a contact with as many rows as there are dimensions, and
without a sign: it may pull.  So its law is an equation, and the Delassus matrix of lesson 9 gives all impulses at once:

    A J = −u,      A = G M⁻¹ Gᵀ,      J (m, d) on a, −J on b

A chain has a matrix with a narrow band, so that the work grows with the number of its bodies.  The steps are RATTLE of
lesson 8, with bodies in place of points:  half of the load, impulses that close the joints at the *end* of the step,
motion, the other half, and impulses that stop what the joints' points move relative to each other.
*Source:* Andersen 1983; Hairer, Lubich, Wanner 2006, VII.1.
*Left out:* joints that form a closed loop; limits, motors and friction of joints.
"""

from typing import NamedTuple

import numpy as np

from ..checks import (
    BadInput,
    Diverged,
    check_field,
    check_indices,
    check_positive,
    check_restitution,
    check_shape,
    finite_array,
)
from ..rotation import SUZUKI, body_angular_momentum, exponential, quaternion_product, splitting_free_rotation
from .arms import apply_impulses, apply_impulses_2d, normal_velocities_2d, point_velocity_of, world_inertia
from .contact_points import ContactSet
from .quaternions import rotate, unrotate
from .scenes import check_independent
from .tuples import across, minus, row, times

CLOSED = 1e-14               # gap of a joint that counts as closed, per metre of coordinates [-]: 45 roundings
MOST = 30                    # rounds of Newton's method per step [-]; with useful steps it needs 3 to 6

COMPOSED = (SUZUKI, SUZUKI, 1.0 - 4.0 * SUZUKI, SUZUKI, SUZUKI)  # steps of a method of order 4, over dt [-]


class Joints(NamedTuple):
    """m pairs of points that stay together."""
    a: np.ndarray            # (m,) a body of each
    b: np.ndarray            # (m,) the other body
    r_a: np.ndarray          # (m, d) the point of a, from its centre, in coordinates of a [m]
    r_b: np.ndarray          # (m, d) the same for b [m]
    band: int                # rows of the Delassus matrix that are farther apart have no entry


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
    are in the PileState; e is the restitution of their contacts.

    A row with inv_mass = 0 is the world, such as a plane.
    Raises BadInput for a body that is none, for two that cannot move, and for joints that form a closed loop.
    """
    check_restitution(e)
    places, d = finite_array("the place of a joint [m]", places), state.x.shape[1]
    a = check_indices("a body of a joint", a, p.inv_mass.size)
    b = check_indices("a body of a joint", b, p.inv_mass.size)
    check_shape("the bodies a", a, (a.size,))
    check_shape("the bodies b", b, (a.size,))
    check_field("the places of the joints [m]", places, (a.size, d))
    r_a, r_b, apart = places - state.x[a], places - state.x[b], 0
    for k in range(a.size):
        if a[k] == b[k]:
            raise BadInput("both bodies of a joint", a[k], "name two bodies")
        check_positive("inverse mass of both bodies of a joint [1/kg]", p.inv_mass[a[k]] + p.inv_mass[b[k]])
        for i in range(k):
            if any(body in (a[i], b[i]) and p.inv_mass[body] > 0.0 for body in (a[k], b[k])):
                apart = max(apart, k - i)
    arms, band = JointArms(r_a, r_b), d * (apart + 1) - 1
    flat = state.q.ndim == 1
    for k in range(a.size):
        if flat:
            r_a[k], r_b[k] = turned_2d(-state.q[a[k]], r_a[k]), turned_2d(-state.q[b[k]], r_b[k])
        else:
            r_a[k], r_b[k] = unrotate(state.q[a[k]], r_a[k]), unrotate(state.q[b[k]], r_b[k])
    joints = JointedBodies(*p, float(e), Joints(a, b, r_a, r_b, band))
    arms = joint_arms_2d(state.q, joints.joints) if flat else joint_arms(state.q, joints.joints)
    check_independent(joint_matrix_2d(arms, arms, joints) if flat
                      else joint_matrix(arms, arms, p.inv_mass, spatial_inertia(state.q, p.inv_inertia), joints.joints))
    return joints


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


def solve_band(A, right, band):
    """The J with A J = right, by elimination within the band; A and right are used up, and J is right.

    A is near a positive definite matrix, so no pivot needs to be looked for.
    """
    for k in range(right.size):
        for r in range(k + 1, min(right.size, k + band + 1)):
            factor = A[r, k] / A[k, k]
            for c in range(k + 1, min(right.size, k + band + 1)):
                A[r, c] -= factor * A[k, c]
            right[r] -= factor * right[k]
    for k in range(right.size - 1, -1, -1):
        for c in range(k + 1, min(right.size, k + band + 1)):
            right[k] -= A[k, c] * right[c]
        right[k] /= A[k, k]
    return right


def close_joints_2d(x, q, v, omega, dt, p):
    """(v, omega) after the impulses at the joints with which all of them are closed at x + dt v, q + dt omega.

    Newton's method: what is open in the end needs the velocity −gap/dt there, from an impulse that acts now.
    Raises Diverged where a step is too long for that.
    """
    v, omega, arms = v.copy(), omega.copy(), joint_arms_2d(q, p.joints)
    open_by, small = 0.0, CLOSED * (1.0 + np.max(np.abs(x)))
    for _ in range(MOST):
        end = joint_arms_2d(q + dt * omega, p.joints)
        gaps = joint_gaps(x + dt * v, end, p.joints)
        open_by = np.max(np.abs(gaps))
        if open_by <= small:
            return v, omega
        J = solve_band(joint_matrix_2d(end, arms, p), -gaps.ravel() / dt, p.joints.band)
        apply_impulses_2d(v, omega, J.reshape(-1, 2), p.joints, arms, p.inv_mass, p.inv_inertia)
    raise Diverged("the largest gap of a joint [m]", open_by, "take a smaller step")


def hold_joints_2d(q, v, omega, p):
    """(v, omega) after the impulses with which both points of each joint have the same velocity."""
    v, omega, joints, arms = v.copy(), omega.copy(), p.joints, joint_arms_2d(q, p.joints)
    u = np.empty(arms.r_a.shape)
    for k in range(joints.a.size):
        a, b = joints.a[k], joints.b[k]
        u[k, 0] = v[a, 0] - omega[a] * arms.r_a[k, 1] - v[b, 0] + omega[b] * arms.r_b[k, 1]
        u[k, 1] = v[a, 1] + omega[a] * arms.r_a[k, 0] - v[b, 1] - omega[b] * arms.r_b[k, 0]
    J = solve_band(joint_matrix_2d(arms, arms, p), -u.ravel(), joints.band)
    apply_impulses_2d(v, omega, J.reshape(-1, 2), joints, arms, p.inv_mass, p.inv_inertia)
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


def turn_on(q, omega, dt, inv_body):
    """(q, omega) of all bodies after they have turned freely for dt: splitting_free_rotation of lesson 5, L as it is.

    What no torque can turn keeps its ω.
    """
    q, omega = q.copy(), omega.copy()
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
    v, omega, arms, inv_inertia = v.copy(), omega.copy(), joint_arms(q, p.joints), spatial_inertia(q, p.inv_inertia)
    open_by, small = 0.0, CLOSED * (1.0 + np.max(np.abs(x)))
    for _ in range(MOST):
        end = joint_arms(turn_on(q, omega, dt, p.inv_inertia)[0], p.joints)
        gaps = joint_gaps(x + dt * v, end, p.joints)
        open_by = np.max(np.abs(gaps))
        if open_by <= small:
            return v, omega
        J = solve_band(joint_matrix(end, arms, p.inv_mass, inv_inertia, p.joints), -gaps.ravel() / dt, p.joints.band)
        apply_impulses(v, omega, J.reshape(-1, 3), p.joints, arms, p.inv_mass, inv_inertia)
    raise Diverged("the largest gap of a joint [m]", open_by, "take a smaller step")


def hold_joints(q, v, omega, p):
    """(v, omega) as in the plane: both points of each joint have the same velocity."""
    v, omega, joints, arms = v.copy(), omega.copy(), p.joints, joint_arms(q, p.joints)
    inv_inertia, u = spatial_inertia(q, p.inv_inertia), np.empty(arms.r_a.shape)
    for k in range(joints.a.size):
        apart = minus(point_velocity_of(v, omega, joints.a[k], row(arms.r_a, k)),
                      point_velocity_of(v, omega, joints.b[k], row(arms.r_b, k)))
        u[k, 0], u[k, 1], u[k, 2] = apart
    J = solve_band(joint_matrix(arms, arms, p.inv_mass, inv_inertia, joints), -u.ravel(), joints.band)
    apply_impulses(v, omega, J.reshape(-1, 3), joints, arms, p.inv_mass, inv_inertia)
    return v, omega


def kick(load, t, x, q, v, omega, dt, p):
    """(v, omega) after the loads have acted for dt; the gyroscopic term is in turn_on."""
    F, tau = load(t, x, q, v, omega, p)
    v, omega = v + dt * p.inv_mass[:, None] * F, omega.copy()
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
