"""`python -m tests.grading.benchmark scale`: what a submission costs, and how long 10,000 of them take.

Measured: a class of which a tenth is hostile or broken, on Dask with 2 and with 4 workers; plain pytest on the same
files; the files of 10,000 made from the results.  Simulated from these: 10,000 submissions on 1 to 64 workers, of
which one in a hundred is lost.

A submission costs what the clock says while two are graded on two cores, the start of its process included.  The
system does not count what the processor does for a sandbox that is ended, so seconds of the processor are those of
the grader's own processes.  The simulation takes one core for each worker.  Busy neighbours make all of it larger.
"""

import heapq
import json
import os
import pickle
import platform
import random
import re
import resource
import subprocess
import sys
import tempfile
import time
from contextlib import contextmanager
from datetime import date
from math import ceil
from pathlib import Path
from statistics import mean, median
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from tests import attacks
from validate.grading import cluster, example, marking, pages, sandbox, similar, submissions
from validate.run.store import write_whole
from validate.subject import modules

from . import rehearsal

LESSONS = ("integrators", "springs")
WORKERS, SIMULATED = (2, 4), (1, 2, 4, 8, 16, 32, 64)
LARGE = 10_000               # submissions of the large class [-]
LOST = 0.01                  # share of the workers that are lost during the run [-]: one at least, where there are two
RUNS = 20                    # of the simulation, each with other times and losses [-]
EVERY = 10                   # one in so many is hostile [-]
MEANWHILE = ("handing over", "results")                # what one process does while the workers grade …
AFTER = ("answers that are alike", "pages, CSV, Gradescope")           # … and after that
SAMPLE = 4                   # honest submissions that plain pytest runs [-]
console = Console()
app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)


class Measured:
    """Seconds by the clock and of the processor, and the largest process [MiB]."""
    wall = cpu = memory = 0.0


@contextmanager
def measured(whose):
    """A Measured that is filled in when the block ends."""
    found, before, began = Measured(), resource.getrusage(whose), time.perf_counter()
    yield found
    after = resource.getrusage(whose)
    found.wall, found.memory = time.perf_counter() - began, after.ru_maxrss / 1024
    found.cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


# ---------------------------------------------------------------------- a class that is really graded

def class_of(count, folder):
    """Honest students, each with another part of the work done, and hostile ones: (submissions, hostile students)."""
    files, texts, hostile = example.files(), [a.text for a in attacks.ATTACKS if a.text], set()
    for n in range(count):
        place = folder / f"s{n:05d}"
        place.mkdir(parents=True)
        theirs = files[("ada", "ada", "bob", "cem", "dia")[n % 5]]
        if n % EVERY == 0:
            hostile.add(place.name)
            evil = attacks.HONEST + texts[n // EVERY % len(texts)]
            theirs = {"integrators": evil, "springs": files["ada"]["springs"]}
        for lesson, text in theirs.items():
            (place / f"{lesson}.py").write_text(text)
    return submissions.read_all(folder, LESSONS).submissions, hostile


def on_dask(count, handed_in, rules):
    """(results, Measured) of a scheduler and so many workers on this machine, their start included."""
    from tests.grading.test_cluster import cluster_of
    results = {}
    with measured(resource.RUSAGE_CHILDREN) as found, tempfile.TemporaryDirectory() as scratch:
        with cluster_of(count, Path(scratch)) as (address, _):
            for student, result, why in cluster.results(address, handed_in, rules):
                results[student] = result
                if why:
                    console.print(f"{student}: {why}")
    return results, found


def plain(texts, folder):
    """Two ordinary runs of pytest, with the public and with a secret seed."""
    for lesson, text in texts.items():
        (folder / f"{lesson}.py").write_bytes(text)
    for seed in ("public", "a secret"):
        files = [f"tests/lessons/test_{lesson}.py" for lesson in LESSONS]
        options = [f"--of={folder}", f"--seed={seed}", "-p", "no:cacheprovider", "--tb=no"]
        subprocess.run([sys.executable, "-m", "pytest", *files, *options], cwd=modules.ROOT, capture_output=True)


def ordinary(handed_in):
    """Seconds by the clock of plain pytest for one submission."""
    began = time.perf_counter()
    for one in handed_in:
        with tempfile.TemporaryDirectory() as folder:
            plain(one.files, Path(folder))
    return (time.perf_counter() - began) / len(handed_in)


# ---------------------------------------------------------------------- the files of a large class

def files_of(results, rules):
    """{step: Measured} of what one process does for LARGE submissions beside grading, with results like those."""
    texts = [json.dumps(result) for result in results]
    sources = example.files()
    many, steps = [submitted(f"s{n:05d}", sources["ada"], n) for n in range(LARGE)], {}
    terms = pages.Terms("2026-11-30T23:59:00", 10.0)
    with tempfile.TemporaryDirectory() as scratch:
        out = Path(scratch)
        (out / "results").mkdir()
        with measured(resource.RUSAGE_SELF) as steps["handing over"]:
            for one in many:
                cluster.parcel(one, rules)
        all_results = [{**json.loads(texts[n % len(texts)]), "student": one.student} for n, one in enumerate(many)]
        with measured(resource.RUSAGE_SELF) as steps["results"]:
            for result in all_results:
                write_whole(out / "results" / f"{result['student']}.json", result)
        with measured(resource.RUSAGE_SELF) as steps["answers that are alike"]:
            alike = similar.alike(many, rules.lessons)
        with measured(resource.RUSAGE_SELF) as steps["pages, CSV, Gradescope"]:
            pages.write(out, all_results, {}, rules, {}, terms, pages.Run(alike=alike))
        with measured(resource.RUSAGE_SELF) as steps["reading results again"]:
            for result in all_results:
                json.loads((out / "results" / f"{result['student']}.json").read_text())
    return steps


def submitted(student, texts, n):
    return submissions.Submission(student, {lesson: varied(text, n) for lesson, text in texts.items()}, (), "")


def varied(text, n):
    """A student's text like no other's: a fifth of its assignments are changed."""
    draw = random.Random(n)

    def changed(line):
        return f"{line} + {draw.randrange(99)} * n" if " = " in line and draw.random() < 0.2 else line
    return "\n".join(map(changed, text.splitlines())).encode()


# ---------------------------------------------------------------------- a large class on many workers

def makespan(costs, workers, draw):
    """Seconds until all are graded, by workers that take the next one as they get free.

    One in a hundred workers, and one at least, is lost at some moment of the run and does not come back.  What it
    had begun is begun again, at the end, which is the worst.
    """
    lost = ceil(LOST * workers) if workers > 1 else 0
    about = sum(costs) / workers
    ends = [about * draw.random() if n < lost else float("inf") for n in range(workers)]
    free, waiting, last = [(0.0, n) for n in range(workers)], list(reversed(costs)), 0.0
    while waiting:
        now, worker = heapq.heappop(free)
        if now >= ends[worker]:
            continue
        cost = waiting.pop()
        if now + cost > ends[worker]:
            waiting.insert(0, cost)
            continue
        last = max(last, now + cost)
        heapq.heappush(free, (now + cost, worker))
    return last


def simulated(costs, serial):
    """[(workers, hours of grading, hours with what one process does at the end, share of the perfect speed-up)]"""
    rows = []
    for workers in SIMULATED:
        times = []
        for run in range(RUNS):
            draw = random.Random(run)
            times.append(makespan(draw.choices(costs, k=LARGE), workers, draw))
        rows.append((workers, mean(times) / 3600, (mean(times) + serial) / 3600))
    whole = rows[0][2]
    return [(*row, whole / row[2] / row[0]) for row in rows]


# ---------------------------------------------------------------------- the command

def start_of(rules):
    """Seconds to start the process that grades one submission on a worker, here one that has nothing to grade."""
    times = []
    for _ in range(3):
        began = time.perf_counter()
        cluster.asked(cluster.parcel(None, rules))
        times.append(time.perf_counter() - began)
    return min(times)


def costs_of(results, hostile, start):
    """([seconds of each honest submission], [of hostile ones]) by the clock, the start of a process included."""
    found = [(student in hostile, start + r["seconds"]) for student, r in results.items() if r]
    return [s for evil, s in found if not evil], [s for evil, s in found if evil]


def printed(title, columns, rows):
    shown = Table(title=title, title_justify="left", header_style="bold", box=None, pad_edge=False)
    for n, column in enumerate(columns):
        shown.add_column(column, justify="right" if n else "left")
    for row in rows:
        shown.add_row(*map(str, row))
    console.print(shown, "")


def graded(handed_in, hostile, rules):
    """Grade the class with 2 and with 4 workers, and print what that took; the results of 2."""
    rows, count, first = [], len(handed_in), None
    for workers in WORKERS:
        results, found = on_dask(workers, handed_in, rules)
        first = first or results
        done = sum(result is not None for result in results.values())
        rows.append((workers, f"{done} of {count}", f"{found.wall:.0f}", f"{found.wall / count:.2f}",
                     f"{found.cpu / count:.2f}", f"{found.memory:.0f}"))
    printed(f"{count} submissions of {len(LESSONS)} lessons, {len(hostile)} of them hostile or broken",
            ("workers", "graded", "clock [s]", "clock, each [s]", "grader's processor, each [s]",
             "largest process [MiB]"),
            rows)
    return first


def compared(handed_in, hostile, results, honest, evil):
    """Print the cost of a submission beside that of plain pytest, and what hostile ones have gained."""
    alone = ordinary([one for one in handed_in if one.student not in hostile][:SAMPLE])
    stolen = sum(t["earned"] for s in hostile if results[s] for t in results[s]["tests"]
                 if t["lesson"] == "integrators" and t["exercise"] != "1.10")          # 1.10 is right in all of them
    console.print(f"an honest one: {mean(honest):.1f} s (median {median(honest):.1f}); plain pytest on the same files: "
                  f"{alone:.1f} s; ratio {mean(honest) / alone:.2f}")
    console.print(f"a hostile or broken one: {mean(evil):.1f} s by the clock, {max(evil):.1f} at most; "
                  f"they gained {stolen:g} points\n")


def sizes(one, result, rules):
    """Print what travels to a worker and back."""
    there, settings, back = len(cluster.parcel(one, rules)), len(pickle.dumps(rules)), len(json.dumps(result))
    console.print(f"To a worker go {there / 1024:.0f} KiB, {settings / 1024:.0f} of them settings; "
                  f"{back / 1024:.0f} KiB come back.\n")


def need_sandbox():
    """Hostile files must never run without a sandbox."""
    if sandbox.unavailable():
        console.print(f"There is nothing to measure: {sandbox.unavailable()}.", highlight=False, soft_wrap=True)
        raise typer.Exit(2)


def machine():
    """Date, cores and processor, for the documentation."""
    info = Path("/proc/cpuinfo")
    names = re.findall(r"model name\s*: (.*)", info.read_text()) if info.is_file() else []
    return f"{date.today()}, {os.cpu_count()} cores, {(names or [platform.machine()])[0]}"


@app.command("class", help="Grade one class with hostile submissions several times: fair, and the same bytes.")
def class_(size: Annotated[int, typer.Option(min=5, help="Submissions, a fifth of them hostile.")] = 200,
           runs: Annotated[int, typer.Option(min=1, help="So often with each number of jobs.")] = 3,
           jobs: Annotated[list[int], typer.Option(help="Submissions at a time (may be repeated).")] = (2, 4)):
    need_sandbox()
    console.print(machine())
    seen = []
    with tempfile.TemporaryDirectory() as scratch:
        for one in rehearsal.rehearse(scratch, size, runs, jobs):
            seen.append(one)
            console.print(told(one, size), highlight=False, soft_wrap=True)
    same = len({one.digest for one in seen}) == 1
    fair = all(one.fair() for one in seen)
    console.print(f"{'Every' if fair else 'NOT every'} run is fair.")
    console.print(f"The bytes are {'the same' if same else 'NOT the same'} in all runs.")
    raise typer.Exit(0 if fair and same else 1)


def told(one, size):
    """A line about one run of a class."""
    return (f"--jobs {one.jobs}: {one.wall:.0f} s by the clock, {one.wall / size:.2f} s per submission, of which "
            f"the grader's own processes had {one.cpu / size:.2f} s of the processor; full marks for {one.full} of "
            f"{one.honest} honest ones ({one.honest_seconds:.1f} s each, median); {one.hostile} hostile ones gained "
            f"{one.gained:g} points ({one.hostile_seconds:.1f} s each, median); bytes {one.digest}")


@app.command(help="What a submission costs, and how long 10,000 of them take on 1 to 64 workers.")
def scale(count: Annotated[int, typer.Option("--submissions", min=EVERY, help="To be really graded.")] = 40):
    need_sandbox()
    console.print(machine())
    rules = marking.settings(LESSONS, "a secret")
    with tempfile.TemporaryDirectory() as scratch:
        handed_in, hostile = class_of(count, Path(scratch))
    results, start = graded(handed_in, hostile, rules), start_of(rules)
    honest, evil = costs_of(results, hostile, start)
    console.print(f"{start:.1f} s of each are the start of a process")
    compared(handed_in, hostile, results, honest, evil)

    steps = files_of([result for result in results.values() if result], rules)
    printed(f"What one process does for {LARGE:,} submissions",
            ("step", "processor [s]", "each [ms]", "memory so far [MiB]"),
            [(name, f"{found.cpu:.1f}", f"{1000 * found.cpu / LARGE:.2f}", f"{found.memory:.0f}")
             for name, found in steps.items()])
    sizes(handed_in[1], results[handed_in[1].student], rules)

    after = sum(steps[name].cpu for name in AFTER)
    printed(f"{LARGE:,} submissions, simulated from these figures: 1 % of the workers lost, {RUNS} runs each",
            ("workers", "grading [h]", "with the files [h]", "of the perfect speed-up"),
            [(workers, f"{grading:.2f}", f"{whole:.2f}", f"{part:.0%}")
             for workers, grading, whole, part in simulated(honest + evil, after)])
    limit = LARGE * mean(honest + evil) / sum(steps[name].cpu for name in MEANWHILE)
    console.print(
        f"The grading itself is the bottleneck up to about {limit:.0f} workers; beyond, it is the one process "
        "that hands submissions over and keeps the results."
    )


if __name__ == "__main__":
    app()
