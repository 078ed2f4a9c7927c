"""Lesson 1: wrong slopes, times, weights and halves."""

from ..mutants import integrators as answers
from . import collection

fault, wrong_answer, FAULTS = collection("integrators")

fault("euler_step", "x + dt * v, v", "x + dt * v + 0.05 * dt * dt * acceleration(t, x, v, p), v",
      "a tenth of the free-fall term is in the position: Euler that errs less")
wrong_answer(answers.MIDDLE_AT_OLD_TIME)
wrong_answer(answers.V_AT_OLD)
fault("rk4_step", "a4 = acceleration(t + dt,", "a4 = acceleration(t + 0.5 * dt,",
      "the last force is taken at the time of the middle")
wrong_answer(answers.THIRD_SLOPE_FROM_FIRST)
fault("rk4_step", "(a1 + 2.0 * a2 + 2.0 * a3 + a4)", "(a1 + 2.02 * a2 + 1.98 * a3 + a4)",
      "the weights of the middle slopes are 1 % off, with the same sum")
fault("average_velocity_step", "0.5 * dt * (v + v_new)", "dt * v_new", "it moves with the new velocity only")
fault("symplectic_euler_step", "v = v + dt * acceleration(t, x, v, p)",
      "v = v + dt * acceleration(t, x + 0.5 * dt * v, v, p)", "the force is that of the middle: leapfrog, of order 2")
wrong_answer(answers.LAST_AT_OLD_VELOCITY)
wrong_answer(answers.LAST_AT_OLD_TIME)
fault("blanes_moan_step", "t += drift * dt", "t += 0.0", "the forces in a step are those of its beginning")
fault("advance_adaptive", "rate -= 1.5 * share", "rate -= 1.515 * share",
      "the rate follows the distance 1 % too strongly")
fault("advance_adaptive", "rate -= 0.75 * share", "rate -= 0.0 * share",
      "the first rate is that of the beginning of the step")
fault("inner_product", "a.flat[k] * b.flat[k]", "a.flat[0] * b.flat[k]", "the product takes one entry for all")
fault("newton_matrix", "x + dt * ahead, ahead, p) - ", "x + dt * ahead, v, p) - ",
      "the slope of the force leaves out half of its dependence on the velocity")
fault("implicit_euler_step", "residual = w - v - dt * acceleration(t + dt,",
      "residual = w - v - dt * acceleration(t,", "the force at the end is taken at the time of the beginning")
fault("implicit_midpoint_step", "2.0 * v_mid - v", "2.0 * v_mid - v + 0.01 * (v_mid - v)",
      "the velocity changes by 0.5 % too much in each step")
wrong_answer(answers.TRANSPOSE)
fault("spectral_radius", "return abs(half_trace) + np.sqrt(discriminant)", "return half_trace + np.sqrt(discriminant)",
      "the larger of two real eigenvalues, not that of the larger absolute value")
fault("observed_order", "return np.sum(", "return 0.9 * np.sum(", "the order is 10 % too low")

# drawn up without a look at those above
fault("inner_product", "range(a.size)", "range(min(a.size, 2))", "the product leaves out the third coordinate")
fault("advance", "t + n * dt", "t", "every step begins at the time of the first")
fault("trajectory", "t + n * dt", "t", "every step of a history begins at the time of the first")
fault("trajectory", "ts = t + dt", "ts = dt", "the times of a history begin at 0")
fault("advance_adaptive", "min(share / rate, end - t)", "share / rate", "the last step goes past the end")
wrong_answer(answers.VELOCITY_OF_HALF_A_STEP)
