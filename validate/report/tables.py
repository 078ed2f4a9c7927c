"""The numbers of the plots and tables as CSV: files for those of a plot, addresses that hold their data for others."""

import csv
import io
from urllib.parse import quote

from . import choice, races, words
from .answers import departures

RUNS = ("case", "method or engine", "role", "steps", "dt [s]", "relative error [-]", "limit [-]",
        "error from its own law [-]", "order", "expected order", "verdict", "failure")
TIMES = ("method or engine", "speed", "steps", "relative error [-]", "median time [s]", "lower end of its interval [s]",
         "upper end [s]")
SCENES = ("scene", "lesson", "side", "verdict", "comparisons")
RACES = ("scene", "lesson", "engine", "race to", "relative error [-]", "outcome", "why there is no ratio",
         "engine's settings", "engine's time [s]", "our method", "our speed", "our time [s]",
         "ratio [-]", "lowest ratio [-]", "highest ratio [-]", "engine's order",
         "order: our method of that order over our quickest [-]", "loop: the engine over our method of its order [-]",
         "calls: the engine over itself without calls from Python [-]", "compilation, cold [s]",
         "compilation, from the cache [s]", "motion until compilation has paid [s]",
         "engine's coarsest run", "our coarsest run")
CHOICE = ("scene", "lesson", "speed", "cheapest at 1 %", "its time [s]", "cheapest at 0.01 %", "its time [s]",
          "safest at large steps", "its least number of steps, times 1 + error there [-]")
PARTS = ("scene", "engine", "part", "steps", "time with it over time without it [-]", "lowest [-]", "highest [-]",
         "relative change without it [-]")
OUR_PARTS = ("scene", "speed", *PARTS[2:])
DEPARTURES = ("engine", "verdict", "smallest departure [-]", "largest departure [-]", "reason", "scenes")
FINDINGS = ("lesson", "case", "claim", "quantity", "predicted", "measured", "tolerance", "holds", "observation",
            "the tolerance was measured on")


def text(header, rows):
    """Return a CSV; None is an empty cell."""
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(["" if cell is None else cell for cell in row] for row in rows)
    return file.getvalue()


def address(header, rows):
    """Return the same as an address that a link can lead to: small tables need no file."""
    return "data:text/csv;charset=utf-8," + quote(text(header, rows))


def names(results, stability):
    """Return the files that `texts` gives."""
    drawn = [case for case in stability if case["picture"]]
    front = {"scenes.csv": True, "races.csv": races.every(results), "choice.csv": choice.scenes(results),
             "departures.csv": departures(results)["lines"], "engine-parts.csv": words.engine_parts(results),
             "our-parts.csv": rows_of_ours(results)}
    return {*(name for name, rows in front.items() if rows), *(f"{r['scene']}-runs.csv" for r in results),
            *(f"{r['scene']}-times.csv" for r in results if r["refinement"]), *(["stability.csv"] if stability else []),
            *(f"stability-{case['lesson']}-{case['slug']}.csv" for case in drawn)}


def texts(results, stability):
    """Return {file: CSV} of all plots and of the long tables; none for a table that is empty."""
    products = words.products(results)
    rows = [(r, words.row(r, products)) for r in results]
    lines = departures(results)["lines"]
    found = {
        "scenes.csv": text(SCENES, [(r["scene"], r["lesson"], side, verdict, count) for r, row in rows
                                    for side, found in (("ours", row["ours"]), *row["engines"].items())
                                    for verdict, _, count in found]),
    }
    if races.every(results):
        found["races.csv"] = text(RACES, map(race_row, races.every(results)))
    if choice.scenes(results):
        found["choice.csv"] = text(CHOICE, choice.scenes(results))
    if lines:
        found["departures.csv"] = text(DEPARTURES, [
            (d["engine"], d["kind"], d["low"], d["high"], d["reason"], d["whose"], " ".join(d["places"]))
            for d in lines])
    if parts := words.engine_parts(results):
        found["engine-parts.csv"] = text(PARTS, part_rows(parts, "engine"))
    if parts := rows_of_ours(results):
        found["our-parts.csv"] = text(OUR_PARTS, parts)
    for r in results:
        found[f"{r['scene']}-runs.csv"] = text(RUNS, runs(r))
        if r["refinement"]:
            found[f"{r['scene']}-times.csv"] = text(TIMES, [
                (t["label"], t["speed"], t["steps"], t["error"], t["seconds"], t["low"], t["high"])
                for t in r["times"]["rows"]])
    if stability:
        found["stability.csv"] = text(FINDINGS, [
            (c["lesson"], c["slug"], f["claim"], f["quantity"], f["predicted"], f["measured"], f["tolerance"],
             yes(f["holds"]), f["observation"], f["tolerance_from"]) for c in stability for f in c["findings"]]
            + [(c["lesson"], c["slug"], one["claim"], one["quantity"], None, None, None, "not run", one["why"], None)
               for c in stability for one in c["not_run"]])
    for case in stability:
        if case["picture"]:
            found[f"stability-{case['lesson']}-{case['slug']}.csv"] = of_picture(case["picture"])
    return found


def race_row(race):
    """Return one race as a line of RACES."""
    engine, ours = (race[side] or {} for side in ("engine", "ours"))
    return (race["scene"], race["lesson"], race["product"], races.level_name(race["level"]), race["error"],
            race["outcome"], race["why"], engine.get("label"), engine.get("seconds"), ours.get("label"),
            ours.get("speed"), ours.get("seconds"), race["ratio"], race["low"], race["high"], race["order_of_engine"],
            race["order"], race["loop"], race["calls"], race["cold"], race["cached"], race["paid"],
            yes(engine.get("coarsest")), yes(ours.get("coarsest")))


def part_rows(parts, key):
    """Return the lines of PARTS or OUR_PARTS; key: engine or speed."""
    return [(scene["scene"], row[key], part, row["steps"], row["cost"], *row["range"], row["change"])
            for scene in parts for part, rows in scene["found"].items() for row in rows]


def rows_of_ours(results):
    """Return the lines of OUR_PARTS."""
    return part_rows(words.our_parts(results), "speed")


def yes(answer):
    """Return yes or no; nothing where there is no answer."""
    return None if answer is None else "yes" if answer else "no"


def runs(result):
    """Yield every run of every case of a scene."""
    for name, case in result["cases"].items():
        for c in case["ours"] + case["engines"]:
            own = {row["steps"]: error for row, error in words.own_errors(c)}
            for row in c["rows"]:
                yield (name, c["label"], c["role"], row["steps"], row["dt"], row["error"], row["limit"],
                       own.get(row["steps"]), c["order"], c["expected"], c["verdict"], row["failure"])


def ablations(result):
    """Return what a scene leaves out, and what it costs to put it in."""
    return [(row["what"], row["cost"], row["same"], row["note"]) for row in result["times"]["ablations"]]


def coverage(table):
    """Return which places run each exercise."""
    return [(number, row["function"], row["lesson"], " ".join(row["places"])) for number, row in table.items()]


def split_places(places, of_stability, most=None):
    """Return (the first `most` places, how many more): scenes, or stability cases."""
    found = [place for place in places if place.startswith("stability/") is of_stability]
    return found[:most], len(found[most:]) if most else 0


def given(table):
    """Return which places run each given function."""
    return [(module, function, " ".join(places)) for module, functions in table.items()
            for function, places in functions.items()]


def of_picture(picture):
    """Return the curves of a stability case; of maps a table each, with a line for each y and a column for each x."""
    if not picture.get("maps"):
        rows = [(label, x, y) for label, xs, ys, _ in picture["series"] for x, y in zip(xs, ys)]
        return text(("curve", picture["x_label"], picture["y_label"]), rows)
    header = (picture["title"], picture["y_label"], *(f"{picture['x_label']} = {x}" for x in picture["maps"][0]["xs"]))
    return text(header, [(one["label"], y, *line) for one in picture["maps"]
                         for y, line in zip(one["ys"], one["values"])])
