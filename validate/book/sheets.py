"""One sheet per lesson for instructors: hours, needs, exercises, demonstrations, and the commands."""

import html
import re

from ..stability.examine import all_cases
from ..subject import modules
from . import course, plan, weeks


def page(name, report):
    """Return the sheet of one lesson, in Markdown."""
    lesson = course.lessons()[name]
    head, later = lesson.head, [one.number for one in course.lessons().values() if lesson.number in one.head.numbers]
    facts = plan.table(("fact", "value"), [
        ("hours", f"{head.whole:g}: {head.reading:g} to read and run, {head.writing:g} to write"),
        ("exercises, points", f"{len(lesson.exercises)} ({plan.stars(lesson.exercises)}), {lesson.points:g}"),
        ("mathematics and physics", head.mathematics),
        ("lessons before", head.before),
        ("exercises of other lessons that it calls", ", ".join(foreign(lesson)) or "none"),
        ("lessons that build on it", ", ".join(map(str, later)) or "none"),
        ("students hand in", f"`lessons/{name}.py`"),
        ("worked answers, in the repository", path(f"solutions/{name}.py")),
        ("wrong answers that must fail, in the repository", path(f"tests/mutants/{name}.py")),
        ("grading tests", path(f"tests/lessons/test_{name}.py")),
    ])
    return "\n\n".join([
        f"# {lesson.number} · {name}: lesson sheet", f"{lesson.title}. The [notebook](../notebooks/"
        f"{course.notebook_of(name).stem}) and the [functions](../lessons/{name}). How the hours are estimated: "
        "[Plan a course](../plan). Where the repository is, and how to set it up: [Set up a course](../instructors).",
        "## The lesson", facts, "## A week with it" if len(weeks.WEEKS[name]) == 1 else "## Two weeks with it",
        "In the week before, make the zip (*Commands*, below) and try it once yourself: unpack it, set it up, run the "
        f"first check. The hours below are those to write; the notebook takes {head.reading:g} "
        f"{'hour' if head.reading == 1.0 else 'hours'} more.", weeks.table(name, report),
        "## Exercises", "★: the docstring gives the formula. ★★: students find it; the notebook has a folded hint. "
        "★★★: many answers are right, and a test judges them. *Minutes* are an estimate. *Calls* and *called by* name "
        "exercises. In their own copy, students cannot pass an exercise that calls one which they have left out.",
        exercise_table(lesson),
        "## Where students go wrong", "A check that fails gives these hints. Each one answers a mistake that a test "
        "of the workbook catches.", hints(lesson),
        "## What to show", "Every scene below has a film or a picture, its truth, and the engines that it is built in.",
        scenes(lesson, report),
        "Stability cases: what theory gives, compared with what the methods do.", cases(name, report),
        "## Questions to discuss", questions(name),
        "## Commands", commands(lesson)]) + "\n"


def foreign(lesson):
    """Return numbers of the exercises of other lessons that exercises of this lesson call themselves."""
    found = {number for one in lesson.exercises for number in one.uses}
    return sorted(found - {one.number for one in lesson.exercises}, key=course.in_order)


def exercise_table(lesson):
    rows = []
    for one in lesson.exercises:
        users = course.used_by().get(one.number, ())
        rows.append((one.number, f"{{py:func}}`~lessons.{one.lesson}.{one.function}`", one.stars, f"{one.points:g}",
                     f"{one.minutes:.0f}", ", ".join(one.uses) or "–", ", ".join(users) or "–"))
    return plan.table(("exercise", "function", "stars", "points", "minutes", "calls", "called by"), rows)


def hints(lesson):
    """Return the hints of all grading tests, folded, because some of them are half an answer."""
    rows = "\n".join(f"<li><b>{one.number}</b> {html.escape(hint)}</li>"
                     for one in lesson.exercises for hint in one.hints)
    return f"```{{raw}} html\n<details><summary>Show the hints</summary>\n<ul>\n{rows}\n</ul></details>\n```"


def plain(text):
    """Return text without markup, for Markdown."""
    return re.sub(r"([\\*_`|\[\]<>$#])", r"\\\1", text)


def scenes(lesson, report):
    rows = []
    for name in lesson.scenes:
        scene = modules.bind_scene(name)
        title = course.link_into(report, f"{name}.html", scene.title) or scene.title
        story = plain(" ".join(scene.story.split("\n\n")[0].split()))
        rows.append((title, story, f"`.venv/bin/validate --scene {name}`"))
    return plan.table(("scene", "what it is", "command"), rows)


def cases(name, report):
    found = [case for case in all_cases() if case.lesson == name]
    return "\n".join("- " + (course.link_into(report, f"stability.html#{name}-{case.slug}", html.escape(case.title))
                             or plain(case.title)) for case in found)


def path(file):
    """Return a file of the repository, with a link if the repository's address is known."""
    address = plan.repository()
    return f"[`{file}`]({address}/blob/HEAD/{file})" if address else f"`{file}`"


def questions(name):
    """Return the questions at the end of a notebook, with their folded answers."""
    from . import execute
    book = execute.nbformat.read(course.notebook_of(name), as_version=4)
    text = next((cell.source for cell in book.cells if cell.source.startswith("## Three questions")), "")
    return text.partition("\n")[2].strip()


def commands(lesson):
    before = [name for name, one in course.lessons().items() if one.number < lesson.number]
    said = "Make the students' zip when this lesson begins."
    if before:
        said += (" It holds the earlier lessons as worked answers, so that no gap in them holds a student up. **So it "
                 f"publishes the answers of {before[-1]}**: if you accept that lesson late, hand the zip out when its "
                 "late days are over. If your course leaves lessons out, take the command from [Plan a course](../plan)"
                 ".")
    return (f"{said}\n\n```sh\n{plan.release(lesson.name, before)}\n```\n\nGrade what comes back. The folder `class` "
            "has one folder or zip per student, and the class list `list.csv`. `--late 10` takes ten per cent for each "
            f"day begun after `--due`. If you have set a part of the lesson only, add for example "
            f"`--exercises {plan.span(lesson.exercises[:5])}`.\n\n```sh\n{plan.grade(lesson.name)}\n```\n\n"
            "[Grading a class](../grading) explains both.")
