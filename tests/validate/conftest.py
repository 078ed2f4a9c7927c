"""What tests of pages and of live scenes share: one Chromium, and a learner's folder."""

import ast
import os
import time

import pytest

from validate.subject.modules import SOLUTIONS

from .test_live_films import CHROMIUM


@pytest.fixture(scope="module")
def browser():
    playwright = pytest.importorskip("playwright.sync_api", reason="without playwright no page can be driven")
    with playwright.sync_playwright() as run:
        chromium = run.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield chromium
        chromium.close()


def begun(lesson, function, line):
    """The text of a solved lesson, one of whose functions begins with a line of its own."""
    text = (SOLUTIONS / f"{lesson}.py").read_text()
    found = next(one for one in ast.parse(text).body if isinstance(one, ast.FunctionDef) and one.name == function)
    lines = text.splitlines(keepends=True)
    return "".join((*lines[:found.body[0].end_lineno], f"    {line}\n", *lines[found.body[0].end_lineno:]))


@pytest.fixture
def learner(tmp_path):
    """save(lesson, text): write a file of the learner's folder, in which all lessons are solved."""
    for file in SOLUTIONS.glob("*.py"):
        (tmp_path / file.name).write_text(file.read_text())
    stamps = iter(range(1, 1000))

    def save(lesson, text):
        file = tmp_path / f"{lesson}.py"
        file.write_text(text)
        os.utime(file, ns=(0, time.time_ns() + next(stamps)))
    save.folder = tmp_path
    return save
