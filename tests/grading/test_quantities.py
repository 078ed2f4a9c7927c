"""A quantity names no drawn number: students read it beside the tests with secret inputs, too."""

import sys

import pytest

from validate.grading import expect, points
from validate.subject import modules

COMPARISONS = "between", "choice", "close", "instance", "numbers", "raises", "truth"


@pytest.mark.long
@pytest.mark.parametrize("name", modules.lesson_names())
def test_a_quantity_is_the_same_for_every_seed(name, monkeypatch):
    points.grade(name, None, collect=True)                               # loads the tests of the lesson
    quantities = set()

    def watched(comparison):
        return lambda quantity, *rest, **given: (quantities.add(quantity), comparison(quantity, *rest, **given))[1]
    for comparison in COMPARISONS:
        one = getattr(expect, comparison)
        for module in [m for m in [*sys.modules.values()] if getattr(m, "__dict__", {}).get(comparison) is one]:
            monkeypatch.setattr(module, comparison, watched(one))
    found = []
    for seed in (points.PUBLIC, "one", "two"):
        quantities.clear()
        assert all(o.status == "passed" for o in points.grade(name, modules.bind(name), seed=seed))
        found.append({*quantities})
    assert found[0] and found[0] == found[1] == found[2], set.union(*found) - set.intersection(*found)


def test_a_choice_is_a_letter_and_the_right_one_is_never_shown():
    expect.choice("the letter", "b ", "B")
    for got, shown in (("A", "A"), ("E", "“E”"), ("AB", "“AB”"), ("", "“”"), (None, expect.NOTHING), (2, "a number")):
        with pytest.raises(expect.NotYet) as failed:
            expect.choice("the letter", got, "B")
        assert failed.value.got == shown and failed.value.expected in (
            "another letter", "one of the letters A, B, C, D, as a text")
