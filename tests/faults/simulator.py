"""Lesson 10: wrong frames, moments of time, supports and invariants."""

from . import collection

fault, FAULTS = collection("simulator")

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
