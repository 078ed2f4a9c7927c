"""Two copies of the workbook and one environment; and a system without processes, as in a browser."""

import os
import re
import shutil
import subprocess
import sys

import nbformat
import pytest

from validate import notebook
from validate.subject import copies, generate
from validate.subject.modules import ROOT, SOLUTIONS

SHOW = """
import validate, validate.notebook as notebook, solutions
shown = []
notebook.display = lambda thing: shown.append(repr(thing))
notebook.check("1.1")
print(validate.__file__, solutions.__file__, *shown, sep="\\n")
"""
NO_PROCESSES = """
import sys
sys.modules.update({name: None for name in ("_multiprocessing", "concurrent.futures.process")})
"""


@pytest.fixture(scope="module")
def other(tmp_path_factory):
    """Another copy of the workbook, in which exercise 1.1 and all others of its lesson are solved."""
    folder = tmp_path_factory.mktemp("other")
    unused = shutil.ignore_patterns("__pycache__", "recorded", "book", "player3d", "attacks", "mutants", "faults")
    for name in ("lessons", "solutions", "tests", "validate"):
        shutil.copytree(ROOT / name, folder / name, ignore=unused)
    shutil.copy(ROOT / "pyproject.toml", folder)
    (folder / "notebooks").mkdir()
    text = (SOLUTIONS / "integrators.py").read_text()
    (folder / "lessons" / "integrators.py").write_text(generate.stub(text, generate.exercises(text)))
    return folder


def program(folder, text, *path):
    """What a Python program prints in a folder, in the environment that this copy is installed in."""
    environment = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "WORKBOOK_LESSONS")}
    code = "\n".join([*(f"import sys; sys.path.insert(0, {str(place)!r})" for place in path), text])
    run = subprocess.run([sys.executable, "-P", "-c", code], cwd=folder, capture_output=True, text=True,
                         env=environment)
    assert run.returncode == 0, run.stderr
    return run.stdout


@pytest.mark.long
def test_a_notebook_uses_the_copy_in_which_it_lies(other):
    said = program(other / "notebooks", SHOW)
    assert f"{other}/validate" in said and f"{other}/solutions" in said and str(ROOT) not in said
    assert "Exercise 1.1: passed" in said and "tested" not in said


@pytest.mark.parametrize("path", sorted((ROOT / "notebooks").glob("*.ipynb")), ids=lambda path: path.stem)
def test_a_notebook_imports_validate_first_which_finds_the_copy(path):
    cells = [cell.source for cell in nbformat.read(path, as_version=4).cells if cell.cell_type == "code"]
    imported = re.findall(r"^(?:from|import) (lessons|solutions|tests|validate)\b", "\n".join(cells), re.M)
    assert imported[0] == "validate"


@pytest.mark.long
def test_a_notebook_of_this_copy_uses_this_one(other):
    said = program(ROOT / "notebooks", SHOW)
    assert f"{ROOT}/validate" in said and "Exercise 1.1: not attempted" in said and "tested" not in said


def test_a_check_runs_where_its_notebook_was_told_to_look_and_says_which_folder_it_has_tested(other, tmp_path):
    """A copy that is on the path of this process alone: the process of the check uses it, too."""
    said = program(tmp_path, SHOW, other)
    assert "Exercise 1.1: passed" in said and f"tested     {other / 'lessons'}" in said


@pytest.mark.long
def test_the_command_tests_the_lessons_of_the_copy_in_which_it_runs(other, tmp_path):
    script = os.path.join(os.path.dirname(sys.executable), "pytest")
    command = [script, "--of=lessons", "--exercise=1.1", "-p", "no:cacheprovider"]
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    run = subprocess.run(command, cwd=other, capture_output=True, text=True, env=environment)
    assert "1.1  1 of 1" in run.stdout, run.stdout + run.stderr


def test_lessons_are_those_of_the_copy_around_the_working_folder(other, monkeypatch):
    monkeypatch.delenv("WORKBOOK_LESSONS", raising=False)
    monkeypatch.chdir(other / "notebooks")
    assert copies.meant_here("lessons") == str(other / "lessons") and copies.meant_here("solutions") == "solutions"
    assert copies.doubtful(ROOT / "lessons") == str(ROOT / "lessons")
    monkeypatch.chdir(ROOT / "notebooks")
    assert copies.meant_here("lessons") == "lessons" and copies.doubtful(ROOT / "lessons") == ""
    monkeypatch.setenv("WORKBOOK_LESSONS", str(other / "lessons"))
    assert copies.doubtful(other / "lessons") == ""


def test_the_folder_that_was_tested_stands_at_the_end():
    passed = [{"status": "passed", "points": 1.0}]
    assert repr(notebook._Answer("1.1", passed, folder="/home/ada/lessons")).endswith("tested     /home/ada/lessons")
    assert "/home/ada" in notebook._Answer("1.1", passed, folder="/home/ada/lessons")._repr_html_()


# ---------------------------------------------------------------------------------------------- without processes

def test_a_second_check_without_processes_reads_the_file_anew(other, tmp_path):
    lessons = shutil.copytree(other / "lessons", tmp_path / "lessons")
    later = f"""
from pathlib import Path
file = Path({str(lessons / "integrators.py")!r})
text = file.read_text()
file.write_text("def euler_step(:")
notebook.check("1.1")
file.write_text(text)
notebook.check("1.1")
notebook.check("1.2")
print(*shown[1:], sep="\\n")
"""
    begin = f"import os; os.environ['WORKBOOK_LESSONS'] = {str(lessons)!r}"
    said = program(tmp_path, begin + NO_PROCESSES + SHOW + later, other)
    assert said.count("Exercise 1.1: passed") == 2 and said.count("Exercise 1.1: not yet") == 1
    assert "Exercise 1.2: passed" in said


@pytest.mark.long
def test_the_grading_tests_are_collected_where_there_are_no_processes():
    code = NO_PROCESSES + """
import pytest
sys.exit(pytest.main(["tests", "--of=solutions", "--exercise=1.1", "-p", "no:cacheprovider"]))
"""
    said = program(ROOT, f"import sys; sys.path.insert(0, {str(ROOT)!r})\n{code}")
    assert "1.1  1 of 1" in said
