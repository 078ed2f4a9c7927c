"""Given with lesson 10.  Loops with joints, one whose positions go with mean velocities, and one that sweeps only as
long as it helps.
"""

import numpy as np

from ..simulator import contact_step_2d, find_contacts, kept_impulses, new_velocities_2d, velocity_sweep_2d
from .arms import apply_impulses_2d, arms_2d
from .joints import COMPOSED, close_joints_2d, hold_joints_2d, parting_speeds, without_joined
from .scenes import PileState

SETTLED = 1e-3               # change of an impulse, over the largest impulse [-]
REPEATS = 500                # of a step, at most


def settled_contact_step_2d(load, bounds, narrow, t, state, dt, p):
    """Given.  Return the PileState of contact_step_2d with as many sweeps as it takes until they change little.

    The step is repeated from the same state, each time with the impulses that the last time found, until p.sweeps more
    change no component by more than SETTLED times the largest one.  At rest one repetition does; an impact that runs
    through several contacts gets as many as it needs.
    *Source:* the residual threshold of an engine's solver.
    """
    new = contact_step_2d(load, bounds, narrow, t, state, dt, p)
    for _ in range(REPEATS if new.J.size else 0):
        found = new.J
        again = PileState(state.x, state.q, state.v, state.omega, new.contacts, found)
        new = contact_step_2d(load, bounds, narrow, t, again, dt, p)
        if np.max(np.abs(new.J - found)) <= SETTLED * np.max(np.abs(new.J)):
            break
    return new


def mean_contact_step_2d(load, bounds, narrow, t, state, dt, p):
    """Given.  Return the PileState of contact_step_2d, but with  x ← x + ½ dt (v + v′).

    v is the velocity before the step, v′ the one after it; angles go the same way.  The step is exact while the forces
    are constant and what touches stays in contact.  It is no method for impacts: a body that arrives at a contact with
    the speed v sinks in by ½ dt v.
    *Source:* the trapezoidal rule; `average_rolling_step` of lesson 5 does the same for one ball.
    """
    x, q, v, omega, _, _ = state
    _, _, v_new, omega_new, contacts, J = contact_step_2d(load, bounds, narrow, t, state, dt, p)
    return PileState(x + 0.5 * dt * (v + v_new), q + 0.5 * dt * (omega + omega_new), v_new, omega_new, contacts, J)


def joint_step_2d(load, t, x, q, v, omega, dt, p):
    """Given.  Return (x, q, v, omega) of JointedBodies in the plane after dt without contact.

    RATTLE: second order, reversible.
    """
    v, omega = new_velocities_2d(load, t, x, q, v, omega, 0.5 * dt, p)
    v, omega = close_joints_2d(x, q, v, omega, dt, p)
    x, q = x + dt * v, q + dt * omega
    v, omega = new_velocities_2d(load, t + dt, x, q, v, omega, 0.5 * dt, p)
    v, omega = hold_joints_2d(q, v, omega, p)
    return x, q, v, omega


def composed_joint_step_2d(load, t, x, q, v, omega, dt, p):
    """Given.  The same by five joint_step_2d, the third one backwards, as `compose` of lesson 5 does; fourth order."""
    for share in COMPOSED:
        x, q, v, omega = joint_step_2d(load, t, x, q, v, omega, share * dt, p)
        t = t + share * dt
    return x, q, v, omega


def joint_contact_step_2d(load, bounds, narrow, t, state, dt, p):
    """Given.  Return the PileState of JointedBodies in the plane after dt: contact_step_2d, and after each sweep
    close_joints_2d, which leaves no joint open at the end of the step.

    Bodies that share a joint do not touch.  A contact that comes with u_n leaves with −p.e u_n, and then no impulse of
    the last step is kept.
    """
    x, q, v, omega, old, J = state
    v, omega = new_velocities_2d(load, t, x, q, v, omega, dt, p)
    low, high, turn = bounds(x, q, p.half)
    contacts = without_joined(find_contacts(narrow, x, low, high, turn, p), p.joints)
    arms = arms_2d(x, p.inv_mass, p.inv_inertia, contacts)
    v, omega = close_joints_2d(x, q, v, omega, dt, p)
    aim = parting_speeds(v, omega, contacts, arms, dt, p.e)
    J, give = kept_impulses(contacts, old, J, p.margin if p.e == 0.0 else 0.0), np.zeros(aim.size)
    apply_impulses_2d(v, omega, J, contacts, arms, p.inv_mass, p.inv_inertia)
    for _ in range(p.sweeps if contacts.a.size > 0 else 0):
        v, omega, J = velocity_sweep_2d(v, omega, J, aim, give, contacts, arms, p)
        v, omega = close_joints_2d(x, q, v, omega, dt, p)
    return PileState(x + dt * v, q + dt * omega, v, omega, contacts, J)
