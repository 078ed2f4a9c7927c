"""Lesson 6.  Collisions: which bodies touch, when and where.

Symbols: x (d,) centre, p (d,) any point [m] · r, R [m] radii · n (d,) unit normal, from b to a · gap [m],
negative where two bodies overlap · E(p) [m] signed distance from a plane · low, high (n, d) [m] corners of n
boxes along the axes · t, dt [s].

*Detection* finds which bodies touch, where and when.  It is pure geometry, and fills this lesson except for its end.
*Avoidance* acts before contact.  It needs detection with a large reach, and forces.
*Response* changes velocities after contact: lesson 7.
Given in solutions/given/collisions.py: make_plane and make_box; contacts of capsules, polygons, boxes; discrete_step
and continuous_step of balls that fly; a flock.  Trees are built in solutions/support/trees.py.
*Left out:* bodies that rotate during the step, and non-convex shapes (divide them into convex parts).
"""

from typing import NamedTuple

import numpy as np

from solutions.checks import BadInput
from solutions.support.geometry import box_corners, candidate_axis, column, half_width, nearer, normal_or_axis, outward
from solutions.support.simplices import check_hulls, far_enough, nearest_subsimplex, support
from solutions.support.trees import Tree, as_pairs, boxes_touch, check_boxes, half_perimeter, touching_items
from solutions.vectors import cross, dot

__all__ = [
    "DEGENERATE_AREA", "EDGE_PREFERENCE", "MAX_GJK_STEPS", "NEVER", "Box", "Contact", "Plane", "Tree", "all_pairs",
    "ball_box", "ball_contact", "barrier_is", "box_corners", "box_separation", "boxes_touch", "candidate_axis",
    "check_boxes", "check_hulls", "clip", "closest_on_segment", "closest_on_triangle", "cylinder_contact",
    "cylinder_impact_time", "edge_axis_distance", "far_enough", "find_intersections", "gjk", "half_perimeter",
    "half_width", "my_rule", "nearer", "nearest_subsimplex", "outward", "plane_distance", "plane_impact_time",
    "repulsion", "separating_edge", "share_past", "steer", "support", "swept_box", "touching_items",
    "triangle_cylinder_gap",
]

NEVER = np.inf               # time of an event that does not occur in this step [s]
DEGENERATE_AREA = 1e-12      # area over longest edge squared below which a triangle's normal is round-off [-]
MAX_GJK_STEPS = 100          # at most [-]; ordinary pairs need below 20, ellipsoids of 1 : 300 sometimes all of them
EDGE_PREFERENCE = 1e-9       # of the size: so much better must a pair of edges separate [-]; prevents alternation


class Contact(NamedTuple):
    """The result of detection: where two bodies touch, or are nearest.  The lecture writes p₁, p₂, n and t*."""
    p_a: np.ndarray          # (d,) the point on a [m]
    p_b: np.ndarray          # (d,) the point on b [m]
    n: np.ndarray            # (d,) unit normal, from b to a
    gap: float               # (p_a − p_b) · n [m]: negative where they overlap
    t: float                 # time of contact [s]; NEVER where they do not meet


class Plane(NamedTuple):
    """All p with n · p + d = 0; the free side is the one to which n points."""
    n: np.ndarray            # (3,) or (2,) unit normal
    d: float                 # [m]


class Box(NamedTuple):
    """A box in 3D."""
    x: np.ndarray            # (3,) centre [m]
    R: np.ndarray            # (3, 3) its axes, as columns
    half: np.ndarray         # (3,) half of its edges [m]


# ---------------------------------------------------------------------------------------------- points and planes

def plane_distance(p, plane):
    """Return the signed distance [m] of p (d,) from a plane; negative on the wrong side: the discrete test.

    E(p) = a x + b y + c z + d = n · p + d

    The product is p @ n: p may have two components, and `dot` takes three.
    *Source:* first lecture deck, “Detect collision: point–plane”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.1: plane_distance")


def plane_impact_time(t, dt, x_0, x_1, r, plane):
    """Return the time [s] at which a ball of radius r touches a plane: the continuous test.

    The ball moves straight from x_0 at t to x_1 at t + dt, at a constant speed.  r = 0: a point.
    *Find* the time from its distances from the plane before the step and after it.

    Return t where the ball already touches at x_0, and NEVER where it does not reach the plane in this step.  A ball
    that just reaches it at x_1 touches at the end of the step.
    *Source:* first lecture deck, “Time of impact”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.2: plane_impact_time")


def ball_contact(x_a, r_a, x_b, r_b):
    """Given.  Return the Contact of two balls, or of a ball and a point (r_b = 0).  Most round shapes reduce to this.

    n = (x_a − x_b)/|x_a − x_b|,   gap = |x_a − x_b| − r_a − r_b,   p_a = x_a − r_a n,   p_b = x_b + r_b n
    """
    r = x_a - x_b
    n = normal_or_axis(r)
    return Contact(x_a - r_a * n, x_b + r_b * n, n, np.sqrt(r @ r) - r_a - r_b, 0.0)


# ------------------------------------------------------------------------------------------ a cylinder along the x axis

def cylinder_contact(x, r, R):
    """Return the Contact of a ball (a) at x (3,) and the infinite cylinder (b) about the x axis: the discrete test.

    r is the radius of the ball, R that of the cylinder.  *Find* the ball of radius R that touches as the cylinder does:
    where on the axis is its centre?  ball_contact does the rest.
    *Source:* second lecture deck, the worked question, part 1.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.3: cylinder_contact")


def cylinder_impact_time(t, dt, x_0, x_1, r, R):
    """Return the time [s] at which a ball first touches the cylinder of cylinder_contact: the continuous test.

    The ball moves straight from x_0 (3,) at t to x_1 at t + dt, at a constant speed.
    *Find* the share s of the step after which it touches.  Let y be the coordinates (1, 2) of x_0, w those of x_1 −
    x_0, and ρ = R + r.  Then  |y + s w|² = ρ²,  and of the two roots the first one counts.

    B² − A C, a quarter of the discriminant of  A s² + 2 B s + C = 0,  loses its digits if a fast ball barely grazes the
    cylinder or comes from far away.  A ρ² − (y₀ w₁ − y₁ w₀)² is the same number, and keeps them.

    Return t where the ball already touches at x_0.  Return NEVER where it does not approach, misses, or touches only
    after this step (s > 1).
    *Source:* second lecture deck, the worked question, part 2.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.4: cylinder_impact_time")


def closest_on_segment(p, a, b):
    """Return the point (d,) of the segment from a to b (d,) that is nearest to p (d,).

    *Find* it: the points of the segment are a + s (b − a) with 0 ≤ s ≤ 1.  If the nearest point of the line through
    a and b is beyond an end, return that end.

    Raises BadInput("the length of an edge [m]", 0.0, "give two different ends") for a segment of zero length.
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
        gap = least edge_axis_distance of the three edges − R − r

    All corners can be far outside while an edge or the face is not: testing the particles of a cloth is not enough.
    *Source:* second lecture deck, the worked question, part 3.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.6: triangle_cylinder_gap")


# ------------------------------------------------------------------------------------------- narrow phase: round shapes

def closest_on_triangle(p, a, b, c):
    """Return the point (3,) of the triangle a b c that is nearest to p (3,).

    N = (b − a) × (c − a),    q = p − ((p − a) · N)/(N · N) N       the projection of p on the triangle's plane
    q where it is inside: ((b − a) × (q − a)) · N ≥ 0, and the same for b, c and for c, a;
    elsewhere the nearest of the three points closest_on_segment of the edges; nearer(p, q, other) returns q or other

    Areas from dot products, as in Ericson 2005, 5.1.5, lose most of their digits where the triangle is a needle.
    Raises BadInput("the area of a triangle [m²]", ½|N|, "give three corners that are not on one line") where |N| is
    DEGENERATE_AREA times its longest edge squared or less.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.7: closest_on_triangle")


def ball_box(x, r, box):
    """Return the Contact of a ball (a) of radius r at x (3,) and a Box (b), even where the ball's centre is inside.

    y = Rᵀ (x − x_box);   outside: the ball_contact with the point x_box + R q of radius 0, q_i = y_i limited to ±half_i
    Take it in the box's axes, between y and q, and turn its n by R.  The difference of y and q is exact.  So n is right
    even where the centre is outside a face by round-off only.
    inside or on a face (|y_i| ≤ half_i for all i): leave through the nearest face, along the axis i of the least depth
    half_i − |y_i|:
        n = sign(y_i) times that axis, sign(0) = 1;   gap = −depth − r,   p_a = x − r n,   p_b = x + depth n,   t = 0

    column(box.R, i) is axis i.
    *Source:* Ericson 2005, section 5.1.4, the nearest point of a turned box.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.8: ball_box")


# ---------------------------------------------------------------------------------------------- broad phase

def swept_box(low, high, move):
    """Return (low, high), each (d,): the box around the path of a box low, high (d,) that moves by move (d,) [m].

    *Find* its corners, whichever way the box moves: it is the least box that holds the moving one at every moment.

    A body at rest that does not touch this box is not hit.  If both bodies move, neither hits the other unless their
    swept boxes touch.
    *Source:* first lecture deck, “Swept volumes”.
    *Left out:* the swept volume itself, which is smaller than the box around it.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.9: swept_box")


def all_pairs(low, high):
    """Return (m, 2): the numbers i < j of all boxes low, high (n, d) that touch, each pair once, by testing every pair.

    There are n (n − 1)/2 tests, boxes_touch(low, high, i, low, high, j), so ten times as many boxes take a hundred
    times as long.
    Begin with the empty list  found = [(0, 0) for _ in range(0)],  from which the compiler infers its type.
    Append pairs, and return as_pairs(found).
    Raises what check_boxes(low, high) raises; call it first.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.10: all_pairs")


def find_intersections(a, b):
    """Return (m, 2): the pairs (item of a, item of b) whose boxes touch, each once, by a joint descent of two Trees.

    FindIntersections(i, j), first of (0, 0), does nothing unless the boxes of node i of a and node j of b touch
    (boxes_touch(a.low, a.high, i, b.low, b.high, j)).  If they do:
        neither is a leaf      FindIntersections of each child of the larger node with the other one; the larger is the
                               one with the greater half_perimeter(tree, node), i if these are equal
        one is a leaf          FindIntersections of each child of the other one with the leaf
        both are leaves        test the pairs of their items: touching_items(a, i, b, j, found)

    The larger node goes first because that prunes sooner.  The pairs are the same whichever goes first, and they may
    come in any order.
    Keep a list of the pairs (i, j) still to visit, at first [(0, 0)], and one of found pairs as in all_pairs; return
    as_pairs(found).  Node i is a leaf if a.child[i] = 0.  Otherwise its children are a.child[i] and a.child[i] + 1.
    If your loop never ends, it may have used the child 0 of a leaf as a node: node 0 is the root.
    *Source:* second lecture deck, “FindIntersections(node₁, node₂)”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.11: find_intersections")


# ---------------------------------------------------------------------------------------- narrow phase: separating axes

def separating_edge(a, b):
    """Return (gap [m], i): the edge i of the convex polygon a (k, 2) that separates it best from b (m, 2), and its gap.

    gap of edge i:  the least  n_i · (b_j − a_i)  of all corners j of b,  n_i = outward(a, i).    Return the greatest

    A positive gap: a line along this edge separates the polygons.  If the gaps of both polygons are negative, they
    overlap, and the greater gap gives the shortest way out.
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
    left, return an array without rows.  y itself may have no row or one row, because it can be the result of another
    cut.  All numbers are finite.
    *Source:* Sutherland and Hodgman 1974.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.13: clip")


def box_separation(a, b):
    """Return (gap [m], n, k): the best separating axis of two Boxes, as a unit normal from b to a, and its number.

    gap along an axis:   |r · axis| − half_width(a, axis) − half_width(b, axis),     r = x_a − x_b
    Choose the axis of the greatest gap.  An axis of two edges (k ≥ 6) wins only if its gap exceeds the best gap before
    it, of faces (k < 6) and edges, by EDGE_PREFERENCE times the longest half edge of both boxes.  Of equal gaps the
    first counts.  candidate_axis(a, b, k) returns axis k; skip those that are zeros.  n = ±axis, such that n · r ≥ 0.

    gap > 0: the boxes are at least that far apart along n.  gap ≤ 0: they overlap, and −gap along n is the shortest way
    out.
    *Source:* Gottschalk, Lin and Manocha 1996.
    *Left out:* beams a million times as long as they are thick, whose edges may be parallel to round-off and yet part
    them.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.14: box_separation")


# ---------------------------------------------------------------------------------- narrow phase: any two convex bodies

def gjk(a, b):
    """Return the Contact of two convex bodies, the hulls of the points a (k, d) and b (m, d), at their nearest points.

    The set of all differences y = p − q is as far from 0 as the bodies are from each other.  Start from one
    point of each,
    p = a[:1], q = b[:1], weights = np.ones(1).  At most MAX_GJK_STEPS times:
        v = Σ weight (p − q)                                      the nearest point so far
        i = support(a, −v),  j = support(b, v),  w = a_i − b_j    the difference that is farthest towards 0
        stop if far_enough(v, w);  otherwise append a_i to p and b_j to q
        p, q, weights = nearest_subsimplex(p, q)                  only those points that span the nearest one
    Return ball_contact(Σ weight p, 0, Σ weight q, 0).  Where the bodies overlap, its gap is 0 (or round-off) and
    its normal is meaningless.
    Raises what check_hulls(a, b) raises; call it first.
    *Source:* Gilbert, Johnson and Keerthi 1988.
    *Left out:* bodies that are a hundred times as long as they are thick, or more.  Round-off may then hide the nearest
    point until MAX_GJK_STEPS are over: gaps that are too large by up to 5e-5 of the size were found.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.15: gjk")


# ---------------------------------------------------------------------------------------------- avoidance

def repulsion(x, centre, radius, reach, k):
    """Return the acceleration (d,) [m/s²] at x (d,) in the repulsive field of an obstacle; unbounded near its surface.

    U = ½ k (1/g − 1/reach)²          for a gap g = |x − centre| − radius below reach,     0 beyond
    *Find* a = −∇U.  A body of finite energy never touches the obstacle.

    k in m⁴/s².  Raises BadInput("the gap to an obstacle [m]", g, "start outside, and take smaller steps") for g ≤ 0.
    *Source:* first lecture deck, “Collision avoidance: force fields”; Khatib 1986.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.16: repulsion")


def steer(x, v, centre, radius, ahead):
    """Return the acceleration (2,) [m/s²], across v, that steers a body at x with v (2,) aside from a disc in its way.

    e = v/|v|,   r = centre − x,   τ = r · e/|v|                  time until the body passes the centre
    y = (r · n) n,   n = (−e₁, e₀), to the left of e              offset from the centre when it passes: −y
    a points along −y/|y|                 if 0 < τ < ahead [s] and |y| < radius;  else a = 0

    *Find* its size: constant for the time τ, it moves the body aside until the offset from the centre is the radius.
    If the body heads for the exact centre (y = 0), it turns left: take n in place of −y/|y|.
    At rest (v = 0): 0.
    radius [m] is the sum of the disc's radius, the body's own and a clearance.  The clearance is needed.  A body that
    holds this acceleration for τ ends at the distance radius, abreast of the centre, but it was nearer just before:
    by no more than the factor |v|/√(v² + a²τ²).  It ends faster by the inverse of that factor.  If the acceleration is
    computed anew all the time, it remains across v, so the speed remains, and the body comes much less too near.
    *Source:* first lecture deck, “Collision avoidance: steer to avoid”; Reynolds 1999.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.17: steer")


# ---------------------------------------------------------------------------------------------- why?

def share_past(r, w, v, dt):
    """Return the share [-] of all balls that get past a wall although ball_box tests them after every step.

    Balls of radius r [m] fly straight at a wall of thickness w [m] with the speed v > 0 [m/s], in steps of dt > 0 [s].
    Every place of the first step near the wall is equally likely.  A ball that overlaps the wall leaves it through the
    face that is nearest to its centre.
    *Find* the share before you run anything: where must a step end for a ball to be sent back?
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.18: share_past")


def barrier_is():
    """Return the letter of the force that stops a body of any speed: "A", "B", "C" or "D".

    The figure of the notebook has four forces that push a body away from a wall, against the gap.  Time is continuous:
    no step skips a force.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.19: barrier_is")


def my_rule(i, x, v, goals):
    """Return the acceleration (2,) [m/s²] of person i of a crowd that crosses a circle of radius 4 m.

    *Make it*: a rule by which twelve people, evenly spread over the circle and at rest, go to the opposite places.
    x, v and goals (n, 2) are the places [m], velocities [m/s] and goals [m] of all.  Many rules are right.  The judge
    walks the crowd for 20 s by symplectic Euler with steps of 0.1 s, and demands:

    - Two people, of a radius of 0.25 m each, never touch.
    - In the end each is within 0.3 m of the goal.
    - No acceleration exceeds 5 m/s².
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 6.20: my_rule")
