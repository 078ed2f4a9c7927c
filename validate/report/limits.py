"""Sharpness of the limits of a report: `validate limits [REPORT]`.

Three numbers say how far a wrong run could go unnoticed.

two-sided          share of the rows whose error theory predicts: such a run may err neither more nor less
band/prediction    of a two-sided row: the allowed distance from the predicted error, over the predicted error
limit/error        of a one-sided row: how much larger its error could have been without a change of the verdict

A row with a limit below ROUND_OFF_ONLY is a comparison to round-off and is left out: it says how exact a computer is.
"""

import math
from statistics import quantiles
from typing import NamedTuple

from rich.console import Console
from rich.table import Table

from solutions.checks import BadInput

from ..measure.accuracy import ASYMPTOTIC
from ..run.store import report_of_this_version
from .again import distance
from .numbers import number

ROUND_OFF_ONLY = 1e-9        # limits below this leave room for round-off only, relative [-]
LOOSEST = 20                 # curves that are named


class Row(NamedTuple):
    """One run that was judged."""
    lesson: str
    scene: str
    case: str
    label: str
    steps: int
    two_sided: bool
    slack: float             # band over prediction, or limit over error [-]; infinite where it would be divided by zero


def rows_of(report):
    """Yield the runs of a report that were judged by more than round-off."""
    for result in report["scenes"]:
        for name, case in result["cases"].items():
            for curve in case["ours"] + case["engines"]:
                law = curve.get("own_law") or case["truth"]
                for row in curve["rows"]:
                    if row["limit"] is None or row["failure"] or not ROUND_OFF_ONLY <= row["limit"] < ASYMPTOTIC:
                        continue
                    two_sided = row["predicted"] is not None
                    allowed, of = ((row["band"], distance(row["predicted"], law)) if two_sided else
                                   (row["limit"], distance(row["observed"], law)))
                    yield Row(result["lesson"], result["scene"], name, curve["label"], row["steps"], two_sided,
                              allowed / of if of else math.inf)


def share(ratios, percent):
    """Return the value that this percentage of the ratios does not exceed."""
    if len(ratios) == 1 or math.isinf(max(ratios)):                    # quantiles() cannot interpolate to infinity
        return sorted(ratios)[math.ceil(percent / 100.0 * len(ratios)) - 1]
    return quantiles(ratios, n=100, method="inclusive")[percent - 1]


def three(rows):
    """Return the cells of the three numbers of some rows; dashes where a kind of rows is missing."""
    kinds = [[row.slack for row in rows if row.two_sided is two_sided] for two_sided in (True, False)]
    cells = [[cell(x) for x in (share(slacks, 50), share(slacks, 90), max(slacks))] if slacks else ["–"] * 3
             for slacks in kinds]
    return [f"{len(kinds[0]) / len(rows):.0%}", *cells[0], *cells[1]]


def cell(x):
    """Return a number of the tables as text."""
    return "∞" if math.isinf(x) else number(x, 2)


def table_of(title, rows, key):
    """Return a table of the three numbers, one line for each value of `key`, and one for all."""
    table = Table(title, "rows", "two-sided", "band/prediction", "90 %", "largest", "limit/error", "90 %", "largest",
                  box=None, header_style="bold")
    groups = {}
    for row in rows:
        groups.setdefault(key(row), []).append(row)
    for name, group in [*groups.items(), ("all", rows)]:
        table.add_row(name, str(len(group)), *three(group))
    return table


def loosest(rows, two_sided, title):
    """Return the curves of one kind whose tightest row is the loosest: a wrong number hides best there."""
    curves = {}
    for row in rows:
        curves.setdefault((row.scene, row.case, row.label), []).append(row)
    table = Table("loosest curves", "case", "", "steps", title, box=None, header_style="bold")
    mine = [group for group in curves.values() if any(row.two_sided for row in group) is two_sided]
    tightest = [min((row for row in group if row.two_sided is two_sided), key=lambda row: row.slack) for group in mine]
    for row in sorted(tightest, key=lambda row: -row.slack)[:LOOSEST]:
        table.add_row(row.scene, row.case, row.label, str(row.steps), cell(row.slack))
    return table


def show(report):
    """Print how sharp the limits of a report are.  Raises BadInput for a report without limits."""
    rows = list(rows_of(report_of_this_version(report)))
    if not rows:
        raise BadInput(f"report {str(report)!r}", "without a limit above round-off", "name a report of more scenes")
    console = Console(width=120)
    console.print("Columns without a name of their own belong to the one before them, which is a median.", "")
    for table in (table_of("lesson", rows, lambda row: row.lesson), table_of("scene", rows, lambda row: row.scene),
                  loosest(rows, False, "limit/error, least"), loosest(rows, True, "band/prediction, least")):
        console.print(table, "")
