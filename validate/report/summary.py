"""The table that a run ends with."""

from rich.table import Table

from . import words

COLOURS = {"agrees": "green", "predicted": "green", "departs": "bold red", "open": "yellow", "none": "dim"}


def show(console, results, stability):
    """Print a line a scene; the number of departures that nobody predicted."""
    table = Table(header_style="bold", box=None, pad_edge=False)
    for column in ("scene", "ours", "pymunk", "pybullet", "order (expected)", "best engine error: theirs / ours"):
        table.add_column(column, no_wrap=column == "scene", overflow="fold")
    departures = 0
    for result in results:
        row = words.row(result)
        every = [c for one in result["cases"].values() for c in one["ours"] + one["engines"]]
        departures += sum(c["right"] is False for c in every)
        best = f"{row['best']['label']} {words.order(row['best'])}" if row["best"] else "–"
        faster = ", ".join(f"{n} {words.factor(a['ratio'])}" for n, a in row["advantages"].items()) or "–"
        table.add_row(result["scene"], coloured(row["ours"]), *(coloured(v) for v, _ in row["engines"].values()), best, faster)
    console.print(table)

    found = [f for case in stability for f in case["findings"]]
    failed = [f for f in found if not f["holds"]]
    if found:
        console.print(f"Stability: {len(found) - len(failed)} of {len(found)} findings hold.")
    for f in failed:
        console.print(f"  [bold red]case {f['case']}[/bold red] {f['claim']}: bound {f['bound']}, measured {f['measured']}")
    return departures + len(failed)


def coloured(verdict):
    text, kind = verdict
    return f"[{COLOURS[kind]}]{text}[/{COLOURS[kind]}]"
