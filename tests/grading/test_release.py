"""The students' zip: all that they need and nothing that they may not have; it runs, and it is refused when an answer would leak."""

import ast
import json
import os
import re
import shutil
import subprocess
import sys
import textwrap
import zipfile

import nbformat
import numpy as np
import pytest

from validate import generate
from validate.modules import ROOT, SOLUTIONS, lesson_names

from ..lessons.kernels import kernel, ran
from . import release

pytestmark = pytest.mark.xdist_group("notebooks")        # one kernel at a time, see test_notebooks


def git(*arguments, cwd):
    command = ["git", "-c", "user.name=a", "-c", "user.email=a@b", *arguments]
    return subprocess.run(command, cwd=cwd, check=True, capture_output=True, text=True).stdout


@pytest.fixture(scope="module")
def repository(tmp_path_factory):
    """A repository of its own, in which everything that is tracked here is committed as it lies here."""
    folder = tmp_path_factory.mktemp("clone")
    for path in git("ls-files", cwd=ROOT).splitlines():
        if (ROOT / path).is_file():
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / path, folder / path)
    git("init", "--quiet", cwd=folder)
    git("add", "--all", cwd=folder)
    git("commit", "--quiet", "--message", "all", cwd=folder)
    return folder


@pytest.fixture
def released(repository, tmp_path, monkeypatch, capsys):
    """released(*arguments) → (exit code, what was said, path of the zip)."""
    monkeypatch.setattr(release, "ROOT", repository)

    def run(*arguments, out=tmp_path / "workbook.zip"):
        with pytest.raises(SystemExit) as end:
            release.main(["--out", str(out), *arguments])
        said = capsys.readouterr()
        return end.value.code or 0, said.out + said.err, out
    return run


def files_in(path):
    with zipfile.ZipFile(path) as archive:
        return {name.removeprefix("workbook/"): archive.read(name).decode() for name in archive.namelist() if not name.endswith(".png")}


@pytest.fixture(scope="module")
def unpacked(repository, tmp_path_factory):
    """The zip of that repository, made by its own command, unpacked."""
    folder = tmp_path_factory.mktemp("student")
    subprocess.run([sys.executable, "-m", "tests.grading.release", "--out", str(folder / "workbook.zip")], cwd=repository, check=True)
    shutil.unpack_archive(folder / "workbook.zip", folder)
    return folder / "workbook"


def run_in(folder, *arguments):
    """What a command of Python says in an unpacked zip."""
    return subprocess.run([sys.executable, "-m", *arguments], cwd=folder, capture_output=True, text=True)


# ---------------------------------------------------------------------------------------------- what goes in

@pytest.mark.long
def test_the_same_commit_gives_the_same_bytes(released, tmp_path):
    (code, said, first), (_, _, second) = released(), released(out=tmp_path / "again.zip")
    assert code == 0, said
    assert first.read_bytes() == second.read_bytes()
    names = zipfile.ZipFile(first).namelist()
    assert names == sorted(names) and all(name.startswith("workbook/") for name in names)


def test_students_get_what_they_need_and_nothing_of_the_authors(released, repository):
    (repository / "notes.txt").write_text("never added")
    files = files_in(released()[2])
    for name in lesson_names():
        assert {f"lessons/{name}.py", f"solutions/{name}.py", f"tests/lessons/test_{name}.py"} <= files.keys()
    assert {"README.md", "LICENSE", "pyproject.toml", "constraints.txt", "uv.lock", "validate/scenes/integrators/oscillator.py",
            "validate/recorded/oscillator.json", "validate/report/base.html", "tests/grading/plugin.py", "tests/grading/expect.py", "notebooks/00_start_here.ipynb"} <= files.keys()
    assert not [name for name in files if re.search(r"mutants|test_(notebooks|generate|repository|release)|grading/box|generate|^\.|notes", name)
                and name not in (".python-version", ".gitignore")]
    assert files["solutions/answers.md"] == release.NO_ANSWERS
    linked = re.findall(r"\]\((?!https?:)([^)#]+)", files["README.md"])
    assert files["README.md"].startswith("# Physics-based animation: your workbook") and linked and not set(linked) - files.keys()


def test_the_students_readme_names_commands_that_are_there(released):
    files = files_in(released()[2])
    commands = set(re.findall(r"\.venv/bin/([\w.-]+)", files["README.md"]))
    ours = set(re.findall(r'^([\w-]+) *= *"(?:tests|validate)[\w.]*:\w+"', files["pyproject.toml"], re.M))
    assert commands == {"pip", "jupyter", "pytest", "validate"} and "validate" in ours


def test_without_answers_a_lesson_builds_on_its_siblings(released):
    files = files_in(released()[2])
    for name in lesson_names():
        source = (SOLUTIONS / f"{name}.py").read_text()
        for folder in ("solutions", "lessons"):
            assert all(f'"Exercise {number}: {function}"' in files[f"{folder}/{name}.py"] for number, function in generate.exercises(source).items())
    assert "from .integrators import" in files["lessons/springs.py"] and "from solutions.checks import" in files["lessons/springs.py"]


def test_a_released_lesson_is_as_worked_without_markers_and_others_import_it(released):
    code, said, out = released("--with-solutions=integrators")
    assert code == 0, said
    files, worked = files_in(out), (SOLUTIONS / "integrators.py").read_text()
    assert files["solutions/integrators.py"] == re.sub(r"^ *### (BEGIN|END) SOLUTION.*\n", "", worked, flags=re.M)
    assert "NotImplementedError" in files["lessons/integrators.py"] and "NotImplementedError" in files["solutions/springs.py"]
    assert "from solutions.integrators import" in files["lessons/springs.py"] and files["solutions/answers.md"] == release.NO_ANSWERS


def test_with_solutions_alone_releases_them_all(released):
    files = files_in(released("--with-solutions")[2])
    assert not any("NotImplementedError(\"Exercise" in files[f"solutions/{name}.py"] for name in lesson_names())
    assert files["solutions/answers.md"] == (ROOT / "solutions/answers.md").read_text() and "--of=lessons" not in files["pyproject.toml"]


@pytest.mark.long
def test_a_single_lesson_comes_with_its_scenes_and_what_it_builds_on(released):
    files = files_in(released("--lesson", "integrators")[2])
    assert "lessons/integrators.py" in files and "validate/scenes/integrators/oscillator.py" in files and "notebooks/00_start_here.ipynb" in files
    assert not [name for name in files if "spring" in name]
    files = files_in(released("--lesson", "springs")[2])
    assert {"lessons/integrators.py", "lessons/springs.py", "validate/scenes/springs/spring_net.py"} <= files.keys()


@pytest.mark.parametrize("arguments, named", [
    (["--with-solutions=springs"], "integrators"),
    (["--lesson", "integrators", "--with-solutions=integrators,springs"], "springs"),
    (["--lesson", "juggling"], "juggling"),
    (["--with-solutions=juggling"], "juggling"),
])
def test_what_does_not_fit_together_is_told_in_one_sentence(released, arguments, named):
    code, said, out = released(*arguments)
    assert code == 2 and named in said and len(said.strip().splitlines()) == 1 and not out.exists()


def test_a_file_that_is_no_zip_is_never_overwritten(released, tmp_path):
    thesis = tmp_path / "thesis.txt"
    thesis.write_text("years of work")
    code, said, _ = released(out=thesis)
    assert code == 2 and "thesis.txt" in said and thesis.read_text() == "years of work"


def test_what_is_not_committed_is_refused(released, repository, planted):
    planted("LICENSE", "\nchanged\n")
    code, said, out = released()
    assert code == 2 and "LICENSE" in said and "--dirty" in said and not out.exists()
    assert released("--dirty")[0] == 0


# ---------------------------------------------------------------------------------------------- what must not

@pytest.fixture
def planted(repository):
    """planted(path, text) adds a text to the end of a tracked file, or to a new one that is then tracked; all is undone afterwards."""
    def plant(path, text):
        file = repository / path
        if isinstance(text, bytes):
            file.write_bytes(text)
        else:
            file.write_text((file.read_text() if file.is_file() else "") + text)
        git("add", "--force", path, cwd=repository)
    yield plant
    git("reset", "--quiet", "--hard", cwd=repository)


def body_of(exercise):
    """An answer as it stands in the solutions, without its indentation."""
    for match in (m for name in lesson_names() for m in generate.ANSWER.finditer((SOLUTIONS / f"{name}.py").read_text())):
        if match["exercise"] == exercise:
            return textwrap.dedent("".join(match[0].splitlines(keepends=True)[1:-1]))


def function(name, body):
    return f"\n\ndef {name}(*_):\n{textwrap.indent(body, '    ')}"


def reformatted(body):
    """The same statements as Python itself would write them, every string and bracket its own way."""
    return ast.unparse(ast.parse(body)).replace(", ", ",").replace(" + ", "+  ")


def refused(released, *named):
    code, said, out = released("--dirty")
    assert code == 2 and len(said.strip().splitlines()) == 1 and all(name in said for name in named), said
    assert not out.exists() and not list(out.parent.iterdir())
    return True


@pytest.mark.parametrize("path, text, named", [
    ("docs/page.md", "Look for ### BEGIN SOLUTION 1.2 in the file.", "BEGIN SOLUTION"),
    ("validate/scenes/integrators/throw.py", function("half_way", reformatted(body_of("1.2"))), "1.2"),
    ("validate/scenes/integrators/throw.py", f"\nstep = lambda acceleration, t, x, v, dt, p: ({body_of('1.1').removeprefix('return ')})", "1.1"),
    ("validate/scenes/integrators/throw.py", function("air_force", body_of("2.2")), "2.2"),
    ("validate/stability.py", function("run", "for _ in range(3):\n" + textwrap.indent(body_of("2.7"), "    ")), "2.7"),
    ("validate/stability.py", "\n" + textwrap.indent(body_of("2.11"), "# "), "2.11"),
    ("validate/report/words.py", f"\nHELP = {body_of('1.10')!r}\n", "1.10"),
    ("tests/lessons/test_springs.py", function("reference", "\n".join(body_of("2.12").splitlines()[2:])), "2.12"),
    ("docs/students.md", f"\n```python\n{reformatted(body_of('1.3'))}\n```\n", "1.3"),
    ("docs/page.md", f"The answer: `{body_of('2.9').strip()}`", "2.9"),
    ("docs/page.html", "<pre>\n" + body_of("1.7").replace("<", "&lt;").replace(">", "&gt;") + "</pre>", "1.7"),
    ("validate/recorded/throw.json", None, "1.8"),
    ("docs/page.md", "Well, " + (SOLUTIONS / "answers.md").read_text().split("\n\n")[2][3:].replace("\n", " \n "), "answers.md"),
    ("docs/integrators.cpython-311.pyc", b"\xa7\r\r\n\x00", "pyc"),
], ids=["marker", "scene", "lambda", "trivial body under its name", "inside a loop", "comment", "string", "most of it in a test", "fence",
        "inline code", "html", "recording", "answer to a question", "compiled code"])
def test_a_planted_leak_is_refused(released, repository, planted, path, text, named):
    if path.endswith(".json"):
        recording = json.loads((repository / path).read_text())
        (repository / path).write_text("")
        text = json.dumps({**recording, "note": [line + "\n" for line in body_of(named).splitlines()]})
    planted(path, text)
    assert refused(released, path, named)


@pytest.mark.parametrize("kind", ["code", "markdown", "output"])
def test_an_answer_pasted_into_a_notebook_is_refused(released, repository, planted, kind):
    path, answer = "notebooks/01_integrators.ipynb", body_of("1.6")
    notebook = json.loads((repository / path).read_text())
    if kind == "code":
        notebook["cells"][-1] = {"cell_type": "code", "source": ["%matplotlib inline\n", *function("mine", answer).splitlines(keepends=True)]}
    elif kind == "markdown":
        notebook["cells"][-1]["source"] = f"Try\n~~~\n{answer}~~~\n"
    else:
        notebook["cells"][1]["outputs"] = [{"output_type": "stream", "name": "stdout", "text": answer}]
    (repository / path).write_text("")
    planted(path, json.dumps(notebook))
    assert refused(released, path, "1.6")


def test_an_older_zip_is_not_left_where_the_new_one_is_refused(released, planted):
    out = released()[2]
    assert out.exists()
    planted("docs/page.md", body_of("1.2"))
    assert refused(released, "docs/page.md")


def test_ordinary_code_is_no_leak(released, planted):
    for name, body in (("still", "return x, v"), ("breeze", body_of("2.2")), ("half", body_of("1.4").splitlines()[0])):
        planted("validate/scenes/integrators/throw.py", function(name, body))
    assert released("--dirty")[0] == 0


def test_every_answer_would_be_found_as_code_and_as_text():
    for name in lesson_names():
        for answer in release.answers_of(name):
            pasted = function(answer.function, body_of(answer.exercise))
            assert release.holds(release.searched(pasted), answer)
            comment = release.searched(textwrap.indent(body_of(answer.exercise), "# "))
            assert release.holds(comment, answer) or max(answer.pieces.values()) < release.TELLING, answer.exercise


# ---------------------------------------------------------------------------------------------- it runs

@pytest.mark.long
def test_the_tests_run_in_it_and_score_nothing(unpacked):
    said = run_in(unpacked, "pytest", "--of=lessons", "--tb=no", "-p", "no:cacheprovider").stdout
    assert re.search(r"^ +all  0 of " + str(20 * len(lesson_names())), said, re.M), said


@pytest.mark.long
def test_the_command_line_names_the_scenes_and_says_that_there_are_no_worked_answers(unpacked):
    assert "oscillator" in run_in(unpacked, "validate", "list").stdout
    asked = run_in(unpacked, "validate", "--scene", "oscillator")
    assert asked.returncode == 2 and "without worked answers of integrators" in asked.stderr and len(asked.stderr.strip().splitlines()) == 1


@pytest.mark.long
@pytest.mark.parametrize("name, checks", [("00_start_here", {"1.1"}), ("01_integrators", {"1.10"})])
def test_a_notebook_runs_in_it_and_says_what_it_is_without(unpacked, monkeypatch, name, checks):
    monkeypatch.setenv("PYTHONPATH", str(unpacked))
    monkeypatch.delenv("WORKBOOK_LESSONS", raising=False)
    notebook = nbformat.read(unpacked / "notebooks" / f"{name}.ipynb", as_version=4)
    asked = {cell.source for cell in notebook.cells if cell.source.startswith("check(")}
    assert {f'check("{number}")' for number in checks} <= asked
    with kernel(unpacked / "notebooks") as client:
        said = "".join(ran(client, cell.source) for cell in notebook.cells
                       if cell.cell_type == "code" and (cell.source not in asked or cell.source[7:-2] in checks))
    assert "The worked answers of integrators are not in this copy" in said and "This first picture was made beforehand" in said
    assert "data-picture" in said and not re.search(r"Exercise [\d.]+: \w+: not attempted yet, so it is not drawn", said.partition("made beforehand")[0])
    assert all(f"Exercise {number}: not attempted" in said for number in checks)


@pytest.mark.long
def test_own_answers_stand_in_for_worked_ones(unpacked, tmp_path):
    for name in lesson_names():
        source = (SOLUTIONS / f"{name}.py").read_text()
        (tmp_path / f"{name}.py").write_text(generate.stub(source, generate.exercises(source), elsewhere={"checks", "vectors"}))
    program = """
        import numpy as np
        from validate.notebook import answers, attempt
        integrators, springs = answers("integrators"), answers("springs")
        x, pairs = np.array([[0.0, 0.0], [1.0, 0.0]]), springs.grid_pairs(1, 2, springs.STRUCTURAL)
        mesh = springs.make_mesh(x, 1.0, (0,), pairs, 1.0, 0.0, [0.0, -1.0], [0.0, 0.0], 0.0)
        print(springs.mass_spring_damper_step(0.0, x, 0.0 * x, 2.0, mesh)[1][1])
        print(attempt(lambda: answers("juggling").catch))
    """
    run = subprocess.run([sys.executable, "-c", textwrap.dedent(program)], cwd=unpacked, capture_output=True, text=True,
                         env={**os.environ, "WORKBOOK_LESSONS": str(tmp_path)})
    assert "[ 0. -2.]" in run.stdout and run.stdout.strip().endswith("None"), run.stderr


@pytest.mark.long
def test_own_file_that_cannot_be_loaded_leaves_what_is_given(unpacked, tmp_path):
    (tmp_path / "integrators.py").write_text("def euler_step(:\n")
    program = """
        from validate.notebook import answers, attempt
        worked = answers("integrators")
        print(worked.Oscillator(2.0, 0.0).omega, worked.advance.__name__, attempt(worked.euler_step))
    """
    run = subprocess.run([sys.executable, "-c", textwrap.dedent(program)], cwd=unpacked, capture_output=True, text=True,
                         env={**os.environ, "WORKBOOK_LESSONS": str(tmp_path)})
    assert "2.0 advance None" in run.stdout, run.stderr


@pytest.mark.long
def test_a_lesson_is_checked_though_one_that_it_builds_on_does_not_load(unpacked, tmp_path):
    for name in lesson_names():
        source = (SOLUTIONS / f"{name}.py").read_text()
        (tmp_path / f"{name}.py").write_text(generate.stub(source, generate.exercises(source), elsewhere={"checks", "vectors"}))
    (tmp_path / "integrators.py").write_text("def euler_step(:\n")
    said = run_in(unpacked, "pytest", f"--of={tmp_path}", "--tb=line", "-p", "no:cacheprovider", *(f"--exercise={n}" for n in ("2.7", "2.9", "7.1"))).stdout
    assert re.search(r"^ +2\.7  (\d)", said, re.M) and re.search(r"^ +7\.1  1 of 1$", said, re.M) and re.search(r"^ +2\.9  0 of", said, re.M), said
    assert "integrators.py cannot be loaded: SyntaxError: invalid syntax (integrators.py, line 1)" in said


# ---------------------------------------------------------------------------------------------- truths

WRONG = """


def _off(value):
    if isinstance(value, tuple):
        return type(value)(*map(_off, value)) if hasattr(value, "_fields") else tuple(map(_off, value))
    return 1.01 * value if np.asarray(value).dtype.kind == "f" else value


def _wrong(right):
    return lambda *arguments: _off(right(*arguments))


for _name in {names}:
    globals()[_name] = _wrong(globals()[_name])
"""
TRUTHS = """
import json, re, sys
import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import nbformat
import numpy as np
from validate import notebook

found, TRUE = {}, re.compile("truth|theory|by hand")

def keep(name, data):
    if TRUE.search(name):
        found.setdefault(f"{cell.id} {name}", np.asarray(data, dtype=float).tolist())

def shown():
    for line in (line for number in plt.get_fignums() for axes in plt.figure(number).axes for line in axes.lines):
        keep(str(line.get_label()), line.get_xydata())
    plt.close("all")

notebook.play = lambda frames, *_, **__: [keep(name, pictures) for name, pictures in frames.items()]
notebook.display, plt.show, space = lambda *_: None, shown, {}
for cell in nbformat.read(sys.argv[1], as_version=4).cells:
    if cell.cell_type == "code" and not re.search("^check|^show_|measured\\\\(|interact|ablations", cell.source, re.M):
        exec(cell.source, space)
print(json.dumps(found))
"""


def truths(copy, notebook, lessons):
    """{cell and label: numbers} of every curve of a notebook that says that it is true, where these are the student's lessons."""
    run = subprocess.run([sys.executable, "-c", TRUTHS, str(copy / "notebooks" / notebook)], cwd=copy, capture_output=True, text=True,
                         env={**os.environ, "WORKBOOK_LESSONS": str(lessons)})
    assert run.returncode == 0, run.stderr
    return json.loads(run.stdout.splitlines()[-1])


@pytest.mark.long
@pytest.mark.parametrize("notebook, least", [("01_integrators.ipynb", 5), ("02_springs.ipynb", 5)])
def test_what_a_notebook_calls_true_does_not_come_from_the_student(unpacked, tmp_path, notebook, least):
    """The student's functions are all a hundredth off: what is drawn as truth is what it is where nothing is written yet."""
    for name in lesson_names():
        source = (SOLUTIONS / f"{name}.py").read_text()
        answered = generate.exercises(source)
        text = generate.stub(source, answered, elsewhere={"checks", "vectors"})
        (tmp_path / f"{name}.py").write_text(text + WRONG.format(names=tuple(answered.values())))
    wrong, open_ = truths(unpacked, notebook, tmp_path), truths(unpacked, notebook, unpacked / "lessons")
    assert len(wrong) >= least and wrong == open_
    for name, places in wrong.items():
        if name.endswith("07-2b95ab truth"):                          # Kepler's ellipse: the ways from its two foci are 2 m long
            assert np.allclose([np.hypot(*p) + np.hypot(p[0] + 1.2, p[1]) for p in places], 2.0, rtol=1e-12)
