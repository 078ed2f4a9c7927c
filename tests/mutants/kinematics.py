"""Lesson 11: arms that count angles from the wrong line, turn about the wrong joint, damp too little or go too far.

Most factories take the parts of an answer as functions, so that each idea is one line.
"""

import numpy as np

from solutions import kinematics as worked
from solutions.checks import BadInput

from . import collection, of_variants, same, variants

wrong, right, edit, MUTANTS = collection(worked)
wrongs, alike = of_variants(wrong)


# 11.1 -----------------------------------------------------------------------------------------------------------
@variants
def positions(given=same, phi=np.cumsum, length=same, link=lambda phi, theta: (np.cos(phi), np.sin(phi)),
              total=lambda links: np.cumsum(links, axis=0), result=same):
    def joint_positions(theta, lengths):
        angles = given(np.array(theta))
        links = length(np.asarray(lengths))[:, None] * np.stack(link(phi(angles), angles), axis=1)
        return result(np.concatenate((np.zeros((1, 2)), total(links))))
    return joint_positions


@right("11.1", "by complex numbers")
def joint_positions(theta, lengths):
    z = np.append(0.0, np.cumsum(lengths * np.exp(1j * np.cumsum(theta))))
    return np.stack((z.real, z.imag), axis=1)


right("11.1", "as a list")(lambda theta, lengths: worked.joint_positions(theta, lengths).tolist())
wrongs("11.1", positions, {
    "measures each angle from the x axis, not from the link before": {"phi": same},
    "adds each angle one link late": {"phi": lambda theta: np.cumsum(theta) - theta},
    "measures the angles clockwise": {"phi": lambda theta: -np.cumsum(theta)},
    "measures the first angle from the y axis": {"phi": lambda theta: np.cumsum(theta) + 0.5 * np.pi},
    "adds up the angles from the end": {"phi": lambda theta: np.cumsum(theta[::-1])[::-1]},
    "adds only the angle of the joint before": {"phi": lambda theta: theta + np.append(0.0, theta[:-1])},
    "adds only the angle of the first joint": {"phi": lambda theta: theta + np.append(0.0, 0.0 * theta[1:] + theta[0])},
    "counts each angle again for the link after it":
        {"phi": lambda theta: np.cumsum(theta + np.append(0.0, theta[:-1]))},
    "uses the mean of the angles": {"phi": lambda theta: np.cumsum(theta) / np.arange(1.0, len(theta) + 1.0)},
    "multiplies each angle by its number": {"phi": lambda theta: theta * np.arange(1.0, len(theta) + 1.0)},
    "adds up the sizes of the angles": {"phi": lambda theta: np.cumsum(np.abs(theta))},
    "uses half of the angles": {"phi": lambda theta: 0.5 * np.cumsum(theta)},
    "takes the direction halfway between two links": {"phi": lambda theta: np.cumsum(theta) - 0.5 * theta},
    "takes the angle of the last joint from the x axis":
        {"phi": lambda theta: np.append(np.cumsum(theta)[:-1], theta[-1])},
    "takes angles modulo π": {"phi": lambda theta: np.cumsum(theta) % np.pi},
    "takes the angles in degrees": {"given": np.radians},
    "converts the angles to degrees": {"given": np.degrees},
    "exchanges sine and cosine": {"link": lambda phi, theta: (np.sin(phi), np.cos(phi))},
    "points along −x where the angle is 0": {"link": lambda phi, theta: (-np.cos(phi), np.sin(phi))},
    "uses the joint's own angle in the cosine": {"link": lambda phi, theta: (np.cos(theta), np.sin(phi))},
    "uses the joint's own angle in the sine": {"link": lambda phi, theta: (np.cos(phi), np.sin(theta))},
    "uses the tangent in place of the sine": {"link": lambda phi, theta: (np.cos(phi), np.tan(phi))},
    "takes the angles as small": {"link": lambda phi, theta: (np.ones(len(phi)), phi)},
    "forgets the lengths": {"length": np.ones_like},
    "uses the length of the first link for all": {"length": lambda l: np.full(len(l), l[0])},
    "uses the length of the link before": {"length": lambda l: np.roll(l, 1)},
    "uses the lengths from the end to the base": {"length": lambda l: l[::-1]},
    "adds up the lengths": {"length": np.cumsum},
    "squares the lengths": {"length": np.square},
    "does not add the positions of the links before": {"total": same},
    "omits the end of the last link": {"result": lambda x: x[:-1]},
    "leaves out the base": {"result": lambda x: x[1:]},
    "returns only the end": {"result": lambda x: x[-1]},
    "returns the transpose": {"result": np.transpose},
    "returns three coordinates": {"result": lambda x: np.hstack((x, np.zeros((len(x), 1))))},
    "returns the end first": {"result": lambda x: x[::-1].copy()},
    "returns the end twice": {"result": lambda x: np.vstack((x, x[-1:]))},
    "returns positions as seen from the end": {"result": lambda x: x - x[-1]},
    "leaves the last row at zero": {"result": lambda x: np.vstack((x[:-1], np.zeros((1, 2))))},
    "leaves the first link out of all positions": {"result": lambda x: np.vstack((x[:1], x[1:] - x[1]))},
    "rounds the positions": {"result": lambda x: np.round(x, 4)},
})
edit("11.1", "alternates the signs of the angles", "phi += theta[k]", "phi += theta[k] * (-1.0) ** k")
edit("11.1", "uses the angle for its sine", "np.sin(phi)", "phi")
edit("11.1", "begins one length along x", "np.zeros((theta.size + 1, 2)), 0.0",
     "np.zeros((theta.size + 1, 2)) + [lengths[0], 0.0], 0.0")
edit("11.1", "computes in whole numbers", "np.zeros((theta.size + 1, 2))", "np.zeros((theta.size + 1, 2), int)")
edit("11.1", "leaves out the first joint", "range(theta.size)", "range(1, theta.size)")
edit("11.1", "changes its input", "phi += theta[k]", "theta[k] = phi = phi + theta[k]")


# 11.2 -----------------------------------------------------------------------------------------------------------
@variants
def jacobian(r=lambda x: x[-1] - x[:-1], column=lambda r: (-r[:, 1], r[:, 0]), result=same):
    def jacobian_2d(x):
        return result(np.stack(column(r(np.array(x)))))
    return jacobian_2d


@right("11.2", "by a matrix")
def jacobian_2d(x):
    return np.array([[0.0, -1.0], [1.0, 0.0]]) @ (x[-1] - x[:-1]).T


def zero_column(k):
    """The matrix with zeros in a column."""
    return lambda J: np.where(np.arange(J.shape[1]) == k % J.shape[1], 0.0, J)


wrongs("11.2", jacobian, {
    "reverses the sign, so that joints rotate clockwise": {"r": lambda x: x[:-1] - x[-1]},
    "uses only the joint's own link as the arm": {"r": lambda x: np.diff(x, axis=0)},
    "measures the arm from the base to the joint": {"r": lambda x: x[:-1]},
    "measures the arm from the next joint": {"r": lambda x: x[-1] - x[1:]},
    "takes the position of the end, not its offset from the joint": {"r": lambda x: 0.0 * x[:-1] + x[-1]},
    "takes all arms from joint 0": {"r": lambda x: 0.0 * x[:-1] + x[-1] - x[0]},
    "takes the first arm from the origin, not from joint 0":
        {"r": lambda x: x[-1] - np.vstack((np.zeros((1, 2)), x[1:-1]))},
    "measures the arm to the last joint, not to the end": {"r": lambda x: x[-2] - x[:-1]},
    "measures the arm from the middle of the link": {"r": lambda x: x[-1] - 0.5 * (x[:-1] + x[1:])},
    "measures the arm from the joint to the base": {"r": lambda x: x[0] - x[:-1]},
    "adds the two positions": {"r": lambda x: x[-1] + x[:-1]},
    "subtracts only in x": {"r": lambda x: x[-1] - x[:-1] * [1.0, 0.0]},
    "subtracts only in y": {"r": lambda x: x[-1] - x[:-1] * [0.0, 1.0]},
    "uses the arm r itself, not its perpendicular": {"column": lambda r: (r[:, 0], r[:, 1])},
    "forgets the minus sign of r_y": {"column": lambda r: (r[:, 1], r[:, 0])},
    "has a minus sign in both entries": {"column": lambda r: (-r[:, 1], -r[:, 0])},
    "exchanges the two rows": {"column": lambda r: (r[:, 0], -r[:, 1])},
    "uses r_y in both rows": {"column": lambda r: (-r[:, 1], r[:, 1])},
    "uses r_x in both rows": {"column": lambda r: (-r[:, 0], r[:, 0])},
    "takes the sizes of the entries": {"column": lambda r: (np.abs(r[:, 1]), np.abs(r[:, 0]))},
    "takes the size of r_y": {"column": lambda r: (-np.abs(r[:, 1]), r[:, 0])},
    "normalises the columns": {"result": lambda J: J / np.linalg.norm(J, axis=0)},
    "divides by the square of r": {"result": lambda J: J / np.sum(J * J, axis=0)},
    "returns the transpose": {"result": lambda J: J.T.copy()},
    "returns a column for the end, too": {"result": lambda J: np.hstack((J, np.zeros((2, 1))))},
    "omits the last joint": {"result": lambda J: J[:, :-1]},
    "omits the first joint": {"result": lambda J: J[:, 1:]},
    "returns the columns from the last joint to the first": {"result": lambda J: J[:, ::-1].copy()},
    "shifts the columns by one joint": {"result": lambda J: np.roll(J, 1, axis=1)},
    "adds up the columns": {"result": lambda J: np.cumsum(J, axis=1)},
    "adds up the columns from the end": {"result": lambda J: np.cumsum(J[:, ::-1], axis=1)[:, ::-1]},
    "adds a row of ones": {"result": lambda J: np.vstack((J, np.ones(J.shape[1])))},
    "adds a row of zeros": {"result": lambda J: np.vstack((J, np.zeros(J.shape[1])))},
    "returns zeros for the last joint": {"result": zero_column(-1)},
    "returns zeros for the first joint": {"result": zero_column(0)},
    "takes the rates in degrees per second": {"result": np.radians},
    "divides by the number of joints": {"result": lambda J: J / J.shape[1]},
    "returns twice the velocity": {"result": lambda J: 2.0 * J},
    "multiplies J by its transpose": {"result": lambda J: J @ J.T},
    "returns one row of all entries": {"result": np.ravel},
    "rounds the entries": {"result": lambda J: np.round(J, 4)},
    "computes in whole numbers": {"result": np.trunc},
})
edit("11.2", "changes its input", "n = x.shape[0] - 1", "n = x.shape[0] - 1; x -= x[n].copy()")


# 11.3 -----------------------------------------------------------------------------------------------------------
def determinants(J, sign=-1.0):
    """The 2 × 2 determinants of all pairs of columns."""
    i, k = np.triu_indices(J.shape[1], 1)
    return J[0, i] * J[1, k] + sign * J[1, i] * J[0, k]


@variants
def ellipse(products=lambda J: (J[0] @ J[0], J[0] @ J[1], J[1] @ J[1]),
            determinant=lambda J: np.linalg.norm(determinants(J)),
            root=lambda a, b, c: np.hypot(0.5 * (a - c), b), long=lambda a, c, root: np.sqrt(0.5 * (a + c) + root),
            short=lambda D, longer: D / longer, turn=lambda a, b, c: 0.5 * np.arctan2(2.0 * b, a - c), result=same):
    def velocity_ellipse(J):
        a, b, c = products(J)
        longer = long(a, c, root(a, b, c))
        return result((longer, short(determinant(J), longer), turn(a, b, c)))
    return velocity_ellipse


@variants
def by_vectors(axis=0, direction=lambda u, v: u):
    def velocity_ellipse(J):
        u, sigma, v = np.linalg.svd(J, full_matrices=False)
        x, y = direction(u, v)[:2, axis]
        return sigma[0], np.append(sigma, 0.0)[1], np.arctan2(y, x)      # a single joint has one singular value
    return velocity_ellipse


@variants
def by_eigenvalues(half_axes=lambda values, J: np.append(np.linalg.svd(J)[1], 0.0)[:2], column=1):
    def velocity_ellipse(J):
        values, u = np.linalg.eigh(J @ J.T)
        longer, shorter = half_axes(values, J)
        return longer, shorter, np.arctan2(u[1, column], u[0, column])
    return velocity_ellipse


wrongs("11.3", ellipse, {
    "computes the short axis from a difference, which cancels":
        {"determinant": lambda J: np.sqrt(np.maximum(np.linalg.det(J @ J.T), 0.0))},
    "returns the squares of the axes": {"result": lambda r: (r[0]**2, r[1]**2, r[2])},
    "returns the square of the longer axis": {"result": lambda r: (r[0]**2, r[1], r[2])},
    "forgets the outer root": {"long": lambda a, c, root: 0.5 * (a + c) + root},
    "uses D² in place of D": {"determinant": lambda J: np.sum(determinants(J)**2)},
    "returns the determinant as the short axis": {"short": lambda D, longer: D},
    "divides D by σ₁²": {"short": lambda D, longer: D / longer**2},
    "returns the area as the short axis": {"short": lambda D, longer: np.pi * D},
    "returns σ₁/D as the short axis": {"short": lambda D, longer: longer / np.maximum(D, 1e-300)},
    "does not let the short axis go to zero": {"short": lambda D, longer: np.maximum(D / longer, 1e-6)},
    "takes a small short axis for zero": {"short": lambda D, longer: D / longer if D > 1e-4 else 0.0},
    "takes each pair of columns twice": {"determinant": lambda J: np.linalg.norm(determinants(J)) * np.sqrt(2.0)},
    "takes only columns that are neighbours":
        {"determinant": lambda J: np.linalg.norm(J[0, :-1] * J[1, 1:] - J[1, :-1] * J[0, 1:])},
    "takes only pairs with the first column":
        {"determinant": lambda J: np.linalg.norm(determinants(J)[:J.shape[1] - 1])},
    "takes only the first two columns in D": {"determinant": lambda J: abs(determinants(J)[0])},
    "squares the sum of the determinants, in place of adding up squares":
        {"determinant": lambda J: abs(np.sum(determinants(J)))},
    "adds up the sizes of the determinants": {"determinant": lambda J: np.sum(np.abs(determinants(J)))},
    "takes the largest determinant": {"determinant": lambda J: np.max(np.abs(determinants(J)))},
    "adds the two products of a determinant": {"determinant": lambda J: np.linalg.norm(determinants(J, 1.0))},
    "forgets b in the longer axis": {"root": lambda a, b, c: 0.5 * abs(a - c)},
    "forgets the quarter": {"root": lambda a, b, c: np.hypot(a - c, b)},
    "does not square b": {"root": lambda a, b, c: np.sqrt(0.25 * (a - c)**2 + abs(b))},
    "takes 4b² under the root": {"root": lambda a, b, c: np.hypot(0.5 * (a - c), 2.0 * b)},
    "adds a and c under the root": {"root": lambda a, b, c: np.hypot(0.5 * (a + c), b)},
    "forgets the inner root": {"root": lambda a, b, c: 0.25 * (a - c)**2 + b * b},
    "forgets the half of a + c": {"long": lambda a, c, root: np.sqrt(a + c + root)},
    "subtracts c from a in the longer axis": {"long": lambda a, c, root: np.sqrt(0.5 * (a - c) + root)},
    "uses JᵀJ in place of JJᵀ": {"products": lambda J: (J[:, 0] @ J[:, 0], J[:, 0] @ J[:, 1], J[:, 1] @ J[:, 1])},
    "returns twice the angle": {"turn": lambda a, b, c: np.arctan2(2.0 * b, a - c)},
    "uses the arctangent of the quotient": {"turn": lambda a, b, c: 0.5 * np.arctan(2.0 * b / (a - c))},
    "returns an angle that is never negative": {"turn": lambda a, b, c: 0.5 * np.arctan2(2.0 * np.abs(b), a - c)},
    "adds a and c in the angle": {"turn": lambda a, b, c: 0.5 * np.arctan2(2.0 * b, a + c)},
    "forgets the factor 2 beside b": {"turn": lambda a, b, c: 0.5 * np.arctan2(b, a - c)},
    "subtracts a from c in the angle": {"turn": lambda a, b, c: 0.5 * np.arctan2(2.0 * b, c - a)},
    "exchanges the arguments of the arctangent": {"turn": lambda a, b, c: 0.5 * np.arctan2(a - c, 2.0 * b)},
    "returns the angle of the short axis": {"turn": lambda a, b, c: 0.5 * np.arctan2(2.0 * b, a - c) + 0.5 * np.pi},
    "reverses the sign of the angle": {"turn": lambda a, b, c: -0.5 * np.arctan2(2.0 * b, a - c)},
    "returns the angle 0 where b is 0":
        {"turn": lambda a, b, c: 0.5 * np.arctan2(2.0 * b, a - c) if abs(b) > 0.0 else 0.0},
    "exchanges the two half axes": {"result": lambda r: (r[1], r[0], r[2])},
    "returns diameters in place of half axes": {"result": lambda r: (2.0 * r[0], 2.0 * r[1], r[2])},
    "returns the angle in degrees": {"result": lambda r: (r[0], r[1], np.degrees(r[2]))},
    "omits the angle": {"result": lambda r: r[:2]},
    "returns the inverse half axes": {"result": lambda r: (1.0 / r[0], 1.0 / np.maximum(r[1], 1e-300), r[2])},
})
edit("11.3", "returns the square of the short axis", "np.sqrt(squared) / longer", "squared / longer ** 2")
edit("11.3", "adds up the determinants without squaring them", "(J[0, i] * J[1, k] - J[1, i] * J[0, k]) ** 2",
     "abs(J[0, i] * J[1, k] - J[1, i] * J[0, k])")
edit("11.3", "takes the shorter axis for the longer one", "0.5 * (a + c) + np.sqrt", "0.5 * (a + c) - np.sqrt")
edit("11.3", "takes the lengths of the rows of J for the half axes", "return longer, np.sqrt(squared) / longer,",
     "return np.sqrt(max(a, c)), np.sqrt(min(a, c)),")
edit("11.3", "returns the direction of the first column", "0.5 * np.arctan2(2.0 * b, a - c)",
     "np.arctan2(J[1, 0], J[0, 0])")
wrongs("11.3", by_vectors, {
    "returns the angle of the short axis": {"axis": 1},
    "returns the angle of v, in joints, not of u": {"direction": lambda u, v: v.T},
})
wrongs("11.3", by_eigenvalues, {
    "returns the eigenvalues of J Jᵀ for the half axes": {"half_axes": lambda values, J: np.abs(values)[::-1]},
    "takes the shorter axis from an eigenvalue, which loses its digits":
        {"half_axes": lambda values, J: np.sqrt(np.abs(values))[::-1]},
    "takes the vector of the smaller eigenvalue": {"column": 0},
    "takes the eigenvalues in rising order": {"half_axes": lambda values, J: np.linalg.svd(J)[1][::-1]},
})


# 11.4 -----------------------------------------------------------------------------------------------------------
def out_of_reach(r, *_):
    raise BadInput("distance of the target [m]", r, "stay within the reach of the arm")


def half_angle(r, a, b, *_):
    return 2.0 * np.arctan2(np.sqrt(np.maximum((b - r) * (b + r), 0.0)), np.sqrt(np.maximum((r - a) * (r + a), 0.0)))


def out_of_reach_by_value(r, *_):
    raise ValueError(f"distance of the target [m]: {r}")


def cosine(r, l_1, l_2):
    return (r * r - l_1 * l_1 - l_2 * l_2) / (2.0 * l_1 * l_2)


@variants
def two_links(pair=lambda lengths: (lengths[0], lengths[1]), total=lambda lengths: lengths[0] + lengths[1],
              least=lambda l_1, l_2: abs(l_1 - l_2), too_far=lambda r, b: r > b + worked.EDGE * b,
              too_near=lambda r, a, b: r < a - worked.EDGE * b, refuse=out_of_reach, bend=half_angle, side=same,
              bearing=lambda x, y: np.arctan2(y, x),
              back=lambda l_1, l_2, bend: np.arctan2(l_2 * np.sin(bend), l_1 + l_2 * np.cos(bend)),
              first=lambda bearing, back: worked.wrapped(bearing - back), result=np.array):
    def solve_2r(target, lengths, elbow):
        (l_1, l_2), b, r = pair(lengths), total(lengths), np.hypot(target[0], target[1])
        a = least(l_1, l_2)
        if too_far(r, b) or too_near(r, a, b):
            r = refuse(r, a, b, target)
        with np.errstate(all="ignore"):
            theta_2 = side(elbow) * bend(r, a, b, l_1, l_2)
        return result((first(bearing(target[0], target[1]), back(l_1, l_2, theta_2)), theta_2))
    return solve_2r


wrongs("11.4", two_links, {
    "returns the same elbow twice": {"side": lambda elbow: 1.0},
    "reverses the sign of the elbow": {"side": lambda elbow: -elbow},
    "returns half of θ₂": {"bend": lambda *given: 0.5 * half_angle(*given)},
    "returns the inner angle of the triangle for θ₂": {"bend": lambda *given: np.pi - half_angle(*given)},
    "uses the arccosine outside of [−1, 1]": {"bend": lambda r, a, b, l_1, l_2: np.arccos(cosine(r, l_1, l_2))},
    "takes roots of negative numbers": {"bend": lambda r, a, b, *_: 2.0 * np.arctan2(
        np.sqrt((b - r) * (b + r)), np.sqrt((r - a) * (r + a)))},
    "takes the root of a negative number at the outer edge": {"bend": lambda r, a, b, *_: 2.0 * np.arctan2(
        np.sqrt((b - r) * (b + r)), np.sqrt(np.maximum((r - a) * (r + a), 0.0)))},
    "takes the root of a negative number at the inner edge": {"bend": lambda r, a, b, *_: 2.0 * np.arctan2(
        np.sqrt(np.maximum((b - r) * (b + r), 0.0)), np.sqrt((r - a) * (r + a)))},
    "takes the root of the size of a negative number": {"bend": lambda r, a, b, *_: 2.0 * np.arctan2(
        np.sqrt(np.abs((b - r) * (b + r))), np.sqrt(np.abs((r - a) * (r + a))))},
    "forgets the roots": {"bend": lambda r, a, b, *_: 2.0 * np.arctan2(
        np.maximum((b - r) * (b + r), 0.0), np.maximum((r - a) * (r + a), 0.0))},
    "exchanges the two links": {"pair": lambda lengths: (lengths[1], lengths[0])},
    "takes the longer link for the first": {"pair": lambda lengths: (max(lengths[:2]), min(lengths[:2]))},
    "uses the last length for the second link": {"pair": lambda lengths: (lengths[0], lengths[-1])},
    "adds up all lengths, not only the first two": {"total": np.sum},
    "takes exactly two lengths": {"pair": lambda lengths: tuple(np.broadcast_to(lengths, 2))},
    "has no hole in the reach where the second link is the longer one": {"least": lambda l_1, l_2: l_1 - l_2},
    "has no hole in the reach": {"least": lambda l_1, l_2: 0.0},
    "omits the inner limit of the reach": {"too_near": lambda r, a, b: False},
    "allows more than EDGE (l₁ + l₂) at the outer edge of the reach": {"too_far": lambda r, b: r > b + 1e-9 * b},
    "allows more than EDGE (l₁ + l₂) at the inner edge of the reach": {"too_near": lambda r, a, b: r < a - 1e-9 * b},
    "refuses targets within EDGE of the inner limit": {"too_near": lambda r, a, b: r < a + worked.EDGE * b},
    "refuses a target at the base": {"too_near": lambda r, a, b: r < a - worked.EDGE * b or r == 0.0},
    "names the square of the distance": {"refuse": lambda r, *_: out_of_reach(r * r)},
    "names the target, not its distance": {"refuse": lambda r, a, b, target: out_of_reach(target)},
    "names the distance that is missing": {"refuse": lambda r, a, b, target: out_of_reach(r - b)},
    "raises another error than BadInput": {"refuse": out_of_reach_by_value},
    "does not bring θ₁ back into (−π, π]": {"first": lambda bearing, back: bearing - back},
    "returns θ₁ from 0 to 2π": {"first": lambda bearing, back: (bearing - back) % (2.0 * np.pi)},
    "returns θ₁ modulo π": {"first": lambda bearing, back: (bearing - back) % np.pi},
    "reverses the correction of θ₁ by the bend": {"first": lambda bearing, back: worked.wrapped(bearing + back)},
    "omits the correction of θ₁ by the bend": {"first": lambda bearing, back: bearing},
    "uses the arctangent of y/x for the target":
        {"bearing": lambda x, y: np.arctan(y / x) if x else np.sign(y) * 0.5 * np.pi},
    "exchanges the arguments of the arctangent of the target": {"bearing": lambda x, y: np.arctan2(x, y)},
    "exchanges sine and cosine of θ₂":
        {"back": lambda l_1, l_2, bend: np.arctan2(l_2 * np.cos(bend), l_1 + l_2 * np.sin(bend))},
    "uses the arctangent of a quotient in the correction of θ₁":
        {"back": lambda l_1, l_2, bend: np.arctan(l_2 * np.sin(bend) / (l_1 + l_2 * np.cos(bend)))},
    "subtracts l₂ cos θ₂ in the correction of θ₁":
        {"back": lambda l_1, l_2, bend: np.arctan2(l_2 * np.sin(bend), l_1 - l_2 * np.cos(bend))},
    "exchanges the links in the correction of θ₁":
        {"back": lambda l_1, l_2, bend: np.arctan2(l_1 * np.sin(bend), l_2 + l_1 * np.cos(bend))},
    "takes half of θ₂ for the correction of θ₁": {"back": lambda l_1, l_2, bend: 0.5 * bend},
    "has the wrong sign of the elbow in the correction of θ₁":
        {"back": lambda l_1, l_2, bend: np.arctan2(l_2 * abs(np.sin(bend)), l_1 + l_2 * np.cos(bend))},
    "returns the angles in degrees": {"result": np.degrees},
    "returns the angles in the other order": {"result": lambda theta: np.array(theta[::-1])},
    "returns the direction of the second link for θ₂": {"result": lambda theta: np.array((theta[0], sum(theta)))},
    "returns θ₂ from 0 to 2π": {"result": lambda theta: np.array((theta[0], theta[1] % (2.0 * np.pi)))},
    "returns a straight arm for a target at the base":
        {"result": lambda theta: np.array((theta[0], theta[1] if abs(theta[1]) < np.pi else 0.0))},
})


alike("11.4", "uses the cosine of θ₂ or a difference of squares, which loses digits near the edges", two_links,
      {"bend": lambda r, a, b, l_1, l_2: np.arccos(np.clip(cosine(r, l_1, l_2), -1.0, 1.0))},
      {"bend": lambda r, a, b, l_1, l_2: np.arctan2(np.sqrt(np.maximum(1.0 - cosine(r, l_1, l_2)**2, 0.0)),
                                                    cosine(r, l_1, l_2))},
      {"bend": lambda r, a, b, *_: 2.0 * np.arctan2(np.sqrt(np.maximum(b * b - r * r, 0.0)),
                                                    np.sqrt(np.maximum(r * r - a * a, 0.0)))})
alike("11.4", "allows less than EDGE (l₁ + l₂) at the outer edge of the reach", two_links,
      {"too_far": lambda r, b: r > b}, {"too_far": lambda r, b: r > b + worked.EDGE},
      {"too_far": lambda r, b: r > b + 1e-15 * b}, {"too_far": lambda r, b: r * r > b * b + worked.EDGE})
alike("11.4", "allows less than EDGE (l₁ + l₂) at the inner edge of the reach", two_links,
      {"too_near": lambda r, a, b: r < a}, {"too_near": lambda r, a, b: r < a - worked.EDGE},
      {"too_near": lambda r, a, b: r < a - worked.EDGE * a})
alike("11.4", "does not refuse a target that is too far away", two_links,
      {"too_far": lambda r, b: False}, {"refuse": lambda r, *_: r},
      {"refuse": lambda r, a, b, target: min(max(r, a), b)})
alike("11.4", "refuses a target at the outer edge", two_links,
      {"too_far": lambda r, b: r >= b}, {"too_far": lambda r, b: r > b - worked.EDGE * b})
edit("11.4", "computes the bend at the base by the arccosine, which loses digits near the edges",
     "back = np.arctan2(lengths[1] * np.sin(theta_2), lengths[0] + lengths[1] * np.cos(theta_2))",
     "back = elbow * np.arccos(np.clip((r * r + lengths[0] ** 2 - lengths[1] ** 2) / "
     "max(2.0 * r * lengths[0], 1e-300), -1.0, 1.0))")
edit("11.4", "names the square of the distance", "[m]\", r,", "[m]\", r * r,")


@right("11.4", "by complex numbers")
def solve_2r(target, lengths, elbow):
    l_1, l_2, z = lengths[0], lengths[1], complex(target[0], target[1])
    r, a, b = abs(z), abs(l_1 - l_2), l_1 + l_2
    if not a - worked.EDGE * b <= r <= b + worked.EDGE * b:
        out_of_reach(r)
    theta_2 = elbow * half_angle(r, a, b)
    theta_1 = np.angle(z) - np.angle(l_1 + l_2 * np.exp(1j * theta_2))
    return np.array((np.angle(np.exp(1j * theta_1)), theta_2))


# 11.5 -----------------------------------------------------------------------------------------------------------
@variants
def three_links(direction=lambda target: target[2], hand=lambda lengths: lengths[2],
                way=lambda phi: np.array((np.cos(phi), np.sin(phi))), wrist=lambda end, hand: end - hand, links=same,
                side=same, solve=worked.solve_2r, last=lambda phi, theta: phi - theta[0] - theta[1],
                wrap=worked.wrapped, result=np.array):
    def solve_3r(target, lengths, elbow):
        phi = direction(target)
        theta = solve(wrist(target[:2], hand(lengths) * way(phi)), links(lengths), side(elbow))
        return result((theta[0], theta[1], wrap(last(phi, theta))))
    return solve_3r


def zeros_if_refused(*given):
    try:
        return worked.solve_2r(*given)
    except BadInput:
        return np.zeros(2)


def nearer_elbow(target, lengths, elbow):
    both = [worked.solve_2r(target, lengths, sign) for sign in (elbow, -elbow)]
    return min(both, key=lambda theta: np.sum(np.abs(theta)))


@right("11.5", "by complex numbers")
def solve_3r(target, lengths, elbow):
    z = complex(target[0], target[1]) - lengths[2] * np.exp(1j * target[2])
    theta = worked.solve_2r(np.array((z.real, z.imag)), lengths, elbow)
    return np.append(theta, np.angle(np.exp(1j * (target[2] - theta[0] - theta[1]))))


wrongs("11.5", three_links, {
    "solves the first two links for the end itself, not for the wrist": {"wrist": lambda end, hand: end},
    "puts the wrist beyond the end": {"wrist": lambda end, hand: end + hand},
    "puts the wrist beyond the end in x": {"wrist": lambda end, hand: end - hand * [-1.0, 1.0]},
    "puts the wrist beyond the end in y": {"wrist": lambda end, hand: end - hand * [1.0, -1.0]},
    "puts the wrist between the base and the end":
        {"wrist": lambda end, hand: end * (1.0 - np.linalg.norm(hand) / np.linalg.norm(end))},
    "exchanges sine and cosine": {"way": lambda phi: np.array((np.sin(phi), np.cos(phi)))},
    "uses the length of the second link for the wrist": {"hand": lambda lengths: lengths[1]},
    "uses the length of the first link for the wrist": {"hand": lambda lengths: lengths[0]},
    "uses all lengths for the wrist": {"hand": np.sum},
    "forgets the length of the third link": {"hand": lambda lengths: 1.0},
    "solves for the last two links": {"links": lambda lengths: lengths[1:]},
    "takes the lengths from the end": {"links": lambda lengths: lengths[::-1].copy()},
    "returns the same elbow twice": {"side": lambda elbow: 1.0},
    "returns the other elbow": {"side": lambda elbow: -elbow},
    "takes elbow = −1 always": {"side": lambda elbow: -1.0},
    "takes the elbow with the smaller angles": {"solve": nearer_elbow},
    "returns zeros where solve_2r raises": {"solve": zeros_if_refused},
    "takes φ in degrees": {"direction": lambda target: np.radians(target[2])},
    "takes the direction of the target for φ": {"direction": lambda target: np.arctan2(target[1], target[0])},
    "takes φ = 0": {"direction": lambda target: 0.0},
    "reverses the sign of φ": {"direction": lambda target: -target[2]},
    "takes the size of φ": {"direction": lambda target: abs(target[2])},
    "points the hand the other way": {"direction": lambda target: target[2] + np.pi},
    "takes half of φ": {"direction": lambda target: 0.5 * target[2]},
    "measures the third angle from the x axis": {"last": lambda phi, theta: phi},
    "subtracts only θ₁": {"last": lambda phi, theta: phi - theta[0]},
    "subtracts only θ₂": {"last": lambda phi, theta: phi - theta[1]},
    "adds the first two angles": {"last": lambda phi, theta: phi + theta[0] + theta[1]},
    "subtracts θ₁ and adds θ₂": {"last": lambda phi, theta: phi - theta[0] + theta[1]},
    "reverses θ₃": {"last": lambda phi, theta: theta[0] + theta[1] - phi},
    "forgets φ in θ₃": {"last": lambda phi, theta: -theta[0] - theta[1]},
    "returns the sum of the first two angles for θ₃": {"last": lambda phi, theta: theta[0] + theta[1]},
    "leaves the hand along the second link": {"last": lambda phi, theta: 0.0},
    "does not bring θ₃ back into (−π, π]": {"wrap": same},
    "returns θ₃ from 0 to 2π": {"wrap": lambda angle: angle % (2.0 * np.pi)},
    "adds 2π at most once, and never subtracts it":
        {"wrap": lambda angle: angle + 2.0 * np.pi * (angle < -np.pi)},
    "subtracts 2π at most once, and never adds it":
        {"wrap": lambda angle: angle - 2.0 * np.pi * (angle > np.pi)},
    "adds or subtracts 2π at most once":
        {"wrap": lambda angle: angle + 2.0 * np.pi * ((angle < -np.pi) - 1.0 * (angle > np.pi))},
    "takes θ₃ modulo π": {"wrap": lambda angle: angle - np.pi * np.round(angle / np.pi)},
    "cuts θ₃ off at π": {"wrap": lambda angle: min(max(angle, -np.pi), np.pi)},
    "returns two angles": {"result": lambda theta: np.array(theta[:2])},
    "returns the angles in the other order": {"result": lambda theta: np.array(theta[::-1])},
    "exchanges θ₁ and θ₂": {"result": lambda theta: np.array((theta[1], theta[0], theta[2]))},
    "returns directions from the x axis": {"result": np.cumsum},
    "returns the angles in degrees": {"result": np.degrees},
})
edit("11.5", "takes the last link off along x only", "target[1] - lengths[2] * np.sin(phi)", "target[1]")
edit("11.5", "uses the remainder, which has the sign of the angle, to wrap θ₃", "wrapped(phi - theta[0] - theta[1])",
     "np.fmod(phi - theta[0] - theta[1], 2.0 * np.pi)")
edit("11.5", "wraps φ, not θ₃", "wrapped(phi - theta[0] - theta[1])", "wrapped(phi) - theta[0] - theta[1]")
edit("11.5", "changes its input", "phi = target[2]", "target[2] = phi = wrapped(target[2])")
edit("11.5", "changes its input", "theta = solve_2r(wrist,", "target[:2] = wrist; theta = solve_2r(target[:2],")


# 11.6 -----------------------------------------------------------------------------------------------------------
@variants
def frames(given=same, axes_of=same, offsets_of=same, turn=lambda angle, axis, q: worked.exponential(angle * axis),
           product=lambda q, turn: worked.quaternion_product(q, turn),
           axis_in_world=lambda old, new, axis: worked.rotate(old, axis),
           ahead=lambda x, old, new, offset: x + worked.rotate(new, offset), result=lambda x, a, q: (x, a, q)):
    def joint_frames(theta, axes, offsets):
        x, a, q = [np.zeros(3)], [], np.array([1.0, 0.0, 0.0, 0.0])
        for angle, axis, offset in zip(given(theta), axes_of(axes), offsets_of(offsets), strict=True):
            old, q = q, product(q, turn(angle, axis, q))
            a.append(axis_in_world(old, q, axis))
            x.append(ahead(x[-1], old, q, offset))
        return result(np.array(x), np.array(a), q)
    return joint_frames


@right("11.6", "the new q gives the axis, too")
def joint_frames(theta, axes, offsets):
    x, a, q = np.zeros((len(theta) + 1, 3)), np.zeros((len(theta), 3)), np.array([1.0, 0.0, 0.0, 0.0])
    for k in range(len(theta)):
        q = worked.quaternion_product(q, worked.exponential(theta[k] * axes[k]))
        a[k], x[k + 1] = worked.rotate(q, axes[k]), x[k] + worked.rotate(q, offsets[k])
    return x, a, q


@right("11.6", "brings the angles into [0, 2π), which may lead to −q")
def frames_of_positive_angles(theta, axes, offsets):
    return worked.joint_frames(theta % (2.0 * np.pi), axes, offsets)


BAR = np.array([1.0, -1.0, -1.0, -1.0])                                  # times q: its conjugate


def by_first_order(angle, axis, q):
    return np.append(1.0, 0.5 * angle * axis)


wrongs("11.6", frames, {
    "does not rotate the axes into the world": {"axis_in_world": lambda old, new, axis: axis},
    "rotates the axes back": {"axis_in_world": lambda old, new, axis: worked.rotate(BAR * old, axis)},
    "squares the angles": {"turn": lambda angle, axis, q: worked.exponential(angle**2 * axis)},
    "rotates a joint's own link one joint late": {"ahead": lambda x, old, new, offset: x + worked.rotate(old, offset)},
    "does not rotate the offsets into the world": {"ahead": lambda x, old, new, offset: x + offset},
    "rotates the offsets back": {"ahead": lambda x, old, new, offset: x + worked.rotate(BAR * new, offset)},
    "does not add the positions of the joints before":
        {"ahead": lambda x, old, new, offset: np.array(worked.rotate(new, offset))},
    "subtracts the offsets": {"ahead": lambda x, old, new, offset: x - worked.rotate(new, offset)},
    "moves on by a length of 1": {"ahead": lambda x, old, new, offset:
                                  x + np.array(worked.rotate(new, offset)) / np.linalg.norm(offset)},
    "multiplies the rotations in the wrong order": {"product": lambda q, turn: worked.quaternion_product(turn, q)},
    "forgets the rotations of the joints before": {"product": lambda q, turn: turn},
    "adds the quaternions": {"product": lambda q, turn: q + turn - [1.0, 0.0, 0.0, 0.0]},
    "turns about the axis in the world, from the right":
        {"turn": lambda angle, axis, q: worked.exponential(angle * np.array(worked.rotate(q, axis)))},
    "turns by twice the angle":
        {"turn": lambda angle, axis, q: np.append(np.cos(angle), np.sin(angle) * axis)},
    "takes the rotation as small": {"turn": by_first_order},
    "takes the rotation as small, and normalises": {"turn": lambda angle, axis, q: by_first_order(angle, axis, q)
                                                    / np.linalg.norm(by_first_order(angle, axis, q))},
    "turns the other way": {"given": np.negative},
    "turns by the size of the angle": {"given": np.abs},
    "turns every joint by 1 rad": {"given": np.ones_like},
    "turns by half of the angle": {"given": lambda theta: 0.5 * theta},
    "adds up the angles": {"given": np.cumsum},
    "takes the angles in degrees": {"given": np.radians},
    "takes the angles from the end": {"given": lambda theta: theta[::-1]},
    "takes the axis of the next joint": {"axes_of": lambda axes: np.roll(axes, -1, axis=0)},
    "takes the axis of the joint before": {"axes_of": lambda axes: np.roll(axes, 1, axis=0)},
    "takes the axis of the first joint for all": {"axes_of": lambda axes: 0.0 * axes + axes[0]},
    "takes the axes from the end": {"axes_of": lambda axes: axes[::-1]},
    "turns all joints about z": {"axes_of": lambda axes: 0.0 * axes + [0.0, 0.0, 1.0]},
    "takes the offset of the joint before": {"offsets_of": lambda offsets: np.roll(offsets, 1, axis=0)},
    "takes the offset of the next joint": {"offsets_of": lambda offsets: np.roll(offsets, -1, axis=0)},
    "takes the offset of the first joint for all": {"offsets_of": lambda offsets: 0.0 * offsets + offsets[0]},
    "returns the conjugate of q": {"result": lambda x, a, q: (x, a, BAR * q)},
    "returns q with w last": {"result": lambda x, a, q: (x, a, np.roll(q, -1))},
    "returns the axes from the end": {"result": lambda x, a, q: (x, a[::-1].copy(), q)},
    "returns the axis of the joint before": {"result": lambda x, a, q: (x, np.roll(a, 1, axis=0), q)},
    "returns an axis for the end, too": {"result": lambda x, a, q: (x, np.vstack((a, a[-1:])), q)},
    "returns positions without the end": {"result": lambda x, a, q: (x[:-1], a, q)},
    "returns positions without the base": {"result": lambda x, a, q: (x[1:], a, q)},
    "returns the axes first": {"result": lambda x, a, q: (a, x, q)},
    "omits q": {"result": lambda x, a, q: (x, a)},
    "rounds q": {"result": lambda x, a, q: (x, a, np.round(q, 5))},
})
edit("11.6", "rotates the axis of the joint before", "put(a, k, rotate(q, axis))",
     "put(a, k, rotate(q, row(axes, max(k - 1, 0))))")
edit("11.6", "starts at the first offset", "x, a, q = np.zeros((n + 1, 3))",
     "x, a, q = np.zeros((n + 1, 3)) + offsets[0]")
edit("11.6", "starts from a quaternion of zeros", "np.array((1.0, 0.0, 0.0, 0.0))", "np.zeros(4)")
edit("11.6", "leaves out the last joint", "for k in range(n):", "a[n - 1] = 0.0\n    for k in range(n - 1):")
edit("11.6", "returns q before the last joint turns", "return x, a, q",
     "return x, a, quaternion_product(q, exponential(scaled(-theta[n - 1], row(axes, n - 1))))")
edit("11.6", "changes its input", "put(a, k, rotate(q, axis))",
     "put(axes, k, rotate(q, axis)); put(a, k, row(axes, k))")
edit("11.6", "multiplies the axes by the angles", "put(a, k, rotate(q, axis))",
     "put(a, k, rotate(q, scaled(theta[k], axis)))")
edit("11.6", "adds to the position of the joint before the last", "plus(row(x, k), 1.0,",
     "plus(row(x, max(k - 1, 0)), 1.0,")
edit("11.6", "moves on along the axes", "rotate(q, row(offsets, k))", "rotate(q, axis)")


# 11.7 -----------------------------------------------------------------------------------------------------------
@variants
def spatial(r=lambda x: x[-1] - x[:-1], axis=same, velocity=np.cross, spin=same, result=same):
    def jacobian_3d(x, a):
        return result(np.concatenate((velocity(axis(a), r(x)), spin(a)), axis=1).T)
    return jacobian_3d


def zero_rows(*rows):
    """The matrix with zeros in these rows."""
    return lambda J: np.where(np.isin(np.arange(len(J)), rows)[:, None], 0.0, J)


wrongs("11.7", spatial, {
    "reverses the cross product": {"velocity": lambda a, r: np.cross(r, a)},
    "forgets the cross product": {"velocity": lambda a, r: r},
    "has no minus sign in the cross product": {"velocity": lambda a, r: np.stack(
        [a[:, i] * r[:, k] + a[:, k] * r[:, i] for i, k in ((1, 2), (2, 0), (0, 1))], axis=1)},
    "has the wrong sign of y in the cross product": {"velocity": lambda a, r: np.cross(a, r) * [1.0, -1.0, 1.0]},
    "returns the velocity of a point at the origin": {"r": lambda x: -x[:-1]},
    "takes the position of the joint, not the offset of the end from it": {"r": lambda x: x[:-1]},
    "measures the arm from the next joint": {"r": lambda x: x[-1] - x[1:]},
    "uses only the joint's own link as the arm": {"r": lambda x: np.diff(x, axis=0)},
    "takes the position of the end, not its offset from the joint": {"r": lambda x: 0.0 * x[:-1] + x[-1]},
    "measures the arm to the last joint, not to the end": {"r": lambda x: x[-2] - x[:-1]},
    "measures the arm from the middle of the link": {"r": lambda x: x[-1] - 0.5 * (x[:-1] + x[1:])},
    "adds the two positions": {"r": lambda x: x[-1] + x[:-1]},
    "uses the axis of the first joint for all": {"axis": lambda a: 0.0 * a + a[0]},
    "uses the axis of the next joint": {"axis": lambda a: np.vstack((a[1:], a[-1:]))},
    "uses the axis of the joint before": {"axis": lambda a: np.vstack((a[:1], a[:-1]))},
    "uses the z axis for all": {"axis": lambda a: 0.0 * a + [0.0, 0.0, 1.0]},
    "omits the angular velocity": {"spin": lambda a: 0.0 * a},
    "reverses the angular velocity": {"spin": np.negative},
    "uses the last axis for the angular velocity": {"spin": lambda a: 0.0 * a + a[-1]},
    "adds up the axes": {"spin": lambda a: np.cumsum(a, axis=0)},
    "takes the angular velocity relative to the link before": {"spin": lambda a: a - np.vstack((0.0 * a[:1], a[:-1]))},
    "divides the axes by the sum of their entries": {"spin": lambda a: a / np.sum(np.abs(a), axis=1)[:, None]},
    "takes the angular velocity in degrees": {"spin": np.degrees},
    "puts the angular velocity first": {"result": lambda J: np.vstack((J[3:], J[:3]))},
    "omits the velocity of the end": {"result": zero_rows(0, 1, 2)},
    "reverses both velocities": {"result": np.negative},
    "adds up the velocities of the end": {"result": lambda J: np.vstack((np.cumsum(J[:3], axis=1), J[3:]))},
    "normalises the velocities of the end":
        {"result": lambda J: np.vstack((J[:3] / (np.linalg.norm(J[:3], axis=0) + 1e-300), J[3:]))},
    "omits the z component of the velocity": {"result": zero_rows(2)},
    "alternates rows of the two velocities": {"result": lambda J: J[[0, 3, 1, 4, 2, 5]]},
    "returns the first three rows": {"result": lambda J: J[:3]},
    "returns the last three rows": {"result": lambda J: J[3:]},
    "returns the rows of an arm in the plane": {"result": lambda J: J[[0, 1, 5]]},
    "returns the transpose": {"result": lambda J: J.T.copy()},
    "returns one row of all entries": {"result": np.ravel},
    "returns the columns from the last joint to the first": {"result": lambda J: J[:, ::-1].copy()},
    "returns a column for the end, too": {"result": lambda J: np.hstack((J, np.zeros((6, 1))))},
    "omits the last joint": {"result": lambda J: J[:, :-1]},
    "returns zeros for the last joint": {"result": zero_column(-1)},
    "returns zeros for the first joint": {"result": zero_column(0)},
    "takes the rates in degrees per second": {"result": np.radians},
    "rounds the entries": {"result": lambda J: np.round(J, 4)},
    "computes in whole numbers": {"result": np.trunc},
})
edit("11.7", "measures all arms from the base", "minus(row(x, n), row(x, k))", "minus(row(x, n), row(x, 0))")
FIRST_AXIS_ONLY = edit("11.7", "uses the first axis for the angular velocity", "a[k, c]", "a[0, c]")
edit("11.7", "changes its input", "n = a.shape[0]", "n = a.shape[0]; x -= x[n].copy()")
edit("11.7", "multiplies the angular velocity by the distance",
     "v[c], a[k, c]", "v[c], a[k, c] * np.sqrt(np.sum((x[n] - x[k])**2))")


# 11.8 -----------------------------------------------------------------------------------------------------------
@variants
def rotation(between=lambda q, q_target: worked.quaternion_product(q_target, BAR * q),
             shorter=lambda d: -d if d[0] < 0.0 else d, length=np.linalg.norm,
             angle=lambda size, w: 2.0 * np.arctan2(size, w), along=lambda angle, d, size: angle * d / size,
             small=lambda size: size == 0.0, nearly=lambda d: 2.0 * d, result=lambda phi, d, q: phi):
    def rotation_error(q, q_target):
        d = shorter(between(q, q_target))
        size = length(d[1:])
        with np.errstate(all="ignore"):
            phi = nearly(d[1:]) if small(size) else along(angle(size, d[0]), d[1:], size)
        return result(phi, d, q)
    return rotation_error


@right("11.8", "by the arctangent of a quotient, which takes the shorter way by itself")
def rotation_error(q, q_target):
    d = worked.quaternion_product(q_target, BAR * q)
    size = np.linalg.norm(d[1:])
    if size == 0.0:
        return 2.0 * d[1:]
    return 2.0 * (np.arctan(size / d[0]) if d[0] != 0.0 else 0.5 * np.pi) / size * d[1:]


def vector_of(q):
    """The rotation vector of an orientation."""
    return worked.rotation_error(np.array([1.0, 0.0, 0.0, 0.0]), q)


wrongs("11.8", rotation, {
    "returns the error in body coordinates": {"between": lambda q, to: worked.quaternion_product(BAR * q, to)},
    "reverses the rotation": {"between": lambda q, to: worked.quaternion_product(q, BAR * to)},
    "conjugates the target, on the left": {"between": lambda q, to: worked.quaternion_product(BAR * to, q)},
    "forgets the conjugate": {"between": lambda q, to: worked.quaternion_product(to, q)},
    "conjugates both": {"between": lambda q, to: worked.quaternion_product(BAR * q, BAR * to)},
    "has wrong signs in the conjugate":
        {"between": lambda q, to: worked.quaternion_product(to, q * [-1.0, 1.0, 1.0, -1.0])},
    "subtracts the quaternions": {"between": lambda q, to: to - q},
    "subtracts the rotation vectors": {"result": lambda phi, d, q:
                                       vector_of(worked.quaternion_product(d, q)) - vector_of(q)},
    "subtracts the vectors of the quaternions": {"result": lambda phi, d, q:
                                                 2.0 * (worked.quaternion_product(d, q) - q)[1:]},
    "rotates the longer way": {"shorter": same},
    "takes the shorter way for the longer one": {"shorter": lambda d: -d if d[0] > 0.0 else d},
    "reverses only w on the shorter way": {"shorter": lambda d: d * [np.sign(d[0]) or 1.0, 1.0, 1.0, 1.0]},
    "reverses only the vector on the shorter way": {"shorter": lambda d: BAR * d if d[0] < 0.0 else d},
    "takes the sizes of all entries": {"shorter": np.abs},
    "returns half of the angle": {"angle": lambda size, w: np.arctan2(size, w)},
    "uses the arccosine, which loses digits near 1": {"angle": lambda size, w: 2.0 * np.arccos(np.clip(w, -1.0, 1.0))},
    "uses the arcsine, which loses digits near half a turn":
        {"angle": lambda size, w: 2.0 * np.arcsin(min(size, 1.0))},
    "uses the arctangent of a quotient that it limits":
        {"angle": lambda size, w: 2.0 * np.arctan(size / max(abs(w), 1e-3))},
    "stops at a quarter turn": {"angle": lambda size, w: min(2.0 * np.arctan2(size, w), 0.5 * np.pi)},
    "exchanges the arguments of the arctangent": {"angle": lambda size, w: 2.0 * np.arctan2(w, size)},
    "takes the sine for the angle": {"angle": lambda size, w: 2.0 * size},
    "takes the tangent for the angle": {"angle": lambda size, w: 2.0 * size / w},
    "takes the sine of the whole angle": {"angle": lambda size, w: 2.0 * size * w},
    "takes half a turn for no rotation":
        {"angle": lambda size, w: 2.0 * np.arctan2(size, w) if w != 0.0 else 2.0 * size},
    "does not divide by |𝐝|": {"along": lambda angle, d, size: angle * d},
    "divides by the square of |𝐝|": {"along": lambda angle, d, size: angle * d / size**2},
    "returns the axis without the angle": {"along": lambda angle, d, size: d / size},
    "adds a small number to |𝐝|": {"along": lambda angle, d, size: angle * d / (size + 1e-9)},
    "divides zero by zero where no rotation is needed": {"small": lambda size: False},
    "takes 2𝐝 for rotations that are not small enough": {"small": lambda size: size < 1e-2},
    "takes the size of all four entries": {"length": lambda d: 1.0},
    "leaves z out of |𝐝|": {"length": lambda d: np.linalg.norm(d[:2])},
    "forgets the root in |𝐝|": {"length": lambda d: d @ d},
    "takes the largest entry for |𝐝|": {"length": lambda d: np.max(np.abs(d))},
    "returns degrees": {"result": lambda phi, d, q: np.degrees(phi)},
    "returns the angle only": {"result": lambda phi, d, q: np.linalg.norm(phi)},
    "returns four numbers": {"result": lambda phi, d, q: np.append(np.linalg.norm(phi), phi)},
    "takes w, x, y for the vector": {"result": lambda phi, d, q: np.append(
        np.linalg.norm(phi) * d[0] / max(np.linalg.norm(d[1:]), 1e-300), phi[:2])},
    "returns twice the angle": {"result": lambda phi, d, q: 2.0 * phi},
    "rotates the result by q": {"result": lambda phi, d, q: np.array(worked.rotate(q, phi))},
})
edit("11.8", "changes its input", "d = quaternion_product(q_target, np.array((q[0], -q[1], -q[2], -q[3])))",
     "q[1:] = -q[1:]; d = quaternion_product(q_target, q)")
edit("11.8", "makes w of its input positive, in place", "if d[0] < 0.0:",
     "if q[0] < 0.0: q *= -1.0\n    if d[0] < 0.0:")
edit("11.8", "makes w positive in q and in the target, not in d", "d[0] < 0.0", "q[0] * q_target[0] < 0.0")
edit("11.8", "returns zero for rotations below 1e-8", "2.0 if size == 0.0", "0.0 if size < 1e-8")
edit("11.8", "returns zero for rotations below 1e-12", "2.0 if size == 0.0", "0.0 if size < 1e-12")
edit("11.8", "returns zero for rotations below 1e-6", "2.0 if size == 0.0", "0.0 if size < 1e-6")


# 11.9 -----------------------------------------------------------------------------------------------------------
def rows(chosen):
    """A task of which only these rows are seen."""
    def of(task):
        def seen(theta, target, arm):
            e, J = task(theta, target, arm)
            return e[chosen], J[chosen].copy()
        return seen
    return of


def clipped(theta, arm):
    return np.clip(theta, arm.low, arm.high)


def blocked(change, theta, arm):
    """The change without that of joints which it would move out of their limits."""
    out = ((theta >= arm.high) & (change > 0.0)) | ((theta <= arm.low) & (change < 0.0))
    return np.where(out, 0.0, change)


def only_the_place(task):
    """The task without the direction of a pose in the plane."""
    def seen(theta, target, arm):
        e, J = task(theta, target, arm)
        return (e[:2], J[:2]) if len(e) == 3 else (e, J)
    return seen


SEEN = {                                                                  # of a task
    "uses only the place, where the task is a place and a direction": only_the_place,
    "uses only the first two rows of the task": rows(slice(2)),
    "uses only the first three rows of the task": rows(slice(3)),
    "uses only the first six rows of the task": rows(slice(6)),
    "omits the last row of the task": rows(slice(-1)),
    "uses reach_2d in place of the task":
        lambda task: lambda theta, target, arm: worked.reach_2d(theta, target[:2].copy(), arm),
    "takes target − x for e, regardless of the task":
        lambda task: lambda theta, target, arm: (target - worked.joint_positions(theta, arm.lengths)[-1],
                                                 worked.jacobian_2d(worked.joint_positions(theta, arm.lengths))),
    "computes J for θ = 0":
        lambda task: lambda theta, target, arm: (task(theta, target, arm)[0], task(0.0 * theta, target, arm)[1]),
    "uses the target for e": lambda task: lambda theta, target, arm: (target, task(theta, target, arm)[1]),
    "reverses the sign of e":
        lambda task: lambda theta, target, arm: (-task(theta, target, arm)[0], task(theta, target, arm)[1]),
    "brings e into (−π, π]": lambda task: lambda theta, target, arm: (
        worked.wrapped(task(theta, target, arm)[0]), task(theta, target, arm)[1]),
}
DONE = {                                                                  # with the change of θ
    "reverses the step": lambda theta, change, arm: theta - change,
    "returns the change, not the new angles": lambda theta, change, arm: change,
    "keeps the limits of the arm": lambda theta, change, arm: clipped(theta + change, arm),
    "blocks joints at their limits": lambda theta, change, arm: theta + blocked(change, theta, arm),
    "brings the angles into (−π, π]": lambda theta, change, arm: worked.wrapped(theta + change),
    "limits each change to 0.1 rad": lambda theta, change, arm: theta + np.clip(change, -0.1, 0.1),
    "limits each change to half a radian": lambda theta, change, arm: theta + np.clip(change, -0.5, 0.5),
    "limits each change to 1 rad": lambda theta, change, arm: theta + np.clip(change, -1.0, 1.0),
    "pulls the arm to rest": lambda theta, change, arm: theta + change + arm.pull * (arm.rest - theta),
    "changes the last joint first: the order is reversed": lambda theta, change, arm: theta + change[::-1],
    "moves only the last joint": lambda theta, change, arm: theta + change * (np.arange(len(theta)) == len(theta) - 1),
    "does not move the first joint": lambda theta, change, arm: theta + change * (np.arange(len(theta)) > 0),
    "does not move the last joint": lambda theta, change, arm: theta + np.append(change[:-1], 0.0),
    "divides the change by the number of joints": lambda theta, change, arm: theta + change / len(theta),
    "makes half of the step": lambda theta, change, arm: theta + 0.5 * change,
    "makes twice the step": lambda theta, change, arm: theta + 2.0 * change,
    "takes the sizes of the changes": lambda theta, change, arm: theta + np.abs(change),
    "normalises the change": lambda theta, change, arm: theta + change / (np.linalg.norm(change) + 1e-300),
    "damps the angles": lambda theta, change, arm: theta + change - arm.damping * theta,
    "rounds the angles": lambda theta, change, arm: np.round(theta + change, 5),
}


def shortened(e, most):
    """An error, no longer than this."""
    return e / max(1.0, np.linalg.norm(e) / most)


@variants
def transposed(of=same, error=same, gain=lambda arm, e, J: arm.gain, push=lambda e, J: J.T @ e,
               done=lambda theta, change, arm: theta + change):
    def transpose_step(task, theta, target, arm):
        e, J = of(task)(theta, target, arm)
        return done(theta, gain(arm, e, J) * push(error(e), J), arm)
    return transpose_step


def best_gain(arm, e, J):
    along = J @ (J.T @ e)
    return along @ e / (along @ along)


for story, part in SEEN.items():
    wrong("11.9", story)(transposed(of=part))
for story, part in DONE.items():
    wrong("11.9", story)(transposed(done=part))
wrongs("11.9", transposed, {
    "omits the gain": {"gain": lambda arm, e, J: 1.0},
    "squares the gain": {"gain": lambda arm, e, J: arm.gain**2},
    "divides by the gain": {"gain": lambda arm, e, J: 1.0 / arm.gain},
    "uses the pull in place of the gain": {"gain": lambda arm, e, J: arm.pull},
    "uses the damping in place of the gain": {"gain": lambda arm, e, J: arm.damping},
    "divides the gain by σ₁²": {"gain": lambda arm, e, J: arm.gain / np.linalg.norm(J, 2)**2},
    "uses 1/σ₁² for the gain": {"gain": lambda arm, e, J: 1.0 / np.linalg.norm(J, 2)**2},
    "limits the gain to 1/σ₁²": {"gain": lambda arm, e, J: min(arm.gain, 1.0 / np.linalg.norm(J, 2)**2)},
    "chooses the gain that is best for this e": {"gain": best_gain},
    "normalises the error": {"error": lambda e: e / (np.linalg.norm(e) + 1e-300)},
    "shortens an error that is longer than a metre": {"error": lambda e: shortened(e, 1.0)},
    "multiplies the error by its size": {"error": lambda e: e * np.linalg.norm(e)},
    "uses only the signs of e": {"error": np.sign},
    "squares the error": {"error": np.square},
    "uses only the signs of Jᵀ e": {"push": lambda e, J: np.sign(J.T @ e)},
    "uses the pseudo-inverse in place of the transpose": {"push": lambda e, J: np.linalg.pinv(J, 1e-10) @ e},
    "multiplies with J, not its transpose, where J is square":
        {"push": lambda e, J: (J if J.shape[0] == J.shape[1] else J.T) @ e},
    "normalises the columns of J": {"push": lambda e, J: (J / np.linalg.norm(J, axis=0)).T @ e},
    "scales the old angles, too": {"done": lambda theta, change, arm: (1.0 - arm.gain) * theta + change},
})
edit("11.9", "limits each change to 0.2 rad", "arm.gain * (e @ J)", "np.clip(arm.gain * (e @ J), -0.2, 0.2)")
edit("11.9", "always makes a step of one length: divides by the size of eᵀJ", "arm.gain * (e @ J)",
     "arm.gain * (e @ J) / max(np.sqrt((e @ J) @ (e @ J)), 1e-300)")
edit("11.9", "makes the step of the middle of the step", "return theta + arm.gain * (e @ J)",
     "e, J = task(theta + 0.5 * arm.gain * (e @ J), target, arm); return theta + arm.gain * (e @ J)")
edit("11.9", "changes its input", "return theta + arm", "theta[:] = theta + arm.gain * (e @ J)\n    return theta; arm")
edit("11.9", "does not move when the target is near", "return theta + arm.gain * (e @ J)",
     "return theta + arm.gain * (e @ J) * (np.sqrt(e @ e) > 1e-2)")
edit("11.9", "makes two steps", "return theta + arm.gain * (e @ J)",
     "theta = theta + arm.gain * (e @ J); e, J = task(theta, target, arm); return theta + arm.gain * (e @ J)")
edit("11.9", "goes back where the error would grow", "return theta + arm.gain * (e @ J)",
     "new = theta + arm.gain * (e @ J); f = task(new, target, arm)[0]; return new if f @ f < e @ e else theta")
edit("11.9", "moves one joint after the other, each with a new e", "return theta + arm.gain * (e @ J)",
     "theta = theta.copy()\n    for k in range(theta.size):\n        e, J = task(theta, target, arm)\n"
     "        theta[k] += arm.gain * (e @ J[:, k])\n    return theta")
edit("11.9", "returns e, too", "return theta + arm.gain * (e @ J)", "return theta + arm.gain * (e @ J), e")


# 11.10 ----------------------------------------------------------------------------------------------------------
@variants
def inverse(cut=lambda sigma: sigma[0] * 1e-10, power=1, few=lambda sigma: len(sigma), small=lambda sigma: 0.0 * sigma,
            result=same):
    def pseudo_inverse(J):
        u, sigma, v = np.linalg.svd(J, full_matrices=False)
        kept = (sigma > cut(sigma)) & (np.arange(len(sigma)) < few(sigma))
        with np.errstate(all="ignore"):
            parts = np.where(kept, sigma ** -float(power), small(sigma))
        return result((v.T * parts) @ u.T)
    return pseudo_inverse


@variants
def by_systems(singular=lambda J: np.linalg.pinv(J, 1e-10), regular=lambda J: np.linalg.pinv(J, 1e-10)):
    def pseudo_inverse(J):
        sigma = np.linalg.svd(J)[1]
        return (singular if sigma[-1] <= 1e-10 * sigma[0] else regular)(J)
    return pseudo_inverse


@right("11.10", "by NumPy")
def pseudo_inverse(J):
    return np.linalg.pinv(J, 1e-10)


@right("11.10", "by least squares")
def least_squares(J):
    return np.linalg.lstsq(J, np.eye(len(J)), rcond=1e-10)[0]


def eigen(cut):
    """J⁺ by the eigenvalues of J Jᵀ above that part of the largest."""
    def pseudo_inverse(J):
        values, u = np.linalg.eigh(J @ J.T)
        kept = values > cut * values[-1]
        return J.T @ (u[:, kept] / values[kept]) @ u[:, kept].T
    return pseudo_inverse


def by_rows(J):
    return J.T @ np.linalg.inv(J @ J.T)


def by_columns(J):
    return np.linalg.inv(J.T @ J) @ J.T


def refuse_singular(J):
    raise BadInput("the smallest singular value [m]", 0.0, "bend the arm")


wrongs("11.10", inverse, {
    "takes EDGE in place of SINGULAR": {"cut": lambda sigma: 1e-12 * sigma[0]},
    "compares with SINGULAR itself, not with that part of the largest σ": {"cut": lambda sigma: 1e-10},
    "keeps the largest singular value only": {"few": lambda sigma: 1},
    "keeps two singular values at most": {"few": lambda sigma: 2},
    "keeps three singular values at most": {"few": lambda sigma: 3},
    "drops the smallest singular value": {"few": lambda sigma: len(sigma) - 1},
    "divides by σ² in place of σ": {"power": 2},
    "does not divide by σ": {"power": 0},
    "multiplies by σ: returns the transpose": {"power": -1},
    "divides by SINGULAR σ₁ in place of the singular values below it":
        {"small": lambda sigma: 1e10 / sigma[0] + 0.0 * sigma},
    "exchanges rows and columns: returns the transpose of the pseudo-inverse": {"result": lambda P: P.T.copy()},
    "reverses the sign": {"result": np.negative},
})
alike("11.10", "drops singular values above SINGULAR σ₁", inverse,
      {"cut": lambda sigma: 1e-4 * sigma[0]},
      {"cut": lambda sigma: 1e-6 * sigma[0]},
      {"cut": lambda sigma: 1e-8 * sigma[0]},
      {"cut": lambda sigma: 1e-6},
      {"cut": lambda sigma: 1e-5 * sigma[0]})
alike("11.10", "inverts round-off", inverse,
      {"cut": lambda sigma: 0.0},
      {"cut": lambda sigma: 1e-10 * sigma[-1]},
      {"cut": lambda sigma: -1.0})
alike("11.10", "inverts singular values far below SINGULAR σ₁", inverse,
      {"cut": lambda sigma: 1e-15 * sigma[0]})
wrongs("11.10", by_systems, {
    "inverts J Jᵀ where that has no inverse": {"regular": by_rows},
    "inverts JᵀJ where that has no inverse": {"regular": by_columns},
    "inverts J Jᵀ or JᵀJ, whether it has an inverse or not":
        {"singular": lambda J: by_rows(J) if J.shape[0] <= J.shape[1] else by_columns(J)},
    "inverts a square J, whether it has an inverse or not":
        {"singular": lambda J: np.linalg.inv(J) if J.shape[0] == J.shape[1] else np.linalg.pinv(J, 1e-10)},
    "returns zeros where J is singular": {"singular": lambda J: 0.0 * J.T},
    "returns the transpose where J is singular": {"singular": lambda J: J.T.copy()},
    "raises an error where J is singular": {"singular": refuse_singular},
    "adds a small damping to J Jᵀ": {"regular": lambda J: J.T @ np.linalg.inv(J @ J.T + 1e-6 * np.eye(len(J)))},
})
edit("11.10", "keeps the last direction only", "J_plus[k, r] += v", "J_plus[k, r] = v")
edit("11.10", "keeps the small singular values only", "if not sigma[i] <= SINGULAR", "if sigma[i] <= SINGULAR")
edit("11.10", "divides zero by zero for J = 0", "not sigma[i] <= SINGULAR", "not sigma[i] < SINGULAR")
edit("11.10", "inverts J Jᵀ, regardless of J", "u, sigma, v = np.linalg.svd(J, False)",
     "return J.T @ np.linalg.inv(J @ J.T)")
edit("11.10", "inverts JᵀJ, regardless of J", "u, sigma, v = np.linalg.svd(J, False)",
     "return np.linalg.inv(J.T @ J) @ J.T")
edit("11.10", "inverts J Jᵀ with a small damping", "u, sigma, v = np.linalg.svd(J, False)",
     "return J.T @ np.linalg.inv(J @ J.T + 1e-12 * np.eye(J.shape[0]))")
edit("11.10", "takes the pseudo-inverse of J Jᵀ, whose singular values are squares",
     "u, sigma, v = np.linalg.svd(J, False)", "return J.T @ np.linalg.pinv(J @ J.T)")
edit("11.10", "divides by the sum of squares of J", "u, sigma, v = np.linalg.svd(J, False)",
     "return J.T / max(np.sum(J * J), 1e-300)")
edit("11.10", "divides each row by its square", "u, sigma, v = np.linalg.svd(J, False)",
     "return (J / np.maximum(np.sum(J * J, axis=1), 1e-300)[:, None]).T.copy()")
edit("11.10", "reads v by columns", "v[i, k]", "v[k % v.shape[0], i]")
edit("11.10", "reads u by rows", "u[r, i]", "u[i % u.shape[0], r % u.shape[1]]")
edit("11.10", "compares with the sum of all σ, not with the largest", "SINGULAR * sigma[0]", "SINGULAR * np.sum(sigma)")
edit("11.10", "changes its input", "return J_plus", "J[:] = 0.0; return J_plus")


# 11.11 ----------------------------------------------------------------------------------------------------------
@variants
def damping_of(of=same, error=same, weight=lambda arm, e, J: arm.damping**2,
               part=lambda sigma, w: sigma / (sigma**2 + w), done=lambda theta, change, arm: theta + change):
    def damped_step(task, theta, target, arm):
        e, J = of(task)(theta, target, arm)
        u, sigma, v = np.linalg.svd(J, full_matrices=False)
        with np.errstate(all="ignore"):
            parts = np.where(sigma > 1e-12 * sigma[0], part(sigma, weight(arm, e, J)), 0.0)
        return done(theta, v.T @ (parts * (u.T @ error(e))), arm)
    return damped_step


right("11.11", "as a system for all joints")(lambda task, theta, target, arm: theta + np.linalg.solve(
    task(theta, target, arm)[1].T @ task(theta, target, arm)[1] + arm.damping**2 * np.eye(len(theta)),
    task(theta, target, arm)[1].T @ task(theta, target, arm)[0]))
right("11.11", "by least squares, with a row for each joint")(lambda task, theta, target, arm: theta + np.linalg.lstsq(
    np.vstack((task(theta, target, arm)[1], arm.damping * np.eye(len(theta)))),
    np.append(task(theta, target, arm)[0], 0.0 * theta), rcond=None)[0])
for story, part in SEEN.items():
    wrong("11.11", story)(damping_of(of=part))
for story, part in DONE.items():
    wrong("11.11", story)(damping_of(done=part))
wrongs("11.11", damping_of, {
    "uses λ in place of λ²": {"weight": lambda arm, e, J: arm.damping},
    "uses twice the damping": {"weight": lambda arm, e, J: 2.0 * arm.damping**2},
    "uses half of the damping": {"weight": lambda arm, e, J: 0.5 * arm.damping**2},
    "uses λ⁴": {"weight": lambda arm, e, J: arm.damping**4},
    "uses the gain in place of the damping": {"weight": lambda arm, e, J: arm.gain},
    "uses the square of the gain in place of that of the damping": {"weight": lambda arm, e, J: arm.gain**2},
    "uses the square of the pull in place of that of the damping": {"weight": lambda arm, e, J: arm.pull**2},
    "uses a damping of 1 for all arms": {"weight": lambda arm, e, J: 1.0},
    "uses a damping of ½ m² for all arms": {"weight": lambda arm, e, J: 0.5},
    "uses a damping that is not below 1e-6": {"weight": lambda arm, e, J: max(arm.damping**2, 1e-6)},
    "adds a small number to the damping": {"weight": lambda arm, e, J: arm.damping**2 + 1e-6},
    "divides by λ²": {"weight": lambda arm, e, J: 1.0 / arm.damping**2},
    "multiplies the damping by σ₁": {"weight": lambda arm, e, J: (arm.damping * np.linalg.norm(J, 2))**2},
    "multiplies the damping by |e|": {"weight": lambda arm, e, J: arm.damping**2 * (e @ e)},
    "multiplies λ² by |e|": {"weight": lambda arm, e, J: arm.damping**2 * np.linalg.norm(e)},
    "multiplies the damping by the number of joints": {"weight": lambda arm, e, J: arm.damping**2 * J.shape[1]},
    "divides by σ + λ": {"part": lambda sigma, w: 1.0 / (sigma + np.sqrt(w))},
    "forgets J in Jᵀ (J Jᵀ + λ²)⁻¹": {"part": lambda sigma, w: 1.0 / (sigma**2 + w)},
    "multiplies by J Jᵀ in place of solving with it": {"part": lambda sigma, w: sigma * (sigma**2 + w)},
    "makes a transpose step, divided by λ²": {"part": lambda sigma, w: sigma / w},
    "makes the step of the pseudo-inverse": {"part": lambda sigma, w: 1.0 / sigma},
    "shortens the step of the pseudo-inverse": {"part": lambda sigma, w: 1.0 / (sigma * (1.0 + w))},
    "normalises the error": {"error": lambda e: e / (np.linalg.norm(e) + 1e-300)},
    "shortens an error that is longer than a metre": {"error": lambda e: shortened(e, 1.0)},
    "multiplies by the gain": {"done": lambda theta, change, arm: theta + arm.gain * change},
    "scales the step down as well": {"done": lambda theta, change, arm: theta + change / (1.0 + arm.damping)},
    "scales the old angles, too": {"done": lambda theta, change, arm: (1.0 - arm.damping**2) * theta + change},
})
for least in (lambda arm: 1e-3, lambda arm: arm.damping):
    wrong("11.11", "damps only where the smallest σ is small")(damping_of(
        weight=lambda arm, e, J, least=least: arm.damping**2 * (np.linalg.svd(J)[1][-1] < least(arm))))
edit("11.11", "omits the damping", "arm.damping * arm.damping", "0.0")
edit("11.11", "adds λ² off the diagonal, too", "A[r, r] +=", "A[r] +=")
edit("11.11", "subtracts λ²", "A[r, r] += arm", "A[r, r] -= arm")
edit("11.11", "adds λ² to the first entry only", "A[r, r] +=", "A[0, 0] +=")
edit("11.11", "adds λ² in the first row only", "range(e.size)", "range(1)")
edit("11.11", "adds λ² in the first two rows only", "range(e.size)", "range(2)")
edit("11.11", "adds λ² in the first three rows only", "range(e.size)", "range(min(e.size, 3))")
edit("11.11", "does not add λ² in the last row", "range(e.size)", "range(e.size - 1)")
edit("11.11", "multiplies the diagonal by 1 + λ²", "A[r, r] += arm", "A[r, r] += A[r, r] * arm")
edit("11.11", "replaces the diagonal by λ²", "A[r, r] += arm", "A[r, r] = arm")
edit("11.11", "divides by the diagonal only", "solve_symmetric(A, e)", "e / np.diag(A)")
edit("11.11", "forgets Jᵀ", "sum_of_rows(J, solve_symmetric(A, e))", "np.resize(solve_symmetric(A, e), theta.size)")
edit("11.11", "refuses λ = 0", "A = row_products(J)",
     "A = row_products(J)\n    if arm.damping == 0.0: raise BadInput('the damping [m]', 0.0, 'give more')")
edit("11.11", "changes its input", "return theta + sum_of_rows(J, solve_symmetric(A, e))",
     "theta += sum_of_rows(J, solve_symmetric(A, e)); return theta")
edit("11.11", "limits the step of the pseudo-inverse to |e|/(2λ)", "A = row_products(J)",
     "d, most = pseudo_inverse(J) @ e, np.sqrt(e @ e) / (2.0 * arm.damping + 1e-300)\n"
     "    return theta + d * min(1.0, most / np.sqrt(d @ d))")
edit("11.11", "makes two steps", "return theta + sum_of_rows(J, solve_symmetric(A, e))",
     "theta = theta + sum_of_rows(J, solve_symmetric(A, e)); e, J = task(theta, target, arm); A = row_products(J)\n"
     "    return theta + sum_of_rows(J, solve_symmetric(A + arm.damping**2 * np.eye(e.size), e))")


# 11.12 ----------------------------------------------------------------------------------------------------------
@variants
def factors(slow=lambda sigma, gain, damping: 1.0 - gain * sigma**2,
            calm=lambda sigma, gain, damping: damping**2 / (sigma**2 + damping**2), given=same, result=same):
    def contraction_factors(sigma, gain, damping):
        with np.errstate(all="ignore"):
            sigma = given(np.array(sigma))
            return result((slow(sigma, gain, damping), calm(sigma, gain, damping)))
    return contraction_factors


wrongs("11.12", factors, {story: {"slow": part} for story, part in {
    "uses σ in place of σ²": lambda sigma, gain, damping: 1.0 - gain * sigma,
    "uses σ⁴ in place of σ²": lambda sigma, gain, damping: 1.0 - gain * sigma**4,
    "returns the share that is done for the transpose": lambda sigma, gain, damping: gain * sigma**2,
    "adds the step to the error": lambda sigma, gain, damping: 1.0 + gain * sigma**2,
    "reverses the sign for the transpose": lambda sigma, gain, damping: gain * sigma**2 - 1.0,
    "forgets the 1 for the transpose": lambda sigma, gain, damping: -gain * sigma**2,
    "returns sizes in place of signed factors": lambda sigma, gain, damping: np.abs(1.0 - gain * sigma**2),
    "squares the factor of the transpose": lambda sigma, gain, damping: (1.0 - gain * sigma**2)**2,
    "uses half of the gain": lambda sigma, gain, damping: 1.0 - 0.5 * gain * sigma**2,
    "uses twice the gain": lambda sigma, gain, damping: 1.0 - 2.0 * gain * sigma**2,
    "squares the gain": lambda sigma, gain, damping: 1.0 - (gain * sigma)**2,
    "squares gain and σ²": lambda sigma, gain, damping: 1.0 - (gain * sigma**2)**2,
    "forgets the gain": lambda sigma, gain, damping: 1.0 - sigma**2,
    "divides the gain by σ²": lambda sigma, gain, damping: 1.0 - gain / sigma**2,
    "divides the gain by σ": lambda sigma, gain, damping: 1.0 - gain / sigma,
    "divides σ² by the gain": lambda sigma, gain, damping: 1.0 - sigma**2 / gain,
    "forgets σ": lambda sigma, gain, damping: 1.0 - gain + 0.0 * sigma,
    "multiplies the factor by σ": lambda sigma, gain, damping: sigma - gain * sigma**3,
    "writes σ − α σ²": lambda sigma, gain, damping: sigma - gain * sigma**2,
    "writes σ² − α": lambda sigma, gain, damping: sigma**2 - gain,
    "does not let the factor be negative": lambda sigma, gain, damping: np.maximum(1.0 - gain * sigma**2, 0.0),
    "does not let the factor be below −1": lambda sigma, gain, damping: np.maximum(1.0 - gain * sigma**2, -1.0),
    "returns an exponential": lambda sigma, gain, damping: np.exp(-gain * sigma**2),
    "returns 1/(1 + α σ²)": lambda sigma, gain, damping: 1.0 / (1.0 + gain * sigma**2),
    "uses the largest σ for all": lambda sigma, gain, damping: 1.0 - gain * np.max(sigma)**2 + 0.0 * sigma,
    "uses the smallest σ for all": lambda sigma, gain, damping: 1.0 - gain * np.min(sigma)**2 + 0.0 * sigma,
    "compares the gain with its limit 2/σ₁²":
        lambda sigma, gain, damping: 1.0 - 2.0 * gain * sigma**2 / np.max(sigma)**2,
    "uses the damping in place of the gain": lambda sigma, gain, damping: 1.0 - damping * sigma**2,
    "returns the slowest factor for all":
        lambda sigma, gain, damping: np.max(np.abs(1.0 - gain * sigma**2)) + 0.0 * sigma,
}.items()})
wrongs("11.12", factors, {story: {"calm": part} for story, part in {
    "uses λ in place of λ²": lambda sigma, gain, damping: damping / (sigma**2 + damping),
    "uses σ in place of σ² for the damped step": lambda sigma, gain, damping: damping**2 / (sigma + damping**2),
    "uses σ and λ in place of their squares": lambda sigma, gain, damping: damping / (sigma + damping),
    "squares the sum, in place of adding squares": lambda sigma, gain, damping: (damping / (sigma + damping))**2,
    "squares λ only below the fraction bar": lambda sigma, gain, damping: damping / (sigma**2 + damping**2),
    "returns the share that is done for the damped step":
        lambda sigma, gain, damping: sigma**2 / (sigma**2 + damping**2),
    "forgets Jᵀ in the damped step: 1 − σ/(σ² + λ²)":
        lambda sigma, gain, damping: 1.0 - sigma / (sigma**2 + damping**2),
    "forgets J Jᵀ in the damped step: 1 − 1/(σ² + λ²)":
        lambda sigma, gain, damping: 1.0 - 1.0 / (sigma**2 + damping**2),
    "returns the part of P, σ/(σ² + λ²)": lambda sigma, gain, damping: sigma / (sigma**2 + damping**2),
    "returns the inverse of σ² + λ²": lambda sigma, gain, damping: 1.0 / (sigma**2 + damping**2),
    "omits the damping in the denominator": lambda sigma, gain, damping: damping**2 / sigma**2,
    "omits the damping: 1 − σ²/λ²": lambda sigma, gain, damping: 1.0 - sigma**2 / damping**2,
    "subtracts λ² in the denominator": lambda sigma, gain, damping: damping**2 / (sigma**2 - damping**2),
    "reverses the sign for the damped step": lambda sigma, gain, damping: -damping**2 / (sigma**2 + damping**2),
    "multiplies σ² by λ²": lambda sigma, gain, damping: 1.0 - damping**2 * sigma**2,
    "squares the factor of the damped step": lambda sigma, gain, damping: (damping**2 / (sigma**2 + damping**2))**2,
    "takes the root of the factor": lambda sigma, gain, damping: damping / np.sqrt(sigma**2 + damping**2),
    "uses the gain in place of the damping": lambda sigma, gain, damping: gain**2 / (sigma**2 + gain**2),
    "multiplies the damped step by the gain":
        lambda sigma, gain, damping: 1.0 - gain * sigma**2 / (sigma**2 + damping**2),
    "adds the damped step to the error": lambda sigma, gain, damping: 1.0 + sigma**2 / (sigma**2 + damping**2),
    "uses the smallest σ for all in the damped step":
        lambda sigma, gain, damping: damping**2 / (np.min(sigma)**2 + damping**2) + 0.0 * sigma,
    "multiplies both factors":
        lambda sigma, gain, damping: (1.0 - gain * sigma**2) * damping**2 / (sigma**2 + damping**2),
    "divides zero by zero for σ = 0":
        lambda sigma, gain, damping: damping**2 / sigma**2 / (1.0 + damping**2 / sigma**2),
}.items()})
wrongs("11.12", factors, {
    "returns the share that is done, not the share that is left":
        {"result": lambda both: (1.0 - both[0], 1.0 - both[1])},
    "exchanges the two factors": {"result": lambda both: both[::-1]},
    "returns only the slowest factors": {"result": lambda both: tuple(np.max(np.abs(one)) for one in both)},
    "squares both factors": {"result": lambda both: (both[0]**2, both[1]**2)},
    "returns matrices": {"result": lambda both: tuple(map(np.diag, both))},
    "returns one array of both": {"result": lambda both: np.stack(both, axis=1)},
    "returns only the factors of the transpose": {"result": lambda both: both[0]},
    "returns the factors in rising order of σ": {"given": np.sort},
    "returns the factors in falling order of σ": {"given": lambda sigma: np.sort(sigma)[::-1]},
    "takes σ² for σ": {"given": np.square},
    "takes only the first two σ": {"given": lambda sigma: sigma[:2]},
})
edit("11.12", "returns the part of P, α σ, for the transpose", "1.0 - gain * sigma**2", "gain * sigma")
edit("11.12", "takes the gain as a part of 1/σ₁²", "gain * sigma**2", "gain * sigma**2 / np.max(sigma) ** 2")
edit("11.12", "changes its input", "return 1.0 - gain * sigma**2, damping**2 / (sigma**2 + damping**2)",
     "sigma *= sigma; return 1.0 - gain * sigma, damping**2 / (sigma + damping**2)")
edit("11.12", "forgets all squares", "gain * sigma**2, damping**2 / (sigma**2 + damping**2)",
     "gain * sigma, damping / (sigma + damping)")
right("11.12", "as in the hint")(lambda sigma, gain, damping: (
    1.0 - gain * sigma**2, 1.0 - sigma**2 / (sigma**2 + damping**2)))


# 11.13 ----------------------------------------------------------------------------------------------------------
def angle_between(r, s):
    """The angle by which r must turn to point along s, of complex numbers."""
    return np.angle(s * np.conj(r))


def afterwards(wish, *_):
    """Limits that the sweep does not know."""
    return wish


@variants
def descent(order=lambda n: reversed(range(n)), r=lambda z, k: z[-1] - z[k], s=lambda goal, z, k: goal - z[k],
            turn=angle_between, wish=lambda theta, turn: theta + turn,
            limited=lambda wish, theta, low, high, k: min(max(wish, low[k]), high[k]),
            moved=lambda wish, new, old: new - old,
            end=lambda z, k, turned, goal, new: z[k] + np.exp(1j * turned) * (z[-1] - z[k]),
            every=same, done=lambda theta, arm, before: theta):
    def ccd_step(task, theta, target, arm):
        before, theta, goal = theta, np.array(theta), complex(*target)
        z = worked.joint_positions(theta, arm.lengths) @ np.array([1.0, 1j])
        for k in order(len(theta)):
            wished = wish(theta[k], turn(r(z, k), s(goal, z, k)))
            old, theta[k] = theta[k], limited(wished, theta[k], arm.low, arm.high, k)
            z[-1] = end(z, k, moved(wished, theta[k], old), goal, theta[k])
        return done(clipped(theta, arm) if limited is afterwards else theta, arm, before)
    return ccd_step


@variants
def descent_anew(order=lambda n: reversed(range(n))):
    """All positions are computed anew for each joint."""
    def ccd_step(task, theta, target, arm):
        theta = np.array(theta)
        for k in order(len(theta)):
            x = worked.joint_positions(theta, arm.lengths)
            turn = angle_between(complex(*(x[-1] - x[k])), complex(*(target - x[k])))
            theta[k] = min(max(theta[k] + turn, arm.low[k]), arm.high[k])
        return theta
    return ccd_step


wrongs("11.13", descent, {
    "visits the joints from the first to the last": {"order": range},
    "turns the last joint only": {"order": lambda n: (n - 1,)},
    "turns the first joint only": {"order": lambda n: (0,)},
    "does not turn the first joint": {"order": lambda n: range(n - 1, 0, -1)},
    "does not turn the last joint": {"order": lambda n: range(n - 2, -1, -1)},
    "sweeps back and forth, with old positions": {"order": lambda n: (*range(n - 1, -1, -1), *range(1, n))},
    "measures r from the base": {"r": lambda z, k: z[-1]},
    "uses the joint's own link for r": {"r": lambda z, k: z[k + 1] - z[k]},
    "measures s from the base": {"s": lambda goal, z, k: goal},
    "measures s from the end": {"s": lambda goal, z, k: goal - z[-1]},
    "rotates away from the target": {"turn": lambda r, s: -angle_between(r, s)},
    "exchanges the arguments of the arctangent":
        {"turn": lambda r, s: np.arctan2((s * np.conj(r)).real, (s * np.conj(r)).imag)},
    "uses the arctangent of a quotient":
        {"turn": lambda r, s: np.arctan((s * np.conj(r)).imag / ((s * np.conj(r)).real or 1e-300))},
    "uses the arccosine, which has no sign": {"turn": lambda r, s: abs(angle_between(r, s))},
    "uses the arcsine, which ends at a right angle":
        {"turn": lambda r, s: np.arcsin(np.sin(angle_between(r, s)))},
    "has a wrong sign in the cross product":
        {"turn": lambda r, s: np.arctan2(r.real * s.imag + r.imag * s.real, r.real * s.real + r.imag * s.imag)},
    "has a wrong sign in the dot product":
        {"turn": lambda r, s: np.arctan2(r.real * s.imag - r.imag * s.real, r.real * s.real - r.imag * s.imag)},
    "does not wrap the difference of two directions": {"turn": lambda r, s: np.angle(s) - np.angle(r)},
    "takes the direction of s for the turn": {"turn": lambda r, s: np.angle(s)},
    "limits each turn to half a radian": {"turn": lambda r, s: min(max(angle_between(r, s), -0.5), 0.5)},
    "limits each turn to 1 rad": {"turn": lambda r, s: min(max(angle_between(r, s), -1.0), 1.0)},
    "makes no small turns, or ends the sweep near the target":
        {"turn": lambda r, s: angle_between(r, s) * (abs(angle_between(r, s)) > 0.05)},
    "makes half of each rotation": {"wish": lambda theta, turn: theta + 0.5 * turn},
    "replaces the angle by the turn": {"wish": lambda theta, turn: turn},
    "brings each angle into (−π, π]": {"wish": lambda theta, turn: worked.wrapped(theta + turn)},
    "omits the limits": {"limited": lambda wish, theta, low, high, k: wish},
    "omits the upper limits": {"limited": lambda wish, theta, low, high, k: max(wish, low[k])},
    "omits the lower limits": {"limited": lambda wish, theta, low, high, k: min(wish, high[k])},
    "exchanges the limits": {"limited": lambda wish, theta, low, high, k: min(max(wish, high[k]), low[k])},
    "uses the limits of the first joint for all":
        {"limited": lambda wish, theta, low, high, k: min(max(wish, low[0]), high[0])},
    "uses the limits of the joints from the end":
        {"limited": lambda wish, theta, low, high, k: min(max(wish, low[-1 - k]), high[-1 - k])},
    "takes −high for the lower limit":
        {"limited": lambda wish, theta, low, high, k: min(max(wish, -high[k]), high[k])},
    "limits the turn, not the angle":
        {"limited": lambda wish, theta, low, high, k: theta + min(max(wish - theta, low[k]), high[k])},
    "does not move a joint that would leave its limits":
        {"limited": lambda wish, theta, low, high, k: wish if low[k] <= wish <= high[k] else theta},
    "moves the end as if there were no limits": {"moved": lambda wish, new, old: wish - old},
    "turns the end by the new angle, not by its change": {"moved": lambda wish, new, old: new},
    "turns the end the other way": {"moved": lambda wish, new, old: old - new},
    "does not move the end between the joints": {"end": lambda z, k, turned, goal, new: z[-1]},
    "puts the end at the target": {"end": lambda z, k, turned, goal, new: goal},
    "turns the end about the base": {"end": lambda z, k, turned, goal, new: np.exp(1j * turned) * z[-1]},
    "does not add the joint after it has turned the end":
        {"end": lambda z, k, turned, goal, new: np.exp(1j * turned) * (z[-1] - z[k])},
    "does not subtract the joint before it turns the end":
        {"end": lambda z, k, turned, goal, new: z[k] + np.exp(1j * turned) * z[-1]},
    "exchanges sine and cosine in the turn of the end": {"end": lambda z, k, turned, goal, new:
        z[k] + (np.sin(turned) + 1j * np.cos(turned)) * (z[-1] - z[k])},
    "applies the limits only after the sweep": {"limited": afterwards},
    "returns the changes, not the new angles": {"done": lambda theta, arm, before: theta - before},
    "brings the new angles into (−π, π]": {"done": lambda theta, arm, before: worked.wrapped(theta)},
})
wrongs("11.13", descent_anew, {
    "sweeps twice": {"order": lambda n: 2 * [*range(n - 1, -1, -1)]},
    "sweeps back and forth": {"order": lambda n: (*range(n - 1, -1, -1), *range(1, n))},
    "visits the joints from the first to the last, with new positions": {"order": range},
})
edit("11.13", "changes its input", "float_copy(theta)", "theta")
edit("11.13", "divides by the distance of the end, which may be zero", "np.arctan2(r_x * s_y",
     "0.0 / np.hypot(r_x, r_y) + np.arctan2(r_x * s_y")
edit("11.13", "takes a lower limit above zero as zero", "arm.low[k])", "min(arm.low[k], 0.0))")
edit("11.13", "takes an upper limit below zero as zero", "arm.high[k])", "max(arm.high[k], 0.0))")
edit("11.13", "ends the sweep at the first limit", "c, s = np.cos(new - theta[k])",
     "if new != wish: theta[k] = new; break\n        c, s = np.cos(new - theta[k])")
edit("11.13", "turns about the next joint", "r_x, r_y, s_x, s_y = end_x", "x[k] = x[k + 1]; r_x, r_y, s_x, s_y = end_x")


# 11.14 ----------------------------------------------------------------------------------------------------------
@variants
def projections(base=lambda old, y: old[0], goal=lambda y, target, old: target, lengths_back=same, lengths_forth=same,
                joints_back=lambda n: reversed(range(n)), joints_forth=range,
                back=lambda y, k, length, old, target: worked.point_at(y[k + 1], y[k], length),
                forth=lambda y, k, length, old, target: worked.point_at(y[k], y[k + 1], length),
                rounds=1, early=lambda y, target, lengths: None, done=lambda y, old, target: y):
    def fabrik_sweep(x, target, lengths):
        old, y, n = np.array(x), np.array(x), len(lengths)
        if early(y, target, lengths) is not None:
            return early(y, target, lengths)
        for _ in range(rounds):
            y[n] = goal(y[n], target, old)
            for k in joints_back(n):
                y[k] = back(y, k, lengths_back(lengths)[k], old, target)
            y[0] = base(old, y)
            for k in joints_forth(n):
                y[k + 1] = forth(y, k, lengths_forth(lengths)[k], old, target)
        return done(y, old, target)
    return fabrik_sweep


def is_far(y, target, lengths):
    return np.linalg.norm(target - y[0]) > np.sum(lengths)


def stretched(y, target, lengths):
    """The arm straight towards a target out of reach."""
    way = (target - y[0]) / np.linalg.norm(target - y[0])
    return y[0] + np.append(0.0, np.cumsum(lengths))[:, None] * way


def longer_only(p, q, length):
    return worked.point_at(p, q, length) if np.linalg.norm(q - p) > length else q


def without_care(p, q, length):
    with np.errstate(all="ignore"):
        return p + length * (q - p) / np.linalg.norm(q - p)


@right("11.14", "joint 0 stays on the way back, because it returns anyhow")
def fabrik_sweep(x, target, lengths):
    x, n = np.array(x, dtype=float), len(lengths)
    x[n] = target
    for k in range(n - 1, 0, -1):
        x[k] = worked.point_at(x[k + 1], x[k], lengths[k])
    for k in range(n):
        x[k + 1] = worked.point_at(x[k], x[k + 1], lengths[k])
    return x


wrongs("11.14", projections, {
    "makes the backward pass only": {"joints_forth": lambda n: ()},
    "makes the forward pass only": {"joints_back": lambda n: ()},
    "does not put the end to the target": {"goal": lambda end, target, old: end},
    "does not put the base back, so that the forward pass changes nothing": {"base": lambda old, y: y[0]},
    "moves the base to the origin": {"base": lambda old, y: 0.0 * y[0]},
    "uses the lengths in the wrong order in the backward pass": {"lengths_back": lambda l: l[::-1]},
    "uses the lengths in the wrong order in the forward pass": {"lengths_forth": lambda l: l[::-1]},
    "uses the length of the next link in the backward pass": {"lengths_back": lambda l: np.append(l[1:], l[-1])},
    "uses the length of the link before in the forward pass": {"lengths_forth": lambda l: np.roll(l, 1)},
    "squares the lengths in the forward pass": {"lengths_forth": np.square},
    "moves the base too little: the backward pass ends at joint 2": {"joints_back": lambda n: range(n - 1, 1, -1)},
    "leaves out the last joint on the way back": {"joints_back": lambda n: range(n - 2, -1, -1)},
    "makes the backward pass from the first joint to the last": {"joints_back": range},
    "makes the forward pass from the last joint to the first": {"joints_forth": lambda n: reversed(range(n))},
    "leaves out the last link on the way forth": {"joints_forth": lambda n: range(n - 1)},
    "exchanges the two points: measures from the old point to the new one":
        {"back": lambda y, k, length, old, target: worked.point_at(y[k], y[k + 1], length)},
    "exchanges the two points on the way forth":
        {"forth": lambda y, k, length, old, target: worked.point_at(y[k + 1], y[k], length)},
    "uses the old positions in the backward pass":
        {"back": lambda y, k, length, old, target: worked.point_at(old[k + 1], y[k], length)},
    "uses the positions before the sweep in the forward pass":
        {"forth": lambda y, k, length, old, target: worked.point_at(y[k], old[k + 1], length)},
    "uses the positions before the sweep for both points in the forward pass":
        {"forth": lambda y, k, length, old, target: worked.point_at(old[k], y[k + 1], length)},
    "moves both points by half in the backward pass":
        {"back": lambda y, k, length, old, target: 0.5 * (y[k] + worked.point_at(y[k + 1], y[k], length))},
    "shortens links only, in the backward pass":
        {"back": lambda y, k, length, old, target: longer_only(y[k + 1], y[k], length)},
    "points all links at the base in the backward pass":
        {"back": lambda y, k, length, old, target: worked.point_at(y[k + 1], old[0], length)},
    "points all links at the target in the forward pass":
        {"forth": lambda y, k, length, old, target: worked.point_at(y[k], target, length)},
    "points to the other side in the backward pass":
        {"back": lambda y, k, length, old, target: 2.0 * y[k + 1] - worked.point_at(y[k + 1], y[k], length)},
    "divides zero by zero where two points coincide, on the way back":
        {"back": lambda y, k, length, old, target: without_care(y[k + 1], y[k], length)},
    "divides zero by zero where two points coincide, on the way forth":
        {"forth": lambda y, k, length, old, target: without_care(y[k], y[k + 1], length)},
    "sweeps twice": {"rounds": 2},
    "sweeps until the end is at the target": {"rounds": 100},
    "stretches the arm towards a target out of reach":
        {"early": lambda y, target, lengths: stretched(y, target, lengths) if is_far(y, target, lengths) else None},
    "does nothing for a target out of reach":
        {"early": lambda y, target, lengths: y if is_far(y, target, lengths) else None},
    "does nothing for a target that is near":
        {"early": lambda y, target, lengths: y if np.linalg.norm(target - y[-1]) < 1e-3 else None},
    "puts the end to the target again after the sweep":
        {"done": lambda y, old, target: np.vstack((y[:-1], target[None]))},
    "leaves out the base": {"done": lambda y, old, target: y[1:]},
    "returns the end only": {"done": lambda y, old, target: y[-1]},
    "returns the end first": {"done": lambda y, old, target: y[::-1].copy()},
    "returns positions relative to the base": {"done": lambda y, old, target: y - y[0]},
    "moves only x and y": {"done": lambda y, old, target: np.hstack((y[:, :2], old[:, 2:]))},
    "returns only x and y": {"done": lambda y, old, target: y[:, :2].copy()},
})
edit("11.14", "moves x and y of the end only", "x[n] = target", "x[n, :2] = target[:2]")
edit("11.14", "changes its input", "x[0].copy(), float_copy(x)", "x[0].copy(), x")
edit("11.14", "makes the forward pass first", "x[n] = target",
     "for k in range(n): x[k + 1] = point_at(x[k], x[k + 1], lengths[k])\n    x[n] = target")
edit("11.14", "uses the length of the link before on the way back", "x[k] = point_at(x[k + 1], x[k], lengths[k])",
     "x[k] = point_at(x[k + 1], x[k], lengths[k - 1])")
edit("11.14", "squares the lengths", "lengths.size", "lengths.size; lengths = lengths**2")
edit("11.14", "takes the lengths from the positions", "x[n] = target",
     "lengths = np.sqrt(np.sum((x[1:] - x[:-1])**2, axis=1)); x[n] = target")
edit("11.14", "uses the length of the first link for all", "base, x, n = x[0].copy(), float_copy(x), lengths.size",
     "base, x, n = x[0].copy(), float_copy(x), lengths.size; lengths = 0.0 * lengths + lengths[0]")
edit("11.14", "takes all links as 1 m long", "base, x, n = x[0].copy(), float_copy(x), lengths.size",
     "base, x, n = x[0].copy(), float_copy(x), lengths.size; lengths = 0.0 * lengths + 1.0")
edit("11.14", "uses the lengths in the wrong order", "base, x, n = x[0].copy(), float_copy(x), lengths.size",
     "base, x, n = x[0].copy(), float_copy(x), lengths.size; lengths = lengths[::-1]")
edit("11.14", "moves the arm as a whole, in place of the forward pass", "x[0] = base",
     "return x + (base - x[0])")
edit("11.14", "puts the base to the target", "x[n] = target", "x[0] = target")
edit("11.14", "takes the number of coordinates for that of links", "lengths.size", "x.shape[1]")


# 11.15 ----------------------------------------------------------------------------------------------------------
@variants
def between_limits(of=same, push=lambda e, J, weight: J.T @ e,
                   at=lambda theta, low, high: (theta <= low, theta >= high),
                   out=lambda push: (push < 0.0, push > 0.0), weight=lambda arm: arm.damping**2,
                   some=lambda out: out, inner=same, before=lambda theta, arm: theta,
                   done=lambda theta, change, arm: clipped(theta + change, arm)):
    def limited_step(task, theta, target, arm):
        theta = before(theta, arm)
        e, J = of(task)(theta, target, arm)
        (below, above), (down, up) = at(theta, arm.low, arm.high), out(push(e, J, weight(arm)))
        J = np.where(some((below & down) | (above & up)), 0.0, J)
        change = inner(J).T @ np.linalg.lstsq(J @ J.T + weight(arm) * np.eye(len(e)), e, rcond=1e-15)[0]
        return done(theta, change, arm)
    return limited_step


def damped(e, J, weight):
    return J.T @ np.linalg.solve(J @ J.T + weight * np.eye(len(e)), e)


def scaled_down(theta, change, arm):
    """θ after as much of the change as no joint's limit forbids."""
    with np.errstate(all="ignore"):
        room = np.where(change > 0.0, (arm.high - theta) / change, (arm.low - theta) / change)
    return theta + change * np.clip(np.min(np.where(change == 0.0, 1.0, room)), 0.0, 1.0)


for story, part in SEEN.items():
    wrong("11.15", story)(between_limits(of=part))
for story, part in DONE.items():
    if "limits of the arm" not in story and "at their limits" not in story:
        wrong("11.15", f"{story}, and then keeps the limits")(
            between_limits(done=lambda theta, change, arm, part=part: clipped(part(theta, change, arm), arm)))
wrongs("11.15", between_limits, {
    "clips the angles and blocks no joint": {"some": lambda out: out & False},
    "blocks joints and does not clip the angles": {"done": lambda theta, change, arm: theta + change},
    "returns the change, not the new angles": {"done": lambda theta, change, arm: clipped(theta + change, arm) - theta},
    "omits the lower limits when it blocks": {"at": lambda theta, low, high: (theta < -np.inf, theta >= high)},
    "omits the upper limits when it blocks": {"at": lambda theta, low, high: (theta <= low, theta > np.inf)},
    "does not block joints exactly at a limit": {"at": lambda theta, low, high: (theta < low, theta > high)},
    "does not block a joint exactly at its upper limit": {"at": lambda theta, low, high: (theta <= low, theta > high)},
    "does not block a joint exactly at its lower limit": {"at": lambda theta, low, high: (theta < low, theta >= high)},
    "does not block joints beyond a limit": {"at": lambda theta, low, high: (theta == low, theta == high)},
    "blocks joints that are near a limit":
        {"at": lambda theta, low, high: (theta <= low + 0.1, theta >= high - 0.1)},
    "blocks joints that are almost at a limit":
        {"at": lambda theta, low, high: (theta <= low + 1e-3, theta >= high - 1e-3)},
    "exchanges the limits when it blocks": {"at": lambda theta, low, high: (theta <= high, theta >= low)},
    "takes −high for the lower limit when it blocks":
        {"at": lambda theta, low, high: (theta <= -high, theta >= high)},
    "takes the limits of the joint before":
        {"at": lambda theta, low, high: (theta <= np.roll(low, 1), theta >= np.roll(high, 1))},
    "never frees a joint at a limit": {"out": lambda push: (push > -np.inf, push > -np.inf)},
    "blocks joints that are pushed inwards": {"out": lambda push: (push > 0.0, push < 0.0)},
    "blocks joints at their upper limit that are pushed inwards": {"out": lambda push: (push < 0.0, push < 0.0)},
    "blocks joints at their lower limit that are pushed inwards": {"out": lambda push: (push > 0.0, push > 0.0)},
    "blocks joints at an upper limit, regardless of the direction": {"out": lambda push: (push < 0.0, push > -np.inf)},
    "blocks joints at a lower limit, regardless of the direction": {"out": lambda push: (push > -np.inf, push > 0.0)},
    "blocks joints that nothing pushes": {"out": lambda push: (push <= 0.0, push >= 0.0)},
    "asks the damped step, not Jᵀ e, what points out": {"push": damped},
    "asks the pseudo-inverse, not Jᵀ e, what points out": {"push": lambda e, J, weight: np.linalg.pinv(J, 1e-10) @ e},
    "asks only the first two rows what points out": {"push": lambda e, J, weight: J[:2].T @ e[:2]},
    "asks only the first three rows what points out": {"push": lambda e, J, weight: J[:3].T @ e[:3]},
    "blocks only the first of the joints": {"some": lambda out: out & (np.cumsum(out) < 2)},
    "clips the angles before the step": {"before": clipped},
    "uses λ in place of λ²": {"weight": lambda arm: arm.damping},
    "uses twice the damping": {"weight": lambda arm: 2.0 * arm.damping**2},
    "uses the gain in place of the damping": {"weight": lambda arm: arm.gain},
    "clips at the upper limits only": {"done": lambda theta, change, arm: np.minimum(theta + change, arm.high)},
    "leaves blocked joints beyond their limits":
        {"done": lambda theta, change, arm: np.where(change == 0.0, theta, clipped(theta + change, arm))},
    "clips at the lower limits only": {"done": lambda theta, change, arm: np.maximum(theta + change, arm.low)},
    "exchanges the limits when it clips":
        {"done": lambda theta, change, arm: np.minimum(np.maximum(theta + change, arm.high), arm.low)},
    "takes −high for the lower limit when it clips":
        {"done": lambda theta, change, arm: np.minimum(np.maximum(theta + change, -arm.high), arm.high)},
    "clips at the limits of the first joint":
        {"done": lambda theta, change, arm: np.clip(theta + change, arm.low[0], arm.high[0])},
    "shortens the whole step to the nearest limit": {"done": scaled_down},
    "does not move joints that would leave their limits": {"done": lambda theta, change, arm:
        np.where(clipped(theta + change, arm) == theta + change, theta + change, theta)},
    "reflects joints at their limits":
        {"done": lambda theta, change, arm: 2.0 * clipped(theta + change, arm) - theta - change},
})
edit("11.15", "sets columns to zero in the array that the task returned", "J.copy()", "J")
edit("11.15", "omits the damping", "arm.damping * arm.damping", "0.0")
edit("11.15", "changes its input", "wish, J = e @ J, J.copy()",
     "wish, J = e @ J, J.copy(); theta[:] = np.maximum(theta, arm.low)")
edit("11.15", "writes the new angles into its input",
     "return np.minimum(np.maximum(theta + sum_of_rows(J, solve_symmetric(A, e)), arm.low), arm.high)",
     "theta[:] = np.clip(theta + sum_of_rows(J, solve_symmetric(A, e)), arm.low, arm.high); return theta")
edit("11.15", "adds λ² in the first row only", "range(e.size)", "range(1)")
edit("11.15", "adds λ² in the first two rows only", "range(e.size)", "range(2)")
edit("11.15", "adds λ² in the first three rows only", "range(e.size)", "range(min(e.size, 3))")
edit("11.15", "sets only two rows of the columns to zero", "J[:, k] = 0.0", "J[:2, k] = 0.0")
edit("11.15", "sets only three rows of the columns to zero", "J[:, k] = 0.0", "J[:3, k] = 0.0")
edit("11.15", "sets rows to zero in place of columns", "J[:, k] = 0.0", "J[k % e.size] = 0.0")
edit("11.15", "uses J, not J', in J Jᵀ", "row_products(J)", "row_products(task(theta, target, arm)[1])")
edit("11.15", "uses J, not J', for Jᵀ after the inverse", "sum_of_rows(J, solve",
     "sum_of_rows(task(theta, target, arm)[1], solve")
edit("11.15", "makes a step of the pseudo-inverse", "sum_of_rows(J, solve_symmetric(A, e))", "pseudo_inverse(J) @ e")
edit("11.15", "makes a transpose step", "sum_of_rows(J, solve_symmetric(A, e))", "arm.gain * (e @ J)")
edit("11.15", "makes a damped step without limits", "wish, J = e @ J, J.copy()",
     "return damped_step(task, theta, target, arm)")
edit("11.15", "blocks every joint that would leave its limits, before it clips any", "wish, J = e @ J, J.copy()",
     "wish, J, free = e @ J, J.copy(), damped_step(task, theta, target, arm); "
     "J[:, (free > arm.high) | (free < arm.low)] = 0.0")
edit("11.15", "blocks joints that the step would move out, not those that Jᵀ e points out of",
     "wish, J = e @ J, J.copy()", "free, J = damped_step(task, theta, target, arm), J.copy(); "
     "wish, J[:, (free > arm.high) | (free < arm.low)] = 0.0 * theta, 0.0")


# 11.16 ----------------------------------------------------------------------------------------------------------
@variants
def freedom(of=same, pull=lambda arm: arm.pull, aim=lambda arm, theta: arm.rest - theta, plan=lambda z: z,
            inverse=lambda J, arm: np.linalg.pinv(J, 1e-10),
            combine=lambda P, J, e, z: P @ e + z - P @ (J @ z), done=lambda theta, change, arm: theta + change):
    def null_space_step(task, theta, target, arm):
        e, J = of(task)(theta, target, arm)
        return done(theta, combine(inverse(J, arm), J, e, plan(pull(arm) * aim(arm, theta))), arm)
    return null_space_step


def damped_inverse(J, arm):
    return J.T @ np.linalg.inv(J @ J.T + arm.damping**2 * np.eye(len(J)))


for story, part in SEEN.items():
    wrong("11.16", story)(freedom(of=part))
for story, part in DONE.items():
    wrong("11.16", story)(freedom(done=part))
wrongs("11.16", freedom, {
    "does not project the pull into the null space": {"combine": lambda P, J, e, z: P @ e + z},
    "omits the step towards the target": {"combine": lambda P, J, e, z: z - P @ (J @ z)},
    "omits the pull": {"combine": lambda P, J, e, z: P @ e},
    "goes to rest, regardless of the target": {"combine": lambda P, J, e, z: z},
    "adds what the pull moves to the error, where it is subtracted":
        {"combine": lambda P, J, e, z: P @ e + z + P @ (J @ z)},
    "projects onto what moves the end, not onto what does not": {"combine": lambda P, J, e, z: P @ e + P @ (J @ z)},
    "projects with JᵀJ, not with J⁺J": {"combine": lambda P, J, e, z: P @ e + z - J.T @ (J @ z)},
    "projects the step towards the target, too":
        {"combine": lambda P, J, e, z: P @ e + z - P @ (J @ (P @ e + z))},
    "makes twice the step towards the target": {"combine": lambda P, J, e, z: 2.0 * (P @ e) + z - P @ (J @ z)},
    "makes half of each step": {"combine": lambda P, J, e, z: 0.5 * (P @ e + z)},
    "subtracts the numbers of J⁺J from 1, not from a unit matrix":
        {"combine": lambda P, J, e, z: P @ e + (1.0 - P @ J) @ z},
    "uses the transpose in place of the pseudo-inverse": {"inverse": lambda J, arm: J.T},
    "uses the gain and the transpose towards the target": {"inverse": lambda J, arm: arm.gain * J.T},
    "uses a damped inverse": {"inverse": damped_inverse},
    "uses the pseudo-inverse of NumPy, with another cutoff": {"inverse": lambda J, arm: np.linalg.pinv(J)},
    "keeps only the first null vector": {"combine": lambda P, J, e, z:
        P @ e + np.linalg.svd(J)[2][-1] * (np.linalg.svd(J)[2][-1] @ z)},
    "keeps all vectors v but the first":
        {"combine": lambda P, J, e, z: P @ e + np.linalg.svd(J)[2][1:].T @ (np.linalg.svd(J)[2][1:] @ z)},
    "takes as many null vectors as there are joints more than rows, regardless of the rank":
        {"combine": lambda P, J, e, z: P @ e + np.linalg.svd(J)[2][len(e):].T @ (np.linalg.svd(J)[2][len(e):] @ z)},
    "uses the null space only where there are more joints than rows":
        {"combine": lambda P, J, e, z: P @ e + (z - P @ (J @ z)) * (len(z) > len(e))},
    "uses the null space only with more than three joints":
        {"combine": lambda P, J, e, z: P @ e + (z - P @ (J @ z)) * (len(z) > 3)},
    "pulls only when the target is near":
        {"combine": lambda P, J, e, z: P @ e + (z - P @ (J @ z)) * (np.linalg.norm(e) < 0.1)},
    "reverses the pull": {"aim": lambda arm, theta: theta - arm.rest},
    "pulls to zero in place of the rest angles": {"aim": lambda arm, theta: -theta},
    "uses the rest angles, not the way to them": {"aim": lambda arm, theta: arm.rest},
    "uses the rest angle of the first joint for all": {"aim": lambda arm, theta: arm.rest[0] - theta},
    "pulls to the middle between the limits":
        {"aim": lambda arm, theta: np.where(np.isfinite(arm.low + arm.high), 0.5 * (arm.low + arm.high), 0.0) - theta},
    "brings the way to rest into (−π, π]": {"aim": lambda arm, theta: worked.wrapped(arm.rest - theta)},
    "pulls all the way to rest in one step": {"pull": lambda arm: 1.0},
    "uses the gain in place of the pull": {"pull": lambda arm: arm.gain},
    "uses the damping in place of the pull": {"pull": lambda arm: arm.damping},
    "squares the pull": {"pull": lambda arm: arm.pull**2},
    "uses half of the pull": {"pull": lambda arm: 0.5 * arm.pull},
    "uses twice the pull": {"pull": lambda arm: 2.0 * arm.pull},
    "uses 1 − κ for κ": {"pull": lambda arm: 1.0 - arm.pull},
    "normalises the way to rest": {"plan": lambda z: z / (np.linalg.norm(z) + 1e-300)},
    "limits the pull to 0.1 rad": {"plan": lambda z: np.clip(z, -0.1, 0.1)},
})
edit("11.16", "changes its input", "return theta + z", "theta += z; return theta")
edit("11.16", "subtracts the pull, and what it moves, too", "theta + z + pseudo", "theta - z + pseudo")
edit("11.16", "uses the pseudo-inverse of NumPy with the cutoff 1e-12", "pseudo_inverse(J)", "np.linalg.pinv(J, 1e-12)")
edit("11.16", "uses the pseudo-inverse of NumPy with the cutoff 1e-6", "pseudo_inverse(J)", "np.linalg.pinv(J, 1e-6)")
edit("11.16", "damps the null space only", "pseudo_inverse(J) @ (e - J @ z)",
     "pseudo_inverse(J) @ e - J.T @ np.linalg.solve(J @ J.T + arm.damping**2 * np.eye(e.size), J @ z)")
edit("11.16", "damps the step towards the target only", "pseudo_inverse(J) @ (e - J @ z)",
     "J.T @ np.linalg.solve(J @ J.T + arm.damping**2 * np.eye(e.size), e) - pseudo_inverse(J) @ (J @ z)")
edit("11.16", "makes a transpose step towards the target", "pseudo_inverse(J) @ (e - J @ z)",
     "arm.gain * (e @ J) - pseudo_inverse(J) @ (J @ z)")
edit("11.16", "inverts J Jᵀ, whether it has an inverse or not", "pseudo_inverse(J) @ (e - J @ z)",
     "J.T @ np.linalg.inv(J @ J.T) @ (e - J @ z)")
edit("11.16", "multiplies the step towards the target by the pull", "pseudo_inverse(J) @ (e - J @ z)",
     "pseudo_inverse(J) @ (arm.pull * e - J @ z)")
edit("11.16", "computes J after the step towards the target", "z = arm.pull * (arm.rest - theta)",
     "z = arm.pull * (arm.rest - theta); theta = theta + pseudo_inverse(J) @ e\n"
     "    e, J = task(theta, target, arm); e = 0.0 * e")
edit("11.16", "computes e and J after the pull to rest", "z = arm.pull * (arm.rest - theta)",
     "z = arm.pull * (arm.rest - theta); theta = theta + z; e, J = task(theta, target, arm); z = 0.0 * z")


# right for most arms only ---------------------------------------------------------------------------------------
# They fail for tiny arms, for a single joint or many, for one limit, or for targets that are very near or very far.
edit("11.1", "takes small coordinates for zero", "return x", "x[np.abs(x) < 1e-6] = 0.0; return x")
edit("11.1", "rounds the positions to 12 digits", "return x", "return np.round(x, 12)")
edit("11.1", "counts from the x axis again after an angle of 0", "phi += theta[k]",
     "phi = phi + theta[k] if theta[k] or not k else 0.0")
edit("11.2", "takes small entries for zero", "return J", "J[np.abs(J) < 1e-6] = 0.0; return J")
edit("11.2", "returns zeros from the sixth joint on", "return J", "J[:, 5:] = 0.0; return J")
edit("11.2", "returns zeros where the joint is as high as the end", "return J",
     "return np.where(J[0] == 0.0, 0.0, J)")
TURN = "0.5 * np.arctan2(2.0 * b, a - c)"
edit("11.3", "takes two singular values, which a single joint does not have",
     "return longer, np.sqrt(squared) / longer,", "return longer, np.linalg.svd(J)[1][1],")
edit("11.3", "takes +45° for a = c, regardless of b", TURN, f"({TURN} if abs(a - c) > 1e-6 else 0.25 * np.pi)")
edit("11.3", "chooses between two arctangents by a > c", TURN,
     "0.5 * np.arctan(2.0 * b / (a - c)) + (0.0 if a > c else 0.5 * np.pi)")
edit("11.3", "takes a short axis below 1e-10 σ₁ for zero", "np.sqrt(squared) / longer,",
     "(np.sqrt(squared) / longer if squared > 1e-20 * longer**4 else 0.0),")
edit("11.3", "adds a small number to what it divides by", "np.sqrt(squared) / longer",
     "np.sqrt(squared) / (longer + 1e-12)")
edit("11.3", "takes an ellipse that is almost a circle for a circle", "np.sqrt(squared) / longer,",
     "(np.sqrt(squared) / longer if np.sqrt(squared) < 0.999 * longer**2 else longer),")
edit("11.4", "brings θ₁ back only where it is above π", "wrapped(np.arctan2(target[1], target[0]) - back)",
     "(lambda angle: angle - 2.0 * np.pi * (angle > np.pi))(np.arctan2(target[1], target[0]) - back)")
edit("11.4", "allows a tenth more than EDGE (l₁ + l₂) at the outer edge of the reach",
     "(1.0 + EDGE)", "(1.0 + 1.1 * EDGE)")
edit("11.5", "wraps θ₃ by at most four turns", "wrapped(phi - theta[0] - theta[1])",
     "(lambda a: a - 2.0 * np.pi * np.clip(np.round(a / (2.0 * np.pi)), -4, 4))(phi - theta[0] - theta[1])")
edit("11.5", "cuts φ off at three turns", "phi = target[2]", "phi = min(max(target[2], -6.0 * np.pi), 6.0 * np.pi)")
edit("11.6", "cuts the angles off at half a turn", "scaled(theta[k], axis)",
     "scaled(min(max(theta[k], -np.pi), np.pi), axis)")
edit("11.6", "takes the positive root for the cosine of half the angle", "exponential(scaled(theta[k], axis))",
     "np.append(np.abs(np.cos(0.5 * theta[k])), np.sin(0.5 * theta[k]) * axes[k])")
edit("11.6", "does not turn by small angles", "scaled(theta[k], axis)",
     "scaled(theta[k] if abs(theta[k]) > 1e-3 else 0.0, axis)")
edit("11.6", "rotates the first six axes only", "put(a, k, rotate(q, axis))",
     "put(a, k, rotate(q, axis) if k < 6 else axis)")
edit("11.6", "brings the angles of its input into (−π, π]", "put(a, k, rotate(q, axis))",
     "theta[k] = wrapped(theta[k]); put(a, k, rotate(q, axis))")
edit("11.7", "returns zeros for a single joint", "return J", "return J if n > 1 else 0.0 * J")
edit("11.7", "returns zeros from the eighth joint on", "return J", "J[:, 7:] = 0.0; return J")
edit("11.7", "takes small velocities for zero", "v[c], a[k, c]", "(v[c] if abs(v[c]) > 1e-6 else 0.0), a[k, c]")
edit("11.8", "wraps the angle in place of taking −d, which loses digits", "if d[0] < 0.0:",
     "size = np.sqrt(d[1:] @ d[1:])\n    if size > 0.0: return wrapped(2.0 * np.arctan2(size, d[0])) / size * d[1:]\n"
     "    if d[0] < 0.0:")
edit("11.8", "takes the shorter way only where w is clearly below 0", "if d[0] < 0.0:", "if d[0] < -0.1:")
edit("11.8", "takes the shorter way only where w is below −1e-9", "if d[0] < 0.0:", "if d[0] < -1e-9:")
edit("11.8", "does not let |𝐝| be below 1e-14", "d[0]) / size", "d[0]) / max(size, 1e-14)")
REACH = "min(1.0, np.sum(arm.lengths) / np.sqrt(e @ e + 1e-300))"
WITHIN = "(lambda a: np.where((theta > arm.low) & (theta < arm.high), np.clip(a, arm.low, arm.high), a))"
PUSHED, SOLVED = "theta + arm.gain * (e @ J)", "theta + sum_of_rows(J, solve_symmetric(A, e))"
PULLED = "theta + z + pseudo_inverse(J) @ (e - J @ z)"
for number, step in (("11.9", PUSHED), ("11.11", SOLVED), ("11.16", PULLED)):
    edit(number, "keeps limits between which the arm is", f"return {step}", f"return {WITHIN}({step})")
    edit(number, "shortens an error that is longer than the arm", f"return {step}",
         f"return (lambda e: {step})(e * {REACH})")
for number, step in (("11.9", PUSHED), ("11.11", SOLVED)):
    edit(number, "does not move when the target is very near", f"return {step}",
         f"return theta + ({step} - theta) * (e @ e > 1e-16)")
edit("11.9", "limits the gain to ½", "arm.gain *", "min(arm.gain, 0.5) *")
CUTOFF = "SINGULAR * sigma[0]"
edit("11.10", "compares with the root of the sum of all σ²", CUTOFF, "SINGULAR * np.sqrt(np.sum(sigma * sigma))")
edit("11.10", "compares with the mean of all σ", CUTOFF, "SINGULAR * np.mean(sigma)")
edit("11.10", "uses twice the cutoff", CUTOFF, f"2.0 * {CUTOFF}")
edit("11.10", "uses half of the cutoff", CUTOFF, f"0.5 * {CUTOFF}")
edit("11.10", "takes a J of small numbers for zero", CUTOFF, f"max({CUTOFF}, 1e-12)")
edit("11.10", "inverts JᵀJ where J has more rows than columns", "u, sigma, v = np.linalg.svd(J, False)",
     "u, sigma, v = np.linalg.svd(J, False)\n    if len(J) > J.shape[1]: return np.linalg.inv(J.T @ J) @ J.T")
edit("11.11", "uses a damping that is not below 1e-6 m", "arm.damping * arm.damping", "max(arm.damping, 1e-6) ** 2")
edit("11.11", "limits the damping to ten times |e|", "arm.damping * arm.damping",
     "min(arm.damping**2, 100.0 * (e @ e))")
edit("11.11", "omits small singular values", "solve_symmetric(A, e)", "np.linalg.pinv(A, 1e-3) @ e")
FACTORS = "return 1.0 - gain * sigma**2, damping**2 / (sigma**2 + damping**2)"
edit("11.12", "takes only the first three σ", FACTORS, f"sigma = sigma[:3]; {FACTORS}")
edit("11.12", "returns numbers for a single σ", FACTORS, f"sigma = sigma if len(sigma) > 1 else sigma[0]; {FACTORS}")
edit("11.12", "takes a small σ for zero", FACTORS,
     f"sigma = np.where(sigma < 1e-3 * np.max(sigma), 0.0, sigma); {FACTORS}")
edit("11.12", "does not let the factor be below −9", "1.0 - gain * sigma**2", "np.maximum(1.0 - gain * sigma**2, -9.0)")
BEGIN = "x, theta = joint_positions(theta, arm.lengths), float_copy(theta)"
ENDS = "end_x, end_y = x[theta.size, 0], x[theta.size, 1]"
NEW, FOUND = "new = np.minimum(np.maximum(wish, arm.low[k]), arm.high[k])", "r_x, r_y, s_x, s_y = "
edit("11.13", "does not move for a target out of reach", ENDS,
     f"{ENDS}\n    if np.hypot(target[0], target[1]) > np.sum(arm.lengths): return theta")
edit("11.13", "brings the target into the reach", ENDS, f"{ENDS}; target = target * min(1.0, np.sum(arm.lengths) / "
     "np.sqrt(target @ target + 1e-300))")
edit("11.13", "leaves joints where they are that begin beyond a limit", NEW,
     f"{NEW}; new = new if arm.low[k] <= theta[k] <= arm.high[k] else theta[k]")
edit("11.13", "brings the angles between the limits before the sweep", BEGIN,
     f"theta = np.clip(theta, arm.low, arm.high); {BEGIN}")
edit("11.13", "keeps limits only where both are finite", NEW,
     f"{NEW}; new = new if np.isfinite(arm.low[k] - arm.high[k]) else wish")
edit("11.13", "keeps only the limit towards which the joint turns", NEW,
     "new = np.minimum(wish, arm.high[k]) if wish > theta[k] else np.maximum(wish, arm.low[k])")
edit("11.13", "turns the other way round where the limits allow only that", NEW,
     "wish = wish - 2.0 * np.pi * np.sign(wish - theta[k]) * (not arm.low[k] <= wish <= arm.high[k] and arm.low[k] "
     f"<= wish - 2.0 * np.pi * np.sign(wish - theta[k]) <= arm.high[k]); {NEW}")
edit("11.13", "ends the sweep when the end is near the target", FOUND,
     f"if np.hypot(end_x - target[0], end_y - target[1]) < 1e-4: break\n        {FOUND}")
edit("11.13", "does not move joints that are near the target", "wish = theta[k] + ",
     "wish = theta[k] + (np.hypot(s_x, s_y) > 1e-3) * ")
SET = "x[n] = target"
edit("11.14", "does nothing where the end is at the target", SET,
     f"if np.sum((x[n] - target) ** 2) < 1e-12: return x\n    {SET}")
edit("11.14", "does nothing for a target at the base", SET, f"if np.array_equal(target, base): return x\n    {SET}")
edit("11.14", "does nothing for a target too near the base", SET,
     f"if np.sqrt(np.sum((target - base) ** 2)) < 2.0 * np.max(lengths) - np.sum(lengths): return x\n    {SET}")
edit("11.14", "does nothing with a single link", SET, f"if n == 1: return x\n    {SET}")
SUM, CLIP = "A = row_products(J)", "return np.minimum(np.maximum("
edit("11.15", "does not block a joint whose limits are equal", "wish[k] > 0.0)",
     "wish[k] > 0.0 and arm.low[k] < arm.high[k])")
edit("11.15", "keeps limits only where both are finite", CLIP,
     "low, high = np.where(np.isinf(arm.high), -np.inf, arm.low), np.where(np.isinf(arm.low), np.inf, arm.high)\n"
     f"    arm = arm._replace(low=low, high=high); {CLIP}")
edit("11.15", "blocks joints only where the push is clearly above 0", "wish[k] > 0.0)", "wish[k] > 1e-3)")
edit("11.15", "blocks joints at a lower limit that nothing pushes", "wish[k] < 0.0)", "wish[k] <= 0.0)")
edit("11.15", "returns its input where all joints are blocked", SUM,
     f"if not np.any(J): return theta.copy()\n    {SUM}")
edit("11.15", "uses a damping that is not below 1e-3 m", "arm.damping * arm.damping", "max(arm.damping, 1e-3) ** 2")
edit("11.16", "uses a pull of at most 1", "arm.pull *", "min(arm.pull, 1.0) *")
edit("11.16", "divides by the pull, which may be 0", "arm.pull *", "arm.pull * (arm.pull / np.float64(arm.pull)) *")
edit("11.16", "keeps only three null vectors", PULLED, "theta + pseudo_inverse(J) @ e + (lambda N: N.T @ (N @ z))("
     "np.linalg.svd(J)[2][np.linalg.matrix_rank(J, 1e-9):][:3])")


# everyday mistakes ----------------------------------------------------------------------------------------------
edit("11.1", "computes in single precision", "(theta.size + 1, 2))", "(theta.size + 1, 2), np.float32)")
edit("11.1", "puts all links at the base in x", "x[k, 0] +", "x[0, 0] +")
edit("11.1", "puts all links at the base in y", "x[k, 1] +", "x[0, 1] +")
edit("11.1", "uses the mean length for all links", "lengths[k] * np.cos", "np.mean(lengths) * np.cos")
edit("11.1", "cuts the sum of the angles off at half a turn", "phi += theta[k]",
     "phi = min(max(phi + theta[k], -np.pi), np.pi)")
edit("11.1", "returns the end relative to the last joint", "return x", "x[-1] -= x[-2].copy(); return x")
edit("11.2", "computes in single precision", "np.empty((2, n))", "np.empty((2, n), np.float32)")
edit("11.2", "returns half of the velocity", "return J", "return 0.5 * J")
edit("11.2", "takes the size of r_x", "x[n, 0] - x[k, 0]", "abs(x[n, 0] - x[k, 0])")
edit("11.3", "returns the angle of the short axis, to the other side", TURN, "0.5 * np.arctan2(-2.0 * b, c - a)")
edit("11.3", "takes the size of a − c in the angle", TURN, "0.5 * np.arctan2(2.0 * b, abs(a - c))")
edit("11.3", "returns the root of a + c for the longer axis", "longer = np.sqrt(0.5 * (a + c) + np.sqrt(",
     "longer = np.sqrt((a + c) + 0.0 * np.sqrt(")
edit("11.3", "takes the arctangent of the quotient, which knows no quadrant", TURN,
     "0.5 * (np.arctan(2.0 * b / (a - c)) if a != c else 0.5 * np.pi)")
edit("11.3", "normalises the columns of J", "a, b, c, squared",
     "J = J / np.maximum(np.linalg.norm(J, axis=0), 1e-300); a, b, c, squared")
edit("11.4", "computes r² − a², which loses digits near the inner edge", "(r - least) * (r + least)",
     "r * r - least * least")
edit("11.4", "takes the root of the size of a negative number at the inner edge", "np.maximum(inner, 0.0)",
     "np.abs(inner)")
edit("11.4", "adds the coordinates of the target for its distance", "np.hypot(target[0], target[1])",
     "abs(target[0]) + abs(target[1])")
edit("11.4", "brings θ₁ back only where it is below −π", "wrapped(np.arctan2(target[1], target[0]) - back)",
     "(lambda angle: angle + 2.0 * np.pi * (angle < -np.pi))(np.arctan2(target[1], target[0]) - back)")
edit("11.5", "returns the arcsine of the sine for θ₃", "wrapped(phi - theta[0] - theta[1])",
     "np.arcsin(np.sin(phi - theta[0] - theta[1]))")
edit("11.5", "wraps φ and the sum of the other angles, not their difference", "wrapped(phi - theta[0] - theta[1])",
     "wrapped(phi) - wrapped(theta[0] + theta[1])")
edit("11.5", "measures the hand from the direction of the wrist", "wrapped(phi - theta[0] - theta[1])",
     "wrapped(phi - np.arctan2(wrist[1], wrist[0]))")
edit("11.6", "takes every offset along x", "rotate(q, row(offsets, k))",
     "rotate(q, (np.sqrt(np.sum(offsets[k] ** 2)), 0.0, 0.0))")
edit("11.6", "returns the axes in the frame of the last link", "return x, a, q",
     "return x, np.stack([rotate(np.array((q[0], -q[1], -q[2], -q[3])), one) for one in a]), q")
edit("11.6", "takes the last axis in its own frame", "return x, a, q", "a[n - 1] = axes[n - 1]; return x, a, q")
edit("11.5", "forgets a hand that is longer than 10 m", "theta = solve_2r(wrist,",
     "theta = solve_2r(wrist if lengths[2] < 10.0 else target[:2].copy(),")
edit("11.5", "sets a θ₃ below 1e-6 to 0", "wrapped(phi - theta[0] - theta[1])",
     "(lambda angle: angle if abs(angle) > 1e-6 else 0.0)(wrapped(phi - theta[0] - theta[1]))")
edit("11.7", "shortens an offset that is longer than 6 m", "minus(row(x, n), row(x, k))",
     "scaled(min(1.0, 6.0 / max(np.sqrt(np.sum((x[n] - x[k]) ** 2)), 1e-300)), minus(row(x, n), row(x, k)))")
edit("11.7", "computes in single precision", "np.empty((6, n))", "np.empty((6, n), np.float32)")
edit("11.7", "takes the first joint to be at the origin", "minus(row(x, n), row(x, k))",
     "(minus(row(x, n), row(x, k)) if k else row(x, n))")
edit("11.7", "returns zeros for the velocity due to the last joint", "return J", "J[:3, n - 1] = 0.0; return J")
edit("11.7", "exchanges y and z of the velocity of the end", "v[c], a[k, c]", "v[(0, 2, 1)[c]], a[k, c]")
edit("11.8", "conjugates x only", "-q[1], -q[2], -q[3]", "-q[1], q[2], q[3]")
edit("11.8", "decides by the sign of x, not of w, which way is the shorter one", "d[0] < 0.0", "d[1] < 0.0")
edit("11.8", "decides by w of the target which way is the shorter one", "d[0] < 0.0", "q_target[0] < 0.0")
edit("11.8", "takes the first three numbers of d for its vector", "factor * d[1:]", "factor * d[:3]")
edit("11.8", "limits the angle to 3 rad", "return factor * d[1:]",
     "return min(factor, 3.0 / max(size, 1e-300)) * d[1:]")
edit("11.9", "brings the angles into [0, 2π)", "return theta + arm.gain * (e @ J)",
     "return (theta + arm.gain * (e @ J)) % (2.0 * np.pi)")
edit("11.9", "divides the change by the number of rows", "arm.gain *", "arm.gain / e.size *")
edit("11.9", "computes J anew after the step", "return theta + arm.gain",
     "_, J = task(theta + arm.gain * (e @ J), target, arm); return theta + arm.gain")
edit("11.9", "computes e anew after half of the step", "return theta + arm.gain",
     "e, _ = task(theta + 0.5 * arm.gain * (e @ J), target, arm); return theta + arm.gain")
for number, step in (("11.9", PUSHED), ("11.11", SOLVED), ("11.16", PULLED)):
    edit(number, "limits each change to π", f"return {step}", f"return theta + np.clip({step} - theta, -np.pi, np.pi)")
    edit(number, "limits each change to 1000 rad", f"return {step}",
         f"return theta + np.clip({step} - theta, -1e3, 1e3)")
    edit(number, "omits changes below 1e-9 rad", f"return {step}",
         f"return theta + np.where(np.abs({step} - theta) < 1e-9, 0.0, {step} - theta)")
edit("11.10", "damps the singular values a little", "/ sigma[i]", "* sigma[i] / (sigma[i] ** 2 + 1e-12)")
edit("11.10", "does not let singular values be below 1e-6", "/ sigma[i]", "/ max(sigma[i], 1e-6)")
edit("11.11", "uses half of λ", "arm.damping * arm.damping", "0.25 * arm.damping * arm.damping")
edit("11.11", "limits the damping to ½ m", "arm.damping * arm.damping", "min(arm.damping, 0.5) ** 2")
edit("11.11", "uses a damping that is not below 0.01 m", "arm.damping * arm.damping", "max(arm.damping, 0.01) ** 2")
edit("11.12", "divides by the sum of all σ²", "(sigma**2 + damping**2)", "(np.sum(sigma**2) + damping**2)")
edit("11.12", "returns 0 for the damped step where σ is 0", "damping**2 / (sigma**2 + damping**2)",
     "np.where(sigma == 0.0, 0.0, damping**2 / (sigma**2 + damping**2))")
edit("11.13", "takes the direction of the target for the angle of the joint", "wish = theta[k] + np.arctan2(",
     "wish = np.arctan2(s_y, s_x) + 0.0 * np.arctan2(")
edit("11.13", "limits each turn to a right angle", NEW,
     f"wish = theta[k] + np.clip(wish - theta[k], -0.5 * np.pi, 0.5 * np.pi); {NEW}")
edit("11.14", "sweeps forth first, and then back", SET,
     f"for k in range(n): x[k + 1] = point_at(x[k], x[k + 1], lengths[k])\n    {SET}\n"
     "    for k in range(n - 1, -1, -1): x[k] = point_at(x[k + 1], x[k], lengths[k])\n    return x")
edit("11.14", "brings the target into the reach", SET, "x[n] = base + (target - base) * min(1.0, np.sum(lengths) / "
     "max(np.sqrt(np.sum((target - base) ** 2)), 1e-300))")
CHANGE = "theta + sum_of_rows(J, solve_symmetric(A, e))"
edit("11.15", "limits the change, not the angle", f"np.minimum(np.maximum({CHANGE}, arm.low), arm.high)",
     f"theta + np.minimum(np.maximum({CHANGE} - theta, arm.low), arm.high)")
edit("11.15", "multiplies the step by the gain", "theta + sum_of_rows", "theta + arm.gain * sum_of_rows")
edit("11.15", "never blocks the first joint", "for k in range(theta.size):", "for k in range(1, theta.size):")
edit("11.15", "never blocks the last joint", "for k in range(theta.size):", "for k in range(theta.size - 1):")
edit("11.15", "takes the upper limit of the first joint for all when it blocks", "arm.high[k] and", "arm.high[0] and")
edit("11.16", "limits the way to rest to 10 rad", "(arm.rest - theta)", "np.clip(arm.rest - theta, -10.0, 10.0)")
edit("11.16", "limits the pull to 1 rad", PULLED, f"(lambda z: {PULLED})(np.clip(z, -1.0, 1.0))")
edit("11.16", "normalises a pull that is longer than 1", PULLED, f"(lambda z: {PULLED})(z / max(1.0, np.sqrt(z @ z)))")
edit("11.16", "uses a pull of at most ½", "arm.pull *", "min(arm.pull, 0.5) *")


# special cases --------------------------------------------------------------------------------------------------
# Joints at one place or at the end, angles and arms of 0, a single joint or more than six, no damping, equal limits.
edit("11.1", "does not turn by exactly half a turn", "phi += theta[k]", "phi += theta[k] * (abs(theta[k]) != np.pi)")
edit("11.1", "points a link up that points along y, or against it", "np.sin(phi)",
     "(np.sin(phi) if abs(np.cos(phi)) > 1e-12 else 1.0)")
edit("11.2", "divides by the distance of the end from a joint, which may be 0", "x[k, 1] - x[n, 1],",
     "x[k, 1] - x[n, 1] + 0.0 / np.hypot(x[n, 0] - x[k, 0], x[n, 1] - x[k, 1]),")
edit("11.2", "returns zeros for the second of two joints at one place", "return J",
     "J[:, 1:][:, np.all(x[1:n] == x[:n - 1], axis=1)] = 0.0; return J")
edit("11.2", "takes the base to be at (0, 0) where there is a single joint", "return J",
     "return J if n > 1 else np.array(((-x[1, 1],), (x[1, 0],)))")
edit("11.2", "returns zeros where the end is at the base", "return J", "return J * float(np.any(x[n] != x[0]))")
edit("11.3", "returns atan2(σ₁² − a, b), which loses the digits of a small angle", TURN,
     "np.arctan2(longer * longer - a, b)")
edit("11.3", "stops at a joint that the end is at", "for k in range(J.shape[1])",
     "for k in range(np.argmin(np.append(np.any(J, axis=0), False)))")
edit("11.3", "counts joints at one place only once", "a, b, c, squared",
     "J = J * np.append(True, np.any(J[:, 1:] != J[:, :-1], axis=0)); a, b, c, squared")
edit("11.3", "returns the lengths of two columns at right angles in their order", "return longer",
     "if J.shape[1] == 2 and J[0, 0] * J[0, 1] == -J[1, 0] * J[1, 1]: "
     f"return np.hypot(J[0, 0], J[1, 0]), np.hypot(J[0, 1], J[1, 1]), {TURN}\n    return longer")
edit("11.3", "returns no number for the angle of a circle", TURN, f"({TURN} if b != 0.0 or a != c else np.nan)")
edit("11.4", "refuses a target nearer to the base than 1e-9 m", "r < least - EDGE * most",
     "0.0 < r < 1e-9 or r < least - EDGE * most")
edit("11.4", "takes half the size of θ₂ as the correction where the two links are equal", "back = ",
     "back = 0.5 * abs(theta_2) if lengths[0] == lengths[1] else ")
for refused, what in (("a target nearer to the base than l₃", "np.hypot(target[0], target[1]) < lengths[2]"),
                      ("a target at the base", "np.hypot(target[0], target[1]) == 0.0"),
                      ("a last joint at the base", "np.hypot(wrist[0], wrist[1]) < 1e-9")):
    edit("11.5", f"refuses {refused}", "theta = solve_2r(wrist,",
         f"if {what}: raise BadInput('distance of the target [m]', 0.0, 'go away')\n    theta = solve_2r(wrist,")
edit("11.5", "takes the size of x of a last joint that is as high as the base", "theta = solve_2r(wrist,",
     "wrist[0] *= 1.0 if wrist[1] != 0.0 else np.sign(wrist[0])\n    theta = solve_2r(wrist,")
edit("11.5", "takes the direction of the target where φ is exactly 0", "phi = target[2]",
     "phi = target[2] if target[2] != 0.0 else np.arctan2(target[1], target[0])")
edit("11.6", "leaves out the offset of a joint whose angle is 0", "rotate(q, row(offsets, k))",
     "scaled(float(theta[k] != 0.0), rotate(q, row(offsets, k)))")
edit("11.6", "does not rotate the axis of a joint whose angle is 0", "put(a, k, rotate(q, axis))",
     "put(a, k, rotate(q, axis) if theta[k] != 0.0 else axis)")
edit("11.6", "does not rotate an offset along the joint's own axis", "rotate(q, row(offsets, k))",
     "(rotate(q, row(offsets, k)) if any(across(axis, row(offsets, k))) else row(offsets, k))")
edit("11.6", "divides by the length of an offset, which may be 0", "plus(row(x, k), 1.0,",
     "plus(row(x, k), 1.0 + 0.0 / np.sqrt(np.sum(offsets[k] ** 2)),")
edit("11.6", "uses the same axis for two joints at one place", "return x, a, q",
     "k = np.flatnonzero(np.all(x[1:n] == x[:n - 1], axis=1)); a[k + 1] = a[k]; return x, a, q")
for which, rotated in (("the first one", "np.any(axes[k] != axes[0])"),
                       ("the one before", "k == 0 or np.any(axes[k] != axes[k - 1])")):
    edit("11.6", f"does not rotate an axis that is the same as {which}", "put(a, k, rotate(q, axis))",
         f"put(a, k, rotate(q, axis) if {rotated} else axis)")
edit("11.6", "cuts the angles off at two turns", "scaled(theta[k], axis)",
     "scaled(min(max(theta[k], -4.0 * np.pi), 4.0 * np.pi), axis)")
edit("11.6", "does not turn by exactly half a turn", "scaled(theta[k], axis)",
     "scaled(theta[k] if abs(theta[k]) != np.pi else 0.0, axis)")
edit("11.6", "does not turn by angles below 1e-6", "scaled(theta[k], axis)",
     "scaled(theta[k] if abs(theta[k]) > 1e-6 else 0.0, axis)")
edit("11.7", "returns no angular velocity where the end does not move", "v[c], a[k, c]",
     "v[c], (a[k, c] if any(v) else 0.0)")
edit("11.7", "takes an axis against z for one along z, in the velocity of the end", "minus(row(x, n), row(x, k))",
     "scaled(1.0 if any(a[k, :2]) else a[k, 2], minus(row(x, n), row(x, k)))")
edit("11.7", "returns no velocity where the end is at the base", "return J",
     "J[:3] *= float(np.any(x[n] != x[0])); return J")
edit("11.7", "exchanges rows and columns of the axes of three joints", "v[c], a[k, c]",
     "v[c], (a[c, k] if n == 3 else a[k, c])")
edit("11.7", "uses the same velocity for two joints at one place", "return J",
     "k = np.flatnonzero(np.all(x[1:n] == x[:n - 1], axis=1)); J[:3, k + 1] = J[:3, k]; return J")
edit("11.7", "divides by the distance of the end from a joint, which may be 0", "v[c], a[k, c]",
     "v[c] + 0.0 / np.sqrt(np.sum((x[n] - x[k]) ** 2)), a[k, c]")
edit("11.8", "divides zero by zero where q_target is −q", "2.0 if size == 0.0", "2.0 if np.all(q == q_target)")
edit("11.8", "reverses the vector where both axes are the same and w of q is below 0", "return factor * d[1:]",
     "return factor * d[1:] * (1.0 if q[0] >= 0.0 or any(across(q[1:], q_target[1:])) else -1.0)")
edit("11.8", "rotates in the frame of the link where q is a rotation about x, y or z", "if d[0] < 0.0:",
     "if np.sum(q[1:] == 0.0) == 2:\n"
     "        d = quaternion_product(np.array((q[0], -q[1], -q[2], -q[3])), q_target)\n    if d[0] < 0.0:")
edit("11.8", "returns zeros where q and q_target are rotations by half a turn", "return factor * d[1:]",
     "return factor * d[1:] * float(q[0] != 0.0 or q_target[0] != 0.0)")
edit("11.9", "multiplies with J, not its transpose, where it is square and has more than two rows", "(e @ J)",
     "(J @ e if 2 < e.size == theta.size else e @ J)")
edit("11.9", "uses only the first row of the task for a single joint", "(e @ J)",
     "(e @ J if theta.size > 1 else e[0] * J[0])")
edit("11.9", "does not move joints at a limit further out", f"return {PUSHED}",
     f"return (lambda new: np.where(((theta == arm.high) & (new > theta)) | ((theta == arm.low) & (new < theta)), "
     f"theta, new))({PUSHED})")
edit("11.9", "takes a gain of 0 for 1", "arm.gain *", "(arm.gain or 1.0) *")
SVD = "u, sigma, v = np.linalg.svd(J, False)"
edit("11.10", "divides a single row by its square, which may be 0", SVD,
     f"if len(J) == 1: return J.T / (J @ J.T)\n    {SVD}")
edit("11.10", "divides a single column by its square, which may be 0", SVD,
     f"if J.shape[1] == 1: return J.T / (J.T @ J)\n    {SVD}")
edit("11.10", "divides by the diagonal of a symmetric J", SVD, "if J.shape[0] == J.shape[1] and np.all(J == J.T) "
     f"and np.all(np.diag(J) != 0.0): return np.diag(1.0 / np.diag(J))\n    {SVD}")
edit("11.10", "counts equal rows only once", SVD, f"J = J.copy(); J[1:][np.all(J[1:] == J[:-1], axis=1)] = 0.0; {SVD}")
edit("11.10", "counts equal columns only once", SVD,
     f"J = J.copy(); J[:, 1:][:, np.all(J[:, 1:] == J[:, :-1], axis=0)] = 0.0; {SVD}")
edit("11.10", "adds only one of several σ_i that are equal", f"not sigma[i] <= {CUTOFF}",
     f"not (sigma[i] <= {CUTOFF} or i > 0 and sigma[i] == sigma[i - 1])")
edit("11.11", "uses only the first row of the task for a single joint", SUM,
     f"if theta.size == 1: return theta + J[0] * e[0] / (J[0, 0] ** 2 + arm.damping**2)\n    {SUM}")
edit("11.11", "moves joints to rest that do not move the end", f"return {SOLVED}",
     f"return np.where(np.any(J, axis=0), {SOLVED}, arm.rest)")
edit("11.11", "divides by the size of the step, which may be 0", f"return {SOLVED}",
     f"return (lambda new: new + 0.0 / np.sqrt((new - theta) @ (new - theta)))({SOLVED})")
edit("11.12", "uses a damping that is not below 1e-3 m", "damping**2 / (sigma**2 + damping**2)",
     "max(damping, 1e-3)**2 / (sigma**2 + max(damping, 1e-3)**2)")
edit("11.12", "does not let σ² + λ² be below 1e-12", "(sigma**2 + damping**2)",
     "np.maximum(sigma**2 + damping**2, 1e-12)")
edit("11.12", "takes only the first of several equal σ, and 0 for the others", FACTORS,
     f"sigma = sigma * np.append(True, sigma[1:] != sigma[:-1]); {FACTORS}")
edit("11.12", "returns 1 for the damped step, too, where the gain is 0", FACTORS,
     f"if gain == 0.0: return 0.0 * sigma + 1.0, 0.0 * sigma + 1.0\n    {FACTORS}")
edit("11.12", "limits the gain to 10", "gain * sigma**2", "min(gain, 10.0) * sigma**2")
edit("11.13", "takes the end from the task, which is not used", ENDS,
     "e, _ = task(theta, target, arm); end_x, end_y = target[0] - e[0], target[1] - e[1]")
edit("11.13", "does nothing where the end is at the target, regardless of the limits", ENDS,
     f"{ENDS}\n    if end_x == target[0] and end_y == target[1]: return theta")
edit("11.13", "does not move a joint from beyond one limit further than to that limit", NEW,
     f"{NEW} if arm.low[k] <= theta[k] <= arm.high[k] or arm.low[k] <= wish <= arm.high[k] "
     "else np.minimum(np.maximum(theta[k], arm.low[k]), arm.high[k])")
edit("11.13", "does not keep the limits of a joint that is at the target", NEW, f"{NEW} if s_x or s_y else wish")
edit("11.13", "does not keep the limits of a joint that need not turn", NEW, f"{NEW} if wish != theta[k] else wish")
edit("11.13", "does not keep limits that are equal", NEW, f"{NEW} if arm.low[k] < arm.high[k] else wish")
edit("11.13", "does not turn a joint that is exactly at a limit, not even back", NEW,
     f"{NEW} if theta[k] != arm.low[k] and theta[k] != arm.high[k] else theta[k]")
edit("11.13", "does not turn a joint that is exactly between the end and the target", "np.arctan2(r_x * s_y",
     "(r_x * s_y != r_y * s_x) * np.arctan2(r_x * s_y")
edit("11.14", "moves only the first six links on the way back", "range(n - 1, -1, -1)", "range(min(n, 6) - 1, -1, -1)")
edit("11.14", "moves only the first six links on the way forth", "range(n):", "range(min(n, 6)):")
edit("11.14", "leaves the end of a single link where it coincides with the base",
     "point_at(x[k], x[k + 1], lengths[k])",
     "point_at(x[k], x[k + 1], lengths[k]) if n > 1 or np.any(x[1] != x[0]) else x[1]")
edit("11.14", "moves the second of two points that coincide along axis 2, in space", "point_at(x[k], x[k + 1],",
     "point_at(x[k], x[k + 1] + np.eye(3)[2] if x.shape[1] == 3 and np.all(x[k] == x[k + 1]) else x[k + 1],")
edit("11.14", "takes joints nearer than 1e-6 m for one on the way back", "point_at(x[k + 1], x[k],",
     "point_at(x[k + 1], x[k] if np.sum((x[k] - x[k + 1]) ** 2) > 1e-12 else x[k + 1],")
edit("11.14", "takes joints nearer than 1e-6 m for one on the way forth", "point_at(x[k], x[k + 1],",
     "point_at(x[k], x[k + 1] if np.sum((x[k] - x[k + 1]) ** 2) > 1e-12 else x[k],")
edit("11.15", "does nothing where e is 0, regardless of the limits", "wish, J =",
     "if not np.any(e): return theta.copy()\n    wish, J =")
edit("11.15", "adds the step to angles that it has set to the limits", "theta + sum_of_rows",
     "np.clip(theta, arm.low, arm.high) + sum_of_rows")
edit("11.15", "blocks joints whose two limits are equal, regardless of the direction", "if (theta[k] >= arm.high[k]",
     "if arm.low[k] == arm.high[k] or (theta[k] >= arm.high[k]")
edit("11.15", "blocks joints beyond a limit, regardless of the direction", "if (theta[k] >= arm.high[k]",
     "if theta[k] > arm.high[k] or theta[k] < arm.low[k] or (theta[k] >= arm.high[k]")
wrongs("11.15", between_limits, {"sets joints beyond a limit to the limit, without a step": {
    "done": lambda theta, change, arm: np.where(clipped(theta, arm) == theta, clipped(theta + change, arm),
                                                clipped(theta, arm))}})
edit("11.16", "does not pull where the task has more rows than there are joints", "arm.pull *",
     "arm.pull * (theta.size >= e.size) *")
edit("11.16", "does not move a joint that is at rest while others are not", f"return {PULLED}",
     f"return np.where((z == 0.0) & np.any(z), theta, {PULLED})")
edit("11.16", "does not pull where J is 0", "arm.pull *", "arm.pull * np.any(J) *")
edit("11.16", "does not pull a single joint", "arm.pull *", "arm.pull * (theta.size > 1) *")


# 11.1 to 11.15: right for arms of about a metre ---------------------------------------------------------------------
edit("11.1", "takes an angle below 1e-6 rad for 0", "phi += theta[k]", "phi += theta[k] * (abs(theta[k]) > 1e-6)")
edit("11.1", "takes an angle below 1 mrad for 0", "phi += theta[k]", "phi += theta[k] * (abs(theta[k]) > 1e-3)")
edit("11.1", "takes an angle beyond 100 rad for 100 rad", "phi += theta[k]", "phi += np.clip(theta[k], -100.0, 100.0)")
edit("11.2", "takes distances above 100 m for 100 m", "n = x.shape[0] - 1",
     "n, x = x.shape[0] - 1, np.clip(x - x[-1], -100.0, 100.0)")
edit("11.3", "returns a longer half axis of at most 100 m", "return longer, np", "return min(longer, 100.0), np")
edit("11.6", "takes offsets above 100 m for 100 m", "n = theta.size",
     "n, offsets = theta.size, np.clip(offsets, -100.0, 100.0)")
edit("11.6", "takes offsets below 1 mm for 0", "n = theta.size",
     "n, offsets = theta.size, np.where(np.abs(offsets) < 1e-3, 0.0, offsets)")
edit("11.9", "takes a gain below 0.01 for 0.01", "arm.gain", "max(arm.gain, 1e-2 * (arm.gain > 0.0))")
edit("11.12", "returns factors of at least −100", FACTORS,
     "return np.maximum(1.0 - gain * sigma**2, -100.0), damping**2 / (sigma**2 + damping**2)")
edit("11.12", "takes a factor below 0.001 for 0", FACTORS, "left = damping**2 / (sigma**2 + damping**2)\n"
     "    return 1.0 - gain * sigma**2, left * (left > 1e-3)")
edit("11.13", "takes a target beyond 100 m for one at 100 m", BEGIN,
     f"target = np.clip(target, -100.0, 100.0); {BEGIN}")
edit("11.14", "takes a target beyond 100 m for one at 100 m", SET, f"{SET}; x[n] = np.clip(x[n], -100.0, 100.0)")
edit("11.15", "takes a damping above 100 m for 100 m", "arm.damping * arm.damping", "min(arm.damping, 100.0) ** 2")
edit("11.16", "takes a pull below 0.01 for 0", "arm.pull * (", "arm.pull * (arm.pull > 1e-2) * (")


# 11.17 --------------------------------------------------------------------------------------------------------------
@right("11.17", "by cases")
def remaining_distance(lengths, target, damping):
    away, least = np.linalg.norm(target), max(0.0, 2.0 * max(lengths) - sum(lengths))
    return away - sum(lengths) if away > sum(lengths) else max(0.0, least - away)


edit("11.17", "says that the damping keeps a part of the error",
     "np.maximum(0.0, np.maximum(away - reach, hole - away))",
     "np.maximum(0.0, np.maximum(away - reach, hole - away)) + away * damping**2 / (damping**2 + reach**2)")
edit("11.17", "forgets that an arm with a long link has a hole in its reach",
     "np.maximum(away - reach, hole - away)", "away - reach")
edit("11.17", "forgets the rim of the reach", "np.maximum(away - reach, hole - away)", "hole - away")
edit("11.17", "returns a negative distance within reach",
     "np.maximum(0.0, np.maximum(away - reach, hole - away))", "np.maximum(away - reach, hole - away)")
edit("11.17", "takes the size of l₁ − (l₂ + … + lₙ) for the hole, as for two links",
     "2.0 * np.max(lengths) - reach", "abs(2.0 * lengths[0] - reach)")
edit("11.17", "takes the first link for the longest", "np.max(lengths) - reach", "lengths[0] - reach")
edit("11.17", "has a hole also where the other links together are longer than the longest one",
     "2.0 * np.max(lengths) - reach", "abs(2.0 * np.max(lengths) - reach)")
edit("11.17", "takes the difference of the longest and the shortest link for the hole",
     "2.0 * np.max(lengths) - reach", "np.max(lengths) - np.min(lengths)")
edit("11.17", "returns the distance from the base", "np.maximum(0.0, np.maximum(away - reach, hole - away))", "away")
LEFT = "return np.maximum(0.0, np.maximum(away - reach, hole - away))"
edit("11.17", "takes the first or the last link for the longest", "np.max(lengths)", "max(lengths[0], lengths[-1])")
edit("11.17", "takes the longest of the first three links for the longest", "np.max(lengths)", "np.max(lengths[:3])")
edit("11.17", "has no hole for a single link", "2.0 * np.max(lengths) - reach",
     "2.0 * np.max(lengths) - reach if lengths.size > 1 else 0.0")
edit("11.17", "has no hole with more than three links", "2.0 * np.max(lengths) - reach",
     "2.0 * np.max(lengths) - reach if lengths.size <= 3 else 0.0")
edit("11.17", "has a small hole also where two links are equal", "2.0 * np.max(lengths) - reach",
     "max(2.0 * np.max(lengths) - reach, 0.01 * np.min(lengths))")
edit("11.17", "adds up only the first six links", "np.sum(lengths)", "np.sum(lengths[:6])")
edit("11.17", "returns 0 for a target at the base", LEFT, f"{LEFT} if away > 0.0 else 0.0")
edit("11.17", "takes a distance below 0.01 m for 0", LEFT, f"hole -= 1e-2; reach += 1e-2; left = {LEFT[7:]}\n"
     "    return left + 1e-2 if left > 0.0 else 0.0")
edit("11.17", "takes a distance below 0.1 m in the hole for 0", LEFT, f"{LEFT} if not 0.0 < hole - away < 0.1 else 0.0")
edit("11.17", "returns at most 5 m", LEFT, f"return min(5.0, {LEFT[7:]})")
edit("11.17", "takes y of a target on the y axis for its distance", "np.sqrt(target @ target)",
     "(np.sqrt(target @ target) if target[0] != 0.0 else target[1])")
edit("11.17", "computes in single precision", "np.sum(lengths)", "np.float64(np.float32(np.sum(lengths)))")
edit("11.17", "takes the longest link as the reach", "reach, away = np.sum(lengths)", "reach, away = np.max(lengths)")
edit("11.17", "omits links below a twentieth of the reach in the hole", "2.0 * np.max(lengths) - reach",
     "2.0 * np.max(lengths) - np.sum(lengths[lengths > 0.05 * reach])")
edit("11.17", "subtracts only the two longest of the other links", "2.0 * np.max(lengths) - reach",
     "2.0 * np.max(lengths) - np.sum(np.sort(lengths)[-3:])")
edit("11.17", "omits links below 1 mm", "np.sum(lengths)", "np.sum(lengths[lengths > 1e-3])")


# 11.18 --------------------------------------------------------------------------------------------------------------
@right("11.18", "as a small letter")
def newton_is():
    return "a"


edit("11.18", "chooses the slowest straight line: a fixed factor per iteration is that of a gradient",
     '"A"', '"B"')
edit("11.18", "chooses a straight line: a fixed factor per iteration is no Newton step",
     '"A"', '"C"')
edit("11.18", "chooses the steepest straight line: each iteration adds as many digits as the last",
     '"A"', '"D"')


# 11.19 --------------------------------------------------------------------------------------------------------------
@right("11.19", "a spiral by two links")
def my_writing():
    t = np.linspace(0.0, 4.0 * np.pi, 121)
    r = 0.15 + 0.02 * t
    return np.array([1.0, 1.0]), np.stack((1.0 + r * np.cos(t), 0.5 + r * np.sin(t)), axis=1), 12.0


@right("11.19", "a square by four links")
def writing_a_square():
    corners = np.array([(1.0, 0.5), (1.8, 0.5), (1.8, 1.3), (1.0, 1.3), (1.0, 0.5)])
    return np.array([0.8, 0.7, 0.6, 0.5]), corners, 12.0


edit("11.19", "writes beyond the reach", "1.1 + r", "2.0 + r")
edit("11.19", "writes too fast for the joints", "points, 10.0", "points, 2.0")
edit("11.19", "writes a single point", "r * np.cos(t)", "0.0 * r")
edit("11.19", "writes a line", "0.5 + r * np.sin(t)", "0.5 + 0.0 * t")
edit("11.19", "writes next to nothing", "0.35 + 0.12", "0.05 + 0.01")
edit("11.19", "uses an arm of one link", "np.array([1.0, 0.8, 0.5])", "np.array([2.3])")
edit("11.19", "takes longer than the film", "points, 10.0", "points, 60.0")
edit("11.19", "places points far away that are between two pictures", "points, 10.0",
     "np.insert(points, np.arange(1, 101), 5.0, axis=0), 4.04")

# fixed numbers in place of zero, and zero by one number only ----------------------------------------------------
edit("11.1", "takes coordinates below 1e-12 m for 0", "return x", "x[np.abs(x) < 1e-12] = 0.0; return x")
edit("11.1", "uses links of at least 1e-12 m", "lengths[k] * np.cos(phi)", "max(lengths[k], 1e-12) * np.cos(phi)")
edit("11.2", "takes entries below 1e-12 m for 0", "return J", "J[np.abs(J) < 1e-12] = 0.0; return J")
edit("11.3", "does not let D² be below 1e-30", "np.sqrt(squared) / longer", "np.sqrt(max(squared, 1e-30)) / longer")
edit("11.3", "takes D² below 1e-28 for 0", "np.sqrt(squared) / longer", "np.sqrt(squared * (squared > 1e-28)) / longer")
edit("11.3", "takes an ellipse of less than 1e-12 m² for a circle", TURN,
     f"({TURN} if abs(b) + abs(a - c) > 1e-12 else 0.0)")
edit("11.3", "takes an ellipse for a circle whose half axes differ by a part of 1e-8", TURN,
     f"({TURN} if abs(b) + abs(a - c) > 1e-8 * (a + c) else 0.0)")
edit("11.4", "takes nearly equal links for equal ones", "np.abs(lengths[0] - lengths[1])",
     "(0.0 if np.isclose(lengths[0], lengths[1]) else np.abs(lengths[0] - lengths[1]))")
edit("11.4", "turns to x where the target is nearer than 1e-9 m to the base", "back = np",
     "target = target if r > 1e-9 else np.array((r, 0.0)); back = np")
edit("11.5", "takes φ for 0 where the hand is below a millionth of the first link", "phi = target[2]",
     "phi = target[2] * (lengths[2] > 1e-6 * lengths[0])")
edit("11.6", "takes offsets below 1e-12 m for 0", "n = theta.size",
     "n = theta.size; offsets = offsets * (np.abs(offsets) > 1e-12)")
edit("11.7", "takes entries below 1e-12 for 0", "return J", "J[np.abs(J) < 1e-12] = 0.0; return J")
edit("11.8", "takes a vector for zero whose three numbers add up to 0", "size == 0.0", "d[1] + d[2] + d[3] == 0.0")
edit("11.8", "turns the longer way where w is hardly below 0", "d[0] < 0.0", "d[0] < -1e-15")
for number, where, what in (("11.9", "arm.gain * (e @ J)", "{} * arm.gain * (e @ J)"),
                            ("11.11", "solve_symmetric(A, e)", "solve_symmetric(A, {} * e)"),
                            ("11.16", "(e - J @ z)", "({} * e - J @ z)")):
    for story, test in (("whose numbers add up to 0", "(np.sum(e) != 0.0)"), ("with one number that is 0", "np.all(e)"),
                        ("whose first number is 0", "(e[0] != 0.0)"), ("below 1e-14", "(np.abs(e) > 1e-14)"),
                        ("whose largest number is not above 0", "(np.max(e) > 0.0)")):
        edit(number, f"takes an e for zero {story}", where, what.format(test))
edit("11.10", "takes singular values below 1e-15 for 0, regardless of the largest", CUTOFF, f"max({CUTOFF}, 1e-15)")
edit("11.10", "adds a small number to what it divides by", "/ sigma[i]", "/ (sigma[i] + 1e-30)")
for number in ("11.11", "11.15"):
    edit(number, "uses a damping of at least 1e-9 m", "arm.damping * arm.damping", "max(arm.damping, 1e-9) ** 2")
edit("11.11", "uses a small damping where it is given as 0", "arm.damping * arm.damping",
     "(arm.damping if arm.damping > 0.0 else 1e-6) ** 2")
edit("11.12", "adds 1e-30 to what it divides by", "(sigma**2 + damping**2)", "(sigma**2 + damping**2 + 1e-30)")
edit("11.12", "takes σ below 1e-12 m for 0", "gain * sigma**2", "gain * (sigma * (sigma > 1e-12))**2")
for story, test in (("straight above or below it", "s_x != 0.0"), ("on a diagonal", "s_x + s_y != 0.0"),
                    ("nearer than 1e-12 m to it", "s_x * s_x + s_y * s_y > 1e-24")):
    edit("11.13", f"does not turn a joint towards a target {story}", "wish = theta[k] + np.arctan2",
         f"wish = theta[k] + ({test}) * np.arctan2")
edit("11.13", "does not turn a joint by less than 1e-9 rad", "c, s = np.cos(new - theta[k])",
     "new = new if abs(new - theta[k]) > 1e-9 else theta[k]; c, s = np.cos(new - theta[k])")
edit("11.14", "takes coordinates below 1e-12 m for 0", "return x", "x[np.abs(x) < 1e-12] = 0.0; return x")
edit("11.15", "blocks a joint that is within 1e-12 of its upper limit", "theta[k] >= arm.high[k]",
     "theta[k] >= arm.high[k] - 1e-12")
edit("11.15", "blocks a joint that is within 1e-12 of its lower limit", "theta[k] <= arm.low[k]",
     "theta[k] <= arm.low[k] + 1e-12")
for story, test in (("where all its angles are 0", "np.any(arm.rest)"),
                    ("a joint whose angle of rest is 0", "(arm.rest != 0.0)"),
                    ("where its angles add up to 0", "(np.sum(arm.rest) != 0.0)")):
    edit("11.16", f"does not pull to rest {story}", "arm.pull *", f"arm.pull * {test} *")
for story, least in (("1e-9 m", "1e-9"), ("1e-4 of the reach", "1e-4 * reach")):
    edit("11.17", f"takes a distance below {story} for 0", LEFT,
         f"left = {LEFT[7:]}\n    return left if left > {least} else 0.0")
