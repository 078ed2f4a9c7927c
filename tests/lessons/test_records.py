"""A record that is handed to a loop is checked before the first step, in plain Python and compiled.

Which records and which loops there are follows from the code.  One field at a time is spoiled, and the run must end in
a BadInput that names the field.
"""

import importlib
import os
import subprocess
import sys
import types

import numpy as np
import pytest

from solutions.checks import BadInput, WrongShape
from solutions.given.bodies import CarriedBall, Toppled
from solutions.support.records import RULES, Inner, check_record
from validate.subject import modules

from .started import STARTED, throw
from .test_hostile_inputs import at, put

integrators, springs, friction, rotation = map(modules.bind, ("integrators", "springs", "friction", "rotation"))
collisions, impulses, pbd, contact = map(modules.bind, ("collisions", "impulses", "pbd", "contact"))
simulator, kinematics = map(modules.bind, ("simulator", "kinematics"))
needs_numba = pytest.mark.skipif(not modules.can_compile(), reason="numba has no wheel for this machine")

up, still, down = np.array([0.0, 0.0, 1.0]), np.zeros(3), np.array([0.0, 0.0, -9.81])
points, links = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), [[0, 1], [1, 2], [2, 3]]
turned = np.array([1.0, 0.0, 0.0, 0.0])
moments, equal = np.array([1.0, 2.0, 2.5]), np.full(3, 0.004)
network = pbd.make_constraint_network(points, 0.1, [0], links, 1e-6, 0.5, down, 4)
obstacle = pbd.Obstacle(-up, 0.5, -2.0 * up, up)
plane = collisions.Plane(up, -0.1)
scene = np.array([[0.0, 0.5], [0.2, 1.45]])
flat = simulator.make_bodies_2d(scene, np.zeros(2), 1.0, 0.2, np.full((2, 2), 0.5), np.array([[0.0, 1.0, 0.0]]),
                                (0.0, -9.81), 0.5, 4, 0.02)
heap = simulator.make_bodies(points[1:3] + up, np.tile(turned, (2, 1)), 1.0, np.full((2, 3), 0.1), np.full((2, 3), 0.5),
                             np.array([[*up, 0.0]]), down, 0.5, 4, 0.02)
touching = simulator.advance_contact(simulator.contact_step_2d, simulator.weight, simulator.box_bounds_2d,
                                     simulator.box_contacts_2d, 0.0, flat[0], 0.004, 3, flat[1])
linked = simulator.make_joints(*flat, [0], [1], np.array([[0.1, 1.0]]), 0.2)
jointed = simulator.make_joints(*heap, [0], [1], np.array([[0.5, 0.5, 1.0]]), 0.2)
pile = contact.make_pile_2d(scene, np.zeros(2), 1.0, 0.2, np.full((2, 2), 0.5), np.array([[0.0, 1.0, 0.0]]),
                            (0.0, -9.81), 0.5, 2, 60.0, 10.0, 0.02)
settings = (0.1, 0.3, [-2.0, -2.0], [2.0, 2.5], [0.1, 0.2], 0.5)

# Records of every kind that has a rule, each with a state that it fits.
EXAMPLES = (
    (integrators.Oscillator(3.0, 0.1), np.ones(2)),
    (springs.make_spring_network(points, 0.1, [0], links, 50.0, 0.1, down, still, 0.2), points),
    (friction.make_block(up, 0.4, 0.3, down, np.array([8.0, 0.0, 0.0]), 2.0), still),
    (friction.ParticleOnPlane(1.0, 0.3, 0.5, down, still, up), up),
    (friction.ParticleInBowl(1.0, 0.3, 0.5, down, still, np.array([0.0, 1.0, 0.0]), 2.0), up),
    (rotation.RigidBody(1.0, moments), still), (rotation.Top(moments, 2.0), still),
    (rotation.RollingBall(1.0, equal, 0.1, 0.3, down), still),
    (CarriedBall(1.0, equal, 0.1, 0.3, down, still, still, up), still),
    (plane, up), (collisions.Target(0.1, 1.0, plane), points), (collisions.make_flock(0.1, 1.0, 2.0, 0.3, 0.4), points),
    (impulses.BouncingBall(0.8, down, still, up, 1e4, 10.0), points),
    (impulses.SpinningBall(0.8, 0.3, 1.0, 2.5 * np.eye(3), 0.4, down, still, up), points),
    (impulses.Discs(np.full(4, 0.1), np.ones(4), 0.9), points),
    (network, points), (obstacle, points),
    (pbd.Cloth(network, np.array([[0, 1, 2, 3]]), np.zeros(1), 0.5, obstacle), points),
    (pbd.Balloon(network, np.array([[0, 2, 1], [0, 1, 3]]), 0.1, 0.0, obstacle), points),
    (pbd.PivotedBody(1.0, moments, down, still, up, 4), still),
    flat[::-1], heap[::-1], (linked, flat[0]), (jointed, heap[0]), pile[::-1],
    (touching, touching),
    (simulator.RockingBlock(1.0, 0.1, 0.5, 0.09, 9.81), np.zeros(1)),
    (simulator.RodsInAngles(1.0, 1.0, 0.1, 9.81), np.zeros(2)),
    (simulator.Cradle(0.12, 1.0, 0.05, 1.001, 9.81), np.zeros(2)),
    (throw.course, throw.x), (throw, throw.x),
    (kinematics.make_arm_2d([1.0, 0.8], *settings), np.zeros(2)),
    (kinematics.make_arm_3d([up, up], np.ones((2, 3)), *settings), np.zeros(2)),
)

# Records without a rule, and the reason.
NO_RULE = {
    "BodyState2D": "impact_2d checks what it divides by", "BodyState3D": "check_impacts checks it",
    "RigidBodyState": "an argument of an exercise, no loop takes it", "MassProperties": "a result",
    "Contact": "a result", "Contacts": "a result", "Pairs": "a result",
    "Tree": "made by build_tree", "Arms": "made anew per step", "JointArms": "made anew per step",
    "StepMatrix": "made anew per step", "Lanes": "made anew per step", "Impact": "made anew per impact",
    "Sliding": "made anew per impact", "Suspects": "made anew per step", "Ways": "made at the beginning of a run",
    **dict.fromkeys(("Ball", "BallJoint", "Body", "Box", "Capsule", "Distance", "Drag", "Force", "HalfSpace", "Hinge",
                     "Model", "Polygon", "Polyhedron", "Spring", "Weld"), "make_model checks it"),
    **dict.fromkeys(("Composed", "Cores", "Hulls", "Kit", "Loop", "Part", "Rods", "Rough", "RoundedBoxes", "Smooth"),
                    "made by compose from a checked Model"),
    "Settings": "compose checks it", "State": "a result"}


# ---------------------------------------------------------------------------------------------- found in the code

def solution_modules():
    """Every module below solutions."""
    names = [".".join(path.relative_to(modules.ROOT).with_suffix("").parts) for path in modules.SOLUTIONS.rglob("*.py")]
    return [importlib.import_module(name) for name in sorted(names) if not name.endswith("__init__")]


def record_types():
    """Every NamedTuple that a module of solutions defines."""
    return {value.__name__: value for module in solution_modules() for value in vars(module).values()
            if isinstance(value, type) and hasattr(value, "_fields") and value.__module__ == module.__name__}


def loops(course):
    """Names of the functions of a lesson and its companion that check a record and do not make it."""
    own = {name: f for name, f in vars(modules.bind(course)).items()
           if isinstance(f, types.FunctionType) and f.__module__.endswith(f".{course}")}
    return sorted(name for name, f in own.items()
                  if name in modules.checks_of(f.__code__.co_filename, "") and not name.startswith("make_"))


def test_every_record_has_a_rule_and_an_example_or_a_reason_to_have_none():
    ours = {"Bound", "Field", "Row", "Inner", "Rule"}
    with_rule = {name for name, kind in record_types().items() if kind._fields in RULES}
    assert with_rule == {type(at(record, path[:k])).__name__ for record, _ in EXAMPLES
                         for path in fields(record) for k in range(len(path))}
    assert touching.contacts.a.size > 0
    assert set(record_types()) - with_rule - ours == set(NO_RULE)
    assert len(RULES) == len(with_rule), "two records with the same fields, or a rule for a record that is gone"


TAKES_A_RECORD = {"p", "body", "ball", "block", "arm", "pile", "network"}
INNER = {"advance_to_event": "a part of a step", "advance_to_plane": "a part of a step"}


@pytest.mark.parametrize("course", modules.lesson_names())
def test_every_loop_that_takes_a_record_checks_it(course):
    for name, f in vars(modules.bind(course)).items():
        last = ""
        if isinstance(f, types.FunctionType) and f.__code__.co_argcount:
            last = f.__code__.co_varnames[f.__code__.co_argcount - 1]
        runs = name.startswith(("advance", "solve_")) or name.endswith("trajectory")
        if runs and last in TAKES_A_RECORD and name not in INNER:
            assert "check_record" in f.__code__.co_names, f"{course}.{name} does not check its record"


MADE_OF_CHECKED_PARTS = {"make_plane": "a unit normal by division", "make_box": "a Box has no rule",
                         "make_model": "its records have no rule; model_checks.py checks them",
                         "make_contacts": "check_contacts of contact_forces checks it"}


def test_every_function_that_makes_a_record_checks_it_by_the_same_rule():
    made = {name: f for module in solution_modules() for name, f in vars(module).items()
            if name.startswith("make_") and isinstance(f, types.FunctionType)}
    assert {name for name, f in made.items() if "check_record" not in f.__code__.co_names} == set(MADE_OF_CHECKED_PARTS)


# ---------------------------------------------------------------------------------------------- spoiled fields

# Fields whose numbers may have any sign, and those that may be infinite.
SIGNED = {"gravity", "wind", "drive", "omega", "zeta", "point", "centre", "plane", "mgl", "floor_v", "floor_omega",
          "d", "align", "gather", "fold", "volume", "pivot", "arm_body", "p", "gap", "x", "q", "v", "J", "low", "high",
          "rest", "offsets", "r_a", "r_b", "g", "loops", "e_s", "target"}
MAY_BE_INFINITE = {"mu", "mu_s", "low", "high"}
NOT_NEGATIVE_ALL_THE_SAME = {("ConstraintNetwork", "rest"), ("SpringNetwork", "rest"), ("RockingBlock", "g")}
# A smaller number of rows, or of columns, is another valid record.
OTHER_ROWS = {("Balloon", "faces"), ("ContactSet", "first")}
OTHER_COLUMNS = {("Course", "e_s")}


def spoiled(record, name):
    """[(what was done, the spoiled value)] of a field, all of which no loop may accept."""
    value, kind = getattr(record, name), type(record).__name__
    if np.ndim(value) == 0:
        values = [("NaN", np.nan), ("text", "one"), ("nothing", None), ("a list", [1.0]), ("an array", np.ones(2))]
        bad = {"infinite": np.inf, "negative": -1.0}
    else:
        values = [("text", "one"), ("nothing", None), ("a list", value.tolist()), ("a number", 1.0),
                  ("another dimension", value[None])]
        if value.shape[0]:
            values += [("a row less", value[:-1])] * ((kind, name) not in OTHER_ROWS)
            values += [("a row more", np.concatenate((value, value[-1:])))] * ((kind, name) not in OTHER_ROWS)
        if value.ndim > 1 and (kind, name) not in OTHER_COLUMNS:
            values.append(("a column less", value[:, :-1].copy()))
        if not value.size:
            return values
        floats = value.dtype.kind == "f"
        values.append(("the other kind of numbers", np.ones(value.shape, np.int64 if floats else float)))
        if not floats:
            return [*values, *(("out of range", entry(value, number)) for number in (-1, 1000))]
        values += [("NaN", entry(value, np.nan)), ("NaN at the end", entry(value, np.nan, -1))]
        bad = {"infinite": entry(value, np.inf), "negative": entry(value, -2.0)}
    signed = name in SIGNED and (kind, name) not in NOT_NEGATIVE_ALL_THE_SAME
    return values + [(how, new) for how, new in bad.items()
                     if not ((how == "negative" and signed) or (how == "infinite" and name in MAY_BE_INFINITE))]


def entry(array, number, k=0):
    """A copy of the array with one other number."""
    array = array.copy()
    array.ravel()[k] = number
    return array


def fields(record, path=()):
    """Paths to the fields of a record and of the records in it."""
    for name in record._fields:
        inner = getattr(record, name)
        if hasattr(inner, "_fields"):
            yield from fields(inner, (*path, name))
        else:
            yield (*path, name)


def thing_of(record, path):
    """The name of a field in errors."""
    owner = at(record, path[:-1])
    field = dict(zip(owner._fields, RULES[owner._fields].fields.values(), strict=True))[path[-1]]
    assert not isinstance(field, Inner)
    return field.thing.split(" [")[0].split(" of ")[0]


def sentence(what, run, *arguments):
    """The text of the BadInput that a call must end in."""
    try:
        run(*arguments)
    except BadInput as refused:
        return str(refused)
    return pytest.fail(f"{what}: accepted")


@pytest.mark.parametrize(("record", "state"), EXAMPLES, ids=lambda value: type(value).__name__)
def test_a_record_with_one_spoiled_field_is_refused_in_a_sentence(record, state):
    check_record(record, state)
    for path in fields(record):
        for how, value in spoiled(at(record, path[:-1]), path[-1]):
            changed = put(record, path, value)
            said = sentence(f"{'.'.join(path)}, {how}", check_record, changed, changed if state is record else state)
            assert ": " in said and "\n" not in said
            assert how not in ("NaN", "text", "nothing") or thing_of(record, path) in said, (path, how)


@pytest.mark.parametrize(("record", "state"), EXAMPLES, ids=lambda value: type(value).__name__)
def test_no_number_that_is_not_one_stays_unseen(record, state):
    """A field whose rule forgets a NaN would be found here even if `spoiled` did not list it."""
    for path in fields(record):
        value = at(record, path)
        if np.size(value) and np.asarray(value).dtype.kind == "f":
            changed = put(record, path, np.full(np.shape(value), np.nan)[()])
            sentence(path, check_record, changed, changed if state is record else state)


# ---------------------------------------------------------------------------------------------- several fields

def refused(said, record, state, **changed):
    with pytest.raises(BadInput, match=said):
        check_record(record._replace(**changed), state)


def test_a_record_that_was_right_is_checked_again_after_a_change():
    """Right records are remembered by their content."""
    rope = modules.bind("pbd").make_constraint_network(
        np.array([[0.0, 0.0], [1.0, 0.0]]), 1.0, [0], [(0, 1)], 0.0, 1.0, (0.0, -9.81), 3)
    x = np.zeros((2, 2))
    check_record(rope, x)
    rope.rest[0] = -1.0
    with pytest.raises(BadInput, match="length"):
        check_record(rope, x)
    rope.rest[0] = 1.0
    check_record(rope, x)
    with pytest.raises((BadInput, WrongShape)):
        check_record(rope, np.zeros((3, 2)))
    with pytest.raises(BadInput, match="length"):
        check_record(rope._replace(rest=[1.0]), x)


def test_moments_are_those_that_a_body_can_have():
    solid, ball, state = rotation.RigidBody(1.0, moments), rotation.RollingBall(1.0, equal, 0.1, 0.3, down), still
    refused("no distribution of mass", solid, state, I_body=np.array([1.0, 1.0, 5.0]))
    refused("three equal moments", ball, state, I_body=moments)
    turns = heap[1].inv_inertia
    refused("no distribution of mass", heap[1], heap[0], inv_inertia=turns * np.array([1.0, 1.0, 0.2]))
    refused("beside an infinite one", heap[1], heap[0], inv_inertia=turns * np.array([0.0, 1.0, 1.0]))
    refused("same about any axis", impulses.SpinningBall(0.8, 0.3, 1.0, np.eye(3), 0.4, down, still, up), points,
            inv_inertia=np.diag([1.0, 1.0, 2.0]))
    check_record(heap[1]._replace(inv_inertia=turns * np.array([[0.0], [1.0], [1.0]])), heap[0])
    flat_body = 1.0 / np.array([0.1, 0.2, 0.1 + 0.2])                # round-off must not refuse a flat body
    check_record(heap[1]._replace(inv_inertia=np.array([flat_body, flat_body, still])), heap[0])


def test_make_bodies_refuses_moments_that_no_body_has():
    make = lambda inertia: simulator.make_bodies([up], [turned], 1.0, [inertia], [[0.5, 0.5, 0.5]], [], down, 0.5, 4,
                                                 0.02)
    make([1.0, 1.0, 2.0])
    make([np.inf, np.inf, np.inf])
    for inertia in ([1.0, 1.0, 5.0], [np.inf, 1.0, 1.0], [1.0, np.inf, 1.0]):
        with pytest.raises(BadInput, match="moment"):
            make(inertia)


def test_rows_of_a_record_are_those_of_the_state():
    for field, value in (("planes", np.zeros((0, 3))), ("planes", np.zeros((1, 2))), ("inv_inertia", np.zeros(1)),
                         ("half", np.full((3, 2), 0.1)), ("gravity", np.array([-9.81])), ("gravity", down)):
        with pytest.raises(BadInput):
            check_record(flat[1]._replace(**{field: value}), flat[0])
    refused("never moves", flat[1], flat[0], inv_mass=np.ones(3))
    few = touching.contacts._replace(first=touching.contacts.first[[0, -1]])
    with pytest.raises(WrongShape, match="first"):
        check_record(flat[1], touching._replace(contacts=few))
    with pytest.raises(BadInput):
        check_record(heap[1], flat[0])


def test_links_and_joints_join_two_rows_of_which_one_can_move():
    refused("name two points", network, points, i=network.j)
    refused("between immovable points", network, points, inv_mass=np.zeros(4))
    refused("of which one can move", linked, flat[0], joints=linked.joints._replace(a=linked.joints.b))
    refused("at most the static", EXAMPLES[2][0], still, mu_k=0.5)
    refused("below the upper", EXAMPLES[-1][0], np.zeros(2), low=np.full(2, 3.0))


def test_a_record_of_ones_own_has_no_rule_and_a_subject_has_classes_of_its_own():
    """Records are known by their fields: a student's file defines the same classes anew."""
    check_record(None, still)
    check_record(EXAMPLES, still)
    theirs = modules.bind("integrators", modules.ROOT / "lessons").Oscillator
    assert theirs is not integrators.Oscillator
    with pytest.raises(BadInput, match=r"ω.* is nan"):
        check_record(theirs(np.nan, 0.1), still)


# ---------------------------------------------------------------------------------------------- loops

def calls(course):
    """[(name, its call)] of the loops of a lesson, ordinary ones."""
    return [(name, call) for name in loops(course) for call in (*STARTED[course].get(name, ()), *MORE.get(name, ()))]


WITH_CONTACT = (simulator.weight, simulator.box_bounds_2d, simulator.box_contacts_2d, 0.0, touching, 0.004, 2)
ON_A_FLOOR = (rotation.supported_weight, 0.0, 0.1 * up, turned, np.array([1.0, 0.0, 0.0]), still, 0.01, 5)
MOVES = (pbd.network_gravity, 0.0, points, 0.0 * points, 0.004, 2, network)
FLAT_STATE = flat[0][:4]
NETWORK_STEPS = pbd.pbd_step, pbd.xpbd_step, pbd.rattle_step, pbd.constraint_projection_step

# Calls beside those of started.py.
MORE = {
    "advance": [(step, *MOVES) for step in NETWORK_STEPS],
    "advance_rigid_body": [(simulator.carried_step, *ON_A_FLOOR, EXAMPLES[8][0])],
    "advance_free": [(simulator.joint_step_2d, simulator.weight, 0.0, *FLAT_STATE, 0.004, 2, linked)],
    "advance_contact": [(simulator.joint_contact_step_2d, *WITH_CONTACT, linked)],
    "contact_trajectory": [(simulator.contact_step_2d, *WITH_CONTACT, flat[1])],
    "pile_trajectory": [(contact.advance_pile_2d, contact.box_bounds_2d, contact.box_contacts_2d, pile[0], 0.004, 2,
                         pile[1])],
    "rotation_trajectory": [(rotation.midpoint_step, rotation.heavy_top_torque, 0.0, turned, up, 0.01, 3,
                             rotation.Top(moments, 2.0))],
    "slip_times": [(friction.driven_acceleration, 0.0, still, still, 0.1, 3, EXAMPLES[2][0])],
}


@pytest.mark.parametrize("course", [name for name in modules.lesson_names() if loops(name)])
@pytest.mark.parametrize("compiled", [False, pytest.param(True, marks=needs_numba)])
def test_a_loop_refuses_every_record_with_a_spoiled_field(course, compiled):
    """A compiled loop refuses it before anything is compiled: the check is plain Python."""
    assert {name for name, _ in calls(course)} == set(loops(course)), "a loop without an ordinary call"
    module = modules.bind(course, compiled=compiled)
    for name, call in calls(course):
        record = call[-1]
        if type(record)._fields not in RULES:
            continue
        for path in fields(record):
            for how, value in spoiled(at(record, path[:-1]), path[-1]):
                sentence(f"{name}: {type(record).__name__}.{'.'.join(path)}, {how}", getattr(module, name), *call[:-1],
                         put(record, path, value))


@pytest.mark.parametrize("course", [name for name in modules.lesson_names() if loops(name)])
def test_ordinary_calls_of_all_loops_run(course):
    for name, call in calls(course):
        getattr(modules.bind(course), name)(*call)


@pytest.mark.parametrize("course", [name for name in modules.lesson_names() if loops(name)])
def test_a_law_that_returns_no_array_of_the_right_shape_is_refused(course):
    """None, a list, an array of another shape: each gives one sentence before the first step."""
    refusals = 0
    for name, call in calls(course):
        for k, f in enumerate(call):
            if not isinstance(f, types.FunctionType) or f.__name__ not in LAWS:
                continue
            for wrong in (None, [0.0, 0.0], np.zeros((5, 5)), np.zeros(1)):
                sentence(f"{name}: a law that returns {wrong}", getattr(modules.bind(course), name), *call[:k],
                         lambda *_, y=wrong: y, *call[k + 1:])
                refusals += 1
    assert refusals > 0 or course in ("collisions", "contact", "kinematics")


# Names of the laws that the ordinary calls use.
LAWS = {"oscillator_acceleration", "attraction", "falling_acceleration", "driven_acceleration", "no_torque", "weight",
        "supported_weight", "heavy_top_torque", "network_gravity"}


# ---------------------------------------------------------------------------------------------- single findings

def test_a_ball_on_a_floor_with_gravity_upwards_is_not_pushed():
    """A floor never pulls: N = max(0, −m g_z), so no friction acts and the ball keeps its velocity."""
    ball = EXAMPLES[8][0]._replace(gravity=-down)
    v, omega = simulator.stop_slip(np.array([1.0, 0.0, 0.0]), still, still, 0.01, ball)
    assert np.array_equal(v, [1.0, 0.0, 0.0]) and not omega.any()
    for mu in (-0.3, np.nan):
        with pytest.raises(BadInput, match="friction"):
            simulator.carried_step(*ON_A_FLOOR[:-1], ball._replace(mu=mu))


@pytest.mark.parametrize("speed", [1.0, 7.0])
def test_without_a_limit_of_friction_a_ball_rolls_at_once_with_five_sevenths_of_its_speed(speed):
    ball = rotation.RollingBall(1.0, equal, 0.1, np.inf, down)       # 2/5 m r² = 0.004
    for step in (simulator.exact_rolling_step, rotation.average_rolling_step):
        start = 0.1 * up, turned, np.array([speed, 0.0, 0.0]), still
        _, _, v, omega = step(rotation.supported_weight, 0.0, *start, 0.01, ball)
        assert abs(v[0] - 5.0 / 7.0 * speed) < 1e-14 * speed and abs(0.1 * omega[1] - v[0]) < 1e-14 * speed


def test_a_block_that_leans_too_far_falls_on_its_side_and_the_error_names_the_angle():
    block = simulator.RockingBlock(1.0, 0.1, 0.4, 0.17 / 3.0, 9.81)  # α = 0.245 rad
    run = lambda lean, steps: simulator.advance_rocking(integrators.rk4_step, 0.0, np.array([lean]), np.zeros(1), 0.005,
                                                        steps, block)
    assert abs(run(0.24, 400)[0][0]) < 0.24
    for lean, sign in ((0.3, ""), (-0.3, "-")):
        with pytest.raises(Toppled, match=rf"lean of a rocking block \[rad\] = {sign}1\.[56]"):
            run(lean, 400)
    with pytest.raises(BadInput, match="lean"):
        simulator.advance_rocking(integrators.rk4_step, 0.0, np.zeros(2), np.zeros(2), 0.005, 3, block)


def test_a_quaternion_of_another_length_than_one_is_refused():
    state, p = heap
    with pytest.raises(BadInput, match=r"quaternion.* is 2\.0"):
        simulator.advance_contact(simulator.contact_step, simulator.weight, simulator.ball_bounds,
                                  simulator.round_contacts, 0.0, state._replace(q=2.0 * state.q), 0.01, 1, p)


@needs_numba
def test_make_functions_of_the_compiled_set_take_lists():
    fast = modules.bind("simulator", compiled=True)
    state, p = fast.make_bodies_2d([[0, 1]], [0], 1, 0.1, [[1, 1]], [], [0, -10], 0.5, 4, 0.01)
    assert state.x.dtype == float and p.planes.shape == (0, 3)
    with pytest.raises(BadInput, match="angle"):
        fast.make_bodies_2d([[0, 1]], ["one"], 1, 0.1, [[1, 1]], [], [0, -10], 0.5, 4, 0.01)


@pytest.mark.parametrize("step", NETWORK_STEPS, ids=lambda step: step.__name__)
@pytest.mark.parametrize("fixed", [[], [0], [0, 1, 2, 3]])
def test_a_network_without_links_falls_freely(step, fixed):
    """After two steps of dt the free points are 3 g dt² below for implicit Euler, 2 g dt² for a second-order step."""
    free = pbd.make_constraint_network(points, 0.1, fixed, [], 0.0, 1.0, down, 4)
    x, _ = integrators.advance(step, pbd.network_gravity, 0.0, points, 0.0 * points, 0.01, 2, free)
    expected = np.full(4, -9.81 * 1e-4 * (2.0 if step is pbd.rattle_step else 3.0))
    expected[fixed] = 0.0
    assert np.allclose((x - points)[:, 2], expected, rtol=0.0, atol=1e-15)
    assert np.array_equal(x[:, :2], points[:, :2])


def test_a_network_in_which_nothing_moves_stays():
    stuck = springs.make_spring_network(points, 0.1, [0, 1, 2, 3], links, 50.0, 0.1, down, still, 0.2)
    for step in (springs.implicit_spring_network_step, integrators.rk4_step):
        x, _ = integrators.advance(step, springs.spring_network_acceleration, 0.0, points, 0.0 * points, 0.01, 2, stuck)
        assert np.array_equal(x, points)


@pytest.mark.parametrize(("state", "p", "step", "bounds"), [
    (*flat, simulator.contact_step_2d, simulator.disc_bounds), (*heap, simulator.contact_step, simulator.ball_bounds)])
def test_what_is_round_has_one_radius(state, p, step, bounds):
    run = lambda half: simulator.advance_contact(step, simulator.weight, bounds, simulator.round_contacts, 0.0, state,
                                                 0.004, 1, p._replace(half=half))
    run(p.half)
    with pytest.raises(BadInput, match="half size of a disc or sphere"):
        run(entry(p.half, 0.4, -1))


# ---------------------------------------------------------------------------------------------- behind an array

def twin(value):
    """The compiled form of a function of solutions or of a test, everything else as it is."""
    if not isinstance(value, types.FunctionType):
        return value
    if not value.__module__.startswith("solutions."):
        import numba
        return numba.njit(value)
    home = modules.module_set(compiled=True).solution(value.__module__.removeprefix("solutions."))
    return vars(home)[value.__name__]


def run_compiled():
    """Make every ordinary call of every loop, compiled; then one without its check, which must read behind an array."""
    for course in modules.lesson_names():
        for name, call in calls(course) if loops(course) else ():
            print(course, name, getattr(call[0], "__name__", ""), flush=True)
            getattr(modules.bind(course, compiled=True), name)(*map(twin, call))
    call = (simulator.contact_step_2d, *WITH_CONTACT, flat[1]._replace(inv_inertia=np.ones(1)))
    unchecked = vars(modules.module_set(compiled=True).solution("simulator"))["advance_contact"].from_python()
    with pytest.raises(IndexError):
        unchecked(*map(twin, call))
    print("all ran", flush=True)


@needs_numba
@pytest.mark.long
def test_no_compiled_loop_reads_behind_an_array():
    """numba compiles all loops anew with a check of every index, in a process of its own."""
    run = subprocess.run([sys.executable, "-c", "from tests.lessons.test_records import run_compiled; run_compiled()"],
                         env={**os.environ, "NUMBA_BOUNDSCHECK": "1"}, cwd=modules.ROOT, capture_output=True, text=True,
                         check=False)
    assert run.returncode == 0 and run.stdout.endswith("all ran\n"), run.stdout[-200:] + run.stderr[-2000:]
