"""Scenes as Models: what they are made of and what is compared, for every world.

Parameters and truth stay with the scenes.
"""

from collections.abc import Callable
from typing import NamedTuple

from ..products import PYBULLET
from ..scene import Scene
from ..scenes.friction import incline, stick_slip
from ..scenes.impulses import cradle, oblique_discs
from ..scenes.integrators import kepler, linear_drag, oscillator, throw
from ..scenes.pbd import pendulum, rope
from ..scenes.rotation import asymmetric_top, heavy_top, slide_then_roll
from ..scenes.simulator import dominoes, machine, moving_wedge, rod_chain, rod_cradle
from ..scenes.springs import hanging_springs, spring_net, two_stars

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
    "hanging_springs": of(hanging_springs.SCENE),
    "spring_net": of(spring_net.SCENE),
    "two_stars": of(two_stars.SCENE),
    "incline": of(incline.SCENE),
    "stick_slip": of(stick_slip.SCENE),
    "slide_then_roll": of(slide_then_roll.SCENE),
    "cradle": of(cradle.SCENE),
    "oblique_discs": of(oblique_discs.SCENE),
    "pendulum": of(pendulum.SCENE),
    "rope": of(rope.SCENE),
    "moving_wedge": of(moving_wedge.SCENE, {PYBULLET: {"slop": 0.0, "breaking": moving_wedge.KEPT}}),
    "dominoes": of(dominoes.SCENE, shown=NO_FORMULA),
    "machine": of(machine.SCENE, shown=NO_FORMULA),
    "rod_chain": of(rod_chain.SCENE),
    "rod_cradle": of(rod_cradle.SCENE),
    "asymmetric_top": of(asymmetric_top.SCENE),
    "heavy_top": of(heavy_top.SCENE),
}
