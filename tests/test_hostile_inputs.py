"""Whatever a person hands in, no answer is silently wrong: it is right, it is visibly no number, or a sentence names the bad value.

The ordinary calls of most functions are recorded while the worked answers take the grading tests; the rest are written below.  Then one value at a
time becomes hostile.  Two groups of functions are held to different standards:

- What a person constructs or starts (STARTED: `make_*`, the loops over steps, whole problems) answers every hostile value with BadInput, with
  Diverged, or with a right result.
- Inner functions trust what those have checked.  They may answer with any exception or with NaN, but NaN must not get lost in them, whole numbers must give
  what floats give, and ordinary numbers must not give NaN.
"""

import functools
import shutil
import signal
import types
import warnings
from collections import Counter, defaultdict

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from solutions import collisions, contact, friction, impulses, integrators, pbd, rotation, springs
from solutions.checks import BadInput, Diverged
from validate import binding

from .grading import points

up, still, down = np.array([0.0, 0.0, 1.0]), np.zeros(3), np.array([0.0, 0.0, -9.81])
q, L, I_body = np.array([1.0, 0.0, 0.0, 0.0]), np.array([0.1, 2.0, 0.2]), np.array([1.0, 2.0, 2.5])
plane, box = collisions.Plane(up, -0.1), collisions.Box(still, np.eye(3), np.array([0.5, 0.6, 0.7]))
other_box = collisions.Box(np.array([0.9, 0.1, 0.2]), np.eye(3), np.array([0.5, 0.4, 0.3]))
square, low = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]), np.array([[0.0, 0.0, 0.0], [0.5, 0.5, 0.5], [4.0, 4.0, 4.0]])
corners, faces = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
on_plane, ball = friction.OnPlane(1.0, 0.3, 0.5, down, still, up), rotation.Ball(1.0, 0.1 * np.ones(3), 0.5, 0.3, down, 0.01)
block = friction.make_block(up, 0.4, 0.3, down, np.array([8.0, 0.0, 0.0]), 2.0)
drop = impulses.Drop(0.8, down, still, up, 1e4, 10.0)
spinner = impulses.Spinner(0.8, 0.3, 1.0, 2.5 * np.eye(3), 0.4, down, still, up)
discs, pair = impulses.Discs(np.array([0.3, 0.4]), np.array([1.0, 0.5]), 0.9), np.array([[[0.0, 0.0], [1.0, 0.1]]])
solid = impulses.Solid(np.array([1.0, 0.5, -2.0]), np.array([0.1, 0.2, 0.3]), 1.0, np.diag([6.0, 7.0, 8.0]))
arms, normals = np.array([[0.1, 0.2, -0.3], [-0.1, 0.2, -0.3]]), np.stack((up, up))
rope, links = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]), np.array([[0, 1], [1, 2]])
weight, calm = np.array([0.0, -9.81]), np.array([0.5, 0.0])
oscillator = integrators.Oscillator(3.0, 0.1)
boxes = (np.array([[0.0, 0.5], [0.2, 1.45]]), np.zeros(2), 1.0, 0.2, 0.5 * np.ones((2, 2)), np.array([[0.0, 1.0, 0.0]]), weight, 0.5, 2, 60.0, 10.0, 0.02)
balls = (np.array([[0.0, 0.0, 0.5], [0.1, 0.0, 1.45]]), np.tile(q, (2, 1)), 1.0, 0.1 * np.ones((2, 3)), 0.5 * np.ones((2, 3)), np.array([[*up, 0.0]]), down, 0.5, 2, 60.0, 10.0, 0.02)

STARTED = {
    "integrators": {
        "advance": [(integrators.rk4_step, integrators.oscillator_acceleration, 0.0, np.ones(2), np.zeros(2), 0.1, 3, oscillator)],
        "trajectory": [(integrators.verlet_step, integrators.oscillator_acceleration, 0.0, np.ones(2), np.zeros(2), 0.1, 3, oscillator)]},
    "springs": {"make_mesh": [(rope, 0.1, [0], links, 50.0, 0.1, weight, calm, 0.2)]},
    "friction": {
        "make_block": [(up, 0.4, 0.3, down, still, 2.0)],
        "slip_times": [(friction.driven_acceleration, 0.0, still, still, 0.1, 3, block)],
        "contact_motion": [(friction.contact_step, friction.falling_acceleration, friction.plane_gap, 0.0, 0.1 * up, -up, 0.05, 5, on_plane),
                           (friction.gripping_step, friction.falling_acceleration, friction.plane_gap, 0.0, 0.1 * up, -up, 0.05, 5, on_plane)]},
    "inertia_tensors": {},
    "rotation": {
        "make_body": [(1.0, I_body)],
        "tumble": [(rotation.midpoint_step, rotation.no_torque, 0.0, q, L, 0.1, 3, rotation.Body(1.0, I_body))],
        "tumbling": [(rotation.splitting_step, rotation.no_torque, 0.0, q, L, 0.1, 3, rotation.Body(1.0, I_body))],
        "move": [(rotation.rigid_body_step, rotation.rolling_load, 0.0, still, np.array([1.0, 0.2, 0.0]), q, still, 0.01, 5, ball)]},
    "collisions": {
        "make_plane": [(np.array([0.0, 0.6, 0.8, 1.0]),)], "make_box": [(up, np.eye(3), 0.5 * np.ones(3))], "make_flock": [(0.1, 1.0, 2.0, 0.3, 0.4)],
        "flight": [(collisions.continuous_step, collisions.plane_gap, collisions.plane_time, 0.0, np.array([[0.0, 0.0, 1.0]]), np.array([[0.0, 0.0, -3.0]]), 0.1, 5,
                    collisions.Target(0.1, 1.0, plane))],
        "build_tree": [(low, low + 1.0)], "tree_pairs": [(low, low + 1.0)], "all_pairs": [(low, low + 1.0)], "gjk": [(corners, corners + 3.0)],
        "polygon_contacts": [(square, square + 0.8)]},
    "impulses": {
        "drop_all": [(step, impulses.falling_acceleration, 0.0, up[None], -up[None], 0.1, 5, drop)
                     for step in (impulses.penalty_step, impulses.projecting_step, impulses.backtracking_step)],
        "spin_all": [(step, impulses.falling_acceleration, 0.0, up[None], -up[None], np.ones((1, 3)), 0.1, 5, spinner)
                     for step in (impulses.projecting_spin_step, impulses.backtracking_spin_step)],
        "discs_all": [(step, pair, -pair, 0.1, 3, discs) for step in (impulses.projecting_discs_step, impulses.backtracking_discs_step)],
        "solve_impacts": [(solid, arms, normals, 0.5, 0.3)], "one_after_the_other": [(solid, arms, normals, 0.5, 0.3)]},
    "pbd": {"make_net": [(rope, 0.1, [0], links, 1e-6, 1.0, weight, 4)]},
    "contact": {
        "make_contacts": [(np.array([1, 2]), np.array([0, 1]), np.array([[0.0, 0.0], [0.0, 1.0]]), np.array([[0.0, 1.0], [0.0, 1.0]]), np.array([0.0, 1.0, 2.0]))],
        "make_pile_2d": [boxes], "make_pile": [balls],
        "advance_pile_2d": [(contact.box_bounds_2d, contact.box_contacts_2d, contact.make_pile_2d(*boxes)[0], 0.004, 2, contact.make_pile_2d(*boxes)[1])],
        "advance_pile": [(contact.ball_bounds, contact.round_contacts, contact.make_pile(*balls)[0], 0.004, 2, contact.make_pile(*balls)[1])]},
}
# What inner functions trust, because whatever starts them has checked it.  NaN may get lost in these, and zeros may divide.
TRUSTED = {
    "made by make_mesh": ("mesh_acceleration", "mass_spring_damper_step", "apply_step_matrix", "implicit_mesh_step"),
    "made by make_block": ("stopping_time", "breakaway_time"),
    "checked by contact_motion": ("gripping_step", "contact_step"),
    "made by make_net": ("falling_acceleration", "predict", "projection_step", "pbd_step", "keep_outside"),
    "moments checked by tumble and move": ("angular_velocity", "state_derivative", "angular_acceleration", "generalised_inverse_mass", "middle_axis"),
    "checked by check_boxes": ("boxes_touch", "enclose", "halve", "find_intersections"),
    "checked by check_hulls": ("support", "nearest_part", "far_enough", "nearer"),
    "corners and sides checked by make_box and outward": ("clip",),
    "checked by drop_all": ("projecting_step",),
    "the number of an axis or of a neighbour in a grid, written into the code": ("body_component", "about_axis", "grid_pairs"),
    "a horizon that steer's caller sets once": ("steer",),
    "sweeps and stiffness checked by make_net": ("pbd_sag",),
}
FREE = {name for names in TRUSTED.values() for name in names}
PATIENCE = 5.0                                             # how long a call may take [s]; ordinary ones take milliseconds
LAWS = {"advance", "trajectory", "advance_pile_2d", "advance_pile", "pile_trajectory", "contact_motion", "tumble", "tumbling", "move", "slip_times", "flight"}       # their records are a law's own, beside what they check


ANOTHER_PROBLEM = {                                        # places where another shape is another problem that makes sense
    ("make_mesh", 0): "one more point", ("make_mesh", 2): "other fixed points", ("make_mesh", 3): "other springs", ("make_mesh", 4): "one stiffness each",
    ("make_mesh", 5): "one damper each", ("make_net", 0): "one more point", ("make_net", 2): "other fixed points", ("make_net", 3): "other links",
    ("make_net", 4): "one compliance each", ("gjk", 0): "one more point", ("gjk", 1): "one more point",
}


# ---------------------------------------------------------------------------------------------- ordinary calls

@pytest.fixture(scope="module")
def ordinary(tmp_path_factory):
    """{(lesson, function): (the function, some ordinary calls)} of every public function."""
    folder = tmp_path_factory.mktemp("recording") / "answers"
    shutil.copytree(binding.SOLUTIONS, folder)
    found = {}
    for lesson in binding.lesson_names():
        module, plain = binding.bind(lesson, folder), binding.bind(lesson)
        calls = {name: [] for name, f in vars(module).items()
                 if isinstance(f, types.FunctionType) and f.__module__ == module.__name__ and not name.startswith("_")}
        for name in calls:
            setattr(module, name, recorded(getattr(module, name), calls[name]))
        points.grade(lesson, module)
        found |= {(lesson, name): (getattr(plain, name), STARTED[lesson].get(name, some[:3])) for name, some in calls.items()}
    return found


def recorded(function, calls):
    """The function; its first calls are kept."""
    @functools.wraps(function)
    def keeping(*arguments):
        if len(calls) < 3:
            calls.append(arguments)
        return function(*arguments)
    return keeping


def leaves(value, path=()):
    """Paths to the numbers and arrays in a call: positions of arguments, and names of the fields of records."""
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
    """The same call with another value in that place."""
    if not path:
        return new
    key, rest = path[0], path[1:]
    if isinstance(key, str):
        return value._replace(**{key: put(getattr(value, key), rest, new)})
    parts = [put(one, rest, new) if k == key else one for k, one in enumerate(value)]
    return type(value)(*parts) if hasattr(value, "_fields") else tuple(parts)


# ---------------------------------------------------------------------------------------------- hostile values

NUMBERS = {"NaN": np.nan, "inf": np.inf, "-inf": -np.inf, "zero": 0.0, "5e-324": 5e-324, "1e300": 1e300, "negative": None}
SHAPES = ("list", "integer", "empty", "one row more", "one column more", "another dimension")


def hostile(value, kind, entry=0):
    """The value made hostile; None where that kind does not apply to it."""
    array = np.asarray(value)
    if kind in NUMBERS:
        if array.dtype.kind != "f" and array.ndim > 0 and not isinstance(value, list):
            return None
        new = -abs(np.asarray(array, float)).ravel()[entry % max(1, array.size)] - 1.0 if kind == "negative" else NUMBERS[kind]
        if array.ndim == 0:
            return new
        changed = np.array(array, float)
        if changed.size:
            changed.ravel()[entry % changed.size] = new
        return changed
    if kind == "integer":
        if array.dtype.kind != "f" or not np.all(np.isfinite(array)):
            return None
        return int(round(float(array))) if array.ndim == 0 else np.round(array).astype(int)
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
    """All numbers of a result, in one array."""
    if isinstance(result, (tuple, list)):
        return np.concatenate([np.zeros(0), *map(flat, result)])
    return np.zeros(0) if result is None else np.asarray(result, dtype=float).ravel()


class Hangs(Exception):
    """A call that did not end within its time."""


def ring(*_):
    raise Hangs()


def answer(function, call):
    """(numbers, None), or (None, what was raised)."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        before = signal.signal(signal.SIGALRM, ring)
        signal.setitimer(signal.ITIMER_REAL, PATIENCE)
        try:
            return flat(function(*call)), None
        except Exception as e:
            return None, e
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            signal.signal(signal.SIGALRM, before)


def same(a, b):
    return a is not None and b is not None and a.shape == b.shape and np.allclose(a, b, rtol=1e-9, atol=1e-9, equal_nan=True)


def matters(function, call, path, entry):
    """Whether the result depends on that number: some other ordinary values give another one, or an error."""
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
    """One word or two for what a hostile value leads to."""
    value = hostile(at(call, path), kind, entry)
    if value is None:
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
        return "visible" if np.any(np.isnan(numbers)) else "LOST" if matters(function, call, path, entry) else "irrelevant"
    if np.any(np.isnan(numbers)):
        return "visible" if kind in ("inf", "-inf") else "overflow" if kind in ("1e300", "5e-324") else "NAN"
    return "a result"


def outcomes(function, calls):
    """[(outcome, kind, path)] over all values and kinds of some calls."""
    return [(found, kind, path) for call in calls for path in leaves(call) for kind in (*NUMBERS, *SHAPES) for entry in (0, -1)
            if (found := outcome(function, call, path, kind, entry)) is not None]


# ---------------------------------------------------------------------------------------------- the tests

def test_no_hostile_value_gives_an_answer_that_is_silently_wrong(ordinary, capsys):
    tables, faults = {True: defaultdict(Counter), False: defaultdict(Counter)}, []
    for (lesson, name), (function, calls) in ordinary.items():
        started = name in STARTED[lesson]
        for found, kind, path in outcomes(function, calls):
            tables[started][kind][found] += 1
            of_law = name in LAWS and isinstance(path[-1], str)
            if found in ("WRONG", "LOST", "NAN", "HANGS") and name not in FREE or started and found in ("another exception", "overflow", "ACCEPTED") and not of_law:
                faults.append(f"{lesson}.{name}: {kind} at {path}: {found}")
    with capsys.disabled():
        for started, table in tables.items():
            print("\n" + ("What a person constructs or starts" if started else "Inner functions"))
            columns = sorted({found for counts in table.values() for found in counts})
            print(f"{'':18}" + "".join(f"{c:>18}" for c in columns))
            for kind, counts in table.items():
                print(f"{kind:18}" + "".join(f"{counts[c]:18}" for c in columns))
    assert not faults, f"{len(faults)}:\n" + "\n".join(dict.fromkeys(faults))


TWO_AT_ONCE = st.sampled_from([(lesson, name, k) for lesson, names in STARTED.items() for name, calls in names.items() for k in range(len(calls))])


@settings(max_examples=400, derandomize=True, deadline=None, database=None, suppress_health_check=list(HealthCheck))
@given(which=TWO_AT_ONCE, draw=st.data())
def test_two_hostile_values_at_once_end_in_a_sentence_or_in_numbers(which, draw):
    """What one bad value hides from its own check, another one must not let through."""
    lesson, name, k = which
    function, call = getattr(binding.bind(lesson), name), STARTED[lesson][name][k]
    places = [path for path in leaves(call) if not isinstance(path[-1], str)]           # arguments; a law's own records are the law's
    for path in draw.draw(st.lists(st.sampled_from(places), min_size=1, max_size=2, unique=True)):
        kind = draw.draw(st.sampled_from((*NUMBERS, *SHAPES)))
        value = hostile(at(call, path), kind, draw.draw(st.integers(0, 20)))
        call = call if value is None else put(call, path, value)
    numbers, error = answer(function, call)
    assert isinstance(error, (BadInput, Diverged)) or error is None and not np.any(np.isnan(numbers)), f"{name}{call}: {error!r}"
