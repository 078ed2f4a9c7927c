"""Give any lesson or scene, from any source of answers, plain or compiled, out of the same undecorated text.

A *world* is one consistent set of modules: the lessons of a subject (`solutions`, `lessons` or a folder) and the scenes that
use them.  The plain world of `solutions` is simply the imported packages.  Every other world is a fresh copy of those files
under a package name of its own, in which whatever came from `solutions` is replaced by the subject's function or by its
compiled twin.  Nothing is decorated, and the imported packages stay as they are.

A twin's cache on disk lives in a folder named after a digest of *all* files of its world, because numba looks at one file
only: without that, an edit to an imported sibling would leave a stale caller.
"""

import hashlib
import importlib
import os
import re
import shutil
import sys
import traceback
import types
import uuid
import warnings
from contextlib import suppress
from functools import lru_cache
from pathlib import Path

import numpy as np

from solutions.checks import BadInput

from .loading import LOAD_WITHIN, Unloadable, alarm, answer_for_what_is_missing, part, stand_in, unloadable

ROOT = Path(__file__).resolve().parent.parent
SOLUTIONS, SCENES = ROOT / "solutions", ROOT / "validate" / "scenes"
CACHE = ROOT / ".cache" / "compiled"
CACHED_WORLDS = 6              # digests kept on disk: a handful of edits back; older ones are deleted
GIVEN = {"__init__", "checks", "support", "vectors"}            # support is a folder: geometry and records
LAW = "acceleration"           # of a scene this is compiled, and what it calls; the loops are in the lessons


def subject_folder(of):
    """The folder that a subject's name means.  Raises BadInput when there is none."""
    folder = {"solutions": SOLUTIONS, "lessons": ROOT / "lessons"}.get(str(of), Path(of).expanduser())
    if not folder.is_dir():
        raise BadInput(f"subject {of!r}", "not a folder", "name solutions, lessons or a folder of lesson files")
    return folder.resolve()


def lesson_names(folder=SOLUTIONS):
    """The lessons in a folder, in the order of the course: the number is the first in the text."""
    def place(path):
        number = re.match(r'"""Lesson (\d+)', path.read_text(encoding="utf-8", errors="replace"))
        return int(number[1]) if number else 99, path.stem
    return [path.stem for path in sorted((path for path in Path(folder).glob("*.py") if path.stem not in GIVEN and path.is_file()), key=place)]


def withheld(lesson, folder=SOLUTIONS):
    """Functions of a lesson that still wait for their body: in solutions/ none, but all in a copy of the workbook without worked answers."""
    text = (Path(folder) / f"{lesson}.py").read_text(encoding="utf-8", errors="replace")
    return set(re.findall(r'raise NotImplementedError\("Exercise [\d.]+: (\w+)"\)', text))


def scene_names():
    """Every scene there is: one file each."""
    return sorted(path.stem for path in SCENES.glob("*.py") if path.stem != "__init__")


def bind(lesson, of="solutions", compiled=False):
    """The module of one lesson, as saved just now.  Raises BadInput for an unknown subject or lesson."""
    folder = subject_folder(of)
    if not (folder / f"{lesson}.py").is_file():
        if lesson in lesson_names():
            why, remedy = f"there is no such file in {folder}", "put it back, or name the folder that has it"
            raise Unloadable(f"{folder.name}/{lesson}.py", why, remedy)
        known = ", ".join(lesson_names(folder)) or "none"
        raise BadInput(f"lesson {lesson!r}", f"not in {folder}", f"choose from: {known}")
    return world(of, compiled).lesson(lesson)


def bind_scene(scene, of="solutions", compiled=False):
    """The module of one scene with the lesson functions of that subject.  Raises BadInput if it is unknown or broken."""
    if scene not in scene_names():
        raise BadInput(f"scene {scene!r}", "unknown", "`validate list` names them all")
    try:
        return world(of, compiled).scene(scene)
    except BadInput:
        raise
    except (Exception, SystemExit) as e:                             # a file in the making may do anything
        lines = [(f.filename, f.lineno) for f in traceback.extract_tb(e.__traceback__)]
        lines += [(e.filename, e.lineno)] if isinstance(e, SyntaxError) else []
        folders = SCENES, SOLUTIONS, subject_folder(of)
        places = [f"file {file!r}, line {line}," for file, line in lines if Path(file).parent in folders]
        why = (str(getattr(e, "msg", e)).splitlines() or [""])[0]
        raise BadInput((places or [f"scene {scene!r} of {str(of)!r}"])[-1], f"not loadable ({type(e).__name__}: {why})",
                       "correct that first") from None


def world(of="solutions", compiled=False):
    """The world of a subject as its files stand now."""
    folder = subject_folder(of)
    if folder == SOLUTIONS and not compiled:
        return PLAIN
    return _world(folder, compiled, digest_of(folder))


def digest_of(folder):
    """Fingerprint of every file that a world of this subject is made of, and of the compiler."""
    compiler = f"{_numba_version()} {sys.version} {os.environ.get('NUMBA_BOUNDSCHECK', '')}"
    return fingerprint({*SOLUTIONS.rglob("*.py"), *SCENES.glob("*.py"), *folder.glob("*.py"), Path(__file__)}, compiler)


def fingerprint(files, more=""):
    """Twelve digits that change with any of these files."""
    text = b"".join(str(path).encode() + path.read_bytes() for path in sorted(files) if path.is_file())
    return hashlib.sha256(text + more.encode()).hexdigest()[:12]


def _numba_version():
    from importlib.metadata import PackageNotFoundError, version
    try:
        return version("numba")
    except PackageNotFoundError:
        return None


def can_compile():
    """Whether numba is installed here: it has no wheel for some machines, and the workbook works without it."""
    return _numba_version() is not None


@lru_cache(maxsize=16)
def _world(folder, compiled, digest):
    if compiled and not can_compile():
        raise BadInput("numba", "not installed", "install it, or use --plain")
    return CompiledWorld(folder, digest) if compiled else World(folder, digest)


def with_law(scene):
    """The scene, with its acceleration under the name `law`: what run is given.  `acceleration` itself always stays plain."""
    scene.law = getattr(scene, LAW, None)
    return scene


class PlainWorld:
    """The packages as imported."""

    def lesson(self, name):
        return importlib.import_module(f"solutions.{name}")

    def scene(self, name):
        return with_law(importlib.import_module(f"validate.scenes.{name}"))


PLAIN = PlainWorld()


def _siblings(file):
    """Names of the files beside a subject's file that it imports."""
    named = re.findall(r"^from \.(\w+) import", file.read_text(encoding="utf-8", errors="replace"), re.M)
    return {name for name in named if (file.parent / f"{name}.py").is_file()}


class World:
    """Copies of the subject's lessons and of the scenes, under a package name of their own, that refer to each other."""

    def __init__(self, folder, digest, speed="plain"):
        self.name, self.folder, self.done = f"_{speed}_{digest}", folder, {}
        self.stuck, self.loading = {}, set()                             # {lesson: its Unloadable}, lessons being loaded
        for package, path in {"": [], ".solutions": [SOLUTIONS], ".subject": [folder], ".scenes": [SCENES]}.items():
            module = sys.modules[self.name + package] = types.ModuleType(self.name + package)
            module.__path__ = [str(p) for p in path]

    def lesson(self, name):
        """A lesson of the subject.  Raises the same Unloadable every time when its file cannot be loaded."""
        if name not in self.stuck and ("subject", name) not in self.done:
            self._load_safely(name)
        if name in self.stuck:
            raise self.stuck[name].with_traceback(None)
        return self.done["subject", name]

    def _load_safely(self, name):
        """Load a file that may hold anything.  What is given in a sibling stands in for it where it cannot be loaded."""
        file = self.folder / f"{name}.py"
        self.loading.add(name)
        try:
            for sibling in _siblings(file) - self.loading:
                self._make_sure_of(sibling)
            with alarm(LOAD_WITHIN), warnings.catch_warnings():
                warnings.simplefilter("ignore")                          # of a stray backslash in a docstring
                answer_for_what_is_missing(self._load("subject", name))
        except KeyboardInterrupt:
            raise
        except BaseException as e:                                       # SystemExit, TooLong and classes of the student's own
            self.stuck[name] = unloadable(file, e)
        finally:
            self.loading.remove(name)

    def _make_sure_of(self, sibling):
        try:
            self.lesson(sibling)
        except Unloadable as e:
            known = sibling in lesson_names()
            given, exercises = (vars(PLAIN.lesson(sibling)), withheld(sibling)) if known else ({}, ())
            sys.modules[f"{self.name}.subject.{sibling}"] = stand_in(sibling, given, exercises, str(e))

    def scene(self, name):
        return self._load("scenes", name)

    def solution(self, name):
        """A lesson of the solutions, as lessons and scenes of this world see it."""
        return PLAIN.lesson(name)

    def _load(self, package, name):
        if (package, name) not in self.done:
            module = importlib.import_module(f"{self.name}.{package}.{name}")
            self.done[package, name] = module
            self._finish(package, module)
        return self.done[package, name]

    def _finish(self, package, module):
        if package == "scenes":
            vars(module).update(self._redirected(package, module))
            with_law(module)

    def _redirected(self, package, module):
        """{name: what it means in this world} for everything that module imported from a lesson.

        A scene means the subject's lessons, a lesson means the solutions'.  Classes stay one for all worlds, or
        `except BadInput` would not recognise what a twin raises.
        """
        meant = {}
        for name, value in vars(module).items():
            home = value.__name__ if isinstance(value, types.ModuleType) else getattr(value, "__module__", None) or ""
            source, _, origin = home.removeprefix(f"{self.name}.").partition(".")                  # origin: friction, or support.arms
            if source not in ("solutions", "subject"):
                continue
            if isinstance(value, type):
                meant[name] = getattr(PLAIN.lesson(origin), value.__name__) if source == "solutions" else value
            elif home != module.__name__ and isinstance(value, (types.ModuleType, types.FunctionType)):
                of_subject = source == "subject" or (package == "scenes" and (self.folder / f"{origin}.py").is_file())
                there = self.lesson(origin) if of_subject else self.solution(origin)
                meant[name] = there if isinstance(value, types.ModuleType) else part(there, value.__name__)
        return meant


class CompiledWorld(World):
    """The same, compiled: every function of a lesson, and the law of a scene.  A scene's run is plain and calls compiled lessons."""

    def __init__(self, folder, digest):
        super().__init__(folder, digest, "compiled")
        _use_cache(digest)

    def lesson(self, name):
        return self.solution(name) if self.folder == SOLUTIONS else super().lesson(name)

    def solution(self, name):
        return self._load("solutions", name)

    def _finish(self, package, module):
        if package != "scenes":
            vars(module).update(self._redirected(package, module))
            own = {name for name, f in vars(module).items() if isinstance(f, types.FunctionType) and f.__module__ == module.__name__}
            vars(module).update(_twins(module, own, vars(module)))
            return
        space = {**vars(module), **self._redirected(package, module)}           # what compiled functions see
        plain = vars(world(self.folder).scene(module.__name__.rpartition(".")[2]))
        lessons = {name: Direct(twin) for name, twin in self._redirected(package, module).items() if hasattr(twin, "py_func")}
        space |= _twins(module, _called_from(space, LAW, module.__name__), space)
        run = types.FunctionType(plain["run"].__code__, {**plain, **lessons}, "run")
        vars(module).update({**plain, "__name__": module.__name__, "run": run, "law": space.get(LAW)})


def _twins(module, names, space):
    """{name: compiled function}, whose globals are `space`, for those functions of a module."""
    from numba import njit
    twins = {}
    for name in names:
        plain = space[name]
        copy = types.FunctionType(plain.__code__, space, plain.__name__, plain.__defaults__, plain.__closure__)
        copy.__module__, copy.__qualname__, copy.__doc__ = module.__name__, plain.__qualname__, plain.__doc__
        twins[name] = njit(cache=True, error_model="numpy", no_cfunc_wrapper=True)(copy)
        # numba recognises a function argument in its disk cache by this id alone: make it the same in every process
        twins[name]._set_uuid(str(uuid.uuid5(uuid.NAMESPACE_URL, f"{module.__name__}.{plain.__qualname__}")))
    return twins


class Direct:
    """A compiled function that goes by the kinds of its arguments: numba's own search for the machine code takes 50 µs a call."""

    def __init__(self, twin):
        self.twin, self.known = twin, {}

    def __call__(self, *arguments):
        arguments = [a.twin if isinstance(a, Direct) else a for a in arguments]           # a lesson's function may take another
        kinds = tuple(map(_kind, arguments))
        if kinds not in self.known:
            from numba import typeof
            exact = tuple(map(typeof, arguments))
            if exact not in self.twin.overloads:
                self.twin.compile(exact)
            self.known[kinds] = self.twin.get_overload(exact)
        return self.known[kinds](*arguments)


def _kind(argument):
    """What decides which machine code an argument needs."""
    if isinstance(argument, np.ndarray):
        return argument.dtype, argument.ndim, argument.flags.num
    if isinstance(argument, tuple):
        return type(argument), *map(_kind, argument)
    return argument if hasattr(argument, "py_func") else type(argument)


def _called_from(space, root, home):
    """Names of the functions of module `home` that root reaches, itself included."""
    own = {name: f for name, f in space.items() if isinstance(f, types.FunctionType) and f.__module__ == home}
    reached, waiting = set(), [root] if root in own else []
    while waiting:
        name = waiting.pop()
        reached.add(name)
        waiting += [n for n in own[name].__code__.co_names if n in own and n not in reached]
    return reached


@lru_cache(maxsize=1)
def _without_addresses():
    """Let numba keep the machine code of functions that hand a function on: it would write down an address, which nobody reads."""
    from numba import types
    from numba.core.imputils import lower_constant
    import numba.experimental.function_type  # noqa: F401           registers its own way: ours must come after
    lower_constant(types.Dispatcher)(lambda context, builder, kind, function: context.get_dummy_value())


@lru_cache(maxsize=1)
def _short_of_words():
    """Let `rows[k] = row` say that shapes differ, but not which: compiling that sentence takes numba longer than all the rest."""
    from numba.extending import overload
    from numba.np import arrayobj

    def shapes_differ(src_shapes, index_shape):
        """Stands in for numba's function of that purpose."""

    @overload(shapes_differ)
    def _(src_shapes, index_shape):
        def say(src_shapes, index_shape):
            raise ValueError("an array does not fit where it is assigned to")
        return say
    if hasattr(arrayobj, "raise_with_shape_context"):                # of numba 0.61 and later
        arrayobj.raise_with_shape_context = shapes_differ


@lru_cache(maxsize=1)
def _full_disk_is_no_error():
    """Let numba go on where the disk takes no more: what it cannot keep is compiled anew next time."""
    from numba.core.caching import Cache
    keep = Cache.save_overload

    def keep_if_possible(cache, signature, data):
        with suppress(OSError):
            keep(cache, signature, data)
    Cache.save_overload = keep_if_possible


def _use_cache(digest):
    """Point numba at this world's folder, and delete the folders of worlds long gone."""
    import numba
    from numba.core.config import _OptLevel
    _without_addresses()
    _short_of_words()
    _full_disk_is_no_error()
    numba.config.OPT, numba.config.LOOP_VECTORIZE = _OptLevel(1), 0                   # same speed here, a third of the compiling
    warnings.filterwarnings("ignore", message="Cannot cache compiled function")      # then it is compiled anew, that is all
    folder = CACHE / digest
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:                                                  # a read-only installation: compile anew each time
        import tempfile
        folder = Path(tempfile.mkdtemp(prefix="workbook-"))
    os.utime(folder)
    numba.config.CACHE_DIR = str(folder)
    worlds = sorted(folder.parent.iterdir(), key=lambda path: path.stat().st_mtime, reverse=True)
    for old in worlds[CACHED_WORLDS:]:
        shutil.rmtree(old, ignore_errors=True)
