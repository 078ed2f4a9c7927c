"""Functions of the tests as code for the sandbox, if they use only their arguments, numbers and NumPy.

Code goes only from the trusted side to the other, and saves a round trip at every step of a motion.  A function that
counts its calls or holds a secret has a closure or a mutable global, and is not sent.
"""

import marshal
import types

import numpy as np


def parts_of(function):
    """Return (code, names, values) of such a function with the globals that it uses; None for any other."""
    if not isinstance(function, types.FunctionType):
        return None
    if function.__closure__ or function.__defaults__ or function.__kwdefaults__:
        return None
    space = function.__globals__
    used = {name: space[name] for name in names_in(function.__code__) if name in space and name != "np"}
    if not all(value is function or type(value) in (int, float) or parts_of(value) for value in used.values()):
        return None
    if function.__globals__.get("np", np) is not np:
        return None
    others = {name: value for name, value in used.items() if value is not function}
    code = marshal.dumps(nameless(function.__code__))
    return np.frombuffer(code, np.uint8), tuple(others), tuple(others.values())


def nameless(code):
    """Return a code object that does not tell where its file lies, nor do the functions inside it."""
    constants = (nameless(inner) if isinstance(inner, types.CodeType) else inner for inner in code.co_consts)
    return code.replace(co_filename="<test>", co_consts=tuple(constants))


def names_in(code):
    """Return every global name in a code object and in the functions inside it."""
    inside = [inner for inner in code.co_consts if isinstance(inner, types.CodeType)]
    return {*code.co_names, *(name for inner in inside for name in names_in(inner))}


def function_of(code, names, values):
    """Build the function from the parts of `parts_of`."""
    space = {"__builtins__": __builtins__, "np": np, **dict(zip(names, values, strict=True))}
    function = types.FunctionType(marshal.loads(code.tobytes()), space)
    space.setdefault(function.__name__, function)
    return function
