"""Lesson 3: cones, sides, times of events, and what happens without load."""

from ..mutants import friction as answers
from . import collection

fault, wrong_answer, FAULTS = collection("friction")

wrong_answer(answers.HOLDS_WHAT_LIFTS)
fault("static_friction", "-limit / size * F_t", "-limit / size * F_t * 0.9", "friction at its limit is 10 % too small")
fault("static_friction", "-F_t if size <= limit", "-F_t if size <= 1.1 * limit", "it holds 10 % beyond the cone")
fault("kinetic_friction", "-limit / speed * v_t", "-limit / np.sqrt(v @ v) * v_t",
      "velocity away from the surface weakens friction")
fault("kinetic_friction", "-limit / speed * v_t", "-limit * v_t", "friction is proportional to the speed")
fault("incline_acceleration", "cone_radius(mu_k, np.cos(theta)))", "cone_radius(mu_s, np.cos(theta)))",
      "a sliding block has static friction")
fault("incline_acceleration", "g * (np.sin(theta) -", "0.99 * g * (np.sin(theta) -", "gravity is 1 % too weak")
fault("friction_impulse", "-np.minimum(limit, m * speed) / speed * v_t",
      "-np.minimum(limit, m * speed) * v_t / np.sqrt(1e-4 + speed * speed)",
      "friction fades at low speed: regularised")
wrong_answer(answers.NO_MASS)
fault("pyramid_impulse", "np.minimum(limit, m * (v_t @ t_2))", "np.minimum(limit, m * np.abs(v_t @ t_2))",
      "along the second axis friction points one way only")
fault("pyramid_impulse", "limit = cone_radius(mu, j_n)", "limit = cone_radius(mu, j_n) / np.sqrt(2.0)",
      "the pyramid is inside the cone in place of around it")
fault("sliding_step", "cone_radius(p.mu_s, a_n)", "cone_radius(p.mu_k, a_n)", "a block at rest has kinetic friction")
fault("sliding_step", "friction_impulse(v, 1.0, dt * a_n, p.mu_k)", "friction_impulse(v, 1.0, dt * a_n, p.mu_s)",
      "a sliding block has static friction")
fault("kinetic_friction_step", "middle = acceleration(t + 0.5 * dt,", "middle = acceleration(t,",
      "the force of the middle is taken at the time of the beginning")
fault("slip_direction", "return a_t / pull if pull >", "return -a_t / pull if pull >", "a block breaks away backwards")
fault("stopping_time", "return stopped", "return 0.5 * stopped", "the block stops after half of the time")
fault("breakaway_time", "t + dt, x, v, p", "t, x, v, p", "a block at rest never breaks away within a step")
fault("advance_to_event", "x, v if tau == dt else 0.0 * v", "x, v",
      "round-off of a velocity is left after a stop: it counts as motion")
fault("particle_bowl_gap", "tangential(x - p.centre, p.axis)", "x - p.centre",
      "a trough is a bowl: its axis does nothing")
fault("particle_contact_impulse", "-(1.0 + e) * m * v_n", "-m * v_n", "nothing bounces")
fault("particle_contact_impulse", "friction_impulse(tangential(v, n), m, j_n, mu)",
      "friction_impulse(tangential(v, n), m, j_n / (1.0 + e), mu)", "friction leaves out the rebound")
fault("contact_step", "x = x - phi * n", "x = x - 0.9 * phi * n", "a tenth of the depth is left")
fault("contact_step", "if phi < 0.0:", "if phi < 0.0 and v @ n < -0.05:", "slow contacts get no impulse")
fault("friction_position_correction", "1.0, depth, mu)", "1.0, 0.5 * depth, mu)",
      "the position slips at half of the cone")
fault("position_friction_step", "moved = dt * v",
      "moved = dt * tangential(v, p.gravity / np.sqrt(p.gravity @ p.gravity))",
      "the correction leaves out the vertical part of the motion")

# drawn up without a look at those above
fault("incline_acceleration", "np.sin(theta) <= cone", "np.sin(theta) < cone",
      "at exactly the limit a slope does not hold",
      missed="sin θ and μ cos θ are equal only to round-off, which decides")
fault("slip_direction", "pull > cone_radius", "pull >= cone_radius", "without load and pull a block slips to nowhere")
wrong_answer(answers.GRAVITY)
fault("kinetic_friction_step", "normal_force(middle, p.n)", "normal_force(early, p.n)",
      "the load is that of the beginning of the step")
fault("contact_step", "acceleration(t, x, v, p)", "acceleration(t + dt, x, v, p)",
      "the force is that of the end of the step")
fault("contact_step", "x = x - phi * n", "x = x - (1.0 + p.e) * phi * n", "the position bounces, too")
fault("position_friction_step", "if v @ n < 0.0:", "if True:", "friction also moves back what already leaves")
fault("slip_times", "slipping = slides and bool(np.any(v))", "slipping = slides",
      "a block that stops and slides back is said not to have stopped", of="given.friction")
fault("average_sliding_step", "(v + v_new)", "(v_new + v_new)", "the position advances with the new velocity",
      of="given.friction")
fault("pyramid_step", "p.mu_k, t_1", "p.mu_s, t_1", "a sliding block has static friction", of="given.friction")
fault("advance_particle", "t + n * dt", "t", "every step begins at the time of the first", of="given.friction")
fault("make_block", "Block(n / length", "Block(n", "the normal may have any length", of="given.friction")
