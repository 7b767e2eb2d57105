"""Hands in motion, out of recordings, captures and running sessions, into files of other programs."""
