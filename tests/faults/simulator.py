"""Lesson 10: wrong frames, moments of time, supports and invariants."""

from . import collection

fault, _, FAULTS = collection("simulator")

fault("new_velocities_2d", "p.inv_inertia * tau", "p.inv_mass * tau",
      "torque over mass in place of the moment of inertia")
fault("new_velocities", "1.0 / p.inv_inertia[i])", "1.0 / p.inv_inertia[0])",
      "all bodies have the moments of the first")
fault("new_velocities", "angular_acceleration(q[i], omega[i], tau[i]",
      "angular_acceleration(q[i], 0.0 * omega[i], tau[i]", "the gyroscopic term is missing")
fault("free_step_2d", "q + dt * omega", "q + dt * 0.99 * omega", "bodies turn 1 % too little")
fault("free_step_2d", "x + dt * v, q", "x + dt * v - 0.5 * dt * dt * p.gravity, q",
      "it falls with the mean velocity: a step that errs less")
fault("free_step", "quaternion_update(q[i], omega[i], dt)", "quaternion_update(q[i], omega[0], dt)",
      "all bodies turn as the first does")
fault("find_contacts", "near_pairs(low - p.margin, high + p.margin, p.planes)", "near_pairs(low, high, p.planes)",
      "the broad phase has no margin: contacts are found when they have closed")
fault("contact_step_2d", "J = kept_impulses(contacts, old, J, p.margin)",
      "J = 0.0 * kept_impulses(contacts, old, J, p.margin)", "the warm start is lost")
fault("contact_step_2d", "q + dt * omega, v, omega, contacts", "q + dt * 0.98 * omega, v, omega, contacts",
      "bodies turn 2 % too little")
fault("contact_step", "new_velocities(load, t, x, q, v, omega, dt, p)",
      "new_velocities(load, t, x, q, v, omega, 0.99 * dt, p)", "loads act for 1 % less than the step")
fault("contact_step", "apply_impulses(v, omega, J, contacts, arms, p.inv_mass, inv_inertia)", "pass",
      "impulses that are kept are counted, but not applied")
fault("support_velocity", "place - ball.centre", "place", "the floor turns about the origin of the world")
fault("support_velocity", "ball.floor_v,", "0.0 * ball.floor_v,", "the floor turns but does not travel")
fault("carried_step", "support_velocity(x + dt * v, ball)", "support_velocity(x, ball)",
      "the floor is that of the beginning of the step")
fault("slip_time", "ball.m * ball.radius * ball.radius / ball.I_body[0]", "ball.m * ball.radius / ball.I_body[0]",
      "right for a radius of 1 m only")
fault("slip_time", "/ ball.I_body[0]) - along", "/ ball.I_body[0])", "the slope of the floor does not change the slip")
fault("exact_rolling_step", "t + first, x, q, v, omega, dt - first, ball", "t + first, x, q, v, omega, dt, ball",
      "after the slip has ended it rolls for a whole step")
fault("corner_impact", "- cross_2d(r, v) / inv_mass", "+ cross_2d(r, v) / inv_mass",
      "one part of the angular momentum has the other sign")
fault("corner_impact", "np.array([r[1], -r[0]])", "np.array([-r[1], r[0]])",
      "the centre moves away from the arc about the corner")
fault("rocking_step", "0.0 * x, np.array([-rate]), dt - late", "0.0 * x, np.array([-rate]), dt",
      "after the impact a whole step follows")
fault("mechanical_energy", "w * w / p.inv_inertia[i]", "omega[i] * omega[i] / p.inv_inertia[i]",
      "energy takes world components for body components")
fault("momenta", "cross(x[i], v[i])", "cross(v[i], x[i])", "the orbital part has the other sign")
fault("momenta", "body_angular_momentum(q[i], omega[i],", "body_angular_momentum(q[0], omega[i],",
      "all tensors are turned as the first body is")
fault("gain_without_source", "energies[k] - work[k]", "energies[k] + work[k]", "work that is put in counts as a gain")
fault("gain_without_source", "lowest = np.minimum(lowest, rest)", "lowest = rest if k == 0 else lowest",
      "gains count from the start only")
fault("compare", "np.max(np.abs(slow - quick))", "np.max(slow - quick)", "a loop that is ahead has no difference")
fault("advance_free", "t + n * dt, x, q", "t, x, q", "all loads are those of the start")
fault("new_velocities_2d", "load(t, x", "load(t + dt, x", "the load is that of the end of the step")
fault("new_velocities", "p.inv_inertia[i, 0] > 0.0", "p.inv_mass[i] > 0.0 and p.inv_inertia[i, 0] > 0.0",
      "no torque turns a body on an axle")
fault("new_velocities", "tau[i]", "tau[i] * (i == 0)", "only the first body has a torque")
fault("find_contacts", "p.planes, pairs, p.margin)", "p.planes, pairs, 0.0)",
      "contacts are found when they have closed")
fault("find_contacts", "high + p.margin", "high", "ceilings are found late")
fault("contact_step_2d", "bounds(x, q, p.half)", "bounds(x, 0.0 * q, p.half)", "detection takes all boxes as upright")
fault("contact_step_2d", "closing_speeds(contacts.gap, dt)", "closing_speeds(0.0 * contacts.gap, dt)",
      "bodies stop before they touch")
fault("contact_step", "closing_speeds(contacts.gap, dt)", "closing_speeds(0.0 * contacts.gap, dt)",
      "in space bodies stop before they touch")
fault("contact_step", "world_inertia(turn, p.inv_inertia)", "world_inertia(0.0 * turn + np.eye(3), p.inv_inertia)",
      "the tensor of a body does not turn with it")
fault("contact_step", "J = kept_impulses(contacts, old, J, p.margin)",
      "J = 0.0 * kept_impulses(contacts, old, J, p.margin)", "in space the warm start is lost")
fault("contact_step", "turn_quaternions(q, omega, dt)", "turn_quaternions(q, state.omega, dt)",
      "bodies turn with their old ω")
fault("carried_step", "0.5 * dt * (omega + omega_new)", "dt * omega_new",
      "the ball turns with its new ω, and moves with the mean velocity")
fault("slip_time", "slip[2] = 0.0", "slip[2] = slip[2]", "a vertical velocity counts as slip")
fault("slip_time", "size / rate if rate > 0.0 else np.inf", "size / np.abs(rate)", "a slip that grows ends, too")
fault("exact_rolling_step", "t + first", "t", "both parts have the load of the start")
fault("corner_impact", "r[0] * r[0] + r[1] * r[1]", "r[1] * r[1]",
      "only the height of the centre counts for the moment about the corner")
fault("rocking_step", "-side * x_new, -side * v_new", "-x_new, -v_new", "right for one of both corners only")
fault("mechanical_energy", "if p.inv_mass[i] > 0.0:", "if p.inv_mass[i] > 0.0 or p.inv_inertia[i, 0] > 0.0:",
      "what is on an axle has an infinite energy")
fault("momenta", "1.0 / p.inv_inertia[i])", "1.0 / p.inv_inertia[0])", "all bodies have the moments of the first")
fault("gain_without_source", "np.maximum(gain, rest - lowest)", "rest - lowest", "only the gain at the end counts")
fault("compare", "np.median(ratios)", "np.mean(ratios)", "one slow run spoils the ratio")
fault("compare", "np.maximum(difference, np.max(np.abs(slow - quick)))", "np.max(np.abs(slow - quick))",
      "only the difference of the last run counts")
fault("advance_contact", "t + n * dt, state, dt, p)", "t, state, dt, p)", "all loads are those of the start")
fault("weight", "p.gravity / p.inv_mass[i]", "p.gravity / p.inv_mass[0]", "all bodies weigh as much as the first")
fault("settled_contact_step_2d", "<= SETTLED * np.max(np.abs(J))", "<= 10.0 * SETTLED * np.max(np.abs(J))",
      "the sweeps end ten times too early", of="given.simulator")
fault("settled_contact_step_2d", "velocity_sweep_2d(v, omega, found,", "velocity_sweep_2d(v, omega, 0.0 * found,",
      "each further sweep forgets the impulses before it", of="given.simulator")
fault("settled_contact_step_2d", "state.x + dt * v,", "state.x + dt * state.v,", "places go with the last velocities",
      of="given.simulator")
fault("settled_contact_step_2d", "closing_speeds(contacts.gap, dt)", "closing_speeds(0.0 * contacts.gap, dt)",
      "further sweeps stop bodies before they touch", of="given.simulator")
fault("mean_contact_step_2d", "0.5 * dt * (v + v_new)", "dt * v_new", "positions with the new velocities alone",
      of="given.simulator")
fault("rods_acceleration", "(n - i - 0.75) + p.I", "(n - i - 0.75)", "rods have no moment of inertia of their own",
      of="given.simulator")
fault("rods_acceleration", "s[i] * c[j] - c[i] * s[j]", "s[i] * c[j] + c[i] * s[j]",
      "the pull of rods that turn has the sine of the sum of the angles", of="given.simulator")
fault("rods_acceleration", "(n - i - 0.5) * c[i]", "(n - i) * c[i]", "a rod's own weight acts at its end",
      of="given.simulator")
fault("swinging_step", "omega[k + 1] -= b * twice", "omega[k + 1] += b * twice", "both balls are struck the same way",
      of="given.simulator")
fault("swing_acceleration", "p.g * p.L / p.inertia", "p.g / p.L", "the balls have no moment of inertia of their own",
      of="given.simulator")
fault("cradle_gap", "length - 2.0 * p.R", "length - 1.8 * p.R", "balls meet a tenth too close", of="given.simulator")
fault("contact_trajectory", "states[-1], dt, 1, p", "state, dt, 1, p", "every step of a history begins at the start",
      of="given.simulator")
fault("normal_and_friction", "N[k] += n[k, i] * state.J[k, i] / dt", "N[k] += n[k, i] * n[k, i] * state.J[k, 1] / dt",
      "the vertical part of the impulse counts as normal, however the contact is inclined", of="given.forces")
fault("normal_forces", "forces[k] += N[c]", "forces[k] = N[c]", "of two contacts only the last one counts",
      of="given.forces")
fault("may_pass", "8.0 * farthest > smallest * smallest", "0.1 * farthest > smallest * smallest",
      "only what moves by three half sizes is tested", of="given.passing")
fault("have_passed", "turned_round < 0.0", "turned_round < -2.0", "a body on the wrong side counts as one that came",
      of="given.passing")
