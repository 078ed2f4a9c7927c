"""Live scenes in a real kernel, with a client in place of the page: interrupts, other cells, cells that run twice."""

import contextlib
import queue
import shutil
import time

import numpy as np
import pytest

from validate.subject.modules import ROOT, SOLUTIONS

from ..lessons.kernels import kernel
from .test_live_page import CELL
from .test_live_simulation import FIRST_LINE

pytestmark = [pytest.mark.long, pytest.mark.xdist_group("notebooks")]
SOON = 60.0                  # until something must have happened on a busy machine [s]


class Page:
    """Answers a kernel as live.js does."""

    def __init__(self, client):
        self.client, self.comm, self.t, self.said, self.errors, self.closed = client, None, 0.0, [], [], []

    def send(self, kind, content, **metadata):
        message = self.client.session.msg(kind, content, metadata=metadata)
        self.client.shell_channel.send(message)
        return message["header"]["msg_id"]

    def run(self, source, cell):
        """Send a cell; return the number of its request."""
        return self.send("execute_request", {"code": source, "silent": False, "store_history": True,
                                             "user_expressions": {}, "allow_stdin": False}, cellId=cell)

    def tell(self, **content):
        self.send("comm_msg", {"comm_id": self.comm, "data": {"method": "custom", "content": content}})

    def listen(self, happened, within=SOON):
        """Take messages until happened(message) is true for one of them, and give a sign every half second."""
        end, sign = time.monotonic() + within, 0.0
        while time.monotonic() < end:
            if self.comm and time.monotonic() - sign > 0.5:
                sign = time.monotonic()
                self.tell(do="here")
            with contextlib.suppress(queue.Empty):
                message = self.client.get_iopub_msg(timeout=0.2)
                self.take(message["msg_type"], message["content"], message["buffers"])
                if happened(message):
                    return
        raise AssertionError((self.said[-3:], self.errors, self.t))

    def take(self, kind, content, buffers):
        if kind == "comm_open" and "anywidget" in str(content["data"]):
            self.comm = content["comm_id"]
        elif kind == "comm_close":
            self.closed.append(content["comm_id"])
        elif kind == "error":
            self.errors.append(content["ename"])
        elif kind == "comm_msg" and content["comm_id"] == self.comm:
            inner = content["data"].get("content", {})
            if inner.get("kind") == "frame":
                head = np.frombuffer(buffers[0], "<f4")
                self.t = float(head[1])
                if head[0] % 6 == 0:
                    self.tell(do="ack", n=float(head[0]))
            elif inner.get("kind") == "status":
                self.said.append(inner["say"])

    def shows(self, source, cell="scene"):
        """Run a cell that makes a scene, show it, and wait until it runs."""
        request = self.run(source, cell)
        self.listen(lambda message: idle(message, request))
        assert self.errors == []
        self.tell(do="hello", play=True)
        self.goes_on()

    def goes_on(self):
        t = self.t
        self.listen(lambda _: self.t > t)


def idle(message, request):
    return (message["parent_header"].get("msg_id") == request and message["msg_type"] == "status"
            and message["content"]["execution_state"] == "idle")


@pytest.fixture
def page(tmp_path):
    """(a page of a new kernel, its manager's interrupt, the learner's simulator.py)"""
    for file in SOLUTIONS.glob("*.py"):
        shutil.copy(file, tmp_path)
    with kernel(ROOT / "notebooks", WORKBOOK_LESSONS=str(tmp_path), PYTHONPATH=str(ROOT)) as client:
        page = Page(client)
        page.interrupt = client.is_kernel_alive.__self__.interrupt_kernel
        page.file = tmp_path / "simulator.py"
        page.shows(CELL.format(root=str(ROOT)))
        yield page


def test_an_interrupt_pauses_a_scene_and_ends_a_loop_that_hangs(page):
    page.interrupt()
    page.listen(lambda _: page.said[-1:] == ["Stopped. ▶ goes on."])
    page.tell(do="play")
    page.goes_on()
    good = page.file.read_text()
    page.file.write_text(good.replace(FIRST_LINE, "    while True: pass\n" + FIRST_LINE))
    page.listen(lambda _: "a step is still running after 2 s" in (page.said or [""])[-1])
    page.file.write_text(good)
    page.goes_on()
    assert page.errors == []


def test_other_cells_run_beside_a_scene_and_can_be_interrupted(page):
    request = page.run("import time; time.sleep(1.0)", "other")
    page.listen(lambda message: idle(message, request))
    page.goes_on()
    request = page.run("time.sleep(50)", "other")
    page.listen(lambda message: message["msg_type"] == "execute_input")
    time.sleep(0.5)
    page.interrupt()
    page.listen(lambda message: idle(message, request))
    assert page.errors == ["KeyboardInterrupt"]
    page.goes_on()


def test_a_cell_that_runs_again_closes_its_first_scene(page):
    first = page.comm
    page.shows(CELL.format(root=str(ROOT)))
    assert page.comm != first and first in page.closed
    count = "sum('LiveScene._run' in str(task) for task in asyncio.all_tasks())"
    request = page.run(f"import asyncio; assert {count} == 1", "count")
    page.listen(lambda message: idle(message, request))
    assert page.errors == []


def test_a_page_that_goes_away_pauses_the_scene_and_one_that_returns_goes_on(page):
    page.tell(do="gone")
    page.listen(lambda message: message["msg_type"] == "comm_msg"
                and message["content"]["data"].get("content", {}).get("playing") is False)
    page.tell(do="hello", play=True)
    page.goes_on()
