"""Trials: their settings, and how a session is built, run, paced, recorded and replayed.

Stored profiles of hands are here, too.
"""
