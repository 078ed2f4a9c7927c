"""Gains, straight arms, targets out of reach, conflicts and limits, and the laws of arms.

Bounds come from singular values and second derivatives of chains of complex numbers, never from the lesson.
*Source:* each case derives its theory; Bertsekas 1982 for limits.
"""

import numpy as np
from scipy.optimize import least_squares, minimize_scalar
from scipy.spatial.transform import Rotation

from solutions.checks import Diverged
from validate.reference.kinematics import annulus, curvature_of, end_of, jacobian_of, joints_of, spatial_end
from validate.stability.case import DOTS, LINE, Picture, bisect, case, log_series, random_law, refuses, series

SMALL = 1e-8                 # small disturbance [rad]: the linear theory is then right to 1e-8
FOUR_DIGITS = 1e-4           # of an edge that bisection finds, and of a factor, relative [-]
ARRIVED = 1e-9               # |e| over the reach at which a search ends [-]


def arm_of(lesson, lengths, gain=0.0, damping=0.0, low=-np.inf, high=np.inf):
    """Make a planar arm without a pull to a rest posture."""
    return lesson.make_arm_2d(np.array(lengths, float), gain, damping, low, high, 0.0, 0.0)


def after(lesson, name, arm, theta, target, iterations, task=None):
    """Return the angles after this number of iterations."""
    step, task = getattr(lesson, name), task or lesson.reach_2d
    return lesson.advance_reach(step, task, np.array(theta, float), np.array(target, float), iterations, arm)


def growth(lesson, name, arm, rest, target, away, iterations=40):
    """Return the factor per iteration by which the distance from angles at rest finally grows."""
    theta, total, counted = np.array(rest) + SMALL * away, 0.0, 0
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

def largest_gain(lesson, lengths, rest):
    """Return the largest stable gain [1/m²] by theory and by bisection, for an arm at rest on its target."""
    sigma, v = np.linalg.svd(jacobian_of(rest, lengths))[1:]
    law, target = 2.0 / sigma[0] ** 2, end_of(rest, lengths)
    unstable = lambda gain: growth(lesson, "transpose_step", arm_of(lesson, lengths, gain), rest, target, v[0]) > 1.0
    return law, bisect(unstable, 0.1 * law, 10.0 * law)


@case("transpose-gain", "The largest stable gain of the transpose", compiled=False)
def transpose_gain(lesson, check):
    """Compare the largest stable gain of the transpose with 2/σ₁².

    Near a target in reach the error along u_i is multiplied by 1 − α σ_i² per iteration.  At the edge the factor is −1.
    Forty iterations from 1e-8 rad show a relative difference of 1e-6 as 8e-5.
    """
    arms = (([1.0, 1.0], (0.3, 1.2)), ([1.0, 0.7, 0.4], (0.4, 0.9, 0.7)), ([0.1, 0.1], (0.3, 2.0)),
            ([1.0] * 10, [0.2] * 10))
    laws, edges = np.transpose([largest_gain(lesson, lengths, np.array(theta)) for lengths, theta in arms])
    for (lengths, _), law, edge in zip(arms, laws, edges, strict=True):
        name = f"{len(lengths)} links of reach {sum(lengths):g} m"
        check("The transpose converges for α < 2/σ₁², σ₁ the largest singular value of J.",
              f"largest gain, {name} [1/m²]", law=law, found=edge, within=FOUR_DIGITS * law,
              saw=f"{name} are stable up to a gain of {edge:.5g}/m².")
    fine = np.linspace(*np.log10([np.min(laws), np.max(laws)]), 20)
    return Picture("The largest gain", "log₁₀ of 2/σ₁²", "log₁₀ of the largest gain", [
        series("theory", fine, fine, LINE), log_series("measured", laws, edges, DOTS)],
        "A gain that suits one arm can be a hundred times too large for another: longer arms need smaller gains.")


# ---------------------------------------------------------------------------------------------- straight arms

STRAIGHT, TWO = np.zeros(2), np.array([1.0, 0.8])        # angles [rad] and lengths [m] of two links
GAIN, DAMPING = 0.2, 0.5     # of the methods on a straight arm [1/m²], [m]
LABELS = {"transpose_step": "transpose", "damped_step": "damped", "ccd_step": "CCD", "fabrik_step": "FABRIK"}


def factors_of_a_bend(d):
    """Return {method: factor per iteration of a small bend} for a target on the axis at d [m], by theory."""
    J = jacobian_of(STRAIGHT, TWO)
    H = J.T @ J - curvature_of(STRAIGHT, TWO, np.array([d - 1.8, 0.0]))
    damped = np.linalg.solve(J.T @ J + DAMPING**2 * np.eye(2), H)
    return {"transpose_step": np.max(np.linalg.eigvals(np.eye(2) - GAIN * H).real),
            "damped_step": np.max(np.linalg.eigvals(np.eye(2) - damped).real),
            "ccd_step": 0.8 * d / (1.8 * (d - 1.0)),
            "fabrik_step": 0.8 / ((d - 1.0) * (d - 0.8))}


@case("straight-arm", "The way out of a straight arm", compiled=False)
def straight_arm(lesson, check):
    """Compare the growth of a small bend of two straight links, with a target on their axis at d < reach, with theory.

    With  H = JᵀJ − e · ∂²x:  transpose 1 − αH, damped 1 − (JᵀJ + λ²)⁻¹H; the largest eigenvalue is above 1.  CCD:
    the second link points at the target, −l₁φ/(d − l₁) for a small φ of the first; then the first joint turns by
    the remaining angle: factor l₂ d/((l₁ + l₂)(d − l₁)).  FABRIK: joint 1 moves aside by l₂/(d − l₁) and l₁/(d −
    l₂): the product.
    """
    arm, distances, curves = arm_of(lesson, TWO, GAIN, DAMPING), np.linspace(1.2, 1.7, 6), []
    for name, label in LABELS.items():
        laws = np.array([factors_of_a_bend(d)[name] for d in distances])
        factors = [growth(lesson, name, arm, STRAIGHT, (d, 0.0), np.array([0.6, 0.8]), 60) for d in distances]
        k = np.argmax(np.abs(factors - laws))
        check("A straight arm is a saddle: each iteration multiplies a small bend by a factor above 1.",
              f"factor per iteration of {name}, target at {distances[k]:.1f} m [-]",
              law=laws[k], found=factors[k], within=FOUR_DIGITS * laws[k],
              saw=f"{name}: a bend grows by {np.min(factors):.3f} to {np.max(factors):.3f} per iteration.")
        curves += [series(f"theory, {label}", distances, np.log10(laws), LINE),
                   series(label, distances, np.log10(factors), DOTS)]
    near_singular(lesson, check)
    for name in ("transpose_step", "pseudo_inverse_step", "damped_step", "ccd_step", "fabrik_step", "limited_step"):
        moved = np.max(np.abs(after(lesson, name, arm, STRAIGHT, (1.4, 0.0), 50)))
        check("A straight arm whose target is on its axis beyond the last joint does not move at all.",
              f"largest angle after 50 iterations of {name} [rad]", law=0.0, found=moved, within=0.0,
              saw=f"{name}: {moved:g} rad after 50 iterations.")
    return Picture("Out of a straight arm", "distance of the target [m]", "log₁₀ of the growth per iteration", curves,
                   f"Of these, FABRIK leaves a nearly straight arm fastest; the damped steps have λ = {DAMPING:g} m, "
                   "and a smaller λ is faster.  No method leaves an exactly straight arm whose target is beyond its "
                   "last joint.")


def step_across(lesson, name, bend, damping=0.0):
    """Return (length of a step [rad], σ₂ [m]) of two links with a small bend, for an error of 30 cm along u₂."""
    theta = np.array([0.0, bend])
    u, sigma, _ = np.linalg.svd(jacobian_of(theta, TWO))
    target = end_of(theta, TWO) + 0.3 * u[:, 1]
    step = after(lesson, name, arm_of(lesson, TWO, damping=damping), theta, target, 1) - theta
    return np.linalg.norm(step), sigma[1]


def longest_step(lesson, damping):
    """Return the longest damped step of all bends, over |e|/(2λ)."""
    shorter = lambda bend: -step_across(lesson, "damped_step", bend, damping)[0] * 2.0 * damping / 0.3
    return -minimize_scalar(shorter, bounds=(1e-4, 1.5), method="bounded", options={"xatol": 1e-8}).fun


def near_singular(lesson, check):
    """Compare steps of an arm bent by ε with theory: J⁺ jumps as 1/ε, a damped step is at most |e|/(2λ)."""
    for bend in (1e-2, 1e-4, 1e-6):
        jump, sigma = step_across(lesson, "pseudo_inverse_step", bend)
        check("Along the direction in which the arm can hardly move, the step of the pseudo-inverse is |e|/σ₂.",
              f"step times σ₂ over |e|, bent by {bend:g} rad [-]",
              law=1.0, found=jump * sigma / 0.3, within=1e-14 / bend,
              saw=f"Bent by {bend:g} rad, an error of 30 cm makes it turn its joints by {jump:.3g} rad.")
    for damping in (0.05, 0.3):
        longest = longest_step(lesson, damping)
        check("No damped step is longer than |e|/(2λ); at σ = λ the step has this length.",
              f"longest step over |e|/(2λ), λ = {damping:g} m [-]", law=1.0, found=longest, within=1e-9,
              saw=f"With λ = {damping:g} m the longest step over all bends is {longest:.6f} of the bound.")


# ---------------------------------------------------------------------------------------------- out of reach

THREE = np.array([1.0, 0.7, 0.4])                        # lengths of three links [m]
REACH = 2.1                  # of these [m]
REST = np.array([0.7, 0.0, 0.0])                         # angles towards a far target [rad]
AWAY = np.array([np.cos(0.7), np.sin(0.7)])              # its direction


def least_damping(lesson, far):
    """Return the least λ² [m²] by theory and by bisection, for a target at `far` times the reach."""
    J, target = jacobian_of(REST, THREE), far * REACH * AWAY
    values, vectors = np.linalg.eigh(-curvature_of(REST, THREE, (far - 1.0) * REACH * AWAY) - J.T @ J)
    law = 0.5 * values[-1]
    settles = lambda square: growth(lesson, "damped_step", arm_of(lesson, THREE, damping=np.sqrt(square)), REST, target,
                                    vectors[:, -1], 60) < 1.0
    return law, bisect(settles, 0.05 * law, 20.0 * law)


@case("far-targets", "Targets a thousand times too far", compiled=False)
def far_targets(lesson, check):
    """Check that an arm comes to rest straight at d − reach from a target out of reach, if the damping is large enough.

    At rest  H = JᵀJ + S,  S = −e · ∂²x, positive.  A damped step multiplies by  1 − (JᵀJ + λ²)⁻¹ H,  which is stable
    if no eigenvalue of (JᵀJ + λ²)⁻¹ H is above 2:  λ² > ½ of the largest eigenvalue of S − JᵀJ.
    """
    times = (1.5, 3.0, 10.0, 100.0, 1000.0)
    laws, edges = np.transpose([least_damping(lesson, far) for far in times])
    for far, law, edge in zip(times, laws, edges, strict=True):
        check("A damped search for a target out of reach comes to rest only above a damping that grows with |e|.",
              f"least λ² for a target at {far:g} reaches [m²]", law=law, found=edge, within=FOUR_DIGITS * law,
              saw=f"At {far:g} reaches a search with λ² below {edge:.4g} m² does not come to rest.")
    e = 999.0 * REACH
    arm = arm_of(lesson, THREE, 1.0 / (3.0 * REACH * (e + REACH)), np.sqrt(1.5 * REACH * e))
    for name in ("damped_step", "limited_step", "transpose_step", "ccd_step", "fabrik_step"):
        iterations = 1500 if name == "transpose_step" else 400
        end = end_of(after(lesson, name, arm, (0.5, 0.5, 0.5), 1000.0 * REACH * AWAY, iterations), THREE)
        aside = np.linalg.norm(end - REACH * AWAY)
        check("An arm whose target is a thousand reaches away points at it.",
              f"distance of the end from where a straight arm has it, {name} [m]", law=0.0, found=aside, within=1e-12,
              saw=f"{name}: {aside:.0e} m aside after {iterations} iterations.")
    return Picture("Damping that a far target needs", "log₁₀ of its distance over the reach",
                   "log₁₀ of the least λ² [m²]", [
                       log_series("theory", times, laws, LINE),
                       log_series("measured", times, edges, DOTS)],
                   "With less damping a damped search does not come to rest, if its target is out of reach.")


# ---------------------------------------------------------------------------------------------- many links

@case("two-to-two-hundred-links", "Two to two hundred links", compiled=False)
def two_to_two_hundred_links(lesson, check):
    """Check that all methods reach a target at 0.6 of the reach, and that the damped step contracts by λ²/(σ₂² + λ²).

    An angle is rounded by 1.1e-16 and moves the end by the reach: n rounding errors, n · 1e-15 of the reach.  The
    factor is a central difference over 1e-6 rad: a few rounding errors of the end over that are 1e-9.
    """
    sizes, damping, target = (2, 5, 20, 200), 0.3, 0.6 * np.array([np.cos(1.0), np.sin(1.0)])
    curves, most = [], []
    for name, label in (("ccd_step", "CCD"), ("fabrik_step", "FABRIK"), ("damped_step", "damped, λ = 0.3 reach")):
        counts = []
        for n in sizes:
            lengths, theta = np.full(n, 1.0 / n), np.full(n, 1.0 / n)
            angles, _, count = lesson.solve_reach(getattr(lesson, name), lesson.reach_2d, theta, target, ARRIVED, 500,
                                                  arm_of(lesson, lengths, damping=damping))
            counts.append(count)
            check("A chain of any number of links reaches a target within its reach.",
                  f"way that is left, {name}, {n} links, over the reach [-]",
                  law=0.0, found=np.linalg.norm(end_of(angles, lengths) - target), within=1.1 * ARRIVED + 1e-15 * n,
                  saw=f"{name}, {n} links: {count} iterations.")
            if name == "damped_step":
                contraction(lesson, check, lengths, angles, damping)
        curves.append(log_series(label, sizes, np.maximum(counts, 1), DOTS))
        most.append(counts[-1])
    return Picture("Iterations to 10⁻⁹ of the reach", "log₁₀ of the number of links", "log₁₀ of the iterations", curves,
                   f"Two hundred links take {most[0]} iterations of CCD and {most[1]} of FABRIK, but {most[2]} damped "
                   "ones. The cost of an iteration is proportional to the number of links.")


def contraction(lesson, check, lengths, angles, damping):
    """Compare the fraction that a damped iteration leaves of an error along u₂, at the answer, with theory."""
    u, sigma, v = np.linalg.svd(jacobian_of(angles, lengths), full_matrices=False)
    target, arm = end_of(angles, lengths), arm_of(lesson, lengths, damping=damping)
    ends = [end_of(after(lesson, "damped_step", arm, angles + sign * 1e-6 * v[1], target, 1), lengths)
            for sign in (1.0, -1.0)]
    factor = u[:, 1] @ (ends[0] - ends[1]) / (2e-6 * sigma[1])
    check("Finally the damped step leaves λ²/(σ₂² + λ²) of the error.",
          f"factor per iteration, {len(lengths)} links [-]",
          law=damping**2 / (sigma[1] ** 2 + damping**2), found=factor, within=1e-9,
          saw=f"{len(lengths)} links: {factor:.6f} of the error is left after an iteration.")


# ---------------------------------------------------------------------------------------------- conflicts

def elbow_and_end(theta, target, arm):
    """Return (e, J) for the second joint at target[:2] and the end at target[2:]; both together may be impossible."""
    x, n = joints_of(theta, arm.lengths), len(theta)
    J = np.vstack((np.column_stack((jacobian_of(theta[:2], arm.lengths[:2]), np.zeros((2, n - 2)))),
                   jacobian_of(theta, arm.lengths)))
    return np.concatenate((target[:2] - x[2], target[2:] - x[n])), J


@case("conflicting-targets", "Two targets, one arm", compiled=False)
def conflicting_targets(lesson, check):
    """Check that with two targets that exclude each other a method with a Jacobian stops at a local minimum of Σ|e|².

    At rest Jᵀe = 0.  SciPy's least squares finds the same minimum from there; the transpose and the damped step
    leave 1e-9 of the angles after their iterations, which is 1e-17 of a minimum.
    """
    arm, start = arm_of(lesson, [1.0, 0.8, 0.6], 0.12, 1.0), (0.5, 0.5, 0.5)
    targets = np.array(((0.9, 0.9, 1.9, -0.4), (1.2, 1.0, -0.5, 1.5), (0.0, 1.5, 1.2, 1.2)))
    for target in targets:
        best = least_squares(lambda theta, target=target: elbow_and_end(theta, target, arm)[0], start, xtol=1e-15,
                             ftol=1e-15, gtol=1e-15)
        for name in ("transpose_step", "damped_step"):
            angles = after(lesson, name, arm, start, target, 1800, elbow_and_end)
            e, J = elbow_and_end(angles, target, arm)
            check("Conflicting targets end in the compromise with the smallest Σ|e|².",
                  f"|e| of {name}, targets {target} [m]",
                  law=np.sqrt(2.0 * best.cost), found=np.linalg.norm(e), within=1e-12,
                  saw=f"{name}: |e| = {np.linalg.norm(e):.6f} m, and |Jᵀe| = {np.linalg.norm(e @ J):.0e} m².")
    numbers, measured = np.arange(1.0, len(targets) + 1.0), [f.measured for f in check]
    return Picture("What no arm can satisfy", "number of the pair of targets", "|e| of the compromise [m]", [
        series("least squares", numbers, [f.predicted for f in check[::2]], LINE),
        series("transpose", numbers, measured[::2], DOTS), series("damped", numbers, measured[1::2], DOTS)],
        "A task is any number of rows stacked into e; the methods stay the same.")


@case("limits-that-forbid", "Limits that forbid the target", compiled=False)
def limits_that_forbid(lesson, check):
    """Compare the remaining distance to targets that the limits of two links forbid with theory.

    The elbow bends by at most B, and the target is closer than that allows: r² = l₁² + l₂² + 2 l₁l₂ cos B.  The
    free first joint turns to the bearing of the target, and r − d is left.  If the first joint has limits, too, the
    target is seen from the end at an angle that neither joint may close: |r e^{iA} − target| is left at the corner
    A.
    """
    bends, target, measured = (0.3, 0.6, 1.0, 1.5), (0.3, 0.5), []
    law = lambda bend: np.sqrt(1.49 + 1.4 * np.cos(bend)) - np.hypot(*target)
    for bend in bends:
        arm = limited(lesson, (-np.inf, 0.0), (np.inf, bend))
        for name in ("limited_step", "ccd_step"):
            angles = after(lesson, name, arm, (0.1, 0.1), target, 600)
            measured.append(np.linalg.norm(end_of(angles, arm.lengths) - target))
            check("If the elbow is at its limit, the distance r − d is left.",
                  f"way that is left, {name}, elbow up to {bend:g} rad [m]",
                  law=law(bend), found=measured[-1], within=1e-12,
                  saw=f"{name}: the elbow stops at {angles[1]:.4f} rad, and {measured[-1]:.4f} m are left.")
    corner_of_limits(lesson, check)
    fine = np.linspace(0.2, 1.6, 40)
    return Picture("An elbow with a limit", "limit of the elbow [rad]", "way that is left [m]", [
        series("theory, r − d", fine, law(fine), LINE), series("damped, with limits", bends, measured[::2], DOTS)],
        "Limits enlarge the hole in the middle of the reach.")


def limited(lesson, low, high):
    """Make two links of 1 m and 0.7 m whose angles have limits."""
    return arm_of(lesson, [1.0, 0.7], damping=0.7, low=np.array(low), high=np.array(high))


def corner_of_limits(lesson, check):
    """Limit both joints, so that the arm rests in a corner or cannot move at all."""
    arm, target = limited(lesson, (-0.4, 0.2), (0.5, 0.9)), (0.1, 1.4)
    angles = after(lesson, "limited_step", arm, (0.0, 0.5), target, 2000)
    check("Where both joints are at their limits, the arm rests in that corner.", "way that is left in the corner [m]",
          law=np.linalg.norm(end_of((0.5, 0.9), arm.lengths) - target),
          found=np.linalg.norm(end_of(angles, arm.lengths) - target), within=1e-12,
          saw=f"It rests at ({angles[0]:.3f}, {angles[1]:.3f}) rad.")
    shut = limited(lesson, (0.2, 0.3), (0.2, 0.3))
    angles = after(lesson, "limited_step", shut, (2.0, -1.0), target, 1)
    check("Limits that leave no freedom determine the joints.", "largest angle off equal limits [rad]",
          law=0.0, found=np.max(np.abs(angles - (0.2, 0.3))), within=0.0,
          saw=f"Between equal limits it stands at ({angles[0]:g}, {angles[1]:g}) rad.")


# ---------------------------------------------------------------------------------------------- in space

X, Y, Z = np.eye(3)
AXES, OFFSETS = np.stack((Z, Y, Y, X, Y, X)), np.stack((0.4 * Z, 0.6 * X, 0.3 * X, 0.2 * X, 0.1 * X, 0.2 * X + 0.1 * Z))
SIX = np.array([0.5, -0.6, 0.9, 0.3, 0.5, 0.2])


def spatial_arm(lesson, damping):
    """Make the arm of six joints."""
    return lesson.make_arm_3d(AXES, OFFSETS, 0.0, damping, -np.inf, np.inf, 0.0, 0.0)


def pose_error(theta, x, R):
    """Return (x − end, rotation vector from the last link to R) (6,), by matrices and SciPy."""
    end, here = spatial_end(theta, AXES, OFFSETS)
    return np.append(x - end, Rotation.from_matrix(R @ here.T).as_rotvec())


@case("six-joints-in-space", "Six joints in space", compiled=False)
def six_joints_in_space(lesson, check):
    """Check that a damped step in space leaves λ²/(σ² + λ²) of a small error of the pose, along each of six directions.

    J comes from central differences of matrices: its error is 1e-10, and of the small σ that is 1e-9.  Factors are
    central differences over 1e-5 rad, with 1e-10 from their third order and from round-off.
    """
    x, R = spatial_end(SIX, AXES, OFFSETS)
    damping, factors = 0.2, []
    slopes = [-(pose_error(SIX + d, x, R) - pose_error(SIX - d, x, R)) / (2.0 * STEP) for d in STEP * np.eye(6)]
    u, sigma, v = np.linalg.svd(np.stack(slopes, axis=1))
    arm = spatial_arm(lesson, damping)
    target = np.append(x, np.roll(Rotation.from_matrix(R).as_quat(), 1))
    for i in range(6):
        left = [pose_error(after(lesson, "damped_step", arm, SIX + h * v[i], target, 1, lesson.pose_3d), x, R)
                for h in (STEP, -STEP)]
        factors.append(-u[:, i] @ (left[0] - left[1]) / (2.0 * STEP * sigma[i]))
        check("A damped step leaves λ²/(σ² + λ²) of an error of place and orientation.",
              f"factor per iteration along the axis with σ = {sigma[i]:.4f} [-]",
              law=damping**2 / (sigma[i] ** 2 + damping**2), found=factors[-1], within=1e-7,
              saw=f"σ = {sigma[i]:.4f}: {factors[-1]:.6f} of the error is left.")
    ellipse_of_two_links(lesson, check)
    posture(lesson, check)
    fine = np.linspace(sigma[-1], sigma[0], 60)
    return Picture("What one iteration leaves", "σ [m, or 1 for a rotation]", "factor [-]", [
        series("theory, λ²/(σ² + λ²)", fine, damping**2 / (fine**2 + damping**2), LINE),
        series("measured", sigma, factors, DOTS)],
        "In space, as in the plane, the directions in which the arm can hardly move converge last.")


def ellipse_of_two_links(lesson, check):
    """Multiply the half axes of two links with a small bend: σ₁ σ₂ = l₁ l₂ sin θ₂.

    J is rounded by 1e-16, which is 1e-16 over the bend, relative to the product.
    """
    for bend in (1.0, 1e-3, 1e-7):
        longer, shorter, _ = lesson.velocity_ellipse(lesson.jacobian_2d(joints_of((0.4, bend), [1.0, 0.7])))
        check("The product of the half axes of two links is l₁ l₂ sin θ₂, even if they are nearly straight.",
              f"σ₁ σ₂ over l₁ l₂ sin θ₂, bent by {bend:g} rad [-]",
              law=1.0, found=longer * shorter / (0.7 * np.sin(bend)), within=1e-15 / bend + 1e-14,
              saw=f"Bent by {bend:g} rad σ₂ is {shorter:.4g} m.")


def posture(lesson, check):
    """Pull an arm to a rest posture: its end does not move to first order; half of the pull moves it by a quarter."""
    lengths, theta, moved = np.array([1.0, 0.8, 0.6, 0.4]), np.array([0.3, 0.6, 0.5, 0.4]), []
    target = end_of(theta, lengths)
    for pull in (2e-3, 1e-3):
        arm = lesson.make_arm_2d(lengths, 0.0, 0.0, -np.inf, np.inf, (0.9, -0.2, 0.4, 0.8), pull)
        moved.append(np.linalg.norm(end_of(after(lesson, "null_space_step", arm, theta, target, 1), lengths) - target))
    check("A pull towards the rest posture moves the end by the square of the pull: the null space is of first order.",
          "way of the end over that with half of the pull [-]", law=4.0, found=moved[0] / moved[1], within=0.01,
          saw=f"The end moves by {moved[0]:.1e} m, and with half of the pull by {moved[1]:.1e} m.")


# ---------------------------------------------------------------------------------------------- extremes

def left_by_closed_form(lesson, target, lengths, elbow=1.0):
    """Return the distance [m] of two links, at the angles of the closed form, from their target."""
    return np.linalg.norm(end_of(lesson.solve_2r(target, np.array(lengths), elbow), lengths) - target)


@case("extremes", "Impossible arms and targets", compiled=False)
def extremes(lesson, check):
    """Check both edges of the ring, the centre of one without a hole, angles of many turns, and refused values."""
    way = np.array([np.cos(2.0), np.sin(2.0)])
    for lengths in ((1.0, 1.0), (1.0, 0.6), (1.0, 1e-6), (1e-3, 1e3)):
        off = np.max([left_by_closed_form(lesson, r * way, lengths, elbow)
                      for r in annulus(lengths) if r > 0.0 for elbow in (1.0, -1.0)]) / sum(lengths)
        check("The closed form reaches both edges of the ring.",
              f"way that is left at the edges over the reach, lengths {lengths[0]:g} and {lengths[1]:g} m [-]",
              law=0.0, found=off, within=1e-14,
              saw=f"Lengths {lengths[0]:g} and {lengths[1]:g} m: {off:.0e} of the reach is left at the edges.")
    centre = left_by_closed_form(lesson, np.zeros(2), (1.0, 1.0))
    check("Two equal links fold to reach their own base.", "way that is left to the base [m]",
          law=0.0, found=centre, within=1e-15, saw=f"Folded, the end is {centre:.0e} m from the base.")
    turns = np.array([0.4, 0.9, 0.7]) + 2.0 * np.pi * np.array([1e6, -1e6, 1e6])
    off = np.linalg.norm(lesson.joint_positions(turns, THREE)[-1] - end_of((0.4, 0.9, 0.7), THREE))
    check("A million turns change only the rounding of the angle, 1e-9 rad.",
          "distance of the end from where it is without the turns [m]", law=0.0, found=off, within=5e-9,
          saw=f"After a million turns the end is {off:.0e} m aside.")
    refusals(lesson, check)
    exponents = np.linspace(-3.0, 0.0, 7)
    left = [left_by_closed_form(lesson, (1.6 - 10.0**k) * way, (1.0, 0.6)) for k in exponents]
    return Picture("Close to the edge of the reach", "log₁₀ of the distance from the edge [m]",
                   "log₁₀ of the way that is left [m]", [
                       series("closed form", exponents, np.log10(np.maximum(left, 1e-17)), DOTS),
                       series("a few roundings", exponents, np.full(7, -15.0), LINE)],
                   "The closed form is as accurate at the edge as anywhere.")


def refusals(lesson, check):
    """Make calls with invalid arms and searches."""
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
    done = sum(refuses(call, (), value) for call, value in asked)
    try:
        after(lesson, "transpose_step", make(gain=1e200), (0.1, 0.2), (1e200, 0.0), 5)
    except Diverged:
        done += 1
    check.count("Impossible lengths, limits, axes and targets are refused with their value, and overflow raises "
                "Diverged.", "calls that end in such a sentence", done, len(asked) + 1,
                "such calls end in a sentence that names the value.")


# ---------------------------------------------------------------------------------------------- laws of arms

TRIED = 50                   # random arms [-]
STEP = 1e-5                  # of a central difference [rad]: its third order and round-off are 5e-11 of a metre


def random_arm(rng):
    """Return (lengths [m], angles [rad]) of four links."""
    return rng.uniform(0.5, 1.0, 4), rng.uniform(-1.0, 1.0, 4)


def random_limits(rng, theta, far):
    """Return (low, high) of the joints of an arm: some are at a limit, some near one, and some are free."""
    return theta - rng.choice((0.0, 0.05, far), 4), theta + rng.choice((0.0, 0.05, far), 4)


@random_law("The ellipse of velocities has the singular values as half axes, and u₁ as direction.",
            "largest error of the half axes and direction [m, -]", 1e-9)
def ellipse(lesson, rng):
    J = rng.normal(size=(2, 4))
    u, sigma, _ = np.linalg.svd(J)
    longer, shorter, angle = lesson.velocity_ellipse(J)
    along = abs(u[:, 0] @ (np.cos(angle), np.sin(angle)))                # 1 where it is the longer axis, either way
    return (longer, shorter, along), (sigma[0], sigma[1], 1.0)


@random_law("The error of an orientation is the shortest rotation vector, of q and of −q.",
            "largest error of the rotation [rad]", 1e-9)
def missing_rotation(lesson, rng):
    here, turn = Rotation.random(rng=rng), rng.normal(size=3)
    turn *= rng.uniform(0.1, 3.1) / np.linalg.norm(turn)
    there = Rotation.from_rotvec(turn) * here
    q_from, q_to = np.roll(here.as_quat(), 1), rng.choice((-1.0, 1.0)) * np.roll(there.as_quat(), 1)
    return lesson.rotation_error(q_from, q_to), turn


@random_law("Joints that are free to move between their limits take a damped step.",
            "largest error of the angles with limits [rad]", 1e-9)
def step_between_limits(lesson, rng):
    lengths, theta = random_arm(rng)
    low, high = random_limits(rng, theta, 3.0)
    damping, e = rng.uniform(0.1, 0.5), 0.5 * rng.normal(size=2)
    J = jacobian_of(theta, lengths)
    wish = J.T @ e                                                       # a joint at its limit is free to move inwards
    J[:, ((theta >= high) & (wish > 0.0)) | ((theta <= low) & (wish < 0.0))] = 0.0
    truth = np.clip(theta + np.linalg.solve(J.T @ J + damping**2 * np.eye(4), J.T @ e), low, high)
    arm = arm_of(lesson, lengths, damping=damping, low=low, high=high)
    return lesson.limited_step(lesson.reach_2d, theta, end_of(theta, lengths) + e, arm), truth


@random_law("A rest posture attracts the arm by motions that do not move the end.",
            "largest error of the angles [rad]", 1e-9)
def pull_to_rest(lesson, rng):
    lengths, theta = random_arm(rng)
    rest, pull = rng.uniform(-1.0, 1.0, 4), 0.1
    arm = lesson.make_arm_2d(lengths, 0.0, 0.0, -np.inf, np.inf, rest, pull)
    step = lesson.null_space_step(lesson.reach_2d, theta, end_of(theta, lengths), arm) - theta
    free = np.linalg.svd(jacobian_of(theta, lengths))[2][2:]
    return step, free.T @ (free @ (pull * (rest - theta)))


@random_law("A search ends when it is close enough, and counts its iterations.",
            "largest error of the search [-, rad, m]", 1e-9)
def counted_search(lesson, rng):
    lengths, theta = random_arm(rng)
    target, count = end_of(theta + 0.3, lengths), 0
    arm = arm_of(lesson, lengths, damping=0.1, low=-9.0, high=9.0)
    found = lesson.solve_reach(lesson.damped_step, lesson.reach_2d, theta, target, 1e-6, 50, arm)
    while np.linalg.norm(target - end_of(theta, lengths)) > 1e-6 and count < 50:
        theta, count = lesson.damped_step(lesson.reach_2d, theta, target, arm), count + 1
    return found, (theta, np.linalg.norm(target - end_of(theta, lengths)), count)


def swept_chain(lesson, rng):
    """Return (lengths, joints before, joints after) of a sweep of FABRIK in space."""
    lengths, links = rng.uniform(0.5, 1.0, 4), rng.normal(size=(4, 3))
    x = np.concatenate((np.zeros((1, 3)), np.cumsum(links, axis=0))) + rng.normal(size=3)
    return lengths, x, lesson.fabrik_sweep(x, rng.normal(size=3), lengths)


@random_law("A sweep of FABRIK leaves the base where it was.", "largest error of the place of the base [m]", 1e-9)
def base_of_a_sweep(lesson, rng):
    _, x, swept = swept_chain(lesson, rng)
    return swept[0], x[0]


@random_law("A sweep of FABRIK leaves each link its own length.", "largest error of the lengths of links [m]", 1e-9)
def links_of_a_sweep(lesson, rng):
    lengths, _, swept = swept_chain(lesson, rng)
    return np.linalg.norm(np.diff(swept, axis=0), axis=1), lengths


@random_law("A vector without a direction is replaced by the first axis.", "largest error of the place [m]", 1e-9)
def no_direction(lesson, rng):
    x, length = rng.normal(size=3), rng.uniform(0.5, 1.0)
    return lesson.point_at(x, x, length), x + length * X


def bent_arm(rng):
    """Return (lengths [m], angles [rad], sign of the elbow) of three links in any quadrant."""
    lengths, angles = rng.uniform(0.5, 1.0, 3), rng.uniform(-3.1, 3.1, 3)
    elbow = np.sign(angles[1])
    angles[1] = elbow * rng.uniform(0.1, 3.0)
    return lengths, angles, elbow


@random_law("The closed forms return the angles from −π to π that led to a target.",
            "largest error of the angles of closed forms [rad]", 1e-9)
def closed_forms(lesson, rng):
    lengths, angles, elbow = bent_arm(rng)
    pose = np.append(end_of(angles, lengths), np.remainder(np.sum(angles), 2.0 * np.pi))
    two = lesson.solve_2r(end_of(angles[:2], lengths[:2]), lengths, elbow)
    return (two, lesson.solve_3r(pose, lengths, elbow)), (angles[:2], angles)


@random_law("A target in the hole is refused, also if the other link is longer.",
            "largest error of the refusals that are missing [-]", 1e-9)
def target_in_the_hole(lesson, rng):
    lengths, angles, elbow = bent_arm(rng)
    hole = 0.9 * abs(lengths[0] - lengths[1]) * np.array([np.cos(angles[0]), np.sin(angles[0])])
    return float(refuses(lesson.solve_2r, (hole, lengths, elbow))), 1.0


@random_law("The pseudo-inverse is that of the singular values, for any unit of length.",
            "largest error of the J⁺ times the size [-]", 1e-9)
def pseudo_inverse(lesson, rng):
    M, size = rng.normal(size=(3, 4)), 10.0 ** rng.uniform(-12.0, 12.0)
    M[2] = rng.choice((M[1], M[2]))
    return size * lesson.pseudo_inverse(size * M), np.linalg.pinv(M, 1e-10)


def descended(theta, lengths, target, low, high):
    """Return the angles after each joint, from the last one on, has turned the end towards the target."""
    new = theta.copy()
    for k in reversed(range(len(theta))):
        joints = joints_of(new, lengths) @ (1.0, 1j)
        turn = np.angle((target @ (1.0, 1j) - joints[k]) / (joints[-1] - joints[k]))
        new[k] = np.clip(new[k] + turn, low[k], high[k])
    return new


def random_descent(lesson, rng):
    """Return (angles, target, arm) of a search by cyclic descent, and the angles after one and after two sweeps."""
    lengths, theta = random_arm(rng)
    target = rng.normal(size=2)
    low, high = random_limits(rng, theta, 9.0)
    once = descended(theta, lengths, target, low, high)
    twice = descended(once, lengths, target, low, high)
    return (theta, target, arm_of(lesson, lengths, low=low, high=high)), once, twice


@random_law("In cyclic descent each joint in turn points the end at the target, within its limits.",
            "largest error of the angles after a sweep [rad]", 1e-9)
def cyclic_descent(lesson, rng):
    (theta, target, arm), once, _ = random_descent(lesson, rng)
    return lesson.ccd_step(lesson.reach_2d, theta, target, arm), once


@random_law("A history holds each iteration, which begins where the one before ended.",
            "largest error of the angles of a history [rad]", 1e-9)
def history(lesson, rng):
    (theta, target, arm), once, twice = random_descent(lesson, rng)
    return (lesson.reach_trajectory(lesson.ccd_step, lesson.reach_2d, theta, target, 2, arm),
            np.array([theta, once, twice]))


@random_law("A search for many targets begins each one at the same angles.",
            "largest error of the searches [rad, m, -]", 1e-9)
def many_targets(lesson, rng):
    lengths, theta = random_arm(rng)
    targets = rng.normal(size=(2, 2))
    how = 1e-6, 3, arm_of(lesson, lengths, damping=0.3, low=-9.0, high=9.0)
    each = [lesson.solve_reach(lesson.damped_step, lesson.reach_2d, theta, target, *how) for target in targets]
    many = lesson.solve_targets(lesson.damped_step, lesson.reach_2d, theta, targets, *how)
    return many, tuple(np.array(part) for part in zip(*each, strict=True))


@random_law("In space products of rotations give the place of the end.",
            "largest error of the end in space [m, -]", 1e-9)
def end_in_space(lesson, rng):
    theta, target, arm = rng.uniform(-2.0, 2.0, 6), rng.normal(size=3), spatial_arm(lesson, 0.1)
    x, R = spatial_end(theta, AXES, OFFSETS)
    pose = lesson.end_pose(theta, arm)
    turned = Rotation.from_quat(np.roll(pose[3:], -1)).as_matrix()
    return (lesson.reach_3d(theta, target, arm)[0], pose[:3], turned), (target - x, x, R)


@random_law("In space J is the change of the end with the angles.", "largest error of the J in space [m]", 1e-9)
def slope_in_space(lesson, rng):
    theta = rng.uniform(-2.0, 2.0, 6)
    place = lambda angles: spatial_end(angles, AXES, OFFSETS)[0]
    slope = [(place(theta + d) - place(theta - d)) / (2.0 * STEP) for d in STEP * np.eye(6)]
    return lesson.reach_3d(theta, np.zeros(3), spatial_arm(lesson, 0.1))[1], np.transpose(slope)


@case("geometry-of-arms", "Ellipse, rotation, limits and null space", compiled=False)
def geometry_of_arms(lesson, check):
    """Compare the ellipse, the error of a rotation, and steps with limits or a rest posture with independent ones.

    A damped step between limits is that of the joints that are free to move; a joint at its limit is free to move
    inwards.
    """
    check.laws(lesson, (ellipse, missing_rotation, step_between_limits, pull_to_rest, counted_search, base_of_a_sweep,
                        links_of_a_sweep, no_direction, closed_forms, target_in_the_hole, pseudo_inverse,
                        cyclic_descent, history, many_targets, end_in_space, slope_in_space), seed=11, times=TRIED)


# ---------------------------------------------------------------------------------------------- why?

@case("distance-left", "The distance that damped steps leave", compiled=False)
def distance_left(lesson, check):
    """Compare with the distance to the ring of reachable places, for random arms with a hole and any damping."""
    rng, worst = np.random.default_rng(17), 0.0
    for _ in range(200):
        lengths = np.array([rng.uniform(1.2, 1.5), *rng.uniform(0.2, 0.5, 2)])
        target = rng.uniform(0.05, 4.0) * np.array([np.cos(1.0), np.sin(1.0)])
        inner, outer = annulus(lengths)
        away = np.hypot(*target)
        nearest = np.clip(away, inner, outer)
        worst = np.maximum(worst, abs(lesson.remaining_distance(lengths, target, rng.uniform(0.1, 3.0))
                                      - abs(away - nearest)))
    check.agree("The damping leaves nothing of the way to the nearest place.", "distance left: largest error [m]",
                worst, 1e-12)


# ---------------------------------------------------------------------------------------------- a thing of one's own

@case("writing-of-ones-own", "A drawing of one's own by an arm", compiled=False)
def writing_of_ones_own(lesson, check):
    """Let the arm of my_writing draw by four damped steps per picture; the limits are those of its docstring.

    A damped step leaves the share λ²/(σ² + λ²) of an error.  With σ₂ ≥ λ/2, four steps leave at most (4/5)⁴ of it, so
    the hand is late by less than one way between two pictures.
    """
    lengths, points, seconds = lesson.my_writing()
    lengths, points = np.array(lengths, dtype=float), np.array(points, dtype=float)
    reach, along = np.sum(lengths), np.linspace(0.0, len(points) - 1.0, round(25 * seconds))
    path = np.stack([np.interp(along, np.arange(len(points)), points[:, c]) for c in (0, 1)], axis=1)
    arm, theta = arm_of(lesson, lengths, damping=0.1 * reach), np.full(len(lengths), 0.6)
    thetas = [after(lesson, "damped_step", arm, theta, path[0], 104)]
    for target in path[1:]:
        thetas.append(after(lesson, "damped_step", arm, thetas[-1], target, 4))
    off = np.max([np.linalg.norm(end_of(theta, lengths) - target) for theta, target in zip(thetas, path)])
    fastest = 25.0 * np.max(np.abs(np.diff(thetas, axis=0)))
    thin = np.min([np.linalg.svd(jacobian_of(theta, lengths), compute_uv=False)[1] for theta in thetas])
    check.agree("The hand stays on the drawing.", "distance from the path over the reach [-]", off / reach, 0.01)
    check("The joints turn slowly.", "fastest joint over 2 rad/s, at least 1 [-]", law=1.0,
          found=np.maximum(1.0, fastest / 2.0), within=0.0, saw=f"The fastest joint turns at {fastest:.2g} rad/s.")
    check("The arm is never nearly straight.", "least σ₂ over a twentieth of the reach, at most 1 [-]", law=1.0,
          found=np.minimum(1.0, thin / (0.05 * reach)), within=0.0, saw=f"The least σ₂ is {thin:.2g} m.")
