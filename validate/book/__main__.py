"""`python -m validate.book`: build the book, a static website that can be read without a network."""

import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
from html.parser import HTMLParser
from pathlib import Path
from typing import Annotated
from urllib.parse import unquote, urlsplit

import typer
from rich.console import Console

from solutions.checks import BadInput

from .. import modules
from ..processes import one_sentence

HERE = Path(__file__).resolve().parent
MARK = ".buildinfo"          # Sphinx writes it: a folder that holds it is a book
MOST = 60.0                  # size of the site [MB]
app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)
console = Console(highlight=False)


@app.command()
def book(
    out: Annotated[Path, typer.Option(help="Folder of the book.")] = Path("book"),
    report: Annotated[Path, typer.Option(help="Folder of a report to copy into the book, if it is there.")] =
        Path("report"),
    notebook: Annotated[list[str] | None, typer.Option(metavar="NN", help="Only this notebook (may be repeated).")] =
        None,
):
    """Build the book, a static website of the workbook without any answer's source.

    The first build runs all notebooks, which takes about ten minutes.  Later ones run those that changed.
    """
    numbers = checked(out, notebook or [])
    with tempfile.TemporaryDirectory() as folder:
        source, site = Path(folder, "source"), Path(folder, "site")
        from . import pages                   # imports what may be missing
        source.mkdir()
        pages.write_all(source, numbers, report if (report / "index.html").is_file() else None, console.print)
        warnings = sphinx(source, site)
        problems = [*warnings, *wrong_links(site), *outside_requests(site)]
        if size(site) > MOST:
            problems.append(f"the site has {size(site):.0f} MB, and at most {MOST:.0f} are allowed")
        if out.exists():
            shutil.rmtree(out)
        shutil.copytree(site, out)
    for problem in problems:
        console.print(f"✗ {problem}", markup=False, soft_wrap=True)
    console.print(f"{out / 'index.html'}: {len(list(out.rglob('*.html')))} pages, {size(out):.0f} MB")
    if not shutil.which("node"):
        console.print("Without node, formulas are set by KaTeX in the reader's browser instead of beforehand.")
    raise typer.Exit(1 if problems else 0)


def checked(out, numbers):
    """The numbers of the notebooks.  Raises BadInput if the book cannot be built like this."""
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


def sphinx(source, site):
    """Let Sphinx make the site; its warnings.  Raises RuntimeError if it makes none."""
    said = source / "warnings.txt"
    run = subprocess.run([sys.executable, "-m", "sphinx", "-b", "html", "-q", "-E", "-c", str(HERE), "-w", str(said),
                          "-d", str(source.parent / "doctrees"), str(source), str(site)],
                         env={**os.environ, "WORKBOOK_BOOK_SOURCE": str(source)}, capture_output=True, text=True)
    if run.returncode:
        raise RuntimeError(f"sphinx failed:\n{run.stdout}{run.stderr}")
    lines = said.read_text(encoding="utf-8").splitlines() if said.is_file() else []
    return [re.sub(r"\x1b\[[\d;]*m", "", line).replace(f"{source}/", "") for line in lines if line.strip()]


# ---------------------------------------------------------------------------------------------- what must hold of a site

class Addresses(HTMLParser):
    """Collects what a page loads, what it links to, and its ids."""

    LOADS = {"img": "src", "script": "src", "iframe": "src", "source": "srcset", "video": "src", "audio": "src",
             "object": "data", "embed": "src", "track": "src", "input": "src"}

    def __init__(self, text):
        super().__init__()
        self.loads, self.links, self.ids = [], [], set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        has = dict(attributes)
        self.ids |= {has["id"]} if has.get("id") else set()
        self.ids |= {has["name"]} if tag == "a" and has.get("name") else set()
        if has.get(self.LOADS.get(tag, "")):
            self.loads.append(has[self.LOADS[tag]].split()[0])
        if tag == "link" and has.get("rel") not in ("canonical", "author"):
            self.loads.append(has.get("href") or "")
        if tag == "a" and has.get("href"):
            self.links.append(has["href"])


def outside_requests(site):
    """Sentences about files of a site that make a browser ask another host."""
    found = []
    for path in sorted(site.rglob("*")):
        if path.suffix in (".html", ".svg"):
            loads = Addresses(path.read_text(encoding="utf-8")).loads if path.suffix == ".html" else []
            loads += re.findall(r"url\(['\"]?([^)'\"]+)", path.read_text(encoding="utf-8"))
        elif path.suffix == ".css":
            loads = re.findall(r"(?:url\(|@import) *['\"]?([^)'\";]+)", path.read_text(encoding="utf-8"))
        else:
            continue
        found += [f"{path.relative_to(site)} loads {address}" for address in loads
                  if urlsplit(address).netloc or urlsplit(address).scheme in ("http", "https", "ftp")]
    return found


def wrong_links(site):
    """Sentences about links and files of a site that lead nowhere."""
    pages = {path.resolve(): Addresses(path.read_text(encoding="utf-8")) for path in site.rglob("*.html")}
    found = []
    for path, page in sorted(pages.items()):
        for address in dict.fromkeys(page.links + page.loads):
            parts = urlsplit(address)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not target.exists():
                found.append(f"{path.relative_to(site.resolve())} leads to {address}, which is not there")
            elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].ids:
                found.append(f"{path.relative_to(site.resolve())} leads to {address}, a place that is not there")
    return found


def size(folder):
    """Size of a folder [MB]."""
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file()) / 1e6


def main(arguments=None):
    """Run the command line."""
    with one_sentence("book"):
        app(arguments, prog_name="python -m validate.book")


if __name__ == "__main__":
    main()
