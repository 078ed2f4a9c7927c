"""The sandbox: the files that a student's program can read, and how it is confined.

A program runs in bubblewrap.  It can read the programs and libraries of the system and of Python, and the files that
it is given.  It has no network, sees no other process, has no place to write, and cannot read the files of grading,
which `keep_out` names.  Where the kernel forbids namespaces, it runs in an empty root (`chroot`).  `calls` lists the
system calls that are allowed.  Where neither way works, no code of a student runs.
"""

import glob
import os
import secrets
import shutil
import subprocess
import sys
import tempfile
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

from solutions.checks import BadInput
from validate.subject.modules import ROOT

from . import calls, chroot

ENVIRONMENT = {
    "PATH": "/usr/bin:/bin",
    "HOME": "/",
    "LANG": "C.UTF-8",
    "OPENBLAS_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "PYTHONHASHSEED": "0",
}
SYSTEM = (
    "/usr/bin",
    "/usr/lib",
    "/usr/lib32",
    "/usr/lib64",
    "/usr/local/lib",
    "/bin",
    "/lib",
    "/lib32",
    "/lib64",
    "/etc/ld.so.cache",
)
PYTHON = ("bin", "lib", "lib64", "pyvenv.cfg")         # of a prefix; the rest may hold a clone of the workbook
PACKAGES = (                 # hidden if they are installed among Python's packages
    "solutions",
    "lessons",
    "validate",
    "tests",
    "pybullet*",
    "pymunk*",
    "mujoco*",
    "physics_animation_workbook*",
    "__editable__*",
)
ISOLATED = (
    "--unshare-pid",
    "--unshare-net",
    "--unshare-ipc",
    "--unshare-uts",
    "--unshare-cgroup-try",
    "--die-with-parent",
    "--new-session",
    "--clearenv",
)
private: dict = {}           # {folder or file of grading: description}


def keep_out(paths):
    """Hide these paths as well, {path: description}.  Raises BadInput for a folder that Python needs."""
    for path, what in paths.items():
        path = Path(path).resolve()
        for place in shown():
            if place.resolve().is_relative_to(path):
                why = f"where Python has its own files ({place}), which every student's program can read"
                raise BadInput(f"{what} {str(path)!r}", why, "move it elsewhere")
        private[path] = what


def shown():
    """List the folders and files of this machine that the sandbox shows, each at its own path."""
    executable = Path(sys.executable).resolve()
    prefixes = (sys.base_prefix, sys.prefix, Path(sys.base_prefix).resolve(), executable.parent.parent)
    python = [f"{prefix}/{name}" for prefix in prefixes for name in PYTHON]
    return [path for path in dict.fromkeys(map(Path, (*SYSTEM, *python))) if path.exists()]


def hidden(places):
    """Generate the private paths below those places, as a student's program would see them."""
    workbook = () if ROOT.name.endswith("-packages") else (ROOT,)      # an installed one is hidden by PACKAGES
    for place in places:
        source = place.resolve()
        for path in (*workbook, Path(tempfile.gettempdir()).resolve(), *private):
            if path.is_relative_to(source) and path != source and path.exists():
                yield place / path.relative_to(source)
        yield from hidden_packages(place)


@lru_cache
def hidden_packages(place):
    """List the PACKAGES that are installed below a place.  Looking takes longer than starting bubblewrap."""
    return [Path(found) for pattern in PACKAGES for found in glob.glob(f"{place}/python*/*-packages/{pattern}")]


def view():
    """Return bwrap's arguments for shown and hidden paths.

    Parents come before children, so that an environment inside a hidden workbook is shown.
    """
    places, arguments, emptied = shown(), [], []
    steps = {**dict.fromkeys(places, True), **dict.fromkeys(hidden(places), False)}
    for path, visible in sorted(steps.items(), key=lambda step: len(step[0].parts)):
        for parent in reversed(path.parents[:-1]):                     # bwrap would make them for root only
            arguments += ["--dir", str(parent)]
        if visible or not path.is_dir():
            arguments += ["--ro-bind", str(path) if visible else "/dev/null", str(path)]
        else:
            arguments += ["--tmpfs", str(path)]
            emptied += ["--remount-ro", str(path)]
    return arguments + emptied


def command(binds, filter):
    """Return bwrap's arguments: the view of this machine, the binds {from: to}, and nothing else.

    filter: descriptor of the filter of system calls.
    """
    around = [shutil.which("bwrap") or "bwrap", *ISOLATED, "--hostname", "box", "--cap-drop", "ALL"]
    for name, value in ENVIRONMENT.items():
        around += ["--setenv", name, value]
    around += ["--dev", "/dev", "--dir", "/tmp", *view()]              # the inner bwrap wants /tmp, and leaves it empty
    for source, target in binds.items():
        around += ["--dir", os.path.dirname(target), "--ro-bind", str(source), target]
    around += ["--remount-ro", "/dev", "--chdir", "/"]
    locked = ["--unshare-user", "--disable-userns", "--seccomp", str(filter)]
    if os.geteuid() != 0:
        return [*around, "--dir", "/proc", "--remount-ro", "/", *locked]
    # The limit of processes does not bind root.  The program therefore runs as a user who owns nothing and cannot
    # make users.  The inner bwrap needs /proc for that, and hides it.
    user = str(60000 + secrets.randbelow(5000))
    capabilities = ["--cap-add", "CAP_SETUID", "--cap-add", "CAP_SETGID", "--cap-add", "CAP_SETPCAP"]
    as_user = ["setpriv", "--reuid", user, "--regid", user, "--clear-groups", "--no-new-privs"]
    powerless = ["--inh-caps=-all", "--bounding-set=-all"]
    inner = ["bwrap", "--die-with-parent", "--dev-bind", "/", "/", "--tmpfs", "/proc", "--remount-ro", "/proc", *locked]
    return [*around, "--proc", "/proc", "--remount-ro", "/", *capabilities, *as_user, *powerless, *inner]


def in_bubblewrap(binds, filter, program):
    return [*command(binds, filter), *program]


WAYS = {"bubblewrap": in_bubblewrap, "chroot": chroot.command}


def started(binds, program, keep=(), **pipes):
    """Start a program in the sandbox, with the binds {from: to}.  keep: descriptors that it inherits."""
    return started_by(way().name, binds, program, keep, **pipes)


def started_by(name, binds, program, keep=(), **pipes):
    """Start a program in the sandbox of that name, one of WAYS."""
    reader, writer = os.pipe()
    try:
        os.write(writer, calls.program())                              # it fits into the buffer of the pipe
        os.close(writer)
        whole = WAYS[name](binds, reader, program)
        pipes = {**pipes, "env": ENVIRONMENT}                          # because --clearenv leaves /proc/1/environ
        return subprocess.Popen(whole, pass_fds=(reader, *keep), start_new_session=True, **pipes)
    finally:
        os.close(reader)


# ---------------------------------------------------------------------------------------------- availability

class Way(NamedTuple):
    """How this machine confines a program."""
    name: str                # one of WAYS; "" if none works
    why: str                 # why none works; "" if one does


@lru_cache(maxsize=1)
def way():
    """Return the first of WAYS that works here, or the one that WORKBOOK_SANDBOX_BY names."""
    wanted, reasons = os.environ.get("WORKBOOK_SANDBOX_BY"), []
    for name in [wanted] if wanted else WAYS:
        if name not in WAYS:
            raise BadInput("WORKBOOK_SANDBOX_BY", repr(name), f"name one of {', '.join(WAYS)}")
        why = broken(name)
        if not why:
            return Way(name, "")
        reasons.append(why)
    return Way("", "; ".join(reasons))


def broken(name):
    """Return why one of WAYS does not work here; an empty string if it does."""
    if name == "bubblewrap" and not shutil.which("bwrap"):
        return "bubblewrap is not installed"
    pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE}
    try:
        trial = started_by(name, {}, [sys.executable, "-I", "-c", "import numpy"], **pipes)
        _, said = trial.communicate(timeout=30)
    except (OSError, subprocess.TimeoutExpired) as e:
        return f"{name} does not start: {e}"
    finally:
        chroot.remove_root()                                           # a run that is killed would leave it behind
    return f"{name} is not allowed here: {said.decode(errors='replace').strip()[-200:]}" if trial.returncode else ""


def unavailable():
    """Return why there is no sandbox on this machine; an empty string if there is one."""
    return way().why


def for_tests(skip, fail):
    """Skip the tests of the grader if there is no sandbox, or fail them if WORKBOOK_SANDBOX=required, as in CI."""
    if unavailable():
        leave = fail if os.environ.get("WORKBOOK_SANDBOX") == "required" else skip
        remedy = "Install it (Debian: apt-get install bubblewrap libseccomp2)"
        leave(f"the grader is not tested here: {unavailable()}. {remedy}")
