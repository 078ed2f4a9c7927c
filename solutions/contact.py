"""Lesson 9.  Contact: many contacts at once.

    0 ≤ λ  ⊥  A λ + b ≥ 0,      |J_t| ≤ μ J_n

Symbols: a ContactSet (solutions/support/contact_points.py) holds for each contact k its bodies a[k] and b[k], the unit
normal n[k], which points from b to a, the place p[k] and the gap[k] · r = p − x offset from a centre · u [m/s] velocity
of a's contact point relative to b's, u_n = n · u · J [N s] impulse on a; b receives −J · λ normal impulses · G (2m, 3n)
contact rows · M⁻¹ (3n,) inverse masses of all coordinates · A (2m, 2m) [1/kg] Delassus matrix · b [m/s] u without
impulses · k_n, k_t [1/kg] effective inverse masses, the diagonal of A · μ [-] friction · ω [-] relaxation ·
ρ [-] contraction factor: error after a sweep over the error before it.
The first part is for small scenes: exact, in the plane, with matrices.  The second part is for piles: fast, with
arrays.  Functions of the second part run compiled if they contain only loops over numbers and arrays: no dict, no
lambda, no string.  Given in solutions/given/contact.py: advance_pile_2d and advance_pile, which call them in each
step.
*Left out:* restitution of many contacts (no law decides it, only conventions); sleeping; rolling resistance.
"""

import numpy as np

from .checks import Diverged, float_copy
from .integrators import solve
from .support.arms import Arms, apply_impulse, point_velocity_of
from .support.contact_points import (
    ContactSet,
    ball_bounds,
    box_bounds,
    box_bounds_2d,
    box_contacts,
    box_contacts_2d,
    disc_bounds,
    round_contacts,
)
from .support.scenes import (
    Pile,
    PileState,
    check_friction_problem,
    check_independent,
    check_scene,
    inverse_masses,
    make_contacts,
    make_pile,
    make_pile_2d,
)
from .support.tuples import minus, plus, put, row, scaled
from .vectors import dot

CONVERGED = 1e-13            # residual over the terms that it is a sum of [-]: a thousand roundings
MAX_SWEEPS = 50_000          # of solve_contacts [-]; a stack of 20 needs 3,800
MAX_PIVOTS = 100             # of solve_lcp, per contact [-]; contacts of bodies have needed two, the worst case 2ᵐ/m


# ---------------------------------------------------------------------- exactly: all contacts in matrices

def contact_rows(x, contacts):
    """Return G (2m, 3n), which turns velocities (v_x, v_y, ω) of all bodies into relative velocities of all contacts.

    u = G v,     row 2k: n · u of contact k,     row 2k + 1: t · u, with t = (−n_y, n_x)

    x (n, 2) are the centres of the bodies.
    A direction d (n or t) has the entries (d_x, d_y, r_a × d) at body a and −(d_x, d_y, r_b × d) at body b.  All others
    are 0.  r = p − x of that body, and r × d = r_x d_y − r_y d_x.
    *Source:* the relative velocity of lesson 7, for all contacts at once.
    """
    ### BEGIN SOLUTION 9.1
    G = np.zeros((2 * contacts.a.size, 3 * x.shape[0]))
    for k in range(contacts.a.size):
        n_x, n_y = contacts.n[k, 0], contacts.n[k, 1]
        for s, d_x, d_y in ((2 * k, n_x, n_y), (2 * k + 1, -n_y, n_x)):
            for body, sign in ((contacts.a[k], 1.0), (contacts.b[k], -1.0)):
                r_x, r_y = contacts.p[k, 0] - x[body, 0], contacts.p[k, 1] - x[body, 1]
                G[s, 3 * body] = sign * d_x
                G[s, 3 * body + 1] = sign * d_y
                G[s, 3 * body + 2] = sign * (r_x * d_y - r_y * d_x)
    return G
    ### END SOLUTION


def delassus_matrix(G, w):
    """Return A (rows, rows) [1/kg]: entry (r, s) is the relative velocity along row r due to a unit impulse in row s.

    *Find* it.  G turns the velocities of all bodies into relative velocities u = G v.  An impulse in row s acts on the
    bodies along row s of G, and changes their velocities by that row times w, the inverse masses and moments (3n,).

    A is symmetric.  Impulses J lead to u = A J + b, with b = G v.  Contacts that share no movable body have entry 0.
    *Source:* Delassus 1917; Moreau 1988.
    """
    ### BEGIN SOLUTION 9.2
    return (G * w) @ np.ascontiguousarray(G.T)
    ### END SOLUTION


def complementarity_residual(A, b, lam):
    """Return how far [m/s] normal impulses λ (m,) are from the law 0 ≤ λ ⊥ A λ + b ≥ 0.

    largest |min(A_kk λ_k, (A λ + b)_k)|          A_kk turns the impulse into a velocity; m ≥ 1

    It is 0 exactly if no contact pulls, no contact approaches, and no contact both pushes and separates.
    *Source:* min(x, y) = 0 if and only if x ≥ 0, y ≥ 0 and x y = 0; Cottle, Pang and Stone 1992.
    """
    ### BEGIN SOLUTION 9.3
    return np.max(np.abs(np.minimum(np.diag(A) * lam, A @ lam + b)))
    ### END SOLUTION


def gauss_seidel_sweep(A, b, lam, omega):
    """Return the impulses (m,) after a sweep of projected Gauss–Seidel over all contacts in order, with relaxation ω.

    *Find* what a visit does to λ_k.  The relative velocity of contact k is  u_k = Σ_l A_kl λ_l + b_k  with the newest
    λ_l.  With ω = 1 the visit treats its contact as if it were alone: afterwards u_k = 0, unless the contact would have
    to pull for that; then λ_k = 0.  With another ω, the change of λ_k is ω times as large before a pull is cut off.

    The diagonal of A is above zero.  Returns a new array.
    *Source:* Cryer 1971.  Sequential impulses (Catto 2006) are the same with ω = 1.
    """
    ### BEGIN SOLUTION 9.4
    lam = float_copy(lam)
    for k in range(lam.size):
        lam[k] = np.maximum(0.0, lam[k] - omega * (A[k] @ lam + b[k]) / A[k, k])
    return lam
    ### END SOLUTION


def stack_contraction(n):
    """Return the factor ρ of a sweep of Gauss–Seidel, for its error on a frictionless stack of n equal bodies.

    *Find* it.  In Jacobi's iteration each visit sees the old impulses of the others.  On the A of this stack it has the
    eigenvalues  cos((2j − 1) π/2n),  j = 1 … n.  A is tridiagonal, and then Gauss–Seidel does in one sweep what Jacobi
    does in two.
    *Source:* Young 1971; the matrix is tridiagonal.
    """
    ### BEGIN SOLUTION 9.5
    return np.cos(0.5 * np.pi / n) ** 2
    ### END SOLUTION


def mass_ratio_contraction(r):
    """Return ρ of Gauss–Seidel for a body of mass r m on one of mass m, which is on the ground.  No friction.

    A = [[1, −1], [−1, 1 + 1/r]]/m: contact 0 is between the ground and the lower body, contact 1 between the bodies.
    *Find* ρ, the factor by which one sweep (gauss_seidel_sweep with ω = 1) shrinks the error of both λ.  Both contacts
    push.
    *Source:* direct elimination in the two equations.
    """
    ### BEGIN SOLUTION 9.6
    # For two contacts ρ = A₀₁ A₁₀/(A₀₀ A₁₁): an error of λ₁ makes one of λ₀, and this makes a new error of λ₁.
    return r / (1.0 + r)
    ### END SOLUTION


def best_relaxation(rho):
    """Return (ω, ρ_ω): the relaxation that converges fastest where Gauss–Seidel contracts by ρ, and its own factor.

    *Find* both.  In a chain, each contact shares bodies with two others at most.  There the factors λ of a relaxed
    sweep are the roots of  (λ + ω − 1)² = λ ω² ρ  (Young), and the larger one decides.  It shrinks as ω grows from 1,
    until both roots are equal.  Where one sweep is enough, ρ = 0, ω is 1.

    For the stack √(1 − ρ) = sin(π/2n).  The number of sweeps then grows as n, and no longer as n².
    *Source:* Young 1971.
    """
    ### BEGIN SOLUTION 9.7
    omega = 2.0 / (1.0 + np.sqrt(1.0 - rho))
    return omega, 0.25 * omega * omega * rho         # = ω − 1, which loses the digits of a small ρ
    ### END SOLUTION


def solve_lcp(A, b):
    """Return λ (m,) with 0 ≤ λ ⊥ A λ + b ≥ 0, exact but for round-off: Murty's least-index method.

    Guess which contacts push, at first none.  Then repeat, at most MAX_PIVOTS m times:
        Find λ with (A λ + b)_k = 0 for the contacts that push and λ_k = 0 for the others.  Use solve of lesson 1, with
        rows and columns of the identity matrix for the others: their λ_k must be exactly 0.  If one is
        1e-17, round-off may change the guess for ever.
        A contact is wrong if it pushes and λ_k < −ε_k/A_kk, or if it does not and (A λ + b)_k < −ε_k, where
        ε_k = CONVERGED (Σ_l |A_kl λ_l| + |b_k|) is round-off.
        If none is wrong, return λ.  Otherwise change the guess for one contact only: the wrong one of least index.
    For a positive definite A no guess occurs twice, so the method ends.  There is only one answer, so another fixed
    order, such as the greatest index first, is right as well.  An order that depends on how wrong a contact is may
    repeat guesses for ever.
    Raises what check_independent(A, b) raises; call it first.  After the last round raises
    Diverged("complementarity residual [m/s]", complementarity_residual(A, b, λ), "use projected Gauss–Seidel").
    *Source:* Murty 1974.
    """
    ### BEGIN SOLUTION 9.8
    check_independent(A, b)
    m = b.size
    pushes, lam = np.zeros(m, np.bool_), np.zeros(m)
    for _ in range(MAX_PIVOTS * m):
        matrix, right = np.eye(m), np.zeros(m)
        for k in range(m):
            if pushes[k]:
                matrix[k], right[k] = np.where(pushes, A[k], 0.0), -b[k]
        lam = solve(matrix, right)
        u, epsilon, wrong = A @ lam + b, CONVERGED * (np.abs(A) @ np.abs(lam) + np.abs(b)), -1
        for k in range(m - 1, -1, -1):
            if (lam[k] < -epsilon[k] / A[k, k]) if pushes[k] else (u[k] < -epsilon[k]):
                wrong = k
        if wrong < 0:
            return lam
        pushes[wrong] = not pushes[wrong]
    raise Diverged("complementarity residual [m/s]", complementarity_residual(A, b, lam), "use projected Gauss–Seidel")
    ### END SOLUTION


def cone_residual(A, b, J, mu):
    """Return how far [m/s] impulses J (2m,) are from the laws of Signorini and Coulomb at all contacts; μ is mu (m,).

    With u = A J + b, each contact by itself would change its impulse to
        J_n' = max(0, J_n − u_n/k_n),       J_t' = J_t − u_t/k_t, but at most limit in size
    Here limit is μ times the given J_n, not J_n'; it is 0 where J_n ≤ 0.
    The residual is the largest k_n |J_n' − J_n| or k_t |J_t' − J_t|.  J and u hold (n, t) of one contact after the
    other; k_n and k_t are on the diagonal of A.  The residual is 0 exactly where the laws hold, for the J of any
    solver, and for μ = ∞ as well.
    *Source:* the natural map: J = P(J − u/k), P the projection onto what the laws allow; Acary and Brogliato 2008.
    """
    ### BEGIN SOLUTION 9.9
    u, worst = A @ J + b, 0.0
    for n in range(0, J.size, 2):
        t = n + 1
        limit = mu[n // 2] * J[n] if J[n] > 0.0 else 0.0
        J_n = np.maximum(0.0, J[n] - u[n] / A[n, n])
        J_t = np.minimum(np.maximum(J[t] - u[t] / A[t, t], -limit), limit)
        worst = np.maximum(worst, np.maximum(A[n, n] * np.abs(J_n - J[n]), A[t, t] * np.abs(J_t - J[t])))
    return worst
    ### END SOLUTION


def cone_sweep(A, b, J, mu):
    """Return the impulses (2m,) after a sweep of projected Gauss–Seidel with friction: at each contact J_n, then J_t.

    J_n ← max(0, J_n − u_n/k_n),      J_t ← J_t − u_t/k_t, but at most μ J_n in size (0 where J_n = 0)

    Each u comes from the newest J, and the limit from the new J_n.  Layout and μ are those of cone_residual.  If a
    sweep leaves J unchanged, its residual is 0.  The diagonal of A is above zero.  Returns a new array.
    *Source:* Jourdan, Alart and Jean 1998; Catto 2006.
    """
    ### BEGIN SOLUTION 9.10
    J = float_copy(J)
    for n in range(0, J.size, 2):
        t = n + 1
        J[n] = np.maximum(0.0, J[n] - (A[n] @ J + b[n]) / A[n, n])
        limit = mu[n // 2] * J[n] if J[n] > 0.0 else 0.0
        J[t] = np.minimum(np.maximum(J[t] - (A[t] @ J + b[t]) / A[t, t], -limit), limit)
    return J
    ### END SOLUTION


def solve_contacts(A, b, mu):
    """Given.  Return the impulses J (2m,) of the contacts, by cone_sweep from 0.

    It ends when cone_residual is at most CONVERGED times the largest (|A||J| + |b|)_k.
    Raises what check_friction_problem(A, b, mu) raises, and Diverged with the residual after MAX_SWEEPS sweeps, which
    are too few for a mass ratio of a million, or earlier where 1,000 sweeps do not reduce it.
    """
    check_friction_problem(A, b, mu)
    J, residual, before = np.zeros(b.size), np.inf, np.inf
    for k in range(MAX_SWEEPS // 10):
        for _ in range(10):
            J = cone_sweep(A, b, J, mu)
        residual = cone_residual(A, b, J, mu)
        if residual <= CONVERGED * np.max(np.abs(A) @ np.abs(J) + np.abs(b)):
            return J
        if k % 100 == 99:
            if not residual < before:
                break
            before = residual
    raise Diverged("residual of the contacts [m/s]", residual, "use a direct solver, or more equal masses")


def contact_forces(x, inv_mass, inv_inertia, contacts, load, mu):
    """Return (F (m, 2) [N], a (n, 3) [m/s², rad/s²]): contact forces (F_n, F_t) of bodies at rest, and accelerations.

    At rest the laws hold for forces and accelerations as they do for impulses and velocities: solve_contacts(A, b, μ)
    gives F from  b = G M⁻¹ load,  and then  a = M⁻¹ (load + Gᵀ F).  inverse_masses(inv_mass, inv_inertia) is M⁻¹ (3n,).

    x (n, 2), inv_mass (n,), inv_inertia (n,), load (n, 3) [N, N, N m] force and torque on each body, mu (m,), ∞ too.
    A body with an inverse mass of 0 may still turn.  Forces do not depend on the gaps.
    A scene stays at rest where a = 0.  A contact is released when its F_n reaches 0.
    Raises what check_scene(x, inv_mass, inv_inertia, contacts, load, mu) raises; call it first.
    *Left out:* the choice among several possible F where supports are redundant; sums and moments are right.
    """
    ### BEGIN SOLUTION 9.11
    check_scene(x, inv_mass, inv_inertia, contacts, load, mu)
    G, w = contact_rows(x, contacts), inverse_masses(inv_mass, inv_inertia)
    F = solve_contacts(delassus_matrix(G, w), G @ (w * load.ravel()), mu)
    a = w * (load.ravel() + np.ascontiguousarray(G.T) @ F)
    return F.reshape(-1, 2), a.reshape(-1, 3)
    ### END SOLUTION


# ---------------------------------------------------------------------- quickly: piles in arrays

def soft_contact(gap, hertz, zeta, dt):
    """Return (aim [m/s], give [-]) of a contact that is a damped spring: its law is u_n = aim − give k_n J_n.

    gap > 0:     aim is the velocity that just closes the gap in this step, and give = 0.
    gap ≤ 0:     *Find* aim and give of an implicit Euler step of a damped spring.  It pushes with the impulse
        J_n = −dt (k (gap + dt u_n) + c u_n),      k = (2π hertz)²/k_n,      c = 2ζ (2π hertz)/k_n
    where u_n is the velocity after the step.  k_n cancels: aim and give depend on gap, hertz, zeta and dt only.

    Under a force F the gap comes to rest at −k_n F/(2π hertz)² for every dt.  gap [m], hertz [1/s], zeta [-],
    dt [s]; hertz and dt are above 0.
    *Source:* Catto 2011, "Soft constraints"; lesson 8's compliance, for a contact.
    """
    ### BEGIN SOLUTION 9.12
    # With s = 2π hertz dt the spring says k_n J_n = −s² gap/dt − s (2ζ + s) u_n.  Solved for u_n it has the form
    # aim − give k_n J_n.
    if gap > 0.0:
        return -gap / dt, 0.0
    s = 2.0 * np.pi * hertz * dt
    return -s * gap / (dt * (2.0 * zeta + s)), 1.0 / (s * (2.0 * zeta + s))
    ### END SOLUTION


def friction_disc(J, limit):
    """Return the point of the disc |J| ≤ limit that is nearest to J.

    *Find* it.  J and the answer are tuples of three numbers; limit is a number, which may be 0 or ∞.

    Two separate limits along two tangents would allow √2 times the friction along the diagonal.
    """
    ### BEGIN SOLUTION 9.13
    size = np.sqrt(dot(J, J))
    return scaled(1.0, J) if size <= limit else scaled(limit / size, J)
    ### END SOLUTION


def kept_impulses(contacts, old, J_old, near):
    """Return J (m, d) [N s] to begin a step with (warm start): each contact takes over the impulse of an old one.

    The old one is the nearest contact of `old` with the same a and the same b, if it is closer than `near` [m]; else J
    is 0.  Normals may have turned, so copy the vector.  Two new contacts may take over the same old impulse.
    contacts and old are ContactSets with fields first, a, b, n, p and gap; J_old belongs to old.  Old contacts are
    ordered by a: those with a = i have the numbers old.first[i], …, old.first[i + 1] − 1.
    *Source:* Catto 2006.
    """
    ### BEGIN SOLUTION 9.14
    J, d = np.zeros(contacts.p.shape), contacts.p.shape[1]
    for k in range(contacts.a.size):
        i, nearest = contacts.a[k], near * near
        for s in range(old.first[i], old.first[i + 1]):
            if old.b[s] == contacts.b[k]:
                squared = 0.0
                for c in range(d):
                    squared += (contacts.p[k, c] - old.p[s, c]) ** 2
                if squared < nearest:
                    nearest = squared
                    for c in range(d):
                        J[k, c] = J_old[s, c]
    return J
    ### END SOLUTION


def has_left_margin(low, high, wide_low, wide_high):
    """Return whether the box of any body, corners low and high (n, d), sticks out of its widened box.

    wide_low and wide_high are the corners of the widened boxes.  There may be no bodies, n = 0.
    While this is False, only pairs that the last search found (with the widened boxes) can touch.  Return True for NaN.
    """
    ### BEGIN SOLUTION 9.15
    for i in range(low.shape[0]):
        for c in range(low.shape[1]):
            if not (wide_low[i, c] <= low[i, c] and high[i, c] <= wide_high[i, c]):
                return True
    return False
    ### END SOLUTION


def velocity_sweep_2d(v, omega, J, aim, give, contacts, arms, pile):
    """Return (v, omega, J) in the plane after a sweep without a matrix: each contact is visited as if it were alone.

    u = velocity of a's contact point less that of b's: (v_x − ω r_y, v_y + ω r_x) with r = arms.r_a[k], arms.r_b[k]
    J_n ← max(0, J_n + (aim − u_n − give k_n J_n)/(k_n (1 + give)))           along n;   k_n = arms.k_n[k]
    J_t ← J_t − u_t/k_t, but at most μ J_n in size, with the new J_n          along t = (−n_y, n_x);   k_t = arms.k_t[k]
    Both use the same u.  Then the change of J acts on a, and minus that on b:   v += J/m,   ω += (r × J)/I

    v (n + p, 2), omega (n + p,), J (m, 2) in x and y, aim and give (m,).  1/m of body i is pile.inv_mass[i], 1/I is
    pile.inv_inertia[i], and μ is pile.mu, the same for all contacts.  μ = ∞ sticks where J_n > 0.  Returns new arrays.
    *Source:* sequential impulses, Catto 2006; aim and give: see soft_contact.
    """
    ### BEGIN SOLUTION 9.16
    v, omega, J = float_copy(v), float_copy(omega), float_copy(J)
    inv_mass, inv_inertia = pile.inv_mass, pile.inv_inertia
    for k in range(contacts.a.size):
        a, b, n_x, n_y, k_n = contacts.a[k], contacts.b[k], contacts.n[k, 0], contacts.n[k, 1], arms.k_n[k]
        a_x, a_y, b_x, b_y = arms.r_a[k, 0], arms.r_a[k, 1], arms.r_b[k, 0], arms.r_b[k, 1]
        u_x = v[a, 0] - omega[a] * a_y - v[b, 0] + omega[b] * b_y
        u_y = v[a, 1] + omega[a] * a_x - v[b, 1] - omega[b] * b_x
        u_n, u_t = n_x * u_x + n_y * u_y, n_x * u_y - n_y * u_x
        J_n, J_t = n_x * J[k, 0] + n_y * J[k, 1], n_x * J[k, 1] - n_y * J[k, 0]
        J_n += (aim[k] - u_n - give[k] * k_n * J_n) / (k_n * (1.0 + give[k]))
        J_n = 0.0 if J_n <= 0.0 else J_n                                 # a NaN stays one
        J_t, limit = J_t - u_t / arms.k_t[k], pile.mu * J_n if J_n > 0.0 else 0.0
        J_t = -limit if J_t < -limit else limit if J_t > limit else J_t
        d_x, d_y = J_n * n_x - J_t * n_y - J[k, 0], J_n * n_y + J_t * n_x - J[k, 1]
        J[k, 0], J[k, 1] = J[k, 0] + d_x, J[k, 1] + d_y
        v[a, 0] += inv_mass[a] * d_x
        v[a, 1] += inv_mass[a] * d_y
        omega[a] += inv_inertia[a] * (a_x * d_y - a_y * d_x)
        v[b, 0] -= inv_mass[b] * d_x
        v[b, 1] -= inv_mass[b] * d_y
        omega[b] -= inv_inertia[b] * (b_x * d_y - b_y * d_x)
    return v, omega, J
    ### END SOLUTION


def velocity_sweep(v, omega, J, aim, give, contacts, arms, inv_mass, inv_inertia, mu):
    """Given.  Return the same in space: J_t in the disc of friction, inv_inertia (n + p, 3, 3) in the world."""
    v, omega, J = float_copy(v), float_copy(omega), float_copy(J)
    for k in range(contacts.a.size):
        a, b, k_n, old = contacts.a[k], contacts.b[k], arms.k_n[k], row(J, k)
        n, r_a, r_b = row(contacts.n, k), row(arms.r_a, k), row(arms.r_b, k)
        u = minus(point_velocity_of(v, omega, a, r_a), point_velocity_of(v, omega, b, r_b))
        J_n = dot(n, old)
        J_n += (aim[k] - dot(n, u) - give[k] * k_n * J_n) / (k_n * (1.0 + give[k]))
        J_n = 0.0 if J_n <= 0.0 else J_n                                 # a NaN stays one
        stick = plus(old, -1.0 / arms.k_t[k], u)
        J_t = friction_disc(plus(stick, -dot(n, stick), n), mu * J_n if J_n > 0.0 else 0.0)
        put(J, k, plus(J_t, J_n, n))
        change = minus(row(J, k), old)
        apply_impulse(v, omega, a, r_a, change, inv_mass, inv_inertia)
        apply_impulse(v, omega, b, r_b, scaled(-1.0, change), inv_mass, inv_inertia)
    return v, omega, J


# ---------------------------------------------------------------------- other solvers for the same laws

def proximal_sweep(A, b, J, mu, r):
    """Return the impulses (2m,) after a sweep of the proximal map with the factors r (2m,) [kg]: J_n, then J_t.

    Each impulse J_k has limits: 0 and ∞ for J_n, ∓μ J_n for J_t (0 where J_n = 0).  Its law is  u_k (J' − J_k) ≥ 0  for
    every J' within the limits: u_k is 0 between them, at least 0 at the lower one, at most 0 at the upper one.
    *Find* what a visit does to J_k: a map of J_k and u_k, with any r_k > 0, that leaves J_k alone exactly if
    this law holds.  Far from all limits it changes J_k by −r_k u_k.

    Each u comes from the newest J, and the limit from the new J_n.  Layout and μ are those of cone_residual.  With
    r = 1/diagonal of A this is cone_sweep.  Returns a new array.
    *Source:* Moreau 1965; Alart and Curnier 1991; Erleben 2017.
    """
    ### BEGIN SOLUTION 9.17
    # The proximal map, here a projection: J ← the point within the limits that is nearest to J − r u.
    J = float_copy(J)
    for n in range(0, J.size, 2):
        t = n + 1
        J[n] = np.maximum(0.0, J[n] - r[n] * (A[n] @ J + b[n]))
        limit = mu[n // 2] * J[n] if J[n] > 0.0 else 0.0
        J[t] = np.minimum(np.maximum(J[t] - r[t] * (A[t] @ J + b[t]), -limit), limit)
    return J
    ### END SOLUTION


def fischer_burmeister(x, y):
    """Return (φ, ∂φ/∂x, ∂φ/∂y) of Fischer's and Burmeister's function of two numbers, at (x, y).

    φ is the sum of the legs x and y of a right triangle less its hypotenuse.  φ = 0 exactly if  0 ≤ x ⊥ y ≥ 0.
    *Find* its derivatives, and a form of φ that loses no digits where x and y are above zero, however different they
    are.  Elsewhere x + y − h is good enough.  At (0, 0) there is no derivative; return 1 − 1/√2 for both, which is
    their value along x = y.
    *Source:* Fischer 1992.
    """
    ### BEGIN SOLUTION 9.18
    # φ = x + y − h.  With h² = x² + y² it is 2xy/(x + y + h), which subtracts nothing where x and y are above zero.
    h = np.hypot(x, y)
    if h == 0.0:
        return 0.0, 1.0 - np.sqrt(0.5), 1.0 - np.sqrt(0.5)
    phi = 2.0 * min(x, y) * (max(x, y) / (x + y + h)) if x > 0.0 and y > 0.0 else x + y - h
    return phi, 1.0 - x / h, 1.0 - y / h
    ### END SOLUTION


def minimum_map_step(A, b, lam):
    """Return λ (m,) after one step of Newton's method for  min(A_kk λ_k, u_k) = 0  at all contacts, u = A λ + b.

    *Find* it.  At each contact the smaller one of A_kk λ_k and u_k is a linear function of all impulses.  Newton's step
    takes these functions, as they are at the given λ, and solves for the λ at which all of them are 0.  The result
    may pull.  Where both are equal, take either one.  Use solve of lesson 1.

    Once it is known which contacts push, one step gives the answer.  From elsewhere the steps may repeat for ever.
    *Source:* Pang 1990; Hintermüller, Ito and Kunisch 2003.
    """
    ### BEGIN SOLUTION 9.19
    # u_k = 0 at contacts with u_k < A_kk λ_k, and λ_k = 0 at all others.
    u, matrix, right = A @ lam + b, np.diag(np.diag(A)), np.zeros(b.size)
    for k in range(b.size):
        if u[k] < A[k, k] * lam[k]:
            matrix[k], right[k] = A[k], -b[k]
    return solve(matrix, right)
    ### END SOLUTION


def relaxed_gap(mu, v, dt):
    """Return the gap [m] above its support at which a block slides at the velocity v, where an engine relaxes friction.

    Many programs (MuJoCo, Drake) take the impulses with the least  ½ J·A J + b·J  within the cones |J_t| ≤ μ J_n,
    because this is a convex problem.  Its solution slides as Coulomb says, against the slip and with |J_t| = μ J_n,
    but it obeys another law along the normal:
        J_n (u_n + gap/dt) + J_t u_t = 0
    *Find* the gap before you run anything.  The block slides steadily: J_n > 0, it neither rises nor sinks, and
    u_t = v in every step, by a force that pulls it.  μ [-], v [m/s] of either sign, dt [s].
    *Source:* Anitescu 2006; Todorov 2014; Castro, Permenter and Han 2022.
    """
    ### BEGIN SOLUTION 9.20
    # J_t = −μ J_n sign(v) and u_n = 0:  J_n gap/dt = μ J_n |v|.
    return mu * np.abs(v) * dt
    ### END SOLUTION


def relaxed_curve_is():
    """Return the letter of the curve of the convex relaxation in the figure of exercise 9.21: "A", "B", "C" or "D".

    The figure shows the residual against the number of iterations for four solvers of one problem with friction:
    projected Gauss–Seidel; Newton's method; the convex relaxation of MuJoCo and Drake; all contacts at once, each with
    more than the change that it needs.  Say which curve is the relaxation.
    """
    ### BEGIN SOLUTION 9.21
    return "B"                                       # its answer is that of another law: a sliding contact opens
    ### END SOLUTION


def fewer_sweeps(sweep, J, calls):
    """Return impulses that are closer to the answer than `calls` sweeps would be, from `calls` sweeps at most.

    *Make it*: a method of your own.  sweep(J) returns the impulses after one sweep of some solver, such as projected
    Gauss–Seidel, from J; you learn nothing else of the problem.  From any J, in a stack of at most 14 bodies and
    under a heavy body, 100 calls must leave at most a tenth of the residual that as many sweeps leave.  In a stack of
    40 bodies the same holds for 600 calls.  In a stack of 20 bodies 15 calls, which are few, must leave at most 95 % of
    it.  With friction, for two boxes that are thrown, the residual must be at most a thousandth of what it is without
    impulses.
    Impulses that a sweep does not change are the answer; return them.  No contact may pull.  A sweep cuts a pull off,
    and an extrapolation may bring one back.  So return impulses that one of your calls of sweep has returned.
    calls is at least 1; do not change J.
    Ideas: extrapolate from the last sweeps (Aitken, Anderson); keep a momentum, and forget it where it leads astray
    (Nesterov); nonsmooth nonlinear conjugate gradients, in which the change of a sweep takes the place of the gradient.
    *Source:* Silcowitz, Niebe and Erleben 2010.
    """
    ### BEGIN SOLUTION 9.22
    # Conjugate gradients after Fletcher and Reeves: p ← β p + change, β the ratio of its squared sizes.  Where a change
    # is larger than the one before, the set of pushing contacts has changed: forget p.
    J, p, before = float_copy(J), np.zeros(J.size), np.inf
    for _ in range(calls - 1):
        swept = sweep(J)
        change = swept - J
        size = change @ change
        if 0.0 < size < before:
            J, p = swept + size / before * p, size / before * p + change
        else:
            J, p = swept, np.zeros(J.size)
        before = size
    return sweep(J)
    ### END SOLUTION
