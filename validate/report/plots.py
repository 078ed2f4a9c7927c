"""The still pictures.

Colours: Okabe and Ito 2008, told apart by colour-blind readers; every curve has a marker too.
"""

import json
import re
import warnings
from hashlib import sha256

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from .. import methods
from ..results import Verdict, jsonable
from ..store import whole

EXACT_RUN = 1e-12               # relative error of a run of many steps that is exact [-]
DRAWN_FROM = "drawn from data "
NOTE = {"xycoords": ("axes fraction", "data"), "fontsize": 8, "color": "#555555"}
TOP = 10.0                      # errors above this, and failures, are drawn here, as crosses [-]


def style():
    plt.rcParams.update({"svg.fonttype": "none", "font.family": "sans-serif", "font.size": 10, "axes.spines.top": False,
                         "axes.spines.right": False, "axes.grid": True, "grid.color": "#e6e6e6", "axes.axisbelow": True,
                         "legend.frameon": False, "svg.hashsalt": "workbook"})


def looks(result):
    """{label: (colour, marker, line)} of every curve of a scene."""
    curves = (c for one in result["cases"].values() for c in one["ours"] + one["engines"])
    return {c["label"]: (c["colour"], c["marker"], c["line"]) for c in curves}


def error_label(result):
    return "relative error [-]" if not result["moves"] else f"relative error at t = {result['T']:g} s [-]"


def floor(result):
    """Error [-] below which nothing can be told: round-off, or what the truth is not known to."""
    return max(EXACT_RUN, 10.0 * result["uncertainty"])


def _ground(axes, bottom):
    """Name the line on which runs lie that are right to the last digit that can be told, if there are any."""
    if any(np.any(np.asarray(line.get_ydata(), dtype=float) == bottom) for line in axes.lines):
        axes.axhline(bottom, color="#999999", lw=0.6)
        axes.annotate("no error that can be told", (0.01, bottom), va="top", **NOTE)


def convergence(path, result):
    """Error against step, with the runs that failed along the top."""
    case, bottom = next(iter(result["cases"].values())), floor(result)
    figure, axes = plt.subplots()
    for c in case["ours"] + case["engines"]:
        if Verdict(c["verdict"]) is Verdict.NOT_ATTEMPTED or not c["rows"]:
            continue
        colour, marker, line = c["colour"], c["marker"], c["line"]
        lost = [r["dt"] for r in c["rows"] if r["error"] is None or r["error"] >= TOP]
        # a line has a gap where a run was lost
        seen = [(r["dt"], np.nan if r["dt"] in lost else max(r["error"], bottom)) for r in c["rows"]]
        order = f": {c['order']:.2f}" if c["order"] is not None else ""
        if len(lost) < len(seen):
            axes.loglog(*zip(*seen), color=colour, marker=marker, ls=line, ms=5, lw=1.3, label=c["label"] + order)
        axes.plot(lost, [TOP] * len(lost), color=colour, marker="X", ls="", ms=7, clip_on=False)
    axes.set(xlabel=result["refinement"], ylabel=error_label(result), xscale="log", yscale="log")
    axes.axhline(TOP, color="#999999", lw=0.6)
    axes.annotate("failed, or error above 10", (0.01, TOP), va="bottom", **NOTE)
    _ground(axes, bottom)
    _finish(figure, axes, path, "method: measured order")


def work_precision(path, result):
    """Error against run time: compiled solid, plain faint, engines dark."""
    figure, axes = plt.subplots()
    bottom, look = floor(result), looks(result)
    rows = [{**r, "error": max(r["error"], bottom)} for r in result["times"]["rows"] if r["error"] < TOP]
    compiled = any(r["speed"] == "compiled" for r in rows)
    for label, speed in dict.fromkeys((r["label"], r["speed"]) for r in rows):
        colour, marker, line = look[label]
        mine = sorted((r["steps"], r["seconds"], r["error"], r["low"], r["high"]) for r in rows
                      if (r["label"], r["speed"]) == (label, speed))
        _, x, y, low, high = zip(*mine)
        plain = compiled and speed == "plain"
        faint = {"ls": ":", "ms": 3, "lw": 0.9, "alpha": 0.55}
        name = f"{label} (recorded)" if speed == "recorded" else label
        strong = {"ls": line, "ms": 5, "lw": 1.4, "label": name}
        axes.loglog(x, y, color=colour, marker=marker, **(faint if plain else strong))
        axes.hlines(y, low, high, color=colour, lw=0.8, alpha=0.5)
    if compiled and any(r["speed"] == "plain" for r in rows):
        axes.plot([], [], color="#555555", ls=":", marker=".", label="the same, plain Python")
    _ground(axes, bottom)
    time_label = "run time of the stepping loop [s]" if result["moves"] else "run time [s]"
    axes.set(xlabel=time_label, ylabel=error_label(result))
    _finish(figure, axes, path, "compiled, and engines" if compiled else "plain Python, and engines")


def stability(path, case):
    """A stability case's own picture."""
    picture = case["picture"]
    if not picture:
        return
    figure, axes = plt.subplots()
    colours = series_colours([label for label, *_ in picture["series"]])
    for (label, xs, ys, mark), colour in zip(picture["series"], colours):
        few = len(xs) <= 60
        style, order = {"line": ("-", 3), "dots": ("o", 2)}[mark]
        axes.plot(xs, ys, style, color=colour, label=label, ms=5 if few else 2, lw=1.4, zorder=order)
    axes.set(xlabel=picture["x_label"], ylabel=picture["y_label"], title=picture["title"])
    _finish(figure, axes, path, None)


THEORY_OR_MEASURED = re.compile(r"^theory, |, (theory|measured)$|: .*$")


def series_colours(labels):
    """A colour each: a method has its own, theory and measurement of one thing share theirs,
    and no two things have one.
    """
    things, colours = [THEORY_OR_MEASURED.sub("", label) for label in labels], {}
    known = {method.label: method.colour for method in vars(methods).values() if isinstance(method, methods.Method)}
    for thing in things:
        own = max((name for name in known if thing.startswith(name)), key=len, default=None)
        if own and known[own] not in colours.values():
            colours[thing] = known[own]
    free = iter([colour for colour in dict.fromkeys(known.values()) if colour not in colours.values()])
    for thing in things:
        if thing not in colours:
            colours[thing] = next(free, "#000000")
    return [colours[thing] for thing in things]


def show(plot, result):
    """Draw one of the plots where a notebook shows it."""
    plot(None, result)


def digest(data):
    """Fingerprint of the data that a picture shows: `validate audit` looks for it in the picture."""
    return sha256(json.dumps(jsonable(data), sort_keys=True).encode()).hexdigest()[:16]


def draw(plot, path, data):
    """Draw one of the plots into a file, without a screen; its last line names the data."""
    plt.switch_backend("svg")
    style()
    with whole(path) as draft, warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")                              # of a diagram in which every run was lost
        plot(draft, data)
        with draft.open("a", encoding="utf-8") as file:
            file.write(f"<!-- {DRAWN_FROM}{digest(data)} -->\n")


RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def _power(x, _):
    """10⁻³, 2·10⁻³: as plain text, which is drawn in a third of the time of a formula."""
    exponent = int(np.floor(np.log10(x) + 1e-9))
    lead = f"{x / 10.0**exponent:.2g}"
    return f"{'' if lead == '1' else f'{lead}·'}10{str(exponent).translate(RAISED)}"


def _tick(axis):
    """On a logarithmic axis name powers of ten, and over fewer than two of them 2 and 5 as well;
    more would run into each other.
    """
    if axis.get_scale() == "log":
        few = np.ptp(np.log10(axis.get_view_interval())) < 2.0
        axis.set_major_formatter(FuncFormatter(_power))
        axis.set_minor_locator(LogLocator(subs=(2, 5)) if few else NullLocator())
        axis.set_minor_formatter(FuncFormatter(_power))


def _finish(figure, axes, path, title):
    _tick(axes.xaxis)
    _tick(axes.yaxis)
    if not axes.get_legend_handles_labels()[0]:
        axes.plot([], [], label=" ")
        axes.text(0.5, 0.5, "nothing to draw: no method has been attempted", transform=axes.transAxes, ha="center",
                  color="#555555")
    axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), fontsize=8.5, title=title, title_fontsize=8.5,
                alignment="left")
    _margins(figure, axes, title)
    if path is None:
        plt.show()
        return
    figure.savefig(path, format="svg", metadata={"Date": None})
    plt.close(figure)


LETTER = 0.072                  # mean width of a letter of the legend [in]: 0.61 of 8.5 points


def _margins(figure, axes, title):
    """Room for labels and legend by their length in letters: finding it by drawing twice takes twice as long."""
    longest = max(map(len, [title or "", *axes.get_legend_handles_labels()[1]]))
    left, bottom, top, right = 0.85, 0.6, 0.35, 0.6 + LETTER * longest
    width, height = 6.0 + left + right, 4.0 + bottom + top
    figure.set_size_inches(width, height)
    figure.subplots_adjust(left / width, bottom / height, 1.0 - right / width, 1.0 - top / height)
