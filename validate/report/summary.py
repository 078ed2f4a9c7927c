"""A run in a few lines: one line per scene for the terminal, one line per lesson for the README."""

from collections import Counter
from statistics import median

from rich.table import Table

from ..check import Verdict
from ..measure.races import HEADLINE
from ..scene import EXACT
from . import races, words
from .numbers import factor, percent, rounded

SIGNS = {Verdict.DEPARTS: ("✗", "bold red"), Verdict.AGREES: ("✓", "green"), Verdict.FOLLOWS_OWN_LAW: ("≈", "green"),
         Verdict.BREAKS_AS_KNOWN: ("≈", "green"), Verdict.KEEPS_LAWS: ("§", "green"),
         Verdict.UNDECIDED: ("○", "yellow"), Verdict.NOT_ATTEMPTED: ("○", "yellow"),
         Verdict.UNFINISHED: ("○", "yellow")}            # a reference counts nowhere
LEGEND = ("✓ agrees   ≈ departs, or breaks a law of contact or joints, as predicted   § keeps these laws\n"
          "✗ departs otherwise   ○ undecided, unfinished, not attempted\n"
          f"order: the highest of ours.   faster: the engine's time to an error of {percent(HEADLINE)},\n"
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
    console.print(LEGEND, style="dim", highlight=False, soft_wrap=True)

    found = [(case, f) for case in stability for f in case["findings"]]
    failed = [(case, f) for case, f in found if not f["holds"]]
    not_run = sum(len(case["not_run"]) for case in stability)
    if found:
        console.print(f"Stability: {len(found) - len(failed)} of {len(found)} findings hold"
                      f"{f'; {not_run} not run on this machine' if not_run else ''}.")
    for case, f in failed:
        console.print(f"  [bold red]{case['lesson']}/{case['slug']}[/bold red] {f['claim']} "
                      f"Predicted {f['predicted']}, measured {f['measured']}.")
    return departures + len(failed)


def signs(curves):
    """Return how many of these curves have each verdict, such as ✓ 8 ≈ 1."""
    count = Counter(SIGNS[verdict] for c in curves if (verdict := Verdict(c["verdict"])) in SIGNS)
    return " ".join(f"[{style}]{sign} {count[sign, style]}[/{style}]" for sign, style in dict.fromkeys(SIGNS.values())
                    if count[sign, style]) or "–"


def best_order(result):
    """Return the highest order that one of our methods shows."""
    best = words.best_order(next(iter(result["cases"].values()))["ours"])
    if best is None:
        return "–"
    return EXACT if best["expected"] == EXACT else words.slope(best)


def faster(result):
    """Return the smallest of our advantages over the engines."""
    race = hardest(result)
    return factor(race["ratio"]) if race else "–"


def hardest(result):
    """Return the decided race of a scene, at the headline's error, with the smallest ratio; None without one."""
    decided = [race for race in races.at(races.of(result)) if race["ratio"]]
    return min(decided, key=lambda race: race["ratio"], default=None)


def by_lesson(report):
    """Return the Markdown table of a stored report (the content of report.json): one line per lesson, dated.

    The last but one column is the median of what `faster` says, with its interval, and its range over the scenes.
    """
    run, level = report["run"], percent(HEADLINE)
    lines = [f"Measured on {run['date']}: {run['mode']} run, {', '.join(run['engines'])}, {run['machine']}.",
             "✓ agrees with the truth · ≈ departs as predicted, or breaks a law by a rule named beforehand · § keeps "
             "the laws of contact or joints · ✗ departs otherwise · ○ undecided, unfinished or not attempted.", "",
             f"| lesson | scenes | our methods | engines | stability | engine's time over ours, to {level} error | "
             "losses, ties, undecided |",
             "|---|---|---|---|---|---|---|"]
    for lesson in dict.fromkeys(result["lesson"] for result in report["scenes"]):
        results = [result for result in report["scenes"] if result["lesson"] == lesson]
        findings = [f["holds"] for case in report["stability"] if case["lesson"] == lesson for f in case["findings"]]
        not_run = sum(len(case["not_run"]) for case in report["stability"] if case["lesson"] == lesson)
        hold = f"{sum(findings)} of {len(findings)}{f', {not_run} not run' if not_run else ''}" if findings else "–"
        cells = (f"`{lesson}`", len(results), plain_signs(results, "ours"), plain_signs(results, "engines"), hold,
                 spread([race for result in results if (race := hardest(result))]), not_won(results))
        lines.append(f"| {' | '.join(map(str, cells))} |")
    return "\n".join([*lines, "", *said_of_all(report), *said_of_truths(report)]) + "\n"


def said_of_truths(report):
    """Yield a sentence about the truths that are an engine's own run, if there are any."""
    if found := words.truths_by_engines(report["scenes"]):
        where = "; ".join(f"`{one['scene']}`{' (' + one['cases'] + ')' if one['cases'] else ''}, {one['engine']}"
                          for one in found)
        yield f"Where the truth is an engine's own run, that engine is not judged: {where}."


KEPT = ("date", "commit", "version", "engines", "compiler", "machine", "processor", "cores", "repeats")


def in_short(report):
    """Return what a quick report shows of a full run: when and on what machine, and how its races ended at each error.
    """
    return {**{key: report["run"].get(key) for key in KEPT}, "counts": races.counted(races.every(report["scenes"]))}


def said_of_all(report):
    """Yield sentences on all races of a report: every error by itself, and what the ratios are made of."""
    every = races.every(report["scenes"])
    counts = [count for count in races.counted(every) if count["races"]]
    if not counts:
        return
    yield ("A race compares the time of an engine with ours, to the same error in the first case of a scene. The "
           "interval in brackets is what the intervals of both times allow, and a tenth more on either side, as two "
           "runs may differ. The table takes the smallest ratio of each scene: the median of these, and their range. "
           "Medians of all races in which both reach the error:")
    yield ". ".join(f"At {count['name']} {races.summary_ratio(count)}; {ended(count)}" for count in counts) + "."
    plain = races.headline_of(counts)["plain"]
    if plain["races"]:
        yield (f"Our loops are compiled by numba. In plain Python they are faster than the engine in {plain['faster']} "
               f"of the {plain['races']} races to {percent(HEADLINE)} in which they were timed.")
    made = races.median_factors(every)
    if made["order"] is not None:
        yield (f"In {made['parted']} of the {made['ratios']} races to {percent(HEADLINE)} that have a ratio, it is the "
               f"product of two: the method's order, and the loop at the engine's own order. (In the others no method "
               f"of ours is compared at the engine's order.) The medians of the two are {factor(made['order'])} and "
               f"{factor(made['loop'])}. "
               f"(The product of two medians is not the median of the products.) In the median calls "
               f"from Python make the engine's time {factor(made['calls'])} as long.{compiled(made)}")


def ended(count):
    """Return how many races at one error ended how."""
    kinds = {"slower": "lost", "tie": "tied", "undecided": "undecided", "engine_fails": "not reached by the engine",
             "neither": "reached by neither"}
    return f"of {count['races']} races " + ", ".join(
        f"{count[kind]} {end}" for kind, end in kinds.items()
        if count[kind] or kind in ("slower", "tie", "undecided"))


def compiled(made):
    """Return the sentence on compilation; nothing where it was not measured."""
    if made["cold"] is None:
        return ""
    return (f" Compilation is not in these times: in the median it takes {rounded(made['cold'])} s, and "
            f"{rounded(made['cached'])} s from the cache.")


def not_won(results):
    """Return the numbers of losses, ties and undecided races of some scenes, at the headline's error."""
    found = races.at(races.every(results))
    if not found:
        return "–"
    count = races.outcomes(found)
    return f"{count['slower']}, {count['tie']}, {count['undecided']} of {len(found)}"


def plain_signs(results, kind):
    """Return how many curves of these results have each verdict, without colours: ✓ 8 ≈ 1."""
    verdicts = [Verdict(c["verdict"]) for result in results for case in result["cases"].values() for c in case[kind]]
    count = Counter(SIGNS[v][0] for v in verdicts if v in SIGNS)
    return " ".join(f"{sign} {count[sign]}" for sign, _ in dict.fromkeys(SIGNS.values()) if count[sign]) or "–"


def spread(decided):
    """Return the median ratio of some races with its interval, and the range of the scenes: 62× (58 to 66); 2.1 to 440.
    """
    if not decided:
        return "–"
    middle = {key: median(race[key] for race in decided) for key in ("low", "ratio", "high")}
    least, most = (rounded(of(race["ratio"] for race in decided)) for of in (min, max))
    return races.with_interval(middle) + (f"; scenes {least} to {most}" if len(decided) > 1 else "")
