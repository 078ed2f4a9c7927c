"""Validation: scenes compared with reference solutions and engines, measured, and reported."""

from .subject.copies import use_the_one_of_this_notebook

use_the_one_of_this_notebook()
