"""Lesson 3.  Friction: a force that stops motion and then holds.

Symbols: x (d,) [m], v (d,) [m/s] of a block or a particle in d dimensions · n (d,) unit normal of the supporting
surface, towards the body · F [N], F_N [N] normal force · μ [-] friction, μ_s static, μ_k kinetic · J, j [N s] impulse ·
e [-] restitution · φ [m] gap.

A support pushes and never pulls: F_N ≥ 0.  Friction opposes motion along the surface with at most μ F_N, so the forces
of a support fill a cone.  The index t denotes the part along the surface, y_t = y − (y · n) n.
Every law for forces here also holds for accelerations: use a in place of F, and m = 1.
Given in solutions/given/friction.py: make_block, average_sliding_step, pyramid_step, event_step, and the loops
slip_times and advance_particle.
*Left out:* rotation (a block that tips, a ball that rolls): lesson 5.  Friction that depends on speed, time or area.
"""

from typing import NamedTuple

import numpy as np

from solutions.checks import check_friction

__all__ = [
    "Block", "ParticleInBowl", "ParticleOnPlane", "advance_to_event", "breakaway_time", "cone_radius",
    "contact_step", "driven_acceleration", "dry_friction_is", "falling_acceleration", "friction_impulse",
    "friction_position_correction", "incline_acceleration", "kinetic_friction", "kinetic_friction_step",
    "my_friction", "normal_force", "particle_bowl_gap", "particle_contact_impulse", "particle_plane_gap",
    "position_friction_step", "pyramid_impulse", "sliding_distance", "sliding_step", "slip_direction",
    "static_friction", "stopping_time", "tangential",
]

HALVINGS = 60                # of an interval of time: 2⁻⁶⁰ of a step is below the spacing of floats


class Block(NamedTuple):
    """A block that stays on a plane, with the forces on it."""
    n: np.ndarray            # (d,) unit normal of the plane
    mu_s: float              # static friction [-]
    mu_k: float              # kinetic friction [-], not above mu_s
    gravity: np.ndarray      # (d,) [m/s²]
    drive: np.ndarray         # (d,) amplitude of a periodic force over mass [m/s²]
    omega: float             # its angular frequency [rad/s]


class ParticleOnPlane(NamedTuple):
    """A particle above a plane."""
    m: float                 # mass [kg]
    mu: float                # friction [-]
    e: float                 # restitution [-]
    gravity: np.ndarray      # (d,) [m/s²]
    point: np.ndarray        # (d,) a point of the plane [m]
    n: np.ndarray            # (d,) its unit normal


class ParticleInBowl(NamedTuple):
    """A particle in a round hollow: a bowl or a trough."""
    m: float                 # mass [kg]
    mu: float                # friction [-]
    e: float                 # restitution [-]
    gravity: np.ndarray      # (d,) [m/s²]
    centre: np.ndarray       # (d,) centre of the bowl, or a point of the trough's axis [m]
    axis: np.ndarray         # (d,) zeros: a bowl (sphere or circle); a unit vector: a trough (cylinder) along it
    radius: float            # [m]


# ---------------------------------------------------------------------------------------------- at rest and sliding

def tangential(y, n):
    """Given.  Return the part of y (d,) along a surface of unit normal n:  y − (y · n) n."""
    return y - (y @ n) * n


def cone_radius(mu, F_N):
    """Given.  Return μ F_N, the limit of friction; it is 0 without load, even for μ = ∞.  Raises BadInput if μ < 0."""
    check_friction(mu)
    return 0.0 if F_N <= 0.0 else mu * F_N               # in this order, so that a load of NaN does not count as none


def normal_force(F, n):
    """Return F_N [N], the size of the normal force of a support on a body on which all other forces are F (d,).

    *Find* it.  The normal force points along the unit normal n, away from the support.  It is as large as it must be so
    that the body does not move into the support, and it never pulls.

    *Source:* first lecture deck, “Resting contact”, “Normal force”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.1: normal_force")


def static_friction(F, n, mu_s):
    """Return the static friction (d,) [N] on a body at rest under the other forces F (d,).

    F_s = −F_t                           while |F_t| ≤ μ_s F_N,    F_N = normal_force(F, n),   F_t = tangential(F, n)
    F_s = −μ_s F_N F_t/|F_t|             beyond: then the body begins to slide

    Take μ_s F_N from cone_radius, which raises BadInput for a negative μ_s and handles μ_s = ∞.
    *Source:* first lecture deck, “Static friction”, F_s = μ_s F_N, which is the limit and not the size: F_s ≤ μ_s F_N.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.2: static_friction")


def kinetic_friction(F, v, n, mu_k):
    """Return the kinetic friction (d,) [N] on a body that slides with velocity v (d,) under the other forces F (d,).

    F_k = −μ_k F_N v_t/|v_t|             at any speed;   0 where v_t = 0, a case for static friction

    Take μ_k F_N from cone_radius.
    *Source:* first lecture deck, “Kinetic friction”, F_k = μ_k F_N.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.3: kinetic_friction")


def incline_acceleration(theta, mu_s, mu_k, g):
    """Return the acceleration [m/s²] down a slope of angle θ [rad], 0 ≤ θ < π/2, of a block released on it at rest.

    *Find* it: static friction holds the block up to and including its limit; beyond the limit the block slides under
    kinetic friction.

    Take both limits from cone_radius, with the normal force over the weight [-] as the load: cone_radius raises
    BadInput for a negative μ and handles μ = ∞.
    *Source:* first lecture deck, “Friction (2)”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.4: incline_acceleration")


# ---------------------------------------------------------------------------------------------- Coulomb's cone

def friction_impulse(v_t, m, j_n, mu):
    """Return the impulse (d,) [N s] in the cone that leaves a body of mass m the least kinetic energy along a surface.

    *Find* it.  Of all impulses J_t along the surface with |J_t| ≤ μ j_n, take the one after which ½ m |v_t + J_t/m|² is
    least.  Such an impulse stops the body, if the cone allows it.

    If it does, compute the impulse without a detour.  Then v_t + J_t/m is 0, or the rounding of one product: a larger
    velocity would count as motion.  Where v_t = 0 the impulse is 0.
    This principle of maximum dissipation has both cases of Coulomb's law in it.
    j_n ≥ 0 [N s] is the normal impulse; take μ j_n from cone_radius.
    *Source:* second lecture deck, “Maximum dissipation principle”, where v̂_t = v_t/|v_t| is meant by v_t; Moreau 1973
    for the principle.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.5: friction_impulse")


def pyramid_impulse(v_t, m, j_n, mu, t_1, t_2):
    """Return the friction impulse (d,) for a pyramid instead of the cone; its sides face the unit vectors t_1 and t_2.

    *Find* J_t (d,) [N s]: of all impulses along the surface with |J_t · t_1| ≤ μ j_n and |J_t · t_2| ≤ μ j_n, the one
    that leaves the least kinetic energy.

    t_1 and t_2 lie along the surface, perpendicular to each other.  Take μ j_n from cone_radius.  Solvers use the
    pyramid because the two directions are independent.  Its friction is up to √2 times too strong, and not exactly
    against the motion.
    *Source:* the box friction of most game engines; Stewart and Trinkle 1996 for pyramids with many sides.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.6: pyramid_impulse")


# ---------------------------------------------------------------------------------------------- a block in time

def driven_acceleration(t, x, v, p):
    """Given.  Return the acceleration of a Block p without friction and support:  a = g + drive cos ωt  [m/s²]."""
    return p.gravity + np.cos(p.omega * t) * p.drive


def sliding_step(acceleration, t, x, v, dt, p):
    """Advance a block on its plane by one step, with friction as an impulse; first order, and it stops completely.

    a = acceleration(t, x, v, p):  everything but support and friction
    a_n = normal_force(a, n),   a_t = tangential(a, n)
    at rest (v = 0) and |a_t| ≤ μ_s a_n:  nothing moves.    Otherwise
    v* = v + dt a_t,    vₙ₊₁ = v* + friction_impulse(v*, 1, dt a_n, μ_k),    xₙ₊₁ = xₙ + dt vₙ₊₁

    The impulse removes at most the present velocity; a friction force over dt could reverse it.  v lies in the plane.
    p has the fields n, mu_s and mu_k of a Block.
    *Source:* second lecture deck, the order of its steps; Moreau 1988 for friction as one impulse per step.
    *Left out:* a block that is lifted off; a block that reverses within a step.  Such a block is at rest for a moment,
    and on a slope with μ_k < tan θ < μ_s static friction would hold it there.  This step misses that; event_step
    does not.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.7: sliding_step")


# ---------------------------------------------------------------------------------------------- stick, slip, and when

def slip_direction(acceleration, t, x, v, p):
    """Return the direction in which a block slides from here: a unit vector (d,), or zeros if it stays at rest.

    moving:  v/|v|          at rest:  a_t/|a_t| if |a_t| > μ_s a_n, else 0          (a, a_n and a_t as in sliding_step)

    *Source:* second lecture deck, the two cases of Coulomb's law.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.8: slip_direction")


def kinetic_friction_step(acceleration, t, x, v, dt, d, p):
    """Given.  Return (x, v) after a midpoint step of a block under kinetic friction along −d, even if v reverses.

    Second order on a straight path, and exact while the forces are constant.
    """
    early = acceleration(t, x, v, p)
    v_mid = v + 0.5 * dt * (tangential(early, p.n) - cone_radius(p.mu_k, normal_force(early, p.n)) * d)
    middle = acceleration(t + 0.5 * dt, x + 0.5 * dt * v, v_mid, p)
    return x + dt * v_mid, v + dt * (tangential(middle, p.n) - cone_radius(p.mu_k, normal_force(middle, p.n)) * d)


def stopping_time(acceleration, t, x, v, dt, d, p):
    """Return the time [s] until a block that slides along d stops: the τ in (0, dt] at which its speed along d is 0.

    A slide over τ is  kinetic_friction_step(acceleration, t, x, v, τ, d, p).  If the slide over dt ends with
    v · d > 0,  the block goes on: return dt.  Otherwise halve the interval (0, dt] HALVINGS times.  Keep the half in
    which the sign changes: after a slide over the τ at its beginning the block still moves (v · d > 0), after a slide
    over the τ at its end it does not.  Return the end of the last interval.
    *Source:* bisection; second lecture deck, “go back to time of impact”, for the idea.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.9: stopping_time")


def breakaway_time(acceleration, t, x, v, dt, p):
    """Return the time [s] until a block at rest begins to slide: the τ in (0, dt] after which |a_t| > μ_s a_n.

    The block stays at x with v = 0 during this time.  If it still holds at t + dt (slip_direction is zeros): return dt.
    Otherwise halve (0, dt] HALVINGS times, so that the block holds at the beginning and slips at the end.  Return the
    end of the last interval.
    *Left out:* a force that exceeds the limit between t and t + dt and is within it again at t + dt.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.10: breakaway_time")


def advance_to_event(acceleration, t, x, v, dt, p):
    """Return (τ, x, v): advance until the block stops or breaks away, at most for dt [s]; second order.

    Let d = slip_direction(acceleration, t, x, v, p).  Then
    where d is zeros:   τ = breakaway_time,   x and v unchanged
    elsewhere:          τ = stopping_time,    (x, v) = kinetic_friction_step(acceleration, t, x, v, τ, d, p);
                        if τ < dt the block has stopped: v = 0 exactly

    *Source:* event-driven simulation; second lecture deck, “Option 1”.
    *Left out:* curved paths, where the force is not along the motion: use sliding_step for those.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.11: advance_to_event")


# --------------------------------------------------------------------------------------------- a particle and a surface

def falling_acceleration(t, x, v, p):
    """Given.  Return a = g  [m/s²]."""
    return p.gravity


def particle_plane_gap(x, p):
    """Given.  Return (φ, n) of a plane:  φ = (x − point) · n,  positive on the free side, and its unit normal."""
    return (x - p.point) @ p.n, p.n


def particle_bowl_gap(x, p):
    """Return (φ, n) of a round hollow: distance [m] of x (d,) from its wall, positive inside, and unit normal.

    *Find* both.  The wall is a sphere around the centre, if axis = 0, and otherwise a cylinder around the line through
    the centre along the unit vector `axis`.  φ is the distance from the nearest point of the wall, and n = ∇φ points
    away from it, inwards.  At the exact centre, where no point of the wall is the nearest one, n = 0.

    *Source:* second lecture deck, the implicit function φ(x) of an obstacle.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.12: particle_bowl_gap")


def particle_contact_impulse(v, n, m, e, mu):
    """Return the impulse J (d,) [N s] of a fixed surface on a particle of mass m that touches it with v (d,) [m/s].

    *Find* it.  J = j_n n + J_t changes the velocity to v⁺ = v + J/m.  The normal part is such that the particle leaves
    with e times the speed with which it came:  n · v⁺ = −e n · v.  The tangential part is the friction_impulse that
    belongs to this j_n.  A particle with n · v ≥ 0 is already leaving, and gets no impulse.

    *Source:* second lecture deck, “A simple strategy for particle/implicit collisions”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.13: particle_contact_impulse")


def contact_step(acceleration, surface, t, x, v, dt, p):
    """Advance a particle by one step, and move it back to the surface if it ends inside the obstacle; first order.

    v ← v + dt a(t, x, v),    x ← x + dt v                      as usual, velocity first
    (φ, n) = surface(x, p);   if φ < 0:
        v ← v + particle_contact_impulse(v, n, m, e, μ)/m            the impulse is 0 where v already points outwards
        x ← x − φ n

    A particle that should rest on a slope moves dt² g sin θ down the slope in every step, and the correction acts only
    across the slope.  So the particle creeps at dt g sin θ: the artificial sliding of this method.  p has the fields m,
    e and mu.
    *Source:* second lecture deck, “A simple strategy for particle/implicit collisions”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.14: contact_step")


def friction_position_correction(moved, n, depth, mu):
    """Return the correction (d,) [m] along the surface after a step that moved a particle by `moved` (d,).

    *Find* it.  This is friction for positions: the correction along the normal is the depth, in the place of an impulse
    j_n.  What the step moved along the surface is in the place of v_t.  Friction takes back as much of it as it may.
    depth ≥ 0 [m]: depth of the particle inside the obstacle after the step.

    On a slope depth = dt² g cos θ, so a particle at rest returns to its old position if tan θ ≤ μ.
    *Source:* second lecture deck, “tangential position correction to counteract artificial sliding”;
    Macklin et al. 2014, eq. 24.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.15: friction_position_correction")


def position_friction_step(acceleration, surface, t, x, v, dt, p):
    """Advance a particle as contact_step does, with a tangential correction of its position; first order, no creep.

    As contact_step.  Where φ < 0 and the velocity was inwards (v · n < 0, before the impulse), also add to x
        friction_position_correction(displacement in this step before x was moved back, n, −φ, μ)

    *Source:* second lecture deck, the last line of “A simple strategy for particle/implicit collisions”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.16: position_friction_step")


# ---------------------------------------------------------------------------------------------- why?

def sliding_distance(v, width, mu_near, mu_far, g):
    """Return how far [m] a block slides on level ground, which begins with a strip of another material.

    *Find* it before you run anything.  The block enters the strip with the speed v ≥ 0 [m/s].  The strip is `width` [m]
    wide and has the kinetic friction mu_near > 0; the ground behind it has mu_far > 0.  Friction is all that takes
    energy from the block.

    The distance is counted from the edge at which the block enters.  A slow block stops on the strip.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.17: sliding_distance")


def dry_friction_is():
    """Return the letter of Coulomb's friction in the figure of the notebook: "A", "B", "C" or "D".

    A block rests on a table.  A hand pulls it sideways with a force that grows slowly from zero.  The curves show four
    ideas of the force of friction on the block, over the force of the hand.  The normal force is 10 N, the static
    friction 0.6 and the kinetic friction 0.4.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.18: dry_friction_is")


def my_friction(v_t, m, j_n, mu):
    """Return the impulse (2,) [N s] of a floor of your own, on a block of mass m that slides with velocity v_t (2,).

    *Make it*: j_n ≥ 0 is the normal impulse of this step, and μ the friction.  Many laws are right.  The judge demands:

    - It never adds energy: at any velocity, the block is not faster after the impulse.
    - Without a load, j_n = 0, it gives no impulse.
    - A block that is thrown at 3 m/s in any direction over a floor with μ ≥ 0.3 is at rest after 4 s, and stays.
    - It is neither friction_impulse nor pyramid_impulse along x and y, and not one of them times a number.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.19: my_friction")
