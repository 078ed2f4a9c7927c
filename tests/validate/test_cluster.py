"""`validate --executor`: the same results as here, also where a worker dies.

The scheduler and two workers are real processes on the loopback.
"""

import contextlib
import json
import multiprocessing
import os
import pickle
import shutil
import sys
import threading
import time
from itertools import pairwise

import psutil
import pytest

from solutions.checks import BadInput
from tests.dask_here import UP_WITHIN, cluster_of, until, worker
from validate import measure
from validate.__main__ import main
from validate.report.compare import changes
from validate.run import cluster, processes
from validate.subject.modules import ROOT

pytestmark = pytest.mark.xdist_group("sweep on a cluster")
THREADS = 2                  # of each worker, which makes one call at a time all the same
SCENES = ("stopping_block", "stick_slip", "incline")      # of one lesson, whose stability cases are short


def validate(out, *more):
    """Exit code of a run of a few scenes, without compiling."""
    named = [word for scene in SCENES for word in ("--scene", scene)]
    with pytest.raises(SystemExit) as end:
        main([*named, "--plain", "--engine", "pymunk", "--out", str(out), *more])
    return end.value.code


def raw(out):
    """What a report says but for times and for who measured it."""
    report = json.loads((out / "report.json").read_text())
    scenes = [{key: value for key, value in scene.items() if key != "times"} for scene in report["scenes"]]
    return report, scenes


@pytest.mark.long
def test_a_killed_worker_changes_nothing_in_the_report_but_times(tmp_path):
    assert validate(tmp_path / "here") == 0
    with cluster_of(2, tmp_path, THREADS) as (address, workers):
        kept, killed = tmp_path / "there" / "results", []

        def kill():                                                    # when something is measured, but not all of it
            until(lambda: len(list(kept.glob("*.errors.json"))) >= 2, within=30.0 * UP_WITHIN)
            killed.append(len(list(kept.glob("*.times.json"))))
            workers[0].kill()
        thread = threading.Thread(target=kill)
        thread.start()
        code = validate(tmp_path / "there", "--executor", address)
        thread.join()
    assert code == 0 and killed == [0]
    (before, here), (after, there) = raw(tmp_path / "here"), raw(tmp_path / "there")
    assert here == there
    assert before["stability"] == after["stability"]
    assert not [c for c in changes(before, after) if c.kind != "times"]
    assert "2 workers of a Dask cluster" in after["run"]["executor"] and not before["run"]["executor"]
    assert all(scene["times"]["rows"] for scene in after["scenes"])


@pytest.mark.long
def test_what_is_timed_has_a_machine_for_itself_and_other_calls_have_all_workers(tmp_path):
    with cluster_of(2, tmp_path, THREADS) as (address, _), cluster.cluster(address, "solutions") as pool:
        def measuring(alone):
            return {found for _, found in pool.each(dict.fromkeys(range(6), (process,)), alone=alone)}
        assert len(measuring(True)) == 1 and len(measuring(False)) == 2


def process():
    return os.getpid()


def a_while(seconds):
    begin = time.monotonic()
    time.sleep(seconds)
    return begin, time.monotonic()


@pytest.mark.long
def test_a_workbook_that_differs_is_refused(tmp_path):
    copy = tmp_path / "workbook"
    for package in ("solutions", "lessons", "validate", "tests"):
        shutil.copytree(ROOT / package, copy / package, ignore=shutil.ignore_patterns("__pycache__"))
    with cluster_of(0, tmp_path, THREADS) as (address, _):
        with pytest.raises(BadInput, match="a scheduler without workers"), cluster.cluster(address, "solutions"):
            pass
        process = worker(address, copy, THREADS)
        try:
            with contextlib.closing(cluster.connected(address)) as client:
                until(lambda: cluster.workers_of(client))
            with cluster.cluster(address, "solutions") as pool:
                assert list(pool.each({1: (pow, 2, 3)})) == [(1, 8)]
            with open(copy / "solutions" / "friction.py", "a") as file:
                file.write("# another version\n")
            with pytest.raises(BadInput, match=r"with workbook .* instead of"), cluster.cluster(address, "solutions"):
                pass
        finally:
            process.kill()
            process.wait()


@pytest.mark.long
def test_a_measuring_process_that_is_killed_is_replaced(tmp_path):
    with cluster_of(1, tmp_path, THREADS) as (address, workers), cluster.cluster(address, "solutions") as pool:
        coming = pool.each(dict.fromkeys(range(3), (time.sleep, 0.5)))
        came = [next(coming)]
        psutil.Process(workers[0].pid).children()[0].kill()
        came += coming
        assert sorted(key for key, _ in came) == [0, 1, 2]
        last = psutil.Process(workers[0].pid).children()
    assert not psutil.wait_procs(last, timeout=UP_WITHIN)[1]           # the run has ended


def test_a_workers_process_answers_many_calls_and_says_what_was_wrong():
    child, run = cluster.Child(), "a run"
    theirs = cluster.makeup("solutions")

    def ask(call, made=theirs):
        return cluster.Cluster.opened(child.ask(run, pickle.dumps((made, "solutions", call))), "here")
    try:
        assert ask(None) and ask((pow, 2, 5)) == 32 and ask((pow, 2, 6)) == 64
        with pytest.raises(BadInput, match="scene 'none'"):
            ask((measure.load, "none", "solutions"))
        with pytest.raises(BadInput, match=r"with workbook .* instead of another"):
            ask((pow, 2, 3), {**theirs, "workbook": "another"})
    finally:
        child.end(run)


@pytest.mark.parametrize("alone", [True, False])
def test_calls_that_are_timed_are_made_one_at_a_time(alone):
    ours, theirs = zip(*(multiprocessing.Pipe() for _ in range(2)), strict=True)

    def work(pipe):                                                    # as processes.work does, in a thread
        with contextlib.suppress(EOFError):
            while True:
                pipe.send(processes.outcome(*pipe.recv()))
    threads = [threading.Thread(target=work, args=(pipe,)) for pipe in theirs]
    for thread in threads:
        thread.start()
    found = processes.Workers(ours).each(dict.fromkeys(range(4), (a_while, 0.05)), alone=alone)
    spans = sorted(span for _, span in found)
    for pipe in ours:
        pipe.close()
    assert len(spans) == 4
    assert all(end <= begin for (_, end), (begin, _) in pairwise(spans)) is alone


def test_an_address_that_is_none_and_a_missing_package_are_said_in_one_sentence(monkeypatch, capsys, tmp_path):
    with pytest.raises(SystemExit) as end:
        main(["--scene", "throw", "--executor", "here", "--out", str(tmp_path)])
    assert end.value.code == 2 and "not an address" in capsys.readouterr().err
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(SystemExit) as end:
        main(["--scene", "throw", "--executor", "tcp://127.0.0.1:1", "--out", str(tmp_path)])
    assert end.value.code == 2 and "distributed is not installed" in capsys.readouterr().err
