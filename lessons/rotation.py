"""Lesson 5.  A single rigid body.

    ẋ = P/M,   Ṙ = ω* R,   Ṗ = F,   L̇ = τ           with   ω = I⁻¹ L,   I = R I_body Rᵀ

Symbols: x (3,) [m] centre of mass · v [m/s] · P [kg m/s] · R (3, 3), q (4,) = (w, x, y, z) orientation: both
convert body to world coordinates · ω (3,) [rad/s] · L (3,) [kg m²/s] · τ (3,) [N m] · I_body (3,) [kg m²]
principal moments.
Vectors are in world coordinates, unless the name ends in _body.  The axes of the body are
its principal axes, which lesson 4 computes.

A method for rotation alone is a function  step(torque, t, q, L, dt, body) → (q, L)  at t + dt.  torque(t, q, L, body)
returns (3,) [N m].  body is any record with a field I_body and is passed on unchanged.  Where the state of a step is L
itself, L stays constant to the last digit without a torque.  Where it is ω (rigid_body_step, gyroscopic_step), it does
not.  A body that also moves has  step(load, t, x, q, v, omega, dt, body) → (x, q, v, omega).
Given in solutions/given/rotation.py: make_rigid_body; steps by the other updates of orientation, by ω as the state, and
by Runge–Kutta; compositions of fourth order; loops over steps.
*Left out:* contacts, except of a ball on a floor; lesson 6 finds contacts and lesson 7 resolves them.
"""

from typing import NamedTuple

import numpy as np

from solutions.checks import Diverged, float_copy
from solutions.friction import cone_radius
from solutions.support.quaternions import (
    about_axis,
    body_component,
    exponential,
    rotate,
    solve3,
    unit,
    unrotate,
)
from solutions.vectors import cross, dot, norm

__all__ = [
    "NEWTON_LIMIT", "SUZUKI", "RigidBody", "RigidBodyState", "RollingBall", "Top", "about_axis",
    "angular_acceleration", "angular_velocity", "average_rolling_step", "axis_angle_update",
    "body_angular_momentum", "body_component", "careful_throw_is", "compose", "exponential", "heavy_top_torque",
    "intermediate_axis", "kinetic_energy", "matrix_update", "midpoint_free_rotation", "midpoint_step",
    "my_thrown_body", "no_torque", "point_velocity", "precession_rate", "quaternion_product",
    "quaternion_update", "rigid_body_step", "rolling_step", "rotate", "rotation_matrix", "skew", "solve3",
    "splitting_free_rotation", "splitting_step", "state_derivative", "supported_weight", "total_load",
    "tumbling_rate", "unit", "unrotate",
]

NEWTON_TOLERANCE = 1e-12     # last correction over the unknown [-]; Newton squares it, so only round-off remains
NEWTON_LIMIT = 30            # corrections [-]; from a good guess Newton doubles its digits and needs fewer than 6
SUZUKI = 1.0 / (4.0 - 4.0 ** (1.0 / 3.0))      # share of the step in each of four substeps [-]: 4γ³ + (1 − 4γ)³ = 0


class RigidBodyState(NamedTuple):
    """The state S(t) of the lecture, or its derivative."""
    x: np.ndarray            # (3,) position of the centre of mass [m]
    R: np.ndarray            # (3, 3) orientation: its columns are the axes of the body
    P: np.ndarray            # (3,) momentum [kg m/s]
    L: np.ndarray            # (3,) angular momentum about the centre of mass [kg m²/s]


class RigidBody(NamedTuple):
    """The constant properties of a rigid body."""
    m: float                 # mass [kg]
    I_body: np.ndarray       # (3,) principal moments of inertia [kg m²]


class Top(NamedTuple):
    """A body that rotates about a fixed point on its third axis."""
    I_body: np.ndarray       # (3,) principal moments about the pivot [kg m²]
    mgl: float               # weight times the distance from the pivot to the centre of mass [N m]


class RollingBall(NamedTuple):
    """A ball, or any round body with three equal moments, on a horizontal floor."""
    m: float                 # mass [kg]
    I_body: np.ndarray       # (3,) moments of inertia [kg m²]
    radius: float            # [m]
    mu: float                # friction [-]
    gravity: np.ndarray      # (3,) [m/s²]; for a sloping floor, tilt gravity instead


# ---------------------------------------------------------------------------------------------- rotational movement

def skew(a):
    """Return the matrix a* (3, 3) with  a* b = a × b  for every b.

    *Find* its nine entries.

    *Source:* first lecture deck, “Rotational Movement”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 5.1: skew")


def point_velocity(v, omega, r):
    """Return the velocity [m/s] (3,) of the point of a body at the offset r [m] from its centre of mass:  v + ω × r.

    cross(a, b) is the cross product.
    *Source:* first lecture deck, “Rotational Movement”: a = b + r(t).
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 5.2: point_velocity")


def total_load(x, points, forces):
    """Return force F [N] (3,) and torque τ [N m] (3,) about the centre of mass x of forces (n, 3) at points (n, 3) [m].

    F = Σ fᵢ,   τ = Σ (pᵢ − x) × fᵢ

    *Source:* first lecture deck, “Center of Mass”; second lecture deck, “Simulation loop”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 5.3: total_load")


def angular_velocity(R, L, I_body):
    """Return ω [rad/s] (3,) of a body with the angular momentum L = I ω; both are in world coordinates.

    *Find* it without inverting a matrix.  In body coordinates the inertia tensor is diagonal, with the moments I_body
    (3,).  R converts a vector from body to world coordinates.
    *Source:* first lecture deck, “Angular Momentum”, “Inertia Tensor”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 5.4: angular_velocity")


def state_derivative(S, F, tau, body):
    """Return Ṡ as a RigidBodyState:  ẋ = P/M,  Ṙ = ω* R,  Ṗ = F,  L̇ = τ,  for a RigidBodyState S and a RigidBody.

    ω = angular_velocity(R, L, I_body)

    *Source:* first lecture deck, S(t) and its derivative; Baraff 1997.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 5.5: state_derivative")


# ----------------------------------------------------------------------------------------- three updates of orientation

def matrix_update(R, omega, dt):
    """Return the orientation (3, 3) after dt at ω, first way:  R + dt ω* R, then renormalised; first order.

    Renormalise by Gram and Schmidt: scale the first column to length 1; subtract from the second its part along the
    first, and scale it to length 1; the third is first × second.  The columns of R are not parallel, and none is zero.
    *Source:* first lecture deck, “Update Orientation”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 5.6: matrix_update")


def axis_angle_update(R, omega, dt):
    """Return the orientation (3, 3) after dt at ω, second way: rotate every column r of R about the axis n by θ.

    θ = |ω| dt,   n = ω/|ω|
    r ← cos θ r + sin θ n × r + (1 − cos θ)(n · r) n

    Exact for constant ω.  Where ω = 0 the orientation stays R.  Returns a new array, there too.
    *Source:* first lecture deck, “Extract axis-angle from ω(t) and rotate columns of R(t)”; Rodrigues 1840.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 5.7: axis_angle_update")


def quaternion_product(a, b):
    """Return the product a b (4,) of two quaternions (w, x, y, z): the rotation by b, followed by the rotation by a.

    (a₀, 𝐚)(b₀, 𝐛) = (a₀b₀ − 𝐚·𝐛,  a₀𝐛 + b₀𝐚 + 𝐚×𝐛)

    *Source:* Hamilton 1844; first lecture deck, “Use quaternions”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 5.8: quaternion_product")


def rotation_matrix(q):
    """Return the matrix R (3, 3) of a unit quaternion:  R r = q (0, r) q̄  for every vector r.

    *Find* its columns from the products of quaternions, or its entries by writing the products out.

    q and −q are the same orientation.
    *Source:* second lecture deck, “rotation (matrix R or quaternion q)”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 5.9: rotation_matrix")


def quaternion_update(q, omega, dt):
    """Return the orientation (4,) after dt at ω, third way:  q + dt q̇  with  q̇ = ½ (0, ω) q,  then unit; first order.

    While ω is constant it is second order.  The axis of rotation is exact.  The angle is 2 atan(½|ω| dt) instead of
    |ω| dt, so it is never more than half a turn.  unit raises BadInput for a quaternion 0, which is no orientation.
    *Source:* first lecture deck, “Use quaternions”; second lecture deck, “Don't forget to normalize q”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 5.10: quaternion_update")


def body_angular_momentum(q, omega, I_body):
    """Given.  Return L = I ω [kg m²/s] (3,)."""
    return rotate(q, I_body * unrotate(q, omega))


# ---------------------------------------------------------------------------------------------- the lecture's loop

def angular_acceleration(q, omega, tau, I_body):
    """Return the angular acceleration ω̇ [rad/s²] (3,) of a body under the torque τ, all in world coordinates.

    *Find* it from  L̇ = τ  and  L = I ω.  The tensor I turns with the body, so İ is not zero: what is fixed in the body
    and has the components y in the world changes at the rate ω × y.

    Without a torque, ω̇ is not zero either: the body tumbles.
    rotate(q, r) converts a vector r from body to world coordinates, and unrotate(q, r) from world to body coordinates.
    The moments I_body are above zero.
    *Source:* second lecture deck, “Rigid bodies”; Euler 1758.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 5.11: angular_acceleration")


def rigid_body_step(load, t, x, q, v, omega, dt, body):
    """Advance a rigid body by one step, as in the lecture; return (x, q, v, ω) at t + dt; first order.

    forces and torques:   F, τ = load(t, x, q, v, ω, body)
    velocities:           v ← v + dt F/m,     ω ← ω + dt ω̇
    positions:            x ← x + dt v,       q ← quaternion_update, both with the new velocities

    body is any record with fields m and I_body; load receives it unchanged.
    *Source:* second lecture deck, “Simulation loop”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 5.12: rigid_body_step")


def supported_weight(t, x, q, v, omega, ball):
    """Given.  Return F [N] and τ [N m], each (3,), of a RollingBall on a floor across z: weight and support.

    Gravity may have any direction.  A floor pushes and never pulls.
    """
    F = ball.m * ball.gravity
    return np.array([F[0], F[1], F[2] + max(0.0, -F[2])]), np.zeros(3)


def rolling_step(load, t, x, q, v, omega, dt, ball):
    """Given.  Advance a RollingBall by one step of the lecture's loop, with friction as an impulse J; first order.

    Friction stops the slip u of the lowest point by the end of the step, within the cone |J| ≤ μN dt:
        J = −min(μN dt, |u|/K) u/|u|      u = v + ω × r + dt g_t: the slip without friction,   K = 1/m + radius²/I
    Then rigid_body_step with v + J/m and ω + r × J/I.
    *Source:* second lecture deck, Coulomb's law; lesson 7 does the same for bodies of any shape.
    """
    r = np.array([0.0, 0.0, -ball.radius])
    slip = point_velocity(v, omega, r) + dt * ball.gravity
    slip[2] = 0.0
    size = norm(slip)
    K = 1.0 / ball.m + ball.radius * ball.radius / ball.I_body[0]
    J = np.zeros(3)
    if size != 0.0:
        limit = cone_radius(ball.mu, max(0.0, -ball.m * ball.gravity[2]) * dt)
        J = -np.minimum(limit, size / K) / size * slip
    return rigid_body_step(load, t, x, q, v + J / ball.m, omega + cross(r, J) / ball.I_body[0], dt, ball)


def average_rolling_step(load, t, x, q, v, omega, dt, ball):
    """Given.  Advance as rolling_step does, but the positions with the mean of old and new velocities; second order.

    It is exact while the ball slides or rolls along a line, because its velocities are then linear in t.  Of q this
    holds only if ω keeps its direction, so not for a ball that spins about the vertical, too.
    """
    _, _, v_new, omega_new = rolling_step(load, t, x, q, v, omega, dt, ball)
    turn = exponential(0.5 * dt * (omega + omega_new))
    return x + 0.5 * dt * (v + v_new), quaternion_product(turn, q), v_new, omega_new


def kinetic_energy(q, L, I_body):
    """Return the energy of rotation [J] of a body with the orientation q and the angular momentum L [kg m²/s].

    *Find* it as a function of L.  The energy is the sum of ½ m |ω × r|² over all points, which is ½ ω · L.  In body
    coordinates ω follows from L by three divisions.

    *Source:* Landau and Lifshitz, Mechanics, § 32.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 5.13: kinetic_energy")


def tumbling_rate(I_body, k, spin):
    """Return the rate [1/s] at which a disturbance of a rotation about the k-th principal axis grows as e^(rate·t).

    *Find* it: insert ω = spin 𝐞ₖ plus a small part across 𝐞ₖ into Euler's equations without torque, and keep the terms
    that are linear in that part.

    I_body (3,) are the principal moments, all above zero; k is 0, 1 or 2.  The spin [rad/s] may have either sign; the
    rate is never negative.  It is positive only for the axis of the middle moment (the tennis-racket theorem).  For the
    other axes return 0.
    *Source:* second lecture deck, “Tennis racket theorem”; Euler's equations, linearised about ω = spin 𝐞ₖ.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 5.14: tumbling_rate")


def no_torque(t, q, L, body):
    """Given.  Return τ = 0: a free body."""
    return np.zeros(3)


def heavy_top_torque(t, q, L, top):
    """Return the torque τ [N m] (3,) of gravity, along −z, about the pivot of a Top whose axis is 𝐞 = R (0, 0, 1).

    *Find* it: the weight Mg acts at l𝐞 from the pivot, and top.mgl is the product of the three numbers.

    rotate(q, r) converts a vector r from body to world coordinates; τ is in world coordinates.
    *Source:* Landau and Lifshitz, Mechanics, § 35.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 5.15: heavy_top_torque")


# ---------------------------------------------------------------------------------------------- steps that conserve

def midpoint_free_rotation(q, L, I_body, dt):
    """Return the orientation (4,) of a free body after dt by the implicit midpoint rule; second order, exact energy.

    Let ℓ be the body coordinates of L at the start (unrotate).  Find m, those at the middle of the step:
        m = ℓ + ½dt m × w,    w = m/I_body
    Newton's method: start from a copy of ℓ and repeat, at most NEWTON_LIMIT times,
        r = m − ℓ − ½dt m × w;     column k of its derivative:  𝐞ₖ + ½dt (w − m/Iₖ) × 𝐞ₖ
        m ← m − δ,   δ = solve3(a, b, c, r)   for the columns a, b, c
    until max|δ| ≤ NEWTON_TOLERANCE max|m|.  Finally take w = m/I_body from the last m and update q as in
    quaternion_update, but multiply from the right, because w is in body coordinates:   q ← unit(q (1, ½dt w)).
    The new ℓ is then 2m − ℓ.  It has the length and the energy of the old one, because
    (2m − ℓ)² − ℓ² = 4m·(m − ℓ) = 0,  and likewise with /I.

    Raises Diverged("Newton's method did not converge at dt [s]", dt, "take a smaller step") after NEWTON_LIMIT
    corrections.
    *Source:* Hairer, Lubich, Wanner 2006, “Geometric numerical integration”, IV.2; Cayley 1846 for the update.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 5.16: midpoint_free_rotation")


def intermediate_axis(I_body):
    """Given.  Return the number of the axis with the middle moment; if moments are equal, the first such axis."""
    for k in range(2):
        if (I_body[(k + 1) % 3] - I_body[k]) * (I_body[k] - I_body[(k + 2) % 3]) >= 0.0:
            return k
    return 2


def splitting_free_rotation(q, L, I_body, dt):
    """Return the orientation (4,) of a free body after dt by four exact rotations; second order, bounded energy error.

    Let b be the intermediate_axis, a and c the two that follow it (b + 1, b + 2, modulo 3).  The energy is a sum,
        L²/2I_b  +  ½(1/I_a − 1/I_b) L_a²  +  ½(1/I_c − 1/I_b) L_c²
    and the motion by each term alone is known.  The first rotates the body about L, by dt/I_b L: multiply by
    exponential(dt/I_b L) from the left; it commutes with the others.  The second rotates it about its own axis a by the
    angle dt (1/I_a − 1/I_b) L_a,  with  L_a = body_component(q, L, a)  of the latest q:  about_axis(q, a, angle) is the
    new orientation.  The third does the same about the axis c.  Order of the rotations:
        half of a,  all of c,  half of a,  about L          and unit at the end
    Exact when two moments are equal.
    *Source:* Touma and Wisdom 1994; Fassò 2003, “Comparison of splitting algorithms for the rigid body”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 5.17: splitting_free_rotation")


def midpoint_step(torque, t, q, L, dt, body):
    """Given.  Half of the angular impulse, midpoint_free_rotation, the other half; second order, reversible."""
    L = L + 0.5 * dt * torque(t, q, L, body)
    q = midpoint_free_rotation(q, L, body.I_body, dt)
    return q, L + 0.5 * dt * torque(t + dt, q, L, body)


def splitting_step(torque, t, q, L, dt, body):
    """Given.  Half of the angular impulse, splitting_free_rotation, the other half; second order, reversible."""
    L = L + 0.5 * dt * torque(t, q, L, body)
    q = splitting_free_rotation(q, L, body.I_body, dt)
    return q, L + 0.5 * dt * torque(t + dt, q, L, body)


def compose(step, torque, t, q, L, dt, body):
    """Return (q, L) after five substeps of a reversible second-order step, the third one backwards; fourth order.

    γ dt, γ dt, (1 − 4γ) dt, γ dt, γ dt          γ = SUZUKI = 1/(4 − ∛4)

    Each begins at the time where the previous one ended.  The composition conserves all that the step conserves.
    *Source:* Suzuki 1990; Hairer, Lubich, Wanner 2006, II.4.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 5.18: compose")


# ---------------------------------------------------------------------------------------------- why?

def precession_rate(I_body, mgl, tilt, spin):
    """Return the rate Ω [rad/s] at which the axis of a Top goes steadily round the vertical, at a constant tilt [rad].

    *Find* it before you run anything.  The moments I_body (3,) [kg m²] about the pivot are I₁ = I₂ and I₃; mgl is the
    weight times the distance of the centre of mass from the pivot [N m]; spin is the component of ω along the axis.
    The tip is released with just the push that it needs, so there is no nutation.  Which Ω turns L as the torque does?

    There are two such rates; return the one nearer to 0.  It exists for the inputs of the test.  The spin may have
    either sign, and Ω follows it.  The axis may be level (tilt = π/2, where the other rate is infinite), and the top
    may hang (tilt > π/2).
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 5.19: precession_rate")


def careful_throw_is():
    """Return the letter of the law of a careful throw in the figure of the notebook: "A", "B", "C" or "D".

    A brick spins about its middle axis at 3 rad/s.  The thrower's hand disturbs it by 10⁻ⁿ of its spin.  The curves
    are four ideas of the time until it turns over, over n.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 5.20: careful_throw_is")


def my_thrown_body(period):
    """Return a body of your own and its spin: m (n,) [kg], x (n, 3) [m], size (n, 3) [m] and ω (3,) [rad/s].

    *Make it*: of n boxes with masses m, centres x and edges `size` along the axes x, y and z, and with ω in the same
    axes.  Nothing acts on it.  Many bodies are right.  The judge demands:

    - There are at least two boxes, and all masses and edges are above 0.
    - No two of the three principal moments are equal to 5 %.
    - L starts within 18° of the axis of the middle moment, but not closer than 0.25° to it.
    - The body turns over again and again: the time between two flips is `period` [s] to 2 %.  At a flip, L passes
      through the plane across the middle axis, so from a flip to the next the body turns over once.
    - |ω| period is below 300 rad.

    A body with twice the ω has the same flips in half the time.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 5.21: my_thrown_body")
