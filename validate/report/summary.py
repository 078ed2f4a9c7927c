"""A run in a few lines: one line per scene for the terminal, one line per lesson for the README."""

from collections import Counter
from statistics import median

from rich.table import Table

from ..check import Verdict
from ..scene import EXACT
from . import words

SIGNS = {Verdict.DEPARTS: ("✗", "bold red"), Verdict.AGREES: ("✓", "green"), Verdict.FOLLOWS_OWN_LAW: ("≈", "green"),
         Verdict.UNDECIDED: ("○", "yellow"), Verdict.NOT_ATTEMPTED: ("○", "yellow")}
LEGEND = ("✓ agrees   ≈ as predicted, by a law of its own   ✗ departs   ○ undecided or not attempted\n"
          "order: the highest of ours.   faster: the engine's time to its smallest error,\n"
          "over our time to the same error; the smallest of the engines' ratios.")


def show(console, results, stability):
    """Print the table and what fails; return the number of unpredicted departures."""
    table = Table(header_style="bold", box=None, pad_edge=False)
    products = words.products(results)
    for column in ("scene", "ours", *products, "order", "faster"):
        table.add_column(column, no_wrap=True, justify="right" if column in ("order", "faster") else "left")
    departures = 0
    for result in results:
        cases = result["cases"].values()
        ours, engines = ([c for one in cases for c in one[kind]] for kind in ("ours", "engines"))
        departures += sum(Verdict(c["verdict"]) is Verdict.DEPARTS for c in ours + engines)
        of_each = (signs([c for c in engines if c["product"] == name]) for name in products)
        table.add_row(result["scene"], signs(ours), *of_each, best_order(result), faster(result))
    console.print(table)
    console.print(LEGEND, style="dim", highlight=False)

    found = [(case, f) for case in stability for f in case["findings"]]
    failed = [(case, f) for case, f in found if not f["holds"]]
    if found:
        console.print(f"Stability: {len(found) - len(failed)} of {len(found)} findings hold.")
    for case, f in failed:
        console.print(f"  [bold red]{case['lesson']}/{case['slug']}[/bold red] {f['claim']} "
                      f"Predicted {f['predicted']}, measured {f['measured']}.")
    return departures + len(failed)


def signs(curves):
    """Return how many of these curves have each verdict, such as ✓ 8 ≈ 1."""
    count = Counter(SIGNS[Verdict(c["verdict"])] for c in curves)
    return " ".join(f"[{style}]{sign} {count[sign, style]}[/{style}]" for sign, style in dict.fromkeys(SIGNS.values())
                    if count[sign, style]) or "–"


def best_order(result):
    """Return the highest order that one of our methods shows."""
    best = words.best_order(next(iter(result["cases"].values()))["ours"])
    if best is None:
        return "–"
    return EXACT if best["expected"] == EXACT else f"{best['order']:.2f}"


def faster(result):
    """Return the smallest of our advantages over the engines."""
    ratios = advantages(result)
    return words.factor(min(ratios)) if ratios else "–"


def by_lesson(report):
    """Return the Markdown table of a stored report (the content of report.json): one line per lesson, dated.

    The last column is the median of what `faster` says, and its range over the lesson's scenes.
    """
    run = report["run"]
    lines = [f"Measured on {run['date']}: {run['mode']} run, {', '.join(run['engines'])}, {run['machine']}.",
             "✓ agrees with the truth · ≈ as predicted, by a law of its own · ✗ departs · ○ undecided.", "",
             "| lesson | scenes | our methods | engines | stability | faster than the engines at equal error |",
             "|---|---|---|---|---|---|"]
    for lesson in dict.fromkeys(result["lesson"] for result in report["scenes"]):
        results = [result for result in report["scenes"] if result["lesson"] == lesson]
        findings = [f["holds"] for case in report["stability"] if case["lesson"] == lesson for f in case["findings"]]
        ratios = [min(found) for result in results if (found := advantages(result))]
        hold = f"{sum(findings)} of {len(findings)}" if findings else "–"
        cells = (f"`{lesson}`", len(results), plain_signs(results, "ours"), plain_signs(results, "engines"), hold,
                 spread(ratios))
        lines.append(f"| {' | '.join(map(str, cells))} |")
    return "\n".join(lines) + "\n"


def advantages(result):
    """Return our advantages over each engine, as ratios of run times at equal error."""
    return [a["ratio"] for a in words.races(result).values() if a["ratio"]]


def plain_signs(results, kind):
    """Return how many curves of these results have each verdict, without colours: ✓ 8 ≈ 1."""
    verdicts = [Verdict(c["verdict"]) for result in results for case in result["cases"].values() for c in case[kind]]
    count = Counter(SIGNS[v][0] for v in verdicts)
    return " ".join(f"{sign} {count[sign]}" for sign, _ in dict.fromkeys(SIGNS.values()) if count[sign]) or "–"


def spread(ratios):
    """Return median and range of ratios, such as 62× (2.1× to 440×)."""
    if not ratios:
        return "–"
    middle, low, high = (words.factor(r) for r in (median(ratios), min(ratios), max(ratios)))
    return middle if len(ratios) == 1 else f"{middle} ({low} to {high})"
