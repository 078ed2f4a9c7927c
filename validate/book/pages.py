"""The pages of the book before Sphinx sets them: one folder of notebooks, Markdown and reStructuredText."""

import hashlib
import json
import re
import shutil
import subprocess
from base64 import b64decode
from pathlib import Path

from ..run.store import SUBSET
from ..subject.modules import ROOT
from . import api, course, execute, hosted, plan, sheets

HERE = Path(__file__).resolve().parent
SOURCE = re.compile(r'<a href="(?:\.\./)*\.\./((notebooks|solutions|validate)/[\w/.]+)">(<code>[\w/.]+</code>)</a>')
WIDGET = "application/vnd.jupyter.widget-view+json"
INLINE = re.compile(r"<script>(.*?)</script>", re.S)            # a player: the same in every film
LONG = 8                     # lines of code; longer cells are folded
LINK = re.compile(r"\[([^\]]*)\]\((?!https?://|#)([^)\s]+)\)")  # to a file of the repository
NOTEBOOK = re.compile(r"`(?:notebooks/)?(\d\d_\w+)\.ipynb`")
EXERCISE = re.compile(r"`(\w+)` \((\d+\.\d+)( ★*)?\)")
LEFT_OUT = "# {0}\n\nThis copy of the book was built without this notebook.\n"
PAGES = re.compile(r"(?:docs/|\.\./)?"
                   r"((?:grading|instructors|plan|slides|students)(?=\.md)|(?:lessons|notebooks)/\w+(?=\.))")


def write_all(folder, numbers, report, say, live=False):
    """Write the sources of all pages into an empty folder.  live: the lessons for the browser lie beside the book."""
    for part in ("notebooks", "lessons", "sheets", "extra"):
        (folder / part).mkdir(parents=True)
    shutil.copytree(HERE / "static", folder / "_static")
    shutil.copy(ROOT / "docs" / "scenes.webp", folder / "_static")
    shutil.copy(ROOT / "docs" / "scenes.png", folder / "_static")
    alts = {}
    paths = sorted(execute.NOTEBOOKS.glob("[0-9]*.ipynb"))
    for path in paths:
        if numbers and path.stem[:2] not in numbers:
            write(folder / "notebooks" / f"{path.stem}.md", LEFT_OUT.format(path.stem))
            continue
        text = json.dumps(prepared(execute.kept(path, say), path.stem, folder, alts, report, live),
                          ensure_ascii=False)
        (folder / "notebooks" / path.name).write_text(text, encoding="utf-8")
    (folder / "alts.json").write_text(json.dumps(alts, ensure_ascii=False), encoding="utf-8")
    for name in course.lessons():
        write(folder / "lessons" / f"{name}.rst", api.page(name))
    write(folder / "glossary.md", glossary())
    for name in ("grading", "instructors", "slides", "students"):
        text = (ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8")
        write(folder / f"{name}.md", plan.with_address(linked(text)))
    write(folder / "plan.md", plan.filled(linked((ROOT / "docs" / "plan.md").read_text(encoding="utf-8"))))
    for name in course.lessons():
        write(folder / "sheets" / f"{name}.md", sheets.page(name, report))
    write(folder / "index.md", front(paths, live))
    write_report(folder, report)


def write_report(folder, report):
    """Write the report into the book, if there is one, and the page about it."""
    if report:
        shutil.copytree(report, folder / "extra" / "report", ignore=shutil.ignore_patterns("results", SUBSET))
        for page in (folder / "extra" / "report").glob("*.html"):
            write(page, with_pages_for_sources(page.read_text(encoding="utf-8")))
    about_report = HERE / ("validation.md" if report else "no_report.md")
    write(folder / "validation.md", about_report.read_text(encoding="utf-8"))


def write(path, text):
    path.write_text(text, encoding="utf-8")


def with_pages_for_sources(page):
    """Return a page of the report whose links to files of the repository lead to pages of the book, if these exist."""
    def to_page(match):
        path, folder, text = Path(match[1]), match[2], match[3]
        parts = {"notebooks": "notebooks", "solutions": "lessons"}
        known = folder == "notebooks" or (path.stem in course.lessons() and len(path.parts) == 2)
        return f'<a href="../{parts[folder]}/{path.stem}.html">{text}</a>' if folder in parts and known else text
    return SOURCE.sub(to_page, page)


# ---------------------------------------------------------------------------------------------- notebooks

def prepared(book, stem, folder, alts, report=None, live=False):
    """Return an executed notebook as the book shows it.

    Sliders, which need a kernel, are removed, and the figure that they drew stays.  Long code is folded.  A player's
    script, which every film repeats, becomes a file that the page loads once.  `alts` collects {file of a figure:
    description}.
    """
    players = set()
    for cell in book.cells:
        if cell.cell_type == "markdown":
            cell.source = with_links(cell.source)
            continue
        if cell.metadata.get("jupyter", {}).get("source_hidden") or len(cell.source.splitlines()) > LONG:
            cell.metadata.setdefault("tags", []).append("hide-input")
        cell.outputs = [output for output in cell.outputs if WIDGET not in output.get("data", {})]
        for output in cell.outputs:
            data = output.get("data", {})
            if "image/png" in data:
                data.pop("text/html", None)      # the same figure, for JupyterLab
            if "text/html" in data:
                data["text/html"] = INLINE.sub(lambda match: script(match[1], folder, players), data["text/html"])
            if "image/png" in data:
                described = output.metadata.get("image/png", {}).get("alt", "")
                alts[hashlib.sha256(b64decode(data["image/png"])).hexdigest()] = described
    lesson = stem.partition("_")[2]
    if lesson in course.lessons():
        book.cells.insert(1, about(lesson, stem, report, live))
    return book


def about(lesson, stem, report, live=False):
    """Return what the book adds to a lesson's first screen: where to work, and its scenes in the report."""
    facts = course.lessons()[lesson]
    links = [link for name in facts.scenes if (link := course.link_into(report, f"{name}.html", name))]
    runs = f" Runs of its scenes are in the report: {', '.join(links)}." if links else ""
    here = hosted.buttons(stem, live, plan.repository())
    where = "press a button, or install the workbook and" if here else "yourself,"
    text = (f"```{{admonition}} This page is the notebook as the worked answers run it\n:class: note\n{here}To work on "
            f"it {where} open `notebooks/{stem}.ipynb` in JupyterLab. Films play here; sliders need JupyterLab. "
            f"The lesson has {len(facts.exercises)} exercises: [what each function does](../lessons/{lesson})."
            f"{runs}\n```")
    return {"cell_type": "markdown", "id": "about-this-page", "metadata": {}, "source": text}


def script(text, folder, players):
    """Put a player into a file of its own; the tag that loads it, for the first film of a page.

    The player starts all films of its page when the page has been read.
    """
    name = f"player-{hashlib.sha256(text.encode()).hexdigest()[:12]}.js"
    write(folder / "_static" / name, text)
    if name in players:
        return ""
    players.add(name)
    return f'<script src="../_static/{name}"></script>'


def with_links(text):
    """Return a notebook's text with links to other notebooks, and from each exercise to its function."""
    text = NOTEBOOK.sub(lambda match: f"[`{match[1]}.ipynb`]({match[1]})", text)

    def to_function(match):
        known = match[2] in api.targets() and api.target(match[2]).endswith(f".{match[1]}")
        return f"{{py:func}}`~{api.target(match[2])}` ({match[2]}{match[3] or ''})" if known else match[0]
    return EXERCISE.sub(to_function, text)


# ---------------------------------------------------------------------------------------------- other pages

def linked(text):
    """Return a page of docs/: links to other pages of the book stay, links to other files become plain text."""
    def to(match):
        page = PAGES.match(match[2])
        return f"[{match[1]}]({page[1]})" if page else match[1]
    return LINK.sub(to, text)


def glossary():
    """Return the table of words in CONTRIBUTING.md as a page to which others can link."""
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").partition("## Glossary")[2].partition("\n## ")[0]
    rows = re.findall(r"^\| (.+?) \| (.+?) \|$", text, re.M)
    entries = ["\n".join([*re.split(r", (?![^(]*\))", term), f"    {meaning}"])
               for term, meaning in rows if term != "word" and not term.startswith("-")]
    return "# Glossary\n\nThe symbols are in [Start here](notebooks/00_start_here).\n\n" \
        "```{glossary}\n:sorted:\n\n" + "\n\n".join(entries) + "\n```\n"


def front(paths, live=False):
    """Return the first page."""
    contents = "\n".join(f"notebooks/{path.stem}" for path in paths)
    functions = "\n".join(f"{lesson.number} · {name} <lessons/{name}>" for name, lesson in course.lessons().items())
    text = (HERE / "front.md").read_text(encoding="utf-8")
    about = "\n".join(f"{lesson.number} · {name} <sheets/{name}>" for name, lesson in course.lessons().items())
    here = hosted.buttons("01_integrators", live, plan.repository(), "")
    text = text.replace("@BUTTONS@", here).replace("@COUNT@", str(len(course.lessons())))
    for name, value in {"NOTEBOOKS": contents, "LESSONS": functions, "SHEETS": about, "COMMIT": commit()}.items():
        text = text.replace(f"@{name}@", value)
    return text


def commit():
    """Return the commit that the book shows, or where it comes from if git does not know."""
    said = subprocess.run(["git", "describe", "--always", "--dirty"], cwd=ROOT, capture_output=True, text=True)
    return said.stdout.strip() or "an unpacked folder"
