"""Regression runs: success over many seeds, on one or many cores, compared with a baseline."""
