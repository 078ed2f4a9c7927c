"""Frames by hand.

The student's code lives beside the worker's, so it may send any frame.  Only right answers earn points.
"""

from . import attack, attacks

WIRE = """
import json, os, struct, sys
main = sys.modules["__main__"]
def frame(tree, arrays=b"", magic=b"WBK1", length=None):
    head = tree if isinstance(tree, bytes) else json.dumps(tree).encode()
    return struct.pack("<4sIQ", magic, len(head) if length is None else length, len(arrays)) + head + arrays
def out(data):
    main.outgoing.flush()
    while data:
        data = data[os.write(main.outgoing.fileno(), data):]
def asks(name, *arguments):
    try:
        return main.peer.call(name, arguments)
    except Exception as e:
        return None
"""

SENDS = {
    "answers ahead":
        "out(b''.join(frame(['value', [{'a': ['f8', [3]]}, {'a': ['f8', [3]]}], []], bytes(48)) for _ in range(40)))",
    "true as an answer": "out(frame(['value', True, []]))",
    "half a frame": "out(frame(['value', 0, []])[:-3]); os._exit(0)",
    "a header and no more": "out(b'WBK1'); main.outgoing.close()",
    "a frame that claims gigabytes": "out(struct.pack('<4sIQ', b'WBK1', 0xFFFFFFFF, 1 << 62))",
    "a frame that claims all it may, and waits": "out(struct.pack('<4sIQ', b'WBK1', 1 << 18, 1 << 25) + bytes(1000))",
    "no frame at all": "out(b'{\"score\": 100}' * 1000)",
    "no JSON": "out(frame(b'\\xff\\xfe{{{'))",
    "a deep tree": "out(frame(b'[' * 200_000))",
    "a wide tree": "out(frame(b'[' + b'[],' * 80_000 + b'[]]'))",
    "NaN for a kind": "out(frame(['NaN'])); out(frame([None])); out(frame({'a': 1})); out(frame(7))",
    "a call of a number": "out(frame(['call', 7, []]))",
    "a call without arguments": "out(frame(['call', 'test:0']))",
    "an error without a name": "out(frame(['error', [], '', '']))",
    "an error made of numbers": "out(frame(['error', [1, [2]], 3, {'a': ['f8', [0]]}]))",
    "a change of what was not handed over":
        "out(frame(['value', 0, [[99, {'a': ['f8', [3]]}], [-1, {'a': ['f8', [3]]}]]], bytes(48)))",
    "a change without an array": "out(frame(['value', 0, [[0, 0], 1, None]]))",
    "a shape of negative numbers": "out(frame(['value', {'a': ['f8', [-1, -3]]}, []], bytes(24)))",
    "a shape of words": "out(frame(['value', {'a': ['f8', 'xyz']}, []], bytes(24)))",
    "objects in the array's type": "out(frame(['value', {'a': ['O', [3]]}, []], bytes(24)))",
    "bools that are two": "out(frame(['value', [{'a': ['b1', [3]]}, {'a': ['b1', [3]]}], []], b'\\2' * 6))",
    "a definition for the parent": "out(frame(['define', 'test:0', {'a': ['u1', [4]]}, [], []], b'evil'))",
    "a record with evil fields": "out(frame(['value', {'r': ['Oscillator', ['__class__', '__init__'], [1, 2]]}, []]))",
    "a record with the wrong number of values":
        "out(frame(['value', {'r': ['Oscillator', ['omega', 'zeta'], [1]]}, []]))",
    "a pickle": "import pickle; out(frame(pickle.dumps(print)))",
    "a flood of frames": "data = frame(['value', 0, []]) * 1000\nfor _ in range(300):\n    out(data)",
    "a flood of large frames": (
        "data = frame(['value', {'a': ['u1', [1 << 24]]}, []], bytes(1 << 24))\n"
        "for _ in range(10):\n    out(data)"
    ),
    "a flood of calls that it does not wait for":
        "data = frame(['call', 'test:0', []]) * 1000\nfor _ in range(100):\n    out(data)",
    **{f"the function {name} as answer": f"out(frame(['value', [{{'f': '{name}'}}, {{'f': '{name}'}}], []]))"
       for name in (
           "solution:integrators.euler_step", "lesson:euler_step", "own:0", "given:advance", "import", "code:0",
       )},
}
attacks(
    "an answer that counts, or a parent that stumbles",
    {name: text + "\nreturn x, v" for name, text in SENDS.items()},
    WIRE,
)

attack("questions for the worked answers", "the parent works the exercise", WIRE + """
def euler_step(acceleration, t, x, v, dt, p):
    for name in (
        "solution:integrators.euler_step", "solution:springs.air_force", "solution:checks.BadInput",
        "solution:integrators.__dict__", "given:euler_step", "lesson:euler_step", "lesson:__class__",
        "own:0", "test:99", "code:0", "import", "define", "solution:", "",
    ):
        got = asks(name, acceleration, t, x, v, dt, p)
        if got is not None:
            print("FOUND", name)
            return got
    return x, v
""", shows=("FOUND",))
attack("the worker's own wire, patched", "every answer is the one that was asked for", WIRE + """
import wire
def serve(name, arguments):
    main.outgoing.write(wire.pack(("value", arguments[2:4] if len(arguments) > 3 else 3.0, [])))
    main.outgoing.flush()
main.peer.serve = serve
""")
attack("frames on every descriptor", "one of them is the grader's result", WIRE + """
def euler_step(acceleration, t, x, v, dt, p):
    for number in range(64):
        try:
            if number != main.incoming.fileno():
                os.set_blocking(number, False)
                os.write(number, frame(["value", [{"a": ["f8", [3]]}, {"a": ["f8", [3]]}], []], bytes(48)))
        except OSError:
            pass
    return x, v
""")
attack("the wire to itself", "the pipes have two ends: read the parent's questions, and answer in its name", WIRE + """
for number in range(16):
    for mode in ("rb", "wb"):
        try:
            os.open(f"/proc/self/fd/{number}", os.O_RDWR | os.O_NONBLOCK)
        except OSError:
            pass
""")
KINDS = (
    "NotYet", "Skipped", "Exit", "Failed", "XFailed", "OutcomeException",
    "KeyboardInterrupt", "SystemExit", "RuntimeError", "UsageError",
    "WireError", "Lost", "TooLong",
)
attacks("the grader or pytest takes it for an error of its own: skipped, ended, passed", {
    f"an error called {kind}": (
        f"raise type('{kind}', (Exception,), "
        "dict(__module__='_pytest.outcomes', pytrace=False, returncode=0))('passed')"
    )
    for kind in KINDS
})
attack(
    "an error called Exit at import",
    "the whole run ends",
    "class Exit(BaseException):\nreturncode = 0\nraise Exit('passed')\n",
    lost=True,
)
