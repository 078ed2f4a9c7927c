"""The notebooks run from first cell to last with nothing attempted, half done and solved; stored without outputs."""

import json
import os
import re

import nbformat
import pytest
from nbclient import NotebookClient

from validate.binding import ROOT, SOLUTIONS, lesson_names
from validate.generate import exercises, stub

pytestmark = pytest.mark.xdist_group("notebooks")        # one kernel at a time: two that start together may choose the same port

NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
STATES = {"nothing attempted": 0.0, "half done": 0.5, "solved": 1.0}          # share of the exercises, from the first on


def answered(state):
    """{lesson: exercises that are solved in that state}."""
    every = {name: list(exercises((SOLUTIONS / f"{name}.py").read_text())) for name in lesson_names()}
    return {name: set(numbers[:round(STATES[state] * len(numbers))]) for name, numbers in every.items()}


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_stored_without_outputs(path):
    for cell in nbformat.read(path, as_version=4).cells:
        assert cell.cell_type != "code" or (not cell.outputs and cell.execution_count is None)


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_to_its_end_and_its_checks_say_the_state(path, state, tmp_path, monkeypatch):
    solved = answered(state)
    for name in lesson_names():
        (tmp_path / f"{name}.py").write_text(stub((SOLUTIONS / f"{name}.py").read_text(), solved[name]))
    monkeypatch.setenv("WORKBOOK_LESSONS", str(tmp_path))
    notebook = nbformat.read(path, as_version=4)
    NotebookClient(notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": ROOT / "notebooks"}}).execute()
    every = set().union(*solved.values())
    for cell in notebook.cells:
        asked = re.match(r'check\("([\d.]+)"\)', cell.source) if cell.cell_type == "code" else None
        if asked:
            said = json.dumps([dict(output) for output in cell.outputs], ensure_ascii=False)
            state_of = "passed" if asked[1] in every else "not attempted"
            assert f"Exercise {asked[1]}: {state_of}" in said, said
