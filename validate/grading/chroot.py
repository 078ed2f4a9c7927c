"""The sandbox where the kernel forbids namespaces, as in Gradescope's containers: an empty root and a user of its own.

The program sees a folder with copies of Python, NumPy, SciPy and the libraries that these load, and nothing else: no
/proc, no place to write, no file of anyone else.  It runs as a user who owns nothing, whom no other process has, and
under the same filter of system calls as in bubblewrap.  Only root can do this.
*Source:* chroot(2), setresuid(2), prctl(2) with PR_SET_NO_NEW_PRIVS, seccomp(2).
"""

import atexit
import importlib.util
import os
import re
import secrets
import shutil
import stat
import subprocess
import sys
import sysconfig
import tempfile
from functools import lru_cache
from pathlib import Path

LIBRARIES = "numpy", "scipy"                      # that a student's program may import, beside Python's own
NEEDLESS = shutil.ignore_patterns("site-packages", "dist-packages", "test", "tests", "idlelib", "tkinter", "ensurepip",
                                  "lib2to3", "config-*")
FOUND = re.compile(r"(/\S+) \(0x")                # in the answer of ldd: the place of a library
USERS = range(2_000_000_000, 2_000_500_000)       # above those that systems and their containers give away
FEW_USERS = range(60_000, 65_000)                 # where a container knows 65,536 users only


def command(binds, filter, program):
    """Return the arguments that start a program in the empty root, with the binds {from: to} copied into it.

    filter: descriptor of the filter of system calls.  Raises OSError unless root calls it.
    """
    if os.geteuid() != 0:
        raise PermissionError("only root can change the root folder")
    top = root()
    for first in {Path(target).parts[1] for target in binds.values()}:
        shutil.rmtree(top / first, ignore_errors=True)                 # what the last program was given
    for source, target in binds.items():
        copy(source, inside(top, target))
    user = secrets.choice(users())
    numbers = str(user), str(filter), str(os.getpid())
    return [sys.executable, "-I", "-S", "-B", "-c", ENTER, str(top), *numbers, *program]


def users(folder=Path("/proc/self")):
    """Return the numbers of users and groups to choose from, all of them known to the kernel here."""
    maps = [(folder / name).read_text().splitlines() for name in ("uid_map", "gid_map")]
    known = [max(int(first) + int(count) for first, _, count in map(str.split, lines)) for lines in maps]
    return USERS if min(known) >= USERS.stop else FEW_USERS


# Runs as root, outside, before any code of a student.  The program is killed when its parent ends, which it must not
# outlive; a change of the user would undo that.  The filter comes last, because it forbids the rest.
ENTER = """
import ctypes, os, sys
top, user, filter, parent, *program = sys.argv[1:]
rules = os.read(int(filter), 1 << 16)
os.close(int(filter))
libc = ctypes.CDLL(None, use_errno=True)
class Program(ctypes.Structure):
    _fields_ = [("length", ctypes.c_ushort), ("rules", ctypes.c_char_p)]
os.chroot(top)
os.chdir("/")
os.setgroups([])
os.setresgid(*3 * [int(user)])
os.setresuid(*3 * [int(user)])
rule = Program(len(rules) // 8, rules)
die_with_parent, killed, no_new_privileges, set_filter, by_program = 1, 9, 38, 22, 2
for words in ((die_with_parent, killed, 0, 0, 0), (no_new_privileges, 1, 0, 0, 0),
              (set_filter, by_program, ctypes.byref(rule), 0, 0)):
    if libc.prctl(*words):
        raise OSError(ctypes.get_errno(), "the kernel confines no program")
if os.getppid() != int(parent):
    sys.exit("the parent has ended")
os.execv(program[0], program)
"""


# ---------------------------------------------------------------------------------------------- the empty root

@atexit.register
def remove_root():
    """Remove the folder that `root` has made.  It is made again when it is needed."""
    if root.cache_info().currsize:
        shutil.rmtree(root(), ignore_errors=True)
        root.cache_clear()


@lru_cache(maxsize=1)
def root():
    """Make the folder that becomes the root of programs of this process, one after the other."""
    top = Path(tempfile.mkdtemp(prefix="root-"))
    top.chmod(0o755)
    places = [sysconfig.get_path("stdlib"), sysconfig.get_path("platstdlib"), *packages()]
    for place in dict.fromkeys(map(Path, places)):
        for name in {place, place.resolve()}:
            if not inside(top, name).exists():
                copy(place, inside(top, name))
    executable = follow(top, Path(sys.executable))
    if (settings := Path(sys.prefix, "pyvenv.cfg")).is_file():
        copy(settings, inside(top, settings))
    for library in {*loaded([executable, *top.rglob("*.so*")]), Path("/etc/ld.so.cache")}:
        if library.is_file():
            copy(library, inside(top, library))
    make_null(inside(top, "/dev/null"))
    return top


def inside(top, path):
    """Return a path of this machine as it lies in the empty root."""
    return top / Path(path).relative_to("/")


def copy(source, target):
    """Copy a file or a folder, readable by all."""
    source = Path(source).resolve()
    target.parent.mkdir(parents=True, exist_ok=True)
    if source.is_dir():
        shutil.copytree(source, target, ignore=NEEDLESS, copy_function=link, dirs_exist_ok=True)
        for folder in (target, *(path for path in target.rglob("*") if path.is_dir())):
            folder.chmod(0o755)
    elif not target.exists():
        link(source, target)


def link(source, target):
    """Link a file to another name, which takes no room.

    Copy it where it cannot be linked, not be read by all, or be changed by all: a program could empty it.
    """
    try:
        if os.stat(source).st_mode & 0o006 != 0o004:
            raise PermissionError
        os.link(source, target)
    except OSError:
        shutil.copyfile(source, target)
        os.chmod(target, 0o755 if os.access(source, os.X_OK) else 0o644)


def packages():
    """Generate the folders of LIBRARIES, and of the libraries that their wheels bring along."""
    for name in LIBRARIES:
        found = importlib.util.find_spec(name)
        for place in map(Path, found.submodule_search_locations if found else ()):
            yield place
            if (beside := place.with_name(f"{name}.libs")).is_dir():
                yield beside


def follow(top, path):
    """Copy a program and the links that lead to it, and return the program's own place."""
    while path.is_symlink():
        place, target = inside(top, path), os.readlink(path)
        place.parent.mkdir(parents=True, exist_ok=True)
        if not place.is_symlink():
            place.symlink_to(target)
        path = Path(os.path.normpath(path.parent / target))
    copy(path, inside(top, path))
    return path.resolve()


def loaded(programs):
    """Return the places of all libraries that these programs and libraries load, and of the loader."""
    said = subprocess.run(["ldd", *map(str, programs)], capture_output=True, text=True).stdout
    return {Path(place) for place in FOUND.findall(said)}


def make_null(place):
    """Make the device of that name, or an empty file where devices are not allowed."""
    place.parent.mkdir(parents=True, exist_ok=True)
    try:
        os.mknod(place, 0o666 | stat.S_IFCHR, os.makedev(1, 3))
        place.chmod(0o666)
        place.read_bytes()
    except OSError:
        place.unlink(missing_ok=True)
        place.touch(0o444)
