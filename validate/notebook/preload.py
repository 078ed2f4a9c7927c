"""Imports of the process from which checks are forked: pytest has run once, so a copy finds everything imported."""

import gc
import tempfile
from pathlib import Path

import scipy.integrate
import scipy.optimize
import scipy.special  # noqa: F401

from .pytest_process import quiet

with tempfile.TemporaryDirectory() as place:
    Path(place, "test_nothing.py").write_text("def test_nothing():\n    pass\n")
    quiet(place, f"--rootdir={place}", "-p", "validate.grading.plugin")
gc.freeze()                      # a copy's collector has nothing to do with what was there before
