"""A check names the mistake in a wrong answer, and none in a right one; with secret inputs it names nothing."""


import json
import types
from collections import Counter

import numpy as np
import pytest

from validate import mistakes
from validate.grading import example, points, release
from validate.notebook.pytest_process import quiet
from validate.subject import modules, needs

from ..mutants.traces import mutants_of, names_in, steady, tells, traces_of, without_the_unsteady

LESSONS = modules.lesson_names()
EACH = 40                    # the default run tries one of so many known wrong answers of a lesson; --long all [-]
RECOGNISED = 0.9             # share of the wrong answers of a lesson that its table knows, at least
NOISE = 1e-15                # relative size of what another order of the same operations may change


def rounded_otherwise(function):
    """The function, whose results differ in their last digits, as they do when another author writes it."""
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


def named(lesson, chosen, rounded):
    """{number: all ideas that are found} for these of the lesson's answers, and for those that round otherwise."""
    kept = mutants_of(lesson)
    answers = {("as it is", k): (kept[k].exercise, kept[k].function) for k in chosen}
    answers |= {("rounded", k): (kept[k].exercise, rounded_otherwise(kept[k].function)) for k in rounded}
    traces = traces_of(lesson, answers)
    found = {key: mistakes.matching(lesson, kept[key[1]].exercise, traces[key]) for key in answers}
    return {k: found["as it is", k] for k in chosen}, {k: found["rounded", k] for k in rounded}


@pytest.mark.parametrize(("name", "each"), [
    *((name, EACH) for name in LESSONS),
    *(pytest.param(name, 1, marks=pytest.mark.long) for name in LESSONS)])
def test_nine_of_ten_wrong_answers_are_recognised_and_no_right_one(name, each):
    kept, table = mutants_of(name), mistakes.table(name)
    every = [k for k, mutant in enumerate(kept) if not mutant.right]
    right = [k for k, mutant in enumerate(kept) if mutant.right][::min(each, 12)]
    stored = Counter((number, one["idea"]) for number, exercise in table.items() for one in exercise["wrong"])
    told = {k: (kept[k].exercise, kept[k].story) for k in every}
    missed = Counter(told.values()) - stored                # of answers with one story, some depend on round-off
    assert stored.total() >= RECOGNISED * len(every), missed
    wrong = [k for k in every if told[k] not in missed][::each]
    found, rounded = named(name, [*wrong, *right] if each == 1 else wrong, right)
    print(f"{name}: {stored.total()} of {len(every)} wrong answers are in the table; {len(wrong)} were tried")
    assert not [f"{kept[k].exercise} {kept[k].story}" for k in wrong if kept[k].story not in found[k]]
    assert not {k: found[k] for k in right if found.get(k)}
    assert not {k: ideas for k, ideas in rounded.items() if ideas}


# ---------------------------------------------------------------------------------------------- in a check

EULER = "return x + dt * v, v + dt * acceleration(t, x, v, p)"           # the answer to 1.1
IDEA = "moves the position with the new velocity"


def run_of(tmp_path, lesson, exercises, changes, *more):
    """Outcomes of pytest --of a folder with that lesson, worked but for some replacements in its text, and what it
    printed.
    """
    text = example.worked(lesson)
    for old, new in changes.items():
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    folder, file = tmp_path / "mine", tmp_path / "outcomes.json"
    folder.mkdir(exist_ok=True)
    (folder / f"{lesson}.py").write_text(text)
    chosen = [f"--exercise={number}" for number in exercises]
    said = quiet(str(points.LESSONS / f"test_{lesson}.py"), f"--of={folder}", *chosen, f"--outcomes={file}",
                 "--tb=line", f"--rootdir={modules.ROOT}", *more)
    return [points.Outcome(**outcome) for outcome in json.loads(file.read_text())], said


def test_a_mistake_that_is_written_differently_is_named(tmp_path):
    other = "w = v + acceleration(t, x, v, p) * dt\n    return w * dt + x, w"
    outcomes, said = run_of(tmp_path, "integrators", ["1.1"], {EULER: other})
    assert IDEA in said and "a known mistake gives the same results" in said
    assert all(IDEA in o.idea for o in outcomes if o.status == "not yet")
    assert all(o.idea == "" for o in outcomes if o.status == "passed")


def test_an_unknown_mistake_is_not_named(tmp_path):
    outcomes, _ = run_of(tmp_path, "integrators", ["1.1"], {EULER: "return x + 1.1 * dt * v, v - 0.3 * dt * x"})
    assert "not yet" in {o.status for o in outcomes} and not any(o.idea for o in outcomes)


@pytest.mark.parametrize(("name", "number"), [("springs", "2.4"), ("friction", "3.1"), ("impulses", "7.14")])
def test_an_answer_that_always_returns_zero_is_not_named(name, number):
    """It gives the same as many a mistake in the first call of a test."""
    worked = getattr(modules.bind(name), names_in(name)[number])
    traces = traces_of(name, {"zero": (number, lambda *arguments: 0.0 * worked(*arguments))})
    assert mistakes.matching(name, number, traces["zero"]) == []


@pytest.mark.parametrize("name", LESSONS)
def test_each_name_rests_on_a_result_about_which_round_off_does_not_decide(name):
    unsure = [f"{number} {one['idea']}" for number, known in mistakes.table(name).items() for one in known["wrong"]
              if not one["later"] and not any(tells(one["tests"][test], known["right"][test]) for test in one["tests"])]
    assert not unsure


def test_a_result_about_which_round_off_decides_is_kept_as_huge_or_not_at_all():
    one, other = [[1, 2.0], [1, 2.0], [1, 2e9], "3 calls"], [[1, 2.0], [1, 2.1], [1, -7e8], "3 calls"]
    assert steady(one, other) == [[1, 2.0], None, "huge", "3 calls"]
    assert mistakes.same([1, 3e7, 3e7], "huge") and not mistakes.same([1, 30.0, 30.0], "huge")
    assert not mistakes.same("ValueError", "huge")


def test_wrong_answers_with_the_same_story_keep_their_own_results():
    def table():
        wrong = [{"idea": "is wrong", "number": k, "tests": {"a": [[1, k + 2.0], "1 calls"]}, "later": {}}
                 for k in range(2)]
        return {"1.1": {"right": {"a": [[1, 1.0], "1 calls"]}, "wrong": wrong}}
    kept = without_the_unsteady(table(), table())["1.1"]["wrong"]
    assert [one["tests"]["a"] for one in kept] == [[[1, 2.0], "1 calls"], [[1, 3.0], "1 calls"]]


def test_where_known_mistakes_are_decided_by_round_off_an_unknown_one_has_no_name():
    """All of them end the tests of 11.10 after the same number of calls."""
    worked = modules.bind("kinematics").pseudo_inverse
    traces = traces_of("kinematics", {"larger": ("11.10", lambda J: 1.7 * worked(J))})
    assert mistakes.matching("kinematics", "11.10", traces["larger"]) == []


def test_a_wrong_letter_of_a_choice_is_named_and_no_letter_stands_in_a_table():
    letters = {letter: ("1.12", lambda letter=letter: letter) for letter in "ABCDE"}
    traces = traces_of("integrators", letters)
    found = {letter: mistakes.matching("integrators", "1.12", traces[letter]) for letter in letters}
    assert sorted(map(len, found.values())) == [0, 0, 1, 1, 1] and not found["E"]
    kept = [one["tests"] for one in mistakes.table("integrators")["1.12"]["wrong"]]
    assert all(len(results[0]) == mistakes.DIGITS for tests in kept for results in tests.values())


def test_with_secret_inputs_no_mistake_is_named(tmp_path):
    other = "w = v + acceleration(t, x, v, p) * dt\n    return w * dt + x, w"
    outcomes, said = run_of(tmp_path, "integrators", ["1.1"], {EULER: other}, "--seed=a secret")
    assert "not yet" in {o.status for o in outcomes} and not any(o.idea for o in outcomes) and IDEA not in said


def test_a_grader_traces_nothing():
    """It grades by `points.grade`, with public and with secret inputs."""
    module = modules.bind("integrators")
    wrong = types.SimpleNamespace(**{**vars(module), "euler_step": lambda a, t, x, v, dt, p: (x, v)})
    for seed in (points.PUBLIC, "a secret"):
        outcomes = points.grade("integrators", wrong, lambda exercise, test: exercise == "1.1", seed)
        assert "not yet" in {o.status for o in outcomes} and not any(o.idea or o.below for o in outcomes)


def test_a_failure_below_is_named(tmp_path):
    """8.7 calls predict, 8.3."""
    wrong = {"return x + dt * v + dt * dt * free[:, None] * a": "return x + dt * v + dt * free[:, None] * a"}
    outcomes, said = run_of(tmp_path, "pbd", ["8.3", "8.7"], wrong)
    sentence = "8.7 calls predict (8.3), which does not pass yet: mend that first"
    assert sentence in said and {o.below for o in outcomes if o.status == "not yet"} == {"", sentence}
    assert not any(o.below for o in outcomes if o.exercise == "8.3")


@pytest.mark.parametrize(("returned", "kind"), [
    ("None", "None"), *(pytest.param(*one, marks=pytest.mark.long) for one in (("dt", "a number"),
                                                                              ("(x, v, t)", "3 values")))])
def test_a_result_of_another_kind_is_named(tmp_path, returned, kind):
    outcomes, _ = run_of(tmp_path, "integrators", ["1.1"], {EULER: f"return {returned}"})
    failed = [o for o in outcomes if o.status == "not yet"]
    assert failed and {o.quantity for o in failed} == {"what euler_step returns"}
    assert {o.got.partition(" (")[0] for o in failed} == {kind}
    assert {o.expected.partition(" (")[0] for o in failed} == {"2 values"}


def test_a_list_in_place_of_an_array_is_told_what_makes_an_array_of_it(tmp_path):
    flat, paired = "for node in (r * cols + c, (r + dr) * cols + c + dc)]", "]"
    change = {"pairs = [node for": "pairs = [(r * cols + c, (r + dr) * cols + c + dc) for", flat: paired,
              "return np.array(pairs, dtype=np.int64).reshape(-1, 2)": "return pairs"}
    outcomes, _ = run_of(tmp_path, "springs", ["2.10"], change)
    first = outcomes[0]
    assert (first.got, first.hint) == ("a list", "np.array(…) makes an array of it")


AS_AN_ARRAY = {              # what is written of an array, and fails with a list
    "half": lambda x: x * 0.5, "quotient": lambda x: x / 2.0, "sum": lambda x: x + 1.0, "longer": lambda x: x + x[0],
    "difference": lambda x: x - x, "sign": lambda x: -x, "square": lambda x: x**2, "product": lambda x: x @ x,
    "column": lambda x: x[:, 0], "shape": lambda x: x.shape,
    "transposed": lambda x: x.T, "order": lambda x: x > 0.0, "size": lambda x: abs(x)}


@pytest.mark.parametrize("use", AS_AN_ARRAY.values(), ids=AS_AN_ARRAY)
def test_a_list_that_is_used_as_an_array_is_named(use):
    with pytest.raises((TypeError, AttributeError)) as found:
        use([1.0])
    assert points._advice("9.11", found.value, points.words_of(found.value)) == points.LISTED


def test_an_exercise_that_gets_a_list_from_another_one_says_so(tmp_path):
    change = {"return (G * w) @ np.ascontiguousarray(G.T)": "return ((G * w) @ G.T).tolist()",
              "F = solve_contacts(delassus_matrix(G, w), G @ (w * load.ravel()), mu)":
              "A = delassus_matrix(G, w)\n    F = solve_contacts(0.5 * (A + A.T), G @ (w * load.ravel()), mu)"}
    outcomes, _ = run_of(tmp_path, "contact", ["9.2", "9.11"], change)
    assert {o.exercise for o in outcomes if o.status != "passed"} == {"9.11"}
    assert {o.hint for o in outcomes if o.status == "not yet"} == {points.LISTED}


def test_an_error_in_given_code_names_the_line_of_the_answer_that_called_it(tmp_path):
    change = {"pairs = movable_pairs(near_pairs(": "pairs = movable_pairs(0 * near_pairs(",
              "p.planes), p)": "p.planes), 1)"}
    outcomes, _ = run_of(tmp_path, "simulator", ["10.5"], change)
    line = 1 + (tmp_path / "mine" / "simulator.py").read_text().split("movable_pairs(0")[0].count("\n")
    assert {o.error.rpartition(" (")[2] for o in outcomes} == {f"simulator.py, line {line})"}


@pytest.mark.long
def test_an_error_where_none_was_expected_is_said(tmp_path):
    outcomes, _ = run_of(tmp_path, "integrators", ["1.1"], {EULER: "raise ValueError('too fast')"})
    failed = [o for o in outcomes if o.status == "not yet"]
    assert failed and all(o.expected == "an answer, and no error" for o in failed)


# ---------------------------------------------------------------------------------------------- the tables

LARGE = {"contact", "simulator"}         # lessons whose tables take seconds to search


def test_exercises_call_those_that_their_answers_use():
    table = needs.table()
    assert table["8.7"]["needs"] == ["8.3", "8.6"] and table["8.16"]["needs"] == ["5.10"]
    assert "5.10" in table["5.12"]["needs"] and "1.4" in table["2.9"]["needs"]
    assert {number for name in LESSONS for number in names_in(name)} == set(table)
    assert needs.needed("8.7") == ["8.3", "8.6"]


def test_another_lesson_is_needed_only_where_it_is_imported_from_beside(tmp_path):
    (tmp_path / "pbd.py").write_text("from .rotation import quaternion_update\n")
    assert "5.10" in needs.needed("8.16", tmp_path)
    (tmp_path / "pbd.py").write_text("from solutions.rotation import quaternion_update\n")
    assert needs.needed("8.16", tmp_path) == []


def test_the_next_exercise_is_the_first_whose_calls_pass():
    states = dict.fromkeys(needs.of_lesson("pbd"), "passed")
    assert needs.next_of("pbd", states) is None
    assert needs.next_of("pbd", {**states, "8.7": "not yet", "8.3": "not attempted"}) == "8.3"
    assert needs.next_of("pbd", {**states, "8.16": "not yet"}) == "8.16"


@pytest.mark.parametrize("name", [pytest.param(name, marks=[pytest.mark.long] * (name in LARGE)) for name in LESSONS])
def test_no_answer_can_be_read_from_a_table(name):
    """Nothing of an answer's text is in it, and no code.  `release` searches all tables of a zip in the same way."""
    path = mistakes.FOLDER / f"{name}.json"
    text = path.read_text(encoding="utf-8")
    hidden = list(release.answers_of(name))
    how = hidden, release.signs_of(hidden), release.names_of(hidden)
    assert release.leak_in(text, *how) is None
    assert not any(release.leak_in(quoted, *how)
                   for quoted in release.texts(f"{name}.json", text))


def test_the_order_matters_only_where_it_is_said():
    rows, other = [(1, 2), (3, 4)], [(3, 4), (1, 2)]
    assert not mistakes.same(mistakes.summary(rows), mistakes.summary(other))
    assert mistakes.same(mistakes.summary(rows, True), mistakes.summary(other, True))
    assert not mistakes.same(mistakes.summary(rows, True), mistakes.summary([(1, 4), (3, 2)], True))
