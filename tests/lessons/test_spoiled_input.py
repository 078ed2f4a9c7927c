"""Spoiled input to a contact problem, and to every solve_* of the lessons, is refused before the work begins.

The work is counted in calls of Python functions, not in seconds.
"""

import sys
from types import FunctionType

import numpy as np
import pytest

from solutions import contact
from solutions.checks import BadInput
from solutions.integrators import solve
from solutions.kinematics import solve_2r, solve_3r
from validate.subject import modules

from .started import STARTED
from .test_contact import stack_of
from .test_hostile_inputs import at, leaves, put

MOST_CALLS = 200             # of functions before bad input is refused [-]: checks of a few arrays; one sweep is one
BOXES = stack_of(contact, [1.0, 2.0, 0.5])
SCENE = (*BOXES, np.full(BOXES[3].a.size, 0.5))
A = np.array([[2.0, -1.0], [-1.0, 2.0]])
UNUSED = {("contact_forces", (3, "first"))}
MAY_BE_INFINITE = {("contact_forces", (5,)), ("solve_contacts", (2,)), ("solve_impacts", (4,))}       # μ = ∞: no slip
LOOPS = "solve_reach", "solve_targets"                               # they take records that make_arm_* has checked
# Single formulas, which the functions that call them check: an answer of NaN is as good as an error here.
FORMULAS = {solve: (A, np.ones(2)), solve_2r: (np.array([1.0, 0.5]), np.array([1.0, 0.8]), 1.0),
            solve_3r: (np.array([1.0, 0.5, 0.3]), np.array([1.0, 0.8, 0.2]), 1.0)}


def calls_until_end(function, arguments):
    """(result or exception, number of Python calls of the project)."""
    count = 0

    def profile(frame, event, argument):
        nonlocal count
        count += event == "call" and "solutions" in frame.f_code.co_filename

    sys.setprofile(profile)
    try:
        result = function(*arguments)
    except Exception as error:
        result = error
    finally:
        sys.setprofile(None)
    return result, count


def spoiled(call, bad):
    """(path, the call with one number replaced), for every number of every array of the call."""
    for path in leaves(call):
        value = at(call, path)
        for k in range(np.size(value)):
            changed = np.array(value, float)
            changed.ravel()[k] = bad
            yield path, put(call, path, changed if np.ndim(value) else bad)


def refused(function, arguments, because):
    result, count = calls_until_end(function, arguments)
    assert isinstance(result, BadInput), f"{function.__name__}: {because}: {result!r}"
    assert count <= MOST_CALLS, f"{function.__name__}: {because}: refused after {count} calls"


@pytest.mark.parametrize("field", ["a", "b"])
@pytest.mark.parametrize("number", [-1, 4, 10**6, 0.5])
def test_contacts_of_bodies_that_do_not_exist_are_refused(field, number):
    for k in range(SCENE[3].a.size):
        bodies = np.array(getattr(SCENE[3], field), float)
        bodies[k] = number
        refused(contact.contact_forces, put(SCENE, (3, field), bodies), f"body {number}")


def test_contacts_of_wrong_shape_or_with_wrong_normals_are_refused():
    for field in ("a", "b", "n", "p", "gap"):
        value = getattr(SCENE[3], field)
        for other in (value[:-1], np.concatenate((value, value[-1:])), value[None], value[:0]):
            refused(contact.contact_forces, put(SCENE, (3, field), other), f"{field} of shape {other.shape}")
    for size in (0.0, 1e-6, 1.0 - 1e-6, 2.0):
        refused(contact.contact_forces, put(SCENE, (3, "n"), size * SCENE[3].n), f"normals of length {size}")
    refused(contact.contact_forces, put(SCENE, (3, "b"), SCENE[3].a), "a body that touches itself")


def test_a_scene_in_which_nothing_can_move_is_refused():
    still = put(put(SCENE, (1,), 0.0 * SCENE[1]), (2,), 0.0 * SCENE[2])
    refused(contact.contact_forces, still, "all inverse masses 0")
    refused(contact.solve_contacts, (0.0 * A, -np.ones(2), np.ones(1)), "a zero Delassus matrix")
    refused(contact.solve_lcp, (0.0 * A, -np.ones(2)), "a zero Delassus matrix")


def test_matrices_of_contacts_are_refused_where_they_do_not_fit():
    b, mu = -np.ones(2), np.full(1, 0.5)
    for arguments in ((A[:1], b, mu), (A, b[:1], mu), (A, b, np.ones(2)), (A, b, -mu), (-A, b, mu), (A, b[None], mu),
                      (np.eye(3), -np.ones(3), mu), (np.zeros((0, 0)), b[:0], mu[:0])):
        refused(contact.solve_contacts, arguments, f"{[np.shape(value) for value in arguments]}")


def solvers():
    """{function: an ordinary call} of every solve_* that a lesson defines."""
    return {contact.solve_contacts: (A, -np.ones(2), np.full(1, 0.5)), contact.solve_lcp: (A, -np.ones(2)),
            contact.contact_forces: SCENE, **FORMULAS,
            **{getattr(modules.bind(lesson), name): calls[0] for lesson, names in STARTED.items()
               for name, calls in names.items() if name.startswith("solve_")}}


def test_every_solve_function_of_the_lessons_is_here():
    found = {name for lesson in modules.lesson_names() for name, value in vars(modules.bind(lesson)).items()
             if isinstance(value, FunctionType) and (name == "solve" or name.startswith("solve_"))
             and value.__module__ == f"solutions.{lesson}"}
    assert found <= {function.__name__ for function in solvers()}, found


def test_every_solve_function_refuses_nan_and_infinity_before_it_begins():
    for function, ordinary in solvers().items():
        name = function.__name__
        result, _ = calls_until_end(function, ordinary)
        assert not isinstance(result, Exception), f"{name}: the ordinary call fails: {result!r}"
        for bad in (np.nan, np.inf, -np.inf):
            for path, call in spoiled(ordinary, bad):
                if name in LOOPS and isinstance(path[-1], str):
                    continue
                if function in FORMULAS:
                    result, _ = calls_until_end(function, call)
                    lost = not isinstance(result, Exception) and np.all(np.isfinite(result))
                    assert not (np.isnan(bad) and lost), f"{name}: NaN at {path} is lost: {result}"
                elif (name, path) not in UNUSED and not (bad == np.inf and (name, path) in MAY_BE_INFINITE):
                    refused(function, call, f"{bad} at {path}")
