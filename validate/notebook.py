"""What a notebook needs beside the lesson itself: the learner's code as saved just now, the check, pictures.

The learner's folder is `lessons/`, or the one that the environment variable WORKBOOK_LESSONS names.
"""

import json
import os
import re
import tempfile
import uuid
from html import escape
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from IPython.display import HTML, Markdown, display

from solutions.checks import BadInput

from . import aside, binding, measure
from .loading import lacks, waiting
from .report import plots, space, words

TESTS = binding.ROOT / "tests"
OPENINGS, ARRAY = binding.ROOT / "notebooks" / "openings.json", "array"                # made by `release`
COLOUR = {"passed": "#00684a", "not yet": "#b3261e", "not attempted": "#7a5b00"}
SIGN = {"passed": "✓", "not yet": "✗", "not attempted": "○"}

plots.style()
plt.rcParams["figure.figsize"] = (7.2, 3.8)


def folder():
    """Where the learner works."""
    return Path(os.environ.get("WORKBOOK_LESSONS", binding.ROOT / "lessons"))


# ---------------------------------------------------------------------------------------------- the learner's code

class Unreadable:
    """Stands in for a lesson that cannot be loaded: whatever is taken from it says why."""

    def __init__(self, why):
        self.why = why

    def __getattr__(self, name):
        return waiting(self.why)


latest = {}                  # {lesson: what `mine` gave last}


def mine(lesson):
    """Your lesson, as saved just now.  A file that cannot be loaded is reported in one sentence, and nothing else breaks."""
    try:
        latest[lesson] = binding.bind(lesson, folder())
    except Exception as e:
        latest[lesson] = Unreadable(_say_unreadable(lesson, e))
    return latest[lesson]


def source_of(lesson, function):
    """The text of your function as saved just now, whether the file loads or not."""
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
    display(HTML(f'<p style="color:{COLOUR["not yet"]}"><b>{escape(sentence)}</b></p>'))


class StandIn:
    """In place of worked answers that are not in this copy: your lesson, as `mine` gave it last.

    Where it cannot be loaded, what is given in it.
    """

    def __init__(self, lesson, withheld):
        self.lesson, self.withheld = lesson, withheld

    def __getattr__(self, name):
        given = binding.bind(self.lesson)                              # raises BadInput where the whole lesson is not in this copy
        own = latest[self.lesson]
        return getattr(given if isinstance(own, Unreadable) and name not in self.withheld else own, name)


def answers(lesson):
    """The worked answers of a lesson.  In a copy of the workbook without them your own functions stand in, and a sentence says so."""
    if lesson not in binding.lesson_names():
        return StandIn(lesson, set())
    withheld = binding.withheld(lesson)
    if not withheld:
        return binding.bind(lesson)
    display(HTML(f"<p>The worked answers of {escape(lesson)} are not in this copy of the workbook: your own functions stand in "
                 "for them. What a figure calls truth does not come from them.</p>"))
    mine(lesson)
    return StandIn(lesson, withheld)


def attempt(function, *arguments):
    """What your function returns; None, and a sentence, when it is not written yet or fails."""
    try:
        with np.errstate(all="ignore"):
            return function(*arguments)
    except NotImplementedError as e:
        display(HTML(f'<p style="color:{COLOUR["not attempted"]}">○ {escape(str(e))}: not attempted yet, so it is not drawn.</p>'))
    except ArithmeticError as e:
        display(HTML(f'<p style="color:{COLOUR["not yet"]}">✗ {escape(str(e))}.</p>'))
    except Exception as e:
        display(HTML(f'<p style="color:{COLOUR["not yet"]}">✗ {escape(type(e).__name__)}: {escape(str(e))}.</p>'))
    return None


def opening(notebook, make):
    """What `make` gives for a notebook's first picture; in a copy without worked answers what it gave when that copy was made."""
    made = json.loads(OPENINGS.read_text()) if OPENINGS.is_file() else {}
    if notebook not in made:
        return attempt(make)
    display(HTML("<p>This first picture was made beforehand, by the worked answers.</p>"))
    return _unfrozen(made[notebook])


def frozen(value):
    """What `make` gave, in types that JSON knows; to five decimals, more than a picture shows."""
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

def check(exercise):
    """Run the grader's tests of one exercise on your code as saved just now: not attempted, not yet, or passed."""
    try:
        lesson, own = _lesson_of(exercise), binding.subject_folder(folder())
    except BadInput as e:
        _say(str(e))
        return
    with tempfile.TemporaryDirectory() as scratch:
        file = Path(scratch) / "outcomes.json"
        try:
            said = aside.run(str(TESTS / f"test_{lesson}.py"), f"--of={own}", f"--exercise={exercise}",
                             f"--outcomes={file}", f"--rootdir={binding.ROOT}", "--tb=line")
        except aside.Ended:
            _say(f"The check of exercise {exercise} ended without an answer: lessons/{lesson}.py ends the program, "
                 "or asks for more memory than there is.")
            return
        outcomes = json.loads(file.read_text()) if file.is_file() else []
    if not outcomes:
        raise RuntimeError(f"the check of exercise {exercise} did not run:\n{said}")
    display(_Answer(exercise, outcomes))


def _lesson_of(exercise):
    for lesson in binding.lesson_names():                              # its tests name it, whether the answers are in this copy or not
        tests = TESTS / f"test_{lesson}.py"
        if isinstance(exercise, str) and tests.is_file() and f'"{exercise}"' in tests.read_text():
            return lesson
    raise BadInput(f"exercise {exercise!r}", "unknown", 'give its number in quotes, like check("1.2")')


class _Answer:
    """The answer of a check, for people: the worst outcome first; all of it as text and as HTML."""

    def __init__(self, exercise, outcomes):
        self.exercise, self.outcomes = exercise, outcomes
        self.open = [o for o in outcomes if o["status"] != "passed"]
        states = {o["status"] for o in outcomes}
        self.state = "not yet" if "not yet" in states else "not attempted" if "not attempted" in states else "passed"

    def lines(self):
        earned = sum(o["points"] for o in self.outcomes if o["status"] == "passed")
        yield f"{SIGN[self.state]} Exercise {self.exercise}: {self.state}", f"{earned:g} of {sum(o['points'] for o in self.outcomes):g} points"
        if self.state == "not attempted":
            waits = self.open[0]["got"]
            yield ("still open" if f"Exercise {self.exercise}:" in waits else "it waits for"), waits
        elif self.open:
            first = next(o for o in self.open if o["status"] == "not yet")
            for name in ("quantity", "given", "expected", "got", "tolerance", "hint", "printed"):
                if first[name]:
                    yield name, first[name]

    def __repr__(self):
        (title, points), *rest = self.lines()
        indented = ((name, value.replace("\n", f"\n{'':15}")) for name, value in rest)
        return "\n".join([f"{title} ({points})", *(f"    {name:10} {value}" for name, value in indented)])

    def _repr_html_(self):
        (title, points), *rest = self.lines()
        rows = "".join(f'<tr><td style="text-align:left;vertical-align:top;color:#5b666e;padding:.1rem 1rem .1rem 0">{escape(n)}</td>'
                       f'<td style="text-align:left;white-space:pre-wrap">{escape(v)}</td></tr>' for n, v in rest)
        return (f'<div style="border-left:4px solid {COLOUR[self.state]};padding:.3rem .8rem;margin:.3rem 0">'
                f'<b style="color:{COLOUR[self.state]}">{escape(title)}</b> ({points})<table style="margin:0">{rows}</table></div>')


# ---------------------------------------------------------------------------------------------- pictures

def play(frames, seconds, links=(), height=260):
    """A moving picture: frames = {label: list of (n, 2) arrays [m]}; "truth" is drawn in grey, the others in colour."""
    name = f"p{uuid.uuid4().hex}"
    picture = plots.playable({
        "seconds": seconds, "links": [list(map(int, pair)) for pair in links],
        "frames": {label: [np.round(np.asarray(f, dtype=float), 5).tolist() for f in fs] for label, fs in frames.items()}})
    key = " &nbsp; ".join(f'<span style="color:{c}">●</span> {escape(label)}' for c, label in zip(picture["colours"], frames))
    script = (Path(plots.__file__).parent / "player.js").read_text()
    display(HTML(f'<canvas data-picture="{name}" style="width:100%;max-width:46rem;height:{height}px;background:#f6f7f8"></canvas>'
                 f'<div>{key}</div><script type="application/json" id="{name}">{json.dumps(picture)}</script><script>{script}</script>'))


def show3d(bodies, runs, seconds, arrows=None, trail=None, ground=False, height=380):
    """A moving picture in space that turns under the mouse; what it takes is written in validate/report/space.py."""
    _display3d(space.picture(bodies, runs, seconds, arrows, trail, ground), height)


def _display3d(picture, height):
    name = f"s{uuid.uuid4().hex}"
    key = [f'<span style="color:{run["colour"]}">■</span> {escape(run["label"])}' for run in picture["runs"]]
    key += [f'<span style="color:{colour}">→</span> {escape(arrow)}' for arrow, colour in zip(picture["arrows"], space.ARROWS)]
    display(HTML(f'<div data-space="{name}" style="width:100%;max-width:46rem;height:{height}px"></div><div>{" &nbsp; ".join(key)}</div>'
                 f'<script type="application/json" id="{name}">{json.dumps(picture)}</script><script>{space.PLAYER.read_text()}</script>'))


def scene_of(name):
    """A scene with your lesson functions in it; with the workbook's own, and a sentence, where yours cannot be loaded."""
    try:
        return binding.bind_scene(name, folder())
    except Exception as e:
        scene = binding.bind_scene(name)
        _say_unreadable(scene.LESSON, e)
        return scene


def measured(name, most_steps=1000):
    """Hold your methods, plain, against truth and engines on one scene; returns what the report is made of.

    Where your lesson cannot be loaded a sentence says so, and the engines run alone.
    """
    own = scene_of(name) is not binding.bind_scene(name) or folder().resolve() == binding.SOLUTIONS
    plan = measure.Plan(of=str(folder()) if own else "solutions", speeds=("plain",) if own else (),
                        live=tuple(n for n in measure.engines.NAMES if measure.engines.installed(n)), most_steps=most_steps)
    result = measure.errors(name, plan)
    return {**result, "times": measure.times(name, plan, result)}


def show_motion(result):
    """The scene's moving picture: truth, your best method, an engine."""
    picture = result["picture"]
    if picture["space"]:
        _display3d(picture["space"], 380)
        return
    play(picture["frames"], picture["seconds"], picture["links"])


def show_precision(result):
    """Error against step, and error against run time: the two figures of the report, with your methods in them."""
    plots.show(plots.convergence, result)
    plots.show(plots.work_precision, result)


def show_findings(result):
    """What the numbers say."""
    display(Markdown("\n".join(f"- {sentence}" for sentence in words.findings(result))))
