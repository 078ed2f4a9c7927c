"""Validation: scenes compared with reference solutions and engines, measured, and reported."""

import importlib
import sys

from .subject.copies import use_the_one_of_this_notebook

use_the_one_of_this_notebook()


def begin(program, module):
    """Run a command line.  Its imports take a second, and Ctrl-C in that second says *interrupted*, as later on."""
    try:
        found = importlib.import_module(module)
    except KeyboardInterrupt:
        print(f"{program}: interrupted", file=sys.stderr)
        sys.exit(130)
    found.main()


def main():
    """Run `validate`."""
    begin("validate", "validate.__main__")


def grade():
    """Run `grade`."""
    begin("grade", "validate.grading.__main__")


def release():
    """Run `release`."""
    begin("release", "validate.grading.release")


def autograder():
    """Run `autograder`."""
    begin("autograder", "validate.grading.autograder")
