"""Lesson 5: wrong frames, sides, halves and handedness."""

from ..mutants import rotation as answers
from . import collection

fault, wrong_answer, FAULTS = collection("rotation")

wrong_answer(answers.SIGN_IN_SECOND_ROW)
wrong_answer(answers.ROTATION_SUBTRACTED)
wrong_answer(answers.AT_ORIGIN)
fault("total_load", "F += forces[i]", "F = forces[i].copy()", "only the last force pushes")
wrong_answer(answers.WORLD_FOR_BODY)
fault("state_derivative", "skew(omega) @ S.R", "S.R @ skew(omega)", "ω is taken in body coordinates")
fault("state_derivative", "S.P / body.m", "S.P", "momentum for velocity: right for a kilogram")
fault("matrix_update", "second -= dot(first, second) * first", "second -= 0.5 * dot(first, second) * first",
      "the axes are not at right angles any more")
fault("axis_angle_update", "(1.0 - c) * dot(n, r) * n", "(1.0 - c) * (1.0 - c) * dot(n, r) * n",
      "the part along the axis is 1 − cos θ too short")
fault("quaternion_product", "a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2]",
      "a[0] * b[1] + a[1] * b[0] - a[2] * b[3] + a[3] * b[2]", "one component multiplies in the other order")
fault("rotation_matrix", "2.0 * (y * z + w * x)", "2.0 * (y * z - w * x)", "one entry is that of the transpose")
fault("quaternion_update", "0.5 * dt * quaternion_product(spin, q)", "0.5 * dt * quaternion_product(q, spin)",
      "ω is taken in body coordinates")
fault("quaternion_update", "unit(q + 0.5 * dt * quaternion_product(spin, q))",
      "unit(q + 0.5 * dt * quaternion_product(spin, q) - 0.125 * dt * dt * (spin @ spin) * q)",
      "the next term of the series is in it: a step that errs less")
fault("angular_acceleration", "cross(omega_body, I_body * omega_body)", "cross(I_body * omega_body, omega_body)",
      "the gyroscopic term has the other sign")
fault("angular_acceleration", "unrotate(q, tau)", "tau", "the torque is taken in body coordinates")
fault("rigid_body_step", "quaternion_update(q, omega, dt)",
      "quaternion_update(q, omega - dt * angular_acceleration(q, omega, tau, body.I_body), dt)",
      "it turns with nearly the old ω: explicit Euler for the orientation")
fault("rolling_step", "ball.radius * ball.radius / ball.I_body[0]", "ball.radius / ball.I_body[0]",
      "the lever of friction counts once: right for a radius of 1 m")
fault("supported_weight", "F[2] + max(0.0, -F[2])", "F[2] - F[2]",
      "the floor also pulls: it holds a ball that gravity lifts")
wrong_answer(answers.WORLD_COMPONENTS)
fault("tumbling_rate", "(I_body[i] * I_body[j])", "(I_body[k] * I_body[k])",
      "the rate has the wrong moments below the line")
wrong_answer(answers.TORQUE_REVERSED)
fault("heavy_top_torque", "top.mgl *", "1.01 * top.mgl *", "the top is 1 % too heavy")
fault("midpoint_free_rotation", "w = m / I_body\n            return", "w = start / I_body\n            return",
      "the body turns with ω of the beginning")
fault("splitting_free_rotation", "turned = about_axis(turned, a, 0.5 * slow_a * body_component(turned, L, a))",
      "turned = about_axis(turned, a, 0.5 * slow_a * body_component(q, L, a))",
      "the last rotation takes L of the beginning")
fault("midpoint_step", "L + 0.5 * dt * torque(t + dt, q, L, body)", "L + 0.5 * dt * torque(t, q, L, body) * 0.98",
      "the second half of the angular impulse is 2 % too small")
fault("compose", "1.0 - 4.0 * SUZUKI", "1.0 - 3.96 * SUZUKI", "the shares of the step do not add up to 1")

# drawn up without a look at those above
wrong_answer(answers.SLOW_IS_AT_REST)
wrong_answer(answers.SIGN_OF_DT_IGNORED)
fault("intermediate_axis", ">= 0.0", "> 0.0", "the middle axis of a symmetric body may be its axis of symmetry")
fault("average_rolling_step", "quaternion_product(turn, q)", "quaternion_product(q, turn)",
      "the ball turns about axes of its own")
fault("average_rolling_step", "(omega + omega_new)", "(omega_new + omega_new)",
      "the ball turns with its new angular velocity")
fault("runge_kutta_step", "L + dt * tau_3", "L", "the last stage has the old angular momentum", of="given.rotation")
fault("_slope", "rotation_matrix(turn)", "rotation_matrix(q)",
      "between the stages, lengths are not kept", of="given.rotation")
fault("rotation_trajectory", "t + n * dt, q", "t, q", "every step of a history begins at the time of the first",
      of="given.rotation")
fault("rotation_trajectory", "ts = t + dt", "ts = dt", "the times of a history begin at 0", of="given.rotation")
fault("advance_rotation", "t + n * dt", "t", "every step begins at the time of the first", of="given.rotation")
fault("advance_rigid_body", "t + n * dt", "t", "every step begins at the time of the first", of="given.rotation")
fault("make_rigid_body", "m), moments)", "m), moments[::-1].copy())", "the moments are reversed", of="given.rotation")
fault("about_axis", "x * c - z * s", "x * c + z * s", "a turn about the second axis is none", of="support.quaternions")
