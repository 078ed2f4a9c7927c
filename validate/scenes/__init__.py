"""Scenes, one file for each: parameters, reference solution, runners with their limits, and what the scene omits."""
