"""Limits of inertia tensors: lesson 4 far from the origin, for thin and for invalid bodies.

The corners of a mesh far from the origin are rounded to the spacing of floats there, and no other error may appear.
Needles, plates and impossible tensors define the edge of valid tensors.
"""

import numpy as np

from validate.stability.case import DOTS, LINE, Picture, case, log_series, log_slope, random_law, refuses, relative

SPACING = 2.0**-52           # of floats around 1 [-]; a coordinate has half of it as relative rounding error
PLACES = 64  # directions in which the body is moved: the mean square of this number of errors is known to 18 %
# of a box whose corner is cut off [m]
CORNER = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.8, 0.0], [0.0, 0.0, 0.6]])
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
FAR = np.array([1e5, -8e4, 5e4])                                                             # [m]


def corner_tensor(density, a, b, c):
    """Return the tensor of the tetrahedron with the intercepts a, b, c: ∫x² = V a²/10, ∫x y = V a b/20, centre a/4."""
    m = density * a * b * c / 6.0
    return m / 80.0 * np.array([[3.0 * (b * b + c * c), a * b, a * c], [a * b, 3.0 * (a * a + c * c), b * c],
                                [a * c, b * c, 3.0 * (a * a + b * b)]])


TRUTH = corner_tensor(1.0, 1.0, 0.8, 0.6)


def error(I):
    """Return the relative error of a tensor of that corner."""
    return np.linalg.norm(I - TRUTH) / np.linalg.norm(TRUTH)


def about_the_world(x):
    """Return the tensor from integrals about the origin of the world, shifted afterwards.

    It is written out here, because an answer of mesh_integrals that loses fewer digits is right, too.
    """
    corners = x[FACES]
    w, s = np.sum(corners[:, 0] * np.cross(corners[:, 1], corners[:, 2]), axis=1), corners.sum(axis=1)
    V, first = w.sum() / 6.0, w @ s / 24.0
    second = (np.einsum("f,fki,fkj->ij", w, corners, corners) + np.einsum("f,fi,fj->ij", w, s, s)) / 120.0
    C = second - np.outer(first, first) / V
    return np.trace(C) * np.eye(3) - C


def mean_error(tensor, distances):
    """Return the root-mean-square error at each distance, over the same directions for all."""
    sizes = np.random.default_rng(40).uniform(0.5, 1.0, (PLACES, 3))
    directions = sizes * np.random.default_rng(41).choice([-1.0, 1.0], (PLACES, 3))
    return np.array([np.sqrt(np.mean([error(tensor(CORNER + D * n)) ** 2 for n in directions])) for D in distances])


@case("far-from-origin", "A mesh far from the origin", compiled=False)
def far_from_origin(lesson, check):
    """Compare the error of a mesh at the distance D with the rounding of its corners.

    Corners are rounded by D/2^53, and the tensor by five times that over the size: ∝ D.  About the origin of the
    world each tetrahedron reaches from there to its triangle.  w sums products of D³ and the second moments
    products of D⁵, each rounded by 1.1e-16 of itself: ∝ D⁵.  Distances are powers of 2, so the spacing of floats
    grows with them exactly.  Slopes over 20 (8) doublings of errors known to 9 % each are known to 0.02 (0.04).  At
    4 m the body's own half metre still counts: (3.5/3)⁵ more error there, which lowers the second slope by 0.14.
    """
    near, far = 2.0 ** np.arange(2, 11), 2.0 ** np.arange(6, 27, 4)
    ours = mean_error(lambda x: lesson.mesh_body(1.0, x, FACES).I, far)
    naive = mean_error(about_the_world, near)
    slope, steep = log_slope(far, ours), log_slope(near, naive)
    check("About a corner of the body, only the rounding of its corners remains: the error grows like D.",
          "slope of log error over log D, 64 m to 67,000 km [-]", law=1.0, found=slope, within=0.05,
          saw=f"The error of the tensor grows with the power {slope:.3f} of D.")
    half = 10.0 ** np.interp(-8.0, np.log10(naive), np.log10(near))
    check("About the origin of the world, products of D⁵ cancel: the error grows with D⁵.",
          "the same for integrals about the world's origin, 4 m to 1 km [-]", law=5.0, found=steep, within=0.2,
          saw=f"There the error grows with the power {steep:.2f} of D: half of the digits are lost at {half:.0f} m.")
    far_body(lesson, check)
    return Picture(
        "A mesh far from the origin", "log₁₀ of the distance [m]", "log₁₀ of the tensor's relative error [-]",
        [log_series("about a corner of the body", far, ours, DOTS),
         log_series("about the world's origin", near, naive, DOTS),
         log_series("∝ D", far, ours[0] * far / far[0], LINE),
         log_series("∝ D⁵", near, naive[0] * (near / near[0]) ** 5, LINE)],
        "A body of one metre, moved away. Taken about one of its corners, the formulas lose one digit per factor of "
        "ten; about the origin of the world they lose five.")


def far_body(lesson, check):
    """Compare one body far away with the same body at the origin.

    The inscribed ball of the body has the radius 3V/area.  Corners moved by √3 D/2^53 scale it by at most that over
    the radius.
    """
    edges = CORNER[FACES[:, 1:]] - CORNER[FACES[:, :1]]
    area = 0.5 * np.sum(np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1))
    allowed = 5.0 * np.sqrt(3.0) * 2.0**16 * 0.5 * SPACING / (3.0 * (0.48 / 6.0) / area)
    body = lesson.mesh_body(1.0, CORNER + FAR, FACES)
    away = error(body.I)
    check("At (10⁵, −8·10⁴, 5·10⁴) m the tensor is as accurate as the corners.",
          "relative error of the tensor there [-]", law=0.0, found=away, within=allowed,
          saw=f"{-np.log10(away):.1f} digits of the tensor are right.")
    missed = np.max(np.abs(body.x - FAR - CORNER.sum(axis=0) / 4.0))
    check("The centre of mass is right to one spacing of floats.",
          "error of the centre of mass there [m]", law=0.0, found=missed, within=2.0**16 * SPACING,
          saw=f"The centre is {missed:.0e} m off.")


# ---------------------------------------------------------------------------------------------- thin bodies

def last_that_passes(check, good, bad):
    """Return the last accepted number between an accepted and a refused one, by bisection; NaN if they are not."""
    if refuses(check, (good,)) or not refuses(check, (bad,)):
        return np.nan
    while True:
        middle = 0.5 * (good + bad)
        if middle in (good, bad):
            return good
        good, bad = (good, middle) if refuses(check, (middle,)) else (middle, bad)


def turned(moments, rng):
    """Return a tensor with these principal moments, rotated at random, and symmetric to the last bit."""
    R = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    I = R @ np.diag(moments) @ R.T
    return 0.5 * (I + I.T)


def needle_errors(lesson, ratios, rng):
    """Return the largest entry of I⁻¹I − 1 for needles of random directions with the moments (ratio, 1, 1)."""
    errors = []
    for ratio in ratios:
        I_body, R = turned([ratio, 1.0, 1.0], rng), np.linalg.qr(rng.standard_normal((3, 3)))[0]
        product = lesson.world_inverse_inertia(I_body, R) @ lesson.world_inertia(I_body, R)
        errors.append(np.max(np.abs(product - np.eye(3))))
    return errors


@case("thin-bodies", "Needles, plates, and impossible tensors", compiled=False)
def thin_bodies(lesson, check):
    """Check I₁ + I₂ − I₃ = 2 ∫ z² dm ≥ 0 and I₁ > 0 at their edges.

    Both hold to ε = MOMENT_ROUND_OFF, which round-off must not exceed.  Determinant and cofactors lose the
    condition number I₃/I₁ in digits, with about twenty rounding errors each.
    """
    epsilon, rng = lesson.MOMENT_ROUND_OFF, np.random.default_rng(41)
    top = last_that_passes(lambda m: lesson.check_inertia(np.diag(np.array([1.0, 2.0, m]))), 2.5, 4.0)
    check("No principal moment is above the sum of the other two.",
          "largest I₃ that passes with I₁ = 1, I₂ = 2 [kg m²]", law=3.0, found=top, within=3.0 * (epsilon + SPACING),
          saw=f"The edge is found at {top:.15g} kg m².")
    thin = last_that_passes(lambda m: lesson.check_inertia(np.diag(np.array([m, 1.0, 1.0]))), 0.5, 0.0)
    check("A needle may be thin, but not of zero thickness.",
          "smallest I₁/I₃ that passes [-]", law=epsilon, found=thin, within=2.0 * SPACING,
          saw=f"Needles are accepted down to I₁/I₃ = {thin:.3g}.")
    plates = [lesson.box_inertia(1.0, np.array([1.0, 0.7, h])) for h in np.logspace(-9.0, 0.0, 200)]
    refused = sum(refuses(lesson.check_inertia, (turned(np.sort(np.diag(I)), rng),)) for I in plates)
    check("Every plate is accepted, however thin and at any orientation.",
          "plates from 1 nm to 1 m that are refused [of 200]", law=0, found=refused, within=0.0,
          saw=f"{refused} of 200 rotated plates are refused.")
    ratios = 10.0 ** -np.arange(0.0, 13.0)
    worst = needle_errors(lesson, ratios, rng)
    check("The inverse of a needle with I₃/I₁ = 10⁶ loses six digits and no more.",
          "largest entry of I⁻¹I − 1 for I = (10⁻⁶, 1, 1) [-]", law=0.0, found=worst[6],
          within=1e6 * 20 * 0.5 * SPACING, saw=f"I⁻¹I differs from 1 by {worst[6]:.1e}.")
    return Picture("Needles", "log₁₀ of I₃/I₁ [-]", "log₁₀ of the departure [-]", [
        log_series("largest entry of I⁻¹I − 1", 1.0 / ratios, worst, DOTS),
        log_series("twenty roundings times I₃/I₁", 1.0 / ratios, 20 * 0.5 * SPACING / ratios, LINE)],
        "The inverse of a rotated tensor loses a digit per factor of ten between the largest and the smallest "
        "moment. In its principal axes it would lose none.")


# ---------------------------------------------------------------------------------------------- laws of bodies

CASES, ROUNDED = 50, 1e-12   # random bodies of each law; a few dozen rounding errors of 1.1e-16, relative


def points(rng):
    """Return the masses m (7,) and places x (7, 3) of random points; one mass is negative, a hole."""
    m = rng.uniform(0.5, 2.0, 7)
    m[3] = -0.4
    return m, rng.normal(size=(7, 3))


def tensor_of(m, x, about):
    """Return Σ m (r² δ_jk − r_j r_k), r from a point."""
    return sum(m_i * (r @ r * np.eye(3) - np.outer(r, r)) for m_i, r in zip(m, x - about, strict=True))


def moving(rng):
    """Return (m, x, v, X, V, L): points that move with V + ω × r about their centre X, and I ω."""
    m, x = rng.uniform(0.5, 2.0, 7), rng.normal(size=(7, 3))
    V, omega = rng.normal(size=(2, 3))
    X = np.average(x, axis=0, weights=m)
    return m, x, V + np.cross(omega, x - X), X, V, tensor_of(m, x, X) @ omega


@random_law("The momentum of a body is its mass times the velocity of its centre.",
            "linear momentum: largest relative error [-]", ROUNDED)
def momentum(lesson, rng):
    m, _, v, _, V, _ = moving(rng)
    return relative((lesson.linear_momentum(m, v), m.sum() * V))


@random_law("About its centre the angular momentum of a body is I ω.",
            "angular momentum about the centre: largest relative error [-]", ROUNDED)
def momentum_about_centre(lesson, rng):
    m, x, v, X, _, L = moving(rng)
    return relative((lesson.angular_momentum(m, x, v, X), L))


@random_law("About another point the momentum of the centre is added.",
            "angular momentum about a point: largest relative error [-]", ROUNDED)
def momentum_about_point(lesson, rng):
    m, x, v, X, V, L = moving(rng)
    about = rng.normal(size=3)
    return relative((lesson.angular_momentum(m, x, v, about), L + np.cross(X - about, m.sum() * V)))


@case("momenta", "Momenta of a body that moves and rotates", compiled=False)
def momenta(lesson, check):
    """Compare momenta with P = M V,  L about the centre = I ω,  L about any other point = I ω + (X − about) × M V.

    The tensor is summed in coordinates: I_jk = Σ m (r² δ_jk − r_j r_k).
    """
    check.laws(lesson, (momentum, momentum_about_centre, momentum_about_point), seed=43, times=CASES)


@random_law("A hole counts with its negative mass: centre, momentum, angular momentum.",
            "sums over points: largest error [-]", ROUNDED)
def sums(lesson, rng):
    m, x = points(rng)
    v, about = rng.normal(size=(7, 3)), rng.normal(size=3)
    M, X = lesson.centre_of_mass(m, x)
    return relative((M, m.sum()), (X, np.average(x, axis=0, weights=m)), (lesson.linear_momentum(m, v), m @ v),
                    (lesson.angular_momentum(m, x, v, about), np.sum(m[:, None] * np.cross(x - about, v), axis=0)))


@random_law("A tensor of points has the products −Σ m x y, all three of them.",
            "tensor of points: largest error [-]", ROUNDED)
def tensor_of_points(lesson, rng):
    m, x = points(rng)
    return relative((lesson.point_mass_inertia(m, x), tensor_of(m, x, np.zeros(3))))


@random_law("A body of parts has its tensor about its own centre of mass.",
            "tensor of parts: largest error [-]", ROUNDED)
def combined(lesson, rng):
    """Combine seven parts, and one: a body of one part is that part."""
    m, x = points(rng)
    factors = rng.normal(size=(7, 3, 3))
    own = 0.2 * m[:, None, None] * (factors @ factors.transpose(0, 2, 1) + np.eye(3))
    X = np.average(x, axis=0, weights=m)
    whole, part = lesson.combine(m, x, own), lesson.combine(m[:1], x[:1], own[:1])
    return relative((whole.I, own.sum(axis=0) + tensor_of(m, x, X)), (whole.x, X), (part.I, own[0]), (part.x, x[0]))


def rotation(rng):
    """Return a random R (3, 3)."""
    R = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    R[:, 2] *= np.linalg.det(R)
    return R


@random_law("The integrals over a mesh are those over its inside, for any origin.",
            "integrals: largest error [-]", ROUNDED)
def integrals(lesson, rng):
    """Integrate polynomials of degree 2 over a tetrahedron beside the origin, by four points inside it."""
    corners = CORNER @ rotation(rng).T + 3.0 * rng.normal(size=3)
    inside = (corners + (np.sqrt(5.0) - 1.0) * np.mean(corners, axis=0)) / np.sqrt(5.0)
    truth = 0.08 * np.concatenate(([1.0], np.mean(inside, axis=0), (inside.T @ inside / 4.0).ravel()))
    return relative((lesson.mesh_integrals(corners, FACES), truth))


@random_law("A tensor and its inverse rotate with the body.",
            "tensor along the axes of the body: largest error [-]", ROUNDED)
def inverse(lesson, rng):
    """Multiply with R: along its k-th column the tensor is the k-th moment."""
    R, moments = rotation(rng), np.sort(rng.uniform(1.0, 1.9, 3))
    body, its_inverse = (of(np.diag(moments), R) for of in (lesson.world_inertia, lesson.world_inverse_inertia))
    return (body @ R, its_inverse @ R), (R * moments, R / moments)


def axes_found(lesson, rng):
    """Return (moments, axes) of a rotated tensor, and the R and the moments from which it is made."""
    R, moments = rotation(rng), np.sort(rng.uniform(1.0, 1.9, 3))
    return *lesson.principal_axes(R @ np.diag(moments) @ R.T), R, moments


@random_law("Principal axes are those to which the body was rotated.", "moments and axes: largest error [-]", ROUNDED)
def axes(lesson, rng):
    got_moments, got_axes, R, moments = axes_found(lesson, rng)
    return (got_moments, np.abs(np.sum(got_axes * R, axis=0))), (moments, np.ones(3))


@random_law("Principal axes are right-handed.", "determinant of the axes: largest error [-]", ROUNDED)
def handedness(lesson, rng):
    return np.linalg.det(axes_found(lesson, rng)[1]), 1.0


@case("bodies-with-holes", "Bodies with holes, in any axes", compiled=False)
def bodies_with_holes(lesson, check):
    """Compare sums over points with negative masses, and tensors with non-zero products, with their definitions.

    The sums are numpy's, over the definitions: X = Σ m x/Σ m,  P = Σ m v,  L = Σ (x − about) × m v,
    I_jk = Σ m (r² δ_jk − r_j r_k).
    """
    check.laws(lesson, (sums, tensor_of_points, combined, integrals, inverse, axes, handedness), seed=44, times=CASES)
    # a closed mesh without one of its triangles, or with one of them the other way round, is open; or it is inside out
    torn = [np.delete(FACES, k, axis=0) for k in range(4)]
    torn += [np.where(np.arange(4)[:, None] == k, FACES[:, ::-1], FACES) for k in range(4)] + [FACES[:, ::-1]]
    refused = sum(refuses(lesson.mesh_body, (1.0, CORNER, faces)) for faces in torn)
    check("A mesh that lacks a triangle, or has one or all of them the wrong way round, is refused.",
          f"meshes without an inside that are refused [of {len(torn)}]", law=len(torn), found=refused, within=0.0,
          saw=f"{refused} of {len(torn)} such meshes are refused.")


@case("rolling", "Times of rolling, and a mesh of one's own", compiled=False)
def rolling(lesson, check):
    """Compare the predicted time with the equations of motion, and a mesh of one's own with a ball."""
    for name, share in (("solid ball", 0.4), ("hoop", 1.0)):
        a, _ = np.linalg.solve([[2.0, 1.0], [share, -0.5]], [2.0 * 9.81 * np.sin(0.2), 0.0])     # 2 kg, R = 0.5 m
        law, found = np.sqrt(2.0 * 3.0 / a), lesson.rolling_time(share * 0.5, 2.0, 0.5, 3.0, 0.2, 9.81)
        check("A round body rolls down as friction and gravity move it.", f"time of a {name} for 3 m [s]", law=law,
              found=found, within=1e-14 * law, saw=f"The {name} takes {found:.4g} s.")
    moments, _ = lesson.principal_axes(lesson.mesh_body(1.0, *lesson.my_mesh(1.0))[2])
    ball = 0.4 * (0.75 / np.pi) ** (2.0 / 3.0)
    check("A mesh of one's own has three equal moments.", "largest over smallest moment [-]", law=1.0,
          found=moments[2] / moments[0], within=0.01,
          saw=f"It resists {moments[0] / ball:.3g} times as much as a ball.")
