"""Measures of a trial."""
