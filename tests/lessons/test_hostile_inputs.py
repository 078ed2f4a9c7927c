"""No hostile input gives a silently wrong answer: the result is right, or visibly NaN, or an error names the bad value.

Ordinary calls of most functions are recorded while the worked answers run the grading tests; the others are written
in started.py. Then one value at a time is made hostile. There are two groups of functions:

- Functions that a person calls to construct or start something (STARTED: `make_*`, loops over steps, whole problems)
  answer every hostile value with BadInput, with Diverged, or with a right result.
- Inner functions trust what those have checked. They may raise any exception or return NaN. But they must not lose a
  NaN, whole numbers must give the same result as floats, and ordinary numbers must not give NaN.
"""

import signal
import warnings
from collections import Counter, defaultdict

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from solutions.checks import COUNTABLE, BadInput, Diverged
from validate.subject import modules

from .given_calls import calls_of_all
from .ordinary import ordinary_calls
from .started import STARTED

# Inner functions that trust an earlier check. They may lose a NaN and divide by zero, but whole numbers stay right.
TRUSTED = {
    "made by make_spring_network": ("spring_network_acceleration", "mass_spring_damper_step", "apply_step_matrix",
                                    "implicit_spring_network_step"),
    "made by make_block": ("stopping_time", "breakaway_time"),
    "checked by advance_particle": ("position_friction_step", "contact_step"),
    "made by make_constraint_network": ("network_gravity", "predict", "constraint_projection_step", "pbd_step",
                                        "keep_outside"),
    "moments checked by advance_rotation and advance_rigid_body": (
        "angular_velocity", "state_derivative", "angular_acceleration", "effective_inverse_mass_at",
        "intermediate_axis"),
    "checked by check_boxes": ("boxes_touch", "fit_node_box", "partition_at_median", "find_intersections"),
    "checked by check_hulls": ("support", "nearest_subsimplex", "far_enough", "nearer"),
    "corners and sides checked by make_box and outward": ("clip",),
    "checked by advance_balls": ("position_projection_step",),
    "an axis or a neighbour in a grid, written in the code": ("body_component", "about_axis", "grid_pairs"),
    "a horizon that the caller of steer sets once": ("steer",),
    "sweeps and stiffness checked by make_constraint_network": ("pbd_sag",),
    "dt, state and record checked by the loops over steps": (
        "newton_matrix", "compliant_sweep", "xpbd_step", "turning_rate", "rolling_step", "average_rolling_step",
        "carried_step", "slip_time", "exact_rolling_step", "new_velocities", "free_step"),
    "made by make_bodies or make_pile, checked by advance_contact and advance_pile": (
        "has_left_margin", "kept_impulses", "velocity_sweep", "velocity_sweep_2d", "find_contacts", "contact_step_2d",
        "contact_step", "weight", "corner_impact", "mechanical_energy", "momenta"),
    "matrices of contacts that make_contacts has checked; solve_contacts begins with zeros": (
        "gauss_seidel_sweep", "solve_lcp", "cone_residual", "cone_sweep", "proximal_sweep", "minimum_map_step",
        "fewer_sweeps", "jacobi_step", "normals_first_sweep", "minimum_map_step_with_friction",
        "fischer_burmeister_step", "relaxed_sweep"),
    "damping above 0, and limits as make_arm_2d checks them": ("ccd_step", "contraction_factors"),
    "steps, round-off and errors above 0, as their docstrings ask": (
        "central_difference", "complex_step", "best_step", "remainder_orders", "predicted_horizon"),
    "a first throw of two numbers, and a course that a person has built": ("aim",),
    "the response K of a ball, which is regular": ("my_impulse",),
    "lengths, masses, speeds and frictions above 0, as the questions give them": (
        "sliding_distance", "rolling_time", "circling_speed", "precession_rate", "my_mesh", "my_thrown_body"),
}
FREE = {name for names in TRUSTED.values() for name in names}
# LAPACK's singular values of an infinite matrix may never end, and no signal stops them.  Finite arms have none.
ENDLESS = {("pseudo_inverse", "inf"), ("pseudo_inverse", "-inf")}
PATIENCE = 5.0               # time limit of one call [s]; ordinary calls take milliseconds
# These functions do not check the records of an acceleration or a surface that they are given.
LAWS = {"advance", "advance_adaptive", "trajectory", "advance_pile_2d", "advance_pile", "pile_trajectory",
        "advance_particle", "advance_rotation", "rotation_trajectory", "advance_rigid_body", "slip_times",
        "advance_projectiles", "advance_free", "advance_contact", "advance_rocking",
        "advance_reach", "reach_trajectory", "solve_reach", "solve_targets"}


# Arguments for which another shape is another valid problem.
ANOTHER_PROBLEM = {
    ("make_spring_network", 0): "one more point", ("make_spring_network", 2): "other fixed points",
    ("make_spring_network", 3): "other springs",
    ("make_spring_network", 4): "one stiffness each", ("make_spring_network", 5): "one damper each",
    ("make_constraint_network", 0): "one more point", ("make_constraint_network", 2): "other fixed points",
    ("make_constraint_network", 3): "other links",
    ("make_constraint_network", 4): "one compliance each",
    ("gjk", 0): "one more point", ("gjk", 1): "one more point", ("solve_targets", 3): "one more target",
}


# ---------------------------------------------------------------------------------------------- ordinary calls

@pytest.fixture(scope="module")
def ordinary():
    """{(lesson, function): (function, a few ordinary calls)} for every public function."""
    return {(lesson, name): (function, STARTED[lesson].get(name, some[:2]))
            for (lesson, name), (function, some) in ordinary_calls(*modules.lesson_names()).items()}


def leaves(value, path=()):
    """Paths to the numbers and arrays in a call: indices of arguments, and names of the fields of records."""
    if isinstance(value, tuple):
        for key, one in (value._asdict().items() if hasattr(value, "_fields") else enumerate(value)):
            yield from leaves(one, (*path, key))
    elif isinstance(value, (bool, int, float, np.ndarray, np.floating, np.integer, list)) and np.size(value):
        yield path


def at(value, path):
    for key in path:
        value = getattr(value, key) if isinstance(key, str) else value[key]
    return value


def put(value, path, new):
    """The same call with another value at that path."""
    if not path:
        return new
    key, rest = path[0], path[1:]
    if isinstance(key, str):
        return value._replace(**{key: put(getattr(value, key), rest, new)})
    parts = [put(one, rest, new) if k == key else one for k, one in enumerate(value)]
    return type(value)(*parts) if hasattr(value, "_fields") else tuple(parts)


# ---------------------------------------------------------------------------------------------- hostile values

NUMBERS = {"NaN": np.nan, "inf": np.inf, "-inf": -np.inf, "zero": 0.0, "5e-324": 5e-324, "1e300": 1e300,
           "negative": None}
SHAPES = ("list", "integer", "empty", "one row more", "one column more", "another dimension")


def hostile(value, kind, entry=0):
    """The value made hostile; None if that kind does not apply to it."""
    array = np.asarray(value)
    if kind in NUMBERS:
        if array.dtype.kind != "f" and array.ndim > 0 and not isinstance(value, list):
            return None
        new = NUMBERS[kind]
        if kind == "negative":
            new = -abs(np.asarray(array, float)).ravel()[entry % max(1, array.size)] - 1.0
        if array.ndim == 0:
            return new
        changed = np.array(array, float)
        if changed.size:
            changed.ravel()[entry % changed.size] = new
        return changed
    if kind == "integer":
        if array.dtype.kind != "f" or not np.all(np.abs(array) < COUNTABLE):
            return None
        return round(float(array)) if array.ndim == 0 else np.round(array).astype(int)
    if kind == "list":
        return [float(array)] if array.ndim == 0 else array.tolist()
    if kind == "empty":
        return np.zeros((0,) * max(1, array.ndim))
    if array.ndim == 0:
        return np.zeros(2) if kind == "another dimension" else None
    if kind == "one row more":
        return np.concatenate((array, array[-1:]))
    if kind == "one column more":
        return np.concatenate((array, array[:, -1:]), axis=1) if array.ndim > 1 else None
    return array[None]


def flat(result):
    """All numbers of a result in one array."""
    if isinstance(result, (tuple, list)):
        return np.concatenate([np.zeros(0), *map(flat, result)])
    return np.zeros(0) if result is None else np.asarray(result, dtype=float).ravel()


class Hangs(Exception):
    """A call that did not end within PATIENCE."""


def ring(*_):
    raise Hangs()


def answer(function, call):
    """(numbers, None), or (None, the exception)."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        before = signal.signal(signal.SIGPROF, ring)
        signal.setitimer(signal.ITIMER_PROF, PATIENCE)
        try:
            return flat(function(*call)), None
        except Exception as e:
            return None, e
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0.0)
            signal.signal(signal.SIGPROF, before)


def same(a, b):
    if a is None or b is None or a.shape != b.shape:
        return False
    return np.allclose(a, b, rtol=1e-9, atol=1e-9, equal_nan=True)


def matters(function, call, path, entry):
    """Whether the result depends on that number: some ordinary value gives another result, or an error."""
    before, _ = answer(function, call)
    for other in (0.5, -2.0, 3.0):
        value = np.array(at(call, path), dtype=float)
        if value.ndim == 0:
            value = other * float(value) + 0.1
        else:
            value.ravel()[entry] = other * value.ravel()[entry] + 0.1
        if not same(before, answer(function, put(call, path, value))[0]):
            return True
    return False


def outcome(function, call, path, kind, entry=0):
    """The outcome of a hostile value in one or two words; capitals are faults."""
    value = hostile(at(call, path), kind, entry)
    if value is None or (function.__name__, kind) in ENDLESS:
        return None
    numbers, error = answer(function, put(call, path, value))
    if isinstance(error, BadInput):
        return "refused"
    if isinstance(error, Diverged):
        return "diverged"
    if isinstance(error, Hangs):
        return "HANGS"
    if error is not None:
        return "another exception"
    if kind in ("list", "integer"):
        floats = np.array(value, dtype=float) if np.ndim(value) else float(value)
        expected, failure = answer(function, put(call, path, floats))
        return "right" if same(numbers, expected) else "WRONG" if failure is None else "another exception"
    if kind in SHAPES:
        return "another problem" if (function.__name__, path[0]) in ANOTHER_PROBLEM else "ACCEPTED"
    if kind == "NaN":
        entry %= max(1, np.asarray(at(call, path)).size)
        if np.any(np.isnan(numbers)):
            return "visible"
        return "LOST" if matters(function, call, path, entry) else "irrelevant"
    if np.any(np.isnan(numbers)):
        return "visible" if kind in ("inf", "-inf") else "overflow" if kind in ("1e300", "5e-324") else "NAN"
    return "a result"


def is_of_a_test(call, path):
    """Whether a value is in a record that a test has defined: only the law of that test knows what it may be."""
    return any(type(at(call, path[:k])).__module__.startswith("tests.") for k in range(1, len(path)))


def outcomes(function, calls):
    """[(outcome, kind, path)] for all values and kinds of some calls."""
    found = []
    for call in calls:
        for path in (path for path in leaves(call) if not is_of_a_test(call, path)):
            for kind in (*NUMBERS, *SHAPES):
                for entry in (0, -1):
                    one = outcome(function, call, path, kind, entry)
                    if one is not None:
                        found.append((one, kind, path))
    return found


# ---------------------------------------------------------------------------------------------- the tests

@pytest.fixture(autouse=True)
def few_adapted_steps(monkeypatch):
    """What a million adapted steps would refuse is refused within the time limit of a call."""
    monkeypatch.setattr(modules.bind("integrators"), "MOST_ADAPTED_STEPS", 1000)


@pytest.mark.long
def test_no_hostile_value_gives_an_answer_that_is_silently_wrong(ordinary, capsys):
    tables = {True: defaultdict(Counter), False: defaultdict(Counter)}
    faults, inner = [], [calls for (lesson, name), (_, calls) in ordinary.items() if name not in STARTED[lesson]]
    assert sum(map(bool, inner)) > 200, "the grading tests did not run, so no inner function was recorded"
    for (lesson, name), (function, calls) in ordinary.items():
        started = name in STARTED[lesson]
        for found, kind, path in outcomes(function, calls):
            tables[started][kind][found] += 1
            of_law = name in LAWS and isinstance(path[-1], str)
            wrong = found == "WRONG" or (found in ("LOST", "NAN", "HANGS") and name not in FREE)
            unchecked = started and found in ("another exception", "overflow", "ACCEPTED")
            if wrong or (unchecked and not of_law and name not in FREE):
                faults.append(f"{lesson}.{name}: {kind} at {path}: {found}")
    with capsys.disabled():
        for started, table in tables.items():
            print("\n" + ("Functions that construct or start something" if started else "Inner functions"))
            columns = sorted({found for counts in table.values() for found in counts})
            print(f"{'':18}" + "".join(f"{c:>18}" for c in columns))
            for kind, counts in table.items():
                print(f"{kind:18}" + "".join(f"{counts[c]:18}" for c in columns))
    assert not faults, f"{len(faults)}:\n" + "\n".join(dict.fromkeys(faults))


@pytest.mark.long
def test_whole_numbers_are_right_in_every_public_function():
    """In those of given_calls.py, too: a step that copies whole numbers and writes into the copy drops fractions."""
    faults = [f"{lesson}.{name}: {path}" for (lesson, name), (function, calls) in calls_of_all().items()
              for call in STARTED[lesson].get(name, calls[:2]) for path in leaves(call)
              if outcome(function, call, path, "integer") == "WRONG"]
    assert not faults, "\n".join(dict.fromkeys(faults))


TWO_AT_ONCE = st.sampled_from([(lesson, name, k) for lesson, names in STARTED.items()
                               for name, calls in names.items() for k in range(len(calls))])


@settings(max_examples=400, derandomize=True, deadline=None, database=None, suppress_health_check=list(HealthCheck))
@given(which=TWO_AT_ONCE, draw=st.data())
def test_two_hostile_values_at_once_end_in_a_sentence_or_in_numbers(which, draw):
    """One bad value must not let another one pass its check."""
    lesson, name, k = which
    function, call = getattr(modules.bind(lesson), name), STARTED[lesson][name][k]
    # Records that belong to an acceleration or a surface are not checked by the loop.
    places = [path for path in leaves(call) if not isinstance(path[-1], str)]
    for path in draw.draw(st.lists(st.sampled_from(places), min_size=1, max_size=2, unique=True)):
        kind = draw.draw(st.sampled_from((*NUMBERS, *SHAPES)))
        value = hostile(at(call, path), kind, draw.draw(st.integers(0, 20)))
        call = call if value is None else put(call, path, value)
    numbers, error = answer(function, call)
    finite = error is None and not np.any(np.isnan(numbers))
    assert isinstance(error, (BadInput, Diverged)) or finite, f"{name}{call}: {error!r}"
