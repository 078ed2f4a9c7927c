"""Scenes as Models: what they are made of and what is compared, for every world.

Parameters and truth stay with the scenes.
"""

from collections.abc import Callable
from typing import NamedTuple

from ..engines.products import PYBULLET, PYMUNK
from ..scene import Scene
from ..scenes.friction import incline, stick_slip
from ..scenes.impulses import bounces, cradle, oblique_discs, spinning_bounce
from ..scenes.integrators import kepler, linear_drag, oscillator, throw
from ..scenes.pbd import pendulum, rope
from ..scenes.rotation import asymmetric_top, heavy_top, rolling_down, slide_then_roll
from ..scenes.simulator import (
    backspin_ball,
    dominoes,
    machine,
    moving_wedge,
    rocking_block,
    rod_chain,
    rod_cradle,
    turntable,
)
from ..scenes.springs import hanging_springs, spring_net, two_stars

ONE_SWEEP = {PYMUNK: {"iterations": 1}}              # over the dampers of a net
FEW_SWEEPS = {PYMUNK: {"iterations": 2}, PYBULLET: {"iterations": 3, "slop": 0.0}}     # over the corners of a block
NO_FORMULA = "no formula gives this motion, and no theory says how far a run is from the truth"


class Described(NamedTuple):
    """A scene whose Model is known."""
    scene: Scene
    model: Callable          # (p) → Model
    observe: Callable        # (State, p) → what the scene's truth(p, T) has
    settings: dict | None = None     # {Product: settings that cannot be derived from the Model}
    shown: str = ""          # why an engine is shown here and not judged


def of(scene, settings=None, shown=""):
    """Return the Described of a scene that has its Model."""
    return Described(scene, scene.model, scene.read, settings, shown)


DESCRIBED = {                # name of the scene: Described
    "throw": of(throw.SCENE),
    "linear_drag": of(linear_drag.SCENE),
    "oscillator": of(oscillator.SCENE),
    "kepler": of(kepler.SCENE),
    "hanging_springs": of(hanging_springs.SCENE, ONE_SWEEP),
    "spring_net": of(spring_net.SCENE, ONE_SWEEP),
    "two_stars": of(two_stars.SCENE),
    "incline": of(incline.SCENE),
    "stick_slip": of(stick_slip.SCENE),
    "slide_then_roll": of(slide_then_roll.SCENE),
    "rolling_down": of(rolling_down.SCENE),
    "backspin_ball": of(backspin_ball.SCENE),
    "cradle": of(cradle.SCENE),
    "oblique_discs": of(oblique_discs.SCENE),
    "bounces": of(bounces.SCENE),
    "spinning_bounce": of(spinning_bounce.SCENE),
    "pendulum": of(pendulum.SCENE),
    "rope": of(rope.SCENE),
    "moving_wedge": of(moving_wedge.SCENE, {PYBULLET: {"slop": 0.0, "breaking": moving_wedge.KEPT}}),
    "dominoes": of(dominoes.SCENE, shown=NO_FORMULA),
    "machine": of(machine.SCENE, shown=NO_FORMULA),
    "rocking_block": of(rocking_block.SCENE, FEW_SWEEPS),
    "rod_chain": of(rod_chain.SCENE),
    "rod_cradle": of(rod_cradle.SCENE),
    "turntable": of(turntable.SCENE),
    "asymmetric_top": of(asymmetric_top.SCENE),
    "heavy_top": of(heavy_top.SCENE),
}
