"""Joints, driven bodies, the judges of a run in the plane, and steps that only some scenes take.

Each truth comes from vectors and matrices, from conserved quantities, or from the reversal of time.
"""

from itertools import combinations, product
from types import SimpleNamespace

import numpy as np
from scipy.optimize import lsq_linear, minimize_scalar
from scipy.spatial.transform import Rotation

from solutions.checks import Diverged
from solutions.given import dividing, passing
from solutions.given import joints as joints_of
from solutions.given import rows as rows_of_bodies
from solutions.given import simulator as swinging
from solutions.given.bodies import TooFast
from solutions.support import convex_3d, model, shapes
from solutions.support.broad_phase import Pairs
from solutions.support.events import extrema, value_at, zeros
from solutions.support.quaternions import quaternion_from_matrix
from solutions.support.small_systems import shortest_solution
from validate.reference.turns import free_splitting, matrix
from validate.stability.case import case, matrix_of, random_law, random_quaternions, turned_by, unlike

ROUND_OFF = 1e-14            # change of an impulse, over the largest one, at which sweeps have settled
EXACT = 1e-9                 # of numbers around 1: the same by another sum
CLOSED = 1e-11               # of gaps of joints [m], which close_joints leaves at some roundings
UPRIGHT = (1.0, 0.0, 0.0, 0.0)


def in_space(r):
    """Return vectors (…, 3) of vectors (…, 2) in the plane; those in space stay as they are."""
    r = np.asarray(r, float)
    return r if r.shape[-1] == 3 else np.concatenate((r, np.zeros((*r.shape[:-1], 1))), axis=-1)


def about_normal(spins):
    """Return vectors (n, 3) of numbers (n,) about the normal of the plane; vectors in space stay as they are."""
    spins = np.asarray(spins, float)
    return spins if spins.ndim == 2 else np.outer(spins, (0.0, 0.0, 1.0))


def rotations(q):
    """Return matrices (n, 3, 3) of quaternions (n, 4), or of angles (n,) about the normal of the plane."""
    q = np.asarray(q, float)
    zero = np.zeros(len(q))
    q = q if q.ndim == 2 else np.stack((np.cos(0.5 * q), zero, zero, np.sin(0.5 * q)), axis=1)
    return np.array([matrix_of(one) for one in q])


def random_bodies(lesson, rng, d, n, heavy=()):
    """Return (PileState, Bodies) of n bodies that move and turn, without gravity; those in `heavy` nothing moves."""
    m, q = rng.uniform(0.5, 2.0, n), rng.normal(size=n) if d == 2 else random_quaternions(rng, n)
    inertia = rng.uniform(0.2, 0.5, n) if d == 2 else rng.uniform(1.0, 1.9, (n, 3))
    m[list(heavy)], inertia[list(heavy)] = np.inf, np.inf
    make = lesson.make_bodies_2d if d == 2 else lesson.make_bodies
    state, p = make(rng.normal(size=(n, d)), q, m, inertia, np.full((n, d), 0.1), [], np.zeros(d), 0.3, 1, 0.01)
    return state._replace(v=rng.normal(size=(n, d)), omega=rng.normal(size=n if d == 2 else (n, 3))), p


def masses(inverse):
    """Return 1/inverse, and 0 where that is infinite: such a row does not count."""
    return np.divide(1.0, inverse, out=np.zeros_like(inverse), where=inverse > 0.0)


def tensors(q, p):
    """Return I (n, 3, 3) in the world of all bodies, in the plane about its normal; 0 where nothing turns one."""
    moments = masses(p.inv_inertia)
    moments = moments if moments.ndim == 2 else about_normal(moments)
    return np.array([R @ np.diag(I) @ R.T for R, I in zip(rotations(q), moments, strict=True)])


def momenta_of(x, q, v, omega, p):
    """Return (P (3,), L (3,)) of all bodies that can move, by cross products and tensors in space."""
    m, x, v, omega = masses(p.inv_mass), in_space(x), in_space(v), about_normal(omega)
    return m @ v, m @ np.cross(x, v) + np.einsum("nij,nj->i", tensors(q, p), omega)


# ---------------------------------------------------------------------------------------------- judges in the plane

def partly_fixed(lesson, rng):
    """Return (PileState, Bodies) of five bodies in the plane: free, fixed, on an axle, and without rotation."""
    state, p = random_bodies(lesson, rng, 2, 5, heavy=(1,))
    p.inv_mass[2], p.inv_inertia[3] = 0.0, 0.0
    return state, p._replace(gravity=rng.normal(size=2))


@random_law("In the plane energy and momenta are those of vectors in space, without what cannot move or turn.",
            "plane: largest error of energy and momenta [J, kg m/s, kg m²/s]", EXACT)
def judges_in_the_plane(lesson, rng):
    state, p = partly_fixed(lesson, rng)
    P, L = momenta_of(*state[:4], p)
    energy = 0.0
    for i in np.flatnonzero(p.inv_mass):
        energy += (0.5 * state.v[i] @ state.v[i] - p.gravity @ state.x[i]) / p.inv_mass[i]
    for i in np.flatnonzero(p.inv_inertia):
        energy += 0.5 * state.omega[i] ** 2 / p.inv_inertia[i]
    return ((*lesson.momenta_2d(*state[:4], p), lesson.mechanical_energy_2d(*state[:4], p)),
            (P[:2], L[2], energy))


def random_contacts(lesson, rng, n, m):
    """Return a ContactSet of m contacts of n bodies in the plane, ordered by body a."""
    a = np.sort(rng.integers(0, n - 1, m))
    b, normals = np.array([rng.integers(i + 1, n) for i in a]), rng.normal(size=(m, 2))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    return lesson.ContactSet(np.searchsorted(a, np.arange(n + 1)), a, b, normals, rng.normal(size=(m, 2)),
                             rng.choice((-1.0, 0.0, 1.0), m) * rng.uniform(0.01, 0.1, m))


@random_law("Rows that move and turn do work: the impulse on the other body times the velocity of the row there.",
            "driven rows: largest error of their work [J]", EXACT)
def work_of_driven_rows(lesson, rng):
    state, p = random_bodies(lesson, rng, 2, 4, heavy=(1, 3))
    dt, contacts, J = rng.uniform(0.01, 0.1), random_contacts(lesson, rng, 4, 6), rng.normal(size=(6, 2))
    begin, work = state.x - dt * state.v, 0.0
    for a, b, place, impulse in zip(contacts.a, contacts.b, contacts.p, J, strict=True):
        for row, force in ((a, -impulse), (b, impulse)):                     # on the other body of the contact
            if row in (1, 3):
                u = in_space(state.v[row]) + np.cross((0.0, 0.0, state.omega[row]), in_space(place - begin[row]))
                work += force @ u[:2]
    return lesson.work_of_driven_rows(state._replace(contacts=contacts, J=J), dt, p), work


@random_law("A contact that has closed leaves with −e u_n; an open one may close, or waits for its bounce.",
            "plane: largest error of the speeds of parting [m/s]", EXACT)
def parting_speeds(lesson, rng):
    state, p = random_bodies(lesson, rng, 2, 4)
    contacts, dt, e = random_contacts(lesson, rng, 4, 6), rng.uniform(0.01, 0.1), rng.choice((0.0, 0.4, 1.0))
    at = lambda k, body: in_space(state.v[body]) + np.cross((0.0, 0.0, state.omega[body]),
                                                            in_space(contacts.p[k] - state.x[body]))
    u_n = [(at(k, a) - at(k, b))[:2] @ n for k, (a, b, n) in enumerate(zip(*contacts[1:4], strict=True))]
    truth = np.where(contacts.gap <= 0.0, -e * np.array(u_n), -contacts.gap / dt if e == 0.0 else -np.inf)
    arms = lesson.arms_2d(state.x, p.inv_mass, p.inv_inertia, contacts)
    return lesson.parting_speeds(state.v, state.omega, contacts, arms, dt, e), truth


@random_law("Bodies that share a joint have no contact; all others keep theirs.",
            "contacts without those of joined bodies: largest error [-]", EXACT)
def without_joined(lesson, rng):
    state, p = random_bodies(lesson, rng, 2, 6)
    contacts, pairs = random_contacts(lesson, rng, 6, 12), [(0, 1), (4, 2), (3, 5)]
    jointed = lesson.make_joints(state, p, *zip(*pairs, strict=True), rng.normal(size=(3, 2)), 0.0)
    left = [k for k in range(12) if not {(contacts.a[k], contacts.b[k]), (contacts.b[k], contacts.a[k])} & {*pairs}]
    kept = lesson.without_joined(contacts, jointed.joints)
    return kept, (np.searchsorted(contacts.a[left], np.arange(7)), *(part[left] for part in contacts[1:]))


@random_law("Joints form a loop where their rows depend on each other; two joints act on each other where they share a "
            "body that can move.", "joints: wrong answers about loops, and largest error of the band [-]", 0.0)
def loops_and_bands(lesson, rng):
    """Join seven bodies as a tree, three of which nothing moves, and in half of the cases two of them once more.

    A joint is a row of 1 and −1 at its bodies, and 0 at what nothing moves.
    """
    inv_mass, still = np.ones(7), rng.permutation(7)[:3]
    inv_mass[still] = 0.0
    parts = [still, *np.flatnonzero(inv_mass)[:, None]]
    order, once_more = rng.permutation(5), rng.integers(2)
    ends = [(order[k], order[rng.integers(k)]) for k in range(1, 5)] + [rng.permutation(5)[:2]] * once_more
    a, b = rng.permutation([[rng.choice(parts[end]) for end in rng.permutation(pair)] for pair in ends]).T
    rows = (np.eye(7)[a] - np.eye(7)[b]) * inv_mass
    near = np.argwhere(rows @ rows.T != 0.0)
    return ((joints_of.form_loops(a, b, inv_mass), joints_of.farthest_neighbour(a, b, inv_mass)),
            (np.linalg.matrix_rank(rows) < len(rows), np.max(near[:, 0] - near[:, 1])))


def with_impulses(lesson, rng):
    """Return (PileState after a step, Bodies, dt, the state where its contacts were found)."""
    state, p = random_bodies(lesson, rng, 2, 5)
    state, dt = state._replace(contacts=random_contacts(lesson, rng, 5, 6), J=rng.normal(size=(6, 2))), 0.02
    return state, p, dt, state._replace(x=state.x - dt * state.v)


def speed_at(state, contacts, k):
    """Return u (2,) [m/s] of contact k, and both levers (2, 2): p − x of a and of b."""
    arms = [contacts.p[k] - state.x[i] for i in (contacts.a[k], contacts.b[k])]
    u = [state.v[i] + state.omega[i] * np.array([-r[1], r[0]])
         for i, r in zip((contacts.a[k], contacts.b[k]), arms, strict=True)]
    return u[0] - u[1], arms


def swept_by_hand(state, p, contacts, aim, mu):
    """Return (v, ω, J) after one contact after the other, each as if it were alone, with mu (m,) of each."""
    v, omega, J = state.v.copy(), state.omega.copy(), state.J.copy()
    for k, (a, b, n) in enumerate(zip(*contacts[1:4], strict=True)):
        u, arms = speed_at(state._replace(v=v, omega=omega), contacts, k)
        axes = np.array([n, (-n[1], n[0])])
        k_n, k_t = (inverse_mass_along(p, (a, b), arms, axis) for axis in axes)
        J_n, J_t = axes @ J[k]
        J_n = max(0.0, J_n + (aim[k] - u @ axes[0]) / k_n)
        J_t = np.clip(J_t - u @ axes[1] / k_t, -mu[k] * J_n, mu[k] * J_n)
        change = np.array([J_n, J_t]) @ axes - J[k]
        J[k] += change
        for i, r, sign in ((a, arms[0], 1.0), (b, arms[1], -1.0)):
            v[i] += sign * p.inv_mass[i] * change
            omega[i] += sign * p.inv_inertia[i] * (r[0] * change[1] - r[1] * change[0])
    return v, omega, J


def inverse_mass_along(p, bodies, arms, axis):
    """Return the effective inverse mass [1/kg] of two bodies at these arms along an axis."""
    return sum(p.inv_mass[i] + p.inv_inertia[i] * (r[0] * axis[1] - r[1] * axis[0]) ** 2
               for i, r in zip(bodies, arms, strict=True))


@random_law("The residual of a step is what one more sweep changes, times the inverse mass along the normal.",
            "residual of a step: largest error [m/s]", EXACT)
def residual_of_a_step(lesson, rng):
    state, p, dt, begin = with_impulses(lesson, rng)
    c = state.contacts
    _, _, J = swept_by_hand(begin, p, c, np.minimum(0.0, -c.gap / dt), np.full(6, p.mu))
    k_n = [inverse_mass_along(p, (c.a[k], c.b[k]), speed_at(begin, c, k)[1], c.n[k]) for k in range(6)]
    return lesson.sweep_residual_2d(state, dt, p), np.max(np.abs(J - state.J) * np.array(k_n)[:, None])


@random_law("Contacts of a step push a body with their impulses over dt, and on the other one with the opposite.",
            "force of contacts: largest error [N]", EXACT)
def force_of_contacts(lesson, rng):
    state, _, dt, _ = with_impulses(lesson, rng)
    body = rng.integers(5)
    signs = 1.0 * (state.contacts.a == body) - 1.0 * (state.contacts.b == body)
    N, T = lesson.normal_and_friction(state, dt)
    normal = np.sum(state.contacts.n * state.J, axis=1) / dt
    return ((lesson.contact_force(state, body, dt), N, T),
            (signs @ state.J / dt, normal, state.J / dt - normal[:, None] * state.contacts.n))


@random_law("Two bodies sink into each other by what the sweeps leave and by what turns within a step, and no more.",
            "bound of the overlap: largest error [m]", EXACT)
def bound_of_the_overlap(lesson, rng):
    """Add up dt (aim − u_n) + ½ dt² (ω_a² |r_a| + ω_b² |r_b| + 2 (|ω_a| + |ω_b|) |u_t|) for the worst pair."""
    after, sums = [with_impulses(lesson, rng) for _ in range(3)], {}
    p, dt = after[0][1], after[0][2]
    for state, _, _, begin in after:
        c, added = state.contacts, {}
        for k, pair in enumerate(zip(map(int, c.a), map(int, c.b), strict=True)):
            u, arms = speed_at(begin, c, k)
            w, long = np.abs(state.omega[list(pair)]), np.linalg.norm(arms, axis=1)
            slip = abs(c.n[k, 0] * u[1] - c.n[k, 1] * u[0])
            more = dt * max(0.0, min(0.0, -c.gap[k] / dt) - u @ c.n[k])
            added[pair] = max(added.get(pair, 0.0), more + 0.5 * dt * dt * (w**2 @ long + 2.0 * np.sum(w) * slip))
            sums.setdefault(pair, max(0.0, -c.gap[k]))
        sums = {pair: depth + added.get(pair, 0.0) for pair, depth in sums.items()}
    return lesson.overlap_bound_2d([after[0][0], *(one[0] for one in after)], dt, p), max(sums.values())


# ---------------------------------------------------------------------------------------------- joints

def random_tree(lesson, rng, d, heavy=()):
    """Return (PileState, JointedBodies) of five bodies, each joined to an earlier one, in any order of the joints."""
    state, p = random_bodies(lesson, rng, d, 5, heavy)
    later = rng.permutation(np.arange(1, 5))
    earlier = np.array([rng.integers(k) for k in later])
    swap = rng.random(4) < 0.5
    a, b = np.where(swap, later, earlier), np.where(swap, earlier, later)
    places = 0.5 * (state.x[a] + state.x[b]) + 0.1 * rng.normal(size=(4, d))
    return state, lesson.make_joints(state, p, a, b, places, 0.0)


def step_of(lesson, d):
    """Return the step of bodies with joints."""
    return lesson.joint_step_2d if d == 2 else lesson.joint_step


def loads_of(rng, d):
    """Return (load, F (5, d), τ): the load is F cos t and τ sin t."""
    F, tau = rng.normal(size=(5, d)), rng.normal(size=5 if d == 2 else (5, 3))
    return (lambda t, x, q, v, omega, p: (np.cos(t) * F, np.sin(t) * tau)), F, tau


def points_of(x, q, joints):
    """Return (the points of a, those of b), each (m, 3), of all joints."""
    return tuple(in_space(x)[body] + np.einsum("kij,kj->ki", rotations(q)[body], in_space(arm))
                 for body, arm in ((joints.a, joints.r_a), (joints.b, joints.r_b)))


def gaps_and_speeds(now, joints):
    """Return (gaps (m, 3) [m], relative velocities of the points (m, 3) [m/s]) of all joints."""
    x, q, v, omega = now
    ends = points_of(x, q, joints)
    speeds = [in_space(v)[body] + np.cross(about_normal(omega)[body], end - in_space(x)[body])
              for body, end in zip((joints.a, joints.b), ends, strict=True)]
    return ends[0] - ends[1], speeds[0] - speeds[1]


@random_law("Joints in the plane and in space are closed at the end of each step, and their points do not part.",
            "joints: largest gap and relative velocity [m, m/s]", CLOSED)
def joints_stay_closed(lesson, rng):
    """Try trees of five bodies under loads, with a body that nothing moves and that moves and turns all the same."""
    d, heavy = rng.choice((2, 3)), rng.choice((0, 1)) * (rng.integers(5),)
    state, p = random_tree(lesson, rng, d, heavy)
    now, load = state[:4], loads_of(rng, d)[0]
    for n in range(2):
        now = step_of(lesson, d)(load, 0.01 * n, *now, 0.01, p)
    return gaps_and_speeds(now, p.joints), (np.zeros((4, 3)), np.zeros((4, 3)))


@random_law("Joints change neither momentum: it changes by the loads at both ends of a step, half each.",
            "joints: largest error of the momenta [kg m/s, kg m²/s]", EXACT)
def joints_keep_momenta(lesson, rng):
    d, t, dt = rng.choice((2, 3)), rng.uniform(0.0, 1.0), 0.01
    state, p = random_tree(lesson, rng, d)
    load, F, tau = loads_of(rng, d)
    end = step_of(lesson, d)(load, t, *state[:4], dt, p)
    F, tau, (P, L) = in_space(F), about_normal(tau), momenta_of(*state[:4], p)
    for x, time in ((state.x, t), (end[0], t + dt)):
        P = P + 0.5 * dt * np.cos(time) * np.sum(F, axis=0)
        L = L + 0.5 * dt * np.sum(np.cos(time) * np.cross(in_space(x), F) + np.sin(time) * tau, axis=0)
    return momenta_of(*end, p), (P, L)


@random_law("A step with joints is undone by the step with −dt.",
            "joints: largest error after a step and its reversal [m, -, m/s, rad/s]", 1e-8)
def joints_are_reversible(lesson, rng):
    """Begin with a state that a step has left: only there the points of the joints do not part."""
    d, dt = rng.choice((2, 3)), 0.01
    state, p = random_tree(lesson, rng, d)
    load = loads_of(rng, d)[0]
    begin = step_of(lesson, d)(load, 0.2, *state[:4], dt, p)
    end = step_of(lesson, d)(load, 0.3, *begin, dt, p)
    return step_of(lesson, d)(load, 0.3 + dt, *end, -dt, p), begin


@random_law("Composed steps with joints change momenta by the integral of the load, and by nothing else.",
            "composed steps: largest error of the momenta [kg m/s, kg m²/s]", EXACT)
def composed_steps_keep_momenta(lesson, rng):
    """Give all bodies the same acceleration, and torques: about the common centre of mass only the torques count."""
    state, p = random_tree(lesson, rng, 2)
    (still, grows), twists, t, dt = rng.normal(size=(2, 2)), rng.normal(size=(2, 5)), rng.uniform(0.0, 1.0), 0.02
    m = masses(p.inv_mass)
    load = lambda t, x, q, v, omega, p: (np.outer(m, still + t * grows), twists[0] + t * twists[1])
    end = lesson.composed_joint_step_2d(load, t, *state[:4], dt, p)
    (P, L), (P_new, L_new) = momenta_of(*state[:4], p), momenta_of(*end, p)
    about = [np.cross(in_space(m @ x) / np.sum(m), one) for x, one in ((state.x, P), (end[0], P_new))]
    push, twist = still + (t + 0.5 * dt) * grows, np.sum(twists[0] + (t + 0.5 * dt) * twists[1])
    return ((P_new, L_new - about[1]),
            (P + dt * np.sum(m) * in_space(push), L - about[0] + dt * twist * np.array([0.0, 0.0, 1.0])))


@random_law("A hinge of two ball joints turns about the line through both only, and keeps the momenta.",
            "hinge in space: largest error of spin, momenta and gaps [rad/s, kg m²/s, m]", EXACT)
def hinge_in_space(lesson, rng):
    """Rows of both joints depend on each other, so elimination within the band gives way to the shortest impulses."""
    state, p = random_bodies(lesson, rng, 3, 2)
    places = 0.5 * (state.x[0] + state.x[1]) + 0.2 * rng.normal(size=(2, 3))
    p = lesson.make_joints(state, p, [0, 0], [1, 1], places, 0.0)
    now = state[:4]
    for _ in range(2):
        now = lesson.joint_step(lesson.weight, 0.0, *now, 0.01, p)
    ends = points_of(now[0], now[1], p.joints)[0]
    line = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    apart = now[3][0] - now[3][1]
    return ((apart - (apart @ line) * line, *momenta_of(*now, p), gaps_and_speeds(now, p.joints)[0]),
            (np.zeros(3), *momenta_of(*state[:4], p), np.zeros((2, 3))))


@random_law("The force of a joint gives its two points the same acceleration.",
            "joint: largest error of its force [N]", EXACT)
def force_of_a_joint(lesson, rng):
    """Solve Newton's and Euler's equations of both bodies with the force as the only unknown.

    a_point = F/m + α × r + ω × (ω × r),      I α = τ + r × F_joint − ω × I ω
    The second body is free, or nothing moves it and it turns steadily.
    """
    d, heavy = rng.choice((2, 3)), rng.choice((0, 1)) * (1,)
    state, p = random_bodies(lesson, rng, d, 2, heavy)
    place = 0.5 * (state.x[0] + state.x[1]) + 0.1 * rng.normal(size=d)
    p = lesson.make_joints(state, p, [0], [1], [place], 0.0)
    F, tau = rng.normal(size=(2, d)), rng.normal(size=2 if d == 2 else (2, 3))
    load = lambda t, x, q, v, omega, p: (F, tau)
    forces = (lesson.joint_forces_2d if d == 2 else lesson.joint_forces)(load, 0.0, *state[:4], p)
    r, spins, F, tau, I = (in_space(place - state.x), about_normal(state.omega), in_space(F), about_normal(tau),
                           tensors(state.q, p))
    A, c = np.zeros((3, 3)), np.zeros(3)
    for i, sign in ((0, 1.0), (1, -1.0)):
        lever, inv_I = np.cross(np.eye(3), r[i]), np.linalg.pinv(I[i])               # r × F is lever F
        turning = inv_I @ (tau[i] - np.cross(spins[i], I[i] @ spins[i]))
        c += sign * (p.inv_mass[i] * F[i] + np.cross(turning, r[i]) + np.cross(spins[i], np.cross(spins[i], r[i])))
        A += p.inv_mass[i] * np.eye(3) + lever.T @ inv_I @ lever
    return forces[0], np.linalg.solve(A[:d, :d], -c[:d])


def landing_pair(lesson, rng):
    """Return (PileState, JointedBodies, e, dt) of a disc that touches a floor and is joined to another body."""
    e, dt, m, r = rng.uniform(0.2, 0.8), 1e-6, rng.uniform(0.5, 2.0, 2), 0.1
    x = np.array([(0.3, r), (0.3 + rng.uniform(-0.5, 0.5), rng.uniform(0.5, 0.8))])
    state, p = lesson.make_bodies_2d(x, rng.normal(size=2), m, rng.uniform(0.2, 0.5, 2), np.full((2, 2), r),
                                     [(0.0, 1.0, 0.0)], np.zeros(2), rng.uniform(0.0, 0.5), 400, 0.01)
    p = lesson.make_joints(state, p, [1], [0], [x[0] + rng.uniform(-0.3, 0.3, 2)], e)
    v, omega = rng.normal(size=(3, 2)) * [(1.0,), (1.0,), (0.0,)], rng.normal(size=3) * [1.0, 1.0, 0.0]
    v[:2, 1] -= 4.0
    _, _, v, omega = lesson.joint_step_2d(lesson.weight, 0.0, *state[:2], v, omega, dt, p)
    return state._replace(v=v, omega=omega), p, e, dt


@random_law("A disc that is joined to another body leaves the floor with −e of its speed; the joint stays closed, and "
            "the momenta change by the impulse of the floor.",
            "joined disc, 0 < e < 1: largest error [m/s, kg m²/s, m, N s]", 1e-5)
def joined_bodies_bounce(lesson, rng):
    """Within 1 µs nothing moves by more than some 10 µm, of which the contact and its arm are wrong."""
    state, p, e, dt = landing_pair(lesson, rng)
    end = lesson.joint_contact_step_2d(lesson.weight, lesson.disc_bounds, lesson.round_contacts, 0.0, state, dt, p)
    joint = lesson.joint_impulses_2d(lesson.weight, 0.0, state, end, dt, p)
    J, place = np.sum(end.J, axis=0), end.contacts.p[0]
    before, after = (np.concatenate(momenta_of(*now[:4], p)) for now in (state, end))
    change = np.concatenate((in_space(J), np.cross(in_space(place), in_space(J))))
    gap, _ = gaps_and_speeds(end[:4], p.joints)
    arm = rotations(state.q)[1] @ in_space(p.joints.r_a[0])
    return ((end.v[0, 1], after, gap, joint[0] * p.inv_mass[1],
             np.cross(arm, in_space(joint[0]))[2] * p.inv_inertia[1]),
            (-e * state.v[0, 1], before + change, np.zeros((1, 3)), end.v[1] - state.v[1],
             end.omega[1] - state.omega[1]))


@random_law("Of all solutions of equations that depend on each other the shortest is taken: the pseudo-inverse's.",
            "six equations of rank 2 to 5: largest error of their solution [-]", 1e-8)
def shortest_of_all(lesson, rng):
    half = rng.normal(size=(6, rng.integers(2, 6)))
    A, z = half @ half.T, rng.normal(size=6)
    return shortest_solution(A, A @ z), np.linalg.pinv(A, 1e-9) @ A @ z


@case("joints", "Joints in the plane and in space, and what judges a run", compiled=False)
def joints(lesson, check):
    """Compare steps with joints with conserved momenta, with reversed time and with Newton's and Euler's equations.

    Trees of five bodies have their joints in any order; a body that nothing moves may move and turn all the same.  An
    impulse acts on both points of a closed joint at one place, so it changes neither momentum.
    """
    check.laws(lesson, (judges_in_the_plane, work_of_driven_rows, parting_speeds, without_joined, joints_stay_closed,
                        joints_keep_momenta, joints_are_reversible, hinge_in_space, force_of_a_joint,
                        joined_bodies_bounce, residual_of_a_step, force_of_contacts, bound_of_the_overlap,
                        shortest_of_all, loops_and_bands, composed_steps_keep_momenta),
               seed=33, times=10)


# ---------------------------------------------------------------------------------------------- special steps

def torque_load(F, tau):
    """Return a load that is constant, with a torque."""
    return lambda t, x, q, v, omega, p: (F, tau)


@random_law("With mean velocities a fall, a turn and a slide come to a place that is exact.",
            "mean velocities: largest error of the state [m, rad, m/s]", EXACT)
def mean_velocities(lesson, rng):
    """Throw one body with a torque, and let another slide on a floor with friction: x = v t − ½ μ g t²."""
    mu, speed, dt = rng.uniform(0.1, 0.3), rng.uniform(2.0, 3.0), 0.02
    state, p = lesson.make_bodies_2d([(0.0, 0.1), (3.0, 5.0)], [0.1, 0.2], [2.0, 0.5], [np.inf, 0.3],
                                     np.full((2, 2), 0.1), [(0.0, 1.0, 0.0)], (0.0, -9.81), mu, 20, 0.01)
    v, omega = np.array([(speed, 0.0), rng.normal(size=2), np.zeros(2)]), np.array([0.0, 1.5, 0.0])
    F = np.array([(0.0, -19.62), (0.0, -4.905), (0.0, 0.0)])
    now, a, T = state._replace(v=v, omega=omega), np.array([(-mu * 9.81, 0.0), (0.0, -9.81)]), 10 * dt
    for n in range(10):
        now = lesson.mean_contact_step_2d(torque_load(F, np.array([0.0, 0.6, 0.0])), lesson.disc_bounds,
                                          lesson.round_contacts, n * dt, now, dt, p)
    return ((now.x[:2], now.q[:2], now.v[:2]),
            (state.x[:2] + T * v[:2] + 0.5 * T * T * a,
             np.array([0.1, 0.2 + 1.5 * T + 0.5 * 2.0 * T * T]), v[:2] + T * a))


@random_law("Friction against a moving floor takes the slip away, or as much of it as μ N dt can.",
            "slip on a moving floor: largest error [m/s, rad/s]", EXACT)
def slip_on_a_moving_floor(lesson, rng):
    m, I, R, dt = rng.uniform((0.5, 0.01, 0.1, 0.01), (2.0, 0.1, 0.5, 0.1))
    mu, g = rng.choice((0.0, 0.02, 50.0)), np.array([*rng.normal(size=2), rng.choice((-9.81, 2.0))])
    ball = lesson.CarriedBall(m, np.full(3, I), R, mu, g, *np.zeros((3, 3)))
    v, omega = rng.normal(size=(2, 3))
    floor, r = np.append(rng.normal(size=2), 0.0), np.array([0.0, 0.0, -R])
    slip = (v + np.cross(omega, r) + dt * g - floor) * [1.0, 1.0, 0.0]
    K = np.eye(3) / m - np.cross(np.eye(3), r) @ np.cross(np.eye(3), r) / I
    stick = -np.linalg.solve(K, slip) * [1.0, 1.0, 0.0]
    J = min(1.0, mu * max(0.0, -m * g[2]) * dt / np.linalg.norm(stick)) * stick
    return lesson.stop_slip(v, omega, floor, dt, ball), (v + J / m, omega + np.cross(r, J) / I)


@random_law("All bodies turn by 2 atan(½ |ω| dt) about their ω.", "quaternions: largest error of the rotations [-]",
            EXACT)
def turns_of_all_bodies(lesson, rng):
    q, omega, dt = random_quaternions(rng, 3), rng.normal(size=(3, 3)), rng.uniform(0.05, 0.5)
    truth = [turned_by(spin, dt) @ R for spin, R in zip(omega, rotations(q), strict=True)]
    return rotations(lesson.turn_quaternions(q, omega, dt)), np.array(truth)


def two_boxes(rng):
    """Return (x (2, 3), q (2, 4), half (2, 3)) of boxes that are near each other."""
    half = rng.uniform(0.3, 0.6, (2, 3))
    way = rng.normal(size=3)
    return np.array([np.zeros(3), rng.uniform(0.7, 1.1) * way / np.linalg.norm(way)]), random_quaternions(rng, 2), half


@random_law("Two boxes that collide in space, with friction, keep both momenta and lose energy.",
            "two boxes: largest change [kg m/s, kg m²/s], and gain of energy [J]", EXACT)
def boxes_collide(lesson, rng):
    """Let two boxes meet: impulses act at one place at the beginning of the step.

    Each has the same moment about all its axes, so its turn in the step does not change I ω.
    """
    m, moment, dt = rng.uniform(0.5, 2.0, 2), rng.uniform(0.1, 0.5, 2), 1e-3
    while True:
        x, q, half = two_boxes(rng)
        state, p = lesson.make_bodies(x, q, m, np.repeat(moment[:, None], 3, axis=1), half, [], np.zeros(3), 0.4, 20,
                                      0.02)
        state = state._replace(v=2.0 * np.array([x[1], -x[1]]), omega=rng.normal(size=(2, 3)))
        end = lesson.contact_step(lesson.weight, lesson.box_bounds, lesson.box_contacts, 0.0, state, dt, p)
        if np.any(end.J):
            break
    energy = lambda now: 0.5 * np.sum(m[:, None] * now.v**2 + moment[:, None] * now.omega**2)
    return ((*momenta_of(*end[:4], p), max(0.0, energy(end) - energy(state))), (*momenta_of(*state[:4], p), 0.0))


@random_law("A body of infinite mass goes on as it moves, and what it meets gets its speed.",
            "moving body of infinite mass: largest error of the states [m, rad, m/s]", EXACT)
def infinite_mass_moves(lesson, rng):
    """Let a disc or a ball rest in the way of another one that nothing moves, and that turns; nothing rubs."""
    d, dt = rng.choice((2, 3)), 0.01
    n = rng.normal(size=d)
    n /= np.linalg.norm(n)
    state, p = random_bodies(lesson, rng, d, 2, heavy=(0,))
    p.inv_inertia[1] = 2.0                                           # about all axes: it keeps its ω
    state = state._replace(x=np.array([0.0 * n, 0.2 * n]), v=np.array([1.5 * n, 0.0 * n]))
    step, bounds = (lesson.contact_step_2d, lesson.disc_bounds) if d == 2 else (lesson.contact_step, lesson.ball_bounds)
    end = step(lesson.weight, bounds, lesson.round_contacts, 0.0, state, dt, p._replace(mu=0.0))
    turned = rotations(state.q + dt * state.omega) if d == 2 else np.array(
        [turned_by(w, dt) @ R for w, R in zip(state.omega, rotations(state.q), strict=True)])
    v = np.array([1.5 * n, 1.5 * n])
    return (end.x, rotations(end.q), end.v, end.omega), (state.x + dt * v, turned, v, state.omega)


def flies_through(lesson, rng, kind):
    """Return (state, step, bounds, contacts, Bodies) of a thin plate in space that flies at another one, or at a plane.

    It is tilted a little and begins outside the margin.
    """
    half, thin, dt = np.full((2, 3), 0.5), 0.01, 0.01
    half[:, 2] = thin
    q = np.array([(1.0, 0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)])
    x, m = np.array([(0.0, 0.0, 2.6 * thin), (0.0, 0.0, 0.0)]), [1.0, np.inf]
    planes = [(0.0, 0.0, 1.0, thin)] if kind == "plane" else []
    bodies = 1 if kind == "plane" else 2
    moments = np.array([(0.1, 0.1, 0.1), (np.inf,) * 3])[:bodies]
    state, p = lesson.make_bodies(x[:bodies], q[:bodies], m[:bodies], moments, half[:bodies], planes, np.zeros(3), 0.0,
                                  10, 0.2 * thin)
    v = np.zeros((bodies + len(planes), 3))
    v[0, 2] = -rng.uniform(6.0, 20.0) * thin / dt
    return state._replace(v=v), p, dt


@random_law("In space a plate that passes another one, or a plane, within a step ends in an error with its speed; one "
            "that goes along it does not.", "plates: wrong answers [-]", 0.0)
def plates_that_pass(lesson, rng):
    found = []
    for kind, along in (("plate", False), ("plane", False), ("plate", True), ("plane", True)):
        state, p, dt = flies_through(lesson, rng, kind)
        if along:
            state = state._replace(v=np.roll(state.v, 1, axis=1))
        try:
            lesson.advance_contact(lesson.contact_step, lesson.weight, lesson.box_bounds, lesson.box_contacts, 0.0,
                                   state, dt, 1, p)
            found.append(0.0)
        except Diverged as error:
            found.append(float(f" {-state.v[0, 2]:.4g}" in str(error)))
    return np.array(found), np.array([1.0, 1.0, 0.0, 0.0])


@random_law("The gap of two balls of a cradle is that of discs; it closes where they overlap and come together.",
            "gaps of a cradle: largest error of gap and derivatives, and wrong answers [m, -]", EXACT)
def gaps_of_a_cradle(lesson, rng):
    """Try balls 1 and 2 of four, wide apart and deep in each other, as they come together and as they part.

    The derivative by an angle is the velocity of the centre at 1 rad/s, along the line of centres.
    """
    k, (L, R), theta = rng.integers(3), rng.uniform((0.5, 0.02), (1.0, 0.05)), rng.uniform(-0.5, 0.5, 4)
    omega = rng.uniform(-0.05, 0.05, 4)
    theta[k + 1] = theta[k] + rng.uniform(-0.02, 0.02)
    pitch = 2.0 * R * rng.uniform(1.3, 1.5) if rng.integers(2) else R * rng.uniform(1.0, 1.2)
    cradle = lesson.Cradle(pitch, L, R, 1.1 * L * L, 9.81)
    places = np.outer(pitch * np.arange(4), (1.0, 0.0)) + L * np.stack((np.sin(theta), -np.cos(theta)), axis=1)
    way, speeds = places[k + 1] - places[k], L * np.stack((np.cos(theta), np.sin(theta)), axis=1)
    n, gap = way / np.linalg.norm(way), np.linalg.norm(way) - 2.0 * R
    slopes = np.array([-n @ speeds[k], n @ speeds[k + 1]])
    return ((*swinging.cradle_gap(theta, k, cradle), swinging.closes(theta, omega, k, cradle),
             swinging.closes(theta, -omega, k, cradle)),
            (gap, *slopes, *(gap < 0.0 and sign * slopes @ omega[k:k + 2] < 0.0 for sign in (1.0, -1.0))))


def pushed(curve):
    """Return the step of two balls of a cradle that swing mirror-wise: the right one as this polynomial of t bends."""
    sides, bend = np.array([-1.0, 1.0]), curve.deriv(2)

    def step(acceleration, t, theta, omega, dt, p):
        later = [bend.integ(k)(t + dt) - bend.integ(k)(t) for k in (1, 2)]
        return theta + dt * omega + sides * (later[1] - dt * bend.integ(1)(t)), omega + sides * later[0]
    return step


@random_law("Balls that meet in a cradle swing back, at the time at which they touch, and each step has its own time.",
            "two balls of a cradle: largest error of the angles and their rates [rad, rad/s]", EXACT)
def balls_that_swing_back(lesson, rng):
    """Push two balls harder and harder.  They move apart, come together, and would rest at the end of dt.

    There the way that is left is long for their speed, and they touch in the second half of the step.
    """
    t, dt, L, R = rng.uniform((0.0, 0.05, 0.5, 0.02), (1.0, 0.1, 1.0, 0.05))
    most, rest, touch = t + dt * np.array([rng.uniform(0.02, 0.1), 1.0005, rng.uniform(0.6, 0.9)])
    curve = (np.poly1d([most, rest], r=True) * rng.uniform(20.0, 100.0)).integ()
    curve -= curve(t) + rng.uniform(0.0, 0.1)
    cradle = lesson.Cradle(2.0 * R - 2.0 * L * np.sin(curve(touch)), L, R, 1.1 * L * L, 9.81)
    theta, omega = np.outer((curve(t), curve.deriv()(t)), (-1.0, 1.0))
    end, rate = lesson.advance_swinging(pushed(curve), t, theta, omega, dt, 3, cradle)
    back, last = -2.0 * curve.deriv()(touch), t + 3.0 * dt
    return (end[1], end[0], rate[1], rate[0]), np.outer(
        (curve(last) + back * (last - touch), curve.deriv()(last) + back), (1.0, -1.0)).ravel()


@random_law("Zeros, extrema and values of a polynomial of degree 5 are those of its coefficients.",
            "polynomial: largest error of the times and values [s, -]", 1e-7)
def polynomials(lesson, rng):
    """Take roots that are clear of each other and of the ends, in times from 0 to 2 s."""
    while True:
        p = np.poly1d(rng.normal(size=6))
        roots = {k: np.sort([r.real for r in p.deriv(k).roots if abs(r.imag) < 1e-9 and 0.0 < r.real < 2.0])
                 for k in (0, 1)}
        at = p.deriv()(roots[0]), p.deriv(2)(roots[1])
        if all(abs(slope) > 0.3 for one in at for slope in one) and len(roots[1]) > 0:
            break
    ts = np.linspace(0.0, 2.0, 41)
    highest, rising, between = at[1] < 0.0, at[0] > 0.0, rng.uniform(0.0, 2.0, 5)
    found = (zeros(ts, p(ts)), zeros(ts, p(ts), 1), *extrema(ts, p(ts)), *extrema(ts, p(ts), 1),
             *extrema(ts, p(ts), -1), value_at(ts, p(ts), between))
    truth = (roots[0], roots[0][rising], roots[1], p(roots[1]), roots[1][highest], p(roots[1][highest]),
             roots[1][~highest], p(roots[1][~highest]), p(between))
    counts = tuple(np.array([len(one) for one in sets], float) for sets in (found, truth))
    same = np.array_equal(*counts)
    return (counts[0], *(found if same else truth)), (counts[1], *truth)


@case("special-steps", "Driven floors, bodies of infinite mass, collisions of boxes, events", compiled=False)
def special_steps(lesson, check):
    """Compare what only some scenes use with closed forms and conserved quantities."""
    check.laws(lesson, (mean_velocities, slip_on_a_moving_floor, turns_of_all_bodies, boxes_collide,
                        infinite_mass_moves, plates_that_pass, polynomials, balls_that_swing_back,
                        gaps_of_a_cradle), seed=34, times=10)


# ---------------------------------------------------------------------------------------------- a loop from a Model

DOWN = (0.0, -9.81)          # gravity [m/s²]
FLOOR = model.Body((0.0, 0.0), shape=shapes.HalfSpace((0.0, 1.0)), mu=1.0, e=1.0)


def springy(rng):
    """Return (Model, load) of three bodies that turn and one that nothing moves.

    They have springs at their rims, drag, and a load that depends on where they are and how they turn.
    """
    bodies = [model.Body(tuple(x), m, q=q, v=tuple(v), omega=w, inertia=0.4) for x, m, q, v, w in zip(
        2.0 * rng.normal(size=(3, 2)), rng.uniform(0.5, 2.0, 3), *rng.normal(size=(1, 3)), rng.normal(size=(3, 2)),
        rng.normal(size=3), strict=True)]
    bodies.insert(1, model.Body((4.0, 1.0), omega=0.7, v=(0.1, 0.2)))
    ends = (0, 1), (2, model.WORLD), (3, 0), (1, 2)
    springs = [model.Spring(a, b, *map(tuple, 0.3 * rng.normal(size=(2, 2))), *rng.uniform(0.5, 2.0, 3))
               for a, b in ends]
    still, twist = rng.normal(size=(4, 2)), rng.normal(size=4)
    push = lambda t, x, q, v, omega: (still + 0.1 * x, twist + 0.2 * omega)
    loads = [model.Drag(0.3), model.Drag(0.2), push]
    return model.make_model(bodies, rng.normal(size=2), springs=springs, loads=loads), push


def pulls_of(scene, push):
    """Return (F (n, 3) [N], τ (n, 3) [N m], energy of the springs [J]) of all that acts on a Model, by vectors."""
    state = model.start_of(scene)
    x, v, spins, turn = in_space(state.x), in_space(state.v), about_normal(state.omega), rotations(state.q)
    free = np.array([np.isfinite(body.m) for body in scene.bodies])[:, None]
    m = np.array([body.m if np.isfinite(body.m) else 0.0 for body in scene.bodies])[:, None]
    more, twist = push(0.0, *state)
    F, tau, energy = in_space(more), about_normal(twist), 0.0
    F = F + m * in_space(scene.gravity) - 0.5 * free * v
    for s in scene.springs:
        arms = [in_space(np.array(place)) if k == model.WORLD else turn[k] @ in_space(np.array(place))
                for k, place in ((s.a, s.place_a), (s.b, s.place_b))]
        at = [arm if k == model.WORLD else x[k] + arm for k, arm in zip((s.a, s.b), arms, strict=True)]
        u = [np.zeros(3) if k == model.WORLD else v[k] + np.cross(spins[k], arm)
             for k, arm in zip((s.a, s.b), arms, strict=True)]
        length = np.linalg.norm(at[0] - at[1])
        along = (at[0] - at[1]) / length
        force = -(s.k * (length - s.rest) + s.c * along @ (u[0] - u[1])) * along
        energy += 0.5 * s.k * (length - s.rest) ** 2
        for k, arm, pull in ((s.a, arms[0], force), (s.b, arms[1], -force)):
            if k != model.WORLD:
                F[k], tau[k] = F[k] + pull, tau[k] + np.cross(arm, pull)
    return F, tau, energy


@random_law("A loop has the forces and torques of gravity, springs, dampers and drag of its Model.",
            "Model: largest error of loads and energy [N, N m, J]", EXACT)
def loads_of_a_model(lesson, rng):
    """Take only what acts on bodies that can move: the others have no use for a force."""
    scene, push = springy(rng)
    loop, (F, tau, stored) = lesson.compose(scene), pulls_of(scene, push)
    free = [k for k, body in enumerate(scene.bodies) if np.isfinite(body.m)]
    got = loop.load(0.0, *loop.state[:4], loop.p)
    own = model.loads_at(scene, 0.0, model.start_of(scene))
    gravity = np.array([scene.bodies[k].m * np.array(scene.gravity) for k in free])
    energy = stored + sum(b.m * (0.5 * np.dot(b.v, b.v) - np.dot(scene.gravity, b.x)) + 0.2 * b.omega**2
                          for b in (scene.bodies[k] for k in free))
    return ((got[0][loop.row[free]], got[1][loop.row[free]], own[0][free] + gravity, own[1][free],
             model.model_energy(scene, model.start_of(scene))),
            (F[free, :2], tau[free, 2], F[free, :2], tau[free, 2], energy))


@random_law("In space the energy of a Model is that of its tensors; a spring pulls between its points, also in a loop.",
            "Model in space: largest error of energy and loads [J, N, N m]", EXACT)
def model_in_space(lesson, rng):
    q, places = random_quaternions(rng, 2), 0.3 * rng.normal(size=(2, 3))
    v, omega, x = rng.normal(size=(3, 2, 3))
    moments = rng.uniform(1.0, 1.9, (2, 3))
    bodies = [model.Body(tuple(x[i]), 2.0, q=tuple(q[i]), v=tuple(v[i]), omega=tuple(omega[i]),
                         inertia=tuple(moments[i])) for i in range(2)]
    spring = model.Spring(0, 1, *map(tuple, places), 0.5, 3.0, 0.7)
    scene = model.make_model(bodies, (0.0, 0.0, -9.81), springs=[spring], loads=[model.Drag(0.3)])
    R = rotations(q)
    arms = [R[i] @ places[i] for i in range(2)]
    way, u = x[0] + arms[0] - x[1] - arms[1], v[0] + np.cross(omega[0], arms[0]) - v[1] - np.cross(omega[1], arms[1])
    length = np.linalg.norm(way)
    pull = -(3.0 * (length - 0.5) + 0.7 * u @ way / length) * way / length
    energy = 1.5 * (length - 0.5) ** 2 + sum(
        v[i] @ v[i] + 19.62 * x[i, 2] + 0.5 * omega[i] @ R[i] @ np.diag(moments[i]) @ R[i].T @ omega[i] for i in (0, 1))
    pulls, torques = np.array([pull, -pull]) - 0.3 * v, np.cross(arms, (pull, -pull))
    state, loop, weights = model.start_of(scene), lesson.compose(scene), np.array([(0.0, 0.0, -19.62)] * 2)
    point, loads = rng.normal(size=3), loop.load(0.0, *loop.state[:4], loop.p)
    return ((model.model_energy(scene, state), *model.loads_at(scene, 0.0, state),
             model.world_place(state, 1, model.own_place(scene, 1, point)), *(rows[loop.row] for rows in loads)),
            (energy, pulls, torques, point, weights + pulls, torques))


NODES, WEIGHTS = np.polynomial.legendre.leggauss(40)


def quadrature(f, half):
    """Return the integral of f from −half to half, where f falls to 0 as a root does at the ends: z = half sin s."""
    s = 0.5 * np.pi * NODES
    return np.sum(WEIGHTS * f(half * np.sin(s)) * half * np.cos(s) * 0.5 * np.pi)


@random_law("Moments of inertia of shapes are those of their slices, those of a triangle are m Σ side²/36.",
            "shapes: largest error of the moments over m [m²]", 1e-8)
def moments_of_shapes(lesson, rng):
    h, r, a, b, c = rng.uniform(0.2, 1.0, 5)
    radius = lambda z: np.sqrt(np.maximum(r * r - np.maximum(np.abs(z) - h, 0.0) ** 2, 0.0))
    parts = lambda f: sum(quadrature(lambda z, a=a, b=b: f(0.5 * (a + b) + z), 0.5 * (b - a))
                          for a, b in ((-h - r, -h), (-h, h), (h, h + r)))
    area, volume = parts(lambda z: 2.0 * radius(z)), parts(lambda z: np.pi * radius(z) ** 2)
    plane = parts(lambda z: 2.0 * radius(z) ** 3 / 3.0 + 2.0 * radius(z) * z * z) / area
    along = parts(lambda z: 0.5 * np.pi * radius(z) ** 4) / volume
    across = parts(lambda z: np.pi * radius(z) ** 2 * (0.25 * radius(z) ** 2 + z * z)) / volume
    triangle = rng.normal(size=(3, 2))
    triangle = triangle if np.linalg.det(triangle[1:] - triangle[0]) > 0.0 else triangle[::-1]
    centre = np.mean(triangle, axis=0)
    sides = np.sum((np.roll(triangle, -1, axis=0) - triangle) ** 2)
    m = rng.uniform(0.5, 2.0)
    of = lambda shape, d: np.array(shapes.moments_of_shape(shape, m, d)) / m
    corners = np.array([(x, y, z) for x in (-a, a) for y in (-b, b) for z in (-c, c)])
    solid, middle, _ = shapes.polyhedron_of(corners @ matrix_of(random_quaternions(rng, 1)[0]) + triangle[0, 0])
    return ((of(shapes.Capsule(h, r), 2), of(shapes.Capsule(h, r), 3), of(shapes.Box((a, b)), 2),
             of(shapes.Box((a, b, c)), 3), of(shapes.Ball(r), 2), of(shapes.Ball(r), 3),
             of(shapes.Polygon(triangle - centre), 2), shapes.polygon_centre(triangle), np.sort(of(solid, 3)), middle),
            (plane, np.array((along, across, across)), (a * a + b * b) / 3.0,
             np.array((b * b + c * c, a * a + c * c, a * a + b * b)) / 3.0, 0.5 * r * r, np.full(3, 0.4 * r * r),
             sides / 36.0, centre, np.sort((b * b + c * c, a * a + c * c, a * a + b * b)) / 3.0,
             np.full(3, triangle[0, 0])))


# ---------------------------------------------------------------------------------------------- parts of that loop

def rubbing(lesson, rng):
    """Return (state with contacts, record of the parts, arms, contacts) of four bodies with six contacts."""
    state, p = random_bodies(lesson, rng, 2, 4)
    contacts = random_contacts(lesson, rng, 4, 6)
    state, none = state._replace(contacts=contacts, J=rng.normal(size=(6, 2))), np.zeros(0, np.int64)
    record = SimpleNamespace(inv_mass=p.inv_mass, inv_inertia=p.inv_inertia, drag=0.0,
                             joints=SimpleNamespace(a=none, b=none), rods=SimpleNamespace(a=none, b=none),
                             ends=np.zeros((0, 2), np.int64), e_of=rng.choice((0.0, 0.5, 0.9), 4),
                             mu_of=rng.choice((0.0, 0.4, 1.5), 4), gravity=rng.normal(size=2), slop=0.02, sweeps=200,
                             settled=1e-12, calm=np.inf, half=SimpleNamespace(half=np.ones((4, 2))))
    return state, record, lesson.arms_2d(state.x, p.inv_mass, p.inv_inertia, contacts), contacts


@random_law("Each pair has its restitution e_a e_b of the speed before forces acted, also where it parts; what they "
            "explain rests; gravity presses none that fall freely; an open contact may close.",
            "pairs: largest error of the speeds of parting [m/s]", EXACT)
def aims_of_pairs(lesson, rng):
    state, p, arms, contacts = rubbing(lesson, rng)
    fixed, p.inv_mass = rng.random(4) < 0.2, p.inv_mass.copy()           # a joint holds another one
    p.inv_mass[fixed], p.joints.a = 0.0, rng.integers(0, 4, rng.integers(0, 2))
    held = fixed | np.isin(np.arange(4), p.joints.a)
    for _ in range(4):                                                   # and what touches a body that is held is, too
        for a, b in zip(contacts.a, contacts.b, strict=True):
            held[[i for i in (a, b) if not fixed[i]]] |= held[a] | held[b]
    dt, truth, speeds = rng.uniform(0.01, 0.5), [], lesson.normal_velocities_2d(state.v, state.omega, contacts, arms)
    pressed = rng.uniform(-0.6, 0.2, len(speeds)) * np.abs(speeds)
    for k, (a, b, n) in enumerate(zip(*contacts[1:4], strict=True)):
        e, u_n, gap = p.e_of[a] * p.e_of[b], speed_at(state, contacts, k)[0] @ n, contacts.gap[k]
        falls = not np.any(held[[i for i in (a, b) if not fixed[i]] or [a]])
        came, added = u_n - pressed[k], max(0.0 if falls else dt * np.linalg.norm(p.gravity), -pressed[k])
        bounces = e > 0.0 and (-came > added or (gap > added * dt if gap > 0.0 else came > added))
        truth.append((-np.inf if gap > 0.0 else -e * came) if bounces else (-gap / dt if gap > 0.0 else 0.0))
    return lesson.parting_aims(speeds, pressed, contacts, dt, p), np.array(truth)


@random_law("Sweeps have settled when no impulse has changed by more than a share of the largest one among bodies that "
            "touch.", "settled sweeps: wrong answers [-]", 0.0)
def settled_sweeps(lesson, rng):
    """Change one impulse of nine on three islands by a little less or more than that; others are much larger."""
    d, island, found = rng.choice((2, 3)), rng.permutation(np.repeat((0, 2, 5), 3)), []
    J = rng.uniform(0.5, 1.0, (9, d)) * rng.choice((-1.0, 1.0), (9, d)) * 10.0 ** (island[:, None] - 2.0)
    for k, c, share in product(range(9), range(d), (-1.01, -0.99, 0.99, 1.01)):
        before = J.copy()
        before[k, c] += 0.01 * share * np.max(np.abs(J[island == island[k]]))
        found.append(lesson.is_settled(J, before, island, np.full(6, 1e9), SimpleNamespace(settled=0.01)))
    return np.array(found, float), np.tile((0.0, 1.0, 1.0, 0.0), 9 * d)


@random_law("Contacts are on one island where bodies that can move lead from one to the other.",
            "islands: wrong answers [-]", 0.0)
def islands_of_contacts(lesson, rng):
    """Draw some contacts of nine bodies, two of which nothing moves: powers of a matrix show which are connected."""
    inv_mass = np.ones(9)
    inv_mass[rng.permutation(9)[:2]] = 0.0
    a, b = np.sort([rng.permutation(9)[:2] for _ in range(rng.integers(3, 10))]).T
    a, b = a[inv_mass[a] + inv_mass[b] > 0.0], b[inv_mass[a] + inv_mass[b] > 0.0]
    links = np.eye(9)
    links[a, b] = links[b, a] = inv_mass[a] * inv_mass[b]
    one = np.where(inv_mass[a] > 0.0, a, b)
    island = lesson.islands_of(SimpleNamespace(a=a, b=b), SimpleNamespace(inv_mass=inv_mass))
    return 1.0 * (island[:, None] == island), 1.0 * (np.linalg.matrix_power(links, 8) > 0.0)[np.ix_(one, one)]


@random_law("A contact that bounces, or waits for its bounce, keeps no impulse; all others keep theirs.",
            "kept impulses: largest error [N s]", 0.0)
def impulses_that_are_kept(lesson, rng):
    """Try contacts that leave with a speed, that rest, that may close, and that wait."""
    d, kinds = rng.choice((2, 3)), rng.permutation(np.repeat(np.arange(4), 2))
    J = rng.normal(size=(8, d))
    kept = J.copy()
    lesson.forget_bounces(kept, np.array([rng.choice((0.05, 2.0)), 0.0, -0.05, -np.inf])[kinds])
    return kept, J * np.isin(kinds, (1, 2))[:, None]


@random_law("Where nothing rubs, only the part of a kept impulse along the normal stays.",
            "kept impulses along normals: largest error [N s]", EXACT)
def kept_along_normals(lesson, rng):
    """What stays is parallel to the normal, and what goes is at right angles to it."""
    d = rng.choice((2, 3))
    n, J = rng.normal(size=(2, 5, d))
    n /= np.linalg.norm(n, axis=1)[:, None]
    kept = lesson.along_normals(J, n)
    return (np.cross(in_space(kept), in_space(n)), np.sum((J - kept) * n, axis=1)), (np.zeros((5, 3)), np.zeros(5))


@random_law("A sweep over pairs limits friction by μ_a μ_b of the new J_n; without friction and rotation no arm "
            "counts.", "pairs: largest error after a sweep [m/s, rad/s, N s]", EXACT)
def sweeps_of_pairs(lesson, rng):
    state, p, arms, contacts = rubbing(lesson, rng)
    aim = rng.normal(size=6)
    rub = swept_by_hand(state, p, contacts, aim, p.mu_of[contacts.a] * p.mu_of[contacts.b])
    got = lesson.sweep_pairs_2d(state.v, state.omega, state.J, aim, contacts, arms, p.inv_inertia, p)
    still = SimpleNamespace(**{**vars(p), "inv_inertia": 0.0 * p.inv_inertia})
    state = state._replace(J=np.abs(rng.normal(size=(6, 1))) * contacts.n, omega=0.0 * state.omega)
    smooth = swept_by_hand(state, still, contacts, aim, np.zeros(6))
    centres = lesson.sweep_centres_2d(state.v, state.omega, state.J, aim, contacts, arms, still.inv_inertia, still)
    return (*got, *centres), (*rub, *smooth)


@random_law("A fifth of each overlap beyond the slop goes per step, and velocities stay.",
            "overlap: largest error of places, angles and velocities [m, rad, m/s]", EXACT)
def overlap_goes(lesson, rng):
    """Let a single contact overlap by more or by less than the slop."""
    state, p, _, _ = rubbing(lesson, rng)
    gap, dt, n = -rng.choice((0.5, 3.0)) * p.slop, rng.uniform(0.01, 0.1), rng.normal(size=2)
    n /= np.linalg.norm(n)
    contacts = lesson.ContactSet(np.array([0, 0, 1, 1, 1]), np.array([1]), np.array([3]), n[None],
                                 rng.normal(size=(1, 2)), np.array([gap]))
    state, away = state._replace(contacts=contacts, J=np.zeros((1, 2))), 0.2 * max(0.0, -gap - p.slop)
    arms = speed_at(state, contacts, 0)[1]
    levers, k_n = [r[0] * n[1] - r[1] * n[0] for r in arms], inverse_mass_along(p, (1, 3), arms, n)
    x, q = state.x.copy(), state.q.copy()
    for i, lever, sign in ((1, levers[0], 1.0), (3, levers[1], -1.0)):
        x[i] += sign * p.inv_mass[i] * away / k_n * n
        q[i] += sign * p.inv_inertia[i] * away / k_n * lever
    end = lesson.separate(None, None, None, 0.0, state, dt, p)
    return (*end[:4], end.contacts.gap), (x, q, state.v, state.omega, np.array([gap + away]))


def tumbling(rng, d):
    """Return a Body that moves and tumbles anywhere."""
    x, v = rng.normal(size=(2, d))
    spin, inertia = (float(rng.normal()), 0.3) if d == 2 else (tuple(rng.normal(size=3)), (0.2, 0.3, 0.4))
    q = float(rng.normal()) if d == 2 else tuple(random_quaternions(rng, 1)[0])
    return model.Body(tuple(x), rng.uniform(0.5, 3.0), q=q, v=tuple(v), omega=spin, inertia=inertia)


@random_law("The pull F of a soft rod and the weight change the momenta of its body; the rod is longer by F times its "
            "compliance.", "a soft rod: largest error of momenta and length [kg m/s, kg m²/s, m]", EXACT)
def pull_of_a_soft_rod(lesson, rng):
    """Hold a body that tumbles at a point off its centre, in the plane and in space."""
    errors = []
    for d in (2, 3):
        held, g, dt, place = tumbling(rng, d), rng.normal(size=d), rng.uniform(0.01, 0.05), 0.3 * rng.normal(size=d)
        rod = model.Distance(0, model.WORLD, tuple(place), (2.0,) * d, compliance=0.01)
        loop = lesson.compose(model.make_model([held], tuple(g), [rod]))
        after = lesson.run_parts(loop, 0.0, loop.state, dt, 1)
        J = in_space(lesson.link_impulses(loop.load, 0.0, loop.state, after, dt, loop.p)[0])
        x, weight, arms = in_space(held.x), in_space(held.m * dt * g), [
            rotations(q[:1])[0] @ in_space(place) for q in (loop.state.q, after.q)]
        (P, L), (P_new, L_new) = momenta_of(*loop.state[:4], loop.p), momenta_of(*after[:4], loop.p)
        ways = x + arms[0] - in_space((2.0,) * d), in_space(after.x[0]) + arms[1] - in_space((2.0,) * d)
        lengths = [np.linalg.norm(way) for way in ways]
        errors += [P_new - P - J - weight, L_new - L - np.cross(x, J + weight) - np.cross(arms[0], J),
                   lengths[1] - lengths[0] + 0.01 / dt * (J @ ways[0]) / lengths[0]]
    return tuple(errors), (np.zeros(14),)


@random_law("Two bodies on a rod between points off their centres keep both momenta.",
            "two bodies on a rod: largest error of the momenta [kg m/s, kg m²/s]", EXACT)
def momenta_on_a_rod(lesson, rng):
    begin, end = [], []
    for d in (2, 3):
        rod = model.Distance(0, 1, *map(tuple, 0.3 * rng.normal(size=(2, d))), compliance=rng.choice((0.0, 0.01)))
        loop = lesson.compose(model.make_model([tumbling(rng, d), tumbling(rng, d)], (0.0,) * d, [rod]))
        begin += momenta_of(*loop.state[:4], loop.p)
        end += momenta_of(*lesson.run_parts(loop, 0.0, loop.state, 0.01, 3)[:4], loop.p)
    return tuple(end), tuple(begin)


@random_law("A rod carries what hangs on it: its impulse in a step is m g dt, for every spin of the body.",
            "a rod at rest: largest error of its impulse [N s]", 1e-8)
def weight_on_a_rod(lesson, rng):
    """Hang a ball on a rod from the world, along gravity, in the plane and in space."""
    found, truth = [], []
    for d in (2, 3):
        g, m, dt, length = rng.normal(size=d), rng.uniform(0.5, 3.0), rng.uniform(0.001, 0.01), rng.uniform(0.5, 2.0)
        spin = float(rng.normal()) if d == 2 else tuple(rng.normal(size=3))
        hung = model.Body(tuple(length * g / np.linalg.norm(g)), m, shapes.Ball(0.1), omega=spin)
        rod = model.Distance(0, model.WORLD, (0.0,) * d, (0.0,) * d)
        loop = lesson.compose(model.make_model([hung], tuple(g), [rod]))
        after = lesson.run_parts(loop, 0.0, loop.state, dt, 1)
        found.append(lesson.link_impulses(loop.load, 0.0, loop.state, after, dt, loop.p)[0])
        truth.append(-m * g * dt)
    return tuple(found), tuple(truth)


@case("loop-from-a-model", "A loop that is composed from a Model", compiled=False)
def loop_from_a_model(lesson, check):
    """Compare the loads, parts and sweeps of a composed loop with vectors, and its motions with closed forms.

    A spring pulls −(k (l − l₀) + c l̇) along its line, drag −k v.  Parts: see each law.
    """
    check.laws(lesson, (loads_of_a_model, model_in_space, moments_of_shapes, aims_of_pairs, sweeps_of_pairs,
                        overlap_goes, weight_on_a_rod, pull_of_a_soft_rod,
                        momenta_on_a_rod, settled_sweeps, impulses_that_are_kept,
                        kept_along_normals, islands_of_contacts), seed=35, times=10)
    right_parts(lesson, check)
    pairs_of_a_model(check)
    composed_motions(lesson, check)


def ball(x, **more):
    """Return a disc of 10 cm and 1 kg."""
    return model.Body(x, 1.0, shapes.Ball(0.1), **more)


MANY = (*(ball((0.5 * k, 0.13), mu=0.5) for k in range(8)), ball((3.5, 0.36), mu=0.5))       # one above another
ROD = model.Body((0.0, 1.0), 1.0, inertia=0.1)
FEEL = ["detect_few", "separate"]
COMPOSITIONS = (             # bodies, gravity, joints, the parts of their loop in order
    ((model.Body((0.0, 1.0), 1.0),), DOWN, (), ["accelerate", "move"]),
    ((model.Body((0.0, 1.0), 1.0),), (0.0, 0.0), (), ["move"]),
    ((model.Body((0.0, 1.0), 1.0, omega=1.0),), DOWN, (), ["accelerate", "move_and_turn"]),
    ((ROD,), DOWN, (model.Hinge(0, model.WORLD, (0.0, 0.0)),),
     ["accelerate_half", "close", "move_and_turn", "accelerate_rest", "hold"]),
    ((ball((0.0, 1.0)), FLOOR), DOWN, (), ["accelerate", *FEEL, "contact_impulses_of_centres", "move"]),
    ((ball((0.0, 1.0), mu=0.5), FLOOR), DOWN, (), ["accelerate", *FEEL, "contact_impulses", "move_and_turn"]),
    ((ball((0.0, 1.0), mu=0.5), ball((1.0, 1.0), mu=0.2), FLOOR), (0.0, 0.0), (),
     [*FEEL, "contact_impulses_of_pairs", "move_and_turn"]),
    ((*[model.Body((0.0, 1.0), 1.0)] * 9, ball((0.0, 1.0)), FLOOR), DOWN, (),
     ["accelerate", *FEEL, "contact_impulses_of_centres", "move"]),
    ((model.Body((0.0, 1.0), 1.0, shapes.Box((0.1, 0.1)), inertia=np.inf), FLOOR), DOWN, (),
     ["accelerate", *FEEL, "contact_impulses_of_centres", "move"]),
    ((ball((0.0, 1.0), mu=0.05), FLOOR), DOWN, (), ["accelerate", *FEEL, "contact_impulses", "move_and_turn"]),
    ((*MANY, FLOOR), DOWN, (), ["accelerate", "detect_many", "separate", "contact_impulses_of_pairs", "move_and_turn"]),
    ((*MANY, FLOOR), DOWN, (model.Hinge(0, 1, (0.25, 0.13)),),
     ["accelerate", "detect_unjoined", "separate_with_joints", "contact_impulses_with_joints", "move_and_turn"]),
)


def right_parts(lesson, check):
    """Compose loops of Models that need different parts."""
    right = 0
    for bodies, gravity, joints, parts in COMPOSITIONS:
        loop = lesson.compose(model.make_model(bodies, gravity, joints))
        right += [part.step.__name__ for part in loop.parts] == parts
    check.count("A loop has the parts that its Model needs, in the order of the lecture, and no others.",
                "Models whose loop has the right parts", right, len(COMPOSITIONS), "loops have the right parts.")


def pairs_of_a_model(check):
    """Compare what pairs of bodies do with the products of their numbers; joined ones and two supports do not touch."""
    bodies = [ball((0.0, 1.0), mu=0.5, e=0.4), ball((1.0, 1.0), mu=np.inf, e=0.5), ball((2.0, 1.0)), FLOOR, FLOOR]
    scene = model.make_model(bodies, DOWN, [model.Hinge(2, 0, (1.0, 1.0))])
    found = [model.touching_pairs(scene) == [(0, 1), (0, 3), (0, 4), (1, 2), (1, 3), (1, 4), (2, 3), (2, 4)],
             model.friction_of(scene, 0, 3) == 0.5, model.friction_of(scene, 0, 1) == np.inf,
             model.friction_of(scene, 1, 2) == 0.0, model.restitution_of(scene, 0, 1) == 0.2]
    check.count("A pair has μ_a μ_b and e_a e_b; nothing rubs on a body without friction.", "facts about pairs",
                sum(found), len(found), "facts are right.")


def composed_run(lesson, bodies, gravity, joints, dt, steps, t=0.0, **more):
    """Return the State of all bodies after so many steps of the composed loop from t on; more: of the Model."""
    loop = lesson.compose(model.make_model(bodies, gravity, joints, **more), lesson.Settings(settled=ROUND_OFF))
    return lesson.state_of(loop, lesson.run_parts(loop, t, loop.state, dt, steps))


def composed_motions(lesson, check):
    """Run composed loops whose end has a closed form.

    A block on a slope of angle θ slides at g (sin θ − μ cos θ).  Balls that meet part with e_a e_b of their speed.  A
    weld keeps angles and distance.  Joined bodies in flight keep both momenta.
    """
    angle, dt, g = 0.5, 0.01, 9.81
    n, along = np.array([-np.sin(angle), np.cos(angle)]), np.array([np.cos(angle), np.sin(angle)])
    slope = model.Body((0.0, 0.0), shape=shapes.HalfSpace(tuple(n)), mu=1.0, e=1.0)
    block = lambda at, mu: model.Body(tuple(at * along + 0.1 * n), 2.0, shapes.Box((0.2, 0.1)), mu=mu, q=angle)
    for mus in ((0.3, 0.3), (0.1, 0.4)):
        end = composed_run(lesson, [block(0.0, mus[0]), block(3.0, mus[1]), slope], DOWN, (), dt, 20)
        speeds = [-v @ along - 20 * dt * g * (np.sin(angle) - mu * np.cos(angle))
                  for v, mu in zip(end.v[:2], mus, strict=True)]
        check.agree("Blocks slide at g (sin θ − μ cos θ), each with its own μ.",
                    f"μ = {mus[0]:g} and {mus[1]:g}: error of the speeds [m/s]", np.max(np.abs(speeds)), EXACT)
    ends = []
    for still in ((0.0, 0.0), (0.0, 0.0, 0.0)):
        balls = [ball(still, v=(1.0, *still[1:]), e=0.8), ball((0.3, *still[1:]), e=0.5)._replace(m=3.0)]
        ends.append(composed_run(lesson, balls, still, (), dt, 30).v[:, 0])
    check.agree("Two balls part with e_a e_b of the speed with which they meet, and keep their momentum.",
                "in the plane and in space: error of the velocities after an impact [m/s]",
                np.max(np.abs(np.array(ends) - ((1.0 - 3.0 * 0.4) / 4.0, (1.0 + 0.4) / 4.0))), EXACT)
    swing = lambda t, x, q, v, omega: (np.cos(t) * np.ones((1, 2)), np.sin(t) * np.ones(1))
    end = composed_run(lesson, [model.Body((0.0, 0.0), 2.0, inertia=0.5)], (0.0, 0.0), (), dt, 5, t=0.4, loads=[swing])
    times = 0.4 + dt * np.arange(5)
    check.agree("Each step of a composed loop takes the load at its own time.", "error of v and ω [m/s, rad/s]",
                np.max(np.abs((*(end.v[0] - 0.5 * dt * np.sum(np.cos(times))),
                               end.omega[0] - 2.0 * dt * np.sum(np.sin(times))))), EXACT)
    joined_motions(lesson, check)
    composed_supports(lesson, check)
    composed_in_space(lesson, check)
    fast_ball(lesson, check)


def swing(theta, T, steps=400):
    """Return the angle [rad] of a pendulum of 1 kg, 1 m and 0.1 kg m², released at theta, by Runge–Kutta."""
    law = lambda y: np.array([y[1], -9.81 / 1.1 * np.sin(y[0])])
    y, h = np.array([theta, 0.0]), T / steps
    for _ in range(steps):
        a = law(y)
        b = law(y + 0.5 * h * a)
        c = law(y + 0.5 * h * b)
        y = y + h / 6.0 * (a + 2.0 * b + 2.0 * c + law(y + h * c))
    return y[0]


def composed_supports(lesson, check):
    """Swing a pendulum, roll a disc down a slope, and drop nine discs, also with a hinge between two."""
    theta, T, turned = 1.0, 0.8, []
    rod = model.Body((np.sin(theta), -np.cos(theta)), 1.0, q=theta, inertia=0.1)
    for steps in (40, 80):
        end = composed_run(lesson, [rod], DOWN, [model.Hinge(0, model.WORLD, (0.0, 0.0))], T / steps, steps)
        turned.append(end.q[0] - swing(theta, T))
    check("A composed pendulum swings by the law of a pendulum, with an error of order 2.",
          "order of the angle of a composed pendulum [-]", law=2.0, found=np.log2(turned[0] / turned[1]), within=0.1,
          saw=f"With 80 steps the angle errs by {turned[1]:.1e} rad.")
    angle, dt, k = 0.3, 0.01, 20
    n, along = np.array([-np.sin(angle), np.cos(angle)]), np.array([np.cos(angle), np.sin(angle)])
    slope = model.Body((0.0, 0.0), shape=shapes.HalfSpace(tuple(n)), mu=1.0, e=1.0)
    a, beside = 9.81 * np.sin(angle) / 1.5, model.Body((0.0, 9.0), 1.0, shapes.Box((0.1, 0.1)))
    for number, more in enumerate(((), (beside,))):
        end = composed_run(lesson, [ball(tuple(0.1 * n), mu=0.5), slope, *more], DOWN, (), dt, k)
        check.agree("A composed disc rolls down a slope at ⅔ g sin θ, also in a scene with other shapes.",
                    f"{number} boxes in the air: error of its way, speed and angle [m, m/s, rad]",
                    np.max(np.abs((end.x[0] @ along + 0.5 * k * (k + 1) * a * dt * dt, end.v[0] @ along + k * a * dt,
                                   end.q[0] - 5.0 * k * (k + 1) * a * dt * dt))), EXACT)
    for joints in ((), [model.Hinge(0, 1, (0.25, 0.13))]):
        end = composed_run(lesson, (*MANY, FLOOR), DOWN, joints, dt, 30)
        heights = np.append(np.full(8, 0.1), 0.3)
        check.agree("Nine discs that fall come to rest, one of them on another, also if a hinge joins two.",
                    f"{len(joints)} joints: error of the heights, and velocities [m, m/s]",
                    max(np.max(np.abs(end.x[:9, 1] - heights)), np.max(np.abs(end.v))), EXACT)


def composed_in_space(lesson, check):
    """Roll a ball down the upper face of a solid that nothing moves, and turn a body that is driven."""
    angle, dt, k, tilt = 0.3, 0.01, 20, (np.cos(0.15), 0.0, np.sin(0.15), 0.0)
    n, along = np.array([np.sin(angle), 0.0, np.cos(angle)]), np.array([np.cos(angle), 0.0, -np.sin(angle)])
    corners = tuple((x, y, z) for x in (-2.0, 2.0) for y in (-1.0, 1.0) for z in (-0.5, 0.5))
    slope = model.Body((0.0, 0.0, 0.0), shape=shapes.Polyhedron(corners), mu=1.0, q=tilt)
    bodies = [model.Body(tuple(0.6 * n), 1.0, shapes.Ball(0.1), mu=0.5), slope]
    end, a = composed_run(lesson, bodies, (0.0, *DOWN), (), dt, k), 9.81 * np.sin(angle) / 1.4
    check.agree("A composed ball rolls down the face of a solid at 5/7 g sin θ.", "error of its way and speed [m, m/s]",
                np.max(np.abs((end.x[0] @ along - 0.5 * k * (k + 1) * a * dt * dt, end.v[0] @ along - k * a * dt))),
                EXACT)
    spin, q = np.array([0.3, -0.7, 0.5]), np.array([0.5, -0.5, 0.5, 0.5])
    driven = model.Body((0.0, 0.0, 0.0), q=tuple(q), omega=tuple(spin))
    rate, turn = np.linalg.norm(spin), rotations(composed_run(lesson, [driven], (0.0, *DOWN), (), dt, k).q)[0]
    check.agree("A body that is driven turns about its ω.", "error of its rotation [-]",
                np.max(np.abs(turn - turned_by(2.0 * np.tan(0.5 * rate * k * dt) / rate * spin, 1.0) @ matrix_of(q))),
                EXACT)


def fast_ball(lesson, check):
    """Throw a ball at a wall so fast that its step is divided where they touch, under a force along the wall.

    The ball touches after the share s of the step.  Each part of the step takes the force k t at its own beginning.
    """
    speed, dt, t, k, gap = 30.0, 0.05, 0.7, 2.0, 0.6
    share = gap / (speed * dt)
    wall = model.Body((0.0, 0.0), shape=shapes.HalfSpace((1.0, 0.0)), e=1.0)
    push = lambda t, x, q, v, omega: (np.array([(0.0, k * t), (0.0, 0.0)]), np.zeros(2))
    end = composed_run(lesson, [ball((0.1 + gap, 0.0), v=(-speed, 0.0), e=1.0), wall], (0.0, 0.0), (), dt, 1, t=t,
                       loads=[push])
    rises = k * dt * np.array([share * t, (1.0 - share) * (t + share * dt)])
    check.agree("A divided step takes each part of it with the load of its own time.",
                "a fast ball at a wall: error of its place and velocity [m, m/s]",
                np.max(np.abs((*(end.v[0] - (speed, np.sum(rises))), end.x[0, 0] - 0.1 - speed * dt * (1.0 - share),
                               end.x[0, 1] - share * dt * rises[0] - (1.0 - share) * dt * np.sum(rises)))), EXACT)


def joined_motions(lesson, check):
    """Let a weld and a hinge fly, and a hinged pair fall on a floor."""
    pair = [model.Body((0.0, 1.0), 1.0, omega=2.0, inertia=0.1), model.Body((0.6, 1.2), 2.0, v=(0.3, 1.0), inertia=0.2)]
    m, I, place, dt = np.array([1.0, 2.0]), np.array([0.1, 0.2]), (0.3, 1.0), 0.01
    L = lambda s: np.sum(m * (s.x[:, 0] * s.v[:, 1] - s.x[:, 1] * s.v[:, 0]) + I * s.omega)
    begin = model.start_of(model.make_model(pair, (0.0, 0.0)))
    for joint in (model.Hinge(0, 1, place), model.Weld(0, 1, place)):
        end = composed_run(lesson, pair, (0.0, 0.0), [joint], dt, 20)
        R = rotations(end.q)[:, :2, :2]
        gap = end.x[0] + R[0] @ (np.array(place) - begin.x[0]) - end.x[1] - R[1] @ (np.array(place) - begin.x[1])
        turned = end.q[0] - end.q[1] if isinstance(joint, model.Weld) else 0.0
        check.agree("Joined bodies keep both momenta in flight, a hinge its place, and a weld the angle between them.",
                    f"{type(joint).__name__}: error of momenta, place and angle [kg m/s, kg m²/s, m, rad]",
                    np.max(np.abs([*(m @ end.v - m @ begin.v), L(end) - L(begin), *gap, turned])), EXACT)
    end = composed_run(lesson, [ball((0.0, 0.1), mu=0.5), ball((0.6, 0.1), mu=0.5), FLOOR], DOWN,
                       [model.Hinge(0, 1, (0.3, 0.1))], dt, 20)
    check.agree("Two joined discs stay at rest on a floor.", "error of places and velocities [m, m/s]",
                np.max(np.abs([*(end.x[:2] - [(0.0, 0.1), (0.6, 0.1)]).ravel(), *end.v.ravel()])), EXACT)


# ---------------------------------------------------------------------------------------------- contacts of solids

REACH = 0.06                 # gap up to which contacts are found [m]
CLEAR = 0.01                 # by which the way out of a solid is shorter than all others [m]
SIGNS = np.array(list(product((-1.0, 1.0), repeat=3)))


class Solid(SimpleNamespace):
    """A shape, its radius [m], and its core: all sums of its edges (k, 3) [m], each times a number from −1 to 1.

    It has a place x and axes R in the world.
    """

    def body(self):
        return model.Body(tuple(self.x), 1.0, self.shape, q=tuple(self.q))

    def corners(self):
        """Return the corners of the core in the world."""
        signs = np.array(list(product((-1.0, 1.0), repeat=len(self.edges))))
        return self.x + signs @ self.edges @ self.R.T


def solid(rng, kind, size=1.0):
    """Return a Solid of this kind in a random place; a polyhedron has the corners of a box."""
    (a, b, c), r, x = size * rng.uniform(0.4, 0.8, 3), size * rng.uniform(0.1, 0.3), rng.normal(size=3)
    q = random_quaternions(rng, 1)[0]
    shape, edges, radius = {
        "ball": (shapes.Ball(r), np.zeros((0, 3)), r), "capsule": (shapes.Capsule(a, r), np.array([(a, 0.0, 0.0)]), r),
        "box": (shapes.Box((a, b, c)), np.diag((a, b, c)), 0.0),
        "polyhedron": (shapes.Polyhedron(tuple(map(tuple, SIGNS * (a, b, c)))), np.diag((a, b, c)), 0.0)}[kind]
    return Solid(shape=shape, edges=edges, radius=radius, q=q, x=x, R=matrix_of(q))


def contacts_of(lesson, bodies):
    """Return (rows (a, b, normal, place, gap), corners low and high of the boxes around the bodies), by a loop."""
    loop = lesson.compose(model.make_model(bodies, (0.0,) * len(bodies[0].x)))
    x, q, p = loop.state.x, loop.state.q, loop.p
    low, high, turn = loop.bounds(x, q, p.half)
    c = loop.narrow(x, turn, p.half, p.planes, p.pairs, REACH)
    assert np.array_equal(c.first, np.searchsorted(c.a, np.arange(len(c.first))))
    return np.column_stack((c.a, c.b, c.n, c.p, c.gap)), low, high


def nearest(rows):
    """Return the row of the smallest gap."""
    return rows[np.argmin(rows[:, -1])] if len(rows) else np.full(9, np.nan)


ONE_PAIR = Pairs(np.array([0, 1, 1]), np.array([1]))
ROUND = [("ball", "capsule"), ("capsule", "capsule"), ("capsule", "box"), ("ball", "box"), ("ball", "polyhedron"),
         ("capsule", "polyhedron")]


@random_law("Round solids that are apart touch halfway between the nearest points of their surfaces.",
            "solids apart: largest error of the nearest contact [-, m]", 1e-8)
def solids_apart(lesson, rng):
    """Find the nearest points by bounded least squares, far apart, and then move the second solid nearer.

    The way between them is across an edge of one core, so that the middle of a segment is often the nearest part.
    """
    kinds = rng.permutation(ROUND[rng.integers(len(ROUND))])
    a, b = (solid(rng, kind) for kind in kinds)
    apart = np.cross((a, b)[rng.integers(2)].R[:, 0], rng.normal(size=3))
    b.x = a.x + 5.0 * apart / np.linalg.norm(apart)
    spans = np.concatenate((a.edges @ a.R.T, -b.edges @ b.R.T)).T
    found = lsq_linear(spans, b.x - a.x, (-1.0, 1.0), method="bvls", tol=1e-14).x
    p, way = a.x + spans[:, :len(a.edges)] @ found[:len(a.edges)], spans @ found - (b.x - a.x)
    n, gap = way / np.linalg.norm(way), rng.uniform(0.005, 0.05)
    b.x = b.x + (np.linalg.norm(way) - a.radius - b.radius - gap) * n
    rows, _, _ = contacts_of(lesson, [a.body(), b.body()])
    return nearest(rows), np.array((0.0, 1.0, *n, *(p - (a.radius + 0.5 * gap) * n), gap))


@random_law("A ball or a capsule inside a solid leaves it by the shortest way, through a face or over an edge.",
            "inside a solid: largest error of the deepest contact [-, m]", EXACT)
def inside_a_solid(lesson, rng):
    """Of all directions in which the two can be separated, take the one in which the least is missing."""
    over_an_edge, round_one = rng.integers(2), rng.choice(("ball", "capsule"))
    while True:
        outer = solid(rng, rng.choice(("box", "polyhedron")))
        inner = solid(rng, "capsule" if over_an_edge else round_one, 0.3)
        half, u = np.diag(outer.edges), outer.R.T @ (inner.edges @ inner.R.T).sum(axis=0)
        y, axes = rng.uniform(-1.0, 1.0, 3) * half, [*np.eye(3)]
        axes += [np.cross(u, one) / np.linalg.norm(np.cross(u, one)) for one in np.eye(3) if np.any(u)]
        axes = [np.where(axis @ y < 0.0, -1.0, 1.0) * axis for axis in axes]
        gaps = np.array([axis @ y - np.abs(axis) @ half - abs(axis @ u) for axis in axes])
        best, second = np.argsort(gaps)[:-3:-1]
        if (best > 2) == over_an_edge and gaps[best] > gaps[second] + CLEAR and np.all(np.abs(y) + np.abs(u) < half):
            break
    n, gap = axes[best], gaps[best] - inner.radius
    end = y - np.sign(n @ u) * u
    if best > 2:                                                         # where the lines of u and of the edge cross
        edge = np.eye(3)[best - 3]
        end = y + np.linalg.lstsq(np.stack((u, -edge), axis=1), np.sign(n) * half + gaps[best] * n - y)[0][0] * u
    inner.x = outer.x + outer.R @ y
    rows, _, _ = contacts_of(lesson, [outer.body(), inner.body()])
    place = outer.x + outer.R @ (end - (inner.radius + 0.5 * gap) * n)
    return nearest(rows), np.array((0.0, 1.0, *(-outer.R @ n), *place, gap))


@random_law("A solid touches a plane with each corner of its core that reaches it, and fills the box around it.",
            "solid on a plane: largest error of the contacts and bounds [-, m]", EXACT)
def solids_on_planes(lesson, rng):
    one, n = solid(rng, rng.choice(("ball", "capsule", "box", "polyhedron"))), rng.normal(size=3)
    n /= np.linalg.norm(n)
    one.x = one.x + (rng.uniform(-0.4, 0.05) + one.radius - np.min(one.corners() @ n)) * n
    floor, corners = model.Body((0.0, 0.0, 0.0), shape=shapes.HalfSpace(tuple(n))), one.corners()
    gaps = corners @ n - one.radius
    truth = [(0.0, 1.0, *n, *(corner - (one.radius + 0.5 * gap) * n), gap)
             for corner, gap in zip(corners, gaps, strict=True) if gap <= REACH]
    beside = solid(rng, "polyhedron")                                    # in half of the cases, and touches nothing
    beside.x = one.x + 9.0 * n
    rows, low, high = contacts_of(lesson, [one.body(), *[beside.body()] * rng.integers(2), floor])
    rows[:, 1] = np.sign(rows[:, 1])
    return ((*unlike(rows, truth), low[0], high[0]),
            (len(truth), 0.0, np.min(corners, axis=0) - one.radius, np.max(corners, axis=0) + one.radius))


@random_law("A capsule that lies on a face touches it at both ends of the part that is over the face.",
            "capsule on a face: largest error of the contacts [-, m]", EXACT)
def capsule_on_a_face(lesson, rng):
    """Tilt it by half a degree, so that its lower end, which is over the face, is the nearest part."""
    under, one, gap = solid(rng, rng.choice(("box", "polyhedron"))), solid(rng, "capsule"), rng.uniform(-0.05, 0.03)
    half, turn, reach = np.diag(under.edges), rng.uniform(0.0, 2.0 * np.pi), one.shape.half_length
    n, e, f = np.roll(np.eye(3), rng.integers(3), axis=0)
    u = np.cos(0.01) * (np.cos(turn) * e + np.sin(turn) * f) + np.sin(0.01) * n
    lower = (half @ n + one.radius + gap) * n + half * (rng.uniform(-0.7, 0.7) * e + rng.uniform(-0.7, 0.7) * f)
    ways = [(np.sign(axis @ u) * (half @ axis) - axis @ lower) / (axis @ u) for axis in (e, f)]
    one.x, one.q = under.x + under.R @ (lower + reach * u), quaternion_from_matrix(
        under.R @ np.stack((u, np.cross(n, u) / np.cos(0.01), np.cross(u, np.cross(n, u)) / np.cos(0.01)), axis=1))
    truth = []
    for s in (0.0, min(2.0 * reach, *ways)):
        here = gap + s * (n @ u)
        truth.append((0.0, 1.0, *(-under.R @ n), *(under.x + under.R @ (
            lower + s * u - (one.radius + 0.5 * here) * n)), here))
    rows, _, _ = contacts_of(lesson, [under.body(), one.body()])
    return unlike(rows, truth), (2, 0.0)


@random_law("Found are the place of a segment that is nearest to a box, and the part that lies over a face or an edge.",
            "segment and box: largest error of the least squared distance [m²], and of the ends of the part [m]", EXACT)
def segments_over_boxes(lesson, rng):
    """Search for the least distance.  Some segments are parallel to a face or to an edge."""
    half, h, y = rng.uniform(0.3, 1.0, 3), rng.uniform(0.5, 2.0), 1.5 * rng.normal(size=3)
    e = unit(rng) * rng.permutation(((1.0, 1.0, 1.0), (1.0, 1.0, 0.0), (1.0, 0.0, 0.0))[rng.integers(3)])
    e /= np.linalg.norm(e)
    beyond = lambda s: y + s * e - np.clip(y + s * e, -half, half)
    out = beyond(convex_3d.nearest_place(tuple(y), tuple(e), h, half))
    far, ends = rng.choice((0.0, np.max(np.abs(out)))), [(-h, h)]
    for k in range(3):
        if out[k] == 0.0 or abs(out[k]) < far:
            within = sorted(((-half[k] - y[k]) / e[k], (half[k] - y[k]) / e[k])) if e[k] != 0.0 else (-h, h)
            ends.append((1.0, 0.0) if e[k] == 0.0 and out[k] != 0.0 else within)
    parts = (convex_3d.part_over(tuple(y), tuple(e), h, half, tuple(out), far),
             (np.max(ends, axis=0)[0], np.min(ends, axis=0)[1]))
    found, part = ((low, high) if low <= high else (0.0, 0.0) for low, high in parts)
    squared = lambda s: np.sum(beyond(s) ** 2)
    inner = minimize_scalar(squared, bounds=(-h, h), method="bounded", options={"xatol": 1e-12})
    return (np.sum(out**2), *found), (min(inner.fun, squared(-h), squared(h)), *part)


@random_law("Each pair in a cluster of balls that is near enough has one contact, halfway between both surfaces.",
            "cluster of balls: largest error of the contacts [-, m]", EXACT)
def cluster_of_balls(lesson, rng):
    """Put five balls on each other, in the plane or in space, over a floor; a capsule beside them touches nothing."""
    d = rng.choice((2, 3))
    x, radii, n = rng.normal(size=(5, d)), rng.uniform(0.3, 0.8, 5), np.eye(d)[rng.integers(d)]
    floor, far, truth = rng.uniform(0.0, 0.2) - np.min(x @ n - radii), rng.integers(6), []
    bodies = [model.Body(tuple(place), 1.0, shapes.Ball(r)) for place, r in zip(x, radii, strict=True)]
    bodies.insert(far, model.Body((20.0,) * d, 1.0, shapes.Capsule(0.3, 0.1)))
    rows = contacts_of(lesson, [*bodies, model.Body((0.0,) * d, shape=shapes.HalfSpace(tuple(n), floor))])[0]
    for i, j in combinations(range(6), 2):
        way, r = (x[i] - x[j], radii[j]) if j < 5 else ((x[i] @ n + floor) * n, 0.0)
        out, gap = way / np.linalg.norm(way), np.linalg.norm(way) - radii[i] - r
        if gap <= REACH:
            truth.append((i + (i >= far), j + (j >= far), *out, *(x[i] - (radii[i] + 0.5 * gap) * out), gap))
    return unlike(rows, truth), (len(truth), 0.0)


@random_law("Capsules beside each other touch at both ends of the part that they have in common.",
            "capsules side by side: largest error of the contacts [-, m]", EXACT)
def capsules_side_by_side(lesson, rng):
    """Lay one along the other, shifted, in the same or in the other direction, parallel or half a degree off.

    Half a degree off, the lower end of the first lies over the second, so that it is the nearest part.
    """
    (x, y, up), (long, radius), angle = rng.normal(size=(3, 3)), rng.uniform(0.1, 1.0, (2, 2)), rng.choice((0.0, 0.01))
    e, n = np.linalg.qr(np.stack((y, up), axis=1))[0].T
    u, (share, gap) = np.cos(angle) * e + np.sin(angle) * n, rng.uniform((-0.8, -0.05), (0.8, 0.03))
    shift = share * np.sum(long) if angle == 0.0 else long[0] * np.cos(angle) + share * long[1]
    ends = np.array([max(-long[0], (-long[1] - shift) / (u @ e)), min(long[0], (long[1] - shift) / (u @ e))])
    height = np.sum(radius) + gap - ends[0] * np.sin(angle)
    centre = x + shift * e + height * n
    turn = np.array([axes_along(rng.choice((-1.0, 1.0)) * way, rng) for way in (u, e)])
    solids = convex_3d.RoundedBoxes(np.outer(long, (1.0, 0.0, 0.0)), radius, np.ones((2, 3)))
    c = convex_3d.rounded_contacts(np.array([centre, x]), turn, solids, np.zeros((0, 4)), ONE_PAIR, REACH)
    truth = [(*n, *(centre + s * u - (radius[0] + 0.5 * here) * n), here)
             for s, here in zip(ends, gap + (ends - ends[0]) * np.sin(angle), strict=True)]
    return unlike(np.column_stack((c.n, c.p, c.gap)), truth), (2, 0.0)


@random_law("A capsule beside an edge of a box, and along it, touches the edge with both ends.",
            "capsule along an edge: largest error of the contacts [-, m]", EXACT)
def capsule_along_an_edge(lesson, rng):
    """Lay it aslant over the edge, so that it lies over no face, and at times reaches beyond the end of the edge.

    Between the ends of what they have in common may be a third contact.
    """
    half, (long, r, gap, share) = rng.uniform(0.3, 1.0, 3), rng.uniform((0.1, 0.1, -0.05, -0.9), (0.9, 0.3, 0.03, 0.9))
    R, place, aside = rotations(random_quaternions(rng, 1))[0], rng.normal(size=3), rng.uniform(0.2, 0.5 * np.pi - 0.2)
    e, u, w = np.roll(np.eye(3), rng.integers(3), axis=0)
    n, h, shift = np.cos(aside) * u + np.sin(aside) * w, long * half @ e, share * half @ e
    x = np.array([place, place + R @ (half * (1.0 - e) + (r + gap) * n + shift * e)])
    turn, order = np.array([R, axes_along(rng.choice((-1.0, 1.0)) * R @ e, rng)]), rng.permutation(2)
    solids = convex_3d.RoundedBoxes(np.array([half, (h, 0.0, 0.0)])[order], np.array([0.0, r])[order], np.ones((2, 3)))
    c = convex_3d.rounded_contacts(x[order], turn[order], solids, np.zeros((0, 4)), ONE_PAIR, REACH)
    ends = c.p[[np.argmin(c.p @ R @ e), np.argmax(c.p @ R @ e)]]
    truth = [place + R @ (half * (1.0 - e) + np.clip(shift + s, -half @ e, half @ e) * e + 0.5 * gap * n)
             for s in (-h, h)]
    return ((np.ptp(c.n, axis=0), c.n[0], np.ptp(c.gap), c.gap[0], ends),
            (np.zeros(3), R @ n * (1.0 if order[0] else -1.0), 0.0, gap, np.array(truth)))


@random_law("Segments that cross are parted at right angles to both, and balls at one place along any direction.",
            "segments that cross: largest error of the deepest contact [-, m]", EXACT)
def segments_that_cross(lesson, rng):
    """Lay the middles of capsules or balls on each other."""
    x, turn = rng.normal(size=3), rotations(random_quaternions(rng, 2))
    long, radius = rng.integers(0, 2, 2) * rng.uniform(1.0, 2.0, 2), rng.uniform(0.1, 0.2, 2)
    solids = convex_3d.RoundedBoxes(np.outer(long, (1.0, 0.0, 0.0)), radius, np.ones((2, 3)))
    c = convex_3d.rounded_contacts(np.array([x, x]), turn, solids, np.zeros((0, 4)), ONE_PAIR, REACH)
    k = np.argmin(c.gap)
    return ((c.n[k] @ c.n[k], (c.n[k] @ turn[:, :, 0].T) * long, c.p[k] - 0.5 * (radius[1] - radius[0]) * c.n[k],
             c.gap[k]), (1.0, np.zeros(2), x, -np.sum(radius)))


@random_law("A pair touches where one of its contacts has at most a given gap.",
            "pairs that touch: wrong answers [-]", 0.0)
def pairs_that_touch(lesson, rng):
    """Try three pairs and four contacts, some of which belong to other pairs."""
    pairs = Pairs(np.array([0, 2, 3, 3]), np.array([1, 2, 2]))
    a, b, gap = rng.integers(0, 2, 4), rng.integers(1, 3, 4), rng.choice((0.01, 0.03), 4)
    found = [dividing.touches(SimpleNamespace(a=a, b=b, gap=gap), pairs, s, 0.02) for s in range(3)]
    return (np.array(found, float),
            np.array([np.any((a == i) & (b == j) & (gap < 0.02)) for i, j in ((0, 1), (0, 2), (1, 2))], float))


@random_law("Polyhedra with the corners of boxes that overlap touch as the boxes do.",
            "polyhedra: largest difference from the contacts of boxes [-, m]", EXACT)
def polyhedra_as_boxes(lesson, rng):
    """Let them overlap by three centimetres along one of the 15 axes that can separate them."""
    while True:
        a, b, way = solid(rng, "box"), solid(rng, "box"), rng.normal(size=3)
        axes = np.array([*a.R.T, *b.R.T, *(np.cross(u, w) for u in a.R.T for w in b.R.T)])
        axes /= np.linalg.norm(axes, axis=1)[:, None]
        widths = sum(np.abs(axes @ one.R) @ np.diag(one.edges) for one in (a, b))
        far = np.min((widths - 0.03) / np.abs(axes @ way))
        second, best = np.sort(np.abs(axes @ way) * far - widths)[-2:]
        if second < best - CLEAR:
            break
    b.x, found = a.x + far * way, []
    for kind in ("box", "polyhedron"):
        for one in (a, b):
            one.shape = shapes.Box(tuple(np.diag(one.edges))) if kind == "box" else shapes.Polyhedron(
                tuple(map(tuple, SIGNS * np.diag(one.edges))))
        found.append(contacts_of(lesson, [a.body(), b.body()])[0])
    return unlike(*found[::-1]), (len(found[0]), 0.0)


def axes_along(first, rng):
    """Return right-handed axes (3, 3), as columns, of which the first one points along `first`."""
    u, across = first / np.linalg.norm(first), np.cross(first, rng.normal(size=3))
    w = across / np.linalg.norm(across)
    return np.stack((u, w, np.cross(u, w)), axis=1)


@random_law("Two polyhedra that point at each other touch halfway between their nearest corners.",
            "corner to corner: largest error of the contact [-, m]", 1e-8)
def corner_to_corner(lesson, rng):
    """Let a corner of each look along n at the other's, within a few degrees of the diagonal of a cube.

    So no part of one solid is over a face of the other.
    """
    n, gap, bodies = axes_along(rng.normal(size=3), rng)[:, 0], rng.uniform(0.02, 0.05), []
    for sign, place in ((1.0, 0.0 * n), (-1.0, gap * n)):
        corner, half = rng.choice((-1.0, 1.0), 3), rng.uniform(0.4, 0.8, 3)
        R = axes_along(sign * n, rng) @ axes_along(corner + 0.1 * rng.normal(size=3), rng).T
        bodies.append(model.Body(tuple(place - R @ (corner * half)), 1.0, shapes.Polyhedron(
            tuple(map(tuple, SIGNS * half))), q=tuple(quaternion_from_matrix(R))))
    return nearest(contacts_of(lesson, bodies)[0]), np.array((0.0, 1.0, *-n, *(0.5 * gap * n), gap))


@case("contacts-of-solids", "Contacts of round solids and polyhedra in space", compiled=False, in_quick=False)
def contacts_of_solids(lesson, check):
    """Compare contacts in a composed loop with nearest points, shortest ways out, and corners.

    Each solid is a core, the sum of some edges, with a radius: a point, a segment, or a box, which is also tried as a
    polyhedron.
    """
    check.laws(lesson, (solids_apart, inside_a_solid, solids_on_planes, capsule_on_a_face, segments_over_boxes,
                        pairs_that_touch, polyhedra_as_boxes, corner_to_corner, cluster_of_balls,
                        segments_that_cross, capsules_side_by_side, capsule_along_an_edge), seed=38, times=20)


# ---------------------------------------------------------------------------------------------- shapes, links, ways

@random_law("Solids of places in space have the centre and the tensor of the tetrahedra that they are made of.",
            "solid of places: largest error of its corners, centre and tensor [-, m, kg m²]", EXACT)
def solids_of_places(lesson, rng):
    """Take two tetrahedra with a common face, and places inside them, which do not count.

    A tetrahedron with corners v has its centre at their mean, and the mean of (x − centre) (x − centre)ᵀ is
    Σ (v − centre) (v − centre)ᵀ/20.
    """
    face, way, (up, down) = rng.normal(size=(3, 3)), rng.normal(size=3), rng.uniform(0.5, 2.0, 2)
    under = rng.dirichlet((3.0, 3.0, 3.0)) @ face
    corners = np.array([*face, under + up * way, under - down * way])
    solid, x, q = shapes.polyhedron_of(np.concatenate((corners, rng.dirichlet(np.full(5, 3.0), 4) @ corners)))
    parts = corners[:4], corners[[0, 1, 2, 4]]
    shares = np.abs([np.linalg.det(part[1:] - part[0]) for part in parts])
    shares, centres = shares / np.sum(shares), np.mean(parts, axis=1)
    centre, spread = shares @ centres, np.zeros((3, 3))
    for share, middle, part in zip(shares, centres, parts, strict=True):
        spread += share * ((part - middle).T @ (part - middle) / 20.0 + np.outer(middle - centre, middle - centre))
    R = matrix_of(q)
    return ((*unlike(x + np.array(solid.corners) @ R.T, corners), x,
             R @ np.diag(shapes.moments_of_shape(solid, 2.0, 3)) @ R.T),
            (5, 0.0, centre, 2.0 * (np.trace(spread) * np.eye(3) - spread)))


@random_law("The half sizes of a shape hold all of it, and the least one is its thickness: that of the largest ball "
            "inside.", "half sizes: largest error [m]", EXACT)
def half_sizes(lesson, rng):
    """The centre of a triangle or of a tetrahedron is at a third or a quarter of its heights, so over its longest side
    or largest face it is 2 A/(3 side), or 3 V/(4 A).
    """
    found, truth = [], []
    for d in (2, 3):
        h, r = rng.uniform(0.2, 1.0, 2)
        half, places = rng.uniform(0.2, 1.0, d), rng.normal(size=(d + 1, d))
        sides = places[1:] - places[0]
        if np.linalg.det(sides) < 0.0:
            places = places[::-1]
        places = places - np.mean(places, axis=0)
        faces = [np.delete(places, k, axis=0) for k in range(d + 1)]
        sizes = [np.sqrt(np.linalg.det((one[1:] - one[0]) @ (one[1:] - one[0]).T)) for one in faces]     # (d − 1)! A
        pointed = shapes.Polygon(tuple(map(tuple, places))) if d == 2 else shapes.polyhedron_of(places)[0]
        bodies = [model.Body((4.0 * k,) * d, 1.0, shape) for k, shape in enumerate(
            (shapes.Ball(r), shapes.Box(tuple(half)), shapes.Capsule(h, r), pointed))]
        loop, inside = lesson.compose(model.make_model(bodies, (0.0,) * d)), abs(np.linalg.det(sides)) / np.max(sizes)
        found.append(loop.p.half.half)
        truth.append([(r,) * d, half, (h + r, *(r,) * (d - 1)),
                      (np.max(np.linalg.norm(places, axis=1)), *(inside / (d + 1.0),) * (d - 1))])
    return tuple(found), tuple(map(np.array, truth))


def linked(rng, kind, apart):
    """Return (bodies, joint) of two bodies in space, with centres up to `apart` [m] from the joint's place."""
    place, axis = rng.normal(size=(2, 3))
    bodies = [tumbling(rng, 3)._replace(x=tuple(place + apart * rng.normal(size=3))) for _ in range(2)]
    axis /= np.linalg.norm(axis)
    joint = {"BallJoint": model.BallJoint(0, 1, tuple(place)), "Weld": model.Weld(0, 1, tuple(place)),
             "Hinge": model.Hinge(0, 1, tuple(place), tuple(axis))}[kind]
    return bodies, joint


@random_law("In space a joint of a Model keeps its place on both bodies and both momenta, a hinge its axis, and a weld "
            "all of their rotation.", "joints of a Model: largest error [m, -, kg m/s, kg m²/s]", EXACT)
def links_keep(lesson, rng):
    kind = rng.choice(("BallJoint", "Hinge", "Weld"))
    bodies, joint = linked(rng, kind, 0.4)
    loop = lesson.compose(model.make_model(bodies, (0.0, 0.0, 0.0), [joint]))
    after = lesson.run_parts(loop, 0.0, loop.state, 0.01, 3)
    begin, end = (lesson.state_of(loop, state) for state in (loop.state, after))
    R, turned = rotations(begin.q), rotations(end.q)
    own = [R[i].T @ (np.array(joint.place) - begin.x[i]) for i in (0, 1)]
    held = {"BallJoint": np.zeros((3, 0)), "Weld": np.eye(3),
            "Hinge": np.reshape(getattr(joint, "axis", (0.0, 0.0, 0.0)), (3, 1))}[kind]
    moved = [turned[i] @ R[i].T @ held for i in (0, 1)]
    return ((end.x[0] + turned[0] @ own[0], moved[0], *momenta_of(*after[:4], loop.p)),
            (end.x[1] + turned[1] @ own[1], moved[1], *momenta_of(*loop.state[:4], loop.p)))


@random_law("Bodies with their centres at one joint share the part of their spins that it holds: none at a ball joint, "
            "all in a weld, and what is across the axis of a hinge.",
            "spins at a joint of a Model: largest error [rad/s]", EXACT)
def links_share(lesson, rng):
    """What they share is Σ I ω/Σ I, for the same moment I about all axes.  A hinge has spins along or across it."""
    kind, across = rng.choice(("BallJoint", "Hinge", "Weld")), rng.integers(2)
    bodies, joint = linked(rng, kind, 0.0)
    moments, spins = rng.uniform(0.2, 0.5, 2), rng.normal(size=(2, 3))
    if kind == "Hinge":
        along = np.outer(spins @ joint.axis, joint.axis)
        spins = spins - along if across else along
    bodies = [body._replace(inertia=(float(moment),) * 3, omega=tuple(spin), v=(0.1, 0.2, 0.3))
              for body, moment, spin in zip(bodies, moments, spins, strict=True)]
    loop = lesson.compose(model.make_model(bodies, (0.0, 0.0, 0.0), [joint]))
    end = lesson.state_of(loop, lesson.run_parts(loop, 0.0, loop.state, 0.01, 2))
    shares = kind == "Weld" or (kind == "Hinge" and across)
    return end.omega, np.tile(moments @ spins / np.sum(moments), (2, 1)) if shares else spins


@random_law("A loop with joints takes half of the load at both ends of a step.",
            "torque on a jointed body of a Model: largest error of its spin [rad/s]", EXACT)
def loads_at_both_ends(lesson, rng):
    """Hold a body at its centre, and turn it by the torque τ sin t for some steps."""
    d, dt, moment, place = rng.choice((2, 3)), 0.1, rng.uniform(0.2, 0.5), rng.normal(size=3)
    tau, x = rng.normal(size=1 if d == 2 else (1, 3)), tuple(place[:d])
    joint = model.Hinge(0, model.WORLD, x) if d == 2 else model.BallJoint(0, model.WORLD, x)
    body = model.Body(x, 1.0, inertia=float(moment) if d == 2 else (float(moment),) * 3)
    twist = lambda t, x, q, v, omega: (0.0 * x, np.sin(t) * tau)
    loop = lesson.compose(model.make_model([body], (0.0,) * d, [joint], loads=[twist]))
    end = lesson.state_of(loop, lesson.run_parts(loop, 0.3, loop.state, dt, 3))
    times = 0.3 + dt * np.arange(4)
    return end.omega, 0.5 * dt * np.sum(np.sin(times[:-1]) + np.sin(times[1:])) * tau / moment


@random_law("A step is divided where fast bodies touch, or where those that overlap do so by a quarter of the smaller "
            "radius more.", "share of a step at which balls touch: largest error [-]", EXACT)
def share_of_a_touch(lesson, rng):
    """Let two balls pass each other at a distance, or a ball fly into a plane; u is its way in the step as seen there.

    They touch where |x + s u| is the sum of the radii, or, for those that overlap, less a quarter of the smaller one.
    """
    d, plane, overlap = rng.choice((2, 3)), rng.integers(2), rng.choice((0.0, 0.1))
    radii, (n, aside) = rng.uniform(0.1, 3.0, 2), np.linalg.qr(rng.normal(size=(d, 2)))[0].T
    least = np.min(radii[:1] if plane else radii)
    far = radii[0] if plane else np.sum(radii)
    beside = 0.0 if plane else rng.uniform(0.0, far - 1.2 * least)
    begin = np.sqrt((far - overlap * least) ** 2 - beside**2) + (rng.uniform(0.1, 2.0) if overlap == 0.0 else 0.0)
    touch = begin - np.sqrt((far - (overlap + 0.25) * least if overlap else far) ** 2 - beside**2)
    way, drift = begin + 0.2 * least + rng.uniform(0.0, 2.0), rng.normal(size=d)
    other = model.Body((0.0,) * d, shape=shapes.HalfSpace(tuple(n))) if plane else model.Body(
        (0.0,) * d, 1.0, shapes.Ball(radii[1]))
    loop = lesson.compose(model.make_model(
        [model.Body(tuple(begin * n + beside * aside), 1.0, shapes.Ball(radii[0])), other], (0.0,) * d))
    moves = np.zeros(loop.state.x.shape)
    moves[loop.row] = (drift - (drift @ n + way) * n, 0.0 * n) if plane else (drift - way * n, drift)
    after = loop.state._replace(x=loop.state.x + moves, v=moves / 0.1)
    return loop.touch(loop.bounds, loop.narrow, loop.state, after, 0.1, loop.p), touch / way


@random_law("A step is divided where the end of a bar that turns beside a plane touches it.",
            "share of a step at which a bar touches: largest error [-]", EXACT)
def share_of_a_turn(lesson, rng):
    """Turn a bar about its centre, at a height h over a plane that it is parallel to at first:  a sin θ + b cos θ = h.

    In a step the angle grows evenly, in the plane and in space.
    """
    d, dt, (a, b), wide = rng.choice((2, 3)), 0.1, rng.uniform((0.8, 0.2), (1.2, 0.3)), rng.uniform(0.4, 0.8)
    h, turn, side = rng.uniform(1.5 * b, a - b), rng.uniform(0.5, 0.8) * np.pi, rng.choice((-1.0, 1.0))
    q = rng.normal() if d == 2 else random_quaternions(rng, 1)[0]
    R = rotations([q])[0]
    n = R[:2, 1] if d == 2 else R[:, 2]
    bar = shapes.Box((a, b) if d == 2 else (a, wide, b))
    loop = lesson.compose(model.make_model([
        model.Body(tuple(h * n), 1.0, bar, q=q if d == 2 else tuple(q)),
        model.Body((0.0,) * d, shape=shapes.HalfSpace(tuple(n)))], (0.0,) * d))
    now, omega = loop.state.q.copy(), loop.state.omega.copy()
    omega[0] = side * turn * (1.0 if d == 2 else R[:, 1]) / dt
    now[0] = q + dt * omega[0] if d == 2 else quaternion_from_matrix(
        Rotation.from_rotvec(dt * omega[0]).as_matrix() @ R)
    share = loop.touch(loop.bounds, loop.narrow, loop.state, loop.state._replace(q=now, omega=omega), dt, loop.p)
    touch = np.arcsin(h / np.hypot(a, b)) - np.arctan2(b, a)
    return share, touch / turn


@random_law("A step is tested where the way and the turn of a body may take a point farther than half of the smallest "
            "half size, and not where they are less than 0.35 of it.", "steps that are tested: wrong answers [-]", 0.0)
def steps_that_are_tested(lesson, rng):
    """Share a way between the motion of the centre and a turn of the farthest point about it."""
    d, dt, i = rng.choice((2, 3)), 0.1, rng.integers(3)
    state = random_bodies(lesson, rng, d, 3)[0]
    half, share, n = rng.uniform(0.1, 0.5, (3, d)), rng.choice((0.0, rng.uniform(), 1.0)), rng.normal(size=d)
    found = []
    for way in (0.35, 0.505):
        way *= np.min(half)
        x, omega, turn = state.x.copy(), 0.0 * state.omega, (1.0 - share) * way / np.linalg.norm(half[i])
        x[i] += share * way * n / np.linalg.norm(n)
        omega[i] = turn / dt * (1.0 if d == 2 else unit(rng))
        q = state.q + dt * omega if d == 2 else state.q
        found.append(passing.may_pass(state, state._replace(x=x, q=q, omega=omega), dt, half))
    return np.array(found, float), np.array([0.0, 1.0])


@random_law("The box around the way of a body has room for it at both ends, and for points that turn between them.",
            "boxes around ways: largest error of their sides and of the ways of points [m]", EXACT)
def boxes_around_ways(lesson, rng):
    """Turn bodies a little and by more than a whole turn: R (1 − cos ½φ) and 2 R.  Half of them look round."""
    d, dt, n = rng.choice((2, 3)), rng.uniform(0.01, 0.1), 8
    state, (angle, side, seen) = random_bodies(lesson, rng, d, n)[0], np.array(list(product(
        (0.01, 7.0), (-1.0, 1.0), (0.0, 1.0)))).T
    omega = side * angle / dt if d == 2 else (side * angle / dt)[:, None] * [unit(rng) for _ in range(n)]
    half, (begin, end) = rng.uniform(0.1, 1.0, (n, d)), rng.normal(size=(2, n, d))
    turn = rng.normal(size=(n, d, d))
    sides = [(begin - half, begin + half, turn), (end - half, end + half, turn + seen[:, None, None])]
    after = state._replace(q=state.q + dt * omega if d == 2 else state.q, omega=omega)
    found = passing.swept_boxes(state, after, *sides, dt, half)
    R = seen * np.linalg.norm(half, axis=1)
    bulge = R * np.where(angle < 1.0, 1.0 - np.cos(0.5 * angle), 2.0)
    return found, (np.minimum(begin, end) - half - bulge[:, None], np.maximum(begin, end) + half + bulge[:, None],
                   R * angle, bulge)


@random_law("A pair overlaps as deeply as its deepest contact, and keeps the normal with which it met.",
            "kept overlaps: largest error of overlaps and normals [m, -]", 0.0)
def kept_overlaps(lesson, rng):
    """Try three pairs, which overlap already or do not, and six contacts, some of which belong to other pairs."""
    d, pairs = rng.choice((2, 3)), Pairs(np.array([0, 2, 3, 3]), np.array([1, 2, 2]))
    overlap, normal, n = rng.choice((0.0, 0.05), 3), rng.normal(size=(3, d)), rng.normal(size=(6, d))
    a, b, gap = rng.integers(0, 2, 6), rng.integers(1, 4, 6), -rng.uniform(0.01, 0.1, 6)
    truth = overlap.copy(), normal.copy()
    for s, (i, j) in enumerate(((0, 1), (0, 2), (1, 2))):
        mine = np.flatnonzero((a == i) & (b == j))
        if overlap[s] == 0.0 and len(mine):
            truth[1][s] = n[mine[0]]
        truth[0][s] = max([overlap[s], *-gap[mine]])
    passing.keep_overlaps(overlap, normal, pairs, SimpleNamespace(a=a, b=b, gap=gap, n=n))
    return (overlap, normal), truth


@random_law("In every direction a shape reaches as far as its core and its radius.",
            "cores of shapes: largest error of their reach [m]", EXACT)
def reach_of_shapes(lesson, rng):
    """Try discs, capsules and boxes in many directions."""
    h, r, a, b = rng.uniform(0.2, 1.0, 4)
    turns = rng.uniform(0.0, 2.0 * np.pi, 16)
    n = np.stack((np.cos(turns), np.sin(turns)))
    cores = [shapes.core_of(shape) for shape in (shapes.Ball(r), shapes.Capsule(h, r), shapes.Box((a, b)))]
    return (tuple(np.max(corners @ n, axis=0) + radius for corners, radius in cores),
            (np.full(16, r), h * np.abs(n[0]) + r, a * np.abs(n[0]) + b * np.abs(n[1])))


@random_law("A push at the corner of a box meets a quarter of its mass.",
            "boxes of several masses: largest error of the ratio of the heaviest to the lightest end [-]", EXACT)
def lightest_ends(lesson, rng):
    """In the plane I = ⅓ m r² for the half diagonal r, and in space about each axis for the part of r across it."""
    d, m = rng.choice((2, 3)), rng.uniform(0.1, 10.0, 4)
    bodies = [model.Body((0.0,) * d, mass, shapes.Box(tuple(rng.uniform(0.1, 1.0, d)))) for mass in m]
    made = model.make_model([*bodies, model.Body((0.0,) * d, shape=shapes.HalfSpace(tuple(np.eye(d)[0])))], (0.0,) * d)
    return rows_of_bodies.difference(made.bodies, d), 4.0 * np.max(m) / np.min(m)


@random_law("Two bodies share a joint where one holds both, in either order; without joints none do.",
            "bodies that share a joint: wrong answers [-]", 0.0)
def bodies_that_share_a_joint(lesson, rng):
    """Try all pairs of five bodies."""
    pairs = [tuple(rng.permutation(5)[:2]) for _ in range(rng.integers(0, 4))]
    a, b = np.array(pairs, int).reshape(-1, 2).T
    found = [(passing.share_a_joint(SimpleNamespace(a=a, b=b), i, j), passing.share_a_joint(None, i, j))
             for i, j in combinations(range(5), 2)]
    return np.array(found, float), np.array([({i, j} in map(set, pairs), 0.0) for i, j in combinations(range(5), 2)])


@random_law("Two bodies may touch where their boxes meet and an impulse moves or turns one of both.",
            "bodies that may touch: wrong answers [-]", 0.0)
def bodies_that_may_touch(lesson, rng):
    """Try two of four boxes, and a box and one of two planes, with all that can hold them; other bodies are free.

    In space a body that turns does so about one axis only.
    """
    d, found, truth = rng.choice((2, 3)), [], []
    for near, plane, *free in product((False, True), repeat=6):
        i, j = np.sort(rng.permutation(4)[:2])
        j, n, low = 4 + rng.integers(2) if plane else j, unit(rng)[:d], np.outer(3.0 * np.arange(4), np.ones(d))
        if near and not plane:
            low[j] = low[i] + 0.9 * rng.choice((-1.0, 1.0), d)
        offsets = np.where((np.arange(2) == j - 4) == near, -0.1, 0.1) - np.sum(np.minimum(n, 0.0)) - low[i] @ n
        record = SimpleNamespace(half=np.ones((4, d)), inv_mass=np.ones(6), inv_inertia=np.ones((6, d)[:d - 1]),
                                 planes=np.column_stack((np.tile(n, (2, 1)), offsets)))
        record.inv_mass[[i, j]] = free[:2]
        for body, turns in zip((i, j), free[2:], strict=True):
            record.inv_inertia[body] = turns if d == 2 else turns * np.eye(3)[rng.integers(3)]
        found.append(passing.may_touch(low, low + 1.0, i, j, record))
        truth.append(near and any(free))
    return np.array(found, float), np.array(truth, float)


@random_law("In space a fifth of each overlap beyond the slop goes per step; a body that turns for it takes its spin "
            "along.", "overlap in space: largest error of places, turns and velocities [m, -, m/s, rad/s]", EXACT)
def overlap_goes_in_space(lesson, rng):
    """Let a single contact overlap by more or by less than the slop.

    J = away/(dt k_n) along n, with k_n = Σ 1/m + n · (I⁻¹ (r × n)) × r, moves and turns both bodies for dt.  They
    turn as free bodies do, for which joints are closed.
    """
    state, p = random_bodies(lesson, rng, 3, 3)
    slop, dt, (n, place) = 0.02, rng.uniform(0.01, 0.1), rng.normal(size=(2, 3))
    n, gap = n / np.linalg.norm(n), -rng.choice((0.5, 3.0)) * slop
    contacts = lesson.ContactSet(np.array([0, 1, 1, 1]), np.array([0]), np.array([2]), n[None], place[None],
                                 np.array([gap]))
    state, away = state._replace(contacts=contacts, J=np.zeros((1, 3))), 0.2 * max(0.0, -gap - slop)
    record = SimpleNamespace(inv_mass=p.inv_mass, inv_inertia=p.inv_inertia, slop=slop, sweeps=200, settled=1e-12,
                             calm=np.inf, half=SimpleNamespace(half=np.ones((3, 3))))
    R, tensor = rotations(state.q), tensors(state.q, p)
    spins = {i: np.linalg.solve(tensor[i], np.cross(place - state.x[i], n)) for i in (0, 2)}
    J = away / dt / sum(p.inv_mass[i] + n @ np.cross(spins[i], place - state.x[i]) for i in (0, 2))
    x, omega, turned = state.x.copy(), state.omega.copy(), R.copy()
    for i, sign in ((0, 1.0), (2, -1.0)):
        x[i] += sign * dt * p.inv_mass[i] * J * n
        if away > 0.0:
            L = sign * J * R[i].T @ np.cross(place - state.x[i], n)              # in the body
            turned[i] = R[i] @ matrix(free_splitting((1.0 + 0j, 0j), tuple(L), tuple(1.0 / p.inv_inertia[i]), dt))
        omega[i] = turned[i] @ R[i].T @ omega[i]
    end = lesson.separate_in_space(None, None, None, 0.0, state, dt, record)
    return ((end.x, rotations(end.q), end.v, end.omega, end.contacts.gap),
            (x, turned, state.v, omega, np.array([gap + away])))


@case("joints-of-a-model", "Joints that a Model has in space", compiled=False)
def joints_of_a_model(lesson, check):
    """Compare what ball joints, hinges and welds hold and what they leave free with conserved momenta."""
    check.laws(lesson, (links_keep, links_share, loads_at_both_ends), seed=39, times=10)


@case("shapes-and-ways", "Shapes, steps that are divided, and overlap in space", compiled=False)
def shapes_and_ways(lesson, check):
    """Compare shapes with the tetrahedra that they are made of, and ways in a step with the times at which balls touch.
    """
    check.laws(lesson, (solids_of_places, half_sizes, share_of_a_touch, share_of_a_turn, steps_that_are_tested,
                        overlap_goes_in_space, boxes_around_ways, bodies_that_may_touch,
                        bodies_that_share_a_joint, reach_of_shapes, lightest_ends, kept_overlaps), seed=40, times=10)


# ---------------------------------------------------------------------------------------------- what few Models need

def ends_of(lesson, bodies, gravity, dt, steps, joints=(), **more):
    """Return the State of all bodies of a Model after some steps of its loop."""
    loop = lesson.compose(model.make_model(bodies, gravity, joints, **more))
    return lesson.state_of(loop, lesson.run_parts(loop, 0.0, loop.state, dt, steps))


@random_law("Smooth balls that do not meet fall with their new velocities: x + k v dt + ½ k (k + 1) g dt².",
            "balls that only move: largest error of places and velocities [m, m/s]", EXACT)
def only_moves(lesson, rng):
    d, dt, steps = rng.choice((2, 3)), rng.uniform(0.001, 0.01), rng.integers(1, 9)
    x, v, g = 10.0 * np.eye(4)[:3, :d] + np.arange(3)[:, None], rng.normal(size=(3, d)), rng.normal(size=d)
    bodies = [model.Body(tuple(place), 1.0, shapes.Ball(0.1), v=tuple(speed)) for place, speed in zip(x, v)]
    end = ends_of(lesson, bodies, tuple(g), dt, steps)
    k = float(steps)
    return (end.x, end.v), (x + k * dt * v + 0.5 * k * (k + 1.0) * dt * dt * g, v + k * dt * g)


@random_law("A torque of one's own turns a body that touches nothing.",
            "torque of one's own: largest error of the spin and the rotation [rad/s, -]", EXACT)
def own_torque(lesson, rng):
    d, dt, moment = rng.choice((2, 3)), 0.01, rng.uniform(0.2, 0.5)
    tau = rng.normal(size=1 if d == 2 else (1, 3))
    body = model.Body((0.0,) * d, 1.0, inertia=moment if d == 2 else (moment,) * 3)
    end = ends_of(lesson, [body], (0.0,) * d, dt, 3, loads=[lambda t, x, q, v, omega: (0.0 * x, tau)])
    way = (1.0 + 2.0 + 3.0) * dt * dt * about_normal(tau)[0] / moment
    return (end.omega, rotations(end.q)[0]), (3.0 * dt * tau / moment, Rotation.from_rotvec(way).as_matrix())


@random_law("Without restitution a gap closes in the step in which it would be crossed, and the momentum stays.",
            "gap that closes: largest error of the gap and the momentum [m, kg m/s]", EXACT)
def gap_closes(lesson, rng):
    """Let two smooth balls approach each other by more than their gap, and less than a radius, in a step."""
    d, dt, (a, b) = rng.choice((2, 3)), 0.01, rng.uniform(0.5, 2.0, 2)
    n, gap = rng.normal(size=d), rng.uniform(0.001, 0.01)
    n /= np.linalg.norm(n)
    drift, v = rng.normal(size=d), (gap + rng.uniform(0.01, 0.03)) / dt
    bodies = [model.Body((0.0,) * d, a, shapes.Ball(0.1), v=tuple(drift)),
              model.Body(tuple((0.2 + gap) * n), b, shapes.Ball(0.1), v=tuple(drift - v * n))]
    end = ends_of(lesson, bodies, (0.0,) * d, dt, 1)
    return ((np.linalg.norm(end.x[1] - end.x[0]), a * end.v[0] + b * end.v[1]), (0.2, (a + b) * drift - b * v * n))


@random_law("Balls that fall together bounce off each other however slowly they meet; a ball beside them rests.",
            "slow impact in free fall: largest error of the velocities [m/s]", EXACT)
def slow_impact_in_free_fall(lesson, rng):
    """Two elastic balls of equal masses exchange what they approach with, less than g dt.  Four more rest in a row."""
    dt, g, u = 0.01, 10.0, rng.uniform(0.01, 0.05)
    down = np.array([0.0, -rng.uniform(0.0, 1.0)])
    fall, aside = np.array([0.0, -g * dt]), np.array([u, 0.0])
    pair = [model.Body((10.0, 5.0), 1.0, shapes.Ball(0.1), v=tuple(down + aside), e=1.0),
            model.Body((10.2, 5.0), 1.0, shapes.Ball(0.1), v=tuple(down), e=1.0)]
    row = [model.Body((0.2 * k, 0.1), 1.0, shapes.Ball(0.1), e=0.5) for k in rng.permutation(4)]
    floor = model.Body((0.0, 0.0), shape=shapes.HalfSpace((0.0, 1.0)), e=1.0)
    end = ends_of(lesson, [*row, *pair, floor], (0.0, -g), dt, 1)
    return end.v[:6], np.vstack((np.zeros((4, 2)), down + fall, down + fall + aside))


@random_law("Up to the speed that gravity adds in a step a ball stays on a floor; a faster one bounces.",
            "slow impacts on a floor: largest error of the speed after them [m/s]", EXACT)
def slow_impacts_on_a_floor(lesson, rng):
    """Let balls come with 2 % less or more than that.  Gravity is weak, and not always along the normal.

    Ball and floor bounce well, badly, or not.
    """
    d, dt, e, (n, g) = rng.choice((2, 3)), 0.01, rng.choice((0.0, 0.05, 0.8), 2), [unit(rng) for _ in range(2)]
    n, g = n[:d] / np.linalg.norm(n[:d]), rng.uniform(0.1, 1.0) * g[:d]
    g, found, shares = -np.sign(g @ n) * g, [], np.array([0.98, 1.02])
    floor = model.Body((0.0,) * d, shape=shapes.HalfSpace(tuple(n)), e=e[1])
    speeds = shares * dt * np.linalg.norm(g)
    for speed in speeds:
        ball = model.Body(tuple((0.1 - 1e-5) * n), 1.0, shapes.Ball(0.1), v=tuple(-speed * n), e=e[0])
        found.append(ends_of(lesson, [ball, floor], tuple(g), dt, 1).v[0] @ n)
    return np.array(found), e[0] * e[1] * speeds * (shares > 1.0)


@random_law("A point that hits a floor leaves it with e times the speed that it had before forces and torques acted.",
            "bounce under a torque: largest error of the speed of the point [m/s]", EXACT)
def bounce_under_a_torque(lesson, rng):
    """Let one end of a tilted capsule hit the floor, while a force and a torque that depend on time act on it."""
    d, dt, (t, e, tilt, speed) = rng.choice((2, 3)), 0.005, rng.uniform((0.0, 0.3, 0.5, 1.0), (1.0, 0.9, 1.0, 3.0))
    q, moment = rng.normal() if d == 2 else random_quaternions(rng, 1)[0], rng.uniform(0.2, 0.5)
    R, (v, F), (spin, tau) = rotations([q])[0][:d, :d], rng.normal(size=(2, d)), rng.normal(size=(2, 1, 3)[:d])
    n, end = R @ np.array([np.sin(tilt), np.cos(tilt), 0.0])[:d], -0.6 * R[:, 0]
    at_end = lambda v, spin: n @ (v + np.cross(about_normal(spin)[0], in_space(end))[:d])
    v = v - (at_end(v, spin) + speed) * n
    push = lambda t, x, q, v, omega: (np.cos(t) * np.stack((F, 0.0 * F)), np.sin(t) * np.concatenate((tau, 0.0 * tau)))
    bodies = [model.Body(tuple((0.2 - 1e-6 - end @ n) * n), 1.0, shapes.Capsule(0.6, 0.2), v=tuple(v), e=e,
                         **({"q": q, "omega": float(spin[0]), "inertia": moment} if d == 2 else
                            {"q": tuple(q), "omega": tuple(spin[0]), "inertia": (moment,) * 3})),
              model.Body((0.0,) * d, shape=shapes.HalfSpace(tuple(n)), e=1.0)]
    after = composed_run(lesson, bodies, (0.0,) * d, (), dt, 1, t, loads=[push])
    return at_end(after.v[0], after.omega[:1]), e * speed


@random_law("A block that cannot turn is slowed by μ g on a floor.",
            "friction without rotation: largest error of the velocity [m/s]", EXACT)
def slides_without_turning(lesson, rng):
    d, dt, mu, speed = rng.choice((2, 3)), 0.01, rng.uniform(0.1, 0.5), rng.uniform(1.0, 2.0)
    up, along = np.eye(d)[-1], np.eye(d)[0]
    body = model.Body(tuple(0.1 * up), 2.0, shapes.Box((0.1,) * d), mu, v=tuple(speed * along),
                      inertia=np.inf if d == 2 else (np.inf,) * 3)
    floor = model.Body((0.0,) * d, shape=shapes.HalfSpace(tuple(up)), mu=1.0)
    end = ends_of(lesson, [body, floor], tuple(-10.0 * up), dt, 5)
    return end.v[0], (speed - mu * 10.0 * 5.0 * dt) * along


@random_law("Balls that are deep in each other part where they have room.",
            "deep overlap: largest error of the gap and the momentum [m, kg m/s]", EXACT)
def deep_balls_part(lesson, rng):
    """A fifth of what is beyond the slop goes in each step, from half of a radius on."""
    d, deep = rng.choice((2, 3)), rng.uniform(0.04, 0.06)
    n = rng.normal(size=d)
    n /= np.linalg.norm(n)
    bodies = [model.Body((0.0,) * d, 1.0, shapes.Ball(0.1)),
              model.Body(tuple((0.2 - deep) * n), rng.uniform(0.5, 2.0), shapes.Ball(0.1))]
    loop = lesson.compose(model.make_model(bodies, (0.0,) * d))
    end, slop = lesson.state_of(loop, lesson.run_parts(loop, 0.0, loop.state, 0.01, 3)), loop.p.slop
    return ((np.linalg.norm(end.x[1] - end.x[0]), end.v), (0.2 - slop - 0.8**3 * (deep - slop), np.zeros((2, d))))


@random_law("Two hinges at the same point hold it, and keep both momenta.",
            "hinges that depend on each other: largest error of the place and the momenta [m, kg m/s, kg m²/s]", EXACT)
def doubled_hinge(lesson, rng):
    """Two bodies and two hinges at one place, whose equations depend on each other: it stays one place, and both
    momenta stay.
    """
    place, x = rng.normal(size=2), rng.normal(size=(2, 2))
    bodies = [model.Body(tuple(centre), float(m), inertia=float(I), omega=float(omega)) for centre, m, I, omega in
              zip(x, rng.uniform(0.5, 2.0, 2), rng.uniform(0.2, 0.5, 2), 0.3 * rng.normal(size=2))]
    loop = lesson.compose(model.make_model(bodies, (0.0, 0.0), [model.Hinge(0, 1, tuple(place))] * 2))
    after = lesson.run_parts(loop, 0.0, loop.state, 0.01, 5)
    end = lesson.state_of(loop, after)
    ends = [end.x[k] + rotations(end.q)[k][:2, :2] @ (place - x[k]) for k in (0, 1)]
    return ((ends[0], *momenta_of(*after[:4], loop.p)), (ends[1], *momenta_of(*loop.state[:4], loop.p)))


@random_law("A hinge on the world and a rod to another body stay as they are while both bodies turn.",
            "hinge and rod: largest error of the place and the length [m]", EXACT)
def hinge_and_rod(lesson, rng):
    """Two bodies that turn; the first hangs on a point off its centre, and a rod leads from a point of it to the other.
    """
    d, x = rng.choice((2, 3)), rng.normal(size=(2, 3))
    x = x[:, :d] + np.array([(0.0,) * d, (3.0,) * d])
    places, pivot = rng.normal(size=(2, d)), x[0] + rng.normal(size=d)
    inertia = [float(I) if d == 2 else (float(I),) * 3 for I in rng.uniform(0.2, 0.5, 2)]
    spin = [float(w[0]) if d == 2 else tuple(w) for w in 0.3 * rng.normal(size=(2, 3))]
    bodies = [model.Body(tuple(x[k]), 1.0 + k, inertia=inertia[k], omega=spin[k]) for k in (0, 1)]
    joint = model.Hinge(0, model.WORLD, tuple(pivot)) if d == 2 else model.BallJoint(0, model.WORLD, tuple(pivot))
    end = ends_of(lesson, bodies, (0.0,) * d, 0.005, 4, [joint, model.Distance(0, 1, *map(tuple, places))])
    R = rotations(end.q)[:, :d, :d]
    ends = [end.x[k] + R[k] @ places[k] for k in (0, 1)]
    return ((end.x[0] + R[0] @ (pivot - x[0]), np.linalg.norm(ends[1] - ends[0])),
            (pivot, np.linalg.norm(x[1] + places[1] - x[0] - places[0])))


@random_law("Two balls deep in each other part against the springs that hold them, as implicit Euler has it.",
            "springs beside deep overlap: largest error of places and velocities [m, m/s]", 5e-5)
def deep_balls_on_springs(lesson, rng):
    """Each hangs on a compliant rod along their line.  Such a rod gives a ball the inertia m + dt²/α: for the impulses
    of a contact, and for what moves it out of the other ball.  Then the springs push both together.
    """
    d, dt, steps, deep = rng.choice((2, 3)), 0.02, 3, rng.uniform(0.01, 0.04)
    n = rng.normal(size=d)
    n /= np.linalg.norm(n)
    m, soft, places = rng.uniform(0.5, 2.0, 2), 10.0 ** rng.uniform(-3.5, -2.5, 2), np.outer((0.0, 0.2 - deep), n)
    bodies = [model.Body(tuple(x), float(w), shapes.Ball(0.1)) for x, w in zip(places, m)]
    rods = [model.Distance(k, model.WORLD, (0.0,) * d, tuple(places[k] + (2 * k - 1) * n), float(soft[k]))
            for k in (0, 1)]
    loop = lesson.compose(model.make_model(bodies, (0.0,) * d, rods))
    end = lesson.state_of(loop, lesson.run_parts(loop, 0.0, loop.state, dt, steps))
    heavy, way, v, beyond = m + dt * dt / soft, np.zeros(2), 0.0, deep - loop.p.slop
    for _ in range(steps):
        way += 0.2 * beyond * np.array([-1.0, 1.0]) / heavy / np.sum(1.0 / heavy)
        v, beyond = (m.sum() * v - dt * np.sum(way / soft)) / heavy.sum(), 0.8 * beyond
        way += dt * v
    return (end.x, end.v), (places + np.outer(way, n), np.outer((v, v), n))


@random_law("A light ball moves a row that it runs into as one, also while heavy balls hit each other elsewhere.",
            "a light row beside heavy balls: largest error of a velocity [m/s]", 1e-3)
def light_row_beside_heavy_balls(lesson, rng):
    """Each impact is swept until its own impulses settle: those of the heavy balls are a million times as large."""
    m, speed, d = 1e-3 * rng.uniform(0.5, 2.0, 5), rng.uniform(0.5, 1.0), rng.choice((2, 3))
    along, far, order = np.eye(d)[0], 100.0 * np.eye(d)[1], rng.permutation(7)
    bodies = [model.Body(tuple(0.2 * k * along), float(w), shapes.Ball(0.1), v=tuple(speed * (k == 0) * along))
              for k, w in enumerate(m)]
    bodies += [model.Body(tuple(far + 0.2 * k * along), 1e3, shapes.Ball(0.1), v=tuple((1.0 - k) * along))
               for k in (0, 1)]
    end = ends_of(lesson, [bodies[k] for k in order], (0.0,) * d, 0.001, 1)
    return end.v[np.argsort(order)[:5]], np.outer(np.ones(5), m[0] * speed / m.sum() * along)


@random_law("A contact of two equal balls stays halfway between them, one on a plane at the foot of its ball.",
            "contacts that are carried along: largest error of their places [m]", EXACT)
def carried_contacts(lesson, rng):
    """Try up to six balls and two planes, of which each ball touches all others."""
    d, n, dt = rng.choice((2, 3)), rng.integers(1, 7), rng.uniform(0.01, 0.1)
    (x, v), normals = rng.normal(size=(2, n + 2, d)), rng.normal(size=(2, d))
    a, b = np.array([(i, j) for i in range(n) for j in range(i + 1, n + 2)]).T
    places = lambda x: np.array([0.5 * (x[i] + x[j]) if j < n else x[i] - 0.1 * normals[j - n] for i, j in zip(a, b)])
    contacts = lesson.ContactSet(np.searchsorted(a, np.arange(n + 1)), a, b, rng.normal(size=(len(a), d)), places(x),
                                 rng.normal(size=len(a)))
    found = lesson.carried(contacts, v, dt, SimpleNamespace(half=SimpleNamespace(half=np.ones((n, d)))))
    return found, contacts._replace(p=places(x + dt * v))


@random_law("A rod that swings through a block within a step is refused, and one that ends before it is not.",
            "rods that swing past a block: wrong verdicts [-]", 0.0)
def swings_past_a_block(lesson, rng):
    """A rod of 2 m turns by up to half a turn; a small block that nothing moves lies on the circle, within or beyond.

    In space a step with ω dt turns a body by 2 arctan(½ ω dt).
    """
    d, dt, within = rng.choice((2, 3)), 0.1, rng.random() < 0.5
    spin = rng.uniform(2.0, 3.0)
    turn = spin if d == 2 else 2.0 * np.arctan(0.5 * spin)
    place = rng.uniform(0.4, turn - 0.4) if within else turn + rng.uniform(0.16, 0.18)
    x = np.zeros((2, d))
    x[1, :2] = 0.7 * np.cos(place), 0.7 * np.sin(place)
    half, turns = np.full((2, d), 0.05), (1.0, np.inf)
    half[0, 0] = 1.0
    if d == 2:
        state, p = lesson.make_bodies_2d(x, np.array([0.0, place]), (1.0, np.inf), turns, half, [], np.zeros(d), 0.0, 5,
                                         0.01)
        state, kind = state._replace(omega=np.array([spin / dt, 0.0])), "_2d"
    else:
        q = np.array([UPRIGHT, (np.cos(0.5 * place), 0.0, 0.0, np.sin(0.5 * place))])
        state, p = lesson.make_bodies(x, q, (1.0, np.inf), np.outer(turns, np.ones(3)), half, [], np.zeros(d), 0.0, 5,
                                      0.01)
        state, kind = state._replace(omega=np.array([(0.0, 0.0, spin / dt), (0.0, 0.0, 0.0)])), ""
    shape = [getattr(lesson, name + kind) for name in ("contact_step", "box_bounds", "box_contacts")]
    try:
        lesson.advance_contact(shape[0], lesson.weight, *shape[1:], 0.0, state, dt, 1, p)
    except TooFast:
        return 1.0, float(within)
    return 0.0, float(within)


def unit(rng):
    """Return a random direction (3,)."""
    n = rng.normal(size=3)
    return n / np.linalg.norm(n)


def squeezed(lesson, d):
    """Return whether a loop says that a ball has no room between a wall and one that is driven against it."""
    n = np.eye(d)[0]
    walls = [model.Body(tuple(-0.6 * n), shape=shapes.Box((0.5,) * d), v=tuple(0.5 * n)),
             model.Body(tuple(0.6 * n), shape=shapes.Box((0.5,) * d))]
    try:
        ends_of(lesson, [model.Body((0.0,) * d, 1.0, shapes.Ball(0.1)), *walls], (0.0,) * d, 0.01, 60)
    except Diverged:
        return True
    return False


@case("parts-of-a-model", "Parts that few Models need", compiled=False)
def parts_of_a_model(lesson, check):
    """Compare what only some Models need (smooth balls, loads of one's own, deep overlaps, joints that depend on each
    other) with closed forms, in the plane and in space.
    """
    check.laws(lesson, (only_moves, own_torque, gap_closes, slow_impact_in_free_fall, slides_without_turning,
                        deep_balls_part, doubled_hinge, hinge_and_rod, deep_balls_on_springs,
                        light_row_beside_heavy_balls, swings_past_a_block, slow_impacts_on_a_floor,
                        bounce_under_a_torque, carried_contacts), seed=41, times=10)
    errors = sum(squeezed(lesson, d) for d in (2, 3))
    check("A ball between a wall and a piston ends in an error.", "errors of a ball without room [of 2]",
          law=2.0, found=float(errors), within=0.0, saw=f"{errors} of 2 runs ended in Diverged.")
