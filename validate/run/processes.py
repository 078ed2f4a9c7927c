"""The processes of a run: workers that end with it, and a lock that keeps a second run out of its folder.

Workers do all the measuring; the run itself only waits and writes, so it can end at any moment. The first Ctrl-C or
SIGTERM raises Ended in it, and its workers are killed. If the run itself is killed, its workers end as well.
"""

import ctypes
import gc
import os
import signal
import sys
import threading
import time
import traceback
from contextlib import contextmanager
from itertools import product
from multiprocessing import connection, get_context, parent_process, resource_tracker

from solutions.checks import BadInput, Diverged

try:
    import fcntl
except ImportError:                                                  # Windows
    import msvcrt

ENDING = (signal.SIGINT, signal.SIGTERM)
QUIET = 2.0  # after Ctrl-C, another one is ignored for this long [s]
PR_SET_PDEATHSIG = 1                                                 # of Linux's <sys/prctl.h>


class Ended(BaseException):
    """Ctrl-C or SIGTERM.  Not a KeyboardInterrupt, which typer turns into exit code 1."""

    def __init__(self, number):
        super().__init__(number)
        self.code = 128 + number                                     # as in a shell


@contextmanager
def one_sentence(program):
    """End the program in one sentence: with exit code 2 for an expected failure, 130 for Ctrl-C and 143 for SIGTERM."""
    try:
        yield
    except Ended as e:
        print(f"{program}: interrupted", file=sys.stderr)
        sys.exit(e.code)
    except (BadInput, Diverged, OSError, MemoryError) as e:
        print(f"{program}: {e}", file=sys.stderr)
        sys.exit(2)


# ---------------------------------------------------------------------------------------------- signals

@contextmanager
def ending_once():
    """Raise Ended for Ctrl-C or SIGTERM.  A second one is ignored while the first is taking effect."""
    seen = []                                                        # (when, which signal)

    def end(number, frame):
        if not seen or time.monotonic() - seen[-1][0] > QUIET:       # later: something has swallowed the first
            seen.append((time.monotonic(), number))
            raise Ended(number)

    before = {each: signal.getsignal(each) for each in ENDING}
    heeded = [each for each in ENDING if before[each] != signal.SIG_IGN]             # a background job ignores Ctrl-C
    for each in heeded:
        signal.signal(each, end)
    try:
        yield
    except Exception as e:
        if seen:                                                     # an import turns Ended into an ImportError
            raise Ended(seen[-1][1]) from e
        raise
    finally:
        for each in heeded:
            signal.signal(each, signal.SIG_IGN if seen else before[each])


@contextmanager
def undisturbed():
    """Delay signals that arrive during the block until its end."""
    late = []
    before = {each: signal.signal(each, lambda number, frame: late.append(number)) for each in ENDING}
    try:
        yield
    finally:
        for each, handler in before.items():
            signal.signal(each, handler)
    for number in late[:1]:
        signal.raise_signal(number)


@contextmanager
def blocked_at_birth():
    """Start processes with these signals blocked: a terminal sends Ctrl-C to workers, too, even while they import."""
    resource_tracker.ensure_running()                                # it unblocks the signals when it starts
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, ENDING) if hasattr(signal, "pthread_sigmask") else None
    try:
        yield
    finally:
        if mask is not None:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)


# ---------------------------------------------------------------------------------------------- workers

class Affinity:
    """Gives a process calls of the kinds that it has had, as far as possible: it compiles less."""

    def __init__(self):
        self.seen = {}                                               # {process: the kinds of calls that it has had}

    def costs(self, process, kind):
        """Return whether a process would compile much for this kind of call, and whether another one has done so."""
        return kind not in self.seen.get(process, ()), any(kind in seen for seen in self.seen.values())


class Workers(Affinity):
    """Processes that wait for calls, each at the other end of a pipe."""

    def __init__(self, pipes):
        super().__init__()
        self.pipes = pipes

    def each(self, calls, kinds=None, alone=False):
        """Yield (key, result) of {key: (function, *arguments)} as the calls end.  Raises what a call raised.

        kinds: {key: kind}, see Affinity;    alone: one call at a time, because it is timed
        """
        waiting, idle, busy, kinds = list(calls.items()), list(self.pipes), {}, kinds or {}
        try:
            while waiting or busy:
                while waiting and idle and not (alone and busy):
                    pairs = product(idle, waiting)
                    pipe, (key, call) = min(pairs, key=lambda pair: self.costs(pair[0], kinds.get(pair[1][0])))
                    idle.remove(pipe)
                    waiting.remove((key, call))
                    self.seen.setdefault(pipe, set()).add(kinds.get(key))
                    pipe.send(call)
                    busy[pipe] = key
                for pipe in connection.wait(list(busy)):
                    result, error = pipe.recv()
                    if error:
                        raise error
                    idle.append(pipe)
                    yield busy.pop(pipe), result
        except (EOFError, ConnectionError):
            raise BadInput("a measuring process", "gone", "the machine may be short of memory: try --jobs 1") from None


@contextmanager
def workers(count):
    """Yield workers for the duration of the block.  They are killed when an error or a signal ends the block."""
    context = get_context("spawn")
    processes, pipes = [], []
    try:
        with undisturbed(), blocked_at_birth():
            for _ in range(count):
                ours, theirs = context.Pipe()
                process = context.Process(target=work, args=(theirs,))
                process.start()
                theirs.close()
                processes.append(process)
                pipes.append(ours)
        yield Workers(pipes)
    except BaseException:
        with undisturbed():
            for process in processes:
                process.kill()
        raise
    finally:
        for pipe in pipes:
            pipe.close()
        for process in processes:
            process.join()


def work(pipe):
    """Answer calls until the run closes the pipe or ends."""
    gc.set_threshold(50_000, 50, 50)         # compiling allocates much and frees little: this is 5 % faster
    for each in ENDING:
        signal.signal(each, signal.SIG_IGN)
    if sys.platform == "linux":                                      # during compiled code the thread below cannot run
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    threading.Thread(target=end_with, args=(parent_process().sentinel,), daemon=True).start()
    try:
        while True:
            pipe.send(outcome(*pipe.recv()))
    except (EOFError, ConnectionError):
        return


def end_with(parent):
    connection.wait([parent])
    os._exit(1)


def outcome(function, *arguments):
    """Return (result, None), or (None, the error)."""
    try:
        return function(*arguments), None
    except (BadInput, OSError, MemoryError) as e:
        return None, e
    except BaseException:                                            # our own fault, or sys.exit() in a subject's code
        return None, RuntimeError(traceback.format_exc())


# ---------------------------------------------------------------------------------------------- one run per folder

@contextmanager
def alone_in(folder):
    """Lock a folder for the length of the block.  Raises BadInput while another run has locked it."""
    with open(folder / ".lock", "a") as file:
        try:
            lock(file)
        except (BlockingIOError, PermissionError):
            raise BadInput(f"folder {str(folder)!r}", "in use by another run",
                           "wait until that has ended, or name another folder with --out") from None
        except OSError:                                              # a file system without locks
            pass
        yield


def lock(file):
    """Lock a file until it is closed; the system closes the files of a process that is killed."""
    if sys.platform == "win32":
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
    else:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
