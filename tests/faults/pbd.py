"""Lesson 8: wrong shares, masses, signs and constraints that are met but wrong."""

from . import collection

fault, FAULTS = collection("pbd")

fault("distance_constraint", "length - rest, r / length", "length - rest, r / rest",
      "the gradient has not the length 1")
fault("constraint_correction", "inv_mass[:, None] * gradients", "np.mean(inv_mass) * gradients",
      "heavy points move as far as light ones")
fault("constraint_correction", "weight += inv_mass[k] * g * g", "weight += inv_mass[k] * np.abs(g)",
      "the gradient is not squared")
fault("predict", "dt * dt * free[:, None] * a", "0.5 * dt * dt * free[:, None] * a",
      "half of gravity: the term of Verlet")
fault("newton_correction", "A[a, b] -= network", "A[a, b] += network", "the curvature of a link has the other sign")
fault("newton_correction", "found[size:] / (dt * dt)", "found[size:] / dt", "multipliers are impulses, not forces")
fault("constraint_projection_step", "(new - x) / dt", "v + (new - goal) / dt", "gravity does not enter the velocity")
fault("distance_sweep", "w[j] * share, x)", "w[i] * share, x)",
      "the second end has the mass of the first")
fault("distance_sweep", "share = network.stiffness[s] *", "share = 0.99 * network.stiffness[s] *",
      "links are 1 % softer than they should be")
fault("pbd_step", "range(network.sweeps)", "range(network.sweeps - 1)", "one sweep is missing")
fault("pbd_sag", "S / (1.0 - S)", "S", "what earlier steps left is forgotten")
fault("fold_constraint", "dot(b - d, e) / squared * wing_d", "dot(b - c, e) / squared * wing_d",
      "the second wing has the lever of the first")
fault("fold_constraint", "turn -= 2.0 * np.pi * np.ceil((turn - np.pi) / (2.0 * np.pi))", "turn -= 0.0",
      "a fold past half a turn opens the long way round")
fault("fold_constraint", "wing_c = -length / squared_c * N_c", "wing_c = -1.0 / squared_c * N_c",
      "right for an edge of 1 m only")
fault("ball_gap", "r / distance if", "-r / distance if", "the normal points into the ball")
fault("keep_outside", "phi < 0.0 and", "", "points outside stick to the surface")
fault("compliant_multiplier", "-C - alpha_scaled * Lam", "-C", "the spring forgets its earlier visits")
fault("compliant_sweep", "network.alpha[s] / (dt * dt)", "network.alpha[s] / dt", "compliance over dt in place of dt²")
fault("compliant_sweep", "network.alpha[s] / (dt * dt)", "1.01 * network.alpha[s] / (dt * dt)",
      "springs are 1 % too soft")
fault("xpbd_step", "new, (new - x) / dt", "new, 0.999 * (new - x) / dt",
      "a thousandth of the velocity is lost per step")
fault("effective_inverse_mass_at", "turn = unrotate(q, cross(r, n))", "turn = cross(r, n)",
      "the lever is taken in world coordinates")
fault("apply_positional_impulse", "quaternion_update(q, turn, 1.0)", "quaternion_update(q, turn, 0.5)",
      "it turns half as far")
fault("turning_rate", "2.0 / (turn[0] * dt) * turn[1:]", "2.0 / dt * turn[1:]",
      "ω is that of a short turn: sin for tan")
fault("volume_gradient", "cross(c, a) / 6.0", "cross(a, c) / 6.0", "one corner of each face pulls inwards")
fault("volume_gradient", "V += dot(a, across)", "V += np.abs(dot(a, across))",
      "every face adds to the volume, whichever way it looks")
