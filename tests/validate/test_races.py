"""Races: the time to an error is read between runs, every outcome is named, and a ratio is the product of its parts."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from validate.engines.products import PYMUNK
from validate.measure import calls, races, timing
from validate.measure.accuracy import Outcome as Run
from validate.measure.accuracy import swept
from validate.measure.compilation import compilation
from validate.measure.races import BEST, HEADLINE, LEVELS, Outcome
from validate.measure.selection import Plan, select
from validate.measure.timing import times_to_error
from validate.report import choice
from validate.report import races as words
from validate.subject import modules
from validate.subject.numba_twins import CACHE

COST = {"product": "pymunk", "seconds": 1e-6, "how": "an empty step", "called": [1e-6], "alone": []}


def row(label, speed, steps, error, seconds, spread=0.1):
    return {"label": label, "speed": speed, "steps": steps, "error": error, "seconds": seconds,
            "low": (1.0 - spread) * seconds, "high": (1.0 + spread) * seconds}


def curve(label, order, errors, verdict="agrees", **more):
    rows = [{"steps": n, "error": e} for n, e in errors]
    return {"label": label, "expected": order, "order": None, "verdict": verdict, "rows": rows, **more}


def line(label, speed, order, per_step, constant=1.0, steps=(10, 100, 1000), **more):
    """(curve, rows) of something whose error is constant/steps^order, and which takes so long per step."""
    errors = [(n, constant / n**order) for n in steps]
    return (curve(label, order, errors, **more),
            [row(label, speed, n, error, n * per_step) for n, error in errors])


def engine(per_step=1e-5, constant=1.0, verdict="agrees", **more):
    about = {"product": "pymunk", "variant": "", "substeps": 1, "verdict": verdict}
    return line("pymunk", "engine", 1, per_step, constant, **about, **more)


def held(engines, ours, quick=False, cost=COST):
    """The races of these lines, by level."""
    rows = [one for _, mine in (*engines, *ours) for one in mine]
    case = {"engines": [c for c, _ in engines], "ours": [c for c, _ in ours]}
    return {race["level"]: race for race in races.races(rows, case, ["pymunk"], quick, [cost])}


EULER, RK4 = line("Euler", "compiled", 1, 1e-7), line("RK4", "compiled", 4, 4e-7)


def test_the_time_to_an_error_is_read_between_two_runs_with_its_range():
    found = races.reach([row("a", "plain", 10, 1e-1, 1.0), row("a", "plain", 1000, 1e-3, 100.0)], 1e-2)
    assert found.seconds == pytest.approx(10.0) and not found.coarsest and found.steps == 1000
    assert (found.low, found.high) == (pytest.approx(9.0), pytest.approx(11.0))
    assert races.reach([row("a", "plain", 10, 1e-1, 1.0)], 1e-2) is None


def test_the_time_to_an_error_is_read_on_the_curve_and_not_across_a_lost_run():
    runs = ((10, 0.9, 1.0), (20, 0.3, 2.0), (40, 1e-4, 4.0))
    lost, coarse, fine = (row("a", "plain", *run) for run in runs)
    assert races.reach([lost, fine], 1e-2).seconds == 4.0
    between = races.reach([lost, coarse, fine], 1e-2).seconds
    assert between == pytest.approx(4.0 * 0.5 ** (np.log(1e-2 / 1e-4) / np.log(0.3 / 1e-4)))
    # the next coarser run counts, and not the one whose error is nearest
    by_luck = row("a", "plain", 5, 0.02, 0.5)
    assert races.reach([by_luck, lost, coarse, fine], 1e-2).seconds == between
    assert races.reach([by_luck, lost, fine], 1e-2).seconds == 4.0


def test_an_error_that_the_coarsest_run_meets_is_said_as_such():
    found = held([engine(constant=0.1)], [EULER])[0.1]
    assert found["engine"]["coarsest"] and found["ours"]["coarsest"]
    assert words.coarse(found) == "Both meet 10 % already in 10 steps."
    one = {**found, "ours": {**found["ours"], "steps": 1}}
    assert words.coarse(one) == \
        "10 % is met already by the coarsest timed run of pymunk (10 steps) and of our method (one step)."
    assert words.coarse(held([engine()], [EULER])[0.001]) == ""


def test_errors_that_the_same_coarsest_run_meets_share_a_sentence():
    theirs = list(held([engine(constant=1e-9)], [EULER]).values())
    assert list(words.coarse_runs(theirs)) == [
        "Both meet 10 % already in 10 steps.",
        "1 % and 0.1 % are met already by the coarsest timed run of pymunk (10 steps)."]


def test_the_interval_of_a_median_leaves_out_one_repeat_on_either_side_of_nine():
    assert timing.interval([5.0, 1.0, 9.0, 3.0, 2.0, 4.0, 8.0, 6.0, 7.0]) == {"low": 2.0, "high": 8.0}
    assert timing.interval([3.0, 1.0, 2.0]) == {"low": 1.0, "high": 3.0}
    drawn = np.random.default_rng(1).exponential(size=(20_000, 9))           # its median is log 2
    ends = np.sort(drawn, axis=1)[:, [1, 7]]
    inside = np.mean((ends[:, 0] <= np.log(2.0)) & (np.log(2.0) <= ends[:, 1]))
    assert inside == pytest.approx(1.0 - 20.0 / 2.0**9, abs=0.006)           # four standard deviations


def test_long_loops_are_repeated_seven_times_and_long_plain_ones_three_times():
    for speed, seconds, laps in (("engine", 0.03, 9), ("engine", 0.3, 7), ("plain", 0.01, 9), ("plain", 0.2, 3)):
        assert sum(timing.is_due(speed, lap, seconds) for lap in range(timing.REPEATS)) == laps


def test_before_each_repeat_a_short_loop_runs_once_without_the_clock(monkeypatch):
    seconds, ran = {"long": 1e-2, "short": 1e-4}, []
    monkeypatch.setattr(timing, "clock", lambda item, inner, steps=None: ran.append(item.label) or seconds[item.label])
    items = [timing.Timed(label, "engine", 8, 0.1, None) for label in seconds]
    timing.interleaved(items, {"engine": 1.0}, repeats=2)
    assert ran[-6:] == 2 * ["long", "short", "short"]


def test_there_is_a_race_to_each_error_and_to_the_engines_best():
    found = held([engine()], [EULER, RK4])
    assert list(found) == [*LEVELS, BEST] and HEADLINE in LEVELS
    assert {race["outcome"] for race in found.values()} == {Outcome.FASTER}
    assert found[BEST]["error"] == 1e-3
    assert found[0.01]["ratio"] < found[0.001]["ratio"]                      # an order more pays more and more


def test_a_ratio_is_the_product_of_order_and_loop_and_calls_are_a_part_of_the_loop():
    for race in held([engine()], [EULER, RK4]).values():
        assert race["ratio"] == pytest.approx(race["order"] * race["loop"])
        assert race["loop"] == pytest.approx(100.0) and race["calls"] == pytest.approx(10.0 / 9.0)
        assert race["same_order"]["label"] == "Euler" and race["low"] < race["ratio"] < race["high"]


def test_an_engine_that_makes_many_steps_in_a_call_pays_for_few_calls():
    theirs = engine()
    theirs[0].update(substeps=10)
    assert held([theirs], [EULER])[0.01]["calls"] == pytest.approx(1.0 / 0.99)


def test_without_a_method_of_the_engines_order_a_ratio_has_no_parts():
    race = held([engine()], [RK4])[0.01]
    assert race["ratio"] and race["order"] is None and race["loop"] is None


def test_a_method_of_the_same_order_that_was_timed_in_plain_python_only_is_no_part_of_a_compiled_race():
    slow = line("Euler", "plain", 1, 1e-5)
    assert held([engine()], [slow, RK4])[0.01]["order"] is None


def test_an_order_that_is_no_number_is_taken_as_it_was_measured():
    theirs = engine()
    theirs[0].update(expected="1 to 2", order=1.9)
    assert races.order_of(theirs[0]) == 2 and races.order_of({"expected": "exact", "order": 2.0}) is None


@pytest.mark.parametrize(("per_step", "outcome"), [(1e-5, "faster"), (1.5e-7, "a tie"), (1e-8, "slower")])
def test_a_race_is_won_only_beyond_a_factor_of_two(per_step, outcome):
    assert held([engine(per_step)], [EULER])[0.01]["outcome"] == outcome


def test_a_ratio_within_the_spread_of_its_times_is_a_tie():
    theirs, ours = engine(4e-7), EULER
    assert held([theirs], [ours])[0.01]["outcome"] == "faster"
    for one in theirs[1]:
        one["low"] = 0.2 * one["seconds"]
    assert held([theirs], [ours])[0.01]["outcome"] == "a tie"


def test_an_error_that_a_side_does_not_reach_is_named_and_never_dropped():
    far = line("Euler", "compiled", 1, 1e-7, constant=20.0)
    assert held([engine()], [far])[0.01]["outcome"] == Outcome.SLOWER           # a loss: ours never gets there
    assert "none of our runs" in words.ratio(held([engine()], [far])[0.01])
    assert held([engine(constant=20.0)], [EULER])[0.01]["outcome"] == Outcome.ENGINE_FAILS
    assert held([engine(constant=20.0)], [far])[0.01]["outcome"] == Outcome.NEITHER
    assert held([engine(constant=1e4)], [EULER])[BEST]["error"] is None         # all of its runs are lost


def test_what_a_run_cannot_decide_is_undecided_and_says_why():
    def why(engines, ours, quick=False):
        race = held(engines, ours, quick)[0.001]
        assert race["outcome"] == Outcome.UNDECIDED and race["ratio"] is None
        return race["why"]
    assert "luck" in why([engine(verdict="undecided")], [EULER])
    assert "short enough" in why([(engine()[0], [])], [EULER])
    timed = (EULER[0], EULER[1][:1])
    assert "too long to be timed" in why([engine()], [timed])
    assert "no run of the engine here is that accurate" in why([engine(constant=20.0)], [EULER], quick=True)
    assert "plain Python only" in why([engine(1.5e-7)], [line("Euler", "plain", 1, 1e-7)])
    assert held([engine()], [line("Euler", "plain", 1, 1e-7)], quick=True)[0.01]["outcome"] == "faster"


def test_what_does_not_agree_with_the_truth_does_not_race():
    assert held([engine(verdict="as predicted")], [EULER]) == {}
    lucky = line("lucky", "compiled", 4, 1e-9, verdict="undecided")
    assert held([engine()], [EULER, lucky])[0.01]["ours"]["label"] == "Euler"


def test_of_settings_that_err_alike_the_fastest_one_runs_to_the_engines_best():
    def setting(variant, error, seconds):
        label = f"pymunk, {variant}"
        return (curve(label, 1, [(10, error)], product="pymunk", variant=variant, substeps=1),
                [row(label, "engine", 10, error, seconds)])
    settings = [setting("as it is", 1e-4, 9.0), setting("fewer", 1.04e-4, 3.0), setting("fewest", 1e-3, 1.0)]
    ours = line("RK4", "compiled", 4, 1e-7)
    assert held(settings, [ours])[BEST]["variant"] == "fewer"
    settings[1] = setting("fewer", 1.06e-4, 3.0)                        # errs more: its time is no time to that error
    assert held(settings, [ours])[BEST]["variant"] == "as it is"


def test_an_engine_without_error_races_to_round_off():
    theirs = (curve("pymunk", "exact", [(1, 1e-16)], product="pymunk", variant="", substeps=1),
              [row("pymunk", "engine", 1, 1e-16, 1e-6)])
    exact = (curve("event", "exact", [(1, 0.0)]), [row("event", "compiled", 1, 0.0, 1e-7)])
    found = held([theirs], [exact])
    assert found[BEST]["error"] == races.EXACTLY and found[BEST]["ratio"] == pytest.approx(10.0)
    assert found[0.01]["order_of_engine"] is None and "Both meet 1 % already in one step." in words.sentence(
        {**found[0.01], "product": "pymunk"})


def test_the_shown_ratio_lies_in_its_shown_range():
    for ratio, low, high in ((352.9, 157.0, 381.0), (1.3, 1.1, 1.9), (10000.0, 5800.0, 10000.0), (4.0, 2.0, 8.0)):
        shown = words.ratio({"ratio": ratio, "low": low, "high": high})
        middle, low, high = (float(text.replace(",", "")) for text in
                             shown.replace("×", "").replace("(", "").replace(")", "").replace("to ", "").split())
        assert low <= middle <= high, shown


def test_a_summary_counts_every_outcome_and_its_median_lies_in_its_interval():
    every = [{**race, "scene": name, "title": name, "lesson": "integrators"}
             for name, per_step in (("a", 1e-5), ("b", 1.5e-7), ("c", 1e-8), ("d", 1.05e-6))
             for race in held([engine(per_step)], [EULER]).values()]
    at_one = words.headline_of(words.counted(every))
    assert (at_one["faster"], at_one["tie"], at_one["slower"], at_one["races"]) == (2, 1, 1, 4)
    assert at_one["low"] < at_one["ratio"] < at_one["high"]
    assert words.summary_ratio(at_one).startswith("6.0× (")                  # between 1.5 and 10.5


def test_the_interval_of_a_ratio_has_room_for_another_run():
    """The measured factor is more than 1, and acts on both ends."""
    assert words.BETWEEN_RUNS > 1.0
    assert words.with_interval({"ratio": 8.9, "low": 8.5, "high": 10.0}) == "8.9× (7.7 to 11)"


def test_compilation_has_paid_when_the_engine_has_lost_as_much_time():
    race = held([engine()], [EULER])[0.01]
    result = {"T": 2.0, "moves": True}
    found = words.compiling(race, {"label": "Euler", "cold": 4.0, "cached": 0.3}, result)
    saved = race["engine"]["seconds"] - race["ours"]["seconds"]
    assert found == {"cold": 4.0, "cached": 0.3, "paid": pytest.approx(8.0 / saved)}
    assert words.compiling(race, {"label": "RK4", "cold": 4.0, "cached": 0.3}, result)["cold"] is None
    still, lost = {**result, "moves": False}, held([engine(1e-8)], [EULER])[0.01]
    assert words.compiling(race, {"label": "Euler", "cold": 4.0, "cached": 0.3}, still)["paid"] is None
    assert words.compiling(lost, {"label": "Euler", "cold": 4.0, "cached": 0.3}, result)["paid"] is None


@pytest.mark.long
@pytest.mark.skipif(not modules.can_compile(), reason="numba is not installed here")
def test_a_method_compiles_longer_than_it_loads_and_leaves_no_cache_behind():
    before = set(CACHE.glob("*")) if CACHE.is_dir() else set()
    selection = select("throw", Plan(quick=False))
    ours = {"label": "midpoint", "speed": "compiled", "steps": 10, "alone": 1e-6}
    found = compilation(selection, selection.first[1], [{"level": HEADLINE, "ours": ours}])
    assert found["label"] == "midpoint" and found["cold"] > 2.0 * found["cached"] > 0.0
    assert not set(CACHE.glob("anew-*")) - before


def test_plain_python_compiles_nothing():
    for ours in (None, {"label": "midpoint", "speed": "plain", "steps": 10, "alone": 1e-6}):
        assert compilation(None, None, [{"level": HEADLINE, "ours": ours}]) is None


@pytest.mark.skipif(not PYMUNK.installed(), reason="pymunk is not installed here")
def test_a_call_from_python_costs_more_than_an_empty_step_of_the_engine():
    one = calls.cost_of_calls(PYMUNK)
    assert one["seconds"] > 0.0 and len(one["called"]) == calls.REPEATS
    assert not one["alone"] or np.median(one["alone"]) < np.median(one["called"])      # one may be interrupted


# ---------------------------------------------------------------------------------------------- which method

def scene(name, lesson, *lines):
    """The result of a scene with these methods of ours, as far as the choice of a method looks at it."""
    rows = [one for _, mine in lines for one in mine]
    return {"scene": name, "lesson": lesson, "refinement": "step", "times": {"time_to_error": times_to_error(rows)},
            "cases": {"one": {"ours": [c for c, _ in lines], "engines": []}}}


def test_the_cheapest_method_of_a_lesson_is_the_one_that_is_cheapest_in_most_scenes():
    fine = (10, 100, 1000, 10_000, 100_000)
    euler, rk4 = line("Euler", "compiled", 1, 1e-9, steps=fine), line("RK4", "compiled", 4, 4e-7, steps=fine)
    row_, = choice.by_lesson([scene("a", "integrators", euler, rk4), scene("b", "integrators", euler, rk4)])
    assert row_["cheapest"][0] == {"label": "Euler", "wins": 2, "of": 2}         # 1 %: cheap steps
    assert row_["cheapest"][1] == {"label": "RK4", "wins": 2, "of": 2}           # 0.01 %: a high order
    assert row_["safest"]["label"] == "RK4"                                      # errs less at the largest step


def test_the_safest_method_bears_the_largest_steps_and_a_lucky_coarse_run_does_not_count():
    steady = curve("steady", 1, [(10, 0.4), (100, 0.1)])
    lucky = curve("lucky", 1, [(2, 0.1), (10, 9.0), (100, 0.01)])
    found = choice.largest_steps({"cases": {"one": {"ours": [steady, lucky]}}})
    assert found["steady"] < found["lucky"] < math.inf
    lost = curve("lost", 1, [(10, None), (100, None)])
    assert choice.largest_steps({"cases": {"one": {"ours": [lost]}}})["lost"] == math.inf


def test_a_lesson_without_steps_has_no_choice():
    still = {**scene("a", "inertia_tensors", EULER), "refinement": ""}
    assert choice.by_lesson([still]) == [{"lesson": "inertia_tensors", "scenes": 0, "cheapest": [None, None],
                                          "safest": None}]


def test_methods_are_compared_at_one_speed():
    both = line("Euler", "plain", 1, 1e-5)
    fast = (RK4[0], [*RK4[1], *line("RK4", "plain", 4, 1e-4)[1]])
    assert choice.speed_of(scene("a", "integrators", both, fast)) == "plain"
    assert set(choice.costs(scene("a", "integrators", both, fast), 0.01)) == {"Euler", "RK4"}


def coarse_sweep(errors, quick=False, at_once=1):
    """Return the numbers of steps of a sweep whose runs have the errors {steps: error}."""
    selection = select("throw", Plan(quick=quick, speeds=("plain",), live=()))
    p, truth = selection.first[1], np.ones(1)
    runner = SimpleNamespace(is_engine=at_once > 1, who=SimpleNamespace(substeps=at_once, most_steps=None),
                             most_in_quick=None, finer_in_full=())
    selection = selection._replace(steps=(20, 40))
    return [n for n, _ in swept(selection, runner, p, truth, lambda n: Run(truth + errors(n)))]


def test_a_sweep_begins_with_a_run_that_misses_the_error_of_the_race():
    """An error of 0.08/n is above 1 % at five steps; that of 1/n already at twenty; an exact method ends with two."""
    assert coarse_sweep(lambda n: 0.08 / n) == [5, 10, 20, 40]
    assert coarse_sweep(lambda n: 1.0 / n) == [20, 40]
    assert coarse_sweep(lambda n: 0.0) == [2, 5, 10, 20, 40]
    assert coarse_sweep(lambda n: 0.0, at_once=4) == [4, 8, 20, 40]
    assert coarse_sweep(lambda n: 0.0, quick=True) == [20, 40]
