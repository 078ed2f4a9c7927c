"""lessons/ is what solutions/ gives, and nothing of the answers is in it."""

import ast
import re
import shutil

import pytest

from solutions.checks import BadInput
from validate.subject import generate
from validate.subject.modules import ROOT, SOLUTIONS


def test_lessons_are_what_the_solutions_give():
    assert generate.differing() == [], "run python -m validate.subject.generate"


def test_every_exercise_raises_its_number_and_name_and_no_marker_leaks():
    for name, text in generate.lessons().items():
        assert "SOLUTION" not in text
        if name != "__init__.py":
            for number, function in generate.exercises((SOLUTIONS / name).read_text()).items():
                assert f'raise NotImplementedError("Exercise {number}: {function}")' in text


def test_a_check_from_another_file_is_named_with_its_arguments():
    """A student sees the docstring of the exercise, and not the file of the check."""
    for path in SOLUTIONS.glob("*.py"):
        functions = [node for node in ast.parse(path.read_text()).body if isinstance(node, ast.FunctionDef)]
        here = {node.name for node in functions}
        for node in functions:
            doc, called = ast.get_docstring(node) or "", {n.id for n in ast.walk(node) if isinstance(n, ast.Name)}
            for name in {*re.findall(r"\bcheck_\w+", doc)} & called - here:
                assert f"{name}(" in doc, (path.name, node.name, name)


def test_no_line_of_an_answer_is_left_in_a_lesson():
    for path in SOLUTIONS.glob("*.py"):
        lesson, source = generate.lessons().get(path.name, "").splitlines(), path.read_text()
        given = generate.ANSWER.sub("", source).splitlines()                               # may use the same line
        for match in generate.ANSWER.finditer(source):
            for line in match[0].splitlines()[1:-1]:
                if len(line.strip()) > 20 and line not in given:
                    assert line not in lesson


def test_lessons_import_earlier_topics_from_the_solutions():
    for text in generate.lessons().values():
        assert not re.search(r"^from \.", text, flags=re.M)


def test_a_changed_file_is_noticed(tmp_path):
    folder = tmp_path / "lessons"
    shutil.copytree(ROOT / "lessons", folder, ignore=shutil.ignore_patterns("__pycache__"))
    (folder / "integrators.py").write_text((folder / "integrators.py").read_text() + "\n# mine\n")
    assert generate.differing(folder) == ["integrators.py"]
    assert generate.worked_in(folder) == []


def test_answers_of_a_student_are_overwritten_only_by_force(tmp_path, monkeypatch, capsys):
    mine = tmp_path / "integrators.py"
    mine.write_text(generate.stub((SOLUTIONS / "integrators.py").read_text(), solved={"1.1"}))
    before = mine.read_text()
    monkeypatch.setattr(generate, "LESSONS", tmp_path)
    assert generate.main([]) == 2 and "integrators.py" in capsys.readouterr().err
    assert mine.read_text() == before
    assert generate.main(["--force"]) == 0 and mine.read_text() != before
    assert generate.main(["--check"]) == 0


def test_an_unpaired_marker_is_refused():
    with pytest.raises(BadInput, match="marker"):
        generate.stub("def f():\n    ### BEGIN SOLUTION 1.1\n    return 1\n")
