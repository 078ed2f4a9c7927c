"""Stability cases of given functions: a file for each lesson that brings some."""
