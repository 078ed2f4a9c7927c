"""The command `python -m tests.faults`: does the validation report notice wrong physics, and nothing else?"""

import json
import random
from typing import Annotated

import numpy as np
import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from solutions.checks import BadInput
from validate.run.processes import ending_once, one_sentence, workers
from validate.run.store import code_digest, write_whole
from validate.subject import modules

from . import faults_of
from .drawn import drawn
from .honest import honest_run
from .notice import notice

ENOUGH = 0.95                # share of the faults that the report must notice [-]
KEPT = modules.ROOT / ".cache" / "faults.json"           # {fault: what became of it}, so that a run can be resumed

app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)
console = Console(highlight=False, soft_wrap=True)


@app.command()
def main(lessons: Annotated[list[str] | None, typer.Argument(help="Lessons; all without one.")] = None,
         jobs: Annotated[int, typer.Option(min=1, help="Processes.")] = 2,
         sample: Annotated[int | None, typer.Option(min=1, help="Only so many, drawn at random.")] = None,
         seed: Annotated[int, typer.Option(help="Of that draw; the first honest run.")] = 0,
         steps: Annotated[int | None, typer.Option(min=1, help="Most steps of a scene's sweep: a first look.")] = None,
         random_ones: Annotated[int | None, typer.Option(
             "--drawn", min=1, help="In place of these, so many random ones in given functions.")] = None,
         honest: Annotated[int | None, typer.Option(min=1, help="In place of faults, so many honest runs.")] = None):
    """Plant each fault and print what of the validation report it turns; exit code 1 if fewer than 95 % are noticed.

    A run that was interrupted goes on where it was.  With --honest no verdict may turn.
    """
    with workers(jobs) as pool:
        if honest:
            raise typer.Exit(honest_runs(range(seed, seed + honest), pool))
        faults = drawn(random_ones, seed) if random_ones else chosen(lessons, sample, seed)
        raise typer.Exit(seeded(faults, steps, pool))


def chosen(lessons, sample, seed):
    """The faults to plant.  Raises BadInput for an unknown lesson."""
    known = modules.lesson_names()
    for lesson in lessons or ():
        if lesson not in known:
            raise BadInput(f"lesson {lesson!r}", "unknown", f"choose from: {', '.join(known)}")
    faults = [fault for lesson in known if not lessons or lesson in lessons for fault in faults_of(lesson)]
    if not sample:
        return faults
    noticeable = [fault for fault in faults if not fault.missed]         # one of the others fails a sample of eight
    return random.Random(seed).sample(noticeable, min(sample, len(noticeable)))


def seeded(faults, steps, pool):
    """Print what became of each fault; the exit code."""
    code, kept = f"{code_digest('solutions')}, {steps} steps", read_kept()
    done, hints = {}, {}
    for fault in faults:
        before = kept.get(key(fault), {})
        hints[fault] = before.get("place", "")
        if before.get("code") == code:
            done[fault] = before
    todo = {fault: (notice, fault, hints[fault], steps or np.inf) for fault in faults if fault not in done}
    table_head()
    for fault in done:
        show(fault, done[fault])
    for fault, found in pool.each(todo):
        done[fault] = kept[key(fault)] = {**found._asdict(), "code": code}
        KEPT.parent.mkdir(exist_ok=True)
        write_whole(KEPT, kept)
        show(fault, done[fault])
    return verdict(done)


def key(fault):
    """What a fault is stored under: all of it but the reason of a miss."""
    return "|".join(fault[:4])


def read_kept():
    """What earlier runs found; nothing where no file of theirs can be read."""
    try:
        return json.loads(KEPT.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}


def table_head():
    console.print("fault: scene or stability case that notices it; what turned\n", style="dim")


def show(fault, found):
    """Print one fault and what it turned."""
    if found["turned"]:
        console.print(f"[green]✓[/green] {fault.lesson}.{fault.function}: {escape(fault.wrong)}\n"
                      f"  {found['place']} in {found['seconds']:.1f} s: {escape(found['turned'])}")
    else:
        why = fault.missed or f"tried {', '.join(found['tried']) or 'nothing: no place executes it'}"
        console.print(f"[red]MISSED[/red] {fault.lesson}.{fault.function}: {escape(fault.wrong)}\n  {escape(why)}")


def verdict(done):
    """Print the share of noticed faults per lesson and in all; the exit code."""
    table = Table(header_style="bold", box=None, pad_edge=False)
    for column in ("lesson", "faults", "noticed", "MISSED", "of these with a reason"):
        table.add_column(column, justify="left" if column == "lesson" else "right")
    for lesson in dict.fromkeys(fault.lesson for fault in done):             # given modules have rows of their own
        table.add_row(lesson, *map(str, counts({f: found for f, found in done.items() if f.lesson == lesson})))
    table.add_row("all", *map(str, counts(done)), style="bold")
    console.print()
    console.print(table)
    all_of_them, noticed, _, _ = counts(done)
    console.print(f"The report notices {noticed} of {all_of_them} faults: {noticed / max(1, all_of_them):.1%}.")
    return 0 if noticed >= ENOUGH * all_of_them else 1


def counts(done):
    """(faults, noticed, missed, missed with a reason)."""
    missed = [fault for fault, found in done.items() if not found["turned"]]
    return len(done), len(done) - len(missed), len(missed), sum(bool(fault.missed) for fault in missed)


def honest_runs(numbers, pool):
    """Print what honest runs turn; the exit code: 1 if anything turns."""
    alarms = 0
    for number, run in pool.each({number: (honest_run, number) for number in numbers}):
        alarms += len(run.alarms)
        console.print(f"{'[red]✗[/red]' if run.alarms else '[green]✓[/green]'} {number}: {run.about}; "
                      f"{run.ended} of {run.places} scenes and cases ended, in {run.seconds:.0f} s")
        for place, words in run.alarms.items():
            console.print(f"  {place}: {words}", markup=False)
    console.print(f"{len(numbers)} honest runs turn {alarms} verdicts.")
    return 1 if alarms else 0


if __name__ == "__main__":
    with one_sentence("tests.faults"), ending_once():
        app()
