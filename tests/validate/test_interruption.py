"""A run ends at once when it should: no process stays, nothing that was finished is lost, and the next run goes on.

The runs are real: `validate` in processes of its own, with answers that wait for as long as a certain file exists.
Every process of a run holds the pipe of its standard output, so the pipe ends when the last of them has ended.
"""

import os
import shutil
import signal
import subprocess
import sys
import time

import pytest

from validate.subject.generate import exercises, stub
from validate.subject.modules import ROOT, SOLUTIONS, can_compile

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals, disks and limits are those of POSIX")
PROMISED = 2.0               # a run may take so long to end [s]
PATIENCE = 20 * PROMISED     # so much on a busy machine
BEGINNING = 120.0            # a busy machine may take so long to get to work [s]


@pytest.fixture(autouse=True)
def signals_arrive():
    """In the background of a shell, pytest and the processes that it starts would ignore Ctrl-C."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


WAIT = """
import pathlib
worked, folder = world_inverse_inertia, pathlib.Path({folder!r})

def world_inverse_inertia(I_body, R):
    while (folder / "hold").exists():
        try:
            (folder / "busy").touch()
        except BaseException:
            pass
    return worked(I_body, R)
"""


@pytest.fixture
def held(tmp_path):
    """A folder with answers to lesson 4: its cases make a file `busy` and wait until the file `hold` is gone."""
    source = (SOLUTIONS / "inertia_tensors.py").read_text(encoding="utf-8")
    (tmp_path / "answers").mkdir()
    answers = stub(source, exercises(source)) + WAIT.format(folder=str(tmp_path))
    (tmp_path / "answers" / "inertia_tensors.py").write_text(answers, encoding="utf-8")
    (tmp_path / "hold").touch()
    yield tmp_path
    (tmp_path / "hold").unlink(missing_ok=True)


def command(out, *more):
    return [sys.executable, "-m", "validate", "--scene", "tensors", "--plain", "--jobs", "1", "--out", str(out), *more]


def ended(*words):
    """A command that ran to its end."""
    return subprocess.run(words, cwd=ROOT, capture_output=True, text=True)


def started(folder, *more):
    """A run that has kept the errors of its scene and is busy with stability cases, in a process group of its own."""
    run = subprocess.Popen(command(folder / "report", "--of", str(folder / "answers"), *more), cwd=ROOT,
                           stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True)
    deadline = time.monotonic() + BEGINNING
    while not ((folder / "busy").exists() and errors(folder).exists()):
        assert run.poll() is None and time.monotonic() < deadline, end_of(run)
        time.sleep(0.01)
    return run


def errors(folder):
    return folder / "report" / "results" / "tensors.errors.json"


def end_of(run):
    """The output of a run, once it and all of its processes have ended."""
    try:
        return run.communicate(timeout=PATIENCE)[0]
    except subprocess.TimeoutExpired:
        os.killpg(run.pid, signal.SIGKILL)
        pytest.fail(f"after {PATIENCE} s there are still processes: {run.communicate()[0]}")


def press(run, number, times):
    """Send a signal to all processes of a run, as a terminal does for Ctrl-C, so many times or until the run ends."""
    for _ in range(times):
        if run.poll() is not None:
            return
        os.killpg(run.pid, number)
        time.sleep(0.02)


@pytest.mark.long
@pytest.mark.parametrize(("number", "times", "jobs"), [
    (signal.SIGINT, 1, 2), (signal.SIGINT, 2, 1), (signal.SIGINT, 500, 2), (signal.SIGTERM, 1, 1),
], ids=["Ctrl-C", "twice", "again and again", "SIGTERM"])
def test_a_run_that_is_interrupted_says_so_once_leaves_no_process_and_keeps_what_is_finished(held, number, times, jobs):
    run = started(held, "--jobs", str(jobs))
    press(run, number, times)
    said = end_of(run)
    assert run.returncode == 128 + number and said.count("Interrupted.") == 1, said
    assert "Traceback" not in said and "Error" not in said, said
    assert errors(held).is_file() and not list(held.rglob("*.part")) and not (held / "report" / "index.html").exists()


@pytest.mark.long
def test_a_killed_run_leaves_no_worker_and_its_folder_is_free_again_but_two_runs_never_share_one(held):
    run = started(held)
    kept = errors(held).stat().st_mtime_ns
    second = ended(*command(held / "report"))
    assert second.returncode == 2 and "in use by another run" in second.stderr, second.stderr
    assert len(second.stderr.splitlines()) == 1

    run.kill()
    end_of(run)
    assert run.returncode == -signal.SIGKILL
    (held / "hold").unlink()
    third = ended(*command(held / "report", "--of", str(held / "answers")))
    assert third.returncode == 0 and "The report lies in" in third.stdout, third.stdout + third.stderr
    assert errors(held).stat().st_mtime_ns == kept and (held / "report" / "tensors.html").is_file()


LIMITED = ("sh", "-c", 'ulimit -f $0; exec "$@"')                    # to files of so many blocks of 512 bytes


def test_a_file_that_cannot_be_written_is_named_in_one_sentence(tmp_path):
    run = ended(*LIMITED, "8", *command(tmp_path / "report"))
    assert run.returncode == 2 and "tensors.errors.json" in run.stderr and "too large" in run.stderr, run.stderr
    assert len(run.stderr.splitlines()) == 1 and not list(tmp_path.rglob("*.part"))


COMPILED = """
import pathlib, sys
import numpy as np
from validate.subject import modules, numba_twins
numba_twins.CACHE = pathlib.Path(sys.argv[1])
vectors = modules.module_set("solutions", compiled=True).lesson("vectors")
print(vectors.dot(np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0, 6.0])))
"""


@pytest.mark.long
@pytest.mark.skipif(not can_compile(), reason="numba is not installed")
def test_compiled_code_that_the_disk_does_not_take_runs_all_the_same(tmp_path):
    run = ended(*LIMITED, "1", sys.executable, "-c", COMPILED, str(tmp_path))
    assert run.stdout == "32.0\n", run.stderr
    assert not [path for path in tmp_path.rglob("*.nbc") if path.stat().st_size > 512]


FULL_DISK = """
mount -t tmpfs -o size=8m none "$0" || exit 77
head -c $((8 * 1024 * 1024 - 80 * 1024)) /dev/zero > "$0/filler"
"$@"; echo "code $?"
find "$0/report" -name "tensors.errors.json" -o -name "*.part"
touch -d 2001-01-01 "$0/report/results/tensors.errors.json"
rm "$0/filler"
"$@"; echo "code $?"
find "$0/report" -name "tensors.errors.json" -newermt 2002-01-01 -o -name index.html
"""


@pytest.mark.long
def test_a_full_disk_ends_a_run_in_one_sentence_and_with_room_again_it_goes_on(tmp_path):
    if not shutil.which("unshare"):
        pytest.skip("a small disk needs unshare and mount, as Linux has them")
    report = tmp_path / "report"
    mounting = "unshare", "--user", "--map-root-user", "--mount", "sh", "-c", FULL_DISK, str(tmp_path)
    run = ended(*mounting, *command(report))
    if run.returncode == 77 or "unshare" in run.stderr:
        pytest.skip(f"a small disk cannot be mounted here: {run.stderr.strip()}")
    assert "No space left on device" in run.stderr and len(run.stderr.splitlines()) == 1, run.stderr
    first, second = run.stdout.partition("code 2\n")[2].split("code 0\n")
    assert first.splitlines()[0] == str(report / "results" / "tensors.errors.json") and ".part" not in first
    assert second.splitlines() == [str(report / "index.html")]       # the errors were not computed again
