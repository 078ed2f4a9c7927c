"""`grade --executor tcp://HOST:PORT`: mark the submissions on a running Dask cluster.

A worker grades each submission in a process of its own, started from the workbook on its machine.  Two test runs
therefore never share a process, and an error that kills the grading process does not kill the worker.  --nthreads of a
worker is the number of submissions that it grades at a time.  A cluster runs any code sent to its ports: keep it in a
network of your own.
"""

import json
import os
import pickle
import queue
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from collections import deque
from importlib.metadata import version

from solutions.checks import BadInput
from validate.run.scheduler import CONNECT_WITHIN, connected, in_a_line, refusal, without_workbook, workers_of
from validate.subject import modules

from . import children, local, marking, sandbox

WORKERLESS = 30.0            # time that a cluster may be without any worker [s]: a nanny starts a new one in 2
LOOK_AFTER = 1.0             # interval of checks that the cluster still answers [s]
AHEAD = 4                    # submissions sent per thread [-]: a whole large class would fill the scheduler's memory


# ---------------------------------------------------------------------------------------------- here

def results(address, todo, settings):
    """Generate (student, result, "") or (student, None, why the grader failed), each student once, in any order.

    Raises BadInput if there is no such cluster, no worker, or one whose workbook differs from this one.
    """
    if not todo:
        return iter(())
    client = connected(address)
    try:
        fit(client, address, settings)
    except BaseException:
        client.close()
        raise
    return graded(client, address, todo, settings)


def fit(client, address, settings):
    """Raise BadInput unless there are workers, and each would mark as this machine does."""
    try:
        client.wait_for_workers(1, timeout=CONNECT_WITHIN)
    except TimeoutError:
        remedy = f"start one on each machine, where the workbook is: `dask worker {address}`"
        raise BadInput(f"--executor {address}", "a scheduler without workers", remedy) from None
    try:
        client.run_on_scheduler(makeup, settings.code)                 # the scheduler unpickles messages, too
    except Exception as e:
        raise refusal(f"the scheduler at {address}", without_workbook(e)) from None
    for worker, answer in client.run(asked, parcel(None, settings), on_error="return").items():
        unfit = without_workbook(answer) if isinstance(answer, Exception) else answer[0]
        if unfit:
            raise refusal(f"the worker at {worker}", unfit)


def parcel(submission, settings, first=None):
    """Pickle everything that a worker needs.  first: the result of a first try, a part of which is repeated."""
    return pickle.dumps((submission, settings, makeup(settings.code), sandbox.private, first))


def makeup(code):
    """Return the versions on which marks depend besides the submission: {thing: version}."""
    return {
        "workbook": code,
        "Python": f"{sys.version_info.major}.{sys.version_info.minor}",
        "numpy": version("numpy"),
        "pytest": version("pytest"),
        "sandbox": sandbox.unavailable() or "bubblewrap",
    }


def graded(client, address, todo, settings):
    """Grade all submissions.  One that timed out or failed is tried again at the end, alone on a machine."""
    again = []
    first_tries = [(submission, None) for submission in todo]
    try:
        for submission, result, why in outcomes(client, address, first_tries, settings):
            if workers_of(client) and (why or result["again"]):
                again.append((submission, result))
            else:
                yield submission.student, result, why
        machines = {worker.rpartition(":")[0]: worker for worker in workers_of(client)}
        for submission, result, why in outcomes(client, address, again, settings, [*machines.values()]):
            yield submission.student, result, why
    finally:                                                           # an interrupted run also cancels what waits
        client.close(timeout=CONNECT_WITHIN)


def outcomes(client, address, todo, settings, alone=None):
    """Generate (submission, result, why), in any order.

    Dask gives the submissions of a dead worker to another one.  alone: workers that grade one at a time.
    """
    waiting, running, finished, seen = deque(todo), {}, queue.Queue(), time.monotonic()
    free, room = deque(alone or ()), threads_of(client)
    while waiting or running:
        while waiting and (free if alone else len(running) < AHEAD * room):
            submission, first = waiting.popleft()
            place = {}
            if alone:                                                  # other workers if that one has gone
                place = {"workers": [free.popleft()], "allow_other_workers": True}
            future = client.submit(asked, parcel(submission, settings, first), pure=False, retries=1, **place)
            running[future] = submission, place.get("workers", ())
            future.add_done_callback(finished.put)
        try:
            future = finished.get(timeout=LOOK_AFTER)
        except queue.Empty:
            now = threads_of(client)
            room, seen = now or room, time.monotonic() if now else seen
            if time.monotonic() - seen > WORKERLESS:
                break
            continue
        if future.status == "pending":                                 # its worker died after the last word
            future.add_done_callback(finished.put)
        elif future in running and future.status != "cancelled":       # cancelled: the scheduler is gone
            submission, place = running.pop(future)
            free.extend(place)
            yield submission, *fetched(future)
    for submission in [*(s for s, _ in running.values()), *(s for s, _ in waiting)]:
        yield submission, None, f"the cluster at {address} has gone away"


def threads_of(client):
    """Return the number of submissions that the cluster grades at a time; 0 if it does not answer."""
    return sum(workers_of(client).values())


def fetched(future):
    """Return (result, "") or (None, why the grader failed)."""
    try:
        unfit, result, why = future.result()
    except ImportError as e:
        raise refusal("a worker that came later or was changed", without_workbook(e)) from None
    except Exception as e:
        return None, in_a_line(e)
    if unfit:
        raise refusal("a worker that came later or was changed", unfit)
    return result, why


# ---------------------------------------------------------------------------------------------- on a worker

def asked(parcel):
    """Grade in a process of its own: (why this worker may not grade, result, why the grader failed).

    Raises RuntimeError if that process breaks.
    """
    patience = marking.patience(pickle.loads(parcel)[1])
    command = [sys.executable, "-m", __name__]
    try:
        run = subprocess.run(command, cwd=modules.ROOT, input=parcel, capture_output=True, timeout=patience)
    except subprocess.TimeoutExpired:
        raise RuntimeError(f"the grading process did not end within {patience:g} s") from None
    try:
        return tuple(json.loads(run.stdout))
    except ValueError:
        last = " ".join(run.stderr.decode(errors="replace").strip().splitlines()[-1:])[:300]
        raise RuntimeError(f"the grading process ended unexpectedly ({run.returncode}): {last}") from None


def answer(submission, settings, theirs, private, first=None):
    """Return what `asked` returns, in the process of its own.

    Without a submission, only check whether this worker may grade.  private: paths that the sandbox must hide.
    """
    try:
        sandbox.keep_out(private)
    except BadInput as e:
        return str(e), None, ""
    ours = makeup(marking.code_digest(settings.lessons))
    differ = [thing for thing in theirs if ours[thing] != theirs[thing]]
    unfit = "; ".join(f"with {thing} {ours[thing]} instead of {theirs[thing]}" for thing in differ)
    return (unfit, None, "") if unfit or submission is None else ("", *local.marked(submission, settings, first))


def orphaned(parent, folder):
    """End when the worker ends; another one grades the submission again."""
    while os.getppid() == parent:
        time.sleep(1.0)
    shutil.rmtree(folder, ignore_errors=True)
    os._exit(1)


def main():
    channel = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)                                                      # only the answer goes to standard output
    with children.temporary() as tempfile.tempdir:
        threading.Thread(target=orphaned, args=(os.getppid(), tempfile.tempdir), daemon=True).start()
        json.dump(answer(*pickle.load(sys.stdin.buffer)), channel)
        channel.close()


if __name__ == "__main__":
    main()
