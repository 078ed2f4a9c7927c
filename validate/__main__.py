"""The command line: `validate` measures scenes and writes the report, `validate list` names them, `validate record` keeps traces."""

import json
import os
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from enum import Enum
from multiprocessing import get_context
from pathlib import Path
from typing import Annotated, Optional

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from solutions.checks import BadInput

from . import binding, engines

app = typer.Typer(add_completion=False, invoke_without_command=True, rich_markup_mode=None, pretty_exceptions_enable=False,
                  help="Hold every scene against its truth and against the engines; write the report.")
console = Console()


class EngineName(str, Enum):
    pymunk = "pymunk"
    pybullet = "pybullet"


@app.callback()
def validate(
    context: typer.Context,
    scene: Annotated[Optional[list[str]], typer.Option(help="Only this scene (may be repeated).")] = None,
    lesson: Annotated[Optional[list[str]], typer.Option(help="Only the scenes of this lesson (may be repeated).")] = None,
    of: Annotated[str, typer.Option(help="Whose answers: solutions, lessons or a folder of lesson files.")] = "solutions",
    plain: Annotated[Optional[bool], typer.Option("--plain/--compiled", help="One speed only; both without this option.")] = None,
    quick: Annotated[bool, typer.Option("--quick/--full", help="Time only short runs, or all of them.")] = True,
    engine: Annotated[Optional[list[EngineName]], typer.Option(help="Run only this engine live (may be repeated).")] = None,
    set_: Annotated[Optional[list[str]], typer.Option("--set", metavar="NAME=VALUE", help="Change a parameter of one scene's first case.")] = None,
    jobs: Annotated[int, typer.Option(min=1, help="Processes for everything that is not timed.")] = max(1, min(4, os.cpu_count() or 1)),
    out: Annotated[Path, typer.Option(help="Folder of the report.")] = Path("report"),
):
    if context.invoked_subcommand:
        return
    names = chosen(scene or [], lesson or [])
    there(of, names)
    plan = plan_of(of, names, plain, quick, [e.value for e in engine or []], overrides(set_ or [], names))
    folder = writable(out)
    raise typer.Exit(run(names, plan, jobs, folder))


@app.command("list")
def list_scenes():
    """Name every scene and its lesson."""
    table = Table("scene", "lesson", "what it is", box=None, header_style="bold")
    for name in chosen([], []):
        module = binding.bind_scene(name)
        table.add_row(name, module.LESSON, (module.__doc__ or "").strip().splitlines()[0])
    console.print(table)


@app.command("record")
def record(scene: Annotated[Optional[list[str]], typer.Option(help="Only this scene (may be repeated).")] = None):
    """Keep the traces of pybullet in the repository, for machines without it."""
    from . import record as recorder
    if not engines.installed("pybullet"):
        raise BadInput("engine 'pybullet'", "not installed", "record where it is: Linux x86-64 with Python 3.11 or older")
    for name in chosen(scene or [], []):
        path = recorder.record(name)
        if path:
            console.print(f"recorded {name} in {path.relative_to(binding.ROOT)}")


# ---------------------------------------------------------------------------------------------- what was asked for

def chosen(scenes, lessons):
    """The scenes that were asked for; all of them when nothing was.  Raises BadInput for a name that is none."""
    for name in scenes:
        binding.bind_scene(name)
    for name in lessons:
        binding.bind(name)
    wanted = {n: binding.bind_scene(n).LESSON for n in scenes or binding.scene_names()}
    return [n for lesson in binding.lesson_names() for n in sorted(wanted) if wanted[n] == lesson and (scenes or not lessons or lesson in lessons)]


def there(of, names):
    """Raises BadInput when the worked answers are asked for in a copy of the workbook that is without them."""
    without = sorted({lesson for lesson in (binding.bind_scene(n).LESSON for n in names) if binding.withheld(lesson)})
    if binding.subject_folder(of) == binding.SOLUTIONS and without:
        raise BadInput("this copy of the workbook", f"without worked answers of {', '.join(without)}", "give --of lessons --plain")


def plan_of(of, names, plain, quick, wanted, changes):
    from .measure import Plan
    folder = binding.subject_folder(of)
    for name in wanted:
        if not engines.installed(name):
            raise BadInput(f"engine {name!r}", "not installed", "leave --engine out: its recorded traces stand in")
    live = tuple(name for name in (wanted or engines.NAMES) if engines.installed(name))
    speeds = {None: ("plain", "compiled"), True: ("plain",), False: ("compiled",)}[plain]
    if plain is False and not binding.can_compile():
        raise BadInput("numba", "not installed", "install it, or use --plain")
    waiting = {name: count for name in {binding.bind_scene(n).LESSON for n in names}
               if (folder / f"{name}.py").is_file() and (count := len(binding.withheld(name, folder)))}
    if not binding.can_compile() or (waiting and plain is None):                     # a function without a body has no type
        speeds = ("plain",)
        if waiting:
            console.print(f"Plain speed only, until every exercise is done: {', '.join(f'{n} of {name} wait' for name, n in sorted(waiting.items()))}.")
    return Plan(of, speeds, quick, live, changes)


def overrides(pairs, names):
    """((name, value), …) from NAME=VALUE.  Raises BadInput for what is no number or no parameter, or for more than one scene."""
    changes = []
    for pair in pairs:
        name, _, text = pair.partition("=")
        if len(names) != 1:
            raise BadInput(f"--set {pair}", f"meant for {len(names)} scenes", "name one with --scene")
        first = next(iter(binding.bind_scene(names[0]).CASES.values()))
        if name not in first._fields:
            raise BadInput(f"parameter {name!r}", f"unknown in {names[0]}", f"choose from: {', '.join(first._fields)}")
        try:
            changes.append((name, type(getattr(first, name))(text)))
        except ValueError:
            raise BadInput(f"parameter {name}", repr(text), "give a number") from None
    if changes:
        scene = binding.bind_scene(names[0])
        scene.start(next(iter(scene.CASES.values()))._replace(**dict(changes)))          # raises BadInput for impossible values
    return tuple(changes)


def writable(out):
    """The output folder, made if need be.  Raises BadInput when nothing can be written there."""
    try:
        out.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=out):
            pass
    except OSError as e:
        raise BadInput(f"output folder {str(out)!r}", f"not writable ({e.strerror})", "name another with --out") from None
    return out


# ---------------------------------------------------------------------------------------------- the run

def run(names, plan, jobs, out):
    """Measure, report, and say how it went: 0, or 1 when something departs from its truth without having been predicted."""
    from . import report
    from .report import summary
    store = Store(out, plan, names)
    try:
        with Progress(TextColumn("{task.description:22}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), console=console) as bars:
            measure_errors(store, names, plan, jobs, bars)
            measure_times(store, names, plan, bars)
            results, stability = store.results(names), store.stability(names)
            front = report.write(out, results, stability, plan, jobs, bars)
    except KeyboardInterrupt:
        console.print(f"Interrupted. What was finished is kept in {out}: the same command goes on from there.")
        return 130
    store.finish()
    departures = summary.show(console, results, stability)
    console.print(f"\nThe report lies in [bold]{front}[/bold]", highlight=False, soft_wrap=True)
    return 1 if departures else 0


class Store:
    """Results on disk, one file each.  A run that was interrupted is continued; a finished one is measured anew."""

    def __init__(self, out, plan, names):
        self.folder, self.mark = out / "results", out / "results" / "unfinished.json"
        self.folder.mkdir(exist_ok=True)
        stamp = {"plan": list(map(str, plan)), "code": code_digest(plan.of), "names": names}
        if not (self.mark.is_file() and json.loads(self.mark.read_text()) == stamp):
            for old in self.folder.glob("*.json"):
                old.unlink()
            write_whole(self.mark, stamp)

    def path(self, kind, name):
        return self.folder / f"{name}.{kind}.json"

    def has(self, kind, name):
        return self.path(kind, name).is_file()

    def get(self, kind, name):
        return json.loads(self.path(kind, name).read_text())

    def put(self, kind, name, value):
        write_whole(self.path(kind, name), value)

    def results(self, names):
        return [{**self.get("errors", name), "times": self.get("times", name)} for name in names]

    def stability(self, names):
        return [case for lesson in lessons_of(names) for case in self.get("stability", lesson)]

    def finish(self):
        self.mark.unlink(missing_ok=True)


def write_whole(path, value):
    """Write JSON so that a reader never sees half of it."""
    draft = path.with_suffix(".part")
    draft.write_text(json.dumps(value, ensure_ascii=False, allow_nan=False))
    draft.replace(path)


def code_digest(of):
    """Fingerprint of all code that a result depends on."""
    package = Path(__file__).parent
    files = {*package.rglob("*.py"), *binding.SOLUTIONS.glob("*.py"), *binding.subject_folder(of).glob("*.py")}
    return binding.fingerprint(files)


def lessons_of(names):
    """The lessons of these scenes, in the order of the course."""
    there = {binding.bind_scene(name).LESSON for name in names}
    return [lesson for lesson in binding.lesson_names() if lesson in there]


def mixed(names):
    """The scenes in turns, one of each lesson: neighbours, which run at one time, then compile little twice."""
    lessons = [binding.bind_scene(name).LESSON for name in names]
    turns = {name: lessons[:k].count(lessons[k]) for k, name in enumerate(names)}
    return sorted(names, key=turns.get)


def measure_errors(store, names, plan, jobs, bars):
    """Errors of every scene and then the stability cases, several processes at a time: compiling is most of it."""
    from . import measure
    tasks = {**{("errors", n): (measure.errors, n, plan) for n in mixed(names)},
             **{("stability", lesson): (measure.stability_cases, lesson, plan) for lesson in lessons_of(names)}}
    todo = {key: call for key, call in tasks.items() if not store.has(*key)}
    bar = bars.add_task("errors and stability", total=len(tasks), completed=len(tasks) - len(todo))
    if jobs == 1 or len(todo) <= 1:
        for key, (function, *arguments) in todo.items():
            store.put(*key, function(*arguments))
            bars.advance(bar)
        return
    pool = ProcessPoolExecutor(min(jobs, len(todo)), mp_context=get_context("spawn"))
    try:
        waiting = {pool.submit(*call): key for key, call in todo.items()}
        for done in as_completed(waiting):
            store.put(*waiting[done], done.result())
            bars.advance(bar)
    except BrokenProcessPool:
        raise BadInput("a measuring process", "gone", "the machine may be short of memory: try --jobs 1") from None
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


def measure_times(store, names, plan, bars):
    """Run times, one scene after the other and nothing beside them."""
    from . import measure
    todo = [n for n in names if not store.has("times", n)]
    bar = bars.add_task("run times", total=len(names), completed=len(names) - len(todo))
    for name in todo:
        store.put("times", name, measure.times(name, plan, store.get("errors", name)))
        bars.advance(bar)


def main(arguments=None):
    """Run the command line; bad input ends with one sentence and exit code 2."""
    try:
        app(arguments, prog_name="validate")
    except BadInput as e:
        print(f"validate: {e}", file=sys.stderr)
        sys.exit(2)


if __name__ == "__main__":
    main()
