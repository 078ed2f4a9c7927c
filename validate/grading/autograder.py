"""Grading on other sites: Gradescope's zip and the program in it, and a workflow for GitHub Classroom."""

import json
import os
import sys
import tempfile
import traceback
import zipfile
from datetime import datetime
from math import ceil
from pathlib import Path
from typing import Annotated

import typer

from solutions.checks import BadInput
from validate.run.command import start
from validate.run.store import writable, write_text, write_whole
from validate.subject.modules import ROOT

from . import children, choice, local, marking, pages, points, sandbox, submissions
from .__main__ import Exercises
from .release import tracked

app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)
Lessons = Annotated[list[str] | None, typer.Option(help="Only this lesson (may be repeated); all of them without.")]
Dirty = Annotated[bool, typer.Option("--dirty", help="Take tracked files as they lie there, committed or not.")]
Seed = Annotated[str, typer.Option(help="Secret from which hidden inputs are drawn.")]
Archive = Annotated[Path, typer.Option(help="The zip to write.")]
Late = Annotated[
    float,
    typer.Option(
        min=0.0,
        max=100.0,
        help="Percent of the maximum taken off for each day begun after Gradescope's due date.",
    ),
]
Workflow = Annotated[Path, typer.Option(help="The workflow to write, in the repository that students copy.")]


# ---------------------------------------------------------------------------------------------- Gradescope

WHEN = (1980, 1, 1, 0, 0, 0)                      # of every entry: the same commit and seed give the same bytes
SETUP = """#!/usr/bin/env bash
# Gradescope runs this once, as root, when it builds the image of the assignment.
# /autograder/source is this zip, unpacked.
# The sandbox is bubblewrap where the container allows it (Ubuntu 24.04 or newer), and an empty root elsewhere.
set -euo pipefail
source=${AUTOGRADER:-/autograder}/source
export DEBIAN_FRONTEND=noninteractive
apt-get update
apt-get install -y bubblewrap libseccomp2
# not every Ubuntu has 3.11
apt-get install -y python3.11 python3.11-venv || apt-get install -y python3 python3-venv
python=$(command -v python3.11 || command -v python3)
if ! "$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))'; then
    echo "Python 3.11 or newer is needed: choose a newer Ubuntu" >&2
    exit 1
fi
"$python" -m venv "$source/venv"
"$source/venv/bin/pip" install -q -c "$source/workbook/constraints.txt" -e "$source/workbook[student]"
"""
RUN = """#!/usr/bin/env bash
# Gradescope runs this for every submission, and shows results/results.json.
root=${AUTOGRADER:-/autograder}
results=$root/results/results.json
mkdir -p "$root/results"
rm -f "$results"
cd "$root/source/workbook" && "$root/source/venv/bin/python" -m validate.grading.autograder run \\
    "$root/submission" "$results" --course "$root/source/course.json" --metadata "$root/submission_metadata.json"
code=$?
if [ ! -s "$results" ]; then      # no score: Gradescope then says that the autograder failed
    echo '{"output": "The grader itself did not run, so there is no score. Please tell your instructor."}' > "$results"
fi
exit $code
"""


@app.command(help="Write the zip that Gradescope asks for; the seed is in it, so keep it secret.")
def gradescope(
    seed: Seed, out: Archive = Path("autograder.zip"), lesson: Lessons = None, exercises: Exercises = None,
    late: Late = 0.0, dirty: Dirty = False,
):
    if not seed.strip():
        raise BadInput("--seed", "empty", "give a secret")
    if out.is_dir():                                   # the check of the worked answers takes long: say this before
        raise BadInput(f"--out {str(out)!r}", "not writable (it is a folder)", "name another file")
    lessons, worth = choice.chosen(lesson or [], exercises)
    local.check_seed(marking.settings(lessons, seed, worth))
    course = json.dumps({"lessons": lessons, "exercises": worth, "seed": seed, "late": late}, indent=1)
    files = {
        "setup.sh": (SETUP.encode(), 0o755),
        "run_autograder": (RUN.encode(), 0o755),
        "course.json": (course.encode(), 0o600),
    }
    files |= {f"workbook/{path}": ((ROOT / path).read_bytes(), 0o644) for path in tracked(dirty)}
    write_zip(out, files)
    print(f"{out}: {len(files)} files, lessons {', '.join(lessons)}")


def write_zip(out, files):
    """Write {path: (bytes, mode)} completely or not at all, readable by the owner only."""
    folder = writable(out.absolute().parent)
    with tempfile.NamedTemporaryFile(dir=folder, suffix=".part", delete=False) as draft:
        try:
            with zipfile.ZipFile(draft, "w", zipfile.ZIP_DEFLATED) as archive:
                for path, (data, mode) in sorted(files.items()):
                    entry = zipfile.ZipInfo(path, WHEN)
                    entry.create_system, entry.external_attr = 3, (0o100000 | mode) << 16
                    entry.compress_type = zipfile.ZIP_DEFLATED
                    archive.writestr(entry, data)
            draft.close()
            os.replace(draft.name, out)
        except BaseException as e:
            Path(draft.name).unlink(missing_ok=True)
            if not isinstance(e, OSError):
                raise
            raise BadInput(f"--out {str(out)!r}", f"not writable ({e.strerror})", "name another file") from None


@app.command(help="Grade one submission inside Gradescope; run_autograder in the zip calls this.")
def run(
    submission: Annotated[Path, typer.Argument(help="Folder of the files handed in.")],
    results: Annotated[Path, typer.Argument(help="results.json to write.")],
    course: Annotated[Path, typer.Option(help="Lessons, seed and late penalty.")],
    metadata: Annotated[Path | None, typer.Option(help="Gradescope's submission_metadata.json.")] = None,
):
    if sandbox.unavailable():
        why = f"There is no sandbox here ({sandbox.unavailable()}), so nothing was run and there is no score."
        write_whole(results, {"output": f"{why} Please tell your instructor."})
        raise typer.Exit(2)
    try:
        sandbox.keep_out({submission: "submission", results.absolute().parent: "folder of results", course: "course"})
        found = graded(submission, json.loads(course.read_text()), told(metadata))
    except submissions.Ungraded as e:
        found = {"output": f"Not graded: {e}."}
    except Exception as e:                        # Gradescope reports a missing score as a failure of the autograder
        if isinstance(e, (BadInput, OSError)):
            print(f"autograder: {e}", file=sys.stderr)
        else:
            traceback.print_exc()                 # for instructors only: it may name hidden inputs
        why = f"The grader itself failed ({type(e).__name__}), so there is no score."
        found = {"output": f"{why} Please tell your instructor."}
    write_whole(results, found)
    raise typer.Exit(0 if "score" in found else 1)


def graded(folder, course, metadata):
    """Grade one submission: Gradescope's results.json as a dict.  Gradescope's dates override those of the files."""
    settings = marking.settings(tuple(course["lessons"]), course["seed"], course.get("exercises"))
    users, assignment = metadata.get("users") or [{}], metadata.get("assignment") or {}
    with children.reader() as child:
        submission = submissions.read(folder, users[0].get("email") or "submission", settings.lessons, child)
    if when := moment(metadata.get("created_at")):
        submission = submission._replace(timestamp=when)
    extended = (users[0].get("assignment") or {}).get("due_date")      # the student's own due date
    due = moment(extended or assignment.get("due_date"))
    result = marking.mark(submission, settings)
    if result["again"]:
        result = marking.again(submission, settings, result)
    return pages.gradescope(result, settings, pages.Terms(due, course["late"]))


def told(metadata):
    return json.loads(metadata.read_text()) if metadata and metadata.is_file() else {}


def moment(text):
    """Return an ISO 8601 time without fractions of a second; "" for none."""
    return datetime.fromisoformat(text).isoformat(timespec="seconds") if text else ""


# ---------------------------------------------------------------------------------------------- GitHub Classroom

HEAD = """# Written by `autograder classroom`.  The names of workflow and job are those that GitHub Classroom looks for.
# The tests run with their public inputs, in the student's own repository.
# For grades that matter, collect the files and run `grade`.
"""
JOB = """name: Autograding Tests
"on": [push, workflow_dispatch]
permissions:
  checks: write
  actions: read
  contents: read
jobs:
  run-autograding-tests:
    runs-on: ubuntu-latest
    if: github.actor != 'github-classroom[bot]'
    steps:
      - uses: actions/checkout@v6
      - uses: actions/setup-python@v6
        with:
          python-version: "3.11"
      - name: Install the workbook
        run: python3 -m venv .venv && .venv/bin/pip install -q -c constraints.txt -e ".[student]"
"""
STEP = """      - name: {name}
        id: {id}
        uses: classroom-resources/autograding-command-grader@v1
        with:
          test-name: {name}
          command: .venv/bin/pytest tests/lessons/test_{lesson}.py --of=lessons --exercise={exercise}
          timeout: {minutes}
          max-score: {points}
"""
TAIL = """      - name: Autograding Reporter
        uses: classroom-resources/autograding-grading-reporter@v1
        env:
{results}
        with:
          runners: {runners}
"""


@app.command(help="Write a workflow for GitHub Classroom with one step per exercise: all of its points, or none.")
def classroom(out: Workflow = Path(".github/workflows/grade.yml"), lesson: Lessons = None,
              exercises: Exercises = None):
    lessons, worth = choice.chosen(lesson or [], exercises)
    writable(out.absolute().parent)
    write_text(out, workflow(marking.manifest(tuple(lessons), worth)))
    print(out)


def workflow(manifest):
    """Return the text of the workflow for a manifest.  Raises BadInput for points that are not in quarters.

    GitHub counts whole points only.  If an exercise has half a point, all points are doubled, and the workflow says so.
    The workbook is installed by a step of its own, not by setup-command: if that fails, the job ends without a zero.
    timeout [min] is that of all tests of an exercise, plus one for pytest to start.
    *Source:* the README of classroom-resources/autograding-command-grader and of autograding-grading-reporter, v1.
    """
    steps = {}
    for lesson, exercise, function, _, worth, _ in manifest:
        tests, total = steps.get((lesson, exercise, function), (0, 0.0))
        steps[lesson, exercise, function] = tests + 1, total + worth
    scale = whole_scale([total for _, total in steps.values()])
    note = f"# GitHub counts whole points: these are {scale} times the workbook's.\n" if scale > 1 else ""
    text, ids = HEAD + note + JOB, []
    for (lesson, exercise, function), (tests, total) in steps.items():
        ids.append(f"exercise-{exercise.replace('.', '-')}")
        text += STEP.format(
            name=f"Exercise {exercise} {function}",
            id=ids[-1],
            lesson=lesson,
            exercise=exercise,
            minutes=1 + ceil(tests * points.LIMIT / 60.0),
            points=int(scale * total),
        )
    env = "\n".join(f"          {name.upper()}_RESULTS: ${{{{ steps.{name}.outputs.result }}}}" for name in ids)
    return text + TAIL.format(results=env, runners=",".join(ids))


def whole_scale(totals):
    """Return the smallest of 1, 2 and 4 that makes all points whole."""
    for scale in (1, 2, 4):
        if all(scale * total == int(scale * total) for total in totals):
            return scale
    raise BadInput("points", "not in quarters", "GitHub Classroom counts whole points only: share them out differently")


def main(arguments=None):
    """Run the command line; bad input ends with one sentence and exit code 2."""
    start("autograder", app, arguments)


if __name__ == "__main__":
    main()
