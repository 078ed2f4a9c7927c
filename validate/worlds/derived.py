"""What a world derives from a Model: touching pairs, overlaps at the start, bounds of speed, other dimensions.

The geometry is independent of the lessons.  It tries every direction in which two shapes could be separated.
"""

from itertools import combinations, product
from math import sqrt

import numpy as np

from solutions.checks import BadInput, positive_number
from solutions.support.model import (
    WORLD,
    BallJoint,
    Distance,
    Drag,
    Force,
    Hinge,
    Spring,
    State,
    Weld,
    can_move,
    can_turn,
    check_model,
    loads_at,
    pair_test,
    rotation_of,
    start_of,
    world_place,
)
from solutions.support.shapes import Ball, Box, Capsule, HalfSpace, Polyhedron, core_of, hull_triangles, size_of

TOUCH = 1e-9                 # gap at which two bodies count as touching at the start, over their size [-]
STICKY = 1e6                 # stands for infinite friction in an engine [-]: its product with 0 is 0
SLIGHT = 1e-9                # difference of velocities over the larger one, up to which they are the same [-]
SPINS_ON = "a body that nothing can turn has an angular velocity, which this engine would drop"
OPENS = "bodies begin with velocities that open a joint, and its coordinates cannot hold such velocities"
SINGLE = 1e-37, 1e18         # smallest and largest mass [kg] and moment [kg m²] that single precision carries
PLANE = 1e-12                # allowed distance from a vertical plane, over the largest coordinate [-]


# ---------------------------------------------------------------------------------------------- contacts

def touches(model):
    """Return whether any two bodies could ever touch."""
    return any_touch(model, range(len(model.bodies)))


def bounces(model):
    """Return whether any pair has restitution, which is a product."""
    return any_touch(model, [k for k, body in enumerate(model.bodies) if body.e > 0.0])


def rubs(model):
    """Return whether any pair has friction, which is a product."""
    return any_touch(model, [k for k, body in enumerate(model.bodies) if body.mu > 0.0])


def any_touch(model, chosen):
    """Return whether any two of the chosen bodies could ever touch."""
    could_touch = pair_test(model)
    return any(could_touch(i, j) for i, j in combinations(chosen, 2))


def carries(model):
    """Return whether a body moves that no impulse moves, such as a belt."""
    return any(not can_move(body) and (np.any(body.v) or np.any(body.omega)) for body in model.bodies)


def spins_on(model):
    """Return whether a body that nothing can turn has an angular velocity, which it keeps."""
    return any(can_move(body) and not can_turn(body) and np.any(body.omega) for body in model.bodies)


def opens(model):
    """Return whether the first velocities of bodies open a joint: only an impulse at the start could hold it."""
    start = start_of(model)
    for joint in model.joints:
        if isinstance(joint, Distance):
            continue
        ends = [k for k in (joint.a, joint.b) if k != WORLD]
        turned = [by_turning(start.omega[k], np.asarray(joint.place, float) - start.x[k]) for k in ends]
        u, spin = [start.v[k] + turn for k, turn in zip(ends, turned)], [start.omega[k] for k in ends]
        fastest = max(np.linalg.norm(start.v[k]) + np.linalg.norm(turn) for k, turn in zip(ends, turned))
        others = (u[1], spin[1]) if len(ends) == 2 else (0.0, 0.0)
        if (np.linalg.norm(held_spin(joint, spin[0] - others[1])) > SLIGHT * np.max(np.abs(spin))
                or np.linalg.norm(u[0] - others[0]) > SLIGHT * fastest):
            return True
    return False


def held_spin(joint, omega):
    """Return the part of a relative angular velocity [rad/s] that a joint forbids.

    A weld forbids all of it, a hinge in space all but that about its axis, and any other joint nothing.
    """
    if isinstance(joint, Weld):
        return omega
    return omega - np.dot(omega, joint.axis) * np.array(joint.axis) if isinstance(joint, Hinge) and joint.axis else 0.0


def weld_place(model, joint):
    """Return the place (d,) [m] at which an engine holds two welded bodies:  (x_a/I_a + x_b/I_b)/(1/I_a + 1/I_b).

    An impulse there turns both alike, so that its rows for places and those for angles do not disturb each other.
    """
    shares = [0.0 if k == WORLD or not can_move(model.bodies[k]) else 1.0 / float(np.mean(model.bodies[k].inertia))
              for k in (joint.a, joint.b)]
    if sum(shares) == 0.0:
        return np.array(joint.place, float)
    places = [np.array(joint.place if k == WORLD else model.bodies[k].x, float) for k in (joint.a, joint.b)]
    return (shares[0] * places[0] + shares[1] * places[1]) / sum(shares)


def by_turning(omega, r):
    """Return the velocity (d,) [m/s] that a point at r from the centre of a body has by its rotation."""
    return omega * np.array((-r[1], r[0])) if len(r) == 2 else np.cross(omega, r)


def grip(body):
    """Return the friction of a body as a finite number [-]."""
    return min(float(body.mu), STICKY)


def core(body):
    """Return (corners (k, d) in the world, radius, edges (m, d)): the body lies within the radius of their hull."""
    if len(body.x) == 2 or isinstance(body.shape, Ball):
        corners, radius = core_of(body.shape)
        corners = np.zeros((1, len(body.x))) if isinstance(body.shape, Ball) else corners
        edges = np.roll(corners, -1, axis=0) - corners
    elif isinstance(body.shape, Capsule):
        corners, radius = np.outer((1.0, -1.0), (body.shape.half_length, 0.0, 0.0)), body.shape.radius
        edges = np.eye(3)[:1]
    elif isinstance(body.shape, Polyhedron):
        corners, radius = np.array(body.shape.corners), 0.0
        triangles = corners[hull_triangles(corners)]
        edges = np.concatenate([np.roll(triangles, -1, axis=1) - triangles]).reshape(-1, 3)
    else:
        corners, radius, edges = np.array(list(product(*((-h, h) for h in body.shape.half)))), 0.0, np.eye(3)
    R = rotation_of(body.q)
    return corners @ R.T + body.x, radius, edges @ R.T


def directions(first, second, edges):
    """Return unit vectors, among them the one in which two convex cores are farthest apart.

    It runs between two corners, or from a corner across an edge, or across two edges.
    """
    between = (first[:, None] - second).reshape(-1, first.shape[1])
    edges = edges / np.maximum(np.linalg.norm(edges, axis=1, keepdims=True), np.finfo(float).tiny)
    across = (between[:, None] - (between @ edges.T)[:, :, None] * edges).reshape(between.shape[0] * len(edges), -1)
    found = np.concatenate((between, across))
    if first.shape[1] == 3 and len(edges) > 1:
        found = np.concatenate((found, np.cross(edges[:, None], edges).reshape(-1, 3)))
    lengths = np.linalg.norm(found, axis=1)
    found = found[lengths > TOUCH * np.max(lengths)] / lengths[lengths > TOUCH * np.max(lengths), None]
    return np.concatenate((found, -found))


def gap(a, b):
    """Return (distance [m], n from b to a) of two bodies with shapes; below zero where they overlap."""
    if isinstance(a.shape, HalfSpace):
        distance, n = gap(b, a)
        return distance, -n
    corners, radius, edges = core(a)
    if isinstance(b.shape, HalfSpace):
        n = np.array(b.shape.normal)
        return float(np.min(corners @ n)) + b.shape.offset - radius, n
    other, more, its = core(b)
    ways = directions(corners, other, np.concatenate((edges, its)))
    apart = np.min(corners @ ways.T, axis=0) - np.max(other @ ways.T, axis=0)
    best = int(np.argmax(apart))
    return float(apart[best]) - radius - more, ways[best]


def contacts_at_start(model):
    """Return [(a, b, n from b to a), …]: the pairs that touch at the start and do not overlap."""
    could_touch, found = pair_test(model), []
    shaped = [k for k, body in enumerate(model.bodies) if body.shape is not None]
    x = np.reshape([model.bodies[k].x for k in shaped], (-1, model.d))
    size = np.array([size_of(model.bodies[k].shape) for k in shaped])
    for at, i in enumerate(shaped):
        others = size[at + 1:]
        near = np.linalg.norm(x[at + 1:] - x[at], axis=1) <= (1.0 + TOUCH) * (size[at] + others)
        for j, other in zip(np.array(shaped[at + 1:], int)[near].tolist(), others[near].tolist()):
            if not could_touch(i, j):
                continue
            distance, n = gap(model.bodies[i], model.bodies[j])
            if abs(distance) <= TOUCH * max(one for one in (size[at], other) if np.isfinite(one)):
                found.append((i, j, n))
    return found


def pressed_in(model, depth):
    """Return x (n, d) at the start, each body `depth` inside the one that carries it: engines then see a contact.

    It begins at the fixed bodies, so a tower sinks by depth, 2 depth, 3 depth …
    """
    x, touching = start_of(model).x, contacts_at_start(model)
    shift = {k: np.zeros(model.d) for k, body in enumerate(model.bodies) if not can_move(body)}
    while True:
        new = {one: shift[other] - depth * way for a, b, n in touching for one, other, way in ((a, b, n), (b, a, -n))
               if one not in shift and other in shift}
        if not new:
            break
        shift |= new
    return np.array([x[k] + shift.get(k, 0.0) for k in range(len(x))])


# ---------------------------------------------------------------------------------------------- motion

def fastest(model):
    """Return the largest speed at the start [m/s]."""
    start = start_of(model)
    return max([np.linalg.norm(start.v[k]) for k, body in enumerate(model.bodies) if can_move(body)], default=0.0)


def moved_start(model, seconds, accelerations=None):
    """Return the State at the start with the velocities of so many seconds later or, where negative, before.

    Half a step makes leapfrog of symplectic Euler.
    accelerations: (a (n, d), α) with what contacts and joints do; without it those of the loads
    """
    start = start_of(model)
    if not seconds:
        return start
    a, alpha = accelerations or acceleration_at_start(model)
    return start._replace(v=start.v + seconds * np.asarray(a), omega=start.omega + seconds * np.asarray(alpha))


def acceleration_at_start(model):
    """Return (a (n, d), α) at the start, without contacts and joints."""
    start = start_of(model)
    F, tau = loads_at(model, 0.0, start)
    a, alpha = np.zeros_like(F), np.zeros_like(tau)
    for k, body in enumerate(model.bodies):
        if can_move(body):
            a[k] = np.asarray(model.gravity) + F[k] / body.m
            alpha[k] = tau[k] / body.inertia if model.d == 2 else 0.0
    return a, alpha


def forces_of(model, springs):
    """Return {number of a body: (F, of, b)}, as in a Force, if that is all that loads do; None otherwise.

    springs: the engine has none; then each may only hold the centre of a body to a place in the plane.
    """
    free = [k for k, body in enumerate(model.bodies) if can_move(body)]
    held = model.springs if springs else ()
    if (any(not isinstance(load, Drag | Force) for load in model.loads)
            or any(one.b != WORLD or model.d == 3 or any(one.place_a) for one in held)):
        return None
    found = [(load.a, load.F, load.of, load.b) for load in model.loads if isinstance(load, Force)]
    found += [(k, dragging(load.k, model.d), "v", None) for load in model.loads if isinstance(load, Drag) for k in free]
    found += [(one.a, pull_of(one), "xv", None) for one in held]
    return {a: how for a, *how in found} if len({a for a, *_ in found}) == len(found) else None


def net_of(model):
    """Return (x, v) → F, both (n, …) in any coordinates, of a Model whose springs join centres of bodies; else None.

    Its loads may be drag only.  F = −k_v v − Bᵀ T n,  n = Bx/|Bx|,  T = k (|Bx| − rest) + c n · Bv.
    """
    springs = model.springs
    if (any(not isinstance(load, Drag) for load in model.loads) or not springs
            or any(one.b == WORLD or any(one.place_a) or any(one.place_b) for one in springs)):
        return None
    B, drag = np.zeros((len(springs), len(model.bodies))), sum(load.k for load in model.loads)
    for row, one in zip(B, springs):
        row[one.a], row[one.b] = 1.0, -1.0
    rest, k, c = (np.array([getattr(one, name) for one in springs])[:, None] for name in ("rest", "k", "c"))

    def pull(x, v):
        r = B @ x
        length = np.sqrt(np.sum(r * r, axis=1, keepdims=True))
        n = r / np.maximum(length, np.finfo(float).tiny)     # 0 where its ends meet
        tension = k * (length - rest) + c * np.sum(n * (B @ v), axis=1, keepdims=True)
        return -drag * v - B.T @ (tension * n)
    return pull


def dragging(k, d):
    """Return v → −k v [N], of floats."""
    k = -k
    return (lambda v: (k * v[0], k * v[1])) if d == 2 else (lambda v: (k * v[0], k * v[1], k * v[2]))


def pull_of(spring):
    """Return (x, v) → (2,) [N] of a Spring in the plane between the centre of a body and a place, of floats."""
    (right, high), rest, k, c = spring[3:]

    def pull(x, v):
        along, up = x[0] - right, x[1] - high
        near = 1.0 / (sqrt(along * along + up * up) or 1.0)  # any number where its ends meet: along and up are 0
        share = k * (rest * near - 1.0) - c * near * near * (along * v[0] + up * v[1])
        return share * along, share * up
    return pull


def checked_step(model, dt, refuses):
    """Return the step [s] of a world.

    Raises BadInput unless it is positive, for anything but a Model, and for one that the world refuses.
    """
    check_model(model)
    why = refuses(model)
    if why:
        raise BadInput("a model for this engine", f"one that it refuses: {why}", "ask refuses(model) before build")
    return positive_number("step dt [s]", dt)


def cuts_moments(model, most):
    """Return why an engine refuses a model with a finite moment of inertia above `most`, which is its ∞ [kg m²]; or "".
    """
    moments = [I for body in model.bodies for I in np.atleast_1d(body.inertia) if most < I < np.inf]
    return f"a moment of inertia of {moments[0]:.3g} kg m² counts as infinite in it" if moments else ""


def beyond_single(model):
    """Return why an engine of single precision refuses a mass or a moment of inertia that is too small or too large.

    Measured in free fall: at 1e-40 a body stands still or its place is no number.  At 1e20, whose square is too large,
    Rapier's bodies do not fall.  At 3e-39 and 1e19 they do.  "" where there is none.
    """
    low, high = SINGLE
    found = [x for body in model.bodies for x in (body.m, *np.atleast_1d(body.inertia)) if x < low or high < x < np.inf]
    return f"its single precision is too narrow for a mass or a moment of inertia of {found[0]:.3g}" if found else ""


def thinnest(model):
    """Return half of the smallest width of all polyhedra along their axes [m]; ∞ without one."""
    return min((float(np.min(np.ptp(body.shape.corners, axis=0))) / 2.0 for body in model.bodies
                if isinstance(body.shape, Polyhedron)), default=np.inf)


def stiff_joints(model):
    """Return the numbers of the joints that with_plain_springs keeps, as the Model numbers them."""
    return [n for n, joint in enumerate(model.joints) if not isinstance(joint, Distance) or joint.compliance == 0.0]


def as_numbered(pushes, model):
    """Return the function `pushes` of a world that was built with_plain_springs, with the Model's numbers of joints."""
    numbers = stiff_joints(model)
    return lambda: [push if push.joint is None else push._replace(joint=numbers[push.joint]) for push in pushes()]


def with_plain_springs(model):
    """Return the model with a spring, of stiffness 1/α, for each Distance that has a compliance."""
    start, springs = start_of(model), []
    stiff = stiff_joints(model)
    for joint in (joint for n, joint in enumerate(model.joints) if n not in stiff):
        length = np.linalg.norm(world_place(start, joint.a, joint.place_a) - world_place(start, joint.b, joint.place_b))
        springs.append(Spring(*joint[:4], float(length), 1.0 / joint.compliance))
    return model._replace(springs=model.springs + tuple(springs),
                          joints=tuple(model.joints[n] for n in stiff))


def only_holds(model, k):
    """Return whether body k is nothing but a place where springs end: fixed, without a shape, joints, or a Force to it.
    """
    body, linked = model.bodies[k], [*model.joints, *(load for load in model.loads if isinstance(load, Force))]
    return not can_move(body) and body.shape is None and not any(k in (one.a, one.b) for one in linked)


def tree(model, kinds=(Hinge, BallJoint, Weld)):
    """Return ({body: (body above or WORLD, number of a joint or None)}, numbers of the joints that close loops).

    Every body hangs on the first joint that leads to a fixed body.  The first body of a group that nothing holds is
    free.  Joints that are not of these kinds carry nothing.
    """
    left = [n for n, joint in enumerate(model.joints) if isinstance(joint, kinds)]
    above = {k: (WORLD, None) for k, body in enumerate(model.bodies) if not can_move(body)}
    loops = []
    known = {WORLD, *above}
    while left:
        n = next((n for n in left if known & {model.joints[n].a, model.joints[n].b}), None)
        if n is None:
            above[model.joints[left[0]].a] = (WORLD, None)
            known.add(model.joints[left[0]].a)
            continue
        left.remove(n)
        a, b = model.joints[n].a, model.joints[n].b
        if a in known and b in known:
            loops.append(n)
            continue
        child, parent = (a, b) if b in known else (b, a)
        above[child] = (parent, n)
        known.add(child)
    return {k: above.get(k, (WORLD, None)) for k in range(len(model.bodies))}, loops


# ---------------------------------------------------------------------------------------------- other dimensions

def in_plane(model):
    """Return (Model in the plane, lift) of a model in space whose motion stays in a vertical plane; None otherwise.

    lift(State in the plane) → State in space.
    """
    if model.d == 2 or model.joints or model.springs or not all(isinstance(load, Drag) for load in model.loads):
        return None
    start, up = start_of(model), -np.asarray(model.gravity)
    if any(body.shape is not None for body in model.bodies) or np.any(start.omega):
        return None
    up = up / np.linalg.norm(up) if np.any(up) else np.array([0.0, 0.0, 1.0])
    flat = start.v - np.outer(start.v @ up, up)
    along = flat[np.argmax(np.linalg.norm(flat, axis=1))]
    if not np.any(along):
        along = np.cross(up, np.eye(3)[np.argmin(np.abs(up))])
    frame = np.stack((along / np.linalg.norm(along), up))
    beside = [array - array @ frame.T @ frame for array in (start.v, start.x - start.x[0])]
    scale = max(1.0, np.max(np.abs(start.v)), np.max(np.abs(start.x)))
    if max(np.max(np.abs(rows)) for rows in beside) > PLANE * scale:
        return None
    bodies = tuple(body._replace(x=tuple(frame @ body.x), v=tuple(frame @ body.v), q=0.0, omega=0.0,
                                 inertia=float(np.max(body.inertia))) for body in model.bodies)
    base = start.x[0] - start.x[0] @ frame.T @ frame
    lift = lambda state: State(state.x @ frame + base, start.q, state.v @ frame, start.omega)
    return model._replace(bodies=bodies, gravity=tuple(frame @ model.gravity)), lift


class Embedding:
    """Between the dimensions of a model and those of an engine in space: (x, y) is there (x, 0, y), ω is (0, −ω, 0)."""

    def __init__(self, d):
        self.flat = d == 2

    def point(self, p):
        """Return a vector (3,) of the engine."""
        return np.array((p[0], 0.0, p[1]) if self.flat else p, float)

    def turning(self, omega):
        """Return an angular velocity or a torque (3,) of the engine."""
        return np.array((0.0, -omega, 0.0) if self.flat else omega, float)

    def frame(self, q):
        """Return R (3, 3) of the engine for an orientation of the model."""
        if not self.flat:
            return rotation_of(q)
        c, s = np.cos(q), np.sin(q)
        return np.array([(c, 0.0, -s), (0.0, 1.0, 0.0), (s, 0.0, c)])

    def half(self, half):
        """Return the half sizes (3,) of a box; one of the plane is as deep as it is large."""
        return np.array((half[0], max(half), half[1]) if self.flat else half, float)

    def deep(self, corners):
        """Return the corners (2k, 3) of the prism of a polygon, as deep as it is large."""
        depth = np.max(np.abs(corners))
        return np.array([(x, y, z) for x, z in corners for y in (-depth, depth)])

    def back(self, x, q, v, omega):
        """Return the State of the model: from the engine's vectors and quaternions (w, x, y, z)."""
        x, q, v, omega = (np.array(rows, float) for rows in (x, q, v, omega))
        if not self.flat:
            return State(x, q, v, omega)
        return State(x[:, ::2], -2.0 * np.arctan2(q[:, 2], q[:, 0]), v[:, ::2], -omega[:, 1])

    def push(self, F):
        """Return a force (d,) of the model."""
        return F[::2].copy() if self.flat else np.array(F, float)


def beyond(model, reach):
    """Return why an engine refuses a model whose half-spaces it ends at `reach` [m], "" where all begin above them.

    Such a half-space is a box or a segment around the point of its plane that is nearest to the origin.
    """
    solid = [body for body in model.bodies if body.shape is not None and not isinstance(body.shape, HalfSpace)]
    for plane in (body.shape for body in model.bodies if isinstance(body.shape, HalfSpace)):
        n = np.array(plane.normal)
        if any(np.linalg.norm(body.x - n * (n @ body.x)) + size_of(body.shape) > reach for body in solid):
            return f"its half-spaces end {reach:g} m from the origin, and a body begins beyond that"
    return ""


def round_only(model):
    """Return whether every shape that can move is a ball, so that a fixed plane needs no edges."""
    return all(isinstance(body.shape, Ball | HalfSpace | None) for body in model.bodies)


def smallest(model):
    """Return the size of the smallest body that can move [m]; ∞ without one."""
    sizes = [float(np.linalg.norm(body.shape.half)) if isinstance(body.shape, Box) else size_of(body.shape)
             for body in model.bodies if body.shape is not None and can_move(body)]
    return min(sizes, default=np.inf)
