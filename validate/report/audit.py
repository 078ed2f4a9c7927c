"""Audit of a report by its own raw rows: every derived figure and verdict is recomputed, every page rendered again.

Raw are, in report.json: the truth of each case; of each run what it observed at the end, its steps, the error that
theory allows, or why it failed; of each time all its repeats; of each finding the predicted and the measured number and
the tolerance.  Everything else is derived from these and is derived here again, by other code where that is short.
The pages must be what the same data give when they are rendered again, and each picture names the data that it shows.
"""

from statistics import median

import numpy as np

from .. import report
from ..check import Verdict, jsonable
from ..measure.accuracy import ASYMPTOTIC, bound
from ..measure.timing import EXACTLY, SAME, TARGETS
from ..run.store import code_digest
from ..scene import ROUND_OFF
from ..subject import modules
from . import plots

NEAR = 1e-9                  # allowed relative difference of a figure that was computed twice [-]


def audit(folder, data):
    """Return (problems, counts): sentences, and how much was checked, for a folder and its report.json."""
    found, counts = [], dict.fromkeys(("runs", "limits", "times", "findings", "pages", "pictures"), 0)
    for result in data["scenes"]:
        found += [f"{result['scene']}: {problem}" for problem in of_scene(result, counts)]
    for case in data["stability"]:
        found += [f"{case['lesson']}/{case['slug']}: {problem}" for problem in of_case(case, counts)]
    found += list(of_limits(data, counts))
    found += list(of_pages(folder, data, counts))
    return found, counts


def differs(a, b):
    """Return whether two figures are not the same; None is a figure that there is none of."""
    if a is None or b is None:
        return a is not b
    return not abs(a - b) <= NEAR * max(abs(a), abs(b))


# ---------------------------------------------------------------------------------------------- errors and verdicts

def of_scene(result, counts):
    """Yield what is wrong with the figures of one scene."""
    for name, case in result["cases"].items():
        if not np.all(np.isfinite(np.array(case["truth"], dtype=float))):
            yield f"the truth of {name!r} is not finite"
            continue
        for curve in case["ours"] + case["engines"]:
            counts["runs"] += len(curve["rows"])
            for problem in of_curve(curve, case, result):
                yield f"{curve['label']}, {name}: {problem}"
    rows = result["parity_rows"]
    if differs(result["parity"], max((distance(row["plain"], row["compiled"]) for row in rows), default=None)):
        yield "the difference of plain and compiled runs is not that of its rows"
    yield from of_times(result, counts)


def of_curve(curve, case, result):
    """Yield what is wrong with the errors, the order and the verdict of one curve."""
    truth, rows, own = case["truth"], curve["rows"], curve.get("own_law")
    if not rows:
        if Verdict(curve["verdict"]) is not Verdict.UNDECIDED:
            yield f"the verdict {curve['verdict']!r} has no rows"
        return
    for row in rows:
        seen = row.get("observed")
        if (seen is None) == (row["failure"] is None) or (seen is not None and len(seen) != len(truth)):
            yield f"the run of {row['steps']} steps has no raw row"
            return
        if differs(row["error"], None if row["failure"] else distance(row["observed"], truth)):
            yield f"the error at {row['steps']} steps is not that of what was observed"
        if differs(row["dt"], result["T"] / row["steps"]):
            yield f"the step of {row['steps']} steps is not T over the steps"
    law = truth if own is None else own
    judged = [{**row, "error": None if row["failure"] else distance(row["observed"], law),
               "off": outside(row, law)} for row in rows]
    for row in rows:
        if row["predicted"] is not None and differs(row["limit"], distance(row["predicted"], law) + row["band"]):
            yield f"the limit at {row['steps']} steps is not the predicted error and its band"
    if own is not None and differs(curve["departure"], distance(own, truth)):
        yield "the departure is not the distance of its own law from the truth"
    order = slope(judged, 10.0 * result["uncertainty"])
    if (order is None) != (curve["order"] is None) or (order is not None and abs(order - curve["order"]) > 1e-6):
        yield f"the order is {curve['order']}, but its rows show {order}"
    verdict = verdict_of(judged, curve["expected"], order, own is not None)
    if curve.get("reference"):
        verdict = Verdict.UNDECIDED                      # its own run is the truth
    if verdict is not None and verdict is not Verdict(curve["verdict"]):
        yield f"the verdict is {curve['verdict']!r}, but its rows say {verdict.value!r}"


def distance(observed, truth):
    """Return |observed − truth| over |truth|, or over 1 where the truth is zero."""
    size = sum(x * x for x in truth) ** 0.5
    return sum((x - y) ** 2 for x, y in zip(observed, truth, strict=True)) ** 0.5 / (size or 1.0)


def outside(row, law):
    """Return whether a run ended outside of the band about what theory predicts for it."""
    if row["predicted"] is None or row["failure"]:
        return False
    size = sum(x * x for x in law) ** 0.5
    away = sum((x - y) ** 2 for x, y in zip(row["observed"], row["predicted"], strict=True)) ** 0.5
    return away > row["band"] * (size or 1.0)


def slope(rows, floor):
    """Return the order of the finest four runs after the last one that was lost: the slope of log error over log dt."""
    lost = [k for k, row in enumerate(rows) if row["error"] is None or row["error"] >= ASYMPTOTIC]
    clear = [row for row in rows[lost[-1] + 1 if lost else 0:]
             if row["error"] > max(1e-11 + floor, 100.0 * ROUND_OFF * row["steps"])][-4:]
    if len(clear) < 3:
        return None
    x, y = (np.log([row[key] for row in clear]) for key in ("dt", "error"))
    return float((x - x.mean()) @ (y - y.mean()) / ((x - x.mean()) @ (x - x.mean())))


def verdict_of(rows, expected, order, has_own_law):
    """Return the Verdict that the rows give; None where an exercise has no answer yet."""
    small = [row for row in rows if row["limit"] is not None and row["limit"] < ASYMPTOTIC]   # None: theory is silent
    ratios = [row["error"] / row["limit"] for row in small if row["error"] is not None]
    failure = rows[-1]["failure"] or ""
    if failure.startswith(Verdict.NOT_ATTEMPTED.value):
        return Verdict.NOT_ATTEMPTED
    if failure:
        return Verdict.DEPARTS
    if not ratios:
        return Verdict.UNDECIDED
    if any(ratio > 1.0 for ratio in ratios) or any(row["off"] for row in rows):
        return Verdict.DEPARTS
    unpredicted = [row for row in small if row["predicted"] is None]
    if expected in (1, 2, 4) and order is not None and order < expected - 0.3 and len(unpredicted) >= 2:
        return Verdict.DEPARTS
    return Verdict.FOLLOWS_OWN_LAW if has_own_law else Verdict.AGREES


# ---------------------------------------------------------------------------------------------- times

def of_times(result, counts):
    """Yield what is wrong with the medians, ranges and ratios of one scene."""
    times = result["times"]
    errors = {(c["label"], row["steps"]): row["error"] for case in list(result["cases"].values())[:1]
              for c in case["ours"] + case["engines"] for row in c["rows"]}
    counts["times"] += len(times["rows"])
    for row in times["rows"]:
        yield from of_time(row, errors.get((row["label"], row["steps"])))
    for label, targets in times["time_to_error"].items():
        yield from of_targets(label, targets, times["rows"])
    for one in times["advantage"]:
        yield from of_advantage(one, times["rows"])
    yield from of_costs(times)


def of_time(row, error):
    """Yield what is wrong with the time of one run, and with the error that stands beside it."""
    place = f"the time of {row['label']}, {row['speed']}, {row['steps']} steps"
    if row["speed"] != "recorded" and not row.get("repeats"):
        yield f"{place} has no repeats"
    elif row["speed"] != "recorded" and any(differs(row[key], of(row["repeats"])) for key, of in
                                            (("seconds", median), ("low", min), ("high", max))):
        yield f"{place} is not the median or the range of its repeats"
    if differs(row["error"], error):
        yield f"{place} stands beside an error that is not that of its run"


def of_targets(label, targets, rows):
    """Yield what is wrong with the times that one curve takes to given errors."""
    mine = [row for row in rows if f"{row['label']} ({row['speed']})" == label]
    points = [(row["error"], row["seconds"]) for row in mine]
    if len(targets) != len(TARGETS) or not points:
        yield f"the times to an error of {label} have no rows"
    for target, seconds in targets.items():
        if differs(seconds, least_time(points, float(target))):
            yield f"the time of {label} to an error of {target} does not follow from its rows"


def of_costs(times):
    """Yield what is wrong with the cost of what a scene, our whole loop or an engine leaves out."""
    for row in times["ablations"]:
        if row["cost"] is not None and not follows(row, "cost"):
            yield f"what it costs to put in {row['what']!r} does not follow from its repeats"
    left_out = times.get("left_out") or {"ratio": None}
    if left_out["ratio"] is not None and not follows(left_out, "ratio"):
        yield "what the whole loop costs does not follow from its repeats"
    for row in times.get("engine_parts") or ():
        full, lean = (median(repeats) for repeats in row["repeats"])
        before, after = row["observed"]
        change = None if before is None or after is None else distance(after, before)
        if differs(row["cost"], full / lean) or differs(row["change"], change):
            yield f"what {row['part']!r} costs in {row['engine']} does not follow from its repeats"


def follows(row, key):
    """Return whether a ratio of times is that of its repeats, and `same` says whether both runs observed the same."""
    full, lean = (median(repeats) for repeats in row["repeats"])
    return not differs(row[key], full / lean) and row["same"] == (distance(*row["observed"]) < SAME)


def least_time(points, target):
    """Return the shortest time for an error: that of the cheapest accurate run, or between it and a coarser one."""
    good = min(((seconds, error) for error, seconds in points if error <= target), default=None)
    if good is None:
        return None
    coarser = min(((error, seconds) for error, seconds in points if error > target and seconds < good[0]), default=None)
    if coarser is None or good[1] <= 0.0:
        return good[0]
    share = np.log(target / good[1]) / np.log(coarser[0] / good[1])
    return float(good[0] * (coarser[1] / good[0]) ** share)


def of_advantage(one, rows):
    """Yield what is wrong with one ratio of an engine's time to ours."""
    worth = [(r["error"], r["seconds"]) for r in rows
             if r["label"] == one["engine"] and r["speed"] == "engine" and EXACTLY < r["error"] < ASYMPTOTIC]
    best = min(worth, default=None)
    if best is None or differs(best[0], one["error"]) or differs(best[1], one["seconds"]):
        yield f"the race with {one['engine']} is not to its smallest error"
        return
    ours = {}
    for r in rows:
        if r["speed"] in ("plain", "compiled"):
            ours.setdefault((r["label"], r["speed"]), []).append((r["error"], r["seconds"]))
    reached = [t for points in ours.values() if (t := least_time(points, best[0]))]
    if differs(one["ours"], min(reached, default=None)):
        yield f"our time in the race with {one['engine']} is not our shortest"
    elif differs(one["ratio"], best[1] / one["ours"] if one["ours"] else None):
        yield f"the ratio in the race with {one['engine']} is not that of its times"


# ---------------------------------------------------------------------------------------------- findings, limits, pages

def of_case(case, counts):
    """Yield what is wrong with the findings of a stability case."""
    if not case["findings"]:
        yield "there are no findings"
    for f in case["findings"]:
        counts["findings"] += 1
        raw = [f["predicted"], f["measured"], f["tolerance"]]
        holds = None not in raw and abs(f["measured"] - f["predicted"]) <= f["tolerance"]
        if holds != f["holds"]:
            yield f"{f['quantity']!r} is said to {'hold' if f['holds'] else 'fail'}, but its numbers say the contrary"


def of_limits(data, counts):
    """Return limits that differ from those of the scenes.

    None if the report comes from other code, which cannot tell.
    """
    run = data["run"]
    if run.get("code") != code_of(run["of"]) or run.get("overrides"):
        return
    for result in data["scenes"]:
        scene = modules.bind_scene(result["scene"], run["of"])
        for name, case in result["cases"].items():
            for curve in case["ours"] + case["engines"]:
                runner = next(r for r in scene.runners if r.label == curve["label"])
                law = np.array(curve.get("own_law") or case["truth"])
                for row in curve["rows"]:
                    counts["limits"] += 1
                    theory = jsonable(bound(runner, scene.cases[name], scene.duration / row["steps"], law))
                    if any(differs(row[key], theory[key]) for key in ("limit", "band")) or apart(row, theory):
                        place = f"{result['scene']}: {curve['label']}, {name}"
                        yield f"{place}: the limit at {row['steps']} steps is not theory's"
                        break


def apart(row, theory):
    """Return whether what theory predicts is not what was stored."""
    a, b = row["predicted"], theory["predicted"]
    return (a is None) != (b is None) or (a is not None and distance(a, b) > NEAR)


def code_of(subject):
    try:
        return code_digest(subject)
    except ValueError:                                   # a BadInput: the folder of answers is gone
        return None


def of_pages(folder, data, counts):
    """Return pages and pictures that do not show these data."""
    for name, text in report.texts(data["scenes"], data["stability"], data["run"]).items():
        counts["pages"] += 1
        there = folder / name
        if not there.is_file():
            yield f"{name} is missing"
        elif there.read_text(encoding="utf-8") != text:
            yield f"{name} is not what its data give"
    for _, name, shown, _ in report.pictures(data["scenes"], data["stability"]):
        counts["pictures"] += 1
        there = folder / name
        if not there.is_file():
            yield f"{name} is missing"
        elif f"<!-- {plots.DRAWN_FROM}{plots.digest(shown)} -->" not in there.read_text(encoding="utf-8")[-200:]:
            yield f"{name} was not drawn from these data"
