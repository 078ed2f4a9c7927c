"""Lesson 5: wrong signs, sides, frames and halves, and alternative right answers."""

import numpy as np

from solutions import rotation as worked
from solutions.checks import Diverged

from . import collection, variants

wrong, right, edit, MUTANTS = collection(worked)


# 5.1 ------------------------------------------------------------------------------------------------------------
@right("5.1", "as cross products with the axes")
def skew(a):
    return np.stack([np.cross(a, e) for e in np.eye(3)], axis=1)


MATRIX = "[[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]]"
edit("5.1", "returns the transpose, which gives b × a",
     MATRIX, "[[0.0, a[2], -a[1]], [-a[2], 0.0, a[0]], [a[1], -a[0], 0.0]]")
edit("5.1", "omits the minus signs", MATRIX, MATRIX.replace("-", ""))
edit("5.1", "exchanges the components x and z",
     MATRIX, MATRIX.replace("a[2]", "c").replace("a[0]", "a[2]").replace("c", "a[0]"))
edit("5.1", "returns the outer product of a with itself", f"np.array({MATRIX})", "np.outer(a, a)")
edit("5.1", "has the wrong sign of a_y in the first row", "-a[2], a[1]]", "-a[2], -a[1]]")
SIGN_IN_SECOND_ROW = edit("5.1", "has the wrong sign of a_x in the second row", "0.0, -a[0]]", "0.0, a[0]]")
edit("5.1", "has the wrong sign of a_z in the first row", "[[0.0, -a[2]", "[[0.0, a[2]")
edit("5.1", "exchanges the components x and y", "return np", "a = a[[1, 0, 2]]; return np")
edit("5.1", "takes the identity matrix for a = 0, as for a rotation by nothing",
     "return np", "return np.eye(3) if not a.any() else np")
edit("5.1", "takes components below 1e-6 for zero", "return np",
     "a = np.where(np.abs(a) < 1e-6, 0.0, a); return np")


# 5.2 ------------------------------------------------------------------------------------------------------------
@right("5.2", "by the skew matrix")
def point_velocity(v, omega, r):
    return worked.skew(omega) @ r + v


edit("5.2", "takes r × ω in place of ω × r", "cross(omega, r)", "cross(r, omega)")
edit("5.2", "omits the velocity of the centre of mass", "v + cross(omega, r)", "cross(omega, r)")
edit("5.2", "omits the rotation, ω × r", "v + cross(omega, r)", "v.copy()")
edit("5.2", "multiplies ω and r component by component", "cross(omega, r)", "omega * r")
ROTATION_SUBTRACTED = edit("5.2", "subtracts the rotation", "v + cross", "v - cross")
edit("5.2", "leaves out the rotation where the centre of mass is at rest",
     "cross(omega, r)", "cross(omega, r) * v.any()")
edit("5.2", "takes a rotation slower than 1e-6 rad/s for none", "return v",
     "omega = np.where(np.abs(omega) < 1e-6, 0.0, omega); return v")
edit("5.2", "takes an arm below 1 µm for none", "return v",
     "r = np.where(np.abs(r) < 1e-6, 0.0, r); return v")
edit("5.2", "takes a velocity below 1 µm/s for none", "return v",
     "v = np.where(np.abs(v) < 1e-6, 0.0, v); return v")


# 5.3 ------------------------------------------------------------------------------------------------------------
@right("5.3", "all at once")
def total_load(x, points, forces):
    return np.sum(forces, axis=0), np.sum(np.cross(points, forces), axis=0) - np.cross(x, np.sum(forces, axis=0))


AT_ORIGIN = edit("5.3", "takes the torque about the origin, not about the centre of mass", "points[i] - x", "points[i]")
edit("5.3", "takes f × r in place of r × f", "cross(points[i] - x, forces[i])", "cross(forces[i], points[i] - x)")
edit("5.3", "takes the arm from the point to the centre", "points[i] - x", "x - points[i]")
edit("5.3", "lets all forces act at the mean of the points",
     "points[i] - x", "np.sum(points, axis=0) / points.shape[0] - x")
edit("5.3", "changes the array of points", "points[i] - x", "np.subtract(points[i], x, out=points[i])")
edit("5.3", "keeps the last torque only", "tau += cross", "tau = cross")
edit("5.3", "keeps the last force only", "F += forces", "F = forces")
edit("5.3", "returns the torque first", "return F, tau", "return tau, F")
edit("5.3", "adds the centre of mass", "points[i] - x", "points[i] + x")
edit("5.3", "takes the mean of the forces", "return F, tau", "return F / forces.shape[0], tau")
edit("5.3", "ends at the first force that is 0",
     "F += forces[i]", "if not forces[i].any(): break\n        F += forces[i]")
edit("5.3", "ends at the first force that acts at the centre of mass",
     "tau += cross", "if not (points[i] - x).any(): break\n        tau += cross")
edit("5.3", "begins with the first force, which there need not be",
     "F, tau = np.zeros(3), np.zeros(3)", "F, tau = forces[0] - forces[0], np.zeros(3)")
edit("5.3", "takes a force below 1 µN for none", "F, tau =",
     "forces = np.where(np.abs(forces) < 1e-6, 0.0, forces); F, tau =")
edit("5.3", "takes a point within a micrometre of the centre to be there", "F, tau =",
     "points = np.where(np.abs(points - x) < 1e-6, x, points); F, tau =")


# 5.4 ------------------------------------------------------------------------------------------------------------
@right("5.4", "solves with the inertia of the world")
def angular_velocity(R, L, I_body):
    return np.linalg.solve(R @ np.diag(I_body) @ R.T, L)


edit("5.4", "divides L in world axes by the moments of the body axes", "R @ ((R.T @ L) / I_body)", "L / I_body")
edit("5.4", "returns ω in body coordinates", "R @ ((R.T @ L) / I_body)", "(R.T @ L) / I_body")
edit("5.4", "multiplies by the inertia in place of dividing by it", "/ I_body", "* I_body")
WORLD_FOR_BODY = edit("5.4", "exchanges R and its transpose", "R @ ((R.T @ L) / I_body)", "R.T @ ((R @ L) / I_body)")
edit("5.4", "divides L of the world by the moments and rotates the result",
     "R @ ((R.T @ L) / I_body)", "R @ (L / I_body)")
edit("5.4", "converts with R and R, not with Rᵀ first", "(R.T @ L)", "(R @ L)")
edit("5.4", "takes a body with two equal moments for a ball",
     "R @ ((R.T @ L) / I_body)", "R @ ((R.T @ L) / I_body) if I_body[0] != I_body[1] else L / I_body[0]")
edit("5.4", "takes an L below 1e-6 kg m²/s for none", "return R",
     "L = np.where(np.abs(L) < 1e-6, 0.0, L); return R")
edit("5.4", "takes moments of at least 1e-3 kg m²", "/ I_body", "/ np.maximum(I_body, 1e-3)")


# 5.5 ------------------------------------------------------------------------------------------------------------
@variants
def derivative(mass=lambda m: m, turn=lambda omega, R: worked.skew(omega) @ R,
               omega=worked.angular_velocity, torque=lambda tau, omega, L: tau):
    """Ṡ with parts that may be wrong."""
    def state_derivative(S, F, tau, body):
        w = omega(S.R, S.L, body.I_body)
        return worked.RigidBodyState(S.P / mass(body.m), turn(w, S.R), F, torque(tau, w, S.L))
    return state_derivative


right("5.5", "by columns")(derivative(turn=lambda omega, R: np.cross(omega, R.T).T))
wrong("5.5", "returns the momentum P in place of the velocity P/m")(derivative(mass=lambda m: 1.0))
wrong("5.5", "takes R ω* in place of ω* R")(derivative(turn=lambda omega, R: R @ worked.skew(omega)))
wrong("5.5", "turns the other way")(derivative(turn=lambda omega, R: worked.skew(omega).T @ R))
wrong("5.5", "takes the cross product with the rows of R, not with its columns")(
    derivative(turn=lambda omega, R: np.cross(omega, R)))
wrong("5.5", "uses L in place of ω")(derivative(omega=lambda R, L, I: L))
wrong("5.5", "adds a gyroscopic term to L̇, where only the torque belongs")(
    derivative(torque=lambda tau, omega, L: tau - np.cross(omega, L)))
edit("5.5", "uses a mass of at least 1 kg", "S.P / body.m", "S.P / max(1.0, body.m)")
edit("5.5", "multiplies by the mass", "S.P / body.m", "S.P * body.m")
edit("5.5", "exchanges force and torque", "F, tau)", "tau, F)")
edit("5.5", "returns the new orientation, R + ω* R", "skew(omega) @ S.R,", "S.R + skew(omega) @ S.R,")
edit("5.5", "returns ω* in place of ω* R", "skew(omega) @ S.R", "skew(omega)")
edit("5.5", "returns the momenta in place of force and torque", "F, tau)", "S.P, S.L)")
edit("5.5", "returns the acceleration in place of the force", "F, tau)", "F / body.m, tau)")
edit("5.5", "leaves the orientation as it is where no torque acts",
     "skew(omega) @ S.R", "skew(omega) @ S.R * tau.any()")
edit("5.5", "uses a mass of at least 1 g", "S.P / body.m", "S.P / max(1e-3, body.m)")
edit("5.5", "uses a mass of at most 1 t", "S.P / body.m", "S.P / min(1e3, body.m)")
edit("5.5", "takes a rotation slower than 1e-6 rad/s for none", "return Rigid",
     "omega = np.where(np.abs(omega) < 1e-6, 0.0, omega); return Rigid")


# 5.6 ------------------------------------------------------------------------------------------------------------
def renormalised(M):
    Q, upper = np.linalg.qr(M)
    return Q * np.sign(np.diag(upper))


@right("5.6", "by a QR factorisation")
def matrix_update(R, omega, dt):
    return renormalised(R + dt * np.cross(omega, R.T).T)


edit("5.6", "does not renormalise", "first, second = M[:, 0].copy(), M[:, 1].copy()", "return M")
edit("5.6", "normalises the columns but does not make them orthogonal", "dot(first, second) * first", "0.0")
edit("5.6", "normalises the columns but does not make them orthogonal",
     "first, second = M[:, 0].copy(), M[:, 1].copy()", "return M / np.sqrt(np.sum(M * M, axis=0))")
edit("5.6", "reverses the third column", "cross(first, second)", "cross(second, first)")
edit("5.6", "takes ω as if it were in body coordinates", "skew(omega) @ R", "R @ skew(omega)")
edit("5.6", "forgets dt", "dt * (skew(omega) @ R)", "skew(omega) @ R")
edit("5.6", "orthonormalises the rows, not the columns", "np.stack((first, second, cross(first, second)), axis=1)",
     "np.linalg.qr(M.T)[0].T * np.sign(np.diag(np.linalg.qr(M.T)[1]))[:, None]")
edit("5.6", "changes its input", "R + dt * (skew(omega) @ R)", "np.add(R, dt * (skew(omega) @ R), out=R)")
edit("5.6", "returns the three vectors as rows, not as columns", "axis=1", "axis=0")
edit("5.6", "subtracts the rotation", "R + dt", "R - dt")
edit("5.6", "does not normalise the second column", "second /= norm(second)", "pass")
edit("5.6", "does not normalise the first column", "first /= norm(first)", "pass")
edit("5.6", "adds the part along the first column", "second -= dot", "second += dot")
edit("5.6", "leaves out R: keeps only the change", "M = R + dt", "M = dt")
edit("5.6", "uses ½ dt, which belongs to a quaternion", "dt * (skew", "0.5 * dt * (skew")
edit("5.6", "keeps the third column of the step", "cross(first, second)), axis=1", "M[:, 2] / norm(M[:, 2])), axis=1")
edit("5.6", "takes a body for one at rest where any component of ω is 0", "R + dt", "R + bool(omega.all()) * dt")
edit("5.6", "does not renormalise a body at rest", "M = R + dt", "if not omega.any(): return R.copy()\n    M = R + dt")
edit("5.6", "takes a turn below 1e-6 rad for none", "skew(omega)", "(norm(omega * dt) > 1e-6) * skew(omega)")
edit("5.6", "ignores the sign of dt", "M = R + dt", "M = R + abs(dt)")


# 5.7 ------------------------------------------------------------------------------------------------------------
@variants
def rodrigues(angle=lambda rate, dt: rate * dt, sign=1.0, along=1.0, side=lambda T, R: T @ R, rest=True):
    """exp(θ n*) = 1 + sin θ n* + (1 − cos θ) n*², with parts that may be wrong."""
    def axis_angle_update(R, omega, dt):
        rate = np.linalg.norm(omega)
        if rest and rate == 0.0:
            return R.copy()
        K, theta = worked.skew(omega / rate), angle(rate, dt)
        return side(np.eye(3) + sign * np.sin(theta) * K + along * (1.0 - np.cos(theta)) * K @ K, R)
    return axis_angle_update


right("5.7", "as one matrix")(rodrigues())
wrong("5.7", "turns the other way")(rodrigues(sign=-1.0))
wrong("5.7", "multiplies R from the right, as if ω were in body coordinates")(rodrigues(side=lambda T, R: R @ T))
wrong("5.7", "rotates by half of the angle")(rodrigues(angle=lambda rate, dt: 0.5 * rate * dt))
wrong("5.7", "forgets the part along the axis")(rodrigues(along=0.0))
wrong("5.7", "divides by zero at rest")(rodrigues(rest=False))
wrong("5.7", "omits dt")(rodrigues(angle=lambda rate, dt: rate))
edit("5.7", "changes its input", "turned = float_copy(R)", "turned = R")
edit("5.7", "returns its input at rest", "turned = float_copy(R)", "turned = float_copy(R) if omega.any() else R")
edit("5.7", "takes a turn below 1e-3 rad for none", "rate != 0.0", "rate * abs(dt) > 1e-3")
edit("5.7", "takes a turn below 1e-6 rad for none", "rate != 0.0", "rate * abs(dt) > 1e-6")
edit("5.7", "takes 1 for cos θ and θ for sin θ in a small turn", "c, s = np.cos(rate * dt), np.sin(rate * dt)",
     "c, s = (np.cos(rate * dt), np.sin(rate * dt)) if abs(rate * dt) > 1e-2 else (1.0, rate * dt)")
SLOW_IS_AT_REST = edit("5.7", "treats a milliradian per second as rest", "rate != 0.0", "rate > 1e-3")
edit("5.7", "drops the sign of the sine", "np.sin(rate * dt)", "np.sqrt(1.0 - np.cos(rate * dt) ** 2)")
edit("5.7", "limits the angle to half a turn", "np.cos(rate * dt), np.sin(rate * dt)",
     "np.cos(min(rate * dt, np.pi)), np.sin(min(rate * dt, np.pi))")
edit("5.7", "limits the angle to one turn", "np.cos(rate * dt), np.sin(rate * dt)",
     "np.cos(min(rate * dt, 2.0 * np.pi)), np.sin(min(rate * dt, 2.0 * np.pi))")
edit("5.7", "rotates the rows, not the columns", "r = R[:, k].copy()", "r = R[k].copy()")
edit("5.7", "stores the turned columns as rows", "turned[:, k] =", "turned[k] =")
edit("5.7", "exchanges sine and cosine",
     "c, s = np.cos(rate * dt), np.sin(rate * dt)", "s, c = np.cos(rate * dt), np.sin(rate * dt)")
edit("5.7", "does not normalise the axis", "n = omega / rate", "n = omega")
edit("5.7", "adds 1 + cos θ along the axis", "1.0 - c", "1.0 + c")
edit("5.7", "forgets the factor 1 − cos θ", "(1.0 - c) * dot(n, r)", "dot(n, r)")
edit("5.7", "has cos θ in place of 1 − cos θ", "(1.0 - c)", "c")
edit("5.7", "takes the part along r in place of n", "dot(n, r) * n", "dot(n, r) * r")
edit("5.7", "converts the angle to degrees",
     "np.cos(rate * dt), np.sin(rate * dt)", "np.cos(np.degrees(rate * dt)), np.sin(np.degrees(rate * dt))")
edit("5.7", "rotates the rows, not the columns", "return turned", "return R @ R @ turned.T")      # R Qᵀ = R R (Q R)ᵀ
edit("5.7", "takes a body for one at rest where any component of ω is 0", "rate != 0.0", "omega.all()")


# 5.8 ------------------------------------------------------------------------------------------------------------
@variants
def hamilton(dot=-1.0, twist=1.0, mixed=(1.0, 1.0), scalar=0, close=lambda c: c):
    """Scalar and vector parts, with signs and positions that may be wrong."""
    def quaternion_product(a, b):
        a, b = np.roll(a, -scalar), np.roll(b, -scalar)
        vector = mixed[0] * a[0] * b[1:] + mixed[1] * b[0] * a[1:] + twist * np.cross(a[1:], b[1:])
        return close(np.roll(np.concatenate(([a[0] * b[0] + dot * a[1:] @ b[1:]], vector)), scalar))
    return quaternion_product


right("5.8", "scalar and vector parts")(hamilton())
wrong("5.8", "multiplies in the wrong order, b before a")(hamilton(twist=-1.0))
wrong("5.8", "omits the cross product")(hamilton(twist=0.0))
wrong("5.8", "adds the dot product in the scalar part, where it is subtracted")(hamilton(dot=1.0))
wrong("5.8", "forgets a scalar")(hamilton(mixed=(1.0, 0.0)))
wrong("5.8", "puts the scalar part last")(hamilton(scalar=3))
wrong("5.8", "changes the sign of a product with a negative scalar part")(
    hamilton(close=lambda c: c if c[0] >= 0.0 else -c))


edit("5.8", "multiplies component by component", "return np", "return a * b\n    return np")
edit("5.8", "has a wrong sign in the x component", "a[2] * b[3] - a[3] * b[2]", "a[3] * b[2] - a[2] * b[3]")
edit("5.8", "has a wrong sign in the y component",
     "a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1]", "a[0] * b[2] + a[1] * b[3] + a[2] * b[0] - a[3] * b[1]")
edit("5.8", "has a wrong sign in the z component", "a[1] * b[2] - a[2] * b[1]", "a[2] * b[1] - a[1] * b[2]")
edit("5.8", "omits the product of the vectors in the scalar part",
     "a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3]", "a[0] * b[0]")
edit("5.8", "returns the product with a conjugated",
     "return np", "a = np.array([a[0], -a[1], -a[2], -a[3]]); return np")
edit("5.8", "returns the product with b conjugated",
     "return np", "b = np.array([b[0], -b[1], -b[2], -b[3]]); return np")
edit("5.8", "returns b where a has no vector part, as if its scalar part were 1",
     "return np", "if not a[1:].any(): return b.copy()\n    return np")
edit("5.8", "takes components below 1e-6 for zero", "return np",
     "a = np.where(np.abs(a) < 1e-6, 0.0, a); return np")


# 5.9 ------------------------------------------------------------------------------------------------------------
@right("5.9", "1 + 2w 𝐪* + 2 𝐪*²")
def rotation_matrix(q):
    K = worked.skew(q[1:])
    return np.eye(3) + 2.0 * q[0] * K + 2.0 * K @ K


edit("5.9", "returns the transpose, which rotates from world to body", "w, x, y, z = q[0]", "w, x, y, z = -q[0]")
edit("5.9", "reads the scalar part as the last component", "q[0], q[1], q[2], q[3]", "q[3], q[0], q[1], q[2]")
edit("5.9", "forgets a factor 2 beside w", "w, x, y, z = q[0]", "w, x, y, z = 0.5 * q[0]")
edit("5.9", "adds w² to a diagonal entry that already contains it", "1.0 - 2.0 * (y * y + z * z)",
     "w * w + 1.0 - 2.0 * (y * y + z * z)")
edit("5.9", "has a wrong sign beside w in the first row: 2(xy + wz)", "2.0 * (x * y - w * z)", "2.0 * (x * y + w * z)")
edit("5.9", "has a wrong sign beside w in the first row: 2(xz − wy)", "2.0 * (x * z + w * y)", "2.0 * (x * z - w * y)")
edit("5.9", "has a wrong sign beside w in the second row: 2(yz + wx)",
     "2.0 * (y * z - w * x)]", "2.0 * (y * z + w * x)]")
edit("5.9", "adds the squares on the diagonal", "[[1.0 - 2.0", "[[1.0 + 2.0")
edit("5.9", "forgets the factor 2 on the diagonal", "1.0 - 2.0 * (y * y + z * z)", "1.0 - (y * y + z * z)")
edit("5.9", "uses the component's own square on the diagonal",
     "1.0 - 2.0 * (y * y + z * z)", "1.0 - 2.0 * (x * x + z * z)")
edit("5.9", "takes half a turn, where w = 0, for no rotation",
     "w, x, y, z = q[0]", "q = q if q[0] != 0.0 else np.eye(4)[0]; w, x, y, z = q[0]")
edit("5.9", "takes a turn below 1e-6 rad for none", "w, x, y, z =",
     "q = q if norm(q[1:]) > 1e-6 else np.eye(4)[0]; w, x, y, z =")
edit("5.9", "takes components below 1e-6 for zero", "w, x, y, z =",
     "q = np.where(np.abs(q) < 1e-6, 0.0, q); w, x, y, z =")


# 5.10 -----------------------------------------------------------------------------------------------------------
@variants
def third_way(half=0.5, sign=1.0, left=True, close=worked.unit):
    """q + ½dt (0, ω) q, normalised, with parts that may be wrong."""
    def quaternion_update(q, omega, dt):
        spin = np.concatenate(([0.0], omega))
        first, second = (spin, q) if left else (q, spin)
        return close(q + sign * half * dt * worked.quaternion_product(first, second))
    return quaternion_update


@right("5.10", "as one product: (1, ½dt ω) q")
def quaternion_update(q, omega, dt):
    return worked.unit(worked.quaternion_product(np.concatenate(([1.0], 0.5 * dt * omega)), q))


wrong("5.10", "omits the factor ½")(third_way(half=1.0))
wrong("5.10", "multiplies by ω from the right, as if ω were in body coordinates")(third_way(left=False))
wrong("5.10", "turns the other way")(third_way(sign=-1.0))
wrong("5.10", "does not normalise")(third_way(close=lambda q: q))
wrong("5.10", "divides by the squared length")(third_way(close=lambda q: q / (q @ q)))
wrong("5.10", "divides zero by zero")(third_way(close=lambda q: q / np.linalg.norm(q)))
edit("5.10", "changes its input",
     "q + 0.5 * dt * quaternion_product(spin, q)", "np.add(q, 0.5 * dt * quaternion_product(spin, q), out=q)")
SIGN_OF_DT_IGNORED = edit("5.10", "ignores the sign of dt", "0.5 * dt", "0.5 * abs(dt)")
edit("5.10", "forgets dt", "0.5 * dt * q", "0.5 * q")
edit("5.10", "returns the change, not the new orientation", "unit(q + 0.5", "unit(0.5")
edit("5.10", "puts ω into the first three components",
     "[0.0, omega[0], omega[1], omega[2]]", "[omega[0], omega[1], omega[2], 0.0]")
edit("5.10", "normalises the turn, not its result",
     "unit(q + 0.5 * dt * quaternion_product(spin, q))", "q + unit(0.5 * dt * quaternion_product(spin, q))")
edit("5.10", "takes a body for one at rest where any component of ω is 0",
     "return unit", "return q.copy() if not omega.all() else unit")
edit("5.10", "takes a turn below 1e-6 rad for none", "0.5 * dt *", "0.5 * dt * (norm(omega * dt) > 1e-6) *")
edit("5.10", "does not normalise q where ω = 0", "return unit",
     "if q.any() and not omega.any(): return q.copy()\n    return unit")
edit("5.10", "returns q = 0 where ω = 0, too", "return unit",
     "if not (q.any() or omega.any()): return q.copy()\n    return unit")
edit("5.10", "turns by the exact angle where it is small", "return unit",
     "if norm(omega * dt) < 0.05: return quaternion_product(exponential(dt * omega), unit(q))\n    return unit")
edit("5.10", "takes a step of at most a second", "spin = np", "dt = min(dt, 1.0); spin = np")


# 5.11 -----------------------------------------------------------------------------------------------------------
@variants
def euler_equations(gyro=-1.0, inverse=True, push=worked.unrotate, back=worked.rotate, momentum=lambda I, w: I * w):
    """ω̇ with terms and frames that may be wrong."""
    def angular_acceleration(q, omega, tau, I_body):
        w = worked.unrotate(q, omega)
        total = push(q, tau) + gyro * np.cross(w, momentum(I_body, w))
        return back(q, total / I_body if inverse else total)
    return angular_acceleration


wrong("5.11", "omits the gyroscopic term, so that nothing tumbles")(euler_equations(gyro=0.0))
wrong("5.11", "adds the gyroscopic term in place of subtracting it")(euler_equations(gyro=1.0))
wrong("5.11", "forgets I⁻¹")(euler_equations(inverse=False))
wrong("5.11", "uses the world's torque in body axes without rotating it")(euler_equations(push=lambda q, tau: tau))
wrong("5.11", "returns the result in body coordinates")(euler_equations(back=lambda q, a: a))
wrong("5.11", "takes ω × ω, which is zero, in place of ω × Iω")(euler_equations(momentum=lambda I, w: w))


@right("5.11", "with the inertia of the world")
def angular_acceleration(q, omega, tau, I_body):
    R = worked.rotation_matrix(q)
    I = R @ np.diag(I_body) @ R.T
    return np.linalg.solve(I, tau - np.cross(omega, I @ omega))


edit("5.11", "uses the moments of the body with vectors in world axes", "omega_body = unrotate(q, omega)",
     "return (tau - cross(omega, I_body * omega)) / I_body")
edit("5.11", "ignores small torques", "unrotate(q, tau)", "unrotate(q, tau) * (np.sum(tau * tau) > 1e-12)")
edit("5.11", "uses ω of the world in the gyroscopic term", "omega_body = unrotate(q, omega)", "omega_body = omega")
edit("5.11", "forgets the torque", "(unrotate(q, tau) - cross", "(0.0 * tau - cross")
edit("5.11", "divides ω by the moments in the gyroscopic term", "I_body * omega_body", "omega_body / I_body")
edit("5.11", "exchanges rotate and unrotate for the torque", "unrotate(q, tau)", "rotate(q, tau)")
edit("5.11", "exchanges rotate and unrotate at the end", "return rotate", "return unrotate")
edit("5.11", "divides only the torque by the moments",
     "(unrotate(q, tau) - cross(omega_body, I_body * omega_body)) / I_body",
     "unrotate(q, tau) / I_body - cross(omega_body, I_body * omega_body)")
edit("5.11", "exchanges rotate and unrotate for ω", "unrotate(q, omega)", "rotate(q, omega)")
edit("5.11", "takes ω to stay as it is where no torque acts", "return rotate(q,", "return tau.any() * rotate(q,")
edit("5.11", "takes a body with two equal moments for a ball",
     "I_body * omega_body", "I_body * omega_body * (I_body[0] != I_body[1])")
edit("5.11", "keeps a body at rest that a torque acts on", "unrotate(q, tau)", "omega.any() * unrotate(q, tau)")
edit("5.11", "takes moments of at least 1e-3 kg m²", "/ I_body)", "/ np.maximum(I_body, 1e-3))")
edit("5.11", "takes a body with nearly equal moments for a ball", "I_body * omega_body",
     "I_body * omega_body * (np.ptp(I_body) > 1e-2 * I_body[0])")


# 5.12 -----------------------------------------------------------------------------------------------------------
@variants
def loop(late=0.0, old_v=False, old_omega=False, gyro=True, mass=True, turned=worked.quaternion_update, first=False):
    """The loop of the second lecture deck with an order that may be wrong."""
    def rigid_body_step(load, t, x, q, v, omega, dt, body):
        F, tau = load(t + late * dt, x + (dt * v if first else 0.0), q, v, omega, body)
        if not gyro:
            tau = tau + np.cross(omega, worked.body_angular_momentum(q, omega, body.I_body))
        v_new = v + dt * F / (body.m if mass else 1.0)
        omega_new = omega + dt * worked.angular_acceleration(q, omega, tau, body.I_body)
        return x + dt * (v if old_v else v_new), turned(q, omega if old_omega else omega_new, dt), v_new, omega_new
    return rigid_body_step


right("5.12", "with a name for everything")(loop())
wrong("5.12", "moves with the old velocity")(loop(old_v=True))
wrong("5.12", "rotates with the old ω")(loop(old_omega=True))
wrong("5.12", "takes the load at time t + dt")(loop(late=1.0))
wrong("5.12", "takes the load at the new position")(loop(first=True))
wrong("5.12", "omits the gyroscopic term")(loop(gyro=False))
wrong("5.12", "forgets the mass")(loop(mass=False))
wrong("5.12", "forgets to normalise q")(loop(turned=third_way(close=lambda q: q)))
edit("5.12", "changes its input", "v = v + dt / body.m * F", "v += dt / body.m * F")
edit("5.12", "uses a mass of at least 1 kg", "dt / body.m", "dt / max(body.m, 1.0)")
edit("5.12", "uses a mass of at most 1 kg", "dt / body.m", "dt / min(body.m, 1.0)")
edit("5.12", "multiplies by the mass", "dt / body.m * F", "dt * body.m * F")
edit("5.12", "forgets dt beside the angular acceleration", "omega + dt * angular", "omega + angular")
edit("5.12", "forgets dt beside the force", "dt / body.m * F", "1.0 / body.m * F")
edit("5.12", "exchanges force and torque", "F, tau = load", "tau, F = load")
edit("5.12", "subtracts the force", "v = v + dt", "v = v - dt")
edit("5.12", "returns ω before v",
     "quaternion_update(q, omega, dt), v, omega", "quaternion_update(q, omega, dt), omega, v")
edit("5.12", "moves with the mean of the old and the new velocity",
     "v = v + dt / body.m * F", "v = v + dt / body.m * F; x = x - 0.5 * dt * dt / body.m * F")
edit("5.12", "does not rotate the body", "quaternion_update(q, omega, dt), v", "q, v")
edit("5.12", "does not move the body", "return x + dt * v,", "return x,")
edit("5.12", "returns the state unchanged where nothing moves yet",
     "F, tau = load", "if not (v.any() or omega.any()): return x, q, v, omega\n    F, tau = load")
edit("5.12", "takes a step of at most a second", "F, tau = load", "dt = min(dt, 1.0); F, tau = load")
edit("5.12", "does not move a body that is slower than 1 mm/s", "return x + dt * v,",
     "return x + dt * (norm(v) > 1e-3) * v,")
edit("5.12", "does not rotate a body that turns more slowly than 1 mrad/s", "quaternion_update(q, omega, dt)",
     "quaternion_update(q, (norm(omega) > 1e-3) * omega, dt)")
edit("5.12", "uses a mass of at least 1 g", "dt / body.m", "dt / max(body.m, 1e-3)")
edit("5.12", "uses a mass of at most 1 t", "dt / body.m", "dt / min(body.m, 1e3)")
edit("5.12", "uses moments of at least 1e-3 kg m²", "tau, body.I_body", "tau, np.maximum(body.I_body, 1e-3)")
edit("5.12", "gives the load a record of its own, without the other fields", "load(t, x, q, v, omega, body)",
     "load(t, x, q, v, omega, RigidBody(body.m, body.I_body))")


# 5.13 -----------------------------------------------------------------------------------------------------------
@right("5.13", "half of ω·L")
def kinetic_energy(q, L, I_body):
    return 0.5 * worked.angular_velocity(worked.rotation_matrix(q), L, I_body) @ L


WORLD_COMPONENTS = edit("5.13", "divides L in world axes by the moments of the body axes", "unrotate(q, L)", "L")
edit("5.13", "omits the factor ½", "0.5 * np.sum", "np.sum")
edit("5.13", "takes L for ω", "L_body * L_body / I_body", "L_body * L_body * I_body")
edit("5.13", "turns L the wrong way", "unrotate(q, L)", "rotate(q, L)")
edit("5.13", "forgets the square of L", "L_body * L_body / I_body", "L_body / I_body")
edit("5.13", "divides by the squares of the moments", "L_body * L_body / I_body", "(L_body / I_body)**2")
edit("5.13", "divides by |L|, which is 0 for a body at rest", "L_body * L_body / I_body",
     "(L_body / norm(L)) ** 2 * dot(L, L) / I_body")
edit("5.13", "takes moments of at least 1e-3 kg m²", "/ I_body", "/ np.maximum(I_body, 1e-3)")
edit("5.13", "takes an L below 1e-6 kg m²/s for none", "L_body = unrotate",
     "L = np.where(np.abs(L) < 1e-6, 0.0, L); L_body = unrotate")


# 5.14 -----------------------------------------------------------------------------------------------------------
@variants
def racket(sign=1.0, below=lambda I, i, j: I[i] * I[j], spin_of=abs, root=lambda s: np.sqrt(max(0.0, s))):
    """The rate with parts that may be wrong."""
    def tumbling_rate(I_body, k, spin):
        i, j = (k + 1) % 3, (k + 2) % 3
        return spin_of(spin) * root(sign * (I_body[k] - I_body[i]) * (I_body[j] - I_body[k]) / below(I_body, i, j))
    return tumbling_rate


@right("5.14", "by the eigenvalues of the linear equations")
def tumbling_rate(I_body, k, spin):
    i, j = (k + 1) % 3, (k + 2) % 3
    matrix = np.array([[0.0, (I_body[j] - I_body[k]) / I_body[i]], [(I_body[k] - I_body[i]) / I_body[j], 0.0]])
    return max(0.0, np.max(np.linalg.eigvals(spin * matrix).real))


wrong("5.14", "reverses a sign, so that the outer axes tumble")(racket(sign=-1.0))
wrong("5.14", "returns a positive rate for every axis")(racket(root=lambda s: np.sqrt(abs(s))))
wrong("5.14", "omits the square root")(racket(root=lambda s: max(0.0, s)))
wrong("5.14", "divides by the squared moment of the axis itself")(
    racket(below=lambda I, i, j: (I.sum() - I[i] - I[j]) ** 2))
wrong("5.14", "returns a negative rate for a negative spin")(racket(spin_of=lambda spin: spin))
edit("5.14", "forgets the spin", "return abs(spin) * np.sqrt", "return np.sqrt")
edit("5.14", "squares the spin, as in the square of the rate", "abs(spin)", "spin**2")
edit("5.14", "does not divide by any moments", "/ (I_body[i] * I_body[j])", "/ 1.0")
edit("5.14", "divides by one moment only", "(I_body[i] * I_body[j])", "I_body[i]")
edit("5.14", "returns NaN where the rotation is stable", "np.sqrt(np.maximum(0.0, squared))", "np.sqrt(squared)")
edit("5.14", "takes the root of the spin, too", "abs(spin)", "np.sqrt(abs(spin))")
edit("5.14", "uses the difference of the other two moments",
     "(I_body[k] - I_body[i]) * (I_body[j] - I_body[k])", "(I_body[j] - I_body[i])**2")
edit("5.14", "counts the axes from 1", "i, j =", "k = k - 1; i, j =")
edit("5.14", "takes the sizes of both differences",
     "(I_body[k] - I_body[i]) * (I_body[j] - I_body[k])", "abs(I_body[k] - I_body[i]) * (I_body[j] - I_body[k])")
edit("5.14", "divides by the spin, which may be 0", "abs(spin)", "spin / abs(spin) * spin")
edit("5.14", "takes nearly equal moments for equal ones", "return abs",
     "squared = squared * (abs(squared) > 1e-4); return abs")
edit("5.14", "takes moments of at least 1e-3 kg m²", "i, j = (k", "I_body = np.maximum(I_body, 1e-3); i, j = (k")
edit("5.14", "takes a spin below 1e-3 rad/s for none", "abs(spin)", "abs(spin) * (abs(spin) > 1e-3)")
edit("5.14", "never divides by zero", "(I_body[i] * I_body[j])", "(I_body[i] * I_body[j] + 1e-9)")


# 5.15 -----------------------------------------------------------------------------------------------------------
@right("5.15", "as a cross product with the weight")
def heavy_top_torque(t, q, L, top):
    return np.cross(worked.rotation_matrix(q)[:, 2], [0.0, 0.0, -top.mgl])


TORQUE_REVERSED = edit("5.15", "reverses the torque, which lifts the tip", "[-e[1], e[0], 0.0]", "[e[1], -e[0], 0.0]")
edit("5.15", "forgets the weight", "top.mgl * np", "np")
edit("5.15", "returns the torque in body coordinates", "top.mgl * np.array([-e[1], e[0], 0.0])",
     "unrotate(q, top.mgl * np.array([-e[1], e[0], 0.0]))")
edit("5.15", "rotates the axis from world to body", "rotate(q, np", "unrotate(q, np")
edit("5.15", "reverses the torque for a top that hangs", "top.mgl * np", "np.sign(e[2]) * top.mgl * np")
edit("5.15", "exchanges two components of the torque", "[-e[1], e[0], 0.0]", "[e[0], -e[1], 0.0]")
edit("5.15", "loses the sign of one component of the torque", "[-e[1], e[0], 0.0]", "[e[1], e[0], 0.0]")
edit("5.15", "takes the weight for the torque", "[-e[1], e[0], 0.0]", "[0.0, 0.0, -1.0]")
edit("5.15", "returns the torque about the top's own axis", "[-e[1], e[0], 0.0]", "[e[0], e[1], e[2]]")
edit("5.15", "takes L for the axis", "rotate(q, np.array([0.0, 0.0, 1.0]))", "L / np.sqrt(L @ L)")
edit("5.15", "takes the x axis of the body for the axis of the top", "[0.0, 0.0, 1.0]", "[1.0, 0.0, 0.0]")
edit("5.15", "takes a top that does not turn for one without weight", "top.mgl * np", "L.any() * top.mgl * np")
edit("5.15", "takes a nearly vertical axis for a vertical one", "return top",
     "e = np.where(np.abs(e) < 1e-6, 0.0, e); return top")
edit("5.15", "takes a weight below 1e-6 N m for none", "return top.mgl", "return (top.mgl * (top.mgl > 1e-6))")


# 5.16 -----------------------------------------------------------------------------------------------------------
@variants
def midpoint(gyro=1.0, newton=True, enough=lambda n, change, m: change <= 1e-12 * np.max(np.abs(m)), at=lambda m,
             start: m,
             close=lambda q, w, dt: worked.unit(worked.quaternion_product(q, np.concatenate(([1.0], 0.5 * dt * w))))):
    """Newton's method by NumPy's solver, with parts that may be wrong."""
    def midpoint_free_rotation(q, L, I_body, dt):
        start, half = worked.unrotate(q, L), 0.5 * dt * gyro
        m = start.copy()
        for n in range(worked.NEWTON_LIMIT):
            r = m - start - half * np.cross(m, m / I_body)
            slope = [e + half * np.cross(m / I_body - m / I, e) for e, I in zip(np.eye(3), I_body, strict=True)]
            delta = np.linalg.solve(np.stack(slope, axis=1), r) if newton else r
            m = m - delta
            if enough(n, np.max(np.abs(delta)), m):
                return close(q, at(m, start) / I_body, dt)
        raise Diverged("the equation did not settle at dt [s]", dt, "take a smaller step")
    return midpoint_free_rotation


right("5.16", "by NumPy's solver")(midpoint())
wrong("5.16", "iterates without Newton's method")(midpoint(newton=False))
wrong("5.16", "compares the change with an absolute tolerance")(midpoint(enough=lambda n, change, m: change <= 1e-12))
wrong("5.16", "iterates only once")(midpoint(enough=lambda n, change, m: True))
wrong("5.16", "stops after two corrections")(midpoint(enough=lambda n, change, m: n == 1))
wrong("5.16", "reverses the gyroscopic term")(midpoint(gyro=-1.0))
wrong("5.16", "rotates with ω at the beginning of the step")(midpoint(at=lambda m, start: start))
wrong("5.16", "rotates with ω at the end of the step")(midpoint(at=lambda m, start: 2.0 * m - start))
wrong("5.16", "multiplies the rotation from the left, as if ω were in world coordinates")(
    midpoint(close=lambda q, w, dt: worked.unit(worked.quaternion_product(np.concatenate(([1.0], 0.5 * dt * w)), q))))
wrong("5.16", "omits the factor ½ in the rotation")(
    midpoint(close=lambda q, w, dt: worked.unit(worked.quaternion_product(q, np.concatenate(([1.0], dt * w))))))
wrong("5.16", "rotates by the whole angle |w| dt, which belongs to another rule")(
    midpoint(close=lambda q, w, dt: worked.unit(worked.quaternion_product(q, worked.exponential(dt * w)))))
wrong("5.16", "does not normalise the quaternion")(
    midpoint(close=lambda q, w, dt: worked.quaternion_product(q, np.concatenate(([1.0], 0.5 * dt * w)))))
wrong("5.16", "normalises the turn, not its result")(
    midpoint(close=lambda q, w, dt: worked.quaternion_product(q, worked.unit(np.concatenate(([1.0], 0.5 * dt * w))))))
wrong("5.16", "fails for a body at rest")(midpoint(enough=lambda n, change, m: change < 1e-12 * np.max(np.abs(m))))
edit("5.16", "never raises: rotates by the last iterate",
     'raise Diverged("Newton\'s method did not converge at dt [s]", dt, "take a smaller step")',
     "return unit(quaternion_product(q, np.array([1.0, 0.5 * dt * w[0], 0.5 * dt * w[1], 0.5 * dt * w[2]])))")
edit("5.16", "gives up after five corrections", "range(NEWTON_LIMIT)", "range(5)")
edit("5.16", "gives up after ten corrections", "range(NEWTON_LIMIT)", "range(10)")
edit("5.16", "adds the correction δ in place of subtracting it", "m = m - delta", "m = m + delta")
edit("5.16", "takes a whole step to the middle", "- 0.5 * dt * cross(m, w)", "- dt * cross(m, w)")
edit("5.16", "takes w × m in place of m × w", "cross(m, w)", "cross(w, m)")
edit("5.16", "starts from L of the world", "start = unrotate(q, L)", "start = L.copy()")
edit("5.16", "takes the rotation of half a step",
     "[1.0, 0.5 * dt * w[0], 0.5 * dt * w[1], 0.5 * dt * w[2]]",
     "[1.0, 0.25 * dt * w[0], 0.25 * dt * w[1], 0.25 * dt * w[2]]")
edit("5.16", "omits the old value in the residual", "r = m - start", "r = m")
edit("5.16", "rotates with the angular momentum m in place of w",
     "[1.0, 0.5 * dt * w[0], 0.5 * dt * w[1], 0.5 * dt * w[2]]",
     "[1.0, 0.5 * dt * m[0], 0.5 * dt * m[1], 0.5 * dt * m[2]]")
edit("5.16", "takes a body for one at rest where any component of its ℓ is 0",
     "one = np.eye(3)", "if not start.all(): return q.copy()\n    one = np.eye(3)")
edit("5.16", "ignores the sign of dt", "one = np.eye(3)", "one, dt = np.eye(3), abs(dt)")
edit("5.16", "takes a turn below 1e-6 rad for none", "one = np.eye(3)",
     "one, dt = np.eye(3), dt * (norm(dt * start / I_body) > 1e-6)")
edit("5.16", "gives the number of corrections in the error, in place of dt", '[s]", dt,', '[s]", NEWTON_LIMIT,')


# 5.17 -----------------------------------------------------------------------------------------------------------
@variants
def splitting(order="aca", middle=worked.intermediate_axis, fresh=True, whole=1.0, left=True, sign=1.0,
              close=worked.unit, slow=lambda I, k, b: 1.0 / I[k] - 1.0 / I[b]):
    """A sequence of exact turns about body axes, half a turn if an axis occurs twice, with parts that may be wrong."""
    def splitting_free_rotation(q, L, I_body, dt):
        b = middle(I_body)
        axis = {"a": (b + 1) % 3, "c": (b + 2) % 3}
        turned, ell = q, worked.unrotate(q, L)
        for name in order:
            k = axis[name]
            if fresh:
                ell = worked.unrotate(turned, L)
            angle = sign * dt / order.count(name) * slow(I_body, k, b) * ell[k]
            turned = worked.quaternion_product(turned, worked.exponential(angle * np.eye(3)[k]))
        about = worked.exponential(whole * dt / I_body[b] * L)
        return close(worked.quaternion_product(about, turned) if left else worked.quaternion_product(turned, about))
    return splitting_free_rotation


right("5.17", "half of c, all of a, half of c")(splitting("cac"))
wrong("5.17", "rotates about a, then c: a first-order splitting")(splitting("ac"))
wrong("5.17", "uses L in the body's axes as it was at the beginning of the step")(splitting(fresh=False))
wrong("5.17", "omits the rotation about L")(splitting(whole=0.0))
wrong("5.17", "rotates about L of the world as if it were in body coordinates")(splitting(left=False))
wrong("5.17", "rotates about the body's axes the other way")(splitting(sign=-1.0))
wrong("5.17", "omits the subtraction of 1/I_b")(splitting(slow=lambda I, k, b: 1.0 / I[k]))
wrong("5.17", "uses differences of the moments, not of their inverses")(
    splitting(slow=lambda I, k, b: 1.0 / (I[k] - I[b]) if I[k] != I[b] else 0.0))
wrong("5.17", "always takes the first axis for the middle one")(splitting(middle=lambda I: 0))
edit("5.17", "takes the axis of the largest moment for the middle one",
     "intermediate_axis(I_body)", "int(np.argmax(I_body))")
edit("5.17", "takes the axis of the smallest moment for the middle one",
     "intermediate_axis(I_body)", "int(np.argmin(I_body))")
edit("5.17", "does not normalise at the end", "unit(quaternion_product(exponential(dt / I_body[b] * L), turned))",
     "quaternion_product(exponential(dt / I_body[b] * L), turned)")
edit("5.17", "rotates about the outer axis by the whole angle twice",
     "dt * (1.0 / I_body[a] - 1.0 / I_body[b]), dt * (1.0",
     "2.0 * dt * (1.0 / I_body[a] - 1.0 / I_body[b]), 2.0 * dt * (1.0")
edit("5.17", "omits the last half rotation about a",
     "turned = about_axis(turned, a, 0.5 * slow_a * body_component(turned, L, a))", "pass")
edit("5.17", "forgets the moment in the rotation about L", "exponential(dt / I_body[b] * L)", "exponential(dt * L)")
edit("5.17", "rotates about L the other way", "exponential(dt / I_body[b] * L)", "exponential(-dt / I_body[b] * L)")
edit("5.17", "rotates about c by half of the angle", "c, slow_c * body", "c, 0.5 * slow_c * body")
edit("5.17", "forgets the component of L in the angle about c", "slow_c * body_component(turned, L, c)", "slow_c")
edit("5.17", "divides by |L|, which is 0 for a body at rest",
     "exponential(dt / I_body[b] * L)", "exponential(dt / I_body[b] * norm(L) * (L / norm(L)))")
edit("5.17", "takes components of L below 1e-6 kg m²/s for zero", "b = intermediate",
     "L = np.where(np.abs(L) < 1e-6, 0.0, L); b = intermediate")
edit("5.17", "takes moments of at least 1e-3 kg m²", "b = intermediate",
     "I_body = np.maximum(I_body, 1e-3); b = intermediate")
edit("5.17", "takes nearly equal moments for equal ones", "turned = about_axis(q,",
     "slow_a = slow_a * (abs(slow_a) > 1e-4); turned = about_axis(q,")


# 5.18 -----------------------------------------------------------------------------------------------------------
G, G3 = worked.SUZUKI, 1.0 / (2.0 - 2.0 ** (1.0 / 3.0))


@variants
def composed(shares=(G, G, 1.0 - 4.0 * G, G, G), clock=1.0):
    """Substeps with fractions of dt."""
    def compose(step, torque, t, q, L, dt, body):
        for share in shares:
            q, L = step(torque, t, q, L, share * dt, body)
            t = t + clock * share * dt
        return q, L
    return compose


right("5.18", "as a list of shares")(composed())
wrong("5.18", "takes five equal substeps")(composed([0.2] * 5))
wrong("5.18", "takes the third substep forwards")(composed([G, G, 4.0 * G - 1.0, G, G]))
wrong("5.18", "omits the third substep")(composed([G, G, G, G]))
wrong("5.18", "takes Yoshida's three substeps")(composed([G3, 1.0 - 2.0 * G3, G3]))
wrong("5.18", "takes the negative substep first")(composed([1.0 - 4.0 * G, G, G, G, G]))
wrong("5.18", "does not advance t")(composed(clock=0.0))
edit("5.18", "forgets dt in the time of each substep", "t = t + share * dt", "t = t + share")
edit("5.18", "advances the time by the whole step each time", "t = t + share * dt", "t = t + dt")
edit("5.18", "advances the time before the substep",
     "q, L = step(torque, t, q, L, share * dt, body)", "q, L = step(torque, t + share * dt, q, L, share * dt, body)")
edit("5.18", "takes 1 − 2γ in the middle", "1.0 - 4.0 * SUZUKI", "1.0 - 2.0 * SUZUKI")
edit("5.18", "takes the negative substep last", "(SUZUKI, SUZUKI, 1.0 - 4.0 * SUZUKI, SUZUKI, SUZUKI)",
     "(SUZUKI, SUZUKI, SUZUKI, SUZUKI, 1.0 - 4.0 * SUZUKI)")
edit("5.18", "leaves a body as it is where L = 0, also under a torque",
     "for share in", "if not L.any(): return q, L\n    for share in")
edit("5.18", "keeps the q of the beginning", "q, L = step(torque", "_, L = step(torque")


# 5.19 -----------------------------------------------------------------------------------------------------------
@right("5.19", "by small steps towards the root")
def precession_rate(I_body, mgl, tilt, spin):
    rate = 0.0
    for _ in range(2000):
        rate = mgl / (I_body[2] * spin - I_body[0] * rate * np.cos(tilt))
    return rate


@right("5.19", "by the usual formula for the roots, except where the axis is level")
def by_the_usual_formula(I_body, mgl, tilt, spin):
    along, across = I_body[2] * spin, 2.0 * I_body[0] * np.cos(tilt)
    if abs(across) < 1e-12 * I_body[0]:
        return mgl / along
    root = np.sqrt(along * along - 2.0 * across * mgl)
    return (along - np.copysign(root, along)) / across


SLOW = "2.0 * mgl / (along + np.copysign(root, along))"
edit("5.19", "takes the limit of a fast top, Mgl/(I₃ω₃)", SLOW, "mgl / along")
edit("5.19", "returns the other rate, at which the top goes round without its weight, too",
     SLOW, "(along + np.copysign(root, along)) / (2.0 * I_body[0] * np.cos(tilt))")
edit("5.19", "divides a difference of near numbers by the cosine, which is almost 0 where the axis is level", SLOW,
     "(along - np.copysign(root, along)) / (2.0 * I_body[0] * np.cos(tilt))")
edit("5.19", "ignores the sign of the spin", "np.copysign(root, along)", "root")
edit("5.19", "forgets that the axis is tilted", " * np.cos(tilt)", "")
edit("5.19", "takes the sine of the tilt", "np.cos", "np.sin")
edit("5.19", "takes the whole torque Mgl sin θ for L = I₃ω₃ along the vertical",
     "2.0 * mgl / (", "2.0 * mgl * np.sin(tilt) / (")
edit("5.19", "forgets the 2", "2.0 * mgl / (", "mgl / (")
edit("5.19", "exchanges the two moments", "along = I_body[2]", "I_body = I_body[::-1]; along = I_body[2]")
edit("5.19", "adds the weight under the root", "along * along - 4.0", "along * along + 4.0")
edit("5.19", "finds no rate where the top is too slow to stand upright", "root = np.sqrt",
     "root = np.nan if along * along < 4.0 * I_body[0] * mgl else np.sqrt")
edit("5.19", "takes the least spin for an upright top where it is slower", "along = I_body[2] * spin",
     "along = np.copysign(max(abs(I_body[2] * spin), np.sqrt(4.0 * I_body[0] * mgl)), spin)")
edit("5.19", "turns the other way", "return 2.0", "return -2.0")
edit("5.19", "loses the sign of the spin where the axis is level",
     SLOW, f"{SLOW} if abs(np.cos(tilt)) > 1e-9 else mgl / abs(along)")
edit("5.19", "takes moments of at least 1e-3 kg m²", "along = I_body[2]",
     "I_body = np.maximum(I_body, 1e-3); along = I_body[2]")
edit("5.19", "takes a weight below 1e-3 N m for none", "along = I_body[2]",
     "mgl = mgl * (mgl > 1e-3); along = I_body[2]")
edit("5.19", "takes the limit Mgl/(I₃ω₃) for a fast top", "return 2.0",
     "if 4.0 * I_body[0] * mgl < 1e-3 * along * along: return mgl / along\n    return 2.0")
edit("5.19", "takes a nearly vertical axis for a vertical one, which does not go round", "return 2.0",
     "return (np.sin(tilt) > 1e-3) * 2.0")
edit("5.19", "takes a nearly level axis for a level one", "np.cos(tilt)", "(np.cos(tilt) * (abs(np.cos(tilt)) > 1e-2))")


# 5.20 -----------------------------------------------------------------------------------------------------------
@right("5.20", "as a small letter")
def careful_throw_is():
    return "a"


edit("5.20", "takes the time to depend on the spin only", '"A"', '"D"')
edit("5.20", "takes ten times the care for ten times the time: growth by equal amounts", '"A"', '"C"')
edit("5.20", "takes a spin that is careful enough for one that never turns over", '"A"', '"B"')


# 5.21 -----------------------------------------------------------------------------------------------------------
@right("5.21", "a hammer, timed in a run")
def my_thrown_body(period):
    m, x = np.array([2.0, 1.0]), np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.3]])
    size = np.array([[0.1, 0.4, 0.1], [0.05, 0.05, 0.5]])
    return m, x, size, 13.03 / period * np.array([0.0, 1.0, 0.05])        # timed in a run


@right("5.21", "two slabs like stairs, with axes that are no edges")
def stairs(period):
    m, x = np.array([1.0, 1.0]), np.array([[0.0, 0.0, 0.0], [0.2, 0.3, 0.0]])
    size = np.array([[0.4, 0.3, 0.1], [0.4, 0.3, 0.1]])
    return m, x, size, np.array([5.359 / period, 0.0, 0.0])


OMEGA = "between_flips / period * np.array([0.0, 1.0, askew])"
edit("5.21", "has the same ω for each period", OMEGA, "between_flips * np.array([0.0, 1.0, askew])")
edit("5.21", "turns more slowly where it should turn faster", "between_flips / period", "between_flips * period")
edit("5.21", "counts a flip there and back as one", "np.pi / a", "2.0 * np.pi / a")
edit("5.21", "spins exactly about the middle axis, and never turns over", "[0.0, 1.0, askew]", "[0.0, 1.0, 0.0]")
edit("5.21", "spins about the axis of the largest moment", "[0.0, 1.0, askew]", "[0.0, askew, 1.0]")
edit("5.21", "spins about the axis of the smallest moment", "[0.0, 1.0, askew]", "[1.0, askew, 0.0]")
edit("5.21", "spins about a slanting axis, and wobbles", "[0.0, 1.0, askew]", "[0.0, 1.0, 1.0]")
edit("5.21", "is a single box", "return m, x, size,", "return m[:1], x[:1], size[:1],")
edit("5.21", "is two cubes, one inside the other, with three equal moments",
     "return m, x, size,", "return m, 0.0 * x, np.full((2, 3), 0.3),")
edit("5.21", "forgets that the centre of mass lies between the boxes", "(x - m @ x / np.sum(m))**2", "x**2")
edit("5.21", "forgets that the boxes are apart", "(x - m @ x / np.sum(m))**2 + size", "size")
edit("5.21", "does not spin", OMEGA, "np.zeros(3)")
edit("5.21", "has an edge of no length", "[0.1, 0.3, 0.1]]", "[0.1, 0.3, 0.0]]")
edit("5.12", "takes a step backwards for one forwards", "x + dt * v,", "x + abs(dt) * v,")
edit("5.18", "takes a step backwards for one forwards", "share * dt, body)", "share * abs(dt), body)")
