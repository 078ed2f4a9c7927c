"""A ball made of triangles, or filled with points: convergence of its tensor to that of the ball."""

from functools import lru_cache
from typing import Annotated, NamedTuple

import numpy as np

from validate.check import Whose
from validate.engines.bullet import Bullet
from validate.methods import POINTS, TRIANGLES
from validate.scene import EXACT, PYBULLET, ROUND_OFF, Departure, EngineRun, Prediction, Scene, engine, ours
from validate.scenes._common import check_positives

T = 1.0
STEPS = (1, 2, 5, 10, 20, 50, 100)


class Params(NamedTuple):
    radius: Annotated[float, "[m]"] = 0.5
    density: Annotated[float, "[kg/m³]"] = 1000.0


CASES = {"ball": Params()}


def start(p):
    check_positives(p, "radius", "density")
    return (p,)


@lru_cache(maxsize=32)
def triangles(n, radius):
    """Return corners and triangles of an octahedron with n² triangles per face, all corners moved onto the sphere."""
    number, faces = {}, []

    def corner(i, j, k):
        return number.setdefault((i, j, k), len(number))

    for sx, sy, sz in ((x, y, z) for x in (1, -1) for y in (1, -1) for z in (1, -1)):
        at = lambda i, j, sx=sx, sy=sy, sz=sz: corner(sx * i, sy * j, sz * (n - i - j))
        for i in range(n):
            for j in range(n - i):
                faces.append((at(i, j), at(i + 1, j), at(i, j + 1))[::sx * sy * sz])
                if i + j < n - 1:
                    faces.append((at(i + 1, j), at(i + 1, j + 1), at(i, j + 1))[::sx * sy * sz])
    x = np.array(list(number), dtype=float)
    return radius / np.sqrt(np.sum(x * x, axis=1))[:, None] * x, np.array(faces)


@lru_cache(maxsize=32)
def cells(n, radius, density):
    """Return masses and centres of those cells, 2 radius/n wide, whose centre lies inside the ball."""
    h = 2.0 * radius / n
    middle = h * (np.arange(n) + 0.5) - radius
    x = np.stack(np.meshgrid(middle, middle, middle, indexing="ij"), axis=-1).reshape(-1, 3)
    x = np.ascontiguousarray(x[np.sum(x * x, axis=1) < radius * radius])
    return np.full(len(x), density * h**3), x


def run(lessons, step, acceleration, state, p, dt, steps):
    """Run the lesson's function on triangles or points; these are made beforehand and not timed."""
    if step is lessons.inertia_tensors.mesh_body:
        return step(p.density, *triangles(steps, p.radius))
    return (step(*cells(steps, p.radius, p.density)),)


def observe(state, p):
    """Return all entries of the tensor [kg m²]."""
    return np.ravel(state[-1])


def truth(p, t):
    """I = ⅖ m R² 1,  m = 4/3 π ρ R³

    Source: the volume integral of x² over a ball is 4/15 π R⁵.
    """
    return np.ravel(8.0 / 15.0 * np.pi * p.density * p.radius**5 * np.eye(3))


def limits(p, dt):
    """A body that contains one ball and lies inside another has a moment between theirs.

    The moment of a ball grows with R⁵.

    Triangles: on an octahedron, 1/√3 away, an equilateral triangle of edge √2/n has its corners √2/(n √3) from its
    centre.  After projection onto the sphere, and seen from its middle, they are at most √3 times as far apart:
    within α = √2/n of the direction of the triangle's centre.  So the triangle does not come closer to the middle
    than R cos α: 0 ≤ error ≤ 1 − cos⁵α, of second order.

    Points: a cell that the sphere cuts is within its half diagonal, √3 R/n, of the sphere.  Each cell also lacks its
    own moment, m h²/6, h = 2R/n, compared with ⅖ m R²:  error ≤ (1 + √3/n)⁵ − 1 + 5/(3n²), at worst of first order.
    """
    n = 1.0 / dt
    alpha = min(np.sqrt(2.0) / n, 0.5 * np.pi)
    return {2: 1.0 - np.cos(alpha) ** 5 + 1e-12, 1: (1.0 + np.sqrt(3.0) / n) ** 5 - 1.0 + 5.0 / (3.0 * n * n)}


def round_off(p, dt):
    """pybullet's own rule does not depend on n, so its limit is round-off."""
    return 1e-12


def of_triangles(n, p):
    """Return the moment of inertia of the ball of triangles, 2 ρ ∫ x² dV = ⅔ ρ ∮ x³ n_x dA.

    On a triangle x³ is a cubic, for which weights of 9/20 at the centre, 1/20 at each corner and 2/15 at each
    midpoint of an edge are exact.  The eight faces are alike, so all moments are equal.
    Source: Gauss's theorem; Zienkiewicz, Taylor 2000, volume 1: the cubic rule with seven points.
    """
    corners, faces = triangles(n, p.radius)
    a, b, c = (corners[faces[:, k]] for k in range(3))
    area_x = 0.5 * ((b - a)[:, 1] * (c - a)[:, 2] - (b - a)[:, 2] * (c - a)[:, 1])
    a, b, c = a[:, 0], b[:, 0], c[:, 0]
    mean = 0.45 * ((a + b + c) / 3.0) ** 3 + (a**3 + b**3 + c**3) / 20.0
    mean += ((a + b) ** 3 + (b + c) ** 3 + (c + a) ** 3) / 60.0
    return 2.0 / 3.0 * p.density * np.sum(mean * area_x)


def of_points(n, p):
    """Return the moment of inertia of the ball of points, 2 Σ m x², layer by layer: Gauss's circle problem in each.

    A layer at x has a point for each pair of coordinates with y² + z² < R² − x².
    """
    h = 2.0 * p.radius / n
    squares = (h * (np.arange(n) + 0.5) - p.radius) ** 2
    in_layer = np.searchsorted(np.sort(np.add.outer(squares, squares), axis=None), p.radius**2 - squares)
    return 2.0 * p.density * h**3 * np.sum(squares * in_layer)


def from_ball(moment, p, many):
    """Return the Prediction of a body with this moment about each axis [kg m²], summed from this number of terms."""
    return Prediction(np.ravel(moment * np.eye(3)) - truth(p, T), (many + 30) * ROUND_OFF)


def triangles_from_ball(p, dt):
    """The moment of the body of triangles is known exactly, by Gauss's theorem and a cubic rule.

    It has no products of inertia, because it has the symmetry of a cube.  Only round-off remains, a spacing of
    floats for each triangle.
    """
    n = round(1.0 / dt)
    return from_ball(of_triangles(n, p), p, 8 * n**2)


def points_from_ball(p, dt):
    """The moment of the body of points is known exactly, too, by counting them in layers; it has the same symmetry.

    Only round-off remains, a spacing of floats for each point.
    """
    n = round(1.0 / dt)
    return from_ball(of_points(n, p), p, n**3)


def by_fat_box(p, t):
    """Return m (b² + c²)/12 of the cube around the ball, 6 mm wider.

    pybullet adds its margin of 1 mm three times on each side.

    Source: Bullet, btPolyhedralConvexShape: recalcLocalAabb, getNonvirtualAabb and calculateLocalInertia each add it.
    """
    m, edge = 4.0 / 3.0 * np.pi * p.density * p.radius**3, 2.0 * p.radius + 0.006
    return np.ravel(0.08333333 * m * 2.0 * edge**2 * np.eye(3))


def bullet_make(p, dt):
    """Make the hull of the same corners, with the mass of the ball, in the first step; the other steps do nothing."""
    bullet, made = Bullet(1.0), []
    x = triangles(round(1.0 / dt), p.radius)[0].tolist()
    m = 4.0 / 3.0 * np.pi * p.density * p.radius**3

    def step():
        if not made:
            shape = bullet.pb.createCollisionShape(bullet.pb.GEOM_MESH, vertices=x)
            made.append(bullet.pb.createMultiBody(m, shape))

    def read():
        return np.ravel(np.diag(bullet.pb.getDynamicsInfo(made[0], -1)[2]))

    return EngineRun(step, read, bullet.close)


RUNNERS = (
    ours(TRIANGLES, limit=limits, predicted=triangles_from_ball),
    ours(POINTS, limit=limits, predicted=points_from_ball),
    engine(PYBULLET, "hull", bullet_make, "GEOM_MESH from corners, createMultiBody with the mass of the ball",
           order=EXACT, limit=round_off, predicted="it follows its own rule to round-off, and the limit bounds that",
           departure=Departure("it uses the cube around the hull in place of the hull, and makes that cube 6 mm larger",
                               by_fat_box, Whose.DEFAULT),
           most_steps=20),
)


def points(observed, p):
    """Draw the triangles for n = 4, seen slightly from above."""
    x, _ = triangles(4, p.radius)
    return x @ np.array([[0.8, -0.2], [0.6, 0.25], [0.0, 0.95]])


def links(p):
    faces = triangles(4, p.radius)[1]
    return sorted({tuple(sorted((int(i), int(j)))) for f in faces for i, j in zip(f, np.roll(f, -1))})


SCENE = Scene(
    title="Ball of triangles", lesson="inertia_tensors",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-15,
    moves=False,
    refinement="fineness 1/n [-]: n triangles per quarter of the equator, n points per diameter",
    points=points, links=links,
    uses=("corners and triangles", "or points with masses"),
    full_loop="nothing moves here, so there is no loop",
    ablations={
        "motion": "lesson 5 turns bodies",
        "a density that varies inside": "points can have it, triangles cannot",
    },
)
