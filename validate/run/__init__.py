"""A run: its processes, its stored results, and workers on other machines."""
