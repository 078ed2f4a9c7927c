"""A check names the mistake in a wrong answer, and none in a right one; with secret inputs it names nothing."""


import numpy as np
import pytest

from validate import mistakes, modules

from ..mutants.traces import mutants_of, traces_of

LESSONS = modules.lesson_names()
EACH = 20                    # the default run looks at one of so many wrong answers of a lesson; --long at all [-]
RECOGNISED = 0.9             # share of the wrong answers of a lesson, at least
NOISE = 1e-15                # relative size of what another order of the same operations may change


def rounded_otherwise(function):
    """The function, whose results differ in their last digits, as they do when somebody else writes it."""
    rng = np.random.default_rng(5)

    def noisy(value):
        if isinstance(value, (float, np.floating)):
            return value * (1.0 + NOISE * rng.uniform(-1.0, 1.0))
        if isinstance(value, np.ndarray) and value.dtype.kind == "f":
            return value * (1.0 + NOISE * rng.uniform(-1.0, 1.0, value.shape))
        if isinstance(value, tuple):
            parts = [noisy(part) for part in value]
            return type(value)(*parts) if hasattr(value, "_fields") else tuple(parts)
        return value
    return lambda *arguments: noisy(function(*arguments))


def named(lesson, chosen, changed=lambda function: function):
    """{number: all ideas that are found} for these of the lesson's answers, each changed in that way."""
    kept, table = mutants_of(lesson), mistakes.table(lesson)
    orderless = {number for number, one in table.items() if one["orderless"]}
    traces = traces_of(lesson, {k: (kept[k].exercise, changed(kept[k].function)) for k in chosen}, orderless)
    return {k: mistakes.matching(lesson, kept[k].exercise, traces[k]) for k in chosen}


@pytest.mark.parametrize(("name", "each"), [
    *((name, EACH) for name in LESSONS),
    *(pytest.param(name, 1, marks=pytest.mark.long) for name in LESSONS)])
def test_nine_of_ten_wrong_answers_are_recognised_and_no_right_one(name, each):
    kept = mutants_of(name)
    wrong = [k for k, mutant in enumerate(kept) if not mutant.right][::each]
    right = [k for k, mutant in enumerate(kept) if mutant.right]
    found = named(name, wrong, rounded_otherwise)
    recognised = [k for k in wrong if kept[k].story in found[k]]
    print(f"{name}: {len(recognised)} of {len(wrong)} wrong answers are recognised")
    missed = [f"{kept[k].exercise} {kept[k].story}" for k in wrong if k not in recognised]
    assert len(recognised) >= RECOGNISED * len(wrong), missed
    assert not {k: ideas for k, ideas in named(name, right).items() if ideas}
    assert not {k: ideas for k, ideas in named(name, right, rounded_otherwise).items() if ideas}
