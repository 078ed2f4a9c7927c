"""The sandbox: what a student's program sees of this machine, and how it is locked in.

On Linux a program runs in bubblewrap.  It sees the system's and Python's own programs and libraries and what it is given, all read-only; no network, no other
process, and nothing that grading uses, wherever that lies: `keep_out` names it.  `calls` says what it may ask of the kernel.
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

from solutions.checks import BadInput
from validate.modules import ROOT

from . import calls

ENVIRONMENT = {"PATH": "/usr/bin:/bin", "HOME": "/tmp", "LANG": "C.UTF-8", "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1",
               "MKL_NUM_THREADS": "1", "PYTHONHASHSEED": "0"}
SYSTEM = ("/usr/bin", "/usr/lib", "/usr/lib32", "/usr/lib64", "/usr/local/lib", "/bin", "/lib", "/lib32", "/lib64", "/etc/ld.so.cache")
PYTHON = ("bin", "lib", "lib64", "pyvenv.cfg")         # of a prefix; the rest of it may hold anything, a clone of the workbook among it
PACKAGES = ("solutions", "lessons", "validate", "tests", "pybullet*", "pymunk*", "physics_animation_workbook*", "__editable__*")      # hidden where Python has them
TEMPORARY = 32 << 20         # of /tmp in the sandbox [bytes]
private = {}                 # {folder or file that grading uses: what it is}


def keep_out(paths):
    """Hide these as well, {path: what it is}.  Raises BadInput for what cannot be hidden, because Python needs it."""
    for path, what in paths.items():
        path = Path(path).resolve()
        for place in shown():
            if place.resolve().is_relative_to(path):
                raise BadInput(f"{what} {str(path)!r}", f"where Python has its own files ({place}), which every student's program can read", "move it elsewhere")
        private[path] = what


def shown():
    """Folders and files of this machine that the sandbox shows, each at its own place."""
    prefixes = (sys.base_prefix, sys.prefix, Path(sys.base_prefix).resolve(), Path(sys.executable).resolve().parent.parent)
    return [path for path in dict.fromkeys(map(Path, (*SYSTEM, *(f"{prefix}/{name}" for prefix in prefixes for name in PYTHON)))) if path.exists()]


def hidden(places):
    """Where something private lies below one of those places, as a student's program would see it."""
    workbook = () if ROOT.name.endswith("-packages") else (ROOT,)      # installed among Python's packages: then these are hidden by name
    for place in places:
        source = place.resolve()
        for path in (*workbook, Path(tempfile.gettempdir()).resolve(), *private):
            if path.is_relative_to(source) and path != source and path.exists():
                yield place / path.relative_to(source)
        for pattern in PACKAGES:
            yield from map(Path, glob.glob(f"{place}/python*/*-packages/{pattern}"))


def view():
    """bwrap's arguments for what is shown and hidden: parents before children, so that the environment of a hidden workbook is there."""
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
    """bwrap's arguments: the view of this machine, the binds {from: to}, an empty /tmp, and nothing else.  filter: descriptor of the filter of system calls."""
    around = [shutil.which("bwrap") or "bwrap", "--unshare-pid", "--unshare-net", "--unshare-ipc", "--unshare-uts", "--unshare-cgroup-try", "--die-with-parent",
              "--new-session", "--clearenv", "--hostname", "box", "--cap-drop", "ALL"]
    for name, value in ENVIRONMENT.items():
        around += ["--setenv", name, value]
    around += ["--dev", "/dev", "--perms", "1777", "--size", str(TEMPORARY), "--tmpfs", "/tmp", *view()]          # an environment may lie below /tmp
    for source, target in binds.items():
        around += ["--dir", os.path.dirname(target), "--ro-bind", str(source), target]
    around += ["--remount-ro", "/dev", "--chdir", "/tmp"]
    locked = ["--unshare-user", "--disable-userns", "--seccomp", str(filter)]
    if os.geteuid() != 0:
        return [*around, "--dir", "/proc", "--remount-ro", "/", *locked]
    # the limit of processes does not bind root: become somebody who owns nothing, then give up making users; bwrap needs /proc for that, and hides it
    somebody = str(60000 + secrets.randbelow(5000))
    return [*around, "--proc", "/proc", "--remount-ro", "/", "--cap-add", "CAP_SETUID", "--cap-add", "CAP_SETGID", "--cap-add", "CAP_SETPCAP", "setpriv", "--reuid", somebody,
            "--regid", somebody, "--clear-groups", "--no-new-privs", "--inh-caps=-all", "--bounding-set=-all",
            "bwrap", "--die-with-parent", "--dev-bind", "/", "/", "--tmpfs", "/proc", "--remount-ro", "/proc", *locked]


def started(binds, program, **pipes):
    """A process of that program in the sandbox; without binds as it is, outside."""
    if binds is None:
        environment = {**ENVIRONMENT, **{k: os.environ[k] for k in ("SYSTEMROOT",) if k in os.environ}}
        return subprocess.Popen(program, env=environment, start_new_session=True, **pipes)
    reader, writer = os.pipe()
    try:
        os.write(writer, calls.program())                              # which the pipe holds
        os.close(writer)
        return subprocess.Popen([*command(binds, reader), *program], env=ENVIRONMENT, pass_fds=(reader,), start_new_session=True, **pipes)     # --clearenv leaves /proc/1/environ
    finally:
        os.close(reader)


# ---------------------------------------------------------------------------------------------- whether there is one

@lru_cache(maxsize=1)
def unavailable():
    """Why code cannot be locked in here; an empty string when it can."""
    if not shutil.which("bwrap"):
        return "bubblewrap is not installed"
    try:
        trial = started({}, [sys.executable, "-I", "-c", "import numpy"], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        _, said = trial.communicate(timeout=30)
    except (OSError, subprocess.TimeoutExpired) as e:
        return f"the sandbox does not start: {e}"
    return "" if trial.returncode == 0 else f"bubblewrap may not make a sandbox here: {said.decode(errors='replace').strip()[-200:]}"


def for_tests(skip, fail):
    """Without a sandbox the tests of the grader cannot say anything: they fail where WORKBOOK_SANDBOX=required, as in CI, and else say so and are left out."""
    if unavailable():
        leave = fail if os.environ.get("WORKBOOK_SANDBOX") == "required" else skip
        leave(f"the grader is not tested here: {unavailable()}. Install it (Debian: apt-get install bubblewrap libseccomp2)")
