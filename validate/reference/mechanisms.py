"""Reference solutions for mechanisms, whose joints form closed loops; independent of the lessons."""

from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import block_diag

RTOL, ATOL = 1e-12, 1e-13
ZERO = 1e-10                 # a singular value below this fraction of the largest counts as 0 [-]


class Mechanism(NamedTuple):
    """n bodies, the last of which is the world and has infinite mass; in space all begin without rotation."""
    x: np.ndarray            # (n, d) centres [m]
    q: np.ndarray            # (n,) angles [rad], or (n, 4) unit quaternions
    v: np.ndarray            # (n, d) [m/s]
    omega: np.ndarray        # (n,) or (n, 3) [rad/s]
    m: np.ndarray            # (n,) [kg]
    inertia: np.ndarray      # (n,) or (n, 3) principal moments [kg m²]
    a: np.ndarray            # (k,) a body of each joint
    b: np.ndarray            # (k,) the other body
    places: np.ndarray       # (k, d) of the joints at the start [m]


def mechanism_2d(x, q, m, inertia, joints):
    """Make a Mechanism at rest in the plane; the world is added as the last body, at the origin.

    joints: (body, other body, place) of each; body −1 is the world.
    """
    n = len(x)
    a, b, places = zip(*joints)
    return Mechanism(np.vstack((x, np.zeros(2))), np.append(q, 0.0), np.zeros((n + 1, 2)), np.zeros(n + 1),
                     np.append(m, np.inf), np.append(inertia, np.inf), np.mod(a, n + 1), np.mod(b, n + 1),
                     np.array(places, float))


def mechanism_3d(x, m, inertia, joints):
    """Make a Mechanism at rest in space."""
    n = len(x)
    a, b, places = zip(*joints)
    return Mechanism(np.vstack((x, np.zeros(3))), np.tile([1.0, 0.0, 0.0, 0.0], (n + 1, 1)), np.zeros((n + 1, 3)),
                     np.zeros((n + 1, 3)), np.append(m, np.inf), np.vstack((inertia, np.full(3, np.inf))),
                     np.mod(a, n + 1), np.mod(b, n + 1), np.array(places, float))


# ---------------------------------------------------------------------------------------------- any mechanism

def matrices(q):
    """Return rotations (n, d, d) from angles (n,) or unit quaternions (n, 4)."""
    if q.ndim == 1:
        return np.moveaxis(np.array([[np.cos(q), -np.sin(q)], [np.sin(q), np.cos(q)]]), 2, 0)
    w, r = q[:, 0], q[:, 1:]
    return np.array([(w * w - r @ r) * np.eye(3) + 2.0 * np.outer(r, r) + 2.0 * w * np.cross(r, np.eye(3)).T
                     for w, r in zip(w, r)])


def constraints(mechanism, q, omega):
    """Return (G, c) with which the points of the joints have the relative velocities G u and accelerations G u̇ + c.

    u = (v, ω) of one body after the other; d rows for each joint.
    """
    d, turns = mechanism.x.shape[1], 1 if q.ndim == 1 else 3
    n, k, size = len(mechanism.m), len(mechanism.a), d + turns
    G, c = np.zeros((d * k, size * n)), np.zeros(d * k)
    R, begun = matrices(q), matrices(mechanism.q)
    for j in range(k):
        rows = slice(d * j, d * j + d)
        for body, sign in ((mechanism.a[j], 1.0), (mechanism.b[j], -1.0)):
            r = R[body] @ begun[body].T @ (mechanism.places[j] - mechanism.x[body])
            spin = np.array([[-r[1]], [r[0]]]) if d == 2 else np.cross(np.eye(3), r).T           # ω × r
            bent = -omega[body] ** 2 * r if d == 2 else np.cross(omega[body], np.cross(omega[body], r))
            G[rows, size * body:size * body + size] += sign * np.hstack((np.eye(d), spin))
            c[rows] += sign * bent
    return G, c


def inverse_mass_matrix(mechanism, q):
    """Return M⁻¹ with the blocks 1/m and R diag(1/I) Rᵀ of one body after the other."""
    blocks, R = [], matrices(q)
    for i, (m, inertia) in enumerate(zip(mechanism.m, mechanism.inertia)):
        turns = np.array([[1.0 / inertia]]) if q.ndim == 1 else R[i] @ np.diag(1.0 / inertia) @ R[i].T
        blocks += [np.eye(mechanism.x.shape[1]) / m, turns]
    return block_diag(*blocks)


def solved(mechanism, q, u, F):
    """Return (u̇, forces (k, d) [N] of the joints on bodies a) under loads F = (force, torque) of all bodies.

    The pseudo-inverse of G M⁻¹ Gᵀ, by singular values, gives the forces of smallest norm where many are possible.
    """
    d, n = mechanism.x.shape[1], len(mechanism.m)
    W, rows = inverse_mass_matrix(mechanism, q), u.reshape(n, -1)
    omega, free = (rows[:, 2] if d == 2 else rows[:, 3:]), W @ F
    if d == 3:
        for i in range(n - 1):                                           # −I⁻¹ (ω × I ω)
            inverse = W[6 * i + 3:6 * i + 6, 6 * i + 3:6 * i + 6]
            free[6 * i + 3:6 * i + 6] -= inverse @ np.cross(omega[i], np.linalg.solve(inverse, omega[i]))
    G, c = constraints(mechanism, q, omega)
    forces = -np.linalg.pinv(G @ W @ G.T, ZERO) @ (G @ free + c)
    return free + W @ G.T @ forces, forces.reshape(-1, d)


def consistent(mechanism, u):
    """Return the velocities u at the start, without the part that the joints do not allow."""
    W = inverse_mass_matrix(mechanism, mechanism.q)
    G, _ = constraints(mechanism, mechanism.q, 0.0 * mechanism.omega)
    return u - W @ G.T @ np.linalg.pinv(G @ W @ G.T, ZERO) @ G @ u


def motion(mechanism, u, F, T):
    """Return (x, q, u) after T under constant loads F, in all coordinates of all bodies, by DOP853.

    No correction closes the joints.  With these tolerances they open by round-off only.
    """
    n, d = mechanism.x.shape
    ends = np.cumsum([mechanism.x.size, mechanism.q.size])

    def slope(_, y):
        _, q, u = np.split(y, ends)
        q = q.reshape(mechanism.q.shape)
        rows = u.reshape(n, -1)
        turning = rows[:, 2] if d == 2 else np.array([half_product(w, r) for w, r in zip(rows[:, 3:], q)]).ravel()
        return np.concatenate((rows[:, :d].ravel(), turning, solved(mechanism, q, u, F)[0]))
    y = solve_ivp(slope, (0.0, T), np.concatenate((mechanism.x.ravel(), mechanism.q.ravel(), u)), "DOP853", rtol=RTOL,
                  atol=ATOL).y[:, -1]
    x, q, u = np.split(y, ends)
    return x.reshape(n, d), q.reshape(mechanism.q.shape), u


def half_product(omega, q):
    """Return ½ (0, ω) q: the rate of a quaternion."""
    return 0.5 * np.append(-omega @ q[1:], q[0] * omega + np.cross(omega, q[1:]))


# ---------------------------------------------------------------------------------------------- four-bars

def four_bars(loops, angle, omega, masses=None):
    """Return the Mechanism of loops + 1 cranks, side by side on the ground, and couplers between their tops.

    All rods are uniform and 1 m long.  Their mass is 1 kg, or (crank, coupler, crank …).  Rows of the constraints
    alternate in the same way, so that only neighbouring joints share a body.  Source: IFToMM benchmark A02.
    """
    along, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    m = np.ones(2 * loops + 1) if masses is None else np.asarray(masses, float)
    feet = np.stack((np.arange(loops + 1.0), np.zeros(loops + 1)), axis=1)
    x, q, v, joints = [], [], [], []
    for i, foot in enumerate(feet):
        x, q, v = [*x, foot + 0.5 * along], [*q, angle], [*v, 0.5 * omega * across]
        joints.append((2 * i, -1, foot))
        if i > 0:
            joints.append((2 * i - 1, 2 * i, foot + along))
        if i < loops:
            joints.append((2 * i, 2 * i + 1, foot + along))
            x, q, v = [*x, foot + along + [0.5, 0.0]], [*q, 0.0], [*v, omega * across]
    spins = np.where(np.arange(2 * loops + 2) % 2 == 0, omega, 0.0)
    spins[-1] = 0.0
    return mechanism_2d(x, q, m, m / 12.0, joints)._replace(v=np.vstack((v, np.zeros(2))), omega=spins)


def four_bars_motion(mechanism, g, t):
    """Return (angle, rate) of the cranks of four_bars at t; all cranks stay parallel, so one angle describes them.

    I θ̈ = −G cos θ,   I = Σ m/3 of the cranks + Σ m of the couplers
    G = (Σ ½ m of the cranks + Σ m of the couplers) g
    """
    cranks, couplers = np.sum(mechanism.m[:-1:2]), np.sum(mechanism.m[1:-1:2])
    rate = (0.5 * cranks + couplers) * g / (cranks / 3.0 + couplers)
    return solve_ivp(lambda _, y: (y[1], -rate * np.cos(y[0])), (0.0, t), (mechanism.q[0], mechanism.omega[0]),
                     "DOP853", rtol=RTOL, atol=ATOL).y[:, -1]


# ---------------------------------------------------------------------------------------------- Bricard's mechanism

CUBE = np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (1.0, 1.0, 1.0), (0.0, 1.0, 1.0), (0.0, 0.0, 1.0)])
EDGES = np.roll(CUBE, -1, axis=0) - CUBE     # rod k from corner k to corner k + 1; the last is the ground
AXES = np.cross(np.roll(EDGES, 1, axis=0), EDGES)        # of hinge k, between rods k − 1 and k
THICK = 1e-3                 # moment of a rod about its axis over that across [-]


def bricard():
    """Return the Mechanism of five rods of 1 m and 1 kg on six hinges, each of two points on its axis.

    The rods lie along edges of a cube.  By counting constraints it has no degree of freedom, and yet it moves: its
    constraints depend on each other in every position.  Source: Bricard 1897; IFToMM benchmark A04.
    """
    joints = [(k - 1 if k > 0 else -1, k if k < 5 else -1, CUBE[k] + side * AXES[k])
              for k in range(6) for side in (0.5, -0.5)]
    return mechanism_3d(CUBE[:5] + 0.5 * EDGES[:5], np.ones(5), np.where(EDGES[:5] != 0.0, THICK, 1.0) / 12.0, joints)


def bricard_state(psi):
    """Return (centres (5, 3), their rates, angular rates (5, 3) in the bodies), rates by ψ.

    The hinges turn by θ, φ, θ, φ, θ, φ with cos θ + cos φ + cos θ cos φ = 0, which is cos ½θ cos ½φ = ½: the legs ½θ
    and ½φ of a right-angled spherical triangle with the hypotenuse 60°.  Its angle ψ passes through every position:
    tan ½θ = √3 cos ψ, sin ½φ = ½√3 sin ψ.  ψ may be complex, for derivatives.
    Source of the closure: Chen, You and Tarnai 2005.
    """
    root = np.sqrt(3.0)
    angles = [2.0 * np.arctan(root * np.cos(psi)), 2.0 * np.arcsin(0.5 * root * np.sin(psi))] * 3
    rates = [-2.0 * root * np.sin(psi) / (1.0 + 3.0 * np.cos(psi) ** 2),
             root * np.cos(psi) / np.sqrt(1.0 - 0.75 * np.sin(psi) ** 2)] * 3
    R, x, v, w, found = np.eye(3), CUBE[0], np.zeros(3), np.zeros(3), []
    for k in range(5):
        K = np.cross(AXES[k], np.eye(3)).T
        turn = angles[k] - 0.5 * np.pi
        w = w + rates[k] * (R @ AXES[k])
        R = R @ (np.eye(3) + np.sin(turn) * K + (1.0 - np.cos(turn)) * K @ K)
        along = R @ EDGES[k]
        found.append((x + 0.5 * along, v + 0.5 * np.cross(w, along), R.T @ w))
        x, v = x + along, v + np.cross(w, along)
    return tuple(np.array(part) for part in zip(*found))


def bricard_motion(g, t):
    """Return (centres (5, 3) [m] at t, ψ, ψ̇), released from the cube, with gravity along −y.

    Lagrange's equation for ψ is  I(ψ) ψ̈ + ½ I′ ψ̇² + V′ = 0,  with derivatives by complex steps.
    """
    moments = np.where(EDGES[:5] != 0.0, THICK, 1.0) / 12.0

    def slope(_, y):
        x, v, w = bricard_state(y[0] + 1e-30j)
        I, V = np.sum(v * v) + np.sum(moments * w * w), g * np.sum(x[:, 1])
        return y[1], -(0.5 * I.imag * y[1] ** 2 + V.imag) / 1e-30 / I.real
    psi, rate = solve_ivp(slope, (0.0, t), (np.arctan(np.sqrt(2.0)), 0.0), "DOP853", rtol=RTOL, atol=ATOL).y[:, -1]
    return bricard_state(psi)[0], psi, rate


# ---------------------------------------------------------------------------------------------- Andrews' squeezer

SECONDS = 0.03               # of the problem [s]
TORQUE, STIFFNESS, REST = 0.033, 4530.0, 0.07785             # on body 0 [N m]; of the spring [N/m], [m]
FIXED = {"O": np.zeros(2), "A": np.array([-0.06934, -0.00227]), "B": np.array([-0.03635, 0.03273]),
         "C": np.array([0.014, 0.072])}
# β, Θ, γ, Φ, δ, Ω, ε at the start, after 0.03 s, and their rates then, as published [rad, rad/s]
ANDREWS_START = np.array([-0.0617138900142764496, 0.0, 0.455279819163070380, 0.222668390165885885, 0.487364979543842550,
                          -0.222668390165885885, 1.23054744454982120])
ANDREWS_END = np.array([15.81077119629904, -15.75637105984298, 0.04082224013073101, -0.5347301163226948,
                        0.5244099658805304, 0.5347301163226948, 1.048080741042263])


def andrews():
    """Return the Mechanism of seven bodies on ten hinges, with three closed loops, driven by a torque and a spring.

    Source: problem “Andrews” of the test set for initial value problems of Bari (Mazzia and Magherini 2008).
    """
    e = lambda angle: np.array([np.cos(angle), np.sin(angle)])
    n = lambda angle: np.array([np.sin(angle), -np.cos(angle)])
    beta, theta, gamma, phi, delta, omega, epsilon = ANDREWS_START
    F = 0.007 * e(beta)
    at = {**FIXED, "F": F, "E": F - 0.028 * e(beta + theta), "G": FIXED["A"] + 0.04 * e(delta),
          "H": FIXED["A"] + 0.04 * n(epsilon)}
    x = [0.00092 * e(beta), F - 0.0115 * e(beta + theta), FIXED["B"] + 0.01874 * n(gamma) + 0.01043 * e(gamma),
         at["G"] + 0.00579 * n(phi + delta), FIXED["A"] + 0.02308 * e(delta) - 0.00916 * n(delta),
         at["H"] + 0.00579 * e(omega + epsilon), FIXED["A"] + 0.01228 * n(epsilon) - 0.00449 * e(epsilon)]
    hinges = [(0, -1, "O"), (0, 1, "F"), (1, 2, "E"), (2, -1, "B"), (1, 3, "E"), (3, 4, "G"), (4, -1, "A"), (1, 5, "E"),
              (5, 6, "H"), (6, -1, "A")]
    return mechanism_2d(x, [beta, beta + theta, gamma, phi + delta, delta, omega + epsilon, epsilon],
                        [0.04325, 0.00365, 0.02373, 0.00706, 0.0705, 0.00706, 0.05498],
                        [2.194e-6, 4.41e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5],
                        [(a, b, at[name]) for a, b, name in hinges])


def andrews_load(t, x, q, v, omega, p):
    """Return the forces and torques of all bodies: the torque on body 0, and the spring from C to a point of body 2."""
    F, tau = np.zeros(x.shape), np.zeros(omega.shape)
    c, s = np.cos(q[2]), np.sin(q[2])
    out, up = 0.02 - 0.01043, 0.01874 - 0.018                # from the centre to the point, along e(γ) and −n(γ)
    hook = np.array([out * c - up * s, out * s + up * c])
    way = x[2] + hook - FIXED["C"]
    length = np.hypot(way[0], way[1])
    F[2] = -STIFFNESS * (length - REST) / length * way
    tau[0], tau[2] = TORQUE, hook[0] * F[2, 1] - hook[1] * F[2, 0]
    return F, tau


def andrews_angles(q):
    """Return the seven angles of the problem, computed from those of the bodies."""
    return np.array([q[0], q[1] - q[0], q[2], q[3] - q[4], q[4], q[5] - q[6], q[6]])
