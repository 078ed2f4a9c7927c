"""Lesson 7.  Impulses: collisions of zero duration.

Symbols: a, b two bodies · v [m/s], omega [rad/s] · r [m] offset of the contact point from a centre of mass ·
n unit normal, from b to a · u [m/s] velocity of a's contact point relative to b's, u_n = n · u its normal part ·
J, j [N s] impulse on a; b receives −J · e [-] restitution · μ [-] friction · K [1/kg] the response of u to an impulse:
u⁺ = u + K J, and k_n = n · K n · φ [m] gap, n = ∇φ · λ [N s] multiplier of the gap.

The sign ⁺ marks velocities after an impact.  An impact is so short that positions do not change and other forces have
no effect.  An immovable body has inv_mass = 0 and inv_inertia = 0.  A body on an axle through its centre of mass has
only inv_mass = 0, and a body that cannot rotate has only inv_inertia = 0.  In the plane r × n is the number
r_x n_y − r_y n_x, and omega is a number, counter-clockwise.
Given in solutions/given/impulses.py: contact_impulse, penalty_step, a spinning ball, discs, and the loops
advance_balls, advance_spinning_balls and advance_discs.
*Left out:* detection of contacts (lesson 6); lasting contacts, as in a stack (lesson 9).
"""

from typing import NamedTuple

import numpy as np

from .checks import Diverged, check_positive, check_restitution
from .friction import tangential
from .given.impact_modes import settle_impacts
from .given.impacts import (
    CONVERGED,
    MAX_SWEEPS,
    check_contact,
    check_impacts,
    check_inverse_mass,
    largest_speed,
    most_dissipative_impact,
    rebound_speeds,
    times,
)
from .integrators import symplectic_euler_step
from .rotation import point_velocity, solve3
from .vectors import cross

__all__ = [
    "CONVERGED", "MAX_IMPACTS", "MAX_SWEEPS", "BodyState2D", "BodyState3D", "BouncingBall", "angular_momenta",
    "apply_impulse", "apply_impulse_2d", "backtracking_step", "bouncing_time", "check_contact", "check_impacts",
    "check_inverse_mass", "cone_impulse", "contact_matrix", "effective_inverse_mass", "effective_inverse_mass_2d",
    "elastic_rest_time", "energy_change", "falling_acceleration", "free_flight", "gap", "gap_multiplier",
    "impact_time", "impulse_size", "kinematic_response", "largest_speed", "most_dissipative_impact", "my_impulse",
    "penalty_force", "position_projection_step", "relative_velocity", "relative_velocity_2d", "settle_impacts",
    "slide_on_plane", "smooth_rod_is", "solve_impacts", "symplectic_euler_step", "times",
]

MAX_IMPACTS = 10_000         # per step [-]; with e = 0.8, 165 impacts bring the next below the spacing of floats


class BodyState2D(NamedTuple):
    """A body in the plane."""
    v: np.ndarray            # (2,) [m/s]
    omega: float             # [rad/s]
    inv_mass: float          # [1/kg]
    inv_inertia: float       # [1/(kg m²)]


class BodyState3D(NamedTuple):
    """A body in space."""
    v: np.ndarray            # (3,) [m/s]
    omega: np.ndarray        # (3,) [rad/s]
    inv_mass: float          # [1/kg]
    inv_inertia: np.ndarray  # (3, 3) in the world [1/(kg m²)]


class BouncingBall(NamedTuple):
    """A ball without rotation, above a plane."""
    e: float                 # restitution [-]
    gravity: np.ndarray      # (d,) [m/s²]
    point: np.ndarray        # (d,) position of its centre when it touches the plane [m]
    n: np.ndarray            # (d,) unit normal of the plane
    stiffness: float         # of the penalty spring over the mass, ω² [1/s²]
    damping: float           # of the penalty damper over the mass [1/s]


# ----------------------------------------------------------------------------------------- kinematic, and with a spring

def kinematic_response(v, n, e):
    """Return the velocity (d,) of a point after it hits a fixed surface; unchanged where it leaves, v · n ≥ 0.

    *Find* it.  The part of the velocity along the unit normal n is reversed and multiplied by e, and the part along the
    surface stays as it is.

    With e = 0.8 it looks like a ball.
    This is the result of impulse_size against an immovable body without friction, for every mass of the point.
    *Source:* first lecture deck, “Kinematic response”, which calls it not physically based.
    """
    ### BEGIN SOLUTION 7.1
    v_n = v @ n
    return v if v_n >= 0.0 else v - (1.0 + e) * v_n * n
    ### END SOLUTION


def penalty_force(phi, v_n, stiffness, damping):
    """Return the force [N] along n of a spring and a damper that push a body out of an obstacle; they never pull.

    f = max(0, −stiffness φ − damping v_n)  while φ < 0;     0 outside

    φ [m] gap, v_n [m/s] its rate, stiffness [N/m], damping [N s/m].  For an acceleration divide the last two by the
    mass.
    *Source:* first lecture deck, “Penalty method”.
    """
    ### BEGIN SOLUTION 7.2
    return 0.0 if phi >= 0.0 else np.maximum(0.0, -stiffness * phi - damping * v_n)
    ### END SOLUTION


# ---------------------------------------------------------------------------------------------- in the plane

def cross_2d(r, f):
    """Given.  Return r × f in the plane, a number:  r_x f_y − r_y f_x."""
    return r[0] * f[1] - r[1] * f[0]


def relative_velocity_2d(a, b, r_a, r_b):
    """Return u (2,) [m/s]: velocity of a's contact point relative to b's, with offsets r_a, r_b (2,).

    u = (v_a + ω_a × r_a) − (v_b + ω_b × r_b),       ω × r = ω (−r_y, r_x)  in the plane

    *Source:* first lecture deck, “Relative Velocity”.
    """
    ### BEGIN SOLUTION 7.3
    turn_a = a.omega * np.array([-r_a[1], r_a[0]])
    turn_b = b.omega * np.array([-r_b[1], r_b[0]])
    return a.v + turn_a - b.v - turn_b
    ### END SOLUTION


def impulse_size(u_n, k_n, e):
    """Return the impulse j ≥ 0 [N s] between two bodies that meet with u_n [m/s] and separate with −e u_n.

    *Find* it from k_n [1/kg], the change of u_n per unit of impulse j; without rotation k_n = 1/m_a + 1/m_b.  Where the
    bodies are already separating, u_n ≥ 0, the impulse is 0.

    Raises what check_restitution(e) and check_inverse_mass(k_n) raise; call them first.
    *Source:* first lecture deck, “Computing impulse”, 1st: objects cannot rotate; second lecture deck, “Coefficient of
    restitution”.  The slides leave out the condition u_n < 0.
    """
    ### BEGIN SOLUTION 7.4
    check_restitution(e)
    check_inverse_mass(k_n)
    return 0.0 if u_n >= 0.0 else -(1.0 + e) * u_n / k_n
    ### END SOLUTION


def effective_inverse_mass_2d(a, b, r_a, r_b, n):
    """Return k_n [1/kg] of two BodyState2D that can rotate: by how much an impulse of 1 N s changes u_n.

    *Find* it.  The impulse n on a at the offset r_a, and −n on b at r_b, change the velocities and the angular
    velocities of both.  u_n = n · u is the velocity of a's contact point relative to b's, along n.

    r × n in the plane is cross_2d(r, n).  An inv_mass or inv_inertia of 0 is that of a body that cannot move or turn.
    *Source:* first lecture deck, “Computing impulse”, in the plane.
    """
    ### BEGIN SOLUTION 7.5
    lever_a, lever_b = cross_2d(r_a, n), cross_2d(r_b, n)
    return a.inv_mass + b.inv_mass + lever_a**2 * a.inv_inertia + lever_b**2 * b.inv_inertia
    ### END SOLUTION


def apply_impulse_2d(body, r, J):
    """Return the BodyState2D after an impulse J (2,) [N s] at the offset r, with the same masses.

    v⁺ = v + J/m,   ω⁺ = ω + (r × J)/I

    *Source:* first lecture deck, the updates after “Computing impulse”.
    """
    ### BEGIN SOLUTION 7.6
    v = body.v + body.inv_mass * J
    omega = body.omega + body.inv_inertia * cross_2d(r, J)
    return BodyState2D(v, omega, body.inv_mass, body.inv_inertia)
    ### END SOLUTION


# ---------------------------------------------------------------------------------------------- in space

def relative_velocity(a, b, r_a, r_b):
    """Given.  Return u (3,) [m/s] of two BodyState3D:  (v_a + ω_a × r_a) − (v_b + ω_b × r_b).

    *Source:* first lecture deck, “Relative Velocity”.
    """
    return point_velocity(a.v, a.omega, r_a) - point_velocity(b.v, b.omega, r_b)


def effective_inverse_mass(a, b, r_a, r_b, n):
    """Return k_n [1/kg] of two BodyState3D: by how much an impulse of 1 N s along n changes u_n.

    *Find* it as in the plane, with  Δω = I⁻¹ (r × n)  and the velocity  v + ω × r  of the contact point.

    times(A, b) multiplies a matrix and a vector.
    *Source:* first lecture deck, “Computing impulse”.
    """
    ### BEGIN SOLUTION 7.7
    turn_a = cross(times(a.inv_inertia, cross(r_a, n)), r_a)
    turn_b = cross(times(b.inv_inertia, cross(r_b, n)), r_b)
    return a.inv_mass + b.inv_mass + n @ turn_a + n @ turn_b
    ### END SOLUTION


def apply_impulse(body, r, J):
    """Given.  Return the BodyState3D after an impulse J (3,) [N s] at r:  v⁺ = v + J/m,   ω⁺ = ω + I⁻¹ (r × J)."""
    v = body.v + body.inv_mass * J
    omega = body.omega + times(body.inv_inertia, cross(r, J))
    return BodyState3D(v, omega, body.inv_mass, body.inv_inertia)


def angular_momenta(L_a, L_b, r_a, r_b, J):
    """Return (L_a⁺, L_b⁺), each (3,) [kg m²/s], about the bodies' own centres, after J on a and −J on b.

    L_a⁺ = L_a + r_a × J,   L_b⁺ = L_b − r_b × J

    No inertia tensor is needed.  If the state contains L, as in lesson 5, this is the whole update of rotation.
    *Source:* first lecture deck, “LA += rA × J, LB −= rB × J”.
    """
    ### BEGIN SOLUTION 7.8
    return L_a + cross(r_a, J), L_b - cross(r_b, J)
    ### END SOLUTION


# ---------------------------------------------------------------------------------------------- friction, and energy

def contact_matrix(r, inv_mass, inv_inertia):
    """Return K [1/kg], (3, 3): an impulse J at the offset r changes the velocity of that point by K J.

    *Find* it from what an impulse does to a body:  v⁺ = v + J/m,   ω⁺ = ω + I⁻¹ (r × J),   and from the velocity
    v + ω × r of the point.

    inv_mass is 1/m [1/kg], and inv_inertia (3, 3) is I⁻¹ in the world [1/(kg m²)]; each may be zero.  Column k is the
    change of velocity by an impulse of 1 N s along axis k.  K is symmetric, and zero for an immovable body.  Between
    two bodies u changes by (K_a + K_b) J.
    *Source:* Mirtich and Canny 1995; Baraff 1997.
    """
    ### BEGIN SOLUTION 7.9
    # K = 1/m − r* I⁻¹ r*,   r* = skew(r) of lesson 5
    K = np.zeros((3, 3))
    for k in range(3):
        unit = np.zeros(3)
        unit[k] = 1.0
        K[k] = inv_mass * unit + cross(times(inv_inertia, cross(r, unit)), r)      # a column, but K is symmetric
    return K
    ### END SOLUTION


def cone_impulse(u, n, K, u_sep, mu):
    """Return J (3,) [N s] in the cone |J_t| ≤ μ J_n after which two contact points separate at u_sep ≥ 0 [m/s].

    There are three cases:

    n · u ≥ u_sep:    J = 0, because the points already separate fast enough.
    Otherwise n · u⁺ = u_sep, also where they separate too slowly, 0 < n · u < u_sep:
    stick:        J = K⁻¹ (u_sep n − u), after which u⁺ = u_sep n has no tangential part; if |J_t| ≤ μ J_n, this is J.
    slide:        J = j d,   j = (u_sep − n · u)/(n · K d)
                  d = n cos β + sin β J_t/|J_t|   is on the rim of the cone, tan β = μ, on the side of the stick's J,
                                                  with J_t = tangential(J, n) of that J

    Where the point slides, n · K d > 0: it is positive for the J of stick, and d leans less towards J_t than that J.
    solve3(K[0], K[1], K[2], r) of lesson 5 returns K⁻¹ r: K is symmetric, and its rows are its columns.
    Raises what check_contact(u, n, K, mu) raises; call it first.
    *Source:* Coulomb's law on velocities after the impact; second lecture deck, “Coulomb's law”.  The side of
    the rim is a modelling choice (see the notebook).
    *Left out:* slip that changes direction during the impact.
    """
    ### BEGIN SOLUTION 7.10
    check_contact(u, n, K, mu)
    if u @ n >= u_sep:
        return np.zeros(3)
    J = solve3(K[0], K[1], K[2], u_sep * n - u)
    J_t = tangential(J, n)
    size = np.sqrt(J_t @ J_t)
    if size <= mu * (J @ n):
        return J
    beta = np.arctan(mu)
    d = np.cos(beta) * n + np.sin(beta) / size * J_t
    return (u_sep - u @ n) / (n @ times(K, d)) * d
    ### END SOLUTION


def energy_change(u, K, J):
    """Return the kinetic energy [J] that both bodies together gain by an impulse J at a contact; negative: lost.

    *Find* it: u (3,) [m/s] is the relative velocity before the impulse, and K (3, 3) [1/kg] its response, u⁺ = u + K J.

    Without friction it is −½ (1 − e²) u_n²/k_n.  With a sticking J it is ½ (e² u_n² n · K⁻¹n − u · K⁻¹u), which can be
    positive: Newton's restitution concerns normal velocities only, but friction can convert tangential to
    normal motion.
    *Source:* ½ m v² and ½ ω · Iω before and after; Kane and Levinson 1985 for the gain.
    """
    ### BEGIN SOLUTION 7.11
    # ΔE = J · u + ½ J · K J = J · (u + u⁺)/2
    return J @ u + 0.5 * (J @ times(K, J))
    ### END SOLUTION


# ---------------------------------------------------------------------------------------------- when

def gap_multiplier(phi, u_n, k_n, dt):
    """Return λ ≥ 0 [N s] of a contact in a step of dt after which the gap is not below zero; the impulse is J = λ ∇φ.

    *Find* it.  After the step the gap is  φ⁺ = φ + dt (u_n + k_n λ).  Either it stays open, φ⁺ > 0, and then λ = 0; or
    λ closes it exactly, φ⁺ = 0:     0 ≤ φ⁺  ⊥  λ ≥ 0.

    φ ≥ 0 [m] the present gap, u_n [m/s] its rate before λ, k_n [1/kg].
    Raises what check_inverse_mass(k_n) raises, and check_positive("step dt [s]", dt).
    *Source:* second lecture deck, the gap function and its complementarity; Moreau 1988.
    """
    ### BEGIN SOLUTION 7.12
    check_inverse_mass(k_n)
    check_positive("step dt [s]", dt)
    return np.maximum(0.0, -(phi / dt + u_n) / k_n)
    ### END SOLUTION


def impact_time(phi, v_n, a_n, dt):
    """Return the time [s] until a gap φ [m] with rate v_n [m/s] and acceleration a_n [m/s²] closes, at most dt.

    φ + v_n τ + ½ a_n τ² = 0  with the gap closing at τ; a_n is constant.  A negative gap counts as φ = 0: it touches.
    s = √(v_n² − 2 a_n φ)
    v_n < 0:                  τ = 2φ/(s − v_n)           equals (−v_n − s)/a_n, without division by a small a_n
    v_n ≥ 0 and a_n < 0:      τ = −(v_n + s)/a_n         the gap opens first, and then closes
    v_n ≥ 0 and a_n ≥ 0, or no real s:   it never closes: dt
    A gap that only touches zero, s = 0, closes there.

    *Source:* first lecture deck, “time of impact”; second lecture deck, “go back to time of impact”; quadratic formula.
    """
    ### BEGIN SOLUTION 7.13
    phi = np.maximum(0.0, phi)
    squared = v_n * v_n - 2.0 * a_n * phi
    if squared < 0.0 or (v_n >= 0.0 and a_n >= 0.0):
        return dt
    s = np.sqrt(squared)
    tau = 2.0 * phi / (s - v_n) if v_n < 0.0 else -(v_n + s) / a_n
    return np.minimum(tau, dt)
    ### END SOLUTION


def bouncing_time(v_n, a_n, e):
    """Return the time [s] for which a ball keeps bouncing that leaves its plane with v_n [m/s], at constant a_n [m/s²].

    *Find* it: a_n < 0 brings the ball back with the speed with which it left, and each impact leaves a fraction e of
    it.  Sum up the times of all flights.  There are infinitely many impacts in a finite time (Zeno).

    Return 0 where v_n ≤ 0, and ∞ (np.inf) where a_n ≥ 0 or e = 1.  Where both conditions hold return 0, because a ball
    that does not leave does not bounce.
    *Source:* Newton's restitution; free flight at constant acceleration.
    """
    ### BEGIN SOLUTION 7.14
    # T = 2v_n/|a_n| · (1 + e + e² + …) = 2v_n/(|a_n| (1 − e))
    if v_n <= 0.0:
        return 0.0
    if a_n >= 0.0 or e == 1.0:
        return np.inf
    return -2.0 * v_n / (a_n * (1.0 - e))
    ### END SOLUTION


# ---------------------------------------------------------------------------------------- a ball above a plane, in time

def falling_acceleration(t, x, v, p):
    """Given.  Return a = g  [m/s²]."""
    return p.gravity


def gap(x, p):
    """Given.  Return the gap φ [m] between a ball and its plane:  (x − point) · n."""
    return (x - p.point) @ p.n


def position_projection_step(acceleration, t, x, v, dt, p):
    """Advance a BouncingBall by one step; if it ends below the plane, correct velocity and position; first order.

    v ← v + dt a(t, x, v),    x ← x + dt v                       as usual, velocity first
    φ = gap(x, p) < 0:        v ← kinematic_response(v, n, e),   x ← x − φ n

    Where φ ≥ 0, nothing is corrected.  The response acts on the v after the acceleration, not on the velocity before
    it.
    *Source:* second lecture deck, time stepping, “Option 2”.
    """
    ### BEGIN SOLUTION 7.15
    v = v + dt * acceleration(t, x, v, p)
    x = x + dt * v
    phi = gap(x, p)
    if phi < 0.0:
        v = kinematic_response(v, p.n, p.e)
        x = x - phi * p.n
    return x, v
    ### END SOLUTION


def free_flight(x, v, a, t):
    """Given.  Return (x, v) after t [s] under a constant acceleration a:  x + t v + ½ t² a,  v + t a."""
    return x + t * v + 0.5 * t * t * a, v + t * a


def slide_on_plane(x, v, a, t, n):
    """Given.  Return (x, v) after t [s] of a ball that slides on its plane without friction, or is lifted off."""
    return free_flight(x, tangential(v, n), a - np.minimum(0.0, a @ n) * n, t)


def backtracking_step(acceleration, t, x, v, dt, p):
    """Advance a BouncingBall by one step, impact by impact; exact while the acceleration is constant.

    a = acceleration(t, x, v, p), for the whole step.  While some time `left` of dt remains, at most MAX_IMPACTS times:
    τ = impact_time(φ, v · n, a · n, left),     φ = gap(x, p);     (x, v) = free_flight(x, v, a, τ);     left ← left − τ
    if nothing is left: done.                   Otherwise the ball is on the plane:
    v ← kinematic_response(v, n, e),            x ← x − gap(x, p) n                        which removes round-off
    if bouncing_time(v · n, a · n, e) ≤ left, all bounces end within this step: return slide_on_plane(x, v, a, left, n)

    A ball that starts inside and leaves, v · n > 0, flies from where it is, because impact_time counts its φ as 0.
    Raises Diverged after MAX_IMPACTS impacts.
    *Source:* second lecture deck, time stepping, “Option 1”.
    """
    ### BEGIN SOLUTION 7.16
    a, left = acceleration(t, x, v, p), dt
    for _ in range(MAX_IMPACTS):
        tau = impact_time(gap(x, p), v @ p.n, a @ p.n, left)
        x, v = free_flight(x, v, a, tau)
        left -= tau
        if left <= 0.0:
            return x, v
        v = kinematic_response(v, p.n, p.e)
        x = x - gap(x, p) * p.n
        if bouncing_time(v @ p.n, a @ p.n, p.e) <= left:
            return slide_on_plane(x, v, a, left, p.n)
    raise Diverged("impacts without end in a step of dt [s]", dt, "take a smaller step")
    ### END SOLUTION


# ---------------------------------------------------------------------------------------------- several impacts at once

def solve_impacts(body, r, n, e, mu):
    """Return (BodyState3D, residual [m/s]) after simultaneous impacts at several points with immovable bodies.

    r (points, 3) are the offsets and n (points, 3) the normals.  u_sep = rebound_speeds(body, r, n, e) is Newton's
    max(0, −e nᵢ · uᵢ) of the velocities before the impact, and  Jᵢ = 0.  Then sweep over all points:
        velocity without the point's own impulse:   u = v + ω × rᵢ − Kᵢ Jᵢ,    Kᵢ = contact_matrix(rᵢ, 1/m, I⁻¹)
        new impulse of the point:                   J = cone_impulse(u, nᵢ, Kᵢ, u_sepᵢ, μ)
        push the body by J − Jᵢ at rᵢ;    Jᵢ ← J
    The residual of a sweep is the largest component of all changes of velocity Kᵢ (J − Jᵢ) of a point by its
    own impulse.  The sweeps end when the residual is at most CONVERGED times largest_speed(body, r).  If MAX_SWEEPS
    sweeps are not enough, return settle_impacts(contact_matrix, cone_impulse, apply_impulse, body, r, n, e, μ) of the
    body before the impact, given in solutions/given/impact_modes.py: it relaxes the sweeps, tries all choices of open,
    sticking and sliding points, and last of all takes the impact that dissipates most, which is no answer of the law.
    The law may have no answer, also for μ = 1, and then the residual shows that.  Of 48,000 random impacts at one to
    four points with μ up to 1, 16 were left without one, and an independent search found none to them either.  Of 140
    with μ = 2 or 5, nine were left; for μ above 1 it is not known how often an answer is missed.
    Answers need not be unique.

    Without friction the order of the points does not matter at convergence, and a box that lands flat leaves the floor
    flat.  With friction it may decide how several points share the load, and so turn a sliding box a little.
    Raises what check_impacts(body, r, n, e, mu) raises; call it first.
    *Source:* Gauss–Seidel sweeps, as in Guendelman et al. 2003; second lecture deck, “Multi-contact problems”.
    *Left out:* how an impact travels from point to point; contacts between many bodies.
    """
    ### BEGIN SOLUTION 7.17
    check_impacts(body, r, n, e, mu)
    u_sep = rebound_speeds(body, r, n, e)
    Js = np.zeros((len(r), 3))
    after, speed = body, largest_speed(body, r)
    for _ in range(MAX_SWEEPS):
        residual = 0.0
        for i in range(len(r)):
            K = contact_matrix(r[i], body.inv_mass, body.inv_inertia)
            u = point_velocity(after.v, after.omega, r[i]) - times(K, Js[i])
            J = cone_impulse(u, n[i], K, u_sep[i], mu)
            residual = max(residual, np.abs(times(K, J - Js[i])).max())
            after = apply_impulse(after, r[i], J - Js[i])
            Js[i] = J
        if residual <= CONVERGED * speed:
            return after, residual
    return settle_impacts(contact_matrix, cone_impulse, apply_impulse, body, r, n, e, mu)
    ### END SOLUTION


# ---------------------------------------------------------------------------------------------- why?

def elastic_rest_time(h, g, dt):
    """Return the time [s] after which position_projection_step lets a perfectly elastic ball lie still.

    The ball, e = 1, leaves the floor at the speed √(2 g h), h > 0 [m], under g > 0 [m/s²]: its energy should stay for
    ever.  That speed is no multiple of g dt/2, where the flights would end at the same phase again and again.
    *Find* the time before you run anything, for a step dt > 0 [s] that is short compared with the fall.  By how much
    does the height of a flight fall from one impact to the next, on average over the phases of a step?  And how long
    is a flight?
    """
    ### BEGIN SOLUTION 7.18
    # Between impacts ½ v² + g x − ½ g dt v is constant.  An impact at the speed w makes v = w of −w, which takes g dt w
    # away, and lifts the ball by w dt/2 on average.  So w²/2 falls by g dt w/2: w by g dt/2 per flight of 2 w/g.
    return 4.0 * h / (g * dt)
    ### END SOLUTION


def smooth_rod_is():
    """Return the letter of the impact without friction: "A", "B", "C" or "D".

    The figure of the notebook has the energy that four impacts of a leaning rod leave, against the restitution e.  In
    three of them the tip sticks, with different slips before the impact.
    """
    ### BEGIN SOLUTION 7.19
    return "D"
    ### END SOLUTION


def my_impulse(u, n, K):
    """Return the impulse J (3,) [N s] on a ball that stores its slip and returns it.

    *Make it*.  u (3,) [m/s] is the velocity of the ball's contact point, with n · u < 0, n (3,) is the unit normal, and
    K (3, 3) [1/kg] the response of the ball to an impulse at this point.  Many laws are right.  The judge demands:

    - The point separates: n · u⁺ is at least a tenth of the speed of approach, where u⁺ = u + K J.
    - The slip turns round: along its old direction it is then at most −3/10 of what it was.
    - No impact gains energy.
    - A ball that is thrown under a table comes back: after three impacts it moves against its first velocity.
    """
    ### BEGIN SOLUTION 7.20
    # u⁺ = −u: the work J · (u + u⁺)/2 is zero.  K is symmetric, so its rows are its columns.
    return solve3(K[0], K[1], K[2], -2.0 * u)
    ### END SOLUTION
