"""Lesson 7.  Impulses: collisions that take no time.

Symbols: a, b two bodies · v [m/s], omega [rad/s], r [m] offset of the contact point from a centre of mass · n unit normal, from b to a ·
u [m/s] velocity of a's contact point as seen from b's, u_n = n · u its part along n · J, j [N s] impulse on a; b gets −J · e [-] restitution ·
μ [-] friction · K [1/kg] what an impulse does to u: u⁺ = u + K J, and k = n · K n · φ [m] gap, n = ∇φ · λ [N s] multiplier of the gap.

Velocities after an impact have a ⁺.  An impact is so short that nothing moves and no other force counts.  A body that cannot be moved has
inv_mass = 0 and inv_inertia = 0.  In the plane r × n is the number r_x n_y − r_y n_x, and omega is a number, counter-clockwise.
*Left out:* finding out who touches whom (lesson 6).  Contacts that last, as in a stack: lesson 9.
"""

from typing import NamedTuple

import numpy as np

from solutions.checks import (BadInput, Diverged, check_array, check_end, check_field, check_finite, check_friction, check_normal, check_not_negative,
                     check_positive, check_restitution, check_shape, checked_run, finite_array, finite_number, number, positive_number)
from solutions.friction import tangential
from solutions.integrators import symplectic_euler_step
from solutions.rotation import cross, point_velocity, solve3
from solutions.vectors import norm

IMPACTS = 10_000             # in one step [-]; a ball of e = 0.8 has 165 before the next is closer than the spacing of floats
SWEEPS = 2000                # over several contact points [-]; four under a box need about a hundred, points close together more than a thousand
STIFFEST = 1e-40             # determinant of K over its trace cubed, below which K has no inverse [-]: products of it vanish
SETTLED = 1e-14              # largest change in a sweep over the largest |v| + |ω||r| at the beginning [-]: a hundred roundings


class Flat(NamedTuple):
    """A body in the plane."""
    v: np.ndarray            # (2,) [m/s]
    omega: float             # [rad/s]
    inv_mass: float          # [1/kg]
    inv_inertia: float       # [1/(kg m²)]


class Solid(NamedTuple):
    """A body in space."""
    v: np.ndarray            # (3,) [m/s]
    omega: np.ndarray        # (3,) [rad/s]
    inv_mass: float          # [1/kg]
    inv_inertia: np.ndarray  # (3, 3) in the world [1/(kg m²)]


class Drop(NamedTuple):
    """A ball that does not turn, over a plane."""
    e: float                 # restitution [-]
    gravity: np.ndarray      # (d,) [m/s²]
    point: np.ndarray        # (d,) where its centre is when it lies on the plane [m]
    n: np.ndarray            # (d,) unit normal of the plane
    stiffness: float         # of the penalty's spring over the mass, ω² [1/s²]
    damping: float           # of its damper over the mass [1/s]


class Spinner(NamedTuple):
    """A ball that turns, over a plane."""
    e: float                 # restitution [-]
    mu: float                # friction [-]
    inv_mass: float          # [1/kg]
    inv_inertia: np.ndarray  # (3, 3), the same about any axis [1/(kg m²)]
    radius: float            # [m]
    gravity: np.ndarray      # (3,) [m/s²]
    point: np.ndarray        # (3,) where its centre is when it lies on the plane [m]
    n: np.ndarray            # (3,) unit normal of the plane


class Discs(NamedTuple):
    """Discs or balls without friction, and without a force between their impacts."""
    radius: np.ndarray       # (bodies,) [m]
    inv_mass: np.ndarray     # (bodies,) [1/kg]
    e: float                 # restitution [-]


# ---------------------------------------------------------------------------------------------- what may be asked

def check_inverse_mass(k):
    """Given.  Raise BadInput unless k [1/kg] is above zero: of two bodies that cannot be moved neither can give way."""
    if not (k > 0.0 and np.isfinite(k)):
        raise BadInput("inverse mass of two bodies at their contact [1/kg]", k, "let one of them have a finite mass")


def check_contact(u, n, K, mu):
    """Given.  Raise BadInput unless n is a unit vector, μ ≥ 0, u finite, and K gives way along n, and in every other direction."""
    check_normal(n)
    check_friction(mu)
    check_finite("relative velocity u [m/s]", u)
    check_inverse_mass(n @ times(K, n))
    determinant = K[0] @ cross(K[1], K[2])
    if not determinant > STIFFEST * (K[0, 0] + K[1, 1] + K[2, 2]) ** 3:
        raise BadInput("determinant of K [1/kg³]", determinant, "give a K that gives way in every direction")


def times(A, b):
    """Given.  A b of a matrix (3, 3) and a vector (3,); written out, because compiling that costs a tenth of A @ b."""
    return np.array([A[0, 0] * b[0] + A[0, 1] * b[1] + A[0, 2] * b[2],
                     A[1, 0] * b[0] + A[1, 1] * b[1] + A[1, 2] * b[2],
                     A[2, 0] * b[0] + A[2, 1] * b[1] + A[2, 2] * b[2]])


# ---------------------------------------------------------------------------------------------- without any physics, and with a spring

def kinematic_response(v, n, k):
    """Velocity (d,) of a point after it has hit a fixed surface:  v⁺ = v − (1 + k)(v · n) n,  and v⁺ = v where it leaves, v · n ≥ 0.

    It turns the normal velocity round and keeps the share k of it; k = 0.8 looks like a ball.  Along the surface nothing changes.
    *Source:* deck A, "Kinematic response".
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 7.1: kinematic_response")


def penalty_force(phi, v_n, stiffness, damping):
    """Force [N] along n of a spring and a damper that push a body out of where it should not be; they never pull.

    f = max(0, −stiffness φ − damping v_n)  while φ < 0;     0 outside

    φ [m] gap, v_n [m/s] its rate, stiffness [N/m], damping [N s/m].  For forces over mass hand in k/m and c/m.
    *Source:* deck A, "Penalty method".
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 7.2: penalty_force")


# ---------------------------------------------------------------------------------------------- in the plane

def flat_cross(r, f):
    """Given.  r × f in the plane, a number:  r_x f_y − r_y f_x."""
    return r[0] * f[1] - r[1] * f[0]


def flat_relative_velocity(a, b, r_a, r_b):
    """u (2,) [m/s]: how fast the contact point of a Flat body a moves as seen from that of b, each at its offset r (2,).

    u = (v_a + ω_a × r_a) − (v_b + ω_b × r_b),       ω × r = ω (−r_y, r_x)  in the plane

    *Source:* deck A, "Relative Velocity".
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 7.3: flat_relative_velocity")


def impulse_size(u_n, k, e):
    """j ≥ 0 [N s]: how hard two bodies push each other apart that meet with u_n [m/s] and rebound with −e u_n.

    j = −(1 + e) u_n/k,      and 0 where they separate by themselves, u_n ≥ 0

    k [1/kg]: the velocity by which j = 1 drives their contact points apart; without rotation k = 1/m_a + 1/m_b.
    Raises what check_restitution and check_inverse_mass raise; call them first.
    *Source:* deck A, "Computing impulse", 1st: objects cannot rotate; deck B, "Coefficient of restitution".
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 7.4: impulse_size")


def flat_inverse_mass(a, b, r_a, r_b, n):
    """k [1/kg] of two Flat bodies that can turn:  k = 1/m_a + 1/m_b + (r_a × n)²/I_a + (r_b × n)²/I_b,   r × n: flat_cross.

    *Source:* deck A, "Computing impulse", in the plane.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 7.5: flat_inverse_mass")


def flat_push(body, r, J):
    """The Flat body after an impulse J (2,) [N s] at the offset r:  v⁺ = v + J/m,   ω⁺ = ω + (r × J)/I;   masses as they are.

    *Source:* deck A, the updates after "Computing impulse".
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 7.6: flat_push")


# ---------------------------------------------------------------------------------------------- in space

def relative_velocity(a, b, r_a, r_b):
    """Given.  u (3,) [m/s] of two Solid bodies:  (v_a + ω_a × r_a) − (v_b + ω_b × r_b).

    *Source:* deck A, "Relative Velocity".
    """
    return point_velocity(a.v, a.omega, r_a) - point_velocity(b.v, b.omega, r_b)


def inverse_mass(a, b, r_a, r_b, n):
    """k [1/kg] of two Solid bodies:  k = 1/m_a + 1/m_b + n · [(I_a⁻¹ (r_a × n)) × r_a] + n · [(I_b⁻¹ (r_b × n)) × r_b].

    *Source:* deck A, "Computing impulse".
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 7.7: inverse_mass")


def push(body, r, J):
    """Given.  The Solid body after an impulse J (3,) [N s] at the offset r:  v⁺ = v + J/m,   ω⁺ = ω + I⁻¹ (r × J)."""
    return Solid(body.v + body.inv_mass * J, body.omega + times(body.inv_inertia, cross(r, J)), body.inv_mass, body.inv_inertia)


def angular_momenta(L_a, L_b, r_a, r_b, J):
    """(L_a⁺, L_b⁺), each (3,) [kg m²/s], about their own centres, after J on a and −J on b:  L_a + r_a × J,   L_b − r_b × J.

    The same impact without any inertia tensor: where L is the state, as in lesson 5, this is the update.
    *Source:* deck A, "LA += rA × J, LB −= rB × J".
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 7.8: angular_momenta")


# ---------------------------------------------------------------------------------------------- friction, and energy

def point_inverse_mass(r, inv_mass, inv_inertia):
    """K [1/kg], (3, 3): an impulse J at the offset r changes the velocity of that very point by K J.

    K = 1/m − r* I⁻¹ r*          r* = skew(r) of lesson 5

    Its column k is what an impulse of 1 N s along axis k does to the velocity.  K is symmetric, and all zeros for a body that cannot be
    moved.  Between two bodies u changes by (K_a + K_b) J.

    *Source:* Mirtich and Canny 1995; Baraff 1997.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 7.9: point_inverse_mass")


def cone_impulse(u, n, K, w, mu):
    """J (3,) [N s] that makes two contact points with u (3,) separate at w ≥ 0 [m/s], n · u⁺ = w, within the cone |J_t| ≤ μ J_n.

    n · u ≥ w:    J = 0, they separate by themselves, and fast enough.       Otherwise, also where they separate too slowly, 0 < n · u < w:
    stick:        J = K⁻¹ (w n − u)                         which leaves u⁺ = w n, nothing along the surface; if |J_t| ≤ μ J_n, this is J.
    slide:        J = j d,   d = n cos β + sin β J_t/|J_t|  on the rim of the cone, tan β = μ, to the side to which sticking would push:
                  j = (w − n · u)/(n · K d)                 J_t = tangential(J, n) is that of the stick's J

    n · K d > 0 for every μ, infinity included: for the stick's J it is, and d leans less towards J_t than that does.
    solve3 of lesson 5 solves for J, given the columns of K.  Raises what check_contact raises; call it first.
    *Source:* Coulomb's law on velocities after the impact; deck B, "Coulomb's law".  The side of the rim is a choice (see the notebook).
    *Left out:* slip that turns while the impact lasts.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 7.10: cone_impulse")


def contact_impulse(u, n, K, e, mu):
    """Given.  J (3,) [N s] of an impact with friction: cone_impulse with Newton's  n · u⁺ = −e n · u;  0 where they separate."""
    check_restitution(e)
    return np.zeros(3) if u @ n >= 0.0 else cone_impulse(u, n, K, -e * (u @ n), mu)


def energy_change(u, K, J):
    """Kinetic energy [J] that an impulse J at a contact gives both bodies together:  ΔE = J · u + ½ J · K J  =  J · (u + u⁺)/2.

    Negative: lost.  Without friction it is −½ (1 − e²) u_n²/k.  A J that sticks gives ½ (e² u_n² n · K⁻¹n − u · K⁻¹u), and that may be
    above zero: Newton's restitution looks at normal velocities only, but friction can turn tangential into normal motion.
    *Source:* ½ m v² and ½ ω · Iω before and after; Kane and Levinson 1985 for the gain.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 7.11: energy_change")


# ---------------------------------------------------------------------------------------------- when

def gap_multiplier(phi, u_n, k, dt):
    """λ ≥ 0 [N s] with which a contact answers in a step of dt, so that the gap is not below zero at its end; the impulse is J = λ ∇φ.

    φ⁺ = φ + dt (u_n + k λ),       0 ≤ φ⁺  ⊥  λ ≥ 0:    either the gap stays open and λ = 0, or it closes and λ is just what that takes

    φ ≥ 0 [m] gap now, u_n [m/s] its rate before λ, k [1/kg].  Raises what check_inverse_mass raises, and check_positive("step dt [s]", dt).
    *Source:* deck B, the gap function and its complementarity; Moreau 1988.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 7.12: gap_multiplier")


def impact_time(phi, v_n, a_n, dt):
    """After how long [s] a gap φ [m] closes that has the rate v_n [m/s] and the constant acceleration a_n [m/s²]; dt if not in this step.

    φ + v_n τ + ½ a_n τ² = 0  with the gap closing there; what is inside already, φ < 0, counts as φ = 0: it touches.
    s = √(v_n² − 2 a_n φ)
    v_n < 0:                  τ = 2φ/(s − v_n)                        the same as (−v_n − s)/a_n, but it does not divide by a small a_n
    v_n ≥ 0 and a_n < 0:      τ = −(v_n + s)/a_n                      it comes back
    v_n ≥ 0 and a_n ≥ 0, or no real s:   it never closes

    *Source:* deck A, "time of impact"; deck B, "go back to time of impact"; the quadratic formula.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 7.13: impact_time")


def bouncing_time(v_n, a_n, e):
    """For how long [s] a ball goes on bouncing that has just left its plane with v_n [m/s], under a constant a_n [m/s²]: Zeno's sum.

    T = 2v_n/|a_n| · (1 + e + e² + …) = 2v_n/(|a_n| (1 − e));      0 where v_n ≤ 0;      ∞ where a_n ≥ 0 or e = 1

    Where both are the case it is 0: what does not leave does not bounce.
    Infinitely many impacts, and over in a finite time.
    *Source:* flights of 2v/|a|, each e times as long as the one before; the geometric series.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 7.14: bouncing_time")


# ---------------------------------------------------------------------------------------------- a ball over a plane, in time

def falling_acceleration(t, x, v, p):
    """Given.  a = g  [m/s²]."""
    return p.gravity


def gap(x, p):
    """Given.  φ [m] of a ball over its plane:  (x − point) · n."""
    return (x - p.point) @ p.n


def penalty_step(acceleration, t, x, v, dt, p):
    """Given.  Advance a Drop by symplectic Euler with the penalty's spring and damper for the plane; first order, stable for ω dt < 2."""
    push = penalty_force(gap(x, p), v @ p.n, p.stiffness, p.damping)
    v = v + dt * (acceleration(t, x, v, p) + push * p.n)
    return x + dt * v, v


def projecting_step(acceleration, t, x, v, dt, p):
    """Advance a Drop by one step, and put right at its end what went wrong on the way; first order.

    v ← v + dt a(t, x, v),    x ← x + dt v                       as usual, the velocity first
    φ = gap(x, p) < 0:        v ← kinematic_response(v, n, e),   x ← x − φ n

    *Source:* deck B, time stepping, "Option 2".
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 7.15: projecting_step")


def fly(x, v, a, t):
    """Given.  (x, v) after t [s] under a constant acceleration a:  x + t v + ½ t² a,  v + t a."""
    return x + t * v + 0.5 * t * t * a, v + t * a


def lie(x, v, a, t, n):
    """Given.  (x, v) after t [s] of a ball that lies on its plane: it slides along without friction; a support pushes, and never pulls."""
    return fly(x, tangential(v, n), a - np.minimum(0.0, a @ n) * n, t)


def backtracking_step(acceleration, t, x, v, dt, p):
    """Advance a Drop by one step, impact by impact; exact while the acceleration is constant.

    a = acceleration(t, x, v, p), for the whole step.  While there is something left of dt, at most IMPACTS times:
    τ = impact_time(φ, v · n, a · n, left),     φ = gap(x, p);     (x, v) = fly(x, v, a, τ);     left ← left − τ
    where nothing is left: done.                Otherwise it is on the plane:
    v ← kinematic_response(v, n, e),            x ← x − gap(x, p) n                                   (which is round-off)
    if bouncing_time(v · n, a · n, e) ≤ left:   all its bounces end within this step: return lie(x, v, a, left, n)

    Raises Diverged after IMPACTS impacts.
    *Source:* deck B, time stepping, "Option 1".
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 7.16: backtracking_step")


def check_over_plane(p, d):
    """Given.  Raise BadInput for an e outside 0 … 1, and unless gravity, the point and the unit normal of a plane have d coordinates."""
    check_restitution(finite_number("restitution e [-]", p.e))
    check_field("gravity [m/s²]", p.gravity, (d,))
    check_field("point of the plane [m]", p.point, (d,))
    check_field("normal of the plane [-]", p.n, (d,))
    check_normal(p.n)


def drop_all(step, acceleration, t, x, v, dt, steps, p):
    """Given.  The states (x, v), each (copies, d), of copies of a Drop that know nothing of each other, after so many steps of one method.

    Raises BadInput for a step that is not positive, an e outside 0 … 1, a normal that is not one, a state that is not finite; Diverged when
    the end is not finite.
    """
    t, x, v, dt, steps = checked_run(t, x, v, dt, steps)
    check_array("position x [m]", x, 2)
    check_over_plane(p, x.shape[1])
    for thing, value in (("stiffness over mass [1/s²]", p.stiffness), ("damping over mass [1/s]", p.damping)):
        check_not_negative(thing, number(thing, value))
    x, v = x.copy(), v.copy()
    for k in range(x.shape[0]):
        x_k, v_k = x[k], v[k]
        for n in range(steps):
            x_k, v_k = step(acceleration, t + n * dt, x_k, v_k, dt, p)
        x[k], v[k] = x_k, v_k
    check_end(x, v, dt)
    return x, v


# ---------------------------------------------------------------------------------------------- a ball that turns

def spinning_impact(v, omega, p):
    """Given.  (v, ω) of a Spinner after it has hit its plane: at the offset −radius n, with contact_impulse."""
    r = -p.radius * p.n
    J = contact_impulse(point_velocity(v, omega, r), p.n, point_inverse_mass(r, p.inv_mass, p.inv_inertia), p.e, p.mu)
    return v + p.inv_mass * J, omega + times(p.inv_inertia, cross(r, J))


def projecting_spin_step(acceleration, t, x, v, omega, dt, p):
    """Given.  Advance a Spinner as projecting_step does; first order."""
    x, v = symplectic_euler_step(acceleration, t, x, v, dt, p)
    if gap(x, p) >= 0.0:
        return x, v, omega
    v, omega = spinning_impact(v, omega, p)
    return put_on_plane(x, p), v, omega


def put_on_plane(x, p):
    """Given.  The place (d,) on the plane of p that is nearest to x:  x − φ n."""
    return x - gap(x, p) * p.n


def fly_to_plane(x, v, a, left, p):
    """Given.  (x, v, what is then left of `left` [s]): on, under a constant acceleration, to the plane of p or to the end, whichever is first."""
    tau = impact_time(gap(x, p), v @ p.n, a @ p.n, left)
    x, v = fly(x, v, a, tau)
    return x, v, left - tau


def backtracking_spin_step(acceleration, t, x, v, omega, dt, p):
    """Given.  Advance a Spinner impact by impact; exact while the acceleration is constant.  Raises Diverged after IMPACTS impacts."""
    a = acceleration(t, x, v, p)
    x, v, left = fly_to_plane(x, v, a, dt, p)
    for _ in range(IMPACTS):
        if left <= 0.0:
            return x, v, omega
        v, omega = spinning_impact(v, omega, p)
        x, v, left = fly_to_plane(put_on_plane(x, p), v, a, left, p)
    raise Diverged("impacts without end in a step of dt [s]", dt, "take a smaller step")


def spin_all(step, acceleration, t, x, v, omega, dt, steps, p):
    """Given.  (x, v, ω), each (copies, 3), of copies of a Spinner after so many steps of one method; errors as in drop_all, or for μ < 0."""
    t, x, v, dt, steps = checked_run(t, x, v, dt, steps)
    check_field("position x [m]", x, (len(x), 3))
    omega = finite_array("angular velocity ω [rad/s]", omega)
    check_shape("the angular velocity ω", omega, x.shape)
    check_over_plane(p, 3)
    check_friction(number("friction μ [-]", p.mu))
    check_positive("inverse mass [1/kg]", number("inverse mass [1/kg]", p.inv_mass))
    check_field("inverse inertia [1/(kg m²)]", p.inv_inertia, (3, 3))
    positive_number("radius [m]", p.radius)
    x, v, omega = x.copy(), v.copy(), omega.copy()
    for k in range(x.shape[0]):
        x_k, v_k, omega_k = x[k], v[k], omega[k]
        for n in range(steps):
            x_k, v_k, omega_k = step(acceleration, t + n * dt, x_k, v_k, omega_k, dt, p)
        x[k], v[k], omega[k] = x_k, v_k, omega_k
    check_end(x, v, dt)
    return x, v, omega


# ---------------------------------------------------------------------------------------------- discs that meet

def meeting_time(x, v, i, j, reach, dt):
    """Given.  When [s] two round things i and j meet, reach [m] the sum of their radii; dt if not before.

    |Δx + τ Δv| = reach, with the distance falling; what overlaps and comes closer meets now.
    """
    closing, apart, speed = 0.0, -reach * reach, 0.0
    for k in range(x.shape[1]):
        dx, dv = x[i, k] - x[j, k], v[i, k] - v[j, k]
        closing, apart, speed = closing - dx * dv, apart + dx * dx, speed + dv * dv
    apart = np.maximum(0.0, apart)
    squared = closing * closing - speed * apart
    return min(dt, apart / (closing + np.sqrt(squared))) if closing > 0.0 and squared >= 0.0 else dt


def overlap(x, i, j, reach):
    """Given.  Whether two round things are closer than the sum of their radii, reach [m]."""
    squared = 0.0
    for k in range(x.shape[1]):
        squared += (x[i, k] - x[j, k]) ** 2
    return squared < reach * reach


def normal_between(x, i, j):
    """Given.  (distance [m], unit normal (d,) from disc j to disc i).  Two on one point have none: then any will do, the first axis."""
    n = x[i] - x[j]
    distance = np.sqrt(n @ n)
    if distance == 0.0:
        n[0] = 1.0
        return 0.0, n
    return distance, n / distance


def disc_impact(x, v, i, j, p):
    """Given.  (v_i, v_j), each (d,), after disc i has met disc j without friction: the impulse j n of impulse_size."""
    _, n = normal_between(x, i, j)
    size = impulse_size((v[i] - v[j]) @ n, p.inv_mass[i] + p.inv_mass[j], p.e)
    return v[i] + p.inv_mass[i] * size * n, v[j] - p.inv_mass[j] * size * n


def separated(x, i, j, p):
    """Given.  (x_i, x_j), each (d,), with two discs that overlap moved apart along their normal until they touch, the lighter the farther.

    Only positions change: whoever starts inside another is separated, and not thrown out.
    """
    distance, n = normal_between(x, i, j)
    share = np.maximum(0.0, p.radius[i] + p.radius[j] - distance) / (p.inv_mass[i] + p.inv_mass[j])
    return x[i] + share * p.inv_mass[i] * n, x[j] - share * p.inv_mass[j] * n


def drift(x, v, dt):
    """Given.  x + dt v, body by body: compiled loops over short rows cost less than arrays of two dimensions."""
    x = 1.0 * x
    for k in range(x.shape[0]):
        x[k] += dt * v[k]
    return x


def projecting_discs_step(x, v, dt, p):
    """Given.  Advance discs by one step, then treat all that overlap, pair by pair; first order."""
    x, v = drift(x, v, dt), 1.0 * v
    for i in range(x.shape[0]):
        for j in range(i):
            if overlap(x, i, j, p.radius[i] + p.radius[j]):
                v[i], v[j] = disc_impact(x, v, i, j, p)
                x[i], x[j] = separated(x, i, j, p)
    return x, v


def backtracking_discs_step(x, v, dt, p):
    """Given.  Advance discs impact by impact, the earliest first; exact.  Raises Diverged after IMPACTS impacts.

    Of impacts at the same moment the first pair in the list goes first: a choice.
    """
    left, v = dt, 1.0 * v
    for _ in range(IMPACTS):
        tau, first, second = left, 0, 0
        for i in range(x.shape[0]):
            for j in range(i):
                meets = meeting_time(x, v, i, j, p.radius[i] + p.radius[j], left)
                if meets < tau:
                    tau, first, second = meets, i, j
        x = drift(x, v, tau)
        left -= tau
        if left <= 0.0:
            return x, v
        v[first], v[second] = disc_impact(x, v, first, second, p)
    raise Diverged("impacts without end in a step of dt [s]", dt, "take a smaller step")


def discs_all(step, x, v, dt, steps, p):
    """Given.  (x, v), each (copies, bodies, d), of copies of some discs after so many steps of one method; errors as in drop_all."""
    _, x, v, dt, steps = checked_run(0.0, x, v, dt, steps)
    check_array("position x [m]", x, 3)
    check_restitution(finite_number("restitution e [-]", p.e))
    for thing, values in (("radius of a disc [m]", p.radius), ("inverse mass of a disc [1/kg]", p.inv_mass)):
        check_field(thing, values, x.shape[1:2])
        check_not_negative(thing, values.min())
    x, v = x.copy(), v.copy()
    for k in range(x.shape[0]):
        x_k, v_k = x[k], v[k]
        for _ in range(steps):
            x_k, v_k = step(x_k, v_k, dt, p)
        x[k], v[k] = x_k, v_k
    check_end(x, v, dt)
    return x, v


# ---------------------------------------------------------------------------------------------- several impacts at once

def check_impacts(body, r, n, e, mu):
    """Given.  Raise BadInput unless a Solid, its offsets r (points, 3), as many unit normals n, e and μ are what an impact can be made of."""
    check_restitution(finite_number("restitution e [-]", e))
    check_friction(number("friction μ [-]", mu))
    check_positive("inverse mass [1/kg]", number("inverse mass [1/kg]", body.inv_mass))
    check_field("velocity v [m/s]", body.v, (3,))
    check_field("angular velocity ω [rad/s]", body.omega, (3,))
    check_field("inverse inertia [1/(kg m²)]", body.inv_inertia, (3, 3))
    check_field("offsets r of the points [m]", r, (len(r), 3))
    check_field("normals n of the points [-]", n, r.shape)
    for i in range(len(n)):
        check_normal(n[i])


def one_after_the_other(body, r, n, e, mu):
    """Given.  (Solid, residual [m/s]) after an impact at several points, as in solve_impacts, but each point once, in turn.

    Each finds the body as the one before has left it, so that the result depends on their order: two ends of an edge leave at
    different speeds.
    """
    check_impacts(body, r, n, e, mu)
    w, Js, after = rebound_speeds(body, r, n, e), np.zeros(r.shape), body
    for i in range(len(r)):
        u = point_velocity(after.v, after.omega, r[i])
        Js[i] = contact_impulse(u, n[i], point_inverse_mass(r[i], body.inv_mass, body.inv_inertia), e, mu)
        after = push(after, r[i], Js[i])
    return after, impact_residual(after, r, n, Js, w, mu)


def rebound_speeds(body, r, n, e):
    """Given.  wᵢ = max(0, −e nᵢ · uᵢ) [m/s] (points,): Newton's restitution of the velocities before the impact."""
    w = np.zeros(len(r))
    for i in range(len(r)):
        w[i] = np.maximum(0.0, -e * (n[i] @ point_velocity(body.v, body.omega, r[i])))
    return w


def largest_speed(body, r):
    """Given.  Largest |v| + |ω||rᵢ| [m/s]: the velocity of a point is a sum of these two, and is rounded like them, however small it is."""
    reach = 0.0
    for i in range(len(r)):
        reach = max(reach, norm(r[i]))
    return norm(body.v) + norm(body.omega) * reach


def impact_residual(after, r, n, Js, w, mu):
    """Given.  How far [m/s] impulses Js (points, 3) are from the law of cone_impulse: the largest velocity by which it would still change
    one of the points, each asked alone; 0 where the law holds at all of them.
    """
    worst = 0.0
    for i in range(len(r)):
        K = point_inverse_mass(r[i], after.inv_mass, after.inv_inertia)
        u = point_velocity(after.v, after.omega, r[i]) - times(K, Js[i])
        worst = np.maximum(worst, np.abs(times(K, cone_impulse(u, n[i], K, w[i], mu) - Js[i])).max())
    return worst


def into_cone(J, n, mu):
    """Given.  The impulse (3,) of Coulomb's cone |J_t| ≤ μ J_n that is nearest to J (3,)."""
    J_n, J_t, beta = J @ n, tangential(J, n), np.arctan(mu)
    size = np.sqrt(J_t @ J_t)
    if J_n >= 0.0 and size * np.cos(beta) <= J_n * np.sin(beta):
        return J
    along_rim = np.maximum(0.0, J_n * np.cos(beta) + size * np.sin(beta))
    return along_rim * (np.cos(beta) * n + np.sin(beta) / size * J_t) if size > 0.0 else np.maximum(0.0, J_n) * n


def most_dissipative_impact(body, r, n, e, mu):
    """Given.  (Solid, residual [m/s]) after an impact at several points at once, for which the law of solve_impacts has no answer or
    its sweeps do not find it.

    Of all impulses inside the cones take those that leave the least kinetic energy: a convex problem, which always has an answer.  Each
    point in turn goes down the gradient of the energy, its own velocity uᵢ, and back into its cone:  Jᵢ ← into_cone(Jᵢ − uᵢ/tr Kᵢ).
    Scale all of them to the least energy, s = 1, and rebound with s = 1 + e (Poisson's restitution), or with less, so that no point goes
    into the other body.  It never gains energy: over s that is a parabola, and s = 1 + e loses 1 − e² of what s = 1 loses.
    *Source:* Moreau 1973, maximum dissipation; Anitescu 2006, the convex problem; Poisson 1817, the two phases.
    """
    before = np.zeros((len(r), 3))
    for i in range(len(r)):
        before[i] = point_velocity(body.v, body.omega, r[i])
    w, Js, after, speed = rebound_speeds(body, r, n, e), np.zeros((len(r), 3)), body, largest_speed(body, r)
    for _ in range(SWEEPS):
        change = 0.0
        for i in range(len(r)):
            K = point_inverse_mass(r[i], body.inv_mass, body.inv_inertia)
            u = point_velocity(after.v, after.omega, r[i])
            J = into_cone(Js[i] - u / (K[0, 0] + K[1, 1] + K[2, 2]), n[i], mu) - Js[i]
            change, after = np.maximum(change, np.abs(times(K, J)).max()), push(after, r[i], J)
            Js[i] += J
        if change <= SETTLED * speed:
            break
    gain, curvature, share = 0.0, 0.0, 1.0 + e
    for i in range(len(r)):
        u = point_velocity(after.v, after.omega, r[i])
        gain, curvature = gain + Js[i] @ before[i], curvature + Js[i] @ (u - before[i])
        leaves, would_leave = n[i] @ before[i], np.maximum(0.0, n[i] @ u)
        if leaves > would_leave:                         # the impact slows this point: it may come to rest along n, not turn round
            share = np.minimum(share, leaves / (leaves - would_leave))
    share *= -gain / curvature if gain < 0.0 else 0.0
    after = body
    for i in range(len(r)):
        Js[i] *= share
        after = push(after, r[i], Js[i])
    return after, impact_residual(after, r, n, Js, w, mu)


def solve_impacts(body, r, n, e, mu):
    """(Solid, residual [m/s]) after an impact at several points at once, offsets r (points, 3), normals n (points, 3), with what cannot
    be moved.

    wᵢ = rebound_speeds(body, r, n, e), from the velocities before the impact, and  Jᵢ = 0.  Then sweep over all points:
        uᵢ = v + ω × rᵢ;  take back the point's own impulse:   u = uᵢ − Kᵢ Jᵢ,    Kᵢ = point_inverse_mass(rᵢ, 1/m, I⁻¹)
        ask what it should be now:           J = cone_impulse(u, nᵢ, Kᵢ, wᵢ, μ);    push the body by J − Jᵢ at rᵢ;    Jᵢ ← J
    The residual of a sweep is the largest component of a velocity Kᵢ (J − Jᵢ) by which an impulse changed its own point.  It has settled
    when that is at most SETTLED times largest_speed(body, r).  Where SWEEPS sweeps are not enough, return most_dissipative_impact(body, r, n, e, μ), given above, of the body
    before the impact: with much friction the law can be without an answer, and its residual says so.

    Together: the order of the points does not matter in the end, and what met the floor flat leaves it flat.
    Raises what check_impacts raises; call it first.
    *Source:* Gauss–Seidel sweeps, as in Guendelman et al. 2003; deck B, "Multi-contact problems".
    *Left out:* how an impact travels from point to point; contacts between many bodies.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 7.17: solve_impacts")
