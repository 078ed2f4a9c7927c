"""Ends, forks, and what outlives them."""

from . import attack, attacks, looks

attack(
    "sys.exit at import",
    "the grader ends, and what it has not tested is not counted",
    "import sys\nsys.exit(0)",
    lost=True,
)
attack("os._exit at import", "an exit without an error looks like success", "import os\nos._exit(0)", lost=True)
attacks("a test that stops before it compares counts as passed, or the grader ends, or waits", {
    "sys.exit in a call": "raise SystemExit(0)",
    "os._exit in a call": "import os; os._exit(0)",
    "os.abort": "import os; os.abort()",
    "SIGKILL to itself": "import os, signal; os.kill(os.getpid(), signal.SIGKILL)",
    "SIGSTOP to itself": "import os, signal; os.kill(os.getpid(), signal.SIGSTOP)",
    "a null pointer": "import ctypes; ctypes.string_at(0)",
    "exec of another program": "import os; os.execv('/bin/true', ['true'])",
    "KeyboardInterrupt": "raise KeyboardInterrupt",
    "GeneratorExit": "raise GeneratorExit",
})

attack("a daemon", "a process that outlives the test and answers, or disturbs, later ones", """
import os, time, signal
def euler_step(acceleration, t, x, v, dt, p):
    for _ in range(2):
        if os.fork() == 0:
            os.setsid()
            if os.fork() == 0:
                signal.signal(signal.SIGTERM, signal.SIG_IGN)
                while True:
                    time.sleep(0.1)
            os._exit(0)
    return x, v
""")
attack("a child that keeps the wire", "the grader waits for the pipe to close after the worker's end", """
import os, time
def euler_step(acceleration, t, x, v, dt, p):
    if os.fork() == 0:
        time.sleep(600)
    os._exit(0)
""")
attack("a fork bomb", "no process is left for the grader", """
import os
def euler_step(acceleration, t, x, v, dt, p):
    for _ in range(10000):
        try:
            if os.fork() == 0:
                while True:
                    try:
                        os.fork()
                    except OSError:
                        pass
        except OSError:
            pass
    return x, v
""")
attack(
    "threads, atexit, __del__ and signals",
    "code that runs after the answer and changes it, or keeps the worker alive",
    """
import atexit, signal, threading, time
class Last:
    def __del__(self):
        while True:
            pass
def forever():
    while True:
        time.sleep(0.01)
kept = Last()
for number in range(1, 60):
    try:
        signal.signal(number, signal.SIG_IGN)
    except (OSError, ValueError):
        pass
atexit.register(forever)
threads = []
try:
    for _ in range(50):
        threads.append(threading.Thread(target=forever))
        threads[-1].start()
except RuntimeError:
    pass
""",
)
looks("files everywhere", """
# results, tests or a start-up file are there for the next run
import os, sys
for folder in (
    "/", "/tmp", "/box", "/given", "/student", "/dev", "/dev/shm", "/etc", "/usr", "/var", "/proc/1",
    sys.prefix, sys.prefix + "/lib/python3.11/site-packages", os.path.dirname(os.__file__),
    "/autograder/results", os.getcwd(), os.path.expanduser("~"),
):
    for name in ("results.json", "conftest.py", "sitecustomize.py", "wire.py", "attack-was-here"):
        try:
            with open(os.path.join(folder, name), "w") as file:
                file.write('{"score": 100}')
            print("FOUND a place to write:", folder, name)
        except OSError:
            pass
""")
attack("a full disk", "the grader cannot write its results", """
import os, tempfile
def euler_step(acceleration, t, x, v, dt, p):
    for n in range(100):
        try:
            with open(os.path.join(tempfile.gettempdir(), str(n)), "wb") as file:
                file.write(bytes(10 << 20))
        except OSError:
            pass
    return x, v
""")
attack("the parent's end", "without a grader the points stay as they are", """
import os, signal
def euler_step(acceleration, t, x, v, dt, p):
    for pid in [os.getppid(), 1, -1, 0, *range(2, 3000)]:
        if pid != os.getpid():
            try:
                os.kill(pid, signal.SIGKILL)
            except OSError:
                pass
    return x, v
""")
looks("memory of the others", """
# to read the expected values in the parent's memory
import os
for pid in range(1, 200):
    if pid != os.getpid():
        try:
            open(f"/proc/{pid}/mem", "rb").read(1)
            print("FOUND memory of", pid)
        except OSError:
            pass
""")
looks("higher limits", """
# time, memory and processes without end
import resource
for limit in (
    resource.RLIMIT_AS, resource.RLIMIT_CPU, resource.RLIMIT_NPROC,
    resource.RLIMIT_FSIZE, resource.RLIMIT_NOFILE,
):
    before = resource.getrlimit(limit)
    try:
        resource.setrlimit(limit, (before[1] + 1, before[1] + 1))
        print("FOUND a limit to raise:", limit)
    except (ValueError, OSError):
        pass
""")
looks("the network", """
# a friend answers, or is told the inputs
import socket
for family, place in (
    (socket.AF_INET, ("1.1.1.1", 53)),
    (socket.AF_INET, ("10.0.0.1", 80)),
    (socket.AF_UNIX, "/run/docker.sock"),
    (socket.AF_UNIX, "\\0/tmp/.X11-unix/X0"),
):
    try:
        s = socket.socket(family, socket.SOCK_STREAM)
        s.settimeout(0.2)
        s.connect(place)
        print("FOUND a connection:", place)
        s.close()
    except OSError:
        pass
try:
    socket.setdefaulttimeout(0.2)
    print("FOUND a name:", socket.gethostbyname("example.org"))
except OSError:
    pass
try:
    print("FOUND interfaces:", [name for _, name in socket.if_nameindex() if name != "lo"] or 1 / 0)
except (OSError, ZeroDivisionError):
    pass
""")
