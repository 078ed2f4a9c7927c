"""What moves in the room: a function for each thing, made of parts that lessons write.

use = {exercise: function} has the parts: the student's, a given one, or what is left where the part is switched off.
Each function returns {name: places (pictures, points, 2) to draw [m]}, and LINES says how the points are joined.
*Left out:* what things do to each other beside what a function names; a box that tips over the edge of the sill.
"""

from functools import partial
from typing import NamedTuple

import numpy as np

from solutions.collisions import Plane
from solutions.given.bodies import Bodies
from solutions.impulses import BodyState2D
from solutions.rotation import Top
from solutions.support.contact_points import ContactSet, box_bounds_2d, box_contacts_2d
from solutions.support.quaternions import rotate
from solutions.support.scenes import PileState

from ...reference.orientation import about, quaternion
from ...scenes.drawing import circle
from . import room
from .room import FRAME, PICTURES, ROOM, G

DOWN = np.array([0.0, -G])
ROUND = 16                                       # corners of a drawn circle
LOOP = (0, 1, 2, 3, 0)


def path(first, count, closed=True):
    """Return the line through so many points from number `first` on."""
    return (*range(first, first + count), *[first] * closed)


LINES = {                                        # {thing: the lines through the numbers of its points}
    "curtain": tuple(map(tuple, room.SEEN_THREADS.tolist())), "cushion": (path(0, ROUND),), "arm": (path(0, 4, False),),
    "ball": (path(0, ROUND), (0, ROUND // 2)), "roller": (path(0, ROUND), (0, ROUND // 2)),
    "box": (LOOP,), "book": (LOOP,), "parcel": (LOOP,),
    "stack": tuple(path(4 * k, 4) for k in range(room.STACK)), "picture": (path(1, 4), (1, 0, 2)),
    "die": (path(0, 4), path(4, 4), *((k, k + 4) for k in range(4))),
    "top": (path(2, ROUND), (0, 1), *((0, 2 + k) for k in range(0, ROUND, 4)))}


def flat(places):
    """Return places (…, 2) to draw of places (…, 3): z comes obliquely towards the viewer, to the lower left."""
    return places[..., :2] + places[..., 2:] * [-0.4, -0.3]


def turned(q):
    """Return the matrix of an angle."""
    return np.array([(np.cos(q), -np.sin(q)), (np.sin(q), np.cos(q))])


def corners(half):
    """Return the corners (4, 2) of a box of these half sizes."""
    return np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]) * half


def fallen(x, v, t):
    """Return the place after a free flight of t."""
    return x + t * v + 0.5 * t * t * DOWN


# ---------------------------------------------------------------------------------------------- the curtain

class Net(NamedTuple):
    """The curtain, as functions of lessons 2 and 8 read it."""
    inv_mass: np.ndarray     # (n,) [1/kg]; 0 at a ring
    gravity: np.ndarray      # (3,) [m/s²]
    wind: np.ndarray         # (3,) [N]
    k_v: float               # [N s/m]
    i: np.ndarray            # (s,) ends of the threads
    j: np.ndarray
    rest: np.ndarray         # (s,) [m]
    k: np.ndarray            # (s,) [N/m]
    k_d: np.ndarray          # (s,) [N s/m]
    stiffness: np.ndarray    # (s,) [-]
    alpha: np.ndarray        # (s,) [m/N]
    sweeps: int


class Solid(NamedTuple):
    """A ball that points stay outside of."""
    centre: np.ndarray       # (3,) [m]
    radius: float            # [m]


def net():
    """Return the curtain as a Net."""
    each = np.ones(len(room.THREADS))
    return Net(room.FREE / room.POINT, np.array([0.0, -G, 0.0]), room.WIND, room.AIR, *room.THREADS.T.copy(), room.LONG,
               room.K * each, room.DAMPING * each, each, 0.0 * each, 1)


def threads_pull(x, v, net):
    """Given.  Return the forces (n, 3) of all threads: Hooke's law and a damper along each."""
    way, rate = x[net.j] - x[net.i], v[net.j] - v[net.i]
    size = np.linalg.norm(way, axis=1, keepdims=True)
    along = way / size
    pull = (net.k[:, None] * (size - net.rest[:, None])
            + net.k_d[:, None] * np.sum(rate * along, axis=1, keepdims=True)) * along
    total = np.zeros_like(x)
    np.add.at(total, net.i, pull)
    np.subtract.at(total, net.j, pull)
    return total


def curtain_law(use):
    """Return the acceleration of the curtain: weight, air (2.2) and threads (2.7)."""
    def law(t, x, v, net):
        force = use["2.7"](x, v, net) + use["2.2"](v, net.wind, net.k_v)
        return net.inv_mass[:, None] * force + (net.inv_mass > 0.0)[:, None] * net.gravity
    return law


def constrained(use, t, x, v, dt, net):
    """Advance a curtain whose threads do not stretch (8.6), and which stays in front of a ball (8.11)."""
    free = net.inv_mass[:, None] > 0.0
    ahead = v + dt * (free * net.gravity + net.inv_mass[:, None] * (net.wind - net.k_v * v))
    new = use["8.6"](x + dt * ahead, net)
    solid = Solid(room.cushion(t + dt), room.CUSHION)
    new = use["8.11"](outside, new, net.inv_mass, solid)
    return new, (new - x) / dt


def outside(x, solid):
    """Given.  Return (distance from the surface of a ball, outward normal)."""
    way = x - solid.centre
    length = np.linalg.norm(way)
    return length - solid.radius, way / max(length, 1e-12)


def hanging(step, rings=None, steps=8):
    """Return places (pictures, n, 3) of the curtain: step(t, x, v, dt, net) → (x, v), so many steps per picture.

    rings: t → how far the rings are apart, which are then drawn along the pole.  What is no longer finite stays.
    """
    x, cloth, seen = room.hung(room.SPREAD), net(), []
    v, dt, at = np.zeros_like(x), FRAME / steps, list(room.RINGS)
    for k in range(PICTURES):
        seen.append(x)
        for s in range(steps):
            t = k * FRAME + s * dt
            if rings:
                v = v.copy()
                v[at] = (room.hung(rings(t + dt))[at] - x[at]) / dt
            x, v = step(t, x, v, dt, cloth)
            x = np.where(np.abs(x) < 10.0, x, seen[-1])
    return np.array(seen)


def moved(use):
    """The curtain, by a step of lesson 1 (1.5); its forces are given."""
    return {"curtain": flat(hanging(partial(use["1.5"], given_law)))}


def curtain(use):
    """The curtain, by the air (2.2) and the threads (2.7) of lesson 2."""
    return {"curtain": flat(hanging(partial(velocity_first, curtain_law(use))))}


def cloth(use, steps=8):
    """The curtain of lesson 8; where 8.6 is off, threads are the springs of lesson 2."""
    def step(t, x, v, dt, net):
        if use["8.6"] is not None:
            return constrained(use, t, x, v, dt, net)
        v = v + dt * given_law(t, x, v, net)
        new = use["8.11"](outside, x + dt * v, net.inv_mass, Solid(room.cushion(t + dt), room.CUSHION))
        return new, (new - x) / dt
    rim = room.CUSHION * circle(ROUND)
    balls = np.array([flat(room.cushion(k * FRAME)) + rim for k in range(PICTURES)])
    return {"curtain": flat(hanging(step, steps=steps)), "cushion": balls}


def velocity_first(law, t, x, v, dt, p):
    """Given.  Advance by the new velocity."""
    new = v + dt * law(t, x, v, p)
    return x + dt * new, new


def given_law(t, x, v, net):
    """Given.  Return the acceleration of the curtain of lesson 2."""
    return curtain_law(GIVEN_CLOTH)(t, x, v, net)


def blown(v, wind, k_v):
    """Given.  Return the force of the air: a point that moves with the wind feels none."""
    return k_v * (np.asarray(wind) / k_v - v)


GIVEN_CLOTH = {"2.2": blown, "2.7": threads_pull}


# ---------------------------------------------------------------------------------------------- the ball

STILL = BodyState2D(np.zeros(2), 0.0, 0.0, 0.0)  # what the ball hits does not move
THROWN_DT = 0.05                                 # step of the ball in lesson 1, which is long [s]


def thrown(use, dt=THROWN_DT):
    """The ball that is thrown up, in long steps (1.6); between them it is drawn on a straight line."""
    body, rim = ROOM.bodies[room.BALL], ROOM.bodies[room.BALL].shape.radius * circle(ROUND)
    x, v, places = np.array(body.x), np.array(body.v), []
    times = dt * np.arange(round(room.SECONDS / dt) + 1)
    for t in times:
        places.append(x)
        x, v = use["1.6"](lambda *_: DOWN, t, x, v, dt, None)
    seen = FRAME * np.arange(PICTURES)
    centres = np.stack([np.interp(seen, times, along) for along in np.transpose(places)], axis=1)
    return {"ball": centres[:, None] + rim}


def ball(use):
    """The ball that is thrown at the rail: two tests (6.4, 6.2), and an impulse (7.4, or 7.10 with friction)."""
    body = ROOM.bodies[room.BALL]
    x, v, q, omega, seen = np.array(body.x), np.array(body.v), 0.0, 0.0, []
    rim = body.shape.radius * circle(ROUND)
    for k in range(PICTURES):
        seen.append(x + rim @ turned(q).T)
        found = first_touch(use, k * FRAME, x, fallen(x, v, FRAME), body.shape.radius)
        if found is None:
            x, v = fallen(x, v, FRAME), v + FRAME * DOWN
        else:
            share, n = found
            x, v = x + share * (fallen(x, v, FRAME) - x), v + share * FRAME * DOWN
            v, omega = bounced(use, v, omega, n, body)
            x, v = x + (1.0 - share) * FRAME * v, v + (1.0 - share) * FRAME * DOWN
        q += FRAME * omega
    return {"ball": np.array(seen)}


def first_touch(use, t, x, x_1, r):
    """Return (share of the step, normal) of the first touch of rail or floor on a straight way, or None."""
    rail = ROOM.bodies[room.RAIL]
    from_rail = [np.append(0.0, place - rail.x) for place in (x, x_1)]
    at_rail = use["6.4"](t, FRAME, *from_rail, r, rail.shape.radius)
    at_floor = use["6.2"](t, FRAME, x, x_1, r, Plane(np.array([0.0, 1.0]), 0.0))
    first = min(at_rail, at_floor)
    if not first <= t + FRAME:
        return None
    share = (first - t) / FRAME
    way = x + share * (x_1 - x) - rail.x
    return share, way / np.linalg.norm(way) if at_rail <= at_floor else np.array([0.0, 1.0])


def bounced(use, v, omega, n, body):
    """Return (v, ω) after an impact on something that does not move; a slow one does not bounce."""
    r = -body.shape.radius * n
    state = BodyState2D(v, omega, 1.0 / body.m, 1.0 / body.inertia)
    u = use["7.3"](state, STILL, r, np.zeros(2))
    if u @ n >= 0.0:
        return v, omega
    e = body.e if -(u @ n) > 2.0 * G * FRAME else 0.0
    if use["7.10"] is None:
        J = use["7.4"](u @ n, 1.0 / body.m, e) * n
    else:
        lever = body.shape.radius**2 / body.inertia
        across = np.array([-n[1], n[0], 0.0])
        K = np.eye(3) / body.m + lever * (np.outer(across, across) + np.diag([0.0, 0.0, 1.0]))
        J = use["7.10"](np.append(u, 0.0), np.append(n, 0.0), K, -e * (u @ n), body.mu)[:2]
    new = use["7.6"](state, r, J)
    return new.v, new.omega


def slip_of(a, b, r_a, r_b):
    """Given.  Return the velocity of a point of a body, which touches another one, relative to that one."""
    return a.v - b.v + a.omega * np.array([-r_a[1], r_a[0]]) - b.omega * np.array([-r_b[1], r_b[0]])


def pushed(body, r, J):
    """Given.  Return the body after an impulse at the offset r."""
    turn = body.inv_inertia * (r[0] * J[1] - r[1] * J[0])
    return body._replace(v=body.v + body.inv_mass * J, omega=body.omega + turn)


def rail_time(t, dt, x_0, x_1, r, R):
    """Given.  Return the time at which a ball on a straight way first touches a rail."""
    a, b = x_0[1:], x_1[1:]
    if not np.all(np.isfinite(np.append(a, b))):
        return np.inf
    s = np.roots([(b - a) @ (b - a), 2.0 * a @ (b - a), a @ a - (r + R) ** 2])
    if a @ a <= (r + R) ** 2:
        return t
    reached = [z.real for z in s if abs(z.imag) < 1e-12 and 0.0 <= z.real <= 1.0]
    return t + dt * min(reached, default=np.inf)


def looked_late(t, dt, x_0, x_1, r, R):
    """Return the end of a step at which a ball and a rail overlap; what happens within the step is not seen."""
    return t + dt if np.linalg.norm(x_1[1:]) < r + R else np.inf


def floor_time(t, dt, x_0, x_1, r, wall):
    """Given.  Return the time at which a ball on a straight way touches the floor."""
    high, low = x_0 @ wall.n + wall.d - r, x_1 @ wall.n + wall.d - r
    return t if high <= 0.0 else t + dt * high / (high - low) if low <= 0.0 else np.inf


def flight(law, t, x, v, dt, p):
    """Given.  Return (x, v) after a free flight."""
    return fallen(x, v, dt), v + dt * DOWN


# ---------------------------------------------------------------------------------------------- friction

class Support(NamedTuple):
    """A body on a plane, as functions of lesson 3 read it."""
    n: np.ndarray            # (2,) unit normal
    mu_s: float
    mu_k: float
    mu: float
    m: float                 # [kg]
    e: float
    gravity: np.ndarray      # (2,) [m/s²]
    point: np.ndarray        # (2,) of the plane


def box(use):
    """The box that slides along the sill, and falls if it does not stop (3.7)."""
    body = ROOM.bodies[room.BOX]
    half = np.array(body.shape.half)
    on = Support(np.array([0.0, 1.0]), body.mu, body.mu, body.mu, body.m, 0.0, DOWN, np.zeros(2))
    x, v, seen, dt = np.array(body.x), np.array(body.v), [], FRAME / 4
    for k in range(4 * PICTURES):
        if k % 4 == 0:
            seen.append(x + corners(half))
        if x[0] < room.SILL_END:
            x, v = use["3.7"](lambda *_: DOWN, k * dt, x, v, dt, on)
        else:
            x, v = fallen(x, v, dt), v + dt * DOWN
        if x[1] < half[1]:
            x, v = np.array([x[0], half[1]]), np.zeros(2)
    return {"box": np.array(seen)}


def smooth_lid(law, surface, t, x, v, dt, on):
    """Advance a book on a lid without friction."""
    return smooth_slide(law, t, x, v, dt, on)


def smooth_slide(law, t, x, v, dt, on):
    """Advance a body on a plane without friction: it stays on the plane."""
    a = law(t, x, v, on)
    v = v + dt * (a - (a @ on.n) * on.n)
    return x + dt * v, v


def book(use):
    """The book on the slanted lid of a chest (3.16); at its lower end it stops."""
    along = (room.LID[1] - room.LID[0]) / np.linalg.norm(room.LID[1] - room.LID[0])
    n = np.array([-along[1], along[0]])
    on = Support(n, 0.6, 0.6, 0.6, 1.0, 0.0, DOWN, room.LID[0])
    start = room.LID[0] + 0.15 * along
    x, v, seen, dt = start, np.zeros(2), [], FRAME / 4
    turn = np.stack((along, n), axis=1)
    for k in range(4 * PICTURES):
        if k % 4 == 0:
            seen.append(x + (corners(room.BOOK) + np.array([0.0, room.BOOK[1]])) @ turn.T)
        if (x - room.LID[0]) @ along < 0.75:
            x, v = use["3.16"](lambda *_: DOWN, lid_gap, k * dt, x, v, dt, on)
    return {"book": np.array(seen)}


def lid_gap(x, on):
    """Given.  Return (distance from the plane, its normal)."""
    return on.n @ (x - on.point), on.n


# ---------------------------------------------------------------------------------------------- inertia, rotation

def picture(use):
    """The picture that swings on its nail, by its moment of inertia (4.5) about the nail (4.11)."""
    body, d = ROOM.bodies[room.PICTURE], room.HANGS
    size = np.array([0.5, 2.0 * d, 0.0])
    I = use["4.11"](use["4.5"](body.m, size), body.m, np.array([0.0, d, 0.0]))[2, 2]
    theta, rate, seen, dt = room.TILT, 0.0, [], FRAME / 16
    shape = np.concatenate(([(0.0, 0.0)], corners(0.5 * size[:2])[[2, 3, 0, 1]] - [0.0, d + 0.06]))
    for k in range(16 * PICTURES):
        if k % 16 == 0:
            seen.append(room.NAIL + shape @ turned(theta).T)
        if I > 0.0:                                                  # without a moment, no law moves it
            rate -= dt * body.m * G * d / I * np.sin(theta)
            theta += dt * rate
    return {"picture": np.array(seen)}


TOSSED, TURNS = np.array([-0.28, 0.3]), np.array([2.0, -5.0, 3.0])           # of a die [m], [rad/s]


def die(use):
    """The die that is tossed again and again, and turns (5.10)."""
    up, q, seen = 4.8, np.array([1.0, 0.0, 0.0, 0.0]), []
    half = np.array([0.09, 0.09, 0.09])
    cube = np.array([(*corner, z) for z in (-1.0, 1.0) for corner in corners(1.0)]) * half
    for k in range(4 * PICTURES):
        t = k * FRAME / 4 % (2.0 * up / G)
        if k % 4 == 0:
            centre = np.append(fallen(TOSSED, np.array([0.0, up]), t), 0.0)
            seen.append(flat(centre + cube @ use["5.9"](q).T))
        q = use["5.10"](q, TURNS, FRAME / 4)
    return {"die": np.array(seen)}


def matrix_of(q):
    """Given.  Return the matrix of a quaternion."""
    return np.array([rotate(q, axis) for axis in np.eye(3)]).T


def top(use):
    """The top that gravity makes go round (5.15)."""
    body = Top(room.TOP_I, room.TOP_MGL)
    R = about(np.array([0.0, 1.0, 0.0]), room.LEAN)                  # z is up here
    L, seen, dt = room.SPIN * room.TOP_I[2] * R[:, 2], [], FRAME / 16
    for k in range(16 * PICTURES):
        if k % 16 == 0:
            seen.append(top_drawn(R))
        omega = R @ ((R.T @ L) / room.TOP_I)
        half = turn_by(0.5 * dt * omega) @ R
        L = L + dt * use["5.15"](k * dt, quaternion(half), L, body)
        omega = half @ ((half.T @ L) / room.TOP_I)
        R = turn_by(dt * omega) @ R
    return {"top": np.array(seen)}


def turn_by(angles):
    """Return the matrix of a rotation by |angles| about angles."""
    size = np.linalg.norm(angles)
    return about(angles / size, size)


def top_drawn(R):
    """Return foot, tip and rim of a top: its z is the room's y."""
    rim = np.column_stack((room.TOP_RADIUS * circle(ROUND), np.full(ROUND, 0.7 * room.TOP_LENGTH)))
    own = np.concatenate(([(0.0, 0.0, 0.0), (0.0, 0.0, room.TOP_LENGTH)], rim)) @ R.T
    return room.FOOT + flat(own[:, [0, 2, 1]] * [1.0, 1.0, -1.0])


# ---------------------------------------------------------------------------------------------- the stack

SWEEPS, STACK_DT = 8, FRAME / 2                  # per step; step of the stack [s]


def stack(use, sweeps=SWEEPS):
    """Boxes that stand on each other, by sweeps (9.4) that begin with the impulses of the last step (9.14)."""
    bodies = ROOM.bodies[room.PILE:]
    half, n = bodies[0].shape.half[1], len(bodies)
    A = 2.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    A[0, 0] = 1.0                                                    # the floor does not move
    y, v, J, old, seen = np.array([body.x[1] for body in bodies]), np.zeros(n), np.zeros((n, 2)), None, []
    for k in range(2 * PICTURES):
        if k % 2 == 0:
            seen.append(stack_drawn(bodies, y))
        gaps = np.diff(np.append(-half, y)) - 2.0 * half
        now = contacts_of(y - half, gaps)
        v = v - STACK_DT * G
        lam = use["9.14"](now, old or now, J, 0.02)[:, 1]
        approach = np.diff(np.append(0.0, v)) + np.maximum(gaps, 0.0) / STACK_DT
        for _ in range(sweeps):
            lam = use["9.4"](A, approach, lam, 1.0)
        v = v + lam - np.append(lam[1:], 0.0)
        y, J, old = y + STACK_DT * v, np.stack((0.0 * lam, lam), axis=1), now
    return {"stack": np.array(seen)}


def stack_drawn(bodies, y):
    """Return the corners of all boxes."""
    return np.concatenate([np.array([bodies[0].x[0], high]) + corners(np.array(body.shape.half))
                           for high, body in zip(y, bodies, strict=True)])


def contacts_of(places, gaps):
    """Return the ContactSet of a stack: contact k lies below box k."""
    n = len(places)
    return ContactSet(np.arange(n + 1), np.arange(n), np.append(n, np.arange(n - 1)), np.tile([0.0, 1.0], (n, 1)),
                      np.stack((np.zeros(n), places), axis=1), gaps)


def one_by_one(A, b, lam, omega):
    """Given.  Return λ after a visit to each contact, which may push and never pull."""
    lam = np.array(lam)
    for k, row in enumerate(A):
        rest = row @ lam - row[k] * lam[k] + b[k]
        lam[k] = max(-rest / row[k], 0.0)
    return lam


def remembered(now, old, J, near):
    """Given.  Return the impulses of the last step: the contacts of a stack keep their order."""
    return J


# ---------------------------------------------------------------------------------------------- the loop

BOXES = (room.SILL, room.BOX, room.PARCEL, *range(room.PILE, room.PILE + room.STACK))
LOOP_DT = FRAME / 4                              # [s]


def boxes():
    """Return (PileState, Bodies) of the Model's boxes at the start, and of the floor in the last row."""
    bodies = [ROOM.bodies[k] for k in BOXES]
    pad = lambda rows: np.concatenate((rows, np.zeros((1, *np.shape(rows)[1:]))))
    empty = ContactSet(np.zeros(len(bodies) + 2, np.int64), np.zeros(0, np.int64), np.zeros(0, np.int64),
                       np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0))
    state = PileState(*(pad(np.array([getattr(b, name) for b in bodies], float)) for name in ("x", "q", "v", "omega")),
                      empty, np.zeros((0, 2)))
    p = Bodies(pad(np.array([1.0 / b.m for b in bodies])), pad(np.array([1.0 / b.inertia for b in bodies])),
              np.array([b.shape.half for b in bodies]), np.array([(0.0, 1.0, 0.0)]), DOWN, room.RUBS, 10, 0.02)
    return state, p


def weights(t, x, q, v, omega, p):
    """Given.  Return the load of gravity on boxes."""
    masses = np.divide(1.0, p.inv_mass, out=np.zeros_like(p.inv_mass), where=p.inv_mass > 0.0)
    return masses[:, None] * p.gravity, np.zeros_like(omega)


def boxes_drawn(state):
    """Return the corners (4, 2) of every box."""
    return [x + corners(half) @ turned(q).T for x, q, half in zip(state.x, state.q, boxes()[1].half)]


def pile(use):
    """All boxes of the room, by the loop of lesson 10 (10.6)."""
    state, p = boxes()
    seen = []
    for k in range(4 * PICTURES):
        if k % 4 == 0:
            seen.append(boxes_drawn(state))
        state = use["10.6"](weights, box_bounds_2d, box_contacts_2d, k * LOOP_DT, state, LOOP_DT, p)
    seen = np.array(seen)
    return {"box": seen[:, 1], "parcel": seen[:, 2], "stack": seen[:, 3:].reshape(PICTURES, -1, 2)}


def parcel(use):
    """The parcel that is thrown, before anything is in its way, by its velocities (10.1) or a whole step (10.3)."""
    state, p = boxes()
    step = use["10.3"] or partial(new_velocity_first, use["10.1"])
    seen = []
    for k in range(4 * PICTURES):
        if k % 4 == 0:
            seen.append(boxes_drawn(state)[2])
        x, q, v, omega = step(weights, k * LOOP_DT, state.x, state.q, state.v, state.omega, LOOP_DT, p)
        state = state._replace(x=x, q=q, v=v, omega=omega)
    return {"parcel": np.array(seen)}


def new_velocity_first(velocities, load, t, x, q, v, omega, dt, p):
    """Given.  Return (x, q, v, omega): the new velocities move the bodies."""
    v, omega = velocities(load, t, x, q, v, omega, dt, p)
    return x + dt * v, q + dt * omega, v, omega


def moved_freely(load, bounds, narrow, t, state, dt, p):
    """Advance boxes that nothing stops: no contact is found."""
    v = state.v + dt * (p.inv_mass > 0.0)[:, None] * p.gravity
    return state._replace(x=state.x + dt * v, q=state.q + dt * state.omega, v=v)


# ---------------------------------------------------------------------------------------------- the arm

def arm_angles(use):
    """Return the angles (pictures, 3) of the arm that follows its wish by 11.11, or by 11.15 within its limits."""
    step = use["11.15"] or use["11.11"]
    theta, seen = room.REST, []
    for k in range(PICTURES):
        seen.append(theta)
        for s in range(4):
            theta = step(reach, theta, room.wish((k + 0.25 * (s + 1)) * FRAME), room.ARM)
    return np.array(seen)


def reach(theta, target, arm):
    """Given.  Return (what is left to the target (2,), Jacobian (2, 3)) of the arm's hand."""
    places = room.joints(theta)
    ways = places[-1] - places[:-1]
    return target - places[-1], np.stack((-ways[:, 1], ways[:, 0]))


def arm(use, threads=None):
    """The arm that draws the curtain: the rings are where its hand is, from GRIP on."""
    angles = arm_angles(use)
    hands = np.array([room.joints(theta) for theta in angles])
    width = (room.COLS - 1) * room.CELL
    times, spread = FRAME * np.arange(PICTURES), (hands[:, -1, 0] - room.CORNER[0]) / width
    held = np.linalg.norm(hands[round(room.GRIP / FRAME), -1] - room.wish(room.GRIP)) < 0.05
    rings = lambda t: np.interp(max(t, room.GRIP), times, np.clip(spread, 0.1, 1.0)) if held else room.SPREAD
    rings_from = lambda t: room.SPREAD if t < room.GRIP else rings(t)
    return {"curtain": flat(hanging(threads or partial(velocity_first, given_law), rings_from)), "arm": hands}


def stay(task, theta, target, arm):
    """Return the angles: the arm does not move."""
    return theta


def unlimited(task, theta, target, arm):
    """Given.  Return the angles after a damped step that knows no limits."""
    e, J = task(theta, target, arm)
    return theta + J.T @ np.linalg.solve(J @ J.T + arm.damping**2 * np.eye(2), e)
