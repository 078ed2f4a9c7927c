"""The sandbox shows no file of grading, wherever it lies, and the kernel allows only the system calls of a lesson."""

import ctypes
import errno
import json
import os
import platform
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from solutions.checks import BadInput
from validate.grading import calls, sandbox

PATIENCE = 600.0             # [s]: only a program that hangs takes so long, on the busiest machine, too

pytestmark = pytest.mark.xdist_group("sandbox")


@pytest.fixture(scope="module", autouse=True)
def _sandbox():
    sandbox.for_tests(pytest.skip, pytest.fail)


def inside(program, *arguments):
    """Run a program in the sandbox, and return the JSON that it prints."""
    command = [sys.executable, "-I", "-B", "-c", program, *map(str, arguments)]
    pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    process = sandbox.started({}, command, **pipes)
    printed, said = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0, said.decode()
    return json.loads(printed)


# ---------------------------------------------------------------------------------------------- what is seen

LOOK = """
import json, os, sys
walks = [walk for top in sys.argv[1:] for walk in os.walk(top)]
print(json.dumps([os.path.join(here, name) for here, _, names in walks for name in names]))
"""
READ = """
import json, os, sys
def text(path):
    try:
        return open(path).read()
    except OSError:
        return ""
print(json.dumps(sorted(map(text, sys.argv[1:]))))
"""


@pytest.fixture(params=["lib", "share"])
def below_the_environment(request):
    """Make a folder below the environment's prefix, in a part that the sandbox shows and in one that it does not."""
    folder = Path(sys.prefix) / request.param
    folder.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder) as made:
        os.chmod(made, 0o755)                                          # the sandbox has another user
        yield Path(made)


def test_no_file_of_grading_is_seen_wherever_it_lies(below_the_environment, monkeypatch):
    used = {name: below_the_environment / name for name in ("workbook", "class", "grades", "temporary")}
    for folder in used.values():
        (folder / "deep").mkdir(parents=True)
        (folder / "deep" / "integrators.py").write_text("secret")
    (below_the_environment / "list.csv").write_text("secret")
    (below_the_environment / "library.py").write_text("anyone may read it")
    monkeypatch.setattr(sandbox, "ROOT", used["workbook"])
    monkeypatch.setattr(tempfile, "tempdir", str(used["temporary"]))
    monkeypatch.setattr(sandbox, "private", {})
    roster = below_the_environment / "list.csv"
    sandbox.keep_out({used["class"]: "submissions", used["grades"]: "grades", roster: "class list"})
    seen = [Path(path) for path in inside(LOOK, below_the_environment)]
    names = {path.name for path in seen}
    assert names <= {"library.py", "list.csv"}
    assert ("library.py" in names) == (below_the_environment.parent.name == "lib")       # the search has worked
    assert inside(READ, *seen) in (["", "anyone may read it"], [])


def test_a_workbook_among_pythons_files_still_has_its_environment(tmp_path, monkeypatch):
    """In /usr/lib/workbook/.venv, for example, the workbook is hidden and the environment is seen."""
    workbook = tmp_path / "usr" / "lib" / "workbook"
    (workbook / "solutions").mkdir(parents=True)
    (workbook / "solutions" / "integrators.py").write_text("secret")
    (workbook / ".venv" / "lib").mkdir(parents=True)
    (workbook / ".venv" / "lib" / "library.py").write_text("")
    monkeypatch.setattr(sandbox, "ROOT", workbook)
    monkeypatch.setattr(sandbox, "SYSTEM", (*sandbox.SYSTEM, tmp_path / "usr" / "lib", workbook / ".venv" / "lib"))
    assert inside(LOOK, tmp_path) == [str(workbook / ".venv" / "lib" / "library.py")]


def test_a_folder_named_by_a_link_is_hidden_at_its_own_path(below_the_environment, tmp_path, monkeypatch):
    (below_the_environment / "grades").mkdir()
    (below_the_environment / "grades" / "seed.txt").write_text("secret")
    (tmp_path / "link").symlink_to(below_the_environment / "grades")
    monkeypatch.setattr(sandbox, "private", {})
    sandbox.keep_out({tmp_path / "link": "grades"})
    assert inside(LOOK, below_the_environment) == []


@pytest.mark.parametrize("place", [sys.prefix, os.path.join(sys.prefix, "lib"), "/usr", "/"])
def test_a_folder_that_cannot_be_hidden_is_refused(place):
    with pytest.raises(BadInput, match=r"output folder .* where Python has its own files .*: move it elsewhere"):
        sandbox.keep_out({place: "output folder"})
    assert Path(place).resolve() not in sandbox.private


def test_only_programs_and_libraries_are_seen():
    top = inside(
        "import json, os\n"
        "print(json.dumps({path: sorted(os.listdir(path)) for path in ('/', '/usr', '/proc', '/etc')}))"
    )
    assert set(top["/usr"]) <= {"bin", "lib", "lib32", "lib64", "local"}
    assert top["/proc"] == [] and set(top["/etc"]) <= {"ld.so.cache"}
    own = {Path(place).parts[1] for place in (sys.prefix, sys.base_prefix)}
    assert set(top["/"]) <= {"bin", "dev", "etc", "lib", "lib32", "lib64", "proc", "tmp", "usr", *own}


def test_a_python_that_is_called_by_another_name_shows_no_more(monkeypatch):
    """Without following links, the prefix of /bin/python3 would be /."""
    monkeypatch.setattr(sys, "executable", "/bin/python3")
    assert not {Path("/"), Path("/usr")} & set(sandbox.shown())


# ---------------------------------------------------------------------------------------------- system calls

def verdict(program, architecture, number, *arguments):
    """Interpret the filter program for a system call, and return its verdict.

    *Source:* linux/filter.h, linux/seccomp.h.
    """
    data = struct.pack("<iIQ6Q", number, architecture, 0, *(arguments + 6 * (0,))[:6])
    code = [struct.unpack_from("<HBBI", program, 8 * n) for n in range(len(program) // 8)]
    at, value = 0, 0
    while True:
        operation, yes, no, k = code[at]
        at += 1
        if operation == 0x20:                                          # load
            value, = struct.unpack_from("<I", data, k)
        elif operation == 0x54:                                        # and
            value &= k
        elif operation == 0x05:                                        # jump
            at += k
        elif operation == 0x06:                                        # return
            return k
        else:
            true = {0x15: value == k, 0x25: value > k, 0x35: value >= k, 0x45: value & k != 0}[operation]
            at += yes if true else no


ARCHITECTURES = {            # AUDIT_ARCH_… of the machine, and of its 32-bit calls
    "x86_64": (0xC000003E, 0x40000003),
    "aarch64": (0xC00000B7, 0x40000028),
}
HERE, OTHER = ARCHITECTURES.get(platform.machine(), (0, 0))
REFUSED = ["fork", "vfork", "clone3", "socket", "memfd_create", "flock", "statfs", "prctl"]
GONE = calls.refused(errno.ENOSYS)


def number(name):
    return ctypes.CDLL(calls.LIBRARY).seccomp_syscall_resolve_name(name.encode())


@pytest.mark.skipif(not HERE, reason="the number of this machine's architecture is not known to the test")
def test_the_filter_allows_kills_and_refuses_the_listed_calls():
    program = calls.program()
    for names, answer in ((calls.ALLOWED, calls.ALLOW), (calls.NEVER, calls.KILL), (REFUSED, GONE)):
        known = [name for name in names if number(name) >= 0]
        assert {name: verdict(program, HERE, number(name)) for name in known} == dict.fromkeys(known, answer)
    assert verdict(program, HERE, 100_000) == GONE
    for foreign in (OTHER, 0, 0xC0000015):
        assert verdict(program, foreign, number("read")) == calls.KILL
    assert verdict(program, HERE, number("read") | 0x40000000) in (GONE, calls.KILL)         # the x32 calls of x86-64


@pytest.mark.skipif(not HERE, reason="the number of this machine's architecture is not known to the test")
def test_arguments_decide_where_a_call_can_do_more():
    program = calls.program()

    def of(name, *arguments):
        return verdict(program, HERE, number(name), *arguments)

    commands = 5, 6, 7, 36, 37, 38, 1024, 1025, 1026, 1031, 1036, 2 | 1 << 32
    assert of("fcntl", 3, 2) == calls.ALLOW and {of("fcntl", 3, k) for k in commands} == {GONE}
    assert of("ioctl", 3, 0x5401) == calls.ALLOW and of("ioctl", 3, 0x5412) == GONE
    assert of("clone", 0x3D0F00) == calls.ALLOW and {of("clone", flags) for flags in (17, 0x4111, 0x10000000)} == {GONE}
    for kept, other in (((calls.KEPT,), (3,)), ((3, calls.KEPT), (calls.KEPT, 3))):
        for name in ("close",) if len(kept) == 1 else ("dup2", "dup3"):
            assert (of(name, *kept), of(name, *other)) == (GONE, calls.ALLOW)
    again = calls.refused(errno.EAGAIN)
    assert of("futex", 8, 0x81) == calls.ALLOW and {of("futex", 8, k) for k in (0, 1, 3, 9, 265)} == {again}


def test_ordinary_programs_of_students_work():
    """Try joined threads, time, and attempts of other libraries to start a process or to write a file."""
    assert inside("""
import concurrent.futures, json, os, random, subprocess, tempfile, threading, time
import numpy as np
with concurrent.futures.ThreadPoolExecutor(2) as pool:
    squares = list(pool.map(lambda x: x * x, range(100)))
thread = threading.Thread(target=time.sleep, args=(0.05,))
thread.start()
thread.join()
total = 0.0
for write in (tempfile.TemporaryDirectory, lambda: np.save("/tmp/a", np.eye(3)), lambda: np.save("a", np.eye(3))):
    try:
        write()
    except OSError:
        total += 1.0
try:
    subprocess.run(["true"])
except OSError:
    total += 1.0
print(json.dumps([sum(squares), total, os.cpu_count() >= 1, os.system("clear") != 0]))
""") == [328350, 4.0, True, True]


def test_without_a_filter_there_is_no_sandbox(monkeypatch):
    monkeypatch.setattr(calls, "LIBRARY", "libnothing.so.2")
    calls.program.cache_clear()
    sandbox.way.cache_clear()
    try:
        assert "libnothing.so.2 is not installed (Debian: apt-get install libseccomp2)" in sandbox.unavailable()
    finally:
        calls.program.cache_clear()
        sandbox.way.cache_clear()
