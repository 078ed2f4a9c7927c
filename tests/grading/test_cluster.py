"""A class on a Dask cluster: a scheduler and two workers on the loopback, all of them real processes.

Without the package distributed these tests fail, with the remedy; they are never skipped.
"""

import importlib.util
import pickle
import shutil
import subprocess
import sys

import psutil
import pytest

from solutions.checks import BadInput
from tests.dask_here import UP_WITHIN, client_of, cluster_of, until, worker
from validate.grading import cluster, marking
from validate.grading.submissions import Submission
from validate.subject.modules import ROOT

pytestmark = pytest.mark.xdist_group("cluster")
LESSON = "inertia_tensors"   # its tests are the quickest


@pytest.fixture(autouse=True)
def _with_dask(request):
    if "missing" not in request.node.name and not importlib.util.find_spec("distributed"):
        pytest.fail("the package distributed is not installed, so grading on a cluster cannot be tested: "
                    "pip install -c constraints.txt -e '.[cluster]'", pytrace=False)


def left_over(dask_scheduler):
    return len(dask_scheduler.tasks), sum(name.startswith("Client-") for name in dask_scheduler.clients)


@pytest.fixture(scope="module")
def settings():
    return marking.settings([LESSON], "a secret")


def small_class():
    """Eight students: all right (2), nothing (2), no file, a syntax error, half of it, and one who prints."""
    worked = (ROOT / "solutions" / f"{LESSON}.py").read_text().replace("from .", "from solutions.")
    blank = (ROOT / "lessons" / f"{LESSON}.py").read_text()
    half = worked.replace("def box_inertia", "def another_name")
    texts = {
        "ada": worked,
        "bea": blank,
        "cyd": None,
        "dov": "def box_inertia(:\n",
        "eve": half,
        "fay": "print('ö\\x07')\n" + blank,
        "gus": worked,
        "hal": blank,
    }
    files = {name: {LESSON: text.encode()} if text else {} for name, text in texts.items()}
    return [Submission(name, files[name], (), "2026-11-30T23:59:00") for name in texts]


def without_time(result):
    return {name: value for name, value in result.items() if name != "seconds"}


@pytest.mark.long
def test_a_killed_worker_loses_no_submission_and_none_is_counted_twice(tmp_path, settings):
    everyone = small_class()
    with cluster_of(2, tmp_path) as (address, workers):
        coming = cluster.results(address, everyone, settings)
        came = [next(coming)]
        victim = psutil.Process(workers[0].pid)
        until(victim.children)                                         # until it is grading
        victim.kill()
        came += coming
    assert sorted(student for student, _, _ in came) == [s.student for s in everyone]
    assert not any(why for _, _, why in came)
    found = {student: without_time(result) for student, result, _ in came}
    for submission in everyone:
        if submission.student in ("ada", "fay"):
            assert found[submission.student] == without_time(marking.mark(submission, settings))       # here
    assert found["gus"]["tests"] == found["ada"]["tests"]
    assert found["hal"]["tests"] == found["bea"]["tests"] == found["fay"]["tests"]
    earned = {s: sum(t["earned"] for t in found[s]["tests"]) for s in ("ada", "bea", "cyd", "dov")}
    assert earned == {"ada": 20.0, "bea": 0, "cyd": 0, "dov": 0}


@pytest.mark.long
def test_the_processes_of_a_killed_worker_end_with_it(settings):
    hangs = Submission("kim", {LESSON: b"while True:\n    pass\n"}, (), "")      # for IMPORT_WITHIN, 10 s
    command = "import sys; from validate.grading import cluster; cluster.asked(sys.stdin.buffer.read())"
    pipes = {"stdin": subprocess.PIPE, "stderr": subprocess.DEVNULL}
    with subprocess.Popen([sys.executable, "-c", command], cwd=ROOT, **pipes) as process:
        process.stdin.write(cluster.parcel(hangs, settings))
        process.stdin.close()
        like_a_worker = psutil.Process(process.pid)
        until(lambda: len(like_a_worker.children(recursive=True)) >= 2)                # grading process and sandbox
        begun = like_a_worker.children(recursive=True)
        process.kill()
        assert not psutil.wait_procs(begun, timeout=UP_WITHIN)[1]                       # it looks once a second


@pytest.mark.long
def test_a_failure_of_the_grader_or_of_the_cluster_is_reported_without_points(tmp_path, settings, monkeypatch):
    monkeypatch.setattr(cluster, "WORKERLESS", 2.0)
    no_bytes = Submission("ivy", {LESSON: None}, (), "")
    with cluster_of(1, tmp_path) as (address, workers):
        (student, result, why), = cluster.results(address, [no_bytes], settings)
        assert (student, result) == ("ivy", None) and "AttributeError" in why
        coming = cluster.results(address, small_class(), settings)
        came = [next(coming)]
        workers[0].kill()
        came += coming
    assert sorted(student for student, _, _ in came) == [s.student for s in small_class()]
    assert came[0][1] and all(result is None and address in why for _, result, why in came[1:])


@pytest.mark.long
def test_an_interrupted_run_leaves_nothing_waiting_on_the_cluster(tmp_path, settings):
    with cluster_of(1, tmp_path) as (address, _):
        coming = cluster.results(address, small_class()[1:], settings)
        next(coming)
        coming.close()                                                 # as when Ctrl-C ends the loop over results
        with client_of(address) as client:
            until(lambda: client.run_on_scheduler(left_over) == (0, 1))                 # no task, and only this client


@pytest.mark.long
def test_a_workbook_elsewhere_is_accepted_and_one_that_differs_is_refused(tmp_path, settings):
    copy = tmp_path / "workbook"
    for package in ("solutions", "lessons", "validate", "tests"):
        shutil.copytree(ROOT / package, copy / package, ignore=shutil.ignore_patterns("__pycache__"))
    with cluster_of(0, tmp_path) as (address, _):
        process = worker(address, folder=copy)
        try:
            with client_of(address) as client:
                client.wait_for_workers(1, timeout=UP_WITHIN)
                cluster.fit(client, address, settings)
                with open(copy / "tests" / "lessons" / f"test_{LESSON}.py", "a") as file:
                    file.write("# another version\n")
                why = f"is with workbook .* instead of {settings.code}: give it"
                with pytest.raises(BadInput, match=f"worker at tcp.* {why}"):
                    cluster.fit(client, address, settings)
            with pytest.raises(BadInput, match="instead of"):
                cluster.results(address, small_class(), settings)
        finally:
            process.kill()
            process.wait()


@pytest.mark.long
def test_a_worker_that_is_refused_when_a_submission_reaches_it_ends_the_run(settings):
    theirs = pickle.dumps((small_class()[1], settings, cluster.makeup("another digest"), {}, None))
    unfit, result, why = cluster.asked(theirs)
    assert "instead of another digest" in unfit and result is None and not why
    for arrived in (unfit, result, why), ModuleNotFoundError("No module named 'tests'"):
        with pytest.raises(BadInput, match="a worker that came later"):
            cluster.fetched(Done(arrived))


class Done:
    """A future that has ended, with a value or an error."""

    def __init__(self, value):
        self.value = value

    def result(self):
        if isinstance(self.value, Exception):
            raise self.value
        return self.value


@pytest.mark.long
def test_a_grading_process_that_breaks_is_an_error_of_the_grader(settings):
    assert cluster.fetched(Done(RuntimeError("a worker\ndied"))) == (None, "RuntimeError: a worker died")
    with pytest.raises(RuntimeError, match=r"ended unexpectedly .*TypeError"):
        cluster.asked(pickle.dumps((None, settings, None, {}, None)))


@pytest.mark.long
def test_an_address_without_a_cluster_is_reported_in_one_sentence(tmp_path, settings, monkeypatch):
    monkeypatch.setattr(cluster, "CONNECT_WITHIN", 1.0)
    for address, said in (("here", "not an address"), ("tcp://127.0.0.1:1", "no Dask scheduler that answers")):
        with pytest.raises(BadInput, match=f"{address}.* is {said}.*: ") as error:
            cluster.results(address, small_class(), settings)
        assert "\n" not in str(error.value)
    why = "is a scheduler without workers: start"
    with cluster_of(0, tmp_path) as (address, _), pytest.raises(BadInput, match=f"{address} {why}"):
        cluster.results(address, small_class(), settings)


def test_a_missing_package_is_named_with_its_remedy(settings, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(BadInput, match=r"distributed is not installed: .*pip install"):
        cluster.results("tcp://127.0.0.1:1", small_class(), settings)


@pytest.mark.long
def test_an_empty_class_needs_no_cluster(settings):
    assert list(cluster.results("tcp://127.0.0.1:1", [], settings)) == []
