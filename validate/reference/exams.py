"""Published benchmarks: the errors and classes of those who stated them, and motions that nobody has published.

Nothing here uses the functions of `solutions`.
"""

from functools import cache

import numpy as np
from scipy.integrate import solve_ivp

from .mechanisms import FIXED, REST, STIFFNESS, TORQUE, andrews

RTOL, ATOL = 1e-12, 1e-13

# ---------------------------------------------------------------------------------------------- errors and classes

THRESHOLD = 1e-3             # a smaller reference counts as this, in its own unit
HIGH, LOW = 1e-3, 1e-1       # largest errors of the classes of high and of low precision [-]


def iftomm_error(y, reference):
    """Return the root mean square, over all outputs and components, of |y − reference| / max(|reference|, 1e-3).

    Source: González, González and Cuadrado, IFToMM library of computational benchmark problems; the same measure for
    all of its problems.
    """
    y, reference = np.asarray(y, float), np.asarray(reference, float)
    return float(np.sqrt(np.mean((np.abs(y - reference) / np.maximum(np.abs(reference), THRESHOLD)) ** 2)))


def iftomm_class(error):
    """Return the class of that library which an error reaches, for readers; "" for none."""
    return "high precision" if error <= HIGH else "low precision" if error <= LOW else ""


def largest_relative_error(y, reference):
    """Return the largest relative error of any component: −log₁₀ of it are the correct digits.

    Source: the test set for initial value problems of Bari (Mazzia and Magherini 2008), `scd`.
    """
    return float(np.max(np.abs(np.subtract(y, reference)) / np.abs(reference)))


def digits(error):
    """Return the number of correct digits that belongs to a largest relative error, for readers; "" below one."""
    return f"{-np.log10(error):.1f} digits" if 0.0 < error < 0.1 else ""


# ---------------------------------------------------------------------------------------------- Andrews' squeezer

def squeezer():
    """Return (C (7, 7), E (3, 7)), complex numbers, of Andrews' mechanism with the angles θ of its bodies.

    The centre of body i is a fixed point + Σⱼ Cᵢⱼ e^(iθⱼ).  Three loops are closed where E e^(iθ) is a fixed vector:
    the point E of body 1 is that of bodies 2, 3 and 5.
    """
    e, n = np.eye(7, dtype=complex), -1j * np.eye(7)                     # (cos a, sin a) and (sin a, −cos a)
    F = 0.007 * e[0]
    of_1 = F - 0.028 * e[1]
    C = np.array([0.00092 * e[0], F - 0.0115 * e[1], 0.01874 * n[2] + 0.01043 * e[2], 0.04 * e[4] + 0.00579 * n[3],
                  0.02308 * e[4] - 0.00916 * n[4], 0.04 * n[6] + 0.00579 * e[5], 0.01228 * n[6] - 0.00449 * e[6]])
    E = of_1 - np.array([0.035 * n[2], 0.04 * e[4] + 0.02 * n[3], 0.04 * n[6] + 0.02 * e[5]])
    return C, E


def squeezer_slope(m, inertia, C, E):
    """Return (t, y) → ẏ of the angles and rates of the bodies, by Lagrange's equations with multipliers.

    M θ̈ + Gᵀ λ = f,   G θ̈ = −Ġ θ̇,   with  M = Σ m Jᵀ J + diag(I).  Positions are sums of e^(iθ), so that
    J = i C e^(iθ)  and  J̇ θ̇ = −C e^(iθ) θ̇².
    """
    place = complex(*FIXED["B"]) - complex(*FIXED["C"])
    hook = np.zeros(7, complex)
    hook[2] = 0.02 - 0.018j

    def slope(_, y):
        turn, squared = np.exp(1j * y[:7]), y[7:] ** 2
        J, G = 1j * C * turn, 1j * E * turn
        bent, bent_loops = -(C * turn) @ squared, -(E * turn) @ squared
        way = place + hook @ turn
        pull = -STIFFNESS * (abs(way) - REST) / abs(way) * way
        f = (J.conj().T @ (-m * bent)).real + ((1j * hook * turn).conj() * pull).real
        f[0] += TORQUE
        rows = np.vstack((G.real, G.imag))
        matrix = np.block([[(J.conj().T @ (m[:, None] * J)).real + np.diag(inertia), rows.T], [rows, np.zeros((6, 6))]])
        right = np.concatenate((f, -bent_loops.real, -bent_loops.imag))
        return np.concatenate((y[7:], np.linalg.solve(matrix, right)[:7]))
    return slope


@cache
def squeezer_motion(T):
    """Return SciPy's dense solution (t) → angles and rates of the bodies of Andrews' mechanism, by DOP853 at 1e-12.

    Seven angles with three closed loops: another formulation than hinges between bodies in the plane.
    """
    made = andrews()
    C, E = squeezer()
    slope = squeezer_slope(made.m[:-1], made.inertia[:-1], C, E)
    start = np.concatenate((made.q[:-1], np.zeros(7)))
    return solve_ivp(slope, (0.0, T), start, "DOP853", rtol=RTOL, atol=ATOL, dense_output=True).sol


# ---------------------------------------------------------------------------------------------- hinges in the plane

SUZUKI = 1.0 / (4.0 - 4.0 ** (1.0 / 3.0))
FIVE = (SUZUKI, SUZUKI, 1.0 - 4.0 * SUZUKI, SUZUKI, SUZUKI)
EVEN = {2: (2, 4, 6), 4: (4, 6, 8)}          # powers of dt in the error of a reversible method, by its order
CLOSED = 1e-15               # gap at which Newton's method ends, over the size of the mechanism [-]
CORRECTIONS = 50


def rattle_2d(made):
    """Return RATTLE's step (law, t, y, u, h) → (y, u) of a Mechanism in the plane; y, u (n, 3): x, y, angle and rates.

    All hinges are closed at the end of the step, and what they hold has no relative velocity there.  The matrix is
    dense and solved by least squares.  Source: Hairer, Lubich, Wanner 2006, VII.1.
    """
    joints, bodies = np.arange(len(made.a)), len(made.m)
    W = np.stack((1.0 / made.m, 1.0 / made.m, 1.0 / made.inertia), axis=1).ravel()
    z, places = made.x @ (1.0, 1j), made.places @ (1.0, 1j)
    own = [(places - z[body]) * np.exp(-1j * made.q[body]) for body in (made.a, made.b)]
    small = CLOSED * np.max(np.abs(places))

    def arms(y):
        return [r * np.exp(1j * y[body, 2]) for r, body in zip(own, (made.a, made.b))]

    def gaps(y):
        ends = [y[body, 0] + 1j * y[body, 1] + r for r, body in zip(arms(y), (made.a, made.b))]
        return np.concatenate(((ends[0] - ends[1]).real, (ends[0] - ends[1]).imag))

    def rows(y):
        G = np.zeros((2, len(joints), bodies, 3))
        for sign, body, r in zip((1.0, -1.0), (made.a, made.b), arms(y)):
            G[0, joints, body, 0], G[1, joints, body, 1] = sign, sign
            G[0, joints, body, 2], G[1, joints, body, 2] = -sign * r.imag, sign * r.real
        return G.reshape(2 * len(joints), -1)

    def pushed(left, right, amount):
        return W * (right.T @ np.linalg.lstsq(left * W @ right.T, amount, rcond=1e-12)[0])

    def step(law, t, y, u, h):
        u, here = u + 0.5 * h * law(t, y, u), rows(y)
        for _ in range(CORRECTIONS):
            gap = gaps(y + h * u)
            if np.max(np.abs(gap)) <= small:
                break
            u = u - pushed(rows(y + h * u), here, gap / h).reshape(u.shape)
        y = y + h * u
        u, there = u + 0.5 * h * law(t + h, y, u), rows(y)
        return y, u - pushed(there, there, there @ u.ravel()).reshape(u.shape)
    return step


def composed(step):
    """Return five steps in place of one, with Suzuki's shares of it: a method of order 4 from one of order 2."""
    def five(law, t, x, v, h):
        for share in FIVE:
            x, v = step(law, t, x, v, share * h)
            t += share * h
        return x, v
    return five
