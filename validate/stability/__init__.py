"""Stability and extreme cases, one file per lesson."""
