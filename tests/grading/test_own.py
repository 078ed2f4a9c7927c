"""An instructor's own exercise, written as docs/grading.md shows it, is graded and handed out."""

import csv
import re
import subprocess
import sys
import zipfile

import pytest

from validate.grading import sandbox
from validate.subject import generate
from validate.subject.modules import ROOT

from .conftest import git

SHOWN = re.compile(r"^`(\S+\.py)`:\n\n```python\n(.*?)^```", re.M | re.S)
ANSWERS = {
    "ada": "",                                                         # the worked one
    "bob": "return v / (1.0 + k * t)",
    "cem": "raise NotImplementedError('Exercise 20.1: glide')",
}


@pytest.fixture(scope="module")
def files(repository):
    """The files of the documentation, added to a repository by its commands."""
    shown = dict(SHOWN.findall((ROOT / "docs" / "grading.md").read_text(encoding="utf-8")))
    assert {*shown} == {"solutions/gliding.py", "tests/lessons/test_gliding.py"}
    for path, text in shown.items():
        (repository / path).write_text(text, encoding="utf-8")
    subprocess.run([sys.executable, "-m", "validate.subject.generate"], cwd=repository, check=True)
    git("add", "solutions", "lessons", "tests", "validate", cwd=repository)
    git("commit", "--quiet", "--message", "A glider", cwd=repository)
    return shown


@pytest.mark.long
def test_its_points_go_to_right_answers_only(repository, files, tmp_path):
    sandbox.for_tests(pytest.skip, pytest.fail)
    worked = files["solutions/gliding.py"]
    for student, answer in ANSWERS.items():
        (tmp_path / "class" / student).mkdir(parents=True)
        text = generate.ANSWER.sub(f"    {answer}\n", worked) if answer else generate.stub(worked, ["20.1"])
        (tmp_path / "class" / student / "gliding.py").write_text(text)
    command = [sys.executable, "-m", "validate.grading", tmp_path / "class", "--out", tmp_path / "grades"]
    run = subprocess.run([*command, "--exercises", "20.1=5"], cwd=repository, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout + run.stderr
    with open(tmp_path / "grades" / "grades.csv", newline="") as file:
        rows = {row["student_id"]: (row["score"], row["max_score"]) for row in csv.DictReader(file)}
    assert rows == {"ada": ("5", "5"), "bob": ("0", "5"), "cem": ("0", "5")}


@pytest.mark.long
def test_students_get_it_without_its_answer(repository, files, tmp_path):
    command = [sys.executable, "-m", "validate.grading.release", "--out", tmp_path / "workbook.zip"]
    subprocess.run(command, cwd=repository, check=True)
    with zipfile.ZipFile(tmp_path / "workbook.zip") as archive:
        lesson = archive.read("workbook/lessons/gliding.py").decode()
        assert "Exercise 20.1: glide" in lesson and "np.exp" not in lesson
        assert archive.read("workbook/tests/lessons/test_gliding.py").decode() == files["tests/lessons/test_gliding.py"]
