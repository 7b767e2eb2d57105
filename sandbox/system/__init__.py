"""Functions that differ between operating systems."""
