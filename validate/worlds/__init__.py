"""The worlds that are built from a Model: one file per engine.

Each file has  refuses(model) → a reason, or "",  and  build(model, dt, **settings) → World.  A new engine is one file
here and one record in `validate/engines/products.py`; it then runs every Model that it does not refuse.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np


class Push(NamedTuple):
    """The force of one contact, of one joint, or of all contacts of a pair."""
    a: int                   # number of a body
    b: int                   # number of a body, or WORLD
    F: np.ndarray            # (d,) on a, from b [N]
    joint: int | None = None  # number of the joint of the Model; None: a contact


class World(NamedTuple):
    """A Model in an engine."""
    step: Callable           # () → None: advance by dt
    state: Callable          # () → State of all bodies, as the Model numbers them; an angle may lack whole turns
    pushes: Callable         # () → [Push, …] of the last step: all that the engine reports of contacts and joints
    close: Callable = lambda: None
    data: object = None      # the engine's own state, where it keeps that beside its world


def unsupported(model, *kinds):
    """Return why a world refuses a model, "" without a reason: a shape or a joint that is not one of these kinds."""
    records = [body.shape for body in model.bodies if body.shape is not None] + list(model.joints)
    return next((f"it has no {type(record).__name__}" for record in records if not isinstance(record, kinds)), "")
