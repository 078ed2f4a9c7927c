"""The JupyterLite site: the students' notebooks and lessons, their workbook as one archive, and Pyodide beside them."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from ...grading import release
from ...subject import modules
from . import pyodide, workbook_live

LOADED = ("pytest", "iniconfig", "pluggy", "jinja2", "markupsafe",   # by the tests
          "ipywidgets", "jupyterlab_widgets", "anywidget", "psygnal", "typing_extensions")     # by live scenes
ELSEWHERE = re.compile(r"docs/|uv\.lock|constraints\.txt|notebooks/.*\.ipynb"        # on the drive or in the book
                       r"|validate/stability/")                                     # of the command `validate` alone
APPS = "lab", "notebooks", "edit", "tree"                            # the last three are for narrow screens
KERNEL = "@jupyterlite/pyodide-kernel-extension:kernel"
SAVED_WITHIN = 5                                                     # seconds after an edit: a reload loses no more
SETTINGS = {
    "@jupyterlab/docmanager-extension:plugin": {"autosaveInterval": SAVED_WITHIN},
    "@jupyterlab/notebook-extension:tracker": {"autoStartDefaultKernel": True},     # there is one: do not ask
    "@jupyterlab/apputils-extension:notification": {"fetchNews": "false", "checkForUpdates": False},
}
ABOUT = """This notebook runs in your browser. Nothing is installed, and nothing is sent anywhere.

1. Run the next cell. The first time it loads about 40 MB, which takes up to a minute.
2. Open [lessons/{lesson}.py](../lessons/{lesson}.py), write a function, save the file (Ctrl-S, or wait for 5 s),
   and run its check here.
3. To hand in, or to keep a copy, run `workbook_live.download()` in a new cell. `workbook_live.bring_back()` puts such
   a copy in place of your files."""
FIRST_CELL = "import workbook_live\n\nawait workbook_live.start()"


def build(place, out):
    """Write the site into an empty folder.  `place` is a Pyodide; raises BadInput if it is another one."""
    files, python = students(), pyodide.interpreter()
    with TemporaryDirectory() as scratch:
        scratch = Path(scratch)
        pyodide.take(place, scratch / "lite" / "static" / "pyodide", python)
        drive(files, scratch / "content")
        jupyterlite(scratch, out)
    packages = {path: data for name in LOADED for path, data in pyodide.installed(name).items()}
    packages = {f"packages/{path}": data for path, data in
                pyodide.compiled(packages, python, documented=False, place=workbook_live.TREE / "packages").items()}
    unused = unraced(files)
    tree = {f"{release.TOP}/{path}": data for path, data in files.items()
            if not ELSEWHERE.match(path) and path not in unused}
    pyodide.pack(out / "static" / "workbook.zip", tree | packages)
    configure(out / "jupyter-lite.json")


def students():
    """Return {path: bytes} of what students get: no answer.  Raises BadInput if an answer would leak."""
    lessons = set(modules.lesson_names())
    files = release.contents(release.tracked(dirty=True), lessons, set())
    release.refuse_leaks(files, set())
    return files


def unraced(files):
    """Return the paths of the recorded runs of those scenes that no notebook names."""
    named = "".join(data.decode() for path, data in files.items() if path.endswith(".ipynb"))
    words = set(re.findall(r"\w+", named))
    return {path for path in files if re.match(r"validate/recorded/\w+\.json$", path) and Path(path).stem not in words}


def drive(files, folder):
    """Write what JupyterLab shows: the notebooks, each with a first cell that unpacks the workbook, and the lessons."""
    for part in ("notebooks", "lessons"):
        (folder / part).mkdir(parents=True)
    for path, data in files.items():
        if path.startswith("lessons/"):
            (folder / path).write_bytes(data)
        elif re.match(r"notebooks/\d\d_\w+\.ipynb", path):
            text = json.dumps(with_first_cell(json.loads(data), Path(path).stem[3:]), ensure_ascii=False, indent=1)
            (folder / path).write_text(text, encoding="utf-8")


def with_first_cell(notebook, lesson):
    """Return a notebook that begins with how to work in a browser, and with the cell that unpacks the workbook."""
    lesson = lesson if lesson in modules.lesson_names() else "integrators"
    title, *rest = notebook["cells"]
    about = {"cell_type": "markdown", "id": "live-about", "metadata": {}, "source": ABOUT.format(lesson=lesson)}
    first = {"cell_type": "code", "id": "live-start", "metadata": {}, "source": FIRST_CELL, "outputs": [],
             "execution_count": None}
    kernel = {"kernelspec": {"display_name": "Python (Pyodide)", "language": "python", "name": "python"}}
    return notebook | {"cells": [title, about, first, *rest], "metadata": notebook["metadata"] | kernel}


def jupyterlite(scratch, out):
    """Run the build of JupyterLite.  Raises RuntimeError if it fails."""
    command = [sys.executable, "-m", "jupyterlite_core.app", "build", "--lite-dir", scratch / "lite", "--contents",
               scratch / "content", "--output-dir", out.resolve(), "--no-sourcemaps", "--no-unused-shared-packages"]
    command += [word for app in APPS for word in ("--apps", app)]
    run = subprocess.run(list(map(str, command)), cwd=scratch, capture_output=True, text=True,
                         env={**os.environ, "SOURCE_DATE_EPOCH": "315532800"})
    if run.returncode or not (out / "lab" / "index.html").is_file():
        raise RuntimeError(f"jupyterlite failed:\n{run.stdout[-2000:]}{run.stderr[-2000:]}")


def configure(file):
    """Let the kernel load its packages together, let it ask no package index, and let JupyterLab save often."""
    config = json.loads(file.read_text(encoding="utf-8"))
    config["jupyter-config-data"]["settingsOverrides"] = SETTINGS
    settings = config["jupyter-config-data"].setdefault("litePluginSettings", {}).setdefault(KERNEL, {})
    settings["disablePyPIFallback"] = True
    settings["loadPyodideOptions"] = {"packages": list(pyodide.FIRST)}
    file.write_text(json.dumps(config, indent=1), encoding="utf-8")
