"""Lesson 6.  Collisions: which bodies touch, when and where.

Symbols: x (d,) centre, p (d,) any point [m] · r, R [m] radii · n (d,) unit normal, from b to a · gap [m],
negative where two bodies overlap · E(p) [m] signed distance from a plane · low, high (n, d) [m] corners of n
boxes along the axes · t, dt [s].

*Detection* finds which bodies touch, where and when.  It is pure geometry, and all of this lesson but its end.
*Avoidance* acts before contact; it needs detection with a large reach, and forces.
*Response* changes velocities after contact: lesson 7.
*Left out:* bodies that rotate during the step, and non-convex shapes (divide them into convex parts).
"""

from typing import NamedTuple

import numpy as np

from solutions.checks import (
    UNIT,
    BadInput,
    WrongShape,
    check_array,
    check_field,
    check_normal,
    check_positive,
    check_shape,
    checked_run,
    finite_array,
    finite_number,
    positive_number,
)
from solutions.support.geometry import (
    PARALLEL,
    box_corners,
    box_edge,
    box_face,
    candidate_axis,
    column,
    half_width,
    incident_edge,
    outward,
)
from solutions.support.simplices import GJK_RELATIVE_GAP, check_hulls, far_enough, nearest_subsimplex, support
from solutions.support.trees import (
    Tree,
    as_pairs,
    boxes_touch,
    build_tree,
    check_boxes,
    fit_node_box,
    half_perimeter,
    partition_at_median,
    touching_items,
)
from solutions.vectors import cross, dot

__all__ = [
    "DEGENERATE_AREA", "EDGE_PREFERENCE", "GJK_RELATIVE_GAP", "MAX_GJK_STEPS", "NEVER", "Box",
    "Contact", "Contacts", "Flock", "Plane", "Target", "Tree", "advance_projectiles", "all_pairs",
    "ball_box", "ball_capsule", "ball_contact", "ball_cylinder_gap", "ball_cylinder_time",
    "ball_plane", "ball_plane_gap", "ball_plane_time", "ball_triangle", "box_box", "box_corners",
    "box_separation", "boxes_touch", "build_tree", "candidate_axis", "capsule_capsule",
    "check_boxes", "check_hulls", "clip", "closest_on_segment", "closest_on_triangle", "column",
    "continuous_step", "cylinder_contact", "cylinder_hit", "cylinder_impact_time", "discrete_step",
    "edge_axis_distance", "far_enough", "find_intersections", "fit_node_box", "flock_acceleration",
    "gjk", "half_perimeter", "half_width", "make_box", "make_flock", "make_plane", "nearer",
    "nearest_subsimplex", "outward", "partition_at_median", "plane_distance", "plane_impact_time",
    "points_plane", "polygon_contacts", "repulsion", "separating_edge", "steer", "support",
    "swept_box", "touching_items", "tree_pairs", "triangle_cylinder_gap",
]

NEVER = np.inf               # time of an event that does not occur in this step [s]
DEGENERATE_AREA = 1e-12      # area over longest edge squared below which a triangle's normal is round-off [-]
MAX_GJK_STEPS = 100          # at most [-]; ordinary pairs need below 20, ellipsoids of 1 : 300 sometimes all of them
EDGE_PREFERENCE = 1e-9       # how much better than faces a pair of edges must separate [m]; prevents alternation


class Contact(NamedTuple):
    """The result of detection: where two bodies touch, or are nearest.  The lecture writes p₁, p₂, n and t*."""
    p_a: np.ndarray          # (d,) the point on a [m]
    p_b: np.ndarray          # (d,) the point on b [m]
    n: np.ndarray            # (d,) unit normal, from b to a
    gap: float               # (p_a − p_b) · n [m]: negative where they overlap
    t: float                 # time of contact [s]; NEVER where they do not meet


class Contacts(NamedTuple):
    """The same for an area of contact, represented by k of its points with a common normal."""
    p_a: np.ndarray          # (k, d) [m]
    p_b: np.ndarray          # (k, d) [m]
    n: np.ndarray            # (d,)
    gap: np.ndarray          # (k,) [m]


class Plane(NamedTuple):
    """All p with n · p + d = 0; the free side is the one to which n points."""
    n: np.ndarray            # (3,) or (2,) unit normal
    d: float                 # [m]


class Box(NamedTuple):
    """A box in 3D."""
    x: np.ndarray            # (3,) centre [m]
    R: np.ndarray            # (3, 3) its axes, as columns
    half: np.ndarray         # (3,) half of its edges [m]


class Target(NamedTuple):
    """The target of a ball: a plane, or the cylinder about the x axis."""
    r: float                 # radius of the ball [m]
    R: float                 # radius of the cylinder [m]
    plane: Plane


class Flock(NamedTuple):
    """Parameters of a flock."""
    radius: float            # of each member [m]
    reach: float             # gap within which members react to each other [m]
    k: float                 # strength of the repulsion [m⁴/s²]
    align: float             # rate of adapting to the velocity of members in reach [1/s]
    gather: float            # strength of the pull to the middle of the flock [1/s²]


# ---------------------------------------------------------------------------------------------- points and planes

def make_plane(coefficients):
    """Given.  Make the Plane of a x + b y + c z + d = 0 from (a, b, c, d), or in 2D (a, b, d), of any length.

    Raises BadInput where all but d are zero, and for values that are not finite.
    """
    y = finite_array("a coefficient of a plane", coefficients)
    if y.shape not in ((3,), (4,)):
        raise WrongShape("the coefficients of a plane", y.shape, "(4,), or (3,) in 2D")
    length = np.sqrt(y[:-1] @ y[:-1])
    if length == 0.0:
        raise BadInput("the normal of a plane", 0.0, "give one of a, b, c another value than zero")
    return Plane(y[:-1] / length, float(y[-1] / length))


def plane_distance(p, plane):
    """Return the signed distance [m] of p (d,) from a plane; negative on the wrong side: the discrete test.

    E(p) = a x + b y + c z + d = n · p + d

    *Source:* first lecture deck, “Detect collision: point–plane”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.1: plane_distance")


def plane_impact_time(t, dt, x_0, x_1, r, plane):
    """Return the time [s] at which a ball of radius r touches a plane: the continuous test.

    The ball moves straight from x_0 at t to x_1 at t + dt.  r = 0: a point.
    t* = t + dt d₁/(d₁ + d₂)         d₁ = E(x_0) − r above the plane before,   d₂ = r − E(x_1) below it after

    t where it already touches (d₁ ≤ 0), NEVER where it does not reach the plane (d₂ < 0).
    *Source:* first lecture deck, “Time of impact”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.2: plane_impact_time")


def normal_or_axis(r):
    """Given.  Return r/|r|, or the last axis where r is zero: there every direction is equally good."""
    length = np.sqrt(r @ r)
    if length != 0.0:
        return r / length
    n = 0.0 * r
    n[-1] = 1.0
    return n


def ball_contact(x_a, r_a, x_b, r_b):
    """Given.  Return the Contact of two balls; with r_b = 0 of a ball and a point.  Most round shapes reduce to this.

    n = (x_a − x_b)/|x_a − x_b|,   gap = |x_a − x_b| − r_a − r_b,   p_a = x_a − r_a n,   p_b = x_b + r_b n
    """
    r = x_a - x_b
    n = normal_or_axis(r)
    return Contact(x_a - r_a * n, x_b + r_b * n, n, np.sqrt(r @ r) - r_a - r_b, 0.0)


def ball_plane(x, r, plane):
    """Given.  Return the Contact of a ball (a) and a plane (b)."""
    distance = plane_distance(x, plane)
    return Contact(x - r * plane.n, x - distance * plane.n, plane.n, distance - r, 0.0)


# ------------------------------------------------------------------------------------------ a cylinder along the x axis

def cylinder_contact(x, r, R):
    """Return the Contact of a ball (a) at x (3,) and the infinite cylinder (b) about the x axis: the discrete test.

    r is the radius of the ball, R that of the cylinder.  The nearest point of the axis is q = (x₀, 0, 0), so
    this is the ball_contact of a ball of radius r at x and a ball of radius R at q.
    *Source:* second lecture deck, the worked question, part 1.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.3: cylinder_contact")


def cylinder_impact_time(t, dt, x_0, x_1, r, R):
    """Return the time [s] at which a ball first touches that cylinder: the continuous test.

    The ball moves straight from x_0 (3,) at t to x_1 at t + dt.
    With y the coordinates (1, 2) of x_0, w those of x_1 − x_0 and ρ = R + r:  |y + s w|² = ρ² is  A s² + 2 B s + C = 0,
    A = w · w,   B = y · w,   C = y · y − ρ²,   D = B² − A C = A ρ² − (y₀ w₁ − y₁ w₀)²
    first root  s = C/(−B + √D),   t* = t + s dt

    Use the last form of D, because B² − A C cancels if a fast ball barely grazes the cylinder.  Use this form of s,
    because (−B − √D)/A cancels more.  If the ball is already close, C cancels in any form: the share s is then known to
    the round-off of |y| over the gap.

    t where it already touches (C ≤ 0); NEVER where it does not approach (B ≥ 0), misses (D < 0) or comes later (s > 1).
    *Source:* second lecture deck, the worked question, part 2.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.4: cylinder_impact_time")


def cylinder_hit(t, dt, x_0, x_1, r, R):
    """Given.  Return the Contact at the time of impact; without impact that at the end of the step, with t = NEVER."""
    moment = cylinder_impact_time(t, dt, x_0, x_1, r, R)
    s = (moment - t) / dt if moment < NEVER else 1.0
    c = cylinder_contact(x_0 + s * (x_1 - x_0), r, R)
    return Contact(c.p_a, c.p_b, c.n, c.gap, moment)


def ball_plane_gap(x, p):
    """Given.  Return the gap [m] between a ball at x (3,) and the plane of a Target."""
    return plane_distance(x, p.plane) - p.r


def ball_plane_time(t, dt, x_0, x_1, p):
    """Given.  Return the plane_impact_time [s] of a Target."""
    return plane_impact_time(t, dt, x_0, x_1, p.r, p.plane)


def ball_cylinder_gap(x, p):
    """Given.  Return the gap [m] between a ball at x (3,) and the cylinder of a Target."""
    return cylinder_contact(x, p.r, p.R).gap


def ball_cylinder_time(t, dt, x_0, x_1, p):
    """Given.  Return the cylinder_impact_time [s] of a Target."""
    return cylinder_impact_time(t, dt, x_0, x_1, p.r, p.R)


def discrete_step(gap, impact_time, t, x, v, dt, p):
    """Given.  Advance a ball by dt and stop it if it then overlaps the target; return (x, v).

    Tested only at the end of a step, it can penetrate by up to |v| dt or pass through.
    """
    x = x + dt * v
    return x, 0.0 * v if gap(x, p) < 0.0 else v


def continuous_step(gap, impact_time, t, x, v, dt, p):
    """Given.  Advance a ball by dt, but stop it at the point of contact, however long the step is; return (x, v)."""
    moment = impact_time(t, dt, x, x + dt * v, p)
    if moment < NEVER:
        return x + (moment - t) * v, 0.0 * v
    return x + dt * v, v


def advance_projectiles(step, gap, impact_time, t, x, v, dt, steps, p):
    """Given.  Return (x, v), each (n, 3), of n balls that fly straight, with one test per step, and stop at contact.

    Raises BadInput for a step that is not positive, and a state that is not finite.
    """
    t, x, v, dt, steps = checked_run(t, x, v, dt, steps)
    check_array("position x [m]", x, 2)
    x, v = x.copy(), v.copy()
    for k in range(len(x)):
        finite_number("gap at the start [m]", gap(x[k], p))
        for n in range(steps):
            if v[k] @ v[k] > 0.0:
                x[k], v[k] = step(gap, impact_time, t + n * dt, x[k], v[k], dt, p)
    return x, v


def closest_on_segment(p, a, b):
    """Return the point (d,) of the segment from a to b (d,) that is nearest to p (d,).

    a + s (b − a),     s = (p − a) · (b − a)/|b − a|²,  limited to 0 ≤ s ≤ 1

    Raises BadInput for a segment of zero length.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.5: closest_on_segment")


def edge_axis_distance(a, b):
    """Given.  Return the distance [m] of an edge of a cloth, from a to b (3,), from the x axis."""
    y_a, y_b = a[1:], b[1:]
    if y_a[0] == y_b[0] and y_a[1] == y_b[1]:                        # parallel to the axis: a point in this view
        return np.sqrt(y_a @ y_a)
    q = closest_on_segment(0.0 * y_a, y_a, y_b)
    return np.sqrt(q @ q)


def triangle_cylinder_gap(a, b, c, r, R):
    """Return the gap [m] between a triangle of a cloth and the cylinder of cylinder_contact.

    a, b, c (3,) are the corners, r is half the thickness of the cloth.  Seen along the x axis the cylinder is a
    disc about 0.  Where the projected triangle contains 0, the axis passes through the face:
        gap = −R − r                              y_i z_j − z_i y_j  over (a, b), (b, c), (c, a) are all > 0 or all < 0
    elsewhere the nearest point is on an edge:
        gap = least edge_axis_distance − R − r    of the three edges

    All corners can be far outside while an edge or the face is not: testing the particles of a cloth is not enough.
    *Source:* second lecture deck, the worked question, part 3.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.6: triangle_cylinder_gap")


# ------------------------------------------------------------------------------------------- narrow phase: round shapes

def nearer(p, q, other):
    """Given.  Return q or other (d,), whichever is nearer to p (d,)."""
    return q if (q - p) @ (q - p) <= (other - p) @ (other - p) else other


def closest_on_triangle(p, a, b, c):
    """Return the point (3,) of the triangle a b c that is nearest to p (3,).

    N = (b − a) × (c − a),    q = p − ((p − a) · N/N · N) N         the projection of p on the triangle's plane
    q where it is inside: ((b − a) × (q − a)) · N ≥ 0, and the same for b, c and for c, a;
    elsewhere the nearest of the closest_on_segment of the three edges, see nearer

    Raises BadInput for a triangle without area: |N| ≤ DEGENERATE_AREA times its longest edge squared.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.7: closest_on_triangle")


def ball_triangle(x, r, a, b, c):
    """Given.  Return the Contact of a ball (a) and a triangle (b)."""
    return ball_contact(x, r, closest_on_triangle(x, a, b, c), 0.0)


def nearer_pair(p, q, other_p, other_q):
    """Given.  Return (p, q) or (other_p, other_q), whichever points are nearer to each other."""
    if (q - p) @ (q - p) <= (other_q - other_p) @ (other_q - other_p):
        return p, q
    return other_p, other_q


def closest_segments(a, b, c, d):
    """Given.  Return (p, q): the points of the segments a b and c d that are nearest to each other.

    Either one of them is an end, or both are inside: there |a + s u − c − t w|² is least (u = b − a, w = d − c).
    *Source:* Lumelsky 1985.
    """
    p, q = nearer_pair(a, closest_on_segment(a, c, d), b, closest_on_segment(b, c, d))
    p, q = nearer_pair(p, q, closest_on_segment(c, a, b), c)
    p, q = nearer_pair(p, q, closest_on_segment(d, a, b), d)
    u, w, r = b - a, d - c, a - c
    uu, ww, uw = u @ u, w @ w, u @ w
    D = uu * ww - uw**2
    if D > PARALLEL * uu * ww:
        s = (uw * (r @ w) - ww * (r @ u)) / D
        t = (uu * (r @ w) - uw * (r @ u)) / D
        if 0.0 <= s <= 1.0 and 0.0 <= t <= 1.0:
            p, q = nearer_pair(p, q, a + s * u, c + t * w)
    return p, q


def capsule_capsule(a, b, r_a, c, d, r_b):
    """Given.  Return the Contact of two capsules: about the segments a b and c d, with radii r_a and r_b."""
    p, q = closest_segments(a, b, c, d)
    return ball_contact(p, r_a, q, r_b)


def ball_capsule(x, r, a, b, r_b):
    """Given.  Return the Contact of a ball (a) and a capsule (b) of radius r_b about the segment from a to b."""
    return ball_contact(x, r, closest_on_segment(x, a, b), r_b)


def ball_box(x, r, box):
    """Return the Contact of a ball (a) of radius r at x (3,) and a Box (b), even where the ball's centre is inside.

    y = Rᵀ (x − x_box);   outside: the ball_contact with the point x_box + R q of radius 0, q_i = y_i limited to ±half_i
    inside or on a face (|y_i| ≤ half_i for all i): leave through the nearest face, along the axis i of the least depth
    half_i − |y_i|:
        n = sign(y_i) times that axis, sign(0) = 1;   gap = −depth − r,   p_a = x − r n,   p_b = x + depth n

    column(box.R, i) is axis i.
    *Source:* Ericson 2005, section 5.1.3.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.8: ball_box")


def points_plane(x, plane):
    """Given.  Return the Contacts of a body with corners x (k, d) (a) and a plane (b): all corners not above it."""
    m = 0
    p_a, gap = np.zeros(x.shape), np.zeros(len(x))
    for i in range(len(x)):
        distance = plane_distance(x[i], plane)
        if distance <= 0.0:
            p_a[m], gap[m] = x[i], distance
            m += 1
    p_b = np.zeros((m, x.shape[1]))
    for i in range(m):
        p_b[i] = p_a[i] - gap[i] * plane.n
    return Contacts(p_a[:m], p_b, plane.n, gap[:m])


# ---------------------------------------------------------------------------------------------- broad phase

def swept_box(low, high, move):
    """Return (low, high), each (d,): the box around the path of a box low, high (d,) that moves by move (d,) [m].

    Each face of it is at the outermost of the first and last position of that face.  If nothing touches it, the body
    hits nothing.
    *Source:* first lecture deck, “Swept volumes”.
    *Left out:* the swept volume itself is smaller than the box around it.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.9: swept_box")


def all_pairs(low, high):
    """Return (m, 2): the numbers i < j of all boxes low, high (n, d) that touch, each pair once, by testing every pair.

    These are n (n − 1)/2 tests with boxes_touch: ten times as many boxes take a hundred times as long.
    Begin with the empty list  found = [(0, 0) for _ in range(0)],  from which the compiler infers its type.
    Append pairs, and return as_pairs(found).
    Raises what check_boxes raises; call it first.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.10: all_pairs")


def find_intersections(a, b):
    """Return (m, 2): the pairs (item of a, item of b) whose boxes touch, each once, by a joint descent of two Trees.

    FindIntersections(i, j), first of (0, 0), does nothing unless the boxes of node i of a and node j of b touch
    (boxes_touch).  If they do:
        neither is a leaf      FindIntersections of each child of the larger node with the other one; the larger is the
                               one with the greater half_perimeter, i if these are equal
        one is a leaf          FindIntersections of each child of the other one with the leaf
        both are leaves        test the pairs of their items: touching_items(a, i, b, j, found)

    Keep a list of the pairs (i, j) still to visit, at first [(0, 0)], and one of found pairs as in all_pairs; return
    as_pairs(found).  Node i is a leaf if a.child[i] = 0.  Otherwise its children are a.child[i] and a.child[i] + 1.
    If your loop never ends, it has taken the child 0 of a leaf for a node, which is the root.
    *Source:* second lecture deck, “FindIntersections(node₁, node₂)”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.11: find_intersections")


def tree_pairs(low, high):
    """Given.  Return the pairs of all_pairs, in another order, by a tree tested against itself.

    That test finds (i, j), (j, i) and all (i, i); only i < j is kept.
    """
    tree = build_tree(low, high)
    pairs = find_intersections(tree, tree)
    m = 0
    for k in range(len(pairs)):
        if pairs[k, 0] < pairs[k, 1]:
            pairs[m] = pairs[k]
            m += 1
    return pairs[:m].copy()


# ---------------------------------------------------------------------------------------- narrow phase: separating axes

def separating_edge(a, b):
    """Return (gap [m], i): the edge i of the convex polygon a (k, 2) that separates it best from b (m, 2), and its gap.

    gap of edge i:  the least  n_i · (b_j − a_i)  of all corners j of b,  n_i = outward(a, i).    Return the greatest

    A positive gap: a line along this edge separates the polygons.  If the gaps of both polygons are negative, they
    overlap, and the greater gap is the shortest way out.
    Corners are counter-clockwise.
    *Source:* the separating axis theorem; Gottschalk, Lin and Manocha 1996.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.12: separating_edge")


def clip(y, n, d):
    """Return the part with n · p ≤ d of a convex polygon, or of a segment, with corners y (k, 2) or (k, 3).

    For each corner i in order: keep it if s_i = n · y_i − d ≤ 0.  Then, if s_i and s_j of the next corner j differ in
    sign (s_i s_j < 0), add
        y_i + s_i/(s_i − s_j) (y_j − y_i)
    A segment (k = 2) has only one edge: there is no crossing from its second corner back to its first.  If nothing is
    left, return an array without rows.  y itself may have no row, or one: it can be the result of another cut.
    *Source:* Sutherland and Hodgman 1974.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.13: clip")


def against_face(y, n, p, flipped):
    """Given.  Return the Contacts of the corners y (k, d) not beyond a face through p with outward normal n (d,).

    The face belongs to a, and y to b; flipped: the other way round.
    """
    m = 0
    on_y, on_face, gap = np.zeros(y.shape), np.zeros(y.shape), np.zeros(len(y))
    for i in range(len(y)):
        s = n @ (y[i] - p)
        if s <= 0.0:
            on_y[m], on_face[m], gap[m] = y[i], y[i] - s * n, s
            m += 1
    on_y, on_face, gap = on_y[:m].copy(), on_face[:m].copy(), gap[:m].copy()
    return Contacts(on_y, on_face, n, gap) if flipped else Contacts(on_face, on_y, -n, gap)


def polygon_contacts(a, b):
    """Given.  Return the Contacts of two convex polygons, counter-clockwise; none where they are apart.

    The edge that separates best is the reference.  The edge of the other polygon that faces it most is clipped to its
    width.  The ends of that edge behind the reference are the contact points.  Edge on edge therefore gives two points:
    the point–point contact of the lecture.
    *Source:* first lecture deck, “Edge/edge collisions are modeled as point/point”; Catto 2006 for the clipping.
    """
    for thing, corners in (("the corners of polygon a [m]", a), ("the corners of polygon b [m]", b)):
        check_field(thing, corners, (len(corners), 2))
    gap_a, i = separating_edge(a, b)
    gap_b, j = separating_edge(b, a)
    if max(gap_a, gap_b) > 0.0:
        return Contacts(np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(2), np.zeros(0))
    flipped = gap_b > gap_a
    face, other, edge = (b, a, j) if flipped else (a, b, i)
    n, p, q = outward(face, edge), face[edge], face[(edge + 1) % len(face)]
    t = np.array([-n[1], n[0]])                                      # from p to q: counter-clockwise
    y = clip(clip(incident_edge(other, n), t, t @ q), -t, -(t @ p))
    return against_face(y, n, p, flipped)


def make_box(x, R, half):
    """Given.  Make a Box; raises BadInput unless half is positive and the axes, columns of R (3, 3), orthonormal."""
    x = finite_array("centre of a box [m]", x)
    R = finite_array("axes R of a box [-]", R)
    half = finite_array("half edges of a box [m]", half)
    check_shape("the centre of a box", x, (3,))
    check_shape("the axes R of a box", R, (3, 3))
    check_shape("the half edges of a box", half, (3,))
    for k in range(3):
        check_positive("half an edge of a box [m]", half[k])
        check_normal(R[:, k])
    skewness = np.abs(R.T @ R - np.eye(3)).max()
    if skewness > UNIT:
        raise BadInput("the largest product of two axes of a box [-]", skewness, "give axes at right angles")
    return Box(x, R, half)


def box_separation(a, b):
    """Return (gap [m], n, k): the best separating axis of two Boxes, as a unit normal from b to a, and its number.

    gap along an axis:   |r · axis| − half_width(a, axis) − half_width(b, axis),     r = x_a − x_b
    Choose the axis of the greatest gap.  An axis of two edges (k ≥ 6) must exceed the best face, k < 6, and any edges
    before it by EDGE_PREFERENCE.  Of equal gaps the first counts.  candidate_axis(a, b, k) returns axis k; skip those
    that are zeros.  n = ±axis, such that n · r ≥ 0.

    gap > 0: the boxes are at least that far apart along n.  gap ≤ 0: they overlap, and −gap along n is the shortest way
    out.
    *Source:* Gottschalk, Lin and Manocha 1996.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.14: box_separation")


def box_box(a, b):
    """Given.  Return the Contacts of two Boxes; none where they are apart.

    If a face separates best, the opposite face of the other box is clipped at its four sides, and the corners
    behind the face are up to eight contact points.  If two edges do, there is one point, where the edges are nearest.
    *Source:* Gottschalk, Lin and Manocha 1996; Catto 2006.
    """
    gap, n, k = box_separation(a, b)
    if not np.isfinite(gap):
        raise BadInput("the gap between two boxes [m]", gap, "give both of them finite places, axes and sizes")
    if gap > 0.0:
        return Contacts(np.zeros((0, 3)), np.zeros((0, 3)), n, np.zeros(0))
    if k >= 6:
        p, q = box_edge(a, (k - 6) // 3, -n)
        s, t = box_edge(b, (k - 6) % 3, n)
        p, q = closest_segments(p, q, s, t)
        return Contacts(np.stack((p,)), np.stack((q,)), n, np.array([gap]))
    flipped = k >= 3
    face, other, to = (b, a, n) if flipped else (a, b, -n)
    y, i, out = box_face(face, to)
    left, _, _ = box_face(other, -out)
    for m in range(3):
        if m != i:
            axis = column(face.R, m)
            left = clip(clip(left, axis, axis @ face.x + face.half[m]), -axis, face.half[m] - axis @ face.x)
    return against_face(left, out, y[0], flipped)


# ---------------------------------------------------------------------------------- narrow phase: any two convex bodies

def gjk(a, b):
    """Return the Contact of two convex bodies, the hulls of the points a (k, d) and b (m, d), at their nearest points.

    The set of all differences y = p − q is as far from 0 as the bodies are from each other.  Start from one
    point of each,
    p = a[:1], q = b[:1], weights = np.ones(1).  At most MAX_GJK_STEPS times:
        v = Σ weight (p − q)                                      the nearest point so far
        i = support(a, −v),  j = support(b, v),  w = a_i − b_j    the difference that is farthest towards 0
        stop if far_enough(v, w);  otherwise append a_i to p and b_j to q, and reduce them with nearest_subsimplex(p, q)
    Return ball_contact(Σ weight p, 0, Σ weight q, 0).  Where the bodies overlap it has a gap of 0 (or round-off), and
    its normal is meaningless.
    Raises what check_hulls raises; call it first.
    *Source:* Gilbert, Johnson and Keerthi 1988.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.15: gjk")


# ---------------------------------------------------------------------------------------------- avoidance

def repulsion(x, centre, radius, reach, k):
    """Return the acceleration (d,) [m/s²] at x (d,) in the repulsive field of an obstacle; unbounded near its surface.

    a = k (1/g − 1/reach)/g² n        for a gap g = |x − centre| − radius below reach,     0 beyond
    It is −∇U of  U = ½ k (1/g − 1/reach)²:  a body of finite energy never touches the obstacle.

    n: unit vector from the centre to x.  k in m⁴/s².  Raises BadInput for a gap of zero or below.
    *Source:* first lecture deck, “Collision avoidance: force fields”; Khatib 1986.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.16: repulsion")


def steer(x, v, centre, radius, ahead):
    """Return the acceleration (2,) [m/s²], across v, that just steers a body at x with v (2,) around a disc in its way.

    e = v/|v|,   r = centre − x,   τ = r · e/|v|                  time until it passes the centre
    y = r − (r · e) e                                             offset from the centre when it passes: −y
    a = −2 (radius − |y|)/τ² · y/|y|      if 0 < τ < ahead [s] and |y| < radius;  else 0

    Applied for τ, it moves the body aside by ½ a τ² = radius − |y|.  If the body heads for the exact centre (y = 0), it
    turns left: −y/|y| = (−e₁, e₀).
    radius [m] is the sum of the disc's radius, the body's own and the clearance.  At rest (v = 0): 0.
    *Source:* first lecture deck, “Collision avoidance: steer to avoid”; Reynolds 1999.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.17: steer")


def flock_acceleration(t, x, v, p):
    """Given.  Return the accelerations (n, d) [m/s²] of a flock at x, v (n, d): separation, alignment and gathering.

    a_i = Σ_j repulsion(x_i, x_j, 2 radius, reach, k) + Σ_near align (v_j − v_i) + gather (x̄ − x_i)

    Separation and gathering have potentials, and alignment only removes energy.  The energy therefore cannot grow, U
    stays finite, and no members collide.
    *Source:* first lecture deck, “as in flocking”; Reynolds 1987 for the three rules.
    """
    a, middle = np.zeros(x.shape), np.zeros(x.shape[1])
    for i in range(len(x)):
        middle += x[i] / len(x)
    for i in range(len(x)):
        a[i] += p.gather * (middle - x[i])
        for j in range(i):
            push = repulsion(x[i], x[j], 2.0 * p.radius, p.reach, p.k)
            r = x[i] - x[j]
            if np.sqrt(r @ r) < 2.0 * p.radius + p.reach:
                push = push + p.align * (v[j] - v[i])
            a[i] += push
            a[j] -= push
    return a


def flock_energy(x, v, p):
    """Given.  Return ½ Σ |v|² + Σ_pairs ½ k (1/g − 1/reach)² + ½ gather Σ |x − x̄|²  [m²/s²], which never grows."""
    energy, middle = 0.0, np.zeros(x.shape[1])
    for i in range(len(x)):
        middle += x[i] / len(x)
    for i in range(len(x)):
        energy += 0.5 * (v[i] @ v[i]) + 0.5 * p.gather * ((x[i] - middle) @ (x[i] - middle))
        for j in range(i):
            r = x[i] - x[j]
            g = np.sqrt(r @ r) - 2.0 * p.radius
            if g < p.reach:
                energy += 0.5 * p.k * (1.0 / g - 1.0 / p.reach) ** 2
    return energy


def make_flock(radius, reach, k, align, gather):
    """Given.  Make a Flock; raises BadInput for a length or a k that is not positive, or values that are not finite."""
    lengths = positive_number("radius [m]", radius), positive_number("reach [m]", reach)
    pulls = finite_number("align [1/s]", align), finite_number("gather [1/s²]", gather)
    return Flock(*lengths, positive_number("k [m⁴/s²]", k), *pulls)
