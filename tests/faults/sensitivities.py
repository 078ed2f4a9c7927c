"""Lesson 12: wrong steps of differences, tangents at the wrong place, impacts whose time does not move."""

from . import collection

fault, wrong_answer, FAULTS = collection("sensitivities")

fault("central_difference", "(2.0 * h)", "(2.02 * h)", "a difference is divided by 1 % too much")
fault("central_difference", "f(s + h, p) - f(s - h, p)", "2.0 * (f(s + h, p) - f(s, p))",
      "the difference is taken ahead only: first order")
fault("best_step", "3.0 * round_off", "24.0 * round_off", "the best step is twice as long")
fault("complex_step", "np.imag(f(s + 1j * h, p)) / h", "np.imag(f(s + h + 1j * h, p)) / h",
      "the derivative is taken at s + h")
fault("tangent_step", "a_v @ dv", "0.0 * dv", "damping does not act on the sensitivities")
fault("tangent_step", "+ a_s)", ")", "the law does not depend on its own parameters")
fault("tangent_step", "dx + dt * dv_new, dv_new", "dx + dt * dv, dv_new", "dx moves with the old dv")
fault("tangent_implicit_step", "- dt * dt * a_x", "", "the new position does not depend on the new velocity")
fault("tangent_implicit_step", "(a_x @ dx + a_s)", "(a_x @ dx)", "the law does not depend on its own parameters")
fault("tangent_implicit_step", "- dt * a_v", "+ dt * a_v", "damping drives the sensitivities")
fault("event_time_sensitivity", "+ gap_s) / rate", ") / rate", "an event does not depend on the inputs itself")
fault("event_time_sensitivity", "return -(gap_x", "return (gap_x", "a later event is an earlier one")
fault("event_time_sensitivity", "+ gap_v @ dv", "", "an event in the velocity does not move with it")
fault("saltation", "dx + np.outer(v - v_new, dtau)", "dx", "the time of the impact does not move the place")
fault("saltation", "- np.outer(a_new, dtau)", "", "the fall after the impact is forgotten")
fault("saltation", "+ R_s", "", "the jump does not depend on the inputs itself")
fault("bounce", "-(v @ n) * np.outer(n, e_s)", "0.0 * np.outer(n, e_s)", "restitution is never an input")
fault("bounce", "(1.0 + e) * np.outer(n, n)", "2.0 * np.outer(n, n)", "every bounce is elastic for the sensitivities")
fault("remainder_orders", "h * (gradient @ direction)", "0.99 * h * (gradient @ direction)",
      "every gradient is 1 % wrong")
fault("aim", "step = solve(J, r)", "step = 0.5 * solve(J, r)", "half of Newton's step: the miss is halved, not squared")
fault("predicted_horizon", "np.arccosh(allowed / error)", "np.log(allowed / error)",
      "the whole error grows, none of it decays")
fault("fly", "dx = dx + tau * dv", "dx = dx + 0.0 * dv", "sensitivities do not move during a flight",
      of="given.sensitivities")
fault("fly", "p.e[k], still, p.e_s[k])", "p.e[k], still, p.e_s[0])", "all planes have the restitution of the first",
      of="given.sensitivities")
