"""Distance, normal, and nearest or overlapping points of two bodies: every pair of shapes of the narrow phase.

Most shapes are rounded hulls: points, and a radius around their hull.  The reference solution is a least-squares
problem with non-negative weights, or the hull of all differences.  The lesson has a formula for each pair, separating
axes with clipping, and GJK for all.
"""

from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.collisions import Box, Plane
from validate.check import Whose
from validate.engines.bullet import Bullet
from validate.methods import AXES, CONTINUOUS, GJK, NARROW
from validate.reference.collisions import ONLY_ROUND_OFF, depth_of, first_root, hull_nearest
from validate.scene import EXACT, PYBULLET, PYMUNK, Departure, EngineRun, Scene, engine, ours
from validate.scenes._common import ANSWER, cases_with, one_reading
from validate.scenes.drawing import outlines

T = 1.0


class Params(NamedTuple):
    pair: str = "ball, ball"
    r: Annotated[float, "radius of the first [m]"] = 0.3
    R: Annotated[float, "of the second [m]"] = 0.4


IN_PLANE = ("disc, polygon (2D)", "polygon, polygon (2D)", "rectangles (2D)", "flying disc (2D)")
CASES = {name: Params(name) for name in (
    "ball, ball", "ball, plane", "ball, capsule", "capsule, capsule", "ball, triangle", "ball, box", "ball in a box",
    "box, box (corner)", "box, box (edges)", "axis of a corner", "axis of two edges", "box in a box", "box on a box",
    "box, plane", "triangle, box", *IN_PLANE,
)}
GRID = 10216                 # of pybullet: spacings of the grid for the points of a hull, along each axis
MARGIN = 0.001               # of pybullet: the radius that rounds boxes, and surrounds hulls of points [m]


# ---------------------------------------------------------------------------------------------- the bodies

def turn(x, y, z):
    """Return R (3, 3) of a rotation about x, then y, then z, by these angles [rad]."""
    R = np.eye(3)
    for k, angle in enumerate((x, y, z)):
        c, s, part = np.cos(angle), np.sin(angle), np.eye(3)
        i, j = (k + 1) % 3, (k + 2) % 3
        part[i, i], part[i, j], part[j, i], part[j, j] = c, -s, s, c
        R = part @ R
    return R


SIGNS = np.array([[i, j, k] for k in (-1.0, 1.0) for j in (-1.0, 1.0) for i in (-1.0, 1.0)])
# everything is rotated and moved, so that no axis is special
WORLD = turn(0.4, -0.7, 1.1)
AT = np.array([0.3, -0.2, 0.5])
FLAT = np.array([[np.cos(0.4), -np.sin(0.4)], [np.sin(0.4), np.cos(0.4)]])
# {name: (kind, points or (centre, angles, half edges)) of both bodies}, before WORLD
SHAPES = {
    "ball, ball": (("ball", [(0.0, 0.0, 0.0)]), ("ball", [(0.9, 0.5, -0.4)])),
    "ball, plane": (("ball", [(0.2, 0.3, 0.8)]), ("plane", None)),
    "ball, capsule": (("ball", [(1.0, 0.2, 0.5)]), ("capsule", [(-0.5, -0.3, -0.8), (0.2, 0.1, 0.9)])),
    "capsule, capsule": (
        ("capsule", [(-0.6, 1.2, -0.4), (0.8, 1.1, 0.5)]),
        ("capsule", [(0.3, -0.2, -0.9), (-0.1, 0.1, 0.8)]),
    ),
    "ball, triangle": (("ball", [(0.3, 0.2, 0.9)]), ("hull", [(-0.5, -0.4, 0.0), (0.9, -0.3, 0.1), (0.2, 0.8, -0.1)])),
    "ball, box": (("ball", [(1.1, 0.9, 0.1)]), ("box", ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.6, 0.4, 0.5)))),
    "ball in a box": (("ball", [(0.1, 0.25, -0.1)]), ("box", ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.6, 0.4, 0.5)))),
    "box, box (corner)": (
        ("box", ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.9, 0.8, 0.3))),
        ("box", ((0.1, 0.1, 1.1), (0.7, 0.6, 0.2), (0.3, 0.35, 0.4))),
    ),
    "box, box (edges)": (
        ("box", ((0.0, 0.0, 0.0), (0.7, 0.0, 0.0), (0.9, 0.4, 0.4))),
        ("box", ((0.0, 0.0, 1.4), (0.0, 0.8, 0.0), (0.4, 0.9, 0.4))),
    ),
    "box in a box": (
        ("box", ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.9, 0.8, 0.5))),
        ("box", ((0.2, -0.1, 0.6), (0.3, 0.5, 0.2), (0.3, 0.3, 0.5))),
    ),
    "box on a box": (
        ("box", ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.9, 0.8, 0.5))),
        ("box", ((0.7, -0.5, 0.85), (0.0, 0.0, 0.0), (0.6, 0.7, 0.4))),
    ),
    "box, plane": (("box", ((0.2, -0.1, 0.6), (0.5, 0.4, 0.2), (0.4, 0.5, 0.45))), ("plane", None)),
    "triangle, box": (
        ("hull", [(1.2, 0.1, 0.9), (1.9, -0.4, 0.6), (1.5, 0.9, 1.3)]),
        ("box", ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.6, 0.4, 0.5))),
    ),
    "disc, polygon (2D)": (("ball", [(1.6, 0.9)]), ("hull", [(0.0, -0.6), (0.8, -0.1), (0.5, 0.6), (-0.4, 0.5)])),
    "polygon, polygon (2D)": (
        ("hull", [(1.1, 0.2), (1.9, -0.1), (2.0, 0.8)]),
        ("hull", [(0.0, -0.6), (0.8, -0.1), (0.9, 0.6), (-0.4, 0.5)]),
    ),
    "rectangles (2D)": (
        ("hull", [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)]),
        ("hull", [(1.2, 0.9), (3.4, 0.9), (3.4, 1.7), (1.2, 1.7)]),
    ),
    "flying disc (2D)": (("ball", [(-3.0, 0.35), (1.0, 0.05)]), ("ball", [(0.0, 0.0)])),
}

SHAPES |= {"axis of a corner": SHAPES["box, box (corner)"], "axis of two edges": SHAPES["box, box (edges)"]}
# These give gap and normal only: a separating axis has no nearest points.
AXIS_ONLY = ("axis of a corner", "axis of two edges", "box in a box")


def flat(p):
    return p.pair in IN_PLANE


def moved(x, p):
    """Return points (k, d) in the coordinates of the scene."""
    x = np.array(x, dtype=float)
    return x @ FLAT.T + AT[:2] if flat(p) and p.pair != "flying disc (2D)" else x if flat(p) else x @ WORLD.T + AT


def corners(body, p):
    """Return the points of a rounded hull."""
    kind, shape = body
    if kind != "box":
        return moved(shape, p)
    x, angles, half = shape
    return moved(np.array(x) + SIGNS * np.array(half) @ turn(*angles).T, p)


def radii(p):
    """Return the radii around the points of each body [m]."""
    return [{"ball": r, "capsule": r}.get(kind, 0.0) for (kind, _), r in zip(SHAPES[p.pair], (p.r, p.R))]


def box_of(body):
    """Make the lesson's Box."""
    x, angles, half = body[1]
    return Box(WORLD @ np.array(x) + AT, np.ascontiguousarray(WORLD @ turn(*angles)), np.array(half))


def the_plane():
    """Make the plane z = 0, moved."""
    n = np.ascontiguousarray(WORLD[:, 2])
    return Plane(n, float(-n @ AT))


def start(p):
    return (p,)


def quantity_names(p):
    if p.pair == "flying disc (2D)":
        return "share of the way [-]", "n_x [-]", "n_y [-]"
    many = ("points [-]",) if p.pair in MANY else ()
    return (
        "gap [m]",
        *(f"n_{c} [-]" for c in "xyz"[: 2 if flat(p) else 3]),
        *(() if p.pair in AXIS_ONLY else (f"{c} of b [m]" for c in "xyz"[: 2 if flat(p) else 3])),
        *many,
    )


# These touch along an area: b's point is the mean of the points of contact.
MANY = ("box on a box", "rectangles (2D)")


# ---------------------------------------------------------------------------------------------- ours

def run(lessons, step, acceleration, state, p, dt, steps):
    """Run the lesson's function for this pair.

    For rounded hulls subtract the radii from GJK's distance of the points.
    """
    collisions, (a, b) = lessons.collisions, SHAPES[p.pair]
    if p.pair == "flying disc (2D)":
        x_0, x_1 = (np.append(0.0, x) for x in np.array(a[1]))
        c = collisions.cylinder_hit(0.0, 1.0, x_0, x_1, p.r, p.R)
        return (np.array([c.t, *c.n[1:]]),)
    if p.pair in MANY:
        c = (collisions.polygon_contacts(corners(a, p), corners(b, p)) if flat(p)
             else collisions.box_box(box_of(a), box_of(b)))
        return (np.array([c.gap.min(), *c.n, *c.p_b.mean(axis=0), len(c.gap)]),)
    # the corners below the plane; of these the deepest
    if p.pair == "box, plane":
        c = collisions.points_plane(collisions.box_corners(box_of(a)), the_plane())
        k = int(np.argmin(c.gap))
        return (np.array([c.gap[k], *c.n, *c.p_b[k]]),)
    if step is collisions.gjk:
        c = step(corners(a, p), corners(b, p))
        r_a, r_b = radii(p)
        return (np.array([c.gap - r_a - r_b, *c.n, *(c.p_b + r_b * c.n)]),)
    if step is collisions.box_separation:
        gap, n, _ = step(box_of(a), box_of(b))
        return (np.array([gap, *n]),)
    c = narrow(lessons, p, a, b)
    return (np.array([c.gap, *c.n, *c.p_b]),)


def narrow(lessons, p, a, b):
    """Return the Contact of a pair for which the lesson has a formula."""
    collisions, x = lessons.collisions, corners(a, p)
    if b[0] == "plane":
        return collisions.ball_plane(x[0], p.r, the_plane())
    if b[0] == "box":
        return collisions.ball_box(x[0], p.r, box_of(b))
    y = corners(b, p)
    if a[0] == "capsule":
        return collisions.capsule_capsule(x[0], x[1], p.r, y[0], y[1], p.R)
    if b[0] == "capsule":
        return collisions.ball_capsule(x[0], p.r, y[0], y[1], p.R)
    if b[0] == "hull":
        return collisions.ball_triangle(x[0], p.r, *y)
    return collisions.ball_contact(x[0], p.r, y[0], p.R)


def observe(state, p):
    return np.array(state[0], dtype=float)


# ---------------------------------------------------------------------------------------------- truth

def truth(p, t):
    """The reference solution depends on the pair.

    separate bodies    nearest points of two hulls, by non-negative least squares, minus the radii
    overlapping        the hull of all differences
    ball, plane        the height above the plane; for a box the height of its lowest corner
    ball in a box      the nearest of six faces
    box on a box       the common rectangle: four points of contact
    rectangles         the common segment: two points
    flying disc        the first root of the distance of the centres minus r + R, by brentq
    Source: the definitions of distance and of the Minkowski difference.
    """
    a, b = SHAPES[p.pair]
    if p.pair == "flying disc (2D)":
        begin, end = np.array(a[1])
        way = lambda s: begin + s * (end - begin)
        nearest = -(begin @ (end - begin)) / ((end - begin) @ (end - begin))
        s = first_root(lambda s: np.hypot(*way(s)) - p.r - p.R, 0.0, nearest)
        return np.array([s, *way(s) / (p.r + p.R)])
    if p.pair == "rectangles (2D)":  # overlap 0.1 m, from x = 1.2 to 2 m, b above a
        return np.array([-0.1, *(FLAT @ [0.0, -1.0]), *moved([(1.6, 0.9)], p)[0], 2.0])
    if p.pair == "box on a box":                                             # overlap 0.05 m, x 0.1 … 0.9, y −0.8 … 0.2
        return np.array([-0.05, *(WORLD @ [0.0, 0.0, -1.0]), *moved([(0.5, -0.3, 0.45)], p)[0], 4.0])
    # the lowest of its corners, before WORLD rotates them
    if p.pair == "box, plane":
        x, angles, half = a[1]
        lowest = min(np.array(x) + SIGNS * np.array(half) @ turn(*angles).T, key=lambda y: y[2])
        return np.array([lowest[2], *WORLD[:, 2], *moved([(*lowest[:2], 0.0)], p)[0]])
    if p.pair == "ball, plane":
        return np.array([a[1][0][2] - p.r, *WORLD[:, 2], *moved([(*a[1][0][:2], 0.0)], p)[0]])
    # 0.4 − 0.25 = 0.15 m below the face y = 0.4, which is the nearest
    if p.pair == "ball in a box":
        return np.array([-0.15 - p.r, *WORLD[:, 1], *moved([(0.1, 0.4, -0.1)], p)[0]])
    if p.pair == "box in a box":
        gap, n = depth_of(corners(a, p), corners(b, p))
        return np.array([gap, *n])
    x, y = hull_nearest(corners(a, p), corners(b, p))
    distance = np.linalg.norm(x - y)
    n, (r_a, r_b) = (x - y) / distance, radii(p)
    return np.array([distance - r_a - r_b, *n, *(() if p.pair in AXIS_ONLY else y + r_b * n)])


def round_off(p, dt):
    """There are a few hundred operations on numbers below 3, and normals are known to round-off over a distance of 0.1.
    Together that is 1e-12.

    GJK stops when the distance is known to 1e-14 of the size.  In general the points are then known only to the square
    root of that, but these bodies have corners, so the last step is exact.  For bodies with corners and zero margin,
    pybullet's GJK is as exact, because its last simplex spans the nearest features.  pymunk's results are closed forms.
    """
    return 1e-12


def polytope_limit(p, dt):
    """For some pairs pybullet has closed forms, with round-off only (Bullet's btDefaultCollisionConfiguration and
    btConvexConvexAlgorithm).  A ball inside a box is round: the expanding polytope stops when the depth is known to
    1e-12 m.  The normal may then be off by √(2 · 1e-12 m/r), and the point by that times r.
    """
    turned = np.sqrt(2e-12 / p.r) * np.hypot(1.0, p.r) / np.linalg.norm(truth(p, T))
    return turned if p.pair == "ball in a box" else round_off(p, dt)


# ---------------------------------------------------------------------------------------------- engines

def bullet_body(bullet, body, r, p, margin):
    """Make one of the bodies, at rest.  margin [m]: that of a box or of a hull, or None for the default."""
    pb = bullet.pb
    kind, shape = body
    x = corners(body, p) if shape else None
    R, at = np.eye(3), np.zeros(3)
    if kind == "ball":
        made, at = pb.createCollisionShape(pb.GEOM_SPHERE, radius=r), x[0]
    elif kind == "plane":
        made, R, at = pb.createCollisionShape(pb.GEOM_PLANE), WORLD, AT
    elif kind == "box":
        box = box_of(body)
        made, R, at = pb.createCollisionShape(pb.GEOM_BOX, halfExtents=list(map(float, box.half))), box.R, box.x
    elif kind == "capsule":
        along = (x[1] - x[0]) / np.linalg.norm(x[1] - x[0])
        side = np.cross(along, np.eye(3)[np.argmin(np.abs(along))])
        side /= np.linalg.norm(side)
        R, at = np.stack((side, np.cross(along, side), along), axis=1), x.mean(axis=0)
        made = pb.createCollisionShape(pb.GEOM_CAPSULE, radius=r, height=float(np.linalg.norm(x[1] - x[0])))
    else:
        made = pb.createCollisionShape(pb.GEOM_MESH, vertices=x.tolist())
    m = 0.0 if kind == "plane" else 1.0
    made = pb.createMultiBody(m, made, basePosition=list(map(float, at)), baseOrientation=quaternion(R))
    if margin is not None and kind in ("box", "hull"):
        pb.changeDynamics(made, -1, collisionMargin=margin)
    return made


def quaternion(R):
    """Return (x, y, z, w) of a rotation by less than half a turn."""
    w = 0.5 * np.sqrt(max(1e-9, 1.0 + np.trace(R)))
    q = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1], 4.0 * w * w]) / (4.0 * w)
    return (q / np.linalg.norm(q)).tolist()


def bullet_make(p, dt, margin=None):
    """Use getClosestPoints within one metre for the points, their distance, and the normal from b to a."""
    bullet = Bullet(1.0)
    a, b = (bullet_body(bullet, body, r, p, margin) for body, r in zip(SHAPES[p.pair], (p.r, p.R)))

    def read():
        if p.pair in MANY:
            bullet.pb.performCollisionDetection()
            found = bullet.pb.getContactPoints(a, b)
        else:
            found = bullet.pb.getClosestPoints(a, b, 1.0)
        deepest = min(found, key=lambda c: c[8])
        if p.pair in MANY:
            return np.array([deepest[8], *deepest[7], *np.mean([c[6] for c in found], axis=0), len(found)])
        on_b = () if p.pair == "box in a box" else deepest[6]
        return np.array([deepest[8], *deepest[7], *on_b])

    return EngineRun(lambda: None, read, bullet.close)


def with_margins(p, t, margin=MARGIN):
    """Return the reference solution for pybullet's bodies.

    box     edges and corners rounded by the margin: a smaller box with that radius
    hull    the margin around the hull of the points, which are on a grid
    Source: Bullet, btBoxShape::localGetSupportingVertexWithoutMargin, btConvexHullShape and setMargin, with the margin
    that pybullet sets.
    """
    (a, b), (r_a, r_b) = SHAPES[p.pair], radii(p)
    (x, m_a), (y, m_b) = core(a, p, margin), core(b, p, margin)
    if p.pair == "box in a box":
        gap, n = depth_of(x, y)
        return np.array([gap - m_a - m_b, *n])
    x, y = hull_nearest(x, y)
    n = (x - y) / np.linalg.norm(x - y)
    return np.array([np.linalg.norm(x - y) - r_a - m_a - r_b - m_b, *n, *(y + (r_b + m_b) * n)])


def core(body, p, margin):
    """Return (points, margin) of a body in pybullet."""
    if body[0] == "hull":
        return snapped(corners(body, p)), margin
    if body[0] != "box":
        return corners(body, p), 0.0
    x, angles, half = body[1]
    return corners(("box", (x, angles, np.array(half) - margin)), p), margin


def snapped(x):
    """Return points (k, 3) on the grid on which pybullet finds the hull of a mesh.

    Each axis has GRID spacings between the outermost points, and counts them from the middle, towards zero.
    Source: Bullet, btConvexHullShape::optimizeConvexHull and btConvexHullInternal::compute.
    """
    low, high = x.min(axis=0), x.max(axis=0)
    middle, spacing = 0.5 * (low + high), (high - low) / GRID
    return middle + np.trunc((x - middle) / spacing) * spacing


def pymunk_make(p, dt):
    """Use pymunk's queries of a point, of two shapes, and of a segment with a radius."""
    import pymunk
    space = pymunk.Space()
    a, b = SHAPES[p.pair]

    def read():
        if p.pair == "flying disc (2D)":
            disc = pymunk.Circle(space.static_body, p.R)
            disc.cache_bb()
            hit = disc.segment_query(*a[1], p.r)
            return np.array([hit.alpha, *hit.normal])
        other = pymunk.Poly(space.static_body, corners(b, p).tolist())
        # places a shape that has no body of its own in a space
        other.cache_bb()
        if p.pair == "rectangles (2D)":
            one = pymunk.Poly(space.static_body, corners(a, p).tolist())
            one.cache_bb()
            found = one.shapes_collide(other)
            on_b = np.mean([c.point_b for c in found.points], axis=0)
            return np.array([min(c.distance for c in found.points), *(-found.normal), *on_b, len(found.points)])
        near = other.point_query(tuple(corners(a, p)[0]))
        return np.array([near.distance - p.r, *near.gradient, *near.point])
    return one_reading(read)


def only(*pairs):
    """Return the field `supports` of a runner that supports these pairs."""
    return cases_with("pair", pairs, CASES)


GJK_STOPS = "it stops when it knows the distance to 1e-14 of the size, and the limit bounds what is left"
WITH_CORNERS = "exact for bodies with corners: only round-off is left, and the limit bounds it"
POLYTOPE_STOPS = "closed forms are exact; its expanding polytope stops at 1e-12 m, and the limit bounds what is left"
ROUND_EDGES = Departure("it rounds the edges and corners of a box with a radius of 1 mm, unless collisionMargin is 0",
                        with_margins, Whose.DEFAULT)
OWN_MARGIN = Departure("it surrounds the points of a hull with a margin of 1 mm, unless collisionMargin is 0",
                       with_margins, Whose.DEFAULT)
OWN_GRID = Departure("it places the points of a hull on a grid of its own", partial(with_margins, margin=0.0),
                     Whose.LAW)
BOXES = only("ball, box", "box, box (corner)", "box, box (edges)", "box in a box")
HULLS = only("ball, triangle", "triangle, box")
EXACTLY = {"order": EXACT, "limit": round_off, "predicted": ONLY_ROUND_OFF}
RUNNERS = (
    ours(NARROW, **EXACTLY,
         supports=only("ball, ball", "ball, plane", "ball, capsule", "capsule, capsule", "ball, triangle", "ball, box",
                       "ball in a box", "box, plane")),
    ours(GJK, order=EXACT, limit=round_off, predicted=GJK_STOPS,
         supports=only("ball, ball", "ball, capsule", "capsule, capsule", "ball, triangle", "ball, box",
                       "box, box (corner)", "box, box (edges)", "triangle, box", "disc, polygon (2D)",
                       "polygon, polygon (2D)")),
    ours(AXES, **EXACTLY, supports=only(*AXIS_ONLY, *MANY)),
    ours(CONTINUOUS, **EXACTLY, supports=only("flying disc (2D)")),
    engine(PYBULLET, "", bullet_make,
           "getClosestPoints within 1 m; GEOM_SPHERE, _PLANE, _CAPSULE; for areas getContactPoints after "
           "performCollisionDetection",
           order=EXACT, limit=polytope_limit, predicted=POLYTOPE_STOPS,
           supports=only("ball, ball", "ball, plane", "ball, capsule", "capsule, capsule", "ball in a box",
                         "box on a box", "box, plane")),
    engine(PYBULLET, "round edges", bullet_make, "getClosestPoints within 1 m; GEOM_BOX",
           order=EXACT, limit=round_off, predicted=WITH_CORNERS, departure=ROUND_EDGES, supports=BOXES),
    engine(PYBULLET, "no margin", partial(bullet_make, margin=0.0),
           "getClosestPoints within 1 m; GEOM_BOX, collisionMargin 0",
           order=EXACT, limit=round_off, predicted=WITH_CORNERS, supports=BOXES),
    engine(PYBULLET, "hull", bullet_make, "getClosestPoints within 1 m; GEOM_MESH from corners",
           order=EXACT, limit=round_off, predicted=WITH_CORNERS, departure=OWN_MARGIN, supports=HULLS),
    engine(PYBULLET, "hull, no margin", partial(bullet_make, margin=0.0),
           "getClosestPoints within 1 m; GEOM_MESH from corners, collisionMargin 0",
           order=EXACT, limit=round_off, predicted=WITH_CORNERS, departure=OWN_GRID, supports=HULLS),
    engine(PYMUNK, "", pymunk_make, "point_query, shapes_collide, segment_query with a radius", **EXACTLY,
           supports=only("disc, polygon (2D)", "rectangles (2D)", "flying disc (2D)")),
)


# ---------------------------------------------------------------------------------------------- picture

def picture(name):
    """Return (points, pairs) of the outlines of both bodies of a 2D case."""
    p = CASES[name]
    drawn, pairs = [], []
    for (kind, shape), r in zip(SHAPES[name], (p.r, p.R)):
        around = np.linspace(0.0, 2.0 * np.pi, 25)
        ring = moved(shape, p)
        if kind == "ball":
            ring = ring[0] + r * np.stack((np.cos(around), np.sin(around)), axis=1)
        first = sum(map(len, drawn))
        drawn.append(ring)
        pairs += outlines(len(ring), 1, first)
    return np.concatenate(drawn), pairs


def points(observed, p):
    """Draw the pairs in the plane, side by side."""
    drawn, across = [], 0.0
    for name in IN_PLANE:
        x = picture(name)[0]
        drawn.append(x - [x[:, 0].min() - across, x[:, 1].mean()])
        across += np.ptp(x[:, 0]) + 0.6
    return np.concatenate(drawn)


def links(p):
    pairs, first = [], 0
    for name in IN_PLANE:
        x, own = picture(name)
        pairs += [(first + i, first + j) for i, j in own]
        first += len(x)
    return pairs


# gap √1.22 − 0.7, normal and point of the first case, by hand
BY_HAND = (0.40453610171, *(WORLD @ [-0.81482, -0.45268, 0.36214]), *(WORLD @ [0.574072, 0.318929, -0.255143] + AT))


SCENE = Scene(
    title="Distances and contacts", lesson="collisions",
    cases=CASES, **ANSWER,
    runners=RUNNERS,
    start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-13,  # of a linear system with a condition below 100
    quantity_names=quantity_names,
    published_states=((1.0, BY_HAND, 1e-4),),
    points=points, links=links,
    uses=("the shapes of two bodies", "where they are"),
    full_loop="nothing moves here, so there is no loop",
    ablations={
        "motion": "the two scenes of points have continuous detection",
        "finding the pairs": "the scene of pairs",
        "response": "lesson 7 builds it",
    },
)
