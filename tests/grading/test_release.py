"""The students' zip holds what they need, it runs, and it is refused when an answer would leak."""

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

from validate.grading import release
from validate.subject import generate
from validate.subject.modules import GIVEN, SOLUTIONS, lesson_names

from ..lessons.kernels import kernel, ran
from .conftest import git

# one kernel at a time, see test_notebooks; long, because the search for answers reads every text of the zip
pytestmark = [pytest.mark.xdist_group("notebooks"), pytest.mark.long]


@pytest.fixture
def released(repository, tmp_path, monkeypatch, capsys):
    """released(*arguments) → (exit code, printed text, path of the zip)."""
    monkeypatch.setattr(release, "ROOT", repository)

    def run(*arguments, out=tmp_path / "workbook.zip"):
        with pytest.raises(SystemExit) as end:
            release.main(["--out", str(out), *arguments])
        said = capsys.readouterr()
        return end.value.code or 0, said.out + said.err, out
    return run


def files_in(path):
    with zipfile.ZipFile(path) as archive:
        names = [name for name in archive.namelist() if not name.endswith(".png")]
        return {name.removeprefix("workbook/"): archive.read(name).decode() for name in names}


def run_in(folder, *arguments):
    """Run a Python module in an unpacked zip."""
    return subprocess.run([sys.executable, "-m", *arguments], cwd=folder, capture_output=True, text=True)


def program_in(folder, program, *arguments, lessons):
    """Run a Python program in an unpacked zip, with the student's lessons in a folder of their own."""
    command = [sys.executable, "-c", textwrap.dedent(program), *arguments]
    environment = {**os.environ, "WORKBOOK_LESSONS": str(lessons)}
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, env=environment)


def solved(name):
    """The worked file of a lesson as a student would hand it in."""
    source = (SOLUTIONS / f"{name}.py").read_text()
    return generate.stub(source, generate.exercises(source), elsewhere=GIVEN)


# ---------------------------------------------------------------------------------------------- contents

def test_the_same_commit_gives_the_same_bytes(released, tmp_path):
    (code, said, first), (_, _, second) = released(), released(out=tmp_path / "again.zip")
    assert code == 0, said
    assert first.read_bytes() == second.read_bytes()
    names = zipfile.ZipFile(first).namelist()
    assert names == sorted(names) and all(name.startswith("workbook/") for name in names)


NEEDED = {
    "README.md",
    "LICENSE",
    "pyproject.toml",
    "constraints.txt",
    "uv.lock",
    "validate/scenes/integrators/oscillator.py",
    "validate/recorded/oscillator.json",
    "validate/report/base.html",
    "validate/grading/plugin.py",
    "validate/grading/expect.py",
    "notebooks/00_start_here.ipynb",
}
OF_AUTHORS = re.compile(r"mutants|attacks|test_(notebooks|generate|repository|release)|grading/(box|unseen)|generate|"
                        r"^\.|notes|docs/(grading|instructors|plan|slides)")


def test_students_get_the_files_they_need_and_none_of_the_authors(released, repository):
    (repository / "notes.txt").write_text("never added")
    files = files_in(released()[2])
    for name in lesson_names():
        assert {f"lessons/{name}.py", f"solutions/{name}.py", f"tests/lessons/test_{name}.py"} <= files.keys()
    assert files.keys() >= NEEDED
    hidden = files.keys() - {".python-version", ".gitignore"}
    assert not [name for name in hidden if OF_AUTHORS.search(name)]


def test_the_students_readme_links_only_files_of_the_zip(released):
    files = files_in(released()[2])
    linked = set(re.findall(r"\]\((?!https?:)([^)#]+)", files["README.md"]))
    assert files["README.md"].startswith("# Physics-based animation: your workbook")
    assert linked <= files.keys()


def test_the_students_readme_names_only_commands_of_the_zip(released):
    files = files_in(released()[2])
    commands = set(re.findall(r"\.venv/bin/([\w.-]+)", files["README.md"]))
    ours = set(re.findall(r'^([\w-]+) *= *"(?:tests|validate)[\w.]*:\w+"', files["pyproject.toml"], re.M))
    assert commands == {"pip", "jupyter", "pytest", "validate"} and "validate" in ours


def test_without_answers_a_lesson_builds_on_its_siblings(released):
    files = files_in(released()[2])
    for name in lesson_names():
        source = (SOLUTIONS / f"{name}.py").read_text()
        for folder in ("solutions", "lessons"):
            for number, function in generate.exercises(source).items():
                assert f'"Exercise {number}: {function}"' in files[f"{folder}/{name}.py"]
    springs = files["lessons/springs.py"]
    assert "from .integrators import" in springs and "from solutions.checks import" in springs


def test_a_released_lesson_is_as_worked_without_markers_and_others_import_it(released):
    code, said, out = released("--with-solutions=integrators")
    assert code == 0, said
    files, worked = files_in(out), (SOLUTIONS / "integrators.py").read_text()
    assert files["solutions/integrators.py"] == re.sub(r"^ *### (BEGIN|END) SOLUTION.*\n", "", worked, flags=re.M)
    for path in ("lessons/integrators.py", "solutions/springs.py"):
        assert "NotImplementedError" in files[path]
    assert "from solutions.integrators import" in files["lessons/springs.py"]


def test_with_solutions_alone_releases_them_all(released):
    files = files_in(released("--with-solutions")[2])
    assert not any("NotImplementedError(\"Exercise" in files[f"solutions/{name}.py"] for name in lesson_names())
    assert "--of=lessons" not in files["pyproject.toml"]


def test_a_single_lesson_comes_with_its_scenes_and_what_it_builds_on(released, tmp_path):
    zipped = released("--lesson", "integrators")[2]
    shutil.unpack_archive(zipped, tmp_path)
    program = "from validate.subject.modules import bind; print(bind('integrators', 'lessons'))"
    run = program_in(tmp_path / "workbook", program,
                     lessons=tmp_path / "workbook" / "lessons")
    assert "integrators" in run.stdout, run.stderr                  # nothing that is given needs a lesson left out
    files = files_in(zipped)
    scene, notebook = "validate/scenes/integrators/oscillator.py", "notebooks/00_start_here.ipynb"
    assert files.keys() >= {"lessons/integrators.py", scene, notebook}
    assert not [name for name in files if "spring" in name]
    files = files_in(released("--lesson", "springs")[2])
    assert {"lessons/integrators.py", "lessons/springs.py", "validate/scenes/springs/spring_net.py"} <= files.keys()


@pytest.mark.parametrize(("arguments", "named"), [
    (["--with-solutions=springs"], "integrators"),
    (["--lesson", "integrators", "--with-solutions=integrators,springs"], "springs"),
    (["--lesson", "juggling"], "juggling"),
    (["--with-solutions=juggling"], "juggling"),
])
def test_inconsistent_options_are_refused_in_one_sentence(released, arguments, named):
    code, said, out = released(*arguments)
    assert code == 2 and named in said and len(said.strip().splitlines()) == 1 and not out.exists()


def test_a_file_that_is_not_a_zip_is_never_overwritten(released, tmp_path):
    thesis = tmp_path / "thesis.txt"
    thesis.write_text("years of work")
    code, said, _ = released(out=thesis)
    assert code == 2 and "thesis.txt" in said and thesis.read_text() == "years of work"


def test_changes_that_are_not_committed_are_refused(released, repository, planted):
    planted("LICENSE", "\nchanged\n")
    code, said, out = released()
    assert code == 2 and "LICENSE" in said and "--dirty" in said and not out.exists()
    assert released("--dirty")[0] == 0


# ---------------------------------------------------------------------------------------------- leaks

@pytest.fixture
def planted(repository):
    """planted(path, text) appends a text to a file and stages it; the repository is reset afterwards."""
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
    """The answer of an exercise in the solutions, without its indentation."""
    for name in lesson_names():
        for match in generate.ANSWER.finditer((SOLUTIONS / f"{name}.py").read_text()):
            if match["exercise"] == exercise:
                return textwrap.dedent("".join(match[0].splitlines(keepends=True)[1:-1]))
    raise LookupError(exercise)


def function(name, body):
    return f"\n\ndef {name}(*_):\n{textwrap.indent(body, '    ')}"


def reformatted(body):
    """The same statements with other quotes, brackets and spaces."""
    return ast.unparse(ast.parse(body)).replace(", ", ",").replace(" + ", "+  ")


def refused(released, *named):
    code, said, out = released("--dirty")
    assert code == 2 and len(said.strip().splitlines()) == 1 and all(name in said for name in named), said
    assert not out.exists() and not list(out.parent.iterdir())
    return True


def in_a_lambda(body):
    return f"\nstep = lambda acceleration, t, x, v, dt, p: ({body.removeprefix('return ')})"


def in_a_loop(body):
    return function("run", "for _ in range(3):\n" + textwrap.indent(body, "    "))


def in_a_comment(body):
    return "\n" + textwrap.indent(body, "# ")


def in_a_fence(body):
    return f"\n```python\n{reformatted(body)}\n```\n"


def in_html(body):
    return "<pre>\n" + body.replace("<", "&lt;").replace(">", "&gt;") + "</pre>"


SCENE = "validate/scenes/integrators/throw.py"
MOST_OF_2_12 = "\n".join(body_of("2.12").splitlines()[2:])
LEAKS = {  # path, text, a part of the message
    "marker": ("docs/page.md", "Look for ### BEGIN SOLUTION 1.2 in the file.", "BEGIN SOLUTION"),
    "scene": (SCENE, function("half_way", reformatted(body_of("1.2"))), "1.2"),
    "lambda": (SCENE, in_a_lambda(body_of("1.1")), "1.1"),
    "trivial body under its name": (SCENE, function("air_force", body_of("2.2")), "2.2"),
    "inside a loop": ("validate/stability.py", in_a_loop(body_of("2.7")), "2.7"),
    "comment": ("validate/stability.py", in_a_comment(body_of("2.11")), "2.11"),
    "string": ("validate/report/words.py", f"\nHELP = {body_of('1.10')!r}\n", "1.10"),
    "most of it in a test": ("tests/lessons/test_springs.py", function("reference", MOST_OF_2_12), "2.12"),
    "fence": ("docs/students.md", in_a_fence(body_of("1.3")), "1.3"),
    "inline code": ("docs/page.md", f"The answer: `{body_of('2.9').strip()}`", "2.9"),
    "html": ("docs/page.html", in_html(body_of("1.7")), "1.7"),
    "recording": ("validate/recorded/throw.json", None, "1.8"),
    "compiled code": ("docs/integrators.cpython-311.pyc", b"\xa7\r\r\n\x00", "pyc"),
}


@pytest.mark.parametrize(("path", "text", "named"), LEAKS.values(), ids=LEAKS)
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
        lines = function("mine", answer).splitlines(keepends=True)
        notebook["cells"][-1] = {"cell_type": "code", "source": ["%matplotlib inline\n", *lines]}
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
            telling = max(answer.pieces.values(), default=0) >= release.TELLING
            assert release.holds(comment, answer) or not telling, answer.exercise


# ---------------------------------------------------------------------------------------------- the unpacked zip

def test_the_tests_run_in_the_zip_and_score_nothing(unpacked):
    said = run_in(unpacked, "pytest", "--of=lessons", "--tb=no", "-p", "no:cacheprovider").stdout
    assert re.search(r"^all: 0 of " + str(20 * len(lesson_names())), said, re.M), said


def test_the_command_line_lists_the_scenes_and_reports_that_worked_answers_are_missing(unpacked):
    assert "oscillator" in run_in(unpacked, "validate", "list").stdout
    asked = run_in(unpacked, "validate", "--scene", "oscillator")
    assert asked.returncode == 2 and len(asked.stderr.strip().splitlines()) == 1
    assert "without worked answers of integrators" in asked.stderr


@pytest.mark.parametrize(("name", "checks"), [("00_start_here", {"1.1"}), ("01_integrators", {"1.10"})])
def test_a_notebook_runs_in_the_zip_and_names_the_answers_it_lacks(unpacked, monkeypatch, name, checks):
    monkeypatch.setenv("PYTHONPATH", str(unpacked))
    monkeypatch.delenv("WORKBOOK_LESSONS", raising=False)
    notebook = nbformat.read(unpacked / "notebooks" / f"{name}.ipynb", as_version=4)
    asked = {cell.source for cell in notebook.cells if cell.source.startswith("check(")}
    chosen = {f'check("{number}")' for number in checks}
    assert chosen <= asked
    cells = [cell.source for cell in notebook.cells if cell.cell_type == "code"]
    with kernel(unpacked / "notebooks") as client:
        said = "".join(ran(client, source) for source in cells if source not in asked - chosen)
    stands_in = "Your own functions stand in for the worked answers of integrators" in said
    assert stands_in == any("answers(" in cell for cell in cells)
    assert "This first picture was made beforehand" in said and "data-picture" in said
    opening = said.partition("made beforehand")[0]
    assert not re.search(r"Exercise [\d.]+: \w+: not attempted yet, so it is not drawn", opening)
    assert all(f"Exercise {number}: not attempted" in said for number in checks)


def test_the_students_answers_replace_the_worked_ones(unpacked, tmp_path):
    for name in lesson_names():
        (tmp_path / f"{name}.py").write_text(solved(name))
    program = """
        import numpy as np
        from validate.notebook import answers, attempt
        integrators, springs = answers("integrators"), answers("springs")
        x, pairs = np.array([[0.0, 0.0], [1.0, 0.0]]), springs.grid_pairs(1, 2, springs.STRUCTURAL)
        mesh = springs.make_spring_network(x, 1.0, (0,), pairs, 1.0, 0.0, [0.0, -1.0], [0.0, 0.0], 0.0)
        print(springs.mass_spring_damper_step(0.0, x, 0.0 * x, 2.0, mesh)[1][1])
        friction = answers("friction")
        block = friction.make_block([0.0, 1.0], 0.5, 0.4, [0.0, -9.81], [0.0, 0.0], 0.0)
        print(friction.event_step(friction.driven_acceleration, 0.0, np.zeros(2), np.zeros(2), 0.1, block)[0])
        print(attempt(lambda: answers("juggling").catch))
    """
    with open(tmp_path / "friction.py", "a") as file:               # event_step is given in the companion and calls it
        file.write("\n\ndef advance_to_event(acceleration, t, x, v, dt, p):\n    return dt, x + 42.0, v\n")
    run = program_in(unpacked, program, lessons=tmp_path)
    assert "[ 0. -2.]" in run.stdout and "[42. 42.]" in run.stdout, run.stderr
    assert run.stdout.strip().endswith("None"), run.stderr


def test_a_students_file_that_cannot_be_loaded_leaves_the_given_functions(unpacked, tmp_path):
    (tmp_path / "integrators.py").write_text("def euler_step(:\n")
    program = """
        from validate.notebook import answers, attempt
        worked = answers("integrators")
        print(worked.Oscillator(2.0, 0.0).omega, worked.advance.__name__, attempt(worked.euler_step))
    """
    run = program_in(unpacked, program, lessons=tmp_path)
    assert "2.0 advance None" in run.stdout, run.stderr


def test_a_lesson_is_checked_even_if_a_lesson_that_it_imports_does_not_load(unpacked, tmp_path):
    for name in lesson_names():
        (tmp_path / f"{name}.py").write_text(solved(name))
    (tmp_path / "integrators.py").write_text("def euler_step(:\n")
    exercises = "--exercise=2.7", "--exercise=2.9", "--exercise=7.1"
    said = run_in(unpacked, "pytest", f"--of={tmp_path}", "--tb=line", "-p", "no:cacheprovider", *exercises).stdout
    for line in (r"^ +2\.7  (\d)", r"^ +7\.1  1 of 1$", r"^ +2\.9  0 of"):
        assert re.search(line, said, re.M), said
    assert "integrators.py cannot be loaded: SyntaxError: invalid syntax (integrators.py, line 1)" in said


# ---------------------------------------------------------------------------------------------- reference curves

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
notebook.display, notebook.show_figure, plt.show, space = lambda *_: None, shown, shown, {}
for cell in nbformat.read(sys.argv[1], as_version=4).cells:
    skipped = re.search("^check|^show_(?!figure)|measured\\\\(|interact|ablations", cell.source, re.M)
    if cell.cell_type == "code" and not skipped:
        exec(cell.source, space)
print(json.dumps(found))
"""


def truths(copy, notebook, lessons):
    """Return {cell and label: numbers} of every curve that a notebook labels as true, for a student's lessons."""
    run = program_in(copy, TRUTHS, str(copy / "notebooks" / notebook), lessons=lessons)
    assert run.returncode == 0, run.stderr
    return json.loads(run.stdout.splitlines()[-1])


@pytest.mark.parametrize(("notebook", "least"), [("01_integrators.ipynb", 5), ("02_springs.ipynb", 3)])
def test_reference_curves_of_a_notebook_do_not_use_the_students_functions(unpacked, tmp_path, notebook, least):
    """Functions that are all off by a hundredth give the same reference curves as right ones."""
    for folder in ("right", "wrong"):
        (tmp_path / folder).mkdir()
    for name in lesson_names():
        answered = generate.exercises((SOLUTIONS / f"{name}.py").read_text())
        (tmp_path / "right" / f"{name}.py").write_text(solved(name))
        (tmp_path / "wrong" / f"{name}.py").write_text(solved(name) + WRONG.format(names=tuple(answered.values())))
    wrong, right = (truths(unpacked, notebook, tmp_path / folder) for folder in ("wrong", "right"))
    assert len(wrong) >= least and wrong == right
    for name, places in wrong.items():
        if name.endswith("07-2b95ab truth"):                          # the distances to Kepler's foci sum to 2 m
            distances = [np.hypot(*p) + np.hypot(p[0] + 1.2, p[1]) for p in places]
            assert np.allclose(distances, 2.0, rtol=1e-12)
