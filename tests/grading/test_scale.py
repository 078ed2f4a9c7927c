"""The simulation of a large class: its arithmetic, and what a lost worker costs."""

import random

import pytest
import typer

from validate.grading import sandbox

from . import benchmark, rehearsal


@pytest.mark.long
@pytest.mark.parametrize("workers", [1, 2, 8, 64])
def test_no_submission_is_lost_and_no_worker_does_two_at_a_time(workers, monkeypatch):
    draw = random.Random(3)
    costs = [draw.uniform(1.0, 9.0) for _ in range(2000)]
    least = sum(costs) / workers
    monkeypatch.setattr(benchmark, "LOST", 0.0)
    whole = benchmark.makespan(costs, workers, random.Random(4))
    assert least <= whole <= least + max(costs)  # Graham's bound for any order
    monkeypatch.setattr(benchmark, "LOST", 0.01)
    after = benchmark.makespan(costs, workers, random.Random(4))
    survivors = workers - (workers > 1)
    assert whole <= after <= sum(costs) / survivors + 3.0 * max(costs)


def test_what_a_lost_worker_had_begun_is_done_by_another():
    class Half(random.Random):
        def random(self):
            return 0.5

    # 2 workers, 4 submissions of 10 s: 20 s each; one is lost after 10 s, between two, so 30 s remain for the other
    assert benchmark.makespan([10.0] * 4, 2, Half()) == 30.0
    # 5 of 8 s: one is lost after 10 s, in its second; the other does four in all
    assert benchmark.makespan([8.0] * 5, 2, Half()) == 32.0


@pytest.mark.long
def test_a_submission_costs_what_the_clock_says_and_the_start_of_its_process():
    results = {"ada": {"seconds": 4.0}, "bob": {"seconds": 3.0}, "eve": {"seconds": 2.0}, "lost": None}
    assert benchmark.costs_of(results, {"eve"}, start=0.5) == ([4.5, 3.5], [2.5])


@pytest.mark.long
def test_files_of_many_are_measured_on_results_that_differ(monkeypatch):
    assert len({benchmark.varied("a = 1\n" * 50, n) for n in range(20)}) == 20


@pytest.mark.long
def test_hostile_neighbours_cost_an_honest_class_nothing(tmp_path):
    sandbox.for_tests(pytest.skip, pytest.fail)
    (one,) = rehearsal.rehearse(tmp_path, 5, 1, [4])
    assert (one.honest, one.hostile, one.full) == (4, 1, 4) and one.fair()


@pytest.mark.long
def test_a_rehearsal_has_a_fifth_of_hostile_files_of_many_kinds(tmp_path):
    evil = rehearsal.make(tmp_path, 200)
    texts = [(tmp_path / student / "integrators.py").read_text() for student in evil]
    assert len(evil) == 40 == len(set(texts)) and len([*tmp_path.iterdir()]) == 200


@pytest.mark.long
def test_nothing_hostile_is_run_without_a_sandbox(monkeypatch):
    monkeypatch.setattr(sandbox, "unavailable", lambda: "there is none")
    monkeypatch.setattr(rehearsal, "rehearse", lambda *_: pytest.fail("it ran"))
    monkeypatch.setattr(benchmark, "class_of", lambda *_: pytest.fail("it ran"))
    for command in (benchmark.class_, benchmark.scale):
        with pytest.raises(typer.Exit) as end:
            command()
        assert end.value.exit_code == 2
