"""A small report for tests: results of a few scenes and stability cases as they are stored."""

import json

from validate import measure
from validate.measure.selection import Plan
from validate.run.run import about
from validate.stability.examine import all_cases, examine, stored


def small_report(scenes, slugs):
    """Return the content of a report.json of these scenes and of the cases with these slugs, in plain Python."""
    plan, results = Plan(speeds=("plain",)), []
    for name in scenes:
        errors = measure.errors(name, plan)
        results.append({**errors, "times": measure.times(name, plan, errors)})
    cases = [stored(examine(case, compiled=False)) for case in all_cases() if case.slug in slugs]
    return json.loads(json.dumps({"run": about(plan, shown=tuple(scenes)), "scenes": results, "stability": cases}))
