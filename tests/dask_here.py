"""A Dask cluster on the loopback for tests: a scheduler and workers, all of them real processes."""

import contextlib
import json
import subprocess
import sys
import time

from validate.subject.modules import ROOT

UP_WITHIN = 60.0             # [s]: a scheduler needs 1, a worker 2, on a machine that does nothing else


def started(kind, *arguments, folder=ROOT):
    """Start a process of Dask: `scheduler` or `worker`."""
    command = [sys.executable, "-m", f"distributed.cli.dask_{kind}", "--host", "127.0.0.1", "--no-dashboard",
               *map(str, arguments)]
    return subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def worker(address, folder=ROOT, threads=1):
    """Start a worker."""
    return started("worker", address, "--no-nanny", "--nthreads", threads, folder=folder)


@contextlib.contextmanager
def cluster_of(count, tmp_path, threads=1):
    """(address, [process of a worker, …]), with all those workers at work."""
    told = tmp_path / "scheduler.json"
    processes = [started("scheduler", "--port", 0, "--scheduler-file", told)]
    try:
        until(lambda: told.is_file() and told.read_text())
        address = json.loads(told.read_text())["address"]
        processes += [worker(address, threads=threads) for _ in range(count)]
        with client_of(address) as client:
            until(lambda: len(client.nthreads()) == count)
        yield address, processes[1:]
    finally:
        for process in processes:
            process.kill()
            process.wait()


def client_of(address):
    from distributed import Client
    return Client(address, timeout=UP_WITHIN, set_as_default=False)


def until(true, within=UP_WITHIN):
    """Wait until something is true."""
    limit = time.monotonic() + within
    while not true():
        assert time.monotonic() < limit
        time.sleep(0.05)
