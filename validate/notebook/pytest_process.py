"""pytest for the checks of a notebook: in a process of its own, or in this one where a browser has no other.

Where the system can fork, that process is a copy of one that has its imports behind it: an answer in 0.2 s in place
of 0.5.
"""

import contextlib
import io
import os
import sys
from functools import cache

import pytest

from ..subject.modules import ROOT

try:
    import _multiprocessing  # noqa: F401                            # WebAssembly has none
    import multiprocessing
    from concurrent.futures.process import BrokenProcessPool, ProcessPoolExecutor
    PROCESSES = True
except ImportError:
    PROCESSES = False


class Ended(Exception):
    """The code under test has ended its process."""


def run(*arguments):
    """Return what pytest prints.  Raises Ended when the code under test ends its process; this one survives."""
    return (in_a_process if PROCESSES else in_this_one)(*arguments)


def in_a_process(*arguments):
    # IPython's %reset takes it away, and multiprocessing asks for it
    vars(sys.modules["__main__"]).setdefault("__spec__", None)
    with first_on_the_path(ROOT), ProcessPoolExecutor(1, mp_context=processes()) as process:
        try:
            return process.submit(quiet, *arguments).result()
        except BrokenProcessPool:
            raise Ended() from None


@cache
def processes():
    """Return how processes are started."""
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["validate.notebook.preload"])
    return context


@contextlib.contextmanager
def first_on_the_path(folder):
    """Let new processes import from there, and not from the copy of the workbook that is installed.

    The server from which processes are forked does not look at the `sys.path` of this process.
    """
    before = os.environ.get("PYTHONPATH")
    os.environ["PYTHONPATH"] = os.pathsep.join([str(folder), *([before] if before else [])])
    try:
        yield
    finally:
        os.environ.pop("PYTHONPATH")
        os.environ.update({"PYTHONPATH": before} if before is not None else {})


def in_this_one(*arguments):
    """Do the same in this process.  The tests' modules are dropped, so the next check reads them anew."""
    kept = set(sys.modules)
    try:
        return quiet(*arguments)
    except SystemExit:
        raise Ended() from None
    finally:
        for name in [name for name in sys.modules if name.partition(".")[0] == "tests" and name not in kept]:
            del sys.modules[name]


def quiet(*arguments):
    """Return what pytest prints, in this process."""
    with contextlib.redirect_stdout(io.StringIO()) as said, contextlib.redirect_stderr(said):
        pytest.main([*arguments, "-p", "no:cacheprovider", "--disable-plugin-autoload"])
    return said.getvalue()
