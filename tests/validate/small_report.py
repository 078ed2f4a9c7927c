"""A small report for tests: results of a few scenes and stability cases as they are stored."""

import functools
import json

from validate import measure
from validate.measure.selection import Plan
from validate.run.run import about
from validate.stability.examine import all_cases, examine, stored

PLAN = Plan(speeds=("plain",))


@functools.cache
def measured(name):
    """Return the result of a scene, which all tests of a process share."""
    errors = measure.errors(name, PLAN)
    return {**errors, "times": measure.times(name, PLAN, errors)}


def small_report(scenes, slugs):
    """Return the content of a report.json of these scenes and of the cases with these slugs, in plain Python."""
    cases = [stored(examine(case, compiled=False)) for case in all_cases() if case.slug in slugs]
    data = {"run": about(PLAN, shown=tuple(scenes)), "scenes": [*map(measured, scenes)], "stability": cases}
    return json.loads(json.dumps(data))
