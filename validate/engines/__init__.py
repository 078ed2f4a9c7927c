"""The engines, set up to match textbook mechanics.

`bullet.py`, `chipmunk.py` and `mujoco.py` wrap one engine each.  The other files hold set-ups that several scenes of a
lesson use.

pybullet and pymunk are first order: pybullet does v += a dt, then x += v dt; pymunk does x += v dt, then v += a dt.
With a first velocity that belongs to half a step before (pybullet, −½ a dt) or after (pymunk, +½ a dt) they become
leapfrog, which is second order where forces are smooth.
"""

import ctypes
import importlib
import os
import sys


def quiet_import(name):
    """Return the module, and suppress the line that its C code prints when it is loaded."""
    if name in sys.modules:
        return sys.modules[name]
    sys.stdout.flush()
    sys.stderr.flush()
    kept, nowhere = [os.dup(1), os.dup(2)], os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
        module = importlib.import_module(name)
        ctypes.CDLL(None).fflush(None)               # the line is in the C library's buffer
        return module
    finally:
        for original, copy in zip((1, 2), kept):
            os.dup2(copy, original)
            os.close(copy)
        os.close(nowhere)
