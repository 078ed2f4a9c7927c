"""Lesson 7: wrong arms, signs, bodies, cones and times."""

from ..mutants import impulses as answers
from . import collection

fault, wrong_answer, FAULTS = collection("impulses")

fault("kinematic_response", "(1.0 + e) * v_n", "(1.0 + 0.99 * e) * v_n", "restitution is 1 % too small")
fault("kinematic_response", "v if v_n >= 0.0 else", "v if v_n > 0.5 else", "a ball that leaves slowly is sent back")
fault("penalty_force", "np.maximum(0.0, -stiffness * phi - damping * v_n)", "-stiffness * phi - damping * v_n",
      "the spring pulls a ball that leaves")
fault("penalty_force", "damping * v_n", "damping * np.minimum(0.0, v_n)", "the damper works on the way in only")
wrong_answer(answers.ADDS_ROTATION_OF_B)
fault("impulse_size", "-(1.0 + e) * u_n / k_n", "-(1.0 + e * e) * u_n / k_n",
      "restitution of energies for that of velocities")
fault("effective_inverse_mass_2d", "lever_b**2 * b.inv_inertia", "lever_b**2 * a.inv_inertia",
      "the second body has the moment of the first")
fault("apply_impulse_2d", "cross_2d(r, J)", "cross_2d(J, r)", "an impulse turns a body the wrong way")
fault("effective_inverse_mass", "cross(times(b.inv_inertia, cross(r_b, n)), r_b)",
      "cross(times(b.inv_inertia, cross(r_b, n)), r_a)", "the second lever has the first arm")
fault("angular_momenta", "L_b - cross(r_b, J)", "L_b + cross(r_b, J)", "both bodies are turned the same way")
fault("contact_matrix", "cross(times(inv_inertia, cross(r, unit)), r)", "cross(times(inv_inertia, cross(unit, r)), r)",
      "turning makes a point heavier")
fault("cone_impulse", "if size <= mu * (J @ n):", "if size <= 1.1 * mu * (J @ n):",
      "it sticks up to 10 % beyond the cone")
fault("cone_impulse", "u_sep - u @ n) / (n @ times(K, d))", "u_sep - u @ n) / (n @ times(K, n) * np.cos(beta))",
      "friction does not change the normal velocity")
fault("cone_impulse", "np.sin(beta) / size * J_t", "-np.sin(beta) / size * J_t",
      "friction on the rim pushes along the slip")
fault("energy_change", "0.5 * (J @ times(K, J))", "(J @ times(K, J))", "the second half of the work counts twice")
fault("gap_multiplier", "phi / dt + u_n", "u_n", "a gap that is still open is closed at once")
fault("impact_time", "np.sqrt(squared)", "np.sqrt(v_n * v_n)", "acceleration does nothing before the impact")
fault("impact_time", "-(v_n + s) / a_n", "-2.0 * (v_n + s) / a_n", "what flies up comes back twice as late")
wrong_answer(answers.RESTITUTION_SQUARED)
fault("bouncing_time", "if v_n <= 0.0:", "if v_n <= 0.1:", "small bounces are left out")
fault("position_projection_step", "x = x - phi * p.n", "x = x - 2.0 * phi * p.n",
      "the ball is mirrored, not moved back")
fault("position_projection_step", "v = v + dt * acceleration(t, x, v, p)\n    x = x + dt * v",
      "x = x + dt * v\n    v = v + dt * acceleration(t, x, v, p)", "the ball moves with its old velocity")
fault("backtracking_step", "slide_on_plane(x, v, a, left, p.n)", "slide_on_plane(x, v, a, 0.0, p.n)",
      "a ball that has bounced to rest stops sliding for the rest of the step")
fault("slide_on_plane", "a - np.minimum(0.0, a @ n) * n", "tangential(a, n)", "the plane also pulls")
fault("free_flight", "0.5 * t * t * a", "0.49 * t * t * a", "the fall is 2 % too short")
fault("solve_impacts", "Js[i] = J\n        if", "Js[i] = np.maximum(J, 0.0)\n        if",
      "impulses along negative axes are forgotten between sweeps")
fault("kinematic_response", "v_n = v @ n", "v_n = v[v.size - 1] * n[n.size - 1]",
      "only the last coordinate counts: right above a level floor")
fault("impulse_size", "u_n >= 0.0 else", "u_n >= -0.01 else", "slow contacts get no impulse, as in engines")
fault("effective_inverse_mass_2d", "lever_b**2 * b.inv_inertia", "lever_b**2 * b.inv_inertia * (b.inv_mass > 0.0)",
      "a second body on an axle does not turn")
fault("apply_impulse_2d", "body.inv_inertia * cross_2d(r, J)",
      "body.inv_inertia * (body.inv_mass > 0.0) * cross_2d(r, J)", "no impulse turns a body on an axle")
fault("effective_inverse_mass", "a.inv_mass + b.inv_mass", "2.0 * a.inv_mass", "right for equal masses only")
fault("relative_velocity", "- point_velocity(b.v, b.omega, r_b)", "- point_velocity(b.v, b.omega, r_a)",
      "the second point has the first arm")
fault("apply_impulse", "times(body.inv_inertia, cross(r, J))", "times(body.inv_inertia * np.eye(3), cross(r, J))",
      "products of inertia are left out")
fault("cone_impulse", "if u @ n >= u_sep:", "if u @ n >= 0.0:", "points that part too slowly are left alone")
fault("cone_impulse", "size <= mu * (J @ n)", "size <= mu * np.abs(J @ n)", "a sticking impulse may pull")
fault("impact_time", "phi = np.maximum(0.0, phi)", "phi = np.abs(phi)", "what is inside is as far away outside")
fault("impact_time", "np.minimum(tau, dt)", "tau", "an impact may be later than the step")
fault("bouncing_time", "if a_n >= 0.0 or e == 1.0:", "if e == 1.0:",
      "a ball that is pulled away comes to rest on its plane")
fault("gap", "(x - p.point) @ p.n", "x @ p.n - p.point @ np.abs(p.n)",
      "right for normals without negative coordinates only")
wrong_answer(answers.ONLY_APPROACHING_BALLS)
fault("backtracking_step", "p.e) <= left", "p.e) <= dt",
      "bounces that last longer than what is left of the step are cut off")
fault("solve_impacts", "n[i], K, u_sep[i], mu", "n[i], K, u_sep[0], mu", "all points separate as fast as the first")
fault("solve_impacts", "residual = max(residual, np.abs(times(K, J - Js[i])).max())",
      "residual = np.abs(times(K, J - Js[i])).max()", "the sweeps end when the last point is at rest")
