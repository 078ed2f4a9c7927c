"""Data between the trusted parent and the worker with the student's code: a JSON tree and raw arrays, and nothing else.

    frame    "WBK1", length of the tree, length of the arrays; the tree; the arrays
    tree     None, bool, int, float, str as they are;  [...] a tuple;  {"a": [dtype, shape]} the next array;
             {"c": [real, imaginary]} a complex number;  {"r": [name, fields, values]} a NamedTuple;
             {"f": name} a function that the other side calls by that name

Nothing is unpickled, and every size is checked before memory is asked for.  *Left out:* dicts and objects.
"""

import json
import math
import numbers
import struct
from collections import defaultdict, deque

import numpy as np

MAGIC, HEADER = b"WBK1", struct.Struct("<4sIQ")
MAX_TREE, MAX_ARRAYS, MAX_DEPTH = 1 << 18, 1 << 25, 24  # [bytes], [bytes], [-]: the tests need a hundredth
DTYPES = {"b1", "u1", "i4", "i8", "f4", "f8", "c16"}
MOST_INT = 2**63 - 1
# what follows the kind of a message; a value's is looked at in `answer`
MESSAGES = {"call": [(str, tuple)], "error": [(tuple, str, str)]}


class WireError(Exception):
    """The other side sent something that is not plain data."""


def pack(value, name_of=None):
    """Return the frame of a value.  name_of(function) gives the name under which a function goes over the wire."""
    arrays = []

    def tree(value, depth=0):
        if depth > MAX_DEPTH:
            raise WireError("nested too deep")
        if value is None or type(value) in (bool, int, float, str):
            return value
        if isinstance(value, np.bool_):
            return bool(value)
        if isinstance(value, numbers.Real):  # also of NumPy, long ones and fractions: a right answer may be any
            return int(value) if isinstance(value, numbers.Integral) else float(value)
        if isinstance(value, numbers.Complex):
            return {"c": [float(value.real), float(value.imag)]}
        if isinstance(value, np.ndarray):
            plain = usual(np.array(value, order="C", subok=False))     # a copy without tricks
            arrays.append(plain.astype(plain.dtype.newbyteorder("<")).tobytes())
            return {"a": [plain.dtype.str[1:], list(plain.shape)]}
        if isinstance(value, tuple) and hasattr(value, "_fields"):
            return {"r": [type(value).__name__, list(value._fields), [tree(v, depth + 1) for v in value]]}
        if type(value) in (list, tuple):
            return [tree(v, depth + 1) for v in value]
        if callable(value) and name_of:
            return {"f": name_of(value)}
        raise WireError(f"a {type(value).__name__} is not plain data")

    head = json.dumps(tree(value)).encode()
    return HEADER.pack(MAGIC, len(head), sum(map(len, arrays))) + head + b"".join(arrays)


def usual(array):
    """Return an array of numbers as one of the kinds that the wire carries.  Raises WireError for other content."""
    kind = array.dtype.kind
    if array.dtype.str[1:] in DTYPES:
        return array
    if (kind == "O" and all(isinstance(x, numbers.Real) for x in array.flat)) or kind == "f":
        return array.astype("f8")
    if kind in "iu":
        return array.astype("f8" if array.size and array.max() > MOST_INT else "i8")
    if kind == "c":
        return array.astype("c16")
    raise WireError(f"an array of {array.dtype} is not plain data")


def sizes(header):
    """Return the lengths of a frame's tree and of its arrays [bytes]."""
    magic, tree, arrays = HEADER.unpack(header)
    if magic != MAGIC or tree > MAX_TREE or arrays > MAX_ARRAYS:
        raise WireError("not a frame, or too large a one")
    return tree, arrays


def read(stream):
    """Return the next (tree, arrays) of a binary stream, as bytes; None at its end."""
    raw = stream.read(HEADER.size)
    if not raw:
        return None
    if len(raw) < HEADER.size:
        raise WireError("a frame broke off")
    tree, arrays = sizes(raw)
    head, body = stream.read(tree), stream.read(arrays) if arrays else b""
    if len(head) < tree or len(body) < arrays:
        raise WireError("a frame broke off")
    return head, body


def unpack(head, body, function=None, record=None):
    """Return the value of a frame.

    function(name) and record(name, fields, values) make the objects that only the receiver can make.
    """
    position = 0

    def array(code, shape):
        nonlocal position
        if code not in DTYPES or len(shape) > 8 or not all(type(n) is int and 0 <= n < 1 << 31 for n in shape):
            raise WireError("an array has a bad header")
        begin, position = position, position + math.prod(shape) * np.dtype(code).itemsize
        if position > len(body):
            raise WireError("an array is longer than its bytes")
        return np.frombuffer(body[begin:position], "<" + code).reshape(shape).astype(code)

    def value(tree, depth=0):
        if depth > MAX_DEPTH:
            raise WireError("nested too deep")
        if type(tree) is list:
            return tuple(value(v, depth + 1) for v in tree)
        if type(tree) is not dict:
            return tree
        (kind, content), = tree.items()
        if kind == "a":
            return array(*content)
        if kind == "c":
            return complex_of(*content)
        if kind == "f" and function and type(content) is str:
            return function(content)
        if kind == "r" and record:
            name, fields, values = content
            if not all(type(text) is str and text.isidentifier()
                       for text in [name, *fields]) or len(fields) != len(values):
                raise WireError("a record has a bad header")
            return record(name, tuple(fields), tuple(value(v, depth + 1) for v in values))
        raise WireError("something that is not plain data")

    try:
        return value(json.loads(head))
    except WireError:
        raise
    except Exception as e:  # ValueError, TypeError, RecursionError, MemoryError …
        raise WireError(f"malformed data ({type(e).__name__})") from None


def complex_of(real, imaginary):
    """Return the complex number of two floats.  Raises WireError for anything else."""
    if not type(real) is type(imaginary) is float:
        raise WireError("a complex number of other things than two floats")
    return complex(real, imaginary)


def arrays_in(value):
    """Yield every array in a value, in the order in which it goes over the wire."""
    if isinstance(value, np.ndarray):
        yield value
    elif isinstance(value, tuple | list):
        for part in value:
            yield from arrays_in(part)


KEPT = 3                     # results of earlier calls that a call of the same function may not change [-]


def results():
    """Return an empty {name of a function: its last results}."""
    return defaultdict(lambda: deque(maxlen=KEPT))


class Contents:
    """What all arrays of a value hold, to see later whether it has changed."""

    def __init__(self, value):
        self.arrays = list(arrays_in(value))
        self.held = [self.of(array) for array in self.arrays]

    @staticmethod
    def of(array):
        return array.shape, array.dtype, array.tobytes()

    def changed(self):
        """Return [(number, array)] of the arrays that hold something else now."""
        return [(n, array) for n, (array, held) in enumerate(zip(self.arrays, self.held)) if self.of(array) != held]


class Peer:
    """One side of the conversation.

    A call waits for its answer and serves the other side's calls meanwhile, to any depth.

    ["call", function, arguments] is answered by ["value", result, changed] or ["error", class names, message, where];
    changed holds (number, array) of the arguments' arrays that the call has changed in place, which happens to the
    caller's as well.
    """

    def __init__(self, send, receive, resolve, name_of, record, describe, error, define=None, fatal=()):
        self.send, self.receive = send, receive                        # a frame, as bytes and as (tree, arrays)
        self.resolve, self.name_of, self.record = resolve, name_of, record
        self.describe, self.error = describe, error                    # exception → (names, message, where), and back
        self.define = define                                           # takes (name, code, names, values) of a function
        self.fatal = fatal                                             # exceptions that end the conversation
        self.returned = results()                                      # of our functions
        self.may_change = lambda name: True  # whether that function of the other side's may change arrays

    def call(self, name, arguments):
        """Return what the other side's function returns; raises what `error` makes of its answer."""
        self.send(pack(("call", name, arguments), self.name_of))
        while True:
            kind, *content = self.message()
            if tuple(map(type, content)) not in MESSAGES.get(kind, ()) and kind != "value":
                raise WireError("an unexpected message")
            if kind == "call":
                self.serve(*content)
            elif kind == "error":
                raise self.error(*content)
            else:
                result, changed = answer(content)
                own = list(arrays_in(arguments))
                if changed and not self.may_change(name):
                    raise self.error(("ValueError",), "it changes an array that it was given: return a new one", "")
                for number, array in changed:
                    known = 0 <= number < len(own)
                    if not known or own[number].shape != array.shape or own[number].dtype != array.dtype:
                        raise WireError("an argument changed its shape")
                    own[number][...] = array
                return result

    def message(self):
        """Return the next message.  ["define", …] brings a function along, where this side takes any."""
        while True:
            got = unpack(*self.receive(), self.resolve, self.record)
            if type(got) is not tuple or not got or type(got[0]) is not str:
                raise WireError("an unexpected message")
            if got[0] != "define" or not self.define:
                return got
            self.define(*got[1:])

    def serve(self, name, arguments):
        """Call one of our functions for the other side, and answer."""
        try:
            function = self.resolve(name)                              # first: it knows which names there are
            given, earlier = Contents(arguments), Contents(list(self.returned[name]))
            result = function(*arguments)
            if earlier.changed():
                raise ValueError("it changes what it has returned before: return a new array")
            answer = "value", result, given.changed()
        except self.fatal:
            raise
        except BaseException as e:                                     # SystemExit of a student's code, too
            answer = "error", *self.describe(e)
        try:
            frame = pack(answer, self.name_of)
            if answer[0] == "value":
                self.returned[name].append(answer[1])
        except Exception as e:  # WireError, RecursionError, an int of too many digits …
            frame = pack(("error", ["TypeError"], f"the result is not plain data: {str(e)[:200]}", ""))
        self.send(frame)


def answer(content):
    """Return (result, changed) of a value message."""
    if len(content) != 2 or type(content[1]) is not tuple or not all(
            type(pair) is tuple and len(pair) == 2 and type(pair[0]) is int and isinstance(pair[1], np.ndarray)
            for pair in content[1]):
        raise WireError("an unexpected message")
    return content
