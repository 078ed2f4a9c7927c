"""Benchmarks beside the report: piles, targets, memory."""
