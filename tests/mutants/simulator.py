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
edit("10.1", "uses the mass of the first body for all", "p.inv_mass[:, None]", "p.inv_mass[0]")
edit("10.1", "does not change the spin", "omega + dt * p.inv_inertia * tau", "omega")
edit("10.1", "reverses the torque", "omega + dt *", "omega - dt *")
edit("10.1", "moves immovable bodies", "p.inv_mass[:, None] * F", "np.maximum(p.inv_mass, 0.1)[:, None] * F")
edit("10.1", "evaluates the load at time 0", "load(t, x", "load(0.0, x")
edit("10.1", "forgets dt beside the force", "v + dt * p.inv_mass", "v + p.inv_mass")
edit("10.1", "forgets the mass", "dt * p.inv_mass[:, None] * F", "dt * F * (p.inv_mass[:, None] > 0.0)")
edit("10.1", "exchanges force and torque: uses the inverse mass for the torque",
     "p.inv_inertia * tau", "p.inv_mass * tau")
edit("10.1", "subtracts the force", "v + dt * p", "v - dt * p")
edit("10.1", "returns the changes only",
     "return v + dt * p.inv_mass[:, None] * F, omega + dt", "return dt * p.inv_mass[:, None] * F, dt")
edit("10.1", "forgets dt beside the torque", "omega + dt * p", "omega + p")


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


edit("10.2", "omits the gyroscopic term", "angular_acceleration(q[i], omega[i], tau[i], 1.0 / p.inv_inertia[i])",
     "angular_acceleration(q[i], 0.0 * omega[i], tau[i], 1.0 / p.inv_inertia[i])")
edit("10.2", "omits the torque", "omega[i], tau[i], 1.0", "omega[i], 0.0 * tau[i], 1.0")
edit("10.2", "uses the inverse inertia in place of the inertia", "1.0 / p.inv_inertia[i]", "p.inv_inertia[i]")
edit("10.2", "changes the spin of the first body only", "range(omega.shape[0])", "range(1)")
edit("10.2", "uses the orientation of the first body for all", "q[i]", "q[0]")
edit("10.2", "does not change the velocity", "v + dt * p.inv_mass[:, None] * F", "v")


edit("10.2", "rotates every body that has a mass", "p.inv_inertia[i, 0] > 0.0", "p.inv_mass[i] > 0.0")
edit("10.2", "forgets dt beside the angular acceleration", "omega[i] + dt * angular", "omega[i] + angular")
edit("10.2", "forgets the mass", "dt * p.inv_mass[:, None] * F", "dt * F * (p.inv_mass[:, None] > 0.0)")
edit("10.2", "subtracts the angular acceleration", "omega[i] + dt", "omega[i] - dt")
edit("10.2", "returns the angular acceleration in place of ω",
     "omega[i] = omega[i] + dt * angular", "omega[i] = dt * angular")
edit("10.2", "forgets dt beside the force", "v + dt * p", "v + p")
edit("10.2", "subtracts the force", "v + dt * p", "v - dt * p")


# 10.3 -----------------------------------------------------------------------------------------------------------
@right("10.3", "changes of positions apart")
def free_step_2d(load, t, x, q, v, omega, dt, p):
    faster, turning = worked.new_velocities_2d(load, t, x, q, v, omega, dt, p)
    return np.array([x[i] + dt * faster[i] for i in range(len(x))]), q + turning * dt, faster, turning


edit("10.3", "moves the positions with the old velocities",
     "v, omega = new_velocities_2d(load, t, x, q, v, omega, dt, p)",
     "old, (v, omega) = v, new_velocities_2d(load, t, x, q, v, omega, dt, p); x = x + dt * (old - v)")
edit("10.3", "does not change the angles", "q + dt * omega", "q")
edit("10.3", "moves by half a step", "x + dt * v", "x + 0.5 * dt * v")
edit("10.3", "returns the old velocities", "v, omega = new", "_, omega = new")
edit("10.3", "rotates the other way", "q + dt * omega", "q - dt * omega")
edit("10.3", "forgets dt beside ω", "q + dt * omega", "q + omega")
edit("10.3", "exchanges v and ω",
     "return x + dt * v, q + dt * omega, v, omega", "return x + dt * v, q + dt * omega, omega, v")
edit("10.3", "does not move the positions", "return x + dt * v,", "return x,")
edit("10.3", "moves backwards", "return x + dt", "return x - dt")


# 10.4 -----------------------------------------------------------------------------------------------------------
@right("10.4", "with the quaternions of all bodies at once")
def free_step(load, t, x, q, v, omega, dt, p):
    v, omega = worked.new_velocities(load, t, x, q, v, omega, dt, p)
    return x + dt * v, worked.turn_quaternions(q, omega, dt), v, omega


edit("10.4", "rotates the first body only", "range(q.shape[0])", "range(1)")
edit("10.4", "uses the spin of the first body for all", "omega[i], dt", "omega[0], dt")
edit("10.4", "rotates the other way", "quaternion_update(q[i], omega[i], dt)", "quaternion_update(q[i], -omega[i], dt)")
edit("10.4", "does not change the positions", "x + dt * v", "x")
edit("10.4", "returns quaternions that are not normalised",
     "quaternion_update(q[i], omega[i], dt)", "1.01 * quaternion_update(q[i], omega[i], dt)")
edit("10.4", "returns the old velocities", "v, omega = new", "_, omega = new")
edit("10.4", "moves with the old velocity",
     "v, omega = new_velocities(load, t, x, q, v, omega, dt, p)",
     "v_old = v; v, omega = new_velocities(load, t, x, q, v, omega, dt, p); x = x + dt * (v_old - v)")
edit("10.4", "does not rotate the bodies", "q[i] = quaternion_update(q[i], omega[i], dt)", "pass")
edit("10.4", "forgets dt beside v", "x + dt * v", "x + v")
edit("10.4", "rotates by half of the step", "omega[i], dt)", "omega[i], 0.5 * dt)")
edit("10.4", "moves backwards", "return x + dt", "return x - dt")
edit("10.4", "exchanges the velocities v and ω in what it returns",
     "return x + dt * v, q, v, omega", "return x + dt * v, q, omega, v")


# 10.5 -----------------------------------------------------------------------------------------------------------
@right("10.5", "tries all pairs")
def find_contacts(narrow, x, low, high, turn, p):
    first, partner = [0], []
    for i in range(len(p.half)):
        partner += [j for j in range(i + 1, len(x)) if p.inv_mass[i] + p.inv_mass[j] > 0.0]
        first.append(len(partner))
    pairs = Pairs(np.array(first, np.int64), np.array(partner, np.int64))
    return narrow(x, turn, p.half, p.planes, pairs, p.margin)


edit("10.5", "does not widen the boxes by the margin", "near_pairs(low - p.margin, high + p.margin, p.planes)",
     "near_pairs(low, high, p.planes)")
edit("10.5", "raises the lower corners by the margin in place of lowering them", "low - p.margin", "low + p.margin")
edit("10.5", "finds only what overlaps", "pairs, p.margin)", "pairs, 0.0)")
edit("10.5", "omits the planes", "high + p.margin, p.planes)", "high + p.margin, p.planes[:0])")
edit("10.5", "finds contacts between immovable bodies, too", "p.inv_mass)", "p.inv_mass + 1.0)")
edit("10.5", "uses twice the margin", "pairs, p.margin)", "pairs, 2.0 * p.margin)")
edit("10.5", "widens the boxes downwards only", "high + p.margin", "high")


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
    edit(number, "stops bodies that are not in contact yet", old_law, old_law.replace("aim, 0.0", "0.0 * aim, 0.0"))
    edit(number, "makes every contact soft", old_law, old_law.replace("0.0 * aim", "0.0 * aim + 1.0"))
    edit(number, "uses targets other than the closing speeds", "closing_speeds(contacts.gap, dt)",
         "-closing_speeds(contacts.gap, dt) + 0.1")
    edit(number, "moves the positions with the velocities before contact", "return PileState(x + dt * v",
         "return PileState(x + dt * (v if J.size == 0 else state.v)")
    edit(number, "returns zero impulses", "v, omega, contacts, J)", "v, omega, contacts, 0.0 * J)")
    edit(number, "evaluates the load at time 0", "(load, t, x", "(load, 0.0, x")
    edit(number, "keeps impulses from any distance", "kept_impulses(contacts, old, J, p.margin)",
         "kept_impulses(contacts, old, J, np.inf)")
    edit(number, "keeps impulses within 1 mm only", "kept_impulses(contacts, old, J, p.margin)",
         "kept_impulses(contacts, old, J, 1e-3)")
    edit(number, "moves the positions with the old velocities", "PileState(x + dt * v", "PileState(x + dt * state.v")
edit("10.6", "does not apply the impulses that it keeps",
     "apply_impulses_2d(v, omega, J, contacts, arms, p.inv_mass, p.inv_inertia)",
     "pass")
edit("10.6", "starts from zero impulses in every step",
     "kept_impulses(contacts, old, J, p.margin)", "np.zeros(contacts.p.shape)")
edit("10.6", "makes one sweep only", "range(p.sweeps)", "range(1)")
edit("10.6", "does not change the angles", "q + dt * omega", "q")
edit("10.6", "omits the forces", "v, omega = new_velocities_2d(load, t, x, q, v, omega, dt, p)",
     "v, omega = v.copy(), omega.copy()")
edit("10.6", "reverses the closing speeds", "closing_speeds(contacts.gap, dt)", "-closing_speeds(contacts.gap, dt)")
edit("10.6", "uses the gap in place of the closing speed", "closing_speeds(contacts.gap, dt)", "contacts.gap")
edit("10.6", "does not move the bodies", "PileState(x + dt * v,", "PileState(x,")
edit("10.6", "looks for contacts of bodies that are not turned", "bounds(x, q, p.half)", "bounds(x, 0.0 * q, p.half)")
edit("10.6", "returns the old contacts", "dt * omega, v, omega, contacts, J)", "dt * omega, v, omega, old, J)")


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


edit("10.7", "does not apply the impulses that it keeps",
     "apply_impulses(v, omega, J, contacts, arms, p.inv_mass, inv_inertia)",
     "pass")
edit("10.7", "starts from zero impulses in every step",
     "kept_impulses(contacts, old, J, p.margin)", "np.zeros(contacts.p.shape)")
edit("10.7", "does not change the orientations", "turn_quaternions(q, omega, dt)", "q")
edit("10.7", "uses the inertia in body axes in place of world axes", "world_inertia(turn, p.inv_inertia)",
     "world_inertia(np.stack([np.eye(3)] * len(turn)), p.inv_inertia)")
edit("10.7", "omits the friction", "p.mu)", "0.0)")
edit("10.7", "makes one sweep only", "range(p.sweeps)", "range(1)")
edit("10.7", "omits the forces", "v, omega = new_velocities(load, t, x, q, v, omega, dt, p)",
     "v, omega = v.copy(), omega.copy()")
edit("10.7", "reverses the closing speeds", "closing_speeds(contacts.gap, dt)", "-closing_speeds(contacts.gap, dt)")
edit("10.7", "uses the gap in place of the closing speed", "closing_speeds(contacts.gap, dt)", "contacts.gap")
edit("10.7", "does not move the bodies", "PileState(x + dt * v,", "PileState(x,")
edit("10.7", "returns the old contacts", "dt), v, omega, contacts, J)", "dt), v, omega, old, J)")


# 10.8 -----------------------------------------------------------------------------------------------------------
@right("10.8", "coordinate by coordinate")
def support_velocity(place, ball):
    r, w = place - ball.centre, ball.floor_omega
    return ball.floor_v + np.array([w[1] * r[2] - w[2] * r[1], w[2] * r[0] - w[0] * r[2], w[0] * r[1] - w[1] * r[0]])


edit("10.8", "rotates about the origin", "place - ball.centre", "place")
edit("10.8", "reverses the rotation", "ball.floor_omega, place", "-ball.floor_omega, place")
edit("10.8", "rotates in place", "point_velocity(ball.floor_v", "point_velocity(0.0 * ball.floor_v")
edit("10.8", "omits the rotation", "ball.floor_omega, place", "0.0 * ball.floor_omega, place")
edit("10.8", "adds the centre", "place - ball.centre", "place + ball.centre")
edit("10.8", "exchanges velocity and rotation", "ball.floor_v, ball.floor_omega", "ball.floor_omega, ball.floor_v")


# 10.9 -----------------------------------------------------------------------------------------------------------
@right("10.9", "by the change of the velocity")
def carried_step(load, t, x, q, v, omega, dt, ball):
    pushed, turned = worked.stop_slip(v, omega, worked.support_velocity(x + dt * v, ball), dt, ball)
    _, _, v_new, omega_new = worked.rigid_body_step(load, t, x, q, pushed, turned, dt, ball)
    spin = worked.exponential(dt * (omega + 0.5 * (omega_new - omega)))
    return x + dt * (v + 0.5 * (v_new - v)), worked.quaternion_product(spin, q), v_new, omega_new


edit("10.9", "takes the velocity of the floor at the old position",
     "support_velocity(x + dt * v, ball)", "support_velocity(x, ball)")
edit("10.9", "evaluates the load at time 0", "rigid_body_step(load, t, x", "rigid_body_step(load, 0.0, x")
edit("10.9", "takes the velocity of the floor half a step ahead", "support_velocity(x + dt * v, ball)",
     "support_velocity(x + 0.5 * dt * v, ball)")
edit("10.9", "takes the floor to be at rest", "support_velocity(x + dt * v, ball)", "0.0 * x")
edit("10.9", "moves the position with the new velocity", "0.5 * dt * (v + v_new)", "dt * v_new")
edit("10.9", "rotates with the new spin", "0.5 * dt * (omega + omega_new)", "dt * omega_new")
edit("10.9", "does not rotate", "quaternion_product(exponential(0.5 * dt * (omega + omega_new)), q)", "q")
edit("10.9", "returns the old spin", "q, v_new, omega_new", "q, v_new, omega")
edit("10.9", "moves with the old velocity", "0.5 * dt * (v + v_new)", "dt * v")
edit("10.9", "adds the velocities without halving", "x + 0.5 * dt", "x + dt")
edit("10.9", "rotates with the old spin", "(omega + omega_new)), q)", "(omega + omega)), q)")
edit("10.9", "returns the old velocity", "q, v_new, omega_new", "q, v, omega_new")
edit("10.9", "omits the friction of the floor", "t, x, q, pushed, turned, dt", "t, x, q, v, omega, dt")
edit("10.9", "starts the step with the old velocity", "q, pushed, turned", "q, v, turned")
edit("10.9", "starts the step with the old spin", "q, pushed, turned", "q, pushed, omega")
edit("10.9", "adds the rotations without halving", "exponential(0.5 * dt", "exponential(dt")
edit("10.9", "multiplies the rotation from the right, as if it were in body coordinates",
     "quaternion_product(exponential(0.5 * dt * (omega + omega_new)), q)",
     "quaternion_product(q, exponential(0.5 * dt * (omega + omega_new)))")


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


edit("10.10", "omits the effect of friction on the spin",
     "(1.0 + ball.m * ball.radius * ball.radius / ball.I_body[0])", "1.0")
edit("10.10", "omits the spin", "point_velocity(v, omega,", "point_velocity(v, 0.0 * omega,")
edit("10.10", "uses the velocity of the highest point", "-ball.radius]", "ball.radius]")
edit("10.10", "adds gravity along the slope in place of subtracting it", "- along", "+ along")
edit("10.10", "omits gravity along the slope", "- along", "")
edit("10.10", "keeps the vertical part of the slip", "slip[2] = 0.0", "pass")
edit("10.10", "returns a finite time where the slip never ends", "size / rate if rate > 0.0 else np.inf", "size / rate")
edit("10.10", "omits the friction coefficient", "-ball.mu * ball.gravity[2]", "-ball.gravity[2]")
edit("10.10", "reverses the effect of friction on the spin", "(1.0 + ball.m", "(1.0 - ball.m")
edit("10.10", "forgets the square of the radius", "ball.radius * ball.radius /", "ball.radius /")
edit("10.10", "returns the rate, not the time", "return size / rate", "return rate")
edit("10.10", "returns the reciprocal", "return size / rate", "return rate / size")
edit("10.10", "forgets gravity in the friction", "-ball.mu * ball.gravity[2] *", "ball.mu *")
edit("10.10", "returns infinity where the ball does not slip", "return 0.0", "return np.inf")
edit("10.10", "does not divide by the moment of inertia", "/ ball.I_body[0])", ")")
edit("10.10", "counts the effect of friction on the spin only", "(1.0 + ball.m * ball.radius", "(ball.m * ball.radius")
edit("10.10", "returns zero where it slips forever", "else np.inf", "else 0.0")


# 10.11 ----------------------------------------------------------------------------------------------------------
@right("10.11", "as a loop over both parts")
def exact_rolling_step(load, t, x, q, v, omega, dt, ball):
    state, first = (x, q, v, omega), min(dt, worked.slip_time(v, omega, ball))
    for begins, part in ((t, first), (t + first, dt - first)):
        state = worked.average_rolling_step(load, begins, *state, part, ball)
    return state


edit("10.11", "treats the whole step as slipping", "np.minimum(dt, slip_time(v, omega, ball))", "dt")
edit("10.11", "makes the second part as long as the step", "omega, dt - first, ball)", "omega, dt, ball)")
edit("10.11", "lets the first part be longer than the step",
     "np.minimum(dt, slip_time(v, omega, ball))", "slip_time(v, omega, ball)")
edit("10.11", "evaluates the first part at time 0",
     "average_rolling_step(load, t, x", "average_rolling_step(load, 0.0, x")
edit("10.11", "starts the second part at the length of the first, not at t plus it", "load, t + first", "load, first")
edit("10.11", "starts the second part at time t", "load, t + first", "load, t")
edit("10.11", "ends the first part after half of the slip time", "np.minimum(dt, slip_time(v, omega, ball))",
     "np.minimum(dt, 0.5 * slip_time(v, omega, ball))")
edit("10.11", "starts the second part at the old position", "x, q, v, omega = average", "_, q, v, omega = average")
edit("10.11", "takes the longer of the two times", "np.minimum(dt, slip", "np.maximum(dt, slip")
edit("10.11", "advances the first part only",
     "return average_rolling_step(load, t + first, x, q, v, omega, dt - first, ball)", "return x, q, v, omega")
edit("10.11", "goes back in the second part", "dt - first", "first - dt")
edit("10.11", "advances each part by half of the step",
     "first = np.minimum(dt, slip_time(v, omega, ball))", "first = 0.5 * dt")


# 10.12 ----------------------------------------------------------------------------------------------------------
@right("10.12", "by the impulse at the corner")
def corner_impact(v, omega, r, inv_mass, inv_inertia):
    lever = np.array([-r[1], r[0]])
    K = inv_mass * np.eye(2) + inv_inertia * np.outer(lever, lever)
    J = -np.linalg.solve(K, v + omega * lever)
    return v + inv_mass * J, omega + inv_inertia * (lever @ J)


edit("10.12", "omits the orbital angular momentum",
     "omega / inv_inertia - cross_2d(r, v) / inv_mass", "omega / inv_inertia")
edit("10.12", "reverses the orbital angular momentum", "- cross_2d(r, v)", "+ cross_2d(r, v)")
edit("10.12", "uses the inertia about the centre, not about the corner",
     "(1.0 / inv_inertia + (r[0] * r[0] + r[1] * r[1]) / inv_mass)",
     "(1.0 / inv_inertia)")
edit("10.12", "keeps the spin unchanged",
     "omega = L / (1.0 / inv_inertia + (r[0] * r[0] + r[1] * r[1]) / inv_mass)", "pass")
edit("10.12", "sets the velocity of the centre to zero", "omega * np.array([r[1], -r[0]])", "0.0 * v")
edit("10.12", "rotates away from the corner", "np.array([r[1], -r[0]])", "np.array([-r[1], r[0]])")
edit("10.12", "keeps the velocity of the centre", "return omega * np.array([r[1], -r[0]]), omega", "return v, omega")
edit("10.12", "uses the mass in place of its inverse beside r × v",
     "cross_2d(r, v) / inv_mass", "cross_2d(r, v) * inv_mass")
edit("10.12", "uses the inertia's inverse in place of the inertia", "omega / inv_inertia", "omega * inv_inertia")
edit("10.12", "forgets the mass in the inertia about the corner",
     "(r[0] * r[0] + r[1] * r[1]) / inv_mass", "(r[0] * r[0] + r[1] * r[1])")
edit("10.12", "returns the angular momentum in place of ω", "omega = L / (", "omega = L; _ = 1.0 / (")
edit("10.12", "forgets the square of the distance",
     "(r[0] * r[0] + r[1] * r[1]) / inv_mass", "np.sqrt(r[0] * r[0] + r[1] * r[1]) / inv_mass")
edit("10.12", "stops the body", "return omega * np.array([r[1], -r[0]]), omega", "return 0.0 * v, 0.0 * omega")
edit("10.12", "uses r · v in place of r × v", "cross_2d(r, v)", "(r @ v)")


# 10.13 ----------------------------------------------------------------------------------------------------------
@right("10.13", "each kind for all bodies")
def mechanical_energy(x, q, v, omega, p):
    moves = np.flatnonzero(p.inv_mass > 0.0)
    m = 1.0 / p.inv_mass[moves]
    spin = sum(0.5 * np.sum((rotation_matrix(q[i]).T @ omega[i]) ** 2 / p.inv_inertia[i])
               for i in moves if p.inv_inertia[i, 0] > 0.0)
    return np.sum(0.5 * m * np.sum(v[moves] ** 2, axis=1)) - m @ (x[moves] @ p.gravity) + spin


edit("10.13", "reverses the sign of the potential energy", "- dot(p.gravity, x[i])", "+ dot(p.gravity, x[i])")
edit("10.13", "omits the factor ½ of the translation", "0.5 * dot(v[i], v[i])", "dot(v[i], v[i])")
edit("10.13", "uses ω in world axes with the moments of the body", "unrotate(q[i], omega[i])", "omega[i]")
edit("10.13", "omits the rotation", "0.5 * np.sum(w * w / p.inv_inertia[i])", "0.0")
edit("10.13", "multiplies by the inverse inertia in place of the inertia",
     "w * w / p.inv_inertia[i]", "w * w * p.inv_inertia[i]")
edit("10.13", "divides by an inverse inertia of zero", "p.inv_inertia[i, 0] > 0.0", "True")
edit("10.13", "counts the first body only", "range(x.shape[0])", "range(1)")
edit("10.13", "omits the potential energy", "- dot(p.gravity, x[i])", "")
edit("10.13", "multiplies by the inverse mass", "x[i])) / p.inv_mass[i]", "x[i])) * p.inv_mass[i]")
edit("10.13", "forgets the squares of ω", "w * w / p", "w / p")
edit("10.13", "counts the rotation of rows with inv_mass 0, too", "if p.inv_mass[i] > 0.0:",
     "if p.inv_mass[i] + p.inv_inertia[i, 0] > 0.0:")
edit("10.13", "omits the factor ½ of the rotation", "0.5 * np.sum", "np.sum")
edit("10.13", "rotates ω from body to world in place of world to body",
     "w = unrotate(q[i], omega[i])", "w = unrotate(q[i] * np.array([1.0, -1.0, -1.0, -1.0]), omega[i])")
edit("10.13", "forgets the mass", "x[i])) / p.inv_mass[i]", "x[i]))")


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


edit("10.14", "omits the orbital angular momentum", "cross(x[i], v[i]) / p.inv_mass[i]", "0.0")
edit("10.14", "omits the spin", "body_angular_momentum(q[i], omega[i], 1.0 / p.inv_inertia[i])", "0.0")
edit("10.14", "divides by an inverse inertia of zero", "p.inv_inertia[i, 0] > 0.0", "True")
edit("10.14", "adds velocities in place of momenta", "P += v[i] / p.inv_mass[i]", "P += v[i]")
edit("10.14", "takes v × x in place of x × v", "cross(x[i], v[i])", "cross(v[i], x[i])")
edit("10.14", "uses the inverse inertia in place of the inertia", "1.0 / p.inv_inertia[i]", "p.inv_inertia[i]")
edit("10.14", "returns L first", "return P, L", "return L, P")
edit("10.14", "multiplies by the inverse mass", "v[i] / p.inv_mass[i]", "v[i] * p.inv_mass[i]")
edit("10.14", "forgets the mass in the orbital part", "cross(x[i], v[i]) / p.inv_mass[i]", "cross(x[i], v[i])")
edit("10.14", "keeps the last body only", "P += v", "P = v")
edit("10.14", "counts rows with inv_mass 0 that can turn, too", "if p.inv_mass[i] > 0.0:",
     "if p.inv_mass[i] + p.inv_inertia[i, 0] > 0.0:")


# 10.15 ----------------------------------------------------------------------------------------------------------
@right("10.15", "by all pairs of times")
def gain_without_source(energies, work):
    energies, work = worked.checked_histories(energies, work)
    rest = energies - work
    return max(rest[k] - rest[:k + 1].min() for k in range(len(rest)))


edit("10.15", "does not check its input", "checked_histories(energies, work)", "energies, work")
edit("10.15", "converts its input to arrays without checking it", "checked_histories(energies, work)",
     "np.asarray(energies), np.asarray(work)")
edit("10.15", "adds the work in place of subtracting it", "energies[k] - work[k]", "energies[k] + work[k]")
edit("10.15", "omits the work", "energies[k] - work[k]", "energies[k]")
edit("10.15", "measures the gain since the beginning, not since the lowest point",
     "np.minimum(lowest, rest)", "energies[0] - work[0]")
edit("10.15", "measures the gain since the last time",
     "np.minimum(lowest, rest)", "energies[k - 1] - work[k - 1] if k else rest")
edit("10.15", "returns the gain at the end, not the largest one", "np.maximum(gain, rest - lowest)", "rest - lowest")
edit("10.15", "returns the largest loss", "np.maximum(gain, rest - lowest)", "np.maximum(gain, lowest - rest)")
edit("10.15", "measures the gain since the highest point",
     "np.minimum(lowest, rest)", "np.maximum(lowest if k else -np.inf, rest)")
edit("10.15", "returns the largest minus the smallest, whatever their order",
     "return gain", "return np.max(energies - work) - np.min(energies - work)")


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


edit("10.16", "divides the minimal time by the full time",
     "(between - began) / (clock() - between)", "(clock() - between) / (between - began)")
edit("10.16", "uses the mean of the ratios in place of the median", "np.median(ratios)", "np.mean(ratios)")
edit("10.16", "calls the functions in another order", "slow = full()", "minimal(); slow = full()")
edit("10.16", "uses the largest ratio", "np.median(ratios)", "np.max(ratios)")
edit("10.16", "omits negative differences", "np.max(np.abs(slow - quick))", "np.max(slow - quick)")
edit("10.16", "returns the mean difference, not the largest one",
     "np.max(np.abs(slow - quick))", "np.mean(np.abs(slow - quick))")
edit("10.16", "compares the last number only", "np.max(np.abs(slow - quick))", "np.abs(slow - quick).ravel()[-1]")
edit("10.16", "adds up the differences of all runs",
     "np.maximum(difference, np.max(np.abs(slow - quick)))", "difference + np.max(np.abs(slow - quick))")
edit("10.16", "returns the ratios, not their median", "np.median(ratios)", "ratios")
edit("10.16", "adds up the ratios", "np.median(ratios)", "np.sum(ratios)")
edit("10.16", "takes the smallest of the ratios", "np.median(ratios)", "np.min(ratios)")
edit("10.16", "returns the difference of the last run",
     "np.maximum(difference, np.max(np.abs(slow - quick)))", "np.max(np.abs(slow - quick))")
