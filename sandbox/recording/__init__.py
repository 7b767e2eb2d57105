"""Recordings: what came in and when it took effect, and how it is kept."""
