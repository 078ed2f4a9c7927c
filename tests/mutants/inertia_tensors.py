"""Lesson 4: wrong signs, halves for wholes, tensors about the wrong point; and alternative right answers."""

import numpy as np

from solutions import inertia_tensors as worked
from solutions.checks import BadInput, check_finite, check_positive

from . import collection, variants

wrong, right, edit, MUTANTS = collection(worked)


# 4.1 ------------------------------------------------------------------------------------------------------------
@right("4.1", "pair by pair, each centre on the line between two")
def centre_of_mass(m, x):
    M, X = m[0], x[0]
    for k, y in zip(m[1:], x[1:], strict=True):
        M = M + k
        X = X + k / M * (y - X) if M != 0.0 else X
    check_positive("total mass [kg]", M)
    return M, X


edit("4.1", "takes the mean of the positions, regardless of the masses", "m @ x / M", "np.sum(x, axis=0) / m.size")
edit("4.1", "forgets to divide by the mass", "m @ x / M", "m @ x")
edit("4.1", "divides by the number of points", "m @ x / M", "m @ x / m.size")
edit("4.1", "divides by zero", 'check_positive("total mass [kg]", M)', "pass")
POSITIVE = 'check_positive("total mass [kg]", M)'
edit("4.1", "refuses a hole among the points", POSITIVE, 'for k in m: check_positive("mass [kg]", k)')
edit("4.1", "accepts NaN", POSITIVE, 'if M <= 0.0: raise BadInput("total mass [kg]", M, "give some")')
edit("4.1", "accepts infinity", POSITIVE, 'if not M > 0.0: raise BadInput("total mass [kg]", M, "give some")')
edit("4.1", "refuses less than a microgram", POSITIVE, 'check_positive("total mass [kg]", M if M > 1e-9 else 0.0)')
edit("4.1", "refuses less than a molecule", POSITIVE, 'check_positive("total mass [kg]", M if M > 1e-20 else 0.0)')
edit("4.1", "refuses a body that consists almost entirely of holes", POSITIVE,
     'check_positive("total mass [kg]", M if M > 1e-3 * np.sum(np.abs(m)) else 0.0)')
edit("4.1", "returns zero for coordinates below 1 nm",
     "m @ x / M", "np.where(np.abs(m @ x / M) < 1e-9, 0.0, m @ x / M)")
edit("4.1", "uses the sizes of the masses, so that holes count as mass", "np.sum(m)", "np.sum(np.abs(m))")
edit("4.1", "multiplies by the total mass", "m @ x / M", "m @ x * M")
edit("4.1", "uses the first hundred points only", "m @ x / M", "m[:100] @ x[:100] / M")
edit("4.1", "checks no mass where there is one point only", "M = np.sum(m)",
     "M = np.sum(m)\n    if m.size == 1: return M, x[0].copy()")
edit("4.1", "names another thing in the error", "total mass [kg]", "mass of a point [kg]")


# 4.2 ------------------------------------------------------------------------------------------------------------
@right("4.2", "mass by mass")
def linear_momentum(m, v):
    P = np.zeros(3)
    for k, w in zip(m, v, strict=True):
        P = P + k * w
    return P


edit("4.2", "forgets the masses", "m @ v", "np.sum(v, axis=0)")
edit("4.2", "multiplies the total mass by the mean velocity", "m @ v", "np.sum(m) * np.sum(v, axis=0) / m.size")
edit("4.2", "uses the absolute values of the velocities", "m @ v", "m @ np.abs(v)")
edit("4.2", "returns the velocity of the centre of mass", "m @ v", "m @ v / np.sum(m)")
edit("4.2", "calls centre_of_mass, which refuses a total mass of zero", "m @ v", "np.sum(m) * centre_of_mass(m, v)[1]")
HOLE_IS_A_BODY = edit("4.2", "counts a hole as a body: uses the size of its mass", "m @ v", "np.abs(m) @ v")
edit("4.2", "refuses holes", "return m @ v", '[check_positive("mass [kg]", k) for k in m]; return m @ v')
edit("4.2", "returns zero for components below 1e-9 kg m/s", "m @ v", "np.where(np.abs(m @ v) < 1e-9, 0.0, m @ v)")
edit("4.2", "reverses the sign", "m @ v", "-(m @ v)")
edit("4.2", "divides by the masses", "return m @ v", "return (1.0 / m) @ v")
edit("4.2", "uses the first hundred points only", "m @ v", "m[:100] @ v[:100]")
edit("4.2", "takes a mass below a microgram for none", "return m @ v",
     "m = np.where(np.abs(m) < 1e-9, 0.0, m); return m @ v")


# 4.3 ------------------------------------------------------------------------------------------------------------
@right("4.3", "about the origin, and the arm of the whole")
def angular_momentum(m, x, v, about):
    return m @ np.cross(x, v) - np.cross(about, m @ v)


V_CROSS_R = edit("4.3", "takes v × r in place of r × v", "cross(x[n] - about, v[n])", "cross(v[n], x[n] - about)")
ABOUT_THE_ORIGIN = edit("4.3", "takes L about the origin, regardless of the point `about`", "x[n] - about", "x[n]")
edit("4.3", "forgets the masses", "m[n] * cross", "cross")
edit("4.3", "takes L about the centre of mass, regardless of the point `about`",
     "x[n] - about", "x[n] - m @ x / np.sum(m)")
edit("4.3", "refuses a total mass of zero or less", "L = np.zeros(3)",
     'check_positive("total mass [kg]", np.sum(m)); L = np.zeros(3)')
edit("4.3", "counts a hole as a body: uses the size of its mass", "m[n] * cross", "abs(m[n]) * cross")
edit("4.3", "ignores holes", "m[n] * cross", "max(0.0, m[n]) * cross")
edit("4.3", "uses the velocities relative to the centre of mass", "v[n])", "v[n] - m @ v / np.sum(m))")
edit("4.3", "measures the arm from the point to the reference point", "x[n] - about", "about - x[n]")
edit("4.3", "adds the reference point", "x[n] - about", "x[n] + about")
edit("4.3", "keeps the last point only", "L += m", "L = m")
edit("4.3", "divides by the mass", "L += m[n] * c", "L += 1.0 / m[n] * c")
edit("4.3", "takes the dot product in every component", "cross(x[n] - about, v[n])", "(x[n] - about) * v[n]")
edit("4.3", "uses the velocities relative to their mean", "v[n])", "v[n] - np.sum(v, axis=0) / m.size)")
edit("4.3", "subtracts the place of the reference point from the velocities, too", "v[n])", "v[n] - about)")
edit("4.3", "takes the centre of mass where the reference point is the origin", "L = np.zeros(3)",
     "L, about = np.zeros(3), about if about.any() else m @ x / np.sum(m)")
edit("4.3", "uses the first hundred points only", "range(m.size)", "range(min(m.size, 100))")
edit("4.3", "takes a mass below a microgram for none", "L = np.zeros(3)",
     "m = np.where(np.abs(m) < 1e-9, 0.0, m); L = np.zeros(3)")
edit("4.3", "takes a point slower than 1 µm/s for one at rest", "L = np.zeros(3)",
     "v = np.where(np.abs(v) < 1e-6, 0.0, v); L = np.zeros(3)")


# 4.4 ------------------------------------------------------------------------------------------------------------
@right("4.4", "minus the squared cross-product matrices")
def point_mass_inertia(m, r):
    I = np.zeros((3, 3))
    for k, (x, y, z) in zip(m, r, strict=True):
        K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        I += k * K.T @ K
    return I


TENSOR = "[[yy + zz, -xy, -xz], [-xy, xx + zz, -yz], [-xz, -yz, xx + yy]]"
edit("4.4", "omits the minus signs off the diagonal", TENSOR, TENSOR.replace("-", ""))
edit("4.4", "returns the second moments, Σ m r rᵀ, in place of the tensor",
     TENSOR, "[[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]")
edit("4.4", "omits the entries off the diagonal",
     TENSOR, "[[yy + zz, 0.0, 0.0], [0.0, xx + zz, 0.0], [0.0, 0.0, xx + yy]]")
edit("4.4", "uses the distance from the point, not from each axis", TENSOR, "np.eye(3) * (xx + yy + zz)")
edit("4.4", "counts a hole as a body: uses the size of its mass", "xx, yy, zz =", "m = np.abs(m); xx, yy, zz =")
edit("4.4", "refuses a total mass of zero or less", "xx, yy, zz =",
     'check_positive("total mass [kg]", np.sum(m)); xx, yy, zz =')
edit("4.4", "treats coordinates below 1 nm as zero",
     "xx, yy, zz =", "r = np.where(np.abs(r) < 1e-9, 0.0, r); xx, yy, zz =")
edit("4.4", "puts x² in Ixx, not y² + z²",
     "[[yy + zz, -xy, -xz], [-xy, xx + zz, -yz], [-xz, -yz, xx + yy]]",
     "[[xx, -xy, -xz], [-xy, yy, -yz], [-xz, -yz, zz]]")
edit("4.4", "forgets the masses",
     "np.sum(m * r[:, 0] * r[:, 0]), np.sum(m * r[:, 1] * r[:, 1]), np.sum(m * r[:, 2] * r[:, 2])",
     "np.sum(r[:, 0] * r[:, 0]), np.sum(r[:, 1] * r[:, 1]), np.sum(r[:, 2] * r[:, 2])")
edit("4.4", "subtracts the squares on the diagonal", "xx + yy]]", "xx - yy]]")
edit("4.4", "exchanges the moments of the first two axes",
     "[[yy + zz, -xy, -xz], [-xy, xx + zz, -yz]", "[[xx + zz, -xy, -xz], [-xy, yy + zz, -yz]")
edit("4.4", "exchanges Ixz and Iyz",
     "[[yy + zz, -xy, -xz], [-xy, xx + zz, -yz], [-xz, -yz, xx + yy]]",
     "[[yy + zz, -xy, -yz], [-xy, xx + zz, -xz], [-yz, -xz, xx + yy]]")
edit("4.4", "fills the upper half only",
     "[-xy, xx + zz, -yz], [-xz, -yz, xx + yy]]", "[0.0, xx + zz, -yz], [0.0, 0.0, xx + yy]]")
edit("4.4", "adds r rᵀ in place of subtracting it", "[[yy + zz, -xy, -xz], [-xy, xx + zz, -yz], [-xz, -yz, xx + yy]]",
     "[[2.0*xx + yy + zz, xy, xz], [xy, xx + 2.0*yy + zz, yz], [xz, yz, xx + yy + 2.0*zz]]")
edit("4.4", "gives a single point no tensor", "xx, yy, zz =", "m = m * (m.size > 1); xx, yy, zz =")
edit("4.4", "takes a mass below a microgram for none", "xx, yy, zz =",
     "m = np.where(np.abs(m) < 1e-9, 0.0, m); xx, yy, zz =")


# 4.5 ------------------------------------------------------------------------------------------------------------
@right("4.5", "trace minus second moments")
def box_inertia(m, size):
    second = m / 12.0 * np.asarray(size) ** 2
    return np.diag(np.sum(second) - second)


edit("4.5", "divides by 3, not by 12: takes the edges for half edges, or integrates from 0 to the edge",
     "m / 12.0", "m / 3.0")
edit("4.5", "uses each axis's own edge in place of the two others",
     "[bb + cc, aa + cc, aa + bb]", "[2.0 * aa, 2.0 * bb, 2.0 * cc]")
edit("4.5", "exchanges the edges of the first two axes", "[bb + cc, aa + cc, aa + bb]", "[aa + cc, bb + cc, aa + bb]")
edit("4.5", "refuses holes", "m / 12.0", '(check_positive("mass m [kg]", m) or m) / 12.0')
edit("4.5", "refuses a plate", "m / 12.0", '(check_positive("edge [m]", np.min(size)) or m) / 12.0')
edit("4.5", "refuses what is smaller than a tenth of a millimetre", "m / 12.0",
     '(check_positive("edge [m]", np.max(size) - 1e-4) or m) / 12.0')
edit("4.5", "returns the three moments, not the tensor",
     "np.diag(np.array([bb + cc, aa + cc, aa + bb]))", "np.array([bb + cc, aa + cc, aa + bb])")
edit("4.5", "forgets the squares",
     "size[0] * size[0], size[1] * size[1], size[2] * size[2]", "size[0], size[1], size[2]")
edit("4.5", "forgets the mass", "m / 12.0", "1.0 / 12.0")
edit("4.5", "subtracts the squares", "[bb + cc, aa + cc, aa + bb]", "[bb - cc, aa - cc, aa - bb]")
edit("4.5", "divides by 6 in place of 12", "12.0", "6.0")
edit("4.5", "takes an edge below a thousandth of the longest for none", "aa, bb, cc =",
     "size = np.where(size < 1e-3 * np.max(size), 0.0, size); aa, bb, cc =")


# 4.6 ------------------------------------------------------------------------------------------------------------
@right("4.6", "a capsule without length")
def sphere_inertia(m, radius):
    return worked.capsule_inertia(m, radius, 0.0)


HOLLOW_SPHERE = edit("4.6", "uses the factor 2/3 of a hollow sphere", "0.4 * m", "2.0 / 3.0 * m")
edit("4.6", "uses the diameter in place of the radius", "radius * radius", "4.0 * radius * radius")
edit("4.6", "fills the whole matrix, not only its diagonal", "np.eye(3)", "np.ones((3, 3))")
edit("4.6", "returns the sum of the three moments on the diagonal", "0.4 * m", "1.2 * m")
edit("4.6", "counts a hole as a body: uses the size of its mass", "0.4 * m", "0.4 * abs(m)")
edit("4.6", "refuses what is smaller than a nanometre", "0.4 * m",
     '0.4 * (check_positive("radius [m]", radius - 1e-9) or m)')
edit("4.6", "refuses holes", "0.4 * m", '0.4 * (check_positive("mass m [kg]", m) or m)')
edit("4.6", "forgets the square of the radius", "radius * radius", "radius")
edit("4.6", "forgets the mass", "0.4 * m", "0.4")
edit("4.6", "uses the factor 1/2 of a disc", "0.4", "0.5")
edit("4.6", "uses the factor 3/5", "0.4", "0.6")
edit("4.6", "cubes the radius", "radius * radius", "radius**3")
edit("4.6", "takes a mass below a microgram for none", "return 0.4 * m",
     "m = np.where(np.abs(m) < 1e-9, 0.0, m); return 0.4 * m")


# 4.7 ------------------------------------------------------------------------------------------------------------
@right("4.7", "a disc and a rod, added")
def cylinder_inertia(m, radius, length):
    return m * radius**2 / 4.0 * np.diag([1.0, 1.0, 2.0]) + m * length**2 / 12.0 * np.diag([1.0, 1.0, 0.0])


edit("4.7", "takes the cylinder's axis along y",
     "across, 0.5 * m * radius * radius", "0.5 * m * radius * radius, across")
edit("4.7", "omits the radius in the moments across the axis",
     "3.0 * radius * radius + length * length", "length * length")
edit("4.7", "uses half of the length", "length * length", "0.25 * length * length")
edit("4.7", "uses the moment of a hoop about the axis", "0.5 * m * radius * radius", "m * radius * radius")
edit("4.7", "refuses holes", "across = m", 'check_positive("mass m [kg]", m); across = m')
edit("4.7", "refuses a disc", "across = m", 'check_positive("length [m]", length); across = m')
edit("4.7", "refuses a rod", "across = m", 'check_positive("radius [m]", radius); across = m')
edit("4.7", "treats a cylinder shorter than 1 nm as a disc", "length * length", "length * length * (length > 1e-9)")
edit("4.7", "divides by the length, which is zero for a disc", "across = m", "m = m / length * length; across = m")
edit("4.7", "divides by the radius, which is zero for a rod", "across = m", "m = m / radius**2 * radius**2; across = m")
edit("4.7", "uses the axis's moment for all three axes",
     "[across, across, 0.5", "[0.5 * m * radius * radius, 0.5 * m * radius * radius, 0.5")
edit("4.7", "takes the cylinder's axis along x",
     "np.array([across, across, 0.5 * m * radius * radius])", "np.array([0.5 * m * radius * radius, across, across])")
edit("4.7", "exchanges radius and length", "across = m", "radius, length = length, radius; across = m")
edit("4.7", "takes the radius for the diameter", "across = m", "radius = 0.5 * radius; across = m")
edit("4.7", "takes the diameter for the radius", "across = m", "radius = 2.0 * radius; across = m")
THIN_CYLINDER = edit("4.7", "gives the radius the same weight as the length across the axis",
                     "3.0 * radius * radius + length", "radius * radius + length")
edit("4.7", "takes the moments about the end, not about the centre",
     "across = m * (3.0 * radius * radius + length * length) / 12.0",
     "across = m * (3.0 * radius * radius + 4.0 * length * length) / 12.0")
edit("4.7", "forgets the square of the length", "length * length", "length")
edit("4.7", "exchanges the moment about the axis with those across it", "[across, across, 0.5 * m * radius * radius]",
     "[0.5 * m * radius * radius, 0.5 * m * radius * radius, across]")
edit("4.7", "takes a mass below a microgram for none", "across = m",
     "m = np.where(np.abs(m) < 1e-9, 0.0, m); across = m")
edit("4.7", "takes a thin cylinder for a rod", "across = m", "radius = radius * (radius > 1e-3 * length); across = m")
edit("4.7", "takes a short cylinder for a disc", "across = m", "length = length * (length > 2e-3 * radius); across = m")
edit("4.7", "takes a cylinder to be at least as long as its radius, or a disc", "across = m",
     "length = max(length, radius) if length else 0.0; across = m")


# 4.8 ------------------------------------------------------------------------------------------------------------
@variants
def capsule(across=lambda r, h: 0.4 * r * r + 0.25 * h * h + 0.375 * h * r):
    """A capsule whose Ixx is m_c (3R² + h²)/12 + m_s across(R, h)."""
    def capsule_inertia(m, radius, length):
        m_c = m * length / (length + 4.0 / 3.0 * radius)
        xx = m_c * (3.0 * radius**2 + length**2) / 12.0 + (m - m_c) * across(radius, length)
        return np.diag([xx, xx, 0.5 * m_c * radius**2 + 0.4 * (m - m_c) * radius**2])
    return capsule_inertia


wrong("4.8", "puts the centres of the half balls at the ends of the cylinder")(
    capsule(lambda r, h: 0.4 * r * r + 0.25 * h * h))
wrong("4.8", "moves the half balls as if their moments were about their own centres")(
    capsule(lambda r, h: 0.4 * r * r + (0.5 * h + 0.375 * r) ** 2))
wrong("4.8", "subtracts the last term of the half balls")(
    capsule(lambda r, h: 0.4 * r * r + 0.25 * h * h - 0.375 * h * r))


@right("4.8", "from the flat face to the centre of the half ball, and out again")
def capsule_inertia(m, radius, length):
    m_c = m * length / (length + 4.0 / 3.0 * radius)
    half = 0.5 * (m - m_c)
    up, out = np.array([0.0, 0.0, 0.375 * radius]), np.array([0.0, 0.0, 0.5 * length + 0.375 * radius])
    own = worked.parallel_axes(worked.sphere_inertia(half, radius), -half, up)
    halves = worked.parallel_axes(own, half, out) + worked.parallel_axes(own, half, -out)
    return worked.cylinder_inertia(m_c, radius, length) + halves


edit("4.8", "divides the mass by length, not by volume", "4.0 / 3.0 * radius", "2.0 * radius")
edit("4.8", "uses the box around the capsule",
     "np.diag(np.array([across, across, 0.5 * m_c * rr + 0.4 * m_s * rr]))",
     "box_inertia(m, np.array([2.0 * radius, 2.0 * radius, length + 2.0 * radius]))")
edit("4.8", "takes the length for the length over all",
     "rr, hh =", "length = max(0.0, length - 2.0 * radius); rr, hh =")
edit("4.8", "refuses holes", "m_c = m", 'check_positive("mass m [kg]", m); m_c = m')
edit("4.8", "refuses a rod", "m_c = m", 'check_positive("radius [m]", radius); m_c = m')
edit("4.8", "divides by the volume, which is zero for a rod", "length / (length + 4.0 / 3.0 * radius)",
     "(np.pi * rr * length) / (np.pi * rr * length + 4.0 / 3.0 * np.pi * rr * radius)")
edit("4.8", "uses a length of at least 1 pm in the denominator",
     "(length + 4.0 / 3.0 * radius)", "max(length + 4.0 / 3.0 * radius, 1e-12)")
edit("4.8", "never divides by zero", "(length + 4.0 / 3.0 * radius)", "(length + 4.0 / 3.0 * radius + 1e-24)")
edit("4.8", "treats a thin capsule as a rod", "length / (length + 4.0 / 3.0 * radius)",
     "(1.0 if radius < 1e-2 * length else length / (length + 4.0 / 3.0 * radius))")
edit("4.8", "treats a short capsule as a ball",
     "m_c = m * length", "m_c = 0.0 if length < 1e-3 * radius else m * length")
edit("4.8", "treats a capsule shorter than 1 µm as a ball",
     "m_c = m * length", "m_c = 0.0 if length < 1e-6 else m * length")
edit("4.8", "gives each half ball the mass of both", "m_s = m - m_c", "m_s = 2.0 * (m - m_c)")
edit("4.8", "takes half of the mass of the half balls", "m_s = m - m_c", "m_s = 0.5 * (m - m_c)")
edit("4.8", "takes the capsule's axis along x",
     "np.array([across, across, 0.5 * m_c * rr + 0.4 * m_s * rr])",
     "np.array([0.5 * m_c * rr + 0.4 * m_s * rr, across, across])")
edit("4.8", "does not move the half balls", "(0.4 * rr + 0.25 * hh + 0.375 * length * radius)", "0.4 * rr")
edit("4.8", "moves the half balls by the whole length", "0.25 * hh", "hh")
edit("4.8", "puts the centre of a half ball at half of its height", "0.375 * length", "0.5 * length")
edit("4.8", "omits the half balls in the moment about the axis", "+ 0.4 * m_s * rr]", "]")
edit("4.8", "gives both half balls together the volume of one", "4.0 / 3.0", "2.0 / 3.0")
edit("4.8", "exchanges the two masses", "m_s = m - m_c", "m_s = m_c; m_c = m - m_c")
edit("4.8", "measures the half ball's centre from its pole", "0.375 * length", "0.625 * length")
edit("4.8", "takes a mass below a microgram for none", "rr, hh =",
     "m = np.where(np.abs(m) < 1e-9, 0.0, m); rr, hh =")


# 4.9 ------------------------------------------------------------------------------------------------------------
@right("4.9", "from the principal moments of the world's columns")
def world_inertia(I_body, R):
    return np.array([[R[i] @ I_body @ R[j] for j in range(3)] for i in range(3)])


TRANSPOSED_ROTATION = edit("4.9", "takes Rᵀ I R in place of R I Rᵀ", "R @ I_body @ R.T", "R.T @ I_body @ R")
edit("4.9", "takes R I in place of R I Rᵀ", "R @ I_body @ R.T", "R @ I_body")
edit("4.9", "returns the tensor in the body's axes", "R @ I_body @ R.T", "I_body.copy()")
edit("4.9", "refuses holes", "return R", 'check_positive("a moment [kg m²]", np.trace(I_body)); return R')
edit("4.9", "changes its input", "R @ I_body @ R.T", "np.matmul(R @ I_body, R.T, out=I_body)")
edit("4.9", "forgets the transpose at the end", "R @ I_body @ R.T", "R @ I_body @ R")
edit("4.9", "multiplies entry by entry", "R @ I_body @ R.T", "R * I_body * R.T")
edit("4.9", "multiplies by the transpose only", "R @ I_body @ R.T", "I_body @ R.T")
edit("4.9", "does not rotate a tensor without entries off the diagonal", "R @ I_body @ R.T",
     "R @ I_body @ R.T if np.any(I_body != np.diag(np.diag(I_body))) else I_body.copy()")
edit("4.9", "rounds to twelve decimals", "R @ I_body @ R.T", "np.round(R @ I_body @ R.T, 12)")
edit("4.9", "takes entries below 1e-9 kg m² for zero", "return R",
     "I_body = np.where(np.abs(I_body) < 1e-9, 0.0, I_body); return R")


# 4.10 -----------------------------------------------------------------------------------------------------------
@right("4.10", "turned first, inverted in the world")
def world_inverse_inertia(I_body, R):
    return np.linalg.inv(R @ I_body @ R.T)


edit("4.10", "returns the tensor, not its inverse", "inverse(I_body)", "I_body")
edit("4.10", "uses Rᵀ in place of R", "inverse(I_body), R)", "inverse(I_body), R.T)")
edit("4.10", "inverts the entries of the diagonal only", "inverse(I_body)", "np.diag(1.0 / np.diag(I_body))")
edit("4.10", "returns the inverse in the body's axes", "world_inertia(inverse(I_body), R)", "inverse(I_body)")
edit("4.10", "returns a pseudo-inverse where there is no inverse", "inverse(I_body)", "np.linalg.pinv(I_body)")
edit("4.10", "refuses small inputs", "inverse(I_body)",
     "inverse(I_body if abs(np.linalg.det(I_body)) > 1e-12 else 0.0 * I_body)")
edit("4.10", "rotates by R and R, without the transpose",
     "world_inertia(inverse(I_body), R)", "R @ inverse(I_body) @ R")
edit("4.10", "inverts the matrix entry by entry", "inverse(I_body)", "1.0 / (I_body + 0.0)")
edit("4.10", "takes R I⁻¹ without the transpose", "world_inertia(inverse(I_body), R)", "R @ inverse(I_body)")
edit("4.10", "does not rotate a tensor without entries off the diagonal", "R)",
     "R if np.any(I_body != np.diag(np.diag(I_body))) else np.eye(3))")
edit("4.10", "refuses holes", "return world", 'check_positive("a moment [kg m²]", np.trace(I_body)); return world')


# 4.11 -----------------------------------------------------------------------------------------------------------
@right("4.11", "with the cross-product matrix")
def parallel_axes(I, m, d):
    K = np.array([[0.0, -d[2], d[1]], [d[2], 0.0, -d[0]], [-d[1], d[0], 0.0]])
    return I - m * K @ K


POINT = "point_mass_inertia(np.array([m]), d.reshape(1, 3))"
edit("4.11", "adds m d² to the whole diagonal and nothing else", POINT, "m * d @ d * np.eye(3)")
edit("4.11", "adds d dᵀ in place of subtracting it", POINT, "m * (d @ d * np.eye(3) + np.outer(d, d))")
edit("4.11", "omits the entries off the diagonal", POINT, "m * np.diag(d @ d - d * d)")
edit("4.11", "subtracts the term in place of adding it", "I + point", "I - point")
edit("4.11", "refuses holes", "return I", 'check_positive("a moment [kg m²]", np.trace(I)); return I')
edit("4.11", "treats offsets below 1 µm as zero", "return I", "d = np.where(np.abs(d) < 1e-6, 0.0, d); return I")
edit("4.11", "changes its input", f"I + {POINT}", f"np.add(I, {POINT}, out=I)")
edit("4.11", "forgets the mass", "np.array([m])", "np.ones(1)")
edit("4.11", "returns the added term only", "return I + point", "return point")
edit("4.11", "does not square the distance", "d.reshape(1, 3)", "(np.sign(d) * np.sqrt(np.abs(d))).reshape(1, 3)")
edit("4.11", "adds the squares of d on the diagonal of their own axes",
     "point_mass_inertia(np.array([m]), d.reshape(1, 3))", "m * np.diag(d * d)")
edit("4.11", "omits |d|²: subtracts m d dᵀ only",
     "point_mass_inertia(np.array([m]), d.reshape(1, 3))", "-m * np.outer(d, d)")
edit("4.11", "omits the term for an offset along an axis", "return I +", "return I + (np.sum(d != 0.0) > 1) *")
edit("4.11", "takes a mass below a microgram for none", "return I +",
     "m = np.where(np.abs(m) < 1e-9, 0.0, m); return I +")


# 4.12 -----------------------------------------------------------------------------------------------------------
@variants
def carried(offset=lambda y, X: y - X, body=lambda M, X, I: worked.MassProperties(M, X, I)):
    """The parts' tensors, each shifted by offset(x, X)."""
    def combine(m, x, I):
        M, X = worked.centre_of_mass(m, x)
        return body(M, X, sum(worked.parallel_axes(J, k, offset(y, X)) for k, y, J in zip(m, x, I, strict=True)))
    return combine


wrong("4.12", "adds the tensors without moving them to the common centre")(carried(lambda y, X: 0.0 * y))
wrong("4.12", "returns the tensor about the origin")(carried(lambda y, X: y))
wrong("4.12", "puts the centre of each part at the origin")(
    carried(body=lambda M, X, I: worked.MassProperties(M, 0.0 * X, I)))


@variants
def gathered(reference=lambda x: x[0]):
    """The parts' tensors about a reference point first, and back to the centre."""
    def combine(m, x, I):
        M, X = worked.centre_of_mass(m, x)
        o = reference(x)
        whole = np.sum(I, axis=0) + worked.point_mass_inertia(m, x - o)
        return worked.MassProperties(M, X, worked.parallel_axes(whole, -M, X - o))
    return combine


wrong("4.12", "sums about the world's origin first, which loses digits far away")(gathered(lambda x: 0.0 * x[0]))


@variants
def one_by_one(centre=lambda m, x: (np.sum(m), m @ x / np.sum(m))):
    """Two bodies become one, which is joined with the third, and so on."""
    def combine(m, x, I):
        worked.centre_of_mass(m, x)
        M, X, whole = m[0], x[0], I[0]
        for k, y, J in zip(m[1:], x[1:], I[1:], strict=True):
            both, middle = centre(np.array([M, k]), np.stack((X, y)))
            whole = worked.parallel_axes(whole, M, X - middle) + worked.parallel_axes(J, k, y - middle)
            M, X = both, middle
        return worked.MassProperties(M, X, whole)
    return combine


wrong("4.12", "combines the parts one by one, which fails where the first ones have no mass")(
    one_by_one(worked.centre_of_mass))


edit("4.12", "moves each tensor with the total mass", "m[n]", "M")
edit("4.12", "uses the first three bodies only", "range(m.size)", "range(min(3, m.size))")
edit("4.12", "divides by zero", "centre_of_mass(m, x)", "np.sum(m), m @ x / np.sum(m)")
edit("4.12", "refuses a mass of zero only", "centre_of_mass(m, x)",
     "centre_of_mass(m, x) if np.sum(m) == 0.0 else (np.sum(m), m @ x / np.sum(m))")
edit("4.12", "changes its input", "parallel_axes(I[n], m[n], x[n] - X)",
     "np.add(I[n], parallel_axes(0.0 * I[n], m[n], x[n] - X), out=I[n])")
edit("4.12", "omits the tensor of a body without mass", "total += parallel_axes(",
     "total += 0.0 if m[n] == 0.0 else parallel_axes(")
edit("4.12", "returns a plain tuple, not MassProperties", "MassProperties(M, X, total)", "(M, X, total)")
edit("4.12", "reverses the sign of the mass in the added term", "m[n], x[n] - X", "-m[n], x[n] - X")
edit("4.12", "keeps the last body only", "total += p", "total = p")
edit("4.12", "moves the tensors by the sum of the positions", "x[n] - X", "x[n] + X")
edit("4.12", "omits the tensors of the parts, as if they were points",
     "parallel_axes(I[n], m", "parallel_axes(0.0 * I[n], m")
edit("4.12", "uses the first hundred bodies only", "range(m.size)", "range(min(100, m.size))")
edit("4.12", "gives a body alone no tensor", "parallel_axes(I[n]", "parallel_axes(I[n] * (m.size > 1)")
edit("4.12", "takes a mass below a microgram for none", "total = np.zeros((3, 3))",
     "m = np.where(np.abs(m) < 1e-9, 0.0, m); total = np.zeros((3, 3))")
edit("4.12", "takes centres within a micrometre of the common one to be there", "total = np.zeros((3, 3))",
     "x = np.where(np.abs(x - X) < 1e-6, X, x); total = np.zeros((3, 3))")
edit("4.12", "refuses less than a microgram", "total = np.zeros((3, 3))",
     'check_positive("total mass [kg]", M if M > 1e-9 else 0.0); total = np.zeros((3, 3))')


# 4.13 -----------------------------------------------------------------------------------------------------------
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


edit("4.13", "does not make the axes right-handed", "dot(R[:, 0], cross(R[:, 1], R[:, 2])) < 0.0", "False")
edit("4.13", "reverses a row", "R[:, 2] = -R[:, 2]", "R[2] = -R[2]")
edit("4.13", "returns the moments without their signs", "return moments, R",
     "return np.abs(moments), R")
edit("4.13", "replaces negative moments by zero", "return moments, R", "return np.maximum(moments, 0.0), R")
edit("4.13", "does not sort the moments", "np.linalg.eigh(I)", "np.linalg.eig(I)")
edit("4.13", "returns the axes as rows, not as columns", "return moments, R", "return moments, R.T")
edit("4.13", "sorts the moments in descending order", "return moments, R", "return moments[::-1], -R[:, ::-1]")
edit("4.13", "returns the entries of the diagonal as moments", "return moments, R", "return np.sort(np.diag(I)), R")
edit("4.13", "reverses all three columns at the end", "return moments, R", "return moments, -R")
edit("4.13", "tests the determinant the other way", "< 0.0", "> 0.0")
edit("4.13", "returns the moments without their signs", "return moments, R", "return np.abs(moments), R")
edit("4.13", "reverses the last row, not the last column", "R[:, 2] = -R[:, 2]", "R[2] = -R[2]")
edit("4.13", "takes a body with equal moments about x, y and z for a ball", "moments, R = np.linalg.eigh(I)",
     "moments, R = (np.diag(I).copy(), np.eye(3)) if np.ptp(np.diag(I)) == 0.0 else np.linalg.eigh(I)")
edit("4.13", "takes a tensor without the product xy for diagonal", "np.linalg.eigh(I)",
     "np.linalg.eigh(I if I[0, 1] != 0.0 else np.diag(np.diag(I)))")
edit("4.13", "takes the small moment of a needle for zero", "return moments, R",
     "return np.where(np.abs(moments) < 1e-10 * np.max(np.abs(moments)), 0.0, moments), R")


# 4.14 -----------------------------------------------------------------------------------------------------------
@variants
def judged(lowest=lambda a, c: a <= 1e-14 * c, highest=lambda a, b, c: c > (a + b) * (1.0 + 1e-14), symmetric=True,
           finite=True,
           asymmetry=lambda I: np.max(np.abs(I - I.T)), equal=1e-14, named=lambda a, c: (a, c)):
    """A check with these two tests of the moments."""
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


wrong("4.14", "does not test the sum")(judged(highest=lambda a, b, c: False))
wrong("4.14", "accepts moments near zero")(judged(lambda a, c: a <= 0.0))
wrong("4.14", "compares the smallest moment with an absolute 1e-14 kg m²")(judged(lambda a, c: a <= 1e-14))
wrong("4.14", "allows a relative excess of 1e-9 in the triangle inequality")(
    judged(highest=lambda a, b, c: c > (a + b) * (1.0 + 1e-9)))
wrong("4.14", "refuses needles with one moment a hundred million times the other")(judged(lambda a, c: a <= 1e-8 * c))
wrong("4.14", "refuses needles with one moment a million million times the other")(judged(lambda a, c: a <= 1e-12 * c))
wrong("4.14", "compares the smallest moment with an absolute 1e-26 kg m²")(judged(lambda a, c: a <= 1e-26))
wrong("4.14", "allows an asymmetry of 1e-10")(judged(equal=1e-10))
wrong("4.14", "allows an asymmetry of 1e-12")(judged(equal=1e-12))
wrong("4.14", "compares only Ixy with Iyx")(judged(asymmetry=lambda I: abs(I[0, 1] - I[1, 0])))
wrong("4.14", "requires symmetry to the last digit")(judged(equal=0.0))
wrong("4.14", "tests symmetry with NumPy's isclose")(judged(equal=1e-5))
wrong("4.14", "names another moment in the error")(judged(named=lambda a, c: (c, a)))
wrong("4.14", "accepts zero")(judged(lambda a, c: a < 0.0))
wrong("4.14", "refuses a plate because of round-off")(judged(highest=lambda a, b, c: c >= a + b))
wrong("4.14", "does not test the symmetry")(judged(symmetric=False))
wrong("4.14", "accepts NaN")(judged(finite=False))
wrong("4.14", "compares the smallest moment with an absolute 1e-6 kg m²")(judged(lambda a, c: a <= 1e-6))
right("4.14", "with eigenvalues only")(judged())
edit("4.14", "tests the diagonal in place of the principal moments", "moments, _ = principal_axes(I)",
     "moments = np.sort(np.diag(I))")
edit("4.14", "compares the sum of moments with an absolute tolerance in kg m²",
     "(1.0 + MOMENT_ROUND_OFF)", "1.0 + MOMENT_ROUND_OFF")
edit("4.14", "accepts NaN off the diagonal", "kg m²]\", I)", "kg m²]\", np.diag(I))")
edit("4.14", "finds NaN on and above the diagonal only", "kg m²]\", I)", "kg m²]\", np.triu(I))")
edit("4.14", "finds NaN on and below the diagonal only", "kg m²]\", I)", "kg m²]\", np.tril(I))")
edit("4.14", "compares the asymmetry with the root of all squares", "MOMENT_ROUND_OFF * np.max(np.abs(I))",
     "MOMENT_ROUND_OFF * np.sqrt(np.sum(I * I))")
edit("4.14", "compares the asymmetry with the trace", "MOMENT_ROUND_OFF * np.max(np.abs(I))",
     "MOMENT_ROUND_OFF * np.trace(I)")
edit("4.14", "compares the smallest moment with the trace", "MOMENT_ROUND_OFF * moments[2]",
     "MOMENT_ROUND_OFF * np.trace(I)")
edit("4.14", "names the smallest moment in the error, where the largest one is wrong",
     "the largest principal moment", "the smallest principal moment")
edit("4.14", "names the largest moment in the error, where the smallest one is wrong", "the smallest principal moment",
     "the largest principal moment")
edit("4.14", "names an entry in the error, where the tensor is not symmetric",
     "the asymmetry of an inertia", "an entry of the inertia")
edit("4.14", "names the asymmetry in the error, where an entry is not finite",
     "an entry of the inertia", "the asymmetry of an inertia")
edit("4.14", "compares the smallest moment with the middle one", "moments[0] <= MOMENT_ROUND_OFF * moments[2]",
     "moments[0] <= MOMENT_ROUND_OFF * moments[1]")
edit("4.14", "compares the asymmetry with the largest entry, signs included", "np.max(np.abs(I)):", "np.max(I):")
edit("4.14", "compares the asymmetry with ε itself, not with that part of the largest entry",
     "asymmetry > MOMENT_ROUND_OFF * np.max(np.abs(I))", "asymmetry > MOMENT_ROUND_OFF")


# 4.15 -----------------------------------------------------------------------------------------------------------
def integrals(x, faces):
    a, b, c = x[faces[:, 0]], x[faces[:, 1]], x[faces[:, 2]]
    w, s = np.sum(a * np.cross(b, c), axis=1), a + b + c
    return np.sum(w) / 6.0, w @ s / 24.0, sum((u.T * w) @ u for u in (a, b, c, s)) / 120.0


right("4.15", "all triangles at once")(integrals)


@right("4.15", "relative to the mean of the corners, and shifted back")
def mesh_integrals(x, faces):
    o = np.mean(x, axis=0)
    V, first, second = integrals(x - o, faces)
    return V, first + V * o, second + np.outer(first, o) + np.outer(o, first) + V * np.outer(o, o)


SIX_VOLUMES = "a[0] * bc_x + a[1] * bc_y + a[2] * bc_z"
SECOND = "w / 120.0 * (a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + s * (a[j] + b[j] + c[j]))"
edit("4.15", "drops the sign of each tetrahedron's volume", SIX_VOLUMES, f"abs({SIX_VOLUMES})")
edit("4.15", "drops the sign of the whole volume", "return volume, first", "return abs(volume), first")
edit("4.15", "puts masses at the corners in place of integrating", SECOND,
     "w / 24.0 * (a[i] * a[j] + b[i] * b[j] + c[i] * c[j])")
edit("4.15", "reverses the orientation of the triangles", SIX_VOLUMES, f"-({SIX_VOLUMES})")
edit("4.15", "puts all mass of a tetrahedron at its centre", SECOND, "w / 96.0 * s * (a[j] + b[j] + c[j])")
CENTRE_OF_THE_TRIANGLE = edit("4.15", "uses the centre of the triangle, not of the tetrahedron", "w / 24.0", "w / 18.0")
edit("4.15", "ignores tetrahedra below a cubic nanometre", "volume +=", "w = w if abs(w) > 1e-27 else 0.0; volume +=")
edit("4.15", "forgets the division by 6 of the volume", "w / 6.0", "w")
edit("4.15", "divides the first integrals by 6 in place of 24", "w / 24.0", "w / 6.0")
edit("4.15", "divides the second integrals by 24 in place of 120", "w / 120.0", "w / 24.0")
edit("4.15", "forgets the corner a in the sum", "s = a[i] + b[i]", "s = b[i]")
WITHOUT_CORNER_PRODUCTS = edit("4.15", "forgets s sᵀ in the second integrals", "+ s * (a[j] + b[j] + c[j]))", ")")
edit("4.15", "takes b × a in place of b × c", "b[1] * c[2] - b[2] * c[1]", "b[1] * a[2] - b[2] * a[1]")
edit("4.15", "fills the lower half of the second integrals only", "second[j, i] = second[i, j]", "pass")
edit("4.15", "takes the mean of the corners in place of their sum for ∫x dV", "w / 24.0 * s", "w / 72.0 * s")
edit("4.15", "uses the first hundred triangles only", "range(faces.shape[0])", "range(min(faces.shape[0], 100))")


# 4.16 -----------------------------------------------------------------------------------------------------------
@variants
def closing(ranged=True, directed=True, counted=True, twice=True, spare=True, named=lambda edges: edges[0][0],
            number=lambda i, j, faces: (i, j)):
    """Each edge needs as many reversed edges, with tests that may be wrong or too many."""
    def check_closed(count, faces):
        if ranged and not 0 <= faces.min() <= faces.max() < count:
            raise BadInput("a triangle's corner", next(k for k in faces.ravel() if not 0 <= k < count),
                           "give a number of a corner")
        every = [(int(i), int(j)) for f in faces for i, j in zip(f, np.roll(f, -1), strict=True)]
        either = [tuple(sorted(edge)) for edge in every]
        if directed:
            there = [number(i, j, faces) for i, j in every]
            back = [number(j, i, faces) for i, j in every]
            alone = [edge for edge, i, j in zip(every, there, back, strict=True)
                     if (there.count(i) != there.count(j) if counted else j not in there)]
        else:
            alone = [edge for edge in either if either.count(edge) % 2]
        if alone or (not twice and len(set(every)) < len(every)) or (not spare and len(set(faces.ravel())) < count):
            raise BadInput("a corner on an open edge: number", named(alone or every), "close the mesh")
    return check_closed


right("4.16", "counting every edge")(closing())
wrong("4.16", "counts the triangles at each edge, regardless of their direction")(closing(directed=False))
wrong("4.16", "looks for one reversed edge in place of comparing the counts")(closing(counted=False))
wrong("4.16", "does not test whether the numbers of the corners exist")(closing(ranged=False))
wrong("4.16", "names corner 0 in the error, whichever edge is open")(closing(named=lambda edges: 0))
wrong("4.16", "requires each edge exactly once in each direction")(closing(twice=False))
wrong("4.16", "requires that every corner is used")(closing(spare=False))
wrong("4.16", "numbers the edges with the number of triangles, not of corners")(
    closing(number=lambda i, j, faces: i * len(faces) + j))
edit("4.16", "refuses a triangle with a corner twice though it closes", "if i < 0 or i >= count:",
     "if i < 0 or i >= count or i == j:")
edit("4.16", "compares the edges with themselves, not with the reversed ones", "= j * count + i", "= i * count + j")
edit("4.16", "compares the first hundred edges only", "range(there.size)", "range(min(there.size, 100))")
edit("4.16", "names an open edge in the error, where a corner does not exist",
     "a triangle's corner", "a corner on an open edge: number")
edit("4.16", "names a triangle's corner in the error, where an edge is open",
     "a corner on an open edge: number", "a triangle's corner")


# 4.17 -----------------------------------------------------------------------------------------------------------
def body_of(density, x, faces, tensor):
    """The checks, then tensor(V, c, Q) about the first corner."""
    check_positive("density [kg/m³]", density)
    check_finite("a corner of the mesh [m]", x)
    worked.check_closed(len(x), faces)
    V, first, Q = worked.mesh_integrals(x - x[0], faces)
    if V <= worked.MOMENT_ROUND_OFF * np.max(np.abs(x - x[0])) ** 3:
        raise BadInput("the volume inside the mesh [m³]", V, "turn it inside out")
    return worked.MassProperties(density * V, x[0] + first / V, density * tensor(V, first / V, Q))


def from_covariance(C):
    return np.trace(C) * np.eye(3) - C


@right("4.17", "as tetrahedra, combined")
def mesh_body(density, x, faces):
    whole = body_of(density, x, faces, lambda V, c, Q: np.eye(3))
    m, centres, tensors = [], [], []
    for i, j, k in faces:
        corners = np.stack([0.0 * x[0], x[i] - x[0], x[j] - x[0], x[k] - x[0]])
        V, s = np.linalg.det(corners[1:]) / 6.0, corners.sum(axis=0)
        second = V / 20.0 * (corners.T @ corners + np.outer(s, s)) - V * np.outer(s, s) / 16.0
        m.append(density * V)
        centres.append(s / 4.0)
        tensors.append(density * from_covariance(second))
    body = worked.combine(np.array(m), np.stack(centres), np.stack(tensors))
    return worked.MassProperties(whole.m, x[0] + body.x, body.I)


TENSOR_ABOUT_FIRST_CORNER = edit("4.17", "returns the tensor about the first corner",
                                 "second - volume * np.outer(centre, centre)", "second")
edit("4.17", "returns the second moments in place of the tensor",
     "np.trace(covariance) * np.eye(3) - covariance", "covariance")
edit("4.17", "forgets the density in the tensor", "density * (np.trace", "1.0 * (np.trace")
edit("4.17", "omits the minus signs off the diagonal", "np.eye(3) - covariance",
     "np.eye(3) + covariance - 2.0 * np.diag(np.diag(covariance))")
edit("4.17", "integrates about the world's origin, which loses digits far away",
     "offsets = x - x[0]", "offsets, x = x, 0.0 * x")
edit("4.17", "takes the density for the mass", "density * volume", "density")
edit("4.17", "returns the mean of the corners as the centre", "x[0] + centre", "np.sum(x, axis=0) / x.shape[0]")
edit("4.17", "returns centre and tensor for the mean of the corners",
     "first / volume", "np.sum(offsets, axis=0) / x.shape[0]")
INSIDE_OUT_MESH = edit("4.17", "accepts a mesh that is inside-out", "volume <= MOMENT", "abs(volume) <= MOMENT")
edit("4.17", "does not check that the mesh is closed", "check_closed(x.shape[0], faces)", "pass")
edit("4.17", "accepts a flat mesh if its round-off volume is positive",
     "MOMENT_ROUND_OFF * np.max(np.abs(offsets)) ** 3", "0.0")
edit("4.17", "refuses what is small, regardless of its shape", "MOMENT_ROUND_OFF * np.max(np.abs(offsets)) ** 3",
     "MOMENT_ROUND_OFF")
edit("4.17", "compares the volume with a length", "np.max(np.abs(offsets)) ** 3", "np.max(np.abs(offsets))")
edit("4.17", "measures the size of the mesh on the positive side of the first corner only",
     "np.max(np.abs(offsets))", "np.max(offsets)")
edit("4.17", "measures the size of the mesh on the negative side of the first corner only", "np.max(np.abs(offsets))",
     "np.max(-offsets)")
edit("4.17", "accepts indices of no corner", "x.shape[0], faces", "np.max(faces) + 1, faces")
edit("4.17", "accepts an infinite density", 'check_positive("density [kg/m³]", density)',
     'if not density > 0.0: raise BadInput("density [kg/m³]", density, "give some")')
edit("4.17", "accepts volumes a thousand times too small", "MOMENT_ROUND_OFF * np.max", "1e-17 * np.max")
edit("4.17", "refuses volumes a thousand times too large", "MOMENT_ROUND_OFF * np.max", "1e-11 * np.max")
edit("4.17", "checks only the corners that triangles use", "[m]\", x)", "[m]\", x[np.unique(faces % x.shape[0])])")
edit("4.17", "returns a plain tuple, not MassProperties", "MassProperties(density * volume, x[0] + centre, tensor)",
     "(density * volume, x[0] + centre, tensor)")
CENTRE_FROM_FIRST_CORNER = edit("4.17", "returns the centre relative to the first corner", "x[0] + centre", "centre")
edit("4.17", "adds the term of the centre in place of subtracting it", "second - volume", "second + volume")
edit("4.17", "forgets the volume beside the centre's term", "volume * np.outer", "np.outer")
edit("4.17", "does not divide the first integrals by the volume", "first / volume", "first")
edit("4.17", "reverses the sign of the tensor",
     "np.trace(covariance) * np.eye(3) - covariance", "covariance - np.trace(covariance) * np.eye(3)")
edit("4.17", "adds the covariance to its trace", "np.eye(3) - covariance", "np.eye(3) + covariance")
edit("4.17", "divides by the mass in place of the volume", "first / volume", "first / (density * volume)")
edit("4.17", "adds the trace to every entry, not only on the diagonal",
     "np.trace(covariance) * np.eye(3)", "np.trace(covariance)")
edit("4.17", "takes a density of at most 10 kg/m³",
     "volume, first, second =", "density = min(density, 10.0); volume, first, second =")
edit("4.17", "names the mass in the error, where there is no volume",
     "the volume inside the mesh [m³]", "the mass [kg]")
edit("4.17", "gives the size of the volume in the error, without its sign", '[m³]", volume', '[m³]", abs(volume)')
edit("4.17", "gives the mass in the error, in place of the volume", '[m³]", volume', '[m³]", density * volume')


# 4.18 -----------------------------------------------------------------------------------------------------------
@right("4.18", "by the energy at the end")
def rolling_time(I, m, radius, way, slope, g):
    speed = np.sqrt(2.0 * m * g * way * np.sin(slope) / (m + I / radius**2))
    return 2.0 * way / speed


edit("4.18", "lets the body slide: no energy goes into the rotation", "(1.0 + I / (m * radius * radius))", "1.0")
edit("4.18", "gives all the energy to the rotation", "(1.0 + I", "(0.0 + I")
edit("4.18", "takes the drop for the horizontal way: cos in place of sin", "np.sin", "np.cos")
edit("4.18", "lets the body fall straight down", "np.sin(slope)", "1.0")
edit("4.18", "forgets the 2 in s = ½ a t²", "2.0 * way", "way")
edit("4.18", "divides the distance by the final speed, not by the mean speed",
     "np.sqrt(2.0 * way / a)", "way / np.sqrt(2.0 * a * way)")
edit("4.18", "returns the square of the time", "np.sqrt(2.0 * way / a)", "2.0 * way / a")
edit("4.18", "divides the moment by m R in place of m R²", "m * radius * radius", "m * radius")
edit("4.18", "adds half of I/(m R²)", "1.0 + I /", "1.0 + 0.5 * I /")
edit("4.18", "returns the speed at the end", "np.sqrt(2.0 * way / a)", "np.sqrt(2.0 * way * a)")
edit("4.18", "takes a slope of at most 1 rad", "np.sin(slope)", "np.sin(min(slope, 1.0))")
edit("4.18", "takes a mass of at least 1 g", "I / (m *", "I / (max(m, 1e-3) *")
edit("4.18", "takes the sine of a slope below 3° for the slope", "np.sin(slope)",
     "(slope if slope < 0.05 else np.sin(slope))")
edit("4.18", "takes a moment of at least 1e-12 kg m²", "1.0 + I /", "1.0 + max(I, 1e-12) /")


# 4.19 -----------------------------------------------------------------------------------------------------------
@right("4.19", "as a small letter")
def solid_cylinder_is():
    return "d"


edit("4.19", "chooses the solid ball: it has less mass far from its axis, and is faster", '"D"', '"C"')
edit("4.19", "chooses the hollow ball: all its mass lies in its skin, so it is slower", '"D"', '"A"')
edit("4.19", "chooses the hoop: all its mass lies at the rim, so it is the slowest", '"D"', '"B"')


# 4.20 -----------------------------------------------------------------------------------------------------------
BOX = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6],
                [0, 6, 4], [1, 5, 7], [1, 7, 3]])
CORNERS = np.array([(i, j, k) for i in (-0.5, 0.5) for j in (-0.5, 0.5) for k in (-0.5, 0.5)])


@right("4.20", "eight small cubes at the corners of a large one")
def my_mesh(volume):
    a = 0.5 * volume ** (1.0 / 3.0)
    return (np.vstack([a * (CORNERS + 6.0 * c) for c in CORNERS]),
            np.vstack([BOX + 8 * k for k in range(8)]))


@right("4.20", "six small cubes on three axes")
def on_axes(volume):
    a = (volume / 6.0) ** (1.0 / 3.0)
    places = np.vstack([np.eye(3), -np.eye(3)])
    return np.vstack([a * (CORNERS + 3.0 * c) for c in places]), np.vstack([BOX + 8 * k for k in range(6)])


FIRST = "a = (3.0 * volume) ** (1.0 / 3.0)"
edit("4.20", "is half as large as it should be", "(3.0 * volume)", "(1.5 * volume)")
edit("4.20", "has the same size always", "(3.0 * volume)", "3.0")
edit("4.20", "is inside out",
     "[[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]", "[[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]]")
edit("4.20", "has a hole: a face is missing", ", [1, 3, 2]]", "]")
edit("4.20", "has one face the other way round", "[1, 3, 2]", "[1, 2, 3]")
edit("4.20", "has three different moments", "x = 0.5 * a *", "x = np.array([1.25, 1.0, 0.8]) * 0.5 * a *")
edit("4.20", "is an octahedron, which is nearly a ball", FIRST,
     "return ((0.75 * volume) ** (1.0 / 3.0) * np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], "
     "[0, 0, -1]]), "
     "np.array([[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]))")
edit("4.20", "has a size of at least 1 cm", "x = 0.5 * a", "a = max(a, 0.01); x = 0.5 * a")
