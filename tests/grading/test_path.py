"""The grader never imports a file of the class folder, under any name that a student gives it."""

import os
import subprocess
import sys

import pytest

from validate.grading import sandbox
from validate.subject.modules import ROOT

from .test_cli import grade, run

CANARY = """
import os
with open({canary!r}, "a") as file:
    file.write(__name__ + chr(10))
raise ImportError("a student's file ran outside the sandbox")
"""
POOL = """
import os, sys
sys.path[:] = [p for p in sys.path if p] + [{root!r}]
from validate.grading import children
if __name__ == "__main__":
    with children.Pool(2, int) as pool:
        print([pool.submit(abs, -n).result() for n in range(4)])
    with children.reader() as child:
        print(child(abs, -5, patience=60.0))
"""


@pytest.fixture
def hostile(tmp_path):
    """A class folder with a module for every name of Python's library and of the grader; and the canary."""
    names = {*sys.stdlib_module_names, "sitecustomize", "usercustomize", "numpy", "pytest", "typer", "solutions",
             "validate", "tests", "lessons"}
    (tmp_path / "class").mkdir()
    for name in names - {"__main__"}:
        (tmp_path / "class" / f"{name}.py").write_text(CANARY.format(canary=str(tmp_path / "canary")))
    return tmp_path


def started(code, folder, **more):
    return subprocess.run([sys.executable, *code], cwd=folder, capture_output=True, text=True, timeout=600.0,
                          env={**os.environ, **more})


def test_processes_of_the_grader_import_nothing_from_the_working_directory(hostile):
    """The main process is a script that lies elsewhere, as `grade` is: its path has no working directory."""
    (hostile / "main.py").write_text(POOL.format(root=str(ROOT)))
    done = started([str(hostile / "main.py")], hostile / "class", PYTHONSAFEPATH="")
    assert done.stdout.split() == ["[0,", "1,", "2,", "3]", "5"] and not (hostile / "canary").exists(), done.stderr


def test_the_canary_sings_where_the_working_directory_is_on_the_path(hostile):
    done = started(["-c", "import colorsys"], hostile / "class", PYTHONSAFEPATH="")
    assert done.returncode != 0 and (hostile / "canary").exists()


@pytest.mark.parametrize("below", ["", "ada"])
def test_a_class_folder_on_the_path_is_refused(below, tmp_path, monkeypatch, capsys):
    sandbox.for_tests(pytest.skip, pytest.fail)
    (tmp_path / "ada").mkdir()
    monkeypatch.syspath_prepend(tmp_path / below)
    code, _, error = run(capsys, grade, tmp_path, "--out", tmp_path.parent / "out")
    assert code == 2 and "where Python looks for modules" in error
    assert len(error.splitlines()) == 1 and not (tmp_path.parent / "out").exists()


@pytest.mark.long
def test_a_class_is_graded_from_inside_its_folder(hostile):
    """As `grade .` does it: one honest student among folders with the names of Python's modules."""
    sandbox.for_tests(pytest.skip, pytest.fail)
    from validate.grading.example import worked
    for path in (hostile / "class").glob("*.py"):
        folder = path.with_suffix("")
        folder.mkdir()
        path.rename(folder / "__init__.py")
    (hostile / "class" / "ada").mkdir()
    (hostile / "class" / "ada" / "integrators.py").write_text(worked("integrators"))
    script = hostile / "grade"
    script.write_text(f"import sys\nsys.path.append({str(ROOT)!r})\n"
                      "from validate.grading.__main__ import main\nif __name__ == '__main__':\n    main()\n")
    done = started([str(script), ".", "--out", str(hostile / "out"), "--lesson", "integrators", "--seed", "a secret"],
                   hostile / "class", PYTHONSAFEPATH="")
    rows = (hostile / "out" / "grades.csv").read_text().splitlines()
    assert done.returncode == 0 and not (hostile / "canary").exists(), done.stderr
    assert [row for row in rows if ",ada," in row and ",20," in row]
