"""Lesson 9: wrong arms, laws of complementarity, cones, springs and memory."""

from . import collection

fault, FAULTS = collection("contact")

fault("contact_rows", "(contacts.b[k], -1.0)", "(contacts.b[k], 1.0)", "both bodies are pushed the same way")
fault("contact_rows", "r_x * d_y - r_y * d_x", "r_x * d_y + r_y * d_x", "the lever of a contact has the wrong sign")
fault("contact_rows", "(2 * k + 1, -n_y, n_x)", "(2 * k + 1, n_y, -n_x)", "tangents point the other way")
fault("delassus_matrix", "(G * w)", "(G * np.sqrt(w))", "each body counts with the root of its inverse mass")
fault("complementarity_residual", "np.minimum(np.diag(A) * lam, A @ lam + b)", "np.minimum(0.0, A @ lam + b)",
      "a contact that separates may push")
fault("gauss_seidel_sweep", "- omega * (A[k] @ lam + b[k]) / A[k, k]", "- (A[k] @ lam + b[k]) / A[k, k]",
      "relaxation does nothing")
fault("gauss_seidel_sweep", "np.maximum(0.0, lam[k] - omega", "np.maximum(-0.1 * np.abs(b[k]), lam[k] - omega",
      "contacts pull a little")
fault("stack_contraction", "0.5 * np.pi / n", "0.5 * np.pi / (n + 1.0)", "the stack has one body more")
fault("mass_ratio_contraction", "r / (1.0 + r)", "1.0 / (1.0 + r)", "a light body on a heavy one")
fault("best_relaxation", "omega - 1.0", "(omega - 1.0) ** 2", "it converges twice as fast as it does")
fault("solve_lcp", "pushes[wrong] = not pushes[wrong]", "pushes[wrong] = True", "a contact that pulls is never let go")
fault("cone_residual", "limit = mu[n // 2] * J[n] if", "limit = 1.1 * mu[n // 2] * J[n] if",
      "the cone is 10 % too wide")
fault("cone_residual", "A[n, n] * np.abs(J_n - J[n])", "A[n, n] * np.maximum(0.0, J_n - J[n])",
      "a contact that pushes too much is no error")
fault("cone_sweep", "limit = mu[n // 2] * J[n] if", "limit = mu[0] * J[n] if",
      "all contacts have the friction of the first")
fault("cone_sweep", "np.minimum(np.maximum(J[t] - (A[t] @ J + b[t]) / A[t, t], -limit), limit)",
      "np.minimum(np.maximum(J[t] - (A[t] @ J + b[t]) / A[t, t], 0.0), limit)", "friction acts one way only")
fault("contact_forces", "np.ascontiguousarray(G.T) @ F", "0.5 * np.ascontiguousarray(G.T) @ F",
      "accelerations take half of the contact forces")
fault("soft_contact", "1.0 / (s * (2.0 * zeta + s))", "1.0 / (s * (zeta + s))",
      "the contact gives as with half of the damping")
fault("soft_contact", "-s * gap / (dt", "-gap / (dt", "the spring is stiffer than its frequency says")
fault("soft_contact", "return -gap / dt, 0.0", "return 0.0, 0.0", "a body is stopped before it touches")
fault("friction_disc", "scaled(limit / size, J) if", "scaled(0.9 * limit / size, J) if", "friction is 10 % too small")
fault("kept_impulses", "if old.b[s] == contacts.b[k]:", "if True:",
      "an impulse is taken from a contact with another body")
fault("kept_impulses", "if squared < nearest:", "if squared > nearest:", "only impulses from far away are kept")
fault("has_left_margin", "high[i, c] <= wide_high[i, c]", "high[i, c] <= wide_high[i, c] + 1.0",
      "who leaves upwards is not missed for a metre")
fault("velocity_sweep_2d", "pile.mu * J_n if", "pile.mu * 0.9 * J_n if", "friction is 10 % too small")
fault("velocity_sweep_2d", "- v[b, 1] - omega[b] * b_x", "- v[b, 1] + omega[b] * b_x",
      "the second body turns the other way")
fault("velocity_sweep_2d", "- give[k] * k_n * J_n)", ")", "the contact does not give under its load")
fault("velocity_sweep", "minus(old, row(J, k)), inv_mass, inv_inertia)",
      "minus(row(J, k), old), inv_mass, inv_inertia)", "action without reaction")
