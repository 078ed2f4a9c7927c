"""The still pictures of a report.

Colours: Okabe and Ito 2008, which colour-blind readers can distinguish; every curve has a marker too.
"""

import json
import re
import textwrap
import warnings
from hashlib import sha256
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import TwoSlopeNorm
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from .. import methods
from ..check import Role, Verdict, jsonable
from ..run.store import whole
from . import words

EXACT_RUN = 1e-12               # relative error of a run of many steps that is exact [-]
DRAWN_FROM = "drawn from data "
MARK = re.compile(f"<!-- {DRAWN_FROM}(?P<data>[0-9a-f]+)( as (?P<text>[0-9a-f]+))? -->\\n$")
NOTE = {"xycoords": ("axes fraction", "data"), "fontsize": 9, "color": "#555555"}
TOP = 10.0                      # errors above this, and failures, are drawn here, as crosses [-]
WIDTH, HEIGHT = 5.2, 3.4        # of the axes with their labels [in]: as wide as a phone shows without shrinking letters
PAGE = 10.0                     # widest figure of a notebook [in]: a page shrinks what is wider, and its letters
LARGEST, SMALLEST = 8.0, 4.5    # markers of the lowest and of the uppermost curve [pt]
MARKERS = "o^sDvP<>hdX*p8H"     # of the things in a stability picture that are no method
DASHES = ("-", (0, (5, 2)), (0, (1, 1.5)), (0, (5, 2, 1, 2)), (0, (8, 3)), (0, (3, 2, 1, 2, 1, 2)))


def style():
    plt.rcParams.update({"svg.fonttype": "none", "font.family": "sans-serif", "font.size": 10, "axes.spines.top": False,
                         "axes.spines.right": False, "axes.grid": True, "grid.color": "#e6e6e6", "axes.axisbelow": True,
                         "legend.frameon": False, "svg.hashsalt": "workbook"})


def looks(result):
    """Return {label: how it is drawn} of every curve of a scene.

    Curves may lie on each other, so each has smaller markers than the one below it; engines have crosses and rings,
    which show what is below.
    """
    curves = {c["label"]: c for one in result["cases"].values() for c in one["ours"] + one["engines"]}
    look = {}
    for (label, c), size in zip(curves.items(), np.linspace(LARGEST, SMALLEST, len(curves))):
        wide = {"ms": LARGEST + 1.0, "mfc": "none"} if Role(c["role"]) is Role.ENGINE else {"ms": size}
        look[label] = {"color": c["colour"], "marker": c["marker"], "ls": c["line"], **wide}
    return look


def error_label(result):
    return "relative error [-]" if not result["moves"] else f"relative error at t = {result['T']:g} s [-]"


def floor(result):
    """Return the error [-] below which nothing can be decided: round-off, or the uncertainty of the truth."""
    return max(EXACT_RUN, 10.0 * result["uncertainty"])


def _ground(axes, bottom):
    """Name the line on which runs lie that are right to the last digit that can be told, if there are any."""
    if any(np.any(np.asarray(line.get_ydata(), dtype=float) == bottom) for line in axes.lines):
        axes.axhline(bottom, color="#999999", lw=0.6)
        low, high = axes.get_ylim()
        axes.set_ylim(low * (low / high) ** 0.05, high)              # room for words below the markers on the line
        axes.annotate("error too small to tell", (0.01, bottom), xytext=(0, -6), textcoords="offset points", va="top",
                      **NOTE)


def convergence(path, result):
    """Plot error against step, with the runs that failed along the top."""
    case, bottom, look_of = next(iter(result["cases"].values())), floor(result), looks(result)
    figure, axes = plt.subplots()
    for c in case["ours"] + case["engines"]:
        if Verdict(c["verdict"]) is Verdict.NOT_ATTEMPTED or not c["rows"]:
            continue
        look = look_of[c["label"]]
        colour, marker = c["colour"], c["marker"]
        lost = [r["dt"] for r in c["rows"] if r["error"] is None or r["error"] >= TOP]
        # a line has a gap where a run was lost
        seen = [(r["dt"], np.nan if r["dt"] in lost else max(r["error"], bottom)) for r in c["rows"]]
        order = f": {words.slope(c)}" if words.shows_order(c) else ""
        own = [(row["dt"], max(error, bottom)) for row, error in words.own_errors(c) if error < TOP]
        if len(lost) < len(seen):
            axes.loglog(*zip(*seen), **look, lw=1.3, label=c["label"] + (order if not own else ""))
        if own:                                                      # the order is that of this second line
            axes.loglog(*zip(*own), color=colour, marker=marker, ls=(0, (4, 2)), ms=5, lw=1.0, mfc="none",
                        label=f"{c['label']}, from its own law{order}")
        axes.plot(lost, [TOP] * len(lost), color=colour, marker="X", ls="", ms=7, clip_on=False)
    axes.set(xlabel=result["refinement"], ylabel=error_label(result), xscale="log", yscale="log")
    axes.axhline(TOP, color="#999999", lw=0.6)
    axes.annotate("failed, or error above 10", (0.01, TOP), va="bottom", **NOTE)
    _ground(axes, bottom)
    _finish(figure, axes, path, "method: measured order")


def work_precision(path, result):
    """Plot error against run time: compiled solid, plain faint, engines dark.

    If more steps took less time, the machine was not quiet.  A line would run backwards, so none is drawn.
    """
    figure, axes = plt.subplots()
    bottom, look = floor(result), looks(result)
    rows = [{**r, "error": max(r["error"], bottom)} for r in result["times"]["rows"] if r["error"] < TOP]
    compiled = any(r["speed"] == "compiled" for r in rows)
    for label, speed in dict.fromkeys((r["label"], r["speed"]) for r in rows):
        mine = sorted((r["steps"], r["seconds"], r["error"], r["low"], r["high"]) for r in rows
                      if (r["label"], r["speed"]) == (label, speed))
        _, x, y, low, high = zip(*mine)
        plain = compiled and speed == "plain"
        faint = {**look[label], "ls": ":", "ms": 3, "lw": 0.9, "alpha": 0.55}
        name = f"{label} (recorded)" if speed == "recorded" else label
        drawn = faint if plain else {**look[label], "lw": 1.4, "label": name}
        axes.loglog(x, y, **(drawn if np.all(np.diff(x) > 0.0) else {**drawn, "ls": ""}))
        axes.hlines(y, low, high, color=look[label]["color"], lw=0.8, alpha=0.5)
    if compiled and any(r["speed"] == "plain" for r in rows):
        axes.plot([], [], color="#555555", ls=":", marker=".", label="the same, plain Python")
    errors = {r["error"] for r in rows}
    if len(errors) == 1:                                             # the axis would have no length
        axes.set_ylim(0.1 * min(errors), 10.0 * min(errors))
    _ground(axes, bottom)
    time_label = "run time of the stepping loop [s]" if result["moves"] else "run time [s]"
    axes.set(xlabel=time_label, ylabel=error_label(result))
    _finish(figure, axes, path, "compiled, and engines" if compiled else "plain Python, and engines")


def stability(path, case):
    """Plot a stability case's own picture: curves, or maps with theory's curve over them."""
    picture = case["picture"]
    if not picture:
        return
    if picture.get("maps"):
        maps(path, picture)
        return
    figure, axes = plt.subplots()
    labels = [label for label, *_ in picture["series"]]
    measured = {thing_of(label) for label, _, _, mark in picture["series"] if mark == "dots"}
    looks = zip(series_colours(labels), series_markers(labels), series_dashes(labels))
    for (label, xs, ys, mark), (colour, marker, dashes) in zip(picture["series"], looks):
        few = len(xs) <= 60
        look = ({"ls": "", "marker": marker, "ms": 5 if few else 2, "zorder": 2} if mark == "dots" else
                {"ls": "-" if thing_of(label) in measured else dashes, "zorder": 3})
        axes.plot(xs, ys, color=colour, label=label, lw=1.4, **look)
    axes.set(xlabel=picture["x_label"], ylabel=picture["y_label"])
    if path is None:
        axes.set_title(picture["title"])
    _finish(figure, axes, path, None)


def maps(path, picture):
    """Plot one small map for each method: the amplification of a step, with theory's edge of stability over it."""
    figure, every = plt.subplots(2, (len(picture["maps"]) + 1) // 2, sharex=True, sharey=True, squeeze=False)
    for axes, one in zip(every.flat, picture["maps"]):
        values, (low, high) = np.array(one["values"], dtype=float), picture["range"]
        drawn = axes.pcolormesh(one["xs"], one["ys"], np.clip(values, low, high), cmap="RdBu_r", rasterized=True,
                                norm=TwoSlopeNorm(1.0, low, high), shading="nearest")
        axes.plot(*one["curve"], color="#111111", lw=1.6)
        axes.set(title=one["label"], xlim=(one["xs"][0], one["xs"][-1]), ylim=(one["ys"][0], one["ys"][-1]))
        axes.title.set_fontsize(9.5)
        axes.grid(False)
    for axes in every.flat[len(picture["maps"]):]:
        axes.set_visible(False)
    figure.supxlabel(picture["x_label"], fontsize=10)
    figure.supylabel(picture["y_label"], fontsize=10)
    figure.set_size_inches(WIDTH, 4.4)
    figure.subplots_adjust(left=0.12, right=0.83, bottom=0.12, top=0.93, wspace=0.12, hspace=0.22)
    bar = figure.colorbar(drawn, cax=figure.add_axes((0.855, 0.12, 0.025, 0.81)))
    bar.set_label("amplification by one step [-]", fontsize=9)
    _save(figure, path)


def thing_of(label):
    """Return what a curve is of, without whether it is theory's or measured."""
    return THEORY_OR_MEASURED.sub("", label)


THEORY_OR_MEASURED = re.compile(r"^theory, |, (theory|measured)$|: .*$")


def series_colours(labels):
    """Return a colour each: a method has its own, theory and measurement of one thing share theirs,
    and no two things have one.
    """
    things, colours = [thing_of(label) for label in labels], {}
    known = {method.label: method.colour for method in all_methods()}
    for thing in things:
        own = max((name for name in known if thing.startswith(name)), key=len, default=None)
        if own and known[own] not in colours.values():
            colours[thing] = known[own]
    free = iter([colour for colour in dict.fromkeys(known.values()) if colour not in colours.values()])
    for thing in things:
        if thing not in colours:
            colours[thing] = next(free, "#000000")
    return [colours[thing] for thing in things]


def series_markers(labels):
    """Return a marker for each series: a method has its own, and no two series share one as far as there are enough."""
    things = list(dict.fromkeys(map(thing_of, labels)))
    known = {method.label: method.marker for method in all_methods()}
    markers = {}
    for thing in things:
        own = max((name for name in known if thing.startswith(name)), key=len, default=None)
        if own and known[own] not in markers.values():
            markers[thing] = known[own]
    free = iter([marker for marker in MARKERS if marker not in markers.values()])
    for thing in things:
        if thing not in markers:
            markers[thing] = next(free, "o")
    return [markers[thing_of(label)] for label in labels]


def series_dashes(labels):
    """Return a dash pattern each: lines that have no markers are told apart without their colours."""
    things = list(dict.fromkeys(map(thing_of, labels)))
    return [DASHES[things.index(thing_of(label)) % len(DASHES)] for label in labels]


def all_methods():
    return [method for method in vars(methods).values() if isinstance(method, methods.Method)]


def show(plot, result):
    """Draw one of the plots where a notebook shows it."""
    plot(None, result)


def digest(data):
    """Return a fingerprint of the data that a picture shows: `validate audit` looks for it in the picture."""
    return sha256(json.dumps(jsonable(data), sort_keys=True).encode()).hexdigest()[:16]


def draw(plot, path, data):
    """Draw one of the plots into a file, without a screen; its last line names the data and the text before it."""
    plt.switch_backend("svg")
    style()
    with whole(path) as draft, warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")                              # of a diagram in which every run was lost
        plot(draft, data)
        text = for_both_schemes(draft.read_text(encoding="utf-8"))
        draft.write_bytes(f"{text}<!-- {DRAWN_FROM}{digest(data)} as {of_text(text)} -->\n".encode())


def of_text(text):
    """Return a fingerprint of the text of a picture."""
    return sha256(text.encode()).hexdigest()[:16]


def marked_data(picture):
    """Return the fingerprint of the data in the mark of a picture; None without a mark."""
    found = MARK.search(picture)
    return found and found["data"]


def is_as_drawn(picture):
    """Return whether a picture with a mark is the text that was drawn, as far as the mark says: older ones do not."""
    found = MARK.search(picture)
    return found["text"] in (None, of_text(picture[:found.start()]))


# ---------------------------------------------------------------------------------------------- light and dark

DARK = Path(__file__).with_name("dark.css")
COLOUR = re.compile(r"(fill|stroke): (#[0-9a-f]{6})")


def css_colour(colour):
    """Return a colour that a dark page may replace by a lighter one."""
    return f"var(--c{colour.lower().replace('#', '-')}, {colour.lower()})"


def for_both_schemes(svg):
    """Return an SVG whose letters, lines and dark colours follow the reader's light or dark scheme."""
    svg = COLOUR.sub(lambda found: f"{found[1]}: {css_colour(found[2])}", svg)
    style = f"<style>{DARK.read_text(encoding='utf-8')} text {{ fill: var(--c-000000, #000) }}</style>"
    return re.sub(r"(<svg[^>]*>)", lambda found: found[1] + style, svg, count=1)


DECADE = 1.05                   # length of the shortest logarithmic axis [decades]
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def _power(x, _):
    """Return 10⁻³ or 2·10⁻³ as plain text, which is drawn in a third of the time of a formula."""
    exponent = int(np.floor(np.log10(x) + 1e-9))
    lead = f"{x / 10.0**exponent:.2g}"
    return f"{'' if lead == '1' else f'{lead}·'}10{str(exponent).translate(RAISED)}"


def tick(axis):
    """Label powers of ten on a logarithmic axis, and 2 and 5 as well if it has fewer than two of them.

    More labels would overlap.  An axis has a decade at least, so that three labels are on it.
    """
    if axis.get_scale() == "log":
        low, high = np.log10(np.sort(axis.get_view_interval()))
        more = max(0.0, 0.5 * (DECADE - (high - low)))
        axis.axes.set(**{f"{axis.axis_name}lim": (10.0 ** (low - more), 10.0 ** (high + more))})
        few = high - low + 2.0 * more < 2.0
        axis.set_major_locator(LogLocator())
        axis.set_major_formatter(FuncFormatter(_power))
        axis.set_minor_locator(LogLocator(subs=(2, 5)) if few else NullLocator())
        axis.set_minor_formatter(FuncFormatter(_power))


def _finish(figure, axes, path, title):
    tick(axes.xaxis)
    tick(axes.yaxis)
    if not axes.get_legend_handles_labels()[0]:
        axes.plot([], [], label=" ")
        axes.text(0.5, 0.5, "nothing to draw: no method has been attempted", transform=axes.transAxes, ha="center",
                  color="#555555")
    if path is None:
        axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), fontsize=9, title=title, title_fontsize=9,
                    alignment="left")
        _margins(figure, axes, title)
        plt.show()
        return
    _legend_below(figure, axes, title)
    _save(figure, path)


def _save(figure, path):
    """Write a picture without a background: it is the page's."""
    if path is None:
        plt.show()
        return
    figure.savefig(path, format="svg", metadata={"Date": None}, transparent=True)
    plt.close(figure)


LETTER = 0.076                  # mean width of a letter of the legend [in]: 0.61 of 9 points
LINE = 0.172                    # height of a line of the legend [in], at 9 points
MANY = 8                        # entries of a legend from which on its letters are smaller


def _legend_below(figure, axes, title):
    """Put the legend below the axes, in as many columns as fit, so that the picture is as narrow as a phone."""
    labels = axes.get_legend_handles_labels()[1]
    size = 9 if len(labels) <= MANY else 8
    columns = columns_of(labels, size)
    axes.set_xlabel(textwrap.fill(axes.get_xlabel(), int(WIDTH / LETTER) - 12))
    lines = -(-len(labels) // columns) + bool(title) + axes.get_xlabel().count("\n")
    below, height = 0.55 + LINE * size / 9.0 * lines, HEIGHT + LINE * size / 9.0 * lines
    figure.set_size_inches(WIDTH, height)
    left = 0.8
    figure.subplots_adjust(left / WIDTH, below / height, 1.0 - 0.25 / WIDTH, 1.0 - 0.22 / height)
    figure.legend(*axes.get_legend_handles_labels(), loc="lower left", bbox_to_anchor=(0.01, 0.0), fontsize=size,
                  title=title, title_fontsize=size, alignment="left", ncols=columns, columnspacing=1.2, borderpad=0.2,
                  handlelength=2.2, labelspacing=0.35)


def columns_of(labels, size):
    """Return the number of columns, at most three, that a legend in letters of this size [pt] has room for."""
    def width(column):
        return (0.62 + 0.95 * LETTER * max(map(len, column))) * size / 9.0
    for count in (3, 2):
        if count <= len(labels) and sum(map(width, np.array_split(labels, count))) <= WIDTH:
            return count
    return 1


def _margins(figure, axes, title):
    """Leave room for labels and legend by their length in letters: finding it by drawing twice takes twice as long."""
    longest = max(map(len, [title or "", *axes.get_legend_handles_labels()[1]]))
    left, bottom, top, right = 0.85, 0.6, 0.35, 0.6 + LETTER * longest
    width, height = min(6.0 + left + right, PAGE), 4.0 + bottom + top
    figure.set_size_inches(width, height)
    figure.subplots_adjust(left / width, bottom / height, 1.0 - right / width, 1.0 - top / height)
