"""The processes of a run: workers that end with it, whatever ends it, and one run at a time in a folder.

Everything is measured in workers.  The run itself only waits and writes, so that it can end at any moment: Ctrl-C and SIGTERM raise `Ended` in it
once, and its workers are killed.  When the run itself is killed, its workers notice that, and the system lets go of its folder.
"""

import copyreg
import ctypes
import os
import signal
import sys
import threading
import traceback
from contextlib import contextmanager
from multiprocessing import connection, get_context, parent_process, resource_tracker

from solutions.checks import BadInput

try:
    import fcntl
except ImportError:                                                  # Windows
    import msvcrt

ENDING = (signal.SIGINT, signal.SIGTERM)
DIE_WITH_PARENT = 1                                                  # PR_SET_PDEATHSIG in Linux's <sys/prctl.h>

copyreg.pickle(BadInput, lambda e: (BadInput.__new__, (BadInput, *e.args)))        # its own __init__ wants the parts of the sentence


class Ended(BaseException):
    """Somebody wants this run to end.  No KeyboardInterrupt: typer would turn that into exit code 1."""

    def __init__(self, number):
        super().__init__(number)
        self.code = 128 + number                                     # as a shell has it


@contextmanager
def one_sentence(program):
    """What can be expected to go wrong in the block ends it in one sentence and exit code 2; Ctrl-C and SIGTERM in 130 and 143."""
    try:
        yield
    except Ended as e:
        print(f"{program}: interrupted", file=sys.stderr)
        sys.exit(e.code)
    except (BadInput, OSError, MemoryError) as e:
        print(f"{program}: {e}", file=sys.stderr)
        sys.exit(2)


# ---------------------------------------------------------------------------------------------- signals

@contextmanager
def ending_once():
    """In the block, the first Ctrl-C or SIGTERM raises Ended.  All later ones are ignored: nothing may disturb the tidying up."""
    def end(number, frame):
        for each in ENDING:
            signal.signal(each, signal.SIG_IGN)
        raise Ended(number)

    before = {each: signal.getsignal(each) for each in ENDING}
    heeded = [each for each in ENDING if before[each] != signal.SIG_IGN]              # nohup, or a shell's background
    for each in heeded:
        signal.signal(each, end)
    try:
        yield
    finally:
        for each in heeded:
            if signal.getsignal(each) is end:
                signal.signal(each, before[each])


@contextmanager
def undisturbed():
    """Signals that come during the block take effect after it."""
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
def born_deaf():
    """Processes that start in the block never get these signals, from their first instruction on: a Ctrl-C in a terminal is for all processes there."""
    resource_tracker.ensure_running()                                # which leaves them open when it starts: let it be before
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, ENDING) if hasattr(signal, "pthread_sigmask") else None
    try:
        yield
    finally:
        if mask is not None:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)


# ---------------------------------------------------------------------------------------------- workers

class Workers:
    """Processes that wait for calls, each behind a pipe."""

    def __init__(self, pipes):
        self.pipes = pipes

    def each(self, calls):
        """(key, result) of every call in {key: (function, *arguments)}, as they are done.  Raises what a call raised."""
        waiting, idle, busy = list(calls.items()), list(self.pipes), {}
        try:
            while waiting or busy:
                while waiting and idle:
                    (key, call), pipe = waiting.pop(0), idle.pop(0)
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
    """So many Workers.  They end with the block; when an error or a signal leaves it, at once."""
    context = get_context("spawn")
    processes, pipes = [], []
    try:
        with undisturbed(), born_deaf():
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
    """A worker's life: one call after the other, until the run closes the pipe or is no more."""
    for each in ENDING:
        signal.signal(each, signal.SIG_IGN)
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(DIE_WITH_PARENT, signal.SIGKILL)     # whatever it is doing; the thread below has to wait for compiled code
    threading.Thread(target=follow, args=(parent_process().sentinel,), daemon=True).start()
    try:
        while True:
            pipe.send(outcome(*pipe.recv()))
    except (EOFError, ConnectionError):
        return


def follow(parent):
    connection.wait([parent])
    os._exit(1)


def outcome(function, *arguments):
    """(result, None) or (None, the error)."""
    try:
        return function(*arguments), None
    except (BadInput, OSError, MemoryError) as e:
        return None, e
    except BaseException:                                            # a fault of ours, or sys.exit() in a subject's code
        return None, RuntimeError(traceback.format_exc())


# ---------------------------------------------------------------------------------------------- a folder's lock

@contextmanager
def alone_in(folder):
    """Hold a folder.  Raises BadInput while another run holds it."""
    with open(folder / ".lock", "a") as file:
        try:
            lock(file)
        except (BlockingIOError, PermissionError):
            raise BadInput(f"folder {str(folder)!r}", "in use by another run", "wait until that has ended, or name another folder with --out") from None
        except OSError:                                              # a file system that has no locks
            pass
        yield


def lock(file):
    """Lock a file until it is closed, which the system does for a process that ends.  Raises BlockingIOError or PermissionError when it is locked."""
    if sys.platform == "win32":
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
    else:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
