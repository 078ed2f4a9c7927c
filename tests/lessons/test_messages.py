"""Messages of a check: few digits, the first entry that differs, and never the same text for expected and got."""

from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import pytest

from validate import notebook
from validate.grading import example, marking, points, sandbox
from validate.grading.expect import LONGEST, NotYet, between, close, instance, numbers, raises, tidy, truth
from validate.subject import modules, needs

pytestmark = pytest.mark.xdist_group("checks of a notebook")             # they share a process that forks the checks


def told(comparison, *arguments, **more):
    """The NotYet that a comparison raises."""
    with pytest.raises(NotYet) as error:
        comparison("quantity [m]", *arguments, **more)
    return error.value


@pytest.mark.parametrize(("expected", "got", "said"), [
    (1.23456789, 2.0, ("1.235", "2")),
    (1.23456789, 1.2349, ("1.2346", "1.2349")),
    (1.23456789, 1.23457, ("1.234568", "1.23457")),
    (1.00049, 1.00051, ("1.00049", "1.00051")),                          # in four digits they would be 0.001 apart
    (1.23456789, 1.23456789 + 1e-9, ("1.235", "1.235 + 1e-09")),
    (0.1, 0.1 - 1e-12, ("0.1", "0.1 - 1e-12")),
    (0.0, -3e-17, ("0", "-3e-17")),
    (5.0, 5.0000001, ("5", "5 + 1e-07")),
    (64741.2, 64741.9, ("64741.2", "64741.9")),
    (1000.0, 0.0, ("1000", "0")),
    (-2.5e9, 2.5e9, ("-2.5e+09", "2.5e+09")),
    (np.inf, 3.0, ("inf", "3")),
])
def test_two_numbers_have_four_digits_or_as_many_as_tell_them_apart(expected, got, said):
    error = told(close, got, expected, 0.0)
    assert (error.expected, error.got) == said


def test_random_numbers_never_look_alike_and_show_their_difference():
    rng = np.random.default_rng(4)
    for _ in range(5_000):
        a = rng.standard_normal() * 10.0 ** rng.integers(-12, 12)
        b = a * (1.0 + rng.standard_normal() * 10.0 ** rng.integers(-14, 3))
        if a != b:
            error = told(close, b, a, 0.0)
            assert error.expected != error.got
            left, right = float(error.expected), eval(error.got)
            assert right - left == pytest.approx(b - a, rel=1.01, abs=0.0) and (right > left) == (b > a), error


def test_a_few_entries_are_shown_whole_and_of_more_the_first_that_differs():
    error = told(close, np.array([1.0, 2.00004, 3.0]), np.array([1.0 + 1e-9, 2.0, 3.0]), 1e-6)
    assert (error.expected, error.got) == ("(1, 2, 3)", "(1, 2.00004, 3)")
    matrix = np.arange(9.0).reshape(3, 3)
    other = matrix.copy()
    other[1, 2], other[2, 0] = 5.25, -1.0
    error = told(close, other, matrix, 1e-6)
    assert (error.expected, error.got) == ("5 at [1, 2]", "5.25 at [1, 2]; 2 of 9 entries differ")
    assert error.error == "clearly off"                              # of the worst entry, as the grader reports it
    other[1, 2] = np.nan
    assert told(numbers, other, (3, 3)).got == "nan at [1, 2]"


def test_a_range_shows_which_end_was_missed():
    error = told(between, 0.5, 0.50001, 12.0)
    assert (error.expected, error.got) == ("0.50001 to 12", "0.5")
    error = told(between, 1.0 + 1e-12, 0.0, 1.0)
    assert (error.expected, error.got) == ("0 to 1", "1 + 1e-12")


@pytest.mark.parametrize(("got", "said"), [
    (None, "None: does every path through your function end with a return?"), ("left", "a str"), (3.0, "a number"),
    (np.zeros(2), "an array of shape (2,)"), ((1.0, (2.0, 3.0)), "a tuple"), ((1.0, np.inf, 2.0), "inf at [1]")])
def test_what_is_no_such_array_is_named(got, said):
    assert told(close, got, np.zeros(3), 1.0).got == said


@pytest.mark.parametrize(("got", "expected", "said"), [
    (False, True, ("True", "False")), (np.True_, False, ("False", "True")), (0, True, ("True", "False")),
    (np.zeros(2), False, ("False", "an array of shape (2,)")), (3.0, True, ("True", "a number")),
    (None, False, ("False", "None: does every path through your function end with a return?"))])
def test_true_and_false_are_written_as_words(got, expected, said):
    error = told(truth, got, expected, given="a body")
    assert (error.expected, error.got, error.given) == (*said, "a body")


def test_true_and_one_are_the_same_answer():
    for got in (True, np.True_, 1, 1.0):
        truth("quantity", got, True)


def test_another_kind_of_thing_is_named():
    error = told(instance, np.zeros(3), tuple)
    assert (error.expected, error.got) == ("a tuple", "an array of shape (3,)")


class Ball(NamedTuple):
    """A record, as in the lessons."""
    x: np.ndarray
    radius: float
    faces: np.ndarray = np.zeros((0, 3))


def test_inputs_are_written_as_people_write_them():
    x, pi, one = np.array([1.0, -2.3456789, 1e-9]), np.float64(3.14159265358979), 1.0
    assert tidy(f"x = {x}, π = {pi}, one = {one}") == "x = [1, -2.346, 1e-09], π = 3.142, one = 1"
    assert tidy(f"{Ball(x, pi)}") == "Ball(x = [1, -2.346, 1e-09], radius = 3.142, faces = [])"
    assert tidy(f"{(pi, np.int64(3), np.bool_(True))}, {[x[:1], x[:2]]}") == "(3.142, 3, True), [[1], [1, -2.346]]"
    assert tidy("speed [kg m²/s] at rest, exercise 1.2") == "speed [kg m²/s] at rest, exercise 1.2"
    assert tidy(f"{0.5 - 1e-11}, {1.000001 * 0.123456}, {0.1 + 0.2}, {1e300}") == "0.5 - 1e-11, 0.1235, 0.3, 1e+300"


def test_a_long_array_is_cut_and_no_text_is_longer_than_a_student_reads():
    many = np.random.default_rng(1).random((40, 3))
    text = tidy(f"corners {many.tolist()} m, m = {many[:, 0]} kg")
    assert text.count("…") == 2 and text.endswith(", …] kg") and "], …] m" in text and len(text) < LONGEST
    assert len(tidy(", ".join(f"{Ball(x, 1.0)}" for x in many))) <= LONGEST
    assert len(tidy("word " * 500)) <= LONGEST


def test_an_error_is_reported_without_the_words_of_numpy():
    def call():
        raise KeyError(f"{np.array([0.1, 0.25])} and {0.1 + 1e-3 / 3.0!r} and {(np.float64(0.25),)}")
    error = told(raises, ValueError, call)
    assert error.expected == "ValueError" and error.got == "KeyError: '[0.1, 0.25] and 0.1003333 and (0.25,)'"


def test_an_error_may_be_required_to_name_a_thing():
    def call():
        raise ValueError("the length is 2: give another")
    raises("length", ValueError, call, naming=[2.0], thing="the length")
    error = told(raises, ValueError, call, thing="the width")
    assert error.quantity.endswith("the thing that ValueError names")
    assert error.expected == "the width" and error.got == "the length is 2: give another"


def test_a_failure_in_one_line_is_complete():
    error = told(close, 1.0, 2.0, 0.0, given=f"x = {np.float64(0.123456)}")
    assert str(error) == "quantity [m] (x = 0.1235): expected 2, got 1, tolerance none: exactly this"


# ---------------------------------------------------------------------------------------------- what a student prints

BODY = "return x + dt * v, v + dt *"                                     # the first line of the answer to 1.1
ESCAPE = r"\x1b[31m"                                                     # as in a student's source text


def printing(lines):
    """Lesson 1 with these lines before the answer of its first exercise."""
    return example.worked("integrators").replace(BODY, f"{lines}\n    {BODY}", 1)


def checked(monkeypatch, tmp_path, text, exercise="1.1", **asked):
    """The result of a check of an exercise in the file of its lesson with that text, as text and as HTML."""
    (tmp_path / f"{needs.table()[exercise]['lesson']}.py").write_text(text)
    shown = []
    monkeypatch.setenv("WORKBOOK_LESSONS", str(tmp_path))
    monkeypatch.setattr("validate.notebook.display", shown.append)
    notebook.check(exercise, **asked)
    return repr(shown[0]), shown[0]._repr_html_()


def test_what_a_function_prints_is_shown_with_the_test_that_failed(monkeypatch, tmp_path):
    text, html = checked(monkeypatch, tmp_path, printing(f"print('dt is', dt, '{ESCAPE}')\n    return x, v"))
    assert "Exercise 1.1: not yet" in text and "    printed    dt is 0.0752" in text and "dt is 0.0752" in html
    assert ESCAPE in text and ESCAPE in html and "\x1b" not in text + html and "white-space:pre-wrap" in html


def test_output_of_a_right_function_is_not_shown(monkeypatch, tmp_path):
    text, _ = checked(monkeypatch, tmp_path, printing("print('here')"))
    assert "Exercise 1.1: passed" in text and "here" not in text


RATE, FORMULA = "return r / (1.0 + r)", "a heavier upper body makes the convergence slower"      # 9.6, a ★★ exercise


def test_a_check_does_not_print_the_formula_that_an_exercise_asks_to_find(monkeypatch, tmp_path):
    wrong = example.worked("contact").replace(RATE, "return 1.0 / (1.0 + r)", 1)
    text, html = checked(monkeypatch, tmp_path, wrong, "9.6")
    assert "quantity" in text and "expected" in text and FORMULA not in text and 'check("9.6", hint=True)' in text
    assert "<details><summary>show it</summary>" in html.partition(FORMULA)[0]
    text, html = checked(monkeypatch, tmp_path, wrong, "9.6", hint=True)
    assert FORMULA in text and "<details><summary>show it" not in html


def test_a_hint_on_pythons_error_is_never_folded(monkeypatch, tmp_path):
    wrong = example.worked("contact").replace(RATE, "return rr / (1.0 + r)", 1)
    text, html = checked(monkeypatch, tmp_path, wrong, "9.6")
    assert "a name is misspelt" in text and "<details><summary>show it" not in html


@pytest.mark.parametrize(("signature", "advice"), [
    ("another_name(acceleration, t, x, v, dt, p)", "name the function as in the file"),
    ("euler_step(acceleration, x, v, dt, p)", "give the function the arguments that it has in the file"),
    ("euler_step(acceleration, t, x, v, dt, p, more)", "give the function the arguments that it has in the file")])
def test_another_name_or_other_arguments_are_told(monkeypatch, tmp_path, signature, advice):
    whole = "euler_step(acceleration, t, x, v, dt, p)"
    worked = example.worked("integrators")
    assert worked.count(f"def {whole}") == 1
    text, _ = checked(monkeypatch, tmp_path, worked.replace(f"def {whole}", f"def {signature}"))
    assert advice in text


def test_a_students_own_error_gives_no_advice_to_the_student(monkeypatch, tmp_path):
    """The answer to 9.8 raises Diverged with the remedy that its docstring names: that is for its caller."""
    worked, law = example.worked("contact"), "0.0), -b[k]"
    assert worked.count(law) == 1
    wrong = worked.replace(law, "0.0), b[k]")
    text, html = checked(monkeypatch, tmp_path, wrong, "9.8")
    assert "Diverged: complementarity residual" in text and "use projected" not in text + html
    other = worked.replace("    check_scene(x, inv_mass, inv_inertia, contacts, load, mu)\n",
                           "    check_scene(x, inv_mass, inv_inertia, contacts, load, -mu)\n", 1)
    text, _ = checked(monkeypatch, tmp_path, other, "9.11")
    assert "BadInput" in text and ": give " in text                      # a given function's advice stays


@pytest.mark.parametrize("printed", ["'word ' * 100_000", "'\\n'.join(map(str, range(100_000)))"])
def test_long_output_is_cut_after_its_beginning(monkeypatch, tmp_path, printed):
    text, html = checked(monkeypatch, tmp_path, printing(f"print({printed})\n    return x, v"))
    assert len(text) < points.PRINTED + 1000 and len(text.splitlines()) < points.LINES + 10 and "…" in text
    assert len(html) < 3 * points.PRINTED


def test_output_with_secret_inputs_is_never_reported():
    """The answer is right for the public inputs, and wrong and talkative for all others."""
    sandbox.for_tests(pytest.skip, pytest.fail)
    worked, public = modules.bind("integrators"), set()

    def noting(acceleration, t, x, v, dt, p):
        public.add(float(dt))
        return worked.euler_step(acceleration, t, x, v, dt, p)
    points.grade("integrators", SimpleNamespace(**{**vars(worked), "euler_step": noting}))
    talk = printing(f"if dt not in {public!r}:\n        print('dt', dt)\n        return x, v")
    outcomes, printed, *_ = marking.mark_lesson("integrators", talk.encode(), "a secret")
    hidden = [o for kind, o in outcomes if kind == "hidden"]
    assert "not yet" in {o.status for o in hidden} and "dt 0." not in printed and all(o.printed == "" for o in hidden)
    for told in (marking.says(o, "hidden") for o in hidden):
        assert told.keys() <= {"quantity", "got", "tolerance"} and "dt 0." not in str(told)
