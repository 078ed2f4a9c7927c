"""The records of a scene's picture: shapes, poses, points and arrows, without a drawing library."""

import numpy as np

from ..reference.orientation import quaternion


def box(half):
    """Make a box of these half sizes [m] along its own axes."""
    return {"kind": "box", "size": [float(a) for a in half]}


def sphere(r):
    return {"kind": "sphere", "r": float(r)}


def cylinder(r, length):
    """Make a cylinder along its own z."""
    return {"kind": "cylinder", "r": float(r), "length": float(length)}


def capsule(r, length):
    """Make a capsule along its own z; length: distance between the centres of its two half spheres."""
    return {"kind": "capsule", "r": float(r), "length": float(length)}


def cone(r, length):
    """Make a cone along its own z with its tip in the origin: a top on its point."""
    return {"kind": "cone", "r": float(r), "length": float(length)}


def mesh(vertices, triangles):
    """Make a mesh of vertices (n, 3) [m] and triangles (m, 3) of their numbers."""
    return {
        "kind": "mesh",
        "vertices": np.round(np.asarray(vertices, dtype=float), 6).tolist(),
        "triangles": np.asarray(triangles).tolist(),
    }


def seen(tips):
    """Return drawing coordinates (n, 2) of points in space: y right, z up, and x obliquely towards the reader."""
    return np.asarray(tips) @ np.array([[-0.4, -0.3], [1.0, 0.0], [0.0, 1.0]])


def axes_seen(R, p):
    """Return the centre of a body and the tips of its three axes, as points to draw."""
    return seen(np.vstack((np.zeros(3), np.reshape(R, (3, 3)).T)))


def axes_links(p):
    """Return the links of `axes_seen`: from the centre to each tip."""
    return [(0, 1), (0, 2), (0, 3)]


def outlines(corners, count=1, first=0):
    """Return the links of this many closed lines with this many corners each; first: number of the first point."""
    starts = range(first, first + count * corners, corners)
    return [(start + k, start + (k + 1) % corners) for start in starts for k in range(corners)]


def circle(n):
    """Return n points (n, 2) of the unit circle, counter-clockwise from (1, 0)."""
    angles = np.linspace(0.0, 2.0 * np.pi, n + 1)[:-1]
    return np.stack((np.cos(angles), np.sin(angles)), axis=1)


def arms_and_target(arms, target, size):
    """Return points to draw, to 10 µm: the joints and the end of each arm, and a cross of this size at the target."""
    cross = np.asarray(target) + size * np.array([(-1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (1.0, -1.0)])
    return np.round(np.concatenate((*arms, cross)), 5)


def two_arms_and_target_links(n):
    """Return the links of `arms_and_target` for two arms of n links each."""
    cross = 2 * (n + 1)
    arms = [(first + k, first + k + 1) for first in (0, n + 1) for k in range(n)]
    return [*arms, (cross, cross + 1), (cross + 2, cross + 3)]


def pose(x, R):
    """Return the pose (7,) of a body at x with the rotation R, for the 3D player."""
    return np.concatenate((x, quaternion(R)))


def turned_in_place(R, p):
    """Return the poses of one body that has the rotation R and keeps its centre in the origin."""
    return [pose(np.zeros(3), np.reshape(R, (3, 3)))]


def omega_and_L(R, p, reach):
    """Return the arrows of a free body with p.moments() and p.omega() that started at R = 1.

    L = I ω(0) is constant and drawn reach [m] long.  ω is scaled so that its tip stays in the plane normal to L at
    L's tip, because ω · L = 2E is conserved, too.
    """
    R, I = np.reshape(R, (3, 3)), p.moments()
    L, still = I * p.omega(), np.zeros(3)
    return {
        "ω": (still, reach * np.linalg.norm(L) / (L @ p.omega()) * R @ ((R.T @ L) / I)),
        "L": (still, reach * L / np.linalg.norm(L)),
    }
