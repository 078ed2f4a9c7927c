"""Lesson 10.  Simulator: the whole loop, composed of functions of lessons 1 to 9.

    forces → velocities → detection → contact → positions

Symbols: n bodies in arrays · x (n, d) [m] · q (n,) angles [rad] in the plane, (n, 4) unit quaternions in space ·
v (n, d) [m/s] · omega (n,) or (n, 3) [rad/s], world · J (m, d) [N s] impulses of m contacts · F (n, d) [N], tau (n,) or
(n, 3) [N m] loads · p: a Bodies (solutions/given/bodies.py) or any record with the fields that a function reads.

A load is a function  load(t, x, q, v, omega, p) → (F, tau).  Planes are additional rows of all arrays.  A row with
inv_mass = 0 keeps the velocity that you give it: it is the ground if at rest, or a moving conveyor belt or turntable.
A plane moves only along itself; a lift, which rises, is a body.  Lesson 5 has the same order for one body.
A scene calls only what it needs: no detection where nothing can touch.
Given in solutions/given/simulator.py: a loop with joints.  Given in solutions/given/invariants.py: how to judge a run.
*Left out:* restitution of many contacts, sleeping.
"""

import numpy as np

from .checks import check_end, check_load, check_shape, checked_run, float_copy
from .collisions import gjk
from .contact import kept_impulses, velocity_sweep, velocity_sweep_2d
from .friction import cone_radius
from .given.bodies import (
    Bodies,
    CarriedBall,
    RockingBlock,
    Toppled,
    check_sinking,
    check_speed,
    checked_bodies,
    make_bodies,
    make_bodies_2d,
    movable_pairs,
    rocking_acceleration,
    stop_slip,
    time_of_landing,
)
from .given.forces import contact_force, joint_forces, joint_forces_2d, normal_and_friction, normal_forces
from .given.invariants import (
    checked_histories,
    closing_speeds,
    mechanical_energy_2d,
    momenta_2d,
    overlap_bound_2d,
    sweep_residual_2d,
    work_of_driven_rows,
)
from .given.joints import (
    close_joints_2d,
    joint_step,
    make_joints,
    parting_speeds,
    without_joined,
)
from .given.passing import check_passing
from .impulses import cross_2d
from .integrators import rk4_step
from .rotation import (
    RollingBall,
    angular_acceleration,
    average_rolling_step,
    body_angular_momentum,
    exponential,
    point_velocity,
    quaternion_product,
    quaternion_update,
    rigid_body_step,
    unrotate,
)
from .support.arms import apply_impulses, apply_impulses_2d, arms_2d, arms_3d, turn_quaternions, world_inertia
from .support.broad_phase import near_pairs
from .support.contact_points import (
    ContactSet,
    ball_bounds,
    box_bounds,
    box_bounds_2d,
    box_contacts,
    box_contacts_2d,
    disc_bounds,
    largest_overlap,
    round_contacts,
)
from .support.records import check_record
from .support.scenes import PileState
from .vectors import cross, dot, norm

# ---------------------------------------------------------------------------------------------- without contact

def weight(t, x, q, v, omega, p):
    """Given.  Return the load of gravity, in the plane or in space: F = m g, no torque; F = 0 where inv_mass = 0."""
    F = np.zeros(x.shape)
    for i in range(x.shape[0]):
        if p.inv_mass[i] > 0.0:
            F[i] = p.gravity / p.inv_mass[i]
    return F, np.zeros(omega.shape)


def new_velocities_2d(load, t, x, q, v, omega, dt, p):
    """Return (v, omega) of all bodies in the plane after their loads have acted for dt.

    F, τ = load(t, x, q, v, omega, p),      v ← v + dt F/m,      ω ← ω + dt τ/I

    1/m and 1/I are p.inv_mass (n,) and p.inv_inertia (n,); where they are 0 the velocity stays.  Returns new arrays.
    *Source:* second lecture deck, “Simulation loop”: forces, velocities.
    """
    ### BEGIN SOLUTION 10.1
    F, tau = load(t, x, q, v, omega, p)
    return v + dt * p.inv_mass[:, None] * F, omega + dt * p.inv_inertia * tau
    ### END SOLUTION


def new_velocities(load, t, x, q, v, omega, dt, p):
    """Return (v, omega) of all bodies in space after their loads have acted for dt.

    v ← v + dt F/m,      ω ← ω + dt ω̇,      with ω̇ = angular_acceleration(q, ω, τ, I_body) of lesson 5, body by body

    I_body = 1/p.inv_inertia[i] (3,).  The three numbers in inv_inertia[i] are all above 0 or all 0.  If they are 0, the
    body keeps its ω, even if it has a finite mass; forces move it all the same.  Returns new arrays.
    *Source:* second lecture deck, “Simulation loop”, with the gyroscopic term.
    """
    ### BEGIN SOLUTION 10.2
    F, tau = load(t, x, q, v, omega, p)
    v, omega = v + dt * p.inv_mass[:, None] * F, float_copy(omega)
    for i in range(omega.shape[0]):
        if p.inv_inertia[i, 0] > 0.0:
            omega[i] = omega[i] + dt * angular_acceleration(q[i], omega[i], tau[i], 1.0 / p.inv_inertia[i])
    return v, omega
    ### END SOLUTION


def free_step_2d(load, t, x, q, v, omega, dt, p):
    """Return (x, q, v, omega) of all bodies in the plane after dt without contact: symplectic Euler for all of them.

    First new_velocities_2d, then positions with the new velocities:   x ← x + dt v,   q ← q + dt ω

    *Source:* second lecture deck, “Simulation loop”.
    """
    ### BEGIN SOLUTION 10.3
    v, omega = new_velocities_2d(load, t, x, q, v, omega, dt, p)
    return x + dt * v, q + dt * omega, v, omega
    ### END SOLUTION


def free_step(load, t, x, q, v, omega, dt, p):
    """Return (x, q, v, omega) of all bodies in space after dt without contact.

    First new_velocities, then positions:   x ← x + dt v,   q ← quaternion_update of lesson 5 with the new ω

    *Source:* second lecture deck, “Simulation loop”.
    """
    ### BEGIN SOLUTION 10.4
    v, omega = new_velocities(load, t, x, q, v, omega, dt, p)
    q = float_copy(q)
    for i in range(q.shape[0]):
        q[i] = quaternion_update(q[i], omega[i], dt)
    return x + dt * v, q, v, omega
    ### END SOLUTION


# ---------------------------------------------------------------------------------------------- with contact

def find_contacts(narrow, x, low, high, turn, p):
    """Return the ContactSet of all bodies whose gap is at most p.margin.

    Broad phase:    near_pairs(low − margin, high + margin, p.planes), and of these movable_pairs(pairs, p)
    narrow phase:   narrow(x, turn, p.half, p.planes, pairs, p.margin)

    low and high (n, d) are the corners of boxes around all bodies, and turn their rotation: what a bounds function
    returns.  narrow is round_contacts, box_contacts_2d or box_contacts.  A contact that is found before it closes can
    stop the body just in time.
    *Source:* second lecture deck, “Simulation loop”: collision detection; lesson 6.
    """
    ### BEGIN SOLUTION 10.5
    pairs = movable_pairs(near_pairs(low - p.margin, high + p.margin, p.planes), p)
    return narrow(x, turn, p.half, p.planes, pairs, p.margin)
    ### END SOLUTION


def contact_step_2d(load, bounds, narrow, t, state, dt, p):
    """Return the PileState of all bodies in the plane after dt: the lecture's loop with contact.

    velocities:   new_velocities_2d
    detection:    low, high, turn = bounds(x, q, p.half),   then find_contacts
    contact:      arms_2d(x, p.inv_mass, p.inv_inertia, contacts), and kept_impulses of the last contacts (near =
                  p.margin), which are applied at once by
                  apply_impulses_2d(v, omega, J, contacts, arms, p.inv_mass, p.inv_inertia), in place
                  then p.sweeps times velocity_sweep_2d with aim = closing_speeds(gap, dt), give = 0 and pile = p
    positions:    x ← x + dt v,   q ← q + dt ω

    state has the fields x, q, v, omega, contacts, J, of which the last two belong to the last step.
    *Source:* second lecture deck, “Simulation loop”; sequential impulses, Catto 2006.
    """
    ### BEGIN SOLUTION 10.6
    x, q, v, omega, old, J = state
    v, omega = new_velocities_2d(load, t, x, q, v, omega, dt, p)
    low, high, turn = bounds(x, q, p.half)
    contacts = find_contacts(narrow, x, low, high, turn, p)
    arms, aim = arms_2d(x, p.inv_mass, p.inv_inertia, contacts), closing_speeds(contacts.gap, dt)
    J = kept_impulses(contacts, old, J, p.margin)
    apply_impulses_2d(v, omega, J, contacts, arms, p.inv_mass, p.inv_inertia)
    for _ in range(p.sweeps):
        v, omega, J = velocity_sweep_2d(v, omega, J, aim, 0.0 * aim, contacts, arms, p)
    return PileState(x + dt * v, q + dt * omega, v, omega, contacts, J)
    ### END SOLUTION


def contact_step(load, bounds, narrow, t, state, dt, p):
    """Return the PileState of all bodies in space after dt: the loop of contact_step_2d with

    new_velocities,  world_inertia(turn, p.inv_inertia) in place of p.inv_inertia wherever an impulse acts,  arms_3d and
    apply_impulses with the arguments of arms_2d and apply_impulses_2d,
    velocity_sweep(v, omega, J, aim, give, contacts, arms, p.inv_mass, inv_inertia, p.mu)  and
    turn_quaternions(q, omega, dt).
    """
    ### BEGIN SOLUTION 10.7
    x, q, v, omega, old, J = state
    v, omega = new_velocities(load, t, x, q, v, omega, dt, p)
    low, high, turn = bounds(x, q, p.half)
    contacts = find_contacts(narrow, x, low, high, turn, p)
    inv_inertia = world_inertia(turn, p.inv_inertia)
    arms, aim = arms_3d(x, p.inv_mass, inv_inertia, contacts), closing_speeds(contacts.gap, dt)
    J = kept_impulses(contacts, old, J, p.margin)
    apply_impulses(v, omega, J, contacts, arms, p.inv_mass, inv_inertia)
    for _ in range(p.sweeps):
        v, omega, J = velocity_sweep(v, omega, J, aim, 0.0 * aim, contacts, arms, p.inv_mass, inv_inertia, p.mu)
    return PileState(x + dt * v, turn_quaternions(q, omega, dt), v, omega, contacts, J)
    ### END SOLUTION


# ---------------------------------------------------------------------------------------------- a floor that moves

def support_velocity(place, ball):
    """Return the velocity [m/s] (3,) of the floor of a CarriedBall at a place (3,) [m].

    *Find* it.  The floor is a rigid body that moves with floor_v and turns with floor_omega about its `centre`.

    *Source:* lesson 5, the velocity of a point of a body; the floor is a body whose motion is given.
    """
    ### BEGIN SOLUTION 10.8
    return point_velocity(ball.floor_v, ball.floor_omega, place - ball.centre)
    ### END SOLUTION


def carried_step(load, t, x, q, v, omega, dt, ball):
    """Return (x, q, v, ω) of a CarriedBall after dt; second order while it rolls, exact while it slips along a line.

    Friction brings the lowest point to the velocity of the floor where the ball would be at t + dt if v stayed:
        v', ω' = stop_slip(v, omega, support_velocity(x + dt v, ball), dt, ball)
        _, _, v_new, ω_new = rigid_body_step(load, t, x, q, v', ω', dt, ball)
        x ← x + dt (v + v_new)/2,      q ← quaternion_product(exponential(½ dt (ω + ω_new)), q)

    From step to step the floor below changes by dt (3/2 v − 1/2 v_before), which is Adams and Bashforth's method.
    *Source:* the ball on a turntable moves on circles, Weltner 1979.
    """
    ### BEGIN SOLUTION 10.9
    pushed, turned = stop_slip(v, omega, support_velocity(x + dt * v, ball), dt, ball)
    _, _, v_new, omega_new = rigid_body_step(load, t, x, q, pushed, turned, dt, ball)
    q = quaternion_product(exponential(0.5 * dt * (omega + omega_new)), q)
    return x + 0.5 * dt * (v + v_new), q, v_new, omega_new
    ### END SOLUTION


# ---------------------------------------------------------------------------------------------- exact events

def slip_time(v, omega, ball):
    """Return the time [s] until a RollingBall on a floor at rest ceases to slip; inf if it never does.

    *Find* the rate at which friction and gravity change the slip, the velocity of the lowest point:
        u = v + ω × r,      r = (0, 0, −radius)
    The rate is constant.  Friction is as large as Coulomb allows, μ m max(0, −g_z): the floor never pulls.  Without
    load there is no friction, even for μ = ∞: cone_radius(mu, F_N) of lesson 3.
    I = I_body[0] is the same about all axes.
    Only the part of u along the floor counts: set u_z = 0.  Return 0 where u = 0, and inf where |u| does not decrease.
    All numbers are finite, but μ may be ∞; advance_rigid_body has checked that.
    Gravity along the floor must be zero or parallel to u, or u would change its direction.
    *Source:* Newton and Euler, with Coulomb's law.
    """
    ### BEGIN SOLUTION 10.10
    # u̇ = −f (1 + m radius²/I) u/|u| + g_t  with f = μ max(0, −g_z).
    # So |u| decreases by  f (1 + m radius²/I) − u · g_t/|u|  in a second.
    slip = point_velocity(v, omega, np.array([0.0, 0.0, -ball.radius]))
    slip[2] = 0.0
    size = norm(slip)
    if size == 0.0:
        return 0.0
    along = dot(slip, ball.gravity) / size
    rate = cone_radius(ball.mu, -ball.gravity[2]) * (1.0 + ball.m * ball.radius * ball.radius / ball.I_body[0]) - along
    return size / rate if rate > 0.0 else np.inf
    ### END SOLUTION


def exact_rolling_step(load, t, x, q, v, omega, dt, ball):
    """Return (x, q, v, ω) of a RollingBall after dt, exact for every dt.

    *Find* how.  average_rolling_step is exact while the accelerations are constant.  They change once, when the slip
    ends:  slip_time(v, omega, ball) says after how long.  That may be longer than dt, or infinite.
    Gravity along the floor is zero or parallel to the slip, as in slip_time.  Without slip it may have any direction.

    *Source:* event-driven integration; stick and slip of lesson 3.
    """
    ### BEGIN SOLUTION 10.11
    first = np.minimum(dt, slip_time(v, omega, ball))
    x, q, v, omega = average_rolling_step(load, t, x, q, v, omega, first, ball)
    return average_rolling_step(load, t + first, x, q, v, omega, dt - first, ball)
    ### END SOLUTION


def corner_impact(v, omega, r, inv_mass, inv_inertia):
    """Return (v (2,), ω) of a body in the plane after its point at r (2,) has hit an edge and stops there.

    *Find* what the impulse, which acts at that point, leaves unchanged.  Afterwards the body turns about that point.
    v is the velocity of the centre, and r × v = cross_2d(r, v).  inv_mass and inv_inertia are above zero.  For a
    uniform block the result is Housner's ratio ω⁺/ω = 1 − 1.5 sin²α.
    *Source:* Housner 1963, “The behavior of inverted pendulum structures during earthquakes”.
    """
    ### BEGIN SOLUTION 10.12
    # The angular momentum about the corner stays, L = I ω − m (r × v); then it turns about the corner, v⁺ = −ω⁺ × r.
    L = omega / inv_inertia - cross_2d(r, v) / inv_mass
    omega = L / (1.0 / inv_inertia + (r[0] * r[0] + r[1] * r[1]) / inv_mass)
    return omega * np.array([r[1], -r[0]]), omega
    ### END SOLUTION


def rocking_step(step, t, x, v, dt, block):
    """Given.  Return (θ, θ̇), each (1,), after dt of rocking: a step of lesson 1, cut where it changes its corner.

    A block on its right corner is the mirror image of one on its left corner.
    *Left out:* a second change in one step; a block that rocks so quickly is nearly at rest.
    """
    if x[0] == 0.0 and v[0] == 0.0:                          # it stands
        return x, v
    side = 1.0 if x[0] > 0.0 or (x[0] == 0.0 and v[0] > 0.0) else -1.0
    x, v = side * x, side * v
    x_new, v_new = step(rocking_acceleration, t, x, v, dt, block)
    if not x_new[0] < 0.0:
        return side * x_new, side * v_new
    late = time_of_landing(step, t, x, v, dt, block)
    _, v = step(rocking_acceleration, t, x, v, late, block)
    lands = np.array([block.half_width, -block.half_height])
    falls = v[0] * np.array([-block.half_height, block.half_width])
    _, rate = corner_impact(falls, v[0], lands, 1.0 / block.m, 1.0 / block.inertia)
    x_new, v_new = step(rocking_acceleration, t + late, 0.0 * x, np.array([-rate]), dt - late, block)
    return -side * x_new, -side * v_new


# ---------------------------------------------------------------------------------------------- is it right?

def mechanical_energy(x, q, v, omega, p):
    """Return the energy [J] of all bodies in space that can move: of motion, of rotation, and in the field of gravity.

    *Find* it.  p.gravity g (3,) [m/s²] is the same everywhere, and its potential energy is 0 at x = 0.  The energy of
    rotation ½ ω · I ω is simple in body coordinates (unrotate), with the moments Iₖ = 1/p.inv_inertia[i, k].
    Rows with inv_mass = 0 do not count; a body whose inv_inertia is 0 has no energy of rotation.  No field of p is NaN:
    the loops refuse such a record.
    """
    ### BEGIN SOLUTION 10.13
    energy = 0.0
    for i in range(x.shape[0]):
        if p.inv_mass[i] > 0.0:
            w = unrotate(q[i], omega[i])
            energy += (0.5 * dot(v[i], v[i]) - dot(p.gravity, x[i])) / p.inv_mass[i]
            if p.inv_inertia[i, 0] > 0.0:
                energy += 0.5 * np.sum(w * w / p.inv_inertia[i])
    return energy
    ### END SOLUTION


def momenta(x, q, v, omega, p):
    """Return momentum P [kg m/s] (3,) and angular momentum L [kg m²/s] (3,) about the origin, of all movable bodies.

    *Find* both.  The angular momentum of a body about the origin has two parts: that of its mass as a point, and that
    about its own centre, which is body_angular_momentum(q, ω, I_body) of lesson 5.

    Rows with inv_mass = 0 do not count; a body whose inv_inertia is 0 has no I ω.  No field of p is NaN.
    Without loads and supports both are constant, also through impacts between the bodies.
    """
    ### BEGIN SOLUTION 10.14
    P, L = np.zeros(3), np.zeros(3)
    for i in range(x.shape[0]):
        if p.inv_mass[i] > 0.0:
            P += v[i] / p.inv_mass[i]
            L += cross(x[i], v[i]) / p.inv_mass[i]
            if p.inv_inertia[i, 0] > 0.0:
                L += body_angular_momentum(q[i], omega[i], 1.0 / p.inv_inertia[i])
    return P, L
    ### END SOLUTION


def gain_without_source(energies, work):
    """Return the largest gain of energy [J] that no work explains, between any two times of a run.

    *Find* it from the energies E (k,) [J] and the work W (k,) [J] that was done until each time.  Work explains a gain
    of energy from any time j to any later time k, if it grew by as much.

    The gain is 0 or more, since k may be j.  Friction and impacts with e = 0 only take energy, so a growth above the
    error of the steps then reveals a fault.  E and W may be lists.  Call checked_histories(energies, work) first: it
    returns both as arrays.  Raises what checked_histories raises.
    """
    ### BEGIN SOLUTION 10.15
    energies, work = checked_histories(energies, work)
    lowest, gain = np.inf, 0.0
    for k in range(energies.size):
        rest = energies[k] - work[k]
        lowest = np.minimum(lowest, rest)
        gain = np.maximum(gain, rest - lowest)
    return gain
    ### END SOLUTION


def compare(full, minimal, runs, clock):
    """Return (largest difference, ratio of times) of a full loop and a minimal one, which leaves something out.

    full() and minimal() return arrays of the same shape.  In each of `runs` rounds, run full and then minimal, and time
    each run with clock() [s].  The difference is the largest |full − minimal| of the two runs of a round, over all
    entries and all rounds, and NaN where one of them is NaN.  The ratio is the median, over the rounds, of the time of
    full over that of minimal.
    """
    ### BEGIN SOLUTION 10.16
    ratios, difference = np.zeros(runs), 0.0
    for k in range(runs):
        began = clock()
        slow = full()
        between = clock()
        quick = minimal()
        ratios[k] = (between - began) / (clock() - between)
        difference = np.maximum(difference, np.max(np.abs(slow - quick)))
    return difference, np.median(ratios)
    ### END SOLUTION


# ---------------------------------------------------------------------------------------------- many steps

def advance_free(step, load, t, x, q, v, omega, dt, steps, p):
    """Given.  Return (x, q, v, omega) after so many steps of free_step_2d or free_step.

    Raises BadInput for arrays that do not fit, Diverged when the end is not finite.
    """
    check_record(p, x)
    t, x, q, v, omega, dt, steps = checked_bodies(t, x, q, v, omega, dt, steps, p)
    check_load(load(t, x, q, v, omega, p), x.shape, omega.shape)
    for n in range(steps):
        x, q, v, omega = step(load, t + n * dt, x, q, v, omega, dt, p)
    check_speed(v, omega, dt)
    return x, q, v, omega


def advance_contact(step, load, bounds, narrow, t, state, dt, steps, p):
    """Given.  Return the PileState after so many steps of contact_step_2d or contact_step.

    Raises BadInput for arrays that do not fit.  Raises Diverged where bodies sink into each other (it names both
    bodies, the time and the depth) or are not finite, and where they pass each other within a step (it names the speed
    and a step that is short enough).  Bodies that overlap at the beginning stay so: this loop does not separate them.
    """
    check_record(p, state)
    t, x, q, v, omega, dt, steps = checked_bodies(t, state.x, state.q, state.v, state.omega, dt, steps, p)
    check_load(load(t, x, q, v, omega, p), x.shape, omega.shape)
    state, allowed = PileState(x, q, v, omega, state.contacts, state.J), np.inf
    for n in range(steps):
        before, state = state, step(load, bounds, narrow, t + n * dt, state, dt, p)
        allowed = check_sinking(state, t + n * dt, dt, p, allowed)
        check_passing(before, state, bounds, narrow, t + n * dt, dt, p)
    check_speed(state.v, state.omega, dt)
    return state


def advance_rocking(step, t, x, v, dt, steps, block):
    """Given.  Return (θ, θ̇), each (1,), of a RockingBlock after so many rocking_steps with a step of lesson 1.

    Raises BadInput for a block or a state that cannot be, Toppled where the block has fallen on its side.
    """
    check_record(block, x)
    t, x, v, dt, steps = checked_run(t, x, v, dt, steps)
    check_shape("the lean θ", x, (1,))
    for n in range(steps):
        x, v = rocking_step(step, t + n * dt, x, v, dt, block)
        if abs(x[0]) >= 0.5 * np.pi:
            raise Toppled(x[0])
    check_end(x, v, dt)
    return x, v


# ---------------------------------------------------------------------------------------------- why?

def stopping_depth(speed, gap, margin, dt):
    """Return the depth [m] below the floor at which the loop stops a body that comes straight at it; 0 on its surface.

    The body has the speed > 0 [m/s], no gravity acts, and at the start it is at a gap > 0 [m] above a plane.  Each step
    of dt > 0 [s] looks for contacts before it moves the body.  A contact is found where the gap is at most the margin
    ≥ 0 [m], and then the body may move to the surface, but no further.  The loop never pushes bodies out.
    *Find* the depth before you run anything.  Which step finds the contact, and how much of the gap is left then?
    """
    ### BEGIN SOLUTION 10.17
    steps = np.maximum(0.0, np.ceil((gap - margin) / (speed * dt)))
    return np.maximum(0.0, steps * speed * dt - gap)
    ### END SOLUTION


def may_be_extrapolated():
    """Return the letter of the result that may be extrapolated by 2 t(dt/2) − t(dt): "A", "B", "C" or "D".

    The figure of the notebook shows four laws: the time of an event against the step dt of the loop that computes it.
    """
    ### BEGIN SOLUTION 10.18
    return "B"
    ### END SOLUTION


def my_scene(n):
    """Return (x (n, 2) [m], angles q (n,), v (n, 2) [m/s], half (n, 2) [m], planes (p, 3)) of a scene of n boxes.

    *Make it*: place the boxes, give them velocities, and let them meet.  Many scenes are right: dominoes, a tower that
    falls, a break in billiards.  The judge runs your loop for 1 s with dt = 1/100 s, g = 9.81 m/s² downwards, 1 kg per
    box, μ = 0.5, 10 sweeps and a margin of 3 cm, for each n from 5 to 8, and demands:

    - The half sizes are 5 to 50 cm.  No box moves by more than the smallest half size in one step.
    - At least n/2 pairs of boxes that are farther apart than the margin at the start push each other later.
    - The overlap is never above 1 cm, at the start and later, between boxes and with planes.
    - The energy is never higher than at the start by more than what lifts all boxes by 1 mm.
    """
    ### BEGIN SOLUTION 10.19
    # A row of dominoes; the first one leans so far that it falls, and is pushed.
    wide, high, lean = 0.05, 0.2, 0.4
    x, q, v, half = np.empty((n, 2)), np.zeros(n), np.zeros((n, 2)), np.empty((n, 2))
    for k in range(n):
        x[k, 0], x[k, 1] = 0.3 * k, high
        half[k, 0], half[k, 1] = wide, high
    q[0], v[0, 0] = -lean, 1.0
    x[0, 0] = wide - wide * np.cos(lean) + high * np.sin(lean)
    x[0, 1] = wide * np.sin(lean) + high * np.cos(lean)
    return x, q, v, half, np.array([[0.0, 1.0, 0.0]])
    ### END SOLUTION
