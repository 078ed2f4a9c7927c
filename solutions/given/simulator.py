"""Given with lesson 10.  Loops with joints, one whose positions go with mean velocities, and one that sweeps only as
long as it helps; a chain and a cradle that need no joints, because their coordinates are angles; the history of a run
with contact.
"""

from typing import NamedTuple

import numpy as np

from ..checks import Diverged, check_end, check_shape, checked_run, whole_number
from ..simulator import *  # noqa: F403    one import has a lesson and its given functions
from ..simulator import (
    advance_contact,
    contact_step_2d,
    find_contacts,
    kept_impulses,
    new_velocities_2d,
    velocity_sweep_2d,
)
from ..support.arms import apply_impulses_2d, arms_2d
from ..support.convex_2d import (  # noqa: F401
    box_bounds_of,
    box_contacts_of,
    convex_bounds_2d,
    convex_contacts_2d,
    disc_bounds_of,
    disc_contacts_of,
)
from ..support.convex_3d import (  # noqa: F401
    ball_bounds_of,
    ball_contacts_of,
    cuboid_bounds_of,
    cuboid_contacts_of,
    rounded_bounds,
    rounded_contacts,
)
from ..support.records import check_record
from ..support.scenes import PileState
from ..support.small_systems import solve_band
from .bodies import HALVINGS
from .compose import (  # noqa: F401
    Loop,
    Part,
    Settings,
    check_explicit_forces,
    compose,
    padded,
    run_parts,
    state_of,
)
from .dividing import advance_parts, divided_step, first_touch, whole_step  # noqa: F401
from .hulls import hull_bounds, hull_contacts  # noqa: F401
from .invariants import closing_speeds
from .joints import (
    COMPOSED,
    close_joints_2d,
    hold_joints_2d,
    impulses_2d,
    joint_arms_2d,
    joint_velocities_2d,
    parting_speeds,
    without_joined,
)
from .parts import *  # noqa: F403    a compiled loop is made of these
from .parts_3d import *  # noqa: F403
from .rods import close_with_rods, hold_with_rods, link_impulses  # noqa: F401

SETTLED = 1e-3               # change of an impulse, over the largest impulse [-]
FURTHER = 1500               # sweeps after those of the step, at most
ROUND_OFF = 1e-15            # of a gap, over the lengths that it is computed from [-]
MOST_IMPACTS = 1000          # of the balls of a cradle in one step [-]


def settled_contact_step_2d(load, bounds, narrow, t, state, dt, p):
    """Given.  Return the PileState of contact_step_2d, swept further until a sweep changes little.

    The sweeps end when one changes no component of an impulse by more than SETTLED times the largest one.  At rest one
    does; an impact that runs through several contacts gets as many as it needs.
    *Source:* the residual threshold of an engine's solver.
    """
    _, _, v, omega, contacts, J = contact_step_2d(load, bounds, narrow, t, state, dt, p)
    arms, aim = arms_2d(state.x, p.inv_mass, p.inv_inertia, contacts), closing_speeds(contacts.gap, dt)
    for _ in range(FURTHER if J.size else 0):
        found = J
        v, omega, J = velocity_sweep_2d(v, omega, found, aim, 0.0 * aim, contacts, arms, p)
        if np.max(np.abs(J - found)) <= SETTLED * np.max(np.abs(J)):
            break
    return PileState(state.x + dt * v, state.q + dt * omega, v, omega, contacts, J)


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


def joint_impulses_2d(load, t, before, after, dt, p):
    """Given.  Return J (m, 2) [N s], on body a, of the joints in a step of joint_contact_step_2d from `before`, at t.

    They are what loads and contacts leave of the change of the velocities; J/dt is the mean force of the step, impacts
    included.  Where rows depend on each other J is the shortest that there is.
    """
    arms = arms_2d(before.x, p.inv_mass, p.inv_inertia, after.contacts)
    v, omega = new_velocities_2d(load, t, before.x, before.q, before.v, before.omega, dt, p)
    apply_impulses_2d(v, omega, after.J, after.contacts, arms, p.inv_mass, p.inv_inertia)
    ends = joint_arms_2d(before.q, p.joints)
    return impulses_2d(ends, ends, joint_velocities_2d(v - after.v, omega - after.omega, ends, p.joints), p)[0]


# ---------------------------------------------------------------------------------------------- the history of a run

def contact_trajectory(step, load, bounds, narrow, t, state, dt, steps, p):
    """Given.  Return (ts, [state, …]) of advance_contact: times and all PileStates, the first included."""
    check_record(p, state)
    steps, states = whole_number("number of steps", steps, 0), [state]
    for n in range(steps):
        states.append(advance_contact(step, load, bounds, narrow, t + n * dt, states[-1], dt, 1, p))
    return t + dt * np.arange(steps + 1), states


# ---------------------------------------------------------------------------------------------- without joints

class RodsInAngles(NamedTuple):
    """Equal rods in the plane, each hinged to the end of the one before, the first to a wall."""
    m: float                 # mass of each [kg]
    l: float                 # length of each [m]
    I: float                 # moment of inertia of each about its centre [kg m²]
    g: float                 # gravity, along −y [m/s²]


def rods_acceleration(t, q, omega, p):
    """Given.  Return the angular accelerations (n,) [rad/s²] of RodsInAngles p whose angles from the x axis are q (n,).

    Angles cannot leave a joint open, so nothing holds it: Lagrange's equations replace the impulses of the joints.
        Σⱼ (m l² cᵢⱼ cos(qᵢ − qⱼ) + δᵢⱼ I) αⱼ = −Σⱼ m l² cᵢⱼ sin(qᵢ − qⱼ) ωⱼ² − m g l (n − i − ½) cos qᵢ
        cᵢⱼ = n − max(i, j) − ½  and  cᵢᵢ = n − i − ¾,  i and j from 0
    The matrix is full, so that a step costs n³, where the band of the joints costs n.
    *Source:* Lagrange's equations.
    """
    n, c, s = q.size, np.cos(q), np.sin(q)
    A, right = np.empty((n, n)), np.empty(n)
    for i in range(n):
        right[i] = -p.m * p.g * p.l * (n - i - 0.5) * c[i]
        for j in range(n):
            share = p.m * p.l * p.l * (n - max(i, j) - 0.5)
            A[i, j] = share * (c[i] * c[j] + s[i] * s[j])
            right[i] -= share * (s[i] * c[j] - c[i] * s[j]) * omega[j] * omega[j]
        A[i, i] = p.m * p.l * p.l * (n - i - 0.75) + p.I
    solve_band(A, right, n, 0.0)
    return right


class Cradle(NamedTuple):
    """Equal balls in the plane on rods without mass, side by side; each rod and its ball turn together about a pivot.
    """
    pitch: float             # distance of neighbouring pivots, which lie at one height [m]
    L: float                 # from a pivot to the centre of its ball [m]
    R: float                 # radius of the balls [m]
    inertia: float           # of a ball about its pivot, over its mass [m²]
    g: float                 # gravity, along −y [m/s²]


def swing_acceleration(t, theta, omega, p):
    """Given.  Return the angular accelerations (n,) [rad/s²] of a Cradle p with the angles θ (n,), from straight down.

    I θ̈ = −g L sin θ,  I about the pivot and over the mass
    """
    return -p.g * p.L / p.inertia * np.sin(theta)


def cradle_gap(theta, k, p):
    """Return (gap [m] between balls k and k + 1 of a Cradle, its derivatives [m] by the angles of both).

    It stays negative where a long step has moved one ball through the other, to its far side.
    """
    c, s = np.cos(theta), np.sin(theta)
    x, y = p.pitch + p.L * (s[k + 1] - s[k]), p.L * (c[k] - c[k + 1])
    length = np.copysign(np.hypot(x, y), x)
    return length - 2.0 * p.R, -p.L * (x * c[k] + y * s[k]) / length, p.L * (x * c[k + 1] + y * s[k + 1]) / length


def first_impact(step, t, theta, omega, dt, p):
    """Return (time [s] until then, k) of the first impact within dt, of balls k and k + 1; (dt, −1) without one.

    Two balls that touch and part again within dt are not noticed.
    """
    late, found = dt, -1
    end = step(swing_acceleration, t, theta, omega, dt, p)
    for k in range(theta.size - 1):
        if closes(*end, k, p):
            late, found = time_of_impact(step, t, theta, omega, late, k, p), k
            end = step(swing_acceleration, t, theta, omega, late, p)
    return late, found


def time_of_impact(step, t, theta, omega, dt, k, p):
    """Return the time [s] within dt at which the gap of balls k and k + 1 closes, which is closed after dt.

    Newton's method begins at dt.  An interval that contains the impact shrinks with each time that it tries.  If the
    next time lies outside of that interval, the middle of it is tried instead.  It ends when only round-off is left of
    the gap.
    """
    early, end, late = 0.0, dt, dt
    for _ in range(HALVINGS):
        q, rates = step(swing_acceleration, t, theta, omega, late, p)
        gap, a, b = cradle_gap(q, k, p)
        if abs(gap) <= ROUND_OFF * (p.pitch + p.L):
            break
        early, end = (early, late) if gap < 0.0 else (late, end)
        late = late - gap / (a * rates[k] + b * rates[k + 1])
        if not early < late < end:
            late = 0.5 * (early + end)
    return late


def closes(theta, omega, k, p):
    """Return whether balls k and k + 1 of a Cradle overlap and still come together."""
    gap, a, b = cradle_gap(theta, k, p)
    return gap < 0.0 and a * omega[k] + b * omega[k + 1] < 0.0


def swinging_step(step, t, theta, omega, dt, p):
    """Given.  Return (θ, ω), each (n,), after dt of a Cradle: a step of lesson 1, cut at each impact of two balls.

    An impact is elastic: its impulse J along the line of centres reverses the rate of the gap.
        ω⁺ = ω − 2 a (a·ω)/(a·a),  a: derivatives of the gap by both angles
    *Left out:* balls that touch, in which several impacts are one.  Raises Diverged after MOST_IMPACTS in a step.
    """
    for _ in range(MOST_IMPACTS):
        late, k = first_impact(step, t, theta, omega, dt, p)
        theta, omega = step(swing_acceleration, t, theta, omega, late, p)
        if k < 0:
            return theta, omega
        _, a, b = cradle_gap(theta, k, p)
        twice = 2.0 * (a * omega[k] + b * omega[k + 1]) / (a * a + b * b)
        omega = omega.copy()
        omega[k] -= a * twice
        omega[k + 1] -= b * twice
        t, dt = t + late, dt - late
    raise Diverged("impacts in a step", MOST_IMPACTS, "leave gaps between the balls, or take a smaller step")


def advance_swinging(step, t, theta, omega, dt, steps, p):
    """Given.  Return (θ, ω), each (n,), of a Cradle after so many swinging_steps with a step of lesson 1.

    Raises BadInput for a cradle or a state that cannot be.
    """
    check_record(p, theta)
    t, theta, omega, dt, steps = checked_run(t, theta, omega, dt, steps)
    check_shape("the angles θ", theta, (theta.size,))
    for n in range(steps):
        theta, omega = swinging_step(step, t + n * dt, theta, omega, dt, p)
    check_end(theta, omega, dt)
    return theta, omega
