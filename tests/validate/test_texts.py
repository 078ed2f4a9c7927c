"""Numbers and names in the texts for readers are those of the code."""

import importlib
import re
from collections import Counter
from datetime import datetime

import pytest

from validate.book import course, weeks
from validate.grading import example, release
from validate.measure.selection import Plan
from validate.reference.stored import kept
from validate.subject import modules
from validate.subject.modules import ROOT
from validate.worlds.described import DESCRIBED

NUMBERS = ("no one two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen sixteen "
           "seventeen eighteen nineteen twenty twenty-one twenty-two twenty-three twenty-four twenty-five").split()
TEXTS = {path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8") for path in (
    ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md")),
    *sorted((ROOT / "validate" / "book").glob("*.md")), ROOT / "notebooks" / "00_start_here.ipynb")}
README = TEXTS["README.md"]


AVOIDED = re.compile(r"\b(no|some|every|any)body\b|\bwh(o|at)ever\b", re.I)      # where a subject exists
READ = {".py", ".md", ".html", ".js", ".ipynb", ".json", ".toml", ".yml"}       # endings of files that people read


@pytest.fixture(scope="module")
def scenes():
    return {name: modules.bind_scene(name) for name in modules.scene_names()}


def test_readme_counts_the_lessons_and_has_a_row_for_each():
    names = modules.lesson_names()
    assert f"in Python: {NUMBERS[len(names)]} lessons" in README
    assert re.findall(r"^\| (\d+) \| `(\w+)` \|", README, re.M) == [
        (str(number), name) for number, name in enumerate(names, 1)]


def test_sentences_name_their_subject():
    files = (ROOT / name for name in release.tracked(dirty=True))
    texts = {path: path.read_text(encoding="utf-8") for path in files if path.suffix in READ and path.is_file()}
    assert len(texts) > 500
    assert not {path: found[0] for path, text in texts.items() if (found := AVOIDED.search(text))}


def test_the_class_of_the_walk_through_was_handed_in_in_time(tmp_path):
    """Whenever it is made: late days would take the points of the student who has everything right."""
    dates = set(re.findall(r"--due (\S+)", "".join(TEXTS.values())))
    due = min(datetime.fromisoformat(date).timestamp() for date in dates)
    made = [path for path in example.make(tmp_path / "class").rglob("*") if path.suffix in (".py", ".zip")]
    assert len(made) >= 5 and all(path.stat().st_mtime < due for path in made)


def test_texts_name_the_engines_scenes_and_the_sample_of_faults():
    assert f"in {len(DESCRIBED)} scenes that are Models" in README
    assert f"{len(DESCRIBED)} of these scenes" in TEXTS["docs/engine.md"]
    sample = re.search(r"tests\.faults --sample (\d+)", (ROOT / ".ci" / "run").read_text())[1]
    assert f"`--sample {sample}` is part of `.ci/run`" in TEXTS["CONTRIBUTING.md"]


def test_the_slides_that_need_care_are_counted():
    rows = re.findall(r"^\| .* \|$", TEXTS["docs/slides.md"], re.M)[1:]                        # below the head
    count = NUMBERS[len(rows)]
    assert f"{count.capitalize()} formulas or sentences" in TEXTS["docs/slides.md"]
    assert f"[{count} formulas to read with care]" in README
    assert f"{count} of their formulas" in TEXTS["docs/instructors.md"]


def test_every_text_gives_the_same_time_for_a_quick_run():
    for name in ("README.md", "CONTRIBUTING.md", "validate/book/validation.md", "validate/book/no_report.md"):
        assert "about three minutes on two cores" in TEXTS[name], name
        assert not re.search(r"\b(?:about|take) two (?:and a half )?minutes", TEXTS[name]), name


def test_readme_gives_the_longest_loop_that_a_full_run_times():
    assert f"less than a limit ({Plan(quick=False).time_limits()['compiled']:g} s compiled)" in README


def test_contributing_counts_the_seeded_faults_to_the_nearest_ten():
    count = sum(len(importlib.import_module(f"tests.faults.{name}").FAULTS) for name in modules.lesson_names())
    assert f"inserts about {round(count, -1)} wrong lines" in TEXTS["CONTRIBUTING.md"]


@pytest.mark.long
def test_readme_counts_the_scenes_that_laws_judge(scenes):
    judged = {name for name, scene in scenes.items() if any(r.laws for r in scene.runners)}
    ours = {name for name in judged if any(r.laws and not r.is_engine for r in scenes[name].runners)}
    numbers = sorted({course.lessons()[scenes[name].lesson].number for name in judged})
    text = " ".join(README.split())
    assert f"In {NUMBERS[len(judged)]} scenes of lessons {' and '.join(map(str, numbers))} no theory" in text
    assert f"In {NUMBERS[len(ours)]} of these scenes our own loop is judged so, too." in text


def test_the_scenes_without_a_truth_of_their_own_are_counted(scenes):
    agreed = [name for name in scenes if kept(name).get("agreed")]
    assert agreed == ["dominoes", "machine"] and "For the dominoes and for a machine of many parts" in README
    for name in ("notebooks/00_start_here.ipynb", "validate/book/validation.md", "validate/book/no_report.md"):
        assert f"{NUMBERS[len(agreed)].capitalize()} scenes have no such truth" in TEXTS[name], name


def test_the_plan_gives_the_constants_of_its_hours():
    text = TEXTS["docs/plan.md"]
    for said in (f"- {course.WORDS_PER_MINUTE} words of a notebook per minute",
                 f"{course.MINUTES_PER_OUTPUT:g} minutes for each cell",
                 f"{course.MINUTES_PER_EXERCISE:g} minutes to read its docstring",
                 f"{course.MINUTES_PER_LINE:g} minutes for each line", f"- {course.MINUTES_TO_FIND:g} minutes more"):
        assert said in text, said
    long = sum(len(own) == 2 for own in weeks.WEEKS.values())
    assert f"({NUMBERS[long]} lessons have two)" in text and "a long lesson has two weeks" in text


def test_the_film_that_grows_has_as_many_exercises_in_each_lesson_as_start_here_says():
    from validate.notebook.growing.parts import PARTS
    first, last, least = re.search(r"In lessons (\d+) to (\d+), at least (\w+) exercises each",
                                   TEXTS["notebooks/00_start_here.ipynb"]).groups()
    lessons = Counter(int(number.split(".")[0]) for number in PARTS)
    assert sorted(lessons) == [*range(int(first), int(last) + 1)] and min(lessons.values()) == NUMBERS.index(least)


@pytest.mark.parametrize("name", ["README.md", "CONTRIBUTING.md", "docs/engine.md"])
def test_every_file_that_a_text_names_is_there(name):
    tops = ("solutions/", "lessons/", "validate/", "tests/", "docs/", "binder/")
    named = [one for one in re.findall(r"`([\w./]+)`", TEXTS[name]) if one.startswith(tops) and "NAME" not in one]
    assert len(named) >= 3
    assert [one for one in named if not (ROOT / one).exists()] == []
