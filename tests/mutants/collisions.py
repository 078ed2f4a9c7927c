"""Lesson 6: collision detection with a wrong side, root, clamp or case."""

import numpy as np

from solutions import collisions as worked
from solutions.checks import BadInput

from . import collection, variants

wrong, right, edit, MUTANTS = collection(worked)
NEVER = np.inf


def size(y):
    return float(np.linalg.norm(y))


# 6.1 ------------------------------------------------------------------------------------------------------------
@variants
def distance(f=lambda p, plane: sum(a * b for a, b in zip(plane.n, p, strict=True)) + plane.d):
    def plane_distance(p, plane):
        return f(p, plane)
    return plane_distance


right("6.1", "as a sum")(distance())
wrong("6.1", "reverses the sign of d")(distance(lambda p, plane: p @ plane.n - plane.d))
wrong("6.1", "returns the distance without its sign")(distance(lambda p, plane: abs(p @ plane.n + plane.d)))
wrong("6.1", "forgets d")(distance(lambda p, plane: p @ plane.n))
wrong("6.1", "returns only the sign of the distance")(distance(lambda p, plane: np.sign(p @ plane.n + plane.d)))
edit("6.1", "returns zero for distances below 1e-15 m",
     "plane.d", "plane.d if abs(p @ plane.n + plane.d) > 1e-15 else 0.0")
edit("6.1", "returns zero for distances below 1 µm", "plane.d", "plane.d if abs(p @ plane.n + plane.d) > 1e-6 else 0.0")
edit("6.1", "subtracts d", "p @ plane.n + plane.d", "plane.d - p @ plane.n")
edit("6.1", "reverses the distance: positive on the wrong side",
     "return p @ plane.n + plane.d", "return -(p @ plane.n + plane.d)")
edit("6.1", "forgets d of a plane that lies along an axis", "plane.d", "(plane.d if np.all(plane.n) else 0.0)")
edit("6.1", "returns zero for distances that are small beside d", "return p",
     "return 0.0 if abs(p @ plane.n + plane.d) < 1e-9 * abs(plane.d) else p")


# 6.2 ------------------------------------------------------------------------------------------------------------
@variants
def impact(skin=1.0, after_skin=1.0, share=lambda d_1, d_2: d_1 / (d_1 + d_2), inside=lambda t: t,
           late=True, start=1.0):
    def plane_impact_time(t, dt, x_0, x_1, r, plane):
        d_1 = worked.plane_distance(x_0, plane) - skin * r
        d_2 = after_skin * r - worked.plane_distance(x_1, plane)
        if d_1 <= 0.0:
            return inside(t)
        if d_2 < 0.0 and late:
            return NEVER
        return start * t + share(d_1, d_2) * dt
    return plane_impact_time


right("6.2", "with new names")(impact())
edit("6.2", "treats the ball as a point", "plane_distance(x_0, plane) - r, r - plane_distance(x_1, plane)",
     "plane_distance(x_0, plane), -plane_distance(x_1, plane)")
edit("6.2", "forgets the radius in the share of the step only",
     "before / (before + after)", "(before + r) / (before + after)")
edit("6.2", "misses an impact if the ball touches and leaves", "before <= 0.0", "before < 0.0")
MISSES_THE_END = edit("6.2", "misses an impact exactly at the end of the step", "after < 0.0", "after <= 0.0")
wrong("6.2", "subtracts r from the first distance only")(impact(after_skin=0.0))
wrong("6.2", "exchanges the two distances in the share of the step")(impact(share=lambda d_1, d_2: d_2 / (d_1 + d_2)))
wrong("6.2", "returns the middle of the step")(impact(share=lambda d_1, d_2: 0.5))
wrong("6.2", "finds no impact if the ball already overlaps")(impact(inside=lambda t: NEVER))
wrong("6.2", "extrapolates beyond the end of the step")(impact(late=False))
wrong("6.2", "forgets t")(impact(start=0.0))
edit("6.2", "treats a gap below 1 nm as contact", "before <= 0.0", "before <= 1e-9")
edit("6.2", "treats a gap below 1e-15 m as contact", "before <= 0.0", "before <= 1e-15")
edit("6.2", "finds an impact at once if the ball is almost there", "before <= 0.0", "before <= 1e-6 * after")
edit("6.2", "finds an impact of a ball that ends less than 1 pm above the plane", "after < 0.0", "after < -1e-12")
edit("6.2", "finds no impact for a point below the plane",
     "before <= 0.0:", "before < 0.0 == r: return NEVER\n    if before <= 0.0:")
edit("6.2", "adds r to the distance before the step",
     "plane_distance(x_0, plane) - r,", "plane_distance(x_0, plane) + r,")
edit("6.2", "takes d₂ with the wrong sign", "r - plane_distance(x_1, plane)", "plane_distance(x_1, plane) - r")
edit("6.2", "subtracts the two distances in place of adding them", "(before + after)", "(before - after)")
edit("6.2", "adds r to the distance after the step",
     "r - plane_distance(x_1, plane)", "-r - plane_distance(x_1, plane)")
edit("6.2", "forgets dt", "t + dt * before", "t + before")
edit("6.2", "exchanges the positions before and after",
     "before, after = plane_distance(x_0, plane) - r, r - plane_distance(x_1, plane)",
     "before, after = plane_distance(x_1, plane) - r, r - plane_distance(x_0, plane)")
edit("6.2", "subtracts the time until the impact", "t + dt * before", "t - dt * before")
edit("6.2", "subtracts the diameter, not the radius, from the distance before",
     "plane_distance(x_0, plane) - r,", "plane_distance(x_0, plane) - 2.0 * r,")
edit("6.2", "returns the end of the step if the ball does not reach the plane", "return NEVER", "return t + dt")
edit("6.2", "divides by the distance after only", "(before + after)", "after")
edit("6.2", "finds no impact of a ball that does not move",
     "before <= 0.0:", "np.all(x_0 == x_1): return NEVER\n    if before <= 0.0:")
edit("6.2", "takes steps of at most 1 s", "t + dt * before", "t + min(dt, 1.0) * before")
edit("6.2", "takes a ball for at rest where the components of its move add up to 0",
     "after < 0.0", "after < 0.0 or np.sum(x_1 - x_0) == 0.0")
edit("6.2", "takes a ball for at rest where the first component of its move is 0",
     "after < 0.0", "after < 0.0 or x_1[0] == x_0[0]")
edit("6.2", "finds an impact of a ball that nearly reaches the plane", "after < 0.0", "after < -1e-3 * before")



# 6.3 ------------------------------------------------------------------------------------------------------------
@variants
def beside(foot=lambda x: np.array([x[0], 0.0, 0.0]), swap=False, radius=lambda R: R, own=lambda r: r):
    def cylinder_contact(x, r, R):
        a, b = (x, own(r)), (foot(x), radius(R))
        return worked.ball_contact(*b, *a) if swap else worked.ball_contact(*a, *b)
    return cylinder_contact


wrong("6.3", "uses the distance from the origin")(beside(lambda x: np.zeros(3)))
wrong("6.3", "takes the cylinder's axis along y")(beside(lambda x: np.array([0.0, x[1], 0.0])))
wrong("6.3", "returns a normal that points from a to b")(beside(swap=True))
wrong("6.3", "forgets the cylinder's radius")(beside(radius=lambda R: 0.0))
wrong("6.3", "forgets the ball's radius")(beside(own=lambda r: 0.0))


@right("6.3", "written out")
def cylinder_contact(x, r, R):
    h = np.hypot(x[1], x[2])
    n = np.array([0.0, x[1] / h, x[2] / h]) if h > 0.0 else np.array([0.0, 1.0, 0.0])
    return worked.Contact(x - r * n, np.array([x[0], 0.0, 0.0]) + R * n, n, h - r - R, 0.0)


edit("6.3", "exchanges the two radii",
     "ball_contact(x, r, np.array([x[0], 0.0, 0.0]), R)", "ball_contact(x, R, np.array([x[0], 0.0, 0.0]), r)")
edit("6.3", "takes the cylinder's axis along z", "np.array([x[0], 0.0, 0.0])", "np.array([0.0, 0.0, x[2]])")
edit("6.3", "takes the part across the axis for the foot", "np.array([x[0], 0.0, 0.0])", "np.array([0.0, x[1], x[2]])")
edit("6.3", "adds the ball's radius to the cylinder's, and keeps it", "0.0]), R)", "0.0]), R + r)")
edit("6.3", "returns the centre as both points of a ball on the axis",
     "return", "if not x[1:].any(): return Contact(x, x, np.array([0.0, 1.0, 0.0]), -R - r, 0.0)\n    return")
edit("6.3", "takes a ball for on the axis where y + z is 0", "return",
     "if x[1] + x[2] == 0.0: return Contact(x, x, np.array([0.0, 1.0, 0.0]), -R - r, 0.0)\n    return")
edit("6.3", "returns NEVER for the time of a contact", "R)", "R)._replace(t=NEVER)")



# 6.4 ------------------------------------------------------------------------------------------------------------
@variants
def root(which=-1.0, naive=False, rho=lambda R, r: R + r, three=False,
         window=True, leaving=True, inside=lambda t: t, t_0=1.0):
    def cylinder_impact_time(t, dt, x_0, x_1, r, R):
        first = 0 if three else 1
        y, w, reach = x_0[first:], (x_1 - x_0)[first:], rho(R, r)
        A, B, C = w @ w, y @ w, y @ y - reach**2
        D = B * B - A * C if naive or three else A * reach**2 - (y[0] * w[1] - y[1] * w[0]) ** 2
        if C <= 0.0:
            return inside(t)
        if (B >= 0.0 and leaving) or D < 0.0 or A == 0.0:
            return NEVER
        s = (-B + which * np.sqrt(D)) / A if naive or which > 0.0 else C / (np.sqrt(D) - B)
        return t_0 * t + s * dt if s <= 1.0 or not window else NEVER
    return cylinder_impact_time


right("6.4", "by the parts of the path")(root())
wrong("6.4", "returns the second root")(root(which=1.0))
wrong("6.4", "takes the textbook form of the root, with D = B² − A C, which cancels")(root(naive=True))
wrong("6.4", "forgets the ball")(root(rho=lambda R, r: R))
wrong("6.4", "forgets the cylinder")(root(rho=lambda R, r: r))
wrong("6.4", "treats the cylinder as a sphere")(root(three=True))
wrong("6.4", "accepts impacts after the end of the step")(root(window=False))
wrong("6.4", "accepts impacts before the start of the step")(root(leaving=False))
wrong("6.4", "finds no impact if the ball already overlaps")(root(inside=lambda t: NEVER))
wrong("6.4", "forgets t")(root(t_0=0.0))
edit("6.4", "tests only the end of the step", "C / (np.sqrt(D) - B)",
     "1.0 if x_1[1:] @ x_1[1:] <= rho * rho else 2.0")
CYLINDER_MISSES_THE_END = edit("6.4", "misses an impact exactly at the end of the step", "s > 1.0", "s >= 1.0")
edit("6.4", "misses an impact if the ball touches and leaves", "C <= 0.0", "C < 0.0")
edit("6.4", "misses a ball that only grazes", "D < 0.0", "D <= 0.0")
edit("6.4", "ignores steps below a micrometre", "B >= 0.0", "A < 1e-12 or B >= 0.0")
edit("6.4", "ignores steps below a nanometre", "B >= 0.0", "A < 1e-18 or B >= 0.0")
edit("6.4", "treats C below 1e-12 as contact", "C <= 0.0", "C <= 1e-12")
edit("6.4", "treats C below 1e-15 as contact", "C <= 0.0", "C <= 1e-15")
edit("6.4", "treats C below 1e-22 as contact", "C <= 0.0", "C <= 1e-22")
edit("6.4", "misses an impact in the first millionth of the step", "s > 1.0", "not 1e-6 < s <= 1.0")
edit("6.4", "treats B above −1e-18 as a ball that does not approach", "B >= 0.0", "B >= -1e-18")
edit("6.4", "accepts an impact slightly after the end of the step", "s > 1.0", "s > 1.0 + 1e-9")
edit("6.4", "takes D = B² − A C, which cancels",
     "D = A * rho * rho - (y[0] * w[1] - y[1] * w[0]) ** 2", "D = B * B - A * C")
edit("6.4", "forgets the root of D", "np.sqrt(D)", "D")
edit("6.4", "forgets the minus sign of B", "(np.sqrt(D) - B)", "(np.sqrt(D) + B)")
edit("6.4", "subtracts the radii", "rho = R + r", "rho = R - r")
edit("6.4", "does not square the sum of the radii", "y @ y - rho * rho", "y @ y - rho")
edit("6.4", "takes the end of the step for the direction: forgets the difference", "x_1[1:] - x_0[1:]", "x_1[1:]")
edit("6.4", "takes the opposite direction", "x_1[1:] - x_0[1:]", "x_0[1:] - x_1[1:]")
edit("6.4", "forgets dt", "t + s * dt", "t + s")
edit("6.4", "takes the cylinder's axis along z: uses the first two coordinates",
     "y, w = x_0[1:], x_1[1:] - x_0[1:]", "y, w = x_0[:2], x_1[:2] - x_0[:2]")
edit("6.4", "divides by 2A, which belongs to A s² + B s + C = 0",
     "s = C / (np.sqrt(D) - B)", "s = (-B - np.sqrt(D)) / (2.0 * A)")
edit("6.4", "solves A s² + B s + C = 0, with B in place of 2B", "D = A * rho * rho - (y[0] * w[1] - y[1] * w[0]) ** 2",
     "D, C = B * B - 4.0 * A * C, 2.0 * C")
edit("6.4", "uses 2B in place of B", "w @ w, y @ w,", "w @ w, 2.0 * (y @ w),")
edit("6.4", "exchanges the tests of B: misses a ball that approaches", "B >= 0.0 or", "B <= 0.0 or")
edit("6.4", "takes the sum of the products in the last form of D",
     "(y[0] * w[1] - y[1] * w[0]) ** 2", "(y[0] * w[1] + y[1] * w[0]) ** 2")


@right("6.4", "by the other form of the root")
def cylinder_impact_time(t, dt, x_0, x_1, r, R):
    y, w = x_0[1:], (x_1 - x_0)[1:]
    A, B, inside = w @ w, y @ w, y @ y <= (R + r)**2
    D = A * (R + r)**2 - (y[0] * w[1] - y[1] * w[0]) ** 2
    if inside or B >= 0.0 or D < 0.0:
        return t if inside else NEVER
    s = (-B - np.sqrt(D)) / A
    return NEVER if s > 1.0 else t + s * dt
edit("6.4", "compares the share s of the step with dt, not with 1", "s > 1.0", "s > dt")
edit("6.4", "misses a ball of radius 0, a point", "D < 0.0", "r == 0.0 or D < 0.0")
edit("6.4", "finds no impact at once on the axis itself", "C <= 0.0", "C <= 0.0 < y @ y")
edit("6.4", "takes a ball for at rest where the components of its move add up to 0",
     "B >= 0.0 or", "np.sum(w) == 0.0 or B >= 0.0 or")
edit("6.4", "takes a ball for at rest where it does not move along y", "B >= 0.0 or", "w[0] == 0.0 or B >= 0.0 or")
edit("6.4", "takes a ball for at rest where it does not move along z", "B >= 0.0 or", "w[1] == 0.0 or B >= 0.0 or")
edit("6.4", "finds an impact of a ball that barely misses", "or D < 0.0", "or D < -1e-6 * A * rho * rho")



# 6.5 ------------------------------------------------------------------------------------------------------------
@variants
def foot(low=0.0, high=1.0, checked=True, begin="a", unit=False):
    def closest_on_segment(p, a, b):
        e = b - a
        if not e @ e and checked:
            raise BadInput("a segment", 0.0, "give two ends")
        s = (p - a) @ e / (size(e) if unit else e @ e)
        s = min(high, max(low, s))
        return (a if begin == "a" else p) + s * e
    return closest_on_segment


right("6.5", "with a clamp")(foot())
wrong("6.5", "treats the segment as a ray")(foot(high=np.inf))
wrong("6.5", "divides by the length once")(foot(unit=True))
wrong("6.5", "adds the offset to p, not to a")(foot(begin="p"))
edit("6.5", "treats the segment as an infinite line",
     "np.minimum(1.0, np.maximum(0.0, (p - a) @ along / length_squared))",
     "(p - a) @ along / length_squared")
edit("6.5", "accepts a segment of zero length",
     'raise BadInput("the length of an edge [m]", 0.0, "give two different ends")', "return a")
edit("6.5", "returns the nearer end", "np.minimum(1.0, np.maximum(0.0, (p - a) @ along / length_squared))",
     "float((p - a) @ (p - a) > (p - b) @ (p - b))")
edit("6.5", "refuses short segments", "length_squared == 0.0", "length_squared < 1e-12")
edit("6.5", "refuses segments along a coordinate axis", "length_squared == 0.0", "np.any(a == b)")
edit("6.5", "refuses segments shorter than 1 nm", "length_squared == 0.0", "length_squared < 1e-18")
edit("6.5", "refuses segments shorter than an atomic nucleus", "length_squared == 0.0", "length_squared < 1e-30")
edit("6.5", "refuses very long segments", "length_squared == 0.0",
     "length_squared == 0.0 or length_squared > 1e24")
edit("6.5", "never divides by zero", "/ length_squared", "/ (length_squared + 1e-30)")
edit("6.5", "refuses two ends that are nearly equal", "length_squared == 0.0", "np.allclose(a, b, atol=0.0, rtol=1e-9)")
edit("6.5", "takes what is close to an end for the end",
     "np.minimum(1.0, np.maximum(0.0, (p - a) @ along / length_squared))",
     "(lambda s: 0.0 if s < 1e-6 else 1.0 if s > 1.0 - 1e-6 else s)((p - a) @ along / length_squared)")
edit("6.5", "measures the offset from b", "(p - a) @ along", "(p - b) @ along")
edit("6.5", "measures the offset from the point to the end", "(p - a) @ along", "(a - p) @ along")
edit("6.5", "exchanges the limits, so that one end always wins",
     "np.minimum(1.0, np.maximum(0.0,", "np.maximum(1.0, np.minimum(0.0,")
edit("6.5", "adds the share to the other end", "return a + np", "return b + np")
edit("6.5", "subtracts the share from a", "return a + np", "return a - np")
edit("6.5", "returns the first end for a point at the second one", "return a +", "return a if np.all(p == b) else a +")
edit("6.5", "takes points on one coordinate for ends", "return a +", "return a if len(p) == 1 else a +")
edit("6.5", "refuses a segment whose components add up to 0", "length_squared == 0.0", "np.sum(along) == 0.0")
edit("6.5", "refuses a segment without a first component", "length_squared == 0.0", "along[0] == 0.0")
edit("6.5", "refuses a segment without a last component", "length_squared == 0.0", "along[-1] == 0.0")



# 6.6 ------------------------------------------------------------------------------------------------------------
@variants
def face(signs=(1, -1), edges=3, thick=True, pierced=lambda r, R: -R - r, measure=worked.edge_axis_distance):
    def triangle_cylinder_gap(a, b, c, r, R):
        corners = [a, b, c]
        turns = [float(np.linalg.det(np.stack((corners[k][1:], corners[(k + 1) % 3][1:])))) for k in range(3)]
        if any(all(sign * turn > 0.0 for turn in turns) for sign in signs):
            return pierced(r, R)
        return min(measure(corners[k], corners[(k + 1) % 3]) for k in range(edges)) - R - (r if thick else 0.0)
    return triangle_cylinder_gap


right("6.6", "by determinants")(face())
wrong("6.6", "tests the edges only")(face(signs=()))
wrong("6.6", "tests one side of the face only")(face(signs=(1,)))
wrong("6.6", "tests two edges only")(face(edges=2))
wrong("6.6", "measures the distance of the corners only")(face(measure=lambda a, b: size(a[1:])))
wrong("6.6", "forgets r")(face(thick=False))
wrong("6.6", "returns a gap of zero for a pierced face")(face(pierced=lambda r, R: 0.0))
edit("6.6", "treats an edge-on triangle as pierced", "np.all(turns > 0.0) or np.all(turns < 0.0)",
     "np.all(turns >= 0.0) or np.all(turns <= 0.0)")
edit("6.6", "counts zeros as equal signs", "np.all(turns > 0.0) or np.all(turns < 0.0)",
     "np.all(np.sign(turns) == np.sign(turns[0]))")
edit("6.6", "tests the signs with a tolerance of 1e-30", "np.all(turns > 0.0) or np.all(turns < 0.0)",
     "np.all(turns > 1e-30) or np.all(turns < -1e-30)")
edit("6.6", "tests the signs with a tolerance of 1e-12", "np.all(turns > 0.0) or np.all(turns < 0.0)",
     "np.all(turns > 1e-12) or np.all(turns < -1e-12)")
edit("6.6", "forgets R",
     "np.minimum(two_edges, edge_axis_distance(c, a)) - R - r", "np.minimum(two_edges, edge_axis_distance(c, a)) - r")
edit("6.6", "adds r to the gap", "c, a)) - R - r", "c, a)) - R + r")
edit("6.6", "takes the greatest of the three distances", "return np.minimum(two_edges", "return np.maximum(two_edges")
edit("6.6", "counts the face as pierced where any of the three products is positive",
     "np.all(turns > 0.0)", "np.any(turns > 0.0)")
edit("6.6", "returns a positive gap for a pierced face", "return -R - r", "return R + r")
edit("6.6", "takes the first two coordinates: projects along z",
     "a[1] * b[2] - a[2] * b[1]", "a[0] * b[1] - a[1] * b[0]")
edit("6.6", "has a wrong sign in a cross product", "c[1] * a[2] - c[2] * a[1]", "a[1] * c[2] - a[2] * c[1]")
edit("6.6", "returns a gap of zero where a corner lies on the axis", "turns = np.array(",
     "if not (a[1:].any() and b[1:].any() and c[1:].any()): return 0.0\n    turns = np.array(")
edit("6.6", "takes an edge for parallel to the axis where the components across add up to 0",
     "np.minimum(edge_axis_distance(a, b), edge",
     "np.minimum(edge_axis_distance(a, b) if np.sum(b[1:] - a[1:]) else np.sqrt(a[1:] @ a[1:]), edge")



# 6.7 ------------------------------------------------------------------------------------------------------------
@variants
def on_triangle(edges=3, inside=True, clamp=True, checked=True, flat=worked.DEGENERATE_AREA, absolute=False):
    def closest_on_triangle(p, a, b, c):
        corners = [a, b, c]
        N = np.cross(b - a, c - a)
        longest = max(size(corners[k] - corners[k - 1]) for k in range(3))
        if checked and size(N) <= flat * (1.0 if absolute else longest**2):
            raise BadInput("the area of a triangle [m²]", 0.5 * size(N), "give one with an area")
        q = p - (p - a) @ N / (N @ N) * N
        if inside and all(np.cross(corners[(k + 1) % 3] - corners[k], q - corners[k]) @ N >= 0.0 for k in range(3)):
            return q
        if not clamp:
            return q
        feet = [worked.closest_on_segment(p, corners[k], corners[(k + 1) % 3]) for k in range(edges)]
        return min(feet, key=lambda y: size(y - p))
    return closest_on_triangle


right("6.7", "in a loop")(on_triangle())
wrong("6.7", "tests the edges only")(on_triangle(inside=False))
wrong("6.7", "returns the closest point of the plane, not of the triangle")(on_triangle(clamp=False))
wrong("6.7", "tests two edges only")(on_triangle(edges=2))
wrong("6.7", "accepts a triangle without area")(on_triangle(checked=False))
FIRST_TWO = "nearer(p, closest_on_segment(p, a, b), closest_on_segment(p, b, c))"
THREE_EDGES = f"nearer(p, {FIRST_TWO}, closest_on_segment(p, c, a))"
OUTSIDE = "closest_on_segment(p, {0}, {1}) if dot(cross({1} - {0}, q - {0}), N) < 0.0 else "
edit("6.7", "names |N| in the error, which is twice the area", "[m²]\", area", "[m²]\", 2.0 * area")
edit("6.7", "refuses small inputs", "DEGENERATE_AREA * longest", "1e-9")
edit("6.7", "compares the area with an absolute 1e-12 m²", "DEGENERATE_AREA * longest", "DEGENERATE_AREA")
edit("6.7", "compares |N| with a length, not with an area",
     "DEGENERATE_AREA * longest", "DEGENERATE_AREA * np.sqrt(longest)")
LONGEST = "max(dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c))"
edit("6.7", "compares the area with the first edge only", LONGEST, "dot(b - a, b - a)")
edit("6.7", "compares the area with the second edge only", LONGEST, "dot(c - b, c - b)")
edit("6.7", "compares the area with the third edge only", LONGEST, "dot(a - c, a - c)")
edit("6.7", "forgets the edge from b to c", LONGEST, "max(dot(b - a, b - a), dot(a - c, a - c))")
edit("6.7", "compares the area with the shortest edge", LONGEST, LONGEST.replace("max", "min"))
edit("6.7", "compares the area with all three edges together", LONGEST, LONGEST.replace("max(", "sum((") + ")")
edit("6.7", "compares the area with the two edges at a", LONGEST, "np.sqrt(dot(b - a, b - a) * dot(a - c, a - c))")
edit("6.7", "halves |N| before the comparison", "np.sqrt(dot(N, N)) > DEGENERATE_AREA", "area > DEGENERATE_AREA")
edit("6.7", "uses a limit for the area that is ten times too large", "DEGENERATE_AREA * longest", "1e-11 * longest")
edit("6.7", "uses a limit for the area that is ten times too small", "DEGENERATE_AREA * longest", "1e-13 * longest")
edit("6.7", "squares DEGENERATE_AREA but not the length",
     "np.sqrt(dot(N, N)) > DEGENERATE_AREA * longest", "dot(N, N) > DEGENERATE_AREA**2 * longest")
edit("6.7", "returns the nearest corner", THREE_EDGES, "nearer(p, nearer(p, a, b), c)")
edit("6.7", "takes the first edge that has p on its outer side", THREE_EDGES,
     OUTSIDE.format("a", "b") + OUTSIDE.format("b", "c") + "closest_on_segment(p, c, a)")
edit("6.7", "takes the last edge that has p on its outer side", THREE_EDGES,
     OUTSIDE.format("c", "a") + OUTSIDE.format("b", "c") + "closest_on_segment(p, a, b)")
edit("6.7", "compares the first two edges by their distance from a corner, not from p",
     FIRST_TWO, FIRST_TWO.replace("nearer(p", "nearer(c"))
edit("6.7", "refuses needles: forgets the root of N · N", "np.sqrt(dot(N, N)) > DEGENERATE_AREA * longest",
     "dot(N, N) > DEGENERATE_AREA * longest**2")
edit("6.7", "subtracts N, not the part along it: forgets the division by N · N",
     "dot(p - a, N) / dot(N, N) * N", "dot(p - a, N) * N")
edit("6.7", "adds the part along N", "q = p - dot", "q = p + dot")
edit("6.7", "divides by |N| once", "dot(p - a, N) / dot(N, N) * N", "dot(p - a, N) / np.sqrt(dot(N, N)) * N")
edit("6.7", "takes q as inside where one of the three tests holds",
     "N) >= 0.0 and dot(cross(c - b, q - b), N) >= 0.0 and", "N) >= 0.0 or dot(cross(c - b, q - b), N) >= 0.0 or")
edit("6.7", "projects p itself, not p − a", "dot(p - a, N) /", "dot(p, N) /")
edit("6.7", "returns the first corner for a point in the plane of the triangle",
     "dot(N, N) * N", "dot(N, N) * N if dot(p - a, N) else a")
edit("6.7", "refuses a triangle whose normal has components that add up to 0",
     "if not np.sqrt", "if np.sum(N) == 0.0 or not np.sqrt")
edit("6.7", "refuses a triangle whose normal has no first component", "if not np.sqrt", "if N[0] == 0.0 or not np.sqrt")
edit("6.7", "refuses a triangle whose normal has no last component", "if not np.sqrt", "if N[2] == 0.0 or not np.sqrt")
edit("6.7", "accepts a triangle that is exactly as flat as DEGENERATE_AREA",
     "if not np.sqrt(dot(N, N)) > DEGENERATE_AREA", "if np.sqrt(dot(N, N)) < DEGENERATE_AREA")
edit("6.7", "refuses a triangle that is barely less flat than DEGENERATE_AREA", "DEGENERATE_AREA * longest",
     "1.1 * DEGENERATE_AREA * longest")
edit("6.7", "takes a point for inside that is barely beyond the first edge", "if dot(cross(b - a, q - a), N) >= 0.0",
     "if dot(cross(b - a, q - a), N) >= -1e-6 * dot(N, N)")



# 6.8 ------------------------------------------------------------------------------------------------------------
@variants
def in_box(turn=lambda R, y: R.T @ y, inside=True, pick=np.argmin,
           depth_sign=-1.0, sign=lambda y: 1.0 if y >= 0.0 else -1.0, out=1.0):
    def ball_box(x, r, box):
        y = turn(box.R, x - box.x)
        depth = box.half - np.abs(y)
        if not (inside and np.all(depth >= 0.0)):
            q = np.clip(y, -box.half, box.half)
            own = worked.ball_contact(y, r, q, 0.0)
            return worked.Contact(x - r * (box.R @ own.n), box.x + box.R @ q, box.R @ own.n, own.gap, 0.0)
        i = int(pick(depth))
        n = out * sign(y[i]) * box.R[:, i]
        return worked.Contact(x - r * n, x + depth[i] * n, n, depth_sign * depth[i] - r, 0.0)
    return ball_box


right("6.8", "with clip")(in_box())
wrong("6.8", "rotates the wrong way")(in_box(turn=lambda R, y: R @ y))
wrong("6.8", "does not transform the ball into the box's axes")(in_box(turn=lambda R, y: y))
wrong("6.8", "does not handle a centre inside the box")(in_box(inside=False))
wrong("6.8", "takes the farthest face")(in_box(pick=np.argmax))
wrong("6.8", "returns a positive gap inside")(in_box(depth_sign=1.0))
wrong("6.8", "returns a zero normal at the centre")(in_box(sign=np.sign))
wrong("6.8", "returns a normal that points inwards")(in_box(out=-1.0))
FACE_IS_OUTSIDE = edit("6.8", "treats a point on a face as outside", "depth[i] < 0.0", "depth[i] <= 0.0")
edit("6.8", "takes the face of the largest coordinate", "np.argmin(depth)", "np.argmax(np.abs(y))")
edit("6.8", "compares the depths relative to the half edges", "np.argmin(depth)", "np.argmin(depth / box.half)")
SIGN_OF_ZERO = edit("6.8", "takes −1 for the sign of 0", "y[i] >= 0.0", "y[i] > 0.0")
edit("6.8", "treats a picometre outside as inside", "depth[i] < 0.0", "depth[i] < -1e-12")
edit("6.8", "treats a minute distance outside as inside", "depth[i] < 0.0", "depth[i] < -1e-20")
edit("6.8", "takes +1 for the sign of coordinates above −1 pm", "y[i] >= 0.0", "y[i] >= -1e-12")
edit("6.8", "takes the full edges for the half edges", "depth = box.half", "depth = 0.5 * box.half")
edit("6.8", "returns q in the box's axes", "box.x + box.R @ q", "box.x + q")
edit("6.8", "leaves the normal outside in the box's axes", "n = box.R @ own.n", "n = own.n")
edit("6.8", "forgets the box's centre in the nearest point", "box.x + box.R @ q", "box.R @ q")
edit("6.8", "drops the absolute value of the coordinates in the depth", "box.half - np.abs(y)", "box.half - y")
edit("6.8", "forgets r in the gap inside", "-depth[i] - r", "-depth[i]")
edit("6.8", "adds r to the gap inside", "-depth[i] - r", "r - depth[i]")
edit("6.8", "takes the row of R for the axis", "column(box.R, i)", "box.R[i].copy()")
edit("6.8", "exchanges the two points inside",
     "Contact(x - r * n, x + depth[i] * n,", "Contact(x + depth[i] * n, x - r * n,")
edit("6.8", "puts p_a on the other side of the ball", "x - r * n, x", "x + r * n, x")
edit("6.8", "puts p_b on the other side", "x + depth[i] * n", "x - depth[i] * n")
edit("6.8", "gives the ball's contact outside a radius of zero",
     "ball_contact(y, r, q, 0.0)", "ball_contact(y, 0.0, q, 0.0)")
edit("6.8", "treats the ball as inside where a single coordinate is", "if depth[i] < 0.0", "if np.max(depth) < 0.0")
edit("6.8", "limits the coordinates from above only",
     "np.minimum(box.half, np.maximum(-box.half, y))", "np.minimum(box.half, y)")
edit("6.8", "uses the body axis in place of the world axis for the normal", "column(box.R, i)", "np.eye(3)[i]")
edit("6.8", "rotates q by the transpose", "box.R @ q", "box.R.T @ q")
edit("6.8", "treats a point on an edge as outside", "depth[i] < 0.0", "depth[i] < 0.0 or np.sum(depth == 0.0) > 1")
edit("6.8", "takes the middle of the box for a point beyond the middle of a face",
     "np.minimum(box.half, np.maximum(-box.half, y))", "np.minimum(box.half, np.maximum(-box.half, y)) * np.all(y)")
edit("6.8", "treats a centre as inside that is outside by less than a ten-thousandth of an edge",
     "depth[i] < 0.0", "np.any(depth < -1e-4 * box.half)")
edit("6.8", "treats a centre as inside that is outside by less than a millionth of an edge",
     "depth[i] < 0.0", "np.any(depth < -1e-6 * box.half)")
edit("6.8", "takes a centre for inside where the components of the way to the nearest point add up to 0",
     "if depth[i] < 0.0", "if depth[i] < 0.0 and np.sum(y - np.minimum(box.half, np.maximum(-box.half, y)))")
edit("6.8", "returns NEVER for the time of a contact inside", "-depth[i] - r, 0.0", "-depth[i] - r, NEVER")
edit("6.8", "returns NEVER for the time of a contact outside", "own.gap, 0.0)", "own.gap, NEVER)")


@right("6.8", "with lists in the contact")
def ball_box(x, r, box):
    c = worked.ball_box(x, r, box)
    return worked.Contact(list(c.p_a), list(c.p_b), list(c.n), float(c.gap), 0)



# 6.9 ------------------------------------------------------------------------------------------------------------
@variants
def sweep(f=lambda low, high, move: (low + np.clip(move, None, 0.0), high + np.clip(move, 0.0, None))):
    def swept_box(low, high, move):
        return f(low, high, move)
    return swept_box


right("6.9", "by the parts of the way")(sweep())
wrong("6.9", "returns the box at the end position only")(sweep(lambda low, high, move: (low + move, high + move)))
wrong("6.9", "moves the high corner only, whichever way the box moves")(
    sweep(lambda low, high, move: (low, high + move)))
edit("6.9", "extends the box in the positive directions only", "np.minimum(low, low + move)", "low")
edit("6.9", "extends the box in the negative directions only", "np.maximum(high, high + move)", "high")
wrong("6.9", "extends the box on every side")(sweep(lambda low, high, move: (low - np.abs(move), high + np.abs(move))))
edit("6.9", "extends the box by the largest move in all coordinates",
     "np.maximum(high, high + move)", "high + max(0.0, np.max(move))")
edit("6.9", "ignores moves below 1 pm", "return", "move = np.where(np.abs(move) < 1e-12, 0.0, move); return")
wrong("6.9", "does not sweep")(sweep(lambda low, high, move: (low, high)))
edit("6.9", "exchanges minimum and maximum",
     "np.minimum(low, low + move), np.maximum(high, high + move)",
     "np.maximum(low, low + move), np.minimum(high, high + move)")
edit("6.9", "subtracts the move",
     "low + move), np.maximum(high, high + move)", "low - move), np.maximum(high, high - move)")
edit("6.9", "returns the upper corner first",
     "return np.minimum(low, low + move), np.maximum(high, high + move)",
     "return np.maximum(high, high + move), np.minimum(low, low + move)")
edit("6.9", "adds the move to the width: the upper corner from the lower one",
     "np.maximum(high, high + move)", "np.maximum(high, low + move)")
edit("6.9", "leaves a flat box where it is",
     "return", "move = 0.0 * move if np.any(low == high) else move; return")
edit("6.9", "leaves a box where it is if the components of its move add up to 0",
     "return", "move = 0.0 * move if np.sum(move) == 0.0 else move; return")



# 6.10 -----------------------------------------------------------------------------------------------------------
@variants
def brute(strict=False, first=lambda i: i + 1, turned=False):
    def all_pairs(low, high):
        worked.check_boxes(low, high)
        n, found = len(low), []
        for i in range(n):
            for j in range(first(i), n):
                a, b = (low[i], high[i]), (low[j], high[j])
                touch = np.all((a[0] < b[1]) & (b[0] < a[1])) if strict else np.all((a[0] <= b[1]) & (b[0] <= a[1]))
                if touch:
                    found.append((j, i) if turned else (i, j))
        return np.array(found, dtype=np.int64).reshape(-1, 2)
    return all_pairs


right("6.10", "with NumPy's comparison")(brute())
wrong("6.10", "omits boxes that share a face")(brute(strict=True))
wrong("6.10", "pairs each box with itself")(brute(first=lambda i: i))
wrong("6.10", "pairs each box with all, and so with itself")(brute(first=lambda i: 0))
edit("6.10", "returns each pair in both orders", "found.append((i, j))", "found += [(i, j), (j, i)]")
edit("6.10", "returns each pair in both orders", "for j in range(i + 1, len(low)):",
     "for j in [j for j in range(len(low)) if j != i]:")
wrong("6.10", "returns the larger number first")(brute(turned=True))
edit("6.10", "tests neighbours in the list only", "range(i + 1, len(low))", "range(i + 1, min(i + 2, len(low)))")
edit("6.10", "accepts invalid boxes", "check_boxes(low, high)", "pass")
edit("6.10", "accepts boxes that are slightly inside out", "check_boxes(low, high)", "check_boxes(low, high + 1e-9)")
edit("6.10", "accepts lower corners at NaN", "check_boxes(low, high)",
     "check_boxes(np.where(np.isnan(low), high, low), high)")
edit("6.10", "accepts infinite corners", "check_boxes(low, high)",
     "check_boxes(np.maximum(low, -1e300), np.minimum(high, 1e300))")
edit("6.10", "does not test the last two", "range(len(low))", "range(len(low) - 2)")
edit("6.10", "counts boxes as touching that are up to 1e-15 m apart", "boxes_touch(low, high, i, low, high, j)",
     "boxes_touch(low - 5e-16, high + 5e-16, i, low - 5e-16, high + 5e-16, j)")
edit("6.10", "counts boxes as touching that are up to 1 nm apart", "boxes_touch(low, high, i, low, high, j)",
     "boxes_touch(low - 5e-10, high + 5e-10, i, low - 5e-10, high + 5e-10, j)")
edit("6.10", "checks its boxes after the search", "check_boxes(low, high)",
     "check_boxes(low[:len(high)], high)")
edit("6.10", "starts each inner loop at 1, not at i + 1", "range(i + 1, len(low))", "range(1, len(low))")
edit("6.10", "returns the pairs that do not touch", "if boxes_touch", "if not boxes_touch")
edit("6.10", "stops at the first pair of each box", "found.append((i, j))", "found.append((i, j)); break")
edit("6.10", "starts each inner loop at i + 2", "range(i + 1, len(low))", "range(i + 2, len(low))")
edit("6.10", "tests the first hundred boxes only", "range(len(low))", "range(min(len(low), 100))")


# 6.11 -----------------------------------------------------------------------------------------------------------
@variants
def traversal(prune=True, second=True, turned=False, both=True,
              leaves=lambda a, i, b, j, found: worked.touching_items(a, i, b, j, found)):
    def find_intersections(a, b):
        found = []

        def go(i, j):
            if prune and not worked.boxes_touch(a.low, a.high, i, b.low, b.high, j):
                return
            down_a, down_b = int(a.child[i]), int(b.child[j])
            if not down_a and not down_b:
                leaves(a, i, b, j, found)
            elif down_a and (not down_b or worked.half_perimeter(a, i) >= worked.half_perimeter(b, j)):
                go(down_a, j)
                if second:
                    go(down_a + 1, j)
            elif both or not down_a:
                go(i, down_b)
                go(i, down_b + 1)
        go(0, 0)
        pairs = np.array(found, dtype=np.int64).reshape(-1, 2)
        return pairs[:, ::-1] if turned else pairs
    return find_intersections


def every_item(a, i, b, j, found):
    for k in range(a.first[i], a.first[i] + a.held[i]):
        for m in range(b.first[j], b.first[j] + b.held[j]):
            found.append((a.order[k], b.order[m]))


right("6.11", "as a recursion")(traversal())
wrong("6.11", "visits all pairs of nodes and never prunes")(traversal(prune=False))
wrong("6.11", "forgets the second child")(traversal(second=False))
wrong("6.11", "returns all items of leaves that touch")(traversal(leaves=every_item))
wrong("6.11", "returns b before a")(traversal(turned=True))
wrong("6.11", "stops where b's node is the larger one")(traversal(both=False))
edit("6.11", "visits each pair of nodes once where a tree meets itself",
     "if boxes_touch(", "if not (a is b and i > j) and boxes_touch(")
edit("6.11", "visits at most 1,000 pairs of nodes", "while len(waiting) > 0",
     "for _ in (k for k in range(1000) if waiting)")
edit("6.11", "visits at most 10,000 pairs of nodes", "while len(waiting) > 0",
     "for _ in (k for k in range(10000) if waiting)")


@right("6.11", "opens the smaller node first")
def find_intersections(a, b):
    found, waiting = [], [(0, 0)]
    while waiting:
        i, j = waiting.pop(0)
        if worked.boxes_touch(a.low, a.high, i, b.low, b.high, j):
            down_a, down_b = a.child[i], b.child[j]
            if not down_a and not down_b:
                worked.touching_items(a, i, b, j, found)
            elif not down_b or (down_a and worked.half_perimeter(a, i) < worked.half_perimeter(b, j)):
                waiting += [(down_a, j), (down_a + 1, j)]
            else:
                waiting += [(i, down_b), (i, down_b + 1)]
    return worked.as_pairs(found)


edit("6.11", "opens both nodes at once, and compares left with left and right with right only", "elif down_b == 0 or",
     "elif down_a > 0 and down_b > 0:\n"
     "                waiting += [(down_a, down_b), (down_a + 1, down_b + 1)]\n"
     "            elif down_b == 0 or")
edit("6.11", "forgets the first child", "waiting.append((down_a, j))", "pass")
edit("6.11", "forgets the second child of b", "waiting.append((i, down_b + 1))", "pass")
edit("6.11", "finds no pair with a tree that is a single leaf", "while len(waiting) > 0",
     "while len(waiting) > 0 and b.child[0] > 0")
edit("6.11", "searches all items of two nodes below the root, and does not descend",
     "down_a == 0 and down_b == 0", "i > 0 < j or down_a == 0 and down_b == 0")
edit("6.11", "searches all items of both nodes where one of them is a leaf",
     "down_a == 0 and down_b == 0", "down_a == 0 or down_b == 0")
edit("6.11", "prunes near the root only", "if boxes_touch(", "if max(i, j) > 2 or boxes_touch(")
edit("6.11", "does not prune at leaves", "if boxes_touch(",
     "if a.child[i] == b.child[j] == 0 or boxes_touch(")
edit("6.11", "prunes the first thirty nodes only", "if boxes_touch(", "if max(i, j) > 30 or boxes_touch(")
edit("6.11", "prunes by the first coordinate only", "boxes_touch(a.low, a.high, i, b.low, b.high, j)",
     "boxes_touch(a.low[:, :1], a.high[:, :1], i, b.low[:, :1], b.high[:, :1], j)")
edit("6.11", "prunes by the last coordinate only", "boxes_touch(a.low, a.high, i, b.low, b.high, j)",
     "boxes_touch(a.low[:, -1:], a.high[:, -1:], i, b.low[:, -1:], b.high[:, -1:], j)")
edit("6.11", "prunes only nodes that are more than 1 m apart", "boxes_touch(a.low, a.high, i,",
     "boxes_touch(a.low - 1.0, a.high + 1.0, i,")


# 6.12 -----------------------------------------------------------------------------------------------------------
@variants
def edges(inner=min, outer=max, sign=1.0, centre=False, checked=True, of=lambda a, b: (a, b)):
    def separating_edge(a, b):
        a, b = of(a, b)
        found = []
        for i in range(len(a)):
            e = a[(i + 1) % len(a)] - a[i]
            n = sign * (worked.outward(a, i) if checked else np.array([e[1], -e[0]]) / max(size(e), 1e-300))
            found.append(((inner(float(n @ (y - a[i])) for y in ([b.mean(axis=0)] if centre else b))), -i))
        gap, i = outer(found)
        return gap, -i
    return separating_edge


right("6.12", "with min and max")(edges())
wrong("6.12", "takes the farthest corner")(edges(inner=max))
wrong("6.12", "takes the edge with the least separation")(edges(outer=min))
wrong("6.12", "uses normals that point inwards")(edges(sign=-1.0))
wrong("6.12", "uses the centre of b in place of its corners")(edges(centre=True))
wrong("6.12", "accepts an edge of zero length")(edges(checked=False))
wrong("6.12", "uses the edges of b")(edges(of=lambda a, b: (b, a)))
edit("6.12", "takes the edge whose gap is nearest to zero", "not gap <= greatest", "abs(gap) < abs(greatest)")
edit("6.12", "takes the first edge that separates", "not gap <= greatest", "greatest <= 0.0 and gap > greatest")
edit("6.12", "takes the last edge that separates", "not gap <= greatest", "gap > min(greatest, 0.0)")
edit("6.12", "uses the first seven edges only", "range(len(a))", "range(min(len(a), 7))")
edit("6.12", "forgets the first corner of b", "range(len(b))", "range(1, len(b))")
FIRST_CORNER_ONLY = edit("6.12", "starts every edge at the first corner", "b[j] - a[i]", "b[j] - a[0]")
edit("6.12", "requires a later edge to be better by 1 pm", "not gap <= greatest", "not gap <= greatest + 1e-12")
edit("6.12", "returns zero for gaps below 1 pm", "return greatest, edge",
     "return (0.0 if abs(greatest) < 1e-12 else greatest), edge")
edit("6.12", "starts the minimum at 1e15 m, not at infinity", "outward(a, i), np.inf", "outward(a, i), 1e15")
edit("6.12", "starts the minimum at 1e9 m, not at infinity", "outward(a, i), np.inf", "outward(a, i), 1e9")
edit("6.12", "starts the maximum at −1e6 m, not at minus infinity", "-np.inf", "-1e6")
edit("6.12", "forgets a's corner", "n @ (b[j] - a[i])", "n @ b[j]")
edit("6.12", "keeps the gap of the last edge", "greatest, edge = gap, i", "edge = i")
edit("6.12", "counts the edges from 1", "return greatest, edge", "return greatest, edge + 1")
edit("6.12", "does not start the minimum again for each edge",
     "n, gap = outward(a, i), np.inf", "n, gap = outward(a, i), (np.inf if i == 0 else gap)")
edit("6.12", "uses the first hundred corners of b only", "range(len(b))", "range(min(len(b), 100))")
edit("6.12", "skips an edge that touches the other polygon exactly",
     "not gap <= greatest", "gap and not gap <= greatest")
edit("6.12", "refuses an edge whose components add up to 0", "n, gap = outward(a, i), np.inf",
     'if np.sum(a[(i + 1) % len(a)] - a[i]) == 0.0: raise BadInput("an edge", 0.0, "")\n'
     "        n, gap = outward(a, i), np.inf")
edit("6.12", "refuses an edge without a first component", "n, gap = outward(a, i), np.inf",
     'if a[(i + 1) % len(a), 0] == a[i, 0]: raise BadInput("an edge", 0.0, "")\n'
     "        n, gap = outward(a, i), np.inf")



# 6.13 -----------------------------------------------------------------------------------------------------------
@variants
def cut(side=1.0, crossing=lambda s_i, s_j: s_i / (s_i - s_j), back=False, add=True,
        offset=1.0, kept_at=lambda s: s <= 0.0, crosses=lambda a, b: a * b < 0.0):
    def clip(y, n, d):
        k, kept = len(y), []
        s = [side * float(n @ p - offset * d) for p in y]
        for i in range(k):
            j = (i + 1) % k
            if kept_at(s[i]):
                kept.append(y[i])
            if add and crosses(s[i], s[j]) and (back or k > 2 or i == 0):
                kept.append(y[i] + crossing(s[i], s[j]) * (y[j] - y[i]))
        return np.array(kept).reshape(-1, y.shape[1])
    return clip


right("6.13", "with a list")(cut())
wrong("6.13", "keeps the other side of the plane")(cut(side=-1.0))
wrong("6.13", "puts the crossing in the middle of the edge")(cut(crossing=lambda s_i, s_j: 0.5))
wrong("6.13", "measures the crossing from the other end")(cut(crossing=lambda s_i, s_j: s_j / (s_j - s_i)))
wrong("6.13", "treats a segment as a polygon with two edges")(cut(back=True))
wrong("6.13", "removes corners and adds no crossings")(cut(add=False))
wrong("6.13", "removes corners on the plane")(cut(kept_at=lambda s: s < 0.0))
wrong("6.13", "counts corners on the plane twice")(cut(crosses=lambda a, b: a * b <= 0.0 and a != b))
wrong("6.13", "forgets d")(cut(offset=0.0))
edit("6.13", "keeps corners up to 1 nm outside", "s_i <= 0.0", "s_i <= 1e-9")
edit("6.13", "keeps corners up to 1e-15 m outside", "s_i <= 0.0", "s_i <= 1e-15")
edit("6.13", "keeps corners that are outside by a minute distance", "s_i <= 0.0", "s_i <= 1e-20")
edit("6.13", "adds no crossing where the product of the distances is minute", "s_i * s_j < 0.0", "s_i * s_j < -1e-30")
edit("6.13", "adds a crossing only where it goes out", "s_i * s_j < 0.0", "s_i < 0.0 < s_j")
edit("6.13", "recognises segments in two dimensions only", "k > 2", "y.shape != (2, 2)")
edit("6.13", "fails for an empty polygon", "kept[:m].copy()",
     "kept[:m].copy() if (y @ n - d).max() > 0.0 else y.copy()")
edit("6.13", "has room for 8 corners only", "2 * len(y)", "8")
edit("6.13", "has room for 10 corners only", "2 * len(y)", "10")
edit("6.13", "has room for 16 corners only", "2 * len(y)", "16")
edit("6.13", "has room for 20 corners only", "2 * len(y)", "20")
edit("6.13", "subtracts the share of the edge", "y[i] + s_i / (s_i - s_j)", "y[i] - s_i / (s_i - s_j)")
SUM_OF_DISTANCES = edit("6.13", "divides by the sum of the two distances", "s_i / (s_i - s_j)", "s_i / (s_i + s_j)")
edit("6.13", "adds d", "n @ y[i] - d, n @ y[j] - d", "n @ y[i] + d, n @ y[j] + d")
edit("6.13", "adds no crossing from the last corner to the first", "(k > 2 or i == 0)", "i < k - 1")
edit("6.13", "adds a crossing where the signs are equal", "s_i * s_j < 0.0", "s_i * s_j > 0.0")
edit("6.13", "adds a crossing only where it comes in", "s_i * s_j < 0.0", "s_i > 0.0 and s_j < 0.0")
edit("6.13", "adds the whole edge vector", "s_i / (s_i - s_j) * (y[j] - y[i])", "s_i / (s_i - s_j) * y[j]")
edit("6.13", "has room for 100 corners only", "2 * len(y)", "100")
edit("6.13", "drops the ends of a segment that are on the plane", "s_i <= 0.0", "s_i <= 0.0 and (k > 2 or s_i < 0.0)")
edit("6.13", "skips an edge whose components add up to 0", "s_i * s_j < 0.0", "s_i * s_j < 0.0 != np.sum(y[j] - y[i])")
edit("6.13", "skips an edge without a first component", "s_i * s_j < 0.0", "s_i * s_j < 0.0 != y[j, 0] - y[i, 0]")
edit("6.13", "puts the crossing of a segment behind its second corner", "(k > 2 or i == 0)", "(k != 2 or i == 1)")
edit("6.13", "keeps corners that are outside by a billionth of d", "s_i <= 0.0", "s_i <= 1e-9 * abs(d)")
edit("6.13", "adds no crossing where one end is very near to the plane", "s_i * s_j < 0.0",
     "s_i * s_j < -1e-12 * (s_i**2 + s_j**2)")



# 6.14 -----------------------------------------------------------------------------------------------------------
@variants
def boxes(axes=range(15), room=worked.EDGE_PREFERENCE, sign=1.0, width=worked.half_width, choose=lambda new,
          old: new > old, fixed=False):
    def box_separation(a, b):
        r, best, size = a.x - b.x, None, max(*a.half, *b.half)
        for k in axes:
            n = worked.candidate_axis(a, b, k)
            if not np.any(n):
                continue
            gap = abs(float(r @ n)) - width(a, n) - width(b, n)
            if best is None or choose(gap, best[0] + (room * size if k >= 6 else 0.0)):
                best = gap, n, k
        gap, n, k = best
        return gap, n if fixed else (sign if n @ r >= 0.0 else -sign) * n, k
    return box_separation


right("6.14", "with a tuple")(boxes())
wrong("6.14", "tests the axes of a only")(boxes(axes=range(3)))
wrong("6.14", "tests the normals of faces only")(boxes(axes=range(6)))
wrong("6.14", "returns a normal that points from a to b")(boxes(sign=-1.0))
wrong("6.14", "does not orient the axis")(boxes(fixed=True))
wrong("6.14", "takes the last one of equal axes")(boxes(choose=lambda new, old: new >= old))
edit("6.14", "accepts zero axes", "dot(axis, axis) > 0.0", "dot(axis, axis) >= 0.0")
edit("6.14", "prefers no face over an edge", "ahead if k >= 6", "0.0 if k >= 6")
edit("6.14", "prefers a face unless an edge separates by a twentieth more",
     "ahead if k >= 6", "0.05 * abs(greatest) if k >= 6")
edit("6.14", "prefers a face unless an edge separates by 1 nm more, however small the boxes are",
     "ahead if k >= 6", "1e-9 if k >= 6")
edit("6.14", "prefers a face unless an edge separates by 1 pm more", "ahead if k >= 6", "1e-12 if k >= 6")
edit("6.14", "prefers a face by a part of the gap, not of the size",
     "ahead if k >= 6", "1e-9 * abs(greatest) if k >= 6")
edit("6.14", "takes the longest half edge of a alone", "np.maximum(np.max(a.half), np.max(b.half))", "np.max(a.half)")
edit("6.14", "takes the shortest half edge of each box",
     "np.maximum(np.max(a.half), np.max(b.half))", "np.maximum(np.min(a.half), np.min(b.half))")
edit("6.14", "requires no advantage of an edge over another edge",
     "ahead if k >= 6", "ahead if k >= 6 and number < 6")
edit("6.14", "forgets the last axis", "range(15)", "range(14)")
edit("6.14", "takes the first axis that separates", "not gap <= greatest +", "greatest <= 0.0 and gap > greatest +")
edit("6.14", "tests edges only where no face separates",
     "not gap <= greatest +", "(k < 6 or greatest < 0.0) and gap > greatest +")
edit("6.14", "takes the axis whose gap is nearest to zero", "not gap <= greatest +", "abs(gap) < abs(greatest) +")
wrong("6.14", "takes the axis with the least gap")(boxes(choose=lambda new, old: new < old))
wrong("6.14", "takes the longest half edge for the half width")(boxes(width=lambda box, n: float(np.max(box.half))))
edit("6.14", "starts the maximum at −1e6 m, not at minus infinity", "-np.inf", "-1e6")
edit("6.14", "requires an advantage for faces, too", "ahead if k >= 6 else 0.0", "ahead")
edit("6.14", "adds the half widths",
     "- half_width(a, axis) - half_width(b, axis)", "+ half_width(a, axis) + half_width(b, axis)")
edit("6.14", "forgets the half width of b", "- half_width(b, axis)", "")
edit("6.14", "drops the absolute value of the distance", "abs(dot(r, axis))", "dot(r, axis)")
edit("6.14", "leaves out the last six axes", "range(15)", "range(9)")
edit("6.14", "counts the axes from 1", "-best), number", "-best), number + 1")
edit("6.14", "skips an axis along which the boxes touch exactly",
     "not gap <= greatest +", "gap and not gap <= greatest +")
edit("6.14", "takes the faces alone where a is not rotated",
     "range(15)", "range(6 if np.all(a.R == np.eye(3)) else 15)")
edit("6.14", "skips an axis whose components add up to 0", "dot(axis, axis) > 0.0", "np.sum(axis) != 0.0")
edit("6.14", "skips an axis without a first component", "dot(axis, axis) > 0.0", "axis[0] != 0.0")
edit("6.14", "returns a normal from a to b where a is barely beside b along it", "dot(best, r) >= 0.0",
     "dot(best, r) >= -1e-2 * np.sqrt(dot(r, r))")
edit("6.14", "skips an axis without a last component", "dot(axis, axis) > 0.0", "axis[2] != 0.0")



# 6.15 -----------------------------------------------------------------------------------------------------------
@variants
def nearest(steps=worked.MAX_GJK_STEPS, along=(-1.0, 1.0), reduce=True, swap=False):
    def gjk(a, b):
        worked.check_hulls(a, b)
        p, q, weights = a[:1], b[:1], np.ones(1)
        for _ in range(steps):
            v = weights @ (p - q)
            i, j = worked.support(a, along[0] * v), worked.support(b, along[1] * v)
            if worked.far_enough(v, a[i] - b[j]):
                break
            p, q = np.vstack((p, a[i])), np.vstack((q, b[j]))
            p, q, weights = worked.nearest_subsimplex(p, q)
            if not reduce:
                p, q, weights = p[-1:], q[-1:], np.ones(1)
        x, y = weights @ p, weights @ q
        return worked.ball_contact(y, 0.0, x, 0.0) if swap else worked.ball_contact(x, 0.0, y, 0.0)
    return gjk


right("6.15", "with vstack")(nearest())
wrong("6.15", "stops after a single iteration")(nearest(steps=1))
wrong("6.15", "stops after five iterations")(nearest(steps=5))
wrong("6.15", "exchanges the two directions of support")(nearest(along=(1.0, -1.0)))
wrong("6.15", "takes both supports along the same direction")(nearest(along=(-1.0, -1.0)))
wrong("6.15", "keeps a single pair of corners")(nearest(reduce=False))
wrong("6.15", "returns a normal that points from a to b")(nearest(swap=True))
edit("6.15", "does not check its input", "check_hulls(a, b)", "pass")
edit("6.15", "checks only the points of a", "check_hulls(a, b)", "check_hulls(a, a)")
edit("6.15", "checks only the points of b", "check_hulls(a, b)", "check_hulls(b, b)")
edit("6.15", "returns a corner of each hull in place of the closest points", "weights @ p, 0.0, weights @ q, 0.0",
     "p[0], 0.0, q[0], 0.0")
edit("6.15", "stops after eight iterations", "range(MAX_GJK_STEPS)", "range(8)")
edit("6.15", "stops after twelve iterations", "range(MAX_GJK_STEPS)", "range(12)")
edit("6.15", "treats a distance below 1e-15 m as overlap", "if far_enough(", "if v @ v < 1e-30 or far_enough(")
edit("6.15", "stops while the bounds still differ", "if far_enough(v, a[i] - b[j])",
     "if v @ v - v @ (a[i] - b[j]) < 1e-26")
edit("6.15", "treats a distance below 1 nm as overlap", "if far_enough(", "if v @ v < 1e-18 or far_enough(")
edit("6.15", "takes the difference the other way", "v = weights @ (p - q)", "v = weights @ (q - p)")
edit("6.15", "appends the corner of b to p", "np.concatenate((q, b[j:j + 1]))", "np.concatenate((q, a[i:i + 1]))")
edit("6.15", "stops where it should go on, and goes on where it should stop", "if far_enough", "if not far_enough")
edit("6.15", "adds the corner of b in place of subtracting it", "a[i] - b[j])", "a[i] + b[j])")
edit("6.15", "exchanges the bodies where both are single points", "weights @ p, 0.0, weights @ q, 0.0",
     "*((b[0], 0.0, a[0], 0.0) if len(a) == len(b) == 1 else (weights @ p, 0.0, weights @ q, 0.0))")
edit("6.15", "takes the bodies for overlapping where the components of v add up to 0",
     "if far_enough(", "if np.sum(v) == 0.0 or far_enough(")
edit("6.15", "takes the bodies for overlapping where the first component of v is 0",
     "if far_enough(", "if v[0] == 0.0 or far_enough(")
edit("6.15", "takes the bodies for overlapping where the last component of v is 0",
     "if far_enough(", "if v[-1] == 0.0 or far_enough(")
edit("6.15", "returns NEVER for the time of a contact", "weights @ q, 0.0)", "weights @ q, 0.0)._replace(t=NEVER)")



# 6.16 -----------------------------------------------------------------------------------------------------------
@variants
def field(strength=lambda g, reach: (1.0 / g - 1.0 / reach) / g**2,
          sign=1.0, checked=True, skin=True, ends=True, unit=True):
    def repulsion(x, centre, radius, reach, k):
        r = x - centre
        g = size(r) - (radius if skin else 0.0)
        if checked and size(r) <= radius:
            raise BadInput("the gap [m]", g, "start outside")
        if ends and g >= reach:
            return 0.0 * r
        return sign * k * strength(g, reach) * (r / max(size(r), 1e-300) if unit else r)
    return repulsion


right("6.16", "with new names")(field())
wrong("6.16", "reverses the force, which then attracts")(field(sign=-1.0))
wrong("6.16", "returns the potential, not the force")(
    field(strength=lambda g, reach: 0.5 * (1.0 / g - 1.0 / reach) ** 2))
wrong("6.16", "divides by g in place of g²")(field(strength=lambda g, reach: (1.0 / g - 1.0 / reach) / g))
wrong("6.16", "measures the gap from the centre")(field(skin=False))
wrong("6.16", "repels beyond its reach, too")(field(ends=False))
wrong("6.16", "accepts a position inside the obstacle")(field(checked=False))
wrong("6.16", "multiplies by the offset in place of its direction")(field(unit=False))
edit("6.16", "accepts a position on the surface", "not g > 0.0", "g < 0.0")
edit("6.16", "refuses gaps below a micrometre", "not g > 0.0", "g < 1e-6")
edit("6.16", "refuses minute gaps", "not g > 0.0", "not g > 1e-20")
edit("6.16", "limits the acceleration to 1e6 m/s²", "k * (1.0 / g - 1.0 / reach) / (g * g * distance)",
     "min(k * (1.0 / g - 1.0 / reach) / (g * g), 1e6) / distance")
edit("6.16", "uses a gap of at least 1 mm", "g = distance - radius",
     "g = max(distance - radius, 1e-3 * (distance > radius))")
edit("6.16", "measures its reach from the centre", "g >= reach", "distance >= reach")
edit("6.16", "forgets k", "k * (1.0 / g", "(1.0 / g")
edit("6.16", "adds the two terms of the potential", "(1.0 / g - 1.0 / reach)", "(1.0 / g + 1.0 / reach)")
edit("6.16", "squares the difference, as in the potential", "(1.0 / g - 1.0 / reach) /", "(1.0 / g - 1.0 / reach)**2 /")
edit("6.16", "keeps the factor ½ of the potential", "k * (1.0", "0.5 * k * (1.0")
edit("6.16", "divides by one power of the gap too many", "(g * g * distance)", "(g * g * g * distance)")
edit("6.16", "forgets the inner derivative", "(g * g * distance)", "distance")
edit("6.16", "divides by the square of the distance from the centre, not of the gap",
     "(g * g * distance)", "(distance * distance * distance)")
edit("6.16", "adds the radius to the distance", "distance - radius", "distance + radius")
edit("6.16", "omits the square root in the distance", "np.sqrt(r @ r)", "r @ r")
FIELD_WITH_A_JUMP = edit("6.16", "omits the term of the reach", "(1.0 / g - 1.0 / reach)", "(1.0 / g)")
edit("6.16", "repels beyond the reach only", "g >= reach", "g <= reach")
edit("6.16", "repels by the gap itself, not by one over it",
     "k * (1.0 / g - 1.0 / reach) / (g * g * distance) * r", "k * (reach - g) / distance * r")
edit("6.16", "takes a k of at most 10 m⁴/s²", "else k *", "else min(k, 10.0) *")
edit("6.16", "gives an obstacle of radius 0 no field", "g >= reach", "radius == 0.0 or g >= reach")
edit("6.16", "refuses a body whose offset has components that add up to 0",
     "not g > 0.0", "np.sum(r) == 0.0 or not g > 0.0")
edit("6.16", "refuses a body whose offset has no first component", "not g > 0.0", "r[0] == 0.0 or not g > 0.0")
edit("6.16", "gives no field where the offset has no last component", "g >= reach", "g >= reach or r[-1] == 0.0")


@right("6.16", "as a list")
def repulsion(x, centre, radius, reach, k):
    return list(worked.repulsion(x, centre, radius, reach, k))
edit("6.16", "refuses gaps below a billionth of the distance", "not g > 0.0", "not g > 1e-9 * distance")
edit("6.16", "accepts a position inside an obstacle without a field", "not g > 0.0", "k > 0.0 and not g > 0.0")
edit("6.16", "ends its field a thousandth before the reach", "g >= reach", "g >= 0.999 * reach")



# 6.17 -----------------------------------------------------------------------------------------------------------
@variants
def swerve(side=-1.0, half=2.0, power=2, window=True, behind=True, wide=True,
           left=1.0, rest=True, need=lambda radius, offset: radius - offset):
    def steer(x, v, centre, radius, ahead):
        speed = size(v)
        if speed == 0.0:
            return 0.0 * v if rest else v + 1.0
        e, r = v / speed, centre - x
        along = float(r @ e)
        y, tau = r - along * e, along / speed
        if (behind and tau <= 0.0) or (window and tau >= ahead) or (wide and size(y) >= radius):
            return 0.0 * v
        way = side * y / size(y) if size(y) > 0.0 else left * np.array([-e[1], e[0]])
        return half * need(radius, size(y)) / abs(tau) ** power * way
    return steer


right("6.17", "with new names")(swerve())
wrong("6.17", "steers towards the obstacle")(swerve(side=1.0))
wrong("6.17", "steers half as much")(swerve(half=1.0))
wrong("6.17", "divides by τ, not by τ²")(swerve(power=1))
wrong("6.17", "steers for an obstacle behind, too")(swerve(behind=False))
wrong("6.17", "does not limit the time ahead")(swerve(window=False))
wrong("6.17", "steers for an obstacle that it would miss")(swerve(wide=False))
wrong("6.17", "steers to the right where it is head-on")(swerve(left=-1.0))
wrong("6.17", "does not steer where it is head-on")(swerve(left=0.0))
wrong("6.17", "steers from rest")(swerve(rest=False))
edit("6.17", "steers when exactly beside the centre", "tau <= 0.0", "tau < 0.0")
edit("6.17", "steers at the end of the time ahead", "tau >= ahead", "tau > ahead")
edit("6.17", "does not steer where it would pass near the centre", "offset >= radius",
     "offset >= radius or r @ r < 0.05 * radius**2")
wrong("6.17", "steers aside by the whole radius, regardless of the offset")(swerve(need=lambda radius, offset: radius))
edit("6.17", "does not steer in the last 0.01 s", "tau <= 0.0", "tau <= 1e-2")
edit("6.17", "does not steer in the last 0.1 ms", "tau <= 0.0", "tau <= 1e-4")
edit("6.17", "treats speeds below 1 nm/s as rest", "speed == 0.0", "speed < 1e-9")
edit("6.17", "treats an offset below 1e-19 m as head-on", "offset > 0.0", "offset > 1e-19")
edit("6.17", "looks 4 s ahead, regardless of the argument", "tau >= ahead", "tau >= 4.0")
edit("6.17", "looks at most 10 s ahead", "tau >= ahead", "tau >= min(ahead, 10.0)")
edit("6.17", "brakes as well as steering sideways", "tau**2 * aside", "tau**2 * aside - 0.1 * v")
edit("6.17", "treats v as zero where its first component is zero", "speed == 0.0", "v[0] == 0.0")
edit("6.17", "treats speeds below 1 mm/s as rest", "speed == 0.0", "speed < 1e-3")
edit("6.17", "computes the left direction for motion along x only", "else left", "else np.array([0.0, e[0]])")
edit("6.17", "treats an offset below a hundredth of the radius as head-on", "offset > 0.0", "offset >= 0.01 * radius")
edit("6.17", "treats an offset below 1 µm as head-on", "offset > 0.0", "offset >= 1e-6")
edit("6.17", "treats an offset close to zero as head-on", "offset > 0.0", "not np.isclose(offset, 0.0)")
edit("6.17", "ignores a disc that it is inside", "offset >= radius", "offset >= radius or np.sqrt(r @ r) <= radius")
edit("6.17", "measures the offset the wrong way: from the centre to the body", "r = centre - x", "r = x - centre")
edit("6.17", "adds the offset, where only the rest of the radius is missing", "(radius - offset)", "(radius + offset)")
edit("6.17", "steers along r, not across v", "aside = -y / offset", "aside = -r / np.sqrt(r @ r)")
edit("6.17", "does not normalise the offset", "aside = -y / offset", "aside = -y")
edit("6.17", "steers four times as much", "2.0 * (radius", "4.0 * (radius")
edit("6.17", "uses v in place of its direction for the distance along", "along = r @ e", "along = r @ v")
edit("6.17", "takes the offset from the whole distance, not from its part across", "y = (r @ left) * left", "y = r")
edit("6.17", "adds the part along the motion", "(r @ left) * left", "(r @ left) * left + 2.0 * along * e")
edit("6.17", "uses `ahead` in place of the time until it passes", "/ tau**2", "/ ahead**2")
edit("6.17", "squares the offset that is missing", "2.0 * (radius - offset)", "2.0 * (radius - offset)**2")
edit("6.17", "steers only where it would miss", "offset >= radius", "offset <= radius")
edit("6.17", "divides by the square of the speed for the time",
     "np.sqrt(y @ y), along / speed", "np.sqrt(y @ y), along / speed**2")
edit("6.17", "takes the distance for the time: does not divide by the speed",
     "np.sqrt(y @ y), along / speed", "np.sqrt(y @ y), along")
edit("6.17", "steers aside from a disc of radius 0", "offset >= radius", "offset >= radius > 0.0")
edit("6.17", "treats v as zero where its components add up to 0", "speed == 0.0", "np.sum(v) == 0.0")
edit("6.17", "treats v as zero where its second component is zero", "speed == 0.0", "v[1] == 0.0")
edit("6.17", "treats an offset as head-on where its components add up to 0", "offset > 0.0", "np.sum(y) != 0.0")
edit("6.17", "treats an offset as head-on where its first component is zero", "offset > 0.0", "y[0] != 0.0")
edit("6.17", "does not steer in the last 0.1 µs", "tau <= 0.0", "tau <= 1e-7")
edit("6.17", "does not steer where it would barely touch", "offset >= radius", "offset >= 0.999999 * radius")



# 6.18 --------------------------------------------------------------------------------------------------------------
@right("6.18", "by counting from the end of the step")
def share_past(r, w, v, dt):
    reach, move = r + 0.5 * w, v * dt
    return max(0.0, (move - reach) / move)


edit("6.18", "takes both sides of the wall: a ball that is found behind the middle leaves on the far side",
     "(r + 0.5 * w)", "(2.0 * r + w)")
edit("6.18", "takes the whole thickness in front of the middle", "0.5 * w", "w")
edit("6.18", "forgets the thickness of the wall", "(r + 0.5 * w)", "r")
edit("6.18", "forgets the radius of the ball", "(r + 0.5 * w)", "(0.5 * w)")
edit("6.18", "returns the share that is sent back", "1.0 - (r + 0.5 * w) / (v * dt)", "(r + 0.5 * w) / (v * dt)")
edit("6.18", "returns a negative share for short steps",
     "np.maximum(0.0, 1.0 - (r + 0.5 * w) / (v * dt))", "1.0 - (r + 0.5 * w) / (v * dt)")
edit("6.18", "takes the diameter of the ball as its radius", "(r + 0.5 * w)", "(0.5 * r + 0.5 * w)")
edit("6.18", "lets all balls past a wall without thickness", "return", "return 1.0 if w == 0.0 else")
edit("6.18", "takes speeds of at most 1000 m/s", "(v * dt)", "(min(v, 1e3) * dt)")


# 6.19 --------------------------------------------------------------------------------------------------------------
@right("6.19", "as a small letter")
def barrier_is():
    return "b"


edit("6.19", "chooses the force that is infinite at the wall but does a finite work: one over the root",
     '"B"', '"A"')
edit("6.19", "chooses the largest force far from the wall: a constant force does a finite work",
     '"B"', '"C"')
edit("6.19", "chooses the ramp, which is strongest at the wall but ends at a finite work",
     '"B"', '"D"')


# 6.20 --------------------------------------------------------------------------------------------------------------
@right("6.20", "looks ahead, and keeps to one side")
def my_rule(i, x, v, goals):
    to = goals[i] - x[i]
    a = 1.5 * (to * min(1.0, 1.2 / max(np.linalg.norm(to), 1e-9)) - v[i])
    for j in range(len(x)):
        if j != i:
            r, w = x[j] - x[i], v[j] - v[i]
            n = r / np.linalg.norm(r)
            a = a - (0.5 / max(np.linalg.norm(r) - 0.5, 0.05) * n if np.linalg.norm(r) < 2.0 else 0.0 * n)
            tau = -(r @ w) / max(w @ w, 1e-9)
            miss = np.linalg.norm(r + tau * w)
            if 0.0 < tau < 4.0 and miss < 0.8:
                a = a + 2.0 * (0.8 - miss) / (tau + 0.3) * np.array([n[1], -n[0]])
    return a * min(1.0, 4.5 / max(np.linalg.norm(a), 1e-9))


@right("6.20", "round the middle to the other side")
def to_the_other_side(i, x, v, goals):
    away, distance, size = goals[i] - x[i], np.linalg.norm(x[i]), np.linalg.norm(goals[i])
    around = np.array([x[i, 1], -x[i, 0]]) / distance + (size - distance) / size * x[i]
    return 2.0 * (1.2 * (around if away @ away > 1.0 else away) - v[i])


edit("6.20", "walks straight to the goal, and meets all others in the middle",
     "around if away @ away > 1.0 else away", "0.3 * away")
edit("6.20", "stands still", "1.2 * way", "0.0 * way")
edit("6.20", "walks round the middle for ever", "around if away @ away > 1.0 else away", "around")
edit("6.20", "turns by the number of the person: neighbours go to different sides",
     "np.array([-x[i, 1], x[i, 0]])", "(-1.0) ** i * np.array([-x[i, 1], x[i, 0]])")
edit("6.20", "accelerates more than a person can", "2.0 * (1.2", "6.0 * (1.2")
edit("6.20", "runs to the goal too slowly to arrive", "1.2 * way", "0.3 * way")
edit("6.8", "takes the normal from places in the world, whose round-off tilts it", "n = box.R @ own.n",
     "n = ball_contact(x, r, box.x + box.R @ q, 0.0).n")
