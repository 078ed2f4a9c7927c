"""Exercises that stand in the place of another part, or do a piece of its work, in the same actors.

    in_place(actor, "1.6", "7.15", rebound)     # the actor, with rebound(exercise 7.15, …) where it calls part 1.6
"""

from functools import partial

import numpy as np

from solutions.collisions import Box, Contact
from solutions.given.bodies import Bodies
from solutions.impulses import BouncingBall
from solutions.inertia_tensors import MassProperties
from solutions.rotation import RigidBody, RollingBall
from solutions.support.geometry import outward
from solutions.support.quaternions import rotate, unrotate

from ...reference.orientation import quaternion
from ...scenes.drawing import circle
from . import actors, room
from .actors import DOWN, ROUND, Support, fallen, flat, turned
from .room import FRAME, PICTURES, ROOM, G

BALL = ROOM.bodies[room.BALL]
R_BALL = BALL.shape.radius
FINE = FRAME / 8                                 # step of what is thrown at something [s]
UP = np.array([0.0, 1.0])


def in_place(actor, place, number, form=None, given=()):
    """Return the actor with an exercise in the place of a part.

    form(function of the exercise, *arguments of the part) is what is called there; None: the exercise itself.
    given: (part, function) of further parts that are given here.
    """
    def act(use):
        own = use[number]
        return actor({**use, **dict(given), place: partial(form, own) if form else own})
    return act


# ---------------------------------------------------------------------------------------------- the thrown ball

EARTH, EARTH_M, GRAVITATION = np.array([0.0, -6.371e6]), 5.972e24, 6.674e-11


def straight(law, t, x, v, dt, p):
    """Advance without acceleration."""
    return x + dt * v, v


def no_contact(*step):
    """Advance freely; the floor is not seen.  The last five of `step` are t, x, v, dt and what else is there."""
    _, x, v, dt, _ = step[-5:]
    return fallen(x, v, dt), v + dt * DOWN


def attracted(gravity, law, t, x, v, dt, p):
    """Advance under the attraction of the Earth (2.1)."""
    a = gravity(x, EARTH, BALL.m, EARTH_M, GRAVITATION) / BALL.m
    return x + dt * v + 0.5 * dt * dt * a, v + dt * a


def pushed_out(force, law, t, x, v, dt, p):
    """Advance under weight and a soft floor: force(gap, its rate) along the normal."""
    v = v + dt * (law(t, x, v, p) + force(x[1] - R_BALL, v[1]) / BALL.m)
    return x + dt * v, v


def soft_floor(f, *step):
    """Advance over a floor by 2.5."""
    return pushed_out(lambda gap, rate: f(gap, rate, UP, 8000.0, 2.0), *step)


def penalty_floor(f, *step):
    """Advance over a floor by 7.2."""
    return pushed_out(lambda gap, rate: f(gap, rate, 8000.0, 2.0) * UP, *step)


def led(force, law, t, x, v, dt, p):
    """Advance a ball that a hand leads round (2.14)."""
    angle = 2.0 * np.pi * t / room.SECONDS
    target = np.array(BALL.x) + 0.5 * np.array([np.sin(angle), 1.0 - np.cos(angle)])
    v = v + dt / BALL.m * force(x, v, target, HAND, HAND_C, BALL.m, dt)
    return x + dt * v, v


HAND, HAND_C = 200.0, 12.0                       # spring [N/m] and damper [N s/m] of a hand


def pulled_now(x, v, target, k, c, m, dt):
    """Return the force of a hand at the beginning of a step."""
    return -k * (x - target) - c * v


ON_FLOOR = Support(UP, BALL.mu, BALL.mu, BALL.mu, BALL.m, BALL.e, DOWN, np.array([0.0, R_BALL]))
BOUNCING = BouncingBall(BALL.e, DOWN, np.array([0.0, R_BALL]), UP, 1e4, 10.0)


def on_floor(step, law, t, x, v, dt, p):
    """Advance over the floor by 3.14."""
    return step(law, actors.lid_gap, t, x, v, dt, ON_FLOOR)


def hit_floor(impulse, law, t, x, v, dt, p):
    """Advance over the floor; the impulse (3.13) changes the velocity, and the place is put back."""
    v = v + dt * law(t, x, v, p)
    x = x + dt * v
    gap = x[1] - R_BALL
    if gap < 0.0:
        v = v + impulse(v, UP, BALL.m, BALL.e, BALL.mu) / BALL.m
        x = x - gap * UP
    return x, v


def rebound(step, law, t, x, v, dt, p):
    """Advance over the floor by 7.15 or 7.16."""
    return step(law, t, x, v, dt, BOUNCING)


def repelled(field, law, t, x, v, dt, p):
    """Advance under weight and a field around the rail (6.16)."""
    rail = ROOM.bodies[room.RAIL]
    push = field(x, np.array(rail.x), rail.shape.radius + R_BALL, 0.2, 0.2)
    return hit_floor(bounce, lambda t, x, v, p: law(t, x, v, p) + push, t, x, v, dt, p)


def bounce(v, n, m, e, mu):
    """Given.  Return the impulse of a floor without friction."""
    return -(1.0 + e) * m * min(v @ n, 0.0) * n


# ---------------------------------------------------------------------------------------------- the curtain

def pulled_by(tension, x, v, net):
    """Return the forces of all threads, by 2.3."""
    way, rate = x[net.j] - x[net.i], v[net.j] - v[net.i]
    size = np.linalg.norm(way, axis=1)
    along = way / size[:, None]
    growth = np.sum(rate * along, axis=1)
    pull = np.array([tension(*one) for one in zip(size, growth, net.rest, net.k, net.k_d)])[:, None] * along
    total = np.zeros_like(x)
    np.add.at(total, net.i, pull)
    np.subtract.at(total, net.j, pull)
    return total


def tied(pairs, x, v, net):
    """Return the forces of the threads of a grid, and of the diagonal ones that 2.10 finds."""
    diagonal = pairs(room.ROWS, room.COLS, ((1, 1), (1, -1)))
    i, j = np.concatenate((room.SEEN_THREADS, diagonal)).T
    kept = len(i)
    return actors.threads_pull(x, v, net._replace(i=i, j=j, rest=net.rest[:kept], k=net.k[:kept], k_d=net.k_d[:kept]))


def with_law(acceleration, law, t, x, v, dt, net):
    """Advance the curtain, by the acceleration of 2.8."""
    return actors.velocity_first(acceleration, t, x, v, dt, net)


def only_weight(t, x, v, net):
    """Return the acceleration of points that nothing but weight moves."""
    return (net.inv_mass > 0.0)[:, None] * net.gravity


def free_fall(*step):
    """Advance a curtain that no thread holds.  The last four of `step` are x, v, dt and the net."""
    x, v, dt, net = step[-4:]
    v = v + dt * only_weight(0.0, x, v, net)
    return x + dt * v, v


def sweeping(visit, x, net):
    """Return the points after each thread has been visited: visit(x_i, x_j, rest, w) → how both ends move."""
    x, w = x.copy(), net.inv_mass
    for i, j, long in zip(net.i, net.j, net.rest):
        move = visit(x[i], x[j], long, w[[i, j]])
        x[i], x[j] = x[i] + move[0], x[j] + move[1]
    return x


def measured(constraint, x, net):
    """Return the points after a sweep whose threads are measured by 8.1."""
    def visit(x_i, x_j, long, w):
        C, n = constraint(x_i, x_j, long)
        part = C / (w[0] + w[1]) * n
        return -w[0] * part, w[1] * part
    return sweeping(visit, x, net)


def corrected(correction, x, net):
    """Return the points after a sweep whose ends are moved by 8.2."""
    def visit(x_i, x_j, long, w):
        way = x_i - x_j
        size = np.sqrt(way @ way)
        return correction(size - long, np.array((way, -way)) / size, w)
    return sweeping(visit, x, net)


def weight_and_air(t, x, v, net):
    """Given.  Return the acceleration of points that no thread holds."""
    return only_weight(t, x, v, net) + net.inv_mass[:, None] * (net.wind - net.k_v * v)


def predicted(predict, law, t, x, v, dt, net):
    """Advance the curtain by a prediction (8.3) and a given sweep."""
    new = shortened(predict(weight_and_air, t, x, v, dt, net), net)
    return new, (new - x) / dt


def shortened(x, net):
    """Given.  Return the points after each thread has been brought to its length, one after the other."""
    def visit(x_i, x_j, long, w):
        way = x_i - x_j
        part = (1.0 - long / np.sqrt(way @ way)) / (w[0] + w[1]) * way
        return -w[0] * part, w[1] * part
    return sweeping(visit, x, net)


def projected(step, law, t, x, v, dt, net):
    """Advance the curtain by 8.7."""
    return step(weight_and_air, t, x, v, dt, net)


def elastic(step, law, t, x, v, dt, net):
    """Advance a curtain of threads that stretch, by 8.14."""
    return step(weight_and_air, t, x, v, dt, net._replace(alpha=net.alpha + 1.0 / SOFT))


SOFT = 15.0                                      # stiffness of a thread that stretches [N/m]


def rigid(law, t, x, v, dt, net):
    """Given.  Advance a curtain of threads that do not stretch."""
    return predicted(ahead, law, t, x, v, dt, net)


def ahead(law, t, x, v, dt, net):
    """Given.  Return the places after dt without threads."""
    return x + dt * v + dt * dt * law(t, x, v, net)


def kept_out(gap, surface, x, w, solid):
    """Return the points with those inside the ball moved to its surface, which 8.10 measures."""
    x = x.copy()
    for k in np.flatnonzero(w):
        phi, n = gap(x[k], solid)
        if phi < 0.0:
            x[k] -= phi * n
    return x


# ---------------------------------------------------------------------------------------------- box and book

def supported(support, law, t, x, v, dt, on):
    """Advance the box by weight, its support (3.1) and friction."""
    F = on.m * law(t, x, v, on)
    held = support(F, on.n)
    v = v + dt / on.m * (F + held * on.n)
    v = v + stopped(v - (v @ on.n) * on.n, on.m, dt * held, on.mu) / on.m
    return x + dt * v, v


def stopped(v_t, m, j_n, mu):
    """Given.  Return the impulse of friction that stops what it can."""
    speed = np.linalg.norm(v_t)
    return -min(1.0, mu * j_n / max(m * speed, 1e-300)) * m * v_t


def by_impulse(friction, law, t, x, v, dt, on):
    """Advance the box on the sill by an impulse of friction (3.5, 3.19)."""
    a = law(t, x, v, on)
    v = v + dt * (a - (a @ on.n) * on.n)
    v = v + friction(v, on.m, -on.m * dt * (a @ on.n), on.mu) / on.m
    return x + dt * v, v


def braked(friction, law, t, x, v, dt, on):
    """Advance the box on the sill by kinetic friction (3.3), which does not turn it round."""
    F = on.m * law(t, x, v, on)
    smooth = v + dt / on.m * (F - (F @ on.n) * on.n)
    new = smooth + dt / on.m * friction(F, v, on.n, on.mu_k)
    new = new if new @ smooth > 0.0 else 0.0 * new
    return x + dt * new, new


def at_rest(friction, law, surface, t, x, v, dt, on):
    """Advance the book by weight, its support and static friction (3.2)."""
    F = on.m * law(t, x, v, on)
    v = v + dt / on.m * (F - (F @ on.n) * on.n + friction(F, on.n, on.mu_s))
    return x + dt * v, v


def put_back(correction, law, surface, t, x, v, dt, on):
    """Advance the book by impulses, and put it back along the surface by 3.15."""
    v = v + dt * law(t, x, v, on)
    moved = dt * v
    x = x + moved
    phi, n = surface(x, on)
    if phi < 0.0:
        v_n = v @ n
        v = v - v_n * n
        v = v + stopped(v, 1.0, -v_n, on.mu)
        x = x - phi * n + correction(moved, n, -phi, on.mu)
    return x, v


# ---------------------------------------------------------------------------------------------- inertia

def many_points(f, m, size):
    """Return the tensor of the picture about its nail, by 4.4: a hundred points with equal masses."""
    x, y = np.meshgrid((np.arange(10) - 4.5) / 10.0 * size[0], (np.arange(10) - 4.5) / 10.0 * size[1])
    return f(np.full(100, 0.01 * m), np.stack((x.ravel(), y.ravel() - room.HANGS, np.zeros(100)), axis=1))


def one_point(m, r):
    """Return the tensor of all masses at their centre."""
    d = np.mean(r, axis=0)
    return np.sum(m) * (d @ d * np.eye(3) - np.outer(d, d))


def two_boards(f, m, size):
    """Return the tensor of the picture, by 4.12, of an upper and a lower half."""
    half = np.array([size[0], 0.5 * size[1], 0.0])
    square = half * half
    I = np.diag(0.5 * m * (np.sum(square) - square) / 12.0)
    places = np.array([(0.0, 0.25 * size[1], 0.0), (0.0, -0.25 * size[1], 0.0)])
    return f(np.full(2, 0.5 * m), places, np.stack((I, I))).I


def only_added(m, x, I):
    """Return a body whose moment is the sum of those of its parts about their own centres."""
    return MassProperties(np.sum(m), m @ x / np.sum(m), np.sum(I, axis=0))


def kept(I, m, d):
    """Return the tensor as it is."""
    return I


def roller(number, *sizes):
    """Return the actor of a round body that rolls down the lid and on along the floor, by a moment of lesson 4."""
    def act(use):
        R, (high, low) = 0.06, room.LID
        along = (low - high) / np.linalg.norm(low - high)
        start, n = high + 0.35 * along, np.array([-along[1], along[0]])
        end = np.linalg.norm(low - start) - R * np.tan(0.5 * room.SLOPE)            # of its way on the lid
        a = G * np.sin(room.SLOPE) / (1.0 + use[number](1.0, R, *sizes)[2, 2] / R**2)
        seen, t_end = [], np.sqrt(2.0 * end / a)
        for t in FRAME * np.arange(PICTURES):
            s = 0.5 * a * t * t if t < t_end else end + a * t_end * (t - t_end)
            centre = start + min(s, end) * along + R * n + max(s - end, 0.0) * np.array([1.0, 0.0])
            seen.append(centre + R * circle(ROUND) @ turned(-s / R).T)
        return {"roller": np.array(seen)}
    return act


# ---------------------------------------------------------------------------------------------- rotation

def by_matrix(update, q, omega, dt):
    """Return the orientation after dt by the matrix of 5.6 or 5.7."""
    return quaternion(update(actors.matrix_of(q), omega, dt))


def by_product(product, q, omega, dt):
    """Return the orientation after dt: q + ½ dt (0, ω) q, by the product of 5.8."""
    new = q + 0.5 * dt * product(np.append(0.0, omega), q)
    return new / np.linalg.norm(new)


def turned_on(q, omega, dt):
    """Given.  Return the orientation after dt at ω."""
    return quaternion(actors.turn_by(dt * omega) @ actors.matrix_of(q))


HALF = np.array([0.13, 0.03, 0.08])              # of the brick [m]
BRICK = RigidBody(1.0, np.array([HALF[1]**2 + HALF[2]**2, HALF[0]**2 + HALF[2]**2, HALF[0]**2 + HALF[1]**2]) / 3.0)


def brick(use):
    """A brick in the place of the die, tossed with a spin about its middle axis (5.12)."""
    start, up, dt = np.append(actors.TOSSED, 0.0), np.array([0.0, 4.8, 0.0]), FRAME / 4
    q, omega = np.array([1.0, 0.0, 0.0, 0.0]), np.array([0.3, 0.0, 9.0])
    box = np.array([(*corner, z) for z in (-1.0, 1.0) for corner in actors.corners(1.0)]) * HALF
    x, v, seen = start, up, []
    for k in range(4 * PICTURES):
        if k % 4 == 0:
            seen.append(flat(x + np.array([rotate(q, corner) for corner in box])))
        x, q, v, omega = use["5.12"](brick_load, k * dt, x, q, v, omega, dt, BRICK)
        if x[1] < start[1]:
            x, v = start, up
    return {"die": np.array(seen)}


def brick_load(t, x, q, v, omega, body):
    """Given.  Return the load on the brick: its weight."""
    return body.m * np.array([0.0, -G, 0.0]), np.zeros(3)


def still_body(load, t, x, q, v, omega, dt, body):
    """Return the state as it is."""
    return x, q, v, omega


def tumbled(acceleration, load, t, x, q, v, omega, dt, body):
    """Advance the brick, by the angular acceleration of 5.11."""
    omega = omega + dt * acceleration(q, omega, np.zeros(3), body.I_body)
    v = v + dt * np.array([0.0, -G, 0.0])
    return x + dt * v, turned_on(q, omega, dt), v, omega


def freely(turn, load, t, x, q, v, omega, dt, body):
    """Advance the brick, by a free rotation from its angular momentum (5.16, 5.17)."""
    L = rotate(q, body.I_body * unrotate(q, omega))
    v = v + dt * np.array([0.0, -G, 0.0])
    q = turn(q, L, body.I_body, dt)
    return x + dt * v, q, v, rotate(q, unrotate(q, L) / body.I_body)


def among_bodies(step, load, t, x, q, v, omega, dt, body):
    """Advance the brick by 10.4, as the only one of all bodies."""
    p = Bodies(np.array([1.0 / body.m]), (1.0 / body.I_body)[None], HALF[None], np.zeros((0, 4)),
               np.array([0.0, -G, 0.0]), 0.0, 1, 0.0)
    def on_all(t, x, q, v, omega, p):
        return tuple(part[None] for part in load(t, x[0], q[0], v[0], omega[0], body))
    return [part[0] for part in step(on_all, t, x[None], q[None], v[None], omega[None], dt, p)]


# ---------------------------------------------------------------------------------------------- detection

SILL = ROOM.bodies[room.SILL]
BOARD = np.array(SILL.x) + actors.corners(np.array(SILL.shape.half))


def landed(number, contact, start):
    """Return the actor of a ball that falls on something: contact(exercise, place) → (gap, normal)."""
    def act(use):
        x, v, seen = np.array(start), np.array([0.15, 0.0]), []
        for k in range(8 * PICTURES):
            if k % 8 == 0:
                seen.append(x + R_BALL * circle(ROUND))
            v = v + FINE * DOWN
            x = x + FINE * v
            for gap, n in (contact(use[number], x), (x[1] - R_BALL, UP)):
                if gap < 0.0:
                    v = v - (1.0 + BALL.e) * min(v @ n, 0.0) * n
                    x = x - gap * n
        return {"ball": np.array(seen)}
    return act


def from_point(x, nearest):
    """Return (gap, normal) of the ball from the nearest point of something."""
    way = x - nearest
    size = np.linalg.norm(way)
    return size - R_BALL, way / size


def at_lid(closest, x):
    """Return (gap, normal) of the ball at the lid of the chest, a segment (6.5)."""
    return from_point(x, closest(x, *room.LID))


def at_corner_of_lid(closest, x):
    """Return (gap, normal) of the ball at half of the lid, a triangle (6.7)."""
    (a_x, a_y), (b_x, b_y) = room.LID
    a, b, c = np.array([(a_x, a_y, -0.3), (b_x, b_y, 0.0), (a_x, a_y, 0.3)])
    gap, n = from_point(np.append(x, 0.0), closest(np.append(x, 0.0), a, b, c))
    return gap, n[:2]


def at_sill(ball_box, x):
    """Return (gap, normal) of the ball at the sill, a box in space (6.8)."""
    found = ball_box(np.append(x, 0.0), R_BALL, Box(np.append(SILL.x, 0.0), np.eye(3), np.append(SILL.shape.half, 0.1)))
    return found.gap, found.n[:2]


def at_edge(separating, x):
    """Return (gap, normal) of the ball at the best separating edge of the sill (6.12)."""
    gap, edge = separating(BOARD, x[None])
    return gap - R_BALL, outward(BOARD, edge)


def at_hull(gjk, x):
    """Return (gap, normal) of the ball at the hull of the sill's corners (6.15)."""
    found = gjk(x[None], BOARD)
    return found.gap - R_BALL, found.n


def far(a, *_):
    """Return a contact that is far away."""
    x = a if np.ndim(a) == 1 else a[0]
    return Contact(x, x, np.eye(x.size)[1], 9.0, np.inf)


def measured_floor(distance, t, dt, x_0, x_1, r, wall):
    """Return the time at which the ball touches the floor, from its distances by 6.1."""
    high, low = distance(x_0, wall) - r, distance(x_1, wall) - r
    return t if high <= 0.0 else t + dt * high / (high - low) if low <= 0.0 else np.inf


# ---------------------------------------------------------------------------------------------- impulses on the ball

def cone(u, n, K, u_sep, mu):
    """Given.  Return the impulse on a ball: it sticks if it can, else it slides.  K has the same entries along both."""
    k_n, k_t = n @ K @ n, np.trace(K) - n @ K @ n
    j = (u_sep - u @ n) / k_n
    slip = u - (u @ n) * n
    return j * n - min(2.0 / k_t, mu * j / max(np.linalg.norm(slip), 1e-300)) * slip


def with_response(matrix, u, n, K, u_sep, mu):
    """Return the impulse on the ball, from its response by 7.9."""
    lever = BALL.inertia
    return cone(u, n, matrix(-R_BALL * n, 1.0 / BALL.m, np.eye(3) / lever), u_sep, mu)


def only_mass(r, inv_mass, inv_inertia):
    """Return the response of a point that cannot turn."""
    return inv_mass * np.eye(3)


def kinematic(response, u, n, K, u_sep, mu):
    """Return the impulse that changes the velocity of the ball as 7.1 does."""
    return BALL.m * (response(u, n, -u_sep / (u @ n)) - u)


def dead_stop(v, n, e):
    """Return the velocity without its part into the surface."""
    return v - min(v @ n, 0.0) * n


def own_law(f, u, n, K, u_sep, mu):
    """Return the impulse by a law of one's own (7.20)."""
    return f(u, n, K)


def smooth(u, n, K):
    """Return the impulse without friction after which a ball leaves with the speed with which it came."""
    return -2.0 * (u @ n) / (n @ K @ n) * n


def velocity_only(body, r, J):
    """Return the body after an impulse that does not turn it."""
    return body._replace(v=body.v + body.inv_mass * J)


# ---------------------------------------------------------------------------------------------- the stack

def exact(solve, A, b, lam, omega):
    """Return the impulses of 9.8, for any impulses before."""
    return solve(A, b)


def newton(step, A, b, lam, omega):
    """Return the impulses after one step of 9.19."""
    return step(A, b, lam)


def with_tangents(sweep, A, b, lam, omega):
    """Return the impulses after sweep(A, b, J) over normal and tangential impulses; nothing slips here."""
    whole = np.eye(2 * len(b))
    whole[::2, ::2] = A
    pad = lambda row: np.stack((row, 0.0 * row), axis=1).ravel()
    return sweep(whole, pad(b), pad(lam))[::2]


def in_cones(f, A, b, lam, omega):
    """Return the impulses after a sweep of 9.10."""
    return with_tangents(lambda A, b, J: f(A, b, J, np.full(len(lam), room.RUBS)), A, b, lam, omega)


def proximal(f, A, b, lam, omega):
    """Return the impulses after a sweep of 9.17."""
    return with_tangents(lambda A, b, J: f(A, b, J, np.full(len(lam), room.RUBS), 1.0 / np.diag(A)), A, b, lam, omega)


def coupled(matrix, A, b, lam, omega):
    """Return the impulses after a sweep with the matrix of 9.2."""
    rows = np.eye(len(b)) - np.eye(len(b), k=-1)
    return actors.one_by_one(matrix(rows, np.ones(len(b))), b, lam, omega)


def forgotten(now, old, J, near):
    """Return no impulse to begin with."""
    return 0.0 * J


def alone(G, w):
    """Return the matrix of contacts that do not know each other."""
    return np.diag(np.sum(w * G * G, axis=1))


def faster(f, A, b, lam, omega):
    """Return the impulses of 9.22 after as many sweeps as a step has."""
    return f(lambda J: actors.one_by_one(A, b, J, 1.0), lam, actors.SWEEPS)


def plain_sweeps(sweep, J, calls):
    """Return the impulses after so many sweeps."""
    for _ in range(calls):
        J = sweep(J)
    return J


# ---------------------------------------------------------------------------------------------- the loop

def rolled(use):
    """The ball that is pushed along the floor without spin, slips and rolls (10.11)."""
    ball = RollingBall(BALL.m, np.full(3, BALL.inertia), R_BALL, 0.1, np.array([0.0, 0.0, -G]))
    x, q, v, omega = np.array([-1.6, 0.0, R_BALL]), np.array([1.0, 0, 0, 0]), np.array([1.6, 0.0, 0.0]), np.zeros(3)
    rim, seen = np.insert(R_BALL * circle(ROUND), 1, 0.0, axis=1), []
    for k in range(PICTURES):
        seen.append((x + np.array([rotate(q, place) for place in rim]))[:, [0, 2]])
        x, q, v, omega = use["10.11"](floor_load, k * FRAME, x, q, v, omega, FRAME, ball)
    return {"ball": np.array(seen)}


def floor_load(t, x, q, v, omega, ball):
    """Given.  Return the load on a ball on the floor beside friction: weight and support cancel."""
    return np.zeros(3), np.zeros(3)


def slides_on(load, t, x, q, v, omega, dt, ball):
    """Advance a ball without friction."""
    return x + dt * v, q, v, omega


# ---------------------------------------------------------------------------------------------- the arm

def placed(positions, task, theta, target, arm):
    """Return the angles after a damped step, with the hand where 11.1 finds it."""
    places = room.BASE + positions(theta, room.LINKS)
    ways = places[-1] - places[:-1]
    return actors.unlimited(lambda *_: (target - places[-1], np.stack((-ways[:, 1], ways[:, 0]))), theta, target, arm)


def with_jacobian(jacobian, task, theta, target, arm):
    """Return the angles after a damped step with the Jacobian of 11.2."""
    places = room.joints(theta)
    return actors.unlimited(lambda *_: (target - places[-1], jacobian(places)), theta, target, arm)


def in_one_step(solve, task, theta, target, arm):
    """Return the angles with which 11.5 reaches the target; the last link keeps its direction."""
    return solve(np.append(target - room.BASE, np.sum(room.REST)), room.LINKS, 1.0)


def inverted(inverse, task, theta, target, arm):
    """Return the angles after a step with the pseudo-inverse of 11.10."""
    e, J = task(theta, target, arm)
    return theta + inverse(J) @ e


def around_base(step, task, theta, target, arm):
    """Return the angles after a sweep of 11.13, which has the base at (0, 0)."""
    return step(task, theta, target - room.BASE, arm._replace(low=np.full(3, -np.inf)))


def by_places(sweep, task, theta, target, arm):
    """Return the angles of the links after a sweep of 11.14 has moved the joints."""
    x = sweep(room.joints(theta) - room.BASE, target - room.BASE, room.LINKS)
    ways = np.diff(x, axis=0)
    heading = np.unwrap(np.arctan2(ways[:, 1], ways[:, 0]))
    new = np.diff(np.append(0.0, heading))
    return theta + (new - theta + np.pi) % (2.0 * np.pi) - np.pi


def with_rest(step, task, theta, target, arm):
    """Return the angles after a step of 11.16, which also approaches the angles of the start."""
    return step(task, theta, target, arm._replace(rest=room.REST, pull=0.1))


# ---------------------------------------------------------------------------------------------- an aimed throw

TARGET, FLIGHT, THROWS = np.array([2.45, 0.85]), 0.9, 30      # on the stack [m]; its time [s] and steps
DRAG = 0.15                                      # of the air, over the mass [1/m]
CORRECTIONS = 2                                  # of the first throw, by Newton's method
FIRST = np.array([2.0, 6.0])                     # velocity of the first throw [m/s]


def air(v):
    """Return the acceleration in the air; v may be complex."""
    return DOWN - DRAG * np.sqrt(np.sum(v * v)) * v


def places_of(velocity):
    """Return the places of a throw, one per step; the velocity may be complex."""
    x, v, dt, seen = np.array(BALL.x) + 0.0 * velocity, velocity, FLIGHT / THROWS, []
    for _ in range(THROWS):
        seen.append(x)
        v = v + dt * air(v)
        x = x + dt * v
    return np.array([*seen, x])


def end_with(s, p):
    """Return the end of a throw with s in the place of component k of the velocity; p = (velocity, k)."""
    velocity, k = p
    return places_of(np.where(np.arange(2) == k, s, velocity))[-1]


def by_difference(difference, velocity):
    """Return the sensitivity (2, 2) of the end to the velocity, by 12.1."""
    return np.stack([difference(end_with, velocity[k], 1e-4, (velocity, k)) for k in range(2)], axis=1)


def by_complex(difference, velocity):
    """Return the sensitivity of the end, by 12.3."""
    return np.stack([difference(end_with, velocity[k], 1e-20, (velocity, k)) for k in range(2)], axis=1)


def by_tangents(step, velocity):
    """Return the sensitivity of the end, by 12.4."""
    x, v, dx, dv, dt = np.array(BALL.x), velocity, np.zeros((2, 2)), np.eye(2), FLIGHT / THROWS
    for k in range(THROWS):
        x, v, dx, dv = step(lambda t, x, v, p: air(v), air_derivatives, k * dt, x, v, dx, dv, dt, None)
    return dx


def air_derivatives(t, x, v, p):
    """Given.  Return the derivatives of the acceleration with respect to x, v and the inputs."""
    speed = np.linalg.norm(v)
    return np.zeros((2, 2)), -DRAG * (speed * np.eye(2) + np.outer(v, v) / speed), np.zeros((2, 2))


def aimed(number, sensitivity=None):
    """Return the actor of a ball that is thrown at the stack: by 12.10, or by given steps with a sensitivity."""
    def act(use):
        if sensitivity:
            s = FIRST
            for _ in range(CORRECTIONS):
                J = sensitivity(use[number], s)
                left = TARGET - places_of(s)[-1]
                s = s + (np.linalg.lstsq(J, left, rcond=None)[0] if np.all(np.isfinite(J)) else np.nan)
        else:
            s = use[number](miss, FIRST, 1e-6, 20, None)[0]
        shown = np.minimum(np.arange(PICTURES) * FRAME, FLIGHT)
        times = FLIGHT / THROWS * np.arange(THROWS + 1)
        centres = np.stack([np.interp(shown, times, along) for along in places_of(s).T], axis=1)
        return {"ball": centres[:, None] + R_BALL * circle(ROUND)}
    return act


def miss(s, p):
    """Given.  Return (what is left to the target, its sensitivity) of a throw."""
    end, h = places_of(s)[-1], 1e-7
    return end - TARGET, np.stack([places_of(s + h * way)[-1] - end for way in np.eye(2)], axis=1) / h


def as_it_was(law, derivatives, t, x, v, dx, dv, dt, p):
    """Return the state and its sensitivity as they are."""
    return x, v, dx, dv


def first_throw(miss, s, tolerance, most, p):
    """Return the first throw."""
    return s, np.zeros(1)
