"""`grade SUBMISSIONS --out GRADES`: a class, from folders and zips to points with reasons."""

import json
import os
import secrets
import sys
from datetime import datetime
from importlib.metadata import version
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from solutions.checks import BadInput
from validate.run.command import start
from validate.run.processes import Ended, alone_in
from validate.run.store import whole, writable, write_whole

from . import children, choice, classlist, ending, local, marking, marks, pages, sandbox, similar, submissions, uploads

JOBS = max(1, min(8, os.cpu_count() or 1))
console = Console()
app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)


Class = Annotated[
    Path,
    typer.Argument(
        metavar="SUBMISSIONS",
        help="Folder with one folder or zip per student; a bare file NAME_LESSON.py will do.",
    ),
]
Out = Annotated[Path, typer.Option(help="Folder for grades, pages and CSV.")]
Lessons = Annotated[list[str] | None, typer.Option(help="Only this lesson (may be repeated); all of them without.")]
Exercises = Annotated[str | None, typer.Option(metavar="N.K,N.K-N.K,N.K=POINTS", help=choice.OPTION)]
Seed = Annotated[
    str | None,
    typer.Option(help="Secret from which hidden inputs are drawn; made and kept in OUT/seed.txt without."),
]
Due = Annotated[str | None, typer.Option(metavar="YYYY-MM-DDTHH:MM", help="When it was due.")]
Late = Annotated[
    float,
    typer.Option(min=0.0, max=100.0, help="Percent of the maximum taken off for each day begun after that."),
]
Roster = Annotated[
    Path | None,
    typer.Option(help=f"CSV: {', '.join(classlist.Person._fields)}; all columns but the first may be missing."),
]
Jobs = Annotated[int, typer.Option(min=1, help="Submissions at a time.")]
Executor = Annotated[
    str | None,
    typer.Option(metavar="tcp://HOST:PORT", help="Hand the submissions to this Dask scheduler."),
]


@app.command(help="Grade a class: one folder or zip per student, the lesson files inside.")
def grade(
    class_: Class,
    out: Out = Path("grades"),
    lesson: Lessons = None,
    exercises: Exercises = None,
    seed: Seed = None,
    due: Due = None,
    late: Late = 0.0,
    roster: Roster = None,
    jobs: Jobs = JOBS,
    executor: Executor = None,
):
    if sandbox.unavailable():
        raise BadInput("the sandbox", f"not available ({sandbox.unavailable()})",
                       "without one no code of a student runs; docs/grading.md says what it needs")
    children.apart_from_path(class_)
    beside(class_, out)
    lessons, worth = choice.chosen(lesson or [], exercises)
    people = classlist.roster(roster, lambda told: say([told])) if roster else {}
    if late and not due and not any(who.due for who in people.values()):
        raise BadInput("--late", f"{late:g}, and nothing has a due date",
                       "give --due, or a column due in the class list")
    terms = pages.Terms(classlist.deadline(due or "", "--due"), late, any(who.timestamp for who in people.values()))
    intake = submissions.read_all(class_, lessons, people, roster)
    sandbox.keep_out({class_: "submissions", out: "output folder", **({roster: "class list"} if roster else {})})
    with alone_in(writable(out)):
        settings = marking.settings(lessons, secret(out, seed), worth)
        known = {*people, *intake.unclear, *intake.students()}
        given = marks.read(class_, settings, known, lambda told: say([told]))
        say([marks.told(given)] if given else [])
        raise typer.Exit(run(intake, settings, people, terms, jobs, executor, out, given))


# ---------------------------------------------------------------------------------------------- what was asked for

def beside(class_, out):
    """Raise BadInput for an output folder in the class folder, where the next run would take it for a student's."""
    if out.resolve().is_relative_to(class_.resolve()):
        raise BadInput(f"--out {str(out)!r}", "in the class folder", "name a folder beside it")


def secret(folder, seed):
    """Return the given seed, the one kept in this folder, or a new one.  It is kept, so that grading is repeatable.

    Where another one is given than before, the one before is kept beside it: earlier marks can be repeated with it.
    Raises BadInput for an empty seed, which any student could guess.
    """
    file, earlier = folder / "seed.txt", folder / "seed-before.txt"
    kept = seed is None and file.is_file()
    seed = (file.read_text() if kept else secrets.token_hex(16) if seed is None else seed).strip()
    if not seed:
        remedy = "write the secret into it" if kept else "give a secret, or leave --seed out"
        raise BadInput(f"file {str(file)!r}" if kept else "--seed", "empty", remedy)
    if os.name == "posix" and file.is_file() and file.stat().st_mode & 0o077:
        said = "could be read by others on this machine, and is closed to them now"
        console.print(f"{file} {said}: if one of them may be a student, give another --seed.", style="bold red",
                      highlight=False, markup=False, soft_wrap=True)
    before = file.read_text().strip() if file.is_file() else ""
    if before not in ("", seed):
        write_secret(earlier, f"{earlier.read_text() if earlier.is_file() else ''}{before}\n")
        say([f"This is another seed than before. The seed of earlier marks is kept in {earlier}."])
    write_secret(file, f"{seed}\n")
    return seed


def write_secret(file, text):
    """Write a file that only this account can read."""
    with whole(file) as draft:
        draft.unlink(missing_ok=True)
        draft.touch(0o600)                                             # before the secret is in it
        draft.write_text(text)


# ---------------------------------------------------------------------------------------------- the run

def run(intake, settings, people, terms, jobs, executor, out, given):
    """Grade what is not graded yet, write every file, and say how it went: 0, or 1 when a submission is not graded."""
    try:
        results, failed = collected(intake, settings, jobs, executor, out)
    except Ended as e:
        console.print(f"Interrupted. What was graded is kept in {out}: the same command goes on from there.")
        return e.code
    graded = [one for s in intake.submissions if s.student in results for one in shared(results[s.student], intake)]
    failed = {who: why for student, why in failed.items() for who in intake.owners_of(student)}
    front = pages.write(out, graded, failed, settings, people, terms, about(intake, settings), given)
    pages.show(console, graded, failed, settings, given)
    say(gap.sentence for gap in uploads.gaps(people) if not gap.whole)  # without any ids it is not used
    say(["", *ending.sentences(intake, graded, failed, people, terms)])
    console.print(f"\nThe class lies in [bold]{front}[/bold]", highlight=False, soft_wrap=True)
    return 1 if failed else 0


def collected(intake, settings, jobs, executor, out):
    """Return ({student: result}, {student: reason for no result}): of an earlier run, or found and kept now.

    Raises Ended, and BadInput for a seed with which a test refuses a worked answer.
    """
    kept, results, todo, failed = out / "results", {}, [], dict(intake.unclear)
    kept.mkdir(exist_ok=True)
    for submission in intake.submissions:
        result = before(kept / f"{pages.file_name(submission.student)}.json", settings.digest(submission))
        if result:
            results[submission.student] = result
        else:
            todo.append(submission)
    coming = on_cluster(executor, todo, settings) if executor else local.results(jobs, todo, settings)
    if todo:                                                           # after a wrong address has been named
        with console.status("worked answers, with the secret inputs"):
            local.check_seed(settings)
    columns = TextColumn("{task.description:12}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn()
    with Progress(*columns, console=console) as bars:
        bar = bars.add_task("submissions", total=len(intake.submissions), completed=len(results))
        for student, result, why in coming:
            if result:
                results[student] = result
                write_whole(kept / f"{pages.file_name(student)}.json", result)
            else:
                failed[student] = f"the grader itself failed: {why}"
            bars.advance(bar)
    return results, failed


def shared(result, intake):
    """Return the results of all whose submission it is."""
    students = intake.owners_of(result["student"])
    told = [f"this is one submission of {', '.join(students)}"] * (len(students) > 1) + result["problems"]
    return [{**result, "student": student, "problems": told} for student in students]


def say(sentences):
    for sentence in sentences:
        console.print(sentence, highlight=False, markup=False, soft_wrap=True)


def about(intake, settings):
    """Return what the page says of this run."""
    versions = f"workbook {settings.code}, Python {sys.version.split()[0]}, NumPy {version('numpy')}"
    alike, now = similar.alike(intake.submissions, settings.lessons), datetime.now().isoformat(timespec="seconds")
    alike = {who: pairs for one, pairs in alike.items() for who in intake.owners_of(one)}
    return pages.Run(intake.overlooked, alike, now, versions, pages.fingerprint(settings.seed))


def before(path, digest):
    """Return the result of an earlier run, if nothing has changed since."""
    try:
        result = json.loads(path.read_text())
    except (OSError, ValueError):
        return None
    return result if result.get("digest") == digest else None


def on_cluster(executor, todo, settings):
    from . import cluster
    return cluster.results(executor, todo, settings)


def main(arguments=None):
    """Run the command line."""
    start("grade", app, arguments)


if __name__ == "__main__":
    main()
