"""The notebooks run from first cell to last with nothing attempted, half done and solved; stored without outputs."""

import ast
import importlib.util
import json
import re
import symtable
from dataclasses import fields
from html import escape
from itertools import pairwise
from pathlib import Path

import nbformat
import pytest
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

from validate.notebook import figures, has_pymunk
from validate.scene import Scene
from validate.subject import modules
from validate.subject.generate import exercises, stub
from validate.subject.modules import ROOT, SOLUTIONS, lesson_names

from .drawn_type import DOTS, LEAST, PAGE, smallest_type
from .kernels import kernel, ran

HASTE = """import validate.notebook, matplotlib
from validate.measure import selection
matplotlib.rcParams["figure.dpi"] = 20
selection.NOTEBOOK = 0.002
# no reader looks at these figures, and no reader sees these times
%config InlineBackend.print_figure_kwargs = {"bbox_inches": None}"""
# the kernel's `tests` may be those of another package
MEASURED = f"""import sys
sys.path.append({str(Path(__file__).parent)!r})
import drawn_type
drawn_type.install()"""
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
SHORT = {"00"}               # notebooks that the default tests run, half done; --long runs all, in three states
STATES = {"nothing attempted": 0.0, "half done": 0.5, "solved": 1.0}  # share of the exercises, from the first on


def answered(state):
    """{lesson: exercises that are solved in that state}."""
    every = {name: list(exercises((SOLUTIONS / f"{name}.py").read_text())) for name in lesson_names()}
    return {name: set(numbers[:round(STATES[state] * len(numbers))]) for name, numbers in every.items()}


def described(said):
    """(description, smallest type) of each figure that a cell showed.

    The description is the same beside the PNG and in the HTML.
    """
    shown = [content for content in json.loads(said) if "image/png" in content.get("data", {})]
    for content in shown:
        alt = content["metadata"]["image/png"]["alt"]
        assert content["data"]["text/html"].startswith(f'<img alt="{escape(alt)}"')
        yield alt, content["metadata"]["image/png"]["type"]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_stored_without_outputs(path):
    for cell in nbformat.read(path, as_version=4).cells:
        assert cell.cell_type != "code" or (not cell.outputs and cell.execution_count is None)


def names_of(source):
    """(names that this code assigns, names that it or a function in it takes from outside)"""
    table = symtable.symtable(source, "cell", "exec")
    tables = [table]
    for one in tables:
        tables += one.get_children()
    taken = {s.get_name() for one in tables for s in one.get_symbols()
             if s.is_referenced() and (one is table or s.is_global())}
    return {s.get_name() for s in table.get_symbols() if s.is_assigned() or s.is_imported()}, taken


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_no_cell_reads_a_name_that_two_cells_before_it_assign(path):
    """Otherwise a figure depends on which cells were run, and a new cell changes the figures below it.

    Only `lesson` is assigned again and again: it is what the learner has saved last.  Nor may a function read a name
    that another cell assigns before the function is called.
    """
    cells = [cell.source for cell in nbformat.read(path, as_version=4).cells if cell.cell_type == "code"]
    assigned, taken = zip(*map(names_of, cells), strict=True)
    for k in range(len(cells)):
        for name in taken[k] - assigned[k] - {"lesson"}:
            places = [j for j in range(k) if name in assigned[j]]
            assert len(places) < 2, f"cell {k} reads {name} of the cells {places}"
        for function in (node for node in ast.parse(cells[k]).body if isinstance(node, ast.FunctionDef)):
            for name in names_of(ast.unparse(function))[1] - {"lesson"}:
                again = [j for j in range(k + 1, len(cells)) if name in assigned[j]]
                called = [j for j in range(k + 1, len(cells)) if function.name in taken[j] - assigned[j]]
                assert not again or not called or max(called) < min(again), (
                    f"{function.name} of cell {k} reads {name}; cell {min(again)} assigns it, cell {max(called)} calls")


def shown_type(width, size, legend=None):
    """smallest_type of a figure that is so many inches wide; the names of its ticks are large."""
    figure, axes = plt.subplots(figsize=(width, 3.0), layout=None if legend else "constrained")
    axes.set_title("a title", fontsize=size)
    axes.tick_params(labelsize=30)
    if legend:
        axes.plot([0, 1], label=legend)
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=20)
    figure.canvas.draw()
    found = smallest_type(figure)
    plt.close(figure)
    return found


def test_the_size_of_type_is_that_on_the_page():
    """A figure that is wider than the page is shown smaller, and so is one whose legend stands beside the plot."""
    for width, size in ((8.0, 10.0), (8.0, 8.0), (20.0, 10.0), (20.0, 20.0)):
        points, text = shown_type(width, size)
        assert text == "a title" and abs(points / (size / 96.0 * min(DOTS, PAGE / width)) - 1.0) < 0.03
    assert shown_type(9.6, 10.0)[0] > LEAST > shown_type(9.6, 10.0, legend="a legend of many words, and large")[0]


def test_a_picture_of_a_failing_case_has_type_of_at_least_nine_points():
    from validate.notebook import cases
    from validate.notebook.cases import marks
    for views in (1, 2):
        figure = marks.picture(views * [marks._FLAT], [], [], [])[0]
        figure.canvas.draw()
        assert smallest_type(figure, cases.SHOWN)[0] >= LEAST


@pytest.mark.parametrize("path", [path for path in NOTEBOOKS if path.stem[:2] != "00"], ids=lambda path: path.stem)
def test_a_lesson_is_told_in_the_same_way_everywhere(path):
    cells = nbformat.read(path, as_version=4).cells
    text = "\n\n".join(cell.source for cell in cells if cell.cell_type == "markdown")
    code = [cell for cell in cells if cell.cell_type == "code"]
    lesson = path.stem.partition("_")[2]
    numbers = exercises((SOLUTIONS / f"{lesson}.py").read_text())
    for heading in ("| **You need** |", "| **Lessons before** |", "| **Time** |", "**Afterwards you can**",
                    "## The idea", "## Break it", "## What this scene leaves out", "## Make it (★★★)", "## The scene",
                    "## What you know now", "**Read on.**", "## Three questions"):
        assert text.count(heading) == 1, heading
    assert f"| {len(numbers)}, 20 points" in text
    assert text.count("<details><summary>Answer</summary>") == 3
    stars = dict(re.findall(rf"`\w+` \(({path.stem[:2].lstrip('0')}\.\d+) (★+)\)", text))
    assert stars.keys() == numbers.keys()
    found = {number for number, hard in stars.items() if hard == "★★"}
    assert len(found) >= 3 / 8 * len(numbers) and {"★", "★★"} <= set(stars.values()) <= {"★", "★★", "★★★"}
    for number in found:
        assert "*Find*" in getattr(modules.bind(lesson), numbers[number]).__doc__
        assert f"<details><summary>Hint for {number}</summary>" in text
    assert [cell.source for cell in code if cell.source.startswith("check(")] == [f'check("{n}")' for n in numbers]
    places = {cell.source: k for k, cell in enumerate(cells) if cell.source.startswith(("check(", "progress("))}
    outlook = next(k for k, cell in enumerate(cells) if cell.source.startswith("## The scene, "))
    assert max(places.values()) == places[f'progress("{lesson}")'] < outlook, "progress follows the last exercise"
    hidden = [cell for cell in code if "plt." in cell.source or cell is code[0]]
    assert all(cell.metadata.get("jupyter", {}).get("source_hidden") for cell in hidden)
    assert not any("plt.show()" in cell.source for cell in code)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_something_to_see_follows_every_check_and_words_follow_every_figure(path):
    """A choice has its figure before its check.  What follows the sliders is said before them."""
    cells = nbformat.read(path, as_version=4).cells
    for cell, after in pairwise(cell.source for cell in cells if cell.cell_type == "code"):
        seen = not after.startswith(("check(", "progress("))
        assert seen or not cell.startswith("check(") or cell in chosen(cells), cell
    for cell, after in pairwise(cells):
        if cell.cell_type == "code" and "show_figure()" in cell.source and "@interact" not in cell.source:
            assert after.source.startswith("*What to see:*"), cell.source


def chosen(cells):
    """The checks of choices: the first code cell behind each figure of four curves."""
    code = [cell.source for cell in cells if cell.cell_type == "code"]
    return [after for cell, after in pairwise(code) if "show_choice(" in cell]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_measures_scenes_with_fields_that_they_have(path):
    known = {"most_steps", "without", *(field.name for field in fields(Scene))}
    code = [cell.source for cell in nbformat.read(path, as_version=4).cells if cell.cell_type == "code"]
    for node in (node for source in code if "measured(" in source for node in ast.walk(ast.parse(source))):
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "measured":
            assert {keyword.arg for keyword in node.keywords} <= known, ast.unparse(node)


@pytest.mark.parametrize(("path", "states"), [
    *(pytest.param(path, ("half done",), id=f"{path.stem}-half done") for path in NOTEBOOKS if path.stem[:2] in SHORT),
    *(pytest.param(path, tuple(STATES), id=f"{path.stem}-three states", marks=pytest.mark.long) for path in NOTEBOOKS)])
def test_a_notebook_runs_to_its_end_and_its_checks_say_the_state(path, states, tmp_path):
    """One kernel, as at a student's desk: run from first cell to last, write more of the lessons, forget every name,
    run again.

    A check whose exercise is as it was in the state before is not asked again.
    """
    known = {}
    cells = [cell.source for cell in nbformat.read(path, as_version=4).cells if cell.cell_type == "code"]
    with kernel(ROOT / "notebooks") as client:
        ran(client, f"{HASTE}\n{MEASURED}")
        for state, solved in ((state, answered(state)) for state in states):
            for name in lesson_names():
                (tmp_path / state).mkdir(exist_ok=True)
                (tmp_path / state / f"{name}.py").write_text(stub((SOLUTIONS / f"{name}.py").read_text(), solved[name]))
            ran(client, f"%reset -f\n%env WORKBOOK_LESSONS={tmp_path / state}")
            for source in cells:
                asked = re.match(r'check\("([\d.]+)"\)', source)
                expected = "passed" if asked and any(asked[1] in numbers
                                                     for numbers in solved.values()) else "not attempted"
                if asked and known.get(asked[1]) == expected:
                    continue
                said = ran(client, source)
                failed = re.search(r"✗ \w+Error: [^<]*", said)
                assert not failed, f"right answers end in {failed[0]}:\n{source}"
                for alt, (size, text) in described(said):
                    assert len(alt) > 20 and alt != figures.NOTHING, f"a figure has too few words ({alt}):\n{source}"
                    assert size >= LEAST, f"{text!r} has {size:.1f} points on a page of {PAGE} px:\n{source}"
                if asked:
                    assert f"Exercise {asked[1]}: {expected}" in said, f"{state}: {said}"
                    known[asked[1]] = expected


ABSENT = "pymunk", "pybullet", "mujoco", "numba"         # modules that a browser does not have
ALONE = f"""import importlib.metadata, sys
for name in {ABSENT}:
    sys.modules[name] = None
def version(name, known=importlib.metadata.version):
    if name.removesuffix("-core") in {ABSENT}:
        raise importlib.metadata.PackageNotFoundError(name)
    return known(name)
importlib.metadata.version = version"""


@pytest.mark.long
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_solved_notebook_runs_to_its_end_without_engines_and_compiler(path, tmp_path):
    """As in a browser.  The checks run in a process of their own, which has all modules, so they are left out."""
    for name in lesson_names():
        (tmp_path / f"{name}.py").write_text((SOLUTIONS / f"{name}.py").read_text())
    cells = [cell.source for cell in nbformat.read(path, as_version=4).cells if cell.cell_type == "code"]
    with kernel(ROOT / "notebooks", WORKBOOK_LESSONS=str(tmp_path), WORKBOOK_LIVE="film") as client:
        ran(client, f"{ALONE}\n{HASTE}")
        said = [ran(client, source) for source in cells if not re.match(r"(check|progress)\(", source)]
    assert not any("No module named" in one or "ModuleNotFoundError" in one for one in said)
    asks = sum("has_pymunk(" in source for source in cells)
    assert sum("pymunk is not installed here. Its stored results are on" in one for one in said) == asks


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_cell_that_runs_pymunk_first_asks_whether_it_is_there(path):
    """In a browser it is not.  The sentence about that leads to the executed notebook, so it must name this one."""
    code = [cell.source for cell in nbformat.read(path, as_version=4).cells if cell.cell_type == "code"]
    for source in code:
        named = set(re.findall(r'has_pymunk\("(\w+)"\)', source))
        runs = re.search(r"^\s+import pymunk|chipmunk\.build\(", source, re.M)
        assert named == ({path.stem} if runs else set()), source


def test_where_pymunk_is_missing_a_sentence_leads_to_its_stored_results(monkeypatch):
    shown = []
    monkeypatch.setattr("validate.notebook.display", lambda html: shown.append(html.data))
    monkeypatch.setattr("validate.engines.products.version", lambda name: "1.0")
    assert has_pymunk("09_contact") and not shown
    monkeypatch.setattr("validate.engines.products.Product.installed", lambda product: None)
    monkeypatch.setenv("WORKBOOK_PAGES", "https://example.org/book/notebooks/")
    assert not has_pymunk("09_contact")
    assert shown == ['<p>pymunk is not installed here. Its stored results are on <a href="https://example.org/book/'
                     'notebooks/09_contact.html" target="_blank">the page of this notebook in the book</a>.</p>']
    monkeypatch.delenv("WORKBOOK_PAGES")
    assert not has_pymunk("09_contact") and "are on the page of this notebook in the book." in shown[1]


def test_a_lesson_that_cannot_be_loaded_is_told_and_the_engines_run_alone(tmp_path, monkeypatch, capsys):
    from validate.notebook import measured, scene_of
    (tmp_path / "friction.py").write_text("def normal_force(:\n")
    monkeypatch.setenv("WORKBOOK_LESSONS", str(tmp_path))
    monkeypatch.setattr("validate.notebook.display", lambda shown: print(shown.data))
    monkeypatch.setattr("validate.measure.selection.NOTEBOOK", 0.002)            # no reader sees these times
    result = measured("stick_slip", 50)
    case = next(iter(result["cases"].values()))
    assert case["ours"] == [] and case["engines"] and scene_of("stick_slip").title
    assert "friction.py cannot be loaded: SyntaxError: invalid syntax (friction.py, line 1)" in capsys.readouterr().out


def test_a_film_has_the_look_of_its_methods(monkeypatch):
    from validate import methods
    from validate.notebook import play
    shown = []
    monkeypatch.setattr("validate.notebook.display", lambda one: shown.append(one.data))
    frames = [[[0.0, 0.0]], [[1.0, 0.0]]]
    play({"mine": frames}, 1.0, shown_as={"mine": methods.RK4})
    assert f'"colour": "{methods.RK4.colour}", "frames"' in shown[0] and '"marker": "s"' in shown[0]
    assert f'color:{methods.RK4.colour}">■</span> mine' in shown[0]
    play({"mine": frames}, 1.0)
    assert '"marker"' not in shown[1] and "●</span> mine" in shown[1]
    play({"beside it": frames, "mine": frames}, 1.0, shown_as={"mine": methods.DAMPED})
    assert shown[2].count(f'"colour": "{methods.DAMPED.colour}"') == 1       # which is the first colour of the others


def test_a_figure_is_described_by_its_labels_and_by_where_its_curves_end():
    figure, empty = Figure(), Figure()
    left, right = figure.subplots(1, 2, sharey=True)
    left.plot([0, 1, 2], [1.0, 0.5, -0.25], label="Euler, $\\mu_s$ = 1")
    left.set(title="a spring", xlabel="t [s]", ylabel="x [m]")
    left.legend(title="method")
    right.plot([0, 1], [0, 1])
    right.text(0, 0, "a wall")
    right.set(xlabel="t [s]", aspect="equal")
    assert figures.describe(figure) == (
        "Plot: a spring; x [m] against t [s]; curves (method): “Euler, μ_s = 1” from 1 at 0 to -0.25 at 2. "
        "Plot: x [m] against t [s]; words: a wall.")
    assert figures.describe(empty) == figures.NOTHING
    axes = empty.subplots()
    axes.bar([0, 1], [1.25, 0.5], label="Ixx")
    axes.set_xticks([0, 1], ["a box", "a rod"])
    assert figures.describe(empty) == "Plot: bars at: a box, a rod; lengths: “Ixx” 1.25, 0.5."


def test_a_figure_is_shown_with_its_description_and_drawn_once():
    """As HTML, because JupyterLab shows the words of HTML only, and as PNG, for everything else."""
    from IPython.core.interactiveshell import InteractiveShell
    from IPython.core.pylabtools import select_figure_formats
    shell, drawings = InteractiveShell(), []

    class Counted(Figure):
        def draw(self, renderer):
            drawings.append(self)
            super().draw(renderer)
    figure = Counted()
    figure.subplots().set(xlabel="t [s]", ylabel='"x" [m]')
    figures.install(shell)
    for options in ({}, {"facecolor": "red"}):             # the second call replaces what IPython draws with
        select_figure_formats(shell, {"png"}, bbox_inches=None, **options)
        drawings.clear()
        data, metadata = shell.display_formatter.format(figure)
        assert len(drawings) == 1 and metadata["image/png"]["alt"] == 'Plot: "x" [m] against t [s].'
        assert data["text/html"] == ('<img alt="Plot: &quot;x&quot; [m] against t [s]." '
                                     f'src="data:image/png;base64,{data["image/png"].strip()}">')
    select_figure_formats(shell, {"svg"})
    assert {"image/png", "text/html"}.isdisjoint(shell.display_formatter.format(figure)[0])


def test_a_narrow_logarithmic_axis_names_few_numbers(monkeypatch):
    """Unless the cell has chosen its own."""
    from validate import notebook
    figure, (plain, chosen) = notebook.plt.subplots(1, 2)
    for axes in (plain, chosen):
        axes.loglog([2e-4, 9e-4], [1.0, 2.0])
    chosen.set_xticks([3e-4], ["mine"])
    monkeypatch.setattr(notebook.plt, "show", figure.canvas.draw)
    notebook.show_figure()
    named = [[tick.get_text() for tick in axes.get_xticklabels(which="both")] for axes in (plain, chosen)]
    notebook.plt.close(figure)
    assert {"2·10⁻⁴", "5·10⁻⁴"} <= set(named[0]) and not any("times" in name for name in named[0])
    assert named[1][0] == "mine"


def test_words_can_be_read_on_white_and_on_black():
    """WCAG 2: a contrast of 4.5 or more, on white and on JupyterLab's dark #111111."""
    from validate.notebook import DARK, LIGHT

    def luminance(colour):
        parts = [int(colour[k:k + 2], 16) / 255.0 for k in (1, 3, 5)]
        linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
    assert LIGHT.keys() == DARK.keys()
    assert all(1.05 / (luminance(colour) + 0.05) >= 4.5 for colour in LIGHT.values())
    assert all((luminance(colour) + 0.05) / (luminance("#111111") + 0.05) >= 4.5 for colour in DARK.values())


@pytest.mark.parametrize("path", sorted((ROOT / "notebooks").glob("*.ipynb")), ids=lambda path: path.stem)
def test_what_a_notebook_imports_of_the_workbook_is_there(path):
    """A cell may import what no default test of its notebook runs."""
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    text = "\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "code")
    for name in set(re.findall(r"^\s*(?:from|import) ((?:validate|solutions)[\w.]*)", text, re.M)):
        assert importlib.util.find_spec(name), name
