"""Piles of lesson 9 compared with engines, as ratios measured in one run: `validate piles [KIND …]`.

Kinds: discs, boxes (in the plane, against pymunk), spheres, bricks (in space, against pybullet).  Both run the same
bodies from the same settled state, in turn, with steps of 1/240 s, μ = 0.5 and no sleeping.  Times are CPU times of
one thread.  Overlaps of both are found by lesson 6's geometry, that is by the contacts of lesson 9.

The cost of a step should grow as n to the power of 1, within a tenth, from 100 to 10,000 bodies; all sizes are timed in
turn.  The memory is that of the whole process, compiler included, with 10,000 spheres: at most 4 GiB.
"""

import sys
import time

import numpy as np
from rich.console import Console
from rich.table import Table

from ..engines.contact import DT, KINDS, BulletPile, PymunkPile, fallen
from ..scene import check_known
from ..subject import modules

BLOCK = 40                   # steps of one timing
SETTLE = 4.0                 # for which a pile falls and comes to rest [s]
SIZES = (100, 316, 1000, 3162, 10_000)  # bodies of the piles whose cost is compared
LANDING = 2.0                # for which those piles fall: long enough that all bodies have contacts [s]
GROWTH = (0.9, 1.1)          # goal: the power of n with which the cost of a step grows [-]
ROOM = 4.0                   # goal: memory of 10,000 spheres, at most [GiB]
REACH = 1e-3                 # gaps up to this are looked at when overlaps are measured [m]
RIVALS = {                   # {kind: {label: (engine, iterations, goal: greatest ratio of times)}}
    "discs": {"pymunk, 10 iterations": (PymunkPile, 10, 0.5)},
    "boxes": {"pymunk, 10 iterations": (PymunkPile, 10, 0.5)},
    "spheres": {"pybullet, 10 iterations": (BulletPile, 10, 0.25), "pybullet, 50 iterations": (BulletPile, 50, 0.1)},
    "bricks": {"pybullet, 10 iterations": (BulletPile, 10, 0.5), "pybullet, 50 iterations": (BulletPile, 50, 0.3)},
}


def functions(lesson, kind):
    """Return (advance, bounds, contacts) of a kind of pile."""
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


def overlaps(lesson, kind, pile, x, q):
    """Return (largest, mean) overlap [mm] of all contacts that overlap."""
    _, bounds, contacts = functions(lesson, kind)
    low, high, turn = bounds(x, q, pile.half)
    gap = contacts(x, turn, pile.half, pile.planes, lesson.near_pairs(low - REACH, high + REACH, pile.planes),
                   REACH).gap
    deep = -1e3 * gap[gap < 0.0]
    return (deep.max(), deep.mean()) if len(deep) else (0.0, 0.0)


def cpu_time(work):
    """Return milliseconds per step of one block."""
    began = time.thread_time()
    work.run(BLOCK)
    return 1e3 * (time.thread_time() - began) / BLOCK


def compare(lesson, name, n, rounds):
    """Return rows (label, ratio, low, high, goal, ms, ms, overlaps) of one kind of pile, one for each engine."""
    kind = KINDS[name]
    state, pile = fallen(kind, n)
    ours = Ours(lesson, kind, state, pile)
    ours.run(round(SETTLE / DT))
    for label, (engine, iterations, goal) in RIVALS[name].items():
        try:
            other = engine(kind, ours.state, pile, iterations)
        except ImportError:
            print(f"{name}: {label} is not installed here, so it is skipped", file=sys.stderr)
            continue
        other.run(240)
        times = np.array([(cpu_time(ours), cpu_time(other)) for _ in range(rounds)])
        ratios = np.sort(times[:, 0] / times[:, 1])
        yield (label, np.median(ratios), ratios[rounds // 4], ratios[-1 - rounds // 4], goal, *np.median(times, axis=0),
               *overlaps(lesson, kind, pile, *ours.places()), *overlaps(lesson, kind, pile, *other.places()))


def landed(lesson, name, n):
    """Return the lesson's pile of n bodies after a while, as wide as it is high."""
    kind = KINDS[name]
    kind = kind._replace(across=max(2, round(n ** (1.0 / kind.d))))
    ours = Ours(lesson, kind, *fallen(kind, n))
    ours.run(round(LANDING / DT))
    return ours


def growth(lesson, name, sizes, rounds):
    """Return (power of n, [(n, ms per step, contacts per body)]): the slope of all medians, over logarithms."""
    piles = [landed(lesson, name, n) for n in sizes]
    times = np.median([[cpu_time(pile) for pile in piles] for _ in range(rounds)], axis=0)
    power = np.polyfit(np.log(sizes), np.log(times), 1)[0]
    return power, [(n, t, len(pile.state.contacts.a) / n) for n, t, pile in zip(sizes, times, piles)]


def grow(lesson, names, rounds):
    """Print how the cost of a step grows."""
    table = Table("pile", "power of n", "goal", *(f"{n:,}: ms per step (contacts per body)" for n in SIZES))
    for name in names:
        power, rows = growth(lesson, name, SIZES, rounds)
        costs = [f"{ms:.3g} ({contacts:.1f})" for _, ms, contacts in rows]
        table.add_row(name, f"{power:.2f}", f"{GROWTH[0]:g} to {GROWTH[1]:g}", *costs)
    Console(width=160).print(table)


def peak_memory():
    """Return the most memory [GiB] that this process has ever had."""
    import resource  # Windows has none
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (2**30 if sys.platform == "darwin" else 2**20)


def remember(lesson, n=10_000):
    """Print the memory of a pile of spheres."""
    before = peak_memory()
    pile = landed(lesson, "spheres", n)
    print(f"{n:,} spheres, {len(pile.state.contacts.a):,} contacts: {peak_memory():.2f} GiB at most, "
          f"{before:.2f} GiB before; goal: {ROOM:g} GiB")


def race(lesson, names, bodies, rounds):
    """Print the time of a step and the overlap, ours and each engine's."""
    table = Table("pile", "engine", "time, ours / engine", "middle half", "goal", "ours [ms]", "engine [ms]",
                  "overlap, ours [mm]", "engine [mm]")
    for name in names:
        for row in compare(lesson, name, bodies, rounds):
            label, ratio, low, high, goal, ours, other, most, mean, most_other, mean_other = row
            table.add_row(f"{bodies} {name}", label, f"{ratio:.3f}", f"{low:.3f}–{high:.3f}", f"{goal:g}",
                          f"{ours:.3f}", f"{other:.3f}",
                          f"{most:.2f}, mean {mean:.3f}", f"{most_other:.2f}, mean {mean_other:.3f}")
    Console(width=160).print(table)


def measure(kinds, bodies, rounds, growth, memory):
    """Print the memory, the growth, or else the races of some kinds of piles; of all without names.

    Raises BadInput for an unknown kind.
    """
    check_known("pile", kinds, KINDS)
    lesson = modules.bind("contact", compiled=True)
    if memory:
        remember(lesson)
    if growth:
        grow(lesson, kinds or KINDS, rounds)
    if not (memory or growth):
        race(lesson, kinds or KINDS, bodies, rounds)
