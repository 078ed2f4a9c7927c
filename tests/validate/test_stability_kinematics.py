"""A wrong function of lesson 11 does not find the gains, factors and distances that theory gives the right one."""

import types

import numpy as np
import pytest

from solutions import kinematics as worked
from validate.stability.examine import cases_of, found_by, subject_of


def slower(task, theta, target, arm):
    """A transpose with nine tenths of its gain."""
    return worked.transpose_step(task, theta, target, arm._replace(gain=0.9 * arm.gain))


def with_damping(times):
    """The damped step with another damping than it was told."""
    return lambda task, theta, target, arm: worked.damped_step(
        task, theta, target, arm._replace(damping=times * arm.damping))


def nudged(step):
    """A method that never stands quite straight."""
    return lambda task, theta, target, arm: step(task, theta, target, arm) + 1e-9


def backwards(task, theta, target, arm):
    """CCD from the first joint to the last, each with the old places of the others."""
    x = worked.joint_positions(theta, arm.lengths)
    r, s = x[-1] - x[:-1], target - x[:-1]
    return theta + np.arctan2(r[:, 0] * s[:, 1] - r[:, 1] * s[:, 0], np.sum(r * s, axis=1))


def half_a_sweep(task, theta, target, arm):
    """FABRIK that goes forth and not back."""
    x = worked.joint_positions(theta, arm.lengths)
    x[-1] = target
    for k in range(len(theta)):
        x[k + 1] = worked.point_at(x[k], x[k + 1], arm.lengths[k])
    return worked.angles_of(x)


def partial(task, theta, target, arm):
    """The damped step with half of the weight on the first row of the task."""
    def lighter(*arguments):
        e, J = task(*arguments)
        weights = np.append(0.5, np.ones(e.size - 1))
        return weights * e, weights[:, None] * J
    return worked.damped_step(lighter, theta, target, arm)


def no_limits(task, theta, target, arm):
    free = np.full(len(theta), np.inf)
    return worked.ccd_step(task, theta, target, arm._replace(low=-free, high=free))


def cautious(task, theta, target, arm):
    """A pseudo-inverse that is a little damped."""
    return worked.damped_step(task, theta, target, arm._replace(damping=1e-5))


def by_the_cosine(target, lengths, elbow):
    """Reaches what is out of reach."""
    cosine = (target @ target - lengths @ lengths) / (2.0 * lengths[0] * lengths[1])
    theta_2 = elbow * np.arccos(np.clip(cosine, -1.0, 1.0))
    back = np.arctan2(lengths[1] * np.sin(theta_2), lengths[0] + lengths[1] * np.cos(theta_2))
    return np.array([np.arctan2(target[1], target[0]) - back, theta_2])


def unchecked(lengths, gain, damping, low, high, rest, pull):
    fill = lambda values: np.broadcast_to(values, len(lengths)).astype(float)
    return worked.Arm2D(np.array(lengths, float), fill(low), fill(high), fill(rest), gain, damping, pull)


WRONG = [                    # case, the function that it examines, what is put in its place
    ("transpose-gain", "transpose_step", slower),
    ("straight-arm", "transpose_step", slower),
    ("straight-arm", "damped_step", with_damping(1.01)),
    ("straight-arm", "ccd_step", backwards),
    ("straight-arm", "ccd_step", nudged(worked.ccd_step)),
    ("straight-arm", "fabrik_step", half_a_sweep),
    ("straight-arm", "pseudo_inverse_step", cautious),
    ("far-targets", "damped_step", with_damping(1.01)),
    ("far-targets", "limited_step", with_damping(0.1)),
    ("two-to-two-hundred-links", "damped_step", with_damping(1.01)),
    ("two-to-two-hundred-links", "fabrik_step", half_a_sweep),
    ("conflicting-targets", "damped_step", partial),
    ("conflicting-targets", "transpose_step", lambda task, theta, target, arm: theta),
    ("limits-that-forbid", "limited_step", worked.damped_step),
    ("limits-that-forbid", "ccd_step", no_limits),
    ("extremes", "solve_2r", by_the_cosine),
    ("extremes", "make_arm_2d", unchecked),
]
IDS = [f"{slug}-{name}-{k}" for k, (slug, name, _) in enumerate(WRONG)]


@pytest.mark.long
@pytest.mark.parametrize(("slug", "name", "wrong"), WRONG, ids=IDS)
def test_a_wrong_function_does_not_find_what_theory_says(slug, name, wrong):
    case = cases_of("kinematics")[slug]
    lesson = types.SimpleNamespace(**{**vars(subject_of(case)), name: wrong})
    with np.errstate(all="ignore"):
        found, _ = found_by(case, lesson)
    assert not all(f.holds for f in found)
