"""`validate --executor tcp://HOST:PORT`: measure on a running Dask cluster.

A worker measures in a process of its own, as a run on this machine does.  It makes one call at a time, also if its
--nthreads is larger.  Timed calls go to one worker of each machine, so that no other call of the run disturbs them.
A call of a worker that dies is repeated elsewhere.  A cluster runs any code sent to its ports: keep it in a network of
your own.
"""

import hashlib
import os
import pickle
import queue
import subprocess
import sys
import threading
import time
import uuid
from contextlib import contextmanager, suppress
from itertools import product

from solutions.checks import BadInput

from ..subject import modules
from .processes import Affinity, outcome
from .run import processor
from .scheduler import CONNECT_WITHIN, connected, in_a_line, refusal, without_workbook, workers_of
from .store import installed_versions, sources

WORKERLESS = 30.0            # time that a cluster may be without any worker [s]: a nanny starts a new one in 2
LOOK_AFTER = 1.0             # interval of checks that the cluster still answers [s]
TRIES = 3                    # of a call whose measuring process broke [-]


# ---------------------------------------------------------------------------------------------- here

class Cluster(Affinity):
    """The workers of a Dask cluster, as `processes.Workers` are those of this machine."""

    def __init__(self, client, address, of):
        super().__init__()
        self.client, self.address, self.of, self.run = client, address, of, uuid.uuid4().hex
        self.makeup, self.processors = makeup(of), []

    def __str__(self):
        return f"{len(self.processors)} workers of a Dask cluster ({', '.join(sorted(set(self.processors)))})"

    def parcel(self, call=None):
        """Pickle everything that a worker needs.  Without a call, it reports its processor if it may measure."""
        return pickle.dumps((self.makeup, self.of, call))

    def fit(self):
        """Raise BadInput unless there are workers, and each would measure what this machine would."""
        try:
            self.client.wait_for_workers(1, timeout=CONNECT_WITHIN)
        except TimeoutError:
            remedy = f"start one on each machine, where the workbook is: `dask worker {self.address}`"
            raise BadInput(f"--executor {self.address}", "a scheduler without workers", remedy) from None
        for worker, answer in self.client.run(asked, self.run, self.parcel(), on_error="return").items():
            if isinstance(answer, Exception):
                raise refusal(f"the worker at {worker}", without_workbook(answer))
            self.processors.append(self.opened(answer, worker))

    def each(self, calls, kinds=None, alone=False):
        """Yield (key, result) of {key: (function, *arguments)} as the calls end.  Raises what a call raised.

        kinds: {key: kind}, as for Workers;    alone: one call at a time on each machine
        """
        waiting, busy, finished, kinds = list(calls.items()), {}, queue.Queue(), kinds or {}
        broken, seen = dict.fromkeys(calls, 0), time.monotonic()
        while waiting or busy:
            there = workers_of(self.client)
            seen = time.monotonic() if there else seen
            if time.monotonic() - seen > WORKERLESS:
                raise BadInput(f"--executor {self.address}", "gone", "start it again: the same command goes on")
            waiting += taken_back(busy, there)
            self.hand_out(waiting, busy, finished, one_of_each_machine(there) if alone else there, kinds)
            try:
                future = finished.get(timeout=LOOK_AFTER)
            except queue.Empty:
                continue
            if future not in busy:                                     # its worker went while it was on its way
                continue
            if future.status == "pending":                             # its worker died after the last word
                future.add_done_callback(finished.put)
                continue
            worker, key, call = busy.pop(future)
            try:
                answer = future.result()
            except ImportError as e:
                raise refusal(f"the worker at {worker}", without_workbook(e)) from None
            except Exception as e:                                     # Dask has many names for a worker that is lost
                broken[key] += 1
                if broken[key] == TRIES:
                    raise BadInput(f"a measuring process at {worker}", f"gone {TRIES} times ({in_a_line(e)})",
                                   "the machine may be short of memory: start fewer workers there") from None
                waiting.append((key, call))
                continue
            yield key, self.opened(answer, worker)

    def hand_out(self, waiting, busy, finished, workers, kinds):
        """Submit waiting calls, until none is left or none of these workers is free; the cheapest pair comes first."""
        at_work = {worker for worker, _, _ in busy.values()}
        free = [worker for worker in workers if worker not in at_work]
        while waiting and free:
            worker, (key, call) = min(product(free, waiting),
                                      key=lambda pair: self.costs(pair[0], kinds.get(pair[1][0])))
            free.remove(worker)
            waiting.remove((key, call))
            self.seen.setdefault(worker, set()).add(kinds.get(key))
            future = self.client.submit(asked, self.run, self.parcel(call), pure=False, workers=[worker])
            busy[future] = worker, key, call
            future.add_done_callback(finished.put)

    @staticmethod
    def opened(answer, worker):
        """Return the result of a call.  Raises what it raised."""
        unfit, result, error = pickle.loads(answer)
        if unfit:
            raise refusal(f"the worker at {worker}", unfit)
        if error:
            raise error
        return result


@contextmanager
def cluster(address, of):
    """Yield a Cluster for the duration of the block.  Its measuring processes are killed when it ends."""
    client = connected(address)
    try:
        found = Cluster(client, address, of)
        found.fit()
        try:
            yield found
        finally:
            if workers_of(client):
                with suppress(Exception):                              # a worker may go at any moment
                    client.run(end, found.run, on_error="ignore")
    finally:
        client.close(timeout=CONNECT_WITHIN)


def taken_back(busy, there):
    """Cancel the calls of lost workers, for which Dask would wait; return them as [(key, call)]."""
    lost = [future for future, (worker, _, _) in busy.items() if there and worker not in there]
    calls = [busy.pop(future)[1:] for future in lost]
    for future in lost:
        future.cancel()
    return calls


def one_of_each_machine(workers):
    return list({worker.rpartition(":")[0]: worker for worker in sorted(workers, reverse=True)}.values())


def makeup(of):
    """Return {thing: version} on which a result depends.  It does not depend on where the workbook lies."""
    files = sorted((path.relative_to(modules.ROOT).as_posix() if path.is_relative_to(modules.ROOT) else path.name, path)
                   for path in sources(of))
    text = b"".join(name.encode() + path.read_bytes() for name, path in files if path.is_file())
    return {"workbook": hashlib.sha256(text).hexdigest()[:12], "Python": ".".join(map(str, sys.version_info[:2])),
            "packages": " ".join(f"{name} {found}" for name, found in installed_versions().items())}


# ---------------------------------------------------------------------------------------------- on a worker

class Child:
    """The process in which a worker measures: a new one for each run, because lessons may have changed."""

    def __init__(self):
        self.lock, self.process, self.run = threading.Lock(), None, None

    def ask(self, run, parcel):
        """Return the answer to a parcel.  Raises EOFError where the process breaks."""
        with self.lock:
            if self.process is None or run != self.run or self.process.poll() is not None:
                self.end(self.run)
                self.run = run
                self.process = subprocess.Popen([sys.executable, "-m", __name__], cwd=modules.ROOT,
                                                stdin=subprocess.PIPE, stdout=subprocess.PIPE)
            try:
                pickle.dump(parcel, self.process.stdin)
                self.process.stdin.flush()
                return pickle.load(self.process.stdout)
            except (OSError, EOFError, pickle.UnpicklingError):
                raise EOFError(f"the measuring process ended unexpectedly ({self.process.wait()})") from None

    def end(self, run):
        """Kill the process of that run."""
        if self.process is not None and run == self.run:
            self.process.kill()
            self.process.wait()
            self.process.stdin.close()
            self.process.stdout.close()
            self.process = None


CHILD = Child()


def asked(run, parcel):
    return CHILD.ask(run, parcel)


def end(run):
    CHILD.end(run)


def answers(parcels, ours):
    """Yield the answer to each parcel: why this machine may not measure, or a result, or an error."""
    for theirs, of, call in parcels:
        if of not in ours:
            try:
                ours[of] = makeup(of)
            except (BadInput, OSError) as e:
                yield in_a_line(e), None, None
                continue
        differ = [thing for thing in theirs if ours[of][thing] != theirs[thing]]
        unfit = "; ".join(f"with {thing} {ours[of][thing]} instead of {theirs[thing]}" for thing in differ)
        yield (unfit, processor(), None) if unfit or call is None else ("", *outcome(*call))


def orphaned(parent):
    """End when the worker ends; another one measures it again."""
    while os.getppid() == parent:
        time.sleep(1.0)
    os._exit(1)


def received(stream):
    """Yield what comes in, until the worker closes its end."""
    with suppress(EOFError):
        while True:
            yield pickle.loads(pickle.load(stream))


def main():
    channel = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)                                                      # only answers go to standard output
    threading.Thread(target=orphaned, args=(os.getppid(),), daemon=True).start()
    for answer in answers(received(sys.stdin.buffer), {}):
        pickle.dump(pickle.dumps(answer), channel)
        channel.flush()


if __name__ == "__main__":
    main()
