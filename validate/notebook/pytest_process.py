"""pytest in a process of its own, for the checks of a notebook.

Where the system can fork, that process is a copy of one that has its imports behind it: an answer in 0.2 s in place
of 0.5.
"""

import contextlib
import io
import multiprocessing
import sys
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool

import pytest

FORKS = "forkserver" in multiprocessing.get_all_start_methods()
PROCESSES = multiprocessing.get_context("forkserver" if FORKS else "spawn")
PROCESSES.set_forkserver_preload(["validate.notebook.preload"])


class Ended(Exception):
    """The code under test has ended its process."""


def run(*arguments):
    """What pytest prints.  Raises Ended when the code under test ends its process; this one survives."""
    # IPython's %reset takes it away, and multiprocessing asks for it
    vars(sys.modules["__main__"]).setdefault("__spec__", None)
    with ProcessPoolExecutor(1, mp_context=PROCESSES) as process:
        try:
            return process.submit(quiet, *arguments).result()
        except BrokenProcessPool:
            raise Ended() from None


def quiet(*arguments):
    """What pytest prints, in this process."""
    with contextlib.redirect_stdout(io.StringIO()) as said, contextlib.redirect_stderr(said):
        pytest.main([*arguments, "-p", "no:cacheprovider", "--disable-plugin-autoload"])
    return said.getvalue()
