"""`release --out workbook.zip`: write the students' zip of this repository, unless an answer would leak.

The zip holds the tracked files that a student needs: lessons, notebooks, their tests, scenes, recorded traces, docs.
The lessons as handed out replace the worked answers, and the arrays of the notebooks' first pictures are computed
beforehand.  A lesson imports its siblings: a student's own lesson 1 serves lesson 2.  A lesson of --with-solutions is
in the zip as worked, without markers, and the other lessons import it from there.

Every text of the zip is searched for every answer that is not released, in two ways.

- As code: statement by statement after ast.unparse, in Python files, notebook cells, fences and quoted strings.
- As text: line by line without spaces, in comments and prose, too.

An answer has leaked if one text holds more than LEAKED of it, by size, and in that a piece of at least TELLING names,
attributes and numbers.  Smaller pieces, like `return x`, are ordinary code.  An answer without any such piece has
leaked if a function of its name has its body.

*Left out:* an answer whose variables were renamed.
"""

import ast
import copy
import html
import json
import keyword
import os
import re
import subprocess
import sys
import tempfile
import textwrap
import warnings
import zipfile
from functools import cache
from pathlib import Path
from typing import Annotated, NamedTuple

import typer
from rich.console import Console

from solutions.checks import BadInput
from validate.run.command import start
from validate.run.store import writable
from validate.subject import generate, modules
from validate.subject.modules import ROOT

TOP = "workbook"                                  # folder that the zip unpacks to
WHEN = (1980, 1, 1, 0, 0, 0)                      # of every entry: the same commit gives the same bytes
LEAKED = 2 / 3                                    # share of an answer
TELLING = 5                                       # names, attributes and numbers in a statement: `r = x_b - x_a` has 3
PICTURES = {".png", ".jpg", ".gif"}
ALWAYS = {
    "LICENSE",
    "pyproject.toml",
    "constraints.txt",
    "uv.lock",
    ".python-version",
    ".gitignore",
    "tests/__init__.py",
    "validate/grading/__init__.py",
}
AUTHORS = {
    "validate/subject/generate.py",                       # makes the lessons from the answers
    "validate/speed/benchmark.py",                      # times the answers
    "validate/worlds/conformance.py",                   # judges a reader's engine, in scenes of all lessons
    "validate/worlds/described.py",
    "validate/report/required.json",                     # the audit's list of all scenes and findings
    "docs/grading.md",                            # for instructors
    "docs/instructors.md",
    "docs/plan.md",
    "docs/scenes.png",                            # of the repository's README
    "docs/scenes.webp",
    "docs/slides.md",
}
PLUGIN = "validate/grading/plugin.py"
OPENINGS = "notebooks/openings.json"
README = "docs/students.md"                       # becomes README.md: the repository's own is for instructors
MARKER = re.compile(r"(BEGIN|END)\W+SOLUTION", re.I)
FENCE = re.compile(r"^ *(```|~~~).*?\n(.*?)^ *\1", re.M | re.S)
WORD = re.compile(r"[^\W\d]\w*|\d[\d.]*")          # a name or a number
SPAN = re.compile(r"`([^`\n]+)`")

app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)

Out = Annotated[Path, typer.Option(help="The zip to write.")]
WithSolutions = Annotated[
    str | None, typer.Option(metavar="[=LESSON,LESSON]", help="Worked answers of these lessons, or of all.")
]
Lessons = Annotated[
    list[str] | None, typer.Option(help="Only this lesson (may be repeated), and the earlier ones that it builds on.")
]
Dirty = Annotated[bool, typer.Option("--dirty", help="Take tracked files as they lie there, committed or not.")]


@app.command(help="Write the students' zip; it is refused when an answer would leak.")
def release(
    out: Out = Path("workbook.zip"), with_solutions: WithSolutions = None, lesson: Lessons = None, dirty: Dirty = False
):
    if out.exists() and not zipfile.is_zipfile(out):
        raise BadInput(f"--out {str(out)!r}", "there, and no zip", "name another file")
    chosen = with_earlier(known(lesson or modules.lesson_names()))
    worked = set(chosen) if with_solutions == EVERY else set(known([n for n in (with_solutions or "").split(",") if n]))
    if missing := (with_earlier(worked) - worked) | (worked - chosen):
        raise BadInput(
            f"--with-solutions={','.join(sorted(worked))}",
            f"without {', '.join(sorted(missing))}",
            "release the lessons that these build on as well, and none that --lesson leaves out",
        )
    writable(out.absolute().parent)
    out.unlink(missing_ok=True)                   # so that no older zip is taken for this one if the command fails
    with Console(stderr=True).status("collecting files and searching them for answers"):
        files = contents(tracked(dirty), chosen, worked)
        refuse_leaks(files, worked)
    files["README.md"] = files.pop(README)
    write(out, files)
    answered = ", ".join(sorted(worked)) or "none"
    print(f"{out}: {len(files)} files, lessons {', '.join(sorted(chosen))}, worked answers of {answered}")


# ---------------------------------------------------------------------------------------------- what goes in

EVERY = "*"


def source(lesson):
    return (modules.SOLUTIONS / f"{lesson}.py").read_text(encoding="utf-8")


def known(names):
    """Return the names.  Raises BadInput if one is not a lesson."""
    for name in names:
        modules.bind(name)
    return names


def with_earlier(names):
    """Return these lessons and all that they build on."""
    found, waiting = set(), list(names)
    while waiting:
        name = waiting.pop()
        found.add(name)
        waiting += set(re.findall(r"^from \.(\w+) import", source(name), re.M)) - modules.GIVEN - found
    return found


def tracked(dirty):
    """Return the paths of all files that git tracks.  Raises BadInput if the work tree differs from the commit."""
    def git(*arguments):
        try:
            return subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=True).stdout
        except (OSError, subprocess.CalledProcessError):
            raise BadInput(f"folder {str(ROOT)!r}", "no git repository", "release from a clone") from None

    changed = [line[3:] for line in git("status", "--porcelain", "--untracked-files=no").splitlines()]
    if changed and not dirty:
        some = ", ".join(changed[:3] + ["…"] * (len(changed) > 3))
        raise BadInput("the work tree", f"changed but not committed ({some})", "commit, or give --dirty")
    return sorted(path for path in git("ls-files", "-z").split("\0") if path and (ROOT / path).exists())


def contents(paths, lessons, worked):
    """Return {path in the zip: bytes}."""
    scenes = {name for name in modules.scene_names() if modules.bind_scene(name).lesson in lessons}
    others = set(modules.lesson_names()) - lessons
    chosen = {path for path in paths if wanted(Path(path), lessons, others, scenes)}
    files = {path: read(path) for path in with_imports(chosen, paths)}
    for name in lessons:
        solved = set(generate.exercises(source(name))) if name in worked else ()
        files[f"solutions/{name}.py"] = generate.stub(source(name), solved, elsewhere=()).encode()
        files[f"lessons/{name}.py"] = generate.stub(source(name), elsewhere=modules.GIVEN | worked).encode()
    files["lessons/__init__.py"] = generate.lessons()["__init__.py"].encode()
    if not worked >= lessons:
        files[OPENINGS] = openings({path: text for path, text in files.items() if path.startswith("notebooks/")})
    files["pyproject.toml"] = for_students(files["pyproject.toml"].decode(), files, worked >= lessons).encode()
    return with_whole_given(files)


def with_whole_given(files):
    """Leave out the given modules that import a module which is not in the zip."""
    given = tuple(f"solutions/{package}/" for package in modules.PACKAGES)
    lacks = lambda path: any((ROOT / name).is_file() and name not in files for name in imported(path))
    kept = {path: text for path, text in files.items() if not (path.startswith(given) and lacks(path))}
    return kept if len(kept) == len(files) else with_whole_given(kept)


def openings(notebooks):
    """Compute the arrays of each notebook's first picture, for a copy without worked answers."""
    cells = [first_code_cell(json.loads(text)) for _, text in sorted(notebooks.items())]
    return made_by(tuple("".join(cell["source"]) for cell in cells)).encode()


def first_code_cell(notebook):
    return next(cell for cell in notebook["cells"] if cell["cell_type"] == "code")


@cache
def made_by(cells):
    """Return the JSON of everything that these cells pass to `opening`."""
    try:
        from validate import notebook  # imports matplotlib, which takes a second
    except ModuleNotFoundError as e:
        remedy = "the notebooks need it: pip install -c constraints.txt -e '.[student]'"
        raise BadInput(f"the package {e.name}", "not installed", remedy) from None
    made, opening = {}, notebook.opening

    def keep(number, make):
        made[number] = notebook.frozen(make())                       # returns None, so that nothing is shown

    notebook.opening = keep
    try:
        for cell in cells:
            exec(cell, {"__name__": "opening"})
    finally:
        notebook.opening = opening
    return json.dumps(made, separators=(",", ":"))


def wanted(path, lessons, others, scenes):
    """Return whether a tracked file goes into the zip unchanged."""
    folder = path.parts[0]
    if path.as_posix() in ALWAYS | {PLUGIN}:
        return True
    if path.as_posix() in AUTHORS or path.parts[:2] in (("validate", "book"), ("validate", "grading")):
        return False
    if path.parts[:2] in (("validate", "scenes"), ("validate", "recorded")) and path.stem != "__init__":
        return path.stem in scenes
    if folder == "validate" and (path.stem in others or path.parent.name in others):
        return False
    if folder == "notebooks":
        return path.stem.partition("_")[2] not in others
    if folder == "solutions":
        return path.suffix == ".py" and Path(path.parts[1]).stem in modules.GIVEN and path.stem not in others
    tests = {f"tests/lessons/test_{name}.py" for name in lessons}
    return folder in ("validate", "docs") or path.as_posix() in ALWAYS | tests


def with_imports(chosen, paths):
    """Return these files and the modules of tests/ and validate/ that they import."""
    there = {path for path in paths if path.startswith(("tests/", "validate/"))}
    found, waiting = set(), sorted(chosen)
    while waiting:
        path = waiting.pop()
        found.add(path)
        if path.endswith(".py"):
            waiting += (imported(path) & there) - found
    return found


def imported(path):
    """Return the paths of the modules that a module may import."""
    return named_in(read(path), tuple(path.split("/")[:-1]))


@cache
def named_in(text, package):
    """Return the paths of the modules that a text in that package may import."""
    package, names = list(package), set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom):
            base = package[:len(package) + 1 - node.level] if node.level else []
            base = base + (node.module.split(".") if node.module else [])
            names |= {".".join(base), *(".".join([*base, alias.name]) for alias in node.names)}
        elif isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
    return {f"{name.replace('.', '/')}.py" for name in names}


def read(path):
    """Return the bytes of a file, with one kind of line ends.  Raises BadInput if it is not text or a picture."""
    file = ROOT / path
    if file.is_symlink() or not file.is_file():
        raise BadInput(path, "a link or no file", "put the file itself there")
    if file.suffix in PICTURES:
        return file.read_bytes()
    try:
        return file.read_text(encoding="utf-8").encode()
    except UnicodeDecodeError:
        remedy = "students get nothing that cannot be searched for answers: git rm it"
        raise BadInput(path, "neither text nor a picture", remedy) from None


def for_students(text, files, solved):
    """Return pyproject.toml without commands that are not in the zip; if answers are missing, pytest tests lessons/."""
    def keep(match):
        path = match[1].replace(".", "/")
        return match[0] if {f"{path}.py", f"{path}/__init__.py"} & files.keys() else ""
    text = re.sub(r'^[\w-]+ *= *"((?:tests|validate)[\w.]*):\w+".*\n', keep, text, flags=re.M)
    return text if solved else text.replace('addopts = "', 'addopts = "--of=lessons ', 1)


# ---------------------------------------------------------------------------------------------- what must not

class Answer(NamedTuple):
    """The body of an exercise, taken apart."""
    lesson: str
    exercise: str
    function: str
    body: str                        # normalised
    pieces: dict[str, int]           # {statement: its size}
    lines: dict[str, int]            # {line without spaces: its size}
    names: set[frozenset[str]]       # the names of each telling statement or line, and that of the function


def answers_of(lesson):
    for match in generate.ANSWER.finditer(source(lesson)):
        body = textwrap.dedent("".join(match[0].splitlines(keepends=True)[1:-1]))
        tree, function = ast.parse(body), generate.exercises(source(lesson))[match["exercise"]]
        lines = {line: len(words(text)) for text in body.splitlines() if (line := squeezed(text))}
        telling = [text for text, size in pieces(tree) if size >= TELLING]
        if telling:
            telling += [text for text in body.splitlines() if len(words(text)) >= TELLING]
        names = {frozenset(word for word in words(text) if not word[0].isdigit()) for text in telling or [function]}
        yield Answer(lesson, match["exercise"], function, plain(tree.body), dict(pieces(tree)), lines, names)


def pieces(tree):
    """Generate (normalised, size) of every statement.

    A compound statement counts as its head, a return as its value, and a docstring not at all.
    """
    for node in ast.walk(tree):
        if isinstance(node, ast.stmt) and not isinstance(getattr(node, "value", None), ast.Constant):
            node = node.value if isinstance(node, (ast.Return, ast.Expr)) and node.value else copy.copy(node)
            for block in ("body", "orelse", "finalbody", "handlers", "cases"):
                if isinstance(getattr(node, block, None), list):
                    setattr(node, block, [ast.Pass()] if block == "body" else [])
            yield ast.unparse(node), size(node)


def size(node):
    return sum(isinstance(part, (ast.Name, ast.Attribute, ast.Constant)) for part in ast.walk(node))


def words(line):
    """Return the names and numbers in a line of code."""
    return [word for word in WORD.findall(line.partition("#")[0]) if not keyword.iskeyword(word)]


def squeezed(line):
    """Return a line of code without spaces, comment and `return`, and without the marks of prose around it."""
    return re.sub(r"\s", "", re.sub(r"^return\b", "", line.strip("#>*-`'\" \t").partition(" #")[0]))


class Searched(NamedTuple):
    """One text of the zip, taken apart for the search."""
    statements: set[str]
    lines: set[str]
    bodies: set[tuple[str, str]]     # (function, its body)


@cache                          # lessons and solutions quote the same texts
def searched(text):
    """Take a text and its fences apart for the search."""
    statements, bodies = set(), set()
    for tree in filter(None, map(parsed, [text, *(match[2] for match in FENCE.finditer(text))])):
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef):
                bodies.add((node.name, plain(node.body)))
            elif isinstance(node, ast.Lambda):
                statements.add(ast.unparse(node.body))
            elif isinstance(node, ast.Assign):
                statements.add(ast.unparse(node.value))
        statements |= dict(pieces(tree)).keys()
    lines = {squeezed(line) for line in [*html.unescape(text).splitlines(), *SPAN.findall(text)]}
    return Searched(statements, lines, bodies)


def plain(body):
    """Return the statements of a body without its docstring, normalised."""
    documented = isinstance(body[0], ast.Expr) and isinstance(body[0].value, ast.Constant)
    return "\n".join(map(ast.unparse, body[documented:]))


def parsed(text):
    """Return the syntax tree of a text, or None if it is not Python.  A notebook's own commands (%, !) are dropped."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")                          # of invalid escapes, which prose may have
            return ast.parse(re.sub(r"^[%!].*$", "", textwrap.dedent(text), flags=re.M))
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None


@cache
def texts(path, text):
    """Return the text and every long enough text that it quotes: strings of JSON and of Python."""
    quoted = list(strings(json.loads(text))) if path.endswith((".json", ".ipynb")) else []
    sources = [text, *quoted] if path.endswith((".py", ".json", ".ipynb")) else []
    for tree in filter(None, map(parsed, sources)):
        constants = [node.value for node in ast.walk(tree) if isinstance(node, ast.Constant)]
        quoted += [value for value in constants if isinstance(value, str)]
    return [text, *{quote for quote in quoted if len(WORD.findall(quote)) >= TELLING}]


def strings(value):
    """Generate the strings of a JSON value; a list of strings counts as one string."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for part in value.values():
            yield from strings(part)
    elif isinstance(value, list):
        if value and all(isinstance(part, str) for part in value):
            yield "".join(value)
        else:
            for part in value:
                yield from strings(part)


def share(sizes, found, telling):
    """Return the share of an answer that was found, by size; 0 if no found piece is telling."""
    here = [sizes[piece] for piece in sizes if piece in found]
    return sum(here) / sum(sizes.values()) if here and max(here) >= telling else 0.0


def holds(where, answer):
    """Return whether a searched text holds that answer."""
    if max(answer.pieces.values(), default=0) < TELLING:
        return (answer.function, answer.body) in where.bodies
    as_code = share(answer.pieces, where.statements, TELLING)
    return as_code > LEAKED or share(answer.lines, where.lines, TELLING) > LEAKED


def signs_of(hidden):
    """Return {sign: indices of the answers that have it}; a sign is a telling piece, or (function, body)."""
    signs = {}
    for number, answer in enumerate(hidden):
        telling = [piece for piece, size in (*answer.pieces.items(), *answer.lines.items()) if size >= TELLING]
        for sign in (*telling, (answer.function, answer.body)):
            signs.setdefault(sign, set()).add(number)
    return signs


def names_of(hidden):
    """Return {longest name: sets of names}: a text that holds a sign of an answer has all names of one of these sets.

    A set without names stands below "".
    """
    sets = {}
    for answer in hidden:
        for names in answer.names:
            sets.setdefault(max(names, key=len, default=""), set()).add(names)
    return sets


def may_hold(text, sets):
    """Return whether a text has all names of a sign.  That is quick to see, and a text without them needs no search."""
    names = {"", *WORD.findall(text)}
    return any(some <= names for name in names & sets.keys() for some in sets[name])


def suspects(where, hidden, signs):
    """Return the answers of which a searched text holds a sign; it cannot hold any other answer."""
    seen = signs.keys() & (where.statements | where.lines | where.bodies)
    return [hidden[number] for number in sorted(set().union(*(signs[sign] for sign in seen)))]


def refuse_leaks(files, worked):
    """Raise BadInput for the first text in the zip that students must not have."""
    hidden = [answer for name in modules.lesson_names() if name not in worked for answer in answers_of(name)]
    signs = signs_of(hidden)
    sets = names_of(hidden)
    for path, data in sorted(files.items()):
        if "__pycache__" in path or path.endswith((".pyc", ".pyo")):
            raise BadInput(path, "compiled code", "answers can be read from that: git rm it")
        if Path(path).suffix in PICTURES or path == OPENINGS:           # frozen() accepts only numbers
            continue
        for text in texts(path, data.decode()):
            leak = leak_in(text, hidden, signs, sets)
            if leak:
                raise BadInput(path, f"not for students (it holds {leak.what})", leak.remedy)


class Leak(NamedTuple):
    """A part of a text that students must not have."""
    what: str
    remedy: str


def leak_in(text, hidden, signs, sets):
    """Return the first Leak of a text, or None."""
    marker = MARKER.search(text)
    if marker:
        return Leak(f"the marker {marker[0]}", "take it out")
    if not may_hold(text, sets):
        return None
    where = searched(text)
    for answer in suspects(where, hidden, signs):
        if holds(where, answer):
            what = f"the answer of exercise {answer.exercise}, {answer.function}"
            return Leak(what, f"take it out, or give --with-solutions={answer.lesson}")
    return None


# ---------------------------------------------------------------------------------------------- the zip

def write(out, files):
    """Write the zip completely or not at all.

    It is sorted, without dates and uncompressed, so that its bytes depend only on the commit.
    """
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=out.parent, suffix=".part", delete=False) as draft:
            try:
                with zipfile.ZipFile(draft, "w", zipfile.ZIP_STORED) as archive:
                    for path in sorted(files):
                        entry = zipfile.ZipInfo(f"{TOP}/{path}", WHEN)
                        entry.create_system, entry.external_attr = 3, 0o100644 << 16
                        archive.writestr(entry, files[path])
                draft.close()
                os.chmod(draft.name, 0o644)
                os.replace(draft.name, out)
            except BaseException:
                Path(draft.name).unlink(missing_ok=True)
                raise
    except OSError as e:
        raise BadInput(f"--out {str(out)!r}", f"not writable ({e.strerror})", "name another file") from None


def main(arguments=None):
    """Run the command line."""
    arguments = sys.argv[1:] if arguments is None else arguments
    start("release", app, [f"{a}={EVERY}" if a == "--with-solutions" else a for a in arguments])


if __name__ == "__main__":
    main()
