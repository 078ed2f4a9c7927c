"""Published benchmarks: the errors and classes of those who stated them, and motions without published numbers.

Nothing here uses the functions of `solutions`.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from . import turns
from .mechanisms import EDGES, FIXED, REST, STIFFNESS, THICK, TORQUE, andrews, bricard, bricard_state
from .schemes import ErrorLaw

RTOL, ATOL = 1e-12, 1e-13

# ---------------------------------------------------------------------------------------------- errors and classes

THRESHOLD = 1e-3             # a smaller reference counts as this, in its own unit
HIGH, LOW = 1e-3, 1e-1       # largest errors of the classes of high and of low precision [-]


def iftomm_error(y, reference):
    """Return the root mean square, over all outputs and components, of |y − reference| / max(|reference|, 1e-3).

    Source: González, González, Luaces and Cuadrado 2010, for IFToMM's library of computational benchmark problems; all
    of its problems have this measure.
    """
    y, reference = np.asarray(y, float), np.asarray(reference, float)
    return float(np.sqrt(np.mean((np.abs(y - reference) / np.maximum(np.abs(reference), THRESHOLD)) ** 2)))


def iftomm_class(error):
    """Return the class of that library which an error reaches, for readers; "" for none."""
    return "high precision" if error <= HIGH else "low precision" if error <= LOW else ""


def velocity_error(outputs, reference):
    """Return SimBenchmark's error [m²/s²] of (outputs, (place, velocity) of the box and of a ball): the mean over the
    outputs of the squared errors of both velocities.
    """
    off = (np.asarray(outputs) - np.asarray(reference)).reshape(-1, 2, 2, 3)[:, :, 1]
    return float(np.mean(np.sum(off * off, axis=(1, 2))))


def largest_relative_error(y, reference):
    """Return the largest relative error of any component: −log₁₀ of it are the correct digits.

    Source: the test set for initial value problems of Bari (Mazzia and Magherini 2008), `scd`.
    """
    return float(np.max(np.abs(np.subtract(y, reference)) / np.abs(reference)))


def digits(error):
    """Return the whole number of correct digits that belongs to a largest relative error, for readers; "" below one."""
    whole = int(np.floor(-np.log10(error))) if 0.0 < error < 1.0 else 0
    return f"{whole} digit{'s' if whole > 1 else ''}" if whole else ""


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
def squeezer_motion(crank, T):
    """Return SciPy's dense solution (t) → angles and rates of the bodies of Andrews' mechanism, by DOP853 at 1e-12.

    crank: the moment of the body that is driven [kg m²].

    Seven angles with three closed loops: another formulation than hinges between bodies in the plane.
    """
    made = andrews()
    C, E = squeezer()
    slope = squeezer_slope(made.m[:-1], np.concatenate(([crank], made.inertia[1:-1])), C, E)
    start = np.concatenate((made.q[:-1], np.zeros(7)))
    return solve_ivp(slope, (0.0, T), start, "DOP853", rtol=RTOL, atol=ATOL, dense_output=True).sol


# ---------------------------------------------------------------------------------------------- hinges in the plane

SUZUKI = 1.0 / (4.0 - 4.0 ** (1.0 / 3.0))
FIVE = (SUZUKI, SUZUKI, 1.0 - 4.0 * SUZUKI, SUZUKI, SUZUKI)
EVEN = {2: (2, 4, 6), 4: (4, 6, 8)}          # powers of dt in the error of a reversible method, by its order
CLOSED = 1e-15               # gap at which Newton's method ends, over the size of the mechanism [-]
CORRECTIONS = 50


def joints_2d(made):
    """Return (gaps(y), rows(y), pushed(left, right, amount)) of the hinges of a Mechanism in the plane.

    y (n, 3): x, y and angle of each body.  pushed: changes of all velocities by impulses at the rows `right` that add
    `amount` at the rows `left`, by least squares.
    """
    joints, bodies = np.arange(len(made.a)), len(made.m)
    W = np.stack((1.0 / made.m, 1.0 / made.m, 1.0 / made.inertia), axis=1).ravel()
    z, places = made.x @ (1.0, 1j), made.places @ (1.0, 1j)
    own = [(places - z[body]) * np.exp(-1j * made.q[body]) for body in (made.a, made.b)]

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
    return gaps, rows, pushed


def rattle_2d(made):
    """Return RATTLE's step (law, t, y, u, h) → (y, u) of a Mechanism in the plane; y, u (n, 3): x, y, angle and rates.

    All hinges are closed at the end of the step, and what they hold has no relative velocity there.
    Source: Hairer, Lubich, Wanner 2006, VII.1.
    """
    gaps, rows, pushed = joints_2d(made)
    small = CLOSED * np.max(np.abs(made.places @ (1.0, 1j)))

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


# ---------------------------------------------------------------------------------------------- four-bars

def four_bars_sums(loops):
    """Return (Σ of both ends of the cranks' and couplers' chords [kg m²], Σ moments of cranks [kg m²], G/g [kg m]).

    The centre of a crank is ½ m from its foot, that of a coupler 1 m: ¼ and 1 kg m².
    """
    cranks = loops + 1
    return 0.25 * cranks + loops, cranks / 12.0, 0.5 * cranks + loops


def four_bars_law(loops, g):
    """Return θ̈(t, θ, ω) of cranks that stay parallel, θ from +x."""
    chords, moments, arm = four_bars_sums(loops)
    return lambda t, theta, omega: -arm * g * np.cos(theta) / (chords + moments)


def four_bars_step(loops):
    """Return RATTLE's step (law, t, θ, ω, h) → (θ, ω) of the four-bars' hinges, written for the angle of their cranks.

    Hinges move centres on chords:  (C sin Δ + I Δ)/h = I_all (ω + ½ h θ̈),  Δ: what the cranks turn by in the step.
    Source: Hairer, Lubich, Wanner 2006, VII.1 and VI.6.
    """
    chords, moments, _ = four_bars_sums(loops)
    total = chords + moments

    def step(law, t, theta, omega, h):
        goal = h * total * (omega + 0.5 * h * law(t, theta, omega))
        turn = goal / total
        for _ in range(CORRECTIONS):
            change = (chords * np.sin(turn) + moments * turn - goal) / (chords * np.cos(turn) + moments)
            turn -= change
            if abs(change) < 1e-16:
                break
        theta += turn
        return theta, goal / (h * total) + 0.5 * h * law(t + h, theta, omega)
    return step


@cache
def four_bars_angle(loops, g, omega, T):
    """Return SciPy's dense solution (t) → (θ, ω) of cranks that begin upright, by DOP853 at 1e-12."""
    law = four_bars_law(loops, g)
    return solve_ivp(lambda t, y: (y[1], law(t, *y)), (0.0, T), (0.5 * np.pi, omega), "DOP853", rtol=RTOL, atol=ATOL,
                     dense_output=True).sol


# ---------------------------------------------------------------------------------------------- a flyball governor

class Governor(NamedTuple):
    """Two rods of 1 m, hinged to a shaft at the height 1 m, with balls in their middles and springs to a slider."""
    k: float                 # [N/m]
    c: float                 # [N s/m]
    rest: float              # [m]
    rod: float               # [kg]
    ball: float              # [kg]
    slider: float            # [kg]
    still: float             # moment of shaft and slider [kg m²]
    b: float                 # of the hinges and of the slider's sides from the axis [m]
    g: float                 # [m/s²]

    def masses(self):
        """Return ((m, place along the rod), …) of points that have the mass, the centre and the moment of a rod."""
        apart = 0.5 / np.sqrt(3.0)                       # Gauss's rule, exact for u²
        return ((0.5 * self.rod, 0.5 - apart), (0.5 * self.rod, 0.5 + apart), (self.ball, 0.5))


def spring_of(machine, x, v):
    """Return (length, rate, its derivatives by α and by s) of one spring; x, v: φ, α, s and rates."""
    out, up = 0.5 * np.cos(x[1]), 1.0 - 0.5 * np.sin(x[1]) - x[2]
    length = np.hypot(out, up)
    by_alpha = (-0.5 * np.sin(x[1]) * out - 0.5 * np.cos(x[1]) * up) / length
    by_s = -up / length
    return length, by_alpha * v[1] + by_s * v[2], by_alpha, by_s


def governor_law(machine):
    """Return (t, x, v) → the accelerations of φ, α, s, by d'Alembert's principle for points of one rod, taken twice.

    In the turning frame a point is at (r, 0, z); its acceleration is  (r̈ − r φ̇², r φ̈ + 2 ṙ φ̇, z̈).
    """
    points = machine.masses()

    def law(t, x, v):
        c, s = np.cos(x[1]), np.sin(x[1])
        M, f = np.diag((machine.still, 0.0, machine.slider)), np.array([0.0, 0.0, -machine.slider * machine.g])
        for m, u in points:
            r, r_rate = machine.b + u * c, -u * s * v[1]
            radial, upward = -u * c * v[1] ** 2 - r * v[0] ** 2, u * s * v[1] ** 2       # without φ̈ and α̈
            M[0, 0] += 2.0 * m * r * r
            M[1, 1] += 2.0 * m * u * u
            f[0] -= 2.0 * m * r * 2.0 * r_rate * v[0]
            f[1] -= 2.0 * m * (-u * s * radial - u * c * (upward + machine.g))
        length, rate, by_alpha, by_s = spring_of(machine, x, v)
        pull = 2.0 * (machine.k * (length - machine.rest) + machine.c * rate)
        f[1] -= pull * by_alpha
        f[2] -= pull * by_s
        return f / np.diag(M)
    return law


@cache
def governor_motion(machine, omega, T):
    """Return SciPy's dense solution (t) → (φ, α, s and rates, work of the dampers) by Radau at 1e-10."""
    law = governor_law(machine)

    def slope(t, y):
        _, rate, _, _ = spring_of(machine, y[:3], y[3:6])
        return np.concatenate((y[3:6], law(t, y[:3], y[3:6]), [2.0 * machine.c * rate * rate]))
    start = np.array([0.0, np.pi / 6.0, 0.5, omega, 0.0, 0.0, 0.0])
    with np.errstate(all="ignore"):                      # of Radau's estimate of the Jacobian
        return solve_ivp(slope, (0.0, T), start, "Radau", rtol=1e-10, atol=1e-11, dense_output=True).sol


def governor_energy(machine, omega, T):
    """Return the energy lost until T less what the dampers took, over the first energy of motion."""
    def energy(y):
        total = 0.5 * machine.still * y[3] ** 2 + machine.slider * (0.5 * y[5] ** 2 + machine.g * y[2])
        for m, u in machine.masses():
            r, z = machine.b + u * np.cos(y[1]), 1.0 - u * np.sin(y[1])
            total += 2.0 * m * (0.5 * (r * r * y[3] ** 2 + u * u * y[4] ** 2) + machine.g * z)
        length = spring_of(machine, y[:3], y[3:6])[0]
        return total + machine.k * (length - machine.rest) ** 2
    motion = governor_motion(machine, omega, T)
    first, last = motion(0.0), motion(T)
    return (energy(first) - energy(last) - last[6]) / energy(first)


NUDGE, NEWTON = 1e-7, 1e-12  # of a coordinate for a difference quotient; change of a rate at which Newton's method ends


def implicit_step(share):
    """Return the step (law, t, x, v, h) → (x, v) of one implicit stage at this share of a step: 1 is Euler, ½ midpoint.

    V = v + share h a(t + share h, x + share h V, V), by Newton's method with difference quotients: it holds for a
    stiff law, too.
    """
    def step(law, t, x, v, h):
        part, V = share * h, np.array(v, float)
        off = lambda V: V - v - part * law(t + part, x + part * V, V)
        for _ in range(CORRECTIONS):
            here = off(V)
            columns = [(off(V + NUDGE * one) - off(V - NUDGE * one)) / (2.0 * NUDGE) for one in np.eye(V.size)]
            change = np.linalg.solve(np.stack(columns, axis=1), here)
            V = V - change
            if np.max(np.abs(change)) <= NEWTON * (1.0 + np.max(np.abs(V))):
                break
        return x + h * V, v + (V - v) / share
    return step


# ---------------------------------------------------------------------------------------------- a box that is tossed

class Tossed(NamedTuple):
    """A free body under gravity that begins at R = 1, in the origin."""
    I: tuple                 # principal moments [kg m²]
    omega: tuple             # first angular velocity [rad/s]
    v: tuple                 # first velocity [m/s]
    gravity: tuple           # [m/s²]


def all_of(R, omega, x, v):
    """Return what is observed of a tossed body, (18,): R (3, 3) by rows, ω in the world, place, velocity."""
    return np.concatenate((np.ravel(R), omega, x, v))


def world_rate(R, L, I):
    """Return ω in the world of a body with the angular momentum L."""
    return R @ ((R.T @ L) / I)


@cache
def tossed_turn(body, T):
    """Return SciPy's dense solution (t) → (R (9), L (3)) by DOP853 at 1e-12."""
    I = np.array(body.I)

    def slope(t, y):
        R = y[:9].reshape(3, 3)
        return np.concatenate((np.cross(world_rate(R, y[9:], I), R.T).T.ravel(), np.zeros(3)))
    start = np.concatenate((np.eye(3).ravel(), I * body.omega))
    return solve_ivp(slope, (0.0, T), start, "DOP853", rtol=RTOL, atol=ATOL, dense_output=True).sol


def tossed(body, t, T):
    """Return what is observed at t ≤ T: Euler's equations, and the parabola."""
    y = tossed_turn(body, T)(t)
    R, v, g = y[:9].reshape(3, 3), np.array(body.v), np.array(body.gravity)
    return all_of(R, world_rate(R, y[9:], np.array(body.I)), v * t + 0.5 * g * t * t, v + g * t)


def predict_tossed(T, body_of, turn, ahead, floor):
    """Return the field `predicted` of a Runner that turns a tossed body by a Turn.

    ahead: how far it is ahead in its fall, in units of ½ g dt t: 1 for symplectic Euler, 0 for an exact parabola.
    """
    @cache
    def error_law(p):
        body, I = body_of(p), np.array(body_of(p).I)

        def run(steps, nudge):
            h = T / steps
            q, L = (1.0 + 0j, 0j), tuple(map(float, I * body.omega + nudge * np.array((0.5, -0.3, 0.8))))
            for _ in range(steps):
                q, L = turn.step(turns.no_torque, q, L, body.I, h)
            R, v, g = np.array(turns.matrix(q)).reshape(3, 3), np.array(body.v), np.array(body.gravity)
            return all_of(R, world_rate(R, np.array(L), I), v * T + 0.5 * g * T * (T + ahead * h), v + g * T)
        return ErrorLaw(run, tossed(body, T, T), turn.powers or turn.order, T, turns.FINEST[turn.order],
                        turns.DOUBLINGS[turn.order])

    def predicted_error(p, dt):
        """The error, with its sign, of the same rotation written independently in complex numbers, and of the fall.

        It is taken at the same step where that is coarse, else by its expansion in powers of dt.
        """
        return error_law(p).prediction(dt, floor(p, dt))
    return predicted_error


def box_error(outputs, start, I, m, gravity):
    """Return the largest relative error of angular momentum or of energy, whichever is larger, at all outputs.

    Source: scpeters/benchmark, `boxes`: |L − L₀|/|L₀| and (E − E₀)/E₀.
    """
    def invariants(y):
        R, omega, x, v = y[:9].reshape(3, 3), y[9:12], y[12:15], y[15:]
        L = R @ (I * (R.T @ omega))
        return L, 0.5 * omega @ L + 0.5 * m * v @ v - m * np.dot(gravity, x)
    L_0, E_0 = invariants(start)
    found = [invariants(y) for y in outputs]
    return float(max(max(np.linalg.norm(L - L_0) / np.linalg.norm(L_0), abs(E - E_0) / abs(E_0)) for L, E in found))


# ---------------------------------------------------------------------------------------------- Bricard's mechanism

@cache
def bricard_angle(g, T):
    """Return SciPy's dense solution (t) → (ψ, ψ̇) of Bricard's mechanism, released from the cube, by DOP853 at 1e-12.

    The same equation as in `bricard_motion`:  I(ψ) ψ̈ + ½ I′ ψ̇² + V′ = 0.
    """
    moments = np.where(EDGES[:5] != 0.0, THICK, 1.0) / 12.0

    def slope(_, y):
        x, v, w = bricard_state(y[0] + 1e-30j)
        I, V = np.sum(v * v) + np.sum(moments * w * w), g * np.sum(x[:, 1])
        return y[1], -(0.5 * I.imag * y[1] ** 2 + V.imag) / 1e-30 / I.real
    return solve_ivp(slope, (0.0, T), (np.arctan(np.sqrt(2.0)), 0.0), "DOP853", rtol=RTOL, atol=ATOL,
                     dense_output=True).sol


def joints_3d(made):
    """Return (gaps(x, R), rows(R), impulses(left, right, R, u)) of the joints of a Mechanism in space.

    x (n, 3), and R (n + 1, 3, 3) with that of the world.  impulses: (n, 6) on the bodies, at the rows `right`, that add
    −u at the rows `left`, by least squares, in which rows may depend on each other.
    """
    n, W, I = len(made.m) - 1, 1.0 / made.m[:-1], made.inertia[:-1]
    a, b = made.a, made.b
    own = [made.places - made.x[body] for body in (a, b)]                # all begin without a rotation

    def arms(R):
        return [np.einsum("kij,kj->ki", R[body], r) for r, body in zip(own, (a, b))]

    def gaps(x, R):
        x = np.vstack((x, np.zeros(3)))
        r_a, r_b = arms(R)
        return (x[a] + r_a - x[b] - r_b).ravel()

    def rows(R):
        G = np.zeros((len(a), 3, n + 1, 6))
        for sign, body, arm in zip((1.0, -1.0), (a, b), arms(R)):
            for k, r in enumerate(arm):
                G[k, :, body[k], :3], G[k, :, body[k], 3:] = sign * np.eye(3), sign * np.cross(np.eye(3), r).T
        return G[:, :, :n].reshape(3 * len(a), 6 * n)

    def over_mass(R, J):
        J = J.reshape(n, 6, -1)
        turned = np.einsum("kij,kj,klj,klm->kim", R[:n], 1.0 / I, R[:n], J[:, 3:])
        return np.concatenate((W[:, None, None] * J[:, :3], turned), axis=1).reshape(6 * n, -1)

    def impulses(left, right, R, u):
        return (right.T @ np.linalg.lstsq(left @ over_mass(R, right.T), -u, rcond=1e-10)[0]).reshape(n, 6)
    return gaps, rows, impulses


def rattle_3d(made, gravity, h, steps):
    """Return centres (n, 3) of a Mechanism in space that was released at rest, after steps of RATTLE.

    Bodies turn by the splitting of `turns.py`.  The last body is the world.
    """
    n, W, I = len(made.m) - 1, 1.0 / made.m[:-1, None], made.inertia[:-1]
    gaps, rows, impulses = joints_3d(made)
    small = 10.0 * CLOSED * np.max(np.abs(made.places))
    frames = lambda q: np.array([turns.matrix(one) for one in q] + [np.eye(3)])
    moved = lambda q, L: [turns.free_splitting(one, tuple(l), tuple(i), h) for one, l, i in zip(q, L, I)]
    x, q, v, L = made.x[:n], [(1.0 + 0j, 0j)] * n, np.zeros((n, 3)), np.zeros((n, 3))
    for _ in range(steps):
        v, R = v + 0.5 * h * gravity, frames(q)
        here = rows(R)
        for _ in range(CORRECTIONS):
            end = frames(moved(q, L))
            gap = gaps(x + h * v, end)
            if np.max(np.abs(gap)) <= small:
                break
            J = impulses(rows(end), here, R, gap / h)
            v, L = v + W * J[:, :3], L + J[:, 3:]
        x, q = x + h * v, moved(q, L)
        v, R = v + 0.5 * h * gravity, frames(q)
        there = rows(R)
        rates = np.hstack((v, np.array([world_rate(R[k], L[k], I[k]) for k in range(n)]))).ravel()
        J = impulses(there, there, R, there @ rates)
        v, L = v + W * J[:, :3], L + J[:, 3:]
    return x


def predict_bricard(T, truth, floor):
    """Return the field `predicted` of a Runner that moves Bricard's mechanism by RATTLE."""
    @cache
    def error_law(p):
        def run(steps, nudge):
            return rattle_3d(bricard(), np.array([0.0, -p.g * (1.0 + nudge), 0.0]), T / steps, steps).ravel()
        return ErrorLaw(run, truth(p, T), EVEN[2], T, 200, 1)

    def predicted_error(p, dt):
        """The error, with its sign, of an independent program of the same step: joints by least squares, rotations in
        complex numbers.  It is taken at the same step where that is coarse, else by its expansion in powers of dt.
        """
        return error_law(p).prediction(dt, floor(p, dt))
    return predicted_error
