"""Truths without a formula: two codes that share nothing agree, and their error bar belongs to every limit."""

import sys

import numpy as np
import pytest

from validate.engines.products import PYMUNK
from validate.measure import agreement
from validate.measure.accuracy import relative, run_engine_to_end
from validate.reference.stored import agreed
from validate.scenes.simulator import dominoes, machine
from validate.subject import modules

AGREED = [pytest.param(name, home.CASES[case], id=f"{name}, {case}")
          for name, home in agreement.SCENES.items() for case in home.AGREED_CASES]
CASES = pytest.mark.parametrize("p", dominoes.CASES.values(), ids=dominoes.CASES)


@pytest.mark.parametrize(("name", "p"), AGREED)
def test_two_codes_agree_on_the_truth_of_every_case(name, p):
    kept, home = agreed(name, p), agreement.SCENES[name]
    assert {code.partition(",")[0] for code in kept["of"]} == {"pymunk", "loop"} and len(kept["of"]) == 4
    assert 0.0 < kept["bar"] <= home.AGREED and max(kept["apart"]) <= home.AGREED
    assert not any(r.is_reference(p) for r in home.SCENE.runners)


def test_the_uncertainty_of_the_scene_is_the_error_bar_of_its_first_case():
    bar = dominoes.reference(dominoes.SCENE.parameters).bar
    assert bar <= dominoes.UNCERTAINTY <= 1.2 * bar


@CASES
def test_a_limit_contains_the_error_bar(p):
    assert dominoes.limit(p, 0.0) == pytest.approx(dominoes.reference(p).bar + dominoes.LEFT, rel=1e-12)


def test_pymunk_is_judged_by_a_truth_that_is_not_its_own():
    p, steps = dominoes.CASES["six"], 5000
    runner = next(r for r in dominoes.SCENE.engine_runners if r.who.product == PYMUNK)
    seen, truth = run_engine_to_end(dominoes.SCENE, runner.who, p, steps).observed, dominoes.truth(p, dominoes.T)
    assert 1e-5 < relative(seen, truth) <= runner.largest_error(p, dominoes.T / steps)


def test_where_no_agreement_is_kept_pymunks_run_is_a_reference_and_judges_nothing():
    p = dominoes.CASES["six"]._replace(n=2, mu=0.3)
    assert all(r.is_reference(p) is (r.who.product == PYMUNK) for r in dominoes.SCENE.engine_runners)
    assert dominoes.limit(p, 1e-3) == np.inf and np.all(np.isfinite(dominoes.truth(p, dominoes.T)))
    slower = machine.CASES["places"]._replace(blow=3.0)
    assert [r.is_reference(slower) for r in machine.SCENE.engine_runners] == [True]


@pytest.mark.parametrize("t", [0.0, 0.0399, 0.0401, 0.5, 0.9999])
def test_the_film_of_the_truth_meets_its_ends_and_its_beginning(t):
    p = dominoes.CASES["six"]
    here, there = dominoes.truth(p, t), dominoes.truth(p, t + 1e-4)
    assert relative(here, there) < 2e-3


@pytest.mark.long
@pytest.mark.parametrize(("name", "p"), [AGREED[0], AGREED[-1]])
def test_the_agreement_that_is_kept_is_what_the_two_codes_give(name, p):
    again, kept, corners = agreement.agreement(name, p), agreed(name, p), agreement.SCENES[name].all_corners
    assert relative(*(corners(np.array(one["ends"]), p) for one in (again, kept))) <= kept["bar"]
    assert again["bar"] == pytest.approx(kept["bar"], rel=0.5)


class EngineRanError(Exception):
    """A truth has made a step of an engine."""


def raise_it(*arguments):
    raise EngineRanError


def truth_runs_an_engine(scene, p):
    """Return whether the truth of this case is computed by an engine, apart from what is cached."""
    for value in vars(sys.modules[scene.truth.__module__]).values():
        getattr(value, "cache_clear", lambda: None)()
    try:
        scene.truth(p, scene.duration)
    except EngineRanError:
        return True
    return False


QUICK = {"card_house", "dominoes", "machine", "oscillator", "rocking_block", "moving_wedge"}


@pytest.mark.parametrize("name", [pytest.param(n, marks=[] if n in QUICK else [pytest.mark.long])
                                  for n in modules.scene_names()])
def test_no_engine_is_its_own_judge(name, monkeypatch):
    """Where a truth is a run of pymunk or pybullet, some runner of the scene says so; elsewhere none does."""
    monkeypatch.setattr("pymunk.Space.step", raise_it)
    monkeypatch.setattr("validate.engines.bullet.Bullet.step", raise_it)
    scene = modules.bind_scene(name)
    for case, p in scene.cases.items():
        assert any(r.is_reference(p) for r in scene.runners) is truth_runs_an_engine(scene, p), case
