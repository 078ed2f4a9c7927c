"""The differences of two reports: verdicts, findings, orders and errors; times only where they exceed their spread."""

from statistics import median
from typing import NamedTuple

from solutions.checks import BadInput

from ..check import JUDGED_RIGHT, Verdict
from ..engines.products import PRODUCTS
from .words import busy_warning

GOOD = {*JUDGED_RIGHT, Verdict.REFERENCE}
ORDER = 0.05                 # a smaller change of an order is noise of the fit [-]
ERROR = 0.01                 # a smaller relative change of an error is not listed [-]
ROUND_OFF = 1e-11            # relative errors below this are round-off, and differ from machine to machine [-]
SLOWER = 1.3                 # ratio of times, after both reports are brought to one speed, from which it is listed [-]
FIRST_FORMAT = 2             # the first that a report names
KINDS = ("verdicts", "findings", "orders", "errors", "times")


class Change(NamedTuple):
    """One difference of two reports."""
    kind: str                # one of KINDS
    place: str               # scene, case and method, or lesson and stability case
    words: str
    worse: bool              # a regression


def changes(old, new):
    """Return every Change from one report to another; both are the content of a report.json, of any format.

    Raises BadInput where their formats do not have the same records.
    """
    try:
        return [*verdicts(old, new), *findings(old, new), *orders_and_errors(old, new), *times(old, new)]
    except (KeyError, TypeError, ValueError):
        formats = " and ".join(map(format_of, (old, new)))
        raise BadInput("this pair of reports", f"not comparable, with the formats {formats}",
                       "make one of them again") from None


def format_of(report):
    """Return the format of a report's records, in words; the first one had no number."""
    return str(report["run"].get("format", f"older than {FIRST_FORMAT}"))


def curves(report):
    """Return {(scene, case, role, label): curve} of a report."""
    return {(scene["scene"], case, curve["role"], curve["label"]): curve
            for scene in report["scenes"] for case, one in scene["cases"].items()
            for curve in one["ours"] + one["engines"]}


def verdicts(old, new):
    """Yield verdicts that differ, and curves that only one report has."""
    before, after = curves(old), curves(new)
    for key in dict.fromkeys([*before, *after]):
        was, now = before.get(key), after.get(key)
        place = name_of(key)
        if was is None:
            yield Change("verdicts", place, f"is new: {now['verdict']}", Verdict(now["verdict"]) is Verdict.DEPARTS)
        elif now is None:
            products = {c.get("product") for c in after.values()}
            left_out = {product.name for product in PRODUCTS if product.optional} - products
            optional = was.get("product") in left_out
            gone = "was left out" if optional else "is gone"
            yield Change("verdicts", place, f"{gone}; it was: {was['verdict']}", not optional)
        elif was["verdict"] != now["verdict"]:
            worse = not is_good(now) and (is_good(was) or Verdict(now["verdict"]) is Verdict.DEPARTS)
            yield Change("verdicts", place, f"{was['verdict']} → {now['verdict']}{because(now)}", worse)


def because(curve):
    return f" ({curve['message']})" if curve["message"] else ""


def findings(old, new):
    """Yield findings that hold in one report only, and stability cases or findings that only one report has."""
    before, after, skipped = by_case(old), by_case(new), not_run(new)
    for place in dict.fromkeys([*before, *after]):
        was, now = before.get(place, {}), after.get(place, {})
        if not was:
            failing = sum(not f["holds"] for f in now.values())
            yield Change("findings", place, f"is new: {len(now) - failing} of {len(now)} findings hold", failing > 0)
            continue
        for key in dict.fromkeys([*was, *now]):
            if key not in now and (place, key[0]) in skipped:
                yield Change("findings", place, f"was not run: {was[key]['claim']}", False)
            elif key not in now:
                yield Change("findings", place, f"is gone: {was[key]['claim']}", True)
            elif key not in was:
                words = f"is new and {'holds' if now[key]['holds'] else 'fails'}: {now[key]['claim']}"
                yield Change("findings", place, words, not now[key]["holds"])
            elif was[key]["holds"] != now[key]["holds"]:
                state = "holds" if now[key]["holds"] else "fails"
                words = f"{state} now, measured {now[key]['measured']}: {now[key]['claim']}"
                yield Change("findings", place, words, not now[key]["holds"])


def not_run(report):
    """Return {(lesson/slug, quantity)} of the findings that the machine of a report could not make."""
    return {(f"{case['lesson']}/{case['slug']}", one["quantity"]) for case in report["stability"]
            for one in case.get("not_run", ())}


def by_case(report):
    """Return {lesson/slug: {(quantity, how many before it): finding}} of a report: a claim may be reworded."""
    cases = {}
    for case in report["stability"]:
        found = cases.setdefault(f"{case['lesson']}/{case['slug']}", {})
        for f in case["findings"]:
            found[f["quantity"], sum(quantity == f["quantity"] for quantity, _ in found)] = f
    return cases


def orders_and_errors(old, new):
    """Yield orders that differ, and for each curve the largest change of an error at one number of steps."""
    after = curves(new)
    for key, was in curves(old).items():
        now = after.get(key)
        if now is None:
            continue
        if was["order"] and now["order"] and abs(was["order"] - now["order"]) > ORDER:
            lower = now["order"] < was["order"]
            yield Change("orders", name_of(key), f"{was['order']:.2f} → {now['order']:.2f}", lower and not is_good(now))
        known = {row["steps"]: row["error"] for row in was["rows"]}
        pairs = [(row["steps"], known[row["steps"]], row["error"]) for row in now["rows"] if row["steps"] in known]
        pairs = [(n, a, b) for n, a, b in pairs if a and b and max(a, b) > ROUND_OFF and abs(b - a) > ERROR * a]
        if pairs:
            n, a, b = max(pairs, key=lambda pair: max(pair[2] / pair[1], pair[1] / pair[2]))
            yield Change("errors", name_of(key), f"{a:.3g} → {b:.3g} at {n} steps", not is_good(now))


def is_good(curve):
    return Verdict(curve["verdict"]) in GOOD


def times(old, new):
    """Yield methods whose ranges of times lie apart, by more than SLOWER, in units of an engine's step.

    The unit is the ratio of the engines' times in the same scene, which were measured alternately with ours, with
    its range; in a scene without an engine it is that of all scenes.  So the machine and a steady load cancel.
    Only a method that becomes slower in this unit, on a machine that nothing else used, is worse.
    """
    before, after, busy = timed(old), timed(new), busy_scenes(old) | busy_scenes(new)
    both = [key for key in before if key in after]
    ratios = {key: after[key]["seconds"] / before[key]["seconds"] for key in both}
    engines = {key: ratio for key, ratio in ratios.items() if key[2] == "engine"}
    finest = {key[:3]: key for key in sorted(both, key=lambda key: key[3])}
    for key in finest.values():
        scene, label, speed, steps = key
        unit = [ratio for other, ratio in engines.items() if other[0] == scene] or list(engines.values())
        pace = unit or [median(ratios.values())]
        was, now, ratio = before[key], after[key], ratios[key] / median(pace)
        slower = now["low"] / max(pace) > was["high"] and ratio > SLOWER
        quicker = now["high"] / min(pace) < was["low"] and ratio < 1.0 / SLOWER
        if speed != "engine" and (slower or quicker):
            words = f"{'slower' if slower else 'faster'} by {max(ratio, 1.0 / ratio):.2g}× at {steps} steps" \
                    f"{', measured on a busy machine' if scene in busy else ''}"
            yield Change("times", f"{scene}: {label}, {speed}", words, slower and bool(unit) and scene not in busy)


def busy_scenes(report):
    """Return the scenes of a report beside whose timing other programs ran, as its pages warn."""
    return {scene["scene"] for scene in report["scenes"] if scene.get("times") and busy_warning([scene], None)}


def timed(report):
    """Return {(scene, label, speed, steps): row} of all times that were measured in this run."""
    return {(scene["scene"], row["label"], row["speed"], row["steps"]): row
            for scene in report["scenes"] for row in (scene.get("times") or {}).get("rows", ())
            if row["speed"] != "recorded"}


def name_of(key):
    scene, case, _, label = key
    return f"{scene}, {case}: {label}"
