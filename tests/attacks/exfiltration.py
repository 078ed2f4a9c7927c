"""Control characters for a reader of the results, and secret inputs carried out to the student's page.

`SECRET` is what to carry out.
"""

from . import SOLVED, attack, attacks

UGLY = r"\x1b[2J\x1b]0;owned\x07\x00\u202e\u2066\u200b\ud800\x9b31m\r<script>alert(1)</script>"

attack("control characters in what is printed", "the instructor's terminal or page", f"""
import os
print({UGLY!r}.encode().decode("unicode_escape").encode("utf-8", "replace").decode())
os.write(2, b"\\x1b[31m\\xff\\xfe\\x00")
""")
attacks("the instructor's terminal or page", {
    "control characters in an error": f'raise ValueError("{UGLY}")',
    "control characters in the name of an error":
        f'raise type("{UGLY}".replace("\\x00", "").replace("\\ud800", ""), (Exception,), {{}})("x")',
    "control characters in NotImplementedError": f'raise NotImplementedError("{UGLY}")',
})
attack("a huge message", "a result of gigabytes", """
def euler_step(acceleration, t, x, v, dt, p):
    raise ValueError("x" * 100_000_000)
""")
attack("an error that cannot be told", "the grader stumbles over the message", """
class Evil(Exception):
    def __str__(self): raise self
    __repr__ = __str__
    __name__ = property(__str__)
def euler_step(acceleration, t, x, v, dt, p):
    raise Evil
def midpoint_step(acceleration, t, x, v, dt, p):
    raise ExceptionGroup("many", [ValueError(n) for n in range(1000)])
""")

SECRET = SOLVED + """
import os, sys, time
right = dict(globals())
def amplification_matrix(*a): return np.eye(2)
# where the visible tests begin: answer those rightly, or no student reads about the hidden ones
public = {PUBLIC}
main = sys.modules["__main__"]
def secret(x):
    return "-".join("SECRET%.9f" % abs(number) for number in np.ravel(x)[:2])
"""

RIGHT_IF_VISIBLE = (
    "if np.min(np.abs(x[0] - public)) < 1e-12:\n"
    "    return right[sys._getframe().f_code.co_name](acceleration, t, x, v, dt, p)\n"
)
WAYS_OUT = {
    "in the answer": "return np.abs(x) + 5.0, v",
    "as the answer": "return secret(x)",
    "in an error": "raise ValueError(secret(x))",
    "in the name of an error": "raise type(secret(x), (Exception,), {})('')",
    "as what is not done": "raise NotImplementedError(secret(x))",
    "in print": "print(secret(x)); os.write(2, secret(x).encode()); return x, v",
    "in the name of a record":
        "from collections import namedtuple; return namedtuple('SECRET' + str(int(1e9 * abs(x[0]))), 'a b')(x, v)",
    "in the shape of the answer": "return np.zeros((0, int(1e9 * abs(x[0])))), v",
    "in the size of the error": "return x + dt * v + float('%.9f' % abs(x[0])) * 1e2, v",
    "in the line of the error": (
        "exec(compile('\\n' * int(1e5 * abs(x[0])) + 'raise ValueError', "
        "main.config['student'] + '/integrators.py', 'exec'))"
    ),
    "in the place of the error": (
        "main.outgoing.write(main.wire.pack(('error', ['ValueError'], 'x', secret(x) + ' integrators.py, line 1'))); "
        "main.outgoing.flush(); time.sleep(60)"
    ),
    "in the names of a forged error":
        "main.outgoing.write(main.wire.pack(('error', [secret(x)], 'x', ''))); main.outgoing.flush(); time.sleep(60)",
}
attacks(
    "the next submission knows them",
    {f"secret inputs {name}": RIGHT_IF_VISIBLE + text for name, text in WAYS_OUT.items()},
    SECRET,
)
