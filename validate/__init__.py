"""Validation: scenes held against truth and engines, measured, and reported."""
