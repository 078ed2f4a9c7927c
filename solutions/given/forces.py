"""Given.  Forces as results: of joints at a time, and of contacts in a step.

The force of a joint follows from the state of one time, without any step.  So it has the order of the method that made
the state: the second after joint_step_2d, the fourth after composed_joint_step_2d.  The force of a contact follows from
the impulse of a step, and has the order of the loop: the first.
*Left out:* forces of joints while bodies touch; joint_impulses_2d of solutions/given/simulator.py has the mean over a
step.
"""

import numpy as np

from ..rotation import angular_acceleration
from ..support.tuples import across, minus, row
from .joints import (
    impulses_2d,
    impulses_3d,
    joint_arms,
    joint_arms_2d,
    joint_velocities,
    joint_velocities_2d,
    spatial_inertia,
)


def joint_forces_2d(load, t, x, q, v, omega, p):
    """Return F (m, 2) [N] of the joints of JointedBodies at the time t: F on body a, −F on b, at the point of both.

    With F both points of each joint have the same acceleration:
        A F = −c,     c = difference of  a + α × r − ω² r  of both bodies under the loads alone
    Where rows depend on each other F is the shortest of the possible forces, which is that of equally stiff joints.
    The velocities must be those of closed joints, as after a step; a row with inv_mass = 0 is not accelerated.  Near a
    singular position, such as a flat four-bar, a force may grow without a bound.
    *Source:* the second derivative of the gaps; Hairer, Lubich, Wanner 2006, VII.1.
    """
    F, tau = load(t, x, q, v, omega, p)
    joints, arms, a, alpha = p.joints, joint_arms_2d(q, p.joints), p.inv_mass[:, None] * F, p.inv_inertia * tau
    c = joint_velocities_2d(a, alpha, arms, joints)          # a + α × r is to a and α what v + ω × r is to v and ω
    for k in range(joints.a.size):
        spin_a, spin_b = omega[joints.a[k]], omega[joints.b[k]]
        for i in range(2):
            c[k, i] -= spin_a * spin_a * arms.r_a[k, i] - spin_b * spin_b * arms.r_b[k, i]
    return impulses_2d(arms, arms, c, p)[0]


def joint_forces(load, t, x, q, v, omega, p):
    """Return F (m, 3) [N] in space as in the plane, with ω × (ω × r) and with the gyroscopic term in α."""
    F, tau = load(t, x, q, v, omega, p)
    joints, arms, a, alpha = p.joints, joint_arms(q, p.joints), p.inv_mass[:, None] * F, 0.0 * omega
    for i in range(omega.shape[0]):
        if p.inv_inertia[i, 0] > 0.0:
            alpha[i] = angular_acceleration(q[i], omega[i], tau[i], 1.0 / p.inv_inertia[i])
    c = joint_velocities(a, alpha, arms, joints)
    for k in range(joints.a.size):
        spin_a, spin_b = row(omega, joints.a[k]), row(omega, joints.b[k])
        bent = minus(across(spin_a, across(spin_a, row(arms.r_a, k))), across(spin_b, across(spin_b, row(arms.r_b, k))))
        for i in range(3):
            c[k, i] += bent[i]
    return impulses_3d(arms, arms, c, p.inv_mass, spatial_inertia(q, p.inv_inertia), joints)[0]


def normal_and_friction(state, dt):
    """Return (N (m,) [N], T (m, d) [N]): the normal force and the friction of each contact of a PileState, on body a.

    J/dt = N n + T.  The loop takes the loads and finds the contacts at the beginning of a step.  So what a state at t
    contains are the forces at t − dt, at state.contacts.p.  Later motion of the bodies does not change them.  An
    impact is spread over its step: its force grows as 1/dt, and J is its result.  After advance_pile J belongs to the
    last substep; give dt/substeps.  Where supports are redundant, as two feet that rub, only sums and moments are
    determined.
    """
    n, N, T = state.contacts.n, np.zeros(state.J.shape[0]), np.zeros(state.J.shape)
    for k in range(N.size):
        for i in range(n.shape[1]):
            N[k] += n[k, i] * state.J[k, i] / dt
        for i in range(n.shape[1]):
            T[k, i] = state.J[k, i] / dt - N[k] * n[k, i]
    return N, T


def normal_forces(states, a, b, dt):
    """Return the normal forces (steps,) [N] between bodies a and b in all states of a contact_trajectory but the first.

    `release` of support/events.py finds out from them when a rests on b no more.
    """
    forces = np.zeros(len(states) - 1)
    for k, state in enumerate(states[1:]):
        N, _ = normal_and_friction(state, dt)
        for c in range(N.size):
            pair = state.contacts.a[c], state.contacts.b[c]
            if pair == (a, b) or pair == (b, a):
                forces[k] += N[c]
    return forces


def contact_force(state, body, dt):
    """Return the sum (d,) [N] of what all contacts of a PileState do to one body; the time is that above."""
    F = np.zeros(state.J.shape[1])
    for k in range(state.J.shape[0]):
        if body in (state.contacts.a[k], state.contacts.b[k]):
            F += (1.0 if state.contacts.a[k] == body else -1.0) * state.J[k] / dt
    return F
