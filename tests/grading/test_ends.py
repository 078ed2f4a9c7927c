"""However a run ends, no process and no file of it stays behind."""

import contextlib
import fcntl
import os
import signal
import subprocess
import sys
import time

import psutil
import pytest

from validate.grading import children, sandbox
from validate.subject.modules import ROOT

WITHIN = 600.0              # [s]: only a run that hangs takes so long, on the busiest machine, too


@pytest.fixture(scope="module", autouse=True)
def _sandbox():
    sandbox.for_tests(pytest.skip, pytest.fail)


def until(true):
    limit = time.monotonic() + WITHIN
    while not true():
        assert time.monotonic() < limit
        time.sleep(0.2)                                # to look at all processes takes a while


@pytest.fixture(params=["bubblewrap", pytest.param("chroot", marks=pytest.mark.long)])
def run(request, tmp_path):
    """`grade` at work, with its sandboxes running: forty files sleep until they are given up, after some seconds each.

    Loops without end would take the time of the processor from all other tests.
    """
    if reason := sandbox.broken(request.param):
        pytest.skip(reason)
    for student in range(40):
        (tmp_path / "class" / f"student {student}").mkdir(parents=True)
        (tmp_path / "class" / f"student {student}" / "integrators.py").write_text("import time\ntime.sleep(1e6)\n")
    (tmp_path / "temporary").mkdir()
    folders = [str(tmp_path / "class"), "--out", str(tmp_path / "out")]
    command = [sys.executable, "-m", "validate.grading", *folders, "--lesson", "integrators", "--jobs", "2"]
    environment = {**os.environ, "TMPDIR": str(tmp_path / "temporary"), "WORKBOOK_SANDBOX_BY": request.param}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    process = subprocess.Popen(command, cwd=ROOT, env=environment, **pipes)
    try:
        until(lambda: len(called("worker.py", process)) >= 2)
        yield process
    finally:
        process.kill()
        process.communicate()


def family(process):
    try:
        return psutil.Process(process.pid).children(recursive=True)
    except psutil.NoSuchProcess:
        return []


def called(word, process):
    """Those of its family that have a word in their command line."""
    found = []
    for child in family(process):
        with contextlib.suppress(psutil.NoSuchProcess):                # it may end at any time
            found += [child] * (word in " ".join(child.cmdline()))
    return found


@pytest.mark.parametrize("number", [signal.SIGKILL, *(pytest.param(number, marks=pytest.mark.long)
                                                      for number in (signal.SIGTERM, signal.SIGINT))],
                         ids=lambda number: number.name)
def test_a_run_that_is_ended_takes_its_children_and_its_files_along(number, run, tmp_path):
    begun = family(run)
    run.send_signal(number)
    said, _ = run.communicate(timeout=WITHIN)
    assert not psutil.wait_procs(begun, timeout=WITHIN)[1]
    until(lambda: not os.listdir(tmp_path / "temporary"))
    assert run.returncode == (-9 if number == signal.SIGKILL else 128 + number)
    assert number == signal.SIGKILL or "the same command goes on from there" in " ".join(said.split())


@pytest.mark.long
def test_a_grading_process_that_is_killed_is_replaced(run, tmp_path):
    victim = next(child for child in called("spawn_main", run) if child.children())
    victim.kill()
    until(lambda: not victim.is_running() and called("worker.py", run))
    run.terminate()
    run.communicate(timeout=WITHIN)
    until(lambda: not os.listdir(tmp_path / "temporary"))


def test_what_a_killed_run_has_left_is_removed_by_the_next(tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    folders = {name: tmp_path / f"{children.PREFIX}{name}" for name in ("left", "at_work", "young")}
    for folder in folders.values():
        (folder / "handout").mkdir(parents=True)
    (tmp_path / f"{children.PREFIX}link").symlink_to(tmp_path / "other")
    (tmp_path / "other").mkdir()
    for name in ("left", "at_work"):
        os.utime(folders[name], (1.0, 1.0))
    descriptor = os.open(folders["at_work"], os.O_RDONLY)
    fcntl.flock(descriptor, fcntl.LOCK_EX)
    with children.temporary() as folder:
        kept = [f"{children.PREFIX}{name}" for name in ("at_work", "link", "young")]
        assert sorted(os.listdir(tmp_path)) == sorted([os.path.basename(folder), "other", *kept])
        os.utime(folder, (1.0, 1.0))
        children.remove_leftovers()
        assert os.path.isdir(folder)                                   # it is at work itself
    os.close(descriptor)
    assert not os.path.isdir(folder)
