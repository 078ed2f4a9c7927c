"""Arms of revolute joints: their records, and functions that build and check them."""

from typing import NamedTuple

import numpy as np

from ..checks import (
    BadInput,
    Diverged,
    check_array,
    check_normal,
    check_not_negative,
    check_positive,
    check_shape,
    finite_array,
    finite_number,
    number,
    whole_number,
)
from .records import check_record


class Arm2D(NamedTuple):
    """A chain in the plane, with the settings of the methods."""
    lengths: np.ndarray      # (n,) of the links [m]
    low: np.ndarray          # (n,) lower limits of the joints [rad]; −∞ for none
    high: np.ndarray         # (n,) upper limits [rad]
    rest: np.ndarray         # (n,) angles that null_space_step prefers [rad]
    gain: float              # α of transpose_step [1/m²]
    damping: float           # λ of damped_step and limited_step [m]
    pull: float              # κ of null_space_step [-]: part of the way to rest per iteration


class Arm3D(NamedTuple):
    """A chain in space, with the same settings."""
    axes: np.ndarray         # (n, 3) unit vectors along the joints, each in the frame of the link before it
    offsets: np.ndarray      # (n, 3) from a joint to the next one, or to the end, in the frame of its own link [m]
    low: np.ndarray          # as above
    high: np.ndarray
    rest: np.ndarray
    gain: float
    damping: float
    pull: float


# ---------------------------------------------------------------------------------------------- making

def limits(thing, values, n):
    """(n,) limits [rad] from one number for all or from one each; they may be infinite.  Raises BadInput for NaN."""
    array = np.zeros(0)
    try:
        array = np.asarray(values, np.float64)
    except Exception:
        raise BadInput(thing, "not an array of numbers", "give numbers only")                    # noqa: B904
    if array.ndim > 0:
        check_shape(thing, array, (n,))
    for value in array.ravel():
        if np.isnan(value):
            raise BadInput(thing, value, "give angles, or ±∞ for no limit")
    return np.zeros(n) + array


def settings(n, gain, damping, low, high, rest, pull):
    """(low, high, rest, gain, damping, pull) of an arm with n joints, checked."""
    low, high = limits("the lower limits [rad]", low, n), limits("the upper limits [rad]", high, n)
    rest = finite_array("the angles at rest [rad]", rest)
    if rest.ndim > 0:
        check_shape("the angles at rest", rest, (n,))
    gain, damping = finite_number("the gain [1/m²]", gain), finite_number("the damping [m]", damping)
    pull = finite_number("the pull to rest [-]", pull)
    check_not_negative("the gain [1/m²]", gain)
    check_not_negative("the damping [m]", damping)
    check_not_negative("the pull to rest [-]", pull)
    for k in range(n):
        if not (low[k] <= high[k] and low[k] < np.inf and high[k] > -np.inf):
            raise BadInput("the lower limit of a joint [rad]", low[k], "keep it below the upper one")
    return low, high, np.zeros(n) + rest, gain, damping, pull


def make_arm_2d(lengths, gain, damping, low, high, rest, pull):
    """An Arm2D.  low, high and rest are one number for all joints, or one each.

    Raises BadInput for a length or a setting that no arm has, and for a lower limit above the upper one.
    """
    lengths = finite_array("the lengths of the links [m]", lengths)
    check_array("the lengths of the links [m]", lengths, 1)
    for length in lengths:
        check_positive("the length of a link [m]", length)
    low, high, rest, gain, damping, pull = settings(lengths.size, gain, damping, low, high, rest, pull)
    arm = Arm2D(lengths.copy(), low, high, rest, gain, damping, pull)
    check_record(arm, low)
    return arm


def make_arm_3d(axes, offsets, gain, damping, low, high, rest, pull):
    """An Arm3D.  Raises BadInput for an axis that is no unit vector, too, and for two different numbers of joints."""
    axes, offsets = finite_array("the axes of the joints [-]", axes), finite_array("the offsets [m]", offsets)
    check_array("the axes of the joints [-]", axes, 2)
    check_shape("the axes of the joints", axes, (len(axes), 3))
    check_shape("the offsets", offsets, axes.shape)
    for k in range(len(axes)):
        check_normal(axes[k].copy())
    low, high, rest, gain, damping, pull = settings(len(axes), gain, damping, low, high, rest, pull)
    arm = Arm3D(axes.copy(), offsets.copy(), low, high, rest, gain, damping, pull)
    check_record(arm, low)
    return arm


# ---------------------------------------------------------------------------------------------- checking

def checked_reach(theta, target, tolerance, most, n):
    """(theta, target, tolerance, most) of a search with n joints, in float64; raises BadInput for what is no search."""
    theta, target = finite_array("the angles θ [rad]", theta), finite_array("the target", target)
    check_shape("the angles θ", theta, (n,))
    check_array("the target", target, 1)
    tolerance = number("the tolerance", tolerance)
    check_not_negative("the tolerance", tolerance)
    return theta, target, tolerance, whole_number("number of iterations", most, 0)


def check_found(theta, error):
    """Raise Diverged unless the angles and what is left of the way are finite."""
    if not (np.all(np.isfinite(theta)) and np.isfinite(error)):
        raise Diverged("what is left of the way [m]", error, "take a smaller gain, more damping, or a nearer target")


def wrapped(angle):
    """The same angle from −π to π [rad]."""
    return angle - 2.0 * np.pi * np.round(angle / (2.0 * np.pi))
