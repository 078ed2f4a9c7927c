"""What a notebook in the browser does first, and how its files leave the browser.  Runs in Pyodide, not here.

The workbook lies in one archive beside the site and is unpacked into memory.  JupyterLab's own folder of files, the
drive, has only what students see and change: reading it costs a request per file.
"""

import base64
import io
import os
import sys
import time
import zipfile
from pathlib import Path

TREE, LESSONS = Path("/workbook"), Path("/drive/lessons")
ARCHIVE = "../workbook.zip"                                          # from Pyodide's own folder
READY = ("The workbook is ready ({:.0f} s). Edit and save the files in <code>lessons/</code>. They stay in this "
         "browser, also when you reload the page.<br>If a cell never ends, restart the kernel (<b>⟳</b>, above the "
         "notebook) and run this cell again. Your files are kept.<br>Here your code runs as plain Python. Compiled "
         "code and live engines need the workbook on your computer; recorded runs of the engines stand in.")


async def start():
    """Unpack the workbook, and say what is different in a browser."""
    from IPython.display import HTML, display
    from pyodide.http import pyfetch
    began = time.monotonic()
    if not TREE.exists():
        response = await pyfetch(f"{place_of_pyodide()}{ARCHIVE}")
        unpack(await response.bytes())
    os.environ["WORKBOOK_LESSONS"] = str(LESSONS)
    import validate.notebook  # noqa: F401  here, so that the first picture does not take all the time
    display(HTML(f"<p>{READY.format(time.monotonic() - began)}</p>"))


def place_of_pyodide():
    """Return the address of the folder from which this Pyodide was loaded, with its last slash."""
    import pyodide_js
    return pyodide_js._api.config.indexURL


def unpack(archive):
    """Lay the workbook and the packages of its tests where Python finds them."""
    with zipfile.ZipFile(io.BytesIO(archive)) as packed:
        packed.extractall(TREE)
    sys.path[:0] = [str(TREE / "workbook"), str(TREE / "packages")]


def download(folder=LESSONS):
    """Show a link that downloads your lessons as lessons.zip, which you can hand in."""
    from IPython.display import HTML, display
    packed, files = io.BytesIO(), sorted(Path(folder).glob("*.py"))
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in files:
            archive.writestr(f"lessons/{file.name}", file.read_bytes())
    data = base64.b64encode(packed.getvalue()).decode()
    display(HTML(f'<a download="lessons.zip" href="data:application/zip;base64,{data}"><b>Download lessons.zip</b></a>'
                 f" ({len(files)} files, as saved just now)"))
