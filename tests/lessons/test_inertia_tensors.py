"""Lesson 4 is right when L = I ω, when tensors turn, move and add as bodies do, and when meshes have their volume integrals."""

from collections import Counter

import numpy as np
import pytest
from scipy.spatial import Delaunay

from solutions.checks import BadInput

from .brute import solid
from ..grading.expect import close, raises

exercise = pytest.mark.exercise
# Masses below 5 kg, lengths below 3 m, speeds below 20 m/s, a dozen terms: numbers below 1e3, each rounded by 1.1e-16 of itself
ROUNDED = 1e-11
SIZES = (1e-8, 1.0, 1e3)     # of bodies [m]


def cloud(draw, n):
    """Masses (n,) [kg] and positions (n, 3) [m] of a few points, not two alike."""
    return draw(0.5, 3.0, n), draw(-1.5, 1.5, (n, 3))


def tensor(m, r):
    """Σ m (|r|² 1 − r rᵀ) [kg m²]"""
    return sum(k * (y @ y * np.eye(3) - np.outer(y, y)) for k, y in zip(m, r))


def rotation(draw):
    """A rotation matrix (3, 3) about a drawn axis, by Rodrigues' formula; the angle is neither small nor a half turn."""
    n, angle = draw(0.2, 1.0, 3), draw(0.5, 2.5)
    n /= np.linalg.norm(n)
    K = np.array([[0.0, -n[2], n[1]], [n[2], 0.0, -n[0]], [-n[1], n[0], 0.0]])
    return np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * K @ K


# ---------------------------------------------------------------------------------------------- momenta of points

@exercise("4.1", points=0.5, hint="M is the sum of the masses; X is the sum of mass times position over M, not the mean position")
def test_a_body_balances_on_its_centre_of_mass(lesson, draw):
    m, x = cloud(draw, draw.whole(3, 6))
    M, X = lesson.centre_of_mass(m, x)
    close("total mass [kg]", M, sum(m), ROUNDED, f"m = {m}")
    balance = m @ (x - np.asarray(X))
    close("Σ mᵢ (xᵢ − X): what gravity would turn the body with [kg m]", balance, np.zeros(3), ROUNDED, f"m = {m}, x = {x.tolist()}")
    _, X = lesson.centre_of_mass(m[:1], x[:1])
    close("centre of a single point [m]: the point", X, x[0], ROUNDED, f"x = {x[0]}")
    hole = np.array([m[0] + m[1], -m[1], 0.0])                         # its masses add up to m[0], which is above zero
    for unit in (1e-12, 1.0, 1e12):
        given = f"m = {unit * hole}, x = {x[:3].tolist()}"
        M, X = lesson.centre_of_mass(unit * hole, x[:3])
        close("total mass of a point, a hole and nothing, over its size [-]", M / unit, m[0], ROUNDED, given)
        close("their centre of mass [m]", X, hole @ x[:3] / m[0], ROUNDED, given)


@exercise("4.1", points=0.5, hint='after summing the masses: check_positive("total mass [kg]", M)')
def test_what_has_no_mass_has_no_centre(lesson, draw):
    m, x = cloud(draw, 2)
    close("total mass of what has some [kg]", lesson.centre_of_mass(m, x)[0], sum(m), ROUNDED, f"m = {m}")
    raises("two masses of 0 kg", BadInput, lesson.centre_of_mass, 0.0 * m, x)
    raises("a mass and its negative: together 0 kg", BadInput, lesson.centre_of_mass, np.array([m[0], -m[0]]), x)
    raises("negative masses", BadInput, lesson.centre_of_mass, -m, x)
    for wrong in (np.nan, np.inf):
        raises(f"a mass of {wrong} kg", BadInput, lesson.centre_of_mass, np.array([m[0], wrong]), x)


@exercise("4.2", points=0.5, hint="each velocity counts as much as its mass: Σ mᵢ vᵢ, a vector")
def test_linear_momentum_is_the_mass_times_the_velocity_of_the_centre(lesson, draw):
    m, x = cloud(draw, draw.whole(3, 6))
    v, t = draw(-4.0, 4.0, x.shape), 0.5
    moved = (m @ (x + t * v) - m @ x) / t                        # M (X(t) − X(0))/t, and the velocities are constant
    close("P of points that fly apart [kg m/s]", lesson.linear_momentum(m, v), moved, ROUNDED, f"m = {m}, v = {v.tolist()}")
    recoil = np.stack([v[0], -m[0] / m[1] * v[0]])
    close("P after an explosion at rest [kg m/s]", lesson.linear_momentum(m[:2], recoil), np.zeros(3), ROUNDED, f"m = {m[:2]}")


@exercise("4.3", points=0.5, hint="the arm (x − about) comes first in the cross product, then m v")
def test_angular_momentum_of_a_turning_body_is_its_tensor_times_omega(lesson, draw):
    m, x = cloud(draw, draw.whole(3, 6))
    X, omega = m @ x / m.sum(), draw(-3.0, 3.0, 3)
    v = np.cross(omega, x - X)
    given = f"m = {m}, x = {x.tolist()}, ω = {omega}"
    found, expected = lesson.angular_momentum(m, x, v, X), tensor(m, x - X) @ omega
    close("L about the centre, of points that turn with ω [kg m²/s]: I ω", found, expected, ROUNDED, given)
    straight = lesson.angular_momentum(m[:1], x[:1], X - x[:1], X)
    close("L of one point that flies straight at `about` [kg m²/s]", straight, np.zeros(3), ROUNDED, given)


@exercise("4.3", points=0.5, hint="the arm of each point begins at `about`, not at the origin; `about` itself does not move")
def test_angular_momentum_about_another_point_has_the_arm_of_the_whole_momentum(lesson, draw):
    m, x = cloud(draw, draw.whole(3, 6))
    v, about, X = draw(-4.0, 4.0, x.shape), draw(-1.5, 1.5, 3), m @ x / m.sum()
    here, there = lesson.angular_momentum(m, x, v, about), lesson.angular_momentum(m, x, v, X)
    given = f"m = {m}, x = {x.tolist()}, v = {v.tolist()}, about = {about}"
    carried = np.cross(X - about, m @ v)
    close("L about a point − L about the centre [kg m²/s]: (X − about) × P", np.asarray(here) - there, carried, ROUNDED, given)
    flight = lesson.angular_momentum(m, x + 0.7 * v, v, about)
    close("L a while later, each point on its straight line [kg m²/s]: the same", flight, here, ROUNDED, given)


# ---------------------------------------------------------------------------------------------- tensors

@exercise("4.4", points=1, hint="off the diagonal stands −Σ m x y: with the plus sign I ω is not the angular momentum")
def test_tensor_of_points_gives_their_angular_momentum_and_energy(lesson, draw):
    m, r = cloud(draw, draw.whole(3, 6))
    I = np.asarray(lesson.point_mass_inertia(m, r))
    for omega in (*np.eye(3), draw(-3.0, 3.0, 3)):
        v = np.cross(omega, r)
        given = f"m = {m}, r = {r.tolist()}, ω = {omega}"
        close("I ω, against Σ r × m v [kg m²/s]", I @ omega, m @ np.cross(r, v), ROUNDED, given)
        close("½ ω·I ω, against Σ ½ m v² [J]", 0.5 * omega @ I @ omega, 0.5 * m @ np.sum(v * v, axis=1), ROUNDED, given)
    close("I − Iᵀ [kg m²]: symmetric", I - I.T, np.zeros((3, 3)), ROUNDED, f"m = {m}, r = {r.tolist()}")
    hole = lesson.point_mass_inertia(np.append(m, -m[0]), np.append(r, r[:1], axis=0))
    close("I with a hole, as heavy, at the first point [kg m²]: as without the two", hole, tensor(m[1:], r[1:]),
          ROUNDED, f"m = {m}, r = {r.tolist()}")


@exercise("4.4", points=0.5, hint="a point on the x axis resists about y and z, not about x")
def test_tensor_of_a_dumbbell_along_an_axis(lesson, draw):
    m, d = draw(0.5, 3.0), draw(0.2, 1.5)
    for axis in range(3):
        r = np.array([np.eye(3)[axis], -np.eye(3)[axis]]) * d
        expected = 2.0 * m * d * d * (1.0 - np.eye(3)[axis])
        I = np.asarray(lesson.point_mass_inertia(np.array([m, m]), r))
        close(f"Ixx, Iyy, Izz of two points on the {'xyz'[axis]} axis [kg m²]", np.diag(I), expected, ROUNDED, f"m = {m:.4g}, at ±{d:.4g} m")


def by_eight_points(m, size):
    """Tensor of a box: Gauss's two points in each direction, ±1/√3 of half an edge, integrate squares exactly."""
    signs = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
    return tensor(np.full(8, m / 8.0), signs * size / np.sqrt(12.0))


@exercise("4.5", points=0.75, hint="m/12 times the sum of the squares of the two edges that are not along that axis; edges are whole, not half")
def test_tensor_of_a_box_is_its_volume_integral(lesson, draw):
    m, size = draw(0.5, 5.0), draw(0.2, 2.0, 3)
    close("tensor of a box [kg m²]", lesson.box_inertia(m, size), by_eight_points(m, size), ROUNDED, f"m = {m:.4g}, size = {size}")


@exercise("4.5", points=0.25, hint="nothing in the formula minds a negative mass: a hole takes away what the box would have had")
def test_tensor_of_a_hole_is_the_negative_of_the_box(lesson, draw):
    m, size = draw(0.5, 5.0), draw(0.2, 2.0, 3)
    hole = lesson.box_inertia(-m, size)
    close("tensor of a hole of box shape [kg m²]", hole, -by_eight_points(m, size), ROUNDED, f"m = {m:.4g}, size = {size}")


def by_slices(m, pieces):
    """Tensor of a solid of revolution about z: slices of squared radius q(z), pieces = [(z_low, z_high, q)], q at most quadratic.

    V = π ∫ q dz,   Izz = ρ π/2 ∫ q² dz,   Ixx = ρ π ∫ (q²/4 + z² q) dz: eight Gauss points integrate these exactly.
    """
    nodes, weights = np.polynomial.legendre.leggauss(8)
    V = zz = xx = 0.0
    for low, high, q in pieces:
        z, w = 0.5 * (high + low) + 0.5 * (high - low) * nodes, 0.5 * (high - low) * weights
        V, zz, xx = V + np.pi * w @ q(z), zz + np.pi / 2.0 * w @ q(z) ** 2, xx + np.pi * w @ (q(z) ** 2 / 4.0 + z**2 * q(z))
    return m / V * np.diag([xx, xx, zz])


def ball_pieces(r):
    return [(-r, r, lambda z: r * r - z * z)]


def capsule_pieces(r, h):
    return [(-0.5 * h - r, -0.5 * h, lambda z: r * r - (z + 0.5 * h) ** 2), (-0.5 * h, 0.5 * h, lambda z: r * r + 0.0 * z),
            (0.5 * h, 0.5 * h + r, lambda z: r * r - (z - 0.5 * h) ** 2)]


@exercise("4.6", points=0.5, hint="two fifths of m R², the same on all three places of the diagonal, zeros elsewhere")
def test_tensor_of_a_ball_is_its_volume_integral(lesson, draw):
    m, r = draw(0.5, 5.0), draw(0.2, 2.0)
    for mass, what in ((m, "ball"), (-m, "hole of ball shape")):
        close(f"tensor of a {what} [kg m²]", lesson.sphere_inertia(mass, r), by_slices(mass, ball_pieces(r)), ROUNDED,
              f"m = {mass:.4g}, R = {r:.4g}")


@exercise("4.7", points=1, hint="the axis is z: only Izz has ½ m R²; across it, m (3R² + h²)/12")
def test_tensor_of_a_cylinder_is_its_volume_integral(lesson, draw):
    m, r, h = draw(0.5, 5.0), draw(0.2, 1.0), draw(1.2, 2.0)
    expected = by_slices(m, [(-0.5 * h, 0.5 * h, lambda z: r * r + 0.0 * z)])
    for sign, what in ((1.0, "cylinder"), (-1.0, "hole of cylinder shape")):
        given = f"m = {sign * m:.4g}, R = {r:.4g}, length = {h:.4g}"
        close(f"tensor of a {what} [kg m²]", lesson.cylinder_inertia(sign * m, r, h), sign * expected, ROUNDED, given)
    disc, rod = m * r * r * np.diag([0.25, 0.25, 0.5]), m * h * h / 12.0 * np.diag([1.0, 1.0, 0.0])
    close("tensor of a disc, a cylinder of length 0 [kg m²]", lesson.cylinder_inertia(m, r, 0.0), disc, ROUNDED,
          f"m = {m:.4g}, R = {r:.4g}")
    close("tensor of a rod, a cylinder of radius 0 [kg m²]", lesson.cylinder_inertia(m, 0.0, h), rod, ROUNDED,
          f"m = {m:.4g}, length = {h:.4g}")


@exercise("4.8", points=1, hint="the half balls are not balls at ±h/2: their centres are ⅜ R further out, which gives the term ⅜ h R")
def test_tensor_of_a_capsule_is_its_volume_integral(lesson, draw):
    m, r, h = draw(0.5, 5.0), draw(0.2, 1.0), draw(0.5, 2.0)
    expected = by_slices(m, capsule_pieces(r, h))
    for sign, what in ((1.0, "capsule"), (-1.0, "hole of capsule shape")):
        for size in (1e-12, 1.0, 1e6):
            found = np.asarray(lesson.capsule_inertia(sign * m, size * r, size * h)) / size**2
            close(f"tensor of a {what} over its size squared [kg]", found, sign * expected, ROUNDED,
                  f"m = {sign * m:.4g}, R = {size * r:.4g}, length = {size * h:.4g}")


@exercise("4.8", points=0.5, hint="with length = 0 all mass is in the two half balls, and they make a ball")
def test_a_capsule_without_length_is_a_ball_and_a_long_one_a_rod(lesson, draw):
    m, r = draw(0.5, 5.0), draw(0.2, 1.0)
    ball = 0.4 * m * r * r * np.eye(3)
    close("tensor of a capsule of length 0 [kg m²]", lesson.capsule_inertia(m, r, 0.0), ball, ROUNDED, f"m = {m:.4g}, R = {r:.4g}")
    rod = m * r * r / 12.0 * np.diag([1.0, 1.0, 0.0])
    close("tensor of a capsule of radius 0, a rod [kg m²]", lesson.capsule_inertia(m, 0.0, r), rod, ROUNDED,
          f"m = {m:.4g}, length = {r:.4g}")
    # a thin one: the caps hold 4/3 R/h of the mass and reach R further out, which moves m h²/12 by less than 6 R/h of itself
    h = 1e5 * r
    rod = np.asarray(lesson.capsule_inertia(m, r, h))[0, 0] / (m * h * h / 12.0)
    close("Ixx of a long thin capsule over m h²/12 [-]", rod, 1.0, 6e-5, f"m = {m:.4g}, R = {r:.4g}, length = {h:.4g}")


# ---------------------------------------------------------------------------------------------- from body to world

@exercise("4.9", points=1, hint="R on the left, Rᵀ on the right: swapped, the body would turn the other way")
def test_the_tensor_turns_with_the_body(lesson, draw):
    m, r = cloud(draw, draw.whole(3, 6))
    R, I_body = rotation(draw), tensor(m, r)
    kept = I_body.copy()
    given = f"m = {m}, r = {r.tolist()}, R = {R.tolist()}"
    close("tensor of points that are turned by R [kg m²]", lesson.world_inertia(I_body, R), tensor(m, r @ R.T), ROUNDED, given)
    close("the I_body that was handed in: return a new array", I_body, kept, 0.0, given)


@exercise("4.10", points=1, hint="invert I_body with `inverse`, then turn it like any tensor: R first, Rᵀ last")
def test_the_inverse_in_world_axes_turns_l_back_into_omega(lesson, draw):
    m, r = cloud(draw, draw.whole(4, 6))
    # a tensor with moments above 1 kg m²: its inverse is below 1, and I⁻¹ I is rounded by 1e-16 times moments below 1e3
    I_body, R = tensor(m, r) + np.eye(3), rotation(draw)
    I = tensor(m, r @ R.T) + np.eye(3)
    for size in (1e-30, 1e-5, 1.0, 1e30):
        inverse = np.asarray(lesson.world_inverse_inertia(size * I_body, R))
        close("I⁻¹ I in world axes [-]", inverse @ (size * I), np.eye(3), ROUNDED,
              f"I_body = {(size * I_body).tolist()}, R = {R.tolist()}")
    for axis in range(3):                                              # NumPy's own error for a singular matrix will do
        raises("a line of points, which has no inverse", ValueError, lesson.world_inverse_inertia,
               np.diag(1.0 - np.eye(3)[axis]), np.eye(3))


# ---------------------------------------------------------------------------------------------- composite bodies

@exercise("4.11", points=1, hint="add m (|d|² 1 − d dᵀ): the tensor of a point of mass m at d, off-diagonal entries and all")
def test_away_from_its_centre_a_body_resists_like_a_point_more(lesson, draw):
    m, r = cloud(draw, draw.whole(3, 6))
    r, M, d = r - m @ r / m.sum(), m.sum(), draw(-1.0, 1.0, 3)
    I = tensor(m, r)
    kept = I.copy()
    given = f"I = {I.tolist()}, m = {M:.4g}, d = {d}"
    moved = lesson.parallel_axes(I, M, d)
    close("tensor about a point at d from the centre [kg m²]", moved, tensor(m, r - d), ROUNDED, given)
    close("and back to the centre with −m [kg m²]", lesson.parallel_axes(np.array(moved), -M, d), I, ROUNDED, given)
    close("the tensor that was handed in: return a new array", I, kept, 0.0, given)


@exercise("4.12", points=1, hint="each tensor is carried from its own centre xᵢ to the common one: the offset is xᵢ − X, the mass mᵢ")
def test_parts_make_the_body_that_their_points_make(lesson, draw):
    clouds = [cloud(draw, n) for n in (draw.whole(3, 4), draw.whole(2, 5), draw.whole(4, 6))]
    clouds[1] = (-0.2 * clouds[1][0], clouds[1][1])                    # a hole: less mass than the others have
    m = np.array([k.sum() for k, _ in clouds])
    x = np.stack([k @ r / k.sum() for k, r in clouds])
    I = np.stack([tensor(k, r - c) for (k, r), c in zip(clouds, x)])
    every_m, every_x = np.concatenate([k for k, _ in clouds]), np.concatenate([r for _, r in clouds])
    X = every_m @ every_x / every_m.sum()
    given = f"m = {m}, x = {x.tolist()}, I = {I.tolist()}"
    found_m, found_x, found_I = lesson.combine(m, x, I)
    close("mass of three parts, one of them a hole [kg]", found_m, every_m.sum(), ROUNDED, given)
    close("their centre of mass [m]", found_x, X, ROUNDED, given)
    close("their tensor about it [kg m²]", found_I, tensor(every_m, every_x - X), 10.0 * ROUNDED, given)


@exercise("4.12", points=0.5, hint="centre_of_mass raises BadInput for you: call it")
def test_parts_without_mass_are_refused(lesson, draw):
    x, I, m = draw(-1.0, 1.0, (2, 3)), np.stack([np.eye(3), np.eye(3)]), draw(0.5, 3.0, 2)
    close("mass of two parts that have some [kg]", lesson.combine(m, x, I)[0], sum(m), ROUNDED, f"m = {m}")
    raises("a body and a hole as heavy: together 0 kg", BadInput, lesson.combine, np.array([1.0, -1.0]), x, I)


@exercise("4.13", points=0.75, hint="the columns of R are the axes, in the order of the moments: I R = R diag(moments)")
def test_principal_axes_are_where_l_is_parallel_to_omega(lesson, draw):
    R, moments = rotation(draw), np.sort(draw(1.0, 3.0, 3))
    I = R @ np.diag(moments) @ R.T
    given = f"I = {I.tolist()}"
    found, axes = lesson.principal_axes(I)
    close("principal moments, ascending [kg m²]", found, moments, ROUNDED, given)
    close("R diag(moments) Rᵀ [kg m²]", np.asarray(axes) @ np.diag(found) @ np.asarray(axes).T, I, ROUNDED, given)
    close("Rᵀ R [-]: unit vectors, across each other", np.asarray(axes).T @ np.asarray(axes), np.eye(3), ROUNDED, given)


@exercise("4.13", points=0.25, hint="when the determinant of R is −1, change the sign of a column")
def test_principal_axes_are_right_handed(lesson, draw):
    tensors = [np.diag([2.0, 1.0, 3.0]), np.diag([1.0, 2.0, 3.0]), np.diag([3.0, 2.0, 1.0]), np.diag([2.0, 3.0, 1.0])]
    tensors += [tensor(*cloud(draw, 5)) for _ in range(8)]
    for I in tensors:
        kept = I.copy()
        _, axes = lesson.principal_axes(I)
        close("determinant of the axes [-]", np.linalg.det(np.asarray(axes)), 1.0, ROUNDED, f"I = {I.tolist()}")
        found = np.asarray(lesson.principal_axes(I)[0])
        close("principal moments, in their order [kg m²]", found, np.sort(found), 0.0, f"I = {I.tolist()}")
        close("R diag(moments) Rᵀ over the largest [-]", np.asarray(axes) @ np.diag(found) @ np.asarray(axes).T / found.max(), I / found.max(), ROUNDED, f"I = {I.tolist()}")
        close("the tensor that was handed in", I, kept, 0.0)


@exercise("4.13", points=0.5,
          hint="of equal moments many axes are right, but all are right-handed unit vectors across each other")
def test_principal_moments_are_the_roots_of_the_characteristic_polynomial_at_any_size(lesson, draw):
    """det(I − λ) = −λ³ + tr I λ² − ½(tr² I − tr I²) λ + det I.  Roots 0.2 apart are known to about 1e-14."""
    low, middle, high = 0.5 + draw(0.0, 0.3), 1.0 + draw(0.0, 0.3), 1.5 + draw(0.0, 0.3)
    for size in (1e-30, 1e-6, 1.0, 1e6, 1e30):
        for moments in ([low, middle, high], [low, middle, middle], [low, low, high], [low, low, low]):
            I = turned(moments, rotation(draw))
            trace, roots = np.trace(I), np.array(moments)
            if len(set(moments)) == 3:
                roots = np.sort(np.roots([1.0, -trace, 0.5 * (trace**2 - np.trace(I @ I)), -np.linalg.det(I)]).real)
            found, axes = lesson.principal_axes(size * I)
            found, axes, given = np.asarray(found) / size, np.asarray(axes), f"I = {(size * I).tolist()}"
            close("principal moments over the size [-]", found, roots, ROUNDED, given)
            close("R diag(moments) Rᵀ over the size [-]", axes @ np.diag(found) @ axes.T, I, ROUNDED, given)
            close("axes in turn: first × second is the third [-]", np.cross(axes[:, 0], axes[:, 1]), axes[:, 2],
                  ROUNDED, given)


def turned(moments, R):
    I = R @ np.diag(moments) @ R.T
    return 0.5 * (I + I.T)


ENTRY, ASYMMETRY = "an entry of the inertia tensor [kg m²]", "the asymmetry of an inertia tensor [kg m²]"
SMALLEST, LARGEST = "the smallest principal moment [kg m²]", "the largest principal moment [kg m²]"


@exercise("4.14", points=0.25,
          hint="in this order: finite, symmetric, smallest moment above zero, largest no more than the sum of the others")
def test_impossible_tensors_are_refused(lesson, draw):
    low, middle, R = draw(0.5, 1.0), draw(1.0, 1.5), rotation(draw)
    impossible = {
        "a moment 0.1 % above the sum of the others": turned([low, middle, 1.001 * (low + middle)], R),
        "a negative moment": turned([-low, middle, middle], R), "three negative moments": turned([-low, -middle, -middle], R),
        "a line of points: no moment about itself": turned([0.0, middle, middle], np.eye(3)),
        "a tensor of zeros: no mass": np.zeros((3, 3)),
        "NaN": np.diag([low, middle, np.nan]), "infinity": np.diag([np.inf, middle, middle]),
        "moments 1, 1 and 1e-15: nearly a line": turned([1e-15 * middle, middle, middle], np.eye(3)),
        "a moment 1e-12 above the sum of the others": np.diag([low, middle, (low + middle) * (1.0 + 1e-12)]),
    }
    lesson.check_inertia(np.diag([low, middle, middle]))               # a possible one passes
    for what, I in impossible.items():
        raises(what, BadInput, lesson.check_inertia, I)
    for i, j in ((0, 1), (0, 2), (2, 1)):
        for size, part in ((1.0, 0.1), (1e-9, 0.1), (1.0, 1e-9)):
            I = size * np.diag([low, middle, middle])
            I[i, j] += part * size
            raises(f"two different entries I{i}{j} and I{j}{i}", BadInput, lesson.check_inertia, I,
                   naming=[part * size], thing=ASYMMETRY)
        for wrong in (np.nan, np.inf, -np.inf):
            I = np.diag([low, middle, middle])
            I[i, j] = I[j, i] = wrong
            raises(f"{wrong} off the diagonal", BadInput, lesson.check_inertia, I, thing=ENTRY)
    raises("a negative moment", BadInput, lesson.check_inertia, np.diag([middle, -low, middle]),
           naming=[-low], thing=SMALLEST)
    raises("a moment above the sum of the others", BadInput, lesson.check_inertia, np.diag([low, 3.0 * middle, middle]),
           naming=[3.0 * middle], thing=LARGEST)


@exercise("4.14", points=0.25,
          hint="round-off must not condemn a thin plate, I₃ = I₁ + I₂: allow ε = TENSOR_ROUND_OFF of it")
def test_possible_tensors_pass(lesson, draw):
    low, middle = draw(0.5, 1.0), draw(1.0, 1.5)
    raises("an impossible tensor, with a negative moment", BadInput, lesson.check_inertia, np.diag([-low, middle, middle]))
    lesson.check_inertia(np.diag([low, low, low]))
    lesson.check_inertia(np.diag([1e-6 * low, low, low]))              # a needle
    lesson.check_inertia(1e-9 * np.diag([low, middle, low + middle]))  # a plate, small and light
    lesson.check_inertia(1e-15 * np.diag([low, middle, middle]))
    for _ in range(20):
        R, size = rotation(draw), 10.0 ** draw(-9.0, 9.0)
        lesson.check_inertia(size * (R @ np.diag([low, middle, middle]) @ R.T))          # asymmetric by the round-off of its size
        lesson.check_inertia(turned([low, middle, low + middle], rotation(draw)))
        m, r = cloud(draw, 5)
        lesson.check_inertia(tensor(m, r) + 0.01 * np.eye(3))


@exercise("4.14", points=0.5,
          hint="each limit is a share of the tensor's own size: as strict for a bacterium as for a ship")
def test_a_tensor_is_possible_exactly_when_its_mass_is_nowhere_below_zero(lesson, draw):
    """∫ x², ∫ y², ∫ z² dm along the principal axes, (I₂ + I₃ − I₁)/2 and so on, are not negative; one may be zero."""
    for size in (1e-24, 1e-9, 1.0, 1e9, 1e24):
        for share in (1.0, 0.0, 1e-9, -1e-9, -0.5):
            for k in range(3):
                second = draw(0.1, 2.0, 3)
                second[k] *= share
                I = size * turned(np.sum(second) - second, rotation(draw))
                if share >= 0.0:
                    lesson.check_inertia(I)
                else:
                    raises("less than no mass along an axis", BadInput, lesson.check_inertia, I)
        line, crooked = size * np.diag([0.0, 1.0, 1.0]), size * np.diag(1.0 + draw(0.0, 0.5, 3))
        crooked[0, 2] += 1e-9 * size
        raises("a line of points: no moment about itself", BadInput, lesson.check_inertia, line)
        raises("an entry unlike the one across the diagonal", BadInput, lesson.check_inertia, crooked,
               naming=[1e-9 * size])


# ---------------------------------------------------------------------------------------------- triangle meshes

TETRAHEDRON = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


def prism(outline, low, high):
    """Corners and triangles of an upright prism; its outline (k, 2) is counter-clockwise, and its first corner sees all the others."""
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
    """An L: legs a and b along x and y, both of thickness t.  The inner corner comes first: it sees all the others."""
    return prism(np.array([[t, t], [t, b], [0.0, b], [0.0, 0.0], [a, 0.0], [a, t]]), 0.0, height)


def of_boxes(boxes):
    """(V, ∫x, ∫x xᵀ) of boxes [(low corner, high corner)]: ∫x² = (h³ − l³)/3, ∫x y = (h² − l²)(k² − j²)/4."""
    V, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
    for low, high in boxes:
        volume, centre = np.prod(high - low), 0.5 * (low + high)
        V, first, second = V + volume, first + volume * centre, second + volume * (np.outer(centre, centre) + np.diag((high - low) ** 2) / 12.0)
    return V, first, second


def compare_integrals(lesson, what, x, faces, expected, given):
    V, first, second = lesson.mesh_integrals(x, faces)
    close(f"∫dV of {what} [m³]", V, expected[0], ROUNDED, given)
    close(f"∫x dV of {what} [m⁴]", first, expected[1], ROUNDED, given)
    close(f"∫x xᵀ dV of {what} [m⁵]", second, expected[2], ROUNDED, given)


@exercise("4.15", points=0.75,
          hint="w = a · (b × c) is six times the tetrahedron's volume; s = a + b + c belongs into first and second")
def test_integrals_over_a_tetrahedron_are_those_of_its_corners(lesson, draw):
    x = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]) + draw(-0.2, 0.2, (4, 3)) + draw(-2.0, 2.0, 3)
    V, s = np.linalg.det(x[1:] - x[0]) / 6.0, x.sum(axis=0)
    # Dirichlet: ∫λᵢλⱼ dV = V (1 + δᵢⱼ)/20 in barycentric coordinates
    expected = V, V / 4.0 * s, V / 20.0 * (x.T @ x + np.outer(s, s))
    compare_integrals(lesson, "a tetrahedron away from the origin", x, TETRAHEDRON, expected, f"corners {x.tolist()}")


@exercise("4.15", points=0.75,
          hint="add up over all triangles with the sign of w: what juts out over the body must be taken away again")
def test_integrals_over_boxes_and_an_angle_are_products(lesson, draw):
    size, centre = draw(0.3, 1.5, 3), draw(-2.0, 2.0, 3)
    expected = of_boxes([(centre - 0.5 * size, centre + 0.5 * size)])
    compare_integrals(lesson, "a box", *box_mesh(size, centre), expected, f"size = {size}, centre = {centre}")
    (a, b), t, height = draw(1.0, 1.5, 2), draw(0.2, 0.5), draw(0.3, 1.0)
    x, faces = angle_mesh(a, b, t, height)
    expected = of_boxes([(np.zeros(3), np.array([a, t, height])), (np.array([0.0, t, 0.0]), np.array([t, b, height]))])
    compare_integrals(lesson, "an L, which is not convex", x, faces, expected, f"legs {a:.4g}, {b:.4g}, thickness {t:.4g}, height {height:.4g}")


def of_tetrahedron(x):
    """(V ≥ 0, ∫x, ∫x xᵀ) of a tetrahedron (4, 3); in barycentric coordinates ∫λᵢλⱼ dV = V (1 + δᵢⱼ)/20 (Dirichlet)."""
    V, s = abs(np.linalg.det(x[1:] - x[0])) / 6.0, x.sum(axis=0)
    return V, V / 4.0 * s, V / 20.0 * (x.T @ x + np.outer(s, s))


def added(parts):
    """The sum of integrals [(share, (V, ∫x, ∫x xᵀ))]."""
    return [sum(share * integrals[k] for share, integrals in parts) for k in range(3)]


def lumps(draw, place):
    """(name, corners, faces, integrals) of random bodies of size 1 at a place [m]: convex, dented, hollow.

    The integrals are those of the tetrahedra into which Delaunay's method divides them.
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


@exercise("4.15", points=0.5,
          hint="keep every sign: the integrals of a cavity, or of a mesh turned inside-out, are negative")
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


@exercise("4.16", points=0.25,
          hint="every edge i → j needs a j → i; an odd triangle, turned round or doubled, breaks that; name a corner where it is open")
def test_open_and_crooked_meshes_are_refused(lesson, draw):
    x, faces = box_mesh(draw(0.3, 1.5, 3), np.zeros(3))
    k = draw.whole(0, len(faces) - 1)
    crooked = faces.copy()
    crooked[k] = crooked[k, ::-1]
    broken = {"a triangle missing": np.delete(faces, k, axis=0), "one triangle turned round": crooked,
              "one triangle twice": np.concatenate([faces, faces[k:k + 1]]),
              "a tube: both lids missing, though the areas of the rest add up to nothing": faces[4:],
              "a number that no corner has": np.where(faces == len(x) - 1, len(x), faces), "a negative number": np.where(faces == 0, -1, faces)}
    lesson.check_closed(len(x), faces)                                 # a closed one passes
    for what, wrong in broken.items():
        raises(what, BadInput, lesson.check_closed, len(x), np.ascontiguousarray(wrong))
    # alone and numbered by triangles, i · 1 + j, its edges there and back would be the same list
    raises("one triangle alone", BadInput, lesson.check_closed, 3, np.array([[0, 1, 2]]), naming=[0, 1, 2])
    k = int(np.flatnonzero(np.all(faces > 0, axis=1))[0])
    raises("a triangle missing that has no corner 0", BadInput, lesson.check_closed, len(x), np.delete(faces, k, axis=0), naming=faces[k].tolist())
    raises("a number that no corner has", BadInput, lesson.check_closed, len(x), np.where(faces == len(x) - 1, 77, faces), naming=[77])


@exercise("4.16", points=0.25,
          hint="compare what is there with what goes back, edge by edge; how the triangles are ordered does not matter")
def test_closed_meshes_pass(lesson, draw):
    raises("an open mesh: a tetrahedron without one of its sides", BadInput, lesson.check_closed, 4, TETRAHEDRON[1:])
    lesson.check_closed(4, TETRAHEDRON)
    x, faces = box_mesh(draw(0.3, 1.5, 3), np.zeros(3))
    lesson.check_closed(len(x), faces)
    lesson.check_closed(len(x), np.ascontiguousarray(np.roll(faces, draw.whole(1, 5), axis=0)[:, [1, 2, 0]]))
    lesson.check_closed(2 * len(x), np.concatenate([faces, faces + len(x)]))          # two bodies that do not touch
    lesson.check_closed(len(x) + 1, faces)                                            # a corner that no triangle uses
    lesson.check_closed(6, np.concatenate([TETRAHEDRON, np.array([0, 1, 4, 5])[TETRAHEDRON]]))           # two that share an edge: it is there twice, and back twice


def open_corners(faces):
    """Corners of edges i → j that are not met by as many edges j → i."""
    there = Counter((int(f[k]), int(f[(k + 1) % 3])) for f in faces for k in range(3))
    return sorted({corner for i, j in there if there[i, j] != there[j, i] for corner in (i, j)})


@exercise("4.16", points=0.5,
          hint="count every edge i → j and every edge j → i: they must be as many, whatever numbers the corners have")
def test_lumps_are_closed_until_a_triangle_is_lost_turned_doubled_or_misplaced(lesson, draw):
    for name, x, original, _ in lumps(draw, np.zeros(3)):
        count = len(x) + 3                                               # three corners that no triangle uses
        for _ in range(3):
            faces = np.argsort(draw(0.0, 1.0, count))[original]
            faces = np.ascontiguousarray(np.roll(faces, draw.whole(0, 2),
                                                 axis=1)[np.argsort(draw(0.0, 1.0, len(faces)))])
            lesson.check_closed(count, faces)
            k, turned_round, misplaced = draw.whole(0, len(faces) - 1), faces.copy(), faces.copy()
            turned_round[k] = faces[k, ::-1]
            misplaced[k, 0] = next(c for c in range(count) if c not in faces[k])
            lost, doubled = np.delete(faces, k, axis=0), np.concatenate((faces, faces[k:k + 1]))
            for what, broken in (("lost", lost), ("turned", turned_round), ("doubled", doubled),
                                 ("misplaced", misplaced)):
                raises(f"{name} with a triangle {what}", BadInput, lesson.check_closed, count, broken,
                       naming=open_corners(broken))


@exercise("4.17", points=0.75, hint="subtract V c cᵀ before you form the trace: the tensor is about the centre of mass")
def test_a_mesh_has_the_mass_centre_and_tensor_of_its_body(lesson, draw):
    density, size, centre = draw(0.5, 2.0), draw(0.3, 1.5, 3), draw(-2.0, 2.0, 3)
    x, faces = box_mesh(size, centre)
    kept, m, given = x.copy(), density * np.prod(size), f"density = {density:.4g}, size = {size}, centre = {centre}"
    found_m, found_x, found_I = lesson.mesh_body(density, x, faces)
    close("mass of a box [kg]", found_m, m, ROUNDED, given)
    close("its centre of mass [m]", found_x, centre, ROUNDED, given)
    close("its tensor about the centre [kg m²]", found_I, by_eight_points(m, size), ROUNDED, given)
    close("the corners that were handed in: return new arrays", x, kept, 0.0, given)

    a, b, c = draw(0.3, 1.5, 3)
    m, given = density * a * b * c / 6.0, f"density = {density:.4g}, edges {a:.4g}, {b:.4g}, {c:.4g}"
    _, found_x, found_I = lesson.mesh_body(density, np.array([[0.0, 0.0, 0.0], [a, 0.0, 0.0], [0.0, b, 0.0], [0.0, 0.0, c]]), TETRAHEDRON)
    # Σ over the corner cut off a box: ∫x² = V a²/10, ∫x y = V a b/20, centre a/4: 1/10 − 1/16 = 3/80, 1/20 − 1/16 = −1/80
    expected = m / 80.0 * np.array([[3.0 * (b * b + c * c), a * b, a * c], [a * b, 3.0 * (a * a + c * c), b * c],
                                    [a * c, b * c, 3.0 * (a * a + b * b)]])
    close("centre of a corner cut off a box [m]", found_x, [0.25 * a, 0.25 * b, 0.25 * c], ROUNDED, given)
    close("its tensor about the centre [kg m²]", found_I, expected, ROUNDED, given)


@exercise("4.17", points=0.25, hint="integrate about a corner, x − x[0], and add x[0] to the centre in the end")
def test_a_mesh_far_from_the_origin_keeps_its_digits(lesson, draw):
    density, size = draw(0.5, 2.0), draw(0.5, 1.5, 3)
    far = np.round(draw(0.5, 1.0, 3) * np.array([1e5, -1e5, 1e5]))
    _, found_x, found_I = lesson.mesh_body(density, *box_mesh(size, far))
    given = f"size = {size}, centre = {far}"
    # a corner 10⁵ m out is rounded by 7e-12 m, and the tensor of 7 kg with it by 4 · 7 kg · 2 m · 7e-12 m; about the origin
    # 7 · 10¹⁰ kg m² would be rounded, by 1e-6 kg m², and more when the tetrahedra reach there
    close("tensor about the centre, 10⁵ m away [kg m²]", found_I, by_eight_points(density * np.prod(size), size), 1e-9, given)
    close("centre of mass, 10⁵ m away [m]", found_x, far, 1e-10, given)


@exercise("4.17", points=0.25,
          hint="check the density, the corners, the edges; then the volume: below zero, the mesh is inside-out")
def test_meshes_without_an_inside_are_refused(lesson, draw):
    size = draw(0.3, 1.5, 3)
    x, faces = box_mesh(size, draw(-1.0, 1.0, 3))
    close("mass of a box at 1 kg/m³ [kg]", lesson.mesh_body(1.0, x, faces)[0], np.prod(size), ROUNDED, f"size = {size}")
    for density in (0.0, -1.0, np.nan, np.inf):
        raises(f"density {density} kg/m³", BadInput, lesson.mesh_body, density, x, faces)
    raises("a mesh turned inside-out", BadInput, lesson.mesh_body, 1.0, x, np.ascontiguousarray(faces[:, ::-1]))
    raises("an open mesh", BadInput, lesson.mesh_body, 1.0, x, faces[1:])
    raises("a corner at NaN", BadInput, lesson.mesh_body, 1.0, np.where(x == x[3], np.nan, x), faces)
    for wrong in (np.nan, np.inf):
        raises(f"a corner at {wrong} that no triangle uses", BadInput, lesson.mesh_body, 1.0,
               np.append(x, [[0.0, wrong, 0.0]], axis=0), faces)
    for number in (-1, len(x), 77):
        raises("a number that no corner has", BadInput, lesson.mesh_body, 1.0, x,
               np.where(faces == len(x) - 1, number, faces))
    raises("two triangles back to back", BadInput, lesson.mesh_body, 1.0, x, np.array([[0, 1, 2], [0, 2, 1]]))
    for _ in range(8):                                                 # one of them has a volume of round-off above zero
        flat = np.column_stack([x[:, :2], x[:, :2] @ draw(-0.5, 0.5, 2)])
        raises("a box pressed flat, all corners in one plane", BadInput, lesson.mesh_body, 1.0, flat, faces)
    for size in (1.0, 1e3, 1e6):                                       # of a large one the round-off is large as well
        flat = size * np.column_stack([x[:, :2], x[:, :2] @ draw(-0.5, 0.5, 2)])
        raises("a large box pressed flat", BadInput, lesson.mesh_body, 1.0, flat, faces)


def sheets(draw, share):
    """(corners, faces, volume) of boxes with V = share · ε e³, ε = 1e-14.

    A corner at the origin comes first: nothing is rounded away.  The others are all above that corner, or all below it.
    """
    for size in SIZES:
        a, b = size * draw(0.3, 1.5, 2)
        edges = np.array([a, b, share * 1e-14 * max(a, b) ** 3 / (a * b)])
        x, faces = box_mesh(edges, 0.5 * edges)
        yield x, faces, np.prod(edges)
        yield -x, np.ascontiguousarray(faces[:, ::-1]), np.prod(edges)


@exercise("4.17", points=0.25,
          hint="the volume is compared with ε e³, e the largest of all |x − o|; zero is not the limit")
def test_what_is_thinner_than_round_off_has_no_inside(lesson, draw):
    for x, faces, V in sheets(draw, 100.0):
        given = f"corners {x.tolist()}, triangles {faces.tolist()}"
        close("mass of a thin sheet over density and volume [-]", lesson.mesh_body(1.0, x, faces)[0] / V, 1.0, 1e-9,
              given)
    for x, faces, _ in sheets(draw, 0.01):
        raises("a sheet thinner than round-off", BadInput, lesson.mesh_body, 1.0, x, faces)


@exercise("4.17", points=0.5,
          hint="the centre is first/volume, not the mean of the corners; a small body is as good as a large one")
def test_a_lump_of_any_size_and_place_has_the_mass_centre_and_tensor_of_its_tetrahedra(lesson, draw):
    for size in SIZES:
        for far in (0.0, 1e3):
            place, density = far * draw(-1.0, 1.0, 3), draw(0.5, 2.0)
            for name, x, faces, (V, first, second) in lumps(draw, np.zeros(3)):
                mass, centre, I = lesson.mesh_body(density, size * (x + place), faces)
                C = second - np.outer(first, first) / V
                given = f"density {density}, corners {(size * (x + place)).tolist()}, triangles {faces.tolist()}"
                # corners a thousand sizes away are rounded by 1e-13 of the size
                close(f"mass of {name} over density and size [-]", mass / density / size**3, V, ROUNDED, given)
                close(f"centre of mass of {name}, less where it was put, over the size [-]",
                      np.asarray(centre) / size - place, first / V, ROUNDED, given)
                close(f"tensor of {name} over density and size [-]", np.asarray(I) / density / size**5,
                      np.trace(C) * np.eye(3) - C, ROUNDED, given)
