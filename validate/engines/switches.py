"""The engines' own switches: the parts of an engine that can be omitted, and how each is switched off.

Each adapter has its SWITCHES.  A switch acts on a world that is ready to step, and returns whether there was
anything to switch off.
"""

from collections.abc import Callable
from contextlib import contextmanager
from typing import NamedTuple

_listening: list[list] = []  # a list for each block of `worlds_made`, from the outermost to the innermost


class Switch(NamedTuple):
    """A part of an engine that can be left out."""
    part: str                # its name, shown to readers
    off: Callable            # (world) → whether there was such a part


@contextmanager
def worlds_made():
    """Yield a list of the worlds (pymunk.Space or Bullet) that are made during the block."""
    _listening.append([])
    try:
        yield _listening[-1]
    finally:
        _listening.pop()


def made(world):
    """Add this world to the lists of all blocks that listen, and return the world."""
    for worlds in _listening:
        worlds.append(world)
    return world
