"""A run ends at once when it should, whatever it is doing: nothing that was finished is lost, no process stays, and the next run goes on.

The runs are real: `validate` in processes of its own, on answers that make it wait for as long as a file is there.  Its standard output is a pipe
that every process of the run holds: it is read to its end only when all of them are gone.
"""

import os
import shutil
import signal
import subprocess
import sys
import time

import pytest

from validate.binding import ROOT, SOLUTIONS, can_compile
from validate.generate import exercises, stub

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals, disks and limits as POSIX has them")
PROMISED = 2.0               # how long the end of a run may take [s]
PATIENCE = 20 * PROMISED     # … where other work takes the machine
BEGINNING = 120.0            # how long the machine may take to get to work [s]


@pytest.fixture(autouse=True)
def signals_arrive():
    """pytest in the background of a shell ignores Ctrl-C, and what it starts would, too."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture
def held(tmp_path):
    """A folder with answers to lesson 4 whose stability cases wait, once they are being examined (`busy`), until `hold` is gone."""
    source = (SOLUTIONS / "inertia_tensors.py").read_text(encoding="utf-8")
    wait = f"""
import pathlib
worked, folder = world_inverse_inertia, pathlib.Path({str(tmp_path)!r})

def world_inverse_inertia(I_body, R):
    while (folder / "hold").exists():
        try:
            (folder / "busy").touch()
        except BaseException:
            pass
    return worked(I_body, R)
"""
    (tmp_path / "answers").mkdir()
    (tmp_path / "answers" / "inertia_tensors.py").write_text(stub(source, exercises(source)) + wait, encoding="utf-8")
    (tmp_path / "hold").touch()
    yield tmp_path
    (tmp_path / "hold").unlink(missing_ok=True)


def command(out, *more):
    return [sys.executable, "-m", "validate", "--scene", "tensors", "--plain", "--jobs", "1", "--out", str(out), *more]


def started(folder, *more):
    """A run in the middle of its work: the errors of its scene are kept, its stability cases are being examined.  It has a terminal's group of its own."""
    run = subprocess.Popen(command(folder / "report", "--of", str(folder / "answers"), *more), cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                           text=True, start_new_session=True)
    deadline = time.monotonic() + BEGINNING
    while not ((folder / "busy").exists() and finished(folder).exists()):
        assert run.poll() is None and time.monotonic() < deadline, run.communicate()[0]
        time.sleep(0.01)
    return run


def finished(folder):
    return folder / "report" / "results" / "tensors.errors.json"


def end_of(run):
    """What a run said, when it and all of its processes are gone."""
    try:
        return run.communicate(timeout=PATIENCE)[0]
    except subprocess.TimeoutExpired:
        os.killpg(run.pid, signal.SIGKILL)
        pytest.fail(f"after {PATIENCE} s there are still processes: {run.communicate()[0]}")


def press(run, number, times):
    """Send a signal to all processes of a run, as a terminal does for Ctrl-C, so many times or until it has ended."""
    for _ in range(times):
        if run.poll() is not None:
            return
        os.killpg(run.pid, number)
        time.sleep(0.02)


@pytest.mark.parametrize("number, times, jobs", [(signal.SIGINT, 1, 2), (signal.SIGINT, 2, 1), (signal.SIGINT, 500, 2), (signal.SIGTERM, 1, 1)],
                         ids=["Ctrl-C", "twice", "again and again", "SIGTERM"])
def test_a_run_that_is_told_to_end_says_so_once_leaves_no_process_and_keeps_what_is_finished(held, number, times, jobs):
    run = started(held, "--jobs", str(jobs))
    press(run, number, times)
    said = end_of(run)
    assert run.returncode == 128 + number and said.count("Interrupted.") == 1 and "Traceback" not in said and "Error" not in said, said
    assert finished(held).is_file() and not list((held / "report").rglob("*.part"))
    assert not (held / "report" / "index.html").exists()


def test_workers_end_with_a_run_that_is_killed_and_its_folder_is_free_for_the_next_but_never_for_two_at_once(held):
    run = started(held)
    kept = finished(held).stat().st_mtime_ns
    second = subprocess.run(command(held / "report"), cwd=ROOT, capture_output=True, text=True)
    assert second.returncode == 2 and "in use by another run" in second.stderr and len(second.stderr.strip().splitlines()) == 1, second.stderr

    run.kill()
    end_of(run)
    assert run.returncode == -signal.SIGKILL
    (held / "hold").unlink()
    third = subprocess.run(command(held / "report", "--of", str(held / "answers")), cwd=ROOT, capture_output=True, text=True)
    assert third.returncode == 0 and "The report lies in" in third.stdout, third.stdout + third.stderr
    assert finished(held).stat().st_mtime_ns == kept and (held / "report" / "tensors.html").is_file()


def test_a_file_that_cannot_be_written_is_named_in_one_sentence(tmp_path):
    limited = subprocess.run(["sh", "-c", 'ulimit -f 8; exec "$@"', "sh", *command(tmp_path / "report")], cwd=ROOT, capture_output=True, text=True)
    assert limited.returncode == 2 and "tensors.errors.json" in limited.stderr and "too large" in limited.stderr, limited.stderr
    assert len(limited.stderr.strip().splitlines()) == 1 and not list(tmp_path.rglob("*.part"))


@pytest.mark.skipif(not can_compile(), reason="numba is not installed")
def test_compiled_code_that_the_disk_does_not_take_is_compiled_all_the_same(tmp_path):
    code = """
import pathlib, sys
import numpy as np
from validate import binding
binding.CACHE = pathlib.Path(sys.argv[1])
vectors = binding.world("solutions", compiled=True).lesson("vectors")
print(vectors.dot(np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0, 6.0])))
"""
    limited = subprocess.run(["sh", "-c", 'ulimit -f 1; exec "$@"', "sh", sys.executable, "-c", code, str(tmp_path)], cwd=ROOT, capture_output=True, text=True)
    assert limited.stdout == "32.0\n", limited.stderr
    assert not [path for path in tmp_path.rglob("*.nbc") if path.stat().st_size > 512]


DISK = """
mount -t tmpfs -o size=800k none "$0" || exit 77
head -c $((720 * 1024)) /dev/zero > "$0/filler"
"$@"; echo "code $?"
ls "$0/report/results"; cd "$0/report" && find . -name "*.part"; touch -d "2001-01-01" results/tensors.errors.json; cd - > /dev/null
rm "$0/filler"
"$@"; echo "code $?"
find "$0/report" -name tensors.errors.json -newermt 2002-01-01 -o -name index.html
"""


def test_a_full_disk_ends_a_run_in_one_sentence_and_with_room_it_goes_on(tmp_path):
    if not shutil.which("unshare"):
        pytest.skip("a small disk cannot be made here: there is no unshare")
    run = subprocess.run(["unshare", "--user", "--map-root-user", "--mount", "sh", "-c", DISK, str(tmp_path), *command(tmp_path / "report")],
                         cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if run.returncode == 77 or "unshare:" in run.stdout:
        pytest.skip(f"a small disk cannot be made here: {run.stdout.strip()}")
    first, _, then = run.stdout.partition("code 2\n")
    assert "No space left on device" in first and first.count("validate: ") == 1 and "Traceback" not in run.stdout, run.stdout
    assert "tensors.errors.json" in then and ".part" not in then
    assert then.rstrip().endswith("code 0\n" + str(tmp_path / "report" / "index.html")), then             # and the errors were not computed again
