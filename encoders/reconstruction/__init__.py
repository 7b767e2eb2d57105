"""Reconstructors: they turn touch frames, one after another, into poses of the whole hand."""
