"""Run the cells of a notebook in a kernel of its own, as a student does, with a blocking client.

nbclient waits with asyncio. On a busy machine that may miss a reply, and then waits until its timeout.
"""

import contextlib
import json
import tempfile

import zmq
from jupyter_client import KernelManager

LONGEST = 120                # of one cell [s]


@contextlib.contextmanager
def kernel(folder):
    """A client of a new kernel with that working folder."""
    # Two kernels that start at the same time may choose the same port, but not the same file.
    with tempfile.TemporaryDirectory() as place:
        manager = KernelManager(kernel_name="python3",
                                **{"transport": "ipc", "ip": f"{place}/kernel"} if zmq.has("ipc") else {})
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
    """The output of a cell as text; an assertion fails if the cell raises."""
    said = []
    hook = lambda message: said.append(message["content"])
    reply = client.execute_interactive(source, timeout=LONGEST, allow_stdin=False, output_hook=hook)["content"]
    assert reply["status"] == "ok", "\n".join([source, *reply.get("traceback", ())])
    return json.dumps(said, ensure_ascii=False, default=str)
