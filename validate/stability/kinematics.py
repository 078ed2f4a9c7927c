"""Which gain is too much, what does a straight arm do, and what becomes of targets that nobody can reach?

Bounds come from singular values and second derivatives of chains of complex numbers, never from the lesson.
*Source:* each case derives what it needs; Bertsekas 1982 for limits.
"""

import numpy as np
from scipy.optimize import least_squares, minimize_scalar
from scipy.spatial.transform import Rotation

from solutions.checks import Diverged
from validate.reference.kinematics import annulus, curvature_of, end_of, jacobian_of, joints_of, spatial_end
from validate.stability.case import DOTS, LINE, Picture, Worst, agreement, bisect, case, finding, refuses, series

SMALL = 1e-8                 # disturbance that a linear theory knows [rad]: leaves 1e-8 of what is measured
FOUR_DIGITS = 1e-4           # of an edge that bisection finds, and of a factor, relative [-]
ARRIVED = 1e-9               # |e| over the reach at which a search ends [-]


def arm_of(lesson, lengths, gain=0.0, damping=0.0, low=-np.inf, high=np.inf):
    return lesson.make_arm_2d(np.array(lengths, float), gain, damping, low, high, 0.0, 0.0)


def after(lesson, name, arm, theta, target, iterations, task=None):
    """Angles after so many iterations."""
    step, task = getattr(lesson, name), task or lesson.reach_2d
    return lesson.advance_reach(step, task, np.array(theta, float), np.array(target, float), iterations, arm)


def growth(lesson, name, arm, rest, target, away, iterations=40):
    """Factor per iteration by which the distance from angles at rest grows, in the long run."""
    theta, size = np.array(rest) + SMALL * away, SMALL
    total, counted = 0.0, 0
    for k in range(iterations):
        theta = after(lesson, name, arm, theta, target, 1)
        size = np.linalg.norm(theta - rest)
        if not 0.0 < size < 1e3:
            return np.inf
        if k >= iterations // 2:
            total, counted = total + np.log(size / SMALL), counted + 1
        theta = rest + (theta - rest) * SMALL / size                     # back to where linear theory holds
    return np.exp(total / counted)


# ---------------------------------------------------------------------------------------------- gains

@case("transpose-gain", "How much gain the transpose stands", compiled=False)
def transpose_gain(lesson):
    """Near a target in reach the error along u_i is multiplied by 1 − α σ_i² per iteration: stable for α < 2/σ₁².

    At the edge the factor is −1.  Forty iterations from 1e-8 rad show a relative difference of 1e-6 as 8e-5.
    """
    found, edges, laws = [], [], []
    arms = (([1.0, 1.0], (0.3, 1.2)), ([1.0, 0.7, 0.4], (0.4, 0.9, 0.7)), ([0.1, 0.1], (0.3, 2.0)),
            ([1.0] * 10, [0.2] * 10))
    for lengths, theta in arms:
        theta, target = np.array(theta), end_of(theta, lengths)
        _, sigma, v = np.linalg.svd(jacobian_of(theta, lengths))
        law = 2.0 / sigma[0] ** 2
        edges.append(bisect(lambda gain, lengths=lengths, rest=(theta, target, v[0]): growth(
            lesson, "transpose_step", arm_of(lesson, lengths, gain), *rest) > 1.0, 0.1 * law, 10.0 * law))
        laws.append(law)
        found.append(finding(
            claim="The transpose converges for α < 2/σ₁², σ₁ the largest singular value of J.",
            quantity=f"largest gain, {len(lengths)} links of reach {sum(lengths):g} m [1/m²]",
            predicted=law,
            measured=edges[-1],
            tolerance=FOUR_DIGITS * law,
            observation=f"{len(lengths)} links of reach {sum(lengths):g} m stand a gain of {edges[-1]:.5g}/m².",
        ))
    fine = np.linspace(min(np.log10(laws)), max(np.log10(laws)), 20)
    return found, Picture("The largest gain", "log₁₀ of 2/σ₁²", "log₁₀ of the largest gain", [
        series("theory", fine, fine, LINE), series("measured", np.log10(laws), np.log10(edges), DOTS)],
        "A gain that suits one arm is a hundred times too much for another: longer arms stand less.")


# ---------------------------------------------------------------------------------------------- straight arms

@case("straight-arm", "How a straight arm finds out", compiled=False)
def straight_arm(lesson):
    """Two straight links and a target on their axis at d < reach: nothing moves, but a disturbance grows.

    With  H = JᵀJ − e · ∂²x:  transpose 1 − αH, damped 1 − (JᵀJ + λ²)⁻¹H; the largest eigenvalue is above 1.
    CCD: the second link points at the target, −l₁φ/(d − l₁) for a small φ of the first; that one then turns by what is
    left: factor l₂ d/((l₁ + l₂)(d − l₁)).  FABRIK: joint 1 goes aside by l₂/(d − l₁) and l₁/(d − l₂): the product.
    """
    found, lengths, rest = [], np.array([1.0, 0.8]), np.zeros(2)
    labels = {"transpose_step": "transpose", "damped_step": "damped", "ccd_step": "CCD", "fabrik_step": "FABRIK"}
    distances, drawn, laws = np.linspace(1.2, 1.7, 6), {name: [] for name in labels}, {name: [] for name in labels}
    J, gain, damping = jacobian_of(rest, lengths), 0.2, 0.5
    for d in distances:
        e = np.array([d - 1.8, 0.0])
        H = J.T @ J - curvature_of(rest, lengths, e)
        laws["transpose_step"].append(np.max(np.linalg.eigvals(np.eye(2) - gain * H).real))
        damped = np.eye(2) - np.linalg.solve(J.T @ J + damping**2 * np.eye(2), H)
        laws["damped_step"].append(np.max(np.linalg.eigvals(damped).real))
        laws["ccd_step"].append(0.8 * d / (1.8 * (d - 1.0)))
        laws["fabrik_step"].append(0.8 / ((d - 1.0) * (d - 0.8)))
        for name in drawn:
            arm = arm_of(lesson, lengths, gain, damping)
            drawn[name].append(growth(lesson, name, arm, rest, (d, 0.0), np.array([0.6, 0.8]), 60))
    for name, factors in drawn.items():
        k = int(np.argmax(np.abs(np.array(factors) - laws[name])))
        found.append(finding(
            claim="A straight arm is a saddle: each iteration multiplies a small bend by a factor above 1.",
            quantity=f"factor per iteration of {name}, target at {distances[k]:.1f} m [-]",
            predicted=laws[name][k],
            measured=factors[k],
            tolerance=FOUR_DIGITS * laws[name][k],
            observation=f"{name}: a bend grows by {min(factors):.3f} to {max(factors):.3f} per iteration.",
        ))
    found += near_singular(lesson)
    for name in ("transpose_step", "pseudo_inverse_step", "damped_step", "ccd_step", "fabrik_step", "limited_step"):
        arm = arm_of(lesson, lengths, gain, damping)
        moved = np.max(np.abs(after(lesson, name, arm, rest, (1.4, 0.0), 50)))
        found.append(finding(
            claim="A straight arm whose target is on its axis beyond the last joint does not move at all.",
            quantity=f"largest angle after 50 iterations of {name} [rad]",
            predicted=0.0,
            measured=moved,
            tolerance=0.0,
            observation=f"{name}: {moved:g} rad after 50 iterations.",
        ))
    curves = [curve for name, label in labels.items() for curve in (
        series(f"theory, {label}", distances, np.log10(laws[name]), LINE),
        series(label, distances, np.log10(drawn[name]), DOTS))]
    return found, Picture("Out of a straight arm", "distance of the target [m]", "log₁₀ of the growth per iteration",
                          curves,
                          "FABRIK leaves a nearly straight arm fastest.  No method leaves an exactly straight one.")


def near_singular(lesson):
    """Findings on an arm that is bent by ε: the pseudo-inverse jumps as 1/ε, a damped step stays below |e|/(2λ)."""
    found, lengths = [], np.array([1.0, 0.8])
    for bend in (1e-2, 1e-4, 1e-6):
        theta = np.array([0.0, bend])
        u, sigma, _ = np.linalg.svd(jacobian_of(theta, lengths))
        target = end_of(theta, lengths) + 0.3 * u[:, 1]
        jump = np.linalg.norm(after(lesson, "pseudo_inverse_step", arm_of(lesson, lengths), theta, target, 1) - theta)
        found.append(finding(
            claim="Along the direction that the arm can hardly move, the pseudo-inverse asks for |e|/σ₂.",
            quantity=f"step times σ₂ over |e|, bent by {bend:g} rad [-]",
            predicted=1.0,
            measured=jump * sigma[1] / 0.3,
            tolerance=1e-14 / bend,
            observation=f"Bent by {bend:g} rad, an error of 30 cm makes it turn its joints by {jump:.3g} rad.",
        ))
    for damping in (0.05, 0.3):
        def share(bend, damping=damping):
            theta = np.array([0.0, bend])
            u = np.linalg.svd(jacobian_of(theta, lengths))[0]
            target = end_of(theta, lengths) + 0.3 * u[:, 1]
            step = after(lesson, "damped_step", arm_of(lesson, lengths, damping=damping), theta, target, 1) - theta
            return np.linalg.norm(step) * 2.0 * damping / 0.3
        largest = -minimize_scalar(lambda bend: -share(bend), bounds=(1e-4, 1.5), method="bounded",
                                   options={"xatol": 1e-8}).fun
        found.append(finding(
            claim="No damped step is longer than |e|/(2λ); at σ = λ one is as long.",
            quantity=f"longest step over |e|/(2λ), λ = {damping:g} m [-]",
            predicted=1.0,
            measured=largest,
            tolerance=1e-9,
            observation=f"With λ = {damping:g} m the longest step over all bends is {largest:.6f} of the bound.",
        ))
    return found


# ---------------------------------------------------------------------------------------------- out of reach

@case("far-targets", "A thousand times too far", compiled=False)
def far_targets(lesson):
    """A target out of reach at d: the arm comes to rest straight at d − reach, if the damping is enough.

    At rest  H = JᵀJ + S,  S = −e · ∂²x, positive.  A damped step multiplies by  1 − (JᵀJ + λ²)⁻¹ H,  which is stable
    while no eigenvalue of (JᵀJ + λ²)⁻¹ H is above 2:  λ² > ½ of the largest eigenvalue of S − JᵀJ.
    """
    found, lengths, bearing = [], np.array([1.0, 0.7, 0.4]), 0.7
    reach, way, rest = 2.1, np.array([np.cos(bearing), np.sin(bearing)]), np.array([bearing, 0.0, 0.0])
    J, times, edges, laws = jacobian_of(rest, lengths), (1.5, 3.0, 10.0, 100.0, 1000.0), [], []
    for far in times:
        e = (far - 1.0) * reach * way
        values, vectors = np.linalg.eigh(-curvature_of(rest, lengths, e) - J.T @ J)
        laws.append(0.5 * values[-1])
        edges.append(bisect(lambda square, target=far * reach * way, away=vectors[:, -1]: growth(
            lesson, "damped_step", arm_of(lesson, lengths, damping=np.sqrt(square)), rest, target, away, 60) < 1.0,
            0.05 * laws[-1], 20.0 * laws[-1]))
        found.append(finding(
            claim="A damped search for a target out of reach comes to rest only above a damping that grows with |e|.",
            quantity=f"least λ² for a target at {far:g} reaches [m²]",
            predicted=laws[-1],
            measured=edges[-1],
            tolerance=FOUR_DIGITS * laws[-1],
            observation=f"At {far:g} reaches a search with λ² below {edges[-1]:.4g} m² trembles.",
        ))
    for name in ("damped_step", "limited_step", "transpose_step", "ccd_step", "fabrik_step"):
        e = 999.0 * reach
        arm = arm_of(lesson, lengths, 1.0 / (3.0 * reach * (e + reach)), np.sqrt(1.5 * reach * e))
        iterations = 1500 if name == "transpose_step" else 400
        end = end_of(after(lesson, name, arm, (0.5, 0.5, 0.5), 1000.0 * reach * way, iterations), lengths)
        found.append(finding(
            claim="An arm whose target is a thousand reaches away points at it.",
            quantity=f"distance of the end from where a straight arm has it, {name} [m]",
            predicted=0.0,
            measured=np.linalg.norm(end - reach * way),
            tolerance=1e-12,
            observation=f"{name}: {np.linalg.norm(end - reach * way):.0e} m aside after {iterations} iterations.",
        ))
    return found, Picture("Damping that a far target needs", "log₁₀ of its distance over the reach",
                          "log₁₀ of the least λ² [m²]", [
        series("theory", np.log10(times), np.log10(laws), LINE),
        series("measured", np.log10(times), np.log10(edges), DOTS)],
        "Without it the arm flails: out of reach, more damping is not caution but a condition.")


# ---------------------------------------------------------------------------------------------- many links

@case("two-to-two-hundred-links", "Two to two hundred links", compiled=False)
def two_to_two_hundred_links(lesson):
    """All methods reach a target at 0.6 of the reach, and the damped step contracts in the end by λ²/(σ₂² + λ²).

    An angle is rounded by 1.1e-16 and moves the end by the reach: n roundings, n · 1e-15 of the reach.  The factor is
    a central difference over 1e-6 rad: a rounding of the end over that, and a few, is 1e-9.
    """
    found, sizes, drawn = [], (2, 5, 20, 200), {}
    for name in ("ccd_step", "fabrik_step", "damped_step"):
        drawn[name] = []
        for n in sizes:
            lengths, theta = np.full(n, 1.0 / n), np.full(n, 1.0 / n)
            target, damping = 0.6 * np.array([np.cos(1.0), np.sin(1.0)]), 0.3
            angles, _, count = lesson.solve_reach(getattr(lesson, name), lesson.reach_2d, theta, target, ARRIVED, 500,
                                                  arm_of(lesson, lengths, damping=damping))
            drawn[name].append(count)
            off = np.linalg.norm(end_of(angles, lengths) - target)
            found.append(finding(
                claim="A chain of any number of links reaches a target within its reach.",
                quantity=f"way that is left, {name}, {n} links, over the reach [-]",
                predicted=0.0,
                measured=off,
                tolerance=1.1 * ARRIVED + 1e-15 * n,
                observation=f"{name}, {n} links: {count} iterations.",
            ))
            if name == "damped_step":
                found.append(contraction(lesson, lengths, angles, damping))
    labels = {"ccd_step": "CCD", "fabrik_step": "FABRIK", "damped_step": "damped, λ = 0.3 reach"}
    curves = [series(labels[name], np.log10(sizes), np.log10(np.maximum(counts, 1)), DOTS)
              for name, counts in drawn.items()]
    return found, Picture(
        "Iterations to 10⁻⁹ of the reach", "log₁₀ of the number of links", "log₁₀ of the iterations", curves,
        "The number of links hardly matters; an iteration costs in proportion to it.")


def contraction(lesson, lengths, angles, damping):
    """The Finding on what a damped iteration leaves of an error along u₂, at the answer."""
    n = len(lengths)
    u, sigma, v = np.linalg.svd(jacobian_of(angles, lengths), full_matrices=False)
    target, arm = end_of(angles, lengths), arm_of(lesson, lengths, damping=damping)
    ends = [end_of(after(lesson, "damped_step", arm, angles + sign * 1e-6 * v[1], target, 1), lengths)
            for sign in (1.0, -1.0)]
    factor, law = u[:, 1] @ (ends[0] - ends[1]) / (2e-6 * sigma[1]), damping**2 / (sigma[1] ** 2 + damping**2)
    return finding(
        claim="In the end the damped step leaves λ²/(σ₂² + λ²) of the error.",
        quantity=f"factor per iteration, {n} links [-]",
        predicted=law,
        measured=factor,
        tolerance=1e-9,
        observation=f"{n} links: {factor:.6f} of the error is left after an iteration.",
    )


# ---------------------------------------------------------------------------------------------- conflicts

def elbow_and_end(theta, target, arm):
    """Task: the second joint at target[:2] and the end at target[2:], which may be impossible together."""
    x, n = joints_of(theta, arm.lengths), len(theta)
    J = np.vstack((np.column_stack((jacobian_of(theta[:2], arm.lengths[:2]), np.zeros((2, n - 2)))),
                   jacobian_of(theta, arm.lengths)))
    return np.concatenate((target[:2] - x[2], target[2:] - x[n])), J


@case("conflicting-targets", "Two targets, one arm", compiled=False)
def conflicting_targets(lesson):
    """Two targets that exclude each other: every method with a Jacobian comes to rest where Σ|e|² is smallest nearby.

    Where it rests, Jᵀe = 0.  SciPy's least squares finds the same minimum from there; the transpose and the damped step
    leave 1e-9 of the angles after their iterations, which is 1e-17 of a minimum.
    """
    found, lengths, left = [], np.array([1.0, 0.8, 0.6]), []
    pulls = ((0.9, 0.9, 1.9, -0.4), (1.2, 1.0, -0.5, 1.5), (0.0, 1.5, 1.2, 1.2))
    for target in pulls:
        target = np.array(target)
        best = least_squares(lambda theta, target=target: elbow_and_end(theta, target, arm_of(lesson, lengths))[0],
                             (0.5, 0.5, 0.5), xtol=1e-15, ftol=1e-15, gtol=1e-15)
        smallest = np.sqrt(2.0 * best.cost)
        left.append(smallest)
        for name in ("transpose_step", "damped_step"):
            arm = arm_of(lesson, lengths, 0.12, 1.0)
            angles = after(lesson, name, arm, (0.5, 0.5, 0.5), target, 1800, elbow_and_end)
            e, J = elbow_and_end(angles, target, arm)
            found.append(finding(
                claim="Conflicting targets end in the compromise with the smallest Σ|e|².",
                quantity=f"|e| of {name}, targets {target} [m]",
                predicted=smallest,
                measured=np.linalg.norm(e),
                tolerance=1e-12,
                observation=f"{name}: |e| = {np.linalg.norm(e):.6f} m, and |Jᵀe| = {np.linalg.norm(e @ J):.0e} m².",
            ))
    numbers = np.arange(1.0, len(pulls) + 1.0)
    return found, Picture("What no arm can satisfy", "pair of targets", "|e| of the compromise [m]", [
        series("least squares", numbers, left, LINE),
        series("transpose", numbers, [f.measured for f in found[::2]], DOTS),
        series("damped", numbers, [f.measured for f in found[1::2]], DOTS)],
        "A task is what is stacked into e: any number of rows, and the methods stay the same.")


@case("limits-that-forbid", "Limits that forbid the target", compiled=False)
def limits_that_forbid(lesson):
    """Two links whose elbow bends by B at most, and a target nearer than that allows: r² = l₁² + l₂² + 2 l₁l₂ cos B.

    The free first joint turns to the bearing of the target, and r − d is left.  If the first joint has limits, too, the
    target is seen from the end at an angle that neither joint may close: |r e^{iA} − target| is left at the corner A.
    """
    found, lengths, bends, measured = [], np.array([1.0, 0.7]), (0.3, 0.6, 1.0, 1.5), []
    outer = lambda bend: np.sqrt(1.49 + 1.4 * np.cos(bend))
    for bend in bends:
        arm = arm_of(lesson, lengths, damping=0.7, low=np.array([-np.inf, 0.0]), high=np.array([np.inf, bend]))
        for name in ("limited_step", "ccd_step"):
            angles = after(lesson, name, arm, (0.1, 0.1), (0.3, 0.5), 600)
            left, law = np.linalg.norm(end_of(angles, lengths) - (0.3, 0.5)), outer(bend) - np.hypot(0.3, 0.5)
            measured += [left] if name == "limited_step" else []
            found.append(finding(
                claim="An elbow that may not bend further leaves r − d.",
                quantity=f"way that is left, {name}, elbow up to {bend:g} rad [m]",
                predicted=law,
                measured=left,
                tolerance=1e-12,
                observation=f"{name}: the elbow stops at {angles[1]:.4f} rad, {left:.4f} m are left.",
            ))
    arm = arm_of(lesson, lengths, damping=0.7, low=np.array([-0.4, 0.2]), high=np.array([0.5, 0.9]))
    corner = end_of((0.5, 0.9), lengths)
    angles = after(lesson, "limited_step", arm, (0.0, 0.5), (0.1, 1.4), 2000)
    found.append(finding(
        claim="Where both joints are at their limits, the arm rests in that corner.",
        quantity="way that is left in the corner [m]",
        predicted=np.linalg.norm(corner - (0.1, 1.4)),
        measured=np.linalg.norm(end_of(angles, lengths) - (0.1, 1.4)),
        tolerance=1e-12,
        observation=f"It rests at ({angles[0]:.3f}, {angles[1]:.3f}) rad.",
    ))
    shut = arm_of(lesson, lengths, damping=0.7, low=np.array([0.2, 0.3]), high=np.array([0.2, 0.3]))
    angles = after(lesson, "limited_step", shut, (2.0, -1.0), (0.1, 1.4), 1)
    found.append(finding(
        claim="Limits that leave no freedom put the joints where they say.",
        quantity="largest angle off equal limits [rad]",
        predicted=0.0,
        measured=np.max(np.abs(angles - (0.2, 0.3))),
        tolerance=0.0,
        observation=f"Between equal limits it stands at ({angles[0]:g}, {angles[1]:g}) rad.",
    ))
    fine = np.linspace(0.2, 1.6, 40)
    return found, Picture("An elbow with a limit", "limit of the elbow [rad]", "way that is left [m]", [
        series("theory, r − d", fine, outer(fine) - np.hypot(0.3, 0.5), LINE),
        series("damped, with limits", bends, measured, DOTS)],
        "Limits make the hole in the middle of the reach larger.")


# ---------------------------------------------------------------------------------------------- in space

X, Y, Z = np.eye(3)
AXES, OFFSETS = np.stack((Z, Y, Y, X, Y, X)), np.stack((0.4 * Z, 0.6 * X, 0.3 * X, 0.2 * X, 0.1 * X, 0.2 * X + 0.1 * Z))
SIX = np.array([0.5, -0.6, 0.9, 0.3, 0.5, 0.2])


def pose_error(theta, x, R):
    """(x − end, rotation vector from the last link to R) (6,), by matrices and SciPy."""
    end, here = spatial_end(theta, AXES, OFFSETS)
    return np.append(x - end, Rotation.from_matrix(R @ here.T).as_rotvec())


@case("six-joints-in-space", "Six joints in space", compiled=False)
def six_joints_in_space(lesson):
    """A damped step in space leaves λ²/(σ² + λ²) of a small error of the pose, along each of six directions.

    J comes from central differences of matrices: 1e-10 of it is wrong, and of the small σ that is 1e-9.  Factors are
    central differences over 1e-5 rad, with 1e-10 from their third order and from round-off.
    """
    found, (x, R), h = [], spatial_end(SIX, AXES, OFFSETS), 1e-5
    slopes = [-(pose_error(SIX + d, x, R) - pose_error(SIX - d, x, R)) / (2.0 * h) for d in h * np.eye(6)]
    u, sigma, v = np.linalg.svd(np.stack(slopes, axis=1))
    damping, factors = 0.2, []
    arm = lesson.make_arm_3d(AXES, OFFSETS, 0.0, damping, -np.inf, np.inf, 0.0, 0.0)
    target = np.append(x, np.roll(Rotation.from_matrix(R).as_quat(), 1))
    for i in range(6):
        ends = [lesson.advance_reach(lesson.damped_step, lesson.pose_3d, SIX + s * h * v[i], target, 1, arm)
                for s in (1.0, -1.0)]
        left = [pose_error(theta, x, R) for theta in ends]
        factors.append(-u[:, i] @ (left[0] - left[1]) / (2.0 * h * sigma[i]))
        law = damping**2 / (sigma[i] ** 2 + damping**2)
        found.append(finding(
            claim="A damped step leaves λ²/(σ² + λ²) of an error of place and orientation.",
            quantity=f"factor per iteration along the axis with σ = {sigma[i]:.4f} [-]",
            predicted=law,
            measured=factors[-1],
            tolerance=1e-7,
            observation=f"σ = {sigma[i]:.4f}: {factors[-1]:.6f} of the error is left.",
        ))
    found += [ellipse(lesson, bend) for bend in (1.0, 1e-3, 1e-7)] + [posture(lesson)]
    fine = np.linspace(sigma[-1], sigma[0], 60)
    return found, Picture("What one iteration leaves", "σ [m, or 1 for a rotation]", "factor [-]", [
        series("theory, λ²/(σ² + λ²)", fine, damping**2 / (fine**2 + damping**2), LINE),
        series("measured", sigma, factors, DOTS)],
        "In space as in the plane: what the arm can hardly move comes last.")


def ellipse(lesson, bend):
    """The Finding on the half axes of two links that are bent so little.

    σ₁ σ₂ = l₁ l₂ sin θ₂.  J is rounded by 1e-16, which is 1e-16 over the bend of that.
    """
    lengths = np.array([1.0, 0.7])
    longer, shorter, _ = lesson.velocity_ellipse(lesson.jacobian_2d(joints_of((0.4, bend), lengths)))
    product = longer * shorter / (0.7 * np.sin(bend))
    return finding(
        claim="The half axes of two links multiply to l₁ l₂ sin θ₂, however straight they are.",
        quantity=f"σ₁ σ₂ over l₁ l₂ sin θ₂, bent by {bend:g} rad [-]",
        predicted=1.0,
        measured=product,
        tolerance=1e-15 / bend + 1e-14,
        observation=f"Bent by {bend:g} rad σ₂ is {shorter:.4g} m.",
    )


def posture(lesson):
    """The Finding on what a pull to rest does to the end: nothing to first order, so a quarter for half of the pull."""
    lengths, theta = np.array([1.0, 0.8, 0.6, 0.4]), np.array([0.3, 0.6, 0.5, 0.4])
    target, moved = end_of(theta, lengths), []
    for pull in (2e-3, 1e-3):
        arm = lesson.make_arm_2d(lengths, 0.0, 0.0, -np.inf, np.inf, (0.9, -0.2, 0.4, 0.8), pull)
        moved.append(np.linalg.norm(end_of(after(lesson, "null_space_step", arm, theta, target, 1), lengths) - target))
    return finding(
        claim="A pull to rest moves the end by the square of the pull: the null space is one of first order.",
        quantity="way of the end over that with half of the pull [-]",
        predicted=4.0,
        measured=moved[0] / moved[1],
        tolerance=0.01,
        observation=f"The end moves by {moved[0]:.1e} m, and with half of the pull by {moved[1]:.1e} m.",
    )


# ---------------------------------------------------------------------------------------------- extremes

@case("extremes", "Impossible arms and targets", compiled=False)
def extremes(lesson):
    """Both edges of the ring, the centre of one without a hole, angles of many turns, and values that are refused."""
    found, way = [], np.array([np.cos(2.0), np.sin(2.0)])
    for lengths in ((1.0, 1.0), (1.0, 0.6), (1.0, 1e-6), (1e-3, 1e3)):
        edges = [r for r in annulus(lengths) if r > 0.0]
        off = max(np.linalg.norm(end_of(lesson.solve_2r(r * way, np.array(lengths), elbow), lengths) - r * way)
                  for r in edges for elbow in (1.0, -1.0)) / sum(lengths)
        found.append(finding(
            claim="The closed form reaches both edges of the ring.",
            quantity=f"way that is left at the edges over the reach, lengths {lengths[0]:g} and {lengths[1]:g} m [-]",
            predicted=0.0,
            measured=off,
            tolerance=1e-14,
            observation=f"Lengths {lengths[0]:g} and {lengths[1]:g} m: {off:.0e} of the reach is left at the edges.",
        ))
    centre = end_of(lesson.solve_2r(np.zeros(2), np.ones(2), 1.0), (1.0, 1.0))
    found.append(finding(
        claim="Two equal links fold to reach their own base.",
        quantity="way that is left to the base [m]",
        predicted=0.0,
        measured=np.linalg.norm(centre),
        tolerance=1e-15,
        observation=f"Folded, the end is {np.linalg.norm(centre):.0e} m from the base.",
    ))
    turns = np.array([0.4, 0.9, 0.7]) + 2.0 * np.pi * np.array([1e6, -1e6, 1e6])
    lengths = np.array([1.0, 0.7, 0.4])
    off = np.linalg.norm(lesson.joint_positions(turns, lengths)[-1] - end_of((0.4, 0.9, 0.7), lengths))
    found.append(finding(
        claim="A million turns change nothing but the rounding of the angle, 1e-9 rad.",
        quantity="distance of the end from where it is without the turns [m]",
        predicted=0.0,
        measured=off,
        tolerance=5e-9,
        observation=f"After a million turns the end is {off:.0e} m aside.",
    ))
    found.append(refusals(lesson))
    limits = np.linspace(-3.0, 0.0, 7)
    off = [np.linalg.norm(end_of(lesson.solve_2r((1.6 - 10.0**k) * way, np.array([1.0, 0.6]), 1.0), (1.0, 0.6))
                          - (1.6 - 10.0**k) * way) for k in limits]
    return found, Picture("Close to the edge of the reach", "log₁₀ of the distance from the edge [m]",
                          "log₁₀ of the way that is left [m]", [
        series("closed form", limits, np.log10(np.maximum(off, 1e-17)), DOTS),
        series("a few roundings", limits, np.full(7, -15.0), LINE)],
        "The closed form is as good at the edge as anywhere.")


def refusals(lesson):
    """The Finding on what is no arm and no search."""
    make = lambda lengths=(1.0, 0.7), gain=0.1, damping=0.3, low=-np.inf, high=np.inf: lesson.make_arm_2d(
        lengths, gain, damping, low, high, 0.0, 0.5)
    search = lambda theta=(0.1, 0.2), target=(0.9, 0.8), tolerance=1e-6, most=9: lesson.solve_reach(
        lesson.damped_step, lesson.reach_2d, theta, target, tolerance, most, make())
    spatial = lambda axis: lesson.make_arm_3d([axis], [(1.0, 0.0, 0.0)], 0.1, 0.3, -np.inf, np.inf, 0.0, 0.5)
    asked = (
        (lambda: make(lengths=(1.0, -0.7)), "-0.7"), (lambda: make(lengths=(1.0, 0.0)), "0.0"),
        (lambda: make(lengths=(1.0, np.nan)), "nan"), (lambda: make(gain=-0.1), "-0.1"),
        (lambda: make(damping=-0.3), "-0.3"), (lambda: make(damping=np.inf), "inf"),
        (lambda: make(low=0.5, high=0.25), "0.5"), (lambda: make(low=np.nan), "nan"),
        (lambda: spatial((0.0, 0.0, 2.0)), "2.0"), (lambda: spatial((0.0, 0.0, 0.0)), "0.0"),
        (lambda: search(theta=(0.1, np.nan)), "nan"), (lambda: search(target=(0.9, np.inf)), "inf"),
        (lambda: search(theta=(0.1, 0.2, 0.3)), "(3,)"), (lambda: search(target=(0.9, 0.8, 0.1)), "(3,)"),
        (lambda: search(tolerance=-1.0), "-1.0"), (lambda: search(most=2.5), "2.5"), (lambda: search(most=-1), "-1"),
        (lambda: lesson.solve_2r(np.array([2.0, 0.0]), np.array([1.0, 0.7]), 1.0), "2.0"),
        (lambda: lesson.solve_2r(np.array([0.25, 0.0]), np.array([1.0, 0.7]), 1.0), "0.25"),
    )
    refused = sum(refuses(function, (), value) for function, value in asked)
    try:
        after(lesson, "transpose_step", make(gain=1e200), (0.1, 0.2), (1e200, 0.0), 5)
        lost = 0
    except Diverged:
        lost = 1
    return finding(
        claim="Impossible lengths, limits, axes and targets are refused with their value, and what overflows has "
              "diverged.",
        quantity=f"calls that end in such a sentence [of {len(asked) + 1}]",
        predicted=len(asked) + 1,
        measured=refused + lost,
        tolerance=0.0,
        observation=f"{refused + lost} of {len(asked) + 1} such calls end in a sentence that names the value.",
    )


# ---------------------------------------------------------------------------------------------- each function by itself

TRIED = 50                   # random arms [-]
STEP = 1e-5                  # of a central difference [rad]: its third order and round-off are 5e-11 of a metre


@case("geometry-of-arms", "Ellipse, rotation, limits and null space", compiled=False)
def geometry_of_arms(lesson):
    """The ellipse by singular values, the error of a rotation by SciPy, and a step with limits or with a rest posture.

    A damped step between limits is that of the joints that are free to go; one at its limit is free to go inwards.
    """
    rng = np.random.default_rng(111)
    worst = Worst()
    for _ in range(TRIED):
        J = rng.normal(size=(2, 4))
        u, sigma, _ = np.linalg.svd(J)
        longer, shorter, angle = lesson.velocity_ellipse(J)
        along = abs(u[:, 0] @ (np.cos(angle), np.sin(angle)))                # 1 where it is the longer axis, either way
        worst.keep("ellipse", abs(longer - sigma[0]), abs(shorter - sigma[1]), abs(along - 1.0))

        here, turn = Rotation.random(rng=rng), rng.normal(size=3)
        turn *= rng.uniform(0.1, 3.1) / np.linalg.norm(turn)                 # short of half a turn, the long way often
        quaternions = [sign * np.roll(r.as_quat(), 1)
                       for r, sign in ((here, 1.0), (Rotation.from_rotvec(turn) * here, rng.choice((-1.0, 1.0))))]
        worst.note("rotation", lesson.rotation_error(*quaternions), turn)

        lengths, theta, damping = rng.uniform(0.5, 1.0, 4), rng.uniform(-1.0, 1.0, 4), rng.uniform(0.1, 0.5)
        low, high = theta - rng.choice((0.0, 0.05, 3.0), 4), theta + rng.choice((0.0, 0.05, 3.0), 4)
        target = end_of(theta, lengths) + 0.5 * rng.normal(size=2)
        e, J = target - end_of(theta, lengths), jacobian_of(theta, lengths)
        wish = J.T @ e
        blocked = ((theta >= high) & (wish > 0.0)) | ((theta <= low) & (wish < 0.0))
        J[:, blocked] = 0.0
        truth = np.clip(theta + np.linalg.solve(J.T @ J + damping**2 * np.eye(4), J.T @ e), low, high)
        arm = lesson.make_arm_2d(lengths, 0.0, damping, low, high, 0.0, 0.0)
        worst.note("limits", lesson.limited_step(lesson.reach_2d, theta, target, arm), truth)

        # with the end on its target, the step goes to the rest posture as far as the end stays, to first order
        rest, pull, J = rng.uniform(-1.0, 1.0, 4), 0.1, jacobian_of(theta, lengths)
        arm = lesson.make_arm_2d(lengths, 0.0, 0.0, -np.inf, np.inf, rest, pull)
        got = lesson.null_space_step(lesson.reach_2d, theta, end_of(theta, lengths), arm) - theta
        free = np.linalg.svd(J)[2][2:]                                       # two directions that do not move the end
        truth = free.T @ (free @ (pull * (rest - theta)))
        worst.note("rest", got, truth)

        # a search counts its iterations, as this loop does
        target, arm, count = end_of(theta + 0.3, lengths), lesson.make_arm_2d(lengths, 0.0, 0.1, -9.0, 9.0, 0.0, 0.0), 0
        angles = theta
        while np.linalg.norm(target - end_of(angles, lengths)) > 1e-6 and count < 50:
            angles, count = lesson.damped_step(lesson.reach_2d, angles, target, arm), count + 1
        found, error, iterations = lesson.solve_reach(lesson.damped_step, lesson.reach_2d, theta, target, 1e-6, 50, arm)
        worst.keep("search", abs(iterations - count), np.max(np.abs(found - angles)),
                   abs(error - np.linalg.norm(target - end_of(angles, lengths))))

        x = np.concatenate((np.zeros((1, 3)), np.cumsum(rng.normal(size=(4, 3)), axis=0))) + rng.normal(size=3)
        swept = lesson.fabrik_sweep(x, rng.normal(size=3), lengths)
        worst.keep("base", np.max(np.abs(swept[0] - x[0])))
        worst.keep("links", np.max(np.abs(np.linalg.norm(np.diff(swept, axis=0), axis=1) - lengths)))
        worst.note("alike", lesson.point_at(x[0], x[0], lengths[0]), x[0] + lengths[0] * X)

        # angles from a target, in every quadrant; the second link is the longer one as often as not
        angles = rng.uniform(-3.1, 3.1, 3)
        elbow = np.sign(angles[1])
        angles[1] = elbow * rng.uniform(0.1, 3.0)
        end = end_of(angles[:2], lengths[:2])
        worst.note("closed form", lesson.solve_2r(end, lengths, elbow), angles[:2])
        whole = np.array([*end_of(angles, lengths[:3]), np.remainder(np.sum(angles), 2.0 * np.pi)])
        worst.note("closed form", lesson.solve_3r(whole, lengths, elbow), angles)
        hole = 0.9 * abs(lengths[0] - lengths[1]) * end / np.linalg.norm(end)
        worst.keep("hole", not refuses(lesson.solve_2r, (hole, lengths, elbow)))

        # of any size; every other matrix has two rows alike
        M, size = rng.normal(size=(3, 4)), 10.0 ** rng.uniform(-12.0, 12.0)
        M[2] = M[1] if elbow > 0.0 else M[2]
        worst.note("inverse", size * lesson.pseudo_inverse(size * M), np.linalg.pinv(M, 1e-10))

        # each joint, from the last one on, turns the end towards the target as far as it may
        low, high = theta - rng.choice((0.0, 0.05, 9.0), 4), theta + rng.choice((0.0, 0.05, 9.0), 4)
        arm = lesson.make_arm_2d(lengths, 0.0, 0.0, low, high, 0.0, 0.0)
        target, truth = rng.normal(size=2), theta.copy()
        for k in range(3, -1, -1):
            joints = joints_of(truth, lengths) @ (1.0, 1j)
            truth[k] = np.clip(truth[k] + np.angle((target @ (1.0, 1j) - joints[k]) / (joints[4] - joints[k])),
                               low[k], high[k])
        worst.note("turns", lesson.ccd_step(lesson.reach_2d, theta, target, arm), truth)
        thetas = lesson.reach_trajectory(lesson.ccd_step, lesson.reach_2d, theta, target, 2, arm)
        worst.note("history", thetas, np.array([theta, truth, lesson.ccd_step(lesson.reach_2d, truth, target, arm)]))
        targets, arm = rng.normal(size=(2, 2)), lesson.make_arm_2d(lengths, 0.0, 0.3, -9.0, 9.0, 0.0, 0.0)
        many = lesson.solve_targets(lesson.damped_step, lesson.reach_2d, theta, targets, 1e-6, 3, arm)
        each = [lesson.solve_reach(lesson.damped_step, lesson.reach_2d, theta, one, 1e-6, 3, arm) for one in targets]
        worst.note("many", many, tuple(np.array(part) for part in zip(*each)))

        # in space: the way to the target and the change of the end, by matrices
        six, place = rng.uniform(-2.0, 2.0, 6), rng.normal(size=3)
        arm, (x, R) = lesson.make_arm_3d(AXES, OFFSETS, 0.0, 0.1, -9.0, 9.0, 0.0, 0.0), spatial_end(six, AXES, OFFSETS)
        e, J = lesson.reach_3d(six, place, arm)
        slope = [spatial_end(six + d, AXES, OFFSETS)[0] - spatial_end(six - d, AXES, OFFSETS)[0]
                 for d in STEP * np.eye(6)]
        pose = lesson.end_pose(six, arm)
        worst.note("space", (e, pose[:3], Rotation.from_quat(np.roll(pose[3:], -1)).as_matrix()), (place - x, x, R))
        worst.note("slope", J, np.transpose(slope) / (2.0 * STEP))
    names = (
        ("ellipse", "The ellipse of velocities has the singular values as half axes, and u₁ as direction.",
         "half axes and direction [m, -]"),
        ("rotation", "The error of an orientation is the shortest rotation vector, of q and of −q.", "rotation [rad]"),
        ("limits", "Joints that are free to move between their limits take a damped step.", "angles with limits [rad]"),
        ("rest", "A rest posture attracts the arm by motions that leave the end in its place.", "angles [rad]"),
        ("search", "A search ends when it is near enough, and counts its iterations.", "search [-, rad, m]"),
        ("base", "A sweep of FABRIK leaves the base where it was.", "place of the base [m]"),
        ("links", "A sweep of FABRIK leaves each link its own length.", "lengths of links [m]"),
        ("alike", "What has no direction goes along the first axis.", "place [m]"),
        ("closed form", "The closed forms return the angles from −π to π that led to a target.",
         "angles of closed forms [rad]"),
        ("hole", "A target in the hole is refused, whichever link is longer.", "refusals that are missing [-]"),
        ("inverse", "The pseudo-inverse is that of the singular values, whatever the unit of length is.",
         "J⁺ times the size [-]"),
        ("turns", "In cyclic descent each joint in turn points the end at the target, within its limits.",
         "angles after a sweep [rad]"),
        ("history", "A history holds each iteration, from where the one before ended.", "angles of a history [rad]"),
        ("many", "Of many targets each is looked for from the same angles.", "searches [rad, m, -]"),
        ("space", "In space the end is where products of rotations have it.", "end in space [m, -]"),
        ("slope", "In space J is the change of the end with the angles.", "J in space [m]"))
    return [agreement(claim, f"largest error of the {quantity}",
                      worst[name], 1e-9) for name, claim, quantity in names], None
