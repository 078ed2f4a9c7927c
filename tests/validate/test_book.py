"""The book shows what the lessons are about and no answer, asks no other host, and its plans can be taught."""

import html
import os
import re
import shutil
import subprocess
import sys
from functools import cache
from html.parser import HTMLParser
from pathlib import Path

import nbformat
import pytest

from solutions.checks import BadInput
from validate.book import __main__ as book
from validate.book import api, course, execute, pages, plan, sheets, weeks
from validate.book.site import files
from validate.grading import choice, release
from validate.notebook import growing
from validate.stability.examine import all_cases
from validate.subject import modules
from validate.subject.modules import ROOT

from ..lessons.drawn_type import PAGE

pytestmark = pytest.mark.xdist_group("book")
ESTIMATED = 0.4              # of a lesson's hours [h]: they are given in halves, and a text may change a little
FILM = "<div>film</div><script>" + "let player = 1;" * 400 + "</script>"


class Texts(HTMLParser):
    """The whole text of a page, and of each block of code in it."""

    def __init__(self, page):
        super().__init__()
        self.whole, self.blocks, self.deep = [], [], 0
        self.feed(page)

    def handle_starttag(self, tag, attributes):
        if tag == "pre":
            self.deep += 1
            self.blocks.append("")

    def handle_endtag(self, tag):
        self.deep -= tag == "pre" and self.deep > 0

    def handle_data(self, data):
        self.whole.append(data)
        if self.deep:
            self.blocks[-1] += data


MARKED = re.compile(r"BEGIN SOLUTION (\d+)\.\d+(.*?)END SOLUTION", re.DOTALL)


@cache
def secrets():
    """The answers of all lessons, and their signs."""
    hidden = [answer for name in modules.lesson_names() for answer in release.answers_of(name)]
    return hidden, release.signs_of(hidden), release.names_of(hidden)


def leaks(texts):
    """What the students' zip would refuse in these texts: the first leak of each."""
    return [leak.what for text in map(without_examples, texts) if (leak := release.leak_in(text, *secrets()))]


def without_examples(text):
    """A text without the markers of exercises that no lesson has: instructors read how to write one of their own."""
    there = modules.lessons_by_number()
    return MARKED.sub(lambda marked: marked[0] if int(marked[1]) in there else marked[2], text)


def test_only_the_markers_of_an_exercise_that_no_lesson_has_do_not_leak():
    block = "### BEGIN SOLUTION {}\n    return v\n    ### END SOLUTION\n".format
    for leaky in (block("1.1"), block("99.1") + block("1.1"), "### END SOLUTION", "### BEGIN SOLUTION"):
        assert len(leaks([leaky])) == 1, leaky
    assert not leaks([block("99.1")])
    assert leaks([block("99.1").replace("    return v\n", answer_of("5.16"))])


def texts_of(site):
    """Every text of a site: pages, their blocks of code, scripts and data."""
    for path in files(site):
        if path.suffix == ".html":
            page = Texts(path.read_text(encoding="utf-8"))
            yield from ["".join(page.whole), *page.blocks]
        elif path.suffix in (".js", ".json", ".txt", ".csv", ".py", ".md", ".rst", ".ipynb"):
            yield path.read_text(encoding="utf-8")


def answer_of(number):
    """The source of an answer."""
    match = next(m for m in release.generate.ANSWER.finditer(release.source(api.target(number).split(".")[1]))
                 if m["exercise"] == number)
    return match[0]


# ---------------------------------------------------------------------------------------------- pages without Sphinx

def test_the_page_of_each_lesson_has_every_exercise_and_no_answer():
    for name, lesson in course.lessons().items():
        page = api.page(name)
        assert all(f"**Exercise {one.number}** · {one.points:g} point" in page for one in lesson.exercises)
        assert leaks([page]) == [] and "SOLUTION" not in page


def test_docstrings_keep_their_formulas_and_their_words():
    said = "Return a* b.\n\n    a   b\n    c   d\n\nUse `x_`, *not* x_ or |y|; cone_impulse has it.\n*Source:* a deck."
    rst = api.as_rst(said)
    assert ".. code-block:: text\n\n   a   b\n   c   d" in rst
    assert r"Return a\* b." in rst and "``x_``" in rst and "*not*" in rst and r"x\_ or \|y\|" in rst
    assert ":py:func:`~lessons.impulses.cone_impulse`" in rst and "\n\n*Source:* a deck." in rst


def test_every_lesson_adds_up_to_twenty_points_and_has_a_sheet():
    for name, lesson in course.lessons().items():
        assert lesson.points == 20.0
        sheet = sheets.page(name, report=None)
        assert all(f"| {one.number} |" in sheet for one in lesson.exercises) and "1. " in sheet
        assert f"--lesson {name} " in sheet and leaks([sheet]) == []


def test_the_hours_are_the_same_on_every_page_and_near_the_estimate():
    weeks = [row.split(" | ") for row in plan.course_table(plan.COURSES[-1]).splitlines()]
    for name, lesson in course.lessons().items():
        head, (reading, writing) = lesson.head, lesson.estimate
        assert abs(head.reading - reading) <= ESTIMATED and abs(head.writing - writing) <= ESTIMATED, name
        told = f"about {head.whole:g} hours: {head.reading:g} to read and run, {head.writing:g} to write"
        assert f"| **Time** | {told} |" in course.notebook_of(name).read_text(encoding="utf-8")
        assert f"| hours | {told.removeprefix('about ').replace(' hours', '')} |" in sheets.page(name, report=None)
        assert f"| {head.whole:g}: {head.reading:g} + {head.writing:g} |" in plan.lesson_table()
        assert sum(float(week[4]) for week in weeks if f"({'notebooks/' + course.notebook_of(name).stem})" in week[1]) \
            == head.whole


def test_a_course_takes_as_many_hours_as_its_weeks():
    for taught in plan.COURSES:
        section = plan.course_section(taught)
        weeks = [row.split(" | ")[4] for row in section.splitlines() if re.match(r"\| \d", row)]
        assert f"About {sum(float(hours) for hours in weeks if hours):g} hours" in section


def test_hours_that_do_not_add_up_are_refused(monkeypatch):
    said = ("| **You need** | sums |\n| **Lessons before** | none |\n"
            "| **Time** | about 5.5 hours: 1 to read and run, 4 to write |")
    cells = [nbformat.v4.new_markdown_cell(text) for text in ("", "", said)]
    monkeypatch.setattr(course.nbformat, "read", lambda *path, as_version: nbformat.v4.new_notebook(cells=cells))
    with pytest.raises(ValueError, match="do not add up"):
        course.head("friction")


def test_a_lesson_names_every_lesson_whose_exercises_it_calls_as_one_before_it():
    for name, lesson in course.lessons().items():
        called = {int(number.split(".")[0]) for number in sheets.foreign(lesson)}
        assert called <= lesson.head.numbers <= set(range(1, lesson.number)), name
        assert lesson.head.numbers or lesson.head.before == "none", name


def test_a_sheet_shows_the_stars_of_the_notebook():
    for name in course.lessons():
        notebook = dict(re.findall(r"`\w+` \((\d+\.\d+) (★+)\)", course.notebook_of(name).read_text(encoding="utf-8")))
        sheet = dict(re.findall(r"^\| (\d+\.\d+) \| [^|]+ \| (★+) \|", sheets.page(name, report=None), re.M))
        assert sheet == notebook, name


@pytest.mark.parametrize("taught", plan.COURSES, ids=lambda taught: taught.title)
def test_a_course_teaches_what_it_needs_before_it_is_needed(taught):
    there = {one.number for name in taught.worked for one in course.lessons()[name].exercises}
    lessons = set(taught.worked)
    for week in taught.weeks:
        if week.lesson:
            lesson = course.lessons()[week.lesson]
            assert lesson.needs <= lessons | {week.lesson}, week
            assert lesson.head.numbers <= {course.lessons()[name].number for name in lessons}, week
            for one in week.exercises():
                assert {n for n in one.uses if course.in_order(n) < course.in_order(one.number)} <= there, one
                there.add(one.number)
            lessons.add(week.lesson)
    assert len(taught.weeks) in (4, 8, 16) and all(week.hours() <= 8.0 for week in taught.weeks)


@pytest.mark.long
@pytest.mark.parametrize("taught", plan.COURSES, ids=lambda taught: taught.title)
def test_the_zips_of_a_course_can_be_released(taught):
    every, paths = modules.lesson_names(), release.tracked(dirty=True)
    for worked in map(set, taught.zips().values()):
        assert release.with_earlier(worked) == worked
        release.refuse_leaks(release.contents(paths, set(every), worked), worked)


def test_the_weeks_of_a_lesson_hold_every_exercise_once_in_whole_sections_and_its_own_scenes():
    assert weeks.WEEKS.keys() == course.lessons().keys()
    for name, lesson in course.lessons().items():
        parts = [part for week in weeks.WEEKS[name] for part in week.parts(name)]
        numbers = [number for first, last in parts for number in range(first, last + 1)]
        assert numbers == list(range(1, len(lesson.exercises) + 1)), name
        assert sum(weeks.hours(name, *part) for part in parts) == lesson.head.writing, name
        assert all(weeks.hours(name, *part) > 0.0 for part in parts), name
        told = weeks.table(name, report=None)
        sections = weeks.sections(name)
        assert sections and all(f"*{title}*" in told for _, _, title in sections), name
        assert all(set(week.show) <= set(lesson.scenes) for week in weeks.WEEKS[name])
        two = sum(week.lesson == name for week in plan.COURSES[-1].weeks) == 2
        assert len(weeks.WEEKS[name]) == (2 if two else 1), name


def test_two_weeks_with_a_lesson_are_those_of_the_long_course():
    for name, own in weeks.WEEKS.items():
        number, parts = course.lessons()[name].number, [week.parts(name) for week in own]
        planned = [week.exercises() for week in plan.COURSES[-1].weeks if week.lesson == name]
        assert [[f"{number}.{before[0]}", f"{number}.{after[1]}"] for before, after in parts] == \
            [[chosen[0].number, chosen[-1].number] for chosen in planned]


def report_of(cases, scenes, folder):
    """Write the pages of a report with these stability cases and scenes; return the folder."""
    folder.mkdir()
    for scene in scenes:
        (folder / f"{scene}.html").write_text("")
    (folder / "stability.html").write_text("".join(f'<h3 id="{case.lesson}-{case.slug}">' for case in cases))
    return folder


def test_a_sheet_links_every_case_and_scene_and_names_the_paths_of_the_answers(tmp_path):
    report = report_of(all_cases(), modules.scene_names(), tmp_path / "report")
    for name, lesson in course.lessons().items():
        sheet = sheets.page(name, report)
        assert sheet.count(f'<a href="../report/stability.html#{name}-') == lesson.cases > 0
        assert all(f'<a href="../report/{scene}.html">' in sheet for scene in lesson.scenes)
        assert all(f"`{path}/{name}.py`" in sheet for path in ("solutions", "tests/mutants"))
        assert "publishes the answers of" in sheet or name == "integrators"
        assert f"({'sheets/' + name})" in plan.lesson_table()


def test_a_sheet_names_without_a_link_what_a_report_has_left_out(tmp_path):
    quick = [case for case in all_cases() if case.in_quick]
    scenes = [name for name in modules.scene_names() if name != "kepler"]
    report = report_of(quick, scenes, tmp_path / "report")
    for name in course.lessons():
        sheet = sheets.page(name, report)
        assert sheet.count("stability.html#") == sum(case.lesson == name for case in quick)
        assert "report/kepler.html" not in sheet + pages.about(name, "01_integrators", report)["source"]


def documents():
    """{name: text} of what an instructor or a student reads: docs, README, the first notebook, sheets, the plan."""
    paths = [*(ROOT / "docs").glob("*.md"), ROOT / "README.md", ROOT / "notebooks" / "00_start_here.ipynb"]
    texts = {path.name: path.read_text(encoding="utf-8") for path in paths}
    return texts | {"plan.md": plan.filled(texts["plan.md"])} | {
        name: sheets.page(name, report=None) for name in course.lessons()}


def test_every_page_gives_a_command_in_the_same_words():
    grades, tests, zips = [], [], set()
    for text in documents().values():
        text = re.sub(r" \\\n +", " ", text)
        grades += [line for line in re.findall(r"^\.venv/bin/grade .*", text, re.M) if "--roster" in line]
        tests += re.findall(r"\.venv/bin/pytest[^`\n]*--exercise.*", text)
        zips |= set(re.findall(r"--out (\S+\.zip)", text))
    assert len(grades) >= 14 and all("--roster class/list.csv" in line and "--late 10" in line for line in grades)
    assert len(tests) >= 2 and all("--of=" in line for line in tests)
    assert zips == {"workbook.zip", "autograder.zip", *(f"{name}.zip" for name in course.lessons())}


def test_the_commands_that_a_page_gives_to_the_grader_name_exercises_that_there_are():
    found = [(name, match[1] or match[2]) for name, text in documents().items()
             for match in re.finditer(r'--exercises (?:"([^"]+)"|([\d.=,–-]+))', text)]
    assert len(found) >= 14 and all(choice.chosen([], text)[1] for _, text in found)
    for taught in plan.COURSES:
        for week in filter(plan.Week.exercises, taught.weeks):
            assert [*choice.chosen([week.lesson], plan.span(week.exercises()))[1]] == [
                one.number for one in week.exercises()]


@pytest.mark.parametrize(("remote", "address"), [
    ("https://github.com/someone/workbook.git", "https://github.com/someone/workbook"),
    ("https://someone:ghp_secret@github.com/someone/workbook", "https://github.com/someone/workbook"),
    ("https://ghp_secret@example.org/workbook", "https://example.org/workbook"),
    ("git@github.com:someone/workbook.git", ""), ("/home/someone/workbook", ""), ("", "")])
def test_the_book_names_the_address_of_the_repository_and_no_secret(remote, address, monkeypatch, tmp_path):
    (tmp_path / "CITATION.cff").write_text("title: A workbook\n")
    subprocess.run(["git", "init", "-q", tmp_path], check=True)
    if remote:
        subprocess.run(["git", "remote", "add", "origin", remote], cwd=tmp_path, check=True)
    monkeypatch.setattr(plan, "ROOT", tmp_path)
    assert plan.repository() == address
    page = plan.with_address((ROOT / "docs" / "instructors.md").read_text(encoding="utf-8"))
    assert (f"git clone {address} workbook" in page) == bool(address) == ("REPOSITORY" not in page)
    assert ("stands for the address" in page) != bool(address)
    (tmp_path / "CITATION.cff").write_text('repository-code: "https://example.org/cited"\n')
    assert plan.repository() == "https://example.org/cited"


def test_the_glossary_has_every_word_of_the_table():
    page = pages.glossary()
    words = re.findall(r"^(\S.*)$", page.partition("```{glossary}")[2], re.M)
    assert len(words) >= 45 and {"mutant", "narrow phase", "sweep (of dt)"} <= set(words)


def test_a_notebook_loses_its_sliders_and_loads_its_player_once(tmp_path):
    cell = nbformat.v4.new_code_cell("x\n" * (pages.LONG + 1))
    view = nbformat.v4.new_output("display_data", {pages.WIDGET: {}, "text/plain": "interactive"})
    cell.outputs = [view, *(nbformat.v4.new_output("display_data", {"text/html": FILM}) for _ in range(2))]
    said = "# One\nWrite `euler_step` (1.1 ★), not `euler_step` (1.2); see `02_springs.ipynb`."
    text = nbformat.v4.new_markdown_cell(said)
    (tmp_path / "_static").mkdir()
    made = pages.prepared(nbformat.v4.new_notebook(cells=[text, cell]), "01_integrators", tmp_path, {},
                          report=report_of([], ["oscillator"], tmp_path / "report"))
    shown = [output["data"]["text/html"] for output in made.cells[2].outputs]
    assert len(shown) == 2 and shown[0].count("<script") == 1 and shown[1] == "<div>film</div>"
    assert [path.read_text() for path in (tmp_path / "_static").iterdir()] == ["let player = 1;" * 400]
    assert made.cells[2].metadata.tags == ["hide-input"]
    assert "{py:func}`~lessons.integrators.euler_step` (1.1 ★), not `euler_step` (1.2)" in made.cells[0].source
    assert "[`02_springs.ipynb`](02_springs)" in made.cells[0].source
    assert '<a href="../report/oscillator.html">' in made.cells[1]["source"]


def test_the_report_in_the_book_leads_to_pages_of_the_book():
    link = '<a href="../{0}"><code>{0}</code></a>'
    scene, lesson = "validate/scenes/pbd/rope.py", "solutions/pbd.py"
    page = "; ".join(link.format(path) for path in (scene, lesson, "notebooks/08_pbd.ipynb"))
    assert pages.with_pages_for_sources(page) == (
        f'<code>{scene}</code>; <a href="../lessons/pbd.html"><code>{lesson}</code></a>; '
        '<a href="../notebooks/08_pbd.html"><code>notebooks/08_pbd.ipynb</code></a>')


def test_a_notebook_that_prints_a_lesson_runs_with_the_stubs():
    prints = [path.stem[:2] for path in sorted(execute.NOTEBOOKS.glob("[0-9]*.ipynb"))
              if execute.prints_source(nbformat.read(path, as_version=4))]
    assert "00" in prints


def test_cleared_outputs_are_gone_when_the_next_one_comes():
    def message(kind, **content):
        return {"header": {"msg_type": kind}, "content": content}
    found = execute.Outputs()
    for one in (message("stream", name="stdout", text="old"), message("clear_output", wait=True)):
        found.take(one)
    assert len(found.cells) == 1
    found.take(message("stream", name="stdout", text="new"))
    assert [output.text for output in found.cells] == ["new"]


def test_a_cell_that_fails_or_ends_its_kernel_is_named(tmp_path):
    with execute.kernel(tmp_path) as client:
        for cell, said in (("1 / 0", "ZeroDivisionError"),
                           ("import os, signal\nos.kill(os.getpid(), signal.SIGTERM)", "ends its kernel")):
            with pytest.raises(BadInput, match=f"notebook 05 .*{said}"):
                execute.outputs_of(client, cell, "05")


# ---------------------------------------------------------------------------------------------- the checks can fail

@pytest.mark.parametrize("page", [
    '<img src="https://a.example/b.png">', '<script src="//a.example/b.js"></script>',
    '<link rel="stylesheet" href="https://a.example/b.css">', "<style>@font-face {src: url(https://a.example/f)}</style>",
    '<iframe src="http://a.example"></iframe>', '<video><source src="https://a.example/v.mp4"></video>',
    '<img src="a.png" srcset="a.png 1x, https://a.example/b.png 2x">', '<style>@import "https://a.example/b";</style>',
    '<video poster="https://a.example/p.png"></video>', '<link rel="preconnect" href="https://a.example">'])
def test_a_request_to_another_host_is_found(page, tmp_path):
    (tmp_path / "index.html").write_text(f"<html>{page}</html>")
    assert len(book.outside_requests(tmp_path)) == 1
    (tmp_path / "index.html").write_text('<a href="https://a.example">a link asks only when it is followed</a>')
    assert book.outside_requests(tmp_path) == []


def test_a_style_sheet_or_a_script_that_asks_another_host_is_found(tmp_path):
    (tmp_path / "a.css").write_text("@import 'https://a.example/b.css';")
    (tmp_path / "b.js").write_text('fetch("https://cdn.example/c.json")')
    (tmp_path / "c.js").write_text("// see https://a.example\nimport('./d.js')")
    assert [said.split()[0] for said in book.outside_requests(tmp_path)] == ["a.css", "b.js"]


def test_a_link_that_leads_nowhere_is_found(tmp_path):
    (tmp_path / "a.html").write_text('<p id="x"></p><a href="b.html#there"></a><a href="#x"></a><img src="c.png">')
    (tmp_path / "b.html").write_text('<p id="elsewhere"></p>')
    wrong = [said.split(" leads to ")[1].split(",")[0] for said in book.wrong_links(tmp_path)]
    assert wrong == ["b.html#there", "c.png"]


def test_an_answer_on_a_page_is_found(tmp_path):
    coloured = "".join(f"<span>{html.escape(word)}</span>" for word in re.split(r"(\W)", answer_of("5.16")))
    (tmp_path / "a.html").write_text(f"<p>See</p><pre>{coloured}</pre>")
    assert leaks(texts_of(tmp_path))


@pytest.mark.parametrize("arguments", [["--out", "{folder}"], ["--notebook", "99"]])
def test_a_folder_that_is_no_book_and_an_unknown_notebook_are_refused(arguments, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(book.importlib.util, "find_spec", lambda name: True)
    (tmp_path / "thesis.tex").write_text("precious")
    with pytest.raises(SystemExit) as end:
        book.main([argument.format(folder=tmp_path) for argument in arguments])
    assert end.value.code == 2 and (tmp_path / "thesis.tex").exists()
    assert re.match(r"python -m validate.book: .*(no book|not there)", capsys.readouterr().err)


# ---------------------------------------------------------------------------------------------- whole books

def built(folder, *arguments, without_node=False):
    """Build a book; what the command said, and the site."""
    pytest.importorskip("furo", reason="the extra `book` is not installed")
    path = os.environ["PATH"]
    if without_node:
        path = folder.parent / "programs"
        path.mkdir()
        (path / "git").symlink_to(shutil.which("git"))
    run = subprocess.run([sys.executable, "-m", "validate.book", "--out", folder, *arguments], cwd=ROOT,
                         env={**os.environ, "PATH": str(path)}, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout + run.stderr
    return run.stdout, folder


@pytest.fixture(scope="module")
def one_notebook(tmp_path_factory):
    """What the command said about a book of notebook 00, and the site."""
    folder = tmp_path_factory.mktemp("one")
    return built(folder / "book", "--notebook", "00", "--report", str(folder / "none"), without_node=True)


@pytest.mark.long
def test_a_book_of_one_notebook_is_built_without_node(one_notebook):
    said, site = one_notebook
    assert "in the reader's browser" in said and (site / "_static" / "katex.min.js").is_file()
    start = Texts((site / "notebooks" / "00_start_here.html").read_text(encoding="utf-8"))
    assert any('raise NotImplementedError("Exercise 1.1: euler_step")' in block for block in start.blocks)
    assert leaks(texts_of(site)) == []
    index = (site / "searchindex.js").read_text(encoding="utf-8")
    assert "restitut" in index and "cone_impulse" in index


@pytest.fixture(scope="module")
def browser():
    playwright = pytest.importorskip("playwright.sync_api", reason="without playwright no page can be driven")
    path = os.environ.get("WORKBOOK_CHROMIUM") or shutil.which("chromium")
    with playwright.sync_playwright() as run:
        chromium = run.chromium.launch(executable_path=path, args=["--no-sandbox"])
        yield chromium
        chromium.close()


ADDED = """wide => {
  const canvas = document.createElement("canvas"), output = document.createElement("div"), image = new Image();
  [canvas.width, canvas.height, output.className] = [wide, 400, "output image_png"];
  image.src = canvas.toDataURL();
  output.append(image);
  document.querySelector(".cell_output").append(output);
  return image.decode();
}"""                         # a figure of that many pixels, among the outputs of the first cell that has any
SIZES = """() => [document.documentElement.scrollWidth,
  Math.max(...[...document.querySelectorAll("article section > p")].map(text => text.getBoundingClientRect().width)),
  [...document.querySelectorAll(".cell_output img")].map(image => image.getBoundingClientRect().width)]"""


@pytest.mark.long
def test_a_book_of_one_notebook_shows_a_figure_as_wide_as_its_type_needs(one_notebook, browser):
    """Lines of text stay short, and no page is wider than its window."""
    page = browser.new_page()
    for window, least in ((1440, PAGE), (1280, 940), (1920, PAGE), (800, 740), (390, 330)):
        page.set_viewport_size({"width": window, "height": 900})
        page.goto((one_notebook[1] / "notebooks" / "00_start_here.html").as_uri())
        page.evaluate(ADDED, PAGE)
        wide, text, figures = page.evaluate(SIZES)
        assert wide == window and text <= 46 * 17.6 and min(figures) >= least, f"{window}: {wide}, {text}, {figures}"
    page.close()


@pytest.mark.long
def test_all_films_of_the_scene_that_grows_play_where_their_script_is_loaded_once(browser, tmp_path, monkeypatch):
    """A page of the book loads a script where it stands first, above the canvases of all later films."""
    shown = []
    monkeypatch.setattr(growing, "display", lambda html: shown.append(html.data))
    for part in ("3.7", "7.4"):
        growing.grow(part)
    (tmp_path / "page.html").write_text("<meta charset=utf-8>" + shown[0] + pages.INLINE.sub("", shown[1]))
    page = browser.new_page()
    page.goto((tmp_path / "page.html").as_uri())
    page.wait_for_function("document.querySelectorAll('canvas[data-playing]').length === 2", timeout=20_000)
    assert page.locator(".film-bar").count() == 2
    page.close()


@pytest.mark.long
def test_the_whole_book_has_no_answer_and_asks_no_other_host(tmp_path):
    site = Path(os.environ["WORKBOOK_BOOK"]) if "WORKBOOK_BOOK" in os.environ else built(tmp_path / "book")[1]
    assert book.outside_requests(site) == [] and book.wrong_links(site) == []
    assert book.size(site) - book.size(site / book.LIVE) < book.MOST and book.size(site / book.LIVE) < book.MOST_LIVE
    assert leaks(texts_of(site)) == []
    for path in execute.NOTEBOOKS.glob("[0-9]*.ipynb"):
        page = (site / "notebooks" / f"{path.stem}.html").read_text(encoding="utf-8")
        assert "katex-error" not in page and "Traceback" not in page and "jupyter.widget" not in page
        if path.stem[:2] != "00":
            assert "not attempted" not in Texts(page).whole and "✗ Exercise" not in page
            figures_of = re.findall(r'<img alt="([^"]*)" [^>]*src="\.\./_images/', page)
            assert figures_of and all(len(alt) > 20 for alt in figures_of)
    assert all(name in (site / "glossary.html").read_text(encoding="utf-8") for name in ("mutant", "warm start"))
