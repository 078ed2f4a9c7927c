"""Lessons of a chosen subject, plain or compiled, and the scenes bound to them.

A *module set* is one consistent set of modules: the lessons of a subject (`solutions`, `lessons` or a folder) and the
given modules that call them.  The plain set of `solutions` is simply the imported packages.  Every other set is a fresh
copy of those files under a package name of its own.  In it, each function that came from `solutions` is replaced by the
subject's function or by its compiled twin.  Nothing is decorated, and the imported packages stay as they are.

A scene is imported once.  Its functions that call lessons take them as their first argument, `lessons`, a `Lessons`.

The *given modules* lie beside the lessons: checks, vectors, and the files of `solutions/support/`, which imports no
lesson, and `solutions/given/`, which calls exercises.  A given module that
imports a function of a lesson, or of a given module that does, belongs to the subject: a module set has its own copy of
it, which calls the subject's exercises.  All others are shared.  By a lesson, given code means the same as the
subject's own files do: the file beside them, or the worked lesson if that is what they import.

A lesson may have a *companion*, the given module of the same name.  It imports from its lesson, and never the other way
round.  A caller that asks for the lesson gets the functions of both in one module.
"""

import ast
import hashlib
import importlib
import inspect
import os
import re
import shutil
import sys
import traceback
import types
import uuid
import warnings
from dataclasses import replace
from difflib import get_close_matches
from functools import cache, cached_property, lru_cache
from pathlib import Path

from solutions.checks import BadInput

from ..scene import Scene, field_names
from .loading import (
    LOAD_WITHIN,
    Folders,
    Unloadable,
    alarm,
    answer_for_what_is_missing,
    part,
    stand_in,
    unloadable,
)
from .numba_twins import CACHE, CachedDispatch, CheckedFirst, compiled, compiled_twins, passed_over, use_cache

ROOT = Path(__file__).resolve().parents[2]
SOLUTIONS, SCENES = ROOT / "solutions", ROOT / "validate" / "scenes"
PACKAGES = "given", "support"                     # of given modules: those that call exercises, and the others
GIVEN = {"__init__", "checks", "vectors", *PACKAGES}
CHECK, RECORDS = "check_record", "support.records"     # the check of a record, and its home
MAKE = "make_"           # begins the names of functions that make records: they stay plain, and convert what they get
COMPOSE = ".given.compose"   # ends the name of the module that makes loops of Models: its functions stay plain, too


def subject_folder(of):
    """Return the folder that a subject's name means.  Raises BadInput when there is none."""
    folder = {"solutions": SOLUTIONS, "lessons": ROOT / "lessons"}.get(str(of), Path(of).expanduser())
    if not folder.is_dir():
        raise BadInput(f"subject {of!r}", "not a folder", "name solutions, lessons or a folder of lesson files")
    return folder.resolve()


def lesson_names(folder=SOLUTIONS):
    """Return the lessons in a folder, in the order of the course: by the number in the first line of the text."""
    files = [path for path in Path(folder).glob("*.py") if path.stem not in GIVEN and path.is_file()]
    return [path.stem for path in sorted(files, key=lambda path: (lesson_number(path) or 99, path.stem))]


def lessons_by_number():
    """Return {number: name} of the workbook's lessons, in the order of the course."""
    return {lesson_number(SOLUTIONS / f"{name}.py"): name for name in lesson_names()}


def lesson_number(path):
    """Return the number in the first line of a lesson's text, or None."""
    found = re.match(r'"""Lesson (\d+)', Path(path).read_text(encoding="utf-8", errors="replace"))
    return int(found[1]) if found else None


@lru_cache(maxsize=1)
def companions():
    """Return {name of the companion: its lesson}, such as {"given.friction": "friction"}."""
    lessons = {f"given.{name}": name for name in lesson_names()}
    return {name: lessons[name] for name in given_modules() if name in lessons}


def both(lesson, companion):
    """Return a module with everything of a lesson and of its companion; where both have a name, it is the lesson's."""
    module = types.ModuleType(lesson.__name__)
    vars(module).update({**vars(companion), **vars(lesson)})
    return module


@lru_cache(maxsize=1)
def given_modules():
    """Return names of the modules beside the lessons, below `solutions`: checks, given.bodies, support.arms …"""
    paths = sorted(path.relative_to(SOLUTIONS).with_suffix("") for path in SOLUTIONS.rglob("*.py"))
    return tuple(".".join(path.parts) for path in paths if path.parts[0] in GIVEN and path.stem != "__init__")


def original(name):
    """Return a given module as it is written."""
    return importlib.import_module(f"solutions.{name}")


def withheld(lesson, folder=SOLUTIONS):
    """Return the functions of a lesson that still wait for their body.

    In solutions/ there is none, but a copy of the workbook without worked answers has all of them.
    """
    text = (Path(folder) / f"{lesson}.py").read_text(encoding="utf-8", errors="replace")
    return set(re.findall(r'raise NotImplementedError\("Exercise [\d.]+: (\w+)"\)', text))


def scene_files():
    """Return {name: path} of every scene: one file each in a folder per lesson.

    A name that begins with an underscore is no scene: `_common.py` has what the scenes of a lesson share.
    """
    files = sorted(SCENES.glob("*/*.py"), key=lambda path: path.stem)
    return {path.stem: path for path in files if not path.stem.startswith("_")}


def scene_names():
    """Return the names of all scenes."""
    return list(scene_files())


class Lessons:
    """The lessons of a subject: `lessons.friction.event_step` is its function, plain or compiled.

    A lesson is loaded when it is first named.
    """

    def __init__(self, lesson):
        self._lesson = lesson                                            # (name) → module

    def __getattr__(self, name):
        if name not in lesson_names():
            raise AttributeError(f"there is no lesson {name!r}")
        module = self._lesson(name)
        setattr(self, name, module)
        return module


def written_scene(name):
    """Return the Scene of that name as it is written, without lessons."""
    return record_of(importlib.import_module(f"validate.scenes.{scene_files()[name].parent.name}.{name}"), name)


@cache
def called_by_scene(name):
    """Return {(lesson, function)} that a scene calls of lessons, in its file and in its `run`, if that is elsewhere."""
    file, run = scene_files()[name], written_scene(name).run
    texts = [file.read_text(encoding="utf-8")]
    if inspect.getfile(run) != str(file):
        texts.append(inspect.getsource(run))
    return {call for text in texts for call in called_of_lessons(ast.parse(text))}


def load_lessons_of(name, scene, lessons):
    """Load what a scene calls.  Raises Unloadable where a lesson cannot be loaded, or lacks a function.

    A step that is lacking fails later, as one that is not written: the others can run.
    """
    steps = {(r.who.lesson, r.who.function) for r in scene.our_runners}
    for lesson, _ in steps:
        getattr(lessons, lesson)
    for lesson, function in called_by_scene(name) - steps:
        part(getattr(lessons, lesson), function)


def called_of_lessons(tree):
    """Return {(lesson, function)} of what source calls of `lessons`.

    That is lessons.friction.event_step, and friction.event_step if the same function sets  friction = lessons.friction.
    """
    found = set()
    for function in tree.body:
        nodes = [node for node in ast.walk(function) if isinstance(node, ast.Attribute | ast.Assign)]
        meant = _names_of_lessons(nodes)
        for node in nodes:
            if isinstance(node, ast.Attribute):
                lesson = meant.get(node.value.id) if isinstance(node.value, ast.Name) else _lesson_named(node.value)
                found |= {(lesson, node.attr)} if lesson else set()
    return found


def _names_of_lessons(nodes):
    """Return {name: lesson} of the names that the statements of a function give to lessons."""
    found = {}
    for node in nodes:
        if isinstance(node, ast.Assign):
            names, values = (side.elts if isinstance(side, ast.Tuple) else [side]
                             for side in (node.targets[0], node.value))
            found |= {name.id: lesson for name, value in zip(names, values) if (lesson := _lesson_named(value))}
    return found


def _lesson_named(node):
    """Return the lesson that source names by lessons.<lesson>; None for anything else."""
    named = isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "lessons"
    return node.attr if named else None


def in_course_order(names):
    """Return scenes in the order of the course."""
    lessons = lesson_names()
    return sorted(set(names), key=lambda name: (lessons.index(bind_scene(name).lesson), name))


def bind(lesson, of="solutions", compiled=False):
    """Return the module of one lesson, as saved just now.  Raises BadInput for an unknown subject or lesson."""
    folder = subject_folder(of)
    if not (folder / f"{lesson}.py").is_file():
        if lesson in lesson_names():
            why, remedy = f"there is no such file in {folder}", "put it back, or name the folder that has it"
            raise Unloadable(f"{folder.name}/{lesson}.py", why, remedy)
        known = ", ".join(lesson_names(folder)) or "none"
        raise BadInput(f"lesson {lesson!r}", f"not in {folder}", f"choose from: {known}")
    return module_set(of, compiled).lesson(lesson)


def bind_scene(scene, of="solutions", compiled=False):
    """Return the Scene of that name with its `lessons` and its `law`.

    Raises BadInput if it or a lesson of it is broken.
    """
    if scene not in scene_names():
        near = "".join(f"did you mean {name}? " for name in get_close_matches(str(scene), scene_names(), 1))
        raise BadInput(f"scene {scene!r}", "unknown", f"{near}`validate list` names them all")
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
    """Return the module set of a subject, as its files are now."""
    folder = subject_folder(of)
    if folder == SOLUTIONS and not compiled:
        return PLAIN
    return _module_set(folder, compiled, digest_of(folder))


def digest_of(folder):
    """Return a fingerprint of every file of which a module set of this subject consists, and of the compiler."""
    compiler = f"{numba_version()} {sys.version} {os.environ.get('NUMBA_BOUNDSCHECK', '')}"
    ours = Path(__file__), *map(Path(__file__).with_name, ("numba_twins.py", "addresses.py", "linking.py"))
    return fingerprint({*SOLUTIONS.rglob("*.py"), *SCENES.rglob("*.py"), *folder.glob("*.py"), *ours}, compiler)


def fingerprint(files, more=""):
    """Return twelve digits that change with any of these files, and not with the folder of the repository."""
    text = b"".join(name_of(path).encode() + path.read_bytes() for path in sorted(files) if path.is_file())
    return hashlib.sha256(text + more.encode()).hexdigest()[:12]


def name_of(path):
    """Return the path of a file inside the repository, or its full path outside of it."""
    return path.relative_to(ROOT).as_posix() if path.is_relative_to(ROOT) else str(path)


def numba_version():
    from importlib.metadata import PackageNotFoundError, version
    try:
        return version("numba")
    except PackageNotFoundError:
        return None


def can_compile():
    """Return whether numba is installed here: it has no wheel for some machines, and the workbook works without it."""
    return numba_version() is not None


@lru_cache(maxsize=16)
def _module_set(folder, compiled, digest):
    if compiled and not can_compile():
        raise BadInput("numba", "not installed", "install it, or use --plain")
    return CompiledModules(folder, digest) if compiled else ModuleSet(folder, digest)


def compiled_twice(of="solutions"):
    """Yield two compiled module sets of a subject, one after the other.

    The first finds an empty cache, and the second what the first has left there.
    """
    digest = f"anew-{uuid.uuid4().hex[:12]}"
    try:
        for _ in range(2):
            forget_modules(f"_compiled_{digest}")
            yield CompiledModules(subject_folder(of), digest)
    finally:
        forget_modules(f"_compiled_{digest}")
        shutil.rmtree(CACHE / digest, ignore_errors=True)


def forget_modules(package):
    """Forget that a package and what lies below it were imported."""
    for name in [name for name in sys.modules if name == package or name.startswith(f"{package}.")]:
        del sys.modules[name]


def record_of(module, name):
    """Return the SCENE of a scene's module, with its story.

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
    """Return its docstring, without the remarks for authors of lessons."""
    text = (inspect.getdoc(thing) or "").removeprefix("Given.")
    return text.replace("*Source:*", "Source:").replace("*Left out:*", "Left out:").strip()


class Binding:
    """What all module sets do with scenes."""

    def __init__(self, lesson):
        self.lessons, self.scenes = Lessons(lesson), {}

    def scene(self, name):
        """Return a scene with the lessons of this set."""
        if name not in self.scenes:
            scene = written_scene(name)
            load_lessons_of(name, scene, self.lessons)
            self.scenes[name] = replace(scene, lessons=self.lessons, law=self._law(name, scene))
        return self.scenes[name]

    def _law(self, name, scene):
        return scene.acceleration and scene.acceleration(self.lessons)


class PlainModules(Binding):
    """The packages as imported."""

    def __init__(self):
        super().__init__(self.lesson)

    @cache  # noqa: B019    there is one PlainModules
    def lesson(self, name):
        module, companion = importlib.import_module(f"solutions.{name}"), f"given.{name}"
        return both(module, importlib.import_module(f"solutions.{companion}")) if companion in companions() else module


PLAIN = PlainModules()


def _siblings(file):
    """Return names of the lessons beside a subject's file that it imports."""
    named = re.findall(r"^from \.(\w+) import", file.read_text(encoding="utf-8", errors="replace"), re.M)
    return {name for name in named if name not in GIVEN and (file.parent / f"{name}.py").is_file()}


def _meant_by_given_code(folder):
    """Return the lessons that given code takes from a subject: all that its files do not take from the worked ones."""
    texts = [file.read_text(encoding="utf-8", errors="replace") for file in folder.glob("*.py") if file.is_file()]
    named = {name for text in texts for name in re.findall(r"^from solutions\.(\w+) import", text, re.M)}
    here = [name for name in lesson_names() if (folder / f"{name}.py").is_file()]
    return {name for name in here if name not in named or withheld(name)}


class ModuleSet(Binding):
    """Copies of the subject's lessons, and of the given modules that call their exercises, under a package name of
    their own, that refer to each other.
    """

    def __init__(self, folder, digest, speed="plain"):
        super().__init__(self.lesson_of_scenes)
        self.name, self.folder, self.done = f"_{speed}_{digest}", folder, {}
        self.stuck, self.loading = {}, set()  # {lesson: its Unloadable}, lessons being loaded
        self.whole = {}                       # {lesson: it and its companion}
        paths = {"": [], ".solutions": [SOLUTIONS], ".subject": [folder], ".subject.support": [], ".subject.given": []}
        for package, path in paths.items():
            module = sys.modules[self.name + package] = types.ModuleType(self.name + package)
            module.__path__ = Folders(map(str, path))
        for given in given_modules():                    # ours, even where the subject's folder has copies of them
            sys.modules[f"{self.name}.subject.{given}"] = original(given)

    # ------------------------------------------------------------------------------------------ lessons

    def lesson(self, name):
        """Return a lesson as a person or a scene calls it."""
        return self.inner_lesson(name)

    def inner_lesson(self, name):
        """Return a lesson of the subject, with its companion, as the other modules of this set call it.

        Raises the same Unloadable every time when its file cannot be loaded.
        """
        return self._with_companion(name, self._own_lesson(name))

    def _with_companion(self, name, lesson):
        companion = f"given.{name}"
        if companion not in companions():
            return lesson
        if name not in self.whole:
            self.whole[name] = both(lesson, self.given(companion))
        return self.whole[name]

    def _own_lesson(self, name):
        """Return a lesson of the subject, without its companion."""
        if name not in self.stuck and ("subject", name) not in self.done:
            self._load_safely(name)
        if name in self.stuck:
            raise self.stuck[name].with_traceback(None)
        return self.done["subject", name]

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
                module = importlib.import_module(f"{self.name}.subject.{name}")
                answer_for_what_is_missing(module)
            self.done["subject", name] = module
            self._finish("subject", module)
        except KeyboardInterrupt:
            raise
        except BaseException as e:  # SystemExit, TooLong and classes of the student's own
            self.stuck[name] = unloadable(file, e)
        finally:
            self.loading.discard(name)

    def _make_sure_of(self, sibling):
        try:
            self._own_lesson(sibling)
        except Unloadable as e:
            known = sibling in lesson_names()
            given, exercises = (vars(PLAIN.lesson(sibling)), withheld(sibling)) if known else ({}, ())
            sys.modules[f"{self.name}.subject.{sibling}"] = stand_in(sibling, given, exercises, str(e))

    def solution(self, name):
        """Return a lesson of the solutions or a shared given module, as lessons and scenes of this set see it."""
        return original(name) if name in given_modules() else PLAIN.lesson(name)

    # ------------------------------------------------------------------------------------------ given modules

    def given(self, name):
        """Return a given module as this set sees it: shared, or a copy that calls the subject's exercises."""
        if name not in self.copied:
            return self.solution(name)
        if ("subject", name) not in self.done:
            copy = types.ModuleType(f"{self.name}.subject.{name}")
            self.done["subject", name] = sys.modules[copy.__name__] = copy
            vars(copy).update({**vars(original(name)), "__name__": copy.__name__})
            self._fill(copy, name)
        return self.done["subject", name]

    def _fill(self, copy, name):
        """Give the copy of a module functions of its own, which call what this set means."""
        here = original(name).__name__
        for key, value in list(vars(copy).items()):
            if isinstance(value, types.FunctionType) and value.__module__ == here:
                vars(copy)[key] = types.FunctionType(value.__code__, vars(copy), value.__name__, value.__defaults__)
            elif isinstance(value, types.FunctionType | types.ModuleType) and self._home(value)[0]:
                there = self._as_given_code_means(self._home(value)[1], name)
                vars(copy)[key] = there if isinstance(value, types.ModuleType) else getattr(there, value.__name__)

    def _as_given_code_means(self, origin, by):
        """Return the module that the given module `by` means by that name of a lesson or of a given module."""
        if origin in given_modules():
            return self.given(origin)
        if not self._is_subjects(origin, by):
            return self.solution(origin)
        if origin not in self.loading:
            self._make_sure_of(origin)
        return sys.modules[f"{self.name}.subject.{origin}"]

    def _is_subjects(self, lesson, by):
        """Return whether a given module means the subject's lesson; a companion does, where there is one."""
        of_its_own = companions().get(by) == lesson and (self.folder / f"{lesson}.py").is_file()
        return of_its_own or lesson in self.meant

    @cached_property
    def meant(self):
        return _meant_by_given_code(self.folder)

    @cached_property
    def copied(self):
        """Return the names of the given modules that call the subject's exercises, directly or through each other."""
        imported = {name: {self._home(value)[1] for value in vars(original(name)).values()
                           if isinstance(value, types.FunctionType | types.ModuleType)} for name in given_modules()}
        found, before = set(), None
        while found != before:
            before = found
            found = {name for name, origins in imported.items()
                     if any(origin in before or self._is_subjects(origin, name) for origin in origins)}
        return found

    # ------------------------------------------------------------------------------------------ scenes

    def lesson_of_scenes(self, name):
        """Return a lesson as scenes call it: the subject's; where it has none, the worked one."""
        return self.lesson(name) if (self.folder / f"{name}.py").is_file() else self._worked(name)

    def _worked(self, name):
        return self._with_companion(name, original(name))

    # ------------------------------------------------------------------------------------------ what is imported

    def _load(self, package, name):
        if (package, name) not in self.done:
            self.done[package, name] = module = importlib.import_module(f"{self.name}.{package}.{name}")
            self._finish(package, module)
        return self.done[package, name]

    def _finish(self, package, module):
        """Redirect what a loaded module has imported; the copies of given modules are made only now."""
        vars(module).update(self._redirected(package, module))

    def _home(self, value):
        """Return (package, name below it) of the module that a thing comes from: ("solutions", "friction"), ("subject",
        "given.bodies"); twice an empty text for what is neither of the solutions nor of this subject.
        """
        home = value.__name__ if isinstance(value, types.ModuleType) else getattr(value, "__module__", None) or ""
        source, _, origin = home.removeprefix(f"{self.name}.").partition(".")
        return (source, origin) if source in ("solutions", "subject") else ("", "")

    def _stays(self, origin):
        """Return whether an object imported from there is already the right one, as from a lesson beside the file."""
        return origin not in self.copied

    def _redirected(self, package, module):
        """Return {name: what it means in this set} for everything that module imported from a lesson or a given module.

        Classes are the same in all sets, or `except BadInput` would not recognise what a twin raises.
        """
        meant, own = {}, self._home(module)
        for name, value in vars(module).items():
            source, origin = home = self._home(value)
            if not source or self._stays(origin):
                continue
            if isinstance(value, type):
                meant[name] = getattr(PLAIN.lesson(origin), value.__name__) if source == "solutions" else value
            elif home != own and isinstance(value, (types.ModuleType, types.FunctionType)):
                there = self._meant(package, source, origin)
                meant[name] = there if isinstance(value, types.ModuleType) else part(there, value.__name__)
        return meant

    def _meant(self, package, source, origin):
        """Return the module that a lesson means by one of the solutions or of the subject."""
        if origin in given_modules():
            return self.given(origin)
        return self.inner_lesson(origin) if source == "subject" else self.solution(origin)


class CompiledModules(ModuleSet):
    """The same, compiled: every function of a lesson, and the law of a scene.

    A scene's run is plain and calls compiled lessons.  A caller that asks for a lesson gets the plain functions that
    make records, and compiled loops that check their record in plain Python first: a check that is compiled takes
    seconds for every kind of record, and in plain Python microseconds.
    """

    def __init__(self, folder, digest):
        from .addresses import pass_by_address
        super().__init__(folder, digest, "compiled")
        self.cache, self.digest, self.outside = use_cache(digest), digest, {}
        pass_by_address(original("given.rows").Composed)

    def lesson(self, name):
        """Return a lesson with plain make_* and with loops that check their record first."""
        return self._outside(name, self.inner_lesson(name), vars(module_set(self.folder).lesson(name)))

    def _outside(self, name, inside, plain):
        if name not in self.outside:
            self.outside[name] = types.ModuleType(inside.__name__)
            vars(self.outside[name]).update(
                {key: self._from_outside(key, value, plain.get(key)) for key, value in vars(inside).items()})
        return self.outside[name]

    def _from_outside(self, key, value, plain):
        """Return what a name of a compiled lesson means outside of compiled code."""
        if not hasattr(value, "py_func"):
            return value
        if (key.startswith(MAKE) or value.py_func.__module__.endswith(COMPOSE)) and plain is not None:
            return plain
        check = checks_of(value.py_func.__code__.co_filename, self.digest).get(value.py_func.__name__)
        return CheckedFirst(value, check) if check else CachedDispatch(value)

    def _own_lesson(self, name):
        return self.solution(name) if self.folder == SOLUTIONS else super()._own_lesson(name)

    def solution(self, name):
        return self._load("solutions", name)

    @cached_property
    def copied(self):
        return set() if self.folder == SOLUTIONS else super().copied

    def _fill(self, copy, name):
        super()._fill(copy, name)
        self._compile("subject", copy)

    def _compile(self, package, module):
        """Compile the functions of a module; each package has a cache of its own, because it may have the same file."""
        own = {name for name, f in vars(module).items()
               if isinstance(f, types.FunctionType) and f.__module__ == module.__name__}
        space = {**vars(module), CHECK: passed_over} if module.__name__.endswith(f".{RECORDS}") else vars(module)
        cache = os.path.join(self.cache, package)
        vars(module).update(compiled_twins(module, own, space, cache))

    def _stays(self, origin):
        return False

    def _meant(self, package, source, origin):
        return self.solution(origin) if package == "solutions" else super()._meant(package, source, origin)

    def _finish(self, package, module):
        super()._finish(package, module)
        self._compile(package, module)

    def _worked(self, name):
        return self._outside(name, self._with_companion(name, self.solution(name)), vars(PLAIN.lesson(name)))

    def _law(self, name, scene):
        """Return the law of a scene: a lesson's or a given one is shared with others.

        One of its own is compiled here.
        """
        law = scene.acceleration and scene.acceleration(Lessons(self.lesson_inside))
        if law is None:
            return None
        if hasattr(law, "py_func"):
            return CachedDispatch(law)
        source, origin = self._home(law)
        if source == "solutions":
            return CachedDispatch(getattr(self.given(origin), law.__name__))
        return CachedDispatch(compiled(law, f"{self.name}.scenes.{name}", os.path.join(self.cache, "scenes")))

    def lesson_inside(self, name):
        """Return a lesson as compiled functions call it."""
        if (self.folder / f"{name}.py").is_file():
            return self.inner_lesson(name)
        return self._with_companion(name, self.solution(name))

    def advance(self, loop, names):
        """Return the function (t, state, dt, steps) → PileState of a Loop whose parts have these names."""
        from .addresses import functions_of_loop
        lesson = self.lesson_inside("simulator")
        functions = functions_of_loop(lesson, loop, [getattr(lesson, name) for name in names])
        advance_parts = self.lesson_of_scenes("simulator").advance_parts
        return lambda t, state, dt, steps: advance_parts(*functions, t, state, dt, steps, loop.p)


@cache
def checks_of(file, digest):
    """Return {function: the check of its record, as a plain function of the same arguments} of a file's functions."""
    found, space = {}, {CHECK: vars(original(RECORDS))[CHECK]}
    for function in ast.parse(Path(file).read_text(encoding="utf-8", errors="replace")).body:
        for line in function.body if isinstance(function, ast.FunctionDef) else ():
            if isinstance(line, ast.Expr) and isinstance(line.value, ast.Call) and \
                    isinstance(line.value.func, ast.Name) and line.value.func.id == CHECK:
                check = ast.fix_missing_locations(ast.Expression(ast.Lambda(function.args, line.value)))
                found[function.name] = eval(compile(check, file, "eval"), space)
    return found
