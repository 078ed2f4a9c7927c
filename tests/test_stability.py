"""Experiments find the stability bounds that theory gives, and a wrong method does not have them."""

import types
from functools import lru_cache

import numpy as np
import pytest

from solutions.checks import BadInput
from validate import stability

examine = lru_cache(maxsize=None)(stability.examine)


def with_its_lesson(*values, number, name):
    """A parameter in the process of its lesson's tests, which compiles the same functions."""
    lesson = stability.CASES[number][2]
    return pytest.param(*values, id=f"{number}-{name}", marks=pytest.mark.xdist_group(f"compiled test_{lesson}"))


numbers = pytest.mark.parametrize("number", [with_its_lesson(n, number=n, name=name.replace(" ", "_"))
                                             for n, (name, _, _) in stability.CASES.items()])


@numbers
def test_experiment_finds_the_bound_that_theory_gives(number):
    lost = [f for f in examine(number).findings if not f.holds]
    lines = [f"{f.quantity}: theory {f.bound}, measured {f.measured}, tolerance {f.tolerance}" for f in lost]
    assert not lost, "\n".join(lines)


@numbers
def test_a_picture_holds_plain_finite_numbers(number):
    picture = examine(number).picture
    for label, xs, ys, style in picture.series:
        assert type(xs) is type(ys) is list and len(xs) == len(ys) and np.all(np.isfinite(xs + ys)), label
        assert style in ("line", "dots")


@numbers
def test_every_finding_is_stated_in_sentences_with_a_unit(number):
    found = examine(number).findings
    for f in found:
        assert f.case == number and f.claim.endswith(".") and f.words.endswith(".") and f.quantity.endswith("]")
    assert len({f.quantity for f in found}) == len(found)


WRONG = [                         # case, method, the method that replaces it
    (1, "euler_step", "symplectic_euler_step"),
    (2, "symplectic_euler_step", "euler_step"),
    (3, "midpoint_step", "euler_step"),
    (4, "rk4_step", "midpoint_step"),
    (5, "implicit_euler_step", "implicit_midpoint_step"),
    (6, "verlet_step", "midpoint_step"),
    (6, "implicit_midpoint_step", "implicit_euler_step"),
    (7, "implicit_euler_step", "symplectic_euler_step"),
    (8, "implicit_euler_step", "implicit_midpoint_step"),
    (11, "gyroscopic_step", "implicit_gyroscopic_step"),
    (11, "matrix_step", "axis_angle_step"),
    (11, "midpoint_step", "quaternion_step"),
    (14, "splitting_step", "quaternion_step"),
    (15, "midpoint_step", "runge_kutta_step"),
    (17, "composed_splitting_step", "quaternion_step"),
]


@pytest.mark.parametrize(("number", "method", "wrong"), [with_its_lesson(n, m, w, number=n, name=f"{w}_as_{m}")
                                                         for n, m, w in WRONG])
def test_a_wrong_method_does_not_find_the_bound(number, method, wrong):
    lesson = stability.lesson_of(number)
    subject = types.SimpleNamespace(**{**vars(lesson), method: getattr(lesson, wrong)})
    with np.errstate(all="ignore"):
        found, _ = stability.CASES[number][1](subject)
    assert not all(f.holds for f in found)


def about_the_world(density, x, faces):
    V, first, second = stability.lesson_of(40).mesh_integrals(x, faces)
    C = second - np.outer(first, first) / V
    return stability.lesson_of(40).Body(density * V, first / V, density * (np.trace(C) * np.eye(3) - C))


def without_tolerance(I):
    moments = np.linalg.eigvalsh(I)
    if moments[0] <= 0.0 or moments[2] > moments[0] + moments[1]:
        raise BadInput("a tensor", moments[2], "give another")


@pytest.mark.parametrize(("number", "function"), [(40, about_the_world), (41, without_tolerance)], ids=["40", "41"])
def test_a_wrong_tensor_does_not_find_the_bound(number, function):
    method = {40: "mesh_body", 41: "check_inertia"}[number]
    subject = types.SimpleNamespace(**{**vars(stability.lesson_of(number)), method: function})
    assert not all(f.holds for f in stability.CASES[number][1](subject)[0])


def test_a_failed_measurement_is_a_finding_that_does_not_hold():
    for measured in (np.nan, np.inf):
        assert not stability.finding(1, "", "", 1.0, measured, 0.1, "").holds


def test_bisection_without_an_edge_returns_zero_or_infinity():
    assert stability.bisect(lambda h: True, 0.05, 4.0) == 0.0
    assert stability.bisect(lambda h: False, 0.05, 4.0) == np.inf
    assert stability.bisect(lambda h: h > np.pi, 0.05, 4.0) == pytest.approx(np.pi, rel=stability.EDGE)
