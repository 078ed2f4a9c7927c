"""Given.  Shapes of bodies, their moments of inertia and their outlines."""

from typing import NamedTuple

import numpy as np


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
    """Return the radius [m] of the largest ball around the centre that is inside a ball or a polygon."""
    if isinstance(shape, Ball):
        return shape.radius
    corners = np.asarray(shape.corners)
    edges = np.roll(corners, -1, axis=0) - corners
    across = corners[:, 0] * edges[:, 1] - corners[:, 1] * edges[:, 0]
    return float(np.min(across / np.hypot(edges[:, 0], edges[:, 1])))
