"""Lesson 8.  Constraints by projection: move the points freely first, then move them to where the constraints hold.

    Cⱼ(x) = 0 for every constraint j,      xₙ₊₁ = x_pred + Σⱼ M⁻¹ λⱼ ∇Cⱼ(xₙ₊₁) dt²,      vₙ₊₁ = (xₙ₊₁ − xₙ)/dt

Symbols: x (n, d) [m] positions of n points in d dimensions · v (n, d) [m/s] · inv_mass (n,), w [1/kg] (0: immovable) ·
C constraint [m] or [rad] or [m³] · ∇C its gradient · λ [N] multiplier: minus the tension of a link ·
α [m/N] compliance, one over stiffness · q (4,) = (w, x, y, z) orientation · ω (3,) [rad/s] ·
n unit normal or direction, from b (or j) to a (or i).

A method for points is a function  step(acceleration, t, x, v, dt, network) → (x, v)  at t + dt, as in lesson 1.
The step passes network on unchanged.
Given in solutions/given/pbd.py: make_constraint_network, network_gravity, the standard rattle_step, and objects that
consist of parts of this lesson: a cloth, a balloon, a rigid body on a pivot.
*Left out:* friction (lesson 3 adds it to such a step); collision of a cloth with itself (lesson 6 finds it).
"""

from typing import NamedTuple

import numpy as np

from solutions.checks import BadInput, Diverged, float_copy
from solutions.given.ropes import composed_rope_step, rope_step
from solutions.integrators import solve
from solutions.rotation import angular_acceleration, quaternion_product, quaternion_update, rotate, unrotate
from solutions.support.networks import shared_edges
from solutions.vectors import cross, distance_between, dot, move_apart

__all__ = [
    "NEWTON_LIMIT", "REGULARISATION", "ConstraintNetwork", "Obstacle", "angular_acceleration",
    "apply_positional_impulse", "ball_gap", "circling_speed", "compliant_multiplier", "compliant_sweep",
    "composed_rope_step", "constraint_correction", "constraint_projection_step", "constraints", "distance_constraint",
    "distance_sweep", "effective_inverse_mass_at", "floor_gap", "fold_constraint", "keep_outside", "my_thing",
    "newton_correction", "pbd_sag", "pbd_step", "predict", "rope_step", "shared_edges", "substeps_are",
    "turning_rate", "volume_gradient", "xpbd_step",
]

NEWTON_TOLERANCE = 1e-12     # last correction over the longest link [-]; Newton squares it, so only round-off remains
NEWTON_LIMIT = 40            # corrections [-]: 5 or 6 for moves of 1/10 link per step, about 7 for one link, rarely 30
REGULARISATION = 1e-13       # compliance over w dt² of a link [-]: far below the pull of all links, far above round-off


class ConstraintNetwork(NamedTuple):
    """Points and the links between them: a pendulum, a rope, a cloth."""
    inv_mass: np.ndarray     # (n,) [1/kg]; 0: immovable, neither forces nor links change its velocity
    gravity: np.ndarray      # (d,) [m/s²]
    i: np.ndarray            # (s,) one end of each link
    j: np.ndarray            # (s,) the other
    rest: np.ndarray         # (s,) its rest length [m]
    stiffness: np.ndarray    # (s,) share of the error that PBD removes per visit [-], above 0 and up to 1
    alpha: np.ndarray        # (s,) compliance of the link in XPBD [m/N]; 0: inextensible
    sweeps: int              # visits to every link per step


class Obstacle(NamedTuple):
    """A ball that does not move, above a floor, for a cloth to fall on."""
    centre: np.ndarray       # (d,) [m]
    radius: float            # [m]; 0: no ball, because no point is inside it
    point: np.ndarray        # (d,) a point of the floor [m]
    n: np.ndarray            # (d,) its unit normal


# ---------------------------------------------------------------------------------------------- one constraint

def distance_constraint(x_i, x_j, rest):
    """Return (C, n): the distance of two points (d,) minus `rest` [m], and the gradient of C with respect to point i.

    *Find* the gradient n = ∇ᵢC (d,).  In which direction must point i move for C to grow fastest, and by how much does
    C grow for each metre of it?

    Raises BadInput("the length of a link [m]", 0.0, "keep its ends apart") when the ends coincide.
    *Source:* second lecture deck, “Inextensible spring between particles i and j”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 8.1: distance_constraint")


def constraint_correction(C, gradients, inv_mass):
    """Return the corrections (k, d) [m] of the k points of one constraint that satisfy it to first order.

    *Find* the number Λ.  Each point moves along its gradient, in proportion to its inverse mass:  Δxₖ = wₖ Λ ∇ₖC.  To
    first order these moves bring the constraint to zero:  C + Σ ∇ₖC · Δxₖ = 0.

    C is the value of the constraint and gradients (k, d) are its ∇ₖC.  Heavy points move little.  Λ is Δλ dt², and dt
    cancels, so it is not an argument.
    Raises BadInput("Σ w |∇C|² of a constraint", 0.0, "let one of its points have a mass and a gradient") where
    no point can move, even where C = 0.
    *Source:* second lecture deck, “Applying a constraint force”; Müller et al. 2006, section 3.3.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 8.2: constraint_correction")


# ---------------------------------------------------------------------------------------------- the projection method

def predict(acceleration, t, x, v, dt, network):
    """Return the positions (n, d) at t + dt without constraints:  x_pred = x + dt v + dt² a(t, x, v).

    An immovable point (inv_mass = 0) feels no force: its a counts as 0, and it keeps its velocity v.
    *Source:* second lecture deck, q_pred = qₙ + vₙ Δt + M⁻¹ f Δt².
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 8.3: predict")


def constraints(x, network):
    """Given.  Return (C (s,), J (s, n d)) of all links: C as in distance_constraint, row s of J = ∂Cₛ/∂x.ravel()."""
    d = x.shape[1]
    C, J = np.zeros(network.i.size), np.zeros((network.i.size, x.size))
    for s in range(network.i.size):
        i, j = network.i[s], network.j[s]
        C[s], n = distance_constraint(x[i], x[j], network.rest[s])
        for c in range(d):
            J[s, i * d + c] = n[c]
            J[s, j * d + c] = -n[c]
    return C, J


def newton_correction(x, lam, goal, dt, network):
    """Return (Δx (n, d) [m], λ (s,) [N]): one Newton iteration for positions and multipliers together.

    It solves  x − x_pred − dt² W Σ λₛ ∇Cₛ(x) = 0  and  Cₛ(x) = 0.  Both equations, linearised about the guess
    (x, λ), with the new multipliers λ_new as unknowns:
        (1 − dt² W Σ λₛ ∇²Cₛ) Δx − dt² W Jᵀ λ_new = x_pred − x
        J Δx − ε dt² (λ_new − λ)                  = −C              ε = REGULARISATION (w_i + w_j) of each link
    ε dt² is a very small compliance [m/N], and ε [1/kg] is the same over dt².  It acts only on the change λ_new − λ,
    so it has no effect at convergence.
    Redundant links (a square with both diagonals) have many equivalent multipliers.  ε selects one set of them; without
    ε the matrix has no inverse.
    Use Λ = dt² λ_new as the unknown, because its size is comparable to that of x.  The second equation becomes
        J Δx − ε Λ = −C − ε dt² λ          with −ε on the diagonal

    W is the inverse mass of each coordinate of x.ravel();  (C, J) = constraints(x, network);  goal (n, d) is x_pred.
    ∇²C of a link: H = (1 − n nᵀ)/l for the ends (i, i) and (j, j), −H for (i, j) and (j, i);  l = C + rest.
    Solve the system with solve(matrix, right).  The worked answer fills the matrix entry by entry, because block
    assignments would multiply the compile time.
    *Source:* second lecture deck, “Solve for q and λ₁, λ₂, … simultaneously using Newton's method”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 8.4: newton_correction")


def constraint_projection_step(acceleration, t, x, v, dt, network):
    """Advance a network by one step of the lecture's projection method: all λ together, every link exact; first order.

    x_pred = predict(…).  Start from x itself (not x_pred) and λ = 0.  Add Δx of newton_correction and take its λ,
    until |Δx| of every coordinate is at most NEWTON_TOLERANCE times the longest link (0 if there is none).  Then
    vₙ₊₁ = (xₙ₊₁ − xₙ)/dt.

    Raises Diverged("the projection did not converge at dt [s]", dt, "take a smaller step, or slacken what is taut")
    after NEWTON_LIMIT iterations.  That includes networks which no finite λ can hold, such as a rope that is taut
    between two fixed ends and pulled sideways.
    *Source:* second lecture deck, “Projection method”; an implicit Euler method, which loses more energy with
    longer steps.
    *Left out:* a network at 10⁴ times its longest link from the origin, where coordinates are rounded by more than the
    tolerance.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 8.5: constraint_projection_step")


# ---------------------------------------------------------------------------------------------- position-based dynamics

def distance_sweep(x, network):
    """Return the positions (n, d) after one visit to every link, in order; each visit uses the ends as left so far.

    Δx_i = −s w_i/(w_i + w_j) C n,      Δx_j = +s w_j/(w_i + w_j) C n          s: the stiffness of the link

    These are the corrections of constraint_correction for two points, times s.  They depend on neither network.sweeps
    nor alpha.
    distance_between(x, i, j) and move_apart(x, i, j, k_i, k_j, x) of vectors.py compute them fast.
    Returns a new array.
    Raises BadInput("the length of a link [m]", 0.0, "keep its ends apart") when the ends of a link coincide.
    A link between two immovable points does not occur: make_constraint_network refuses it.
    *Source:* second lecture deck, “Loop over all constraints = 1 iteration”; Müller et al. 2006, eqs. 10, 11.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 8.6: distance_sweep")


def pbd_step(acceleration, t, x, v, dt, network):
    """Advance a network by one step of position-based dynamics; first order once its sweeps have converged.

    x_pred = predict(…);   distance_sweep network.sweeps times;   vₙ₊₁ = (xₙ₊₁ − xₙ)/dt

    *Source:* second lecture deck, “Position-based dynamics”; Müller et al. 2006, algorithm 1.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 8.7: pbd_step")


def pbd_sag(g, dt, stiffness, sweeps):
    """Return the sag [m] of a weight that hangs at rest from a single link under PBD; an inextensible link has none.

    predict first lowers the weight by g dt².  Then each of the n sweeps removes a fraction s of the error that it
    finds.
    *Find* the sag at which a step ends where it began.

    s: stiffness, up to 1, and above 0 by so much that 1 − s keeps its digits; n: sweeps.  The sag is not a property of
    the link: half the step gives a quarter of it.
    *Source:* Müller et al. 2006, section 3.3; second lecture deck, “If not enough iterations, constraints appear soft!”
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 8.8: pbd_sag")


# ---------------------------------------------------------------------------------------------- folds and obstacles

def fold_constraint(x, fold):
    """Return (C [rad], ∇C (4, 3) [rad/m]): the error of the fold angle of two triangles with a common edge.

    x (4, 3) holds the corners: a and b of the edge, c and d opposite to it.      e = b − a
    Compute with dot and cross, which are imported: |e| is np.sqrt(dot(e, e)).
    N_c = (a − c) × (b − c),   N_d = (b − d) × (a − d)          normals, both on one side of a flat sheet
    θ = atan2((N_c × N_d) · e/|e|,  N_c · N_d),      C = θ − fold, taken into (−π, π]; for half a turn −π counts, too

    ∇_c = −|e| N_c/|N_c|²,      ∇_d = −|e| N_d/|N_d|²
    ∇_a = −β_c ∇_c − β_d ∇_d,   β_c = (b − c)·e/|e|²,  β_d = (b − d)·e/|e|²          leverage of each wing at a
    ∇_b = −∇_a − ∇_c − ∇_d                                                            no net force from outside

    Raises BadInput("the area of a triangle at a fold [m²]", 0.0, "keep its corners apart") where a computed area is 0.
    Different corners on one line may leave an area of round-off, which passes.
    *Source:* Müller et al. 2006, section 4.1; Bridson et al. 2003 for an angle that is smooth at a flat fold.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 8.9: fold_constraint")


def ball_gap(x, obstacle):
    """Return (φ, n) of a solid ball: distance [m] of x (d,) from its surface, negative inside, and the outward normal.

    *Find* both.  n is the gradient ∇φ, a unit vector.  At the centre, where no direction leads out fastest, n = 0.

    A radius of 0 needs no case of its own: φ is then the distance from the centre, and no point is inside.
    *Source:* Müller et al. 2006, section 3.4; the hollow ball is in lesson 3.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 8.10: ball_gap")


def floor_gap(x, obstacle):
    """Given.  Return (φ, n) of the floor:  φ = (x − point) · n."""
    return np.sum((x - obstacle.point) * obstacle.n), obstacle.n


def keep_outside(surface, x, inv_mass, obstacle):
    """Return the positions (n, d) with every movable point that is inside an obstacle moved back to its surface.

    The constraint of each point is φ ≥ 0.
    (φ, n) = surface(x_k, obstacle);   where φ < 0 and the point can move (w_k > 0):   x_k ← x_k − φ n

    A point outside stays where it is, and so does a point at the centre of a ball, where n = 0.  Returns a new array.
    *Source:* Müller et al. 2006, section 3.4; second lecture deck, “Project particle out”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 8.11: keep_outside")


# ---------------------------------------------------------------------------------------------- XPBD: compliant links

def compliant_multiplier(C, Lam, weight, alpha_scaled):
    """Return ΔΛ [N s²] for one visit to a compliant constraint: a spring of stiffness 1/α for every step.

    Λ = λ dt² is the sum of the ΔΛ of earlier visits in this step.  A visit with ΔΛ changes C by weight ΔΛ, to first
    order; weight = Σ w |∇C|².  *Find* the ΔΛ after which C and Λ, both with their new values, obey Hooke's law:
        C = −α λ = −α̃ Λ,      α̃ = α/dt²
    alpha_scaled is α̃.  It is the same for all visits of a step, so the caller divides once.
    Raises BadInput("scaled compliance α/dt² [1/kg]", α̃, "give zero or more") for a negative α̃ or NaN, and
    BadInput("Σ w |∇C|² of a constraint", 0.0, "let one of its points have a mass and a gradient") for a weight of 0.
    *Source:* Macklin, Müller and Chentanez 2016, eq. 18.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 8.12: compliant_multiplier")


def compliant_sweep(x, Lam, dt, network):
    """Return (x (n, d), Λ (s,)) after one visit to every link, in order, with the compliance α of each.

    ΔΛ = compliant_multiplier(C, Λₛ, w_i + w_j, αₛ/dt²)
    Λₛ ← Λₛ + ΔΛ,   x_i ← x_i + w_i ΔΛ n,   x_j ← x_j − w_j ΔΛ n

    C and n are those of distance_constraint, for the ends as the earlier visits have left them.  A link that is too
    short pushes its ends apart, also with α = 0.  One visit is enough for a single link.  For a chain, visits repeat
    until all links obey Hooke's law together; before that it is softer than its α.  Returns new arrays.
    Raises what distance_constraint and compliant_multiplier raise.
    *Source:* Macklin et al. 2016, algorithm 1.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 8.13: compliant_sweep")


def xpbd_step(acceleration, t, x, v, dt, network):
    """Advance a network by one step of XPBD: pbd_step with compliant_sweep, from Λ = 0 in every step; first order.

    Many short steps with one sweep each are better than one long step with as many sweeps.  In a step of dt/n the
    points fall n² times less, so a sweep has less to undo, and the velocity carries the progress over to the next
    step.  (Only a very large number of sweeps is better: above about 190 for a chain of 8 equal links, 940 for 16.)
    *Source:* Macklin et al. 2016; Macklin et al. 2019, “Small steps in physics simulation”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 8.14: xpbd_step")


# ---------------------------------------------------------------------------------------------- rigid bodies

def effective_inverse_mass_at(q, r, n, m, I_body):
    """Return w [1/kg] of a point of a rigid body: how easily it moves along n (3,), at the offset r (3,) [m].

    *Find* it.  An impulse p n at that point changes the velocity of the point along n by w p.  It changes the velocity
    of the body, and its angular velocity, and both move the point.

    unrotate(q, ·) of lesson 5 converts a vector to body coordinates, where the tensor is the three moments I_body.
    r starts at the centre of mass.  For a given direction of r × n, w increases with the distance of the centre of mass
    from the line of n through the point.  r and n are in world coordinates.
    *Source:* Müller et al. 2020, “Detailed rigid body simulation with extended position based dynamics”, eqs. 2, 3.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 8.15: effective_inverse_mass_at")


def apply_positional_impulse(x, q, r, p, m, I_body):
    """Return (x (3,), q (4,)) of a rigid body after p (3,) [kg m] acts at the offset r (3,) from its centre of mass.

    x ← x + p/m,      q ← quaternion_update(q, I⁻¹ (r × p), 1)          p = λ dt² ∇C: an impulse times a time

    All vectors are in world coordinates; rotate and unrotate (lesson 5) convert from and to body coordinates.
    *Source:* Müller et al. 2020, eqs. 6 to 9.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 8.16: apply_positional_impulse")


def turning_rate(q_old, q_new, dt):
    """Return the ω [rad/s] (3,) with which quaternion_update turns q_old into q_new in dt: v = Δx/dt for rotations.

    *Find* it as the inverse of quaternion_update, which makes  q_new ∝ q_old + ½ dt (0, ω) q_old.  The length of the
    sum is unknown, because quaternion_update normalises it.  q and −q are the same orientation and give the same ω.

    quaternion_product(a, b) multiplies quaternions (lesson 5); the conjugate of q = (w, x, y, z) is (w, −x, −y, −z).
    *Left out:* half a turn in one step, Δ₀ = 0.
    *Source:* Müller et al. 2020, algorithm 2; the division by Δ₀ makes it the exact inverse of quaternion_update.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 8.17: turning_rate")


# ---------------------------------------------------------------------------------------------- a soft ball

def volume_gradient(x, faces):
    """Return (V [m³], ∇V (n, 3) [m²]) of a closed surface with corners x (n, 3) and triangles faces (f, 3).

    Row k of ∇V is ∂V/∂x_k; it is 0 for a corner that belongs to no face.  Faces are counter-clockwise seen from
    outside.  Where they are clockwise, the surface is inside-out, and V and ∇V have the opposite sign.
    *Find* V as a sum over the faces, and its gradient.  The origin may be anywhere, inside or outside.  Far away it
    costs digits: at a distance of 10⁴ sizes V is off by about 1e-6.

    *Source:* Müller et al. 2006, section 4.4, balloons; the divergence theorem.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 8.18: volume_gradient")


# ---------------------------------------------------------------------------------------------- building


# ---------------------------------------------------------------------------------------------- why?

def circling_speed(v, length, dt, t):
    """Return the speed [m/s] that pbd_step leaves a weight that circles on a string, without gravity and friction.

    It begins with v > 0 [m/s] on a string of this length [m], and t ≥ 0 [s] later its speed should be v.  *Find* what
    is left, for steps dt > 0 [s] with v dt much shorter than the string.  Along which line does predict move the
    weight, and to which place does the projection move it?

    Any number of sweeps gives the same: for one string the first sweep is exact.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 8.19: circling_speed")


def substeps_are():
    """Return the letter of the substeps: "A", "B", "C" or "D".

    The figure of the notebook shows how much too low the end of a chain hangs, against the number n of visits to each
    link per frame.  One curve is for n substeps of one sweep each, and one for a single step with n sweeps.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 8.20: substeps_are")


def my_thing():
    """Return (x, network, frames) of a thing of points and links that holds together.

    *Make it*: x (n, 2) or (n, 3) [m] are the points at the start, at rest, of a ConstraintNetwork for frames of 1/60 s.
    Many things are right: a bridge, a net, a puppet.  The judge runs it by XPBD, four substeps per frame with
    network.sweeps sweeps each, and demands:

    - It has 6 to 60 points, of which three or more are free, and the links join all of them.  At least half of the
      links are rigid (alpha = 0).  It runs for 60 to 300 frames, with at most 10 sweeps.
    - Rigid links are always within 5 % of their rest length.
    - Some point moves by a tenth of the size of the thing, or more.
    - The energy never exceeds that at the start.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 8.21: my_thing")
