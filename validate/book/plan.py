"""Courses of 4, 8 and 16 weeks, and the tables of the page *Plan a course*."""

import re
import subprocess
from typing import NamedTuple

from ..subject.modules import ROOT
from . import course

WIDTH = 84                   # of the code on a page of the book [characters]


class Week(NamedTuple):
    """One week of a course."""
    lesson: str              # or "" for a week of another kind
    first: int = 1           # exercises of the lesson that are set: from this one
    last: int = 0            # to this one; 0 means to the end
    leave_out: tuple = ()    # but without these
    note: str = ""

    def exercises(self):
        """Return the exercises that are set."""
        if not self.lesson:
            return ()
        of_lesson = course.lessons()[self.lesson].exercises
        chosen = of_lesson[self.first - 1:self.last or len(of_lesson)]
        return tuple(one for one in chosen if course.in_order(one.number)[1] not in self.leave_out)

    def hours(self):
        """Return hours of a student."""
        return course.lessons()[self.lesson].hours(self.exercises()) if self.lesson else 0.0


class Course(NamedTuple):
    """Weeks, and the lessons that students get as worked answers because the course leaves them out."""
    title: str
    aim: str
    weeks: tuple[Week, ...]
    worked: tuple = ()

    def lessons(self):
        """Return the lessons of the course, each once."""
        return tuple(dict.fromkeys(week.lesson for week in self.weeks if week.lesson))

    def zips(self):
        """Return {week in which a lesson begins: lessons that the students' zip of that week holds as worked answers}.

        Those are the lessons before it, and what it needs of the lessons that the course leaves out.
        """
        found, before = {}, []
        for number, week in enumerate(self.weeks, 1):
            if week.lesson and week.lesson not in before:
                needed = course.lessons()[week.lesson].needs - set(before)
                before += [name for name in self.worked if name in needed]
                found[number] = tuple(sorted(before, key=list(course.lessons()).index))
                before.append(week.lesson)
        return found


COURSES = (
    Course(
        "Four weeks: particles", "A unit of another course, such as numerical methods or computer graphics.",
        (Week("integrators"), Week("springs", last=10, note="without the implicit step of a stiff mesh"),
         Week("pbd", last=7, note="the projection method and PBD"),
         Week("pbd", first=8, leave_out=(15, 16, 17), note="cloth, obstacles, compliance, a soft ball")),
        worked=("friction", "rotation")),
    Course(
        "Eight weeks: rigid bodies", "From Euler's method to a body that collides, with friction.",
        (Week("integrators"), Week("springs", last=10), Week("friction", last=11, note="without curved surfaces"),
         Week("inertia_tensors", leave_out=(15, 16, 17), note="without triangle meshes"),
         Week("rotation"), Week("collisions", last=10), Week("impulses"),
         Week("contact", last=11, note="exactly, on small scenes")),),
    Course(
        "Sixteen weeks: everything", "A course of one term that ends with a simulator and a scene of one's own.",
        (Week("integrators"), Week("springs"), Week("friction"), Week("inertia_tensors"), Week("rotation"),
         Week("collisions", last=8), Week("collisions", first=9), Week("impulses"),
         Week("pbd", last=11), Week("pbd", first=12),
         Week("contact", last=11), Week("contact", first=12, note="piles, and other solvers"), Week("simulator"),
         Week("", note="a scene of one's own with the simulator: three kinds of parts, contact and friction, judged by "
                       "the invariants of lesson 10"),
         Week("kinematics"), Week("sensitivities"))),
)


# ---------------------------------------------------------------------------------------------- tables

def table(head, rows):
    """Return a table in Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines)


def half(number):
    """Return hours, rounded to the half."""
    return max(0.5, round(2.0 * number) / 2.0) if number else 0.0


def lesson_link(name):
    lesson = course.lessons()[name]
    return f"[{lesson.number} · {name}](notebooks/{course.notebook_of(name).stem}) ([sheet](sheets/{name}))"


def numbers_of(names):
    """Return names of lessons as their numbers, in order."""
    return ", ".join(str(number) for number in sorted(course.lessons()[name].number for name in names)) or "–"


def lesson_table():
    """Return every lesson with its size, its hours and what it needs."""
    rows = [(lesson_link(name), stars(lesson.exercises), f"{lesson.points:g}",
             f"{lesson.head.whole:g}: {lesson.head.reading:g} + {lesson.head.writing:g}",
             ", ".join(map(str, sorted(lesson.head.numbers))) or "–", numbers_of(lesson.needs), len(lesson.scenes),
             lesson.cases)
            for name, lesson in course.lessons().items()]
    return table(("lesson", "exercises", "points", "hours: to read + to write", "builds on lessons",
                  "loads files of", "scenes", "stability cases"), rows)


def stars(chosen):
    """Return how many exercises there are of each kind: "13 ★, 4 ★★"."""
    counts = [(kind, sum(one.stars == kind for one in chosen)) for kind in ("★", "★★", "★★★")]
    return ", ".join(f"{count}\N{NO-BREAK SPACE}{kind}" for kind, count in counts if count)


def span(chosen):
    """Return numbers of exercises, neighbours joined: "5.1–5.7, 5.9"."""
    runs = []
    for one in chosen:
        number = course.in_order(one.number)[1]
        if runs and number == runs[-1][-1] + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    lesson = chosen[0].number.partition(".")[0]
    return ", ".join(f"{lesson}.{run[0]}" + (f"–{lesson}.{run[-1]}" if run[1:] else "") for run in runs)


def course_table(plan):
    """Return the weeks of a course."""
    rows = []
    for number, week in enumerate(plan.weeks, 1):
        chosen = week.exercises()
        if chosen:
            points = sum(one.points for one in chosen)
            hours = f"{half(week.hours()):g}"
            rows.append((number, lesson_link(week.lesson), span(chosen), f"{points:g}", hours, week.note))
        else:
            rows.append((number, "", "", "", "", week.note))
    return table(("week", "lesson", "exercises", "points", "hours", "remark"), rows)


def release(name, worked):
    """Return the command that makes a students' zip with these lessons as worked answers."""
    return in_sight(f".venv/bin/release --out {name}.zip", f"--with-solutions={','.join(worked)}" if worked else "")


def grade(name):
    """Return the command that grades a lesson."""
    return in_sight(f".venv/bin/grade class --out grades-{name} --lesson {name}",
                    "--roster class/list.csv --due 2026-11-30T23:59 --late 10")


def in_sight(command, options):
    """Return a command with its options, on a second line if they would run out of the page."""
    line = f"{command} {options}".strip()
    return line if len(line) <= WIDTH else f"{command} \\\n    {options}"


def course_section(plan):
    """Return a course as the page shows it."""
    total = sum(half(week.hours()) for week in plan.weeks)
    zips = "\n".join(release(plan.weeks[number - 1].lesson, worked) for number, worked in plan.zips().items())
    why = (f" Students get lessons {numbers_of(plan.worked).replace(', ', ' and ')} as worked answers, because lessons "
           "of this course load their files." if plan.worked else "")
    return (f"### {plan.title}\n\n{plan.aim} About {total:g} hours of a student's work.{why}\n\n"
            f"{course_table(plan)}\n\nThe students' zips, one for each lesson, in the order of the weeks:\n\n"
            f"```sh\n{zips}\n```")


def free_exercises():
    """Return, for each lesson, the exercises that no other exercise calls: a course may omit them."""
    rows = []
    for name, lesson in course.lessons().items():
        free = [one for one in lesson.exercises if not course.used_by().get(one.number)]
        rows.append((lesson_link(name), span(free), f"{sum(one.points for one in free):g}"))
    return table(("lesson", "exercises that no other exercise calls", "points"), rows)


def cited():
    """Return the address of the repository that CITATION.cff gives; "" if it gives none."""
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    named = re.search(r"^repository-code: *[\"']?(\S+?)[\"']?$", citation, re.M)
    return named[1] if named else ""


def repository():
    """Return the address of the repository, from CITATION.cff or else from git; "" if neither has one."""
    if named := cited():
        return named
    said = subprocess.run(["git", "remote", "get-url", "origin"], cwd=ROOT, capture_output=True, text=True)
    address = re.fullmatch(r"https://(?:[^@/]*@)?([\w.-]+/[\w./-]+?)(?:\.git)?", said.stdout.strip())
    return f"https://{address[1]}" if address else ""


def with_address(text):
    """Return a page in which REPOSITORY is the address of the repository, if it is known."""
    address = repository()
    if not address:
        return text
    text = re.sub(r"`REPOSITORY` stands for .*", f"The repository is at <{address}>.", text)
    return text.replace("REPOSITORY", address)


def filled(text):
    """Return the page with its tables in place of the marks."""
    tables = {"lessons": lesson_table, "free": free_exercises,
              "courses": lambda: "\n\n".join(map(course_section, COURSES))}
    for mark, make in tables.items():
        text = text.replace(f"<!-- {mark} -->", make())
    return text
