"""Records of the lesson on simulators: what does not change while bodies move, and a ball on a floor that moves."""

from typing import NamedTuple

import numpy as np

from ..checks import (
    BadInput,
    Diverged,
    check_field,
    check_finite,
    check_friction,
    check_normal,
    check_positive,
    check_shape,
    check_unit,
    finite_array,
    finite_number,
    number,
    positive_number,
    whole_number,
)
from ..friction import cone_radius
from ..rotation import point_velocity
from ..support.broad_phase import pairs_with
from ..support.records import check_principal_moments, check_record
from ..support.scenes import PileState, deepest_contact, movable, no_contacts, still_allowed
from ..vectors import cross, norm

HALVINGS = 50                # of a step, until the time of an impact is known to round-off [-]


class Bodies(NamedTuple):
    """What does not change: n bodies and, as further rows, p planes.  Inverse masses of 0: no impulse moves it."""
    inv_mass: np.ndarray     # (n + p,) [1/kg]
    inv_inertia: np.ndarray  # (n + p,), or (n + p, 3) about the principal axes [1/(kg m²)]
    half: np.ndarray         # (n, d) half sizes [m]; of what is round its radius d times
    planes: np.ndarray       # (p, d + 1): n · p + d = 0, bodies on the side of n
    gravity: np.ndarray      # (d,) [m/s²]
    mu: float                # friction [-]
    sweeps: int              # over all contacts, per step
    margin: float            # gap up to which a contact is found, and way from step to step in which it is known [m]


class CarriedBall(NamedTuple):
    """A ball, or any round body with three equal moments, on a horizontal floor that moves in its own plane."""
    m: float                 # mass [kg]
    I_body: np.ndarray       # (3,) moments of inertia [kg m²]
    radius: float            # [m]
    mu: float                # friction [-]
    gravity: np.ndarray      # (3,) [m/s²]
    centre: np.ndarray       # (3,) a point of the floor [m]
    floor_v: np.ndarray      # (3,) its velocity [m/s]
    floor_omega: np.ndarray  # (3,) angular velocity of the floor [rad/s]


class RockingBlock(NamedTuple):
    """A block that rocks from one lower corner to the other and does not slide."""
    m: float                 # mass [kg]
    half_width: float        # [m]
    half_height: float       # [m]
    inertia: float           # moment of inertia about its centre [kg m²]
    g: float                 # gravity [m/s²]


class Toppled(Diverged):
    """A rocking block lies on its side: says by which angle it leans."""

    def __init__(self, lean):
        super().__init__("lean of a rocking block [rad]", f"{lean:.4g}",
                         "it has fallen on its side: start with less lean or speed, or end the run earlier")


class Sunk(Diverged):
    """Two bodies sink into each other: says which, when, how deep, and with how many sweeps per step."""

    def __init__(self, a, b, bodies, t, overlap, sweeps):
        other = f"plane {b - bodies}" if b >= bodies else f"body {b}"
        super().__init__(f"overlap [m] of body {a} and {other} at t = {t:.4g} s, with {sweeps} sweeps per step",
                         f"{overlap:.3g}", "take more sweeps, shorter steps, or more equal masses")


class TooFast(Diverged):
    """Two bodies, or a body and a plane, pass each other within a step: says when, how fast, and which step would do.
    """

    def __init__(self, a, b, bodies, t, dt, speed, enough):
        other = f"plane {b - bodies}" if b >= bodies else f"body {b}"
        super().__init__(f"body {a} and {other} pass each other within the step of {dt:.3g} s from t = {t:.4g} s; "
                         f"speed of one as the other sees it [m/s]", f"{speed:.4g}",
                         f"take steps of at most {enough:.2g} s")


def inverse_or_zero(thing, values, count, planes):
    """Return 1/values, one each, and 0 for each plane; 0 where a value is infinite.  Raises BadInput for the others."""
    values = np.asarray(values, np.float64)
    if values.size != 1:
        check_shape(thing, values, (count,))
    inverse = np.zeros(count + planes)
    for i in range(count):
        value = values.ravel()[i if values.size != 1 else 0]
        if not value > 0.0:
            raise BadInput(thing, value, "give a number above zero; infinity for what no impulse moves")
        inverse[i] = 1.0 / value
    return inverse


def check_bodies(x, half, planes, d):
    """Raise BadInput unless these arrays describe bodies and planes in d dimensions; there may be no plane."""
    check_field("the centres x [m]", x, (len(x), d))
    check_field("the half sizes [m]", half, (len(x), d))
    check_shape("the planes", planes, (len(planes) if planes.ndim == 2 else 1, d + 1))
    for size in half.ravel():
        check_positive("half size of a body [m]", size)
    for p in range(len(planes)):
        check_normal(planes[p, :d])


def settings_of(mu, sweeps, margin):
    """Return the last three fields of Bodies, checked."""
    mu = number("friction μ [-]", mu)
    check_friction(mu)
    return mu, whole_number("number of sweeps", sweeps, 1), positive_number("margin [m]", margin)


def make_bodies_2d(x, q, m, inertia, half, planes, gravity, mu, sweeps, margin):
    """Return (PileState, Bodies) of discs or boxes at rest in the plane: x (n, 2), angles q (n,), planes (p, 3).

    m [kg] and inertia [kg m²] are numbers or one each, infinite for what no impulse moves or turns; half (n, 2) half
    sizes [m], of a disc its radius twice; planes may be an empty list.
    Raises BadInput for sizes, masses or settings that are not above zero, and planes without a unit normal.
    """
    x, half = finite_array("a centre x [m]", x), finite_array("a half size [m]", half)
    planes = finite_array("a plane", planes)
    q, gravity = finite_array("an angle q [rad]", q), finite_array("gravity [m/s²]", gravity)
    planes = planes if planes.size > 0 else np.zeros((0, 3))         # an empty list has no rows to count
    check_bodies(x, half, planes, 2)
    n, p = len(x), len(planes)
    check_field("the angles q [rad]", q, (n,))
    check_field("gravity [m/s²]", gravity, (2,))
    mu, sweeps, margin = settings_of(mu, sweeps, margin)
    state = PileState(np.concatenate((x, np.zeros((p, 2)))), np.concatenate((q, np.zeros(p))), np.zeros((n + p, 2)),
                      np.zeros(n + p), no_contacts(n, 2), np.zeros((0, 2)))
    bodies = Bodies(inverse_or_zero("mass [kg]", m, n, p), inverse_or_zero("moment of inertia [kg m²]", inertia, n, p),
                    half, planes, gravity, mu, sweeps, margin)
    check_record(bodies, state)
    return state, bodies


def make_bodies(x, q, m, inertia, half, planes, gravity, mu, sweeps, margin):
    """Return (PileState, Bodies) of spheres or boxes at rest in space: x (n, 3), q (n, 4), planes (p, 4).

    q are unit quaternions, inertia (n, 3): principal moments [kg m²], of a body all finite or all infinite; the rest is
    as in make_bodies_2d.
    """
    x, half = finite_array("a centre x [m]", x), finite_array("a half size [m]", half)
    planes = finite_array("a plane", planes)
    q, gravity = finite_array("a quaternion q [-]", q), finite_array("gravity [m/s²]", gravity)
    inertia = np.asarray(inertia, np.float64)
    planes = planes if planes.size > 0 else np.zeros((0, 4))         # an empty list has no rows to count
    check_bodies(x, half, planes, 3)
    n, p = len(x), len(planes)
    check_field("the quaternions q [-]", q, (n, 4))
    check_field("gravity [m/s²]", gravity, (3,))
    check_shape("the moments of inertia [kg m²]", inertia, (n, 3))
    for i in range(n):
        check_normal(q[i])
        check_principal_moments(inertia[i])
    mu, sweeps, margin = settings_of(mu, sweeps, margin)
    state = PileState(np.concatenate((x, np.zeros((p, 3)))),
                      np.concatenate((q, np.tile(np.array([1.0, 0.0, 0.0, 0.0]), p).reshape(p, 4))),
                      np.zeros((n + p, 3)), np.zeros((n + p, 3)), no_contacts(n, 3), np.zeros((0, 3)))
    turned = inverse_or_zero("moment of inertia [kg m²]", inertia.ravel(), 3 * n, 3 * p).reshape(-1, 3)
    bodies = Bodies(inverse_or_zero("mass [kg]", m, n, p), turned, half, planes, gravity, mu, sweeps, margin)
    check_record(bodies, state)
    return state, bodies


def movable_pairs(pairs, p):
    """Return the Pairs of which an impulse moves or turns at least one body."""
    return pairs_with(movable(p), pairs)


def checked_bodies(t, x, q, v, omega, dt, steps, p):
    """Return (t, x, q, v, omega, dt, steps), converted to float64.

    Raises BadInput for a step or a number of steps that is none, arrays that do not fit the bodies, what is not finite,
    and quaternions that are not of length 1.  check_record has checked p.
    """
    x, q = finite_array("position x [m]", x), finite_array("orientation q", q)
    v, omega = finite_array("velocity v [m/s]", v), finite_array("angular velocity ω [rad/s]", omega)
    rows, d = p.inv_mass.size, p.half.shape[1]
    check_shape("position x [m]", x, (rows, d))
    check_shape("velocity v [m/s]", v, (rows, d))
    check_finite("planes", p.planes)
    check_friction(p.mu)
    if q.ndim == 2:
        check_shape("orientation q", q, (rows, 4))
        check_shape("angular velocity ω [rad/s]", omega, (rows, 3))
        for i in range(rows):
            check_unit("length of a quaternion q [-]", np.sqrt(np.sum(q[i] ** 2)))
    else:
        check_shape("orientation q", q, (rows,))
        check_shape("angular velocity ω [rad/s]", omega, (rows,))
    return (finite_number("time t [s]", t), x, q, v, omega, positive_number("step dt [s]", dt),
            whole_number("number of steps", steps, 0))


def check_sinking(state, t, dt, p, allowed):
    """Return what overlap is allowed from now on, as check_overlap of lesson 9 does.

    Raises Sunk where bodies sink into each other all the same, and Diverged where a velocity is no number.
    """
    k, share, deep = deepest_contact(state.contacts, state.v, dt, p.half)
    if share > allowed:
        raise Sunk(state.contacts.a[k], state.contacts.b[k], p.half.shape[0], t, -state.contacts.gap[k], p.sweeps)
    return still_allowed(allowed, deep)


def check_speed(v, omega, dt):
    """Raise Diverged unless all velocities are numbers."""
    fastest = np.max(np.abs(v)) + np.max(np.abs(omega))
    if not np.isfinite(fastest):
        raise Diverged("the largest velocity of a body at the step [s]", dt, "take a smaller step, or more sweeps")


def rocking_acceleration(t, x, v, block):
    """Return θ̈ (1,) [rad/s²] of a RockingBlock that leans to the left by θ = x[0], on its left lower corner.

    (I + m R²) θ̈ = −m g R sin(α − θ),      tan α = half_width/half_height,   R² = half_width² + half_height²
    """
    R = np.sqrt(block.half_width**2 + block.half_height**2)
    alpha = np.arctan2(block.half_width, block.half_height)
    rate = block.m * block.g * R / (block.inertia + block.m * R * R)
    return np.array([-rate * np.sin(alpha - x[0])])


def stop_slip(v, omega, floor, dt, ball):
    """Given.  Return (v, omega) after friction has acted for dt against a floor with the velocity `floor` (3,).

    As rolling_step of lesson 5:  J = −min(μN dt, |u|/K) u/|u|,  u = v + ω × r + dt g_t − floor,  K = 1/m + radius²/I.
    A floor pushes and never pulls: N = max(0, −m g_z).  Raises BadInput for μ < 0.
    """
    r = np.array([0.0, 0.0, -ball.radius])
    slip = point_velocity(v, omega, r) + dt * ball.gravity - floor
    slip[2] = 0.0
    size, K = norm(slip), 1.0 / ball.m + ball.radius * ball.radius / ball.I_body[0]
    if size == 0.0:
        return v, omega
    limit = cone_radius(ball.mu, max(0.0, -ball.m * ball.gravity[2]) * dt)
    J = -np.minimum(limit, size / K) / size * slip
    return v + J / ball.m, omega + cross(r, J) / ball.I_body[0]


def time_of_landing(step, t, x, v, dt, block):
    """Return the time [s] within dt at which a RockingBlock with the lean x > 0 comes upright, by bisection."""
    early, late = 0.0, dt
    for _ in range(HALVINGS):
        middle = 0.5 * (early + late)
        if step(rocking_acceleration, t, x, v, middle, block)[0][0] > 0.0:
            early = middle
        else:
            late = middle
    return late
