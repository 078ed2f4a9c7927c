"""Lesson 4: L = I ω, tensors rotate, shift and add as bodies do, and meshes have the right volume integrals."""

import itertools
from collections import Counter

import numpy as np
import pytest
from scipy.spatial import Delaunay

from solutions.checks import BadInput
from validate.grading.expect import between, choice, close, raises, truth
from validate.reference import choices
from validate.reference.choices.inertia_tensors import PULL
from validate.reference.orientation import about

from .brute import solid

exercise = pytest.mark.exercise
# Masses below 5 kg, lengths below 3 m, speeds below 20 m/s, a dozen terms: numbers below 1e3 with round-off 1.1e-16.
ROUNDED = 1e-11
SIZES = (1.0, 1e-30, 1e30)   # of bodies [m]; the ordinary one first, because a student reads of the first that fails


def cloud(draw, n):
    """Masses (n,) [kg] and positions (n, 3) [m] of a few drawn points."""
    return draw(0.5, 3.0, n), draw(-1.5, 1.5, (n, 3))


def tensor(m, r):
    """Σ m (|r|² 1 − r rᵀ) [kg m²]."""
    return sum(k * (y @ y * np.eye(3) - np.outer(y, y)) for k, y in zip(m, r, strict=True))


def rotation(draw):
    """A rotation matrix (3, 3) about a drawn axis, with an angle of 0.5 to 2.5 rad."""
    n, angle = draw(0.2, 1.0, 3), draw(0.5, 2.5)
    return about(n / np.linalg.norm(n), angle)


def sparse_clouds(draw):
    """Masses [kg], positions [m] and velocities [m/s] of 1 to 150 points: on axes, at the origin, at rest; or all."""
    for n in (1, 2, 3, 150):
        m, x, v = draw(0.5, 3.0, n), draw.sparse(-1.5, 1.5, (n, 3)), draw.sparse(-4.0, 4.0, (n, 3))
        yield from ((m, x, v), (m, 0.0 * x, v), (m, x, 0.0 * v), (m, draw(-1.5, 1.5) * np.eye(3)[np.arange(n) % 3], v))


def scales(n):
    """n factors: all are 1, or one of them is 1e-30 or 1e30. A limit in grams or micrometres shows there."""
    yield np.ones(n)
    for k, size in itertools.product(range(n), SIZES[1:]):
        yield np.where(np.arange(n) == k, size, 1.0)


# rotations by none, a third and a half turn, and by a quarter turn about z
AXIS_TURNS = np.stack([np.eye(3), np.roll(np.eye(3), 1, axis=0), np.diag([1.0, -1.0, -1.0]),
                       np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])])


# ---------------------------------------------------------------------------------------------- momenta of points

@exercise("4.1", points=0.5,
          hint="M is the sum of the masses; X is the sum of mass times position over M, not the mean position")
def test_a_body_balances_on_its_centre_of_mass(lesson, draw):
    m, x = cloud(draw, draw.whole(3, 6))
    M, X = lesson.centre_of_mass(m, x)
    close("total mass [kg]", M, sum(m), ROUNDED, f"m = {m}")
    balance = m @ (x - np.asarray(X))
    close("Σ mᵢ (xᵢ − X) [kg m]: gravity exerts no torque about X", balance,
          np.zeros(3), ROUNDED, f"m = {m}, x = {x.tolist()}")
    _, X = lesson.centre_of_mass(m[:1], x[:1])
    close("centre of a single point [m]: that point", X, x[0], ROUNDED, f"x = {x[0]}")
    for masses, points, _ in sparse_clouds(draw):
        M, X = lesson.centre_of_mass(masses, points)
        close("total mass [kg]", M, sum(masses), ROUNDED, f"m = {masses}")
        close("centre of mass [m]", X, sum(k * y for k, y in zip(masses, points, strict=True)) / sum(masses), ROUNDED,
              f"m = {masses}, x = {points.tolist()}")
    hole = np.array([m[0] + m[1], -m[1], 0.0])                           # the sum of its masses is m[0] > 0
    for unit, size in ((1.0, 1.0), (1e-30, 1e30), (1e30, 1e-30)):
        given = f"m = {unit * hole}, x = {(size * x[:3]).tolist()}"
        M, X = lesson.centre_of_mass(unit * hole, size * x[:3])
        close("total mass of a point, a hole and a point of no mass, over its size [-]", M / unit, m[0], ROUNDED, given)
        close("centre of mass of a point, a hole and a point of no mass, over its size [-]", np.asarray(X) / size,
              hole @ x[:3] / m[0], ROUNDED, given)
    # A body of 1 kg that is almost all hole: M is exact, and X is known to 1e-16 kg · 1.5 m over M = 1e-6 kg.
    left = 2.0**-20
    M, X = lesson.centre_of_mass(np.array([1.0, left - 1.0]), x[:2])
    given = f"m = 1 kg and 2^-20 kg − 1 kg, x = {x[:2].tolist()}"
    close("total mass of a body that is almost all hole [kg]", M, left, 0.0, given)
    close("centre of mass of a body that is almost all hole [m]", np.asarray(X) * left, x[0] - (1.0 - left) * x[1],
          1e-14, given)


@exercise("4.1", points=0.5,
          hint='check the sum, not each mass, which may be that of a hole: check_positive("total mass [kg]", M)')
def test_a_body_without_mass_has_no_centre_of_mass(lesson, draw):
    m, x = cloud(draw, 2)
    close("total mass of two points [kg]", lesson.centre_of_mass(m, x)[0], sum(m), ROUNDED, f"m = {m}")
    raises("two masses of 0 kg", BadInput, lesson.centre_of_mass, 0.0 * m, x)
    raises("a mass and its negative: together 0 kg", BadInput, lesson.centre_of_mass, np.array([m[0], -m[0]]), x)
    raises("negative masses", BadInput, lesson.centre_of_mass, -m, x)
    for wrong in (np.nan, np.inf):
        raises(f"a mass of {wrong} kg", BadInput, lesson.centre_of_mass, np.array([m[0], wrong]), x)
    # One point alone is no case of its own.
    for wrong, what in ((0.0, "a single mass of 0 kg"), (-m[0], "a single negative mass"), (np.nan, "a single NaN")):
        raises(what, BadInput, lesson.centre_of_mass, np.array([wrong]), x[:1], naming=[wrong] if wrong < 0.0 else (),
               thing="total mass [kg]")


@exercise("4.2", points=0.5, hint="multiply each velocity by its mass: Σ mᵢ vᵢ, a vector")
def test_linear_momentum_is_the_mass_times_the_velocity_of_the_centre(lesson, draw):
    m, x = cloud(draw, draw.whole(3, 6))
    v, t = draw(-4.0, 4.0, x.shape), 0.5
    moved = (m @ (x + t * v) - m @ x) / t                                # M (X(t) − X(0))/t at constant velocities
    close("P of points with different velocities [kg m/s]", lesson.linear_momentum(m, v),
          moved, ROUNDED, f"m = {m}, v = {v.tolist()}")
    for masses, _, speeds in sparse_clouds(draw):
        close("P of points, some of them at rest [kg m/s]", lesson.linear_momentum(masses, speeds),
              sum(k * y for k, y in zip(masses, speeds, strict=True)), ROUNDED, f"m = {masses}, v = {speeds.tolist()}")
    recoil = np.stack([v[0], -m[0] / m[1] * v[0]])
    close("P after an explosion at rest [kg m/s]", lesson.linear_momentum(m[:2], recoil),
          np.zeros(3), ROUNDED, f"m = {m[:2]}")
    for heavy, (unit, size) in itertools.product((1.0, 0.5, 2.0), scales(2)):
        masses, speeds = unit * np.array([m[0], 0.0, -heavy * m[0]]), size * v[:3]
        close("P of a point, a point of no mass and a hole, over the size of masses and velocities [-]",
              np.asarray(lesson.linear_momentum(masses, speeds)) / unit / size, m[0] * (v[0] - heavy * v[2]), ROUNDED,
              f"m = {masses}, v = {speeds.tolist()}")


@exercise("4.3", points=0.5,
          hint="add up (x − about) × m v of every point: turning about the centre counts, too; the arm comes first")
def test_angular_momentum_of_a_turning_body_is_its_tensor_times_omega(lesson, draw):
    m, x = cloud(draw, draw.whole(3, 6))
    X, omega = m @ x / m.sum(), draw(-3.0, 3.0, 3)
    v = np.cross(omega, x - X)
    given = f"m = {m}, x = {x.tolist()}, ω = {omega}"
    found = lesson.angular_momentum(m, x, v, X)
    close("L about the centre of points that rotate with ω [kg m²/s]: I ω", found, tensor(m, x - X) @ omega, ROUNDED,
          given)
    for heavy, (unit, size, pace) in itertools.product((1.0, 0.5, 2.0), scales(3)):
        masses = unit * np.array([m[0], 0.0, -heavy * m[0]])
        L = np.asarray(lesson.angular_momentum(masses, size * x[:3], pace * v[:3], size * X)) / unit / pace
        expected = m[0] * (np.cross(x[0] - X, v[0]) - heavy * np.cross(x[2] - X, v[2]))
        close("L of a point, a point of no mass and a hole, over the sizes of m, x and v [-]", L / size, expected,
              ROUNDED,
              f"m = {masses}, x = {(size * x[:3]).tolist()}, v = {(pace * v[:3]).tolist()}, about = {size * X}")
    straight = lesson.angular_momentum(m[:1], x[:1], X - x[:1], X)
    close("L of a point that moves straight towards `about` [kg m²/s]", straight, np.zeros(3), ROUNDED, given)


@exercise("4.3", points=0.5,
          hint="the lever arm of each point starts at `about`, not at the origin; `about` itself does not move")
def test_angular_momentum_about_another_point_has_the_arm_of_the_whole_momentum(lesson, draw):
    m, x = cloud(draw, draw.whole(3, 6))
    v, about = draw(-4.0, 4.0, x.shape), draw(-1.5, 1.5, 3)
    X = m @ x / m.sum()
    here, there = lesson.angular_momentum(m, x, v, about), lesson.angular_momentum(m, x, v, X)
    given = f"m = {m}, x = {x.tolist()}, v = {v.tolist()}, about = {about}"
    carried = np.cross(X - about, m @ v)
    close("L about a point − L about the centre [kg m²/s]: (X − about) × P", np.asarray(here) - there,
          carried, ROUNDED, given)
    flight = lesson.angular_momentum(m, x + 0.7 * v, v, about)
    close("L at a later time, each point on its straight line [kg m²/s]: the same", flight, here, ROUNDED, given)
    for m, x, v in sparse_clouds(draw):
        for about in (np.zeros(3), x[-1].copy(), draw.sparse(-1.5, 1.5, 3)):
            arm = x - about
            close("L of points, some of them at rest, at `about`, or on an axis [kg m²/s]",
                  lesson.angular_momentum(m, x, v, about), m @ np.cross(arm, v), ROUNDED,
                  f"m = {m}, x = {x.tolist()}, v = {v.tolist()}, about = {about}")


# ---------------------------------------------------------------------------------------------- tensors

@exercise("4.4", points=1,
          hint="Ixx = Σ m (y² + z²) and Ixy = −Σ m x y, about the origin of r: every entry has the mass, and two "
               "lengths")
def test_tensor_of_points_gives_their_angular_momentum_and_energy(lesson, draw):
    m, r = cloud(draw, draw.whole(3, 6))
    I = np.asarray(lesson.point_mass_inertia(m, r))
    for omega in (*np.eye(3), draw(-3.0, 3.0, 3)):
        v = np.cross(omega, r)
        given = f"m = {m}, r = {r.tolist()}, ω = {omega}"
        close("I ω, compared with Σ r × m v [kg m²/s]", I @ omega, m @ np.cross(r, v), ROUNDED, given)
        energy = 0.5 * m @ np.sum(v * v, axis=1)
        close("½ ω·I ω, compared with Σ ½ m v² [J]", 0.5 * omega @ I @ omega, energy, ROUNDED, given)
    close("I − Iᵀ [kg m²]: symmetric", I - I.T, np.zeros((3, 3)), ROUNDED, f"m = {m}, r = {r.tolist()}")
    for masses, points, _ in sparse_clouds(draw):
        close("I of points on axes, at the reference point, one alone, or many [kg m²]",
              lesson.point_mass_inertia(masses, points), tensor(masses, points), ROUNDED,
              f"m = {masses}, r = {points.tolist()}")
    hole = lesson.point_mass_inertia(np.append(m, -m[0]), np.append(r, r[:1], axis=0))
    close("I with a hole of equal mass at the first point [kg m²]: as without both", hole, tensor(m[1:], r[1:]),
          ROUNDED, f"m = {m}, r = {r.tolist()}")
    for masses in (-m, m - m.mean()):                                    # their sum is negative, or about zero
        for unit, size in scales(2):
            I = np.asarray(lesson.point_mass_inertia(unit * masses, size * r)) / unit / size**2
            close("I of points and holes of which the holes are not lighter, over mass and size squared [-]", I,
                  tensor(masses, r), ROUNDED, f"m = {unit * masses}, r = {(size * r).tolist()}")


@exercise("4.4", points=0.5, hint="a point on the x axis contributes to Iyy and Izz, not to Ixx")
def test_tensor_of_a_dumbbell_along_an_axis(lesson, draw):
    m, d = draw(0.5, 3.0), draw(0.2, 1.5)
    for axis in range(3):
        r = np.array([np.eye(3)[axis], -np.eye(3)[axis]]) * d
        expected = 2.0 * m * d * d * (1.0 - np.eye(3)[axis])
        I = np.asarray(lesson.point_mass_inertia(np.array([m, m]), r))
        close(f"Ixx, Iyy, Izz of two points on the {'xyz'[axis]} axis [kg m²]", np.diag(I),
              expected, ROUNDED, f"m = {m:.4g}, at ±{d:.4g} m")


def by_eight_points(m, size):
    """Tensor of a box: two Gauss points per direction, at ±1/√3 of half an edge, integrate squares exactly."""
    signs = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
    return tensor(np.full(8, m / 8.0), signs * size / np.sqrt(12.0))


@exercise("4.5", points=0.75,
          hint="m/12 times the sum of the squares of the other two edges; "
               "the edges are whole, not half")
def test_tensor_of_a_box_is_its_volume_integral(lesson, draw):
    m, size = draw(0.5, 5.0), draw(0.2, 2.0, 3)
    close("tensor of a box [kg m²]", lesson.box_inertia(m, size),
          by_eight_points(m, size), ROUNDED, f"m = {m:.4g}, size = {size}")
    for small, mass in ((1e-30, 1e30), (1e30, 1e-30)):
        I = np.asarray(lesson.box_inertia(mass * m, small * size)) / mass / small**2
        close("tensor of a very small or large box over its mass and size squared [-]", I, by_eight_points(m, size),
              ROUNDED, f"m = {mass * m:.4g}, size = {small * size}")
    # The moment about an axis does not depend on the edge along it: that of a needle is that of its cross-section.
    # An answer may subtract x² from x² + y² + z²: a round-off of 1e-16/share².
    for axis, share in itertools.product(range(3), (1e-2, 5e-4)):
        edges = np.where(np.arange(3) == axis, 1.0, share) * size
        close("moment of a needle about its own axis, over the square of its thinness [kg m²]",
              np.asarray(lesson.box_inertia(m, edges))[axis, axis] / share**2,
              by_eight_points(m, np.where(np.arange(3) == axis, 0.0, size))[axis, axis], 1e-7,
              f"m = {m:.4g}, size = {edges}")
    parts = draw.sparse(0.2, 2.0, (6, 3))
    for name, edges in (("plate", size * [1.0, 1.0, 0.0]), ("rod", size * [0.0, 1.0, 0.0]),
                        ("cube", size[0] * np.ones(3)), *(("box, a plate or a rod", edges) for edges in parts)):
        close(f"tensor of a {name} [kg m²]", lesson.box_inertia(m, edges), by_eight_points(m, edges), ROUNDED,
              f"m = {m:.4g}, size = {edges}")


@exercise("4.5", points=0.25,
          hint="a negative mass needs no special case: a hole subtracts the tensor of the box")
def test_tensor_of_a_hole_is_the_negative_of_the_box(lesson, draw):
    m, size = draw(0.5, 5.0), draw(0.2, 2.0, 3)
    hole = lesson.box_inertia(-m, size)
    close("tensor of a box-shaped hole [kg m²]", hole,
          -by_eight_points(m, size), ROUNDED, f"m = {m:.4g}, size = {size}")


def by_slices(m, pieces):
    """Tensor of a solid of revolution about z, from pieces [(z_low, z_high, q)], with q(z) the squared radius.

    V = π ∫ q dz,   Izz = ρ π/2 ∫ q² dz,   Ixx = ρ π ∫ (q²/4 + z² q) dz.
    Eight Gauss points integrate these exactly if q is at most quadratic.
    """
    nodes, weights = np.polynomial.legendre.leggauss(8)
    V = zz = xx = 0.0
    for low, high, q in pieces:
        z = 0.5 * (high + low) + 0.5 * (high - low) * nodes
        w = 0.5 * (high - low) * weights
        V = V + np.pi * w @ q(z)
        zz = zz + np.pi / 2.0 * w @ q(z) ** 2
        xx = xx + np.pi * w @ (q(z) ** 2 / 4.0 + z**2 * q(z))
    return m / V * np.diag([xx, xx, zz])


def ball_pieces(r):
    return [(-r, r, lambda z: r * r - z * z)]


def capsule_pieces(r, h):
    return [(-0.5 * h - r, -0.5 * h, lambda z: r * r - (z + 0.5 * h) ** 2),
            (-0.5 * h, 0.5 * h, lambda z: r * r + 0.0 * z),
            (0.5 * h, 0.5 * h + r, lambda z: r * r - (z - 0.5 * h) ** 2)]


@exercise("4.6", points=0.5, hint="two fifths of m R² in all three places of the diagonal, zeros elsewhere")
def test_tensor_of_a_ball_is_its_volume_integral(lesson, draw):
    m, r = draw(0.5, 5.0), draw(0.2, 2.0)
    for mass, what in ((m, "ball"), (-m, "ball-shaped hole")):
        for unit, size in scales(2):
            close(f"tensor of a {what} over its mass and size squared [-]",
                  np.asarray(lesson.sphere_inertia(unit * mass, size * r)) / unit / size**2,
                  by_slices(mass, ball_pieces(r)), ROUNDED, f"m = {unit * mass:.4g}, R = {size * r:.4g}")


@exercise("4.7", points=1, hint="the axis is z: only Izz has ½ m R²; the other two are m (3R² + h²)/12")
def test_tensor_of_a_cylinder_is_its_volume_integral(lesson, draw):
    m, r, h = draw(0.5, 5.0), draw(0.2, 1.0), draw(1.2, 2.0)
    expected = by_slices(m, [(-0.5 * h, 0.5 * h, lambda z: r * r + 0.0 * z)])
    for sign, what in ((1.0, "cylinder"), (-1.0, "cylinder-shaped hole")):
        for unit, size in scales(2):
            given = f"m = {sign * unit * m:.4g}, R = {size * r:.4g}, length = {size * h:.4g}"
            found = np.asarray(lesson.cylinder_inertia(sign * unit * m, size * r, size * h)) / unit / size**2
            close(f"tensor of a {what} over its mass and size squared [-]", found, sign * expected, ROUNDED, given)
    for share in (1e-6, 1e-3, 0.03, 0.9, 30.0, 1e3, 1e6):                # nearly a disc, ..., nearly a rod
        half = 0.5 * share * r
        expected = np.diag(by_slices(m, [(-half, half, lambda z: r * r + 0.0 * z)]))
        close("Ixx, Iyy, Izz of a short or long cylinder over their truth [-]",
              np.diag(np.asarray(lesson.cylinder_inertia(m, r, 2.0 * half))) / expected, np.ones(3), ROUNDED,
              f"m = {m:.4g}, R = {r:.4g}, length = {2.0 * half:.4g}")
    disc = m * r * r * np.diag([0.25, 0.25, 0.5])
    rod = m * h * h / 12.0 * np.diag([1.0, 1.0, 0.0])
    close("tensor of a disc, a cylinder of length 0 [kg m²]", lesson.cylinder_inertia(m, r, 0.0), disc, ROUNDED,
          f"m = {m:.4g}, R = {r:.4g}")
    close("tensor of a rod, a cylinder of radius 0 [kg m²]", lesson.cylinder_inertia(m, 0.0, h), rod, ROUNDED,
          f"m = {m:.4g}, length = {h:.4g}")


@exercise("4.8", points=1,
          hint="the half balls are not balls at ±h/2: their centres are ⅜ R farther out, which gives the term ⅜ h R")
def test_tensor_of_a_capsule_is_its_volume_integral(lesson, draw):
    m, r, h = draw(0.5, 5.0), draw(0.2, 1.0), draw(0.5, 2.0)
    expected = by_slices(m, capsule_pieces(r, h))
    for sign, what in ((1.0, "capsule"), (-1.0, "capsule-shaped hole")):
        for unit, size in scales(2):
            found = np.asarray(lesson.capsule_inertia(sign * unit * m, size * r, size * h)) / unit / size**2
            close(f"tensor of a {what} over its mass and size squared [-]", found, sign * expected, ROUNDED,
                  f"m = {sign * unit * m:.4g}, R = {size * r:.4g}, length = {size * h:.4g}")


@exercise("4.8", points=0.5, hint="for length = 0 the two half balls contain all the mass and form a ball")
def test_a_capsule_without_length_is_a_ball_and_a_long_one_a_rod(lesson, draw):
    m, r = draw(0.5, 5.0), draw(0.2, 1.0)
    ball = 0.4 * m * r * r * np.eye(3)
    close("tensor of a capsule of length 0 [kg m²]", lesson.capsule_inertia(m, r, 0.0),
          ball, ROUNDED, f"m = {m:.4g}, R = {r:.4g}")
    rod = m * r * r / 12.0 * np.diag([1.0, 1.0, 0.0])
    close("tensor of a capsule of radius 0, a rod [kg m²]", lesson.capsule_inertia(m, 0.0, r), rod, ROUNDED,
          f"m = {m:.4g}, length = {r:.4g}")
    # The caps of a thin capsule hold 4/3 R/h of its mass and reach R farther out, so m h²/12 changes by at most 6 R/h.
    h = 1e5 * r
    rod = np.asarray(lesson.capsule_inertia(m, r, h))[0, 0] / (m * h * h / 12.0)
    close("Ixx of a long thin capsule over m h²/12 [-]", rod, 1.0, 6e-5, f"m = {m:.4g}, R = {r:.4g}, length = {h:.4g}")
    for share in (1e-6, 1e-3, 0.03, 30.0, 1e3, 1e6):
        expected = np.diag(by_slices(m, capsule_pieces(r, share * r)))
        found = np.diag(np.asarray(lesson.capsule_inertia(m, r, share * r)))
        close("Ixx, Iyy, Izz of a short or long capsule over their truth [-]", found / expected, np.ones(3), ROUNDED,
              f"m = {m:.4g}, R = {r:.4g}, length = {share * r:.4g}")


# ---------------------------------------------------------------------------------------------- from body to world

@exercise("4.9", points=1, hint="R on the left, Rᵀ on the right: swapped, they rotate the tensor the other way")
def test_the_tensor_turns_with_the_body(lesson, draw):
    m, r = cloud(draw, draw.whole(3, 6))
    R, I_body = rotation(draw), tensor(m, r)
    kept = I_body.copy()
    given = f"m = {m}, r = {r.tolist()}, R = {R.tolist()}"
    close("tensor of points that are rotated by R [kg m²]", lesson.world_inertia(I_body, R),
          tensor(m, r @ R.T), ROUNDED, given)
    close("input I_body after the call: return a new array", I_body, kept, 0.0, given)
    close("tensor of a hole that is rotated by R [kg m²]", lesson.world_inertia(-I_body, R), -tensor(m, r @ R.T),
          ROUNDED, given)
    for size in SIZES[1:]:
        close("tensor of a very small or large body, over its size [-]",
              np.asarray(lesson.world_inertia(size * I_body, R)) / size, tensor(m, r @ R.T), ROUNDED, given)
    for R in (*AXIS_TURNS, rotation(draw), about(np.array([0.0, 0.0, 1.0]), draw(0.5, 2.5))):
        for points in (r, draw.sparse(-1.5, 1.5, r.shape), np.eye(3)[:2], np.concatenate([np.eye(3), -np.eye(3)])):
            masses = np.resize(m, len(points)) if len(points) < 6 else np.ones(6)          # the last one is like a ball
            close("tensor of points on axes that are rotated by R [kg m²]",
                  lesson.world_inertia(tensor(masses, points), R.copy()), tensor(masses, points @ R.T), ROUNDED,
                  f"m = {masses}, r = {points.tolist()}, R = {R.tolist()}")


@exercise("4.10", points=1, hint="invert I_body with `inverse`, then rotate it like any tensor: R first, Rᵀ last")
def test_the_inverse_in_world_axes_turns_l_back_into_omega(lesson, draw):
    m, r = cloud(draw, draw.whole(4, 6))
    # Moments above 1 kg m² make the inverse less than 1. The round-off of I⁻¹ I is 1e-16 times moments below 1e3.
    I_body, R = tensor(m, r) + np.eye(3), rotation(draw)
    I = tensor(m, r @ R.T) + np.eye(3)
    for size in (1.0, 1e-5, 1e-30, 1e30, -1.0):                          # the last one is a hole
        inverse = np.asarray(lesson.world_inverse_inertia(size * I_body, R))
        close("I⁻¹ I in world axes [-]", inverse @ (size * I), np.eye(3), ROUNDED,
              f"I_body = {(size * I_body).tolist()}, R = {R.tolist()}")
    for R in (*AXIS_TURNS, rotation(draw)):
        for moments in (draw(1.0, 3.0, 3), np.array([2.0, 2.0, 3.0]), 2.0 * np.ones(3), np.array([2.0**-10, 1.0, 1.0])):
            close("I⁻¹ in world axes of a body in its principal axes [1/(kg m²)]: over its largest entry",
                  np.asarray(lesson.world_inverse_inertia(np.diag(moments), R.copy())) * moments.min(),
                  sum(moments.min() / k * np.outer(axis, axis) for k, axis in zip(moments, R.T, strict=True)), ROUNDED,
                  f"moments {moments}, R = {R.tolist()}")
    for axis in range(3):                                                # NumPy's error for a singular matrix will do
        raises("the tensor of collinear points, which has no inverse", ValueError, lesson.world_inverse_inertia,
               np.diag(1.0 - np.eye(3)[axis]), np.eye(3))


# ---------------------------------------------------------------------------------------------- composite bodies

@exercise("4.11", points=1,
          hint="add m (|d|² 1 − d dᵀ), the whole tensor of a point of mass m at d, with its off-diagonal entries")
def test_away_from_its_centre_a_body_resists_like_a_point_more(lesson, draw):
    m, r = cloud(draw, draw.whole(3, 6))
    r, M, d = r - m @ r / m.sum(), m.sum(), draw(-1.0, 1.0, 3)
    I = tensor(m, r)
    kept = I.copy()
    given = f"I = {I.tolist()}, m = {M:.4g}, d = {d}"
    moved = lesson.parallel_axes(I, M, d)
    close("tensor about a point at d from the centre [kg m²]", moved, tensor(m, r - d), ROUNDED, given)
    close("tensor moved back to the centre with −m [kg m²]", lesson.parallel_axes(np.array(moved), -M, d), I, ROUNDED,
          given)
    close("input tensor after the call: return a new array", I, kept, 0.0, given)
    for d in (np.zeros(3), *draw(0.2, 1.0) * np.eye(3), *draw.sparse(-1.0, 1.0, (4, 3))):
        given = f"I = {I.tolist()}, m = {M:.4g}, d = {d}"
        close("tensor of a body about its centre, a point on an axis, or in a plane [kg m²]",
              lesson.parallel_axes(I, M, d.copy()), tensor(m, r - d), ROUNDED, given)
        close("tensor of a point of mass [kg m²]", lesson.parallel_axes(np.zeros((3, 3)), M, d.copy()),
              tensor([M], [d]), ROUNDED, f"no I, m = {M:.4g}, d = {d}")
        close("tensor of a body whose holes are as heavy as it is [kg m²]: the same everywhere",
              lesson.parallel_axes(I, 0.0, d.copy()), I, ROUNDED, f"I = {I.tolist()}, m = 0, d = {d}")
    d = draw(-1.0, 1.0, 3)
    given = f"I = {I.tolist()}, m = {M:.4g}, d = {d}"
    for unit, size in scales(2):
        hole = np.asarray(lesson.parallel_axes(-unit * size**2 * I, -unit * M, size * d)) / unit / size**2
        close("tensor of a hole about a point at d from its centre, over its mass and size squared [-]", hole,
              -tensor(m, r - d), ROUNDED, f"mass {unit} kg, size {size} m, its {given}")


@exercise("4.12", points=0.5,
          hint="return MassProperties(M, X, I); shift each tensor from its own centre xᵢ to X, with the mass mᵢ")
def test_combined_parts_equal_the_body_of_all_their_points(lesson, draw):
    clouds = [cloud(draw, n) for n in (draw.whole(3, 4), draw.whole(2, 5), draw.whole(4, 6))]
    # The second one is a hole: heavier than the first part, lighter than all others together.
    for k, share in ((1, -1.5), (2, 2.0)):
        clouds[k] = (share * clouds[0][0].sum() / clouds[k][0].sum() * clouds[k][0], clouds[k][1])
    m = np.array([k.sum() for k, _ in clouds])
    x = np.stack([k @ r / k.sum() for k, r in clouds])
    I = np.stack([tensor(k, r - c) for (k, r), c in zip(clouds, x, strict=True)])
    every_m = np.concatenate([k for k, _ in clouds])
    every_x = np.concatenate([r for _, r in clouds])
    X = every_m @ every_x / every_m.sum()
    for order in ([0, 1, 2], [1, 0, 2], [2, 0, 1]):                      # the hole may come first
        parts = np.ascontiguousarray(m[order]), np.ascontiguousarray(x[order]), np.ascontiguousarray(I[order])
        given = f"m = {parts[0]}, x = {parts[1].tolist()}, I = {parts[2].tolist()}"
        kept = [part.copy() for part in parts]
        found = lesson.combine(*parts)
        found_m, found_x, found_I = found.m, found.x, found.I
        close("mass of three parts, one of them a hole [kg]", found_m, every_m.sum(), ROUNDED, given)
        close("centre of mass of three parts, one of them a hole [m]", found_x, X, ROUNDED, given)
        close("tensor of three parts about their centre [kg m²]", found_I, tensor(every_m, every_x - X),
              10.0 * ROUNDED, given)
        for name, part, before in zip(("masses", "centres", "tensors"), parts, kept, strict=True):
            close(f"input {name} after the call: unchanged", part, before, 0.0, given)
    one = lesson.combine(np.append(m[:1], 0.0), x[:2], I[:2])             # a body without mass has its tensor
    close("tensor of a body and one without mass [kg m²]", one.I, I[0] + I[1], ROUNDED,
          f"m = {m[:1]} and 0, x = {x[:2].tolist()}, I = {I[:2].tolist()}")
    n = len(every_m)
    _, found_x, found_I = lesson.combine(every_m, every_x, np.zeros((n, 3, 3)))
    given = f"m = {every_m}, x = {every_x.tolist()}, no tensors"
    close("centre of mass of bodies without a size [m]", found_x, X, ROUNDED, given)
    close("tensor of bodies without a size about their centre [kg m²]", found_I, tensor(every_m, every_x - X),
          10.0 * ROUNDED, given)
    # Coordinates of a few powers of two, so that x + far has no round-off.  X has one of 1e-10 m, which Σ m (x − X) = 0
    # removes from the tensor.  About the origin of the world, 10 kg would give 10¹³ kg m², with a round-off of 1e-3.
    near, far = np.round(x * 2.0**20) / 2.0**20, np.round(draw(0.5, 1.0, 3) * np.array([1e6, -1e6, 1e6]))
    X = m @ near / m.sum()
    _, found_x, found_I = lesson.combine(m, near + far, I)
    given = f"m = {m}, x = {near.tolist()} and {far}, I = {I.tolist()}"
    close("centre of mass of three parts, 10⁶ m away [m]", np.asarray(found_x) - far, X, 1e-8, given)
    close("tensor of three parts about their centre, 10⁶ m away [kg m²]", found_I,
          np.sum(I, axis=0) + tensor(m, near - X), 1e-7, given)


@exercise("4.12", points=0.25,
          hint="add up all bodies in one loop: one alone, bodies in one place and on an axis are no case of their own")
def test_equal_bodies_on_axes_in_one_place_or_alone_have_the_tensor_of_their_centres_added(lesson, draw):
    own = np.diag([1.0, 2.0, 2.5])
    for m, x, _ in sparse_clouds(draw):
        found, X = lesson.combine(m, x, np.stack([own] * len(m))), m @ x / m.sum()
        given = f"m = {m}, x = {x.tolist()}, each with the moments 1, 2 and 2.5 kg m²"
        close("mass of all [kg]", found.m, m.sum(), ROUNDED, given)
        close("centre of mass of all [m]", found.x, X, ROUNDED, given)
        close("tensor of all about their centre [kg m²]", found.I, tensor(m, x - X) + len(m) * own, 10.0 * ROUNDED,
              given)
    own = np.stack([tensor(*cloud(draw, 3)) for _ in range(3)])
    m, x = cloud(draw, 3)
    for unit, size in scales(2):
        found = lesson.combine(unit * m, size * x, unit * size**2 * own)
        given = f"masses {unit * m}, centres {(size * x).tolist()}, tensors {(unit * size**2 * own).tolist()}"
        close("mass of very small or large bodies, over that of the unit [-]", found.m / unit, m.sum(), ROUNDED, given)
        close("centre of mass of very small or large bodies, over their size [-]", np.asarray(found.x) / size,
              m @ x / m.sum(), ROUNDED, given)
        close("tensor of very small or large bodies, over mass and size squared [-]",
              np.asarray(found.I) / unit / size**2, tensor(m, x - m @ x / m.sum()) + own.sum(axis=0), ROUNDED, given)


@exercise("4.12", points=0.25, hint="centre_of_mass raises BadInput: call it")
def test_parts_without_mass_are_refused(lesson, draw):
    x = draw(-1.0, 1.0, (2, 3))
    I = np.stack([np.eye(3), np.eye(3)])
    m = draw(0.5, 3.0, 2)
    close("mass of two parts [kg]", lesson.combine(m, x, I)[0], sum(m), ROUNDED, f"m = {m}")
    raises("a body and a hole of equal mass: together 0 kg", BadInput, lesson.combine, np.array([1.0, -1.0]), x, I)
    for wrong, what in ((-m, "two holes"), (np.array([m[0], -2.0 * m[0]]), "a hole heavier than the body"),
                        (np.array([m[0], np.nan]), "a mass that is not a number"),
                        (np.array([np.inf, m[1]]), "an infinite mass")):
        raises(what, BadInput, lesson.combine, wrong, x, I)


@exercise("4.13", points=0.5, hint="the columns of R are the axes, in the order of the moments: I R = R diag(moments)")
def test_principal_axes_are_where_l_is_parallel_to_omega(lesson, draw):
    R, moments = rotation(draw), np.sort(draw(1.0, 3.0, 3))
    I = R @ np.diag(moments) @ R.T
    given = f"I = {I.tolist()}"
    found, axes = lesson.principal_axes(I)
    close("principal moments, ascending [kg m²]", found, moments, ROUNDED, given)
    close("R diag(moments) Rᵀ [kg m²]", np.asarray(axes) @ np.diag(found) @ np.asarray(axes).T, I, ROUNDED, given)
    close("Rᵀ R [-]: orthogonal unit vectors", np.asarray(axes).T @ np.asarray(axes), np.eye(3), ROUNDED, given)


@exercise("4.13", points=0.25, hint="if the determinant of R is −1, change the sign of one column")
def test_principal_axes_are_right_handed(lesson, draw):
    tensors = [np.diag([2.0, 1.0, 3.0]), np.diag([1.0, 2.0, 3.0]), np.diag([3.0, 2.0, 1.0]), np.diag([2.0, 3.0, 1.0])]
    tensors += [tensor(*cloud(draw, 5)) for _ in range(8)]
    for I in tensors:
        kept = I.copy()
        _, axes = lesson.principal_axes(I)
        close("determinant of the axes [-]", np.linalg.det(np.asarray(axes)), 1.0, ROUNDED, f"I = {I.tolist()}")
        found = np.asarray(lesson.principal_axes(I)[0])
        close("principal moments, ascending [kg m²]", found, np.sort(found), 0.0, f"I = {I.tolist()}")
        close("R diag(moments) Rᵀ over the largest moment [-]",
              np.asarray(axes) @ np.diag(found) @ np.asarray(axes).T / found.max(), I / found.max(), ROUNDED,
              f"I = {I.tolist()}")
        close("input tensor after the call: unchanged", I, kept, 0.0)


@exercise("4.13", points=0.25,
          hint="moments ascend with their signs: those of a hole are negative. Equal ones allow any orthogonal axes; "
               "equal entries of the diagonal are no equal moments where a product of inertia is not 0")
def test_principal_moments_are_the_roots_of_the_characteristic_polynomial_at_any_size(lesson, draw):
    """det(I − λ) = −λ³ + tr I λ² − ½(tr² I − tr I²) λ + det I. Roots 0.2 apart are known to about 1e-14."""
    low, middle, high = 0.5 + draw(0.0, 0.3), 1.0 + draw(0.0, 0.3), 1.5 + draw(0.0, 0.3)
    for size in (1.0, 1e-30, 1e-6, 1e6, 1e30):
        for moments in ([low, middle, high], [low, middle, middle], [low, low, high], [low, low, low],
                        [0.0, low, low], [0.0, 0.0, 0.0], [1e-9, high, high],         # a rod, nothing, a thin body
                        [-high, -middle, -low], [-middle, -low, high]):               # holes have negative ones
            I = turned(moments, rotation(draw))
            trace, roots = np.trace(I), np.array(moments)
            if len(set(moments)) == 3:
                roots = np.sort(np.roots([1.0, -trace, 0.5 * (trace**2 - np.trace(I @ I)), -np.linalg.det(I)]).real)
            found, axes = lesson.principal_axes(size * I)
            found, axes = np.asarray(found) / size, np.asarray(axes)
            given = f"I = {(size * I).tolist()}"
            close("principal moments over the size [-]", found, roots, ROUNDED, given)
            close("R diag(moments) Rᵀ over the size [-]", axes @ np.diag(found) @ axes.T, I, ROUNDED, given)
            close("first axis × second axis [-]: the third", np.cross(axes[:, 0], axes[:, 1]), axes[:, 2],
                  ROUNDED, given)
    for signs in ((1.0, 1.0, 1.0), (1.0, -1.0, 0.0), (0.0, 1.0, 1.0), *np.eye(3)):       # no ball, and not diagonal
        xy, xz, yz = draw(0.1, 0.3) * np.array(signs)
        I = np.array([[high, xy, xz], [xy, high, yz], [xz, yz, high]])
        found, axes = (np.asarray(part) for part in lesson.principal_axes(I))
        close("R diag(moments) Rᵀ of a body with equal moments about x, y and z [kg m²]",
              axes @ np.diag(found) @ axes.T, I, ROUNDED, f"I = {I.tolist()}")
    for share in (1e-10, 1e-11, 1e-12):                                  # needles, whose small moment is no round-off
        needle = np.array([share * low, middle, high])
        found, _ = lesson.principal_axes(np.diag(needle))
        close("principal moments of a needle [kg m²]", found, needle, 1e-14, f"I = diag {needle.tolist()}")


def turned(moments, R):
    I = R @ np.diag(moments) @ R.T
    return 0.5 * (I + I.T)


ENTRY, ASYMMETRY = "an entry of the inertia tensor [kg m²]", "the asymmetry of an inertia tensor [kg m²]"
SMALLEST, LARGEST = "the smallest principal moment [kg m²]", "the largest principal moment [kg m²]"


@exercise("4.14", points=0.25,
          hint="test in this order: finite, symmetric, smallest moment positive, "
               "largest at most the sum of the others")
def test_impossible_tensors_are_refused(lesson, draw):
    low, middle, R = draw(0.5, 1.0), draw(1.0, 1.5), rotation(draw)
    impossible = {
        "a moment 0.1 % above the sum of the others": turned([low, middle, 1.001 * (low + middle)], R),
        "a negative moment": turned([-low, middle, middle], R),
        "three negative moments": turned([-low, -middle, -middle], R),
        "collinear points: one moment is zero": turned([0.0, middle, middle], np.eye(3)),
        "a tensor of zeros: no mass": np.zeros((3, 3)),
        "NaN": np.diag([low, middle, np.nan]),
        "infinity": np.diag([np.inf, middle, middle]),
        "moments 1, 1 and 1e-15: nearly collinear points": turned([1e-15 * middle, middle, middle], np.eye(3)),
        "a moment 1e-12 above the sum of the others": np.diag([low, middle, (low + middle) * (1.0 + 1e-12)]),
    }
    lesson.check_inertia(np.diag([low, middle, middle]))                 # a possible one passes
    for what, I in impossible.items():
        raises(what, BadInput, lesson.check_inertia, I)
    for i, j in ((0, 1), (0, 2), (2, 1)):
        for size, part in ((1.0, 0.1), (1e-9, 0.1), (1.0, 1e-9)):
            I = size * np.diag([low, middle, middle])
            I[i, j] += part * size
            raises(f"two different entries I{i}{j} and I{j}{i}", BadInput, lesson.check_inertia, I,
                   naming=[part * size], thing=ASYMMETRY)
        for wrong in (np.nan, np.inf, -np.inf):
            for places in ([(i, j), (j, i)], [(i, j)], [(j, i)]):
                I = np.diag([low, middle, middle])
                for place in places:
                    I[place] = wrong
                raises(f"{wrong} off the diagonal", BadInput, lesson.check_inertia, I, thing=ENTRY)
    raises("a negative moment", BadInput, lesson.check_inertia, np.diag([middle, -low, middle]),
           naming=[-low], thing=SMALLEST)
    raises("a moment above the sum of the others", BadInput, lesson.check_inertia, np.diag([low, 3.0 * middle, middle]),
           naming=[3.0 * middle], thing=LARGEST)


@exercise("4.14", points=0.25,
          hint="round-off must not refuse a thin plate, I₃ = I₁ + I₂: allow ε = MOMENT_ROUND_OFF of it")
def test_possible_tensors_pass(lesson, draw):
    low, middle = draw(0.5, 1.0), draw(1.0, 1.5)
    raises("an impossible tensor, with a negative moment", BadInput,
           lesson.check_inertia, np.diag([-low, middle, middle]))
    lesson.check_inertia(np.diag([low, low, low]))
    lesson.check_inertia(np.diag([1e-6 * low, low, low]))                # a needle
    lesson.check_inertia(1e-9 * np.diag([low, middle, low + middle]))    # a small, light plate
    lesson.check_inertia(1e-15 * np.diag([low, middle, middle]))
    for _ in range(20):
        R, size = rotation(draw), 10.0 ** draw(-9.0, 9.0)
        # R I Rᵀ is asymmetric by round-off.
        lesson.check_inertia(size * (R @ np.diag([low, middle, middle]) @ R.T))
        lesson.check_inertia(turned([low, middle, low + middle], rotation(draw)))
        m, r = cloud(draw, 5)
        lesson.check_inertia(tensor(m, r) + 0.01 * np.eye(3))


@exercise("4.14", points=0.25,
          hint="each limit is ε = MOMENT_ROUND_OFF times max|I|, the largest moment, or the sum of the other two")
def test_each_limit_is_epsilon_of_the_size_of_the_tensor(lesson, draw):
    """All tensors are diagonal, so that their moments are known to a few roundings, a hundredth of ε = 1e-14."""
    low, middle = draw(0.5, 1.0), draw(1.0, 1.5)
    for size in (1e-100, 1e-14, 1.0, 1e14, 1e100):
        for shuffle in ([0, 1, 2], [2, 0, 1], [1, 2, 0]):
            def tensor_of(*moments, size=size, shuffle=shuffle):
                return size * np.diag(np.array(moments)[shuffle])
            for share in (1.3, 10.0, 1e4, 1e6):                          # of ε; the trace is about 2 middle
                lesson.check_inertia(tensor_of(share * 1e-14 * middle, middle, middle))
            raises("a moment of half a round-off", BadInput, lesson.check_inertia,
                   tensor_of(0.5e-14 * middle, middle, middle), thing=SMALLEST)
            lesson.check_inertia(tensor_of(low, middle, (low + middle) * (1.0 + 0.7e-14)))
            raises("a moment of half a round-off of the largest", BadInput, lesson.check_inertia,
                   tensor_of(0.5e-14 * 10.0 * middle, middle, 10.0 * middle), thing=SMALLEST)
            raises("a symmetric tensor whose entries are all negative", BadInput, lesson.check_inertia,
                   -size * (np.eye(3) + 0.3 * low), thing=SMALLEST)
            for share in (1.5e-14, 1e-13, 1e-11):
                raises("a moment a little above the sum of the others", BadInput, lesson.check_inertia,
                       tensor_of(low, middle, (low + middle) * (1.0 + share)), thing=LARGEST)
            for part, (i, j) in itertools.product((0.7e-14, 1.2e-14, 1e-11), ((1, 0), (2, 0), (2, 1))):
                I = tensor_of(low, middle, middle)
                I[i, j] = part * size * middle
                if part < 1e-14:
                    lesson.check_inertia(I)
                else:
                    raises("two entries that differ by more than round-off", BadInput, lesson.check_inertia, I,
                           thing=ASYMMETRY)


@exercise("4.14", points=0.25,
          hint="each limit is a fraction of the size of the tensor itself, for small and large bodies alike")
def test_a_tensor_is_possible_exactly_when_its_mass_is_nowhere_below_zero(lesson, draw):
    """∫ x², ∫ y² and ∫ z² dm along the principal axes, (I₂ + I₃ − I₁)/2 and cyclically, are zero or positive."""
    for size in (1e-24, 1e-9, 1.0, 1e9, 1e24):
        for share in (1.0, 0.0, 1e-9, -1e-9, -0.5):
            for k in range(3):
                second = draw(0.1, 2.0, 3)
                second[k] *= share
                I = size * turned(np.sum(second) - second, rotation(draw))
                if share >= 0.0:
                    lesson.check_inertia(I)
                else:
                    raises("a negative ∫ x² dm along an axis", BadInput, lesson.check_inertia, I)
        line = size * np.diag([0.0, 1.0, 1.0])
        crooked = size * np.diag(1.0 + draw(0.0, 0.5, 3))
        crooked[0, 2] += 1e-9 * size
        raises("collinear points: one moment is zero", BadInput, lesson.check_inertia, line)
        raises("an entry that differs from the one across the diagonal", BadInput, lesson.check_inertia, crooked,
               naming=[1e-9 * size])


# ---------------------------------------------------------------------------------------------- triangle meshes

TETRAHEDRON = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


def prism(outline, low, high):
    """Corners and triangles of an upright prism.

    Its outline (k, 2) is counter-clockwise, and all corners are visible from the first.
    """
    k = len(outline)
    x = np.concatenate([np.column_stack([outline, np.full(k, z)]) for z in (low, high)])
    lids = [f for i in range(1, k - 1) for f in ((0, i + 1, i), (k, k + i, k + i + 1))]
    sides = [f for i in range(k) for j in ((i + 1) % k,) for f in ((i, j, k + j), (i, k + j, k + i))]
    return x, np.array(lids + sides)


def box_mesh(size, centre):
    a, b, c = 0.5 * size
    x, faces = prism(np.array([[-a, -b], [a, -b], [a, b], [-a, b]]), -c, c)
    return x + centre, faces


def angle_mesh(a, b, t, height):
    """An L: legs a and b along x and y, both of thickness t. All corners are visible from the first, the inner one."""
    return prism(np.array([[t, t], [t, b], [0.0, b], [0.0, 0.0], [a, 0.0], [a, t]]), 0.0, height)


def of_boxes(boxes):
    """(V, ∫x, ∫x xᵀ) of boxes [(low corner, high corner)]: ∫x² = (h³ − l³)/3, ∫x y = (h² − l²)(k² − j²)/4."""
    V, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
    for low, high in boxes:
        volume, centre = np.prod(high - low), 0.5 * (low + high)
        V, first = V + volume, first + volume * centre
        second = second + volume * (np.outer(centre, centre) + np.diag((high - low) ** 2) / 12.0)
    return V, first, second


def compare_integrals(lesson, what, x, faces, expected, given):
    V, first, second = lesson.mesh_integrals(x, faces)
    close(f"∫dV of {what} [m³]", V, expected[0], ROUNDED, given)
    close(f"∫x dV of {what} [m⁴]", first, expected[1], ROUNDED, given)
    close(f"∫x xᵀ dV of {what} [m⁵]", second, expected[2], ROUNDED, given)


@exercise("4.15", points=0.25,
          hint="w = a · (b × c) is six times the tetrahedron's volume; first and second contain s = a + b + c")
def test_integrals_over_a_tetrahedron_are_those_of_its_corners(lesson, draw):
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    x = corners + draw(-0.2, 0.2, (4, 3)) + draw(-2.0, 2.0, 3)
    V, s = np.linalg.det(x[1:] - x[0]) / 6.0, x.sum(axis=0)
    # Dirichlet: ∫λᵢλⱼ dV = V (1 + δᵢⱼ)/20 in barycentric coordinates
    expected = V, V / 4.0 * s, V / 20.0 * (x.T @ x + np.outer(s, s))
    compare_integrals(lesson, "a tetrahedron away from the origin", x, TETRAHEDRON.copy(), expected,
                      f"corners {x.tolist()}")


@exercise("4.15", points=0.25,
          hint="add all triangles with the sign of w: negative terms cancel the volume outside the body")
def test_integrals_over_boxes_and_an_angle_are_products(lesson, draw):
    size, centre = draw(0.3, 1.5, 3), draw(-2.0, 2.0, 3)
    expected = of_boxes([(centre - 0.5 * size, centre + 0.5 * size)])
    compare_integrals(lesson, "a box", *box_mesh(size, centre), expected, f"size = {size}, centre = {centre}")
    (a, b), t, height = draw(1.0, 1.5, 2), draw(0.2, 0.5), draw(0.3, 1.0)
    x, faces = angle_mesh(a, b, t, height)
    legs = [(np.zeros(3), np.array([a, t, height])), (np.array([0.0, t, 0.0]), np.array([t, b, height]))]
    expected = of_boxes(legs)
    compare_integrals(lesson, "an L, which is not convex", x, faces, expected,
                      f"legs {a:.4g}, {b:.4g}, thickness {t:.4g}, height {height:.4g}")


def of_tetrahedron(x):
    """(V ≥ 0, ∫x, ∫x xᵀ) of a tetrahedron (4, 3); ∫λᵢλⱼ dV = V (1 + δᵢⱼ)/20 in barycentric coordinates (Dirichlet)."""
    V, s = abs(np.linalg.det(x[1:] - x[0])) / 6.0, x.sum(axis=0)
    return V, V / 4.0 * s, V / 20.0 * (x.T @ x + np.outer(s, s))


def added(parts):
    """The weighted sum of integrals [(weight, (V, ∫x, ∫x xᵀ))]."""
    return [sum(share * integrals[k] for share, integrals in parts) for k in range(3)]


def lumps(draw, place):
    """(name, corners, faces, integrals) of random bodies of size 1 at a place [m]: convex, dented, hollow.

    The integrals are sums over the tetrahedra of a Delaunay triangulation.
    """
    x, faces = solid(draw(-0.5, 0.5, (12, 3)) * [1.0, 1.0, draw(0.1, 1.0)] + place)
    whole = added([(1.0, of_tetrahedron(x[t])) for t in Delaunay(x).simplices])
    yield "a lump", x, faces, whole
    centre, corners = whole[1] / whole[0], x[faces[0]]
    tip = draw(0.3, 0.9) * (centre - corners.mean(axis=0)) + corners.mean(axis=0)
    dent = np.array([[faces[0, k], faces[0, (k + 1) % 3], len(x)] for k in range(3)])
    lost = of_tetrahedron(np.concatenate((corners, [tip])))
    dented = added([(1.0, whole), (-1.0, lost)])
    yield "a lump with a dent", np.concatenate((x, [tip])), np.concatenate((faces[1:], dent)), dented
    inner = centre + 0.5 * (x - centre)
    hole = added([(1.0, of_tetrahedron(inner[t])) for t in Delaunay(x).simplices])
    hollow = added([(1.0, whole), (-1.0, hole)])
    yield "a lump with a cavity", np.concatenate((x, inner)), np.concatenate((faces, faces[:, ::-1] + len(x))), hollow
    round_one = draw(-1.0, 1.0, (80, 3))
    x, faces = solid(0.5 * round_one / np.linalg.norm(round_one, axis=1)[:, None] + place)
    yield "a round lump", x, faces, added([(1.0, of_tetrahedron(x[t])) for t in Delaunay(x).simplices])


@exercise("4.15", points=0.5,
          hint="keep every sign: the integrals of a cavity, or of an inside-out mesh, are negative")
def test_integrals_over_lumps_dents_and_cavities_are_those_of_their_tetrahedra(lesson, draw):
    for size in SIZES:
        for far in (0.0, 3.0):
            for name, x, faces, expected in lumps(draw, far * draw(-1.0, 1.0, 3)):
                for what, sign, mesh in ((name, 1.0, faces),
                                         (f"{name} inside-out", -1.0, np.ascontiguousarray(faces[:, ::-1]))):
                    V, first, second = lesson.mesh_integrals(size * x, mesh)
                    given = f"corners {(size * x).tolist()}, triangles {mesh.tolist()}"
                    close(f"∫dV of {what}, over its size [-]", V / size**3, sign * expected[0], ROUNDED, given)
                    close(f"∫x dV of {what}, over its size [-]", np.asarray(first) / size**4, sign * expected[1],
                          ROUNDED, given)
                    close(f"∫x xᵀ dV of {what}, over its size [-]", np.asarray(second) / size**5, sign * expected[2],
                          ROUNDED, given)


NO_CORNER, OPEN = "a triangle's corner", "a corner on an open edge: number"


@exercise("4.16", points=0.25,
          hint="every edge i → j needs an edge j → i, and corners have numbers from 0 to count − 1; a reversed or "
               "repeated triangle violates the first; name a corner of the open edge")
def test_open_and_crooked_meshes_are_refused(lesson, draw):
    x, faces = box_mesh(draw(0.3, 1.5, 3), np.zeros(3))
    k = draw.whole(0, len(faces) - 1)
    crooked = faces.copy()
    crooked[k] = crooked[k, ::-1]
    out_of_range = np.where(faces == len(x) - 1, len(x), faces)
    broken = {"a missing triangle": np.delete(faces, k, axis=0),
              "one reversed triangle": crooked,
              "one repeated triangle": np.concatenate([faces, faces[k:k + 1]]),
              "a tube without lids, though the areas of the rest add up to zero": faces[4:],
              "an index of no corner": out_of_range,
              "a negative index": np.where(faces == 0, -1, faces)}
    lesson.check_closed(len(x), faces)                                   # a closed one passes
    for what, wrong in broken.items():
        raises(what, BadInput, lesson.check_closed, len(x), np.ascontiguousarray(wrong),
               thing=NO_CORNER if "index" in what else OPEN)
    # Edges numbered i · 1 + j, with the number of triangles, would give the same list in both directions.
    raises("a single triangle", BadInput, lesson.check_closed, 3, np.array([[0, 1, 2]]), naming=[0, 1, 2],
           thing=OPEN)
    k = int(np.flatnonzero(np.all(faces > 0, axis=1))[0])
    raises("a missing triangle that does not contain corner 0", BadInput,
           lesson.check_closed, len(x), np.delete(faces, k, axis=0), naming=faces[k].tolist())
    raises("an index of no corner", BadInput,
           lesson.check_closed, len(x), np.where(faces == len(x) - 1, 77, faces), naming=[77],
           thing=NO_CORNER)


@exercise("4.16", points=0.25,
          hint="compare the edges with the reversed edges; the order of the triangles does not matter")
def test_closed_meshes_pass(lesson, draw):
    raises("an open mesh: a tetrahedron without one of its faces", BadInput, lesson.check_closed, 4,
           TETRAHEDRON[1:].copy())
    lesson.check_closed(4, TETRAHEDRON.copy())
    x, faces = box_mesh(draw(0.3, 1.5, 3), np.zeros(3))
    lesson.check_closed(len(x), faces)
    lesson.check_closed(len(x), np.ascontiguousarray(np.roll(faces, draw.whole(1, 5), axis=0)[:, [1, 2, 0]]))
    lesson.check_closed(2 * len(x), np.concatenate([faces, faces + len(x)]))     # two separate bodies
    lesson.check_closed(len(x) + 1, faces)                               # a corner that no triangle uses
    # A triangle with a corner twice has no area, and its edges 0 → 0, 0 → 1, 1 → 0 close.
    lesson.check_closed(4, np.concatenate([TETRAHEDRON, [[0, 0, 1]]]))
    # Two bodies share an edge: it occurs twice in each direction.
    lesson.check_closed(6, np.concatenate([TETRAHEDRON, np.array([0, 1, 4, 5])[TETRAHEDRON]]))


def open_corners(faces):
    """Corners of edges i → j that do not occur as often as j → i."""
    there = Counter((int(f[k]), int(f[(k + 1) % 3])) for f in faces for k in range(3))
    return sorted({corner for i, j in there if there[i, j] != there[j, i] for corner in (i, j)})


@exercise("4.16", points=0.25,
          hint="count every edge i → j and every edge j → i: the counts must be equal for any numbering of the corners")
def test_lumps_are_closed_until_a_triangle_is_lost_turned_doubled_or_misplaced(lesson, draw):
    for name, x, original, _ in lumps(draw, np.zeros(3)):
        count = len(x) + 3                                               # three corners that no triangle uses
        for _ in range(3):
            faces = np.argsort(draw(0.0, 1.0, count))[original]
            roll = draw.whole(0, 2)
            order = np.argsort(draw(0.0, 1.0, len(faces)))
            faces = np.ascontiguousarray(np.roll(faces, roll, axis=1)[order])
            lesson.check_closed(count, faces)
            k = draw.whole(0, len(faces) - 1)
            turned_round, misplaced = faces.copy(), faces.copy()
            turned_round[k] = faces[k, ::-1]
            misplaced[k, 0] = next(c for c in range(count) if c not in faces[k])
            lost, doubled = np.delete(faces, k, axis=0), np.concatenate((faces, faces[k:k + 1]))
            damaged = {"missing": lost, "reversed": turned_round, "repeated": doubled, "misplaced": misplaced}
            for what, broken in damaged.items():
                raises(f"{name} with a {what} triangle", BadInput, lesson.check_closed, count, broken,
                       naming=open_corners(broken))


@exercise("4.17", points=0.25, hint="subtract V c cᵀ before taking the trace: the tensor is about the centre of mass")
def test_a_mesh_has_the_mass_centre_and_tensor_of_its_body(lesson, draw):
    density, size, centre = draw(0.5, 2.0), draw(0.3, 1.5, 3), draw(-2.0, 2.0, 3)
    x, faces = box_mesh(size, centre)
    kept = x.copy()
    m = density * np.prod(size)
    given = f"density = {density:.4g}, size = {size}, centre = {centre}"
    found = lesson.mesh_body(density, x, faces)
    found_m, found_x, found_I = found.m, found.x, found.I
    close("mass of a box [kg]", found_m, m, ROUNDED, given)
    close("centre of mass of a box [m]", found_x, centre, ROUNDED, given)
    close("tensor of a box about its centre [kg m²]", found_I, by_eight_points(m, size), ROUNDED, given)
    close("input corners after the call: return new arrays", x, kept, 0.0, given)

    a, b, c = draw(0.3, 1.5, 3)
    m = density * a * b * c / 6.0
    given = f"density = {density:.4g}, edges {a:.4g}, {b:.4g}, {c:.4g}"
    corners = np.array([[0.0, 0.0, 0.0], [a, 0.0, 0.0], [0.0, b, 0.0], [0.0, 0.0, c]])
    _, found_x, found_I = lesson.mesh_body(density, corners, TETRAHEDRON.copy())
    # For a corner cut off a box ∫x² = V a²/10, ∫x y = V a b/20, and the centre is at a/4:
    # 1/10 − 1/16 = 3/80 and 1/20 − 1/16 = −1/80.
    expected = m / 80.0 * np.array([[3.0 * (b * b + c * c), a * b, a * c], [a * b, 3.0 * (a * a + c * c), b * c],
                                    [a * c, b * c, 3.0 * (a * a + b * b)]])
    close("centre of a corner cut off a box [m]", found_x, [0.25 * a, 0.25 * b, 0.25 * c], ROUNDED, given)
    close("tensor of a corner cut off a box, about its centre [kg m²]", found_I, expected, ROUNDED, given)


@exercise("4.17", points=0.25, hint="integrate relative to a corner, x − x[0], and add x[0] to the centre at the end")
def test_a_mesh_far_from_the_origin_keeps_its_digits(lesson, draw):
    density, size = draw(0.5, 2.0), draw(0.5, 1.5, 3)
    far = np.round(draw(0.5, 1.0, 3) * np.array([1e5, -1e5, 1e5]))
    _, found_x, found_I = lesson.mesh_body(density, *box_mesh(size, far))
    given = f"size = {size}, centre = {far}"
    # A corner 10⁵ m away has a round-off of 7e-12 m, and the tensor of 7 kg one of 4 · 7 kg · 2 m · 7e-12 m.
    # About the origin the tensor would be 7 · 10¹⁰ kg m² with a round-off of 1e-6 kg m² or more.
    close("tensor about the centre, 10⁵ m away [kg m²]", found_I,
          by_eight_points(density * np.prod(size), size), 1e-9, given)
    close("centre of mass, 10⁵ m away [m]", found_x, far, 1e-10, given)


@exercise("4.17", points=0.25,
          hint="check the density, the corners, the edges, then the volume: a negative one means inside-out")
def test_meshes_without_an_inside_are_refused(lesson, draw):
    size = draw(0.3, 1.5, 3)
    x, faces = box_mesh(size, draw(-1.0, 1.0, 3))
    close("mass of a box at 1 kg/m³ [kg]", lesson.mesh_body(1.0, x, faces)[0], np.prod(size), ROUNDED, f"size = {size}")
    for density in (0.0, -1.0, np.nan, np.inf):
        raises(f"density {density} kg/m³", BadInput, lesson.mesh_body, density, x, faces)
    raises("an inside-out mesh", BadInput, lesson.mesh_body, 2.0, x, np.ascontiguousarray(faces[:, ::-1]),
           naming=[-np.prod(size)], thing="the volume inside the mesh [m³]")
    raises("an open mesh", BadInput, lesson.mesh_body, 1.0, x, faces[1:])
    raises("a corner at NaN", BadInput, lesson.mesh_body, 1.0, np.where(x == x[3], np.nan, x), faces)
    for wrong in (np.nan, np.inf):
        raises(f"a corner at {wrong} that no triangle uses", BadInput, lesson.mesh_body, 1.0,
               np.append(x, [[0.0, wrong, 0.0]], axis=0), faces)
    for number in (-1, len(x), 77):
        raises("an index of no corner", BadInput, lesson.mesh_body, 1.0, x,
               np.where(faces == len(x) - 1, number, faces))
    raises("two triangles back to back", BadInput, lesson.mesh_body, 1.0, x, np.array([[0, 1, 2], [0, 2, 1]]))
    # The volume of at least one of these is round-off above zero.
    for _ in range(8):
        flat = np.column_stack([x[:, :2], x[:, :2] @ draw(-0.5, 0.5, 2)])
        raises("a flat box, all corners in one plane", BadInput, lesson.mesh_body, 1.0, flat, faces)
    for size in (1.0, 1e3, 1e6):                                         # the round-off grows with the size
        flat = size * np.column_stack([x[:, :2], x[:, :2] @ draw(-0.5, 0.5, 2)])
        raises("a large flat box", BadInput, lesson.mesh_body, 1.0, flat, faces)


def sheets(draw, share):
    """(corners, faces, volume) of boxes with V = share · ε e³, ε = 1e-14.

    The first corner is at the origin, so there is no round-off. The others are all above it, or all below it.
    """
    for size in SIZES:
        a, b = size * draw(0.3, 1.5, 2)
        edges = np.array([a, b, share * 1e-14 * max(a, b) ** 3 / (a * b)])
        x, faces = box_mesh(edges, 0.5 * edges)
        yield x, faces, np.prod(edges)
        yield -x, np.ascontiguousarray(faces[:, ::-1]), np.prod(edges)


@exercise("4.17", points=0.25,
          hint="compare the volume with ε e³, e the largest of all |x − o|, not with zero")
def test_a_sheet_thinner_than_round_off_has_no_volume(lesson, draw):
    for x, faces, V in sheets(draw, 100.0):
        given = f"corners {x.tolist()}, triangles {faces.tolist()}"
        close("mass of a thin sheet over density and volume [-]", lesson.mesh_body(1.0, x, faces)[0] / V, 1.0, 1e-9,
              given)
    for x, faces, _ in sheets(draw, 0.01):
        raises("a sheet thinner than round-off", BadInput, lesson.mesh_body, 1.0, x, faces)


@exercise("4.17", points=0.25,
          hint="the centre is first/volume, not the mean of the corners; a small body is valid")
def test_a_lump_of_any_size_and_place_has_the_mass_centre_and_tensor_of_its_tetrahedra(lesson, draw):
    for size in SIZES:
        for far in (0.0, 1e3):
            place = far * draw(-1.0, 1.0, 3)
            density = draw(0.5, 2.0) * (1.0 if size == 1.0 else 10.0 ** draw(-6.0, 6.0))
            for name, x, faces, (V, first, second) in lumps(draw, np.zeros(3)):
                mass, centre, I = lesson.mesh_body(density, size * (x + place), faces)
                C = second - np.outer(first, first) / V
                given = f"density {density}, corners {(size * (x + place)).tolist()}, triangles {faces.tolist()}"
                # The round-off of corners a thousand sizes away is 1e-13 sizes.
                close(f"mass of {name} over density and size [-]", mass / density / size**3, V, ROUNDED, given)
                close(f"centre of mass of {name}, relative to its place, over the size [-]",
                      np.asarray(centre) / size - place, first / V, ROUNDED, given)
                close(f"tensor of {name} over density and size [-]", np.asarray(I) / density / size**5,
                      np.trace(C) * np.eye(3) - C, ROUNDED, given)


# ---------------------------------------------------------------------------------------------- why?

@exercise("4.18", points=1, hint="its kinetic energy is ½mv² + ½Iω² with ω = v/R, and all of it comes from the height")
def test_a_body_rolls_down_in_the_time_that_its_forces_give(lesson, draw):
    shares = [*draw(0.1, 1.0, 5), 0.0, 1.0, 0.4, 7.0]
    slopes = [*draw(0.1, 0.6, 3), 1e-2, 3e-4, 0.3, 0.5 * np.pi, 1e-9, 0.3]
    # The smallest bodies have moments of 1e-12 kg m² and less, the largest ones of 1e12 kg m² and more.
    signs = np.array([(1.0, 1.0, 1.0, 1.0), (-1.0, -1.0, 1.0, -1.0), (1.0, -1.0, -1.0, 1.0)])
    for n, (share, slope) in enumerate(zip(shares, slopes, strict=True)):
        m, R, way, g = draw(0.5, 2.0, 4) * 10.0 ** (draw(4.0, 6.0, 4) * signs[n % 3])
        I = share * m * R * R
        # m a + f = m g sin θ,  I a/R = f R: acceleration and friction
        a, _ = np.linalg.solve([[m, 1.0], [I / R, -R]], [m * g * np.sin(slope), 0.0])
        close("time of rolling down, over its truth [-]",
              lesson.rolling_time(I, m, R, way, slope, g) / np.sqrt(2.0 * way / a), 1.0, 1e-12,
              given=f"I/(m R²) = {share:.4g}, m = {m:.4g} kg, R = {R:.4g} m, way = {way:.4g} m, "
              f"slope = {slope:.4g} rad, g = {g:.4g} m/s²")


@exercise("4.19", points=1, hint="the more of its mass lies far from the axis, the more energy goes into the rotation")
def test_the_chosen_body_rolls_as_half_of_its_mass_at_the_rim_would(lesson):
    right = choices.where("inertia_tensors", "four_rollers", lambda t, way: np.allclose(way, PULL * t * t / 3.0))
    choice("the letter of the solid cylinder", lesson.solid_cylinder_is(), right)


@exercise("4.20", points=1, hint="symmetry makes moments equal, and material far from the centre makes them large")
def test_a_mesh_of_ones_own_has_three_large_equal_moments(lesson, draw):
    for volume in draw(0.5, 2.0, 3) * [1.0, 1e-9, 1e9]:
        x, faces = lesson.my_mesh(volume)
        x, faces = np.asarray(x, dtype=float), np.asarray(faces)
        edges = Counter((int(f[k]), int(f[(k + 1) % 3])) for f in faces for k in range(3))
        closed = all(count == 1 and edges.get(edge[::-1]) == 1 for edge, count in edges.items())
        truth("whether each edge belongs to two faces, once in each direction", closed, True)
        filled, moments = volume_and_moments(x, faces)
        between("volume of the mesh over that which was asked for [-]", filled / volume, 0.99, 1.01)
        between("largest over smallest principal moment [-]", moments[2] / moments[0], 1.0, 1.01)
        ball = 0.4 * filled * (0.75 * filled / np.pi) ** (2.0 / 3.0)
        between("smallest moment over that of a ball of the same mass and volume [-]", moments[0] / ball, 1.3, np.inf)


def volume_and_moments(x, faces):
    """Volume and principal moments at density 1, from the tetrahedra of the faces with the origin."""
    corners = x[faces]
    volumes = np.linalg.det(corners) / 6.0
    V, total = volumes.sum(), corners.sum(axis=1)
    c = volumes @ total / (4.0 * V)
    squares = np.einsum("f,fka,fkb->ab", volumes, corners, corners) + np.einsum("f,fa,fb->ab", volumes, total, total)
    spread = squares / 20.0 - V * np.outer(c, c)
    return V, np.linalg.eigvalsh(np.trace(spread) * np.eye(3) - spread)
