"""Write the report: one folder of static pages that need no network, and the same content as JSON."""

import json
from pathlib import Path

from jinja2 import Environment, PackageLoader, select_autoescape

from ..store import whole
from . import plots, words

HERE = Path(__file__).parent
ARROWS = ("#e69f00", "#cc79a7", "#009e73")      # as in player3d/source.js
PLAYER_3D = HERE / "player3d.js"


def pictures(results, stability):
    """(plot, file, data, the scene or lesson that it is of) of every still picture."""
    refined = [r for r in results if r["refinement"]]
    drawn = [case for case in stability if case["picture"]]
    return [*((plots.convergence, f"{r['scene']}-steps.svg", r, r["scene"]) for r in refined),
            *((plots.work_precision, f"{r['scene']}-times.svg", r, r["scene"]) for r in refined),
            *((plots.stability, f"stability-{case['lesson']}-{case['slug']}.svg", case, case["lesson"])
              for case in drawn)]


def copied(results):
    """Files that come with the pages as they are."""
    return ("style.css", "player.js", *(["player3d.js"] if any(r["picture"]["space"] for r in results) else []))


def files(results, stability):
    """The names of all files of a report."""
    always = "index.html", "report.json", "coverage.html", "left_out.html"
    return {*always, *(["stability.html"] if stability else []), *copied(results),
            *(f"{r['scene']}.html" for r in results), *(name for _, name, _, _ in pictures(results, stability))}


def texts(results, stability, about):
    """Return {file: text} of everything in a report but its pictures."""
    pages = Environment(loader=PackageLoader("validate", "report"), autoescape=select_autoescape(),
                        trim_blocks=True, lstrip_blocks=True)
    pages.filters.update(seconds=words.seconds, number=words.number, percent=words.percent, factor=words.factor,
                         order=words.order)
    pages.tests["reaches"] = lambda row: any(t is not None for t in row.values())
    pages.globals.update(run=about, verdict=words.verdict, judge=words.judge, arrow_colours=ARROWS)

    found = {f"{r['scene']}.html": pages.get_template("scene.html").render(
        r=r, findings=words.findings(r), others=results,
        cases=[c for c in stability if c["lesson"] == r["lesson"]]) for r in results}
    if about.get("coverage"):
        scenes = {r["scene"]: r["title"] for r in results}
        cases = {f"{c['lesson']}/{c['slug']}": c["title"] for c in stability}
        found["coverage.html"] = pages.get_template("coverage.html").render(
            coverage=about["coverage"], scenes=scenes, cases=cases)
    found["left_out.html"] = pages.get_template("left_out.html").render(rows=words.left_out(results))
    if stability:
        found["stability.html"] = pages.get_template("stability.html").render(cases=stability)
    rows = [words.row(r) for r in results]
    found["index.html"] = pages.get_template("front.html").render(rows=rows, cases=stability, results=results)
    data = {"run": about, "scenes": results, "stability": stability}
    found["report.json"] = json.dumps(data, ensure_ascii=False, indent=1)
    found |= {name: (HERE / name).read_text(encoding="utf-8") for name in copied(results)}
    return found


def write(out, results, stability, about, pool, bars, measured):
    """Write pages, pictures and report.json into a folder; return the path of the front page.

    about says what the report was made with: a plain record that stands at the foot of every page.
    measured(scene or lesson) is when its results were written [ns]: pictures newer than that are not drawn again.
    """
    calls = {name: (plots.draw, plot, out / name, data) for plot, name, data, of in pictures(results, stability)
             if not (out / name).is_file() or (out / name).stat().st_mtime_ns <= measured(of)}
    bar = bars.add_task("report", total=len(calls) + 1)
    for _ in pool.each(calls):
        bars.advance(bar)

    for name, text in texts(results, stability, about).items():
        with whole(out / name) as draft:
            draft.write_bytes(text.encode())
    bars.advance(bar)
    return out / "index.html"
