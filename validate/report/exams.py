"""Published benchmarks in words and numbers: what each method and engine reached of them."""

from ..check import Role


def of(results):
    """Return [{scene, title, …, rows}] of all scenes that are published benchmarks."""
    return [{**exam, "scene": r["scene"], "title": r["title"], "rows": [line(row) for row in exam["rows"]]}
            for r in results if (exam := r["times"].get("exam"))]


def line(row):
    """Return a contestant with the runs that the page shows: of each class the quickest, else the best of all."""
    made = [run for run in row["runs"] if run["error"] is not None]
    grades = dict.fromkeys(run["grade"] for run in sorted(made, key=lambda run: -run["error"]) if run["grade"])
    shown = [min((run for run in made if run["grade"] == grade), key=lambda run: run["seconds"]) for grade in grades]
    if not shown and made:
        shown = [min(made, key=lambda run: run["error"])]
    failed = next((run["failure"] for run in reversed(row["runs"]) if run["failure"]), "")
    return {**row, "ours": Role(row["role"]) is Role.OURS, "shown": shown, "why": failed or row["left"]}
