"""Lesson 4: wrong offsets, factors and orders of axes."""

from . import collection

fault, FAULTS = collection("inertia_tensors")

fault("centre_of_mass", "m @ x / M", "np.abs(m) @ x / M", "a hole counts as a body where the centre is computed")
fault("linear_momentum", "return m @ v", "return np.abs(m) @ v", "a hole carries momentum with it")
fault("angular_momentum", "cross(x[n] - about, v[n])", "cross(x[n], v[n])", "the point of reference does nothing")
fault("angular_momentum", "cross(x[n] - about, v[n])", "cross(v[n], x[n] - about)", "clockwise is positive")
fault("point_mass_inertia", "[-xz, -yz, xx + yy]", "[-xz, yz, xx + yy]", "one product of inertia has the other sign")
fault("box_inertia", "[bb + cc, aa + cc, aa + bb]", "[bb + cc, aa + bb, aa + cc]", "two axes of a box are exchanged")
fault("box_inertia", "m / 12.0", "m / 12.1", "a box is 1 % too easy to turn")
fault("sphere_inertia", "0.4 * m", "2.0 / 3.0 * m", "a hollow ball for a solid one")
fault("cylinder_inertia", "3.0 * radius * radius + length", "radius * radius + length",
      "across its axis a cylinder is too thin")
fault("capsule_inertia", "0.375 * length * radius", "0.25 * length * radius",
      "the centre of a half ball is at a quarter of its radius")
fault("capsule_inertia", "0.5 * m_c * rr + 0.4 * m_s * rr", "0.5 * m * rr", "about its axis a capsule is a cylinder")
fault("world_inertia", "R @ I_body @ R.T", "R.T @ I_body @ R", "from world to body instead of from body to world")
fault("world_inverse_inertia", "world_inertia(inverse(I_body), R)", "inverse(world_inertia(I_body, R.T))",
      "the inverse tensor is turned the wrong way")
fault("parallel_axes", "np.array([m])", "np.array([np.abs(m)])", "a hole adds to the tensor by its offset")
fault("combine", "x[n] - X", "x[n]", "the tensor is about the origin, not about the centre of mass")
fault("principal_axes", "R[:, 2] = -R[:, 2]", "R[:, 2] = R[:, 2]", "the axes can be left-handed")
fault("check_inertia", "moments[0] + moments[1]", "moments[0] + moments[2]", "moments that no body has are accepted")
fault("mesh_integrals", "w / 24.0 * s", "w / 18.0 * s", "the centroid of a tetrahedron is that of its triangle")
fault("mesh_integrals", "+ s * (a[j] + b[j] + c[j])", "", "second moments leave out the products between corners")
fault("check_closed", "if there[k] != back[k]:", "if there[k] != back[k] and k == 0:",
      "an open mesh passes, unless its first edge is open")
fault("mesh_body", "x[0] + centre", "centre", "the centre is given from the first corner")
fault("mesh_body", "second - volume * np.outer(centre, centre)", "second", "the tensor is about the first corner")

# drawn up without a look at those above
fault("combine", "centre_of_mass(m, x)", "(np.sum(m), x.T @ m / np.sum(m) if m.size > 1 else 0.0 * x[0])",
      "a single part is moved to the origin")
fault("mesh_integrals", "w / 24.0 * s", "abs(w) / 24.0 * s", "tetrahedra on the outer side are added to the centre")
fault("mesh_body", "volume <= MOMENT_ROUND_OFF", "abs(volume) <= MOMENT_ROUND_OFF",
      "a mesh turned inside out has a negative mass")
fault("inverse", "cross(a, b))) / determinant", "cross(b, a))) / determinant",
      "the last row has the other sign", of="vectors")
