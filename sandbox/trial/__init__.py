"""Trials: their settings, and how a session is built, run, paced, recorded and replayed; stored profiles of hands."""
