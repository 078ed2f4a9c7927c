"""Geometry by brute force: slow, simple, and independent of the lessons."""

import numpy as np
from scipy.optimize import lsq_linear
from scipy.spatial import ConvexHull


def differences(a, b):
    """All a_i − b_j (k m, d): two bodies touch if the hull of these contains 0."""
    return (a[:, None] - b[None]).reshape(-1, a.shape[1])


def not_negative(rows, goal):
    """The x ≥ 0 (n,) with the least |rows x − goal|.

    SciPy's nnls 1.17 stops short of it for some rows, as for differences of points of which three lie on a line.
    *Source:* bounded variables, Stark and Parker 1995.
    """
    return lsq_linear(rows, goal, (0.0, np.inf), method="bvls", tol=1e-15).x


def nearest_to_zero(y):
    """The point (d,) of the hull of y (k, d) that is nearest to 0.

    Least squares of Σ λ y = 0 and Σ λ = 1, with λ = s μ ≥ 0 and Σ μ = 1, minimise s²|Σ μ y|² + (1 − s)².
    Its minimum over s is |Σ μ y|²/(1 + |Σ μ y|²). This grows with |Σ μ y|, so the μ are those of the nearest point.
    """
    size = np.abs(y).max() or 1.0
    weights = not_negative(np.vstack((y.T / size, np.ones(len(y)))), np.append(np.zeros(y.shape[1]), 1.0))
    return weights @ y / weights.sum()


def distance(a, b):
    """Distance [m] of the hulls of a (k, d) and b (m, d); 0 where they overlap."""
    return float(np.linalg.norm(nearest_to_zero(differences(a, b))))


def facets(y):
    """(normals (f, d), offsets (f,)) of the hull of y (k, d): inside the hull, normal · p + offset ≤ 0."""
    equations = ConvexHull(y).equations
    return equations[:, :-1], equations[:, -1]


def outline(points):
    """The corners of the hull of points (k, 2), counter-clockwise."""
    return np.ascontiguousarray(points[ConvexHull(points).vertices])


def area(y):
    """Area [m²] of a polygon (k, 2), counter-clockwise."""
    return 0.5 * float(np.sum(y[:, 0] * np.roll(y[:, 1], -1) - y[:, 1] * np.roll(y[:, 0], -1))) if len(y) else 0.0


def solid(points):
    """(corners (k, 3), faces (f, 3)) of the hull of points, the faces counter-clockwise as seen from outside."""
    hull = ConvexHull(points)
    number = np.full(len(points), -1)
    number[hull.vertices] = np.arange(len(hull.vertices))
    faces, x = number[hull.simplices], points[hull.vertices]
    a, b, c = x[faces[:, 0]], x[faces[:, 1]], x[faces[:, 2]]
    inwards = np.sum(np.cross(b - a, c - a) * hull.equations[:, :3], axis=1) < 0.0
    faces[inwards] = faces[inwards, ::-1]
    return np.ascontiguousarray(x), np.ascontiguousarray(faces, dtype=np.int64)
