"""Given.  Impacts at several points for which sweeps do not settle: relaxed sweeps, then every choice of contact modes.

A point is open (no impulse), it sticks, or it slides.  If one knows which, only the directions of sliding are unknown.
A function that needs an exercise takes it as an argument.  Arrays of all points have three entries per point, along its
normal and along two sides: u (3 points,) velocities, J (3 points,) impulses, A (3 points, 3 points) [1/kg], so that
u⁺ = u + A J.
"""

from typing import NamedTuple

import numpy as np

from ..vectors import cross, inverse, norm
from .impacts import (
    CONVERGED,
    impact_residual,
    largest_speed,
    most_dissipative_impact,
    project_onto_cone,
    rebound_speeds,
    times,
    velocity_at,
)

OPEN, STICKS, SLIDES = 0, 1, 2
MAX_POINTS = 4               # with more, 3^points modes take too long [-]
RELAXED_SWEEPS = 500         # [-]; where they settle, 56 to 257 have been needed
HOLDING_ROUNDS = 200         # of holding_impulses [-]; most cones contain the first ones
SOLVED = 1e-10               # residual of an answer over the largest initial |v| + |ω||r| [-]: four digits are lost
ROUND_OFF = 1e-12            # of the velocity at which an open point separates, over the largest initial one [-]
LAST_DIGIT = 2.2e-16         # of a number, over it [-]
DEPENDENT = 1e-11            # singular value of rows that depend on others, over the largest [-]
ANGLE = 1e-7                 # for differences of the slip over the angle [rad]: half the digits
TURN = 0.5                   # longest Newton step [rad]
STILL = 1e-13                # Newton step that ends the search [rad]
ROUNDS = 30                  # of Newton's method [-]; with 16 some answers are missed
STARTS = (1, 18, 66, 66, 66) # of Newton's method for so many sliding points [-]; with 1, 16, 48 and 16 some are missed
FREE_ROWS = (6, 3, 1, 0, 0)  # motions that are left to a body that sticks at so many points [-]
EVEN = 0.8566748838545029    # (Eᵏ, E²ᵏ, …) without whole parts fill the unit cube evenly: 1/E solves x⁵ = x + 1


class Impact(NamedTuple):
    """What all choices of modes share."""
    u: np.ndarray            # (3 points,) before the impact [m/s]
    A: np.ndarray            # (3 points, 3 points) [1/kg]
    sides: np.ndarray        # (points, 2, 2) block of K⁻¹ across the normal [kg]
    frames: np.ndarray       # (points, 3, 3) rows: the normal and two sides
    u_sep: np.ndarray        # (points,) [m/s]
    mu: float


class Sliding(NamedTuple):
    """The s sliding points of one choice of modes, of a body that is held where it sticks."""
    along: np.ndarray        # (s, s, 3) rows of A along the normals
    across: np.ndarray       # (2s, 3s) rows of A across them
    wanted: np.ndarray       # (s,) missing velocities along the normals [m/s]
    slip: np.ndarray         # (2s,) velocities across them without impulses [m/s]
    sides: np.ndarray        # (s, 2, 2) of Impact
    beta: float              # half the angle of the cone [rad]


def impact_of(contact_matrix, apply_impulse, body, r, n, e, mu):
    """Return an Impact.  Column 3 i + c of A is what a unit impulse at point i along its axis c does to all points."""
    k = len(r)
    u, A, sides, frames = np.zeros(3 * k), np.zeros((3 * k, 3 * k)), np.zeros((k, 2, 2)), np.zeros((k, 3, 3))
    for i in range(k):
        axis = np.zeros(3)
        axis[np.argmin(np.abs(n[i]))] = 1.0
        frames[i, 0] = n[i]
        frames[i, 1] = cross(n[i], axis) / norm(cross(n[i], axis))
        frames[i, 2] = cross(n[i], frames[i, 1])
        u[3 * i:3 * i + 3] = times(frames[i], velocity_at(body, r[i]))
        K_inverse = inverse(contact_matrix(r[i], body.inv_mass, body.inv_inertia))
        for a in range(2):
            for b in range(2):
                sides[i, a, b] = frames[i, 1 + a] @ times(K_inverse, frames[i, 1 + b])
    for i in range(k):
        for c in range(3):
            pushed = apply_impulse(body, r[i], frames[i, c].copy())
            for l in range(k):
                A[3 * l:3 * l + 3, 3 * i + c] = times(frames[l], velocity_at(pushed, r[l]) - velocity_at(body, r[l]))
    return Impact(u, A, sides, frames, rebound_speeds(body, r, n, e), mu)


def relaxed_sweeps(contact_matrix, cone_impulse, apply_impulse, body, r, n, e, mu):
    """Return (BodyState3D, residual) after sweeps that go half of the way at each point, at most RELAXED_SWEEPS.

    Where whole sweeps jump to and fro between two sets of impulses, half of each often settles between them.
    """
    u_sep, Js = rebound_speeds(body, r, n, e), np.zeros((len(r), 3))
    after, speed = body, largest_speed(body, r)
    for _ in range(RELAXED_SWEEPS):
        change = 0.0
        for i in range(len(r)):
            K = contact_matrix(r[i], body.inv_mass, body.inv_inertia)
            u = velocity_at(after, r[i]) - times(K, Js[i])
            J = 0.5 * (cone_impulse(u, n[i], K, u_sep[i], mu) - Js[i])
            change = np.maximum(change, np.abs(times(K, J)).max())
            after = apply_impulse(after, r[i], J)
            Js[i] += J
        if change <= CONVERGED * speed:
            break
    return after, impact_residual(contact_matrix, cone_impulse, after, r, n, Js, u_sep, mu)


def held_points(impact, modes):
    """Return (u, A, hold, aim) of a body that is held where it sticks: hold @ (aim − u) are impulses that hold it.

    u and A are those of the other impulses; hold (3 points, 3 points) is a pseudo-inverse.
    """
    k = modes.size
    chosen, aim, hold = np.zeros((3 * k, 3 * k)), np.zeros(3 * k), np.zeros((3 * k, 3 * k))
    for i in range(k):
        if modes[i] == STICKS:
            aim[3 * i] = impact.u_sep[i]
            for c in range(3 * i, 3 * i + 3):
                chosen[c, c] = 1.0
    if np.any(modes == STICKS):
        hold = chosen @ np.linalg.pinv(chosen @ impact.A @ chosen, DEPENDENT) @ chosen
    return impact.u + impact.A @ (hold @ (aim - impact.u)), impact.A - impact.A @ hold @ impact.A, hold, aim


def sliding_of(impact, points, u, A):
    """Return the Sliding of these points (s,), with u and A of held_points."""
    s = points.size
    along, across = np.zeros((s, s, 3)), np.zeros((2 * s, 3 * s))
    wanted, slip, sides = np.zeros(s), np.zeros(2 * s), np.zeros((s, 2, 2))
    for a in range(s):
        i = points[a]
        wanted[a] = impact.u_sep[i] - u[3 * i]
        slip[2 * a:2 * a + 2] = u[3 * i + 1:3 * i + 3]
        sides[a] = impact.sides[i]
        for b in range(s):
            l = 3 * points[b]
            along[a, b] = A[3 * i, l:l + 3]
            across[2 * a:2 * a + 2, 3 * b:3 * b + 3] = A[3 * i + 1:3 * i + 3, l:l + 3]
    return Sliding(along, across, wanted, slip, sides, np.arctan(impact.mu))


def slide(angles, p, clear):
    """Return (J (3s,), mismatch (s,)) where the points of a Sliding slide at these angles (s,) [rad].

    The sizes are such that all these points separate at u_sep; of several such sizes, the shortest.  mismatch is the
    part of K⁻¹(u_sep n − u⁺) across the impulse and the normal; the law of cone_impulse says that there is none.
    If clear, it is multiplied by the determinant of the equations for the sizes.  That removes its poles, and Newton's
    method finds other answers, but none where one of the points repeats what others say.
    """
    s = angles.size
    d = np.empty((s, 3))
    d[:, 0] = np.cos(p.beta)
    d[:, 1] = np.sin(p.beta) * np.cos(angles)
    d[:, 2] = np.sin(p.beta) * np.sin(angles)
    rows = np.sum(p.along * d, axis=2)
    determinant = np.linalg.det(rows)
    if not np.isfinite(determinant):
        return np.zeros(3 * s), np.full(s, np.nan)
    J = ((np.linalg.pinv(rows, DEPENDENT) @ p.wanted).reshape(s, 1) * d).ravel()
    slip = (p.slip + p.across @ J).reshape(s, 2)
    pull_1 = p.sides[:, 0, 0] * slip[:, 0] + p.sides[:, 0, 1] * slip[:, 1]
    pull_2 = p.sides[:, 1, 0] * slip[:, 0] + p.sides[:, 1, 1] * slip[:, 1]
    mismatch = pull_1 * np.sin(angles) - pull_2 * np.cos(angles)
    return J, determinant * mismatch if clear else mismatch


def find_angles(angles, p, clear):
    """Return the angles (s,) [rad] at which the points of a Sliding slide, by Newton's method from the given ones."""
    s = angles.size
    for _ in range(ROUNDS):
        _, mismatch = slide(angles, p, clear)
        slopes = np.zeros((s, s))
        for a in range(s):
            turned = angles.copy()
            turned[a] += ANGLE
            slopes[:, a] = (slide(turned, p, clear)[1] - mismatch) / ANGLE
        if not np.all(np.isfinite(slopes)):
            return angles
        step = np.linalg.pinv(slopes, DEPENDENT) @ mismatch
        longest = np.abs(step).max()
        angles = angles - step * (TURN / np.maximum(longest, TURN))
        if longest <= STILL:
            return angles
    return angles


def holding_impulses(impact, modes, hold, u, aim):
    """Return impulses (3 points,) that stop the sticking points, inside their cones where such are found soon.

    Where points hold each other, many impulses do the same.  Go to the nearest ones in the cones, and from there to the
    nearest ones that stop the points, and so on.
    """
    J, normal = hold @ (aim - u), np.array([1.0, 0.0, 0.0])
    for _ in range(HOLDING_ROUNDS):
        inside = J.copy()
        for i in range(modes.size):
            if modes[i] == STICKS:
                inside[3 * i:3 * i + 3] = project_onto_cone(J[3 * i:3 * i + 3], normal, impact.mu)
        old, J = J, inside + hold @ (aim - u - impact.A @ inside)
        if np.abs(J - old).max() <= CONVERGED * np.abs(J).max():
            return inside
    return J


def impulses_of_modes(contact_matrix, cone_impulse, apply_impulse, body, r, n, impact, modes, J):
    """Return (BodyState3D, residual [m/s]) after the impulses J (3 points,) of these modes.

    An open point that just separates at u_sep may do so less ROUND_OFF: the law jumps there if the point could stick.
    The residual is at least the round-off of what the impulses change.  Where the equations of two points are nearly
    the same, impulses may become so large that the velocities are lost in this round-off.
    """
    Js, after, u_sep = np.zeros((len(r), 3)), body, impact.u_sep.copy()
    for i in range(len(r)):
        for c in range(3):
            Js[i] += J[3 * i + c] * impact.frames[i, c]
        after = apply_impulse(after, r[i], Js[i])
        if modes[i] == OPEN:
            u_sep[i] -= ROUND_OFF * largest_speed(body, r)
    residual = impact_residual(contact_matrix, cone_impulse, after, r, n, Js, u_sep, impact.mu)
    return after, np.maximum(residual, LAST_DIGIT * np.abs(impact.A).max() * np.abs(J).max())


def directions_of_pull(after, r, impact):
    """Return the angles (points,) [rad] at which the law pushes each point if it slides with the velocities `after`."""
    angles = np.zeros(len(r))
    for i in range(len(r)):
        u = times(impact.frames[i], velocity_at(after, r[i]))
        pull = -impact.sides[i, :, 0] * u[1] - impact.sides[i, :, 1] * u[2]
        angles[i] = np.arctan2(pull[1], pull[0])
    return angles


def start_of(number, s):
    """Return the angles (s,) [rad] of one of the starts that fill all directions evenly."""
    angles = np.zeros(s)
    for a in range(s):
        angles[a] = 2.0 * np.pi * ((number + 1) * EVEN ** (a + 1) % 1.0)
    return angles


def try_modes(contact_matrix, cone_impulse, apply_impulse, body, r, n, impact, modes, near, starts, goal):
    """Return (BodyState3D, residual [m/s]) of these modes, from the first start that leaves at most the goal.

    starts: the number of the first one, and of the one after the last.  Half of them follow `slide` with clear, and
    the first two are the angles near (points,).
    """
    points = np.flatnonzero(modes == SLIDES)
    best, least = body, np.inf
    u, A, hold, aim = held_points(impact, modes)
    sliding, s = sliding_of(impact, points, u, A), points.size
    for start in range(starts[0], min(starts[1], STARTS[s])):
        J = np.zeros(u.size)
        if s > 0:
            angles = start_of(start // 2 - 1, s) if start > 1 else near[points]
            pushes, mismatch = slide(find_angles(angles, sliding, start % 2 == 0), sliding, False)
            if not np.all(pushes[::3] >= 0.0) or not np.all(np.isfinite(mismatch)):
                continue
            for a in range(s):
                J[3 * points[a]:3 * points[a] + 3] = pushes[3 * a:3 * a + 3]
        J += holding_impulses(impact, modes, hold, impact.u + impact.A @ J, aim)
        after, residual = impulses_of_modes(contact_matrix, cone_impulse, apply_impulse, body, r, n, impact, modes, J)
        if residual < least:
            best, least = after, residual
        if residual <= goal:
            break
    return best, least


def search_modes(contact_matrix, cone_impulse, apply_impulse, body, r, n, impact, near, starts, goal):
    """Return (BodyState3D, residual [m/s]) of the first choice of modes that leaves at most the goal; else of the last.
    """
    after, residual = body, np.inf
    for choice in range(3 ** len(r)):
        modes = np.array([choice // 3**i % 3 for i in range(len(r))])
        slides = np.sum(modes == SLIDES)
        if slides == 0 or slides <= FREE_ROWS[np.sum(modes == STICKS)]:
            after, residual = try_modes(contact_matrix, cone_impulse, apply_impulse, body, r, n, impact, modes, near,
                                        starts, goal)
            if residual <= goal:
                break
    return after, residual


def settle_impacts(contact_matrix, cone_impulse, apply_impulse, body, r, n, e, mu):
    """Given.  Return (BodyState3D, residual [m/s]) after impacts for which the sweeps of solve_impacts do not settle.

    1. relaxed_sweeps, and if these do not settle either:
    2. up to MAX_POINTS points: each may be open, stick or slide.  For every choice, Newton's method finds the
       directions of sliding: first from those after relaxed_sweeps, which often circle round an answer, and then from
       STARTS starts.  The first answer with a residual of at most SOLVED times largest_speed(body, r) is returned.
       Points that others make redundant count as open.
    3. most_dissipative_impact, whose residual shows that it is no answer of the law.
    With 3. there may still be an answer: that 2. finds one where there is one has been tested, not proved.
    """
    goal = SOLVED * largest_speed(body, r)
    after, residual = relaxed_sweeps(contact_matrix, cone_impulse, apply_impulse, body, r, n, e, mu)
    if residual <= goal:
        return after, residual
    if len(r) <= MAX_POINTS:
        impact = impact_of(contact_matrix, apply_impulse, body, r, n, e, mu)
        near = directions_of_pull(after, r, impact)
        for starts in ((0, 2), (2, max(STARTS))):
            after, residual = search_modes(contact_matrix, cone_impulse, apply_impulse, body, r, n, impact, near,
                                           starts, goal)
            if residual <= goal:
                return after, residual
    return most_dissipative_impact(contact_matrix, cone_impulse, apply_impulse, body, r, n, e, mu)
