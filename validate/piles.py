"""Piles of lesson 9 against engines, as ratios measured in one run: `python -m validate.piles [KIND …] [--bodies N]
[--rounds N]`.

Kinds: discs, boxes (in the plane, against pymunk), spheres, bricks (in space, against pybullet).  Both run the same
bodies from the same settled state, in turn, with steps of 1/240 s, μ = 0.5 and no sleeping.  Times are CPU times of
one thread.  Overlaps of both are found by lesson 6's geometry, that is by the contacts of lesson 9.
"""

import argparse
import sys
import time
from typing import NamedTuple

import numpy as np
from rich.console import Console
from rich.table import Table

from solutions.support.scenes import make_pile, make_pile_2d

from . import modules

G, DT, MU = 9.81, 1.0 / 240.0, 0.5
BLOCK = 40                   # steps of one timing
SETTLE = 4.0                 # for which a pile falls and comes to rest [s]
REACH = 1e-3                 # gaps up to this are looked at when overlaps are measured [m]


class Kind(NamedTuple):
    """A kind of pile, the settings of its solver and what it is compared with."""
    d: int
    shape: str               # round or box
    across: int              # bodies side by side
    pitch: float             # of the lattice from which they fall [m]
    substeps: int
    hertz: float
    engines: dict            # {label: (engine, iterations, goal: greatest ratio of times)}


KINDS = {
    "discs": Kind(2, "round", 30, 0.25, 3, 180.0, {"pymunk, 10 iterations": ("pymunk", 10, 0.5)}),
    "boxes": Kind(2, "box", 30, 0.35, 3, 180.0, {"pymunk, 10 iterations": ("pymunk", 10, 0.5)}),
    "spheres": Kind(3, "round", 10, 0.25, 2, 150.0,
                    {"pybullet, 10 iterations": ("pybullet", 10, 0.25),
                     "pybullet, 50 iterations": ("pybullet", 50, 0.1)}),
    "bricks": Kind(3, "box", 10, 0.42, 4, 120.0,
                   {"pybullet, 10 iterations": ("pybullet", 10, 0.5),
                    "pybullet, 50 iterations": ("pybullet", 50, 0.3)}),
}


def fallen(kind, n):
    """(PileState, Pile) of n bodies on a lattice between walls;
    sizes vary by a tenth where round, by a fifth where not.
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


def functions(lesson, kind):
    """(advance, bounds, contacts) of a kind of pile."""
    return {(2, "round"): (lesson.advance_pile_2d, lesson.disc_bounds, lesson.round_contacts),
            (2, "box"): (lesson.advance_pile_2d, lesson.box_bounds_2d, lesson.box_contacts_2d),
            (3, "round"): (lesson.advance_pile, lesson.ball_bounds, lesson.round_contacts),
            (3, "box"): (lesson.advance_pile, lesson.box_bounds, lesson.box_contacts)}[kind.d, kind.shape]


class Ours:
    """The lesson's pile."""

    def __init__(self, lesson, kind, state, pile):
        (self.advance, *self.shape), self.state, self.pile = functions(lesson, kind), state, pile

    def run(self, steps):
        self.state = self.advance(*self.shape, self.state, DT, steps, self.pile)

    def places(self):
        return self.state.x, self.state.q


class Pymunk:
    """The same bodies in pymunk.  Friction coefficients multiply there."""

    def __init__(self, kind, state, pile, iterations):
        import pymunk
        self.space, self.bodies = pymunk.Space(), []
        self.space.gravity, self.space.iterations, self.space.collision_slop = (0.0, -G), iterations, 1e-3
        wall = pile.planes[1, 2]
        for p, q in (((-wall - 1.0, -1.0), (wall + 1.0, -1.0)), ((-wall - 1.0, -1.0), (-wall - 1.0, 60.0)),
                     ((wall + 1.0, -1.0), (wall + 1.0, 60.0))):
            self.space.add(pymunk.Segment(self.space.static_body, p, q, 1.0))
        for k, (half_x, half_y) in enumerate(pile.half):
            body = pymunk.Body(1.0 / pile.inv_mass[k], 1.0 / pile.inv_inertia[k])
            body.position, body.angle = tuple(state.x[k]), state.q[k]
            corners = [(half_x, half_y), (-half_x, half_y), (-half_x, -half_y), (half_x, -half_y)]
            self.space.add(body, pymunk.Circle(body, half_x) if kind.shape == "round" else pymunk.Poly(body, corners))
            self.bodies.append(body)
        for shape in self.space.shapes:
            shape.friction = np.sqrt(MU)
        self.planes = len(pile.planes)

    def run(self, steps):
        for _ in range(steps):
            self.space.step(DT)

    def places(self):
        still = np.zeros((self.planes, 2))
        places = [tuple(body.position) for body in self.bodies]
        angles = [body.angle for body in self.bodies]
        return np.vstack((places, still)), np.append(angles, still[:, 0])


class Bullet:
    """The same bodies in pybullet, with maximal coordinates."""

    def __init__(self, kind, state, pile, iterations):
        import pybullet
        self.p, self.c = pybullet, pybullet.connect(pybullet.DIRECT)
        self.p.setGravity(0.0, 0.0, -G, physicsClientId=self.c)
        self.p.setPhysicsEngineParameter(fixedTimeStep=DT, numSolverIterations=iterations, solverResidualThreshold=0.0,
                                         contactBreakingThreshold=0.02, physicsClientId=self.c)
        wall, thick = pile.planes[1, 3], 1.0
        for axis, sign in ((2, -1.0), (0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0)):
            at, half = np.zeros(3), np.full(3, 60.0)
            at[axis], half[axis] = sign * (thick if axis == 2 else wall + thick), thick
            self.add(pybullet.GEOM_BOX, {"halfExtents": list(half)}, 0.0, at, (0.0, 0.0, 0.0, 1.0))
        self.bodies = []
        for k, half in enumerate(pile.half):
            w, *xyz = state.q[k]
            ball, brick = (pybullet.GEOM_SPHERE, {"radius": half[0]}), (pybullet.GEOM_BOX, {"halfExtents": list(half)})
            shape = ball if kind.shape == "round" else brick
            self.bodies.append(self.add(*shape, 1.0 / pile.inv_mass[k], state.x[k], (*xyz, w)))
        self.planes = len(pile.planes)

    def add(self, geometry, sizes, mass, x, q):
        shape = self.p.createCollisionShape(geometry, physicsClientId=self.c, **sizes)
        body = self.p.createMultiBody(mass, shape, -1, list(x), list(q), useMaximalCoordinates=1,
                                      physicsClientId=self.c)
        self.p.changeDynamics(body, -1, lateralFriction=np.sqrt(MU), restitution=0.0, linearDamping=0.0,
                              angularDamping=0.0, physicsClientId=self.c)
        return body

    def run(self, steps):
        for _ in range(steps):
            self.p.stepSimulation(physicsClientId=self.c)

    def places(self):
        both = [self.p.getBasePositionAndOrientation(body, physicsClientId=self.c) for body in self.bodies]
        x, q = (np.array([one[k] for one in both]) for k in (0, 1))
        upright = np.tile([1.0, 0.0, 0.0, 0.0], (self.planes, 1))
        return np.vstack((x, np.zeros((self.planes, 3)))), np.vstack((q[:, [3, 0, 1, 2]], upright))


def overlaps(lesson, kind, pile, x, q):
    """(largest, mean) overlap [mm] of all contacts that overlap."""
    _, bounds, contacts = functions(lesson, kind)
    low, high, turn = bounds(x, q, pile.half)
    gap = contacts(x, turn, pile.half, pile.planes, lesson.near_pairs(low - REACH, high + REACH, pile.planes),
                   REACH).gap
    deep = -1e3 * gap[gap < 0.0]
    return (deep.max(), deep.mean()) if len(deep) else (0.0, 0.0)


def cpu_time(work):
    """Milliseconds per step of one block."""
    began = time.thread_time()
    work.run(BLOCK)
    return 1e3 * (time.thread_time() - began) / BLOCK


def compare(lesson, name, n, rounds):
    """Rows (label, ratio, low, high, goal, ms, ms, overlaps) of one kind of pile, one for each engine."""
    kind = KINDS[name]
    state, pile = fallen(kind, n)
    ours = Ours(lesson, kind, state, pile)
    ours.run(round(SETTLE / DT))
    for label, (engine, iterations, goal) in kind.engines.items():
        try:
            other = (Pymunk if engine == "pymunk" else Bullet)(kind, ours.state, pile, iterations)
        except ImportError:
            print(f"{name}: {engine} is not installed here, so it is skipped", file=sys.stderr)
            continue
        other.run(240)
        times = np.array([(cpu_time(ours), cpu_time(other)) for _ in range(rounds)])
        ratios = np.sort(times[:, 0] / times[:, 1])
        yield (label, np.median(ratios), ratios[rounds // 4], ratios[-1 - rounds // 4], goal, *np.median(times, axis=0),
               *overlaps(lesson, kind, pile, *ours.places()), *overlaps(lesson, kind, pile, *other.places()))


def main(arguments):
    parser = argparse.ArgumentParser(prog="python -m validate.piles", description=__doc__.splitlines()[0])
    parser.add_argument("kinds", nargs="*", choices=[[], *KINDS], default=[])
    parser.add_argument("--bodies", type=int, default=1000)
    parser.add_argument("--rounds", type=int, default=15)
    asked = parser.parse_args(arguments)
    lesson = modules.bind("contact", compiled=True)
    table = Table("pile", "engine", "time, ours / engine", "middle half", "goal", "ours [ms]", "engine [ms]",
                  "overlap, ours [mm]", "engine [mm]")
    for name in asked.kinds or KINDS:
        for row in compare(lesson, name, asked.bodies, asked.rounds):
            label, ratio, low, high, goal, ours, other, most, mean, most_other, mean_other = row
            table.add_row(f"{asked.bodies} {name}", label, f"{ratio:.3f}", f"{low:.3f}–{high:.3f}", f"{goal:g}",
                          f"{ours:.3f}", f"{other:.3f}",
                          f"{most:.2f}, mean {mean:.3f}", f"{most_other:.2f}, mean {mean_other:.3f}")
    Console(width=160).print(table)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
