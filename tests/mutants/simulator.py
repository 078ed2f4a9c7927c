"""Lesson 10: stale velocities, forgotten bodies, floors that stand still, events that come too late."""

import numpy as np

from solutions import simulator as worked
from solutions.rotation import rotation_matrix
from solutions.support.broad_phase import Pairs

from . import collection

wrong, right, edit, MUTANTS = collection(worked)


# 10.1 -----------------------------------------------------------------------------------------------------------
@right("10.1", "body by body")
def new_velocities_2d(load, t, x, q, v, omega, dt, p):
    F, tau = load(t, x, q, v, omega, p)
    v, omega = v.copy(), omega.copy()
    for i in range(len(v)):
        v[i] += dt * p.inv_mass[i] * F[i]
        omega[i] += dt * p.inv_inertia[i] * tau[i]
    return v, omega


edit("10.1", "divides by the inverse mass", "p.inv_mass[:, None] * F", "F / p.inv_mass[:, None]")
edit("10.1", "the mass of the first for all", "p.inv_mass[:, None]", "p.inv_mass[0]")
edit("10.1", "does not turn", "omega + dt * p.inv_inertia * tau", "omega")
edit("10.1", "turns the other way", "omega + dt *", "omega - dt *")
edit("10.1", "moves what cannot be moved", "p.inv_mass[:, None] * F", "np.maximum(p.inv_mass, 0.1)[:, None] * F")
edit("10.1", "loads at time 0", "load(t, x", "load(0.0, x")


# 10.2 -----------------------------------------------------------------------------------------------------------
@right("10.2", "in body coordinates")
def new_velocities(load, t, x, q, v, omega, dt, p):
    F, tau = load(t, x, q, v, omega, p)
    omega = omega.copy()
    for i in np.flatnonzero(p.inv_inertia[:, 2] > 0.0):
        R, I = rotation_matrix(q[i]), 1.0 / p.inv_inertia[i]
        w = R.T @ omega[i]
        omega[i] += dt * R @ ((R.T @ tau[i] - np.cross(w, I * w)) / I)
    return v + (dt * p.inv_mass * F.T).T, omega


edit("10.2", "no gyroscopic term", "angular_acceleration(q[i], omega[i], tau[i], 1.0 / p.inv_inertia[i])",
     "angular_acceleration(q[i], 0.0 * omega[i], tau[i], 1.0 / p.inv_inertia[i])")
edit("10.2", "no torque", "omega[i], tau[i], 1.0", "omega[i], 0.0 * tau[i], 1.0")
edit("10.2", "inverse inertia for inertia", "1.0 / p.inv_inertia[i]", "p.inv_inertia[i]")
edit("10.2", "the first body only", "range(omega.shape[0])", "range(1)")
edit("10.2", "the orientation of the first for all", "q[i]", "q[0]")
edit("10.2", "the velocity stays", "v + dt * p.inv_mass[:, None] * F", "v")


edit("10.2", "turns what has a mass", "p.inv_inertia[i, 0] > 0.0", "p.inv_mass[i] > 0.0")


# 10.3 -----------------------------------------------------------------------------------------------------------
@right("10.3", "changes of positions apart")
def free_step_2d(load, t, x, q, v, omega, dt, p):
    faster, turning = worked.new_velocities_2d(load, t, x, q, v, omega, dt, p)
    return np.array([x[i] + dt * faster[i] for i in range(len(x))]), q + turning * dt, faster, turning


edit("10.3", "positions with the old velocities",
     "v, omega = new_velocities_2d(load, t, x, q, v, omega, dt, p)",
     "old, (v, omega) = v, new_velocities_2d(load, t, x, q, v, omega, dt, p); x = x + dt * (old - v)")
edit("10.3", "angles stay", "q + dt * omega", "q")
edit("10.3", "half a step", "x + dt * v", "x + 0.5 * dt * v")
edit("10.3", "velocities are lost", "v, omega = new", "_, omega = new")
edit("10.3", "turns back", "q + dt * omega", "q - dt * omega")


# 10.4 -----------------------------------------------------------------------------------------------------------
@right("10.4", "with the quaternions of all bodies at once")
def free_step(load, t, x, q, v, omega, dt, p):
    v, omega = worked.new_velocities(load, t, x, q, v, omega, dt, p)
    return x + dt * v, worked.turn_quaternions(q, omega, dt), v, omega


edit("10.4", "the first body only", "range(q.shape[0])", "range(1)")
edit("10.4", "the spin of the first for all", "omega[i], dt", "omega[0], dt")
edit("10.4", "turns back", "quaternion_update(q[i], omega[i], dt)", "quaternion_update(q[i], -omega[i], dt)")
edit("10.4", "positions stay", "x + dt * v", "x")
edit("10.4", "not unit", "quaternion_update(q[i], omega[i], dt)", "1.01 * quaternion_update(q[i], omega[i], dt)")
edit("10.4", "velocities are lost", "v, omega = new", "_, omega = new")


# 10.5 -----------------------------------------------------------------------------------------------------------
@right("10.5", "tries all pairs")
def find_contacts(narrow, x, low, high, turn, p):
    first, partner = [0], []
    for i in range(len(p.half)):
        partner += [j for j in range(i + 1, len(x)) if p.inv_mass[i] + p.inv_mass[j] > 0.0]
        first.append(len(partner))
    pairs = Pairs(np.array(first, np.int64), np.array(partner, np.int64))
    return narrow(x, turn, p.half, p.planes, pairs, p.margin)


edit("10.5", "boxes are not widened", "near_pairs(low - p.margin, high + p.margin, p.planes)",
     "near_pairs(low, high, p.planes)")
edit("10.5", "boxes are made smaller", "low - p.margin", "low + p.margin")
edit("10.5", "only what overlaps", "pairs, p.margin)", "pairs, 0.0)")
edit("10.5", "no planes", "high + p.margin, p.planes)", "high + p.margin, p.planes[:0])")
edit("10.5", "ground on ground", "p.inv_mass)", "p.inv_mass + 1.0)")
edit("10.5", "twice the margin", "pairs, p.margin)", "pairs, 2.0 * p.margin)")


# 10.6 -----------------------------------------------------------------------------------------------------------
@right("10.6", "impulses once more from the start")
def contact_step_2d(load, bounds, narrow, t, state, dt, p):
    v, omega = worked.new_velocities_2d(load, t, state.x, state.q, state.v, state.omega, dt, p)
    contacts = worked.find_contacts(narrow, state.x, *bounds(state.x, state.q, p.half), p)
    arms = worked.arms_2d(state.x, p.inv_mass, p.inv_inertia, contacts)
    J = worked.kept_impulses(contacts, state.contacts, state.J, p.margin)
    worked.apply_impulses_2d(v, omega, J, contacts, arms, p.inv_mass, p.inv_inertia)
    aim, give = -np.maximum(contacts.gap, 0.0) / dt, np.zeros(len(contacts.gap))
    sweep = 0
    while sweep < p.sweeps:
        v, omega, J = worked.velocity_sweep_2d(v, omega, J, aim, give, contacts, arms, p)
        sweep += 1
    return worked.PileState(state.x + dt * v, state.q + dt * omega, v, omega, contacts, J)


for number, old_law in (("10.6", "velocity_sweep_2d(v, omega, J, aim, 0.0 * aim, contacts, arms, p)"),
                        ("10.7", "velocity_sweep(v, omega, J, aim, 0.0 * aim, contacts, arms, p.inv_mass, inv_inertia, "
                                 "p.mu)")):
    edit(number, "stops what is not there yet", old_law, old_law.replace("aim, 0.0", "0.0 * aim, 0.0"))
    edit(number, "everything is soft", old_law, old_law.replace("0.0 * aim", "0.0 * aim + 1.0"))
    edit(number, "asks for more than to come to rest", "closing_speeds(contacts.gap, dt)",
         "-closing_speeds(contacts.gap, dt) + 0.1")
    edit(number, "positions without contact", "return PileState(x + dt * v",
         "return PileState(x + dt * (v if J.size == 0 else state.v)")
    edit(number, "J is lost", "v, omega, contacts, J)", "v, omega, contacts, 0.0 * J)")
    edit(number, "loads at time 0", "(load, t, x", "(load, 0.0, x")
    edit(number, "remembers from everywhere", "kept_impulses(contacts, old, J, p.margin)",
         "kept_impulses(contacts, old, J, np.inf)")
    edit(number, "remembers within a millimetre", "kept_impulses(contacts, old, J, p.margin)",
         "kept_impulses(contacts, old, J, 1e-3)")
    edit(number, "velocities of before", "PileState(x + dt * v", "PileState(x + dt * state.v")
edit("10.6", "remembered but not applied", "apply_impulses_2d(v, omega, J, contacts, arms, p.inv_mass, p.inv_inertia)",
     "pass")
edit("10.6", "no memory", "kept_impulses(contacts, old, J, p.margin)", "np.zeros(contacts.p.shape)")
edit("10.6", "one sweep", "range(p.sweeps)", "range(1)")
edit("10.6", "angles stay", "q + dt * omega", "q")
edit("10.6", "no forces", "v, omega = new_velocities_2d(load, t, x, q, v, omega, dt, p)",
     "v, omega = v.copy(), omega.copy()")


# 10.7 -----------------------------------------------------------------------------------------------------------
@right("10.7", "in another order")
def contact_step(load, bounds, narrow, t, state, dt, p):
    low, high, turn = bounds(state.x, state.q, p.half)
    contacts = worked.find_contacts(narrow, state.x, low, high, turn, p)
    inertia = worked.world_inertia(turn, p.inv_inertia)
    arms = worked.arms_3d(state.x, p.inv_mass, inertia, contacts)
    v, omega = worked.new_velocities(load, t, state.x, state.q, state.v, state.omega, dt, p)
    J = worked.kept_impulses(contacts, state.contacts, state.J, p.margin)
    worked.apply_impulses(v, omega, J, contacts, arms, p.inv_mass, inertia)
    aim = worked.closing_speeds(contacts.gap, dt)
    for _ in range(p.sweeps):
        v, omega, J = worked.velocity_sweep(v, omega, J, aim, np.zeros(len(aim)), contacts, arms, p.inv_mass, inertia,
                                            p.mu)
    return worked.PileState(state.x + dt * v, worked.turn_quaternions(state.q, omega, dt), v, omega, contacts, J)


edit("10.7", "remembered but not applied", "apply_impulses(v, omega, J, contacts, arms, p.inv_mass, inv_inertia)",
     "pass")
edit("10.7", "no memory", "kept_impulses(contacts, old, J, p.margin)", "np.zeros(contacts.p.shape)")
edit("10.7", "orientations stay", "turn_quaternions(q, omega, dt)", "q")
edit("10.7", "inertia of the body for that of the world", "world_inertia(turn, p.inv_inertia)",
     "world_inertia(np.stack([np.eye(3)] * len(turn)), p.inv_inertia)")
edit("10.7", "no friction", "p.mu)", "0.0)")
edit("10.7", "one sweep", "range(p.sweeps)", "range(1)")
edit("10.7", "no forces", "v, omega = new_velocities(load, t, x, q, v, omega, dt, p)",
     "v, omega = v.copy(), omega.copy()")


# 10.8 -----------------------------------------------------------------------------------------------------------
@right("10.8", "coordinate by coordinate")
def support_velocity(place, ball):
    r, w = place - ball.centre, ball.floor_omega
    return ball.floor_v + np.array([w[1] * r[2] - w[2] * r[1], w[2] * r[0] - w[0] * r[2], w[0] * r[1] - w[1] * r[0]])


edit("10.8", "turns about the origin", "place - ball.centre", "place")
edit("10.8", "turns the other way", "ball.floor_omega, place", "-ball.floor_omega, place")
edit("10.8", "turns in place", "point_velocity(ball.floor_v", "point_velocity(0.0 * ball.floor_v")
edit("10.8", "does not turn", "ball.floor_omega, place", "0.0 * ball.floor_omega, place")


# 10.9 -----------------------------------------------------------------------------------------------------------
@right("10.9", "by the change of the velocity")
def carried_step(load, t, x, q, v, omega, dt, ball):
    pushed, turned = worked.stop_slip(v, omega, worked.support_velocity(x + dt * v, ball), dt, ball)
    _, _, v_new, omega_new = worked.rigid_body_step(load, t, x, q, pushed, turned, dt, ball)
    spin = worked.exponential(dt * (omega + 0.5 * (omega_new - omega)))
    return x + dt * (v + 0.5 * (v_new - v)), worked.quaternion_product(spin, q), v_new, omega_new


edit("10.9", "the floor where the ball was", "support_velocity(x + dt * v, ball)", "support_velocity(x, ball)")
edit("10.9", "loads at time 0", "rigid_body_step(load, t, x", "rigid_body_step(load, 0.0, x")
edit("10.9", "the floor half a step ahead", "support_velocity(x + dt * v, ball)",
     "support_velocity(x + 0.5 * dt * v, ball)")
edit("10.9", "the floor stands still", "support_velocity(x + dt * v, ball)", "0.0 * x")
edit("10.9", "positions with the new velocities", "0.5 * dt * (v + v_new)", "dt * v_new")
edit("10.9", "turns with the new spin", "0.5 * dt * (omega + omega_new)", "dt * omega_new")
edit("10.9", "does not turn", "quaternion_product(exponential(0.5 * dt * (omega + omega_new)), q)", "q")
edit("10.9", "the old spin", "q, v_new, omega_new", "q, v_new, omega")


# 10.10 ----------------------------------------------------------------------------------------------------------
@right("10.10", "from the deceleration of the slip")
def slip_time(v, omega, ball):
    r = np.array([0.0, 0.0, -ball.radius])
    u = (v + np.cross(omega, r))[:2]
    size = np.hypot(u[0], u[1])
    if size == 0.0:
        return 0.0
    K = 1.0 / ball.m + ball.radius**2 / ball.I_body[0]
    force = ball.mu * ball.m * abs(ball.gravity[2])
    slower = force * K - ball.gravity[:2] @ u / size
    return size / slower if slower > 0.0 else np.inf


edit("10.10", "friction only brakes", "(1.0 + ball.m * ball.radius * ball.radius / ball.I_body[0])", "1.0")
edit("10.10", "does not look at the spin", "point_velocity(v, omega,", "point_velocity(v, 0.0 * omega,")
edit("10.10", "the highest point", "-ball.radius]", "ball.radius]")
edit("10.10", "gravity helps", "- along", "+ along")
edit("10.10", "a floor that is level", "- along", "")
edit("10.10", "rises and slips", "slip[2] = 0.0", "pass")
edit("10.10", "always ends", "size / rate if rate > 0.0 else np.inf", "size / rate")
edit("10.10", "no friction coefficient", "-ball.mu * ball.gravity[2]", "-ball.gravity[2]")


# 10.11 ----------------------------------------------------------------------------------------------------------
@right("10.11", "as a loop over both parts")
def exact_rolling_step(load, t, x, q, v, omega, dt, ball):
    state, first = (x, q, v, omega), min(dt, worked.slip_time(v, omega, ball))
    for begins, part in ((t, first), (t + first, dt - first)):
        state = worked.average_rolling_step(load, begins, *state, part, ball)
    return state


edit("10.11", "one part", "np.minimum(dt, slip_time(v, omega, ball))", "dt")
edit("10.11", "the rest is as long as the step", "omega, dt - first, ball)", "omega, dt, ball)")
edit("10.11", "longer than the step", "np.minimum(dt, slip_time(v, omega, ball))", "slip_time(v, omega, ball)")
edit("10.11", "the first part at time 0", "average_rolling_step(load, t, x", "average_rolling_step(load, 0.0, x")
edit("10.11", "the second part at time 0", "load, t + first", "load, first")
edit("10.11", "the second part at the time of the first", "load, t + first", "load, t")
edit("10.11", "half of the slip", "np.minimum(dt, slip_time(v, omega, ball))",
     "np.minimum(dt, 0.5 * slip_time(v, omega, ball))")
edit("10.11", "the second part from the start", "x, q, v, omega = average", "_, q, v, omega = average")


# 10.12 ----------------------------------------------------------------------------------------------------------
@right("10.12", "by the impulse at the corner")
def corner_impact(v, omega, r, inv_mass, inv_inertia):
    lever = np.array([-r[1], r[0]])
    K = inv_mass * np.eye(2) + inv_inertia * np.outer(lever, lever)
    J = -np.linalg.solve(K, v + omega * lever)
    return v + inv_mass * J, omega + inv_inertia * (lever @ J)


edit("10.12", "only the spin is kept", "omega / inv_inertia - cross_2d(r, v) / inv_mass", "omega / inv_inertia")
edit("10.12", "the other side", "- cross_2d(r, v)", "+ cross_2d(r, v)")
edit("10.12", "inertia about the centre", "(1.0 / inv_inertia + (r[0] * r[0] + r[1] * r[1]) / inv_mass)",
     "(1.0 / inv_inertia)")
edit("10.12", "energy is kept", "omega = L / (1.0 / inv_inertia + (r[0] * r[0] + r[1] * r[1]) / inv_mass)", "pass")
edit("10.12", "the centre stops", "omega * np.array([r[1], -r[0]])", "0.0 * v")
edit("10.12", "turns away from the corner", "np.array([r[1], -r[0]])", "np.array([-r[1], r[0]])")


# 10.13 ----------------------------------------------------------------------------------------------------------
@right("10.13", "each kind for all bodies")
def mechanical_energy(x, q, v, omega, p):
    moves = np.flatnonzero(p.inv_mass > 0.0)
    m = 1.0 / p.inv_mass[moves]
    spin = sum(0.5 * np.sum((rotation_matrix(q[i]).T @ omega[i]) ** 2 / p.inv_inertia[i])
               for i in moves if p.inv_inertia[i, 0] > 0.0)
    return np.sum(0.5 * m * np.sum(v[moves] ** 2, axis=1)) - m @ (x[moves] @ p.gravity) + spin


edit("10.13", "height counts downwards", "- dot(p.gravity, x[i])", "+ dot(p.gravity, x[i])")
edit("10.13", "twice the motion", "0.5 * dot(v[i], v[i])", "dot(v[i], v[i])")
edit("10.13", "spin in the world", "unrotate(q[i], omega[i])", "omega[i]")
edit("10.13", "no rotation", "0.5 * np.sum(w * w / p.inv_inertia[i])", "0.0")
edit("10.13", "inverse inertia for inertia", "w * w / p.inv_inertia[i]", "w * w * p.inv_inertia[i]")
edit("10.13", "everything turns", "p.inv_inertia[i, 0] > 0.0", "True")
edit("10.13", "the first body only", "range(x.shape[0])", "range(1)")


# 10.14 ----------------------------------------------------------------------------------------------------------
@right("10.14", "with whole tensors")
def momenta(x, q, v, omega, p):
    P, L = np.zeros(3), np.zeros(3)
    for i in np.flatnonzero(p.inv_mass > 0.0):
        R, one = rotation_matrix(q[i]), v[i] / p.inv_mass[i]
        P, L = P + one, L + np.cross(x[i], one)
        if p.inv_inertia[i].any():
            L = L + R @ np.diag(1.0 / p.inv_inertia[i]) @ R.T @ omega[i]
    return P, L


edit("10.14", "no orbit", "cross(x[i], v[i]) / p.inv_mass[i]", "0.0")
edit("10.14", "no spin", "body_angular_momentum(q[i], omega[i], 1.0 / p.inv_inertia[i])", "0.0")
edit("10.14", "everything turns", "p.inv_inertia[i, 0] > 0.0", "True")
edit("10.14", "velocities for momenta", "P += v[i] / p.inv_mass[i]", "P += v[i]")
edit("10.14", "cross product the other way", "cross(x[i], v[i])", "cross(v[i], x[i])")
edit("10.14", "spin by the inverse tensor", "1.0 / p.inv_inertia[i]", "p.inv_inertia[i]")


# 10.15 ----------------------------------------------------------------------------------------------------------
@right("10.15", "by all pairs of times")
def gain_without_source(energies, work):
    energies, work = worked.checked_histories(energies, work)
    rest = energies - work
    return max(rest[k] - rest[:k + 1].min() for k in range(len(rest)))


edit("10.15", "takes what it is given", "checked_histories(energies, work)", "energies, work")
edit("10.15", "takes what it is given for arrays", "checked_histories(energies, work)",
     "np.asarray(energies), np.asarray(work)")
edit("10.15", "work is a loss", "energies[k] - work[k]", "energies[k] + work[k]")
edit("10.15", "work is forgotten", "energies[k] - work[k]", "energies[k]")
edit("10.15", "since the beginning", "np.minimum(lowest, rest)", "energies[0] - work[0]")
edit("10.15", "since the last time", "np.minimum(lowest, rest)", "energies[k - 1] - work[k - 1] if k else rest")
edit("10.15", "in the end", "np.maximum(gain, rest - lowest)", "rest - lowest")


# 10.16 ----------------------------------------------------------------------------------------------------------
@right("10.16", "with lists")
def compare(full, minimal, runs, clock):
    rows = []
    for _ in range(runs):
        times, ends = [clock()], []
        for run in (full, minimal):
            ends.append(run())
            times.append(clock())
        rows.append((np.abs(ends[0] - ends[1]).max(), (times[1] - times[0]) / (times[2] - times[1])))
    off, ratios = np.array(rows).T
    return off.max(), np.median(ratios)


edit("10.16", "minimal over full", "(between - began) / (clock() - between)", "(clock() - between) / (between - began)")
edit("10.16", "the mean", "np.median(ratios)", "np.mean(ratios)")
edit("10.16", "another order", "slow = full()", "minimal(); slow = full()")
edit("10.16", "the best", "np.median(ratios)", "np.max(ratios)")
edit("10.16", "one side only", "np.max(np.abs(slow - quick))", "np.max(slow - quick)")
edit("10.16", "the mean difference", "np.max(np.abs(slow - quick))", "np.mean(np.abs(slow - quick))")
edit("10.16", "the last number only", "np.max(np.abs(slow - quick))", "np.abs(slow - quick).ravel()[-1]")
