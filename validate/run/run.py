"""A run: it measures what is not measured yet, writes the report, and prints a summary."""

import os
import platform
import re
import subprocess
import threading
from contextlib import suppress
from datetime import date
from importlib.metadata import version
from pathlib import Path

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from .. import measure
from ..engines.products import PRODUCTS
from ..stability.examine import left_to_full, stability_cases
from ..subject import modules
from . import coverage
from .store import FORMAT, code_digest, full_run, lessons_of, store_for


def run(names, plan, pool, out, console, measuring=None):
    """Measure, report, and return the exit code: 0, or 1 at an unpredicted departure.

    pool: processes of this machine, which draw the report;    measuring: what measures, where that is not the pool
    """
    store = store_for(out, plan, names)
    prepared = threading.Thread(target=prepare, daemon=True)
    prepared.start()
    columns = TextColumn("{task.description:22}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn()
    with Progress(*columns, console=console) as bars:
        measure_errors(store, names, plan, measuring or pool, bars)
        prepared.join()                                  # nothing else runs while a clock does
        measure_times(store, names, plan, measuring or pool, bars)
        front = report_on(store, names, plan, pool, bars, measuring)
    from ..report import summary
    departures = summary.show(console, store.results(names), store.stability(names))
    if store.out != out:
        console.print(f"\nOther scenes in {out} were measured with other code or options: their report stays as it is.",
                      highlight=False, soft_wrap=True)
    console.print(f"\nThe report lies in [bold]{front}[/bold]", highlight=False, soft_wrap=True)
    lost = coverage.missing() if set(names) == set(modules.scene_names()) else []
    if lost:
        console.print(f"Nothing in the report runs {', '.join(lost)}.", highlight=False, soft_wrap=True)
    return 1 if departures or lost else 0


def prepare():
    """Do what takes the run itself seconds and needs no result, while its processes measure."""
    with suppress(Exception):                            # what fails here fails again in the run, and is said there
        from .. import report  # noqa: F401    brings matplotlib along
        coverage.table()


def measure_errors(store, names, plan, pool, bars):
    """Compute the errors of every scene and the stability cases, several at a time: most of it is compilation.

    A process stays with a lesson as long as it can.  Two processes at the same lesson would compile the same twice.
    """
    lessons = {("errors", name): modules.bind_scene(name).lesson for name in names}
    lessons |= {("stability", lesson): lesson for lesson in reversed(lessons_of(names))}     # the short ones come last
    todo = {(kind, name): ((measure.errors if kind == "errors" else stability_cases), name, plan)
            for kind, name in lessons if not store.has(kind, name)}
    bar = bars.add_task("errors and stability", total=len(lessons), completed=len(lessons) - len(todo))
    for key, value in pool.each(todo, lessons):
        store.put(*key, value)
        bars.advance(bar)


def measure_times(store, names, plan, pool, bars):
    """Measure run times, one scene at a time on a machine, in a process that has loaded its lesson if there is one."""
    todo = [n for n in names if not store.has("times", n)]
    bar = bars.add_task("run times", total=len(names), completed=len(names) - len(todo))
    calls = {("times", name): (measure.times, name, plan, {"cases": store.get("errors", name)["cases"]})
             for name in todo}
    for key, value in pool.each(calls, {key: modules.bind_scene(key[1]).lesson for key in calls}, alone=True):
        store.put(*key, value)
        bars.advance(bar)


def report_on(store, names, plan, pool, bars, measuring=None):
    """Write the report of all scenes that were measured with this code and this plan; return its front page."""
    from .. import report  # brings matplotlib along
    shown = modules.in_course_order(store.scenes())
    results, stability = store.results(shown), store.stability(shown)
    pages = report.files(results, stability)
    store.note(pages=sorted({*store.state["pages"], *pages}))        # first, in case writing them is interrupted
    front = report.write(store.out, results, stability, about(plan, store.out, measuring, shown), pool, bars,
                         store.measured)
    store.finish(names, pages)
    return front


def about(plan, out=None, measuring=None, shown=()):
    """Return what a report was made with: a plain record for the foot of its pages.

    shown: names of its scenes.  Links to the sources are there only for a report in a folder of the repository.
    """
    from ..report.again import pages_version  # brings matplotlib along
    inside = out is not None and out.resolve().is_relative_to(modules.ROOT)
    live = [f"{engine} {engine.installed()} live" if engine in plan.live else
            f"{engine} {'left out' if engine.optional else 'recorded'}" for engine in PRODUCTS]
    compiler = f"numba {modules.numba_version()}" if modules.can_compile() else "numba not installed: plain speed only"
    return {
        "format": FORMAT, "full_run": full_run(),
        "of": str(plan.of), "mode": "quick" if plan.quick else "full", "engines": live, "compiler": compiler,
        "speeds": list(plan.speeds), "repeats": plan.repeats(), "date": date.today().isoformat(),
        "machine": f"{platform.system()} {platform.machine()}, Python {platform.python_version()}",
        "processor": processor(), "cores": os.cpu_count(), "executor": str(measuring or ""),
        "code": code_digest(plan.of), "pages": pages_version(),
        "chosen": [] if set(shown) == set(modules.scene_names()) else list(shown),
        "versions": {name: version(name) for name in ("numpy", "scipy", "matplotlib")},
        "overrides": [list(pair) for pair in plan.overrides], "coverage": coverage.table(),
        "given": coverage.given(),
        "version": version("physics-animation-workbook"), "commit": commit(),
        "root": Path(os.path.relpath(modules.ROOT, out.resolve())).as_posix() if inside else "",
        "notebooks": notebooks(),
        "left_to_full": [case.title for lesson in lessons_of(shown) for case in left_to_full(lesson, plan)],
    }


def commit():
    """Return the commit of the workbook, marked where files were changed since; nothing without git."""
    try:
        done = subprocess.run(["git", "describe", "--always", "--dirty=, changed since", "--exclude=*"],
                              cwd=modules.ROOT, capture_output=True, text=True, timeout=10)
    except (OSError, subprocess.SubprocessError):
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""


def notebooks():
    """Return {lesson: its notebook}."""
    files = sorted((modules.ROOT / "notebooks").glob("[0-9][0-9]_*.ipynb"))
    return {file.stem.partition("_")[2]: f"notebooks/{file.name}" for file in files}


def processor():
    """Return the name of the processor, as far as the system tells."""
    try:
        names = re.findall(r"^model name\s*: (.*)$", Path("/proc/cpuinfo").read_text(encoding="utf-8"), re.M)
    except OSError:
        names = []
    return names[0] if names else platform.processor()
