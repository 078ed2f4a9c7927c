"""Fixtures of the attacks: the grader with the trial tests and short time limits."""

import importlib.util
import shutil
import tempfile

import pytest

from validate.subject.modules import ROOT

if importlib.util.find_spec("_multiprocessing"):
    from validate.grading import box, marking, plugin, points, remote, sandbox

    from .trial import BUDGET, LESSONS, MARK, PATIENCE, SEED
else:                                                                  # in a browser there is no grader to attack
    collect_ignore_glob = ["*.py"]


@pytest.fixture(scope="session", autouse=True)
def _sandbox():
    sandbox.for_tests(pytest.skip, pytest.fail)


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    """A folder of tests that holds the trial tests in place of the lessons' own."""
    top = tmp_path_factory.mktemp("trial")
    tests = top / "trials"                                            # not "tests": such a module may be loaded already
    (tests / "lessons").mkdir(parents=True)
    shutil.copy(ROOT / "pyproject.toml", top)
    for lesson in LESSONS:
        shutil.copy(ROOT / "tests" / "attacks" / f"trial_{lesson}.py", tests / "lessons" / f"test_{lesson}.py")
    return tests


@pytest.fixture
def trial(folder, settings, monkeypatch, tmp_path_factory):
    """Let the grader use the trial tests and short time limits, and mark the processes that it starts."""
    use_trial_tests(monkeypatch, folder)
    monkeypatch.setattr(plugin, "BOX_LIMIT", PATIENCE)
    monkeypatch.setattr(box, "IMPORT_WITHIN", 3.0 * PATIENCE)
    monkeypatch.setattr(marking, "BUDGET", BUDGET)
    monkeypatch.setitem(sandbox.ENVIRONMENT, MARK, "1")
    monkeypatch.setenv("TOKEN", "TOKEN-OF-THE-GRADER")
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path_factory.mktemp("boxes")))


@pytest.fixture(scope="session")
def settings(folder):
    """{lesson: marking.Settings} of the trial tests."""
    with pytest.MonkeyPatch.context() as patch:
        use_trial_tests(patch, folder)
        remote.handout()                                               # kept as long as the process
        return {lesson: marking.settings((lesson,), SEED) for lesson in LESSONS}


def use_trial_tests(patch, folder):
    patch.setattr(points, "TESTS", folder)
    patch.setattr(points, "LESSONS", folder / "lessons")
