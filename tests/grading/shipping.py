"""Functions of the tests that may go to the sandbox as code: those that know nothing but their arguments, numbers and NumPy.

Only from the trusted side to the other: it saves a round trip at every step of a motion.  What counts its calls, or knows a secret, has a
closure or a mutable global, and stays.
"""

import marshal
import types

import numpy as np


def parts_of(function):
    """(code, names, values) of such a function, its globals among them; None for any other."""
    if not isinstance(function, types.FunctionType) or function.__closure__ or function.__defaults__ or function.__kwdefaults__:
        return None
    used = {name: function.__globals__[name] for name in names_in(function.__code__) if name in function.__globals__ and name != "np"}
    if not all(value is function or type(value) in (int, float) or parts_of(value) for value in used.values()):
        return None
    if function.__globals__.get("np", np) is not np:
        return None
    others = {name: value for name, value in used.items() if value is not function}
    return np.frombuffer(marshal.dumps(function.__code__), np.uint8), tuple(others), tuple(others.values())


def names_in(code):
    """Every global name in a code object, those of functions inside it included."""
    return {*code.co_names, *(name for inner in code.co_consts if isinstance(inner, types.CodeType) for name in names_in(inner))}


def function_of(code, names, values):
    """The function again."""
    space = {"__builtins__": __builtins__, "np": np, **dict(zip(names, values))}
    function = types.FunctionType(marshal.loads(code.tobytes()), space)
    space.setdefault(function.__name__, function)
    return function
