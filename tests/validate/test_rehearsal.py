"""A rehearsed run is the same run, without its checks and look-ups."""

from types import SimpleNamespace

import numpy as np
import pytest

from validate.measure.preparation import built, looked_up
from validate.measure.rehearsal import rehearsed
from validate.measure.selection import Plan, select
from validate.measure.timing import time_ours
from validate.subject import modules
from validate.subject.numba_twins import CachedDispatch

pytestmark = pytest.mark.skipif(not modules.can_compile(), reason="numba is not installed here")


class Counting(CachedDispatch):
    """A function that counts how often it is looked up; its machine code is a list of what it is called with."""

    def __init__(self):
        self.known, self.asked, self.called_with = {}, 0, []

    def __call__(self, *arguments):
        self.asked += 1
        return super().__call__(*arguments)

    def machine_code(self, arguments):
        kinds = [type(a).__name__ for a in arguments]
        return lambda *values: self.called_with.append((kinds, values))


def lessons_with(**functions):
    return SimpleNamespace(springs=SimpleNamespace(**functions, NUMBER=3))


def test_a_rehearsed_function_is_not_looked_up_again():
    f = Counting()

    def run(lessons, step):
        lessons.springs.f(2.0, lessons.springs.NUMBER)
    again = rehearsed(lessons_with(f=f), None, run)
    assert f.asked == 1
    run(*again)
    assert f.asked == 1
    assert f.called_with == 2 * [(["float", "int"], (2.0, 3))]


def test_a_function_of_several_kinds_is_looked_up_in_each_call():
    f = Counting()

    def run(lessons, step):
        lessons.springs.f(2.0)
        lessons.springs.f(2)
    run(*rehearsed(lessons_with(f=f), None, run))
    assert f.asked == 4
    assert f.called_with == 2 * [(["float"], (2.0,)), (["int"], (2,))]


def test_a_function_that_is_an_argument_stays_itself():
    """Also in a record or a tuple, and also where the run calls it as well."""
    f, g = Counting(), Counting()

    def run(lessons, step):
        lessons.springs.f(1.0)
        lessons.springs.g((lessons.springs.f, 2.0))
    run(*rehearsed(lessons_with(f=f, g=g), None, run))
    assert [values for _, values in g.called_with] == 2 * [((f, 2.0),)]


def test_a_run_still_finds_out_which_step_it_takes():
    f, g = Counting(), Counting()
    ways = []

    def run(lessons, step):
        ways.append((step is lessons.springs.f, step is lessons.springs.g))
        step(1.0)
    run(*rehearsed(lessons_with(f=f, g=g), f, run))
    assert ways == 2 * [(True, False)] and (f.asked, g.asked) == (1, 0)


@pytest.fixture(scope="module")
def throw():
    """The scene `throw`, compiled, with a method and its arguments for ten steps."""
    selection = select("throw", Plan(live=()))
    runner = next(r for r in selection.ours_for(selection.first[1]) if r.label == "midpoint")
    return selection, runner, *selection.bound(runner, "compiled")


@pytest.mark.parametrize("name", [
    pytest.param(name, marks=[] if name == "throw" else [pytest.mark.long]) for name in modules.scene_names()])
def test_a_loop_on_the_clock_ends_where_the_scene_does(name):
    """Also when it runs again: machine code that was found for one run fits the next."""
    selection = select(name, Plan(quick=False, live=()))
    p, steps = selection.first[1], selection.steps[0]
    dt = selection.scene.duration / steps
    for runner in selection.ours_for(p):
        scene, step = selection.bound(runner, "compiled")
        try:
            ends = scene.run(scene.lessons, step, scene.law, scene.start(p), p, dt, steps)
        except ArithmeticError:                                      # a step that is too long is not timed
            continue
        loop, _ = time_ours(scene, step, p)(steps, dt)
        for _ in range(2):
            np.testing.assert_equal(scene.observe(loop(), p), scene.observe(ends, p), runner.label)


def test_what_comes_before_the_clock_is_measured(throw):
    selection, runner, *_ = throw
    ours = looked_up(selection, runner, selection.first[1], 10)
    assert ours["label"] == "midpoint" and 0.0 < ours["seconds"] < np.median(ours["with"])

    made = []
    world = SimpleNamespace(close=lambda: made.append("closed"))
    engine = SimpleNamespace(label="theirs", who=SimpleNamespace(make=lambda p, dt: world))
    theirs = built(engine, selection.first[1], 0.1)
    assert theirs["seconds"] == np.median(theirs["with"]) and not theirs["without"]
    assert len(made) == len(theirs["with"])
