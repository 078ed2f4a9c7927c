"""Runs of stability cases with the lessons of a subject."""

from importlib import import_module
from pathlib import Path

import numpy as np

from ..check import jsonable
from ..subject import modules
from .case import CASES, Checks, Examined


def cases_of(lesson):
    """Return {slug: Case} of a lesson, in the order of its files; empty for a lesson without cases.

    Cases of its exercises are in stability/, those of its given functions in stability/given/.
    """
    for name in (lesson, f"given.{lesson}"):
        if Path(__file__).parent.joinpath(f"{name.replace('.', '/')}.py").is_file():
            import_module(f".{name}", __package__)
    return CASES.get(lesson, {})


def all_cases():
    """Return every case, in the order of the course."""
    return [case for lesson in modules.lesson_names() for case in cases_of(lesson).values()]


def subject_of(case, of="solutions", compiled=True):
    """Return the lesson of a subject that a case examines, compiled if the case says so."""
    return modules.module_set(of, compiled and case.compiled and modules.can_compile()).lesson(case.lesson)


def examine(case, of="solutions", compiled=True):
    """Return the findings and the picture of one case."""
    with np.errstate(all="ignore"):              # overflow is what an unstable run does
        found, picture = found_by(case, subject_of(case, of, compiled))
        return Examined(case.slug, case.title, case.lesson, found, picture, found.not_run)


def found_by(case, lesson):
    """Return the findings and the picture of a case with a lesson."""
    check = Checks()
    picture = case.examine(lesson, check)
    return check, picture


def left_to_full(lesson, plan):
    """Return the cases of a lesson that this plan leaves to --full."""
    return [case for case in cases_of(lesson).values() if plan.quick and not case.in_quick]


def stability_cases(lesson, plan):
    """Return every case of a lesson whose exercises have been attempted, as data, but those left to --full."""
    found, left = [], left_to_full(lesson, plan)
    for case in cases_of(lesson).values():
        if case in left:
            continue
        try:
            found.append(examine(case, plan.of, "compiled" in plan.speeds))
        except NotImplementedError:
            pass
        except (Exception, SystemExit) as e:                         # a subject's code may do anything
            found.append(broken_off(case, e))
    return [stored(one) for one in found]


def broken_off(case, error):
    """Return a case that ended in an error of the subject's code: a finding that does not hold."""
    words = f"{type(error).__name__}: {(str(error).splitlines() or [''])[0]}"
    check = Checks()
    check(f"The case runs without an error; here it ended in {words}.", "cases without an error [of 1]",
          law=1, found=0, within=0.0, saw=words)
    return Examined(case.slug, case.title, case.lesson, check, None, [])


def stored(examined):
    """Return an examined case as data that JSON can hold."""
    findings = [{**f._asdict(), "holds": f.holds} for f in examined.findings]
    picture = examined.picture._asdict() if examined.picture else None
    return jsonable({**examined._asdict(), "findings": findings, "picture": picture,
                     "not_run": [one._asdict() for one in examined.not_run]})
