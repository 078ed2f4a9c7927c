"""Time and memory without end."""

from . import attack

attack("a loop at import", "tests × time-out", "while True:\n    pass\n", lost=True)
attack("sleep at import", "tests × time-out", "import time\ntime.sleep(3600)\n", lost=True)
attack("source that takes for ever to compile", "tests × time-out", "x = " + "-" * 100_000 + "1\n", lost=True)
attack("a loop in a call", "the grader waits", "\ndef euler_step(acceleration, t, x, v, dt, p):\n    while True:\n        pass\n")
attack("a loop that Python cannot interrupt", "the grader waits", "\ndef euler_step(acceleration, t, x, v, dt, p):\n    return 9**9**9\n")
attack("a callback for ever", "the grader answers, and never stops", """
def midpoint_step(acceleration, t, x, v, dt, p):
    while True:
        acceleration(t, x, v, p)
""")
attack("a callback of a million numbers, for ever", "the grader's memory and time", """
def midpoint_step(acceleration, t, x, v, dt, p):
    big = np.zeros(1_000_000)
    while True:
        acceleration(t, big, big[:0], p)
""")
attack("a callback of very many numbers", "the grader's memory", """
def midpoint_step(acceleration, t, x, v, dt, p):
    return acceleration(t, np.zeros((4_000_000, 1)), v, p), acceleration(t, np.zeros((1000, 1)), v, np.zeros(1000))
""")
attack("memory", "no memory is left for the grader", """
def euler_step(acceleration, t, x, v, dt, p):
    kept = []
    while True:
        kept.append(bytearray(64 << 20))
""")
attack("a flood on standard output and standard error", "the grader's memory, or a pipe that is full for ever", """
import os, sys
def euler_step(acceleration, t, x, v, dt, p):
    text = "x" * (1 << 20)
    for _ in range(60):
        print(text)
        sys.stderr.write(text)
        os.write(2, b"\\0" * (1 << 16))
    return x, v
""")
attack("standard output and error closed", "the grader reads nothing, and waits", """
import os, sys
for number in (0, 1, 2):
    os.close(number)
""")
