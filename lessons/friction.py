"""Lesson 3.  Friction: the force that knows when to stop.

Symbols: x (d,) [m], v (d,) [m/s] of a block or a particle in d dimensions · n (d,) unit normal of what supports it, towards its
side · F [N], F_N [N] normal force · μ [-] friction, μ_s static, μ_k kinetic · J, j [N s] impulse · e [-] restitution · φ [m] gap.

A support pushes, and never pulls: F_N ≥ 0.  Across its normal it answers with whatever stops the motion, but with no more than
μ F_N: the forces that a support can give fill a cone.  An index t means the part along the surface, y_t = y − (y · n) n.
Every law of forces here is one of accelerations as well: put a for F and m = 1.
*Left out:* rotation (a block that tips, a ball that rolls): lesson 5.  Friction that depends on speed, time or area.
"""

from typing import NamedTuple

import numpy as np

from solutions.checks import (
    BadInput,
    Diverged,
    check_array,
    check_end,
    check_field,
    check_friction,
    check_normal,
    check_restitution,
    check_shape,
    checked_run,
    finite_array,
    finite_number,
    number,
    positive_number,
)

HALVINGS = 60                # of an interval of time: 2⁻⁶⁰ of a step is below the spacing of floats
EVENTS = 8                   # stops and starts in one step [-]; a force that reverses more often needs a shorter step


class Block(NamedTuple):
    """A block that stays on a plane: what it lies on, and what pulls at it."""
    n: np.ndarray            # (d,) unit normal of the plane
    mu_s: float              # static friction [-]
    mu_k: float              # kinetic friction [-], not above mu_s
    gravity: np.ndarray      # (d,) [m/s²]
    push: np.ndarray         # (d,) periodic force over mass [m/s²], at its height
    omega: float             # its angular frequency [rad/s]


class OnPlane(NamedTuple):
    """A particle above a plane."""
    m: float                 # mass [kg]
    mu: float                # friction [-]
    e: float                 # restitution [-]
    gravity: np.ndarray      # (d,) [m/s²]
    point: np.ndarray        # (d,) a point of the plane [m]
    n: np.ndarray            # (d,) its unit normal


class InBowl(NamedTuple):
    """A particle in a round hollow: a bowl or a trough."""
    m: float                 # mass [kg]
    mu: float                # friction [-]
    e: float                 # restitution [-]
    gravity: np.ndarray      # (d,) [m/s²]
    centre: np.ndarray       # (d,) centre of the bowl, or a point of the trough's axis [m]
    axis: np.ndarray         # (d,) zeros: a bowl (a sphere; in the plane a circle).  A unit vector: a trough (a cylinder) along it
    radius: float            # [m]


# ---------------------------------------------------------------------------------------------- at rest and sliding

def tangential(y, n):
    """Given.  The part of y (d,) along a surface of unit normal n:  y − (y · n) n."""
    return y - (y @ n) * n


def cone_radius(mu, F_N):
    """Given.  μ F_N, the most that friction can be; without load 0, even where μ = ∞.  Raises BadInput for a negative μ."""
    check_friction(mu)
    return 0.0 if F_N <= 0.0 else mu * F_N               # in this order, so that a load of NaN is not taken for none


def normal_force(F, n):
    """Size F_N [N] of the force with which a support answers everything else, F (d,), that acts on a body resting on it.

    F_N = max(0, −F · n)          along n: it cancels what presses, and lets go of what lifts

    *Source:* deck A, "Resting contact", "Normal force".
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.1: normal_force")


def static_friction(F, n, mu_s):
    """Static friction (d,) [N] on a body at rest that F (d,) pulls at: it holds if it can, else it does what it can.

    F_s = −F_t                           while |F_t| ≤ μ_s F_N,    F_N = normal_force(F, n),   F_t = tangential(F, n)
    F_s = −μ_s F_N F_t/|F_t|             beyond: then the body begins to slide

    Take μ_s F_N from cone_radius: it raises BadInput for a negative μ_s, and knows what μ_s = ∞ means.
    *Source:* deck A, "Static friction", F_s = μ_s F_N.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.2: static_friction")


def kinetic_friction(F, v, n, mu_k):
    """Kinetic friction (d,) [N] on a body that slides with v (d,) while F (d,) acts on it.

    F_k = −μ_k F_N v_t/|v_t|             however fast it slides;   0 where v_t = 0: that is the case of static friction

    Take μ_k F_N from cone_radius.
    *Source:* deck A, "Kinetic friction", F_k = μ_k F_N.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.3: kinetic_friction")


def incline_acceleration(theta, mu_s, mu_k, g):
    """Acceleration [m/s²] down a slope of angle θ [rad], 0 ≤ θ < π/2, of a block that is put on it at rest.

    0                        while sin θ ≤ μ_s cos θ:  the slope is not steeper than the cone is wide, tan θ ≤ μ_s
    g (sin θ − μ_k cos θ)    beyond

    Take μ_s cos θ and μ_k cos θ from cone_radius: cos θ is the normal force over the weight.
    *Source:* deck A, "Friction (2)".
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.4: incline_acceleration")


# ---------------------------------------------------------------------------------------------- Coulomb's cone

def friction_impulse(v_t, m, j_n, mu):
    """The impulse (d,) [N s] along a surface that leaves a body of mass m the least kinetic energy, of all that the cone allows.

    J_t = −min(μ j_n, m |v_t|) v_t/|v_t|          of all |J_t| ≤ μ j_n;   0 where v_t = 0

    Either it slides on, and friction is on the rim of the cone, against the motion: −μ j_n v_t/|v_t|; or it stops, and friction is
    inside: −m v_t itself, for m |v_t| v_t/|v_t| would leave a round-off of velocity, and that is a motion.  That is Coulomb's law, and the principle of maximum dissipation is all of it.  j_n ≥ 0 [N s]: the normal impulse; μ j_n: cone_radius.
    *Source:* deck B, "Maximum dissipation principle"; Moreau 1973 for the principle.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.5: friction_impulse")


def pyramid_impulse(v_t, m, j_n, mu, t_1, t_2):
    """The same for a pyramid in place of the cone, whose sides face the unit vectors t_1 and t_2 (d,), both along the surface and across each other.

    J_t = −clamp(m v_t · t_1) t_1 − clamp(m v_t · t_2) t_2          clamp(y): y, but not beyond ±μ j_n

    Of all J_t with |J_t · t_1| ≤ μ j_n and |J_t · t_2| ≤ μ j_n it leaves the least kinetic energy.  Solvers like it because one
    direction asks nothing of the other; it brakes up to √2 times too strongly, and not against the motion.
    *Source:* the box friction of most game engines; Stewart and Trinkle 1996 for pyramids with many sides.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.6: pyramid_impulse")


# ---------------------------------------------------------------------------------------------- a block in time

def make_block(n, mu_s, mu_k, gravity, push, omega):
    """Given.  A Block from lists, tuples or arrays; n may have any length but zero.

    Raises BadInput for a negative μ, for μ_k above μ_s (then it could neither hold nor slide), for what is not finite.
    """
    mu_s, mu_k = number("static friction μ_s [-]", mu_s), number("kinetic friction μ_k [-]", mu_k)
    check_friction(mu_s)
    check_friction(mu_k)
    if mu_k > mu_s:
        raise BadInput("kinetic friction μ_k [-]", mu_k, f"give at most the static μ_s = {mu_s}")
    n, gravity, push = finite_array("normal n [-]", n), finite_array("gravity [m/s²]", gravity), finite_array("push over mass [m/s²]", push)
    check_array("normal n", n, 1)
    length = positive_number("length of the normal n [-]", np.linalg.norm(n))
    for thing, y in (("gravity", gravity), ("push over mass", push)):
        check_shape(thing, y, n.shape[:1])
    return Block(n / length, mu_s, mu_k, gravity, push, finite_number("angular frequency ω [rad/s]", omega))


def driven_acceleration(t, x, v, p):
    """Given.  What pulls at a Block p, friction and support not counted:  a = g + push cos ωt  [m/s²]."""
    return p.gravity + np.cos(p.omega * t) * p.push


def sliding_step(acceleration, t, x, v, dt, p):
    """Advance a block on its plane by one step, friction as an impulse; first order, and it stops for good.

    a = acceleration(t, x, v, p):  everything but support and friction.   a_n = normal_force(a, n),   a_t = tangential(a, n)
    at rest (v = 0) and |a_t| ≤ μ_s a_n:  nothing moves.    Otherwise
    v* = v + dt a_t,    vₙ₊₁ = v* + friction_impulse(v*, 1, dt a_n, μ_k),    xₙ₊₁ = xₙ + dt vₙ₊₁

    The impulse takes at most the velocity that is there: that is what friction as a force cannot know.  v lies in the plane.
    p has the fields n, mu_s and mu_k of a Block.
    *Source:* deck B, the order of its steps; Moreau 1988 for friction as an impulse a step.
    *Left out:* a block that is lifted off; and one whose pull turns it round within a step: it was at rest in between, where μ_s would
    have held it on a slope between the two μ, and this step does not see that.  event_step does.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.7: sliding_step")


def pyramid_step(acceleration, t, x, v, dt, p):
    """Given.  A sliding step on the floor of a three-dimensional room, n = (0, 0, 1), with the pyramid along x and y for the cone."""
    pull = dt * acceleration(t, x, v, p)
    t_1, t_2 = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
    v_free = v + tangential(pull, p.n)
    v_new = v_free + pyramid_impulse(v_free, 1.0, normal_force(pull, p.n), p.mu_k, t_1, t_2)
    return x + dt * v_new, v_new


# ---------------------------------------------------------------------------------------------- stick, slip, and when

def slip_direction(acceleration, t, x, v, p):
    """Where a block slides from here: a unit vector (d,), or zeros where it stays.

    moving:  v/|v|          at rest:  a_t/|a_t| if |a_t| > μ_s a_n, else 0          (a, a_n and a_t as in sliding_step)

    *Source:* deck B, the two cases of Coulomb's law.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.8: slip_direction")


def slide(acceleration, t, x, v, dt, d, p):
    """Given.  (x, v) after a midpoint step of a block under kinetic friction along −d, whatever v becomes meanwhile.

    Second order while the path is straight, and exact while nothing changes.
    """
    early = acceleration(t, x, v, p)
    v_mid = v + 0.5 * dt * (tangential(early, p.n) - cone_radius(p.mu_k, normal_force(early, p.n)) * d)
    middle = acceleration(t + 0.5 * dt, x + 0.5 * dt * v, v_mid, p)
    return x + dt * v_mid, v + dt * (tangential(middle, p.n) - cone_radius(p.mu_k, normal_force(middle, p.n)) * d)


def stopping_time(acceleration, t, x, v, dt, d, p):
    """After how long [s] a block that slides along d comes to rest: the τ in (0, dt] at which its speed along d is zero.

    If  slide(acceleration, t, x, v, dt, d, p)  ends with  v · d > 0  it does not stop in this step: return dt.
    Otherwise halve the interval (0, dt] HALVINGS times: keep the half at whose beginning a slide of that length still moves
    (v · d > 0) and at whose end it does not.  Return its end.
    *Source:* bisection; deck B, "go back to time of impact", for the idea.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.9: stopping_time")


def breakaway_time(acceleration, t, x, v, dt, p):
    """After how long [s] a block that holds at t begins to slide: the τ in (0, dt] from which on |a_t| > μ_s a_n.

    The block is at x, at rest (v is zeros) all the while.  If it still holds at t + dt (slip_direction is zeros): return dt.
    Otherwise halve (0, dt] HALVINGS times, so that it holds at the beginning and slips at the end.  Return the end.
    *Left out:* a force that exceeds the limit between t and t + dt and is back within it at t + dt.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.10: breakaway_time")


def until_event(acceleration, t, x, v, dt, p):
    """(τ, x, v): go on until the block stops or breaks away, or for dt [s] if it does neither; second order.

    Let d = slip_direction(acceleration, t, x, v, p).  Then
    where d is zeros:   τ = breakaway_time,   x and v as they are
    elsewhere:          τ = stopping_time,    (x, v) from slide over τ;   if τ < dt it has stopped: v is zeros, exactly

    *Source:* event-driven simulation; deck B, "Option 1".
    *Left out:* paths that bend, where the force is not along the motion: use sliding_step for those.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.11: until_event")


def event_step(acceleration, t, x, v, dt, p):
    """Given.  Advance a block by one step, through its stops and starts; second order, exact while nothing changes.

    Raises Diverged when EVENTS of them do not carry it to the end of the step.
    """
    left = dt
    for _ in range(EVENTS):
        tau, x, v = until_event(acceleration, t, x, v, left, p)
        t, left = t + tau, left - tau
        if left <= 0.0:
            return x, v
    raise Diverged("stops and starts without end in a step of dt [s]", dt, "take a smaller step")


def slip_times(acceleration, t, x, v, dt, steps, p):
    """Given.  (k, 2) [s]: when each slip begins and ends; the last ends with the run if the block is still sliding then."""
    t, x, v, dt, steps = checked_run(t, x, v, dt, steps)
    check_normal(p.n)
    check_shape("the position x", x, p.n.shape)
    finite_array("acceleration at the start [m/s²]", acceleration(t, x, v, p))
    times = np.zeros((EVENTS * steps, 2))
    k, slipping = 0, False
    for step in range(steps):
        here, left = t + step * dt, dt
        for _ in range(EVENTS):
            slides = bool(np.any(slip_direction(acceleration, here, x, v, p)))
            if slides and not slipping:
                times[k, 0] = here
                k += 1
            tau, x, v = until_event(acceleration, here, x, v, left, p)
            here, left = here + tau, left - tau
            slipping = slides and bool(np.any(v))
            if slides:
                times[k - 1, 1] = here
            if left <= 0.0:
                break
    return times[:k]


# ---------------------------------------------------------------------------------------------- a particle and a surface

def falling_acceleration(t, x, v, p):
    """Given.  a = g  [m/s²]."""
    return p.gravity


def plane_gap(x, p):
    """Given.  (φ, n) of a plane:  φ = (x − point) · n,  positive on the free side, and its unit normal."""
    return (x - p.point) @ p.n, p.n


def bowl_gap(x, p):
    """(φ, n) of a round hollow: how far inside x (d,) is [m], and the unit normal (d,) of the nearest wall, towards the inside.

    r = x − centre, less its part along the axis:  r ← r − (r · axis) axis          (axis = 0: a bowl)
    φ = radius − |r|,     n = −r/|r| = ∇φ;          in the very middle, where every wall is as near, n = 0

    *Source:* deck B, the implicit function φ(x) of an obstacle.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.12: bowl_gap")


def contact_impulse(v, n, m, e, mu):
    """Impulse J (d,) [N s] of a fixed surface on a particle of mass m that touches it with v (d,) [m/s].

    v_n = v · n;  where v_n ≥ 0 it leaves by itself: J = 0.          Otherwise
    j_n = −(1 + e) m v_n          then  n · v⁺ = −e n · v
    J = j_n n + J_t,              J_t = friction_impulse(v_t, m, j_n, μ) = −min(μ j_n, m |v_t|) v_t/|v_t|

    *Source:* deck B, "A simple strategy for particle/implicit collisions".
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.13: contact_impulse")


def contact_step(acceleration, surface, t, x, v, dt, p):
    """Advance a particle by one step, and put it back if that led into the obstacle; first order.

    v ← v + dt a(t, x, v),    x ← x + dt v                      as usual, the velocity first
    (φ, n) = surface(x, p);   if φ < 0:
        v ← v + contact_impulse(v, n, m, e, μ)/m                which is nothing where v leads out
        x ← x − φ n

    A particle that should stay put on a slope is moved by dt² g sin θ along it at every step, and put back only across it: it
    creeps with dt g sin θ, the artificial sliding of this method.  p has the fields m, e and mu.
    *Source:* deck B, "A simple strategy for particle/implicit collisions".
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.14: contact_step")


def grip_correction(moved, n, depth, mu):
    """Correction (d,) [m] along the surface of a particle that a step moved by `moved` (d,), and so pressed in by depth ≥ 0 [m].

    Δx_t = −min(μ depth, |s|) s/|s|,     s = tangential(moved, n);          0 where s = 0

    Friction once more, for positions: the depth is what the normal correction undoes, and friction undoes up to μ times as much.
    On a slope depth = dt² g cos θ, so that a particle at rest is put back to where it was as long as tan θ ≤ μ.
    *Source:* deck B, "tangential position correction to counteract artificial sliding"; Macklin et al. 2014, eq. 24.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.15: grip_correction")


def gripping_step(acceleration, surface, t, x, v, dt, p):
    """Advance a particle as contact_step does, with the tangential correction of its position; first order, and no creep.

    As contact_step.  Where φ < 0 and the velocity led in (v · n < 0, before the impulse), add to x also
        grip_correction(the displacement by this step before x was put back, n, −φ, μ)

    *Source:* deck B, the last line of that strategy.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 3.16: gripping_step")


def contact_motion(step, acceleration, surface, t, x, v, dt, steps, p):
    """Given.  The state (x, v) of a particle after so many steps of one method.

    Raises BadInput for a mass or a step that is not positive, a negative μ, an e outside 0 … 1, a state that is not finite, and a
    surface whose normal at x is no unit vector; Diverged when the end is not finite.
    """
    t, x, v, dt, steps = checked_run(t, x, v, dt, steps)
    positive_number("mass m [kg]", p.m)
    check_friction(number("friction μ [-]", p.mu))
    check_restitution(finite_number("restitution e [-]", p.e))
    check_field("gravity [m/s²]", p.gravity, x.shape)
    phi, n = surface(x, p)
    finite_number("gap at the start [m]", phi)
    check_field("normal at the start [-]", n, x.shape)
    if np.any(n):                                        # in the middle of a bowl there is no normal
        check_normal(n)
    for n in range(steps):
        x, v = step(acceleration, surface, t + n * dt, x, v, dt, p)
    check_end(x, v, dt)
    return x, v
