"""Geometry that lessons hand out: nobody has to write it, and few need to read it."""
