"""What became slower since an earlier commit: the verdict follows the interval, and a bad commit is refused."""

import subprocess
import sys
from contextlib import contextmanager

import pytest

from validate.speed import regression
from validate.subject.modules import ROOT, lesson_names


def test_every_lesson_has_a_method_that_is_timed():
    assert list(regression.WORK) == list(lesson_names())


@pytest.mark.parametrize(("ratio", "words", "slower"), [
    (1.0, "as quick", False), (1.12, "as quick", False), (1.3, "slower", True), (0.7, "quicker", False)])
def test_a_method_is_slower_if_the_whole_interval_is(ratio, words, slower):
    samples = [ratio * (1.0 + 0.01 * k) for k in range(-4, 5)]
    row, found = regression.judged("springs", samples)
    assert found == slower and words in row[-1]


def test_one_slow_round_of_nine_decides_nothing():
    assert not regression.judged("springs", [1.0] * 7 + [3.0, 3.0])[1]


def test_ratios_are_in_steps_of_the_engine():
    """A machine of half the speed doubles both times."""
    now, then = (lambda lesson: (0.4, 0.2)), (lambda lesson: (0.1, 0.1))
    assert regression.ratios(now, then, "springs") == [2.0] * regression.ROUNDS


@pytest.mark.parametrize(("slow", "verdict"), [({0}, False), ({0, 1}, False), ({0, 1, 2}, True)])
def test_a_slow_process_decides_nothing_and_a_slow_method_does(slow, verdict, monkeypatch):
    """In the slow ones of our processes the springs take 1.2 times as long; the other lessons are measured once."""
    begun = []

    @contextmanager
    def server(folder):
        begun.append(folder)
        late = folder == ROOT and begun.count(ROOT) - 1 in slow
        yield lambda lesson: (0.6 if late and lesson == "springs" else 0.5, 0.1)
    monkeypatch.setattr(regression, "server", server)
    found = regression.all_compared("then")
    assert list(found) == list(regression.WORK)
    assert {lesson for lesson, (_, slower) in found.items() if slower} == ({"springs"} if verdict else set())
    assert begun.count(ROOT) == min(len(slow) + 1, 1 + regression.AGAIN)


def test_an_unknown_commit_gets_one_sentence():
    done = subprocess.run([sys.executable, "-m", "validate.speed.regression", "--base", "no-such-commit"], cwd=ROOT,
                          capture_output=True, text=True)
    assert done.returncode == 2 and len(done.stderr.splitlines()) == 1 and "no-such-commit" in done.stderr


@pytest.mark.parametrize(("kept", "found"), [(None, None), ({"commit": "no-such-commit"}, None),
                                             ({"commit": "HEAD"}, "HEAD")])
def test_without_a_commit_to_compare_with_nothing_is_compared(monkeypatch, kept, found):
    monkeypatch.setattr(regression, "full_run", lambda: kept)
    assert regression.of_the_last_full_run() == found


def failing(lesson):
    raise EOFError(lesson)


def test_a_measurement_that_failed_at_the_earlier_commit_is_named_and_one_that_fails_now_is_an_error():
    row, slower = regression.compared(lambda lesson: (0.4, 0.2), failing, "springs")
    assert not slower and row[0] == "springs" and "failed at that commit" in row[-1]
    with pytest.raises(EOFError):
        regression.compared(failing, lambda lesson: (0.4, 0.2), "springs")


@pytest.mark.parametrize("name", [
    pytest.param(name, marks=[pytest.mark.long] if name == "contact" else []) for name in regression.WORK])
def test_what_is_timed_is_there(name):
    """One that a scene does not have would end the comparison."""
    assert callable(regression.WORK[name]())
