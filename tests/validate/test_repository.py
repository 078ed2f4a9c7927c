"""What must hold of the repository itself."""

import ast
import contextlib
import functools
import io
import re
import sys
import tomllib
from hashlib import sha256

import pytest

from validate.engines.products import PRODUCTS
from validate.grading.plugin import part_of
from validate.subject.modules import ROOT, SOLUTIONS, lesson_names, scene_files


def test_the_lock_names_only_the_public_index():
    hosts = set(re.findall(r"https?://([^/\"]+)", (ROOT / "uv.lock").read_text()))
    assert hosts <= {"pypi.org", "files.pythonhosted.org"}
    assert "://" not in (ROOT / "constraints.txt").read_text()


def test_both_locks_hold_the_same_versions():
    locked = {(p["name"], p["version"]) for p in tomllib.loads((ROOT / "uv.lock").read_text())["package"]
              if "registry" in p["source"]}
    pinned = set(re.findall(r"^([\w.-]+)==([^ ;\n]+)", (ROOT / "constraints.txt").read_text(), flags=re.M))
    assert pinned <= locked and len({n for n, _ in pinned}) >= 100


def test_solutions_import_nothing_but_numpy_typing_and_their_siblings():
    for path in SOLUTIONS.rglob("*.py"):
        for line in path.read_text().splitlines():
            if re.match(r"(import|from) ", line):
                assert re.match(r"import numpy as np$|from typing import NamedTuple$|from \.[\w.]+ import ",
                                line), f"{path.name}: {line}"


def test_every_lesson_has_its_notebook_tests_mutants_and_scenes():
    from validate.subject import modules
    for name in modules.lesson_names():
        assert list((ROOT / "notebooks").glob(f"*_{name}.ipynb")), name
        assert (ROOT / "tests" / "lessons" / f"test_{name}.py").is_file()
        assert (ROOT / "tests" / "mutants" / f"{name}.py").is_file()
        assert any(modules.bind_scene(s).lesson == name for s in modules.scene_names())


def test_the_player_in_space_was_built_from_its_source_and_can_stand_inside_a_page():
    folder = ROOT / "validate" / "report"
    bundle = (folder / "player3d.js").read_text()
    sources = (folder / "player3d" / "source.js").read_bytes() + (folder / "player.js").read_bytes()
    assert sha256(sources).hexdigest()[:16] in bundle.splitlines()[0]
    assert "</script" not in bundle and "SPDX-License-Identifier: MIT" in bundle


def test_no_text_names_a_lesson_that_there_is_not():
    from validate.subject import modules
    texts = [(SOLUTIONS / f"{name}.py").read_text() for name in modules.lesson_names()]
    there = {int(re.match(r'"""Lesson (\d+)', text)[1]) for text in texts}
    assert there == set(range(1, len(there) + 1))
    folders = (SOLUTIONS, ROOT / "validate", ROOT / "notebooks", ROOT / "docs", ROOT / "tests")
    files = [ROOT / "README.md", ROOT / "CONTRIBUTING.md"]
    files += [path for folder in folders for path in folder.rglob("*")
              if path.suffix in (".py", ".md", ".ipynb", ".html")]
    for path in files:
        text = path.read_text(encoding="utf-8")
        known = there | {int(number) for number in re.findall(r'^"""Lesson (\d+)', text, re.M)}      # its own example
        for named in re.findall(r"\blessons? (\d+(?:(?:, | and | to |–)\d+)*)", text, re.I):
            assert {int(number) for number in re.findall(r"\d+", named)} <= known, f"{path}: lesson {named}"


def test_every_file_of_the_given_code_that_a_student_reads_of_is_there():
    for path in [*SOLUTIONS.rglob("*.py"), *(ROOT / "notebooks").glob("*.ipynb")]:
        for named in re.findall(r"\b(?:solutions|support|given)/[\w/]+\.py", path.read_text(encoding="utf-8")):
            assert (ROOT / named).exists() or (SOLUTIONS / named).exists(), f"{path}: {named}"


def test_the_readme_shows_what_its_example_prints():
    text = (ROOT / "README.md").read_text()
    code, printed = re.search(r"<!-- example -->\n```python\n(.*?)```\n\n```\n(.*?)```", text, re.S).groups()
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        exec(code, {})
    assert said.getvalue() == printed


def test_no_grading_test_and_no_answer_needs_an_index_of_64_bits():
    """In WebAssembly an index has 32 bits, and np.bincount refuses the 64 bits of our pairs and contacts."""
    for path in (*SOLUTIONS.rglob("*.py"), *(ROOT / "tests" / "lessons").glob("*.py")):
        for call in re.findall(r"np\.bincount\(.*", path.read_text()):
            assert "astype(np.intp)" in call, f"{path.name}: {call}"


def modules_of(*tops):
    """{dotted name: path} of the modules in these folders."""
    paths = [path for top in tops for path in (ROOT / top).rglob("*.py")]
    names = [path.relative_to(ROOT).with_suffix("").parts for path in paths]
    return {".".join(parts[:-1] if parts[-1] == "__init__" else parts): path
            for parts, path in zip(names, paths, strict=True)}


reads_sources = pytest.mark.xdist_group("sources")       # read and parsed once for all of these tests


@functools.cache
def parsed(path):
    """The syntax tree of a file."""
    return ast.parse(path.read_text(encoding="utf-8"))


def imports_of(name, path, known):
    """The modules among the known ones that a module imports, also inside of functions."""
    package = name.split(".") if path.name == "__init__.py" else name.split(".")[:-1]
    for node in ast.walk(parsed(path)):
        if isinstance(node, ast.ImportFrom):
            base = package[:len(package) + 1 - node.level] if node.level else []
            home = ".".join([*base, *filter(None, [node.module])])
            for alias in node.names:
                whole = f"{home}.{alias.name}"
                yield whole if whole in known else home
        elif isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)


def order_of_validate():
    """[{part, …}, …]: the lines of the list in CONTRIBUTING, from what imports nothing to what imports all."""
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    block = re.search(r"in the order in which data flows:\n\n```\n(.*?)```", text, re.S)[1]
    named = [line.split("   ")[0].split() for line in block.splitlines()]
    return [{f"validate.{part.removesuffix('.py').strip('/').replace('/', '.')}" for part in parts} for parts in named]


@reads_sources
def test_no_import_runs_upwards_in_the_order_that_contributing_gives():
    lines = order_of_validate()
    known = modules_of("validate")

    def line_of(name):
        """The line with the longest part of this name."""
        found = [(len(part), k) for k, parts in enumerate(lines) for part in parts
                 if name == part or name.startswith(f"{part}.")]
        assert found, f"{name} is not in CONTRIBUTING's list"
        return max(found)[1]

    for name in known.keys() - {"validate"}:
        for other in set(imports_of(name, known[name], known)) & known.keys() - {"validate"}:
            assert line_of(other) <= line_of(name), f"{name} imports {other}, which stands below it"


@reads_sources
def test_scenes_and_stability_cases_import_no_others_and_no_report_and_a_reference_no_solution():
    known = modules_of("validate", "solutions")
    scenes = {f"validate.scenes.{path.parent.name}.{name}" for name, path in scene_files().items()}
    cases = {name for name in known if name.startswith("validate.stability.")}

    def imported(name):
        return {other for other in imports_of(name, known[name], known) if other in known} - {name}
    for name in known:
        others = imported(name)
        if name.startswith("validate.reference"):
            assert not [other for other in others if other.startswith("solutions")], name
        if name.startswith(("validate.scenes", "validate.stability")):
            assert not [other for other in others if other.startswith("validate.report")], name
            assert not others & scenes, f"{name} imports the scene {others & scenes}"
        if name.startswith("validate.scenes"):
            assert not others & cases, f"{name} imports the case {others & cases}"


@reads_sources
def test_a_lesson_imports_only_earlier_lessons_and_given_code_that_calls_no_later_one():
    known = modules_of("solutions")
    imported = {name: set(imports_of(name, path, known)) & known.keys() for name, path in known.items()}
    place = {f"solutions.{name}": k for k, name in enumerate(lesson_names())}

    def reached(name):
        found, waiting = set(), [name]
        while waiting:
            new = imported[waiting.pop()] - found
            found |= new
            waiting += new
        return found

    for name in known:
        lessons = reached(name) & place.keys()
        assert not (name.startswith("solutions.support") and lessons), f"{name} imports {lessons}"
        if name in place:
            assert all(place[other] < place[name] for other in lessons), f"{name} imports {lessons}"


def test_few_files_lie_at_the_root_of_validate():
    files = {path.name for path in (ROOT / "validate").glob("*.py")}
    assert files == {"__init__.py", "__main__.py", "check.py", "methods.py", "scene.py"}


OTHER_NAMES = {              # of distributions that are not called like their module
    "PIL": "pillow", "_pytest": "pytest", "jupyter_client": "jupyter-client", "mujoco": "mujoco-core",
    "pybullet_utils": "pybullet", "pyodide": "jupyterlite-pyodide-kernel", "pyodide_js": "jupyterlite-pyodide-kernel",
    "sphinxcontrib": "sphinxcontrib-katex", "xdist": "pytest-xdist", "yaml": "pyyaml",
    "zmq": "pyzmq"}
BESIDE_THE_WORKER = {"shipping", "wire"}     # files that the sandbox holds beside grading/worker.py


def test_every_engine_of_the_report_belongs_to_the_default_installation():
    """So the published report has them, and newer Pythons have a live engine in space."""
    default = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]["validate"]
    assert {product.distribution for product in PRODUCTS} <= {re.match(r"[\w.-]+", one)[0] for one in default}


@reads_sources
def test_every_package_that_is_imported_is_declared():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    named = [*project["dependencies"], *(one for extra in project["optional-dependencies"].values() for one in extra)]
    declared = {re.match(r"[\w.-]+", one)[0].lower() for one in named}
    known = modules_of("solutions", "validate", "tests")
    own = {"solutions", "validate", "tests", "lessons"}
    for name, path in known.items():
        if "attacks" in name:                                # programs that a student might hand in
            continue
        tops = {other.partition(".")[0] for other in imports_of(name, path, known)} - {""}
        for top in tops - own - BESIDE_THE_WORKER - sys.stdlib_module_names:
            assert OTHER_NAMES.get(top, top).lower() in declared, f"{name} imports {top}"


LONGEST_BODY = 40            # lines of a function, without its docstring: about a screen


@reads_sources
def test_no_function_is_longer_than_a_screen():
    for name, path in modules_of("solutions", "validate", "tests").items():
        for node in ast.walk(parsed(path)):
            if isinstance(node, ast.FunctionDef):
                body = node.body[ast.get_docstring(node) is not None:]
                long = body and body[-1].end_lineno - body[0].lineno + 1 > LONGEST_BODY
                assert not long, f"{name}.{node.name} has more than {LONGEST_BODY} lines"


NOT_IN_CI = {                    # files with long tests, and why CI does not run those
    "tests/attacks/test_watch.py": "each of its copies is compared with a class; the attacks themselves are run",
    "tests/grading/test_cluster.py": "it starts a scheduler of Dask and its workers",
    "tests/grading/test_scale.py": "it grades a class of two hundred",
    "tests/validate/test_agreement.py": "it refines the dominoes for minutes",
    "tests/validate/test_book.py": "it executes all notebooks; CI builds the book with one of them",
    "tests/validate/test_cluster.py": "it starts a scheduler of Dask and its workers",
    "tests/validate/test_hosted.py": "it installs the workbook twice, as Binder and Colab do",
    "tests/validate/test_live_canvas.py": "it needs Chromium",
    "tests/validate/test_live_kernel.py": "it needs Chromium",
    "tests/validate/test_live_page.py": "it needs Chromium",
    "tests/validate/test_live_site.py": "it needs Chromium and Pyodide",
    "tests/validate/test_workflow.py": "it runs the workflow that publishes the book, and needs Chromium and Pyodide",
    "tests/validate/test_worlds.py": "it compiles the loops of all models, which takes minutes",
    "tests/validate/test_worlds_in_space.py": "it compiles the loops of all models, which takes minutes",
}


def test_every_file_with_long_tests_is_run_by_ci_or_has_a_reason():
    ci = (ROOT / ".ci" / "run").read_text().partition("part=")[2]
    marked = "mark." + "long", "list(" + "wrong_functions"
    files = {path.relative_to(ROOT).as_posix() for path in (ROOT / "tests").rglob("test_*.py")
             if any(one in path.read_text() for one in marked)}
    assert {file for file in files if file not in ci} == NOT_IN_CI.keys()


def test_commits_in_a_row_run_all_parts_of_the_long_tests():
    text = (ROOT / ".ci" / "run").read_text()
    parts = int(re.search(r"^parts=(\d+)$", text, re.M)[1])
    assert text.count('part="--part=$(git rev-list --count HEAD)/$parts"') == 1
    run = {part_of(f"{commits}/{parts}") for commits in range(1000, 1000 + parts)}
    assert run == {(k, parts) for k in range(parts)}
    long = [line for line in text.splitlines() if line.startswith(".venv/bin/pytest --long")]
    assert [line for line in long if '"$part"' not in line] == [
        ".venv/bin/pytest --long tests/validate/test_book.py -k one_notebook",
        ".venv/bin/pytest --long $whole -n 2 --dist loadgroup"]
