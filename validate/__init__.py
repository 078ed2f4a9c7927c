"""Validation: scenes held against truth and engines, measured, and reported."""

from .subject.copies import use_the_one_of_this_notebook

use_the_one_of_this_notebook()
