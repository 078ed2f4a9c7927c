"""Load any lesson or scene, plain or compiled, with the lesson functions of a chosen subject.

A *module set* is one consistent set of modules: the lessons of a subject (`solutions`, `lessons` or a folder) and the
scenes that use them.  The plain set of `solutions` is simply the imported packages.  Every other set is a fresh copy
of those files under a package name of its own.  In it, each function that came from `solutions` is replaced by the
subject's function or by its compiled twin.  Nothing is decorated, and the imported packages stay as they are.

The *given modules* lie beside the lessons: checks, vectors, and the files of `solutions/support/`.  A given module that
imports a function of a lesson, or of a given module that does, belongs to the subject: a module set has its own copy of
it, which calls the subject's exercises.  All others are shared.  By a lesson, given code means the same as the
subject's own files do: the file beside them, or the worked lesson if that is what they import.

A lesson may have a *companion*, the given module of the same name.  It imports from its lesson, and never the other way
round.  Whoever asks for the lesson gets the functions of both in one module.
"""

import ast
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
from functools import cache, cached_property, lru_cache
from pathlib import Path

from solutions.checks import BadInput

from .loading import LOAD_WITHIN, Unloadable, alarm, answer_for_what_is_missing, part, stand_in, unloadable
from .numba_twins import CheckedFirst, cached_dispatch, compiled_twins, passed_over, use_cache
from .scene import Scene, field_names

ROOT = Path(__file__).resolve().parent.parent
SOLUTIONS, SCENES = ROOT / "solutions", ROOT / "validate" / "scenes"
GIVEN = {"__init__", "checks", "support", "vectors"}           # support is a folder: geometry and records
SUPPORT = SOLUTIONS / "support"
ORIGINALS = "solutions"  # the package of the given modules that module sets share or copy
CHECK, RECORDS = "check_record", "support.records"     # the check of a record, and its home
MAKE = "make_"           # begins the names of functions that make records: they stay plain, and convert what they get
LAW = "acceleration"  # the function of a scene that is compiled, with all that it calls; loops are in the lessons


def subject_folder(of):
    """The folder that a subject's name means.  Raises BadInput when there is none."""
    folder = {"solutions": SOLUTIONS, "lessons": ROOT / "lessons"}.get(str(of), Path(of).expanduser())
    if not folder.is_dir():
        raise BadInput(f"subject {of!r}", "not a folder", "name solutions, lessons or a folder of lesson files")
    return folder.resolve()


def lesson_names(folder=SOLUTIONS):
    """The lessons in a folder, in the order of the course: by the number in the first line of the text."""
    files = [path for path in Path(folder).glob("*.py") if path.stem not in GIVEN and path.is_file()]
    return [path.stem for path in sorted(files, key=lambda path: (lesson_number(path) or 99, path.stem))]


def lessons_by_number():
    """{number: name} of the workbook's lessons, in the order of the course."""
    return {lesson_number(SOLUTIONS / f"{name}.py"): name for name in lesson_names()}


def lesson_number(path):
    """The number in the first line of a lesson's text, or None."""
    found = re.match(r'"""Lesson (\d+)', Path(path).read_text(encoding="utf-8", errors="replace"))
    return int(found[1]) if found else None


@lru_cache(maxsize=1)
def companions():
    """{name of the companion: its lesson}, such as {"support.friction": "friction"}."""
    lessons = {f"support.{name}": name for name in lesson_names()}
    return {name: lessons[name] for name in given_modules() if name in lessons}


def both(lesson, companion):
    """A module with everything of a lesson and of its companion; where both have a name, it is the lesson's."""
    module = types.ModuleType(lesson.__name__)
    vars(module).update({**vars(companion), **vars(lesson)})
    return module


@lru_cache(maxsize=1)
def given_modules():
    """Names of the modules beside the lessons, below `solutions`: checks, support.arms, support.bodies …"""
    paths = sorted(path.relative_to(SOLUTIONS).with_suffix("") for path in SOLUTIONS.rglob("*.py"))
    return tuple(".".join(path.parts) for path in paths if path.parts[0] in GIVEN and path.stem != "__init__")


def original(name):
    """A given module as it is written."""
    return importlib.import_module(f"{ORIGINALS}.{name}")


def withheld(lesson, folder=SOLUTIONS):
    """Functions of a lesson that still wait for their body:
    in solutions/ none, but all in a copy of the workbook without worked answers.
    """
    text = (Path(folder) / f"{lesson}.py").read_text(encoding="utf-8", errors="replace")
    return set(re.findall(r'raise NotImplementedError\("Exercise [\d.]+: (\w+)"\)', text))


def scene_files():
    """{name: path} of every scene: one file each in a folder per lesson.

    A name that begins with an underscore is no scene: `_common.py` has what the scenes of a lesson share.
    """
    files = sorted(SCENES.glob("*/*.py"), key=lambda path: path.stem)
    return {path.stem: path for path in files if not path.stem.startswith("_")}


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
    return fingerprint({*SOLUTIONS.rglob("*.py"), *SCENES.rglob("*.py"), *folder.glob("*.py"), *ours}, compiler)


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
        return both(module, importlib.import_module(f"solutions.{companion}")) if companion in companions() else module

    def scene_module(self, name):
        return importlib.import_module(f"validate.scenes.{scene_files()[name].parent.name}.{name}")

    def scene(self, name):
        return record_of(self.scene_module(name), name)


PLAIN = PlainModules()


def _siblings(file):
    """Names of the lessons beside a subject's file that it imports."""
    named = re.findall(r"^from \.(\w+) import", file.read_text(encoding="utf-8", errors="replace"), re.M)
    return {name for name in named if name not in GIVEN and (file.parent / f"{name}.py").is_file()}


def _meant_by_given_code(folder):
    """The lessons that given code takes from a subject: all that its own files do not take from the worked ones."""
    texts = [file.read_text(encoding="utf-8", errors="replace") for file in folder.glob("*.py") if file.is_file()]
    named = {name for text in texts for name in re.findall(r"^from solutions\.(\w+) import", text, re.M)}
    here = [name for name in lesson_names() if (folder / f"{name}.py").is_file()]
    return {name for name in here if name not in named or withheld(name)}


class ModuleSet:
    """Copies of the subject's lessons, of the given modules that call their exercises, and of the scenes, under a
    package name of their own, that refer to each other.
    """

    def __init__(self, folder, digest, speed="plain"):
        self.name, self.folder, self.done = f"_{speed}_{digest}", folder, {}
        self.stuck, self.loading = {}, set()  # {lesson: its Unloadable}, lessons being loaded
        self.whole = {}                       # {lesson: it and its companion}
        paths = {"": [], ".solutions": [SOLUTIONS], ".subject": [folder], ".subject.support": [], ".scenes": [SCENES]}
        for package, path in paths.items():
            module = sys.modules[self.name + package] = types.ModuleType(self.name + package)
            module.__path__ = [str(p) for p in path]
        for given in given_modules():                    # ours, even where the subject's folder has copies of them
            sys.modules[f"{self.name}.subject.{given}"] = original(given)

    # ------------------------------------------------------------------------------------------ lessons

    def lesson(self, name):
        """A lesson as a person or a scene calls it."""
        return self.inner_lesson(name)

    def inner_lesson(self, name):
        """A lesson of the subject, with its companion, as the other modules of this set call it.

        Raises the same Unloadable every time when its file cannot be loaded.
        """
        lesson, companion = self._own_lesson(name), f"support.{name}"
        if companion not in companions():
            return lesson
        if name not in self.whole:
            self.whole[name] = both(lesson, self.given(companion))
        return self.whole[name]

    def _own_lesson(self, name):
        """A lesson of the subject, without its companion."""
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
        """A lesson of the solutions or a shared given module, as lessons and scenes of this set see it."""
        return original(name) if name in given_modules() else PLAIN.lesson(name)

    # ------------------------------------------------------------------------------------------ given modules

    def given(self, name):
        """A given module as this set sees it: shared, or a copy that calls the subject's exercises."""
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
        """The module that the given module `by` means by that name of a lesson or of a given module."""
        if origin in given_modules():
            return self.given(origin)
        if not self._is_subjects(origin, by):
            return self.solution(origin)
        if origin not in self.loading:
            self._make_sure_of(origin)
        return sys.modules[f"{self.name}.subject.{origin}"]

    def _is_subjects(self, lesson, by):
        """Whether a given module means the subject's lesson; a companion does, where there is one."""
        of_its_own = companions().get(by) == lesson and (self.folder / f"{lesson}.py").is_file()
        return of_its_own or lesson in self.meant

    @cached_property
    def meant(self):
        return _meant_by_given_code(self.folder)

    @cached_property
    def copied(self):
        """Names of the given modules that call the subject's exercises, directly or through each other."""
        imported = {name: {self._home(value)[1] for value in vars(original(name)).values()
                           if isinstance(value, types.FunctionType | types.ModuleType)} for name in given_modules()}
        found, before = set(), None
        while found != before:
            before = found
            found = {name for name, origins in imported.items()
                     if any(origin in before or self._is_subjects(origin, name) for origin in origins)}
        return found

    # ------------------------------------------------------------------------------------------ scenes

    def scene_module(self, name):
        return self._load("scenes", name)

    def scene(self, name):
        return record_of(self.scene_module(name), name)

    def _load(self, package, name):
        if (package, name) not in self.done:
            folder = f".{scene_files()[name].parent.name}" if package == "scenes" else ""
            module = importlib.import_module(f"{self.name}.{package}{folder}.{name}")
            self.done[package, name] = module
            self._finish(package, module)
        return self.done[package, name]

    def _finish(self, package, module):
        """Redirect what a loaded module has imported; the copies of given modules are made only now."""
        vars(module).update(self._redirected(package, module))
        if package == "scenes" and isinstance(record := vars(module).get("SCENE"), Scene):
            module.SCENE = replace(record, acceleration=vars(module).get(LAW))

    def _home(self, value):
        """(package, name below it) of the module that a thing comes from: ("solutions", "friction"), ("subject",
        "support.bodies"); twice an empty text for what is neither of the solutions nor of this subject.
        """
        home = value.__name__ if isinstance(value, types.ModuleType) else getattr(value, "__module__", None) or ""
        source, _, origin = home.removeprefix(f"{self.name}.").partition(".")
        source = "solutions" if source == ORIGINALS else source
        return (source, origin) if source in ("solutions", "subject") else ("", "")

    def _stays(self, package, origin):
        """Whether something imported from there is what it should be: what a subject's file takes from a lesson is."""
        return package == "subject" and origin not in self.copied

    def _redirected(self, package, module):
        """{name: what it means in this set} for everything that module imported from a lesson or a given module.

        A scene means the subject's lessons; a lesson means what it imports.  Classes are the same in all sets, or
        `except BadInput` would not recognise what a twin raises.
        """
        meant, own = {}, self._home(module)
        for name, value in vars(module).items():
            source, origin = home = self._home(value)
            if not source or self._stays(package, origin):
                continue
            if isinstance(value, type):
                meant[name] = getattr(PLAIN.lesson(origin), value.__name__) if source == "solutions" else value
            elif home != own and isinstance(value, (types.ModuleType, types.FunctionType)):
                there = self._meant(package, source, origin)
                meant[name] = there if isinstance(value, types.ModuleType) else part(there, value.__name__)
        return meant

    def _meant(self, package, source, origin):
        """The module that a lesson or a scene means by one of the solutions or of the subject."""
        lesson = companions().get(origin, origin)
        if package == "scenes" and lesson not in given_modules() and (self.folder / f"{lesson}.py").is_file():
            return self.inner_lesson(lesson)
        if origin in given_modules():
            return self.given(origin)
        return self.inner_lesson(origin) if source == "subject" else self.solution(origin)


class CompiledModules(ModuleSet):
    """The same, compiled: every function of a lesson, and the law of a scene.

    A scene's run is plain and calls compiled lessons.  Whoever asks for a lesson gets the plain functions that make
    records, and compiled loops that check their record in plain Python first: a check that is compiled takes seconds
    for every kind of record, and in plain Python microseconds.
    """

    def __init__(self, folder, digest):
        super().__init__(folder, digest, "compiled")
        self.cache, self.digest, self.outside = use_cache(digest), digest, {}

    def lesson(self, name):
        """A lesson with plain make_* and with loops that check their record first."""
        if name not in self.outside:
            inside = self.inner_lesson(name)
            plain = vars(module_set(self.folder).lesson(name))
            self.outside[name] = types.ModuleType(inside.__name__)
            vars(self.outside[name]).update(
                {key: self._from_outside(key, value, plain.get(key)) for key, value in vars(inside).items()})
        return self.outside[name]

    def _from_outside(self, key, value, plain):
        """What a name of a compiled lesson means to whoever calls it from outside of compiled code."""
        if not hasattr(value, "py_func"):
            return value
        if key.startswith(MAKE) and plain is not None:
            return plain
        check = checks_of(value.py_func.__code__.co_filename, self.digest).get(value.py_func.__name__)
        return CheckedFirst(value, check) if check else value

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
        vars(module).update(compiled_twins(module, own, space, os.path.join(self.cache, package)))

    def _stays(self, package, origin):
        return False

    def _meant(self, package, source, origin):
        return self.solution(origin) if package == "solutions" else super()._meant(package, source, origin)

    def _finish(self, package, module):
        if package != "scenes":
            vars(module).update(self._redirected(package, module))
            self._compile(package, module)
            return
        redirected = self._redirected(package, module)
        space = {**vars(module), **redirected}                                  # what compiled functions see
        plain = vars(module_set(self.folder).scene_module(module.__name__.rpartition(".")[2]))
        lessons = {name: cached_dispatch(self._from_outside(name, twin, plain.get(name)))
                   for name, twin in redirected.items() if hasattr(twin, "py_func") and not name.startswith(MAKE)}
        space |= compiled_twins(module, _called_from(space, LAW, module.__name__), space,
                                os.path.join(self.cache, package))
        run = types.FunctionType(plain["run"].__code__, {**plain, **lessons}, "run")
        record = replace(plain["SCENE"], run=run, acceleration=space.get(LAW))
        vars(module).update({**plain, "__name__": module.__name__, "SCENE": record})


@cache
def checks_of(file, digest):
    """{function: the check of its record, as a plain function of the same arguments} of the functions in a file."""
    found, space = {}, {CHECK: vars(original(RECORDS))[CHECK]}
    for function in ast.parse(Path(file).read_text(encoding="utf-8", errors="replace")).body:
        for line in function.body if isinstance(function, ast.FunctionDef) else ():
            if isinstance(line, ast.Expr) and isinstance(line.value, ast.Call) and \
                    isinstance(line.value.func, ast.Name) and line.value.func.id == CHECK:
                check = ast.fix_missing_locations(ast.Expression(ast.Lambda(function.args, line.value)))
                found[function.name] = eval(compile(check, file, "eval"), space)
    return found


def _called_from(space, root, home):
    """Names of the functions of module `home` that root reaches, itself included."""
    own = {name: f for name, f in space.items() if isinstance(f, types.FunctionType) and f.__module__ == home}
    reached, waiting = set(), [root] if root in own else []
    while waiting:
        name = waiting.pop()
        reached.add(name)
        waiting += [n for n in own[name].__code__.co_names if n in own and n not in reached]
    return reached
