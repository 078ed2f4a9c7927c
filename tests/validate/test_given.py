"""Given code calls the exercises of its subject: a function of solutions/given/ that reaches one is theirs."""

import ast
import types

import numpy as np
import pytest

from validate.grading import release
from validate.run import coverage
from validate.subject import generate, modules
from validate.subject.modules import ROOT, SOLUTIONS, lesson_names

SPEEDS = [False, pytest.param(True, marks=pytest.mark.skipif(
    not modules.can_compile(), reason="numba has no wheel for this machine: there are no compiled twins"))]


ZERO = np.zeros(3)
BALL_ON_A_FLOOR = ZERO, ZERO, ZERO, 0.1, types.SimpleNamespace(radius=0.1, gravity=ZERO)


def written(folder, lessons=None, elsewhere=modules.GIVEN):
    """A folder with some lessons, all solved; they import the modules named in `elsewhere` from solutions."""
    folder.mkdir(exist_ok=True)
    for name in lessons or lesson_names():
        text = (SOLUTIONS / f"{name}.py").read_text()
        (folder / f"{name}.py").write_text(generate.stub(text, generate.exercises(text), elsewhere))
    return folder


def plain(value):
    """The Python function behind a compiled one."""
    return getattr(getattr(value, "twin", value), "py_func", value)


def called(function):
    """All things that a function names: globals, attributes of modules, defaults, what a closure holds."""
    space, codes = function.__globals__, [function.__code__]
    for code in codes:
        codes += [inner for inner in code.co_consts if isinstance(inner, types.CodeType)]
    names = {name for code in codes for name in code.co_names}
    found = [space[name] for name in names if name in space]
    for module in [value for value in found if isinstance(value, types.ModuleType)]:
        found += [vars(module)[name] for name in names if name in vars(module)]
    return [*found, *(function.__defaults__ or ()), *(cell.cell_contents for cell in function.__closure__ or ())]


def reached(*roots):
    """All functions of the solutions and of subjects that these reach, by (file, name)."""
    found, waiting, seen = {}, list(roots), set()
    while waiting:
        value = plain(waiting.pop())
        if isinstance(value, tuple | list):
            waiting += value
        elif isinstance(value, dict):
            waiting += value.values()
        elif isinstance(value, type) and value.__module__.startswith(("solutions.", "_plain_", "_compiled_")):
            waiting += vars(value).values()
        elif isinstance(value, types.FunctionType) and id(value) not in seen:
            seen.add(id(value))
            found[value.__code__.co_filename, value.__name__] = value
            waiting += called(value)
    return found


def lessons_reached(*roots, folder):
    """{(lesson, function)} of the lessons of that folder which these functions reach."""
    files = {str(folder / f"{name}.py"): name for name in lesson_names()}
    return {(files[file], name) for file, name in reached(*roots) if file in files}


def given_functions():
    """{(module, name): function} of solutions/given/ that reach a function of a lesson."""
    homes = {name: modules.original(name) for name in modules.given_modules() if "." in name}
    own = {(module, name): value for module, space in homes.items() for name, value in vars(space).items()
           if isinstance(value, types.FunctionType) and value.__module__ == space.__name__}
    return {place: value for place, value in own.items() if lessons_reached(value, folder=SOLUTIONS)}


def test_the_functions_that_are_known_to_call_exercises_are_found():
    known = {("bodies", "stop_slip"), ("invariants", "sweep_residual_2d"), ("joints", "turn_on"),
             ("friction", "event_step"), ("simulator", "joint_step_2d"), ("simulator", "contact_trajectory")}
    assert {(f"given.{module}", name) for module, name in known} <= given_functions().keys()


def test_given_code_below_the_lessons_calls_no_exercise():
    assert not [(module, name) for module, name in given_functions() if module.startswith("support.")]


@pytest.mark.parametrize("compiled", SPEEDS)
def test_a_given_function_reaches_the_exercises_of_its_subject_and_never_the_worked_ones(tmp_path, compiled):
    """In a folder as a student has it, each lesson builds on those beside it."""
    world = modules.module_set(written(tmp_path), compiled)
    for (module, name), worked in given_functions().items():
        here = getattr(world.given(module), name)
        assert not lessons_reached(here, folder=SOLUTIONS), (module, name)
        expected = lessons_reached(worked, folder=SOLUTIONS)
        assert lessons_reached(here, folder=tmp_path) == expected, (module, name)
        assert hasattr(here, "py_func") == compiled


@pytest.mark.parametrize("compiled", SPEEDS)
def test_nothing_that_a_lesson_or_a_scene_has_reaches_a_worked_exercise(tmp_path, compiled):
    world = modules.module_set(written(tmp_path), compiled)
    for name in lesson_names():
        assert not lessons_reached(*vars(world.lesson(name)).values(), folder=SOLUTIONS), name
    for name in modules.scene_names():
        scene = world.scene(name)
        called = [getattr(getattr(scene.lessons, lesson), function)
                  for lesson, function in modules.called_by_scene(name)]
        assert not lessons_reached(scene.run, scene.law, *called, folder=SOLUTIONS), name


@pytest.mark.parametrize("compiled", SPEEDS)
def test_an_unfinished_lesson_blocks_no_other_that_takes_it_from_the_solutions(tmp_path, compiled):
    """In a clone of the repository lessons import each other from solutions, and what is given to them does, too."""
    world = modules.module_set(written(tmp_path, elsewhere=None), compiled)
    for name in lesson_names():
        of_subject = lessons_reached(*vars(world.lesson(name)).values(), folder=tmp_path)
        assert {lesson for lesson, _ in of_subject} == {name}


@pytest.mark.parametrize("compiled", SPEEDS)
def test_a_lesson_alone_in_its_folder_has_the_worked_ones_beside_it(tmp_path, compiled):
    world = modules.module_set(written(tmp_path, ["simulator"], elsewhere=None), compiled)
    assert ("rotation", "point_velocity") in lessons_reached(world.lesson("simulator").stop_slip, folder=SOLUTIONS)
    history = world.given("given.simulator").contact_trajectory
    assert ("simulator", "advance_contact") in lessons_reached(history, folder=tmp_path)


def students_get(path):
    """Whether a module of validate/ is in their zip."""
    return path.relative_to(ROOT).as_posix() not in release.AUTHORS and "book" not in path.parts


MEASURING = sorted(filter(students_get, (ROOT / "validate").rglob("*.py")))


@pytest.mark.parametrize("path", MEASURING, ids=lambda path: path.stem)
def test_what_measures_a_subject_calls_no_worked_exercise(path):
    """In a copy without answers it would wait for ever.  What a case or a film needs, it gets with the lesson."""
    tree = ast.parse(path.read_text())
    exercises = {(row["lesson"], row["function"]) for row in coverage.table().values()}
    named = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    attributes = {(node.value.id, node.attr) for node in ast.walk(tree)
                  if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name)}
    for name, (module, there) in coverage.imported(tree).items():
        roots = {(module, there)} if there and name in named else {(module, a) for n, a in attributes if n == name}
        assert not coverage.reached(roots) & exercises, name


def test_worked_lessons_of_a_zip_stay_worked_and_the_others_are_the_students(tmp_path, monkeypatch):
    """Of a zip with some worked answers: they are imported from solutions, even if a student has such a file."""
    written(tmp_path, elsewhere=modules.GIVEN | {"rotation"})
    stop = modules.bind("simulator", tmp_path).stop_slip
    assert lessons_reached(stop, folder=SOLUTIONS) == {("rotation", "point_velocity")}
    monkeypatch.setattr(modules, "withheld", lambda lesson: {"point_velocity"} if lesson == "rotation" else set())
    (tmp_path / "other.py").write_text("from solutions.rotation import point_velocity\n")
    stop = modules.bind("simulator", written(tmp_path)).stop_slip
    assert not lessons_reached(stop, folder=SOLUTIONS)


def test_given_code_waits_for_a_lesson_that_cannot_be_loaded(tmp_path, monkeypatch):
    """In a copy without worked answers."""
    monkeypatch.setattr(modules, "withheld", lambda lesson: {"point_velocity"} if lesson == "rotation" else set())
    written(tmp_path)
    (tmp_path / "rotation.py").write_text("def point_velocity(:\n")
    simulator = modules.bind("simulator", tmp_path)
    with pytest.raises(NotImplementedError, match=r"rotation\.py cannot be loaded: SyntaxError.*line 1"):
        simulator.stop_slip(*BALL_ON_A_FLOOR)
    contact = lessons_reached(simulator.sweep_residual_2d, folder=tmp_path)
    assert ("contact", "velocity_sweep_2d") in contact


def test_given_code_waits_for_a_function_that_is_gone(tmp_path):
    text = (written(tmp_path) / "rotation.py").read_text()
    (tmp_path / "rotation.py").write_text(text.replace("def point_velocity(", "def pointvelocity("))
    simulator = modules.bind("simulator", tmp_path)
    with pytest.raises(NotImplementedError, match=r"rotation\.py has no point_velocity"):
        simulator.stop_slip(*BALL_ON_A_FLOOR)


def test_a_students_file_may_import_what_is_given_above_it(tmp_path):
    """No lesson of ours imports its companion, but a student may try."""
    more = "from solutions.given.friction import event_step\nfrom solutions.given import friction as more\n"
    with open(written(tmp_path) / "friction.py", "a") as file:
        file.write(more)
    lesson = modules.bind("friction", tmp_path)
    for step in (lesson.event_step, lesson.more.event_step):
        assert step is modules.module_set(tmp_path).given("given.friction").event_step
        assert not lessons_reached(step, folder=SOLUTIONS)


def test_records_of_a_copied_module_are_the_same_in_all_sets(tmp_path):
    """Or no `isinstance` would know them, and no other process could be sent one."""
    world = modules.module_set(written(tmp_path))
    for name in world.copied:
        for key, value in vars(modules.original(name)).items():
            if isinstance(value, type):
                assert vars(world.given(name))[key] is value


def test_modules_are_imported_at_the_top_of_given_code_where_module_sets_see_it():
    for path in (SOLUTIONS / "given").glob("*.py"):
        assert not [line for line in path.read_text().splitlines() if line.lstrip() != line
                    and line.lstrip().startswith(("import ", "from ."))], path


def functions_in(value):
    """Return the functions that a value holds."""
    if isinstance(value, types.FunctionType):
        return [value]
    inside = value.values() if isinstance(value, dict) else value if isinstance(value, list | tuple | set) else ()
    return [function for one in inside for function in functions_in(one)]


@pytest.mark.parametrize("name", [name for name in modules.given_modules() if name.startswith("given.")])
def test_no_data_of_a_module_above_the_lessons_hold_a_function(name):
    """What a module computes when it is imported keeps the worked functions, where a student's should count."""
    data = {key: value for key, value in vars(modules.original(name)).items()
            if not key.startswith("__") and not isinstance(value, types.FunctionType | types.ModuleType | type)}
    assert {key: found for key, value in data.items() if (found := functions_in(value))} == {}
