"""Lesson 11: arms that count angles from the wrong line, turn about the wrong joint, damp too little or go too far."""

import numpy as np

from solutions import kinematics as worked

from . import collection, variants

wrong, right, edit, MUTANTS = collection(worked)


# 11.1 -----------------------------------------------------------------------------------------------------------
@variants
def positions(absolute=False, swap=False, late=False, last=True):
    def joint_positions(theta, lengths):
        phi = np.array(theta) if absolute else np.cumsum(theta)
        if late:
            phi = phi - theta
        links = np.stack((np.sin(phi), np.cos(phi)) if swap else (np.cos(phi), np.sin(phi)), axis=1)
        x = np.concatenate((np.zeros((1, 2)), np.cumsum(np.asarray(lengths)[:, None] * links, axis=0)))
        return x if last else x[:-1]
    return joint_positions


@right("11.1", "by complex numbers")
def joint_positions(theta, lengths):
    z = np.append(0.0, np.cumsum(lengths * np.exp(1j * np.cumsum(theta))))
    return np.stack((z.real, z.imag), axis=1)


wrong("11.1", "measures each angle from the x axis, not from the link before")(positions(absolute=True))
wrong("11.1", "exchanges sine and cosine")(positions(swap=True))
wrong("11.1", "adds each angle one link late")(positions(late=True))
wrong("11.1", "omits the end of the last link")(positions(last=False))
edit("11.1", "does not add the positions of the links before",
     "x[k, 0] + lengths[k] * np.cos(phi)", "lengths[k] * np.cos(phi)")
edit("11.1", "measures the angles clockwise", "phi += theta[k]", "phi -= theta[k]")
edit("11.1", "takes the angles in degrees", "np.cos(phi)", "np.cos(np.radians(phi))")
edit("11.1", "forgets the lengths", "lengths[k] * np.cos(phi)", "np.cos(phi)")
edit("11.1", "uses the length of the first link for all", "lengths[k] * np.cos(phi)", "lengths[0] * np.cos(phi)")
edit("11.1", "leaves out the base", "return x", "return x[1:]")


# 11.2 -----------------------------------------------------------------------------------------------------------
@variants
def jacobian(sign=1.0, first=False, turn=True, unit=False):
    def jacobian_2d(x):
        r = (x[-1] - x[:-1]) if not first else np.diff(x, axis=0)
        if unit:
            r = r / np.linalg.norm(r, axis=1)[:, None]
        return sign * (np.stack((-r[:, 1], r[:, 0])) if turn else np.stack((r[:, 0], r[:, 1])))
    return jacobian_2d


@right("11.2", "by a matrix")
def jacobian_2d(x):
    return np.array([[0.0, -1.0], [1.0, 0.0]]) @ (x[-1] - x[:-1]).T


wrong("11.2", "reverses the sign, so that joints rotate clockwise")(jacobian(sign=-1.0))
wrong("11.2", "uses only the joint's own link as the arm")(jacobian(first=True))
wrong("11.2", "uses the arm r itself, not its perpendicular")(jacobian(turn=False))
wrong("11.2", "normalises the columns")(jacobian(unit=True))
edit("11.2", "takes all arms from the base", "x[n, 0] - x[k, 0]", "x[n, 0] - x[0, 0]")
edit("11.2", "forgets the minus sign of r_y", "x[k, 1] - x[n, 1], x[n, 0]", "x[n, 1] - x[k, 1], x[n, 0]")
edit("11.2", "exchanges the two rows", "J[0, k], J[1, k] = ", "J[1, k], J[0, k] = ")
edit("11.2", "takes the position of the end, not its offset from the joint",
     "x[k, 1] - x[n, 1], x[n, 0] - x[k, 0]", "-x[n, 1], x[n, 0]")
edit("11.2", "measures the arm from the next joint",
     "x[k, 1] - x[n, 1], x[n, 0] - x[k, 0]", "x[k + 1, 1] - x[n, 1], x[n, 0] - x[k + 1, 0]")
edit("11.2", "returns the transpose", "return J", "return J.T.copy()")


# 11.3 -----------------------------------------------------------------------------------------------------------
@variants
def ellipse(of_svd=True, squares=False, swapped=False, degrees=False):
    def velocity_ellipse(J):
        u, sigma, _ = np.linalg.svd(J, full_matrices=False)
        longer, shorter = sigma
        if not of_svd:
            values = np.linalg.eigvalsh(J @ J.T)
            shorter = np.sqrt(max(values[0], 0.0))
        if squares:
            longer, shorter = longer**2, shorter**2
        direction = u[:, 1 if swapped else 0]
        angle = np.arctan2(direction[1], direction[0])
        return longer, shorter, np.degrees(angle) if degrees else angle
    return velocity_ellipse


right("11.3", "by the singular values of NumPy")(ellipse())
wrong("11.3", "computes the short axis from a difference, which cancels")(ellipse(of_svd=False))
wrong("11.3", "returns the squares of the axes")(ellipse(squares=True))
wrong("11.3", "returns the angle of the short axis")(ellipse(swapped=True))
wrong("11.3", "returns the angle in degrees")(ellipse(degrees=True))
edit("11.3", "returns twice the angle", "0.5 * np.arctan2", "np.arctan2")
edit("11.3", "returns an angle that is never negative",
     "np.arctan2(2.0 * b, a - c)", "np.arctan2(2.0 * np.abs(b), a - c)")
edit("11.3", "returns the determinant as the short axis", "np.sqrt(squared) / longer", "np.sqrt(squared)")
edit("11.3", "exchanges the two half axes",
     "return longer, np.sqrt(squared) / longer,", "return np.sqrt(squared) / longer, longer,")
edit("11.3", "adds a and c in the angle", "2.0 * b, a - c)", "2.0 * b, a + c)")
edit("11.3", "forgets the factor 2 beside b", "np.arctan2(2.0 * b, a - c)", "np.arctan2(b, a - c)")
edit("11.3", "exchanges the arguments of the arctangent", "np.arctan2(2.0 * b, a - c)", "np.arctan2(a - c, 2.0 * b)")
edit("11.3", "forgets b in the longer axis", "0.25 * (a - c) ** 2 + b * b", "0.25 * (a - c) ** 2")
edit("11.3", "forgets the quarter", "0.25 * (a - c) ** 2", "(a - c) ** 2")
edit("11.3", "takes the shorter axis for the longer one", "0.5 * (a + c) + np.sqrt", "0.5 * (a + c) - np.sqrt")
edit("11.3", "uses JᵀJ in place of JJᵀ",
     "a, b, c, squared = J[0] @ J[0], J[0] @ J[1], J[1] @ J[1], 0.0",
     "a, b, c, squared = J[:, 0] @ J[:, 0], J[:, 0] @ J[:, 1], J[:, 1] @ J[:, 1], 0.0")


# 11.4 and 11.5 --------------------------------------------------------------------------------------------------
@variants
def two_links(one_elbow=False, back=1.0, wraps=True, checks=True, inside=True, swap=False, supplement=False):
    def solve_2r(target, lengths, elbow):
        l_1, l_2 = (lengths[1], lengths[0]) if swap else (lengths[0], lengths[1])
        r = np.hypot(*target)
        too_near = inside and r < abs(l_1 - l_2) * (1.0 - 1e-12)
        if checks and (r > (l_1 + l_2) * (1.0 + 1e-12) or too_near):
            raise worked.BadInput("distance of the target [m]", r, "stay within the reach")
        cosine = np.clip((r * r - l_1 * l_1 - l_2 * l_2) / (2.0 * l_1 * l_2), -1.0, 1.0)
        theta_2 = (1.0 if one_elbow else elbow) * np.arccos(-cosine if supplement else cosine)
        theta_1 = np.angle(complex(*target)) - back * np.angle(l_1 + l_2 * np.exp(1j * theta_2))
        return np.array((np.angle(np.exp(1j * theta_1)) if wraps else theta_1, theta_2))
    return solve_2r


right("11.4", "by the arccosine")(two_links())
wrong("11.4", "returns the same elbow twice")(two_links(one_elbow=True))
wrong("11.4", "reverses the correction of θ₁ by the bend")(two_links(back=-1.0))
wrong("11.4", "does not bring θ₁ back into (−π, π]")(two_links(wraps=False))
wrong("11.4", "does not test the reach")(two_links(checks=False))
wrong("11.4", "omits the inner limit of the reach")(two_links(inside=False))
wrong("11.4", "exchanges the two links")(two_links(swap=True))
wrong("11.4", "returns the inner angle of the triangle for θ₂")(two_links(supplement=True))
edit("11.4", "returns half of θ₂", "elbow * 2.0 * np.arctan2", "elbow * np.arctan2")
edit("11.4", "has no hole in the reach where the second link is the longer one",
     "np.abs(lengths[0] - lengths[1])", "lengths[0] - lengths[1]")


@variants
def three_links(wrist=1.0, relative=True, wraps=True, elbow_kept=True):
    def solve_3r(target, lengths, elbow):
        z = complex(target[0], target[1]) - wrist * lengths[2] * np.exp(1j * target[2])
        theta = worked.solve_2r(np.array((z.real, z.imag)), lengths, elbow if elbow_kept else 1.0)
        last = target[2] - (theta[0] + theta[1] if relative else 0.0)
        return np.append(theta, np.angle(np.exp(1j * last)) if wraps else last)
    return solve_3r


right("11.5", "by complex numbers")(three_links())
wrong("11.5", "solves the first two links for the end itself, not for the wrist")(three_links(wrist=0.0))
wrong("11.5", "puts the wrist beyond the end")(three_links(wrist=-1.0))
wrong("11.5", "measures the third angle from the x axis")(three_links(relative=False))
wrong("11.5", "does not bring θ₃ back into (−π, π]")(three_links(wraps=False))
wrong("11.5", "returns the same elbow twice")(three_links(elbow_kept=False))
edit("11.4", "exchanges the arguments of the arctangent of the target",
     "np.arctan2(target[1], target[0])", "np.arctan2(target[0], target[1])")
edit("11.4", "exchanges sine and cosine of θ₂",
     "lengths[1] * np.sin(theta_2), lengths[0] + lengths[1] * np.cos(theta_2)",
     "lengths[1] * np.cos(theta_2), lengths[0] + lengths[1] * np.sin(theta_2)")
edit("11.4", "omits the correction of θ₁ by the bend", "target[0]) - back", "target[0]) - 0.0 * back")
edit("11.4", "forgets the roots",
     "np.sqrt(np.maximum(outer, 0.0)), np.sqrt(np.maximum(inner, 0.0))",
     "np.maximum(outer, 0.0), np.maximum(inner, 0.0)")
edit("11.4", "returns the angles in degrees", "return np.array(", "return np.degrees(")
edit("11.4", "reverses the sign of the elbow", "theta_2 = elbow", "theta_2 = -elbow")
edit("11.5", "subtracts only θ₂", "phi - theta[0] - theta[1]", "phi - theta[1]")
edit("11.5", "adds the first two angles", "phi - theta[0] - theta[1]", "phi + theta[0] + theta[1]")
edit("11.5", "exchanges sine and cosine",
     "lengths[2] * np.cos(phi), target[1] - lengths[2] * np.sin(phi)",
     "lengths[2] * np.sin(phi), target[1] - lengths[2] * np.cos(phi)")
edit("11.5", "uses the length of the second link for the wrist",
     "target[0] - lengths[2] * np.cos(phi), target[1] - lengths[2] * np.sin(phi)",
     "target[0] - lengths[1] * np.cos(phi), target[1] - lengths[1] * np.sin(phi)")
edit("11.5", "forgets the length of the third link",
     "target[0] - lengths[2] * np.cos(phi), target[1] - lengths[2] * np.sin(phi)",
     "target[0] - np.cos(phi), target[1] - np.sin(phi)")


# 11.6 -----------------------------------------------------------------------------------------------------------
@variants
def frames(axis_in_world=True, before=False, order=1, sign=1.0):
    def joint_frames(theta, axes, offsets):
        x, a, q = [np.zeros(3)], [], np.array([1.0, 0.0, 0.0, 0.0])
        for angle, axis, offset in zip(theta, axes, offsets):
            old = q
            turn = worked.exponential(sign * angle * axis)
            q = worked.quaternion_product(q, turn) if order > 0 else worked.quaternion_product(turn, q)
            a.append(worked.rotate(old, axis) if axis_in_world else axis)
            x.append(x[-1] + worked.rotate(old if before else q, offset))
        return np.array(x), np.array(a), q
    return joint_frames


@right("11.6", "the new q gives the axis, too")
def joint_frames(theta, axes, offsets):
    x, a, q = np.zeros((len(theta) + 1, 3)), np.zeros((len(theta), 3)), np.array([1.0, 0.0, 0.0, 0.0])
    for k in range(len(theta)):
        q = worked.quaternion_product(q, worked.exponential(theta[k] * axes[k]))
        a[k], x[k + 1] = worked.rotate(q, axes[k]), x[k] + worked.rotate(q, offsets[k])
    return x, a, q


wrong("11.6", "does not rotate the axes into the world")(frames(axis_in_world=False))
wrong("11.6", "rotates a joint's own link one joint late")(frames(before=True))
wrong("11.6", "multiplies the rotations in the wrong order")(frames(order=-1))
wrong("11.6", "turns the other way")(frames(sign=-1.0))
edit("11.6", "does not rotate the offsets into the world", "rotate(q, row(offsets, k))", "row(offsets, k)")
edit("11.6", "does not add the positions of the joints before",
     "plus(row(x, k), 1.0, rotate(q, row(offsets, k)))", "rotate(q, row(offsets, k))")
edit("11.6", "subtracts the offsets", "plus(row(x, k), 1.0,", "plus(row(x, k), -1.0,")
edit("11.6", "turns every joint by 1 rad", "scaled(theta[k], axis)", "scaled(1.0, axis)")
edit("11.6", "turns by twice the angle", "scaled(theta[k], axis)", "scaled(2.0 * theta[k], axis)")
edit("11.6", "turns by half of the angle", "scaled(theta[k], axis)", "scaled(0.5 * theta[k], axis)")
edit("11.6", "turns about the axis in the world, from the right",
     "exponential(scaled(theta[k], axis))", "exponential(scaled(theta[k], rotate(q, axis)))")


# 11.7 -----------------------------------------------------------------------------------------------------------
@variants
def spatial(sign=1.0, end=True, swapped=False, spins=True):
    def jacobian_3d(x, a):
        v = sign * np.cross(a, (x[-1] - x[:-1]) if end else -x[:-1])
        omega = a if spins else 0.0 * a
        return np.concatenate((omega, v) if swapped else (v, omega), axis=1).T
    return jacobian_3d


right("11.7", "all joints at once")(spatial())
wrong("11.7", "reverses the cross product")(spatial(sign=-1.0))
wrong("11.7", "returns the velocity of a point at the origin")(spatial(end=False))
wrong("11.7", "puts the angular velocity first")(spatial(swapped=True))
wrong("11.7", "omits the angular velocity")(spatial(spins=False))
edit("11.7", "measures the arm from the next joint", "minus(row(x, n), row(x, k))", "minus(row(x, n), row(x, k + 1))")
edit("11.7", "takes the position of the end, not its offset from the joint", "minus(row(x, n), row(x, k))", "row(x, n)")
edit("11.7", "uses the axis of the first joint for all", "across(row(a, k),", "across(row(a, 0),")


# 11.8 -----------------------------------------------------------------------------------------------------------
@variants
def rotation(body=False, shorter=True, half=2.0, back=False, small=True, arccos=False):
    def rotation_error(q, q_target):
        conjugate = np.array([q[0], -q[1], -q[2], -q[3]])
        d = worked.quaternion_product(conjugate, q_target) if body else worked.quaternion_product(q_target, conjugate)
        if shorter and d[0] < 0.0:
            d = -d
        size = np.linalg.norm(d[1:])
        if size == 0.0 and small:
            return 0.0 * d[1:]
        with np.errstate(all="ignore"):
            angle = half * (np.arccos(np.clip(d[0], -1.0, 1.0)) if arccos else np.arctan2(size, d[0]))
            return (-1.0 if back else 1.0) * angle * d[1:] / size
    return rotation_error


right("11.8", "with a unit vector")(rotation())
wrong("11.8", "returns the error in body coordinates")(rotation(body=True))
wrong("11.8", "rotates the longer way")(rotation(shorter=False))
wrong("11.8", "returns half of the angle")(rotation(half=1.0))
wrong("11.8", "reverses the rotation")(rotation(back=True))
wrong("11.8", "divides zero by zero where no rotation is needed")(rotation(small=False))
wrong("11.8", "uses the arccosine, which loses digits near 1")(rotation(arccos=True))
edit("11.8", "does not divide by |𝐝|", "np.arctan2(size, d[0]) / size", "np.arctan2(size, d[0])")
edit("11.8", "exchanges the arguments of the arctangent", "np.arctan2(size, d[0])", "np.arctan2(d[0], size)")
edit("11.8", "forgets the conjugate", "np.array((q[0], -q[1], -q[2], -q[3]))", "q")
edit("11.8", "takes the sine for the angle", "2.0 if size == 0.0 else 2.0 * np.arctan2(size, d[0]) / size", "2.0")


# 11.9 -----------------------------------------------------------------------------------------------------------
@variants
def transposed(sign=1.0, gain=lambda arm, J: arm.gain, signs=False):
    def transpose_step(task, theta, target, arm):
        e, J = task(theta, target, arm)
        change = J.T @ e
        return theta + sign * gain(arm, J) * (np.sign(change) if signs else change)
    return transpose_step


right("11.9", "with Jᵀ written out")(transposed())
wrong("11.9", "reverses the step, which then increases the error")(transposed(sign=-1.0))
wrong("11.9", "omits the gain")(transposed(gain=lambda arm, J: 1.0))
wrong("11.9", "divides the gain by σ²")(transposed(gain=lambda arm, J: arm.gain / np.linalg.norm(J, 2) ** 2))
wrong("11.9", "uses only the signs of Jᵀ e")(transposed(signs=True))
edit("11.9", "returns the change, not the new angles", "return theta + arm.gain", "return arm.gain")
edit("11.9", "divides by the gain", "arm.gain * (e @ J)", "(e @ J) / arm.gain")
edit("11.9", "starts from zero angles", "theta + arm", "0.0 * theta + arm")
edit("11.9", "normalises the error", "(e @ J)", "(e @ J) / (np.sqrt(e @ e) + 1e-300)")
edit("11.9", "shortens an error that is longer than a metre", "(e @ J)", "(e @ J) / np.maximum(1.0, np.sqrt(e @ e))")


# 11.10 ----------------------------------------------------------------------------------------------------------
@variants
def inverse(cut=1e-10, power=1, full=True):
    def pseudo_inverse(J):
        if not full:
            return J.T.copy()
        u, sigma, v = np.linalg.svd(J, full_matrices=False)
        kept = sigma > cut * sigma[0]
        return (v[kept].T / sigma[kept] ** power) @ u[:, kept].T
    return pseudo_inverse


@right("11.10", "by NumPy")
def pseudo_inverse(J):
    return np.linalg.pinv(J, 1e-10)


wrong("11.10", "inverts round-off")(inverse(cut=0.0))
wrong("11.10", "drops small singular values that are no round-off")(inverse(cut=1e-4))
wrong("11.10", "divides by σ² in place of σ")(inverse(power=2))
wrong("11.10", "returns the transpose, not the pseudo-inverse")(inverse(full=False))
edit("11.10", "multiplies by σ", "/ sigma[i]", "* sigma[i]")
edit("11.10", "keeps the last direction only", "J_plus[k, r] += v", "J_plus[k, r] = v")
edit("11.10", "exchanges rows and columns: returns the transpose of the pseudo-inverse",
     "return J_plus", "return J_plus.T.copy()")
edit("11.10", "keeps the small singular values only", "if not sigma[i] <= SINGULAR", "if sigma[i] <= SINGULAR")
edit("11.10", "does not divide by σ", "/ sigma[i]", "/ 1.0")
edit("11.10", "compares with SINGULAR itself, not with that part of the largest σ", "SINGULAR * sigma[0]", "SINGULAR")


# 11.11 and 11.12 ------------------------------------------------------------------------------------------------
@variants
def damping_of(squared=True, damped=True, sign=1.0, after=False):
    def damped_step(task, theta, target, arm):
        e, J = task(theta, target, arm)
        weight = (arm.damping**2 if squared else arm.damping) if damped else 1e-12
        change = np.linalg.solve(J.T @ J + weight * np.eye(len(theta)), J.T @ e)
        return theta + sign * (change / (1.0 + arm.damping) if after else change)
    return damped_step


right("11.11", "as a system for all joints")(damping_of())
wrong("11.11", "uses λ in place of λ²")(damping_of(squared=False))
wrong("11.11", "omits the damping")(damping_of(damped=False))
wrong("11.11", "reverses the step")(damping_of(sign=-1.0))
wrong("11.11", "scales the step down as well")(damping_of(after=True))
edit("11.11", "adds λ² off the diagonal, too", "A[r, r] +=", "A[r] +=")


@variants
def factors(gain_power=2, damping_power=2, done=False, size=lambda y: y, worst=False):
    def contraction_factors(sigma, gain, damping):
        transpose = 1.0 - gain * sigma**gain_power
        damped = damping**damping_power / (sigma**2 + damping**damping_power)
        if worst:
            return np.max(np.abs(transpose)) * np.ones_like(sigma), damped
        return size(transpose), 1.0 - damped if done else damped
    return contraction_factors


right("11.12", "term by term")(factors())
wrong("11.12", "uses σ in place of σ²")(factors(gain_power=1))
wrong("11.12", "uses λ in place of λ²")(factors(damping_power=1))
wrong("11.12", "returns the share that is done, not the share that is left")(factors(done=True))
wrong("11.12", "returns sizes in place of signed factors")(factors(size=np.abs))
wrong("11.12", "returns the slowest factor for all")(factors(worst=True))
edit("11.11", "subtracts λ²", "A[r, r] += arm", "A[r, r] -= arm")
edit("11.11", "returns the change, not the new angles", "return theta + sum", "return sum")
edit("11.11", "divides by λ²", "A[r, r] += arm.damping * arm.damping", "A[r, r] += 1.0 / (arm.damping * arm.damping)")
edit("11.11", "adds λ² to the first entry only", "A[r, r] +=", "A[0, 0] +=")
edit("11.11", "replaces the diagonal by λ²", "A[r, r] += arm", "A[r, r] = arm")
edit("11.11", "multiplies by J Jᵀ in place of solving with it", "solve_symmetric(A, e)", "A @ e")
edit("11.12", "exchanges the two factors",
     "return 1.0 - gain * sigma**2, damping**2 / (sigma**2 + damping**2)",
     "return damping**2 / (sigma**2 + damping**2), 1.0 - gain * sigma**2")
edit("11.12", "omits the damping in the denominator", "(sigma**2 + damping**2)", "sigma**2")
edit("11.12", "subtracts λ² in the denominator", "(sigma**2 + damping**2)", "(sigma**2 - damping**2)")
edit("11.12", "returns the share that is done for the damped step", "damping**2 / (sigma**2", "sigma**2 / (sigma**2")
edit("11.12", "forgets the gain", "gain * sigma**2", "sigma**2")
edit("11.12", "divides the gain by σ²", "gain * sigma**2", "gain / sigma**2")


# 11.13 ----------------------------------------------------------------------------------------------------------
@variants
def descent(last_first=True, moves_end=True, sign=1.0, keeps=True, wish=False, share=1.0):
    def ccd_step(task, theta, target, arm):
        theta, goal = np.array(theta), complex(*target)
        z = worked.joint_positions(theta, arm.lengths) @ np.array([1.0, 1j])
        for k in reversed(range(len(theta))) if last_first else range(len(theta)):
            change = sign * share * np.angle((goal - z[k]) * np.conj(z[-1] - z[k]))
            new = min(max(theta[k] + change, arm.low[k]), arm.high[k]) if keeps else theta[k] + change
            turned = change if wish else new - theta[k]
            theta[k] = new
            if moves_end:
                z[k:] = z[k] + np.exp(1j * turned) * (z[k:] - z[k])
        return theta
    return ccd_step


right("11.13", "by complex numbers, with all joints")(descent())
wrong("11.13", "visits the joints from the first to the last")(descent(last_first=False))
wrong("11.13", "does not move the end between the joints")(descent(moves_end=False))
wrong("11.13", "rotates away from the target")(descent(sign=-1.0))
wrong("11.13", "omits the limits")(descent(keeps=False))
wrong("11.13", "moves the end as if there were no limits")(descent(wish=True))
wrong("11.13", "makes half of each rotation")(descent(share=0.5))
edit("11.13", "changes its input", "theta.copy()", "theta")
edit("11.13", "exchanges the arguments of the arctangent",
     "np.arctan2(r_x * s_y - r_y * s_x, r_x * s_x + r_y * s_y)",
     "np.arctan2(r_x * s_x + r_y * s_y, r_x * s_y - r_y * s_x)")
edit("11.13", "replaces the angle by the turn", "wish = theta[k] + np", "wish = np")
edit("11.13", "turns the end the other way",
     "x[k, 0] + c * r_x - s * r_y, x[k, 1] + s * r_x + c * r_y",
     "x[k, 0] + c * r_x + s * r_y, x[k, 1] - s * r_x + c * r_y")
edit("11.13", "limits the turn, not the angle",
     "new = np.minimum(np.maximum(wish, arm.low[k]), arm.high[k])",
     "new = theta[k] + np.minimum(np.maximum(wish - theta[k], arm.low[k]), arm.high[k])")
edit("11.13", "turns the end about the base",
     "theta[k], end_x, end_y = new, x[k, 0] + c * r_x - s * r_y, x[k, 1] + s * r_x + c * r_y",
     "theta[k], end_x, end_y = new, c * end_x - s * end_y, s * end_x + c * end_y")
edit("11.13", "has a wrong sign in the cross product", "r_x * s_y - r_y * s_x, r_x", "r_x * s_y + r_y * s_x, r_x")


# 11.14 ----------------------------------------------------------------------------------------------------------
@variants
def projections(back=True, forth=True, old=False, base=True, lengths_in=1):
    def fabrik_sweep(x, target, lengths):
        before, y, lengths = np.array(x), np.array(x), np.asarray(lengths)[::lengths_in]
        step = lambda p, q, length: p + length * (q - p) / np.linalg.norm(q - p)
        if back:
            y[-1] = target
            for k in reversed(range(len(lengths))):
                y[k] = step(before[k + 1] if old and k + 1 < len(lengths) else y[k + 1], y[k], lengths[k])
        if forth:
            y[0] = before[0] if base else y[0]
            for k in range(len(lengths)):
                y[k + 1] = step(y[k], y[k + 1], lengths[k])
        return y
    return fabrik_sweep


right("11.14", "with unit vectors")(projections())
wrong("11.14", "makes the backward pass only")(projections(forth=False))
wrong("11.14", "makes the forward pass only")(projections(back=False))
wrong("11.14", "uses the old positions in the backward pass")(projections(old=True))
wrong("11.14", "does not put the base back")(projections(base=False))
wrong("11.14", "uses the lengths in the wrong order")(projections(lengths_in=-1))
edit("11.14", "changes its input", "x[0].copy(), x.copy()", "x[0].copy(), x")
edit("11.14", "moves the base to the origin", "x[0] = base", "x[0] = 0.0 * base")
edit("11.14", "exchanges the two points: measures from the old point to the new one",
     "x[k] = point_at(x[k + 1], x[k], lengths[k])", "x[k] = point_at(x[k], x[k + 1], lengths[k])")
edit("11.14", "exchanges the two points on the way forth",
     "x[k + 1] = point_at(x[k], x[k + 1], lengths[k])", "x[k + 1] = point_at(x[k + 1], x[k], lengths[k])")
edit("11.14", "leaves out the last link on the way forth", "for k in range(n):", "for k in range(n - 1):")


# 11.15 ----------------------------------------------------------------------------------------------------------
@variants
def between_limits(blocks=True, by_gradient=True, clips=True, low_too=True, frozen=False):
    def limited_step(task, theta, target, arm):
        e, J = task(theta, target, arm)
        push = J.T @ e if by_gradient else np.ones(len(theta))
        out = (theta >= arm.high) & (push > 0.0)
        if low_too:
            out |= (theta <= arm.low) & ((push < 0.0) | (not by_gradient))
        if frozen:
            out = (theta >= arm.high) | (theta <= arm.low)
        if blocks:
            J = np.where(out, 0.0, J)
        change = np.linalg.solve(J.T @ J + arm.damping**2 * np.eye(len(theta)), J.T @ e)
        return np.clip(theta + change, arm.low, arm.high) if clips else theta + change
    return limited_step


right("11.15", "as a system for all joints")(between_limits())
wrong("11.15", "clips the angles and blocks no joint")(between_limits(blocks=False))
wrong("11.15", "blocks joints and does not clip the angles")(between_limits(clips=False))
wrong("11.15", "omits the lower limits")(between_limits(low_too=False))
wrong("11.15", "never frees a joint at a limit")(between_limits(frozen=True))
edit("11.15", "blocks joints that move away from their limits", "wish[k] > 0.0", "wish[k] < 0.0")
edit("11.15", "omits the damping", "arm.damping * arm.damping", "1e-9")
edit("11.15", "blocks joints at any limit, whatever the direction",
     "(theta[k] >= arm.high[k] and wish[k] > 0.0)", "(theta[k] >= arm.high[k])")
edit("11.15", "omits the upper limits",
     "np.minimum(np.maximum(theta + sum_of_rows(J, solve_symmetric(A, e)), arm.low), arm.high)",
     "np.maximum(theta + sum_of_rows(J, solve_symmetric(A, e)), arm.low)")
edit("11.15", "exchanges the limits",
     "(theta[k] >= arm.high[k] and wish[k] > 0.0) or (theta[k] <= arm.low[k] and wish[k] < 0.0)",
     "(theta[k] >= arm.low[k] and wish[k] > 0.0) or (theta[k] <= arm.high[k] and wish[k] < 0.0)")
edit("11.15", "uses λ in place of λ²", "arm.damping * arm.damping", "arm.damping")
edit("11.15", "does not block a joint exactly at its upper limit", "theta[k] >= arm.high[k]", "theta[k] > arm.high[k]")


# 11.16 ----------------------------------------------------------------------------------------------------------
@variants
def freedom(projects=True, reaches=True, sign=1.0, pulls=True, towards_zero=False):
    def null_space_step(task, theta, target, arm):
        e, J = task(theta, target, arm)
        rest = np.zeros(len(theta)) if towards_zero else arm.rest
        z = sign * (arm.pull if pulls else 1.0) * (rest - theta)
        J_plus = np.linalg.pinv(J, 1e-10)
        stay = np.eye(len(theta)) - J_plus @ J if projects else np.eye(len(theta))
        return theta + (J_plus @ e if reaches else 0.0) + stay @ z
    return null_space_step


right("11.16", "with the projection as a matrix")(freedom())
wrong("11.16", "does not project the pull into the null space")(freedom(projects=False))
wrong("11.16", "omits the step towards the target")(freedom(reaches=False))
wrong("11.16", "reverses the pull")(freedom(sign=-1.0))
wrong("11.16", "pulls all the way to rest in one step")(freedom(pulls=False))
wrong("11.16", "pulls to zero in place of the rest angles")(freedom(towards_zero=True))
edit("11.16", "omits the pull", "return theta + z +", "return theta +")
edit("11.16", "subtracts the pull", "theta + z + pseudo", "theta - z + pseudo")
edit("11.16", "adds what the pull moves to the error, where it is subtracted", "(e - J @ z)", "(e + J @ z)")
edit("11.16", "returns the change, not the new angles", "return theta + z", "return z")
edit("11.16", "uses the transpose in place of the pseudo-inverse",
     "pseudo_inverse(J) @ (e - J @ z)", "J.T @ (e - J @ z)")
edit("11.16", "projects onto what moves the end, not onto what does not",
     "theta + z + pseudo_inverse(J) @ (e - J @ z)", "theta + pseudo_inverse(J) @ (e + J @ z)")
