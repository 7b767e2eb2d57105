"""Recordings: inputs, the steps at which they took effect, and their files."""
