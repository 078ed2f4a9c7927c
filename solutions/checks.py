"""What may go wrong, said in one sentence.  Given: every lesson may raise these, none has to define them."""

import numpy as np


class BadInput(ValueError):
    """A value that no physics can be done with: names the thing, its value and the remedy."""

    def __init__(self, thing, value, remedy):
        super().__init__(f"{thing} is {value}: {remedy}")


class Diverged(ArithmeticError):
    """A computation that left the numbers behind: says what happened, at which value of what, and the remedy."""

    def __init__(self, what, value, remedy):
        super().__init__(f"{what} = {value}: {remedy}")


def check_positive(thing, value):
    """Raise BadInput unless the number is finite and above zero (NaN is neither)."""
    if not (value > 0.0 and np.isfinite(value)):
        raise BadInput(thing, value, "give a finite number above zero")


def check_finite(thing, values):
    """Raise BadInput with the first entry of the array that is infinite or not a number."""
    for value in values.ravel():
        if not np.isfinite(value):
            raise BadInput(thing, value, "give finite numbers only")


def check_motion(x, v, dt):
    """Raise BadInput for a step that is not positive, or for a state that is not finite: what a loop asks before its first step."""
    check_positive("step dt [s]", dt)
    check_finite("position x [m]", x)
    check_finite("velocity v [m/s]", v)


def check_end(x, v, dt):
    """Raise Diverged unless the state is still finite: what a loop asks after its last step."""
    if not (np.all(np.isfinite(x)) and np.all(np.isfinite(v))):
        raise Diverged("the motion is no longer finite at dt [s]", dt, "take a smaller step, or an implicit method")
