"""Inertia tensors at the limits of floats and of bodies: lesson 4 far from the origin, for thin and for invalid bodies.

A mesh far from the origin: its corners are rounded to the spacing of floats there, and no other error may appear.
Needles, plates, and impossible tensors: the edge between them.
"""

import numpy as np

from solutions.checks import BadInput
from validate.stability.case import (
    DOTS,
    LINE,
    Picture,
    Worst,
    agreement,
    case,
    finding,
    flat,
    log_slope,
    refuses,
    series,
)

SPACING = 2.0**-52           # of floats around 1 [-]; a coordinate has half of it as relative rounding error
PLACES = 64  # directions in which the body is moved: the mean square of so many errors is known to 18 %
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
    return np.linalg.norm(I - TRUTH) / np.linalg.norm(TRUTH)


def about_the_world(x):
    """Return the tensor from integrals about the origin of the world, shifted afterwards.

    Written out here: an answer of mesh_integrals that loses fewer digits is right, too.
    """
    corners = x[FACES]
    w, s = np.sum(corners[:, 0] * np.cross(corners[:, 1], corners[:, 2]), axis=1), corners.sum(axis=1)
    V, first = w.sum() / 6.0, w @ s / 24.0
    second = (np.einsum("f,fki,fkj->ij", w, corners, corners) + np.einsum("f,fi,fj->ij", w, s, s)) / 120.0
    C = second - np.outer(first, first) / V
    return np.trace(C) * np.eye(3) - C


def mean_error(tensor, distances):
    """Return the root-mean-square error at each distance, over the same directions for all."""
    directions = np.random.default_rng(40).uniform(0.5, 1.0, (PLACES, 3)) * np.random.default_rng(41).choice(
        [-1.0, 1.0], (PLACES, 3)
    )
    return np.array([np.sqrt(np.mean([error(tensor(CORNER + D * n)) ** 2 for n in directions])) for D in distances])


@case("far-from-origin", "A mesh far from the origin", compiled=False)
def far_from_origin(lesson):
    """Corners at the distance D are rounded by D/2^53, and the tensor by five times that over the size: ∝ D.

    About the origin of the world each tetrahedron reaches from there to its triangle.  w sums products of D³ and
    the second moments products of D⁵, each rounded by 1.1e-16 of itself: ∝ D⁵.  Distances are powers of 2, so the
    spacing of floats grows with them exactly.  Slopes over 20 (8) doublings of errors known to 9 % each are known
    to 0.02 (0.04).  At 4 m the body's own half metre still counts: (3.5/3)⁵ more error there, which lowers the
    second slope by 0.14.
    """
    near, far = 2.0 ** np.arange(2, 11), 2.0 ** np.arange(6, 27, 4)
    ours = mean_error(lambda x: lesson.mesh_body(1.0, x, FACES).I, far)
    naive = mean_error(about_the_world, near)
    slope, steep = log_slope(far, ours), log_slope(near, naive)
    found = [
        finding(
            claim="About a corner of the body, only the rounding of its corners remains: the error grows like D.",
            quantity="slope of log error over log D, 64 m to 67,000 km [-]",
            predicted=1.0,
            measured=slope,
            tolerance=0.05,
            observation=f"The error of the tensor grows with the power {slope:.3f} of D.",
        ),
        finding(
            claim="About the origin of the world, products of D⁵ cancel: the error grows with D⁵.",
            quantity="the same for integrals about the world's origin, 4 m to 1 km [-]",
            predicted=5.0,
            measured=steep,
            tolerance=0.2,
            observation=(f"There the error grows with the power {steep:.2f} of D: half of the digits are lost at "
                         f"{lost(near, naive):.0f} m."),
        ),
    ]
    # The inscribed ball of the body has the radius 3V/area.  Corners moved by √3 D/2^53 scale it by at most that
    # over the radius.

    edges = CORNER[FACES[:, 1:]] - CORNER[FACES[:, :1]]
    V, area = 0.48 / 6.0, 0.5 * np.sum(np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1))
    allowed = 5.0 * np.sqrt(3.0) * 2.0**16 * 0.5 * SPACING / (3.0 * V / area)
    body = lesson.mesh_body(1.0, CORNER + FAR, FACES)
    away, missed = error(body.I), np.max(np.abs(body.x - FAR - CORNER.sum(axis=0) / 4.0))
    found += [
        finding(
            claim="At (10⁵, −8·10⁴, 5·10⁴) m the tensor is as accurate as the corners.",
            quantity="relative error of the tensor there [-]",
            predicted=0.0,
            measured=away,
            tolerance=allowed,
            observation=f"{-np.log10(away):.1f} digits of the tensor are right.",
        ),
        finding(
            claim="The centre of mass is right to one spacing of floats.",
            quantity="error of the centre of mass there [m]",
            predicted=0.0,
            measured=missed,
            tolerance=2.0**16 * SPACING,
            observation=f"The centre is {missed:.0e} m off.",
        ),
    ]
    curves = {"about a corner of the body": (far, ours, DOTS), "about the world's origin": (near, naive, DOTS),
              "∝ D": (far, ours[0] * far / far[0], LINE), "∝ D⁵": (near, naive[0] * (near / near[0]) ** 5, LINE)}
    drawn = [series(label, np.log10(xs), np.log10(ys), style) for label, (xs, ys, style) in curves.items()]
    return found, Picture(
        "A mesh far from the origin",
        "log₁₀ of the distance [m]",
        "log₁₀ of the tensor's relative error [-]",
        drawn,
        "A body of one metre, moved away. Taken about one of its corners, the formulas lose one digit per factor of "
        "ten; about the origin of the world they lose five.",
    )


def lost(distances, errors):
    """Return the distance at which the error passes 10⁻⁸ [m]."""
    return 10.0 ** np.interp(-8.0, np.log10(errors), np.log10(distances))


def last_that_passes(check, good, bad):
    """Bisect for the last accepted number between an accepted and a refused one; NaN if they are not."""
    if not passes(check, good) or passes(check, bad):
        return np.nan
    while True:
        middle = 0.5 * (good + bad)
        if middle in (good, bad):
            return good
        good, bad = (middle, bad) if passes(check, middle) else (good, middle)


def passes(check, value):
    try:
        check(value)
    except BadInput:
        return False
    return True


def turned(moments, rng):
    """Return a tensor with these principal moments, rotated at random, and symmetric to the last bit."""
    R = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    I = R @ np.diag(moments) @ R.T
    return 0.5 * (I + I.T)


@case("thin-bodies", "Needles, plates, and impossible tensors", compiled=False)
def thin_bodies(lesson):
    """I₁ + I₂ − I₃ = 2 ∫ z² dm ≥ 0, and I₁ > 0; both to ε = MOMENT_ROUND_OFF, which round-off must not exceed."""
    epsilon, rng = lesson.MOMENT_ROUND_OFF, np.random.default_rng(41)
    top = last_that_passes(lambda m: lesson.check_inertia(np.diag(np.array([1.0, 2.0, m]))), 2.5, 4.0)
    thin = last_that_passes(lambda m: lesson.check_inertia(np.diag(np.array([m, 1.0, 1.0]))), 0.5, 0.0)
    found = [
        finding(
            claim="No principal moment is above the sum of the other two.",
            quantity="largest I₃ that passes with I₁ = 1, I₂ = 2 [kg m²]",
            predicted=3.0,
            measured=top,
            tolerance=3.0 * (epsilon + SPACING),
            observation=f"The edge is found at {top:.15g} kg m².",
        ),
        finding(
            claim="A needle may be thin, but not of zero thickness.",
            quantity="smallest I₁/I₃ that passes [-]",
            predicted=epsilon,
            measured=thin,
            tolerance=2.0 * SPACING,
            observation=f"Needles are accepted down to I₁/I₃ = {thin:.3g}.",
        ),
    ]
    thicknesses = np.logspace(-9.0, 0.0, 200)
    plates = [lesson.box_inertia(1.0, np.array([1.0, 0.7, h])) for h in thicknesses]
    refused = sum(not passes(lesson.check_inertia, turned(np.sort(np.diag(I)), rng)) for I in plates)
    found.append(finding(
        claim="Every plate is accepted, however thin and at any orientation.",
        quantity="plates from 1 nm to 1 m that are refused [of 200]",
        predicted=0,
        measured=refused,
        tolerance=0.0,
        observation=f"{refused} of 200 rotated plates are refused.",
    ))
    # det and cofactors lose the condition number I₃/I₁ in digits, about twenty roundings each
    ratios, worst = 10.0 ** -np.arange(0.0, 13.0), []
    for ratio in ratios:
        I_body, R = turned([ratio, 1.0, 1.0], rng), np.linalg.qr(rng.standard_normal((3, 3)))[0]
        worst.append(
            np.max(np.abs(lesson.world_inverse_inertia(I_body, R) @ lesson.world_inertia(I_body, R) - np.eye(3)))
        )
    needle = worst[6]
    found.append(finding(
        claim="The inverse of a needle with I₃/I₁ = 10⁶ loses six digits and no more.",
        quantity="largest entry of I⁻¹I − 1 for I = (10⁻⁶, 1, 1) [-]",
        predicted=0.0,
        measured=needle,
        tolerance=1e6 * 20 * 0.5 * SPACING,
        observation=f"I⁻¹I differs from 1 by {needle:.1e}.",
    ))
    drawn = [series("largest entry of I⁻¹I − 1", -np.log10(ratios), np.log10(worst), DOTS),
             series("twenty roundings times I₃/I₁", -np.log10(ratios), np.log10(20 * 0.5 * SPACING / ratios), LINE)]
    return found, Picture(
        "Needles",
        "log₁₀ of I₃/I₁ [-]",
        "log₁₀ of the departure [-]",
        drawn,
        "The inverse of a rotated tensor loses a digit per factor of ten between the largest and the smallest "
        "moment. In its principal axes it would lose none.",
    )


@case("momenta", "Momenta of a body that moves and rotates", compiled=False)
def momenta(lesson):
    """P = M V,  L about the centre = I ω,  L about any other point = I ω + (X − about) × M V.

    The tensor is summed in coordinates: I_jk = Σ m (r² δ_jk − r_j r_k).
    """
    rng, worst = np.random.default_rng(43), Worst()
    for _ in range(50):
        m, x = rng.uniform(0.5, 2.0, 7), rng.normal(size=(7, 3))
        V, omega, about = rng.normal(size=(3, 3))
        X = np.average(x, axis=0, weights=m)
        r = x - X
        v = V + np.cross(omega, r)
        I = sum(m_i * (r_i @ r_i * np.eye(3) - np.outer(r_i, r_i)) for m_i, r_i in zip(m, r, strict=True))
        P, L = m.sum() * V, I @ omega
        moved = L + np.cross(X - about, P)
        for name, got, truth in (("P", lesson.linear_momentum(m, v), P),
                                 ("centre", lesson.angular_momentum(m, x, v, X), L),
                                 ("about", lesson.angular_momentum(m, x, v, about), moved)):
            worst.keep(name, np.linalg.norm(got - truth) / np.linalg.norm(truth))
    names = (
        ("P", "The momentum of a body is its mass times the velocity of its centre.", "linear momentum"),
        ("centre", "About its centre the angular momentum of a body is I ω.", "angular momentum about the centre"),
        ("about", "About another point the momentum of the centre is added.", "angular momentum about a point"))
    return [agreement(claim, f"{quantity}: largest relative error [-]", worst[name], 1e-12)
            for name, claim, quantity in names], None


@case("bodies-with-holes", "Bodies with holes, in any axes", compiled=False)
def bodies_with_holes(lesson):
    """Sums over points whose masses may be negative, and tensors whose products do not vanish.

    The sums are numpy's, over the definitions: X = Σ m x/Σ m,  P = Σ m v,  L = Σ (x − about) × m v,
    I_jk = Σ m (r² δ_jk − r_j r_k).
    """
    rng = np.random.default_rng(44)
    worst = Worst()
    for _ in range(50):
        m, x, v, about = rng.uniform(0.5, 2.0, 7), *rng.normal(size=(2, 7, 3)), rng.normal(size=3)
        m[3] = -0.4                                              # a hole
        X = np.average(x, axis=0, weights=m)
        tensors = np.array([np.eye(3) * (r @ r) - np.outer(r, r) for r in x])
        I = np.tensordot(m, tensors, 1)
        L = np.sum(m[:, None] * np.cross(x - about, v), axis=0)
        got = *lesson.centre_of_mass(m, x), lesson.linear_momentum(m, v), lesson.angular_momentum(m, x, v, about)
        for one, truth in zip(got, (m.sum(), X, m @ v, L), strict=True):
            worst.keep("sums", np.max(np.abs(one - truth)) / np.max(np.abs(truth)))
        worst.keep("tensor", np.max(np.abs(lesson.point_mass_inertia(m, x) - I)) / np.max(np.abs(I)))

        factors = rng.normal(size=(7, 3, 3))
        own = 0.2 * m[:, None, None] * (factors @ factors.transpose(0, 2, 1) + np.eye(3))
        whole = lesson.combine(m, x, own)
        truth = np.sum(own, axis=0) + I - m.sum() * (X @ X * np.eye(3) - np.outer(X, X))
        worst.keep("combined", np.max(np.abs(whole.I - truth)) / np.max(np.abs(truth)),
                   np.max(np.abs(whole.x - X)))
        one = lesson.combine(m[:1], x[:1], own[:1])
        worst.keep("combined", np.max(np.abs(one.I - own[0])) / np.max(np.abs(own[0])), np.max(np.abs(one.x - x[0])))

        R = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        R[:, 2] *= np.linalg.det(R)
        # a tetrahedron beside the origin: polynomials of degree 2 by four points inside it
        corners = CORNER @ R.T + 3.0 * about
        inside = (corners + (np.sqrt(5.0) - 1.0) * np.mean(corners, axis=0)) / np.sqrt(5.0)
        truth = 0.08 * np.concatenate(([1.0], np.mean(inside, axis=0), (inside.T @ inside / 4.0).ravel()))
        got = flat(lesson.mesh_integrals(corners, FACES))
        worst.keep("integrals", np.max(np.abs(got - truth)) / np.max(np.abs(truth)))

        moments = np.sort(rng.uniform(1.0, 1.9, 3))
        body = lesson.world_inertia(np.diag(moments), R)
        inverse = lesson.world_inverse_inertia(np.diag(moments), R)
        # along the k-th column of R the tensor is the k-th moment
        worst.keep("inverse", np.max(np.abs(body @ R - R * moments)),
                   np.max(np.abs(inverse @ R - R / moments)))
        found, axes = lesson.principal_axes(R @ np.diag(moments) @ R.T)
        worst.keep("axes", np.max(np.abs(found - moments)),
                   np.max(np.abs(np.abs(np.sum(axes * R, axis=0)) - 1.0)))
        worst.keep("hand", abs(np.linalg.det(axes) - 1.0))
    # a closed mesh without one of its triangles, or with one of them the other way round, is open; or it is inside out
    torn = [np.delete(FACES, k, axis=0) for k in range(4)]
    torn += [np.where(np.arange(4)[:, None] == k, FACES[:, ::-1], FACES) for k in range(4)] + [FACES[:, ::-1]]
    refused = sum(refuses(lesson.mesh_body, (1.0, CORNER, faces), "") for faces in torn)
    names = (
        ("sums", "A hole counts with its negative mass: centre, momentum, angular momentum.", "sums over points"),
        ("tensor", "A tensor of points has the products −Σ m x y, all three of them.", "tensor of points"),
        ("combined", "A body of parts has its tensor about its own centre of mass.", "tensor of parts"),
        ("integrals", "The integrals over a mesh are those over its inside, wherever the origin is.", "integrals"),
        ("inverse", "A tensor and its inverse turn with the body.", "tensor along the axes of the body"),
        ("axes", "Principal axes are those that the body was turned to.", "moments and axes"),
        ("hand", "Principal axes are right-handed.", "determinant of the axes"))
    return [agreement(claim, f"{quantity}: largest error [-]", worst[name], 1e-12)
            for name, claim, quantity in names] + [finding(
        claim="A mesh that lacks a triangle, or has one or all of them the wrong way round, is refused.",
        quantity=f"meshes without an inside that are refused [of {len(torn)}]", predicted=len(torn),
        measured=refused, tolerance=0.0,
        observation=f"{refused} of {len(torn)} such meshes are refused.")], None
