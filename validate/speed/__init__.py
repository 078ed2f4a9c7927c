"""Benchmarks beside the report: piles and a profile of their steps, targets, memory, what became slower."""
