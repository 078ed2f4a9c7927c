"""The command line: `validate` measures scenes and writes the report, `validate list` names them, `validate record` keeps traces."""

import os
import tempfile
from enum import Enum
from math import isfinite
from pathlib import Path
from typing import Annotated, Optional

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from solutions.checks import BadInput

from . import binding, engines
from .processes import Ended, alone_in, ending_once, one_sentence, workers
from .store import SUBSET, lessons_of, store_for

app = typer.Typer(add_completion=False, invoke_without_command=True, rich_markup_mode=None, pretty_exceptions_enable=False,
                  help="Hold every scene against its truth and against the engines; write the report.  With --scene or --lesson, only their part of the report "
                       f"in OUT is made anew.  If the rest of it was made by other code or with other options, it stays as it is, and theirs goes into OUT/{SUBSET}.")
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
    from . import measure
    names = chosen(scene or [], lesson or [])
    there(of, names)
    plan = plan_of(of, names, plain, quick, [e.value for e in engine or []], overrides(set_ or [], names))
    try:
        with workers(jobs) as pool:
            for _ in pool.each({name: (measure.load, name, of) for name in names}):
                pass
            with alone_in(writable(out)):
                code = run(names, plan, pool, out)
    except Ended as e:
        console.print(f"Interrupted. What was finished is kept in {out}: the same command goes on from there.", soft_wrap=True)
        code = e.code
    raise typer.Exit(code)


@app.command("list")
def list_scenes():
    """Name every scene and its lesson."""
    table = Table("scene", "lesson", "what it is", box=None, header_style="bold")
    scenes, broken = {}, []
    for name in binding.scene_names():
        try:
            scenes[name] = binding.bind_scene(name)
        except BadInput as e:
            broken.append(e)
    for name in ordered(scenes):
        table.add_row(name, scenes[name].LESSON, (scenes[name].__doc__ or "").strip().splitlines()[0])
    console.print(table)
    for why in broken:
        raise why


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
    for name in lessons:
        binding.bind(name)
    for name in scenes or binding.scene_names():
        binding.bind_scene(name)
    return [n for n in ordered(scenes or binding.scene_names()) if scenes or not lessons or binding.bind_scene(n).LESSON in lessons]


def ordered(names):
    """Scenes in the order of the course."""
    lessons = binding.lesson_names()
    return sorted(set(names), key=lambda name: (lessons.index(binding.bind_scene(name).LESSON), name))


def there(of, names):
    """Raises BadInput when answers are asked for that are not there."""
    folder = binding.subject_folder(of)
    lessons = {m.lesson for n in names for m in binding.bind_scene(n).METHODS} | set(lessons_of(names))
    if missing := sorted(f"{lesson}.py" for lesson in lessons if not (folder / f"{lesson}.py").is_file()):
        raise BadInput(f"folder {str(of)!r}", f"without {', '.join(missing)}", "put the lesson files there, or name lessons that are there with --lesson")
    without = [lesson for lesson in lessons_of(names) if binding.withheld(lesson)]
    if folder == binding.SOLUTIONS and without:
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
    from . import measure
    changes = []
    for pair in pairs:
        name, _, text = pair.partition("=")
        if len(names) != 1:
            raise BadInput(f"--set {pair}", f"meant for {len(names)} scenes", "name one with --scene")
        cases = list(binding.bind_scene(names[0]).CASES.values())
        if name not in cases[0]._fields:
            raise BadInput(f"parameter {name!r}", f"unknown in {names[0]}", f"choose from: {', '.join(cases[0]._fields)}")
        changes.append((name, value_of(name, text, [getattr(case, name) for case in cases])))
    if changes:
        scene = binding.bind_scene(names[0])
        with measure.changed(names[0], changes):
            scene.start(next(iter(scene.CASES.values()))._replace(**dict(changes)))      # raises BadInput for impossible values
    return tuple(changes)


def value_of(name, text, known):
    """A parameter's new value, of the kind of the known ones; words only from among them.  Raises BadInput for anything else."""
    kind = type(known[0])
    try:
        value = kind(text)
    except ValueError:
        value = None
    if value is None or (kind is float and not isfinite(value)) or (kind is str and value not in known):
        wanted = {int: "give a whole number", float: "give a finite number"}.get(kind) or f"choose from: {'; '.join(dict.fromkeys(known))}"
        raise BadInput(f"parameter {name}", repr(text), wanted)
    return value


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

def run(names, plan, pool, out):
    """Measure, report, and say how it went: 0, or 1 when something departs from its truth without having been predicted."""
    from .report import summary
    store = store_for(out, plan, names)
    with Progress(TextColumn("{task.description:22}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), console=console) as bars:
        measure_errors(store, names, plan, pool, bars)
        measure_times(store, names, plan, pool, bars)
        front = report_on(store, names, plan, pool, bars)
    departures = summary.show(console, store.results(names), store.stability(names))
    if store.out != out:
        console.print(f"\nOther scenes in {out} were measured with other code or options: their report stays as it is.", highlight=False, soft_wrap=True)
    console.print(f"\nThe report lies in [bold]{front}[/bold]", highlight=False, soft_wrap=True)
    return 1 if departures else 0


def mixed(names):
    """The scenes in turns, one of each lesson: neighbours, which run at one time, then compile little twice."""
    lessons = [binding.bind_scene(name).LESSON for name in names]
    turns = {name: lessons[:k].count(lessons[k]) for k, name in enumerate(names)}
    return sorted(names, key=turns.get)


def measure_errors(store, names, plan, pool, bars):
    """Errors of every scene and then the stability cases, several at a time: compiling is most of it."""
    from . import measure
    tasks = {**{("errors", n): (measure.errors, n, plan) for n in mixed(names)},
             **{("stability", lesson): (measure.stability_cases, lesson, plan) for lesson in lessons_of(names)}}
    todo = {key: call for key, call in tasks.items() if not store.has(*key)}
    bar = bars.add_task("errors and stability", total=len(tasks), completed=len(tasks) - len(todo))
    for key, value in pool.each(todo):
        store.put(*key, value)
        bars.advance(bar)


def measure_times(store, names, plan, pool, bars):
    """Run times, one scene after the other and nothing beside them."""
    from . import measure
    todo = [n for n in names if not store.has("times", n)]
    bar = bars.add_task("run times", total=len(names), completed=len(names) - len(todo))
    for name in todo:
        for key, value in pool.each({("times", name): (measure.times, name, plan, store.get("errors", name))}):
            store.put(*key, value)
            bars.advance(bar)


def report_on(store, names, plan, pool, bars):
    """Write the report of these scenes and of those that were measured before with the same code and plan; the path of its front page."""
    from . import report
    shown = ordered(store.scenes())
    results, stability = store.results(shown), store.stability(shown)
    pages = report.files(results, stability)
    store.note(pages=sorted({*store.state["pages"], *pages}))        # before they are written: should that be interrupted, the next report knows of them
    front = report.write(store.out, results, stability, plan, pool, bars, store.measured)
    store.finish(names, pages)
    return front


def main(arguments=None):
    """Run the command line."""
    with one_sentence("validate"), ending_once():
        app(arguments, prog_name="validate")


if __name__ == "__main__":
    main()
