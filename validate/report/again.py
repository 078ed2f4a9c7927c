"""What the audit makes again: the limits that the scenes give, the pages, and the pictures.

Each function is a call for a process of its own and returns sentences about what differs.
"""

import tempfile
from importlib.metadata import version
from pathlib import Path

import numpy as np

from .. import report
from ..check import jsonable
from ..measure.accuracy import bound
from ..measure.selection import Plan, can_do, select
from ..subject import modules
from . import plots

NEAR = 1e-9                  # allowed relative difference of a figure that was computed twice [-]
PLOTS = {plot.__name__: plot for plot in (plots.convergence, plots.work_precision, plots.stability)}


def differs(a, b):
    """Return whether two figures are not the same; None is a figure that there is none of."""
    if a is None or b is None:
        return a is not b
    return not abs(a - b) <= NEAR * max(abs(a), abs(b))


def distance(observed, truth):
    """Return |observed − truth| over |truth|, or over 1 where the truth is zero."""
    size = sum(x * x for x in truth) ** 0.5
    return sum((x - y) ** 2 for x, y in zip(observed, truth, strict=True)) ** 0.5 / (size or 1.0)


# ---------------------------------------------------------------------------------------------- limits

def limits_of(result, of, quick):
    """Return (sentences, number of limits): where the curves and limits of a scene are not those that it gives today.

    of, quick: the answers and the mode of the run.
    """
    found, count = [], 0
    selection = select(result["scene"], Plan(of, quick=quick))
    scene = selection.scene
    for name, case in result["cases"].items():
        p = scene.cases[name]
        for label in missing_curves(case, selection, p):
            found.append(f"{result['scene']}: {label}, {name}, is missing")
        for curve in case["ours"] + case["engines"]:
            runner = next((r for r in scene.runners if r.label == curve["label"]), None)
            place = f"{result['scene']}: {curve['label']}, {name}"
            if runner is None:
                found.append(f"{place}: the scene has no such method or engine")
                continue
            count += len(curve["rows"])
            found += [f"{place}: {problem}" for problem in of_runner(curve, runner, p, case["truth"], scene.duration)]
    return found, count


def missing_curves(case, selection, p):
    """Return labels of our methods, and of the engines that ran in a case, that the scene has and the case lacks."""
    ran = {curve["product"] for curve in case["engines"]}
    wanted = [*selection.ours_for(p), *(runner for runner, _ in selection.unfinished_for(p)),
              *(r for r in selection.scene.engine_runners if r.who.product.name in ran and can_do(r, p))]
    there = {curve["label"] for curve in case["ours"] + case["engines"]}
    return [runner.label for runner in wanted if runner.label not in there]


def of_runner(curve, runner, p, truth, T):
    """Yield where a curve is not what its Runner says."""
    if curve["measured"] != runner.measured:
        yield "whether its limit was measured is not what the scene says"
    if curve["reference"] != runner.is_reference(p):
        yield "whether the truth is its own run is not what the scene says"
    law = np.array(curve.get("own_law") or truth)
    for row in curve["rows"]:
        theory = jsonable(bound(runner, p, T / row["steps"], law))
        if any(differs(row[key], theory[key]) for key in ("limit", "band")) or apart(row, theory):
            yield f"the limit at {row['steps']} steps is not theory's"
            return


def apart(row, theory):
    """Return whether what theory predicts is not what was stored."""
    a, b = row["predicted"], theory["predicted"]
    return (a is None) != (b is None) or (a is not None and distance(a, b) > NEAR)


# ---------------------------------------------------------------------------------------------- pages and pictures

def pages_version():
    """Return a fingerprint of everything that a page is made with, but its data."""
    folder = Path(__file__).parent
    return modules.fingerprint(path for path in folder.iterdir() if path.suffix in (".py", ".html", ".css", ".js"))


def pages_of(folder, data):
    """Return (sentences, number of pages): pages that are not what these data give."""
    found, texts = [], report.texts(data["scenes"], data["stability"], data["run"])
    for name, text in texts.items():
        there = folder / name
        if not there.is_file():
            found.append(f"{name} is missing")
        elif there.read_text(encoding="utf-8") != text:
            found.append(f"{name} is not what its data give")
    return found, len(texts)


def may_redraw(run):
    """Return whether a picture that is drawn here must be the same to the last letter."""
    return run.get("pages") == pages_version() and run["versions"]["matplotlib"] == version("matplotlib")


def picture_of(path, plot, shown, redraw):
    """Return (sentences, 1): where a picture was not drawn from these data, or was changed afterwards.

    plot: the name of a function in PLOTS;    redraw: draw it again and compare every letter
    """
    if not path.is_file():
        return [f"{path.name} is missing"], 1
    there = path.read_bytes().decode()
    if plots.marked_data(there) != plots.digest(shown):
        return [f"{path.name} was not drawn from these data"], 1
    if not plots.is_as_drawn(there):
        return [f"{path.name} was changed after it was drawn"], 1
    if redraw and there != redrawn(PLOTS[plot], shown):
        return [f"{path.name} is not what its data give"], 1
    return [], 1


def redrawn(plot, shown):
    """Return the text of a picture that is drawn again."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "picture.svg"
        plots.draw(plot, path, shown)
        return path.read_bytes().decode()
