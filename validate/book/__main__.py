"""`python -m validate.book`: build the book, a static website that can be read without a network."""

import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from solutions.checks import BadInput

from ..run.command import start
from ..subject import modules
from .site import LIVE, outside_requests, size, wrong_links

HERE = Path(__file__).resolve().parent
MARK = ".buildinfo"          # Sphinx writes it: a folder that holds it is a book
MOST = 60.0                  # size of the book [MB]
MOST_LIVE = 80.0             # size of the lessons for the browser [MB]; a first visit loads a part of it
app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)
console = Console(highlight=False)


@app.command()
def book(
    out: Annotated[Path, typer.Option(help="Folder of the book.")] = Path("book"),
    report: Annotated[Path, typer.Option(help="Folder of a report to copy into the book, if it is there.")] =
        Path("report"),
    notebook: Annotated[list[str] | None, typer.Option(metavar="NN", help="Only this notebook (may be repeated).")] =
        None,
    live: Annotated[bool, typer.Option("--live", help="Also build the lessons for the reader's browser.")] = False,
    pyodide: Annotated[Path | None, typer.Option(help="Archive of Pyodide's release, or the folder that it unpacks "
                                                      "to; for --live.")] = None,
):
    """Build the book, a static website of the workbook without any answer's source.

    The first build runs all notebooks, which takes about ten minutes.  Later ones run those that changed.
    """
    numbers = checked(out, notebook or [])
    if live:
        checked_live(pyodide)
    with tempfile.TemporaryDirectory() as folder:
        source, site = Path(folder, "source"), Path(folder, "site")
        from . import pages  # imports what may be missing
        source.mkdir()
        pages.write_all(source, numbers, report if (report / "index.html").is_file() else None, console.print, live)
        warnings = sphinx(source, site)
        if live:
            from .live.site import build
            build(pyodide, site / LIVE)
        problems = [*warnings, *wrong_links(site), *outside_requests(site)]
        for part, found, most in (("book", size(site) - size(site / LIVE), MOST), (LIVE, size(site / LIVE), MOST_LIVE)):
            if found > most:
                problems.append(f"the {part} has {found:.0f} MB, and at most {most:.0f} are allowed")
        if out.exists():
            shutil.rmtree(out)
        shutil.copytree(site, out)
    for problem in problems:
        console.print(f"✗ {problem}", markup=False, soft_wrap=True)
    console.print(f"{out / 'index.html'}: {len(list(out.rglob('*.html')))} pages, {size(out):.0f} MB")
    for sentence in missing(live):
        console.print(sentence, soft_wrap=True)
    raise typer.Exit(1 if problems else 0)


def checked(out, numbers):
    """Return the numbers of the notebooks.  Raises BadInput if the book cannot be built like this."""
    if not importlib.util.find_spec("sphinx") or not importlib.util.find_spec("furo"):
        raise BadInput("the package sphinx", "not installed", "install the extra: .venv/bin/pip install -e '.[book]'")
    waiting = [name for name in modules.lesson_names() if modules.withheld(name)]
    if waiting:
        raise BadInput(f"lesson {waiting[0]}", "without its worked answers", "build the book in the whole workbook")
    there = {path.stem[:2] for path in (modules.ROOT / "notebooks").glob("[0-9]*.ipynb")}
    for number in numbers:
        if number not in there:
            raise BadInput(f"--notebook {number!r}", "not there", f"give one of {', '.join(sorted(there))}")
    if out.exists() and any(out.iterdir()) and not (out / MARK).is_file():
        raise BadInput(f"--out {str(out)!r}", "there, and no book", "name another folder")
    return set(numbers)


def checked_live(pyodide):
    """Raise BadInput if the lessons for the browser cannot be built with that Pyodide."""
    if not importlib.util.find_spec("jupyterlite_pyodide_kernel"):
        raise BadInput("the package jupyterlite-pyodide-kernel", "not installed",
                       "install the extra: .venv/bin/pip install -e '.[live]'")
    from .live import pyodide as parts
    if pyodide is None or not pyodide.exists():
        raise BadInput(f"--pyodide {str(pyodide or '')!r}", "not there",
                       f"download pyodide-{parts.VERSION}.tar.bz2 from the releases of Pyodide, and name the file")


def missing(live):
    """Yield a sentence for each program that would have saved work in the reader's browser, and is not there."""
    if not shutil.which("node"):
        yield "Without node, formulas are set by KaTeX in the reader's browser instead of beforehand."
    if live:
        from .live import pyodide as parts
        if not parts.interpreter():
            yield f"Without Python {parts.PYTHON}, packages are compiled in the reader's browser instead of beforehand."


def sphinx(source, site):
    """Let Sphinx make the site; its warnings.  Raises RuntimeError if it makes none."""
    said, log = source / "warnings.txt", source / "log.txt"
    with log.open("w") as output:              # a pipe would stay open if KaTeX's server outlived Sphinx
        run = subprocess.run([sys.executable, "-m", "sphinx", "-b", "html", "-q", "-E", "-c", HERE, "-w", said,
                              "-d", source.parent / "doctrees", source, site],
                             env={**os.environ, "WORKBOOK_BOOK_SOURCE": str(source)}, stdout=output, stderr=output)
    if run.returncode:
        raise RuntimeError(f"sphinx failed:\n{log.read_text(encoding='utf-8', errors='replace')}")
    lines = said.read_text(encoding="utf-8").splitlines() if said.is_file() else []
    return [re.sub(r"\x1b\[[\d;]*m", "", line).replace(f"{source}/", "") for line in lines if line.strip()]


def main(arguments=None):
    """Run the command line."""
    start("python -m validate.book", app, arguments)


if __name__ == "__main__":
    main()
