"""The program inside the sandbox, beside the student's code.  The parent trusts nothing that comes from here.

Usage: worker.py CONFIG NOTES.  CONFIG is a JSON object: limits; lesson; student, the folder of the student's file;
given, the folder of the lessons as handed out; wire, the folder of wire.py; earlier, {lesson: its exercises} of the
lessons that this one builds on; noted, the kinds of what the instructor may look into.  NOTES is the descriptor of the
pipe for these notes, and becomes the one that config names as kept.
Frames go over standard input and output; what the student prints goes to standard error.
"""

import collections
import contextlib
import fcntl
import importlib.util
import json
import os
import resource
import sys
import traceback
import types

config = json.loads(sys.argv[1])
LESSON = f"lessons.{config['lesson']}"
for limit, value in config["limits"].items():                          # hard, and set before any code of the student's
    with contextlib.suppress(ValueError, OSError):
        resource.setrlimit(getattr(resource, f"RLIMIT_{limit}"), (value, value))

sys.path.insert(0, config["wire"])
import numpy  # noqa: F401         before the student's file, or it would count against the time of the first test
import shipping
import wire

incoming, outgoing = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
os.dup2(2, 1)                                                          # print() goes where standard error goes


# ---------------------------------------------------------------------------------------------- modules

class Handout(importlib.machinery.SourceFileLoader):
    """Loads a lesson as handed out; its exercises are worked by the parent, over the wire."""

    def exec_module(self, module):
        super().exec_module(module)
        name = module.__name__.partition(".")[2]
        for function in config["earlier"].get(name, ()):
            setattr(module, function, remote(f"solution:{name}.{function}"))


class Submission(importlib.machinery.SourceFileLoader):
    """Loads a student's file, and raises SyntaxError for a NUL byte in it, as Python does from 3.11.4 on."""

    def source_to_code(self, data, path):
        try:
            return super().source_to_code(data, path)
        except ValueError as e:
            raise SyntaxError(str(e)) from e


class Finder:
    """Finds the student's file as lessons.NAME, and under solutions or lessons the checks and the lessons that this
    one builds on.
    """

    @staticmethod
    def find_spec(full, path=None, target=None):
        package, _, name = full.rpartition(".")
        if full == LESSON:
            file = os.path.join(config["student"], f"{name}.py")
            return importlib.util.spec_from_file_location(full, file, loader=Submission(full, file))
        file = os.path.join(config["given"], f"{name}.py")
        if full in ("solutions.given", "solutions.support"):               # what is in them is found the usual way
            folder = os.path.join(config["given"], name)
            return importlib.util.spec_from_file_location(full, os.path.join(folder, "__init__.py"),
                                                          submodule_search_locations=[folder])
        if package in ("lessons", "solutions") and (name in config["earlier"] or name in ("checks", "vectors")):
            return importlib.util.spec_from_file_location(full, file, loader=Handout(full, file))
        return None


for package in ("lessons", "solutions"):
    sys.modules[package] = types.ModuleType(package)
    sys.modules[package].__path__ = []
sys.meta_path.insert(0, Finder)


# ---------------------------------------------------------------------------------------------- functions and records

own: dict = {}       # functions of ours that the parent knows by name
names: dict = {}     # and back


def remote(name):
    """Return a function of the parent's."""
    def call(*arguments):
        return peer.call(name, arguments)
    names[call] = name
    return call


def students(name):
    """Return a function of the student's file, which is imported when the first one is called."""
    def call(*arguments):
        return getattr(importlib.import_module(LESSON), name)(*arguments)
    names[call] = f"lesson:{name}"
    return call


def define(name, *parts):
    """Make a function of the tests that runs here."""
    own[name] = shipping.function_of(*parts)
    names[own[name]] = name


def resolve(name):
    """Return a function by the name that it has on the wire."""
    kind, _, rest = name.partition(":")
    if name == "echo":
        return lambda text: text
    if name == "import":
        return lambda: importlib.import_module(LESSON) and None
    return students(rest) if kind == "lesson" else own[name] if kind in ("own", "code") else remote(name)


def name_of(function):
    """Return the name by which the parent may call a function."""
    if function not in names:
        names[function] = f"own:{len(own)}"
        own[names[function]] = function
    return names[function]


records: dict = {}


def record(name, fields, values):
    """Return a NamedTuple of the class that a lesson has for it, or of one that looks the same."""
    for module in [m for n, m in list(sys.modules.items()) if n.startswith(("lessons.", "solutions."))]:
        known = getattr(module, name, None)
        if isinstance(known, type) and getattr(known, "_fields", None) == fields:
            return known(*values)
    if (name, fields) not in records:
        records[name, fields] = collections.namedtuple(name, fields)
    return records[name, fields](*values)


# ---------------------------------------------------------------------------------------------- errors

class FromParent(Exception):
    """An error of the parent's that the lessons have no name for."""


def raised(names, message, where):
    """Return an error of the parent's, as the class of that name."""
    for module in ("solutions.checks", "builtins"):
        kind = getattr(sys.modules.get(module), names[0], None)
        if isinstance(kind, type) and issubclass(kind, Exception):
            return kind.__new__(kind, message)
    return FromParent(f"{names[0]}: {message}")


def describe(e):
    """Return names of its class and that class's bases, message, and the last place in the student's file."""
    places = [entry.lineno for entry in traceback.extract_tb(e.__traceback__)
              if entry.filename.startswith(config["student"])]
    line = e.lineno if isinstance(e, SyntaxError) else places[-1] if places else None
    place = f"{config['lesson']}.py, line {line}" if line else ""
    return [kind.__name__ for kind in type(e).__mro__][:8], str(e)[:300], place


# ------------------------------------------------------------------------------------ what the instructor may look into

NOTED = {
    "process": "os.fork os.forkpty os.posix_spawn os.system os.exec subprocess.Popen",
    "signal": "os.kill os.killpg signal.pthread_kill",
    "write": "os.remove os.rename os.mkdir os.rmdir os.truncate os.link os.symlink os.chmod os.chown os.utime",
    "read": "open os.listdir os.scandir os.chdir sqlite3.connect",
    "inside": "gc.get_objects gc.get_referrers gc.get_referents sys.settrace sys.setprofile sys._current_frames "
              "sys.addaudithook sys.monitoring.register_callback",
    "limit": "resource.setrlimit resource.prlimit",
    "network": "socket.",                                              # all events that begin so
    "native": "ctypes.",
}


def kept(descriptor):
    """Move a descriptor to the number that the filter of system calls lets no program close or turn elsewhere."""
    number = fcntl.fcntl(descriptor, fcntl.F_DUPFD_CLOEXEC, config["kept"])
    os.close(descriptor)
    if number != config["kept"]:
        raise OSError(f"descriptor {config['kept']} is in use")
    return number


def watcher():
    """Return an audit hook that reports operations which no lesson needs, in a pipe to the parent.

    A report cannot be taken back.  The student's code may reach the hook's variables by an error or a signal inside it:
    none of them can be changed, and no method of the student's objects is called.
    """
    notes = kept(int(sys.argv[2]))
    code = {kind: bytes([k]) for k, kind in enumerate(config["noted"])}
    events = tuple((event, code[kind]) for kind, names in NOTED.items() for event in names.split())
    reading, writing = code["read"], code["write"]
    ours = (sys.prefix, sys.base_prefix, os.path.realpath(sys.base_prefix), os.path.dirname(os.__file__), os.devnull,
            config["given"], config["student"], config["wire"])
    changing = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
    kind_of, text, number, write = type, str, int, os.write

    def hook(event, arguments):
        note = None
        for known, code in events:
            if event == known or (known[-1] == "." and event.startswith(known)):
                note = code
        if note is reading:
            path, *more = arguments or (None,)
            if kind_of(path) is number:                                # a descriptor, which has been opened before
                return
            plain = kind_of(path) is text                              # not bytes, nor a class of the student's
            flags = more[-1] if event == "open" and more and kind_of(more[-1]) is number else 0
            if flags & changing and not (plain and path == "/dev/null"):
                note = writing
            elif plain and path.startswith(ours) and "/.." not in path:
                return
        if note:
            write(notes, note)
    return hook


# ---------------------------------------------------------------------------------------------- the conversation

def send(frame):
    outgoing.write(frame)
    outgoing.flush()


def receive():
    frame = wire.read(incoming)
    if frame is None:                                                  # the parent has gone
        os._exit(0)
    return frame


peer = wire.Peer(send, receive, resolve, name_of, record, describe, raised, define)
sys.addaudithook(watcher())
send(wire.pack(("ready",)))
while True:
    kind, *content = peer.message()
    if kind == "call":
        peer.serve(*content)
