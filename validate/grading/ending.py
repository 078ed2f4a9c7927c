"""The summary in the terminal at the end of a run: graded, missing and unlisted students, with reasons."""

from .texts import line

MOST_TOLD = 20               # students or sentences on the screen [-]; the page of the class has them all
BY_FILES = ("Late days follow the dates of the files, which students can set: a column timestamp in the class list "
            "replaces them")


def sentences(intake, graded, failed, people, terms):
    """Return the lines.  graded: results, as marking.mark returns them · failed: {student: why there are no points}."""
    read = [result for result in graded if result["handed_in"]]
    unread = {result["student"]: reason(result) for result in graded if not result["handed_in"]}
    students = {result["student"] for result in graded} | {*failed}
    told = [f"{len(read)} handed in and graded"]
    if people:
        absent, strangers = {*people} - students, students - {*people}
        told += [f"{len(absent)} on the class list and nothing handed in{names(absent)}",
                 f"{len(strangers)} handed in and not on the class list{names(strangers)}"]
    told.append(f"{len(unread)} could not be read{':' if unread else ''}")
    told += first(f"  {line(student)}: {line(why)}" for student, why in sorted(unread.items()))
    told += first(f"{line(one.student)}: {line(problem)}"
                  for one in intake.submissions if one.files for problem in one.problems)
    told += first(map(line, intake.overlooked))
    told += unsolved(read)
    late = terms.late and (terms.due or any(person.due for person in people.values()))
    return told + [BY_FILES] * bool(late and intake.dated_by_files and not terms.listed)


def unsolved(results):
    """Return a sentence on lessons in which nothing is earned, while others have points: they may not have been set."""
    earned = {}
    for result in results:
        for test in result["tests"]:
            earned[test["lesson"]] = earned.get(test["lesson"], 0) + test["earned"]
    idle = [lesson for lesson, points in earned.items() if not points]
    if not idle or len(idle) == len(earned):
        return []
    return [f"No submission earns a point in {', '.join(idle)}. They count all the same. If you did not set them, name "
            "those that you did with --lesson"]


def names(students):
    """Return a colon and the names of students, or nothing where there are none."""
    shown = [*map(line, sorted(students)[:MOST_TOLD])]
    more = [f"{len(students) - MOST_TOLD} more"] if len(students) > MOST_TOLD else []
    return f": {', '.join(shown + more)}" if shown else ""


def reason(result):
    return " | ".join(result["problems"]) or "no lesson file is in it"


def first(told):
    """Return the first sentences, and how many more there are."""
    told = [*told]
    more = [f"… and {len(told) - MOST_TOLD} more, which are on the page of the class"] if len(told) > MOST_TOLD else []
    return told[:MOST_TOLD] + more
