"""What became slower since an earlier commit: `python -m validate.speed.regression [--base COMMIT]`.

One compiled method of each lesson runs in turn at both commits, each in a process of its own with the packages of this
environment.  Times are CPU times of one thread, in units of an engine's step that runs beside them, so machine and load
cancel.  A method counts as slower only if the whole interval of its ratio lies above SLOWER in 1 + AGAIN pairs of
processes.  The place of compiled code in memory differs between processes, and can change its time by a fifth.
"""

import json
import subprocess
import sys
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from solutions.checks import BadInput

from ..measure.selection import Plan, select
from ..measure.timing import interval, time_ours
from ..methods import BACKTRACKING_DISCS, CONTINUOUS, LOOP_2D, RATTLE, RK4, RUNGE_KUTTA, SLIDING, TANGENTS, TRIANGLES
from ..run.command import start
from ..run.store import full_run
from ..subject import modules
from . import benchmark, piles, targets

ROUNDS = 9
AGAIN = 2                    # new pairs of processes for a method that seems to have become slower [-]
SLOWER = 1.15                # ratio of times, now over then, from which a method has become slower [-]
BLOCK = 0.05                 # a timed block lasts about this long [s]
SPRINGS = 1000               # of the net that is timed [-]
BOXES = 100                  # of the pile that is timed [-]
BALLS = 10                   # of the engine that is the clock [-]
AIMS = 50                    # targets of the arm that is timed [-]


def of_a_scene(name, method):
    """Return () → None, a compiled run of a scene's method, with the steps in the middle of its sweep."""
    selection = select(name, Plan(quick=False))
    runner = next(r for r in selection.ours if r.who is method)
    steps = selection.scene.steps[len(selection.scene.steps) // 2]
    prepare = time_ours(*selection.bound(runner, "compiled"), selection.first[1])
    return prepare(steps, selection.scene.duration / steps)[0]


def pile():
    """Return () → None, four steps of a pile of boxes at rest."""
    kind = piles.KINDS["boxes"]
    work = piles.Ours(modules.bind("contact", compiled=True), kind, *piles.fallen(kind, BOXES))
    work.run(round(piles.SETTLE / piles.DT))
    return lambda: work.run(4)


def arm():
    """Return () → None, searches of an arm with six joints."""
    lesson = modules.bind("kinematics", compiled=True)
    return targets.ours(lesson, "spatial", targets.drawn("spatial", AIMS), targets.THRESHOLD)


WORK = {                     # {lesson: () → what is timed, a function without arguments}
    "integrators": lambda: of_a_scene("kepler", RK4),
    "springs": lambda: benchmark.compiled_run(SPRINGS, 100),
    "friction": lambda: of_a_scene("incline", SLIDING),
    "inertia_tensors": lambda: of_a_scene("ball_mesh", TRIANGLES),
    "rotation": lambda: of_a_scene("asymmetric_top", RUNGE_KUTTA),
    "collisions": lambda: of_a_scene("point_and_plane", CONTINUOUS),
    "impulses": lambda: of_a_scene("oblique_discs", BACKTRACKING_DISCS),
    "pbd": lambda: of_a_scene("rope", RATTLE),
    "contact": pile,
    "simulator": lambda: of_a_scene("moving_wedge", LOOP_2D),
    "kinematics": arm,
    "sensitivities": lambda: of_a_scene("tangent_oscillator", TANGENTS),
}


def engine():
    """Return () → None, steps of a pymunk space with a row of balls that rest on the ground: the clock."""
    import pymunk
    space = pymunk.Space()
    space.gravity = 0.0, -9.81
    ground = pymunk.Segment(space.static_body, (-1.0, 0.0), (2.0 * BALLS, 0.0), 0.0)
    space.add(ground)
    for k in range(BALLS):
        ball = pymunk.Body(1.0, 0.1)
        ball.position = k, 0.4
        space.add(ball, pymunk.Circle(ball, 0.4))
    return lambda: [space.step(1e-3) for _ in range(100)]


def calls_in_a_block(work):
    """Return how many calls of work last about BLOCK seconds, after one call that compiles it."""
    work()
    return max(1, round(BLOCK / max(timed(work, 1), 1e-6)))


def timed(work, calls):
    """Return CPU seconds per call."""
    began = time.thread_time()
    for _ in range(calls):
        work()
    return (time.thread_time() - began) / calls


def serve():
    """Answer every line of the input, the name of a lesson, with [seconds of its method, seconds of the clock]."""
    clock, ready = engine(), {}
    ticks = calls_in_a_block(clock)
    for line in sys.stdin:
        lesson = line.strip()
        if lesson not in ready:
            work = WORK[lesson]()
            ready[lesson] = work, calls_in_a_block(work)
        print(json.dumps([timed(*ready[lesson]), timed(clock, ticks)]), flush=True)


# ---------------------------------------------------------------------------------------------- two commits

@contextmanager
def checkout(revision):
    """Yield the folder of a copy of the repository at a revision, which is removed afterwards.

    Raises BadInput for an unknown revision.
    """
    with tempfile.TemporaryDirectory() as folder:
        add = git("worktree", "add", "--quiet", "--detach", folder, revision)
        if add.returncode:
            raise BadInput(f"--base {revision!r}", "no commit of this repository", "name a commit, a branch or a tag")
        try:
            yield Path(folder)
        finally:
            git("worktree", "remove", "--force", folder)


def of_the_last_full_run():
    """Return the commit of the full run that is kept; None where there is none, as in a clone without its history."""
    commit = (full_run() or {}).get("commit", "")
    return commit if commit and git("cat-file", "-e", f"{commit}^{{commit}}").returncode == 0 else None


def git(*arguments):
    return subprocess.run(["git", *arguments], cwd=modules.ROOT, capture_output=True, text=True)


@contextmanager
def server(folder):
    """Yield ask(lesson) → [seconds of its method, of the clock], answered by the code in that folder.

    ask raises EOFError where that code ends in an error.
    """
    code = "from validate.speed.regression import serve; serve()"

    def begun():
        return subprocess.Popen([sys.executable, "-c", code], cwd=folder, text=True,
                                stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    process = begun()

    def ask(lesson):
        nonlocal process
        process = process if process.poll() is None else begun()
        print(lesson, file=process.stdin, flush=True)
        answer = process.stdout.readline()
        if not answer:
            process.wait()
            raise EOFError(f"the measurement of {lesson} in {folder} ended in an error")
        return np.array(json.loads(answer))
    try:
        yield ask
    finally:
        process.stdin.close()
        process.wait()


def ratios(now, then, lesson):
    """Return times now over then, in steps of the engine, of ROUNDS rounds in turn."""
    def one():
        (method, clock), (method_then, clock_then) = now(lesson), then(lesson)
        return method / clock / (method_then / clock_then)
    return [one() for _ in range(ROUNDS)]


def compared(now, then, lesson):
    """Return what `judged` returns, or a row that says that the measurement failed at the earlier commit.

    One that fails now raises EOFError.
    """
    now(lesson)
    try:
        then(lesson)
    except EOFError:
        return (lesson, "–", "–", "not compared: its measurement failed at that commit"), False
    return judged(lesson, ratios(now, then, lesson))


def judged(lesson, samples):
    """Return (a row of the table, whether the method has become slower)."""
    low, high = interval(samples).values()
    slower = low > SLOWER
    verdict = "[bold red]slower[/bold red]" if slower else "quicker" if high * SLOWER < 1.0 else "as quick"
    return (lesson, f"{np.median(samples):.2f}", f"{low:.2f} to {high:.2f}", verdict), slower


def all_compared(folder):
    """Return {lesson: what `compared` returns} for the code in a folder; what seems slower is measured again."""
    found, wanted = {}, list(WORK)
    for _ in range(1 + AGAIN):
        if wanted:
            with server(modules.ROOT) as now, server(folder) as then:
                found |= {lesson: compared(now, then, lesson) for lesson in wanted}
        wanted = [lesson for lesson in wanted if found[lesson][1]]
    return found


def main(base: Annotated[str | None, typer.Option(help="Else that of the last full run that was kept.")] = None):
    """Compare one compiled method of each lesson with the same at an earlier commit; exit with 1 if one is slower."""
    base = base or of_the_last_full_run()
    if base is None:
        print("no full run is kept whose commit is in this repository, so nothing is compared")
        return
    table = Table("lesson", f"time, now over {base}", "interval", "", box=None, header_style="bold")
    with checkout(base) as folder:
        if not (folder / Path(__file__).relative_to(modules.ROOT)).exists():
            print(f"{base} has no such measurement yet, so nothing is compared")
            return
        found = all_compared(folder)
    for row, _ in found.values():
        table.add_row(*row)
    Console().print(table)
    raise typer.Exit(any(slower for _, slower in found.values()))


if __name__ == "__main__":
    start("python -m validate.speed.regression", main)
