"""The report: one folder of static pages that need no network, and the same content as JSON."""

import json
from functools import cache
from math import log
from pathlib import Path

from jinja2 import Environment, PackageLoader, select_autoescape
from markupsafe import Markup

from ..check import Verdict
from ..engines.products import PRODUCTS
from ..measure.races import EXACTLY, HEADLINE, LEVELS
from ..measure.timing import LONG, LONG_REPEATS, TARGETS
from ..run.store import whole
from . import choice, exams, films, numbers, plots, races, tables, words
from .answers import LEAST, MOST, answers

HERE = Path(__file__).parent
ARROWS = ("#e69f00", "#cc79a7", "#009e73")      # as in player3d/source.js
PLAYER_3D = HERE / "player3d.js"
LESSONS = {"pbd": "PBD"}     # names that are no words
BARS_MOST = 20_000.0         # largest ratio that the bars of a scene's page have room for [-]


def pictures(results, stability):
    """Return (plot, file, data, the scene or lesson that it is of) of every still picture."""
    refined = [({key: value for key, value in r.items() if key != "picture"}, r["scene"])
               for r in results if r["refinement"]]
    drawn = [case for case in stability if case["picture"]]
    return [*((plots.convergence, f"{scene}-steps.svg", r, scene) for r, scene in refined),
            *((plots.work_precision, f"{scene}-times.svg", r, scene) for r, scene in refined),
            *((plots.stability, f"stability-{case['lesson']}-{case['slug']}.svg", case, case["lesson"])
              for case in drawn)]


def copied(results):
    """Return the files that come with the pages unchanged."""
    return ("style.css", "dark.css", "report.css", "report.js", "player.js",
            *(["player3d.js"] if any(r["picture"]["space"] for r in results) else []))


def files(results, stability):
    """Return the names of all files of a report."""
    always = "index.html", "report.json", "coverage.html", "left_out.html"
    more = [*(["stability.html"] if stability else []), *(["exams.html"] if exams.of(results) else [])]
    return {*always, *more, *copied(results), *tables.names(results, stability),
            *(name for r in results for name in (f"{r['scene']}.html", f"{r['scene']}-film.js")),
            *(name for _, name, _, _ in pictures(results, stability))}


def place(ratio, least=LEAST, most=MOST):
    """Return where a ratio stands on a scale, which is logarithmic and by default the front page's [%]."""
    share = log(min(max(ratio, least), most) / least) / log(most / least)
    return round(100.0 * share, 2)


def thumbnail(picture):
    """Return a still picture of a film, as an SVG in the page."""
    return Markup(environment().get_template("thumbnail.html").render(runs=films.still(picture)))


@cache
def environment():
    """Return the templates, with what they call."""
    pages = Environment(loader=PackageLoader("validate", "report"), autoescape=select_autoescape(),
                        trim_blocks=True, lstrip_blocks=True)
    pages.filters.update(seconds=numbers.seconds, number=numbers.number, percent=numbers.percent,
                         factor=numbers.factor, rounded=numbers.rounded, order=words.order, ratio=races.ratio,
                         flowing=words.flowing, css_colour=plots.css_colour, place=place, subscripts=words.subscripts,
                         lesson=lambda name: LESSONS.get(name, name.replace("_", " ")))
    pages.tests["reaches"] = lambda row: any(t is not None for t in row["seconds"])
    pages.globals.update(judge=words.judge, verdicts=words.verdicts, known=numbers.known, percents=numbers.percents,
                         levels=LEVELS, targets=TARGETS, race_error=HEADLINE, level_name=races.level_name,
                         coarse=races.coarse, coarse_runs=races.coarse_runs, summary_ratio=races.summary_ratio,
                         engine_name=numbers.engine_name, listed=words.listed, exactly=EXACTLY,
                         long=LONG, long_repeats=LONG_REPEATS,
                         measured_limits=words.measured_limits, least=LEAST, most=MOST,
                         bars_most=BARS_MOST, cheap=choice.CHEAP, race_header=tables.RACES,
                         race_rows=lambda r: map(tables.race_row, races.of(r)),
                         legend=[(v.value, words.KINDS[v], words.LEGEND[v]) for v in Verdict], thumb=thumbnail,
                         arrow_colours=ARROWS, arrow_meanings=words.ARROWS, with_units=words.with_units,
                         csv=tables.address, ablation_rows=tables.ablations,
                         coverage_rows=tables.coverage, given_rows=tables.given,
                         split_places=tables.split_places, summary_line=words.summary_line,
                         dimensions={product.name: product.dimensions for product in PRODUCTS},
                         theory_of=words.theory_of, meanings={v.value: words.LEGEND[v] for v in Verdict},
                         unpredicted=words.unpredicted, engines_of=words.engines_of, part_names=words.part_names,
                         part_products=words.part_products)
    return pages


def texts(results, stability, about):
    """Return {file: text} of everything in a report but its pictures."""
    pages = environment()
    shown = {"run": about, "results": results, "stability": stability, "exams": exams.of(results)}

    def page(template, **more):
        return pages.get_template(template).render(**shown, **more)

    lessons = list(dict.fromkeys(r["lesson"] for r in results))
    coverage = about.get("coverage") or {}
    found = {f"{r['scene']}.html": page("scene.html", **of_scene(r, stability, about, coverage)) for r in results}
    if coverage:
        found["coverage.html"] = page(
            "coverage.html", coverage=coverage, scenes={r["scene"]: r["title"] for r in results},
            cases={f"{c['lesson']}/{c['slug']}": c["title"] for c in stability})
    found["left_out.html"] = page("left_out.html", rows=words.left_out(results), ours=words.our_parts(results),
                                  parts=words.engine_parts(results), omissions=words.omissions(results))
    if shown["exams"]:
        found["exams.html"] = page("exams.html")
    if stability:
        found["stability.html"] = page("stability.html", cases=stability)
    products = words.products(results)
    found["index.html"] = page("front.html", rows=[words.row(r, products) for r in results], lessons=lessons,
                               products=products, found=answers(results, stability, about.get("cores")))
    found["report.json"] = json.dumps({"run": about, "scenes": results, "stability": stability}, ensure_ascii=False)
    found |= {f"{r['scene']}-film.js": films.script(r) for r in results}
    found |= tables.texts(results, stability)
    found |= {name: (HERE / name).read_text(encoding="utf-8") for name in copied(results)}
    return found


def of_scene(r, stability, about, coverage):
    """Return what the page of a scene shows, by its names in the template."""
    return {"r": r, "headline": words.headline(r), "findings": words.leading(r),
            "seen_in_steps": words.seen_in_steps(r), "races": races.rows(races.of(r)), "parts": words.our_parts([r]),
            "warning": words.busy_warning([r], about.get("cores")),
            "notebook": about.get("notebooks", {}).get(r["lesson"]),
            "exercises": [(number, one["function"]) for number, one in coverage.items() if r["scene"] in one["places"]],
            "cases": [case for case in stability if case["lesson"] == r["lesson"]]}


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
