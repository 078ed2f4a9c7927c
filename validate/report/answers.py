"""The four questions of the front page, answered from the results."""

from collections import Counter
from statistics import median

from ..check import BY_LAWS, Verdict
from ..measure.races import Outcome
from ..scene import EXACT
from . import choice, races, words

LEAST, MOST = 0.1, 3000.0    # range of ratios that the front page has room for [-]


def answers(results, stability, cores=None):
    """Return {question's name: what the front page says}: right, faster, departures, stable, which."""
    return {"right": right(results, stability), "faster": faster(results, cores), "departures": departures(results),
            "stable": stable(stability), "which": choice.by_lesson(results)}


def curves_of(results, role):
    """Return [(result, name of the case, curve)] of all scenes; role is ours or engines."""
    return [(r, name, c) for r in results for name, case in r["cases"].items() for c in case[role]]


def right(results, stability):
    """Counts of the verdicts on our methods, and how many orders are as high as theory says."""
    every = curves_of(results, "ours")
    count = Counter(Verdict(c["verdict"]) for _, _, c in every)
    measured = [one for one in every if one[2]["order"] is not None and one[2]["expected"] != EXACT]
    ordered = [one for one in measured if one[2]["expected"] in (1, 2, 4)]
    below = [one for one in ordered if not one[2]["order"] > one[2]["expected"] - 0.3]
    wrong = {r["scene"]: r["title"] for r, _, c in every if Verdict(c["verdict"]) is Verdict.DEPARTS}
    curves, predicted = set(), set()
    for r, _, c in (*every, *curves_of(results, "engines")):
        curves.add((r["scene"], c["label"]))
        if any(row["predicted"] is not None for row in c["rows"]):
            predicted.add((r["scene"], c["label"]))
    return {
        "curves": len(curves), "curves_predicted": len(predicted),
        "scenes": len(results), "runs": len(every),
        "judged": count[Verdict.AGREES] + count[Verdict.FOLLOWS_OWN_LAW] + count[Verdict.DEPARTS],
        "agree": count[Verdict.AGREES], "predicted": count[Verdict.FOLLOWS_OWN_LAW], "depart": count[Verdict.DEPARTS],
        "by_laws": sum(count[verdict] for verdict in BY_LAWS), "breaks": count[Verdict.BREAKS_AS_KNOWN],
        "waiting": count[Verdict.NOT_ATTEMPTED], "undecided": count[Verdict.UNDECIDED], "wrong": wrong,
        "unfinished": unfinished(every), "measured": len(words.measured_limits(results, stability)),
        "truths": words.truths_by_engines(results), "agreed": words.truths_by_agreement(results),
        "orders": len(ordered), "orders_open": len(measured) - len(ordered),
        "orders_reached": len(ordered) - len(below),
        "orders_below": [{**place_of(*one), "order": one[2]["order"], "expected": one[2]["expected"]} for one in below],
        "exact": sum(c["expected"] == EXACT and Verdict(c["verdict"]) is Verdict.AGREES for _, _, c in every),
    }


def unfinished(every):
    """[{label, case, scene, title}] of the curves of ours that do not come to their end."""
    return [place_of(*one) for one in every if Verdict(one[2]["verdict"]) is Verdict.UNFINISHED]


def place_of(result, case, curve):
    """{label, case, scene, title} of a curve."""
    return {"label": curve["label"], "case": case, "scene": result["scene"], "title": result["title"]}


def faster(results, cores=None):
    """All races of the report, how many ended how at each error, and what the ratios at the headline are made of."""
    every = races.every(results)
    counts = races.counted(every)
    headline = races.at(every)
    by = {outcome.name.lower(): [race for race in headline if Outcome(race["outcome"]) is outcome]
          for outcome in Outcome}
    return {"races": every, "counts": counts, "headline": races.headline_of(counts), "by": by,
            "factors": races.median_factors(every), "rows": races.rows(every),
            "undecided": by_reason(by["undecided"]),
            "beyond": [race for race in headline if race["ratio"] and not LEAST <= race["ratio"] <= MOST],
            "calls": calls(results), "before": before_the_clock(results), "warning": words.busy_warning(results, cores)}


def by_reason(undecided):
    """{why: races} of the undecided races."""
    found = {}
    for race in undecided:
        found.setdefault(race["why"], []).append(race)
    return found


def calls(results):
    """Return what a call from Python costs each engine: one record each, from the first scene that was timed."""
    found = {}
    for result in results:
        for one in result["times"].get("calls") or ():
            found.setdefault(one["product"], one)
    return list(found.values())


def before_the_clock(results):
    """Return {"engine", "ours"}: medians of what comes before the timed loops of the headline's races; None if unknown.
    """
    found = {"engine": [], "ours": []}
    for one in (one for result in results for one in result["times"].get("preparations") or ()):
        found["ours" if one["without"] else "engine"].append(one["seconds"])
    return {side: median(values) if values else None for side, values in found.items()}


def departures(results):
    """One line for each engine and reason: {engine, kind, reason, whose, low, high, places}, unpredicted ones first."""
    groups, undecided = {}, {}
    for r, name, c in curves_of(results, "engines"):
        verdict = Verdict(c["verdict"])
        if verdict in (Verdict.FOLLOWS_OWN_LAW, Verdict.DEPARTS):
            known = verdict is Verdict.FOLLOWS_OWN_LAW
            reason = c["departure_reason"] if known else f"not known: it {c['message']}"
            whose = c["departure_whose"] if known else ""
            last = words.finest(c)
            size = c["departure"] if known else (last["error"] if last else None)
            groups.setdefault((words.KINDS[verdict], c["label"], reason, whose), []).append((r, name, size))
        elif verdict is Verdict.UNDECIDED:
            undecided.setdefault(r["scene"], r["title"])
    lines = []
    for (kind, label, reason, whose), found in groups.items():
        sizes = [size for _, _, size in found if size is not None]
        lines.append({"engine": label, "kind": kind, "reason": reason, "whose": whose, "low": min(sizes, default=None),
                      "high": max(sizes, default=None), "places": {r["scene"]: r["title"] for r, _, _ in found},
                      "cases": len(found)})
    lines.sort(key=lambda line: (line["kind"] != "departs", -len(line["places"]), -(line["high"] or 0.0)))
    compared = [one for one in curves_of(results, "engines") if Verdict(one[2]["verdict"]) is not Verdict.REFERENCE]
    return {"lines": lines, "undecided": undecided, "runs": len(compared),
            "depart": sum(line["cases"] for line in lines),
            "by_laws": sum(Verdict(c["verdict"]) in BY_LAWS for _, _, c in compared),
            "breaks": sum(Verdict(c["verdict"]) is Verdict.BREAKS_AS_KNOWN for _, _, c in compared),
            "open": sum(Verdict(c["verdict"]) is Verdict.UNDECIDED for _, _, c in compared),
            "agree": sum(Verdict(c["verdict"]) is Verdict.AGREES for _, _, c in compared),
            "scenes": len({scene for line in lines for scene in line["places"]})}


def stable(stability):
    """Return how many findings hold, and the cases in which one fails."""
    held = [f["holds"] for case in stability for f in case["findings"]]
    failing = {f"{case['lesson']}-{case['slug']}": case["title"] for case in stability
               if not all(f["holds"] for f in case["findings"])}
    not_run = [one for case in stability for one in case["not_run"]]
    return {"findings": len(held), "hold": sum(held), "cases": len(stability), "failing": failing,
            "not_run": len(not_run), "why": list(dict.fromkeys(one["why"] for one in not_run))}
