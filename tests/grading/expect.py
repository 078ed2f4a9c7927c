"""The few ways in which a grading test compares.  A failure carries quantity, expected, got and tolerance as data."""

import re

import numpy as np


class NotYet(AssertionError):
    """An answer that is not right yet.

    quantity and tolerance may be shown to anyone.  given (the inputs), expected and got may not when the inputs are secret;
    then error, in few words, stands in for them.
    """

    def __init__(self, quantity, expected, got, tolerance, error="", given=""):
        self.quantity, self.expected, self.got, self.tolerance, self.error, self.given = quantity, expected, got, tolerance, error, given
        super().__init__(f"{quantity}{f' ({given})' if given else ''}: expected {expected}, got {got}, tolerance {tolerance}")


def numbers(quantity, got, shape, given=""):
    """got as a float array, or NotYet when it is not one of that shape or holds NaN or infinity."""
    try:
        array = np.asarray(got, dtype=float)
    except (TypeError, ValueError):
        raise NotYet(quantity, f"an array of shape {shape}", f"a {type(got).__name__}", "", f"a {type(got).__name__}", given) from None
    if array.shape != shape:
        raise NotYet(quantity, f"an array of shape {shape}", f"shape {array.shape}", "", f"shape {array.shape}", given)
    if not np.all(np.isfinite(array)):
        raise NotYet(quantity, "finite numbers", show(array), "", "not finite", given)
    return array


def close(quantity, got, expected, tolerance, given=""):
    """got equals expected, entry by entry, within an absolute tolerance.  given: the inputs, in words."""
    expected = np.asarray(expected, dtype=float)
    array = numbers(quantity, got, expected.shape, given)
    off = np.abs(array - expected)
    if not np.all(off <= tolerance):
        raise NotYet(quantity, show(expected), show(array), f"{tolerance:.1e}" if tolerance else "none: exactly this", how_far(np.max(off), np.max(np.abs(expected))), given)


def between(quantity, got, low, high, given=""):
    """low ≤ got ≤ high, for one number."""
    number = float(numbers(quantity, got, (), given))
    if not low <= number <= high:
        raise NotYet(quantity, f"{low:.6g} to {high:.6g}", f"{number:.6g}", "", how_far(max(low - number, number - high), max(abs(low), abs(high))), given)


def raises(quantity, error, function, *arguments, naming=()):
    """The call raises an error of that class (or of one of that name: compiled and sandboxed code have their own).

    naming: values of which the error's sentence must name one, to 1e-6 of it.
    """
    try:
        function(*arguments)
    except NotImplementedError:
        raise
    except Exception as e:
        if error.__name__ not in {base.__name__ for base in type(e).__mro__}:
            raise NotYet(quantity, error.__name__, f"{type(e).__name__}: {e}", "", "another error") from None
        said = [float(number) for number in re.findall(r"-?\d+\.?\d*(?:e[-+]?\d+)?|-?inf|nan", str(e))]
        if naming and not any(abs(a - b) <= 1e-6 * abs(b) for a in said for b in naming):
            raise NotYet(f"{quantity}: the value that {error.__name__} names", " or ".join(f"{value:.7g}" for value in naming), str(e), "", "another value") from None
    else:
        raise NotYet(quantity, f"{error.__name__} to be raised", "no error", "", "no error")


OFF = ("slightly off", "clearly off", "grossly off")


def how_far(off, size):
    """One of three words, by the part of what is expected that it is off: below a hundredth, below all of it, beyond.  Where zero is expected, of one unit."""
    part = off / (size or 1.0)
    return OFF[0] if part < 0.01 else OFF[1] if part < 1.0 else OFF[2]


def show(array):
    """A number or a small array in seven digits; of a large one the beginning."""
    flat = np.ravel(array)
    text = ", ".join(f"{x:.7g}" for x in flat[:9]) + (", …" if flat.size > 9 else "")
    return text if np.ndim(array) == 0 else f"({text})"
