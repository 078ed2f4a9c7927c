"""The grader itself: wrong answers lose an exercise's points, right ones keep them,
stubs score 0 and solutions 100 %.
"""

import functools
import importlib
import re
import types

import pytest

from validate.grading.expect import LONGEST, MOST_DIGITS
from validate.grading.points import grade, grade_each, score
from validate.subject import modules
from validate.subject.generate import exercises

from ..mutants import collection, variants

LESSONS = modules.lesson_names()
SEEDS = [f"of an examiner, {number}" for number in range(5)]


def mutants_of(name):
    return importlib.import_module(f"tests.mutants.{name}").MUTANTS


def sample(name):
    """Numbers of the answers that the default run grades: the first right and the first wrong one of each exercise.

    `pytest --long` grades all.
    """
    first = {}
    for number, mutant in enumerate(mutants_of(name)):
        first.setdefault((mutant.exercise, mutant.right), number)
    return sorted(first.values())


def all_mutants():
    for name in LESSONS:
        short = set(sample(name))
        for number, mutant in enumerate(mutants_of(name)):
            kind = "right" if mutant.right else "wrong"
            label = f"{name}-{mutant.exercise}-{kind}-{mutant.kind}-{mutant.story}".replace(" ", "_")
            marks = [pytest.mark.xdist_group(f"mutants of {name}"), *([] if number in short else [pytest.mark.long])]
            yield pytest.param(name, number, id=label, marks=marks)


@pytest.fixture
def grades_of(request):
    """The function that grades the answers of a lesson: all of them with --long, else a sample."""
    every = request.config.getoption("--long")
    return lambda name: graded(name, every)


@functools.cache
def graded(name, every):
    """Outcomes of each mutant of a lesson, all from one run of its tests."""
    chosen = range(len(mutants_of(name))) if every else sample(name)
    return grade_each(name, {str(number): subject(name, mutants_of(name)[number]) for number in chosen})


def subject(name, mutant):
    """What `grade_each` takes: the lesson with this answer in it, and which of its tests are wanted."""
    changed = types.SimpleNamespace(**{**vars(modules.bind(name)), mutant.name: mutant.function})
    return changed, lambda exercise, test: exercise == mutant.exercise


@pytest.mark.parametrize(("name", "number"), list(all_mutants()))
def test_an_answer_keeps_its_points_exactly_when_it_is_right(name, number, grades_of):
    mutant = mutants_of(name)[number]
    earned, possible = score(grades_of(name)[str(number)])[mutant.exercise]
    assert (earned == possible) == mutant.right, f"{earned} of {possible} points"


@pytest.mark.long
@pytest.mark.parametrize("name", LESSONS)
def test_right_answers_keep_their_points_with_other_inputs(name):
    """A tolerance that a right answer misses by chance is a fault of the test: an examiner's inputs are drawn, too."""
    right = {f"{mutant.exercise}: {mutant.story}": subject(name, mutant)
             for mutant in mutants_of(name) if mutant.right}
    right["the worked answers"] = modules.bind(name), lambda exercise, test: True
    lost = [(seed, story, o.test, o.quantity, o.got) for seed in SEEDS
            for story, outcomes in grade_each(name, right, seed=seed).items()
            for o in outcomes if o.status != "passed"]
    assert not lost, lost


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.xdist_group(f"mutants of {name}"))
                                  for name in LESSONS])
def test_what_a_student_reads_is_short_and_tells_expected_from_got(name, grades_of):
    failed = [outcome for outcomes in grades_of(name).values() for outcome in outcomes if outcome.status == "not yet"]
    assert {o.exercise for o in failed} == {mutant.exercise for mutant in mutants_of(name)}
    for o in failed:
        words = {"quantity": o.quantity, "given": o.given, "expected": o.expected, "got": o.got, "hint": o.hint}
        assert not [field for field, text in words.items() if len(text) > LONGEST], o
        ours = f"{o.given}|{o.expected}|{'' if o.quantity == 'the call itself' else o.got}"  # there Python speaks
        assert not re.search(r"np\.|array\(|dtype|[A-Za-z_]=\S|\n|  |\[ | [\],]", ours), o
        assert o.expected != o.got and o.got, o
        assert max(map(digits_of, re.findall(r"\d[\d.]*(?:e[-+]?\d+)?", f"{o.given} {o.expected} {o.got}")),
                   default=0) <= MOST_DIGITS, o


def digits_of(number):
    """Significant digits of a number's text."""
    return len(number.partition("e")[0].replace(".", "").strip("0"))


def proof(mutant, kept):
    """How it is shown that a wrong answer has one fault: undo that, and what is left is right;
    an empty string where it is not.
    """
    if mutant.faults != 1:
        return ""
    if mutant.kind == "edit":                                            # what is left is the worked answer
        return "edit"
    whole = any(m.right and m.faults == 0 and m.exercise == mutant.exercise and m.factory is mutant.factory
                for m in kept)
    return "variant" if whole and mutant.kind == "variant" else ""


@pytest.mark.parametrize("name", LESSONS)
def test_every_wrong_answer_has_one_fault_and_proves_it(name):
    kept = mutants_of(name)
    proofs = {(m.exercise, m.story): proof(m, kept) for m in kept if not m.right}
    for kind in ("edit", "variant"):
        print(f"{name}: {list(proofs.values()).count(kind)} wrong answers have one fault by {kind}")
    assert not [wrong for wrong, kind in proofs.items() if not kind]


def test_what_has_two_faults_or_none_or_no_right_answer_behind_it_proves_nothing():
    wrong, _right, edit, kept = collection(importlib.import_module("solutions.springs"))

    @variants
    def tension(sign=1.0, damper=1.0):
        return lambda length, rate, rest, k, k_d: sign * k * (length - rest) + damper * k_d * rate
    wrong("2.3", "one argument")(tension(sign=-1.0))
    wrong("2.3", "two arguments")(tension(sign=-1.0, damper=-1.0))
    wrong("2.3", "none")(tension())
    wrong("2.3", "written out")(lambda length, rate, rest, k, k_d: 0.0)
    edit("2.3", "once", "k_d", "0.0 * k_d")
    edit("2.3", "twice", " * ", " + ")
    edit("2.3", "nowhere", "no such text", "0.0")
    edit("2.6", "over two lines", "squared_a == 0.0 or squared_c == 0.0:\n", "False:\n")
    proofs = {m.story: proof(m, kept) for m in kept if not m.right}
    assert {story: kind for story, kind in proofs.items() if kind} == {"one argument": "variant", "once": "edit"}
    assert not [m for m in kept if m.right and m.faults]


@pytest.mark.parametrize("name", LESSONS)
def test_every_exercise_has_three_wrong_answers_and_a_right_one(name):
    numbers = set(exercises((modules.SOLUTIONS / f"{name}.py").read_text()))
    kept = mutants_of(name)
    for number in numbers:
        assert sum(m.exercise == number and not m.right for m in kept) >= 3, number
        assert sum(m.exercise == number and m.right for m in kept) >= 1, number


@pytest.mark.parametrize("name", LESSONS)
def test_stubs_score_nothing_of_twenty_points(name):
    empty = score(grade(name, modules.bind(name, "lessons")))
    assert sum(possible for _, possible in empty.values()) == 20
    assert all(earned == 0 for earned, _ in empty.values())
    assert set(empty) == set(exercises((modules.SOLUTIONS / f"{name}.py").read_text()))


@pytest.mark.long                                      # by default the tests of each lesson run on the worked answers
@pytest.mark.parametrize("name", LESSONS)
def test_solutions_score_everything(name):
    full = score(grade(name, modules.bind(name)))
    assert sum(earned for earned, _ in full.values()) == sum(possible for _, possible in full.values()) == 20
    assert set(full) == set(exercises((modules.SOLUTIONS / f"{name}.py").read_text()))
