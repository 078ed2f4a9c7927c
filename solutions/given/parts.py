"""Given with lesson 10.  The parts of our loop in the plane: compose.py says which of them a model needs.

Parts that find contacts, and `move`, serve in space as well; parts_3d.py has the others.

Every part has the arguments of a step,

    part(load, bounds, narrow, t, state, dt, p) → state

and is made of exercises and given functions of lessons 9 and 10.  p is a Composed of compose.py.
"""

from typing import NamedTuple

import numpy as np

from ..checks import Diverged
from ..contact import kept_impulses, velocity_sweep_2d
from ..simulator import find_contacts, new_velocities_2d, weight
from ..support.arms import apply_impulses_2d, arms_2d, normal_velocities_2d
from ..support.contact_points import ContactSet
from ..support.networks import pull_per_length
from ..support.scenes import PileState, smaller_half, smallest_halves
from .joints import close_joints_2d, hold_joints_2d, without_joined
from .rods import close_links, impulses_at_rest, no_link_impulses

PUSH_OUT = 0.2               # share of an overlap that is removed per step [-]
NOTHING = 1e-12              # change of a velocity over itself that is round-off [-]
SQUEEZED = 0.1               # overlap over the smaller half size from which impulses are looked at again [-]
MOST_LEFT = 0.5              # share of what contacts change that one more sweep may change [-]


class Smooth(NamedTuple):
    """Bodies without friction, as velocity_sweep_2d reads them."""
    inv_mass: np.ndarray     # (rows,) [1/kg]
    inv_inertia: np.ndarray  # (rows,) [1/(kg m²)]
    mu: float                # 0 [-]


# ---------------------------------------------------------------------------------------------- forces

def model_load(t, x, q, v, omega, p):
    """Return (F, tau) of gravity, springs and drag on all rows in the plane."""
    F, tau = weight(t, x, q, v, omega, p)
    for i in range(x.shape[0]):
        if p.inv_mass[i] > 0.0:
            F[i, 0] -= p.drag * v[i, 0]
            F[i, 1] -= p.drag * v[i, 1]
    for s in range(p.ends.shape[0]):
        a, b = p.ends[s, 0], p.ends[s, 1]
        c, d = np.cos(q[a]), np.sin(q[a])
        a_x, a_y = c * p.arms[s, 0] - d * p.arms[s, 1], d * p.arms[s, 0] + c * p.arms[s, 1]
        c, d = np.cos(q[b]), np.sin(q[b])
        b_x, b_y = c * p.arms[s, 2] - d * p.arms[s, 3], d * p.arms[s, 2] + c * p.arms[s, 3]
        r_x, r_y = x[a, 0] + a_x - x[b, 0] - b_x, x[a, 1] + a_y - x[b, 1] - b_y
        u_x = v[a, 0] - omega[a] * a_y - v[b, 0] + omega[b] * b_y
        u_y = v[a, 1] + omega[a] * a_x - v[b, 1] - omega[b] * b_x
        pull = pull_per_length(r_x * r_x + r_y * r_y, r_x * u_x + r_y * u_y, p.laws[s])
        F[a, 0], F[a, 1] = F[a, 0] + pull * r_x, F[a, 1] + pull * r_y
        F[b, 0], F[b, 1] = F[b, 0] - pull * r_x, F[b, 1] - pull * r_y
        tau[a] += pull * (a_x * r_y - a_y * r_x)
        tau[b] -= pull * (b_x * r_y - b_y * r_x)
    return F, tau


def accelerated(load, t, state, dt, p):
    """Return the state after the loads at the time t have acted for dt."""
    x, q, v, omega, contacts, J = state
    v, omega = new_velocities_2d(load, t, x, q, v, omega, dt, p)
    return PileState(x, q, v, omega, contacts, J)


def accelerate(load, bounds, narrow, t, state, dt, p):
    """Return the state after the loads have acted for dt."""
    return accelerated(load, t, state, dt, p)


def accelerate_half(load, bounds, narrow, t, state, dt, p):
    """Return the state after the loads have acted for ½ dt."""
    return accelerated(load, t, state, 0.5 * dt, p)


def accelerate_rest(load, bounds, narrow, t, state, dt, p):
    """Return the state after the loads at the end of the step have acted for ½ dt."""
    return accelerated(load, t + dt, state, 0.5 * dt, p)


# ---------------------------------------------------------------------------------------------- detection

def carried(contacts, v, dt, p):
    """Return the contacts of the step before where their bodies have carried them in dt, so that they are recognised.

    Between two bodies: by the mean of their velocities v;  on a plane: by that of the body, whose corner it is.
    """
    points, n = contacts.p.copy(), p.half.half.shape[0]
    for k in range(contacts.a.size):
        a, b = contacts.a[k], contacts.b[k]
        for c in range(points.shape[1]):
            points[k, c] += dt * (0.5 * (v[a, c] + v[b, c]) if b < n else v[a, c])
    return ContactSet(contacts.first, contacts.a, contacts.b, contacts.n, points, contacts.gap)


def detect_few(load, bounds, narrow, t, state, dt, p):
    """Return the state with the contacts of all pairs that could touch, and the impulses that they keep."""
    x, q, v, omega, old, J = state
    _, _, turn = bounds(x, q, p.half)
    contacts = narrow(x, turn, p.half, p.planes, p.pairs, p.margin)
    return PileState(x, q, v, omega, contacts, kept_impulses(contacts, carried(old, v, dt, p), J, p.margin))


def detect_many(load, bounds, narrow, t, state, dt, p):
    """Return the same, with a broad phase."""
    x, q, v, omega, old, J = state
    low, high, turn = bounds(x, q, p.half)
    contacts = find_contacts(narrow, x, low, high, turn, p)
    return PileState(x, q, v, omega, contacts, kept_impulses(contacts, carried(old, v, dt, p), J, p.margin))


def detect_unjoined(load, bounds, narrow, t, state, dt, p):
    """Return the same as detect_many, without contacts of bodies that share a joint."""
    x, q, v, omega, old, J = state
    low, high, turn = bounds(x, q, p.half)
    contacts = without_joined(find_contacts(narrow, x, low, high, turn, p), p.joints)
    return PileState(x, q, v, omega, contacts, kept_impulses(contacts, carried(old, v, dt, p), J, p.margin))


# ---------------------------------------------------------------------------------------------- contact

def resting_speed(dt, p):
    """Return the approach speed [m/s] up to which a contact rests: what gravity adds in a step."""
    squared = 0.0
    for c in range(p.gravity.size):
        squared += p.gravity[c] * p.gravity[c]
    return dt * np.sqrt(squared)


def resting_speeds(contacts, dt, p):
    """Return resting_speed of each contact (m,) [m/s].  It is 0 in free fall, where gravity presses no bodies together.
    """
    speeds = np.full(contacts.a.size, resting_speed(dt, p))
    if speeds.size == 0 or speeds[0] == 0.0 or p.drag > 0.0 or not may_bounce(contacts, p):
        return speeds
    held, island = p.inv_mass == 0.0, islands_of(contacts, p)
    for ends in (p.joints.a, p.joints.b, p.rods.a, p.rods.b, p.ends.ravel()):
        for i in ends:
            held[i] = True
    for k in range(speeds.size):
        if held[contacts.a[k]] or held[contacts.b[k]]:
            held[island[k]] = True
    for k in range(speeds.size):
        if not held[island[k]]:
            speeds[k] = 0.0
    return speeds


def may_bounce(contacts, p):
    """Return whether a contact has e > 0."""
    for k in range(contacts.a.size):
        if p.e_of[contacts.a[k]] > 0.0 and p.e_of[contacts.b[k]] > 0.0:
            return True
    return False


def parting_aims(u_n, pressed, contacts, dt, p):
    """Return the velocities (m,) [m/s] below which no contact may leave: each pair has its own restitution.

    An open contact may close: −gap/dt.  A closed one leaves with −e times the speed at which it came before forces and
    joints acted, u_n − pressed, if that is faster than what gravity, or all of them, add in a step; a slower one rests.
    One that parts faster may come back with e times that speed, if another impact of the step turns it round: stopping
    it would gain energy.  *Source:* Moreau 1988.
    Gravity counts with its full size for any normal: bodies that lean on each other are pressed sideways, too.
    With e > 0 an open contact has to close before it bounces.  It is not stopped in this step, unless forces alone
    could close it: another impact of the same step may throw its bodies at each other.
    pressed: (m,) what all forces and joints have added to u_n in this step [m/s]

    Symplectic Euler keeps E − ½ g dt v of a ball that flies up with v, and so does an impact with e = 1 that turns the
    speed round which the ball had before gravity acted.  With u_n the ball would win g dt u_n in each impact.
    """
    aim, rests = np.empty(contacts.a.size), resting_speeds(contacts, dt, p)
    for k in range(aim.size):
        e, gap, came = p.e_of[contacts.a[k]] * p.e_of[contacts.b[k]], contacts.gap[k], u_n[k] - pressed[k]
        added = max(rests[k], -pressed[k])
        if gap > 0.0:
            aim[k] = -np.inf if e > 0.0 and (came < -added or gap > added * dt) else -gap / dt
        else:
            aim[k] = -e * came if e > 0.0 and abs(came) > added else 0.0
    return aim


def forget_bounces(J, aim):
    """Set the kept impulses J (m, d) of contacts that bounce to zero, in place."""
    for k in range(aim.size):
        if aim[k] > 0.0 or aim[k] == -np.inf:
            J[k] = 0.0


def pushing_aims(contacts, dt, p):
    """Return the velocities (m,) [m/s] that remove the share PUSH_OUT of each overlap deeper than p.slop per step."""
    aim = np.empty(contacts.a.size)
    for k in range(aim.size):
        deep = -contacts.gap[k] - p.slop
        aim[k] = PUSH_OUT * deep / dt if deep > 0.0 else -max(contacts.gap[k], 0.0) / dt
    return aim


def all_shallow(contacts, p):
    """Return whether no overlap is deeper than p.slop.  This runs in each step and makes no array."""
    for k in range(contacts.gap.size):
        if not contacts.gap[k] >= -p.slop:                               # a NaN is not shallow
            return False
    return True


def sweep_alike_2d(v, omega, J, aim, contacts, arms, inv_inertia, p):
    """Return (v, omega, J) after velocity_sweep_2d of lesson 9 over rigid contacts that have one friction."""
    return velocity_sweep_2d(v, omega, J, aim, np.zeros(aim.size), contacts, arms, p)


def sweep_pairs_2d(v, omega, J, aim, contacts, arms, inv_inertia, p):
    """Return the same over contacts that have a friction of their own each."""
    v, omega, J = v.copy(), omega.copy(), J.copy()
    for k in range(contacts.a.size):
        a, b, n_x, n_y = contacts.a[k], contacts.b[k], contacts.n[k, 0], contacts.n[k, 1]
        a_x, a_y, b_x, b_y = arms.r_a[k, 0], arms.r_a[k, 1], arms.r_b[k, 0], arms.r_b[k, 1]
        u_x = v[a, 0] - omega[a] * a_y - v[b, 0] + omega[b] * b_y
        u_y = v[a, 1] + omega[a] * a_x - v[b, 1] - omega[b] * b_x
        u_n, u_t = n_x * u_x + n_y * u_y, n_x * u_y - n_y * u_x
        J_n, J_t = n_x * J[k, 0] + n_y * J[k, 1], n_x * J[k, 1] - n_y * J[k, 0]
        J_n = max(0.0, J_n + (aim[k] - u_n) / arms.k_n[k])
        rubs = J_n > 0.0 and p.mu_of[a] > 0.0 and p.mu_of[b] > 0.0
        limit = p.mu_of[a] * p.mu_of[b] * J_n if rubs else 0.0
        J_t = min(max(J_t - u_t / arms.k_t[k], -limit), limit)
        d_x, d_y = J_n * n_x - J_t * n_y - J[k, 0], J_n * n_y + J_t * n_x - J[k, 1]
        J[k, 0], J[k, 1] = J[k, 0] + d_x, J[k, 1] + d_y
        v[a, 0], v[a, 1] = v[a, 0] + p.inv_mass[a] * d_x, v[a, 1] + p.inv_mass[a] * d_y
        v[b, 0], v[b, 1] = v[b, 0] - p.inv_mass[b] * d_x, v[b, 1] - p.inv_mass[b] * d_y
        omega[a] += inv_inertia[a] * (a_x * d_y - a_y * d_x)
        omega[b] -= inv_inertia[b] * (b_x * d_y - b_y * d_x)
    return v, omega, J


def sweep_centres_2d(v, omega, J, aim, contacts, arms, inv_inertia, p):
    """Return the same where nothing rubs and nothing turns: no arms, no tangent."""
    v, J = v.copy(), J.copy()
    for k in range(contacts.a.size):
        a, b, n_x, n_y = contacts.a[k], contacts.b[k], contacts.n[k, 0], contacts.n[k, 1]
        old, u_n = n_x * J[k, 0] + n_y * J[k, 1], n_x * (v[a, 0] - v[b, 0]) + n_y * (v[a, 1] - v[b, 1])
        J_n = max(0.0, old + (aim[k] - u_n) / (p.inv_mass[a] + p.inv_mass[b]))
        d_x, d_y = (J_n - old) * n_x, (J_n - old) * n_y
        J[k, 0], J[k, 1] = J_n * n_x, J_n * n_y
        v[a, 0], v[a, 1] = v[a, 0] + p.inv_mass[a] * d_x, v[a, 1] + p.inv_mass[a] * d_y
        v[b, 0], v[b, 1] = v[b, 0] - p.inv_mass[b] * d_x, v[b, 1] - p.inv_mass[b] * d_y
    return v, omega, J


def begun(load, t, free, v, omega, dt, p):
    """Return (v, omega, J, aim, arms, inv_inertia): what the sweeps of a step begin with; a bounce keeps no impulse.

    free: the state after the loads;    v, omega: of its bodies, after joints are closed
    """
    x, q, _, _, contacts, J = free
    J, arms = J.copy(), arms_2d(x, p.inv_mass, p.inv_inertia, contacts)
    u_n, pressed = normal_velocities_2d(v, omega, contacts, arms), np.zeros(J.shape[0])
    if may_bounce(contacts, p):              # what loads have added, once more, and what closing joints has added
        later, spun = new_velocities_2d(load, t, x, q, free.v, free.omega, dt, p)
        pressed = normal_velocities_2d(v + later - 2.0 * free.v, omega + spun - 2.0 * free.omega, contacts, arms)
    aim, v, omega = parting_aims(u_n, pressed, contacts, dt, p), v.copy(), omega.copy()
    forget_bounces(J, aim)
    apply_impulses_2d(v, omega, J, contacts, arms, p.inv_mass, p.inv_inertia)
    return v, omega, J, aim, arms, p.inv_inertia


def along_normals(J, n):
    """Return what of the impulses J (m, d) is along the normals n: those that were kept may be along older ones.

    Where nothing rubs, the rest would be a friction, because no sweep takes it away.
    """
    kept = np.empty(J.shape)
    for k in range(J.shape[0]):
        along = 0.0
        for c in range(J.shape[1]):
            along += n[k, c] * J[k, c]
        for c in range(J.shape[1]):
            kept[k, c] = along * n[k, c]
    return kept


def begun_of_centres(load, t, free, v, omega, dt, p):
    """Return the same where nothing rubs and nothing turns."""
    x, q, v_free, omega_free, contacts, J = free
    free = PileState(x, q, v_free, omega_free, contacts, along_normals(J, contacts.n))
    return begun(load, t, free, v, omega, dt, p)


def islands_of(contacts, p):
    """Return the number (m,) of the island of each contact: of bodies that contacts connect, also through others.

    What does not move connects nothing.  first[i] is a body of the island of i with a smaller number.  For the first
    body of an island it is the body itself.
    """
    first, island = np.arange(p.inv_mass.size), np.empty(contacts.a.size, np.int64)
    for k in range(contacts.a.size):
        a, b = contacts.a[k], contacts.b[k]
        if p.inv_mass[a] > 0.0 and p.inv_mass[b] > 0.0:
            while first[a] != a:
                a = first[a]
            while first[b] != b:
                b = first[b]
            first[max(a, b)] = min(a, b)
    for i in range(first.size):
        first[i] = first[first[i]]
    for k in range(contacts.a.size):
        island[k] = first[contacts.a[k] if p.inv_mass[contacts.a[k]] > 0.0 else contacts.b[k]]
    return island


def is_settled(J, before, island, most, p):
    """Return whether a sweep has changed no impulse by more than p.settled times the largest one of its island.

    most: (rows,) for the largest impulse of each island; it is written anew
    This runs after each sweep, makes no array, and ends at the first change that is too large.
    """
    for k in range(J.shape[0]):
        most[island[k]] = 0.0
    for k in range(J.shape[0] if p.settled > 0.0 else 0):
        for c in range(J.shape[1]):
            most[island[k]] = max(most[island[k]], abs(J[k, c]))
    for k in range(J.shape[0]):
        for c in range(J.shape[1]):
            if abs(J[k, c] - before[k, c]) > p.settled * most[island[k]]:
                return False
    return True


def share_left(J, before, v, free, contacts, arms):
    """Return the largest velocity that a visit of a sweep has taken from a contact, over the largest change of v [-].

    free: v before all impulses
    A light body under a heavy one has small impulses to change, and yet sinks as fast as the heavy one.
    """
    most, left = 0.0, 0.0
    for k in range(J.shape[0]):
        along, squared = 0.0, 0.0
        for c in range(J.shape[1]):
            d = J[k, c] - before[k, c]
            along, squared = along + d * contacts.n[k, c], squared + d * d
            for i in (contacts.a[k], contacts.b[k]):
                most = max(most, abs(v[i, c] - free[i, c]), NOTHING * abs(v[i, c]))
        across = np.sqrt(max(squared - along * along, 0.0))
        left = max(left, arms.k_n[k] * abs(along), arms.k_t[k] * across)
    return left / most if most > 0.0 else 0.0


def is_calm(J, before, v, free, contacts, arms, island, most, p):
    """Return whether a sweep has changed neither the impulses nor, where bodies differ, the velocities any more.

    island, most: see is_settled
    """
    if not is_settled(J, before, island, most, p):
        return False
    return p.calm == np.inf or share_left(J, before, v, free, contacts, arms) <= p.calm


def are_deep(contacts, p):
    """Return whether two bodies are so deep in each other that impulses seem not to hold them apart."""
    least = smallest_halves(p.half.half)
    for k in range(contacts.gap.size):
        if contacts.gap[k] < -p.slop and contacts.gap[k] < -SQUEEZED * smaller_half(contacts, k, least):
            return True
    return False


def check_solved(calm, sweep, v, omega, J, aim, contacts, arms, inv_inertia, free, p):
    """Raise Diverged where one more sweep takes more than half of what contacts change in all.

    This is looked at where bodies differ and the sweeps have not ended; and where bodies are deep in each other:
    impulses that grow without end, as those of a body between a piston and a wall, change by an ever smaller share.
    """
    if (p.calm < np.inf and not calm) or are_deep(contacts, p):
        _, _, more = sweep(v, omega, J, aim, contacts, arms, inv_inertia, p)
        check_left(share_left(more, J, v, free, contacts, arms))


def check_left(share):
    """Raise Diverged where a sweep still takes more than half of what contacts change in all."""
    if share > MOST_LEFT:
        raise Diverged("the share of the velocities at contacts that sweeps have left [-]", share,
                       "take more sweeps, masses nearer to each other, less friction, or more room between bodies")


def damped(now, before, older):
    """Return (v, omega, J) after a sweep; where it takes back what the sweep before did, the mean of both.

    now, before, older: (v, omega, J) after the last sweep, the one before, and the one before that
    A rod that lands aslant with a friction above 4/3 needs this: its normal and tangential impulse undo each other.
    """
    product = 0.0
    for k in range(now[2].shape[0]):
        for c in range(now[2].shape[1]):
            product += (now[2][k, c] - before[2][k, c]) * (before[2][k, c] - older[2][k, c])
    if product >= 0.0:
        return now
    return 0.5 * (now[0] + before[0]), 0.5 * (now[1] + before[1]), 0.5 * (now[2] + before[2])


def swept(begin, sweep, load, t, state, dt, p):
    """Return the state after sweeps over all contacts, until they settle; the second half of them is damped.

    begin: see begun;    sweep: over all contacts, in the plane or in space
    Raises Diverged where they do not.
    """
    x, q, free, spun, contacts, J = state
    if contacts.a.size == 0:
        return state
    (v, omega, J, aim, arms, inv_inertia), calm = begin(load, t, state, free, spun, dt, p), False
    before, island, most = (v, omega, J), islands_of(contacts, p), np.zeros(p.inv_mass.size)
    for n in range(p.sweeps):
        older, before = before, (v, omega, J)
        v, omega, J = sweep(v, omega, J, aim, contacts, arms, inv_inertia, p)
        if 2 * n >= p.sweeps:
            v, omega, J = damped((v, omega, J), before, older)
        calm = is_calm(J, before[2], v, free, contacts, arms, island, most, p)
        if calm:
            break
    check_solved(calm, sweep, v, omega, J, aim, contacts, arms, inv_inertia, free, p)
    return PileState(x, q, v, omega, contacts, J)


def contact_impulses(load, bounds, narrow, t, state, dt, p):
    """Return the state after the impulses of all contacts, with one friction for all."""
    return swept(begun, sweep_alike_2d, load, t, state, dt, p)


def contact_impulses_of_pairs(load, bounds, narrow, t, state, dt, p):
    """Return the same with a friction of each pair."""
    return swept(begun, sweep_pairs_2d, load, t, state, dt, p)


def contact_impulses_of_centres(load, bounds, narrow, t, state, dt, p):
    """Return the same where nothing rubs and nothing turns."""
    return swept(begun_of_centres, sweep_centres_2d, load, t, state, dt, p)


def swept_and_closed(begin, sweep, close_all, load, t, state, dt, p):
    """Return the state after sweeps over all contacts, with links that are closed by `close_all` after each of them.

    close_all: (x, q, v, omega, links, dt, p) → (v, omega, links), with the impulses of all links in this step
    """
    x, q, free, omega, contacts, J = state
    v, omega, links = close_all(x, q, free, omega, no_link_impulses(p), dt, p)
    if contacts.a.size == 0:
        return PileState(x, q, v, omega, contacts, J)
    (v, omega, J, aim, arms, inv_inertia), calm = begin(load, t, state, v, omega, dt, p), False
    before, island, most = (v, omega, J), islands_of(contacts, p), np.zeros(p.inv_mass.size)
    for n in range(p.sweeps):
        older, before = before, (v, omega, J)
        v, omega, J = sweep(v, omega, J, aim, contacts, arms, inv_inertia, p)
        if 2 * n >= p.sweeps:
            v, omega, J = damped((v, omega, J), before, older)
        v, omega, links = close_all(x, q, v, omega, links, dt, p)
        calm = is_calm(J, before[2], v, free, contacts, arms, island, most, p)
        if calm:
            break
    check_solved(calm, sweep, v, omega, J, aim, contacts, arms, inv_inertia, free, p)
    return PileState(x, q, v, omega, contacts, J)


def close_rigid_2d(x, q, v, omega, links, dt, p):
    """Return (v, omega, links) after close_joints_2d, which does not need the impulses of links."""
    v, omega = close_joints_2d(x, q, v, omega, dt, p)
    return v, omega, links


def contact_impulses_with_joints(load, bounds, narrow, t, state, dt, p):
    """Return the same as contact_impulses_of_pairs, with joints that are closed after every sweep."""
    return swept_and_closed(begun, sweep_pairs_2d, close_rigid_2d, load, t, state, dt, p)


def contact_impulses_with_rods(load, bounds, narrow, t, state, dt, p):
    """Return the same with joints and rods."""
    return swept_and_closed(begun, sweep_pairs_2d, close_links, load, t, state, dt, p)


def separated(close_all, links, state, dt, p):
    """Return the state with bodies moved out of each other; close_all and links: see swept_and_closed."""
    x, q, v, omega, contacts, J = state
    aim, arms = pushing_aims(contacts, dt, p), arms_2d(x, p.inv_mass, p.inv_inertia, contacts)
    push, spin, J_push, give = np.zeros(v.shape), np.zeros(omega.shape), np.zeros(J.shape), np.zeros(aim.size)
    smooth, still = Smooth(p.inv_mass, p.inv_inertia, 0.0), push
    island, most = islands_of(contacts, p), np.zeros(p.inv_mass.size)
    for _ in range(p.sweeps):
        before = J_push
        push, spin, J_push = velocity_sweep_2d(push, spin, J_push, aim, give, contacts, arms, smooth)
        push, spin, links = close_all(x, q, push, spin, links, dt, p)
        if is_calm(J_push, before, push, still, contacts, arms, island, most, p):
            break
    if are_deep(contacts, p):
        _, _, more = velocity_sweep_2d(push, spin, J_push, aim, give, contacts, arms, smooth)
        check_left(share_left(more, J_push, push, still, contacts, arms))
    gap = contacts.gap + dt * normal_velocities_2d(push, spin, contacts, arms)
    moved = ContactSet(contacts.first, contacts.a, contacts.b, contacts.n, contacts.p, gap)
    return PileState(x + dt * push, q + dt * spin, v, omega, moved, J)


def leave_open(x, q, v, omega, links, dt, p):
    """Return what a function that closes links returns, of bodies without any."""
    return v, omega, links


def separate(load, bounds, narrow, t, state, dt, p):
    """Return the state with bodies moved out of each other, and with the velocities that they have.

    Sweeps without friction find velocities that remove the share PUSH_OUT of each overlap deeper than p.slop.  Open
    contacts may close.  The bodies move with these velocities for dt and then lose them, so nothing gains kinetic
    energy.  Raises Diverged where bodies are deep in each other and have no room to part.
    *Source:* split impulses, as in Bullet.
    """
    return state if all_shallow(state.contacts, p) else separated(leave_open, np.zeros(0), state, dt, p)


def separate_with_joints(load, bounds, narrow, t, state, dt, p):
    """Return the same with joints that stay closed.  An open one would be closed by a velocity, which is then kept."""
    return state if all_shallow(state.contacts, p) else separated(close_rigid_2d, np.zeros(0), state, dt, p)


def separate_with_rods(load, bounds, narrow, t, state, dt, p):
    """Return the same with joints and rods; a compliant rod keeps the force that it has, and gives way to more."""
    if all_shallow(state.contacts, p):
        return state
    return separated(close_links, impulses_at_rest(state.x, state.q, dt, p), state, dt, p)


# ---------------------------------------------------------------------------------------------- joints and motion

def close(load, bounds, narrow, t, state, dt, p):
    """Return the state with velocities that leave no joint open at the end of the step."""
    x, q, v, omega, contacts, J = state
    v, omega = close_joints_2d(x, q, v, omega, dt, p)
    return PileState(x, q, v, omega, contacts, J)


def hold(load, bounds, narrow, t, state, dt, p):
    """Return the state with velocities at which the joints' points do not part."""
    x, q, v, omega, contacts, J = state
    v, omega = hold_joints_2d(q, v, omega, p)
    return PileState(x, q, v, omega, contacts, J)


def move(load, bounds, narrow, t, state, dt, p):
    """Return the state after all bodies have moved on; none turns."""
    x, q, v, omega, contacts, J = state
    return PileState(x + dt * v, q, v, omega, contacts, J)


def move_and_turn(load, bounds, narrow, t, state, dt, p):
    """Return the state after all bodies have moved and turned on."""
    x, q, v, omega, contacts, J = state
    return PileState(x + dt * v, q + dt * omega, v, omega, contacts, J)


def leave(load, bounds, narrow, t, state, dt, p):
    """Return the state unchanged.  It fills the places of a loop that has fewer than six parts."""
    return state
