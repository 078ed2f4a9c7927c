"""What may go wrong, said in one sentence.  Given: every lesson may raise these, none has to define them."""

import numpy as np

COUNTABLE = 1e15             # whole numbers up to here are exact in floats [-]
UNIT = 1e-9                  # how far from 1 the length of a unit vector may be [-]: any rounding is far below


class BadInput(ValueError):
    """A value that no physics can be done with: names the thing, its value and the remedy."""

    def __init__(self, thing, value, remedy):
        super().__init__(f"{thing} is {value}: {remedy}")


class WrongShape(BadInput):
    """An array of another shape than expected: names the array, its shape, and the shape or the number of dimensions to give."""

    def __init__(self, thing, shape, expected):
        wanted = f"at least one number, in {expected} dimensions" if isinstance(expected, int) else expected
        super().__init__(f"the shape of {thing}", shape, f"give {wanted}")


class Diverged(ArithmeticError):
    """A computation that left the numbers behind: says what happened, at which value of what, and the remedy."""

    def __init__(self, what, value, remedy):
        super().__init__(f"{what} = {value}: {remedy}")


def check_shape(thing, values, shape):
    """Raise WrongShape unless the array has this shape."""
    if values.shape != shape:
        raise WrongShape(thing, values.shape, shape)


def check_array(thing, values, dimensions):
    """Raise BadInput unless values is an array of finite numbers, not empty, with so many dimensions."""
    found = -1
    try:
        found = values.ndim
    except Exception:
        raise BadInput(thing, "not an array", "wrap it in np.array")
    if found != dimensions or values.size == 0:
        raise WrongShape(thing, values.shape, dimensions)
    check_finite(thing, values)


def check_field(thing, values, shape):
    """Raise BadInput unless a field of a record is an array of finite numbers of that shape."""
    check_array(thing, values, len(shape))
    check_shape(thing, values, shape)


def check_normal(n):
    """Raise BadInput unless n (d,) is a unit vector."""
    length = np.sqrt(n @ n)
    if not abs(length - 1.0) <= UNIT:
        raise BadInput("length of a normal [-]", length, "give a unit vector")


def check_restitution(e):
    """Raise BadInput unless 0 ≤ e ≤ 1: above 1 every impact would make energy."""
    if not 0.0 <= e <= 1.0:
        raise BadInput("restitution e [-]", e, "give a number from 0 to 1")


def check_friction(mu):
    """Raise BadInput unless μ is zero or more; infinity is allowed: it holds against everything."""
    if not mu >= 0.0:
        raise BadInput("friction μ [-]", mu, "give a number of zero or above")


def check_indices(thing, numbers, count):
    """numbers as an array of int64.  Raises BadInput unless each is one of 0 … count − 1: −1 is not the last one here."""
    values = finite_array(thing, numbers)
    for number in values.ravel():
        if number != np.floor(number) or not 0 <= number < count:
            raise BadInput(thing, f"{number:g}", f"give whole numbers from 0 to {count - 1}")
    return values.astype(np.int64)


def one_each(thing, value, count):
    """(count,) finite numbers of zero or more, from one number for all or from one each.  Raises BadInput."""
    values = finite_array(thing, value)
    if values.ndim > 0:
        check_shape(thing, values, (count,))
    for negative in values[values < 0.0].ravel():
        raise BadInput(thing, negative, "give zero or more")
    return np.full(count, values) if values.ndim == 0 else values.copy()


# ---------------------------------------------------------------------------------------------- what a person gives

def number(thing, value):
    """value as a float, which may be infinite or NaN.  Raises BadInput for a list, None or a word."""
    converted = np.nan
    try:
        converted = float(value)
    except Exception:
        raise BadInput(thing, "not a number", "give a number")
    return converted


def finite_number(thing, value):
    """value as a float.  Raises BadInput unless it is a finite number."""
    converted = number(thing, value)
    if not np.isfinite(converted):
        raise BadInput(thing, converted, "give a finite number")
    return converted


def positive_number(thing, value):
    """value as a float.  Raises BadInput unless it is a finite number above zero."""
    converted = finite_number(thing, value)
    check_positive(thing, converted)
    return converted


def whole_number(thing, value, least):
    """value as an int.  Raises BadInput unless it is a whole number that is not below `least`, and that can be counted to."""
    converted = finite_number(thing, value)
    if converted != np.floor(converted) or not least <= converted <= COUNTABLE:
        raise BadInput(thing, converted, "give a whole number that is neither too small nor too large to count to")
    return int(converted)


def finite_array(thing, values):
    """values as an array of float64: whole numbers are converted, because arithmetic in whole numbers drops every fraction.

    Raises BadInput for what is no array of numbers, and with the first entry that is infinite or not a number.
    """
    array = np.zeros(0)
    try:
        array = np.asarray(values, np.float64)
    except Exception:                                    # rows of different lengths, words
        raise BadInput(thing, "not an array of numbers", "give numbers only, in rows of equal length")
    check_finite(thing, array)
    return array


def float_copy(values):
    """A copy of an array in float64: it may be changed, and whole numbers in it become numbers with a fraction."""
    return np.asarray(values, np.float64).copy()


def check_positive(thing, value):
    """Raise BadInput unless the number is finite and above zero (NaN is neither)."""
    if not (value > 0.0 and np.isfinite(value)):
        raise BadInput(thing, value, "give a finite number above zero")


def check_not_negative(thing, value):
    """Raise BadInput unless the number is finite, and zero or above."""
    if not (value >= 0.0 and np.isfinite(value)):
        raise BadInput(thing, value, "give a finite number of zero or above")


def check_finite(thing, values):
    """Raise BadInput with the first entry of the array that is infinite or not a number."""
    for value in values.ravel():
        if not np.isfinite(value):
            raise BadInput(thing, value, "give finite numbers only")


def checked_run(t, x, v, dt, steps):
    """(t, x, v, dt, steps) in float64, as every loop over steps asks for them before its first step.

    Raises BadInput for a step that is not positive, a number of steps that is not one, a state that is not finite, and for
    positions and velocities of different shapes.
    """
    x, v = finite_array("position x [m]", x), finite_array("velocity v [m/s]", v)
    check_shape("the velocity v", v, x.shape)
    return finite_number("time t [s]", t), x, v, positive_number("step dt [s]", dt), whole_number("number of steps", steps, 0)


def check_end(x, v, dt):
    """Raise Diverged unless the state is still finite.  Every loop over steps calls this after its last step."""
    if not (np.all(np.isfinite(x)) and np.all(np.isfinite(v))):
        raise Diverged("the motion is no longer finite at dt [s]", dt, "take a smaller step, or an implicit method")
