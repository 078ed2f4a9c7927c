"""Lesson 2: wrong arms, ends, signs and terms that vanish at rest."""

from ..mutants import springs as answers
from . import collection

fault, wrong_answer, FAULTS = collection("springs")

wrong_answer(answers.FALLS_WITH_1_OVER_R)
wrong_answer(answers.REPELS)
fault("air_force", "wind - k_v * v", "wind - 1.01 * k_v * v", "the air is 1 % too viscous")
wrong_answer(answers.WITHOUT_WIND)
fault("spring_tension", "k_d * rate", "k_d * np.abs(rate)", "the damper pulls while the spring is shortened, too")
fault("spring_tension", "k * (length - rest)", "1.01 * k * (length - rest)", "springs are 1 % too stiff")
fault("soft_constraint_force", "k_d * C_rate", "0.9 * k_d * C_rate", "the damper is 10 % too weak")
fault("soft_contact_force", "if C >= 0.0:", "if C >= 0.01:", "the surface pushes from a distance of a centimetre on")
wrong_answer(answers.DAMPER_PULLS)
fault("angular_spring_forces", "-k * turn / squared_c", "-k * turn / np.sqrt(squared_a * squared_c)",
      "the force on c has the mean arm for its own")
fault("angular_spring_forces", "-(F_a + F_c), F_c", "-2.0 * F_a, F_c", "the hinge gets twice the force of one arm")
fault("angular_spring_forces", "turn -= 2.0 * np.pi * np.ceil((turn - np.pi) / (2.0 * np.pi))", "turn -= 0.0",
      "an angle past half a turn is not brought back: the spring pushes the long way round")
fault("spring_forces", "product_between(x, v, i, j)", "np.sum((x[i] - x[j]) * v[i])",
      "the damper sees the velocity of one end only")
fault("spring_network_acceleration", "(force[n, c] + air) * network.inv_mass[n]",
      "force[n, c] * network.inv_mass[n] + air", "air acts per kilogram")
fault("mass_spring_damper_step", "average_velocity_step(spring_network_acceleration, t, x",
      "average_velocity_step(spring_network_acceleration, t, x + 0.5 * dt * v",
      "the forces are those of the middle of the step, and so is the place")
fault("grid_pairs", "0 <= c + dc < cols", "c + dc < cols",
      "a shear spring of the first column wraps round to the row before")
fault("spring_stiffness", "np.maximum(0.0, 1.0 - network.rest[s] / length)", "np.maximum(0.0, 1.0)",
      "a spring at rest resists sideways motion")
fault("spring_stiffness", "D[s, a, b] = network.k_d[s] * nn", "D[s, a, b] = 0.5 * network.k_d[s] * nn",
      "half of the damping is explicit")
fault("implicit_spring_network_step", "+ dt * network.k_v", "", "viscosity is not in the matrix")
wrong_answer(answers.HALF_OF_THE_STIFFNESS)
fault("conjugate_gradients", "enough = CG_TOLERANCE * CG_TOLERANCE * squared", "enough = 1e-4 * squared",
      "the step is solved to 1 % only")

# drawn up without a look at those above
wrong_answer(answers.FORCE_AT_TOUCH)
fault("angular_spring_forces", "np.ceil((turn - np.pi) / (2.0 * np.pi))", "np.where(turn > np.pi, 1.0, 0.0)",
      "angles above half a turn are brought back, those below minus half a turn are not")
wrong_answer(answers.HALF_A_TURN,
             missed="both ways round are equally long there, and round-off decides between them")
wrong_answer(answers.NEGATIVE_INDEX)
wrong_answer(answers.ONE_REST)
wrong_answer(answers.ONE_DAMPER)
fault("randomised", "2.0 * u - 1.0", "u", "what is drawn is above its value only")
fault("hand_force", "dt * (c + dt * k) / m", "dt * (0.99 * c + dt * k) / m", "the hand's own damper is 1 % too weak")
fault("hand_force", "x - target + dt * v", "x - target + 0.5 * dt * v",
      "the hand sees the place in the middle of the step")
