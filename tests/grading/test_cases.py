"""A wrong answer of each pictured exercise makes a picture of the case in which it failed, a right one makes none."""

import io
import types

import numpy as np
import pytest

from validate.grading import points
from validate.mistakes import failing_case
from validate.notebook import _Answer, cases
from validate.notebook.cases import marks
from validate.notebook.pytest_process import quiet
from validate.subject import modules, needs
from validate.subject.modules import ROOT

from ..mutants.traces import mutants_of, traces_of

LESSONS = sorted({needs.table()[number]["lesson"] for number in cases.pictures()})
EACH = 4                     # the default run draws one of so many pictured exercises of a lesson; --long all [-]


@pytest.mark.parametrize(("name", "each"), [
    *((name, EACH) for name in LESSONS), *(pytest.param(name, 1, marks=pytest.mark.long) for name in LESSONS)])
def test_a_wrong_answer_is_drawn_and_a_right_one_is_not(name, each, monkeypatch):
    monkeypatch.setattr(cases, "DOTS_PER_INCH", 20)                  # no reader looks at them
    module, functions = modules.bind(name), {n: one["function"] for n, one in needs.table().items()}
    numbers = [n for n in cases.pictures() if needs.table()[n]["lesson"] == name][::each]
    first = {m.exercise: m for m in reversed(mutants_of(name)) if not m.right}
    answers = {("wrong", n): (n, first[n].function) for n in numbers}
    answers |= {("right", n): (n, getattr(module, functions[n])) for n in numbers[:3 if each == 1 else 1]}
    kept = points.FailingCases()
    traces_of(name, answers, cases=kept)
    assert {subject for subject, _ in kept.found} == {str(("wrong", n)) for n in numbers}
    for (_, number), text in kept.found.items():
        drawn = cases.drawn(failing_case.decoded(text))
        assert drawn and drawn.png.startswith(b"\x89PNG"), number
        assert number in drawn.alt and ("your answer: " in drawn.alt or "nothing that can be drawn" in drawn.words)
        assert drawn.words.startswith("What to see: ") and f'alt="The case in which the check of exercise {number}' in \
            drawn.html()


def check_of(tmp_path, *options):
    """The case that pytest writes for a wrong plane_distance; None where it writes none."""
    (tmp_path / "collisions.py").write_text("def plane_distance(p, plane):\n    return plane.n @ p - plane.d\n"
                                            "from solutions.collisions import Plane\n")
    file = tmp_path / "case.json"
    quiet(str(ROOT / "tests" / "lessons" / "test_collisions.py"), f"--of={tmp_path}", "--exercise=6.1",
          f"--case={file}", f"--rootdir={ROOT}", *options)
    return failing_case.decoded(file.read_text()) if file.is_file() else None


def test_a_case_is_written_for_public_inputs_only(tmp_path):
    assert check_of(tmp_path, "--seed=secret") is None
    case = check_of(tmp_path)
    p, plane = case.arguments
    assert case.exercise == "6.1" and case.result == plane.n @ p - plane.d
    assert case.expected == pytest.approx(plane.n @ p + plane.d, abs=1e-12)


def test_a_drawn_case_stands_below_the_message_of_a_check(tmp_path):
    drawn = cases.drawn(check_of(tmp_path))
    outcome = points.Outcome("6.1", "test_it", 1.0, "not yet", "signed distance [m]", "1", "2")._asdict()
    answer = _Answer("6.1", [outcome], picture=drawn)
    assert answer._repr_html_().index("signed distance") < answer._repr_html_().index("<img")
    assert drawn.alt in repr(answer)
    assert "<img" not in _Answer("6.1", [outcome])._repr_html_()


def test_what_a_test_expects_is_found_in_the_part_of_a_result_that_it_compared():
    n, p = np.array([1.0, 0.0]), np.array([3.0, 4.0])
    contact = modules.bind("collisions").Contact(p, p + 1.0, n, 0.5, 0.0)
    found = failing_case.expected_result(contact, n, -n)
    assert np.array_equal(found.n, -n) and found.p_a is None and found.gap is None
    assert failing_case.expected_result((0.5, n), 0.5, 0.25) == (0.25, None)
    corners = np.array([[0.0, 1.0], [2.0, 3.0], [4.0, 5.0]])
    assert np.array_equal(failing_case.expected_result(corners, np.roll(corners, 1, axis=0), -corners), -corners)
    for result, got in ((contact, 2.0 * n), (None, n), (p, None), ("no number", p), (p, p[:1])):
        assert failing_case.expected_result(result, got, n) is None


def test_a_case_survives_as_text_and_one_that_is_too_large_is_dropped():
    record = types.SimpleNamespace
    contact = modules.bind("collisions").Contact(np.zeros(2), np.ones(2), np.array([1.0, np.nan]), 0.5, 0.0)
    case = failing_case.Case("6.1", "test", [contact, (1.0, [2, True]), np.sum, "text"], np.float64(3.0), None)
    text = failing_case.encoded(case)
    back = failing_case.decoded(text)
    assert isinstance(back.arguments[0], record) and np.isnan(back.arguments[0].n[1])
    assert back.arguments[1:] == [[1.0, [2, True]], None, "text"] and (back.result, back.expected) == (3.0, None)
    huge = case._replace(arguments=[np.zeros(failing_case.MOST_NUMBERS + 1)])
    assert failing_case.encoded(huge) is None


def test_an_answer_that_is_very_far_away_is_drawn_towards_its_direction_only():
    """The renderer draws each dash of a line: one to a place 1e18 widths away would never end."""
    view = marks.View("", np.eye(2), np.zeros(2), ("x", "y"))
    given = [marks.Way(np.array([(0.0, 0.0), (1.0, 1.0)]), "given")]
    answer = [marks.Way(np.array([(0.5, 0.5), (3e18, 4e18)]), "way"), marks.Disc(np.zeros(2), 1e18, "disc"),
              marks.Arrow(np.zeros(2), np.array([1e18, 0.0]), "arrow")]
    figure, inside = marks.picture([view], given, answer, [])
    figure.savefig(io.BytesIO(), format="png", dpi=20)
    axes = figure.axes[0]
    ends = np.concatenate([line.get_xydata() for line in axes.lines])
    assert not inside and np.abs(ends).max() < 2.0 * marks.BEYOND * np.ptp(axes.get_xlim())
    assert np.allclose((ends - 0.5)[np.argmax(np.abs(ends[:, 1]))] / np.abs(ends).max(), (0.75, 1.0), rtol=1e-2)


@pytest.mark.parametrize("result", [None, "text", np.nan, np.zeros((2, 2)), [np.inf], 1e300])
def test_no_result_and_no_input_breaks_the_picture(result):
    plane = types.SimpleNamespace(n=np.array([0.0, 1.0]), d=0.0)
    drawn = cases.drawn(failing_case.Case("6.1", "test", [np.array([1.0, 2.0]), plane], result, None))
    assert drawn and "expected" not in drawn.alt
    for p in (np.array([np.nan, 1.0]), None, np.zeros(7)):
        assert cases.drawn(failing_case.Case("6.1", "test", [p, plane], result, None)) is None
    assert cases.drawn(failing_case.Case("1.1", "test", [1.0], 2.0, 3.0)) is None
