"""The workbook on Google Colab, which opens one notebook alone and forgets its machine after hours.

`binder/colab.ipynb` fetches the repository and calls `lay_out`.  The notebooks that it writes into your Drive fetch it
again, and your lessons lie beside them.  The versions are Colab's own where they are new enough, because its notebooks
stop working with another ipykernel.
"""

import json
import shutil
from pathlib import Path

from ..subject.modules import ROOT

FETCH = """# Fetch the workbook, which takes about a minute on a new machine.  Your lessons lie in your Drive.
import os
import sys

if not os.path.isdir("/content/workbook"):
    !git clone -q --depth 1 {address} /content/workbook
    !pip install -q "/content/workbook[validate]" "pytest>=8.4,<9.2" "anywidget>=0.9.18"
from google.colab import drive

drive.mount("/content/drive")
os.environ["WORKBOOK_LESSONS"] = "{folder}/lessons"
sys.path.insert(0, "/content/workbook")
os.chdir("/content/workbook/notebooks")"""


def lay_out(folder, address):
    """Write the notebooks, each with a first cell that fetches the workbook, and the lessons that are not there yet."""
    folder = Path(folder)
    (folder / "lessons").mkdir(parents=True, exist_ok=True)
    for file in sorted((ROOT / "lessons").glob("*.py")):
        if not (folder / "lessons" / file.name).exists():            # what is there is yours
            shutil.copy(file, folder / "lessons")
    for file in sorted((ROOT / "notebooks").glob("[0-9]*.ipynb")):
        book = json.loads(file.read_text(encoding="utf-8"))
        first = {"cell_type": "code", "id": "colab-fetch", "metadata": {}, "outputs": [], "execution_count": None,
                 "source": FETCH.format(address=address, folder=folder)}
        book["cells"].insert(1, first)
        (folder / file.name).write_text(json.dumps(book, ensure_ascii=False, indent=1), encoding="utf-8")
