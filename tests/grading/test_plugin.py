"""What pytest itself says about the tests of the workbook."""

import re
import subprocess
import sys

import pytest

from validate import modules

LEFT_OUT = re.compile(r"^(\d+) long tests were left out: pytest --long runs them, too$", re.MULTILINE)


def printed(*arguments):
    """What pytest prints with these arguments, in a process of its own."""
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", *arguments]
    run = subprocess.run(command, cwd=modules.ROOT, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout + run.stderr
    return run.stdout


@pytest.mark.parametrize("options", [[], ["-n", "1"]], ids=["one process", "pytest-xdist"])
def test_the_summary_counts_the_long_tests_that_were_left_out(options):
    summary = printed("tests/grading/test_scale.py", *options)
    assert len(LEFT_OUT.findall(summary)) == 1


@pytest.mark.parametrize("options", [["--long"], ["--exercise=1.2"]], ids=" ".join)
def test_the_summary_has_no_such_line_with_long_or_with_an_exercise(options):
    files = "tests/grading/test_scale.py", "tests/lessons/test_integrators.py"
    assert not LEFT_OUT.search(printed(*files, "--collect-only", *options))
