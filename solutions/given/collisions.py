"""Given with lesson 6.  Contacts of more shapes, the steps and loops of balls that fly, and a flock."""

from typing import NamedTuple

import numpy as np

from ..checks import (
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
from ..collisions import *  # noqa: F403    one import has a lesson and its given functions
from ..collisions import (
    NEVER,
    Box,
    Contact,
    Plane,
    ball_contact,
    box_separation,
    clip,
    closest_on_segment,
    closest_on_triangle,
    cylinder_contact,
    cylinder_impact_time,
    find_intersections,
    plane_distance,
    plane_impact_time,
    repulsion,
    separating_edge,
)
from ..support.geometry import PARALLEL, box_edge, box_face, column, incident_edge, outward
from ..support.records import check_record
from ..support.trees import build_tree


class Contacts(NamedTuple):
    """The same for an area of contact, represented by k of its points with a common normal."""
    p_a: np.ndarray          # (k, d) [m]
    p_b: np.ndarray          # (k, d) [m]
    n: np.ndarray            # (d,)
    gap: np.ndarray          # (k,) [m]


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


# ---------------------------------------------------------------------------------------------- planes and cylinders

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


def ball_plane(x, r, plane):
    """Given.  Return the Contact of a ball (a) and a plane (b)."""
    distance = plane_distance(x, plane)
    return Contact(x - r * plane.n, x - distance * plane.n, plane.n, distance - r, 0.0)


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


# ---------------------------------------------------------------------------------------------- balls that fly

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
    check_record(p, x)
    t, x, v, dt, steps = checked_run(t, x, v, dt, steps)
    check_array("position x [m]", x, 2)
    x, v = x.copy(), v.copy()
    for k in range(len(x)):
        finite_number("gap at the start [m]", gap(x[k], p))
        for n in range(steps):
            if v[k] @ v[k] > 0.0:
                x[k], v[k] = step(gap, impact_time, t + n * dt, x[k], v[k], dt, p)
    return x, v


# ---------------------------------------------------------------------------------------------- narrow phase

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

    Either one of them is an end, or both are inside: there |a + s u − c − t w|² is least (u = b − a, w = d − c).  All
    numbers are finite.
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


# ---------------------------------------------------------------------------------------------- polygons and boxes

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


# ---------------------------------------------------------------------------------------------- a flock

def flock_acceleration(t, x, v, p):
    """Given.  Return the accelerations (n, d) [m/s²] of a flock at x, v (n, d): separation, alignment and gathering.

    a_i = Σ_j repulsion(x_i, x_j, 2 radius, reach, k) + Σ_near align (v_j − v_i) + gather (x̄ − x_i)

    Separation and gathering have potentials, and alignment (≥ 0) only removes energy.  In exact motion the energy
    therefore cannot grow, U stays finite, and no members collide.  A step that is too long for the reach can skip U.
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
    flock = Flock(*lengths, positive_number("k [m⁴/s²]", k), *pulls)
    check_record(flock, np.zeros((1, 1)))
    return flock
