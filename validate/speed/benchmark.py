"""Speed and memory: `python -m validate.speed.benchmark`.

A row gives the requirement, if it has one, and the result.  Speeds are ratios of one run, but a frame of cloth is
compared with 1/60 s, and the import of a lesson with 0.3 s.  Memory has a limit in GiB.
"""

import subprocess
import sys
import time

import numpy as np
from rich.console import Console
from rich.table import Table

from solutions import springs
from solutions.given import pbd
from solutions.integrators import observed_order

from ..run.command import start
from ..subject import modules

REPEATS = 9


def net(n_springs, seed=1):
    """Return a square net, slightly disturbed, with about this many structural springs: x, v, mesh."""
    side = int(np.sqrt(n_springs / 2)) + 1
    grid = np.stack(np.meshgrid(np.arange(side), -np.arange(side), indexing="ij"), axis=-1).reshape(-1, 2) * 0.1
    x = grid + 1e-3 * np.random.default_rng(seed).normal(size=grid.shape)
    node = np.arange(side * side).reshape(side, side)
    ends = ((node[:-1], node[1:]), (node[:, :-1], node[:, 1:]))
    pairs = np.concatenate([np.stack([a.ravel(), b.ravel()], 1) for a, b in ends])
    mesh = springs.make_spring_network(x, 0.01, [0, side - 1], pairs, 50.0, 0.05, (0.0, -9.81), (0.01, 0.0), 0.01)
    return x, np.zeros_like(x), mesh


def pulls(x, v, mesh):
    """Return the forces (s, d) of all springs on their first ends, in plain NumPy style."""
    r, u = x[mesh.j] - x[mesh.i], v[mesh.j] - v[mesh.i]
    length = np.sqrt(np.sum(r * r, axis=1))
    tension = mesh.k * (length - mesh.rest) + mesh.k_d * np.sum(r * u, axis=1) / length
    return (tension / length)[:, None] * r


def numpy_forces_add_at(x, v, mesh):
    """Compute the forces on all points, with np.add.at for the ends."""
    pull, force = pulls(x, v, mesh), np.zeros_like(x)
    np.add.at(force, mesh.i, pull)
    np.subtract.at(force, mesh.j, pull)
    return force


def numpy_forces_bincount(x, v, mesh):
    """Compute the same with the fastest scatter that NumPy has for few columns."""
    pull = pulls(x, v, mesh)
    columns = [
        np.bincount(mesh.i, pull[:, c], len(x)) - np.bincount(mesh.j, pull[:, c], len(x)) for c in range(x.shape[1])
    ]
    return np.stack(columns, axis=1)


def numpy_step(forces, x, v, dt, mesh):
    """Take one vectorised symplectic Euler step of the whole mesh."""
    free = (mesh.inv_mass > 0.0)[:, None]
    force = forces(x, v, mesh) + mesh.wind - mesh.k_v * v
    v = v + dt * np.where(free, mesh.gravity + force * mesh.inv_mass[:, None], 0.0)
    return x + dt * v, v


def step_times(contenders):
    """Return {name: median seconds}, interleaved; contenders = {name: (function, steps per call)}."""
    samples = {name: [] for name in contenders}
    for _ in range(REPEATS):
        for name, (function, steps) in contenders.items():
            begin = time.perf_counter()
            function()
            samples[name].append((time.perf_counter() - begin) / steps)
    return {name: float(np.median(s)) for name, s in samples.items()}


def compiled_run(n_springs, steps):
    """Return a function that takes this many compiled symplectic Euler steps of a net, already compiled."""
    world = modules.module_set(compiled=True)
    step = world.lesson("integrators").symplectic_euler_step
    acceleration = world.lesson("springs").spring_network_acceleration
    advance, (x, v, mesh) = world.lesson("integrators").advance, net(n_springs)
    advance(step, acceleration, 0.0, x, v, 1e-4, 1, mesh)
    return lambda: advance(step, acceleration, 0.0, x, v, 1e-4, steps, mesh)


def thousand_springs():
    """Compare a compiled step of 1,000 springs with two ways of vectorising it."""
    x, v, mesh = net(1000)
    times = step_times({
        "compiled": (compiled_run(1000, 200), 200),
        "add.at": (lambda: numpy_step(numpy_forces_add_at, x, v, 1e-4, mesh), 1),
        "bincount": (lambda: numpy_step(numpy_forces_bincount, x, v, 1e-4, mesh), 1),
    })
    for way, wanted in (("add.at", 10.0), ("bincount", None)):
        ratio = times[way] / times["compiled"]
        asked = f"at least {wanted:g}×" if wanted else "for comparison"
        yield (
            f"{mesh.i.size} springs, one step: NumPy with {way} / compiled",
            asked,
            f"{ratio:.1f}×  ({times[way] * 1e6:.0f} µs / {times['compiled'] * 1e6:.1f} µs)",
            wanted is None or ratio >= wanted,
        )


def growth():
    """Measure the cost of a step as a function of the number of springs, with at least ten steps per run.

    Fewer would include the overhead of a loop before its first step and after its last.
    """
    sizes = np.array([1000, 10_000, 100_000, 1_000_000])
    steps = np.maximum(10, 200_000 // sizes)
    times = step_times({n: (compiled_run(n, k), k) for n, k in zip(sizes, steps)})
    order = observed_order(sizes.astype(float), np.array([times[n] for n in sizes]))
    yield (
        "cost of a step over 10³ to 10⁶ springs grows as n to the",
        "1.0 ± 0.1",
        f"{order:.3f}",
        abs(order - 1.0) <= 0.1,
    )


def boxes(n, seed=1):
    """Return corners low, high (n, 3) of boxes, one per cubic metre, with about as many neighbours for any n."""
    rng = np.random.default_rng(seed)
    low = rng.uniform(0.0, n ** (1.0 / 3.0), (n, 3))
    return low, low + rng.uniform(0.0, 1.2, (n, 3))


def pair_search():
    """Measure pairs of boxes by two trees, rebuilt each time: how the cost grows, and the cost of testing all pairs."""
    lesson, sizes = modules.module_set(compiled=True).lesson("collisions"), np.array([1000, 10_000, 100_000])
    search = lambda find, b: (lambda: find(*b), 1)
    asked = (*(("tree_pairs", n) for n in sizes), ("all_pairs", 1000), ("all_pairs", 10_000))
    times = step_times({(name, n): search(getattr(lesson, name), boxes(n)) for name, n in asked})
    growth = times["tree_pairs", 100_000] / times["tree_pairs", 1000]
    most = 100.0 * np.log(1e5) / np.log(1e3)
    yield (
        "pairs by trees, 10⁵ boxes over 10³",
        f"at most n log n: {most:.0f}×",
        f"{growth:.0f}×  ({times['tree_pairs', 100_000] * 1e3:.0f} ms / {times['tree_pairs', 1000] * 1e3:.1f} ms)",
        growth <= most,
    )
    for n in (1000, 10_000):
        ratio = times["all_pairs", n] / times["tree_pairs", n]
        yield f"pairs of {n:,} boxes: brute force / trees", "above 1×", f"{ratio:.1f}×", ratio > 1.0


def cloth_frame():
    """Measure a frame of a cloth of 100 × 100 points, 20 sweeps of PBD and of XPBD, over its 1/60 s."""
    from ..reference.pbd import weave
    side, sweeps, frame = 100, 20, 1.0 / 60.0
    flat = weave(side, 0.01, 1e-4, 1e3, 9.81)
    threads = flat.pairs[:2 * side * (side - 1)]
    net = pbd.make_constraint_network(flat.x, flat.m, flat.held, threads, 1e-4, 1.0, (0.0, 0.0, -flat.g), sweeps)
    lesson = modules.module_set(compiled=True).lesson("pbd")
    advance = modules.module_set(compiled=True).lesson("integrators").advance

    def frames(step, substeps, net):
        v, dt = 0.0 * flat.x, frame / substeps
        run = lambda: advance(step, lesson.network_gravity, 0.0, flat.x, v, dt, substeps, net)
        run()
        return run, 1

    ways = {
        "PBD, 20 sweeps": frames(lesson.pbd_step, 1, net),
        "XPBD, 20 sweeps": frames(lesson.xpbd_step, 1, net),
        "XPBD, 20 substeps": frames(lesson.xpbd_step, 20, net._replace(sweeps=1)),
    }
    for name, seconds in step_times(ways).items():
        yield (
            f"a cloth of {side} × {side}, {threads.shape[0]} links, {name}: frame over 1/60 s",
            "at most 1",
            f"{seconds / frame:.2f}  ({1e3 * seconds:.1f} ms)",
            seconds <= frame,
        )


def printed(code):
    """Return the output of a new Python process that runs this code."""
    command = [sys.executable, "-c", code]
    return subprocess.run(command, cwd=modules.ROOT, capture_output=True, text=True, check=True).stdout


def memory():
    """Measure the peak memory of a process that takes steps with a million springs."""
    code = ("import resource; from validate.speed.benchmark import compiled_run; compiled_run(1_000_000, 5)(); "
            "print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)")
    peak = int(printed(code))
    gib = peak * (1 if sys.platform == "darwin" else 1024) / 2**30                     # kB on Linux, bytes on macOS
    yield "a million springs, peak memory", "within 4 GiB", f"{gib:.2f} GiB", gib <= 4.0


def imports():
    """Measure the import of a lesson, NumPy included, in a new process, and of NumPy alone."""
    def seconds(module):
        code = f"import time; t = time.perf_counter(); import {module}; print(time.perf_counter() - t)"
        return float(np.median([float(printed(code)) for _ in range(5)]))

    alone = seconds("numpy")
    for name in modules.lesson_names():
        taken = seconds(f"solutions.{name}")
        yield f"import of lesson {name}", "under 0.3 s", f"{taken:.2f} s  (NumPy alone {alone:.2f} s)", taken < 0.3


PARTS = thousand_springs, growth, pair_search, cloth_frame, memory, imports


def main():
    """Measure speed and memory as ratios; exit with 1 if a requirement is not met."""
    return measured(PARTS)


def measured(parts):
    """Print every requirement with its result; return 1 if one is not met, else 0."""
    table, missed = Table("what", "asked", "found", "", box=None, header_style="bold"), 0
    for part in parts:
        for what, asked, found, met in part():
            table.add_row(what, asked, found, "[green]met[/green]" if met else "[bold red]not met[/bold red]")
            missed += not met
    Console().print(table)
    return 1 if missed else 0


if __name__ == "__main__":
    start("python -m validate.speed.benchmark", main)
