"""A reader's own engine in every described scene: where it agrees with the truth, with which order, what it refuses.

The installed engines stand beside it, and in a full run our own loop.  No theory of this engine is known, and it is
never compared with the theory of another one.  So only its convergence is judged: whether its error vanishes with its
step.
"""

import importlib.util
import signal
import sys
from collections.abc import Callable
from contextlib import contextmanager
from enum import StrEnum
from functools import partial
from html import escape
from itertools import pairwise
from multiprocessing import Pipe, get_context
from pathlib import Path
from typing import NamedTuple

import numpy as np
from rich.table import Table

from solutions.checks import BadInput
from solutions.support.model import State, start_of

from ..measure.accuracy import ASYMPTOTIC, Outcome, finite, relative, shown_order
from ..run.store import writable
from ..subject import modules
from ..subject.loading import TooLong, alarm
from . import ours
from .described import DESCRIBED

MOST = {True: 500, False: 2000}              # most steps of a run, quick or not, where there are enough shorter runs
RUNS = 4                                     # of each scene
LEAST_ORDER = 0.7                            # of an error that vanishes with the step: single runs scatter
EXACT = 1e-9                                 # error of a run that has no error but round-off [-]
STUCK = 3.0                                  # error over the last changes: above it runs converge to another motion
WITHIN = 60.0                                # in which a reader's engine must end all runs of a scene [s]


class Judgement(StrEnum):
    """The verdict on a reader's engine in one scene."""
    AGREES = "agrees"
    DEPARTS = "departs"
    FAILS = "fails"
    SHOWN = "shown, not judged"
    REFUSES = "refuses"


class Reader(NamedTuple):
    """A reader's engine."""
    name: str
    build: Callable          # (model, dt) → a world with step() and state()
    refuses: Callable        # (model) → a reason, or ""


class Beside(NamedTuple):
    """What stands beside a reader's engine and is no product."""
    name: str
    refuses: Callable
    build: Callable

    @property
    def world(self):
        """Return what builds its worlds, as a product does."""
        return self

    def __str__(self):
        return self.name


OURS = Beside("our loop", ours.refuses, partial(ours.build, compiled=modules.can_compile()))


class Row(NamedTuple):
    """One scene."""
    scene: str
    title: str
    steps: tuple             # of each run
    errors: tuple            # relative, of each run; None where it failed
    order: float | None      # that the errors show
    verdict: Judgement
    words: str               # the reason
    others: dict             # {name of an engine: its error with the most steps, or the reason why it has none}


# ---------------------------------------------------------------------------------------------- a file

def load_engine(path):
    """Return the Reader of a file.  Raises BadInput for one that cannot be run or has no build(model, dt)."""
    path, thing = Path(path), f"the engine file {str(path)!r}"
    if not path.is_file():
        raise BadInput(thing, "not there", "name a Python file with build(model, dt)")
    spec = importlib.util.spec_from_file_location(f"engine_of_a_reader_{path.stem}", path)
    module = importlib.util.module_from_spec(spec)
    with beside(path):
        try:
            spec.loader.exec_module(module)
        except (Exception, SystemExit) as error:             # it is a program, and may do anything
            raise BadInput(thing, f"not a program that runs ({sentence(error)})", "mend it") from None
    for name, default in (("build", None), ("refuses", lambda model: "")):
        if not callable(getattr(module, name, default)):
            raise BadInput(f"{name} in {thing}", "missing or not a function",
                           f"define {'build(model, dt)' if name == 'build' else 'refuses(model)'}")
    return Reader(path.stem, module.build, getattr(module, "refuses", lambda model: ""))


@contextmanager
def beside(path):
    """Let a file import its neighbours for the length of the block."""
    sys.path.insert(0, str(path.resolve().parent))
    try:
        yield
    finally:
        sys.path.pop(0)


def sentence(error):
    """Return an exception in one line."""
    lines = str(error).strip().splitlines()
    return f"{type(error).__name__}: {lines[0]}" if lines else type(error).__name__


# ---------------------------------------------------------------------------------------------- runs

def run_to_end(build, described, p, steps, **settings):
    """Return the Outcome of a run of `described` with parameters p, and close its world."""
    model, world, call = described.model(p), None, "build(model, dt)"
    try:
        with np.errstate(all="ignore"):
            world = build(model, described.scene.duration / steps, **settings)
            if world is None:
                raise BadInput("what it returned", None, "return a world with step() and state()")
            call = "step()"
            for _ in range(steps):
                world.step()
            call = "state()"
            found = finite(np.array(described.observe(checked_state(world.state(), model), p), float))
            if found.failure:
                found = Outcome(None, f"{call}: {found.failure} after {steps:,} steps")
    except (Exception, SystemExit) as error:                 # a reader's program may do anything
        found = Outcome(None, f"{call}: {sentence(error)}")
    finally:
        why = failure_to_close(world)
    return Outcome(None, f"close(): {why}") if why else found


def failure_to_close(world):
    """Close a world that can be closed.  Return the error in one line, or ""."""
    try:
        if hasattr(world, "close"):
            world.close()
    except (Exception, SystemExit) as error:
        return sentence(error)
    return ""


def checked_state(state, model):
    """Return a State.  Raises BadInput unless it is (x, q, v, omega) with the shapes of the Model."""
    right = start_of(model)
    try:
        rows = [np.array(one, float) for one in state]
    except (TypeError, ValueError):
        raise BadInput("state()", type(state).__name__, "return (x, q, v, omega), four arrays") from None
    if [row.shape for row in rows] != [row.shape for row in right]:
        raise BadInput("the shapes of state()", [row.shape for row in rows],
                       f"return (x, q, v, omega) with the shapes {[row.shape for row in right]}")
    return State(*rows)


def measured(engine, name, others, most):
    """Return the Row of a scene.  engine: an Apart."""
    described = DESCRIBED[name]
    scene, p = described.scene, described.scene.parameters
    truth = np.array(scene.truth(p, scene.duration), float)
    steps = max(tuple(n for n in scene.steps if n <= most)[-RUNS:], scene.steps[:RUNS], key=len)
    about = {"scene": name, "title": scene.title,
             "others": {product.name: error_of(product, described, p, truth, steps[-1]) for product in others}}
    no_runs = {"steps": (), "errors": (), "order": None}
    try:
        why, found = engine.runs(name, steps)
    except EOFError as error:
        return Row(**about, **no_runs, verdict=Judgement.FAILS, words=str(error))
    if found is None:
        verdict = Judgement.FAILS if isinstance(why, Failed) else Judgement.REFUSES
        return Row(**about, **no_runs, verdict=verdict, words=why)
    errors = tuple(None if one.failure else relative(one.observed, truth) for one in found)
    rows = [{"dt": scene.duration / n, "steps": n, "error": error} for n, error in zip(steps, errors)]
    order = shown_order(rows, 10.0 * scene.truth_uncertainty)
    changes = [None if a.failure or b.failure else relative(b.observed, a.observed) for a, b in pairwise(found)]
    verdict, words = judged(errors, changes, order, scene.truth_uncertainty)
    if found[-1].failure:
        verdict, words = Judgement.FAILS, found[-1].failure
    elif described.shown:
        verdict, words = Judgement.SHOWN, described.shown
    return Row(**about, steps=steps, errors=errors, order=order, verdict=verdict, words=words)


class Failed(str):
    """Why an engine has no runs, where it did not refuse the Model."""


def runs_of(reader, described, steps, within):
    """Return ("", Outcomes of the runs of an engine), or (why there are none, None)."""
    p = described.scene.parameters
    try:
        why = str(reader.refuses(described.model(p)) or "")
    except (Exception, SystemExit) as error:
        return Failed(f"refuses(model): {sentence(error)}"), None
    if why:
        return why, None
    try:
        with alarm(within):
            return "", [run_to_end(reader.build, described, p, n) for n in steps]
    except TooLong as error:
        return Failed(f"its runs of {steps[0]:,} to {steps[-1]:,} steps are {error}"), None


def serve(path, pipe):
    """Answer each question (scene, steps, within) from a pipe with what `runs_of` says of the engine in a file."""
    with beside(Path(path)):
        reader = load_engine(path)
        while True:
            name, steps, within = pipe.recv()
            pipe.send(runs_of(reader, DESCRIBED[name], steps, within))


class Apart:
    """A process of its own with a reader's engine: one in another language may crash."""

    def __init__(self, path):
        self.path, self.process, self.pipe = path, None, None

    def __enter__(self):
        return self

    def __exit__(self, *error):
        if self.process:
            self.process.kill()
            self.process.join()

    def runs(self, name, steps):
        """Return what `runs_of` says of a scene.  Raises EOFError where the process ends before it answers."""
        if self.process is None or not self.process.is_alive():
            self.pipe, there = Pipe()
            self.process = get_context("spawn").Process(target=serve, args=(self.path, there), daemon=True)
            self.process.start()
            there.close()
        try:
            self.pipe.send((name, steps, WITHIN))
            return self.pipe.recv()
        except (EOFError, OSError):
            self.process.join()
            code = self.process.exitcode
            how = f"signal {signal.Signals(-code).name}" if code < 0 else f"code {code}"
            raise EOFError(f"it ended the process, with {how}") from None


def error_of(product, described, p, truth, steps):
    """Return the error of a known engine, or the reason why it has none."""
    why = product.world.refuses(described.model(p))
    if why:
        return why
    settings = (described.settings or {}).get(product, {})
    found = run_to_end(product.world.build, described, p, steps, **settings)
    return found.failure or relative(found.observed, truth)


def judged(errors, changes, order, uncertainty):
    """Return (verdict, reason) from the errors of runs and from how much each run differs from the one before."""
    last = errors[-1]
    if last is None:
        return Judgement.FAILS, ""
    if last <= EXACT + 10.0 * uncertainty:
        return Judgement.AGREES, "no error but round-off"
    if order is not None and order >= LEAST_ORDER and last < ASYMPTOTIC:
        return Judgement.AGREES, f"its error vanishes with order {order:.1f}"
    latest = changes[-2:]
    if latest and None not in latest and last > STUCK * max(latest):
        return Judgement.DEPARTS, f"its runs converge to another motion, {100.0 * last:.2g} % away"
    if last >= ASYMPTOTIC:
        return Judgement.SHOWN, "its shortest step is too long here to judge"
    return Judgement.SHOWN, "its runs show no order yet"


# ---------------------------------------------------------------------------------------------- what a reader gets

def conform(path, names, others, quick, out, console):
    """Run a reader's engine in these scenes, print a table, write a page, and return the exit code.

    It is 1 where the engine fails or departs.  Raises BadInput for a bad file or a scene without a Model.
    """
    reader, others = load_engine(path), others if quick else (OURS, *others)     # our loop has to be compiled
    for name in names:
        if name not in DESCRIBED:
            raise BadInput(f"scene {name!r}", "not listed in validate/worlds/described.py",
                           f"choose from: {', '.join(DESCRIBED)}")
    rows, page = [], writable(Path(out)) / f"engine-{reader.name}.html"
    with Apart(path) as engine:
        for name in names or DESCRIBED:
            rows.append(measured(engine, name, others, MOST[quick]))
            console.print(f"{name}: {rows[-1].verdict}", highlight=False, soft_wrap=True)
    console.print(table(reader, rows))
    page.write_text(page_of(reader, rows, others), encoding="utf-8")
    console.print(f"{summary(rows)}  Page: {page}", highlight=False, soft_wrap=True)
    return int(any(row.verdict in (Judgement.FAILS, Judgement.DEPARTS) for row in rows))


def summary(rows):
    """Return the number of scenes with each verdict, in a sentence."""
    counts = {verdict: sum(row.verdict is verdict for row in rows) for verdict in Judgement}
    scenes = "one scene" if len(rows) == 1 else f"{len(rows)} scenes"
    return f"{scenes}: " + "; ".join(f"{verdict} in {n}" for verdict, n in counts.items() if n) + "."


def number(value):
    """Return an error, or a dash."""
    return "–" if value is None else f"{value:.1e}"


def table(reader, rows):
    """Return the table for a terminal."""
    made = Table(title=f"{reader.name} against the truth")
    for name in ("scene", "steps", "error", "order", "verdict", "reason"):
        made.add_column(name)
    for row in rows:
        steps, error = (str(row.steps[-1]), number(row.errors[-1])) if row.steps else ("–", "–")
        order = "–" if row.order is None else f"{row.order:.1f}"
        made.add_row(row.scene, steps, error, order, row.verdict, row.words)
    return made


STYLE = """body{font:16px/1.5 system-ui,sans-serif;max-width:75rem;margin:2rem auto;padding:0 1rem;color:#222}
.wide{overflow-x:auto}table{border-collapse:collapse;width:100%}td.n{white-space:nowrap}
th,td{text-align:left;vertical-align:top;padding:.3rem .6rem;border-bottom:1px solid #ccc}
.agrees{color:#04663a}.departs,.fails{color:#a3121f}.refuses,.shown{color:#555}
@media(prefers-color-scheme:dark){body{background:#181818;color:#ddd}.agrees{color:#6fce9b}
.departs,.fails{color:#ff8c94}.refuses,.shown{color:#aaa}}"""


def page_of(reader, rows, others):
    """Return the page, which needs no other file."""
    heads = ["scene", "errors of its runs", "order", "verdict", *(f"error of {product}" for product in others)]
    body = "".join(f"<tr>{cells(row)}</tr>\n" for row in rows)
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>{escape(reader.name)}: conformance</title><style>{STYLE}</style></head><body>
<h1>Conformance of {escape(reader.name)}</h1>
<p>{escape(summary(rows))}</p>
<p>Each scene is one Model, from which every engine is built. An error is relative to the truth at the end of the scene.
No theory of this engine is known here, so only its convergence is judged: it agrees where its error vanishes with its
step, and departs where its runs converge to another motion. The others ran with the most steps of a row. Our own loop,
which is composed of what each Model needs, runs all these scenes, in the plane and in space; a full run shows it.</p>
<div class="wide"><table><thead><tr>{"".join(f"<th>{escape(head)}</th>" for head in heads)}</tr></thead><tbody>
{body}</tbody></table></div></body></html>
"""


def cells(row):
    """Return the cells of a row."""
    runs = "<br>".join(f"{n} steps: {number(error)}" for n, error in zip(row.steps, row.errors)) or "–"
    order = "–" if row.order is None else f"{row.order:.2f}"
    others = "".join(f'<td class="n">{number(one)}</td>' if isinstance(one, float) else f"<td>{escape(one)}</td>"
                     for one in row.others.values())
    look = row.verdict.name.lower()
    return (f'<td>{escape(row.title)}</td><td class="n">{runs}</td><td class="n">{order}</td>'
            f'<td><strong class="{look}">{escape(row.verdict)}</strong><br>{escape(row.words)}</td>{others}')
