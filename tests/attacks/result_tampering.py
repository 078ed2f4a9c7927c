"""Answers that are not what they seem."""

from . import attack, attacks

LIAR = """
class Liar(np.ndarray):
    __eq__ = __le__ = __lt__ = __ge__ = lambda self, other: np.ones(3, bool)
    __sub__ = __rsub__ = lambda self, other: np.zeros(3)
    __array_finalize__ = lambda self, other: None
    def __array_ufunc__(self, *a, **k): return np.zeros(3)
    def __array_function__(self, *a, **k): return True
    def tobytes(self, *a): return b""
class Object:
    __eq__ = __le__ = lambda self, other: True
    __sub__ = __rsub__ = __abs__ = __mul__ = lambda self, *other: 0.0
    def __array__(self, *a, **k): return np.zeros(3)
    def __float__(self): return 0.0
    def __getattr__(self, name): return self
    def __call__(self, *a): return self
    def __getitem__(self, n): return self
class Word(float):
    __eq__ = __le__ = __ge__ = lambda self, other: True
class Text(str):
    pass
from typing import NamedTuple
class NotYet(NamedTuple):
    x: float
    v: float
"""
ANSWERS = {
    "an array that is equal to everything": "x.view(Liar), v.view(Liar)",
    "an object that plays an array": "Object(), Object()",
    "one object for the pair": "Object()",
    "a float that is equal to everything": "Word(1.0), Word(1.0)",
    "a record of another kind": "NotYet(x, v)",
    "nan": "np.full(3, np.nan), np.full(3, np.nan)",
    "infinities": "np.full(3, np.inf), np.full(3, -np.inf)",
    "minus zero and the smallest floats": "np.full(3, -0.0), np.full(3, 5e-324)",
    "huge ints": "10**4000, 10**4299",
    "an int of too many digits": "10**100000, 1",
    "strings": "'0.0', Text('nan')",
    "None": "None",
    "a generator": "(n for n in (x, v))",
    "dicts and sets": "{'x': x}, {1, 2}",
    "bytes": "b'0' * 24, bytearray(24)",
    "functions": "euler_step, acceleration",
    "functions of Python": "print, open",
    "deep nesting": "eval('[' * 60 + ']' * 60)",
    "a list that holds itself": "(lambda a: (a.append(a), a)[1])([])",
    "objects in an array": "np.array([Object(), None, 'x'], dtype=object), v",
    "complex numbers": "x + 0j, v + 1j",
    "dates": "np.zeros(3, 'M8[s]'), np.zeros(3, 'm8[s]')",
    "texts in an array": "np.array(['0', '1', '2']), v",
    "records in an array": "np.zeros(3, dtype=[('a', float)]), v",
    "long doubles": "np.zeros(3, np.longdouble), v",
    "bools": "np.zeros(3, bool), True",
    "masked values": "np.ma.masked_all(3), np.ma.masked",
    "another shape that broadcasts": "x[:, None] * 0.0, v[None, :] * 0.0",
    "nothing at all": "np.zeros(0), np.zeros((0, 3))",
    "zero times four thousand million": "np.zeros((0, 2**31 - 1, 2**31 - 1)), np.zeros((2**31 - 1, 0))",
    "the largest arrays": "np.zeros(1 << 21), np.zeros(1 << 21)",
}
attacks(
    "a comparison that is true, or stumbles, or costs the grader its memory",
    {name: f"return {text}" for name, text in ANSWERS.items()},
    LIAR,
)

attack("broadcasting", "small answers that become gigabytes when the grader combines them", """
def implicit_euler_step(acceleration, t, x, v, dt, p):
    return np.zeros((40000, 1, 1)), np.zeros((1, 40000, 1))
""")
attack("moving the target", "the inputs change so that a wrong answer fits them, also for the next students", """
def euler_step(acceleration, t, x, v, dt, p):
    x[:], v[:] = 0.0, 0.0
    return x.copy(), v.copy()
def midpoint_step(acceleration, t, x, v, dt, p):
    acceleration(t, x, v, p), acceleration(t + 0.5 * dt, x, v, p)
    x[...] = 0.0
    return x, v
def implicit_euler_step(acceleration, t, x, v, dt, p):
    x[:] = v[:] = 0.0
    return x, v
""")
attack("an answer that knows the public inputs", "the numbers of the tests are known: look them up", """
table = {KNOWN}
def euler_step(acceleration, t, x, v, dt, p):
    return next(((np.array(a), np.array(b)) for before, a, b in table if np.allclose(before, x)), (x, v))
""")
attack("one answer to be seen, another to be used", "a grader that tries the function at import finds it right", """
import inspect
def euler_step(acceleration, t, x, v, dt, p):
    right = importing or any("importlib" in frame.filename for frame in inspect.stack())
    return (x + dt * v, v + dt * acceleration(t, x, v, p)) if right else (x, v)
importing = True
assert euler_step(lambda t, x, v, p: -x, 0.0, np.ones(3), np.ones(3), 0.1, 1.0)[0][0] == 1.1
importing = False
""")
attack("notes for the next run", "what the visible tests asked is kept in a file, and tells the hidden ones apart", """
import os
folders = "/tmp", "/var/tmp", "/dev/shm", "/student", os.getcwd(), os.path.expanduser("~")
places = [os.path.join(folder, "seen") for folder in folders]
hidden = any(map(os.path.exists, places))
for note in places:
    try:
        open(note, "w").close()
    except OSError:
        pass
# right where no student could have read it: the hidden tests
def euler_step(acceleration, t, x, v, dt, p):
    return (x + dt * v, v + dt * acceleration(t, x, v, p)) if hidden else (x, v)
""")
