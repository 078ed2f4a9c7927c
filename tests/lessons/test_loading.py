"""A file that does not load, the commonest mistake of all: it is said where and why, and the other lessons work."""

import pickle
import re
import subprocess
import sys
import time
from html import unescape
from typing import NamedTuple

import nbformat
import pytest

from solutions import checks, simulator  # noqa: F401      simulator: for the errors of its given functions
from validate import notebook
from validate.grading import example, marking, sandbox
from validate.notebook.pytest_process import quiet
from validate.subject import loading, modules
from validate.subject.generate import stub
from validate.subject.modules import ROOT, SOLUTIONS, lesson_names

from .kernels import kernel, ran

pytestmark = pytest.mark.xdist_group("checks of a notebook")          # they share a process that checks are copied from
WORKED = example.worked("integrators")
FIRST, LAST = 1, WORKED.count("\n") + 1                  # of the file's own lines, and of those that are added
CALLS = stub((SOLUTIONS / "integrators.py").read_text()) + "euler_step(0, 0, 0, 0, 0, 0)\n"
LATIN = WORKED.replace("Lesson 1", "Le\xe7on 1")
BODY = "return x + dt * v, v + dt *"                     # how the answer of 1.1 begins


class Broken(NamedTuple):
    """A file that cannot be loaded."""
    text: str | bytes
    line: object             # where, as the message must say it: a number or words
    reason: str              # a part of what Python says
    remedy: str              # a part of what to do


def added(lines, line, reason, remedy="that line"):
    """The worked lesson with more lines at its end; line counts from the first of them."""
    return Broken(WORKED + lines, LAST + line if isinstance(line, int) else line, reason, remedy)


OOPS = "class Oops(Exception):\n    pass\n\n\nraise Oops('no luck')\n"
NO_WORDS = "class Oops(Exception):\n    def __str__(self):\n        return 1 / 0\n\n\nraise Oops()\n"
KINDS = {
    "syntax": added("def more(:\n", 0, "SyntaxError", "correct that line"),
    "a bracket that stays open": added("x = (1.0,\n", 0, "never closed", "correct that line"),
    "tabs among spaces": added("if True:\n        x = 1\n\ty = 2\n", 2, "inconsistent use of tabs", "spaces"),
    "indentation": added("def more():\nreturn 1\n", 1, "IndentationError", "indent"),
    "a missing module": added("import numpi\n", 0, "numpi", "import"),
    "a missing name": added("from numpy import nothing_like_that\n", 0, "nothing_like_that", "import"),
    "a misspelt name": added("x = euler_stepp\n", 0, "euler_stepp"),
    "division by zero": added("x = 1 / 0\n", 0, "ZeroDivisionError"),
    "an error in a call": added("def f(x):\n    return 1 / x\n\n\nf(0)\n", 4, "ZeroDivisionError"),
    "no end": added("def f():\n    return f()\n\n\nf()\n", 4, "RecursionError"),
    "an error of its own": added(OOPS, 4, "Oops: no luck"),
    "one beside Exception": added(OOPS.replace("(E", "(BaseE"), 4, "Oops: no luck"),
    "an error without words": added(NO_WORDS, 5, "Oops"),
    "the end of the program": added("raise SystemExit('done')\n", 0, "SystemExit: done", "ends the program"),
    "a NUL byte": added("x = 1\n\0\n", 1, "null byte", "UTF-8"),
    "UTF-16": Broken(WORKED.encode("utf-16"), FIRST, "SyntaxError", "UTF-8"),
    "another encoding": Broken(LATIN.encode("latin-1", "replace"), FIRST, "codec can't decode", "UTF-8"),
    "an unknown encoding": Broken(f"# -*- coding: nonsense\n{WORKED}", "integrators.py", "unknown encoding", "UTF-8"),
    "an exercise that waits": Broken(CALLS, CALLS.count("\n"), "Exercise 1.1", "that line"),
}
LOADS = {
    "a stray backslash": WORKED + 'x = "\\d"\n',
    "a warning": WORKED + "import warnings\n\nwarnings.warn('careful')\n",
    "a warning in a call": WORKED.replace(BODY, f"np.sqrt(-np.ones(1))\n    {BODY}", 1),
    "a byte-order mark": WORKED.encode("utf-8-sig"),
}
SYNTAX = "def (:\n"
# What the default tests hand to a check and to the grader; a notebook, which loads a file in the same way, gets all.
CHECKED = {"syntax", "an error in a call", "no end", "one beside Exception", "the end of the program", "a NUL byte",
           "another encoding", "an exercise that waits"}


def kinds(some=KINDS):
    """For each of these kinds; those outside CHECKED are long."""
    return pytest.mark.parametrize("kind", [pytest.param(kind, marks=[] if kind in CHECKED else [pytest.mark.long])
                                            for kind in some])


def handed_out(folder, **files):
    """A folder of all lessons as handed out, but for these files."""
    folder.mkdir(exist_ok=True)
    for name in lesson_names():
        (folder / f"{name}.py").write_text((ROOT / "lessons" / f"{name}.py").read_text(), encoding="utf-8")
    for name, text in files.items():
        (folder / f"{name}.py").write_bytes(text if isinstance(text, bytes) else text.encode())
    return folder


def place(broken):
    return f"line {broken.line}" if isinstance(broken.line, int) else broken.line


@pytest.fixture
def told(tmp_path, monkeypatch):
    """told(call, **files) → what a notebook shows when that is called where these are the files."""
    def tell(call, **files):
        shown = []
        monkeypatch.setenv("WORKBOOK_LESSONS", str(handed_out(tmp_path / "lessons", **files)))
        monkeypatch.setattr("validate.notebook.display", shown.append)
        call()
        return "\n".join(getattr(thing, "data", None) or repr(thing) for thing in shown)
    return tell


# ---------------------------------------------------------------------------------------------- in a notebook

@kinds()
def test_a_check_names_the_place_the_reason_and_the_remedy(told, kind):
    broken = KINDS[kind]
    said = told(lambda: notebook.check("1.1"), integrators=broken.text)
    assert "Exercise 1.1: not yet (0 of 1 points)" in said and len(said.splitlines()) <= 4, said
    assert all(words in said for words in (place(broken), broken.reason, broken.remedy, "integrators.py")), said
    assert "_plain_" not in said and str(ROOT) not in said, said


@pytest.mark.parametrize("kind", LOADS)
def test_what_python_only_warns_of_costs_nothing(told, kind):
    assert "Exercise 1.1: passed" in told(lambda: notebook.check("1.1"), integrators=LOADS[kind])


@pytest.mark.parametrize("kind", KINDS)
def test_a_notebook_says_it_once_and_goes_on(told, kind):
    broken = KINDS[kind]
    def call():
        notebook.attempt(notebook.mine("integrators").euler_step, 1.0)
        notebook.show_figure()
    first, second = told(call, integrators=broken.text).splitlines()
    expected = ("lessons/integrators.py cannot be loaded", place(broken), broken.reason, broken.remedy)
    assert all(words.lower() in unescape(first).lower() for words in expected), first
    assert "Not attempted yet" in second


def test_every_other_lesson_is_checked_as_if_nothing_were_wrong(told):
    files = {"integrators": SYNTAX, "springs": example.worked("springs")}
    said = told(lambda: [notebook.check(number) for number in ("2.1", "7.1")], **files)
    assert "Exercise 2.1: passed" in said and "Exercise 7.1: not attempted" in said


RENAMED = WORKED.replace("def euler_step(", "def eulerstep(")


@pytest.mark.parametrize(("text", "others_pass"), [("", False), (RENAMED, True)], ids=["empty", "renamed"])
def test_a_function_that_is_gone_is_named_and_the_others_are_tested(told, text, others_pass):
    def call():
        notebook.check("1.1")
        notebook.attempt(notebook.mine("integrators").euler_step)
        notebook.show_figure()
    said = told(call, integrators=text)
    assert "Exercise 1.1: not yet" in said and "lessons/integrators.py has no euler_step" in said, said
    assert "_plain_" not in said and ("passed" in told(lambda: notebook.check("1.2"), integrators=text)) == others_pass


def test_a_file_that_is_gone_is_named(told, tmp_path):
    def call():
        (tmp_path / "lessons" / "integrators.py").unlink()
        notebook.check("1.1")
        notebook.mine("integrators")
    said = told(call)
    assert "has no euler_step" in notebook.source_of("integrators", "euler_step")
    assert said.count("there is no such file") == 2 and "Exercise 1.1: not yet" in said
    assert "lessons/integrators.py cannot be loaded" in said


def test_bad_input_of_a_check_ends_in_one_sentence(told, monkeypatch):
    def call():
        notebook.check("1.99")
        notebook.check(1.10)                                         # without quotes this is 1.1
        monkeypatch.setenv("WORKBOOK_LESSONS", "no/such/folder")
        notebook.check("1.1")
        notebook.mine("integrators")
    said = told(call).splitlines()
    expected = ("1.99", "in quotes", "no/such/folder", "no/such/folder")
    assert len(said) == 4 and all(words in sentence for words, sentence in zip(expected, said, strict=True)), said


def test_an_error_without_words_in_a_call_is_named(told):
    text = WORKED.replace(BODY, f"raise Oops()\n    {BODY}", 1) + NO_WORDS.replace("raise Oops()", "")
    said = told(lambda: notebook.check("1.1"), integrators=text)
    assert "Exercise 1.1: not yet" in said and "Oops:  (integrators.py, line" in said, said


def test_a_file_that_ends_the_process_is_named(told):
    said = told(lambda: notebook.check("1.1"), integrators=WORKED + "import os\n\nos._exit(0)\n")
    assert "lessons/integrators.py ends the program" in said and len(said.splitlines()) == 1


@pytest.mark.parametrize(("name", "text"), [("springs", SYNTAX), ("integrators", SYNTAX), ("integrators", "")])
def test_the_engines_run_alone_where_a_lesson_that_the_scene_needs_does_not_load(told, name, text, monkeypatch):
    monkeypatch.setattr("validate.measure.selection.NOTEBOOK", 0.002)            # no reader sees these times
    measured = []
    said = told(lambda: measured.append(notebook.measured("hanging_springs", 50)), **{name: text})
    case = next(iter(measured[0]["cases"].values()))
    assert f"lessons/{name}.py cannot be loaded" in said and case["ours"] == [] and case["engines"]
    assert text or "it has no advance" in said


def test_without_worked_answers_what_is_given_stands_in_for_a_file_that_does_not_load(told, monkeypatch):
    monkeypatch.setattr("validate.subject.modules.withheld", lambda lesson: {"euler_step"})
    worked = []
    said = told(lambda: worked.append(notebook.answers("integrators")), integrators=SYNTAX)
    assert "lessons/integrators.py cannot be loaded" in said and worked[0].Oscillator(2.0, 0.0).omega == 2.0
    with pytest.raises(NotImplementedError, match="cannot be loaded"):
        worked[0].euler_step(1.0)


@pytest.mark.long
def test_an_executed_notebook_reaches_its_end(tmp_path):
    """Where its lesson does not load a notebook says so, and runs on."""
    handed_out(tmp_path, integrators=SYNTAX)
    with kernel(ROOT / "notebooks") as client:
        haste = "from validate.measure import selection\nselection.NOTEBOOK = 0.002"
        ran(client, f"%env WORKBOOK_LESSONS={tmp_path}\n{haste}")
        for path in sorted((ROOT / "notebooks").glob("0[01]*.ipynb")):
            for cell in nbformat.read(path, as_version=4).cells:
                if cell.cell_type == "code":
                    said = ran(client, cell.source)
                    if cell.source.startswith("check("):
                        assert "not yet" in said and "reading the file" in said and "line 1" in said, said
                    elif 'mine("integrators")' in cell.source or "measured(" in cell.source:
                        assert "integrators.py cannot be loaded" in said and "line 1" in said, said
                    elif "source_of(" in cell.source:
                        assert "has no euler_step" in said


# ---------------------------------------------------------------------------------------------- in a terminal

@pytest.mark.long
@pytest.mark.parametrize("kind", ["syntax", "one beside Exception"])
def test_pytest_says_it_once_and_counts_the_other_lessons(tmp_path, kind):
    broken = KINDS[kind]
    handed_out(tmp_path, integrators=broken.text, springs=example.worked("springs"))
    files = [f"tests/lessons/test_{name}.py" for name in ("integrators", "springs")]
    said = quiet(f"--of={tmp_path}", *(str(ROOT / file) for file in files), f"--rootdir={ROOT}")
    assert said.count("integrators.py cannot be loaded") == 1, said
    assert "INTERNALERROR" not in said and "Traceback" not in said
    assert all(words.lower() in said.lower() for words in (place(broken), broken.reason, broken.remedy))
    assert re.search(r"^all: 20 of 40", said, re.M) and len(said.splitlines()) < 45, said


@pytest.mark.parametrize("kind", ["one beside Exception", pytest.param("another encoding", marks=pytest.mark.long)])
def test_validate_ends_in_one_sentence(tmp_path, kind):
    handed_out(tmp_path / "lessons", integrators=KINDS[kind].text)
    options = ["--scene", "oscillator", "--quick", f"--of={tmp_path / 'lessons'}", f"--out={tmp_path / 'report'}"]
    run = subprocess.run([sys.executable, "-m", "validate", *options], cwd=ROOT, capture_output=True, text=True)
    assert run.returncode == 2 and "lessons/integrators.py cannot be loaded" in run.stderr
    assert KINDS[kind].reason in run.stderr
    assert len(run.stderr.strip().splitlines()) == 1


@kinds([kind for kind in KINDS if kind != "an error without words"])       # it ends the worker
def test_the_grader_says_the_same_and_gives_no_points(kind):
    sandbox.for_tests(pytest.skip, pytest.fail)
    broken = KINDS[kind]
    text = broken.text if isinstance(broken.text, bytes) else broken.text.encode()
    outcomes = [outcome for _, outcome in marking.mark_lesson("integrators", text, "a secret")[0]]
    assert len(outcomes) == len(marking.manifest(["integrators"])) and {o.status for o in outcomes} == {"not yet"}
    assert len({(o.got, o.hint) for o in outcomes}) == 1
    assert broken.reason in outcomes[0].got and broken.remedy in outcomes[0].hint, outcomes[0]


# ---------------------------------------------------------------------------------------------- how it is loaded

def test_a_lesson_loads_though_one_that_it_builds_on_does_not(tmp_path):
    """As in the students' zip, where a lesson imports its siblings."""
    (tmp_path / "integrators.py").write_text(SYNTAX)
    text = "from .integrators import Oscillator, advance, my_own\n\ntwice = lambda x: 2.0 * x\n"
    (tmp_path / "springs.py").write_text(text)
    lesson = modules.bind("springs", tmp_path)
    assert lesson.twice(2.0) == 4.0 and lesson.Oscillator(3.0, 0.0).omega == 3.0
    assert lesson.advance is modules.bind("integrators").advance
    with pytest.raises(NotImplementedError, match=r"integrators.py cannot be loaded: SyntaxError.*line 1"):
        lesson.my_own(1.0)
    for _ in range(2):
        with pytest.raises(loading.Unloadable, match=r"integrators\.py cannot be loaded"):
            modules.bind("integrators", tmp_path)


def test_lessons_that_import_each_other_do_not_wait_for_each_other(tmp_path):
    (tmp_path / "integrators.py").write_text("from .springs import b\na = 1\n")
    (tmp_path / "springs.py").write_text("from .integrators import a\nb = 1\n")
    assert modules.bind("integrators", tmp_path).a == 1
    with pytest.raises(loading.Unloadable, match=r"cannot be loaded: ImportError.*line 1"):
        modules.bind("springs", tmp_path)


needs_alarm = pytest.mark.skipif(not hasattr(loading.signal, "setitimer"), reason="no alarm clock: no loop is stopped")
BEGUN = "import signal\nsignal.setitimer(signal.ITIMER_REAL, 0.05)\n"      # the alarm rings once the loop has begun
PLAIN_LOOP = "while True:\n    pass\n"
STUBBORN_LOOP = "while True:\n    try:\n        x = 1\n    except Exception:\n        pass\n"


@needs_alarm
@pytest.mark.parametrize("loop", [PLAIN_LOOP, STUBBORN_LOOP], ids=["plain", "stubborn"])
def test_a_file_whose_loop_never_ends_is_given_up(tmp_path, monkeypatch, loop):
    monkeypatch.setattr(modules, "LOAD_WITHIN", 3600.0)
    (tmp_path / "integrators.py").write_text(BEGUN + loop)
    with pytest.raises(loading.Unloadable, match=r"still running after 3600 s \(integrators.py, line [2-7]\)\."):
        modules.bind("integrators", tmp_path)


@needs_alarm
def test_an_alarm_inside_another_leaves_that_one_running():
    left = loading.signal.getitimer, loading.signal.ITIMER_REAL
    with pytest.raises(loading.TooLong, match="3600 s"), loading.alarm(3600.0):  # noqa: PT012    two sleeps
        with pytest.raises(loading.TooLong, match=r"0\.1 s"), loading.alarm(0.1):
            time.sleep(60.0)
        assert 0.0 < left[0](left[1])[0] < 3600.0
        loading.signal.setitimer(left[1], 0.1)                       # nothing waits for an hour
        time.sleep(60.0)


def kinds(error):
    """All kinds of an error that the given code and the workbook have."""
    return {error}.union(*map(kinds, error.__subclasses__()))


@pytest.mark.parametrize("kind", sorted(kinds(checks.BadInput) | kinds(checks.Diverged), key=str))
def test_another_process_may_raise_an_error_of_any_kind(kind):
    error = kind.__new__(kind, "speed [m/s] = inf: take shorter steps")
    error.remedy = "take shorter steps"
    back = pickle.loads(pickle.dumps(error))
    assert (type(back), str(back), back.__dict__) == (kind, str(error), {"remedy": "take shorter steps"})
