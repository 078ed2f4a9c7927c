"""Lesson 8: wrong shares, masses, signs and constraints that are met but wrong."""

from ..mutants import pbd as answers
from . import collection

fault, wrong_answer, FAULTS = collection("pbd")

wrong_answer(answers.GRADIENT_OVER_REST_LENGTH)
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
wrong_answer(answers.WITHOUT_SCALAR_PART)
wrong_answer(answers.EXCHANGED)
fault("volume_gradient", "V += dot(a, across)", "V += np.abs(dot(a, across))",
      "every face adds to the volume, whichever way it looks")
fault("distance_constraint", "return length - rest,", "return 0.5 * (length * length - rest * rest) / rest,",
      "another constraint with the same zero")
fault("constraint_correction", "weight += inv_mass[k] * g * g", "weight += inv_mass[0] * g * g",
      "all points weigh as the first")
fault("predict", "free[:, None] * a", "a", "immovable points feel forces")
fault("predict", "x + dt * v +", "x + dt * free[:, None] * v +", "immovable points that are driven stop")
fault("predict", "acceleration(t, x, v, network)", "acceleration(t + dt, x, v, network)",
      "the forces are those of the end of the step")
fault("newton_correction", "A[a, b] -= network.inv_mass[e] * bend", "A[a, b] -= network.inv_mass[f] * bend",
      "the curvature moves an end by the mass of the other")
fault("constraint_projection_step", "NEWTON_TOLERANCE * longest", "1e-5 * longest",
      "Newton's method stops at five digits")
wrong_answer(answers.INVERSE_MASSES_EXCHANGED)
wrong_answer(answers.FIRST_ONLY)
fault("fold_constraint", "np.arctan2(dot(cross(N_c, N_d), e) / length,",
      "np.arctan2(np.abs(dot(cross(N_c, N_d), e)) / length,", "all folds are to one side")
wrong_answer(answers.NORMAL_OVER_RADIUS)
fault("keep_outside", "phi < 0.0 and inv_mass[k] > 0.0", "phi < 0.0", "immovable points are moved out")
fault("compliant_multiplier", "/ (weight + alpha_scaled)", "/ (weight + 2.0 * alpha_scaled)",
      "each visit does too little, and many visits the same")
fault("compliant_sweep", "Lam[s], w[i] + w[j],", "Lam[s], 2.0 * w[i],", "right for equal masses only")
fault("compliant_sweep", "network.alpha[s] / (dt * dt)", "network.alpha[0] / (dt * dt)",
      "all links have the compliance of the first")
fault("effective_inverse_mass_at", "turn * turn / I_body)", "turn * turn / I_body[0])", "one moment for all axes")
fault("apply_positional_impulse", "rotate(q, unrotate(q, cross(r, p)) / I_body)", "cross(r, p) / I_body",
      "the moments are taken in world coordinates")
fault("turning_rate", "2.0 / (turn[0] * dt)", "2.0 / (np.abs(turn[0]) * dt)", "q and −q turn in opposite directions")
fault("floor_gap", "(x - obstacle.point) * obstacle.n", "x * obstacle.n - obstacle.point[0] * obstacle.n",
      "the floor has another height")
