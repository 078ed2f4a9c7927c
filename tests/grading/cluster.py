"""`grade --executor tcp://HOST:PORT`: the submissions go to a running Dask cluster, and come back marked.

A worker grades each submission in a process of its own, started from the workbook that lies there: so one test run never meets another
in a process, however many threads a worker has, and what kills the grading does not kill the worker.  --nthreads of a worker is how many
submissions it grades at a time.  A cluster runs what anybody sends who reaches its ports: keep it in a network of your own.
"""

import json
import os
import pickle
import queue
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from collections import deque
from importlib.metadata import version

from solutions.checks import BadInput
from validate import modules

from . import children, local, marking, sandbox

CONNECT_WITHIN = 5.0         # [s]: a scheduler answers in milliseconds
WORKERLESS = 30.0            # so long a cluster may be without any worker [s]: a nanny starts a new one in 2
LOOK_AFTER = 1.0             # while nothing comes, see so often whether the cluster is still there [s]
AHEAD = 4                    # submissions that wait on the cluster for each that is being graded [-]: all of a large class would fill the scheduler's memory


# ---------------------------------------------------------------------------------------------- here

def results(address, todo, settings):
    """(student, result, "") or (student, None, why the grader failed), as they come, each student once.

    Raises BadInput when there is no such cluster, no worker, or one whose workbook is not the same as here.
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


def connected(address):
    """A client of the scheduler there."""
    if not re.fullmatch(r"\w+://\S+:\d+", address):
        raise BadInput(f"--executor {address!r}", "not an address", "write it like tcp://127.0.0.1:8786")
    try:
        from distributed import Client
    except ImportError:
        raise BadInput("the package distributed", "not installed", "--executor needs it: pip install -c constraints.txt -e '.[cluster]'") from None
    try:
        return Client(address, timeout=CONNECT_WITHIN, set_as_default=False)
    except (OSError, ValueError) as e:
        raise BadInput(f"--executor {address}", f"no Dask scheduler that answers ({type(e).__name__})",
                       "start one there with `dask scheduler`, and name the address that it prints") from None


def fit(client, address, settings):
    """Raise BadInput unless there are workers, and each would mark as this machine does."""
    try:
        client.wait_for_workers(1, timeout=CONNECT_WITHIN)
    except TimeoutError:
        raise BadInput(f"--executor {address}", "a scheduler without workers",
                       f"start one on each machine, where the workbook is: `dask worker {address}`") from None
    try:
        client.run_on_scheduler(makeup, settings.code)                 # it unpacks what passes through
    except Exception as e:
        raise refusal(f"the scheduler at {address}", without_workbook(e)) from None
    for worker, answer in client.run(asked, parcel(None, settings), on_error="return").items():
        unfit = without_workbook(answer) if isinstance(answer, Exception) else answer[0]
        if unfit:
            raise refusal(f"the worker at {worker}", unfit)


def without_workbook(error):
    return f"without a workbook that runs ({in_a_line(error)})"


def in_a_line(error):
    return " ".join(f"{type(error).__name__}: {error}".split())


def refusal(thing, unfit):
    return BadInput(thing, unfit, "give it the workbook and the locked versions that are here, start it again, and repeat the command")


def parcel(submission, settings, first=None):
    """What travels to a worker: everything that it needs, as bytes.  first: the result of a first try, of which a part is done again."""
    return pickle.dumps((submission, settings, makeup(settings.code), sandbox.private, first))


def makeup(code):
    """What marks depend on besides the submission: {thing: which}."""
    return {"workbook": code, "Python": f"{sys.version_info.major}.{sys.version_info.minor}", "numpy": version("numpy"),
            "pytest": version("pytest"), "sandbox": sandbox.unavailable() or "bubblewrap"}


def graded(client, address, todo, settings):
    """Hand everything over, and wait.  What timed out or failed is tried once more at the end, when a machine does nothing else."""
    again = []
    try:
        for submission, result, why in outcomes(client, address, [(submission, None) for submission in todo], settings):
            if workers_of(client) and (why or result["again"]):
                again.append((submission, result))
            else:
                yield submission.student, result, why
        machines = {worker.rpartition(":")[0]: worker for worker in workers_of(client)}
        for submission, result, why in outcomes(client, address, again, settings, [*machines.values()]):
            yield submission.student, result, why
    finally:                                                           # also when the run is interrupted: what waits is cancelled with it
        client.close(timeout=CONNECT_WITHIN)


def outcomes(client, address, todo, settings, alone=None):
    """(submission, result, why), as they come.  Dask gives what a dead worker had to another one.  alone: workers that do one at a time."""
    waiting, running, finished, seen = deque(todo), {}, queue.Queue(), time.monotonic()
    free, room = deque(alone or ()), threads_of(client)
    while waiting or running:
        while waiting and (free if alone else len(running) < AHEAD * room):
            submission, first = waiting.popleft()
            place = {"workers": [free.popleft()], "allow_other_workers": True} if alone else {}          # if that one has gone
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
    """How many submissions the cluster grades at a time; 0 when it does not answer."""
    return sum(workers_of(client).values())


def workers_of(client):
    """{address of a worker: its threads}; none when the scheduler does not answer."""
    try:
        return dict(client.nthreads()) if client.status == "running" else {}
    except Exception:                                                  # whatever Dask says when it is cut off
        return {}


def fetched(future):
    """(result, "") or (None, why the grader failed)."""
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
    """(why this worker may not grade, result, why the grader failed), from a process of its own.  Raises RuntimeError when that breaks."""
    patience = marking.patience(pickle.loads(parcel)[1])
    try:
        run = subprocess.run([sys.executable, "-m", __name__], cwd=modules.ROOT, input=parcel, capture_output=True, timeout=patience)
    except subprocess.TimeoutExpired:
        raise RuntimeError(f"the grading process did not end within {patience:g} s") from None
    try:
        return tuple(json.loads(run.stdout))
    except ValueError:
        last = run.stderr.decode(errors="replace").strip().splitlines()[-1:]
        raise RuntimeError(f"the grading process ended unexpectedly ({run.returncode}): {' '.join(last)[:300]}") from None


def answer(submission, settings, theirs, private, first=None):
    """What `asked` returns, in the process of its own; without a submission only whether this worker may grade.  private: what the sandbox must hide, if it is here, too."""
    try:
        sandbox.keep_out(private)
    except BadInput as e:
        return str(e), None, ""
    ours = makeup(marking.code_digest(settings.lessons))
    unfit = "; ".join(f"with {thing} {ours[thing]} instead of {theirs[thing]}" for thing in theirs if ours[thing] != theirs[thing])
    return (unfit, None, "") if unfit or submission is None else ("", *local.marked(submission, settings, first))


def orphaned(parent, folder):
    """End when the worker does: another one grades this again."""
    while os.getppid() == parent:
        time.sleep(1.0)
    shutil.rmtree(folder, ignore_errors=True)
    os._exit(1)


def main():
    channel = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)                                                      # nothing else may get in between
    with children.temporary() as tempfile.tempdir:
        threading.Thread(target=orphaned, args=(os.getppid(), tempfile.tempdir), daemon=True).start()
        json.dump(answer(*pickle.load(sys.stdin.buffer)), channel)
        channel.close()


if __name__ == "__main__":
    main()
