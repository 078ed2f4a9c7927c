"""Validation: scenes compared with reference solutions and engines, measured, and reported."""

import importlib
import sys

from .subject.copies import use_the_one_of_this_notebook

use_the_one_of_this_notebook()


def main(program="validate", module="validate.__main__"):
    """Run a program.  Its imports take a second, and Ctrl-C in that second says *interrupted*, as it does later."""
    try:
        imported = importlib.import_module(module)
    except KeyboardInterrupt:
        print(f"{program}: interrupted", file=sys.stderr)
        sys.exit(130)
    imported.main()


def grade():
    main("grade", "validate.grading.__main__")


def release():
    main("release", "validate.grading.release")


def autograder():
    main("autograder", "validate.grading.autograder")
