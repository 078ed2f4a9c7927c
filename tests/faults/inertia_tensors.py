"""Lesson 4: wrong offsets, factors and orders of axes."""

from ..mutants import inertia_tensors as answers
from . import collection

fault, wrong_answer, FAULTS = collection("inertia_tensors")

fault("centre_of_mass", "m @ x / M", "np.abs(m) @ x / M", "a hole counts as a body where the centre is computed")
wrong_answer(answers.HOLE_IS_A_BODY)
wrong_answer(answers.ABOUT_THE_ORIGIN)
wrong_answer(answers.V_CROSS_R)
fault("point_mass_inertia", "[-xz, -yz, xx + yy]", "[-xz, yz, xx + yy]", "one product of inertia has the other sign")
fault("box_inertia", "[bb + cc, aa + cc, aa + bb]", "[bb + cc, aa + bb, aa + cc]", "two axes of a box are exchanged")
fault("box_inertia", "m / 12.0", "m / 12.1", "a box is 1 % too easy to turn")
wrong_answer(answers.HOLLOW_SPHERE)
wrong_answer(answers.THIN_CYLINDER)
fault("capsule_inertia", "0.375 * length * radius", "0.25 * length * radius",
      "the centre of a half ball is at a quarter of its radius")
fault("capsule_inertia", "0.5 * m_c * rr + 0.4 * m_s * rr", "0.5 * m * rr", "about its axis a capsule is a cylinder")
wrong_answer(answers.TRANSPOSED_ROTATION)
fault("world_inverse_inertia", "world_inertia(inverse(I_body), R)", "inverse(world_inertia(I_body, R.T))",
      "the inverse tensor is turned the wrong way")
fault("parallel_axes", "np.array([m])", "np.array([np.abs(m)])", "a hole adds to the tensor by its offset")
fault("combine", "x[n] - X", "x[n]", "the tensor is about the origin, not about the centre of mass")
fault("principal_axes", "R[:, 2] = -R[:, 2]", "R[:, 2] = R[:, 2]", "the axes can be left-handed")
fault("check_inertia", "moments[0] + moments[1]", "moments[0] + moments[2]", "moments that no body has are accepted")
wrong_answer(answers.CENTRE_OF_THE_TRIANGLE)
wrong_answer(answers.WITHOUT_CORNER_PRODUCTS)
fault("check_closed", "if there[k] != back[k]:", "if there[k] != back[k] and k == 0:",
      "an open mesh passes, unless its first edge is open")
wrong_answer(answers.CENTRE_FROM_FIRST_CORNER)
wrong_answer(answers.TENSOR_ABOUT_FIRST_CORNER)

# drawn up without a look at those above
fault("combine", "centre_of_mass(m, x)", "(np.sum(m), x.T @ m / np.sum(m) if m.size > 1 else 0.0 * x[0])",
      "a single part is moved to the origin")
fault("mesh_integrals", "w / 24.0 * s", "abs(w) / 24.0 * s", "tetrahedra on the outer side are added to the centre")
wrong_answer(answers.INSIDE_OUT_MESH)
fault("inverse", "cross(a, b))) / determinant", "cross(b, a))) / determinant",
      "the last row has the other sign", of="vectors")
