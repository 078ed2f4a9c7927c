"""The students' zip, made from a repository that holds what this work tree holds; results that are made up."""

import contextlib
import shutil
import subprocess
import sys

import pytest

from validate.subject.modules import ROOT


def git(*arguments, cwd):
    command = ["git", "-c", "user.name=a", "-c", "user.email=a@b", *arguments]
    return subprocess.run(command, cwd=cwd, check=True, capture_output=True, text=True).stdout


@pytest.fixture(scope="module")
def repository(tmp_path_factory):
    """Copy the tracked files of this work tree into a repository of their own and commit them."""
    folder = tmp_path_factory.mktemp("clone")
    for path in git("ls-files", cwd=ROOT).splitlines():
        if (ROOT / path).is_file():
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / path, folder / path)
    git("init", "--quiet", cwd=folder)
    git("add", "--all", cwd=folder)
    git("commit", "--quiet", "--message", "all", cwd=folder)
    return folder


@pytest.fixture(scope="module")
def reader():
    """Start the process that reads archives; a new one would take half a second for each test."""
    from validate.grading import children  # here, since this file must load where Python cannot start processes
    with children.reader() as child:
        yield child


@pytest.fixture
def one_reader(reader, monkeypatch):
    """Let everything that is read be read by that process."""
    monkeypatch.setattr("validate.grading.children.reader", lambda: contextlib.nullcontext(reader))


@pytest.fixture
def made_up(monkeypatch):
    """Return function(more) after which nothing is graded: each result is marking.nothing with more(submission,
    settings).  It returns {student: how often he was graded}.
    """
    from validate.grading import local, marking  # here, since this file must load where Python cannot start processes

    def set_up(more):
        graded = {}

        def results(jobs, todo, settings):
            for s in todo:
                graded[s.student] = graded.get(s.student, 0) + 1
                nothing = marking.nothing(s.student, settings)
                yield s.student, {**nothing, "digest": settings.digest(s), **more(s, settings)}, ""
        monkeypatch.setattr(local, "results", results)
        return graded
    return set_up


@pytest.fixture(scope="module")
def unpacked(repository, tmp_path_factory):
    """Make the zip of that repository by its own command, and unpack it."""
    folder = tmp_path_factory.mktemp("student")
    command = [sys.executable, "-m", "validate.grading.release", "--out", str(folder / "workbook.zip")]
    subprocess.run(command, cwd=repository, check=True)
    shutil.unpack_archive(folder / "workbook.zip", folder)
    return folder / "workbook"
