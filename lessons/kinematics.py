"""Lesson 11.  Kinematics: chains, forward and inverse.

    x = f(θ),      ẋ = J(θ) θ̇,      θ ← θ + Δθ  until  e = target − x  is zero

Symbols: θ (n,) [rad] angles of the joints, each relative to the link before it · x (n + 1, d) [m] positions of the
joints, the last one the end of the arm · J (m, n) Jacobian · e (m,) remaining error to the target · σ [m]
singular values of J · α [1/m²] gain · λ [m] damping · q (4,) = (w, x, y, z) orientation of the last link · elbow ±1.
An arm is an Arm2D or an Arm3D (support/chains.py).  Its base is at the origin.

A task is a function  task(θ, target, arm) → (e, J).  A method is a function  step(task, θ, target, arm) → θ.
*Left out:* sliding joints and closed chains; six joints in closed form; collisions of the links.
"""

import numpy as np

from solutions.checks import BadInput, check_array, check_shape, finite_array, float_copy
from solutions.rotation import quaternion_product
from solutions.support.chains import Arm2D, Arm3D, check_found, checked_reach, make_arm_2d, make_arm_3d, wrapped
from solutions.support.quaternions import exponential, rotate
from solutions.support.records import check_record
from solutions.support.small_systems import row_products, solve_symmetric, sum_of_rows
from solutions.support.tuples import across, minus, plus, put, row, scaled

__all__ = [
    "EDGE", "SINGULAR", "Arm2D", "Arm3D", "advance_reach", "angles_of", "ccd_step", "contraction_factors",
    "damped_step", "end_pose", "fabrik_step", "fabrik_sweep", "jacobian_2d", "jacobian_3d", "joint_frames",
    "joint_positions", "limited_step", "make_arm_2d", "make_arm_3d", "my_writing", "newton_is", "null_space_step",
    "point_at", "pose_2d", "pose_3d", "pseudo_inverse", "pseudo_inverse_step", "reach_2d", "reach_3d",
    "reach_trajectory", "remaining_distance", "rotation_error", "row_products", "solve_2r", "solve_3r", "solve_reach",
    "solve_symmetric", "solve_targets", "sum_of_rows", "transpose_step", "velocity_ellipse", "wrapped",
]

SINGULAR = 1e-10             # singular values below this part of the largest count as zero [-]: far above round-off
EDGE = 1e-12                 # part of the reach by which a target may be outside by round-off [-]


# ---------------------------------------------------------------------------------------------- in the plane

def joint_positions(theta, lengths):
    """Return x (n + 1, 2): positions of all joints of a planar chain from the base at (0, 0), and last of its end.

    x_k+1 = x_k + l_k (cos φ_k, sin φ_k),      φ_k = θ_1 + … + θ_k

    *Source:* Lynch and Park 2017, chapter 4.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 11.1: joint_positions")


def jacobian_2d(x):
    """Return J (2, n) [m/rad]: column k is the velocity of the end when only joint k turns, at 1 rad/s.

    *Find* it.  All that comes after joint k turns about x_k like a rigid body.

    x (n + 1, 2) are the joints and the end, anywhere in the plane.
    *Source:* Lynch and Park 2017, chapter 5.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 11.2: jacobian_2d")


def velocity_ellipse(J):
    """Return (σ₁, σ₂, angle) of the ellipse {J θ̇ : |θ̇| = 1}: half axes [m], σ₁ ≥ σ₂, and angle of the longer one.

    σ₁² = ½(a + c) + √(¼(a − c)² + b²),      σ₂ = D/σ₁,      angle = ½ atan2(2b, a − c),      J Jᵀ = [[a, b], [b, c]]
    D² = Σ_i<k (J_0i J_1k − J_1i J_0k)²          the determinant of J Jᵀ, as a sum without cancellation
    J (2, n) is not zero.  Where the arm is straight, σ₂ = 0: no joint moves the end along it.
    *Source:* Yoshikawa 1985; for D² Cauchy and Binet.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 11.3: velocity_ellipse")


def solve_2r(target, lengths, elbow):
    """Return θ (2,), both from −π to π, with which the first two links end at the target (2,).

    θ₂ = elbow · 2 atan2(√((b − r)(b + r)), √((r − a)(r + a))),      r = |target|,  a = |l₁ − l₂|,  b = l₁ + l₂
    θ₁ = atan2(y, x) − atan2(l₂ sin θ₂, l₁ + l₂ cos θ₂), wrapped(θ₁) if that is outside

    This is cos θ₂ = (r² − l₁² − l₂²)/(2 l₁ l₂).  Half the angle and the products keep all digits of θ₂ at the edges of
    the reach, where the arccosine and b² − r² lose half of them.  Take the root of a negative number as 0.
    Raises BadInput("distance of the target [m]", r, remedy) where r is above b or below a by more than EDGE b, which is
    round-off.  elbow = ±1 is the sign of θ₂.  lengths may have more entries.
    *Source:* Lynch and Park 2017, chapter 6; the law of cosines.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 11.4: solve_2r")


def solve_3r(target, lengths, elbow):
    """Return θ (3,), all from −π to π, with which three links end at (x, y) with the direction φ: target = (x, y, φ).

    *Find* them with solve_2r: where must the last joint be, and by how much must it turn?

    φ may be any number of turns away from θ₁ + θ₂ + θ₃.  Raises what solve_2r raises.
    *Source:* Lynch and Park 2017, chapter 6.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 11.5: solve_3r")


# ---------------------------------------------------------------------------------------------- in space

def joint_frames(theta, axes, offsets):
    """Return (x (n + 1, 3), a (n, 3), q (4,)): joints and end, axes in the world, orientation of the last link.

    From q = (1, 0, 0, 0) and x_0 = 0, joint after joint:
        a_k = q applied to axes_k          the axis, which its own joint does not turn
        q ← q ∘ exp(θ_k axes_k)            the joint turns all later links
        x_k+1 = x_k + (the new q applied to offsets_k)
    rotate(q, r), quaternion_product and exponential are those of lesson 5.  Compiled, tuples are quicker than rows:
    row(x, k), put(x, k, r), plus, minus, across (×) and scaled of support/tuples.py; rotate takes them.
    *Source:* Lynch and Park 2017, chapter 4: a product of exponentials, here of quaternions.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 11.6: joint_frames")


def jacobian_3d(x, a):
    """Return J (6, n): column k is (velocity of the end, angular velocity of the last link) when only joint k turns.

    *Find* it.  All that comes after joint k turns like a rigid body about the axis a_k through x_k, at 1 rad/s.

    x (n + 1, 3) and a (n, 3) are as joint_frames gives them; each axis is a unit vector.
    *Source:* Lynch and Park 2017, chapter 5; they write the angular velocity first, and the velocity at the origin.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 11.7: jacobian_3d")


def rotation_error(q, q_target):
    """Return the rotation vector φ (3,) [rad] that turns the orientation q into q_target:  exp(φ) ∘ q = ±q_target.

    d = q_target ∘ q̄ = (w, 𝐝);  where w < 0 take −d, which is the same rotation by the shorter way
    φ = 2 atan2(|𝐝|, w) 𝐝/|𝐝|,      2𝐝 where |𝐝| = 0          q̄ = (w, −x, −y, −z)

    φ is at most π long.
    *Source:* Lynch and Park 2017, chapter 3: the logarithm of a rotation.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 11.8: rotation_error")


# ---------------------------------------------------------------------------------------------- tasks

def reach_2d(theta, target, arm):
    """Given.  Return (e, J) for the end of an Arm2D at the target (2,)."""
    check_shape("the target", target, (2,))
    x = joint_positions(theta, arm.lengths)
    return target - x[theta.size], jacobian_2d(x)


def pose_2d(theta, target, arm):
    """Given.  Return (e, J) for the end of an Arm2D at (x, y) with the direction φ: target = (x, y, φ).

    1 rad counts as 1 m.
    """
    check_shape("the target", target, (3,))
    x, n, J = joint_positions(theta, arm.lengths), theta.size, np.ones((3, theta.size))
    J[:2] = jacobian_2d(x)
    return np.array((target[0] - x[n, 0], target[1] - x[n, 1], wrapped(target[2] - np.sum(theta)))), J


def reach_3d(theta, target, arm):
    """Given.  Return (e, J) for the end of an Arm3D at the target (3,)."""
    check_shape("the target", target, (3,))
    x, a, _ = joint_frames(theta, arm.axes, arm.offsets)
    return target - x[theta.size], jacobian_3d(x, a)[:3]


def pose_3d(theta, target, arm):
    """Given.  Return (e, J) for the end of an Arm3D at x with the orientation q, target = (x, q), (7,)."""
    check_shape("the target", target, (7,))
    x, a, q = joint_frames(theta, arm.axes, arm.offsets)
    return np.concatenate((target[:3] - x[theta.size], rotation_error(q, target[3:]))), jacobian_3d(x, a)


def end_pose(theta, arm):
    """Given.  Return (x, q) (7,) of the end of an Arm3D: what pose_3d takes as its target."""
    x, _, q = joint_frames(theta, arm.axes, arm.offsets)
    return np.concatenate((x[theta.size], q))


# ---------------------------------------------------------------------------------------------- methods with a Jacobian

def transpose_step(task, theta, target, arm):
    """Return θ after one step of steepest descent on ½|e|²: against its gradient, times α = arm.gain.

    *Find* the gradient with respect to θ.  The error e is the target less the task, and the task changes by J Δθ.

    Limits are not kept.  e (m,) and J (m, n) have all rows of the task, which may be 2, 3, 6 or more.
    Near a target within reach it converges only for α < 2/σ₁².
    *Source:* Wolovich and Elliott 1984.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 11.9: transpose_step")


def pseudo_inverse(J):
    """Return J⁺ (n, m): J⁺ e is the shortest of all Δθ for which |J Δθ − e| is smallest.

    J = Σ σ_i u_i v_iᵀ,      J⁺ = Σ v_i u_iᵀ/σ_i over all σ_i > SINGULAR σ₁          0 for J = 0

    np.linalg.svd(J, False) gives u (as columns), σ and v (as rows).
    *Source:* Moore 1920; Penrose 1955; Whitney 1969 for arms.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 11.10: pseudo_inverse")


def pseudo_inverse_step(task, theta, target, arm):
    """Given.  Return θ + J⁺ e:  Newton's method, which squares the error near a target, and jumps where σ₂ is small."""
    e, J = task(theta, target, arm)
    return theta + pseudo_inverse(J) @ e


def damped_step(task, theta, target, arm):
    """Return θ + Jᵀ (J Jᵀ + λ² 1)⁻¹ e:  the Δθ with the smallest |J Δθ − e|² + λ² |Δθ|², λ = arm.damping.

    No step is longer than |e|/(2λ).  Where J Jᵀ has no inverse, λ must be above 0, and above about 1e-6 of the largest
    σ of J: a smaller λ² is lost beside J Jᵀ.  Limits are not kept.
    Given are row_products(J) for J Jᵀ, solve_symmetric(A, e) for A⁻¹ e, and sum_of_rows(J, y) for Jᵀ y: compiled, they
    are faster than NumPy.
    *Source:* Wampler 1986; Nakamura and Hanafusa 1986.  Levenberg 1944 for least squares.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 11.11: damped_step")


def contraction_factors(sigma, gain, damping):
    """Return (transpose, damped): factors by which an iteration multiplies a small error along u_i, for each σ_i of J.

    An iteration is θ ← θ + P e.  Near a target in reach it turns e into (1 − J P) e, to first order:
        transpose_step:  P = α Jᵀ          damped_step:  P = Jᵀ (J Jᵀ + λ² 1)⁻¹          J = Σ σ_i u_i v_iᵀ
    *Find* the factor of each for an e along u_i.  It has a sign: below 0, the error changes sides.
    sigma is an array, and so are both results; gain is α, damping is λ > 0, both are numbers.

    The slowest direction decides.  For the damped step it belongs to the smallest σ, for the transpose to the smallest
    or the largest.
    *Source:* the singular value decomposition of J.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 11.12: contraction_factors")


# ---------------------------------------------------------------------------------------------- methods without

def ccd_step(task, theta, target, arm):
    """Return θ after one sweep of cyclic coordinate descent in the plane, from the last joint to the first.

    Each joint turns until the end lies on the line from this joint to the target (2,).  *Find* the angle Δ_k of this
    turn, from −π to π, with r = end − x_k and s = target − x_k.

    θ_k ← θ_k + Δ_k, but not beyond arm.low_k and arm.high_k; then turn the end about x_k by the change of θ_k.

    All x_k are those before the sweep, because joints nearer to the base have not turned yet.
    Where s is 0, any Δ_k is right, as the end is equally far away.  task is not used.  Returns a new array.
    *Source:* Wang and Chen 1991.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 11.13: ccd_step")


def point_at(p, towards, length):
    """Given.  Return the point (d,) at this distance [m] from p towards another; along axis 0 if the two coincide."""
    r = towards - p
    size = np.sqrt(np.sum(r * r))
    if size == 0.0:
        r = np.zeros(p.size)
        r[0], size = 1.0, 1.0
    return p + length / size * r


def fabrik_sweep(x, target, lengths):
    """Return x (n + 1, d) of joints and end after a sweep of projections there and back, in the plane or in space.

    Back: the end goes to the target.  Then each joint, from the last to the first, moves along the line to the joint
        after it until their distance is lengths_k: x_k ← point_at(x_k+1, x_k, lengths_k), with the new x_k+1.
    Forth: joint 0 returns to its old place.  Then x_k+1 ← point_at(x_k, x_k+1, lengths_k), with the new x_k.

    This is lesson 8's projection of distances, with the whole correction on one end.  Returns a new array.
    *Source:* Aristidou and Lasenby 2011, FABRIK.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 11.14: fabrik_sweep")


def angles_of(x):
    """Given.  Return θ (n,) of joints at x (n + 1, 2): the inverse of joint_positions."""
    theta, before = np.empty(x.shape[0] - 1), 0.0
    for k in range(theta.size):
        phi = np.arctan2(x[k + 1, 1] - x[k, 1], x[k + 1, 0] - x[k, 0])
        theta[k], before = wrapped(phi - before), phi
    return theta


def fabrik_step(task, theta, target, arm):
    """Given.  Return θ after a fabrik_sweep, as a method for an Arm2D; limits are not kept."""
    return angles_of(fabrik_sweep(joint_positions(theta, arm.lengths), target, arm.lengths))


# ---------------------------------------------------------------------------------------------- limits and redundancy

def limited_step(task, theta, target, arm):
    """Return θ after a damped step between the limits arm.low and arm.high (n,).

    A joint is blocked if it is at a limit, or beyond it, and (Jᵀ e)_k points further out.
    J' is J with zeros in the columns of blocked joints.
    θ ← θ + J'ᵀ (J' J'ᵀ + λ² 1)⁻¹ e.  Then set each angle that is outside its limits to the nearest limit.
    Where the iteration comes to rest, no single joint can reduce |e|, to first order, without leaving its limits.
    *Source:* Bertsekas 1982, projected Newton methods.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 11.15: limited_step")


def null_space_step(task, theta, target, arm):
    """Return θ + Δθ:  go to the target, and use the remaining freedom to approach the angles arm.rest (n,).

    z = κ (rest − θ) is the desired change, κ = arm.pull.  *Find* Δθ with pseudo_inverse: of all Δθ for
    which |J Δθ − e| is smallest, the one that is nearest to z.  Limits are not kept.
    *Source:* Liégeois 1977.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 11.16: null_space_step")


# ---------------------------------------------------------------------------------------------- loops

def advance_reach(step, task, theta, target, iterations, arm):
    """Given.  Return θ after so many iterations.  Raises BadInput for invalid input, Diverged if θ is not finite."""
    check_record(arm, theta)
    theta, target, _, iterations = checked_reach(theta, target, 0.0, iterations, arm.low.size)
    theta = theta.copy()
    for _ in range(iterations):
        theta = step(task, theta, target, arm)
    e, _ = task(theta, target, arm)
    check_found(theta, np.sqrt(np.sum(e * e)))
    return theta


def reach_trajectory(step, task, theta, target, iterations, arm):
    """Given.  Return the angles (iterations + 1, n) before the first iteration and after each."""
    check_record(arm, theta)
    theta, target, _, iterations = checked_reach(theta, target, 0.0, iterations, arm.low.size)
    thetas = np.empty((iterations + 1, theta.size))
    thetas[0] = theta
    for k in range(iterations):
        thetas[k + 1] = advance_reach(step, task, thetas[k], target, 1, arm)
    return thetas


def solve_reach(step, task, theta, target, tolerance, most, arm):
    """Given.  Return (θ, |e|, iterations) when |e| is at most the tolerance, or after `most` iterations.

    A target out of reach is not an error: |e| is the distance that remains.  Raises what advance_reach raises.
    """
    check_record(arm, theta)
    theta, target, tolerance, most = checked_reach(theta, target, tolerance, most, arm.low.size)
    theta, iterations = theta.copy(), 0
    e, _ = task(theta, target, arm)
    while iterations < most and not np.sqrt(np.sum(e * e)) <= tolerance:
        theta, iterations = step(task, theta, target, arm), iterations + 1
        e, _ = task(theta, target, arm)
    error = np.sqrt(np.sum(e * e))
    check_found(theta, error)
    return theta, error, iterations


def solve_targets(step, task, theta, targets, tolerance, most, arm):
    """Given.  Return (θ (m, n), |e| (m,), iterations (m,)) for each of the targets (m, …), all from the same θ (n,)."""
    check_record(arm, theta)
    theta, targets = finite_array("the angles θ [rad]", theta), finite_array("the targets", targets)
    check_array("the targets", targets, 2)
    m = targets.shape[0]
    thetas, errors, counts = np.empty((m, theta.size)), np.empty(m), np.zeros(m, np.int64)
    for i in range(m):
        thetas[i], errors[i], counts[i] = solve_reach(step, task, theta, targets[i], tolerance, most, arm)
    return thetas, errors, counts


# ---------------------------------------------------------------------------------------------- why?

def remaining_distance(lengths, target, damping):
    """Return the distance [m] from the end of a planar arm to a target (2,), after many damped steps from a bent start.

    lengths (n,) are the links [m], the base is at (0, 0), and the damping λ [m] is large enough for the steps to come
    to rest.  *Find* what is left before you run anything.  Where does a step end that does not move the arm?  Which
    places can the end of the arm not reach?  0 for a target within reach.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 11.17: remaining_distance")


def newton_is():
    """Return the letter of the step with the pseudo-inverse: "A", "B", "C" or "D".

    The figure of the notebook has the error of four ways to a target within reach, far from where the arm is straight,
    after each iteration: the pseudo-inverse, the transpose with two gains, and a damped step.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 11.18: newton_is")


def my_writing():
    """Return (lengths (n,) [m], points (m, 2) [m], seconds): an arm, and what it writes.

    *Make it*: the hand passes the points at equal times, and the base is at (0, 0).  Many drawings are right.  The
    judge lets the arm follow by four damped steps per picture, with 25 pictures per second and λ a tenth of the reach
    Σ lengths, and demands:

    - It has two to six links, none shorter than a hundredth of the reach.  It takes 2 s to 20 s.  The path is at least
      as long as the reach, and is no line: across its main direction it is at least a twentieth of the reach wide.
    - The hand is always within a hundredth of the reach of where it should be, also between two pictures.
    - No joint turns faster than 2 rad/s, and σ₂ of the Jacobian never falls below a twentieth of the reach.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 11.19: my_writing")
