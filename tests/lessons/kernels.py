"""Run the cells of a notebook in a kernel of its own, as a student does, with a blocking client.

nbclient waits with asyncio. On a busy machine that may miss a reply, and then waits until its timeout.
"""

import json

from validate.book.execute import kernel

__all__ = ["kernel", "ran"]

LONGEST = 600                # of one cell [s]: only one that hangs takes so long, on the busiest machine, too


def ran(client, source):
    """The output of a cell as text; an assertion fails if the cell raises."""
    said = []
    hook = lambda message: said.append(message["content"])
    reply = client.execute_interactive(source, timeout=LONGEST, allow_stdin=False, output_hook=hook)["content"]
    assert reply["status"] == "ok", "\n".join([source, *reply.get("traceback", ())])
    return json.dumps(said, ensure_ascii=False, default=str)
