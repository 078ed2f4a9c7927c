"""The physics engines: one record each.  A new engine is one record here and one adapter in `validate/worlds/`."""

import importlib
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version

from solutions.checks import BadInput


@dataclass(frozen=True)
class Product:
    """An engine."""
    name: str                # of its Python module, in commands and in stored results
    dimensions: int
    file: str                # of its adapters: see `adapter` and `world`
    colour: str
    marker: str
    distribution: str        # what pip installs
    remedy: str              # what to do where it is not installed, for people
    recorded: bool = False   # its record stands in where it is not installed
    optional: bool = False   # it is left out where it is not installed

    def __str__(self):
        return self.name

    @property
    def adapter(self):
        """Return its module with empty_world() → EngineRun, and SWITCHES."""
        return importlib.import_module(f"validate.engines.{self.file}")

    @property
    def world(self):
        """Return its module with build(model, dt, **settings) → World, and refuses(model)."""
        return importlib.import_module(f"validate.worlds.{self.file}")

    def installed(self):
        """Return its version, or None."""
        try:
            return version(self.distribution)
        except PackageNotFoundError:
            return None


PYMUNK = Product("pymunk", 2, "chipmunk", "#000000", "x", "pymunk", "pip install pymunk")
PYBULLET = Product("pybullet", 3, "bullet", "#5A5A5A", "+", "pybullet",
                   "leave --engine out: its recorded traces stand in", recorded=True)
MUJOCO = Product("mujoco", 3, "mujoco", "#8C0D26", "1", "mujoco-core",
                 "pip install mujoco-core, where it has a wheel", optional=True)
BOX2D = Product("pyb2d3", 2, "box2d", "#7A5C00", "2", "pyb2d3", "pip install -e '.[opponents]' adds it", optional=True)
RAPIER = Product("rapier3d", 3, "rapier", "#B5651D", "3", "rapier3d", "pip install -e '.[opponents]' adds it",
                 optional=True)
PRODUCTS = PYMUNK, PYBULLET, MUJOCO         # of the scenes and of the report
BUILDERS = *PRODUCTS, BOX2D, RAPIER         # of worlds from a Model


def product_named(name, known=PRODUCTS):
    """Return the known engine of that name.  Raises BadInput for another one."""
    for product in known:
        if product.name == name:
            return product
    raise BadInput(f"engine {name!r}", "unknown", f"choose from: {', '.join(map(str, known))}")
