"""Records and functions that compiled code gets by their addresses, and the loops that are made of such functions."""

import sys
from typing import NamedTuple

import numpy as np
import pytest

from solutions.given import compose
from solutions.support.model import (
    WORLD,
    Ball,
    BallJoint,
    Body,
    Box,
    Capsule,
    Distance,
    Drag,
    HalfSpace,
    Hinge,
    Polyhedron,
    Spring,
    make_model,
)
from validate.subject import modules
from validate.worlds.ours import lesson_of

numba = pytest.importorskip("numba", reason="numba has no wheel for this machine")
addresses = pytest.importorskip("validate.subject.addresses")

DOWN = (0.0, -9.81)


class Scaling(NamedTuple):
    """A record with an array."""
    factors: np.ndarray
    share: float


def scaled(x, p):
    """Return x, scaled; raises where a factor is not positive."""
    if np.min(p.factors) <= 0.0:
        raise ArithmeticError("a factor is not positive")
    return p.share * p.factors * x


def twice(step, x, p):
    """Return x after two calls of a function."""
    return step(step(x, p), p)


@pytest.fixture(scope="module")
def scaled_twice():
    """twice, compiled, with the address of scaled, compiled."""
    addresses.pass_by_address(Scaling)
    row, record = numba.typeof(np.ones(2)), numba.typeof(Scaling(np.ones(2), 1.0))
    inner = numba.njit(no_cpython_wrapper=True)(scaled)
    step = addresses.address_of(inner, addresses.function(row, row, record))
    outer = numba.njit(twice)
    return lambda x, p, inner=inner: outer(step, x, p)


def test_a_function_that_is_called_by_its_address_reads_the_record_at_its_address(scaled_twice):
    p = Scaling(np.array([2.0, 3.0]), 0.5)
    assert scaled_twice(np.ones(2), p) == pytest.approx([1.0, 2.25], rel=1e-15)
    assert scaled_twice(np.ones(2), p._replace(share=1.0)) == pytest.approx([4.0, 9.0], rel=1e-15)


def test_what_a_function_raises_arrives_through_its_address(scaled_twice):
    with pytest.raises(ArithmeticError, match="a factor is not positive"):
        scaled_twice(np.ones(2), Scaling(np.array([2.0, 0.0]), 0.5))


def test_a_record_that_is_passed_by_its_address_keeps_no_array_alive(scaled_twice):
    p = Scaling(np.array([2.0, 3.0]), 0.5)
    before = sys.getrefcount(p.factors)
    for _ in range(20):
        scaled_twice(np.ones(2), p)
    after = sys.getrefcount(p.factors)                       # an assertion would hold a reference of its own
    assert after == before


def at_most(step, x, p):
    """Return x, after a call of a function where x is positive."""
    return step(x, p) if x[0] > 0.0 else x


def promised(function):
    """Return a function (x, p) that calls a promised one where x is positive, and the twin of that one."""
    addresses.pass_by_address(Scaling)
    row, record = numba.typeof(np.ones(2)), numba.typeof(Scaling(np.ones(2), 1.0))
    inner, outer = numba.njit(no_cpython_wrapper=True)(function), numba.njit(at_most)
    step = addresses.promise(inner, addresses.function(row, row, record))
    return lambda x, p: outer(step, x, p), inner


def test_a_promised_function_is_compiled_when_it_is_first_called():
    run, inner = promised(scaled)
    p = Scaling(np.array([2.0, 3.0]), 1.0)
    assert run(np.zeros(2), p) == pytest.approx([0.0, 0.0], abs=0.0)
    assert not inner.overloads
    for _ in range(2):
        assert run(np.ones(2), p) == pytest.approx([2.0, 3.0], rel=1e-15)
    assert len(inner.overloads) == 1


def test_a_promised_function_that_cannot_be_compiled_raises_at_its_first_call(monkeypatch):
    said = []
    monkeypatch.setattr(sys, "unraisablehook", lambda fault: said.append(fault.exc_value))
    run, _ = promised(lambda x, p: p.share)
    with pytest.raises(RuntimeError, match="could not be compiled"):
        run(np.ones(2), Scaling(np.ones(2), 1.0))
    assert "returns float64 and not" in str(said[0])


def test_a_function_that_returns_something_else_than_its_caller_expects_is_refused():
    row = numba.typeof(np.ones(2))
    with pytest.raises(TypeError, match="returns float64 and not"):
        addresses.address_of(numba.njit(lambda x: x[0]), addresses.function(row, row))


# ---------------------------------------------------------------------------------------------- loops

@pytest.fixture
def compilations():
    """Return a list that gets the name of each function that numba compiles."""
    from numba.core import event
    names = []

    class Noted(event.Listener):
        def on_start(self, event):
            names.append(event.data["dispatcher"].py_func.__name__)

        def on_end(self, event):
            pass
    with event.install_listener("numba:compile", Noted()):
        yield names


def run(modules_of_loop, model):
    """Return the state of a Model after two steps of a compiled loop, and of a plain one."""
    lesson = lesson_of("solutions")
    loop = lesson.compose(model)
    advance = modules_of_loop.advance(loop, [part.__name__ for part in lesson.padded(loop)])
    return advance(0.0, loop.state, 1e-3, 2), lesson.run_parts(loop, 0.0, loop.state, 1e-3, 2)


@pytest.mark.long
@pytest.mark.xdist_group("compiled simulator")
def test_a_part_is_compiled_once_for_all_models_and_once_for_all_processes(compilations):
    """Three models: the second needs a part of its own only, and the third none; then all of them from the disk."""
    point = Body((0.0, 1.0), 1.0, v=(1.0, 0.5))
    models = (make_model([point], DOWN), make_model([point._replace(inertia=0.1, omega=1.0)], DOWN),
              make_model([point, point._replace(x=(0.0, 2.0))], DOWN))
    sets, found = modules.compiled_twice(), []
    for _ in range(2):
        modules_of_loop = next(sets)
        for model in models:
            compilations.clear()
            ours, plain = run(modules_of_loop, model)
            assert ours.x == pytest.approx(plain.x, abs=1e-15)
            found.append(set(compilations))
    sets.close()
    shared = {"weight", "accelerate", "advance_parts"}
    assert shared | {"move"} <= found[0] and not shared & found[1]
    assert "move_and_turn" in found[1]
    assert found[2:] == [set()] * 4


# ---------------------------------------------------------------------------------------------- in space

RISE = np.sqrt(0.75)         # of a regular hexagon
GROUND = Body((0.0, 0.0, 0.0), shape=HalfSpace((0.0, 0.0, 1.0)), mu=1.0, e=1.0)
BALL = Body((0.0, 0.0, 0.199), 1.0, Ball(0.2), v=(0.3, 0.0, -0.1), e=0.5)
ROUGH = BALL._replace(mu=0.5)
TOP = Body((0.0, 0.0, 0.3), 1.0, inertia=(0.1, 0.2, 0.25), omega=(1.0, 2.0, 0.5))
CUBE = Body((0.0, 0.0, 0.49), 1.0, Box((0.5, 0.5, 0.5)), mu=0.5, omega=(0.1, 0.2, 0.0))
PRISM = Body((0.0, 0.0, 0.195), 1.0, Polyhedron(tuple(
    (0.5 * x, 0.5 * y, z) for z in (-0.2, 0.2) for x, y in ((1.0, 0.0), (0.5, RISE), (-0.5, RISE), (-1.0, 0.0),
                                                            (-0.5, -RISE), (0.5, -RISE)))), 0.5, omega=(0.1, 0.2, 0.5))
HINGE = Hinge(0, WORLD, (0.5, 0.0, 0.3), (0.6, 0.8, 0.0))
ROD = Distance(0, WORLD, (0.0, 0.0, 0.0), (0.5, 0.0, 0.8))
IN_SPACE = {                                             # of each model: its bodies, joints and other fields
    "smooth balls": ([BALL, GROUND], [], {}),
    "rough ball": ([ROUGH, GROUND], [], {}),
    "many balls": ([ROUGH._replace(x=(0.39 * k, 0.0, 0.199)) for k in range(9)] + [GROUND], [], {}),
    "cube": ([CUBE, GROUND], [], {}),
    "cube and ball": ([CUBE, ROUGH._replace(x=(0.0, 0.69, 0.3)), GROUND], [], {}),
    "fast ball": ([BALL._replace(x=(0.0, 0.0, 0.5), v=(0.0, 0.0, -900.0)), GROUND], [], {}),
    "polyhedra": ([PRISM, PRISM._replace(x=(0.05, 0.02, 0.49)), ROUGH._replace(x=(0.0, 0.1, 0.98)),
                   CUBE._replace(x=(1.2, 0.0, 0.5), omega=None), PRISM._replace(x=(1.2, 0.1, 1.18)),
                   Body((0.1, 0.6, 0.095), 1.0, Capsule(0.4, 0.1), 0.5), GROUND], [], {}),
    "hinge": ([TOP], [HINGE], {}),
    "soft rod": ([TOP], [ROD._replace(compliance=1e-4)], {}),
    "hinge and contact": ([ROUGH, GROUND], [HINGE], {}),
    "rod and contact": ([ROUGH, GROUND], [ROD], {}),
    "chain and contacts": ([ROUGH._replace(x=(0.5 * k, 0.0, 0.199)) for k in range(9)] + [GROUND],
                           [BallJoint(k, k + 1, (0.5 * k + 0.25, 0.0, 0.199)) for k in range(8)], {}),
    "springs and drag": ([TOP], [], {"springs": [Spring(0, WORLD, (0.1, 0.0, 0.0), (0.0, 0.0, 2.0), 1.0, 5.0, 0.1)],
                                     "loads": [Drag(0.2)]}),
}


def in_space(name):
    """Return one of the models."""
    bodies, joints, more = IN_SPACE[name]
    return make_model(bodies, (0.0, 0.0, -9.81), joints, **more)


def test_the_models_in_space_need_all_parts_in_space():
    lesson, used = lesson_of("solutions"), set()
    for name in IN_SPACE:
        loop = lesson.compose(in_space(name))
        used |= {part.step.__name__ for part in loop.parts} | {loop.load.__name__, loop.narrow.__name__}
    there = {name for name, thing in vars(compose).items()
             if getattr(thing, "__module__", "") in ("solutions.given.parts_3d", "solutions.given.rods")}
    detects = {name for name in vars(compose) if name.startswith("detect_")}
    finders = {"ball_contacts_of", "cuboid_contacts_of", "rounded_contacts", "hull_contacts"}
    assert used >= there - {"rods_in"} | detects | finders


@pytest.mark.long
@pytest.mark.xdist_group("compiled simulator")
@pytest.mark.parametrize("name", IN_SPACE)
def test_a_compiled_loop_in_space_moves_as_the_plain_one(name):
    """Numbers are near 1, except for the fast ball's 900 m/s; there are a few thousand roundings per step."""
    ours, plain = run(modules.module_set("solutions", True), in_space(name))
    for fast, slow in zip(ours[:4], plain[:4], strict=True):
        assert fast == pytest.approx(slow, rel=1e-12, abs=1e-12)
    assert ours.contacts.b.tolist() == plain.contacts.b.tolist()
