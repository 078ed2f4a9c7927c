"""Lesson 9: wrong arms, laws of complementarity, cones, springs and memory."""

from ..mutants import contact as answers
from . import collection

fault, wrong_answer, FAULTS = collection("contact")

fault("contact_rows", "(contacts.b[k], -1.0)", "(contacts.b[k], 1.0)", "both bodies are pushed the same way")
wrong_answer(answers.PRODUCTS_ADDED)
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
fault("best_relaxation", "0.25 * omega * omega * rho", "(0.25 * omega * omega * rho) ** 2",
      "it converges twice as fast as it does")
fault("solve_lcp", "pushes[wrong] = not pushes[wrong]", "pushes[wrong] = True", "a contact that pulls is never let go")
fault("cone_residual", "limit = mu[n // 2] * J[n] if", "limit = 1.1 * mu[n // 2] * J[n] if",
      "the cone is 10 % too wide")
fault("cone_residual", "A[n, n] * np.abs(J_n - J[n])", "A[n, n] * np.maximum(0.0, J_n - J[n])",
      "a contact that pushes too much is no error")
wrong_answer(answers.FIRST_FRICTION_ONLY)
fault("cone_sweep", "np.minimum(np.maximum(J[t] - (A[t] @ J + b[t]) / A[t, t], -limit), limit)",
      "np.minimum(np.maximum(J[t] - (A[t] @ J + b[t]) / A[t, t], 0.0), limit)", "friction acts one way only")
fault("contact_forces", "np.ascontiguousarray(G.T) @ F", "0.5 * np.ascontiguousarray(G.T) @ F",
      "accelerations take half of the contact forces")
fault("soft_contact", "1.0 / (s * (2.0 * zeta + s))", "1.0 / (s * (zeta + s))",
      "the contact gives as with half of the damping")
fault("soft_contact", "-s * gap / (dt", "-gap / (dt", "the spring is stiffer than its frequency says")
fault("soft_contact", "return -gap / dt, 0.0", "return 0.0, 0.0", "a body is stopped before it touches")
fault("friction_disc", "scaled(limit / size, J)", "scaled(0.9 * limit / size, J)", "friction is 10 % too small")
fault("kept_impulses", "if old.b[s] == contacts.b[k]:", "if True:",
      "an impulse is taken from a contact with another body")
fault("kept_impulses", "if squared < nearest:", "if squared > nearest:", "only impulses from far away are kept")
fault("has_left_margin", "high[i, c] <= wide_high[i, c]", "high[i, c] <= wide_high[i, c] + 1.0",
      "who leaves upwards is not missed for a metre")
fault("velocity_sweep_2d", "pile.mu * J_n if", "pile.mu * 0.9 * J_n if", "friction is 10 % too small")
fault("velocity_sweep_2d", "- v[b, 1] - omega[b] * b_x", "- v[b, 1] + omega[b] * b_x",
      "the second body turns the other way")
fault("velocity_sweep_2d", "- give[k] * k_n * J_n)", ")", "the contact does not give under its load")
fault("velocity_sweep", "b, r_b, scaled(-1.0, change),", "b, r_b, change,", "action without reaction")
fault("contact_rows", "contacts.p[k, 0] - x[body, 0]", "contacts.p[k, 0] - x[contacts.a[k], 0]",
      "both arms begin at the first body")
fault("delassus_matrix", "(G * w)", "(G * (w > 0.0) * np.max(w))", "all bodies are as light as the lightest")
fault("complementarity_residual", "np.diag(A) * lam", "lam", "impulses are compared with velocities")
fault("gauss_seidel_sweep", "for k in range(lam.size)", "for k in range(lam.size - 1, -1, -1)",
      "the sweep begins at the other end")
fault("solve_lcp", "(lam[k] < -epsilon[k] / A[k, k])", "(lam[k] < -1e-3)", "contacts may pull by 1 mN s")
fault("solve_lcp", "(u[k] < -epsilon[k])", "(u[k] < -1e-4)", "contacts may approach by 0.1 mm/s")
fault("cone_residual", "limit = mu[n // 2] * J[n] if J[n] > 0.0 else 0.0",
      "limit = mu[n // 2] * np.maximum(0.0, J[n] - u[n] / A[n, n])", "the limit is that of the new J_n")
fault("cone_sweep", "(A[t] @ J + b[t]) / A[t, t]", "(A[t] @ J + b[t]) / np.maximum(A[t, t], A[n, n])",
      "a sweep changes J_t too little, and many sweeps do not")
fault("contact_forces", "G @ (w * load.ravel())", "G @ load.ravel() * np.max(w)", "right for equal masses only")
fault("soft_contact", "if gap > 0.0:", "if gap > 1e-3:", "the spring acts before it touches")
fault("friction_disc", "size = np.sqrt(dot(J, J))", "size = max(abs(J[0]), abs(J[1]), abs(J[2]))",
      "a box in place of the disc of friction")
fault("kept_impulses", "near * near", "near", "metres are compared with square metres")
fault("kept_impulses", "(contacts.p[k, c] - old.p[s, c]) ** 2", "(contacts.p[k, c] - old.p[s, c]) ** 2 * (c == 0)",
      "only the distance along x counts")
fault("velocity_sweep_2d", "pile.mu * J_n if J_n > 0.0", "pile.mu * (n_x * J[k, 0] + n_y * J[k, 1]) if J_n > 0.0",
      "friction is limited by the old J_n")
fault("velocity_sweep_2d", "J_t = -limit if J_t < -limit else", "J_t = limit if J_t < -limit else",
      "friction at its limit turns round on one side")
fault("velocity_sweep", "plus(old, -1.0 / arms.k_t[k], u)", "plus(old, -1.0 / arms.k_n[k], u)",
      "in space friction has the mass of the normal direction")
fault("velocity_sweep", "aim[k] - dot(n, u) - give[k] * k_n * J_n", "aim[k] - dot(n, u)",
      "in space contacts do not give under their load")
fault("velocity_sweep", "mu * J_n if J_n > 0.0 else 0.0", "mu * dot(n, old) if J_n > 0.0 else 0.0",
      "in space friction is limited by the old J_n")
fault("_aim_eight", "min(aim, s[WIDE * FASTEST + k]", "max(aim, s[WIDE * FASTEST + k]",
      "in a pile in space bodies part as fast as their overlap wants", of="given.contact")
fault("_aim_eight", "give * load), give", "give * load), 0.0",
      "in a pile in space contacts are stiff", of="given.contact")
fault("_visit_eight", "- give * k_n * J_n)", ")",
      "in a pile in space contacts do not give under their load", of="given.contact")
fault("_visit_eight", "mu * J_n if J_n > 0.0", "mu * 0.8 * J_n if J_n > 0.0",
      "in a pile in space friction is a fifth too small", of="given.contact")
fault("_follow_eight", "min(-gap / h, 0.0), 0.0", "w[WIDE * AIM + k], w[WIDE * GIVE + k]",
      "in a pile in space the velocity that pushes bodies apart stays", of="given.contact")
fault("_follow_eight", "gap + h *", "gap + 2.0 * h *", "gaps change twice as fast as bodies move", of="given.contact")
fault("turned", "plus(three(w, omega, k), sign,", "plus(three(w, omega, k), 1.0,",
      "both bodies of a contact turn the same way", of="support.lanes")
fault("inertia_times", "xy * b[0] + s", "xz * b[0] + s", "one product of inertia stands for another",
      of="support.lanes")
fault("colours_of", "taken[b] |= 1 << free", "taken[b] |= 0",
      "contacts of one group share a body, which loses impulses", of="support.lanes")
fault("put_contacts", "s[WIDE * (ARM_B + e) + i] = arms.r_a[k, e], arms.r_b[k, e]",
      "s[WIDE * (ARM_B + e) + i] = arms.r_a[k, e], arms.r_a[k, e]", "both arms begin at the first body",
      of="support.lanes")
fault("places_in", "old.b[k] != new.b[s]:", "False:", "a new contact takes the place of one with another body",
      of="support.kept_contacts")
fault("pairs_in_reach", "near_pairs(wide_low - half, wide_high + half", "near_pairs(wide_low, wide_high",
      "a pair is searched for when its bodies may touch already", of="support.kept_contacts")
fault("mark_gone", "gap[k] = GONE", "pass", "a contact that is gone still pushes", of="support.kept_contacts")
fault("mark_gone_in_lanes", "-s[WIDE * MASS_A + i], J", "0.0, J",
      "what a contact did to velocities stays when it is gone", of="support.lanes")
fault("mark_gone_in_lanes", "put_three(s, IMPULSE, i, (0.0, 0.0, 0.0))", "pass",
      "the impulse of a contact that is gone stays in its lane", of="support.lanes")
fault("add_push", "before + kept[k], before", "before, before", "no substep begins with the last impulses",
      of="support.arms")
fault("push_since", "total[k] - kept[k]", "0.5 * (total[k] - kept[k])",
      "a substep begins with half of what the last impulses did", of="support.arms")
fault("_follow_2d", "gap[k] += h * u_n[k]", "gap[k] += 2.0 * h * u_n[k]",
      "in the plane gaps change twice as fast as bodies move", of="given.contact")
fault("_follow_2d", "min(aim[k], 0.0), 0.0", "aim[k], give[k]",
      "in the plane the velocity that pushes bodies apart stays", of="given.contact")
fault("replace_in_plane", "gap[i], arms.k_n[i]", "_, arms.k_n[i]", "a contact that is found anew keeps its old gap",
      of="support.kept_contacts")
