"""Time and memory without end."""

from . import attack, looks

attack("a loop at import", "tests × time-out", "while True:\n    pass\n", lost=True)
attack("sleep at import", "tests × time-out", "import time\ntime.sleep(3600)\n", lost=True)
attack("source that takes for ever to compile", "tests × time-out", "x = " + "-" * 100_000 + "1\n", lost=True)
attack("a loop in a call", "the grader waits", """
def euler_step(acceleration, t, x, v, dt, p):
    while True:
        pass
""")
attack("a loop that Python cannot interrupt", "the grader waits", """
def euler_step(acceleration, t, x, v, dt, p):
    return 9**9**9
""")
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
looks("names without end", """
# the kernel keeps the names of empty files in memory that no limit of the process covers
import os
for folder in ("/", "/tmp", "/dev", "/dev/shm", "/student", os.getcwd()):
    for make in (
        lambda path: os.close(os.open(path, os.O_CREAT | os.O_WRONLY)),
        os.mkdir,
        os.mkfifo,
        lambda path: os.symlink("/", path),
    ):
        try:
            make(os.path.join(folder, "n" * 200))
            print("FOUND a place for names:", folder)
        except OSError:
            pass
""")
looks("pipes", """
# the kernel numbers the pipes of all processes: an accomplice reads how many were made
import os, socket
for make in (os.pipe, socket.socketpair, lambda: os.memfd_create("x"), lambda: os.eventfd(0)):
    try:
        print("FOUND a number of the kernel:", make())
    except OSError:
        pass
""")
attack("answers that are never read", "the time of a call does not count while the grader waits to write", """
import json, struct, sys, time
def euler_step(acceleration, t, x, v, dt, p):
    main = sys.modules["__main__"]
    head = json.dumps(
        ["call", main.names[acceleration], [0.0, {"a": ["f8", [100000]]}, {"a": ["f8", [100000]]}, None]]
    ).encode()
    for _ in range(100):
        main.outgoing.write(struct.pack("<4sIQ", b"WBK1", len(head), 1600000) + head + bytes(1600000))
        main.outgoing.flush()
    time.sleep(1e5)
midpoint_step = implicit_euler_step = euler_step
""")
attack("reading the disk for ever", "the time of waiting for a disk does not count", """
import mmap, os
def euler_step(acceleration, t, x, v, dt, p):
    page, files = mmap.mmap(-1, 1 << 20), [
        os.path.join(here, name) for here, _, names in os.walk("/usr/bin") for name in names
    ]
    while True:
        for path in files or [os.__file__]:
            try:
                file = os.open(path, os.O_RDONLY | getattr(os, "O_DIRECT", 0))
                while os.preadv(file, [page], 0) < 0:
                    pass
                os.close(file)
            except OSError:
                pass
""")
