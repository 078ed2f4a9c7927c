"""Scenes with many contacts: their records, and functions that build and check them."""

from typing import NamedTuple

import numpy as np

from ..checks import (
    BadInput,
    Diverged,
    check_field,
    check_finite,
    check_friction,
    check_indices,
    check_normal,
    check_not_negative,
    check_positive,
    check_shape,
    check_unit,
    finite_array,
    number,
    positive_number,
    whole_number,
)
from .contact_points import ContactSet
from .records import check_record

HIGHEST = 0.3                # hertz times a substep [-]: discs, balls and towers of squares come to rest there; towers
                             # of flat boxes need 0.26, towers of cubes in space 0.24, and slim ones even less
INDEPENDENT = 1e-12          # least pivot of A over its diagonal [-]: below it a contact repeats what others say
TOO_DEEP = 0.5               # overlap over the smaller half size that ends a run, if it was not there before [-]
DEEPER = 1.05                # by which what overlapped at the beginning may go deeper [-]


class PileState(NamedTuple):
    """n bodies and, as further rows that never move, p planes."""
    x: np.ndarray            # (n + p, d) [m]
    q: np.ndarray            # (n + p,) angle [rad], or (n + p, 4) unit quaternion
    v: np.ndarray            # (n + p, d) [m/s]
    omega: np.ndarray        # (n + p,) or (n + p, 3) [rad/s]
    contacts: ContactSet     # of the last step
    J: np.ndarray            # (m, d) their impulses in one substep [N s]


class Pile(NamedTuple):
    """What does not change: bodies, planes and the settings of the solver."""
    inv_mass: np.ndarray     # (n + p,) [1/kg]; 0 for planes
    inv_inertia: np.ndarray  # (n + p,), or (n + p, 3) about the principal axes [1/(kg m²)]; 0 for planes
    half: np.ndarray         # (n, d) half sizes [m]; of what is round its radius d times
    planes: np.ndarray       # (p, d + 1): n · p + d = 0, bodies on the side of n
    gravity: np.ndarray      # (d,) [m/s²]
    mu: float                # friction [-]
    substeps: int            # per step
    hertz: float             # frequency of the soft contacts [1/s]
    zeta: float              # their damping ratio [-]
    margin: float            # by which boxes are widened, so that pairs serve for many steps [m]


# ---------------------------------------------------------------------------------------------- small scenes

def make_contacts(a, b, p, n, inv_mass):
    """A ContactSet in the plane, all gaps 0: bodies a[k] and b[k] touch at p (m, 2) with unit normals n (m, 2), from
    b to a.

    Raises BadInput for a body number that is none, a normal that is no unit vector, and for two bodies that cannot
    move.
    """
    inv_mass = finite_array("an inverse mass [1/kg]", inv_mass)
    check_shape("the inverse masses", inv_mass, (inv_mass.size,))
    a = check_indices("a body of a contact", a, inv_mass.size)
    b = check_indices("a body of a contact", b, inv_mass.size)
    p, n = finite_array("a contact point [m]", p), finite_array("a normal [-]", n)
    check_shape("the bodies a", a, (a.size,))
    contacts = ContactSet(np.zeros(1, np.int64), a, b, n, p, np.zeros(a.size))
    check_contacts(contacts, inv_mass)
    return contacts


def inverse_masses(inv_mass, inv_inertia):
    """M⁻¹ (3n,): 1/m, 1/m, 1/I of every body, from inv_mass (n,) and inv_inertia (n,)."""
    w = np.zeros(3 * inv_mass.size)
    for i in range(inv_mass.size):
        w[3 * i], w[3 * i + 1], w[3 * i + 2] = inv_mass[i], inv_mass[i], inv_inertia[i]
    return w


def check_scene(x, inv_mass, inv_inertia, contacts, load, mu):
    """Raise BadInput unless these are what contact_forces can be asked about."""
    check_field("the centres x [m]", x, (len(x), 2))
    check_field("the inverse masses [1/kg]", inv_mass, (len(x),))
    check_field("the inverse inertias [1/(kg m²)]", inv_inertia, (len(x),))
    check_field("the load [N, N, N m]", load, (len(x), 3))
    check_shape("the friction μ", mu, contacts.a.shape)
    for k in range(mu.size):
        check_friction(mu[k])
    for i in range(len(x)):
        check_not_negative("an inverse mass [1/kg]", inv_mass[i])
        check_not_negative("an inverse inertia [1/(kg m²)]", inv_inertia[i])
    check_contacts(contacts, inv_mass)


def check_contacts(contacts, inv_mass):
    """Raise BadInput unless a ContactSet joins two of these bodies at each contact, of which one can be moved."""
    check_field("the contact points p [m]", contacts.p, (contacts.a.size, 2))
    check_field("the normals n [-]", contacts.n, (contacts.a.size, 2))
    check_field("the gaps of the contacts [m]", contacts.gap, (contacts.a.size,))
    check_shape("the bodies b of the contacts", contacts.b, contacts.a.shape)
    check_indices("a body a of a contact", contacts.a, inv_mass.size)
    check_indices("a body b of a contact", contacts.b, inv_mass.size)
    for k in range(contacts.a.size):
        check_normal(contacts.n[k])
        if contacts.a[k] == contacts.b[k]:
            raise BadInput("both bodies of a contact", contacts.a[k], "name two bodies")
        check_positive("inverse mass of both bodies of a contact [1/kg]",
                       inv_mass[contacts.a[k]] + inv_mass[contacts.b[k]])


def check_delassus(A, b):
    """Raise BadInput unless A (rows, rows) [1/kg] and b (rows,) [m/s] are finite and the diagonal of A is positive.

    The diagonal is 0 where neither body of a contact can be moved.
    """
    check_field("the Delassus matrix A [1/kg]", A, (b.size, b.size))
    check_field("the velocities b without impulses [m/s]", b, (b.size,))
    for k in range(b.size):
        check_positive("inverse mass on the diagonal of A [1/kg]", A[k, k])


def check_friction_problem(A, b, mu):
    """Raise BadInput unless A, b and μ (rows/2,) are what solve_contacts can be asked about."""
    check_delassus(A, b)
    check_shape("the friction μ, one number for two rows of A", mu, (b.size // 2,))
    check_shape("the rows of A, two for each contact", b, (2 * mu.size,))
    for k in range(mu.size):
        check_friction(mu[k])


def check_independent(A, b):
    """Raise BadInput unless A and b are finite and A is positive definite.

    All pivots of elimination must be above INDEPENDENT times the diagonal.
    """
    check_delassus(A, b)
    U = 1.0 * A
    for k in range(A.shape[0]):
        if not U[k, k] > INDEPENDENT * A[k, k]:
            raise BadInput("a pivot of the Delassus matrix [1/kg]", U[k, k],
                           "leave out contacts that others make redundant")
        for r in range(k + 1, A.shape[0]):
            U[r] = U[r] - U[r, k] / U[k, k] * U[k]


# ---------------------------------------------------------------------------------------------- piles

def check_pile(x, half, planes, d):
    """Raise BadInput unless these arrays describe bodies and planes in d dimensions."""
    check_field("the centres x [m]", x, (len(x), d))
    check_field("the half sizes [m]", half, (len(x), d))
    check_field("the planes", planes, (len(planes) if planes.ndim == 2 else 1, d + 1))
    for size in half.ravel():
        check_positive("half size of a body [m]", size)
    for p in range(len(planes)):
        check_normal(planes[p, :d])


def inverse(thing, values, count, planes):
    """1/values, one each, and 0 for each plane.  Raises BadInput unless all are above zero."""
    values = finite_array(thing, values)
    if values.size != 1:
        check_shape(thing, values, (count,))
    values = np.zeros(count) + values.ravel()
    for value in values:
        check_positive(thing, value)
    return np.concatenate((1.0 / values, np.zeros(planes)))


def no_contacts(n, d):
    """The ContactSet of n bodies before their first step."""
    none = np.zeros(0, np.int64)
    return ContactSet(np.zeros(n + 1, np.int64), none, none, np.zeros((0, d)), np.zeros((0, d)), np.zeros(0))


def settings(mu, substeps, hertz, zeta, margin):
    """The last five fields of a Pile, checked."""
    mu = number("friction μ [-]", mu)
    check_friction(mu)
    return (mu, whole_number("number of substeps", substeps, 1), positive_number("hertz of the contacts [1/s]", hertz),
            positive_number("damping ratio ζ of the contacts [-]", zeta), positive_number("margin [m]", margin))


def make_pile_2d(x, q, m, inertia, half, planes, gravity, mu, substeps, hertz, zeta, margin):
    """(PileState, Pile) of discs or boxes at rest in the plane, centres x (n, 2), angles q (n,), and lines planes
    (p, 3).

    m [kg] and inertia [kg m²] are numbers or one each; half (n, 2) half sizes [m], of a disc its radius twice.
    Raises BadInput for sizes, masses or settings that are not above zero, and planes without a unit normal.
    """
    x, half = finite_array("a centre x [m]", x), finite_array("a half size [m]", half)
    planes = finite_array("a plane", planes)
    q, gravity = finite_array("an angle q [rad]", q), finite_array("gravity [m/s²]", gravity)
    check_pile(x, half, planes, 2)
    n, p = len(x), len(planes)
    check_field("the angles q [rad]", q, (n,))
    check_field("gravity [m/s²]", gravity, (2,))
    mu, substeps, hertz, zeta, margin = settings(mu, substeps, hertz, zeta, margin)
    state = PileState(np.concatenate((x, np.zeros((p, 2)))), np.concatenate((q, np.zeros(p))), np.zeros((n + p, 2)),
                      np.zeros(n + p), no_contacts(n, 2), np.zeros((0, 2)))
    pile = Pile(inverse("mass [kg]", m, n, p), inverse("moment of inertia [kg m²]", inertia, n, p), half, planes,
                gravity, mu, substeps, hertz, zeta, margin)
    check_record(pile, state)
    return state, pile


def make_pile(x, q, m, inertia, half, planes, gravity, mu, substeps, hertz, zeta, margin):
    """(PileState, Pile) of spheres or boxes at rest in space, as in make_pile_2d: x (n, 3), unit quaternions q (n,
    4), planes (p, 4).

    inertia (n, 3): principal moments [kg m²].
    """
    x, half = finite_array("a centre x [m]", x), finite_array("a half size [m]", half)
    planes = finite_array("a plane", planes)
    q, gravity = finite_array("a quaternion q [-]", q), finite_array("gravity [m/s²]", gravity)
    inertia = finite_array("a moment of inertia [kg m²]", inertia)
    check_pile(x, half, planes, 3)
    n, p = len(x), len(planes)
    check_field("the quaternions q [-]", q, (n, 4))
    check_field("gravity [m/s²]", gravity, (3,))
    check_field("the moments of inertia [kg m²]", inertia, (n, 3))
    for i in range(n):
        check_normal(q[i])
    mu, substeps, hertz, zeta, margin = settings(mu, substeps, hertz, zeta, margin)
    inv_inertia = inverse("moment of inertia [kg m²]", inertia.ravel(), 3 * n, 3 * p).reshape(-1, 3)
    state = PileState(np.concatenate((x, np.zeros((p, 3)))),
                      np.concatenate((q, np.tile(np.array([1.0, 0.0, 0.0, 0.0]), p).reshape(p, 4))),
                      np.zeros((n + p, 3)), np.zeros((n + p, 3)), no_contacts(n, 3), np.zeros((0, 3)))
    pile = Pile(inverse("mass [kg]", m, n, p), inv_inertia, half, planes, gravity, mu, substeps, hertz, zeta, margin)
    check_record(pile, state)
    return state, pile


def checked_pile(state, dt, steps, pile):
    """(PileState, dt, steps), converted to float64.

    Raises BadInput for a step or a number of steps or substeps that is none, hertz that a substep does not carry, what
    is not finite, and quaternions that are not of length 1.
    """
    dt, steps = positive_number("step dt [s]", dt), whole_number("number of steps", steps, 0)
    substeps = whole_number("number of substeps", pile.substeps, 1)
    check_positive("a substep [s]", dt / substeps)
    check_positive("hertz of the contacts [1/s]", pile.hertz)
    check_positive("damping ratio ζ of the contacts [-]", pile.zeta)
    product = pile.hertz * dt / substeps
    if not product <= HIGHEST * (1.0 + 1e-9):
        raise BadInput("hertz of the contacts times a substep [-]", product,
                       "give at most 0.3, and less for high towers: take more substeps, or fewer hertz")
    check_friction(pile.mu)
    check_finite("planes", pile.planes)
    x, q = finite_array("position x [m]", state.x), finite_array("orientation q", state.q)
    v, omega = finite_array("velocity v [m/s]", state.v), finite_array("angular velocity ω [rad/s]", state.omega)
    for thing, values in (("position x [m]", x), ("velocity v [m/s]", v)):
        check_shape(thing, values, (len(pile.inv_mass), pile.half.shape[1]))
    if q.ndim == 2:
        check_shape("orientation q", q, (len(x), 4))
        for i in range(q.shape[0]):
            check_unit("length of a quaternion q [-]", np.sqrt(np.sum(q[i] ** 2)))
    return PileState(x, q, v, omega, state.contacts, finite_array("impulse J [N s]", state.J)), dt, steps


def movable(pile):
    """Whether an impulse moves or turns each body or plane, (n + p,)."""
    can = pile.inv_mass > 0.0
    turns = pile.inv_inertia.reshape(can.size, -1)
    for i in range(can.size):
        for c in range(turns.shape[1]):
            can[i] = can[i] or turns[i, c] > 0.0
    return can


def smallest_halves(half):
    """The smallest half size (n,) [m] of each body."""
    smallest = np.empty(half.shape[0])
    for i in range(smallest.size):
        smallest[i] = half[i, 0]
        for c in range(1, half.shape[1]):
            smallest[i] = min(smallest[i], half[i, c])
    return smallest


def smaller_half(contacts, k, least):
    """The smallest half size [m] of both bodies of contact k, from smallest_halves `least`; planes have none."""
    a, b = contacts.a[k], contacts.b[k]
    return min(least[a], least[b]) if b < least.size else least[a]


def deepest_contact(contacts, v, dt, half):
    """(k, share, deep): the contact that has sunk in most, by how much, and the deepest overlap of all.

    Both are over the smaller half size of two bodies; (-1, 0, 0) if none overlap.  What moves fast may go as far in
    during a step as the bodies move in it: that part does not count for `share`.  Raises Diverged where a velocity is
    no number.
    """
    deepest, share, deep, fastest, least = -1, 0.0, 0.0, np.max(np.abs(v)), smallest_halves(half)
    smallest = np.min(least)
    if not np.isfinite(fastest):
        raise Diverged("the largest velocity of a body [m/s]", fastest, "take shorter steps, substeps or more sweeps")
    for k in range(contacts.a.size):
        overlap = -contacts.gap[k]
        if overlap > deep * smallest:                                    # otherwise it is not the deepest
            size = smaller_half(contacts, k, least)
            this, deep = (overlap - 2.0 * dt * fastest) / size, max(deep, overlap / size)
            if this > share:
                deepest, share = k, this
    return deepest, share, deep


def overlap_before(state, dt, half):
    """The overlap, over the smaller half size of both bodies, that is allowed at the beginning of a run.

    A first run, whose state has no contacts, may begin with any overlap, and the result is ∞.  A run that goes on from
    another one may go as deep as TOO_DEEP, or a little deeper than its contacts if these are deeper than that.
    """
    if state.contacts.a.size == 0:
        return np.inf
    _, share, deep = deepest_contact(state.contacts, state.v, dt, half)
    return DEEPER * deep if share > TOO_DEEP else TOO_DEEP


def still_allowed(allowed, deep):
    """The share of a half size that may overlap from now on: TOO_DEEP, or a little more than what overlaps now if that
    is deeper.  It never grows.
    """
    return min(allowed, max(TOO_DEEP, DEEPER * deep))


def check_overlap(contacts, v, dt, half, allowed, residual):
    """The overlap, over the smaller half size of both bodies, that is allowed from now on.

    Raises Diverged with the residual [m/s] of the contacts where bodies sink into each other all the same.
    """
    _, share, deep = deepest_contact(contacts, v, dt, half)
    if share > allowed:
        raise Diverged("bodies sink into each other; the residual of their contacts [m/s]", residual,
                       "take more substeps, shorter steps, or more equal masses")
    return still_allowed(allowed, deep)
