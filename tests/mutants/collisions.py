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
def distance(f=lambda p, plane: sum(a * b for a, b in zip(plane.n, p)) + plane.d):
    def plane_distance(p, plane):
        return f(p, plane)
    return plane_distance


right("6.1", "as a sum")(distance())
wrong("6.1", "d with the wrong sign")(distance(lambda p, plane: p @ plane.n - plane.d))
wrong("6.1", "returns the distance without its sign")(distance(lambda p, plane: abs(p @ plane.n + plane.d)))
wrong("6.1", "forgets d")(distance(lambda p, plane: p @ plane.n))
wrong("6.1", "only the sign")(distance(lambda p, plane: np.sign(p @ plane.n + plane.d)))
edit("6.1", "zero within a femtometre", "plane.d", "plane.d if abs(p @ plane.n + plane.d) > 1e-15 else 0.0")
edit("6.1", "zero within a micrometre", "plane.d", "plane.d if abs(p @ plane.n + plane.d) > 1e-6 else 0.0")


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
edit("6.2", "no impact if it touches and leaves", "before <= 0.0", "before < 0.0")
edit("6.2", "no impact at the end of the step", "after < 0.0", "after <= 0.0")
wrong("6.2", "subtracts r only before")(impact(after_skin=0.0))
wrong("6.2", "d₂ over the sum")(impact(share=lambda d_1, d_2: d_2 / (d_1 + d_2)))
wrong("6.2", "the middle of the step")(impact(share=lambda d_1, d_2: 0.5))
wrong("6.2", "never, if it already overlaps")(impact(inside=lambda t: NEVER))
wrong("6.2", "extrapolates beyond the step")(impact(late=False))
wrong("6.2", "forgets t")(impact(start=0.0))
edit("6.2", "touches within a nanometre", "before <= 0.0", "before <= 1e-9")
edit("6.2", "touches within a femtometre", "before <= 0.0", "before <= 1e-15")
edit("6.2", "at once, if it is almost there", "before <= 0.0", "before <= 1e-6 * after")
edit("6.2", "arrives within a picometre", "after < 0.0", "after < -1e-12")
edit("6.2", "a point below does not touch", "before <= 0.0:", "before < 0.0 == r: return NEVER\n    if before <= 0.0:")


# 6.3 ------------------------------------------------------------------------------------------------------------
@variants
def beside(foot=lambda x: np.array([x[0], 0.0, 0.0]), swap=False, radius=lambda R: R, own=lambda r: r):
    def cylinder_contact(x, r, R):
        a, b = (x, own(r)), (foot(x), radius(R))
        return worked.ball_contact(*b, *a) if swap else worked.ball_contact(*a, *b)
    return cylinder_contact


wrong("6.3", "the distance from the origin")(beside(lambda x: np.zeros(3)))
wrong("6.3", "takes the cylinder's axis along y")(beside(lambda x: np.array([0.0, x[1], 0.0])))
wrong("6.3", "n from a to b")(beside(swap=True))
wrong("6.3", "forgets the cylinder's radius")(beside(radius=lambda R: 0.0))
wrong("6.3", "forgets the ball's radius")(beside(own=lambda r: 0.0))


@right("6.3", "written out")
def cylinder_contact(x, r, R):
    h = np.hypot(x[1], x[2])
    n = np.array([0.0, x[1] / h, x[2] / h]) if h > 0.0 else np.array([0.0, 1.0, 0.0])
    return worked.Contact(x - r * n, np.array([x[0], 0.0, 0.0]) + R * n, n, h - r - R, 0.0)


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
wrong("6.4", "the second root")(root(which=1.0))
wrong("6.4", "the textbook root")(root(naive=True))
wrong("6.4", "forgets the ball")(root(rho=lambda R, r: R))
wrong("6.4", "forgets the cylinder")(root(rho=lambda R, r: r))
wrong("6.4", "a sphere for a cylinder")(root(three=True))
wrong("6.4", "later steps, too")(root(window=False))
wrong("6.4", "accepts impacts before the start of the step")(root(leaving=False))
wrong("6.4", "never, if it already overlaps")(root(inside=lambda t: NEVER))
wrong("6.4", "forgets t")(root(t_0=0.0))
edit("6.4", "the discrete test at the end of the step", "C / (np.sqrt(D) - B)",
     "1.0 if x_1[1:] @ x_1[1:] <= rho * rho else 2.0")
edit("6.4", "no impact at the end of the step", "s > 1.0", "s >= 1.0")
edit("6.4", "no impact if it touches and leaves", "C <= 0.0", "C < 0.0")
edit("6.4", "a grazing ball misses", "D < 0.0", "D <= 0.0")
edit("6.4", "ignores steps below a micrometre", "B >= 0.0", "A < 1e-12 or B >= 0.0")
edit("6.4", "ignores steps below a nanometre", "B >= 0.0", "A < 1e-18 or B >= 0.0")
edit("6.4", "touches where C is small", "C <= 0.0", "C <= 1e-12")
edit("6.4", "touches where C is tiny", "C <= 0.0", "C <= 1e-15")
edit("6.4", "touches where C is minute", "C <= 0.0", "C <= 1e-22")
edit("6.4", "never, if it is almost there", "s > 1.0", "not 1e-6 < s <= 1.0")
edit("6.4", "rests where B is minute", "B >= 0.0", "B >= -1e-18")
edit("6.4", "arrives a thousand-millionth of a step late", "s > 1.0", "s > 1.0 + 1e-9")


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
wrong("6.5", "starts at p")(foot(begin="p"))
edit("6.5", "treats the segment as an infinite line",
     "np.minimum(1.0, np.maximum(0.0, (p - a) @ along / length_squared))",
     "(p - a) @ along / length_squared")
edit("6.5", "accepts a segment of zero length",
     'raise BadInput("the length of an edge [m]", 0.0, "give two different ends")', "return a")
edit("6.5", "the nearer end", "np.minimum(1.0, np.maximum(0.0, (p - a) @ along / length_squared))",
     "float((p - a) @ (p - a) > (p - b) @ (p - b))")
edit("6.5", "refuses short segments", "length_squared == 0.0", "length_squared < 1e-12")
edit("6.5", "refuses segments along a coordinate axis", "length_squared == 0.0", "np.any(a == b)")
edit("6.5", "refuses less than a nanometre", "length_squared == 0.0", "length_squared < 1e-18")
edit("6.5", "refuses less than an atomic nucleus", "length_squared == 0.0", "length_squared < 1e-30")
edit("6.5", "refuses more than a million megametres", "length_squared == 0.0",
     "length_squared == 0.0 or length_squared > 1e24")
edit("6.5", "never divides by zero", "/ length_squared", "/ (length_squared + 1e-30)")
edit("6.5", "refuses two ends that are nearly equal", "length_squared == 0.0", "np.allclose(a, b, atol=0.0, rtol=1e-9)")
edit("6.5", "takes what is close to an end for the end",
     "np.minimum(1.0, np.maximum(0.0, (p - a) @ along / length_squared))",
     "(lambda s: 0.0 if s < 1e-6 else 1.0 if s > 1.0 - 1e-6 else s)((p - a) @ along / length_squared)")


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
wrong("6.6", "edges only")(face(signs=()))
wrong("6.6", "one side of the face only")(face(signs=(1,)))
wrong("6.6", "two edges only")(face(edges=2))
wrong("6.6", "corners only")(face(measure=lambda a, b: size(a[1:])))
wrong("6.6", "forgets r")(face(thick=False))
wrong("6.6", "a pierced face has a gap of zero")(face(pierced=lambda r, R: 0.0))
edit("6.6", "treats an edge-on triangle as pierced", "np.all(turns > 0.0) or np.all(turns < 0.0)",
     "np.all(turns >= 0.0) or np.all(turns <= 0.0)")
edit("6.6", "three equal signs, zeros as well", "np.all(turns > 0.0) or np.all(turns < 0.0)",
     "np.all(np.sign(turns) == np.sign(turns[0]))")
edit("6.6", "signs with a minute tolerance", "np.all(turns > 0.0) or np.all(turns < 0.0)",
     "np.all(turns > 1e-30) or np.all(turns < -1e-30)")
edit("6.6", "signs with a tolerance", "np.all(turns > 0.0) or np.all(turns < 0.0)",
     "np.all(turns > 1e-12) or np.all(turns < -1e-12)")


# 6.7 ------------------------------------------------------------------------------------------------------------
@variants
def on_triangle(edges=3, inside=True, clamp=True, checked=True, flat=worked.DEGENERATE_AREA, absolute=False):
    def closest_on_triangle(p, a, b, c):
        corners = [a, b, c]
        N = np.cross(b - a, c - a)
        longest = max(size(corners[k] - corners[k - 1]) for k in range(3))
        if checked and size(N) <= flat * (1.0 if absolute else longest**2):
            raise BadInput("a triangle", size(N), "give one with an area")
        q = p - (p - a) @ N / (N @ N) * N
        if inside and all(np.cross(corners[(k + 1) % 3] - corners[k], q - corners[k]) @ N >= 0.0 for k in range(3)):
            return q
        if not clamp:
            return q
        feet = [worked.closest_on_segment(p, corners[k], corners[(k + 1) % 3]) for k in range(edges)]
        return min(feet, key=lambda y: size(y - p))
    return closest_on_triangle


right("6.7", "in a loop")(on_triangle())
wrong("6.7", "edges only")(on_triangle(inside=False))
wrong("6.7", "the plane for the triangle")(on_triangle(clamp=False))
wrong("6.7", "two edges only")(on_triangle(edges=2))
wrong("6.7", "accepts a triangle without area")(on_triangle(checked=False))
FIRST_TWO = "nearer(p, closest_on_segment(p, a, b), closest_on_segment(p, b, c))"
THREE_EDGES = f"nearer(p, {FIRST_TWO}, closest_on_segment(p, c, a))"
OUTSIDE = "closest_on_segment(p, {0}, {1}) if dot(cross({1} - {0}, q - {0}), N) < 0.0 else "
edit("6.7", "refuses small inputs", "DEGENERATE_AREA * longest", "1e-9")
edit("6.7", "an area of 1e-12 m² is none", "DEGENERATE_AREA * longest", "DEGENERATE_AREA")
edit("6.7", "compares with a length", "DEGENERATE_AREA * longest", "DEGENERATE_AREA * np.sqrt(longest)")
LONGEST = "max(dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c))"
edit("6.7", "compares with the first edge only", LONGEST, "dot(b - a, b - a)")
edit("6.7", "compares with the second edge only", LONGEST, "dot(c - b, c - b)")
edit("6.7", "compares with the third edge only", LONGEST, "dot(a - c, a - c)")
edit("6.7", "forgets the edge from b to c", LONGEST, "max(dot(b - a, b - a), dot(a - c, a - c))")
edit("6.7", "compares with the shortest edge", LONGEST, LONGEST.replace("max", "min"))
edit("6.7", "compares with all three edges together", LONGEST, LONGEST.replace("max(", "sum((") + ")")
edit("6.7", "compares with the two edges at a", LONGEST, "np.sqrt(dot(b - a, b - a) * dot(a - c, a - c))")
edit("6.7", "half of |N|", "np.sqrt(dot(N, N)) > DEGENERATE_AREA", "area > DEGENERATE_AREA")
edit("6.7", "ten times too strict", "DEGENERATE_AREA * longest", "1e-11 * longest")
edit("6.7", "ten times too tolerant", "DEGENERATE_AREA * longest", "1e-13 * longest")
edit("6.7", "the square of DEGENERATE_AREA only",
     "np.sqrt(dot(N, N)) > DEGENERATE_AREA * longest", "dot(N, N) > DEGENERATE_AREA**2 * longest")
edit("6.7", "the nearest corner", THREE_EDGES, "nearer(p, nearer(p, a, b), c)")
edit("6.7", "the first edge with p outside", THREE_EDGES,
     OUTSIDE.format("a", "b") + OUTSIDE.format("b", "c") + "closest_on_segment(p, c, a)")
edit("6.7", "the last edge with p outside", THREE_EDGES,
     OUTSIDE.format("c", "a") + OUTSIDE.format("b", "c") + "closest_on_segment(p, a, b)")
edit("6.7", "the first two edges compared from a corner", FIRST_TWO, FIRST_TWO.replace("nearer(p", "nearer(c"))
edit("6.7", "refuses needles: forgets the root of N · N", "np.sqrt(dot(N, N)) > DEGENERATE_AREA * longest",
     "dot(N, N) > DEGENERATE_AREA * longest**2")


# 6.8 ------------------------------------------------------------------------------------------------------------
@variants
def in_box(turn=lambda R, y: R.T @ y, inside=True, pick=np.argmin,
           depth_sign=-1.0, sign=lambda y: 1.0 if y >= 0.0 else -1.0, out=1.0):
    def ball_box(x, r, box):
        y = turn(box.R, x - box.x)
        depth = box.half - np.abs(y)
        if not (inside and np.all(depth >= 0.0)):
            return worked.ball_contact(x, r, box.x + box.R @ np.clip(y, -box.half, box.half), 0.0)
        i = int(pick(depth))
        n = out * sign(y[i]) * box.R[:, i]
        return worked.Contact(x - r * n, x + depth[i] * n, n, depth_sign * depth[i] - r, 0.0)
    return ball_box


right("6.8", "with clip")(in_box())
wrong("6.8", "rotates the wrong way")(in_box(turn=lambda R, y: R @ y))
wrong("6.8", "does not transform the ball into the box's axes")(in_box(turn=lambda R, y: y))
wrong("6.8", "no case for the inside")(in_box(inside=False))
wrong("6.8", "the farthest face")(in_box(pick=np.argmax))
wrong("6.8", "a gap above zero inside")(in_box(depth_sign=1.0))
wrong("6.8", "zero normal at the centre")(in_box(sign=np.sign))
wrong("6.8", "n points inward")(in_box(out=-1.0))
edit("6.8", "treats a point on a face as outside", "depth[i] < 0.0", "depth[i] <= 0.0")
edit("6.8", "the face of the largest coordinate", "np.argmin(depth)", "np.argmax(np.abs(y))")
edit("6.8", "the face of the least share of its half edge", "np.argmin(depth)", "np.argmin(depth / box.half)")
edit("6.8", "sign(0) = -1", "y[i] >= 0.0", "y[i] > 0.0")
edit("6.8", "treats a picometre outside as inside", "depth[i] < 0.0", "depth[i] < -1e-12")
edit("6.8", "treats a minute distance outside as inside", "depth[i] < 0.0", "depth[i] < -1e-20")
edit("6.8", "sign(0) = 1 within a picometre", "y[i] >= 0.0", "y[i] >= -1e-12")


# 6.9 ------------------------------------------------------------------------------------------------------------
@variants
def sweep(f=lambda low, high, move: (low + np.clip(move, None, 0.0), high + np.clip(move, 0.0, None))):
    def swept_box(low, high, move):
        return f(low, high, move)
    return swept_box


right("6.9", "by the parts of the way")(sweep())
wrong("6.9", "only the end position")(sweep(lambda low, high, move: (low + move, high + move)))
wrong("6.9", "only forwards")(sweep(lambda low, high, move: (low, high + move)))
wrong("6.9", "larger on every side")(sweep(lambda low, high, move: (low - np.abs(move), high + np.abs(move))))
edit("6.9", "all coordinates by the largest move", "np.maximum(high, high + move)", "high + max(0.0, np.max(move))")
edit("6.9", "a picometre is no move", "return", "move = np.where(np.abs(move) < 1e-12, 0.0, move); return")
wrong("6.9", "does not sweep")(sweep(lambda low, high, move: (low, high)))


# 6.10 -----------------------------------------------------------------------------------------------------------
@variants
def brute(strict=False, first=lambda i: i + 1, turned=False, some=lambda low: low):
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
wrong("6.10", "a common face does not count")(brute(strict=True))
wrong("6.10", "pairs each box with itself")(brute(first=lambda i: i))
wrong("6.10", "returns each pair twice")(brute(first=lambda i: 0))
wrong("6.10", "the larger number first")(brute(turned=True))
edit("6.10", "neighbours in the list only", "range(i + 1, len(low))", "range(i + 1, min(i + 2, len(low)))")
edit("6.10", "accepts invalid boxes", "check_boxes(low, high)", "pass")
edit("6.10", "accepts boxes that are slightly inside out", "check_boxes(low, high)", "check_boxes(low, high + 1e-9)")
edit("6.10", "accepts lower corners at NaN", "check_boxes(low, high)",
     "check_boxes(np.where(np.isnan(low), high, low), high)")
edit("6.10", "accepts infinite corners", "check_boxes(low, high)",
     "check_boxes(np.maximum(low, -1e300), np.minimum(high, 1e300))")
edit("6.10", "does not test the last two", "range(len(low))", "range(len(low) - 2)")
edit("6.10", "touch up to a femtometre apart", "boxes_touch(low, high, i, low, high, j)",
     "boxes_touch(low - 5e-16, high + 5e-16, i, low - 5e-16, high + 5e-16, j)")
edit("6.10", "touch up to a nanometre apart", "boxes_touch(low, high, i, low, high, j)",
     "boxes_touch(low - 5e-10, high + 5e-10, i, low - 5e-10, high + 5e-10, j)")
edit("6.10", "checks its boxes after the search", "check_boxes(low, high)",
     "check_boxes(low[:len(high)], high)")


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
    for k in range(a.first[i], a.first[i] + a.count[i]):
        for m in range(b.first[j], b.first[j] + b.count[j]):
            found.append((a.order[k], b.order[m]))


right("6.11", "as a recursion")(traversal())
wrong("6.11", "never prunes")(traversal(prune=False))
wrong("6.11", "forgets the second child")(traversal(second=False))
wrong("6.11", "all items of leaves that touch")(traversal(leaves=every_item))
wrong("6.11", "b before a")(traversal(turned=True))
wrong("6.11", "gives up where b's node is bigger")(traversal(both=False))
edit("6.11", "each pair of a tree's own nodes once", "if boxes_touch(", "if not (a is b and i > j) and boxes_touch(")
edit("6.11", "a thousand pairs of nodes at most", "while len(waiting) > 0",
     "for _ in (k for k in range(1000) if waiting)")
edit("6.11", "ten thousand pairs of nodes at most", "while len(waiting) > 0",
     "for _ in (k for k in range(10000) if waiting)")


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
wrong("6.12", "the farthest corner")(edges(inner=max))
wrong("6.12", "the worst edge")(edges(outer=min))
wrong("6.12", "normals that point inward")(edges(sign=-1.0))
wrong("6.12", "the middle of b for its corners")(edges(centre=True))
wrong("6.12", "accepts an edge of zero length")(edges(checked=False))
wrong("6.12", "the edges of b")(edges(of=lambda a, b: (b, a)))
edit("6.12", "the edge whose gap is nearest to zero", "not gap <= greatest", "abs(gap) < abs(greatest)")
edit("6.12", "the first edge that separates", "not gap <= greatest", "greatest <= 0.0 and gap > greatest")
edit("6.12", "the last edge that separates", "not gap <= greatest", "gap > min(greatest, 0.0)")
edit("6.12", "seven edges at most", "range(len(a))", "range(min(len(a), 7))")
edit("6.12", "forgets the first corner of b", "range(len(b))", "range(1, len(b))")
edit("6.12", "every edge begins at the first corner", "b[j] - a[i]", "b[j] - a[0]")
edit("6.12", "a later edge must be better by a picometre", "not gap <= greatest", "not gap <= greatest + 1e-12")
edit("6.12", "touch within a picometre", "return greatest, edge",
     "return (0.0 if abs(greatest) < 1e-12 else greatest), edge")
edit("6.12", "the least begins with a million gigametres", "outward(a, i), np.inf", "outward(a, i), 1e15")
edit("6.12", "the least begins with a gigametre", "outward(a, i), np.inf", "outward(a, i), 1e9")
edit("6.12", "the greatest begins with a megametre below zero", "-np.inf", "-1e6")


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
wrong("6.13", "keeps the other side")(cut(side=-1.0))
wrong("6.13", "cuts in the middle of an edge")(cut(crossing=lambda s_i, s_j: 0.5))
wrong("6.13", "the crossing from the other end")(cut(crossing=lambda s_i, s_j: s_j / (s_j - s_i)))
wrong("6.13", "there and back along a segment")(cut(back=True))
wrong("6.13", "only removes corners")(cut(add=False))
wrong("6.13", "drops corners on the plane")(cut(kept_at=lambda s: s < 0.0))
wrong("6.13", "counts corners on the plane twice")(cut(crosses=lambda a, b: a * b <= 0.0 and a != b))
wrong("6.13", "forgets d")(cut(offset=0.0))
edit("6.13", "keeps corners a nanometre outside", "s_i <= 0.0", "s_i <= 1e-9")
edit("6.13", "keeps corners a femtometre outside", "s_i <= 0.0", "s_i <= 1e-15")
edit("6.13", "keeps corners a minute distance outside", "s_i <= 0.0", "s_i <= 1e-20")
edit("6.13", "no crossing where the product is minute", "s_i * s_j < 0.0", "s_i * s_j < -1e-30")
edit("6.13", "adds a crossing only where it goes out", "s_i * s_j < 0.0", "s_i < 0.0 < s_j")
edit("6.13", "segments in a plane only", "k > 2", "y.shape != (2, 2)")
edit("6.13", "fails for an empty polygon", "kept[:m].copy()",
     "kept[:m].copy() if (y @ n - d).max() > 0.0 else y.copy()")
edit("6.13", "room for 8 corners", "2 * len(y)", "8")
edit("6.13", "room for 10 corners", "2 * len(y)", "10")
edit("6.13", "room for 16 corners", "2 * len(y)", "16")
edit("6.13", "room for 20 corners", "2 * len(y)", "20")


# 6.14 -----------------------------------------------------------------------------------------------------------
@variants
def boxes(axes=range(15), room=worked.EDGE_PREFERENCE, sign=1.0, width=worked.half_width, choose=lambda new,
          old: new > old, fixed=False):
    def box_separation(a, b):
        r, best = a.x - b.x, None
        for k in axes:
            n = worked.candidate_axis(a, b, k)
            if not np.any(n):
                continue
            gap = abs(float(r @ n)) - width(a, n) - width(b, n)
            if best is None or choose(gap, best[0] + (room if k >= 6 else 0.0)):
                best = gap, n, k
        gap, n, k = best
        return gap, n if fixed else (sign if n @ r >= 0.0 else -sign) * n, k
    return box_separation


right("6.14", "with a tuple")(boxes())
wrong("6.14", "the axes of a only")(boxes(axes=range(3)))
wrong("6.14", "faces only")(boxes(axes=range(6)))
wrong("6.14", "returns a normal that points from a to b")(boxes(sign=-1.0))
wrong("6.14", "does not orient the axis")(boxes(fixed=True))
wrong("6.14", "the last of equal ones")(boxes(choose=lambda new, old: new >= old))
edit("6.14", "accepts zero axes", "dot(axis, axis) > 0.0", "dot(axis, axis) >= 0.0")
edit("6.14", "edges need no advantage", "EDGE_PREFERENCE if k >= 6", "0.0 if k >= 6")
edit("6.14", "edges win by a twentieth", "EDGE_PREFERENCE if k >= 6", "0.05 * abs(greatest) if k >= 6")
edit("6.14", "edges win by a micrometre", "EDGE_PREFERENCE if k >= 6", "1e-6 if k >= 6")
edit("6.14", "edges win by a picometre", "EDGE_PREFERENCE if k >= 6", "1e-12 if k >= 6")
edit("6.14", "edges win by a part of the gap", "EDGE_PREFERENCE if k >= 6", "1e-9 * abs(greatest) if k >= 6")
edit("6.14", "edges need no advantage over edges",
     "EDGE_PREFERENCE if k >= 6", "EDGE_PREFERENCE if k >= 6 and number < 6")
edit("6.14", "forgets the last axis", "range(15)", "range(14)")
edit("6.14", "the first axis that separates", "not gap <= greatest +", "greatest <= 0.0 and gap > greatest +")
edit("6.14", "edges only where no face separates",
     "not gap <= greatest +", "(k < 6 or greatest < 0.0) and gap > greatest +")
edit("6.14", "the axis whose gap is nearest to zero", "not gap <= greatest +", "abs(gap) < abs(greatest) +")
wrong("6.14", "the least gap")(boxes(choose=lambda new, old: new < old))
wrong("6.14", "the longest half edge for the width")(boxes(width=lambda box, n: float(np.max(box.half))))
edit("6.14", "the greatest begins with a megametre below zero", "-np.inf", "-1e6")
edit("6.14", "faces need an advantage, too", "EDGE_PREFERENCE if k >= 6 else 0.0", "EDGE_PREFERENCE")


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
wrong("6.15", "gives up after five steps")(nearest(steps=5))
wrong("6.15", "the supports exchanged")(nearest(along=(1.0, -1.0)))
wrong("6.15", "both along the same direction")(nearest(along=(-1.0, -1.0)))
wrong("6.15", "keeps a single pair")(nearest(reduce=False))
wrong("6.15", "n from a to b")(nearest(swap=True))
edit("6.15", "checks nothing", "check_hulls(a, b)", "pass")
edit("6.15", "checks a only", "check_hulls(a, b)", "check_hulls(a, a)")
edit("6.15", "checks b only", "check_hulls(a, b)", "check_hulls(b, b)")
edit("6.15", "a corner of each for the points between them", "weights @ p, 0.0, weights @ q, 0.0",
     "p[0], 0.0, q[0], 0.0")
edit("6.15", "gives up after eight steps", "range(MAX_GJK_STEPS)", "range(8)")
edit("6.15", "gives up after twelve steps", "range(MAX_GJK_STEPS)", "range(12)")
edit("6.15", "gives up after twenty steps", "range(MAX_GJK_STEPS)", "range(20)")
edit("6.15", "overlap below a femtometre", "if far_enough(", "if v @ v < 1e-30 or far_enough(")
edit("6.15", "stops where little can be gained", "if far_enough(v, a[i] - b[j])",
     "if v @ v - v @ (a[i] - b[j]) < 1e-26")
edit("6.15", "overlap below a nanometre", "if far_enough(", "if v @ v < 1e-18 or far_enough(")


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
wrong("6.16", "one power too few")(field(strength=lambda g, reach: (1.0 / g - 1.0 / reach) / g))
wrong("6.16", "from the centre on")(field(skin=False))
wrong("6.16", "goes on beyond its reach")(field(ends=False))
wrong("6.16", "accepts a position inside")(field(checked=False))
wrong("6.16", "the offset itself for its direction")(field(unit=False))
edit("6.16", "accepts a position on the surface", "not g > 0.0", "g < 0.0")
edit("6.16", "refuses gaps below a micrometre", "not g > 0.0", "g < 1e-6")
edit("6.16", "refuses minute gaps", "not g > 0.0", "not g > 1e-20")
edit("6.16", "no more than a million m/s²", "k * (1.0 / g - 1.0 / reach) / (g * g * distance)",
     "min(k * (1.0 / g - 1.0 / reach) / (g * g), 1e6) / distance")
edit("6.16", "no gap below a millimetre", "g = distance - radius",
     "g = max(distance - radius, 1e-3 * (distance > radius))")
edit("6.16", "measures its reach from the centre", "g >= reach", "distance >= reach")


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
wrong("6.17", "half as much")(swerve(half=1.0))
wrong("6.17", "divides by τ once")(swerve(power=1))
wrong("6.17", "avoids an obstacle behind")(swerve(behind=False))
wrong("6.17", "no limit of time ahead")(swerve(window=False))
wrong("6.17", "avoids an obstacle that is aside")(swerve(wide=False))
wrong("6.17", "head on to the right")(swerve(left=-1.0))
wrong("6.17", "does nothing head on")(swerve(left=0.0))
wrong("6.17", "accelerates from rest")(swerve(rest=False))
edit("6.17", "steers when exactly beside the centre", "tau <= 0.0", "tau < 0.0")
edit("6.17", "steers at the end of the time ahead", "tau >= ahead", "tau > ahead")
edit("6.17", "does nothing near the middle of the disc", "offset >= radius",
     "offset >= radius or r @ r < 0.05 * radius**2")
wrong("6.17", "avoids by the whole radius")(swerve(need=lambda radius, offset: radius))
edit("6.17", "too late for the last hundredth of a second", "tau <= 0.0", "tau <= 1e-2")
edit("6.17", "too late for the last hundred microseconds", "tau <= 0.0", "tau <= 1e-4")
edit("6.17", "at rest below a nanometre per second", "speed == 0.0", "speed < 1e-9")
edit("6.17", "head-on within a minute distance", "offset > 0.0", "offset > 1e-19")
edit("6.17", "four seconds ahead, whatever is asked", "tau >= ahead", "tau >= 4.0")
edit("6.17", "at most ten seconds ahead", "tau >= ahead", "tau >= min(ahead, 10.0)")
edit("6.17", "brakes as well as steering sideways", "tau**2 * aside", "tau**2 * aside - 0.1 * v")
edit("6.17", "at rest where v[0] is zero", "speed == 0.0", "v[0] == 0.0")
edit("6.17", "at rest below a millimetre per second", "speed == 0.0", "speed < 1e-3")
edit("6.17", "left along x only", "np.array([-e[1], e[0]])", "np.array([0.0, e[0]])")
edit("6.17", "head-on within a hundredth of the radius", "offset > 0.0", "offset >= 0.01 * radius")
edit("6.17", "head-on within a micrometre", "offset > 0.0", "offset >= 1e-6")
edit("6.17", "head-on where it is close to zero", "offset > 0.0", "not np.isclose(offset, 0.0)")
edit("6.17", "ignores a disc that it is inside", "offset >= radius", "offset >= radius or np.sqrt(r @ r) <= radius")
