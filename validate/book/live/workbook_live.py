"""What a notebook in the browser does first, and how its files leave the browser.  Runs in Pyodide, not here.

The workbook lies in one archive beside the site and is unpacked into memory.  JupyterLab's own folder of files, the
drive, has only what students see and change: reading it costs a request per file.
"""

import base64
import io
import logging
import os
import sys
import time
import zipfile
from html import escape
from pathlib import Path
from urllib.parse import urljoin

TREE, LESSONS = Path("/workbook"), Path("/drive/lessons")
ARCHIVE = "../workbook.zip"                                          # from Pyodide's own folder
RUNNING = Path("/drive/.running")                                    # the cell that runs; a kernel that hangs leaves it
OLDER = Path("/drive/older")                                         # lessons that `bring_back` has replaced
REPORT = "../../../validation.html"                                  # from Pyodide's own folder, in the book
PAGES = "../../../notebooks/"                                        # the same of its executed notebooks
READY = ("The workbook is ready ({seconds:.0f} s). Edit and save the files in <code>lessons/</code>. They stay in this "
         "browser, also when you reload the page.<br>If a cell never ends, restart the kernel (<b>⟳</b>, above the "
         "notebook) and run this cell again. Your files are kept.<br>Here your code runs as plain Python, and "
         "pybullet's runs are recorded ones; compiled code, pymunk and MuJoCo need the workbook on your computer. "
         'Their stored results are in <a href="{report}" target="_blank">the report</a>.')
STOPPED = ("When the kernel ended the last time, the cell that begins with <code>{}</code> was still running. "
           "If it had hung, look for a loop that never ends in the functions that it calls.")
NONE_THERE = "There is no file of a lesson in {}: choose a lessons.zip, or a file such as integrators.py."
BROUGHT = ("Brought back: {}. What stood there before is in {}. If one of these files is open, close its tab without "
           "saving, and open it again.")


async def start():
    """Unpack the workbook, and say what is different in a browser."""
    from IPython import get_ipython
    from IPython.display import HTML, display
    from pyodide.http import pyfetch
    began = time.monotonic()
    if not TREE.exists():
        response = await pyfetch(f"{place_of_pyodide()}{ARCHIVE}")
        unpack(await response.bytes())
        watch(get_ipython())
    os.environ["WORKBOOK_LESSONS"] = str(LESSONS)
    os.environ["WORKBOOK_PAGES"] = urljoin(place_of_pyodide(), PAGES)
    logging.getLogger("matplotlib.font_manager").setLevel(logging.ERROR)      # a new font cache is no warning
    import validate.notebook  # noqa: F401  here, so that the first picture does not take all the time
    ready = READY.format(seconds=time.monotonic() - began, report=urljoin(place_of_pyodide(), REPORT))
    display(HTML(f"<p>{ready}</p>{left_over()}"))


def watch(shell, mark=RUNNING):
    """Keep the first line of each cell until the cell has ended."""
    def begins(about):
        lines = about.raw_cell.strip().splitlines()
        if lines and "await " not in about.raw_cell:                 # of such a cell IPython does not tell the end
            mark.write_text(lines[0], encoding="utf-8")
    shell.events.register("pre_run_cell", begins)
    shell.events.register("post_run_cell", lambda result: mark.unlink(missing_ok=True))


def left_over(mark=RUNNING):
    """Return the sentence about a cell that had not ended when its kernel was restarted, as HTML; "" if all had."""
    if not mark.exists():
        return ""
    line = mark.read_text(encoding="utf-8")
    mark.unlink()
    return f"<p><b>{STOPPED.format(escape(line))}</b></p>"


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
    data, files = base64.b64encode(packed(folder)).decode(), len(lessons_in(folder))
    display(HTML(f'<a download="lessons.zip" href="data:application/zip;base64,{data}"><b>Download lessons.zip</b></a>'
                 f" ({files} files, as saved just now)"))


def lessons_in(folder):
    """Return the files of your lessons."""
    return sorted(Path(folder).glob("*.py"))


def packed(folder):
    """Return the bytes of a zip of your lessons."""
    zipped = io.BytesIO()
    with zipfile.ZipFile(zipped, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in lessons_in(folder):
            archive.writestr(f"lessons/{file.name}", file.read_bytes())
    return zipped.getvalue()


def bring_back(folder=LESSONS, older=OLDER):
    """Show a button that takes a lessons.zip, or the file of a lesson, and puts it in place of yours."""
    from IPython.display import display
    from ipywidgets import HTML, FileUpload, VBox
    chooser, said = FileUpload(accept=".zip,.py", description="Choose a file"), HTML()

    def chosen(change):
        for file in change["new"]:
            said.value = escape(put_back(file["name"], bytes(file["content"]), folder, older))
    chooser.observe(chosen, "value")
    display(VBox([chooser, said]))


def put_back(name, data, folder, older):
    """Write the lessons of a zip, or of one file, and keep what they replace; return the sentence about it."""
    files = {name: data}
    if name.endswith(".zip"):
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            files = {Path(path).name: archive.read(path) for path in archive.namelist()}
    files = {one: text for one, text in files.items() if one.endswith(".py") and (Path(folder) / one).exists()}
    if not files:
        return NONE_THERE.format(name)
    kept = Path(older) / time.strftime("lessons-%Y-%m-%d-%H%M%S.zip")
    kept.parent.mkdir(parents=True, exist_ok=True)
    kept.write_bytes(packed(folder))
    for one, text in files.items():
        (Path(folder) / one).write_bytes(text)
    return BROUGHT.format(", ".join(sorted(files)), f"{kept.parent.name}/{kept.name}")
