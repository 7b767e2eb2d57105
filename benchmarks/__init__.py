"""Measurements: each prints the machine, what was measured and against what."""
