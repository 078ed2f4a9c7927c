"""Piles of bodies between walls for the lesson and for engines: the same bodies, places, friction and steps."""

from typing import NamedTuple

import numpy as np

from solutions.support.model import Body, make_model
from solutions.support.scenes import make_pile, make_pile_2d
from solutions.support.shapes import Ball, Box, HalfSpace

from . import watched
from .products import PYBULLET, PYMUNK
from .switches import worlds_made

G, DT, MU = 9.81, 1.0 / 240.0, 0.5


class Kind(NamedTuple):
    """A kind of pile and the settings of its solver."""
    d: int
    shape: str               # round or box
    across: int              # bodies side by side
    pitch: float             # of the lattice from which they fall [m]
    substeps: int
    hertz: float


KINDS = {
    "discs": Kind(2, "round", 30, 0.25, 3, 210.0),
    "boxes": Kind(2, "box", 30, 0.35, 3, 210.0),                         # with 240 Hz towers of six boxes sway on
    "spheres": Kind(3, "round", 10, 0.25, 2, 144.0),
    "bricks": Kind(3, "box", 10, 0.42, 4, 120.0),
}


def fallen(kind, n):
    """Return (PileState, Pile) of n bodies on a lattice between walls.

    Sizes vary by a tenth for round bodies, and by a fifth for boxes.
    """
    d, rng, k = kind.d, np.random.default_rng(1), np.arange(n)
    if kind.shape == "round":
        half = np.repeat(rng.uniform(0.09, 0.11, (n, 1)), d, axis=1)
    else:
        half = rng.uniform(0.08, 0.12, (n, d))
    places = [k // kind.across**c % kind.across for c in range(d - 1)] + [k // kind.across ** (d - 1)]
    x, wall = (np.stack(places, axis=1) + 0.5) * kind.pitch, 0.5 * kind.across * kind.pitch + 0.02
    x[:, :-1] -= 0.5 * kind.across * kind.pitch
    x += rng.uniform(-0.01, 0.01, x.shape)
    floor = np.append(np.eye(d)[-1], 0.0)
    planes = np.stack([floor, *(np.append(sign * np.eye(d)[c], wall) for c in range(d - 1) for sign in (1.0, -1.0))])
    volume = {(2, "round"): np.pi, (2, "box"): 4.0, (3, "round"): 4.0 / 3.0 * np.pi, (3, "box"): 8.0}[d, kind.shape]
    m, squares = 1000.0 * volume * np.prod(half, axis=1), half**2
    solver = (MU, kind.substeps, kind.hertz, 10.0, 0.008)
    if d == 2:
        inertia = m * (0.5 * squares[:, 0] if kind.shape == "round" else np.sum(squares, axis=1) / 3.0)
        angles = rng.uniform(-np.pi, np.pi, n) if kind.shape == "box" else np.zeros(n)
        return make_pile_2d(x, angles, m, inertia, half, planes, (0.0, -G), *solver)
    inertia = m[:, None] * (0.4 * squares if kind.shape == "round"
                            else (np.sum(squares, axis=1)[:, None] - squares) / 3.0)
    q = rng.normal(size=(n, 4)) if kind.shape == "box" else np.tile([1.0, 0.0, 0.0, 0.0], (n, 1))
    return make_pile(x, q / np.linalg.norm(q, axis=1)[:, None], m, inertia, half, planes, (0.0, 0.0, -G), *solver)


def model_of(kind, state, pile):
    """Return the Model of a pile: its bodies, at rest where the PileState has them, and then its planes.

    Frictions multiply, so each body has the root of that of a pair.
    """
    rough, d = np.sqrt(MU), kind.d
    shapes = [Ball(half[0]) if kind.shape == "round" else Box(tuple(half)) for half in pile.half.tolist()]
    bodies = [Body(tuple(x), 1.0 / inverse, shape, rough, q=q)
              for x, q, inverse, shape in zip(state.x.tolist(), state.q.tolist(), pile.inv_mass, shapes)]
    walls = [Body((0.0,) * d, shape=HalfSpace(tuple(n), offset), mu=rough) for *n, offset in pile.planes.tolist()]
    return make_model([*bodies, *walls], pile.gravity)


class Judged(NamedTuple):
    """The arguments of natural_residual for a pile after a step."""
    bodies: tuple            # (x, v, ω, inverse masses, inverse moments) of bodies and planes
    contacts: tuple          # (a, b, n, p, gap)
    J: np.ndarray            # (m, d) [N s]


def inverse_tensors(q, inv_body):
    """Return I⁻¹ (n + p, 3, 3) in the world, from quaternions (n + p, 4), w first.

    inv_body: inverse moments (n + p, 3).
    """
    w, xyz = q[:, 0], q[:, 1:]
    cross = np.zeros((len(q), 3, 3))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        cross[:, i, j], cross[:, j, i] = -xyz[:, k], xyz[:, k]
    R = np.eye(3) + 2.0 * (w[:, None, None] * cross + cross @ cross)
    return (R * inv_body[:, None, :]) @ R.transpose(0, 2, 1)


class EnginePile:
    """A pile in an engine, whose world is built from the Model of the pile.

    watch: the engine's own world → what reports its contacts, of `watched.py`;    settings: of the world's build
    """

    def __init__(self, product, watch, kind, state, pile, **settings):
        with worlds_made() as own:
            self.world = product.world.build(model_of(kind, state, pile), DT, **settings)
        self.watching, self.pile = watch(*own), pile

    def run(self, steps):
        for _ in range(steps):
            self.world.step()

    def places(self):
        """Return (x (n + p, d), orientations (n + p, …)) of bodies and planes."""
        return self.world.state()[:2]

    def velocities(self):
        """Return (v (n + p, d), angular velocities (n + p, …)) of bodies and planes."""
        return self.world.state()[2:]

    def touching(self):
        """Return the Touching record of all contact points that push or overlap; planes have the number n."""
        rows = self.watching.contacts()
        return watched.touching([row for row in rows if row[5] <= 0.0 or np.dot(row[2], row[6]) > 0.0],
                                self.pile.half.shape[1])

    def judged(self):
        """Return the Judged record."""
        c, (x, q), inv_inertia = self.touching(), self.places(), self.pile.inv_inertia
        if len(x[0]) == 3:
            inv_inertia = inverse_tensors(q, inv_inertia)
        bodies = (x, *self.velocities(), self.pile.inv_mass, inv_inertia)
        return Judged(bodies, (c.a, c.b, c.n, 0.5 * (c.p_a + c.p_b), c.gap), c.J)

    def wall_force(self):
        """Return the sum (d,) [N] of the forces of floor and walls on the bodies."""
        c, n = self.touching(), len(self.pile.half)
        return (np.sum(c.J[c.b == n], axis=0) - np.sum(c.J[c.a == n], axis=0)) / DT

    def close(self):
        self.world.close()


def pymunk_pile(kind, state, pile, iterations, slop=1e-3):
    """Return the EnginePile of pymunk."""
    return EnginePile(PYMUNK, lambda space: watched.Pymunk(space, DT), kind, state, pile,
                      iterations=iterations, slop=slop)


def bullet_pile(kind, state, pile, iterations, residual=0.0):
    """Return the EnginePile of pybullet, with maximal coordinates and its own slop."""
    return EnginePile(PYBULLET, lambda bullet: watched.Bullet(bullet.pb, DT, bullet.gravity), kind, state, pile,
                      iterations=iterations, residual=residual, slop=watched.SLOP, slabs=True)
