"""Notebooks run in a kernel of their own, as at a student's desk, by clients that wait by blocking.

(nbclient waits by asyncio; on a busy machine that may overlook an answer, and then it sits out its whole time.)
"""

import contextlib
import json
import tempfile

import zmq
from jupyter_client import KernelManager

LONGEST = 120                # of one cell [s]


@contextlib.contextmanager
def kernel(folder):
    """A client of a new kernel that works in that folder."""
    with tempfile.TemporaryDirectory() as place:                      # two kernels that start together may choose the same port, but not the same file
        manager = KernelManager(kernel_name="python3", **({"transport": "ipc", "ip": f"{place}/kernel"} if zmq.has("ipc") else {}))
        manager.start_kernel(cwd=folder)
        client = manager.blocking_client()
        try:
            client.start_channels()
            client.wait_for_ready(timeout=60)
            yield client
        finally:
            client.stop_channels()
            manager.shutdown_kernel(now=True)


def ran(client, source):
    """What a cell puts out, as text; an assertion fails when it raises."""
    said = []
    reply = client.execute_interactive(source, timeout=LONGEST, allow_stdin=False, output_hook=lambda message: said.append(message["content"]))["content"]
    assert reply["status"] == "ok", "\n".join([source, *reply.get("traceback", ())])
    return json.dumps(said, ensure_ascii=False, default=str)
