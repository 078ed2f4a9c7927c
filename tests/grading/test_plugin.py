"""What pytest itself says about the tests of the workbook."""

import io
import re
import subprocess
import sys
import types

import numpy as np
import pytest

from validate.grading import plugin, points, wire
from validate.notebook.pytest_process import quiet
from validate.subject import generate, modules, needs
from validate.subject.generate import exercises

LEFT_OUT = re.compile(r"^(\d+) long tests were left out: pytest --long runs them, too$", re.MULTILINE)


FILES = "tests/grading/test_scale.py", "tests/lessons/test_integrators.py"


def collected(*options, files=FILES):
    """What pytest prints when it collects these files."""
    said = quiet(*(str(modules.ROOT / file) for file in files), f"--rootdir={modules.ROOT}", "--collect-only", *options)
    assert re.search(r"^\d+(/\d+)? tests collected", said, re.M), said
    return said


def test_the_summary_counts_the_long_tests_that_were_left_out():
    assert len(LEFT_OUT.findall(collected())) == 1


def test_workers_of_pytest_xdist_send_the_number_and_it_counts_once():
    worker, whole = types.SimpleNamespace(workeroutput={}), types.SimpleNamespace()
    plugin.count_left_out(worker, 7)
    for _ in range(2):
        plugin.pytest_testnodedown(types.SimpleNamespace(workeroutput=worker.workeroutput, config=whole))
    assert whole.long_tests_left_out == 7


@pytest.mark.long
def test_the_summary_counts_those_of_pytest_xdist_once():
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-n", "1", FILES[0]]
    run = subprocess.run(command, cwd=modules.ROOT, capture_output=True, text=True)
    assert run.returncode == 0 and len(LEFT_OUT.findall(run.stdout)) == 1, run.stdout + run.stderr


@pytest.mark.long
@pytest.mark.parametrize("options", [["--long"], ["--exercise=1.2"]], ids=" ".join)
def test_the_summary_has_no_such_line_with_long_or_with_an_exercise(options):
    assert not LEFT_OUT.search(collected(*options))


@pytest.mark.parametrize("exercise", ["euler_step", "sliding_step", "1.99", "1", ""])
def test_an_exercise_without_such_a_number_is_unknown(exercise):
    """The first name stands in quotes in a test file."""
    options = ["--of=solutions", f"--exercise={exercise}", "--collect-only"]
    run = subprocess.run([sys.executable, "-m", "pytest", *options], cwd=modules.ROOT, capture_output=True, text=True)
    assert run.returncode == pytest.ExitCode.USAGE_ERROR
    assert run.stderr.strip() == f"ERROR: exercise {exercise!r} is unknown: give its number, like --exercise=1.2"


@pytest.mark.long
def test_the_parts_of_the_long_tests_make_up_the_whole():
    """Each long test belongs to one part, and the others to all of them."""
    def tests(*options):
        said = collected(*options, files=("tests/lessons/test_messages.py", "tests/validate/test_cli.py"))
        return {line for line in said.splitlines() if "::" in line}
    whole, short = tests("--long"), tests()
    parts = [tests("--long", f"--part={k}/3") - short for k in (0, 1, 5)]
    assert len(short) < len(whole) and set().union(*parts) == whole - short
    assert sum(map(len, parts)) == len(whole - short)


# ---------------------------------------------------------------------------------------------- a loop without end

def endless(*arguments):
    while True:
        pass


@pytest.fixture
def short(monkeypatch):
    """Limits of a second and of a quarter of it, in place of those of the grader."""
    monkeypatch.setattr(plugin, "LIMIT", 1.0)
    monkeypatch.setattr(plugin, "AGAIN", 0.25)


def limits_of(exercises, **changes):
    """{exercise: the limits [s] of its tests that took too long, "passed" for others}, with these functions changed."""
    changed = types.SimpleNamespace(**{**vars(modules.bind("integrators")), **changes})
    outcomes = points.grade("integrators", changed, lambda exercise, test: exercise in exercises)
    assert {o.hint.partition("?")[0] for o in outcomes if o.quantity == points.DURATION} \
        <= {"does one of your loops never end"}
    return {number: [o.expected.removeprefix("an answer within ") or o.status for o in outcomes if o.exercise == number]
            for number in exercises}


def test_a_loop_without_end_is_waited_for_once(short):
    found = limits_of(["1.1", "1.2"], euler_step=endless)
    assert found == {"1.1": ["1 s", "0.25 s"], "1.2": ["passed", "passed"]}


def test_after_a_loop_without_end_a_test_that_ends_passes(short):
    euler_step, calls = modules.bind("integrators").euler_step, []

    def first_call_never_ends(*arguments):
        calls.append(arguments)
        return endless() if len(calls) == 1 else euler_step(*arguments)
    assert limits_of(["1.1"], euler_step=first_call_never_ends) == {"1.1": ["1 s", "passed"]}


@pytest.mark.long
def test_what_calls_a_loop_without_end_has_less_time_from_its_first_test_on(short):
    found = limits_of(["1.7", "1.8"], implicit_euler_step=endless, implicit_midpoint_step=endless)
    assert sorted(found["1.7"]) == ["0.25 s"] * 4 + ["1 s"]
    assert set(found["1.8"]) == {"0.25 s"}


# ---------------------------------------------------------------------------------------------- arrays that are kept

class OneArray:
    """An answer that returns the same arrays at each call: `lost` says whether a call wrote over a recent result."""

    def __init__(self, function):
        self.function, self.kept, self.calls, self.lost = function, {}, 0, False

    def __call__(self, *arguments):
        self.calls += 1
        return self.stored(self.function(*arguments), ())

    def stored(self, value, place):
        if isinstance(value, tuple) and type(value) is tuple:
            return tuple(self.stored(one, (*place, number)) for number, one in enumerate(value))
        if not isinstance(value, np.ndarray):
            return value
        array, call = self.kept.get((place, value.shape, value.dtype), (np.array(value), self.calls))
        self.lost |= self.calls - call <= wire.KEPT and array.tobytes() != value.tobytes()
        array[...] = value
        self.kept[place, value.shape, value.dtype] = array, self.calls
        return array


@pytest.mark.parametrize("taught", [pytest.param(name, marks=[] if name == "kinematics" else pytest.mark.long)
                                    for name in modules.lesson_names()])
def test_an_answer_that_writes_over_its_last_result_loses_points(taught):
    module = modules.bind(taught)
    names = exercises((modules.SOLUTIONS / f"{taught}.py").read_text(encoding="utf-8"))
    answers = {number: OneArray(getattr(module, name)) for number, name in names.items()}
    subjects = {number: (types.SimpleNamespace(**{**vars(module), names[number]: answer}),
                         lambda exercise, test, number=number: exercise == number)
                for number, answer in answers.items()}
    scores = {number: points.score(outcomes)[number] for number, outcomes in
              points.grade_each(taught, subjects).items()}
    assert sum(answer.lost for answer in answers.values()) >= 3
    for number, (earned, possible) in scores.items():
        assert (earned < possible) == answers[number].lost, number


def test_the_other_end_of_the_wire_sees_it_as_well():
    said, kept = [], np.zeros(2)

    def total(x):
        kept[:] += x
        return kept

    peer = wire.Peer(lambda frame: said.append(wire.unpack(*wire.read(io.BytesIO(frame)))), None,
                     {"total": total, "double": lambda x: 2.0 * x}.get, None, None,
                     lambda error: ([type(error).__name__], str(error), ""), None)
    for name in ("double", "total", "double", "total"):
        peer.serve(name, (np.ones(2),))
    assert [kind for kind, *_ in said] == ["value", "value", "value", "error"]
    assert "what it has returned before" in said[-1][2]


# ---------------------------------------------------------------------------------------------- what no answer can know

def test_a_graded_run_has_a_law_that_students_do_not_receive():
    """The public seed keeps the law of the handed-out file, on which the tables of mistakes rest."""
    def coupled_pendula():
        """Stand for the law of that name."""

    assert plugin.Draw(points.PUBLIC, "a test").law(coupled_pendula) is coupled_pendula
    assert plugin.Draw("a secret", "a test").law(coupled_pendula).__module__ == "validate.grading.unseen"


def test_imports_that_a_grader_need_not_have_are_named(tmp_path):
    """Both ways of importing count; Python's own modules, NumPy and the workbook do not."""
    lessons = tmp_path / "lessons"
    lessons.mkdir()
    (lessons / "springs.py").write_text("import math, numpy as np\nfrom solutions.checks import BadInput\n"
                                        "from . import other\nfrom scipy.linalg import solve\n"
                                        "def f():\n    import matplotlib.pyplot as plt\n")
    (lessons / "friction.py").write_text("import numpy.linalg\nfrom lessons.springs import f\n")
    (lessons / "rotation.py").write_text("from lessons.helpers import half\n")
    (lessons / "pbd.py").write_text("import (\n")
    config = types.SimpleNamespace(getoption=lambda name: str(lessons))
    assert plugin.imports_without_a_grader(config) == {"rotation.py": ["lessons.helpers"],
                                                          "springs.py": ["matplotlib", "scipy"]}
    config = types.SimpleNamespace(getoption=lambda name: "solutions")
    assert plugin.imports_without_a_grader(config) == {}


def test_what_is_not_written_yet_is_counted_and_not_shown_as_failures(tmp_path):
    """Lessons come in the order of the course, with their exercises where one is attempted."""
    text = generate.stub((modules.SOLUTIONS / "springs.py").read_text())
    stub = 'raise NotImplementedError("Exercise 2.2: air_force")'
    assert stub in text
    (tmp_path / "springs.py").write_text(text.replace(stub, "return 1.0"))
    (tmp_path / "simulator.py").write_text(generate.stub((modules.SOLUTIONS / "simulator.py").read_text()))
    files = [str(points.LESSONS / f"test_{name}.py") for name in ("springs", "simulator")]
    said = quiet(*files, f"--of={tmp_path}", f"--rootdir={modules.ROOT}",
                 *(f"--exercise={number}" for number in ("2.2", "2.3", "2.10", "10.1")))
    assert re.findall(r"^(\w+): 0 of", said, re.M) == ["springs", "simulator", "all"]
    assert re.findall(r"^ +([\d.]+)  0 of 1(  o)?$", said, re.M) == [("2.2", ""), ("2.3", "  o"), ("2.10", "  o")]
    assert "deselected" not in said and "next: " not in said
    assert re.findall(r"^_+ (test_\w+)", said, re.M) == [
        "test_air_pushes_resting_points_and_exerts_no_force_on_points_at_wind_speed"]
    assert re.search(r"^\d+ failed, .*\d+ not attempted in", said, re.M), said


def test_the_points_end_with_the_exercise_that_comes_next():
    outcomes = [points.Outcome(number, "a test", 1.0, "passed" if number == "2.1" else points.NOT_ATTEMPTED)
                for number in needs.of_lesson("springs")]
    said = plugin.lines_of_points(outcomes)
    assert said[0] == f"springs: 1 of {len(outcomes)}" and said[1:3] == ["   2.1  1 of 1", "   2.2  0 of 1  o"]
    assert said[-1] == "next: 2.2 air_force"
