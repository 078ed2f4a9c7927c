"""Load any lesson or scene, plain or compiled, with the lesson functions of a chosen subject.

A *module set* is one consistent set of modules: the lessons of a subject (`solutions`, `lessons` or a folder) and the
scenes that use them.  The plain set of `solutions` is simply the imported packages.  Every other set is a fresh copy
of those files under a package name of its own.  In it, each function that came from `solutions` is replaced by the
subject's function or by its compiled twin.  Nothing is decorated, and the imported packages stay as they are.

A lesson may have a *companion*, the file of the same name in `solutions/support/`: given functions that call exercises
and that nobody needs to read.  It imports from its lesson, and never the other way round.  A module set has its own
copy of it, which calls the subject's exercises.  Whoever asks for the lesson gets the functions of both in one module.
"""

import hashlib
import importlib
import inspect
import os
import re
import sys
import traceback
import types
import warnings
from dataclasses import replace
from functools import cache, lru_cache
from pathlib import Path

from solutions.checks import BadInput

from .loading import LOAD_WITHIN, Unloadable, alarm, answer_for_what_is_missing, part, stand_in, unloadable
from .numba_twins import CachedDispatch, compiled_twins, use_cache
from .scene import Scene, field_names

ROOT = Path(__file__).resolve().parent.parent
SOLUTIONS, SCENES = ROOT / "solutions", ROOT / "validate" / "scenes"
GIVEN = {"__init__", "checks", "support", "vectors"}           # support is a folder: geometry and records
SUPPORT = SOLUTIONS / "support"
LAW = "acceleration"  # the function of a scene that is compiled, with all that it calls; loops are in the lessons


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
    files = (path for path in Path(folder).glob("*.py") if path.stem not in GIVEN and path.is_file())
    return [path.stem for path in sorted(files, key=place)]


@lru_cache(maxsize=1)
def companions():
    """{name of the companion: its lesson}, such as {"support.friction": "friction"}."""
    names = [path.stem for path in SUPPORT.glob("*.py") if path.stem not in GIVEN]
    return {f"support.{name}": name for name in names if (SOLUTIONS / f"{name}.py").is_file()}


def both(lesson, companion):
    """A module with everything of a lesson and of its companion; where both have a name, it is the lesson's."""
    module = types.ModuleType(lesson.__name__)
    vars(module).update({**vars(companion), **vars(lesson)})
    return module


def given_modules():
    """Names of the modules beside the lessons, below `solutions`, that call no exercise: checks, support.arms …"""
    paths = sorted(path.relative_to(SOLUTIONS).with_suffix("") for path in SOLUTIONS.rglob("*.py"))
    dotted = (".".join(path.parts) for path in paths if path.parts[0] in GIVEN and path.stem != "__init__")
    return [name for name in dotted if name not in companions()]


def withheld(lesson, folder=SOLUTIONS):
    """Functions of a lesson that still wait for their body:
    in solutions/ none, but all in a copy of the workbook without worked answers.
    """
    text = (Path(folder) / f"{lesson}.py").read_text(encoding="utf-8", errors="replace")
    return set(re.findall(r'raise NotImplementedError\("Exercise [\d.]+: (\w+)"\)', text))


def scene_files():
    """{name: path} of every scene: one file each in a folder per lesson."""
    files = sorted(SCENES.glob("*/*.py"), key=lambda path: path.stem)
    return {path.stem: path for path in files if path.stem != "__init__"}


def scene_names():
    """The names of all scenes."""
    return list(scene_files())


def in_course_order(names):
    """Scenes in the order of the course."""
    lessons = lesson_names()
    return sorted(set(names), key=lambda name: (lessons.index(bind_scene(name).lesson), name))


def bind(lesson, of="solutions", compiled=False):
    """The module of one lesson, as saved just now.  Raises BadInput for an unknown subject or lesson."""
    folder = subject_folder(of)
    if not (folder / f"{lesson}.py").is_file():
        if lesson in lesson_names():
            why, remedy = f"there is no such file in {folder}", "put it back, or name the folder that has it"
            raise Unloadable(f"{folder.name}/{lesson}.py", why, remedy)
        known = ", ".join(lesson_names(folder)) or "none"
        raise BadInput(f"lesson {lesson!r}", f"not in {folder}", f"choose from: {known}")
    return module_set(of, compiled).lesson(lesson)


def bind_scene(scene, of="solutions", compiled=False):
    """The Scene of that name with the lesson functions of a subject.  Raises BadInput if it is unknown or broken."""
    if scene not in scene_names():
        raise BadInput(f"scene {scene!r}", "unknown", "`validate list` names them all")
    try:
        return module_set(of, compiled).scene(scene)
    except BadInput:
        raise
    except (Exception, SystemExit) as e:                             # a file in the making may do anything
        lines = [(f.filename, f.lineno) for f in traceback.extract_tb(e.__traceback__)]
        lines += [(e.filename, e.lineno)] if isinstance(e, SyntaxError) else []
        folders = SOLUTIONS, subject_folder(of), scene_files()[scene].parent
        places = [f"file {file!r}, line {line}," for file, line in lines if Path(file).parent in folders]
        why = (str(getattr(e, "msg", e)).splitlines() or [""])[0]
        raise BadInput((places or [f"scene {scene!r} of {str(of)!r}"])[-1], f"not loadable ({type(e).__name__}: {why})",
                       "correct that first") from None


def module_set(of="solutions", compiled=False):
    """The module set of a subject, as its files are now."""
    folder = subject_folder(of)
    if folder == SOLUTIONS and not compiled:
        return PLAIN
    return _module_set(folder, compiled, digest_of(folder))


def digest_of(folder):
    """Fingerprint of every file that a module set of this subject is made of, and of the compiler."""
    compiler = f"{numba_version()} {sys.version} {os.environ.get('NUMBA_BOUNDSCHECK', '')}"
    ours = Path(__file__), Path(__file__).with_name("numba_twins.py")
    return fingerprint({*SOLUTIONS.rglob("*.py"), *SCENES.glob("*/*.py"), *folder.glob("*.py"), *ours}, compiler)


def fingerprint(files, more=""):
    """Twelve digits that change with any of these files."""
    text = b"".join(str(path).encode() + path.read_bytes() for path in sorted(files) if path.is_file())
    return hashlib.sha256(text + more.encode()).hexdigest()[:12]


def numba_version():
    from importlib.metadata import PackageNotFoundError, version
    try:
        return version("numba")
    except PackageNotFoundError:
        return None


def can_compile():
    """Whether numba is installed here: it has no wheel for some machines, and the workbook works without it."""
    return numba_version() is not None


@lru_cache(maxsize=16)
def _module_set(folder, compiled, digest):
    if compiled and not can_compile():
        raise BadInput("numba", "not installed", "install it, or use --plain")
    return CompiledModules(folder, digest) if compiled else ModuleSet(folder, digest)


def record_of(module, name):
    """The SCENE of a scene's module, with its story.

    Raises BadInput when it is missing or belongs to another lesson.
    """
    scene = getattr(module, "SCENE", None)
    if not isinstance(scene, Scene):
        required = ", ".join(field_names(required=True))
        raise BadInput(f"scene {name!r}", "without a record",
                       f"end its file with SCENE = Scene(...), which needs {required}")
    folder = scene_files()[name].parent.name
    if scene.lesson != folder:
        raise BadInput(f"scene {name!r} of lesson {scene.lesson!r}", f"in the folder of {folder!r}",
                       "move the file, or correct the field 'lesson'")
    return replace(scene, story=report_text(module))


def report_text(thing):
    """Its docstring, without the remarks for authors of lessons."""
    text = (inspect.getdoc(thing) or "").removeprefix("Given.")
    return text.replace("*Source:*", "Source:").replace("*Left out:*", "Left out:").strip()


class PlainModules:
    """The packages as imported."""

    @cache  # noqa: B019    there is one PlainModules
    def lesson(self, name):
        module, companion = importlib.import_module(f"solutions.{name}"), f"support.{name}"
        return both(module, self.lesson(companion)) if companion in companions() else module

    def scene_module(self, name):
        return importlib.import_module(f"validate.scenes.{scene_files()[name].parent.name}.{name}")

    def scene(self, name):
        return record_of(self.scene_module(name), name)


PLAIN = PlainModules()


def _siblings(file):
    """Names of the lessons beside a subject's file that it imports."""
    named = re.findall(r"^from \.(\w+) import", file.read_text(encoding="utf-8", errors="replace"), re.M)
    return {name for name in named if name not in GIVEN and (file.parent / f"{name}.py").is_file()}


class ModuleSet:
    """Copies of the subject's lessons and of the scenes, under a package name of their own,
    that refer to each other.
    """

    def __init__(self, folder, digest, speed="plain"):
        self.name, self.folder, self.done = f"_{speed}_{digest}", folder, {}
        self.stuck, self.loading = {}, set()  # {lesson: its Unloadable}, lessons being loaded
        self.whole = {}                       # {lesson: it and its companion}
        paths = {"": [], ".solutions": [SOLUTIONS], ".subject": [folder], ".subject.support": [SUPPORT],
                 ".scenes": [SCENES]}
        for package, path in paths.items():
            module = sys.modules[self.name + package] = types.ModuleType(self.name + package)
            module.__path__ = [str(p) for p in path]
        for given in given_modules():                    # ours, even where the subject's folder has copies of them
            sys.modules[f"{self.name}.subject.{given}"] = importlib.import_module(f"solutions.{given}")

    def lesson(self, name):
        """A lesson of the subject, with its companion.

        Raises the same Unloadable every time when its file cannot be loaded.
        """
        if name not in self.stuck and ("subject", name) not in self.done:
            self._load_safely(name)
        if name in self.stuck:
            raise self.stuck[name].with_traceback(None)
        return self._with_companion("subject", name)

    def _load_safely(self, name):
        """Load a file that may hold anything.

        What is given in a sibling stands in for it where it cannot be loaded.
        """
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
        except BaseException as e:  # SystemExit, TooLong and classes of the student's own
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

    def scene_module(self, name):
        return self._load("scenes", name)

    def scene(self, name):
        return record_of(self.scene_module(name), name)

    def solution(self, name):
        """A lesson of the solutions, as lessons and scenes of this set see it."""
        return PLAIN.lesson(name)

    def _with_companion(self, package, name):
        """A lesson and its companion as one module; the lesson first, because the companion imports from it."""
        lesson = self._load(package, name)
        if f"support.{name}" not in companions():
            return lesson
        if name not in self.whole:
            self.whole[name] = both(lesson, self._load(package, f"support.{name}"))
        return self.whole[name]

    def _load(self, package, name):
        if (package, name) not in self.done:
            folder = f".{scene_files()[name].parent.name}" if package == "scenes" else ""
            module = importlib.import_module(f"{self.name}.{package}{folder}.{name}")
            self.done[package, name] = module
            self._finish(package, module)
        return self.done[package, name]

    def _finish(self, package, module):
        if package == "scenes":
            vars(module).update(self._redirected(package, module))
            if isinstance(record := vars(module).get("SCENE"), Scene):
                module.SCENE = replace(record, acceleration=vars(module).get(LAW))

    def _redirected(self, package, module):
        """{name: what it means in this set} for everything that module imported from a lesson.

        A scene means the subject's lessons, a lesson means the solutions'.  Classes are the same in all sets, or
        `except BadInput` would not recognise what a twin raises.
        """
        meant = {}
        for name, value in vars(module).items():
            home = value.__name__ if isinstance(value, types.ModuleType) else getattr(value, "__module__", None) or ""
            source, _, origin = home.removeprefix(f"{self.name}.").partition(".")  # origin: friction, or support.arms
            if source not in ("solutions", "subject"):
                continue
            if isinstance(value, type):
                meant[name] = getattr(PLAIN.lesson(origin), value.__name__) if source == "solutions" else value
            elif home != module.__name__ and isinstance(value, (types.ModuleType, types.FunctionType)):
                lesson = companions().get(origin, origin)
                of_subject = source == "subject" or (package == "scenes" and (self.folder / f"{lesson}.py").is_file())
                there = self.lesson(lesson) if of_subject else self.solution(origin)
                meant[name] = there if isinstance(value, types.ModuleType) else part(there, value.__name__)
        return meant


class CompiledModules(ModuleSet):
    """The same, compiled: every function of a lesson, and the law of a scene.

    A scene's run is plain and calls compiled lessons.
    """

    def __init__(self, folder, digest):
        super().__init__(folder, digest, "compiled")
        self.cache = use_cache(digest)

    def lesson(self, name):
        return self._with_companion("solutions", name) if self.folder == SOLUTIONS else super().lesson(name)

    def solution(self, name):
        return self._load("solutions", name)

    def _finish(self, package, module):
        if package != "scenes":
            vars(module).update(self._redirected(package, module))
            own = {name for name, f in vars(module).items()
                   if isinstance(f, types.FunctionType) and f.__module__ == module.__name__}
            vars(module).update(compiled_twins(module, own, vars(module), self.cache))
            return
        space = {**vars(module), **self._redirected(package, module)}           # what compiled functions see
        plain = vars(module_set(self.folder).scene_module(module.__name__.rpartition(".")[2]))
        lessons = {name: CachedDispatch(twin) for name, twin in self._redirected(package, module).items()
                   if hasattr(twin, "py_func")}
        space |= compiled_twins(module, _called_from(space, LAW, module.__name__), space, self.cache)
        run = types.FunctionType(plain["run"].__code__, {**plain, **lessons}, "run")
        record = replace(plain["SCENE"], run=run, acceleration=space.get(LAW))
        vars(module).update({**plain, "__name__": module.__name__, "SCENE": record})


def _called_from(space, root, home):
    """Names of the functions of module `home` that root reaches, itself included."""
    own = {name: f for name, f in space.items() if isinstance(f, types.FunctionType) and f.__module__ == home}
    reached, waiting = set(), [root] if root in own else []
    while waiting:
        name = waiting.pop()
        reached.add(name)
        waiting += [n for n in own[name].__code__.co_names if n in own and n not in reached]
    return reached
