"""Hands in motion: out of recordings, captures and sessions, into other programs' files."""
