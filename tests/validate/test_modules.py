"""One text, two speeds: the twin is the same code, its cache is found again, and it cannot go stale."""

import os
import re
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from solutions.checks import BadInput, Diverged
from validate.subject import modules, numba_twins

needs_numba = pytest.mark.skipif(not modules.can_compile(),
                                 reason="numba has no wheel for this machine: there are no compiled twins")


def in_a_new_process(code, *arguments):
    """What a fresh interpreter prints."""
    done = subprocess.run([sys.executable, "-c", code, *map(str, arguments)], cwd=modules.ROOT, capture_output=True,
                          text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


@needs_numba
def test_an_edit_to_an_imported_sibling_is_seen_by_the_compiled_twin(tmp_path):
    """Of a compiled function that another process has kept."""
    (tmp_path / "upper.py").write_text("from .lower import base\n\n\ndef doubled(x):\n    return 2.0 * base(x)\n")
    ask = ("import sys; from validate.subject.modules import bind; "
           "print(bind('upper', sys.argv[1], compiled=True).doubled(3.0))")
    (tmp_path / "lower.py").write_text("def base(x):\n    return x + 1.0\n")
    assert modules.bind("upper", tmp_path, compiled=True).doubled(3.0) == 8.0
    (tmp_path / "lower.py").write_text("def base(x):\n    return x + 5.0\n")
    os.utime(tmp_path / "lower.py", (1, 1))  # the date of the file must not matter, only what is in it
    assert in_a_new_process(ask, tmp_path) == "16.0"


@needs_numba
def test_an_edit_is_seen_within_one_process_too(tmp_path, monkeypatch):
    """Python's own cache takes two files of one length and one second for the same; it must not be asked."""
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    for number in (1.0, 2.0):
        (tmp_path / "lower.py").write_text(f"def base(x):\n    return x + {number}\n")
        os.utime(tmp_path / "lower.py", (1, 1))
        assert modules.bind("lower", tmp_path).base(0.0) == number
        assert modules.bind("lower", tmp_path, compiled=True).base(0.0) == number


IN_A_SECOND_PROCESS = """
import numpy as np
from numba.core import event
from validate.subject import modules
compiled = event.RecordingListener()
event.register("numba:compile", compiled)
lesson = modules.bind("integrators", compiled=True)
lesson.advance(lesson.verlet_step, lesson.oscillator_acceleration, 0.0, np.ones(1), np.zeros(1), 0.1, 3,
               lesson.Oscillator(1.0, 0.0))
lesson.amplification_matrix(lesson.euler_step, 1.0, 0.0, 0.1)             # hands a function on
for name in ("kepler", "linear_drag", "wind"):                            # a given law, its own, one with an exercise
    scene = modules.bind_scene(name, compiled=True)
    integrators, p = scene.lessons.integrators, scene.parameters
    scene.run(scene.lessons, integrators.euler_step, scene.law, scene.start(p), p, 0.01, 5)
print({one.data["dispatcher"].py_func.__name__ for _, one in compiled.buffer} or "nothing")
"""


@pytest.mark.long
@needs_numba
def test_a_second_process_compiles_no_function_of_a_lesson_and_no_law_of_a_scene():
    in_a_new_process(IN_A_SECOND_PROCESS)
    assert in_a_new_process(IN_A_SECOND_PROCESS) == "nothing"


@pytest.mark.long
@needs_numba
def test_two_processes_that_save_at_once_lose_nothing(tmp_path):
    (tmp_path / "lower.py").write_text("def base(x):\n    return x + x\n")
    ask = """
import sys
from time import sleep
from numba.core.caching import IndexDataCacheFile
from validate.subject.modules import bind
lesson, write = bind("lower", sys.argv[1], compiled=True), IndexDataCacheFile._save_index
# one process is in the middle of its save when the other begins
IndexDataCacheFile._save_index = lambda index, entries: (sleep(2.0), write(index, entries))
print(lesson.base(eval(sys.argv[2])), sum(lesson.base.called.stats.cache_misses.values()))
"""
    with ThreadPoolExecutor(2) as pool:
        assert list(pool.map(lambda x: in_a_new_process(ask, tmp_path, x), ("3", "1.5"))) == ["6 1", "3.0 1"]
        assert list(pool.map(lambda x: in_a_new_process(ask, tmp_path, x), ("3", "1.5"))) == ["6 0", "3.0 0"]


def test_only_sets_that_no_process_has_asked_for_for_an_hour_are_deleted_from_the_cache(tmp_path):
    """A test run binds dozens of sets at once.  Deleting one in use cost another process its entries."""
    hours = np.append(np.zeros(10), np.arange(1.5, 5.0))
    for number, age in enumerate(hours):
        (tmp_path / f"{number}").mkdir()
        os.utime(tmp_path / f"{number}", 2 * (time.time() - 3600.0 * age,))
    numba_twins.forget_old_sets(tmp_path)
    assert sorted(int(folder.name) for folder in tmp_path.iterdir()) == list(range(10))
    for number in range(10):
        os.utime(tmp_path / f"{number}", 2 * (time.time() - 3600.0 * (2 + number),))
    numba_twins.forget_old_sets(tmp_path)
    assert sorted(int(folder.name) for folder in tmp_path.iterdir()) == list(range(numba_twins.CACHED_SETS))


@needs_numba
def test_plain_and_compiled_give_the_same_bits_and_the_plain_module_stays_plain():
    plain, twin = modules.bind("integrators"), modules.bind("integrators", compiled=True)
    ends = [m.advance(m.rk4_step, m.oscillator_acceleration, 0.0, np.ones(1), np.zeros(1), 0.01, 100,
                      m.Oscillator(3.0, 0.1)) for m in (plain, twin)]
    assert np.array_equal(*ends)
    assert not hasattr(plain.rk4_step, "py_func") and hasattr(twin.rk4_step, "py_func")


@needs_numba
def test_compiled_code_frees_its_arrays_and_counts_their_references_without_locks():
    code = """
import numpy as np
from numba import njit
from numba.core.runtime import _nrt_python, rtsys
from validate.subject import modules

_nrt_python.memsys_enable_stats()
lesson = modules.bind("integrators", compiled=True)
twin = njit(lambda x, n: len([x + k for k in range(n)]))
for run in (lambda: twin(np.ones(3), 100),
            lambda: lesson.advance(lesson.rk4_step, lesson.oscillator_acceleration, 0.0, np.ones(1), np.zeros(1), 0.01,
                                   100, lesson.Oscillator(3.0, 0.1))):
    run()
    before = rtsys.get_allocation_stats()
    run()
    after = rtsys.get_allocation_stats()
    print(after.alloc - before.alloc >= 100, after.alloc - before.alloc - (after.free - before.free))
code = next(iter(twin.overloads.values())).library.get_llvm_str()
print("define linkonce_odr void @NRT_incref" in code, "atomicrmw" in code)
"""
    assert in_a_new_process(code).splitlines() == ["True 0", "True 0", "True False"]


@needs_numba
@pytest.mark.long
@pytest.mark.parametrize("d", [2, 3])
def test_arrays_that_do_not_lie_row_by_row_are_taken_too(d):
    """numba cannot compile a loop in which a transposed array and its successor are one variable."""
    lesson, x = modules.bind("contact", compiled=True), np.array([[0.0, 0.3], [0.2, 0.3], [0.0, 0.0]])[[0, 2, 1][-d:]].T
    frozen = np.broadcast_to(0.1, (2, d))
    ends = []
    for centres, half in ((x, frozen), (x.copy(), frozen.copy())):
        if d == 2:
            state, pile = lesson.make_pile_2d(centres, np.zeros(2), 1.0, 0.01, half, [(0.0, 1.0, 0.0)], (0.0, -9.81),
                                              0.3, 2, 60.0, 5.0, 0.01)
            functions = lesson.advance_pile_2d, lesson.disc_bounds, lesson.round_contacts
        else:
            state, pile = lesson.make_pile(centres, np.tile([1.0, 0.0, 0.0, 0.0], (2, 1)), 1.0, np.full((2, 3), 0.01),
                                           half, [(0.0, 0.0, 1.0, 0.0)], (0.0, 0.0, -9.81), 0.3, 2, 60.0, 5.0, 0.01)
            functions = lesson.advance_pile, lesson.ball_bounds, lesson.round_contacts
        ends.append(functions[0](*functions[1:], state, 1.0 / 240.0, 5, pile))
    assert all(np.array_equal(a, b) for a, b in zip(ends[0][:4], ends[1][:4], strict=True))


def test_a_twin_raises_the_same_errors_with_the_value_in_them():
    twin = modules.bind("integrators", compiled=True)
    with pytest.raises(BadInput, match=r"-0\.5"):
        twin.advance(twin.rk4_step, twin.oscillator_acceleration, 0.0, np.ones(1), np.zeros(1), -0.5, 1,
                     twin.Oscillator(1.0, 0.0))


def test_a_scene_uses_the_subject_it_is_bound_to(tmp_path):
    text = (modules.SOLUTIONS / "integrators.py").read_text().replace("from .", "from solutions.")
    own = "\n\ndef advance(step, acceleration, t, x, v, dt, steps, p):\n    return x + 42.0, v\n"
    (tmp_path / "integrators.py").write_text(text + own)
    scene = modules.bind_scene("oscillator", tmp_path)
    p = scene.parameters
    assert scene.run(scene.lessons, None, None, scene.start(p), p, 0.1, 1)[0] == p.x0 + 42.0
    assert modules.bind_scene("oscillator").lessons.integrators.advance.__module__ == "solutions.integrators"


OWN_EVENT = "\n\ndef advance_to_event(acceleration, t, x, v, dt, p):\n    return dt, x + 42.0, v\n"


@pytest.mark.parametrize("compiled", [False, pytest.param(True, marks=needs_numba)])
def test_a_companion_calls_the_exercises_of_its_subject(tmp_path, compiled):
    """Lesson 3's event_step is given in support/friction.py; advance_to_event, which it calls, is an exercise."""
    text = (modules.SOLUTIONS / "friction.py").read_text().replace("from .", "from solutions.")
    (tmp_path / "friction.py").write_text(text + OWN_EVENT)
    worked = modules.module_set(compiled=compiled)                   # made before the other, loaded after it
    mine, ours = modules.bind("friction", tmp_path, compiled), worked.lesson("friction")
    assert "def event_step" not in text and hasattr(mine.event_step, "py_func") == compiled
    zero = np.zeros(2)
    arguments = ours.driven_acceleration, 0.0, zero, zero, 0.1, ours.Block(np.eye(2)[1], 0.5, 0.4, zero, zero, 0.0)
    assert ours.event_step(*arguments)[0][0] == 0.0 and mine.event_step(*arguments)[0][0] == 42.0
    scene = modules.bind_scene("stick_slip", tmp_path, compiled)
    step = scene.lessons.friction.event_step
    assert getattr(step, "twin", step) is getattr(mine.event_step, "twin", mine.event_step)
    assert modules.bind_scene("stick_slip").lessons.friction.event_step.__module__ == "solutions.given.friction"


def test_a_companion_imports_exercises_from_its_lesson_only_and_no_lesson_imports_it():
    """Otherwise it would call the exercises of another subject, or of a lesson that the subject has not begun."""
    lessons = {name: (modules.SOLUTIONS / f"{name}.py").read_text() for name in modules.lesson_names()}
    for name, lesson in modules.companions().items():
        assert not [user for user, text in lessons.items() if f"from .{name} import" in text]
        text = (modules.SOLUTIONS / "given" / f"{lesson}.py").read_text()
        assert set(re.findall(r"^from \.\.(\w+) import", text, re.M)) - modules.GIVEN == {lesson}


@pytest.mark.parametrize(("call", "names"), [
    (lambda: modules.bind("juggling"), "juggling"),
    (lambda: modules.bind("integrators", "no/such/folder"), "no/such/folder"),
    (lambda: modules.bind_scene("moonwalk"), "moonwalk"),
])
def test_what_is_unknown_is_named_with_a_remedy(call, names):
    with pytest.raises(BadInput) as caught:
        call()
    assert names in str(caught.value) and ": " in str(caught.value) and "\n" not in str(caught.value)


@needs_numba
@pytest.mark.long
def test_a_scene_may_hand_a_function_of_its_lesson_to_a_compiled_loop():
    """The bowl's run gives particle_bowl_gap to advance_particle: both are twins, and the motion is the plain one."""
    plain, fast = modules.bind_scene("bowl"), modules.bind_scene("bowl", compiled=True)
    p = plain.cases["rough bowl"]
    ends = []
    for scene in (plain, fast):
        step = scene.lessons.friction.position_friction_step
        ends.append(scene.observe(scene.run(scene.lessons, step, scene.law, scene.start(p), p, 0.01, 20), p))
    assert np.array_equal(*ends)


@pytest.mark.parametrize("compiled", [False, pytest.param(True, marks=needs_numba)])
def test_a_plain_copy_of_the_solutions_raises_the_errors_that_scenes_expect(tmp_path, compiled):
    """The copy brings a file checks.py of its own.  Its classes must not replace ours, or no `except` knows them."""
    copy = tmp_path / "copy"
    shutil.copytree(modules.SOLUTIONS, copy, ignore=shutil.ignore_patterns("__pycache__"))
    lesson = modules.bind("rotation", copy, compiled)
    assert lesson.skew is not modules.bind("rotation").skew
    with pytest.raises(BadInput):
        lesson.check_rotation(np.array([2.0, 0.0, 0.0, 0.0]))
    lost = lambda a, t, x, v, dt, p: (x * np.nan, v)
    advance = modules.bind("integrators", copy, False).advance
    with pytest.raises(Diverged):
        advance(lost, lambda t, x, v, p: x, 0.0, np.ones(1), np.ones(1), 0.1, 1, None)
    assert type(modules.PLAIN.lesson("checks").finite_array) is type(lambda: None)        # ours stay as they are


def test_what_the_scenes_of_a_lesson_share_is_no_scene():
    shared = sorted(path.parent.name for path in modules.SCENES.glob("*/_*.py") if path.stem == "_common")
    assert {"integrators", "springs"} <= set(shared)
    assert not [name for name in modules.scene_names() if name.startswith("_")]
