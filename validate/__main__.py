"""The command line: `validate` measures scenes and writes the report, `validate list` names them,
`validate record` keeps traces, `validate summary` prints the main results, `validate compare` what
changed, `validate audit` whether a report follows from its raw rows, `validate limits` how sharp its limits are.
`validate piles` and `validate targets` time our code against the engines.
"""

import json
import os
from contextlib import contextmanager
from importlib import import_module
from importlib.util import find_spec
from math import isfinite
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from solutions.checks import BadInput

from .engines.products import BUILDERS, PRODUCTS, PYBULLET, product_named
from .run.command import start
from .run.processes import Ended, alone_in, workers
from .run.store import FULL_RUN, SUBSET, lessons_of, report_of_this_version, stored_report, writable, write_text
from .subject import copies, modules, needs

HELP = (
    "Compare every scene with its truth and with the engines; write the report.  "
    "--scene and --lesson update their part of the report in OUT.  If its other scenes were measured with other code "
    f"or other options, that report stays as it is, and the scenes that you name get their own in OUT/{SUBSET}.")
app = typer.Typer(add_completion=False, invoke_without_command=True, rich_markup_mode=None,
                  pretty_exceptions_enable=False, help=HELP)
console = Console()


RESULTS = "<!-- results -->"    # begins and ends the table of results in the README
UNBROKEN = 1000              # width of a table that a program reads, not a person [characters]
ONE_SCENE = typer.Option(help="Only this scene (may be repeated).")
ONE_LESSON = typer.Option(help="Only the scenes of this lesson (may be repeated).")
ANSWERS = typer.Option(help="Whose answers: solutions, lessons or a folder of lesson files.")
SPEED = typer.Option("--plain/--compiled", help="One speed only; else both, but a quick run compiles only some scenes.")
DEPTH = typer.Option("--quick/--full", help="Compile, refine and time only what is quick; or everything.")
LIVE = typer.Option(metavar="NAME|FILE.py", help=f"Run only this engine live: {', '.join(map(str, PRODUCTS))} (may be "
                    "repeated); or run an engine of your own, a file with build(model, dt), as docs/engine.md shows.")
CHANGE = typer.Option("--set", metavar="NAME=VALUE", help="Change a parameter of one scene's first case.")
PROCESSES = typer.Option(min=1, help="Processes for everything that is not timed.")
JOBS = max(1, min(4, os.cpu_count() or 1))
ROUNDS = Annotated[int, typer.Option(min=3, help="How often each is timed, in turn.")]
EXECUTOR = typer.Option(metavar="tcp://HOST:PORT", help="Measure on this Dask cluster instead of in processes here.")


@app.callback()
def validate(
    context: typer.Context,
    scene: Annotated[list[str] | None, ONE_SCENE] = None,
    lesson: Annotated[list[str] | None, ONE_LESSON] = None,
    of: Annotated[str, ANSWERS] = "solutions",
    plain: Annotated[bool | None, SPEED] = None,
    quick: Annotated[bool, DEPTH] = True,
    engine: Annotated[list[str] | None, LIVE] = None,
    set_: Annotated[list[str] | None, CHANGE] = None,
    jobs: Annotated[int, PROCESSES] = JOBS,
    executor: Annotated[str | None, EXECUTOR] = None,
    out: Annotated[Path, typer.Option(help="Folder of the report.")] = Path("report"),
):
    if context.invoked_subcommand:
        return
    files = [name for name in engine or [] if name.endswith(".py")]
    apart_from_files(out)
    if files:
        refuse_unused(context)
        raise typer.Exit(own_engines(files, [name for name in engine or [] if name not in files], scene, quick, out))
    from . import measure  # takes half a second: not for --help
    from .run.run import run
    names, broken = select_scenes(scene or [], lesson or [])
    asked, of = of, copies.meant_here(of)
    require_answers(of, names)
    plan = plan_of(of, names, plain, quick, engine or [], overrides(set_ or [], names))
    try:
        with workers(jobs) as pool, on_cluster(executor, of) as measuring:
            if modules.subject_folder(of) != modules.SOLUTIONS:          # those were loaded here
                for _ in pool.each({name: (measure.load, name, of) for name in names}):
                    pass
            with alone_in(writable(out)):
                code = run(names, plan, pool, out, console, measuring)
        if of != asked:
            console.print(f"Measured: {of}, with the scenes of {modules.ROOT}", highlight=False, soft_wrap=True)
    except Ended as e:
        console.print(f"Interrupted. What was finished is kept in {out}: the same command goes on from there.",
                      soft_wrap=True)
        code = e.code
    for error in broken.values():                            # after the other scenes have run
        raise error
    raise typer.Exit(code)


def refuse_unused(context):
    """Raise BadInput for an option that has no effect beside an engine in a file."""
    for name in ("of", "lesson", "plain", "set_", "jobs", "executor"):
        if context.get_parameter_source(name).name == "COMMANDLINE":
            raise BadInput(f"--{name.rstrip('_')} beside an engine in a file", "without effect",
                           "leave it out; --scene, --quick or --full, --engine and --out count")


def own_engines(files, named, scenes, quick, out):
    """Run engines of the reader beside known ones, and return the exit code."""
    if find_spec("validate.worlds.conformance") is None:
        raise BadInput("--engine with a file", "not in this copy", "take a clone of the workbook")
    conform = import_module("validate.worlds.conformance").conform        # a copy for students does without
    return max(conform(file, scenes or [], installed(named, BUILDERS), quick, out, console) for file in files)


@contextmanager
def on_cluster(executor, of):
    """Yield a Cluster for the duration of the block; None without an address."""
    if executor is None:
        yield None
        return
    from .run.cluster import cluster
    with cluster(executor, of) as measuring:
        yield measuring


@app.command("list")
def list_scenes(
    exercises: Annotated[bool, typer.Option("--exercises", help="Name every exercise, and what it calls.")] = False,
):
    """Name every scene and its lesson; or every exercise, and the exercises that it calls."""
    if exercises:
        list_exercises()
        return
    table = Table("scene", "lesson", "what it is", box=None, header_style="bold")
    scenes, broken = loadable_scenes()
    for name in modules.in_course_order(scenes):
        table.add_row(name, scenes[name].lesson, scenes[name].story.splitlines()[0])
    for name in broken:
        table.add_row(name, "–", "[bold red]cannot be loaded[/bold red]")
    print_whole(table)
    for error in broken.values():
        raise error


def print_whole(table):
    """Print a table with one line per row, unless a person looks at it in a narrow terminal."""
    (console if console.is_terminal else Console(width=UNBROKEN)).print(table)


def list_exercises():
    table = Table("exercise", "lesson", "function", "calls", box=None, header_style="bold")
    for number, one in needs.table().items():
        table.add_row(number, one["lesson"], one["function"], ", ".join(one["needs"]))
    print_whole(table)


@app.command("record")
def record(scene: Annotated[list[str] | None, ONE_SCENE] = None):
    """Keep the traces of pybullet in the repository, for machines without it."""
    from .measure.record import record as write_record
    if not PYBULLET.installed():
        raise BadInput("engine 'pybullet'", "not installed",
                       "record where it is: Linux x86-64 with Python 3.11 or older")
    names, broken = select_scenes(scene or [], [])
    for name in names:
        path = write_record(name)
        if path:
            console.print(f"recorded {name} in {path.relative_to(modules.ROOT)}")
    for error in broken.values():
        raise error


@app.command("compare")
def compare(
    old: Annotated[Path, typer.Argument(help="Folder of the earlier report.")],
    new: Annotated[Path, typer.Argument(help="Folder of the later report.")],
):
    """Print what changed between two reports; exit with 1 when something became worse."""
    from .report.compare import KINDS, changes, format_of
    before, after = stored_report(old), stored_report(new)
    found = changes(before, after)
    if format_of(before) != format_of(after):
        console.print(f"Formats of the reports: {format_of(before)} and {format_of(after)}.", highlight=False)
    for kind in KINDS:
        of_kind = [change for change in found if change.kind == kind]
        console.print(f"[bold]{kind}[/bold]: {len(of_kind)} changed, {sum(c.worse for c in of_kind)} worse",
                      highlight=False)
        for change in sorted(of_kind, key=lambda change: not change.worse):
            console.print(f"  {'✗' if change.worse else '·'} {change.place}  {change.words}", highlight=False,
                          markup=False, soft_wrap=True)
    raise typer.Exit(1 if any(change.worse for change in found) else 0)


@app.command("audit")
def audit(
    report: Annotated[Path, typer.Argument(help="Folder of a report.")] = Path("report"),
    jobs: Annotated[int, PROCESSES] = JOBS,
):
    """Recompute every figure and verdict of a report from its raw rows, and make its pages and pictures again.

    Exit with 1 when something differs.
    """
    from .report.audit import audit as check
    content = report_of_this_version(report)
    columns = TextColumn("{task.description:22}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn()
    try:
        with workers(jobs) as pool, Progress(*columns, console=console) as bars:
            problems, counts, notes = check(report, content, pool.each, bars.track)
    except (KeyError, TypeError, AttributeError, IndexError, RuntimeError):           # the last one from a process
        raise BadInput(f"report {str(report)!r}", "with parts missing", "make it again") from None
    for problem in problems:
        console.print(f"✗ {problem}", highlight=False, markup=False, soft_wrap=True)
    for note in notes:
        console.print(f"· not checked: {note}", highlight=False, markup=False, soft_wrap=True)
    say_measured(content)
    checked = ", ".join(f"{count} {what}" for what, count in counts.items())
    console.print(f"{len(problems)} differences in {checked}.", highlight=False, soft_wrap=True)
    raise typer.Exit(1 if problems else 0)


def say_measured(report):
    """Print each limit and tolerance of a report that was measured and not derived."""
    from .report.words import measured_limits
    for place, why in measured_limits(report["scenes"], report["stability"]):
        console.print(f"· measured, not derived: {place}: {why}", highlight=False, markup=False, soft_wrap=True)


@app.command("summary")
def summary(
    report: Annotated[Path, typer.Argument(help="Folder of a report.")] = Path("report"),
    into: Annotated[Path | None, typer.Option(help=f"Put it between the marks {RESULTS} of this file.")] = None,
    keep: Annotated[bool, typer.Option("--keep", help="Keep it, for quick reports to show beside their own.")] = False,
):
    """Print the main results of a report as a table in Markdown, one line per lesson."""
    from .report.summary import by_lesson, in_short
    content = report_of_this_version(report)
    if keep and content["run"]["mode"] != "full":
        raise BadInput(f"report {str(report)!r}", "of a quick run", "keep the results of a full one")
    text = by_lesson(content)
    if keep:
        write_text(FULL_RUN, json.dumps(in_short(content), ensure_ascii=False, indent=1) + "\n")
    if into is None:
        print(text, end="")
    else:
        put_between_marks(into, text)


def put_between_marks(into, text):
    """Replace what stands between two marks RESULTS in a file.  Raises BadInput without them."""
    try:
        head, mark, rest = into.read_text(encoding="utf-8").partition(RESULTS)
        _, closing, tail = rest.partition(RESULTS)
    except (OSError, UnicodeDecodeError):
        raise BadInput(f"file {str(into)!r}", "not readable as text", "name a text file") from None
    if not (mark and closing):
        raise BadInput(f"file {str(into)!r}", f"without two marks {RESULTS}", "put them where the table belongs")
    into.write_text(f"{head}{mark}\n{text}{closing}{tail}", encoding="utf-8")


@app.command("limits")
def limits(report: Annotated[Path, typer.Argument(help="Folder of a report.")] = Path("report")):
    """Print how many times larger than the error the limits of a report are, and its loosest curves."""
    from .report.limits import show
    show(report)
    say_measured(report_of_this_version(report))


@app.command("piles")
def piles(
    kinds: Annotated[list[str] | None, typer.Argument(help="discs, boxes, spheres or bricks; else all")] = None,
    bodies: Annotated[int, typer.Option(min=1)] = 1000,
    rounds: ROUNDS = 15,
    growth: Annotated[bool, typer.Option("--growth", help="How the cost of a step grows.")] = False,
    most: Annotated[int, typer.Option(min=316, max=100_000, help="Bodies of the largest pile of --growth.")] = 10_000,
    memory: Annotated[bool, typer.Option("--memory", help="The memory of 10,000 spheres.")] = False,
    threads: Annotated[int, typer.Option(min=1, help="Of ours in space, of Box2D and of Rapier.  With two, 10,000 "
                                                     "spheres take less time, and bricks or 1,000 do not.")] = 1,
    figure: Annotated[Path | None, typer.Option(help="File for a picture of the result.")] = None,
):
    """Time piles of lesson 9 against the engines, as ratios measured in one run."""
    from .speed.piles import measure
    if figure:
        writable(figure.absolute().parent, "--figure")
    measure(kinds or [], bodies, rounds, growth, memory, figure, most, threads)


@app.command("targets")
def targets(
    arms: Annotated[list[str] | None, typer.Argument(help="planar or spatial; else both")] = None,
    targets: Annotated[int, typer.Option(min=1)] = 1000,
    rounds: ROUNDS = 15,
):
    """Time inverse kinematics of lesson 11 against pybullet, as ratios measured in one run."""
    from .speed.targets import measure
    measure(arms or [], targets, rounds)


# ---------------------------------------------------------------------------------------------- what was asked for

def apart_from_files(out):
    """Raise BadInput for an output folder in which the 500 files of a report would lie among others.

    It holds the working folder, which an empty name means, too; or it holds Python files.
    """
    if Path.cwd().is_relative_to(out.resolve()):
        raise BadInput(f"--out {str(out)!r}", "the folder in which you work, or one around it",
                       "name a folder for the report, such as report")
    if out.is_dir() and any(out.glob("*.py")):
        raise BadInput(f"--out {str(out)!r}", "a folder with Python files", "name one for the report, such as report")


def loadable_scenes():
    """Return ({name: Scene}, {name: BadInput}): the scenes that load, and what is wrong with the others."""
    scenes, broken = {}, {}
    for name in modules.scene_names():
        try:
            scenes[name] = modules.bind_scene(name)
        except BadInput as e:
            broken[name] = e
    return scenes, broken


def select_scenes(scenes, lessons):
    """Return (names, {name: BadInput}): the requested scenes, or all of them, and those that do not load.

    Raises BadInput for an unknown name, and for a requested scene that does not load.
    """
    for name in lessons:
        modules.bind(name)
    for name in scenes:
        modules.bind_scene(name)
    if scenes:
        return modules.in_course_order(scenes), {}
    loadable, broken = loadable_scenes()
    return modules.in_course_order(n for n, scene in loadable.items() if not lessons or scene.lesson in lessons), broken


def require_answers(of, names):
    """Raise BadInput if the requested answers do not exist."""
    folder = modules.subject_folder(of)
    lessons = {r.who.lesson for n in names for r in modules.bind_scene(n).our_runners} | set(lessons_of(names))
    if missing := sorted(f"{lesson}.py" for lesson in lessons if not (folder / f"{lesson}.py").is_file()):
        raise BadInput(f"folder {str(of)!r}", f"without {', '.join(missing)}",
                       "put the lesson files there, or name lessons that are there with --lesson")
    without = [lesson for lesson in lessons_of(names) if modules.withheld(lesson)]
    if folder == modules.SOLUTIONS and without:
        raise BadInput("this copy of the workbook", f"without worked answers of {', '.join(without)}",
                       "give --of lessons --plain")


def installed(wanted, known=PRODUCTS):
    """Return the known engines of these names, or all that are installed.  Raises BadInput for one that is not."""
    chosen = tuple(product_named(name, known) for name in wanted) or known
    for product in chosen if wanted else ():
        if not product.installed():
            raise BadInput(f"engine {product.name!r}", "not installed", product.remedy)
    return tuple(product for product in chosen if product.installed())


def plan_of(of, names, plain, quick, wanted, changes):
    from .measure import Plan
    folder = modules.subject_folder(of)
    live = installed(wanted)
    speeds = {None: ("plain", "compiled"), True: ("plain",), False: ("compiled",)}[plain]
    if plain is False and not modules.can_compile():
        raise BadInput("numba", "not installed", "install it, or use --plain")
    waiting = {name: count for name in {modules.bind_scene(n).lesson for n in names}
               if (folder / f"{name}.py").is_file() and (count := len(modules.withheld(name, folder)))}
    if not modules.can_compile() or (waiting and plain is None):  # a function without a body has no type
        speeds = ("plain",)
        if waiting:
            left = ", ".join(f"{n} of {name} wait" for name, n in sorted(waiting.items()))
            console.print(f"Plain speed only, until every exercise is done: {left}.")
    return Plan(of, speeds, quick, live, changes)


def overrides(pairs, names):
    """Return ((name, value), …) from NAME=VALUE.

    Raises BadInput for what is no number or no parameter, or for more than one scene.
    """
    from .measure.selection import changed
    changes = []
    for pair in pairs:
        name, sign, text = pair.partition("=")
        if not (name and sign):
            raise BadInput(f"--set {pair!r}", "not NAME=VALUE", "write it like --set k=400")
        if name in dict(changes):
            raise BadInput(f"--set {name}", "given twice", "give each parameter once")
        if len(names) != 1:
            raise BadInput(f"--set {pair}", f"meant for {len(names)} scenes", "name one with --scene")
        cases = list(modules.bind_scene(names[0]).cases.values())
        if name not in cases[0]._fields:
            known = ", ".join(cases[0]._fields)
            raise BadInput(f"parameter {name!r}", f"unknown in {names[0]}", f"choose from: {known}")
        changes.append((name, value_of(name, text, [getattr(case, name) for case in cases])))
    if changes:
        with changed(names[0], changes):                     # raises BadInput for impossible values
            modules.bind_scene(names[0]).start(cases[0]._replace(**dict(changes)))
    return tuple(changes)


def value_of(name, text, known):
    """Return the value of a parameter, of the type of its known values.

    A word must be one of them.  Raises BadInput.
    """
    kind = type(known[0])
    try:
        value = kind(text)
    except ValueError:
        value = None
    if value is None or (kind is float and not isfinite(value)) or (kind is str and value not in known):
        number = {int: "give a whole number", float: "give a finite number"}.get(kind)
        raise BadInput(f"parameter {name}", repr(text), number or f"choose from: {'; '.join(dict.fromkeys(known))}")
    return value


def main(arguments=None):
    """Run the command line."""
    start("validate", app, arguments, suggestion)


def suggestion(arguments):
    """Return what a word that is no command may have meant, or where all options are named."""
    if arguments and arguments[0] in typer.main.get_command(app).commands:
        return f": `validate {arguments[0]} --help` names all that there is"
    for words, option in ((modules.scene_names(), "--scene"), (modules.lesson_names(), "--lesson")):
        for word in arguments:
            if word in words and option not in arguments:
                return f": did you mean {option} {word}"
    return ": `validate --help` names all that there is"


if __name__ == "__main__":
    main()
