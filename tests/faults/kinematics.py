"""Lesson 11: wrong joints, frames, branches and limits."""

from ..mutants import kinematics as answers
from . import collection

fault, wrong_answer, FAULTS = collection("kinematics")

fault("joint_positions", "phi += theta[k]", "phi = theta[k]", "angles are from the x axis, not from the link before")
fault("joint_positions", "x[k, 1] + lengths[k] * np.sin(phi)", "x[k, 1] + lengths[0] * np.sin(phi)",
      "upwards, all links have the length of the first")
fault("jacobian_2d", "x[k, 1] - x[n, 1], x[n, 0] - x[k, 0]", "x[n, 1] - x[k, 1], x[n, 0] - x[k, 0]",
      "joints move the end the wrong way along x")
fault("velocity_ellipse", "0.5 * np.arctan2(2.0 * b, a - c)", "np.arctan2(2.0 * b, a - c)",
      "the ellipse is turned twice as far")
fault("velocity_ellipse", "np.sqrt(squared) / longer", "squared / longer", "the short axis has its square")
fault("solve_2r", "elbow * 2.0 *", "-elbow * 2.0 *", "elbow up is elbow down")
fault("solve_2r", "lengths[0] + lengths[1] * np.cos(theta_2)", "lengths[1] + lengths[0] * np.cos(theta_2)",
      "the two links are exchanged")
fault("solve_3r", "wrapped(phi - theta[0] - theta[1])", "wrapped(phi - theta[1])",
      "the wrist leaves out the turn of the shoulder")
fault("joint_frames", "quaternion_product(q, exponential(scaled(theta[k], axis)))",
      "quaternion_product(exponential(scaled(theta[k], axis)), q)", "joints turn about axes of the world")
wrong_answer(answers.FIRST_AXIS_ONLY)
fault("rotation_error", "quaternion_product(q_target, np.array((q[0], -q[1], -q[2], -q[3])))",
      "quaternion_product(np.array((q[0], -q[1], -q[2], -q[3])), q_target)", "the error is in the frame of the hand")
fault("rotation_error", "2.0 * np.arctan2(size, d[0]) / size", "2.0", "the error is that of a small turn")
fault("rotation_error", "if d[0] < 0.0:", "if d[0] < -2.0:", "the hand turns the long way round")
fault("transpose_step", "arm.gain * (e @ J)", "1.05 * arm.gain * (e @ J)", "the gain is 5 % too large")
fault("pseudo_inverse", "SINGULAR * sigma[0]", "0.3 * sigma[0]", "directions that are hard to reach are given up")
fault("damped_step", "A[r, r] += arm.damping * arm.damping", "A[r, r] += arm.damping", "damping is not squared")
fault("damped_step", "A[r, r] += arm.damping * arm.damping", "A[r, r] += 1.1 * arm.damping * arm.damping",
      "λ² is 10 % too large")
fault("contraction_factors", "1.0 - gain * sigma**2", "1.0 - gain * sigma",
      "the transpose contracts by σ, not by its square")
fault("contraction_factors", "damping**2 / (sigma**2 + damping**2)", "damping / (sigma**2 + damping)", "λ for λ²")
fault("ccd_step", "x[k, 0] + c * r_x - s * r_y", "x[k, 0] + c * r_x + s * r_y",
      "the end is turned the wrong way while the joint is not")
fault("ccd_step", "np.minimum(np.maximum(wish, arm.low[k]), arm.high[k])", "np.maximum(wish, arm.low[k])",
      "joints have no upper limit")
fault("fabrik_sweep", "x[k + 1] = point_at(x[k], x[k + 1], lengths[k])",
      "x[k + 1] = point_at(x[k], x[k + 1], lengths[0])", "all links have the length of the first")
fault("fabrik_sweep", "x[0] = base", "x[0] = 0.5 * (x[0] + base)", "the base creeps to the target")
fault("limited_step", "theta[k] <= arm.low[k] and wish[k] < 0.0", "theta[k] <= arm.low[k]",
      "a joint never leaves its lower limit")
fault("limited_step", ", arm.low), arm.high)", ", arm.low), np.inf)", "joints have no upper limit")
fault("null_space_step", "(e - J @ z)", "e", "going to the rest posture moves the end")
fault("null_space_step", "arm.pull * (arm.rest - theta)", "arm.pull * (theta - arm.rest)",
      "the arm flees from its rest posture")
fault("pose_2d", "wrapped(target[2] - np.sum(theta))", "wrapped(target[2] - theta[n - 1])",
      "the direction of the hand is the last angle only")
fault("angles_of", "wrapped(phi - before), phi", "wrapped(phi - before), 0.0",
      "angles are from the x axis, not from the link before")
fault("reach_2d", "target - x[theta.size], jacobian_2d(x)", "target - x[theta.size - 1], jacobian_2d(x)",
      "the last joint but one reaches for the target")
fault("velocity_ellipse", "np.arctan2(2.0 * b, a - c)", "np.arctan2(2.0 * np.abs(b), a - c)",
      "the long axis never points downwards")
fault("velocity_ellipse", "for i in range(k):", "for i in range(max(0, k - 1), k):", "right for two joints only")
fault("solve_2r", "np.abs(lengths[0] - lengths[1])", "lengths[0] - lengths[1]",
      "an arm with a longer second link has no hole")
fault("solve_2r", "wrapped(np.arctan2(target[1], target[0]) - back)", "np.arctan2(target[1], target[0]) - back",
      "angles beyond half a turn")
fault("solve_3r", "wrapped(phi - theta[0] - theta[1])", "phi - theta[0] - theta[1]",
      "the hand turns the long way round")
fault("pseudo_inverse", "SINGULAR * sigma[0]", "SINGULAR", "what is singular depends on the unit of length")
fault("ccd_step", "np.minimum(np.maximum(wish, arm.low[k]), arm.high[k])", "np.minimum(wish, arm.high[k])",
      "joints have no lower limit")
fault("ccd_step", "np.cos(new - theta[k]), np.sin(new - theta[k])", "np.cos(wish - theta[k]), np.sin(wish - theta[k])",
      "the end goes where a joint without limits would take it")
fault("fabrik_sweep", "x[0] = base", "x[0] = 0.0 * base", "the base is always at the origin")
fault("limited_step", "theta[k] >= arm.high[k]", "theta[k] > arm.high[k]", "a joint at its upper limit is not blocked")
fault("jacobian_3d", "minus(row(x, n), row(x, k))", "row(x, n)", "all joints turn the end about the base")
fault("rotation_error", "if d[0] < 0.0:", "if d[0] < -0.999:", "it turns the long way round")
fault("reach_3d", "jacobian_3d(x, a)[:3]", "jacobian_3d(x, a)[3:]", "the rows of the rotation for those of the place")
fault("pose_3d", "rotation_error(q, target[3:])", "-rotation_error(q, target[3:])",
      "the hand turns away from its target")
fault("end_pose", "x[theta.size], q", "x[theta.size - 1], q", "the place of the last joint for that of the end")
fault("point_at", "r[0], size = 1.0, 1.0", "r[1], size = 1.0, 1.0", "what has no direction goes along the second axis")
fault("solve_reach", "theta, iterations = step(task, theta, target, arm), iterations + 1",
      "theta, iterations = step(task, theta, target, arm), iterations + 2", "each iteration counts twice")
fault("solve_targets", "task, theta, targets[i]", "task, thetas[i - 1] if i > 0 else theta, targets[i]",
      "each search begins where the last one ended")
fault("reach_trajectory", "step, task, thetas[k]", "step, task, thetas[0]", "a history repeats its first iteration")
