"""The grader itself: wrong answers lose an exercise's points, right ones keep them, stubs score 0 and solutions 100 %."""

import importlib
import types

import pytest

from validate import binding

from .grading.points import grade, score

LESSONS = binding.lesson_names()


def mutants():
    for name in LESSONS:
        for mutant in importlib.import_module(f"tests.mutants.{name}").MUTANTS:
            yield pytest.param(name, mutant, id=f"{mutant.exercise}-{'right' if mutant.right else 'wrong'}-{mutant.story.replace(' ', '_')}")


@pytest.mark.parametrize("lesson_name, mutant", list(mutants()))
def test_an_answer_keeps_its_points_exactly_when_it_is_right(lesson_name, mutant):
    module = binding.bind(lesson_name)
    subject = types.SimpleNamespace(**{**vars(module), mutant.function.__name__: mutant.function})
    earned, possible = score(grade(lesson_name, subject, mutant.exercise))[mutant.exercise]
    assert (earned == possible) == mutant.right, f"{earned} of {possible} points"


@pytest.mark.parametrize("name", LESSONS)
def test_every_exercise_has_three_wrong_answers_and_a_right_one(name):
    from validate.generate import exercises
    numbers = set(exercises((binding.SOLUTIONS / f"{name}.py").read_text()))
    kept = importlib.import_module(f"tests.mutants.{name}").MUTANTS
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
