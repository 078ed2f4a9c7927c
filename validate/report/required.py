"""What a report must contain: every scene with its cases, and every finding with the law and the tolerance of theory.

`python -m validate.report.required [LESSON …]` derives the list from the code and writes it.  The list is a file of the
repository, so that the list of an earlier commit can judge a report of that commit.
"""

import json
import subprocess
from pathlib import Path
from typing import Annotated

import typer

from ..run.command import start
from ..run.store import read_whole, write_text
from ..stability.examine import all_cases, examine, stored
from ..subject import modules

FILE = Path(__file__).with_name("required.json")
NEAR = 1e-9                  # allowed relative difference of a tolerance between two machines [-]
SHARE = 0.1                  # allowed difference of a law between two machines, over its tolerance [-]


def derived(stability, kept=None):
    """Return {"scenes", "slow", "findings"} of today's code; slow: the stability cases that a quick run leaves out.

    stability: cases after their run, as a report stores them;    kept: {place: laws} of all that were not run again
    """
    scenes = {name: modules.bind_scene(name) for name in modules.scene_names()}
    return {"scenes": {name: {"lesson": scene.lesson, "cases": list(scene.cases), "slow": list(scene.slow_cases)}
                       for name, scene in scenes.items()},
            "slow": sorted(place(case._asdict()) for case in all_cases() if not case.in_quick),
            "findings": {**(kept or {}), **{place(case): laws(case["findings"]) for case in stability}}}


def place(case):
    """Return the name of a stability case in the list."""
    return f"{case['lesson']}/{case['slug']}"


def laws(findings):
    """Return {quantity: [law, tolerance]} of stored findings."""
    return {f["quantity"]: [f["predicted"], f["tolerance"]] for f in findings}


def write(stability, kept=None):
    """Write the list of today's code, with a line for each scene and each finding, so that two changes of it merge."""
    parts = derived(stability, kept)
    cases = ",\n".join(f"{json.dumps(name)}: {{\n" + ",\n".join(lines(found)) + "\n}"
                       for name, found in sorted(parts["findings"].items()))
    scenes = ",\n".join(lines(parts["scenes"]))
    slow = json.dumps(parts["slow"])
    write_text(FILE, f'{{"scenes": {{\n{scenes}\n}}, "slow": {slow}, "findings": {{\n{cases}\n}}}}\n')


def lines(entries):
    """Return one line of JSON for each entry of a dict."""
    return [f"{json.dumps(key, ensure_ascii=False)}: {json.dumps(value, ensure_ascii=False)}"
            for key, value in entries.items()]


def kept(run, same_code):
    """Return the list for a report with this record of its run; None where the repository has none.

    same_code: the report was made by today's code; else the list of its commit is taken.
    """
    if same_code:
        return read_whole(FILE, dict, "write it: python -m validate.report.required") if FILE.is_file() else None
    commit = (run.get("commit") or "").partition(",")[0]
    name = FILE.relative_to(modules.ROOT).as_posix()
    try:
        done = subprocess.run(["git", "show", f"{commit}:{name}"], cwd=modules.ROOT, capture_output=True, text=True,
                              timeout=10)
        return json.loads(done.stdout) if commit and done.returncode == 0 else None
    except (OSError, subprocess.SubprocessError, ValueError):
        return None


def missing(data, must):
    """Yield what a report lacks of the list, and where it states another law or tolerance than the list."""
    run = data["run"]
    there = {result["scene"]: result for result in data["scenes"]}
    asked = run.get("chosen") or list(must["scenes"])
    for name in asked:
        if name not in there:
            yield f"{name}: the scene is missing"
        elif name in must["scenes"] and not run.get("overrides"):
            slow = must["scenes"][name]["slow"] if run["mode"] == "quick" else ()
            for case in must["scenes"][name]["cases"]:
                if case not in there[name]["cases"] and case not in slow:
                    yield f"{name}: the case {case!r} is missing"
    if run["of"] == "solutions":                         # other answers may leave exercises out, and then their cases
        lessons = {must["scenes"][name]["lesson"] for name in asked if name in must["scenes"]}
        left = must.get("slow", ()) if run["mode"] == "quick" else ()         # a list of before has none
        yield from missing_findings(data["stability"], {name: found for name, found in must["findings"].items()
                                                        if name.partition("/")[0] in lessons and name not in left})


def missing_findings(stability, must):
    """Yield the cases and findings that are missing, and those with another law or tolerance."""
    there = {place(case): case for case in stability}
    for name, wanted in must.items():
        if name not in there:
            yield f"{name}: the stability case is missing"
            continue
        found, not_run = laws(there[name]["findings"]), {one["quantity"] for one in there[name]["not_run"]}
        for quantity, theory in wanted.items():
            if quantity not in found and quantity not in not_run:
                yield f"{name}: the finding {quantity!r} is missing"
            elif quantity in found and not same(found[quantity], theory):
                yield (f"{name}: {quantity!r} has the law and the tolerance {found[quantity]}, but the code gives "
                       f"{theory}")


def same(found, theory):
    """Return whether a law and its tolerance differ from those of theory by round-off at most.

    None is a number that is not finite.
    """
    if None in (*found, *theory):
        return found == theory
    (law, tolerance), (law_there, tolerance_there) = found, theory
    return (abs(law - law_there) <= SHARE * tolerance_there
            and abs(tolerance - tolerance_there) <= NEAR * tolerance_there)


def main(lesson: Annotated[list[str] | None, typer.Argument(help="Such as springs.")] = None):
    """Run the stability cases of these lessons, or of all, and write the list."""
    lessons = lesson or modules.lesson_names()
    for name in lessons:
        modules.bind(name)               # raises BadInput for a name that is no lesson
    names = {place(case._asdict()) for case in all_cases()}
    old = read_whole(FILE, dict, "write it for all lessons")["findings"] if FILE.is_file() else {}
    kept = {name: found for name, found in old.items() if name in names and name.partition("/")[0] not in lessons}
    write([stored(examine(case)) for case in all_cases() if case.lesson in lessons], kept)


if __name__ == "__main__":
    start("python -m validate.report.required", main)
