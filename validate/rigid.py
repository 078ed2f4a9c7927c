"""Rigid bodies once more, by other means: what the scenes of lesson 5 hold our steps against, and pybullet's bodies.

Nothing here knows the functions of `solutions`.  A free body is solved by Jacobi's elliptic functions, a heavy symmetric top by
their close relative, and what is left is an integral, taken by Gauss; SciPy's DOP853 on R and L is the second witness.
"""

from functools import lru_cache

import numpy as np
from scipy.integrate import solve_ivp
from scipy.special import ellipj, ellipkinc, ellipkm1

from .engines import Bullet
from .scene import EXACT, ROUND_OFF, Engine, Method, World, by_order

MATRIX = Method("matrix_step", "ω*R, renormalised", 1, "rotation")
AXIS_ANGLE = Method("axis_angle_step", "axis–angle", 1, "rotation")
QUATERNION = Method("quaternion_step", "quaternion", 1, "rotation")
GYROSCOPIC = Method("gyroscopic_step", "gyroscopic term", 1, "rotation")
IMPLICIT_GYROSCOPIC = Method("implicit_gyroscopic_step", "gyroscopic, implicit", 1, "rotation")
RUNGE_KUTTA = Method("runge_kutta_step", "Runge–Kutta 4", 4, "rotation")
MIDPOINT_TURN = Method("midpoint_step", "midpoint turn", 2, "rotation")
SPLITTING = Method("splitting_step", "splitting", 2, "rotation")
COMPOSED_SPLITTING = Method("composed_splitting_step", "splitting, composed", 4, "rotation")
COMPOSED_MIDPOINT = Method("composed_midpoint_step", "midpoint, composed", 4, "rotation")
LOOP = Method("rigid_body_step", "the lecture's loop", 1, "rotation")

TURNS = (MATRIX, AXIS_ANGLE, QUATERNION, GYROSCOPIC, IMPLICIT_GYROSCOPIC, RUNGE_KUTTA, MIDPOINT_TURN, SPLITTING, COMPOSED_SPLITTING, COMPOSED_MIDPOINT)

RTOL, ATOL = 1e-13, 1e-15    # of DOP853, near the least it accepts
NODES, WEIGHTS = np.polynomial.legendre.leggauss(20)
PANEL = 1.0                  # radian of the fastest motion in each panel of Gauss's rule, whose error is then (½)⁴⁰/40!: none


# ---------------------------------------------------------------------------------------------- small change

def cross_matrix(a):
    """(3, 3): times b it is a × b."""
    x, y, z = a
    return np.array(((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)))


def about(axis, angle):
    """R (3, 3) about a unit vector."""
    K = cross_matrix(axis)
    return np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * K @ K


def quaternion_matrix(w, x, y, z):
    """R (3, 3) of a unit quaternion, as a turn by 2 acos w about (x, y, z)."""
    s = np.sqrt(x * x + y * y + z * z)
    return about(np.array([x, y, z]) / s, 2.0 * np.arctan2(s, w)) if s > 0.0 else np.eye(3)


def quaternion(R):
    """The unit quaternion (w, x, y, z), w ≥ 0, of R: the longest row of 4 q qᵀ.

    *Source:* Shepperd 1978.
    """
    (a, b, c), (d, e, f), (g, h, i) = R
    rows = np.array([[1.0 + a + e + i, h - f, c - g, d - b],
                     [h - f, 1.0 + a - e - i, b + d, c + g],
                     [c - g, b + d, 1.0 - a + e - i, f + h],
                     [d - b, c + g, f + h, 1.0 - a - e + i]])
    row = rows[np.argmax(np.diag(rows))]
    return row / np.copysign(np.linalg.norm(row), row[0])


def relative_turn(R, S):
    """Angle [rad] of the turn that takes one orientation to the other: |R − S| = 2√2 sin(½ angle) in Frobenius' norm."""
    return 2.0 * np.arcsin(min(1.0, np.linalg.norm(R - S) / np.sqrt(8.0)))


def integral(f, t, rate):
    """∫₀ᵗ f, f(ts) of an array, changing no faster than rate [1/s]."""
    panels = max(1, int(np.ceil(abs(t) * rate / PANEL)))
    half = 0.5 * t / panels
    middles = half * (2.0 * np.arange(panels)[:, None] + 1.0)
    return half * np.sum(WEIGHTS * f(middles + half * NODES))


def freely(R, omega_body, I, t, torque=lambda R: np.zeros(3)):
    """(R, L) after t by DOP853 on R and L in the world, torque(R) in the world: the second witness."""
    def slope(t, y):
        R, L = y[:9].reshape(3, 3), y[9:]
        omega = R @ ((R.T @ L) / I)
        return np.concatenate((np.cross(omega, R.T).T.ravel(), torque(R)))
    start = np.concatenate((R.ravel(), R @ (I * omega_body)))
    end = solve_ivp(slope, (0.0, t), start, method="DOP853", rtol=RTOL, atol=ATOL).y[:, -1]
    return end[:9].reshape(3, 3), end[9:]


# ---------------------------------------------------------------------------------------------- a free body

class FreeTop:
    """A free body with I₁ < I₂ < I₃ that starts at R = 1 with ω in the body, and L² > 2E I₂: its axis 3 never turns back from L.

    ω = (A₁ cn τ, A₂ sn τ, A₃ dn τ),  τ = nt + τ₀,      A₁² = (2EI₃ − L²)/I₁(I₃ − I₁),  A₂² = (2EI₃ − L²)/I₂(I₃ − I₂),
    A₃² = (L² − 2EI₁)/I₃(I₃ − I₁),   n² = (I₃ − I₂)(L² − 2EI₁)/I₁I₂I₃,   k² = (I₂ − I₁)(2EI₃ − L²)/(I₃ − I₂)(L² − 2EI₁)
    About L the body turns at  φ̇ = |L| (I₁ω₁² + I₂ω₂²)/(I₁²ω₁² + I₂²ω₂²).

    2EI₃ − L² and L² − 2EI₁ are summed from squares, so that nothing cancels; 1 − k² likewise.
    *Source:* Landau and Lifshitz, Mechanics, § 37.
    """

    @staticmethod
    def knows(I, omega):
        """Whether the formulas hold for this body: moments in order, L² > 2E I₂, and not quite about an axis."""
        a, b, c = I * (I - I[1]) * omega**2                              # their sum: L² − 2E I₂
        return I[0] < I[1] < I[2] and a + b + c > 0.0 and (omega[0] != 0.0 or omega[1] != 0.0)

    def __init__(self, I, omega):
        I1, I2, I3 = self.I = np.array(I, dtype=float)
        squares = self.I * np.array(omega) ** 2
        wide = (I3 - I1) * squares[0] + (I3 - I2) * squares[1]           # 2EI₃ − L²
        tall = (I2 - I1) * squares[1] + (I3 - I1) * squares[2]           # L² − 2EI₁
        self.minor = (I3 - I1) * ((I3 - I2) * squares[2] - (I2 - I1) * squares[0]) / ((I3 - I2) * tall)     # 1 − k²
        up = np.sign(omega[2]) or 1.0                                    # A₁A₂A₃ > 0 solves Euler's equations
        self.A = np.array([np.sqrt(wide / (I1 * (I3 - I1))), up * np.sqrt(wide / (I2 * (I3 - I2))), up * np.sqrt(tall / (I3 * (I3 - I1)))])
        self.n = np.sqrt((I3 - I2) * tall / (I1 * I2 * I3))
        self.tau = ellipkinc(np.arctan2(omega[1] / self.A[1], omega[0] / self.A[0]), 1.0 - self.minor)
        self.L = np.linalg.norm(self.I * omega)
        self.begin = self.frame(0.0)

    def omega(self, t):
        """ω in the body at the times t: (3, …)."""
        sn, cn, dn, _ = ellipj(self.n * np.asarray(t) + self.tau, 1.0 - self.minor)
        return np.array([self.A[0] * cn, self.A[1] * sn, self.A[2] * dn])

    def flips(self):
        """Times at which ω₂ changes sign, the first two after the start [s]."""
        K = ellipkm1(self.minor)
        return (np.array([2.0, 4.0]) * K - self.tau) / self.n

    def precession(self, t):
        squares = np.moveaxis(self.omega(t) ** 2, 0, -1) * self.I
        return self.L * (squares[..., 0] + squares[..., 1]) / (self.I[0] * squares[..., 0] + self.I[1] * squares[..., 1])

    def frame(self, t):
        """(3, 3) from body coordinates to ones whose z is along L, but for a turn about L: its rows seen from the body."""
        z = self.I * self.omega(t) / self.L
        x = np.array([z[1], -z[0], 0.0]) / np.hypot(z[0], z[1])
        return np.stack((x, np.cross(z, x), z))

    def R(self, t):
        """Orientation (3, 3) at t, from R(0) = 1."""
        rate = 4.0 * self.L / self.I.min()
        return self.begin.T @ about(np.array([0.0, 0.0, 1.0]), integral(self.precession, t, rate)) @ self.frame(t)


def symmetric_top(I, omega, t):
    """R(t) = e^(t L*/I₁) e^(t (1 − I₃/I₁) ω₃ 𝐞₃*)  of a free body with I₁ = I₂ that starts at R = 1: ω = L/I₁ + (1 − I₃/I₁) ω₃ 𝐞₃.

    *Source:* Landau and Lifshitz, Mechanics, § 33.
    """
    L = I * omega
    size = np.linalg.norm(L)
    return about(L / size, size / I[0] * t) @ about(np.array([0.0, 0.0, 1.0]), (1.0 - I[2] / I[0]) * omega[2] * t)


# ---------------------------------------------------------------------------------------------- a heavy top

class HeavyTop:
    """A symmetric top about its pivot, let go at the tilt θ₀ with nothing but its spin ω₃; u = cos θ.

    With  β = 2Mgl/I₁,  α = (I₃ω₃/I₁)²:   u̇² = (u₀ − u)[β(1 − u²) − α(u₀ − u)] = β(u₀ − u)(u − u₁)(u₂ − u)
        u = u₀ − (u₀ − u₁) (1 − cd²),   cd = sn(κt + K),   κ = ½√(β(u₂ − u₁)),   k² = (u₀ − u₁)/(u₂ − u₁)
        φ̇ = (I₃ω₃/I₁)(u₀ − u)/(1 − u²)
    *Source:* Landau and Lifshitz, Mechanics, § 35; Whittaker 1917, § 71.
    """

    def __init__(self, I1, I3, mgl, tilt, spin):
        self.a, beta, self.u0 = I3 * spin / I1, 2.0 * mgl / I1, np.cos(tilt)
        alpha = self.a * self.a
        root = np.sqrt(alpha * alpha - 4.0 * beta * (alpha * self.u0 - beta))
        self.u2 = (alpha + root) / (2.0 * beta)
        self.fall = 2.0 * beta * np.sin(tilt) ** 2 / (alpha - 2.0 * beta * self.u0 + root)      # u₀ − u₁, without cancelling
        self.u1, self.kappa = self.u0 - self.fall, 0.5 * np.sqrt(beta * (self.u2 - self.u0 + self.fall))
        self.m = self.fall / (self.u2 - self.u1)
        self.high = 2.0 * np.sin(0.5 * tilt) ** 2                        # 1 − u₀

    def nutation(self):
        """Period of θ [s]."""
        return 2.0 * ellipkm1(1.0 - self.m) / self.kappa

    def drop(self, t):
        """u₀ − u."""
        sn, cn, dn, _ = ellipj(self.kappa * np.asarray(t), self.m)
        return self.fall * (1.0 - self.m) * (sn / dn) ** 2               # 1 − cd² = k′² sd²

    def sine_squared(self, t):
        return (self.high + self.drop(t)) * (2.0 - self.high - self.drop(t))

    def precession(self, t):
        return self.a * self.drop(t) / self.sine_squared(t)

    def tips(self, ts):
        """Horizontal coordinates (n, 2) of the unit vector along the top at these times, one after the other; at 0 it is at (0, −sin θ₀)."""
        phi = np.cumsum([integral(lambda s: self.precession(begin + s), end - begin, 4.0 * self.a) for begin, end in zip([0.0, *ts], ts)])
        return np.sqrt(self.sine_squared(ts))[:, None] * np.stack((np.sin(phi), -np.cos(phi)), axis=1)

    def tip(self, t):
        return self.tips([t])[0]


# ---------------------------------------------------------------------------------------------- what a step may get wrong

FIRST_ORDER = ("L kept", "L kept, by columns", "gyroscopic", "gyroscopic, implicit")


@lru_cache(maxsize=None)
def growth_of_errors(I, omega, T):
    """(fastest |ω|, ∫ ‖Φ(T, s)‖ |ω̇(s)| ds, {kind of first-order step: its relative error of R at T over dt}) of a free body.

    A step leaves R off by an angle θ, in the body, and ω by δω.  Such errors obey  ė = Je,  whose solution operator is Φ:
        θ̇ = δω − ω × θ,     I δω̇ = (Iω)* δω − ω* I δω
    A first-order step adds dt² d to them each time, so that the error at T is dt e(T),  ė = Je + d:
        L kept (axis–angle, quaternion)                θ: −½ω̇         δω: I⁻¹(Iω × θ), because L is kept
        L kept, R renormalised by columns              θ: −½ω̇ + κ     δω: likewise;     κ = ½(−ω₂ω₃, ω₁ω₃, −ω₁ω₂)
        gyroscopic term at the beginning, at the end   θ: +½ω̇         δω: −½ω̈, +½ω̈
    κ:  1 + dt ω* = QU with Q = exp(dt ω* + dt² κ*) and U upper triangular.
    *Source:* Hairer, Nørsett, Wanner 1993, II.8, for the global error; the defects d by expansion in dt.
    """
    I = np.array(I)

    def parts(w):
        W, turned = cross_matrix(w), cross_matrix(I * w) / I[:, None]       # turned @ θ: I⁻¹(Iω × θ)
        w_dot, J_w = turned @ w, turned - W * I / I[:, None]
        theta = np.stack((-0.5 * w_dot, 0.5 * np.array([-w[1] * w[2], w[0] * w[2], -w[0] * w[1]]) - 0.5 * w_dot), axis=1)
        J, d = np.zeros((6, 6)), np.zeros((6, 10))
        J[:3, :3], J[:3, 3:], J[3:, 3:] = -W, np.eye(3), J_w
        d[:3, 6:8], d[3:, 6:8] = theta, turned @ theta
        d[:3, 8], d[:3, 9], d[3:, 8], d[3:, 9] = 0.5 * w_dot, 0.5 * w_dot, -0.5 * J_w @ w_dot, 0.5 * J_w @ w_dot
        return w_dot, J, d

    def slope(t, y):
        w_dot, J, d = parts(y[:3])
        return np.concatenate((w_dot, (J @ y[3:].reshape(6, 10) + d).ravel()))

    times = np.linspace(0.0, T, 401)
    start = np.concatenate((omega, np.hstack((np.eye(6), np.zeros((6, 4)))).ravel()))
    run = solve_ivp(slope, (0.0, T), start, method="DOP853", rtol=1e-10, atol=1e-12, t_eval=times).y.T
    ws, Ms = run[:, :3], run[:, 3:].reshape(-1, 6, 10)
    rate = np.linalg.norm(ws, axis=1).max()
    scale = np.array([1.0, 1.0, 1.0, rate, rate, rate])                  # δω/rate is a number like θ
    grown = [np.linalg.norm((Ms[-1, :, :6] @ np.linalg.inv(M[:, :6]) * scale)[:3], 2) for M in Ms]
    change = [np.linalg.norm(parts(w)[0]) for w in ws]
    first = np.linalg.norm(Ms[-1, :3, 6:], axis=0) * np.sqrt(2.0 / 3.0)   # |R − R*| = √2 |θ| in Frobenius' norm, and |R*| = √3
    return float(rate), float(np.trapezoid(np.multiply(grown, change), times)), dict(zip(FIRST_ORDER, map(float, first)))


def free_limits(p, T, dt, kinds=FIRST_ORDER):
    """{order k: largest relative error of R at T} of a step on the free body of p; pybullet's two kinds of body by name.

    First order: the worst of these kinds, χ = C dt, as χ e^χ where the expansion is no longer exact, and what second order allows.
    Higher orders: a step errs by (rate dt)ᵏ |ω̇| dt where ω changes, which grows by Φ, and by (rate dt)ᵏ⁺¹ in its angle, which adds
    up.  Round-off, an error of 1e-16 a step, grows like the former.
    """
    rate, grown, first = growth_of_errors(tuple(p.moments()), tuple(p.omega()), T)
    noise, plain = (1.0 + grown / (rate * T)) * T / dt * ROUND_OFF, by_order(rate, T, dt)

    def of_kind(C):
        chi = min(C * dt, 500.0)                                         # e⁵⁰⁰ is large enough, and finite
        return chi * np.exp(chi) + higher[2]
    higher = {k: plain[k] + grown * (rate * dt) ** k + noise for k in (2, 4)}
    return {**higher, 1: of_kind(max(first[kind] for kind in kinds)), EXACT: plain[EXACT],
            "pybullet, reduced coordinates": of_kind(first["gyroscopic"]), "pybullet": of_kind(first["gyroscopic, implicit"])}


# ---------------------------------------------------------------------------------------------- a witness

class Rigid(Bullet):
    """pybullet with bodies that have moments of inertia; `maximal` or reduced coordinates; no hidden damping, no clamp of velocity."""

    def __init__(self, dt, gravity=(0.0, 0.0, 0.0), iterations=50, erp=0.2):
        super().__init__(dt, gravity)
        # the slop is a depth at which a contact begins to be felt: 1e-5 m take 1.4 ms to fall through, without friction
        self.pb.setPhysicsEngineParameter(numSolverIterations=iterations, erp=erp, contactSlop=0, physicsClientId=self.client)

    def body(self, m, I, x, omega, maximal, v=(0.0, 0.0, 0.0), R=np.eye(3), shape=-1, mu=0.0):
        """A body at x, turned by R; mass and moments go in one call, or the first is lost."""
        q = np.roll(quaternion(R), -1).tolist()                          # pybullet has w last
        body = self.pb.createMultiBody(m, shape, basePosition=list(map(float, x)), baseOrientation=q, useMaximalCoordinates=int(maximal), physicsClientId=self.client)
        unclamped = {} if maximal else {"maxJointVelocity": 1e9}
        self.pb.changeDynamics(body, -1, mass=m, localInertiaDiagonal=list(map(float, I)), linearDamping=0, angularDamping=0, lateralFriction=mu,
                               rollingFriction=0, spinningFriction=0, restitution=0, **unclamped, physicsClientId=self.client)
        self.pb.resetBaseVelocity(body, list(map(float, v)), list(map(float, omega)), physicsClientId=self.client)
        return body

    def R(self, body):
        """Orientation (3, 3)."""
        q = self.pb.getBasePositionAndOrientation(body, physicsClientId=self.client)[1]
        return np.array(self.pb.getMatrixFromQuaternion(q)).reshape(3, 3)

    def omega(self, body):
        return self.pb.getBaseVelocity(body, physicsClientId=self.client)[1]

    def pivot(self, body, offset, maximal):
        """Hold the point of the body at this offset from its centre at the origin, to a body of no size that cannot move.

        (To the world itself bodies with maximal coordinates cannot be held.)
        """
        nail = self.pb.createMultiBody(0, -1, useMaximalCoordinates=int(maximal), physicsClientId=self.client)
        self.pb.createConstraint(body, -1, nail, -1, self.pb.JOINT_POINT2POINT, [0, 0, 0], list(map(float, offset)), [0, 0, 0], physicsClientId=self.client)

    def ball(self, radius):
        return self.pb.createCollisionShape(self.pb.GEOM_SPHERE, radius=radius, physicsClientId=self.client)

    def floor(self):
        """A plane z = 0 of friction 1: pybullet multiplies the two."""
        plane = self.pb.createCollisionShape(self.pb.GEOM_PLANE, physicsClientId=self.client)
        body = self.pb.createMultiBody(0, plane, physicsClientId=self.client)
        self.pb.changeDynamics(body, -1, lateralFriction=1.0, rollingFriction=0, spinningFriction=0, restitution=0, physicsClientId=self.client)

    def close(self):
        """The next world finds the engine's own settings again."""
        self.pb.setPhysicsEngineParameter(numSolverIterations=50, erp=0.2, contactSlop=1e-5, physicsClientId=self.client)
        super().close()


def seen(tips):
    """Drawing coordinates (n, 2) of points in space: y to the right, z up, and x slanted towards the reader."""
    return np.asarray(tips) @ np.array([[-0.4, -0.3], [1.0, 0.0], [0.0, 1.0]])


def axes_seen(R):
    """The centre of a body and the tips of its three axes, as points to draw."""
    return seen(np.vstack((np.zeros(3), np.reshape(R, (3, 3)).T)))


def pose(x, R):
    """(7,): a body at x, turned by R, for the player in space."""
    return np.concatenate((x, quaternion(R)))


def omega_and_L(R, p, reach):
    """The arrows of a free body with p.moments() and p.omega() that started at R = 1, so that L = I ω(0) for ever.

    L is drawn reach [m] long, and ω at the scale at which its tip stays in the plane across L at L's tip: ω · L = 2E is kept, too.
    """
    R, I = np.reshape(R, (3, 3)), p.moments()
    L, still = I * p.omega(), np.zeros(3)
    return {"ω": (still, reach * np.linalg.norm(L) / (L @ p.omega()) * R @ ((R.T @ L) / I)), "L": (still, reach * L / np.linalg.norm(L))}


def free_body(maximal):
    """make(p, dt) of a free body with p.moments() and p.omega() that starts at R = 1; read: R, flat."""
    def make(p, dt):
        bullet = Rigid(dt)
        body = bullet.body(1.0, p.moments(), (0.0, 0.0, 0.0), p.omega(), maximal)
        return World(bullet.step, lambda: bullet.R(body).ravel(), bullet.close)
    return make


FREE_ENGINES = (
    Engine("pybullet, reduced coordinates", free_body(False), 1, "createMultiBody as it comes, but no damping and no clamp of velocity"),
    Engine("pybullet", free_body(True), 1, "useMaximalCoordinates=1, no damping"),
)


def rolling_ball(ball, v, maximal, dt):
    """A World of a ball, bowled along x on a horizontal floor; read: way, speed and rim speed along it."""
    bullet = Rigid(dt, ball.gravity, iterations=100)
    bullet.floor()
    body = bullet.body(ball.m, ball.I_body, (0.0, 0.0, ball.radius), np.zeros(3), maximal, v=v, shape=bullet.ball(ball.radius), mu=ball.mu)
    read = lambda: np.array([bullet.position(body)[0], bullet.velocity(body)[0], ball.radius * bullet.omega(body)[1]])
    return World(bullet.step, read, bullet.close)
