"""Write the report: one folder of static pages that need no network, and the same content as JSON."""

import json
import shutil
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

from jinja2 import Environment, PackageLoader, select_autoescape

from ..binding import bind_scene
from . import plots, space, words

HERE = Path(__file__).parent


def write(out, results, stability, plan, jobs, bars):
    """Pages, pictures and report.json in a folder; the path of the front page."""
    pages = Environment(loader=PackageLoader("validate", "report"), autoescape=select_autoescape(), trim_blocks=True, lstrip_blocks=True)
    pages.filters.update(seconds=words.seconds, number=words.number, percent=words.percent, factor=words.factor, order=words.order)
    pages.tests["reaches"] = lambda row: any(t is not None for t in row.values())
    pages.globals.update(run=words.run(plan), playable=plots.playable, verdict=words.verdict, judge=words.judge, arrow_colours=space.ARROWS)

    refined = [r for r in results if r["still"] != ""]
    pictures = [(plots.convergence, out / f"{r['scene']}-steps.svg", r) for r in refined]
    pictures += [(plots.work_precision, out / f"{r['scene']}-times.svg", r) for r in refined]
    pictures += [(plots.stability, out / f"stability-{case['number']}.svg", case) for case in stability]
    bar = bars.add_task("report", total=len(pictures) + 1)
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn"), initializer=plots.style) as pool:
        for _ in pool.map(plots.draw, *zip(*pictures)):
            bars.advance(bar)

    for result in results:
        page = pages.get_template("scene.html").render(r=result, parameters=words.parameters(bind_scene(result["scene"])),
                                                       findings=words.findings(result), others=results,
                                                       cases=[c for c in stability if c["lesson"] == result["lesson"]])
        (out / f"{result['scene']}.html").write_text(page)
    (out / "stability.html").write_text(pages.get_template("stability.html").render(cases=stability))
    front = out / "index.html"
    front.write_text(pages.get_template("front.html").render(rows=[words.row(r) for r in results], cases=stability, results=results))
    (out / "report.json").write_text(json.dumps({"run": words.run(plan), "scenes": results, "stability": stability}, ensure_ascii=False, indent=1))
    for name in ("style.css", "player.js", *(["player3d.js"] if any(r["picture"]["space"] for r in results) else [])):
        shutil.copyfile(HERE / name, out / name)
    bars.advance(bar)
    return front
