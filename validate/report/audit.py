"""Audit of a report by its own raw rows: every derived figure and verdict is recomputed, every page rendered again.

Raw are, in report.json: the truth of each case; of each run what it observed at the end, its steps, the error that
theory allows, or why it failed; of each time all its repeats; of each finding the measured number.  Everything else is
derived from these and is derived here again, by other code where that is short.  Limits, laws and tolerances must be
those of the code, and `required.py` says what must be there.  Pages and pictures must be what the same data give when
they are made again.
"""

from statistics import median

import numpy as np

from .. import report
from ..check import Verdict
from ..measure.accuracy import ASYMPTOTIC
from ..measure.races import EXACTLY, HEADLINE, NEARLY, TIE, Outcome
from ..measure.timing import SAME, TARGETS
from ..run.store import code_digest
from ..scene import ROUND_OFF
from . import required
from .again import differs, distance, limits_of, may_redraw, pages_of, pages_version, picture_of

NINE = 9                     # repeats from which the interval of a median leaves out the shortest and the longest [-]
COUNTED = ("runs", "times", "findings", "limits", "pages", "pictures")


def here(calls):
    """Yield (key, result) of {key: (function, *arguments)}, one after the other in this process."""
    for key, (function, *arguments) in calls.items():
        yield key, function(*arguments)


def untracked(sequence, total=None, description=""):
    """Return a sequence as it is: the progress is not shown."""
    return sequence


def audit(folder, data, each=here, track=untracked):
    """Return (problems, counts, notes): sentences, how much was checked, and what could not be checked.

    folder and data: a report and its report.json;    each(calls): see `here`;    track(sequence, total=, description=)
    yields what the sequence has, and shows the progress
    """
    run, counts = data["run"], dict.fromkeys(COUNTED, 0)
    found = []
    for result in track(data["scenes"], description="figures"):
        found += [f"{result['scene']}: {problem}" for problem in of_scene(result, counts)]
    for case in data["stability"]:
        found += [f"{case['lesson']}/{case['slug']}: {problem}" for problem in of_case(case, counts)]
    same_code = run.get("code") == code_of(run["of"])
    must = required.kept(run, same_code)
    found += required.missing(data, must) if must else ()
    by_theory = same_code and not run.get("overrides")
    for kind, calls in (("limits", limits_to_derive(data) if by_theory else {}),
                        ("pages", {"all": (pages_of, folder, data)} if run.get("pages") == pages_version() else {}),
                        ("pictures", pictures_to_check(folder, data))):
        for _, (problems, count) in track(each(calls), total=len(calls), description=kind):
            found += problems
            counts[kind] += count
    return found, counts, list(unchecked(run, must, by_theory))


def unchecked(run, must, by_theory):
    """Yield sentences on what this code cannot judge of a report."""
    if must is None:
        yield "whether all scenes, cases and findings are there: the repository has no list for its commit"
    if not by_theory:
        yield "whether its limits are theory's: it was made by other code or with other parameters"
    if run.get("pages") != pages_version():
        yield "whether its pages show its data: they were made by other code"
    if not may_redraw(run):
        yield "whether its pictures are drawn from its data: only their marks were checked"


def limits_to_derive(data):
    """Return a call for each scene."""
    run = data["run"]
    return {result["scene"]: (limits_of, result, run["of"], run["mode"] == "quick") for result in data["scenes"]}


def pictures_to_check(folder, data):
    """Return a call for each picture."""
    redraw = may_redraw(data["run"])
    return {name: (picture_of, folder / name, plot.__name__, shown, redraw)
            for plot, name, shown, _ in report.pictures(data["scenes"], data["stability"])}


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
        if Verdict(curve["verdict"]) not in (Verdict.UNDECIDED, Verdict.UNFINISHED):
            yield f"the verdict {curve['verdict']!r} has no rows"
        return
    if curve["reference"] != (Verdict(curve["verdict"]) is Verdict.REFERENCE):
        yield "it is its own judge" if curve["reference"] else "it is called a reference, but the truth is no run of it"
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
    verdict = None if curve["reference"] else verdict_of(judged, curve["expected"], order, own is not None)
    if verdict is Verdict.UNDECIDED and curve.get("laws"):
        verdict = verdict_by_laws(curve["laws"])
    if verdict is not None and verdict is not Verdict(curve["verdict"]):
        yield f"the verdict is {curve['verdict']!r}, but its rows say {verdict.value!r}"


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


def verdict_by_laws(laws):
    """Return the Verdict that stored laws of contact give.  None is a number that is not finite."""
    lost = [law for law in laws if law["found"] is None or law["found"] > law["allowed"]]
    if any(law["found"] is None or not law["reason"] or (law["known"] is not None and law["found"] > law["known"])
           for law in lost):
        return Verdict.DEPARTS
    return Verdict.BREAKS_AS_KNOWN if lost else Verdict.KEEPS_LAWS


# ---------------------------------------------------------------------------------------------- times

def of_times(result, counts):
    """Yield what is wrong with the medians, ranges and ratios of one scene."""
    times = result["times"]
    errors = {(c["label"], row["steps"]): row["error"] for case in list(result["cases"].values())[:1]
              for c in case["ours"] + case["engines"] for row in c["rows"]}
    counts["times"] += len(times["rows"])
    for row in times["rows"]:
        yield from of_time(row, errors.get((row["label"], row["steps"])))
    for curve in times["time_to_error"]:
        yield from of_targets(curve, times["rows"])
    case = next(iter(result["cases"].values()), None)
    for race in times["races"] if case else ():
        for problem in of_race(race, times, case):
            yield f"the race with {race['product']} to {race['error']}: {problem}"
    yield from of_calls(times)
    yield from of_preparations(times)
    yield from of_compilation(times)
    yield from of_costs(times)


def of_time(row, error):
    """Yield what is wrong with the time of one run, and with the error that stands beside it."""
    place = f"the time of {row['label']}, {row['speed']}, {row['steps']} steps"
    if row["speed"] != "recorded" and not row.get("repeats"):
        yield f"{place} has no repeats"
    elif row["speed"] != "recorded":
        ordered = sorted(row["repeats"])
        ends = ordered[1:-1] if len(ordered) >= NINE else ordered
        if any(differs(row[key], known) for key, known in
               (("seconds", median(ordered)), ("low", ends[0]), ("high", ends[-1]))):
            yield f"{place} is not the median or the interval of its repeats"
    if differs(row["error"], error):
        yield f"{place} stands beside an error that is not that of its run"


def of_targets(curve, rows):
    """Yield what is wrong with the times that one curve takes to given errors."""
    name = f"{curve['label']}, {curve['speed']},"
    points = [row for row in rows if (row["label"], row["speed"]) == (curve["label"], curve["speed"])]
    if len(curve["seconds"]) != len(TARGETS) or not points:
        yield f"the times to an error of {name} have no rows"
        return
    for target, seconds in zip(TARGETS, curve["seconds"], strict=True):
        if differs(seconds, least_time(points, target)):
            yield f"the time of {name} to an error of {target} does not follow from its rows"


def of_costs(times):
    """Yield what is wrong with the cost of what a scene, our whole loop or an engine leaves out."""
    for row in times["ablations"]:
        if row["cost"] is not None and not follows(row, "cost"):
            yield f"what it costs to put in {row['what']!r} does not follow from its repeats"
    left_out = times.get("left_out") or {"ratio": None}
    if left_out["ratio"] is not None and not follows(left_out, "ratio"):
        yield "what the whole loop costs does not follow from its repeats"
    ours = [{**row, "engine": f"our loop, {row['speed']}"} for row in (times.get("our_parts") or {"rows": ()})["rows"]]
    for row in [*ours, *(times.get("engine_parts") or ())]:
        full, lean = (median(repeats) for repeats in row["repeats"])
        before, after = row["observed"]
        change = None if before is None or after is None else distance(after, before)
        if differs(row["cost"], full / lean) or differs(row["change"], change):
            yield f"what {row['part']!r} costs in {row['engine']} does not follow from its repeats"


def follows(row, key):
    """Return whether a ratio of times is that of its repeats, and `same` says whether both runs observed the same."""
    full, lean = (median(repeats) for repeats in row["repeats"])
    return not differs(row[key], full / lean) and row["same"] == (distance(*row["observed"]) < SAME)


def least_time(rows, target):
    """Return the shortest time for an error: of the cheapest accurate run, or between it and the run before it.

    The run before it has the next smaller number of steps.  It must be a part of the curve: cheaper, and not lost.
    """
    rows = sorted(rows, key=lambda row: row["steps"])
    good = [k for k, row in enumerate(rows) if row["error"] <= target]
    if not good:
        return None
    k = min(good, key=lambda k: (rows[k]["seconds"], rows[k]["error"]))
    fine, coarse = rows[k], rows[max(0, k - 1)]
    if not (0.0 < fine["error"] and target < coarse["error"] < ASYMPTOTIC and coarse["seconds"] < fine["seconds"]):
        return fine["seconds"]
    share = np.log(target / fine["error"]) / np.log(coarse["error"] / fine["error"])
    return float(fine["seconds"] * (coarse["seconds"] / fine["seconds"]) ** share)


def of_calls(times):
    """Yield what is wrong with the cost of a call of an engine from Python."""
    for one in times["calls"]:
        alone = median(one["alone"]) if one["alone"] else 0.0
        if not one["called"] or differs(one["seconds"], max(0.0, median(one["called"]) - alone)):
            yield f"the cost of a call of {one['product']} does not follow from its repeats"


def of_preparations(times):
    """Yield what is wrong with the times that come before the clock starts."""
    for one in times.get("preparations") or ():
        without = median(one["without"]) if one["without"] else 0.0
        if not one["with"] or differs(one["seconds"], max(0.0, median(one["with"]) - without)):
            yield f"what comes before the loops of {one['label']} does not follow from its repeats"


def of_compilation(times):
    """Yield what is wrong with the times of compilation: they belong to the method that runs the headline's race."""
    one = times.get("compilation")
    if not one:
        return
    quickest = {race["ours"]["label"] for race in times["races"] if race["level"] == HEADLINE and race["ours"]}
    if one["label"] not in quickest:
        yield f"the compilation is timed of {one['label']}, which runs no race"
    if not 0.0 <= one["cached"] <= one["cold"]:
        yield "to load a method from the cache takes longer than to compile it"


def of_race(race, times, case):
    """Yield what is wrong with one race: its error, the times of both sides, its ratio and its factors."""
    rows = [row for row in times["rows"] if row["error"] is not None and row["speed"] != "recorded"]
    theirs, ours = (by_curve(rows, agreeing(case[role], race["product"])) for role in ("engines", "ours"))
    error = race["error"] if race["level"] is None else race["level"]
    if race["level"] is None:
        least = min((row["error"] for group in theirs.values() for row in group), default=ASYMPTOTIC)
        if differs(error, max(EXACTLY, least) if least < ASYMPTOTIC else None):
            yield "it is not to the engine's smallest error"
            return
    elif differs(race["error"], error):
        yield "it is to another error than its level"
        return
    if error is None:
        return
    if race["level"] is not None and differs(time_of(race["engine"]), least_of(theirs, error)):
        yield "the engine's time is not its shortest"
    if race["level"] is None and differs(time_of(race["engine"]), cheapest_near(theirs, error)):
        yield "the engine's time is not that of its cheapest run that is as accurate"
    if differs(time_of(race["ours"]), least_of(ours, error)):
        yield "our time is not our shortest"
    if race["ratio"] is not None:
        yield from of_ratio(race, times)
    elif not may_have_no_ratio(race, rows):
        yield f"it has no ratio, but its outcome is {race['outcome']!r}"


def may_have_no_ratio(race, rows):
    """Return whether the outcome of a race without a ratio is that of its sides.

    With both sides it is undecided only where our quickest method was not timed compiled.
    """
    engine, ours, outcome = race["engine"], race["ours"], Outcome(race["outcome"])
    if engine and ours:
        compiled = any((row["label"], row["speed"]) == (ours["label"], "compiled") for row in rows)
        return outcome is Outcome.UNDECIDED and not compiled
    lost = Outcome.SLOWER if engine else Outcome.ENGINE_FAILS if ours else Outcome.NEITHER
    return outcome in (Outcome.UNDECIDED, lost)


def agreeing(curves, product):
    """Return the labels of the curves that may race: those that agree, and of an engine only its own."""
    return {c["label"] for c in curves if Verdict(c["verdict"]) is Verdict.AGREES
            and ("product" not in c or c["product"] == product)}


def by_curve(rows, labels):
    """{(label, speed): its rows} of the curves with these labels."""
    groups = {}
    for row in rows:
        if row["label"] in labels:
            groups.setdefault((row["label"], row["speed"]), []).append(row)
    return groups


def least_of(groups, error):
    """Return the least time to an error of some curves, or None."""
    reached = [least_time(group, error) for group in groups.values()]
    return min((t for t in reached if t is not None), default=None)


def cheapest_near(groups, error):
    """Return the time of the cheapest run whose error is within a twentieth of the smallest."""
    return min((row["seconds"] for group in groups.values() for row in group
                if row["error"] <= NEARLY * error), default=None)


def time_of(side):
    """Return the time of one side of a race, or None."""
    return side and side["seconds"]


def of_ratio(race, times):
    """Yield what is wrong with a ratio, with its range, or with what it is made of."""
    engine, ours, same = race["engine"], race["ours"], race["same_order"]
    wanted = {"ratio": engine["seconds"] / ours["seconds"], "low": engine["low"] / ours["high"],
              "high": engine["high"] / ours["low"], "order": same and same["seconds"] / ours["seconds"],
              "loop": same and engine["seconds"] / same["seconds"]}
    cost = next((one["seconds"] for one in times["calls"] if one["product"] == race["product"]), None)
    rest = None if cost is None else engine["alone"] - cost * (engine["steps"] // race["substeps"])
    wanted["calls"] = engine["alone"] / rest if rest is not None and rest > 0.0 else None
    for key, value in wanted.items():
        if differs(race[key], value):
            yield f"its {key} is not that of its times"
    if not race["low"] <= race["ratio"] <= race["high"]:
        yield "its ratio is outside of its range"
    tie = 1.0 / TIE < race["ratio"] < TIE or race["low"] < 1.0 < race["high"]
    outcome = Outcome.TIE if tie else Outcome.FASTER if race["ratio"] > 1.0 else Outcome.SLOWER
    if Outcome(race["outcome"]) is not outcome:
        yield f"its outcome is {race['outcome']!r}, but its ratio says {outcome.value!r}"


# ---------------------------------------------------------------------------------------------- findings

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


def code_of(subject):
    try:
        return code_digest(subject)
    except ValueError:                                   # a BadInput: the folder of answers is gone
        return None
