"""The notebooks run from first cell to last with nothing attempted, half done and solved; stored without outputs."""

import copy
import json
import re
import tempfile

import nbformat
import pytest
import zmq
from nbclient import NotebookClient
from traitlets.config import Config

from validate.binding import ROOT, SOLUTIONS, lesson_names
from validate.generate import exercises, stub

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


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_to_its_end_and_its_checks_say_the_state(path, tmp_path):
    """One kernel, as at a student's desk: run from first cell to last, write more of the lessons, forget every name, run again."""
    cells, ran = nbformat.read(path, as_version=4).cells, nbformat.v4.new_notebook()
    for state, solved in ((state, answered(state)) for state in STATES):
        for name in lesson_names():
            (tmp_path / state).mkdir(exist_ok=True)
            (tmp_path / state / f"{name}.py").write_text(stub((SOLUTIONS / f"{name}.py").read_text(), solved[name]))
        ran.cells += [nbformat.v4.new_code_cell(f"%reset -f\n%env WORKBOOK_LESSONS={tmp_path / state}"), *copy.deepcopy(cells)]
    with tempfile.TemporaryDirectory() as place:                      # two kernels that start together may choose the same port, but not the same file
        sockets = Config(KernelManager={"transport": "ipc", "ip": f"{place}/kernel"}) if zmq.has("ipc") else Config()
        NotebookClient(ran, config=sockets, timeout=300, kernel_name="python3", resources={"metadata": {"path": ROOT / "notebooks"}}).execute()
    for number, state in enumerate(STATES):
        every = set().union(*answered(state).values())
        for cell in ran.cells[1 + number * (1 + len(cells)):][:len(cells)]:
            asked = re.match(r'check\("([\d.]+)"\)', cell.source) if cell.cell_type == "code" else None
            if asked:
                said = json.dumps([dict(output) for output in cell.outputs], ensure_ascii=False)
                state_of = "passed" if asked[1] in every else "not attempted"
                assert f"Exercise {asked[1]}: {state_of}" in said, f"{state}: {said}"
