"""The engines' own switches: the parts of an engine that can be left out, and how each is switched off.

A switch acts on a world that is ready to step.  It says whether there was anything to switch off.  pymunk has none for
its memory of contacts: with collision_persistence = 0 it forgets a contact before it solves it.
"""

from collections.abc import Callable
from contextlib import contextmanager
from typing import NamedTuple

from ..scene import PYBULLET, PYMUNK

_listening = []              # a list for each block of `worlds_made`, innermost last


class Switch(NamedTuple):
    """A part of an engine that can be left out."""
    product: str
    part: str                # for people
    off: Callable            # (world) → whether there was such a part


@contextmanager
def worlds_made():
    """Give a list of the worlds (pymunk.Space or Bullet) that are made during the block."""
    _listening.append([])
    try:
        yield _listening[-1]
    finally:
        _listening.pop()


def made(world):
    """Tell who listens that this world was made; return it."""
    for worlds in _listening[-1:]:
        worlds.append(world)
    return world


# ---------------------------------------------------------------------------------------------- pymunk

def pymunk_collisions(space):
    """Let no shape collide with another."""
    import pymunk
    for shape in space.shapes:
        shape.filter = pymunk.ShapeFilter(mask=0)
    return len(space.shapes) > 1


def pymunk_friction(space):
    rubbing = [shape for shape in space.shapes if shape.friction > 0.0]
    for shape in rubbing:
        shape.friction = 0.0
    return len(rubbing) > 1


def pymunk_sweeps(space):
    """Sweep once over contacts and joints."""
    space.iterations, before = 1, space.iterations
    return before > 1 and bool(space.constraints or len(space.shapes) > 1)


# ---------------------------------------------------------------------------------------------- pybullet

def parts(bullet):
    """[(body, link)] of everything in pybullet; empty where nothing has a shape.

    pybullet does not tell whether a body in maximal coordinates has one.  But its client remembers what was called.
    """
    pb = bullet.pb
    if "createCollisionShape" not in vars(pb):
        return []
    return [(body, link) for body in map(pb.getBodyUniqueId, range(pb.getNumBodies()))
            for link in range(-1, pb.getNumJoints(body))]


def pybullet_collisions(bullet):
    """Let no shape collide with another."""
    for body, link in parts(bullet):
        bullet.pb.setCollisionFilterGroupMask(body, link, 0, 0)
    return len(parts(bullet)) > 1


def pybullet_friction(bullet):
    rubbing = [part for part in parts(bullet) if bullet.pb.getDynamicsInfo(*part)[1] > 0.0]
    for body, link in rubbing:
        bullet.pb.changeDynamics(body, link, lateralFriction=0.0)
    return len(rubbing) > 1


def pybullet_memory(bullet):
    """Begin the sweeps of each step from nothing."""
    bullet.pb.setPhysicsEngineParameter(warmStartingFactor=0)
    return len(parts(bullet)) > 1


def pybullet_sweeps(bullet):
    """Sweep once over contacts and joints."""
    before = bullet.pb.getPhysicsEngineParameters()["numSolverIterations"]
    bullet.pb.setPhysicsEngineParameter(numSolverIterations=1)
    return before > 1 and (len(parts(bullet)) > 1 or bullet.pb.getNumConstraints() > 0)


SWITCHES = (
    Switch(PYMUNK, "collision detection", pymunk_collisions),
    Switch(PYMUNK, "friction", pymunk_friction),
    Switch(PYMUNK, "all sweeps but one", pymunk_sweeps),
    Switch(PYBULLET, "collision detection", pybullet_collisions),
    Switch(PYBULLET, "friction", pybullet_friction),
    Switch(PYBULLET, "memory of contacts", pybullet_memory),
    Switch(PYBULLET, "all sweeps but one", pybullet_sweeps),
)
