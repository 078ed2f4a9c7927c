"""Lesson 8.  Constraints by projection: move the points first, then put them where they may be.

    Cⱼ(x) = 0 for every constraint j,      xₙ₊₁ = x_pred + Σⱼ M⁻¹ λⱼ ∇Cⱼ(xₙ₊₁) dt²,      vₙ₊₁ = (xₙ₊₁ − xₙ)/dt

Symbols: x (n, d) [m] positions of n points in d dimensions · v (n, d) [m/s] · inv_mass (n,), w [1/kg] (0: immovable) · C constraint
[m] or [rad] or [m³] · ∇C its gradient · λ [N] multiplier: the tension of a link, with its sign turned · α [m/N] compliance, one over stiffness ·
q (4,) = (w, x, y, z) orientation · ω (3,) [rad/s] · n unit normal or direction, from b (or j) to a (or i).

A method for points is a function  step(acceleration, t, x, v, dt, net) → (x, v)  at t + dt, as in lesson 1; net gets through untouched.
*Left out:* friction (lesson 3 puts it into such a step), collision of a cloth with itself (lesson 6 finds it).
"""

from typing import NamedTuple

import numpy as np

from .checks import BadInput, Diverged, check_shape, finite_array, float_copy, one_each, whole_number
from .integrators import solve
from .rotation import angular_acceleration, cross, product, quaternion_update, rotate, unrotate
from .springs import inverse_masses, measured_links

NEWTON_TOLERANCE = 1e-12     # last correction over the longest link [-]: Newton squares it, so what is left is round-off
NEWTON_LIMIT = 40            # corrections [-]: 4 to 7 where points move a tenth of a link per step, 30 and more where some move a whole link
TRACE = 1e-13                # compliance over w dt² of a link [-]: far below the pull of all links, far above round-off
FIRST_TRACE = 1e-10          # the same while the gaps are still closing: what redundant links then disagree about is larger than round-off


class Net(NamedTuple):
    """Points and the links between them: a pendulum, a rope, a cloth."""
    inv_mass: np.ndarray     # (n,) [1/kg]; 0 is a point that nothing moves but its own velocity
    gravity: np.ndarray      # (d,) [m/s²]
    i: np.ndarray            # (s,) one end of each link
    j: np.ndarray            # (s,) the other
    rest: np.ndarray         # (s,) its length [m]
    stiffness: np.ndarray    # (s,) share of the error that PBD takes at each visit [-], above 0 and up to 1
    alpha: np.ndarray        # (s,) compliance that XPBD gives it [m/N]; 0: inextensible
    sweeps: int              # visits to every link in a step


class Obstacle(NamedTuple):
    """A ball that does not move, over a floor: what a cloth falls on."""
    centre: np.ndarray       # (d,) [m]
    radius: float            # [m]; 0: no ball
    point: np.ndarray        # (d,) a point of the floor [m]
    n: np.ndarray            # (d,) its unit normal


class Cloth(NamedTuple):
    """A net whose faces resist folding."""
    net: Net
    hinges: np.ndarray       # (h, 4) points a, b, c, d of each: edge a–b, the faces' other corners c and d
    fold: np.ndarray         # (h,) angle that each wants [rad]; 0 is flat
    stiffness: float         # share of the error of a fold that is taken at each visit [-]
    obstacle: Obstacle


class Balloon(NamedTuple):
    """A closed net full of air."""
    net: Net
    faces: np.ndarray        # (f, 3) corners, counter-clockwise seen from outside
    volume: float            # that it wants [m³]
    alpha: float             # compliance of the air [m³/(N/m²)]: 0 keeps the volume
    obstacle: Obstacle


class Hung(NamedTuple):
    """A rigid body that hangs from a fixed point."""
    m: float                 # mass [kg]
    I_body: np.ndarray       # (3,) principal moments [kg m²]
    gravity: np.ndarray      # (3,) [m/s²]
    pivot: np.ndarray        # (3,) [m]
    arm_body: np.ndarray     # (3,) from the centre of mass to the pivot, in the body's coordinates [m]
    sweeps: int              # projections in a step


# ---------------------------------------------------------------------------------------------- one constraint

def distance_constraint(x_i, x_j, rest):
    """(C, n) of the constraint that two points (d,) are `rest` apart: how much too far they are [m], and its gradient for i.

    C = |x_i − x_j| − rest,      n = ∇ᵢC = (x_i − x_j)/|x_i − x_j|,      ∇ⱼC = −n

    Raises BadInput("the length of a link [m]", 0.0, "keep its ends apart") when the ends coincide: then it has no direction.
    *Source:* deck B, "Inextensible spring between particles i and j".
    """
    ### BEGIN SOLUTION 8.1
    r = x_i - x_j
    length = np.sqrt(np.sum(r * r))
    if length == 0.0:
        raise BadInput("the length of a link [m]", 0.0, "keep its ends apart")
    return length - rest, r / length
    ### END SOLUTION


def projection(C, gradients, inv_mass):
    """Corrections (k, d) [m] of the k points of one constraint that make it hold, as far as its gradients (k, d) tell.

    Δxₖ = wₖ Λ ∇ₖC,      Λ = −C / Σ wₖ |∇ₖC|²          Λ = Δλ dt²: the step cancels, so it is not asked for

    Each goes along its gradient, and by its inverse mass: what is heavy moves little, and Σ mₖ Δxₖ = Λ Σ ∇ₖC.
    Raises BadInput("Σ w |∇C|² of a constraint", 0.0, "let one of its points have a mass and a gradient") where nothing can move.
    *Source:* deck B, "Applying a constraint force"; Müller et al. 2006, section 3.3.
    """
    ### BEGIN SOLUTION 8.2
    total, d = 0.0, gradients.shape[1]
    for k in range(inv_mass.size):
        for c in range(d):
            total += inv_mass[k] * gradients[k, c] * gradients[k, c]
    if total == 0.0:
        raise BadInput("Σ w |∇C|² of a constraint", 0.0, "let one of its points have a mass and a gradient")
    corrections = np.zeros(gradients.shape)
    for k in range(inv_mass.size):
        for c in range(d):
            corrections[k, c] = -C / total * inv_mass[k] * gradients[k, c]
    return corrections
    ### END SOLUTION


# ---------------------------------------------------------------------------------------------- the projection method

def falling_acceleration(t, x, v, net):
    """Given.  a (n, d) [m/s²]: gravity for everything that has a mass."""
    a = np.zeros(x.shape)
    for k in range(x.shape[0]):
        if net.inv_mass[k] > 0.0:
            for c in range(x.shape[1]):
                a[k, c] = net.gravity[c]
    return a


def predict(acceleration, t, x, v, dt, net):
    """Where the points (n, d) would be at t + dt if there were no constraints:  x_pred = x + dt v + dt² a(t, x, v).

    An immovable point, inv_mass = 0, feels no force: there a counts as 0, and it goes on with the v that it has.
    *Source:* deck B, q_pred = qₙ + vₙ Δt + M⁻¹ f Δt².
    """
    ### BEGIN SOLUTION 8.3
    a = acceleration(t, x, v, net)
    goal = x + dt * v
    for k in range(x.shape[0]):
        if net.inv_mass[k] > 0.0:
            for c in range(x.shape[1]):
                goal[k, c] += dt * dt * a[k, c]
    return goal
    ### END SOLUTION


def constraints(x, net):
    """Given.  (C (s,), J (s, n d)) of all links: C as in distance_constraint; row s of J is the gradient of Cₛ by x.ravel()."""
    d = x.shape[1]
    C, J = np.zeros(net.i.size), np.zeros((net.i.size, x.size))
    for s in range(net.i.size):
        i, j = net.i[s], net.j[s]
        C[s], n = distance_constraint(x[i], x[j], net.rest[s])
        for c in range(d):
            J[s, i * d + c], J[s, j * d + c] = n[c], -n[c]
    return C, J


def newton_correction(x, lam, goal, dt, net):
    """(Δx (n, d) [m], λ (s,) [N]): one round of Newton's method for positions and multipliers at once, from a guess (x, λ).

    wanted:  x − x_pred − dt² W Σ λₛ ∇Cₛ(x) = 0  and  Cₛ(x) = 0.      Linear about the guess, with the new λ, of both:
        (1 − dt² W Σ λₛ ∇²Cₛ) Δx − dt² W Jᵀ λ_new = x_pred − x
        J Δx − ε dt² (λ_new − λ)                  = −C              ε = TRACE (w_i + w_j) of each link
    ε is a trace of compliance.  It acts on the change λ_new − λ, not on λ: where Newton's method comes to rest the change is 0, and so
    is its effect.  It decides between multipliers that do the same, where links are redundant (a square with both diagonals): without
    it the matrix has no inverse there.
    Λ = dt² λ_new is the better unknown, because it is of one size with x.  The second row for it, with −ε on the diagonal:
        J Δx − ε Λ = −C − ε dt² λ

    W: the inverse mass of each coordinate of x.ravel();  (C, J) = constraints(x, net);  goal (n, d) is x_pred.
    ∇²C of a link: H = (1 − n nᵀ)/l for the ends (i, i) and (j, j), −H for (i, j) and (j, i);  l = C + rest.
    solve(matrix, right) solves it.
    *Source:* deck B, "Solve for q and λ₁, λ₂, … simultaneously using Newton's method".
    """
    ### BEGIN SOLUTION 8.4
    d, size = x.shape[1], x.size
    C, J = constraints(x, net)
    A, right, change = np.zeros((size + C.size, size + C.size)), np.zeros(size + C.size), np.zeros(x.shape)
    for k in range(size):
        A[k, k], right[k] = 1.0, goal[k // d, k % d] - x[k // d, k % d]
    for s in range(C.size):
        trace = TRACE * (net.inv_mass[net.i[s]] + net.inv_mass[net.j[s]])
        A[size + s, size + s], right[size + s] = -trace, -C[s] - trace * dt * dt * lam[s]
        for e in (net.i[s], net.j[s]):
            for a in range(e * d, e * d + d):
                A[size + s, a], A[a, size + s] = J[s, a], -net.inv_mass[e] * J[s, a]
                for f in (net.i[s], net.j[s]):                           # J at i is n, at j −n: J Jᵀ has the sign of each block in it
                    for b in range(f * d, f * d + d):
                        same = (1.0 if e == f else -1.0) if a % d == b % d else 0.0
                        A[a, b] -= dt * dt * net.inv_mass[e] * lam[s] * (same - J[s, a] * J[s, b]) / (C[s] + net.rest[s])
    found = solve(A, right)
    for k in range(size):
        change[k // d, k % d] = found[k]
    return change, found[size:] / (dt * dt)
    ### END SOLUTION


def projection_step(acceleration, t, x, v, dt, net):
    """Advance a net by one step of the lecture's projection method: all λ at once, so that every link has its length; first order.

    x_pred = predict(…);  from the guess (x, λ = 0) add newton_correction's Δx, and take its λ, until |Δx| of every coordinate is at
    most NEWTON_TOLERANCE times the longest link;  then  vₙ₊₁ = (xₙ₊₁ − xₙ)/dt.

    Raises Diverged("the projection did not converge at dt [s]", dt, "take a smaller step, or slacken what is taut") after NEWTON_LIMIT rounds: where no
    finite λ holds the links, too, as in a rope that is taut between two fixed ends and pulled aside.
    *Source:* deck B, "Projection method"; an implicit Euler method: it takes energy, and more with longer steps.
    """
    ### BEGIN SOLUTION 8.5
    goal = predict(acceleration, t, x, v, dt, net)
    new, lam, longest = x.copy(), np.zeros(net.i.size), np.max(net.rest)
    for _ in range(NEWTON_LIMIT):
        change, lam = newton_correction(new, lam, goal, dt, net)
        new = new + change
        if np.max(np.abs(change)) <= NEWTON_TOLERANCE * longest:
            return new, (new - x) / dt
    raise Diverged("the projection did not converge at dt [s]", dt, "take a smaller step, or slacken what is taut")
    ### END SOLUTION


def rattle_step(acceleration, t, x, v, dt, net):
    """Given.  The same, with the gradients taken where the step begins, and with a velocity that obeys the links: second order.

    x' = x + dt v + ½dt² a + W J(x)ᵀΛ  with C(x') = 0,      v' = (x' − x)/dt + ½dt a' + W J(x')ᵀμ  with J(x') v' = 0

    It takes no energy: beyond the lecture, and what the projection method is measured by.
    *Source:* Ryckaert et al. 1977 (SHAKE), Andersen 1983 (RATTLE).
    """
    _, J = constraints(x, net)
    new = x + dt * v + 0.5 * dt * dt * acceleration(t, x, v, net)
    for _ in range(NEWTON_LIMIT):
        C, J_new = constraints(new, net)
        change = pushed(J, solve(met(J_new, J, net, FIRST_TRACE), -C), net)               # each round removes what the trace left
        new = new + change
        if max(np.max(np.abs(change)), np.max(np.abs(C))) <= NEWTON_TOLERANCE * np.max(net.rest):
            v = (new - x) / dt + 0.5 * dt * acceleration(t + dt, new, v, net)
            _, J = constraints(new, net)
            return new, v - pushed(J, solve(met(J, J, net, TRACE), rates(J, v)), net)
    raise Diverged("the projection did not converge at dt [s]", dt, "take a smaller step, or slacken what is taut")


def met(J, K, net, trace):
    """Given.  J W Kᵀ (s, s): how each constraint, with the gradients J, answers a push along the gradients K of each.

    A trace of w_i + w_j is added on the diagonal, so that redundant links have an inverse, too.
    """
    d, A = J.shape[1] // net.inv_mass.size, np.zeros((J.shape[0], K.shape[0]))
    for s in range(J.shape[0]):
        for k in (net.i[s], net.j[s]):                                   # no other point of row s counts
            for r in range(K.shape[0]):
                for c in range(k * d, k * d + d):
                    A[s, r] += net.inv_mass[k] * J[s, c] * K[r, c]
        A[s, s] += trace * (net.inv_mass[net.i[s]] + net.inv_mass[net.j[s]])
    return A


def pushed(J, Lam, net):
    """Given.  W JᵀΛ (n, d) [m]: where multipliers Λ (s,) move the points."""
    d = J.shape[1] // net.inv_mass.size
    moved = np.zeros((net.inv_mass.size, d))
    for s in range(Lam.size):
        for k in (net.i[s], net.j[s]):
            for c in range(d):
                moved[k, c] += net.inv_mass[k] * J[s, k * d + c] * Lam[s]
    return moved


def rates(J, v):
    """Given.  J v (s,) [m/s]: how fast each constraint is being left."""
    rate = np.zeros(J.shape[0])
    for s in range(J.shape[0]):
        rate[s] = np.sum(J[s] * v.ravel())
    return rate


# ---------------------------------------------------------------------------------------------- position-based dynamics

def distance_sweep(x, net):
    """Positions (n, d) after one visit to every link, in their order: each is projected where the ones before have left its ends.

    Δx_i = −s w_i/(w_i + w_j) C n,      Δx_j = +s w_j/(w_i + w_j) C n          s: the stiffness of the link

    That is projection() for two points, times s.  Returns a new array.  (For speed the worked answer sums over the coordinates in a
    loop; what projection returns is as right.)
    Raises BadInput("the length of a link [m]", 0.0, "keep its ends apart") when the ends of a link coincide.
    A link between two immovable points does not occur: make_net refuses it.
    *Source:* deck B, "Loop over all constraints = 1 iteration"; Müller et al. 2006, eqs. 10, 11.
    """
    ### BEGIN SOLUTION 8.6
    x, d = float_copy(x), x.shape[1]
    for s in range(net.i.size):
        i, j = net.i[s], net.j[s]
        squared = 0.0
        for c in range(d):
            squared += (x[i, c] - x[j, c]) ** 2
        if squared == 0.0:
            raise BadInput("the length of a link [m]", 0.0, "keep its ends apart")
        share = net.stiffness[s] * (1.0 - net.rest[s] / np.sqrt(squared)) / (net.inv_mass[i] + net.inv_mass[j])
        for c in range(d):
            push = share * (x[i, c] - x[j, c])
            x[i, c] -= net.inv_mass[i] * push
            x[j, c] += net.inv_mass[j] * push
    return x
    ### END SOLUTION


def pbd_step(acceleration, t, x, v, dt, net):
    """Advance a net by one step of position-based dynamics; first order once its sweeps have converged.

    x_pred = predict(…);   net.sweeps times distance_sweep;   vₙ₊₁ = (xₙ₊₁ − xₙ)/dt

    *Source:* deck B, "Position-based dynamics"; Müller et al. 2006, algorithm 1.
    """
    ### BEGIN SOLUTION 8.7
    new = predict(acceleration, t, x, v, dt, net)
    for _ in range(net.sweeps):
        new = distance_sweep(new, net)
    return new, (new - x) / dt
    ### END SOLUTION


def pbd_sag(g, dt, stiffness, sweeps):
    """How far too low [m] a weight rests that hangs from a single link under PBD: the softness of what should not stretch.

    At rest a step lowers it by g dt², and the sweeps leave the share S = (1 − s)ⁿ of any error:
        (sag + g dt²) S = sag,      sag = g dt² S/(1 − S)

    s: stiffness, above 0 and up to 1; n: sweeps.  Not a property of the link: halve the step, and it is a quarter.
    *Source:* Müller et al. 2006, section 3.3, for S; deck B, "If not enough iterations, constraints appear soft!".
    """
    ### BEGIN SOLUTION 8.8
    S = (1.0 - stiffness) ** sweeps
    return g * dt * dt * S / (1.0 - S)
    ### END SOLUTION


# ---------------------------------------------------------------------------------------------- folds and obstacles

def fold_constraint(x, fold):
    """(C [rad], ∇C (4, 3) [rad/m]) of the constraint that two triangles with a common edge are folded by the angle `fold`.

    x (4, 3): a, b the edge, c and d the other corners.      e = b − a
    N_c = (a − c) × (b − c),   N_d = (b − d) × (a − d)          normals, both on one side of a flat sheet
    θ = atan2((N_c × N_d) · e/|e|,  N_c · N_d),      C = θ − fold, taken into (−π, π]

    ∇_c = −|e| N_c/|N_c|²,      ∇_d = −|e| N_d/|N_d|²
    ∇_a = −β_c ∇_c − β_d ∇_d,   β_c = (b − c)·e/|e|²,  β_d = (b − d)·e/|e|²          so much of a wing's height hangs on a
    ∇_b = −∇_a − ∇_c − ∇_d                                                            nothing is pushed from outside

    Raises BadInput("the area of a triangle at a fold [m²]", 0.0, "keep its corners apart") when a triangle has none.
    *Source:* Müller et al. 2006, section 4.1, for the constraint; Bridson et al. 2003 for an angle that is smooth where it is flat.
    """
    ### BEGIN SOLUTION 8.9
    a, b, c, d = x[0], x[1], x[2], x[3]
    e, N_c, N_d = b - a, cross(a - c, b - c), cross(b - d, a - d)
    squared, length = np.sum(e * e), np.sqrt(np.sum(e * e))
    squared_c, squared_d = np.sum(N_c * N_c), np.sum(N_d * N_d)
    if squared_c == 0.0 or squared_d == 0.0:
        raise BadInput("the area of a triangle at a fold [m²]", 0.0, "keep its corners apart")
    turn = np.arctan2(np.sum(cross(N_c, N_d) * e) / length, np.sum(N_c * N_d)) - fold
    turn -= 2.0 * np.pi * np.ceil((turn - np.pi) / (2.0 * np.pi))
    wing_c, wing_d = -length / squared_c * N_c, -length / squared_d * N_d
    hinge = -np.sum((b - c) * e) / squared * wing_c - np.sum((b - d) * e) / squared * wing_d
    return turn, np.stack((hinge, -hinge - wing_c - wing_d, wing_c, wing_d))
    ### END SOLUTION


def ball_gap(x, obstacle):
    """(φ, n) of a ball that nothing may enter: distance [m] of x (d,) from its skin, negative inside, and the unit normal outwards.

    φ = |x − centre| − radius,      n = ∇φ = (x − centre)/|x − centre|;      in the very middle n = 0

    *Source:* Müller et al. 2006, section 3.4; lesson 3 has the hollow one.
    """
    ### BEGIN SOLUTION 8.10
    r = x - obstacle.centre
    distance = np.sqrt(np.sum(r * r))
    return distance - obstacle.radius, r / distance if distance > 0.0 else 0.0 * r
    ### END SOLUTION


def floor_gap(x, obstacle):
    """Given.  (φ, n) of the floor:  φ = (x − point) · n."""
    return np.sum((x - obstacle.point) * obstacle.n), obstacle.n


def keep_outside(surface, x, inv_mass, obstacle):
    """Positions (n, d) with every point that has got into an obstacle put back onto its skin: the constraint φ ≥ 0, one point each.

    (φ, n) = surface(x_k, obstacle);   where φ < 0 and the point can move (w_k > 0):   x_k ← x_k − φ n

    An inequality acts one way: a point outside is left alone.  Returns a new array.
    *Source:* Müller et al. 2006, section 3.4; deck B, "Project particle out".
    """
    ### BEGIN SOLUTION 8.11
    x = float_copy(x)
    for k in range(x.shape[0]):
        phi, n = surface(x[k], obstacle)
        if phi < 0.0 and inv_mass[k] > 0.0:
            x[k] -= phi * n
    return x
    ### END SOLUTION


def fold_sweep(x, cloth):
    """Given.  Positions after one visit to every fold of a cloth."""
    x = float_copy(x)
    for h in range(cloth.fold.size):
        corners, w = np.zeros((4, 3)), np.zeros(4)
        for k in range(4):
            corners[k], w[k] = x[cloth.hinges[h, k]], cloth.net.inv_mass[cloth.hinges[h, k]]
        C, gradients = fold_constraint(corners, cloth.fold[h])
        corrections = projection(cloth.stiffness * C, gradients, w)
        for k in range(4):
            x[cloth.hinges[h, k]] += corrections[k]
    return x


def cloth_step(acceleration, t, x, v, dt, cloth):
    """Given.  pbd_step for a cloth that resists folding and meets a ball and a floor."""
    new = predict(acceleration, t, x, v, dt, cloth.net)
    for _ in range(cloth.net.sweeps):
        new = distance_sweep(new, cloth.net)
        new = fold_sweep(new, cloth)
        new = keep_outside(ball_gap, new, cloth.net.inv_mass, cloth.obstacle)
        new = keep_outside(floor_gap, new, cloth.net.inv_mass, cloth.obstacle)
    return new, (new - x) / dt


# ---------------------------------------------------------------------------------------------- XPBD: a compliance of its own

def compliant_multiplier(C, Lam, weight, alpha_scaled):
    """ΔΛ [N s²] for one visit to a constraint that gives way: a spring of stiffness 1/α, at any step and any number of sweeps.

    ΔΛ = (−C − α̃ Λ)/(weight + α̃),      α̃ = α/dt²          weight = Σ w |∇C|²

    Λ = λ dt² is what earlier visits of this step have added up to.  It comes to rest where C = −α̃ Λ = −α λ: Hooke's law.
    alpha_scaled is α̃: it is the same for all visits of a step, so the caller divides once.
    Raises BadInput("scaled compliance α/dt² [1/kg]", α̃, "give zero or more") for a negative one (NaN, too), and
    BadInput("Σ w |∇C|² of a constraint", 0.0, "let one of its points have a mass and a gradient") for a weight of 0.
    *Source:* Macklin, Müller and Chentanez 2016, eq. 18.
    """
    ### BEGIN SOLUTION 8.12
    if not alpha_scaled >= 0.0:
        raise BadInput("scaled compliance α/dt² [1/kg]", alpha_scaled, "give zero or more")
    if weight == 0.0:
        raise BadInput("Σ w |∇C|² of a constraint", 0.0, "let one of its points have a mass and a gradient")
    return (-C - alpha_scaled * Lam) / (weight + alpha_scaled)
    ### END SOLUTION


def compliant_sweep(x, Lam, dt, net):
    """(x (n, d), Λ (s,)) after one visit to every link, in their order, each as compliant as its α says.

    ΔΛ = compliant_multiplier(C, Λₛ, w_i + w_j, αₛ/dt²);      Λₛ ← Λₛ + ΔΛ,   x_i ← x_i + w_i ΔΛ n,   x_j ← x_j − w_j ΔΛ n

    C and n as in distance_constraint, where the visits before have left the ends.  Returns new arrays.
    Raises what distance_constraint and compliant_multiplier raise.
    *Source:* Macklin et al. 2016, algorithm 1.
    """
    ### BEGIN SOLUTION 8.13
    x, Lam, d = float_copy(x), float_copy(Lam), x.shape[1]
    per_square = 1.0 / (dt * dt)
    for s in range(net.i.size):
        i, j = net.i[s], net.j[s]
        squared = 0.0
        for c in range(d):
            squared += (x[i, c] - x[j, c]) ** 2
        if squared == 0.0:
            raise BadInput("the length of a link [m]", 0.0, "keep its ends apart")
        length = np.sqrt(squared)
        change = compliant_multiplier(length - net.rest[s], Lam[s], net.inv_mass[i] + net.inv_mass[j], net.alpha[s] * per_square)
        Lam[s] += change
        for c in range(d):
            push = change / length * (x[i, c] - x[j, c])
            x[i, c] += net.inv_mass[i] * push
            x[j, c] -= net.inv_mass[j] * push
    return x, Lam
    ### END SOLUTION


def xpbd_step(acceleration, t, x, v, dt, net):
    """Advance a net by one step of XPBD: pbd_step with compliant_sweep, and Λ = 0 at the beginning of every step; first order.

    Many short steps with one sweep each are worth more than one step with as many sweeps: dt² makes every link heavier to move.
    *Source:* Macklin et al. 2016; Macklin et al. 2019, "Small steps in physics simulation".
    """
    ### BEGIN SOLUTION 8.14
    new, Lam = predict(acceleration, t, x, v, dt, net), np.zeros(net.i.size)
    for _ in range(net.sweeps):
        new, Lam = compliant_sweep(new, Lam, dt, net)
    return new, (new - x) / dt
    ### END SOLUTION


# ---------------------------------------------------------------------------------------------- rigid bodies

def generalised_inverse_mass(q, r, n, m, I_body):
    """w [1/kg]: how readily a point of a rigid body, at the offset r (3,) [m] from its centre of mass, gives way along n (3,).

    w = 1/m + (r × n)ᵀ I⁻¹ (r × n)          I⁻¹ = R I_body⁻¹ Rᵀ: unrotate(q, ·) turns a vector into the body's coordinates

    r and n in the world's coordinates.  A point mass has w = 1/m; far from the centre of mass a body is light.
    *Source:* Müller et al. 2020, "Detailed rigid body simulation with extended position based dynamics", eqs. 2, 3.
    """
    ### BEGIN SOLUTION 8.15
    turn = unrotate(q, cross(r, n))
    return 1.0 / m + np.sum(turn * turn / I_body)
    ### END SOLUTION


def push_body(x, q, r, p, m, I_body):
    """(x (3,), q (4,)) of a rigid body after p (3,) [kg m] has been applied at the offset r (3,) from its centre of mass.

    x ← x + p/m,      q ← quaternion_update(q, I⁻¹ (r × p), 1)          p = λ dt² ∇C: an impulse times a time

    Everything in the world's coordinates; rotate and unrotate (lesson 5) lead to the body's, where I is the diagonal I_body.
    *Source:* Müller et al. 2020, eqs. 6 to 9.
    """
    ### BEGIN SOLUTION 8.16
    turn = rotate(q, unrotate(q, cross(r, p)) / I_body)
    return x + p / m, quaternion_update(q, turn, 1.0)
    ### END SOLUTION


def turning_rate(q_old, q_new, dt):
    """ω [rad/s] (3,) that quaternion_update would need to lead from one orientation to the other in dt: the v = Δx/dt of rotations.

    Δq = q_new q̄_old = (Δ₀, 𝚫),      ω = 2 𝚫/(Δ₀ dt)          q̄ = (w, −x, −y, −z);   the same for q and −q

    product(a, b) multiplies quaternions (lesson 5).  *Left out:* half a turn in one step, Δ₀ = 0.
    *Source:* Müller et al. 2020, algorithm 2; the division by Δ₀ makes it the exact inverse of quaternion_update.
    """
    ### BEGIN SOLUTION 8.17
    turn = product(q_new, np.array([q_old[0], -q_old[1], -q_old[2], -q_old[3]]))
    return 2.0 / (turn[0] * dt) * turn[1:]
    ### END SOLUTION


def hung_step(t, x, v, q, omega, dt, body):
    """Given.  Advance a Hung body by one step: (x, v, q, ω); first order.  Its pivot is one constraint, C = |x + r − pivot|."""
    new, turned = x + dt * v + dt * dt * body.gravity, omega + dt * angular_acceleration(q, omega, np.zeros(3), body.I_body)
    turned = quaternion_update(q, turned, dt)
    for _ in range(body.sweeps):
        r = rotate(turned, body.arm_body)
        gap = new + r - body.pivot
        C = np.sqrt(np.sum(gap * gap))
        if C > 0.0:
            w = generalised_inverse_mass(turned, r, gap / C, body.m, body.I_body)
            new, turned = push_body(new, turned, r, -gap / w, body.m, body.I_body)
    return new, (new - x) / dt, turned, turning_rate(q, turned, dt)


# ---------------------------------------------------------------------------------------------- a soft ball

def volume_gradient(x, faces):
    """(V [m³], ∇V (n, 3) [m²]) of a closed surface with corners x (n, 3) and triangles faces (f, 3).

    V = Σ a · (b × c)/6 over the faces (a, b, c), counter-clockwise seen from outside;      each adds to
    ∇_a V:  b × c/6,      ∇_b V:  c × a/6,      ∇_c V:  a × b/6

    *Source:* Müller et al. 2006, section 4.2, balloons; the divergence theorem.
    """
    ### BEGIN SOLUTION 8.18
    V, gradient = 0.0, np.zeros(x.shape)
    for f in range(faces.shape[0]):
        a, b, c = x[faces[f, 0]], x[faces[f, 1]], x[faces[f, 2]]
        across = cross(b, c) / 6.0
        V += np.sum(a * across)
        gradient[faces[f, 0]] += across
        gradient[faces[f, 1]] += cross(c, a) / 6.0
        gradient[faces[f, 2]] += cross(a, b) / 6.0
    return V, gradient
    ### END SOLUTION


def balloon_step(acceleration, t, x, v, dt, balloon):
    """Given.  xpbd_step for a closed net whose volume is one more constraint, above a floor.  Links first, then the air, then the floor."""
    net = balloon.net
    new, Lam, air = predict(acceleration, t, x, v, dt, net), np.zeros(net.i.size), 0.0
    for _ in range(net.sweeps):
        new, Lam = compliant_sweep(new, Lam, dt, net)
        V, gradient = volume_gradient(new, balloon.faces)
        weight = 0.0
        for k in range(x.shape[0]):
            weight += net.inv_mass[k] * np.sum(gradient[k] * gradient[k])
        change = compliant_multiplier(V - balloon.volume, air, weight, balloon.alpha / (dt * dt))
        air += change
        for k in range(x.shape[0]):
            new[k] += change * net.inv_mass[k] * gradient[k]
        new = keep_outside(floor_gap, new, net.inv_mass, balloon.obstacle)
    return new, (new - x) / dt


# ---------------------------------------------------------------------------------------------- building

def make_net(x, m, fixed, pairs, alpha, stiffness, gravity, sweeps):
    """Given.  A Net whose links have the lengths that they have at x.

    x (n, d); m [kg], alpha [m/N] and stiffness [-] are numbers or one each; fixed lists point numbers; pairs (s, 2); gravity (d,).
    Raises BadInput for a mass that is not positive, a state that is not finite, a link without length or between two immovable
    points, a negative compliance, a stiffness outside 0 … 1 or equal to 0, fewer than one sweep, a point number that is none, gravity
    of another dimension than x.
    """
    x, gravity = finite_array("a position of the net [m]", x), finite_array("gravity [m/s²]", gravity)
    inv_mass = inverse_masses("a mass of the net [kg]", m, fixed, x)
    check_shape("gravity", gravity, x.shape[1:])
    i, j, rest = measured_links("link", x, pairs)
    alphas, shares = one_each("compliance α [m/N]", alpha, len(i)), one_each("stiffness of a link [-]", stiffness, len(i))
    for s in range(len(i)):
        if rest[s] == 0.0:
            raise BadInput(f"the length of link {s} from point {i[s]} to {j[s]} [m]", 0.0, "move its ends apart")
        if inv_mass[i[s]] + inv_mass[j[s]] == 0.0:
            raise BadInput(f"the inverse mass at link {s} from point {i[s]} to {j[s]} [1/kg]", 0.0, "leave out links between immovable points")
        if not 0.0 < shares[s] <= 1.0:
            raise BadInput(f"the stiffness of link {s} [-]", shares[s], "give a number above 0, up to 1")
    return Net(inv_mass, gravity, i, j, rest, shares, alphas, whole_number("sweeps in a step", sweeps, 1))


def shared_edges(faces):
    """Given.  (edges (e, 2), hinges (h, 4)) of triangles (f, 3): every edge once, and a, b, c, d for each that two of them share."""
    found = {}
    for face in np.asarray(faces):
        for k in range(3):
            a, b, c = face[k], face[(k + 1) % 3], face[(k + 2) % 3]
            found.setdefault((min(a, b), max(a, b)), []).append((a, b, c))
    hinges = [(*two[0], two[1][2]) for two in found.values() if len(two) == 2]
    return np.array(sorted(found), dtype=np.int64), np.array(hinges, dtype=np.int64).reshape(-1, 4)
