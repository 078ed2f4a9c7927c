"""Piles of lesson 9 compared with engines, as ratios measured in one run: `validate piles [KIND …]`.

Kinds: discs, boxes (in the plane), spheres, bricks (in space).  Ours and an engine run the same bodies from the same
settled state, in turn, with steps of 1/240 s, μ = 0.5 and no sleeping, in a process of their own.  Times are CPU times
of all its threads.  Box2D and Rapier run with their defaults, and tuned so that their bodies overlap less.
Against each engine ours takes the fewest substeps with which its bodies overlap no more than the engine's.
Overlaps are judged by `reference/overlaps.py`, which uses no code of the lessons.

With `--threads` ours shares its work in space among threads (`threads.py`), and Box2D and Rapier get as many.  The
other engines are left out then.  Times are those of a clock on the wall.

The cost of a step should grow as n to a power of at most 1.05 from 100 to 10,000 bodies; all sizes are timed in turn.
All piles have about the same number of rows, 29 to 34 in the plane and 9 to 12 in space.  All are timed two seconds
after their fall began, when some bodies still move.  Larger piles do not fit into the processor's cache, and a contact
costs more there, for the tuned engine as well.  The memory shown for ours is that of the whole process, compiler
included: with 10,000 spheres at most 4 GiB.  For the engine it is what the process holds more once the engine has its
bodies and has run for a block.
"""

import os
import sys
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import NamedTuple

import numpy as np
from rich.console import Console
from rich.table import Table
from scipy.spatial.transform import Rotation

from solutions.checks import BadInput

from ..engines.contact import DT, KINDS, bullet_pile, fallen, pymunk_pile
from ..engines.products import BOX2D, MUJOCO, PYBULLET, PYMUNK, RAPIER, Product
from ..reference.overlaps import overlaps
from ..scene import check_known
from ..subject import modules
from .opponents import Box2DPile, MuJoCoPile, RapierPile

BLOCK = 40                   # steps of one timing
SETTLE = 4.0                 # for which a pile falls and comes to rest [s]
SIZES = (100, 316, 1000, 3162, 10_000, 31_623, 100_000)  # bodies of the piles whose cost is compared
ROWS = {2: 30, 3: 10}        # {dimension: rows of a pile}; higher piles land so hard that bodies pass each other [-]
LANDING = 2.0                # for which those piles fall: long enough that all bodies have contacts [s]
GROWTH = 1.05                # goal: the power of n with which the cost of a step grows, at most [-]
ROOM = 4.0                   # goal: memory of 10,000 spheres, at most [GiB]


FEW, FEWER = (2, 140.0), (1, 70.0)       # (substeps, hertz): each as stiff as towers of squares allow
LOOSE, FIRM = {"discs": FEWER, "boxes": FEWER}, {"discs": FEW, "boxes": FEW}
SOFT_SPACE = {"spheres": FEWER, "bricks": FEWER}


class Rival(NamedTuple):
    """An engine with its settings."""
    product: Product
    settings: str            # for people
    make: Callable           # (kind, state, pile) → what has run(steps) and places()
    goal: dict               # {kind: greatest ratio of times, ours over its}
    ours: dict               # {kind: (substeps, hertz) of ours, where fewer than usual overlap no more than the engine}


PLANE = (
    Rival(PYMUNK, "10 iterations", partial(pymunk_pile, iterations=10), {"discs": 0.5, "boxes": 0.5}, {}),
    Rival(BOX2D, "defaults: 4 substeps, 30 Hz, slop 5 mm", Box2DPile, {}, LOOSE),
    Rival(BOX2D, "2 substeps", partial(Box2DPile, substeps=2), {}, LOOSE),
    Rival(BOX2D, "tuned: 4 substeps, 240 Hz, slop 0.5 mm", partial(Box2DPile, hertz=240.0, unit=0.1),
          {"discs": 0.6, "boxes": 0.6}, FIRM),
)
SPACE = (
    Rival(PYBULLET, "10 iterations", partial(bullet_pile, iterations=10), {"spheres": 0.25, "bricks": 0.5}, {}),
    Rival(PYBULLET, "50 iterations", partial(bullet_pile, iterations=50), {"spheres": 0.1, "bricks": 0.3}, {}),
    Rival(RAPIER, "defaults: 4 iterations, 30 Hz (60 Hz at walls), slop 5 mm", RapierPile, {}, SOFT_SPACE),
    Rival(RAPIER, "2 iterations", partial(RapierPile, iterations=2), {}, SOFT_SPACE),
    Rival(RAPIER, "tuned: 4 iterations, 120 Hz, slop 0.1 mm", partial(RapierPile, hertz=120.0, slop=1e-4),
          {"spheres": 0.2, "bricks": 0.5}, {"bricks": (2, 120.0)}),
    Rival(MUJOCO, "20 iterations of CG, contacts as stiff as two steps allow", MuJoCoPile, {}, {}),
)
RIVALS = {2: PLANE, 3: SPACE}            # {dimension: engines}
THREADED = {BOX2D, RAPIER}               # engines whose threads can be counted
SETTLE_RIVAL = 480           # steps in which an engine settles from our state [-]


def functions(lesson, kind):
    """Return (advance, bounds, contacts) of a kind of pile."""
    return {(2, "round"): (lesson.advance_pile_2d, lesson.disc_bounds, lesson.round_contacts),
            (2, "box"): (lesson.advance_pile_2d, lesson.box_bounds_2d, lesson.box_contacts_2d),
            (3, "round"): (lesson.advance_pile, lesson.ball_bounds, lesson.round_contacts),
            (3, "box"): (lesson.advance_pile, lesson.box_bounds, lesson.box_contacts)}[kind.d, kind.shape]


def compiled_lesson():
    """Return lesson 9, compiled, as scenes call it: they find its machine code sooner than numba's own search does."""
    return modules.module_set(compiled=True).lesson_of_scenes("contact")


class Ours:
    """The lesson's pile."""

    def __init__(self, lesson, kind, state, pile, threads=1):
        (self.advance, *self.shape), self.state, self.pile = functions(lesson, kind), state, pile
        if threads > 1 and kind.d == 3:
            from .threads import on_threads  # imports numba
            self.advance = on_threads(lesson, threads)

    def run(self, steps):
        self.state = self.advance(*self.shape, self.state, DT, steps, self.pile)

    def places(self):
        return self.state.x, self.state.q


def found_overlaps(kind, pile, x, q):
    """Return (largest, mean) overlap [mm] of all pairs that overlap."""
    n = len(pile.half)
    depths = 1e3 * overlaps(x[:n], directions(q[:n]), pile.half, kind.shape == "round", pile.planes)
    return (depths.max(), depths.mean()) if len(depths) else (0.0, 0.0)


def directions(q):
    """Return matrices (n, d, d) from angles (n,) [rad] or quaternions (n, 4), w first."""
    if q.ndim == 1:
        return np.stack((np.cos(q), -np.sin(q), np.sin(q), np.cos(q)), axis=1).reshape(-1, 2, 2)
    return Rotation.from_quat(q[:, [1, 2, 3, 0]]).as_matrix()


def cpu_time(work, steps=BLOCK, clock=time.process_time):
    """Return milliseconds per step of one block, of all threads of this process or by another clock."""
    began = clock()
    work.run(steps)
    return 1e3 * (clock() - began) / steps


def warm_time(work):
    """Return the same after one step that does not count: it may follow a pile of another size, and pay for that."""
    work.run(1)
    return cpu_time(work)


class Race(NamedTuple):
    """Ours and an engine in turn."""
    ratios: np.ndarray       # (rounds,) times, ours over the engine's, sorted [-]
    ours: float              # median time of a step [ms]
    engine: float
    overlap: tuple           # (largest, mean) of ours [mm]
    overlap_engine: tuple


def with_settings(pile, rival, name):
    """Return the pile with our settings against an engine."""
    substeps, hertz = rival.ours.get(name, (pile.substeps, pile.hertz))
    return pile._replace(substeps=substeps, hertz=hertz)


def race(name, n, rival, rounds, threads=1):
    """Return the Race of one kind of pile against one engine, each on so many threads."""
    kind = KINDS[name]
    kind = kind._replace(across=max(kind.across, across_in_rows(kind, n)))
    state, pile = fallen(kind, n)
    ours = Ours(compiled_lesson(), kind, state, pile, threads)
    ours.run(round(SETTLE / DT))
    other = rival.make(kind, ours.state, pile, **({"threads": threads} if threads > 1 else {}))
    ours.pile = with_settings(pile, rival, name)
    ours.run(SETTLE_RIVAL)
    other.run(SETTLE_RIVAL)
    clock = time.perf_counter if threads > 1 else time.process_time
    times = np.array([(cpu_time(ours, clock=clock), cpu_time(other, clock=clock)) for _ in range(rounds)])
    return Race(np.sort(times[:, 0] / times[:, 1]), *np.median(times, axis=0).tolist(),
                found_overlaps(kind, pile, *ours.places()), found_overlaps(kind, pile, *other.places()))


def alone(function, *arguments):
    """Return what a function returns in a new process: some settings of Box2D hold for a whole process."""
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as process:
        return process.submit(function, *arguments).result()


def across_in_rows(kind, n):
    """Return how many bodies a pile has across if n bodies lie in ROWS rows."""
    return round((n / ROWS[kind.d]) ** (1.0 / (kind.d - 1)))


def landed(lesson, name, n):
    """Return the lesson's pile of n bodies after LANDING seconds.

    All have about ROWS rows, so they settle in the same time.
    """
    kind = KINDS[name]
    kind = kind._replace(across=max(2, across_in_rows(kind, n)))
    ours = Ours(lesson, kind, *fallen(kind, n))
    ours.run(round(LANDING / DT))
    return ours


class Size(NamedTuple):
    """The cost of a pile of some size."""
    bodies: int
    contacts: int
    ms: float                # median time of a step, ours
    engine: float            # the same of the tuned engine; NaN where it is not installed
    memory: float            # the most memory that the process has had until this pile had landed [GiB]
    memory_engine: float     # that the tuned engine holds; NaN where it is not known


def growth(name, sizes, rounds):
    """Return [Size]: all sizes are timed in turn, ours and the last engine that has a goal, where it is installed."""
    lesson, rows = compiled_lesson(), []
    rival = next((one for one in reversed(RIVALS[KINDS[name].d]) if one.goal and one.product.installed()), None)
    for n in sorted(sizes):
        ours = landed(lesson, name, n)
        memory, other, before = peak_memory(), None, held_memory()
        if rival:
            other = rival.make(KINDS[name], ours.state, ours.pile)
            other.run(BLOCK)
        rows.append((n, ours, other, memory, held_memory() - before if rival else np.nan))
    times = np.array([[(warm_time(ours), warm_time(other) if other else np.nan) for _, ours, other, *_ in rows]
                      for _ in range(rounds)])
    return [Size(n, len(ours.state.contacts.a), *middle, *memory)
            for (n, ours, _, *memory), middle in zip(rows, np.median(times, axis=0).tolist())]


def power(bodies, ms):
    """Return the power of n with which the cost of a step grows: the slope of all medians, over logarithms."""
    return np.polyfit(np.log(bodies), np.log(ms), 1)[0]


def grow(names, most, rounds, figure=None):
    """Print how the cost of a step grows; each kind in a process of its own, whose memory it shows."""
    table = Table("pile", "power of n", "goal", "tuned engine", "bodies", "contacts", "ms per step", "tuned engine",
                  "ns per contact and step", "tuned engine", "memory [GiB]", "tuned engine")
    sizes, found = [n for n in SIZES if n <= most], {}
    for name in names:
        found[name] = rows = alone(growth, name, sizes, rounds)
        n, ms, engine = ([getattr(row, field) for row in rows] for field in ("bodies", "ms", "engine"))
        first = [name, f"{power(n, ms):.2f}", f"≤ {GROWTH:g}", known(power(n, engine), ".2f")]
        for row in rows:
            each = 1e6 / max(row.contacts, 1)
            table.add_row(*first, f"{row.bodies:,}", f"{row.contacts:,}", f"{row.ms:.3g}", known(row.engine, ".3g"),
                          f"{each * row.ms:.0f}", known(each * row.engine, ".0f"), f"{row.memory:.2f}",
                          known(row.memory_engine, ".2f"))
            first = [""] * 4
    Console(width=180).print(table)
    if figure:
        draw_growth(found, figure)


def known(number, form):
    """Return a number in a form, or a dash for NaN."""
    return f"{number:{form}}" if number == number else "–"


def draw_growth(found, path):
    """Draw the time per contact and step against the number of bodies: a level line is a cost that grows as n."""
    import matplotlib.pyplot as plt
    chart, axis = plt.subplots(figsize=(8.4, 4.0), layout="constrained")
    for k, (name, rows) in enumerate(found.items()):
        n, ms, engine, contacts = (np.array(column) for column in zip(*((r.bodies, r.ms, r.engine, r.contacts)
                                                                          for r in rows)))
        axis.plot(n, 1e6 * ms / contacts, "os^D"[k % 4] + "-", color=f"C{k}",
                  label=f"{name}: step ~ n to the power of {power(n, ms):.2f}")
        axis.plot(n, 1e6 * engine / contacts, "os^D"[k % 4] + ":", color=f"C{k}", fillstyle="none",
                  label=f"{name}, tuned engine: {known(power(n, engine), '.2f')}")
    axis.set(xscale="log", yscale="log", xlabel="bodies", ylabel="CPU time per contact and step [ns]")
    plain_ticks(axis.yaxis)
    chart.legend(loc="outside right upper", fontsize=9)
    chart.savefig(path)
    plt.close(chart)


def plain_ticks(*axes):
    """Write 0.5, 1, 2, 5, 10 … on logarithmic axes."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
    for axis in axes:
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())


def peak_memory():
    """Return the most memory [GiB] that this process has ever had."""
    import resource  # Windows has none
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (2**30 if sys.platform == "darwin" else 2**20)


def held_memory():
    """Return the memory [GiB] that this process holds now; NaN where the system does not say so in Linux's way."""
    pages = Path("/proc/self/statm")
    return int(pages.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**30 if pages.is_file() else np.nan


def remember(lesson, n=10_000):
    """Print the memory of a pile of spheres."""
    before = peak_memory()
    pile = landed(lesson, "spheres", n)
    print(f"{n:,} spheres, {len(pile.state.contacts.a):,} contacts: {peak_memory():.2f} GiB at most, "
          f"{before:.2f} GiB before; goal: {ROOM:g} GiB")


def compare(names, bodies, rounds, threads=1):
    """Return {kind: [(rival, its Race)]} of all engines that are installed; name those that are not, or that end."""
    found = {}
    for name in names:
        rivals = [rival for rival in RIVALS[KINDS[name].d] if threads == 1 or rival.product in THREADED]
        for product in dict.fromkeys(rival.product for rival in rivals if not rival.product.installed()):
            print(f"{name}: {product} is not installed here, so it is skipped: {product.remedy}", file=sys.stderr)
        found[name] = []
        for rival in rivals:
            if rival.product.installed():
                try:
                    found[name].append((rival, alone(race, name, bodies, rival, rounds, threads)))
                except BrokenProcessPool:
                    print(f"{name}: the process of {rival.product}, {rival.settings}, was ended, as the system does "
                          f"where memory runs out; it is left out", file=sys.stderr)
    return found


def our_settings(rival, name):
    """Return our settings against an engine, in words."""
    substeps, hertz = rival.ours.get(name, KINDS[name][-2:])
    return f"{substeps} × {hertz:g} Hz"


def show(races, bodies, threads=1):
    """Print the time of a step and the overlap, ours and each engine's."""
    if threads > 1:
        print(f"Times by the clock on the wall, {threads} threads; in the plane ours has one.")
    table = Table("pile", "engine", "settings", "ours", "time, ours / engine", "middle half", "goal", "ours [ms]",
                  "engine [ms]", "overlap, ours [mm]", "engine [mm]")
    for name, rows in races.items():
        for rival, one in rows:
            quarter, goal = len(one.ratios) // 4, rival.goal.get(name)
            depths = (f"{most:.2f}, mean {mean:.3f}" for most, mean in (one.overlap, one.overlap_engine))
            table.add_row(f"{bodies} {name}", rival.product.name, rival.settings, our_settings(rival, name),
                          f"{np.median(one.ratios):.3f}",
                          f"{one.ratios[quarter]:.3f}–{one.ratios[-1 - quarter]:.3f}", f"{goal:g}" if goal else "–",
                          f"{one.ours:.3f}", f"{one.engine:.3f}", *depths)
    Console(width=200).print(table)


def draw(races, bodies, path, threads=1):
    """Draw time against overlap of all engines and of ours, one picture for each kind: the lower left is best."""
    import matplotlib.pyplot as plt
    figure, panels = plt.subplots(1, len(races), figsize=(5.2 * len(races), 4.2), squeeze=False, layout="constrained")
    for panel, (name, rows) in zip(panels[0], races.items()):
        points = [("ours", our_settings(rival, name), "#0072B2", "o", one.overlap[1], one.ours)
                  for rival, one in {our_settings(rival, name): (rival, one) for rival, one in rows}.values()]
        points += [(rival.product.name, rival.settings.partition(":")[0], rival.product.colour, rival.product.marker,
                    one.overlap_engine[1], one.engine) for rival, one in rows]
        for engine, settings, colour, marker, overlap, ms in points:
            panel.scatter(overlap, ms, color=colour, marker=marker, s=60)
            panel.annotate(f"{engine}\n{settings.partition(',')[0]}".strip(), (overlap, ms), (6, 4), color=colour,
                           textcoords="offset points", fontsize=9)
        panel.set(xscale="log", yscale="log", title=f"{bodies:,} {name}", xlabel="mean overlap [mm]",
                  ylabel="CPU time of a step [ms]" if threads == 1 else f"time of a step on {threads} threads [ms]")
        panel.margins(0.3)
        plain_ticks(panel.xaxis, panel.yaxis)
    figure.savefig(path)
    plt.close(figure)


def measure(kinds, bodies, rounds, growth, memory, figure=None, most=10_000, threads=1):
    """Print the memory, the growth up to `most` bodies, or else the races of some kinds of piles; of all without names.

    figure: a file for a picture of the growth or of the races.  Raises BadInput for an unknown kind, and for more
    threads than there are, or threads where one is timed.
    """
    check_known("pile", kinds, KINDS)
    if threads > (os.cpu_count() or 1):
        raise BadInput("--threads", threads, f"this machine has {os.cpu_count()}")
    if threads > 1 and (growth or memory):
        raise BadInput("--threads", threads, "leave it out with --growth and --memory: they look at one thread")
    if memory:
        remember(compiled_lesson())
    if growth:
        grow(kinds or KINDS, most, rounds, figure)
    if not (memory or growth):
        races = compare(kinds or KINDS, bodies, rounds, threads)
        show(races, bodies, threads)
        if figure:
            draw(races, bodies, figure, threads)
