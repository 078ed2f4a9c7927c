"""Errors and checks.  Given: every lesson may raise these errors."""

import numpy as np

__all__ = [
    "UNIT", "BadInput", "Diverged", "WrongShape", "check_array", "check_end", "check_field",
    "check_finite", "check_friction", "check_indices", "check_law", "check_load", "check_normal", "check_not_negative",
    "check_positive", "check_restitution", "check_shape", "check_unit", "checked_run", "finite_array",
    "finite_number", "float_copy", "number", "one_each", "positive_number", "whole_number",
]

COUNTABLE = 1e15             # integers up to this size are exact in floats [-]
UNIT = 1e-9                  # allowed error of the length of a unit vector [-]: far above round-off


class Sentence:
    """Part of errors whose only argument is the sentence that they say: they can be sent to another process."""

    def __reduce__(self):
        return self.__class__.__new__, (self.__class__, *self.args), self.__dict__


class BadInput(Sentence, ValueError):
    """A value that makes no physical sense: names the thing, its value and the remedy."""

    def __init__(self, thing, value, remedy):
        super().__init__(f"{thing} is {value}: {remedy}")


class WrongShape(BadInput):
    """An array of the wrong shape: names the array, its shape, and the expected shape or number of dimensions."""

    def __init__(self, thing, shape, expected):
        kind = {1: "a list of numbers", 2: "a list of rows"}
        wanted = kind.get(expected, f"an array of {expected} dimensions") if isinstance(expected, int) else expected
        empty = ", not an empty one" if 0 in shape else ""
        super().__init__(f"the shape of {thing}", shape, f"give {wanted}{empty}")


class Diverged(Sentence, ArithmeticError):
    """A computation that gave no finite or no converged result: says what happened, at which value, and the remedy.

    A float is printed with eight digits.
    """

    def __init__(self, what, value, remedy):
        shown = f"{value:.8g}" if isinstance(value, float) else value
        super().__init__(f"{what} = {shown}: {remedy}")


def check_shape(thing, values, shape):
    """Raise WrongShape unless the array has this shape."""
    if values.shape != shape:
        raise WrongShape(thing, values.shape, shape)


def check_kind(thing, value, kind, remedy):
    """Raise BadInput unless a value has the fields of this NamedTuple; it may come from another copy of its file."""
    if getattr(value, "_fields", None) != kind._fields:
        raise BadInput(thing, f"a {type(value).__name__}", remedy)


def check_array(thing, values, dimensions):
    """Raise BadInput unless values is a non-empty array of finite numbers with this number of dimensions."""
    found = -1
    try:
        found = values.ndim
    except Exception:
        raise BadInput(thing, "not an array", "wrap it in np.array")       # noqa: B904   numba knows no `from`
    if found != dimensions or values.size == 0:
        raise WrongShape(thing, values.shape, dimensions)
    check_finite(thing, values)


def check_field(thing, values, shape):
    """Raise BadInput unless a field of a record is an array of finite numbers of this shape."""
    check_array(thing, values, len(shape))
    check_shape(thing, values, shape)


def check_law(thing, values, shape):
    """Raise BadInput unless a law returned an array of this shape at the start of a run."""
    found = False
    try:
        found = values.shape == shape
    except Exception:
        raise BadInput(thing, "not an array", "return an array from its law")                        # noqa: B904
    if not found:
        raise WrongShape(thing, values.shape, shape)


def check_load(result, F_shape, tau_shape):
    """Raise BadInput unless a load returned (F, tau) at the start: two arrays of finite numbers of these shapes."""
    pair = False
    try:
        pair = len(result) == 2
    except Exception:
        raise BadInput("what the load returned", "not (F, tau)", "return two arrays")            # noqa: B904
    if not pair:
        raise BadInput("what the load returned", "not (F, tau)", "return two arrays")
    F, tau = result
    check_law("force F [N]", F, F_shape)
    check_law("torque τ [N m]", tau, tau_shape)
    check_finite("force at the start [N]", F)
    check_finite("torque at the start [N m]", tau)


def check_normal(n):
    """Raise BadInput unless n (d,) is a unit vector."""
    check_unit("length of a normal [-]", np.sqrt(n @ n))


def check_unit(thing, length):
    """Raise BadInput unless a length is 1."""
    if not abs(length - 1.0) <= UNIT:
        raise BadInput(thing, length, "divide by it: the length must be 1")


def check_restitution(e):
    """Raise BadInput unless 0 ≤ e ≤ 1; above 1 every impact would gain energy."""
    if not 0.0 <= e <= 1.0:
        raise BadInput("restitution e [-]", e, "give a number from 0 to 1")


def check_friction(mu):
    """Raise BadInput unless μ is zero or more; infinity is allowed and prevents any slip."""
    if not mu >= 0.0:
        raise BadInput("friction μ [-]", mu, "give a number of zero or above")


def check_indices(thing, numbers, count):
    """Return numbers as an array of int64.  Raises BadInput unless all are in 0 … count − 1, also for −1."""
    values = finite_array(thing, numbers)
    for number in values.ravel():
        if number != np.floor(number) or not 0 <= number < count:
            raise BadInput(thing, number, f"give whole numbers from 0 to {count - 1}")
    return values.astype(np.int64)


def one_each(thing, value, count):
    """Return (count,) finite numbers of zero or more, from one number for all or one for each.  Raises BadInput."""
    values = finite_array(thing, value)
    if values.ndim > 0:
        check_shape(thing, values, (count,))
    for negative in values[values < 0.0].ravel():
        raise BadInput(thing, negative, "give zero or more")
    return np.full(count, values) if values.ndim == 0 else values.copy()


# ---------------------------------------------------------------------------------------------- values from the user

def number(thing, value):
    """Return value as a float, which may be infinite or NaN.  Raises BadInput for a list, None or text."""
    converted = np.nan
    try:
        converted = float(value * 1.0)                                     # float alone takes "1" for a number
    except Exception:
        raise BadInput(thing, "not a number", "give a number")             # noqa: B904   numba knows no `from`
    return converted


def finite_number(thing, value):
    """Return value as a float.  Raises BadInput unless it is a finite number."""
    converted = number(thing, value)
    if not np.isfinite(converted):
        raise BadInput(thing, converted, "give a finite number")
    return converted


def positive_number(thing, value):
    """Return value as a float.  Raises BadInput unless it is a finite number above zero."""
    converted = finite_number(thing, value)
    check_positive(thing, converted)
    return converted


def whole_number(thing, value, least):
    """Return value as an int.  Raises BadInput unless it is a whole number from `least` to COUNTABLE."""
    converted = finite_number(thing, value)
    if converted != np.floor(converted) or not least <= converted <= COUNTABLE:
        raise BadInput(thing, converted, "give a whole number such as 1, 2 or 100")
    return int(converted)


def finite_array(thing, values):
    """Return values as an array of float64; integers are converted, because integer arithmetic drops fractions.

    Raises BadInput for anything but an array of numbers, and for the first entry that is infinite or not a number.
    """
    array = np.zeros(0)
    try:
        array = np.asarray(values, np.float64)
    except Exception:                                    # rows of different lengths, text;  numba knows no `from`:
        raise BadInput(thing, "not an array of numbers", "give numbers only, in rows of equal length")     # noqa: B904
    check_finite(thing, array)
    return array


def float_copy(values):
    """Return a copy of an array in float64: it can be changed, and integers become floats."""
    return np.asarray(values, np.float64).copy()


def check_positive(thing, value):
    """Raise BadInput unless the number is finite and above zero; NaN is neither."""
    if not (value > 0.0 and np.isfinite(value)):
        raise BadInput(thing, value, "give a finite number above zero")


def check_not_negative(thing, value):
    """Raise BadInput unless the number is finite, and zero or more."""
    if not (value >= 0.0 and np.isfinite(value)):
        raise BadInput(thing, value, "give a finite number of zero or above")


def check_finite(thing, values):
    """Raise BadInput for the first entry of the array that is infinite or not a number."""
    for value in values.ravel():
        if not np.isfinite(value):
            raise BadInput(thing, value, "give finite numbers only")


def checked_run(t, x, v, dt, steps):
    """Return (t, x, v, dt, steps) in float64, as every loop over steps needs them before its first step.

    Raises BadInput for a step that is not positive, a number of steps that is not whole or is negative, a state that is
    not finite, and for positions and velocities of different shapes.
    """
    x = finite_array("position x [m]", x)
    v = finite_array("velocity v [m/s]", v)
    check_shape("the velocity v", v, x.shape)
    t, dt = finite_number("time t [s]", t), positive_number("step dt [s]", dt)
    return t, x, v, dt, whole_number("number of steps", steps, 0)


def check_end(x, v, dt):
    """Raise Diverged unless the state is finite.  Every loop over steps calls this after its last step."""
    if not (np.all(np.isfinite(x)) and np.all(np.isfinite(v))):
        raise Diverged("the motion is no longer finite at dt [s]", dt, "take a smaller step, or an implicit method")
