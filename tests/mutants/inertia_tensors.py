"""Lesson 4: wrong signs, halves for wholes, tensors about the wrong point; and the other ways of writing what is right."""

import numpy as np

from solutions import inertia_tensors as worked
from solutions.checks import BadInput, check_finite, check_positive
from . import collection, variants

wrong, right, edit, MUTANTS = collection(worked)


# 4.1 ------------------------------------------------------------------------------------------------------------
@wrong("4.1", "mean position, whatever the masses")
def centre_of_mass(m, x):
    check_positive("total mass [kg]", np.sum(m))
    return np.sum(m), np.sum(x, axis=0) / m.size


@wrong("4.1", "forgets to divide by the mass")
def centre_of_mass(m, x):
    check_positive("total mass [kg]", np.sum(m))
    return np.sum(m), m @ x


@wrong("4.1", "divides by the number of points")
def centre_of_mass(m, x):
    check_positive("total mass [kg]", np.sum(m))
    return np.sum(m), m @ x / m.size


@wrong("4.1", "divides by zero")
def centre_of_mass(m, x):
    with np.errstate(all="ignore"):
        return np.sum(m), m @ x / np.sum(m)


@right("4.1", "pair by pair, each centre on the line between two")
def centre_of_mass(m, x):
    M, X = m[0], x[0]
    for k, y in zip(m[1:], x[1:]):
        M = M + k
        X = X + k / M * (y - X) if M != 0.0 else X
    check_positive("total mass [kg]", M)
    return M, X


# 4.2 ------------------------------------------------------------------------------------------------------------
@wrong("4.2", "forgets the masses")
def linear_momentum(m, v):
    return np.sum(v, axis=0)


@wrong("4.2", "total mass times the mean velocity")
def linear_momentum(m, v):
    return np.sum(m) * np.mean(v, axis=0)


@wrong("4.2", "speeds instead of velocities")
def linear_momentum(m, v):
    return m @ np.abs(v)


@wrong("4.2", "velocity of the centre")
def linear_momentum(m, v):
    return m @ v / np.sum(m)


@right("4.2", "mass by mass")
def linear_momentum(m, v):
    P = np.zeros(3)
    for k, w in zip(m, v):
        P = P + k * w
    return P


# 4.3 ------------------------------------------------------------------------------------------------------------
@wrong("4.3", "cross product the other way round")
def angular_momentum(m, x, v, about):
    return m @ np.cross(v, x - about)


@wrong("4.3", "always about the origin")
def angular_momentum(m, x, v, about):
    return m @ np.cross(x, v)


@wrong("4.3", "forgets the masses")
def angular_momentum(m, x, v, about):
    return np.sum(np.cross(x - about, v), axis=0)


@wrong("4.3", "always about the centre")
def angular_momentum(m, x, v, about):
    return m @ np.cross(x - m @ x / m.sum(), v)


@right("4.3", "about the origin, and the arm of the whole")
def angular_momentum(m, x, v, about):
    return m @ np.cross(x, v) - np.cross(about, m @ v)


# 4.4 ------------------------------------------------------------------------------------------------------------
def moments(m, r):
    """Σ m x xᵀ"""
    return (r.T * m) @ r


@wrong("4.4", "plus sign off the diagonal")
def point_mass_inertia(m, r):
    I = worked.point_mass_inertia(m, r)
    return 2.0 * np.diag(np.diag(I)) - I


@wrong("4.4", "second moments for the tensor")
def point_mass_inertia(m, r):
    return moments(m, r)


@wrong("4.4", "diagonal only")
def point_mass_inertia(m, r):
    return np.diag(np.diag(worked.point_mass_inertia(m, r)))


@wrong("4.4", "distance from the point instead of from the axis")
def point_mass_inertia(m, r):
    return m @ np.sum(r * r, axis=1) * np.eye(3)


@right("4.4", "minus the squared cross-product matrices")
def point_mass_inertia(m, r):
    I = np.zeros((3, 3))
    for k, (x, y, z) in zip(m, r):
        K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        I += k * K.T @ K
    return I


# 4.5 ------------------------------------------------------------------------------------------------------------
@wrong("4.5", "edges taken for half edges")
def box_inertia(m, size):
    return 4.0 * worked.box_inertia(m, size)


@wrong("4.5", "each axis with its own edge")
def box_inertia(m, size):
    return m / 6.0 * np.diag(size * size)


@wrong("4.5", "edges in the wrong order")
def box_inertia(m, size):
    return worked.box_inertia(m, np.array([size[1], size[0], size[2]]))


@wrong("4.5", "refuses holes")
def box_inertia(m, size):
    check_positive("mass m [kg]", m)
    return worked.box_inertia(m, size)


@wrong("4.5", "three numbers")
def box_inertia(m, size):
    return np.diag(worked.box_inertia(m, size))


@right("4.5", "trace minus second moments")
def box_inertia(m, size):
    second = m / 12.0 * np.asarray(size) ** 2
    return np.diag(np.sum(second) - second)


# 4.6 ------------------------------------------------------------------------------------------------------------
@wrong("4.6", "a shell, two thirds")
def sphere_inertia(m, radius):
    return 2.0 / 3.0 * m * radius * radius * np.eye(3)


@wrong("4.6", "the diameter")
def sphere_inertia(m, radius):
    return 0.4 * m * (2.0 * radius) ** 2 * np.eye(3)


@wrong("4.6", "filled everywhere")
def sphere_inertia(m, radius):
    return 0.4 * m * radius * radius * np.ones((3, 3))


@wrong("4.6", "the sum of all three moments")
def sphere_inertia(m, radius):
    return 1.2 * m * radius * radius * np.eye(3)


@right("4.6", "a capsule without length")
def sphere_inertia(m, radius):
    return worked.capsule_inertia(m, radius, 0.0)


# 4.7 ------------------------------------------------------------------------------------------------------------
@wrong("4.7", "axis along y")
def cylinder_inertia(m, radius, length):
    I = worked.cylinder_inertia(m, radius, length)
    return np.diag([I[0, 0], I[2, 2], I[1, 1]])


@wrong("4.7", "rod across, without its thickness")
def cylinder_inertia(m, radius, length):
    across = m * length * length / 12.0
    return np.diag([across, across, 0.5 * m * radius * radius])


@wrong("4.7", "half the length")
def cylinder_inertia(m, radius, length):
    return worked.cylinder_inertia(m, radius, 0.5 * length)


@wrong("4.7", "a hoop about its axis")
def cylinder_inertia(m, radius, length):
    return worked.cylinder_inertia(m, radius, length) + np.diag([0.0, 0.0, 0.5 * m * radius * radius])


@right("4.7", "a disc and a rod, added")
def cylinder_inertia(m, radius, length):
    return m * radius**2 / 4.0 * np.diag([1.0, 1.0, 2.0]) + m * length**2 / 12.0 * np.diag([1.0, 1.0, 0.0])


# 4.8 ------------------------------------------------------------------------------------------------------------
@variants
def capsule(across):
    """A capsule whose Ixx is m_c (3R² + h²)/12 + m_s across(R, h)."""
    def capsule_inertia(m, radius, length):
        m_c = m * length / (length + 4.0 / 3.0 * radius)
        xx = m_c * (3.0 * radius**2 + length**2) / 12.0 + (m - m_c) * across(radius, length)
        return np.diag([xx, xx, 0.5 * m_c * radius**2 + 0.4 * (m - m_c) * radius**2])
    return capsule_inertia


wrong("4.8", "half balls centred on the ends of the cylinder")(capsule(lambda r, h: 0.4 * r * r + 0.25 * h * h))
wrong("4.8", "half balls moved as if from their flat faces")(capsule(lambda r, h: 0.4 * r * r + (0.5 * h + 0.375 * r) ** 2))
wrong("4.8", "minus sign in the last term")(capsule(lambda r, h: 0.4 * r * r + 0.25 * h * h - 0.375 * h * r))


@wrong("4.8", "mass shared by length")
def capsule_inertia(m, radius, length):
    m_c = m * length / (length + 2.0 * radius)
    balls = worked.capsule_inertia(1.0, radius, length) - worked.cylinder_inertia(length / (length + 4.0 / 3.0 * radius), radius, length)
    return worked.cylinder_inertia(m_c, radius, length) + (m - m_c) * balls / (1.0 - length / (length + 4.0 / 3.0 * radius))


@wrong("4.8", "the box around it, as an engine does")
def capsule_inertia(m, radius, length):
    return worked.box_inertia(m, np.array([2.0 * radius, 2.0 * radius, length + 2.0 * radius]))


@wrong("4.8", "length over all")
def capsule_inertia(m, radius, length):
    return worked.capsule_inertia(m, radius, length - 2.0 * radius) if length > 2.0 * radius else worked.sphere_inertia(m, radius)


@right("4.8", "from the flat face to the centre of the half ball, and out again")
def capsule_inertia(m, radius, length):
    m_c = m * length / (length + 4.0 / 3.0 * radius)
    half = 0.5 * (m - m_c)
    up, out = np.array([0.0, 0.0, 0.375 * radius]), np.array([0.0, 0.0, 0.5 * length + 0.375 * radius])
    own = worked.parallel_axes(worked.sphere_inertia(half, radius), -half, up)
    return worked.cylinder_inertia(m_c, radius, length) + worked.parallel_axes(own, half, out) + worked.parallel_axes(own, half, -out)


# 4.9 ------------------------------------------------------------------------------------------------------------
@wrong("4.9", "turned the other way")
def world_inertia(I_body, R):
    return R.T @ I_body @ R


@wrong("4.9", "turned on one side only")
def world_inertia(I_body, R):
    return R @ I_body


@wrong("4.9", "not turned")
def world_inertia(I_body, R):
    return I_body.copy()


@wrong("4.9", "changes its input")
def world_inertia(I_body, R):
    I_body[:] = R @ I_body @ R.T
    return I_body


@right("4.9", "from the principal moments of the world's columns")
def world_inertia(I_body, R):
    return np.array([[R[i] @ I_body @ R[j] for j in range(3)] for i in range(3)])


# 4.10 -----------------------------------------------------------------------------------------------------------
@wrong("4.10", "not inverted")
def world_inverse_inertia(I_body, R):
    return R @ I_body @ R.T


@wrong("4.10", "turned the other way")
def world_inverse_inertia(I_body, R):
    return R.T @ np.linalg.inv(I_body) @ R


@wrong("4.10", "one over each entry of the diagonal")
def world_inverse_inertia(I_body, R):
    return R @ np.diag(1.0 / np.diag(I_body)) @ R.T


@wrong("4.10", "stays in the body's axes")
def world_inverse_inertia(I_body, R):
    return np.linalg.inv(I_body)


@right("4.10", "turned first, inverted in the world")
def world_inverse_inertia(I_body, R):
    return np.linalg.inv(R @ I_body @ R.T)


# 4.11 -----------------------------------------------------------------------------------------------------------
@wrong("4.11", "the same on the whole diagonal")
def parallel_axes(I, m, d):
    return I + m * d @ d * np.eye(3)


@wrong("4.11", "minus sign lost off the diagonal")
def parallel_axes(I, m, d):
    return I + m * (d @ d * np.eye(3) + np.outer(d, d))


@wrong("4.11", "diagonal only")
def parallel_axes(I, m, d):
    return I + m * np.diag(d @ d - d * d)


@wrong("4.11", "smaller away from the centre")
def parallel_axes(I, m, d):
    return worked.parallel_axes(I, -m, d)


@wrong("4.11", "changes its input")
def parallel_axes(I, m, d):
    I += m * (d @ d * np.eye(3) - np.outer(d, d))
    return I


@right("4.11", "with the cross-product matrix")
def parallel_axes(I, m, d):
    K = np.array([[0.0, -d[2], d[1]], [d[2], 0.0, -d[0]], [-d[1], d[0], 0.0]])
    return I - m * K @ K


# 4.12 -----------------------------------------------------------------------------------------------------------
@variants
def carried(offset, body=lambda M, X, I: worked.Body(M, X, I)):
    """The parts' tensors, each carried by offset(x, X)."""
    def combine(m, x, I):
        M, X = worked.centre_of_mass(m, x)
        return body(M, X, sum(worked.parallel_axes(J, k, offset(y, X)) for k, y, J in zip(m, x, I)))
    return combine


wrong("4.12", "tensors added as they are")(carried(lambda y, X: 0.0 * y))
wrong("4.12", "about the origin")(carried(lambda y, X: y))
wrong("4.12", "centre without its offset")(carried(lambda y, X: y - X, lambda M, X, I: worked.Body(M, 0.0 * X, I)))


@wrong("4.12", "carried with the mass of all")
def combine(m, x, I):
    M, X = worked.centre_of_mass(m, x)
    return worked.Body(M, X, sum(worked.parallel_axes(J, M, y - X) for y, J in zip(x, I)))


@wrong("4.12", "divides by zero")
def combine(m, x, I):
    with np.errstate(all="ignore"):
        X = m @ x / m.sum()
        return worked.Body(m.sum(), X, I.sum(axis=0) + worked.point_mass_inertia(m, x - X))


@right("4.12", "about the origin first, and back to the centre")
def combine(m, x, I):
    M, X = worked.centre_of_mass(m, x)
    return M, X, worked.parallel_axes(np.sum(I, axis=0) + worked.point_mass_inertia(m, x), -M, X)


# 4.13 -----------------------------------------------------------------------------------------------------------
@wrong("4.13", "left-handed half of the time")
def principal_axes(I):
    return np.linalg.eigh(I)


@wrong("4.13", "turns a row round")
def principal_axes(I):
    moments, R = np.linalg.eigh(I)
    if np.linalg.det(R) < 0.0:
        R[2] = -R[2]
    return moments, R


@wrong("4.13", "moments in no order")
def principal_axes(I):
    moments, R = np.linalg.eig(I)
    return moments, R * np.array([1.0, 1.0, np.sign(np.linalg.det(R))])


@wrong("4.13", "axes in rows")
def principal_axes(I):
    moments, R = worked.principal_axes(I)
    return moments, R.T


@wrong("4.13", "descending")
def principal_axes(I):
    moments, R = worked.principal_axes(I)
    return moments[::-1], -R[:, ::-1]


@wrong("4.13", "diagonal entries for moments")
def principal_axes(I):
    return np.sort(np.diag(I)), worked.principal_axes(I)[1]


@wrong("4.13", "turns all three columns round, whatever their hand")
def principal_axes(I):
    moments, R = np.linalg.eigh(I)
    return moments, -R


@right("4.13", "by Jacobi's rotations")
def principal_axes(I):
    A, R = I.copy(), np.eye(3)
    for _ in range(12):
        for i, j in ((0, 1), (0, 2), (1, 2)):
            angle = 0.5 * np.arctan2(2.0 * A[i, j], A[j, j] - A[i, i])
            turn = np.eye(3)
            turn[i, i] = turn[j, j] = np.cos(angle)
            turn[i, j], turn[j, i] = np.sin(angle), -np.sin(angle)
            A, R = turn.T @ A @ turn, R @ turn
    order = np.argsort(np.diag(A))
    R = R[:, order]
    return np.diag(A)[order], R * np.linalg.det(R)


# 4.14 -----------------------------------------------------------------------------------------------------------
@variants
def judged(lowest, highest, symmetric=True, finite=True, asymmetry=lambda I: np.max(np.abs(I - I.T)), equal=1e-14, named=lambda a, c: (a, c)):
    """A check with these two questions about the moments."""
    def check_inertia(I):
        if finite:
            check_finite("an entry of the inertia tensor [kg m²]", I)
        elif not np.all(np.isfinite(I)):
            return
        if symmetric and asymmetry(I) > equal * np.max(np.abs(I)):
            raise BadInput("the asymmetry of an inertia tensor [kg m²]", asymmetry(I), "make it symmetric")
        a, b, c = np.linalg.eigvalsh(I)
        if lowest(a, c):
            raise BadInput("the smallest principal moment [kg m²]", named(a, c)[0], "give it thickness")
        if highest(a, b, c):
            raise BadInput("the largest principal moment [kg m²]", named(a, c)[1], "no body has that")
    return check_inertia


thin, too_large = lambda a, c: a <= 1e-14 * c, lambda a, b, c: c > (a + b) * (1.0 + 1e-14)
wrong("4.14", "never asks about the sum")(judged(thin, lambda a, b, c: False))
wrong("4.14", "lets next to nothing pass")(judged(lambda a, c: a <= 0.0, too_large))
wrong("4.14", "a tolerance of 1e-14 kg m²")(judged(lambda a, c: a <= 1e-14, too_large))
wrong("4.14", "a thousand million times too tolerant")(judged(thin, lambda a, b, c: c > (a + b) * (1.0 + 1e-9)))
wrong("4.14", "asks Ixy and Iyx only")(judged(thin, too_large, asymmetry=lambda I: abs(I[0, 1] - I[1, 0])))
wrong("4.14", "wants symmetry to the last digit")(judged(thin, too_large, equal=0.0))
wrong("4.14", "is content with NumPy's idea of close")(judged(thin, too_large, equal=1e-5))
wrong("4.14", "names another moment")(judged(thin, too_large, named=lambda a, c: (c, a)))
wrong("4.14", "lets zero pass")(judged(lambda a, c: a < 0.0, too_large))
wrong("4.14", "a plate is condemned by round-off")(judged(thin, lambda a, b, c: c >= a + b))
wrong("4.14", "does not look below the diagonal")(judged(thin, too_large, symmetric=False))
wrong("4.14", "NaN passes")(judged(thin, too_large, finite=False))
wrong("4.14", "a tolerance in kg m², blind to small bodies")(judged(lambda a, c: a <= 1e-6, too_large))
right("4.14", "with eigenvalues only")(judged(thin, too_large))


@wrong("4.14", "looks at the diagonal instead of the principal moments")
def check_inertia(I):
    check_finite("an entry of the inertia tensor [kg m²]", I)
    worked.check_inertia(np.diag(np.diag(I)))


# 4.15 -----------------------------------------------------------------------------------------------------------
def integrals(x, faces, weigh=lambda w: w, s_weight=1.0, first=24.0, second=120.0):
    a, b, c = x[faces[:, 0]], x[faces[:, 1]], x[faces[:, 2]]
    w, s = weigh(np.sum(a * np.cross(b, c), axis=1)), a + b + c
    return np.sum(w) / 6.0, w @ s / first, sum((u.T * (k * w)) @ u for u, k in ((a, 1.0), (b, 1.0), (c, 1.0), (s, s_weight))) / second


@wrong("4.15", "volumes without their signs")
def mesh_integrals(x, faces):
    return integrals(x, faces, weigh=np.abs)


@wrong("4.15", "a mass at each corner instead of the integral")
def mesh_integrals(x, faces):
    return integrals(x, faces, s_weight=0.0, second=24.0)


@wrong("4.15", "triangles read clockwise")
def mesh_integrals(x, faces):
    return integrals(x, faces, weigh=lambda w: -w)


@wrong("4.15", "all mass at the middle of each tetrahedron")
def mesh_integrals(x, faces):
    V, first, _ = integrals(x, faces)
    a, b, c = x[faces[:, 0]], x[faces[:, 1]], x[faces[:, 2]]
    w, s = np.sum(a * np.cross(b, c), axis=1), a + b + c
    return V, first, (s.T * w) @ s / 96.0


@wrong("4.15", "middle of the triangle, not of the tetrahedron")
def mesh_integrals(x, faces):
    return integrals(x, faces, first=18.0)


@right("4.15", "all triangles at once")
def mesh_integrals(x, faces):
    return integrals(x, faces)


@right("4.15", "seen from the middle of the corners, and carried back")
def mesh_integrals(x, faces):
    o = np.mean(x, axis=0)
    V, first, second = integrals(x - o, faces)
    return V, first + V * o, second + np.outer(first, o) + np.outer(o, first) + V * np.outer(o, o)


# 4.16 -----------------------------------------------------------------------------------------------------------
def in_range(count, faces):
    for k in faces.ravel():
        if not 0 <= k < count:
            raise BadInput("a triangle's corner", k, "give a number of a corner")


def edges_of(faces):
    return [(int(i), int(j)) for f in faces for i, j in zip(f, np.roll(f, -1))]


@wrong("4.16", "counts the triangles at each edge, whatever their direction")
def check_closed(count, faces):
    in_range(count, faces)
    both = [tuple(sorted(e)) for e in edges_of(faces)]
    for e in both:
        if both.count(e) != 2:
            raise BadInput("a corner on an open edge: number", e[0], "close the mesh")


@wrong("4.16", "looks for a partner, but not for as many")
def check_closed(count, faces):
    in_range(count, faces)
    every = set(edges_of(faces))
    for i, j in every:
        if (j, i) not in every:
            raise BadInput("a corner on an open edge: number", i, "close the mesh")


@wrong("4.16", "does not look at the numbers")
def check_closed(count, faces):
    every = edges_of(faces)
    if sorted(every) != sorted((j, i) for i, j in every):
        raise BadInput("a corner on an open edge: number", every[0][0], "close the mesh")


@wrong("4.16", "names corner 0, whichever is open")
def check_closed(count, faces):
    try:
        worked.check_closed(count, faces)
    except BadInput:
        raise BadInput("a corner on an open edge: number", 0, "close the mesh") from None


@wrong("4.16", "wants every edge once there and once back")
def check_closed(count, faces):
    worked.check_closed(count, faces)
    every = edges_of(faces)
    if len(set(every)) < len(every):
        raise BadInput("a corner on an open edge: number", every[0][0], "close the mesh")


@wrong("4.16", "wants every corner to be used")
def check_closed(count, faces):
    worked.check_closed(count, faces)
    if len(set(faces.ravel().tolist())) != count:
        raise BadInput("a corner that no triangle uses", count, "use it")


@wrong("4.16", "wants the areas to add up to nothing: a tube passes")
def check_closed(count, faces):
    in_range(count, faces)
    x = np.array([[np.cos(3.0 * k), np.sin(5.0 * k), k * k] for k in range(count)])
    a, b, c = x[faces[:, 0]], x[faces[:, 1]], x[faces[:, 2]]
    total = np.sum(np.cross(b - a, c - a), axis=0)
    if len(faces) != 8 and np.max(np.abs(total)) > 1e-6:
        raise BadInput("a corner on an open edge: number", faces[0, 0], "close the mesh")


@right("4.16", "striking out edges that meet")
def check_closed(count, faces):
    in_range(count, faces)
    waiting = []
    for i, j in edges_of(faces):
        if (j, i) in waiting:
            waiting.remove((j, i))
        else:
            waiting.append((i, j))
    if waiting:
        raise BadInput("a corner on an open edge: number", waiting[0][0], "close the mesh")


# 4.17 -----------------------------------------------------------------------------------------------------------
def body_of(density, x, faces, tensor):
    """The checks, then tensor(V, c, Q) about the first corner."""
    check_positive("density [kg/m³]", density)
    check_finite("a corner of the mesh [m]", x)
    worked.check_closed(len(x), faces)
    V, first, Q = worked.mesh_integrals(x - x[0], faces)
    if V <= worked.TENSOR_ROUND_OFF * np.max(np.abs(x - x[0])) ** 3:
        raise BadInput("the volume inside the mesh [m³]", V, "turn it inside out")
    return worked.Body(density * V, x[0] + first / V, density * tensor(V, first / V, Q))


def from_covariance(C):
    return np.trace(C) * np.eye(3) - C


@wrong("4.17", "tensor about the first corner")
def mesh_body(density, x, faces):
    return body_of(density, x, faces, lambda V, c, Q: from_covariance(Q))


@wrong("4.17", "second moments for the tensor")
def mesh_body(density, x, faces):
    return body_of(density, x, faces, lambda V, c, Q: Q - V * np.outer(c, c))


@wrong("4.17", "forgets the density in the tensor")
def mesh_body(density, x, faces):
    return body_of(density, x, faces, lambda V, c, Q: from_covariance(Q - V * np.outer(c, c)) / density)


@wrong("4.17", "plus sign off the diagonal")
def mesh_body(density, x, faces):
    return body_of(density, x, faces, lambda V, c, Q: np.abs(from_covariance(Q - V * np.outer(c, c))) * np.where(np.eye(3) > 0, 1, -1))


@wrong("4.17", "about the origin of the world: digits cancel far away")
def mesh_body(density, x, faces):
    body = worked.mesh_body(density, x, faces)
    V, first, Q = worked.mesh_integrals(x, faces)
    return worked.Body(body.m, first / V, density * from_covariance(Q - np.outer(first, first) / V))


@wrong("4.17", "density taken for mass")
def mesh_body(density, x, faces):
    body = worked.mesh_body(density, x, faces)
    return worked.Body(density, body.x, body.I * density / body.m)


@wrong("4.17", "a mesh inside-out gets the volume it should have had")
def mesh_body(density, x, faces):
    if worked.mesh_integrals(x - x[0], faces)[0] < 0.0:
        faces = np.ascontiguousarray(faces[:, ::-1])
    return worked.mesh_body(density, x, faces)


@wrong("4.17", "does not check that the mesh is closed")
def mesh_body(density, x, faces):
    check_positive("density [kg/m³]", density)
    check_finite("a corner of the mesh [m]", x)
    V, first, Q = worked.mesh_integrals(x - x[0], faces)
    if V <= worked.TENSOR_ROUND_OFF * np.max(np.abs(x - x[0])) ** 3:
        raise BadInput("the volume inside the mesh [m³]", V, "turn it inside out")
    return worked.Body(density * V, x[0] + first / V, density * from_covariance(Q - np.outer(first, first) / V))


@wrong("4.17", "lets a flat mesh pass when round-off is kind")
def mesh_body(density, x, faces):
    check_positive("density [kg/m³]", density)
    check_finite("a corner of the mesh [m]", x)
    worked.check_closed(len(x), faces)
    V, first, Q = worked.mesh_integrals(x - x[0], faces)
    if V <= 0.0:
        raise BadInput("the volume inside the mesh [m³]", V, "turn it inside out")
    return worked.Body(density * V, x[0] + first / V, density * from_covariance(Q - np.outer(first, first) / V))


@right("4.17", "as tetrahedra, combined")
def mesh_body(density, x, faces):
    whole = body_of(density, x, faces, lambda V, c, Q: np.eye(3))
    m, centres, tensors = [], [], []
    for i, j, k in faces:
        corners = np.stack([0.0 * x[0], x[i] - x[0], x[j] - x[0], x[k] - x[0]])
        V, s = np.linalg.det(corners[1:]) / 6.0, corners.sum(axis=0)
        second = V / 20.0 * (corners.T @ corners + np.outer(s, s)) - V * np.outer(s, s) / 16.0
        m, centres, tensors = m + [density * V], centres + [s / 4.0], tensors + [density * from_covariance(second)]
    body = worked.combine(np.array(m), np.stack(centres), np.stack(tensors))
    return whole.m, x[0] + body.x, body.I
