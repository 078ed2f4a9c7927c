"""The lessons in the reader's browser: what is taken from Pyodide, and a student's first hour in a real browser.

The long tests need a Pyodide or a built site: `WORKBOOK_PYODIDE=pyodide-0.27.7.tar.bz2` or `WORKBOOK_LIVE=book/live`,
and a Chromium (`WORKBOOK_CHROMIUM`, or one on the path, or the one that playwright installs).
"""

import ast
import base64
import gzip
import io
import json
import os
import re
import shutil
import subprocess
import sys
import threading
import time
import tomllib
import types
import zipfile
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from importlib.machinery import SourcelessFileLoader
from pathlib import Path
from typing import ClassVar

import psutil
import pytest
from IPython.core.interactiveshell import ExecutionInfo, InteractiveShell

from solutions.checks import BadInput
from validate import notebook
from validate.book import hosted, plan
from validate.book.live import pyodide, site, workbook_live
from validate.notebook import colab
from validate.subject import generate, loading, modules
from validate.subject.modules import ROOT

MOST = 40.0                  # before the first check, as a server sends it that compresses text [MB]
TEXT = ".js", ".json", ".css", ".html", ".svg", ".ipynb", ".py", ".mjs"     # what such a server compresses
LONGEST = 600_000            # until a page shows what it should, there [ms]
PATIENCE = 900               # until a cell has ended, on a machine that does other things as well [s]
LINK = re.compile(r'href="([^"]+)"')


# ---------------------------------------------------------------------------------------------- without a browser

def test_every_package_that_one_needs_is_there_with_its_digest():
    packages = pyodide.WANTED["packages"]
    for name, one in packages.items():
        assert {needed.replace("_", "-") for needed in one["depends"]} <= packages.keys(), name
        assert one["version"] in one["file_name"] and "imports" in one
    assert all(re.fullmatch("[0-9a-f]{64}", digest) for digest in pyodide.files().values())
    assert set(pyodide.FIRST) <= {*packages, *pyodide.ABSENT, *pyodide.INSTALLED, "workbook-live"}


def test_no_part_of_scipy_is_left_out_that_a_lesson_imports():
    imported = set()
    for folder in ("validate", "tests/lessons", "solutions"):
        for path in (ROOT / folder).rglob("*.py"):
            imported |= set(re.findall(r"^\s*(?:from|import) (scipy\.[\w.]+)", path.read_text(encoding="utf-8"), re.M))
    paths = [f"{name.replace('.', '/')}/__init__.py" for name in imported]
    assert len(paths) >= 6 and not [path for path in paths if re.match(pyodide.UNUSED["scipy"], path)]


def pretend(folder, content):
    """A Pyodide whose files hold their own names, and its digests."""
    for name in pyodide.files():
        (folder / name).write_bytes(content(name))
    (folder / "pyodide-lock.json").write_text("{}")
    return folder


def test_another_pyodide_is_refused_with_the_name_of_its_file(tmp_path):
    with pytest.raises(BadInput, match=r"pyodide\.js is not the file of Pyodide 0\.27\.7"):
        pyodide.take(pretend(tmp_path, str.encode), tmp_path / "out")
    with pytest.raises(BadInput, match="no Pyodide"):
        pyodide.take(ROOT / "docs", tmp_path / "out2")
    (tmp_path / "broken.tar.bz2").write_text("no archive")
    with pytest.raises(BadInput, match="not readable"):
        pyodide.take(tmp_path / "broken.tar.bz2", tmp_path / "out3")


def small_wheel(name):
    """The bytes of a wheel with a file of each package that is left out, and one that is kept."""
    unused = {"scipy": "scipy/stats/x.py", "matplotlib": "matplotlib/testing/x.py",
              "pillow": "PIL/_webp.x.so", "pygments": "pygments/lexers/x.py", "ipython": "IPython/sphinxext/x.py",
              "python-dateutil": "dateutil/zoneinfo/x.py"}
    packed, paths = io.BytesIO(), [*unused.values(), "kept/x.py", "kept/x.pyx"]
    with zipfile.ZipFile(packed, "w") as archive:
        for path, text in (*zip(paths, paths, strict=True),
                           ("x.dist-info/RECORD", "".join(f"{path},,\n" for path in paths))):
            archive.writestr(zipfile.ZipInfo(path, pyodide.DATE), text)     # the time of day would change the bytes
    return packed.getvalue() if name.endswith((".whl", ".zip")) else name.encode()


def test_the_lock_of_what_is_taken_names_its_files_and_their_digests(tmp_path, monkeypatch):
    wanted = json.loads(json.dumps(pyodide.WANTED))
    for one in wanted["packages"].values():
        one["sha256"] = pyodide.sha256(small_wheel(one["file_name"]))
    wanted["files"] = {name: pyodide.sha256(small_wheel(name)) for name in wanted["files"]}
    monkeypatch.setattr(pyodide, "WANTED", wanted)
    (tmp_path / "in").mkdir()
    pyodide.take(pretend(tmp_path / "in", small_wheel), tmp_path / "out")
    lock = json.loads((tmp_path / "out" / "pyodide-lock.json").read_text())
    assert {*pyodide.FIRST} <= lock["packages"].keys()
    for name, one in lock["packages"].items():
        data = (tmp_path / "out" / one["file_name"]).read_bytes()
        assert pyodide.sha256(data) == one["sha256"], name
        if name in wanted["packages"]:
            with zipfile.ZipFile(io.BytesIO(data)) as archive:
                record = archive.read("x.dist-info/RECORD").decode().split(",,\n")[:-1]
                assert record == archive.namelist(), name
                assert len(record) == (7 if name in pyodide.UNUSED else 8) and "kept/x.py" in record, name
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        *wanted["files"], "pyodide-lock.json", *(one["file_name"] for one in lock["packages"].values())}


def test_the_standard_library_in_the_browser_has_what_a_page_can_use(tmp_path):
    """Not the modules of mail, servers, processes and old alphabets, which would be loaded in vain."""
    unused = "imaplib.py", "encodings/cp1250.py", "multiprocessing/pool.py", "asyncio/windows_utils.py"
    used = "image.py", "encodings/cp1252.py", "multiprocessing/__init__.py", "asyncio/events.py"
    with zipfile.ZipFile(tmp_path / "library.zip", "w") as archive:
        for path in (*unused, *used):
            archive.writestr(path, "")
    assert {*pyodide.kept(tmp_path / "library.zip", pyodide.LIBRARY)} == {*used}
    assert {*pyodide.kept(tmp_path / "library.zip", "numpy")} == {*used, *unused}


MODULE = b'''"""Text."""

from __future__ import annotations


def only_text(x):
    """Nothing else."""


class One:
    "Text."

    def fails(self):
        assert False
'''


@pytest.mark.parametrize("documented", [True, False])
def test_bytecode_stands_in_for_its_source(documented, tmp_path):
    content = {"one.py": MODULE, "two.txt": b"2", "old.py": b"print 1"}
    made = pyodide.compiled(content, sys.executable, documented, "/place")
    assert made.keys() == {"one.pyc", "two.txt", "old.py"} and made["old.py"] == content["old.py"]
    (tmp_path / "one.pyc").write_bytes(made["one.pyc"])
    one = types.ModuleType("one")
    SourcelessFileLoader("one", str(tmp_path / "one.pyc")).exec_module(one)
    assert one.only_text(1) is None
    assert [one.__doc__, one.only_text.__doc__, one.One.__doc__] == (
        ["Text.", "Nothing else.", "Text."] if documented else [None] * 3)
    with pytest.raises(AssertionError) as fault:
        one.One().fails()
    assert [(str(fault.traceback[-1].path), fault.traceback[-1].lineno + 1)] == [("/place/one.py", 14)]
    assert pyodide.compiled(content, None) is content


def test_packages_are_compiled_by_a_python_of_the_version_in_the_browser(monkeypatch):
    monkeypatch.setattr(pyodide, "PYTHON", f"{sys.version_info[0]}.{sys.version_info[1]}")
    assert pyodide.interpreter() == sys.executable
    monkeypatch.setattr(pyodide, "PYTHON", "3.1")
    assert pyodide.interpreter() is None


def test_the_site_has_the_recorded_runs_that_a_notebook_names():
    files = {"notebooks/01_x.ipynb": b'race("rope", 3)', "validate/recorded/rope.json": b"{}",
             "validate/recorded/rope_2.json": b"{}", "validate/recorded/agreement.py": b""}
    assert site.unraced(files) == {"validate/recorded/rope_2.json"}


def test_each_notebook_begins_with_the_cell_that_unpacks_the_workbook(tmp_path):
    files = {f"notebooks/{path.name}": path.read_bytes() for path in (ROOT / "notebooks").glob("*.ipynb")}
    files |= {f"lessons/{path.name}": path.read_bytes() for path in (ROOT / "lessons").glob("*.py")}
    site.drive(files | {"notebooks/openings.json": b"{}", "validate/check.py": b""}, tmp_path)
    there = {path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*") if path.is_file()}
    assert there == files.keys()
    for path in (tmp_path / "notebooks").iterdir():
        cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
        assert next(cell for cell in cells if cell["cell_type"] == "code")["source"] == site.FIRST_CELL
        named = re.search(r"\.\./lessons/(\w+)\.py", cells[1]["source"])[1]
        assert named == path.stem[3:] or path.stem == "00_start_here"
    tree = ast.parse((Path(site.__file__).parent / "workbook_live.py").read_text(encoding="utf-8"))
    assert "start" in {node.name for node in tree.body if isinstance(node, ast.AsyncFunctionDef)}


def test_the_lessons_can_be_downloaded_as_one_zip(tmp_path, monkeypatch):
    shown = []
    monkeypatch.setattr("IPython.display.display", lambda html: shown.append(html.data))
    (tmp_path / "springs.py").write_text("my answer")
    workbook_live.download(tmp_path)
    data = re.search(r'download="lessons.zip" href="data:application/zip;base64,([^"]+)"', shown[0])[1]
    with zipfile.ZipFile(io.BytesIO(base64.b64decode(data))) as archive:
        assert archive.read("lessons/springs.py") == b"my answer" and len(archive.namelist()) == 1


def zipped(**files):
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for name, text in files.items():
            archive.writestr(f"lessons/{name}.py", text)
    return packed.getvalue()


@pytest.mark.parametrize(("name", "data"), [("lessons.zip", zipped(springs="older", other="x")),
                                            ("springs.py", b"older")], ids=["a zip", "a file"])
def test_an_older_file_is_brought_back_and_what_it_replaces_is_kept(name, data, tmp_path):
    lessons = tmp_path / "lessons"
    lessons.mkdir()
    (lessons / "springs.py").write_text("newer")
    (lessons / "pbd.py").write_text("mine")
    said = workbook_live.put_back(name, data, lessons, tmp_path / "older")
    assert said.startswith("Brought back: springs.py. ")
    assert {file.name: file.read_text() for file in lessons.iterdir()} == {"springs.py": "older", "pbd.py": "mine"}
    kept, = (tmp_path / "older").iterdir()
    assert f"older/{kept.name}" in said
    with zipfile.ZipFile(kept) as archive:
        assert archive.read("lessons/springs.py") == b"newer" and archive.read("lessons/pbd.py") == b"mine"


@pytest.mark.parametrize(("name", "data"), [("lessons.zip", zipped(other="x")), ("notes.py", b"x"), ("a.txt", b"x")],
                         ids=["a zip", "another module", "a text"])
def test_a_file_that_is_no_lesson_replaces_nothing(name, data, tmp_path):
    (tmp_path / "springs.py").write_text("mine")
    said = workbook_live.put_back(name, data, tmp_path, tmp_path / "older")
    assert said.startswith(f"There is no file of a lesson in {name}") and not (tmp_path / "older").exists()


def test_a_cell_that_had_not_ended_is_named_after_a_restart(tmp_path):
    shell, mark = InteractiveShell(), tmp_path / "running"
    workbook_live.watch(shell, mark)
    shell.run_cell("x = 1")
    assert not mark.exists() and workbook_live.left_over(mark) == ""
    shell.events.trigger("pre_run_cell", ExecutionInfo("check('1.1') < 2\nx", False, False, True, "cell"))
    assert "<code>check(&#x27;1.1&#x27;) &lt; 2</code> was still running" in workbook_live.left_over(mark)
    assert workbook_live.left_over(mark) == ""


def forever():
    while True:
        abs(0)


def endless(inner, outer):
    """A loop without an end, inside of two alarms, in a function of its own as in a student's file."""
    with loading.alarm_at_jumps(outer), loading.alarm_at_jumps(inner):
        forever()


@pytest.mark.skipif(not hasattr(sys, "monitoring"), reason="sys.monitoring needs Python 3.12")
@pytest.mark.parametrize(("inner", "outer"), [(0.1, 30.0), (30.0, 0.1)])
def test_an_endless_loop_ends_where_there_is_no_alarm_clock(inner, outer):
    began = time.monotonic()
    with pytest.raises(loading.TooLong, match=r"after 0\.1 s"):
        endless(inner, outer)
    assert time.monotonic() - began < 10.0 and not sys.monitoring.get_events(loading.JUMPS)


def test_an_attempt_that_never_ends_is_one_sentence_in_a_browser(monkeypatch):
    """A kernel there cannot be interrupted."""
    shown = []
    monkeypatch.setattr(notebook, "display", lambda html: shown.append(html.data))
    monkeypatch.setattr(notebook, "BROWSER", True)
    monkeypatch.setattr(notebook, "LONGEST", 0.1)
    assert notebook.attempt(forever) is None
    assert "✗ Your code is still running after 0.1 s: look for a loop that never ends." in shown[0]


BROWSER = """
import sys
from pathlib import Path

import IPython, matplotlib.pyplot, pytest, scipy.integrate, scipy.optimize
here, sys.platform, sys.modules["_multiprocessing"] = sys.platform, "emscripten", None
from validate.notebook import check
sys.platform = here                  # Python 3.11 has no sys.monitoring for the alarm
file = Path(sys.argv[1], "integrators.py")
check("1.1")
file.write_text(file.read_text().replace('raise NotImplementedError("Exercise 1.1: euler_step")',
                                         "return x + dt * v, v + dt * acceleration(t, x, v, p)"))
check("1.1")
file.write_text(file.read_text().replace("return x + dt * v, v", "return x - dt * v, v"))
check("1.1")
"""


def test_a_check_needs_no_process_of_its_own_in_a_browser(tmp_path):
    for name, text in generate.lessons().items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    run = subprocess.run([sys.executable, "-c", BROWSER, tmp_path], cwd=ROOT, capture_output=True, text=True,
                         env={**os.environ, "WORKBOOK_LESSONS": str(tmp_path), "MPLBACKEND": "agg"})
    said = re.findall(r"Exercise 1\.1: (not attempted|passed|not yet)", run.stdout)
    assert said == ["not attempted", "passed", "not yet"], run.stdout + run.stderr


def test_buttons_lead_to_the_repository_or_are_left_out():
    here = hosted.buttons("09_contact", True, "")
    assert LINK.findall(here) == ["../live/lab/index.html?path=notebooks/09_contact.ipynb"]
    assert hosted.buttons("09_contact", False, "https://example.org/a/b") == ""
    links = LINK.findall(hosted.buttons("09_contact", False, "https://github.com/a/b"))
    assert links == ["https://mybinder.org/v2/gh/a/b/main?labpath=notebooks%2F09_contact.ipynb",
                     "https://colab.research.google.com/github/a/b/blob/main/binder/colab.ipynb"]
    assert (ROOT / hosted.COLAB).is_file() and (ROOT / "notebooks" / "09_contact.ipynb").is_file()


def test_readme_and_colab_have_the_address_that_citation_gives():
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert readme.split("<!-- hosted -->")[1].strip() == hosted.readme(plan.cited())
    cells = json.loads((ROOT / hosted.COLAB).read_text(encoding="utf-8"))["cells"]
    assert f'ADDRESS = "{plan.cited()}"' in "".join(cells[1]["source"])


def test_an_address_in_the_citation_makes_the_buttons_of_both_services(tmp_path, monkeypatch):
    """The address is made up.  Each notebook that a button opens is there, and Binder's own files are, too."""
    (tmp_path / "CITATION.cff").write_text("title: x\nrepository-code: \"https://github.com/made-up/workbook\"\n")
    monkeypatch.setattr(plan, "ROOT", tmp_path)
    for path in (ROOT / "notebooks").glob("[0-9]*.ipynb"):
        binder, on_colab = LINK.findall(hosted.buttons(path.stem, False, plan.repository()))
        assert binder == f"https://mybinder.org/v2/gh/made-up/workbook/main?labpath=notebooks%2F{path.name}"
        assert on_colab == "https://colab.research.google.com/github/made-up/workbook/blob/main/binder/colab.ipynb"
    assert "made-up/workbook" in hosted.readme(plan.cited()) and hosted.WAITING not in hosted.readme(plan.cited())


def test_binder_and_colab_install_what_the_notebooks_need():
    """Binder makes its Python from runtime.txt and then runs postBuild in the repository."""
    assert re.fullmatch(r"python-3\.\d+\n", (ROOT / "binder" / "runtime.txt").read_text())
    after = ROOT / "binder" / "postBuild"
    assert os.access(after, os.X_OK) and after.read_text().startswith("#!")
    needed = set(tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"])
    named = re.findall(r"\[(\w+)\]", after.read_text()) + re.findall(r"workbook\[(\w+)\]", colab.FETCH)
    assert named == ["student", "validate"] and set(named) <= needed
    cells = json.loads((ROOT / hosted.COLAB).read_text(encoding="utf-8"))["cells"]
    installs = re.compile(r"!pip install .*")
    fetched = installs.search("".join(cells[1]["source"]))[0]
    assert fetched == installs.search(colab.FETCH)[0] and "pytest" in fetched and "anywidget" in fetched


def test_colab_gets_every_notebook_with_its_first_cell_and_keeps_what_a_student_wrote(tmp_path):
    (tmp_path / "lessons").mkdir()
    (tmp_path / "lessons" / "springs.py").write_text("mine")
    colab.lay_out(tmp_path, "https://github.com/a/b")
    assert (tmp_path / "lessons" / "springs.py").read_text() == "mine"
    assert (tmp_path / "lessons" / "pbd.py").read_text() == (ROOT / "lessons" / "pbd.py").read_text()
    for path in (ROOT / "notebooks").glob("[0-9]*.ipynb"):
        cells = json.loads((tmp_path / path.name).read_text(encoding="utf-8"))["cells"]
        assert "git clone -q --depth 1 https://github.com/a/b /content/workbook" in cells[1]["source"]
        assert cells[2:] == json.loads(path.read_text(encoding="utf-8"))["cells"][1:]


# ---------------------------------------------------------------------------------------------- in a browser

class Counting(SimpleHTTPRequestHandler):
    """Serves a site, compresses text as web servers do, and counts what it sends."""

    sent: ClassVar[dict] = {}                    # {path: sizes of what was sent of it}

    def do_GET(self):
        file = Path(self.translate_path(self.path))
        if file.suffix not in TEXT or not file.is_file():
            self.sent.setdefault(file, []).append(file.stat().st_size if file.is_file() else 0)
            return super().do_GET()
        data = gzip.compress(file.read_bytes(), 6)
        self.sent.setdefault(file, []).append(len(data))
        self.send_response(200)
        for name, value in (("Content-Type", self.guess_type(file)), ("Content-Encoding", "gzip"),
                            ("Content-Length", str(len(data)))):
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(data)

    def log_message(self, *arguments):
        pass


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """The folder of a built site."""
    if "WORKBOOK_LIVE" in os.environ:
        return Path(os.environ["WORKBOOK_LIVE"]).resolve()
    if "WORKBOOK_PYODIDE" not in os.environ:
        pytest.skip("no Pyodide is given: set WORKBOOK_PYODIDE to its archive, or WORKBOOK_LIVE to a built site")
    out = tmp_path_factory.mktemp("live") / "live"
    site.build(Path(os.environ["WORKBOOK_PYODIDE"]), out)
    return out


@pytest.mark.long
def test_no_name_begins_with_a_dot(place):
    """GitHub's action for pages leaves such files out."""
    assert [path for path in place.rglob("*") if path.name.startswith(".")] == []


@pytest.fixture(scope="module")
def server(place):
    """(address of the host, path of the site on it): of the whole book, where the site lies in one."""
    Counting.sent = {}
    in_book = (place.parent / ".buildinfo").is_file()
    folder, path = (place.parent, f"/{place.name}") if in_book else (place, "")
    httpd = ThreadingHTTPServer(("127.0.0.1", 0), partial(Counting, directory=str(folder)))
    threading.Thread(target=httpd.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{httpd.server_address[1]}", path
    httpd.shutdown()
    httpd.server_close()


@pytest.fixture
def student(server):
    """A student with a new browser."""
    api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed: the extra `live` has it")
    with api.sync_playwright() as p:
        path = os.environ.get("WORKBOOK_CHROMIUM") or shutil.which("chromium")
        browser = p.chromium.launch(executable_path=path, args=["--no-sandbox", NO_OTHER_HOST])
        student = Student(browser.new_page(viewport={"width": 1440, "height": 900}), *server)
        yield student
        browser.close()
        assert student.outside == []


NO_OTHER_HOST = "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1"       # a request there fails, and is counted
FIND = """part => { const cells = jupyterapp.shell.currentWidget.content.model.cells;
  for (let k = 0; k < cells.length; k++)
    if (cells.get(k).type === "code" && cells.get(k).sharedModel.getSource().includes(part)) return k;
  return -1; }"""
RUN = """k => { const book = jupyterapp.shell.currentWidget.content; book.activeCellIndex = k;
  jupyterapp.commands.execute("notebook:run-cell"); }"""
STATE = """k => { const cell = jupyterapp.shell.currentWidget.content.model.cells.get(k);
  return [cell.executionState ?? cell.sharedModel.executionState, JSON.stringify(cell.outputs.toJSON())]; }"""
SAID = "document.querySelector('.live-scene .pace').textContent"
ADD = """text => { const book = jupyterapp.shell.currentWidget.content;
  book.model.sharedModel.insertCell(2, {cell_type: "code", source: text}); }"""


class Student:
    """What a student does with a page of the site, and what the page asks other hosts."""

    def __init__(self, page, server, path):
        self.page, self.server, self.path, self.outside = page, server, path, []
        page.context.on("request", self.watch)
        page.context.route("**/jupyter-lite.json*", self.expose)

    def watch(self, request):
        if not request.url.startswith((self.server, "data:", "blob:")):
            self.outside.append(request.url)

    def expose(self, route):
        """Give the test the program of the page, which has no other way to read outputs that are out of sight."""
        answer = route.fetch()
        config = answer.json()
        config["jupyter-config-data"]["exposeAppInBrowser"] = True
        route.fulfill(response=answer, json=config)

    def open(self, stem, app="lab"):
        """Open a lesson by the button on its page in the book; in a site without a book, by its address."""
        if self.path:
            self.page.goto(f"{self.server}/notebooks/{stem}.html", timeout=LONGEST)
            self.page.get_by_role("link", name="Open this lesson in your browser").first.click()
        else:
            self.page.goto(f"{self.server}/{app}/index.html?path=notebooks/{stem}.ipynb", timeout=LONGEST)
        self.page.wait_for_selector(".jp-Notebook .jp-Cell", timeout=LONGEST)
        if app == "lab":
            self.goes_back(stem)                 # JupyterLab shows last what was open before a reload
        self.page.wait_for_function("window.jupyterapp?.shell.currentWidget?.sessionContext?.session?.kernel",
                                    timeout=LONGEST)

    def starts(self, part):
        """Run the cell with that text; its place."""
        place = self.page.evaluate(FIND, part)
        assert place >= 0, part
        self.page.evaluate(RUN, place)
        return place

    def runs(self, part, until):
        """Run the cell with that text; what it shows, when that contains `until`."""
        place, began = self.starts(part), time.monotonic()
        while time.monotonic() - began < PATIENCE:
            time.sleep(0.3)
            _, shown = self.page.evaluate(STATE, place)
            if until in shown or '"output_type":"error"' in shown:
                break
        assert until in shown, f"{part!r} shows {shown[-1500:]}"
        return shown

    def writes(self, lesson, text):
        """Open a lesson from the link of its notebook, write that text, and save the file as students do."""
        self.page.evaluate("jupyterapp.shell.currentWidget.content.scrollToItem(1)")
        self.page.get_by_role("link", name=f"lessons/{lesson}.py").first.click(timeout=LONGEST)
        self.types(self.page, text)

    def has_written(self, lesson):
        """Put a solved lesson on the drive, by a cell of the notebook."""
        file, text = f"/drive/lessons/{lesson}.py", (modules.SOLUTIONS / f"{lesson}.py").read_text(encoding="utf-8")
        self.page.evaluate(ADD, f"print('written', open({file!r}, 'w').write({text!r}), {file!r})")
        self.runs(f", {file!r})", "written")

    def writes_on_a_phone(self, lesson, text):
        """Do the same where the file opens in a page of its own; it saves itself."""
        self.page.evaluate("jupyterapp.shell.currentWidget.content.scrollToItem(1)")
        with self.page.expect_popup(timeout=LONGEST) as opened:
            self.page.get_by_role("link", name=f"lessons/{lesson}.py").first.click(timeout=LONGEST)
        page = opened.value
        page.set_viewport_size(self.page.viewport_size)
        self.types(page, text, by_key=False)
        self.shows("phone-file", page)
        page.close()

    def types(self, page, text, by_key=True):
        editor = page.locator(".jp-FileEditor .cm-content")
        editor.click(timeout=LONGEST)
        page.keyboard.press("Control+a")
        page.keyboard.insert_text(text)
        if by_key:
            page.keyboard.press("Control+s")
        page.wait_for_function("!jupyterapp.shell.currentWidget.context.model.dirty", timeout=LONGEST)

    def shows(self, name, page=None):
        """Keep a picture of the page, if a folder for pictures is given."""
        if "WORKBOOK_PICTURES" in os.environ:
            (page or self.page).screenshot(path=Path(os.environ["WORKBOOK_PICTURES"]) / f"{name}.png")

    def waits(self, condition):
        """Wait until a live scene meets a condition on `scene` and its numbers `data`."""
        self.page.wait_for_function(f"""(() => {{ const scene = document.querySelector('.live-scene');
            if (!scene) return false; const data = scene.dataset; return {condition}; }})()""", timeout=LONGEST)

    def goes_back(self, stem):
        self.page.get_by_role("tab", name=f"{stem}.ipynb").click()


def processor_time():
    """Seconds that the browser has computed: on a busy machine the time by the clock says little."""
    browser = [one for one in psutil.Process().children(recursive=True) if "chrom" in one.name().lower()]
    return sum(sum(one.cpu_times()[:2]) for one in browser)


def solved(lesson, *exercises):
    """The text of a lesson in which a student has written these exercises."""
    return generate.stub((modules.SOLUTIONS / f"{lesson}.py").read_text(encoding="utf-8"), set(exercises))


FIRSTS = ("01_integrators", "1.1"), ("09_contact", "9.1"), ("12_sensitivities", "12.1")


@pytest.mark.long
@pytest.mark.parametrize(("stem", "exercise"), FIRSTS)
def test_a_student_with_nothing_but_a_browser_passes_an_exercise(student, stem, exercise, capsys):
    Counting.sent.clear()
    began, marks = time.monotonic(), {}
    student.open(stem)
    marks["notebook shown"] = time.monotonic() - began
    student.runs("workbook_live.start", "The workbook is ready")
    marks["workbook ready"] = time.monotonic() - began
    student.runs("from validate.notebook import", "<canvas")
    marks["first picture"] = time.monotonic() - began
    student.runs(f'check("{exercise}")', "not attempted")
    marks["first check"], spent = time.monotonic() - began, processor_time()
    stored = sum(len(sizes) * file.stat().st_size for file, sizes in Counting.sent.items() if file.is_file()) / 1e6
    sent, requests = sum(map(sum, Counting.sent.values())) / 1e6, sum(map(len, Counting.sent.values()))
    lesson = stem[3:]
    student.writes(lesson, solved(lesson, exercise))
    student.goes_back(stem)
    student.runs(f'check("{exercise}")', "passed")
    marks["passed"] = time.monotonic() - began
    with capsys.disabled():
        times = ", ".join(f"{name} {seconds:.1f} s" for name, seconds in marks.items())
        print(f"\n{stem}: {times}; before the first check {requests} requests, {sent:.1f} MB ({stored:.1f} on disk), "
              f"{spent:.1f} s of processor time at a load of {os.getloadavg()[0]:.1f}")
    assert sent < MOST


@pytest.mark.long
def test_a_reload_loses_nothing_and_an_endless_loop_can_be_stopped(student):
    student.open("01_integrators")
    student.runs("workbook_live.start", "The workbook is ready")
    student.writes("integrators", solved("integrators", "1.1"))
    student.page.keyboard.press("Control+End")
    student.page.keyboard.insert_text("\n# not saved by me\n")
    student.page.wait_for_function("!jupyterapp.shell.currentWidget.context.model.dirty", timeout=60_000)
    student.open("01_integrators")
    student.runs("workbook_live.start", "The workbook is ready")
    student.runs("from validate.notebook import", "<canvas")
    student.runs('check("1.1")', "passed")
    student.page.evaluate(ADD, "print(open('/drive/lessons/integrators.py').read()[-20:])")
    student.runs("print(open(", "not saved by me")
    student.page.evaluate(ADD, "while True:\n    pass")
    student.starts("while True")
    time.sleep(5.0)
    student.page.get_by_title(re.compile("Restart the kernel")).first.click()
    student.page.get_by_role("button", name="Confirm Kernel Restart").or_(
        student.page.locator(".jp-Dialog .jp-mod-warn")).first.click()
    said = student.runs("workbook_live.start", "The workbook is ready")
    assert "the cell that begins with <code>while True:</code> was still running" in said
    student.runs("from validate.notebook import", "<canvas")
    student.runs('check("1.1")', "passed")
    student.page.evaluate(ADD, "workbook_live.download()")
    student.runs("workbook_live.download()", "Download lessons.zip")
    with student.page.expect_download() as download:
        student.page.get_by_role("link", name="Download lessons.zip").click()
    with zipfile.ZipFile(download.value.path()) as archive:
        assert archive.read("lessons/integrators.py").decode().endswith("# not saved by me\n")
        assert len(archive.namelist()) == len(modules.lesson_names()) + 1
    student.writes("integrators", "# all is lost")
    student.goes_back("01_integrators")
    student.runs('check("1.1")', "not yet")
    student.page.evaluate(ADD, "workbook_live.bring_back()")
    student.runs("workbook_live.bring_back()", "widget-view")
    with student.page.expect_file_chooser(timeout=LONGEST) as chooser:
        student.page.get_by_role("button", name="Choose a file").click(timeout=LONGEST)
    chooser.value.set_files({"name": "lessons.zip", "mimeType": "application/zip",
                             "buffer": Path(download.value.path()).read_bytes()})
    student.page.get_by_text("Brought back:").wait_for(timeout=LONGEST)
    student.runs('check("1.1")', "passed")


@pytest.mark.long
def test_a_check_of_an_endless_loop_says_so_in_the_browser(student):
    text, line = solved("integrators", "1.1"), "    return x + dt * v"
    assert line in text
    student.open("01_integrators")
    student.runs("workbook_live.start", "The workbook is ready")
    student.runs("from validate.notebook import", "<canvas")
    student.writes("integrators", text.replace(line, f"    while True:\n        k = 0\n{line}", 1))
    student.goes_back("01_integrators")
    student.runs('check("1.1")', "an answer within")


@pytest.mark.long
def test_a_live_scene_runs_in_the_page_and_follows_a_save(student):
    """The arm of lesson 11: the pointer leads it, by the student's own method."""
    student.open("11_kinematics")
    student.runs("workbook_live.start", "The workbook is ready")
    student.writes("kinematics", solved("kinematics", "11.1", "11.2"))
    student.goes_back("11_kinematics")
    student.runs("from validate.notebook import", "<canvas")
    place = student.starts("live(arm_of")
    student.page.evaluate("k => jupyterapp.shell.currentWidget.content.scrollToItem(k)", place)
    student.waits("scene.querySelector('.say').textContent.includes('Not attempted yet: 11.11: damped_step')")
    student.writes("kinematics", solved("kinematics", "11.1", "11.2", "11.11"))
    student.goes_back("11_kinematics")
    student.page.evaluate("k => jupyterapp.shell.currentWidget.content.scrollToItem(k)", place)
    student.waits("data.t > 0.5 && data.energy < 0.05")
    box = student.page.locator(".live-scene canvas.stage").bounding_box()
    right, middle, high = box["x"] + 0.97 * box["width"], box["x"] + 0.4 * box["width"], box["y"] + 0.4 * box["height"]
    student.page.mouse.move(middle, high)
    student.page.mouse.move(right, high)                             # farther than the arm can reach
    student.page.mouse.down()
    student.waits("data.held === '4' && data.energy > 0.3")
    student.page.mouse.move(middle, high, steps=5)
    student.waits("data.held === '4' && data.energy < 0.05")
    student.page.mouse.up()
    student.shows("live-arm")


PULLED = {                   # {notebook: ({cell that its scene needs: what that shows}, its scene, its last point)}
    "02_springs": ({"DOWN = ": "image/png", "def square_net(": "image/png"}, "live(hung_net", 35),
    "08_pbd": ({"def rope(": "length after your predict"}, "live(hung_rope", 20),
}


@pytest.mark.long
@pytest.mark.parametrize("stem", PULLED)
def test_a_net_and_a_rope_are_pulled_by_the_pointer_in_the_page(student, stem, capsys):
    """The student has written the lesson, and lesson 1, and runs it as plain Python.  The last point is taken."""
    before, made, last = PULLED[stem]
    student.open(stem)
    student.runs("workbook_live.start", "The workbook is ready")
    for lesson in ("integrators", stem[3:]):
        student.has_written(lesson)
    student.runs("from validate.notebook import", "<canvas")
    for part, shown in before.items():
        student.runs(part, shown)
    place = student.starts(made)
    student.page.evaluate("k => jupyterapp.shell.currentWidget.content.scrollToItem(k)", place)
    student.waits("data.t > 0.5")
    student.page.locator(".live-scene button").first.click()         # a point at rest can be hit; a grab goes on
    student.waits("scene.querySelector('button').title.startsWith('Play')")
    scene = "document.querySelector('.live-scene')"
    box = student.page.locator(".live-scene canvas.stage").bounding_box()
    x, y = (box[one] + there for one, there in zip("xy", student.page.evaluate(f"{scene}.where({last})"), strict=True))
    student.page.mouse.move(x, y)
    student.page.mouse.down()
    student.waits(f"data.held === '{last}'")
    student.page.mouse.move(x + 60, y - 30, steps=5)
    student.waits(f"scene.where({last})[0] > {x - box['x'] + 30}")
    student.shows(f"live-{stem}")
    student.page.mouse.up()
    student.waits("data.held === '-1'")
    with capsys.disabled():
        print(f"\n{stem}: {student.page.evaluate(f'{scene}.dataset.fps')} pictures per second; "
              f"{student.page.evaluate(SAID)}")


@pytest.mark.long
@pytest.mark.parametrize(("stem", "exercise"), FIRSTS)
def test_a_lesson_is_read_and_an_exercise_passed_on_a_phone(student, stem, exercise):
    student.page.set_viewport_size({"width": 390, "height": 844})
    student.open(stem, "notebooks")
    student.shows(f"phone-first-{stem}")
    student.runs("workbook_live.start", "The workbook is ready")
    student.runs("from validate.notebook import", "<canvas")
    student.shows(f"phone-film-{stem}")
    student.runs(f'check("{exercise}")', "not attempted")
    student.writes_on_a_phone(stem[3:], solved(stem[3:], exercise))
    place = student.page.evaluate(FIND, f'check("{exercise}")')
    student.runs(f'check("{exercise}")', "passed")
    student.page.evaluate("k => jupyterapp.shell.currentWidget.content.scrollToItem(k)", place)
    student.shows(f"phone-check-{stem}")
    wide = "[document.documentElement, document.querySelector('.jp-WindowedPanel-outer')].map(one => one.scrollWidth)"
    assert max(student.page.evaluate(wide)) <= 390


@pytest.mark.long
def test_where_pybullet_cannot_run_its_recorded_runs_are_shown_and_a_sentence_says_so(student):
    student.open("11_kinematics")
    said = student.runs("workbook_live.start", "The workbook is ready")
    assert "pybullet's runs are recorded ones" in said
    student.runs("from validate.notebook import", "<canvas")
    student.page.evaluate(ADD, "engines = measured('reach_2r', without=()); show_findings(engines)")
    student.runs("engines = measured", "recorded")
