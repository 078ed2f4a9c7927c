"""Tools of a notebook beside the lesson itself: the learner's code as saved just now, the check, pictures.

The learner's folder is `lessons/`, or the one that the environment variable WORKBOOK_LESSONS names.
"""

import ast
import json
import os
import re
import sys
import tempfile
import uuid
import warnings
from contextlib import nullcontext
from dataclasses import replace
from html import escape
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from IPython import get_ipython
from IPython.display import HTML, Markdown, display
from matplotlib.ticker import LogFormatterSciNotation

from solutions.checks import BadInput

from .. import measure
from ..check import Role
from ..engines.products import PRODUCTS, PYMUNK
from ..measure import film
from ..mistakes import failing_case
from ..reference import choices
from ..report import ARROWS, PLAYER_3D, plots, words
from ..scene import check_known
from ..subject import copies, modules, needs
from ..subject.loading import TooLong, alarm, lacks, waiting
from . import cases, figures, pytest_process, saving

TESTS = modules.ROOT / "tests" / "lessons"
OPENINGS, ARRAY = modules.ROOT / "notebooks" / "openings.json", "array"                # made by `release`
LIGHT = {"passed": "#00684a", "not-yet": "#b3261e", "not-attempted": "#7a5b00", "soft": "#5b666e"}     # on white
DARK = {"passed": "#4cc38a", "not-yet": "#ff8a80", "not-attempted": "#e0b050", "soft": "#a3adb4"}      # on black
COLOUR = {name.replace("-", " "): f"var(--workbook-{name}, {colour})" for name, colour in LIGHT.items()}
IN_THE_DARK = "{" + ";".join(f"--workbook-{name}:{colour}" for name, colour in DARK.items()) + "}"
# of JupyterLab's dark theme and of the book's; every output has it, because a page may hold any of them alone
STYLE = (f'<style>body[data-jp-theme-light="false"],body[data-theme="dark"]{IN_THE_DARK}'
         f'@media(prefers-color-scheme:dark){{body[data-theme="auto"]{IN_THE_DARK}}}</style>')
BROWSER = sys.platform == "emscripten"
PAGES = "WORKBOOK_PAGES"           # environment variable: where the executed notebooks are, for one in a browser
LONGEST = 120.0                    # of an attempt in a browser, which has no button that interrupts a kernel [s]
SIGN = {"passed": "✓", "not yet": "✗", "not attempted": "○"}

plots.style()
plt.rcParams.update({"figure.figsize": (7.2, 3.8), "legend.fontsize": 9})
# a figure that waits for an exercise may have nothing yet that its legend could name
warnings.filterwarnings("ignore", "No artists with labels found to put in legend", UserWarning)


def folder():
    """Return where the learner works."""
    return Path(os.environ.get("WORKBOOK_LESSONS", modules.ROOT / "lessons"))


# ---------------------------------------------------------------------------------------------- the learner's code

class Unreadable:
    """Stands in for a lesson that cannot be loaded: everything that is taken from it says why."""

    def __init__(self, why):
        self.why = why

    def __getattr__(self, name):
        return waiting(self.why)


latest: dict = {}                  # {lesson: what `mine` gave last}


def mine(lesson):
    """Return your lesson, as saved just now.

    A file that cannot be loaded is reported in one sentence, and nothing else breaks.
    """
    try:
        latest[lesson] = modules.bind(lesson, folder())
    except Exception as e:
        latest[lesson] = Unreadable(_say_unreadable(lesson, e))
    return latest[lesson]


def source_of(lesson, function):
    """Return the text of your function as saved just now, whether the file loads or not."""
    file = folder() / f"{lesson}.py"
    text = file.read_text(encoding="utf-8", errors="replace") if file.is_file() else ""
    found = re.search(rf"^def {function}\(.*?(?=^\S|\Z)", text, re.M | re.S)
    return found[0].rstrip() if found else lacks(file, function)


def _say_unreadable(lesson, e):
    """Say in one sentence why a lesson could not be loaded; the sentence."""
    why = str(e) if isinstance(e, BadInput) else f"lessons/{lesson}.py cannot be loaded: {type(e).__name__}: {e}"
    _say(why)
    return why


def _say(sentence):
    display(HTML(f'{STYLE}<p style="color:{COLOUR["not yet"]}"><b>{escape(sentence)}</b></p>'))


def _say_failed(why):
    display(HTML(f'{STYLE}<p style="color:{COLOUR["not yet"]}">✗ {escape(why)}.</p>'))


class StandIn:
    """In place of worked answers that are not in this copy: your lesson, as `mine` gave it last.

    Where it cannot be loaded, what is given in it.
    """

    def __init__(self, lesson, withheld):
        self.lesson, self.withheld = lesson, withheld

    def __getattr__(self, name):
        given = modules.bind(self.lesson)  # raises BadInput where the whole lesson is not in this copy
        own = latest[self.lesson]
        return getattr(given if isinstance(own, Unreadable) and name not in self.withheld else own, name)


def answers(lesson):
    """Return the worked answers of a lesson.

    In a copy of the workbook without them your own functions stand in, and a sentence says so.
    """
    if lesson not in modules.lesson_names():
        return StandIn(lesson, set())
    withheld = modules.withheld(lesson)
    if not withheld:
        return modules.bind(lesson)
    display(HTML(f"<p>Your own functions stand in for the worked answers of {escape(lesson)}, which are not in this "
                 "copy. What a figure calls truth is computed independently.</p>"))
    mine(lesson)
    return StandIn(lesson, withheld)


# in one cell: {what is not attempted yet: None}, and whether each attempt gave something
waiting_for: dict = {}
drawn: list[bool] = []


def attempt(function, *arguments):
    """Return what your function returns; None when it is not written yet or fails.

    A failure is reported at once.  What is not attempted yet is said once per cell or figure.
    """
    try:
        with np.errstate(all="ignore"), alarm(LONGEST) if BROWSER else nullcontext():
            result = function(*arguments)
        drawn.append(True)
        return result
    except TooLong as e:
        _say_failed(f"Your code is {e}: look for a loop that never ends")
    except NotImplementedError as e:
        waiting_for[str(e).removeprefix("Exercise ").replace(":", "")] = None
    except ArithmeticError as e:
        _say_failed(str(e))
    except Exception as e:
        _say_failed(f"{type(e).__name__}: {e}")
    drawn.append(False)
    return None


def show_figure():
    """Show the figure of this cell without its empty axes, and say what it still waits for.

    If every attempt since the last figure failed, there is nothing of yours to see, and the figure is not drawn.
    """
    empty = drawn and not any(drawn)
    _say_waiting()
    for number in plt.get_fignums():
        figure = plt.figure(number)
        for ax in figure.axes:
            if not ax.has_data() and not ax.patches and not ax.texts and not ax.images:
                ax.remove()
            for axis in (ax.xaxis, ax.yaxis):
                if type(axis.get_major_formatter()) is LogFormatterSciNotation:          # no choice of the cell's own
                    plots.tick(axis)
        if empty or not figure.axes:
            plt.close(figure)
    plt.show()


def _say_waiting(*_):
    """Say in one sentence what was not attempted yet, and forget it."""
    if waiting_for:
        display(HTML(f'{STYLE}<p style="color:{COLOUR["not attempted"]}">○ Not attempted yet: '
                     f'{escape(", ".join(waiting_for))}.</p>'))
    waiting_for.clear()
    drawn.clear()


if get_ipython():
    get_ipython().events.register("post_run_cell", _say_waiting)
    figures.install(get_ipython())


def show_choice(lesson, question):
    """Draw the four curves of a question, with the letters that its answer names them by.

    Where curves coincide, those below are seen: they are wider, and no two have their markers in one place.
    """
    found, dealt = choices.of(lesson, question)
    _, ax = plt.subplots()
    looks = zip(("#0072B2", "#D55E00", "#009E73", "#000000"), ("o", "s", "^", "d"), strict=True)
    apart = max(4, len(found.x) // 8)
    for k, ((letter, curve), (colour, marker)) in enumerate(zip(dealt.items(), looks, strict=True)):
        ax.plot(found.x, curve, color=colour, marker=marker, markevery=(k * apart // 4, apart), lw=3.8 - 0.8 * k,
                label=letter)
    ax.set(title=found.title, xlabel=found.xlabel, ylabel=found.ylabel, yscale="log" if found.log else "linear")
    ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    show_figure()


def fastest(lesson, trial):
    """Return (your lesson, whether it is compiled): compiled if trial(your compiled lesson) runs.

    If numba cannot compile one of your functions, a sentence says which, and all of the lesson runs plain.
    """
    if not modules.can_compile():
        return modules.bind(lesson, folder()), False
    from numba.core.errors import NumbaError
    fast = modules.bind(lesson, folder(), compiled=True)
    try:
        trial(fast)
    except NumbaError as e:
        _say(_why_not_compiled(folder() / f"{lesson}.py", str(e)))
        return modules.bind(lesson, folder()), False
    return fast, True


def has_pymunk(notebook):
    """Return whether pymunk is installed; where it is not, a browser above all, say where its results are.

    notebook   the one that asks, such as "09_contact": the book has it executed, with pymunk's results
    """
    if PYMUNK.installed():
        return True
    page, pages = "the page of this notebook in the book", os.environ.get(PAGES)
    link = f'<a href="{escape(pages)}{notebook}.html" target="_blank">{page}</a>' if pages else page
    display(HTML(f"<p>pymunk is not installed here. Its stored results are on {link}.</p>"))
    return False


UNKNOWN_TO_NUMBA = {         # {kind of expression: what people call it}
    ast.Lambda: "a lambda", ast.Dict: "a dict", ast.DictComp: "a dict", ast.Set: "a set", ast.SetComp: "a set",
    ast.GeneratorExp: "a generator", ast.FunctionDef: "a function in a function", ast.JoinedStr: "text",
    ast.Try: "try", ast.With: "with"}


def _why_not_compiled(file, said):
    """Return the sentence about a function that numba refuses: its name, and if known the line and its text."""
    place = rf'{re.escape(file.parent.name)}[\\/]{re.escape(file.name)}", line (\d+)'
    lines = [int(n) for n in re.findall(place, said)]
    text = file.read_text(encoding="utf-8", errors="replace")
    holds = [f for f in ast.parse(text).body for n in lines[-1:]
             if isinstance(f, ast.FunctionDef) and f.lineno <= n <= f.end_lineno]
    if not holds:
        return f"{file.name} cannot be compiled; it runs plain, which takes long."
    unknown = [part for part in ast.walk(holds[0]) if type(part) in UNKNOWN_TO_NUMBA and part is not holds[0]]
    unknown.sort(key=lambda part: (list(UNKNOWN_TO_NUMBA).index(type(part)), part.lineno))
    at_line = [part for part in unknown if part.lineno == lines[-1]]
    at = next(iter(at_line or unknown), None)
    where = f"line {at.lineno}: {UNKNOWN_TO_NUMBA[type(at)]}" if at else f"line {lines[-1]}"
    return (f"{holds[0].name} cannot be compiled ({where}); it runs plain, which takes long. "
            "Numba takes loops over numbers and arrays.")


def opening(notebook, make):
    """Return the result of `make` for a notebook's first picture.

    In a copy without worked answers it is the result that was stored when the copy was made.
    """
    made = stored(notebook)
    if made is None:
        return attempt(make)
    display(HTML("<p>This first picture was made beforehand, by the worked answers.</p>"))
    return made


def stored(notebook):
    """Return the stored result for a notebook's first picture; None in a copy that stores none."""
    made = json.loads(OPENINGS.read_text()) if OPENINGS.is_file() else {}
    return _unfrozen(made[notebook]) if notebook in made else None


def frozen(value):
    """Return what `make` gave, in types that JSON knows; to five decimals, more than a picture shows."""
    if isinstance(value, np.ndarray):
        return {ARRAY: frozen(value.tolist())}
    if isinstance(value, dict):
        return {key: frozen(one) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [frozen(one) for one in value]
    return round(float(value), 5) if isinstance(value, (float, np.floating)) else int(value)


def _unfrozen(value):
    if isinstance(value, dict):
        return np.array(value[ARRAY]) if ARRAY in value else {key: _unfrozen(one) for key, one in value.items()}
    return [_unfrozen(one) for one in value] if isinstance(value, list) else value


# ---------------------------------------------------------------------------------------------- the check

def check(exercise, hint=False):
    """Run the grader's tests of one exercise on your code as saved just now: not attempted, not yet, or passed.

    Text does not print the hint of a ★★ exercise, because it tells the formula, unless hint=True asks for it.
    """
    try:
        lesson, own = _lesson_of(exercise), modules.subject_folder(folder())
    except BadInput as e:
        _say(str(e))
        return
    with tempfile.TemporaryDirectory() as scratch:
        file, case = Path(scratch) / "outcomes.json", Path(scratch) / "case.json"
        try:
            said = pytest_process.run(str(TESTS / f"test_{lesson}.py"), f"--of={own}", f"--exercise={exercise}",
                             f"--outcomes={file}", f"--case={case}", f"--rootdir={modules.ROOT}", "--tb=line")
        except pytest_process.Ended:
            _say(f"The check of exercise {exercise} ended without an answer: lessons/{lesson}.py ends the program, "
                 "or asks for more memory than there is.")
            return
        outcomes = json.loads(file.read_text()) if file.is_file() else []
        picture = cases.drawn(failing_case.decoded(case.read_text())) if case.is_file() else None
    if not outcomes:
        raise RuntimeError(f"the check of exercise {exercise} did not run:\n{said}")
    display(_Answer(exercise, outcomes, _below(exercise, outcomes, own), picture, hint, copies.doubtful(own)))


def _below(exercise, outcomes, own):
    """Return the sentence about an exercise that this one calls, where that does not pass."""
    below = needs.needed(exercise, own)
    if not below or not any(o["status"] == "not yet" for o in outcomes):
        return ""
    states = needs.states((o["exercise"], o["status"]) for o in _outcomes_of(below, own))
    first = needs.first_open(exercise, states, own)
    return needs.sentence(exercise, first, states[first]) if first else ""


def _outcomes_of(exercises, own):
    """Return the outcomes of some exercises, as saved just now; none where the code ends the program."""
    files = dict.fromkeys(str(TESTS / f"test_{needs.table()[number]['lesson']}.py") for number in exercises)
    with tempfile.TemporaryDirectory() as scratch:
        file = Path(scratch) / "outcomes.json"
        try:
            pytest_process.run(*files, f"--of={own}", *(f"--exercise={number}" for number in exercises),
                               f"--outcomes={file}", f"--rootdir={modules.ROOT}", "--tb=line")
        except pytest_process.Ended:
            return []
        return json.loads(file.read_text()) if file.is_file() else []


def _lesson_of(exercise):
    for lesson in modules.lesson_names():  # its tests name it, whether the answers are in this copy or not
        tests = TESTS / f"test_{lesson}.py"
        if isinstance(exercise, str) and tests.is_file() and f'"{exercise}"' in tests.read_text():
            return lesson
    raise BadInput(f"exercise {exercise!r}", "unknown", 'give its number in quotes, like check("1.2")')


# ---------------------------------------------------------------------------------------------- how far

def progress(lesson):
    """Show your points in a lesson so far, and the next exercise whose called exercises all pass."""
    try:
        own = modules.subject_folder(folder())
        if not needs.of_lesson(lesson):
            raise BadInput(f"lesson {lesson!r}", "unknown", f"choose from: {', '.join(modules.lesson_names())}")
    except BadInput as e:
        _say(str(e))
        return
    outcomes = _outcomes_of(needs.of_lesson(lesson), own)
    if not outcomes:
        _say(f"The exercises of {lesson} ended without an answer: lessons/{lesson}.py ends the program, "
             "or asks for more memory than there is.")
        return
    display(_Progress(lesson, outcomes))


class _Progress:
    """The points of a lesson, for people, as text and as HTML."""

    def __init__(self, lesson, outcomes):
        self.lesson, self.states = lesson, needs.states((o["exercise"], o["status"]) for o in outcomes)
        self.earned = sum(o["points"] for o in outcomes if o["status"] == "passed")
        self.possible = sum(o["points"] for o in outcomes)

    def signs(self):
        """Return (exercise, its state) in the order of the lesson."""
        return [(number, self.states.get(number, "not attempted")) for number in needs.of_lesson(self.lesson)]

    def next(self):
        number = needs.next_of(self.lesson, self.states)
        return f"next: {number} {needs.table()[number]['function']}" if number else "all exercises pass"

    def title(self):
        return f"{self.lesson}: {self.earned:g} of {self.possible:g} points"

    def __repr__(self):
        return f"{self.title()}\n{' '.join(f'{SIGN[state]} {number}' for number, state in self.signs())}\n{self.next()}"

    def _repr_html_(self):
        marks = " &nbsp; ".join(f'<span style="color:{COLOUR[state]};white-space:nowrap" title="{escape(state)}">'
                                f'{SIGN[state]} {number}</span>' for number, state in self.signs())
        return f"{STYLE}<div><b>{escape(self.title())}</b><br>{marks}<br>{escape(self.next())}</div>"


def exercise_map():
    """Return a table of all exercises: the function of each, and the exercises that it calls."""
    display(_Map())


class _Map:
    """All exercises and what each calls, for people, as text and as HTML."""

    def rows(self):
        for number, one in needs.table().items():
            yield number, one["stars"], one["lesson"], one["function"], ", ".join(one["needs"])

    def __repr__(self):
        return "\n".join(f"{number:6} {stars:3} {lesson:16} {function:32} {calls}"
                         for number, stars, lesson, function, calls in self.rows())

    def _repr_html_(self):
        head = "".join(f'<th scope="col" style="text-align:left">{name}</th>'
                       for name in ("exercise", "kind", "lesson", "function", "calls"))
        body = "".join(f"<tr>{''.join(f'<td style=text-align:left>{escape(cell)}</td>' for cell in row)}</tr>"
                       for row in self.rows())
        return (f"<details><summary>All {len(needs.table())} exercises, and what each calls</summary>"
                f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></details>")


class _Answer:
    """The answer of a check, for people: the worst outcome first; all of it as text and as HTML."""

    def __init__(self, exercise, outcomes, below="", picture=None, unfolded=False, folder=""):
        self.exercise, self.outcomes, self.below, self.picture = exercise, outcomes, below, picture
        self.unfolded = unfolded                     # whether a hint that tells the formula was asked for
        self.folder = folder                         # which was tested, where one might doubt it
        self.open = [o for o in outcomes if o["status"] != "passed"]
        states = {o["status"] for o in outcomes}
        self.state = "not yet" if "not yet" in states else "not attempted" if "not attempted" in states else "passed"

    def first(self):
        """Return the outcome that is shown."""
        return next((o for o in self.open if o["status"] == "not yet"), None)

    def folds(self, name):
        """Return whether this line tells the formula that the exercise asks to find, and was not asked for."""
        return name == "hint" and self.first()["tells"] and not self.unfolded

    def lines(self):
        earned = sum(o["points"] for o in self.outcomes if o["status"] == "passed")
        possible = sum(o["points"] for o in self.outcomes)
        waits = self.open[0]["got"] if self.state == "not attempted" else ""
        for_another = waits and f"Exercise {self.exercise}:" not in waits
        says = "waits for another exercise" if for_another else self.state
        yield f"{SIGN[self.state]} Exercise {self.exercise}: {says}", f"{earned:g} of {possible:g} points"
        if waits:
            yield ("it waits for" if for_another else "still open"), waits
        elif self.open:
            if self.below:
                yield "first", self.below
            first = self.first()
            for name in ("quantity", "given", "expected", "got", "tolerance", "hint", "printed"):
                if first[name]:
                    yield name, first[name]
            if first["idea"]:
                yield "diagnosis", first["idea"]
        if self.folder:
            yield "tested", self.folder

    def __repr__(self):
        (title, points), *rest = self.lines()
        ask = f'it tells the formula: check("{self.exercise}", hint=True) shows it'
        indented = ((name, ask if self.folds(name) else value.replace("\n", f"\n{'':15}")) for name, value in rest)
        drawn = [f"    {'picture':10} {self.picture.alt}"] if self.picture else []
        return "\n".join([f"{title} ({points})", *(f"    {name:10} {value}" for name, value in indented), *drawn])

    def shown(self, name, value):
        """Return a line as HTML."""
        if self.folds(name):
            return f"<details><summary>show it</summary>{escape(value)}</details>"
        return escape(value)

    def _repr_html_(self):
        (title, points), *rest = self.lines()
        name_style = f"text-align:left;vertical-align:top;color:{COLOUR['soft']};padding:.1rem 1rem .1rem 0"
        rows = "".join(f'<tr><td style="{name_style}">{escape(n)}</td>'
                       f'<td style="text-align:left;white-space:pre-wrap">{self.shown(n, v)}</td></tr>'
                       for n, v in rest)
        return (f'{STYLE}<div style="border-left:4px solid {COLOUR[self.state]};padding:.3rem .8rem;margin:.3rem 0">'
                f'<b style="color:{COLOUR[self.state]}">{escape(title)}</b> ({points})'
                f'<table style="margin:0">{rows}</table>{self.picture.html() if self.picture else ""}</div>')


# ---------------------------------------------------------------------------------------------- pictures

def look(method, **changes):
    """Return how every figure draws a method of validate/methods.py: its arguments for `plot`, with changes."""
    return {"color": method.colour, "marker": method.marker, "label": method.label, **changes}


def play(frames, seconds, links=(), height=260, shown_as=None):
    """Show a film: frames = {label: list of (n, 2) arrays [m]}; "truth" is drawn in grey, the others in colour.

    shown_as = {label: Method of validate/methods.py}: these have the colour and the marker of their method.
    """
    _display(_plane(frames, seconds, links, shown_as or {}), height)


def save_film(frames, seconds, file, links=(), shown_as=None):
    """Write a film as a page (file ends with .html; any browser plays it) or as a picture that moves (.gif).

    frames, seconds, links and shown_as are those of `play`.  Raises BadInput for any other ending.
    """
    saving.save(_plane(frames, seconds, links, shown_as or {}), Path(file))
    display(HTML(f"<p>Written: {escape(str(file))}</p>"))


def _plane(frames, seconds, links, shown_as):
    """Return a film in the plane as data."""
    roles = [Role.TRUTH if label == "truth" else Role.OURS for label in frames]
    taken = {method.colour for label, method in shown_as.items() if label in frames}
    others = iter([colour for colour in film.COLOURS[Role.OURS] * 3 if colour not in taken])
    films = [{"label": label, "role": role.value, "colour": colour,
              "frames": [np.round(np.asarray(f, dtype=float), 5).tolist() for f in frames[label]]}
             for label, role, colour in zip(frames, roles, film.colours(roles))]
    for run in films:
        method = shown_as.get(run["label"])
        if method:
            run.update(colour=method.colour, marker=method.marker)
        elif run["role"] == Role.OURS.value:
            run["colour"] = next(others)
    return {"seconds": seconds, "links": [list(map(int, pair)) for pair in links], "films": films}


def _display(picture, height=260):
    """Show a film in the plane."""
    display(HTML(saving.film_html(picture, height)))


def show3d(bodies, runs, seconds, arrows=None, trail=None, ground=False, height=380):
    """Show a film in 3D that the mouse rotates: runs = {label: poses}.  The rest is as in validate/measure/film.py."""
    runs = {label: (Role.TRUTH if label == "truth" else Role.OURS, poses) for label, poses in runs.items()}
    _display3d(film.packed(bodies, runs, seconds, arrows, trail, ground), height)


def _display3d(picture, height=380):
    """Show a film in 3D."""
    name = f"s{uuid.uuid4().hex}"
    alone = picture["runs"] if len(picture["runs"]) == 1 else []     # the player's bar names several
    key = [f'<span style="color:{run["colour"]}">■</span> {escape(run["label"])}' for run in alone]
    key += [f'<span style="color:{colour}">→</span> {escape(arrow)}'
            for arrow, colour in zip(picture["arrows"], ARROWS)]
    place = f'<div data-space="{name}" style="width:100%;max-width:46rem;height:{height}px"></div>'
    display(HTML(saving.keeping_keys(f'{place}<div>{" &nbsp; ".join(key)}</div>')
                 + f'<script type="application/json" id="{name}">{json.dumps(picture)}</script>'
                 f'<script>{PLAYER_3D.read_text()}</script>'))


def scene_of(name):
    """Return a scene with your lesson functions in it; with the workbook's own, and a sentence,
    where yours cannot be loaded.
    """
    return _scene_and_owner(name)[0]


def _scene_and_owner(name):
    """Return (scene, whether it holds your functions)."""
    try:
        return modules.bind_scene(name, folder()), True
    except Exception as e:
        scene = modules.bind_scene(name)
        _say_unreadable(scene.lesson, e)
        return scene, False


def measured(name, most_steps=1000, without=None, **changes):
    """Compare your methods, plain, with the truth and the engines on one scene; return what the report is made of.

    without   names of steps that take too long here; then all others run.  By default a quick run's choice is taken.
    changes   replace fields of the Scene, such as steps=(50, 100, 200)
    Where your lesson cannot be loaded a sentence says so, and the engines run alone.
    """
    scene, own = _scene_and_owner(name)
    if without is not None:
        check_known(f"a step of scene {name!r}", without, [r.who.function for r in scene.our_runners])
        changes["runners"] = tuple(replace(r, in_quick=r.is_engine or r.who.function not in without)
                                   for r in scene.runners)
    plan = measure.Plan(of=str(folder()) if own else "solutions", speeds=("plain",) if own else (),
                        live=tuple(product for product in PRODUCTS if product.installed()), most_steps=most_steps,
                        changes=tuple(changes.items()))
    result = measure.errors(name, plan)
    return {**result, "times": measure.times(name, plan, result)}


def show_motion(result):
    """Show the scene's film: truth, your best method, an engine."""
    picture = result["picture"]
    if picture["space"]:
        _display3d(picture["space"])
    else:
        _display(picture)


def show_precision(result):
    """Show error against step, and error against run time: the two figures of the report, with your methods in them."""
    plots.show(plots.convergence, result)
    plots.show(plots.work_precision, result)


def show_findings(result):
    """Show what the numbers say."""
    display(Markdown("\n".join(f"- {sentence}" for sentence in [*words.findings(result), *words.recorded(result)])))
