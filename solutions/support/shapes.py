"""Given.  Shapes of bodies, their moments of inertia and their outlines."""

from typing import NamedTuple

import numpy as np

from .quaternions import quaternion_from_matrix

FLAT = 1e-9                  # distance from a plane, over the size, at which a corner counts as in it [-]


class Ball(NamedTuple):
    """A ball in space, a disc in the plane."""
    radius: float            # [m]


class Box(NamedTuple):
    """A box whose faces look along the axes of the body."""
    half: tuple              # (d,) half sizes [m]


class Capsule(NamedTuple):
    """All points within a radius of a segment that lies on the first axis of the body, its middle at the centre."""
    half_length: float       # of the segment [m]
    radius: float            # [m]


class Polygon(NamedTuple):
    """A convex polygon in the plane."""
    corners: tuple           # (k, 2) counter-clockwise, from the centre of mass [m]


class Polyhedron(NamedTuple):
    """A convex polyhedron in space.  Make it with polyhedron_of: its axes of inertia are the axes of the body."""
    corners: tuple           # (k, 3) from the centre of mass [m]


class HalfSpace(NamedTuple):
    """All places p of the world with n · p + offset ≤ 0, wherever its body is.  Only for a body that nothing moves."""
    normal: tuple            # (d,) unit vector, out of the half-space
    offset: float = 0.0      # [m]


def moments_of_shape(shape, m, d):
    """Return the moment [kg m²], in space (3,) about the axes of the body, of a shape that is filled evenly.

    *Source:* the integrals of lesson 4.
    """
    if isinstance(shape, Ball):
        return 0.5 * m * shape.radius**2 if d == 2 else (0.4 * m * shape.radius**2,) * 3
    if isinstance(shape, Box):
        squares = np.square(shape.half)
        return m * np.sum(squares) / 3.0 if d == 2 else tuple(m * (np.sum(squares) - squares) / 3.0)
    if isinstance(shape, Capsule):
        return capsule_moment_2d(shape, m) if d == 2 else capsule_moments(shape, m)
    if isinstance(shape, Polyhedron):
        squares = np.diag(solid_integrals(shape.corners)[2])
        return tuple((m * (np.sum(squares) - squares)).tolist())
    return polygon_moment(np.asarray(shape.corners), m)


def capsule_moment_2d(shape, m):
    """Return the moment [kg m²] of a capsule in the plane: a rectangle and two half discs at its ends.

    A half disc of radius r has its centre 4r/(3π) from its straight edge.  About that edge's middle its moment is
    ½ m r², so about the end of the segment; the theorem of parallel axes leads to the centre and on to the middle.
    """
    h, r = shape.half_length, shape.radius
    box, disc = 4.0 * h * r, np.pi * r * r                                       # areas
    density, out = m / (box + disc), 4.0 * r / (3.0 * np.pi)
    return density * (box * (h * h + r * r) / 3.0 + disc * (0.5 * r * r + h * h + 2.0 * h * out))


def capsule_moments(shape, m):
    """Return the moments (3,) [kg m²] of a capsule in space: a cylinder and two half balls at its ends.

    A half ball of radius r has its centre 3r/8 from its flat face, and 2/5 m r² about any axis through the middle of
    that face.
    """
    h, r = shape.half_length, shape.radius
    cylinder, ball = 2.0 * h * np.pi * r * r, 4.0 / 3.0 * np.pi * r**3           # volumes
    density = m / (cylinder + ball)
    along = density * (0.5 * cylinder + 0.4 * ball) * r * r
    across = density * (cylinder * (0.25 * r * r + h * h / 3.0) + ball * (0.4 * r * r + h * h + 0.75 * h * r))
    return along, across, across


def polygon_moment(corners, m):
    """Return the moment [kg m²] of a polygon about the origin, which is its centre: a sum over its triangles."""
    there = np.roll(corners, -1, axis=0)
    twice = corners[:, 0] * there[:, 1] - corners[:, 1] * there[:, 0]            # areas
    squares = np.sum(corners * corners + corners * there + there * there, axis=1)
    return m * np.sum(twice * squares) / (6.0 * np.sum(twice))


def polygon_centre(corners):
    """Return the centre of mass (2,) [m] of a polygon."""
    corners = np.asarray(corners, float)
    there = np.roll(corners, -1, axis=0)
    twice = corners[:, 0] * there[:, 1] - corners[:, 1] * there[:, 0]
    return np.sum((corners + there) * twice[:, None], axis=0) / (3.0 * np.sum(twice))


def hull_triangles(corners):
    """Return triangles (k, 3) of numbers of corners, counter-clockwise from outside, that cover the convex hull.

    A face with more corners is a fan.
    """
    triangles = [(face[0], face[k], face[k + 1]) for face in hull_faces(corners) for k in range(1, len(face) - 1)]
    return np.array(triangles, int).reshape(-1, 3)


def hull_faces(corners):
    """Return the faces of the convex hull: of each the numbers of its corners, counter-clockwise from outside.

    A plane through three corners is a face if all others lie on one side of it.
    """
    corners = np.asarray(corners, float)
    near, faces = FLAT * np.max(np.abs(corners)), {}
    for i, j in pairs_below(len(corners)):
        normals = np.cross(corners[j] - corners[i], corners[j + 1:] - corners[i])
        lengths = np.linalg.norm(normals, axis=1)
        normals = normals[lengths > near * near] / lengths[lengths > near * near, None]
        heights = (corners - corners[i]) @ normals.T                     # of all corners over all planes
        for outward in (-1.0, 1.0):
            for k in np.flatnonzero(np.all(outward * heights <= near, axis=0)):
                on = tuple(np.flatnonzero(np.abs(heights[:, k]) <= near).tolist())
                if on not in faces:
                    faces[on] = in_turn(corners, on, outward * normals[k])
    return list(faces.values())


def pairs_below(n):
    """Return all pairs of numbers below n."""
    return [(i, j) for j in range(n) for i in range(j)]


def in_turn(corners, on, n):
    """Return the numbers `on` of the corners of a face with the outward normal n, counter-clockwise around it."""
    way = corners[list(on)] - np.mean(corners[list(on)], axis=0)
    around = np.arctan2(way @ np.cross(n, way[0]), way @ way[0] * np.linalg.norm(n))
    return [on[k] for k in np.argsort(around)]


def face_planes(corners, faces):
    """Return the planes (k, 4) of faces of a convex polyhedron: rows (n, d) with n · p + d = 0, and n outward."""
    corners, planes = np.asarray(corners, float), []
    for face in faces:
        at = corners[list(face)]
        n = np.sum(np.cross(at[1:-1] - at[0], at[2:] - at[0]), axis=0)
        n = n / np.linalg.norm(n)
        planes.append((*n, -np.mean(at @ n)))
    return np.array(planes).reshape(-1, 4)


def solid_integrals(corners):
    """Return (volume [m³], centre (3,) [m], mean of x xᵀ (3, 3) [m²]) of a convex polyhedron.

    By the divergence theorem it is a sum over tetrahedra from the origin to the triangles of its hull.  One with the
    corners 0, a, b, c has the volume  a · (b × c)/6,  the centre  s/4  and  ∫ x xᵀ = V (a aᵀ + b bᵀ + c cᵀ + s sᵀ)/20,
    with s = a + b + c.  *Source:* lesson 4; Eberly 2002, “Polyhedral mass properties”.
    """
    corners = np.asarray(corners, float)
    volume, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
    for triangle in hull_triangles(corners):
        a, b, c = corners[triangle]
        V, s = a @ np.cross(b, c) / 6.0, a + b + c
        volume, first = volume + V, first + 0.25 * V * s
        second += V / 20.0 * (np.outer(a, a) + np.outer(b, b) + np.outer(c, c) + np.outer(s, s))
    return (volume, first / volume, second / volume) if volume > 0.0 else (0.0, first, second)


def polyhedron_of(places):
    """Return (Polyhedron, x, q) of the convex hull of places (k, 3) [m]: its centre, and its principal axes.

    Places inside the hull are left out.
    """
    middle = np.mean(places, axis=0)
    corners = np.asarray(places, float) - middle
    corners = corners[np.unique(hull_triangles(corners))]
    _, centre, second = solid_integrals(corners)
    axes = np.linalg.eigh(second - np.outer(centre, centre))[1]
    axes[:, 2] *= np.sign(np.linalg.det(axes))
    turned = (corners - centre) @ axes
    return Polyhedron(tuple(map(tuple, turned.tolist()))), centre + middle, quaternion_from_matrix(axes)


def core_of(shape):
    """Return (corners (k, 2), radius) of a shape in the plane: all points within the radius of a convex polygon.

    A disc is one point with a radius, and a capsule is two.
    """
    if isinstance(shape, Ball):
        return np.zeros((1, 2)), shape.radius
    if isinstance(shape, Capsule):
        return np.array([(shape.half_length, 0.0), (-shape.half_length, 0.0)]), shape.radius
    if isinstance(shape, Box):
        return np.array([(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)]) * shape.half, 0.0
    return np.array(shape.corners, float), 0.0


def outline_of(shape, points=24):
    """Return the outline (k, 2) [m] of a shape in the plane, closed, in coordinates of the body; for pictures."""
    corners, radius = core_of(shape)
    if radius > 0.0:
        around = np.linspace(0.0, 2.0 * np.pi, points, endpoint=False)
        out = radius * np.stack((np.cos(around), np.sin(around)), axis=1)
        middle = 0 if len(corners) == 1 else None
        corners = (corners[middle] + out if middle == 0 else
                   np.concatenate([corners[0 if way[0] >= 0.0 else 1][None] + way[None] for way in out]))
    return np.concatenate((corners, corners[:1]))


def size_of(shape):
    """Return the radius [m] of a ball around the centre that contains a shape; ∞ for a half-space."""
    if isinstance(shape, HalfSpace):
        return np.inf
    if isinstance(shape, Ball):
        return shape.radius
    if isinstance(shape, Capsule):
        return shape.half_length + shape.radius
    corners = shape.half if isinstance(shape, Box) else max(shape.corners, key=np.linalg.norm)
    return float(np.linalg.norm(corners))


def inner_radius(shape):
    """Return the radius [m] of the largest ball around the centre that is inside a ball, a polygon or a polyhedron."""
    if isinstance(shape, Ball):
        return shape.radius
    if isinstance(shape, Polyhedron):
        return float(np.min(-face_planes(shape.corners, hull_faces(shape.corners))[:, 3]))
    corners = np.asarray(shape.corners)
    edges = np.roll(corners, -1, axis=0) - corners
    across = corners[:, 0] * edges[:, 1] - corners[:, 1] * edges[:, 0]
    return float(np.min(across / np.hypot(edges[:, 0], edges[:, 1])))
