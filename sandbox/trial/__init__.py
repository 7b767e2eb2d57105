"""Trials: settings, and the building, running, pacing, recording and replaying of sessions."""
