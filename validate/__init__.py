"""Validation: scenes compared with reference solutions and engines, measured, and reported."""

import importlib
import sys

from .subject.copies import use_the_one_of_this_notebook

use_the_one_of_this_notebook()


def main():
    """Run the command line.  Its imports take a second, and Ctrl-C in that second says *interrupted*, as later on."""
    try:
        program = importlib.import_module("validate.__main__")
    except KeyboardInterrupt:
        print("validate: interrupted", file=sys.stderr)
        sys.exit(130)
    program.main()
