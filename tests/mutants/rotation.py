"""Lesson 5: signs, sides, frames and halves that go astray, and the other ways of writing a rotation."""

import numpy as np

from solutions import rotation as worked
from solutions.checks import Diverged
from . import collection, variants

wrong, right, edit, MUTANTS = collection(worked)


# 5.1 ------------------------------------------------------------------------------------------------------------
@wrong("5.1", "transposed: b × a")
def skew(a):
    return worked.skew(a).T


@wrong("5.1", "symmetric")
def skew(a):
    return np.abs(worked.skew(np.ones(3))) * worked.skew(np.abs(a)) * np.sign(worked.skew(np.ones(3)))


@wrong("5.1", "x and z exchanged")
def skew(a):
    return worked.skew(a[::-1])


@wrong("5.1", "outer product")
def skew(a):
    return np.outer(a, a)


@right("5.1", "as cross products with the axes")
def skew(a):
    return np.stack([np.cross(a, e) for e in np.eye(3)], axis=1)


# 5.2 ------------------------------------------------------------------------------------------------------------
@wrong("5.2", "r × ω")
def point_velocity(v, omega, r):
    return v + np.cross(r, omega)


@wrong("5.2", "forgets the centre of mass")
def point_velocity(v, omega, r):
    return np.cross(omega, r)


@wrong("5.2", "forgets the rotation")
def point_velocity(v, omega, r):
    return v


@right("5.2", "by the skew matrix")
def point_velocity(v, omega, r):
    return worked.skew(omega) @ r + v


# 5.3 ------------------------------------------------------------------------------------------------------------
@wrong("5.3", "torque about the origin")
def total_load(x, points, forces):
    return forces.sum(axis=0), np.cross(points, forces).sum(axis=0)


@wrong("5.3", "f × r")
def total_load(x, points, forces):
    return forces.sum(axis=0), np.cross(forces, points - x).sum(axis=0)


@wrong("5.3", "arm from the point to the centre")
def total_load(x, points, forces):
    return forces.sum(axis=0), np.cross(x - points, forces).sum(axis=0)


@wrong("5.3", "torque of the total force at the mean point")
def total_load(x, points, forces):
    F = forces.sum(axis=0)
    return F, np.cross(points.mean(axis=0) - x, F)


@wrong("5.3", "moves the points")
def total_load(x, points, forces):
    points -= x
    return forces.sum(axis=0), np.cross(points, forces).sum(axis=0)


@right("5.3", "all at once")
def total_load(x, points, forces):
    return np.sum(forces, axis=0), np.sum(np.cross(points, forces), axis=0) - np.cross(x, np.sum(forces, axis=0))


# 5.4 ------------------------------------------------------------------------------------------------------------
@wrong("5.4", "moments of the body, axes of the world")
def angular_velocity(R, L, I_body):
    return L / I_body


@wrong("5.4", "stays in the body")
def angular_velocity(R, L, I_body):
    return (R.T @ L) / I_body


@wrong("5.4", "multiplies by the inertia")
def angular_velocity(R, L, I_body):
    return R @ ((R.T @ L) * I_body)


@wrong("5.4", "R and its transpose exchanged")
def angular_velocity(R, L, I_body):
    return R.T @ ((R @ L) / I_body)


@right("5.4", "solves with the inertia of the world")
def angular_velocity(R, L, I_body):
    return np.linalg.solve(R @ np.diag(I_body) @ R.T, L)


# 5.5 ------------------------------------------------------------------------------------------------------------
@variants
def derivative(mass=lambda m: m, turn=lambda omega, R: worked.skew(omega) @ R, omega=worked.angular_velocity, torque=lambda tau, omega, L: tau):
    """Ṡ with parts that may be wrong."""
    def state_derivative(S, F, tau, body):
        w = omega(S.R, S.L, body.I_body)
        return worked.State(S.P / mass(body.m), turn(w, S.R), F, torque(tau, w, S.L))
    return state_derivative


right("5.5", "by columns")(derivative(turn=lambda omega, R: np.cross(omega, R.T).T))
wrong("5.5", "momentum for velocity")(derivative(mass=lambda m: 1.0))
wrong("5.5", "R ω*")(derivative(turn=lambda omega, R: R @ worked.skew(omega)))
wrong("5.5", "turns the other way")(derivative(turn=lambda omega, R: worked.skew(omega).T @ R))
wrong("5.5", "rows for columns")(derivative(turn=lambda omega, R: np.cross(omega, R)))
wrong("5.5", "L for ω")(derivative(omega=lambda R, L, I: L))
wrong("5.5", "a gyroscopic term in L̇")(derivative(torque=lambda tau, omega, L: tau - np.cross(omega, L)))


# 5.6 ------------------------------------------------------------------------------------------------------------
def renormalised(M):
    Q, upper = np.linalg.qr(M)
    return Q * np.sign(np.diag(upper))


@right("5.6", "by a QR factorisation")
def matrix_update(R, omega, dt):
    return renormalised(R + dt * np.cross(omega, R.T).T)


@wrong("5.6", "does not renormalise")
def matrix_update(R, omega, dt):
    return R + dt * worked.skew(omega) @ R


@wrong("5.6", "brings the columns to length 1 and leaves them oblique")
def matrix_update(R, omega, dt):
    M = R + dt * worked.skew(omega) @ R
    return M / np.sqrt(np.sum(M * M, axis=0))


@wrong("5.6", "the third column inside out")
def matrix_update(R, omega, dt):
    return worked.matrix_update(R, omega, dt) * [1.0, 1.0, -1.0]


@wrong("5.6", "ω of the body")
def matrix_update(R, omega, dt):
    return renormalised(R + dt * R @ worked.skew(omega))


@wrong("5.6", "forgets dt")
def matrix_update(R, omega, dt):
    return worked.matrix_update(R, omega, 1.0)


@wrong("5.6", "renormalises rows")
def matrix_update(R, omega, dt):
    return renormalised((R + dt * worked.skew(omega) @ R).T).T


@wrong("5.6", "changes its input")
def matrix_update(R, omega, dt):
    R += dt * worked.skew(omega) @ R
    return renormalised(R)


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
wrong("5.7", "on the side of the body")(rodrigues(side=lambda T, R: R @ T))
wrong("5.7", "half the angle")(rodrigues(angle=lambda rate, dt: 0.5 * rate * dt))
wrong("5.7", "forgets the part along the axis")(rodrigues(along=0.0))
wrong("5.7", "divides by zero at rest")(rodrigues(rest=False))
wrong("5.7", "turns only for a second")(rodrigues(angle=lambda rate, dt: rate))


@wrong("5.7", "changes its input")
def axis_angle_update(R, omega, dt):
    R[:] = worked.axis_angle_update(R, omega, dt)
    return R


# 5.8 ------------------------------------------------------------------------------------------------------------
@variants
def hamilton(dot=-1.0, twist=1.0, mixed=(1.0, 1.0)):
    """Scalar and vector parts, with signs that may be wrong."""
    def product(a, b):
        vector = mixed[0] * a[0] * b[1:] + mixed[1] * b[0] * a[1:] + twist * np.cross(a[1:], b[1:])
        return np.concatenate(([a[0] * b[0] + dot * a[1:] @ b[1:]], vector))
    return product


right("5.8", "scalar and vector parts")(hamilton())
wrong("5.8", "b first: a × b the other way")(hamilton(twist=-1.0))
wrong("5.8", "no cross product: they commute")(hamilton(twist=0.0))
wrong("5.8", "plus in the scalar")(hamilton(dot=1.0))
wrong("5.8", "forgets a scalar")(hamilton(mixed=(1.0, 0.0)))


@wrong("5.8", "turns what has a negative scalar round")
def product(a, b):
    c = worked.product(a, b)
    return c if c[0] >= 0.0 else -c


@wrong("5.8", "the scalar last")
def product(a, b):
    return np.roll(worked.product(np.roll(a, 1), np.roll(b, 1)), -1)


# 5.9 ------------------------------------------------------------------------------------------------------------
@right("5.9", "1 + 2w 𝐪* + 2 𝐪*²")
def rotation_matrix(q):
    K = worked.skew(q[1:])
    return np.eye(3) + 2.0 * q[0] * K + 2.0 * K @ K


@wrong("5.9", "from world to body")
def rotation_matrix(q):
    return worked.rotation_matrix(q).T


@wrong("5.9", "the scalar last")
def rotation_matrix(q):
    return worked.rotation_matrix(np.roll(q, 1))


@wrong("5.9", "forgets a factor 2 beside w")
def rotation_matrix(q):
    K = worked.skew(q[1:])
    return np.eye(3) + q[0] * K + 2.0 * K @ K


@wrong("5.9", "adds w² to a diagonal that has it already")
def rotation_matrix(q):
    return worked.rotation_matrix(q) + q[0] ** 2 * np.eye(3)


# 5.10 -----------------------------------------------------------------------------------------------------------
@variants
def third_way(half=0.5, sign=1.0, left=True, close=worked.unit):
    """q + ½dt (0, ω) q, normalised, with parts that may be wrong."""
    def quaternion_update(q, omega, dt):
        spin = np.concatenate(([0.0], omega))
        return close(q + sign * half * dt * (worked.product(spin, q) if left else worked.product(q, spin)))
    return quaternion_update


@right("5.10", "as one product: (1, ½dt ω) q")
def quaternion_update(q, omega, dt):
    return worked.unit(worked.product(np.concatenate(([1.0], 0.5 * dt * omega)), q))


wrong("5.10", "forgets the half")(third_way(half=1.0))
wrong("5.10", "ω on the right: of the body")(third_way(left=False))
wrong("5.10", "turns the other way")(third_way(sign=-1.0))
wrong("5.10", "does not normalise")(third_way(close=lambda q: q))
wrong("5.10", "divides by the squared length")(third_way(close=lambda q: q / (q @ q)))
wrong("5.10", "divides zero by zero")(third_way(close=lambda q: q / np.linalg.norm(q)))


@wrong("5.10", "changes its input")
def quaternion_update(q, omega, dt):
    q += 0.5 * dt * worked.product(np.concatenate(([0.0], omega)), q)
    return worked.unit(q)


# 5.11 -----------------------------------------------------------------------------------------------------------
@variants
def euler_equations(gyro=-1.0, inverse=True, push=worked.unrotate, back=worked.rotate, momentum=lambda I, w: I * w):
    """ω̇ with terms and frames that may be wrong."""
    def angular_acceleration(q, omega, tau, I_body):
        w = worked.unrotate(q, omega)
        total = push(q, tau) + gyro * np.cross(w, momentum(I_body, w))
        return back(q, total / I_body if inverse else total)
    return angular_acceleration


wrong("5.11", "no gyroscopic term: nothing tumbles")(euler_equations(gyro=0.0))
wrong("5.11", "the gyroscopic term with a plus")(euler_equations(gyro=1.0))
wrong("5.11", "forgets I⁻¹")(euler_equations(inverse=False))
wrong("5.11", "torque of the world in the body")(euler_equations(push=lambda q, tau: tau))
wrong("5.11", "stays in the body")(euler_equations(back=lambda q, a: a))
wrong("5.11", "ω × ω")(euler_equations(momentum=lambda I, w: w))


@wrong("5.11", "moments of the body, axes of the world")
def angular_acceleration(q, omega, tau, I_body):
    return (tau - np.cross(omega, I_body * omega)) / I_body


@right("5.11", "with the inertia of the world")
def angular_acceleration(q, omega, tau, I_body):
    R = worked.rotation_matrix(q)
    I = R @ np.diag(I_body) @ R.T
    return np.linalg.solve(I, tau - np.cross(omega, I @ omega))


# 5.12 -----------------------------------------------------------------------------------------------------------
@variants
def loop(late=0.0, old_v=False, old_omega=False, gyro=True, mass=True, turned=worked.quaternion_update, first=False):
    """Deck B's loop with an order of things that may be wrong."""
    def rigid_body_step(load, t, x, v, q, omega, dt, body):
        F, tau = load(t + late * dt, x + (dt * v if first else 0.0), v, q, omega, body)
        if not gyro:
            tau = tau + np.cross(omega, worked.angular_momentum(q, omega, body.I_body))
        v_new = v + dt * F / (body.m if mass else 1.0)
        omega_new = omega + dt * worked.angular_acceleration(q, omega, tau, body.I_body)
        return x + dt * (v if old_v else v_new), v_new, turned(q, omega if old_omega else omega_new, dt), omega_new
    return rigid_body_step


right("5.12", "with a name for everything")(loop())
wrong("5.12", "moves with the old velocity")(loop(old_v=True))
wrong("5.12", "turns with the old ω")(loop(old_omega=True))
wrong("5.12", "load at the end of the step")(loop(late=1.0))
wrong("5.12", "load at the new position")(loop(first=True))
wrong("5.12", "no gyroscopic term")(loop(gyro=False))
wrong("5.12", "forgets the mass")(loop(mass=False))
wrong("5.12", "forgets to normalise q")(loop(turned=third_way(close=lambda q: q)))


@wrong("5.12", "changes its input")
def rigid_body_step(load, t, x, v, q, omega, dt, body):
    F, tau = load(t, x, v, q, omega, body)
    v += dt / body.m * F
    omega += dt * worked.angular_acceleration(q, omega, tau, body.I_body)
    x += dt * v
    return x, v, worked.quaternion_update(q, omega, dt), omega


# 5.13 -----------------------------------------------------------------------------------------------------------
@wrong("5.13", "L of the world over moments of the body")
def kinetic_energy(q, L, I_body):
    return 0.5 * np.sum(L * L / I_body)


@wrong("5.13", "forgets the half")
def kinetic_energy(q, L, I_body):
    return 2.0 * worked.kinetic_energy(q, L, I_body)


@wrong("5.13", "takes L for ω")
def kinetic_energy(q, L, I_body):
    return 0.5 * np.sum(I_body * worked.unrotate(q, L) ** 2)


@wrong("5.13", "turns L the wrong way")
def kinetic_energy(q, L, I_body):
    return 0.5 * np.sum(worked.rotate(q, L) ** 2 / I_body)


@right("5.13", "half of ω·L")
def kinetic_energy(q, L, I_body):
    return 0.5 * worked.angular_velocity(worked.rotation_matrix(q), L, I_body) @ L


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


wrong("5.14", "the outer axes tumble")(racket(sign=-1.0))
wrong("5.14", "everything tumbles")(racket(root=lambda s: np.sqrt(abs(s))))
wrong("5.14", "forgets the root")(racket(root=lambda s: max(0.0, s)))
wrong("5.14", "over the squared moment of the axis itself")(racket(below=lambda I, i, j: (I.sum() - I[i] - I[j]) ** 2))
wrong("5.14", "a negative spin calms")(racket(spin_of=lambda spin: spin))


# 5.15 -----------------------------------------------------------------------------------------------------------
@wrong("5.15", "lifts the tip")
def heavy_top_torque(t, q, L, top):
    return -worked.heavy_top_torque(t, q, L, top)


@wrong("5.15", "forgets the weight")
def heavy_top_torque(t, q, L, top):
    return worked.heavy_top_torque(t, q, L, top) / top.mgl


@wrong("5.15", "in coordinates of the body")
def heavy_top_torque(t, q, L, top):
    return worked.unrotate(q, worked.heavy_top_torque(t, q, L, top))


@wrong("5.15", "the axis turned the wrong way")
def heavy_top_torque(t, q, L, top):
    return worked.heavy_top_torque(t, q * np.array([-1.0, 1.0, 1.0, 1.0]), L, top)


@right("5.15", "as a cross product with the weight")
def heavy_top_torque(t, q, L, top):
    return np.cross(worked.rotation_matrix(q)[:, 2], [0.0, 0.0, -top.mgl])


# 5.16 -----------------------------------------------------------------------------------------------------------
@variants
def midpoint(rounds=1000, gyro=1.0, close=lambda q, w, dt: worked.unit(worked.product(q, np.concatenate(([1.0], 0.5 * dt * w)))), silent=False,
             guess=lambda start: start.copy(), end=False, strict=False, small=lambda m: 4e-16 * np.max(np.abs(m))):
    """By going round the equation itself, m ← ℓ + ½dt m × w, until nothing changes, with parts that may be wrong."""
    def midpoint_turn(q, L, I_body, dt):
        start = worked.unrotate(q, L)
        m = guess(start)
        for n in range(rounds):
            m_new = start + gyro * 0.5 * dt * np.cross(m, m / I_body)
            change, m = np.max(np.abs(m_new - m)), m_new
            if change < small(m) or (change <= small(m) and not strict) or (silent and n == rounds - 1):
                return close(q, (2.0 * m - start if end else m) / I_body, dt)
        raise Diverged("the equation did not settle at dt [s]", dt, "take a smaller step")
    return midpoint_turn


right("5.16", "by going round the equation")(midpoint())
wrong("5.16", "until the change is small in kg m²/s")(midpoint(small=lambda m: 1e-12))
wrong("5.16", "goes round once")(midpoint(rounds=1, silent=True))
wrong("5.16", "goes round five times: not there yet")(midpoint(rounds=5, silent=True))
wrong("5.16", "the gyroscopic term with the other sign")(midpoint(gyro=-1.0))
wrong("5.16", "ω at the beginning of the step")(midpoint(rounds=1, gyro=0.0, silent=True))
wrong("5.16", "ω at the end of the step")(midpoint(end=True))
wrong("5.16", "turns on the side of the world")(
    midpoint(close=lambda q, w, dt: worked.unit(worked.product(np.concatenate(([1.0], 0.5 * dt * w)), q))))
wrong("5.16", "forgets the half in the turn")(
    midpoint(close=lambda q, w, dt: worked.unit(worked.product(q, np.concatenate(([1.0], dt * w))))))
wrong("5.16", "turns by |ω| dt: the angle of another rule")(
    midpoint(close=lambda q, w, dt: worked.product(q, worked.exponential(dt * w))))
wrong("5.16", "does not normalise")(
    midpoint(close=lambda q, w, dt: worked.product(q, np.concatenate(([1.0], 0.5 * dt * w)))))
wrong("5.16", "gives up on a body at rest")(midpoint(strict=True))


@wrong("5.16", "never says so: turns by whatever Newton's method has")
def midpoint_turn(q, L, I_body, dt):
    start, one = worked.unrotate(q, L), np.eye(3)
    m = start.copy()
    for _ in range(worked.NEWTON_LIMIT):
        w = m / I_body
        r = m - start - 0.5 * dt * np.cross(m, w)
        m = m - np.linalg.solve(np.stack([e + 0.5 * dt * np.cross(w - m / I, e) for e, I in zip(one, I_body)], axis=1), r)
    return worked.unit(worked.product(q, np.concatenate(([1.0], 0.5 * dt * m / I_body))))


# 5.17 -----------------------------------------------------------------------------------------------------------
@variants
def splitting(order="aca", middle=worked.middle_axis, fresh=True, whole=1.0, left=True, sign=1.0, close=worked.unit, slow=lambda I, k, b: 1.0 / I[k] - 1.0 / I[b]):
    """A sequence of exact turns about axes of the body, half where one comes twice, with parts that may be wrong."""
    def splitting_turn(q, L, I_body, dt):
        b = middle(I_body)
        axis = {"a": (b + 1) % 3, "c": (b + 2) % 3}
        turned, ell = q, worked.unrotate(q, L)
        for name in order:
            k = axis[name]
            if fresh:
                ell = worked.unrotate(turned, L)
            angle = sign * dt / order.count(name) * slow(I_body, k, b) * ell[k]
            turned = worked.product(turned, worked.exponential(angle * np.eye(3)[k]))
        about = worked.exponential(whole * dt / I_body[b] * L)
        return close(worked.product(about, turned) if left else worked.product(turned, about))
    return splitting_turn


right("5.17", "half of c, all of a, half of c")(splitting("cac"))
wrong("5.17", "a, then c: first order, and not reversible")(splitting("ac"))
wrong("5.17", "L in the body as it was at the beginning")(splitting(fresh=False))
wrong("5.17", "forgets the turn about L")(splitting(whole=0.0))
wrong("5.17", "about L of the world, on the side of the body")(splitting(left=False))
wrong("5.17", "turns about its axes the other way")(splitting(sign=-1.0))
wrong("5.17", "the whole energy of a and c: L²/2I_b counted twice")(splitting(slow=lambda I, k, b: 1.0 / I[k]))
wrong("5.17", "differences of moments, not of their inverses")(splitting(slow=lambda I, k, b: 1.0 / (I[k] - I[b]) if I[k] != I[b] else 0.0))
wrong("5.17", "always takes the first axis for the middle one")(splitting(middle=lambda I: 0))


@wrong("5.17", "turns about its axes the whole way twice")
def splitting_turn(q, L, I_body, dt):
    turned = splitting("aca", whole=0.0)(q, L, I_body, 2.0 * dt)
    return worked.unit(worked.product(worked.exponential(dt / I_body[worked.middle_axis(I_body)] * L), turned))


# 5.18 -----------------------------------------------------------------------------------------------------------
G, G3 = worked.SUZUKI, 1.0 / (2.0 - 2.0 ** (1.0 / 3.0))


@variants
def composed(shares=(G, G, 1.0 - 4.0 * G, G, G), clock=1.0):
    """Substeps with shares of dt."""
    def compose(step, torque, t, q, L, dt, body):
        for share in shares:
            q, L = step(torque, t, q, L, share * dt, body)
            t = t + clock * share * dt
        return q, L
    return compose


right("5.18", "as a list of shares")(composed())
wrong("5.18", "five equal substeps")(composed([0.2] * 5))
wrong("5.18", "the third forwards: more than one step in all")(composed([G, G, 4.0 * G - 1.0, G, G]))
wrong("5.18", "forgets the third")(composed([G, G, G, G]))
wrong("5.18", "Yoshida's three shares: fourth order, but another method")(composed([G3, 1.0 - 2.0 * G3, G3]))
wrong("5.18", "the negative one first")(composed([1.0 - 4.0 * G, G, G, G, G]))
wrong("5.18", "the clock stands still")(composed(clock=0.0))
