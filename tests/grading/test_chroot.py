"""The second way to confine a program, for containers that forbid namespaces: what it sees, what it can do."""

import json
import os
import subprocess
import sys

import pytest

from validate.grading import chroot, example, marking, remote, sandbox, submissions
from validate.subject import modules

pytestmark = [
    pytest.mark.xdist_group("sandbox"),
    pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root can change the root folder"),
]
LOOK = """
import json, os
print(json.dumps([os.path.join(here, name) for here, _, names in os.walk("/") for name in names]))
"""
TRY = """
import ctypes, json, os, socket, sys
def answer(attempt):
    try:
        attempt()
        return "done"
    except OSError as e:
        return "refused"
attempts = {
    "write": lambda: open("/new", "w"), "make a folder": lambda: os.mkdir("/new"),
    "write over": lambda: open(sys.executable, "r+b"), "change a mode": lambda: os.chmod(sys.executable, 0o777),
    "signal": lambda: os.kill(int(sys.argv[1]), 0), "connect": socket.socket, "fork": os.fork,
    "read processes": lambda: os.listdir("/proc"), "read users": lambda: open("/etc/passwd"),
    "leave by ..": lambda: os.stat("/../../etc/passwd"), "use what is open": lambda: os.fstat(3),
}
print(json.dumps({**{name: answer(attempt) for name, attempt in attempts.items()}, "user": os.getuid(),
                  "groups": os.getgroups(), "here": os.getcwd()}))
"""


def inside(program, *arguments, binds=()):
    """Run a program in the empty root, and return the JSON that it prints."""
    command = [sys.executable, "-I", "-B", "-c", program, *map(str, arguments)]
    pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    process = sandbox.started_by("chroot", dict(binds), command, **pipes)
    printed, said = process.communicate(timeout=600.0)
    assert process.returncode == 0, said.decode()
    return json.loads(printed)


@pytest.fixture
def by_chroot(monkeypatch):
    monkeypatch.setattr(sandbox, "way", lambda: sandbox.Way("chroot", ""))


def test_it_works_here():
    assert sandbox.broken("chroot") == ""


def test_nothing_of_the_workbook_and_nothing_of_others_is_seen(tmp_path):
    (tmp_path / "ada.py").write_text("answer = 1\n")
    (tmp_path / "bob.py").write_text("answer = 2\n")
    first, second = (inside(LOOK, binds={tmp_path / name: f"/student/{name}"}.items()) for name in ("ada.py", "bob.py"))
    assert "/student/ada.py" in first and "/student/bob.py" in second and "/student/ada.py" not in second
    ours = {"integrators.py", "test_integrators.py", "marking.py", "conftest.py", "seed.txt", "passwd", "shadow"}
    assert not ours & {os.path.basename(path) for path in second if "/numpy/" not in path and "/scipy/" not in path}
    packages = {path.split("-packages/")[1].split("/")[0] for path in second if "-packages/" in path}
    assert packages <= {"numpy", "numpy.libs", "scipy", "scipy.libs"} and "numpy" in packages


def test_a_program_can_change_signal_and_reach_nothing():
    done = inside(TRY, os.getpid())
    assert done.pop("here") == "/" and done.pop("groups") == []
    assert done.pop("user") in chroot.users()
    assert done == dict.fromkeys(done, "refused")


def test_a_container_that_knows_few_users_has_one_for_the_program(tmp_path):
    for count, users in ((65_536, chroot.FEW_USERS), (2**32 - 1, chroot.USERS)):
        (tmp_path / "uid_map").write_text(f"         0     100000 {count}\n")
        (tmp_path / "gid_map").write_text(f"0 100000 1\n1 100001 {count - 1}\n")
        assert chroot.users(tmp_path) == users and users.stop <= count


IN_A_CONTAINER = """
import ctypes, os, sys
asked, told = os.pipe(), os.pipe()
child = os.fork()
if child:
    os.close(asked[1])
    for kind in ("uid", "gid") if os.read(asked[0], 1) else ():
        with open(f"/proc/{child}/{kind}_map", "w") as file:
            file.write("0 0 65536")
    os.write(told[1], b"x")
    sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
if ctypes.CDLL(None).unshare(0x10000000):
    sys.exit("no namespace of users here")
os.write(asked[1], b"x")
os.read(told[0], 1)
os.setresgid(0, 0, 0)
os.setresuid(0, 0, 0)
from validate.grading import sandbox
sys.exit(sandbox.broken("chroot") or 0)
"""


@pytest.mark.long
def test_it_works_where_the_kernel_knows_few_users():
    """As in a container of Docker with its own users, or of Podman without root."""
    done = subprocess.run([sys.executable, "-c", IN_A_CONTAINER], cwd=modules.ROOT, capture_output=True, text=True)
    if "no namespace of users here" in done.stderr:
        pytest.skip("this kernel makes no namespace of users")
    assert done.returncode == 0, done.stderr


def test_a_file_that_all_may_change_is_copied(tmp_path):
    for mode, linked in ((0o644, True), (0o646, False), (0o640, False)):
        source, target = tmp_path / f"{mode:o}", tmp_path / f"{mode:o} inside"
        source.write_text("text")
        source.chmod(mode)
        chroot.link(source, target)
        assert target.samefile(source) == linked and target.stat().st_mode & 0o006 == 0o004


def test_two_programs_run_as_two_users():
    assert len({inside("import os; print(os.getuid())") for _ in range(5)}) == 5


@pytest.mark.long
def test_the_points_are_those_of_the_other_way(monkeypatch):
    text = example.worked("springs").replace("p.k", "1.01 * p.k", 1).encode()
    settings = marking.settings(("springs",), "a secret")
    results = []
    for name in ("bubblewrap", "chroot"):
        if not sandbox.broken(name):
            monkeypatch.setattr(sandbox, "way", lambda name=name: sandbox.Way(name, ""))
            result = marking.mark(submissions.Submission("ada", {"springs": text}, (), ""), settings)
            results.append({**result, "seconds": 0.0})
    assert results[0] == results[-1] and 0.0 < sum(t["earned"] for t in results[0]["tests"])


def test_notes_and_the_end_of_a_program_are_seen(by_chroot):
    text = "import os, socket\ntry:\n    socket.socket()\nexcept OSError:\n    pass\nos._exit(3)\n"
    place = remote.box_of("integrators", text.encode(), 30.0)
    try:
        place.open()
        assert place.broken and place.seen >= {"network", "end"}
    finally:
        place.close()


def test_only_root_can_do_it(monkeypatch):
    monkeypatch.setattr(os, "geteuid", lambda: 1000)
    assert "only root can change the root folder" in sandbox.broken("chroot")


def test_a_way_that_does_not_exist_is_named():
    code = "from validate.grading import sandbox; sandbox.way()"
    done = subprocess.run([sys.executable, "-c", code], cwd=modules.ROOT, capture_output=True, text=True,
                          env={**os.environ, "WORKBOOK_SANDBOX_BY": "a fence"})
    assert "WORKBOOK_SANDBOX_BY is 'a fence': name one of bubblewrap, chroot" in done.stderr
