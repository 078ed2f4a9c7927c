"""What Binder and Colab run, in fresh environments of this machine: their commands, and a notebook after them."""

import json
import os
import subprocess
import sys

import pytest

from validate.book import hosted
from validate.subject.modules import ROOT

pytestmark = pytest.mark.long
PICTURE = """import json
cells = json.load(open("01_integrators.ipynb"))["cells"]
exec("".join(next(cell for cell in cells if cell["cell_type"] == "code")["source"]))
"""
OF_COLAB = """import types
sys.modules["google"], sys.modules["google.colab"] = types.ModuleType("google"), types.ModuleType("google.colab")
sys.modules["google.colab"].drive = types.SimpleNamespace(mount=lambda place: None)
"""                          # what Colab has of its own


@pytest.fixture
def clone(tmp_path):
    """A clone of the workbook, as both services make it."""
    subprocess.run(["git", "clone", "-q", "--depth", "1", ROOT.as_uri(), tmp_path / "workbook"], check=True)
    return tmp_path / "workbook"


def environment(folder):
    """Make a Python without packages; return the environment in which it is `python`."""
    subprocess.run([sys.executable, "-m", "venv", folder], check=True)
    kept = {name: value for name, value in os.environ.items()
            if name not in ("VIRTUAL_ENV", "PYTHONPATH", "WORKBOOK_LESSONS")}
    return kept | {"PATH": f"{folder / 'bin'}:{os.environ['PATH']}", "MPLBACKEND": "agg"}


def run(command, folder, surroundings):
    return subprocess.run(command, cwd=folder, env=surroundings, check=True, capture_output=True, text=True).stdout


def test_binder_runs_its_command_and_draws_the_first_picture(clone, tmp_path):
    surroundings = environment(tmp_path / "own")
    run(["bash", "binder/postBuild"], clone, surroundings)
    assert run(["jupyter", "lab", "--version"], clone, surroundings)[0].isdigit()
    said = run(["python", "-c", PICTURE], clone / "notebooks", surroundings)
    assert "HTML object" in said


def as_script(source, place):
    """Return a cell as Python.  A line that begins with ! is a command, with {names} of the cell in it."""
    lines = [f"{line[:len(line) - len(line.lstrip())]}subprocess.run(f{line.lstrip()[1:]!r}, shell=True, check=True)"
             if line.lstrip().startswith("!") else line for line in source.replace("/content", str(place)).splitlines()]
    return "\n".join(lines)


def test_colab_runs_its_cells_and_a_notebook_in_the_drive_draws_its_first_picture(clone, tmp_path):
    """Colab has IPython.  The place of its machine and of the drive is a folder here; a second run keeps a lesson."""
    surroundings, place = environment(tmp_path / "own"), tmp_path / "content"
    place.mkdir()
    run(["python", "-m", "pip", "install", "-q", "ipython"], tmp_path, surroundings)
    first, second = ("".join(cell["source"]) for cell in json.loads((ROOT / hosted.COLAB).read_text())["cells"][1:])
    address = next(line for line in first.splitlines() if line.startswith("ADDRESS ="))
    cells = [as_script(first.replace(address, f"ADDRESS = {clone.as_uri()!r}"), place), as_script(second, place)]
    program = "import subprocess, sys\n" + OF_COLAB + "\n".join(cells)
    run(["python", "-c", program], tmp_path, surroundings)
    drive = place / "drive" / "MyDrive" / "physics-animation"
    (drive / "lessons" / "springs.py").write_text("mine")
    book = json.loads((drive / "01_integrators.ipynb").read_text(encoding="utf-8"))
    cells = [as_script("".join(cell["source"]), place) for cell in book["cells"] if cell["cell_type"] == "code"][:2]
    said = run(["python", "-c", "import subprocess, sys\n" + OF_COLAB + "\n".join(cells)], tmp_path, surroundings)
    assert "HTML object" in said and (drive / "lessons" / "springs.py").read_text() == "mine"
