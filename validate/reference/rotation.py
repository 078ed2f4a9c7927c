"""Reference solutions of lesson 5: rigid bodies.

Nothing here uses the functions of `solutions`.  A free body is solved by Jacobi's elliptic functions, a heavy symmetric
top by related functions.  The integral that remains uses Gauss's rule.  SciPy's DOP853 on R and L is the second
reference.
"""

from functools import cache

import numpy as np
from scipy.integrate import solve_ivp
from scipy.special import ellipj, ellipkinc, ellipkm1

from validate.reference.orientation import about, cross_matrix
from validate.scene import EXACT, ROUND_OFF, by_order

RTOL, ATOL = 1e-13, 1e-15    # of DOP853, near the smallest it accepts
NODES, WEIGHTS = np.polynomial.legendre.leggauss(20)
PANEL = 1.0  # radian of the fastest motion in each panel of Gauss's rule, whose error (½)⁴⁰/40! is then negligible


def integral(f, t, rate):
    """Return ∫₀ᵗ f, where f(ts) of an array changes no faster than rate [1/s]."""
    panels = max(1, int(np.ceil(abs(t) * rate / PANEL)))
    half = 0.5 * t / panels
    middles = half * (2.0 * np.arange(panels)[:, None] + 1.0)
    return half * np.sum(WEIGHTS * f(middles + half * NODES))


def freely(R, omega_body, I, t, torque=lambda R: np.zeros(3)):
    """Return (R, L) after t by DOP853 on R and L in the world, with torque(R) in the world: the second reference."""
    def slope(t, y):
        R, L = y[:9].reshape(3, 3), y[9:]
        omega = R @ ((R.T @ L) / I)
        return np.concatenate((np.cross(omega, R.T).T.ravel(), torque(R)))
    start = np.concatenate((R.ravel(), R @ (I * omega_body)))
    end = solve_ivp(slope, (0.0, t), start, method="DOP853", rtol=RTOL, atol=ATOL).y[:, -1]
    return end[:9].reshape(3, 3), end[9:]


# ---------------------------------------------------------------------------------------------- a free body

class FreeTop:
    """A free body with I₁ < I₂ < I₃ that starts at R = 1 with ω in body coordinates, and L² > 2E I₂.

    Its axis 3 never turns away from L.

    ω = (A₁ cn τ, A₂ sn τ, A₃ dn τ),  τ = nt + τ₀,      A₁² = (2EI₃ − L²)/I₁(I₃ − I₁),  A₂² = (2EI₃ − L²)/I₂(I₃ − I₂),
    A₃² = (L² − 2EI₁)/I₃(I₃ − I₁),   n² = (I₃ − I₂)(L² − 2EI₁)/I₁I₂I₃,   k² = (I₂ − I₁)(2EI₃ − L²)/(I₃ − I₂)(L² − 2EI₁)
    About L the body turns at  φ̇ = |L| (I₁ω₁² + I₂ω₂²)/(I₁²ω₁² + I₂²ω₂²).

    2EI₃ − L² and L² − 2EI₁ are summed from squares, so that nothing cancels; 1 − k² likewise.
    *Source:* Landau and Lifshitz, Mechanics, § 37.
    """

    @staticmethod
    def knows(I, omega):
        """Return whether the formulas hold: moments in order, L² > 2E I₂, and no rotation about a single axis."""
        a, b, c = I * (I - I[1]) * omega**2                              # their sum: L² − 2E I₂
        return I[0] < I[1] < I[2] and a + b + c > 0.0 and (omega[0] != 0.0 or omega[1] != 0.0)

    def __init__(self, I, omega):
        I1, I2, I3 = self.I = np.array(I, dtype=float)
        squares = self.I * np.array(omega) ** 2
        wide = (I3 - I1) * squares[0] + (I3 - I2) * squares[1]           # 2EI₃ − L²
        tall = (I2 - I1) * squares[1] + (I3 - I1) * squares[2]           # L² − 2EI₁
        self.minor = (I3 - I1) * ((I3 - I2) * squares[2] - (I2 - I1) * squares[0]) / ((I3 - I2) * tall)     # 1 − k²
        up = np.sign(omega[2]) or 1.0  # A₁A₂A₃ > 0 solves Euler's equations
        squared = np.array([wide / (I1 * (I3 - I1)), wide / (I2 * (I3 - I2)), tall / (I3 * (I3 - I1))])
        self.A = np.array([1.0, up, up]) * np.sqrt(squared)
        self.n = np.sqrt((I3 - I2) * tall / (I1 * I2 * I3))
        self.tau = ellipkinc(np.arctan2(omega[1] / self.A[1], omega[0] / self.A[0]), 1.0 - self.minor)
        self.L = np.linalg.norm(self.I * omega)
        self.begin = self.frame(0.0)

    def omega(self, t):
        """Return ω in body coordinates at the times t: (3, …)."""
        sn, cn, dn, _ = ellipj(self.n * np.asarray(t) + self.tau, 1.0 - self.minor)
        return np.array([self.A[0] * cn, self.A[1] * sn, self.A[2] * dn])

    def flips(self):
        """Return the first two times after the start at which ω₂ changes sign [s]."""
        K = ellipkm1(self.minor)
        return (np.array([2.0, 4.0]) * K - self.tau) / self.n

    def precession(self, t):
        squares = np.moveaxis(self.omega(t) ** 2, 0, -1) * self.I
        one, two = squares[..., 0], squares[..., 1]
        return self.L * (one + two) / (self.I[0] * one + self.I[1] * two)

    def frame(self, t):
        """Return (3, 3), from the body to axes with z along L, up to a rotation about L; rows are body vectors."""
        z = self.I * self.omega(t) / self.L
        x = np.array([z[1], -z[0], 0.0]) / np.hypot(z[0], z[1])
        return np.stack((x, np.cross(z, x), z))

    def R(self, t):
        """Return the orientation (3, 3) at t, from R(0) = 1."""
        rate = 4.0 * self.L / self.I.min()
        return self.begin.T @ about(np.array([0.0, 0.0, 1.0]), integral(self.precession, t, rate)) @ self.frame(t)


def symmetric_top(I, omega, t):
    """Return R(t) of a free body with I₁ = I₂ that starts at R = 1.

    R(t) = e^(t L*/I₁) e^(t (1 − I₃/I₁) ω₃ 𝐞₃*),  from  ω = L/I₁ + (1 − I₃/I₁) ω₃ 𝐞₃.
    *Source:* Landau and Lifshitz, Mechanics, § 33.
    """
    L = I * omega
    size = np.linalg.norm(L)
    return about(L / size, size / I[0] * t) @ about(np.array([0.0, 0.0, 1.0]), (1.0 - I[2] / I[0]) * omega[2] * t)


# ---------------------------------------------------------------------------------------------- a heavy top

class HeavyTop:
    """A symmetric top about its pivot, released at the tilt θ₀ with no angular velocity but its spin ω₃; u = cos θ.

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
        # u₀ − u₁, without cancelling
        self.fall = 2.0 * beta * np.sin(tilt) ** 2 / (alpha - 2.0 * beta * self.u0 + root)
        self.u1, self.kappa = self.u0 - self.fall, 0.5 * np.sqrt(beta * (self.u2 - self.u0 + self.fall))
        self.m = self.fall / (self.u2 - self.u1)
        self.high = 2.0 * np.sin(0.5 * tilt) ** 2                        # 1 − u₀

    def nutation(self):
        """Return the period of θ [s]."""
        return 2.0 * ellipkm1(1.0 - self.m) / self.kappa

    def drop(self, t):
        """Return u₀ − u."""
        sn, _, dn, _ = ellipj(self.kappa * np.asarray(t), self.m)
        return self.fall * (1.0 - self.m) * (sn / dn) ** 2               # 1 − cd² = k′² sd²

    def sine_squared(self, t):
        return (self.high + self.drop(t)) * (2.0 - self.high - self.drop(t))

    def precession(self, t):
        return self.a * self.drop(t) / self.sine_squared(t)

    def tips(self, ts):
        """Return the horizontal coordinates (n, 2) of the unit vector along the top; at t = 0 it is at (0, −sin θ₀)."""
        turned = lambda begin, end: integral(lambda s: self.precession(begin + s), end - begin, 4.0 * self.a)
        phi = np.cumsum([turned(begin, end) for begin, end in zip([0.0, *ts], ts)])
        return np.sqrt(self.sine_squared(ts))[:, None] * np.stack((np.sin(phi), -np.cos(phi)), axis=1)

    def tip(self, t):
        return self.tips([t])[0]


# ---------------------------------------------------------------------- bounds of the error

FIRST_ORDER = L_KEPT, BY_COLUMNS, EXPLICIT, IMPLICIT = ("L kept", "L kept, by columns", "gyroscopic",
                                                        "gyroscopic, implicit")


def hung_up(m, l, I, g, R, omega, h, steps, implicit):
    """Return R (3, 3) of a body on a pivot in the origin after steps of Bullet, which holds it there by an impulse.

    m [kg] and I (3,) [kg m²] are about the centre, which is at l R[:, 2] [m].  Gravity acts, then the gyroscopic term
    in body coordinates, at the beginning of the step or by one step of Newton's method at its end (implicit).  The
    impulse lets the point of the body reach the pivot in this step:  K j = −(its place)/h − velocity,
    K = 1/m − r* I⁻¹ r*,  r from the centre to it.  Then the body moves and turns by the new velocities.
    *Source:* Bullet, btRigidBody.cpp and btPoint2PointConstraint.cpp.
    """
    x, v, weight = l * R[:, 2], np.zeros(3), np.array([0.0, 0.0, -g])
    for _ in range(steps):
        w = R.T @ omega
        term = np.diag(I) + h * (cross_matrix(w) * I - cross_matrix(I * w)) if implicit else np.diag(I)
        v, omega = v + h * weight, R @ (w - np.linalg.solve(term, h * np.cross(w, I * w)))
        r, inverse = -l * R[:, 2], R / I @ R.T
        across = cross_matrix(r)
        K = np.eye(3) / m - across @ inverse @ across
        j = np.linalg.solve(K, -(x + r) / h - v - np.cross(omega, r))
        v, omega = v + j / m, omega + inverse @ np.cross(r, j)
        x, rate = x + h * v, np.linalg.norm(omega)
        R = about(omega / rate, rate * h) @ R
    return R


@cache
def growth_of_errors(I, omega, T):
    """Return the error constants of first-order steps on a free body.

    They are (fastest |ω|, ∫ ‖Φ(T, s)‖ |ω̇(s)| ds, {kind of first-order step: its relative error of R at T over dt}).
    A step leaves R off by an angle θ, in body coordinates, and ω by δω.  Such errors obey  ė = Je, with propagator Φ:
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
        kappa = 0.5 * np.array([-w[1] * w[2], w[0] * w[2], -w[0] * w[1]])
        theta = np.stack((-0.5 * w_dot, kappa - 0.5 * w_dot), axis=1)
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
    # |R − R*| = √2 |θ| in Frobenius' norm, and |R*| = √3
    first = np.linalg.norm(Ms[-1, :3, 6:], axis=0) * np.sqrt(2.0 / 3.0)
    total = np.trapezoid(np.multiply(grown, change), times)
    return float(rate), float(total), dict(zip(FIRST_ORDER, map(float, first)))


def free_limits(T, kinds=FIRST_ORDER):
    """Return function(p, dt) → {order k: largest relative error of R at T} on the free body of p.

    kinds: the errors that a first-order step can make.
    """
    def limits(p, dt):
        """Errors grow as neighbouring motions separate, by the propagator Φ of the linearised motion.

        First order: the largest of its kinds of step, χ = C dt, as χ e^χ where the expansion is no longer exact,
        plus the limit of second order.  The constants C follow from that motion, too; two kinds are pybullet's two
        kinds of body.  Higher orders: a step errs by (rate dt)ᵏ |ω̇| dt where ω changes, which grows by Φ, and by
        (rate dt)ᵏ⁺¹ in its angle, which accumulates.  Round-off, an error of 1e-16 per step, grows like the former.
        """
        rate, grown, first = growth_of_errors(tuple(p.moments()), tuple(p.omega()), T)
        noise, plain = (1.0 + grown / (rate * T)) * T / dt * ROUND_OFF, by_order(rate, T, dt)
        higher = {k: plain[k] + grown * (rate * dt) ** k + noise for k in (2, 4)}
        chi = min(max(first[kind] for kind in kinds) * dt, 500.0)        # e⁵⁰⁰ is large enough, and finite
        return {**higher, 1: chi * np.exp(chi) + higher[2], EXACT: plain[EXACT]}
    return limits
