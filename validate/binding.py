"""Give any lesson or scene, from any source of answers, plain or compiled, out of the same undecorated text.

A *world* is one consistent set of modules: the lessons of a subject (`solutions`, `lessons` or a folder) and the scenes that
use them.  The plain world of `solutions` is simply the imported packages.  Every other world is a fresh copy of those files
under a package name of its own, in which whatever came from `solutions` is replaced by the subject's function or by its
compiled twin.  Nothing is decorated, and the imported packages stay as they are.

A twin's cache on disk lives in a folder named after a digest of *all* lesson files of its world, because numba looks at one
file only: without that, an edit to an imported sibling would leave a stale caller.  A scene's own digest is part of its name.
"""

import hashlib
import importlib
import os
import shutil
import sys
import types
import uuid
import warnings
from functools import lru_cache
from pathlib import Path

from solutions.checks import BadInput

ROOT = Path(__file__).resolve().parent.parent
SOLUTIONS, SCENES = ROOT / "solutions", ROOT / "validate" / "scenes"
CACHE = ROOT / ".cache" / "compiled"
CACHED_WORLDS = 6              # digests kept on disk: a handful of edits back; older ones are deleted
GIVEN = {"__init__", "checks", "vectors"}
COMPILED_SCENE_ROOT = "run"    # a scene compiles this function and what it calls; truth and engines stay plain


def subject_folder(of):
    """The folder that a subject's name means.  Raises BadInput when there is none."""
    folder = {"solutions": SOLUTIONS, "lessons": ROOT / "lessons"}.get(str(of), Path(of).expanduser())
    if not folder.is_dir():
        raise BadInput(f"subject {of!r}", "not a folder", "name solutions, lessons or a folder of lesson files")
    return folder.resolve()


def lesson_names(folder=SOLUTIONS):
    """The lessons in a folder, sorted."""
    return sorted(path.stem for path in Path(folder).glob("*.py") if path.stem not in GIVEN)


def scene_names():
    """Every scene there is: one file each."""
    return sorted(path.stem for path in SCENES.glob("*.py") if path.stem != "__init__")


def bind(lesson, of="solutions", compiled=False):
    """The module of one lesson, as saved just now.  Raises BadInput for an unknown subject or lesson."""
    folder = subject_folder(of)
    if not (folder / f"{lesson}.py").is_file():
        known = ", ".join(lesson_names(folder)) or "none"
        raise BadInput(f"lesson {lesson!r}", f"not in {folder}", f"choose from: {known}")
    return world(of, compiled).lesson(lesson)


def bind_scene(scene, of="solutions", compiled=False):
    """The module of one scene, its lesson functions taken from that subject.  Raises BadInput for an unknown scene."""
    if scene not in scene_names():
        raise BadInput(f"scene {scene!r}", "unknown", "`validate list` names them all")
    return world(of, compiled).scene(scene)


def world(of="solutions", compiled=False):
    """The world of a subject as its files stand now."""
    folder = subject_folder(of)
    if folder == SOLUTIONS and not compiled:
        return PLAIN
    return _world(folder, compiled, digest_of(folder))


def digest_of(folder):
    """Fingerprint of every lesson file that a world of this subject is made of, and of the compiler."""
    compiler = f"{_numba_version()} {sys.version} {os.environ.get('NUMBA_BOUNDSCHECK', '')}"
    return _fingerprint({*SOLUTIONS.glob("*.py"), *folder.glob("*.py"), Path(__file__)}, compiler)


def _fingerprint(files, more=""):
    text = b"".join(str(path).encode() + path.read_bytes() for path in sorted(files))
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
    return World(folder, compiled, digest)


class PlainWorld:
    """The packages as imported."""

    def lesson(self, name):
        return importlib.import_module(f"solutions.{name}")

    def scene(self, name):
        return importlib.import_module(f"validate.scenes.{name}")


PLAIN = PlainWorld()


class World:
    """A copy of solutions, subject and scenes under one package name, with their references redirected."""

    def __init__(self, folder, compiled, digest):
        speed = "compiled" if compiled else "plain"
        self.name, self.folder, self.compiled = f"_{speed}_{digest}", folder, compiled
        self.done = {}
        for package, path in {"": [], ".solutions": [SOLUTIONS], ".subject": [folder]}.items():
            self._package(package, path)
        if compiled:
            _use_cache(digest)

    def _package(self, package, path):
        if self.name + package not in sys.modules:
            module = sys.modules[self.name + package] = types.ModuleType(self.name + package)
            module.__path__ = [str(p) for p in path]

    def lesson(self, name):
        return self._load("subject" if self.folder != SOLUTIONS else "solutions", name)

    def scene(self, name):
        package = f"scenes_{_fingerprint([SCENES / f'{name}.py'])}"
        self._package(f".{package}", [SCENES])
        return self._load(package, name)

    def _load(self, package, name):
        key = package, name
        if key not in self.done:
            module = importlib.import_module(f"{self.name}.{package}.{name}")
            self.done[key] = module                                  # before its imports: lessons may not import in circles
            self._redirect(package, module)
            if self.compiled:
                self._compile(module, _called_from(module, COMPILED_SCENE_ROOT) if package.startswith("scenes") else None)
        return self.done[key]

    def _redirect(self, package, module):
        """Replace each thing that module imported from elsewhere in the workbook by this world's own.

        Classes stay one for all worlds, or `except BadInput` would not recognise what a twin raises.
        """
        for name, value in list(vars(module).items()):
            home = value.__name__ if isinstance(value, types.ModuleType) else getattr(value, "__module__", None) or ""
            source, _, origin = home.removeprefix(f"{self.name}.").rpartition(".")
            if source not in ("solutions", "subject") or (home == module.__name__ and not isinstance(value, type)):
                continue
            if isinstance(value, type):
                setattr(module, name, getattr(PLAIN.lesson(origin), value.__name__) if source == "solutions" else value)
            elif isinstance(value, (types.ModuleType, types.FunctionType)):
                replacement = self._load("subject", origin) if source == "subject" else self._origin(package, origin)
                setattr(module, name, replacement if isinstance(value, types.ModuleType) else getattr(replacement, value.__name__))

    def _origin(self, package, lesson):
        """Where a scene or a lesson of this world finds that lesson: scenes use the subject's, lessons use the solutions'."""
        if package.startswith("scenes") and (self.folder / f"{lesson}.py").is_file():
            return self.lesson(lesson)
        return self._load("solutions", lesson) if self.compiled else PLAIN.lesson(lesson)

    def _compile(self, module, names):
        from numba import njit
        for name, value in list(vars(module).items()):
            if isinstance(value, types.FunctionType) and value.__module__ == module.__name__ and (names is None or name in names):
                twin = njit(cache=True, error_model="numpy", no_cfunc_wrapper=True)(value)
                # numba recognises a function argument in its disk cache by this id alone: make it the same in every process
                twin._set_uuid(str(uuid.uuid5(uuid.NAMESPACE_URL, f"{module.__name__}.{value.__qualname__}")))
                setattr(module, name, twin)


def _called_from(module, root):
    """Names of the module's own functions that root reaches, itself included."""
    own = {name: f for name, f in vars(module).items() if isinstance(f, types.FunctionType) and f.__module__ == module.__name__}
    reached, waiting = set(), [root] if root in own else []
    while waiting:
        name = waiting.pop()
        reached.add(name)
        waiting += [n for n in own[name].__code__.co_names if n in own and n not in reached]
    return reached


def _use_cache(digest):
    """Point numba at this world's folder, and delete the folders of worlds long gone."""
    import numba
    from numba.core.config import _OptLevel
    numba.config.OPT, numba.config.LOOP_VECTORIZE = _OptLevel(2), 0                   # same speed here, a third of the compiling
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
