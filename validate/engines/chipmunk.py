"""pymunk, which wraps Chipmunk2D: the 2D engine."""

from validate.scene import EngineRun

from .switches import Switch, made


def pymunk_space(gravity=(0.0, 0.0)):
    """Make a pymunk.Space without damping, its units metres."""
    import pymunk
    space = made(pymunk.Space())
    space.gravity = tuple(map(float, gravity))
    space.collision_slop = 1e-5                      # the default, 0.1, is a length in pixels
    return space


def pymunk_world(space, dt, read):
    """Make the EngineRun of a space."""
    return EngineRun(lambda: space.step(dt), read, lambda: None)


def empty_world():
    """Make the EngineRun of a world without bodies."""
    return pymunk_world(pymunk_space(), 1e-3, lambda: None)


# ---------------------------------------------------------------------------------------------- switches

def let_all_pass(space):
    """Disable the collisions of all shapes."""
    import pymunk
    for shape in space.shapes:
        shape.filter = pymunk.ShapeFilter(mask=0)
    return len(space.shapes) > 1


def rub_nothing(space):
    rubbing = [shape for shape in space.shapes if shape.friction > 0.0]
    for shape in rubbing:
        shape.friction = 0.0
    return len(rubbing) > 1


def let_sweep(space, iterations):
    """Sweep so often over contacts and joints, and return how often it was before."""
    space.iterations, before = iterations, space.iterations
    return before


def sweep_once(space):
    """Sweep once over contacts and joints."""
    return let_sweep(space, 1) > 1 and bool(space.constraints or len(space.shapes) > 1)


# no switch for its memory of contacts: with collision_persistence = 0 it drops a contact before it solves it
SWITCHES = (
    Switch("collision detection", let_all_pass),
    Switch("friction", rub_nothing),
    Switch("all sweeps but one", sweep_once),
)
