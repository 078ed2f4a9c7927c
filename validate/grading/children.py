"""Child processes that end when this one ends, for any reason, and leave no files behind.

Each child waits at a pipe whose other end only this process has.  When that end closes, the child removes the temporary
files and ends at once.  If all of them were killed, the next run removes the files.
"""

import contextlib
import os
import shutil
import signal
import sys
import tempfile
import threading
import time
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool as Ended
from multiprocessing import get_context
from pathlib import Path

from solutions.checks import BadInput

PREFIX = "workbook-grading-"
SAFE = "PYTHONSAFEPATH"      # of Python 3.11: the working directory is not on the path
YOUNG = 60.0                 # a folder of another run may not be locked yet when it is so old [s]
LITTLE = 256 << 20           # so much may reading an archive take [bytes]: an honest one takes a tenth
WITHIN = 10.0                # so long may it take [s of the processor]: an honest one takes a hundredth
PATIENCE = 10.0 * WITHIN     # … and so long altogether, on a machine that does much else [s]


class Pool:
    """An executor of processes that have called begin(*arguments).  Leaving it by an error ends them at once."""

    def __init__(self, count, begin, *arguments):
        context = get_context("spawn")
        self.leave = contextlib.ExitStack()
        self.leave.enter_context(without_working_directory())
        folder = self.leave.enter_context(temporary())
        end, lifeline = context.Pipe(duplex=False)
        begun = {"initializer": _begun, "initargs": (end, folder, begin, arguments)}
        self.executor = ProcessPoolExecutor(count, mp_context=context, **begun)
        self.leave.callback(self.executor.shutdown, wait=True, cancel_futures=True)
        self.lifeline = self.leave.enter_context(lifeline)
        self.submit = self.executor.submit

    def __enter__(self):
        return self

    def __exit__(self, kind=None, *error):
        if not kind:
            self.executor.shutdown(wait=True)
        for process in [*(self.executor._processes or {}).values()]:   # there is no public way before Python 3.14
            process.kill()
        self.leave.close()


@contextlib.contextmanager
def without_working_directory():
    """Let new processes look for modules nowhere in the working directory, where a student's selectors.py may lie.

    multiprocessing starts them by `python -c`, which would put the working directory first on their path.
    """
    before = os.environ.get(SAFE)
    os.environ[SAFE] = "1"
    try:
        yield
    finally:
        if before is None:
            os.environ.pop(SAFE, None)
        else:
            os.environ[SAFE] = before


def apart_from_path(folder):
    """Raise BadInput if Python looks for modules in this folder or below: a file in it would run as the grader."""
    folder = Path(folder).resolve()
    for entry in sys.path:
        if os.path.exists(entry or ".") and Path(entry).resolve().is_relative_to(folder):
            why = f"where Python looks for modules ({entry or '.'!r} is on sys.path)"
            raise BadInput(f"folder {str(folder)!r}", why, "start `grade` elsewhere, and leave PYTHONPATH without it")


def _begun(end, folder, begin, arguments):
    """Prepare the child, before its first task."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)                       # Ctrl-C reaches each process; the parent decides
    tempfile.tempdir = tempfile.mkdtemp(dir=folder)
    os.chmod(tempfile.tempdir, 0o755)                                  # the sandbox has another user
    threading.Thread(target=_wait, args=(end, folder), daemon=True).start()
    begin(*arguments)


def _wait(end, folder):
    with contextlib.suppress(EOFError, OSError):
        end.recv_bytes()
    shutil.rmtree(folder, ignore_errors=True)
    os._exit(1)


# ---------------------------------------------------------------------------------------------- temporary files

@contextlib.contextmanager
def temporary():
    """Yield a folder for the temporary files of this run; remove what earlier runs have left."""
    remove_leftovers()
    folder = tempfile.mkdtemp(prefix=PREFIX)
    os.chmod(folder, 0o755)
    lock = locked(folder)
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        if lock is not None:
            os.close(lock)


def remove_leftovers():
    """Remove folders of runs that were killed, which no process has locked any more."""
    for folder in Path(tempfile.gettempdir()).glob(f"{PREFIX}*"):
        with contextlib.suppress(OSError):
            about = folder.lstat()
            ours = folder.is_dir() and not folder.is_symlink() and about.st_uid == os.geteuid()
            if ours and time.time() - about.st_mtime > YOUNG:
                lock = locked(folder)
                if lock is not None:
                    shutil.rmtree(folder, ignore_errors=True)
                    os.close(lock)


def locked(folder):
    """Return a descriptor that keeps a folder locked while this process lives.

    It is None if another process has the lock, or on systems without such locks.
    """
    try:
        import fcntl
    except ImportError:
        return None
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        return descriptor
    except OSError:
        os.close(descriptor)
        return None


# ---------------------------------------------------------------------------------------------- limits

def bound(more):
    """Limit the growth of this process's memory [bytes]; return the limit before, or None on systems without one."""
    try:
        import resource
        now = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        before = resource.getrlimit(resource.RLIMIT_AS)
    except (ImportError, OSError):                                     # no Linux, so no sandbox either
        return None
    limits = [now + more, *(limit for limit in before if limit != resource.RLIM_INFINITY)]
    resource.setrlimit(resource.RLIMIT_AS, (min(limits), before[1]))
    return before


class Child:
    """Calls functions in one process that has called begin(*arguments), and in a new one when that has ended."""

    def __init__(self, begin, *arguments):
        self.begin, self.pool = (begin, *arguments), None

    def __enter__(self):
        return self

    def __exit__(self, *error):
        if self.pool:
            self.pool.__exit__(*error)
            self.pool = None

    def __call__(self, function, *arguments, patience=None):
        """Call the function in the child.  Raises its error, Ended, or TimeoutError after `patience` seconds."""
        self.pool = self.pool or Pool(1, *self.begin)
        try:
            return self.pool.submit(function, *arguments).result(timeout=patience)
        except (Ended, TimeoutError) as e:
            self.__exit__(type(e))
            raise


def reader():
    """Start a child with little memory that reads archives."""
    return Child(bound, LITTLE)


def timed(function, *arguments):
    """Return the function's result, or TimeoutError after so long on the processor."""
    def ring(*_):
        raise TimeoutError("it takes too long")
    if hasattr(signal, "setitimer"):
        signal.signal(signal.SIGPROF, ring)
        signal.setitimer(signal.ITIMER_PROF, WITHIN)
    try:
        return function(*arguments)
    finally:
        if hasattr(signal, "setitimer"):
            signal.setitimer(signal.ITIMER_PROF, 0.0)
