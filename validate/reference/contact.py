"""Reference solutions for the scenes of lesson 9: many contacts, without the lesson's sweeps, matrices and piles."""

from functools import cache
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq, linprog, nnls

# ---------------------------------------------------------------------- a heavy body on a light one


def sweeps_needed(r, omega, small):
    """Return the number of relaxed sweeps from zero after which two forces have a relative error below `small`.

    A body of mass r stands on a body of mass 1.  The forces are F = ((1 + r) g, r g), from below.  The errors
    e = λ/F − 1 obey, with the lower contact first,

        e₀' = (1 − ω) e₀ + ω r/(1 + r) e₁,      e₁' = (1 − ω) e₁ + ω e₀'

    and start at −1.  (The force needed to stop the approach of the upper contact is r/(1 + r) of λ₀, and
    F₁ = r/(1 + r) F₀.)  With ω = 1 both are −ρᵏ after k sweeps, with ρ = r/(1 + r): k = ln(small)/ln ρ.
    """
    if omega == 1.0:
        return np.ceil(-np.log(small) / np.log1p(1.0 / r))
    e, done = (-1.0, -1.0), 0
    while max(abs(e[0]), abs(e[1])) > small:
        lower = (1.0 - omega) * e[0] + omega * r / (1.0 + r) * e[1]
        e, done = (lower, (1.0 - omega) * e[1] + omega * lower), done + 1
    return float(done)


# ---------------------------------------------------------------------- a semicircular arch of stones

class Arch(NamedTuple):
    """n equal stones, sectors of a ring of mean radius 1 and thickness t, from the right springing to the left one."""
    x: np.ndarray            # (n, 2) centres of mass
    m: np.ndarray            # (n,) masses, of density 1
    inertia: np.ndarray      # (n,) about the centres
    joints: np.ndarray       # (n + 1,) angles of the joints [rad]; joint k is below stone k and above stone k − 1
    radii: tuple             # inner and outer


def arch(n, t):
    """Return the Arch.

    A sector of half angle α between the radii r and R has the area (R² − r²) α, its centre of mass at
    ⅔ (R³ − r³)/(R² − r²) · sin α/α, and (R² + r²)/2 of its area as moment about the centre of the ring.
    """
    r, R, alpha = 1.0 - 0.5 * t, 1.0 + 0.5 * t, 0.5 * np.pi / n
    centre = 2.0 / 3.0 * (R**3 - r**3) / (R**2 - r**2) * np.sin(alpha) / alpha
    middle, area = (2.0 * np.arange(n) + 1.0) * alpha, (R**2 - r**2) * alpha
    x = centre * np.stack((np.cos(middle), np.sin(middle)), axis=1)
    inertia = area * (0.5 * (R**2 + r**2) - centre**2)
    return Arch(x, np.full(n, area), np.full(n, inertia), 2.0 * alpha * np.arange(n + 1), (r, R))


def arch_holds(n, t, mu):
    """Return whether forces exist that hold the arch: a linear program, after Heyman's safe theorem.

    Each joint pushes at its inner and outer end with f_n ≥ 0 and |f_t| ≤ μ f_n.  Every stone is in balance: two
    forces, one moment.  The program has no objective; SciPy's HiGHS reports whether it has a solution.
    """
    stones = arch(n, t)
    balance, cone = np.zeros((n, 3, n + 1, 2, 2)), np.zeros((n + 1, 2, 2, n + 1, 2, 2))
    for k, theta in enumerate(stones.joints):
        outward = np.array([np.cos(theta), np.sin(theta)])
        along = np.array([-outward[1], outward[0]])                      # the normal of the joint, to stone k
        for end, radius in enumerate(stones.radii):
            for part, d in enumerate((along, outward)):
                for stone, sign in ((k, 1.0), (k - 1, -1.0)):
                    if 0 <= stone < n:
                        arm = radius * outward - stones.x[stone]
                        balance[stone, :, k, end, part] = sign * np.array([*d, arm[0] * d[1] - arm[1] * d[0]])
            cone[k, end, :, k, end] = [(-mu, 1.0), (-mu, -1.0)]
    load = np.zeros((n, 3))
    load[:, 1] = stones.m / np.sum(stones.m)
    unknowns = 4 * (n + 1)
    found = linprog(np.zeros(unknowns), cone.reshape(-1, unknowns), np.zeros(unknowns),
                    balance.reshape(-1, unknowns), load.ravel(), [(0.0, None), (None, None)] * (2 * (n + 1)),
                    options={"primal_feasibility_tolerance": 1e-10})
    return found.status == 0


def bisected(holds, falls, safe, width):
    """Return the number at which `holds` turns True between two numbers, to the relative `width`."""
    while abs(safe - falls) > width * safe:
        middle = 0.5 * (falls + safe)
        falls, safe = (falls, middle) if holds(middle) else (middle, safe)
    return 0.5 * (falls + safe)


@cache
def least_thickness(n, mu):
    """Return the smallest t/R at which the arch stands, to 1e-8."""
    return bisected(lambda t: arch_holds(n, t, mu), 0.02, 0.5, 1e-8)


@cache
def least_friction(n, t):
    """Return the smallest μ at which the arch stands, to 1e-8."""
    return bisected(lambda mu: arch_holds(n, t, mu), 0.05, 2.0, 1e-8)


def hinged_thickness(n):
    """Return the smallest t/R of an even number of stones by moments about hinges, for sufficient friction.

    Consider half of the arch, with a joint at the crown.  The thrust H enters at the outer end of the crown.  It
    must hold the part above each joint β (from the crown) about its inner end, and must not overturn the half about
    the outer end of the springing.  With W(β) the weight of that part and M(β) its moment about the crown:

        H (R − r cos β) ≥ W r sin β − M  for all joints,      H R ≤ W R − M  at β = 90°

    *Source:* Couplet 1730, Milankovitch 1907; Heyman 1969.
    """
    def spare(t):
        r, R = 1.0 - 0.5 * t, 1.0 + 0.5 * t
        beta = np.pi / n * np.arange(1, n // 2 + 1)
        W, M = 0.5 * (R**2 - r**2) * beta, (R**3 - r**3) / 3.0 * (1.0 - np.cos(beta))
        return (W[-1] * R - M[-1]) / R - np.max((W * r * np.sin(beta) - M) / (R - r * np.cos(beta)))
    return brentq(spare, 0.02, 0.5, xtol=1e-14)


# ---------------------------------------------------------------------- a judge of impulses from any solver

def in_space(vectors):
    """Return vectors (m, 2) with a third coordinate 0; return vectors (m, 3) unchanged."""
    vectors = np.asarray(vectors, dtype=float)
    return np.pad(vectors, ((0, 0), (0, 3 - vectors.shape[1])))


def turning(omega, inv_inertia):
    """Return (ω (n, 3), I⁻¹ (n, 3, 3)) of bodies in the plane, ω (n,) and I⁻¹ (n,); return those in space unchanged."""
    omega, inv_inertia = np.asarray(omega, dtype=float), np.asarray(inv_inertia, dtype=float)
    if omega.ndim == 2:
        return omega, inv_inertia
    about_z = np.array([0.0, 0.0, 1.0])
    return omega[:, None] * about_z, inv_inertia[:, None, None] * np.outer(about_z, about_z)


def relative_motion(bodies, a, b, p_a, p_b):
    """Return u (c, 3) [m/s] of contacts at p_a on body a and at p_b on body b; bodies = (x, v, ω), each (n, 3)."""
    x, v, omega = bodies
    return v[a] + np.cross(omega[a], p_a - x[a]) - v[b] - np.cross(omega[b], p_b - x[b])


def inverse_masses_at(inverse, x, contacts):
    """Return (k_n (c,), k_t (c,)) [1/kg] of contacts: effective inverse masses along n, and at most across it.

    The arguments are those of natural_parts.  k_t is the trace of the contact's matrix minus k_n.
    """
    (inv_mass, inv_inertia), (a, b, n, p_a, p_b) = inverse, contacts
    k_n, trace = np.zeros(len(n)), np.zeros(len(n))
    for body, p in ((a, p_a), (b, p_b)):
        r = p - x[body]
        lever = np.cross(r, n)
        k_n += inv_mass[body] + np.einsum("ki,kij,kj->k", lever, inv_inertia[body], lever)
        around = np.trace(inv_inertia[body], axis1=1, axis2=2)
        trace += (3.0 * inv_mass[body] + np.sum(r**2, axis=1) * around
                  - np.einsum("ki,kij,kj->k", r, inv_inertia[body], r))
    return k_n, trace - k_n


def natural_parts(inverse, x, u, contacts, gap, J, mu, dt, axes=None):
    """Return the residuals (c,), (c,) [m/s] of Signorini's and of Coulomb's law at each contact: see natural_residual.

    inverse = (inverse masses (n,), inverse moments (n, 3, 3));    u (c, 3) relative velocities after the step;
    contacts = (a, b, n, p_a, p_b), where the impulses act on a and on b;    axes (c, 2, 3): friction is a pyramid,
    with each component at most μ J_n;    None: it is a cone
    """
    n, (k_n, k_t) = contacts[2], inverse_masses_at(inverse, x, contacts)
    J_n, u_n = np.sum(n * J, axis=1), np.sum(n * u, axis=1)
    J_t, u_t = J - J_n[:, None] * n, u - u_n[:, None] * n
    pushed = np.maximum(0.0, J_n - (u_n + np.maximum(gap, 0.0) / dt) / k_n)
    stuck, limit = J_t - u_t / k_t[:, None], mu * np.maximum(J_n, 0.0)
    if axes is None:
        size = np.linalg.norm(stuck, axis=1)
        held = stuck * np.where(size > limit, limit / np.where(size > 0.0, size, 1.0), 1.0)[:, None]
    else:
        along = np.einsum("cad,cd->ca", axes, stuck)
        held = np.einsum("cad,ca->cd", axes, np.clip(along, -limit[:, None], limit[:, None]))
    return k_n * np.abs(pushed - J_n), k_t * np.linalg.norm(held - J_t, axis=1)


def natural_residual(bodies, contacts, J, mu, dt):
    """Return the residual [m/s] of the laws of Signorini and Coulomb for impulses J (m, d) of a step dt, d = 2 or 3.

    bodies = (x, v, ω, inverse masses, inverse moments) after the step.  contacts = (a, b, n, p, gap), n from b to a.
    With the relative velocity u of a contact, and k_n and k_t its effective inverse masses, the laws hold where

        J_n = max(0, J_n − (u_n + max(gap, 0)/dt)/k_n)
        J_t = the point of the disc |J_t| ≤ μ J_n that is nearest to J_t − u_t/k_t

    The residual is the largest k_n or k_t times the distance of the two sides.  k_t may be any positive number; here it
    is the trace of the contact's matrix minus k_n.  The lesson's residual uses matrices instead.
    *Source:* the natural map; Acary and Brogliato 2008.
    """
    (x, v, omega, inv_mass, inv_inertia), (a, b, n, p, gap) = bodies, contacts
    x, v, n, p, J = (in_space(each) for each in (x, v, n, p, J))
    omega, inv_inertia = turning(omega, inv_inertia)
    u = relative_motion((x, v, omega), a, b, p, p)
    parts = natural_parts((inv_mass, inv_inertia), x, u, (a, b, n, p, p), gap, J, mu, dt)
    return max(np.max(each, initial=0.0) for each in parts)


def enumerated(A, b):
    """Return λ ≥ 0 with A λ + b ≥ 0 and λ ⊥ A λ + b, by trying all sets of active contacts; NaN if there is none."""
    for number in range(2 ** len(b)):
        on = np.array([bool(number >> k & 1) for k in range(len(b))])
        lam = np.zeros(len(b))
        lam[on] = np.linalg.solve(A[np.ix_(on, on)], -b[on])
        if np.all(lam >= 0.0) and np.all(A @ lam + b >= -1e-12 * np.max(np.abs(b))):
            return lam
    return np.full(len(b), np.nan)


# ---------------------------------------------------------------------- a tower that settles on soft contacts

class Settling(NamedTuple):
    """Settings for a tower of boxes that settles."""
    dt: float                # [s]
    substeps: int            # per step
    hertz: float             # of the soft contacts [1/s]
    zeta: float              # their damping ratio [-]
    mu: float                # friction [-]
    seconds: float           # [s]


@cache
def sway_of_tower(masses, size, g, how):
    """Return the relative error of the forces in the joints of a tower, after this many seconds of soft contacts.

    Boxes of that size stand on each other without a gap, and sink onto their soft contacts.  The equations are
    linear in the motion (x, y, θ) of each box, because it moves by less than 1e-4 of its size.  A joint therefore
    keeps the same two corners, with constant lever arms and normals.  The recursion consists of the sweeps, first
    those of soft contacts and then those at rest.  A pile numbers the two corners above the lowest box first, then
    those below it, then the others upwards.  It visits number 0, 5, 10, …, then 1, 6, 11, … and so on, which makes
    the tower rock.  Nothing of the lesson is used.
    """
    m = np.asarray(masses, dtype=float)
    n, h = len(m), how.dt / how.substeps
    w = np.stack((1.0 / m, 1.0 / m, 6.0 / (m * size**2)), axis=1).ravel()
    N, along = np.zeros((2 * n, 3 * n)), np.zeros((2 * n, 3 * n))        # rows of u_n and u_t
    for c in range(2 * n):
        k, x = c // 2, (c % 2 - 0.5) * size
        for body, sign in ((k, 1.0), (k - 1, -1.0)):
            if body >= 0:
                y = (k - body - 0.5) * size
                N[c, 3 * body:3 * body + 3] = sign * np.array((0.0, 1.0, x))
                along[c, 3 * body:3 * body + 3] = sign * np.array((1.0, 0.0, -y))
    k_n, k_t = np.sum(N * w * N, axis=1), np.sum(along * w * along, axis=1)
    s = 2.0 * np.pi * how.hertz * h
    numbered = [*range(2, min(4, 2 * n)), 0, 1, *range(4, 2 * n)]
    visited = [c for first in range(5) for c in numbered[first::5]]
    push, soft = s / (h * (2.0 * how.zeta + s)), 1.0 / (s * (2.0 * how.zeta + s))
    q, v, J_n, J_t = np.zeros(3 * n), np.zeros(3 * n), np.zeros(2 * n), np.zeros(2 * n)

    def sweep(v, aim, give):
        for c in visited:
            new = max(0.0, J_n[c] + (aim[c] - N[c] @ v - give[c] * k_n[c] * J_n[c]) / (k_n[c] * (1.0 + give[c])))
            held = min(max(J_t[c] - along[c] @ v / k_t[c], -how.mu * new), how.mu * new)
            v = v + w * ((new - J_n[c]) * N[c] + (held - J_t[c]) * along[c])
            J_n[c], J_t[c] = new, held
        return v

    for _ in range(round(how.seconds / how.dt) * how.substeps):
        gap = N @ q
        aim = np.where(gap > 0.0, -gap / h, -push * gap)
        v = v + w * (J_n @ N + J_t @ along)
        v[1::3] -= h * g
        v = sweep(v, aim, np.where(gap > 0.0, 0.0, soft))
        q = q + h * v
        v = sweep(v, np.minimum(aim, 0.0), np.zeros(2 * n))
    truth = g * np.cumsum(m[::-1])[::-1]
    return float(np.linalg.norm(J_n.reshape(n, 2).sum(axis=1) / h - truth) / np.linalg.norm(truth))


def rounded_force(masses, size, g, hertz):
    """Return the relative error of the forces of a tower if a gap is off by the spacing of floats at its height.

    A soft contact turns a gap into (2π hertz)²/k_n times as much force; the corner of a box of mass m has k_n = 2.5/m.
    """
    m = np.asarray(masses, dtype=float)
    gap = np.spacing(len(m) * size)
    return gap * (2.0 * np.pi * hertz) ** 2 * m.max() / 2.5 / np.linalg.norm(g * np.cumsum(m[::-1]))


# ---------------------------------------------------------------------- towers in the engines

class Towers(NamedTuple):
    """Settings for a tower of boxes in an engine."""
    dt: float                # [s]
    iterations: int          # per step
    slop: float              # tolerated overlap [m]
    overlap: float           # of neighbours at the start [m]
    frictions: tuple         # of the joints, from below [-]
    seconds: float           # [s]


class ChipmunkTower(NamedTuple):
    """A tower of boxes as Chipmunk stores it, from below; the last body is the floor and never moves.

    Positions and velocities are (x, y, θ) of each body.  Positions are linear in the motion, and lever arms are
    constant.
    """
    w: list                  # 1/mass of each body [1/kg]
    turn: list               # 1/moment of inertia [1/(kg m²)]
    arm: float               # half a size [m]
    effective: list          # effective mass at the corners of each joint, the same along it [kg]
    places: list
    v: list
    push: list               # the velocities that remove overlaps; each step begins without them
    J: list                  # impulses of the two corners of each joint, across it [N s]
    F: list                  # along it


def chipmunk_tower(masses, size, overlap):
    """Make a tower whose boxes overlap one another and the floor."""
    n, arm = len(masses), 0.5 * size
    w, turn = [*(1.0 / m for m in masses), 0.0], [*(6.0 / (m * size**2) for m in masses), 0.0]
    effective = [1.0 / (w[k] + w[k - 1] + arm * arm * (turn[k] + turn[k - 1])) for k in range(n)]
    places = [[0.0, -overlap * (k + 1), 0.0] for k in range(n)] + [[0.0, 0.0, 0.0]]
    still = lambda columns, rows: [[0.0] * columns for _ in range(rows)]
    return ChipmunkTower(w, turn, arm, effective, places, still(3, n + 1), still(3, n + 1), still(2, n), still(2, n))


def kick(tower, v, k, x, normal, along):
    """Change the velocities of the box above joint k and of the body below it by impulses at a corner."""
    for body, sign in ((k, 1.0), (k - 1, -1.0)):
        v[body][0] += sign * tower.w[body] * along
        v[body][1] += sign * tower.w[body] * normal
        v[body][2] += tower.turn[body] * (sign * x * normal + tower.arm * along)


def opening(v, k, x):
    """Return the speed, or the distance, by which joint k opens at a corner."""
    return v[k][1] + x * v[k][2] - v[k - 1][1] - x * v[k - 1][2]


def overlapping_corners(tower, how):
    """Return [[joint, corner, its x, velocity that removes its overlap, impulse for that]], in Chipmunk's order.

    The order is from the highest joint to the lowest, the left corner first, but on the floor the right one first.  The
    impulses of the last step are applied; those of a corner that has opened are dropped.
    """
    found, order = [], [(joint, c) for joint in reversed(range(len(tower.J))) for c in ((0, 1) if joint else (1, 0))]
    for k, c in order:
        x = (2 * c - 1) * tower.arm
        gap = opening(tower.places, k, x)
        if gap > 0.0:
            tower.J[k][c] = tower.F[k][c] = 0.0
            continue
        back = (1.0 - 0.9 ** (60.0 * how.dt)) * -min(0.0, gap + how.slop) / how.dt
        found.append([k, c, x, back, 0.0])
        kick(tower, tower.v, k, x, tower.J[k][c], tower.F[k][c])
    return found


def chipmunk_sweep(tower, corners, frictions):
    """Sweep once through the corners; return the largest change of a velocity [m/s].

    The normal impulse and the friction of a corner are computed from the same velocities.
    """
    v, push, J, F, arm, most = tower.v, tower.push, tower.J, tower.F, tower.arm, 0.0
    for corner in corners:
        k, c, x, back, pushed = corner
        m = tower.effective[k]
        slip = v[k][0] + arm * v[k][2] - v[k - 1][0] + arm * v[k - 1][2]
        normal = max(0.0, J[k][c] - m * opening(v, k, x))
        along = min(max(F[k][c] - m * slip, -frictions[k] * normal), frictions[k] * normal)
        more = max(0.0, pushed + m * (back - opening(push, k, x)))
        kick(tower, v, k, x, normal - J[k][c], along - F[k][c])
        kick(tower, push, k, x, more - pushed, 0.0)
        most = max(most, abs(normal - J[k][c]) / m, abs(along - F[k][c]) / m, abs(more - pushed) / m)
        J[k][c], F[k][c], corner[4] = normal, along, more
    return most


@cache
def unrest_in_pymunk(masses, size, g, how):
    """Return the relative error of the forces in the joints of a tower in pymunk, after this many seconds.

    A step of Chipmunk moves with the old velocities, finds the corners that overlap, adds gravity and the impulses of
    the last step, and sweeps through the corners.  A second set of velocities removes 1 − 0.9^(60 dt) of an overlap
    beyond the slop, and is then discarded.  The sweeps end when no velocity changes by 1e-17 m/s.
    *Source:* Munk2D, cpSpaceStep.c and cpArbiter.c.
    """
    tower, n, dt = chipmunk_tower(masses, size, how.overlap), len(masses), how.dt
    for _ in range(round(how.seconds / dt)):
        for k in range(n):
            tower.places[k] = [place + dt * (a + b) for place, a, b in zip(tower.places[k], tower.v[k], tower.push[k])]
            tower.push[k] = [0.0, 0.0, 0.0]
            tower.v[k][1] -= g * dt
        corners = overlapping_corners(tower, how)
        for _ in range(how.iterations):
            if chipmunk_sweep(tower, corners, how.frictions) < 1e-17:
                break
    truth = g * np.cumsum(np.array(masses)[::-1])[::-1]
    return float(np.linalg.norm(np.sum(tower.J, axis=1) / dt - truth) / np.linalg.norm(truth))


def rounded_overlap(masses, size, g, share, dt):
    """Return the relative error of the forces of a tower if an engine's overlap is wrong by ten rounding errors.

    The engine removes a fraction of the overlap per step.  The whole tower gets the velocity  share · error/dt
    within dt. There are ten rounding errors, because each corner is computed from positions, rotations and half
    sizes that are as large as the tower.
    """
    error = 10.0 * np.spacing(len(masses) * size)
    return share * error / dt**2 * np.sum(masses) / np.linalg.norm(g * np.cumsum(masses[::-1]))

# ---------------------------------------------------------------------- solvers of one problem with friction

THROWN, THROWN_MU = 5, 0.3   # discs of thrown_column in four_residuals, and their friction [-]


def thrown_column(n):
    """Return (A (2n, 2n), b (2n,)) of a column of n discs of 1 kg that is thrown down and aside, lower ones faster.

    Contact k is under disc k, at ∓½ m from the centres; its rows are the normal (0, 1) and the tangent (−1, 0).
    """
    rows = np.zeros((2 * n, 3 * n))
    for k in range(n):
        rows[2 * k, 3 * k + 1], rows[2 * k + 1, [3 * k, 3 * k + 2]] = 1.0, (-1.0, -0.5)
        if k > 0:
            rows[2 * k, 3 * k - 2], rows[2 * k + 1, [3 * k - 3, 3 * k - 1]] = -1.0, (1.0, -0.5)
    v = np.column_stack((9.0 - 2.0 * np.arange(n), -np.ones(n), np.zeros(n))).ravel()
    return (rows * np.tile((1.0, 1.0, 8.0), n)) @ rows.T, rows @ v


def least_energy(A, b, mu):
    """Return the impulses J (2m,) with the least  ½ J·A J + b·J  in the cones |J_t| ≤ μ J_n, by SciPy's active sets.

    J_n = y + z + s and J_t = μ_k (y − z), with y, z and s ≥ 0, is exactly such a cone.  With A = F Fᵀ the energy is
    half of |Fᵀ J + F⁻¹ b|², less a constant.
    """
    cones = np.zeros((b.size, 3 * mu.size))
    for k, m in enumerate(mu):
        cones[2 * k:2 * k + 2, 3 * k:3 * k + 3] = (1.0, 1.0, 1.0), (m, -m, 0.0)
    F = np.linalg.cholesky(A)
    return cones @ nnls(F.T @ cones, -np.linalg.solve(F, b))[0]


def limited(J, mu):
    """Return impulses (2m,) with J_n cut off at 0, and J_t at μ J_n."""
    J_n = np.maximum(0.0, J[::2])
    return np.column_stack((J_n, np.clip(J[1::2], -mu * J_n, mu * J_n))).ravel()


def nearest_in_cone(J, mu):
    """Return the points of the cones |J_t| ≤ μ J_n that are nearest to impulses (2m,)."""
    J_n, J_t = J[::2], J[1::2]
    edge = np.maximum(0.0, J_n + mu * np.abs(J_t)) / (1.0 + mu * mu)
    outside = np.abs(J_t) > mu * J_n
    return np.column_stack((np.where(outside, edge, J_n), np.where(outside, mu * edge * np.sign(J_t), J_t))).ravel()


def newton_of(phi, J):
    """Return J after one step of Newton's method for φ(J) = 0, with derivatives from central differences."""
    slopes = [(phi(J + 1e-7 * e) - phi(J - 1e-7 * e)) / 2e-7 for e in np.eye(J.size)]
    return J - np.linalg.solve(np.stack(slopes, axis=1), phi(J))


def four_solvers(A, b, mu):
    """Return steps J (2m,) → J of four solvers.

    All contacts at once, with too large a change; Gauss–Seidel; the convex relaxation; Newton's method.
    """
    k = np.diag(A)

    def bend(x, y):
        return x + y - np.hypot(x, y)

    def phi(J):
        u, limit = A @ J + b, mu * J[::2]
        upper = bend(k[1::2] * (limit - J[1::2]), -u[1::2])
        return np.append(bend(k[::2] * J[::2], u[::2]), bend(k[1::2] * (limit + J[1::2]), -upper))

    def one_by_one(J):
        J = J.copy()
        for n in range(0, J.size, 2):
            J[n] = max(0.0, J[n] - (A[n] @ J + b[n]) / k[n])
            limit, free = mu[n // 2] * J[n], J[n + 1] - (A[n + 1] @ J + b[n + 1]) / k[n + 1]
            J[n + 1] = min(max(free, -limit), limit)
        return J

    def cone_by_cone(J):
        J = J.copy()
        for c in range(0, J.size, 2):
            pair = slice(c, c + 2)
            J[pair] = nearest_in_cone(J[pair] - (A[pair] @ J + b[pair]) / k[pair].max(), mu[c // 2:c // 2 + 1])
        return J
    return lambda J: limited(J - 1.2 * (A @ J + b) / k, mu), one_by_one, cone_by_cone, lambda J: newton_of(phi, J)


def four_residuals(steps=160):
    """Return (4, steps + 1) residuals [m/s] of four_solvers for discs that are thrown, from no impulses on.

    The residual is the largest k |J' − J|, with the impulse J' that each contact alone would have: 0 exactly where the
    laws of Signorini and Coulomb hold.
    """
    (A, b), mu = thrown_column(THROWN), np.full(THROWN, THROWN_MU)
    k, found = np.diag(A), []
    for step in four_solvers(A, b, mu):
        J, residuals = np.zeros(b.size), []
        for _ in range(steps + 1):
            residuals.append(np.max(k * np.abs(limited(J - (A @ J + b) / k, mu) - J)))
            J = step(J)
        found.append(residuals)
    return np.array(found)


@cache
def residual_of_relaxation():
    """Return the residual [m/s] at which the convex relaxation of the same discs ends: the largest μ |u_t|.

    There a contact that slides opens at u_n = μ |u_t|, by which the laws are missed.
    """
    (A, b), mu = thrown_column(THROWN), np.full(THROWN, THROWN_MU)
    return np.max(mu * np.abs(A @ least_energy(A, b, mu) + b)[1::2])
