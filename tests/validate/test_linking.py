"""Machine code of compiled functions is made where Python or an address asks for it, and nowhere else."""

import ctypes
import importlib
import subprocess
import sys

import pytest

from solutions.checks import BadInput
from validate.subject import modules, numba_twins

pytest.importorskip("numba", reason="numba has no wheel for this machine")
linking = pytest.importorskip("validate.subject.linking")

UPPER = """from solutions.checks import BadInput

from .lower import countdown, scaled


def twice(x):
    return 2.0 * scaled(x)


def rounds(n):
    return countdown(n)
"""
LOWER = """from solutions.checks import BadInput


def scaled(x):
    if x < 0.0:
        raise BadInput("x", x, "give a number above zero")
    return 3.0 * x


def countdown(n):
    return 0 if n == 0 else 1 + countdown(n - 1)
"""


@pytest.fixture
def upper(tmp_path):
    """Return a lesson that calls another one, compiled."""
    (tmp_path / "upper.py").write_text(UPPER)
    (tmp_path / "lower.py").write_text(LOWER)
    return modules.bind("upper", tmp_path, compiled=True)


def libraries(function):
    """Return the libraries that numba has compiled for a function."""
    return [code.library for code in function.overloads.values()]


def test_a_function_that_only_compiled_code_calls_has_no_machine_code(upper):
    assert upper.twice(1.5) == 9.0
    inner, = libraries(upper.scaled)
    outer, = libraries(upper.twice.called)
    assert linking.is_linked_only(inner) and not linking.is_linked_only(outer)
    assert upper.scaled(2.0) == 6.0                                     # Python calls it now
    assert not linking.is_linked_only(*libraries(upper.scaled.called))


def test_what_was_not_compiled_for_python_refuses_a_call_from_python(upper):
    """Without that the process would end: there is no code to jump to."""
    assert upper.twice(1.5) == 9.0
    with pytest.raises(TypeError):
        upper.scaled.twin(1.5)


def test_an_error_of_a_linked_function_has_its_value_also_from_the_cache(upper, tmp_path):
    """The value is made a Python object by what numba calls the function's environment."""
    with pytest.raises(BadInput, match=r"x is -0\.25: give a number above zero"):
        upper.twice(-0.25)
    ask = f"""
from solutions.checks import BadInput
from validate.subject import modules
upper = modules.bind("upper", {str(tmp_path)!r}, compiled=True)
try:
    upper.twice(-0.25)
except BadInput as e:
    print(e, sum(upper.twice.called.stats.cache_hits.values()), len(upper.scaled.overloads))
"""
    done = subprocess.run([sys.executable, "-c", ask], cwd=modules.ROOT, capture_output=True, text=True, check=True)
    assert done.stdout == "x is -0.25: give a number above zero 1 0\n"


def test_a_linked_function_may_call_itself(upper):
    assert upper.rounds(10) == 10


def product(x, y):
    return x * y


def test_the_machine_code_of_a_linked_function_is_saved_when_its_address_is_asked_for(tmp_path, monkeypatch):
    """numba's convention: result = f(address of the value, address of an error, arguments); 0 is no error."""
    from numba import types

    from validate.subject.addresses import function, machine_code
    number, value = types.float64, ctypes.c_double
    convention = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.POINTER(value), ctypes.c_void_p, value, value)
    monkeypatch.setattr(numba_twins, "CACHE", tmp_path)
    for loaded in (False, True):
        twin = numba_twins.compiled(product, "tests.product", numba_twins.use_cache("a set"))
        call, found = convention(machine_code(twin, function(number, number, number))), value()
        assert call(ctypes.byref(found), None, 3.0, 5.0) == 0 and found.value == 15.0
        assert sum(twin.stats.cache_hits.values()) == loaded and not linking.is_linked_only(*libraries(twin))


@pytest.mark.parametrize("name", ["solutions.given.contact", "solutions.support.arms", "solutions.support.lanes"])
def test_what_a_module_names_as_side_by_side_are_functions_of_its_own(name):
    module = importlib.import_module(name)
    assert module.SIDE_BY_SIDE and all(vars(module)[one].__module__ == name for one in module.SIDE_BY_SIDE)
