"""Notebooks executed with the worked answers, and the store of their outputs.

A kept notebook is used again until its text, an answer or a tool changes.
"""

import contextlib
import hashlib
import os
import queue
import sys
import tempfile
import time
from pathlib import Path

import nbformat
import zmq
from jupyter_client import KernelManager

from solutions.checks import BadInput

from ..subject import generate
from ..subject.modules import ROOT, SOLUTIONS

NOTEBOOKS, KEPT = ROOT / "notebooks", ROOT / ".cache" / "book"
LONGEST = 600                # of one cell [s]
SHOWN = {"stream", "display_data", "execute_result", "error"}
FIRST = """%matplotlib inline
%reset -f"""


@contextlib.contextmanager
def kernel(folder, python=sys.executable, **environment):
    """Yield a client of a new kernel of that Python, with that working folder."""
    # Two kernels that start at the same time may choose the same port, but not the same file.
    with tempfile.TemporaryDirectory() as place:
        manager = KernelManager(kernel_name="python3",
                                **{"transport": "ipc", "ip": f"{place}/kernel"} if zmq.has("ipc") else {})
        manager.kernel_spec.argv = [str(python), "-m", "ipykernel_launcher", "-f", "{connection_file}"]
        manager.start_kernel(cwd=folder, env={**os.environ, **environment})
        client = manager.blocking_client()
        client.is_kernel_alive = manager.is_alive
        try:
            client.start_channels()
            client.wait_for_ready(timeout=300)
            yield client
        finally:
            client.stop_channels()
            manager.shutdown_kernel(now=True)


class Outputs:
    """Collects the outputs of one cell.  A call of `clear_output` empties it, at once or before the next output."""

    def __init__(self):
        self.cells, self.clear_next = [], False

    def take(self, message):
        kind, content = message["header"]["msg_type"], message["content"]
        if kind == "clear_output":
            self.clear_next = content["wait"]
            if not content["wait"]:
                self.cells.clear()
        elif kind in SHOWN:
            if self.clear_next:
                self.cells.clear()
            self.clear_next = False
            self.cells.append(nbformat.v4.output_from_msg(message))


def executed(path, stubs=False):
    """Return the notebook with the outputs of its cells.  Raises BadInput if a cell fails.

    stubs: run it with the lessons as students get them, because it prints the text of a lesson.
    """
    book = nbformat.read(path, as_version=4)
    with tempfile.TemporaryDirectory() as folder:
        if stubs:
            for name, text in generate.lessons().items():
                Path(folder, name).write_text(text, encoding="utf-8")
        lessons = folder if stubs else str(SOLUTIONS)
        # a live scene is shown as a film, because no kernel runs behind the book
        with kernel(path.parent, WORKBOOK_LESSONS=lessons, PYTHONPATH=str(ROOT), WORKBOOK_LIVE="film") as client:
            client.execute_interactive(FIRST, timeout=LONGEST, output_hook=lambda message: None)
            for cell in book.cells:
                if cell.cell_type == "code":
                    cell.outputs = outputs_of(client, cell.source, path.name)
    return book


def outputs_of(client, source, name):
    """Run one cell; return its outputs."""
    found, request, until = Outputs(), client.execute(source, allow_stdin=False), time.monotonic() + LONGEST
    remedy = "mend it, and build again"
    while True:
        try:
            message = client.get_iopub_msg(timeout=1)
        except queue.Empty:
            if not client.is_kernel_alive():
                raise BadInput(f"notebook {name}", "a cell that ends its kernel", remedy) from None
            if time.monotonic() > until:
                raise BadInput(f"notebook {name}", f"a cell that takes longer than {LONGEST} s", remedy) from None
            continue
        if message["parent_header"].get("msg_id") == request:
            if message["msg_type"] == "status" and message["content"]["execution_state"] == "idle":
                break
            found.take(message)
    error = next((output for output in found.cells if output.output_type == "error"), None)
    if error:
        raise BadInput(f"notebook {name}", f"a cell that ends with {error.ename}: {error.evalue}", remedy)
    return found.cells


def prints_source(book):
    """Return whether a notebook prints the text of the lessons."""
    return any("source_of(" in cell.source for cell in book.cells if cell.cell_type == "code")


def fingerprint(path):
    """Return a hash of everything that a notebook's outputs depend on."""
    sources = [path, *sorted(SOLUTIONS.rglob("*.py")), *sorted((ROOT / "tests" / "lessons").glob("test_*.py"))]
    sources += [file for file in sorted((ROOT / "validate").rglob("*.py"))
                if file.parent.name != "book" or file.stem == "execute"]
    sources += sorted(file for folder in ("report", "notebook") for file in (ROOT / "validate" / folder).rglob("*.js")
                      if "node_modules" not in file.parts)
    return hashlib.sha256(b"\0".join(file.read_bytes() for file in sources)).hexdigest()[:16]


def kept(path, say):
    """Return the executed notebook, from an earlier build if nothing has changed since."""
    KEPT.mkdir(parents=True, exist_ok=True)
    place = KEPT / f"{path.stem}-{fingerprint(path)}.ipynb"
    if not place.is_file():
        say(f"runs {path.name}")
        book = executed(path, prints_source(nbformat.read(path, as_version=4)))
        for older in KEPT.glob(f"{path.stem}-*"):
            older.unlink()
        draft = place.with_suffix(f".{os.getpid()}")
        nbformat.write(book, draft)
        draft.replace(place)
    return nbformat.read(place, as_version=4)
