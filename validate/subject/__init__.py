"""Whose code is measured: module sets, compiled twins, loading, and the lessons made from the answers."""
