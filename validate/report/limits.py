"""Sharpness of the limits of a report: `validate limits [REPORT]`.

A limit is the largest error that theory allows a run.  Limit over error says how much larger the error could have been
without a change of the verdict.  A row with a limit below ROUND_OFF_ONLY is a comparison to round-off and is left
out: it says how exact a computer is.  A row with a prediction is judged from below as well.
"""

import math
from statistics import quantiles
from typing import NamedTuple

from rich.console import Console
from rich.table import Table

from solutions.checks import BadInput

from ..measure.accuracy import ASYMPTOTIC
from ..run.store import report_of_this_version
from .audit import distance

ROUND_OFF_ONLY = 1e-9        # limits below this leave room for round-off only, relative [-]
LOOSEST = 20                 # curves that are named


class Row(NamedTuple):
    """One run that was judged."""
    lesson: str
    scene: str
    case: str
    label: str
    ratio: float             # limit over error [-]; infinite where the error is zero
    two_sided: bool
    steps: int


def rows_of(report):
    """Yield the runs of a report that were judged by more than round-off."""
    for result in report["scenes"]:
        for name, case in result["cases"].items():
            for curve in case["ours"] + case["engines"]:
                law = curve.get("own_law") or case["truth"]
                for row in curve["rows"]:
                    if row["limit"] is None or row["failure"] or not ROUND_OFF_ONLY <= row["limit"] < ASYMPTOTIC:
                        continue
                    error = distance(row["observed"], law)
                    yield Row(result["lesson"], result["scene"], name, curve["label"],
                              row["limit"] / error if error else math.inf, row.get("predicted") is not None,
                              row["steps"])


def share(ratios, percent):
    """Return the value that this percentage of the ratios does not exceed."""
    if len(ratios) == 1 or math.isinf(max(ratios)):                    # quantiles() cannot interpolate to infinity
        return sorted(ratios)[math.ceil(percent / 100.0 * len(ratios)) - 1]
    return quantiles(ratios, n=100, method="inclusive")[percent - 1]


def table_of(title, rows, key):
    """Return a table of the ratios, one line for each value of `key`, and one for all."""
    table = Table(title, "rows", "two-sided", "median", "90 %", "largest", box=None, header_style="bold")
    groups = {}
    for row in rows:
        groups.setdefault(key(row), []).append(row)
    for name, group in [*groups.items(), ("all", rows)]:
        ratios = [row.ratio for row in group]
        sides = f"{sum(row.two_sided for row in group) / len(group):.0%}"
        largest = share(ratios, 50), share(ratios, 90), max(ratios)
        table.add_row(name, str(len(group)), sides, *(f"{x:.3g}" for x in largest))
    return table


def loosest(rows):
    """Return the curves whose tightest row is the loosest: a wrong number hides best there."""
    curves = {}
    for row in rows:
        curves.setdefault((row.scene, row.case, row.label), []).append(row)
    table = Table("loosest curves", "case", "", "steps", "limit/error, least", box=None, header_style="bold")
    tightest = sorted((min(group, key=lambda row: row.ratio) for group in curves.values()), key=lambda row: -row.ratio)
    for row in tightest[:LOOSEST]:
        table.add_row(row.scene, row.case, row.label, str(row.steps), f"{row.ratio:.3g}")
    return table


def show(report):
    """Print how sharp the limits of a report are.  Raises BadInput for a report without limits."""
    rows = list(rows_of(report_of_this_version(report)))
    if not rows:
        raise BadInput(f"report {str(report)!r}", "without a limit above round-off", "name a report of more scenes")
    console = Console(width=120)
    for table in (table_of("lesson", rows, lambda row: row.lesson), table_of("scene", rows, lambda row: row.scene),
                  loosest(rows)):
        console.print(table, "")
