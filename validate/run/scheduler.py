"""The scheduler of a Dask cluster, for `validate --executor` and `grade --executor`."""

import re

from solutions.checks import BadInput

CONNECT_WITHIN = 5.0         # [s]: a scheduler answers in milliseconds


def connected(address):
    """Connect to the scheduler."""
    if not re.fullmatch(r"\w+://\S+:\d+", address):
        raise BadInput(f"--executor {address!r}", "not an address", "write it like tcp://127.0.0.1:8786")
    try:
        from distributed import Client
    except ImportError:
        remedy = "--executor needs it: pip install -c constraints.txt -e '.[cluster]'"
        raise BadInput("the package distributed", "not installed", remedy) from None
    try:
        return Client(address, timeout=CONNECT_WITHIN, set_as_default=False)
    except (OSError, ValueError) as e:
        why = f"no Dask scheduler that answers ({type(e).__name__})"
        remedy = "start one there with `dask scheduler`, and name the address that it prints"
        raise BadInput(f"--executor {address}", why, remedy) from None


def workers_of(client):
    """Return {address of a worker: its threads}; empty if the scheduler does not answer."""
    try:
        return dict(client.nthreads()) if client.status == "running" else {}
    except Exception:                                                  # Dask raises errors of many kinds when cut off
        return {}


def without_workbook(error):
    """Return, in words, that a worker cannot run the workbook."""
    return f"without a workbook that runs ({in_a_line(error)})"


def in_a_line(error):
    """Return an error with its kind in one line."""
    return " ".join(f"{type(error).__name__}: {error}".split())


def refusal(thing, unfit):
    """Return the BadInput for a scheduler or a worker that may not take part."""
    remedy = "give it the workbook and the locked versions that are here, start it again, and repeat the command"
    return BadInput(thing, unfit, remedy)
