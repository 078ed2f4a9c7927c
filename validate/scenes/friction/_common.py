"""A block on a plane: the fields of its scenes, and its worlds in the engines."""

from functools import partial

from validate.engines.friction import SWEEPS
from validate.reference.friction import block_in_space
from validate.scene import PYBULLET, PYMUNK
from validate.scenes._common import ONE_LINK, built, coordinates, measured

LEFT = 0.4                   # of an error after a sweep [-]: theory has 0.27 for a slab that is held
BY_SWEEPS = "that a sweep leaves at most 0.4 of an error, on runs of 5 to 1,000 steps: 0.25 in pymunk, 0.35 in pybullet"
SLOP = 1e-5                  # pybullet: the overlap that it tolerates in a contact, and with which the slab begins [m]
in_pymunk = partial(built, PYMUNK, iterations=SWEEPS)
in_pybullet = partial(built, PYBULLET, iterations=SWEEPS, overlap=SLOP, slop=SLOP)


JOINT = "a slide joint with frictionloss, impedance 0.9999, in place of a contact; Euler, first velocity − ½ a dt"


def left_by(sweeps, impulse):
    """Return what the sweeps of an engine leave of an impulse on a flat slab.  How much one leaves was measured."""
    return impulse * LEFT**sweeps


def block_on(ground, start):
    """Return the fields that the scenes of a block share; ground: "floor" or "slope", start: the start of the scene."""
    return {
        "lesson": "friction",
        "start": start,
        "observe": coordinates(1),
        "links": ONE_LINK,
        "uses": ("two coordinates", "a normal", "one step of a block that stays on its plane"),
        "ablations": {
            "the third dimension": lambda p: (block_in_space(*start(p)), p),
            **measured("rotation: it does not tip", f"detection: it does not leave the {ground}"),
        },
    }


def read_distance(state, p):
    """Return how far the block is along x."""
    return state.x[0, :1]


def slab_on_line(before="", after="", iterations=SWEEPS):
    """Return pymunk's settings; the words before and after the slab say what a scene does with it."""
    return f"{before}a slab of 2 m on a line{after}; {iterations} iterations, collision_slop 1e-5"


def slab_on_box(before="", after="", iterations=SWEEPS):
    """Return pybullet's settings likewise."""
    return (f"{before}a slab of 2 m on a box{after}; maximal coordinates, solverResidualThreshold 0, "
            f"{iterations} iterations")
