"""The grader itself: wrong answers lose an exercise's points, right ones keep them, stubs score 0 and solutions 100 %."""

import functools
import importlib
import re
import types

import pytest

from validate import binding

from .grading.expect import LONGEST, MOST_DIGITS
from .grading.points import grade, grade_each, score

LESSONS = binding.lesson_names()


def mutants_of(name):
    return importlib.import_module(f"tests.mutants.{name}").MUTANTS


def all_mutants():
    for name in LESSONS:
        for number, mutant in enumerate(mutants_of(name)):
            label = f"{name}-{mutant.exercise}-{'right' if mutant.right else 'wrong'}-{mutant.kind}-{mutant.story}".replace(" ", "_")
            yield pytest.param(name, number, id=label, marks=pytest.mark.xdist_group(f"mutants of {name}"))


@functools.cache
def grades_of(name):
    """Outcomes of each mutant of a lesson, all from one run of its tests."""
    module = vars(binding.bind(name))

    def subject(mutant):
        changed = types.SimpleNamespace(**{**module, mutant.name: mutant.function})
        return changed, lambda exercise, test: exercise == mutant.exercise
    return grade_each(name, {str(number): subject(mutant) for number, mutant in enumerate(mutants_of(name))})


@pytest.mark.parametrize("name, number", list(all_mutants()))
def test_an_answer_keeps_its_points_exactly_when_it_is_right(name, number):
    mutant = mutants_of(name)[number]
    earned, possible = score(grades_of(name)[str(number)])[mutant.exercise]
    assert (earned == possible) == mutant.right, f"{earned} of {possible} points"


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.xdist_group(f"mutants of {name}")) for name in LESSONS])
def test_what_a_student_reads_is_short_and_tells_expected_from_got(name):
    failed = [outcome for outcomes in grades_of(name).values() for outcome in outcomes if outcome.status == "not yet"]
    assert len(failed) > 30
    for o in failed:
        words = {"quantity": o.quantity, "given": o.given, "expected": o.expected, "got": o.got, "hint": o.hint}
        assert not [field for field, text in words.items() if len(text) > LONGEST], o
        ours = f"{o.given}|{o.expected}|{'' if o.quantity == 'the call itself' else o.got}"              # there Python speaks
        assert not re.search(r"np\.|array\(|dtype|[A-Za-z_]=\S|\n|  |\[ | [\],]", ours), o
        assert o.expected != o.got and o.got, o
        assert max(map(digits_of, re.findall(r"\d[\d.]*(?:e[-+]?\d+)?", f"{o.given} {o.expected} {o.got}")), default=0) <= MOST_DIGITS, o


def digits_of(number):
    """Significant digits of a number's text."""
    return len(number.partition("e")[0].replace(".", "").strip("0"))


@pytest.mark.parametrize("name", LESSONS)
def test_every_exercise_has_three_wrong_answers_and_a_right_one(name):
    from validate.generate import exercises
    numbers = set(exercises((binding.SOLUTIONS / f"{name}.py").read_text()))
    kept = mutants_of(name)
    for number in numbers:
        assert sum(m.exercise == number and not m.right for m in kept) >= 3, number
        assert sum(m.exercise == number and m.right for m in kept) >= 1, number


@pytest.mark.parametrize("name", LESSONS)
def test_solutions_score_everything_and_stubs_nothing(name):
    full, empty = (score(grade(name, binding.bind(name, of))) for of in ("solutions", "lessons"))
    assert sum(possible for _, possible in full.values()) == 20
    assert all(earned == possible for earned, possible in full.values())
    assert all(earned == 0 for earned, _ in empty.values())
    from validate.generate import exercises
    assert list(full) == list(empty) and set(full) == set(exercises((binding.SOLUTIONS / f"{name}.py").read_text()))
